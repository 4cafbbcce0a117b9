//! The JSON schema.

use super::{folder, parse, shipped, with};
use helfrich_std::scene::json_schema;
use regex_lite::Regex;
use serde_json::{Value, json};

#[test]
fn schema_is_up_to_date() {
    let path = folder().join("scene.schema.json");
    let mut text = serde_json::to_string_pretty(&json_schema()).unwrap();
    text.push('\n');
    if std::env::var_os("UPDATE_SCHEMA").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        kept == text,
        "{} is out of date: run this test with UPDATE_SCHEMA=1",
        path.display()
    );
}

/// The list of all keys in the guide is that of the schema.
#[test]
fn the_guide_has_every_key() {
    const HEAD: &str = "## All keys\n";
    let path = folder().join("../../../docs/SCENES.md");
    let text = std::fs::read_to_string(&path).unwrap();
    let (before, after) = text.split_once(HEAD).expect("a heading");
    let after = after.find("\n## ").map_or("", |next| &after[next..]);
    let mut keys = Vec::new();
    add_keys("", &json_schema(), &mut keys);
    let mut list = "\nGenerated from the schema. A number may also be a text with a unit, where the key has one. Keys \
                     in bold are required. Keys of `population` that mean the same as those of `surface` are left out.\n\n"
        .to_owned();
    for key in keys.iter().filter(|key| !key.is_of_surfaces(&keys)) {
        list += &key.line(&keys);
    }
    let current = format!("{before}{HEAD}{list}{after}");
    if std::env::var_os("UPDATE_SCHEMA").is_some() {
        std::fs::write(&path, &current).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap();
    assert!(
        kept == current,
        "{} is out of date: run this test with UPDATE_SCHEMA=1",
        path.display()
    );
}

/// A key in the list of the guide.
struct Key {
    path: String,
    is_required: bool,
    form: String,
    meaning: String,
}

impl Key {
    /// Whether it is a key of populations that surfaces have with the same meaning.
    fn is_of_surfaces(&self, keys: &[Self]) -> bool {
        let of_surfaces = self
            .path
            .strip_prefix("population.")
            .map(|key| format!("surface.{key}"));
        let is_same = |other: &Self| {
            Some(&other.path) == of_surfaces.as_ref()
                && (&other.form, &other.meaning) == (&self.form, &self.meaning)
        };
        keys.iter().any(is_same)
    }

    /// Its line. What is said of a key of the same name elsewhere, of surfaces if possible, is not repeated.
    fn line(&self, keys: &[Self]) -> String {
        let name = |key: &Self| key.path.rsplit('.').next().unwrap().to_owned();
        let is_same = |other: &&Self| {
            (name(other), &other.form, &other.meaning) == (name(self), &self.form, &self.meaning)
        };
        let order = |other: &&Self| {
            let path = &other.path;
            (!path.starts_with("surface."), path.matches('.').count())
        };
        let first = keys.iter().filter(is_same).min_by_key(order).unwrap();
        let shown = match self.is_required {
            true => format!("**`{}`**", self.path),
            false => format!("`{}`", self.path),
        };
        let is_long = self.meaning.split_whitespace().count() > 6;
        let meaning = match is_long && first.path != self.path {
            true => format!("As `{}`.", first.path),
            false => self.meaning.clone(),
        };
        format!("* {shown} ({}): {meaning}\n", self.form)
    }
}

/// Each key of a table and of the tables in it.
fn add_keys(path: &str, table: &Value, keys: &mut Vec<Key>) {
    let required = table["required"].as_array();
    for (key, form) in table["properties"].as_object().unwrap() {
        let own = match path {
            "" => key.clone(),
            path => format!("{path}.{key}"),
        };
        keys.push(Key {
            path: own.clone(),
            is_required: required.is_some_and(|required| required.contains(&json!(key))),
            form: form_of(form),
            meaning: form["description"].as_str().unwrap().to_owned(),
        });
        let forms = form["anyOf"]
            .as_array()
            .map_or(vec![form], |any| any.iter().collect());
        for form in forms {
            let inner = if form["items"]["properties"].is_object() {
                &form["items"]
            } else {
                form
            };
            if inner["properties"].is_object() {
                add_keys(&own, inner, keys);
            }
        }
    }
}

/// The form of a value in words.
fn form_of(form: &Value) -> String {
    if let Some(choices) = form["enum"].as_array() {
        let quoted = choices.iter().map(|choice| format!("`{choice}`"));
        return Vec::from_iter(quoted).join(", ");
    }
    if let Some(any) = form["anyOf"].as_array() {
        let mut forms = Vec::from_iter(any.iter().map(form_of));
        // A quantity is a number or a text with its unit.
        if forms.starts_with(&["number".to_owned(), "text".to_owned()]) {
            forms.remove(1);
        }
        return forms.join(" or ");
    }
    match form["type"].as_str().unwrap() {
        "object" => "table".to_owned(),
        "array" if form["items"]["properties"].is_object() => "tables".to_owned(),
        "array" => {
            let items = form_of(&form["items"]);
            let several = match items.starts_with(|c: char| c.is_ascii_digit()) {
                true => format!("lists of {items}"),
                false => format!("{items}s"),
            };
            match (&form["minItems"], &form["maxItems"]) {
                (least, most) if least == most => format!("{least} {several}"),
                _ => format!("list of {several}"),
            }
        }
        "string" => "text".to_owned(),
        other => other.to_owned(),
    }
}

/// Whether a value conforms to a schema; implements the keywords of JSON Schema 2020-12 that the scene schema
/// uses.
pub(super) fn conforms(schema: &Value, value: &Value) -> bool {
    let holds = |(keyword, rule): (&String, &Value)| {
        let list = || rule.as_array().unwrap().iter();
        let number = || rule.as_f64().unwrap();
        match keyword.as_str() {
            "const" => rule == value || (rule.is_number() && rule.as_f64() == value.as_f64()),
            "if" => !conforms(rule, value) || conforms(&schema["then"], value),
            "then" => true,
            "$schema" | "title" | "description" => true,
            "type" => match rule.as_str().unwrap() {
                "object" => value.is_object(),
                "array" => value.is_array(),
                "string" => value.is_string(),
                "boolean" => value.is_boolean(),
                "number" => value.is_number(),
                "integer" => value.is_i64() || value.is_u64(),
                other => panic!("type {other}"),
            },
            "enum" => list().any(|choice| choice == value),
            "anyOf" => list().any(|schema| conforms(schema, value)),
            "allOf" => list().all(|schema| conforms(schema, value)),
            "oneOf" => list().filter(|schema| conforms(schema, value)).count() == 1,
            "not" => !conforms(rule, value),
            "required" => value
                .as_object()
                .is_none_or(|object| list().all(|key| object.contains_key(key.as_str().unwrap()))),
            "dependentRequired" => value.as_object().is_none_or(|object| {
                let mut present = rule
                    .as_object()
                    .unwrap()
                    .iter()
                    .filter(|(key, _)| object.contains_key(*key));
                present.all(|(_, needed)| {
                    let needed = needed.as_array().unwrap();
                    needed
                        .iter()
                        .all(|key| object.contains_key(key.as_str().unwrap()))
                })
            }),
            "properties" => value.as_object().is_none_or(|object| {
                let known = rule.as_object().unwrap();
                object
                    .iter()
                    .all(|(key, value)| known.get(key).is_none_or(|schema| conforms(schema, value)))
            }),
            "additionalProperties" => {
                assert_eq!(rule, &Value::Bool(false));
                let known = schema["properties"].as_object().unwrap();
                value
                    .as_object()
                    .is_none_or(|object| object.keys().all(|key| known.contains_key(key)))
            }
            "items" => value
                .as_array()
                .is_none_or(|items| items.iter().all(|item| conforms(rule, item))),
            "minItems" => value
                .as_array()
                .is_none_or(|items| items.len() as f64 >= number()),
            "maxItems" => value
                .as_array()
                .is_none_or(|items| items.len() as f64 <= number()),
            "minLength" => value
                .as_str()
                .is_none_or(|text| text.chars().count() as f64 >= number()),
            "minimum" => value.as_f64().is_none_or(|value| value >= number()),
            "maximum" => value.as_f64().is_none_or(|value| value <= number()),
            "exclusiveMinimum" => value.as_f64().is_none_or(|value| value > number()),
            // A pattern matches anywhere in the text, unless it is anchored.
            "pattern" => value
                .as_str()
                .is_none_or(|text| Regex::new(rule.as_str().unwrap()).unwrap().is_match(text)),
            other => panic!("keyword {other}"),
        }
    };
    match schema {
        Value::Bool(allowed) => *allowed,
        schema => schema.as_object().unwrap().iter().all(holds),
    }
}

/// Checks values that conform to schemas, and values that do not.
fn holds_for(cases: impl IntoIterator<Item = (Value, Vec<Value>, Vec<Value>)>) {
    for (schema, right, wrong) in cases {
        for value in right {
            assert!(conforms(&schema, &value), "{schema}: {value}");
        }
        for value in wrong {
            assert!(!conforms(&schema, &value), "{schema}: {value}");
        }
    }
}

/// Conforming and other values for each keyword, by the text of JSON Schema 2020-12 (Validation and Core): a
/// keyword for numbers or texts ignores values of other types.
#[test]
fn keywords_for_any_value_are_those_of_the_standard() {
    let least = json!({ "minimum": 2 });
    holds_for([
        (
            json!({ "const": 1 }),
            vec![json!(1), json!(1.0)],
            vec![json!(2), json!("1"), json!(true)],
        ),
        (
            json!({ "enum": ["a", 1] }),
            vec![json!("a"), json!(1)],
            vec![json!("b"), json!(null)],
        ),
        (
            json!({ "type": "object" }),
            vec![json!({})],
            vec![json!([]), json!("")],
        ),
        (json!({ "type": "array" }), vec![json!([])], vec![json!({})]),
        (json!({ "type": "string" }), vec![json!("")], vec![json!(1)]),
        (
            json!({ "type": "boolean" }),
            vec![json!(false)],
            vec![json!(0), json!("false")],
        ),
        (
            json!({ "type": "number" }),
            vec![json!(1), json!(-1.5)],
            vec![json!("1")],
        ),
        (
            json!({ "type": "integer" }),
            vec![json!(1)],
            vec![json!(1.5), json!("1")],
        ),
        (
            json!({ "anyOf": [least, { "type": "string" }] }),
            vec![json!(2), json!("")],
            vec![json!(1)],
        ),
        (
            json!({ "allOf": [least, { "maximum": 3 }] }),
            vec![json!(2), json!(3)],
            vec![json!(1), json!(4)],
        ),
        (
            json!({ "oneOf": [least, { "maximum": 3 }] }),
            vec![json!(1), json!(4)],
            vec![json!(2), json!("")],
        ),
        (
            json!({ "not": least }),
            vec![json!(1)],
            vec![json!(2), json!("")],
        ),
        (
            json!({ "if": { "required": ["a"] }, "then": { "required": ["b"] } }),
            vec![json!({}), json!({ "a": 1, "b": 1 }), json!({ "b": 1 })],
            vec![json!({ "a": 1 })],
        ),
    ]);
}

#[test]
fn keywords_for_one_type_are_those_of_the_standard() {
    let least = json!({ "minimum": 2 });
    holds_for([
        (
            json!({ "required": ["a"] }),
            vec![json!({ "a": null }), json!(1)],
            vec![json!({ "b": 1 })],
        ),
        (
            json!({ "dependentRequired": { "a": ["b"] } }),
            vec![
                json!({}),
                json!({ "b": 1 }),
                json!({ "a": 1, "b": 1 }),
                json!([]),
            ],
            vec![json!({ "a": 1 })],
        ),
        (
            json!({ "properties": { "a": least }, "additionalProperties": false }),
            vec![json!({}), json!({ "a": 2 }), json!([])],
            vec![json!({ "a": 1 }), json!({ "b": 2 })],
        ),
        (
            json!({ "properties": { "a": false } }),
            vec![json!({ "b": 1 })],
            vec![json!({ "a": 1 })],
        ),
        (
            json!({ "items": least }),
            vec![json!([]), json!([2, 3]), json!({})],
            vec![json!([2, 1])],
        ),
        (
            json!({ "minItems": 2 }),
            vec![json!([1, 1]), json!("")],
            vec![json!([1])],
        ),
        (
            json!({ "maxItems": 2 }),
            vec![json!([1, 1]), json!("abc")],
            vec![json!([1, 1, 1])],
        ),
        (
            json!({ "minLength": 2 }),
            vec![json!("µm"), json!(1), json!([])],
            vec![json!("µ"), json!("")],
        ),
        (
            json!({ "minimum": 2 }),
            vec![json!(2), json!("1")],
            vec![json!(1.9)],
        ),
        (
            json!({ "maximum": 2 }),
            vec![json!(2), json!("3")],
            vec![json!(2.1)],
        ),
        (
            json!({ "exclusiveMinimum": 0 }),
            vec![json!(1e-300), json!("0")],
            vec![json!(0), json!(-1)],
        ),
        (
            json!({ "pattern": "b+" }),
            vec![json!("abbc"), json!(1)],
            vec![json!("ac"), json!("")],
        ),
        (
            json!({ "pattern": "^(a|b)(:|$)" }),
            vec![json!("a"), json!("b:1")],
            vec![json!("ab"), json!(" a")],
        ),
    ]);
}

pub(super) fn json(text: &str) -> Value {
    serde_json::to_value(toml::from_str::<toml::Table>(text).unwrap()).unwrap()
}

#[test]
fn shipped_scenes_conform_to_the_schema() {
    let schema = json_schema();
    for (name, text) in shipped() {
        assert!(conforms(&schema, &json(&text)), "{name}");
    }
    let adhesion = "adhesion = { strength = \"0.1 µN/m\", distance = 0.06, range = \"20 nm\", \
                    wall = [0, 0, \"-4 µm\"], normal = [0, 0, 1] }";
    assert!(conforms(&schema, &json(&with(adhesion))));
    for wrong in [
        "adhesion = { strength = 1 }",
        "adhesion = { strength = 0, distance = 1 }",
        "adhesion = { strength = 1, distance = 1, normal = [0, 1] }",
        "tension.value = true",
        "tenson.value = 1",
        "bending.modulus = 1",
        "area = { constraint = \"exact\", modulus = 1 }",
        "area = { target = 1 }",
        "volume = { modulus = 1, target = 1, reduced = 0.5 }",
        "position = [1, 2]",
        "mesh = \"a.ply\"",
        "scale = 0",
        // These are refused by patterns alone.
        "tension.value = \"a lot\"",
        "tension.value = \"1\"",
        "tension.value = \"12\"",
        "tension.value = \"1.5e5\"",
        "tension.value = \"1e\"",
        "position = [\"1 µm\", 0, \"half a micron\"]",
        "weld = true",
    ] {
        let text = with(wrong);
        assert!(!conforms(&schema, &json(&text)), "{wrong}");
        assert!(parse(&text).is_err(), "{wrong}");
    }
    for [shape, name] in [
        ["cube:1", "cell"],
        ["spheres", "cell"],
        ["sphere:3", "1st"],
        ["sphere:3", "a b"],
    ] {
        let text = with("").replace("\"cell\"", &format!("{name:?}"));
        let text = text.replace("\"sphere:3\"", &format!("{shape:?}"));
        assert!(!conforms(&schema, &json(&text)), "{shape} {name}");
        assert!(parse(&text).is_err(), "{shape} {name}");
    }
}
