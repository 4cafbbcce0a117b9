//! Which method to take on a mesh of one's own: measured there.
//!
//! Nobody knows the exact curvatures of such a mesh. Jets of degree 8 stand in for them, and how far
//! degrees 6 and 4 are from them says what is not known: the error of J6 is taken as the distance of
//! degree 6, or the geometric mean of the two distances if that is larger (near the limit of what a
//! mesh resolves degree 8 is hardly better than degree 6, and their errors are alike). On exact shapes
//! (discocyte, ellipsoids, tori; regular, irregular and hard meshes of 42 vertices and more) the true
//! error of J6 was at most 1.3 times that wherever it was below a half at the worst vertex. Beyond
//! [`RESOLVED`] there nothing is promised. All of this takes the vertices to lie on a smooth surface:
//! noise in them is curvature for every method, and shows as an error of the reference.

use crate::answer::Norm;
use crate::execute::Parallel;
use crate::method::{BendingMethod, Evaluated, Evaluator};
use crate::scalar::{HeldPositions, Scalar};
use crate::study::{Progress, Quantity, Reference, median_time};
use helfrich::{Surface, SurfaceError, TriangleMesh};
use serde::Serialize;
use std::time::Instant;

/// What is wished for.
#[derive(Clone, Debug, PartialEq)]
pub struct Wish {
    /// What has to be accurate.
    pub quantity: Quantity,
    /// Which error counts.
    pub norm: Norm,
    /// How large it may be, relative to the largest value on the surface.
    pub target: f64,
    /// The methods to choose from.
    pub methods: Vec<BendingMethod>,
    /// The number types to choose from.
    pub scalars: Vec<Scalar>,
}

/// One method in one number type, as measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Candidate {
    /// The method.
    pub method: BendingMethod,
    /// The number type.
    pub scalar: Scalar,
    /// Largest distance from the reference, relative to the largest value; infinite, which JSON writes
    /// as null, if a vertex has no result.
    pub max: f64,
    /// Area-weighted mean distance, relative to the same.
    pub mean: f64,
    /// Median time of one evaluation of the mesh, on one thread.
    pub seconds: f64,
    /// The most that its error is expected to be, in the norm of the wish: the distance from the
    /// reference, and what is not known of that; of J6 in f64 the latter alone.
    pub expected: f64,
    /// Whether that is known, and within the target.
    pub reaches: bool,
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Recommendation {
    /// How many vertices the mesh has.
    pub vertices: usize,
    /// At how many of them there is a reference: all but those at a boundary, or in no triangle.
    pub compared: usize,
    /// What has to be accurate.
    pub quantity: Quantity,
    /// `max` or `mean`.
    pub norm: &'static str,
    /// How large the error may be.
    pub target: f64,
    /// About what is not known, in that norm: the error of J6 in f64, by how far degrees 6 and 4 are
    /// from the reference.
    pub reference_error: f64,
    /// Whether the mesh resolves the shape: whether the error of J6 in f64 at the worst vertex is at
    /// most [`RESOLVED`]. If not, no candidate is known to reach anything.
    pub is_resolved: bool,
    /// The candidate that reaches the target in the shortest time.
    pub choice: Option<Candidate>,
    /// The one with the smallest expected error.
    pub nearest: Option<Candidate>,
    /// If none reaches it: how many vertices J6 would need, by the order that theory gives it, h³ for
    /// f and Δ_S H, h⁵ for H and K.
    pub vertices_needed: Option<f64>,
    /// Everything that was measured, fastest first.
    pub candidates: Vec<Candidate>,
}

/// Up to which what is not known at the worst vertex says how much that is: beyond, one vertex may be so
/// far off that it is the largest value itself, against which all the others look small.
pub const RESOLVED: f64 = 0.2;

/// Why there is no recommendation.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecommendError {
    /// The positions cannot be used in this number type.
    #[error("the mesh cannot be held in {scalar}: {source}")]
    Surface {
        /// The number type.
        scalar: Scalar,
        /// What is wrong.
        source: SurfaceError,
    },
    /// No vertex has a reference.
    #[error(
        "no vertex has neighbours enough to know its {}: a mesh with some dozen vertices away from its \
         boundary is needed", quantity.symbol()
    )]
    NoReference {
        /// What would be compared.
        quantity: Quantity,
    },
}

