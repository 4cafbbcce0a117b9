//! Capsules in shear flow: scenes run as users run them, compared with small-deformation theory, published
//! curves, and the independent computation of `capsules.csv`.

use crate::scenes::{PUBLISHED_CAPSULE, at, column, last, run_file, run_scene};
use helfrich_paper::flow::published;
use helfrich_paper::literature::{Computed, prototype};
use helfrich_std::deformation::first_plateau;
use helfrich_std::run::Summary;
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_std::series::SeriesTable;
use helfrich_tests::tolerance::CAPSULE_VOLUME;
use helfrich_tests::tolerance::Tolerance;
use std::path::Path;

/// D of the paper's capsule against the digitised curve: absolute, or 2 % if that is more.
const CAPSULE_TRANSIENT: Tolerance = Tolerance::new(
    3e-3,
    "the curve was digitised to 0.002, and 1280 triangles are off by 0.002 with method B",
);

/// D in steady states against the independent computation on the same mesh, absolute.
const CAPSULE_REFERENCE: Tolerance = Tolerance::new(5e-4, "the prototype's own uncertainty");

/// D of a stiff capsule by linearly implicit steps against stabilised ones, relative.
const CAPSULE_IMPLICIT: Tolerance = Tolerance::new(
    1e-3,
    "displacements are as large as D = 3.6e-3, and errors of a step are a few thousandths of them",
);

/// Inclination against the independent computation, relative.
const CAPSULE_INCLINATION: Tolerance =
    Tolerance::new(1e-2, "the reference is given to 0.1 degrees");

/// D with Loop subdivision on 320 triangles against the paper's, absolute.
const CAPSULE_SUBDIVISION: Tolerance =
    Tolerance::new(5e-4, "the error of elasticity and flow on so few triangles");

/// D at a capillary number of 0.005 against small-deformation theory, relative.
const CAPSULE_SLOPE: Tolerance = Tolerance::new(
    1e-2,
    "1280 triangles, and the next order of the capillary number, of half a percent each",
);

/// D of capsules whose viscosity differs from the fluid's, on 320 triangles, relative.
const CAPSULE_VISCOUS: Tolerance =
    Tolerance::new(4e-2, "four times the error of method B on 1280 triangles");

/// Symmetry of two capsules, in units of their radius.
const CAPSULE_PAIR: Tolerance = Tolerance::new(
    1e-3,
    "the meshes are not images of each other, so that their discretisation errors differ",
);

/// Growth of 1/D with the viscosity of the membrane, relative.
const CAPSULE_MEMBRANE: Tolerance = Tolerance::new(
    5e-2,
    "elasticity contributes a few percent of the resistance to the largest deformation",
);

/// The same against theory on 42 vertices, relative.
const CAPSULE_COARSE: Tolerance = Tolerance::new(
    0.2,
    "the edges of 80 triangles are 0.6 radii long: half of their square",
);

/// Speed of a falling capsule, relative.
const CAPSULE_FALL: Tolerance = Tolerance::new(
    1e-2,
    "the drag on 1280 triangles is off by 0.4 %, and the membrane deforms by a hundredth",
);

/// Runs the shipped capsule in shear flow without its slice of the flow, which takes a third of the time.
fn sheared(overrides: &[&str]) -> (Summary, SeriesTable) {
    let overrides = [overrides, &["output.slice="]].concat();
    run_scene("capsule-shear.toml", &overrides)
}

