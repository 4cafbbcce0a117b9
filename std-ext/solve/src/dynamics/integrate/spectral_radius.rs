//! The largest eigenvalue of the right-hand side's Jacobian, by power iteration on differences.
//!
//! After each product the two Ritz values of the last three iterates are taken (W. E. Arnoldi,
//! Quart. Appl. Math. 9 (1951) 17), so that complex pairs are found as well as real eigenvalues.

use super::{Checked, Failure, Settings, Start, Work};
use crate::dynamics::vector::{Vector, add, dot, norm, root_mean_square, scale, sub};
use serde::{Deserialize, Serialize};

/// The factor by which the estimate is raised: power iteration approaches from below.
const MARGIN: f64 = 1.15;

/// Relative change of the estimate below which it has converged.
const CONVERGED: f64 = 1e-3;

/// The largest number of iterations.
const LIMIT: usize = 100;

/// The least number of iterations from a random start, and from an earlier mode.
const LEAST: [usize; 2] = [12, 2];

/// The sine² of the angle between two iterates below which they are equal to rounding.
const PARALLEL: f64 = 1e-8;

/// The fraction of the radius above which a positive real part counts as growth and not as an
/// error.
const GROWTH: f64 = 0.1;

/// The largest relative residual with which two Ritz values count as eigenvalues, and the largest
/// relative difference of products from both sides with which there is a derivative.
const RESIDUAL: f64 = 0.1;

/// The largest eigenvalue of the Jacobian ∂v/∂x.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spectrum {
    /// Spectral radius ρ, per time; an estimate that was raised by 15 %.
    pub radius: f64,
    /// Number of iterations, each of one evaluation.
    pub iterations: usize,
    /// Whether the estimate had converged when the iteration ended.
    pub converged: bool,
    /// Growth rate, per time, of the mode of the largest eigenvalue if it does not decay: the real
    /// part of the eigenvalue.
    pub growth: Option<f64>,
    /// The vertex at which that mode is largest.
    pub vertex: usize,
}

/// Ritz values: the larger modulus, the real part that goes with it, and the relative residual.
#[derive(Clone, Copy, Debug)]
struct Ritz {
    modulus: f64,
    real: f64,
    residual: f64,
}

/// Estimates the spectrum at a start. The iteration starts from `mode`, and sets it to its last
/// iterate; `mode` is empty before the first call.
pub(super) fn estimate(
    rhs: &mut Checked<'_>,
    start: Start<'_>,
    settings: &Settings,
    mode: &mut Vec<Vector>,
    work: &mut Work,
) -> Result<Spectrum, Failure> {
    let x = start.positions;
    let cold = mode.len() != x.len();
    if cold {
        mode.clear();
        mode.extend((0..x.len() as u64).map(noise));
    }
    let far = x.iter().map(|x| norm(*x)).fold(settings.length, f64::max);
    // Root mean square of the displacement, which balances truncation against the error of the
    // velocities.
    let displacement = settings.precision.sqrt() * far;
    let least = LEAST[usize::from(!cold)];

    let [before, ..] = &mut work.stages;
    let (product, moved) = (&mut work.end_velocities, &mut work.end);
    normalise(mode);
    before.fill([0.0; 3]);
    // J before = growth mode.
    let mut growth = 0.0;
    let mut modulus = 0.0;
    let mut iterations = 0;
    let (ritz, converged) = loop {
        for (moved, (x, m)) in moved.iter_mut().zip(x.iter().zip(&*mode)) {
            *moved = add(*x, scale(displacement, *m));
        }
        rhs.evaluate(moved, start.time, product)?;
        for (product, v) in product.iter_mut().zip(start.velocities) {
            *product = scale(displacement.recip(), sub(*product, *v));
        }
        iterations += 1;
        let ritz = ritz(before, mode, growth, product);
        let settled = (ritz.modulus - modulus).abs() <= CONVERGED * ritz.modulus;
        modulus = ritz.modulus;
        before.copy_from_slice(mode);
        let size = root_mean_square(product.iter().copied());
        let converged = settled && iterations >= least || size == 0.0;
        if size > 0.0 {
            mode.copy_from_slice(product);
            normalise(mode);
            growth = size;
            // The displacement keeps its sign although the mode decays. If the sign alternated,
            // terms of even order in the displacement would alternate too and look like a growing
            // mode.
            if inner(before, mode) < 0.0 {
                mode.iter_mut()
                    .for_each(|vector| *vector = scale(-1.0, *vector));
                growth = -size;
            }
        }
        if converged || iterations >= LIMIT {
            break (ritz, converged);
        }
    };
    let mut grows = ritz.real > GROWTH * ritz.modulus && ritz.residual <= RESIDUAL;
    if grows {
        // Velocities that jump look like a growing mode on one side only. Methods that choose
        // neighbours by distance have such velocities.
        for (moved, (x, m)) in moved.iter_mut().zip(x.iter().zip(&*before)) {
            *moved = sub(*x, scale(displacement, *m));
        }
        let there = product.clone();
        rhs.evaluate(moved, start.time, product)?;
        iterations += 1;
        for (product, v) in product.iter_mut().zip(start.velocities) {
            *product = scale(displacement.recip(), sub(*v, *product));
        }
        let difference = there.iter().zip(&*product).map(|(a, b)| sub(*a, *b));
        let apart = root_mean_square(difference);
        grows = apart <= RESIDUAL * root_mean_square(there.iter().copied());
    }
    Ok(Spectrum {
        radius: MARGIN * ritz.modulus,
        iterations,
        converged,
        growth: grows.then_some(ritz.real),
        vertex: largest(mode),
    })
}

