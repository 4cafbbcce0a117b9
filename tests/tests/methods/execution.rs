//! Loops on several threads and in wide vectors give the bits of the serial loop in the core.

use helfrich::element::{ElementKernel, Execution, SlotKernel, Slots, Strided};
use helfrich::{
    Conservative, Energy, Force, InPlane, Lane, Prepared, Real, Reordering, Serial, Skalak, Surface,
};
use helfrich_std::execute::{Parallel, Shares, available_threads, with_threads};
use helfrich_tests::laws::{
    Candidate, ConservativeCandidate, ConservativeLaw, Evaluate, Law, Subject, for_each,
    for_each_conservative, largest,
};
use helfrich_tests::meshes::{Mesh, bent, icosphere, sheet, small, torus};
use helfrich_tests::potentials::for_each_potential;
use helfrich_tests::tolerance::Tolerance;
use std::collections::{BTreeMap, HashSet};
use std::fmt::Debug;
use std::num::NonZeroUsize;
use std::sync::Mutex;
use std::time::Duration;

/// Forces of one method in two orders of the vertices, relative to the largest.
const REORDERED: Tolerance = Tolerance::new(
    1e-12,
    "rounding of positions in a fourth derivative: 1e-16 over the fourth power of an edge of a tenth",
);

fn threads() -> impl Iterator<Item = Parallel> {
    (1..=3).map(|threads| Parallel {
        threads: NonZeroUsize::new(threads).expect("from 1 on"),
    })
}

/// Execution in runs of varying numbers of slots, which all use the same scratch memory.
#[derive(Debug)]
struct Piecemeal;

impl Execution for Piecemeal {
    fn scatter<T: Real, K, const CORNERS: usize, const IN: usize, const OUT: usize>(
        &self,
        kernel: &K,
        surface: Surface<'_, T>,
        elements: &[[u32; CORNERS]],
        input: &[[T; IN]],
        output: &mut [[T; OUT]],
    ) where
        K: ElementKernel<T, CORNERS, IN, OUT>,
    {
        Serial.scatter(kernel, surface, elements, input, output);
    }

    fn run<S: Default + Send, O: Slots>(
        &self,
        scratches: &mut Vec<S>,
        mut output: O,
        kernel: &impl SlotKernel<S, O>,
    ) {
        scratches.resize_with(1, S::default);
        let mut start = 0;
        for size in [1, 2, 3, 5, 11, 29].into_iter().cycle() {
            let count = output.count();
            let (now, later) = output.split_at(size.min(count));
            kernel.set(&mut scratches[0], start, now);
            (start, output) = (start + size, later);
            if output.count() == 0 {
                break;
            }
        }
    }

    fn sum<T: Real>(&self, count: usize, term: impl Fn(usize) -> T + Sync) -> T {
        Serial.sum(count, term)
    }
}

/// Mesh so uneven that whether neighbours determine a fit changes from vertex to vertex.
fn uneven() -> Mesh {
    icosphere(3).map(|x| [0, 1, 2].map(|k| x[k] + 0.05 * (57.0 * x[(k + 1) % 3]).sin()))
}

/// Mesh large enough for threads, in random vertex order.
fn large() -> Mesh {
    torus(110, 56).map(bent).relabelled(7).0
}

/// Checks that two values have the same numbers, where NaN equals NaN.
fn assert_same<V: Debug>(found: &V, expected: &V, what: &str) {
    let (found, expected) = (format!("{found:?}"), format!("{expected:?}"));
    assert!(found == expected, "{what}: not the bits of the serial loop");
}

struct SameBits<'a>(&'a str, &'a Mesh);

/// A method that is prepared anew for each execution.
type Prepare<'a, 'b, X, T> = &'a mut dyn FnMut(X) -> Box<dyn Evaluate<T> + 'b>;

/// Methods that take long at a vertex, so that threads are worth starting on a few hundred.
const SLOW: [&str; 3] = ["Belkin et al.", "Belkin, published bandwidth", "Galerkin"];

