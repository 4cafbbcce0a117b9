//! One thread and two give the same bits.

use super::{Bound, Group, Outcome, Row, StabilityError};
use helfrich::Surface;
use helfrich::shapes::{Ellipsoid, Sphere};
use helfrich_std::dynamics::integrate::{Integrator, Scheme, Settings};
use helfrich_std::execute::Parallel;
use helfrich_std::flow::lattice_boltzmann::{Lattice, Node, Precision, Setup, Sides};
use helfrich_std::flow::{Ambient, DoubleLayer, Moving, SingleLayer, Suspension};
use helfrich_std::generate::{AnyShape, Family, GeneratedMesh, generate};
use helfrich_std::method::{BendingMethod, Evaluator, MethodOptions};
use helfrich_std::scalar::Scalar;
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_std::simulation::build;
use std::error::Error;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;

/// Numbers of threads that are compared.
const THREADS: [NonZeroUsize; 2] = [NonZeroUsize::MIN, NonZeroUsize::MIN.saturating_add(1)];

type Made = Result<Vec<u64>, Box<dyn Error + Send + Sync>>;

/// A computation: name, meaning, subject, number type, and a function that returns the bits of the result.
type Case = (
    &'static str,
    &'static str,
    &'static str,
    Scalar,
    fn(NonZeroUsize) -> Made,
);

const CASES: [Case; 5] = [
    (
        "boundary integrals",
        "Velocity and pressure at the vertices of a sphere and at points around it.",
        "single layer",
        Scalar::F64,
        single_layer,
    ),
    (
        "boundary integrals",
        "Velocity and pressure at the vertices of a sphere and at points around it.",
        "double layer",
        Scalar::F64,
        double_layer,
    ),
    (
        "lattice",
        "Populations after twenty steps between walls.",
        "populations",
        Scalar::F32,
        lattice::<f32>,
    ),
    (
        "lattice",
        "Populations after twenty steps between walls.",
        "populations",
        Scalar::F64,
        lattice::<f64>,
    ),
    (
        "a capsule in flow",
        "Positions after γ̇t = 0.2, with adaptive steps and another fluid inside.",
        "positions",
        Scalar::F64,
        capsule,
    ),
];

pub(super) fn rows() -> Result<Vec<Row>, StabilityError> {
    let mut rows = Vec::new();
    let case = "bending methods";
    for method in BendingMethod::ALL {
        let [one, two] = THREADS.map(|threads| forces(method, threads));
        let error = |source| StabilityError { case, source };
        rows.push(row(
            case,
            "Forces on an ellipsoid of 6252 vertices, enough for two threads.",
            method.name(),
            Scalar::F64,
            [one.map_err(error)?, two.map_err(error)?],
        ));
    }
    for (case, meaning, subject, scalar, bits) in CASES {
        let error = |source| StabilityError { case, source };
        let [one, two] = THREADS.map(bits);
        let (one, two) = (one.map_err(error)?, two.map_err(error)?);
        rows.push(row(case, meaning, subject, scalar, [one, two]));
    }
    Ok(rows)
}

/// Makes a row with the number of entries in which two results differ.
fn row(
    case: &'static str,
    meaning: &'static str,
    subject: &'static str,
    scalar: Scalar,
    [one, two]: [Vec<u64>; 2],
) -> Row {
    let different = one.iter().zip(&two).filter(|(one, two)| one != two);
    let count = if one.len() == two.len() && !one.is_empty() {
        different.count() as f64
    } else {
        f64::NAN
    };
    Row::new(
        Group::Threads,
        (case, meaning),
        (subject, scalar),
        Outcome::Measured(count),
        Bound::AtMost(0.0),
    )
}

/// Nodal forces or force densities.
fn forces(method: BendingMethod, threads: NonZeroUsize) -> Made {
    let shape = AnyShape::Ellipsoid(Ellipsoid::new([1.0, 0.8, 0.6])?);
    let GeneratedMesh {
        mesh, positions, ..
    } = generate(&shape, Family::Regular, 6252, 1)?;
    let threads = Parallel { threads };
    let mut evaluator =
        Evaluator::with_options(method, &MethodOptions::default(), 1.0, &mesh, threads);
    evaluator.evaluate(Surface::new(&mesh, &positions)?);
    Ok(bits(evaluator.force()))
}

fn bits<'a>(values: impl IntoIterator<Item = &'a [f64; 3]>) -> Vec<u64> {
    let values = values.into_iter().flatten();
    values.map(|value| value.to_bits()).collect()
}

fn sphere() -> Result<GeneratedMesh, Box<dyn Error + Send + Sync>> {
    let shape = AnyShape::Sphere(Sphere::new(1.0)?);
    Ok(generate(&shape, Family::Irregular, 642, 3)?)
}

