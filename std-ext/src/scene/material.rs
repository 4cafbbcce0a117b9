//! Parameters of the membrane that may be different at each vertex.

use super::builder::Builder;
use super::keys::{Form, Keys, plain, required};
use super::reader::Reader;
use super::{MeshFileSource, MeshSource};
use crate::io::Column;
use crate::six::Six;
use helfrich::MaterialParameter;
use serde::{Serialize, Serializer};
use std::sync::Arc;

/// A column of the mesh file, as the alternative to a number.
pub(super) const COLUMN: Form = Form::Table(&KEYS);

static KEYS: Keys = plain(&[required(
    "column",
    Form::Text,
    "The name of a column of the surface's mesh file, one number for each vertex in the scene's units: \
     an array of one component in the PointData of a VTP file, or a property of the vertices of a PLY \
     file.",
)]);

/// A parameter of the membrane: a number, or one for each vertex.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Material {
    /// The same everywhere.
    Number(f64),
    /// From a column of the surface's mesh file, in the scene's units. Each number belongs to the material
    /// at its vertex and moves with it; a `scale` of the surface does not change it.
    Column {
        /// The column.
        #[serde(serialize_with = "by_name")]
        column: Arc<Column>,
    },
}

fn by_name<S: Serializer>(column: &Arc<Column>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&column.name)
}

impl Material {
    /// Reads the key `key`, a number or a column of the mesh of the surface; `None` if the key is
    /// absent or its column has a problem, which is then reported.
    pub(super) fn read(
        table: Reader<'_>,
        key: &str,
        source: &MeshSource,
        builder: &mut Builder<'_>,
    ) -> Option<Self> {
        if let Some(number) = table.number(key) {
            return Some(Self::Number(number));
        }
        let reader = table.table(key)?;
        let name = reader.text("column")?;
        let found = builder.column(name, source).and_then(|column| {
            let range = table.range(key);
            let wrong = |&(_, value): &(usize, &f64)| !(value.is_finite() && range.contains(*value));
            match column.values.iter().enumerate().find(wrong) {
                None => Ok(Self::Column { column }),
                Some((vertex, value)) => Err(format!(
                    "the column \"{name}\" is {value} at vertex {vertex}: `{key}` has to be a finite \
                     number {}",
                    range.words()
                )),
            }
        });
        found
            .map_err(|message| builder.contradiction(&reader.origin_of("column"), message))
            .ok()
    }

    /// The numbers: one, or one for each vertex.
    pub fn values(&self) -> &[f64] {
        match self {
            Self::Number(number) => std::slice::from_ref(number),
            Self::Column { column } => &column.values,
        }
    }

    /// The column, if it is one.
    pub(crate) fn column(&self) -> Option<&Arc<Column>> {
        match self {
            Self::Number(_) => None,
            Self::Column { column } => Some(column),
        }
    }

    /// The smallest of the numbers.
    pub fn least(&self) -> f64 {
        self.values().iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The largest of the numbers.
    pub fn largest(&self) -> f64 {
        let values = self.values().iter().copied();
        values.fold(f64::NEG_INFINITY, f64::max)
    }

    /// The number, if it is the same everywhere.
    pub fn uniform(&self) -> Option<f64> {
        let parameter = self.parameter();
        (!parameter.varies()).then(|| parameter.at(0))
    }

    /// The parameter in the form that methods take.
    pub(crate) fn parameter(&self) -> MaterialParameter<f64> {
        match self {
            Self::Number(number) => MaterialParameter::Constant(*number),
            Self::Column { column } => MaterialParameter::PerVertex(column.values.clone()),
        }
    }

    /// The range of a column as a text that follows the name of a parameter; `None` for a number.
    pub(crate) fn range(&self) -> Option<String> {
        let column = self.column()?;
        let [least, largest] = [self.least(), self.largest()].map(Six);
        Some(format!(
            "from {least} to {largest} by column \"{}\"",
            column.name
        ))
    }
}

impl Builder<'_> {
    /// A column of the file of a mesh, or the reason why there is none.
    fn column(&mut self, name: &str, source: &MeshSource) -> Result<Arc<Column>, String> {
        let file = match source {
            MeshSource::Shape { .. } => {
                return Err(format!(
                    "the mesh of the surface is generated, and has no column \"{name}\": give a mesh file \
                     by `mesh`, or a number"
                ));
            }
            MeshSource::File(MeshFileSource {
                weld: Some(true), ..
            }) => {
                return Err(format!(
                    "`weld` merges vertices, and the column \"{name}\" has a number for each of them: \
                     weld the mesh first, and write a file with the column"
                ));
            }
            MeshSource::File(file) => file,
        };
        let columns = self.meshes.columns(file);
        let columns = columns.map_err(|error| error.to_string())?;
        if let Some(column) = columns.iter().find(|column| column.name == name) {
            return Ok(Arc::clone(column));
        }
        let known = Vec::from_iter(columns.iter().map(|column| format!("\"{}\"", column.name)));
        let known = match known.as_slice() {
            [] => "it has none; .vtp and .ply files may have columns".to_owned(),
            known => format!("it has {}", known.join(", ")),
        };
        let path = file.path.display();
        Err(format!(
            "{path} has no column \"{name}\" of single numbers: {known}"
        ))
    }
}
