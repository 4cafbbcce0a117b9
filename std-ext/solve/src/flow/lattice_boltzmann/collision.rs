//! Collisions: the most expensive loop.
//!
//! Two relaxation times: I. Ginzburg, F. Verhaeghe, D. d'Humières, Commun. Comput. Phys. 3 (2008)
//! 427. Forces: Z. Guo, C. Zheng, B. Shi, Phys. Rev. E 65 (2002) 046308. In-place streaming, the
//! pattern "AA": P. Bailey et al., ICPP 2009, p. 550.

use crate::flow::lattice_boltzmann::Precision;
use crate::flow::lattice_boltzmann::force::NodalForces;
use crate::flow::lattice_boltzmann::stencil::{Layout, Q, VELOCITIES, opposite, wrapped};
use crate::flow::lattice_boltzmann::viscosity::NodalViscosities;
use crate::flow::vectors::Vector;
use pulp::{Simd, WithSimd};
use std::{array, mem};

/// Pairs of opposite velocities.
const PAIRS: usize = Q / 2;

/// (1/ω₊ − ½)(1/ω₋ − ½): half-way walls are then exactly half-way in a parabolic flow along them,
/// whatever the viscosity.
const MAGIC: f64 = 3.0 / 16.0;

/// Consecutive planes of constant z, to be collided.
pub(super) struct Slab<'a, 'b, T> {
    /// For each plane, the sheets in which its nodes find the populations of each direction, by
    /// even or odd step.
    pub(super) planes: &'a mut [[&'b mut [T]; Q]],
    /// z of the first plane.
    pub(super) first: usize,
    pub(super) odd: bool,
    pub(super) layout: Layout,
    pub(super) fluid: Fluid<'a, T>,
    /// The memory for velocities of rows with further forces, from the first plane on.
    pub(super) velocities: Option<[&'b mut [T]; 3]>,
}

/// Properties of the fluid for a collision.
#[derive(Clone, Copy)]
pub(super) struct Fluid<'a, T> {
    /// 3ν of all nodes without their own viscosity.
    pub(super) tripled_viscosity: T,
    /// Viscosities of single nodes.
    pub(super) viscosities: Option<&'a NodalViscosities<T>>,
    /// Force on every node.
    pub(super) force: [T; 3],
    /// Further forces on single nodes.
    pub(super) forces: Option<&'a NodalForces<T>>,
    /// 1, or 0 to leave out what is quadratic in the velocity.
    pub(super) inertia: T,
}

/// Properties of a row of nodes for a collision.
struct Row<'a, T> {
    tripled_viscosities: Option<&'a [T]>,
    forces: Option<[&'a [T]; 3]>,
    /// Output: the velocities at the start of the collision.
    velocities: Option<[&'a mut [T]; 3]>,
}

impl<T: Precision> WithSimd for Slab<'_, '_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let Layout { cells, pitch, .. } = self.layout;
        let [length, rows, _] = cells;
        for (plane, sheets) in self.planes.iter_mut().enumerate() {
            let z = self.first + plane;
            for y in 0..rows {
                // No closures here: where they are not inlined, they cost an eighth of the time of
                // the collisions.
                let mut slots: [&mut [T]; Q] = array::from_fn(|_| <&mut [T]>::default());
                for (direction, (slots, sheet)) in slots.iter_mut().zip(&mut *sheets).enumerate() {
                    let (stored, step) = Layout::source(self.odd, direction);
                    let start = wrapped(y, step[1], rows) * pitch;
                    let row = &mut sheet[start..start + pitch];
                    // What goes through the end of a row has come to the slot more for now.
                    *slots = match step[0] {
                        0 => &mut row[Layout::lead(stored)..][..length],
                        1 => {
                            row[length] = row[0];
                            &mut row[1..]
                        }
                        _ => {
                            row[0] = row[length];
                            &mut row[..length]
                        }
                    };
                }
                let number = y + rows * z;
                let Fluid {
                    viscosities,
                    forces,
                    ..
                } = self.fluid;
                let forces = forces.and_then(|forces| forces.row(number));
                let own = (y + rows * plane) * length;
                let row = Row {
                    tripled_viscosities: viscosities.and_then(|all| all.row(number)),
                    velocities: match &mut self.velocities {
                        Some([u, v, w]) if forces.is_some() => Some([
                            &mut u[own..own + length],
                            &mut v[own..own + length],
                            &mut w[own..own + length],
                        ]),
                        _ => None,
                    },
                    forces,
                };
                collide_row(simd, slots, &self.fluid, row);
                if self.odd {
                    for (direction, sheet) in sheets.iter_mut().enumerate() {
                        let step = VELOCITIES[opposite(direction)];
                        let start = wrapped(y, step[1], rows) * pitch;
                        match step[0] {
                            0 => {}
                            1 => sheet[start] = sheet[start + length],
                            _ => sheet[start + length] = sheet[start],
                        }
                    }
                }
            }
        }
    }
}

