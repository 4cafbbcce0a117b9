//! Accuracy and cost of bending methods on exact shapes: data; [`crate::report`] shows it.

use crate::generate::{self, AnyShape, Family, GenerateError, GeneratedMesh, generate};
use crate::method::{BendingMethod, Evaluated, Evaluator, Fields};
use crate::scalar::{HeldPositions, Scalar};
use helfrich::shapes::{ExactPoint, Shape};
use helfrich::{Real, SurfaceError};
use serde::Serialize;
use std::time::{Duration, Instant};

/// What is compared with its exact value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
pub enum Quantity {
    /// Mean curvature.
    #[serde(rename = "H")]
    Mean,
    /// Gaussian curvature.
    #[serde(rename = "K")]
    Gaussian,
    /// Laplacian of the mean curvature.
    #[serde(rename = "LapH")]
    LaplacianOfMean,
    /// Force density, as a vector.
    #[serde(rename = "f")]
    ForceDensity,
}

impl Quantity {
    /// Every quantity, from the second to the fourth derivative.
    pub const ALL: [Self; 4] = [
        Self::Mean,
        Self::Gaussian,
        Self::LaplacianOfMean,
        Self::ForceDensity,
    ];

    /// Whether a method says anything of this quantity.
    pub fn is_defined_by(self, method: BendingMethod) -> bool {
        match method {
            BendingMethod::KantorNelson => self == Self::ForceDensity,
            BendingMethod::GompperKroll | BendingMethod::Juelicher => {
                matches!(self, Self::Mean | Self::ForceDensity)
            }
            BendingMethod::Loop => self != Self::LaplacianOfMean,
            // Those in strong form compute everything.
            BendingMethod::Meyer
            | BendingMethod::Belkin
            | BendingMethod::Farutin
            | BendingMethod::J4
            | BendingMethod::J6
            | BendingMethod::Jet => true,
        }
    }

    /// The symbol: `H`, `K`, `LapH` or `f`.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Mean => "H",
            Self::Gaussian => "K",
            Self::LaplacianOfMean => "LapH",
            Self::ForceDensity => "f",
        }
    }
}

/// What a study covers: every combination of what is listed.
#[derive(Clone, Debug)]
pub struct Study {
    /// The exact shape.
    pub shape: AnyShape,
    /// The mesh families.
    pub families: Vec<Family>,
    /// How many vertices the meshes have, in any order; each number counts once.
    pub vertices: Vec<usize>,
    /// The methods.
    pub methods: Vec<BendingMethod>,
    /// The number types.
    pub scalars: Vec<Scalar>,
    /// Bending modulus κ.
    pub modulus: f64,
    /// Seed of the random meshes.
    pub seed: u64,
}

/// One quantity of one method on one mesh.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The exact shape's name.
    pub shape: &'static str,
    /// The mesh family's name.
    pub family: &'static str,
    /// How many vertices the mesh has.
    pub vertices: usize,
    /// The method.
    pub method: BendingMethod,
    /// The number type.
    pub scalar: Scalar,
    /// What is compared.
    pub quantity: Quantity,
    /// Largest error over the vertices, relative to the largest exact value, or to what the
    /// shape's size gives (1/R³, κ/R³) where the exact value vanishes. Infinite, which JSON writes
    /// as null, if a vertex has no result.
    pub max: f64,
    /// Area-weighted mean error, relative to the same.
    pub mean: f64,
    /// Order of convergence of `max` from the next coarser mesh: ln(e₁/e₂)/ln √(N₂/N₁).
    pub order_max: Option<f64>,
    /// The same of `mean`.
    pub order_mean: Option<f64>,
    /// Median time of one evaluation, nanoseconds a vertex.
    pub ns_per_vertex: f64,
}

/// How far a study has come.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// Work done, in vertices.
    pub done: u64,
    /// All work, in vertices.
    pub total: u64,
    /// What is being worked on.
    pub at: &'a str,
}

/// Why a study cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A mesh cannot be made.
    #[error(transparent)]
    Generate(#[from] GenerateError),
    /// The curvatures overflow, or lose their digits.
    #[error(
        "{shape} cannot be studied in {scalar}: with its size and κ = {modulus:?}, 1/R³ or κ/R³ \
         are out of range"
    )]
    OutOfRange {
        /// The shape with its parameters.
        shape: AnyShape,
        /// Bending modulus κ.
        modulus: f64,
        /// The number type.
        scalar: Scalar,
    },
    /// A mesh cannot be used in this number type.
    #[error("the mesh of {vertices} vertices cannot be held in {scalar}: {source}")]
    Surface {
        /// How many vertices.
        vertices: usize,
        /// The number type.
        scalar: Scalar,
        /// What is wrong.
        source: SurfaceError,
    },
}

