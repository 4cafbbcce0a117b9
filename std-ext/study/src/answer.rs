//! The method that reaches an accuracy in the shortest time, decided from measured rows by a fixed
//! rule.

use crate::method::AnyMethod;
use crate::scalar::Scalar;
use crate::study::{Quantity, Row};

/// The norm of the error of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Norm {
    /// The largest over the vertices.
    Max,
    /// The area-weighted mean.
    Mean,
}

impl Norm {
    /// Both norms, the stricter one first.
    pub const ALL: [Self; 2] = [Self::Max, Self::Mean];

    /// The error of a row in this norm.
    pub fn of(self, row: &Row) -> f64 {
        match self {
            Self::Max => row.max,
            Self::Mean => row.mean,
        }
    }

    /// `at every vertex` or `on average`.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Max => "at every vertex",
            Self::Mean => "on average",
        }
    }

    /// `max` or `mean`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Max => "max",
            Self::Mean => "mean",
        }
    }
}

/// A question: quantity, norm and accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Question<'a> {
    /// The mesh family's name.
    pub family: &'a str,
    /// The quantity that has to be accurate.
    pub quantity: Quantity,
    /// The norm of the error.
    pub norm: Norm,
    /// The largest allowed error, relative to the largest exact value.
    pub target: f64,
    /// The method in question; `None` for all methods.
    pub method: Option<AnyMethod>,
}

/// Time of one evaluation of the whole mesh.
pub fn seconds(row: &Row) -> f64 {
    1e-9 * row.ns_per_vertex * row.vertices as f64
}

/// The row with the shortest evaluation that reaches the target; none if no row does.
///
/// A row reaches the target if its error is at most the allowed one, and if the same method in f64
/// also reaches the target on every finer mesh of the study: an error that grows under refinement
/// was small by chance. (Without f64 among the rows, the number type of the row is used.)
pub fn cheapest<'a>(rows: &'a [Row], question: &Question<'a>) -> Option<&'a Row> {
    let reaching = asked(rows, question)
        .filter(|row| question.norm.of(row) <= question.target && is_kept(rows, row, question));
    reaching.min_by(|a, b| seconds(a).total_cmp(&seconds(b)))
}

/// The row with the smallest error, however long it takes.
pub fn most_accurate<'a>(rows: &'a [Row], question: &Question<'a>) -> Option<&'a Row> {
    asked(rows, question).min_by(|a, b| question.norm.of(a).total_cmp(&question.norm.of(b)))
}

fn asked<'a>(rows: &'a [Row], question: &Question<'a>) -> impl Iterator<Item = &'a Row> {
    let Question {
        family,
        quantity,
        method,
        ..
    } = *question;
    rows.iter().filter(move |row| {
        row.quantity == quantity
            && row.family == family
            && method.is_none_or(|method| row.method == method)
    })
}

/// Whether all finer meshes reach the target, too.
fn is_kept(rows: &[Row], row: &Row, question: &Question<'_>) -> bool {
    let same = |scalar: Scalar| {
        asked(rows, question)
            .filter(move |other| other.method == row.method && other.scalar == scalar)
    };
    let scalar = match same(Scalar::F64).next() {
        Some(_) => Scalar::F64,
        None => row.scalar,
    };
    same(scalar)
        .filter(|finer| finer.vertices > row.vertices)
        .all(|finer| question.norm.of(finer) <= question.target)
}

/// The method that answers all questions in the shortest total time.
#[derive(Clone, Debug)]
pub struct Recommended<'a> {
    /// The method.
    pub method: AnyMethod,
    /// The norm in which it reaches the target.
    pub norm: Norm,
    /// The row that answers each question.
    pub rows: Vec<&'a Row>,
}

impl<'a> Recommended<'a> {
    /// The method that reaches the target for every one of these quantities on every mesh family of the study, at
    /// every vertex or, if none does, on average; `None` if no method reaches it.
    pub fn of(rows: &'a [Row], quantities: &[Quantity], target: f64) -> Option<Self> {
        let methods = each(rows.iter().map(|row| row.method));
        let families = each(rows.iter().map(|row| row.family));
        Norm::ALL.into_iter().find_map(|norm| {
            let answers = |&method: &AnyMethod| {
                let questions = quantities.iter().flat_map(|&quantity| {
                    families.iter().map(move |&family| Question {
                        family,
                        quantity,
                        norm,
                        target,
                        method: Some(method),
                    })
                });
                questions
                    .map(|question| cheapest(rows, &question))
                    .collect::<Option<Vec<_>>>()
            };
            let cost = |rows: &[&Row]| rows.iter().map(|row| seconds(row)).sum::<f64>();
            let found = methods
                .iter()
                .filter_map(|method| Some((method, answers(method)?)));
            let (&method, rows) = found.min_by(|(_, a), (_, b)| cost(a).total_cmp(&cost(b)))?;
            Some(Self { method, norm, rows })
        })
    }

    /// The row with the most vertices, from which on the target is reached everywhere.
    pub fn largest(&self) -> Option<&'a Row> {
        self.rows.iter().copied().max_by_key(|row| row.vertices)
    }

    /// Whether a curve of this method in this number type answers a question.
    pub fn is_of(&self, method: AnyMethod, scalar: Scalar) -> bool {
        self.method == method && self.rows.iter().any(|row| row.scalar == scalar)
    }
}

/// Each value once, in the order of its first mention.
pub(crate) fn each<V: PartialEq>(values: impl Iterator<Item = V>) -> Vec<V> {
    let mut seen = Vec::new();
    for value in values {
        if !seen.contains(&value) {
            seen.push(value);
        }
    }
    seen
}
