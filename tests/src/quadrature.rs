//! Integrals over exact shapes.

use helfrich::shapes::{ExactPoint, Shape};
use std::f64::consts::{PI, TAU};

/// Nodes and weights of the Gauss–Legendre rule on [−1, 1], exact for polynomials of degree
/// 2 `count` − 1.
pub fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    (0..count)
        .map(|k| {
            let mut x = (PI * (k as f64 + 0.75) / (count as f64 + 0.5)).cos();
            let mut slope = 0.0;
            // Each step of Newton's iteration from Tricomi's estimate doubles the number of digits.
            for _ in 0..6 {
                let (mut before, mut value) = (1.0, x);
                for degree in 2..=count {
                    let n = degree as f64;
                    (before, value) = (
                        value,
                        ((2.0 * n - 1.0) * x * value - (n - 1.0) * before) / n,
                    );
                }
                slope = count as f64 * (before - x * value) / (1.0 - x * x);
                x -= value / slope;
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// ∫ `integrand` dS over a shape whose pre-image is the unit sphere.
pub fn over_sphere_like(
    shape: &impl Shape<f64>,
    integrand: impl Fn(&ExactPoint<f64>) -> f64,
) -> f64 {
    let around = 96;
    let mut sum = 0.0;
    for (z, weight) in gauss_legendre(160) {
        let radius = (1.0 - z * z).sqrt();
        for k in 0..around {
            let (sin, cos) = (TAU * (f64::from(k) + 0.5) / f64::from(around)).sin_cos();
            let preimage = [radius * cos, radius * sin, z];
            let element = weight * TAU / f64::from(around) * shape.area_element(preimage);
            sum += element * integrand(&shape.at(preimage));
        }
    }
    sum
}

/// ∫ `integrand` dS over a shape that is symmetric about the z axis and whose pre-image is itself:
/// a torus of radii `radius` and `tube_radius`.
pub fn over_torus(
    shape: &impl Shape<f64>,
    radius: f64,
    tube_radius: f64,
    integrand: impl Fn(&ExactPoint<f64>) -> f64,
) -> f64 {
    let around = 256;
    (0..around)
        .map(|k| {
            let angle = TAU * (f64::from(k) + 0.5) / f64::from(around);
            let distance = radius + tube_radius * angle.cos();
            let point = shape.at([distance, 0.0, tube_radius * angle.sin()]);
            TAU / f64::from(around) * tube_radius * TAU * distance * integrand(&point)
        })
        .sum()
}