/// The paper's own case: D(t) agrees with the published curve, the steady state with that of the prototype on
/// the same number of triangles, and the volume is kept.
#[test]
fn the_capsule_of_the_paper_deforms_as_published() {
    let (summary, series) = &*PUBLISHED_CAPSULE;
    let curve = &published()[0];
    assert_eq!(curve.points.len(), 10);
    for &[strain, value] in &curve.points {
        if strain > 4.0 {
            continue;
        }
        let found = at(series, strain);
        let allowed = (0.02 * value).max(CAPSULE_TRANSIENT.value) / CAPSULE_TRANSIENT.value;
        CAPSULE_TRANSIENT.assert(found, value, allowed, &format!("D at γ̇t = {strain}"));
    }
    let Computed {
        deformations: [expected, ..],
        inclination: angle,
        ..
    } = prototype()[0];
    let deformation = last(series, "deformation");
    CAPSULE_REFERENCE.assert(deformation, expected, 1.0, "D of B on 1280 triangles");
    let inclination = last(series, "inclination");
    CAPSULE_INCLINATION.assert(inclination, angle, angle, "inclination");
    let volumes = column(series, "volume");
    for &volume in &volumes {
        CAPSULE_VOLUME.assert(volume, volumes[0], volumes[0], "volume");
    }
    assert!(summary.right_hand_sides.is_some_and(|count| count > 100));
    // The material circulates once in about γ̇t = 14.
    let turns = last(series, "tank_treading_turns");
    assert!((0.2..0.4).contains(&turns), "{turns} turns");
}

/// D and inclination in the steady state agree with the independent computation on 1280 triangles, for all of its
/// sets of parameters but that of the paper.
#[test]
fn steady_deformations_are_those_of_an_independent_computation() {
    let computed = prototype();
    assert_eq!(computed.len(), 5);
    for Computed {
        law,
        capillary,
        bending: modulus,
        deformations: [expected, ..],
        inclination,
    } in &computed[1..]
    {
        let bending = match *modulus {
            0.0 => "bending=".to_owned(),
            modulus => format!("bending.modulus={modulus}"),
        };
        let bending = format!("surface.capsule.{bending}");
        let rate = format!("driver.flow.rate={capillary}");
        let law_set = format!("surface.capsule.elasticity.law={law}");
        // From here to γ̇t = 10, D changes by less than 2e-4.
        let strain = match law.as_str() {
            "neo-hookean" if *capillary > 0.5 => "driver.strain=9",
            _ => "driver.strain=7",
        };
        // Only the last row is looked at: steps need not end at others.
        let interval = "output.strain_interval=3.5";
        let mut overrides = vec![bending.as_str(), &rate, &law_set, strain, interval];
        if law == "skalak" {
            overrides.push("surface.capsule.elasticity.area_ratio=1");
        }
        let (_, series) = sheared(&overrides);
        let what = format!("{law}, {rate}, {bending}");
        CAPSULE_REFERENCE.assert(last(&series, "deformation"), *expected, 1.0, &what);
        let found = last(&series, "inclination");
        CAPSULE_INCLINATION.assert(found, *inclination, *inclination, &what);
    }
}

/// Where bending relaxes much faster than the flow deforms, with κ = a²G and Ca = 0.02, linearly implicit
/// steps give the same deformations as stabilised steps with less than a tenth of the evaluations that an
/// explicit scheme needs.
#[test]
fn stiff_capsules_need_few_linearly_implicit_steps() {
    let found = |integrator: &str, tolerance: &str, strain: f64| {
        let integrator = format!("driver.integrator={integrator}");
        let tolerance = format!("driver.tolerance={tolerance}");
        let strain = format!("driver.strain={strain}");
        let overrides = [
            "surface.capsule.vertices=162",
            "surface.capsule.bending.modulus=1",
            "driver.flow.rate=0.02",
            &strain,
            "output.strain_interval=0.25",
            &integrator,
            &tolerance,
        ];
        let (_, series) = sheared(&overrides);
        let evaluations = last(&series, "right_hand_sides");
        (column(&series, "deformation"), evaluations)
    };
    let (expected, _) = found("rkc2", "1e-5", 1.0);
    // Stability limits explicit steps from the start: all quarters need as many.
    let explicit = 4.0 * found("bs23", "1e-4", 0.25).1;
    let (deformation, implicit) = found("rosenbrock", "1e-4", 1.0);
    println!("{implicit} instead of {explicit} evaluations");
    for (found, expected) in deformation.iter().zip(&expected).skip(1) {
        CAPSULE_IMPLICIT.assert(*found, *expected, *expected, "D");
    }
    assert!(10.0 * implicit < explicit, "{implicit} of {explicit}");
}

