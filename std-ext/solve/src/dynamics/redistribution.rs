//! Redistribution of the vertices of fluid membranes along the surface, towards even triangles.

use super::coordinates::Coordinates;
use super::place::{Place, reciprocal_or_zero};
use super::quadric::Quadric;
use super::vector::{self, Vector};
use super::{Membrane, Motion};
use helfrich::{TriangleMesh, VertexKind};

/// The fraction of the distance to the centre of the surrounding triangles by which a vertex moves.
const SHARE: f64 = 0.5;

/// Root-mean-square displacement, in edges, below which vertices are not moved.
const SETTLED: f64 = 1e-3;

/// Moves every interior vertex of fluid membranes that is not fixed along the surface, part of the way to the
/// area-weighted centre of the triangles around it, so that areas become even and angles good.
/// Returns whether any membrane was moved by more than a thousandth of an edge.
///
/// The shape is unchanged to second order, because each vertex moves on a quadric through itself
/// that is fitted to the neighbours. The quadric needs a linear part, because the sum of area
/// vectors is a normal of only first order.
pub(super) fn redistribute(
    membranes: &[Membrane],
    places: &[Place],
    coordinates: &Coordinates,
    positions: &mut [Vector],
) -> bool {
    let mut moved = false;
    for (membrane, place) in membranes.iter().zip(places) {
        if membrane.motion == Motion::AlongNormals {
            let range = place.vertices();
            let surface = CurrentSurface {
                membrane,
                mesh: &membrane.mesh,
                normals: &coordinates.normals[range.clone()],
                positions: &positions[range.clone()],
            };
            let (displacements, size) = surface.displacements();
            if size > SETTLED {
                moved = true;
                for (position, displacement) in positions[range].iter_mut().zip(displacements) {
                    *position = vector::add(*position, displacement);
                }
            }
        }
    }
    moved
}

struct CurrentSurface<'a> {
    membrane: &'a Membrane,
    mesh: &'a TriangleMesh,
    normals: &'a [Vector],
    positions: &'a [Vector],
}

impl CurrentSurface<'_> {
    /// The displacements, and their root mean square in edges.
    fn displacements(&self) -> (Vec<Vector>, f64) {
        let mut sums = vec![([0.0; 3], 0.0); self.positions.len()];
        let mut total = 0.0;
        for triangle in self.mesh.triangles() {
            let [a, b, c] = triangle.map(|vertex| self.positions[vertex as usize]);
            let (ab, ac) = (vector::sub(b, a), vector::sub(c, a));
            let doubled = vector::norm(vector::cross(ab, ac));
            total += 0.5 * doubled;
            let centre = vector::scale(1.0 / 3.0, vector::add(ab, ac));
            let offsets = [centre, vector::sub(centre, ab), vector::sub(centre, ac)];
            for (&vertex, offset) in triangle.iter().zip(offsets) {
                let (sum, weight) = &mut sums[vertex as usize];
                *sum = vector::add(*sum, vector::scale(doubled, offset));
                *weight += doubled;
            }
        }
        let mut squares = 0.0;
        let mut displacements = vec![[0.0; 3]; self.positions.len()];
        for (vertex, (sum, weight)) in sums.into_iter().enumerate() {
            let fixed = self.membrane.is_fixed(vertex);
            if fixed || self.mesh.vertex_kind(vertex) != VertexKind::Interior {
                continue;
            }
            let offset = vector::scale(SHARE * reciprocal_or_zero(weight), sum);
            let normal = self.normals[vertex];
            let normal_part = vector::dot(offset, normal);
            let along = vector::sub(offset, vector::scale(normal_part, normal));
            squares += vector::dot(along, along);
            displacements[vertex] = match self.height(vertex, along) {
                Some(height) => vector::add(along, vector::scale(height, normal)),
                None => [0.0; 3],
            };
        }
        // In a triangulation of equilateral triangles the squared edge is 2/√3 areas of a vertex.
        let squared_edges = total * 2.0 / 3f64.sqrt();
        (displacements, (squares / squared_edges).sqrt())
    }

    /// The height of the surface over the tangent plane at a distance `along` from the vertex;
    /// `None` if the neighbours do not determine it.
    fn height(&self, vertex: usize, along: Vector) -> Option<f64> {
        let normal = self.normals[vertex];
        let way = vector::norm(along);
        if way == 0.0 {
            return Some(0.0);
        }
        let first = vector::scale(way.recip(), along);
        let axes = [first, vector::cross(normal, first), normal];
        let height = Quadric::fit(self.mesh, self.positions, vertex, axes).height(way);
        // If the surface is this far from its tangent plane, the mesh does not resolve it.
        (height.abs() <= 0.5 * way).then_some(height)
    }
}

#[cfg(test)]
mod tests {
    use super::super::coordinates::Coordinates;
    use super::super::place::Place;
    use super::super::{Membrane, Motion};
    use super::redistribute;
    use helfrich::shapes::Shape;
    use helfrich_mesh::generate::{AnyShape, Family, generate};
    use std::sync::Arc;

    /// The root-mean-square distance of the vertices from an ellipsoid, measured along its normals to
    /// first order, after one redistribution of a mesh on it that moves them by some part of an edge.
    fn distance(vertices: usize) -> f64 {
        let shape: AnyShape = "ellipsoid:1,1,0.5".parse().expect("a shape");
        let generated = generate(&shape, Family::Irregular, vertices, 1).expect("a mesh");
        let membranes = [Membrane {
            mesh: Arc::new(generated.mesh.clone()),
            bending_modulus: 1.0,
            in_plane_modulus: 0.0,
            motion: Motion::AlongNormals,
            fixed: Vec::new(),
        }];
        let places = Place::of(&membranes);
        let mut positions = generated.positions.clone();
        let coordinates = Coordinates::new(&membranes, &places, &positions);
        assert!(redistribute(
            &membranes,
            &places,
            &coordinates,
            &mut positions
        ));
        let off = |position: &[f64; 3]| {
            let nearest = shape.position(shape.preimage(*position));
            let squares = (0..3).map(|axis| (position[axis] - nearest[axis]).powi(2));
            squares.sum::<f64>()
        };
        let sum: f64 = positions.iter().map(off).sum();
        (sum / vertices as f64).sqrt()
    }

    #[test]
    fn keeps_the_shape_to_third_order() {
        let (coarse, fine) = (distance(642), distance(2562));
        // Third order: halving the edges divides the distance by 8.
        assert!(fine < coarse / 7.0, "{coarse:e} {fine:e}");
    }
}
