//! Stress-free positions of a mesh.

use super::super::MeshFileSource;
use super::super::keys::{Form, Keys, NUMBER, optional};
use super::super::mesh_source::WELD;
use super::super::value::Origin;
use super::{Builder, EffectError, MeshSource, Named, Preparation, Reader};
use crate::effect::{CompiledPotential, in_plane};
use crate::generate::{AnyShape, Family};
use helfrich::{InPlane, StrainEnergy, Surface};
use serde::Serialize;
use std::fmt;

/// The stress-free positions of a mesh.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reference {
    /// The source of the positions.
    pub source: ReferenceSource,
    /// Factor by which they are scaled: a reference smaller than the surface stretches it.
    pub scale: f64,
}

/// The source of the positions of a reference. A reference is not rotated or moved, because stress
/// depends on neither.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReferenceSource {
    /// The initial surface, with its own scale.
    Initial,
    /// The surface's mesh generated on another shape, with its family, vertices and seed.
    Shape(#[serde(serialize_with = "crate::scene::mesh_source::as_text")] AnyShape),
    /// A mesh file with the triangles of the surface.
    File(MeshFileSource),
}

/// `"initial"` or a table.
pub(super) const FORM: Form = Form::Either(&[Form::Choice(|| vec!["initial"]), Form::Table(&KEYS)]);

static KEYS: Keys = Keys {
    keys: &[
        optional(
            "shape",
            Form::Shape,
            "The surface's mesh on another exact shape, with its family, vertices and seed.",
        ),
        optional(
            "mesh",
            Form::File,
            "Mesh file with the triangles of the surface, relative to the scene's folder.",
        ),
        WELD,
        optional(
            "scale",
            NUMBER,
            "Factor by which the reference is scaled; by default 1. The initial surface is scaled if \
             neither shape nor mesh is given.",
        ),
    ],
    exactly_one: &[],
    at_most_one: &[&["shape", "mesh"]],
    needs: &[["weld", "mesh"]],
    kinds: &[],
};

impl Reference {
    /// Reads the key `reference` of an effect of a surface with this mesh.
    pub(super) fn read(table: Reader<'_>, source: &MeshSource, builder: &mut Builder<'_>) -> Self {
        let Some(reader) = table.table("reference") else {
            return Self {
                source: ReferenceSource::Initial,
                scale: 1.0,
            };
        };
        let shape = reader.text("shape").and_then(|text| text.parse().ok());
        let origin = reader.origin_of("shape");
        let reference = match (shape, reader.text("mesh")) {
            (Some(shape), _) => {
                check_shape(&origin, shape, source, builder);
                ReferenceSource::Shape(shape)
            }
            (_, Some(mesh)) => ReferenceSource::File(builder.mesh_file(mesh, reader)),
            _ => ReferenceSource::Initial,
        };
        Self {
            source: reference,
            scale: reader.number("scale").unwrap_or(1.0),
        }
    }

    /// Whether the surface is stress-free at the start, up to a scale.
    pub(crate) fn is_initial(&self) -> bool {
        self.source == ReferenceSource::Initial
    }
}

/// Reports shapes that cannot have the triangles of the surface.
fn check_shape(
    origin: &Origin,
    reference: AnyShape,
    source: &MeshSource,
    builder: &mut Builder<'_>,
) {
    let is_torus = |shape: &AnyShape| matches!(shape, AnyShape::Torus(_));
    let why = match source {
        MeshSource::File(_) => {
            "the surface is a mesh file: its reference is \"initial\" or a mesh file with the same \
             triangles, { mesh = \"…\" }"
        }
        MeshSource::Shape { family, .. } if *family == Family::Irregular => {
            "the triangles of an irregular mesh depend on the shape: choose another family"
        }
        MeshSource::Shape { shape, .. }
            if is_torus(shape) != is_torus(&reference)
                || (is_torus(shape) && *shape != reference) =>
        {
            "the meshes of the two shapes have different triangles: choose a shape like the surface's, \
             and no other torus for a torus"
        }
        MeshSource::Shape { .. } => return,
    };
    let message = format!("no reference on the {}: {why}", reference.name());
    builder.contradiction(origin, message);
}

impl fmt::Display for Reference {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.source {
            ReferenceSource::Initial => write!(formatter, "at the start")?,
            ReferenceSource::Shape(shape) => write!(formatter, "on {shape}")?,
            ReferenceSource::File(file) => write!(formatter, "as in {file}")?,
        }
        if self.scale == 1.0 {
            return Ok(());
        }
        write!(formatter, ", scaled by {}", self.scale)
    }
}

impl Preparation<'_> {
    /// Adds a law of in-plane elasticity over the reference of its effect.
    pub(super) fn in_plane<E: Named, W>(
        &mut self,
        law: W,
        reference: &Reference,
    ) -> Result<(), EffectError>
    where
        W: StrainEnergy<f64>,
        InPlane<f64, W>: CompiledPotential,
    {
        let unstressed = Surface::new(self.mesh(), &self.unstressed)?;
        self.conservative(E::NAME, in_plane(law, unstressed, reference.scale)?)
    }
}
