//! The lattice Boltzmann method: viscous fluid with inertia in a box, with walls, obstacles and
//! membranes.
//!
//! Everything is in lattice units: the distance of nodes, the time of a step and the density at
//! rest are 1, and the speed of sound is 1/√3. [`Units`] converts. Node (i, j, k) is at
//! (i + ½, j + ½, k + ½); a box of n cells reaches from 0 to n, and that is where its walls are.
//!
//! Nineteen populations a node (D3Q19) relax with two times, Λ = 3/16, to the equilibrium of second
//! order in the velocity, or of first order, which is Stokes flow as far as the fluid's slight
//! compressibility goes: density deviates from 1 by 3 times the pressure.
//! The error is of second order in the distance of nodes, and in the Mach number.
//!
//! T. Krüger et al., The Lattice Boltzmann Method, Springer 2017.

mod boundary;
mod collision;
mod force;
mod immersed;
mod stencil;
mod units;
mod vectors;
mod voxel;

pub use immersed::{Immersed, Kernel};
pub use units::{Units, mach, memory, reynolds};

use boundary::{FIRST_OBSTACLE, Links, wall};
use collision::{Fluid, Slab};
use force::NodalForces;
use helfrich::{Surface, SurfaceError, TriangleMesh};
use pulp::Arch;
use serde::{Deserialize, Serialize};
use std::array;
use std::num::NonZeroUsize;
use stencil::{Layout, Q, VELOCITIES, along, opposite, weight, wrapped};
use vectors::Vectors;

/// The numbers that a lattice computes with: `f32` and `f64`.
///
/// Populations are stored as what they deviate by from rest, so that `f32` rounds at 6·10⁻⁸ of the
/// deviations.
pub trait Precision: Vectors {}

impl Precision for f32 {}
impl Precision for f64 {}

fn number<T: Precision>(value: T) -> f64 {
    value.to_f64().unwrap_or(f64::NAN)
}

/// What is on the two sides of the box that an axis goes through.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sides {
    /// What leaves on one side enters on the other.
    Periodic,
    /// Plane walls, half a cell beyond the outermost nodes. Links through an edge between walls
    /// belong to the wall of the first axis.
    Walls {
        /// Velocity of the wall at 0, along the wall.
        low: [f64; 3],
        /// Velocity of the other one.
        high: [f64; 3],
    },
}

impl Sides {
    /// Two walls at rest.
    pub const RESTING: Self = Self::Walls {
        low: [0.0; 3],
        high: [0.0; 3],
    };
}

/// A box of fluid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setup {
    /// Number of nodes along each axis. Multiples of 8 along x are fastest.
    pub cells: [usize; 3],
    /// What the box ends in, along each axis.
    pub sides: [Sides; 3],
    /// Kinematic viscosity ν = (τ − ½)/3. Best between 0.02 and 1.
    pub viscosity: f64,
    /// Whether there is inertia; if not, nothing is quadratic in the velocity.
    pub inertia: bool,
    /// Number of threads. No result depends on it.
    pub threads: NonZeroUsize,
}

