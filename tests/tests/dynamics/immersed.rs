//! Capsules in the fluid of a lattice, beside the same capsules in boundary integrals.

use crate::scenes::{column, last, run_scene, scenes};
use helfrich_std::flow::Channel;
use helfrich_std::flow_study::{
    BENDING, FlowCase, FlowRow, FlowStudy, Solver, boxes, largest_deviation, published, resolved,
};
use helfrich_std::method::BendingMethod;
use helfrich_std::run::{End, run};
use helfrich_std::scalar::Scalar;
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_std::simulation::build;
use helfrich_tests::tolerance::{
    CAPSULE_VOLUME, CHANNEL_SERIES, IMMERSED_COARSE, IMMERSED_PROBE, IMMERSED_SINGLE,
    SERIES_EXTRAPOLATION,
};
use std::fs;
use tempfile::TempDir;

/// Four nodes a radius, in a cube of five.
const COARSE: [&str; 4] = [
    "driver.resolution=4",
    "driver.box=[5, 5, 5]",
    "driver.strain=2",
    "output.slice=",
];

fn with<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&COARSE, more].concat()
}

/// D(L) − D(∞) is 1.5 (a/L)³, and membranes are thicker by a share of the distance of nodes: what is
/// left is of the order of 10 % on so coarse a lattice. Both solvers have nothing in common.
#[test]
fn a_capsule_deforms_as_by_boundary_integrals() {
    for ratio in ["surface.0.viscosity_ratio=1", "surface.0.viscosity_ratio=5"] {
        let (summary, series) = run_scene("capsule-shear-lattice.toml", &with(&[ratio]));
        let strain = ["driver.strain=2", "output.slice=", ratio];
        let (_, exact) = run_scene("capsule-shear.toml", &strain);
        let expected = last(&exact, "deformation");
        let found = last(&series, "deformation") - 1.5 * 5.0_f64.powi(-3);
        IMMERSED_COARSE.assert(found, expected, expected, ratio);
        let volumes = column(&series, "volume");
        for &volume in &volumes {
            CAPSULE_VOLUME.assert(volume, volumes[0], volumes[0], "volume");
        }
        // A capsule in the middle stays there.
        assert!(last(&series, "centroid_y").abs() < 1e-9);
        let note = &summary.warnings;
        assert!(
            note.iter()
                .any(|note| note.contains("nothing is corrected"))
        );
    }
}

/// Fluid that resists more inside makes the capsule follow later.
#[test]
fn a_viscous_content_slows_a_capsule_down() {
    let deformation = |ratio: &str| {
        let early = ["driver.strain=0.5", ratio];
        let (_, series) = run_scene("capsule-shear-lattice.toml", &with(&early));
        last(&series, "deformation")
    };
    let [thin, same, thick] = [
        "surface.0.viscosity_ratio=0.2",
        "surface.0.viscosity_ratio=1",
        "surface.0.viscosity_ratio=5",
    ]
    .map(deformation);
    assert!(
        thin > 1.05 * same && same > 1.2 * thick,
        "{thin} {same} {thick}"
    );
}

/// The same scene in both number types, and with each kernel.
#[test]
fn number_types_and_kernels_agree() {
    let deformation = |more: &str| {
        let (_, series) = run_scene("capsule-shear-lattice.toml", &with(&[more]));
        last(&series, "deformation")
    };
    let double = deformation("driver.precision=f64");
    let single = deformation("driver.precision=f32");
    IMMERSED_SINGLE.assert(single, double, double, "f32");
    assert!(single != double, "the number type is heeded");
    for kernel in ["driver.kernel=three", "driver.kernel=four"] {
        let found = deformation(kernel);
        IMMERSED_COARSE.assert(found, double, double, kernel);
        assert!(found != double, "the kernel is heeded");
    }
}

/// With inertia the same capsule deforms more, as in the literature at Re of order 1.
#[test]
fn inertia_is_there_if_there_is_a_density() {
    let deformation = |more: &[&str]| {
        let (_, series) = run_scene("capsule-shear-lattice.toml", &with(more));
        last(&series, "deformation")
    };
    let without = deformation(&[]);
    // Re = ργ̇a²/μ of 0.01 and 1.
    let slow = deformation(&["driver.density=0.0667"]);
    let fast = deformation(&["driver.density=6.67"]);
    IMMERSED_COARSE.assert(slow, without, without, "nearly none");
    assert!(fast > 1.02 * without, "{fast} {without}");
}

