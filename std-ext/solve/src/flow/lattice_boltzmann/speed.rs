//! The speed of a lattice on this machine.

use super::{Immersed, Kernel, Lattice, LatticeError, Precision, Setup};
use std::f64::consts::PI;
use std::time::{Duration, Instant};

/// Duration of each measurement.
const TRIAL: Duration = Duration::from_millis(100);

/// The speed of a lattice on this machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speed {
    /// Number of nodes that are updated per second.
    pub nodes: f64,
    /// Seconds to place all points once, to spread forces from them and to interpolate velocities at
    /// them.
    pub coupling: f64,
}

/// Measures fluid at rest, and its coupling to as many points on a sphere half as wide as the box.
/// This takes a quarter of a second.
///
/// # Errors
/// If a parameter is impossible, or there is not enough memory.
pub fn measure_speed<T: Precision>(
    setup: Setup,
    kernel: Kernel,
    points: usize,
) -> Result<Speed, LatticeError> {
    T::measure_speed(setup, kernel, points)
}

/// The measurement, compiled in the crate that calls this.
pub(super) fn measure_here<T: Precision>(
    setup: Setup,
    kernel: Kernel,
    count: usize,
) -> Result<Speed, LatticeError> {
    let cells = setup.cells;
    let mut fluid = Lattice::<T>::new(setup)?;
    // The points are distributed evenly, on a spiral with the golden angle.
    let spiral = |index: usize| {
        let z = 1.0 - (2 * index + 1) as f64 / count as f64;
        let turn = index as f64 * PI * (3.0 - 5.0_f64.sqrt());
        let across = (1.0 - z * z).sqrt();
        let point = [across * turn.cos(), across * turn.sin(), z];
        std::array::from_fn(|axis| cells[axis] as f64 * (0.5 + 0.25 * point[axis]))
    };
    let points = Vec::from_iter((0..count).map(spiral));
    let forces = vec![[0.0; 3]; count];
    let mut velocities = vec![[0.0; 3]; count];
    let mut immersed = Immersed::new(kernel);
    let mut rounds = 0;
    immersed.place(&fluid, &points)?;
    immersed.spread(&mut fluid, &forces)?;
    fluid.advance_keeping_velocities();
    let start = Instant::now();
    while start.elapsed() < TRIAL {
        immersed.place(&fluid, &points)?;
        fluid.clear_forces();
        immersed.spread(&mut fluid, &forces)?;
        immersed.interpolate_kept(&fluid, &mut velocities);
        rounds += 1;
    }
    let coupling = start.elapsed().as_secs_f64() / f64::from(rounds);
    let start = Instant::now();
    let mut steps = 0;
    while start.elapsed() < TRIAL {
        // One even and one odd step, because their memory access differs.
        for _ in 0..2 {
            fluid.advance_keeping_velocities();
        }
        steps += 2;
    }
    let updates = cells.iter().product::<usize>() as f64 * f64::from(steps);
    Ok(Speed {
        nodes: updates / start.elapsed().as_secs_f64(),
        coupling,
    })
}
