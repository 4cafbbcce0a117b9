//! The JSON of a glTF file, as far as it describes triangles.

use serde::Deserialize;

use super::super::{ParseError, Position, Problem};

/// Extensions without which positions and triangles cannot be read.
const COMPRESSED: [&str; 3] = [
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
];

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document {
    pub(super) scene: Option<usize>,
    #[serde(default)]
    pub(super) scenes: Vec<GltfScene>,
    #[serde(default)]
    pub(super) nodes: Vec<GltfNode>,
    #[serde(default)]
    pub(super) meshes: Vec<Mesh>,
    #[serde(default)]
    pub(super) accessors: Vec<Accessor>,
    #[serde(default)]
    pub(super) buffer_views: Vec<View>,
    #[serde(default)]
    pub(super) buffers: Vec<Buffer>,
    #[serde(default)]
    extensions_required: Vec<String>,
}

#[derive(Debug, Deserialize)]
pub(super) struct GltfScene {
    #[serde(default)]
    pub(super) nodes: Vec<usize>,
}

/// A node of the scene. Most nodes have few of these, so that boxes keep them small.
#[derive(Debug, Deserialize)]
pub(super) struct GltfNode {
    pub(super) mesh: Option<usize>,
    #[serde(default)]
    pub(super) children: Vec<usize>,
    pub(super) matrix: Option<Box<[f64; 16]>>,
    pub(super) translation: Option<Box<[f64; 3]>>,
    pub(super) rotation: Option<Box<[f64; 4]>>,
    pub(super) scale: Option<Box<[f64; 3]>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Mesh {
    pub(super) primitives: Vec<Primitive>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Primitive {
    pub(super) attributes: Attributes,
    pub(super) indices: Option<usize>,
    pub(super) mode: Option<u32>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Attributes {
    #[serde(rename = "POSITION")]
    pub(super) position: Option<usize>,
}

/// Numbers in a view of a buffer; zeros if there is no view.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    buffer_view: Option<usize>,
    #[serde(default)]
    byte_offset: usize,
    component_type: u32,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) count: usize,
    #[serde(rename = "type")]
    pub(super) shape: String,
    pub(super) sparse: Option<Box<Sparse>>,
}

impl Accessor {
    pub(super) fn stored(&self) -> StoredBytes {
        StoredBytes {
            buffer_view: self.buffer_view,
            byte_offset: self.byte_offset,
            component_type: self.component_type,
        }
    }
}

/// A place in a view, and the type of the numbers there.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct StoredBytes {
    pub(super) buffer_view: Option<usize>,
    #[serde(default)]
    pub(super) byte_offset: usize,
    /// Missing for the values of a sparse accessor, which have that of the accessor.
    #[serde(default)]
    pub(super) component_type: u32,
}

/// Numbers that replace others.
#[derive(Debug, Deserialize)]
pub(super) struct Sparse {
    pub(super) count: usize,
    pub(super) indices: StoredBytes,
    pub(super) values: StoredBytes,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct View {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) byte_length: usize,
    pub(super) byte_stride: Option<usize>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Buffer {
    pub(super) uri: Option<String>,
}

impl Document {
    pub(super) fn parse(json: &[u8]) -> Result<Self, ParseError> {
        let document: Self = serde_json::from_slice(json).map_err(|error| {
            let text = error.to_string();
            let text = text.split(" at line ").next().unwrap_or_default();
            let shown = String::from_iter(text.chars().take(100));
            let problem = Problem::Expected {
                expected: "the JSON of a glTF file",
                found: format!("`{}`", shown.escape_debug()),
            };
            problem.at(Position::Line(error.line()), None)
        })?;
        let mut required = document.extensions_required.iter();
        match required.find(|name| COMPRESSED.contains(&name.as_str())) {
            None => Ok(document),
            Some(name) => {
                let problem = Problem::Expected {
                    expected: "triangles that are not compressed",
                    found: format!("the extension {name}: save the file without it"),
                };
                Err(problem.anywhere())
            }
        }
    }
}
