//! Membranes in a box of fluid by the driver lattice-boltzmann.

mod contact;
mod limits;
mod refused;

use super::schema::{conforms, json};
use super::{capsule_in, mesh_file, parse, valid};
use helfrich_std::flow::lattice_boltzmann::Kernel;
use helfrich_std::info::MeshInfo;
use helfrich_std::scalar::Scalar;
use helfrich_std::scene::{
    Driver, Every, Flow, LatticeBoltzmann, MeshSource, ObstacleScene, Orientation, Probe, Scene,
    Volume, json_schema,
};
use helfrich_std::simulation::{BuildError, build};
use helfrich_tests::tolerance::{self, Tolerance};

/// Velocities in the centre of ducts, relative.
const DUCT: Tolerance = Tolerance::new(
    5e-4,
    "finite differences over a thirtieth of the half width; a book's four digits",
);

#[track_caller]
pub(super) fn capsule(replacements: &[(&str, &str)]) -> String {
    capsule_in("lattice-boltzmann", "resolution = 6\n", replacements)
}

/// Message about a scene that cannot be built.
#[track_caller]
fn unbuildable(text: &str) -> String {
    match build(&valid(text)) {
        Err(BuildError::Scene(errors)) => errors.to_string(),
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("it can be built: {text}"),
    }
}

/// Messages of all warnings, including those about the meshes.
pub(super) fn warnings(text: &str) -> Vec<String> {
    let (simulation, _) = build(&valid(text)).unwrap_or_else(|error| panic!("{error}"));
    simulation
        .warnings()
        .iter()
        .map(ToString::to_string)
        .collect()
}

/// Checks that the value `inside` in place of `?` gives no warning, and `outside` one warning at `line` with
/// `parts`.
#[track_caller]
fn warned_beyond(
    replacements: &[(&str, &str)],
    [inside, outside]: [&str; 2],
    line: usize,
    parts: &[&str],
) {
    let text = capsule(replacements);
    assert!(text.contains('?'), "{text}");
    assert_eq!(warnings(&text.replace('?', inside)), [""; 0]);
    let all = warnings(&text.replace('?', outside));
    let [message] = <[String; 1]>::try_from(all).unwrap_or_else(|all| panic!("{all:#?}"));
    let start = format!("folder/cell.toml:{line}:");
    assert!(message.starts_with(&start), "{message}");
    for part in parts {
        assert!(message.contains(part), "`{part}` is not in: {message}");
    }
}

/// Facts about the scene's only surface at its position.
fn placed(text: &str) -> MeshInfo {
    let (simulation, positions) = build(&valid(text)).unwrap();
    MeshInfo::new(simulation.bodies()[0].surface(&positions).unwrap())
}

#[track_caller]
fn driver(scene: &Scene) -> LatticeBoltzmann {
    match scene.driver {
        Driver::LatticeBoltzmann(driver) => driver,
        other => panic!("{other:?}"),
    }
}

/// A scene with every key of a lattice.
const ON_A_LATTICE: &str = r#"
units = "micro"
[[surface]]
shape = "sphere:3"
vertices = 2562
elasticity = { law = "skalak", shear_modulus = 5.3, area_ratio = 1 }
bending = { method = "j4", modulus = "2e-19 J" }
[[obstacle]]
name = "bump"
shape = "sphere:1"
vertices = 642
position = ["2 µm", -9, 0]
scale = 4
orientation = { axis = [0, 0, 1], angle = 30 }
[[obstacle]]
mesh = "bump.ply"
[driver]
kind = "lattice-boltzmann"
viscosity = "1.2 mPa s"
density = "1000 kg/m³"
flow = { kind = "channel", centre_velocity = "1 mm/s", section = "duct" }
duration = "20 ms"
spacing = "500 nm"
box = ["24 µm", 16.1, 12]
centre = [1, "2 µm", 3]
step = "20 ns"
kernel = "four"
precision = "f32"
volume_correction = false
[output]
interval = "1 ms"
[[output.probe]]
name = "ahead"
point = ["10 µm", 0, 0]
[[output.probe]]
point = [1, 2, 3]
[[output.volume]]
name = "all"
stride = 2
[[output.volume]]
"#;