impl SameBits<'_> {
    fn has_many_vertices(&self) -> bool {
        self.1.positions.len() > 3000
    }

    fn is_left_out(&self, name: &str) -> bool {
        self.has_many_vertices() && SLOW.contains(&name)
    }

    fn check_in<T: Real, M: Energy<T> + Force<T>>(&self, name: &str, method: impl Fn() -> M) {
        let mesh = &self.1.connectivity;
        self.check_loops(name, &mut |threads| match threads {
            None => Box::new(Prepared::new(method(), mesh)),
            Some(threads) => Box::new(Prepared::with_execution(method(), mesh, threads)),
        });
    }

    fn check_loops<T: Real>(&self, name: &str, prepare: Prepare<'_, '_, Option<Parallel>, T>) {
        let Self(place, mesh) = self;
        let positions = mesh.positions_in::<T>();
        let surface = Surface::new(&mesh.connectivity, &positions).expect("finite");
        let start = vec![[T::constant(0.25); 3]; positions.len()];
        let mut expected = start.clone();
        let mut serial = prepare(None);
        serial.add_force(surface, &mut expected);
        let energy = serial.energy(surface);
        for execution in threads() {
            let what = format!("{name}, {place}, {execution:?}");
            let mut found = start.clone();
            let mut prepared = prepare(Some(execution));
            prepared.add_force(surface, &mut found);
            assert_same(&found, &expected, &what);
            assert_same(&prepared.energy(surface), &energy, &what);
        }
        // Nothing is carried over from a surface nearby.
        let what = format!("{name}, {place}, after another surface");
        let nearby = (*mesh)
            .clone()
            .map(|[x, y, z]| [1.02 * x, 0.98 * y, z + 0.03 * x * y]);
        let nearby = nearby.positions_in::<T>();
        let nearby = Surface::new(&mesh.connectivity, &nearby).expect("finite");
        let mut found = start.clone();
        let mut prepared = prepare(None);
        prepared.add_force(nearby, &mut start.clone());
        prepared.add_force(surface, &mut found);
        assert_same(&found, &expected, &what);
    }

    /// Scratch memory carries nothing over from run to run, wherever runs end. Slots are divided and scratch memory
    /// is used in the same way in all number types: f64 stands for these.
    fn check_pieces(&self, name: &str, prepare: Prepare<'_, '_, bool, f64>) {
        let Self(place, mesh) = self;
        let [expected, found] = [false, true].map(|in_pieces| {
            let mut forces = vec![[0.25; 3]; mesh.positions.len()];
            prepare(in_pieces).add_force(mesh.surface(), &mut forces);
            forces
        });
        assert_same(&found, &expected, &format!("{name}, {place}, piecemeal"));
    }

    fn check_both<T: Real, M: Conservative<T>>(&self, name: &str, method: impl Fn() -> M) {
        let Self(place, mesh) = self;
        let positions = mesh.positions_in::<T>();
        let surface = Surface::new(&mesh.connectivity, &positions).expect("finite");
        let mut expected = vec![[T::zero(); 3]; positions.len()];
        let mut serial = Prepared::new(method(), &mesh.connectivity);
        let energy = serial.add_force_and_energy(surface, &mut expected);
        for execution in threads() {
            let what = format!("{name}, {place}, {execution:?}, at once");
            let mut found = vec![[T::zero(); 3]; positions.len()];
            let connectivity = &mesh.connectivity;
            let mut prepared = Prepared::with_execution(method(), connectivity, execution);
            let both = prepared.add_force_and_energy(surface, &mut found);
            assert_same(&found, &expected, &what);
            assert_same(&both, &energy, &what);
        }
    }
}

impl Law for SameBits<'_> {
    fn check<C: Candidate>(&mut self, candidate: C) {
        let name = candidate.name();
        if self.is_left_out(name) {
            return;
        }
        self.check_in(name, || candidate.method(1.0_f64));
        let mesh = &self.1.connectivity;
        self.check_pieces(name, &mut |in_pieces| match in_pieces {
            false => Box::new(Prepared::new(candidate.method(1.0), mesh)),
            true => Box::new(Prepared::with_execution(
                candidate.method(1.0),
                mesh,
                Piecemeal,
            )),
        });
        // On many vertices f32 runs the same loops.
        if !self.has_many_vertices() {
            self.check_in(name, || candidate.method(1.0_f32));
        }
    }
}

impl ConservativeLaw for SameBits<'_> {
    fn check<C: ConservativeCandidate>(&mut self, candidate: C) {
        let name = ConservativeCandidate::name(candidate);
        if self.is_left_out(name) {
            return;
        }
        self.check_both(name, || ConservativeCandidate::method(candidate, 1.0_f64));
        self.check_both(name, || ConservativeCandidate::method(candidate, 1.0_f32));
    }
}

