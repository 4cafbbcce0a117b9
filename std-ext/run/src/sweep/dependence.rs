//! Last numbers of runs over a key that varies over numbers, and points where two such curves cross.

use super::{Case, Swept};
use crate::plots::PublishedCurve;
use crate::run::End;
use crate::series::SeriesTable;
use crate::six::Six;

/// Last numbers of a column over a key: a curve for each combination of the other values.
#[derive(Clone, Debug, PartialEq)]
pub struct Dependence {
    /// The shortened key.
    pub key: String,
    /// The column.
    pub column: String,
    /// The other values of each curve that are not common to all runs, and its points by rising value of
    /// the key. Runs that did not reach their end have the number NaN.
    pub curves: Vec<(String, Vec<[f64; 2]>)>,
    /// Points of runs that ended without an equilibrium that can be trusted, each with the number of its
    /// curve.
    pub unresolved: Vec<(usize, Vec<[f64; 2]>)>,
}

/// A point where two curves have the same number.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    /// The names of the curves.
    pub names: [String; 2],
    /// The value of the key, and the number of the column.
    pub at: [f64; 2],
}

/// Number of common points of two curves through which a crossing is interpolated.
const POINTS: usize = 4;

impl Swept {
    /// The dependences of a column on each key with two or more values, all of which are numbers.
    pub fn dependences(&self, column: &str) -> Vec<Dependence> {
        let over = |at: usize| {
            let numbers = self
                .cases
                .iter()
                .map(|(case, _)| case.values[at].parse::<f64>());
            let numbers: Vec<f64> = numbers.collect::<Result<_, _>>().ok()?;
            let varies = numbers.iter().any(|number| *number != numbers[0]);
            (varies && numbers.iter().all(|number| number.is_finite()))
                .then(|| self.over(at, column))
        };
        (0..self.keys.len()).filter_map(over).collect()
    }

    fn over(&self, at: usize, column: &str) -> Dependence {
        let mut curves: Vec<(String, Vec<[f64; 2]>)> = Vec::new();
        let mut unresolved: Vec<(usize, Vec<[f64; 2]>)> = Vec::new();
        for (case, ended) in self.ended() {
            let number = match ended.end {
                End::Converged | End::Completed => ended.last(column),
                _ => f64::NAN,
            };
            let value = case.values[at].parse().unwrap_or(f64::NAN);
            let name = self.legend(case, Some(at));
            let known = curves.iter().position(|(known, _)| *known == name);
            let curve = known.unwrap_or_else(|| {
                curves.push((name, Vec::new()));
                curves.len() - 1
            });
            curves[curve].1.push([value, number]);
            if let End::Unresolved | End::Stagnated | End::IterationLimit = ended.end {
                let point = [value, ended.last(column)];
                match unresolved.iter_mut().find(|(known, _)| *known == curve) {
                    Some((_, points)) => points.push(point),
                    None => unresolved.push((curve, vec![point])),
                }
            }
        }
        for (_, points) in &mut curves {
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        }
        Dependence {
            key: self.keys[at].clone(),
            column: column.to_owned(),
            curves,
            unresolved,
        }
    }

    /// The values of a run that are not common to all runs, apart from that of one key.
    pub(super) fn legend(&self, case: &Case, without: Option<usize>) -> String {
        let values = case.values.iter().enumerate();
        let varies = |&(at, value): &(usize, &String)| {
            let mut cases = self.cases.iter();
            let told = self.cases.len() == 1 || cases.any(|(other, _)| other.values[at] != *value);
            told && Some(at) != without
        };
        let told = values.filter(varies).map(|(_, value)| value.as_str());
        Vec::from_iter(told).join(", ")
    }
}

impl Dependence {
    /// The points where curves cross, between two values of the key that both curves have, by a cubic
    /// through the differences at the nearest four.
    pub fn crossings(&self) -> Vec<Crossing> {
        let mut found = Vec::new();
        for (k, (name, first)) in self.curves.iter().enumerate() {
            for (other, second) in &self.curves[k + 1..] {
                let names = [name.clone(), other.clone()];
                let common: Vec<[f64; 3]> = first
                    .iter()
                    .filter_map(|&[x, a]| {
                        let [_, b] = second.iter().find(|point| point[0] == x)?;
                        (a.is_finite() && b.is_finite()).then_some([x, a, *b])
                    })
                    .collect();
                for (at, pair) in common.windows(2).enumerate() {
                    let [before, after] = [pair[0], pair[1]].map(|[_, a, b]| b - a);
                    // A crossing at a point belongs to the interval before it.
                    if before == 0.0 || before * after > 0.0 {
                        continue;
                    }
                    let start = (at + 1).saturating_sub(POINTS / 2);
                    let start = start.min(common.len().saturating_sub(POINTS));
                    let near = &common[start..common.len().min(start + POINTS)];
                    let x = root(near, [pair[0][0], pair[1][0]], before);
                    found.push(Crossing {
                        names: names.clone(),
                        at: [x, interpolated(near, x, |[_, a, _]| a)],
                    });
                }
            }
        }
        found
    }

    /// The points of a curve as a table.
    pub(super) fn table(&self, points: &[[f64; 2]]) -> SeriesTable {
        SeriesTable {
            columns: vec![self.key.clone(), self.column.clone()],
            rows: points.iter().map(|point| point.to_vec()).collect(),
        }
    }

    /// A mark at each crossing.
    pub(super) fn marks(&self) -> Vec<PublishedCurve> {
        let mark = |crossing: Crossing| PublishedCurve {
            name: format!("crossing at {}", Six(crossing.at[0])),
            points: vec![crossing.at],
        };
        self.crossings().into_iter().map(mark).collect()
    }
}

/// The polynomial through some numbers of points, at x: Lagrange's formula.
fn interpolated(points: &[[f64; 3]], x: f64, number: impl Fn([f64; 3]) -> f64) -> f64 {
    let term = |point: &[f64; 3]| {
        let others = points.iter().filter(|other| other[0] != point[0]);
        let factors = others.map(|other| (x - other[0]) / (point[0] - other[0]));
        number(*point) * factors.product::<f64>()
    };
    points.iter().map(term).sum()
}

/// The zero of the polynomial through the differences, in an interval at the start of which it has a sign.
fn root(points: &[[f64; 3]], [mut low, mut high]: [f64; 2], sign: f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if interpolated(points, middle, |[_, a, b]| b - a) * sign > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
