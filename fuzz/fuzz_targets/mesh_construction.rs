//! Any triangles over any number of vertices: refused, or a mesh that keeps every promise.
#![no_main]

use helfrich::TriangleMesh;
use helfrich_tests::invariants::check_invariants;
use libfuzzer_sys::fuzz_target;

// The first byte is the number of vertices, then three bytes a triangle: few vertices, so that
// triangles meet.
fuzz_target!(|bytes: &[u8]| {
    let Some((&vertices, corners)) = bytes.split_first() else {
        return;
    };
    let vertices = usize::from(vertices);
    let triangles = Vec::from_iter(
        corners
            .chunks_exact(3)
            .map(|t| [t[0], t[1], t[2]].map(u32::from)),
    );
    if let Ok(mesh) = TriangleMesh::new(vertices, triangles.clone()) {
        assert_eq!(mesh.triangles(), triangles);
        check_invariants(&mesh, vertices);
    }
});
