//! Vertices, degrees of freedom, normals and areas of several membranes.

use super::vector::{self, Vector};
use super::{Membrane, Motion};
use helfrich::VertexKind;

/// The ranges of a membrane's vertices and numbers among those of all membranes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) first_vertex: usize,
    pub(super) vertices: usize,
    pub(super) first_number: usize,
    pub(super) width: usize,
    /// Whether the membrane is fluid.
    pub(super) along_normals: bool,
}

impl Place {
    /// The ranges of consecutive membranes.
    pub(super) fn of(membranes: &[Membrane]) -> Vec<Self> {
        let (mut first_vertex, mut first_number) = (0, 0);
        let mut place = |membrane: &Membrane| {
            let vertices = membrane.mesh.vertex_count();
            let along_normals = membrane.motion == Motion::AlongNormals;
            let place = Self {
                first_vertex,
                vertices,
                first_number,
                width: if along_normals && !has_free_edge(membrane) {
                    1
                } else {
                    3
                },
                along_normals,
            };
            first_vertex += vertices;
            first_number += place.width * vertices;
            place
        };
        membranes.iter().map(&mut place).collect()
    }

    pub(super) fn vertices(&self) -> std::ops::Range<usize> {
        self.first_vertex..self.first_vertex + self.vertices
    }

    pub(super) fn numbers(&self) -> std::ops::Range<usize> {
        self.first_number..self.first_number + self.width * self.vertices
    }
}

/// Whether any vertex of an edge can move.
fn has_free_edge(membrane: &Membrane) -> bool {
    let kinds = membrane.mesh.vertex_kinds().iter().enumerate();
    let mut edge = kinds.filter(|(_, kind)| **kind == VertexKind::Boundary);
    edge.any(|(vertex, _)| !membrane.is_fixed(vertex))
}

/// Number of degrees of freedom.
pub(super) fn number_count(places: &[Place]) -> usize {
    places.last().map_or(0, |place| place.numbers().end)
}

/// Unit normals and areas of vertices. The normal is the normalised sum of the area vectors around
/// the vertex (which is ∂V/∂x), 0 where the sum vanishes; the area is a third of that of the
/// triangles around it.
pub(super) fn geometry(
    membranes: &[Membrane],
    places: &[Place],
    positions: &[Vector],
) -> (Vec<Vector>, Vec<f64>) {
    let mut normals = vec![[0.0; 3]; positions.len()];
    let mut areas = vec![0.0; positions.len()];
    for (membrane, place) in membranes.iter().zip(places) {
        for triangle in membrane.mesh.triangles() {
            let corners = triangle.map(|vertex| place.first_vertex + vertex as usize);
            let [a, b, c] = corners.map(|vertex| positions[vertex]);
            let doubled = vector::cross(vector::sub(b, a), vector::sub(c, a));
            let share = vector::norm(doubled) / 6.0;
            for corner in corners {
                normals[corner] = vector::add(normals[corner], doubled);
                areas[corner] += share;
            }
        }
    }
    for normal in &mut normals {
        *normal = vector::unit(*normal);
    }
    (normals, areas)
}

pub(super) fn reciprocal_or_zero(value: f64) -> f64 {
    if value > 0.0 { value.recip() } else { 0.0 }
}
