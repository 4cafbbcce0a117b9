//! Two triangles that meet in an edge, and the angle between them.

use crate::element::Corners;
use crate::lane::Lane;
use crate::mesh::TriangleMesh;
use crate::vec3::{Vec3, add, cross, dot, neg, norm, scale, sub};
use alloc::vec::Vec;

/// The interior edges of a mesh, each with its four vertices: the ends a and b, then the opposite
/// corner in the triangle on the left, then the one in the triangle on the right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hinges {
    pub(crate) vertices: Vec<[u32; 4]>,
}

impl Hinges {
    pub(crate) fn new(mesh: &TriangleMesh) -> Self {
        let opposite = |triangle: u32, [a, b]: [u32; 2]| {
            // The third corner is the exclusive or of the two ends and all three indices.
            let [i, j, k] = mesh.triangles()[triangle as usize];
            i ^ j ^ k ^ a ^ b
        };
        let hinge = |(index, &edge): (usize, &[u32; 2])| {
            let (left, right) = mesh.edge_triangles(index);
            right.map(|right| {
                [
                    edge[0],
                    edge[1],
                    opposite(left, edge),
                    opposite(right, edge),
                ]
            })
        };
        Self {
            vertices: mesh.edges().iter().enumerate().filter_map(hinge).collect(),
        }
    }
}

/// One hinge: the sine and cosine of its angle, and the ingredients of its gradient.
pub(crate) struct Hinge<L> {
    edge: Vec3<L>,
    pub(crate) edge_length: L,
    /// One over the edge's length.
    along: L,
    normals: [Vec3<L>; 2],
    reciprocals: [L; 2],
    pub(crate) cosine: L,
    pub(crate) sine: L,
    /// 1, or 0 where a triangle or the edge has no extent.
    pub(crate) presence: L,
}

impl<L: Lane> Hinge<L> {
    #[inline(always)]
    pub(crate) fn new(corners: &Corners<L, 4>) -> Self {
        let edge = corners.difference(0, 1);
        let left = cross(edge, corners.difference(0, 2));
        let right = cross(corners.difference(0, 3), edge);
        let edge_length = norm(edge);
        let lengths = [norm(left), norm(right)];
        let reciprocals = lengths.map(L::reciprocal_or_zero);
        let normals = [scale(reciprocals[0], left), scale(reciprocals[1], right)];
        let along = edge_length.reciprocal_or_zero();
        // Each factor is 1 to rounding, or 0, so that no product overflows.
        let sides = (lengths[0] * reciprocals[0]) * (lengths[1] * reciprocals[1]);
        let present = (edge_length * along) * sides;
        Self {
            edge,
            edge_length,
            along,
            normals,
            reciprocals,
            cosine: dot(normals[0], normals[1]),
            sine: dot(edge, cross(normals[0], normals[1])) * along,
            presence: L::select(L::zero().less(present), L::literal(1.0), L::zero()),
        }
    }

    /// θ in (−π, π]; 0 where a triangle or the edge has no extent.
    #[inline(always)]
    pub(crate) fn angle(&self) -> L {
        // If the hinge has no extent, sine and cosine are 0 or meaningless.
        self.presence * self.sine.atan2(self.cosine)
    }

    /// The unit vector along the edge; 0 for one without length.
    #[inline(always)]
    pub(crate) fn direction(&self) -> Vec3<L> {
        scale(self.along, self.edge)
    }

    /// `−torque ∂θ/∂x` at the four corners. Moving an opposite corner along the normal of its
    /// triangle lowers θ by the inverse of its height. The ends of the edge share the opposite
    /// force in proportion to the position of the corner's foot between them.
    #[inline(always)]
    pub(crate) fn forces(&self, corners: &Corners<L, 4>, torque: L) -> [Vec3<L>; 4] {
        let lever = |side: usize| scale(torque * self.reciprocals[side], self.normals[side]);
        let (left, right) = (lever(0), lever(1));
        // Scalar products of the edge with the vectors from its ends to the corner.
        let from_b = |corner: usize| dot(corners.difference(corner, 1), self.edge) * self.along;
        let from_a = |corner: usize| dot(corners.difference(0, corner), self.edge) * self.along;
        [
            neg(add(scale(from_b(2), left), scale(from_b(3), right))),
            neg(add(scale(from_a(2), left), scale(from_a(3), right))),
            scale(self.edge_length, left),
            scale(self.edge_length, right),
        ]
    }

    /// `weight ∂(l θ)/∂x = weight (θ ∂l + l ∂θ)` at the four corners, l the edge's length.
    #[inline(always)]
    pub(crate) fn length_times_angle_gradient(
        &self,
        corners: &Corners<L, 4>,
        weight: L,
    ) -> [Vec3<L>; 4] {
        let weight = weight * self.presence;
        let [a, b, left, right] = self.forces(corners, -(weight * self.edge_length));
        let stretch = scale(weight * self.angle(), self.direction());
        [sub(a, stretch), add(b, stretch), left, right]
    }
}
