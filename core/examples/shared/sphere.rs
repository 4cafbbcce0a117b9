//! The surface of the examples.

use helfrich::{Subdivision, TriangleMesh};
use std::error::Error;

/// A mesh and the positions of its vertices.
type Meshed = (TriangleMesh, Vec<[f64; 3]>);

/// A sphere of radius 1 with `4^(levels + 1) + 2` vertices: an octahedron, refined, its vertices put
/// on the sphere.
pub(crate) fn sphere(levels: u32) -> Result<Meshed, Box<dyn Error>> {
    let corners = [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [-1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, -1.0],
    ];
    let triangles = vec![
        [0, 1, 2],
        [1, 3, 2],
        [3, 4, 2],
        [4, 0, 2],
        [1, 0, 5],
        [3, 1, 5],
        [4, 3, 5],
        [0, 4, 5],
    ];
    let refined = Subdivision::new(&TriangleMesh::new(6, triangles)?, levels)?;
    let points = refined.refine(&corners).into_iter().map(|point: [f64; 3]| {
        let length = point.iter().map(|x| x * x).sum::<f64>().sqrt();
        point.map(|x| x / length)
    });
    let points = points.collect();
    Ok((refined.into_mesh(), points))
}
