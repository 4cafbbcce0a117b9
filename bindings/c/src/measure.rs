//! Curvatures with error bars.

use crate::call::{Call, surface};
use crate::membrane::threads;
use crate::mesh::Mesh;
use crate::number::Number;
use crate::status::{Failure, Outcome};
use helfrich::{AdaptiveJet, Estimate, Measured as Vertex, Verdict};
use helfrich_std::execute::with_threads;
use helfrich_std::noise::measured;

/// The verdicts in the order of their numbers.
pub(crate) const VERDICTS: [Verdict; 5] = [
    Verdict::Clean,
    Verdict::Noise,
    Verdict::Unresolved,
    Verdict::OneSided,
    Verdict::Unknown,
];

/// Arrays of the caller for curvatures with error bars at vertices: `count` entries each, or NULL where a result
/// is not wanted. The true error is estimated to be within the error bar at 99 of 100 vertices. A value that is
/// not known is 0, with an infinite error.
#[derive(Debug)]
#[repr(C)]
pub struct Measured<N> {
    /// Mean curvature H, 1/length, positive on a sphere.
    pub mean: *mut N,
    /// Error bar of H.
    pub mean_error: *mut N,
    /// Gaussian curvature K, 1/length².
    pub gaussian: *mut N,
    /// Error bar of K.
    pub gaussian_error: *mut N,
    /// Principal curvatures k1 ≥ k2, 1/length.
    pub principal: *mut [N; 2],
    /// Error bars of the principal curvatures.
    pub principal_error: *mut [N; 2],
    /// Unit vectors along k1 and k2; 0 near umbilics, where they are not known.
    pub directions: *mut [[N; 3]; 2],
    /// f = 2[Δ_S H + 2H(H² − K)], the force density along the normal for κ = 1, 1/length³.
    pub force_density: *mut N,
    /// Error bar of the force density.
    pub force_density_error: *mut N,
    /// Outward unit normal; 0 where it is not known.
    pub normal: *mut [N; 3],
    /// Standard deviation of the noise along the normal, a length; 0 if none was found.
    pub deviation: *mut N,
    /// Verdict on the mesh around the vertex, by the numbers of hf_verdict_name.
    pub verdict: *mut u32,
}

/// The arrays that are wanted of one kind.
fn put<V>(place: Option<&mut [V]>, vertices: &[Vertex<f64>], of: impl Fn(&Vertex<f64>) -> V) {
    if let Some(place) = place {
        for (place, vertex) in place.iter_mut().zip(vertices) {
            *place = of(vertex);
        }
    }
}

fn value<N: Number>(estimate: Estimate<f64>) -> N {
    N::nearest(if estimate.value.is_finite() {
        estimate.value
    } else {
        0.0
    })
}

fn error<N: Number>(estimate: Estimate<f64>) -> N {
    let known = estimate.value.is_finite() && !estimate.error.is_nan();
    N::nearest(if known { estimate.error } else { f64::INFINITY })
}

fn measure<N: Number>(
    call: &mut Call,
    mesh: *const Mesh,
    (positions, count): (*const [N; 3], usize),
    deviation: f64,
    thread_count: usize,
    results: *const Measured<N>,
) -> Outcome {
    let mesh = &call.object("mesh", mesh)?.triangles;
    let positions = call.at_vertices("positions", positions, count, mesh)?;
    let surface = surface(mesh, &positions)?;
    if !(deviation >= 0.0 && deviation.is_finite()) {
        let text = format!("`deviation` is {deviation}: a length of 0 or above is needed");
        return Err(Failure::argument(text));
    }
    let results = call.object("results", results)?;
    let mean = call.write_if_wanted("mean", results.mean, count)?;
    let mean_error = call.write_if_wanted("mean_error", results.mean_error, count)?;
    let gaussian = call.write_if_wanted("gaussian", results.gaussian, count)?;
    let gaussian_error = call.write_if_wanted("gaussian_error", results.gaussian_error, count)?;
    let principal = call.write_if_wanted("principal", results.principal, count)?;
    let principal_error =
        call.write_if_wanted("principal_error", results.principal_error, count)?;
    let directions = call.write_if_wanted("directions", results.directions, count)?;
    let density = call.write_if_wanted("force_density", results.force_density, count)?;
    let density_error =
        call.write_if_wanted("force_density_error", results.force_density_error, count)?;
    let normal = call.write_if_wanted("normal", results.normal, count)?;
    let noise = call.write_if_wanted("deviation", results.deviation, count)?;
    let verdict = call.write_if_wanted("verdict", results.verdict, count)?;

    let jet = AdaptiveJet {
        deviation,
        extent: None,
    };
    let vertices = with_threads(threads(thread_count), || {
        measured(&jet, surface, &mut |_| true)
    });
    let vertices = vertices.unwrap_or_default();
    let vector = |of: [f64; 3]| of.map(N::nearest);
    put(mean, &vertices, |at| value(at.mean));
    put(mean_error, &vertices, |at| error(at.mean));
    put(gaussian, &vertices, |at| value(at.gaussian));
    put(gaussian_error, &vertices, |at| error(at.gaussian));
    put(principal, &vertices, |at| at.principal.map(value));
    put(principal_error, &vertices, |at| at.principal.map(error));
    put(directions, &vertices, |at| {
        at.directions.unwrap_or_default().map(vector)
    });
    put(density, &vertices, |at| value(at.force_density));
    put(density_error, &vertices, |at| error(at.force_density));
    put(normal, &vertices, |at| vector(at.normal));
    put(noise, &vertices, |at| N::nearest(at.deviation));
    put(verdict, &vertices, |at| {
        let number = VERDICTS.iter().position(|known| *known == at.verdict);
        number.unwrap_or_default() as u32
    });
    Ok(())
}

twins! {
    /// Measures curvatures with error bars, by jets that choose their degree and neighbours from the noise at each
    /// vertex, on up to `threads` threads, 0 for all.
    ///
    /// `positions` has `count` rows of three. `deviation` is the known standard deviation of positions along the
    /// normal, a length, or 0: noise is estimated in either case. Sets the arrays of `results`.
    fn hf_measure, hf_measure_f32<$N>(
        mesh: *const Mesh, positions: *const [$N; 3], count: usize, deviation: f64, threads: usize,
        results: *const Measured<$N>,
    ) |call| measure(call, mesh, (positions, count), deviation, threads, results)
}
