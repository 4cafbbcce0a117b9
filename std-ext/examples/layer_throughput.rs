//! Prints what one evaluation of the single layer takes on icospheres, on one thread and on all, and
//! how many pairs of vertices and far sources (middles of edges) a second that is, all corrections of
//! near triangles included, beside what one division and one square root a pair allow by themselves.
//!
//! ```console
//! cargo run --release --example layer_throughput
//! ```
#![expect(clippy::print_stdout, reason = "the result")]

use helfrich_std::flow::SingleLayer;
use helfrich_std::generate::{AnyShape, Family, generate};
use std::error::Error;
use std::hint::black_box;
use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

/// Rounds, of which the fastest counts.
const ROUNDS: usize = 15;

fn main() -> Result<(), Box<dyn Error>> {
    let all = std::thread::available_parallelism()?;
    println!("triangles  ms on 1 thread  ms on {all}  G pairs/s on 1  allowed on 1  ratio");
    let sphere: AnyShape = "sphere:1".parse()?;
    for vertices in [642, 2562, 10242] {
        let made = generate(&sphere, Family::Regular, vertices, 1)?;
        let forces = made.positions.clone();
        let mut velocity = vec![[0.0; 3]; vertices];
        let pairs = vertices * made.mesh.edges().len();
        let (mut one, mut many, mut bound) = (Duration::MAX, Duration::MAX, Duration::MAX);
        for _ in 0..ROUNDS {
            for (threads, best) in [(NonZeroUsize::MIN, &mut one), (all, &mut many)] {
                let mut layer = SingleLayer::new([&made.mesh], 1.0, threads);
                // Once for memory.
                layer.set_forces(&made.positions, &forces);
                layer.add_at_vertices(&mut velocity);
                let start = Instant::now();
                layer.set_forces(&made.positions, &forces);
                layer.add_at_vertices(&mut velocity);
                *best = start.elapsed().min(*best);
            }
            let start = Instant::now();
            pulp::Arch::new().dispatch(|| divide_and_root(pairs));
            bound = start.elapsed().min(bound);
        }
        black_box(&velocity);
        let milliseconds = |time: Duration| 1e3 * time.as_secs_f64();
        let rate = |time: Duration| pairs as f64 / time.as_secs_f64() / 1e9;
        println!(
            "{:9}  {:14.2}  {:7.2}  {:14.2}  {:12.2}  {:5.2}",
            made.mesh.triangles().len(),
            milliseconds(one),
            milliseconds(many),
            rate(one),
            rate(bound),
            rate(one) / rate(bound)
        );
    }
    Ok(())
}

/// As many divisions and square roots as there are pairs, on numbers in the first cache.
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