#[test]
fn every_method_has_the_bits_of_the_serial_loop() {
    let sheet = sheet(6).map(bent);
    let large = large();
    let uneven = uneven();
    let mut meshes: Vec<(&str, &Mesh)> = vec![
        ("sheet", &sheet),
        ("uneven", &uneven),
        ("many vertices", &large),
    ];
    let small = small();
    meshes.extend(small.iter().map(|(name, mesh)| (*name, mesh)));
    for (name, mesh) in meshes {
        let mut law = SameBits(name, mesh);
        for_each(&mut law);
        for_each_conservative(&mut law);
        if mesh.connectivity.is_closed() {
            for_each_potential(&mut law);
        }
        let rest = mesh.map(|[x, y, z]| [1.1 * x, y, 0.9 * z + 0.1 * y]);
        let skalak = Skalak {
            shear_modulus: 5.3,
            area_ratio: 10.0,
        };
        let connectivity = &mesh.connectivity;
        law.check_both("Skalak", || {
            InPlane::new(skalak, connectivity, rest.surface()).expect("a reference with areas")
        });
    }
}

/// Forces of every method are the same in another order of vertices and triangles.
struct Ordered<'a>(&'a Mesh);

impl Law for Ordered<'_> {
    fn check<C: Candidate>(&mut self, candidate: C) {
        self.check_method(&candidate);
    }
}

impl Ordered<'_> {
    fn check_method(&self, candidate: &dyn Subject<f64>) {
        let Self(mesh) = self;
        let order = Reordering::reverse_cuthill_mckee(&mesh.connectivity);
        let connectivity = order.of_mesh(&mesh.connectivity).expect("the same");
        let expected = candidate.forces(1.0, &mesh.connectivity, &mesh.positions);
        let found = candidate.forces(1.0, &connectivity, &order.apply(&mesh.positions));
        let (found, scale) = (order.undo(&found), largest(&expected));
        let pairs = found.as_flattened().iter().zip(expected.as_flattened());
        for (&found, &expected) in pairs {
            REORDERED.assert(found, expected, scale, candidate.name());
        }
    }
}

#[test]
fn every_method_follows_another_order() {
    for_each(&mut Ordered(&icosphere(3).map(bent).relabelled(5).0));
}

#[test]
fn positions_in_pairs_have_the_bits_of_the_serial_loop() {
    let mesh = large();
    let high = mesh.positions_in::<f32>();
    let low: Vec<[f32; 3]> = (0..high.len())
        .map(|v| [0, 1, 2].map(|k| (mesh.positions[v][k] - f64::from(high[v][k])) as f32))
        .collect();
    let surface = Surface::with_remainders(&mesh.connectivity, &high, &low).expect("finite");
    let method = || helfrich::GompperKroll::new(1.0_f32);
    let mut expected = vec![[0.0; 3]; high.len()];
    Prepared::new(method(), &mesh.connectivity).add_force(surface, &mut expected);
    for execution in threads() {
        let mut found = vec![[0.0; 3]; high.len()];
        Prepared::with_execution(method(), &mesh.connectivity, execution)
            .add_force(surface, &mut found);
        assert_same(&found, &expected, &format!("{execution:?}"));
    }
}

#[test]
fn each_slot_is_set_once_and_by_its_number() {
    for execution in threads() {
        for count in [0, 1, 63, 64, 65, 66, 5000] {
            let mut single = vec![0; count];
            let mut triple = vec![0; 3 * count];
            let output = (&mut single[..], Strided::new(&mut triple, 3));
            assert_eq!(output.count(), count);
            // Each entry is slow enough to be worth threads.
            execution.map(output, |k, (single, triple)| {
                let mut sum = 0.0_f64;
                for step in 0..2000 {
                    sum += std::hint::black_box(f64::from(step)).sqrt();
                }
                std::hint::black_box(sum);
                *single += k;
                triple[2] += 2 * k;
            });
            for k in 0..count {
                assert_eq!((single[k], triple[3 * k], triple[3 * k + 2]), (k, 0, 2 * k));
            }
        }
    }
}

#[test]
#[should_panic(expected = "the output has 3 entries")]
fn an_output_that_is_too_short_panics() {
    let (_, mesh) = &small()[0];
    let method = helfrich::GompperKroll::new(1.0);
    Prepared::with_execution(method, &mesh.connectivity, Parallel::new())
        .add_force(mesh.surface(), &mut [[0.0; 3]; 3]);
}

