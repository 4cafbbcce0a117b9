//! Scenes that are shipped with the library: all scenes of the folder, by name.

use helfrich_std::plots::read_curves;
use helfrich_std::scene::{Overrides, SHIPPED, SceneFile, shipped_files};
use std::fs;
use std::path::Path;

#[test]
fn every_scene_of_the_folder_is_shipped() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../std-ext/scene/scenes");
    let mut scenes = Vec::new();
    for entry in fs::read_dir(&folder).expect("the folder") {
        let path = entry.expect("a file").path();
        if path
            .extension()
            .is_some_and(|extension| extension == "toml")
        {
            let stem = path.file_stem().expect("a name");
            scenes.push(stem.to_str().expect("text").to_owned());
        }
    }
    scenes.sort();
    let mut shipped = SHIPPED.map(|scene| scene.name.to_owned()).to_vec();
    shipped.sort();
    assert_eq!(shipped, scenes);
    for (name, text) in shipped_files() {
        let file = fs::read_to_string(folder.join(&name)).expect("the file");
        assert_eq!(text, file, "{name}");
    }
}

#[test]
fn shipped_scenes_are_read_by_name_with_what_they_name() {
    for scene in SHIPPED {
        let file = SceneFile::read(Path::new(scene.name), &Overrides::default());
        let file = file.unwrap_or_else(|errors| panic!("{}: {errors}", scene.name));
        assert!(!scene.title().is_empty(), "{}", scene.name);
        let plots = file.scene.output.plots.iter();
        for published in plots.filter_map(|plot| plot.published.as_deref()) {
            read_curves(published).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
        }
    }
    let errors = SceneFile::read(Path::new("no-such-scene"), &Overrides::default());
    let message = errors.expect_err("no scene").to_string();
    assert!(
        message.contains("`helfrich scenes` lists them"),
        "{message}"
    );
}
