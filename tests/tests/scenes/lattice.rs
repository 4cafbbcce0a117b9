//! Membranes in a box of fluid: the driver lattice-boltzmann.

use super::schema::{conforms, json};
use super::{parse, refused, valid};
use helfrich::Surface;
use helfrich_std::flow::lattice_boltzmann::Kernel;
use helfrich_std::info::MeshInfo;
use helfrich_std::scalar::Scalar;
use helfrich_std::scene::{
    Driver, Every, Explanation, Flow, LatticeBoltzmann, MeshSource, Obstacle, Orientation, Probe,
    Scene, Volume, json_schema,
};
use helfrich_std::simulation::{BuildError, build};
use helfrich_tests::tolerance;

/// The capsule of Guckenberger et al. 2016 in a box: effects from line 8 on, the driver from 11 on.
const CAPSULE: &str = r#"units = "none"
[[surface]]
name = "capsule"
shape = "sphere:1"
family = "regular"
vertices = 642
match_volume = true
bending = { method = "B", modulus = 0.1125 }
elasticity = { law = "neo-hookean", shear_modulus = 1 }
[driver]
kind = "lattice-boltzmann"
viscosity = 1
flow = { kind = "shear", rate = 0.15 }
strain = 4
resolution = 6
"#;

/// The same with other lines in places.
fn capsule(replacements: &[(&str, &str)]) -> String {
    let mut text = CAPSULE.to_owned();
    for (old, new) in replacements {
        assert!(text.contains(old), "{old}");
        text = text.replace(old, new);
    }
    text
}

/// What is said of a scene that cannot be built.
#[track_caller]
fn unbuildable(text: &str) -> String {
    match build(&valid(text)) {
        Err(BuildError::Scene(errors)) => errors.to_string(),
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("it can be built: {text}"),
    }
}

/// The messages of all warnings, those of the meshes included.
fn warnings(text: &str) -> Vec<String> {
    let (simulation, _) = build(&valid(text)).unwrap_or_else(|error| panic!("{error}"));
    simulation
        .warnings()
        .iter()
        .map(ToString::to_string)
        .collect()
}

/// Lines in place of others give no warning, and with another value one at `line` with `parts`.
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

/// What the scene's one surface is like where it is.
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

