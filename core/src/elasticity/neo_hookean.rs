//! The neo-Hookean membrane.

use super::{Strain, StrainEnergy};
use crate::lane::Lane;
use crate::real::Real;

/// `W = G/2 (I1 − 1 + 1/(I2 + 1))`: a thin sheet of incompressible rubber, which thins as its area
/// grows. `K_s = 3 G`; it softens in extension. Tension of equal stretches λ: `G (1 − λ⁻⁶)`.
///
/// A triangle that has lost its area would have infinite energy; it feels no force, and its energy
/// is finite and means nothing.
///
/// D. Barthès-Biesel, A. Diaz and E. Dhenin, J. Fluid Mech. 460 (2002) 211.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHookean<T> {
    /// Shear modulus G, in units of force per length.
    pub shear_modulus: T,
}

impl<T: Real> NeoHookean<T> {
    #[inline(always)]
    fn half_modulus<L: Lane<Scalar = T>>(&self) -> L {
        L::literal(0.5) * L::splat(self.shear_modulus)
    }
}

/// `1/(I2 + 1)²`, and 0 where it is no finite number.
#[inline(always)]
fn inverse_square<L: Lane>(strain: &Strain<L>) -> L {
    (strain.squared_area_ratio * strain.squared_area_ratio).reciprocal_or_zero()
}

impl<T: Real> StrainEnergy<T> for NeoHookean<T> {
    /// `G/2 [(I1 − I2) + I2²/(I2 + 1)]`, two terms of second order, where strains are small;
    /// `G/2 [I1 − I2/(I2 + 1)]`, of which the second is less than 1, where they are large.
    #[inline(always)]
    fn density<L: Lane<Scalar = T>>(&self, strain: &Strain<L>) -> L {
        let inverse = inverse_square(strain) * strain.squared_area_ratio;
        let share = strain.second * inverse;
        let small = strain.difference + strain.second * share;
        let large = strain.first - share;
        self.half_modulus::<L>() * L::select(strain.is_small, small, large)
    }

    #[inline(always)]
    fn derivatives<L: Lane<Scalar = T>>(&self, strain: &Strain<L>) -> [L; 2] {
        let weight = self.half_modulus::<L>() * inverse_square(strain);
        let sum = strain.second * (L::literal(2.0) + strain.second);
        [weight * sum, -weight]
    }

    fn shear_modulus(&self) -> T {
        self.shear_modulus
    }

    fn area_modulus(&self) -> T {
        T::constant(3.0) * self.shear_modulus
    }
}
