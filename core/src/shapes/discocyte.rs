//! The red blood cell of Evans and Fung.

use super::{ExactPoint, Shape, ShapeError, between};
use crate::real::Real;
use crate::vec3;

/// The biconcave disc z = ±(R/2) √(1−u) P(u), P(u) = C₀ + C₁u + C₂u², u = (x² + y²)/R².
///
/// Source: E. Evans and Y.-C. Fung, Improved measurements of the erythrocyte geometry, Microvascular
/// Research 4 (1972) 335–347.
///
/// It is the image R (X, Y, Z P(u)/2) of the unit sphere, u = X² + Y². With v = 1 − u = Z², a prime
/// for d/du and R = 1:
/// ```text
/// q = (−P + 2vP')/2    G = v + u q²    m = q + 2uvq'    N = qG + m    M = N'G − 3/2 N G'
/// n = (−qX, −qY, Z)/√G    H = −½ N G^{-3/2}    K = q m G^{-2}
/// Δ_S H = −[2v((uM)'G − 3uMG') − uMG] G^{-9/2}
/// ```
/// Everything is computed from the factors q, G, m and their derivatives: expanded into powers of u
/// the polynomials cancel and lose eight digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discocyte<T> {
    /// R, of the rim, finite and above 0; a length.
    pub radius: T,
    /// C₀, C₁, C₂, such that P is above 0 everywhere in 0 ≤ u ≤ 1; without unit.
    pub coefficients: [T; 3],
}

/// The generating polynomials at one u, for R = 1.
struct Profile<T> {
    u: T,
    v: T,
    /// P(u), the thickness over √v.
    thickness: T,
    /// q, q', q''; its third derivative vanishes.
    q: [T; 3],
    /// G, G', G''.
    g: [T; 3],
}

impl<T: Real> Discocyte<T> {
    /// The average human red blood cell, C = (0.207161, 2.002558, −1.122762), with this radius.
    ///
    /// # Errors
    /// Unless 0 < `radius` < ∞.
    pub fn new(radius: T) -> Result<Self, ShapeError> {
        Self::with_coefficients(radius, [0.207161, 2.002558, -1.122762].map(T::constant))
    }

    /// The disc with this radius and these C₀, C₁, C₂.
    ///
    /// # Errors
    /// Unless 0 < `radius` < ∞ and the least value of P(u) in 0 ≤ u ≤ 1 is above 0 and finite.
    pub fn with_coefficients(radius: T, coefficients: [T; 3]) -> Result<Self, ShapeError> {
        let (zero, one) = (T::zero(), T::one());
        let radius = between("discocyte's radius", radius, zero, T::infinity())?;
        let shape = Self {
            radius,
            coefficients,
        };
        let [_, c1, c2] = coefficients;
        let turning = (-c1 / (c2 + c2)).max(zero).min(one);
        // Compared one by one, because the minimum of two numbers would hide a NaN.
        for u in [zero, turning, one] {
            let parameter = "discocyte's least C0 + C1 u + C2 u² in 0 <= u <= 1";
            between(parameter, shape.thickness(u), zero, T::infinity())?;
        }
        Ok(shape)
    }

    /// P(u).
    fn thickness(&self, u: T) -> T {
        let [c0, c1, c2] = self.coefficients;
        c0 + u * (c1 + u * c2)
    }

    fn profile(&self, [x, y, z]: [T; 3]) -> Profile<T> {
        let [_, c1, c2] = self.coefficients;
        let two = T::constant(2.0);
        let half = T::constant(0.5);
        let u = x * x + y * y;
        let v = z * z;

        let thickness = self.thickness(u);
        let slope = c1 + two * c2 * u;
        let bend = two * c2;
        let q0 = v * slope - half * thickness;
        let q1 = v * bend - T::constant(1.5) * slope;
        let q2 = -T::constant(2.5) * bend;
        Profile {
            u,
            v,
            thickness,
            q: [q0, q1, q2],
            g: [
                v + u * q0 * q0,
                q0 * q0 + two * u * q0 * q1 - T::one(),
                two * (two * q0 * q1 + u * (q1 * q1 + q0 * q2)),
            ],
        }
    }
}

impl<T: Real> Shape<T> for Discocyte<T> {
    fn at(&self, preimage: [T; 3]) -> ExactPoint<T> {
        let [x, y, z] = preimage;
        let two = T::constant(2.0);
        let three = T::constant(3.0);
        let half = T::constant(0.5);
        let Profile {
            u,
            v,
            thickness,
            q: [q0, q1, q2],
            g: [g0, g1, g2],
        } = self.profile(preimage);

        let uv = u * v;
        let uv1 = v - u;
        let m0 = q0 + two * uv * q1;
        let m1 = q1 + two * (uv1 * q1 + uv * q2);
        let m2 = q2 + T::constant(4.0) * (uv1 * q2 - q1);
        let n0 = q0 * g0 + m0;
        let n1 = q1 * g0 + q0 * g1 + m1;
        let n2 = q2 * g0 + two * q1 * g1 + q0 * g2 + m2;
        // M and M', the numerator of −2 G^{5/2} H' and its derivative.
        let slope = n1 * g0 - three * half * n0 * g1;
        let bend = n2 * g0 - half * n1 * g1 - three * half * n0 * g2;

        let inverse = g0.recip();
        let root = inverse.sqrt();
        let flux = (slope + u * bend) * g0 - three * u * slope * g1;
        let laplacian_of_mean =
            -(two * v * flux - u * slope * g0) * inverse * inverse * inverse * inverse * root;

        let unit = self.radius;
        ExactPoint {
            position: vec3::scale(unit, [x, y, half * z * thickness]),
            normal: vec3::scale(root, [-q0 * x, -q0 * y, z]),
            mean: -half * n0 * inverse * root / unit,
            gaussian: q0 * m0 * inverse * inverse / unit / unit,
            laplacian_of_mean: laplacian_of_mean / unit / unit / unit,
        }
    }

    /// (x, y, 2z/P(u)) normalised, for every point but the centre; beyond the rim P(1) is taken.
    fn preimage(&self, position: [T; 3]) -> [T; 3] {
        let [x, y, z] = vec3::scale(self.radius.recip(), position);
        let u = (x * x + y * y).min(T::one());
        vec3::normalise([x, y, (z + z) / self.thickness(u)])
    }

    /// R² √G.
    fn area_element(&self, preimage: [T; 3]) -> T {
        let [element, ..] = self.profile(preimage).g;
        element.sqrt() * self.radius * self.radius
    }

    fn position(&self, preimage: [T; 3]) -> [T; 3] {
        let [x, y, z] = preimage;
        let thickness = self.thickness(x * x + y * y);
        vec3::scale(self.radius, [x, y, T::constant(0.5) * z * thickness])
    }
}
