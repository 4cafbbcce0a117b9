//! Collisions compared with the formulas, in vectors of every width.

use super::{Fluid, Precision, Q, Row, VELOCITIES, collide_row, opposite};
use crate::flow::lattice_boltzmann::stencil::{along, weight};
use pulp::{Arch, Scalar128b, Scalar256b, Scalar512b, Simd, WithSimd};
use std::array;

/// The collision as it stands in the literature, direction by direction: what relaxes to
/// equilibrium, and Guo's force, each by even and odd parts.
fn collided(found: [f64; Q], viscosity: f64, force: [f64; 3]) -> [f64; Q] {
    let over_even = 3.0 * viscosity + 0.5;
    let over_odd = 0.5 + 3.0 / 16.0 / (over_even - 0.5);
    let density = 1.0 + found.iter().sum::<f64>();
    let velocity: [f64; 3] = std::array::from_fn(|axis| {
        let momentum = |(c, f): (&[i8; 3], &f64)| f64::from(c[axis]) * f;
        let momentum: f64 = VELOCITIES.iter().zip(&found).map(momentum).sum();
        (momentum + 0.5 * force[axis]) / density
    });
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let squared = dot(velocity, velocity);
    let equilibrium = |i: usize| {
        let u = along(i, velocity);
        let expanded = 1.0 + 3.0 * u + 4.5 * u * u - 1.5 * squared;
        weight(i) * (density * expanded - 1.0)
    };
    let source = |i: usize| {
        let f = along(i, force);
        weight(i) * (3.0 * (f - dot(velocity, force)) + 9.0 * along(i, velocity) * f)
    };
    std::array::from_fn(|i| {
        let parts = |value: &dyn Fn(usize) -> f64| {
            let [here, there] = [value(i), value(opposite(i))];
            [0.5 * (here + there), 0.5 * (here - there)]
        };
        let ([even, odd], [even_force, odd_force]) =
            (parts(&|i| found[i] - equilibrium(i)), parts(&source));
        found[i] - even / over_even - odd / over_odd
            + (1.0 - 0.5 / over_even) * even_force
            + (1.0 - 0.5 / over_odd) * odd_force
    })
}

#[test]
fn populations_are_those_of_the_formulas() {
    let fluid = Fluid {
        tripled_viscosity: 0.6,
        viscosities: None,
        force: [3e-3, -1e-3, 2e-3],
        forces: None,
        inertia: 1.0,
    };
    // Large deviations, so that nothing is too small to be seen.
    let found: [f64; Q] = std::array::from_fn(|i| 0.02 * (1.0 + (7 * i) as f64).sin());
    let expected = collided(found, 0.2, fluid.force);
    let mut slots = found.map(|f| [f]);
    let row = Row {
        tripled_viscosities: None,
        forces: None,
        velocities: None,
    };
    let lent = slots.each_mut().map(|slot| slot.as_mut_slice());
    collide_row(pulp::Scalar::new(), lent, &fluid, row);
    for (i, expected) in expected.into_iter().enumerate() {
        let [left] = slots[opposite(i)];
        assert!(
            (left - expected).abs() < 1e-16,
            "direction {i}: found {left:e}, expected {expected:e}"
        );
    }
}

/// A row of nodes with everything that a collision may have to know.
#[derive(Clone, Debug, PartialEq)]
struct Nodes<T> {
    populations: [Vec<T>; Q],
    tripled_viscosities: Vec<T>,
    forces: [Vec<T>; 3],
    velocities: [Vec<T>; 3],
}

impl<T: Precision> Nodes<T> {
    fn new(length: usize) -> Self {
        let row = |seed: usize, size: f64, mean: f64| -> Vec<T> {
            let number = |k: usize| mean + size * ((7 * seed + 3 * k) as f64).sin();
            (0..length).map(|k| T::constant(number(k))).collect()
        };
        Self {
            populations: array::from_fn(|i| row(i, 0.02, 0.0)),
            tripled_viscosities: row(40, 0.3, 0.6),
            forces: array::from_fn(|axis| row(50 + axis, 1e-3, 0.0)),
            velocities: array::from_fn(|_| row(0, 0.0, 0.0)),
        }
    }

    fn collided(mut self, run: impl FnOnce(Collided<'_, T>)) -> Self {
        run(Collided(&mut self));
        self
    }
}

struct Collided<'a, T>(&'a mut Nodes<T>);

impl<T: Precision> WithSimd for Collided<'_, T> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let nodes = self.0;
        let fluid = Fluid {
            tripled_viscosity: T::constant(0.6),
            viscosities: None,
            force: [T::constant(2e-3); 3],
            forces: None,
            inertia: T::one(),
        };
        let row = Row {
            tripled_viscosities: Some(&nodes.tripled_viscosities),
            forces: Some(nodes.forces.each_ref().map(Vec::as_slice)),
            velocities: Some(nodes.velocities.each_mut().map(Vec::as_mut_slice)),
        };
        let slots = nodes.populations.each_mut().map(Vec::as_mut_slice);
        collide_row(simd, slots, &fluid, row);
    }
}

fn widths_agree<T: Precision>() {
    // Whole vectors of every width, and an end that fills none.
    let nodes = Nodes::<T>::new(37);
    let narrow = nodes.clone().collided(|row| row.with_simd(Scalar128b));
    let wide = nodes.clone().collided(|row| row.with_simd(Scalar256b));
    let widest = nodes.clone().collided(|row| row.with_simd(Scalar512b));
    assert_eq!(narrow, wide);
    assert_eq!(narrow, widest);
    // Without vectors of its own, a processor rounds products before it adds them.
    if !matches!(Arch::new(), Arch::Scalar) {
        let own = nodes.clone().collided(|row| Arch::new().dispatch(row));
        assert_eq!(narrow, own);
    }
    assert_ne!(narrow.velocities, nodes.velocities);
}

#[test]
fn vectors_of_every_width_collide_to_the_same_bits() {
    widths_agree::<f32>();
    widths_agree::<f64>();
}
