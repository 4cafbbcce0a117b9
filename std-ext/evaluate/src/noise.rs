//! Noise of positions, its smoothing and adaptive jets in f64, compiled once here for all
//! other crates.

use crate::execute::Parallel;
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

/// Result of removing the noise of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Quieted {
    /// The noise of the original surface.
    pub noise: Noise<f64>,
    /// The scale of the fits onto which vertices were moved, [`Quieted::TIMES`] times.
    pub smoothing: Smoothing,
    /// The smoothed positions.
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
    /// [`Smoothing::of_measured`]. `None` if there is no noise, or if the mesh does not resolve the shape.
    pub fn new(surface: Surface<'_, f64>) -> Option<Self> {
        let noise = noise_of(surface);
        // Detecting noise costs little; the choice of the scale takes as long as two dozen evaluations of
        // jets.
        if !noise.is_seen() {
            return None;
        }
        let measured = measured(&AdaptiveJet::default(), surface, &mut |_| true)?;
        Self::of_measured(surface, noise, &measured)
    }

    /// The same for a surface that adaptive jets have measured, with this noise.
    pub fn of_measured(
        surface: Surface<'_, f64>,
        noise: Noise<f64>,
        measured: &[Measured<f64>],
    ) -> Option<Self> {
        let smoothing = Smoothing::of_measured(measured)?;
        let mut positions = surface.positions().to_vec();
        for _ in 0..Self::TIMES {
            let smooth = smoothed(Surface::new(surface.mesh(), &positions).ok()?, smoothing);
            positions = smooth;
        }
        let both = surface.positions().iter().zip(&positions);
        let squares = both.map(|(a, b)| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>());
        let moved = (squares.sum::<f64>() / positions.len() as f64).sqrt();
        Some(Self {
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
