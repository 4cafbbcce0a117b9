//! A JSON schema from the table of keys, for editors and other programs.

use super::check::LONGEST_NAME;
use super::keys::{Form, Key, Keys, Kind, Presence, Range};
use super::tables::SCENE;
use super::units::Dimension;
use serde_json::{Map, Value, json};

/// The JSON schema (draft 2020-12) of a scene file, its tables being objects.
///
/// The schema covers keys, forms, plain ranges, and keys that exclude or need each other. Only
/// [`super::SceneFile`] checks dimensions of units and contradictions between effects.
pub fn json_schema() -> Value {
    let mut schema = object(&SCENE);
    schema.insert(
        "$schema".to_owned(),
        json!("https://json-schema.org/draft/2020-12/schema"),
    );
    schema.insert("title".to_owned(), json!("Scene of the helfrich program"));
    Value::Object(schema)
}

fn object(keys: &'static Keys) -> Map<String, Value> {
    let required = |key: &&Key| key.presence == Presence::Required;
    let required = Vec::from_iter(keys.keys.iter().filter(required).map(|key| key.name));
    let properties = keys.keys.iter().map(|key| {
        let mut value = form(&key.form);
        value.insert("description".to_owned(), json!(key.summary));
        (key.name.to_owned(), Value::Object(value))
    });
    let mut schema = Map::from_iter([
        ("type".to_owned(), json!("object")),
        ("properties".to_owned(), Value::Object(properties.collect())),
        ("additionalProperties".to_owned(), json!(false)),
    ]);
    if !required.is_empty() {
        schema.insert("required".to_owned(), json!(required));
    }
    let mut rules = Vec::from_iter(keys.exactly_one.iter().map(one));
    for group in keys.at_most_one {
        for (index, first) in group.iter().enumerate() {
            let later = group[index + 1..].iter();
            rules.extend(later.map(|second| json!({ "not": { "required": [first, second] } })));
        }
    }
    for kind in keys.kinds {
        let named = json!({ "properties": { "kind": { "const": kind.name } } });
        rules.push(json!({ "if": named, "then": of_kind(keys, kind) }));
    }
    if !rules.is_empty() {
        schema.insert("allOf".to_owned(), json!(rules));
    }
    let mut needs = Map::new();
    for [key, other] in keys.needs {
        needs.insert((*key).to_owned(), json!([other]));
    }
    if !needs.is_empty() {
        schema.insert("dependentRequired".to_owned(), Value::Object(needs));
    }
    schema
}

/// Further rules for a table of this kind: keys of other kinds are absent.
fn of_kind(keys: &'static Keys, kind: &Kind) -> Map<String, Value> {
    let elsewhere = |name: &&str| !kind.has(name) && !keys.kinds_with(name).is_empty();
    let elsewhere = keys.keys.iter().map(|key| key.name).filter(elsewhere);
    let elsewhere = elsewhere.map(|name| (name.to_owned(), Value::Bool(false)));
    let mut schema = Map::new();
    schema.insert("properties".to_owned(), Value::Object(elsewhere.collect()));
    let required = Vec::from_iter(kind.required());
    if !required.is_empty() {
        schema.insert("required".to_owned(), json!(required));
    }
    if !kind.exactly_one.is_empty() {
        let one = Vec::from_iter(kind.exactly_one.iter().map(one));
        schema.insert("allOf".to_owned(), json!(one));
    }
    schema
}

/// Requires exactly one key of a group.
fn one(group: &&[&str]) -> Value {
    let alone = Vec::from_iter(group.iter().map(|key| json!({ "required": [key] })));
    json!({ "oneOf": alone })
}

/// The pattern of a number with a unit. A unit begins with a letter or with `1/`. Of units with `e`
/// only `erg` is allowed, because exponents begin with `e`.
const QUANTITY: &str =
    r"^\s*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?(\s*([A-DF-Za-df-zµμ]|erg)|\s+1\s*/)";

fn form(form: &'static Form) -> Map<String, Value> {
    let value = match form {
        Form::Text => json!({ "type": "string" }),
        Form::Name => json!({
            "type": "string",
            "pattern": format!("^[A-Za-z][A-Za-z0-9_-]{{0,{}}}$", LONGEST_NAME - 1)
        }),
        Form::File => json!({ "type": "string", "minLength": 1 }),
        Form::Shape => {
            json!({ "type": "string", "pattern": "^(sphere|ellipsoid|torus|discocyte)(:|$)" })
        }
        Form::Choice(names) => json!({ "enum": names() }),
        Form::Number(dimension, range) => number(*dimension, *range),
        Form::Numbers(dimension, range) => {
            let number = number(*dimension, *range);
            json!({ "anyOf": [number, { "type": "array", "items": number, "minItems": 1 }] })
        }
        Form::Count(least) => json!({ "type": "integer", "minimum": least }),
        Form::Switch => json!({ "type": "boolean" }),
        Form::Vector(dimension) => three(*dimension),
        Form::Direction => three(Dimension::NONE),
        Form::Pair => {
            json!({ "type": "array", "items": { "type": "string" }, "minItems": 2, "maxItems": 2 })
        }
        Form::Exactly(count, inner) => {
            let inner = self::form(inner);
            json!({ "type": "array", "items": inner, "minItems": count, "maxItems": count })
        }
        Form::Table(keys) => Value::Object(object(keys)),
        Form::Tables(keys) => json!({ "type": "array", "items": object(keys), "minItems": 1 }),
        Form::Either([first, second]) => {
            json!({ "anyOf": [self::form(first), self::form(second)] })
        }
    };
    match value {
        Value::Object(map) => map,
        _ => Map::new(),
    }
}

fn three(dimension: Dimension) -> Value {
    let number = number(dimension, Range::Any);
    json!({ "type": "array", "items": number, "minItems": 3, "maxItems": 3 })
}

fn number(dimension: Dimension, range: Range) -> Value {
    let number = match range {
        Range::Any => json!({ "type": "number" }),
        Range::NotZero => json!({ "type": "number", "not": { "const": 0 } }),
        Range::Positive => json!({ "type": "number", "exclusiveMinimum": 0 }),
        Range::NotNegative => json!({ "type": "number", "minimum": 0 }),
        Range::Fraction => json!({ "type": "number", "exclusiveMinimum": 0, "maximum": 1 }),
        Range::Half => json!({ "type": "number", "exclusiveMinimum": 0, "maximum": 0.5 }),
        Range::Signed => json!({ "type": "number", "minimum": -1, "maximum": 1 }),
        Range::Above(least) => json!({ "type": "number", "exclusiveMinimum": least }),
    };
    if dimension == Dimension::NONE {
        return number;
    }
    json!({ "anyOf": [number, { "type": "string", "pattern": QUANTITY }] })
}
