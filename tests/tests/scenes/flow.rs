//! Membranes in Stokes flow: the driver boundary-integral.

use super::{generated, parse, parse_with, refused, valid};
use helfrich::Surface;
use helfrich_std::generate::{AnyShape, Family, generate};
use helfrich_std::info::MeshInfo;
use helfrich_std::scene::{
    BoundaryIntegral, Driver, Every, Explanation, Flow, Integrator, MeshSource, Plot, Scene,
    SceneFile, Slice,
};
use helfrich_std::simulation::build;
use helfrich_tests::tolerance;

/// The capsule of Guckenberger et al. 2016, on a coarse mesh: effects from line 8 on.
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
kind = "boundary-integral"
viscosity = 1
flow = { kind = "shear", rate = 0.15 }
strain = 4
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

/// The same in another flow.
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

/// The messages of the warnings, those of the mesh included.
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

#[test]
fn every_key_of_a_flow_is_read() {
    let file = valid(
        r#"
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
"#,
    );
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
        volume_correction: false,
    };
    assert_eq!(driver(scene), expected);
    let surface = &scene.surfaces[0];
    assert_eq!(surface.viscosity_ratio, Some(5.0));
    assert_eq!(surface.membrane_viscosity.unwrap().shear, 0.5);
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
    let scene = valid(CAPSULE).scene;
    let expected = BoundaryIntegral {
        viscosity: 1.0,
        flow: Flow::Shear { rate: 0.15 },
        duration: 4.0 / 0.15,
        integrator: Integrator::Rkc2,
        tolerance: 1e-4,
        volume_correction: true,
    };
    assert_eq!(driver(&scene), expected);
    assert_eq!(scene.output.every, Every::Time(0.01 * expected.duration));
    let soft = capsule(&[("bending = { method = \"B\", modulus = 0.1125 }\n", "")]);
    assert_eq!(driver(&valid(&soft).scene).integrator, Integrator::Bs23);
    let still = capsule(&[
        ("flow = { kind = \"shear\", rate = 0.15 }\n", ""),
        ("strain = 4", "duration = 3"),
    ]);
    let still = valid(&(still + "[[output.plot]]\ncolumn = \"D\"")).scene;
    assert_eq!(driver(&still).flow, Flow::Quiescent);
    assert_eq!(still.output.plots[0].against, "time");
    let often = valid(&(CAPSULE.to_owned() + "[output]\nstrain_interval = 0.3"))
        .scene
        .output
        .every;
    assert_eq!(often, Every::Time(0.3 / 0.15));
}

/// Whatever a flow is called, its velocities are those of the formula in its documentation.
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
        // A shear in the plane of z and x, and the same rate of pure strain.
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
    // Turning as a whole strains nothing.
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
    // Both may be turned over together.
    let sign = n[0].signum();
    for axis in 0..3 {
        tolerance::SCENE_NUMBER.assert(sign * t[axis], along[axis], 1.0, "velocity");
        tolerance::SCENE_NUMBER.assert(sign * n[axis], normal[axis], 1.0, "gradient");
    }
    // A strain has none, nor has a matrix of rank one that is no shear.
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

#[test]
fn keys_of_other_drivers_say_whose_they_are() {
    refused(
        &capsule(&[("strain = 4", "strain = 4\nresidual = 1e-3")]),
        [15, 1],
        &[
            "`residual` belongs to the kind \"relax\"",
            "`driver` is of the kind \"boundary-integral\"",
        ],
    );
    let relaxing = "units = \"none\"\n[[surface]]\nshape = \"sphere\"\nvertices = 42\ntension.value = 1\n[driver]\nkind = \"relax\"\n";
    refused(
        &format!("{relaxing}flow.kind = \"quiescent\""),
        [8, 1],
        &[
            "`flow` belongs to the kind \"boundary-integral\"",
            "of the kind \"relax\"",
        ],
    );
    refused(
        &format!("{relaxing}[output]\ninterval = 3"),
        [9, 12],
        &["\"relax\" has no time", "give `every`"],
    );
    refused(
        &format!("{relaxing}[output]\nstrain_interval = 3"),
        [9, 19],
        &["`strain_interval`", "give `every`"],
    );
    refused(
        &format!("{relaxing}[[output.slice]]\nnormal = [0, 0, 1]\nsize = [1, 1]\npoints = [2, 2]"),
        [8, 1],
        &["a slice shows the fluid", "\"relax\" has none"],
    );
    refused(
        &(CAPSULE.to_owned() + "[output]\nevery = 3"),
        [16, 9],
        &["goes by time", "give `interval`", "`strain_interval`"],
    );
    refused(
        &with_flow("kind = \"shear\", rate = 1, gradient = [[0, 1, 0], [0, 0, 0], [0, 0, 0]]"),
        [13, 36],
        &["`gradient` belongs to the kind \"linear\""],
    );
    refused(
        &with_flow("kind = \"linear\", rate = 1, gradient = [[0, 1, 0], [0, 0, 0], [0, 0, 0]]"),
        [13, 27],
        &["`rate` belongs to the kind \"shear\" or \"extension\" or \"plane-extension\""],
    );
}

