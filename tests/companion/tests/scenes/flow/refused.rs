//! Refusal of impossible flows.

use super::super::{generated, refused, the_error, valid};
use super::{capsule, with_flow};
use helfrich_std::info::MeshInfo;

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
        &(capsule(&[]) + "[output]\nevery = 3"),
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
    // The trace is judged relative to the size of the gradient, and up to rounding.
    valid(&linear(
        "[[1e9, 0, 0], [0, -333333333.3333333, 0], [0, 0, -666666666.6666667]]",
    ));
    refused(
        &linear("[[1e-9, 0, 0], [0, 0, 0], [0, 0, 0]]"),
        [13, 38],
        &["the trace of this gradient is 1e-9,"],
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
fn wrong_courses_say_what_is_needed() {
    let shear = |course: &str| {
        with_flow(&format!(
            "kind = \"shear\", rate = 1, course = {{ {course} }}"
        ))
    };
    valid(&shear("kind = \"table\", times = [0, 1], factors = [0, 1]"));
    refused(
        &shear("kind = \"oscillation\""),
        [13, 45],
        &["`driver.flow.course` lacks `period`: a number, above 0 is needed"],
    );
    // These lines are too long to be shown whole.
    let said = |table: &str, parts: &[&str]| {
        let (_, message) = the_error(&shear(&format!("kind = \"table\", {table}")));
        for part in parts {
            assert!(message.contains(part), "`{part}` is not in: {message}");
        }
    };
    said("times = [0, 1], factors = [0, 2]", &["from -1 to 1"]);
    said(
        "times = [0, 1], factors = 1",
        &["there are 1 factors for 2 times"],
    );
    said(
        "times = [0, 1, 1], factors = [0, 1, 0]",
        &[
            "time 3 does not come after time 2",
            "for a jump give two that are close",
        ],
    );
    refused(
        &capsule(&[
            (
                "kind = \"shear\", rate = 0.15",
                "kind = \"quiescent\", course = { kind = \"oscillation\", period = 1 }",
            ),
            ("strain = 4", "duration = 4"),
        ]),
        [13, 30],
        &["`course` belongs to the kind"],
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
            &["has no rate of strain: give `duration`"],
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
    let slice =
        |lines: &str| capsule(&[]) + &format!("[[output.slice]]\nnormal = [0, 0, 1]\n{lines}");
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

/// In a flow, membranes move only by forces; constraints are refused except for volumes, which the flow
/// itself preserves.
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
    valid(&capsule(&[])).check_mesh(0, &open).unwrap();
    let same = valid(&capsule(&[("[driver]", "viscosity_ratio = 1\n[driver]")]));
    same.check_mesh(0, &open).unwrap();
}
