//! Wrong and doubtful scenes.

use super::{parse, refused, refused_effect, the_error, valid, with};
use helfrich_std::scene::{Overrides, Place, SceneFile};
use std::path::Path;

#[test]
fn wrong_keys_name_the_line_and_the_nearest_key() {
    refused_effect(
        "[surface.bending]\nmethod = \"B\"\nmodulos = 1\nmodulus = 1",
        [10, 1],
        &[
            "no key `modulos` in `surface.0.bending`",
            "did you mean `modulus`?",
        ],
    );
    refused_effect(
        "wobble = 3",
        [8, 1],
        &[
            "no key `wobble`",
            "the keys are name, shape",
            "bending, elasticity",
        ],
    );
    refused_effect("[output]\nevry = 3", [9, 1], &["did you mean `every`?"]);
    refused_effect(
        "[surface.spontaneous_curvature]\nvalue = 1",
        [8, 10],
        &["no key `spontaneous_curvature` in `surface.0`"],
    );
    // Part of a key is as good a guess as a misspelt key.
    refused_effect(
        "tension.value = 1\ngravity.acceleration = [0, 0, 1]\ngravity.density = 1\ngravity.density_difference = 1",
        [10, 9],
        &["did you mean `density_difference`?"],
    );
}

#[test]
fn missing_keys_name_the_table() {
    refused_effect(
        "[surface.bending]\nmethod = \"B\"",
        [8, 1],
        &[
            "`surface.0.bending` lacks `modulus`: an energy in pN·µm, above 0, or a table is needed. Bending modulus κ",
        ],
    );
    let (place, message) =
        the_error("[driver]\nkind = \"relax\"\n[[surface]]\nmesh = \"a.ply\"\ntension.value = 1");
    assert_eq!(place, Place::File);
    assert!(message.contains("the scene lacks `units`"), "{message}");
    assert!(message.contains("µm, pN and s"), "{message}");
    refused(
        "units = \"none\"\n[driver]\nkind = \"relax\"\n[[surface]]\ntension.value = 1",
        [4, 1],
        &["has neither `shape` nor `mesh`"],
    );
    refused(
        "units = \"none\"\n[driver]\nkind = \"relax\"\n[[surface]]\nshape = \"sphere\"\n",
        [5, 1],
        &["`shape` also needs `vertices`: Number of vertices"],
    );
    refused(
        "units = \"none\"\n[driver]\nkind = \"relax\"\n[[surface]]\nmesh = \"a.ply\"\nseed = 3\n",
        [6, 1],
        &["`seed` also needs `shape`"],
    );
}

#[test]
fn wrong_forms_say_what_is_needed() {
    let bending = |modulus: &str| format!("[surface.bending]\nmethod = \"B\"\nmodulus = {modulus}");
    refused_effect(
        &bending("true"),
        [10, 11],
        &["`modulus` is true or false: an energy in pN·µm, above 0, or a table is needed"],
    );
    refused_effect(
        &bending("[1]"),
        [10, 11],
        &["`modulus` is a list: an energy"],
    );
    refused_effect(
        "bending = 3",
        [8, 11],
        &["`bending` is a number: a table is needed"],
    );
    refused_effect(
        "position = [1, 2]",
        [8, 12],
        &["`position` is a list of 2: a list of three numbers is needed"],
    );
    refused_effect(
        "position = [1, true, 2]",
        [8, 16],
        &["true or false: a length in µm"],
    );
    refused_effect(
        "area = { constraint = true }",
        [8, 23],
        &["`constraint` is true or false: \"exact\" is needed"],
    );
    refused_effect(
        "area = { constraint = \"exact\", target = false }",
        [8, 41],
        &["\"initial\" or an area in µm², above 0, is needed"],
    );
    refused_effect(
        "[output]\nevery = 1.5",
        [9, 9],
        &["a whole number from 1 on is needed"],
    );
    refused_effect(
        "[output]\npictures = \"yes\"",
        [9, 12],
        &["true or false is needed"],
    );
    refused(
        "units = \"none\"\nsurface = []\n[driver]\nkind = \"relax\"",
        [2, 11],
        &["one [[surface]] or more is needed"],
    );
    refused(
        "units = \"none\"\n[surface]\nmesh = \"a.ply\"\n[driver]\nkind = \"relax\"",
        [2, 1],
        &["`surface` is a table: a list of tables, [[surface]], is needed"],
    );
}