#[test]
fn wrong_flows_say_what_is_needed() {
    refused(
        &with_flow("kind = \"shear\""),
        [13, 8],
        &["`driver.flow` lacks `rate`: a number, other than 0 is needed"],
    );
    refused(
        &with_flow("kind = \"shear\", rate = 0"),
        [13, 33],
        &["`rate` is 0: a number other than 0 is needed"],
    );
    refused(
        &with_flow("kind = \"sheer\", rate = 1"),
        [13, 17],
        &["did you mean `shear`?"],
    );
    let linear = |gradient: &str| with_flow(&format!("kind = \"linear\", gradient = {gradient}"));
    refused(
        &linear("[[1, 0, 0], [0, -0.5, 0], [0, 0, -0.49]]"),
        [13, 38],
        &["the trace of this gradient is 0.01", "add up to 0"],
    );
    // Relative to its size, and but for rounding.
    valid(&linear(
        "[[1e9, 0, 0], [0, -333333333.3333333, 0], [0, 0, -666666666.6666667]]",
    ));
    refused(
        &linear("[[1e-9, 0, 0], [0, 0, 0], [0, 0, 0]]"),
        [13, 38],
        &["the trace of this gradient is 0.000000001"],
    );
    refused(
        &capsule(&[
            (
                "kind = \"shear\", rate = 0.15",
                "kind = \"linear\", gradient = [[0, 0, 0], [0, 0, 0], [0, 0, 0]]",
            ),
            ("strain = 4", "duration = 4"),
        ]),
        [13, 38],
        &["this gradient is 0", "kind = \"quiescent\""],
    );
    refused(
        &linear("[[0, 1], [0, 0, 0], [0, 0, 0]]"),
        [13, 39],
        &["`gradient` is a list of 2: a list of 3 numbers is needed"],
    );
    refused(
        &linear("[[0, 1, 0], [0, 0, 0]]"),
        [13, 38],
        &["`gradient` is a list of 2: a list of 3 lists of 3 numbers is needed"],
    );
    refused(
        &linear("[[0, 1, 0], [0, true, 0], [0, 0, 0]]"),
        [13, 54],
        &["`gradient` is true or false: a number is needed"],
    );
}

#[test]
fn wrong_ends_and_steps_are_refused() {
    let refused = |old: &str, new: &str, at: [usize; 2], parts: &[&str]| {
        refused(&capsule(&[(old, new)]), at, parts);
    };
    refused(
        "strain = 4\n",
        "",
        [10, 1],
        &["`driver` has neither `duration` nor `strain`"],
    );
    refused(
        "strain = 4",
        "strain = 4\nduration = 3",
        [14, 1],
        &["has both `duration` and `strain`"],
    );
    refused("viscosity = 1\n", "", [10, 1], &["lacks `viscosity`"]);
    for still in [
        "kind = \"quiescent\"",
        "kind = \"linear\", gradient = [[0, 1, 0], [-1, 0, 0], [0, 0, 0]]",
    ] {
        refused(
            "kind = \"shear\", rate = 0.15",
            still,
            [14, 10],
            &["strains nothing: give `duration`"],
        );
    }
    refused(
        "rate = 0.15",
        "rate = 1e-308",
        [14, 10],
        &["the run would last inf"],
    );
    refused(
        "strain = 4",
        "strain = 4\nintegrator = \"rk4\"",
        [15, 14],
        &["rk4 has no error control, and needs a `step`"],
    );
    refused(
        "strain = 4",
        "strain = 4\nstep = 0.1",
        [15, 8],
        &["`step` is for integrator = \"rk4\""],
    );
    refused(
        "strain = 4",
        "strain = 4\n[output]\ninterval = 1\nstrain_interval = 2",
        [17, 1],
        &["has both `interval` and `strain_interval`"],
    );
}

