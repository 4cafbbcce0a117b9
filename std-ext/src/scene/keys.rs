//! The table of all keys of a scene: their forms, dimensions, ranges and meanings.

mod driver;
mod output;
mod surface;

use super::problem::Problem;
use super::units::Dimension;
use driver::DRIVER;
use output::OUTPUT;
pub(super) use surface::WELD;
use surface::{OBSTACLE, SURFACE};

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

/// Keys that a table has if its `kind` is this one. Keys that no kind names belong to all kinds.
#[derive(Debug)]
pub(super) struct Kind {
    pub(super) name: &'static str,
    pub(super) required: &'static [&'static str],
    pub(super) optional: &'static [&'static str],
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
            Self::Above(least) => value > least,
        }
    }

    /// In words, behind `a number`.
    pub(super) fn words(self) -> String {
        match self {
            Self::Any => "of any size".to_owned(),
            Self::NotZero => "other than 0".to_owned(),
            Self::Positive => "above 0".to_owned(),
            Self::NotNegative => "of 0 or above".to_owned(),
            Self::Fraction => "above 0 and at most 1".to_owned(),
            Self::Half => "above 0 and at most 0.5".to_owned(),
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

impl Kind {
    pub(super) fn has(&self, name: &str) -> bool {
        self.required.contains(&name) || self.optional.contains(&name)
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

/// The keys of two lists, one after the other; N is the sum of their numbers.
const fn joined<const N: usize>(first: &[Key], second: &[Key]) -> [Key; N] {
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

/// The names of the kinds of a table, as its key `kind` has them.
fn kinds(keys: &Keys) -> Vec<&'static str> {
    keys.kinds.iter().map(|kind| kind.name).collect()
}

pub(super) const NUMBER: Form = Form::Number(Dimension::NONE, Range::Positive);

pub(super) const fn positive(dimension: Dimension) -> Form {
    Form::Number(dimension, Range::Positive)
}

pub(super) const fn any(dimension: Dimension) -> Form {
    Form::Number(dimension, Range::Any)
}

pub(super) static SCENE: Keys = plain(&[
    optional("title", Form::Text, "Description of the scene in one line."),
    required(
        "units",
        Form::Choice(|| vec!["micro", "none"]),
        "Units of plain numbers: \"micro\" is µm, pN and s, hence pN·µm = 1e-18 J, pN/µm = µN/m, \
         pN/µm² = Pa; \"none\" is numbers without units.",
    ),
    optional(
        "temperature",
        NUMBER,
        "Temperature in kelvin, by which \"20 kT\" is an energy; by default 298.15.",
    ),
    required(
        "surface",
        Form::Tables(&SURFACE),
        "A surface and the effects that act on it; absent effects are off.",
    ),
    optional(
        "interaction",
        Form::Tables(&INTERACTION),
        "What acts between surfaces.",
    ),
    optional(
        "obstacle",
        Form::Tables(&OBSTACLE),
        "A closed body at rest in the fluid; for the driver \"lattice-boltzmann\".",
    ),
    required(
        "driver",
        Form::Table(&DRIVER),
        "What moves the surfaces, and when the run ends.",
    ),
    optional(
        "output",
        Form::Table(&OUTPUT),
        "What is written, and how often.",
    ),
]);

static INTERACTION: Keys = plain(&[
    required(
        "kind",
        Form::Choice(|| vec!["repulsion"]),
        "The kind of interaction.",
    ),
    required(
        "strength",
        positive(Dimension::REPULSION),
        "k in the energy per area w(d) = k r_c²/4 (1 − s²)³/s² of surfaces at a distance d, s = \
         d/r_c. The pressure k r_c/2 (1 − s²)² (1 + 2s²)/s³ grows without bound as surfaces \
         approach each other. If k r_c is about the applied pressure, they rest at two thirds of \
         r_c.",
    ),
    required(
        "cutoff",
        positive(Dimension::LENGTH),
        "Distance r_c beyond which there is no force: a few node spacings on a lattice, and less \
         than the gaps of interest.",
    ),
    optional(
        "between",
        Form::Pair,
        "Names of two surfaces; by default every pair interacts, and in a periodic box every \
         surface with its own images. The same name twice: a surface with its own images only.",
    ),
]);
