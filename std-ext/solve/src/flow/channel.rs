//! Steady flow between walls at rest.

use std::f64::consts::PI;

/// Number of terms of the series, which has odd n only: the last is below 1e-8 of the first.
const TERMS: u32 = 200;

/// A straight channel along x, between walls at y = ±H/2 and, if it has a depth, at z = ±W/2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channel {
    /// H.
    pub width: f64,
    /// W; `None` between two plates.
    pub depth: Option<f64>,
}

impl Channel {
    /// u μ/g of fluid of viscosity μ under a force per volume g along x, a squared length.
    ///
    /// Between plates it is `(H²/4 − y²)/2`; in a duct
    /// `4H²/π³ Σ (−1)^((n−1)/2)/n³ [1 − cosh(nπz/H)/cosh(nπW/2H)] cos(nπy/H)` over odd n.
    /// F. M. White, Viscous Fluid Flow, section 3-3.
    pub fn response(&self, y: f64, z: f64) -> f64 {
        let height = self.width;
        let plates = 0.5 * (0.25 * height * height - y * y);
        let Some(depth) = self.depth else {
            return plates;
        };
        // The difference of the series from the flow between plates decays with n faster than any
        // power, except on the walls.
        let term = |index: u32| {
            let n = f64::from(2 * index + 1);
            let sign = if index.is_multiple_of(2) { 1.0 } else { -1.0 };
            let [near, far] = [z.abs(), 0.5 * depth].map(|z| n * PI * z / height);
            let ratio =
                (near - far).exp() * (1.0 + (-2.0 * near).exp()) / (1.0 + (-2.0 * far).exp());
            sign * ratio * (n * PI * y / height).cos() / n.powi(3)
        };
        let series: f64 = (0..TERMS).rev().map(term).sum();
        plates - 4.0 * height * height / PI.powi(3) * series
    }
}
