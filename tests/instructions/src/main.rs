//! Evaluates one method a given number of times and does nothing else, so that `.ci/instructions` can count
//! its instructions.
//!
//! ```console
//! cargo run --release -p helfrich-instructions -- B f64 3
//! ```

use helfrich::shapes::{Discocyte, Shape};
use helfrich::subdivision::{Subdivision, limit_positions};
use helfrich::{
    Bandwidth, Conservative, DualArea, ForceDensity, GompperKroll, HeatKernel, InPlane, Juelicher,
    KantorNelson, LoopSubdivision, NeoHookean, Prepared, Real, Serial, Skalak, StrongForm, Surface,
    TriangleMesh,
};
use std::error::Error;
use std::hint::black_box;

/// Number of refinements of the icosahedron.
const LEVELS: u32 = 3;

/// A mesh with positions.
type Discus = (TriangleMesh, Vec<[f64; 3]>);

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [method, scalar, times] = arguments.as_slice() else {
        return Err("expected a method, f64 or f32, and how often".into());
    };
    let (mesh, positions) = discocyte()?;
    let times = times.parse()?;
    match scalar.as_str() {
        "f64" => evaluate::<f64>(method, &mesh, &positions, times),
        "f32" => evaluate::<f32>(method, &mesh, &positions, times),
        other => Err(format!("there is no number type {other}").into()),
    }
}

/// A discocyte by Loop subdivision of an icosahedron.
fn discocyte() -> Result<Discus, Box<dyn Error>> {
    let long = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut controls = Vec::new();
    for (a, b) in [(1.0, long), (-1.0, long), (1.0, -long), (-1.0, -long)] {
        controls.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]]);
    }
    // The faces are the triples of vertices at the least mutual distance, 2.
    let near = |a: usize, b: usize| {
        let squared = |k: usize| (controls[a][k] - controls[b][k]).powi(2);
        squared(0) + squared(1) + squared(2) < 5.0
    };
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in (b + 1..12).filter(|&c| near(a, b) && near(b, c) && near(c, a)) {
                let [x, y, z] = [a, b, c].map(|vertex: usize| controls[vertex]);
                let volume: f64 = x[0] * (y[1] * z[2] - y[2] * z[1])
                    + x[1] * (y[2] * z[0] - y[0] * z[2])
                    + x[2] * (y[0] * z[1] - y[1] * z[0]);
                let [a, b, c] = [a, b, c].map(|vertex| vertex as u32);
                triangles.push(if volume > 0.0 { [a, b, c] } else { [a, c, b] });
            }
        }
    }
    let mut mesh = TriangleMesh::new(controls.len(), triangles)?;
    for _ in 0..LEVELS {
        let finer = Subdivision::new(&mesh, 1)?;
        controls = finer.refine(&controls);
        mesh = finer.into_mesh();
    }
    let mut limit = vec![[0.0; 3]; controls.len()];
    limit_positions(&mesh).apply(&Serial, &controls, &mut limit);
    let shape = Discocyte::new(1.0)?;
    let on_shape = |point: &[f64; 3]| {
        let length = point.iter().map(|x| x * x).sum::<f64>().sqrt();
        shape.at(point.map(|x| x / length)).position
    };
    Ok((mesh, limit.iter().map(on_shape).collect()))
}

fn evaluate<T: Real>(
    method: &str,
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
    times: usize,
) -> Result<(), Box<dyn Error>> {
    let positions: Vec<[T; 3]> = positions.iter().map(|x| x.map(T::constant)).collect();
    let surface = Surface::new(mesh, &positions)?;
    let one = T::one();
    match method {
        "A" => conservative(KantorNelson::new(one), surface, times),
        "B" => {
            // Voronoi areas, as published, so that counts remain comparable over the years.
            let method = GompperKroll::with_areas(one, DualArea::Voronoi);
            conservative(method, surface, times);
        }
        "S" => conservative(LoopSubdivision::new(one), surface, times),
        "Juelicher" => conservative(Juelicher::new(one), surface, times),
        "C" => density(StrongForm::meyer(one), surface, times),
        "D" => {
            let operator = HeatKernel::new(Bandwidth::MixedArea(one));
            density(StrongForm::new(one, operator), surface, times);
        }
        "E" => density(StrongForm::farutin(one), surface, times),
        "J4" => density(StrongForm::j4(one), surface, times),
        "J6" => density(StrongForm::j6(one), surface, times),
        "neo-Hookean" => {
            let law = NeoHookean { shear_modulus: one };
            conservative(InPlane::new(law, mesh, surface)?, surface, times);
        }
        "Skalak" => {
            let law = Skalak {
                shear_modulus: one,
                area_ratio: T::constant(10.0),
            };
            conservative(InPlane::new(law, mesh, surface)?, surface, times);
        }
        other => return Err(format!("there is no method {other}").into()),
    }
    Ok(())
}

fn conservative<T: Real, M: Conservative<T>>(method: M, surface: Surface<'_, T>, times: usize) {
    let mut prepared = Prepared::new(method, surface.mesh());
    let mut force = vec![[T::zero(); 3]; surface.positions().len()];
    for _ in 0..times {
        black_box(prepared.add_force_and_energy(black_box(surface), &mut force));
    }
}

fn density<T: Real, M: ForceDensity<T>>(method: M, surface: Surface<'_, T>, times: usize) {
    let mut prepared = Prepared::new(method, surface.mesh());
    let mut force = vec![[T::zero(); 3]; surface.positions().len()];
    for _ in 0..times {
        prepared.force_density(black_box(surface), &mut force);
    }
    black_box(&force);
}
