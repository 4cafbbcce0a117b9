//! The adaptive jet as a candidate, which estimates its own errors.

use crate::execute::available_threads;
use crate::measurement::Measurement;
use crate::method::Fields;
use crate::study::{Quantity, Timing};
use helfrich::{AdaptiveJet, Estimate, Measured, Surface};
use std::time::Instant;

/// The mean of the absolute value of a normal error, in standard deviations: √(2/π).
const MEAN: f64 = 0.8;

/// The expected maximum of the errors, in standard deviations: as for about 60 independent normal
/// errors, because fits overlap.
const LARGEST: f64 = 2.4;

/// A surface measured by jets that choose their scale.
pub(super) struct Adaptive {
    pub(super) fields: Fields<f64>,
    /// Expected errors of the quantity, the largest and the mean.
    pub(super) expected: [f64; 2],
    /// Summed over all threads, because a measurement on one thread would take too long.
    pub(super) time: Timing,
}

impl Adaptive {
    /// Measures the surface. `watch` is called with the fraction of the work that is done; `None` if it
    /// returned false.
    pub(super) fn new(
        surface: Surface<'_, f64>,
        quantity: Quantity,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Option<Self> {
        let start = Instant::now();
        let measurement = Measurement::new(surface, &AdaptiveJet::default(), watch)?;
        let threads = available_threads().get() as u32;
        let mut expected = [0.0_f64; 2];
        let mut areas = 0.0;
        for at in &measurement.vertices {
            let error = expected_error(at, quantity);
            if error.is_finite() && at.area.is_finite() {
                expected[0] = expected[0].max(LARGEST * error);
                expected[1] += MEAN * error * at.area;
                areas += at.area;
            }
        }
        expected[1] /= areas;
        Some(Self {
            time: Timing::of_one(start.elapsed() * threads),
            fields: measurement.fields(1.0),
            expected,
        })
    }
}

fn expected_error(at: &Measured<f64>, quantity: Quantity) -> f64 {
    let Estimate { expected, .. } = match quantity {
        Quantity::Mean => at.mean,
        Quantity::Gaussian => at.gaussian,
        Quantity::LaplacianOfMean | Quantity::ForceDensity => at.force_density,
    };
    // f is 2 Δ_S H plus terms without derivatives of H, whose errors are much smaller.
    match quantity {
        Quantity::LaplacianOfMean => expected / 2.0,
        _ => expected,
    }
}
