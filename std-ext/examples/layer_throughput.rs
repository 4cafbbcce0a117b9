//! Prints what one evaluation of the single layer takes on icospheres: over all pairs, on one thread and
//! on all, and how many pairs of vertices and far sources (middles of edges) a second that is, all
//! corrections of near triangles included, beside what one division and one square root a pair allow by
//! themselves; then over clusters, with the error relative to a force in one direction.
//!
//! ```console
//! cargo run --profile bench --example layer_throughput
//! ```
#![expect(clippy::print_stdout, reason = "the result")]

use helfrich_std::flow::SingleLayer;
use helfrich_std::generate::{AnyShape, Family, generate};
use std::error::Error;
use std::hint::black_box;
use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

/// Rounds, of which the fastest counts.
const ROUNDS: usize = 3;

/// Tolerance of sums over clusters.
const TOLERANCE: f64 = 1e-4;

/// More vertices than these are summed over clusters only.
const MOST_PAIRS: usize = 50_000;

fn main() -> Result<(), Box<dyn Error>> {
    let all = std::thread::available_parallelism()?;
    println!(
        "triangles  pairs: ms on 1 thread  on {all}  G pairs/s on 1  allowed  ratio  \
         clusters: ms on 1 thread  on {all}  error"
    );
    let sphere: AnyShape = "sphere:1".parse()?;
    for vertices in [642, 2562, 10_242, 40_962, 163_842] {
        let made = generate(&sphere, Family::Regular, vertices, 1)?;
        let evaluate = |tolerance, threads| {
            let mut layer = SingleLayer::new([&made.mesh], 1.0, threads);
            layer.set_cluster_tolerance(tolerance);
            // The first time is for memory.
            let mut best = Duration::MAX;
            let mut velocity = vec![[0.0; 3]; vertices];
            for _ in 0..2 {
                velocity.fill([0.0; 3]);
                let start = Instant::now();
                layer.set_tractions(&made.positions, &vec![[1.0, 0.0, 0.0]; vertices]);
                layer.add_at_vertices(&mut velocity);
                best = start.elapsed().min(best);
            }
            (best, velocity)
        };
        let pairs = vertices * made.mesh.edges().len();
        let dense = vertices < MOST_PAIRS;
        let [mut one, mut many, mut bound] = [Duration::MAX; 3];
        let [mut clusters, mut many_clusters] = [Duration::MAX; 2];
        let mut error = f64::NAN;
        for _ in 0..ROUNDS {
            let found = evaluate(TOLERANCE, NonZeroUsize::MIN);
            clusters = clusters.min(found.0);
            many_clusters = many_clusters.min(evaluate(TOLERANCE, all).0);
            if dense {
                let exact = evaluate(0.0, NonZeroUsize::MIN);
                one = one.min(exact.0);
                many = many.min(evaluate(0.0, all).0);
                error = relative(&found.1, &exact.1);
                let start = Instant::now();
                pulp::Arch::new().dispatch(|| divide_and_root(pairs));
                bound = start.elapsed().min(bound);
            }
        }
        let milliseconds = |time: Duration| 1e3 * time.as_secs_f64();
        let rate = |time: Duration| pairs as f64 / time.as_secs_f64() / 1e9;
        let triangles = made.mesh.triangles().len();
        if dense {
            print!(
                "{triangles:9}  {:21.2}  {:4.2}  {:14.2}  {:7.2}  {:5.2}",
                milliseconds(one),
                milliseconds(many),
                rate(one),
                rate(bound),
                rate(one) / rate(bound)
            );
        } else {
            print!("{triangles:9}{:59}", "");
        }
        print!(
            "  {:24.2}  {:4.2}",
            milliseconds(clusters),
            milliseconds(many_clusters)
        );
        println!(
            "{}",
            if dense {
                format!("  {error:.0e}")
            } else {
                String::new()
            }
        );
    }
    Ok(())
}

/// The root mean square of the difference over that of the second field.
fn relative(found: &[[f64; 3]], exact: &[[f64; 3]]) -> f64 {
    let squares = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>();
    let pairs = found.as_flattened().iter().zip(exact.as_flattened());
    let error = squares(&mut pairs.map(|(a, b)| a - b));
    (error / squares(&mut exact.as_flattened().iter().copied())).sqrt()
}

/// Computes as many divisions and square roots as there are pairs, on numbers in the first-level cache.
#[inline(always)]
fn divide_and_root(pairs: usize) {
    let mut numbers = [1.5; 512];
    for _ in 0..pairs / numbers.len() {
        for number in black_box(&mut numbers) {
            let x: f64 = *number;
            *number = x.sqrt() + x.recip();
        }
    }
    black_box(&numbers);
}