/// Loop subdivision agrees with the paper's method S on a quarter of the triangles.
#[test]
fn loop_subdivision_needs_few_triangles() {
    let overrides = [
        "surface.capsule.bending.method=loop",
        "surface.capsule.family=smooth",
        "surface.capsule.vertices=162",
        "output.strain_interval=1",
    ];
    let (_, series) = sheared(&overrides);
    let deformation = last(&series, "deformation");
    CAPSULE_SUBDIVISION.assert(deformation, 0.1334, 1.0, "D of S on 320 triangles");
}

/// D at its first plateau agrees with theory for both laws, and for viscosity ratios 1 and 5, on which the
/// limit does not depend: Barthès-Biesel and Rallison, J. Fluid Mech. 113 (1981) 251, with bending as in
/// Barthès-Biesel, Diaz and Dhenin, J. Fluid Mech. 460 (2002) 211.
#[test]
fn small_deformations_follow_theory() {
    let capillary = 0.005;
    for (law, bending, ratio, strain) in [
        ("neo-hookean", 0.0375, 1.0, 0.2),
        ("skalak", 0.0375, 1.0, 0.2),
        ("neo-hookean", 0.0375, 5.0, 0.45),
    ] {
        let area_ratio = 1.0;
        let theory = match law {
            "skalak" => {
                1.25 * (2.0 + 3.0 * area_ratio) * capillary
                    / (1.0 + 2.0 * area_ratio + (15.0 + 18.0 * area_ratio) * bending)
            }
            _ => 25.0 / 12.0 * capillary / (1.0 + 11.0 * bending),
        };
        // The case of ratio 5 takes ten times as long, so its mesh is coarser.
        let vertices = if ratio == 1.0 { 642 } else { 162 };
        let mut overrides = vec![
            format!("driver.flow.rate={capillary}"),
            format!("driver.strain={strain}"),
            format!("output.strain_interval={}", strain / 50.0),
            format!("surface.capsule.elasticity.law={law}"),
            format!("surface.capsule.bending.modulus={bending}"),
            format!("surface.capsule.viscosity_ratio={ratio}"),
            format!("surface.capsule.vertices={vertices}"),
        ];
        if law == "skalak" {
            overrides.push(format!(
                "surface.capsule.elasticity.area_ratio={area_ratio}"
            ));
        }
        let overrides = Vec::from_iter(overrides.iter().map(String::as_str));
        let (_, series) = sheared(&overrides);
        let (strains, values) = (column(&series, "strain"), column(&series, "deformation"));
        let plateau = first_plateau(&strains, &values, 2e-3).map_or(f64::NAN, |at| at.value);
        let tolerance = if ratio == 1.0 {
            CAPSULE_SLOPE
        } else {
            CAPSULE_VISCOUS
        };
        let what = format!("D of {law}, viscosity ratio {ratio}");
        tolerance.assert(plateau, theory, theory, &what);
    }
}

/// Two capsules that are images of each other under a half turn stay so.
#[test]
fn a_pair_stays_symmetric_and_apart() {
    let overrides = [
        "surface.left.vertices=162",
        "surface.right.vertices=162",
        "surface.left.position=[-1.5, 0.25, 0]",
        "surface.right.position=[1.5, -0.25, 0]",
        "driver.strain=6",
        "output.strain_interval=1",
    ];
    let (_, series) = run_scene("capsule-pair.toml", &overrides);
    for axis in ["x", "y", "z"] {
        let [left, right] =
            ["left", "right"].map(|name| column(&series, &format!("centroid_{axis}_{name}")));
        for (left, right) in left.iter().zip(&right) {
            CAPSULE_PAIR.assert(left + right, 0.0, 1.0, &format!("centre along {axis}"));
        }
    }
    let heights = column(&series, "centroid_y_left");
    let highest = heights.iter().fold(0.0, |a: f64, &b| a.max(b));
    assert!(highest > 0.6, "the left capsule rises only to {highest}");
}

