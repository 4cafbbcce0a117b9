//! A vesicle that relaxes.

use super::super::{Held, Membrane, Motion, Problem, Settings};
use super::{Evaluation, Failure, Outcome, Relaxation, SetupError, State, StepReport};
use helfrich::{
    AnyFunctional, Constraint, Constraints, Juelicher, Prepared, Surface, TriangleMesh,
};
use helfrich_mesh::generate::{AnyShape, Family, generate};
use std::sync::Arc;

/// Jülicher's bending energy with area and volume held.
struct Vesicle {
    mesh: Arc<TriangleMesh>,
    bending: Prepared<f64, Juelicher<f64>>,
    held: Held,
    groups: Vec<u32>,
    /// The evaluation that goes wrong.
    broken: Option<usize>,
    evaluations: usize,
}

impl Vesicle {
    /// A vesicle of reduced volume 0.9, from an ellipsoid.
    fn new() -> (Self, Vec<[f64; 3]>) {
        Self::of_reduced_volume(0.9)
    }

    fn of_reduced_volume(reduced: f64) -> (Self, Vec<[f64; 3]>) {
        let shape: AnyShape = "ellipsoid:1,1,1.9".parse().expect("a shape");
        let generated = generate(&shape, Family::Relaxed, 162, 0).expect("a mesh");
        let mesh = Arc::new(generated.mesh);
        let area = Surface::new(&mesh, &generated.positions)
            .expect("fits")
            .area();
        let sphere = area * (area / std::f64::consts::PI).sqrt() / 6.0;
        let hold = |functional, target: f64| Constraint {
            functional,
            targets: target.into(),
        };
        let constraints = Constraints {
            constraints: vec![
                hold(AnyFunctional::Area, area),
                hold(AnyFunctional::Volume, reduced * sphere),
            ],
        };
        let vesicle = Self {
            bending: Prepared::new(Juelicher::new(1.0), &mesh),
            held: Held::new(Arc::clone(&mesh), constraints),
            groups: vec![0; mesh.vertex_count()],
            mesh,
            broken: None,
            evaluations: 0,
        };
        (vesicle, generated.positions)
    }

    fn membranes(&self) -> Vec<Membrane> {
        vec![Membrane {
            mesh: Arc::clone(&self.mesh),
            bending_modulus: 1.0,
            in_plane_modulus: 0.0,
            motion: Motion::AlongNormals,
            fixed: Vec::new(),
        }]
    }
}

impl Problem for Vesicle {
    fn is_conservative(&self) -> bool {
        true
    }

    fn evaluate(&mut self, positions: &[[f64; 3]], force: &mut [[f64; 3]]) -> Evaluation {
        self.evaluations += 1;
        force.fill([0.0; 3]);
        let surface = Surface::new(&self.mesh, positions).expect("finite");
        let energy = self.bending.add_force_and_energy(surface, force);
        if self.broken.is_some_and(|broken| self.evaluations >= broken) {
            force[7][1] = f64::NAN;
        }
        Evaluation::new(energy)
    }

    fn constraint_count(&self) -> usize {
        self.held.count()
    }

    fn groups(&self) -> &[u32] {
        &self.groups
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

#[test]
fn a_stored_state_continues_bit_for_bit() {
    let (mut vesicle, positions) = Vesicle::new();
    let membranes = vesicle.membranes();
    let settings = Settings::default();
    let mut whole =
        Relaxation::new(membranes.clone(), positions.clone(), settings).expect("a start");
    let mut expected = Vec::new();
    let end = whole.run(&mut vesicle, |_, report| {
        expected.push(*report);
        true
    });
    assert_eq!(end.outcome, Some(Outcome::Converged));

    // Stored and taken up again after every single step, by a problem that remembers nothing.
    let mut parts = Relaxation::new(membranes.clone(), positions, settings).expect("a start");
    let mut reports: Vec<StepReport> = Vec::new();
    while reports.last().is_none_or(|report| report.outcome.is_none()) {
        let (mut vesicle, _) = Vesicle::new();
        reports.push(parts.step(&mut vesicle));
        let bytes = postcard::to_stdvec(parts.state()).expect("encodes");
        let state: State = postcard::from_bytes(&bytes).expect("decodes");
        parts = Relaxation::resume(membranes.clone(), state, settings).expect("a state");
    }
    assert_eq!(reports, expected);
    assert_eq!(parts.positions(), whole.positions());
    assert_eq!(parts.state(), whole.state());
}

#[test]
fn what_goes_wrong_is_said_and_the_last_good_positions_stay() {
    let (mut vesicle, positions) = Vesicle::new();
    vesicle.broken = Some(6);
    let mut relaxation =
        Relaxation::new(vesicle.membranes(), positions, Settings::default()).expect("a start");
    let end = relaxation.run(&mut vesicle, |_, _| true);
    let expected = Failure::NotFinite {
        membrane: 0,
        vertex: 7,
    };
    assert_eq!(end.outcome, Some(Outcome::Failed(expected)));
    assert!(end.iteration > 0 && end.energy.is_finite());
    vesicle.broken = None;
    let surface = Surface::new(&vesicle.mesh, relaxation.positions()).expect("finite");
    let energy = vesicle.bending.energy(surface);
    assert_eq!(energy, end.energy);
}

#[test]
fn targets_out_of_reach_are_said() {
    // More volume than a sphere of this area has.
    let (mut vesicle, positions) = Vesicle::of_reduced_volume(10.0);
    let mut relaxation =
        Relaxation::new(vesicle.membranes(), positions, Settings::default()).expect("a start");
    let outcome = relaxation.step(&mut vesicle).outcome;
    assert!(
        matches!(
            outcome,
            Some(Outcome::Failed(Failure::ConstraintsLost { .. }))
        ),
        "{outcome:?}"
    );
}

#[test]
fn settings_that_make_no_sense_are_refused() {
    let (vesicle, mut positions) = Vesicle::new();
    let mut membranes = vesicle.membranes();
    membranes[0].bending_modulus = 0.0;
    let refused = Relaxation::new(membranes, positions.clone(), Settings::default());
    assert!(matches!(
        refused.map(|_| ()),
        Err(SetupError::Modulus { membrane: 0, .. })
    ));
    positions.pop();
    let refused = Relaxation::new(vesicle.membranes(), positions, Settings::default());
    assert!(matches!(
        refused.map(|_| ()),
        Err(SetupError::CountMismatch {
            positions: 161,
            vertices: 162
        })
    ));
}
