//! Choice of a method for a mesh of the user, by measurements on that mesh.
//!
//! The exact curvatures of such a mesh are unknown. The reference are adaptive jets, which estimate their own error from
//! other fits and from the noise that they find. The error of a jet is expected to be its distance from the reference
//! and the error of the reference, whose squares add up. For other methods, which may share errors with the reference,
//! both together are an upper bound.
//!
//! All methods see noise of the positions as curvature, but wide fits average it: with noise the distance of a method
//! from the reference is its error. On meshes of 2562 vertices with noise of 1e-4 to 1e-2 edges, the expected mean
//! errors of J4 and J6 are within a factor of 1.5 of the true ones, except where f is lost in noise: there the largest
//! |f|, to which errors are relative, is up to twice too large.

mod uncertainty;

use crate::answer::Norm;
use crate::execute::Parallel;
use crate::generate::random::Random;
use crate::method::{
    AnyMethod, BendingMethod, Compiled, Evaluated, Evaluator, Fields, MethodOptions, RepeatedName,
};
use crate::noise::Quieted;
use crate::scalar::{HeldPositions, Scalar};
use crate::study::{Quantity, Reference, StudyProgress, Timing, is_scattered};
use helfrich::{Noise, Surface, SurfaceError, TriangleMesh};
use serde::{Serialize, Serializer};
use std::time::Instant;
use uncertainty::Uncertain;

/// Request of a user.
#[derive(Clone, Debug, PartialEq)]
pub struct Wish {
    /// Quantity that has to be accurate.
    pub quantity: Quantity,
    /// The norm in which the error counts.
    pub norm: Norm,
    /// Largest allowed error, relative to the largest value on the surface.
    pub target: f64,
    /// The methods to choose from. `jet` is measured once, whatever the number types.
    pub methods: Vec<AnyMethod>,
    /// Options of the methods; each takes those that it has.
    pub options: MethodOptions,
    /// The number types to choose from.
    pub scalars: Vec<Scalar>,
}

/// One method in one number type, as measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Candidate {
    /// The method.
    pub method: AnyMethod,
    /// Its options other than the defaults.
    #[serde(flatten)]
    pub options: MethodOptions,
    /// The number type.
    pub scalar: Scalar,
    /// Largest distance from the reference, relative to the largest value; infinite, which JSON writes
    /// as null, if a vertex has no result.
    pub max: f64,
    /// Area-weighted mean distance, relative to the same.
    pub mean: f64,
    /// Median time of one evaluation of the mesh, on one thread; for `jet`, the time of a single evaluation,
    /// summed over all threads.
    pub seconds: f64,
    /// Distance of the quartiles of that time over their median; see [`Self::is_scattered`].
    pub seconds_scatter: f64,
    /// Its expected error, in the norm of the request, including the effect of noise: the distance from the
    /// reference and the uncertainty of the reference.
    pub expected: f64,
    /// Whether the expected error is only an upper bound: true for all methods except jets.
    pub is_bound: bool,
    /// Whether the expected error is known and within the target.
    pub reaches: bool,
}