#[test]
fn every_key_is_read() {
    let file = valid(ON_A_LATTICE);
    let scene = &file.scene;
    let expected = LatticeBoltzmann {
        viscosity: 1.2e-3,
        density: Some(1e-9),
        flow: Flow::Channel {
            centre_velocity: 1000.0,
            width: 16.0,
            depth: Some(12.0),
        },
        duration: 0.02,
        spacing: 0.5,
        cells: [48, 32, 24],
        centre: [1.0, 2.0, 3.0],
        lattice_viscosity: driver(scene).lattice_viscosity,
        step: 2e-8,
        kernel: Kernel::Four,
        precision: Scalar::F32,
        volume_correction: false,
        redistribution: false,
    };
    assert_eq!(driver(scene), expected);
    // μ step/(ρ spacing²), with a kinematic viscosity of 1.2e6 µm²/s.
    let viscosity = driver(scene).lattice_viscosity;
    tolerance::SCENE_NUMBER.assert(viscosity, 0.096, 0.096, "lattice viscosity");
    assert_eq!(driver(scene).walls(), [false, true, true]);
    assert_eq!(driver(scene).size(), [24.0, 16.0, 12.0]);
    let corners = [[-11.0, -6.0, -3.0], [13.0, 10.0, 9.0]];
    assert_eq!(driver(scene).corners(), corners);
    let [bump, other] = scene.obstacles.as_slice() else {
        panic!("{:?}", scene.obstacles);
    };
    assert!(matches!(
        bump.source,
        MeshSource::Shape { vertices: 642, .. }
    ));
    let placed = ObstacleScene {
        name: "bump".to_owned(),
        source: bump.source.clone(),
        scale: 4.0,
        position: [2.0, -9.0, 0.0],
        orientation: Some(Orientation {
            axis: [0.0, 0.0, 1.0],
            angle: 30.0,
        }),
    };
    assert_eq!(bump, &placed);
    let file = ObstacleScene {
        name: "obstacle-2".to_owned(),
        source: MeshSource::File(mesh_file("folder/bump.ply")),
        scale: 1.0,
        position: [0.0; 3],
        orientation: None,
    };
    assert_eq!(other, &file);
    let probe = |name: &str, point| Probe {
        name: name.to_owned(),
        point,
    };
    let probes = [
        probe("ahead", [10.0, 0.0, 0.0]),
        probe("probe-2", [1.0, 2.0, 3.0]),
    ];
    assert_eq!(scene.output.probes, probes);
    let volume = |name: &str, stride| Volume {
        name: name.to_owned(),
        stride,
    };
    let volumes = [volume("all", 2), volume("volume-2", 1)];
    assert_eq!(scene.output.volumes, volumes);
}

#[test]
fn what_is_left_out_has_its_default() {
    let scene = valid(&capsule(&[])).scene;
    let found = driver(&scene);
    let expected = LatticeBoltzmann {
        viscosity: 1.0,
        density: None,
        flow: Flow::Shear { rate: 0.15 },
        duration: 4.0 / 0.15,
        spacing: found.spacing,
        cells: [42; 3],
        centre: [0.0; 3],
        lattice_viscosity: 1.0 / 3.0,
        step: found.step,
        kernel: Kernel::Two,
        precision: Scalar::F64,
        volume_correction: true,
        redistribution: false,
    };
    assert_eq!(found, expected);
    // The nominal radius a = 1 counts, whatever volume the polyhedron encloses.
    tolerance::SCENE_NUMBER.assert(found.spacing, 1.0 / 6.0, 1.0, "spacing");
    assert_eq!(found.walls(), [false, true, false]);
    // A surface that resists only by its total area has a default step, too.
    let effects = "bending = { method = \"B\", modulus = 0.1125 }\nelasticity = { law = \"neo-hookean\", shear_modulus = 1 }";
    let held = valid(&capsule(&[
        (effects, "area.modulus = 4"),
        ("kind = \"shear\", rate = 0.15", "kind = \"quiescent\""),
        ("strain = 4", "duration = 100"),
    ]));
    // (K_s + G) step/(μ spacing) is at most 0.5, minus a tenth and the rounding to whole steps.
    let step = driver(&held.scene).step * 6.0 * 4.0;
    assert!((0.4..=0.45).contains(&step), "{step}");
    // Outputs are written after whole steps.
    let Every::Time(interval) = scene.output.every else {
        panic!("{:?}", scene.output.every);
    };
    let steps = interval / found.step;
    tolerance::SCENE_NUMBER.assert(steps, steps.round(), steps, "steps an interval");
    assert_eq!(scene.obstacles, []);
    // The lattice viscosity of the fluid inside is also between 0.02 and 1, if possible.
    for (ratio, expected) in [
        (2.0, 1.0 / 3.0),
        (5.0, 0.2),
        (0.1, 1.0 / 3.0),
        (0.04, 0.5),
        (60.0, 0.02),
    ] {
        let line = format!("match_volume = true\nviscosity_ratio = {ratio}");
        let scene = valid(&capsule(&[("match_volume = true", &line)])).scene;
        let found = driver(&scene).lattice_viscosity;
        tolerance::SCENE_NUMBER.assert(found, expected, expected, &line);
    }
}

