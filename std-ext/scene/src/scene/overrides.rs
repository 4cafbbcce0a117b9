//! Values that replace or add to those of a scene file.

use super::keys::{Form, Key, Keys};
use super::problem::Problem;
use super::value::{NOTHING, Node, Origin, Table, Value, default_name};
use serde::Serialize;
use toml::de::DeValue;

/// Overrides of values of a scene, in the form `path.to.key=value`; they apply in order.
///
/// A path names keys from the outermost to the innermost. One of several surfaces or interactions
/// is chosen by its number, counted from 0, or by its name: `surface.0.bending.modulus` or
/// `surface.vesicle.bending.modulus`. A value is parsed as TOML; if that fails, the text itself is
/// the value. Without a value, as in `surface.0.bending=`, the key is removed.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Overrides {
    texts: Vec<String>,
}

/// A text without the form `path.to.key=value`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` sets nothing: write path.to.key=value, as in surface.0.bending.modulus=0.3")]
pub struct OverrideSyntaxError {
    /// The text.
    pub text: String,
}

impl Overrides {
    /// Overrides from texts like `surface.0.bending.modulus=0.3`.
    ///
    /// # Errors
    /// If a text has no `=` or no path before it. Unknown paths are reported when a scene is read.
    pub fn new<S: Into<String>>(
        texts: impl IntoIterator<Item = S>,
    ) -> Result<Self, OverrideSyntaxError> {
        let texts = Vec::from_iter(texts.into_iter().map(Into::into));
        match texts.iter().find(|text| split(text).is_none()) {
            Some(text) => Err(OverrideSyntaxError { text: text.clone() }),
            None => Ok(Self { texts }),
        }
    }

    /// The texts.
    pub fn texts(&self) -> &[String] {
        &self.texts
    }

    /// Sets the values in the table of a scene; returns the problems of overrides.
    pub(super) fn apply(&self, keys: &Keys, table: &mut Table) -> Vec<(Origin, Problem)> {
        let mut problems = Vec::new();
        for (index, text) in self.texts.iter().enumerate() {
            let before = table.clone();
            let Some((path, value)) = split(text) else {
                continue;
            };
            let origin = Origin::Override(index);
            let node = |value| Node {
                value,
                origin: origin.clone(),
            };
            let value = match DeValue::parse(value) {
                _ if value.is_empty() => Value::Other(NOTHING),
                Ok(value) => Value::new(value.get_ref(), &|_| origin.clone()),
                Err(_) => Value::Text(value.to_owned()),
            };
            let segments = Vec::from_iter(path.split('.').map(str::trim));
            if let Err(problem) = set(keys, "", table, &segments, node(value)) {
                *table = before;
                problems.push((origin, problem));
            }
        }
        problems
    }
}

fn split(text: &str) -> Option<(&str, &str)> {
    let (path, value) = text.split_once('=')?;
    let path = path.trim();
    (!path.is_empty()).then_some((path, value.trim()))
}

/// Inserts `node` at the path `segments`; `around` is the name of the table in messages.
fn set(
    keys: &Keys,
    around: &str,
    table: &mut Table,
    segments: &[&str],
    node: Node,
) -> Result<(), Problem> {
    let [segment, rest @ ..] = segments else {
        return Ok(());
    };
    let Some(Key { name, form, .. }) = keys.find(segment) else {
        return Err(keys.unknown(around, segment));
    };
    if matches!(node.value, Value::Other(NOTHING)) {
        if rest.is_empty() {
            table.entries.retain(|entry| entry.key != *name);
        }
        // Removal creates no missing tables on the way.
        if table.get(name).is_none() {
            return Ok(());
        }
    }
    let origin = node.origin.clone();
    let here = table.get_or_insert(name, &origin);
    let path = if around.is_empty() {
        (*name).to_owned()
    } else {
        format!("{around}.{name}")
    };
    let Some((next, further)) = rest.split_first() else {
        *here = node;
        return Ok(());
    };
    if let Some(inner) = form.table() {
        if !matches!(here.value, Value::Table(_)) {
            *here = Node {
                value: Value::Table(Table::default()),
                origin,
            };
        }
        return match &mut here.value {
            Value::Table(table) => set(inner, &path, table, rest, node),
            _ => Ok(()),
        };
    }
    match form {
        Form::Tables(inner) => {
            let list = match &mut here.value {
                Value::List(list) => list.as_mut_slice(),
                _ => &mut [],
            };
            let names = list.iter().enumerate();
            let names = Vec::from_iter(names.map(|(index, node)| name_of(name, index, node)));
            let found = match next.parse::<usize>() {
                Ok(index) => (index < list.len()).then_some(index),
                Err(_) => names.iter().position(|name| name == next),
            };
            let numbered = |(index, name)| format!("{index} ({name})");
            let names = names.into_iter().enumerate().map(numbered).collect();
            let element = found.and_then(|index| list.get_mut(index));
            match element.map(|element| &mut element.value) {
                Some(Value::Table(_)) if further.is_empty() => Err(Problem::WholeElement {
                    path,
                    element: (*next).to_owned(),
                }),
                Some(Value::Table(table)) => {
                    set(inner, &format!("{path}.{next}"), table, further, node)
                }
                _ => Err(Problem::UnknownElement {
                    kind: (*name).to_owned(),
                    element: (*next).to_owned(),
                    known: names,
                }),
            }
        }
        _ => Err(Problem::NoTable {
            path,
            below: (*next).to_owned(),
        }),
    }
}

/// The name of an element of a list, or its default name.
fn name_of(list: &str, index: usize, node: &Node) -> String {
    if let Value::Table(table) = &node.value
        && let Some(Node {
            value: Value::Text(name),
            ..
        }) = table.get("name")
    {
        return name.clone();
    }
    default_name(list, index)
}
