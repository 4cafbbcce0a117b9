//! The report of a smoothing.

use super::{NO_VOLUME, noise_property, property};
use crate::noise::Quieted;
use crate::smoothing::Smoothed;
use helfrich::Smoothing;
use std::io::{self, Write};

/// Writes what smoothing did to a mesh, one property per line.
///
/// # Errors
/// If `out` cannot be written to.
pub fn smoothing(smoothed: &Smoothed, out: &mut dyn Write) -> io::Result<()> {
    let (name, noise) = noise_property(&smoothed.noise);
    property(out, name, noise)?;
    if let Some(Smoothing { degree, neighbours }) = smoothed.fits {
        let times = Quieted::TIMES;
        let fits = format!("degree {degree} to {neighbours} neighbours, {times} times");
        property(out, "fits", fits)?;
    }
    let [mean, largest] = smoothed.displacements;
    let moved = match &smoothed.unmoved {
        Some(_) => "0".to_owned(),
        None => format!("{mean:.1e} root mean square, {largest:.1e} at most"),
    };
    property(out, "displacements", moved)?;
    let change = |[before, after]: [f64; 2]| format!("{after} (before: {before})");
    property(out, "area", change(smoothed.areas))?;
    let volume = smoothed.volumes.map(change);
    property(out, "volume", volume.as_deref().unwrap_or(NO_VOLUME))
}
