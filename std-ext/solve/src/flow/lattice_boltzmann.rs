//! The lattice Boltzmann method: viscous fluid with inertia in a box, with walls, obstacles and
//! membranes.
//!
//! Everything is in lattice units: the distance of nodes, the time of a step and the density at
//! rest are 1, and the speed of sound is 1/√3. [`Units`] converts. Node (i, j, k) is at
//! (i + ½, j + ½, k + ½); a box of n cells reaches from 0 to n, and that is where its walls are.
//!
//! Nineteen populations per node (D3Q19) relax with two relaxation times, Λ = 3/16. The equilibrium
//! is of second order in the velocity, or of first order for Stokes flow. The fluid is slightly
//! compressible: the density deviates from 1 by 3 times the pressure. The error is of second order
//! in the distance of nodes, and in the Mach number. [`limits`] has the longest steps for membranes.
//!
//! T. Krüger et al., The Lattice Boltzmann Method, Springer 2017.

mod boundary;
mod collision;
mod error;
mod force;
mod immersed;
pub mod limits;
mod obstacle;
mod ranks;
mod reading;
mod setup;
mod speed;
mod stencil;
mod units;
mod viscosity;
mod voxel;

pub use error::LatticeError;
pub use immersed::{Immersed, Kernel};
pub use reading::Node;
pub use setup::{Setup, Sides};
pub use speed::{Speed, measure_speed};
pub use units::{Units, mach, memory, reynolds};

use super::vectors::Vectors;
use boundary::Links;
use collision::{Fluid, Slab};
use force::{NodalForces, NodalVelocities};
use helfrich_execute::execute::in_parts;
use helfrich_execute::team::Team;
use pulp::Arch;
use ranks::RankPlanes;
use serde::{Deserialize, Serialize};
use std::array;
use stencil::{Layout, Q, VELOCITIES, along, opposite, weight, wrapped};
use viscosity::NodalViscosities;

/// The numbers that a lattice computes with: `f32` and `f64`.
///
/// Populations are stored as deviations from rest, so that rounding in `f32` is 6·10⁻⁸ of the
/// deviations.
///
/// Its functions are long loops, compiled in this crate for both types, so that their speed does
/// not depend on how a crate that calls them is optimised.
pub trait Precision: Vectors {
    /// [`Lattice::advance`] by one step; keeps the velocities at its start, if asked to.
    fn step(lattice: &mut Lattice<Self>, keep_velocities: bool);

    /// [`measure_speed`].
    ///
    /// # Errors
    /// As there.
    fn measure_speed(setup: Setup, kernel: Kernel, points: usize) -> Result<Speed, LatticeError>;
}

macro_rules! precision {
    ($($number:ty),*) => {$(
        impl Precision for $number {
            fn step(lattice: &mut Lattice<Self>, keep_velocities: bool) {
                lattice.step_here(keep_velocities);
            }

            fn measure_speed(
                setup: Setup,
                kernel: Kernel,
                points: usize,
            ) -> Result<Speed, LatticeError> {
                speed::measure_here::<Self>(setup, kernel, points)
            }
        }
    )*};
}

precision!(f32, f64);

fn number<T: Precision>(value: T) -> f64 {
    value.to_f64().unwrap_or(f64::NAN)
}

/// The state that changes from step to step. A lattice of the same setup, forces, viscosities and
/// obstacles continues from it bit for bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State<T> {
    cells: [usize; 3],
    steps: u64,
    populations: Vec<T>,
}

/// Fluid on the nodes of a box.
///
/// Only one copy of the populations is stored. A step reads and writes each population in the same
/// place (pattern "AA"), so that threads can work on separate planes.
#[derive(Clone, Debug)]
pub struct Lattice<T> {
    setup: Setup,
    layout: Layout,
    parts: RankPlanes,
    state: State<T>,
    force: [f64; 3],
    forces: Option<NodalForces<T>>,
    /// The velocities at the start of the last step, if they were kept.
    velocities: Option<NodalVelocities<T>>,
    viscosities: Option<NodalViscosities<T>>,
    /// For each node the surface that it lies in, 0 in the fluid.
    labels: Option<Vec<u16>>,
    obstacles: usize,
    links: Links<T>,
}

