//! Scene files: what is right is read, what is wrong is said.

use helfrich_std::scene::{Overrides, SceneFile};
use std::path::Path;

fn read(name: &str) -> SceneFile {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../std-ext/scenes");
    SceneFile::read(&folder.join(name), &Overrides::default())
        .unwrap_or_else(|errors| panic!("{errors}"))
}

#[test]
fn shipped_scenes_are_valid() {
    let file = read("vesicle-prolate-0.9.toml");
    assert_eq!(file.warnings, []);
    assert_eq!(file.scene.surfaces[0].name, "vesicle");
}