#[test]
fn wrong_slices_are_refused() {
    let slice = |lines: &str| format!("{CAPSULE}[[output.slice]]\nnormal = [0, 0, 1]\n{lines}");
    refused(
        &slice("size = [1, 0]\npoints = [2, 2]"),
        [17, 12],
        &["`size` is 0: a number above 0"],
    );
    refused(
        &slice("size = [1, 1, 1]\npoints = [2, 2]"),
        [17, 8],
        &["`size` is a list of 3: a list of 2 numbers is needed"],
    );
    refused(
        &slice("size = [1, 1]\npoints = [2, 1]"),
        [18, 14],
        &["`points` is 1", "from 2 to"],
    );
    refused(
        &slice("size = [1, 1]\npoints = [10000, 10000]"),
        [18, 10],
        &["100000000 points are too many for a slice"],
    );
    let two = slice("size = [1, 1]\npoints = [2, 2]\nname = \"slice-2\"\n");
    refused(
        &format!("{two}[[output.slice]]\nnormal = [1, 0, 0]\nsize = [1, 1]\npoints = [2, 2]"),
        [20, 1],
        &["slice 1 has the name \"slice-2\" of slice 0"],
    );
}

#[test]
fn membranes_resist_the_flow() {
    let effects = "bending = { method = \"B\", modulus = 0.1125 }\nelasticity = { law = \"neo-hookean\", shear_modulus = 1 }\n";
    for (instead, resists) in [
        ("", false),
        ("volume.modulus = 1\n", false),
        ("area.modulus = 1\n", true),
        ("tension.value = 1\n", true),
        ("local_area.modulus = 1\n", true),
    ] {
        let text = capsule(&[(effects, instead)]);
        if resists {
            valid(&text);
        } else {
            refused(
                &text,
                [2, 1],
                &["nothing in \"capsule\" resists deformation"],
            );
        }
    }
    refused(
        &capsule(&[(
            "[driver]",
            "stretching = { axis = [1, 0, 0], force = [1, 2] }\n[driver]",
        )]),
        [10, 42],
        &["a sequence of forces", "give one force"],
    );
}

/// Only forces move membranes in a flow; volumes, which the flow itself keeps, are the exception.
#[test]
fn areas_are_not_held_exactly_in_a_flow() {
    for key in ["area", "area_difference"] {
        let held = format!("{key}.constraint = \"exact\"\n[driver]");
        let column = key.len() + 15;
        let said = format!("the `{key}` of \"capsule\" cannot be held exactly");
        refused(
            &capsule(&[("[driver]", &held)]),
            [10, column],
            &[&said, "give a `modulus`"],
        );
    }
    valid(&capsule(&[(
        "[driver]",
        "volume.constraint = \"exact\"\n[driver]",
    )]));
}

#[test]
fn a_viscosity_ratio_needs_a_closed_mesh() {
    let file = valid(&capsule(&[("[driver]", "viscosity_ratio = 5\n[driver]")]));
    let closed = generated(&file, 0);
    file.check_mesh(0, &closed).unwrap();
    let open = MeshInfo {
        volume: None,
        boundary_edges: 7,
        ..closed
    };
    let message = file.check_mesh(0, &open).unwrap_err().to_string();
    assert!(
        message.starts_with(
            "folder/cell.toml:10:19: `viscosity_ratio` needs an enclosed volume, and the mesh of \
             \"capsule\" has 7 boundary edges"
        ),
        "{message}"
    );
    valid(CAPSULE).check_mesh(0, &open).unwrap();
    let same = valid(&capsule(&[("[driver]", "viscosity_ratio = 1\n[driver]")]));
    same.check_mesh(0, &open).unwrap();
}

