//! Noise of positions and its smoothing in f64, compiled once here for all other crates.

use crate::execute::Parallel;
use helfrich::{Noise, Smoothing, Surface};

/// The noise of a surface, on all threads: see [`Noise::of`].
pub fn noise_of(surface: Surface<'_, f64>) -> Noise<f64> {
    Noise::of(&Parallel::new(), surface)
}

/// The positions of a surface, smoothed over a number of neighbours on all threads: see
/// [`Smoothing::apply`].
pub fn smoothed(surface: Surface<'_, f64>, neighbours: usize) -> Vec<[f64; 3]> {
    let mut smooth = surface.positions().to_vec();
    Smoothing { neighbours }.apply(&Parallel::new(), surface, &mut smooth);
    smooth
}
