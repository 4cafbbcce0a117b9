//! Time spent on the parts of a run that are no effects, and the pictures that a run can afford.

use super::drive::Work;
use crate::scene::{Driver, Output, Pictures, Scene};
use crate::simulation::{EffectCost, Simulation};
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// Time spent on something, and how often.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Spent {
    times: u64,
    seconds: f64,
}

impl Spent {
    /// Counts work that began at `start`.
    pub(super) fn add(&mut self, start: Instant) {
        self.times += 1;
        self.seconds += start.elapsed().as_secs_f64();
    }

    fn named(self, name: &str) -> EffectCost {
        EffectCost {
            effect: name.to_owned(),
            evaluations: self.times,
            seconds: self.seconds,
        }
    }
}

/// Time spent on outputs since the start of a run.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct OutputCosts {
    /// Rows of the series: forces of each effect, findings of methods, estimates of errors.
    pub(super) quality: Spent,
    /// New meshes of surfaces.
    pub(super) remeshing: Spent,
    /// The series, surfaces, fields of the fluid and checkpoints.
    pub(super) files: Spent,
    /// Pictures, slices and plots.
    pub(super) pictures: Spent,
}

impl OutputCosts {
    /// The cost of everything but the effects, which took `effects` of `all` seconds; the rest is the
    /// driver's, in that number of steps.
    pub(super) fn parts(self, steps: u64, effects: f64, all: f64) -> Vec<EffectCost> {
        let outputs = [
            self.quality.named("quality"),
            self.files.named("files"),
            self.pictures.named("pictures"),
        ];
        let remeshing = [self.remeshing].into_iter().filter(|spent| spent.times > 0);
        let remeshing = remeshing.map(|spent| spent.named("remeshing"));
        let outputs = Vec::from_iter(remeshing.chain(outputs));
        let spent: f64 = outputs.iter().map(|cost| cost.seconds).sum();
        // Differences of times may be below 0 by rounding.
        let seconds = (all - effects - spent).max(0.0);
        let driver = Spent {
            times: steps,
            seconds,
        };
        let mut parts = vec![driver.named("driver")];
        parts.extend(outputs);
        parts
    }
}

/// The share of the time of a run that pictures may take by default.
const SHARE: f64 = 0.1;

/// Seconds that a picture takes: without vertices, and for each vertex.
const PICTURE_SECONDS: [f64; 2] = [0.05, 5e-6];

/// Seconds of a sum over all pairs of vertices, for each pair, and of one over clusters, for each vertex.
const SUM_SECONDS: [f64; 2] = [4e-9, 7e-6];

/// Seconds of a step of a lattice, for each node.
const NODE_SECONDS: f64 = 5e-8;

/// Estimate of the seconds that a run has taken so far, without outputs.
pub(super) fn estimated_seconds(scene: &Scene, simulation: &Simulation, work: Work) -> f64 {
    let counts = simulation.bodies().iter().map(|body| body.vertices().len());
    let surfaces = scene.surfaces.iter().zip(counts.clone());
    let forces = surfaces.map(|(surface, vertices)| surface.evaluation_seconds(vertices)[0]);
    let forces: f64 = forces.sum();
    let vertices = counts.sum::<usize>() as f64;
    let [pair, vertex] = SUM_SECONDS;
    let fluid = match scene.driver {
        Driver::Relax(_) => 0.0,
        Driver::BoundaryIntegral(_) => vertices * vertex.min(vertices * pair),
        Driver::LatticeBoltzmann(lattice) => {
            let nodes = lattice.cells.iter().map(|&count| count as f64);
            NODE_SECONDS * nodes.product::<f64>()
        }
    };
    let evaluations = work.right_hand_sides.unwrap_or(work.iterations);
    evaluations as f64 * (forces + fluid)
}

/// Whether a picture is drawn with a set of files, `drawn` of which have one, in a run that has taken
/// about `seconds` so far.
///
/// By default the last set has one, and before it as many as take a tenth of the time of the run. The
/// times are estimates from counts, so that resumed runs have the same pictures.
pub(super) fn is_drawn(
    output: &Output,
    [drawn, vertices]: [u64; 2],
    seconds: f64,
    last: bool,
) -> bool {
    let [fixed, each] = PICTURE_SECONDS;
    let picture = fixed + each * vertices as f64;
    match output.pictures {
        Pictures::Never => false,
        Pictures::Always => true,
        // This one, and the last.
        Pictures::Affordable => last || (drawn + 2) as f64 * picture <= SHARE * seconds,
    }
}