/// Why something cannot be computed on a lattice.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LatticeError {
    /// A box without extent.
    #[error("the lattice has 0 nodes along {}: at least 1 is needed", axis_name(*axis))]
    NoCells {
        /// 0, 1 or 2.
        axis: usize,
    },
    /// More memory than can be addressed.
    #[error(
        "a lattice of {} × {} × {} nodes is larger than any memory: the size that fits is \
         about 170 bytes a node in f64, half in f32", cells[0], cells[1], cells[2]
    )]
    TooLarge {
        /// Number of nodes along each axis.
        cells: [usize; 3],
    },
    /// More memory than there is.
    #[error("{bytes} bytes of memory are not to be had: fewer nodes, or f32, need less")]
    NoMemory {
        /// What was asked for.
        bytes: usize,
    },
    /// A viscosity that is not above 0.
    #[error(
        "the viscosity is {viscosity} in lattice units: it has to be above 0, which is a relaxation \
         time τ = 3ν + ½ above ½, and is best between 0.02 and 1"
    )]
    Viscosity {
        /// In lattice units.
        viscosity: f64,
    },
    /// A wall that moves through itself, or as fast as sound.
    #[error(
        "the {} wall along {} moves with ({}, {}, {}): its velocity must lie in the wall and be \
         below the speed of sound, 0.577, better below 0.1",
        if *high { "high" } else { "low" }, axis_name(*axis), velocity[0], velocity[1], velocity[2]
    )]
    WallVelocity {
        /// The axis that goes through the wall.
        axis: usize,
        /// Whether it is the wall at the end of the axis.
        high: bool,
        /// In lattice units.
        velocity: [f64; 3],
    },
    /// A force that is no number.
    #[error("the force ({}, {}, {}) is not finite", force[0], force[1], force[2])]
    Force {
        /// In lattice units.
        force: [f64; 3],
    },
    /// Positions that do not fit their mesh.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
    /// A mesh that encloses nothing.
    #[error(
        "the mesh has {boundary_edges} boundary edges: only a closed one has an inside and an outside"
    )]
    Open {
        /// How many edges have one triangle.
        boundary_edges: usize,
    },
    /// Positions that are not in lattice units.
    #[error(
        "the mesh reaches to {coordinate} along {}, far beyond the box of {cells} nodes: positions \
         are in lattice units, and in the box", axis_name(*axis)
    )]
    FarAway {
        /// 0, 1 or 2.
        axis: usize,
        /// The coordinate, less whole periods.
        coordinate: f64,
        /// Number of nodes along the axis.
        cells: usize,
    },
    /// An obstacle between the nodes.
    #[error(
        "no node of the lattice lies inside the mesh: it needs to be larger, or the lattice finer"
    )]
    NothingInside,
    /// More obstacles than can be told apart.
    #[error("a lattice has room for {limit} obstacles at most")]
    TooManyObstacles {
        /// How many there may be.
        limit: usize,
    },
    /// A point that is nowhere.
    #[error("coordinate {} of point {point} is not a finite number", axis_name(*axis))]
    PointNotFinite {
        /// The point.
        point: usize,
        /// 0, 1 or 2.
        axis: usize,
    },
    /// A point whose kernel reaches through a wall.
    #[error(
        "point {point} is at {coordinate} along {}, between walls at 0 and {cells}: its kernel needs \
         {distance} of distance from each, and one of fewer points less", axis_name(*axis)
    )]
    NearWall {
        /// The point.
        point: usize,
        /// The axis that goes through the wall.
        axis: usize,
        /// The point's coordinate.
        coordinate: f64,
        /// Number of nodes along the axis.
        cells: usize,
        /// How far from the walls the kernel needs the point to be.
        distance: f64,
    },
    /// Units that are not numbers above 0.
    #[error("the {name} is {value}: it has to be a number above 0")]
    Unit {
        /// What it is a unit of.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A state of another lattice.
    #[error(
        "the state is of a lattice of {} × {} × {} nodes with {populations} populations, this one \
         has {} × {} × {} with {expected}", found[0], found[1], found[2], cells[0], cells[1], cells[2]
    )]
    OtherState {
        /// Nodes of the state along each axis.
        found: [usize; 3],
        /// Numbers in the state.
        populations: usize,
        /// Nodes of the lattice along each axis.
        cells: [usize; 3],
        /// Numbers that the lattice holds.
        expected: usize,
    },
}

fn axis_name(axis: usize) -> &'static str {
    ["x", "y", "z"][axis]
}

/// What changes from step to step: with it a lattice of the same setup, forces, viscosities and
/// obstacles goes on bit for bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State<T> {
    cells: [usize; 3],
    steps: u64,
    populations: Vec<T>,
}

/// Density and velocity at a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// ρ, 1 at rest.
    pub density: f64,
    /// u, with the half of the force that the step to come will add. Without inertia it is the
    /// momentum, whatever the density.
    pub velocity: [f64; 3],
}

