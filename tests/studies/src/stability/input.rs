//! Meshes and surfaces that must be refused.

use super::{Bound, Group, Outcome, Row};
use helfrich::{Real, Surface, TriangleMesh};
use helfrich_std::scalar::Scalar;

/// Lists of triangles that do not form a surface: name, meaning, triangles, and a part of the message.
const MESHES: &[(&str, &str, &[[u32; 3]], &str)] = &[
    (
        "duplicated face",
        "Two triangles with the same three vertices.",
        &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2], [1, 3, 2]],
        "have the same three vertices",
    ),
    (
        "bow-tie",
        "Two fans of triangles that share only one vertex.",
        &[[0, 1, 2], [0, 3, 4]],
        "2 separate fans (a bow-tie)",
    ),
    (
        "three triangles at an edge",
        "A surface that branches.",
        &[[0, 1, 2], [1, 0, 3], [0, 1, 4]],
        "3 triangles meet in the edge between vertices 0 and 1",
    ),
    (
        "contradicting orientations",
        "Adjacent triangles with opposite orientations.",
        &[[0, 1, 2], [0, 1, 3]],
        "their orientations contradict each other",
    ),
    (
        "repeated vertex",
        "A triangle with the same vertex twice.",
        &[[0, 1, 1]],
        "three different vertices are needed",
    ),
    (
        "missing vertex",
        "A triangle with a vertex index beyond the last vertex.",
        &[[0, 1, 5]],
        "but there are 5 vertices",
    ),
    (
        "no triangle",
        "A mesh without triangles.",
        &[],
        "the mesh is empty",
    ),
];

/// An invalid coordinate: name, meaning, the coordinate in a number type, and a part of the message.
type Coordinate = (&'static str, &'static str, fn(Scalar) -> f64, &'static str);

const COORDINATES: &[Coordinate] = &[
    (
        "not a number",
        "A coordinate that is NaN.",
        |_| f64::NAN,
        "is not a finite number",
    ),
    (
        "infinite",
        "A coordinate beyond the range of the number type.",
        |_| f64::INFINITY,
        "is not a finite number",
    ),
    (
        "too large",
        "A surface of size 1e12 in f32, 1e100 in f64: squares of areas would overflow.",
        |scalar| if scalar == Scalar::F64 { 1e100 } else { 1e12 },
        "choose a larger unit of length",
    ),
];

/// All rows about input.
pub(super) fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for &(name, meaning, triangles, message) in MESHES {
        let refused = TriangleMesh::new(5, triangles.to_vec()).err();
        rows.push(Row::new(
            Group::Input,
            (name, meaning),
            ("connectivity", Scalar::F64),
            outcome(refused.map(|error| error.to_string())),
            Bound::Refused(message),
        ));
    }
    for &(name, meaning, coordinate, message) in COORDINATES {
        for scalar in Scalar::ALL {
            let refused = match scalar {
                Scalar::F32 | Scalar::F32Pair => refusal::<f32>(coordinate(scalar)),
                Scalar::F64 => refusal::<f64>(coordinate(scalar)),
            };
            rows.push(Row::new(
                Group::Input,
                (name, meaning),
                ("positions", scalar),
                outcome(refused),
                Bound::Refused(message),
            ));
        }
    }
    rows
}

/// Reason why a triangle with this coordinate is refused.
fn refusal<T: Real>(coordinate: f64) -> Option<String> {
    let mesh = TriangleMesh::new(3, vec![[0, 1, 2]]).ok()?;
    let (zero, one) = (T::zero(), T::one());
    let positions = [
        [zero; 3],
        [one, zero, zero],
        [zero, T::constant(coordinate), one],
    ];
    Surface::new(&mesh, &positions)
        .err()
        .map(|error| error.to_string())
}

fn outcome(refused: Option<String>) -> Outcome {
    refused.map_or(Outcome::Measured(0.0), Outcome::Refused)
}
