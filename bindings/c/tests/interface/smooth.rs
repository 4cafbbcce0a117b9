//! Smooth surfaces and new meshes.

use super::errors::fails;
use super::{Handle, ellipsoid, mesh_of, outcome, succeed};
use helfrich::{MeshPoint, SmoothSurface as Smooth, Surface, TriangleMesh};
use helfrich_capi::Status;
use helfrich_capi::mesh::{
    Mesh, hf_mesh_free, hf_mesh_positions, hf_mesh_triangle_count, hf_mesh_triangles,
    hf_mesh_vertex_count,
};
use helfrich_capi::smooth::{
    Remeshing, SmoothSurface, SurfacePoints, hf_remesh, hf_surface_at, hf_surface_free,
    hf_surface_interpolate, hf_surface_new, hf_surface_project,
};
use helfrich_std::execute::Parallel;
use std::ptr::{null, null_mut};

fn smooth_of(mesh: &TriangleMesh, positions: &[[f64; 3]]) -> Handle<SmoothSurface> {
    let (mesh, mut handle) = (mesh_of(mesh), null_mut());
    let (at, count) = (positions.as_ptr(), positions.len());
    let place = &raw mut handle;
    succeed(|error| unsafe { hf_surface_new(mesh.0, at, count, 0, 0, place, error) });
    Handle(handle, hf_surface_free)
}

#[test]
fn points_fields_and_projections_are_those_of_the_library() {
    let (mesh, positions) = ellipsoid(642);
    let handle = smooth_of(&mesh, &positions);
    let surface = Surface::new(&mesh, &positions).unwrap();
    let smooth = Smooth::new(&Parallel::new(), surface, &Smooth::jet_for(&mesh));
    let count = mesh.triangles().len();
    let faces = Vec::from_iter(0..count as u32);
    let weights = vec![[0.5, 0.25, 0.25]; count];
    let places = faces.iter().map(|&face| MeshPoint {
        triangle: face as usize,
        barycentric: weights[0],
    });
    let places = Vec::from_iter(places);
    let expected = smooth.all_at(&Parallel::new(), &places);

    let mut position = vec![[0.0; 3]; count];
    let (mut mean, mut gaussian_error) = (vec![0.0; count], vec![0.0; count]);
    let (mut principal, mut direction) = (vec![[0.0; 2]; count], vec![[0.0; 3]; count]);
    let wanted = SurfacePoints {
        position: position.as_mut_ptr(),
        position_error: null_mut(),
        normal: null_mut(),
        mean: mean.as_mut_ptr(),
        mean_error: null_mut(),
        gaussian: null_mut(),
        gaussian_error: gaussian_error.as_mut_ptr(),
        principal: principal.as_mut_ptr(),
        direction: direction.as_mut_ptr(),
    };
    let (of, at) = (faces.as_ptr(), weights.as_ptr());
    succeed(|error| unsafe { hf_surface_at(handle.0, of, at, count, 0, &raw const wanted, error) });
    for (k, point) in expected.iter().enumerate() {
        assert_eq!(position[k], point.position);
        assert_eq!(
            (mean[k], gaussian_error[k]),
            (point.mean, point.curvature_errors[1])
        );
        assert_eq!(
            (principal[k], direction[k]),
            (point.principal(), point.direction)
        );
    }

    let field = Vec::from_iter(positions.iter().map(|[x, y, z]| x * y + z));
    let fitted = smooth.fields(&Parallel::new(), &[&field]);
    let (mut values, mut errors) = (vec![0.0; count], vec![0.0; count]);
    let (from, to) = (field.as_ptr(), (values.as_mut_ptr(), errors.as_mut_ptr()));
    succeed(|error| unsafe {
        let vertices = field.len();
        hf_surface_interpolate(
            handle.0, from, vertices, of, at, count, 0, to.0, to.1, error,
        )
    });
    for (k, &place) in places.iter().enumerate() {
        let point = fitted.at(0, place);
        assert_eq!((values[k], errors[k]), (point.value, point.error));
    }

    let outside = Vec::from_iter(position.iter().map(|at| at.map(|x| 1.01 * x)));
    let expected = smooth.project_all(&Parallel::new(), &outside);
    let (mut found, mut corners) = (vec![0; count], vec![[0.0; 3]; count]);
    let (from, to) = (outside.as_ptr(), (found.as_mut_ptr(), corners.as_mut_ptr()));
    succeed(|error| unsafe { hf_surface_project(handle.0, from, count, 0, to.0, to.1, error) });
    for (k, place) in expected.into_iter().enumerate() {
        let place = place.unwrap();
        assert_eq!(
            (found[k] as usize, corners[k]),
            (place.triangle, place.barycentric)
        );
    }
}

const EVEN: Remeshing = Remeshing {
    vertices: 0,
    edge: 0.0,
    creases: 60.0,
    smooth: 0,
};

fn remeshed(mesh: &Handle<Mesh>, positions: &[[f64; 3]], remeshing: Remeshing) -> Handle<Mesh> {
    let mut made = null_mut();
    let (at, count) = (positions.as_ptr(), positions.len());
    let place = &raw mut made;
    succeed(|error| unsafe { hf_remesh(mesh.0, at, count, &raw const remeshing, 0, place, error) });
    Handle(made, hf_mesh_free)
}

