//! Vesicles that relax, against the axisymmetric theory, and the stability of what they relax to.

use crate::scenes::scenes;
use helfrich_std::dynamics::Mode;
use helfrich_std::report::run_table;
use helfrich_std::run::{End, Summary, run, stability};
use helfrich_std::scene::{Overrides, SceneErrors, SceneFile};
use helfrich_std::simulation::build;
use helfrich_tests::axisymmetric::{Branch, Vesicle};
use helfrich_tests::tolerance::Tolerance;
use std::f64::consts::PI;
use std::path::Path;
use tempfile::TempDir;

/// Energies of Jülicher's method on 2562 vertices, relative.
const JUELICHER: Tolerance = Tolerance::new(
    1.5e-3,
    "second order: the area and volume that are held are those of the polyhedron",
);

/// The same of S, whose area and volume are those of the polyhedron of its limit points, too.
const LOOP: Tolerance = Tolerance::new(
    3e-3,
    "second order, and larger on long shapes, the triangles of which are stretched",
);

/// Energies of Galerkin's method on 2562 vertices, relative.
const PATCHES: Tolerance = Tolerance::new(
    1e-4,
    "high order: the patches of the rim and of the neck, where radii are five edges, decide",
);

/// Energies that are corrected for the curved surface, relative, where 2562 vertices resolve the shape.
const ESTIMATE: Tolerance = Tolerance::new(
    1.5e-3,
    "fourth order in edges over the radius of the rim, where they are a fifth of it",
);

/// The spheroid of area 4π and a reduced volume.
fn spheroid(branch: Branch, reduced_volume: f64) -> String {
    let semi_axes = |ratio: f64| {
        let eccentricity = (1.0 - ratio.min(1.0 / ratio).powi(2)).sqrt();
        let side = match branch {
            Branch::Prolate => ratio * eccentricity.asin() / eccentricity,
            _ => ratio * ratio * eccentricity.atanh() / eccentricity,
        };
        let scale = (2.0 / (1.0 + side)).sqrt();
        [scale, scale * ratio]
    };
    let (mut rounder, mut longer) = match branch {
        Branch::Prolate => (1.001_f64, 20.0_f64),
        _ => (0.999, 0.05),
    };
    for _ in 0..60 {
        let ratio = (rounder * longer).sqrt();
        let [across, along] = semi_axes(ratio);
        if across * across * along > reduced_volume {
            rounder = ratio;
        } else {
            longer = ratio;
        }
    }
    let [across, along] = semi_axes(rounder);
    format!("ellipsoid:{across},{across},{along}")
}

/// The scene of a vesicle, and other changes.
fn scene(branch: Branch, reduced_volume: f64, changes: &[&str]) -> Result<SceneFile, SceneErrors> {
    let own = [
        format!("surface.0.shape={}", spheroid(branch, reduced_volume)),
        format!("surface.0.volume.reduced={reduced_volume}"),
        "output.pictures=false".to_owned(),
        "output.surfaces=false".to_owned(),
    ];
    let changes = own
        .iter()
        .map(String::as_str)
        .chain(changes.iter().copied());
    let overrides = Overrides::new(changes).expect("overrides");
    SceneFile::read(&scenes().join("vesicle-prolate-0.9.toml"), &overrides)
}

fn relax_in(file: &SceneFile, folder: &Path, resume: bool) -> Summary {
    let built = build(file).expect("a simulation");
    let summary = run(&file.scene, built, folder, resume, &|| false, &mut |_| {});
    summary.unwrap_or_else(|error| panic!("{error}"))
}

fn relax(branch: Branch, reduced_volume: f64, changes: &[&str]) -> Summary {
    let folder = TempDir::new().expect("a folder");
    let file = scene(branch, reduced_volume, changes);
    let file = file.unwrap_or_else(|errors| panic!("{errors}"));
    relax_in(&file, &folder.path().join("out"), false)
}

fn energy(summary: &Summary) -> f64 {
    let energy = summary.last.iter().find(|(name, _)| name == "energy");
    energy.expect("a column").1
}

