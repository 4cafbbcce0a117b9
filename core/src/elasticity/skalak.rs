//! The membrane of red blood cells.

use super::{Strain, StrainEnergy};
use crate::real::Real;

/// `W = G/4 (I1² + 2 I1 − 2 I2 + C I2²)`: a membrane that resists shear, and changes of area with
/// the additional ratio C. `K_s = (1 + 2 C) G`; it hardens in extension. The tension at equal
/// stretches λ is `G [λ² − 1 + C λ² (λ⁴ − 1)]`. Stable for C > −1/2; red blood cells have C of 10²
/// and more.
///
/// W is finite for every triangle, even without area.
///
/// R. Skalak, A. Tozeren, R. P. Zarda and S. Chien, Biophys. J. 13 (1973) 245, whose B is 2 G and
/// whose C is 2 C G.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Skalak<T> {
    /// Shear modulus G, in units of force per length.
    pub shear_modulus: T,
    /// C, a pure number.
    pub area_ratio: T,
}

impl<T: Real> StrainEnergy<T> for Skalak<T> {
    #[inline(always)]
    fn density(&self, strain: &Strain<T>) -> T {
        let Strain {
            first,
            second,
            difference,
            ..
        } = *strain;
        let twice = difference + difference;
        let sum = first * first + twice + self.area_ratio * (second * second);
        T::constant(0.25) * self.shear_modulus * sum
    }

    #[inline(always)]
    fn derivatives(&self, strain: &Strain<T>) -> [T; 2] {
        let half = T::constant(0.5) * self.shear_modulus;
        let dilation = self.area_ratio * strain.second;
        [
            half * (strain.first + dilation),
            half * (dilation - T::constant(1.0)),
        ]
    }

    fn shear_modulus(&self) -> T {
        self.shear_modulus
    }

    fn area_modulus(&self) -> T {
        (T::one() + self.area_ratio + self.area_ratio) * self.shear_modulus
    }
}
