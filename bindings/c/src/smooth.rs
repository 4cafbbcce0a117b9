//! The smooth surface through the vertices of a mesh, and new meshes of it.

use crate::call::{Call, free, surface};
use crate::membrane::threads;
use crate::mesh::Mesh;
use crate::number::Number;
use crate::status::{Failure, Outcome, Status};
use helfrich::{Jet, MeshPoint, SmoothPoint, SmoothSurface as Smooth, VertexKind};
use helfrich_std::execute::{Parallel, with_threads};
use helfrich_std::remesh::{EdgeLengths, MeshRequest, OfNoise, RemeshError, remeshed};

/// The smooth surface through the vertices of a mesh. It never changes, and several threads may use it.
#[derive(Debug)]
pub struct SmoothSurface {
    smooth: Smooth<f64>,
}

/// Arrays of the caller for points of a smooth surface: `count` entries each, or NULL where a result is not wanted.
/// Curvatures that are not known are 0, with an infinite error.
#[derive(Debug)]
#[repr(C)]
pub struct SurfacePoints<N> {
    /// Position, a length.
    pub position: *mut [N; 3],
    /// Error bar of the position along the normal if the vertices are exact, a length; 0 at vertices.
    pub position_error: *mut N,
    /// Outward unit normal.
    pub normal: *mut [N; 3],
    /// Mean curvature H, 1/length, positive on a sphere.
    pub mean: *mut N,
    /// Estimated error of H.
    pub mean_error: *mut N,
    /// Gaussian curvature K, 1/length².
    pub gaussian: *mut N,
    /// Estimated error of K.
    pub gaussian_error: *mut N,
    /// Principal curvatures k1 ≥ k2, 1/length.
    pub principal: *mut [N; 2],
    /// Unit vector along k1; 0 at umbilics.
    pub direction: *mut [N; 3],
}

fn new<N: Number>(
    call: &mut Call,
    mesh: *const Mesh,
    (positions, count): (*const [N; 3], usize),
    degree: u32,
    thread_count: usize,
    made: *mut *mut SmoothSurface,
) -> Outcome {
    let mesh = &call.object("mesh", mesh)?.triangles;
    let positions = call.at_vertices("positions", positions, count, mesh)?;
    let surface = surface(mesh, &positions)?;
    let jet = match degree {
        0 => Smooth::jet_for(mesh),
        4 => Jet::j4(),
        6 => Jet::j6(),
        8 => Jet::j8(),
        _ => {
            let text = format!(
                "`degree` is {degree}: 4, 6 or 8 is needed, or 0 for that which suits the mesh"
            );
            return Err(Failure::argument(text));
        }
    };
    let smooth = with_threads(threads(thread_count), || {
        Smooth::new(&Parallel::new(), surface, &jet)
    });
    call.give("surface", made, SmoothSurface { smooth })
}

twins! {
    /// Fits the smooth surface through the vertices of a mesh, by polynomials of this degree, 4, 6, 8, or 0 for that
    /// which suits the mesh, on up to `threads` threads, 0 for all.
    ///
    /// `positions` has `count` rows of three, which are taken as exact. On success `*surface` is a new surface, which
    /// hf_surface_free frees. Positions have errors of order degree + 1 in the edge length, H and K of order degree − 1.
    fn hf_surface_new, hf_surface_new_f32<$N>(
        mesh: *const Mesh, positions: *const [$N; 3], count: usize, degree: u32, threads: usize,
        surface: *mut *mut SmoothSurface,
    ) |call| new(call, mesh, (positions, count), degree, threads, surface)
}

/// Frees a surface; NULL is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_surface_free(surface: *mut SmoothSurface) {
    // SAFETY: the caller keeps the contract of this library.
    unsafe { free(surface) }
}

