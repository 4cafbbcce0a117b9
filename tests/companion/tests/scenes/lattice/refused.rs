//! Refusal of impossible lattices.

use super::super::{refused, valid};
use super::{capsule, placed, unbuildable, warnings};
use helfrich::Surface;
use helfrich_std::info::MeshInfo;
use helfrich_std::simulation::build;
use helfrich_tests::tolerance;

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
    // Everything that would follow from the file's size is given explicitly.
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
        &["has no rate of strain: give `duration`"],
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
    // Walls are at ±3.5 along y; the box is periodic along x and z.
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
    let reach = placed(&capsule(&[])).corners[1][1];
    for (kernel, distance) in [("two", 0.5), ("three", 1.0), ("four", 1.5)] {
        // Walls are at ±3.5, and nodes are 1/6 apart.
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
    // Positions on periodic axes may lie anywhere.
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
