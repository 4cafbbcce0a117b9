//! Curvatures and force densities with error bars: of jets that choose their scale, and of other
//! methods by comparison with these.

use crate::io::{PointField, PointValues};
use crate::method::Fields;
use crate::noise;
use helfrich::{AdaptiveJet, Estimate, Finding, Measured, Noise, Real, Surface, Verdict};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_2_PI};

/// Curvatures and force densities at every vertex of a surface, with error bars.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// The results, in the order of the vertices.
    pub vertices: Vec<Measured<f64>>,
}

/// A quantity at every vertex; NaN where it is not known.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name in files.
    pub name: &'static str,
    /// Its values.
    pub values: ColumnValues,
}

/// The values of a [`Column`].
#[derive(Clone, Debug, PartialEq)]
pub enum ColumnValues {
    /// One number per vertex.
    Scalars(Vec<f64>),
    /// One vector per vertex.
    Vectors(Vec<[f64; 3]>),
    /// One verdict per vertex.
    Verdicts(Vec<Verdict>),
}

/// The results of a method as columns, and further columns, in numbers alone, as files for VTK have them: verdicts are
/// numbered in their order, from clean to unknown.
pub fn in_numbers<T: Real>(fields: &Fields<T>, columns: &[Column]) -> Vec<Column> {
    let number = |value: T| value.to_f64().unwrap_or(f64::NAN);
    let vectors = |of: &mut dyn Iterator<Item = [T; 3]>| {
        ColumnValues::Vectors(of.map(|vector| vector.map(number)).collect())
    };
    let numbers = |values: &[Option<T>]| {
        let values = values.iter().map(|value| value.map_or(f64::NAN, number));
        ColumnValues::Scalars(values.collect())
    };
    let areas = fields.area.iter().map(|&area| number(area));
    let densities = fields.force_density.iter();
    let own = [
        ("area", ColumnValues::Scalars(areas.collect())),
        ("normal", vectors(&mut fields.normal.iter().copied())),
        ("H", numbers(&fields.mean)),
        ("K", numbers(&fields.gaussian)),
        ("LapH", numbers(&fields.laplacian_of_mean)),
        (
            "f",
            vectors(&mut densities.map(|density| density.unwrap_or([T::nan(); 3]))),
        ),
    ];
    let own = own.map(|(name, values)| Column { name, values });
    let others = columns.iter().map(|Column { name, values }| Column {
        name,
        values: match values {
            ColumnValues::Verdicts(verdicts) => {
                let numbers = verdicts.iter().map(|&verdict| f64::from(verdict as u8));
                ColumnValues::Scalars(numbers.collect())
            }
            values => values.clone(),
        },
    });
    own.into_iter().chain(others).collect()
}

impl Column {
    /// The column as a field of a file; `None` for verdicts, which [`in_numbers`] makes numbers.
    pub fn as_field(&self) -> Option<PointField<'_>> {
        let values = match &self.values {
            ColumnValues::Scalars(values) => PointValues::Scalars(values),
            ColumnValues::Vectors(values) => PointValues::Vectors(values),
            ColumnValues::Verdicts(_) => return None,
        };
        let name = self.name;
        Some(PointField { name, values })
    }
}

/// The word for a verdict in files and messages.
pub const fn verdict_name(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Clean => "clean",
        Verdict::Noise => "noise",
        Verdict::Unresolved => "unresolved",
        Verdict::OneSided => "one-sided",
        Verdict::Unknown => "unknown",
    }
}

/// The words for verdicts other than clean, each with its bit in flags of vertices. They come after the bits
/// of findings ([`Finding::bit`]), with room for more of these, except for the one that is a finding, too.
pub const VERDICT_BITS: [(&str, u32); 4] = [
    (verdict_name(Verdict::Noise), 1 << 24),
    (
        verdict_name(Verdict::Unresolved),
        Finding::Unresolved { vertex: 0 }.bit(),
    ),
    (verdict_name(Verdict::OneSided), 1 << 25),
    (verdict_name(Verdict::Unknown), 1 << 26),
];

/// The bit of a verdict among [`VERDICT_BITS`]; 0 for clean vertices.
pub fn verdict_bit(verdict: Verdict) -> u32 {
    let name = verdict_name(verdict);
    let known = VERDICT_BITS.iter().find(|(known, _)| *known == name);
    known.map_or(0, |&(_, bit)| bit)
}

/// The principal curvatures `H ± √(H² − K)`, k₁ ≥ k₂; both are H where K exceeds H².
pub fn principal_curvatures(mean: f64, gaussian: f64) -> [f64; 2] {
    let apart = (mean * mean - gaussian).max(0.0).sqrt();
    [mean + apart, mean - apart]
}

