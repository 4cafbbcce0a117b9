//! Errors of methods on exact shapes whose vertices have noise.

use super::errors::natural_scales;
use super::{StudyError, StudyProgress};
use crate::execute::{Parallel, unless_interrupted};
use crate::generate::random::Random;
use crate::generate::{AnyShape, Family, GeneratedMesh, generate};
use crate::measurement::Measurement;
use crate::method::{AnyMethod, BendingMethod, Evaluator, Fields, MethodOptions};
use crate::scalar::Scalar;
use helfrich::shapes::{ExactPoint, Shape};
use helfrich::{AdaptiveJet, Estimate, FitExtent, Measured, Surface, Verdict};
use serde::Serialize;

/// H, K and f.
const QUANTITIES: usize = 3;

/// A study of noise: every combination of the listed values.
#[derive(Clone, Debug)]
pub struct NoiseStudy {
    /// The exact shape.
    pub shape: AnyShape,
    /// The mesh families.
    pub families: Vec<Family>,
    /// Numbers of vertices.
    pub vertices: Vec<usize>,
    /// The methods; `jet` and the best fixed fit are added.
    pub methods: Vec<AnyMethod>,
    /// Standard deviations of every coordinate, in mean lengths of an edge.
    pub deviations: Vec<f64>,
    /// Seed of the random meshes and of the noise.
    pub seed: u64,
}

/// One method on one mesh with noise.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NoiseRow {
    /// The mesh family's name.
    pub family: &'static str,
    /// Number of vertices.
    pub vertices: usize,
    /// Standard deviation of every coordinate, in mean lengths of an edge.
    pub deviation: f64,
    /// Name of the method; [`BEST_FIXED`] for the least error of any fixed fit.
    pub method: &'static str,
    /// Root mean square errors of H, K and f over that of the exact field; `None` if not defined.
    pub errors: [Option<f64>; QUANTITIES],
    /// Reliability of the error bars; only of `jet`.
    pub bars: Option<[Bars; QUANTITIES]>,
    /// Median of the standard deviations of the noise that it finds, in mean edge lengths; only of `jet`.
    pub found: Option<f64>,
    /// Fractions of the vertices that are clean, noisy and unresolved; only of `jet`.
    pub verdicts: Option<[f64; 3]>,
}

/// Error bars compared with true errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Bars {
    /// Part of the vertices whose error is within the bar.
    pub within: f64,
    /// The median of the bar over the error.
    pub median: f64,
    /// Root mean square of the bars over that of the exact field.
    pub size: f64,
    /// The median number of neighbours of the fits.
    pub neighbours: u32,
}

/// The least error of `jet` with any one number of neighbours, and of J6, for each quantity: what a choice can reach that
/// is the same at all vertices.
pub const BEST_FIXED: &str = "best fixed fit";

