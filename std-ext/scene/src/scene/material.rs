//! Parameters of the membrane that may be different at each vertex.

use super::builder::Builder;
use super::keys::{Form, Keys, plain, required};
use super::reader::Reader;
use super::{MeshFileSource, MeshSource};
use crate::io::{Column, ColumnPlace, MeshFile};
use crate::six::Six;
use helfrich::{MaterialParameter, Surface};
use serde::{Serialize, Serializer};
use std::sync::Arc;

/// A column of the mesh file, as the alternative to a number.
pub(super) const COLUMN: Form = Form::Table(&KEYS);

static KEYS: Keys = plain(&[required(
    "column",
    Form::Text,
    "The name of a column of the surface's mesh file, one number for each vertex or face in the scene's \
     units: an array of one component in the PointData or CellData of a VTP, VTU or VTK file, or a property of the \
     vertices or faces of a PLY file.",
)]);

/// A parameter of the membrane: a number, or one for each vertex. Labels of domains may belong to triangles.
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
    /// absent or its column has a problem, which is then reported. The value at a vertex is the mean of
    /// the numbers of the triangles around it, weighted by area, if the column has numbers of triangles.
    pub(super) fn read(
        table: Reader<'_>,
        key: &str,
        source: &MeshSource,
        builder: &mut Builder<'_>,
    ) -> Option<Self> {
        let place = ColumnPlace::Vertices;
        Self::read_preferring(place, table, key, source, builder)
    }

    /// Reads the key `key` as [`Self::read`], but leaves numbers of triangles as they are.
    pub(super) fn read_labels(
        table: Reader<'_>,
        key: &str,
        source: &MeshSource,
        builder: &mut Builder<'_>,
    ) -> Option<Self> {
        let place = ColumnPlace::Triangles;
        Self::read_preferring(place, table, key, source, builder)
    }

    /// Reads the key `key`. Of two columns of this name that in the given place counts.
    fn read_preferring(
        place: ColumnPlace,
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
        let found = builder.column(name, place, source);
        let found = found.and_then(|(file, column)| {
            let range = table.range(key);
            let wrong = |&(_, value): &(usize, &f64)| !(value.is_finite() && range.contains(*value));
            match column.values.iter().enumerate().find(wrong) {
                None if (place, column.place)
                    == (ColumnPlace::Vertices, ColumnPlace::Triangles) =>
                {
                    Ok(Self::Column {
                        column: Arc::new(at_vertices(&column, &file)),
                    })
                }
                None => Ok(Self::Column { column }),
                Some((at, value)) => Err(format!(
                    "the column \"{name}\" is {value} at {} {at}: `{key}` has to be a finite number {}",
                    singular(column.place),
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

    /// [`Self::column`], mutable.
    pub(super) fn column_mut(&mut self) -> Option<&mut Arc<Column>> {
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
    #[doc(hidden)]
    pub fn parameter(&self) -> MaterialParameter<f64> {
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

/// A place of a column in messages.
pub(super) fn singular(place: ColumnPlace) -> &'static str {
    match place {
        ColumnPlace::Vertices => "vertex",
        ColumnPlace::Triangles => "triangle",
    }
}

/// The mean of the numbers of the triangles around each vertex, weighted by area; equal numbers stay the
/// same to the last bit.
fn at_vertices(column: &Column, file: &MeshFile) -> Column {
    let triangles = file.mesh.triangles();
    let first = column.values[0];
    let mut sums = vec![[0.0; 2]; file.positions.len()];
    let surface = Surface::new(&file.mesh, &file.positions);
    for (triangle, (corners, &value)) in triangles.iter().zip(&column.values).enumerate() {
        let area = surface.as_ref().map_or(1.0, |s| s.triangle_area(triangle));
        for &vertex in corners {
            let [numbers, areas] = &mut sums[vertex as usize];
            *numbers += area * (value - first);
            *areas += area;
        }
    }
    let means = sums.into_iter().map(|[numbers, areas]| match areas > 0.0 {
        true => first + numbers / areas,
        false => first,
    });
    Column {
        name: column.name.clone(),
        place: ColumnPlace::Vertices,
        values: means.collect(),
    }
}

impl Builder<'_> {
    /// A column of the file of a mesh, or the reason why there is none. Of two columns of this name that
    /// in the given place counts.
    fn column(
        &mut self,
        name: &str,
        place: ColumnPlace,
        source: &MeshSource,
    ) -> Result<(Arc<MeshFile>, Arc<Column>), String> {
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
        let named = || columns.iter().filter(|column| column.name == name);
        let preferred = named().find(|column| column.place == place);
        if let Some(column) = preferred.or_else(|| named().next()) {
            let column = Arc::clone(column);
            let file = self.meshes.read(file).map_err(|error| error.to_string())?;
            return Ok((file, column));
        }
        let known = Vec::from_iter(columns.iter().map(|column| format!("\"{}\"", column.name)));
        let known = match known.as_slice() {
            [] => "it has none; .ply, .vtp, .vtu, .vtk, .msh and .gii files may have columns"
                .to_owned(),
            known => format!("it has {}", known.join(", ")),
        };
        let path = file.path.display();
        Err(format!(
            "{path} has no column \"{name}\" of single numbers: {known}"
        ))
    }
}
