//! The geometry of membranes at some positions, and the directions that constraints exclude there.

use super::Membrane;
use super::frame::Frame;
use super::place::{Place, geometry, reciprocal_or_zero};
use super::vector::{self, Vector};

/// Properties of the membranes at some positions that steps need.
#[derive(Clone, Debug, Default)]
pub(super) struct Coordinates {
    /// Outward unit normals: see [`geometry`].
    pub(super) normals: Vec<Vector>,
    /// A third of the area of the triangles around each vertex.
    pub(super) areas: Vec<f64>,
    /// The directions that constraints exclude, as forces on the numbers of the frame: orthonormal
    /// for M⁻¹ in each group.
    forbidden: Vec<Vec<f64>>,
}

impl Coordinates {
    /// The geometry at these positions, without constraints.
    pub(super) fn new(membranes: &[Membrane], places: &[Place], positions: &[Vector]) -> Self {
        let (normals, areas) = geometry(membranes, places, positions);
        Self {
            normals,
            areas,
            forbidden: Vec::new(),
        }
    }

    /// A triangle, with its membrane, whose normal is opposite to that of the surface around it.
    pub(super) fn folded(
        &self,
        membranes: &[Membrane],
        places: &[Place],
        positions: &[Vector],
    ) -> Option<(usize, usize)> {
        for (index, (membrane, place)) in membranes.iter().zip(places).enumerate() {
            let folds = |triangle: &[u32; 3]| {
                let corners = triangle.map(|vertex| place.first_vertex + vertex as usize);
                let [a, b, c] = corners.map(|vertex| positions[vertex]);
                let area = vector::cross(vector::sub(b, a), vector::sub(c, a));
                let [u, v, w] = corners.map(|vertex| self.normals[vertex]);
                vector::dot(area, vector::add(vector::add(u, v), w)) < 0.0
            };
            if let Some(triangle) = membrane.mesh.triangles().iter().position(folds) {
                return Some((index, triangle));
            }
        }
        None
    }

    /// The smallest sine of all angles, with its membrane and triangle.
    pub(super) fn narrowest(
        &self,
        membranes: &[Membrane],
        places: &[Place],
        positions: &[Vector],
    ) -> (f64, usize, usize) {
        let mut least = (1.0, 0, 0);
        for (index, (membrane, place)) in membranes.iter().zip(places).enumerate() {
            for (k, triangle) in membrane.mesh.triangles().iter().enumerate() {
                let corners = triangle.map(|vertex| place.first_vertex + vertex as usize);
                let [a, b, c] = corners.map(|vertex| positions[vertex]);
                let edges = [vector::sub(b, a), vector::sub(c, b), vector::sub(a, c)];
                let doubled = vector::norm(vector::cross(edges[0], edges[1]));
                let mut squares = edges.map(|edge| vector::dot(edge, edge));
                squares.sort_by(f64::total_cmp);
                // Opposite to the shortest side.
                let sine = doubled / (squares[1] * squares[2]).sqrt();
                if sine < least.0 || sine.is_nan() {
                    least = (sine, index, k);
                }
            }
        }
        least
    }

    /// Whether the surface has turned so far that its present normals are better directions.
    pub(super) fn turned(&self, places: &[Place], frame: &Frame) -> bool {
        let turned = |place: &Place| {
            let mut sum = 0.0;
            let mut least = 1.0f64;
            for vertex in place.vertices() {
                let cosine = vector::dot(self.normals[vertex], frame.directions()[vertex]);
                sum += self.areas[vertex] * (1.0 - cosine * cosine);
                // Vertices in no triangle never have a normal.
                if self.areas[vertex] > 0.0 && !frame.is_fixed(vertex) {
                    least = least.min(cosine);
                }
            }
            let area: f64 = self.areas[place.vertices()].iter().sum();
            sum > LARGEST_TURN * LARGEST_TURN * area || least < LEAST_COSINE
        };
        places
            .iter()
            .any(|place| place.along_normals && turned(place))
    }

    /// Calls `each` with a number's index, its group and 1/area, or 0 if the area is 0.
    fn for_each(&self, places: &[Place], groups: &[u32], mut each: impl FnMut(usize, usize, f64)) {
        for place in places {
            for (k, vertex) in place.vertices().enumerate() {
                let over = reciprocal_or_zero(self.areas[vertex]);
                for entry in 0..place.width {
                    let number = place.first_number + place.width * k + entry;
                    each(number, groups[vertex] as usize, over);
                }
            }
        }
    }

    /// Excludes the directions of these gradients, separately in every group of vertices.
    pub(super) fn forbid(&mut self, places: &[Place], groups: &[u32], gradients: Vec<Vec<f64>>) {
        let group_count = group_count(groups);
        for mut field in gradients {
            let mut before = vec![0.0; group_count];
            self.for_each(places, groups, |number, group, over| {
                before[group] += field[number] * field[number] * over;
            });
            // Orthogonalised twice, because rounding leaves errors after the first pass.
            for _ in 0..2 {
                self.take_out(places, groups, &mut field);
            }
            let mut after = vec![0.0; group_count];
            self.for_each(places, groups, |number, group, over| {
                after[group] += field[number] * field[number] * over;
            });
            let factors: Vec<f64> = after
                .iter()
                .zip(&before)
                .map(|(&after, &before)| {
                    // On a sphere the gradients of area and volume are parallel.
                    if after > DEPENDENT * before {
                        after.sqrt().recip()
                    } else {
                        0.0
                    }
                })
                .collect();
            self.for_each(places, groups, |number, group, _| {
                field[number] *= factors[group];
            });
            self.forbidden.push(field);
        }
    }

    /// Removes the excluded directions from forces: `f −= b (b·M⁻¹f)`.
    pub(super) fn take_out(&self, places: &[Place], groups: &[u32], force: &mut [f64]) {
        for forbidden in &self.forbidden {
            let mut products = vec![0.0; group_count(groups)];
            self.for_each(places, groups, |number, group, over| {
                products[group] += forbidden[number] * force[number] * over;
            });
            self.for_each(places, groups, |number, group, _| {
                force[number] -= products[group] * forbidden[number];
            });
        }
    }

    /// Removes from displacements the part that would change the constrained values: `d −= M⁻¹ b
    /// (b·d)`.
    pub(super) fn keep(&self, places: &[Place], groups: &[u32], displacement: &mut [f64]) {
        for forbidden in &self.forbidden {
            let mut products = vec![0.0; group_count(groups)];
            self.for_each(places, groups, |number, group, _| {
                products[group] += forbidden[number] * displacement[number];
            });
            self.for_each(places, groups, |number, group, over| {
                displacement[number] -= products[group] * forbidden[number] * over;
            });
        }
    }
}

/// The root-mean-square angle, in radians, by which a surface may turn against its directions.
const LARGEST_TURN: f64 = 0.15;

/// The least cosine between a normal and its direction.
const LEAST_COSINE: f64 = 0.7;

/// The fraction of a squared gradient that must be independent of the others for the gradient to
/// count.
const DEPENDENT: f64 = 1e-10;

fn group_count(groups: &[u32]) -> usize {
    groups.iter().max().map_or(0, |&group| group as usize + 1)
}
