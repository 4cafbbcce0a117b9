//! Errors due to noise of the positions, measured by adding more noise.
//!
//! All methods share the positions and their noise, so that distances between methods do not reveal the
//! noise. But noise is small compared with an edge, and its effect is nearly linear: additional noise
//! of the same standard deviation changes a result by as much as the existing noise has changed it. The
//! error due to the mesh alone is the error at smoothed positions; smoothing is repeated as often as
//! necessary.

use super::estimate::{Estimate, along_normal};
use crate::generate::random::Random;
use crate::method::{BendingMethod, Evaluator, Fields};
use crate::noise;
use crate::study::Quantity;
use helfrich::{Noise, Smoothing, Surface, SurfaceError, TriangleMesh};

/// Copies of the positions with noise added.
pub(super) const REPLICAS: usize = 2;

/// Numbers of neighbours for smoothing, and of repetitions, until noise is small; the last stages use
/// the neighbours of [`widest`].
const STAGES: [(usize, usize); 4] = [(48, 2), (64, 2), (64, 4), (64, 4)];
const LAST_STAGES: [usize; 4] = [4, 4, 8, 8];

/// Largest mean effect of noise on J6 after smoothing, relative to that before.
const LEFT: f64 = 0.3;

/// Largest effect of noise on means over patches, relative to the largest value.
const PATCH_NOISE: f64 = 0.05;

/// Inverse of the part of a mesh that a patch covers; patches have seven vertices or more. Features of
/// a shape that a mesh of 2562 vertices resolves are larger.
const PATCHES: usize = 366;
const LARGEST_PATCH: usize = 64;

/// Positions with noise, smoothed, and with additional noise.
pub(super) struct Noisy {
    /// The positions without most of the noise.
    pub(super) smooth: Vec<[f64; 3]>,
    /// The positions with added noise of the same standard deviation, each from other random numbers.
    pub(super) replicas: [Vec<[f64; 3]>; REPLICAS],
    /// The best estimate on the positions with noise.
    pub(super) estimate: Estimate,
}

/// J6 on one set of positions, as means over patches and at vertices.
struct Glimpse {
    values: [Vec<f64>; 4],
    patches: [Vec<f64>; 4],
}

impl Noisy {
    /// Smooths positions until noise matters little for a quantity.
    pub(super) fn new(
        mesh: &TriangleMesh,
        positions: &[[f64; 3]],
        noise: Noise<f64>,
        quantity: Quantity,
    ) -> Result<Self, SurfaceError> {
        let mut random = Random::new(1);
        let replicas = [(); REPLICAS].map(|()| disturbed(positions, noise.length, &mut random));
        let estimate = Estimate::new(mesh, positions, noise, quantity)?;
        let scale = estimate.reference.scale(quantity);
        let patches = patches(mesh);
        let mut jets = Evaluator::new(BendingMethod::J6, 1.0, mesh);
        let mut glimpse = |positions: &[[f64; 3]]| {
            let fields = jets.fields(Surface::new(mesh, positions)?);
            Ok::<_, SurfaceError>(Glimpse::new(&fields, &patches))
        };
        let which = quantity as usize;
        let before = distance(
            &glimpse(positions)?.values[which],
            &glimpse(&replicas[0])?.values[which],
        );
        // The same smoothing of positions with additional noise shows how much of the noise remains.
        let mut pair = [positions.to_vec(), replicas[0].clone()];
        let widest = widest(mesh);
        let last = LAST_STAGES.map(|times| (widest, times));
        for (neighbours, times) in STAGES.into_iter().chain(last) {
            for positions in &mut pair {
                for _ in 0..times {
                    *positions = smoothed(mesh, positions, neighbours)?;
                }
            }
            let [here, there] = [glimpse(&pair[0])?, glimpse(&pair[1])?];
            let left = distance(&here.values[which], &there.values[which]);
            let uncertain = root_mean_square(&here.patches[which], &there.patches[which]);
            if left <= LEFT * before && uncertain <= PATCH_NOISE * scale {
                break;
            }
        }
        let [smooth, _] = pair;
        Ok(Self {
            smooth,
            replicas,
            estimate,
        })
    }
}

/// Neighbours that span no more than a fortieth of a mesh.
fn widest(mesh: &TriangleMesh) -> usize {
    (mesh.vertex_count() / 40).clamp(64, 128)
}

/// Adds an error of this standard deviation to each coordinate; a sum of twelve uniform numbers is
/// nearly normal.
fn disturbed(positions: &[[f64; 3]], deviation: f64, random: &mut Random) -> Vec<[f64; 3]> {
    let mut error = || (0..12).map(|_| random.unit()).sum::<f64>() - 6.0;
    let moved = positions.iter().map(|x| x.map(|x| x + deviation * error()));
    moved.collect()
}

fn smoothed(
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
    neighbours: usize,
) -> Result<Vec<[f64; 3]>, SurfaceError> {
    let surface = Surface::new(mesh, positions)?;
    let smoothing = Smoothing {
        degree: 4,
        neighbours,
    };
    Ok(noise::smoothed(surface, smoothing))
}

/// The patch around each vertex: the vertex and its breadth-first neighbourhood.
fn patches(mesh: &TriangleMesh) -> Vec<Vec<u32>> {
    let size = (mesh.vertex_count() / PATCHES).clamp(7, LARGEST_PATCH);
    let mut reached = vec![u32::MAX; mesh.vertex_count()];
    let patch = |centre: usize| {
        let mut patch = vec![centre as u32];
        reached[centre] = centre as u32;
        let mut next = 0;
        while next < patch.len() && patch.len() < size {
            for &neighbour in mesh.one_ring(patch[next] as usize) {
                if reached[neighbour as usize] != centre as u32 {
                    reached[neighbour as usize] = centre as u32;
                    patch.push(neighbour);
                }
            }
            next += 1;
        }
        patch
    };
    (0..mesh.vertex_count()).map(patch).collect()
}

impl Glimpse {
    fn new(fields: &Fields<f64>, patches: &[Vec<u32>]) -> Self {
        let values = along_normal(fields);
        let mean_over = |values: &Vec<f64>| {
            let mean = |patch: &Vec<u32>| {
                let values = patch.iter().map(|&vertex| values[vertex as usize]);
                mean(values)
            };
            patches.iter().map(mean).collect()
        };
        let patches = values.each_ref().map(mean_over);
        Self { values, patches }
    }
}

/// The mean without NaN; `None` if nothing is left.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let known = values.filter(|value| value.is_finite());
    let (sum, count) = known.fold((0.0, 0_u32), |(sum, count), value| (sum + value, count + 1));
    sum / f64::from(count)
}

fn distance(here: &[f64], there: &[f64]) -> f64 {
    mean(here.iter().zip(there).map(|(a, b)| (a - b).abs()))
}

fn root_mean_square(here: &[f64], there: &[f64]) -> f64 {
    mean(here.iter().zip(there).map(|(a, b)| (a - b).powi(2))).sqrt()
}
