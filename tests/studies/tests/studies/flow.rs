//! Capsules in flow: their cases, and evaluations of their rows.

use helfrich_paper::flow::{
    BENDING, CAPILLARY_NUMBER, FlowCase, FlowOutcome, FlowRow, FlowStudy, Solver, boxes, deviation,
    published, resolved,
};
use helfrich_std::method::BendingMethod;
use helfrich_std::plots::PublishedCurve;
use helfrich_std::run::End;
use helfrich_std::scalar::Scalar;
use helfrich_tests::tolerance::Tolerance;

/// Extrapolations of exact laws, relative.
const SERIES_EXTRAPOLATION: Tolerance = Tolerance::new(
    1e-10,
    "differences of numbers that differ in the third digit",
);

pub(crate) fn row(resolution: f64, size: f64, deformation: f64) -> FlowRow {
    FlowRow {
        case: FlowCase {
            solver: Solver::LatticeBoltzmann {
                resolution,
                size,
                precision: Scalar::F64,
            },
            method: BendingMethod::GompperKroll,
            capillary: CAPILLARY_NUMBER,
            bending: BENDING,
            vertices: 642,
            strain: 6.0,
        },
        outcome: FlowOutcome {
            end: End::Completed,
            message: String::new(),
            deformation,
            inclination: 37.0,
            volume_change: 0.0,
            transient: vec![[0.0, 0.0], [1.0, 0.1316], [6.0, 0.1334]],
            inclinations: vec![[0.0, 45.0], [1.0, 38.0], [6.0, 37.0]],
            steps: 1,
            seconds: 1.0,
        },
    }
}

/// If D obeys the assumed laws of box size and resolution, extrapolation is exact.
#[test]
fn boxes_and_lattices_are_taken_out() {
    let law = |resolution: f64, size: f64| {
        let deformation = 0.13 + 0.05 / resolution + (1.0 + resolution) * size.powi(-3);
        row(resolution, size, deformation)
    };
    let rows = [
        law(6.0, 10.0),
        law(4.0, 7.0),
        law(6.0, 7.0),
        law(4.0, 10.0),
        law(6.0, 14.0),
    ];
    let boxes = boxes(&rows);
    let sizes = Vec::from_iter(boxes.iter().map(|found| (found.resolution, found.sizes)));
    let expected = [(6.0, [10.0, 14.0]), (4.0, [7.0, 10.0]), (6.0, [7.0, 10.0])];
    assert_eq!(sizes, expected);
    for found in &boxes {
        let coefficient = 1.0 + found.resolution;
        SERIES_EXTRAPOLATION.assert(found.coefficient, coefficient, coefficient, "c");
        let unbounded = 0.13 + 0.05 / found.resolution;
        SERIES_EXTRAPOLATION.assert(found.unbounded, unbounded, unbounded, "D(∞)");
    }
    let resolved = resolved(&boxes);
    assert_eq!(resolved.len(), 1);
    assert_eq!(resolved[0].resolutions, [4.0, 6.0]);
    SERIES_EXTRAPOLATION.assert(resolved[0].resolved, 0.13, 0.13, "D");
}

/// The paper's curve comes first, and runs are compared at its points as far as they go.
#[test]
fn runs_are_compared_with_what_was_published() {
    let curves = published();
    assert!(
        curves[0].name.contains("Guckenberger"),
        "{}",
        curves[0].name
    );
    assert_eq!(curves.len(), 6);
    let found = deviation(&row(6.0, 7.0, 0.1334), &curves[0]).expect("points");
    // At γ̇t = 0.302, linear interpolation of the run gives 0.0397, and the curve has 0.0926.
    let expected = 0.302 * 0.1316 - 0.0926;
    SERIES_EXTRAPOLATION.assert(found.largest, expected, 0.05, "largest difference");
    let at = [found.at, found.last_at];
    assert_eq!(at, [0.302, 5.0]);
    // The slope there is 0.1316.
    let shift = -expected / 0.1316;
    SERIES_EXTRAPOLATION.assert(found.shift, shift, shift, "shift of γ̇t");
    let mut early = row(6.0, 7.0, 0.1);
    early.outcome.transient.clear();
    assert_eq!(deviation(&early, &curves[0]), None);
}

/// A run that differs from a curve by a known amount has this deviation, with its sign, at the points that it reaches.
#[test]
fn a_known_deviation_is_found() {
    let curve = PublishedCurve {
        name: "a line".to_owned(),
        points: vec![[0.5, 0.05], [1.5, 0.15], [2.5, 0.25], [9.0, 0.9]],
    };
    let mut run = row(6.0, 7.0, 0.3);
    // The line, a tenth lower at first, and 0.004 higher at the end.
    run.outcome.transient = vec![[0.0, 0.0], [1.0, 0.09], [2.0, 0.204], [3.0, 0.304]];
    let found = deviation(&run, &curve).expect("points");
    for (what, found, expected) in [
        ("largest", found.largest, -0.005),
        ("at", found.at, 0.5),
        ("shift", found.shift, 0.005 / 0.09),
        ("last", found.last, 0.004),
        ("last at", found.last_at, 2.5),
    ] {
        SERIES_EXTRAPOLATION.assert(found, expected, 1.0, what);
    }
}

/// The cases comprise every method with both solvers, two resolutions and two boxes with much and little
/// bending, and both number types, without repetition.
#[test]
fn a_study_of_flow_has_all_cases() {
    let study = FlowStudy::default();
    let cases = study.cases();
    for (number, case) in cases.iter().enumerate() {
        assert!(!cases[..number].contains(case), "{case} twice");
    }
    for &method in &study.methods {
        let of = |case: &&FlowCase| case.method == method && case.bending == BENDING;
        let exact = |case: &FlowCase| case.solver == Solver::BoundaryIntegral;
        let own = Vec::from_iter(cases.iter().filter(of));
        assert!(own.iter().any(|case| exact(case)) && own.iter().any(|case| !exact(case)));
    }
    let lattices = cases.iter().filter(|case| {
        case.method == BendingMethod::GompperKroll && case.solver != Solver::BoundaryIntegral
    });
    assert_eq!(lattices.count(), 2 * (4 + 1));
}
