//! Short-range repulsion, with or without attraction.

mod face;
mod near;
mod neighbours;

use super::Interaction;
use super::images::{Images, NearImages};
use crate::bending::AreaVectorForce;
use crate::element::Execution;
use crate::lane::Lane;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, dot, scale, sub};
use alloc::vec::Vec;
use face::{Everywhere, Facing, Felt};
use near::{NearFace, NearVertex, Nearby};
use neighbours::Neighbours;

/// Short-range repulsion of different surfaces: a pressure between them that grows without bound as
/// the gap closes; with an [`Self::attraction`], adhesion.
///
/// Each vertex has an energy that depends on its distance d from each other surface, weighted by a
/// third of the area of the triangles around it. Both surfaces of a pair contribute one half:
///
/// `E = ½ Σ_i A_i w(d_i)`, `w(d) = k r_c²/4 (1 − s²)³ (1/s² − c)` with s = d/r_c for d < r_c, 0 beyond.
///
/// Parallel surfaces at a distance h have the energy w(h) per area, and the pressure
/// `p(h) = k r_c/2 (1 − s²)² (1 + 2s² − 3c s⁴)/s³`. Without attraction, c = 0, it is 0.29 k r_c at 0.8 r_c, 0.75 k r_c at 0.7 r_c, 3.4 k r_c at
/// 0.5 r_c, and `k r_c/(2s³)` where they all but touch. If k r_c is about the applied pressure,
/// surfaces come to rest at about two thirds of the range. With c > 1 they adhere: see [`Self::adhesion`]. Distances are measured from triangles,
/// not from vertices, so that the barrier has no holes, however long edges are compared with the
/// range. Where surfaces touch, the energy is infinite.
///
/// If several points of a surface are near, all contribute: w is added for triangles, subtracted
/// for their sides and added for their corners, each with its own nearest point. By Euler's
/// formula, a point that is nearest for several of these counts once, and forces are continuous
/// when the nearest point changes. Areas are those of the current surfaces, and the force is the
/// exact gradient, including that of the areas. Both sides of a surface repel.
///
/// Parts of one surface act on each other if [`Self::parts`] is set, where they face each other: each term is multiplied by a
/// smooth function of the angle between the vertex normal and the direction to the nearest point, 1 up to 30° and 0 from 60°
/// on. Two sheets meet along their normals, so that this is a barrier, and neighbours along the surface feel nothing: on a
/// smooth surface, wherever the range is below its radius of curvature. Each of two sheets has the energy that it would have
/// near another surface.
///
/// In a periodic box surfaces act on other surfaces and all their images, and on their own images
/// if [`Images::own`] is set. All images within the range count. In a box shorter than the range a
/// surface has several images within the range, and the time grows with the cube of their number
/// along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repulsion<T> {
    /// k, energy per area squared.
    pub modulus: T,
    /// r_c, a length; nothing happens unless it is positive and finite.
    pub range: T,
    /// c, a number: 0 for repulsion alone.
    pub attraction: T,
    /// Whether parts of one surface, connected or not, act on each other.
    pub parts: bool,
    /// The number of surfaces in a first group, if there are two groups: those at the start act on all others, and none on
    /// another of its group.
    pub first_group: Option<usize>,
    /// The periodic box, if there is one.
    pub images: Images<T>,
}

/// Memory of [`Repulsion`]: a list of what may come near each other, which is searched for again only once surfaces have
/// moved far enough. Results do not depend on it, unless it is [limited](Self::limit_to).
#[derive(Clone, Debug, Default)]
pub struct RepulsionMemory<T> {
    neighbours: Neighbours<T>,
    nearby: Nearby<T>,
    bundles: Vec<Bundle<T>>,
    /// As [`Bundle::sums`], of all near vertices.
    sums: Vec<[T; 7]>,
    /// The near vertices that feel anything, by their numbers in the list.
    moved: Vec<u32>,
    /// −∂E/∂(2N) and −∂E/∂A of one surface's vertices.
    weights: Vec<[T; 4]>,
}