/// The curvedness `√((k₁² + k₂²)/2)`, in 1/length, and the shape index `(2/π) arctan((k₁ + k₂)/(k₁ − k₂))` of
/// principal curvatures k₁ ≥ k₂: 1 on a sphere seen from outside, ½ on a cylinder, 0 on a minimal surface, −1 on a
/// sphere seen from inside. A plane has none, and it is NaN.
///
/// J. J. Koenderink and A. J. van Doorn, Image Vis. Comput. 10 (1992) 557, with normals that point outward.
pub fn curvedness_and_shape_index([larger, smaller]: [f64; 2]) -> [f64; 2] {
    let curvedness = larger.hypot(smaller) * FRAC_1_SQRT_2;
    if curvedness == 0.0 {
        return [0.0, f64::NAN];
    }
    let index = FRAC_2_PI * (larger + smaller).atan2(larger - smaller);
    [curvedness, index]
}

/// Error bars of curvedness and shape index: the largest changes of length and angle of the vector (k₁, k₂) within
/// the bars of its components. That of the shape index is infinite where a plane is within them.
fn bars_of_shape(principal: [f64; 2], [larger, smaller]: [f64; 2]) -> [f64; 2] {
    let [curvedness, _] = curvedness_and_shape_index(principal);
    let bar = larger.hypot(smaller) * FRAC_1_SQRT_2;
    let is_plane = bar >= curvedness;
    let angle = FRAC_2_PI * (bar / curvedness).asin();
    [bar, if is_plane { f64::INFINITY } else { angle }]
}

/// The bar of a value; infinite if the value is known and the bar is not.
fn known_bar(value: f64, bar: f64) -> f64 {
    match value.is_finite() && bar.is_nan() {
        true => f64::INFINITY,
        false => bar,
    }
}