/// Relaxes with a method, and compares its energy and the corrected one with theory.
fn compare(branch: Branch, reduced_volume: f64, method: &str, bounds: [Tolerance; 2]) {
    let theory = Vesicle::new(branch, reduced_volume, 32);
    let theory = 8.0 * PI * theory.unwrap_or_else(|error| panic!("{error}")).energy();
    let method = format!("surface.0.bending.method={method}");
    let summary = relax(branch, reduced_volume, &[&method]);
    let what = format!("{branch:?} {reduced_volume} {method}");
    assert_eq!(summary.end, End::Converged, "{what}: {}", summary.message);
    let energy = energy(&summary);
    let estimate = summary.energy_estimates[0].estimate;
    bounds[0].assert(energy, theory, theory, &what);
    bounds[1].assert(estimate, theory, theory, &format!("{what}, corrected"));
}

#[test]
fn vesicles_have_the_energies_of_the_axisymmetric_theory() {
    let smooth = Tolerance::new(1.5e-4, "as below, at radii of ten edges");
    let even = Tolerance::new(5e-4, "second order, at radii of ten edges");
    compare(Branch::Prolate, 0.9, "juelicher", [even, smooth]);
    compare(Branch::Prolate, 0.9, "loop", [even, smooth]);
    compare(Branch::Oblate, 0.651, "juelicher", [JUELICHER, ESTIMATE]);
}

/// Energies of patches, whose area and volume are held, too; those of flat triangles would change them by 1.5e-3.
#[test]
fn a_coarse_vesicle_of_patches_has_the_energy_of_the_axisymmetric_theory() {
    let theory = Vesicle::new(Branch::Prolate, 0.9, 32);
    let theory = 8.0 * PI * theory.unwrap_or_else(|error| panic!("{error}")).energy();
    let changes = [
        "surface.0.bending.method=galerkin",
        "surface.0.vertices=642",
        "driver.energy_error=0.1",
        // The energy is stationary: what is left of the forces enters squared.
        "driver.residual=0.2",
    ];
    let summary = relax(Branch::Prolate, 0.9, &changes);
    assert_eq!(summary.end, End::Converged, "{}", summary.message);
    PATCHES.assert(energy(&summary), theory, theory, "642 vertices");
}

/// Edges of a fifth of the radius do not resolve the neck of a stomatocyte: its patches fold, and their energy has
/// no bound.
#[test]
fn a_bending_energy_below_zero_ends_the_run() {
    let folder = TempDir::new().expect("a folder");
    let mesh = folder.path().join("stomatocyte.ply");
    let vesicle = Vesicle::new(Branch::Stomatocyte, 0.6, 64);
    let vesicle = vesicle.unwrap_or_else(|error| panic!("{error}"));
    std::fs::write(&mesh, vesicle.ply(0.2, "a stomatocyte")).expect("a mesh");
    let mesh = format!("surface.0.mesh={}", mesh.display());
    let changes = [
        mesh.as_str(),
        "surface.0.bending.method=galerkin",
        "surface.0.volume.reduced=0.58",
        "output.pictures=false",
        "output.every=5",
    ];
    let changes = Overrides::new(changes).expect("overrides");
    let file = SceneFile::read(&scenes().join("vesicle-branches.toml"), &changes);
    let file = file.unwrap_or_else(|errors| panic!("{errors}"));
    let summary = relax_in(&file, &folder.path().join("out"), false);
    assert_eq!(summary.end, End::Failed, "{}", summary.message);
    assert!(summary.message.contains("below 0"), "{}", summary.message);
}

/// The same for all branches and volumes that 2562 vertices resolve.
#[test]
#[ignore = "a quarter of an hour: by .ci/long"]
fn vesicles_of_patches_have_the_energies_of_the_axisymmetric_theory() {
    for (branch, v) in [
        (Branch::Prolate, 0.9),
        (Branch::Prolate, 0.651),
        (Branch::Oblate, 0.651),
        (Branch::Prolate, 0.6),
        (Branch::Oblate, 0.6),
    ] {
        compare(branch, v, "galerkin", [PATCHES, ESTIMATE]);
    }
}