/// Some near vertices, one after the other.
#[derive(Clone, Debug, Default)]
struct Bundle<T> {
    /// Potential at each of them, its part of minus the gradient, and its turn.
    sums: [[T; 7]; BUNDLE],
    /// Whether each of them feels anything.
    feels: [bool; BUNDLE],
    /// The triangles near them, and the forces on the corners of these.
    reactions: Vec<(u32, [Vec3<T>; 3])>,
    /// Largest number of these of one vertex.
    most: usize,
}

/// Number of vertices in a bundle.
const BUNDLE: usize = 8;

/// Number of bundles between two additions of their forces: the memory for these is that of so many.
const BUNDLES: usize = 2048;

impl<T: Real> RepulsionMemory<T> {
    /// From now on, only forces on those surfaces are computed for which this is true: they have the same bits as among the
    /// forces on all. Those on others, and the energy, then lack what these do not feel. With `None`, everything is computed
    /// again.
    pub fn limit_to(&mut self, surfaces: Option<&[bool]>) {
        self.neighbours.limit_to(surfaces);
    }

    /// Number of vertices that the last search found near the box of another surface or an image. If 0, the evaluation
    /// ended there.
    pub fn candidates(&self) -> usize {
        self.neighbours.candidates()
    }

    /// Number of searches for what may come near each other, in all evaluations so far.
    pub fn searches(&self) -> u64 {
        self.neighbours.searches()
    }
}

/// The interaction of single vertices and triangles.
struct Pairs<'a, T> {
    repulsion: &'a Repulsion<T>,
    over_range: T,
    images: NearImages<T>,
}

impl<'a, T: Real> Pairs<'a, T> {
    /// Pairs with triangles that were measured for this range.
    fn new(repulsion: &'a Repulsion<T>, range: T) -> Self {
        Self {
            repulsion,
            over_range: range.reciprocal_or_zero(),
            images: NearImages::new(&repulsion.images),
        }
    }

    /// Calls `act` with the difference of a vertex from a triangle's first corner and from its images, if they act on each
    /// other and may be near, in units of the range, and whether both are parts of one surface.
    #[inline(always)]
    fn each_apart(
        &self,
        vertex: &NearVertex<T>,
        face: &NearFace<T>,
        mut act: impl FnMut(Vec3<T>, bool),
    ) {
        let itself = vertex.surface == face.surface;
        let apart = sub(vertex.position, face.position);
        let apart = add(apart, sub(vertex.remainder, face.remainder));
        let (offset, reach) = (face.centre, face.reach);
        self.images
            .each_within(apart, offset, reach, |apart, is_another| {
                let parts = itself && !is_another;
                let faces = self.repulsion.parts && !face.corners.contains(&vertex.vertex);
                if !parts || faces {
                    act(scale(self.over_range, apart), parts);
                }
            });
    }

    /// Calls `act` with the interaction of a vertex with a triangle and its images.
    #[inline(always)]
    fn each_felt(&self, vertex: &NearVertex<T>, face: &NearFace<T>, mut act: impl FnMut(Felt<T>)) {
        let attraction = self.repulsion.attraction;
        self.each_apart(vertex, face, |apart, parts| {
            let felt = if parts {
                let sight = Facing(vertex.normal);
                face.triangle.felt(apart, attraction, sight)
            } else {
                face.triangle.felt(apart, attraction, Everywhere)
            };
            felt.into_iter().for_each(&mut act);
        });
    }

    /// Whether a vertex is within the range of a triangle, wherever it faces.
    fn is_near(&self, vertex: &NearVertex<T>, face: &NearFace<T>) -> bool {
        let mut near = false;
        self.each_apart(vertex, face, |apart, _| {
            near |= face.triangle.felt(apart, T::zero(), Everywhere).is_some();
        });
        near
    }
}

