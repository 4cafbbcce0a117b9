//! Equilibrium shapes by relaxation.

use helfrich::{
    AnyFunctional, Conservative, Constraint, Constraints, Energy, Force, GompperKroll, InPlane,
    Juelicher, LoopSubdivision, NeoHookean, Prepared, Projected, StrongForm, Surface, TriangleMesh,
};
use helfrich_std::dynamics::{
    Evaluation, Held, Membrane, Motion, Outcome, Problem, Relaxation, Settings, StepReport,
};
use helfrich_std::generate::{AnyShape, Family, GeneratedMesh, generate};
use helfrich_tests::tolerance::{self, Tolerance};
use std::f64::consts::PI;
use std::sync::Arc;

/// Rise of the energy in an accepted step of a relaxation, relative.
const ENERGY_RISE: Tolerance = Tolerance::new(
    1e-13,
    "thousands of terms of the same size, summed pairwise, round at about 1e-16 each",
);

/// Equilibrium energy of a method on 642 vertices against theory or another path, relative.
const COARSE_VESICLE_ENERGY: Tolerance = Tolerance::new(
    2e-2,
    "four times the error of 2562 vertices, less the part that methods share",
);

/// Area, volume and energy over G R² of an elastic sphere after its relaxation, relative.
const REGAINED: Tolerance = Tolerance::new(
    1e-6,
    "the residual of 1e-5 bounds the strain, in which the energy is quadratic",
);

/// Energies over 8πκ of the stationary axisymmetric vesicles of Seifert, Berndl and Lipowsky, Phys. Rev. A 44
/// (1991) 1182: (reduced volume, aspect ratio along over across the axis of a spheroid of that reduced
/// volume, energy).
const PROLATE_90: (f64, f64, f64) = (0.9, 1.962, 1.1896);
const PROLATE_80: (f64, f64, f64) = (0.8, 2.791, 1.3874);
const OBLATE_70: (f64, f64, f64) = (0.7, 0.325, 1.6991);
const OBLATE_90: (f64, f64, f64) = (0.9, 0.544, 1.2179);

/// Evaluation of a prepared method: sets the forces and returns the energy.
type Evaluate = Box<dyn FnMut(Surface<'_, f64>, &mut [[f64; 3]]) -> f64>;

fn conservative<M: Conservative<f64> + 'static>(method: M, mesh: &TriangleMesh) -> Evaluate {
    let mut prepared = Prepared::new(method, mesh);
    Box::new(move |surface, force| prepared.add_force_and_energy(surface, force))
}

fn without_energy<M: Force<f64> + Energy<f64> + 'static>(
    method: M,
    mesh: &TriangleMesh,
) -> Evaluate {
    let mut prepared = Prepared::new(Projected(method), mesh);
    Box::new(move |surface, force| {
        prepared.add_force(surface, force);
        prepared.energy(surface)
    })
}

struct Body {
    mesh: Arc<TriangleMesh>,
    evaluate: Evaluate,
    conservative: bool,
    held: Held,
}

impl Problem for Body {
    fn is_conservative(&self) -> bool {
        self.conservative
    }

