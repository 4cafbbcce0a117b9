//! Loops over elements and vertices on several threads, in wide vectors.
//!
//! The formulas and the loops are the core's. Here they are compiled for processors with AVX2 and for
//! every other, and the choice is made at run time. Nothing is contracted into fused operations:
//! results have the bits of [`Serial`], whatever the processor and the number of threads.

use helfrich::element::{BATCH, ElementKernel, SlotKernel, Slots, check_output, scatter_onto};
use helfrich::{Execution, Real, Serial, Surface};
use pulp::NullaryFnOnce;
use std::num::NonZeroUsize;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Loops on several threads, in vectors of AVX2 where the processor has them.
///
/// Threads are started for each loop that is long enough to be worth it, which no result depends on.
///
/// * Sums over elements: each thread has a range of vertices, and computes the elements around
///   them. Those around vertices of several threads are computed by each: few, where vertices near
///   each other have numbers near each other.
/// * Loops over vertices are cut into ranges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parallel {
    /// Number of threads.
    pub threads: NonZeroUsize,
}

impl Parallel {
    /// As many threads as the process may run at once.
    pub fn new() -> Self {
        Self {
            threads: std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN),
        }
    }

    /// One thread.
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

/// A loop over fewer elements takes less time than it takes to start a thread.
const FEWEST_ELEMENTS: usize = 6000;

/// Threads are worth it as long as each computes no more than this part of all elements.
const MOST_REPEATED: f64 = 0.7;

/// In how many ranges of `size` vertices the elements are that a loop takes up together, on average:
/// by some dozens of them.
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

/// Slots of a loop that are done before it is decided whether the others are worth a thread.
const FIRST_SLOTS: usize = 64;

/// Work that is worth starting a thread for.
const WORTH_A_THREAD: Duration = Duration::from_micros(150);

/// Runs `work(k)` for k in 0 … `count` − 1, each on a thread of its own, the first on this one. It is
/// compiled once, whatever the work.
fn on_threads(count: usize, work: &(dyn Fn(usize) + Sync)) {
    std::thread::scope(|scope| {
        for k in 1..count {
            scope.spawn(move || work(k));
        }
        work(0);
    });
}

/// Runs `work` for each part, the first on this thread.
fn share<P: Send>(parts: Vec<P>, work: &(dyn Fn(P) + Sync)) {
    let parts: Vec<_> = parts.into_iter().map(|p| Mutex::new(Some(p))).collect();
    on_threads(parts.len(), &|k| {
        let mut part = parts[k].lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(part) = part.take() {
            work(part);
        }
    });
}

/// Runs a task, compiled for AVX2 where the processor has it, as [`Parallel`] runs its loops.
///
/// On processors with AVX-512, too: code that compilers make for it is slower for jets and patches,
/// and hardly faster elsewhere.
// Not inlined: with one thread and with several, it is the same code.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
#[inline(never)]
pub fn dispatch(task: impl NullaryFnOnce<Output = ()>) {
    match pulp::x86::V3::try_new() {
        Some(avx2) => avx2.vectorize(task),
        None => task.call(),
    }
}

/// Runs a task in the vectors of the target, as [`Parallel`] runs its loops.
#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
#[inline(never)]
pub fn dispatch(task: impl NullaryFnOnce<Output = ()>) {
    pulp::Arch::new().dispatch(task);
}

/// [`scatter_onto`] as a task: a closure would not be inlined for certain.
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

/// Slots in a row, as a task.
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
        let threads = self.threads.get().min(elements.len() / FEWEST_ELEMENTS);
        if threads <= 1 {
            return onto((0, output));
        }
        let size = vertices.div_ceil(threads);
        // Numbered as they come, most elements would be computed by every thread.
        if mean_parts(elements, size) > MOST_REPEATED * threads as f64 {
            return onto((0, output));
        }
        let parts = output[..vertices].chunks_mut(size).enumerate();
        share(parts.map(|(k, part)| (k * size, part)).collect(), &onto);
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
        let run = |(scratch, start, slots): (&mut S, usize, O)| {
            dispatch(Run {
                kernel,
                scratch,
                start,
                slots,
            });
        };
        let count = output.count();
        if self.threads.get() == 1 || count <= FIRST_SLOTS {
            return run((&mut scratches[0], 0, output));
        }
        let (first, rest) = output.split_at(FIRST_SLOTS);
        let start = Instant::now();
        run((&mut scratches[0], 0, first));
        let left = count - FIRST_SLOTS;
        let expected = start.elapsed().as_secs_f64() * (left as f64 / FIRST_SLOTS as f64);
        let worth = (expected / WORTH_A_THREAD.as_secs_f64()) as usize;
        let threads = self.threads.get().min(worth);
        if threads <= 1 {
            return run((&mut scratches[0], FIRST_SLOTS, rest));
        }
        if scratches.len() < threads {
            scratches.resize_with(threads, S::default);
        }
        let size = left.div_ceil(threads);
        let mut parts = Vec::with_capacity(threads);
        let (mut start, mut rest) = (FIRST_SLOTS, Some(rest));
        for scratch in scratches.iter_mut() {
            let Some(slots) = rest.take() else {
                break;
            };
            if count - start <= size {
                parts.push((scratch, start, slots));
            } else {
                let (part, others) = slots.split_at(size);
                parts.push((scratch, start, part));
                (start, rest) = (start + size, Some(others));
            }
        }
        share(parts, &run);
    }

    fn sum<T: Real>(&self, count: usize, term: impl Fn(usize) -> T + Sync) -> T {
        // What is added up here is known at each vertex: it takes less time than a thread.
        Serial.sum(count, term)
    }
}
