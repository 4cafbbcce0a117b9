//! Time of the kernels beside naive versions of them: `cargo bench -p helfrich-std --bench kernels`,
//! with numbers of vertices (10·4^k + 2) as arguments after `--`.
//!
//! All columns of a row are measured in turn, again and again, and what is printed are medians: on
//! a machine with other work only ratios within a row mean anything.
#![expect(clippy::print_stdout, reason = "the table is what it is for")]

use helfrich::{
    Conservative, ForceDensity, GompperKroll, InPlane, Juelicher, KantorNelson, Method, NeoHookean,
    Prepared, Real, StrongForm, Surface, TriangleMesh,
};
use helfrich_std::execute::Parallel;
use helfrich_std::generate::{Family, generate};
use num_traits::Float;
use std::hint::black_box;
use std::num::NonZeroUsize;
use std::time::Instant;

type Error = Box<dyn std::error::Error>;

/// Rounds, in each of which every column has its turn.
const ROUNDS: usize = 15;

fn main() -> Result<(), Error> {
    let sizes: Vec<usize> = std::env::args()
        .skip(1)
        .flat_map(|text| text.parse())
        .collect();
    let sizes = if sizes.is_empty() {
        vec![2562, 40962]
    } else {
        sizes
    };
    println!("ns a vertex, medians of {ROUNDS} rounds; n/s: naive over serial, and so on");
    println!(
        "{:24}{:>8}{:>9}{:>9}{:>9}{:>9}{:>7}{:>7}{:>7}",
        "kernel", "N", "naive", "serial", "wide", "2 thr.", "n/w", "s/w", "w/2"
    );
    for vertices in sizes {
        let generated = generate(&"discocyte".parse()?, Family::Smooth, vertices, 1)?;
        rows::<f64>("f64", &generated.mesh, &generated.positions)?;
        rows::<f32>("f32", &generated.mesh, &generated.positions)?;
    }
    Ok(())
}

fn rows<T: Real>(scalar: &str, mesh: &TriangleMesh, positions: &[[f64; 3]]) -> Result<(), Error> {
    let positions: Vec<[T; 3]> = positions.iter().map(|x| x.map(T::constant)).collect();
    let surface = Surface::new(mesh, &positions)?;
    let rings = naive::Rings::new(mesh);
    let mut force = vec![[T::zero(); 3]; positions.len()];
    let one = T::one();
    naive::squared_laplacian(&rings, &positions, &mut force);
    check_naive(surface, &force)?;
    conservative(
        &format!("B {scalar}"),
        surface,
        || GompperKroll::new(one),
        Some(&mut || {
            naive::squared_laplacian(&rings, &positions, &mut force);
        }),
    );
    conservative(
        &format!("A {scalar}"),
        surface,
        || KantorNelson::new(one),
        None,
    );
    conservative(
        &format!("Jülicher {scalar}"),
        surface,
        || Juelicher::new(one),
        None,
    );
    let law = NeoHookean { shear_modulus: one };
    let in_plane = InPlane::new(law, mesh, surface)?;
    conservative(
        &format!("neo-Hookean {scalar}"),
        surface,
        || in_plane.clone(),
        None,
    );
    density(&format!("C {scalar}"), surface, || StrongForm::meyer(one));
    density(&format!("E {scalar}"), surface, || StrongForm::farutin(one));
    density(&format!("J4 {scalar}"), surface, || StrongForm::j4(one));
    density(&format!("J6 {scalar}"), surface, || StrongForm::j6(one));
    Ok(())
}

/// The naive version computes the same.
fn check_naive<T: Real>(surface: Surface<'_, T>, force: &[[T; 3]]) -> Result<(), Error> {
    let mut known = vec![[T::zero(); 3]; force.len()];
    Prepared::new(GompperKroll::new(T::one()), surface.mesh()).add_force(surface, &mut known);
    let pairs = || force.as_flattened().iter().zip(known.as_flattened());
    let largest = pairs().fold(T::zero(), |most, (_, known)| most.max(known.abs()));
    let error = pairs().fold(T::zero(), |most, (&a, &b)| most.max((a - b).abs()));
    if error > T::epsilon().sqrt() * largest {
        return Err(format!("the naive version of B is {error:?} off, of {largest:?}").into());
    }
    Ok(())
}

