//! The Laplacian of a mesh by cotangents, in the entries that a factorisation takes.

use super::vector;
use helfrich::TriangleMesh;

/// The area below which a triangle counts as this large, in mean areas of a triangle.
const LEAST_AREA: f64 = 1e-3;

/// Cotangent stiffness S and lumped areas M, so that `Σ_j S_ij u_j/M_i` is −Δu.
#[derive(Clone, Debug)]
pub(crate) struct Cotangents {
    /// The entries of S off the diagonal, one per edge.
    pub(crate) edges: Vec<f64>,
    /// The entries of M, one per vertex.
    pub(crate) areas: Vec<f64>,
    /// The area of the surface.
    pub(crate) total: f64,
}

impl Cotangents {
    pub(crate) fn new(mesh: &TriangleMesh, positions: &[[f64; 3]]) -> Self {
        let mut stiffness = vec![0.0; mesh.edges().len()];
        let mut areas = vec![0.0; mesh.vertex_count()];
        let corners = |triangle: &[u32; 3]| triangle.map(|vertex| positions[vertex as usize]);
        for triangle in mesh.triangles() {
            let [a, b, c] = corners(triangle);
            let area = 0.5 * vector::norm(vector::cross(vector::sub(b, a), vector::sub(c, a)));
            for &vertex in triangle {
                areas[vertex as usize] += area / 3.0;
            }
        }
        let total: f64 = areas.iter().sum();
        let mean = total / mesh.triangles().len() as f64;
        for (edge, value) in stiffness.iter_mut().enumerate() {
            let [a, b] = mesh.edges()[edge];
            let (left, right) = mesh.edge_triangles(edge);
            for triangle in [Some(left), right].into_iter().flatten() {
                let triangle = mesh.triangles()[triangle as usize];
                let apex = triangle.into_iter().find(|&v| v != a && v != b);
                let [p, q, r] = [a, b, apex.unwrap_or(a)].map(|v| positions[v as usize]);
                let (u, v) = (vector::sub(p, r), vector::sub(q, r));
                let area = 0.5 * vector::norm(vector::cross(u, v));
                // The matrix of a triangle is positive semi-definite for any divisor, so a lower
                // bound of the area is safe: it keeps slivers from dominating the others.
                *value -= vector::dot(u, v) / (4.0 * area.max(LEAST_AREA * mean));
            }
        }
        for area in &mut areas {
            // Vertices in no triangle, and those of triangles without area.
            *area = area.max(LEAST_AREA * mean);
        }
        Self {
            edges: stiffness,
            areas,
            total,
        }
    }
}

/// The diagonal of `α M + β S` for the factors `[α, β]`.
pub(crate) fn diagonal(
    mesh: &TriangleMesh,
    areas: &[f64],
    edges: &[f64],
    [alpha, beta]: [f64; 2],
) -> Vec<f64> {
    let mut diagonal: Vec<f64> = areas.iter().map(|area| alpha * area).collect();
    for (&[a, b], &value) in mesh.edges().iter().zip(edges) {
        diagonal[a as usize] -= beta * value;
        diagonal[b as usize] -= beta * value;
    }
    diagonal
}
