//! The energies of whole components, for the laws of conservative methods.

use crate::laws::{ConservativeCandidate, ConservativeLaw, Sum};
use helfrich::{
    AnyFunctional, AreaDifference, OsmoticPressure, PatchFunctional, Penalty, Real, SurfaceTension,
};

/// Surface tension.
#[derive(Clone, Copy, Debug)]
pub struct Tension;

impl ConservativeCandidate for Tension {
    type ConservativeMethod<T: Real> = SurfaceTension<T>;
    fn name(self) -> &'static str {
        "surface tension"
    }
    fn method<T: Real>(self, modulus: T) -> SurfaceTension<T> {
        SurfaceTension::new(modulus)
    }
}

/// Osmotic pressure.
#[derive(Clone, Copy, Debug)]
pub struct Pressure;

impl ConservativeCandidate for Pressure {
    type ConservativeMethod<T: Real> = OsmoticPressure<T>;
    fn name(self) -> &'static str {
        "osmotic pressure"
    }
    fn method<T: Real>(self, modulus: T) -> OsmoticPressure<T> {
        OsmoticPressure::new(modulus)
    }
}

/// The penalty of a quantity.
#[derive(Clone, Copy, Debug)]
pub struct Penalised {
    /// The quantity.
    pub quantity: AnyFunctional,
    /// Its target.
    pub target: f64,
}

impl ConservativeCandidate for Penalised {
    type ConservativeMethod<T: Real> = Penalty<T>;
    fn name(self) -> &'static str {
        match self.quantity {
            AnyFunctional::Area => "penalty of area",
            AnyFunctional::Volume => "penalty of volume",
            AnyFunctional::MeanCurvature => "penalty of mean curvature",
            AnyFunctional::OfPatches(PatchFunctional::Area) => "penalty of the area of patches",
            AnyFunctional::OfPatches(PatchFunctional::Volume) => "penalty of the volume of patches",
        }
    }
    fn method<T: Real>(self, modulus: T) -> Penalty<T> {
        Penalty::new(self.quantity, modulus, T::constant(self.target))
    }
}

/// Area difference.
#[derive(Clone, Copy, Debug)]
pub struct Bilayer {
    /// Target M0 of [`AreaDifference`].
    pub target: f64,
}

impl ConservativeCandidate for Bilayer {
    type ConservativeMethod<T: Real> = AreaDifference<T>;
    fn name(self) -> &'static str {
        "area difference"
    }
    fn method<T: Real>(self, modulus: T) -> AreaDifference<T> {
        AreaDifference::new(modulus, T::constant(self.target))
    }
}

/// Applies a law to every energy of whole components, with targets for bodies of size 1.
pub fn for_each_potential(law: &mut impl ConservativeLaw) {
    law.check(Tension);
    law.check(Pressure);
    for (quantity, target) in [
        (AnyFunctional::Area, 9.0),
        (AnyFunctional::Volume, 2.5),
        (AnyFunctional::MeanCurvature, 15.0),
    ] {
        law.check(Penalised { quantity, target });
    }
    law.check(Bilayer { target: 15.0 });
    law.check(Sum(Tension, Bilayer { target: 10.0 }));
}
