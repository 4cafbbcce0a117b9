//! The laws, each with formulas from theory for comparison.

use helfrich::{LocalArea, NeoHookean, Real, Skalak, StrainEnergy};

/// A law that can be made for any scalar.
pub(super) trait Family: Copy {
    type Law<T: Real>: StrainEnergy<T>;
    /// Module of the library that contains the law.
    const MODULE: &'static str;
    fn law<T: Real>(self, modulus: T) -> Self::Law<T>;
    /// W of two principal stretches in the form of the literature, for a modulus of 1.
    fn density(self, stretches: [f64; 2]) -> f64;
    /// Tension under two equal stretches.
    fn tension(self, stretch: f64) -> f64;
    /// G and K_s.
    fn moduli(self) -> [f64; 2];
}

/// I1 and I2.
pub(super) fn invariants([a, b]: [f64; 2]) -> [f64; 2] {
    [a * a + b * b - 2.0, a * a * b * b - 1.0]
}

#[derive(Clone, Copy)]
pub(super) struct Rubber;

impl Family for Rubber {
    type Law<T: Real> = NeoHookean<T>;
    const MODULE: &'static str = "neo_hookean";
    fn law<T: Real>(self, shear_modulus: T) -> NeoHookean<T> {
        NeoHookean { shear_modulus }
    }
    fn density(self, stretches: [f64; 2]) -> f64 {
        let [first, second] = invariants(stretches);
        0.5 * (first - 1.0 + 1.0 / (second + 1.0))
    }
    fn tension(self, stretch: f64) -> f64 {
        1.0 - stretch.powi(-6)
    }
    fn moduli(self) -> [f64; 2] {
        [1.0, 3.0]
    }
}

/// Skalak's law with its parameter C.
#[derive(Clone, Copy)]
pub(super) struct Blood(pub(super) f64);

impl Family for Blood {
    type Law<T: Real> = Skalak<T>;
    const MODULE: &'static str = "skalak";
    fn law<T: Real>(self, shear_modulus: T) -> Skalak<T> {
        Skalak {
            shear_modulus,
            area_ratio: T::constant(self.0),
        }
    }
    fn density(self, stretches: [f64; 2]) -> f64 {
        let [first, second] = invariants(stretches);
        0.25 * (first * first + 2.0 * first - 2.0 * second + self.0 * second * second)
    }
    fn tension(self, stretch: f64) -> f64 {
        let square = stretch * stretch;
        square - 1.0 + self.0 * square * (square * square - 1.0)
    }
    fn moduli(self) -> [f64; 2] {
        [1.0, 1.0 + 2.0 * self.0]
    }
}

#[derive(Clone, Copy)]
pub(super) struct Area;

impl Family for Area {
    type Law<T: Real> = LocalArea<T>;
    const MODULE: &'static str = "local_area";
    fn law<T: Real>(self, area_modulus: T) -> LocalArea<T> {
        LocalArea { area_modulus }
    }
    fn density(self, [a, b]: [f64; 2]) -> f64 {
        0.5 * (a * b - 1.0).powi(2)
    }
    fn tension(self, stretch: f64) -> f64 {
        stretch * stretch - 1.0
    }
    fn moduli(self) -> [f64; 2] {
        [0.0, 1.0]
    }
}

/// Sum of two laws over one reference.
#[derive(Clone, Copy)]
pub(super) struct Both<A, B>(pub(super) A, pub(super) B);

impl<A: Family, B: Family> Family for Both<A, B> {
    type Law<T: Real> = (A::Law<T>, B::Law<T>);
    const MODULE: &'static str = "";
    fn law<T: Real>(self, modulus: T) -> Self::Law<T> {
        (self.0.law(modulus), self.1.law(modulus))
    }
    fn density(self, stretches: [f64; 2]) -> f64 {
        self.0.density(stretches) + self.1.density(stretches)
    }
    fn tension(self, stretch: f64) -> f64 {
        self.0.tension(stretch) + self.1.tension(stretch)
    }
    fn moduli(self) -> [f64; 2] {
        let (a, b) = (self.0.moduli(), self.1.moduli());
        [a[0] + b[0], a[1] + b[1]]
    }
}

/// A check that can be applied to every law.
pub(super) trait Check {
    fn check<F: Family>(&mut self, family: F);
}

pub(super) fn for_each(check: &mut impl Check) {
    check.check(Rubber);
    check.check(Blood(0.0));
    check.check(Blood(1.0));
    check.check(Blood(50.0));
    check.check(Area);
    check.check(Both(Rubber, Area));
}
