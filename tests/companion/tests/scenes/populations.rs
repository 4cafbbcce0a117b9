//! Populations: equal surfaces at random places of a box.

use super::{generated, refused, the_error, valid};
use helfrich::interaction::RepulsionMemory;
use helfrich::{Images, Repulsion};
use helfrich_std::contact::repel;
use helfrich_std::dynamics::Problem;
use helfrich_std::execute::Parallel;
use helfrich_std::scene::{Driver, Overrides, Scene, SceneFile};
use helfrich_std::simulation::{Simulation, build};
use std::path::Path;

const GAP: f64 = 0.1;

/// Populations in a box of this length with walls at the ends of y.
fn scene(populations: &str, length: f64, more: &str) -> String {
    format!(
        r#"units = "none"
{populations}
elasticity = {{ law = "skalak", shear_modulus = 1, area_ratio = 10 }}
[driver]
kind = "lattice-boltzmann"
viscosity = 1
spacing = 0.2
box = [{length}, {length}, {length}]
flow = {{ kind = "shear", rate = 0.1 }}
strain = 1
{more}"#
    )
}

fn cells(shape: &str, number: &str) -> String {
    format!(
        "[[population]]\nname = \"cells\"\n{number}\nshape = \"{shape}\"\nvertices = 362\ngap = {GAP}"
    )
}

/// The scene and where its vertices are, surface by surface.
fn places(text: &str) -> (Scene, Vec<Vec<[f64; 3]>>) {
    let file = valid(text);
    let (simulation, positions) = build(&file).unwrap_or_else(|error| panic!("{error}"));
    let bodies = simulation.bodies().iter();
    let places = bodies.map(|body| positions[body.vertices()].to_vec());
    let places = places.collect();
    (file.scene, places)
}

/// The energy of a repulsion of this range between all surfaces and obstacles of a scene, with images: 0 if no vertex is
/// nearer to a triangle of another body.
fn felt((simulation, positions): &(Simulation, Vec<[f64; 3]>), range: f64) -> f64 {
    let bodies = simulation.bodies().iter();
    let bodies = bodies.map(|body| body.surface(positions).expect("finite"));
    let solids = simulation.obstacles().iter();
    let solids = solids
        .map(|solid| helfrich::Surface::new(&solid.mesh, &solid.positions[..]).expect("finite"));
    let surfaces = Vec::from_iter(bodies.chain(solids));
    let repulsion = Repulsion {
        modulus: 1.0,
        range,
        attraction: 0.0,
        parts: false,
        first_group: None,
        images: Images {
            own: true,
            ..*simulation.images()
        },
    };
    let mut forces = Vec::from_iter(
        surfaces
            .iter()
            .map(|one| vec![[0.0; 3]; one.positions().len()]),
    );
    let mut forces = Vec::from_iter(forces.iter_mut().map(|force| &mut force[..]));
    let mut memory = RepulsionMemory::default();
    repel(
        &Parallel::new(),
        &repulsion,
        &surfaces,
        &mut memory,
        &mut forces,
    )
}

/// Spheres and red cells fill the demanded part of a box, away from each other, from images and from walls.
#[test]
fn surfaces_keep_their_gap() {
    for (shape, part, length) in [("sphere:1", 0.45, 8.0), ("discocyte:1", 0.3, 5.0)] {
        let text = scene(&cells(shape, &format!("haematocrit = {part}")), length, "");
        let file = valid(&text);
        let Driver::LatticeBoltzmann(lattice) = file.scene.driver else {
            panic!("{:?}", file.scene.driver);
        };
        let built = build(&file).expect("a scene");
        let (simulation, positions) = &built;
        let volumes = simulation.bodies().iter();
        let volumes = volumes.map(|body| body.surface(positions).and_then(|at| at.volume()));
        let volumes = Vec::from_iter(volumes.map(|volume| volume.expect("closed")));
        let filled = volumes.iter().sum::<f64>() / lattice.size().iter().product::<f64>();
        // The number of surfaces is rounded.
        let one = 0.5 * volumes[0] / lattice.size().iter().product::<f64>();
        assert!((filled - part).abs() <= 1.001 * one, "{shape}: {filled}");
        assert_eq!(felt(&built, GAP), 0.0, "{shape}");
        let [low, high] = lattice.corners();
        for place in positions {
            assert!(
                place[1] > low[1] + GAP && place[1] < high[1] - GAP,
                "{shape}"
            );
        }
        // They are near each other: the test sees vertices that are.
        assert!(felt(&built, 5.0 * GAP) > 0.0, "{shape}");
    }
}