/// Collides a row, vector by vector; the last vector may be padded with nodes at rest.
#[inline(always)]
fn collide_row<T: Precision, S: Simd>(
    simd: S,
    slots: [&mut [T]; Q],
    fluid: &Fluid<'_, T>,
    row: Row<'_, T>,
) {
    let mut ends: [&mut [T]; Q] = array::from_fn(|_| <&mut [T]>::default());
    let mut vectors: [&mut [T::Of<S>]; Q] = array::from_fn(|_| <&mut [T::Of<S>]>::default());
    for ((slots, vectors), end) in slots.into_iter().zip(&mut vectors).zip(&mut ends) {
        (*vectors, *end) = T::rows_mut::<S>(slots);
    }
    let viscosities = row.tripled_viscosities.map(T::rows::<S>);
    let forces = row.forces.map(|axes| axes.map(T::rows::<S>));
    let (velocities, velocity_ends) = match row.velocities {
        None => (None, None),
        Some(axes) => {
            let [u, v, w] = axes.map(T::rows_mut::<S>);
            (Some([u.0, v.0, w.0]), Some([u.1, v.1, w.1]))
        }
    };
    // Most rows have none of these and use a separate loop, because `Option`s would be checked at
    // every vector.
    if let (None, None) = (viscosities, forces) {
        collide_vectors(simd, vectors, fluid, Vectors::NONE);
    } else {
        let whole = Vectors {
            tripled_viscosities: viscosities.map(|(vectors, _)| vectors),
            forces: forces.map(|axes| axes.map(|(vectors, _)| vectors)),
            velocities,
        };
        collide_vectors(simd, vectors, fluid, whole);
    }

    if ends[0].is_empty() {
        return;
    }
    let zero = T::splat(simd, T::zero());
    let (mut vectors, mut viscosity) = ([[zero]; Q], [zero]);
    let (mut force, mut velocity) = ([[zero]; 3], [[zero]; 3]);
    for (vector, end) in vectors.iter_mut().zip(&ends) {
        *vector = [T::load(simd, end)];
    }
    if let Some((_, end)) = viscosities {
        viscosity = [T::load(simd, end)];
    }
    if let Some(axes) = forces {
        for (force, (_, end)) in force.iter_mut().zip(axes) {
            *force = [T::load(simd, end)];
        }
    }
    let lent = velocity.each_mut().map(|velocity| velocity.as_mut_slice());
    let end = Vectors {
        tripled_viscosities: viscosities.map(|_| viscosity.as_slice()),
        forces: forces.map(|_| force.each_ref().map(|force| force.as_slice())),
        velocities: velocity_ends.as_ref().map(|_| lent),
    };
    let slots = vectors.each_mut().map(|vector| vector.as_mut_slice());
    collide_vectors(simd, slots, fluid, end);
    for (end, [vector]) in ends.into_iter().zip(vectors) {
        T::store(simd, end, vector);
    }
    for (end, [vector]) in velocity_ends.into_iter().flatten().zip(velocity) {
        T::store(simd, end, vector);
    }
}

/// [`Row`] in vectors.
struct Vectors<'a, V> {
    tripled_viscosities: Option<&'a [V]>,
    forces: Option<[&'a [V]; 3]>,
    velocities: Option<[&'a mut [V]; 3]>,
}

impl<V> Vectors<'_, V> {
    const NONE: Self = Self {
        tripled_viscosities: None,
        forces: None,
        velocities: None,
    };
}