#[test]
fn places_count_characters_and_lines() {
    // Three characters of this line take two bytes each, so that columns must count characters.
    refused_effect(
        "area = { target = \"3 µm²\", constraint = \"exäct\" }",
        [8, 41],
        &["\n    area = { target = \"3 µm²\", constraint = \"exäct\" }\n                                            ^^^^^^^\n".trim_end()],
    );
    let windows = with("tension.value = true").replace('\n', "\r\n");
    let (place, message) = the_error(&windows);
    assert!(
        matches!(
            place,
            Place::Text {
                line: 8,
                column: 17,
                ..
            }
        ),
        "{message}"
    );
    assert!(
        message.ends_with("    tension.value = true\n                    ^^^^"),
        "{message}"
    );
    // A line that is too long is shown around its error.
    let long = with(&format!(
        "tension.value = 1 # {}\nposition = [{} 1, 2, true]",
        "x".repeat(300),
        " ".repeat(200)
    ));
    let (_, message) = the_error(&long);
    assert!(
        message.ends_with(
            "1, 2, true]\n                                                                ^^^^"
        ),
        "{message}"
    );
    assert!(
        message.lines().all(|line| line.chars().count() <= 110),
        "{message}"
    );
}

#[test]
fn names_suggest_the_nearest() {
    refused_effect(
        "[surface.bending]\nmethod = \"gomper-kroll\"\nmodulus = 1",
        [9, 10],
        &["`method` cannot be \"gomper-kroll\": did you mean `gompper-kroll`?"],
    );
    refused_effect(
        "[surface.bending]\nmethod = \"best\"\nmodulus = 1",
        [9, 10],
        &["the choices are kantor-nelson, gompper-kroll"],
    );
    refused_effect(
        "[surface.elasticity]\nlaw = \"Skalack\"\nshear_modulus = 1\narea_ratio = 1",
        [9, 7],
        &["did you mean `skalak`?"],
    );
    refused(
        "units = \"SI\"\n[driver]\nkind = \"relax\"\n[[surface]]\nmesh = \"a.ply\"",
        [1, 9],
        &["`units` cannot be \"SI\": the choices are micro, none"],
    );
    refused_effect("name = \"red cell\"", [8, 1], &[]);
}

#[test]
fn shapes_and_families_are_checked() {
    let scene = |shape: &str, rest: &str| {
        format!(
            "units = \"none\"\n[driver]\nkind = \"relax\"\n[[surface]]\nshape = \"{shape}\"\n{rest}\ntension.value = 1"
        )
    };
    refused(
        &scene("cube", "vertices = 642"),
        [5, 9],
        &["`shape`: there is no shape `cube`: choose sphere, ellipsoid"],
    );
    refused(
        &scene("sphere:-1", "vertices = 642"),
        [5, 9],
        &["`shape`: "],
    );
    refused(
        &scene("sphere:1", "vertices = 11"),
        [6, 12],
        &["11 vertices on the sphere are out of range: between 12 and"],
    );
    refused(
        &scene("sphere:1", "vertices = 642\nfamily = \"regulr\""),
        [7, 10],
        &["did you mean `regular`?"],
    );
    refused(
        &scene("sphere:1", "mesh = \"a.ply\"\nvertices = 642"),
        [6, 1],
        &["has both `shape` and `mesh`: only one of them"],
    );
}

