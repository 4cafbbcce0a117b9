//! Times of the methods, written by `helfrich-studies costs --update`. A new method has 1 here until it is
//! measured.

use super::BendingMethod;

/// Time of an evaluation of f, or of H and K for operators without a force, relative to that of method B.
pub(super) const fn relative(method: BendingMethod) -> f64 {
    match method {
        BendingMethod::KantorNelson => 0.81,
        BendingMethod::GompperKroll => 1.0,
        BendingMethod::Meyer => 1.1,
        BendingMethod::Belkin => 99.0,
        BendingMethod::Farutin => 4.8,
        BendingMethod::Loop => 3.9,
        BendingMethod::Juelicher => 2.0,
        BendingMethod::Hamann => 2.3,
        BendingMethod::Galerkin => 100.0,
        BendingMethod::J4 => 7.2,
        BendingMethod::J6 => 15.0,
        BendingMethod::J8 => 50.0,
        BendingMethod::Jet => 50.0,
        BendingMethod::Corrected => 0.89,
        BendingMethod::CorrectedFit => 6.7,
    }
}
