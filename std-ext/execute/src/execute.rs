//! Loops over elements and vertices on several threads, in wide vectors.
//!
//! The formulas and loops are those of the core. Here they are compiled for AVX2 and for baseline
//! vectors, and one version is selected at run time. No operations are fused, so that results have
//! the bits of [`Serial`] for any processor and number of threads.

mod interruption;
mod shares;

pub use interruption::{
    Interruption, SLICE, interruptible, look_for_interruption, unless_interrupted,
};

pub use shares::Shares;

use helfrich::element::{BATCH, ElementKernel, SlotKernel, Slots, check_output, scatter_onto};
use helfrich::{Execution, Real, Serial, Surface};
use interruption::Loop;
use pulp::NullaryFnOnce;
use std::cell::Cell;
use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

/// Execution of loops on several threads, in AVX2 vectors where the processor has them.
///
/// Threads are started only for loops that are long enough; no result depends on this.
///
/// * Sums over elements: each thread has a range of vertices and computes the elements around these. Elements
///   with vertices of several threads are computed by each of them; there are few if nearby vertices have
///   nearby numbers.
/// * Loops over vertices are divided into ranges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parallel {
    /// Number of threads.
    pub threads: NonZeroUsize,
}

thread_local! {
    /// The number of threads that [`with_threads`] allows.
    static ALLOWED: Cell<Option<NonZeroUsize>> = const { Cell::new(None) };
}

/// Whether the target can start threads: WebAssembly in a browser cannot, and need not have the code for it.
const HAS_THREADS: bool = !cfg!(target_family = "wasm");

/// Number of threads that [`with_threads`] allows here; outside of it, the number that the process may run at
/// once.
pub fn available_threads() -> NonZeroUsize {
    let all = || std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    ALLOWED.get().unwrap_or_else(all)
}

/// Runs `work` so that every [`Parallel`] and every run of a scene in it uses at most this number of threads.
///
/// The number applies to `work` on the calling thread only, so that several threads can share a machine.
/// No result depends on it.
pub fn with_threads<R>(threads: NonZeroUsize, work: impl FnOnce() -> R) -> R {
    /// Restores the previous number, also when `work` panics.
    struct Restored(Option<NonZeroUsize>);
    impl Drop for Restored {
        fn drop(&mut self) {
            ALLOWED.set(self.0);
        }
    }
    let _restored = Restored(ALLOWED.replace(Some(threads)));
    work()
}

impl Parallel {
    /// Execution on all available threads: see [`available_threads`].
    pub fn new() -> Self {
        Self {
            threads: available_threads(),
        }
    }

    /// Its number of threads, or what [`with_threads`] allows here.
    fn allowed(self) -> NonZeroUsize {
        ALLOWED
            .get()
            .map_or(self.threads, |most| most.min(self.threads))
    }

    /// Execution on one thread.
    pub fn single() -> Self {
        Self {
            threads: NonZeroUsize::MIN,
        }
    }
}

impl Default for Parallel {
    fn default() -> Self {
        Self::new()
    }
}

/// Smallest number of elements per thread for which a thread is worth starting.
const FEWEST_ELEMENTS: usize = 6000;

/// Largest fraction of all elements per thread with which threads are worth starting.
const MOST_REPEATED: f64 = 0.7;

/// Average number of ranges of `size` vertices in which an element has corners, estimated from a
/// few dozen elements.
fn mean_parts<const CORNERS: usize>(elements: &[[u32; CORNERS]], size: usize) -> f64 {
    const SAMPLES: usize = 64;
    let batches = elements
        .chunks(BATCH)
        .step_by((elements.len() / BATCH / SAMPLES).max(1));
    let count = batches.len();
    let parts = batches.map(|batch| {
        let mut parts: Vec<usize> = batch.iter().flatten().map(|&v| v as usize / size).collect();
        parts.sort_unstable();
        parts.dedup();
        parts.len()
    });
    parts.sum::<usize>() as f64 / count.max(1) as f64
}

/// Number of slots of a loop that are timed before deciding whether to start threads.
const FIRST_SLOTS: usize = 64;

/// Duration of work that is worth starting a thread.
const WORTH_A_THREAD: Duration = Duration::from_micros(150);

