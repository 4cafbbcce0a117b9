//! Noise that is smaller than the residual of the shape, from the distances between bending forces.
//!
//! Fourth derivatives amplify noise far more than a residual does. f of two interpolating jets, over fewer
//! and more neighbours, differs by noise and by bias. Its squared difference divided by the effect of noise
//! of variance 1 is the variance of the noise that would explain it. Noise has the same variance by degrees
//! 4 and 6; the bias has less by degree 6, because it is of higher order.

use super::bias::FitPair;
use super::level::Level;
use super::{FORCE, Ground, POOL, REPLICAS};
use crate::element::Execution;
use crate::noise::largest_coordinate;
use crate::noise::quiet::MOST_OF_MESH;
use crate::real::Real;
use alloc::vec::Vec;

/// Largest ratio of the deviations that explain the distances by degrees 6 and 4 for most vertices of a shape,
/// and its ratio to S₆/S₄, with which it falls. On meshes that resolve 32 shapes, the median of the first was at
/// most 0.27 with 1280 vertices, 0.32 with 2562, and 0.10 with 10 242, that of the second at most 4.2. Noise has
/// 1.
const STEEP: [f64; 2] = [0.4, 6.0];

/// Largest difference of f of the first level from that of the jets in units of its distance from the second level.
const UNLIKE: f64 = 0.5;

/// σ² around each vertex by the distances between two levels of interpolating jets, 0 where the shape explains
/// them. `None` unless there is noise at half of all vertices, because distances that the shape explains scatter
/// as well, and on meshes that a few pools cover. Only vertices where the squared decay of the shape, (S₆/S₄)²,
/// is known are taken into account, and where f of the first level is near that of the jets, `force`.
pub(super) fn variances<T: Real>(
    execution: &impl Execution,
    ground: &Ground<'_, T>,
    force: &[T],
    levels: [&Level<T>; 2],
    decay: impl Fn(usize) -> Option<T>,
) -> Option<Vec<T>> {
    if MOST_OF_MESH * POOL > ground.rings.len() {
        return None;
    }
    let [near, far] = levels.map(|level| &level.of_degrees[1].values[FORCE]);
    let is_telling = |vertex: usize| {
        let [unlike, distance] = [force, far].map(|other| (other[vertex] - near[vertex]).abs());
        // False for NaN.
        unlike <= T::constant(UNLIKE) * distance && decay(vertex).is_some()
    };
    let [fourth, sixth] = [0, 1].map(|which| {
        let [near, far] = levels.map(|level| &level.of_degrees[which]);
        let pair = FitPair {
            values: [&far.values[FORCE], &near.values[FORCE]],
            changes: [&far.changes[FORCE], &near.changes[FORCE]],
        };
        explained(execution, ground, &pair, is_telling)
    });
    let last_digit = T::epsilon() * largest_coordinate(ground.surface.positions());
    let of_noise = sixth.iter().zip(&fourth).enumerate();
    let of_noise = of_noise.map(|(vertex, (&sixth, &fourth))| {
        let [most, of_decay] = STEEP.map(|factor| T::constant(factor * factor));
        let decay = decay(vertex).unwrap_or(T::one());
        let steep = most.min(of_decay * decay);
        let variance = (sixth - steep * fourth) / (T::one() - steep);
        // Also false for NaN.
        if variance > last_digit * last_digit {
            variance
        } else {
            T::zero()
        }
    });
    let of_noise = Vec::from_iter(of_noise);
    let is_noisy = |vertex: &usize| is_telling(*vertex) && of_noise[*vertex] > T::zero();
    let noisy = (0..of_noise.len()).filter(is_noisy).count();
    (2 * noisy >= of_noise.len()).then_some(of_noise)
}

/// σ² of the noise that explains the distance of two estimates; NaN where it is unknown.
fn explained<T: Real>(
    execution: &impl Execution,
    ground: &Ground<'_, T>,
    pair: &FitPair<'_, T>,
    is_telling: impl Fn(usize) -> bool,
) -> Vec<T> {
    let square = |x: T| x * x;
    let known = |vertex: usize, square: T| if is_telling(vertex) { square } else { T::nan() };
    let count = ground.rings.len();
    let distances = (0..count).map(|vertex| known(vertex, square(pair.difference(vertex))));
    let effects = (0..count).map(|vertex| {
        let changes = (0..REPLICAS).map(|replica| square(pair.change(vertex, replica)));
        known(vertex, changes.sum::<T>() / T::constant(REPLICAS as f64))
    });
    let [distances, effects] = [distances.collect::<Vec<T>>(), effects.collect()]
        .map(|squares| ground.means(execution, &squares, POOL));
    let both = distances.iter().zip(&effects);
    both.map(|(&distance, &effect)| distance / effect).collect()
}
