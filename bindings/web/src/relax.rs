//! A vesicle that relaxes: the least bending energy at fixed area and reduced volume.

use crate::Refusal;
use helfrich::{AnyFunctional, Constraint, Constraints, MaterialParameter, Surface, TriangleMesh};
use helfrich_std::clock;
use helfrich_std::dynamics::{
    Evaluation, Held, Membrane, Motion, Outcome, Problem, Relaxation, Settings, StepReport,
};
use helfrich_std::effect::{Effect, Lumping};
use helfrich_std::generate::{AnyShape, Family, generate};
use helfrich_std::io::MeshFile;
use helfrich_std::method::{BendingMethod, MethodOptions};
use serde::Deserialize;
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::sync::Arc;
use std::time::Duration;

/// The method by which vesicles bend: the energy of a mesh of a thousand vertices is right to a hundredth.
const METHOD: BendingMethod = BendingMethod::Loop;

/// The vertices of a vesicle.
const VERTICES: usize = 642;

/// The reduced volumes of spheroids from which relaxations begin.
pub(crate) const REDUCED_VOLUMES: [f64; 2] = [0.6, 0.98];

/// The shape where a relaxation begins, which leads to the branch of this name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// A long spheroid.
    Prolate,
    /// A flat spheroid.
    Oblate,
}

/// Bending energy at fixed area and volume.
#[derive(Debug)]
struct Vesicle {
    mesh: Arc<TriangleMesh>,
    bending: Effect,
    held: Held,
}

impl Problem for Vesicle {
    fn is_conservative(&self) -> bool {
        self.bending.is_conservative()
    }

    fn evaluate(&mut self, positions: &[[f64; 3]], force: &mut [[f64; 3]]) -> Evaluation {
        force.fill([0.0; 3]);
        let energy = match Surface::new(&self.mesh, positions) {
            Ok(surface) => self.bending.add_force(surface, force),
            Err(_) => f64::NAN,
        };
        Evaluation::new(energy)
    }

    fn constraint_count(&self) -> usize {
        self.held.count()
    }

    fn groups(&self) -> &[u32] {
        self.held.groups()
    }

    fn constraint_gradients(&mut self, positions: &[[f64; 3]], gradients: &mut [Vec<[f64; 3]>]) {
        for (index, gradient) in gradients.iter_mut().enumerate() {
            self.held.gradient(index, positions, gradient);
        }
    }

    fn restore(&mut self, positions: &mut [[f64; 3]]) -> f64 {
        let corrected = self.held.restore(positions);
        corrected.map_or(f64::INFINITY, |correction| correction.residual)
    }
}

/// A relaxation of a vesicle.
#[derive(Debug)]
pub(crate) struct Relaxing {
    vesicle: Vesicle,
    relaxation: Relaxation,
    report: StepReport,
}

impl Relaxing {
    /// A vesicle of the area of a spheroid with this reduced volume, and its mesh.
    pub(crate) fn new(start: Start, reduced_volume: f64) -> Result<(Self, MeshFile), Refusal> {
        let [low, high] = REDUCED_VOLUMES;
        if !(low..=high).contains(&reduced_volume) {
            return Err(Refusal::new(format_args!(
                "a reduced volume of {reduced_volume}: from {low} to {high} is right"
            )));
        }
        let shape = spheroid(start, reduced_volume)?;
        let made = generate(&shape, Family::Relaxed, VERTICES, 0).map_err(Refusal::new)?;
        let mesh = Arc::new(made.mesh);
        let surface = Surface::new(&mesh, &made.positions).map_err(Refusal::new)?;
        let area = surface.area();
        let volume = reduced_volume * area * (area / PI).sqrt() / 6.0;
        let hold = |functional, target: f64| Constraint {
            functional,
            targets: target.into(),
        };
        let constraints = Constraints {
            constraints: vec![
                hold(AnyFunctional::Area, area),
                hold(AnyFunctional::Volume, volume),
            ],
        };
        let material = [1.0, 0.0].map(MaterialParameter::from);
        let options = MethodOptions::default();
        let bending = Effect::bending("bending", METHOD, &options, material, Lumping::Own, &mesh);
        let mut vesicle = Vesicle {
            bending: bending.map_err(Refusal::new)?,
            held: Held::new(Arc::clone(&mesh), constraints),
            mesh: Arc::clone(&mesh),
        };
        let membrane = Membrane {
            mesh: Arc::clone(&mesh),
            bending_modulus: 1.0,
            in_plane_modulus: 0.0,
            motion: Motion::AlongNormals,
            fixed: Vec::new(),
        };
        let settings = Settings::default();
        let relaxation = Relaxation::new(vec![membrane], made.positions, settings);
        let mut relaxation = relaxation.map_err(Refusal::new)?;
        let report = relaxation.start(&mut vesicle);
        let file = MeshFile::new(relaxation.positions().to_vec(), (*mesh).clone());
        let this = Self {
            vesicle,
            relaxation,
            report,
        };
        Ok((this, file))
    }

    /// Steps for this time, at least one.
    pub(crate) fn run(&mut self, time: Duration) {
        let start = clock::now();
        while self.relaxation.outcome().is_none() {
            self.report = self.relaxation.step(&mut self.vesicle);
            if clock::since(start) >= time {
                return;
            }
        }
    }

    pub(crate) fn positions(&self) -> &[[f64; 3]] {
        self.relaxation.positions()
    }

    /// The energy over 8πκ, and where the relaxation stands.
    pub(crate) fn describe(&self) -> Value {
        let report = &self.report;
        let end = self.relaxation.outcome().map(|outcome| match outcome {
            Outcome::Failed(failure) => failure.to_string(),
            outcome => match outcome {
                Outcome::Converged => "converged",
                Outcome::IterationLimit => "the limit of steps was reached",
                _ => "stagnated: the remaining forces are rounding errors",
            }
            .to_owned(),
        });
        json!({
            "energy": report.energy / (8.0 * PI),
            "residual": report.residual,
            "iteration": report.iteration,
            "end": end,
        })
    }
}

/// A spheroid of this reduced volume.
fn spheroid(start: Start, reduced_volume: f64) -> Result<AnyShape, Refusal> {
    let shape = |aspect: f64| format!("ellipsoid:1,1,{aspect}").parse::<AnyShape>();
    // Far beyond the reduced volumes that are offered.
    let mut far: f64 = match start {
        Start::Prolate => 20.0,
        Start::Oblate => 0.05,
    };
    let mut near: f64 = 1.0;
    for _ in 0..60 {
        let middle = (near * far).sqrt();
        let shape = shape(middle).map_err(Refusal::new)?;
        let radius = (shape.area() / (4.0 * PI)).sqrt();
        let reduced = shape.volume() / (4.0 / 3.0 * PI * radius.powi(3));
        if reduced > reduced_volume {
            near = middle;
        } else {
            far = middle;
        }
    }
    shape((near * far).sqrt()).map_err(Refusal::new)
}
