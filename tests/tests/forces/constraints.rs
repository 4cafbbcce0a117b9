//! Energies of whole components, the exact correction and the projection onto constraints.

use helfrich::constraint::{Linear, PotentialOf};
use helfrich::{
    AnyFunctional, AreaDifference, Components, Constraint, ConstraintError, Constraints,
    Correction, EnclosedVolume, Functional, OsmoticPressure, PatchFunctional, Penalty, Prepared,
    Surface, SurfaceTension, Targets, TotalArea, TotalMeanCurvature,
};
use helfrich_tests::laws::{
    Balanced, ConservativeCandidate, ConservativeLaw, Finite, ForceIsDifference, ForceIsGradient,
    Invariant, Law, energy, forces, largest,
};
use helfrich_tests::meshes::{
    Mesh, SplitMix64, bent, cases, difference, dot, hemisphere, icosphere, norm, octahedron,
    rough_any, torus,
};
use helfrich_tests::potentials::for_each_potential;
use helfrich_tests::tolerance::{self, Tolerance};
use proptest::prelude::*;
use std::f64::consts::PI;

/// Energies on a sphere of 2562 vertices against those of the smooth sphere, relative.
const COARSE_SPHERE: Tolerance = Tolerance::new(
    2e-2,
    "M and A have second-order errors of 1.5e-3, five times as much relative to M − M0 for M0 = 0.8 M; \
     then squared",
);

/// |F/F0 − 1| after a correction of a body at 1e8 radii from the origin.
const CONSTRAINED_FAR: Tolerance =
    Tolerance::new(1e-7, "positions are rounded at 1e-8 of the radius there");

/// |F/F0 − 1| after a correction in f32.
const CONSTRAINED_SINGLE: Tolerance = Tolerance::new(5e-6, "as in f64, from a rounding of 6e-8");

/// Directions of a small step against those to first order.
const FIRST_ORDER: Tolerance = Tolerance::new(
    1e-5,
    "the step is 1e-6 of the size, and the cosine deviates from 1 in second order",
);

const ALL: [AnyFunctional; 3] = [
    AnyFunctional::Area,
    AnyFunctional::Volume,
    AnyFunctional::MeanCurvature,
];

struct AsConservative<L>(L);
impl<L: Law> ConservativeLaw for AsConservative<L> {
    fn check<C: ConservativeCandidate>(&mut self, candidate: C) {
        self.0.check(candidate);
    }
}

proptest! {
    #![proptest_config(cases(32))]

    #[test]
    fn forces_are_gradients(rough in rough_any(), seed in 0..1_000_000_u64) {
        let mesh = &rough.mesh();
        for_each_potential(&mut ForceIsGradient(mesh));
        for_each_potential(&mut ForceIsDifference(mesh));
        for_each_potential(&mut Balanced(mesh));
        for_each_potential(&mut AsConservative(Invariant { mesh, seed }));
    }
}

/// Two bodies, a patch and a vertex in no triangle.
fn several() -> Mesh {
    let (mut positions, mut triangles) = (vec![], vec![]);
    for (k, mesh) in [icosphere(2), torus(12, 8), hemisphere(2)]
        .iter()
        .enumerate()
    {
        let first = positions.len() as u32;
        let placed = |&x: &[f64; 3]| {
            let [x, y, z] = bent(x);
            [x + 4.0 * k as f64, 0.8 * y, z]
        };
        positions.extend(mesh.positions.iter().map(placed));
        let moved = |triangle: &[u32; 3]| triangle.map(|vertex| vertex + first);
        triangles.extend(mesh.connectivity.triangles().iter().map(moved));
    }
    Mesh::new(positions, triangles)
}

#[test]
fn degenerate_surfaces_give_finite_numbers() {
    for mesh in [
        icosphere(1).map(|_| [1.0, 2.0, 3.0]),
        icosphere(1).map(|[x, ..]| [x, 0.0, 0.0]),
        icosphere(1).map(|[x, y, _]| [x, y, 0.0]),
        several(),
    ] {
        for scale in [1e-12, 1.0, 1e12] {
            let mesh = mesh.map(|x| x.map(|x| scale * x));
            for_each_potential(&mut AsConservative(Finite(&mesh)));
        }
    }
}

