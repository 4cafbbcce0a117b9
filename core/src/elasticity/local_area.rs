//! A penalty on the area of each triangle.

use super::{Strain, StrainEnergy};
use crate::lane::Lane;
use crate::real::Real;

/// `E = k_a/2 Σ (A − A0)²/A0` over the triangles: the membrane resists local changes of area, but
/// not shear. `K_s = k_a`; the tension at equal stretches λ is `k_a (λ² − 1)`.
///
/// No force acts on a triangle that has lost its area, because the gradient of its area has no
/// direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalArea<T> {
    /// Area modulus k_a, in units of force per length.
    pub area_modulus: T,
}

/// `A/A0`, and `A/A0 − 1` without cancellation.
#[inline(always)]
fn area_ratio<T: Real>(strain: &Strain<T>) -> [T; 2] {
    let ratio = Lane::sqrt(strain.squared_area_ratio);
    let growth = strain.second * (T::constant(1.0) + ratio).reciprocal_or_zero();
    [ratio, growth]
}

impl<T: Real> StrainEnergy<T> for LocalArea<T> {
    #[inline(always)]
    fn density(&self, strain: &Strain<T>) -> T {
        let [_, growth] = area_ratio(strain);
        T::constant(0.5) * self.area_modulus * growth * growth
    }

    #[inline(always)]
    fn derivatives(&self, strain: &Strain<T>) -> [T; 2] {
        let [ratio, growth] = area_ratio(strain);
        let half = T::constant(0.5) * self.area_modulus;
        [half * growth * ratio.reciprocal_or_zero(); 2]
    }

    fn shear_modulus(&self) -> T {
        T::zero()
    }

    fn area_modulus(&self) -> T {
        self.area_modulus
    }
}