/// Places of the mesh, which are checked.
fn places<N: Number>(
    call: &mut Call,
    smooth: &Smooth<f64>,
    (faces, weights): (*const u32, *const [N; 3]),
    count: usize,
) -> Result<Vec<MeshPoint<f64>>, Failure> {
    let faces = call.read("faces", faces, count)?;
    let weights = N::widen(call.read("weights", weights, count)?);
    let triangles = smooth.surface().mesh().triangles().len();
    let places = faces.iter().zip(weights.iter()).enumerate();
    let places = places.map(|(row, (&face, &barycentric))| {
        let triangle = face as usize;
        if triangle >= triangles {
            let text = format!("`faces` is {face} at {row}: the mesh has {triangles} triangles, numbered from 0");
            return Err(Failure::argument(text));
        }
        // Also for NaN. Weights of the twin are rounded.
        let is_inside = barycentric.iter().all(|weight| *weight >= 0.0);
        if !is_inside || (barycentric.iter().sum::<f64>() - 1.0).abs() > 1e-6 {
            let text = format!(
                "`weights` is {barycentric:?} at {row}: weights of corners are at least 0, with the sum 1"
            );
            return Err(Failure::argument(text));
        }
        Ok(MeshPoint {
            triangle,
            barycentric,
        })
    });
    places.collect()
}

fn at<N: Number>(
    call: &mut Call,
    surface: *const SmoothSurface,
    of: (*const u32, *const [N; 3]),
    count: usize,
    thread_count: usize,
    results: *const SurfacePoints<N>,
) -> Outcome {
    let smooth = &call.object("surface", surface)?.smooth;
    let places = places(call, smooth, of, count)?;
    let results = call.object("results", results)?;
    let position = call.write_if_wanted("position", results.position, count)?;
    let position_error = call.write_if_wanted("position_error", results.position_error, count)?;
    let normal = call.write_if_wanted("normal", results.normal, count)?;
    let mean = call.write_if_wanted("mean", results.mean, count)?;
    let mean_error = call.write_if_wanted("mean_error", results.mean_error, count)?;
    let gaussian = call.write_if_wanted("gaussian", results.gaussian, count)?;
    let gaussian_error = call.write_if_wanted("gaussian_error", results.gaussian_error, count)?;
    let principal = call.write_if_wanted("principal", results.principal, count)?;
    let direction = call.write_if_wanted("direction", results.direction, count)?;

    let points = with_threads(threads(thread_count), || {
        smooth.all_at(&Parallel::new(), &places)
    });
    fn put<V>(
        place: Option<&mut [V]>,
        points: &[SmoothPoint<f64>],
        of: impl Fn(&SmoothPoint<f64>) -> V,
    ) {
        for (place, point) in place.into_iter().flatten().zip(points) {
            *place = of(point);
        }
    }
    let vector = |of: [f64; 3]| of.map(N::nearest);
    let known = |of: f64| N::nearest(if of.is_nan() { 0.0 } else { of });
    put(position, &points, |at| vector(at.position));
    put(position_error, &points, |at| N::nearest(at.position_error));
    put(normal, &points, |at| vector(at.normal));
    put(mean, &points, |at| known(at.mean));
    put(mean_error, &points, |at| N::nearest(at.curvature_errors[0]));
    put(gaussian, &points, |at| known(at.gaussian));
    put(gaussian_error, &points, |at| {
        N::nearest(at.curvature_errors[1])
    });
    put(principal, &points, |at| at.principal().map(known));
    put(direction, &points, |at| vector(at.direction));
    Ok(())
}

twins! {
    /// Points of a smooth surface over places of its mesh, on up to `threads` threads, 0 for all.
    ///
    /// `faces` has `count` numbers of triangles, `weights` `count` rows with the weights of their corners, at least 0
    /// with the sum 1. Sets the arrays of `results`.
    fn hf_surface_at, hf_surface_at_f32<$N>(
        surface: *const SmoothSurface, faces: *const u32, weights: *const [$N; 3], count: usize, threads: usize,
        results: *const SurfacePoints<$N>,
    ) |call| at(call, surface, (faces, weights), count, threads, results)
}