#[test]
fn ranges_are_checked() {
    let bending = |modulus: &str| format!("[surface.bending]\nmethod = \"B\"\nmodulus = {modulus}");
    for (number, shown) in [
        ("-1", "-1"),
        ("0", "0"),
        ("nan", "NaN"),
        ("inf", "inf"),
        ("\"-2e-19 J\"", "-0.2"),
    ] {
        let said = format!("`modulus` is {shown}: a number ");
        refused_effect(&bending(number), [10, 11], &[&said]);
    }
    refused_effect(
        "volume = { constraint = \"exact\", reduced = 1.1 }",
        [8, 44],
        &["`reduced` is 1.1: a number above 0 and at most 1 is needed"],
    );
    refused_effect(
        "[output]\nevery = 0",
        [9, 9],
        &["`every` is 0", "from 1 to"],
    );
    refused_effect(
        "orientation = { axis = [0, 0.0, 0], angle = 3 }",
        [8, 24],
        &["`axis` is [0, 0, 0]: a number other than 0 among the three"],
    );
    refused_effect(
        "stretching = { axis = [0, 0, 1], force = [1, -3] }",
        [8, 46],
        &["`force` is -3: a number of 0 or above"],
    );
    refused_effect(
        "stretching = { axis = [0, 0, 1], force = 1, fraction = 0.7 }",
        [8, 56],
        &["above 0 and at most 0.5"],
    );
    refused_effect(
        "stretching = { axis = [0, 0, 1], length = 3, depth = 0.1 }",
        [8, 34],
        &["`length` also needs `stiffness`"],
    );
    refused_effect(
        "stretching = { axis = [0, 0, 1], force = 1, depth = [1, 2, 3] }",
        [8, 53],
        &["one number, or one for each of the two ends"],
    );
    refused_effect("seed = -4", [8, 8], &["`seed` is -4", "from 0 to"]);
}

#[test]
fn units_are_converted_and_checked() {
    let tension = |value: &str| format!("tension.value = \"{value}\"");
    assert_eq!(
        valid(&with(&tension("5.3 µN/m"))).scene.surfaces[0]
            .effects
            .tension
            .unwrap()
            .value,
        5.3
    );
    assert_eq!(
        valid(&with(&tension("5.3 uN/m"))).scene.surfaces[0]
            .effects
            .tension
            .unwrap()
            .value,
        5.3
    );
    refused_effect(
        &tension("5.3 µN"),
        [8, 17],
        &[
            "`value` is a force, \"5.3 µN\": a force per length in pN/µm is needed",
            "such as \"5.3 µN/m\"",
        ],
    );
    refused_effect(&tension("5.3 µM/m"), [8, 17], &["there is no unit `µM`"]);
    refused_effect(
        &tension("5.3"),
        [8, 17],
        &["a number in quotes without a unit"],
    );
    refused_effect(
        &tension("much"),
        [8, 17],
        &["\"much\", which is no number", "\"5.3 µN/m\""],
    );
    refused_effect(
        "scale = \"3 µm\"",
        [8, 9],
        &["`scale` is a length", "a number without a unit is needed"],
    );
    refused_effect(
        "area = { constraint = \"exact\", target = \"3 µm\" }",
        [8, 41],
        &["`target` is a length, \"3 µm\": an area in µm² is needed"],
    );
    refused_effect(
        "area = { constraint = \"exact\", target = \"initail\" }",
        [8, 41],
        &["did you mean `initial`?"],
    );
    // Numbers in every notation of TOML.
    let surface = valid("units = \"none\"\ndriver.kind = \"relax\"\n[[surface]]\nmesh = \"a.ply\"\ntension.value = 1_000.5\nscale = 0x10").scene.surfaces.remove(0);
    let found = surface.effects.tension.unwrap().value;
    assert_eq!((found, surface.scale), (1000.5, 16.0));
    let none = with(&tension("5.3 µN/m")).replace("micro", "none");
    refused(
        &none,
        [8, 17],
        &[
            "has a unit, \"5.3 µN/m\", but the scene's units are \"none\"",
            "units = \"micro\"",
        ],
    );
}

#[test]
fn contradictions_of_methods_and_viscosities_are_refused() {
    let bending = "[surface.bending]\nmethod = \"J\"\nmodulus = 1\n";
    refused(
        &with(bending).replace("[driver]", "[driver]\nscheme = \"minimise\""),
        [3, 10],
        &[
            "jet, the bending method of \"cell\", has none: choose \"overdamped\"",
            "gompper-kroll",
        ],
    );
    // Operators for curvatures only have no force, so they are not among the choices.
    refused_effect(
        "[surface.bending]\nmethod = \"corrected\"\nmodulus = 1",
        [9, 10],
        &[
            "`method` cannot be \"corrected\": the choices are kantor-nelson",
            "j6, j8, jet, A",
        ],
    );
    refused_effect(
        "[surface.bending]\nmethod = \"A\"\nmodulus = 1\nspontaneous_curvature = 1",
        [11, 25],
        &["kantor-nelson (A) has no spontaneous curvature: choose another method"],
    );
    refused_effect(
        "[surface.bending]\nmethod = \"S\"\nmodulus = 1\nareas = \"voronoi\"",
        [11, 9],
        &["method loop has no option `areas`: gompper-kroll (B) and meyer (C) have"],
    );
    refused_effect(
        "tension.value = 1\nviscosity_ratio = 5",
        [9, 19],
        &["\"relax\" has no flow", "leave `viscosity_ratio` out"],
    );
    refused_effect(
        "tension.value = 1\nmembrane_viscosity.shear = 5",
        [9, 1],
        &[
            "\"relax\" has no time",
            "leave [surface.membrane_viscosity] out",
        ],
    );
}