/// A share of a loop.
type Task<'a> = Box<dyn FnOnce() + Send + 'a>;

/// Runs every task on a thread of its own, the first on this one. The function is not generic over the tasks,
/// so that it is compiled once.
fn on_threads<'a>(next: &mut dyn FnMut() -> Option<Task<'a>>) {
    std::thread::scope(|scope| {
        let first = next();
        while let Some(task) = next() {
            scope.spawn(task);
        }
        if let Some(task) = first {
            task();
        }
    });
}

/// Runs `work` for each part, the first on this thread and every other one on a thread of its own.
///
/// # Panics
/// If `work` does.
pub fn in_parts<P: Send>(mut parts: impl Iterator<Item = P>, work: &(impl Fn(P) + Sync)) {
    if !HAS_THREADS {
        return parts.for_each(work);
    }
    on_threads(&mut || {
        let part = parts.next()?;
        Some(Box::new(move || work(part)))
    });
}

/// The results of both, on two threads where there are two; each receives its share of the threads.
///
/// # Panics
/// If one of them does.
pub fn in_two<T: Send>(
    threads: usize,
    one: impl FnOnce(usize) -> T + Send,
    other: impl FnOnce(usize) -> T + Send,
) -> [T; 2] {
    if threads < 2 {
        return [one(1), other(1)];
    }
    let (mut first, mut second) = (None, None);
    let tasks: [Task<'_>; 2] = [
        Box::new(|| second = Some(other(threads - threads / 2))),
        Box::new(|| first = Some(one(threads / 2))),
    ];
    in_parts(tasks.into_iter(), &|task: Task<'_>| task());
    [first, second].map(|result| result.expect("both have run"))
}

/// Number of threads that are worth starting for slots of which the first [`FIRST_SLOTS`] took this time.
fn worthwhile(threads: NonZeroUsize, first: Duration, left: usize) -> usize {
    let expected = first.as_secs_f64() * (left as f64 / FIRST_SLOTS as f64);
    let worth = (expected / WORTH_A_THREAD.as_secs_f64()) as usize;
    threads.get().min(worth)
}

/// Divides slots into consecutive parts, each with a scratch and the number of its first slot.
struct Parts<'a, S, O> {
    scratches: std::slice::IterMut<'a, S>,
    start: usize,
    slots: Option<O>,
    /// The largest number of slots of a part.
    size: usize,
}

impl<'a, S, O: Slots> Iterator for Parts<'a, S, O> {
    type Item = (&'a mut S, usize, O);

    fn next(&mut self) -> Option<Self::Item> {
        let scratch = self.scratches.next()?;
        let mut slots = self.slots.take()?;
        let start = self.start;
        if slots.count() > self.size {
            let (part, others) = slots.split_at(self.size);
            slots = part;
            self.start += self.size;
            self.slots = Some(others);
        }
        Some((scratch, start, slots))
    }
}

/// Runs a task compiled for AVX2 where the processor has it, as [`Parallel`] runs its loops.
///
/// Processors with AVX-512 also use AVX2, because AVX-512 code from compilers is slower for jets
/// and patches and hardly faster elsewhere.
// Not inlined, so that one thread and several threads run the same code.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
#[inline(never)]
pub fn dispatch(task: impl NullaryFnOnce<Output = ()>) {
    match pulp::x86::V3::try_new() {
        Some(avx2) => avx2.vectorize(task),
        None => task.call(),
    }
}

/// Runs a task in the vectors of the target, as [`Parallel`] runs its loops. WebAssembly has those for which it was
/// compiled.
#[cfg(target_family = "wasm")]
#[inline(never)]
pub fn dispatch(task: impl NullaryFnOnce<Output = ()>) {
    task.call();
}

/// Runs a task in the vectors of the target, as [`Parallel`] runs its loops.
#[cfg(not(any(target_arch = "x86", target_arch = "x86_64", target_family = "wasm")))]
#[inline(never)]
pub fn dispatch(task: impl NullaryFnOnce<Output = ()>) {
    pulp::Arch::new().dispatch(task);
}

/// [`scatter_onto`] as a task; a closure might not be inlined.
struct Scatter<'a, T, K, const CORNERS: usize, const IN: usize, const OUT: usize> {
    kernel: &'a K,
    surface: Surface<'a, T>,
    elements: &'a [[u32; CORNERS]],
    input: &'a [[T; IN]],
    start: usize,
    output: &'a mut [[T; OUT]],
}

