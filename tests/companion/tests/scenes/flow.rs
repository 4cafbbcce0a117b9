//! Membranes in Stokes flow by the driver boundary-integral.

mod numbers;
mod refused;

use super::{capsule_in, generated, valid};
use helfrich_std::scene::{
    BoundaryIntegral, Driver, Every, Flow, Integrator, MeshSource, Plot, Scene, SceneFile, Slice,
};
use helfrich_tests::tolerance;

#[track_caller]
fn capsule(replacements: &[(&str, &str)]) -> String {
    capsule_in("boundary-integral", "", replacements)
}

/// The capsule's scene in another flow.
fn with_flow(flow: &str) -> String {
    capsule(&[("kind = \"shear\", rate = 0.15", flow)])
}

#[track_caller]
fn driver(scene: &Scene) -> BoundaryIntegral {
    match scene.driver {
        Driver::BoundaryIntegral(driver) => driver,
        other => panic!("{other:?}"),
    }
}

/// Messages of all warnings, including those about the mesh.
fn warnings(file: &SceneFile) -> Vec<String> {
    let mesh = generated(file, 0);
    let all = file.warnings.iter().cloned();
    let all = all.chain(file.mesh_warnings(0, &mesh));
    all.map(|warning| warning.to_string()).collect()
}

#[track_caller]
fn warned(text: &str, line: usize, parts: &[&str]) {
    let [message] = warnings(&valid(text)).try_into().unwrap();
    let start = format!("folder/cell.toml:{line}:");
    assert!(message.starts_with(&start), "{message}");
    for part in parts {
        assert!(message.contains(part), "`{part}` is not in: {message}");
    }
}

/// A scene with every key of a flow without walls.
const IN_FLOW: &str = r#"
units = "micro"
[[surface]]
shape = "sphere:3"
vertices = 642
match_volume = true
viscosity_ratio = 5
membrane_viscosity = { shear = "0.5 µN·s/m" }
stretching = { axis = [1, 0, 0], force = "3 pN" }
elasticity = { law = "skalak", shear_modulus = 5.3, area_ratio = 1 }
area.modulus = "100 µN/m"
volume.constraint = "exact"
[driver]
kind = "boundary-integral"
viscosity = "1.2 mPa s"
flow = { kind = "poiseuille", centre_velocity = "1 mm/s", radius = "10 µm", direction = [0, 0, 2], through = [1, "2 µm", 3] }
duration = "20 ms"
integrator = "rk4"
step = "10 µs"
tolerance = 1e-5
cluster_tolerance = 0
volume_correction = false
[output]
interval = "1 ms"
checkpoint_every = 7
[[output.plot]]
column = "D"
against = "time"
published = "published.csv"
[[output.plot]]
column = "volume"
[[output.slice]]
name = "middle"
centre = ["1 µm", 0, 0.5]
normal = [0, 1, 0]
size = ["40 µm", 20]
points = [81, 41]
[[output.slice]]
normal = [1, 0, 0]
size = [1, 1]
points = [2, 2]
"#;

#[test]
fn every_key_of_a_flow_is_read() {
    let file = valid(IN_FLOW);
    let scene = &file.scene;
    let expected = BoundaryIntegral {
        viscosity: 1.2e-3,
        flow: Flow::Poiseuille {
            centre_velocity: 1000.0,
            radius: 10.0,
            direction: [0.0, 0.0, 2.0],
            through: [1.0, 2.0, 3.0],
        },
        duration: 0.02,
        integrator: Integrator::Rk4 { step: 1e-5 },
        tolerance: 1e-5,
        cluster_tolerance: Some(0.0),
        volume_correction: false,
        redistribution: false,
    };
    assert_eq!(driver(scene), expected);
    let surface = &scene.surfaces[0];
    assert_eq!(surface.viscosity_ratio, Some(5.0));
    assert_eq!(surface.effects.membrane_viscosity.unwrap().shear, 0.5);
    assert!(matches!(
        surface.source,
        MeshSource::Shape {
            match_volume: true,
            ..
        }
    ));
    let output = &scene.output;
    assert_eq!(output.every, Every::Time(1e-3));
    assert_eq!(output.checkpoint_every, 7);
    let plot = |column: &str, against: &str, published: Option<&str>| Plot {
        column: column.to_owned(),
        against: against.to_owned(),
        published: published.map(Into::into),
    };
    let plots = [
        plot("D", "time", Some("folder/published.csv")),
        plot("volume", "strain", None),
    ];
    assert_eq!(output.plots, plots);
    let slices = [
        Slice {
            name: "middle".to_owned(),
            centre: [1.0, 0.0, 0.5],
            normal: [0.0, 1.0, 0.0],
            size: [40.0, 20.0],
            points: [81, 41],
        },
        Slice {
            name: "slice-2".to_owned(),
            centre: [0.0; 3],
            normal: [1.0, 0.0, 0.0],
            size: [1.0, 1.0],
            points: [2, 2],
        },
    ];
    assert_eq!(output.slices, slices);
    assert_eq!(file.warnings, []);
}

