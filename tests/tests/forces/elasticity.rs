//! In-plane laws relative to a reference: exact gradients, known limits, and references that are refused.

mod families;
mod range;

use families::{Blood, Check, Family, Rubber, for_each, invariants};
use helfrich::elasticity::Strain;
use helfrich::{
    Conservative, Finding, InPlane, Prepared, Real, ReferenceError, Serial, StrainEnergy, Surface,
    TriangleMesh,
};
use helfrich_tests::laws::{
    Balanced, ConservativeCandidate, ConservativeLaw, Finite, ForceIsDifference, ForceIsGradient,
    Law, energy, findings, forces, largest,
};
use helfrich_tests::meshes::{
    GENERIC, Mesh, bent, cases, cross, difference, disc, hemisphere, icosphere, norm, octahedron,
    rotation, rough_any, turned, unit,
};
use helfrich_tests::tolerance::{self, Tolerance};
use proptest::prelude::*;

/// Energies and forces under homogeneous strains, relative to modulus times area; forces are also divided by
/// the strain.
const HOMOGENEOUS: Tolerance = Tolerance::new(
    1e-13,
    "a linear triangle is exact for a homogeneous strain; only a few roundings are left",
);

/// Energies of small strains against their quadratic limit, relative, divided by the strain.
const SMALL_STRAIN: Tolerance = Tolerance::new(
    8.0,
    "terms of third order: the strain times a number that grows with the exponents of the stretches",
);

/// Energy of a strain of 1e-8 in positions that are rounded, relative.
const TINY_STRAIN: Tolerance = Tolerance::new(
    1e-6,
    "positions are rounded at 1e-16 over an edge of a third, and the strain is 1e-8",
);

#[test]
fn every_law_of_the_library_is_in_the_suite() {
    struct Modules(Vec<&'static str>);
    impl Check for Modules {
        fn check<F: Family>(&mut self, _family: F) {
            self.0.push(F::MODULE);
        }
    }
    let mut covered = Modules(Vec::new());
    for_each(&mut covered);
    let source = include_str!("../../../core/src/elasticity.rs");
    let modules = source
        .lines()
        .filter_map(|line| line.strip_prefix("mod ")?.strip_suffix(';'));
    let modules = Vec::from_iter(modules);
    assert!(!modules.is_empty());
    for module in modules {
        assert!(covered.0.contains(&module), "{module} is in no law");
    }
}

/// A law with its reference, as a candidate of the suite of all methods.
#[derive(Clone, Copy)]
struct Over<'a, F> {
    family: F,
    reference: &'a Mesh,
}

impl<F: Family> ConservativeCandidate for Over<'_, F> {
    type ConservativeMethod<T: Real> = InPlane<T, F::Law<T>>;
    fn name(self) -> &'static str {
        F::MODULE
    }
    fn method<T: Real>(self, modulus: T) -> InPlane<T, F::Law<T>> {
        let positions = self.reference.positions_in::<T>();
        let mesh = &self.reference.connectivity;
        let reference = Surface::new(mesh, &positions).expect("finite positions");
        InPlane::new(self.family.law(modulus), mesh, reference).expect("triangles with area")
    }
}

/// Another shape of the same mesh, as the reference.
fn relaxed(mesh: &Mesh) -> Mesh {
    mesh.map(|[x, y, z]| [0.9 * x + 0.1 * y, 1.1 * y - 0.1 * z, 0.8 * z + 0.1 * x * y])
}

/// Laws of conservative methods that apply to a method made for one mesh.
struct Conserves<'a>(&'a Mesh);

impl Check for Conserves<'_> {
    fn check<F: Family>(&mut self, family: F) {
        let reference = &relaxed(self.0);
        let candidate = Over { family, reference };
        ForceIsGradient(self.0).check(candidate);
        ForceIsDifference(self.0).check(candidate);
        Balanced(self.0).check(candidate);

        // The workspace carries nothing over to the next evaluation, and forces are added to the output.
        let (expected, total) = evaluate(family, reference, self.0);
        let method = ConservativeCandidate::method(candidate, 1.0);
        let mut prepared = Prepared::new(method, &self.0.connectivity);
        for _ in 0..2 {
            let mut force = vec![[0.0; 3]; expected.len()];
            let together = prepared.add_force_and_energy(self.0.surface(), &mut force);
            assert!((&force, together) == (&expected, total), "{}", F::MODULE);
            assert_eq!(prepared.energy(self.0.surface()), total, "{}", F::MODULE);
            prepared.add_force_and_energy(self.0.surface(), &mut force);
            let twice = expected.iter().map(|f| f.map(|f| f + f));
            assert!(force.iter().copied().eq(twice), "{}: added", F::MODULE);
        }
    }
}

