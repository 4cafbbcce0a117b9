//! Meshes inscribed in a sphere, with exact results.

mod effects;

use alloc::vec;
use alloc::vec::Vec;
use core::fmt::Display;
use glam::{DVec3, Vec3};
use helfrich::{
    Conservative, Cotangent, Curvature, Curvatures, DualArea, Finding, GompperKroll, KantorNelson,
    LaplaceBeltrami, Method, Points, Prepared, Real, Rows, Serial, StrongForm, Surface,
    TriangleMesh,
};
use nalgebra::{Point3, Vector3};

/// κ.
const MODULUS: f64 = 1.5;
/// R.
const RADIUS: f64 = 2.5;

/// Runs all checks through every kind of points.
///
/// # Panics
/// If a result is wrong.
pub fn run() {
    for solid in [tetrahedron(), octahedron(), icosahedron()] {
        in_f64(&solid);
        in_f32(&solid);
    }
    // An inscribed solid without symmetry.
    let mut uneven = icosahedron();
    for [x, y, z] in &mut uneven.directions {
        [*x, *y, *z] = [*x + 0.1, 1.3 * *y, 0.7 * *z + 0.2 * *x];
    }
    uneven.expected = None;
    in_f64(&uneven);
    in_f32(&uneven);
    effects::run::<f64>();
    effects::run::<f32>();
}

/// A convex solid with its corners on a sphere.
struct Solid {
    directions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    /// Exact values, if the solid is regular.
    expected: Option<Expected>,
}

/// Exact values of a regular solid in the unit sphere.
#[derive(Clone, Copy)]
struct Expected {
    area: f64,
    /// Σ (1 − cos θ) over the edges, θ the angle between the normals of two faces.
    hinges: f64,
}

const SQRT_3: f64 = 1.732_050_807_568_877_2;
const SQRT_5: f64 = 2.236_067_977_499_79;

fn tetrahedron() -> Solid {
    Solid {
        directions: vec![
            [1.0; 3],
            [1.0, -1.0, -1.0],
            [-1.0, 1.0, -1.0],
            [-1.0, -1.0, 1.0],
        ],
        triangles: vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]],
        expected: Some(Expected {
            area: 8.0 / SQRT_3,
            hinges: 6.0 * (1.0 + 1.0 / 3.0),
        }),
    }
}

fn octahedron() -> Solid {
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let opposite = |direction: [f64; 3]| direction.map(|component| -component);
    Solid {
        directions: vec![x, y, z, opposite(x), opposite(y), opposite(z)],
        triangles: vec![
            [0, 1, 2],
            [1, 3, 2],
            [3, 4, 2],
            [4, 0, 2],
            [1, 0, 5],
            [3, 1, 5],
            [4, 3, 5],
            [0, 4, 5],
        ],
        expected: Some(Expected {
            area: 4.0 * SQRT_3,
            hinges: 12.0 * (1.0 - 1.0 / 3.0),
        }),
    }
}

fn icosahedron() -> Solid {
    let golden = (1.0 + SQRT_5) / 2.0;
    let mut directions = Vec::new();
    for [a, b] in [
        [1.0, golden],
        [-1.0, golden],
        [1.0, -golden],
        [-1.0, -golden],
    ] {
        directions.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]]);
    }
    // The faces are the triples of mutual neighbours, at distance 2, counterclockwise from outside.
    let neighbours = |i: usize, j: usize| (dot(directions[i], directions[j]) - golden).abs() < 0.1;
    let mut triangles = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if neighbours(i, j) && neighbours(j, k) && neighbours(k, i) {
                    let outward = dot(cross(directions[i], directions[j]), directions[k]) > 0.0;
                    let [i, j, k] = [i as u32, j as u32, k as u32];
                    triangles.push(if outward { [i, j, k] } else { [i, k, j] });
                }
            }
        }
    }
    Solid {
        directions,
        triangles,
        expected: Some(Expected {
            area: 40.0 * SQRT_3 / (5.0 + SQRT_5),
            hinges: 30.0 * (1.0 - SQRT_5 / 3.0),
        }),
    }
}

/// Corners of the solid on a sphere of this radius.
fn positions<T: Real>(solid: &Solid, radius: f64) -> Vec<[T; 3]> {
    let radius = T::constant(radius);
    let position = |direction: &[f64; 3]| {
        let direction = direction.map(T::constant);
        let scale = radius / dot(direction, direction).sqrt();
        direction.map(|component| scale * component)
    };
    solid.directions.iter().map(position).collect()
}

