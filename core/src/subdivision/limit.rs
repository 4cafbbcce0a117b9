//! Limit positions and normals of vertices under infinite refinement.

use super::masks::{BOUNDARY_LIMIT, limit_weight};
use super::stencils::Stencils;
use crate::element::Execution;
use crate::mesh::{TriangleMesh, VertexKind};
use crate::real::Real;
use crate::vec3::{add, cross, normalise, scale, sub};
use core::f64::consts::{PI, TAU};
use num_traits::Float;

/// The map L from control points to the points of the limit surface under the vertices.
///
/// Its rows sum to 1. On a closed mesh `L = I − ω Δ` with the graph Laplacian Δ; all eigenvalues
/// lie between `1 − 3/2 max(nω) ≥ 1/10` and 1.
pub fn limit_positions(mesh: &TriangleMesh) -> Stencils {
    let vertices = mesh.vertex_count();
    let entries = vertices + mesh.ring_vertices().len();
    let mut map = Stencils::with_capacity(vertices, vertices, entries);
    for vertex in 0..vertices {
        let ring = mesh.one_ring(vertex);
        let centre = vertex as u32;
        match (mesh.vertex_kind(vertex), ring) {
            (VertexKind::Boundary, &[first, .., last]) => {
                let [middle, side] = BOUNDARY_LIMIT;
                map.push_row([(centre, middle), (first, side), (last, side)]);
            }
            (VertexKind::Interior, ring) => {
                let omega = limit_weight(ring.len());
                let neighbours = ring.iter().map(|&neighbour| (neighbour, omega));
                let middle = (centre, 1.0 - ring.len() as f64 * omega);
                map.push_row(core::iter::once(middle).chain(neighbours));
            }
            _ => map.push_row([(centre, 1.0)]),
        }
    }
    map
}

/// Sets `normals` to the outward unit normals of the limit surface under the vertices; 0 at isolated
/// vertices, and where control points coincide so that there is no tangent plane.
///
/// At a boundary vertex in more than five triangles, Loop's rules leave no tangent plane that would
/// contain the boundary and the surface: the normal is that of the boundary's tangent and the
/// dominant direction across.
///
/// # Panics
/// If `controls` or `normals` have fewer entries than the mesh has vertices.
pub fn limit_normals<T: Real>(
    execution: &impl Execution,
    mesh: &TriangleMesh,
    controls: &[[T; 3]],
    normals: &mut [[T; 3]],
) {
    execution.map(&mut normals[..mesh.vertex_count()], |vertex, normal| {
        *normal = limit_normal(mesh, vertex, |v| controls[v as usize]);
    });
}

/// The normal at one vertex, from two tangents: eigenvectors of refinement around it.
pub(crate) fn limit_normal<T: Real>(
    mesh: &TriangleMesh,
    vertex: usize,
    control: impl Fn(u32) -> [T; 3],
) -> [T; 3] {
    let ring = mesh.one_ring(vertex);
    let centre = control(vertex as u32);
    let kind = mesh.vertex_kind(vertex);
    let mut tangents = [[T::zero(); 3]; 2];
    for (at, &neighbour) in ring.iter().enumerate() {
        let spoke = sub(control(neighbour), centre);
        let weights = match kind {
            VertexKind::Interior => interior_weights(at, ring.len()),
            _ => boundary_weights(at, ring.len()),
        };
        for (tangent, weight) in tangents.iter_mut().zip(weights) {
            *tangent = add(*tangent, scale(T::constant(weight), spoke));
        }
    }
    normalise(cross(tangents[0], tangents[1]))
}

/// `Σ cos(2πk/n) c_k` and `Σ sin(2πk/n) c_k`.
fn interior_weights(at: usize, count: usize) -> [f64; 2] {
    let (sine, cosine) = Float::sin_cos(TAU * at as f64 / count as f64);
    [cosine, sine]
}

/// `c_1 − c_n` along the boundary, against the order of the ring; and inward, relative to the
/// vertex, `Σ sin((k−1)θ) c_k + a (c_1 + c_n)` with θ = π/(n − 1) and
/// `a = −sin θ cos θ/((1 − cos θ)(1 + 2 cos θ))`; in a single triangle `c_1 + c_2`.
fn boundary_weights(at: usize, count: usize) -> [f64; 2] {
    let step = PI / (count - 1) as f64;
    let (sine, cosine) = Float::sin_cos(step);
    let side = match count {
        2 => 1.0,
        _ => -sine * cosine / ((1.0 - cosine) * (1.0 + 2.0 * cosine)),
    };
    match at {
        0 => [1.0, side],
        _ if at + 1 == count => [-1.0, side],
        _ => [0.0, Float::sin(step * at as f64)],
    }
}
