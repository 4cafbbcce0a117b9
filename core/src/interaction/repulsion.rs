//! Short-range repulsion, with or without attraction.

mod face;
mod near;

use super::Interaction;
use super::cells::{Cells, Near, Sorted};
use super::images::{Images, NearImages};
use crate::bending::AreaVectorForce;
use crate::element::Execution;
use crate::lane::Lane;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, dot, scale, sub};
use alloc::vec::Vec;
use face::{Everywhere, Facing, Felt};
use near::{Bounds, NearFace, NearVertex};

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
    /// The periodic box, if there is one.
    pub images: Images<T>,
}

/// Memory of [`Repulsion`].
#[derive(Clone, Debug, Default)]
pub struct RepulsionMemory<T> {
    bounds: Vec<Bounds<T>>,
    /// The widened boxes of other surfaces and of images that intersect the box of one surface.
    near: Vec<Bounds<T>>,
    vertex_places: Sorted<T>,
    face_places: Sorted<T>,
    /// The triangles near the cells of vertices.
    near_vertices: Vec<Near>,
    /// In the order of their places.
    vertices: Vec<NearVertex<T>>,
    faces: Vec<NearFace<T>>,
    /// Areas of the vertices of all surfaces, and where those of each begin.
    areas: Vec<T>,
    begins: Vec<usize>,
    /// Twice the area vectors of one surface's vertices; unit normals N/|N| of all and 1/|2N|, where parts act.
    doubled: Vec<[T; 4]>,
    normals: Vec<[T; 4]>,
    bundles: Vec<Bundle<T>>,
    /// As [`Bundle::sums`], of all near vertices.
    sums: Vec<[T; 7]>,
    /// −∂E/∂(2N) and −∂E/∂A of one surface's vertices.
    weights: Vec<[T; 4]>,
}

/// Some near vertices, one after the other.
#[derive(Clone, Debug, Default)]
struct Bundle<T> {
    /// Potential at each of them, its part of minus the gradient, and its turn.
    sums: [[T; 7]; BUNDLE],
    /// The triangles near them, and the forces on the corners of these.
    reactions: Vec<(u32, [Vec3<T>; 3])>,
}

/// Number of vertices in a bundle.
const BUNDLE: usize = 8;

/// Number of bundles between two additions of their forces: the memory for these is that of so many.
const BUNDLES: usize = 2048;

impl<T> RepulsionMemory<T> {
    /// Number of vertices that the last evaluation found near the box of another surface or an
    /// image. If 0, the evaluation ended there.
    pub fn candidates(&self) -> usize {
        self.vertices.len()
    }
}

/// Cells and images by which near pairs are found.
struct Pairs<'a, T> {
    repulsion: &'a Repulsion<T>,
    over_range: T,
    cells: Cells<T>,
    images: NearImages<T>,
}