#[inline(always)]
fn collide_vectors<T: Precision, S: Simd>(
    simd: S,
    mut slots: [&mut [T::Of<S>]; Q],
    fluid: &Fluid<'_, T>,
    mut row: Vectors<'_, T::Of<S>>,
) {
    // No closures around vectors, because they would be compiled without the target features of the
    // caller.
    let constants = Constants::new(simd, fluid);
    let plain = Rates::new(&constants, Vector::splat(simd, fluid.tripled_viscosity));
    let [fx, fy, fz] = fluid.force;
    let uniform = [
        Vector::splat(simd, fx),
        Vector::splat(simd, fy),
        Vector::splat(simd, fz),
    ];
    // Slices of equal length, so that the compiler can remove bounds checks.
    let count = slots[0].len();
    for slots in &mut slots {
        *slots = &mut mem::take(slots)[..count];
    }
    for number in 0..count {
        let mut rates = plain;
        if let Some(viscosities) = row.tripled_viscosities {
            rates = Rates::new(&constants, Vector::new(simd, viscosities[number]));
        }
        let mut force = uniform;
        if let Some(axes) = row.forces {
            for axis in 0..3 {
                force[axis] = force[axis] + Vector::new(simd, axes[axis][number]);
            }
        }
        let rest = Vector::new(simd, slots[0][number]);
        let mut moments = VectorMoments::of_rest(simd, rest);
        for pair in 0..PAIRS {
            let there = Vector::new(simd, slots[2 * pair + 1][number]);
            let back = Vector::new(simd, slots[2 * pair + 2][number]);
            moments = moments.with_pair(pair, there, back);
        }
        if let Some(velocities) = &mut row.velocities {
            let found = moments.velocity(&constants, force);
            for axis in 0..3 {
                velocities[axis][number] = found[axis].entries();
            }
        }
        let collision = Collision::new(&constants, &rates, force, moments);
        slots[0][number] = collision.of_rest(rest).entries();
        for pair in 0..PAIRS {
            // Read again, because there are more populations than registers.
            let there = Vector::new(simd, slots[2 * pair + 1][number]);
            let back = Vector::new(simd, slots[2 * pair + 2][number]);
            let left = collision.of_pair(pair, there, back);
            slots[2 * pair + 1][number] = left[0].entries();
            slots[2 * pair + 2][number] = left[1].entries();
        }
    }
}

/// Numbers in every entry of a vector.
#[derive(Clone, Copy)]
struct Constants<V> {
    one: V,
    half: V,
    minus_third: V,
    quarter: V,
    eighth: V,
    twelve: V,
    twelfth: V,
    thirty_sixth: V,
    magic: V,
    inertia: V,
}

impl<T: Precision, S: Simd> Constants<Vector<T, S>> {
    #[inline(always)]
    fn new(simd: S, fluid: &Fluid<'_, T>) -> Self {
        Self {
            one: Vector::constant(simd, 1.0),
            half: Vector::constant(simd, 0.5),
            minus_third: Vector::constant(simd, -1.0 / 3.0),
            quarter: Vector::constant(simd, 0.25),
            eighth: Vector::constant(simd, 0.125),
            twelve: Vector::constant(simd, 12.0),
            twelfth: Vector::constant(simd, 1.0 / 12.0),
            thirty_sixth: Vector::constant(simd, 1.0 / 36.0),
            magic: Vector::constant(simd, MAGIC),
            inertia: Vector::splat(simd, fluid.inertia),
        }
    }
}

/// Relaxation rates, which follow from the viscosity.
#[derive(Clone, Copy)]
struct Rates<V> {
    /// (1 − ω)/2 of ω₊ = 1/(3ν + ½), for what is the same in opposite directions, and of
    /// ω₋ = 1/(Λ/3ν + ½), for what has opposite signs.
    even_left: V,
    odd_left: V,
    /// 1 − ω₊, for rest.
    rest_left: V,
    /// ω₊/36, ω₋/12, ω₊/8 and (1 − ω₊/4)/4: see [`Collision`].
    isotropic: V,
    a: V,
    b: V,
    b_force: V,
}

impl<T: Precision, S: Simd> Rates<Vector<T, S>> {
    #[inline(always)]
    fn new(constants: &Constants<Vector<T, S>>, tripled_viscosity: Vector<T, S>) -> Self {
        let &Constants {
            one,
            half,
            quarter,
            magic,
            ..
        } = constants;
        let even = one / (tripled_viscosity + half);
        let odd = tripled_viscosity / tripled_viscosity.times_plus(half, magic);
        Self {
            even_left: half * (one - even),
            odd_left: half * (one - odd),
            rest_left: one - even,
            isotropic: constants.thirty_sixth * even,
            a: constants.twelfth * odd,
            b: constants.eighth * even,
            b_force: quarter * (one - quarter * even),
        }
    }
}

/// δρ = Σ f and j = Σ c f.
#[derive(Clone, Copy)]
struct VectorMoments<V> {
    excess: V,
    momentum: [V; 3],
}

impl<T: Precision, S: Simd> VectorMoments<Vector<T, S>> {
    #[inline(always)]
    fn of_rest(simd: S, rest: Vector<T, S>) -> Self {
        Self {
            excess: rest,
            momentum: [Vector::constant(simd, 0.0); 3],
        }
    }

    /// With two opposite populations.
    #[inline(always)]
    fn with_pair(self, pair: usize, there: Vector<T, S>, back: Vector<T, S>) -> Self {
        let difference = there - back;
        let mut momentum = self.momentum;
        for axis in 0..3 {
            match VELOCITIES[2 * pair + 1][axis] {
                1 => momentum[axis] = momentum[axis] + difference,
                -1 => momentum[axis] = momentum[axis] - difference,
                _ => {}
            }
        }
        Self {
            excess: self.excess + (there + back),
            momentum,
        }
    }

