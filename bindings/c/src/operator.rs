//! Matrices of linear finite elements, and gradients.

use crate::call::{Call, finite, surface};
use crate::mesh::Mesh;
use crate::number::Number;
use crate::status::{Failure, Outcome};
use helfrich::{Cotangent, DualArea, SparseMatrix, Surface, TriangleMesh};
use helfrich_std::execute::Parallel;
use helfrich_std::method::MethodOptions;
use std::ffi::c_char;

/// Number of entries of the matrices of a mesh: one for each vertex, and two for each edge; 0 if it is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_mesh_entry_count(mesh: *const Mesh) -> usize {
    // SAFETY: the caller keeps the contract of this library.
    unsafe { mesh.as_ref() }.map_or(0, |mesh| entry_count(&mesh.triangles))
}

fn entry_count(mesh: &TriangleMesh) -> usize {
    mesh.vertex_count() + 2 * mesh.edges().len()
}

/// A matrix in rows, in arrays of the caller.
struct Rows<N> {
    offsets: *mut usize,
    columns: *mut usize,
    values: *mut N,
    entries: usize,
}

fn matrix<N: Number>(
    call: &mut Call,
    mesh: *const Mesh,
    (positions, count): (*const [N; 3], usize),
    rows: &Rows<N>,
    assemble: impl FnOnce(Surface<'_, f64>) -> SparseMatrix<f64>,
) -> Outcome {
    let mesh = &call.object("mesh", mesh)?.triangles;
    let positions = call.at_vertices("positions", positions, count, mesh)?;
    let surface = surface(mesh, &positions)?;
    let entries = entry_count(mesh);
    if rows.entries != entries {
        let of = "as many as hf_mesh_entry_count says";
        return Err(Failure::count("values", rows.entries, entries, of));
    }
    let offsets = call.write("offsets", rows.offsets, mesh.vertex_count() + 1)?;
    let columns = call.write("columns", rows.columns, rows.entries)?;
    let values = call.write("values", rows.values, rows.entries)?;
    let (own_offsets, own_columns, own_values) = assemble(surface).into_parts();
    offsets.copy_from_slice(&own_offsets);
    columns.copy_from_slice(&own_columns);
    for (value, own) in values.iter_mut().zip(own_values) {
        *value = N::nearest(own);
    }
    finite("values", "entry", values.iter().copied(), 1)
}

fn stiffness(surface: Surface<'_, f64>) -> SparseMatrix<f64> {
    Cotangent::new(DualArea::Mixed).stiffness(surface)
}

fn mass(surface: Surface<'_, f64>) -> SparseMatrix<f64> {
    Cotangent::new(DualArea::Mixed).mass(surface)
}

twins! {
    /// Sets a matrix to the stiffness S_ij = ∫ ∇λ_i·∇λ_j dS of linear finite elements: symmetric, positive
    /// semi-definite, dimensionless. −Δ_S φ is S φ divided by the areas of hf_vertex_areas.
    ///
    /// The matrix is in compressed rows: row i has the entries `offsets[i]` to `offsets[i + 1]`, excluded, of
    /// `columns` and `values`, columns in increasing order. `offsets` has a number for each of `count` vertices and one
    /// more; `columns` and `values` have `entries` numbers, as many as hf_mesh_entry_count says. The pattern depends
    /// on the mesh alone.
    fn hf_stiffness, hf_stiffness_f32<$N>(
        mesh: *const Mesh, positions: *const [$N; 3], count: usize, offsets: *mut usize,
        columns: *mut usize, values: *mut $N, entries: usize,
    ) |call| {
        let rows = Rows { offsets, columns, values, entries };
        matrix(call, mesh, (positions, count), &rows, stiffness)
    }
}

twins! {
    /// Sets a matrix to the consistent mass M_ij = ∫ λ_i λ_j dS, length², with the pattern of hf_stiffness:
    /// positive definite, and all entries together are the area.
    fn hf_mass, hf_mass_f32<$N>(
        mesh: *const Mesh, positions: *const [$N; 3], count: usize, offsets: *mut usize,
        columns: *mut usize, values: *mut $N, entries: usize,
    ) |call| {
        let rows = Rows { offsets, columns, values, entries };
        matrix(call, mesh, (positions, count), &rows, mass)
    }
}

fn areas<N: Number>(
    call: &mut Call,
    mesh: *const Mesh,
    (positions, count): (*const [N; 3], usize),
    kind: *const c_char,
    areas: *mut [N; 1],
) -> Outcome {
    let mesh = &call.object("mesh", mesh)?.triangles;
    let positions = call.at_vertices("positions", positions, count, mesh)?;
    let surface = surface(mesh, &positions)?;
    let kind = MethodOptions::parse_areas(call.text("kind", kind)?).map_err(Failure::argument)?;
    let areas = call.write("areas", areas, count)?;
    N::compute(&mut *areas, |areas| {
        let areas = areas.as_flattened_mut();
        Cotangent::new(kind).dual_areas(&Parallel::single(), surface, areas);
    });
    finite("areas", "vertex", areas.as_flattened().iter().copied(), 1)
}

twins! {
    /// Sets `areas` to the areas of the vertices, length², the diagonal of the lumped mass matrix.
    ///
    /// `kind` is "mixed", "voronoi" or "barycentric".
    fn hf_vertex_areas, hf_vertex_areas_f32<$N>(
        mesh: *const Mesh, positions: *const [$N; 3], count: usize, kind: *const c_char,
        areas: *mut $N,
    ) |call| self::areas(call, mesh, (positions, count), kind, areas.cast())
}

fn gradient<N: Number>(
    call: &mut Call,
    mesh: *const Mesh,
    (positions, count): (*const [N; 3], usize),
    field: *const [N; 1],
    gradient: *mut [N; 3],
    triangle_count: usize,
) -> Outcome {
    let mesh = &call.object("mesh", mesh)?.triangles;
    let positions = call.at_vertices("positions", positions, count, mesh)?;
    let surface = surface(mesh, &positions)?;
    let field = call.field("field", field, count, mesh)?;
    let triangles = mesh.triangles().len();
    if triangle_count != triangles {
        let of = "one for each triangle";
        return Err(Failure::count("gradient", triangle_count, triangles, of));
    }
    let gradient = call.write("gradient", gradient, triangles)?;
    N::compute(&mut *gradient, |gradient| {
        let field = field.as_flattened();
        Cotangent::new(DualArea::Mixed).gradient(&Parallel::single(), surface, field, gradient);
    });
    finite(
        "gradient",
        "triangle",
        gradient.as_flattened().iter().copied(),
        3,
    )
}

twins! {
    /// Sets `gradient`, `triangle_count` rows of three, to the surface gradient of a field with a number for each of
    /// `count` vertices: one tangential vector for each triangle, in the unit of the field divided by length.
    fn hf_gradient, hf_gradient_f32<$N>(
        mesh: *const Mesh, positions: *const [$N; 3], count: usize, field: *const $N,
        gradient: *mut [$N; 3], triangle_count: usize,
    ) |call| self::gradient(call, mesh, (positions, count), field.cast(), gradient, triangle_count)
}