/// Energies of the regular octahedron with edge √2 by hand: E = σA and E = −ΔpV with A = 4√3 and V = 4/3, a
/// penalty, and the area difference with M = 6√2 acos(1/3).
#[test]
fn energies_have_their_values() {
    let mesh = octahedron();
    let (connectivity, x) = (&mesh.connectivity, &mesh.positions);
    let (area, volume) = (4.0 * 3.0_f64.sqrt(), 4.0 / 3.0);
    let mean = 6.0 * 2.0_f64.sqrt() * (1.0_f64 / 3.0).acos();
    let check = |found: f64, expected: f64| {
        tolerance::SAME.assert(found, expected, expected.abs(), "E");
    };
    check(
        energy(SurfaceTension::new(3.0), connectivity, x),
        3.0 * area,
    );
    check(
        energy(OsmoticPressure::new(3.0), connectivity, x),
        -3.0 * volume,
    );
    let penalty = Penalty::new(TotalArea, 5.0, 6.0);
    let excess = area - 6.0;
    check(
        energy(penalty, connectivity, x),
        2.5 * excess * excess / 6.0,
    );
    let (thickness, free) = (0.01, 0.2);
    let bilayer = AreaDifference::new(7.0, free / (2.0 * thickness));
    let excess = 2.0 * thickness * mean - free;
    let expected = 3.5 * PI / (area * thickness * thickness) * excess * excess;
    check(energy(bilayer, connectivity, x), expected);
}

/// A sphere of radius R whose area difference is that of a sphere of radius R0:
/// E = 8π² κ̄ (1 − R0/R)².
#[test]
fn area_difference_of_spheres() {
    let mesh = icosphere(4);
    let bilayer = AreaDifference::new(2.0, 4.0 * PI * 0.8);
    let found = energy(bilayer, &mesh.connectivity, &mesh.positions);
    let expected = 16.0 * PI * PI * 0.2 * 0.2;
    COARSE_SPHERE.assert(found, expected, expected, "E");
}

/// F(s x) = s^p F(x), so that Σ x·∂F = p F by Euler's theorem, exactly.
#[test]
fn dilatation_does_the_work_of_euler() {
    fn check(functional: impl Functional<f64> + Copy, power: f64, mesh: &Mesh) {
        let potential = PotentialOf {
            functional,
            potential: Linear { slope: 1.0 },
        };
        let (connectivity, x) = (&mesh.connectivity, &mesh.positions);
        let force = forces(potential, connectivity, x);
        let work: f64 = x.iter().zip(&force).map(|(&x, &f)| -dot(x, f)).sum();
        let value = energy(potential, connectivity, x);
        tolerance::SAME.assert(work, power * value, value.abs(), "Σ x·∂F");
    }
    for mesh in [icosphere(3).map(bent), torus(20, 10).map(bent)] {
        check(TotalArea, 2.0, &mesh);
        check(EnclosedVolume, 3.0, &mesh);
        check(TotalMeanCurvature, 1.0, &mesh);
    }
}

/// Δp = 2σ/R: tension and pressure balance on a sphere. The work of the residual force along smooth fields is
/// of second order in the edge length; along displacements of single vertices it is not, because triangles
/// rotate.
#[test]
fn sphere_under_tension_obeys_laplace() {
    let (radius, sigma) = (2.5, 3.0);
    let unbalanced = |refinement, field: fn([f64; 3]) -> [f64; 3]| {
        let mesh = icosphere(refinement).map(|x| x.map(|x| radius * x));
        let tension = SurfaceTension::new(sigma);
        let pressure = OsmoticPressure::new(2.0 * sigma / radius);
        let (connectivity, x) = (&mesh.connectivity, &mesh.positions);
        let both = forces((tension, pressure), connectivity, x);
        let one = forces(tension, connectivity, x);
        let work = |force: &[[f64; 3]]| -> f64 {
            let work = |(&f, &x): (&[f64; 3], &[f64; 3])| dot(f, field(x));
            force.iter().zip(x).map(work).sum()
        };
        work(&both) / work(&one)
    };
    let fields: [fn([f64; 3]) -> [f64; 3]; 3] = [
        |x| x,
        |[x, y, z]| [x + y * z, 2.0 * y, x * x - z],
        |[x, y, z]| [x.sin(), y * x.exp(), z.powi(5)],
    ];
    for (number, field) in fields.into_iter().enumerate() {
        let order = (unbalanced(3, field) / unbalanced(4, field)).log2();
        let last = unbalanced(4, field);
        assert!(
            last.abs() < 3e-3 && (order - 2.0).abs() < 0.1,
            "field {number}: {last:e} of order {order}"
        );
    }
}

