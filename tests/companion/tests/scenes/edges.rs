//! Effects and methods at the edges of open surfaces in scenes.

use super::{capsule_in, generated, refused, the_error, valid, with};
use helfrich_std::info::MeshInfo;
use helfrich_std::scene::{Boundary, SceneFile};

/// Errors and warnings of a scene on its mesh, which is closed or has an edge.
fn findings(keys: &str, open: bool) -> (String, String) {
    let file: SceneFile = valid(&with(keys));
    let closed = generated(&file, 0);
    let info = match open {
        false => closed,
        true => MeshInfo {
            volume: None,
            boundary_edges: 7,
            ..closed
        },
    };
    let wrong = file.check_mesh(0, &info).err();
    let doubts = file.mesh_warnings(0, &info);
    let doubts = Vec::from_iter(doubts.iter().map(ToString::to_string));
    (
        wrong.map_or(String::new(), |wrong| wrong.to_string()),
        doubts.join("\n"),
    )
}

#[track_caller]
fn assert_found(found: &str, part: &str) {
    assert!(found.contains(part), "`{part}` is not in: {found}");
}

const BENDING: &str = "bending = { method = \"B\", modulus = 1 }";

#[test]
fn supports_are_read() {
    for (key, expected) in [
        ("", Boundary::Free),
        ("boundary = \"free\"", Boundary::Free),
        ("boundary = \"hinged\"", Boundary::Hinged),
        ("boundary = \"clamped\"", Boundary::Clamped),
    ] {
        let file = valid(&with(&format!("{BENDING}\n{key}")));
        assert_eq!(file.scene.surfaces[0].boundary, expected);
    }
    let (_, message) = the_error(&with(&format!("{BENDING}\nboundary = \"simply\"")));
    assert_found(&message, "free, hinged, clamped");
}

#[test]
fn closed_surfaces_have_no_edge() {
    let (wrong, _) = findings(&format!("{BENDING}\nboundary = \"hinged\""), false);
    assert_found(
        &wrong,
        "cell.toml:9:12: the mesh of \"cell\" is closed, and has no edge to support",
    );
    let (wrong, _) = findings("line_tension.value = 1", false);
    assert_found(
        &wrong,
        "cell.toml:8:1: `line_tension` acts at an edge, and \"cell\" is closed",
    );
    let gaussian = format!("{BENDING}\ngaussian_bending.modulus = -1");
    let (wrong, doubts) = findings(&gaussian, false);
    assert_eq!(wrong, "");
    assert_found(&doubts, "the constant 2πχ κ_G");
}

#[test]
fn edges_need_an_energy() {
    for method in ["meyer", "belkin", "farutin", "j4"] {
        let bending = format!("bending = {{ method = \"{method}\", modulus = 1 }}");
        let (wrong, _) = findings(&bending, true);
        assert_found(&wrong, "cell.toml:8:22: \"cell\" is open");
        assert_found(
            &wrong,
            "choose gompper-kroll (B), juelicher, hamann or loop (S)",
        );
        assert_eq!(findings(&bending, false).0, "");
    }
    for method in ["gompper-kroll", "juelicher", "hamann", "loop"] {
        let keys = format!(
            "bending = {{ method = \"{method}\", modulus = 1 }}\nline_tension.value = 1\n\
             gaussian_bending.modulus = -1\narea.constraint = \"exact\""
        );
        assert_eq!(
            findings(&keys, true),
            (String::new(), String::new()),
            "{method}"
        );
    }
    let hinges = |boundary: &str| {
        format!("bending = {{ method = \"A\", modulus = 1 }}\nboundary = \"{boundary}\"")
    };
    assert_found(
        &findings(&hinges("free"), true).1,
        "includes a Gaussian modulus",
    );
    assert_eq!(findings(&hinges("clamped"), true).1, "");
}

#[test]
fn supports_exclude_what_would_move_them() {
    for boundary in ["hinged", "clamped"] {
        let support = format!("{BENDING}\nboundary = \"{boundary}\"\n");
        let (wrong, _) = findings(&format!("{support}area.constraint = \"exact\""), true);
        assert_found(
            &wrong,
            "cell.toml:10:19: a constraint would move the supported edge",
        );
        let (wrong, doubts) = findings(&format!("{support}area.modulus = 1"), true);
        assert_eq!((wrong, doubts), (String::new(), String::new()));
        let (_, doubts) = findings(&format!("{support}line_tension.value = 1"), true);
        assert_found(
            &doubts,
            "`line_tension` does nothing to \"cell\", whose edge is held",
        );
        let (_, doubts) = findings(&format!("{support}gaussian_bending.modulus = -1"), true);
        assert_eq!(doubts.contains("does nothing"), boundary == "clamped");
        let flow = capsule_in(
            "boundary-integral",
            "",
            &[("match_volume = true", &format!("boundary = \"{boundary}\""))],
        );
        refused(
            &flow,
            [7, 12],
            &["choose the driver \"relax\"", "`boundary = \"free\"`"],
        );
    }
}

#[test]
fn edges_on_a_lattice_are_refused() {
    for effect in ["line_tension.value = 1", "gaussian_bending.modulus = -0.1"] {
        let text = capsule_in(
            "lattice-boltzmann",
            "resolution = 8\nbox = [6, 6, 6]",
            &[("match_volume = true", effect)],
        );
        refused(
            &text,
            [7, 1],
            &["lattice-boltzmann", "\"boundary-integral\""],
        );
    }
}

#[test]
fn unstable_gaussian_moduli_are_doubted() {
    for (modulus, doubtful) in [("-1", false), ("-2", false), ("-2.1", true), ("0.1", true)] {
        let file = valid(&with(&format!(
            "{BENDING}\ngaussian_bending.modulus = {modulus}"
        )));
        let found = file
            .warnings
            .iter()
            .any(|warning| warning.to_string().contains("no minimum"));
        assert_eq!(found, doubtful, "{modulus}");
    }
}
