//! Peak rates of the processor, in the vectors of the loops and without fused operations, which
//! these loops do not use because they would change bits.

use crate::counted::Operations;
use helfrich_execute::execute::dispatch;
use pulp::NullaryFnOnce;
use std::hint::black_box;
use std::time::Instant;

/// Nanoseconds an operation takes, in f64 and in f32.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Peak {
    fast: [f64; 2],
    slow: [f64; 2],
}

/// Numbers that are computed with: as many as hide latencies, and few enough for registers.
const NUMBERS: usize = 32;

/// Steps of one measurement.
const STEPS: usize = 20_000;

macro_rules! loops {
    ($fast:ident $slow:ident $scalar:ty) => {
        struct $fast;
        impl NullaryFnOnce for $fast {
            type Output = ();
            #[inline(always)]
            fn call(self) {
                let mut numbers: [$scalar; NUMBERS] = black_box([1.0; NUMBERS]);
                let (factor, term): ($scalar, $scalar) = black_box((0.999, 0.001));
                for _ in 0..STEPS {
                    for number in &mut numbers {
                        *number = *number * factor + term;
                    }
                }
                black_box(numbers);
            }
        }
        struct $slow;
        impl NullaryFnOnce for $slow {
            type Output = ();
            #[inline(always)]
            fn call(self) {
                let mut numbers: [$scalar; NUMBERS] = black_box([1.5; NUMBERS]);
                for _ in 0..STEPS {
                    for number in &mut numbers {
                        *number = (1.0 / *number).sqrt();
                    }
                }
                black_box(numbers);
            }
        }
    };
}
loops!(FastDouble SlowDouble f64);
loops!(FastSingle SlowSingle f32);

fn least<Op: NullaryFnOnce<Output = ()>>(task: impl Fn() -> Op) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..15 {
        let start = Instant::now();
        dispatch(task());
        least = least.min(start.elapsed().as_secs_f64());
    }
    // Two operations a number and step.
    1e9 * least / (2 * NUMBERS * STEPS) as f64
}

impl Peak {
    pub(crate) fn measure() -> Self {
        Self {
            fast: [least(|| FastDouble), least(|| FastSingle)],
            slow: [least(|| SlowDouble), least(|| SlowSingle)],
        }
    }

    /// The least time of these operations in nanoseconds: sums and products beside quotients and
    /// roots, which other units of the processor compute.
    pub(crate) fn bound(self, done: Operations, single: bool) -> f64 {
        let kind = usize::from(single);
        let fast = done.fast as f64 * self.fast[kind];
        fast.max(done.slow as f64 * self.slow[kind])
    }
}
