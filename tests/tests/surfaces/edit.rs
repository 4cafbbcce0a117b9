//! Edits of the connectivity of a mesh: what they keep, and what they refuse.

use helfrich::edit::{EditableMesh, Freedom, Refusal};
use helfrich::{TriangleMesh, VertexKind};
use helfrich_tests::meshes;
use proptest::prelude::*;

/// One edit, of the edge with this number modulo the number of edges.
#[derive(Clone, Copy, Debug)]
enum Edit {
    Split(usize),
    Flip(usize),
    Collapse(usize),
}

fn edits() -> impl Strategy<Value = Vec<Edit>> {
    let edit = (0..3, any::<usize>()).prop_map(|(kind, edge)| match kind {
        0 => Edit::Split(edge),
        1 => Edit::Flip(edge),
        _ => Edit::Collapse(edge),
    });
    proptest::collection::vec(edit, 1..60)
}

/// A torus of n × m squares, each in two triangles.
fn torus(n: u32, m: u32) -> TriangleMesh {
    let vertex = |i: u32, j: u32| (i % n) * m + j % m;
    let squares = (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
    let triangles = squares.flat_map(|(i, j)| {
        let [a, b, c, d] = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(k, l)| vertex(i + k, j + l));
        [[a, b, c], [b, d, c]]
    });
    TriangleMesh::new((n * m) as usize, triangles.collect()).expect("a torus")
}

/// A sheet of n × m vertices.
fn sheet(n: u32, m: u32) -> TriangleMesh {
    let squares = (0..n - 1).flat_map(|i| (0..m - 1).map(move |j| i * m + j));
    let triangles = squares.flat_map(|a| [[a, a + m, a + 1], [a + m, a + m + 1, a + 1]]);
    TriangleMesh::new((n * m) as usize, triangles.collect()).expect("a sheet")
}

/// Meshes with lines: closed, with holes, with a line around a torus, and across a sheet.
fn with_lines() -> Vec<(&'static str, TriangleMesh, Vec<[u32; 2]>)> {
    vec![
        (
            "tetrahedron",
            meshes::tetrahedron().connectivity,
            Vec::new(),
        ),
        ("torus", torus(5, 6), Vec::new()),
        ("sheet", sheet(5, 4), Vec::new()),
        (
            "torus with a line",
            torus(5, 6),
            (0..6).map(|j| [j, (j + 1) % 6]).collect(),
        ),
        (
            "sheet with a line",
            sheet(5, 4),
            (1..4).map(|i| [i * 4 + 2, i * 4 - 2]).collect(),
        ),
    ]
}

/// Makes an edit, and returns the refusal.
fn make(edited: &mut EditableMesh, edit: Edit) -> Result<(), Refusal> {
    let edges = Vec::from_iter(edited.edges());
    match edit {
        Edit::Split(edge) => {
            edited.split(edges[edge % edges.len()]);
            Ok(())
        }
        Edit::Flip(edge) => edited.flip(edges[edge % edges.len()]),
        Edit::Collapse(edge) => {
            let half_edge = edges[(edge / 2) % edges.len()];
            let other = edited.opposite(half_edge).filter(|_| edge % 2 == 1);
            edited.collapse(other.unwrap_or(half_edge))
        }
    }
}

/// Number of vertices at which lines end or meet, and whether there are any edges of lines.
fn line_ends(edited: &EditableMesh) -> (usize, bool) {
    let vertices = (0..edited.vertex_count() as u32).filter(|&vertex| edited.is_used(vertex));
    let ends = vertices.filter(|&vertex| edited.freedom(vertex) == Freedom::Fixed);
    let kept = edited.edges().any(|edge| edited.is_kept(edge));
    (ends.count(), kept)
}

/// Number of closed lines of border edges.
fn holes(mesh: &TriangleMesh) -> usize {
    let is_border = |v: &usize| mesh.vertex_kind(*v) == VertexKind::Boundary;
    let mut left = Vec::from_iter((0..mesh.vertex_count()).filter(is_border));
    let mut count = 0;
    while let Some(start) = left.pop() {
        count += 1;
        // A one-ring at the border begins along it.
        let mut at = mesh.one_ring(start)[0] as usize;
        while at != start {
            left.retain(|&vertex| vertex != at);
            at = mesh.one_ring(at)[0] as usize;
        }
    }
    count
}

fn check_half_edges(edited: &EditableMesh) {
    for half_edge in edited.triangles().flat_map(|first| first..first + 3) {
        if let Some(other) = edited.opposite(half_edge) {
            assert_eq!(edited.opposite(other), Some(half_edge));
            assert_eq!(edited.tail(other), edited.head(half_edge));
            assert_eq!(edited.is_kept(other), edited.is_kept(half_edge));
        }
        let tail = edited.tail(half_edge);
        let found = edited.half_edge(tail, edited.head(half_edge));
        assert_eq!(found, Some(half_edge), "around vertex {tail}");
    }
}