#[test]
#[ignore = "half a minute: by .ci/long"]
fn long_and_flat_vesicles_have_the_energies_of_the_axisymmetric_theory() {
    compare(Branch::Prolate, 0.651, "juelicher", [JUELICHER, ESTIMATE]);
    compare(Branch::Prolate, 0.651, "loop", [LOOP, ESTIMATE]);
    compare(Branch::Oblate, 0.651, "loop", [LOOP, ESTIMATE]);
    compare(Branch::Prolate, 0.6, "loop", [LOOP, ESTIMATE]);
    compare(Branch::Oblate, 0.6, "juelicher", [JUELICHER, ESTIMATE]);
    compare(Branch::Oblate, 0.6, "loop", [LOOP, ESTIMATE]);
}

/// A quick vesicle, and its modes.
const COARSE: [&str; 4] = [
    "surface.0.vertices=642",
    "surface.0.bending.method=loop",
    "driver.energy_error=0.1",
    "driver.modes=8",
];

/// Above v = 0.74 or so oblates are saddles, from which displacements by cos 2φ and sin 2φ around the axis lead to
/// prolates.
#[test]
fn modes_tell_stable_equilibria_from_saddles() {
    for (branch, v, residual, unstable) in [
        (Branch::Prolate, 0.9, "1e-5", 0),
        (Branch::Oblate, 0.7, "1e-5", 0),
        // As close to the saddle as the relaxation comes.
        (Branch::Oblate, 0.9, "0.1", 2),
    ] {
        let residual = format!("driver.residual={residual}");
        let changes = COARSE.iter().copied().chain([residual.as_str()]);
        let summary = relax(branch, v, &Vec::from_iter(changes));
        let what = format!("{branch:?} {v}: {:?}", summary.modes);
        assert_eq!(summary.end, End::Converged, "{what}");
        assert!(summary.warnings.is_empty(), "{:?}", summary.warnings);
        // All rigid motions but the rotation about the axis, measured against the stiffness of the others.
        let (rigid, shapes): (Vec<_>, Vec<_>) =
            summary.modes.iter().partition(|mode| mode.is_rigid());
        assert_eq!([rigid.len(), shapes.len()], [5, 3], "{what}");
        assert!(rigid.iter().all(|mode| mode.rigid > 0.999), "{what}");
        assert!(
            rigid.iter().all(|mode| mode.stiffness.abs() < 0.2),
            "{what}"
        );
        let falls = shapes.iter().filter(|mode| mode.stiffness < -1.0);
        assert_eq!(falls.count(), unstable, "{what}");
        let rises = shapes.iter().filter(|mode| mode.stiffness > 1.0);
        assert_eq!(rises.count(), 3 - unstable, "{what}");
        // cos 2φ and sin 2φ.
        let pair = (shapes[0].stiffness / shapes[1].stiffness - 1.0).abs();
        assert!(pair < 0.02, "{what}");

        let mut report = Vec::new();
        run_table(&summary, Path::new("out"), &mut report).expect("a report");
        let report = String::from_utf8(report).expect("text");
        let told = match unstable {
            0 => "the shape is stable (8 modes, of which rigid motions: 5)",
            _ => "the shape is unstable: 2 of negative stiffness",
        };
        assert!(report.contains(told), "{report}");
    }
}

#[test]
fn modes_can_be_asked_for_when_a_run_has_ended() {
    let folder = TempDir::new().expect("a folder");
    let out = folder.path().join("out");
    let table = out.join("modes.csv");
    let file = |modes: &'static str| {
        let changes = COARSE.iter().copied().chain([modes]);
        let file = scene(Branch::Prolate, 0.9, &Vec::from_iter(changes));
        file.unwrap_or_else(|errors| panic!("{errors}"))
    };
    let without = relax_in(&file("driver.modes=0"), &out, false);
    assert!(without.modes.is_empty() && !table.exists());
    let with = relax_in(&file("driver.modes=6"), &out, true);
    assert_eq!(with.modes.len(), 6);
    let written = std::fs::read_to_string(&table).expect("a table");
    let (head, rows) = written.split_once('\n').expect("rows");
    assert_eq!(head, "mode,stiffness,residual,rigid");
    let numbers = |row: &str| -> Vec<f64> {
        let cells = row.split(',');
        cells.map(|cell| cell.parse().expect("a number")).collect()
    };
    let expected =
        with.modes.iter().zip(1..).map(|(mode, number)| {
            vec![f64::from(number), mode.stiffness, mode.residual, mode.rigid]
        });
    assert_eq!(
        Vec::from_iter(rows.lines().map(numbers)),
        Vec::from_iter(expected)
    );
    let again = relax_in(&file("driver.modes=0"), &out, true);
    assert!(again.modes.is_empty() && !table.exists());
}

