//! Keys of tables: their forms, dimensions, ranges and meanings.

use super::problem::Problem;
use super::units::Dimension;

/// The keys of a table.
#[derive(Debug)]
pub(super) struct Keys {
    pub(super) keys: &'static [Key],
    /// Groups of which exactly one key is required.
    pub(super) exactly_one: &'static [&'static [&'static str]],
    /// Groups of which at most one key is allowed.
    pub(super) at_most_one: &'static [&'static [&'static str]],
    /// The first key needs the second.
    pub(super) needs: &'static [[&'static str; 2]],
    /// Further rules for each value of the key `kind` of the table.
    pub(super) kinds: &'static [Kind],
}

/// The keys of tables of one `kind`. Keys that no kind lists belong to all kinds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kind {
    pub(super) name: &'static str,
    pub(super) keys: &'static [Key],
    /// As [`Keys::exactly_one`], for optional keys.
    pub(super) exactly_one: &'static [&'static [&'static str]],
}

/// A key.
#[derive(Clone, Copy, Debug)]
pub(super) struct Key {
    pub(super) name: &'static str,
    pub(super) form: Form,
    pub(super) presence: Presence,
    /// Its meaning, as in the schema.
    pub(super) summary: &'static str,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Presence {
    Required,
    Optional,
}