#[test]
fn every_key_is_read() {
    let file = valid(
        r#"
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
"#,
    );
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
    };
    assert_eq!(driver(scene), expected);
    // μ step/(ρ spacing²), 1.2e6 µm²/s of kinematic viscosity.
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
    let placed = Obstacle {
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
    let file = Obstacle {
        name: "obstacle-2".to_owned(),
        source: MeshSource::File("folder/bump.ply".into()),
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
    let scene = valid(CAPSULE).scene;
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
    };
    assert_eq!(found, expected);
    // a = 1 whatever the polyhedron encloses.
    tolerance::SCENE_NUMBER.assert(found.spacing, 1.0 / 6.0, 1.0, "spacing");
    assert_eq!(found.walls(), [false, true, false]);
    // What resists by its total area alone has a step as well.
    let effects = "bending = { method = \"B\", modulus = 0.1125 }\nelasticity = { law = \"neo-hookean\", shear_modulus = 1 }";
    let held = valid(&capsule(&[
        (effects, "area.modulus = 4"),
        ("kind = \"shear\", rate = 0.15", "kind = \"quiescent\""),
        ("strain = 4", "duration = 100"),
    ]));
    // (K_s + G) step/(μ spacing) ≤ 0.5, less a tenth and a little.
    let step = driver(&held.scene).step * 6.0 * 4.0;
    assert!((0.4..=0.45).contains(&step), "{step}");
    // Outputs come after whole steps.
    let Every::Time(interval) = scene.output.every else {
        panic!("{:?}", scene.output.every);
    };
    let steps = interval / found.step;
    tolerance::SCENE_NUMBER.assert(steps, steps.round(), steps, "steps an interval");
    assert_eq!(scene.obstacles, []);
    // Fluid inside has a good viscosity as well, from 0.02 to 1, if that can be.
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

/// μU/(G H²) in the middle of a duct H wide and `ratio` H deep: ∇²u = −1 by differences of second
/// order on a quarter of it, relaxed with the factor that is best for a square.
fn velocity_in_the_middle(ratio: usize) -> f64 {
    const HALF: usize = 30;
    let [rows, columns] = [HALF, HALF * ratio];
    // From the middle to the walls; what lies beyond the middle is mirrored.
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

/// Books give 0.07367 for a square duct; plates have 1/8.
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
        tolerance::DUCT.assert(found, share, share, &format!("{depth:?}"));
    }
    // It does not matter which side is which.
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

#[test]
fn flows_without_walls_have_no_place_in_a_box() {
    for (flow, instead) in [
        (
            "kind = \"extension\", rate = 1",
            "choose \"quiescent\", \"shear\" or \"channel\"",
        ),
        ("kind = \"plane-extension\", rate = 1", "\"channel\""),
        (
            "kind = \"linear\", gradient = [[0, 1, 0], [0, 0, 0], [0, 0, 0]]",
            "the driver \"boundary-integral\"",
        ),
        (
            "kind = \"poiseuille\", centre_velocity = 1, radius = 9, direction = [1, 0, 0]",
            "choose \"channel\"",
        ),
    ] {
        let text = capsule(&[("kind = \"shear\", rate = 0.15", flow)]);
        refused(&text, [13, 17], &["one of unbounded fluid", instead]);
    }
    let unbounded = capsule(&[
        ("lattice-boltzmann", "boundary-integral"),
        (
            "kind = \"shear\", rate",
            "kind = \"channel\", centre_velocity",
        ),
        ("resolution = 6\n", ""),
    ]);
    refused(
        &unbounded,
        [13, 17],
        &["a channel has walls", "choose \"poiseuille\""],
    );
}

#[test]
fn what_needs_a_lattice_says_so() {
    let integral = capsule(&[
        ("lattice-boltzmann", "boundary-integral"),
        ("resolution = 6\n", ""),
    ]);
    let obstacle = "[[obstacle]]\nshape = \"sphere:1\"\nvertices = 42\n";
    refused(
        &(integral.clone() + obstacle),
        [15, 1],
        &["\"boundary-integral\" has none", "\"lattice-boltzmann\""],
    );
    refused(
        &(integral.clone() + "[[output.volume]]\n"),
        [15, 1],
        &["a volume shows the nodes", "[[output.slice]]"],
    );
    valid(&(integral + "[[output.probe]]\npoint = [1, 2, 3]"));
    let relax = "units = \"none\"\n[[surface]]\nshape = \"sphere\"\nvertices = 42\ntension.value = 1\n[driver]\nkind = \"relax\"\n[[output.probe]]\npoint = [1, 2, 3]";
    refused(
        relax,
        [8, 1],
        &["a probe measures the fluid", "\"relax\" has none"],
    );
}

#[test]
fn wrong_lattices_say_what_is_needed() {
    let refused = |old: &str, new: &str, at: [usize; 2], parts: &[&str]| {
        refused(&capsule(&[(old, new)]), at, parts);
    };
    let lines = "resolution = 6";
    refused(lines, "", [10, 1], &["neither `spacing` nor `resolution`"]);
    refused(
        lines,
        "spacing = 15",
        [15, 11],
        &["nodes are 15 apart, and the box is 7 long along x"],
    );
    refused(
        lines,
        "resolution = 600",
        [15, 14],
        &["7.4e10 nodes", "a larger spacing, 0.07 say"],
    );
    refused(
        lines,
        "resolution = 6\ndensity = 1\nstep = 0.001\nlattice_viscosity = 0.1",
        [17, 8],
        &["follow from each other", "with this step ν is 0.036"],
    );
    refused(
        "shape = \"sphere:1\"\nfamily = \"regular\"\nvertices = 642\nmatch_volume = true\n",
        "mesh = \"nowhere.ply\"\n",
        [4, 8],
        &[
            "the size of \"capsule\" is not known",
            "give the driver `spacing`, `box` and `step`",
        ],
    );
    // All that would follow from the file is given.
    valid(&capsule(&[
        (
            "shape = \"sphere:1\"\nfamily = \"regular\"\nvertices = 642\nmatch_volume = true\n",
            "mesh = \"nowhere.ply\"\n",
        ),
        (lines, "spacing = 0.2\nbox = [7, 7, 7]\nstep = 0.001"),
    ]));
    let second = "[[surface]]\nshape = \"sphere:1\"\nvertices = 642\nposition = [3, 0, 0]\ntension.value = 1\n[driver]";
    refused(
        "[driver]",
        second,
        [15, 1],
        &["`driver` lacks `box`", "there are 2 surfaces"],
    );
    refused(
        "kind = \"shear\", rate = 0.15",
        "kind = \"quiescent\"",
        [14, 10],
        &["strains nothing: give `duration`"],
    );
    refused(
        "viscosity = 1",
        "viscosity = 1e-320",
        [10, 1],
        &["steps would take ", "choose other units"],
    );
    refused(
        lines,
        "resolution = 6\n[output]\nevery = 3",
        [17, 9],
        &[
            "the driver \"lattice-boltzmann\" goes by time",
            "give `interval`",
        ],
    );
}

#[test]
fn outputs_lie_between_the_walls() {
    let with = |lines: &str| capsule(&[("resolution = 6", &format!("resolution = 6\n{lines}"))]);
    let probe = |point: &str| with(&format!("[[output.probe]]\npoint = {point}"));
    // Walls are at ±3.5 along y; along x and z the box is periodic.
    valid(&probe("[9, 3.5, -20]"));
    refused(
        &probe("[0, 3.6, 0]"),
        [17, 9],
        &[
            "the probe \"probe-1\" reaches to 3.6 along y",
            "walls at -3.5 and 3.5",
        ],
    );
    let slice = |height: f64| {
        with(&format!(
            "[[output.slice]]\nnormal = [0, 0, 1]\nsize = [9, {height}]\npoints = [3, 3]"
        ))
    };
    valid(&slice(7.0));
    refused(
        &slice(7.5),
        [16, 1],
        &["the slice \"slice-1\" reaches to -3.75 along y"],
    );
    refused(
        &with("[[output.probe]]\nname = \"centroid\"\npoint = [0, 0, 0]"),
        [17, 8],
        &["are the surfaces': choose another name"],
    );
    refused(
        &with(
            "[[output.probe]]\npoint = [0, 0, 0]\nname = \"a\"\n[[output.probe]]\nname = \"a\"\npoint = [0, 0, 0]",
        ),
        [20, 8],
        &["probe 1 has the name \"a\" of probe 0"],
    );
}

#[test]
fn surfaces_fit_between_the_walls() {
    let reach = placed(CAPSULE).corners[1][1];
    for (kernel, distance) in [("two", 0.5), ("three", 1.0), ("four", 1.5)] {
        // Walls are at ±3.5, nodes 1/6 apart.
        let farthest = 3.5 - distance / 6.0 - reach;
        let at = |y: f64| {
            capsule(&[
                (
                    "match_volume = true",
                    &format!("match_volume = true\nposition = [9, {y}, 9]"),
                ),
                (
                    "resolution = 6",
                    &format!("resolution = 6\nkernel = \"{kernel}\""),
                ),
            ])
        };
        assert_eq!(warnings(&at(farthest - 1e-3)), [""; 0]);
        let message = unbuildable(&at(farthest + 1e-3));
        assert!(
            message.starts_with("folder/cell.toml:8:12: \"capsule\" reaches from "),
            "{message}"
        );
        for part in [
            "the walls are at -3.5 and 3.5",
            "choose a `box` of ",
            "along y",
        ] {
            assert!(message.contains(part), "`{part}` is not in: {message}");
        }
    }
    let narrow = capsule(&[("resolution = 6", "resolution = 6\nbox = [7, 7, 1.9]")]);
    let message = unbuildable(&narrow);
    assert!(
        message.contains("long along z, and the box, which is periodic there, 1.83"),
        "{message}"
    );
    let coarse = capsule(&[("resolution = 6", "spacing = 1.1\nbox = [9, 9, 9]")]);
    let message = unbuildable(&coarse);
    assert!(
        message.contains("the radius of \"capsule\" is 1, less than"),
        "{message}"
    );
    assert!(
        message.contains("a `spacing` of 0.167 or less"),
        "{message}"
    );
}

#[test]
fn obstacles_are_closed_and_stand_in_the_fluid() {
    let with = |lines: &str| {
        capsule(&[(
            "[driver]",
            &format!("[[obstacle]]\nvertices = 162\n{lines}\n[driver]"),
        )])
    };
    let there = with("shape = \"sphere:1\"\nposition = [3, -3.5, 0]");
    let (simulation, _) = build(&valid(&there)).unwrap();
    let [obstacle] = simulation.obstacles() else {
        panic!("{:?}", simulation.obstacles());
    };
    assert_eq!(obstacle.name, "obstacle-1");
    assert_eq!(obstacle.mesh.vertex_count(), 162);
    let surface = Surface::new(&obstacle.mesh, &obstacle.positions).unwrap();
    let expected = [3.0, -3.5, 0.0];
    for (found, expected) in surface.centroid().into_iter().zip(expected) {
        tolerance::SCENE_NUMBER.assert(found, expected, 1.0, "centroid");
    }
    for (lines, part) in [
        (
            "shape = \"sphere:1\"\nposition = [0, 4.6, 0]",
            "between walls at -3.5 and 3.5: move it",
        ),
        (
            "shape = \"ellipsoid:1,1,0.08\"",
            "thick along z, less than the distance of two nodes, 0.167",
        ),
    ] {
        let message = unbuildable(&with(lines));
        assert!(
            message.starts_with("folder/cell.toml:10:1: the obstacle \"obstacle-1\""),
            "{message}"
        );
        assert!(message.contains(part), "`{part}` is not in: {message}");
    }
    // Periodic axes have no outside.
    build(&valid(&with(
        "shape = \"sphere:1\"\nposition = [40, 3, 40]",
    )))
    .unwrap();
    let file = valid(&there);
    let closed = MeshInfo::new(surface);
    let open = MeshInfo {
        volume: None,
        boundary_edges: 5,
        ..closed.clone()
    };
    let message = file.check_obstacle(0, &open).unwrap_err().to_string();
    assert!(message.contains("has 5 boundary edges"), "{message}");
    let inside_out = MeshInfo {
        volume: Some(-1.0),
        ..closed
    };
    let message = file.check_obstacle(0, &inside_out).unwrap_err().to_string();
    assert!(message.contains("turn them over"), "{message}");
}

/// Each limit of the valid range, with a value on either side of it; by hand, with a = μ = G = 1, edges of
/// 0.151, and nodes 1/6 apart where nothing else is said.
#[test]
fn what_leaves_the_valid_range_is_warned_of() {
    assert_eq!(warnings(CAPSULE), [""; 0]);
    let soft = ("modulus = 0.1125", "modulus = 1e-4");
    let slow = ("rate = 0.15", "rate = 1e-3");
    let with = |lines: &str| format!("resolution = 6\n{lines}");
    // 3 G ν step/(μ a), which is 0.01 at 1/60.
    warned_beyond(
        &[
            soft,
            slow,
            ("resolution = 6", &with("lattice_viscosity = 0.2\nstep = ?")),
        ],
        ["0.0166", "0.0168"],
        17,
        &[
            "3 P = 0.0101",
            "a `step` of 0.0167, or a `lattice_viscosity` of 0.198",
        ],
    );
    // With a density 3 G step²/(a ρ spacing²): here at a step of √(0.01/(3·36)) = 0.009623.
    warned_beyond(
        &[
            soft,
            slow,
            ("resolution = 6", &with("density = 1\nstep = ?")),
        ],
        ["0.0096", "0.0097"],
        17,
        &[
            "3 P = 0.0102",
            "a `step` of 0.00962, which is a viscosity of 0.346",
        ],
    );
    // √3 γ̇ L/2 step/spacing, which is 0.1 at 0.01833.
    warned_beyond(
        &[
            soft,
            ("shear_modulus = 1", "shear_modulus = 0.01"),
            ("resolution = 6", &with("lattice_viscosity = 1\nstep = ?")),
        ],
        ["0.0182", "0.0185"],
        17,
        &[
            "the walls move with a Mach number of 0.101",
            "a `step` of 0.0183",
        ],
    );
    // γ̇ a² step/(ν spacing²), which is 0.2 at 0.003704.
    warned_beyond(
        &[
            soft,
            ("resolution = 6", &with("lattice_viscosity = 0.1\nstep = ?")),
        ],
        ["0.0036", "0.0038"],
        17,
        &[
            "a Reynolds number γ̇a²/ν of 0.205",
            "a `step` of 0.0037, a `lattice_viscosity` of 0.103, or a `resolution` of 5.92",
        ],
    );
    // (K_s + G) step/(μ spacing), of which 0.5 is allowed and twice that, at a step of 1/24, too much.
    warned_beyond(
        &[
            soft,
            slow,
            (
                "resolution = 6",
                &with("lattice_viscosity = 0.05\nstep = ?"),
            ),
        ],
        ["0.0412", "0.0421"],
        17,
        &[
            "more than twice 0.0208, which the elasticity of \"capsule\" allows",
            "choose a `step` of 0.0208, or fewer `vertices`",
        ],
    );
    // κ step/(μ spacing edge²), of which 0.09/ν is allowed.
    let edge = mean_edge(&placed(CAPSULE));
    let most = 2.0 * 0.45 * edge * edge / 6.0;
    warned_beyond(
        &[
            ("modulus = 0.1125", "modulus = 1"),
            ("resolution = 6", &with("lattice_viscosity = 0.2\nstep = ?")),
        ],
        [&(0.99 * most).to_string(), &(1.01 * most).to_string()],
        17,
        &["which the bending of \"capsule\" allows"],
    );
    // Edges are 0.151 long.
    warned_beyond(
        &[("resolution = 6", "resolution = ?")],
        ["9.9", "10.1"],
        6,
        &[
            "1.52 nodes long",
            "fluid leaks",
            "more `vertices`, 2562 say, or a `resolution` of 9.9",
        ],
    );
    warned_beyond(
        &[("resolution = 6", "spacing = ?")],
        ["0.49", "0.51"],
        6,
        &[
            "0.295 nodes long",
            "fewer `vertices`, or a `spacing` of 0.251",
        ],
    );
    for (axis, lengths) in [("x", "[?, 7, 7]"), ("y", "[7, ?, 7]"), ("z", "[7, 7, ?]")] {
        let what = if axis == "y" { "walls" } else { "images" };
        warned_beyond(
            &[(
                "resolution = 6",
                &format!("resolution = 6\nbox = {lengths}"),
            )],
            ["6.95", "6.5"],
            16,
            &[
                &format!(
                    "6.5 radii of \"capsule\" long along {axis}, below 7: it feels its {what}"
                ),
                "D by about 2.4 (a/L)³ = 0.00874",
            ],
        );
    }
    for range in [["0.021", "0.019"], ["0.99", "1.01"]] {
        warned_beyond(
            &[("resolution = 6", "resolution = 6\nlattice_viscosity = ?")],
            range,
            16,
            &[
                "best lies between 0.02 and 1",
                "choose a `lattice_viscosity` of ",
            ],
        );
    }
    // ρ γ̇ a²/μ.
    warned_beyond(
        &[("resolution = 6", "resolution = 6\ndensity = ?")],
        ["0.66", "0.68"],
        16,
        &[
            "Reynolds number ργ̇a²/μ of \"capsule\" is 0.102",
            "leave `density` out",
        ],
    );
    for (range, change) in [
        (["4.9", "5.1"], "choose a `lattice_viscosity` of 0.196"),
        (["0.11", "0.09"], "choose a `lattice_viscosity` of 0.222"),
        (["1", "60"], "no viscosity outside is right for both"),
    ] {
        warned_beyond(
            &[
                (
                    "match_volume = true",
                    "match_volume = true\nviscosity_ratio = ?",
                ),
                ("resolution = 6", &with("lattice_viscosity = 0.2")),
            ],
            range,
            8,
            &["inside of \"capsule\"", change],
        );
    }
    let resting = &[
        ("kind = \"shear\", rate = 0.15", "kind = \"?\""),
        ("strain = 4", "duration = 1"),
        (
            "match_volume = true",
            "match_volume = true\ngravity = { density_difference = 1, acceleration = [1, 0, 0] }",
        ),
    ];
    warned_beyond(
        resting,
        [
            "channel\", centre_velocity = 0.1, section = \"plates",
            "quiescent",
        ],
        8,
        &["in a box without walls nothing carries it"],
    );
    // Walls of a channel are there to be felt.
    let channel = "kind = \"channel\", centre_velocity = 0.1";
    let channel = capsule(&[
        ("kind = \"shear\", rate = 0.15", channel),
        ("resolution = 6", "resolution = 6\nbox = [7, 3, 7]"),
    ]);
    assert_eq!(warnings(&channel), [""; 0]);
    // More than any machine has: of the scene itself, for the mesh is too coarse for it as well.
    let large = valid(&capsule(&[("resolution = 6", "resolution = 250")]));
    let [message] = large.warnings.as_slice() else {
        panic!("{:?}", large.warnings);
    };
    let message = message.to_string();
    for part in [
        "the lattice takes 9",
        "GB of memory",
        "`precision` = \"f32\"",
        "a `spacing` of",
    ] {
        assert!(message.contains(part), "`{part}` is not in: {message}");
    }
}

/// The edge of an equilateral triangle of the mean area.
fn mean_edge(mesh: &MeshInfo) -> f64 {
    (4.0 * mesh.area / (3_f64.sqrt() * mesh.triangles as f64)).sqrt()
}

/// The step is the longest that all limits allow, less a tenth, and less what makes it divide the time
/// between outputs.
#[test]
fn the_default_step_obeys_all_limits() {
    let soft = ("modulus = 0.1125", "modulus = 1e-4");
    let thin = ("resolution = 6", "resolution = 6\nlattice_viscosity = 0.1");
    let thinner = ("resolution = 6", "resolution = 6\nlattice_viscosity = 0.05");
    let thick = ("resolution = 6", "resolution = 6\nlattice_viscosity = 1");
    let edge = mean_edge(&placed(CAPSULE));
    for (replacements, name, limit) in [
        (
            &[][..],
            "bending",
            3.0 * 0.09 * edge * edge / (6.0 * 0.1125),
        ),
        (&[soft], "compressibility", 0.01),
        (&[soft, thick], "compressibility", 0.01 / 3.0),
        (
            &[soft, thin],
            "inertia of the lattice",
            0.02 / (36.0 * 0.15),
        ),
        (
            &[soft, thinner, ("rate = 0.15", "rate = 1e-3")],
            "elasticity",
            0.5 / (6.0 * 4.0),
        ),
        (
            &[soft, thick, ("shear_modulus = 1", "shear_modulus = 0.01")],
            "Mach number",
            0.1 / (6.0 * 3_f64.sqrt() * 0.525),
        ),
        (
            &[soft, ("resolution = 6", "resolution = 6\ndensity = 0.5")],
            "compressibility",
            (0.01 * 0.5 / 3.0_f64).sqrt() / 6.0,
        ),
    ] {
        let text = capsule(replacements);
        let explanation = explained(&text);
        let lattice = explanation.lattice.as_ref().unwrap();
        let shortest = lattice
            .limits
            .iter()
            .min_by(|a, b| a.step.total_cmp(&b.step));
        assert_eq!(shortest.unwrap().name, name);
        tolerance::SCENE_NUMBER.assert(shortest.unwrap().step, limit, limit, name);
        assert!(
            explanation.step_limit.starts_with(name),
            "{}",
            explanation.step_limit
        );
        let scene = valid(&text).scene;
        let step = driver(&scene).step;
        if driver(&scene).density.is_none() {
            assert!(
                (0.8..=0.9).contains(&(step / limit)),
                "{name}: {step} of {limit}"
            );
        } else {
            // Here it is ν = 1/3 that asks for more.
            tolerance::SCENE_NUMBER.assert(
                driver(&scene).lattice_viscosity,
                step * 36.0 / 0.5,
                1.0,
                name,
            );
            assert!((0.32..=0.34).contains(&driver(&scene).lattice_viscosity));
        }
        assert_eq!(warnings(&text), [""; 0]);
    }
}

fn explained(text: &str) -> Explanation {
    valid(text).scene.explain(&[placed(text)])
}

#[test]
fn explanations_have_the_numbers_of_the_lattice() {
    let lines = "resolution = 6\nlattice_viscosity = 0.2\nstep = 0.002";
    let text = capsule(&[("resolution = 6", lines)]);
    let explanation = explained(&text);
    let lattice = explanation.lattice.as_ref().unwrap();
    let number = |formula: &str| {
        let found = lattice.groups.iter().find(|group| group.formula == formula);
        found.unwrap_or_else(|| panic!("{formula}")).value
    };
    let edge = mean_edge(&placed(CAPSULE));
    for (formula, expected) in [
        ("a/spacing", 6.0),
        ("h/spacing", 6.0 * edge),
        ("L_x/a", 7.0),
        ("L_y/a", 7.0),
        ("L_z/a", 7.0),
        ("ν", 0.2),
        ("τ = 3 ν + 1/2", 1.1),
        ("γ̇ step", 3e-4),
        ("√3 U step/spacing", 3_f64.sqrt() * 0.525 * 0.012),
        // ρ is 0.002·5·36 without a density.
        ("3 P step²/(ρ spacing²)", 3.0 * 0.012_f64.powi(2) / 0.36),
        ("γ̇ a² step/(ν spacing²)", 3e-4 * 36.0 * 5.0),
        ("D(L_y) − D(∞) = 2.4 (a/L_y)³", 2.4 / 343.0),
    ] {
        tolerance::SCENE_NUMBER.assert(number(formula), expected, expected, formula);
    }
    // 80/3 of time.
    assert_eq!(lattice.steps, 13_334);
    let nodes = 42_f64.powi(3);
    assert!(lattice.throughput > 0.0 && lattice.coupling > 0.0);
    // What it measures, and two ten millionths of a second a vertex.
    let step = nodes / lattice.throughput + lattice.coupling + 642.0 * 2e-7;
    let minutes = step * 13_334.0 / 60.0;
    tolerance::SCENE_NUMBER.assert(lattice.minutes, minutes, minutes, "minutes");
    // Nineteen populations, a force and a velocity a node; rows and planes are padded.
    let least = nodes * 25.0 * 8.0;
    let found = explanation.memory as f64;
    assert!((1.0..1.2).contains(&(found / least)), "{found} for {least}");
    let half = text.replace("step =", "precision = \"f32\"\nstep =");
    let half = explained(&half).memory as f64;
    assert!((0.5..0.6).contains(&(half / found)), "{half} of {found}");
    let shown = explanation.to_string();
    for part in [
        "lattice-boltzmann   Stokes flow in a box, volumes kept to rounding",
        "42 × 42 × 42 nodes in f64, walls at the ends of y, kernel of 2 nodes an axis",
        "viscosity on the lattice                      0.2  ν",
        "step limit          inertia of the lattice; compressibility = 0.016667 (",
        "13334 steps",
        "step = 0.002, output interval = 0.26667",
        "Ca_G = μγ̇a/G",
    ] {
        assert!(shown.contains(part), "`{part}` is not in:\n{shown}");
    }
    // With a density the Reynolds number is the fluid's.
    let heavy = capsule(&[("resolution = 6", "resolution = 6\ndensity = 0.5")]);
    let heavy = explained(&heavy).lattice.unwrap().groups;
    let found = heavy.iter().find(|group| group.formula == "Re = ρ γ̇ a²/μ");
    tolerance::SCENE_NUMBER.assert(found.unwrap().value, 0.075, 0.075, "Re");
    // Other drivers have none.
    let integral = capsule(&[
        ("lattice-boltzmann", "boundary-integral"),
        ("resolution = 6\n", ""),
    ]);
    assert_eq!(explained(&integral).lattice, None);
}