impl<T: Precision> Lattice<T> {
    /// Fluid at rest.
    ///
    /// # Errors
    /// If a parameter is impossible, or there is not enough memory.
    pub fn new(setup: Setup) -> Result<Self, LatticeError> {
        Self::shared(setup, Team::alone())
    }

    /// Fluid at rest, of which each rank has some planes of constant z. All ranks have to do the same with it: fill it,
    /// advance it, place obstacles in it. Readings are of the planes of this rank, but for forces on walls and obstacles;
    /// after [`Self::collect`] those of rank 0 are of all.
    ///
    /// # Errors
    /// As [`Self::new`], and if there are too many ranks.
    pub fn shared(setup: Setup, team: Team) -> Result<Self, LatticeError> {
        let layout = Layout::new::<T>(setup.cells)?;
        setup.check()?;
        let parts = RankPlanes::new(team, setup.cells)?;
        let no_memory = |_| LatticeError::NoMemory {
            bytes: layout.slots() * size_of::<T>(),
        };
        Vec::<T>::new()
            .try_reserve_exact(layout.slots())
            .map_err(no_memory)?;
        Ok(Self {
            links: Links::new(&layout, &parts, &setup.sides, None),
            state: State {
                cells: setup.cells,
                steps: 0,
                // Zeros that nobody touches, those of other ranks' planes, take no memory.
                populations: vec![T::zero(); layout.slots()],
            },
            layout,
            parts,
            setup,
            force: [0.0; 3],
            forces: None,
            velocities: None,
            viscosities: None,
            labels: None,
            obstacles: 0,
        })
    }

    /// The setup of the lattice.
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// Number of nodes along each axis.
    pub fn cells(&self) -> [usize; 3] {
        self.layout.cells
    }

    /// Number of steps since the start.
    pub fn steps(&self) -> u64 {
        self.state.steps
    }

    /// Total memory in bytes.
    pub fn bytes(&self) -> usize {
        let forces = self.forces.as_ref().map_or(0, |_| 3 * size_of::<T>());
        let velocities = self.velocities.as_ref().map_or(0, |_| 3 * size_of::<T>());
        let viscosities = self.viscosities.as_ref().map_or(0, |_| size_of::<T>());
        let labels = self.labels.as_ref().map_or(0, |_| size_of::<u16>());
        self.layout.slots() * size_of::<T>()
            + self.layout.nodes() * (forces + velocities + viscosities + labels)
            + self.links.bytes()
    }

    /// The state to store in order to continue later.
    pub fn state(&self) -> &State<T> {
        &self.state
    }

    /// Continues from a stored state. Forces on walls and obstacles are 0 until the next step.
    ///
    /// # Errors
    /// If the state belongs to a lattice of another size.
    pub fn restore(&mut self, state: State<T>) -> Result<(), LatticeError> {
        if state.cells != self.state.cells
            || state.populations.len() != self.state.populations.len()
        {
            return Err(LatticeError::OtherState {
                found: state.cells,
                populations: state.populations.len(),
                cells: self.state.cells,
                expected: self.state.populations.len(),
            });
        }
        self.state = state;
        self.links.forget();
        Ok(())
    }

    /// Sets density and velocity of every node, with populations in equilibrium apart from the
    /// forces; of several ranks before the first step.
    pub fn fill(&mut self, mut node: impl FnMut([usize; 3]) -> Node) {
        let odd = self.odd();
        let [length, rows, _] = self.layout.cells;
        let planes = self.own_planes();
        for number in planes.start * length * rows..planes.end * length * rows {
            let cell = self.layout.cell(number);
            let Node { density, velocity } = node(cell);
            let force = self.force_at(number);
            let (mass, inertia) = if self.setup.inertia {
                (density, 1.0)
            } else {
                (1.0, 0.0)
            };
            let squared: f64 = velocity.iter().map(|u| u * u).sum();
            for direction in 0..Q {
                let along_u = along(direction, velocity);
                let linear = mass * along_u - 0.5 * along(direction, force);
                let quadratic = mass * inertia * (4.5 * along_u * along_u - 1.5 * squared);
                let deviation = weight(direction) * (density - 1.0 + 3.0 * linear + quadratic);
                let place = self.layout.place(odd, direction, cell);
                self.state.populations[place] = T::constant(deviation);
            }
        }
    }

