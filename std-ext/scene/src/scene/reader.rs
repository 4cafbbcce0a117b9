//! Reads values that have been compared with the table of keys.

use super::check::{nonempty, number};
use super::keys::{Form, Keys, Range};
use super::units::{Dimension, Scale};
use super::value::{Node, Origin, Table, Value};

/// Reads a table whose problems have been reported. Invalid values are read as placeholders,
/// because the scene will be discarded.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reader<'a> {
    keys: &'static Keys,
    table: &'a Table,
    origin: &'a Origin,
    scale: Scale,
}

impl<'a> Reader<'a> {
    pub(super) fn new(
        keys: &'static Keys,
        table: &'a Table,
        origin: &'a Origin,
        scale: Scale,
    ) -> Self {
        Self {
            keys,
            table,
            origin,
            scale,
        }
    }

    /// The place where the table was written.
    pub(super) fn origin(&self) -> &'a Origin {
        self.origin
    }

    /// The place of a key, or of the table if the key is missing.
    pub(super) fn origin_of(&self, key: &str) -> Origin {
        let found = self.table.entries.iter().find(|entry| entry.key == key);
        found.map_or_else(
            || self.origin.clone(),
            |entry| nonempty(&entry.node.origin, &entry.key_origin).clone(),
        )
    }

    pub(super) fn has(&self, key: &str) -> bool {
        self.table.get(key).is_some()
    }

    fn form(&self, key: &str) -> Option<&'static Form> {
        let found = self.keys.find(key);
        debug_assert!(found.is_some(), "the table of keys lacks {key}");
        found.map(|key| &key.form)
    }

    fn get(&self, key: &str) -> Option<&'a Value> {
        debug_assert!(self.form(key).is_some());
        self.table.get(key).map(|node| &node.value)
    }

    pub(super) fn text(&self, key: &str) -> Option<&'a str> {
        match self.get(key)? {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    fn dimension(&self, key: &str) -> Dimension {
        fn of(form: &Form) -> Option<Dimension> {
            match form {
                Form::Number(dimension, _)
                | Form::Numbers(dimension, _)
                | Form::Vector(dimension) => Some(*dimension),
                Form::Either(forms) => forms.iter().find_map(of),
                Form::Exactly(_, form) => of(form),
                _ => None,
            }
        }
        self.form(key).and_then(of).unwrap_or(Dimension::NONE)
    }

    /// The numbers that the key allows.
    pub(super) fn range(&self, key: &str) -> Range {
        fn of(form: &Form) -> Option<Range> {
            match form {
                Form::Number(_, range) => Some(*range),
                Form::Either(forms) => forms.iter().find_map(of),
                _ => None,
            }
        }
        self.form(key).and_then(of).unwrap_or(Range::Any)
    }

    /// A number, if the key has one.
    pub(super) fn number(&self, key: &str) -> Option<f64> {
        number(self.get(key)?, self.dimension(key), self.scale).ok()
    }

    /// A required number.
    pub(super) fn needed(&self, key: &str) -> f64 {
        self.number(key).unwrap_or(f64::NAN)
    }

    /// One number or several.
    pub(super) fn numbers(&self, key: &str) -> Vec<f64> {
        match self.get(key) {
            Some(Value::List(list)) => list
                .iter()
                .filter_map(|node| number(&node.value, self.dimension(key), self.scale).ok())
                .collect(),
            _ => self.number(key).into_iter().collect(),
        }
    }

    pub(super) fn vector(&self, key: &str) -> Option<[f64; 3]> {
        self.numbers(key).try_into().ok()
    }

    pub(super) fn pair(&self, key: &str) -> Option<[f64; 2]> {
        self.numbers(key).try_into().ok()
    }

    /// Three rows of three numbers.
    pub(super) fn matrix(&self, key: &str) -> Option<[[f64; 3]; 3]> {
        let Value::List(rows) = self.get(key)? else {
            return None;
        };
        let dimension = self.dimension(key);
        let row = |row: &Node| -> Option<[f64; 3]> {
            let Value::List(entries) = &row.value else {
                return None;
            };
            let entry = |entry: &Node| number(&entry.value, dimension, self.scale).ok();
            Vec::from_iter(entries.iter().filter_map(entry))
                .try_into()
                .ok()
        };
        Vec::from_iter(rows.iter().filter_map(row)).try_into().ok()
    }

    /// Two whole numbers.
    pub(super) fn counts(&self, key: &str) -> Option<[u64; 2]> {
        let Value::List(list) = self.get(key)? else {
            return None;
        };
        let count = |node: &Node| match node.value {
            Value::Integer(count) => u64::try_from(count).ok(),
            _ => None,
        };
        Vec::from_iter(list.iter().filter_map(count))
            .try_into()
            .ok()
    }

    pub(super) fn count(&self, key: &str) -> Option<u64> {
        match self.get(key)? {
            Value::Integer(count) => u64::try_from(*count).ok(),
            _ => None,
        }
    }

    pub(super) fn switch(&self, key: &str) -> Option<bool> {
        match self.get(key)? {
            Value::Switch(value) => Some(*value),
            _ => None,
        }
    }

    pub(super) fn texts(&self, key: &str) -> Vec<&'a str> {
        let Some(Value::List(list)) = self.get(key) else {
            return Vec::new();
        };
        let text = |node: &'a Node| match &node.value {
            Value::Text(text) => Some(text.as_str()),
            _ => None,
        };
        list.iter().filter_map(text).collect()
    }

    /// The table of a key.
    pub(super) fn table(&self, key: &str) -> Option<Reader<'a>> {
        let keys = self.form(key)?.table()?;
        let entry = self.table.entries.iter().find(|entry| entry.key == key)?;
        match &entry.node.value {
            Value::Table(table) => Some(Self {
                keys,
                table,
                origin: nonempty(&entry.node.origin, &entry.key_origin),
                ..*self
            }),
            _ => None,
        }
    }

    /// The tables of a list.
    pub(super) fn tables(&self, key: &str) -> Vec<Reader<'a>> {
        let Some(Form::Tables(keys)) = self.form(key) else {
            return Vec::new();
        };
        let Some(Value::List(list)) = self.get(key) else {
            return Vec::new();
        };
        let table = |node: &'a Node| match &node.value {
            Value::Table(table) => Some(Reader {
                keys,
                table,
                origin: &node.origin,
                ..*self
            }),
            _ => None,
        };
        list.iter().filter_map(table).collect()
    }
}
