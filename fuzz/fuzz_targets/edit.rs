//! Any edits of the connectivity of closed and open meshes with lines: each leaves an oriented manifold of the same
//! topology, or is refused; and so does a cut along the lines.
#![no_main]

use helfrich::TriangleMesh;
use helfrich::edit::EditableMesh;
use libfuzzer_sys::fuzz_target;

/// A torus of 5 × 6 squares, each in two triangles, or the sheet that it is without the squares across its seams.
fn mesh(closed: bool) -> TriangleMesh {
    let squares = (0..5).flat_map(|i| (0..6).map(move |j| (i, j)));
    let squares = squares.filter(|&(i, j)| closed || (i < 4 && j < 5));
    let triangles = squares.flat_map(|(i, j)| {
        let corners = [(0, 0), (1, 0), (0, 1), (1, 1)];
        let [a, b, c, d] = corners.map(|(k, l)| (i + k) % 5 * 6 + (j + l) % 6);
        [[a, b, c], [b, d, c]]
    });
    TriangleMesh::new(30, triangles.collect()).expect("a manifold")
}

fuzz_target!(|input: (bool, u32, Vec<(u8, u16)>)| {
    let (closed, kept, edits) = input;
    let start = mesh(closed);
    let edges = start.edges().iter().zip(0..32);
    let lines = edges.filter(|(_, bit)| kept >> bit & 1 == 1);
    let lines = Vec::from_iter(lines.map(|(&ends, _)| ends));
    let mut edited = EditableMesh::with_lines(&start, &lines);
    for (kind, edge) in edits {
        let edges = Vec::from_iter(edited.edges());
        let half_edge = edges[usize::from(edge) % edges.len()];
        let _ = match kind % 4 {
            0 => Ok(drop(edited.split(half_edge))),
            1 => edited.flip(half_edge),
            2 => edited.collapse(half_edge),
            _ => edited
                .opposite(half_edge)
                .map_or(Ok(()), |other| edited.collapse(other)),
        };
    }
    let count = edited.triangle_count();
    assert_eq!(edited.clone().cut().mesh.triangles().len(), count);
    let end = edited.finish().mesh;
    assert_eq!(end.euler_characteristic(), start.euler_characteristic());
    assert_eq!(end.is_closed(), start.is_closed());
});