/// The same seed gives the same places, another one others; orientations are random unless they are fixed.
#[test]
fn places_follow_from_the_seed() {
    let text = |more: &str| {
        scene(
            &cells("ellipsoid:1,1,0.4", &format!("count = 6\n{more}")),
            6.0,
            "",
        )
    };
    let [first, again, other, fixed] = [
        "seed = 2",
        "seed = 2",
        "seed = 3",
        "orientation = \"fixed\"",
    ]
    .map(|more| places(&text(more)).1);
    assert_eq!(first, again);
    assert_ne!(first, other);
    let height = |place: &Vec<[f64; 3]>| {
        let heights = place.iter().map(|x| x[2]);
        heights.clone().fold(f64::MIN, f64::max) - heights.fold(f64::MAX, f64::min)
    };
    assert!(fixed.iter().all(|place| (height(place) - 0.8).abs() < 0.02));
    assert!(first.iter().any(|place| height(place) > 1.0));
}

/// Populations of several kinds, surfaces and obstacles share a box; populations come last.
#[test]
fn all_bodies_keep_their_gap() {
    let populations = format!(
        "[[obstacle]]\nname = \"ball\"\nshape = \"sphere:1.5\"\nvertices = 362\n{}\n{}\n{}",
        "[[surface]]\nname = \"alone\"\nshape = \"sphere:1\"\nvertices = 362\nposition = [2.9, 0, 2.9]\nelasticity = { law = \
         \"skalak\", shear_modulus = 1, area_ratio = 10 }",
        cells("discocyte:1", "count = 20"),
        "elasticity = { law = \"skalak\", shear_modulus = 1, area_ratio = 10 }\n[[population]]\nname = \"drops\"\ncount = 12\nshape = \
         \"sphere:0.5\"\nvertices = 162\ngap = 0.1",
    );
    let text = scene(&populations, 8.0, "");
    let (scene, places) = places(&text);
    let ranges = Vec::from_iter(scene.populations.iter().map(|one| one.surfaces.clone()));
    assert_eq!(ranges, [1..21, 21..33]);
    assert_eq!(places.len(), 33);
    assert_eq!(scene.surfaces[20].name, "cells-20");
    assert_eq!(scene.surfaces[32].name, "drops-12");
    assert_eq!(felt(&build(&valid(&text)).expect("a scene"), GAP), 0.0);
}

/// The scene of a text in this folder.
fn in_folder(folder: &Path, text: &str) -> Result<SceneFile, String> {
    let path = folder.join("a.toml");
    SceneFile::parse(text, &path, &Overrides::default()).map_err(|error| error.to_string())
}

/// Surfaces stand where a file says, as if each had its position and orientation, and random ones keep away from them.
#[test]
fn places_are_those_of_a_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let list = "x,y,z\n1.5, 0.25, -1\n# turned\n\n-1;0.5;1;0;1;2;40\n0 0 0\n";
    std::fs::write(folder.path().join("places.csv"), list).expect("a file");
    let given = cells("ellipsoid:1,1,0.4", "places = \"places.csv\"").replace("gap = 0.1", "");
    let alone = |position: &str, more: &str| {
        let surface = given.replace(
            "[[population]]\nname = \"cells\"\nplaces = \"places.csv\"",
            "",
        );
        format!(
            "[[surface]]{surface}\nposition = [{position}]\n{more}\nelasticity = {{ law = \"skalak\", shear_modulus = 1, \
             area_ratio = 10 }}\n"
        )
    };
    let turned = "orientation = { axis = [0, 1, 2], angle = 40 }";
    let surfaces =
        alone("1.5, 0.25, -1", "") + &alone("-1, 0.5, 1", turned) + &alone("0, 0, 0", "");
    let surfaces = surfaces.trim_end();
    let elasticity = "elasticity = { law = \"skalak\", shear_modulus = 1, area_ratio = 10 }";
    let surfaces = surfaces.strip_suffix(elasticity).expect("the last");
    let positions = |populations: &str| {
        let file = in_folder(folder.path(), &scene(populations, 8.0, "")).expect("valid");
        build(&file).unwrap_or_else(|error| panic!("{error}"))
    };
    let found = positions(&given);
    assert_eq!(found.0.bodies()[2].name(), "cells-3");
    assert_eq!(found.1, positions(surfaces).1);
    let balls = cells("sphere:0.5", "count = 30").replace("cells", "balls");
    let both = positions(&format!("{balls}\n{elasticity}\n{given}"));
    assert_eq!(both.0.bodies().len(), 33);
    assert_eq!(both.1[both.0.bodies()[30].vertices()], found.1[..362]);
    assert_eq!(felt(&both, GAP), 0.0);
}