#[test]
fn contradictions_of_elasticity_and_targets_are_refused() {
    refused_effect(
        "[surface.elasticity]\nlaw = \"neo-hookean\"\nshear_modulus = 1\narea_ratio = 1\n[surface.bending]\nmethod = \"B\"\nmodulus = 1",
        [11, 14],
        &[
            "`area_ratio` is the C of Skalak's law",
            "leave it out, or choose law = \"skalak\"",
        ],
    );
    refused_effect(
        "[surface.elasticity]\nlaw = \"skalak\"\nshear_modulus = 1\n[surface.bending]\nmethod = \"B\"\nmodulus = 1",
        [9, 7],
        &["Skalak's law lacks `area_ratio`"],
    );
    refused_effect(
        "area = { constraint = \"exact\", modulus = 3 }",
        [8, 32],
        &["has both `constraint` and `modulus`: only one of them"],
    );
    refused_effect(
        "area = { target = 3 }",
        [8, 8],
        &["has neither `constraint` nor `modulus`: one of them is needed"],
    );
    refused_effect(
        "volume = { constraint = \"exact\", target = 3, reduced = 0.5 }",
        [8, 46],
        &["has both `target` and `reduced`"],
    );
    refused_effect(
        "area = { constraint = \"exact\", target = 4 }\nvolume = { constraint = \"exact\", target = 4 }",
        [9, 43],
        &[
            "the reduced volume of these targets is 5.3174",
            "encloses more than a sphere, 0.752253",
        ],
    );
    let elastic = "[surface.bending]\nmethod = \"B\"\nmodulus = 1\n[surface.elasticity]\nlaw = \"neo-hookean\"\nshear_modulus = 1\n";
    refused(
        &with(elastic).replace("[driver]", "[driver]\nredistribution = true"),
        [3, 18],
        &["every surface is elastic: choose false or \"auto\""],
    );
    let flow = "[driver]\nredistribution = true\nviscosity = 1\nduration = 1";
    let pulled = "[surface.bending]\nmethod = \"B\"\nmodulus = 1\n[surface.stretching]\naxis = [1, 0, 0]\nforce = 1\n";
    refused(
        &with(pulled)
            .replace("[driver]", flow)
            .replace("relax", "boundary-integral"),
        [3, 18],
        &["every surface is elastic, or pulled at its vertices: choose false"],
    );
    let renewed = |text: &str| text.replace("vertices = 642", "vertices = 642\nremesh = \"auto\"");
    refused(
        &renewed(&with(elastic)),
        [8, 10],
        &["remembers where its material was, by `elasticity`"],
    );
    let bent = "[surface.bending]\nmethod = \"B\"\nmodulus = 1\n";
    refused(
        &renewed(&with(bent)).replace("remesh", "boundary = \"hinged\"\nremesh"),
        [9, 10],
        &["the edge of \"cell\" is supported, and its vertices have to stay"],
    );
    refused(
        &with(bent).replace("vertices = 642", "vertices = 642\ntopology = \"may-break\""),
        [8, 1],
        &["`topology` also needs `remesh`"],
    );
    refused(
        &with(bent).replace("vertices = 642", "vertices = 642\nremesh = {}"),
        [8, 10],
        &["neither `edge` nor `vertices` nor `curvature` nor `error`"],
    );
    refused_effect(
        &format!("{elastic}reference = {{ shape = \"torus:2,1\" }}"),
        [14, 23],
        &["no reference on the torus", "different triangles"],
    );
    refused(
        &with(elastic)
            .replace("vertices = 642", "vertices = 642\nfamily = \"irregular\"")
            .replace(
                "shear_modulus = 1",
                "shear_modulus = 1\nreference.shape = \"sphere\"",
            ),
        [15, 19],
        &["triangles of an irregular mesh depend on the shape: choose another family"],
    );
    refused_effect(
        "tension.value = 1\n[[interaction]]\nkind = \"repulsion\"\nstrength = 1\ncutoff = 1",
        [9, 1],
        &["the scene has only one: add a [[surface]]"],
    );
}