impl<T: Real> Repulsion<T> {
    /// Surfaces that adhere with this energy per area W at this distance d < r_c, without images: with `u = (d/r_c)²`,
    /// `c = (1 + 2u)/(3u²)` and `k = 12 W u²/(r_c² (1 − u)⁴)`.
    pub fn adhesion(energy: T, distance: T, range: T) -> Self {
        let [one, two, three] = [1.0, 2.0, 3.0].map(T::constant);
        let share = distance / range;
        let rest = share * share;
        let inside = (one - rest) * (one - rest) * range;
        Self {
            modulus: T::constant(12.0) * energy * rest * rest / (inside * inside),
            range,
            attraction: (one + two * rest) / (three * rest * rest),
            parts: false,
            first_group: None,
            images: Images::none(),
        }
    }

    /// Whether two surfaces with these numbers may act on each other, or one on itself and its images.
    pub fn acts(&self, one: usize, other: usize) -> bool {
        one == other
            || self
                .first_group
                .is_none_or(|first| (one < first) != (other < first))
    }

    /// Finds near pairs, sets `sums` and `moved`, adds the forces on triangles and returns the energy; nothing where none
    /// are near.
    ///
    /// Each pair is evaluated once. Vertices collect the forces on their triangles, which are then added in the order of
    /// vertices, so that sums do not depend on the division among threads.
    fn measure(
        &self,
        execution: &impl Execution,
        surfaces: &[Surface<'_, T>],
        memory: &mut RepulsionMemory<T>,
        mut forces: Option<&mut [&mut [[T; 3]]]>,
    ) -> Option<T> {
        if self.range.reciprocal_or_zero() <= T::zero() {
            return None;
        }
        let RepulsionMemory {
            neighbours,
            nearby,
            bundles,
            sums,
            moved,
            ..
        } = memory;
        neighbours.update(execution, self, surfaces, &mut nearby.faces);
        if neighbours.vertices().is_empty() {
            return None;
        }
        nearby.measure(execution, surfaces, neighbours, self.range, self.parts);
        let pairs = Pairs::new(self, self.range);
        let (vertices, faces) = (nearby.vertices.as_slice(), nearby.faces.as_slice());
        let (listed, listed_faces) = (neighbours.vertices(), neighbours.pairs());
        let (has_forces, push) = (forces.is_some(), self.half_push());
        sums.clear();
        moved.clear();
        for block in (0..vertices.len()).step_by(BUNDLE * BUNDLES) {
            let count = (vertices.len() - block).div_ceil(BUNDLE).min(BUNDLES);
            bundles.resize_with(count.max(bundles.len()), Bundle::default);
            execution.map(&mut bundles[..count], |number, bundle| {
                let Bundle {
                    sums,
                    feels,
                    reactions,
                    most,
                } = bundle;
                reactions.clear();
                *most = 0;
                *sums = [[T::zero(); 7]; BUNDLE];
                *feels = [false; BUNDLE];
                let first = block + number * BUNDLE;
                for ((k, sum), feels) in (first..vertices.len()).zip(sums).zip(feels) {
                    let vertex = &vertices[k];
                    let area = push * vertex.area;
                    let before = reactions.len();
                    for &face in &listed_faces[listed[k].pairs()] {
                        pairs.each_felt(vertex, &faces[face as usize], |felt| {
                            *feels = true;
                            let [x, y, z] = felt.force;
                            let [u, v, w] = felt.turn;
                            let terms = [felt.potential, x, y, z, u, v, w];
                            for (sum, term) in sum.iter_mut().zip(terms) {
                                *sum += term;
                            }
                            if has_forces {
                                let corners = felt.corners.map(|force| scale(area, force));
                                reactions.push((face, corners));
                            }
                        });
                    }
                    *most = (*most).max(reactions.len() - before);
                }
            });
            let left = vertices.len() - block;
            let of_bundle = bundles[..count].iter().flat_map(|bundle| bundle.sums);
            sums.extend(of_bundle.take(left));
            let feeling = bundles[..count].iter().flat_map(|bundle| bundle.feels);
            let feeling = feeling.take(left).enumerate().filter(|(_, feels)| *feels);
            moved.extend(feeling.map(|(k, _)| (block + k) as u32));
            if let Some(forces) = &mut forces {
                let reactions = bundles[..count].iter().flat_map(|bundle| &bundle.reactions);
                for (face, reaction) in reactions {
                    let face = &faces[*face as usize];
                    let force = &mut *forces[face.surface as usize];
                    for (&corner, &reaction) in face.corners.iter().zip(reaction) {
                        let force = &mut force[corner as usize];
                        *force = add(*force, reaction);
                    }
                }
                // Room for any of these vertices in a bundle, and some more, so that the next evaluations need no more memory.
                let most = bundles.iter().map(|bundle| bundle.most).max();
                let most = most.unwrap_or(0);
                for Bundle { reactions, .. } in &mut *bundles {
                    if reactions.capacity() < BUNDLE * most {
                        let room = BUNDLE * (most + most / 4 + 1);
                        reactions.reserve_exact(room - reactions.len());
                    }
                }
            }
        }
        // Only those within the range: how a sum is grouped must not depend on the list.
        let energy = execution.sum(moved.len(), |k| {
            let k = moved[k] as usize;
            vertices[k].area * sums[k][0]
        });
        // Of surfaces that touch, infinite terms may have met with both signs.
        let energy = if energy.is_nan() {
            T::infinity()
        } else {
            energy
        };
        Some(self.half_potential() * energy)
    }

    /// Half of the unit of potentials, `k r_c²/4`.
    fn half_potential(&self) -> T {
        T::constant(0.125) * self.modulus * self.range * self.range
    }

    /// Half of the unit of forces per area, `k r_c/2`.
    fn half_push(&self) -> T {
        T::constant(0.25) * self.modulus * self.range
    }
}

impl<T: Real> Interaction<T> for Repulsion<T> {
    type Memory = RepulsionMemory<T>;

