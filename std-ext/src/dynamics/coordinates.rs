//! The directions in which vertices are free to move.

use super::vector::{self, Vector};
use super::{Membrane, Motion};

/// Forces and displacements as long vectors: one number a vertex, along its normal, for membranes
/// that are fluid; three for the others. Numbers along normals need no transport from one surface to
/// the next.
#[derive(Clone, Debug, Default)]
pub(super) struct Coordinates {
    /// Outward unit normals: the sum of the area vectors around, which is ∂V/∂x. 0 where it vanishes.
    pub(super) normals: Vec<Vector>,
    /// A third of the areas around.
    pub(super) areas: Vec<f64>,
    /// The directions that constraints forbid, as forces: orthonormal for M⁻¹ in each group.
    forbidden: Vec<Vec<f64>>,
}

/// Where a membrane's vertices and numbers are among those of all.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) first_vertex: usize,
    pub(super) vertices: usize,
    pub(super) first_number: usize,
    pub(super) width: usize,
}

impl Place {
    /// The places of membranes that follow each other.
    pub(super) fn of(membranes: &[Membrane]) -> Vec<Self> {
        let (mut first_vertex, mut first_number) = (0, 0);
        let mut place = |membrane: &Membrane| {
            let vertices = membrane.mesh.vertex_count();
            let width = match membrane.motion {
                Motion::AlongNormals => 1,
                Motion::Free => 3,
            };
            let place = Self {
                first_vertex,
                vertices,
                first_number,
                width,
            };
            first_vertex += vertices;
            first_number += width * vertices;
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

/// How many numbers there are.
pub(super) fn number_count(places: &[Place]) -> usize {
    places.last().map_or(0, |place| place.numbers().end)
}

impl Coordinates {
    /// Takes over the geometry of the membranes, without constraints.
    pub(super) fn set(&mut self, membranes: &[Membrane], places: &[Place], positions: &[Vector]) {
        self.normals.clear();
        self.normals.resize(positions.len(), [0.0; 3]);
        self.areas.clear();
        self.areas.resize(positions.len(), 0.0);
        self.forbidden.clear();
        for (membrane, place) in membranes.iter().zip(places) {
            for triangle in membrane.mesh.triangles() {
                let corners = triangle.map(|vertex| place.first_vertex + vertex as usize);
                let [a, b, c] = corners.map(|vertex| positions[vertex]);
                let doubled = vector::cross(vector::sub(b, a), vector::sub(c, a));
                let share = vector::norm(doubled) / 6.0;
                for corner in corners {
                    self.normals[corner] = vector::add(self.normals[corner], doubled);
                    self.areas[corner] += share;
                }
            }
        }
        for normal in &mut self.normals {
            *normal = vector::unit(*normal);
        }
    }

    /// The triangle, with its membrane, that looks the other way than the surface around it.
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

    /// Sets `numbers` to a field's part along the directions that are free.
    pub(super) fn reduce(&self, places: &[Place], field: &[Vector], numbers: &mut [f64]) {
        for place in places {
            let numbers = &mut numbers[place.numbers()];
            let vertices = place.vertices();
            if place.width == 1 {
                let normals = &self.normals[vertices.clone()];
                for ((number, &entry), &normal) in
                    numbers.iter_mut().zip(&field[vertices]).zip(normals)
                {
                    *number = vector::dot(entry, normal);
                }
            } else {
                numbers.copy_from_slice(field[vertices].as_flattened());
            }
        }
    }

    /// Sets `field` to the displacements that `numbers` stand for.
    pub(super) fn expand(&self, places: &[Place], numbers: &[f64], field: &mut [Vector]) {
        for place in places {
            let numbers = &numbers[place.numbers()];
            let vertices = place.vertices();
            if place.width == 1 {
                let normals = &self.normals[vertices.clone()];
                for ((entry, &number), &normal) in
                    field[vertices].iter_mut().zip(numbers).zip(normals)
                {
                    *entry = vector::scale(number, normal);
                }
            } else {
                field[vertices].as_flattened_mut().copy_from_slice(numbers);
            }
        }
    }

    /// Calls `each` with a number's index, its group and 1/area, or 0 where there is no area.
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

    /// Forbids the directions of these gradients, each by itself in every group of vertices.
    pub(super) fn forbid(&mut self, places: &[Place], groups: &[u32], gradients: &[Vec<Vector>]) {
        let group_count = groups.iter().max().map_or(0, |&group| group as usize + 1);
        for gradient in gradients {
            let mut field = vec![0.0; number_count(places)];
            self.reduce(places, gradient, &mut field);
            let mut before = vec![0.0; group_count];
            self.for_each(places, groups, |number, group, over| {
                before[group] += field[number] * field[number] * over;
            });
            // Twice: rounding leaves something of the others after the first time.
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
                    // Area and volume of a sphere have one gradient between them.
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

    /// Takes from forces what constraints forbid: `f −= b (b·M⁻¹f)`.
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

    /// Takes from displacements what would change the constrained values: `d −= M⁻¹ b (b·d)`.
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

/// The share of a squared gradient that has to be its own, for it to count.
const DEPENDENT: f64 = 1e-10;

fn group_count(groups: &[u32]) -> usize {
    groups.iter().max().map_or(0, |&group| group as usize + 1)
}

pub(super) fn reciprocal_or_zero(value: f64) -> f64 {
    if value > 0.0 { value.recip() } else { 0.0 }
}
