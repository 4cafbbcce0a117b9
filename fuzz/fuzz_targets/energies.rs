//! Any positions on valid meshes, coincident and collinear ones included: every method gives finite
//! numbers.
#![no_main]

use helfrich::{Surface, TriangleMesh};
use helfrich_std::method::{BendingMethod, Evaluator};
use helfrich_tests::meshes::{disc, hemisphere, icosahedron, icosphere, octahedron, tetrahedron};
use libfuzzer_sys::fuzz_target;

/// A known mesh, or one of the triangles that the bytes name; with the bytes that are left.
fn mesh(bytes: &[u8]) -> Option<(TriangleMesh, &[u8])> {
    let (&kind, rest) = bytes.split_first()?;
    let known = match kind % 7 {
        0 => tetrahedron(),
        1 => octahedron(),
        2 => icosahedron(),
        3 => icosphere(1),
        4 => hemisphere(1),
        5 => disc(2),
        _ => {
            let (&triangles, rest) = rest.split_first()?;
            let (corners, rest) = rest.split_at_checked(3 * usize::from(triangles))?;
            let corners = corners.chunks_exact(3);
            let triangles =
                corners.map(|t| [t[0], t[1], t[2]].map(|corner| u32::from(corner % 32)));
            return Some((TriangleMesh::new(32, triangles.collect()).ok()?, rest));
        }
    };
    Some((known.connectivity, rest))
}

// Coordinates are sixteenths, a byte each, over and over: few values, so that vertices meet.
fuzz_target!(|bytes: &[u8]| {
    let Some((mesh, coordinates)) = mesh(bytes) else {
        return;
    };
    if coordinates.is_empty() {
        return;
    }
    let mut coordinates = coordinates
        .iter()
        .cycle()
        .map(|&byte| f64::from(byte as i8) / 16.0);
    let mut next = || coordinates.next().unwrap_or(0.0);
    let positions = Vec::from_iter((0..mesh.vertex_count()).map(|_| [next(), next(), next()]));
    let surface = Surface::new(&mesh, &positions).expect("sixteenths are finite");
    for method in BendingMethod::ALL {
        let mut evaluator = Evaluator::new(method, 1.0, &mesh);
        let fields = evaluator.fields(surface);
        let scalars = [&fields.mean, &fields.gaussian, &fields.laplacian_of_mean];
        for value in scalars.into_iter().flatten().flatten() {
            assert!(value.is_finite(), "{method}: {value}");
        }
        for force in fields.force_density.iter().flatten() {
            assert!(force.iter().all(|f| f.is_finite()), "{method}: {force:?}");
        }
        for (area, normal) in fields.area.iter().zip(&fields.normal) {
            assert!(
                area.is_finite() && normal.iter().all(|n| n.is_finite()),
                "{method}"
            );
        }
        evaluator.findings(surface);
    }
});
