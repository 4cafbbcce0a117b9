//! Scene files: what is right is read, what is wrong is said.

use helfrich::Surface;
use helfrich_std::generate::generate;
use helfrich_std::info::MeshInfo;
use helfrich_std::method::BendingMethod;
use helfrich_std::scene::{
    AreaDifferenceTarget, Driver, Every, Hold, InPlaneLaw, Interaction, MeshSource, Overrides,
    Place, ReferenceSource, SceneErrors, SceneFile, Scheme, Target, Units, VolumeTarget,
    json_schema,
};
use helfrich_tests::meshes::cases;
use proptest::prelude::*;
use serde_json::Value;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../std-ext/scenes")
}

fn shipped() -> Vec<(String, String)> {
    let files = std::fs::read_dir(folder()).unwrap();
    let paths = files.map(|entry| entry.unwrap().path());
    let scenes = paths.filter(|path| path.extension().is_some_and(|end| end == "toml"));
    let name = |path: &PathBuf| path.file_stem().unwrap().to_string_lossy().into_owned();
    let mut all =
        Vec::from_iter(scenes.map(|path| (name(&path), std::fs::read_to_string(path).unwrap())));
    all.sort();
    all
}

fn parse(text: &str) -> Result<SceneFile, SceneErrors> {
    parse_with::<&str>(text, &[])
}

fn parse_with<S: Into<String> + Clone>(
    text: &str,
    overrides: &[S],
) -> Result<SceneFile, SceneErrors> {
    let overrides = Overrides::new(overrides.iter().cloned()).unwrap();
    SceneFile::parse(text, Path::new("folder/cell.toml"), &overrides)
}

#[track_caller]
fn valid(text: &str) -> SceneFile {
    parse(text).unwrap_or_else(|errors| panic!("{errors}\n\n{text}"))
}

/// A scene with `effects` on its one surface, from line 8 on.
fn with(effects: &str) -> String {
    format!(
        "units = \"micro\"\n[driver]\nkind = \"relax\"\n[[surface]]\nname = \"cell\"\nshape = \
         \"sphere:3\"\nvertices = 642\n{effects}"
    )
}

/// The one error of a text.
#[track_caller]
fn the_error(text: &str) -> (Place, String) {
    let errors = parse(text).expect_err(text);
    assert_eq!(errors.errors().len(), 1, "{errors}");
    (errors.errors()[0].place.clone(), errors.to_string())
}

/// A text has one error, at `line` and `column`, whose message has `parts`.
#[track_caller]
fn refused(text: &str, at: [usize; 2], parts: &[&str]) {
    let (place, message) = the_error(text);
    let Place::Text {
        line,
        column,
        text: shown,
        ..
    } = place
    else {
        panic!("no place: {message}");
    };
    assert_eq!([line, column], at, "{message}");
    assert_eq!(
        Some(shown.as_str()),
        text.lines().nth(line - 1),
        "{message}"
    );
    let start = format!("folder/cell.toml:{line}:{column}: ");
    assert!(message.starts_with(&start), "{message}");
    assert!(message.contains(shown.trim_end()), "{message}");
    for part in parts {
        assert!(message.contains(part), "`{part}` is not in: {message}");
    }
}

/// The same for an effect that the scene of [`with`] is given.
#[track_caller]
fn refused_effect(effects: &str, at: [usize; 2], parts: &[&str]) {
    refused(&with(effects), at, parts);
}