impl<T: Real> Pairs<'_, T> {
    /// Calls `act` with the interaction of a vertex with a triangle and its images.
    #[inline(always)]
    fn each_felt(&self, vertex: &NearVertex<T>, face: &NearFace<T>, mut act: impl FnMut(Felt<T>)) {
        let itself = vertex.surface == face.surface;
        let apart = sub(vertex.position, face.position);
        let apart = add(apart, sub(vertex.remainder, face.remainder));
        let (offset, reach) = (face.centre, face.reach);
        self.images
            .each_within(apart, offset, reach, |apart, is_another| {
                let Repulsion {
                    attraction, parts, ..
                } = *self.repulsion;
                let apart = scale(self.over_range, apart);
                let felt = if !itself || is_another {
                    face.triangle.felt(apart, attraction, Everywhere)
                } else if parts && !face.corners.contains(&vertex.vertex) {
                    let sight = Facing(vertex.normal);
                    face.triangle.felt(apart, attraction, sight)
                } else {
                    None
                };
                felt.into_iter().for_each(&mut act);
            });
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
            images: Images::none(),
        }
    }

    /// 1/r_c; 0 where there is no range.
    fn over_range(&self) -> T {
        self.range.reciprocal_or_zero().max(T::zero())
    }

    /// Finds near pairs, sets `sums`, adds the forces on triangles and returns the energy; nothing where none are near.
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
        let pairs = self.find(execution, surfaces, memory)?;
        let RepulsionMemory {
            vertex_places,
            face_places,
            near_vertices,
            vertices,
            faces,
            bundles,
            sums,
            ..
        } = memory;
        let (vertices, faces) = (vertices.as_slice(), faces.as_slice());
        let (has_forces, push) = (forces.is_some(), self.half_push());
        sums.clear();
        for block in (0..vertices.len()).step_by(BUNDLE * BUNDLES) {
            let count = (vertices.len() - block).div_ceil(BUNDLE).min(BUNDLES);
            bundles.resize_with(count.max(bundles.len()), Bundle::default);
            execution.map(&mut bundles[..count], |number, bundle| {
                let Bundle { sums, reactions } = bundle;
                reactions.clear();
                *sums = [[T::zero(); 7]; BUNDLE];
                let first = block + number * BUNDLE;
                for (k, sum) in (first..vertices.len()).zip(sums) {
                    let (vertex, place) = (&vertices[k], &vertex_places.places[k]);
                    let area = push * vertex.area;
                    let meet = |face: usize| {
                        pairs.each_felt(vertex, &faces[face], |felt| {
                            let [x, y, z] = felt.force;
                            let [u, v, w] = felt.turn;
                            let terms = [felt.potential, x, y, z, u, v, w];
                            for (sum, term) in sum.iter_mut().zip(terms) {
                                *sum += term;
                            }
                            if has_forces {
                                let corners = felt.corners.map(|force| scale(area, force));
                                reactions.push((face as u32, corners));
                            }
                        });
                    };
                    pairs
                        .cells
                        .each_near(face_places, near_vertices, place, meet);
                }
            });
            let left = vertices.len() - block;
            let of_bundle = bundles[..count].iter().flat_map(|bundle| bundle.sums);
            sums.extend(of_bundle.take(left));
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
                // Room for other bundles, so that the next evaluations need no more memory.
                let most = bundles.iter().map(|bundle| bundle.reactions.len()).max();
                let most = most.unwrap_or(0);
                for Bundle { reactions, .. } in &mut *bundles {
                    if reactions.capacity() < most + most / 2 {
                        reactions.reserve_exact(2 * most - reactions.len());
                    }
                }
            }
        }
        let energy = execution.sum(vertices.len(), |k| vertices[k].area * sums[k][0]);
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
            vertices,
            sums,
            weights,
            begins,
            normals,
            ..
        } = memory;
        let zero = T::zero();
        let push = self.half_push();
        let half_potential = self.half_potential();
        for (k, (surface, force)) in surfaces.iter().zip(forces).enumerate() {
            let felt = || {
                let both = vertices.iter().zip(&*sums);
                both.filter(|(vertex, sum)| vertex.surface as usize == k && sum[0] != zero)
            };
            if felt().next().is_none() {
                continue;
            }
            weights.clear();
            weights.resize(surface.positions().len(), [zero; 4]);
            for (near, &[potential, x, y, z, u, v, w]) in felt() {
                let vertex = near.vertex as usize;
                weights[vertex][3] = -half_potential * potential;
                force[vertex] = add(force[vertex], scale(push * near.area, [x, y, z]));
                if self.parts {
                    let [a, b, c, over] = normals[begins[k] + vertex];
                    let across = sub([u, v, w], scale(dot([u, v, w], [a, b, c]), [a, b, c]));
                    let turn = scale((half_potential + half_potential) * near.area * over, across);
                    weights[vertex][..3].copy_from_slice(&turn);
                }
            }
            let triangles = surface.mesh().triangles();
            execution.scatter(&AreaVectorForce, *surface, triangles, weights, force);
        }
        energy
    }
}
