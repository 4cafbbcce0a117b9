//! Errors of methods on meshes inscribed in exact shapes.

use helfrich::shapes::{ExactPoint, Shape};
use helfrich::{
    Cotangent, Curvature, DualArea, Energy, Force, LaplaceBeltrami, Prepared, StrongForm, Surface,
};
use helfrich_std::generate::GeneratedMesh;

/// Errors over the vertices, relative to the largest exact value. If that is 0 (Δ_S H and f on
/// spheres), they are relative to a power of the sphere's curvature.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// Largest error.
    pub max: f64,
    /// Area-weighted mean error.
    pub mean: f64,
}

/// Errors of a method in strong form on one mesh, with κ = 1.
#[derive(Clone, Copy, Debug)]
pub struct StrongFormErrors {
    /// Errors of H.
    pub mean: Errors,
    /// Errors of K.
    pub gaussian: Errors,
    /// Errors of Δ_S H.
    pub laplacian_of_mean: Errors,
    /// Errors of f, as a vector.
    pub force_density: Errors,
    /// Energy from the method's own areas and H, with κ = 1.
    pub energy: f64,
}

/// Surface of a generated mesh.
///
/// # Panics
/// If the mesh is not valid; generated meshes always are.
pub fn surface(made: &GeneratedMesh) -> Surface<'_, f64> {
    Surface::new(&made.mesh, &made.positions).expect("generated positions are finite")
}

/// The exact values at the vertices.
pub fn exact_points(made: &GeneratedMesh) -> Vec<ExactPoint<f64>> {
    let preimages = made.preimages.iter();
    preimages.map(|&preimage| made.shape.at(preimage)).collect()
}

/// n, H, K and mixed areas at the vertices, by the cotangent operator.
pub fn cotangent_curvature(surface: Surface<'_, f64>) -> Vec<Curvature<f64>> {
    let mut cotangent = Prepared::new(Cotangent::new(DualArea::Mixed), surface.mesh());
    cotangent.curvatures(surface).to_vec()
}

/// Errors at the vertices. `exact` is the exact value; `error` gives the absolute error of a vertex from its
/// number and its exact value. An error of NaN counts as infinite.
pub fn errors(
    made: &GeneratedMesh,
    exact: impl Fn(&ExactPoint<f64>) -> f64,
    error: impl Fn(usize, f64) -> f64,
) -> Errors {
    let points = exact_points(made);
    let areas = cotangent_curvature(surface(made));
    let largest = points.iter().map(|p| exact(p).abs()).fold(0.0, f64::max);
    let scale = if largest > 1e-9 { largest } else { 1.0 };
    let (mut max, mut weighted, mut weights) = (0.0_f64, 0.0, 0.0);
    for (vertex, point) in points.iter().enumerate() {
        let error = error(vertex, exact(point));
        max = if error.is_nan() {
            f64::INFINITY
        } else {
            max.max(error)
        };
        weighted += areas[vertex].area * error;
        weights += areas[vertex].area;
    }
    Errors {
        max: max / scale,
        mean: weighted / weights / scale,
    }
}

/// Errors of the force density f = `force`/`area`. If `force` is a density already, `area` returns 1.
pub fn density_errors(
    made: &GeneratedMesh,
    force: &[[f64; 3]],
    area: impl Fn(usize) -> f64,
) -> Errors {
    let points = exact_points(made);
    errors(
        made,
        |point| point.force_density(1.0),
        |vertex, exact| {
            let part =
                |k: usize| force[vertex][k] / area(vertex) - exact * points[vertex].normal[k];
            (0..3).map(|k| part(k).powi(2)).sum::<f64>().sqrt()
        },
    )
}

/// Evaluates a method in strong form on a closed mesh with κ = 1.
pub fn of_strong_form<L: LaplaceBeltrami<f64> + Sync>(
    method: StrongForm<f64, L>,
    made: &GeneratedMesh,
) -> StrongFormErrors {
    let surface = surface(made);
    let mut prepared = Prepared::new(method, &made.mesh);
    let mut density = vec![[0.0; 3]; made.mesh.vertex_count()];
    prepared.force_density(surface, &mut density);
    let memory = prepared.memory();
    let curvature = memory.curvature().to_vec();
    let laplacian = memory.laplacian_of_mean().to_vec();
    StrongFormErrors {
        mean: errors(
            made,
            |p| p.mean,
            |v, exact| (curvature[v].mean - exact).abs(),
        ),
        gaussian: errors(
            made,
            |p| p.gaussian,
            |v, exact| (curvature[v].gaussian - exact).abs(),
        ),
        laplacian_of_mean: errors(
            made,
            |p| p.laplacian_of_mean,
            |v, exact| (laplacian[v] - exact).abs(),
        ),
        force_density: density_errors(made, &density, |_| 1.0),
        energy: prepared.energy(surface),
    }
}

/// Nodal forces and energy of a method.
pub fn force_and_energy<M>(method: M, surface: Surface<'_, f64>) -> (Vec<[f64; 3]>, f64)
where
    M: Force<f64> + Energy<f64>,
{
    let mut prepared = Prepared::new(method, surface.mesh());
    let mut force = vec![[0.0; 3]; surface.mesh().vertex_count()];
    prepared.add_force(surface, &mut force);
    let energy = prepared.energy(surface);
    (force, energy)
}
