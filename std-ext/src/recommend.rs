//! Choice of a method for a mesh of the user, by measurements on that mesh.
//!
//! The exact curvatures of such a mesh are unknown. Jets of degree 8 are the reference. The error
//! of J6 is estimated as the distance of degree 6 from the reference, or as the geometric mean of
//! the distances of degrees 6 and 4 if that is larger, because near the limit of resolution degree
//! 8 is hardly better than degree 6. On exact shapes (discocyte, ellipsoids, tori; regular,
//! irregular and hard meshes of 42 vertices and more) the true error of J6 was at most 1.3 times
//! this estimate wherever the estimate was below a half at the worst vertex. Above [`RESOLVED`] the
//! estimate is not reliable.
//!
//! All methods see noise of the positions as curvature, so that distances between methods do not
//! reveal it. If noise is found, methods are compared with the best of many estimates that average
//! it: regression jets with as many neighbours as the shape allows. The effect of noise on a method
//! is measured by adding the same amount again. Errors of noise and of the shape are independent,
//! so their squares add up.
//!
//! The adaptive jet is a candidate where noise is found, and estimates its own error. On 156 meshes of
//! 13 shapes, with noise of 1e-4 to 3e-2 edges, the estimated mean error of H was within a factor of 1.5
//! of the true one, that of K on all but one, and that of f on all but 13 (0.5 to 2.1). It is too small on
//! stars with noise of 1e-2 edges and more, which hides that degrees 4 and 6 share their bias.
//!
//! Mean errors of J4 and J6 are also estimated from the distances of J4, J6 and jets of degree 8 from
//! each other, as far as noise does not explain these distances. On meshes of 2562 vertices with noise
//! of 1e-4 to 1e-2 edges, the expected errors of H are within a factor of 1.5 of the true ones. On most
//! shapes this holds for f, too. Exceptions are a torus of aspect 0.6, with 0.5 of the true error, and
//! a sphere with deep waves, with twice the true error, because noise hides its largest f. On shapes
//! that are hardly resolved, such as a torus of aspect 0.2, noise below 3e-4 edges is not detected.

mod adaptive;
mod estimate;
mod noisy;

use crate::answer::Norm;
use crate::execute::Parallel;
use crate::method::{
    AnyMethod, BendingMethod, Compiled, Evaluated, Evaluator, MethodOptions, RepeatedName,
};
use crate::noise::noise_of;
use crate::scalar::{HeldPositions, Scalar};
use crate::study::{Quantity, Reference, StudyProgress, Timing, is_scattered};
use adaptive::Adaptive;
use estimate::Estimate;
use helfrich::{Finding, Noise, Surface, SurfaceError, TriangleMesh};
use noisy::{Noisy, REPLICAS};
use serde::{Serialize, Serializer};
use std::time::Instant;