#[test]
fn what_is_left_out_has_its_default() {
    let scene = valid(&capsule(&[])).scene;
    let expected = BoundaryIntegral {
        viscosity: 1.0,
        flow: Flow::Shear { rate: 0.15 },
        duration: 4.0 / 0.15,
        integrator: Integrator::Rkc2,
        tolerance: 1e-4,
        cluster_tolerance: None,
        volume_correction: true,
        redistribution: false,
    };
    assert_eq!(driver(&scene), expected);
    let tolerances = [4999, 5000].map(|vertices| expected.cluster_tolerance_at(vertices));
    assert_eq!(tolerances, [0.0, 1e-4]);
    assert_eq!(scene.output.every, Every::Time(0.01 * expected.duration));
    let soft = capsule(&[("bending = { method = \"B\", modulus = 0.1125 }\n", "")]);
    assert_eq!(driver(&valid(&soft).scene).integrator, Integrator::Bs23);
    let drop = valid(&capsule(&[
        ("bending = { method = \"B\", modulus = 0.1125 }", ""),
        (
            "elasticity = { law = \"neo-hookean\", shear_modulus = 1 }",
            "tension.value = 1",
        ),
    ]));
    assert_eq!(driver(&drop.scene).integrator, Integrator::Rkc2);
    assert!(driver(&drop.scene).redistribution);
    let still = capsule(&[
        ("flow = { kind = \"shear\", rate = 0.15 }\n", ""),
        ("strain = 4", "duration = 3"),
    ]);
    let still = valid(&(still + "[[output.plot]]\ncolumn = \"D\"")).scene;
    assert_eq!(driver(&still).flow, Flow::Quiescent);
    assert_eq!(still.output.plots[0].against, "time");
    let often = valid(&(capsule(&[]) + "[output]\nstrain_interval = 0.3"))
        .scene
        .output
        .every;
    assert_eq!(often, Every::Time(0.3 / 0.15));
}

/// Each named flow has the velocities of the formula in its documentation.
#[test]
fn flows_are_what_they_are_called() {
    let flow = |text: &str| driver(&valid(&with_flow(text)).scene).flow;
    let point = [0.3, -0.7, 1.1];
    let [x, y, z] = point;
    let cases = [
        ("kind = \"shear\", rate = 2", [2.0 * y, 0.0, 0.0], 2.0),
        ("kind = \"shear\", rate = -2", [-2.0 * y, 0.0, 0.0], 2.0),
        ("kind = \"extension\", rate = 2", [2.0 * x, -y, -z], 2.0),
        (
            "kind = \"plane-extension\", rate = 2",
            [2.0 * x, -2.0 * y, 0.0],
            2.0,
        ),
        // A shear in the plane of z and x, and a pure strain of the same rate.
        (
            "kind = \"linear\", gradient = [[0, 0, 0], [0, 0, 0], [3, 0, 0]]",
            [0.0, 0.0, 3.0 * x],
            3.0,
        ),
        (
            "kind = \"linear\", gradient = [[0, 1.5, 0], [1.5, 0, 0], [0, 0, 0]]",
            [1.5 * y, 1.5 * x, 0.0],
            3.0,
        ),
        (
            "kind = \"poiseuille\", centre_velocity = 3, radius = 2, direction = [0, 5, 0]",
            [0.0, 3.0 * (1.0 - (x * x + z * z) / 4.0), 0.0],
            3.0,
        ),
    ];
    for (text, velocity, rate) in cases {
        let flow = flow(text);
        let found = flow.ambient().unwrap().velocity(point);
        for (found, expected) in found.into_iter().zip(velocity) {
            tolerance::SCENE_NUMBER.assert(found, expected, 1.0, text);
        }
        tolerance::SCENE_NUMBER.assert(flow.rate().unwrap(), rate, 1.0, text);
    }
    assert_eq!(Flow::Quiescent.ambient(), None);
    assert_eq!(Flow::Quiescent.rate(), None);
    // A rigid rotation has no rate of strain.
    let gradient = [[0.0, 0.7, 0.0], [-0.7, 0.0, 0.0], [0.0; 3]];
    assert_eq!(Flow::Linear { gradient }.rate(), None);
}

#[test]
fn shears_have_a_plane_however_they_are_written() {
    let xy = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    assert_eq!(Flow::Shear { rate: 2.0 }.plane(), Some(xy));
    assert_eq!(Flow::PlaneExtension { rate: 2.0 }.plane(), Some(xy));
    assert_eq!(Flow::Extension { rate: 2.0 }.plane(), None);
    // γ̇ t nᵀ with t = (2, −1, 2)/3 and n = (1, 2, 0)/√5.
    let [along, normal] = [
        [2.0, -1.0, 2.0].map(|x| x / 3.0),
        [1.0, 2.0, 0.0].map(|x| x / 5_f64.sqrt()),
    ];
    let gradient = along.map(|t| normal.map(|n| 0.15 * t * n));
    let [t, n] = Flow::Linear { gradient }.plane().unwrap();
    // Both directions may be reversed together.
    let sign = n[0].signum();
    for axis in 0..3 {
        tolerance::SCENE_NUMBER.assert(sign * t[axis], along[axis], 1.0, "velocity");
        tolerance::SCENE_NUMBER.assert(sign * n[axis], normal[axis], 1.0, "gradient");
    }
    // Neither a pure strain nor a matrix of rank one that is no shear has a shear plane.
    let strain = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0; 3]];
    assert_eq!(Flow::Linear { gradient: strain }.plane(), None);
    let skew = [[1.0, 1.0, 0.0], [0.0; 3], [0.0; 3]];
    assert_eq!(Flow::Linear { gradient: skew }.plane(), None);
}

#[test]
fn slices_have_axes_in_their_plane() {
    let axes = |normal| {
        Slice {
            name: String::new(),
            centre: [0.0; 3],
            normal,
            size: [1.0, 1.0],
            points: [2, 2],
        }
        .axes()
    };
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(axes([0.0, 0.0, 3.0]), [x, y]);
    assert_eq!(axes([0.5, 0.0, 0.0]), [y, z]);
    assert_eq!(axes([0.0, -2.0, 0.0]), [x, z]);
}
