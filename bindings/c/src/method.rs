//! Methods by name: curvatures and force densities at every vertex.

use crate::call::{Call, free, guarded, surface};
use crate::membrane::threads;
use crate::mesh::Mesh;
use crate::number::Number;
use crate::status::{Error, Failure, Outcome, Status};
use helfrich::{DualArea, Finding, GompperKroll, Quality, TriangleMesh};
use helfrich_std::execute::Parallel;
use helfrich_std::method::{BendingMethod, Evaluator, MethodOptions};
use std::ffi::c_char;
use std::sync::Arc;

/// A bending method, or an operator for curvatures, on one mesh. One thread at a time may use it.
#[derive(Debug)]
pub struct Method {
    evaluator: Evaluator<f64>,
    mesh: Arc<TriangleMesh>,
}

/// Bit of a vertex's flags beside those of findings: H is not defined there, and set to 0.
pub const NO_MEAN: u32 = 1 << 24;
/// As HF_NO_MEAN, for K.
pub const NO_GAUSSIAN: u32 = 1 << 25;
/// As HF_NO_MEAN, for Δ_S H.
pub const NO_LAPLACIAN: u32 = 1 << 26;
/// As HF_NO_MEAN, for the force density.
pub const NO_DENSITY: u32 = 1 << 27;

/// Kinds of findings have the bits below.
const _: () = assert!(Finding::KINDS.len() <= NO_MEAN.trailing_zeros() as usize);

/// Arrays of the caller for results at vertices: `count` entries each, or NULL where a result is not wanted.
/// Values that are not defined are 0, and flagged.
#[derive(Debug)]
#[repr(C)]
pub struct Fields<N> {
    /// Mixed area of the vertex, length².
    pub area: *mut N,
    /// Outward unit normal; 0 where it is not defined.
    pub normal: *mut [N; 3],
    /// Mean curvature H = (k1 + k2)/2, 1/length, positive on a sphere.
    pub mean: *mut N,
    /// Gaussian curvature K = k1 k2, 1/length².
    pub gaussian: *mut N,
    /// Δ_S H, 1/length³.
    pub laplacian_of_mean: *mut N,
    /// Force density, force per area; for methods with nodal forces, these over the mixed area.
    pub force_density: *mut [N; 3],
    /// Kinds of findings that concern the vertex, by the bits of hf_flag_name, and HF_NO_MEAN and others.
    pub flags: *mut u32,
}

impl Method {
    fn new(
        mesh: &Arc<TriangleMesh>,
        name: &str,
        options: MethodOptions,
        [modulus, curvature]: [f64; 2],
        threads: Parallel,
    ) -> Result<Self, Failure> {
        let method: BendingMethod = name.parse().map_err(Failure::argument)?;
        options.check(method).map_err(Failure::argument)?;
        if modulus <= 0.0 || modulus.is_nan() {
            let text = format!("`modulus` is {modulus}: a number above 0 is needed");
            return Err(Failure::argument(text));
        }
        // The same limits apply to every method.
        let limits = GompperKroll {
            modulus: modulus.into(),
            spontaneous_curvature: curvature.into(),
            area: DualArea::default(),
        };
        helfrich::Method::<f64>::check(&limits).map_err(Failure::argument)?;
        let flat = method == BendingMethod::KantorNelson || !method.has_force();
        if flat && curvature != 0.0 {
            let text =
                format!("{method} has no spontaneous curvature: 0 is needed, or another method");
            return Err(Failure::argument(text));
        }
        let evaluator = if method.has_force() {
            let material = [modulus.into(), curvature.into()];
            Evaluator::with_material(method, &options, material, mesh, threads)
                .map_err(Failure::argument)?
        } else {
            Evaluator::with_options(method, &options, modulus, mesh, threads)
        };
        Ok(Self {
            evaluator,
            mesh: Arc::clone(mesh),
        })
    }
}

fn options(
    call: &mut Call,
    areas: *const c_char,
    bandwidth: *const c_char,
) -> Result<MethodOptions, Failure> {
    let mut options = MethodOptions::default();
    if !areas.is_null() {
        let parsed = MethodOptions::parse_areas(call.text("areas", areas)?);
        options.areas = Some(parsed.map_err(Failure::argument)?);
    }
    if !bandwidth.is_null() {
        let parsed = MethodOptions::parse_bandwidth(call.text("bandwidth", bandwidth)?);
        options.bandwidth = Some(parsed.map_err(Failure::argument)?);
    }
    Ok(options)
}