#[test]
fn what_is_doubtful_in_flow_is_warned_of() {
    assert_eq!(warnings(&valid(CAPSULE)), [""; 0]);
    warned(
        &capsule(&[("method = \"B\"", "method = \"A\"")]),
        8,
        &["kantor-nelson (A)", "37 to 43 % too much"],
    );
    warned(
        &capsule(&[("strain = 4", "strain = 4\nvolume_correction = false")]),
        15,
        &["volumes drift"],
    );
    let held = capsule(&[
        ("strain = 4", "strain = 4\nvolume_correction = false"),
        ("[driver]", "volume.constraint = \"exact\"\n[driver]"),
    ]);
    assert_eq!(warnings(&valid(&held)), [""; 0]);
    warned(
        &capsule(&[("[driver]", "pressure.value = 1\n[driver]")]),
        10,
        &["`pressure` does nothing to \"capsule\""],
    );
    // A weight is carried by the fluid.
    let heavy = capsule(&[(
        "[driver]",
        "gravity = { density_difference = 1, acceleration = [0, 0, -1] }\n[driver]",
    )]);
    assert_eq!(warnings(&valid(&heavy)), [""; 0]);

    let bending = "bending = { method = \"B\", modulus = 0.1125 }\n";
    let soft = capsule(&[(bending, "")]);
    warned(
        &soft,
        8,
        &["Ca_G = 0.150, below about 0.45", "add [surface.bending]"],
    );
    let fast = capsule(&[(bending, ""), ("rate = 0.15", "rate = 0.46")]);
    assert_eq!(warnings(&valid(&fast)), [""; 0]);

    for (method, part) in [
        ("B", "100 times shorter"),
        ("C", "200 times shorter"),
        ("E", "grow without end"),
    ] {
        for family in ["irregular", "hard"] {
            let text = capsule(&[
                ("\"B\"", &format!("\"{method}\"")),
                ("\"regular\"", &format!("\"{family}\"")),
            ]);
            warned(
                &text,
                8,
                &["the mesh of \"capsule\" is uneven", part, "choose j4"],
            );
        }
    }
    let robust = capsule(&[("\"B\"", "\"j4\""), ("\"regular\"", "\"irregular\"")]);
    assert_eq!(warnings(&valid(&robust)), [""; 0]);
    // A mesh file is judged by its angles and valences.
    let file = valid(CAPSULE);
    let slivers = MeshInfo {
        angles: [2.0, 150.0],
        ..generated(&file, 0)
    };
    assert_eq!(file.mesh_warnings(0, &slivers).len(), 1);

    let tube = |radius: f64, through: f64| {
        with_flow(&format!(
            "kind = \"poiseuille\", centre_velocity = 1, radius = {radius}, direction = [1, 0, 0], through = [7, 0, {through}]"
        ))
    };
    assert_eq!(warnings(&valid(&tube(1.1, 0.0))), [""; 0]);
    warned(
        &tube(0.9, 0.0),
        13,
        &["\"capsule\" reaches 1.000 from the axis", "turns round"],
    );
    warned(&tube(1.1, 0.5), 13, &["reaches 1.500 from the axis"]);
}

#[test]
fn overrides_change_flow_surface_and_law() {
    let set = |overrides: &[&str]| {
        let file = parse_with(CAPSULE, overrides);
        file.unwrap_or_else(|errors| panic!("{errors}")).scene
    };
    let scene = set(&[
        "driver.flow.rate=0.3",
        "surface.0.bending.modulus=0.0025",
        "surface.0.vertices=2562",
        "surface.0.viscosity_ratio=5",
        "surface.0.elasticity.law=skalak",
        "surface.0.elasticity.area_ratio=1",
        "driver.strain=10",
    ]);
    let surface = &scene.surfaces[0];
    assert_eq!(driver(&scene).flow, Flow::Shear { rate: 0.3 });
    assert_eq!(driver(&scene).duration, 10.0 / 0.3);
    assert_eq!(surface.bending.unwrap().modulus, 0.0025);
    assert!(matches!(
        surface.source,
        MeshSource::Shape { vertices: 2562, .. }
    ));
    assert_eq!(surface.viscosity_ratio, Some(5.0));
    assert_eq!(surface.elasticity.as_ref().unwrap().law.area_modulus(), 3.0);
    let flow = driver(&set(&["driver.flow.kind=extension"])).flow;
    assert_eq!(flow, Flow::Extension { rate: 0.15 });
    let slice = CAPSULE.to_owned()
        + "[[output.slice]]\nnormal = [0, 0, 1]\nsize = [1, 1]\npoints = [2, 2]\n";
    let scene = parse_with(&slice, &["output.slice.slice-1.points=[5, 6]"]).unwrap();
    assert_eq!(scene.scene.output.slices[0].points, [5, 6]);
    let errors = parse_with(CAPSULE, &["surface.0.elasticity.law=skalak"]).unwrap_err();
    assert!(errors.to_string().contains("lacks `area_ratio`"));
}