/// A channel, a capsule far too small to matter, and probes: one in the middle, one half-way to the
/// wall.
#[test]
fn probes_see_the_flow_of_a_channel() {
    let scene = r#"
units = "none"

[[surface]]
name = "grain"
shape = "sphere:0.4"
family = "regular"
vertices = 162
position = [0, 2.5, 0]
elasticity = { law = "skalak", shear_modulus = 10, area_ratio = 1 }

[driver]
kind = "lattice-boltzmann"
viscosity = 2
flow = { kind = "channel", centre_velocity = 3 }
spacing = 0.25
box = [6, 8, 6]
duration = 0.05

[output]
interval = 0.05
pictures = false
surfaces = false
probe = [
    { name = "middle", point = [-2, 0, 0] },
    { name = "between", point = [-2, -2, 1] },
]
volume = [{ name = "all", stride = 3 }]
"#;
    let folder = TempDir::new().expect("a folder");
    let path = folder.path().join("channel.toml");
    let file = SceneFile::parse(scene, &path, &Overrides::default());
    let file = file.unwrap_or_else(|errors| panic!("{errors}"));
    let out = folder.path().join("out");
    let built = build(&file).expect("a simulation");
    let summary = run(&file.scene, built, &out, false, &|| false, &mut |_| {});
    let summary = summary.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(summary.end, End::Completed, "{}", summary.message);
    let number = |name: &str| {
        let found = summary.last.iter().find(|(column, _)| column == name);
        found.unwrap_or_else(|| panic!("no column {name}")).1
    };
    IMMERSED_PROBE.assert(number("middle_x"), 3.0, 3.0, "in the middle");
    IMMERSED_PROBE.assert(number("between_x"), 3.0 * 0.75, 3.0, "half-way to the wall");
    IMMERSED_PROBE.assert(number("middle_y"), 0.0, 3.0, "across");
    let volume = fs::read_to_string(out.join("volumes/all-00000001.vti")).expect("a volume");
    // 24 × 32 × 24 nodes, every third.
    assert!(
        volume.contains("WholeExtent=\"0 7 0 10 0 7\""),
        "{}",
        &volume[..400]
    );
    let index = fs::read_to_string(out.join("volumes.pvd")).expect("an index");
    assert!(index.contains("volumes/all-00000001.vti"), "{index}");
}

/// Forces too stiff for the step end a run with the reason, and leave what there was.
#[test]
fn steps_that_are_too_long_end_a_run() {
    let overrides = with(&[
        "driver.step=0.2",
        "output.pictures=false",
        "output.surfaces=false",
    ]);
    let overrides = Overrides::new(overrides).expect("overrides");
    let scene = scenes().join("capsule-shear-lattice.toml");
    let file = SceneFile::read(&scene, &overrides).unwrap_or_else(|errors| panic!("{errors}"));
    let folder = TempDir::new().expect("a folder");
    let out = folder.path().join("out");
    let built = build(&file).expect("a simulation");
    let summary = run(&file.scene, built, &out, false, &|| false, &mut |_| {}).expect("a run");
    assert_eq!(summary.end, End::Failed);
    assert!(
        summary.message.contains("a shorter one is needed"),
        "{}",
        summary.message
    );
    assert!(out.join("checkpoint").exists());
}

/// Ducts obey the equation of twisted bars, whose torsion constant is four times the integral of u μ/g:
/// 0.1406 H⁴ of a square, S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, section 109. Between
/// plates the middle has an eighth of H².
#[test]
fn channels_flow_as_their_series() {
    let plates = Channel {
        width: 2.0,
        depth: None,
    };
    CHANNEL_SERIES.assert(plates.response(0.0, 9.0), 0.5, 0.5, "plates");
    let square = Channel {
        width: 2.0,
        depth: Some(2.0),
    };
    let middle = |index: i32| (f64::from(index) + 0.5) / 32.0 - 1.0;
    let cells = (0..64).flat_map(|i| (0..64).map(move |j| (i, j)));
    let integral: f64 = cells
        .map(|(i, j)| square.response(middle(i), middle(j)))
        .sum();
    let expected = 16.0 * 0.1406 / 4.0;
    CHANNEL_SERIES.assert(integral / 1024.0, expected, expected, "a square");
    // The walls, all alike.
    for [y, z] in [[1.0, 0.3], [-1.0, 0.9], [0.3, 1.0], [0.7, -1.0]] {
        CHANNEL_SERIES.assert(square.response(y, z), 0.0, 0.3, "on a wall");
    }
    CHANNEL_SERIES.assert(
        square.response(0.2, 0.6),
        square.response(0.6, 0.2),
        0.3,
        "turned",
    );
    let flat = Channel {
        width: 2.0,
        depth: Some(40.0),
    };
    CHANNEL_SERIES.assert(
        flat.response(0.5, 1.0),
        plates.response(0.5, 1.0),
        0.5,
        "flat",
    );
}

fn row(resolution: f64, size: f64, deformation: f64) -> FlowRow {
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

/// Numbers that obey the laws by which boxes and resolutions are taken out are taken apart exactly.
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

/// The paper's curve comes first, and runs are judged at its points as far as they go.
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
    // At γ̇t = 0.302 the straight line from 0 to 1 is at 0.0397 instead of 0.0926.
    SERIES_EXTRAPOLATION.assert(deviation, 0.0926 - 0.302 * 0.1316, 0.05, "deviation");
    let mut early = row(6.0, 7.0, 0.1);
    early.transient.clear();
    assert_eq!(largest_deviation(&early, &curves[0]), None);
}

/// Every method by both solvers, two resolutions and two boxes with much and little bending, both
/// number types: and none twice.
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
