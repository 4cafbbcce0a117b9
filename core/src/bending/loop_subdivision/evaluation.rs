//! Energy and forces of several patches at a time, one per vector entry.
//!
//! Patches with the same table differ only in their nodes. Each number of the formula is therefore
//! a vector with one entry per patch, while the weights of the table are common to all.

use super::patches::{BLOCK, Field, NodeBasis, PatchBlock, Patches, WEIGHT};
use crate::bending::surface_point::Point;
use crate::element::{Execution, SlotKernel};
use crate::lane::{Lane, Several, WIDTH};
use crate::real::{Real, finite_or_zero};
use crate::vec3::Vec3;
use alloc::vec::Vec;
use core::ops::Range;

/// The loop over blocks, as a kernel: a closure would not be compiled as part of it.
///
/// For the same reason this file uses plain loops: a closure that is passed to a function is not
/// compiled for the vector width of the surrounding loop.
pub(super) struct Evaluation<'a, T, const GRADIENT: bool> {
    pub(super) patches: &'a Patches<T>,
    /// Bending modulus and spontaneous curvature.
    pub(super) material: [Field<'a, T>; 2],
    pub(super) controls: &'a [[T; 4]],
}

/// Patches that are evaluated together.
#[derive(Clone, Debug)]
pub(super) struct PatchBatch<T> {
    /// The nodes of each patch, relative to its first node.
    spokes: Vec<Vec3<Several<T>>>,
    /// Bending modulus, spontaneous curvature, energy over the modulus, area, and derivatives of the
    /// energy, at each point.
    moduli: [Several<T>; 3],
    wanted: [Several<T>; 3],
    energies: [Several<T>; 3],
    areas: [Several<T>; 3],
    gradients: [[Vec3<Several<T>>; 5]; 3],
    /// Force and mass for each node.
    contributions: Vec<[Several<T>; 4]>,
}

impl<T: Real> Default for PatchBatch<T> {
    fn default() -> Self {
        Self {
            spokes: Vec::new(),
            moduli: Default::default(),
            wanted: Default::default(),
            energies: Default::default(),
            areas: Default::default(),
            gradients: Default::default(),
            contributions: Vec::new(),
        }
    }
}

/// Memory of an evaluation.
#[derive(Clone, Debug, Default)]
pub(super) struct PatchMemory<T> {
    pub(super) blocks: Vec<PatchBlock<T>>,
    /// Scratch memory of each thread.
    batches: Vec<PatchBatch<T>>,
}

impl<T: Real> Patches<T> {
    /// Sets energies and areas, and with `GRADIENT` forces and masses, from the control points.
    pub(super) fn evaluate<const GRADIENT: bool>(
        &self,
        execution: &impl Execution,
        material: [Field<'_, T>; 2],
        controls: &[[T; 4]],
        memory: &mut PatchMemory<T>,
    ) {
        let PatchMemory { blocks, batches } = memory;
        blocks.resize_with(self.len().div_ceil(BLOCK), PatchBlock::default);
        let evaluation = Evaluation::<T, GRADIENT> {
            patches: self,
            material,
            controls,
        };
        execution.run(batches, &mut blocks[..], &evaluation);
    }
}

impl<T: Real, const GRADIENT: bool> SlotKernel<PatchBatch<T>, &mut [PatchBlock<T>]>
    for Evaluation<'_, T, GRADIENT>
{
    #[inline(always)]
    fn set(&self, batch: &mut PatchBatch<T>, start: usize, blocks: &mut [PatchBlock<T>]) {
        for (index, block) in blocks.iter_mut().enumerate() {
            let first = (start + index) * BLOCK;
            let last = (first + BLOCK).min(self.patches.len());
            block.energy = T::zero();
            block.areas.resize(last - first, [T::zero(); 3]);
            let before = self.patches.entries(first..last).start;
            if GRADIENT {
                let nodes = self.patches.entries(first..last).len();
                block.contributions.resize(nodes, [T::zero(); 4]);
            }
            let mut patch = first;
            while patch < last {
                let alike = patch..patch + self.patches.alike(patch, last);
                patch = alike.end;
                let (_, bases) = self.patches.patch(alike.start);
                self.gather(alike.clone(), bases, batch);
                self.evaluate(bases, batch);
                for (lane, areas) in block.areas[alike.start - first..alike.end - first]
                    .iter_mut()
                    .enumerate()
                {
                    block.energy += batch.energy(lane);
                    *areas = batch.areas(lane);
                }
                if GRADIENT {
                    let entries = self.patches.entries(alike);
                    let contributions =
                        &mut block.contributions[entries.start - before..entries.end - before];
                    batch.scatter(contributions);
                }
            }
        }
    }
}

impl<T: Real, const GRADIENT: bool> Evaluation<'_, T, GRADIENT> {
    /// Loads patches with these bases, one per entry.
    #[inline(always)]
    fn gather(&self, alike: Range<usize>, bases: &[NodeBasis<T>], batch: &mut PatchBatch<T>) {
        let PatchBatch {
            spokes,
            moduli,
            wanted,
            ..
        } = batch;
        spokes.resize(bases.len(), [Several::zero(); 3]);
        for lane in 0..WIDTH {
            // Unused entries repeat the last patch.
            let (nodes, _) = self
                .patches
                .patch(alike.end.min(alike.start + lane + 1) - 1);
            let first = self.controls[nodes[0] as usize];
            for (spoke, &node) in spokes.iter_mut().zip(nodes) {
                let control = self.controls[node as usize];
                for axis in 0..3 {
                    spoke[axis].0[lane] = control[axis] - first[axis];
                }
            }
            let [modulus, spontaneous] = self.material;
            let (own, values) = (modulus.at(nodes, bases), spontaneous.at(nodes, bases));
            for point in 0..3 {
                moduli[point].0[lane] = own[point];
                wanted[point].0[lane] = values[point];
            }
        }
    }