#[test]
fn every_key_is_read() {
    let file = valid(
        r#"
title = "Everything"
units = "micro"

[[surface]]
name = "a"
shape = "ellipsoid:3,3,2"
family = "relaxed"
vertices = 642
seed = 7
scale = 2
position = [0, "5 µm", 0.5]
orientation = { axis = [0, 0, 1], angle = 30 }
viscosity_ratio = 1.0
bending = { method = "B", modulus = "2e-19 J", spontaneous_curvature = -0.5 }
area = { modulus = "5 N/m", target = "200 µm²" }
volume = { constraint = "exact", reduced = 0.6 }
area_difference = { modulus = 0.3, reduced = 1.2 }
tension.value = "1 nN/m"
pressure.value = "-0.5 Pa"
gravity = { density_difference = "50 kg/m³", acceleration = [0, 0, "-9.81 m/s²"] }

[surface.elasticity]
law = "skalak"
shear_modulus = "5.3 µN/m"
area_ratio = 1
reference = { shape = "sphere:3", scale = 0.9 }

[surface.local_area]
modulus = 3
reference.mesh = "rest.ply"

[surface.stretching]
axis = [1, 0, 0]
force = [0, "30 pN"]
fraction = 0.02

[[surface]]
mesh = "cell.ply"
area.constraint = "exact"
volume.modulus = 2
volume.target = 50
area_difference.constraint = "exact"

[[interaction]]
kind = "repulsion"
strength = 0.1
cutoff = 0.2
between = ["surface-2", "a"]

[driver]
kind = "relax"
scheme = "overdamped"
residual = 1e-3
iterations = 7
redistribution = false

[output]
every = 3
surfaces = false
pictures = false
picture_field = "bending-force"
checkpoint_every = 11
"#,
    );
    let lines = Vec::from_iter(file.warnings.iter().map(|warning| match warning.place {
        Place::Text { line, .. } => line,
        _ => 0,
    }));
    // Pressure on a volume that is held, and weight.
    assert_eq!(lines, [20, 21], "{:?}", file.warnings);
    let scene = &file.scene;
    assert_eq!(
        (scene.title.as_str(), scene.units),
        ("Everything", Units::Micro)
    );
    let [a, b] = scene.surfaces.as_slice() else {
        panic!("two surfaces");
    };
    let MeshSource::Shape {
        shape,
        family,
        vertices,
        seed,
        match_volume: false,
    } = a.source
    else {
        panic!("a shape");
    };
    assert_eq!(shape.to_string(), "ellipsoid:3,3,2");
    assert_eq!((family.name(), vertices, seed), ("relaxed", 642, 7));
    assert_eq!((a.scale, a.position), (2.0, [0.0, 5.0, 0.5]));
    let orientation = a.orientation.unwrap();
    assert_eq!(
        (orientation.axis, orientation.angle),
        ([0.0, 0.0, 1.0], 30.0)
    );
    assert_eq!(a.viscosity_ratio, Some(1.0));
    let bending = a.bending.unwrap();
    assert_eq!(bending.method, BendingMethod::GompperKroll);
    assert_eq!(
        (bending.modulus, bending.spontaneous_curvature),
        (0.2, -0.5)
    );
    let elasticity = a.elasticity.as_ref().unwrap();
    let law = InPlaneLaw::Skalak {
        shear_modulus: 5.3,
        area_ratio: 1.0,
    };
    assert_eq!(elasticity.law, law);
    assert_eq!(elasticity.reference.scale, 0.9);
    let ReferenceSource::Shape(reference) = &elasticity.reference.source else {
        panic!("a shape");
    };
    assert_eq!(reference.to_string(), "sphere:3");
    let area = a.area.unwrap();
    assert_eq!(
        (area.hold, area.target),
        (Hold::Penalty(5e6), Target::Value(200.0))
    );
    let local = a.local_area.as_ref().unwrap();
    let rest = ReferenceSource::File("folder/rest.ply".into());
    assert_eq!((local.modulus, &local.reference.source), (3.0, &rest));
    let volume = a.volume.unwrap();
    assert_eq!(
        (volume.hold, volume.target),
        (Hold::Exact, VolumeTarget::Reduced(0.6))
    );
    let difference = a.area_difference.unwrap();
    assert_eq!(difference.hold, Hold::Penalty(0.3));
    assert_eq!(difference.target, AreaDifferenceTarget::Reduced(1.2));
    assert_eq!((a.tension, a.pressure), (Some(1e-3), Some(-0.5)));
    let gravity = a.gravity.unwrap();
    assert_eq!(gravity.density_difference, 5e-11);
    assert_eq!(gravity.acceleration, [0.0, 0.0, -9.81e6]);
    let stretching = a.stretching.as_ref().unwrap();
    assert_eq!(stretching.axis, [1.0, 0.0, 0.0]);
    assert_eq!(
        (&stretching.forces, stretching.fraction),
        (&vec![0.0, 30.0], 0.02)
    );

    assert_eq!(b.name, "surface-2");
    assert_eq!(b.source, MeshSource::File("folder/cell.ply".into()));
    assert_eq!((b.scale, b.position), (1.0, [0.0; 3]));
    assert_eq!(b.area.unwrap().hold, Hold::Exact);
    assert_eq!(b.area.unwrap().target, Target::Initial);
    assert_eq!(b.volume.unwrap().target, VolumeTarget::Value(50.0));
    assert_eq!(b.volume.unwrap().hold, Hold::Penalty(2.0));
    assert_eq!(
        b.area_difference.unwrap().target,
        AreaDifferenceTarget::Initial
    );
    assert!(b.bending.is_none() && b.elasticity.is_none() && b.stretching.is_none());

    let repulsion = Interaction::Repulsion {
        strength: 0.1,
        cutoff: 0.2,
        between: Some([1, 0]),
    };
    assert_eq!(scene.interactions, [repulsion]);
    let Driver::Relax(relax) = scene.driver else {
        panic!("{:?}", scene.driver);
    };
    assert_eq!(relax.scheme, Scheme::Overdamped);
    assert_eq!((relax.residual, relax.iterations), (1e-3, 7));
    assert!(!relax.redistribution);
    let output = &scene.output;
    assert_eq!(
        (output.every, output.checkpoint_every),
        (Every::Iterations(3), 11)
    );
    assert!(!output.surfaces && !output.pictures);
    assert_eq!(
        serde_json::to_value(output.picture_field).unwrap(),
        "bending-force"
    );
}