#[test]
fn files_without_places_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = scene(
        &cells("sphere:1", "places = \"places.csv\"").replace("gap = 0.1", ""),
        8.0,
        "",
    );
    for (list, expected) in [
        (None, "No such file"),
        (Some("# none\n\n"), "there is no place"),
        (
            Some("0, 0, 0\n0, 0\n"),
            "line 2 has not three finite numbers",
        ),
        (Some("0, 0, NaN\n"), "line 1 has not three"),
        (
            Some("x,y\n0,0,1,0,0,0,9\n"),
            "line 2 has an angle about an axis",
        ),
    ] {
        if let Some(list) = list {
            std::fs::write(folder.path().join("places.csv"), list).expect("a file");
        }
        let message = in_folder(folder.path(), &text).expect_err("no places");
        assert!(
            message.contains(expected) && message.contains("a.toml:4:"),
            "{message}"
        );
    }
    let message = in_folder(
        folder.path(),
        &text.replace("places =", "gap = 1\nplaces ="),
    );
    assert!(message.is_err_and(|message| message.contains("gap")));
}

#[test]
fn populations_without_room_are_refused() {
    refused(
        &scene(&cells("sphere:1", "haematocrit = 0.7"), 8.0, ""),
        [4, 15],
        &[
            "surfaces of \"cells\" in the box",
            "% of their size fit",
            "choose fewer",
        ],
    );
    refused(
        &scene(&cells("sphere:1", "count = 1"), 2.05, ""),
        [4, 9],
        &["a body is", "long, with its gap, and the box"],
    );
    refused(
        &scene(&cells("sphere:1", "haematocrit = 0.001"), 8.0, ""),
        [4, 15],
        &["would have 0 surfaces of \"cells\"", "choose more"],
    );
    refused(
        &scene(&cells("sphere:1", "count = 9000000000000"), 8.0, ""),
        [4, 9],
        &["GB of memory", "choose fewer"],
    );
    let text = scene(&cells("sphere:1", "count = 4"), 8.0, "");
    let (_, message) = the_error(&text.replace("box = [8, 8, 8]\n", ""));
    assert!(message.contains("has to be given by `box`"), "{message}");
    let relax = text.split("[driver]").next().expect("a text");
    let (_, message) = the_error(&format!("{relax}[driver]\nkind = \"relax\"\n"));
    assert!(message.contains("fills the box of the driver"), "{message}");
    let (_, message) = the_error("units = \"none\"\n[driver]\nkind = \"relax\"\n");
    assert!(
        message.contains("add a [[surface]], or a [[population]]"),
        "{message}"
    );
}