/// A field of vectors on a surface.
fn field(positions: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let vector = |&[x, y, z]: &[f64; 3]| [x * y + 0.3, z - x * x, y * z * z + x];
    positions.iter().map(vector).collect()
}

/// Points near a surface and far from it.
fn points(positions: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let every = positions.iter().step_by(3).enumerate();
    every
        .map(|(k, x)| x.map(|x| x * (0.5 + 0.01 * k as f64)))
        .collect()
}

fn single_layer(threads: NonZeroUsize) -> Made {
    let GeneratedMesh {
        mesh, positions, ..
    } = sphere()?;
    let mut layer = SingleLayer::new([&mesh], 0.7, threads);
    layer.set_forces(&positions, &field(&positions));
    let mut velocity = vec![[0.0; 3]; positions.len()];
    layer.add_at_vertices(&mut velocity);
    let points = points(&positions);
    let mut around = vec![[0.0; 3]; points.len()];
    layer.add_at_points(&points, &mut around);
    let mut pressure = vec![0.0; points.len()];
    layer.add_pressure_at_points(&points, &mut pressure);
    let mut all = bits(velocity.iter().chain(&around));
    all.extend(pressure.into_iter().map(f64::to_bits));
    Ok(all)
}

fn double_layer(threads: NonZeroUsize) -> Made {
    let GeneratedMesh {
        mesh, positions, ..
    } = sphere()?;
    let mut layer = DoubleLayer::new([&mesh], &[5.0], threads);
    layer.set_positions(&positions);
    layer.set_velocities(&field(&positions));
    let mut velocity = vec![[0.0; 3]; positions.len()];
    layer.add_at_vertices(&mut velocity);
    let points = points(&positions);
    let mut around = vec![[0.0; 3]; points.len()];
    layer.add_at_points(&points, &mut around);
    let mut pressure = vec![0.0; points.len()];
    layer.add_pressure_at_points(0.7, &points, &mut pressure);
    let mut all = bits(velocity.iter().chain(&around));
    all.extend(pressure.into_iter().map(f64::to_bits));
    Ok(all)
}

fn lattice<T: Precision>(threads: NonZeroUsize) -> Made {
    let cells = [19, 14, 11];
    let walls = Sides::Walls {
        low: [0.0; 3],
        high: [0.03, 0.0, 0.01],
    };
    let mut lattice = Lattice::<T>::new(Setup {
        cells,
        sides: [Sides::Periodic, walls, Sides::Periodic],
        viscosity: 0.1,
        inertia: true,
        threads,
    })?;
    lattice.fill(|[i, j, k]| {
        let [x, y, z] = [i, j, k].map(|index| index as f64);
        Node {
            density: 1.0 + 0.01 * (0.7 * x + 0.3 * y).sin(),
            velocity: [0.02 * y.sin(), 0.01 * (x + z).cos(), 0.015 * (x * y).sin()],
        }
    });
    lattice.advance(20);
    let mut all = Vec::new();
    for k in 0..cells[2] {
        for j in 0..cells[1] {
            for i in 0..cells[0] {
                let node = lattice.node([i, j, k]);
                all.push(node.density.to_bits());
                all.extend(node.velocity.map(f64::to_bits));
            }
        }
    }
    Ok(all)
}

/// A capsule with bending, and fluid five times as viscous inside.
const CAPSULE: &str = r#"
units = "none"
[[surface]]
shape = "sphere:1"
vertices = 162
elasticity = { law = "neo-hookean", shear_modulus = 1 }
bending = { method = "j4", modulus = 0.1 }
[driver]
kind = "boundary-integral"
viscosity = 1
flow = { kind = "shear", rate = 0.15 }
strain = 1
"#;

fn capsule(threads: NonZeroUsize) -> Made {
    let file = SceneFile::parse(CAPSULE, Path::new("scene.toml"), &Overrides::default())?;
    let (mut simulation, positions) = build(&file)?;
    let bodies = simulation.bodies().iter();
    let meshes = Vec::from_iter(bodies.map(|body| Arc::clone(body.shared_mesh())));
    let rate = 0.15;
    let shear = Some(Ambient::shear(rate));
    let mut suspension = Suspension::new(&meshes, 1.0, &[5.0], shear, threads);
    let mut moving = Moving {
        suspension: &mut suspension,
        membranes: &mut simulation,
    };
    let settings = Settings::new(Scheme::Rkc2, 1.0);
    let mut integrator = Integrator::new(positions, 0.0, settings)?;
    integrator.run(&mut moving, 0.2 / rate, |_, _| true)?;
    Ok(bits(integrator.positions()))
}