/// Forces and energy over a reference.
fn evaluate<F: Family>(family: F, reference: &Mesh, now: &Mesh) -> (Vec<[f64; 3]>, f64) {
    let method = || ConservativeCandidate::method(Over { family, reference }, 1.0);
    let (mesh, positions) = (&now.connectivity, &now.positions);
    (
        forces(method(), mesh, positions),
        energy(method(), mesh, positions),
    )
}

/// Energy and forces vanish exactly in the reference shape, wherever it lies.
struct AtRest<'a>(&'a Mesh);

impl Check for AtRest<'_> {
    fn check<F: Family>(&mut self, family: F) {
        let pitch = 2.0_f64.powi(-40);
        let mesh = &self.0.map(|x| x.map(|x| (x / pitch).round() * pitch));
        let nothing = vec![[0.0; 3]; mesh.positions.len()];
        let moved = mesh.map(|x| [x[0] + 5.0, x[1] - 2.25, x[2] + 0.125]);
        for now in [mesh, &moved] {
            let (force, energy) = evaluate(family, mesh, now);
            assert!(force == nothing && energy == 0.0, "{}", F::MODULE);
        }
        let single = mesh.positions_in::<f32>();
        let candidate = Over {
            family,
            reference: mesh,
        };
        let method = || ConservativeCandidate::method(candidate, 1.0_f32);
        let force = forces(method(), &mesh.connectivity, &single);
        assert!(force.iter().flatten().all(|&f| f == 0.0), "{}", F::MODULE);
        assert_eq!(energy(method(), &mesh.connectivity, &single), 0.0);

        let remainders = vec![[1e-17, -2e-17, 3e-18]; single.len()];
        let surface =
            Surface::with_remainders(&mesh.connectivity, &mesh.positions, &remainders).unwrap();
        let method = InPlane::new(family.law(1.0), &mesh.connectivity, surface).unwrap();
        let mut force = nothing.clone();
        let energy =
            Prepared::new(method, &mesh.connectivity).add_force_and_energy(surface, &mut force);
        assert!(force == nothing && energy == 0.0, "{}: pairs", F::MODULE);
    }
}

/// Rotation of either shape and relabelling transform E and F accordingly; under common scaling, E grows as
/// length², F as length.
struct Follows<'a>(&'a Mesh, u64);

impl Check for Follows<'_> {
    fn check<F: Family>(&mut self, family: F) {
        let (now, reference) = (self.0, &relaxed(self.0));
        let (force, energy) = evaluate(family, reference, now);
        let scale = largest(&force) * now.roughness();
        let compare = |found: (Vec<[f64; 3]>, f64), expected: Vec<[f64; 3]>, what: &str| {
            for (found, expected) in found.0.iter().zip(expected) {
                let error = norm(difference(*found, expected));
                tolerance::INVARIANCE.assert(error, 0.0, scale, what);
            }
            tolerance::INVARIANCE.assert(found.1, energy, energy + scale, what);
        };
        let turn = rotation(GENERIC);
        let about = |mesh: &Mesh| mesh.map(|x| turned(turn, x));
        let expected = force.iter().map(|&f| turned(turn, f)).collect();
        compare(evaluate(family, reference, &about(now)), expected, "turned");
        compare(
            evaluate(family, &about(reference), now),
            force.clone(),
            "turned reference",
        );

        let (relabelled, number) = now.relabelled(self.1);
        let found = evaluate(family, &reference.relabelled(self.1).0, &relabelled);
        let back = number.iter().map(|&new| found.0[new]).collect();
        compare((back, found.1), force.clone(), "relabelled");

        for exponent in [-40, 40] {
            let factor = 2.0_f64.powi(exponent);
            let scaled = |mesh: &Mesh| mesh.map(|x| x.map(|x| factor * x));
            let (large, much) = evaluate(family, &scaled(reference), &scaled(now));
            assert_eq!(much, factor * factor * energy, "{}: scale", F::MODULE);
            for (large, force) in large.iter().zip(&force) {
                assert_eq!(*large, force.map(|f| factor * f), "{}: scale", F::MODULE);
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(12))]

    #[test]
    fn forces_are_gradients_and_balance(rough in rough_any()) {
        for_each(&mut Conserves(&rough.mesh()));
    }

    #[test]
    fn a_reference_has_exactly_no_force(rough in rough_any()) {
        for_each(&mut AtRest(&rough.mesh()));
    }

    #[test]
    fn motion_labels_and_scale_are_followed(rough in rough_any(), seed in 0..1_000_000_u64) {
        for_each(&mut Follows(&rough.mesh(), seed));
    }
}

