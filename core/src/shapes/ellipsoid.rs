//! The ellipsoid with three semi-axes.

use super::{ExactPoint, Shape, ShapeError, between};
use crate::real::Real;
use crate::vec3;
use core::array::from_fn;

/// The ellipsoid Σ (xᵢ/aᵢ)² = 1, the image (a₁X, a₂Y, a₃Z) of the unit sphere.
///
/// With bᵢ = 1/aᵢ² and the moments P = Σ bᵢXᵢ² = Σ xᵢ²/aᵢ⁴, T = Σ bᵢ²Xᵢ², U = Σ bᵢ³Xᵢ²:
/// ```text
/// n = (Xᵢ/aᵢ)/√P     H = E/(2 P^{3/2})     K = b₁b₂b₃/P²     E = P Σbᵢ − T
/// ```
/// which is H = (Σaᵢ² − |x|²)/(2 a₁²a₂²a₃² P^{3/2}), without its powers of length. Δ_S H follows
/// from the product rule on E and P. Both are the restriction of quadratic functions Q of space, for
/// which Δ_S Q = ΔQ − n·Hess(Q)·n − 2H ∂ₙQ:
/// ```text
/// Δ_S E = 2 b₁b₂b₃ (E − 2P²)/P²      Δ_S P = 2 (Σbᵢ² − U/P − E T/P²)
/// ∇_S E·∇_S P = 4 b₁b₂b₃ V/P         |∇_S P|² = 4 W/P
/// Δ_S H = ½ P^{-3/2} [Δ_S E − 12 b₁b₂b₃ V/P² − 3/2 E Δ_S P/P + 15 E W/P³]
/// ```
/// V = T − P² and W = U P − T² are summed over pairs i < j as XᵢXⱼ(bᵢ − bⱼ) squared, times bᵢbⱼ in
/// W: written as differences they would cancel on a nearly round ellipsoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid<T> {
    /// a₁, a₂, a₃ along x, y, z, finite and above 0; lengths.
    pub semi_axes: [T; 3],
}

impl<T: Real> Ellipsoid<T> {
    /// The ellipsoid with these semi-axes along x, y and z.
    ///
    /// # Errors
    /// Unless 0 < a < ∞ for each of the three.
    pub fn new(semi_axes: [T; 3]) -> Result<Self, ShapeError> {
        let parameters = [
            "ellipsoid's semi-axis along x",
            "ellipsoid's semi-axis along y",
            "ellipsoid's semi-axis along z",
        ];
        for (parameter, axis) in parameters.into_iter().zip(semi_axes) {
            between(parameter, axis, T::zero(), T::infinity())?;
        }
        Ok(Self { semi_axes })
    }

    /// The longest semi-axis, the unit of length in all formulas, and the semi-axes in it.
    fn in_own_units(&self) -> (T, [T; 3]) {
        let [a, b, c] = self.semi_axes;
        let unit = a.max(b).max(c);
        (unit, [a / unit, b / unit, c / unit])
    }
}

impl<T: Real> Shape<T> for Ellipsoid<T> {
    fn at(&self, preimage: [T; 3]) -> ExactPoint<T> {
        let number = T::constant;
        let (unit, axes) = self.in_own_units();
        let x = preimage;
        let square = x.map(|x| x * x);
        let b = axes.map(|a| (a * a).recip());

        let moment = |b: [T; 3]| vec3::dot(b, square);
        let p = moment(b);
        let t = moment(b.map(|b| b * b));
        let u = moment(b.map(|b| b * b * b));
        // P Σb − T, as a sum of positive terms.
        let e = moment([
            b[0] * (b[1] + b[2]),
            b[1] * (b[2] + b[0]),
            b[2] * (b[0] + b[1]),
        ]);
        let product = b[0] * b[1] * b[2];
        let pairs = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| {
            let weighted = x[i] * x[j] * (b[i] - b[j]);
            (weighted * weighted, b[i] * b[j])
        });
        let v = pairs[0].0 + pairs[1].0 + pairs[2].0;
        let w = pairs[0].0 * pairs[0].1 + pairs[1].0 * pairs[1].1 + pairs[2].0 * pairs[2].1;

        let two = number(2.0);
        let inverse = p.recip();
        let root = inverse.sqrt();
        let half_power = root * inverse / two;
        let laplacian_e = two * product * (e * inverse * inverse - two);
        let laplacian_p = two * (vec3::dot(b, b) - u * inverse - e * t * inverse * inverse);
        let laplacian_of_mean = half_power
            * (laplacian_e
                - number(12.0) * product * v * inverse * inverse
                - number(1.5) * e * laplacian_p * inverse
                + number(15.0) * e * w * inverse * inverse * inverse);

        ExactPoint {
            position: self.position(preimage),
            normal: from_fn(|i| x[i] / axes[i] * root),
            mean: e * half_power / unit,
            gaussian: product * inverse * inverse / unit / unit,
            laplacian_of_mean: laplacian_of_mean / unit / unit / unit,
        }
    }

    /// (xᵢ/aᵢ) normalised, for every point but the centre.
    fn preimage(&self, position: [T; 3]) -> [T; 3] {
        vec3::normalise(from_fn(|i| position[i] / self.semi_axes[i]))
    }

    /// a₁a₂a₃ √P.
    fn area_element(&self, preimage: [T; 3]) -> T {
        let (unit, axes) = self.in_own_units();
        let slope: [T; 3] = from_fn(|i| preimage[i] / axes[i]);
        axes[0] * axes[1] * axes[2] * vec3::norm(slope) * unit * unit
    }

    fn position(&self, preimage: [T; 3]) -> [T; 3] {
        from_fn(|i| self.semi_axes[i] * preimage[i])
    }
}
