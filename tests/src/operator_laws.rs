//! The laws of [`LaplaceBeltrami`], for any operator.

use crate::accuracy::surface;
use crate::{small_meshes, tolerance};
use helfrich::{Curvature, Finding, LaplaceBeltrami, Rows, Serial, Surface, TriangleMesh};
use helfrich_std::generate::{Family, generate};

/// What an operator makes of a surface: curvatures, and the Laplacian of a field.
struct Measured {
    curvature: Vec<Curvature<f64>>,
    laplacian: Vec<f64>,
    findings: Vec<Finding>,
}

fn measure<L: LaplaceBeltrami<f64>>(
    operator: &L,
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
    field: &[f64],
) -> Measured {
    let surface = Surface::new(mesh, positions).expect("finite positions");
    let plan = operator.plan(mesh);
    let mut memory = L::Memory::default();
    let mut curvature = vec![Curvature::default(); mesh.vertex_count()];
    operator.measure(&Serial, &plan, surface, &mut memory, &mut curvature);
    let mut laplacian = vec![0.0; mesh.vertex_count()];
    operator.apply_to_scalar(&Serial, &plan, surface, &memory, field, &mut laplacian);

    let mut rows = Rows::new();
    let mut by_rows = laplacian.clone();
    operator.assemble(&plan, surface, &memory, &mut rows);
    rows.apply_to_scalar(&Serial, field, &mut by_rows);
    assert_eq!(by_rows, laplacian, "the assembled rows are what is applied");

    let constant = vec![0.7; field.len()];
    operator.apply_to_scalar(&Serial, &plan, surface, &memory, &constant, &mut by_rows);
    assert!(by_rows.iter().all(|&value| value == 0.0));

    let mut findings = Vec::new();
    operator.inspect(&plan, surface, &memory, &mut |finding| {
        findings.push(finding)
    });
    Measured {
        curvature,
        laplacian,
        findings,
    }
}

fn some_field(positions: &[[f64; 3]]) -> Vec<f64> {
    let wave = |&[x, y, z]: &[f64; 3]| (1.3 * x - 0.4 * y).sin() + z * (x + 0.2);
    positions.iter().map(wave).collect()
}

/// Constants, rows, scale, rotation and translation, on a closed mesh.
///
/// # Panics
/// If a law is broken.
pub fn check_operator<L: LaplaceBeltrami<f64>>(operator: &L) {
    let shape = "ellipsoid".parse().expect("a shape");
    let made = generate(&shape, Family::Relaxed, 642, 0).expect("a mesh");
    let positions = surface(&made).positions();
    let field = some_field(positions);
    let here = measure(operator, &made.mesh, positions, &field);

    // By a power of two everything scales to the last bit, unless there is an absolute number
    // somewhere.
    for factor in [(-40.0_f64).exp2(), 40.0_f64.exp2()] {
        let scaled: Vec<_> = positions.iter().map(|x| x.map(|x| x * factor)).collect();
        let there = measure(operator, &made.mesh, &scaled, &field);
        for (here, there) in here.curvature.iter().zip(&there.curvature) {
            assert_eq!(here.normal, there.normal);
            assert_eq!(here.mean, there.mean * factor);
            assert_eq!(here.gaussian, there.gaussian * factor * factor);
        }
        for (here, there) in here.laplacian.iter().zip(&there.laplacian) {
            assert_eq!(*here, there * factor * factor);
        }
    }

    let turn = |[x, y, z]: [f64; 3]| {
        let (x, y) = (0.6 * x - 0.8 * y, 0.8 * x + 0.6 * y);
        let (y, z) = (0.28 * y - 0.96 * z, 0.96 * y + 0.28 * z);
        [x, y, z]
    };
    let moved = |x: &[f64; 3]| turn(*x).map(|x| x + 0.75);
    let moved: Vec<_> = positions.iter().map(moved).collect();
    let there = measure(operator, &made.mesh, &moved, &field);
    let tolerance = &tolerance::OPERATOR_MOTION;
    for (vertex, curvature) in here.curvature.iter().enumerate() {
        let turned = turn(curvature.normal);
        for (normal, turned) in there.curvature[vertex].normal.into_iter().zip(turned) {
            tolerance.assert(normal, turned, 1.0, "normal");
        }
        tolerance.assert(there.curvature[vertex].mean, curvature.mean, 1.0, "H");
        tolerance.assert(
            there.curvature[vertex].gaussian,
            curvature.gaussian,
            1.0,
            "K",
        );
        let (found, expected) = (there.laplacian[vertex], here.laplacian[vertex]);
        tolerance.assert(found, expected, 10.0, "Laplacian");
    }
}

/// Finite values on tiny meshes and meshes with boundary; returns the findings on each.
///
/// # Panics
/// If a value is not finite.
pub fn check_small_meshes<L: LaplaceBeltrami<f64>>(
    operator: &L,
) -> Vec<(&'static str, Vec<Finding>)> {
    let check = |(name, (mesh, positions)): (&'static str, small_meshes::Positioned)| {
        let field = some_field(&positions);
        let measured = measure(operator, &mesh, &positions, &field);
        for (vertex, curvature) in measured.curvature.iter().enumerate() {
            let numbers = [curvature.mean, curvature.gaussian, curvature.area];
            let finite = numbers.iter().chain(&curvature.normal);
            assert!(
                finite
                    .chain([&measured.laplacian[vertex]])
                    .all(|x| x.is_finite()),
                "{name}, vertex {vertex}: {curvature:?}"
            );
        }
        (name, measured.findings)
    };
    small_meshes::all().into_iter().map(check).collect()
}