/// Symmetric 2×2 matrix (xx, xy, yy) with these principal values along axes turned by `angle`.
fn symmetric([a, b]: [f64; 2], angle: f64) -> [f64; 3] {
    let (s, c) = angle.sin_cos();
    [
        a * c * c + b * s * s,
        (a - b) * s * c,
        a * s * s + b * c * c,
    ]
}

/// A flat patch stretched along two axes in its plane, then turned.
fn stretched(patch: &Mesh, stretches: [f64; 2], angle: f64) -> Mesh {
    let [xx, xy, yy] = symmetric(stretches, angle);
    let turn = rotation(GENERIC);
    patch.map(|[x, y, _]| turned(turn, [xx * x + xy * y, xy * x + yy * y, 0.0]))
}

/// The energy of a homogeneous strain is the law's density times the area, because linear triangles are
/// exact.
#[test]
fn homogeneous_strain_has_the_energy_of_the_law() {
    struct Homogeneous;
    impl Check for Homogeneous {
        fn check<F: Family>(&mut self, family: F) {
            let patch = &disc(3);
            for stretches in [[1.3, 1.0], [1.2, 1.2], [2.0, 0.5], [0.7, 0.9], [0.2, 3.0]] {
                let now = stretched(patch, stretches, 0.4);
                let (_, energy) = evaluate(family, patch, &now);
                let area = patch.surface().area();
                let expected = family.density(stretches) * area;
                HOMOGENEOUS.assert(energy, expected, expected + area, F::MODULE);
            }
        }
    }
    for_each(&mut Homogeneous);
}

/// `W → ½ K_s (tr ε)² + G |dev ε|²`, down to strains whose squares are far below rounding, where the same law
/// written with `tr C − 2` and `det C − 1` returns only rounding.
#[test]
fn small_strains_have_the_moduli() {
    struct Small;
    impl Check for Small {
        fn check<F: Family>(&mut self, family: F) {
            let law = family.law(1.0);
            let [shear, area] = family.moduli();
            assert_eq!([law.shear_modulus(), law.area_modulus()], [shear, area]);
            // The strains are multiples of 2⁻⁵², so that positions store them exactly.
            let patch = &Mesh::new(
                vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
                vec![[0, 1, 2], [1, 3, 2]],
            );
            for units in [1_u64 << 39, 31_100_003, 3001] {
                let size = units as f64 * f64::EPSILON;
                for strain in [[1.0, 1.0], [1.0, 0.0], [1.0, -1.0]] {
                    let [a, b] = strain.map(|part| size * part);
                    let now = patch.map(|[x, y, z]| [x + a * x, y + b * y, z]);
                    let (_, energy) = evaluate(family, patch, &now);
                    let expected = 0.5 * area * (a + b) * (a + b) + 0.5 * shear * (a - b) * (a - b);
                    if expected > 0.0 {
                        // The bound is for the law's terms of third order.
                        let bound = SMALL_STRAIN.value * size;
                        let error = (energy / expected - 1.0).abs();
                        assert!(error <= bound, "{}, {size:e}: {error:e}", F::MODULE);
                    }
                }
            }
        }
    }
    for_each(&mut Small);

    // Here the strain is not a multiple of 2⁻⁵² and positions are rounded. The naive formula fails.
    let (size, patch) = (1e-8, &disc(3));
    let stretches = [1.0 + size, 1.0 - size];
    let area = patch.surface().area();
    let (_, found) = evaluate(Rubber, patch, &stretched(patch, stretches, 0.4));
    TINY_STRAIN.assert(found, 2.0 * size * size * area, found, "W");
    let naive = Rubber.density(stretches);
    assert!((naive / (2.0 * size * size) - 1.0).abs() > 0.1, "{naive:e}");
}

