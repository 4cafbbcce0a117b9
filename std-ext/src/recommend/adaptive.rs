//! The adaptive jet among the candidates: it knows its own errors.

use crate::execute::available_threads;
use crate::measurement::Measurement;
use crate::method::Fields;
use crate::study::{Quantity, Timing};
use helfrich::{AdaptiveJet, Estimate, Measured, Surface};
use std::time::Instant;

/// The mean of the absolute value of a normal error, in standard deviations: √(2/π).
const MEAN: f64 = 0.8;

/// The largest of the errors in standard deviations: fits overlap, and of some 60 normal errors that are
/// independent it is so large.
const LARGEST: f64 = 2.4;

/// A surface measured by jets that choose their scale.
pub(super) struct Adaptive {
    pub(super) fields: Fields<f64>,
    /// Expected errors of the quantity, the largest and the mean.
    pub(super) expected: [f64; 2],
    /// On all threads together: it takes too long to be measured on one.
    pub(super) time: Timing,
}

impl Adaptive {
    /// `None` if `watch`, which is called with the part of the work that is done, returned false.
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
    // f = 2 Δ_S H and terms without derivatives, whose errors are much smaller.
    match quantity {
        Quantity::LaplacianOfMean => expected / 2.0,
        _ => expected,
    }
}