#[test]
fn sums_do_not_depend_on_the_execution() {
    let term = |k: usize| (1.0 + k as f64).recip();
    for execution in threads() {
        assert_eq!(execution.sum(100_000, term), Serial.sum(100_000, term));
    }
}

/// Points at angles all around, at small and at large distances.
fn points() -> impl Iterator<Item = (f64, f64)> {
    let angles = (0..=20_000).map(|k| f64::from(k) * 3.2e-4 - 3.2);
    angles.flat_map(|angle: f64| {
        let (y, x) = angle.sin_cos();
        [1e-150, 1.0, 3e7].map(|radius| (radius * y, radius * x))
    })
}

#[test]
fn arctangents_agree_with_the_library() {
    for (y, x) in points() {
        let (found, known) = (Lane::atan2(y, x), f64::atan2(y, x));
        let bound = 2.0 * f64::EPSILON * known.abs();
        assert!((found - known).abs() <= bound, "{y} {x}");
        if x.hypot(y) < 1e-30 {
            continue;
        }
        let (y, x) = (y as f32, x as f32);
        let known = f64::from(y).atan2(f64::from(x));
        let found = f64::from(Lane::atan2(y, x));
        let bound = 2.0 * f64::from(f32::EPSILON) * known.abs();
        assert!((found - known).abs() <= bound, "{y} {x}, in f32");
    }
}

#[test]
fn arctangents_on_the_axes_and_at_the_origin() {
    use std::f64::consts::{FRAC_PI_2, PI};
    let known = [
        (0.0, 0.0, 0.0),
        (0.0, 1.0, 0.0),
        (0.0, -1.0, PI),
        (-0.0, -1.0, PI),
        (1.0, 0.0, FRAC_PI_2),
        (-2.0, 0.0, -FRAC_PI_2),
        (f64::MIN_POSITIVE, 1.0, f64::MIN_POSITIVE),
    ];
    for (y, x, angle) in known {
        assert_eq!(Lane::atan2(y, x), angle, "{y} {x}");
    }
    assert!(Lane::atan2(f64::NAN, 1.0).is_nan());
    assert!(Lane::atan2(1.0, f64::NAN).is_nan());
}

/// Each part is worked on once, with the others of its share in their order; loops within shares start no threads.
#[test]
fn shares_have_every_part_once() {
    let count = |threads| NonZeroUsize::new(threads).unwrap();
    for (weights, is_divided) in [(vec![2; 9], true), (vec![1, 1, 30, 1], false)] {
        for threads in 1..5 {
            let mut shares = with_threads(count(threads), Shares::default);
            let mut seen = BTreeMap::new();
            // Threads are worth starting once it is known how long the work takes.
            for _ in 0..2 {
                let worked = Mutex::new(Vec::new());
                let parts = weights.iter().copied().zip(0..);
                shares.each(parts, |part: usize| {
                    std::thread::sleep(Duration::from_millis(1));
                    let by = (std::thread::current().id(), available_threads());
                    worked.lock().unwrap().push((part, by));
                });
                let worked = worked.into_inner().unwrap();
                seen.clear();
                for (part, (thread, allowed)) in worked {
                    let last = seen.insert(part, (thread, allowed));
                    assert!(last.is_none(), "{part} twice");
                }
                assert_eq!(seen.len(), weights.len());
            }
            let by = seen.values().map(|(thread, _)| *thread);
            let by = by.collect::<HashSet<_>>().len();
            let expected = if is_divided { threads } else { 1 };
            assert_eq!(by, expected, "{weights:?}, {threads} threads");
            if by > 1 {
                assert!(seen.values().all(|(_, allowed)| *allowed == count(1)));
            }
        }
    }
}

/// The number of threads is set for one piece of work on one thread, and restored after it.
#[test]
fn work_has_the_threads_that_it_is_given() {
    let count = |threads| NonZeroUsize::new(threads).unwrap();
    let all = available_threads();
    with_threads(count(5), || {
        assert_eq!(Parallel::new().threads, count(5));
        with_threads(count(2), || {
            assert_eq!(Parallel::default().threads, count(2))
        });
        assert_eq!(available_threads(), count(5));
        let elsewhere = std::thread::scope(|scope| scope.spawn(available_threads).join());
        assert_eq!(elsewhere.unwrap(), all);
    });
    let panicked = std::panic::catch_unwind(|| with_threads(count(7), || panic!("on purpose")));
    assert!(panicked.is_err());
    assert_eq!(available_threads(), all);
}
