//! Interactions of surfaces with each other and with their images in a periodic box.

use super::super::{refused, valid};
use super::{capsule, unbuildable};
use helfrich_std::scene::InteractionScene;

/// Scene with a box of these lengths, and a repulsion at its end from line 16 on.
fn repelled(lengths: &str, between: &str) -> String {
    let lengths = format!("resolution = 6\nbox = {lengths}\n");
    capsule(&[("resolution = 6\n", &lengths)])
        + &format!("[[interaction]]\nkind = \"repulsion\"\nstrength = 1\ncutoff = 1.5\n{between}")
}

#[test]
fn one_surface_and_its_images_interact() {
    for (between, expected) in [
        ("", None),
        ("between = [\"capsule\", \"capsule\"]", Some([0.into(); 2])),
    ] {
        let text = repelled("[7, 7, 7]", between);
        let scene = valid(&text).scene;
        let [InteractionScene::Repulsion { between, .. }] = scene.interactions[..] else {
            panic!("{:?}", scene.interactions);
        };
        assert_eq!(between, expected);
        // In free space, the only surface has nothing to repel.
        let free = text
            .replace("lattice-boltzmann", "boundary-integral")
            .replace("resolution = 6\nbox = [7, 7, 7]\n", "");
        let message = super::parse(&free).expect_err("alone").to_string();
        assert!(message.contains("one would meet its images"), "{message}");
    }
    // Between walls along y, there are no images along y.
    let explanation = |text: &str| {
        let file = valid(text);
        let meshes = [super::placed(text)];
        file.scene.explain(&meshes).to_string()
    };
    for (between, expected) in [
        ("", "between all surfaces and their images"),
        (
            "between = [\"capsule\", \"capsule\"]",
            "between capsule and its images",
        ),
    ] {
        let text = explanation(&repelled("[7, 7, 7]", between));
        assert!(text.contains(expected), "{text}");
    }
}

#[test]
fn a_repulsion_reaches_less_far_than_the_box_is_long() {
    let text = repelled("[7, 7, 7]", "");
    refused(
        &text.replace("cutoff = 1.5", "cutoff = 7.1"),
        [20, 10],
        &["periodic along x, is 7 long", "choose a shorter `cutoff`"],
    );
    // Along y, which has walls, the range may exceed the box.
    valid(&repelled("[7, 3, 7]", "").replace("cutoff = 1.5", "cutoff = 6.9"));
}

/// An obstacle at one end of the box reaches through the periodic boundary to the other end.
#[test]
fn obstacles_are_met_through_the_ends() {
    let obstacle = |x: f64| {
        let lengths = "resolution = 6\nbox = [7, 7, 7]\n";
        capsule(&[("resolution = 6\n", lengths)])
            + &format!(
                "[[obstacle]]\nname = \"ball\"\nshape = \"sphere:1.2\"\nvertices = 162\n\
                 position = [{x}, 0, 0]\n"
            )
    };
    for x in [1.9, -5.1, 8.9] {
        let message = unbuildable(&obstacle(x));
        assert!(
            message.contains("starts inside the obstacle \"ball\""),
            "{message}"
        );
        let through = message.contains("through the ends of the periodic box");
        assert_eq!(through, x != 1.9, "{message}");
    }
    helfrich_std::simulation::build(&valid(&obstacle(3.5))).expect("apart");
}