#[test]
fn automatic_choices_follow_the_effects() {
    let relax = |effects: &str| {
        let Driver::Relax(relax) = valid(&with(effects)).scene.driver else {
            panic!("another driver");
        };
        (relax.scheme, relax.redistribution)
    };
    let bending = |method: &str| format!("bending = {{ method = \"{method}\", modulus = 1 }}\n");
    assert_eq!(relax(&bending("B")), (Scheme::Minimise, true));
    assert_eq!(relax(&bending("J")), (Scheme::Overdamped, true));
    let elastic = bending("S") + "elasticity = { law = \"neo-hookean\", shear_modulus = 1 }";
    assert_eq!(relax(&elastic), (Scheme::Minimise, false));
}

#[test]
fn shipped_scenes_are_valid() {
    let all = shipped();
    assert!(all.len() >= 7);
    for (name, text) in &all {
        let file = SceneFile::parse(text, &folder().join(name), &Overrides::default());
        let file = file.unwrap_or_else(|errors| panic!("{errors}"));
        assert_eq!(file.warnings, [], "{name}");
        let meshes = Vec::from_iter((0..file.scene.surfaces.len()).map(|surface| {
            let info = generated(&file, surface);
            file.check_mesh(surface, &info)
                .unwrap_or_else(|errors| panic!("{errors}"));
            info
        }));
        let explanation = file.scene.explain(&meshes).to_string();
        assert!(explanation.starts_with(&file.scene.title), "{explanation}");
    }
}

/// What the generated mesh of a surface is like, scaled.
fn generated(file: &SceneFile, surface: usize) -> MeshInfo {
    let surface = &file.scene.surfaces[surface];
    let MeshSource::Shape {
        shape,
        family,
        vertices,
        seed,
        match_volume: false,
    } = &surface.source
    else {
        panic!("no shape");
    };
    let made = generate(shape, *family, *vertices, *seed).unwrap();
    let scaled = |point: &[f64; 3]| point.map(|x| x * surface.scale);
    let positions = Vec::from_iter(made.positions.iter().map(scaled));
    MeshInfo::new(Surface::new(&made.mesh, &positions).unwrap())
}

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
    // A part of a key is as good a guess as a wrong letter.
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
            "`surface.0.bending` lacks `modulus`: an energy in pN·µm, above 0 is needed. Bending modulus κ",
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
        &["`shape` needs `vertices` beside it: How many vertices"],
    );
    refused(
        "units = \"none\"\n[driver]\nkind = \"relax\"\n[[surface]]\nmesh = \"a.ply\"\nseed = 3\n",
        [6, 1],
        &["`seed` needs `shape` beside it"],
    );
}

