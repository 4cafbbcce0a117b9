//! Adhesion between surfaces, and obstacles and suction in relaxations.

use super::{generated, refused, the_error, valid, with};
use helfrich_std::scene::InteractionScene;

const PIPETTE: &str = "tension.value = 1
aspiration = { pressure = \"-3 Pa\", mouth = [0, 0, \"2 µm\"], axis = [0, 0, 3], width = 0.1 }
[[obstacle]]
name = \"rim\"
shape = \"torus:2,0.5\"
vertices = 100
position = [0, 0, 4]
";

const STICKY: &str =
    "[[interaction]]\nkind = \"adhesion\"\nenergy = \"2 nN/m\"\ndistance = 0.1\ncutoff = 0.5\n";

#[test]
fn suction_and_adhesion_are_read() {
    let file = valid(&with(&format!(
        "{PIPETTE}{STICKY}between = [\"rim\", \"cell\"]"
    )));
    let suction = file.scene.surfaces[0].effects.aspiration.expect("suction");
    assert_eq!((suction.pressure, suction.width), (-3.0, 0.1));
    assert_eq!(
        (suction.mouth, suction.axis),
        ([0.0, 0.0, 2.0], [0.0, 0.0, 3.0])
    );
    let adhesion = InteractionScene::Adhesion {
        energy: 2e-3,
        distance: 0.1,
        cutoff: 0.5,
        between: Some([1.into(), 0.into()]),
        parts: false,
    };
    assert_eq!(file.scene.interactions, [adhesion]);
    let mesh = [generated(&file, 0)];
    let explained = file.scene.explain(&mesh).to_string();
    for part in [
        "aspiration",
        "adhesion",
        "between rim and cell",
        "distance = 0.1",
    ] {
        assert!(explained.contains(part), "`{part}` is not in {explained}");
    }
}

#[test]
fn interactions_with_obstacles_say_what_is_needed() {
    refused(
        &with(PIPETTE),
        [10, 1],
        &["nothing keeps surfaces away from this obstacle: add an [[interaction]]"],
    );
    let second = "[[obstacle]]\nname = \"plug\"\nshape = \"sphere:1\"\nvertices = 42\nposition = [0, 0, 8]\n";
    refused(
        &with(&format!(
            "{PIPETTE}{second}{STICKY}between = [\"rim\", \"plug\"]"
        )),
        [25, 11],
        &["`between` names two obstacles, which do not move"],
    );
    refused(
        &with(&format!("{PIPETTE}{STICKY}between = [\"cell\", \"rin\"]")),
        [20, 11],
        &["`between` cannot be \"rin\": did you mean `rim`?"],
    );
    let same = PIPETTE.replace("\"rim\"", "\"cell\"");
    let (_, message) = the_error(&with(&format!("{same}{STICKY}")));
    assert!(
        message.contains("the obstacle has the name \"cell\" of a surface"),
        "{message}"
    );
    let (_, message) = the_error(&with(
        &format!("{PIPETTE}{STICKY}").replace("distance = 0.1", "distance = 0.5"),
    ));
    assert!(
        message.contains("beyond the reach of the adhesion, 0.5"),
        "{message}"
    );
    let (_, message) = the_error(&with(&format!("{PIPETTE}{STICKY}strength = 1\n")));
    assert!(
        message.contains("`strength` belongs to the kind \"repulsion\""),
        "{message}"
    );
}

/// The rim of a contact can move where the gap opens within its range over more than an edge.
#[test]
fn adhesion_needs_short_edges() {
    let scene = |cutoff: f64| {
        let sticky = STICKY.replace("cutoff = 0.5", &format!("cutoff = {cutoff}"));
        valid(&with(&format!("{PIPETTE}{sticky}")))
    };
    let info = generated(&scene(3.0), 0);
    assert!(scene(3.0).mesh_warnings(0, &info).is_empty());
    let warnings = scene(0.3).mesh_warnings(0, &info);
    let pinned = warnings.iter().filter(|warning| {
        let message = warning.to_string();
        message.contains("the rim of a contact, where the gap opens")
    });
    assert_eq!(pinned.count(), 1, "{warnings:?}");
}
