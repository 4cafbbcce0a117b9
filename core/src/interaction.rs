//! Forces between surfaces.

use crate::element::{Corners, ElementKernel, Execution};
use crate::lane::Lane;
use crate::laplacian::Cotangent;
use crate::real::Real;
use crate::surface::Surface;
use crate::triangle::DualArea;
use crate::vec3::{Vec3, add, dot, scale, sub};
use alloc::vec::Vec;

/// An energy of several surfaces together, with its nodal forces.
///
/// Laws: the force is the exact negative gradient of the energy by every position of every surface;
/// moving, turning and relabelling all surfaces together leaves the energy as it is, so that the
/// forces on all of them have no sum and no torque. Nothing is allocated again once memory has
/// grown to the largest evaluation.
pub trait Interaction<T: Real> {
    /// Memory for one evaluation at a time.
    type Memory: Default;

    /// The energy.
    fn energy(
        &self,
        execution: &impl Execution,
        surfaces: &[Surface<'_, T>],
        memory: &mut Self::Memory,
    ) -> T;

    /// Adds to `forces[k]` the nodal forces on surface k, and returns the energy.
    ///
    /// # Panics
    /// If there are fewer slices than surfaces, or one has fewer entries than its surface vertices.
    fn add_force_and_energy(
        &self,
        execution: &impl Execution,
        surfaces: &[Surface<'_, T>],
        memory: &mut Self::Memory,
        forces: &mut [&mut [[T; 3]]],
    ) -> T;
}

/// Short-range repulsion of different surfaces: `E = ∫∫ u(|x − y|) dS_x dS_y` over each pair of
/// surfaces, by their vertices with a third of the triangles around each as weight,
///
/// `E = Σ A_i A_j u(r_ij)`, `u(r) = k (1 − r²/r_c²)³` for r < r_c, 0 beyond: twice continuously
/// differentiable everywhere. The weights belong to the surfaces as they are, and the force is the
/// exact gradient, theirs included.
///
/// The double integral does not depend on the meshes as long as their edges are short against the
/// range, r_c/2 or less. Parallel planes at a distance h then have, per area, the energy
/// `π k r_c²/4 (1 − h²/r_c²)⁴` and the pressure `2π k h (1 − h²/r_c²)³`, at most 1.50 k r_c at
/// h = 0.38 r_c: a soft barrier, and beyond its top surfaces are pushed on through each other.
/// Nothing acts between parts of one surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repulsion<T> {
    /// k, energy per area squared.
    pub modulus: T,
    /// r_c, a length; nothing happens unless it is positive and finite.
    pub range: T,
}

/// A vertex that may be near another surface.
#[derive(Clone, Copy, Debug)]
struct Entry<T> {
    cell: [i64; 3],
    surface: u32,
    vertex: u32,
    area: T,
}

/// The least box around a surface: lower and upper bounds.
type Bounds<T> = [Vec3<T>; 2];

/// Memory of [`Repulsion`].
#[derive(Clone, Debug, Default)]
pub struct RepulsionMemory<T> {
    bounds: Vec<Bounds<T>>,
    /// In the order of cells, surfaces, vertices.
    entries: Vec<Entry<T>>,
    /// Areas of one surface's vertices.
    areas: Vec<T>,
    /// `Σ_j A_j u_ij` and `−Σ_j A_j ∂u_ij/∂x_i` of each entry.
    sums: Vec<[T; 4]>,
    /// −∂E/∂A of one surface's vertices.
    weights: Vec<[T; 1]>,
}

impl<T> RepulsionMemory<T> {
    /// How many vertices the last evaluation found near the box of another surface: 0 if it ended
    /// there.
    pub fn candidates(&self) -> usize {
        self.entries.len()
    }
}

/// Cells are wider than the range by this part, more than coordinates in cells are rounded by.
const MARGIN: f64 = 1.0 / 64.0;

/// x_to − x_from, each a surface and its vertex.
fn difference<T: Real>(surfaces: &[Surface<'_, T>], from: (u32, u32), to: (u32, u32)) -> Vec3<T> {
    let part = |select: fn(&Surface<'_, T>, usize) -> Vec3<T>| {
        let at =
            |(surface, vertex): (u32, u32)| select(&surfaces[surface as usize], vertex as usize);
        sub(at(to), at(from))
    };
    let positions = part(|surface, vertex| surface.positions()[vertex]);
    let remainders = part(|surface, vertex| match surface.remainders() {
        None => [T::zero(); 3],
        Some(remainders) => remainders[vertex],
    });
    add(positions, remainders)
}

impl<T: Real> Repulsion<T> {
    /// 1/r_c; 0 where there is no range.
    fn over_range(&self) -> T {
        self.range.reciprocal_or_zero().max(T::zero())
    }

    /// Fills `entries` with the vertices that lie in the widened box of another surface, sorted by
    /// cell.
    fn find(
        &self,
        execution: &impl Execution,
        surfaces: &[Surface<'_, T>],
        memory: &mut RepulsionMemory<T>,
    ) {
        let RepulsionMemory {
            bounds,
            entries,
            areas,
            ..
        } = memory;
        entries.clear();
        bounds.clear();
        if self.over_range() == T::zero() {
            return;
        }
        bounds.extend(surfaces.iter().map(|surface| {
            let positions = surface.positions();
            let first = positions.first().copied().unwrap_or_default();
            positions.iter().fold([first; 2], |[low, high], x| {
                let by = |bound: Vec3<T>, f: fn(T, T) -> T| [0, 1, 2].map(|k| f(bound[k], x[k]));
                [by(low, T::min), by(high, T::max)]
            })
        }));
        let width = self.range * T::constant(1.0 + MARGIN);
        let near = |x: T, low: T, high: T| low - width <= x && x <= high + width;
        for (a, surface) in surfaces.iter().enumerate() {
            let [low, high] = bounds[a];
            let meets = |&b: &usize| {
                let [other_low, other_high] = bounds[b];
                let overlaps =
                    |k: usize| other_low[k] - width <= high[k] && low[k] <= other_high[k] + width;
                a != b && (0..3).all(overlaps)
            };
            if !(0..surfaces.len()).any(|b| meets(&b)) {
                continue;
            }
            let vertices = surface.positions().len();
            if areas.len() < vertices {
                areas.resize(vertices, T::zero());
            }
            let areas = &mut areas[..vertices];
            Cotangent::new(DualArea::Barycentric).dual_areas(execution, *surface, areas);
            for (vertex, x) in surface.positions().iter().enumerate() {
                let inside = |b: usize| {
                    let [low, high] = bounds[b];
                    (0..3).all(|k| near(x[k], low[k], high[k]))
                };
                if (0..surfaces.len()).filter(meets).any(inside) {
                    entries.push(Entry {
                        cell: [0; 3],
                        surface: a as u32,
                        vertex: vertex as u32,
                        area: areas[vertex],
                    });
                }
            }
        }
        let position =
            |entry: &Entry<T>| surfaces[entry.surface as usize].positions()[entry.vertex as usize];
        let Some(first) = entries.first().map(position) else {
            return;
        };
        let corner = entries
            .iter()
            .map(position)
            .fold(first, |corner, x| [0, 1, 2].map(|k| corner[k].min(x[k])));
        // Beyond so many cells coordinates in cells are rounded by more than the margin: what lies
        // there shares the last cell.
        let last = (T::epsilon() * T::constant(256.0)).recip();
        let over = width.reciprocal_or_zero();
        for entry in &mut *entries {
            let x = position(entry);
            entry.cell = [0, 1, 2].map(|k| {
                let cell = ((x[k] - corner[k]) * over).floor().min(last);
                cell.to_i64().unwrap_or(0)
            });
        }
        entries.sort_unstable_by_key(|entry| (entry.cell, entry.surface, entry.vertex));
    }

    /// Sets `sums` and returns the energy. Each entry goes through its neighbours in their order,
    /// so that sums do not depend on who takes which entries.
    fn sum(
        &self,
        execution: &impl Execution,
        surfaces: &[Surface<'_, T>],
        memory: &mut RepulsionMemory<T>,
    ) -> T {
        let RepulsionMemory { entries, sums, .. } = memory;
        let entries = entries.as_slice();
        let over_range = self.over_range();
        let slope = T::constant(6.0) * self.modulus * over_range;
        sums.clear();
        sums.resize(entries.len(), [T::zero(); 4]);
        execution.map(&mut sums[..], |k, sum| {
            let own = entries[k];
            let [x, y, z] = own.cell;
            for column in 0..9 {
                let (x, y) = (x + column / 3 - 1, y + column % 3 - 1);
                let begin = entries.partition_point(|entry| entry.cell < [x, y, z - 1]);
                for other in &entries[begin..] {
                    if other.cell > [x, y, z + 1] {
                        break;
                    }
                    if other.surface == own.surface {
                        continue;
                    }
                    let (from, to) = (other.surface, other.vertex);
                    let apart = difference(surfaces, (from, to), (own.surface, own.vertex));
                    let apart = scale(over_range, apart);
                    let inside = T::one() - dot(apart, apart);
                    if inside > T::zero() {
                        let square = inside * inside;
                        sum[0] += other.area * (self.modulus * (inside * square));
                        let push = other.area * (slope * square);
                        for axis in 0..3 {
                            sum[axis + 1] += push * apart[axis];
                        }
                    }
                }
            }
        });
        let half = T::constant(0.5);
        half * execution.sum(entries.len(), |k| entries[k].area * sums[k][0])
    }
}

/// What the change of a triangle's area gives to its corners: `⅓ Σ w ∂A`.
struct AreaForce;

impl<T: Real> ElementKernel<T, 3, 1, 3> for AreaForce {
    #[inline(always)]
    fn evaluate<L: Lane<Scalar = T>>(
        &self,
        _first: usize,
        corners: &Corners<L, 3>,
        weights: &[[L; 1]; 3],
    ) -> [[L; 3]; 3] {
        let sixth = L::literal(1.0 / 6.0) * (weights[0][0] + weights[1][0] + weights[2][0]);
        corners.triangle().outward_edges(sixth)
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
        self.find(execution, surfaces, memory);
        self.sum(execution, surfaces, memory)
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
        self.find(execution, surfaces, memory);
        let energy = self.sum(execution, surfaces, memory);
        let RepulsionMemory {
            entries,
            sums,
            weights,
            ..
        } = memory;
        for (k, (surface, force)) in surfaces.iter().zip(forces).enumerate() {
            let felt = || {
                let both = entries.iter().zip(&*sums);
                both.filter(|(entry, sum)| entry.surface as usize == k && sum[0] != T::zero())
            };
            if felt().next().is_none() {
                continue;
            }
            weights.clear();
            weights.resize(surface.positions().len(), [T::zero()]);
            for (entry, &[potential, x, y, z]) in felt() {
                let vertex = entry.vertex as usize;
                weights[vertex] = [-potential];
                force[vertex] = add(force[vertex], scale(entry.area, [x, y, z]));
            }
            let triangles = surface.mesh().triangles();
            execution.scatter(&AreaForce, *surface, triangles, weights, force);
        }
        energy
    }
}