/// The Ritz values of J on the span of `before` and `mode`, with `J before = growth mode` and
/// `J mode = product`.
fn ritz(before: &[Vector], mode: &[Vector], growth: f64, product: &[Vector]) -> Ritz {
    let size = inner(product, product);
    let left = |rest: f64| (rest.max(0.0) / size).sqrt();
    if size == 0.0 {
        return Ritz {
            modulus: 0.0,
            real: 0.0,
            residual: 0.0,
        };
    }
    let rayleigh = inner(mode, product);
    let cosine = inner(before, mode);
    let determinant = 1.0 - cosine * cosine;
    if growth == 0.0 || determinant <= PARALLEL {
        // The norm is not reduced by errors of the direction. The real part has the sign of the
        // eigenvalue if it has one.
        return Ritz {
            modulus: size.sqrt(),
            real: rayleigh,
            residual: left(size - rayleigh * rayleigh),
        };
    }
    // product ≈ p mode + q before; then λ² = p λ + q growth.
    let other = inner(before, product);
    let p = (rayleigh - cosine * other) / determinant;
    let q = (other - cosine * rayleigh) / determinant;
    let residual = left(size - p * rayleigh - q * other);
    let constant = q * growth;
    let discriminant = 0.25 * p * p + constant;
    if discriminant >= 0.0 {
        let real = 0.5 * p + discriminant.sqrt().copysign(p);
        Ritz {
            modulus: real.abs(),
            real,
            residual,
        }
    } else {
        Ritz {
            modulus: (-constant).sqrt(),
            real: 0.5 * p,
            residual,
        }
    }
}

/// The mean over the vertices of the products of two fields.
fn inner(a: &[Vector], b: &[Vector]) -> f64 {
    let terms = a.iter().zip(b).map(|(a, b)| dot(*a, *b));
    terms.sum::<f64>() / a.len() as f64
}

/// Scales a field to a root mean square of 1.
fn normalise(field: &mut [Vector]) {
    let size = root_mean_square(field.iter().copied());
    for vector in field {
        *vector = scale(size.recip(), *vector);
    }
}

/// The vertex with the longest vector.
fn largest(field: &[Vector]) -> usize {
    let mut best = (0, 0.0);
    for (vertex, vector) in field.iter().enumerate() {
        let size = dot(*vector, *vector);
        if size > best.1 {
            best = (vertex, size);
        }
    }
    best.0
}

/// A vector that contains every mode and is the same on every machine: numbers in [−1, 1) by the
/// mixing function of D. Stafford's variant 13, as SplitMix64 uses it.
fn noise(index: u64) -> Vector {
    [0, 1, 2].map(|axis| {
        let mut bits = (3 * index + axis + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    })
}
