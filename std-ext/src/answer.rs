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

/// The method that answers all questions in the shortest total time, with its row for each question;
/// `None` if no method answers all of them.
pub fn for_everything<'a>(
    rows: &'a [Row],
    questions: &[Question<'a>],
) -> Option<(AnyMethod, Vec<&'a Row>)> {
    let mut methods: Vec<AnyMethod> = Vec::new();
    for row in rows {
        if !methods.contains(&row.method) {
            methods.push(row.method);
        }
    }
    let answers = methods.into_iter().filter_map(|method| {
        let answers = questions.iter().map(|question| {
            let method = Some(method);
            cheapest(
                rows,
                &Question {
                    method,
                    ..*question
                },
            )
        });
        Some((method, answers.collect::<Option<Vec<_>>>()?))
    });
    let cost = |answers: &[&Row]| answers.iter().map(|row| seconds(row)).sum::<f64>();
    answers.min_by(|(_, a), (_, b)| cost(a).total_cmp(&cost(b)))
}
