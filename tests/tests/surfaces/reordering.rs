//! Orders of vertices: permutations, undone, and neighbours get numbers near each other.

use helfrich::{GompperKroll, Reordering, Surface, TriangleMesh};
use helfrich_tests::laws::forces;
use helfrich_tests::meshes::{Mesh, bent, icosphere, sheet, small, torus};

/// Largest difference between the numbers of two neighbours.
fn bandwidth(mesh: &TriangleMesh) -> u32 {
    let edges = mesh.edges().iter();
    edges.map(|[a, b]| a.abs_diff(*b)).max().unwrap_or(0)
}

fn is_permutation(numbers: &[u32]) -> bool {
    let mut sorted = numbers.to_vec();
    sorted.sort_unstable();
    sorted.iter().copied().eq(0..numbers.len() as u32)
}

/// Two spheres and a vertex that is in no triangle.
fn apart() -> Mesh {
    let sphere = icosphere(2);
    let count = sphere.positions.len() as u32;
    let mut positions = sphere.positions.clone();
    positions.push([9.0; 3]);
    positions.extend(sphere.positions.iter().map(|[x, y, z]| [x + 3.0, *y, *z]));
    let mut triangles = sphere.connectivity.triangles().to_vec();
    let second = triangles.iter().map(|t| t.map(|v| v + count + 1));
    let second: Vec<_> = second.collect();
    triangles.extend(second);
    Mesh::new(positions, triangles)
}

#[test]
fn orders_are_permutations_and_undone() {
    let mut meshes = vec![
        icosphere(3).relabelled(3).0,
        sheet(8),
        torus(20, 9),
        apart(),
    ];
    meshes.extend(small().map(|(_, mesh)| mesh));
    for mesh in meshes {
        let connectivity = &mesh.connectivity;
        let order = Reordering::reverse_cuthill_mckee(connectivity);
        assert_eq!(order.vertices().len(), connectivity.vertex_count());
        assert_eq!(order.triangles().len(), connectivity.triangles().len());
        assert!(is_permutation(order.vertices()) && is_permutation(order.triangles()));
        assert_eq!(order.undo(&order.apply(&mesh.positions)), mesh.positions);
        let ordered = order.of_mesh(connectivity).expect("the same surface");
        // Each triangle keeps its corners, and their direction around.
        for (place, corners) in ordered.triangles().iter().enumerate() {
            let old = connectivity.triangles()[order.triangles()[place] as usize];
            assert_eq!(corners.map(|vertex| order.vertices()[vertex as usize]), old);
        }
    }
}

#[test]
fn neighbours_get_numbers_near_each_other() {
    for (mesh, widest) in [(icosphere(4), 130), (torus(60, 12), 30), (sheet(30), 40)] {
        let mesh = mesh.relabelled(11).0.connectivity;
        let order = Reordering::reverse_cuthill_mckee(&mesh);
        let ordered = order.of_mesh(&mesh).expect("the same surface");
        let (before, after) = (bandwidth(&mesh), bandwidth(&ordered));
        // A ring around a sphere of N vertices has about √(πN) of them, one across a tube two times 12.
        assert!(after <= widest && 5 * after < before, "{before} {after}");
    }
}

#[test]
fn forces_of_another_order_come_back_in_the_first() {
    let mesh = icosphere(3).map(bent).relabelled(5).0;
    let order = Reordering::reverse_cuthill_mckee(&mesh.connectivity);
    let ordered = order.of_mesh(&mesh.connectivity).expect("the same surface");
    let positions = order.apply(&mesh.positions);
    assert!(Surface::new(&ordered, &positions).is_ok());
    let expected = forces(GompperKroll::new(1.0), &mesh.connectivity, &mesh.positions);
    let found = order.undo(&forces(GompperKroll::new(1.0), &ordered, &positions));
    let scale = helfrich_tests::laws::largest(&expected);
    for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((found - expected).abs() <= 1e-12 * scale);
    }
}