/// The form of a value.
#[derive(Clone, Copy, Debug)]
pub(super) enum Form {
    /// Any text.
    Text,
    /// A letter, then letters, digits, `-` and `_`.
    Name,
    /// The name of a file.
    File,
    /// An exact shape.
    Shape,
    /// One of these names.
    Choice(fn() -> Vec<&'static str>),
    /// A number, plain or with a unit.
    Number(Dimension, Range),
    /// One number, or a list of one or more.
    Numbers(Dimension, Range),
    /// A whole number from 0 or 1 on.
    Count(u64),
    /// true or false.
    Switch,
    /// Three numbers.
    Vector(Dimension),
    /// Three numbers that are not all 0.
    Direction,
    /// Two names of surfaces.
    Pair,
    /// A list of a fixed number of values of one form.
    Exactly(usize, &'static Form),
    /// A table.
    Table(&'static Keys),
    /// A list of tables.
    Tables(&'static Keys),
    /// A value of one of two forms with different TOML types.
    Either(&'static [Form; 2]),
}

/// Which numbers are allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Range {
    Any,
    /// Other than 0.
    NotZero,
    /// Above 0.
    Positive,
    /// 0 or above.
    NotNegative,
    /// Above 0, at most 1.
    Fraction,
    /// Above 0, at most 0.5.
    Half,
    /// From −1 to 1.
    Signed,
    /// Above this.
    Above(f64),
}

impl Range {
    pub(super) fn contains(self, value: f64) -> bool {
        match self {
            Self::Any => true,
            Self::NotZero => value != 0.0,
            Self::Positive => value > 0.0,
            Self::NotNegative => value >= 0.0,
            Self::Fraction => value > 0.0 && value <= 1.0,
            Self::Half => value > 0.0 && value <= 0.5,
            Self::Signed => value.abs() <= 1.0,
            Self::Above(least) => value > least,
        }
    }

    /// The range as a text that follows `a number`.
    pub(super) fn words(self) -> String {
        match self {
            Self::Any => "of any size".to_owned(),
            Self::NotZero => "other than 0".to_owned(),
            Self::Positive => "above 0".to_owned(),
            Self::NotNegative => "of 0 or above".to_owned(),
            Self::Fraction => "above 0 and at most 1".to_owned(),
            Self::Half => "above 0 and at most 0.5".to_owned(),
            Self::Signed => "from -1 to 1".to_owned(),
            Self::Above(least) => format!("above {least}"),
        }
    }
}

impl Form {
    /// The keys of the table, if a table is allowed here.
    pub(super) fn table(&self) -> Option<&'static Keys> {
        match self {
            Self::Table(keys) => Some(keys),
            Self::Either(forms) => forms.iter().find_map(Self::table),
            _ => None,
        }
    }
}

impl Key {
    /// The same key, required.
    pub(super) const fn required(self) -> Self {
        Self {
            presence: Presence::Required,
            ..self
        }
    }
}

impl Kind {
    pub(super) fn has(&self, name: &str) -> bool {
        self.keys.iter().any(|key| key.name == name)
    }

    /// The names of the keys that the kind requires.
    pub(super) fn required(&self) -> impl Iterator<Item = &'static str> {
        let required = |key: &&Key| key.presence == Presence::Required;
        self.keys.iter().filter(required).map(|key| key.name)
    }
}

impl Keys {
    /// The kinds that have a key; empty if all have it.
    pub(super) fn kinds_with(&self, name: &str) -> Vec<&'static str> {
        let kinds = self.kinds.iter().filter(|kind| kind.has(name));
        kinds.map(|kind| kind.name).collect()
    }

    pub(super) fn find(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().find(|key| key.name == name)
    }

    /// The problem of a key that is not in the table.
    pub(super) fn unknown(&self, around: &str, key: &str) -> Problem {
        let known = Vec::from_iter(self.keys.iter().map(|key| key.name));
        Problem::UnknownKey {
            table: around.to_owned(),
            key: key.to_owned(),
            nearest: nearest(key, &known),
            known: known.join(", "),
        }
    }
}

/// The most similar name, if there is one.
pub(super) fn nearest(name: &str, known: &[&str]) -> Option<String> {
    let name = name.to_lowercase();
    let distance = |known: &str| strsim::damerau_levenshtein(&name, &known.to_lowercase());
    let best = known.iter().min_by_key(|known| distance(known))?;
    // A substring of a long name is as good a match as a misspelt name.
    let part = |known: &&&str| name.len() >= 3 && known.to_lowercase().contains(&name);
    let near = |known: &&str| distance(known) <= 1 + name.chars().count().min(known.len()) / 4;
    if near(best) {
        return Some((*best).to_owned());
    }
    known.iter().find(part).map(|known| (*known).to_owned())
}

pub(super) const fn required(name: &'static str, form: Form, summary: &'static str) -> Key {
    Key {
        name,
        form,
        presence: Presence::Required,
        summary,
    }
}

pub(super) const fn optional(name: &'static str, form: Form, summary: &'static str) -> Key {
    Key {
        name,
        form,
        presence: Presence::Optional,
        summary,
    }
}

pub(super) const fn plain(keys: &'static [Key]) -> Keys {
    Keys {
        keys,
        exactly_one: &[],
        at_most_one: &[],
        needs: &[],
        kinds: &[],
    }
}

/// The keys of two lists, one after the other; N is their total number.
pub(super) const fn joined<const N: usize>(first: &[Key], second: &[Key]) -> [Key; N] {
    assert!(!first.is_empty() && first.len() + second.len() == N);
    let mut keys = [first[0]; N];
    let mut index = 1;
    while index < N {
        keys[index] = if index < first.len() {
            first[index]
        } else {
            second[index - first.len()]
        };
        index += 1;
    }
    keys
}

/// Number of different keys of all kinds.
pub(super) const fn count_of(kinds: &[Kind]) -> usize {
    let mut count = 0;
    let mut kind = 0;
    while kind < kinds.len() {
        let keys = kinds[kind].keys;
        let mut index = 0;
        while index < keys.len() {
            if first_with(kinds, keys[index].name) == kind {
                count += 1;
            }
            index += 1;
        }
        kind += 1;
    }
    count
}

/// The key `kind` and the keys of all kinds, each once, in the order of their first occurrence; N is
/// their number. A key that only some kinds require is optional in the whole table.
pub(super) const fn of_kinds<const N: usize>(kind: Key, kinds: &[Kind]) -> [Key; N] {
    assert!(N == 1 + count_of(kinds));
    let mut keys = [kind; N];
    let mut found = 1;
    let mut kind = 0;
    while kind < kinds.len() {
        let own = kinds[kind].keys;
        let mut index = 0;
        while index < own.len() {
            if first_with(kinds, own[index].name) == kind {
                keys[found] = Key {
                    presence: Presence::Optional,
                    ..own[index]
                };
                found += 1;
            }
            index += 1;
        }
        kind += 1;
    }
    keys
}

/// The first kind that has a key of this name.
const fn first_with(kinds: &[Kind], name: &str) -> usize {
    let mut kind = 0;
    while kind < kinds.len() {
        let keys = kinds[kind].keys;
        let mut index = 0;
        while index < keys.len() {
            if are_equal(keys[index].name, name) {
                return kind;
            }
            index += 1;
        }
        kind += 1;
    }
    kinds.len()
}

const fn are_equal(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut index = 0;
    while index < a.len() && index < b.len() && a[index] == b[index] {
        index += 1;
    }
    index == a.len() && index == b.len()
}

/// The names of the kinds of a table, as its key `kind` has them.
pub(super) fn kinds(keys: &Keys) -> Vec<&'static str> {
    keys.kinds.iter().map(|kind| kind.name).collect()
}

pub(super) const NUMBER: Form = Form::Number(Dimension::NONE, Range::Positive);

pub(super) const fn positive(dimension: Dimension) -> Form {
    Form::Number(dimension, Range::Positive)
}

pub(super) const fn any(dimension: Dimension) -> Form {
    Form::Number(dimension, Range::Any)
}