fn threads(count: usize) -> Parallel {
    Parallel {
        threads: NonZeroUsize::new(count).unwrap_or(NonZeroUsize::MIN),
    }
}

fn conservative<T: Real, M: Conservative<T>>(
    name: &str,
    surface: Surface<'_, T>,
    method: impl Fn() -> M,
    naive: Option<&mut dyn FnMut()>,
) {
    let mesh = surface.mesh();
    let mut force = vec![[T::zero(); 3]; mesh.vertex_count()];
    let [mut forces, mut others] = [force.clone(), force.clone()];
    let mut serial = Prepared::new(method(), mesh);
    let mut wide = Prepared::with_execution(method(), mesh, threads(1));
    let mut both = Prepared::with_execution(method(), mesh, threads(2));
    row(
        name,
        mesh.vertex_count(),
        naive,
        [
            &mut || _ = black_box(serial.add_force_and_energy(surface, &mut force)),
            &mut || _ = black_box(wide.add_force_and_energy(surface, &mut forces)),
            &mut || _ = black_box(both.add_force_and_energy(surface, &mut others)),
        ],
    );
}

fn density<T: Real, M: ForceDensity<T> + Method<T>>(
    name: &str,
    surface: Surface<'_, T>,
    method: impl Fn() -> M,
) {
    let mesh = surface.mesh();
    let mut force = vec![[T::zero(); 3]; mesh.vertex_count()];
    let [mut forces, mut others] = [force.clone(), force.clone()];
    let mut serial = Prepared::new(method(), mesh);
    let mut wide = Prepared::with_execution(method(), mesh, threads(1));
    let mut both = Prepared::with_execution(method(), mesh, threads(2));
    row(
        name,
        mesh.vertex_count(),
        None,
        [
            &mut || serial.force_density(surface, &mut force),
            &mut || wide.force_density(surface, &mut forces),
            &mut || both.force_density(surface, &mut others),
        ],
    );
}

/// Measures and prints a row.
fn row(
    name: &str,
    vertices: usize,
    naive: Option<&mut dyn FnMut()>,
    [serial, wide, both]: [&mut dyn FnMut(); 3],
) {
    let mut nothing = || ();
    let compared = naive.is_some();
    let mut columns: [&mut dyn FnMut(); 4] = [naive.unwrap_or(&mut nothing), serial, wide, both];
    // Memory is taken at the first evaluation.
    columns.iter_mut().for_each(|column| column());
    let once = Instant::now();
    columns[1]();
    let repeats = (4e-3 / once.elapsed().as_secs_f64())
        .ceil()
        .clamp(1.0, 1000.0) as usize;
    let mut times = [const { Vec::new() }; 4];
    for _ in 0..ROUNDS {
        for (column, times) in columns.iter_mut().zip(&mut times) {
            let start = Instant::now();
            for _ in 0..repeats {
                column();
            }
            let each = start.elapsed().as_secs_f64() / repeats as f64;
            times.push(each * 1e9 / vertices as f64);
        }
    }
    let [naive, serial, wide, both] = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[ROUNDS / 2]
    });
    let or_dash = |value: f64, digits: usize| match compared {
        true => format!("{value:.digits$}"),
        false => "–".to_owned(),
    };
    println!(
        "{name:24}{vertices:>8}{:>9}{serial:>9.1}{wide:>9.1}{both:>9.1}{:>7}{:>7.2}{:>7.2}",
        or_dash(naive, 1),
        or_dash(naive / wide, 2),
        serial / wide,
        wide / both,
    );
}

/// What is written first: generic over the number, lists of lists, vertex after vertex, and a branch
/// wherever something might be missing.
mod naive {
    use super::{Float, TriangleMesh};

    pub(super) struct Rings {
        triangles: Vec<[usize; 3]>,
        /// The triangles around each vertex, and its place in each.
        around: Vec<Vec<(usize, usize)>>,
    }

    impl Rings {
        pub(super) fn new(mesh: &TriangleMesh) -> Self {
            let triangles: Vec<[usize; 3]> = mesh
                .triangles()
                .iter()
                .map(|t| t.map(|v| v as usize))
                .collect();
            let mut around = vec![Vec::new(); mesh.vertex_count()];
            for (t, triangle) in triangles.iter().enumerate() {
                for (corner, &vertex) in triangle.iter().enumerate() {
                    around[vertex].push((t, corner));
                }
            }
            Self { triangles, around }
        }
    }