impl Candidate {
    /// Whether the times that were measured scatter by more than [`crate::study::MOST_SCATTER`], as on a
    /// machine with other work: then their median says little.
    pub fn is_scattered(&self) -> bool {
        is_scattered(self.seconds_scatter)
    }
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Recommendation {
    /// Number of vertices of the mesh.
    pub vertices: usize,
    /// Number of vertices with a reference: all except those at a boundary or in no triangle.
    pub compared: usize,
    /// Quantity that has to be accurate.
    pub quantity: Quantity,
    /// `max` or `mean`.
    pub norm: &'static str,
    /// The largest allowed error.
    pub target: f64,
    /// Noise of the positions, 0 if none was found.
    #[serde(serialize_with = "as_length_and_edges")]
    pub noise: Noise<f64>,
    /// Part of the error of J6 in f64 that is due to noise, in that norm.
    pub noise_error: f64,
    /// Expected error of J6 in f64 in this norm.
    pub reference_error: f64,
    /// Whether the mesh resolves the shape: whether the error of J6 in f64 at the worst vertex is at
    /// most [`RESOLVED`]. If not, no candidate is known to reach anything.
    pub is_resolved: bool,
    /// The candidate that reaches the target in the shortest time.
    pub choice: Option<Candidate>,
    /// The candidate with the smallest expected error.
    pub nearest: Option<Candidate>,
    /// If no candidate reaches the target: the number of vertices that J6 would need. Errors of the
    /// mesh fall with the theoretical order, h³ for f and Δ_S H and h⁵ for H and K; errors of noise
    /// of the same size grow as h⁻⁴ and h⁻². Where noise dominates, the number is below that of the
    /// mesh; `None` if no number reaches the target.
    pub vertices_needed: Option<f64>,
    /// Everything that was measured, fastest first.
    pub candidates: Vec<Candidate>,
}

/// Methods beside `jet` whose expected errors are estimates; those of others are upper bounds.
const JETS: [AnyMethod; 2] = [
    AnyMethod::Listed(BendingMethod::J4),
    AnyMethod::Listed(BendingMethod::J6),
];

/// Largest part of the inner vertices that may have no reference.
const UNKNOWN: f64 = 0.2;

/// Largest estimated error at the worst vertex for which the estimate is reliable. Above it, the
/// largest value may be that of a vertex with a large error, which makes all relative errors appear
/// small.
pub const RESOLVED: f64 = 0.2;

/// The reason why there is no recommendation.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecommendError {
    /// Two methods have one name.
    #[error(transparent)]
    Name(#[from] RepeatedName),
    /// The positions cannot be used in this number type.
    #[error("the mesh cannot be held in {scalar}: {source}")]
    Surface {
        /// The number type.
        scalar: Scalar,
        /// The fault.
        source: SurfaceError,
    },
    /// No vertex has a reference.
    #[error(
        "no vertex has enough neighbours to determine its {}: a mesh with some dozen vertices away \
         from its boundary is needed", quantity.symbol()
    )]
    NoReference {
        /// Quantity that would be compared.
        quantity: Quantity,
    },
}