impl Node {
    /// Fluid at rest.
    pub const REST: Self = Self {
        density: 1.0,
        velocity: [0.0; 3],
    };

    /// (ρ − 1)/3, in units of a density times a squared velocity.
    pub fn pressure(&self) -> f64 {
        (self.density - 1.0) / 3.0
    }
}

/// Nodes along x, from one on.
#[derive(Clone, Copy, Debug)]
struct Row {
    start: [usize; 3],
    count: usize,
}

/// δρ, and momentum with half of the force.
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    excess: f64,
    momentum: [f64; 3],
}

impl Moments {
    fn add(&mut self, other: &Self) {
        self.excess += other.excess;
        for (sum, momentum) in self.momentum.iter_mut().zip(other.momentum) {
            *sum += momentum;
        }
    }
}

/// Fluid on the nodes of a box.
///
/// Populations are kept once: a step reads each from its place and writes to the same place, so
/// that planes are shared out among threads without any copy (pattern "AA").
#[derive(Clone, Debug)]
pub struct Lattice<T> {
    setup: Setup,
    layout: Layout,
    state: State<T>,
    force: [f64; 3],
    forces: Option<NodalForces<T>>,
    /// 3ν of each node.
    tripled_viscosities: Option<Vec<T>>,
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
        let layout = Layout::new::<T>(setup.cells)?;
        checked_viscosity(setup.viscosity)?;
        for (axis, sides) in setup.sides.iter().enumerate() {
            if let Sides::Walls { low, high } = *sides {
                for (velocity, high) in [(low, false), (high, true)] {
                    let squared: f64 = velocity.iter().map(|u| u * u).sum();
                    let subsonic = (0.0..1.0).contains(&(3.0 * squared));
                    if velocity[axis] != 0.0 || !subsonic {
                        return Err(LatticeError::WallVelocity {
                            axis,
                            high,
                            velocity,
                        });
                    }
                }
            }
        }
        let mut populations = Vec::new();
        (populations.try_reserve_exact(layout.slots())).map_err(|_| LatticeError::NoMemory {
            bytes: layout.slots() * size_of::<T>(),
        })?;
        populations.resize(layout.slots(), T::zero());
        Ok(Self {
            links: Links::new(&layout, &setup.sides, None),
            state: State {
                cells: setup.cells,
                steps: 0,
                populations,
            },
            layout,
            setup,
            force: [0.0; 3],
            forces: None,
            tripled_viscosities: None,
            labels: None,
            obstacles: 0,
        })
    }

    /// What the lattice was made from.
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

    /// Memory in bytes that all of this takes.
    pub fn bytes(&self) -> usize {
        let forces = self.forces.as_ref().map_or(0, |_| 3 * size_of::<T>());
        let viscosities = (self.tripled_viscosities.as_ref()).map_or(0, |_| size_of::<T>());
        let labels = self.labels.as_ref().map_or(0, |_| size_of::<u16>());
        self.layout.slots() * size_of::<T>()
            + self.layout.nodes() * (forces + viscosities + labels)
            + self.links.bytes()
    }

    /// What to store in order to go on later.
    pub fn state(&self) -> &State<T> {
        &self.state
    }

    /// Goes on from a stored state. Forces on walls and obstacles are 0 until the next step.
    ///
    /// # Errors
    /// If it is that of a lattice of another size.
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

    /// Sets density and velocity of every node, in equilibrium but for the forces.
    pub fn fill(&mut self, mut node: impl FnMut([usize; 3]) -> Node) {
        let odd = self.odd();
        for number in 0..self.layout.nodes() {
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

    /// Density and velocity at a node.
    ///
    /// # Panics
    /// If there is no such node.
    pub fn node(&self, cell: [usize; 3]) -> Node {
        self.assert_inside(cell);
        let mut moments = [Moments::default()];
        let row = Row {
            start: cell,
            count: 1,
        };
        self.read(row, &mut moments);
        let [moments] = moments;
        Node {
            density: 1.0 + moments.excess,
            velocity: self.velocity(&moments),
        }
    }

    fn velocity(&self, moments: &Moments) -> [f64; 3] {
        let mass = if self.setup.inertia {
            1.0 + moments.excess
        } else {
            1.0
        };
        moments.momentum.map(|momentum| momentum / mass)
    }

    /// The moments of a row of nodes. Node by node, so that the processor waits for the memory of
    /// all directions at once.
    fn read(&self, row: Row, moments: &mut [Moments]) {
        let layout = &self.layout;
        let slots: [_; Q] =
            array::from_fn(|direction| layout.row(self.odd(), direction, row.start));
        let first = layout.node(row.start);
        for (along, moments) in moments[..row.count].iter_mut().enumerate() {
            let mut excess = 0.0;
            let mut momentum = self.force_at(first + along).map(|force| 0.5 * force);
            for (velocity, [before, after]) in VELOCITIES.iter().zip(&slots) {
                let slot = if along < before.len() {
                    before.start + along
                } else {
                    after.start + along - before.len()
                };
                let population = number(self.state.populations[slot]);
                excess += population;
                for (sum, &velocity) in momentum.iter_mut().zip(velocity) {
                    *sum += f64::from(velocity) * population;
                }
            }
            *moments = Moments { excess, momentum };
        }
    }

    /// Mass of the fluid, without that inside obstacles.
    pub fn mass(&self) -> f64 {
        let (nodes, Moments { excess, .. }) = self.totals();
        nodes as f64 + excess
    }

    /// Momentum of the fluid, without that inside obstacles.
    pub fn momentum(&self) -> [f64; 3] {
        self.totals().1.momentum
    }

    /// Number of nodes in the fluid, and the sums over them, by rows so that little is lost to
    /// rounding.
    fn totals(&self) -> (usize, Moments) {
        let [length, rows, planes] = self.layout.cells;
        let mut nodes = 0;
        let mut total = Moments::default();
        let mut moments = vec![Moments::default(); length];
        for (z, y) in (0..planes).flat_map(|z| (0..rows).map(move |y| (z, y))) {
            let row = Row {
                start: [0, y, z],
                count: length,
            };
            self.read(row, &mut moments);
            let mut sum = Moments::default();
            for (x, moments) in moments.iter().enumerate() {
                if !self.is_labelled(self.layout.node([x, y, z])) {
                    nodes += 1;
                    sum.add(moments);
                }
            }
            total.add(&sum);
        }
        (nodes, total)
    }

    /// Sets a force on every node: a pressure gradient, or gravity.
    ///
    /// # Errors
    /// If it is not finite.
    pub fn set_force(&mut self, force: [f64; 3]) -> Result<(), LatticeError> {
        self.force = checked_force(force)?;
        Ok(())
    }

    /// Adds to the forces on single nodes, which exist from then on. They act in every step until
    /// they are cleared.
    ///
    /// # Errors
    /// If the force is not finite.
    ///
    /// # Panics
    /// If there is no such node.
    pub fn add_force(&mut self, cell: [usize; 3], force: [f64; 3]) -> Result<(), LatticeError> {
        self.assert_inside(cell);
        let force = checked_force(force)?.map(T::constant);
        let node = self.layout.node(cell);
        self.nodal_forces().add(node, force);
        Ok(())
    }

    fn nodal_forces(&mut self) -> &mut NodalForces<T> {
        (self.forces).get_or_insert_with(|| NodalForces::new(&self.layout))
    }

    /// Takes away all forces on single nodes.
    pub fn clear_forces(&mut self) {
        if let Some(forces) = &mut self.forces {
            forces.clear();
        }
    }

    /// The force on a node.
    fn force_at(&self, node: usize) -> [f64; 3] {
        match &self.forces {
            None => self.force,
            Some(forces) => {
                let own = forces.at(node);
                array::from_fn(|axis| self.force[axis] + number(own[axis]))
            }
        }
    }

    /// Gives each node a viscosity of its own.
    ///
    /// # Errors
    /// If one is not above 0; then nothing changes.
    pub fn set_viscosities(
        &mut self,
        mut viscosity: impl FnMut([usize; 3]) -> f64,
    ) -> Result<(), LatticeError> {
        // Kept until all are known to be good.
        let mut tripled = Vec::with_capacity(self.layout.nodes());
        for node in 0..self.layout.nodes() {
            let viscosity = checked_viscosity(viscosity(self.layout.cell(node)))?;
            tripled.push(T::constant(3.0 * viscosity));
        }
        self.tripled_viscosities = Some(tripled);
        Ok(())
    }

    /// Gives the nodes inside of something a viscosity of their own, and those outside the one of
    /// the setup. Memory is kept from call to call.
    ///
    /// # Errors
    /// If the viscosity is not above 0; then nothing changes.
    ///
    /// # Panics
    /// If `inside` is not as long as there are nodes; see [`Self::inside`].
    pub fn set_inner_viscosity(
        &mut self,
        inside: &[bool],
        viscosity: f64,
    ) -> Result<(), LatticeError> {
        assert_eq!(inside.len(), self.layout.nodes(), "one entry a node");
        let inner = checked_viscosity(viscosity)?;
        let [outer, inner] = [self.setup.viscosity, inner].map(|nu| T::constant(3.0 * nu));
        let tripled = self.tripled_viscosities.get_or_insert_default();
        tripled.clear();
        tripled.extend(
            inside
                .iter()
                .map(|&inside| if inside { inner } else { outer }),
        );
        Ok(())
    }

    /// Which nodes lie inside a closed surface, by their number: x runs fastest, then y. On periodic
    /// axes it may lie anywhere, and what reaches beyond one side goes on at the other.
    ///
    /// # Errors
    /// If the positions do not fit the mesh or are not finite, if they reach more than a box beyond
    /// walls, or over more than two periods, or if the mesh is open.
    pub fn inside(
        &self,
        mesh: &TriangleMesh,
        positions: &[[f64; 3]],
    ) -> Result<Vec<bool>, LatticeError> {
        Surface::new(mesh, positions)?;
        if !mesh.is_closed() {
            return Err(LatticeError::Open {
                boundary_edges: mesh.boundary_edge_count(),
            });
        }
        let cells = self.layout.cells;
        let mut positions = positions.to_vec();
        for axis in 0..3 {
            let length = cells[axis] as f64;
            if self.is_periodic(axis) {
                let low = (positions.iter().map(|x| x[axis])).fold(f64::INFINITY, f64::min);
                let periods = (low / length).floor() * length;
                positions.iter_mut().for_each(|x| x[axis] -= periods);
            }
            for position in &positions {
                if !(-length..=2.0 * length).contains(&position[axis]) {
                    return Err(LatticeError::FarAway {
                        axis,
                        coordinate: position[axis],
                        cells: cells[axis],
                    });
                }
            }
        }
        let in_box = |axis: usize, index: i64| {
            let count = cells[axis] as i64;
            (self.is_periodic(axis) || (0..count).contains(&index))
                .then(|| index.rem_euclid(count) as usize)
        };
        let mut inside = vec![false; self.layout.nodes()];
        voxel::for_each_row_inside(mesh.triangles(), &positions, |row, j, k| {
            if let (Some(y), Some(z)) = (in_box(1, j), in_box(2, k)) {
                for x in row.filter_map(|i| in_box(0, i)) {
                    inside[self.layout.node([x, y, z])] = true;
                }
            }
        });
        Ok(inside)
    }

    /// Puts an obstacle at rest into the fluid, and returns its number. Its surface lies half-way
    /// between nodes inside and outside of the mesh; the fluid inside stays there.
    ///
    /// # Errors
    /// As [`Self::inside`], and if there is no node inside.
    pub fn add_obstacle(
        &mut self,
        mesh: &TriangleMesh,
        positions: &[[f64; 3]],
    ) -> Result<usize, LatticeError> {
        let inside = self.inside(mesh, positions)?;
        if !inside.contains(&true) {
            return Err(LatticeError::NothingInside);
        }
        let limit = usize::from(u16::MAX) - FIRST_OBSTACLE;
        if self.obstacles == limit {
            return Err(LatticeError::TooManyObstacles { limit });
        }
        let odd = self.odd();
        let label = (FIRST_OBSTACLE + self.obstacles) as u16;
        let labels = (self.labels).get_or_insert_with(|| vec![0; self.layout.nodes()]);
        for (node, _) in inside.iter().enumerate().filter(|&(_, &inside)| inside) {
            labels[node] = label;
            let cell = self.layout.cell(node);
            for direction in 0..Q {
                self.state.populations[self.layout.place(odd, direction, cell)] = T::zero();
            }
        }
        self.links = Links::new(&self.layout, &self.setup.sides, Some(labels));
        self.obstacles += 1;
        Ok(self.obstacles - 1)
    }

    /// Whether a node lies inside an obstacle.
    ///
    /// # Panics
    /// If there is no such node.
    pub fn is_solid(&self, cell: [usize; 3]) -> bool {
        self.assert_inside(cell);
        self.is_labelled(self.layout.node(cell))
    }

    fn is_labelled(&self, node: usize) -> bool {
        (self.labels.as_ref()).is_some_and(|labels| labels[node] != 0)
    }

    /// Forces of the fluid on the walls at the start and the end of an axis in the last step,
    /// without the pressure of the fluid at rest, which is 1/3. 0 if there are no walls.
    ///
    /// # Panics
    /// If there is no such axis.
    pub fn wall_forces(&self, axis: usize) -> [[f64; 3]; 2] {
        assert!(axis < 3, "there is no axis {axis}");
        [false, true].map(|high| self.links.force(wall(axis, high)).unwrap_or_default())
    }

    /// Force of the fluid on an obstacle in the last step. It is what bounces off: an external force
    /// on every node does not act on the obstacle itself.
    ///
    /// # Panics
    /// If there is no such obstacle.
    pub fn obstacle_force(&self, obstacle: usize) -> [f64; 3] {
        assert!(obstacle < self.obstacles, "there is no obstacle {obstacle}");
        // One that lies all in others has no links.
        self.links
            .force(FIRST_OBSTACLE + obstacle)
            .unwrap_or_default()
    }

    /// Goes on by a number of steps.
    pub fn advance(&mut self, steps: u64) {
        for _ in 0..steps {
            self.step();
        }
    }

    fn step(&mut self) {
        let odd = self.odd();
        let fluid = Fluid {
            tripled_viscosity: T::constant(3.0 * self.setup.viscosity),
            tripled_viscosities: self.tripled_viscosities.as_deref(),
            force: self.force.map(T::constant),
            forces: self.forces.as_ref(),
            inertia: if self.setup.inertia {
                T::one()
            } else {
                T::zero()
            },
        };
        let layout = self.layout;
        let share = layout.cells[2].div_ceil(self.setup.threads.get());
        let mut planes = planes(&layout, odd, &mut self.state.populations);
        std::thread::scope(|scope| {
            let slab = |(number, planes)| Slab {
                planes,
                first: number * share,
                odd,
                layout,
                fluid,
            };
            let mut slabs = planes.chunks_mut(share).enumerate().map(slab);
            let own = slabs.next();
            for slab in slabs {
                scope.spawn(move || Arch::new().dispatch(slab));
            }
            if let Some(slab) = own {
                Arch::new().dispatch(slab);
            }
        });
        self.links.bounce_back(&mut self.state.populations, odd);
        self.state.steps += 1;
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

fn checked_viscosity(viscosity: f64) -> Result<f64, LatticeError> {
    if viscosity > 0.0 && viscosity.is_finite() {
        Ok(viscosity)
    } else {
        Err(LatticeError::Viscosity { viscosity })
    }
}

fn checked_force(force: [f64; 3]) -> Result<[f64; 3], LatticeError> {
    if force.iter().all(|component| component.is_finite()) {
        Ok(force)
    } else {
        Err(LatticeError::Force { force })
    }
}