impl<T, K, const CORNERS: usize, const IN: usize, const OUT: usize> NullaryFnOnce
    for Scatter<'_, T, K, CORNERS, IN, OUT>
where
    T: Real,
    K: ElementKernel<T, CORNERS, IN, OUT>,
{
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let Self {
            kernel,
            surface,
            elements,
            input,
            start,
            output,
        } = self;
        scatter_onto(kernel, surface, elements, input, start, output);
    }
}

/// Loop over consecutive slots, as a task.
struct Run<'a, S, O, K> {
    kernel: &'a K,
    scratch: &'a mut S,
    start: usize,
    slots: O,
}

impl<S, O: Slots, K: SlotKernel<S, O>> NullaryFnOnce for Run<'_, S, O, K> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        self.kernel.set(self.scratch, self.start, self.slots);
    }
}

impl Execution for Parallel {
    fn scatter<T, K, const CORNERS: usize, const IN: usize, const OUT: usize>(
        &self,
        kernel: &K,
        surface: Surface<'_, T>,
        elements: &[[u32; CORNERS]],
        input: &[[T; IN]],
        output: &mut [[T; OUT]],
    ) where
        T: Real,
        K: ElementKernel<T, CORNERS, IN, OUT>,
    {
        check_output(surface, output);
        look_for_interruption();
        let onto = |(start, output): (usize, &mut [[T; OUT]])| {
            dispatch(Scatter {
                kernel,
                surface,
                elements,
                input,
                start,
                output,
            });
        };
        let vertices = surface.positions().len();
        let threads = self.allowed().get().min(elements.len() / FEWEST_ELEMENTS);
        if !HAS_THREADS || threads <= 1 {
            return onto((0, output));
        }
        let size = vertices.div_ceil(threads);
        // With an unordered mesh, every thread would compute most elements.
        if mean_parts(elements, size) > MOST_REPEATED * threads as f64 {
            return onto((0, output));
        }
        let parts = output[..vertices].chunks_mut(size).enumerate();
        in_parts(parts.map(|(k, part)| (k * size, part)), &onto);
    }

    fn run<S: Default + Send, O: Slots>(
        &self,
        scratches: &mut Vec<S>,
        output: O,
        kernel: &impl SlotKernel<S, O>,
    ) {
        if scratches.is_empty() {
            scratches.push(S::default());
        }
        let own = Loop::here();
        let run = |(scratch, start, slots): (&mut S, usize, O)| {
            own.for_slices(start, slots, |start, slots| {
                dispatch(Run {
                    kernel,
                    scratch: &mut *scratch,
                    start,
                    slots,
                });
            });
        };
        self.divide(scratches, output, &run);
        look_for_interruption();
    }

    fn sum<T: Real>(&self, count: usize, term: impl Fn(usize) -> T + Sync) -> T {
        // The terms are already known at each vertex: adding them takes less time than starting a thread.
        Serial.sum(count, term)
    }
}

impl Parallel {
    /// Calls `run` with all slots, divided among as many threads as are worth starting.
    fn divide<S: Default + Send, O: Slots>(
        self,
        scratches: &mut Vec<S>,
        output: O,
        run: &(impl Fn((&mut S, usize, O)) + Sync),
    ) {
        let count = output.count();
        let threads = self.allowed();
        if !HAS_THREADS || threads.get() == 1 || count <= FIRST_SLOTS {
            return run((&mut scratches[0], 0, output));
        }
        let (first, rest) = output.split_at(FIRST_SLOTS);
        let start = Instant::now();
        run((&mut scratches[0], 0, first));
        let left = count - FIRST_SLOTS;
        let threads = worthwhile(threads, start.elapsed(), left);
        if threads <= 1 {
            return run((&mut scratches[0], FIRST_SLOTS, rest));
        }
        if scratches.len() < threads {
            scratches.resize_with(threads, S::default);
        }
        let parts = Parts {
            scratches: scratches.iter_mut(),
            start: FIRST_SLOTS,
            slots: Some(rest),
            size: left.div_ceil(threads),
        };
        in_parts(parts, run);
    }
}
