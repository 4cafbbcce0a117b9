//! Standard deviation of the positions around every vertex, and resolution of the shape by the mesh.

use super::kind::FitKind;
use super::level::Level;
use super::{Ground, POOL, Verdict, hidden};
use crate::element::Execution;
use crate::noise::quiet::MOST_OF_MESH;
use crate::noise::{
    AROUND_VERTICES, Decay, FLAT, Noise, Smooth, Spectrum, largest_coordinate, rounding, sort,
};
use crate::real::Real;
use alloc::vec;
use alloc::vec::Vec;

/// R/S₆ above which R counts as noise even if less than half of the mesh has noise. If no noise is found
/// on the mesh as a whole, the lower of the two values in [`FLAT`] takes its place.
const CERTAIN: f64 = 0.5;

/// Fraction of the vertices whose noise may be smaller than the lower bound that is assumed for all
/// vertices, or larger than the upper bound that is assumed where the mesh does not resolve the shape.
const QUIETEST: f64 = 0.05;

/// Noise around every vertex.
pub(super) struct Deviations<T> {
    /// σ², squared lengths.
    pub(super) variances: Vec<T>,
    pub(super) verdicts: Vec<Verdict>,
    /// Lower bound of σ², from the digits of the positions or from the user.
    least: T,
}

impl<T: Real> Deviations<T> {
    /// No noise at any vertex.
    pub(super) fn none(ground: &Ground<'_, T>) -> Self {
        let verdict = |vertex: usize| match ground.is_near_border(vertex) {
            true => Verdict::OneSided,
            false => Verdict::Clean,
        };
        let count = ground.normals.len();
        Self {
            variances: vec![T::zero(); count],
            verdicts: (0..count).map(verdict).collect(),
            least: T::zero(),
        }
    }

    /// Estimates the noise from fits of a mesh whose jets have this f. Where their residuals show none, it is also
    /// estimated from wider jets, which are returned.
    pub(super) fn new(
        execution: &impl Execution,
        ground: &Ground<'_, T>,
        jets: &Level<T>,
        force: &[T],
        known: T,
    ) -> (Self, Option<Level<T>>) {
        let spectra = &jets.spectra;
        let mut decays = vec![Decay([T::nan(); 4]); spectra.len()];
        execution.map(&mut decays[..], |vertex, decay| {
            let mut sums = Spectrum::<T>::default();
            for other in ground.pool(vertex, POOL) {
                if ground.is_near_border(other) {
                    continue;
                }
                let terms = spectra[other].iter().flatten();
                for (sum, &term) in sums.iter_mut().flatten().zip(terms) {
                    *sum += term;
                }
            }
            *decay = Decay::new(sums);
        });
        let last_digit = T::epsilon() * largest_coordinate(ground.surface.positions());
        let found = |decay: &Decay<T>| {
            let variance = decay.variance(&AROUND_VERTICES);
            // Also false for NaN.
            if variance > last_digit * last_digit {
                variance
            } else {
                T::zero()
            }
        };
        let mut variances = Vec::from_iter(decays.iter().map(found));
        let inside = decays.iter().filter(|decay| decay.residual().is_finite());
        let inside = inside.count();
        let unresolved = decays
            .iter()
            .filter(|decay| !decay.is_resolved(&AROUND_VERTICES))
            .count();
        let seen = variances.iter().filter(|&&variance| variance > T::zero());
        let smooth = Smooth {
            normals: &ground.normals,
            marks: &ground.marks,
        };
        let everywhere = Noise::of_spectra(ground.surface, smooth, spectra).length;
        let certain = if everywhere > T::zero() {
            CERTAIN
        } else {
            FLAT[0]
        };
        if everywhere == T::zero() && MOST_OF_MESH * POOL > variances.len() {
            // A few pools cover such a mesh, and do not agree about the noise.
            variances.fill(T::zero());
        } else if 2 * unresolved > inside {
            // If the shape is mistaken for noise nearly everywhere, the quietest places are more
            // reliable.
            variances.fill(everywhere * everywhere);
        } else if everywhere == T::zero() || 2 * seen.count() < variances.len() {
            for (variance, decay) in variances.iter_mut().zip(&decays) {
                let [_, _, sixth, left] = decay.0;
                if left < T::constant(certain * certain) * sixth {
                    *variance = T::zero();
                }
            }
        }
        if 2 * unresolved <= inside {
            // The shape is mistaken for noise at the tips of an ellipsoid with large triangles.
            let both = decays.iter().zip(&variances);
            let resolved = both.filter(|(decay, _)| decay.is_resolved(&AROUND_VERTICES));
            let resolved = Vec::from_iter(resolved.map(|(_, &variance)| variance));
            let most = quantile(&resolved, 1.0 - QUIETEST);
            for (variance, decay) in variances.iter_mut().zip(&decays) {
                if !decay.is_resolved(&AROUND_VERTICES) {
                    *variance = variance.min(most);
                }
            }
        }
        let wider = add_hidden(execution, ground, (jets, force), &decays, &mut variances);
        let least = quantile(&variances, QUIETEST);
        let residuals = decays.iter().map(|decay| decay.residual().sqrt());
        let residuals = Vec::from_iter(residuals.filter(|residual| residual.is_finite()));
        let most = quantile(&residuals, 0.5);
        let rounding = rounding(ground.surface.positions(), most);
        let known = (rounding * rounding).max(known * known);
        for variance in &mut variances {
            *variance = variance.max(least).max(known);
        }
        let verdicts = decays.iter().zip(&variances).enumerate();
        let verdicts = verdicts.map(|(vertex, (decay, &variance))| {
            match (
                ground.is_near_border(vertex),
                decay.is_resolved(&AROUND_VERTICES),
            ) {
                (true, _) => Verdict::OneSided,
                (_, false) => Verdict::Unresolved,
                // No fit around the vertex shows whether the mesh resolves the shape.
                _ if decay.residual().is_nan() => Verdict::Unresolved,
                _ if variance > T::zero() => Verdict::Noise,
                _ => Verdict::Clean,
            }
        });
        let found = Self {
            verdicts: verdicts.collect(),
            variances,
            least: known,
        };
        (found, wider)
    }

