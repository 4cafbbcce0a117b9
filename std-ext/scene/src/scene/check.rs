//! Compares values with the table of keys.

use super::UnitSystem;
use super::keys::{Form, Key, Keys, Kind, Presence, Range, nearest};
use super::problem::{Problem, Problems, expected_number};
use super::units::{Dimension, QuantityError, Scale, quantity};
use super::value::{Node, Origin, Table, Value};

/// Reports all problems within a table. `around` is the path of the table, `origin` its place.
pub(super) fn check_table(
    keys: &'static Keys,
    around: &str,
    origin: &Origin,
    table: &Table,
    scale: Scale,
    problems: &mut Problems,
) {
    for entry in &table.entries {
        let Some(key) = keys.find(&entry.key) else {
            problems.add(&entry.key_origin, keys.unknown(around, &entry.key));
            continue;
        };
        let path = join(around, key.name);
        let origin = nonempty(&entry.node.origin, &entry.key_origin);
        check(
            &key.form,
            key.name,
            &path,
            origin,
            &entry.node.value,
            scale,
            problems,
        );
    }
    let given = |name: &&&str| table.get(name).is_some();
    let kind = kind_of(keys, table);
    if let Some(kind) = kind {
        for entry in &table.entries {
            let kinds = keys.kinds_with(&entry.key);
            if !kinds.is_empty() && !kinds.contains(&kind.name) {
                let problem = Problem::OtherKind {
                    table: around.to_owned(),
                    key: entry.key.clone(),
                    kind: kind.name,
                    kinds: quoted(&kinds, " or "),
                };
                problems.add(&entry.key_origin, problem);
            }
        }
    }
    for Key {
        name,
        presence,
        summary,
        form,
    } in keys.keys
    {
        let of_kind = kind.is_some_and(|kind| kind.required().any(|required| required == *name));
        if (*presence == Presence::Required || of_kind) && !given(&name) {
            let problem = Problem::Missing {
                table: around.to_owned(),
                key: name,
                expected: expected(form, scale.units).trim_end_matches(',').to_owned(),
                summary,
            };
            problems.add(origin, problem);
        }
    }
    let exactly_one = kind.map_or(&[][..], |kind| kind.exactly_one);
    let exactly_one = keys.exactly_one.iter().chain(exactly_one);
    for group in exactly_one.clone() {
        if !group.iter().any(|name| given(&name)) {
            let problem = Problem::NoneOf {
                table: around.to_owned(),
                keys: listed(group, "nor"),
            };
            problems.add(origin, problem);
        }
    }
    for group in exactly_one.chain(keys.at_most_one) {
        let found = Vec::from_iter(group.iter().filter(given).copied());
        if let [_, .., last] = found.as_slice() {
            let problem = Problem::SeveralOf {
                table: around.to_owned(),
                keys: listed(&found, "and"),
            };
            problems.add(&place_of(table, last, origin), problem);
        }
    }
    for [key, other] in keys.needs {
        if given(&key) && !given(&other) {
            let summary = keys.find(other).map_or("", |other| other.summary);
            let problem = Problem::Needs {
                key,
                other,
                summary,
            };
            problems.add(&place_of(table, key, origin), problem);
        }
    }
}

