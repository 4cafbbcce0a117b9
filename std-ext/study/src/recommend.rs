//! Choice of a method for a mesh of the user, by measurements on that mesh.
//!
//! The exact curvatures of such a mesh are unknown. Without noise, jets of degree 8 are the reference. The error of J6 is
//! estimated as the distance of degree 6 from the reference, or as the geometric mean of the distances of degrees 6 and 4
//! if that is larger, because near the limit of resolution degree 8 is hardly better than degree 6; the error of J8 as
//! the distance of degree 6. On exact shapes
//! (discocyte, ellipsoids, tori; regular, irregular and hard meshes of 42 vertices and more) the true error of J6 was at
//! most 1.3 times this estimate wherever the estimate was below a half at the worst vertex. Above [`RESOLVED`] the
//! estimate is not reliable.
//!
//! All methods see noise of the positions as curvature, so that distances between methods do not reveal it. With noise the
//! reference are adaptive jets, whose wide fits average it and which estimate their own error. On meshes of 2562 vertices
//! with noise of 1e-4 to 1e-2 edges, the expected mean errors of H by J4 and J6 are within a factor of 1.5 of the true
//! ones. This holds for f, too, except where f is lost in noise: there the largest |f|, to which errors are relative, is
//! up to 1.8 times too small or too large.

mod uncertainty;

use crate::answer::Norm;
use crate::clock;
use crate::execute::Parallel;
use crate::generate::random::Random;
use crate::method::{
    AnyMethod, BendingMethod, Compiled, Evaluated, Evaluator, Fields, MethodOptions, RepeatedName,
};
use crate::noise::{Quieted, noise_of};
use crate::scalar::{HeldPositions, Scalar};
use crate::study::{Quantity, Reference, StudyProgress, Timing, is_scattered};
use helfrich::{Finding, Noise, Surface, SurfaceError, TriangleMesh};
use serde::{Serialize, Serializer};
use uncertainty::Uncertain;

/// Request of a user.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// Quantity that has to be accurate.
    pub quantity: Quantity,
    /// The norm in which the error counts.
    pub norm: Norm,
    /// Largest allowed error, relative to the largest value on the surface.
    pub target: f64,
    /// The methods to choose from. `jet` chooses its scale where there is noise, and is measured once, whatever the number
    /// types; without noise it equals J4, J6 or J8, and is left out if these are listed.
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
const JETS: [BendingMethod; 3] = [BendingMethod::J4, BendingMethod::J6, BendingMethod::J8];

/// Number of vertices below which the shape of a coarse mesh is taken for noise.
const TOLD: usize = 1200;

/// Largest part of the vertices where jets of degree 8 may have a lower degree, as beside boundaries: where those of
/// degrees 4 and 6 have the same, their distances say nothing.
const LOWERED: f64 = 0.2;

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

/// A method with its options and number type.
type Which = (AnyMethod, MethodOptions, Scalar);