impl Study {
    /// Makes the study, row after row, coarse meshes before fine ones; `progress` hears of every
    /// step. What can be refused is refused before anything is computed.
    ///
    /// # Errors
    /// If a mesh cannot be made, or does not fit a number type.
    pub fn run(&self, progress: &mut dyn FnMut(Progress<'_>)) -> Result<Vec<Row>, StudyError> {
        self.check()?;
        let mut numbers = self.vertices.clone();
        numbers.sort_unstable();
        numbers.dedup();
        let passes = self.families.len() * (self.methods.len() * self.scalars.len() + 1);
        let total = numbers.iter().sum::<usize>() as u64 * passes as u64;
        let mut done = 0;
        let mut step = |vertices: usize, at: &str| {
            progress(Progress { done, total, at });
            done += vertices as u64;
        };
        let mut rows: Vec<Row> = Vec::new();
        for &family in &self.families {
            let mut meshes: Vec<(GeneratedMesh, Exact)> = Vec::with_capacity(numbers.len());
            for &vertices in &numbers {
                step(vertices, &format!("{family} {vertices}: mesh"));
                let mesh = generate(&self.shape, family, vertices, self.seed)?;
                let count = |mesh: &GeneratedMesh| mesh.mesh.vertex_count();
                // Two numbers may have the same nearest lattice of the torus.
                if meshes
                    .last()
                    .is_none_or(|(last, _)| count(last) < count(&mesh))
                {
                    let exact = Exact::new(&self.shape, &mesh, self.modulus);
                    meshes.push((mesh, exact));
                }
            }
            for &scalar in &self.scalars {
                for &method in &self.methods {
                    let case = Case {
                        study: self,
                        family,
                        method,
                        scalar,
                    };
                    for (mesh, exact) in &meshes {
                        let vertices = mesh.mesh.vertex_count();
                        step(vertices, &format!("{family} {vertices}: {method} {scalar}"));
                        let measured = match scalar {
                            Scalar::F32 | Scalar::F32Pair => case.measure::<f32>(mesh, exact),
                            Scalar::F64 => case.measure::<f64>(mesh, exact),
                        };
                        let found = measured.map_err(|source| StudyError::Surface {
                            vertices,
                            scalar,
                            source,
                        })?;
                        for mut row in found {
                            row.set_orders(&rows);
                            rows.push(row);
                        }
                    }
                }
            }
        }
        progress(Progress {
            done: total,
            total,
            at: "done",
        });
        Ok(rows)
    }

    /// Refuses what cannot be studied.
    fn check(&self) -> Result<(), StudyError> {
        for &family in &self.families {
            for &vertices in &self.vertices {
                generate::check(&self.shape, family, vertices)?;
            }
        }
        for &scalar in &self.scalars {
            let [.., third, force] = natural_scales(&self.shape, self.modulus);
            if !(scalar.holds(self.modulus) && scalar.holds(third) && scalar.holds(force)) {
                return Err(StudyError::OutOfRange {
                    shape: self.shape,
                    modulus: self.modulus,
                    scalar,
                });
            }
        }
        Ok(())
    }
}

impl Row {
    /// The orders against the last earlier row of the same kind, which has fewer vertices.
    fn set_orders(&mut self, earlier: &[Self]) {
        let coarser = earlier.iter().rev().find(|row| {
            row.family == self.family
                && row.method == self.method
                && row.scalar == self.scalar
                && row.quantity == self.quantity
        });
        let Some(coarser) = coarser else {
            return;
        };
        let refinement = (self.vertices as f64 / coarser.vertices as f64).sqrt().ln();
        let order = |coarse: f64, fine: f64| {
            let order = (coarse / fine).ln() / refinement;
            order.is_finite().then_some(order)
        };
        self.order_max = order(coarser.max, self.max);
        self.order_mean = order(coarser.mean, self.mean);
    }
}

/// Exact values at the vertices, and what errors are relative to.
struct Exact {
    points: Vec<ExactPoint<f64>>,
    modulus: f64,
    scales: [f64; 4],
}

impl Exact {
    fn new(shape: &AnyShape, mesh: &GeneratedMesh, modulus: f64) -> Self {
        let points: Vec<_> = mesh
            .preimages
            .iter()
            .map(|&preimage| shape.at(preimage))
            .collect();
        let natural = natural_scales(shape, modulus);
        let scales = Quantity::ALL.map(|quantity| {
            let largest = points
                .iter()
                .map(|point| exact_value(point, quantity, modulus).abs())
                .fold(0.0, f64::max);
            // Δ_S H and f of a sphere and f of a Clifford torus vanish identically, but for
            // rounding: then the shape's size is what is left to compare with.
            let natural = natural[quantity as usize];
            if largest > f64::EPSILON.sqrt() * natural {
                largest
            } else {
                natural
            }
        });
        Self {
            points,
            modulus,
            scales,
        }
    }
}

/// 1/R, 1/R², 1/R³ and κ/R³: what a shape's size R makes of H, K, Δ_S H and f.
fn natural_scales(shape: &AnyShape, modulus: f64) -> [f64; 4] {
    let curvature = shape.size().recip();
    let third = curvature.powi(3);
    [curvature, curvature.powi(2), third, modulus.abs() * third]
}

fn exact_value(point: &ExactPoint<f64>, quantity: Quantity, modulus: f64) -> f64 {
    match quantity {
        Quantity::Mean => point.mean,
        Quantity::Gaussian => point.gaussian,
        Quantity::LaplacianOfMean => point.laplacian_of_mean,
        Quantity::ForceDensity => point.force_density(modulus),
    }
}

/// One method on one family in one number type.
#[derive(Clone, Copy)]
struct Case<'a> {
    study: &'a Study,
    family: Family,
    method: BendingMethod,
    scalar: Scalar,
}