/// Request of a user.
#[derive(Clone, Debug, PartialEq)]
pub struct Wish {
    /// Quantity that has to be accurate.
    pub quantity: Quantity,
    /// The norm in which the error counts.
    pub norm: Norm,
    /// Largest allowed error, relative to the largest value on the surface.
    pub target: f64,
    /// The methods to choose from. `jet` chooses its scale where there is noise; without noise it
    /// equals J4 or J6, and is omitted if these are listed.
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
    /// Median time of one evaluation of the mesh, on one thread; for `jet` on a mesh with noise, the
    /// time of a single evaluation, summed over all threads.
    pub seconds: f64,
    /// Distance of the quartiles of that time over their median; see [`Self::is_scattered`].
    pub seconds_scatter: f64,
    /// Upper estimate of its error, in the norm of the request, including the effect of noise: the
    /// distance from the reference plus the uncertainty of the reference; for J6 in f64 the
    /// uncertainty alone.
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
    /// Estimated error of J6 in f64 in this norm, from the distances of degrees 6 and 4 from the
    /// reference, and from noise.
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

/// Methods whose errors the distances from the reference estimate; for others the distances are upper
/// bounds.
const JETS: [AnyMethod; 2] = [
    AnyMethod::Listed(BendingMethod::J4),
    AnyMethod::Listed(BendingMethod::J6),
];

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
    tell(0, "noise, and a reference: jets of degree 8");
    let failed = |source| RecommendError::Surface {
        scalar: Scalar::F64,
        source,
    };
    let noise = noise_of(surface);
    let ground = Ground::new(mesh, positions, noise, quantity).map_err(failed)?;
    let compared = ground.reference().known(quantity);
    if compared == 0 {
        return Err(RecommendError::NoReference { quantity });
    }
    if interrupted() {
        return Ok(None);
    }
    tell(1, "reference: jets of degrees 6 and 4");
    let expected = ground.of_jets().map_err(failed)?;
    // Without noise `jet` is one of these.
    let are_given = JETS.iter().all(|&degree| wish.methods.contains(&degree));
    let is_repeated = |method: AnyMethod| method == BendingMethod::Jet && are_given;
    let mut candidates = Vec::new();
    let mut done = 2;
    for &scalar in &wish.scalars {
        for &method in &wish.methods {
            if interrupted() {
                return Ok(None);
            }
            tell(done, &format!("{method} {scalar}"));
            done += 1;
            if !quantity.is_defined_by(method) || (is_repeated(method) && !noise.is_seen()) {
                continue;
            }
            if method == BendingMethod::Jet && noise.is_seen() {
                // `jet` is measured once, whatever the number types.
                if scalar == Scalar::F64 {
                    let adaptive = Adaptive::new(surface, quantity, &mut |_| !interrupted());
                    let Some(adaptive) = adaptive else {
                        return Ok(None);
                    };
                    candidates.push(expected.of_adaptive(&adaptive, ground.reference(), wish));
                }
                continue;
            }
            let which = (method, wish.options.of(method), scalar);
            let measured = match scalar {
                Scalar::F32 | Scalar::F32Pair => ground.measure::<f32>(which),
                Scalar::F64 => ground.measure::<f64>(which),
            };
            let measured = measured.map_err(|source| RecommendError::Surface { scalar, source })?;
            candidates.push(expected.of_candidate(which, &measured, wish));
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
        noise,
        noise_error: in_norm(expected.noise, wish.norm),
        reference_error: in_norm(expected.error(), wish.norm),
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
struct Expected<'a> {
    /// According to the distances of degrees 6 and 4 from the reference.
    unknown: [f64; 2],
    /// Due to noise; 0 if none was found.
    noise: [f64; 2],
    /// The reference of all methods, if noise was found.
    estimate: Option<&'a Estimate>,
}

impl Expected<'_> {
    fn error(&self) -> [f64; 2] {
        [0, 1].map(|norm| together(self.unknown[norm], self.noise[norm]))
    }

    fn is_resolved(&self) -> bool {
        self.unknown[0] <= RESOLVED.max(self.noise[0])
    }

    /// Expected error of a method, from its measured distances.
    fn of_candidate(
        &self,
        (method, options, scalar): (AnyMethod, MethodOptions, Scalar),
        measured: &Measured,
        wish: &Wish,
    ) -> Candidate {
        let is_bound = !JETS.contains(&method);
        let [distance, noise] =
            [measured.distances, measured.noise].map(|errors| in_norm(errors, wish.norm));
        let expected = match &self.estimate {
            None if method == BendingMethod::J6 && scalar == Scalar::F64 => {
                in_norm(self.unknown, wish.norm)
            }
            None if is_bound => in_norm(self.unknown, wish.norm) + distance,
            None => in_norm(self.unknown, wish.norm).hypot(distance),
            Some(estimate) => {
                let both = in_norm(estimate.error(), wish.norm);
                let own = method == BendingMethod::J6 && estimate.is_j6;
                // Errors of two methods due to the shape are often similar; errors due to noise are
                // not.
                let found = match (is_bound, own) {
                    (true, _) => distance + both,
                    (false, true) => distance.hypot(both),
                    (false, false) => distance.hypot(in_norm(estimate.noise, wish.norm)),
                };
                let found = found.max(noise);
                match wish.norm {
                    Norm::Mean if !is_bound => {
                        let by_shape = noise.hypot(estimate.by_shape(method));
                        between(found, by_shape)
                    }
                    _ => found,
                }
            }
        };
        let [max, mean] = measured.distances;
        Candidate {
            method,
            options,
            scalar,
            max,
            mean,
            seconds: measured.time.median.as_secs_f64(),
            seconds_scatter: measured.time.scatter,
            expected,
            is_bound,
            reaches: self.is_resolved() && expected <= wish.target,
        }
    }

    /// The candidate of the adaptive jet, with its own estimate of its errors.
    fn of_adaptive(&self, adaptive: &Adaptive, reference: &Reference, wish: &Wish) -> Candidate {
        let [max, mean] = reference.errors(&adaptive.fields, wish.quantity);
        let expected = in_norm(adaptive.expected, wish.norm) / reference.scale(wish.quantity);
        Candidate {
            method: BendingMethod::Jet.into(),
            options: MethodOptions::default(),
            scalar: Scalar::F64,
            max,
            mean,
            seconds: adaptive.time.median.as_secs_f64(),
            seconds_scatter: adaptive.time.scatter,
            expected,
            is_bound: false,
            reaches: self.is_resolved() && expected <= wish.target,
        }
    }

    /// The number of vertices that J6 needs for the target, on the same surface with the same
    /// noise.
    fn vertices_needed(&self, vertices: usize, wish: &Wish) -> Option<f64> {
        // Orders with which errors fall with the edge length, and with which errors of noise grow.
        let (order, noise_order) = match wish.quantity {
            Quantity::Mean | Quantity::Gaussian => (5.0, 2.0),
            Quantity::LaplacianOfMean | Quantity::ForceDensity => (3.0, 4.0),
        };
        let [unknown, noise] = [self.unknown, self.noise].map(|error| in_norm(error, wish.norm));
        // If the shape is not resolved, resolution comes first.
        let worst = self.unknown[0] / RESOLVED;
        let count = vertices as f64;
        if noise == 0.0 {
            let excess = (unknown / wish.target).max(worst);
            let needed = (count * excess.powf(2.0 / order)).ceil();
            return needed.is_finite().then_some(needed);
        }
        let suffices = |factor: &f64| {
            let finer = factor.sqrt();
            let shape = unknown * finer.powf(-order);
            let error = together(shape, noise * finer.powf(noise_order));
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

/// The error of J6 due to the shape, from its distance to degree 8 and that of J4: near the limit of
/// resolution degree 8 is hardly better than degree 6.
fn of_sixth(near: f64, far: f64) -> f64 {
    near.max((near * far).sqrt())
}

/// A value between two estimates of an error: one is too low where a method shares its noise with the
/// reference, the other too high where noise is weak. Both are too high near the limit of resolution.
fn between(found: f64, by_shape: f64) -> f64 {
    if by_shape.is_nan() {
        return found;
    }
    by_shape.min((found * by_shape).sqrt())
}

/// Largest number of steps that are tried; each is an eighth of a doubling of the vertices.
const STEPS: u32 = 80;

/// The size of the sum of two independent errors.
fn together(a: f64, b: f64) -> f64 {
    if b == 0.0 { a } else { a.hypot(b) }
}

/// The surface on which methods are measured, and the references with which they are compared.
struct Ground<'a> {
    mesh: &'a TriangleMesh,
    positions: &'a [[f64; 3]],
    quantity: Quantity,
    /// Results of jets of degree 8, at smoothed positions if there is noise.
    degree_8: Reference,
    /// Whether these have degree 8.
    is_whole: bool,
    /// Set if noise was found.
    noisy: Option<Noisy>,
}

/// Largest part of the vertices where jets of degree 8 may have a lower degree, as beside boundaries: where those of degrees 4 and 6 have
/// the same, their distances say nothing.
const LOWERED: f64 = 0.2;

/// Results of jets of degree 8, and whether they have this degree.
fn of_degree_8(
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
) -> Result<(Reference, bool), SurfaceError> {
    let surface = Surface::new(mesh, positions)?;
    let (fields, findings) = Evaluator::reference(1.0, mesh).fields_and_findings(surface);
    let is_lowered = |finding: &&Finding| match **finding {
        Finding::ReducedDegree { vertex, .. } | Finding::TooFewNeighbours { vertex } => {
            mesh.is_interior(vertex as usize)
        }
        _ => false,
    };
    let lowered = findings.iter().filter(is_lowered).count();
    let is_whole = lowered as f64 <= LOWERED * mesh.vertex_count() as f64;
    Ok((Reference::of(&fields), is_whole))
}

/// Measurements of a method in a number type: errors in both norms, and the time.
struct Measured {
    /// Distances from the reference.
    distances: [f64; 2],
    /// Errors due to noise.
    noise: [f64; 2],
    time: Timing,
}

impl<'a> Ground<'a> {
    fn new(
        mesh: &'a TriangleMesh,
        positions: &'a [[f64; 3]],
        noise: Noise<f64>,
        quantity: Quantity,
    ) -> Result<Self, SurfaceError> {
        let noisy = match noise.is_seen() {
            true => Some(Noisy::new(mesh, positions, noise, quantity)?),
            false => None,
        };
        let smooth = noisy.as_ref().map_or(positions, |noisy| &noisy.smooth);
        let (mut degree_8, is_whole) = of_degree_8(mesh, smooth)?;
        if let Some(noisy) = &noisy {
            degree_8 = degree_8.in_units_like(&noisy.estimate.reference);
        }
        Ok(Self {
            mesh,
            positions,
            quantity,
            degree_8,
            is_whole,
            noisy,
        })
    }

    /// Reference that methods are compared with.
    fn reference(&self) -> &Reference {
        match &self.noisy {
            Some(noisy) => &noisy.estimate.reference,
            None => &self.degree_8,
        }
    }

    fn of_jets(&self) -> Result<Expected<'_>, SurfaceError> {
        let smooth = self.noisy.as_ref();
        let smooth = smooth.map_or(self.positions, |noisy| &noisy.smooth);
        let surface = Surface::new(self.mesh, smooth)?;
        let [far, near] = [BendingMethod::J4, BendingMethod::J6].map(|method| {
            let fields = Evaluator::new(method, 1.0, self.mesh).fields(surface);
            self.degree_8.errors(&fields, self.quantity)
        });
        let unknown = [0, 1].map(|norm| match self.is_whole {
            true => of_sixth(near[norm], far[norm]),
            false => f64::INFINITY,
        });
        let mut jets = Evaluator::new(BendingMethod::J6, 1.0, self.mesh);
        let noise = self.noise_of(&mut jets, Scalar::F64)?;
        Ok(Expected {
            unknown,
            noise,
            estimate: self.noisy.as_ref().map(|noisy| &noisy.estimate),
        })
    }

    /// Errors relative to the reference, due to noise and due to the mesh, and the time of an
    /// evaluation.
    fn measure<T: Compiled>(
        &self,
        (method, options, scalar): (AnyMethod, MethodOptions, Scalar),
    ) -> Result<Measured, SurfaceError> {
        let held = HeldPositions::<T>::new(scalar, self.positions);
        let surface = held.surface(self.mesh)?;
        let threads = Parallel::single();
        let modulus = T::one();
        let mut evaluator = method.evaluator(&options, modulus, self.mesh, threads);
        let start = Instant::now();
        evaluator.evaluate(surface);
        let time = Timing::of_runs(start.elapsed(), || evaluator.evaluate(surface));
        let fields = evaluator.last_fields(surface);
        let distances = self.reference().errors(&fields, self.quantity);
        Ok(Measured {
            distances,
            noise: self.noise_of(&mut evaluator, scalar)?,
            time,
        })
    }

    /// The change of the results of a method by additional noise of the same size: the root mean
    /// square, in both norms.
    fn noise_of<T: Evaluated>(
        &self,
        evaluator: &mut Evaluator<T>,
        scalar: Scalar,
    ) -> Result<[f64; 2], SurfaceError> {
        let Some(noisy) = &self.noisy else {
            return Ok([0.0; 2]);
        };
        let mut fields = |positions: &[[f64; 3]]| {
            let held = HeldPositions::<T>::new(scalar, positions);
            Ok::<_, SurfaceError>(evaluator.fields(held.surface(self.mesh)?))
        };
        let here = Reference::of(&fields(self.positions)?).in_units_like(self.reference());
        let mut squares = [0.0; 2];
        for replica in &noisy.replicas {
            let errors = here.errors(&fields(replica)?, self.quantity);
            for (square, error) in squares.iter_mut().zip(errors) {
                *square += error * error / REPLICAS as f64;
            }
        }
        Ok(squares.map(f64::sqrt))
    }
}