proptest! {
    /// Also: half-edges are consistent, no hole and no line appears or vanishes, refused edits change nothing.
    #[test]
    fn edits_leave_an_oriented_manifold_of_the_same_topology(edits in edits()) {
        for (name, mesh, lines) in with_lines() {
            let mut edited = EditableMesh::with_lines(&mesh, &lines);
            let before = line_ends(&edited);
            for &edit in &edits {
                let unchanged = edited.clone();
                if make(&mut edited, edit).is_err() {
                    let mesh = edited.clone().finish().mesh;
                    prop_assert_eq!(mesh, unchanged.finish().mesh);
                }
                check_half_edges(&edited);
                prop_assert_eq!(line_ends(&edited), before, "{}", name);
            }
            let count = edited.triangle_count();
            let made = edited.finish();
            prop_assert_eq!(made.mesh.triangles().len(), count);
            prop_assert_eq!(made.mesh.vertex_count(), made.vertices.len());
            prop_assert_eq!(made.mesh.euler_characteristic(), mesh.euler_characteristic());
            prop_assert_eq!(holes(&made.mesh), holes(&mesh), "{}", name);
        }
    }

    /// A sheet in the plane whose edits turn no triangle covers the same part of the plane.
    #[test]
    fn edits_of_a_flat_sheet_keep_its_area(edits in edits()) {
        let mesh = sheet(5, 4);
        let mut edited = EditableMesh::new(&mesh);
        // The corners of the sheet, so that borders stay where they are.
        for corner in [0, 3, 16, 19] {
            edited.fix(corner);
        }
        let place = |v: u32| [f64::from(v / 4), f64::from(v % 4)];
        let mut places = Vec::from_iter((0..20).map(place));
        let area = |edited: &EditableMesh, places: &[[f64; 2]]| {
            let triangles = edited.triangles().map(|first| {
                let [a, b, c] = edited.corners(first).map(|corner| places[corner as usize]);
                0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
            });
            let areas = Vec::from_iter(triangles);
            (areas.iter().sum::<f64>(), areas.into_iter().fold(f64::INFINITY, f64::min))
        };
        for edit in edits {
            let before = edited.clone();
            let ends = |half_edge: u32| [before.tail(half_edge), before.head(half_edge)];
            let middle = match edit {
                Edit::Split(edge) => {
                    let edges = Vec::from_iter(before.edges());
                    let [from, to] = ends(edges[edge % edges.len()]).map(|v| places[v as usize]);
                    Some([(from[0] + to[0]) / 2.0, (from[1] + to[1]) / 2.0])
                }
                _ => None,
            };
            let done = make(&mut edited, edit);
            places.extend(middle);
            let (total, least) = area(&edited, &places);
            if done.is_ok() && least <= 1e-9 {
                // It would turn a triangle.
                edited = before;
                continue;
            }
            prop_assert!((total - 12.0).abs() < 1e-12, "{edit:?}: {total}");
        }
    }
}

#[test]
fn a_split_edge_keeps_its_start_and_number() {
    let mut edited = EditableMesh::new(&torus(5, 6));
    let edge = edited.half_edge(0, 6).expect("an edge");
    let vertex = edited.split(edge);
    assert_eq!([edited.tail(edge), edited.head(edge)], [0, vertex]);
    assert_eq!(edited.valence(vertex), 4);
    assert!(edited.half_edge(vertex, 6).is_some() && edited.half_edge(0, 6).is_none());
}

#[test]
fn refusals_name_the_reason() {
    let mut edited = EditableMesh::with_lines(&sheet(5, 4), &[[6, 10]]);
    let edge = |edited: &EditableMesh, tail, head| edited.half_edge(tail, head).expect("an edge");
    let border = edge(&edited, 0, 4);
    assert_eq!(edited.flip(border), Err(Refusal::Border));
    let line = edge(&edited, 6, 10);
    assert_eq!(edited.flip(line), Err(Refusal::Kept));
    // A line ends at vertex 6.
    assert_eq!(
        edited.collapse(line),
        Err(Refusal::FixedVertex { vertex: 6 })
    );
    let inner = edge(&edited, 5, 6);
    edited.fix(5);
    assert_eq!(
        edited.collapse(inner),
        Err(Refusal::FixedVertex { vertex: 5 })
    );
    // From one border to the other.
    let strip = TriangleMesh::new(4, vec![[0, 1, 2], [2, 1, 3]]).expect("a strip");
    let mut strip = EditableMesh::new(&strip);
    let across = edge(&strip, 1, 2);
    assert!(matches!(
        strip.collapse(across),
        Err(Refusal::FixedVertex { .. } | Refusal::Topology)
    ));
    let mut closed = EditableMesh::new(&meshes::tetrahedron().connectivity);
    let any = edge(&closed, 0, 1);
    assert!(matches!(
        closed.flip(any),
        Err(Refusal::ExistingEdge { .. })
    ));
    assert_eq!(closed.collapse(any), Err(Refusal::Topology));
}

/// A torus cut along a circle is a tube, and along half of it a torus with a slit.
#[test]
fn a_cut_has_a_border_on_both_sides() {
    let mesh = torus(5, 6);
    let circle = Vec::from_iter((0..6).map(|j| [j, (j + 1) % 6]));
    for (lines, boundary, count, chi) in [(6, 12, 2, 0), (3, 6, 1, -1), (1, 0, 0, 0)] {
        let cut = EditableMesh::with_lines(&mesh, &circle[..lines]).cut();
        assert_eq!(cut.mesh.boundary_edge_count(), boundary);
        assert_eq!(holes(&cut.mesh), count);
        assert_eq!(cut.mesh.euler_characteristic(), chi);
        let original = cut.mesh.triangles().iter();
        let original = original.map(|corners| corners.map(|corner| cut.vertices[corner as usize]));
        assert!(original.eq(mesh.triangles().iter().copied()));
    }
}