/// Measures every candidate on a mesh, and chooses. `None` if interrupted.
///
/// # Errors
/// If the positions do not fit a number type, no vertex can be compared, or two methods have one name.
pub fn recommend(
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
    wish: &Wish,
    interrupted: &dyn Fn() -> bool,
    progress: &mut dyn FnMut(StudyProgress<'_>),
) -> Result<Option<Recommendation>, RecommendError> {
    AnyMethod::check_names(&wish.methods)?;
    let quantity = wish.quantity;
    let surface = Surface::new(mesh, positions).map_err(|source| RecommendError::Surface {
        scalar: Scalar::F64,
        source,
    })?;
    let total = (wish.methods.len() * wish.scalars.len() + 2) as u64;
    let mut tell = |done: u64, at: &str| progress(StudyProgress { done, total, at });
    tell(0, "noise, and a reference: adaptive jets");
    let Some(known) = Uncertain::new(surface, quantity, &mut |_| !interrupted()) else {
        return Ok(None);
    };
    let compared = known.reference.known(quantity);
    if compared == 0 {
        return Err(RecommendError::NoReference { quantity });
    }
    tell(1, "error of j6");
    let ground = Ground {
        surface,
        wish,
        known,
    };
    let expected = ground.of_j6().map_err(|source| RecommendError::Surface {
        scalar: Scalar::F64,
        source,
    })?;
    let mut candidates = Vec::new();
    let mut done = 2;
    for &scalar in &wish.scalars {
        for &method in &wish.methods {
            if interrupted() {
                return Ok(None);
            }
            tell(done, &format!("{method} {scalar}"));
            done += 1;
            let which = (method, wish.options.of(method), scalar);
            let measured = match scalar {
                _ if !quantity.is_defined_by(method) => continue,
                Scalar::F64 if method.has_error_bars() => Ok(ground.of_jet(method)),
                _ if method.has_error_bars() => continue,
                Scalar::F32 | Scalar::F32Pair => ground.measured::<f32>(which),
                Scalar::F64 => ground.measured::<f64>(which),
            };
            let measured = measured.map_err(|source| RecommendError::Surface { scalar, source })?;
            candidates.push(Candidate {
                reaches: expected.is_resolved() && measured.expected <= wish.target,
                ..measured
            });
        }
    }
    candidates.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let choice = candidates.iter().find(|candidate| candidate.reaches);
    let nearest = candidates
        .iter()
        .min_by(|a, b| a.expected.total_cmp(&b.expected));
    let needed = expected.vertices_needed(mesh.vertex_count(), wish);
    Ok(Some(Recommendation {
        vertices: mesh.vertex_count(),
        compared,
        quantity,
        norm: wish.norm.name(),
        target: wish.target,
        noise: ground.known.measurement.noise(surface),
        noise_error: in_norm(expected.noise, wish.norm),
        reference_error: in_norm(expected.all, wish.norm),
        is_resolved: expected.is_resolved(),
        choice: choice.copied(),
        nearest: nearest.copied(),
        vertices_needed: needed.filter(|_| choice.is_none()),
        candidates,
    }))
}

/// `{length, edges}`.
fn as_length_and_edges<S: Serializer>(noise: &Noise<f64>, to: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct LengthAndEdges {
        length: f64,
        edges: f64,
    }
    let Noise { length, edges } = *noise;
    LengthAndEdges { length, edges }.serialize(to)
}

fn in_norm([max, mean]: [f64; 2], norm: Norm) -> f64 {
    match norm {
        Norm::Max => max,
        Norm::Mean => mean,
    }
}

/// Errors of J6 in f64 in both norms, the largest and the mean.
struct Expected {
    /// All errors together; infinite if too many vertices have no reference.
    all: [f64; 2],
    /// Errors due to noise; 0 if none was found.
    noise: [f64; 2],
    /// Errors due to the shape.
    shape: [f64; 2],
}

impl Expected {
    fn is_resolved(&self) -> bool {
        self.shape[0] <= RESOLVED.max(self.noise[0])
    }

    /// The number of vertices that J6 needs for the target, on the same surface with the same
    /// noise.
    fn vertices_needed(&self, vertices: usize, wish: &Wish) -> Option<f64> {
        // Orders with which errors fall with the edge length, and with which errors of noise grow.
        let (order, noise_order) = match wish.quantity {
            Quantity::Mean | Quantity::Gaussian => (5.0, 2.0),
            Quantity::LaplacianOfMean | Quantity::ForceDensity => (3.0, 4.0),
        };
        let [unknown, noise] = [self.shape, self.noise].map(|error| in_norm(error, wish.norm));
        // If the shape is not resolved, resolution comes first.
        let worst = self.shape[0] / RESOLVED;
        let count = vertices as f64;
        if noise == 0.0 {
            let excess = (unknown / wish.target).max(worst);
            let needed = (count * excess.powf(2.0 / order)).ceil();
            return needed.is_finite().then_some(needed);
        }
        let suffices = |factor: &f64| {
            let finer = factor.sqrt();
            let shape = unknown * finer.powf(-order);
            let error = shape.hypot(noise * finer.powf(noise_order));
            error <= wish.target && worst * finer.powf(-order) <= 1.0
        };
        // Numbers near that of the mesh come first; finer meshes only where noise does not dominate.
        let factors = (0..=STEPS).flat_map(|step| {
            let factor = 2.0_f64.powf(f64::from(step) / 8.0);
            let finer = (noise < unknown).then_some(factor);
            finer.into_iter().chain([factor.recip()])
        });
        let found = factors.into_iter().find(suffices)?;
        Some((count * found).ceil())
    }
}

/// Largest number of steps that are tried; each is an eighth of a doubling of the vertices.
const STEPS: u32 = 80;

/// Copies of the positions with noise added.
const REPLICAS: usize = 2;

/// The surface on which methods are measured, and the reference with which they are compared.
struct Ground<'a> {
    surface: Surface<'a, f64>,
    wish: &'a Wish,
    known: Uncertain,
}