/// The shipped cell, on a coarse mesh, tilts past the direction of the flow and on against the gradient
/// without coming to rest.
#[test]
fn a_red_blood_cell_tumbles() {
    let overrides = [
        "surface.cell.vertices=162",
        "surface.cell.bending.method=gompper-kroll",
        "driver.strain=4",
    ];
    let (summary, series) = run_scene("red-blood-cell-shear.toml", &overrides);
    assert_eq!(summary.warnings, [""; 0]);
    let inclinations = column(&series, "inclination");
    let inclination = last(&series, "inclination");
    assert!((-90.0..-45.0).contains(&inclination), "{inclination}°");
    // Cells that tread like tanks come to rest at an angle above 0.
    assert!(
        inclinations.is_sorted_by(|before, after| after < before),
        "{inclinations:?}"
    );
    let volumes = column(&series, "volume");
    for &volume in &volumes {
        CAPSULE_VOLUME.assert(volume, volumes[0], volumes[0], "volume");
    }
}

/// Fluid and membrane resist in parallel: the resistance to a small deformation, 1/D after a short time,
/// grows in proportion to the membrane's viscosity.
#[test]
fn a_viscous_membrane_deforms_more_slowly() {
    let deformation = |viscosity: f64| {
        let viscosity = format!(
            "surface.capsule.membrane_viscosity={{ shear = {viscosity}, dilational = {viscosity} }}"
        );
        let overrides = [
            "surface.capsule.vertices=42",
            "driver.strain=0.05",
            "output.strain_interval=0.05",
            &viscosity,
        ];
        let (_, series) = sheared(&overrides);
        assert!(last(&series, "products") > 0.0, "velocities are solved for");
        last(&series, "deformation")
    };
    let [low, middle, high] = [20.0, 40.0, 80.0].map(|viscosity| deformation(viscosity).recip());
    let growth = (high - middle) / (middle - low);
    CAPSULE_MEMBRANE.assert(growth, 2.0, 2.0, "growth of 1/D");
    // The rate of strain of a viscous membrane, as in `immersed.rs`, without elasticity.
    let rate = |b: f64| (175.0 + 160.0 * b) / (175.0 + 210.0 * b + 32.0 * b * b);
    let expected = (rate(80.0).recip() - rate(40.0).recip()) / 0.025_f64.sin();
    CAPSULE_COARSE.assert(high - middle, expected, expected, "growth of 1/D");
}

/// A heavy sphere with a stiff membrane falls as a rigid one: `U = 2/9 Δρ g a²/μ` (Stokes 1851).
#[test]
fn a_heavy_capsule_falls_as_stokes_has_it() {
    let text = r#"
        units = "none"
        [[surface]]
        shape = "sphere:1"
        family = "regular"
        vertices = 642
        match_volume = true
        elasticity = { law = "neo-hookean", shear_modulus = 20 }
        gravity = { density_difference = 0.5, acceleration = [0, 0, -2] }
        [driver]
        kind = "boundary-integral"
        viscosity = 1
        duration = 1
        [output]
        interval = 0.25
        surfaces = false
        pictures = false
    "#;
    let file = SceneFile::parse(text, Path::new("falling.toml"), &Overrides::default());
    let (_, series) = run_file(file.unwrap_or_else(|errors| panic!("{errors}")));
    let heights = column(&series, "centroid_z");
    let speed = (heights[3] - heights[4]) / 0.25;
    CAPSULE_FALL.assert(speed, 2.0 / 9.0, 2.0 / 9.0, "speed");
}
