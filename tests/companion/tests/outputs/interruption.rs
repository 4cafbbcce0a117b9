//! Work that is asked to end early.

use helfrich::{AdaptiveJet, Execution, Surface};
use helfrich_std::execute::{
    Interruption, Parallel, SLICE, interruptible, unless_interrupted, with_threads,
};
use helfrich_std::generate::{Family, GeneratedMesh, generate};
use helfrich_std::measurement::Measurement;
use helfrich_std::method::{BendingMethod, Evaluator, Fields};
use std::cell::Cell;
use std::num::NonZeroUsize;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

fn parallel(threads: usize) -> Parallel {
    Parallel {
        threads: NonZeroUsize::new(threads).expect("a thread or more"),
    }
}

/// After a request every thread completes its slice of a loop, and no more.
#[test]
fn a_loop_ends_with_the_slices_under_way() {
    for threads in [1, 2, 5] {
        let flag = Arc::new(AtomicBool::new(false));
        let done = AtomicUsize::new(0);
        let mut slots = vec![0_u64; 1_000_000];
        let ended = interruptible(Interruption::by_flag(Arc::clone(&flag)), || {
            parallel(threads).map(&mut slots[..], |slot, entry| {
                *entry = (0..50).fold(slot as u64, |sum, k| sum ^ (sum << 7).wrapping_add(k));
                if done.fetch_add(1, Ordering::Relaxed) == 100_000 {
                    flag.store(true, Ordering::Relaxed);
                }
            });
        });
        let done = done.into_inner();
        assert!(ended.is_none());
        assert!(
            (100_001..100_001 + threads * SLICE).contains(&done),
            "{threads}: {done}"
        );
    }
}

/// Runs `work`, which is asked to end at this look for a request; returns its result and the number of looks.
fn with_looks<R>(end: usize, work: impl FnOnce() -> R) -> (Option<R>, usize) {
    let looks = Rc::new(Cell::new(0));
    let own = Rc::clone(&looks);
    let look = move || {
        own.set(own.get() + 1);
        own.get() == end
    };
    let result = interruptible(Interruption::by_look(look), work);
    (result, looks.get())
}

/// Work looks for a request once for each slice of the vertices and more often, has the same result if there
/// is none, and does no more after there was one.
#[track_caller]
fn check<R: PartialEq>(name: &str, vertices: usize, work: &dyn Fn() -> R) {
    let threads = NonZeroUsize::MIN;
    let work = || with_threads(threads, work);
    let plain = work();
    let (whole, looks) = with_looks(usize::MAX, work);
    assert!(whole.is_some_and(|whole| whole == plain), "{name}");
    assert!(looks >= vertices / SLICE, "{name}: {looks} looks");
    for end in [1, looks / 2, looks] {
        let (ended, looks) = with_looks(end, work);
        assert!(ended.is_none() && looks == end, "{name}: {looks}, {end}");
    }
}

/// Fields as bits, because NaN is not equal to itself.
fn bits(fields: &Fields<f64>) -> Vec<u64> {
    let values = fields
        .mean
        .iter()
        .chain(&fields.gaussian)
        .map(|value| value.map(f64::to_bits));
    let densities = fields.force_density.iter().flatten().flatten();
    let densities = densities.map(|component| Some(component.to_bits()));
    values
        .chain(densities)
        .map(|bits| bits.unwrap_or(1))
        .collect()
}

#[test]
fn every_method_and_the_measurement_can_be_interrupted() {
    let shape = "discocyte".parse().expect("a shape");
    let made = generate(&shape, Family::Irregular, 2562, 1).expect("a mesh");
    let GeneratedMesh {
        mesh, positions, ..
    } = &made;
    let surface = Surface::new(mesh, positions).expect("finite positions");
    for method in BendingMethod::NAMED {
        check(method.name(), 2562, &|| {
            bits(&Evaluator::new(method, 1.0, mesh).fields(surface))
        });
    }
    check("measurement", 2562, &|| {
        let measured = Measurement::new(surface, &AdaptiveJet::default(), &mut |_| true);
        bits(&measured.expect("nobody watches").fields(1.0))
    });
}

/// A part that is interrupted ends the part only; panics are not mistaken for requests.
#[test]
fn parts_end_by_themselves() {
    let flag = Arc::new(AtomicBool::new(true));
    let both = interruptible(Interruption::by_flag(flag), || {
        let part = || parallel(1).map(&mut [0; 3][..], |_, _| {});
        (unless_interrupted(part), 1)
    });
    assert_eq!(both, Some((None, 1)));
    let panics = std::panic::catch_unwind(|| {
        interruptible(Interruption::default(), || {
            std::panic::resume_unwind(Box::new(7))
        })
    });
    assert!(panics.is_err_and(|payload| payload.downcast_ref() == Some(&7)));
    // Nobody asks outside.
    parallel(1).map(&mut [0; 3][..], |_, _| {});
}
