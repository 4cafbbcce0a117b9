//! Patches over a mesh, and the way back from them to the positions.

use super::basis::{self, Basis};
use super::fit::Fit;
use super::material::Field;
use super::patch::Patches;
use super::plan::{Plan, Vectors};
use super::vertices::{Backward, Forward, Work};
use crate::bending::area_vectors::{AreaVectorForce, AreaVectors};
use crate::element::{Execution, Ragged, of_vertices};
use crate::lane::{Lane, Several, WIDTH};
use crate::mesh::TriangleMesh;
use crate::real::{Real, finite_or_zero};
use crate::surface::Surface;
use crate::vec3::{Vec3, add, dot, normalise, scale, sub};
use alloc::vec::Vec;

/// Patches over a mesh.
#[derive(Clone, Debug)]
pub(super) struct Shape<T> {
    pub(super) plan: Plan,
    pub(super) basis: Basis<T>,
    /// Sums of area vectors, and unit normals.
    pub(super) sums: Vec<[T; 4]>,
    pub(super) normals: Vec<[T; 3]>,
    pub(super) fits: Vec<Fit<T>>,
    pub(super) displacements: Vec<Several<T>>,
}

impl<T: Real> Shape<T> {
    pub(super) fn new(mesh: &TriangleMesh) -> Self {
        Self {
            plan: Plan::new(mesh),
            basis: Basis::new(),
            sums: Vec::new(),
            normals: Vec::new(),
            fits: Vec::new(),
            displacements: Vec::new(),
        }
    }

    /// Sets normals, fits and displacements.
    pub(super) fn set(
        &mut self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        work: &mut Vec<Work<T>>,
    ) {
        let plan = &self.plan;
        AreaVectors.sum(execution, surface, &mut self.sums);
        let sums = &self.sums;
        self.normals.resize(sums.len(), [T::zero(); 3]);
        execution.map(&mut self.normals[..], |vertex, normal| {
            let [x, y, z, _] = sums[vertex];
            *normal = normalise([x, y, z]);
        });
        self.fits.resize_with(plan.blocks.len(), Fit::default);
        let stars = plan.star_offsets[plan.blocks.len()];
        self.displacements.resize(stars, Several::zero());
        let forward = Forward {
            plan,
            surface,
            normals: &self.normals,
        };
        let ragged = Ragged::new(&mut self.displacements, &plan.star_offsets);
        execution.run(work, (&mut self.fits[..], ragged), &forward);
    }

    /// The number of blocks of patches.
    pub(super) fn blocks(&self) -> usize {
        self.plan.patches.len().div_ceil(WIDTH)
    }

    /// The patches of the block from number `first` on.
    #[inline(always)]
    pub(super) fn patches(&self, surface: Surface<'_, T>, first: usize) -> Patches<T> {
        Patches::gather(
            &self.plan,
            surface,
            &self.normals,
            &self.displacements,
            first,
        )
    }
}

/// Buffers of the reverse pass, from patches to positions.
#[derive(Clone, Debug, Default)]
pub(super) struct Return<T> {
    /// Derivatives with respect to what patches are made of, see [`Patches::give_back`].
    pub(super) returned: Vec<Several<T>>,
    pulls: Vec<Vectors<T>>,
    turns: Vec<Vectors<T>>,
    own: Vec<[Vec3<Several<T>>; 2]>,
    /// −∂E/∂(2N).
    normal_forces: Vec<[T; 4]>,
}

impl<T: Real> Return<T> {
    /// Subtracts from `force` the derivatives with respect to the positions that follow from `stride` rows
    /// of each block in `returned`.
    pub(super) fn subtract_from(
        &mut self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        (shape, stride): (&Shape<T>, usize),
        material: [Field<'_, T>; 2],
        work: &mut Vec<Work<T>>,
        force: &mut [[T; 3]],
    ) {
        self.pull(execution, surface, shape, material, work);
        let Self {
            returned,
            pulls,
            turns,
            own,
            normal_forces,
        } = self;
        let Shape {
            plan,
            normals,
            sums,
            ..
        } = shape;
        // What patches return for a vertex, with respect to its position (part 0) or normal (part 1).
        let corner_bars = |vertex: usize, part: usize| {
            let mut sum = [T::zero(); 3];
            for (patch, corner) in plan.patches_at(vertex) {
                let row = patch / WIDTH * stride + basis::FREE + 6 * corner + 3 * part;
                sum = add(
                    sum,
                    [0, 1, 2].map(|axis| returned[row + axis].0[patch % WIDTH]),
                );
            }
            sum
        };
        // The same for its own fit.
        let of_member = |vertex: usize, part: usize| {
            plan.members[vertex].map_or([T::zero(); 3], |(block, lane)| {
                own[block as usize][part].map(|row| row.0[usize::from(lane)])
            })
        };
        normal_forces.resize(sums.len(), [T::zero(); 4]);
        execution.map(&mut normal_forces[..], |vertex, normal_force| {
            let mut sum = corner_bars(vertex, 1);
            for place in plan.ringed_at(vertex) {
                sum = add(sum, place.vector(turns));
            }
            sum = add(sum, of_member(vertex, 1));
            let normal = normals[vertex];
            let across = sub(sum, scale(dot(sum, normal), normal));
            let [x, y, z, _] = sums[vertex];
            let over = crate::vec3::norm([x, y, z]).reciprocal_or_zero();
            // Sums of three of them must stay finite, too, and their products with edges.
            let eightfold = finite_or_zero(scale(T::constant(-8.0) * over, across));
            let [x, y, z] = scale(T::constant(0.125), eightfold);
            *normal_force = [x, y, z, T::zero()];
        });
        execution.scatter(
            &AreaVectorForce,
            surface,
            surface.mesh().triangles(),
            normal_forces,
            force,
        );
        execution.map(of_vertices(surface, force), |vertex, force| {
            let mut sum = corner_bars(vertex, 0);
            for place in plan.listed_at(vertex) {
                sum = add(sum, place.vector(pulls));
            }
            sum = add(sum, of_member(vertex, 0));
            *force = sub(*force, finite_or_zero(sum));
        });
    }

    /// Sets the derivatives with respect to the positions and normals of which fits and patches are made.
    fn pull(
        &mut self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        shape: &Shape<T>,
        material: [Field<'_, T>; 2],
        work: &mut Vec<Work<T>>,
    ) {
        let zero = [[T::zero(); 3]; WIDTH];
        let plan = &shape.plan;
        let count = plan.blocks.len();
        self.pulls.resize(plan.neighbour_offsets[count], zero);
        self.turns.resize(plan.ring_offsets[count], zero);
        self.own.resize(count, [[Several::zero(); 3]; 2]);
        let backward = Backward {
            plan,
            surface,
            normals: &shape.normals,
            fits: &shape.fits,
            displacements: &shape.displacements,
            returned: &self.returned,
            material,
        };
        let slots = (
            (
                Ragged::new(&mut self.pulls, &plan.neighbour_offsets),
                Ragged::new(&mut self.turns, &plan.ring_offsets),
            ),
            &mut self.own[..],
        );
        execution.run(work, slots, &backward);
    }
}
