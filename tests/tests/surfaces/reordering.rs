//! Orders of vertices are permutations that can be undone and that give neighbours numbers close to each
//! other.

use helfrich::{Finding, GompperKroll, Prepared, Reordering, Surface, TriangleMesh};
use helfrich_std::method::{BendingMethod, Evaluator};
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

/// Two spheres and an isolated vertex.
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
        // Each triangle keeps its corners and their orientation.
        for (place, corners) in ordered.triangles().iter().enumerate() {
            let old = connectivity.triangles()[order.triangles()[place] as usize];
            assert_eq!(corners.map(|vertex| order.vertices()[vertex as usize]), old);
        }
    }
}

#[test]
fn neighbours_get_numbers_near_each_other() {
    for (mesh, widest) in [(icosphere(4), 130), (torus(60, 12), 48), (sheet(30), 40)] {
        let mesh = mesh.relabelled(11).0.connectivity;
        let order = Reordering::reverse_cuthill_mckee(&mesh);
        let ordered = order.of_mesh(&mesh).expect("the same surface");
        let (before, after) = (bandwidth(&mesh), bandwidth(&ordered));
        // The bandwidth is below two fronts of the search: one around a sphere of N vertices has about √(πN)
        // vertices, one that runs both ways along a tube twice 12.
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

#[test]
fn surfaces_in_pairs_are_ordered_with_their_remainders() {
    let mesh = icosphere(2).map(bent).relabelled(5).0;
    let high = mesh.positions_in::<f32>();
    let low: Vec<[f32; 3]> = (0..high.len())
        .map(|v| [0, 1, 2].map(|k| (mesh.positions[v][k] - f64::from(high[v][k])) as f32))
        .collect();
    let surface = Surface::with_remainders(&mesh.connectivity, &high, &low).expect("finite");
    let order = Reordering::reverse_cuthill_mckee(&mesh.connectivity);
    let ordered = order.of_mesh(&mesh.connectivity).expect("the same surface");
    let (mut positions, mut remainders) = (Vec::new(), Vec::new());
    let found = order.of_surface(surface, &ordered, &mut positions, &mut remainders);
    for [a, b] in ordered.edges() {
        let old = |vertex: u32| order.vertices()[vertex as usize];
        assert_eq!(
            found.difference(*a, *b),
            surface.difference(old(*a), old(*b))
        );
    }
}

/// A mesh so large that [`Evaluator`] evaluates it in another order returns results in the mesh's own order.
#[test]
fn large_meshes_are_answered_in_their_own_order() {
    let mut mesh = icosphere(7).map(bent).relabelled(11).0;
    // One vertex is close to its neighbour, to cause findings.
    let neighbour = mesh.connectivity.one_ring(77)[0] as usize;
    let [near, far] = [mesh.positions[neighbour], mesh.positions[77]];
    mesh.positions[77] = [0, 1, 2].map(|k| near[k] + 1e-3 * (far[k] - near[k]));
    let mesh = &mesh;
    let order = Reordering::reverse_cuthill_mckee(&mesh.connectivity);
    assert!(
        bandwidth(&mesh.connectivity) > 10 * bandwidth(&order.of_mesh(&mesh.connectivity).unwrap())
    );

    let mut expected = vec![[0.0; 3]; mesh.positions.len()];
    let mut known = Prepared::new(GompperKroll::new(1.0), &mesh.connectivity);
    let energy = known.add_force_and_energy(mesh.surface(), &mut expected);
    let method = BendingMethod::GompperKroll;
    let mut evaluator = Evaluator::<f64>::new(method, 1.0, &mesh.connectivity);
    let fields = evaluator.fields(mesh.surface());
    let scale = helfrich_tests::laws::largest(&expected);
    for (found, expected) in evaluator.force().iter().zip(&expected) {
        for axis in 0..3 {
            assert!((found[axis] - expected[axis]).abs() <= 1e-12 * scale);
        }
    }
    assert!((evaluator.energy(mesh.surface()) - energy).abs() <= 1e-12 * energy);
    for (vertex, force) in expected.iter().enumerate() {
        let density = fields.force_density[vertex].expect("an area");
        let found = fields.area[vertex] * density[0];
        assert!((found - force[0]).abs() <= 1e-12 * scale);
    }

    let sorted = |findings: &[Finding]| {
        let mut findings: Vec<String> = findings.iter().map(|f| format!("{f:?}")).collect();
        findings.sort();
        findings
    };
    let (found, known) = (
        evaluator.quality(mesh.surface()),
        known.quality(mesh.surface()),
    );
    assert!(!known.findings().is_empty());
    assert_eq!(sorted(found.findings()), sorted(known.findings()));
    assert_eq!(found.flagged(), known.flagged());
}
