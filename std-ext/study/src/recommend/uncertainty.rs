//! Adaptive jets as the reference of all methods on a surface with noise, and the errors that methods have by their
//! distances from it.

use crate::clock;
use crate::execute::available_threads;
use crate::measurement::Measurement;
use crate::method::{Evaluated, Fields};
use crate::study::{Quantity, Reference, Timing};
use helfrich::{AdaptiveJet, Measured, Real, Surface};

/// The mean of the absolute value of a normal error, in standard deviations: √(2/π).
const MEAN: f64 = 0.8;

/// The expected maximum of errors by noise, in standard deviations: as for about 60 independent normal errors, because
/// fits overlap. Without noise, expected errors are upper estimates at every vertex.
const LARGEST: f64 = 2.4;

/// Expected errors that are subtracted from values before the largest one is sought, as the largest of many values is so
/// by chance; and for a lower bound of it.
const BY_CHANCE: [f64; 2] = [2.0, 3.0];

/// A surface measured by adaptive jets, with the uncertainty of one quantity.
pub(super) struct Uncertain {
    pub(super) measurement: Measurement,
    /// Summed over all threads, because a measurement on one thread would take too long.
    pub(super) time: Timing,
    /// The values at inner vertices where their error is known.
    pub(super) reference: Reference,
    /// Expected errors of these values, in the same units.
    errors: Vec<f64>,
    /// The unit of these over its lower bound.
    more: f64,
    quantity: Quantity,
}

impl Uncertain {
    /// Measures the surface. `watch` is called with the fraction of the work that is done; `None` if it
    /// returned false.
    pub(super) fn new(
        surface: Surface<'_, f64>,
        quantity: Quantity,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Option<Self> {
        let start = clock::now();
        let measurement = Measurement::new(surface, &AdaptiveJet::default(), watch)?;
        let threads = available_threads().get() as u32;
        let time = Timing::of_one(clock::since(start) * threads);
        let estimates = |quantity: Quantity| {
            let all = measurement.vertices.iter().enumerate();
            let all = all.map(move |(vertex, at)| {
                let [value, error] = estimate(at, quantity);
                let is_known = surface.mesh().is_interior(vertex) && (value + error).is_finite();
                if is_known {
                    [value, error]
                } else {
                    [f64::NAN; 2]
                }
            });
            Vec::from_iter(all)
        };
        let (values, errors): (Vec<f64>, Vec<f64>) = (estimates(quantity).into_iter())
            .map(|[value, error]| (value, error))
            .unzip();
        let normals = measurement.vertices.iter().map(|at| at.normal);
        let normals = Vec::from_iter(normals);
        let [reference, least] = BY_CHANCE.map(|by_chance| {
            let mut largest = [0.0; 4];
            for which in [Quantity::Mean, quantity] {
                largest[which as usize] = beyond(&estimates(which), by_chance);
            }
            Reference::estimated(quantity, values.clone(), &normals, largest)
        });
        let scale = reference.scale(quantity);
        Some(Self {
            errors: errors.into_iter().map(|error| error / scale).collect(),
            more: scale / least.scale(quantity),
            measurement,
            time,
            reference,
            quantity,
        })
    }

    /// The largest and the mean error that a method with these results is expected to have. Errors of jets by noise are
    /// independent of those of the reference; other errors may have the same sign. Those of methods other than jets are
    /// bounds.
    pub(super) fn expected<T: Real + Evaluated>(
        &self,
        fields: &Fields<T>,
        is_bound: bool,
    ) -> [f64; 2] {
        let distances = self.reference.at_vertices(fields, self.quantity);
        let [mut largest, mut sum, mut areas] = [0.0_f64; 3];
        for (vertex, at) in self.measurement.vertices.iter().enumerate() {
            let (distance, error) = (distances[vertex], self.errors[vertex]);
            if error.is_nan() {
                continue;
            }
            let has_noise = at.deviation > 0.0;
            let with = |error: f64| match (is_bound, has_noise) {
                (true, _) => self.more * (distance + error),
                (false, true) => distance.hypot(error),
                (false, false) => distance + error,
            };
            let most = if has_noise { LARGEST } else { 1.0 };
            largest = largest.max(with(most * error));
            sum += at.area * with(MEAN * error);
            areas += at.area;
        }
        [largest, sum / areas]
    }
}

/// The value of a quantity at a vertex and its expected error.
fn estimate(at: &Measured<f64>, quantity: Quantity) -> [f64; 2] {
    let [mean, gaussian, force] = [at.mean, at.gaussian, at.force_density]
        .map(|estimate| [estimate.value, estimate.expected]);
    match quantity {
        Quantity::Mean => mean,
        Quantity::Gaussian => gaussian,
        Quantity::ForceDensity => force,
        Quantity::LaplacianOfMean => {
            let ([mean, _], [gaussian, _], [force, error]) = (mean, gaussian, force);
            // The terms without derivatives of H have much smaller errors.
            [
                0.5 * force - 2.0 * mean * (mean * mean - gaussian),
                0.5 * error,
            ]
        }
    }
}

/// The largest absolute value less this multiple of its error.
fn beyond(estimates: &[[f64; 2]], by_chance: f64) -> f64 {
    let sizes = estimates
        .iter()
        .map(|[value, error]| value.abs() - by_chance * error);
    sizes.fold(0.0, f64::max)
}
