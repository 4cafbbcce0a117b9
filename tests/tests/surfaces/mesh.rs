//! Connectivity: accepted meshes and their invariants, and refused ones with their reasons.

use helfrich::{MeshError, TriangleMesh, VertexKind};
use helfrich_tests::invariants::check_invariants;

const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

/// Grid of `columns` × `rows` cells of two triangles each, periodic if it `wraps`.
fn grid(columns: u32, rows: u32, wraps: bool) -> (usize, Vec<[u32; 3]>) {
    let (width, height) = if wraps {
        (columns, rows)
    } else {
        (columns + 1, rows + 1)
    };
    let at = |i: u32, j: u32| i % width + width * (j % height);
    let mut triangles = Vec::new();
    for j in 0..rows {
        for i in 0..columns {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    ((width * height) as usize, triangles)
}

/// Triangles around vertex 0 over `neighbours` vertices, which form a disc with vertex 0 inside.
fn wheel(neighbours: u32) -> (usize, Vec<[u32; 3]>) {
    let triangles = (0..neighbours).map(|k| [0, 1 + k, 1 + (k + 1) % neighbours]);
    (neighbours as usize + 1, triangles.collect())
}

/// Pseudorandom numbers below `limit` (SplitMix64).
fn random(seed: u64, limit: u32) -> impl FnMut() -> u32 {
    let mut state = seed;
    move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % u64::from(limit)) as u32
    }
}

fn mesh((vertices, triangles): (usize, Vec<[u32; 3]>)) -> TriangleMesh {
    let mesh = TriangleMesh::new(vertices, triangles).unwrap();
    check_invariants(&mesh, vertices);
    mesh
}

#[test]
fn closed_and_open_surfaces() {
    let tetrahedron = mesh((4, TETRAHEDRON.to_vec()));
    assert!(tetrahedron.is_closed());
    assert_eq!(tetrahedron.edges().len(), 6);
    assert_eq!(tetrahedron.euler_characteristic(), 2);

    let torus = mesh(grid(7, 4, true));
    assert!(torus.is_closed());
    assert_eq!(torus.euler_characteristic(), 0);
    assert!((0..28).all(|vertex| torus.valence(vertex) == 6));

    let disc = mesh(grid(5, 3, false));
    assert!(!disc.is_closed());
    assert_eq!(disc.boundary_edge_count(), 16);
    assert_eq!(disc.euler_characteristic(), 1);
    let kinds = disc.vertex_kinds().iter();
    let inside = kinds.filter(|&&kind| kind == VertexKind::Interior).count();
    assert_eq!(inside, 4 * 2);
}

#[test]
fn rings_run_counter_clockwise_from_boundary_to_boundary() {
    let disc = mesh(wheel(5));
    assert_eq!(disc.one_ring(0), [1, 2, 3, 4, 5]);
    assert_eq!(disc.one_ring(1), [2, 0, 5]);
    assert_eq!(disc.vertex_kind(0), VertexKind::Interior);
    assert_eq!(disc.vertex_kind(1), VertexKind::Boundary);
}

#[test]
fn components_and_isolated_vertices() {
    let two = mesh((8, vec![[1, 2, 3], [7, 6, 5]]));
    assert_eq!(two.components(), (vec![0, 1, 1, 1, 2, 3, 3, 3], 4));
    assert_eq!(two.vertex_kind(0), VertexKind::Isolated);
    assert_eq!(two.euler_characteristic(), 2);
}

#[test]
fn each_error() {
    let limit = TriangleMesh::LIMIT;
    for (vertices, triangles, error) in [
        (3, vec![], MeshError::Empty),
        (
            limit + 1,
            vec![[0, 1, 2]],
            MeshError::TooLarge {
                what: "vertices",
                count: limit + 1,
                limit,
            },
        ),
        (
            3,
            vec![[0, 1, 2], [2, 1, 3]],
            MeshError::VertexOutOfRange {
                triangle: 1,
                vertex: 3,
                vertices: 3,
            },
        ),
        (
            3,
            vec![[0, 1, 0]],
            MeshError::RepeatedVertex {
                triangle: 0,
                vertex: 0,
            },
        ),
        (
            4,
            vec![[0, 1, 2], [0, 3, 1], [1, 2, 0]],
            MeshError::DuplicateTriangle {
                first: 0,
                second: 2,
            },
        ),
        (
            3,
            vec![[0, 1, 2], [1, 0, 2]],
            MeshError::DuplicateTriangle {
                first: 0,
                second: 1,
            },
        ),
        (
            5,
            vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]],
            MeshError::NonManifoldEdge {
                edge: [0, 1],
                triangles: 3,
                triangle: 2,
            },
        ),
        (
            4,
            vec![[0, 1, 2], [0, 1, 3]],
            MeshError::InconsistentOrientation {
                edge: [0, 1],
                triangles: [0, 1],
            },
        ),
        (
            5,
            vec![[0, 1, 2], [0, 3, 4]],
            MeshError::NonManifoldVertex {
                vertex: 0,
                fans: 2,
                triangles: [0, 1],
            },
        ),
    ] {
        assert_eq!(TriangleMesh::new(vertices, triangles), Err(error));
    }
}

#[test]
fn fans_are_counted_whether_open_or_closed() {
    // Two tetrahedra and an open fan of two triangles meet in vertex 0.
    let mut triangles = TETRAHEDRON.to_vec();
    triangles.extend(TETRAHEDRON.map(|t| t.map(|v| if v == 0 { 0 } else { v + 3 })));
    triangles.extend([[0, 7, 8], [0, 8, 9]]);
    let error = TriangleMesh::new(10, triangles).unwrap_err();
    let MeshError::NonManifoldVertex {
        vertex: 0,
        fans: 3,
        triangles: [open, closed],
    } = error
    else {
        panic!("{error}");
    };
    assert_eq!((open, closed), (8, 1));
}