    fn sub<T: Float>(a: [T; 3], b: [T; 3]) -> [T; 3] {
        [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
    }
    fn add<T: Float>(a: [T; 3], b: [T; 3]) -> [T; 3] {
        [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
    }
    fn scale<T: Float>(s: T, a: [T; 3]) -> [T; 3] {
        a.map(|x| s * x)
    }
    fn dot<T: Float>(a: [T; 3], b: [T; 3]) -> T {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }
    fn cross<T: Float>(a: [T; 3], b: [T; 3]) -> [T; 3] {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    }

    /// cot of the angle between a and b.
    fn cotangent<T: Float>(a: [T; 3], b: [T; 3]) -> T {
        let normal = cross(a, b);
        let area = dot(normal, normal).sqrt();
        if area > T::zero() {
            dot(a, b) / area
        } else {
            T::zero()
        }
    }

    /// Energy and exact gradient of method B with Voronoi areas and κ = 1: adds −∂E/∂x to `force`.
    pub(super) fn squared_laplacian<T: Float>(
        rings: &Rings,
        positions: &[[T; 3]],
        force: &mut [[T; 3]],
    ) -> T {
        let number = |value: f64| T::from(value).unwrap_or_else(T::nan);
        let (half, quarter, eighth) = (number(0.5), number(0.25), number(0.125));
        let corners =
            |t: usize, corner: usize| [0, 1, 2].map(|k| rings.triangles[t][(corner + k) % 3]);
        let mut energy = T::zero();
        let mut weights = Vec::new();
        for (i, around) in rings.around.iter().enumerate() {
            let (mut gradient, mut area) = ([T::zero(); 3], T::zero());
            for &(t, corner) in around {
                let [_, j, k] = corners(t, corner);
                let (x, y, z) = (positions[i], positions[j], positions[k]);
                let at_j = cotangent(sub(x, y), sub(z, y));
                let at_k = cotangent(sub(x, z), sub(y, z));
                gradient = add(gradient, scale(half * at_k, sub(x, y)));
                gradient = add(gradient, scale(half * at_j, sub(x, z)));
                area = area + eighth * at_k * dot(sub(x, y), sub(x, y));
                area = area + eighth * at_j * dot(sub(x, z), sub(x, z));
            }
            if area == T::zero() {
                weights.push(([T::zero(); 3], T::zero()));
                continue;
            }
            let squared = dot(gradient, gradient) / area;
            energy = energy + half * squared;
            weights.push((scale(area.recip(), gradient), half * squared / area));
        }
        for (i, around) in rings.around.iter().enumerate() {
            for &(t, corner) in around {
                let triangle = corners(t, corner);
                // Each edge with what its cotangent is multiplied by.
                for opposite in 0..3 {
                    let k = triangle[opposite];
                    let (p, q) = (triangle[(opposite + 1) % 3], triangle[(opposite + 2) % 3]);
                    let (a, b) = (
                        sub(positions[p], positions[k]),
                        sub(positions[q], positions[k]),
                    );
                    let normal = cross(a, b);
                    let area = dot(normal, normal).sqrt();
                    if area == T::zero() {
                        continue;
                    }
                    let unit = scale(area.recip(), normal);
                    let along = dot(a, b);
                    let edge = sub(a, b);
                    let (turn, sum) =
                        (sub(weights[p].0, weights[q].0), weights[p].1 + weights[q].1);
                    let factor = half * dot(turn, edge) - eighth * sum * dot(edge, edge);
                    let slope = sub(scale(half, turn), scale(quarter * sum, edge));
                    let over = along / (area * area);
                    let by_a = sub(scale(area.recip(), b), scale(over, cross(b, unit)));
                    let by_b = sub(scale(area.recip(), a), scale(over, cross(unit, a)));
                    let change = if p == i {
                        add(scale(factor, by_a), scale(along / area, slope))
                    } else if q == i {
                        sub(scale(factor, by_b), scale(along / area, slope))
                    } else {
                        scale(-factor, add(by_a, by_b))
                    };
                    force[i] = sub(force[i], change);
                }
            }
        }
        energy
    }
}