/// A mesh with its positions.
fn contents(mesh: &Handle<Mesh>) -> (Vec<[u32; 3]>, Vec<[f64; 3]>) {
    let (vertices, count) =
        unsafe { (hf_mesh_vertex_count(mesh.0), hf_mesh_triangle_count(mesh.0)) };
    let (mut triangles, mut positions) = (vec![[0; 3]; count], vec![[0.0; 3]; vertices]);
    let (corners, at) = (triangles.as_mut_ptr(), positions.as_mut_ptr());
    succeed(|error| unsafe { hf_mesh_triangles(mesh.0, corners, count, error) });
    succeed(|error| unsafe { hf_mesh_positions(mesh.0, at, vertices, error) });
    (triangles, positions)
}

#[test]
fn new_meshes_have_the_vertices_or_edges_that_are_asked_for() {
    let (mesh, positions) = ellipsoid(642);
    let handle = mesh_of(&mesh);
    for (remeshing, expected) in [
        (EVEN, 642..643),
        (
            Remeshing {
                vertices: 500,
                ..EVEN
            },
            500..501,
        ),
        // Equilateral triangles of this edge on an area of 8.0: 230 vertices.
        (Remeshing { edge: 0.2, ..EVEN }, 215..250),
    ] {
        let (triangles, places) = contents(&remeshed(&handle, &positions, remeshing));
        assert!(expected.contains(&places.len()), "{}", places.len());
        assert_eq!(triangles.len(), 2 * places.len() - 4);
        for [x, y, z] in places {
            let level = x * x + (y / 0.8).powi(2) + (z / 0.6).powi(2);
            assert!((level - 1.0).abs() < 1e-3, "{level}");
        }
    }
}

#[test]
fn wrong_places_and_requests_are_refused() {
    let (mesh, positions) = ellipsoid(162);
    let handle = smooth_of(&mesh, &positions);
    let mesh = mesh_of(&mesh);
    let (at, count) = (positions.as_ptr(), positions.len());
    let mut made: *mut SmoothSurface = null_mut();
    let place = &raw mut made;
    let degree = outcome(|error| unsafe { hf_surface_new(mesh.0, at, count, 5, 0, place, error) });
    fails(degree, Status::InvalidArgument, "`degree` is 5");
    assert!(made.is_null());

    let mut value = 0.0;
    let place = &raw mut value;
    let interpolate = |field: &[f64], face: u32, weights: [f64; 3]| {
        let (from, vertices) = (field.as_ptr(), field.len());
        let (of, at) = (&raw const face, &raw const weights);
        outcome(|error| unsafe {
            let none = null_mut();
            hf_surface_interpolate(handle.0, from, vertices, of, at, 1, 0, place, none, error)
        })
    };
    let field = vec![1.0; count];
    let corner = [1.0, 0.0, 0.0];
    fails(
        interpolate(&field, 320, corner),
        Status::InvalidArgument,
        "`faces` is 320 at 0",
    );
    for wrong in [[1.0; 3], [2.0, -1.0, 0.0], [f64::NAN, 0.0, 1.0]] {
        fails(
            interpolate(&field, 0, wrong),
            Status::InvalidArgument,
            "`weights`",
        );
    }
    fails(
        interpolate(&field[1..], 0, corner),
        Status::InvalidCount,
        "162 are needed",
    );
    fails(
        interpolate(&[f64::NAN; 162], 0, corner),
        Status::InvalidArgument,
        "at vertex 0",
    );

    let far = [f64::INFINITY, 0.0, 0.0];
    let (mut face, mut weights) = (0, [0.0; 3]);
    let (from, to) = (&raw const far, (&raw mut face, &raw mut weights));
    let project =
        outcome(|error| unsafe { hf_surface_project(handle.0, from, 1, 0, to.0, to.1, error) });
    fails(project, Status::InvalidArgument, "`points`");

    for (remeshing, part) in [
        (
            Remeshing {
                vertices: 3,
                ..EVEN
            },
            "`vertices` is 3",
        ),
        (Remeshing { edge: -1.0, ..EVEN }, "`edge` is -1"),
        (
            Remeshing {
                creases: 0.0,
                ..EVEN
            },
            "`creases` is 0",
        ),
        (
            Remeshing {
                vertices: 100,
                edge: 0.1,
                ..EVEN
            },
            "together",
        ),
    ] {
        let mut made: *mut Mesh = null_mut();
        let place = &raw mut made;
        let refused = outcome(|error| unsafe {
            hf_remesh(mesh.0, at, count, &raw const remeshing, 0, place, error)
        });
        fails(refused, Status::InvalidArgument, part);
    }
    let mut made: *mut Mesh = null_mut();
    let place = &raw mut made;
    let missing = outcome(|error| unsafe { hf_remesh(mesh.0, at, count, null(), 0, place, error) });
    fails(missing, Status::NullPointer, "`remeshing` is NULL");
    let (mesh, positions) = ellipsoid(642);
    let (mesh, count) = (mesh_of(&mesh), positions.len());
    let rough = positions.iter().enumerate().map(|(k, at)| {
        let part = (12.9898 * k as f64).sin() * 43_758.547 % 1.0;
        at.map(|x| x * (1.0 + 0.01 * part))
    });
    let rough = Vec::from_iter(rough);
    let noisy = outcome(|error| unsafe {
        hf_remesh(mesh.0, rough.as_ptr(), count, &EVEN, 0, place, error)
    });
    fails(noisy, Status::Undefined, "`smooth` removes it");
}