impl NoiseStudy {
    /// Makes every measurement; what is measured so far if interrupted.
    ///
    /// # Errors
    /// If a mesh cannot be generated, or two methods have one name.
    pub fn run(
        &self,
        interrupted: &dyn Fn() -> bool,
        progress: &mut dyn FnMut(StudyProgress<'_>),
    ) -> Result<Vec<NoiseRow>, StudyError> {
        AnyMethod::check_names(&self.methods)?;
        let mut rows = Vec::new();
        let total = (self.families.len() * self.vertices.len() * self.deviations.len()) as u64;
        let mut done = 0;
        for &family in &self.families {
            for &vertices in &self.vertices {
                let made = generate(&self.shape, family, vertices, self.seed)?;
                for &deviation in &self.deviations {
                    let at = format!("{family}, {vertices} vertices, noise {deviation}");
                    progress(StudyProgress {
                        done,
                        total,
                        at: &at,
                    });
                    done += 1;
                    if interrupted() {
                        return Ok(rows);
                    }
                    let measure = || self.measure(family, &made, deviation, &mut rows);
                    let Some(measured) = unless_interrupted(measure) else {
                        return Ok(rows);
                    };
                    measured?;
                }
            }
        }
        Ok(rows)
    }

    /// Every method on one mesh with one noise.
    fn measure(
        &self,
        family: Family,
        made: &GeneratedMesh,
        deviation: f64,
        rows: &mut Vec<NoiseRow>,
    ) -> Result<(), StudyError> {
        let truth = Truth::new(&self.shape, made);
        let positions = disturbed(made, deviation, self.seed)?;
        let surface = held(made, &positions)?;
        let row = |method, errors| NoiseRow {
            family: family.name(),
            vertices: made.mesh.vertex_count(),
            deviation,
            method,
            errors,
            bars: None,
            found: None,
            verdicts: None,
        };
        for &method in &self.methods {
            if !method.has_error_bars() {
                let options = MethodOptions::default();
                let mut evaluator = method.evaluator(&options, 1.0, &made.mesh, Parallel::new());
                let fields = evaluator.fields(surface);
                rows.push(row(method.name(), truth.errors(&fields)));
            }
        }
        let jet = Measurement::new(surface, &AdaptiveJet::default(), &mut |_| true);
        if let Some(jet) = jet {
            let all = jet.vertices.len() as f64;
            let verdicts = [Verdict::Clean, Verdict::Noise, Verdict::Unresolved];
            rows.push(NoiseRow {
                bars: Some(truth.bars(&jet.vertices)),
                found: Some(jet.noise(surface).edges),
                verdicts: Some(verdicts.map(|verdict| jet.count(verdict) as f64 / all)),
                ..row(BendingMethod::Jet.name(), truth.errors(&jet.fields(1.0)))
            });
        }
        rows.push(row(BEST_FIXED, truth.best_fixed(made, surface).map(Some)));
        Ok(())
    }
}

/// The surface of a mesh at some positions.
fn held<'a>(
    made: &'a GeneratedMesh,
    positions: &'a [[f64; 3]],
) -> Result<Surface<'a, f64>, StudyError> {
    Surface::new(&made.mesh, positions).map_err(|source| StudyError::Surface {
        vertices: made.mesh.vertex_count(),
        scalar: Scalar::F64,
        source,
    })
}

/// The mean length of an edge.
fn mean_edge(made: &GeneratedMesh, surface: Surface<'_, f64>) -> f64 {
    let edges = made.mesh.edges();
    let lengths = edges.iter().map(|&[from, to]| {
        let [x, y, z] = surface.difference(from, to);
        x.hypot(y).hypot(z)
    });
    lengths.sum::<f64>() / edges.len() as f64
}

/// The positions of a mesh with normal errors in every coordinate, by G. E. P. Box and M. E. Muller, in
/// the polar form of Marsaglia.
fn disturbed(made: &GeneratedMesh, deviation: f64, seed: u64) -> Result<Vec<[f64; 3]>, StudyError> {
    let length = deviation * mean_edge(made, held(made, &made.positions)?);
    let mut random = Random::new(seed);
    let mut error = || {
        let point = random.in_disc();
        let square = point.length_squared();
        length * point.x * (-2.0 * square.ln() / square).sqrt()
    };
    let positions = made.positions.iter();
    Ok(positions.map(|x| x.map(|x| x + error())).collect())
}

/// The exact surface.
struct Truth {
    points: Vec<ExactPoint<f64>>,
    /// The scale of the errors of each quantity.
    scales: [f64; QUANTITIES],
}

impl Truth {
    fn new(shape: &AnyShape, made: &GeneratedMesh) -> Self {
        let points = made.preimages.iter().map(|&at| shape.at(at));
        let points: Vec<ExactPoint<f64>> = points.collect();
        let [mean, gaussian, _, force] = natural_scales(shape, 1.0);
        let mut scales = [mean, gaussian, force];
        for (quantity, scale) in scales.iter_mut().enumerate() {
            let size = root_mean_square(points.iter().map(|point| exact(point, quantity)));
            // f of a sphere vanishes up to rounding: its errors are relative to the scale of the shape.
            if size > f64::EPSILON.sqrt() * *scale {
                *scale = size;
            }
        }
        Self { points, scales }
    }