#[test]
fn wrong_forms_say_what_is_needed() {
    let bending = |modulus: &str| format!("[surface.bending]\nmethod = \"B\"\nmodulus = {modulus}");
    refused_effect(
        &bending("true"),
        [10, 11],
        &["`modulus` is true or false: an energy in pN·µm is needed"],
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
    // Three of them have two bytes.
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
        &["`method` knows no \"gomper-kroll\": did you mean `gompper-kroll`?"],
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
        &["`units` knows no \"SI\": the choices are micro, none"],
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
        &scene("sphere:1", "vertices = 1000"),
        [6, 12],
        &[
            "no smooth mesh of 1000 vertices",
            "the nearest are 642 and 2562",
        ],
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
    refused_effect("seed = -4", [8, 8], &["`seed` is -4", "from 0 to"]);
}

#[test]
fn units_are_converted_and_checked() {
    let tension = |value: &str| format!("tension.value = \"{value}\"");
    assert_eq!(
        valid(&with(&tension("5.3 µN/m"))).scene.surfaces[0].tension,
        Some(5.3)
    );
    assert_eq!(
        valid(&with(&tension("5.3 uN/m"))).scene.surfaces[0].tension,
        Some(5.3)
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
    // Every way in which TOML writes numbers.
    let surface = valid("units = \"none\"\ndriver.kind = \"relax\"\n[[surface]]\nmesh = \"a.ply\"\ntension.value = 1_000.5\nscale = 0x10").scene.surfaces.remove(0);
    assert_eq!((surface.tension, surface.scale), (Some(1000.5), 16.0));
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
fn contradictions_are_refused() {
    let bending = "[surface.bending]\nmethod = \"J\"\nmodulus = 1\n";
    refused(
        &with(bending).replace("[driver]", "[driver]\nscheme = \"minimise\""),
        [3, 10],
        &[
            "jet, the bending method of \"cell\", has none: choose \"overdamped\"",
            "gompper-kroll",
        ],
    );
    refused_effect(
        "[surface.bending]\nmethod = \"A\"\nmodulus = 1\nspontaneous_curvature = 1",
        [11, 25],
        &["kantor-nelson (A) has no spontaneous curvature: choose another method"],
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
    refused(
        &with("tension.value = 1").replace("relax", "lattice-boltzmann"),
        [3, 8],
        &["no driver \"lattice-boltzmann\" yet: the drivers are relax, boundary-integral"],
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
        &["`between` knows no \"surface-1\": did you mean `surface-2`?"],
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
    refused("units = \"micro\"\ntitle = \"a\nb\"", [2, 11], &["no TOML"]);
    refused("units = ", [1, 9], &["no TOML"]);
    refused(
        "units = \"micro\"\nunits = \"none\"",
        [2, 1],
        &["no TOML", "duplicate key"],
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
    // Each with its line below it, marked.
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

#[test]
fn overrides_replace_and_add() {
    let text = with("bending = { method = \"B\", modulus = 1 }");
    let one = |set: &str| {
        parse_with(&text, &[set])
            .unwrap_or_else(|errors| panic!("{errors}"))
            .scene
            .surfaces
            .remove(0)
    };
    assert_eq!(
        one("surface.0.bending.modulus=0.3")
            .bending
            .unwrap()
            .modulus,
        0.3
    );
    assert_eq!(
        one("surface.cell.bending.modulus = 3")
            .bending
            .unwrap()
            .modulus,
        3.0
    );
    assert_eq!(
        one("surface.0.bending.modulus=2e-19 J")
            .bending
            .unwrap()
            .modulus,
        0.2
    );
    assert_eq!(
        one("surface.0.bending.modulus=\"2e-19 J\"")
            .bending
            .unwrap()
            .modulus,
        0.2
    );
    assert_eq!(
        one("surface.0.bending.method=J").bending.unwrap().method,
        BendingMethod::Jet
    );
    assert_eq!(one("surface.0.tension.value=3").tension, Some(3.0));
    assert_eq!(one("surface.0.position=[1,2,3]").position, [1.0, 2.0, 3.0]);
    assert_eq!(
        one("surface.0.shape=ellipsoid:1,2,3").source,
        one("surface.cell.shape=\"ellipsoid:1,2,3\"").source
    );
    let later = parse_with(&text, &["output.every=3", "output.every=4"]).unwrap();
    assert_eq!(later.scene.output.every, Every::Iterations(4));
    // The default name of a surface without one.
    let unnamed = text.replace("name = \"cell\"\n", "");
    let found = parse_with(&unnamed, &["surface.surface-1.tension.value=2"]).unwrap();
    assert_eq!(found.scene.surfaces[0].tension, Some(2.0));
}

#[test]
fn errors_of_overrides_name_the_override() {
    let text = with("bending = { method = \"B\", modulus = 1 }");
    let refused = |set: &str, parts: &[&str]| {
        let errors = parse_with(&text, &[set]).expect_err(set);
        assert_eq!(errors.errors().len(), 1, "{errors}");
        let message = errors.to_string();
        assert!(message.starts_with(&format!("--set {set}: ")), "{message}");
        for part in parts {
            assert!(message.contains(part), "`{part}` is not in: {message}");
        }
    };
    refused(
        "surface.0.bending.modulos=1",
        &[
            "no key `modulos` in `surface.0.bending`",
            "did you mean `modulus`?",
        ],
    );
    refused(
        "sufrace.0.bending.modulus=1",
        &["in the scene", "did you mean `surface`?"],
    );
    refused(
        "surface.0.bending.modulus=-1",
        &["`modulus` is -1: a number above 0"],
    );
    refused("surface.0.bending.modulus=3 µm", &["`modulus` is a length"]);
    refused(
        "surface.1.bending.modulus=1",
        &["no surface `1`: there are 0 (cell)"],
    );
    refused(
        "surface.bending.modulus=1",
        &["no surface `bending`: there are 0 (cell)"],
    );
    refused("surface.0=1", &["`surface.0` is a whole table"]);
    refused(
        "interaction.0.cutoff=1",
        &["no interaction `0`: the scene has no interaction"],
    );
    refused("units.a=1", &["`units` is a value and no table"]);
    refused("surface.0.vertices=100", &["the nearest are 42 and 162"]);
    let error = Overrides::new(["surface"]).unwrap_err().to_string();
    assert!(
        error.contains("`surface` sets nothing: write path.to.key=value"),
        "{error}"
    );
    assert!(Overrides::new(["=3"]).is_err());
}

#[test]
fn meshes_are_checked_when_they_are_known() {
    let text =
        with("volume.constraint = \"exact\"\npressure.value = 1\narea.constraint = \"exact\"");
    let file = valid(&text);
    let info = generated(&file, 0);
    file.check_mesh(0, &info).unwrap();
    let open = MeshInfo {
        volume: None,
        boundary_edges: 7,
        ..info.clone()
    };
    let message = file.check_mesh(0, &open).unwrap_err().to_string();
    assert!(
        message.contains("folder/cell.toml:8:1: `volume` needs an enclosed volume"),
        "{message}"
    );
    assert!(
        message.contains("7 boundary edges: close the mesh"),
        "{message}"
    );
    assert!(
        message.contains("folder/cell.toml:9:1: `pressure`"),
        "{message}"
    );
    let inside_out = MeshInfo {
        volume: Some(-3.0),
        ..info.clone()
    };
    let message = file.check_mesh(0, &inside_out).unwrap_err().to_string();
    assert!(message.contains("run clockwise"), "{message}");
    let isolated = MeshInfo {
        isolated_vertices: 2,
        ..info.clone()
    };
    let message = file.check_mesh(0, &isolated).unwrap_err().to_string();
    assert!(
        message.contains("2 vertices of the mesh are in no triangle"),
        "{message}"
    );
    let elastic = valid(&with(
        "bending = { method = \"B\", modulus = 1 }\nelasticity = { law = \"neo-hookean\", shear_modulus = 1 }",
    ));
    let degenerate = MeshInfo {
        degenerate_triangles: vec![7],
        ..info.clone()
    };
    let message = elastic.check_mesh(0, &degenerate).unwrap_err().to_string();
    assert!(
        message.contains("cell.toml:9:14: triangle 7 of the mesh has no area"),
        "{message}"
    );
    // More than a sphere of that area encloses.
    let text =
        with("volume = { constraint = \"exact\", target = 200 }\narea.constraint = \"exact\"");
    let file = valid(&text);
    let message = file.check_mesh(0, &info).unwrap_err().to_string();
    assert!(message.contains("cell.toml:8:10: area "), "{message}");
    assert!(
        message.contains("no surface of that area encloses more than"),
        "{message}"
    );
}

#[test]
fn families_have_the_same_triangles_on_every_shape() {
    use helfrich_std::generate::Family;
    for family in Family::ALL
        .into_iter()
        .filter(|&family| family != Family::Irregular)
    {
        let mesh = |shape: &str| {
            generate(&shape.parse().unwrap(), family, 642, 5)
                .unwrap()
                .mesh
        };
        let sphere = mesh("sphere:3");
        for shape in ["ellipsoid:1,2,0.3", "discocyte:4"] {
            assert_eq!(
                sphere.triangles(),
                mesh(shape).triangles(),
                "{family} {shape}"
            );
        }
    }
}

#[test]
fn repulsion_needs_short_edges() {
    let scene = |cutoff: f64| {
        with(&format!(
            "tension.value = 1\n[[surface]]\nmesh = \"a.ply\"\ntension.value = 1\n[[interaction]]\nkind = \"repulsion\"\nstrength = 1\ncutoff = {cutoff}"
        ))
    };
    let file = valid(&scene(0.3));
    let info = generated(&file, 0);
    let [warning] = file.mesh_warnings(0, &info).try_into().unwrap();
    let message = warning.to_string();
    assert!(
        message.starts_with("folder/cell.toml:15:10: the repulsion reaches 0.3"),
        "{message}"
    );
    assert!(valid(&scene(3.0)).mesh_warnings(0, &info).is_empty());
}

#[test]
fn references_have_the_triangles_of_their_surface() {
    let text = with(
        "elasticity = { law = \"neo-hookean\", shear_modulus = 1, reference = { mesh = \"r.ply\" } }",
    );
    let file = valid(&text);
    let mesh = |vertices| {
        let shape = "sphere".parse().unwrap();
        generate(&shape, helfrich_std::generate::Family::Smooth, vertices, 1)
            .unwrap()
            .mesh
    };
    file.check_reference(0, &mesh(642), &mesh(642)).unwrap();
    let message = file
        .check_reference(0, &mesh(642), &mesh(162))
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("cell.toml:8:68: the reference has 162 vertices"),
        "{message}"
    );
    let mut turned = mesh(642).triangles().to_vec();
    turned.swap(3, 4);
    let turned = helfrich::TriangleMesh::new(642, turned).unwrap();
    let message = file
        .check_reference(0, &mesh(642), &turned)
        .unwrap_err()
        .to_string();
    assert!(message.contains("triangle 3 of the reference"), "{message}");
}

#[test]
fn explanations_name_effects_and_groups() {
    let file = valid(&with(
        "[surface.bending]\nmethod = \"B\"\nmodulus = 0.5\nspontaneous_curvature = 0.25\n\
         [surface.elasticity]\nlaw = \"neo-hookean\"\nshear_modulus = 2\n\
         [surface.volume]\nconstraint = \"exact\"\nreduced = 0.9\n\
         [surface.area]\nmodulus = 3\n",
    ));
    // A sphere of radius 3, exactly.
    let pi = std::f64::consts::PI;
    let mesh = MeshInfo {
        area: 36.0 * pi,
        volume: Some(36.0 * pi),
        ..generated(&file, 0)
    };
    let explanation = file.scene.explain(&[mesh]);
    let surface = &explanation.surfaces[0];
    let on = Vec::from_iter(surface.on.iter().map(|effect| effect.name));
    assert_eq!(on, ["bending", "elasticity", "area", "volume"]);
    assert_eq!(surface.off.len(), 7);
    let group = |formula: &str| {
        let found = surface.groups.iter().find(|group| group.formula == formula);
        found.unwrap_or_else(|| panic!("{formula}")).value
    };
    let close = |formula: &str, expected: f64| {
        let found = group(formula);
        assert!(
            (found / expected - 1.0).abs() < 1e-12,
            "{formula}: {found} for {expected}"
        );
    };
    close("6√π V/A^(3/2)", 1.0);
    close("6√π V0/A^(3/2)", 0.9);
    close("c0 R = 2 H0 R", 1.5);
    close("b = κ/(R² G)", 0.5 / 18.0);
    close("κ/(R² 3 G)", 0.5 / 54.0);
    close("K_s/G", 3.0);
    // Y = 3 G of an incompressible sheet.
    close("γ = Y R²/κ, Y = 4 K_s G/(K_s + G)", 6.0 * 9.0 / 0.5);
    close("k R²/κ", 54.0);
    let text = explanation.to_string();
    for part in [
        "off: local_area, area_difference",
        "step limit          none",
        "modulus = 0.5 pN·µm",
        "memory",
    ] {
        assert!(text.contains(part), "`{part}` is not in:\n{text}");
    }
}

// The schema.

#[test]
fn schema_is_up_to_date() {
    let path = folder().join("scene.schema.json");
    let mut text = serde_json::to_string_pretty(&json_schema()).unwrap();
    text.push('\n');
    if std::env::var_os("UPDATE_SCHEMA").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        kept == text,
        "{} is out of date: run this test with UPDATE_SCHEMA=1",
        path.display()
    );
}

/// Whether a value conforms to a schema, by the keywords of JSON Schema 2020-12 that are used.
fn conforms(schema: &Value, value: &Value) -> bool {
    let holds = |(keyword, rule): (&String, &Value)| {
        let list = || rule.as_array().unwrap().iter();
        let number = || rule.as_f64().unwrap();
        match keyword.as_str() {
            "const" => rule == value || (rule.is_number() && rule.as_f64() == value.as_f64()),
            "if" => !conforms(rule, value) || conforms(&schema["then"], value),
            "then" => true,
            "$schema" | "title" | "description" => true,
            "type" => match rule.as_str().unwrap() {
                "object" => value.is_object(),
                "array" => value.is_array(),
                "string" => value.is_string(),
                "boolean" => value.is_boolean(),
                "number" => value.is_number(),
                "integer" => value.is_i64() || value.is_u64(),
                other => panic!("type {other}"),
            },
            "enum" => list().any(|choice| choice == value),
            "anyOf" => list().any(|schema| conforms(schema, value)),
            "allOf" => list().all(|schema| conforms(schema, value)),
            "oneOf" => list().filter(|schema| conforms(schema, value)).count() == 1,
            "not" => !conforms(rule, value),
            "required" => value
                .as_object()
                .is_none_or(|object| list().all(|key| object.contains_key(key.as_str().unwrap()))),
            "dependentRequired" => value.as_object().is_none_or(|object| {
                let mut present = rule
                    .as_object()
                    .unwrap()
                    .iter()
                    .filter(|(key, _)| object.contains_key(*key));
                present.all(|(_, needed)| {
                    let needed = needed.as_array().unwrap();
                    needed
                        .iter()
                        .all(|key| object.contains_key(key.as_str().unwrap()))
                })
            }),
            "properties" => value.as_object().is_none_or(|object| {
                let known = rule.as_object().unwrap();
                object
                    .iter()
                    .all(|(key, value)| known.get(key).is_none_or(|schema| conforms(schema, value)))
            }),
            "additionalProperties" => {
                assert_eq!(rule, &Value::Bool(false));
                let known = schema["properties"].as_object().unwrap();
                value
                    .as_object()
                    .is_none_or(|object| object.keys().all(|key| known.contains_key(key)))
            }
            "items" => value
                .as_array()
                .is_none_or(|items| items.iter().all(|item| conforms(rule, item))),
            "minItems" => value
                .as_array()
                .is_none_or(|items| items.len() as f64 >= number()),
            "maxItems" => value
                .as_array()
                .is_none_or(|items| items.len() as f64 <= number()),
            "minLength" => value.as_str().is_none_or(|text| !text.is_empty()),
            "minimum" => value.as_f64().is_none_or(|value| value >= number()),
            "maximum" => value.as_f64().is_none_or(|value| value <= number()),
            "exclusiveMinimum" => value.as_f64().is_none_or(|value| value > number()),
            // Regular expressions are left to others: texts are told from numbers by their type.
            "pattern" => true,
            other => panic!("keyword {other}"),
        }
    };
    match schema {
        Value::Bool(allowed) => *allowed,
        schema => schema.as_object().unwrap().iter().all(holds),
    }
}

fn json(text: &str) -> Value {
    serde_json::to_value(toml::from_str::<toml::Table>(text).unwrap()).unwrap()
}

#[test]
fn shipped_scenes_conform_to_the_schema() {
    let schema = json_schema();
    for (name, text) in shipped() {
        assert!(conforms(&schema, &json(&text)), "{name}");
    }
    for wrong in [
        "tension.value = true",
        "tenson.value = 1",
        "bending.modulus = 1",
        "area = { constraint = \"exact\", modulus = 1 }",
        "area = { target = 1 }",
        "volume = { modulus = 1, target = 1, reduced = 0.5 }",
        "position = [1, 2]",
        "mesh = \"a.ply\"",
        "scale = 0",
    ] {
        let text = with(wrong);
        assert!(!conforms(&schema, &json(&text)), "{wrong}");
        assert!(parse(&text).is_err(), "{wrong}");
    }
}

// What nobody means.

/// Words out of which wrong scenes are made.
const WORDS: &[&str] = &[
    "[surface.bending]",
    "[[surface]]",
    "[surface.volume]",
    "[driver]",
    "[[interaction]]",
    "units",
    "=",
    "\"none\"",
    "\"micro\"",
    "modulus",
    "\"2e-19 J\"",
    "\"µ\"",
    "-1",
    "0",
    "1e999",
    "nan",
    "{",
    "}",
    "[",
    "]",
    ",",
    ".",
    "\n",
    "shape",
    "\"sphere:1\"",
    "vertices",
    "642",
    "\u{0}",
    "é",
    "target",
    "\"initial\"",
    "reduced",
    "constraint",
    "\"exact\"",
    "\"\"",
    "'",
    "\"",
    "#",
    "true",
    "reference",
    "9999999999999999999999999999999999999999999",
];

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn any_text_is_read_or_refused(text in "(?s).{0,200}") {
        let _ = parse(&text).map_err(|errors| errors.to_string());
    }

    #[test]
    fn any_words_are_read_or_refused(words in prop::collection::vec(prop::sample::select(WORDS), 0..60)) {
        let _ = parse(&words.join(" ")).map_err(|errors| errors.to_string());
    }

    #[test]
    fn mutated_scenes_are_read_or_refused(
        scene in 0..7_usize,
        cuts in prop::collection::vec((any::<prop::sample::Index>(), 0..12_usize, prop::sample::select(WORDS)), 1..4),
    ) {
        let (_, text) = &shipped()[scene];
        let mut text = Vec::from_iter(text.chars());
        for (at, length, word) in cuts {
            let at = at.index(text.len().max(1)).min(text.len());
            let end = (at + length).min(text.len());
            text.splice(at..end, word.chars());
        }
        let text = String::from_iter(text);
        match parse(&text) {
            // Whatever is read, the schema allows.
            Ok(_) => prop_assert!(conforms(&json_schema(), &json(&text)), "{}", text),
            Err(errors) => prop_assert!(!errors.to_string().is_empty()),
        }
    }

    #[test]
    fn any_override_is_read_or_refused(path in "[a-z0-9_.]{0,30}", value in "(?s).{0,30}", inside in any::<bool>()) {
        let start = if inside { "surface.0." } else { "" };
        if let Ok(overrides) = Overrides::new([format!("{start}{path}={value}")]) {
            let text = with("bending = { method = \"B\", modulus = 1 }");
            let read = SceneFile::parse(&text, Path::new("a.toml"), &overrides);
            let _ = read.map_err(|errors| errors.to_string());
        }
    }
}

#[test]
fn deep_texts_do_not_overflow_the_stack() {
    let depth = 100_000;
    let dotted = format!("{}a = 1", "a.".repeat(depth));
    let lists = format!("a = {}{}", "[".repeat(depth), "]".repeat(depth));
    let tables = format!("a = {}{}", "{a = ".repeat(depth), "}".repeat(depth));
    for text in [dotted, lists, tables] {
        assert!(parse(&text).is_err());
        let set = text.replacen(" = ", "=", 1);
        assert!(parse_with(&with(""), &[set]).is_err());
    }
}
