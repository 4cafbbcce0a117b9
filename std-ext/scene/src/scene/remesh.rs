//! New meshes of a surface during a run, and changes of its topology.

use super::builder::Builder;
use super::effects::Effects;
use super::keys::{Form, Key, Keys, Range, optional, positive};
use super::parameter::Parameters;
use super::reader::Reader;
use super::units::Dimension;
use super::{Boundary, SurfaceScene};
use serde::Serialize;

pub(super) const REMESH: Key = optional(
    "remesh",
    Form::Either(&[Form::Choice(|| vec![AUTO]), TABLE]),
    "New meshes of the smooth surface through the vertices, whenever triangles have become narrow: \"auto\", or a table \
     with the lengths of the edges; by default the mesh stays as it is. The membrane has to be fluid. \"auto\": as many \
     vertices in proportion to the area as at the start, with edges of the same length everywhere.",
);

const AUTO: &str = "auto";

const TABLE: Form = Form::Table(&SIZES);

static SIZES: Keys = Keys {
    keys: &[
        optional(
            "edge",
            positive(Dimension::LENGTH),
            "Length of the edges, the same everywhere.",
        ),
        optional(
            "vertices",
            Form::Count(12),
            "Number of vertices, with edges of the same length everywhere.",
        ),
        optional(
            "curvature",
            positive(Dimension::NONE),
            "Angle in degrees by which the surface turns along an edge at most.",
        ),
        optional(
            "error",
            Form::Number(Dimension::NONE, Range::Fraction),
            "Error of H, in parts of the largest |H|, up to which edges are as long as possible.",
        ),
    ],
    exactly_one: &[&["edge", "vertices", "curvature", "error"]],
    at_most_one: &[],
    needs: &[],
    kinds: &[],
};

pub(super) const TOPOLOGY: Key = optional(
    "topology",
    Form::Either(&[
        Form::Choice(|| CHANGES.map(|(name, _)| name).to_vec()),
        EXTENTS,
    ]),
    "Whether a surface with `remesh` may part or join; by default the topology stays. \"may-break\": necks are cut and closed \
     on both sides, and holes are closed, when they are shorter around than a circle whose radius is the mean length of the \
     edges. \"may-fuse\": parts of the surface that face each other join where they are nearer than half a mean edge, \
     outside as drops do, or inside. \"may-change\": both. A table sets the lengths of what may happen. Volumes stay, and \
     each part gets its share of what is held.",
);

/// Names of changes: a neck and a film as short as that, in mean edges.
const CHANGES: [(&str, Topology); 3] = [
    (
        "may-break",
        Topology {
            neck: Some(Extent::Edges(1.0)),
            film: None,
        },
    ),
    (
        "may-fuse",
        Topology {
            neck: None,
            film: Some(Extent::Edges(0.5)),
        },
    ),
    (
        "may-change",
        Topology {
            neck: Some(Extent::Edges(1.0)),
            film: Some(Extent::Edges(0.5)),
        },
    ),
];

const EXTENTS: Form = Form::Table(&RADIUS);

static RADIUS: Keys = Keys {
    keys: &[
        optional(
            "radius",
            positive(Dimension::LENGTH),
            "Radius below which necks are cut and holes are closed.",
        ),
        optional(
            "film",
            positive(Dimension::LENGTH),
            "Thickness below which films between parts that face each other break.",
        ),
    ],
    exactly_one: &[],
    at_most_one: &[],
    needs: &[],
    kinds: &[],
};

/// Changes of the topology of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Topology {
    /// The radius of necks that are cut and of holes that are closed; `None` if they stay.
    pub neck: Option<Extent>,
    /// The thickness of films that break; `None` if they stay.
    pub film: Option<Extent>,
}

/// A length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Extent {
    /// In mean lengths of the edges.
    Edges(f64),
    /// As it is.
    Length(f64),
}

impl Extent {
    /// The length on a mesh with this mean length of the edges.
    pub fn of(self, edge: f64) -> f64 {
        match self {
            Self::Edges(edges) => edges * edge,
            Self::Length(length) => length,
        }
    }