/// Energies of several components add up, each with its own target.
#[test]
fn components_have_targets_of_their_own() {
    let mesh = several();
    let targets = Targets::measured(&TotalArea, mesh.surface());
    let (connectivity, x) = (&mesh.connectivity, &mesh.positions);
    let at_rest = Penalty::new(TotalArea, 2.0, targets.clone());
    assert_eq!(energy(at_rest.clone(), connectivity, x), 0.0);
    assert_eq!(largest(&forces(at_rest, connectivity, x)), 0.0);
    let Targets::PerComponent(mut areas) = targets else {
        panic!("measured targets are one a component");
    };
    let area = areas[1];
    areas[1] *= 0.5;
    let one = Penalty::new(TotalArea, 2.0, Targets::PerComponent(areas));
    tolerance::SAME.assert(
        energy(one.clone(), connectivity, x),
        0.5 * area,
        area,
        "k/2 (A − A/2)²/(A/2)",
    );
    let plan = Components::new(connectivity);
    for (force, &component) in forces(one, connectivity, x).iter().zip(plan.of_vertex()) {
        assert_eq!(norm(*force) > 0.0, component == 1);
    }
}

/// Constraints that hold these quantities at their current values.
fn holding(quantities: &[AnyFunctional], mesh: &Mesh) -> Constraints<f64> {
    let held = |&functional: &AnyFunctional| Constraint {
        functional,
        targets: Targets::measured(&functional, mesh.surface()),
    };
    Constraints {
        constraints: quantities.iter().map(held).collect(),
    }
}

fn correct(
    prepared: &mut Prepared<f64, Constraints<f64>>,
    mesh: &mut Mesh,
) -> Result<Correction<f64>, ConstraintError> {
    let Mesh {
        connectivity,
        positions,
    } = mesh;
    prepared.with(|constraints, execution, workspace| {
        constraints.correct(execution, connectivity, positions, workspace)
    })
}

/// Largest |F/F0 − 1| of all constraints and components.
fn residual(constraints: &Constraints<f64>, mesh: &Mesh) -> f64 {
    let mut largest = 0.0_f64;
    for constraint in &constraints.constraints {
        let Targets::PerComponent(found) =
            Targets::measured(&constraint.functional, mesh.surface())
        else {
            panic!("measured targets are one a component");
        };
        for (component, found) in found.into_iter().enumerate() {
            largest = largest.max((found / constraint.targets.at(component) - 1.0).abs());
        }
    }
    largest
}

#[test]
fn corrections_hold_over_a_thousand_disturbances() {
    let start = icosphere(2).map(bent);
    let mut random = SplitMix64::new(4);
    for quantities in [&ALL[..1], &ALL[1..2], &ALL[..2], &ALL] {
        let mut mesh = start.clone();
        let constraints = holding(quantities, &mesh);
        let mut prepared = Prepared::new(constraints.clone(), &mesh.connectivity);
        for round in 0..1000 {
            let step = 1e-3 * mesh.edge_length();
            for x in mesh.positions.iter_mut().flatten() {
                *x += step * random.symmetric();
            }
            let reached = correct(&mut prepared, &mut mesh).unwrap();
            let left = residual(&constraints, &mesh);
            tolerance::CONSTRAINED.assert(left, 0.0, 1.0, &format!("{quantities:?}, {round}"));
            tolerance::CONSTRAINED.assert(reached.residual, left, 1.0, "what was reached");
            assert!(reached.steps <= 4, "{reached:?}");
        }
    }
}