fn known(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

impl Measurement {
    /// Measures a surface on all threads. `watch` is called with the fraction of the work that is done;
    /// `None` if it returned false.
    pub fn new(
        surface: Surface<'_, f64>,
        jet: &AdaptiveJet<f64>,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Option<Self> {
        let vertices = noise::measured(jet, surface, watch)?;
        Some(Self { vertices })
    }

    /// The values in the form of a method's results with a bending modulus: f is κ times that of the
    /// measurement, and Δ_S H follows from f, H and K.
    pub fn fields(&self, modulus: f64) -> Fields<f64> {
        let all = self.vertices.iter();
        let of = |value: fn(&Measured<f64>) -> f64| {
            let values = self.vertices.iter().map(|at| known(value(at)));
            values.collect()
        };
        Fields {
            area: all.clone().map(|at| at.area).collect(),
            normal: all.clone().map(|at| at.normal).collect(),
            mean: of(|at| at.mean.value),
            gaussian: of(|at| at.gaussian.value),
            laplacian_of_mean: of(|at| {
                let (mean, gaussian) = (at.mean.value, at.gaussian.value);
                0.5 * at.force_density.value - 2.0 * mean * (mean * mean - gaussian)
            }),
            force_density: all
                .map(|at| {
                    let density = known(modulus * at.force_density.value)?;
                    Some(at.normal.map(|component| density * component))
                })
                .collect(),
        }
    }

    /// Principal curvatures, curvedness, shape index and error bars of a method's results with a bending modulus: the distance
    /// from the measurement plus the error bar of the measurement. For [`Self::fields`] they are the
    /// error bars of the measurement itself.
    pub fn columns<T: Real>(&self, fields: &Fields<T>, modulus: f64) -> Vec<Column> {
        let number = |value: Option<T>| value.and_then(|value| value.to_f64()).unwrap_or(f64::NAN);
        let mean = |vertex: usize| number(fields.mean[vertex]);
        let gaussian = |vertex: usize| number(fields.gaussian[vertex]);
        let principal = |which: usize| {
            self.each(|vertex, at| {
                let (mean, own) = (mean(vertex), at.mean.value);
                if mean == own {
                    return at.principal[which].value;
                }
                principal_curvatures(mean, gaussian(vertex))[which]
            })
        };
        let bars = |values: &[f64], of: &dyn Fn(&Measured<f64>) -> Estimate<f64>| {
            self.each(|vertex, at| {
                let estimate = of(at);
                let bar = (values[vertex] - estimate.value).abs() + estimate.error;
                known_bar(values[vertex], bar)
            })
        };
        let [larger, smaller] = [principal(0), principal(1)];
        let force = self.each(|vertex, at| {
            let Some(density) = fields.force_density[vertex] else {
                return f64::NAN;
            };
            let off = (0..3).map(|axis| {
                let own = modulus * at.force_density.value * at.normal[axis];
                number(Some(density[axis])) - own
            });
            let off = off.map(|x| x * x).sum::<f64>().sqrt();
            let size = density.iter().map(|&f| number(Some(f)));
            known_bar(size.sum(), off + modulus * at.force_density.error)
        });
        let scalars = |name, values| Column {
            name,
            values: ColumnValues::Scalars(values),
        };
        let of_larger = bars(&larger, &|at| at.principal[0]);
        let of_smaller = bars(&smaller, &|at| at.principal[1]);
        let shape = |which: usize| {
            self.each(|v, _| curvedness_and_shape_index([larger[v], smaller[v]])[which])
        };
        let of_shape = |which: usize| {
            self.each(|v, _| {
                bars_of_shape([larger[v], smaller[v]], [of_larger[v], of_smaller[v]])[which]
            })
        };
        let [curvedness, shape_index] = [shape(0), shape(1)];
        let [of_curvedness, of_shape_index] = [of_shape(0), of_shape(1)];
        vec![
            scalars("H_error", bars(&self.each(|v, _| mean(v)), &|at| at.mean)),
            scalars(
                "K_error",
                bars(&self.each(|v, _| gaussian(v)), &|at| at.gaussian),
            ),
            scalars("f_error", force),
            scalars("k1_error", of_larger),
            scalars("k2_error", of_smaller),
            scalars("k1", larger),
            scalars("k2", smaller),
            scalars("curvedness", curvedness),
            scalars("curvedness_error", of_curvedness),
            scalars("shape_index", shape_index),
            scalars("shape_index_error", of_shape_index),
            scalars("sigma", self.each(|_, at| at.deviation)),
            Column {
                name: "verdict",
                values: ColumnValues::Verdicts(self.vertices.iter().map(|at| at.verdict).collect()),
            },
        ]
    }

    /// Results of jets only: directions of k₁ and k₂, the gradient of H, the derivatives of k₁ and k₂
    /// along their directions, and degree and number of neighbours of the fits for each quantity.
    pub fn columns_of_jets(&self) -> Vec<Column> {
        let none = [f64::NAN; 3];
        let direction = |which: usize| {
            let of = |at: &Measured<f64>| at.directions.map_or(none, |both| both[which]);
            ColumnValues::Vectors(self.vertices.iter().map(of).collect())
        };
        let extremality = |which: usize| {
            let of = |at: &Measured<f64>| at.extremalities.map_or(f64::NAN, |both| both[which]);
            ColumnValues::Scalars(self.vertices.iter().map(of).collect())
        };
        let gradient = self.vertices.iter().map(|at| at.gradient_of_mean);
        let degrees = |of: fn(&Measured<f64>) -> Estimate<f64>| {
            ColumnValues::Scalars(self.each(|_, at| f64::from(of(at).scale.degree)))
        };
        let neighbours = |of: fn(&Measured<f64>) -> Estimate<f64>| {
            ColumnValues::Scalars(self.each(|_, at| f64::from(of(at).scale.neighbours)))
        };
        let columns = [
            ("direction1", direction(0)),
            ("direction2", direction(1)),
            ("gradient_H", ColumnValues::Vectors(gradient.collect())),
            ("extremality1", extremality(0)),
            ("extremality2", extremality(1)),
            ("H_degree", degrees(|at| at.mean)),
            ("H_neighbours", neighbours(|at| at.mean)),
            ("K_degree", degrees(|at| at.gaussian)),
            ("K_neighbours", neighbours(|at| at.gaussian)),
            ("f_degree", degrees(|at| at.force_density)),
            ("f_neighbours", neighbours(|at| at.force_density)),
        ];
        columns.map(|(name, values)| Column { name, values }).into()
    }

    /// Findings at the vertices, by the causes of their verdicts.
    pub fn findings(&self) -> Vec<Finding> {
        let all = (0..).zip(&self.vertices);
        all.filter_map(|(vertex, at)| at.cause?.finding(vertex))
            .collect()
    }

    /// Number of vertices with a verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        let is_same = |at: &&Measured<f64>| at.verdict == verdict;
        self.vertices.iter().filter(is_same).count()
    }

    /// The median of σ on the surface that was measured.
    pub fn noise(&self, surface: Surface<'_, f64>) -> Noise<f64> {
        Noise::of_deviations(surface, &mut self.each(|_, at| at.deviation))
    }

    fn each(&self, of: impl Fn(usize, &Measured<f64>) -> f64) -> Vec<f64> {
        self.vertices
            .iter()
            .enumerate()
            .map(|(vertex, at)| of(vertex, at))
            .collect()
    }
}
