//! Small meshes, closed and open.

use helfrich::TriangleMesh;

/// Connectivity and positions.
pub type Positioned = (TriangleMesh, Vec<[f64; 3]>);

fn positioned(triangles: &[[u32; 3]], positions: &[[f64; 3]]) -> Positioned {
    let mesh = TriangleMesh::new(positions.len(), triangles.to_vec());
    (mesh.expect("a manifold"), positions.to_vec())
}

/// Four vertices, each with three neighbours.
pub fn tetrahedron() -> Positioned {
    positioned(
        &[[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]],
        &[
            [1.0, 1.0, 1.0],
            [-1.0, -1.0, 1.0],
            [1.0, -1.0, -1.0],
            [-1.0, 1.0, -1.0],
        ]
        .map(|[x, y, z]| [x, z, y]),
    )
}

/// Six vertices, each with four neighbours.
pub fn octahedron() -> Positioned {
    let [px, nx, py, ny, pz, nz] = [0, 1, 2, 3, 4, 5];
    positioned(
        &[
            [px, py, pz],
            [py, nx, pz],
            [nx, ny, pz],
            [ny, px, pz],
            [py, px, nz],
            [nx, py, nz],
            [ny, nx, nz],
            [px, ny, nz],
        ],
        &[
            [1.0, 0.0, 0.0],
            [-1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, 0.0, -1.0],
        ],
    )
}

/// A curved sheet with a boundary, `cells` × `cells` squares of two triangles each; it has vertices
/// in one triangle only.
pub fn sheet(cells: u32) -> Positioned {
    let at = |i: u32, j: u32| i + (cells + 1) * j;
    let mut triangles = Vec::new();
    let mut positions = Vec::new();
    for j in 0..=cells {
        for i in 0..=cells {
            let [x, y] = [i, j].map(|k| f64::from(k) / f64::from(cells) - 0.5);
            positions.push([x, y + 0.1 * x * x, 0.4 * x * x + 0.3 * x * y - 0.2 * y]);
            if i < cells && j < cells {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    positioned(&triangles, &positions)
}

/// Every mesh of this module.
pub fn all() -> Vec<(&'static str, Positioned)> {
    vec![
        ("tetrahedron", tetrahedron()),
        ("octahedron", octahedron()),
        ("triangle pair", sheet(1)),
        ("sheet", sheet(6)),
    ]
}
