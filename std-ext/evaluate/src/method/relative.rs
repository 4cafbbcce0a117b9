//! Times of the methods, written by `helfrich-studies costs --update`. A new method has 1 here until it is
//! measured.

use super::BendingMethod;

/// Time of an evaluation of f, or of H and K for operators without a force, relative to that of method B.
pub(super) const fn relative(method: BendingMethod) -> f64 {
    match method {
        BendingMethod::KantorNelson => 0.75,
        BendingMethod::GompperKroll => 1.0,
        BendingMethod::Meyer => 1.1,
        BendingMethod::Belkin => 110.0,
        BendingMethod::Farutin => 5.5,
        BendingMethod::Loop => 3.5,
        BendingMethod::Juelicher => 1.8,
        BendingMethod::Hamann => 1.9,
        BendingMethod::Galerkin => 120.0,
        BendingMethod::J4 => 6.7,
        BendingMethod::J6 => 13.0,
        BendingMethod::Jet => 14.0,
        BendingMethod::Corrected => 0.79,
        BendingMethod::CorrectedFit => 6.6,
    }
}
