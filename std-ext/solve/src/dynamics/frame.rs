//! The directions in which vertices are free to move.

use super::Membrane;
use super::place::{Place, geometry, number_count, reciprocal_or_zero};
use super::vector::{self, Vector};
use helfrich::{Components, VertexKind};

/// Forces and displacements as long vectors of numbers. A vertex has three numbers. A vertex of a fluid
/// membrane has one, the displacement u along the direction of the vertex; such scalars need no
/// transport from one surface to the next. A fluid membrane with a free edge has three numbers per
/// vertex, too, of which [`Freedom`] leaves one in the interior and two at the edge.
///
/// The directions of a fluid membrane are the normals n of an earlier surface, the anchor. With the
/// current normals, a sequence of normal steps could add up to any tangential displacement. Every
/// discrete energy decreases along some tangential displacements and would then have no minimum.
///
/// For the same reason, if u is the normal component of a rigid motion, the whole body moves
/// rigidly. With displacements along n alone, a prolate vesicle could rotate relative to its
/// vertices, and it would do so towards meshes with too low an energy. With the rigid motions `ρ_k`
/// of the present positions, whose `b_k = n·ρ_k` at the anchor are orthonormal, displacements are
/// `n u + Σ_k (ρ_k − n b_k) Σ A b_k u`, and forces transform by the transpose. Without net force
/// and torque, u has no component along b_k. A body with fixed vertices has no rigid motions, and one
/// with a free edge follows them by the motion of its edge.
#[derive(Clone, Debug, Default)]
pub(super) struct Frame {
    directions: Vec<Vector>,
    freedoms: Vec<Freedom>,
    modes: Vec<Mode>,
}

/// The displacements that a vertex is free to make.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Freedom {
    All,
    /// Along the direction of the vertex.
    Along,
    /// In all directions except along this unit vector, the tangent of an edge.
    Across(Vector),
    /// In no direction.
    Fixed,
}

impl Freedom {
    /// The freedom of the vertices of a membrane.
    fn of(membrane: &Membrane, place: &Place, anchor: &[Vector]) -> Vec<Self> {
        let mesh = &membrane.mesh;
        let of_kind = |(vertex, kind): (usize, &VertexKind)| match kind {
            _ if membrane.is_fixed(vertex) => Self::Fixed,
            _ if !place.along_normals => Self::All,
            VertexKind::Boundary => {
                let ring = mesh.one_ring(vertex);
                let [first, last] = [ring.first(), ring.last()]
                    .map(|end| end.map_or(vertex, |&end| end as usize) + place.first_vertex);
                Self::Across(vector::unit(vector::sub(anchor[last], anchor[first])))
            }
            _ => Self::Along,
        };
        let kinds = mesh.vertex_kinds().iter().enumerate();
        kinds.map(of_kind).collect()
    }

    /// The component of a vector in the free directions.
    fn restrict(self, direction: Vector, entry: Vector) -> Vector {
        let part = |along: Vector| vector::scale(vector::dot(entry, along), along);
        match self {
            Self::All => entry,
            Self::Along => part(direction),
            Self::Across(tangent) => vector::sub(entry, part(tangent)),
            Self::Fixed => [0.0; 3],
        }
    }
}

/// A rigid motion of a body.
#[derive(Clone, Debug)]
struct Mode {
    /// The vertices of the body, and the positions of their numbers.
    vertices: Vec<(u32, u32)>,
    /// The area A of each vertex, and A b.
    areas: Vec<f64>,
    weighted: Vec<f64>,
    /// ρ = v + w × (x − c): v, w, c.
    velocity: Vector,
    rotation: Vector,
    centre: Vector,
}

impl Mode {
    /// ρ at x.
    fn at(&self, position: Vector) -> Vector {
        let arm = vector::sub(position, self.centre);
        vector::add(self.velocity, vector::cross(self.rotation, arm))
    }

    /// b, from the corresponding entry of A b.
    fn normal_part(&self, k: usize) -> f64 {
        self.weighted[k] * reciprocal_or_zero(self.areas[k])
    }
}