/// Measures a method.
type Measure = fn(&Ground<'_>, Which) -> Result<Candidate, SurfaceError>;

/// Measures every candidate on a mesh, and chooses. `None` if interrupted.
///
/// # Errors
/// If the positions do not fit a number type, no vertex can be compared, or two methods have one name.
pub fn recommend(
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
    request: &Request,
    interrupted: &dyn Fn() -> bool,
    progress: &mut dyn FnMut(StudyProgress<'_>),
) -> Result<Option<Recommendation>, RecommendError> {
    let measure: Measure = |ground, which| match which.2 {
        Scalar::F32 | Scalar::F32Pair => ground.measured::<f32>(which),
        Scalar::F64 => ground.measured::<f64>(which),
    };
    recommend_by(measure, mesh, positions, request, interrupted, progress)
}

/// As [`recommend`], with candidates in f64 whatever the request names: programs of which the size counts need not
/// have all methods in f32, too.
///
/// # Errors
/// As [`recommend`].
pub fn recommend_in_f64(
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
    request: &Request,
    interrupted: &dyn Fn() -> bool,
    progress: &mut dyn FnMut(StudyProgress<'_>),
) -> Result<Option<Recommendation>, RecommendError> {
    let request = Request {
        scalars: vec![Scalar::F64],
        ..request.clone()
    };
    let measure: Measure = |ground, which| ground.measured::<f64>(which);
    recommend_by(measure, mesh, positions, &request, interrupted, progress)
}

fn recommend_by(
    measure: Measure,
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
    request: &Request,
    interrupted: &dyn Fn() -> bool,
    progress: &mut dyn FnMut(StudyProgress<'_>),
) -> Result<Option<Recommendation>, RecommendError> {
    AnyMethod::check_names(&request.methods)?;
    let quantity = request.quantity;
    let surface = Surface::new(mesh, positions).map_err(|source| RecommendError::Surface {
        scalar: Scalar::F64,
        source,
    })?;
    let total = (request.methods.len() * request.scalars.len() + 2) as u64;
    let mut tell = |done: u64, at: &str| progress(StudyProgress { done, total, at });
    tell(0, "noise, and a reference");
    let failed = |source| RecommendError::Surface {
        scalar: Scalar::F64,
        source,
    };
    let noise = noise_of(surface);
    let known = match noise.is_seen() {
        true => Uncertain::new(surface, quantity, &mut |_| !interrupted()).map(Known::Noisy),
        false => Some(Known::exact(surface, quantity)),
    };
    let Some(known) = known else {
        return Ok(None);
    };
    let compared = known.reference().known(quantity);
    if compared == 0 {
        return Err(RecommendError::NoReference { quantity });
    }
    if interrupted() {
        return Ok(None);
    }
    tell(1, "error of j6");
    let ground = Ground {
        surface,
        request,
        noise,
        known,
    };
    let expected = ground.of_j6().map_err(failed)?;
    // Without noise `jet` is one of these.
    let are_given = JETS
        .iter()
        .all(|&degree| request.methods.contains(&degree.into()));
    let mut candidates = Vec::new();
    let mut done = 2;
    for &scalar in &request.scalars {
        for &method in &request.methods {
            if interrupted() {
                return Ok(None);
            }
            tell(done, &format!("{method} {scalar}"));
            done += 1;
            let which = (method, request.options.of(method), scalar);
            let jet = match &ground.known {
                Known::Noisy(jet) => Some(jet),
                Known::Exact { .. } => None,
            };
            let is_left_out = method.has_error_bars()
                && match jet {
                    Some(_) => scalar != Scalar::F64,
                    None => are_given,
                };
            if is_left_out || !quantity.is_defined_by(method) {
                continue;
            }
            let jet = jet.filter(|_| method.has_error_bars());
            let measured = match jet {
                Some(jet) => Ok(ground.of_jet(jet, method)),
                None => measure(&ground, which),
            };
            let measured = measured.map_err(|source| RecommendError::Surface { scalar, source })?;
            candidates.push(Candidate {
                reaches: expected.is_resolved() && measured.expected <= request.target,
                ..measured
            });
        }
    }
    candidates.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let choice = candidates.iter().find(|candidate| candidate.reaches);
    let nearest = candidates
        .iter()
        .min_by(|a, b| a.expected.total_cmp(&b.expected));
    let needed = expected.vertices_needed(mesh.vertex_count(), request);
    Ok(Some(Recommendation {
        vertices: mesh.vertex_count(),
        compared,
        quantity,
        norm: request.norm.name(),
        target: request.target,
        noise,
        noise_error: in_norm(expected.noise, request.norm),
        reference_error: in_norm(expected.all, request.norm),
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
    /// All errors together; infinite if nothing shows them.
    all: [f64; 2],
    /// Errors due to noise; 0 if none was found.
    noise: [f64; 2],
    /// Errors due to the shape.
    shape: [f64; 2],
    /// Whether noise can be told from a shape that the mesh does not resolve.
    is_told: bool,
}

impl Expected {
    fn is_resolved(&self) -> bool {
        let noise = if self.is_told { self.noise[0] } else { 0.0 };
        self.shape[0] <= RESOLVED.max(noise)
    }

    /// The number of vertices that J6 needs for the target, on the same surface with the same
    /// noise.
    fn vertices_needed(&self, vertices: usize, request: &Request) -> Option<f64> {
        // Orders with which errors fall with the edge length, and with which errors of noise grow.
        let (order, noise_order) = match request.quantity {
            Quantity::Mean | Quantity::Gaussian => (5.0, 2.0),
            Quantity::LaplacianOfMean | Quantity::ForceDensity => (3.0, 4.0),
        };
        let [unknown, noise] = [self.shape, self.noise].map(|error| in_norm(error, request.norm));
        // If the shape is not resolved, resolution comes first.
        let worst = self.shape[0] / RESOLVED;
        let count = vertices as f64;
        if noise == 0.0 {
            let excess = (unknown / request.target).max(worst);
            let needed = (count * excess.powf(2.0 / order)).ceil();
            return needed.is_finite().then_some(needed);
        }
        let suffices = |factor: &f64| {
            let finer = factor.sqrt();
            let shape = unknown * finer.powf(-order);
            let error = shape.hypot(noise * finer.powf(noise_order));
            error <= request.target && worst * finer.powf(-order) <= 1.0
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

/// Reference of all methods.
enum Known {
    /// Jets of degree 8 on a surface without noise, and the errors of J6 and J8 by the distances of degrees 6 and 4
    /// from them.
    Exact {
        reference: Reference,
        of_j6: [f64; 2],
        of_j8: [f64; 2],
    },
    /// Adaptive jets on a surface with noise.
    Noisy(Uncertain),
}

impl Known {
    fn exact(surface: Surface<'_, f64>, quantity: Quantity) -> Self {
        let mesh = surface.mesh();
        let (fields, findings) =
            Evaluator::new(BendingMethod::J8, 1.0, mesh).fields_and_findings(surface);
        let is_lowered = |finding: &&Finding| match **finding {
            Finding::ReducedDegree { vertex, .. } | Finding::TooFewNeighbours { vertex } => {
                mesh.is_interior(vertex as usize)
            }
            _ => false,
        };
        let lowered = findings.iter().filter(is_lowered).count();
        let is_whole = lowered as f64 <= LOWERED * mesh.vertex_count() as f64;
        let reference = Reference::of(&fields);
        let [far, near] = [BendingMethod::J4, BendingMethod::J6].map(|method| {
            let fields = Evaluator::new(method, 1.0, mesh).fields(surface);
            reference.errors(&fields, quantity)
        });
        let of_distances = |error: fn(f64, f64) -> f64| {
            [0, 1].map(|norm| match is_whole {
                true => error(near[norm], far[norm]),
                false => f64::INFINITY,
            })
        };
        Self::Exact {
            reference,
            of_j6: of_distances(|near, far| near.max((near * far).sqrt())),
            of_j8: of_distances(|near, _| near),
        }
    }

    fn reference(&self) -> &Reference {
        match self {
            Self::Exact { reference, .. } => reference,
            Self::Noisy(uncertain) => &uncertain.reference,
        }
    }

    /// The largest and the mean error that a method with these distances is expected to have.
    fn expected<T: Evaluated>(
        &self,
        fields: &Fields<T>,
        distances: [f64; 2],
        (method, scalar): (AnyMethod, Scalar),
    ) -> [f64; 2] {
        match self {
            Self::Noisy(uncertain) => uncertain.expected(fields, is_bound(method)),
            Self::Exact { of_j6, of_j8, .. } => [0, 1].map(|norm| {
                let distance = distances[norm];
                let unknown = match method == BendingMethod::J8 {
                    true => of_j8[norm],
                    false => of_j6[norm],
                };
                match (is_bound(method), scalar) {
                    (_, Scalar::F64) if method == BendingMethod::J6 => unknown,
                    (true, _) => unknown + distance,
                    (false, _) => unknown.hypot(distance),
                }
            }),
        }
    }
}

/// Whether expected errors of a method are upper bounds: those of jets are estimates.
fn is_bound(method: AnyMethod) -> bool {
    !(JETS.iter().any(|&degree| method == degree) || method.has_error_bars())
}

/// The surface on which methods are measured, and the reference with which they are compared.
struct Ground<'a> {
    surface: Surface<'a, f64>,
    request: &'a Request,
    noise: Noise<f64>,
    known: Known,
}

impl Ground<'_> {
    /// The errors of J6. Noise is small compared with an edge, and its effect nearly linear: additional noise of the same
    /// standard deviation changes a result by as much as the existing noise has changed it. The error due to the shape is
    /// the distance from degree 8 on a smooth surface.
    fn of_j6(&self) -> Result<Expected, SurfaceError> {
        let (mesh, quantity) = (self.surface.mesh(), self.request.quantity);
        let jet = match &self.known {
            Known::Noisy(jet) => jet,
            Known::Exact { of_j6, .. } => {
                return Ok(Expected {
                    all: *of_j6,
                    noise: [0.0; 2],
                    shape: *of_j6,
                    is_told: true,
                });
            }
        };
        let mut jets = Evaluator::new(BendingMethod::J6, 1.0, mesh);
        let fields = jets.fields(self.surface);
        let all = jet.expected(&fields, false);
        let here = Reference::of(&fields).in_units_like(&jet.reference);
        let mut random = Random::new(1);
        let mut squares = [0.0; 2];
        for _ in 0..REPLICAS {
            let replica = disturbed(self.surface.positions(), self.noise.length, &mut random);
            let fields = jets.fields(Surface::new(mesh, &replica)?);
            for (square, error) in squares.iter_mut().zip(here.errors(&fields, quantity)) {
                *square += error * error / REPLICAS as f64;
            }
        }
        let quiet = Quieted::of_measured(self.surface, self.noise, &jet.measurement.vertices);
        let smooth = quiet.as_ref().ok();
        let smooth = smooth.map_or(self.surface.positions(), |quiet| &quiet.positions);
        let smooth = Surface::new(mesh, smooth)?;
        let eighth = Reference::of(&Evaluator::new(BendingMethod::J8, 1.0, mesh).fields(smooth));
        let eighth = eighth.in_units_like(&jet.reference);
        let is_told = mesh.vertex_count() >= TOLD;
        Ok(Expected {
            all,
            noise: squares.map(f64::sqrt),
            // Smoothing removes a shape that is hardly resolved.
            shape: match is_told {
                true => eighth.errors(&jets.fields(smooth), quantity),
                false => all,
            },
            is_told,
        })
    }

    /// The adaptive jets themselves.
    fn of_jet(&self, jet: &Uncertain, method: AnyMethod) -> Candidate {
        let which = (method, MethodOptions::default(), Scalar::F64);
        self.candidate(which, &jet.measurement.fields(1.0), jet.time)
    }

    /// A method in a number type, and the time of an evaluation.
    fn measured<T: Compiled>(
        &self,
        (method, options, scalar): Which,
    ) -> Result<Candidate, SurfaceError> {
        let (mesh, positions) = (self.surface.mesh(), self.surface.positions());
        let held = HeldPositions::<T>::new(scalar, positions);
        let surface = held.surface(mesh)?;
        let mut evaluator = method.evaluator(&options, T::one(), mesh, Parallel::single());
        let start = clock::now();
        evaluator.evaluate(surface);
        let time = Timing::of_runs(clock::since(start), || evaluator.evaluate(surface));
        let fields = evaluator.last_fields(surface);
        Ok(self.candidate((method, options, scalar), &fields, time))
    }

    fn candidate<T: Evaluated>(
        &self,
        (method, options, scalar): Which,
        fields: &Fields<T>,
        time: Timing,
    ) -> Candidate {
        let distances = self.known.reference().errors(fields, self.request.quantity);
        let expected = self.known.expected(fields, distances, (method, scalar));
        let [max, mean] = distances;
        Candidate {
            method,
            options,
            scalar,
            max,
            mean,
            seconds: time.median.as_secs_f64(),
            seconds_scatter: time.scatter,
            expected: in_norm(expected, self.request.norm),
            is_bound: is_bound(method),
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