#[test]
fn surfaces_have_different_names() {
    let two = with("tension.value = 1\n[[surface]]\nmesh = \"a.ply\"\ntension.value = 1\n");
    let name = format!("{two}name = \"cell\"");
    refused(
        &name,
        [12, 8],
        &["surface 1 has the name \"cell\" of surface 0"],
    );
    let repulsion = "[[interaction]]\nkind = \"repulsion\"\nstrength = 1\ncutoff = 1\n";
    refused(
        &format!("{two}{repulsion}between = [\"cell\", \"surface-1\"]"),
        [16, 11],
        &["`between` cannot be \"surface-1\": did you mean `surface-2`?"],
    );
    refused(
        &format!("{two}{repulsion}between = [\"cell\", \"cell\"]"),
        [16, 11],
        &["names \"cell\" twice"],
    );
    refused(
        &format!("{two}{repulsion}between = [\"cell\"]"),
        [16, 11],
        &["names of two surfaces"],
    );
}

#[test]
fn what_is_doubtful_is_warned_of() {
    let file = valid(&with(
        "elasticity = { law = \"neo-hookean\", shear_modulus = 1 }",
    ));
    let [warning] = file.warnings.as_slice() else {
        panic!("one warning");
    };
    let message = warning.to_string();
    assert!(
        message.starts_with("folder/cell.toml:8:14: \"cell\" is elastic"),
        "{message}"
    );
    assert!(
        message.contains("wrinkles") && message.contains("[surface.bending]"),
        "{message}"
    );
    let warned = |effects: &str, line: usize, part: &str| {
        let file = valid(&with(effects));
        let messages = Vec::from_iter(file.warnings.iter().map(ToString::to_string));
        assert_eq!(messages.len(), 1, "{messages:?}");
        let start = format!("folder/cell.toml:{line}:");
        assert!(
            messages[0].starts_with(&start) && messages[0].contains(part),
            "{messages:?}"
        );
    };
    warned(
        "tension.value = 1\narea.constraint = \"exact\"",
        8,
        "`tension` does nothing",
    );
    warned(
        "volume.constraint = \"exact\"\npressure.value = 1",
        9,
        "`pressure` does nothing",
    );
    warned(
        "gravity = { density_difference = 1, acceleration = [0, 0, 1] }",
        8,
        "no equilibrium",
    );
    let file = valid(&with(""));
    assert!(
        file.warnings[0]
            .to_string()
            .contains("nothing acts on \"cell\"")
    );
}

#[test]
fn no_toml_names_the_place() {
    refused(
        "units = \"micro\"\ntitle = \"a\nb\"",
        [2, 11],
        &["not valid TOML"],
    );
    refused("units = ", [1, 9], &["not valid TOML"]);
    refused(
        "units = \"micro\"\nunits = \"none\"",
        [2, 1],
        &["not valid TOML", "duplicate key"],
    );
}

#[test]
fn independent_errors_are_said_together() {
    let text =
        with("[surface.bending]\nmethod = \"X\"\nmodulus = -1\nfoo = 3\n[output]\nevery = 0");
    let errors = parse(&text).unwrap_err();
    let lines = Vec::from_iter(errors.errors().iter().map(|error| match error.place {
        Place::Text { line, .. } => line,
        _ => 0,
    }));
    assert_eq!(lines, [9, 10, 11, 13], "{errors}");
    // The message shows each line, with the wrong value marked.
    assert!(
        errors
            .to_string()
            .contains("\n    modulus = -1\n              ^^\n"),
        "{errors}"
    );
}

#[test]
fn files_that_cannot_be_read_are_named() {
    let missing = SceneFile::read(Path::new("no/such.toml"), &Overrides::default());
    assert_eq!(
        missing.unwrap_err().to_string(),
        "no/such.toml: there is no such file"
    );
    let directory = SceneFile::read(Path::new("."), &Overrides::default());
    assert_eq!(
        directory.unwrap_err().to_string(),
        ".: is a directory: a scene file is needed"
    );
}