#[test]
fn units_of_flows_are_checked() {
    let micro = capsule(&[("\"none\"", "\"micro\"")]);
    let error = |old: &str, new: &str| {
        let text = micro.replace(old, new);
        parse(&text).expect_err(&text).to_string()
    };
    for (old, new, part) in [
        (
            "viscosity = 1",
            "viscosity = \"1 Pa\"",
            "a viscosity, pressure·time in pN·s/µm² is needed, such as \"1.2 mPa s\"",
        ),
        (
            "rate = 0.15",
            "rate = \"3 s\"",
            "`rate` is a time, \"3 s\": a rate, 1/time in 1/s is needed, such as \"100 1/s\"",
        ),
        (
            "strain = 4",
            "duration = \"3 µm\"",
            "a time in s is needed, such as \"2 ms\"",
        ),
    ] {
        let message = error(old, new);
        assert!(message.contains(part), "{message}");
    }
}

/// A shape's volume is that of fine meshes on it, which differ from it in second order.
#[test]
fn shapes_have_the_volume_of_fine_meshes() {
    for shape in [
        "sphere:1.5",
        "ellipsoid:1,2,0.7",
        "torus:2,0.6",
        "discocyte:3.9",
    ] {
        let shape: AnyShape = shape.parse().unwrap();
        let error = |vertices| {
            let made = generate(&shape, Family::Smooth, vertices, 1).unwrap();
            let surface = Surface::new(&made.mesh, &made.positions).unwrap();
            1.0 - surface.volume().unwrap() / shape.volume()
        };
        let vertices = match shape {
            AnyShape::Torus(_) => [2500, 10_000],
            _ => [2562, 10_242],
        };
        let [coarse, fine] = vertices.map(error);
        tolerance::FINE_MESH_VOLUME.assert(fine, 0.0, 1.0, &shape.to_string());
        let order = (coarse / fine).log2();
        assert!((order - 2.0).abs() < 0.2, "{shape}: {order}");
    }
}

#[test]
fn meshes_enclose_the_volume_of_their_shape() {
    for (shape, scale) in [("sphere:1", 1.0), ("ellipsoid:1,2,0.7", 3.0)] {
        let text = capsule(&[("sphere:1", shape)])
            .replace("vertices", &format!("scale = {scale}\nvertices"));
        let volume = |text: &str| {
            let (simulation, positions) = build(&valid(text)).unwrap();
            let body = &simulation.bodies()[0];
            (
                body.surface(&positions).unwrap().volume().unwrap(),
                simulation,
                positions,
            )
        };
        let expected = shape.parse::<AnyShape>().unwrap().volume() * f64::powi(scale, 3);
        let (found, mut simulation, positions) = volume(&text);
        tolerance::SCENE_NUMBER.assert(found, expected, expected, shape);
        // The scaled mesh is the one without stress.
        let acting = simulation.resolve(&positions);
        let elastic = acting.iter().find(|acting| acting.effect == "elasticity");
        let elastic = elastic.unwrap().energy;
        tolerance::SCENE_NUMBER.assert(elastic, 0.0, expected, shape);
        let (inscribed, ..) = volume(&text.replace("match_volume = true\n", ""));
        assert!(inscribed < expected * (1.0 - 1e-3), "{shape}: {inscribed}");
        // A reference on another shape is treated as the surface is.
        let named = text.replace(
            "shear_modulus = 1",
            &format!("shear_modulus = 1, reference = {{ shape = \"{shape}\", scale = {scale} }}"),
        );
        let (_, mut simulation, positions) = volume(&named);
        let elastic = simulation.resolve(&positions)[1].energy;
        tolerance::SCENE_NUMBER.assert(elastic, 0.0, expected, shape);
    }
}

fn explained(text: &str) -> Explanation {
    let file = valid(text);
    file.scene.explain(&[generated(&file, 0)])
}

fn group(explanation: &Explanation, name: &str, formula: &str) -> Option<f64> {
    let groups = &explanation.surfaces[0].groups;
    let found =
        |group: &&helfrich_std::scene::Group| group.name == name && group.formula == formula;
    groups.iter().find(found).map(|group| group.value)
}