    fn evaluate(&mut self, positions: &[[f64; 3]], force: &mut [[f64; 3]]) -> Evaluation {
        force.fill([0.0; 3]);
        let surface = Surface::new(&self.mesh, positions).expect("finite positions");
        Evaluation::new((self.evaluate)(surface, force))
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

/// Vesicle with its area and reduced volume, and its initial mesh.
struct Vesicle {
    start: GeneratedMesh,
    body: Body,
    area: f64,
    volume: f64,
}

impl Vesicle {
    fn new(
        (reduced_volume, aspect, _): (f64, f64, f64),
        vertices: usize,
        method: impl FnOnce(&TriangleMesh) -> (Evaluate, bool),
    ) -> Self {
        let shape: AnyShape = format!("ellipsoid:1,1,{aspect}").parse().expect("a shape");
        let start = generate(&shape, Family::Relaxed, vertices, 0).expect("a mesh");
        let mesh = Arc::new(start.mesh.clone());
        let area = Surface::new(&mesh, &start.positions).expect("fits").area();
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
        let (evaluate, conservative) = method(&mesh);
        let body = Body {
            held: Held::new(Arc::clone(&mesh), constraints),
            mesh,
            evaluate,
            conservative,
        };
        Self {
            start,
            body,
            area,
            volume,
        }
    }

    /// Relaxes, and checks the laws of every relaxation; returns the last report with the energy over 8πκ.
    fn relax(&mut self, settings: Settings) -> StepReport {
        self.relax_to(settings, Outcome::Converged)
    }

    /// Relaxes like [`Self::relax`] up to this outcome.
    fn relax_to(&mut self, settings: Settings, end: Outcome) -> StepReport {
        let membrane = Membrane {
            mesh: Arc::clone(&self.body.mesh),
            bending_modulus: 1.0,
            in_plane_modulus: 0.0,
            motion: Motion::AlongNormals,
            fixed: Vec::new(),
        };
        let positions = self.start.positions.clone();
        let mut relaxation =
            Relaxation::new(vec![membrane], positions, settings).expect("a vesicle");
        let mut before = f64::INFINITY;
        let conservative = self.body.conservative;
        let mesh = Arc::clone(&self.body.mesh);
        let (area, volume) = (self.area, self.volume);
        let mut report = relaxation.run(&mut self.body, |relaxation, report| {
            if conservative {
                let rise = report.energy - before;
                assert!(
                    rise <= ENERGY_RISE.value * report.energy,
                    "step {} raises the energy by {rise:e}",
                    report.iteration
                );
            }
            before = report.energy;
            let surface = Surface::new(&mesh, relaxation.positions()).expect("finite");
            let held = tolerance::HELD;
            held.assert(surface.area(), area, area, "area");
            held.assert(surface.volume().expect("closed"), volume, volume, "volume");
            true
        });
        report.energy /= 8.0 * PI;
        assert_eq!(report.outcome, Some(end), "{report:?}");
        report
    }
}

fn gompper_kroll(mesh: &TriangleMesh) -> (Evaluate, bool) {
    (conservative(GompperKroll::new(1.0), mesh), true)
}

#[test]
fn vesicles_have_the_energies_of_the_theory() {
    for vesicle in [PROLATE_90, PROLATE_80, OBLATE_70] {
        let report = Vesicle::new(vesicle, 2562, gompper_kroll).relax(Settings::default());
        tolerance::VESICLE_ENERGY.assert(report.energy, vesicle.2, vesicle.2, "method B");
        assert!(report.iteration < 150, "{report:?}");
    }
}

#[test]
fn other_methods_agree_within_their_error() {
    let assert = |found: f64, what: &str| {
        let expected = PROLATE_90.2;
        COARSE_VESICLE_ENERGY.assert(found, expected, expected, what);
    };
    let energy = |method: fn(&TriangleMesh) -> (Evaluate, bool)| {
        Vesicle::new(PROLATE_90, 642, method)
            .relax(Settings::default())
            .energy
    };
    let juelicher = energy(|mesh| (conservative(Juelicher::new(1.0), mesh), true));
    assert(juelicher, "Jülicher");
    let subdivision = energy(|mesh| (conservative(LoopSubdivision::new(1.0), mesh), true));
    assert(subdivision, "S");
    let meyer = energy(|mesh| (without_energy(StrongForm::meyer(1.0), mesh), false));
    assert(meyer, "C");
    let jets = energy(|mesh| (without_energy(StrongForm::j4(1.0), mesh), false));
    assert(jets, "J4");
}

/// A tolerance below the rounding of forces is never reached: the relaxation stops at rounding, and no
/// redistribution of vertices restarts it.
#[test]
fn relaxations_end_at_rounding() {
    let methods: [fn(&TriangleMesh) -> Evaluate; 2] = [
        |mesh| conservative(LoopSubdivision::new(1.0), mesh),
        |mesh| conservative(Juelicher::new(1.0), mesh),
    ];
    for method in methods {
        let settings = Settings {
            tolerance: 1e-14,
            ..Settings::default()
        };
        let mut vesicle = Vesicle::new(PROLATE_90, 642, |mesh| (method(mesh), true));
        let report = vesicle.relax_to(settings, Outcome::Stagnated);
        assert!(report.residual < 1e-9, "{report:?}");
        assert!(report.iteration < 1000, "{report:?}");
        let expected = PROLATE_90.2;
        COARSE_VESICLE_ENERGY.assert(report.energy, expected, expected, "at rest");
    }
}

#[test]
fn an_unstable_oblate_becomes_prolate() {
    let method = |mesh: &TriangleMesh| (conservative(Juelicher::new(1.0), mesh), true);
    let mut vesicle = Vesicle::new(OBLATE_90, 642, method);
    for [x, y, _] in &mut vesicle.start.positions {
        *x *= 1.01;
        *y *= 0.99;
    }
    let energy = vesicle.relax(Settings::default()).energy;
    let expected = PROLATE_90.2;
    COARSE_VESICLE_ENERGY.assert(energy, expected, expected, "prolate");
    // The energy is at least four times closer to the prolate branch than to the oblate one.
    assert!((OBLATE_90.2 - energy) > 4.0 * (energy - expected).abs());
}

#[test]
fn the_preconditioner_saves_most_of_the_steps() {
    let steps = |preconditioned| {
        let settings = Settings {
            preconditioned,
            ..Settings::default()
        };
        let mut vesicle = Vesicle::new(PROLATE_90, 642, gompper_kroll);
        let report = vesicle.relax(settings);
        (report.iteration, report.energy)
    };
    let ((few, with), (many, without)) = (steps(true), steps(false));
    assert!(4 * few < many, "{few} {many}");
    // The two relaxations take different paths to the same shape and end with different positions of the
    // vertices within the surface.
    COARSE_VESICLE_ENERGY.assert(with, without, without, "either way");
}

#[test]
fn an_elastic_sphere_regains_its_shape() {
    let shape: AnyShape = "sphere".parse().expect("a shape");
    let sphere = generate(&shape, Family::Regular, 642, 0).expect("a mesh");
    let mesh = Arc::new(sphere.mesh.clone());
    let surface = Surface::new(&mesh, &sphere.positions).expect("fits");
    let law = InPlane::new(NeoHookean { shear_modulus: 1.0 }, &mesh, surface).expect("a reference");
    let mut body = Body {
        evaluate: conservative(law, &mesh),
        conservative: true,
        held: Held::new(
            Arc::clone(&mesh),
            Constraints {
                constraints: Vec::new(),
            },
        ),
        mesh: Arc::clone(&mesh),
    };
    let stretch = |&[x, y, z]: &[f64; 3]| [1.3 * x + 0.2 * y * z, 0.9 * y, 0.8 * z + 0.1];
    let positions: Vec<[f64; 3]> = sphere.positions.iter().map(stretch).collect();
    let membrane = Membrane {
        mesh: Arc::clone(&mesh),
        bending_modulus: 0.0,
        in_plane_modulus: 3.0,
        motion: Motion::Free,
        fixed: Vec::new(),
    };
    let mut relaxation =
        Relaxation::new(vec![membrane], positions, Settings::default()).expect("a sphere");
    let report = relaxation.run(&mut body, |_, _| true);
    assert_eq!(report.outcome, Some(Outcome::Converged), "{report:?}");
    assert!(report.iteration < 100, "{report:?}");
    let relaxed = Surface::new(&mesh, relaxation.positions()).expect("finite");
    let what = |found: f64, expected: f64, what: &str| {
        REGAINED.assert(found, expected, expected, what);
    };
    what(relaxed.area(), surface.area(), "area");
    let volumes = [&relaxed, &surface].map(|s| s.volume().expect("closed"));
    what(volumes[0], volumes[1], "volume");
    assert!(report.energy < REGAINED.value, "{report:?}");
}