fn in_f64(solid: &Solid) {
    let arrays = positions::<f64>(solid, RADIUS);
    let results = check(solid, &arrays);
    let points: Vec<DVec3> = arrays.iter().map(|&point| point.into()).collect();
    assert!(
        check(solid, &points) == results,
        "DVec3 differs from [f64; 3]"
    );
    through_nalgebra(solid, &arrays, &results);
}

fn in_f32(solid: &Solid) {
    let arrays = positions::<f32>(solid, RADIUS);
    let results = check(solid, &arrays);
    let points: Vec<Vec3> = arrays.iter().map(|&point| point.into()).collect();
    assert!(
        check(solid, &points) == results,
        "Vec3 differs from [f32; 3]"
    );
    through_nalgebra(solid, &arrays, &results);
}

fn through_nalgebra<T: Real + Display + nalgebra::Scalar>(
    solid: &Solid,
    arrays: &[[T; 3]],
    results: &Results<T>,
) where
    Vec<Point3<T>>: Points<Scalar = T>,
    Vec<Vector3<T>>: Points<Scalar = T>,
{
    let points: Vec<Point3<T>> = arrays.iter().map(|&point| point.into()).collect();
    assert!(
        check(solid, &points) == *results,
        "Point3 differs from an array"
    );
    let vectors: Vec<Vector3<T>> = arrays.iter().map(|&point| point.into()).collect();
    assert!(
        check(solid, &vectors) == *results,
        "Vector3 differs from an array"
    );
}

/// Results that must be the same to the last bit through every kind of points.
#[derive(PartialEq)]
struct Results<T> {
    energies: [T; 2],
    forces: [Vec<[T; 3]>; 2],
    density: Vec<[T; 3]>,
    laplacian: Vec<[T; 3]>,
}

fn check<T, P>(solid: &Solid, points: &P) -> Results<T>
where
    T: Real + Display,
    P: Points<Scalar = T> + ?Sized,
{
    let mesh = match TriangleMesh::new(solid.directions.len(), solid.triangles.clone()) {
        Ok(mesh) => mesh,
        Err(error) => panic!("{error}"),
    };
    let surface = match Surface::new(&mesh, points) {
        Ok(surface) => surface,
        Err(error) => panic!("{error}"),
    };
    let modulus = T::constant(MODULUS);
    let [radius, area] = [RADIUS, surface.area().to_f64().unwrap_or(0.0)];
    if let Some(expected) = solid.expected {
        near(surface.area(), expected.area * radius * radius, "area");
    }

    let (energy_a, force_a) = conservative(KantorNelson::new(modulus), solid, surface);
    if let Some(expected) = solid.expected {
        let exact = 2.0 / SQRT_3 * MODULUS * expected.hinges;
        near(energy_a, exact, "the energy of A");
        vanishes(&force_a, "the force of A on a regular solid");
    }

    let gompper_kroll = GompperKroll::new(modulus);
    let (energy_b, force_b) = conservative(gompper_kroll.clone(), solid, surface);
    if solid.expected.is_some() {
        // Here L points along x: E = 2κ/R² Σ A.
        let exact = 2.0 * MODULUS * area / (radius * radius);
        near(energy_b, exact, "the energy of B");
        vanishes(&force_b, "the force of B on a regular solid");
    }
    // L·x/R = 2A/R at every vertex of an inscribed mesh, so that H along x/R is 1/R.
    let normals: Vec<[T; 3]> = surface
        .positions()
        .iter()
        .map(|point| point.map(|component| component / T::constant(radius)))
        .collect();
    let mut mean = vec![T::zero(); mesh.vertex_count()];
    let mut workspace = gompper_kroll.workspace(&mesh);
    gompper_kroll.mean_curvature_along(&Serial, surface, &mut workspace, &normals, &mut mean);
    for &mean in &mean {
        near(mean, 1.0 / radius, "the mean curvature of B");
    }

    Results {
        energies: [energy_a, energy_b],
        forces: [force_a, force_b],
        density: strong_form(solid, surface),
        laplacian: cotangent(surface),
    }
}