    /// Sets energies and areas, and with `GRADIENT` contributions to nodes.
    #[inline(always)]
    fn evaluate(&self, bases: &[NodeBasis<T>], batch: &mut PatchBatch<T>) {
        let weight = T::constant(WEIGHT);
        for point in 0..3 {
            let mut derivatives = [[Several::zero(); 3]; 5];
            for (k, derivative) in derivatives.iter_mut().enumerate() {
                *derivative = weighted(&batch.spokes, bases, point, k);
            }
            let geometry = Point::new(derivatives);
            let wanted = batch.wanted[point];
            batch.areas[point] = Several::splat(weight) * geometry.area;
            // Computed without the modulus, so that an overflow through the modulus gives infinity
            // and is not masked.
            batch.energies[point] = geometry.energy(Several::splat(weight), wanted);
            if GRADIENT {
                let strength = Several::splat(weight) * batch.moduli[point];
                batch.gradients[point] = geometry.gradient(strength, wanted);
            }
        }
        if GRADIENT {
            batch
                .contributions
                .resize(bases.len(), [Several::zero(); 4]);
            let gradients = batch.gradients.as_flattened();
            for (contribution, basis) in batch.contributions.iter_mut().zip(bases) {
                *contribution = given(basis, gradients, &batch.areas);
            }
        }
    }
}

impl<T: Real> PatchBatch<T> {
    /// The energy in one entry, of the points where it is a number.
    #[inline(always)]
    fn energy(&self, lane: usize) -> T {
        let mut sum = T::zero();
        for (modulus, energy) in self.moduli.iter().zip(&self.energies) {
            let [energy] = finite_or_zero([energy.0[lane]]);
            sum += modulus.0[lane] * energy;
        }
        sum
    }

    #[inline(always)]
    fn areas(&self, lane: usize) -> [T; 3] {
        let [a, b, c] = &self.areas;
        [a.0[lane], b.0[lane], c.0[lane]]
    }

    /// Sets the contributions to each node of each patch. Separate from the loop that computes
    /// them, which compilers would otherwise fail to vectorise.
    #[inline(always)]
    fn scatter(&self, contributions: &mut [[T; 4]]) {
        for (lane, contributions) in contributions
            .chunks_exact_mut(self.contributions.len())
            .enumerate()
        {
            for (to, [x, y, z, mass]) in contributions.iter_mut().zip(&self.contributions) {
                *to = [x.0[lane], y.0[lane], z.0[lane], mass.0[lane]];
            }
        }
    }
}

/// Derivative `k` at a point: Σ of its weights times the nodes.
#[inline(always)]
fn weighted<T: Real>(
    spokes: &[Vec3<Several<T>>],
    bases: &[NodeBasis<T>],
    point: usize,
    k: usize,
) -> Vec3<Several<T>> {
    let mut sum = [Several::zero(); 3];
    // The first node is the origin of the others, so its position is 0.
    for (spoke, basis) in spokes[1..].iter().zip(&bases[1..]) {
        let weight = Several::splat(basis.derivatives[point][k]);
        for axis in 0..3 {
            sum[axis] = sum[axis] + weight * spoke[axis];
        }
    }
    sum
}

/// Force and mass of a node: minus the derivatives of the energy, by the same weights, and the areas
/// by its values.
#[inline(always)]
fn given<T: Real>(
    basis: &NodeBasis<T>,
    gradients: &[Vec3<Several<T>>],
    areas: &[Several<T>; 3],
) -> [Several<T>; 4] {
    let [mut x, mut y, mut z, mut mass] = [Several::zero(); 4];
    let weights = basis.derivatives.as_flattened();
    for (&weight, gradient) in weights.iter().zip(gradients) {
        let weight = Several::splat(weight);
        x = x - weight * gradient[0];
        y = y - weight * gradient[1];
        z = z - weight * gradient[2];
    }
    for (&value, &area) in basis.values.iter().zip(areas) {
        mass = mass + Several::splat(value) * area;
    }
    [x, y, z, mass]
}