#[test]
fn modes_need_an_energy_and_an_equilibrium() {
    for (change, problem) in [
        ("surface.0.bending.method=j6", "leave `modes` out"),
        ("driver.scheme=overdamped", "leave `modes` out"),
        ("driver.modes=101", "101 modes: the limit is 100"),
    ] {
        let changes = COARSE.iter().copied().chain([change]);
        let refused = scene(Branch::Prolate, 0.9, &Vec::from_iter(changes));
        let errors = refused.err().unwrap_or_else(|| panic!("{change}"));
        assert!(errors.to_string().contains(problem), "{errors}");
    }
    let changes = COARSE.iter().copied().chain(["driver.iterations=3"]);
    let summary = relax(Branch::Prolate, 0.9, &Vec::from_iter(changes));
    assert_eq!(summary.end, End::IterationLimit);
    let warning = "the modes are not those of an equilibrium";
    assert!(summary.warnings.iter().any(|told| told.contains(warning)));
}

#[test]
fn stability_is_that_of_the_modes_that_are_no_rigid_motions() {
    let mode = |stiffness: f64, rigid: f64| Mode {
        stiffness,
        residual: 1e-3,
        rigid,
    };
    let rigid = mode(-0.1, 0.99);
    for (modes, verdict) in [
        (
            vec![rigid.clone(), mode(0.3, 0.0)],
            "stable (2 modes, of which rigid motions: 1)",
        ),
        (vec![rigid.clone(), mode(-0.3, 0.1)], "unstable: 1 of"),
        (vec![mode(1e-4, 0.0), mode(0.3, 0.0)], "not decided: 1 of"),
        (vec![rigid], "not decided: all modes"),
    ] {
        let told = stability(&modes);
        assert!(told.starts_with(verdict), "{told}");
    }
}

/// The meshes of the scene `vesicle-branches`; `UPDATE_MESHES=1` writes them.
#[test]
fn shipped_meshes_are_axisymmetric_vesicles() {
    for (branch, name, v, edge) in [
        (Branch::Prolate, "prolate", 0.65, 0.12),
        (Branch::Oblate, "oblate", 0.6, 0.12),
        (Branch::Stomatocyte, "stomatocyte", 0.6, 0.115),
    ] {
        let vesicle = Vesicle::new(branch, v, 64).unwrap_or_else(|error| panic!("{error}"));
        let comment = format!("an axisymmetric {name} of reduced volume {v}, of area 4 pi");
        let expected = vesicle.ply(edge, &comment);
        let path = scenes().join(format!("vesicle-{name}.ply"));
        if std::env::var_os("UPDATE_MESHES").is_some() {
            std::fs::write(&path, &expected).expect("the mesh can be written");
        }
        let shipped = std::fs::read_to_string(&path).expect("a mesh");
        assert_eq!(shipped.lines().count(), expected.lines().count());
        for (shipped, expected) in shipped.lines().zip(expected.lines()) {
            let numbers = |line: &str| -> Option<Vec<f64>> {
                line.split(' ').map(|number| number.parse().ok()).collect()
            };
            // The last digit may be rounded otherwise on another machine.
            match (numbers(shipped), numbers(expected)) {
                (Some(shipped), Some(expected)) => assert!(
                    shipped
                        .iter()
                        .zip(&expected)
                        .all(|(a, b)| (a - b).abs() < 2e-6),
                    "{name}: {shipped:?} {expected:?}"
                ),
                _ => assert_eq!(shipped, expected, "{name}"),
            }
        }
    }
}
