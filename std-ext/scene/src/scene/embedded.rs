//! Effects on a mesh in memory, for engines that move its vertices themselves.

use super::keys::{Keys, plain};
use super::mesh_source::{MeshFileSource, MeshFiles};
use super::read::{checked, values};
use super::source::Source;
use super::value::{Entry, Node, Origin, Table, Value};
use super::{Overrides, SceneErrors, SceneFile, effects};
use crate::io::{Column, MeshFile};
use std::path::PathBuf;

/// The keys of such a text: the effects of a surface. `units` and `temperature` are those of a scene.
static EFFECTS: Keys = plain(effects::KEYS);
const OF_SCENE: [&str; 2] = ["units", "temperature"];

/// The name of the mesh in messages.
const MESH: &str = "mesh";

fn entry(key: &str, value: Value) -> Entry {
    Entry {
        key: key.to_owned(),
        key_origin: Origin::File,
        node: Node {
            value,
            origin: Origin::File,
        },
    }
}

impl SceneFile {
    /// Reads the effects on one surface whose mesh is in memory, from TOML with the keys that effects have
    /// in the table of a surface: `bending = { method = "j6", modulus = 1.0 }`. The positions of the mesh are
    /// those of the start: references, initial areas and initial volumes are measured there.
    ///
    /// Plain numbers have no units unless the text has the key `units = "micro"`. Mesh files of references are
    /// relative to the working directory. Numbers at vertices or triangles come from `columns`. The scene has
    /// the driver "relax", which nobody runs: forces are evaluated by a
    /// [`Simulation`](crate::simulation::Simulation) of it.
    ///
    /// # Errors
    /// Everything that is wrong with the text.
    pub fn of_effects(
        text: &str,
        file: MeshFile,
        columns: Vec<Column>,
    ) -> Result<Self, SceneErrors> {
        let source = Source {
            path: PathBuf::from("effects"),
            text: text.to_owned(),
            overrides: Overrides::default(),
        };
        let given = values(&source)?;
        let is_of_scene = |entry: &Entry| OF_SCENE.contains(&entry.key.as_str());
        let (mut entries, mut surface): (Vec<Entry>, Vec<Entry>) =
            given.entries.into_iter().partition(is_of_scene);
        let unknown = |entry: &&Entry| EFFECTS.find(&entry.key).is_none();
        let problems = surface.iter().filter(unknown).map(|entry| {
            let problem = EFFECTS.unknown("", &entry.key);
            (entry.key_origin.clone(), problem)
        });
        let problems = Vec::from_iter(problems);
        surface.retain(|entry| EFFECTS.find(&entry.key).is_some());
        surface.push(entry("mesh", Value::Text(MESH.to_owned())));
        let surface = Node {
            value: Value::Table(Table { entries: surface }),
            origin: Origin::File,
        };
        let driver = vec![entry("kind", Value::Text("relax".to_owned()))];
        entries.push(entry("surface", Value::List(vec![surface])));
        entries.push(entry("driver", Value::Table(Table { entries: driver })));
        if !entries.iter().any(|entry| entry.key == "units") {
            entries.push(entry("units", Value::Text("none".to_owned())));
        }
        let mesh = MeshFileSource {
            path: PathBuf::from(MESH),
            weld: None,
        };
        let meshes = MeshFiles::in_memory(mesh, file, columns);
        checked(source, Table { entries }, problems, meshes)
    }
}