    fn errors(&self, fields: &Fields<f64>) -> [Option<f64>; QUANTITIES] {
        let scalar = |values: &[Option<f64>], quantity: usize| {
            let pairs = values.iter().zip(&self.points);
            let errors = pairs.map(|(value, point)| Some((*value)? - exact(point, quantity)));
            let errors: Option<Vec<f64>> = errors.collect();
            Some(root_mean_square(errors?.into_iter()) / self.scales[quantity])
        };
        let vectors = fields.force_density.iter().zip(&self.points);
        let vectors = vectors.map(|(density, point)| {
            let normal = point.normal.map(|component| component * exact(point, 2));
            let density = (*density)?;
            let squares = (0..3).map(|axis| (density[axis] - normal[axis]).powi(2));
            Some(squares.sum::<f64>().sqrt())
        });
        let vectors: Option<Vec<f64>> = vectors.collect();
        [
            scalar(&fields.mean, 0),
            scalar(&fields.gaussian, 1),
            vectors.map(|errors| root_mean_square(errors.into_iter()) / self.scales[2]),
        ]
    }

    fn bars(&self, measured: &[Measured<f64>]) -> [Bars; QUANTITIES] {
        std::array::from_fn(|quantity| {
            let estimates = measured.iter();
            let estimates = estimates.map(|at| [at.mean, at.gaussian, at.force_density][quantity]);
            let pairs = estimates.clone().zip(&self.points);
            let ratios = pairs.map(|(Estimate { value, error, .. }, point)| {
                error / (value - exact(point, quantity)).abs()
            });
            let mut ratios = Vec::from_iter(ratios);
            let neighbours = estimates.clone().map(|estimate| estimate.scale.neighbours);
            let mut neighbours = Vec::from_iter(neighbours);
            neighbours.sort_unstable();
            let size = root_mean_square(estimates.map(|estimate| estimate.error));
            ratios.sort_by(f64::total_cmp);
            let within = ratios.iter().filter(|&&ratio| ratio >= 1.0).count();
            Bars {
                within: within as f64 / ratios.len() as f64,
                median: ratios[ratios.len() / 2],
                size: size / self.scales[quantity],
                neighbours: neighbours[neighbours.len() / 2],
            }
        })
    }

    fn best_fixed(&self, made: &GeneratedMesh, surface: Surface<'_, f64>) -> [f64; QUANTITIES] {
        let jets = Evaluator::new(BendingMethod::J6, 1.0, &made.mesh).fields(surface);
        let ladder = AdaptiveJet::<f64>::LADDER.into_iter();
        let ladder = ladder.take_while(|neighbours| neighbours + 1 < self.points.len());
        let fixed = ladder.filter_map(|neighbours| {
            let jet = AdaptiveJet {
                extent: Some(FitExtent::Neighbours(neighbours)),
                ..AdaptiveJet::default()
            };
            Some(Measurement::new(surface, &jet, &mut |_| true)?.fields(1.0))
        });
        let mut best = [f64::INFINITY; QUANTITIES];
        for fields in std::iter::once(jets).chain(fixed) {
            for (best, error) in best.iter_mut().zip(self.errors(&fields)) {
                *best = error.unwrap_or(f64::INFINITY).min(*best);
            }
        }
        best
    }
}

fn exact(point: &ExactPoint<f64>, quantity: usize) -> f64 {
    [point.mean, point.gaussian, point.force_density(1.0)][quantity]
}

fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), x| (sum + x * x, count + 1.0));
    (sum / count).sqrt()
}
