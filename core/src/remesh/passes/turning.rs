//! Triangles that are turned against the input.

use super::{COMPASS, Remesher};
use crate::edit::Freedom;
use crate::face_tree::MeshPoint;
use crate::real::Real;
use crate::smooth_surface::{SmoothPoint, SmoothSurface};
use crate::vec3::{add, dot, scale, tangent_frame};
use alloc::vec::Vec;

/// Most rounds of movements and flips for triangles that are turned against the input.
const TURNS: usize = 8;

/// The cosine of the smallest angle that a triangle may get by these: 3°.
const NEEDLE: f64 = 0.9986;

impl<T: Real> Remesher<'_, T> {
    /// Mends triangles that are turned against the input at their corners, as far as movements of these and flips can.
    pub(in crate::remesh) fn turn_back(&mut self, smooth: &SmoothSurface<T>) {
        for _ in 0..TURNS {
            let turned = self.turned();
            for &corners in &turned {
                for vertex in corners {
                    self.turn_back_at(smooth, vertex);
                }
                for k in 0..3 {
                    self.flip_to_turn_back([corners[k], corners[(k + 1) % 3]]);
                }
            }
            if turned.is_empty() {
                break;
            }
        }
    }

    /// Moves a vertex in steps that make the least cosine of its triangles with the input larger.
    fn turn_back_at(&mut self, smooth: &SmoothSurface<T>, vertex: u32) {
        if self.edited.freedom(vertex) != Freedom::Free {
            return;
        }
        let index = vertex as usize;
        let axes = tangent_frame(self.samples[index].normal);
        let mut step = T::constant(0.5) * self.factor * self.size(vertex);
        let mut best = (self.places[index], self.points[index]);
        let mut shape = self.shape(self.ring(vertex));
        for _ in 0..6 {
            let (start, here) = (best.0, best.1.position);
            for (x, y) in COMPASS {
                let [x, y] = [x, y].map(|part| T::constant(part) * step);
                let target = add(here, add(scale(x, axes[0]), scale(y, axes[1])));
                let point = self.put(smooth, vertex, self.ground.nearest(start, target));
                let moved = self.shape(self.ring(vertex));
                let limit = shape.cosine.max(T::constant(NEEDLE));
                if moved.outward > shape.outward && moved.cosine <= limit {
                    shape = moved;
                    best = (self.places[index], point);
                }
            }
            if best.0 == start {
                step /= T::constant(2.0);
            }
        }
        self.points[index] = self.put(smooth, vertex, best.0);
    }

    /// Moves a vertex to the point of the smooth surface over a place.
    fn put(
        &mut self,
        smooth: &SmoothSurface<T>,
        vertex: u32,
        place: MeshPoint<T>,
    ) -> SmoothPoint<T> {
        self.set_place(vertex, place);
        let point = self.point(smooth, vertex);
        self.samples[vertex as usize].position = point.position;
        point
    }

    /// Flips an edge if the least cosine of its triangles with the input becomes larger.
    fn flip_to_turn_back(&mut self, [tail, head]: [u32; 2]) {
        let Some(edge) = self.edited.half_edge(tail, head) else {
            return;
        };
        let Some([a, b, c, d]) = self.corners_of_flip(edge) else {
            return;
        };
        let before = self.shape([[a, b, c], [b, a, d]]);
        let after = self.shape([[d, c, a], [c, d, b]]);
        let limit = before.cosine.max(T::constant(NEEDLE));
        if after.outward > before.outward && after.cosine <= limit {
            // Refused where c and d are neighbours.
            let _ = self.edited.flip(edge);
        }
    }

    /// The corners of the triangles that are turned against the input there.
    pub(in crate::remesh) fn turned(&self) -> Vec<[u32; 3]> {
        let is_turned = |&corners: &[u32; 3]| {
            let normals = corners.map(|corner| self.samples[corner as usize].normal);
            let normal = normals.into_iter().fold([T::zero(); 3], add);
            dot(self.area_vector(corners), normal) < T::zero()
        };
        let triangles = self.edited.triangles();
        let triangles = triangles.map(|half_edge| self.edited.corners(half_edge));
        triangles.filter(is_turned).collect()
    }
}
