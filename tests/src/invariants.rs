//! Checks of accepted input that do not use the code under test, for tests and fuzz targets.

use std::collections::{BTreeMap, BTreeSet};

use helfrich::{TriangleMesh, VertexKind};
use helfrich_std::io::{
    Column, ColumnPlace, Format, ParseError, parse, parse_soup, parse_with_columns,
};
use helfrich_std::repair::Soup;

/// Parses bytes. If they are accepted, positions must be finite, vertices must exist, and columns must
/// have one number per vertex. If they are refused, the same holds for the triangles that are read for a repair, except
/// that positions need not be finite.
///
/// # Panics
/// If this does not hold, or if the message of an error is not a single line.
pub fn check_reader(bytes: &[u8], format: Format) {
    match parse(bytes, format) {
        Ok(file) => {
            assert_eq!(file.mesh.vertex_count(), file.positions.len());
            assert!(file.positions.iter().flatten().all(|x| x.is_finite()));
            assert!(!file.mesh.triangles().is_empty());
            let mut corners = file.mesh.triangles().iter().flatten();
            assert!(corners.all(|&vertex| (vertex as usize) < file.positions.len()));
            match parse_with_columns(bytes, format) {
                Ok((same, columns)) => {
                    assert_eq!(same, file);
                    for column in columns {
                        let length = match column.place {
                            ColumnPlace::Vertices => file.positions.len(),
                            ColumnPlace::Triangles => file.mesh.triangles().len(),
                        };
                        assert_eq!(column.values.len(), length);
                    }
                }
                Err(error) => check_message(&error),
            }
        }
        Err(error) => {
            check_message(&error);
            match parse_soup(bytes, format) {
                Ok((soup, columns)) => check_soup(&soup, &columns),
                Err(error) => check_message(&error),
            }
        }
    }
}

fn check_soup(soup: &Soup, columns: &[Column]) {
    let (vertices, triangles) = (soup.positions.len(), soup.triangles.len());
    let mut corners = soup.triangles.iter().flatten();
    assert!(corners.all(|&vertex| (vertex as usize) < vertices));
    for column in columns {
        let length = match column.place {
            ColumnPlace::Vertices => vertices,
            ColumnPlace::Triangles => triangles,
        };
        assert_eq!(column.values.len(), length);
    }
}

fn check_message(error: &ParseError) {
    let message = error.to_string();
    assert!(!message.is_empty() && !message.chars().any(char::is_control));
}

/// Checks everything that [`TriangleMesh`] promises, from its list of triangles alone.
///
/// # Panics
/// If a promise is broken.
pub fn check_invariants(mesh: &TriangleMesh, vertices: usize) {
    assert_eq!(mesh.vertex_count(), vertices);
    let mut sides = BTreeMap::new();
    let mut sets = BTreeSet::new();
    for (triangle, &[a, b, c]) in (0..).zip(mesh.triangles()) {
        assert!([a, b, c].iter().all(|&vertex| (vertex as usize) < vertices));
        assert!(a != b && b != c && c != a);
        assert!(sets.insert(BTreeSet::from([a, b, c])), "a triangle twice");
        for side in [[a, b], [b, c], [c, a]] {
            assert!(sides.insert(side, triangle).is_none(), "a side twice");
        }
    }
    check_edges(mesh, &sides);
    for vertex in 0..vertices as u32 {
        check_ring(mesh, vertex, &sides);
    }
    check_components(mesh);
}

fn check_edges(mesh: &TriangleMesh, sides: &BTreeMap<[u32; 2], u32>) {
    let mut seen = BTreeSet::new();
    let mut boundary = 0;
    for (at, &[a, b]) in mesh.edges().iter().enumerate() {
        assert!(seen.insert([a.min(b), a.max(b)]), "an edge twice");
        let (left, right) = mesh.edge_triangles(at);
        assert_eq!(sides.get(&[a, b]), Some(&left));
        assert_eq!(sides.get(&[b, a]), right.as_ref());
        boundary += usize::from(right.is_none());
    }
    let all = BTreeSet::from_iter(sides.keys().map(|&[a, b]| [a.min(b), a.max(b)]));
    assert_eq!(seen, all);
    assert_eq!(mesh.boundary_edge_count(), boundary);
    assert_eq!(mesh.is_closed(), boundary == 0);
}

/// Checks that the ring contains every neighbour once, that consecutive neighbours span a triangle with the
/// vertex in this orientation, and that these are all its triangles, so that they form one fan.
fn check_ring(mesh: &TriangleMesh, vertex: u32, sides: &BTreeMap<[u32; 2], u32>) {
    let ring = mesh.one_ring(vertex as usize);
    let mut neighbours = BTreeSet::new();
    for &[a, b] in sides.keys() {
        if a == vertex {
            neighbours.insert(b);
        } else if b == vertex {
            neighbours.insert(a);
        }
    }
    assert_eq!(ring.len(), neighbours.len());
    assert_eq!(BTreeSet::from_iter(ring.iter().copied()), neighbours);
    let count = mesh
        .triangles()
        .iter()
        .filter(|t| t.contains(&vertex))
        .count();
    let expected = match mesh.vertex_kind(vertex as usize) {
        VertexKind::Isolated => {
            assert!(ring.is_empty());
            0
        }
        VertexKind::Boundary => ring.len() - 1,
        VertexKind::Interior => ring.len(),
    };
    assert_eq!(count, expected);
    for at in 0..expected {
        let (here, next) = (ring[at], ring[(at + 1) % ring.len()]);
        let triangle = sides.get(&[vertex, here]);
        assert!(triangle.is_some());
        assert_eq!(triangle, sides.get(&[here, next]));
        assert_eq!(triangle, sides.get(&[next, vertex]));
    }
}

fn check_components(mesh: &TriangleMesh) {
    let (component, count) = mesh.components();
    assert_eq!(component.len(), mesh.vertex_count());
    for [a, b] in mesh.edges() {
        assert_eq!(component[*a as usize], component[*b as usize]);
    }
    let mut next = 0;
    for &number in &component {
        assert!(number <= next, "not numbered by the lowest vertex");
        next = next.max(number + 1);
    }
    assert_eq!(next as usize, count);
}