impl Ground<'_> {
    /// The errors of J6. Noise is small compared with an edge, and its effect nearly linear: additional noise of the same
    /// standard deviation changes a result by as much as the existing noise has changed it. The error due to the shape is
    /// the distance from degree 8 on a smooth surface.
    fn of_j6(&self) -> Result<Expected, SurfaceError> {
        let Self {
            surface,
            wish,
            known,
        } = self;
        let (mesh, quantity) = (surface.mesh(), wish.quantity);
        let mut jets = Evaluator::new(BendingMethod::J6, 1.0, mesh);
        let here = jets.fields(*surface);
        let mut all = known.expected(&here, false);
        let inner = (0..mesh.vertex_count()).filter(|&vertex| mesh.is_interior(vertex));
        let unknown = 1.0 - known.reference.known(quantity) as f64 / inner.count() as f64;
        if unknown > UNKNOWN {
            all = [f64::INFINITY; 2];
        }
        let noise = known.measurement.noise(*surface);
        if !noise.is_seen() || unknown > UNKNOWN {
            return Ok(Expected {
                all,
                noise: [0.0; 2],
                shape: all,
            });
        }
        let here = Reference::of(&here).in_units_like(&known.reference);
        let mut random = Random::new(1);
        let mut squares = [0.0; 2];
        for _ in 0..REPLICAS {
            let replica = disturbed(surface.positions(), noise.length, &mut random);
            let fields = jets.fields(Surface::new(mesh, &replica)?);
            for (square, error) in squares.iter_mut().zip(here.errors(&fields, quantity)) {
                *square += error * error / REPLICAS as f64;
            }
        }
        let quiet = Quieted::of_measured(*surface, noise, &known.measurement.vertices);
        let smooth = quiet
            .as_ref()
            .map_or(surface.positions(), |quiet| &quiet.positions);
        let smooth = Surface::new(mesh, smooth)?;
        let eighth = Reference::of(&Evaluator::reference(1.0, mesh).fields(smooth));
        let eighth = eighth.in_units_like(&known.reference);
        Ok(Expected {
            all,
            noise: squares.map(f64::sqrt),
            shape: eighth.errors(&jets.fields(smooth), quantity),
        })
    }

    /// The adaptive jets themselves.
    fn of_jet(&self, method: AnyMethod) -> Candidate {
        let fields = self.known.measurement.fields(1.0);
        let which = (method, MethodOptions::default(), Scalar::F64);
        self.candidate(which, &fields, self.known.time)
    }

    /// A method in a number type, and the time of an evaluation.
    fn measured<T: Compiled>(
        &self,
        (method, options, scalar): (AnyMethod, MethodOptions, Scalar),
    ) -> Result<Candidate, SurfaceError> {
        let (mesh, positions) = (self.surface.mesh(), self.surface.positions());
        let held = HeldPositions::<T>::new(scalar, positions);
        let surface = held.surface(mesh)?;
        let mut evaluator = method.evaluator(&options, T::one(), mesh, Parallel::single());
        let start = Instant::now();
        evaluator.evaluate(surface);
        let time = Timing::of_runs(start.elapsed(), || evaluator.evaluate(surface));
        let fields = evaluator.last_fields(surface);
        Ok(self.candidate((method, options, scalar), &fields, time))
    }

    fn candidate<T: Evaluated>(
        &self,
        (method, options, scalar): (AnyMethod, MethodOptions, Scalar),
        fields: &Fields<T>,
        time: Timing,
    ) -> Candidate {
        let [max, mean] = self.known.reference.errors(fields, self.wish.quantity);
        let is_bound = !(JETS.contains(&method) || method.has_error_bars());
        Candidate {
            method,
            options,
            scalar,
            max,
            mean,
            seconds: time.median.as_secs_f64(),
            seconds_scatter: time.scatter,
            expected: in_norm(self.known.expected(fields, is_bound), self.wish.norm),
            is_bound,
            reaches: false,
        }
    }
}

/// Adds an error of this standard deviation to each coordinate; a sum of twelve uniform numbers is nearly normal.
fn disturbed(positions: &[[f64; 3]], deviation: f64, random: &mut Random) -> Vec<[f64; 3]> {
    let mut error = || (0..12).map(|_| random.unit()).sum::<f64>() - 6.0;
    let moved = positions.iter().map(|x| x.map(|x| x + deviation * error()));
    moved.collect()
}