fn project<N: Number>(
    call: &mut Call,
    surface: *const SmoothSurface,
    (points, count): (*const [N; 3], usize),
    thread_count: usize,
    faces: *mut u32,
    weights: *mut [N; 3],
) -> Outcome {
    let smooth = &call.object("surface", surface)?.smooth;
    let points = N::widen(call.read("points", points, count)?);
    let faces = call.write("faces", faces, count)?;
    let weights = call.write("weights", weights, count)?;
    let far = |point: &[f64; 3]| !point.iter().all(|x| x.is_finite());
    if let Some(row) = points.iter().position(far) {
        let text = format!(
            "`points` is {:?} at {row}: finite numbers are needed",
            points[row]
        );
        return Err(Failure::argument(text));
    }
    let places = with_threads(threads(thread_count), || {
        smooth.project_all(&Parallel::new(), &points)
    });
    for (place, (face, weight)) in places.into_iter().zip(faces.iter_mut().zip(weights)) {
        let Some(place) = place else {
            let text = "the mesh has no triangles, and the surface no points";
            return Err(Failure::new(Status::Undefined, text));
        };
        *face = place.triangle as u32;
        *weight = place.barycentric.map(N::nearest);
    }
    Ok(())
}

twins! {
    /// The places of the mesh over which a smooth surface is nearest to points, `count` rows of three, on up to
    /// `threads` threads, 0 for all: sets `faces`, `count` triangles, and `weights`, `count` rows with the weights of
    /// their corners.
    fn hf_surface_project, hf_surface_project_f32<$N>(
        surface: *const SmoothSurface, points: *const [$N; 3], count: usize, threads: usize, faces: *mut u32,
        weights: *mut [$N; 3],
    ) |call| project(call, surface, (points, count), threads, faces, weights)
}

/// A field at the vertices, places, and arrays for the values there and their error bars.
struct FieldArrays<N> {
    field: *const [N; 1],
    vertex_count: usize,
    places: (*const u32, *const [N; 3]),
    count: usize,
    values: *mut N,
    errors: *mut N,
}

fn interpolate<N: Number>(
    call: &mut Call,
    surface: *const SmoothSurface,
    arrays: FieldArrays<N>,
    thread_count: usize,
) -> Outcome {
    let smooth = &call.object("surface", surface)?.smooth;
    let (mesh, count) = (smooth.surface().mesh(), arrays.count);
    let field = call.field("field", arrays.field, arrays.vertex_count, mesh)?;
    let places = places(call, smooth, arrays.places, count)?;
    let values = call.write("values", arrays.values, count)?;
    let errors = call.write_if_wanted("errors", arrays.errors, count)?;
    let points = with_threads(threads(thread_count), || {
        let fitted = smooth.fields(&Parallel::new(), &[field.as_flattened()]);
        fitted.all_at(&Parallel::new(), 0, &places)
    });
    for (value, point) in values.iter_mut().zip(&points) {
        *value = N::nearest(point.value);
    }
    for (error, point) in errors.into_iter().flatten().zip(&points) {
        *error = N::nearest(point.error);
    }
    Ok(())
}

twins! {
    /// The values of a field at places of the mesh, as smooth as the surface, on up to `threads` threads, 0 for all.
    ///
    /// `field` has `vertex_count` numbers, one for each vertex; `faces` and `weights` are as for hf_surface_at. Sets
    /// `values`, and the error bars `errors` unless it is NULL: infinite where values are interpolated linearly for want
    /// of a fit.
    fn hf_surface_interpolate, hf_surface_interpolate_f32<$N>(
        surface: *const SmoothSurface, field: *const $N, vertex_count: usize, faces: *const u32,
        weights: *const [$N; 3], count: usize, threads: usize, values: *mut $N, errors: *mut $N,
    ) |call| interpolate(
        call,
        surface,
        FieldArrays { field: field.cast(), vertex_count, places: (faces, weights), count, values, errors },
        threads,
    )
}