/// Measures every candidate on a mesh, and chooses. None if it was interrupted.
///
/// # Errors
/// If the positions do not fit a number type, or no vertex can be compared.
pub fn recommend(
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
    wish: &Wish,
    interrupted: &dyn Fn() -> bool,
    progress: &mut dyn FnMut(Progress<'_>),
) -> Result<Option<Recommendation>, RecommendError> {
    let quantity = wish.quantity;
    let surface = Surface::new(mesh, positions).map_err(|source| RecommendError::Surface {
        scalar: Scalar::F64,
        source,
    })?;
    let total = (wish.methods.len() * wish.scalars.len() + 2) as u64;
    let mut tell = |done: u64, at: &str| progress(Progress { done, total, at });
    tell(0, "reference: jets of degree 8");
    let reference = Reference::of(&Evaluator::reference(1.0, mesh).fields(surface));
    let compared = reference.known(quantity);
    if compared == 0 {
        return Err(RecommendError::NoReference { quantity });
    }
    if interrupted() {
        return Ok(None);
    }
    tell(1, "reference: jets of degrees 6 and 4");
    let in_norm = |[max, mean]: [f64; 2]| match wish.norm {
        Norm::Max => max,
        Norm::Mean => mean,
    };
    let [far, near] = [BendingMethod::J4, BendingMethod::J6].map(|method| {
        let fields = Evaluator::new(method, 1.0, mesh).fields(surface);
        reference.errors(&fields, quantity)
    });
    let unknown = [0, 1].map(|norm| near[norm].max((near[norm] * far[norm]).sqrt()));
    let reference_error = in_norm(unknown);
    let [unknown_at_worst, _] = unknown;
    let is_resolved = unknown_at_worst <= RESOLVED;
    let mut candidates = Vec::new();
    let mut done = 2;
    for &scalar in &wish.scalars {
        for &method in &wish.methods {
            if interrupted() {
                return Ok(None);
            }
            tell(done, &format!("{method} {scalar}"));
            done += 1;
            if !quantity.is_defined_by(method) {
                continue;
            }
            let measured = match scalar {
                Scalar::F32 | Scalar::F32Pair => {
                    measure::<f32>(mesh, positions, (method, scalar), &reference, quantity)
                }
                Scalar::F64 => {
                    measure::<f64>(mesh, positions, (method, scalar), &reference, quantity)
                }
            };
            let (errors, seconds) =
                measured.map_err(|source| RecommendError::Surface { scalar, source })?;
            let own = (method, scalar) == (BendingMethod::J6, Scalar::F64);
            let expected = reference_error + if own { 0.0 } else { in_norm(errors) };
            candidates.push(Candidate {
                method,
                scalar,
                max: errors[0],
                mean: errors[1],
                seconds,
                expected,
                reaches: is_resolved && expected <= wish.target,
            });
        }
    }
    candidates.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let choice = candidates.iter().find(|candidate| candidate.reaches);
    let nearest = candidates
        .iter()
        .min_by(|a, b| a.expected.total_cmp(&b.expected));
    let order = match quantity {
        Quantity::Mean | Quantity::Gaussian => 5.0,
        Quantity::LaplacianOfMean | Quantity::ForceDensity => 3.0,
    };
    // Where the shape is not resolved, that has to come first.
    let excess = (reference_error / wish.target).max(unknown_at_worst / RESOLVED);
    let needed = mesh.vertex_count() as f64 * excess.powf(2.0 / order);
    Ok(Some(Recommendation {
        vertices: mesh.vertex_count(),
        compared,
        quantity,
        norm: wish.norm.name(),
        target: wish.target,
        reference_error,
        is_resolved,
        choice: choice.copied(),
        nearest: nearest.copied(),
        vertices_needed: (choice.is_none() && needed.is_finite()).then(|| needed.ceil()),
        candidates,
    }))
}

/// Largest and mean distance from the reference, and the time of an evaluation.
fn measure<T: Evaluated>(
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
    (method, scalar): (BendingMethod, Scalar),
    reference: &Reference,
    quantity: Quantity,
) -> Result<([f64; 2], f64), SurfaceError> {
    let held = HeldPositions::<T>::new(scalar, positions);
    let surface = held.surface(mesh)?;
    let mut evaluator = Evaluator::on_threads(method, T::one(), mesh, Parallel::single());
    let start = Instant::now();
    evaluator.evaluate(surface);
    let time = median_time(start.elapsed(), || evaluator.evaluate(surface));
    let errors = reference.errors(&evaluator.last_fields(surface), quantity);
    Ok((errors, time.as_secs_f64()))
}
