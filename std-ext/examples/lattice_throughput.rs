//! Prints how many nodes a second the lattice Boltzmann method updates on a single thread, beside
//! what memory would allow if collisions cost nothing: each of the 19 populations read and written
//! once, in place.
//!
//! ```console
//! cargo run --release --example lattice_throughput -- 128
//! ```
#![expect(clippy::print_stdout, reason = "the result")]

use helfrich_std::flow::lattice_boltzmann::{Lattice, Precision, Setup, Sides};
use std::error::Error;
use std::hint::black_box;
use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

/// Rounds of both measurements, taken in turn; the fastest of each counts.
const ROUNDS: usize = 9;

fn main() -> Result<(), Box<dyn Error>> {
    let edge = std::env::args()
        .nth(1)
        .map_or(Ok(128), |edge| edge.parse())?;
    println!("type  nodes  million updates a second  memory allows  ratio");
    measure::<f64>("f64", edge)?;
    measure::<f32>("f32", edge)?;
    Ok(())
}

fn measure<T: Precision>(name: &str, edge: usize) -> Result<(), Box<dyn Error>> {
    let mut lattice = Lattice::<T>::new(Setup {
        cells: [edge; 3],
        sides: [Sides::Periodic; 3],
        viscosity: 1.0 / 6.0,
        inertia: true,
        threads: NonZeroUsize::MIN,
    })?;
    let nodes = edge.pow(3);
    let mut bare = vec![T::one(); 19 * nodes];
    let factor = T::constant(0.999);
    let (mut own, mut bound) = (Duration::MAX, Duration::MAX);
    for _ in 0..ROUNDS {
        let start = Instant::now();
        // One even and one odd.
        lattice.advance(2);
        own = own.min(start.elapsed() / 2);

        let start = Instant::now();
        for value in black_box(&mut bare) {
            *value *= factor;
        }
        bound = bound.min(start.elapsed());
    }
    black_box(lattice.node([0; 3]));
    let rate = |time: Duration| nodes as f64 / time.as_secs_f64() / 1e6;
    println!(
        "{name}   {edge}³   {:24.1}  {:13.1}  {:5.2}",
        rate(own),
        rate(bound),
        rate(own) / rate(bound)
    );
    Ok(())
}
