//! The study of a capsule in flow: its cases, and evaluations of its rows.

use helfrich_std::method::BendingMethod;
use helfrich_std::run::End;
use helfrich_std::scalar::Scalar;
use helfrich_studies::flow::{
    BENDING, FlowCase, FlowRow, FlowStudy, Solver, boxes, largest_deviation, published, resolved,
};
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
            bending: BENDING,
            vertices: 642,
        },
        end: End::Completed,
        message: String::new(),
        deformation,
        inclination: 37.0,
        volume_change: 0.0,
        transient: vec![[0.0, 0.0], [1.0, 0.1316], [6.0, 0.1334]],
        steps: 1,
        seconds: 1.0,
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
    let deviation = largest_deviation(&row(6.0, 7.0, 0.1334), &curves[0]).expect("points");
    // At γ̇t = 0.302, linear interpolation of the run gives 0.0397, and the curve has 0.0926.
    SERIES_EXTRAPOLATION.assert(deviation, 0.0926 - 0.302 * 0.1316, 0.05, "deviation");
    let mut early = row(6.0, 7.0, 0.1);
    early.transient.clear();
    assert_eq!(largest_deviation(&early, &curves[0]), None);
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
