//! Noise of meshes that resolve the shape only in part, estimated where the residual is least.
//!
//! The residual of the shape grows with the width of a fit, at least where the mesh nearly resolves the
//! shape; the residual of noise does not.

use super::fit::HeightFit;
use super::{NEIGHBOURS, POOL, Seen, Smooth, median, spectrum_at};
use crate::neighbourhood::Neighbourhood;
use crate::real::Real;
use crate::surface::Surface;
use alloc::vec::Vec;
use core::cmp::Ordering;

/// Inverse of the part of the pools that is taken as quiet, and of the part of these that may be quiet
/// by chance.
const QUIET: usize = 4;
const CHANCE: usize = 20;

/// Least ratio of the residuals at the ends of both parts: noise has 0.8 to 0.9, shapes with any
/// variation had less than 0.3.
const STEADY: f64 = 0.6;

/// Inverse of the largest part of a mesh that a pool may cover: pools that cover the whole mesh agree
/// for any shape.
pub(super) const MOST_OF_MESH: usize = 12;

/// Neighbours of wider fits, and the largest growth of the residual in them that counts as noise: noise
/// has 1.0 to 1.2, shapes had 1.3 to 2.
const WIDE: usize = 72;
const GROWTH: f64 = 1.25;

/// The noise according to the quiet pools, given the estimate in each pool; `None` if the residual
/// there is not noise. `is_noisy` states that there is noise.
pub(super) fn noise<T: Real>(
    surface: Surface<'_, T>,
    smooth: Smooth<'_, T>,
    seen: &mut [(&Vec<u32>, Seen<T>)],
    is_noisy: bool,
) -> Option<T> {
    if MOST_OF_MESH * POOL > surface.mesh().vertex_count() {
        return None;
    }
    let by_residual = |a: &Seen<T>, b: &Seen<T>| a.most.partial_cmp(&b.most);
    seen.sort_by(|(_, a), (_, b)| by_residual(a, b).unwrap_or(Ordering::Equal));
    let quiet = &seen[..seen.len() / QUIET];
    let (loudest, too_quiet) = (&quiet.last()?.1, &seen[seen.len() / CHANCE].1);
    let is_steady = too_quiet.most >= T::constant(STEADY) * loudest.most;
    let of_quiet = |of: fn(&Seen<T>) -> T| median(quiet.iter().map(|(_, seen)| of(seen)));
    let is_seen = is_steady && of_quiet(|seen| seen.least) > T::zero();
    let is_noise = is_seen && (is_noisy || growth(surface, smooth, quiet) <= T::constant(GROWTH));
    is_noise.then(|| of_quiet(|seen| seen.likely))
}

/// The median ratio of the residuals of wide fits to those of other fits; infinite if it is unknown for
/// half of the vertices.
fn growth<T: Real>(
    surface: Surface<'_, T>,
    smooth: Smooth<'_, T>,
    pools: &[(&Vec<u32>, Seen<T>)],
) -> T {
    let mut near = Neighbourhood::default();
    let mut fit = HeightFit::default();
    let mut of_pool = |pool: &Vec<u32>| {
        let mut sums = [[T::zero(); 2]; 2];
        for &vertex in pool {
            let [first, _] = NEIGHBOURS;
            let both = [[first; 2], [WIDE; 2]];
            let [narrow, wide] = both.map(|counts| {
                let spectrum = spectrum_at(surface, smooth, vertex, counts, &mut near, &mut fit);
                spectrum[3]
            });
            // Only vertices where both are known, because the residual varies over the surface.
            if narrow[1] > T::zero() && wide[1] > T::zero() {
                for (sum, term) in sums
                    .iter_mut()
                    .flatten()
                    .zip([narrow, wide].iter().flatten())
                {
                    *sum += *term;
                }
            }
        }
        let [narrow, wide] = sums.map(|[squares, gain]| squares / gain);
        let growth = (wide / narrow).sqrt();
        if growth.is_finite() {
            growth
        } else {
            T::infinity()
        }
    };
    median(pools.iter().map(|(pool, _)| of_pool(pool)))
}