    /// Moves the walls with other velocities from the next step on.
    ///
    /// # Errors
    /// If there are walls where there were none, or none where there were walls, or if velocities are impossible.
    pub fn move_walls(&mut self, sides: [Sides; 3]) -> Result<(), LatticeError> {
        let walled = |sides: [Sides; 3]| sides.map(|sides| sides != Sides::Periodic);
        if let Some(axis) =
            (0..3).find(|&axis| walled(sides)[axis] != walled(self.setup.sides)[axis])
        {
            return Err(LatticeError::OtherSides { axis });
        }
        let setup = Setup {
            sides,
            ..self.setup.clone()
        };
        setup.check()?;
        self.links.move_walls(&sides);
        self.setup = setup;
        Ok(())
    }

    /// Advances by a number of steps.
    pub fn advance(&mut self, steps: u64) {
        for _ in 0..steps {
            T::step(self, false);
        }
    }

    /// Advances by one step and keeps the velocities at its start, including half of all forces as
    /// in [`Node`], for the rows along x that have forces on single nodes. Collisions compute these
    /// velocities anyway, so this takes no second pass over the populations.
    ///
    /// The velocities are rounded to the number type of the lattice, and available until the next
    /// such step.
    pub fn advance_keeping_velocities(&mut self) {
        T::step(self, true);
    }

    /// A step, compiled in the crate that calls this.
    fn step_here(&mut self, keep_velocities: bool) {
        if !keep_velocities {
            self.collide_and_stream(None);
            return;
        }
        let layout = &self.layout;
        let mut kept = (self.velocities.take()).unwrap_or_else(|| NodalVelocities::new(layout));
        kept.keep(self.forces.as_ref());
        self.collide_and_stream(Some(&mut kept));
        self.velocities = Some(kept);
    }

    fn collide_and_stream(&mut self, velocities: Option<&mut NodalVelocities<T>>) {
        let odd = self.odd();
        if odd {
            self.fetch();
        }
        let fluid = Fluid {
            tripled_viscosity: T::constant(3.0 * self.setup.viscosity),
            viscosities: self.viscosities.as_ref(),
            force: self.force.map(T::constant),
            forces: self.forces.as_ref(),
            inertia: if self.setup.inertia {
                T::one()
            } else {
                T::zero()
            },
        };
        let layout = self.layout;
        let own = self.own_planes();
        let share = own.len().div_ceil(self.setup.threads.get());
        let mut planes = planes(&layout, odd, &mut self.state.populations);
        let mut velocities = velocities.map(|velocities| velocities.slabs(own.clone(), share));
        let slab = |(number, planes)| Slab {
            planes,
            first: own.start + number * share,
            odd,
            layout,
            fluid,
            velocities: velocities.as_mut().and_then(Iterator::next),
        };
        let slabs = planes[own.clone()].chunks_mut(share).enumerate().map(slab);
        in_parts(slabs, &|slab| Arch::new().dispatch(slab));
        if odd {
            self.deliver();
        }
        (self.links).bounce_back(&mut self.state.populations, odd, &self.parts);
        self.state.steps += 1;
    }

    fn kept_velocities(&self) -> Option<&NodalVelocities<T>> {
        self.velocities.as_ref()
    }

    fn is_periodic(&self, axis: usize) -> bool {
        self.setup.sides[axis] == Sides::Periodic
    }

    fn odd(&self) -> bool {
        self.state.steps % 2 == 1
    }

    fn assert_inside(&self, cell: [usize; 3]) {
        let cells = self.layout.cells;
        let inside = (0..3).all(|axis| cell[axis] < cells[axis]);
        assert!(inside, "there is no node {cell:?} among {cells:?}");
    }
}

/// For each plane, the sheets in which its nodes find the populations of each direction.
fn planes<'a, T>(layout: &Layout, odd: bool, populations: &'a mut [T]) -> Vec<[&'a mut [T]; Q]> {
    let count = layout.cells[2];
    let mut planes = Vec::from_iter((0..count).map(|_| array::from_fn(|_| <&mut [T]>::default())));
    for (number, sheet) in populations.chunks_exact_mut(layout.sheet).enumerate() {
        let (z, stored) = (number / Q, number % Q);
        if odd {
            let direction = opposite(stored);
            planes[wrapped(z, VELOCITIES[direction][2], count)][direction] = sheet;
        } else {
            planes[z][stored] = sheet;
        }
    }
    planes
}