/// The kind that the key `kind` of a table selects.
fn kind_of(keys: &'static Keys, table: &Table) -> Option<&'static Kind> {
    let Some(Value::Text(name)) = table.get("kind").map(|node| &node.value) else {
        return None;
    };
    keys.kinds.iter().find(|kind| kind.name == name)
}

/// The place where a key was written.
fn place_of(table: &Table, key: &str, or: &Origin) -> Origin {
    let found = table.entries.iter().find(|entry| entry.key == key);
    found.map_or_else(|| or.clone(), |entry| entry.key_origin.clone())
}

/// A table of dotted keys has no place of its own, so the place of its key is used.
pub(super) fn nonempty<'a>(origin: &'a Origin, or: &'a Origin) -> &'a Origin {
    match origin {
        Origin::Text(range) if range.is_empty() => or,
        origin => origin,
    }
}

fn listed(names: &[&str], between: &str) -> String {
    let quoted = Vec::from_iter(names.iter().map(|name| format!("`{name}`")));
    quoted.join(&format!(" {between} "))
}

fn quoted(names: &[&str], between: &str) -> String {
    let quoted = Vec::from_iter(names.iter().map(|name| format!("\"{name}\"")));
    quoted.join(between)
}

pub(super) fn join(around: &str, key: &str) -> String {
    if around.is_empty() {
        key.to_owned()
    } else {
        format!("{around}.{key}")
    }
}

/// Reports all problems of a value. `name` is its key, `path` its path.
fn check(
    form: &'static Form,
    name: &str,
    path: &str,
    origin: &Origin,
    value: &Value,
    scale: Scale,
    problems: &mut Problems,
) {
    match (form, value) {
        (Form::Either(forms), value) => match forms.iter().find(|form| fits(form, value)) {
            Some(form) => check(form, name, path, origin, value, scale, problems),
            None => problems.add(origin, wrong_kind(form, name, value, scale)),
        },
        (Form::Table(keys), Value::Table(table)) => {
            check_table(keys, path, origin, table, scale, problems);
        }
        (Form::Tables(keys), Value::List(list)) => {
            if list.is_empty() {
                problems.add(
                    origin,
                    Problem::WrongKind {
                        key: name.to_owned(),
                        found: value.kind().to_owned(),
                        expected: format!("one [[{name}]] or more"),
                    },
                );
            }
            for (index, node) in list.iter().enumerate() {
                let path = format!("{path}.{index}");
                match &node.value {
                    Value::Table(table) => {
                        check_table(keys, &path, &node.origin, table, scale, problems);
                    }
                    other => problems.add(
                        &node.origin,
                        Problem::WrongKind {
                            key: path,
                            found: other.kind().to_owned(),
                            expected: "a table".to_owned(),
                        },
                    ),
                }
            }
        }
        (Form::Numbers(dimension, range), Value::List(list)) if !list.is_empty() => {
            check_all(name, *dimension, *range, list, scale, problems);
        }
        (Form::Vector(dimension), Value::List(list)) if list.len() == 3 => {
            check_all(name, *dimension, Range::Any, list, scale, problems);
        }
        (Form::Direction, Value::List(list)) if list.len() == 3 => {
            let before = problems.0.len();
            check_all(name, Dimension::NONE, Range::Any, list, scale, problems);
            let zero = |node: &Node| number(&node.value, Dimension::NONE, scale) == Ok(0.0);
            if problems.0.len() == before && list.iter().all(zero) {
                problems.add(
                    origin,
                    Problem::OutOfRange {
                        key: name.to_owned(),
                        value: "[0, 0, 0]".to_owned(),
                        range: "other than 0 among the three".to_owned(),
                    },
                );
            }
        }
        (Form::Exactly(count, inner), Value::List(list)) if list.len() == *count => {
            for node in list {
                check(
                    inner,
                    name,
                    path,
                    &node.origin,
                    &node.value,
                    scale,
                    problems,
                );
            }
        }
        _ => {
            if let Some(problem) = problem_of(form, name, value, scale) {
                problems.add(origin, problem);
            }
        }
    }
}

/// The problem of a value that is not a table, and whose parts have no problem of their own.
fn problem_of(form: &'static Form, name: &str, value: &Value, scale: Scale) -> Option<Problem> {
    let key = || name.to_owned();
    let is_wrong = |found: String| Problem::WrongKind {
        key: key(),
        found,
        expected: expected(form, scale.units),
    };
    match (form, value) {
        (Form::Vector(_) | Form::Direction | Form::Exactly(..), Value::List(list)) => {
            Some(is_wrong(format!("a list of {}", list.len())))
        }
        (Form::Number(dimension, range) | Form::Numbers(dimension, range), value) => {
            check_number(name, *dimension, *range, value, scale)
        }
        (Form::Count(least), Value::Integer(count)) => {
            let most = i64::MAX.into();
            let inside = (i128::from(*least)..=most).contains(count);
            (!inside).then(|| Problem::OutOfRange {
                key: key(),
                value: count.to_string(),
                range: format!("from {least} to {most}"),
            })
        }
        (Form::Choice(names), Value::Text(text)) => {
            let names = names();
            (!names.contains(&text.as_str())).then(|| unknown_name(name, text, &names))
        }
        (Form::Shape, Value::Text(text)) => {
            let parsed = text.parse::<crate::generate::AnyShape>();
            parsed
                .err()
                .map(|source| Problem::Shape { key: key(), source })
        }
        (Form::Name, Value::Text(text)) => {
            let found = match text.chars().count() {
                letters if letters > LONGEST_NAME => format!("a name of {letters} letters"),
                _ => format!("\"{text}\""),
            };
            (!is_name(text)).then(|| is_wrong(found))
        }
        (Form::File, Value::Text(text)) => text.is_empty().then(|| is_wrong("empty".to_owned())),
        (Form::Pair, Value::List(list)) => {
            let text = |node: &Node| matches!(node.value, Value::Text(_));
            let is_pair = list.len() == 2 && list.iter().all(text);
            (!is_pair).then(|| wrong_kind(form, name, value, scale))
        }
        (Form::Text, Value::Text(_)) | (Form::Switch, Value::Switch(_)) => None,
        _ => Some(wrong_kind(form, name, value, scale)),
    }
}

/// The problem of a value of another kind.
fn wrong_kind(form: &Form, name: &str, value: &Value, scale: Scale) -> Problem {
    Problem::WrongKind {
        key: name.to_owned(),
        found: value.kind().to_owned(),
        expected: match form {
            Form::Tables(_) => format!("a list of tables, [[{name}]],"),
            form => expected(form, scale.units),
        },
    }
}

fn check_all(
    name: &str,
    dimension: Dimension,
    range: Range,
    list: &[Node],
    scale: Scale,
    problems: &mut Problems,
) {
    for node in list {
        if let Some(problem) = check_number(name, dimension, range, &node.value, scale) {
            problems.add(&node.origin, problem);
        }
    }
}

/// Whether a value may be intended to have this form.
fn fits(form: &Form, value: &Value) -> bool {
    match (form, value) {
        (Form::Choice(names), Value::Text(text)) => {
            // A text that starts with a digit is regarded as a number with a unit, if one is allowed.
            names().contains(&text.as_str()) || !starts_as_number(text)
        }
        (Form::Number(..), Value::Integer(_) | Value::Float(_) | Value::Text(_))
        | (Form::Table(_), Value::Table(_))
        | (Form::Switch, Value::Switch(_)) => true,
        _ => false,
    }
}

fn starts_as_number(text: &str) -> bool {
    text.trim_start()
        .starts_with(|c: char| c.is_ascii_digit() || ['+', '-', '.'].contains(&c))
}

/// The expected value, in words.
fn expected(form: &Form, units: UnitSystem) -> String {
    match form {
        Form::Text => "a text".to_owned(),
        Form::Name => format!(
            "a letter, then letters, digits, `-` and `_`, {LONGEST_NAME} characters at most,"
        ),
        Form::File => "the name of a file".to_owned(),
        Form::Shape => "a shape such as \"sphere:1\"".to_owned(),
        Form::Choice(names) => match names().as_slice() {
            [one] => format!("\"{one}\""),
            names => format!("one of {}", quoted(names, ", ")),
        },
        Form::Number(dimension, Range::Any) => expected_number(*dimension, units),
        Form::Number(dimension, range) => {
            format!("{}, {},", expected_number(*dimension, units), range.words())
        }
        Form::Numbers(dimension, _) => {
            format!("{}, or a list of them,", expected_number(*dimension, units))
        }
        Form::Count(least) => format!("a whole number from {least} on"),
        Form::Switch => "true or false".to_owned(),
        Form::Vector(_) | Form::Direction => "a list of three numbers".to_owned(),
        Form::Pair => "a list of the names of two surfaces".to_owned(),
        Form::Exactly(count, inner) => match inner {
            Form::Exactly(inner, _) => format!("a list of {count} lists of {inner} numbers"),
            Form::Count(_) => format!("a list of {count} whole numbers"),
            _ => format!("a list of {count} numbers"),
        },
        Form::Table(_) => "a table".to_owned(),
        Form::Tables(_) => "a list of tables".to_owned(),
        Form::Either([first, second]) => {
            format!("{} or {}", expected(first, units), expected(second, units))
        }
    }
}

fn unknown_name(key: &str, name: &str, known: &[&str]) -> Problem {
    Problem::UnknownName {
        key: key.to_owned(),
        name: name.to_owned(),
        nearest: nearest(name, known),
        known: known.join(", "),
    }
}

/// The largest number of characters of a name. Names of files have 255 bytes at most on most systems, and the
/// files of a run have more than the name in theirs.
pub(super) const LONGEST_NAME: usize = 100;

/// A letter, then letters, digits, `-` and `_`: a name that files and paths can have.
pub(super) fn is_name(text: &str) -> bool {
    let inside = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    text.len() <= LONGEST_NAME
        && text.starts_with(|c: char| c.is_ascii_alphabetic())
        && text.chars().all(inside)
}

/// The number that a value is, in the scene's units.
pub(super) fn number(
    value: &Value,
    dimension: Dimension,
    scale: Scale,
) -> Result<f64, QuantityError> {
    match value {
        Value::Integer(integer) => Ok(*integer as f64),
        Value::Float(float) => Ok(*float),
        Value::Text(text) => quantity(text, dimension, scale.temperature),
        _ => Err(QuantityError::NoNumber),
    }
}

fn check_number(
    key: &str,
    dimension: Dimension,
    range: Range,
    value: &Value,
    scale: Scale,
) -> Option<Problem> {
    let Scale { units, .. } = scale;
    let key = key.to_owned();
    let expected = expected_number(dimension, units);
    let text = match value {
        Value::Integer(_) | Value::Float(_) => String::new(),
        Value::Text(text) => text.clone(),
        other => {
            return Some(Problem::WrongKind {
                key,
                found: other.kind().to_owned(),
                expected,
            });
        }
    };
    if !text.is_empty() && units == UnitSystem::None && starts_as_number(&text) {
        return Some(Problem::UnitWithoutUnits { key, text });
    }
    let example = match units {
        UnitSystem::Micro => dimension.example(),
        UnitSystem::None => "",
    };
    let no_quantity = |reason: String| Problem::NoQuantity {
        key: key.clone(),
        text: text.clone(),
        reason,
        expected: expected.clone(),
        example,
    };
    let value = match number(value, dimension, scale) {
        Ok(value) => value,
        Err(QuantityError::NoNumber) => return Some(no_quantity("which is no number".to_owned())),
        Err(QuantityError::NoUnit) if dimension == Dimension::NONE => {
            return Some(no_quantity("in quotes".to_owned()));
        }
        Err(QuantityError::NoUnit) => {
            return Some(no_quantity("a number in quotes without a unit".to_owned()));
        }
        Err(QuantityError::UnknownUnit(word)) => {
            return Some(no_quantity(format!("and there is no unit `{word}`")));
        }
        Err(QuantityError::TooLarge) => {
            return Some(no_quantity("which is too large".to_owned()));
        }
        Err(QuantityError::Dimension(found)) => {
            return Some(Problem::WrongDimension {
                key,
                found: found.name(),
                text,
                expected,
                example,
            });
        }
    };
    if !value.is_finite() {
        let value = value.to_string();
        let range = "that is finite".to_owned();
        return Some(Problem::OutOfRange { key, value, range });
    }
    (!range.contains(value)).then(|| Problem::OutOfRange {
        key,
        value: value.to_string(),
        range: range.words(),
    })
}
