//! Prints how many nodes a second the lattice Boltzmann method updates on a single thread, beside
//! what memory would allow if collisions cost nothing: each of the 19 populations read and written
//! once, in place. Then what a capsule in a box of seven radii takes by each kernel, the forces and
//! velocities in the collisions among it, and what it takes to give the fluid in it another
//! viscosity: each relative to a step of the fluid without it.
//!
//! ```console
//! cargo run --profile bench --example lattice_throughput -- 128
//! ```
//!
//! With the word `fluid` behind the number it ends after the fluid alone.
#![expect(clippy::print_stdout, reason = "the result")]

use helfrich::Surface;
use helfrich_std::flow::lattice_boltzmann::{
    Immersed, Kernel, Lattice, LatticeError, Precision, Setup, Sides,
};
use helfrich_std::generate::{AnyShape, Family, generate};
use std::error::Error;
use std::hint::black_box;
use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

/// Rounds of both measurements, taken in turn; the fastest of each counts.
const ROUNDS: usize = 24;

fn main() -> Result<(), Box<dyn Error>> {
    let edge = std::env::args()
        .nth(1)
        .map_or(Ok(128), |edge| edge.parse())?;
    println!("type  nodes  million updates a second  memory allows  ratio");
    measure::<f64>("f64", edge)?;
    measure::<f32>("f32", edge)?;
    if std::env::args().nth(2).as_deref() == Some("fluid") {
        return Ok(());
    }
    println!(
        "\ntype  kernel  place   spread  interpolate  in collisions  together  inner viscosity"
    );
    share::<f64>("f64", edge)?;
    share::<f32>("f32", edge)?;
    Ok(())
}

fn lattice<T: Precision>(edge: usize) -> Result<Lattice<T>, LatticeError> {
    Lattice::new(Setup {
        cells: [edge; 3],
        sides: [Sides::Periodic; 3],
        viscosity: 1.0 / 6.0,
        inertia: true,
        threads: NonZeroUsize::MIN,
    })
}

fn measure<T: Precision>(name: &str, edge: usize) -> Result<(), Box<dyn Error>> {
    let mut lattice = lattice::<T>(edge)?;
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

/// Times of parts of a step, the least over all rounds.
struct Least<const N: usize>([Duration; N]);

impl<const N: usize> Least<N> {
    fn time<R>(&mut self, part: usize, run: impl FnOnce() -> R) -> R {
        let start = Instant::now();
        let result = run();
        self.0[part] = self.0[part].min(start.elapsed());
        result
    }
}

fn share<T: Precision>(name: &str, edge: usize) -> Result<(), Box<dyn Error>> {
    let shape: AnyShape = "sphere:1".parse()?;
    let (middle, radius) = (0.5 * edge as f64, edge as f64 / 7.0);
    // The ball is as fine as the lattice: its edges are 0.6 to 1.3 node spacings long.
    let vertices = if radius < 8.0 { 642 } else { 2562 };
    let ball = generate(&shape, Family::Regular, vertices, 0)?;
    let positions = ball.positions.iter();
    let positions = Vec::from_iter(positions.map(|x| x.map(|x| middle + radius * x)));
    let surface = Surface::new(&ball.mesh, &positions)?;
    let forces = vec![[1e-6; 3]; positions.len()];
    let mut velocities = vec![[0.0; 3]; positions.len()];
    for (kernel, written) in [
        (Kernel::Two, "two  "),
        (Kernel::Three, "three"),
        (Kernel::Four, "four "),
    ] {
        let mut lattice = lattice::<T>(edge)?;
        let mut free = lattice.clone();
        let mut immersed = Immersed::new(kernel);
        let mut least = Least([Duration::MAX; 6]);
        for _ in 0..ROUNDS {
            least.time(0, || immersed.place(&lattice, &positions))?;
            least.time(1, || {
                lattice.clear_forces();
                immersed.spread(&mut lattice, &forces)
            })?;
            least.time(2, || lattice.set_inner_viscosities(&[(surface, 0.5)]))?;
            lattice.set_inner_viscosities(&[])?;
            least.time(3, || lattice.advance_keeping_velocities());
            least.time(4, || free.advance(1));
            least.time(5, || immersed.interpolate_kept(&lattice, &mut velocities));
        }
        let [place, spread, viscosity, step, free, read] =
            least.0.map(|time| 100.0 * time.as_secs_f64());
        let [place, spread, viscosity, forces, read] =
            [place, spread, viscosity, step - free, read].map(|time| time / free * 100.0);
        println!(
            "{name}   {written}  {place:4.1} %  {spread:4.1} %  {read:9.1} %  {forces:12.1} %  \
             {:6.1} %  {viscosity:13.1} %",
            place + spread + read + forces
        );
    }
    Ok(())
}
