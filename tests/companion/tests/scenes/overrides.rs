//! Values that override those of the file.

use super::{parse_with, with};
use helfrich_std::method::BendingMethod;
use helfrich_std::scene::{Every, Material, Overrides};

/// An empty value removes a key; removing a missing key is no error, unless the scene needs it.
#[test]
fn overrides_take_away() {
    let text = with("bending = { method = \"B\", modulus = 1 }\ntension = { value = 2 }");
    let surface = |sets: &[&str]| {
        let file = parse_with(&text, sets).unwrap_or_else(|errors| panic!("{errors}"));
        file.scene.surfaces[0].clone()
    };
    let without = surface(&["surface.0.bending="]);
    let names = Vec::from_iter(without.effects.names());
    assert_eq!(names, ["tension"]);
    assert_eq!(without.effects.tension.unwrap().value, 2.0);
    let same = surface(&[]);
    assert_eq!(
        surface(&["surface.cell.elasticity.reference.scale = "]),
        same
    );
    assert_eq!(surface(&["surface.0.bending.spontaneous_curvature="]), same);
    let again = surface(&[
        "surface.0.bending=",
        "surface.0.bending={ method = \"B\", modulus = 1 }",
    ]);
    assert_eq!(again, same);
    let errors = parse_with(&text, &["surface.0.bending.modulus="]).unwrap_err();
    assert!(errors.to_string().contains("modulus"), "{errors}");
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
            .effects
            .bending
            .unwrap()
            .modulus,
        Material::Number(0.3)
    );
    assert_eq!(
        one("surface.cell.bending.modulus = 3")
            .effects
            .bending
            .unwrap()
            .modulus,
        Material::Number(3.0)
    );
    assert_eq!(
        one("surface.0.bending.modulus=2e-19 J")
            .effects
            .bending
            .unwrap()
            .modulus,
        Material::Number(0.2)
    );
    assert_eq!(
        one("surface.0.bending.modulus=\"2e-19 J\"")
            .effects
            .bending
            .unwrap()
            .modulus,
        Material::Number(0.2)
    );
    assert_eq!(
        one("surface.0.bending.method=J")
            .effects
            .bending
            .unwrap()
            .method,
        BendingMethod::Jet
    );
    let tension = one("surface.0.tension.value=3").effects.tension;
    assert_eq!(tension.unwrap().value, 3.0);
    assert_eq!(one("surface.0.position=[1,2,3]").position, [1.0, 2.0, 3.0]);
    assert_eq!(
        one("surface.0.shape=ellipsoid:1,2,3").source,
        one("surface.cell.shape=\"ellipsoid:1,2,3\"").source
    );
    let later = parse_with(&text, &["output.every=3", "output.every=4"]).unwrap();
    assert_eq!(later.scene.output.every, Every::Iterations(4));
    // A surface without a name has a default name.
    let unnamed = text.replace("name = \"cell\"\n", "");
    let found = parse_with(&unnamed, &["surface.surface-1.tension.value=2"]).unwrap();
    assert_eq!(found.scene.surfaces[0].effects.tension.unwrap().value, 2.0);
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
    refused("units.a=1", &["`units` is a value, not a table"]);
    refused("surface.0.vertices=11", &["between 12 and"]);
    let error = Overrides::new(["surface"]).unwrap_err().to_string();
    assert!(
        error.contains("`surface` sets nothing: write path.to.key=value"),
        "{error}"
    );
    assert!(Overrides::new(["=3"]).is_err());
}