    fn words(self, name: &'static str, number: &Parameters) -> String {
        match self {
            Self::Edges(edges) => format!("{name} = {edges} mean edges"),
            Self::Length(length) => number.of(name, length, Dimension::LENGTH).to_string(),
        }
    }
}

impl Topology {
    pub(super) fn read(surface: Reader<'_>) -> Option<Self> {
        if let Some(name) = surface.text("topology") {
            let mut changes = CHANGES.into_iter();
            return changes.find_map(|(known, change)| (known == name).then_some(change));
        }
        let table = surface.table("topology")?;
        let length = |key: &str| table.number(key).map(Extent::Length);
        Some(Self {
            neck: length("radius"),
            film: length("film"),
        })
    }

    /// The changes in words.
    pub(crate) fn words(self, number: &Parameters) -> String {
        let neck = self.neck.map(|radius| {
            let radius = radius.words("radius", number);
            format!("thinner necks are cut and smaller holes are closed: {radius}")
        });
        let film = self.film.map(|film| {
            let film = film.words("film", number);
            format!("thinner films break: {film}")
        });
        Vec::from_iter(neck.into_iter().chain(film)).join("; ")
    }
}

/// Edges of the new meshes of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Remesh {
    /// As many vertices in proportion to the area as at the start.
    Auto,
    /// Edges of this length.
    Edge(f64),
    /// This number of vertices.
    Vertices(usize),
    /// Edges along which the surface turns by this angle, in degrees.
    Curvature(f64),
    /// Edges as long as this error of H allows, in parts of the largest |H|.
    Error(f64),
}

impl Remesh {
    pub(super) fn read(surface: Reader<'_>) -> Option<Self> {
        if surface.text("remesh") == Some(AUTO) {
            return Some(Self::Auto);
        }
        let table = surface.table("remesh")?;
        let number = |key: &str| table.number(key);
        let edge = number("edge").map(Self::Edge);
        let curvature = number("curvature").map(Self::Curvature);
        let error = number("error").map(Self::Error);
        let count = table.count("vertices").map(|count| {
            let count = usize::try_from(count);
            Self::Vertices(count.unwrap_or(usize::MAX))
        });
        edge.or(curvature).or(error).or(count)
    }

    /// The edges in words.
    pub(crate) fn words(self, number: &Parameters) -> String {
        match self {
            Self::Auto => "as many vertices for its area as at the start".to_owned(),
            Self::Edge(length) => number.of("edge", length, Dimension::LENGTH).to_string(),
            Self::Vertices(count) => format!("{count} vertices"),
            Self::Curvature(angle) => format!("at most {angle}° an edge"),
            Self::Error(part) => format!("errors of H of at most {} %", 100.0 * part),
        }
    }
}

impl Builder<'_> {
    /// Refuses new meshes of surfaces whose vertices have to stay.
    pub(super) fn remesh(&mut self, surface: &SurfaceScene, reader: Reader<'_>) {
        if surface.remesh.is_none() {
            return;
        }
        let name = &surface.name;
        if let Some(Topology {
            neck: None,
            film: None,
        }) = surface.topology
        {
            self.contradiction(
                &reader.origin_of("topology"),
                "`topology` allows nothing: set `radius` for necks and holes, `film` for films, or both".to_owned(),
            );
        }
        let mut refuse = |message: String| {
            self.contradiction(&reader.origin_of("remesh"), message);
        };
        if let Some(effect) = Effects::solid(&surface.effects).next() {
            refuse(format!(
                "\"{name}\" remembers where its material was, by `{effect}`, and vertices of a new mesh were nowhere: leave \
                 `remesh` or `{effect}` out"
            ));
        }
        if surface.boundary != Boundary::Free {
            refuse(format!(
                "the edge of \"{name}\" is supported, and its vertices have to stay: leave `remesh` out, or choose \
                 `boundary = \"free\"`"
            ));
        }
    }
}