/// Surfaces that have left the box by its open ends are moved back by whole periods, those between walls are not.
#[test]
fn surfaces_are_shown_within_the_box() {
    let built = build(&valid(&scene(&cells("sphere:1", "count = 5"), 8.0, "")));
    let (simulation, positions) = built.unwrap_or_else(|error| panic!("{error}"));
    let within = simulation.within_period([-4.0; 3], &positions);
    assert_eq!(within, positions);
    let mut away = positions.clone();
    for (number, body) in simulation.bodies().iter().enumerate() {
        let number = number as f64;
        for at in &mut away[body.vertices()] {
            *at = [at[0] + 8.0 * number, at[1] + 8.0, at[2] - 16.0 * number];
        }
    }
    let back = simulation.within_period([-4.0; 3], &away);
    for (found, at) in back.iter().zip(&positions) {
        let expected = [at[0], at[1] + 8.0, at[2]];
        assert!((0..3).all(|axis| (found[axis] - expected[axis]).abs() < 1e-13));
    }
}

/// Problems with one kind of surface are said once, at its table.
#[test]
fn problems_are_said_once() {
    let text =
        scene(&cells("sphere:1", "count = 9"), 8.0, "").replace("vertices = 362", "vertices = 42");
    let file = SceneFile::parse(&text, Path::new("a.toml"), &Overrides::default()).expect("valid");
    let (simulation, _) = build(&file).expect("a scene");
    let coarse = simulation.warnings().iter().map(ToString::to_string);
    let coarse =
        Vec::from_iter(coarse.filter(|warning| warning.contains("nodes long in the mean")));
    assert_eq!(coarse.len(), 1, "{coarse:?}");
    assert!(coarse[0].contains("a.toml:6:"), "{}", coarse[0]);
}

/// Two populations and an obstacle, with a repulsion between what `between` names, if it names any.
fn two_populations(between: &str) -> String {
    let small = "elasticity = { law = \"skalak\", shear_modulus = 1, area_ratio = 10 }\n[[population]]\nname = \
                 \"small\"\ncount = 4\nshape = \"sphere:0.5\"\nvertices = 162\nseed = 3";
    let more = format!(
        "[[obstacle]]\nname = \"post\"\nshape = \"sphere:0.6\"\nvertices = 162\n[[interaction]]\nkind = \
         \"repulsion\"\nstrength = 1\ncutoff = 1.5\n{between}"
    );
    scene(
        &format!("{}\n{small}", cells("sphere:1", "count = 6")),
        6.0,
        &more,
    )
}

/// `between` takes populations: all pairs of surfaces are those within each population, and those of both.
#[test]
fn populations_interact_by_their_names() {
    let energy = |between: &str| {
        let file = valid(&two_populations(between));
        let (mut simulation, positions) = build(&file).expect("a scene");
        let mut force = vec![[0.0; 3]; positions.len()];
        simulation.evaluate(&positions, &mut force).energy
    };
    let pairs = [
        ["cells", "cells"],
        ["small", "small"],
        ["small", "cells"],
        ["cells", "post"],
        ["post", "small"],
    ];
    let parts = pairs.map(|[a, b]| energy(&format!("between = [\"{a}\", \"{b}\"]")));
    let all = energy("");
    assert!(parts.iter().all(|part| *part > 0.0), "{parts:?}");
    // On a lattice, surfaces meet an obstacle only if it is named.
    let sum = parts[..3].iter().sum::<f64>();
    assert!((sum - all).abs() < 1e-12 * all, "{sum} of {all}");
    let single = energy("between = [\"cells-2\", \"small\"]");
    assert!(
        single > 0.0 && single < parts[2],
        "{single} of {}",
        parts[2]
    );
}

#[test]
fn names_of_populations_are_checked() {
    let message = |between: &str| {
        let text = two_populations(&format!("between = {between}"));
        super::parse(&text).expect_err("refused").to_string()
    };
    let part = message("[\"cells\", \"cells-3\"]");
    assert!(part.contains("without common surfaces"), "{part}");
    let near = message("[\"cells\", \"smal\"]");
    assert!(near.contains("`small`"), "{near}");
    // Not the name of every cell.
    let unknown = message("[\"cells\", \"platelets\"]");
    assert!(unknown.contains("post, cells, small"), "{unknown}");
    let explained = valid(&two_populations("between = [\"small\", \"cells\"]"));
    let meshes =
        Vec::from_iter((0..explained.scene.surfaces.len()).map(|one| generated(&explained, one)));
    let text = explained.scene.explain(&meshes).to_string();
    assert!(text.contains("between small and cells"), "{text}");
}
