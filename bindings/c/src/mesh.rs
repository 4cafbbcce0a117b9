//! Meshes: triangles of vertices, and mesh files.

use crate::call::{Call, finite_sum, free, guarded, of_vertices, surface};
use crate::number::Number;
use crate::status::{Error, Failure, Outcome, Status};
use helfrich::{Surface, TriangleMesh};
use helfrich_std::io::{read, read_welded};
use std::ffi::c_char;
use std::path::Path;
use std::sync::Arc;

/// An oriented manifold of triangles, closed or with edges. It never changes, and several threads may use it.
#[derive(Debug)]
pub struct Mesh {
    pub(crate) triangles: Arc<TriangleMesh>,
    /// Positions from a mesh file, or of a new mesh of a surface.
    positions: Option<Vec<[f64; 3]>>,
}

impl Mesh {
    /// A mesh with positions.
    pub(crate) fn new(mesh: TriangleMesh, positions: Vec<[f64; 3]>) -> Self {
        Self {
            triangles: Arc::new(mesh),
            positions: Some(positions),
        }
    }
}

/// Makes a mesh of triangles whose corners run counter-clockwise seen from outside.
///
/// `triangles` has `triangle_count` rows of three numbers of vertices, each below `vertex_count`. On success
/// `*mesh` is a new mesh, which hf_mesh_free frees. Fails with HF_STATUS_INVALID_MESH if the triangles are no
/// oriented manifold.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_mesh_new(
    vertex_count: usize,
    triangles: *const [u32; 3],
    triangle_count: usize,
    mesh: *mut *mut Mesh,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps the contract of this library.
    unsafe {
        guarded(error, |call| {
            let triangles = call.read("triangles", triangles, triangle_count)?;
            let triangles = TriangleMesh::new(vertex_count, triangles.to_vec())?;
            let made = Mesh {
                triangles: Arc::new(triangles),
                positions: None,
            };
            call.give("mesh", mesh, made)
        })
    }
}

/// Reads a mesh with its positions from an OBJ, OFF, STL, PLY, VTP, VTU, VTK, glTF, MSH, GIFTI or 3MF file.
///
/// `path` is UTF-8. Vertices at the same point are merged if `weld` is not 0. On success `*mesh` is a new mesh,
/// which hf_mesh_free frees. Fails with HF_STATUS_UNREADABLE_FILE if there is no such file or no mesh in it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_mesh_read(
    path: *const c_char,
    weld: u32,
    mesh: *mut *mut Mesh,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps the contract of this library.
    unsafe {
        guarded(error, |call| {
            let path = Path::new(call.text("path", path)?);
            let file = if weld == 0 {
                read(path)
            } else {
                read_welded(path)
            };
            let file = file.map_err(|error| Failure::new(Status::UnreadableFile, error))?;
            call.give("mesh", mesh, Mesh::new(file.mesh, file.positions))
        })
    }
}

/// Frees a mesh; NULL is ignored. Membranes and methods that were made with it stay usable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_mesh_free(mesh: *mut Mesh) {
    // SAFETY: the caller keeps the contract of this library.
    unsafe { free(mesh) }
}

/// Number of vertices, or 0 if `mesh` is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_mesh_vertex_count(mesh: *const Mesh) -> usize {
    // SAFETY: the caller keeps the contract of this library.
    unsafe { mesh.as_ref() }.map_or(0, |mesh| mesh.triangles.vertex_count())
}

/// Number of triangles, or 0 if `mesh` is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_mesh_triangle_count(mesh: *const Mesh) -> usize {
    // SAFETY: the caller keeps the contract of this library.
    unsafe { mesh.as_ref() }.map_or(0, |mesh| mesh.triangles.triangles().len())
}

/// Sets `triangles` to the corners of the triangles, `triangle_count` rows of three.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_mesh_triangles(
    mesh: *const Mesh,
    triangles: *mut [u32; 3],
    triangle_count: usize,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps the contract of this library.
    unsafe {
        guarded(error, |call| {
            let own = call.object("mesh", mesh)?.triangles.triangles();
            if triangle_count != own.len() {
                let of = "one for each triangle";
                return Err(Failure::count("triangles", triangle_count, own.len(), of));
            }
            let triangles = call.write("triangles", triangles, triangle_count)?;
            triangles.copy_from_slice(own);
            Ok(())
        })
    }
}

fn positions<N: Number>(
    call: &mut Call,
    mesh: *const Mesh,
    positions: *mut [N; 3],
    count: usize,
) -> Outcome {
    let mesh = call.object("mesh", mesh)?;
    let Some(own) = &mesh.positions else {
        let text = "the mesh was made of triangles alone: only those from files and of hf_remesh have positions";
        return Err(Failure::new(Status::Undefined, text));
    };
    of_vertices("positions", count, &mesh.triangles)?;
    let positions = call.write("positions", positions, count)?;
    for (position, own) in positions.iter_mut().zip(own) {
        *position = own.map(N::nearest);
    }
    Ok(())
}

twins! {
    /// Sets `positions`, `count` rows of three, to the positions in the mesh's file, in its unit of length, or to those
    /// of a mesh that hf_remesh made.
    ///
    /// Fails with HF_STATUS_UNDEFINED for meshes of triangles alone.
    fn hf_mesh_positions, hf_mesh_positions_f32<$N>(
        mesh: *const Mesh, positions: *mut [$N; 3], count: usize,
    ) |call| self::positions(call, mesh, positions, count)
}

fn size<N: Number>(
    call: &mut Call,
    mesh: *const Mesh,
    positions: *const [N; 3],
    count: usize,
    size: (&'static str, *mut N),
    measure: impl FnOnce(Surface<'_, f64>) -> Option<f64>,
) -> Outcome {
    let mesh = &call.object("mesh", mesh)?.triangles;
    let positions = call.at_vertices("positions", positions, count, mesh)?;
    let (name, place) = (size.0, call.place(size.0, size.1)?);
    let size = measure(surface(mesh, &positions)?).ok_or_else(|| {
        let edges = mesh.boundary_edge_count();
        let text = format!("the mesh has {edges} boundary edges, and encloses no volume");
        Failure::new(Status::Undefined, text)
    })?;
    *place = finite_sum(name, N::nearest(size))?;
    Ok(())
}

twins! {
    /// Sets `*area` to the area of a surface, length².
    fn hf_area, hf_area_f32<$N>(
        mesh: *const Mesh, positions: *const [$N; 3], count: usize, area: *mut $N,
    ) |call| size(call, mesh, positions, count, ("area", area), |at| Some(at.area()))
}

twins! {
    /// Sets `*volume` to the enclosed volume, length³: positive if triangles run counter-clockwise seen from
    /// outside. Fails with HF_STATUS_UNDEFINED for open surfaces.
    fn hf_volume, hf_volume_f32<$N>(
        mesh: *const Mesh, positions: *const [$N; 3], count: usize, volume: *mut $N,
    ) |call| size(call, mesh, positions, count, ("volume", volume), |at| at.volume())
}
