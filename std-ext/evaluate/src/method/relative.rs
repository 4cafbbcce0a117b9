//! Times of the methods, written by `helfrich-studies costs --update`. A new method has 1 here until it is
//! measured.

use super::BendingMethod;

/// Time of an evaluation of f, or of H and K for operators without a force, relative to that of method B.
pub(super) const fn relative(method: BendingMethod) -> f64 {
    match method {
        BendingMethod::KantorNelson => 0.87,
        BendingMethod::GompperKroll => 1.0,
        BendingMethod::Meyer => 1.6,
        BendingMethod::Belkin => 330.0,
        BendingMethod::Farutin => 13.0,
        BendingMethod::Loop => 9.8,
        BendingMethod::Juelicher => 2.8,
        BendingMethod::Hamann => 5.6,
        BendingMethod::Galerkin => 300.0,
        BendingMethod::J4 => 38.0,
        BendingMethod::J6 => 69.0,
        BendingMethod::J8 => 180.0,
        BendingMethod::Jet => 180.0,
        BendingMethod::Corrected => 0.86,
        BendingMethod::CorrectedFit => 38.0,
    }
}