impl Frame {
    /// The frame of membranes at these positions.
    pub(super) fn new(membranes: &[Membrane], places: &[Place], anchor: &[Vector]) -> Self {
        let (directions, areas) = geometry(membranes, places, anchor);
        let mut modes = Vec::new();
        let mut freedoms = Vec::with_capacity(anchor.len());
        for (membrane, place) in membranes.iter().zip(places) {
            freedoms.extend(Freedom::of(membrane, place, anchor));
            if place.width == 1 {
                let components = Components::new(&membrane.mesh);
                let of_vertex = components.of_vertex();
                let mut supported = vec![false; components.count()];
                for (vertex, &component) in of_vertex.iter().enumerate() {
                    supported[component as usize] |= membrane.is_fixed(vertex);
                }
                let bodies = 0..components.count() as u32;
                for component in bodies.filter(|&body| !supported[body as usize]) {
                    let vertices: Vec<(u32, u32)> = components
                        .of_vertex()
                        .iter()
                        .enumerate()
                        .filter(|(_, of)| **of == component)
                        .map(|(k, _)| {
                            let vertex = place.first_vertex + k;
                            (vertex as u32, (place.first_number + k) as u32)
                        })
                        .collect();
                    add_modes(&mut modes, vertices, &directions, &areas, anchor);
                }
            }
        }
        Self {
            directions,
            freedoms,
            modes,
        }
    }

    /// Whether a vertex does not move.
    pub(super) fn is_fixed(&self, vertex: usize) -> bool {
        self.freedoms[vertex] == Freedom::Fixed
    }

    /// Removes from numbers the displacements that vertices are not free to make.
    pub(super) fn restrict(&self, places: &[Place], numbers: &mut [f64]) {
        for place in places {
            let numbers = &mut numbers[place.numbers()];
            let vertices = place.vertices();
            if place.width == 1 {
                for (number, vertex) in numbers.iter_mut().zip(vertices) {
                    if self.is_fixed(vertex) {
                        *number = 0.0;
                    }
                }
            } else {
                for (entry, vertex) in numbers.as_chunks_mut().0.iter_mut().zip(vertices) {
                    *entry = self.freedoms[vertex].restrict(self.directions[vertex], *entry);
                }
            }
        }
    }

    /// The directions of all vertices.
    pub(super) fn directions(&self) -> &[Vector] {
        &self.directions
    }

    /// The forces on the numbers that correspond to nodal forces.
    pub(super) fn reduce(
        &self,
        places: &[Place],
        positions: &[Vector],
        field: &[Vector],
    ) -> Vec<f64> {
        let mut numbers = vec![0.0; number_count(places)];
        for place in places {
            let numbers = &mut numbers[place.numbers()];
            let vertices = place.vertices();
            if place.width == 1 {
                let directions = &self.directions[vertices.clone()];
                let parts = field[vertices].iter().zip(directions);
                for (number, (&entry, &direction)) in numbers.iter_mut().zip(parts) {
                    *number = vector::dot(entry, direction);
                }
            } else {
                numbers.copy_from_slice(field[vertices].as_flattened());
            }
        }
        self.restrict(places, &mut numbers);
        let along = numbers.clone();
        for mode in &self.modes {
            let slip = |(k, &(vertex, number)): (usize, &(u32, u32))| {
                let force = field[vertex as usize];
                let rigid = vector::dot(mode.at(positions[vertex as usize]), force);
                rigid - mode.normal_part(k) * along[number as usize]
            };
            let sum: f64 = mode.vertices.iter().enumerate().map(slip).sum();
            for (&(_, number), weighted) in mode.vertices.iter().zip(&mode.weighted) {
                numbers[number as usize] += weighted * sum;
            }
        }
        numbers
    }

    /// Calls `precondition` on the deforming part of a force. Rigid motions are treated separately
    /// with `compliance`, so that forces without net force and torque cause none.
    pub(super) fn apart_from_rigid(
        &self,
        compliance: f64,
        force: &mut [f64],
        precondition: impl FnOnce(&mut [f64]),
    ) {
        // f − A b (b·f), and after it d − b (A b·d): transposes of each other.
        let over = |weighted: f64, area: f64| weighted * reciprocal_or_zero(area);
        let mut shares = Vec::with_capacity(self.modes.len());
        for mode in &self.modes {
            let parts = mode
                .vertices
                .iter()
                .zip(mode.weighted.iter().zip(&mode.areas));
            let share: f64 = parts
                .map(|(&(_, number), (&weighted, &area))| {
                    over(weighted, area) * force[number as usize]
                })
                .sum();
            for (&(_, number), weighted) in mode.vertices.iter().zip(&mode.weighted) {
                force[number as usize] -= share * weighted;
            }
            shares.push(share);
        }
        precondition(force);
        for (mode, share) in self.modes.iter().zip(shares) {
            let parts = mode.vertices.iter().zip(&mode.weighted);
            let rigid: f64 = parts
                .map(|(&(_, number), weighted)| weighted * force[number as usize])
                .sum();
            let wanted = compliance * share - rigid;
            let parts = mode.weighted.iter().zip(&mode.areas);
            for (&(_, number), (&weighted, &area)) in mode.vertices.iter().zip(parts) {
                force[number as usize] += wanted * over(weighted, area);
            }
        }
    }

