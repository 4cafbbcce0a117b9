//! Sizes near the ends of a number type's range: results scale, or a finding says that they do not.

use helfrich::{
    Finding, GompperKroll, Hamann, Juelicher, LoopSubdivision, MaterialParameter, Prepared,
    Quality, StrongForm, Surface, TriangleMesh,
};
use helfrich_std::method::{BendingMethod, Evaluated, Evaluator, Fields};
use helfrich_tests::laws::{Candidate, Law, Subject, for_each};
use helfrich_tests::meshes::{Mesh, bent, icosphere};
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Fields of a surface of this size, and for each vertex whether a finding names it. Those about noise, which are
/// the same for every method, are measured if they are `None`.
fn measured<T: Evaluated>(
    method: BendingMethod,
    mesh: &Mesh,
    size: T,
    noisy: &mut Option<Vec<Finding>>,
) -> (Fields<T>, Vec<bool>) {
    let scaled = |position: &[f64; 3]| position.map(|x| T::constant(x) * size);
    let positions = Vec::from_iter(mesh.positions.iter().map(scaled));
    let surface = Surface::new(&mesh.connectivity, &positions).expect("positions");
    let mut evaluator = Evaluator::new(method, T::one(), &mesh.connectivity);
    let fields = evaluator.fields(surface);
    let noisy = noisy.get_or_insert_with(|| {
        let quality = evaluator.quality(surface);
        let is_noise = |finding: &Finding| matches!(finding, Finding::NoisyPosition { .. });
        quality
            .findings()
            .iter()
            .copied()
            .filter(is_noise)
            .collect()
    });
    let quality = Quality::gather(&mesh.connectivity, |report| {
        let own = evaluator.findings(surface);
        own.into_iter()
            .chain(noisy.iter().copied())
            .for_each(report);
    });
    (fields, quality.flagged().to_vec())
}

/// Checks that scaling by a power of two keeps all digits: H is divided by it and f by its cube, unless a
/// finding names the vertex. No field is 0 because of underflow or overflow.
fn results_scale_or_say_so<T: Evaluated>(exponents: impl Iterator<Item = i32>) {
    let [coarse, fine] = [2, 3].map(|refinement| icosphere(refinement).map(bent));
    let exponents: Vec<i32> = exponents.collect();
    let mut noise: HashMap<(usize, i32), Option<Vec<Finding>>> = HashMap::new();
    for method in BendingMethod::ALL {
        // The heat kernel couples all vertices, and takes most of the time.
        let mesh = match method {
            BendingMethod::Belkin => &coarse,
            _ => &fine,
        };
        let vertices = mesh.positions.len();
        let of_unit = noise.entry((vertices, 0)).or_default();
        let (unit, _) = measured(method, mesh, T::one(), of_unit);
        for &exponent in &exponents {
            let size = T::constant(2.0).powi(exponent);
            let noisy = noise.entry((vertices, exponent)).or_default();
            let (fields, flagged) = measured(method, mesh, size, noisy);
            for (vertex, flagged) in flagged.into_iter().enumerate() {
                if flagged {
                    continue;
                }
                let near = |found: T, expected: T, what: &str| {
                    // Sums have the same order; only elementary functions of ratios round differently.
                    let error = (found - expected).abs();
                    let bound = T::constant(64.0) * T::epsilon() * expected.abs();
                    assert!(
                        error <= bound || error < T::constant(1e-3),
                        "{method} at 2^{exponent}, vertex {vertex}: {what} is {found:?}, not \
                         {expected:?} over the size"
                    );
                };
                match (fields.mean[vertex], unit.mean[vertex]) {
                    (None, None) => {}
                    (Some(found), Some(expected)) => near(found * size, expected, "H"),
                    (found, _) => panic!("{method} at 2^{exponent}: H {found:?} at {vertex}"),
                }
                match (fields.force_density[vertex], unit.force_density[vertex]) {
                    (None, None) => {}
                    (Some(found), Some(expected)) => {
                        for (found, expected) in found.into_iter().zip(expected) {
                            near(found * size * size * size, expected, "f");
                        }
                    }
                    (found, _) => panic!("{method} at 2^{exponent}: f {found:?} at {vertex}"),
                }
            }
        }
    }
}

#[test]
fn single_precision() {
    // Squares of areas become subnormal at about 2^-29, before they vanish.
    results_scale_or_say_so::<f32>((-75..=25).step_by(10).chain(-36..=-27));
}