impl Case<'_> {
    fn measure<T: Evaluated>(
        self,
        mesh: &GeneratedMesh,
        exact: &Exact,
    ) -> Result<Vec<Row>, SurfaceError> {
        let held = HeldPositions::<T>::new(self.scalar, &mesh.positions);
        let surface = held.surface(&mesh.mesh)?;
        let mut evaluator =
            Evaluator::new(self.method, T::constant(self.study.modulus), &mesh.mesh);
        let fields = evaluator.fields(surface);
        let time = median_time(|| evaluator.evaluate(surface));
        let vertices = mesh.mesh.vertex_count();
        let row = |quantity| {
            let [max, mean] = errors(&fields, exact, quantity);
            Row {
                shape: self.study.shape.name(),
                family: self.family.name(),
                vertices,
                method: self.method,
                scalar: self.scalar,
                quantity,
                max,
                mean,
                order_max: None,
                order_mean: None,
                ns_per_vertex: time.as_secs_f64() * 1e9 / vertices as f64,
            }
        };
        let defined = |quantity: &Quantity| quantity.is_defined_by(self.method);
        Ok(Quantity::ALL.into_iter().filter(defined).map(row).collect())
    }
}

/// Largest and area-weighted mean error of a quantity, relative.
fn errors<T: Real>(fields: &Fields<T>, exact: &Exact, quantity: Quantity) -> [f64; 2] {
    let to_f64 = |value: T| value.to_f64().unwrap_or(f64::NAN);
    let scale = exact.scales[quantity as usize];
    let mut largest = 0.0_f64;
    let (mut weighted, mut weights) = (0.0, 0.0);
    for (vertex, point) in exact.points.iter().enumerate() {
        let value = exact_value(point, quantity, exact.modulus);
        let scalar = |found: Option<T>| found.map(|found| (to_f64(found) - value).abs());
        let error = match quantity {
            Quantity::Mean => scalar(fields.mean[vertex]),
            Quantity::Gaussian => scalar(fields.gaussian[vertex]),
            Quantity::LaplacianOfMean => scalar(fields.laplacian_of_mean[vertex]),
            Quantity::ForceDensity => fields.force_density[vertex].map(|found| {
                let difference = |axis: usize| to_f64(found[axis]) - value * point.normal[axis];
                (0..3)
                    .map(|axis| difference(axis).powi(2))
                    .sum::<f64>()
                    .sqrt()
            }),
        };
        let area = to_f64(fields.area[vertex]);
        // No number, or none at all (on a closed surface, for want of an area), is an infinite
        // error: `max` would pass it over.
        let error = error
            .filter(|error| !error.is_nan())
            .unwrap_or(f64::INFINITY);
        largest = largest.max(error);
        weighted += area * error;
        weights += area;
    }
    let mean = if largest.is_finite() {
        weighted / weights
    } else {
        largest
    };
    [largest / scale, mean / scale]
}

/// Median over as many runs as fit into a short while, at least three. Memory is warm: the fields
/// have been evaluated.
fn median_time(mut run: impl FnMut()) -> Duration {
    const WHILE: Duration = Duration::from_millis(40);
    let start = Instant::now();
    let mut times = Vec::new();
    while times.len() < 3 || (start.elapsed() < WHILE && times.len() < 1000) {
        let one = Instant::now();
        run();
        times.push(one.elapsed());
    }
    times.sort_unstable();
    times[times.len() / 2]
}
