//! Scenes that are shipped with the library, by name.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// The folder name of shipped scenes in messages.
const FOLDER: &str = "<helfrich>";

/// A scene that is shipped with the library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShippedScene {
    /// The name by which it can be run: the name of its file without `.toml`.
    pub name: &'static str,
    /// The file's content.
    pub text: &'static str,
}

macro_rules! scenes {
    ($($name:literal)*) => {
        [$(ShippedScene {
            name: $name,
            text: include_str!(concat!("../../scenes/", $name, ".toml")),
        }),*]
    };
}

/// All shipped scenes.
pub const SHIPPED: [ShippedScene; 21] = scenes![
    "capsule-constriction"
    "capsule-pair"
    "capsule-shear"
    "capsule-shear-lattice"
    "drop-breakup"
    "drop-pipette"
    "drops-adhere"
    "red-blood-cell-relax"
    "red-blood-cell-shear"
    "red-blood-cell-stretched"
    "suspension-shear"
    "two-domains"
    "vesicle-branches"
    "vesicle-bud"
    "vesicle-dumbbell"
    "vesicle-oblate-0.7"
    "vesicle-oblate-unstable-0.9"
    "vesicle-prolate-0.8"
    "vesicle-prolate-0.9"
    "vesicle-shear"
    "vesicle-tether"
];

/// Further files that scenes need.
const FILES: [(&str, &str); 6] = [
    (
        "capsule-shear-published.csv",
        include_str!("../../scenes/capsule-shear-published.csv"),
    ),
    (
        "scene.schema.json",
        include_str!("../../scenes/scene.schema.json"),
    ),
    (
        "two-domains.ply",
        include_str!("../../scenes/two-domains.ply"),
    ),
    (
        "vesicle-oblate.ply",
        include_str!("../../scenes/vesicle-oblate.ply"),
    ),
    (
        "vesicle-prolate.ply",
        include_str!("../../scenes/vesicle-prolate.ply"),
    ),
    (
        "vesicle-stomatocyte.ply",
        include_str!("../../scenes/vesicle-stomatocyte.ply"),
    ),
];

impl ShippedScene {
    /// The shipped scene that a path names: a name without a folder, if no file has this name.
    pub fn named(path: &Path) -> Option<Self> {
        let is = |scene: &Self| path.as_os_str() == OsStr::new(scene.name);
        let found = SHIPPED.into_iter().find(is)?;
        (!path.is_file()).then_some(found)
    }

    /// The title in the scene.
    pub fn title(self) -> &'static str {
        let line = self.text.lines().find_map(|line| {
            let (_, title) = line.strip_prefix("title")?.split_once('"')?;
            title.strip_suffix('"')
        });
        line.unwrap_or_default()
    }

    /// The path of the scene in messages; files that the scene names are relative to it.
    pub fn path(self) -> PathBuf {
        Path::new(FOLDER).join(format!("{}.toml", self.name))
    }
}

/// All files that are needed to run the scenes from a folder, each with its name and content.
pub fn shipped_files() -> impl Iterator<Item = (String, &'static str)> {
    let scenes = SHIPPED.iter();
    let scenes = scenes.map(|scene| (format!("{}.toml", scene.name), scene.text));
    scenes.chain(FILES.map(|(name, text)| (name.to_owned(), text)))
}

/// The content of a file that a shipped scene names.
pub fn shipped_file(path: &Path) -> Option<&'static [u8]> {
    let name = path.strip_prefix(FOLDER).ok()?;
    let is = |(known, _): &(&str, &str)| name.as_os_str() == OsStr::new(known);
    Some(FILES.into_iter().find(is)?.1.as_bytes())
}