#[test]
fn double_precision() {
    results_scale_or_say_so::<f64>((-600..=250).step_by(50).chain(-268..=-252));
}

/// The jets' H of a tiny sphere is 1/R and not 0, for R = 1e-12 in f32 and 1e-90 in f64.
#[test]
fn jets_of_small_spheres() {
    fn mean<T: Evaluated>(radius: f64) -> Vec<f64> {
        let (mesh, size) = (icosphere(3), T::constant(radius));
        let (fields, _) = measured(BendingMethod::J4, &mesh, size, &mut Some(Vec::new()));
        let mean = fields.mean.iter().map(|mean| mean.expect("H").to_f64());
        mean.map(|mean| mean.expect("a number") * radius).collect()
    }
    for mean in mean::<f32>(1e-12).into_iter().chain(mean::<f64>(1e-90)) {
        assert!((mean - 1.0).abs() < 2e-3, "H R = {mean}");
    }
}

/// Curvatures that overflow or underflow are omitted, and reported.
#[test]
fn what_is_out_of_range_is_said() {
    let mesh = icosphere(3).map(bent);
    let positions = Vec::from_iter(mesh.positions.iter().map(|x| x.map(|x| x as f32 * 1e-14)));
    let surface = Surface::new(&mesh.connectivity, &positions).expect("positions");
    let mut evaluator = Evaluator::new(BendingMethod::J6, 1.0, &mesh.connectivity);
    let fields = evaluator.fields(surface);
    let findings = evaluator.findings(surface);
    assert!(fields.force_density.iter().all(Option::is_none));
    assert!(
        findings
            .iter()
            .any(|finding| matches!(finding, Finding::OutOfRange { .. }))
    );
}

/// Message of a panic, if there is one.
pub(crate) fn refusal(evaluate: impl FnOnce()) -> Option<String> {
    let mut evaluate = Some(evaluate);
    caught(&mut || evaluate.take().expect("one call")())
}

/// As [`refusal`], and compiled once.
fn caught(evaluate: &mut dyn FnMut()) -> Option<String> {
    let payload = catch_unwind(AssertUnwindSafe(evaluate)).err()?;
    let text = payload.downcast_ref::<&str>().map(|&text| text.to_owned());
    text.or_else(|| payload.downcast_ref::<String>().cloned())
}

/// A modulus that is not finite is refused; it must not give an energy of 0.
#[test]
fn moduli_that_are_no_numbers_are_refused() {
    struct Refused(Mesh);
    impl Law for Refused {
        fn check<C: Candidate>(&mut self, candidate: C) {
            self.check_method(&candidate);
        }
    }
    impl Refused {
        fn check_method(&self, candidate: &dyn Subject<f64>) {
            for modulus in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let message = refusal(|| {
                    candidate.prepared(modulus, &self.0.connectivity);
                });
                let message = message.unwrap_or_else(|| panic!("{}: {modulus}", candidate.name()));
                assert!(message.contains("modulus"), "{message}");
            }
        }
    }
    for_each(&mut Refused(icosphere(1)));
    let mesh = icosphere(1);
    let mut bent = GompperKroll::new(1.0);
    bent.spontaneous_curvature = f64::NAN.into();
    let message = refusal(|| drop(Prepared::new(bent.clone(), &mesh.connectivity)));
    assert!(
        message
            .expect("a refusal")
            .contains("spontaneous curvature")
    );
    let mut changed = Prepared::new(StrongForm::meyer(1.0), &mesh.connectivity);
    changed.method_mut().modulus = f64::NAN.into();
    assert!(refusal(|| _ = changed.energy(mesh.surface())).is_some());
}

/// Moduli with which forces would overflow, and become 0, are refused. With the largest accepted power of
/// two, energies and forces are those of the modulus 1, to the last bit.
#[test]
fn moduli_that_overflow_are_refused() {
    struct Large(Mesh);
    impl Law for Large {
        fn check<C: Candidate>(&mut self, candidate: C) {
            self.check_method(&candidate);
        }
    }
    impl Large {
        fn check_method(&self, candidate: &dyn Subject<f64>) {
            let (name, mesh) = (candidate.name(), &self.0);
            for modulus in [1e155, f64::MAX / 8.0, -1e200] {
                let message = refusal(|| drop(candidate.prepared(modulus, &mesh.connectivity)));
                let message = message.unwrap_or_else(|| panic!("{name}: {modulus} accepted"));
                assert!(message.contains("overflow where it is above"), "{message}");
            }
            let largest = 2.0_f64.powi(511);
            let results = |modulus: f64| {
                let mut prepared = candidate.prepared(modulus, &mesh.connectivity);
                let mut force = vec![[0.0; 3]; mesh.positions.len()];
                prepared.add_force(mesh.surface(), &mut force);
                (prepared.energy(mesh.surface()), force)
            };
            let ((one, forces), (energy, found)) = (results(1.0), results(largest));
            assert_eq!(energy, largest * one, "{name}");
            for (found, force) in found.iter().zip(forces) {
                assert_eq!(*found, force.map(|f| largest * f), "{name}");
            }
        }
    }
    for_each(&mut Large(icosphere(2).map(bent)));
}