/// Prepares a method for a mesh.
///
/// `name` is one of those that hf_method_name lists. `areas` are "mixed", "voronoi" or "barycentric", for
/// gompper-kroll and meyer; `bandwidth` is a number of mean vertex areas, "converging" or "published", for
/// belkin; NULL is the default of either. `modulus` is the bending modulus κ, an energy above 0, of which
/// kantor-nelson makes the modulus k̃ = 2κ/√3 of an edge: its forces are those of κ. `spontaneous_curvature` is H0,
/// 1/length, positive on a sphere. Evaluations run on up to `threads` threads, 0 for all; no result depends on their
/// number. On success `*method` is a new method, which hf_method_free frees.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_method_new(
    mesh: *const Mesh,
    name: *const c_char,
    areas: *const c_char,
    bandwidth: *const c_char,
    modulus: f64,
    spontaneous_curvature: f64,
    threads: usize,
    method: *mut *mut Method,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps the contract of this library.
    unsafe {
        guarded(error, |call| {
            let mesh = &call.object("mesh", mesh)?.triangles;
            let name = call.text("name", name)?;
            let options = options(call, areas, bandwidth)?;
            let threads = Parallel {
                threads: self::threads(threads),
            };
            let made = Method::new(
                mesh,
                name,
                options,
                [modulus, spontaneous_curvature],
                threads,
            )?;
            call.give("method", method, made)
        })
    }
}

/// Frees a method; NULL is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hf_method_free(method: *mut Method) {
    // SAFETY: the caller keeps the contract of this library.
    unsafe { free(method) }
}

fn set<N: Copy, V: Copy>(place: Option<&mut [N]>, values: &[V], number: impl Fn(V) -> N) {
    if let Some(place) = place {
        for (place, &value) in place.iter_mut().zip(values) {
            *place = number(value);
        }
    }
}

fn fields<N: Number>(
    call: &mut Call,
    method: *mut Method,
    positions: *const [N; 3],
    count: usize,
    fields: *const Fields<N>,
) -> Outcome {
    let method = call.object_mut("method", method)?;
    let positions = call.at_vertices("positions", positions, count, &method.mesh)?;
    let surface = surface(&method.mesh, &positions)?;
    let wanted = call.object("fields", fields)?;
    let area = call.write_if_wanted("area", wanted.area, count)?;
    let normal = call.write_if_wanted("normal", wanted.normal, count)?;
    let mean = call.write_if_wanted("mean", wanted.mean, count)?;
    let gaussian = call.write_if_wanted("gaussian", wanted.gaussian, count)?;
    let laplacian = call.write_if_wanted("laplacian_of_mean", wanted.laplacian_of_mean, count)?;
    let density = call.write_if_wanted("force_density", wanted.force_density, count)?;
    let flags = call.write_if_wanted("flags", wanted.flags, count)?;

    let (results, findings) = method.evaluator.fields_and_findings(surface);
    let vector = |value: [f64; 3]| value.map(N::nearest);
    let number = |value: Option<f64>| N::nearest(value.unwrap_or(0.0));
    set(area, &results.area, N::nearest);
    set(normal, &results.normal, vector);
    set(mean, &results.mean, number);
    set(gaussian, &results.gaussian, number);
    set(laplacian, &results.laplacian_of_mean, number);
    set(density, &results.force_density, |value| {
        vector(value.unwrap_or_default())
    });
    if let Some(flags) = flags {
        let found = |report: &mut dyn FnMut(Finding)| findings.iter().for_each(|it| report(*it));
        let quality = Quality::gather(&method.mesh, found);
        for (vertex, (flag, kinds)) in flags.iter_mut().zip(quality.flags()).enumerate() {
            let undefined = [
                (results.mean[vertex].is_none(), NO_MEAN),
                (results.gaussian[vertex].is_none(), NO_GAUSSIAN),
                (results.laplacian_of_mean[vertex].is_none(), NO_LAPLACIAN),
                (results.force_density[vertex].is_none(), NO_DENSITY),
            ];
            let undefined = undefined.iter().filter(|(is_none, _)| *is_none);
            *flag = undefined.fold(*kinds, |bits, (_, bit)| bits | bit);
        }
    }
    Ok(())
}

twins! {
    /// Evaluates a method at positions, `count` rows of three, and sets the arrays of `fields`.
    fn hf_method_fields, hf_method_fields_f32<$N>(
        method: *mut Method, positions: *const [$N; 3], count: usize, fields: *const Fields<$N>,
    ) |call| self::fields(call, method, positions, count, fields)
}
