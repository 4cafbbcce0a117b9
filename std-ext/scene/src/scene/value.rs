//! TOML values with their origins.

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
    /// A value of a type that no scene has, named with an article.
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
pub(super) const NOTHING: &str = "nothing";

impl Table {
    pub(super) fn get(&self, key: &str) -> Option<&Node> {
        let found = self.entries.iter().find(|entry| entry.key == key);
        found.map(|entry| &entry.node)
    }

    /// The value of a key; if there is none, inserts a placeholder with this `origin`.
    pub(super) fn get_or_insert(&mut self, key: &str, origin: &Origin) -> &mut Node {
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
    /// The name of its type, with an article.
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

    pub(super) fn new(value: &DeValue<'_>, origin: &impl Fn(Range<usize>) -> Origin) -> Self {
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
    /// Whether a text in this value fulfils a condition.
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
    /// Whether a text in this table fulfils a condition.
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

/// The default name of a surface, or of another element of a list.
pub(super) fn default_name(list: &str, index: usize) -> String {
    format!("{list}-{}", index + 1)
}