/// μU/(G H²) in the centre of a duct of width H and depth `ratio` H: solves ∇²u = −1 by second-order
/// differences on a quarter of it, by over-relaxation with the factor that is best for a square.
fn velocity_in_the_middle(ratio: usize) -> f64 {
    const HALF: usize = 30;
    let [rows, columns] = [HALF, HALF * ratio];
    // The grid reaches from the centre to the walls; values beyond the centre are mirrored.
    let mut u = vec![vec![0.0; columns + 1]; rows + 1];
    let spacing = 0.5 / HALF as f64;
    let factor = 2.0 / (1.0 + std::f64::consts::PI / (2 * columns) as f64);
    for _ in 0..40 * columns {
        for i in 0..rows {
            for j in 0..columns {
                let across = u[i + 1][j] + u[i.abs_diff(1)][j];
                let along = u[i][j + 1] + u[i][j.abs_diff(1)];
                let relaxed = 0.25 * (across + along + spacing * spacing);
                u[i][j] += factor * (relaxed - u[i][j]);
            }
        }
    }
    u[0][0]
}

/// The literature gives 0.07367 for a square duct; between plates it is 1/8.
#[test]
fn channels_are_driven_by_the_force_that_their_velocity_takes() {
    let force = |centre_velocity: f64, width: f64, depth: Option<f64>, viscosity: f64| {
        let flow = Flow::Channel {
            centre_velocity,
            width,
            depth,
        };
        flow.driving_force(viscosity).unwrap()
    };
    let [velocity, width, viscosity] = [3.0, 2.0, 5.0];
    for (depth, share) in [
        (None, 0.125),
        (Some(2.0), 0.07367),
        (Some(2.0), velocity_in_the_middle(1)),
        (Some(4.0), velocity_in_the_middle(2)),
        (Some(1e6), 0.125),
    ] {
        let force = force(velocity, width, depth, viscosity);
        let found = viscosity * velocity / (force * width * width);
        DUCT.assert(found, share, share, &format!("{depth:?}"));
    }
    // Width and depth may be exchanged.
    let [high, wide] = [(1.0, 2.0), (2.0, 1.0)].map(|(h, d)| force(1.0, h, Some(d), 1.0));
    tolerance::SCENE_NUMBER.assert(high, wide, wide, "turned");
    assert_eq!(Flow::Shear { rate: 1.0 }.driving_force(1.0), None);
    let channel = Flow::Channel {
        centre_velocity: -3.0,
        width: 2.0,
        depth: None,
    };
    assert_eq!(channel.rate(), Some(6.0));
}

#[test]
fn the_schema_knows_lattices() {
    let schema = json_schema();
    let obstacle = "[[obstacle]]\nshape = \"sphere:1\"\nvertices = 42\n[driver]";
    let with = |lines: &str| capsule(&[("resolution = 6", lines)]);
    let right = [
        capsule(&[]),
        capsule(&[("[driver]", obstacle)]),
        with("spacing = 0.2\nbox = [5, 6, 7]\nkernel = \"four\"\nprecision = \"f32\""),
        capsule(&[(
            "kind = \"shear\", rate",
            "kind = \"channel\", centre_velocity",
        )]),
        with("resolution = 6\n[[output.volume]]\n[[output.probe]]\npoint = [0, 1, 0]"),
    ];
    for text in right {
        assert!(conforms(&schema, &json(&text)), "{text}");
        valid(&text);
    }
    let wrong = [
        with(""),
        with("resolution = 6\nspacing = 0.2"),
        with("resolution = 6\nbox = [1, 2]"),
        with("resolution = 6\nkernel = \"five\""),
        with("resolution = 6\nprecision = \"f32-pair\""),
        with("resolution = 6\ntolerance = 1e-4"),
        with("resolution = 6\n[[output.volume]]\nstride = 0"),
        with("resolution = 6\n[[output.probe]]\nname = \"a\""),
        capsule(&[(
            "kind = \"shear\", rate = 0.15",
            "kind = \"channel\", section = \"duct\"",
        )]),
        capsule(&[("[driver]", "[[obstacle]]\nshape = \"sphere:1\"\n[driver]")]),
    ];
    for text in wrong {
        assert!(!conforms(&schema, &json(&text)), "{text}");
        assert!(parse(&text).is_err(), "{text}");
    }
}
