//! Support of the edges of open surfaces.

use super::keys::{Form, Key, optional};
use helfrich::{TriangleMesh, VertexKind};
use serde::Serialize;

pub(super) const BOUNDARY: Key = optional(
    "boundary",
    Form::Choice(|| Boundary::ALL.map(Boundary::name).to_vec()),
    "Support of the edge of an open surface: \"free\", as by default; \"hinged\", held in place but free \
     to turn; \"clamped\", held in place and direction, with the first row of vertices beside it.",
);

/// The support of the edge of an open surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Boundary {
    /// The edge moves, and no force or torque acts on it but those of the effects.
    #[default]
    Free,
    /// The vertices of the edge stay where they are. No torque acts: the membrane is free to turn.
    Hinged,
    /// The vertices of the edge and their neighbours stay where they are, and with them the normal at
    /// the edge.
    Clamped,
}

impl Boundary {
    const ALL: [Self; 3] = [Self::Free, Self::Hinged, Self::Clamped];

    const fn name(self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Hinged => "hinged",
            Self::Clamped => "clamped",
        }
    }

    pub(super) fn parse(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|boundary| boundary.name() == name)
    }

    pub(crate) fn is_free(&self) -> bool {
        *self == Self::Free
    }

    /// Whether each vertex is fixed; empty if none is.
    pub(crate) fn fixed(self, mesh: &TriangleMesh) -> Vec<bool> {
        let at_edge = |vertex: usize| mesh.vertex_kind(vertex) == VertexKind::Boundary;
        let beside = |vertex: usize| mesh.one_ring(vertex).iter().any(|&v| at_edge(v as usize));
        let vertices = 0..mesh.vertex_count();
        match self {
            Self::Free => Vec::new(),
            Self::Hinged => vertices.map(at_edge).collect(),
            Self::Clamped => vertices.map(|v| at_edge(v) || beside(v)).collect(),
        }
    }
}
