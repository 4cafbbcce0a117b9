//! The JSON schema.

use super::{folder, parse, shipped, with};
use helfrich_std::scene::json_schema;
use serde_json::Value;

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

/// Whether a value conforms to a schema, by the keywords of JSON Schema 2020-12 that are used.
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
            "minLength" => value.as_str().is_none_or(|text| !text.is_empty()),
            "minimum" => value.as_f64().is_none_or(|value| value >= number()),
            "maximum" => value.as_f64().is_none_or(|value| value <= number()),
            "exclusiveMinimum" => value.as_f64().is_none_or(|value| value > number()),
            // Regular expressions are left to others: texts are told from numbers by their type.
            "pattern" => true,
            other => panic!("keyword {other}"),
        }
    };
    match schema {
        Value::Bool(allowed) => *allowed,
        schema => schema.as_object().unwrap().iter().all(holds),
    }
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
    for wrong in [
        "tension.value = true",
        "tenson.value = 1",
        "bending.modulus = 1",
        "area = { constraint = \"exact\", modulus = 1 }",
        "area = { target = 1 }",
        "volume = { modulus = 1, target = 1, reduced = 0.5 }",
        "position = [1, 2]",
        "mesh = \"a.ply\"",
        "scale = 0",
    ] {
        let text = with(wrong);
        assert!(!conforms(&schema, &json(&text)), "{wrong}");
        assert!(parse(&text).is_err(), "{wrong}");
    }
}
