//! TOML values with their origins, and overrides.

use super::keys::{Form, Key, Keys};
use super::problem::Problem;
use serde::Serialize;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The origin of a value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// No particular place: the problem concerns the whole file.
    File,
    /// Bytes of the scene's text.
    Text(Range<usize>),
    /// An override, counted from 0.
    Override(usize),
}

/// The origin of each key of a scene, by its path: `surface.0.bending.modulus`.
#[derive(Clone, Debug, Default)]
pub(super) struct Origins(BTreeMap<String, Origin>);

impl Origins {
    /// The origin of a path, or of the nearest enclosing table.
    pub(super) fn of(&self, path: &str) -> Origin {
        let mut path = path;
        loop {
            if let Some(origin) = self.0.get(path) {
                return origin.clone();
            }
            match path.rsplit_once('.') {
                Some((around, _)) => path = around,
                None => return Origin::File,
            }
        }
    }

    /// Whether a path was written.
    pub(super) fn has(&self, path: &str) -> bool {
        self.0.contains_key(path)
    }

    pub(super) fn new(table: &Table) -> Self {
        let mut origins = Self::default();
        origins.collect("", table);
        origins
    }

    fn collect(&mut self, prefix: &str, table: &Table) {
        for entry in &table.entries {
            let path = format!("{prefix}{}", entry.key);
            self.add(path, &entry.node);
        }
    }

    fn add(&mut self, path: String, node: &Node) {
        match &node.value {
            Value::Table(table) => self.collect(&format!("{path}."), table),
            Value::List(list) => {
                for (index, node) in list.iter().enumerate() {
                    self.add(format!("{path}.{index}"), node);
                }
            }
            _ => {}
        }
        self.0.insert(path, node.origin.clone());
    }
}

/// A value and its origin.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) value: Value,
    pub(super) origin: Origin,
}

#[derive(Clone, Debug)]
pub(super) enum Value {
    Text(String),
    Integer(i128),
    Float(f64),
    Switch(bool),
    List(Vec<Node>),
    Table(Table),
    /// A value that no scene has, in words.
    Other(&'static str),
}

/// Keys and values.
#[derive(Clone, Debug, Default)]
pub(super) struct Table {
    pub(super) entries: Vec<Entry>,
}

#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub(super) key: String,
    /// The origin of the key itself.
    pub(super) key_origin: Origin,
    pub(super) node: Node,
}

/// The name of a missing value.
const NOTHING: &str = "nothing";

impl Table {
    pub(super) fn get(&self, key: &str) -> Option<&Node> {
        let found = self.entries.iter().find(|entry| entry.key == key);
        found.map(|entry| &entry.node)
    }

    /// The value of a key; if there is none, inserts a placeholder with this `origin`.
    fn get_or_insert(&mut self, key: &str, origin: &Origin) -> &mut Node {
        let found = self.entries.iter().position(|entry| entry.key == key);
        let at = found.unwrap_or_else(|| {
            self.entries.push(Entry {
                key: key.to_owned(),
                key_origin: origin.clone(),
                node: Node {
                    value: Value::Other(NOTHING),
                    origin: origin.clone(),
                },
            });
            self.entries.len() - 1
        });
        &mut self.entries[at].node
    }
}

impl Value {
    /// Its kind, in words with an article.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::Text(_) => "a text",
            Self::Integer(_) | Self::Float(_) => "a number",
            Self::Switch(_) => "true or false",
            Self::List(_) => "a list",
            Self::Table(_) => "a table",
            Self::Other(kind) => kind,
        }
    }

    fn new(value: &DeValue<'_>, origin: &impl Fn(Range<usize>) -> Origin) -> Self {
        match value {
            DeValue::String(text) => Self::Text(text.clone().into_owned()),
            DeValue::Integer(integer) => {
                match i128::from_str_radix(integer.as_str(), integer.radix()) {
                    Ok(value) => Self::Integer(value),
                    Err(_) => Self::Other("an integer out of range"),
                }
            }
            DeValue::Float(float) => match float.as_str().parse() {
                Ok(value) => Self::Float(value),
                Err(_) => Self::Other("no number"),
            },
            DeValue::Boolean(value) => Self::Switch(*value),
            DeValue::Datetime(_) => Self::Other("a date"),
            DeValue::Array(list) => {
                Self::List(list.iter().map(|value| Node::new(value, origin)).collect())
            }
            DeValue::Table(table) => Self::Table(Table::new(table, origin)),
        }
    }
}

impl Node {
    fn new(value: &Spanned<DeValue<'_>>, origin: &impl Fn(Range<usize>) -> Origin) -> Self {
        Self {
            value: Value::new(value.get_ref(), origin),
            origin: origin(value.span()),
        }
    }
}

impl Value {
    /// Whether a text in it is one of these.
    fn any_text(&self, is: &dyn Fn(&str) -> bool) -> bool {
        match self {
            Self::Text(text) => is(text),
            Self::List(list) => list.iter().any(|node| node.value.any_text(is)),
            Self::Table(table) => table.any_text(is),
            _ => false,
        }
    }
}

impl Table {
    /// Whether a text in it is one of these.
    pub(super) fn any_text(&self, is: &dyn Fn(&str) -> bool) -> bool {
        self.entries
            .iter()
            .any(|entry| entry.node.value.any_text(is))
    }
}

impl Table {
    pub(super) fn new(table: &DeTable<'_>, origin: &impl Fn(Range<usize>) -> Origin) -> Self {
        let entry = |(key, value): (&Spanned<Cow<'_, str>>, &Spanned<DeValue<'_>>)| Entry {
            key: key.get_ref().clone().into_owned(),
            key_origin: origin(key.span()),
            node: Node::new(value, origin),
        };
        Self {
            entries: table.iter().map(entry).collect(),
        }
    }
}

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

/// The default name of a surface, or of another element of a list.
pub(super) fn default_name(list: &str, index: usize) -> String {
    format!("{list}-{}", index + 1)
}
