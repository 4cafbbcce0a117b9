//! Split vertices and their welding.

use helfrich::MeshError;
use helfrich_std::io::{MeshFile, weld};
use helfrich_tests::meshes::{Mesh, SplitMix64, difference, disc, icosphere, norm};

/// The mesh with separate vertices for each face, as renderers export it.
fn split(mesh: &Mesh) -> MeshFile {
    let triangles = mesh.connectivity.triangles().iter();
    let corners = triangles
        .flatten()
        .map(|&corner| mesh.positions[corner as usize]);
    let positions = Vec::from_iter(corners);
    let apart = (0..positions.len() as u32)
        .step_by(3)
        .map(|k| [k, k + 1, k + 2]);
    let apart = Mesh::new(positions, apart.collect());
    MeshFile::new(apart.positions, apart.connectivity)
}

/// A sphere and a disc are welded into the same triangles over the same points; the disc keeps its boundary.
#[test]
fn split_meshes_are_put_together() {
    for mesh in [icosphere(2), disc(3)] {
        let split = split(&mesh);
        let faces = mesh.connectivity.triangles().len();
        assert_eq!(split.mesh.components().1, faces);
        assert_eq!(split.split_vertices(), 3 * faces - mesh.positions.len());
        let welded = split.welded().expect("a mesh");
        assert_eq!(welded.split_vertices(), 0);
        assert_eq!(welded.positions.len(), mesh.positions.len());
        assert_eq!(welded.mesh.components().1, 1);
        let points = |positions: &[[f64; 3]], triangles: &[[u32; 3]]| {
            let corners = triangles.iter().flatten();
            Vec::from_iter(corners.map(|&corner| positions[corner as usize]))
        };
        assert_eq!(
            points(&welded.positions, welded.mesh.triangles()),
            points(&mesh.positions, mesh.connectivity.triangles())
        );
    }
}

/// Meshes without split vertices stay unchanged.
#[test]
fn whole_meshes_have_no_split_vertices() {
    let mesh = icosphere(1);
    let file = MeshFile::new(mesh.positions.clone(), mesh.connectivity.clone());
    assert_eq!(file.split_vertices(), 0);
    assert_eq!(file.welded().expect("a mesh"), file);
}

/// Welding two tetrahedra that touch in a vertex would not give a manifold.
#[test]
fn what_only_touches_is_refused() {
    let tetrahedron = |from: f64, to: f64, first: u32| {
        let positions = vec![
            [0.0; 3],
            [to, from, from],
            [from, to, from],
            [from, from, to],
        ];
        let triangles = [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]];
        (positions, triangles.map(|t| t.map(|corner| first + corner)))
    };
    let ((mut positions, mut triangles), (others, more)) = {
        let (positions, triangles) = tetrahedron(0.0, 1.0, 0);
        ((positions, triangles.to_vec()), tetrahedron(0.0, -1.0, 4))
    };
    positions.extend(others);
    triangles.extend(more.map(|[a, b, c]| [a, c, b]));
    let mesh = Mesh::new(positions, triangles);
    let file = MeshFile::new(mesh.positions, mesh.connectivity);
    assert!(file.welded().is_err());
}

/// Corners that were moved a little are one vertex again within the distance, in cells of a grid of any
/// size; the kept vertices are the first of each group.
#[test]
fn vertices_near_each_other_are_merged() {
    let mesh = icosphere(2);
    let mut random = SplitMix64::new(7);
    for scale in [1.0, 1e-150, 1e150] {
        let MeshFile {
            mut positions,
            mesh: apart,
            ..
        } = split(&mesh);
        let shift = 1e-6 * scale;
        for position in &mut positions {
            *position = position.map(|x| scale * x + 0.5 * shift * random.symmetric());
        }
        let none = weld(&positions, apart.triangles(), 0.0).expect("a mesh");
        assert_eq!(none.file.positions.len(), positions.len(), "{scale:e}");
        let welded = weld(&positions, apart.triangles(), 2.0 * shift).expect("a mesh");
        assert_eq!(welded.file.positions.len(), mesh.positions.len());
        assert_eq!(welded.file.mesh.components().1, 1);
        for (corner, &vertex) in welded.vertices.iter().enumerate() {
            let [kept, given] = [welded.file.positions[vertex as usize], positions[corner]];
            let apart = norm(difference(kept, given).map(|x| x / shift));
            assert!(apart <= 2.0, "{corner}: {apart}");
        }
        let first = |vertex: u32| welded.vertices.iter().position(|&it| it == vertex);
        let kept = (0..welded.file.positions.len() as u32).map(|vertex| first(vertex).unwrap());
        let kept = kept.map(|corner| positions[corner]);
        assert_eq!(Vec::from_iter(kept), welded.file.positions);
    }
    // So short a distance that cells are beyond all numbers: only equal points are merged.
    let file = split(&mesh);
    let welded = weld(&file.positions, file.mesh.triangles(), f64::MIN_POSITIVE).expect("a mesh");
    assert_eq!(welded.file, file.welded().expect("a mesh"));
}

/// A face that names no vertex is refused before anything is merged.
#[test]
fn faces_without_a_vertex_are_refused() {
    let error = weld(&[[0.0; 3]; 3], &[[0, 1, 2], [0, 1, 3]], 1.0).expect_err("no vertex 3");
    assert_eq!(
        error,
        MeshError::VertexOutOfRange {
            triangle: 1,
            vertex: 3,
            vertices: 3
        }
    );
}
