//! Support of the edges of open surfaces.

use super::keys::{Form, Key, optional};
use helfrich::{TriangleMesh, VertexKind};
use serde::Serialize;

pub(super) const BOUNDARY: Key = optional(
    "boundary",
    Form::Choice(|| Boundary::ALL.map(Boundary::name).to_vec()),
    "Support of the edge of an open surface: \"free\", the default; \"hinged\", fixed but free to \
     rotate; \"clamped\", fixed in position and direction, with the first row of vertices next to it.",
);

/// The support of the edge of an open surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Boundary {
    /// The edge moves; only the effects exert forces or torques on it.
    #[default]
    Free,
    /// The vertices of the edge are fixed. No torque acts there: the membrane is free to rotate about
    /// the edge.
    Hinged,
    /// The vertices of the edge and their neighbours are fixed, and with them the normal at the edge.
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