/// A correction converges from a deviation of ten percent.
#[test]
fn corrections_come_from_afar() {
    let mut mesh = several();
    let open = mesh.connectivity.triangles().len() - hemisphere(2).connectivity.triangles().len();
    let closed = mesh.connectivity.triangles()[..open].to_vec();
    let vertices = mesh.positions.len() - hemisphere(2).positions.len();
    mesh = Mesh::new(mesh.positions[..vertices].to_vec(), closed);
    let constraints = holding(&ALL[..2], &mesh);
    let mut prepared = Prepared::new(constraints.clone(), &mesh.connectivity);
    mesh = mesh.map(|[x, y, z]| [1.1 * x, y, z]);
    let before = mesh.clone();
    let reached = correct(&mut prepared, &mut mesh).unwrap();
    assert!((1..=8).contains(&reached.steps), "{reached:?}");
    tolerance::CONSTRAINED.assert(residual(&constraints, &mesh), 0.0, 1.0, "F/F0");
    assert_ne!(mesh.positions, before.positions);

    // On target, nothing moves; and if one component is off, the others stay.
    let there = mesh.clone();
    assert_eq!(correct(&mut prepared, &mut mesh).unwrap().steps, 0);
    assert_eq!(mesh.positions, there.positions);
    let second = Components::new(&mesh.connectivity);
    mesh.positions[0][0] += 0.01;
    correct(&mut prepared, &mut mesh).unwrap();
    for (vertex, &component) in second.of_vertex().iter().enumerate() {
        let stays = mesh.positions[vertex] == there.positions[vertex];
        assert_eq!(stays, component == 1, "vertex {vertex}");
    }
}

/// To first order the correction is the shortest one: its displacement is parallel to the gradient.
#[test]
fn corrections_are_the_shortest() {
    let mesh = icosphere(2).map(bent);
    let mut constraints = holding(&ALL[1..2], &mesh);
    if let Targets::PerComponent(targets) = &mut constraints.constraints[0].targets {
        targets[0] *= 1.0 + 1e-6;
    }
    let mut prepared = Prepared::new(constraints, &mesh.connectivity);
    let mut moved = mesh.clone();
    correct(&mut prepared, &mut moved).unwrap();
    let gradient = forces(
        OsmoticPressure::new(1.0),
        &mesh.connectivity,
        &mesh.positions,
    );
    let ends = moved.positions.iter().zip(&mesh.positions);
    let step = Vec::from_iter(ends.map(|(&to, &from)| difference(to, from)));
    let product =
        |a: &[[f64; 3]], b: &[[f64; 3]]| -> f64 { a.iter().zip(b).map(|(&a, &b)| dot(a, b)).sum() };
    let cosine =
        product(&step, &gradient) / (product(&step, &step) * product(&gradient, &gradient)).sqrt();
    FIRST_ORDER.assert(cosine, 1.0, 1.0, "cosine between step and gradient");
}

/// Far from the origin, a correction is as accurate as the rounding of positions permits.
#[test]
fn corrections_far_away() {
    let far = 2.0_f64.powi(27);
    let mut mesh = icosphere(2).map(bent).map(|x| x.map(|x| x + far));
    let constraints = holding(&ALL, &mesh);
    let mut prepared = Prepared::new(constraints.clone(), &mesh.connectivity);
    let mut random = SplitMix64::new(6);
    for x in mesh.positions.iter_mut().flatten() {
        *x += 1e-3 * random.symmetric();
    }
    let off = residual(&constraints, &mesh);
    let reached = correct(&mut prepared, &mut mesh).unwrap();
    let left = residual(&constraints, &mesh);
    CONSTRAINED_FAR.assert(left, 0.0, 1.0, "F/F0");
    assert!(reached.steps <= 3 && off > 1e-4, "{off:e}, {reached:?}");
}