    /// Reduces σ² at a vertex to this fraction, but not below what is known of it. Returns the actual
    /// fraction.
    pub(super) fn reduce(&mut self, vertex: usize, fraction: T) -> T {
        let before = self.variances[vertex];
        // Also false for NaN.
        if !(fraction < T::one() && before > self.least) {
            return T::one();
        }
        let after = (fraction * before).max(self.least);
        self.variances[vertex] = after;
        after / before
    }

    /// Whether there is noise anywhere.
    pub(super) fn is_seen(&self) -> bool {
        self.variances.iter().any(|&variance| variance > T::zero())
    }
}

/// Adds noise that residuals do not show to the variances, unless these are positive everywhere. Returns the
/// wider jets that show it.
fn add_hidden<T: Real>(
    execution: &impl Execution,
    ground: &Ground<'_, T>,
    (jets, force): (&Level<T>, &[T]),
    decays: &[Decay<T>],
    variances: &mut [T],
) -> Option<Level<T>> {
    if !variances.contains(&T::zero()) {
        return None;
    }
    let wider = Level::new(execution, ground, &FitKind::wider());
    let decay = |vertex: usize| {
        let [fourth, _, sixth, _] = decays[vertex].0;
        let square = sixth / fourth;
        // False for NaN.
        let slow = T::constant(AROUND_VERTICES.slow);
        let is_telling = square <= slow * slow && decays[vertex].is_resolved(&AROUND_VERTICES);
        (is_telling && !ground.is_near_border(vertex)).then_some(square)
    };
    let hidden = hidden::variances(execution, ground, force, [jets, &wider], decay);
    let both = variances.iter_mut().zip(decays);
    for ((variance, decay), hidden) in both.zip(hidden.into_iter().flatten()) {
        *variance = variance.max(hidden.min(decay.residual()));
    }
    Some(wider)
}

/// The value below which the fraction `part` of all values lies.
fn quantile<T: Real>(values: &[T], part: f64) -> T {
    let mut values = values.to_vec();
    sort(&mut values);
    let place = (values.len() as f64 * part) as usize;
    values.get(place).copied().unwrap_or(T::zero())
}