    /// The displacements that correspond to the numbers.
    pub(super) fn expand(
        &self,
        places: &[Place],
        positions: &[Vector],
        numbers: &[f64],
    ) -> Vec<Vector> {
        let mut field = vec![[0.0; 3]; self.directions.len()];
        let mut free = numbers.to_vec();
        self.restrict(places, &mut free);
        let numbers = &free[..];
        for place in places {
            let numbers = &numbers[place.numbers()];
            let vertices = place.vertices();
            if place.width == 1 {
                let directions = &self.directions[vertices.clone()];
                let parts = numbers.iter().zip(directions);
                for (entry, (&number, &direction)) in field[vertices].iter_mut().zip(parts) {
                    *entry = vector::scale(number, direction);
                }
            } else {
                field[vertices].as_flattened_mut().copy_from_slice(numbers);
            }
        }
        for mode in &self.modes {
            let parts = mode.vertices.iter().zip(&mode.weighted);
            let sum: f64 = parts
                .map(|(&(_, number), weighted)| weighted * numbers[number as usize])
                .sum();
            for (k, &(vertex, _)) in mode.vertices.iter().enumerate() {
                let vertex = vertex as usize;
                let along = vector::scale(mode.normal_part(k), self.directions[vertex]);
                let slip = vector::sub(mode.at(positions[vertex]), along);
                field[vertex] = vector::add(field[vertex], vector::scale(sum, slip));
            }
        }
        field
    }
}

/// The rigid motions of one body, as far as they move its surface.
fn add_modes(
    modes: &mut Vec<Mode>,
    vertices: Vec<(u32, u32)>,
    directions: &[Vector],
    areas: &[f64],
    anchor: &[Vector],
) {
    let area: f64 = vertices.iter().map(|&(v, _)| areas[v as usize]).sum();
    let over = reciprocal_or_zero(area);
    let first = vertices
        .first()
        .map_or([0.0; 3], |&(v, _)| anchor[v as usize]);
    let mut centre = [0.0; 3];
    for &(v, _) in &vertices {
        let offset = vector::sub(anchor[v as usize], first);
        centre = vector::add(centre, vector::scale(areas[v as usize] * over, offset));
    }
    let centre = vector::add(first, centre);
    let turn = reciprocal_or_zero(area.sqrt());
    let own_from = modes.len();
    let areas: Vec<f64> = vertices.iter().map(|&(v, _)| areas[v as usize]).collect();
    for motion in 0..6 {
        let mut axis = [0.0; 3];
        axis[motion % 3] = 1.0;
        let mut mode = Mode {
            vertices: vertices.clone(),
            areas: areas.clone(),
            weighted: vec![0.0; vertices.len()],
            velocity: if motion < 3 { axis } else { [0.0; 3] },
            rotation: if motion < 3 {
                [0.0; 3]
            } else {
                vector::scale(turn, axis)
            },
            centre,
        };
        let normal_part =
            |mode: &Mode, v: u32| vector::dot(directions[v as usize], mode.at(anchor[v as usize]));
        // Orthogonalised twice, because of rounding.
        for _ in 0..2 {
            for other in &modes[own_from..] {
                let parts = vertices.iter().zip(&other.weighted);
                let share: f64 = parts.map(|(&(v, _), b)| b * normal_part(&mode, v)).sum();
                let less = |a: Vector, b: Vector| vector::sub(a, vector::scale(share, b));
                mode.velocity = less(mode.velocity, other.velocity);
                mode.rotation = less(mode.rotation, other.rotation);
            }
        }
        let (mut across, mut all) = (0.0, 0.0);
        for (&(v, _), area) in vertices.iter().zip(&areas) {
            let moved = mode.at(anchor[v as usize]);
            across += area * normal_part(&mode, v).powi(2);
            all += area * vector::dot(moved, moved);
        }
        if across > LEAST_ACROSS * LEAST_ACROSS * all {
            let scale = across.sqrt().recip();
            mode.velocity = vector::scale(scale, mode.velocity);
            mode.rotation = vector::scale(scale, mode.rotation);
            for (k, &(v, _)) in vertices.iter().enumerate() {
                mode.weighted[k] = areas[k] * normal_part(&mode, v);
            }
            modes.push(mode);
        }
    }
}

