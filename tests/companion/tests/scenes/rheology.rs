//! Keys of the measurements of suspensions.

use super::lattice::{capsule, warnings};
use super::{refused, the_error, valid};
use helfrich_std::info::MeshInfo;
use helfrich_std::scene::Rheology;

/// A capsule on a lattice, with the table of the measurements from line 16 on.
fn measured(keys: &str, replacements: &[(&str, &str)]) -> String {
    capsule(replacements) + "[output.rheology]\n" + keys
}

#[test]
fn measurements_have_defaults_and_an_explanation() {
    let file = valid(&measured("", &[]));
    let expected = Rheology {
        stress: true,
        profiles: 0,
        blocks: 10,
        skip: 0.0,
    };
    assert_eq!(file.scene.output.rheology, Some(expected));
    assert_eq!(valid(&capsule(&[])).scene.output.rheology, None);
    let file = valid(&measured("profiles = 8\nskip = 2\nblocks = 5", &[]));
    let info: MeshInfo = super::generated(&file, 0);
    let text = file.scene.explain(&[info]).to_string();
    let line = "stress and profiles of 8 slices, means over 50 rows after the strain 2 in 5 blocks";
    assert!(text.contains(line), "{text}");
}

#[test]
fn what_cannot_be_measured_is_refused() {
    let refuse = |keys: &str, replacements: &[(&str, &str)], at: [usize; 2], parts: &[&str]| {
        refused(&measured(keys, replacements), at, parts);
    };
    let unbounded = [
        ("lattice-boltzmann", "boundary-integral"),
        ("resolution = 6\n", ""),
    ];
    let text = measured("", &unbounded);
    refused(
        &text,
        [15, 1],
        &[
            "has unbounded fluid",
            "choose the driver \"lattice-boltzmann\"",
        ],
    );
    refuse(
        "stress = false",
        &[],
        [17, 10],
        &["neither `stress` nor `profiles`"],
    );
    refuse("profiles = 43", &[], [17, 12], &["43 slices", "42 at most"]);
    refuse(
        "skip = 4",
        &[],
        [17, 8],
        &["leaves nothing", "the strain 4"],
    );
    refuse("blocks = 1", &[], [17, 10], &["from 2"]);
    refuse("skip = -1", &[], [17, 8], &["of 0 or above"]);
    let gravity = [(
        "elasticity",
        "gravity = { density_difference = 1, acceleration = [0, -1, 0] }\nelasticity",
    )];
    refuse(
        "stress = true",
        &gravity,
        [18, 10],
        &["`gravity` of \"capsule\"", "`stress = false`"],
    );
    valid(&measured("stress = false\nprofiles = 8", &gravity));
    let still = [
        ("kind = \"shear\", rate = 0.15", "kind = \"quiescent\""),
        ("strain = 4", "duration = 4"),
    ];
    refuse(
        "profiles = 8",
        &still,
        [17, 12],
        &["\"quiescent\" has none", "\"channel\""],
    );
    refuse("skip = 1", &still, [17, 8], &["has no rate"]);
    let (_, message) = the_error(&measured("slices = 8", &[]));
    assert!(
        message.contains("stress, profiles, blocks, skip"),
        "{message}"
    );
}

#[test]
fn runs_too_short_for_blocks_are_doubted() {
    let long = warnings(&measured("blocks = 100", &[]));
    assert_eq!(long, [""; 0]);
    let short = warnings(&measured("skip = 3.9\nblocks = 4", &[]));
    assert!(
        short[0].contains("writes 3 rows after `skip`, fewer than the 4 blocks"),
        "{short:?}"
    );
}
