//! Noise of positions, its smoothing and adaptive jets in f64, compiled once here for all
//! other crates.

use crate::execute::Parallel;
use crate::held::{VolumeError, keep_volumes};
use crate::ordered::Ordered;
use helfrich::{AdaptiveJet, Components, Measured, Noise, Smoothing, Surface};

/// The noise of a surface, on all threads: see [`Noise::of`].
pub fn noise_of(surface: Surface<'_, f64>) -> Noise<f64> {
    Noise::of(&Parallel::new(), surface)
}

/// Largest number of vertices of which [`noise_seen`] measures every one: some seconds on two threads.
pub const EVERY_VERTEX: usize = 30_000;

/// The noise of a surface as [`measured`] finds it: the median over all vertices. On meshes of more than
/// [`EVERY_VERTEX`] vertices, it is the estimate of [`noise_of`] from some of these.
pub fn noise_seen(surface: Surface<'_, f64>) -> Noise<f64> {
    if surface.mesh().vertex_count() > EVERY_VERTEX {
        return noise_of(surface);
    }
    let jet = AdaptiveJet::default();
    let deviations = Components::each(surface, 0.0, &mut |_| true, &mut |part, _, watch| {
        in_order(part, |part, names| {
            jet.deviations(&Parallel::new(), part, names, watch)
        })
    });
    Noise::of_deviations(surface, &mut deviations.unwrap_or_default())
}

/// The positions of a surface, smoothed on all threads: see [`Smoothing::apply`].
pub fn smoothed(surface: Surface<'_, f64>, smoothing: Smoothing) -> Vec<[f64; 3]> {
    let mut smooth = surface.positions().to_vec();
    smoothing.apply(&Parallel::new(), surface, &mut smooth);
    smooth
}

/// The reason why the noise of a surface is not removed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NotQuieted {
    /// There is none.
    #[error("the positions have no noise that can be told from the shape")]
    NoNoise,
    /// Fits do not reduce it around half of the vertices: see [`Smoothing::of_measured`].
    #[error(
        "the positions have noise of {:.1e} ({:.1e} mean edges), which no fits reduce around half of the vertices or \
         more: it is as small as the errors of the fits, or the mesh does not resolve the shape, as at creases", .0.length, .0.edges
    )]
    Unresolved(Noise<f64>),
    /// A component would lose its volume.
    #[error(transparent)]
    Volume(#[from] VolumeError),
    /// The caller ended the work.
    #[error("interrupted")]
    Interrupted,
}

/// Result of removing the noise of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Quieted {
    /// The noise of the original surface.
    pub noise: Noise<f64>,
    /// The scale of the fits onto which vertices were moved, [`Quieted::TIMES`] times.
    pub smoothing: Smoothing,
    /// The smoothed positions. Each closed component encloses its original volume: see [`keep_volumes`].
    pub positions: Vec<[f64; 3]>,
    /// Root mean square of the displacements.
    pub moved: f64,
}

impl Quieted {
    /// Number of times that vertices are moved. A single fit leaves differences between neighbouring
    /// fits, which the fourth derivatives of f amplify: after four moves the error of f by jets was 0.3
    /// to 0.9 times the error after one move, on discocytes, ellipsoids and tori with noise of 1e-4 to
    /// 3e-2 edges. Eight moves gained little more.
    pub const TIMES: usize = 4;

    /// Removes the noise of a surface, at one scale that adaptive jets choose: see
    /// [`Smoothing::of_measured`]. `watch` gets the part of this choice that is done, and ends the work by `false`.
    ///
    /// # Errors
    /// If there is no noise, if fits do not reduce it, if a volume cannot be kept, or if the work is ended.
    pub fn new(
        surface: Surface<'_, f64>,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Self, NotQuieted> {
        let noise = noise_of(surface);
        // Detecting noise costs little; the choice of the scale takes as long as two dozen evaluations of
        // jets.
        if !noise.is_seen() {
            return Err(NotQuieted::NoNoise);
        }
        let measured = measured(&AdaptiveJet::default(), surface, watch);
        Self::of_measured(surface, noise, &measured.ok_or(NotQuieted::Interrupted)?)
    }

    /// The same for a surface that adaptive jets have measured, with this noise.
    ///
    /// # Errors
    /// If fits do not reduce the noise, or if a volume cannot be kept.
    pub fn of_measured(
        surface: Surface<'_, f64>,
        noise: Noise<f64>,
        measured: &[Measured<f64>],
    ) -> Result<Self, NotQuieted> {
        let smoothing = Smoothing::of_measured(measured);
        let smoothing = smoothing.ok_or(NotQuieted::Unresolved(noise))?;
        Ok(Self::at_scale(surface, noise, smoothing)?)
    }

    /// The same at a given scale, whatever the noise is.
    ///
    /// # Errors
    /// If a volume cannot be kept.
    ///
    /// # Panics
    /// If the degree is not 2 to 6.
    pub fn at_scale(
        surface: Surface<'_, f64>,
        noise: Noise<f64>,
        smoothing: Smoothing,
    ) -> Result<Self, VolumeError> {
        let mut positions = surface.positions().to_vec();
        for _ in 0..Self::TIMES {
            let Ok(rough) = Surface::new(surface.mesh(), &positions) else {
                // Fits have left the range of numbers: the volume is not a number either.
                break;
            };
            positions = smoothed(rough, smoothing);
        }
        keep_volumes(surface, &mut positions)?;
        let both = surface.positions().iter().zip(&positions);
        let squares = both.map(|(a, b)| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>());
        let moved = (squares.sum::<f64>() / positions.len() as f64).sqrt();
        Ok(Self {
            noise,
            smoothing,
            positions,
            moved,
        })
    }
}

/// A surface measured by adaptive jets on all threads, each component alone, in a cache-friendly order if it is
/// large: see [`AdaptiveJet::measure`]. `None` if `watch` returned false.
pub fn measured(
    jet: &AdaptiveJet<f64>,
    surface: Surface<'_, f64>,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Option<Vec<Measured<f64>>> {
    Components::each(
        surface,
        Measured::unknown(),
        watch,
        &mut |part, _, watch| {
            in_order(part, |part, names| {
                jet.measure(&Parallel::new(), part, names, watch)
            })
        },
    )
}

/// The results of `measure` on a surface in a cache-friendly order, if it is large.
fn in_order<R: Copy>(
    surface: Surface<'_, f64>,
    measure: impl FnOnce(Surface<'_, f64>, Option<&[u32]>) -> Option<Vec<R>>,
) -> Option<Vec<R>> {
    let Some(mut ordered) = Ordered::of(surface.mesh()) else {
        return measure(surface, None);
    };
    let names = ordered.order().vertices().to_vec();
    let (surface, _) = ordered.parts(surface);
    let results = measure(surface, Some(&names))?;
    Some(ordered.order().undo(&results))
}