/// Every triangle of an inflated sphere has the same isotropic tension; the force is this tension times the
/// gradient of the area.
#[test]
fn a_stretched_sphere_has_the_exact_tension() {
    struct Blown;
    impl Check for Blown {
        fn check<F: Family>(&mut self, family: F) {
            let sphere = &icosphere(3);
            for stretch in [0.7, 0.999, 1.0 + 1e-6, 1.05, 1.6] {
                let now = sphere.map(|x| x.map(|x| stretch * x));
                let (force, energy) = evaluate(family, sphere, &now);
                let area = sphere.surface().area();
                let expected = family.density([stretch; 2]) * area;
                HOMOGENEOUS.assert(energy, expected, expected + area, F::MODULE);

                let rounding = HOMOGENEOUS.value / (stretch - 1.0).abs();
                let tension = family.tension(stretch);
                let mut expected = vec![[0.0; 3]; force.len()];
                for &corners in now.connectivity.triangles() {
                    let x = corners.map(|vertex| now.positions[vertex as usize]);
                    let normal = unit(cross(difference(x[1], x[0]), difference(x[2], x[0])));
                    for k in 0..3 {
                        let opposite = difference(x[(k + 2) % 3], x[(k + 1) % 3]);
                        let gradient = cross(normal, opposite);
                        for axis in 0..3 {
                            expected[corners[k] as usize][axis] -= 0.5 * tension * gradient[axis];
                        }
                    }
                }
                let scale = largest(&expected);
                for (found, expected) in force.iter().zip(expected) {
                    let error = norm(difference(*found, expected)) / scale;
                    assert!(error < rounding, "{}, {stretch}: {error:e}", F::MODULE);
                }
                // Tension pulls a sphere inwards.
                let inwards = force[0][0] * now.positions[0][0] < 0.0;
                assert_eq!(inwards, stretch > 1.0, "{}", F::MODULE);
            }
        }
    }
    for_each(&mut Blown);
}

#[test]
fn a_scaled_reference_is_a_smaller_shape() {
    let (sphere, now) = (icosphere(1), icosphere(1).map(bent));
    let mesh = &sphere.connectivity;
    let half = sphere.map(|x| x.map(|x| 0.5 * x));
    let law = Rubber.law(1.0);
    let method = InPlane::new(law, mesh, sphere.surface()).unwrap();
    let area = method.reference_area(&Serial);
    tolerance::POLYHEDRON.assert(area, sphere.surface().area(), area, "A0");
    let scaled = method.clone().with_scaled_reference(0.5).unwrap();
    let direct = InPlane::new(law, mesh, half.surface()).unwrap();
    assert_eq!(scaled, direct);
    assert_eq!(
        forces(scaled, mesh, &now.positions),
        forces(direct, mesh, &now.positions)
    );
    for factor in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = method.clone().with_scaled_reference(factor);
        assert!(matches!(refused, Err(ReferenceError::Factor { .. })));
    }
    let refused = method.with_scaled_reference(1e-200);
    assert_eq!(refused, Err(ReferenceError::NoArea { triangle: 0 }));
}

#[test]
fn references_that_do_not_fit_are_refused() {
    let law = Blood(1.0).law(1.0);
    let (sphere, solid) = (icosphere(1), octahedron());
    let refused = InPlane::new(law, &sphere.connectivity, solid.surface());
    let (reference, mesh) = (8, 80);
    let expected = ReferenceError::CountMismatch { reference, mesh };
    assert_eq!(refused, Err(expected));

    let mut triangles = solid.connectivity.triangles().to_vec();
    triangles.swap(3, 5);
    let swapped = TriangleMesh::new(6, triangles).unwrap();
    let error = InPlane::new(law, &swapped, solid.surface()).unwrap_err();
    assert!(matches!(
        error,
        ReferenceError::TriangleMismatch { triangle: 3, .. }
    ));
    assert!(error.to_string().contains("triangle 3"));

    let flat = solid.map(|[x, y, z]| [x, y, if y == 0.0 { z } else { 0.0 }]);
    assert!(InPlane::new(law, &flat.connectivity, flat.surface()).is_ok());
    let pinched = solid.map(|[x, y, z]| [x, y, if x == 0.0 { 0.0 } else { z }]);
    let line = solid.map(|[x, y, _]| [x + y, 0.0, 0.0]);
    for (shape, triangle) in [(line, 0), (pinched.map(|[x, _, z]| [x, 0.0, z]), 0)] {
        let refused = InPlane::new(law, &shape.connectivity, shape.surface());
        assert_eq!(refused, Err(ReferenceError::NoArea { triangle }));
    }
}

#[test]
#[should_panic(expected = "prepared for a mesh of 42 vertices and 80 triangles")]
fn a_method_for_another_mesh_does_not_go_unnoticed() {
    let sphere = icosphere(1);
    let law = Rubber.law(1.0);
    let method = InPlane::new(law, &sphere.connectivity, sphere.surface()).unwrap();
    Prepared::new(method, &octahedron().connectivity);
}