/// Checks the laws of a bending energy with its gradient; returns energy and forces.
fn conservative<T, M>(method: M, solid: &Solid, surface: Surface<'_, T>) -> (T, Vec<[T; 3]>)
where
    T: Real + Display,
    M: Conservative<T>,
{
    let mesh = surface.mesh();
    let mut prepared = Prepared::new(method, mesh);
    let mut force = vec![[T::zero(); 3]; mesh.vertex_count()];
    let energy = prepared.add_force_and_energy(surface, &mut force);
    prepared.inspect(surface, &mut |finding: Finding| match finding {
        // Some of the solids have three edges at a corner.
        Finding::UnusualValence { .. } => {}
        finding => panic!("nothing is wrong with this mesh, but {finding:?} was found"),
    });

    let mut net = [T::zero(); 3];
    let mut torque = [T::zero(); 3];
    for (&force, &position) in force.iter().zip(surface.positions()) {
        let moment = cross(position, force);
        for axis in 0..3 {
            net[axis] += force[axis];
            torque[axis] += moment[axis];
        }
    }
    vanishes(&[net], "the sum of all forces");
    vanishes(&[torque], "the torque of all forces");

    let larger = positions::<T>(solid, 4.0 * RADIUS);
    match Surface::new(mesh, &larger) {
        Ok(larger) => near(
            prepared.energy(larger),
            energy.to_f64().unwrap_or(0.0),
            "the energy of a larger copy",
        ),
        Err(error) => panic!("{error}"),
    }
    (energy, force)
}

/// Checks method C: Gauss–Bonnet, and H, K and f on regular solids.
fn strong_form<T: Real + Display>(solid: &Solid, surface: Surface<'_, T>) -> Vec<[T; 3]> {
    let mesh = surface.mesh();
    let mut prepared = Prepared::new(StrongForm::meyer(T::constant(MODULUS)), mesh);
    let mut density = vec![[T::zero(); 3]; mesh.vertex_count()];
    prepared.force_density(surface, &mut density);
    let curvature = prepared.memory().curvature();
    let total: T = curvature
        .iter()
        .map(|vertex| vertex.gaussian * vertex.area)
        .sum();
    near(total, 4.0 * core::f64::consts::PI, "∫ K dS");
    let Some(expected) = solid.expected else {
        return density;
    };
    let gaussian = 4.0 * core::f64::consts::PI / (expected.area * RADIUS * RADIUS);
    let exact = 4.0 * MODULUS / RADIUS * (1.0 / (RADIUS * RADIUS) - gaussian);
    for (vertex, &density) in curvature.iter().zip(&density) {
        near(vertex.mean, 1.0 / RADIUS, "the mean curvature of C");
        near(vertex.gaussian, gaussian, "the Gaussian curvature of C");
        near(dot(density, vertex.normal), exact, "the force density of C");
    }
    density
}

/// Checks the cotangent operator with Voronoi areas: `Δ_S x = −2 H n`, with H = 1/R along x/R.
fn cotangent<T: Real + Display>(surface: Surface<'_, T>) -> Vec<[T; 3]> {
    let mesh = surface.mesh();
    let operator = Cotangent::new(DualArea::Voronoi);
    let mut workspace = operator.workspace(mesh);
    let mut curvature = vec![Curvature::default(); mesh.vertex_count()];
    operator.curvatures(&Serial, surface, &mut workspace, &mut curvature);
    let mut laplacian = vec![[T::zero(); 3]; mesh.vertex_count()];
    let field = surface.positions();
    operator.apply(&Serial, surface, &workspace, field, &mut laplacian);
    let mut rows = Rows::new();
    operator.assemble(surface, &workspace, &mut rows);
    let mut product = vec![[T::zero(); 3]; mesh.vertex_count()];
    rows.apply(&Serial, field, &mut product);
    for (vertex, &position) in field.iter().enumerate() {
        let along = [&laplacian, &product].map(|field| dot(field[vertex], position));
        for along in along {
            near(along, -2.0, "Δ_S x · x on a sphere");
        }
    }
    laplacian
}

/// Checks a value to a few hundred roundings, relative to the expected one.
fn near<T: Real + Display>(found: T, expected: f64, what: &str) {
    let found_f64 = found.to_f64().unwrap_or(0.0);
    let error = (found_f64 - expected).abs() / expected.abs();
    let limit = 200.0 * T::epsilon().to_f64().unwrap_or(0.0);
    assert!(error <= limit, "{what} is {found}, not {expected}");
}

/// Checks that vectors vanish to a few hundred roundings of κ, the size of forces that do not cancel.
fn vanishes<T: Real + Display>(vectors: &[[T; 3]], what: &str) {
    let limit = T::constant(200.0 * MODULUS) * T::epsilon();
    for component in vectors.iter().flatten() {
        assert!(component.abs() <= limit, "{what} is not 0 but {component}");
    }
}

fn dot<T: Real>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