/// Random sets of up to five triangles over a few vertices are refused exactly if counting sides and fans by
/// brute force says so.
#[test]
fn random_triangles_are_judged_as_by_brute_force() {
    let mut accepted = 0;
    for seed in 0..200_000 {
        let mut draw = random(seed, 6);
        let count = 1 + draw() % 5;
        let triangles = Vec::from_iter((0..count).map(|_| [draw(), draw(), draw()]));
        let result = TriangleMesh::new(6, triangles.clone());
        assert_eq!(result.is_ok(), is_mesh(&triangles), "{triangles:?}");
        if let Ok(mesh) = result {
            check_invariants(&mesh, 6);
            accepted += 1;
        }
    }
    assert!(accepted > 10_000, "{accepted}");
}

/// Literal transcription of the definition of [`TriangleMesh`].
fn is_mesh(triangles: &[[u32; 3]]) -> bool {
    let sides = |t: &[u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    let sorted = |t: &[u32; 3]| {
        let mut t = *t;
        t.sort_unstable();
        t
    };
    for (at, t) in triangles.iter().enumerate() {
        if t[0] == t[1] || t[1] == t[2] || t[2] == t[0] {
            return false;
        }
        for other in &triangles[..at] {
            let same_side = sides(t).iter().any(|side| sides(other).contains(side));
            if same_side || sorted(t) == sorted(other) {
                return false;
            }
        }
    }
    (0..6).all(|vertex| {
        // From the first triangle at a vertex, all others must be reachable through edges at it.
        let mut around = Vec::from_iter(triangles.iter().filter(|t| t.contains(&vertex)));
        let Some(first) = around.pop() else {
            return true;
        };
        let mut reached = vec![first];
        while let Some(at) = around.iter().position(|t| {
            reached.iter().any(|other| {
                let mut common = t.iter().filter(|v| other.contains(v));
                common.any(|&v| v != vertex)
            })
        }) {
            reached.push(around.swap_remove(at));
        }
        around.is_empty()
    })
}

/// With 10⁵ neighbours, a quadratic algorithm would take minutes.
#[test]
fn a_vertex_of_high_valence_takes_no_quadratic_time() {
    let (vertices, mut triangles) = wheel(100_000);
    let hub = TriangleMesh::new(vertices, triangles.clone()).unwrap();
    assert_eq!(hub.valence(0), 100_000);
    // The triangles in random order, and in two fans.
    let mut draw = random(1, 100_000);
    let mut order = Vec::from_iter(1..vertices as u32);
    for at in 0..order.len() {
        order.swap(at, draw() as usize);
    }
    for triangle in &mut triangles {
        *triangle = triangle.map(|v| if v == 0 { 0 } else { order[v as usize - 1] });
    }
    let shuffled = TriangleMesh::new(vertices, triangles.clone()).unwrap();
    assert_eq!(shuffled.valence(0), 100_000);
    triangles.retain(|t| *t != [0, order[10], order[11]] && *t != [0, order[500], order[501]]);
    let error = TriangleMesh::new(vertices, triangles).unwrap_err();
    assert!(matches!(
        error,
        MeshError::NonManifoldVertex {
            vertex: 0,
            fans: 2,
            ..
        }
    ));
}

#[test]
fn triangles_that_all_share_an_edge_are_refused_at_once() {
    let triangles = Vec::from_iter((2..100_000).map(|v| [0, 1, v]));
    let error = TriangleMesh::new(100_000, triangles).unwrap_err();
    assert!(matches!(
        error,
        MeshError::NonManifoldEdge {
            edge: [0, 1],
            triangles: 99_998,
            ..
        }
    ));
}

#[test]
fn a_large_mesh() {
    let (vertices, triangles) = grid(1000, 300, true);
    let torus = TriangleMesh::new(vertices, triangles).unwrap();
    assert_eq!(torus.euler_characteristic(), 0);
    assert_eq!(torus.components().1, 1);
}

/// All index formats of renderers and solvers give the same triangles.
#[test]
fn indices_come_in_every_form() {
    let mesh = TriangleMesh::new(4, TETRAHEDRON.to_vec()).expect("a mesh");
    let triangles = mesh.triangles();
    let short = Vec::from_iter(triangles.iter().map(|t| t.map(|vertex| vertex as u16)));
    let forms = [
        TriangleMesh::from_indices(4, triangles),
        TriangleMesh::from_indices(4, &triangles.to_vec()),
        TriangleMesh::from_indices(4, triangles.as_flattened()),
        TriangleMesh::from_indices(4, &short),
        TriangleMesh::from_indices(4, short.as_flattened()),
        TriangleMesh::from_indices(4, &[0_u32; 0]).and(TriangleMesh::from_indices(4, triangles)),
    ];
    let [forms @ .., empty] = forms;
    for form in forms {
        assert_eq!(form.as_ref(), Ok(&mesh));
    }
    assert_eq!(empty, Err(MeshError::Empty));
    for indices in [1, 2, 4, 11] {
        let given = TriangleMesh::from_indices(4, &triangles.as_flattened()[..indices]);
        assert_eq!(given, Err(MeshError::IncompleteTriangle { indices }));
        let given = TriangleMesh::from_indices(4, &short.as_flattened()[..indices]);
        assert_eq!(given, Err(MeshError::IncompleteTriangle { indices }));
    }
}