    /// (j + F/2)/ρ, and with 1 for ρ without inertia.
    #[inline(always)]
    fn velocity(
        &self,
        constants: &Constants<Vector<T, S>>,
        force: [Vector<T, S>; 3],
    ) -> [Vector<T, S>; 3] {
        let &Constants {
            one, half, inertia, ..
        } = constants;
        let over = inertia / (one + self.excess) + (one - inertia);
        let mut velocity = self.momentum;
        for axis in 0..3 {
            velocity[axis] = over * half.times_plus(force[axis], velocity[axis]);
        }
        velocity
    }
}

/// The populations of a node after a collision.
///
/// With δρ = Σ f, j = Σ c f and F the force, momentum is j + F/2, velocity u = (j + F/2)/ρ, and in
/// opposite directions, sum and difference halved,
///
/// `f₊ → (1 − ω₊) f₊ + W [s + (c·b)(c·u)]`, s = ω₊ δρ/36 − b·u/3, b = ω₊ j/8 + (1 − ω₊/4) F/4,
/// `f₋ → (1 − ω₋) f₋ + W c·a`, a = (ω₋ j + F)/12,
///
/// where W = 36 w is 1 along diagonals, 2 along axes and 12 at rest. That is relaxation to
/// `f = w [δρ + ρ (3 c·u + 9/2 (c·u)² − 3/2 u²)]` with Guo's force.
struct Collision<'a, V> {
    constants: &'a Constants<V>,
    rates: &'a Rates<V>,
    u: [V; 3],
    a: [V; 3],
    b: [V; 3],
    s: V,
}

impl<'a, T: Precision, S: Simd> Collision<'a, Vector<T, S>> {
    #[inline(always)]
    fn new(
        constants: &'a Constants<Vector<T, S>>,
        rates: &'a Rates<Vector<T, S>>,
        [fx, fy, fz]: [Vector<T, S>; 3],
        moments: VectorMoments<Vector<T, S>>,
    ) -> Self {
        let &Constants {
            one,
            half,
            minus_third,
            twelfth,
            inertia,
            ..
        } = constants;
        let VectorMoments {
            excess,
            momentum: [jx, jy, jz],
        } = moments;
        let over = inertia / (one + excess);
        let ux = over * half.times_plus(fx, jx);
        let uy = over * half.times_plus(fy, jy);
        let uz = over * half.times_plus(fz, jz);
        let bx = rates.b.times_plus(jx, rates.b_force * fx);
        let by = rates.b.times_plus(jy, rates.b_force * fy);
        let bz = rates.b.times_plus(jz, rates.b_force * fz);
        let bu = bx.times_plus(ux, by.times_plus(uy, bz * uz));
        Self {
            constants,
            rates,
            u: [ux, uy, uz],
            a: [
                rates.a.times_plus(jx, twelfth * fx),
                rates.a.times_plus(jy, twelfth * fy),
                rates.a.times_plus(jz, twelfth * fz),
            ],
            b: [bx, by, bz],
            s: minus_third.times_plus(bu, rates.isotropic * excess),
        }
    }

    #[inline(always)]
    fn of_rest(&self, found: Vector<T, S>) -> Vector<T, S> {
        (self.rates.rest_left).times_plus(found, self.constants.twelve * self.s)
    }

    /// Two opposite populations after the collision, each in the place of the other.
    #[inline(always)]
    fn of_pair(&self, pair: usize, there: Vector<T, S>, back: Vector<T, S>) -> [Vector<T, S>; 2] {
        let mut even = along_pair(pair, self.b).times_plus(along_pair(pair, self.u), self.s);
        let mut odd = along_pair(pair, self.a);
        if pair < 3 {
            (even, odd) = (even + even, odd + odd);
        }
        let even = self.rates.even_left.times_plus(there + back, even);
        let odd = self.rates.odd_left.times_plus(there - back, odd);
        [even - odd, even + odd]
    }
}

/// The scalar product of a vector with the first velocity of a pair.
#[inline(always)]
fn along_pair<T: Precision, S: Simd>(pair: usize, [x, y, z]: [Vector<T, S>; 3]) -> Vector<T, S> {
    match pair {
        0 => x,
        1 => y,
        2 => z,
        3 => x + y,
        4 => x - y,
        5 => x + z,
        6 => x - z,
        7 => y + z,
        _ => y - z,
    }
}

#[cfg(test)]
mod tests;
