//! The neo-Hookean membrane.

use super::{Strain, StrainEnergy};
use crate::lane::Lane;
use crate::real::Real;

/// `W = G/2 (I1 − 1 + 1/(I2 + 1))`: a thin sheet of incompressible rubber, which thins as its area
/// grows. `K_s = 3 G`; it softens in extension. Tension of equal stretches λ: `G (1 − λ⁻⁶)`.
///
/// A triangle that has lost its area would have infinite energy. Here no force acts on it, and its
/// energy is finite and far above that of any other shape.
///
/// D. Barthès-Biesel, A. Diaz and E. Dhenin, J. Fluid Mech. 460 (2002) 211.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHookean<T> {
    /// Shear modulus G, in units of force per length.
    pub shear_modulus: T,
}

impl<T: Real> NeoHookean<T> {
    #[inline(always)]
    fn half_modulus(&self) -> T {
        T::constant(0.5) * self.shear_modulus
    }
}

/// `1/(I2 + 1)`, also finite without an area: a tiny number is added, which changes I2 + 1 only
/// near the smallest number of the scalar. The formula avoids squares, which would overflow at
/// stretches that are otherwise in range.
#[inline(always)]
fn inverse<T: Real>(strain: &Strain<T>) -> T {
    let least = T::min_positive_value() / (T::epsilon() * T::epsilon());
    (strain.squared_area_ratio + least).reciprocal_or_zero()
}

impl<T: Real> StrainEnergy<T> for NeoHookean<T> {
    /// `G/2 [(I1 − I2) + I2²/(I2 + 1)]`, two terms of second order, where strains are small;
    /// `G/2 [I1 − I2/(I2 + 1)]`, of which the second is less than 1, where they are large.
    #[inline(always)]
    fn density(&self, strain: &Strain<T>) -> T {
        let share = strain.second * inverse(strain);
        let small = strain.difference + strain.second * share;
        let large = strain.first - share;
        self.half_modulus() * T::select(strain.is_small, small, large)
    }

    #[inline(always)]
    fn derivatives(&self, strain: &Strain<T>) -> [T; 2] {
        let inverse = inverse(strain);
        // 1, or 0 without an area, because the gradient then has no direction.
        let presence = strain.squared_area_ratio * inverse;
        let weight = self.half_modulus() * inverse * presence;
        let sum = T::constant(2.0) + strain.second;
        [
            weight * strain.second * (inverse * sum),
            -(weight * inverse),
        ]
    }

    fn shear_modulus(&self) -> T {
        self.shear_modulus
    }

    fn area_modulus(&self) -> T {
        T::constant(3.0) * self.shear_modulus
    }
}