#[test]
fn what_cannot_be_corrected_is_refused_and_left() {
    let refused = |mut mesh: Mesh, constraints: Constraints<f64>| {
        let before = mesh.positions.clone();
        let mut prepared = Prepared::new(constraints, &mesh.connectivity);
        let error = correct(&mut prepared, &mut mesh).unwrap_err();
        assert!(mesh.positions == before, "positions after {error}");
        error
    };
    let enlarged = |quantities: &[AnyFunctional], mesh: &Mesh, factor: f64| {
        let mut constraints = holding(quantities, mesh);
        if let Targets::PerComponent(targets) = &mut constraints.constraints[0].targets {
            targets[0] *= factor;
        }
        constraints
    };
    // Area and volume of spheres are dependent constraints, on coarse and fine meshes.
    for refinement in 1..=4 {
        let sphere = icosphere(refinement);
        let constraints = enlarged(&ALL[..2], &sphere, 1.01);
        let error = refused(sphere, constraints);
        assert!(
            matches!(error, ConstraintError::Dependent { component: 0, .. }),
            "{error}"
        );
    }
    // Area and volume of vesicles of reduced volume 0.98 are independent.
    for refinement in 2..=4 {
        let mut vesicle = icosphere(refinement).map(|[x, y, z]| [x, y, 1.28 * z]);
        let constraints = enlarged(&ALL[..2], &vesicle, 1.01);
        let mut prepared = Prepared::new(constraints, &vesicle.connectivity);
        correct(&mut prepared, &mut vesicle).unwrap();
    }
    // An open patch has no volume that could be held.
    let patch = hemisphere(2);
    let constraints = Constraints {
        constraints: vec![Constraint {
            functional: AnyFunctional::Volume,
            targets: 1.0.into(),
        }],
    };
    assert!(matches!(
        refused(patch, constraints),
        ConstraintError::Dependent {
            component: 0,
            constraint: 0
        }
    ));
    // A negative area cannot be reached.
    let body = icosphere(2).map(bent);
    let constraints = enlarged(&ALL[..1], &body, -1.0);
    assert!(matches!(
        refused(body, constraints),
        ConstraintError::NotReached { .. } | ConstraintError::Dependent { .. }
    ));
    let mut body = icosphere(2).map(bent);
    let mut prepared = Prepared::new(holding(&ALL, &body), &body.connectivity);
    body.positions[3][1] = f64::NAN;
    assert!(matches!(
        correct(&mut prepared, &mut body),
        Err(ConstraintError::Surface(_))
    ));
    body.positions.pop();
    assert!(matches!(
        correct(&mut prepared, &mut body),
        Err(ConstraintError::Surface(_))
    ));
}

fn project(constraints: &Constraints<f64>, mesh: &Mesh, field: &mut [[f64; 3]]) -> Vec<f64> {
    let mut prepared = Prepared::new(constraints.clone(), &mesh.connectivity);
    prepared.with(|constraints, execution, workspace| {
        constraints.project(execution, mesh.surface(), workspace, field);
        workspace.memory().multipliers(0).to_vec()
    })
}

#[test]
fn projected_fields_keep_the_constraints() {
    check_projection(&ALL);
    check_projection(
        &[PatchFunctional::Area, PatchFunctional::Volume].map(AnyFunctional::OfPatches),
    );
}

fn check_projection(quantities: &[AnyFunctional]) {
    let mesh = several();
    let constraints = holding(quantities, &mesh);
    let mut field = SplitMix64::new(3).directions(mesh.positions.len());
    let original = field.clone();
    project(&constraints, &mesh, &mut field);
    let at = |step: f64| {
        let moved = mesh.positions.iter().zip(&field);
        let moved = moved.map(|(x, f)| [0, 1, 2].map(|k| x[k] + step * f[k]));
        Vec::from_iter(moved)
    };
    let (ahead, behind) = (at(1e-6), at(-1e-6));
    for &quantity in quantities {
        let values = |positions: &Vec<[f64; 3]>| {
            let surface = Surface::new(&mesh.connectivity, positions).unwrap();
            match Targets::measured(&quantity, surface) {
                Targets::PerComponent(values) => values,
                Targets::Same(_) => panic!("measured targets are one a component"),
            }
        };
        for (ahead, behind) in values(&ahead).into_iter().zip(values(&behind)) {
            let rate = (ahead - behind) / 2e-6;
            tolerance::TANGENT.assert(rate, 0.0, 1.0, &format!("{quantity:?} along the field"));
        }
    }
    // The removed part is orthogonal to the rest, and a second projection removes nothing.
    let taken = original.iter().zip(&field);
    let taken = taken.map(|(&a, &b)| dot(difference(a, b), b));
    tolerance::SAME.assert(taken.sum(), 0.0, 1.0, "removed · rest");
    let once = field.clone();
    project(&constraints, &mesh, &mut field);
    for (&once, &twice) in once.iter().zip(&field) {
        tolerance::SAME.assert(norm(difference(once, twice)), 0.0, 1.0, "twice");
    }
}