/// The fraction of a rigid motion that must be normal to the surface. Rotations of spheres and
/// near-spheres have almost no normal component, and cannot be identified from normal
/// displacements.
const LEAST_ACROSS: f64 = 0.05;

#[cfg(test)]
mod tests {
    use super::Frame;
    use crate::dynamics::coordinates::Coordinates;
    use crate::dynamics::place::Place;
    use crate::dynamics::{Membrane, Motion};
    use helfrich_mesh::generate::{AnyShape, Family, generate};
    use std::sync::Arc;

    /// An ellipsoid, all rigid motions of which move its surface.
    fn ellipsoid() -> ([Membrane; 1], Vec<Place>, Vec<[f64; 3]>) {
        let shape: AnyShape = "ellipsoid:1,0.8,0.5".parse().expect("a shape");
        let made = generate(&shape, Family::Irregular, 162, 1).expect("a mesh");
        let membranes = [Membrane {
            mesh: Arc::new(made.mesh),
            bending_modulus: 1.0,
            in_plane_modulus: 0.0,
            motion: Motion::AlongNormals,
            fixed: Vec::new(),
        }];
        let places = Place::of(&membranes);
        (membranes, places, made.positions)
    }

    /// A preconditioner sees forces without net force and torque, and the rigid part of displacements is that of
    /// the compliance, whatever the preconditioner adds to it.
    #[test]
    fn rigid_motions_have_their_own_compliance() {
        let (membranes, places, positions) = ellipsoid();
        let frame = Frame::new(&membranes, &places, &positions);
        assert_eq!(frame.modes.len(), 6);
        let along = |field: &[f64], displacement: bool| {
            let of_mode = frame.modes.iter().map(|mode| {
                let numbers = mode.vertices.iter().enumerate();
                let terms = numbers.map(|(k, &(_, number))| {
                    let weight = if displacement {
                        mode.weighted[k]
                    } else {
                        mode.normal_part(k)
                    };
                    weight * field[number as usize]
                });
                terms.sum::<f64>()
            });
            Vec::from_iter(of_mode)
        };
        let mut field = Vec::from_iter((0..positions.len()).map(|k| 1.0 + (3.0 * k as f64).sin()));
        let shares = along(&field, false);
        let size = shares.iter().map(|share| share.abs()).fold(0.0, f64::max);
        frame.apart_from_rigid(0.3, &mut field, |force| {
            for left in along(force, false) {
                assert!(left.abs() < 1e-12 * size, "{left:e} of {size:e}");
            }
            for (k, force) in force.iter_mut().enumerate() {
                *force = *force * (2.0 + (k as f64).cos()) + 1.0;
            }
        });
        for (found, share) in along(&field, true).into_iter().zip(shares) {
            let off = (found - 0.3 * share).abs();
            assert!(off < 1e-12 * size, "{found:e}, {share:e}");
        }
    }

    /// Directions are kept until normals have turned by a root mean square of 0.15 radians.
    #[test]
    fn directions_are_kept_until_the_surface_turns() {
        let (membranes, places, positions) = ellipsoid();
        let frame = Frame::new(&membranes, &places, &positions);
        // Normals of a stretched sphere turn by at most half of the logarithm of the stretch, on average.
        for (stretch, turned) in [(1.0, false), (1.1, false), (1.6, true)] {
            let stretched = positions.iter().map(|&[x, y, z]| [x, y, stretch * z]);
            let stretched = Vec::from_iter(stretched);
            let coordinates = Coordinates::new(&membranes, &places, &stretched);
            assert_eq!(coordinates.turned(&places, &frame), turned, "{stretch}");
        }
    }
}