/// A new mesh that is asked for.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Remeshing {
    /// The number of vertices, at least 4; 0 for those of the old mesh, or for as many as `edge` asks for.
    pub vertices: usize,
    /// The length of the edges; 0 for that which the number of vertices asks for.
    pub edge: f64,
    /// The angle in degrees, above 0, by which triangles differ at an edge that is kept as a crease: 60 suits most.
    pub creases: f64,
    /// Whether noise of the positions is removed first, unless it is 0.
    pub smooth: u32,
}

fn remesh<N: Number>(
    call: &mut Call,
    mesh: *const Mesh,
    (positions, count): (*const [N; 3], usize),
    remeshing: *const Remeshing,
    thread_count: usize,
    made: *mut *mut Mesh,
) -> Outcome {
    let mesh = &call.object("mesh", mesh)?.triangles;
    let positions = call.at_vertices("positions", positions, count, mesh)?;
    let surface = surface(mesh, &positions)?;
    let Remeshing {
        vertices,
        edge,
        creases,
        smooth,
    } = *call.object("remeshing", remeshing)?;
    if vertices > 0 && edge != 0.0 {
        let text =
            "`vertices` and `edge` are given together: one of them is needed, and 0 for the other";
        return Err(Failure::argument(text));
    }
    if (1..4).contains(&vertices) {
        let text = format!("`vertices` is {vertices}: at least 4 are needed, or 0");
        return Err(Failure::argument(text));
    }
    for (name, number, is_needed) in [("edge", edge, false), ("creases", creases, true)] {
        let is_given = number > 0.0 && number.is_finite();
        if !is_given && (is_needed || number != 0.0) {
            let text = format!("`{name}` is {number}: a finite number above 0 is needed");
            return Err(Failure::argument(text));
        }
    }
    let kinds = mesh.vertex_kinds().iter();
    let used = kinds.filter(|kind| **kind != VertexKind::Isolated).count();
    let wanted = if vertices > 0 { vertices } else { used };
    let (length, wanted) = match edge {
        0.0 => (1.0, Some(wanted)),
        edge => (edge, None),
    };
    let request = MeshRequest {
        lengths: EdgeLengths::Uniform(length),
        vertices: wanted,
        creases: creases.to_radians(),
        noise: OfNoise::removed_if(smooth != 0),
    };
    let found = with_threads(threads(thread_count), || {
        remeshed(surface, &request, &mut |_| true)
    });
    let found = found.map_err(|error| {
        let remedy = match error {
            RemeshError::Noise(_) => ": `smooth` removes it first",
            _ => "",
        };
        Failure::new(Status::Undefined, format!("{error}{remedy}"))
    })?;
    let positions = found.made.points.iter().map(|point| point.position);
    call.give(
        "made",
        made,
        Mesh::new(found.made.mesh, positions.collect()),
    )
}

twins! {
    /// Makes a mesh with even triangles of the smooth surface through the vertices, on up to `threads` threads, 0 for
    /// all. Borders and creases keep their curves.
    ///
    /// `positions` has `count` rows of three. On success `*made` is a new mesh, which hf_mesh_free frees, and
    /// hf_mesh_positions has its positions. Places of its vertices on the old mesh, where fields can be interpolated, are
    /// found by hf_surface_project. Fails with HF_STATUS_UNDEFINED if positions are noisy, or triangles would cross.
    fn hf_remesh, hf_remesh_f32<$N>(
        mesh: *const Mesh, positions: *const [$N; 3], count: usize, remeshing: *const Remeshing, threads: usize,
        made: *mut *mut Mesh,
    ) |call| remesh(call, mesh, (positions, count), remeshing, threads, made)
}