/// The projection removes forces of tension and pressure completely, and its multipliers are their values.
#[test]
fn multipliers_are_tension_and_pressure() {
    let mesh = icosphere(3).map(bent);
    let constraints = holding(&ALL[..2], &mesh);
    let effects = (SurfaceTension::new(3.0), OsmoticPressure::new(7.0));
    let mut force = forces(effects, &mesh.connectivity, &mesh.positions);
    let scale = largest(&force);
    let multipliers = project(&constraints, &mesh, &mut force);
    tolerance::SAME.assert(largest(&force), 0.0, scale, "what is left");
    tolerance::SAME.assert(multipliers[0], -3.0, 3.0, "−σ");
    tolerance::SAME.assert(multipliers[1], 7.0, 7.0, "Δp");
}

/// Two identical constraints are dependent; the projection removes their common span once.
#[test]
fn dependent_constraints_are_projected_once() {
    let mesh = icosphere(3);
    let mut twice = holding(&[AnyFunctional::Area, AnyFunctional::Area], &mesh);
    let mut force = SplitMix64::new(3).directions(mesh.positions.len());
    let mut other = force.clone();
    project(&twice, &mesh, &mut force);
    twice.constraints.pop();
    project(&twice, &mesh, &mut other);
    for (&a, &b) in force.iter().zip(&other) {
        tolerance::SAME.assert(norm(difference(a, b)), 0.0, 1.0, "one and two");
    }
}

/// A correction in f32 reaches its target within the rounding of f32.
#[test]
fn corrections_in_single_precision() {
    let mesh = icosphere(2).map(bent);
    let mut positions = mesh.positions_in::<f32>();
    let surface = Surface::new(&mesh.connectivity, &positions).unwrap();
    let area = Targets::measured(&TotalArea, surface);
    let constraints = Constraints {
        constraints: vec![Constraint {
            functional: TotalArea,
            targets: area.clone(),
        }],
    };
    for x in positions.iter_mut().flatten() {
        *x *= 1.02;
    }
    let mut prepared = Prepared::new(constraints, &mesh.connectivity);
    let reached = prepared.with(|constraints, execution, workspace| {
        let mesh = &mesh.connectivity;
        constraints.correct(execution, mesh, &mut positions, workspace)
    });
    let residual = f64::from(reached.unwrap().residual);
    CONSTRAINED_SINGLE.assert(residual, 0.0, 1.0, "A/A0");
}

/// Steps towards these targets would leave the range of floating-point positions.
#[test]
fn targets_beyond_the_range_are_not_reached() {
    let start = icosphere(1).map(bent);
    for target in [1e200, -1e200, 1e308] {
        let mut mesh = start.clone();
        let mut constraints = holding(&ALL[1..2], &mesh);
        constraints.constraints[0].targets = Targets::from(target);
        let mut prepared = Prepared::new(constraints, &mesh.connectivity);
        let refused = correct(&mut prepared, &mut mesh).expect_err("out of reach");
        let not_reached = matches!(refused, ConstraintError::NotReached { .. });
        assert!(not_reached, "{target}: {refused}");
        assert_eq!(mesh.positions, start.positions);
    }
}

/// Infinite targets must be refused explicitly, because every value is within rounding of them.
#[test]
fn infinite_targets_are_refused() {
    let start = icosphere(1).map(bent);
    for target in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
        let mut mesh = start.clone();
        let mut constraints = holding(&ALL[..2], &mesh);
        constraints.constraints[1].targets = Targets::from(target);
        let mut prepared = Prepared::new(constraints, &mesh.connectivity);
        let refused = correct(&mut prepared, &mut mesh);
        let expected = ConstraintError::Target {
            component: 0,
            constraint: 1,
        };
        assert_eq!(refused.err(), Some(expected), "{target}");
        assert_eq!(mesh.positions, start.positions);
    }
}