#[test]
fn degenerate_surfaces_give_finite_numbers() {
    struct Degenerate<'a>(&'a Mesh, Vec<Mesh>);
    impl Check for Degenerate<'_> {
        fn check<F: Family>(&mut self, family: F) {
            let reference = self.0;
            for now in &self.1 {
                Finite(now).check(Over { family, reference });
            }
        }
    }
    let sphere = &icosphere(1);
    let neighbours = sphere.connectivity.one_ring(0);
    let [first, second] = [0, 1].map(|k| sphere.positions[neighbours[k] as usize]);
    let replaced = |position| {
        let mut replaced = sphere.clone();
        replaced.positions[0] = position;
        replaced
    };
    let middle = [0, 1, 2].map(|axis| 0.5 * (first[axis] + second[axis]));
    let near = [0, 1, 2].map(|axis| middle[axis] + 1e-100 * sphere.positions[0][axis]);
    let shapes = vec![
        replaced(first),
        replaced(middle),
        replaced(near),
        sphere.map(|_| [1.0, 2.0, 3.0]),
        sphere.map(|[x, ..]| [x, 0.0, 0.0]),
        sphere.map(|[x, y, z]| [x, y, 1e-90 * z]),
        sphere.map(|x| x.map(|x| 1e-12 * x)),
        sphere.map(|x| x.map(|x| 1e12 * x)),
    ];
    for_each(&mut Degenerate(sphere, shapes));

    let law = || InPlane::new(Rubber.law(1.0), &sphere.connectivity, sphere.surface()).unwrap();
    let expected = sphere.connectivity.triangles().iter().enumerate();
    let expected =
        expected.filter(|(_, corners)| corners.contains(&0) && corners.contains(&neighbours[0]));
    let expected = expected.map(|(triangle, _)| Finding::DegenerateTriangle {
        triangle: triangle as u32,
    });
    assert!(findings(law(), &replaced(first)).into_iter().eq(expected));
    assert_eq!(findings(law(), sphere), []);

    let open = hemisphere(2);
    let flat = open.map(|[x, y, _]| [x, y, 0.0]);
    for_each(&mut Degenerate(&open, vec![flat]));
}

#[test]
fn single_precision() {
    struct Single;
    impl Check for Single {
        fn check<F: Family>(&mut self, family: F) {
            let (now, reference) = (icosphere(3).map(bent), &icosphere(3));
            let candidate = Over { family, reference };
            let (expected, total) = evaluate(family, reference, &now);
            // In metres and newtons per metre, too, nothing may underflow.
            for (length, modulus) in [(1.0_f32, 1.0_f32), (4e-6, 5e-6)] {
                let shrunk = now.map(|x| x.map(|x| x * f64::from(length)));
                let rest = &reference.map(|x| x.map(|x| x * f64::from(length)));
                let candidate = Over {
                    reference: rest,
                    ..candidate
                };
                let mesh = &now.connectivity;
                let positions = shrunk.positions_in::<f32>();
                let method = || ConservativeCandidate::method(candidate, modulus);
                let unit = f64::from(length) * f64::from(modulus);
                let found = forces(method(), mesh, &positions);
                let scale = largest(&expected);
                for (found, expected) in found.iter().zip(&expected) {
                    let found = found.map(|f| f64::from(f) / unit);
                    let error = norm(difference(found, *expected));
                    tolerance::SINGLE_STRAIN.assert(error, 0.0, scale, F::MODULE);
                }
                let found = f64::from(energy(method(), mesh, &positions));
                let found = found / unit / f64::from(length);
                tolerance::SINGLE_STRAIN.assert(found, total, total, F::MODULE);
            }
        }
    }
    for_each(&mut Single);
}

/// A law from another program is used like the library's laws.
#[test]
fn laws_of_other_programs() {
    /// `W = I1²`.
    struct Squared;
    impl StrainEnergy<f64> for Squared {
        fn density(&self, strain: &Strain<f64>) -> f64 {
            strain.first * strain.first
        }
        fn derivatives(&self, strain: &Strain<f64>) -> [f64; 2] {
            [strain.first + strain.first, 0.0]
        }
        fn shear_modulus(&self) -> f64 {
            0.0
        }
        fn area_modulus(&self) -> f64 {
            8.0
        }
    }
    fn conserves(_: &impl Conservative<f64>) {}
    let patch = disc(2);
    let method = InPlane::new(Squared, &patch.connectivity, patch.surface()).unwrap();
    conserves(&method);
    let now = stretched(&patch, [1.1, 1.2], 0.3);
    let [first, _] = invariants([1.1, 1.2]);
    let expected = first * first * patch.surface().area();
    let found = energy(method, &patch.connectivity, &now.positions);
    HOMOGENEOUS.assert(found, expected, expected, "E");
}