    fn energy(
        &self,
        execution: &impl Execution,
        surfaces: &[Surface<'_, T>],
        memory: &mut RepulsionMemory<T>,
    ) -> T {
        let energy = self.measure(execution, surfaces, memory, None);
        energy.unwrap_or_else(T::zero)
    }

    fn add_force_and_energy(
        &self,
        execution: &impl Execution,
        surfaces: &[Surface<'_, T>],
        memory: &mut RepulsionMemory<T>,
        forces: &mut [&mut [[T; 3]]],
    ) -> T {
        assert!(
            forces.len() >= surfaces.len(),
            "there are {} slices of forces for {} surfaces",
            forces.len(),
            surfaces.len()
        );
        let Some(energy) = self.measure(execution, surfaces, memory, Some(&mut *forces)) else {
            return T::zero();
        };
        let RepulsionMemory {
            nearby,
            sums,
            moved,
            weights,
            ..
        } = memory;
        let (vertices, normals) = (nearby.vertices.as_slice(), nearby.normals.as_slice());
        let zero = T::zero();
        let push = self.half_push();
        let half_potential = self.half_potential();
        let mut moved = moved.as_slice();
        while let Some(&first) = moved.first() {
            let number = vertices[first as usize].surface;
            let own = moved.partition_point(|&k| vertices[k as usize].surface == number);
            let (felt, rest) = moved.split_at(own);
            moved = rest;
            let number = number as usize;
            let (surface, force) = (surfaces[number], &mut *forces[number]);
            weights.clear();
            weights.resize(surface.positions().len(), [zero; 4]);
            for &k in felt {
                let (near, [potential, x, y, z, u, v, w]) =
                    (&vertices[k as usize], sums[k as usize]);
                let vertex = near.vertex as usize;
                weights[vertex][3] = -half_potential * potential;
                force[vertex] = add(force[vertex], scale(push * near.area, [x, y, z]));
                if self.parts {
                    let [a, b, c, over] = normals[nearby.begins[number] + vertex];
                    let across = sub([u, v, w], scale(dot([u, v, w], [a, b, c]), [a, b, c]));
                    let turn = scale((half_potential + half_potential) * near.area * over, across);
                    weights[vertex][..3].copy_from_slice(&turn);
                }
            }
            let triangles = surface.mesh().triangles();
            execution.scatter(&AreaVectorForce, surface, triangles, weights, force);
        }
        energy
    }
}