/// H0 whose square overflows is refused; otherwise it would drop vertices. With the largest accepted H0 the
/// energy is `2κ H0² A`, because H is negligible.
#[test]
fn spontaneous_curvatures_that_overflow_are_refused() {
    let mesh = icosphere(2).map(bent);
    let vertices = mesh.positions.len();
    let one_of = |value: f64| {
        let mut values = vec![0.0; vertices];
        values[5] = value;
        MaterialParameter::PerVertex(values)
    };
    let largest = 2.0_f64.powi(255);
    let expected = 2.0 * largest * largest * mesh.surface().area();
    macro_rules! check {
        ($($method:expr),*) => {
            $(
                let energy = |values: MaterialParameter<f64>| {
                    let mut method = $method;
                    method.spontaneous_curvature = values;
                    Prepared::new(method, &mesh.connectivity).energy(mesh.surface())
                };
                for value in [1e78, 1e200, -1e308] {
                    for values in [MaterialParameter::Constant(value), one_of(value)] {
                        let message = refusal(|| _ = energy(values)).expect(stringify!($method));
                        assert!(message.contains("spontaneous curvature is"), "{message}");
                    }
                }
                let found = energy(largest.into());
                // Areas of limit surfaces and fits are smaller than those of triangles.
                assert!((found / expected - 1.0).abs() < 0.05, "{}: {found}", stringify!($method));
            )*
        };
    }
    check!(
        GompperKroll::new(1.0),
        Juelicher::new(1.0),
        Hamann::new(1.0),
        LoopSubdivision::new(1.0),
        StrongForm::meyer(1.0),
        StrongForm::belkin(1.0),
        StrongForm::farutin(1.0),
        StrongForm::j4(1.0)
    );
}

/// Outputs with fewer entries than vertices are refused with the same message by every method.
#[test]
fn outputs_that_are_too_short_are_refused() {
    struct Short(Mesh);
    impl Law for Short {
        fn check<C: Candidate>(&mut self, candidate: C) {
            self.check_method(&candidate);
        }
    }
    impl Short {
        fn check_method(&self, candidate: &dyn Subject<f64>) {
            let mut prepared = candidate.prepared(1.0, &self.0.connectivity);
            let mut force = [[0.0; 3]; 161];
            let message = refusal(|| prepared.add_force(self.0.surface(), &mut force));
            let message = message.unwrap_or_else(|| panic!("{}", candidate.name()));
            let documented = "the output has 161 entries, the surface 162 vertices";
            assert_eq!(message, documented, "{}", candidate.name());
        }
    }
    for_each(&mut Short(icosphere(2)));
}

/// A workspace of another mesh with the same numbers of vertices and triangles would give wrong results, and
/// is refused.
#[test]
fn surfaces_of_another_mesh_are_refused() {
    struct Refused(Mesh, TriangleMesh);
    impl Law for Refused {
        fn check<C: Candidate>(&mut self, candidate: C) {
            self.check_method(&candidate);
        }
    }
    impl Refused {
        fn check_method(&self, candidate: &dyn Subject<f64>) {
            let surface = Surface::new(&self.1, &self.0.positions).expect("positions");
            let mut prepared = candidate.prepared(1.0, &self.0.connectivity);
            let message = refusal(|| _ = prepared.energy(surface));
            let message = message.unwrap_or_else(|| panic!("{}", candidate.name()));
            assert!(message.contains("another mesh"), "{message}");
            prepared.energy(self.0.surface());
        }
    }
    let mesh = icosphere(2);
    let mut triangles = mesh.connectivity.triangles().to_vec();
    triangles.rotate_left(1);
    let other = TriangleMesh::new(mesh.positions.len(), triangles).expect("a mesh");
    for_each(&mut Refused(mesh, other));
}