/// The numbers of the paper's case by both conventions, and those of the theory.
#[test]
fn groups_are_named_by_both_conventions() {
    let explanation = explained(CAPSULE);
    let cases = [
        ("capillary number by G", "Ca_G = μγ̇a/G", 0.15),
        ("capillary number by E_s = 3 G", "Ca_E = μγ̇a/E_s", 0.05),
        ("bending number by G", "b = κ/(a² G)", 0.1125),
        ("bending number by E_s = 3 G", "κ/(a² E_s)", 0.0375),
        ("capillary number by κ", "Ca_κ = μγ̇a³/κ", 4.0 / 3.0),
        ("viscosity inside over outside", "λ", 1.0),
        (
            "expected D, theory for Ca_G → 0",
            "(25/12) Ca_G/(1 + 11 b)",
            0.3125 / 2.2375,
        ),
    ];
    for (name, formula, expected) in cases {
        let found = group(&explanation, name, formula).unwrap_or_else(|| panic!("{formula}"));
        tolerance::SCENE_NUMBER.assert(found, expected, expected, formula);
    }
    let text = explanation.to_string();
    for part in [
        "sphere:1, regular, of its volume",
        "Reynolds number 0",
        "volumes kept to rounding",
        "strain = 4",
        "shear, u = (γ̇ y, 0, 0); rate = 0.15",
        "rkc2: \"capsule\" bends",
        "output interval = 0.26667",
        "a factor of 3",
        "theory",
        "λ",
    ] {
        assert!(text.contains(part), "`{part}` is not in:\n{text}");
    }
    // Skalak's law with C = 2, without bending and with another size.
    let text = capsule(&[
        ("bending = { method = \"B\", modulus = 0.1125 }\n", ""),
        (
            "\"neo-hookean\", shear_modulus = 1",
            "\"skalak\", shear_modulus = 3, area_ratio = 2",
        ),
        ("sphere:1", "sphere:2"),
    ]);
    let explanation = explained(&text);
    let found = group(
        &explanation,
        "expected D, theory for Ca_G → 0",
        "(5/4)(2 + 3 C) Ca_G/(1 + 2 C + (15 + 18 C) b)",
    );
    let expected = 1.25 * 8.0 * 0.1 / 5.0;
    tolerance::SCENE_NUMBER.assert(found.unwrap(), expected, expected, "Skalak");
    assert!(explanation.to_string().contains("bs23: nothing bends"));
    // No sphere, no shear, not alone: no theory.
    for text in [
        capsule(&[("sphere:1", "ellipsoid:1,1,0.9")]),
        with_flow("kind = \"extension\", rate = 0.15"),
        capsule(&[("[driver]", "tension.value = 1\n[driver]")]),
        capsule(&[(
            "shear_modulus = 1",
            "shear_modulus = 1, reference.scale = 0.9",
        )]),
    ] {
        let text = explained(&text).to_string();
        assert!(!text.contains("expected D"), "{text}");
        assert!(!text.contains("the theory gives"), "{text}");
    }
}

/// `ρ/γ̇ = (1/Ca) max{0.355 (K_s/G + 1)(a/h), 2.65 b (a/h)³}` of method B on icospheres, whose mean
/// edge is h but for a little.
#[test]
fn the_step_limit_is_estimated() {
    for (rate, b, law, ratio) in [
        (0.15, 0.1125, "law = \"neo-hookean\"", 3.0),
        (0.6, 1e-4, "law = \"skalak\", area_ratio = 1.5", 4.0),
    ] {
        let text = capsule(&[
            ("rate = 0.15", &format!("rate = {rate}")),
            ("modulus = 0.1125", &format!("modulus = {b}")),
            ("law = \"neo-hookean\"", law),
        ]);
        let file = valid(&text);
        let MeshSource::Shape {
            shape,
            family,
            vertices,
            seed,
            ..
        } = &file.scene.surfaces[0].source
        else {
            panic!("no shape");
        };
        let made = generate(shape, *family, *vertices, *seed).unwrap();
        let surface = Surface::new(&made.mesh, &made.positions).unwrap();
        let edges = made.mesh.edges();
        let length = |edge: &[u32; 2]| {
            let [x, y, z] = surface.difference(edge[0], edge[1]);
            x.hypot(y).hypot(z)
        };
        let fine = edges.len() as f64 / edges.iter().map(length).sum::<f64>();
        // μ = a = G = 1.
        let capillary = rate;
        let stretch: f64 = 0.355 * (ratio + 1.0) * fine;
        let bending = 2.65 * b * fine.powi(3);
        let expected = rate / capillary * stretch.max(bending);
        let explanation = explained(&text);
        let found = explanation.spectral_radius.unwrap();
        tolerance::MEAN_EDGE.assert(found, expected, expected, law);
        assert!(
            explanation.step_limit.contains("estimate Δt = "),
            "{}",
            explanation.step_limit
        );
    }
    for text in [
        capsule(&[("\"B\"", "\"J\"")]),
        capsule(&[("\"regular\"", "\"irregular\"")]),
    ] {
        let explanation = explained(&text);
        assert_eq!(explanation.spectral_radius, None);
        assert!(explanation.step_limit.contains("power iteration"));
    }
}
