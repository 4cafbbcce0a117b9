//! Membranes immersed in the fluid of a lattice.

mod ranks;
mod ripples;
mod viscous;

pub use ripples::Ripples;

use super::lattice_boltzmann::{
    Immersed, Kernel, Lattice, LatticeError, Precision, Sides, State, Units,
};
use super::{Effort, Fluid, KeptVolumes, Membranes, Redistribution};
use helfrich::{Surface, TriangleMesh};
use helfrich_execute::team::Division;
use ranks::Order;
use serde::{Deserialize, Serialize};
use std::array;
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;
use viscous::ViscousForces;

/// Membranes immersed in the fluid of a lattice. Vertices spread their forces over the nodes around them
/// and move with the velocity of the fluid there.
///
/// Vertices move with the mean of the fluid velocities in this step and in the previous one. Whatever
/// its viscosity, a lattice conserves a momentum whose sign changes from node to node and from step to
/// step (G. Zanetti, Phys. Rev. A 40 (1989) 1539). If vertices followed it, elastic membranes would
/// drive it in resonance, and it would grow with any step. It vanishes in the mean of two steps, as in
/// A. J. C. Ladd and R. Verberg, J. Stat. Phys. 104 (2001) 1191. Before the first step the fluid is at
/// rest.
///
/// Elastic forces are evaluated at the start of a step. Forces of viscous membranes are evaluated at the
/// velocities of the step, which depend on them; this linear system is solved in each step, which is
/// stable for any viscosity and step.
///
/// Positions, velocities and forces are in the units of the membranes; [`Units`] converts them.
#[derive(Debug)]
pub struct Immersion<T> {
    lattice: Lattice<T>,
    units: Units,
    /// The origin of the lattice.
    origin: [f64; 3],
    immersed: Immersed,
    contrasts: Vec<Contrast>,
    volumes: KeptVolumes,
    redistribution: Redistribution,
    ripples: Ripples,
    /// Velocities of the fluid at the vertices in the last step.
    velocities: Vec<[f64; 3]>,
    /// Velocities of the last step: of the material, and of the vertices that slide along it.
    moving: Vec<[f64; 3]>,
    sliding: Vec<[f64; 3]>,
    forces: Vec<[f64; 3]>,
    /// The positions in lattice units.
    placed: Vec<[f64; 3]>,
    /// The velocities without viscous forces, in lattice units.
    free: Vec<[f64; 3]>,
    viscous: ViscousForces,
    /// The vertices of each rank's membranes.
    division: Division,
    fluid: Effort,
    coupling: Effort,
}

/// A closed membrane, and the viscosity inside it.
#[derive(Debug)]
struct Contrast {
    mesh: Arc<TriangleMesh>,
    vertices: Range<usize>,
    ratio: f64,
}

/// The state that changes from step to step, besides positions.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ImmersionState<T> {
    lattice: State<T>,
    velocities: Vec<[f64; 3]>,
}

/// Reason why membranes cannot take a step.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImmersionError {
    /// The forces of the membranes cannot be evaluated.
    #[error("{0}")]
    Membranes(String),
    /// The lattice refuses the forces or points.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// A velocity too large for the lattice.
    #[error("vertex {vertex} moves with {speed:.3} nodes a step, and sound with 0.577")]
    TooFast {
        /// The vertex.
        vertex: usize,
        /// Its speed in lattice units.
        speed: f64,
    },
    /// The linear system of viscous membranes was not solved.
    #[error(
        "after {products} evaluations of viscous forces the velocities that they make depend on \
         themselves are still wrong by {residual:.1e} of their size: a smaller `membrane_viscosity`, or \
         fewer vertices, are needed"
    )]
    NotSolved {
        /// Evaluations of the forces.
        products: usize,
        /// The residual, relative to the velocities without them.
        residual: f64,
    },
}

/// The largest speed of a vertex, in lattice units: half the speed of sound.
const FASTEST: f64 = 0.289;

/// The number types of lattices with membranes in them: `f32` and `f64`, for which a step is compiled in
/// this crate.
pub trait ImmersionPrecision: Precision {
    /// [`Immersion::advance`].
    ///
    /// # Errors
    /// As there.
    fn advance(
        immersion: &mut Immersion<Self>,
        membranes: &mut dyn Membranes,
        positions: &mut [[f64; 3]],
    ) -> Result<(), ImmersionError>;
}

macro_rules! precision {
    ($($number:ty),*) => {$(
        impl ImmersionPrecision for $number {
            fn advance(
                immersion: &mut Immersion<Self>,
                membranes: &mut dyn Membranes,
                positions: &mut [[f64; 3]],
            ) -> Result<(), ImmersionError> {
                immersion.advance_here(membranes, positions)
            }
        }
    )*};
}

precision!(f32, f64);

impl<T: ImmersionPrecision> Immersion<T> {
    /// An immersion of this number of vertices in a fluid whose first corner is at `origin`.
    pub fn new(
        lattice: Lattice<T>,
        units: Units,
        origin: [f64; 3],
        kernel: Kernel,
        vertices: usize,
    ) -> Self {
        Self {
            lattice,
            units,
            origin,
            immersed: Immersed::new(kernel),
            contrasts: Vec::new(),
            volumes: KeptVolumes::default(),
            redistribution: Redistribution::default(),
            ripples: Ripples::default(),
            velocities: vec![[0.0; 3]; vertices],
            moving: vec![[0.0; 3]; vertices],
            sliding: Vec::new(),
            forces: vec![[0.0; 3]; vertices],
            placed: vec![[0.0; 3]; vertices],
            free: Vec::new(),
            viscous: ViscousForces::default(),
            division: Division::alone(),
            fluid: Effort::default(),
            coupling: Effort::default(),
        }
    }

    /// Keeps these volumes.
    pub fn keep_volumes(&mut self, volumes: KeptVolumes) {
        self.volumes = volumes;
    }

    /// Lets the vertices of these membranes slide along them.
    pub fn redistribute(&mut self, redistribution: Redistribution) {
        self.redistribution = redistribution;
    }

    /// Continues with other vertices in the same fluid. All that is set for meshes has to be set anew.
    ///
    /// # Errors
    /// If a vertex is too near to a wall.
    pub fn continue_at(&mut self, positions: &[[f64; 3]]) -> Result<(), LatticeError> {
        for vertices in [&mut self.velocities, &mut self.moving, &mut self.forces] {
            vertices.clear();
            vertices.resize(positions.len(), [0.0; 3]);
        }
        self.placed = positions.iter().map(|&at| self.on_lattice(at)).collect();
        self.immersed.place(&self.lattice, &self.placed)?;
        // Of the populations alone, which a stored state has.
        self.lattice.clear_forces();
        self.immersed
            .interpolate(&mut self.lattice, &mut self.velocities);
        let unit = self.units.velocity();
        for velocity in &mut self.velocities {
            *velocity = velocity.map(|component| component * unit);
        }
        Ok(())
    }

    /// Lets forces act on ripples of these membranes that are too short for the kernel.
    pub fn resist(&mut self, ripples: Ripples) {
        self.ripples = ripples;
    }

    /// The velocities with which the last step moved the material.
    pub fn material_velocities(&self) -> &[[f64; 3]] {
        &self.moving
    }

    /// Fills the membranes of these closed meshes, one after the other, with fluid of the outer
    /// viscosity times their ratio. The outer viscosity is that outside all membranes, also for
    /// membranes inside others; the innermost membrane decides. Open meshes must have the ratio 1. No
    /// time is needed if all ratios are 1.
    ///
    /// # Panics
    /// If there is not one ratio per mesh.
    pub fn set_viscosity_ratios(&mut self, meshes: &[Arc<TriangleMesh>], ratios: &[f64]) {
        assert_eq!(meshes.len(), ratios.len(), "one viscosity ratio a mesh");
        let mut first = 0;
        let contrast = ratios.iter().any(|&ratio| ratio != 1.0);
        self.contrasts.clear();
        for (mesh, &ratio) in meshes.iter().zip(ratios) {
            let vertices = first..first + mesh.vertex_count();
            first = vertices.end;
            // A membrane with the outer viscosity still matters, because it may lie inside another
            // one.
            if ratio != 1.0 || (contrast && mesh.is_closed()) {
                self.contrasts.push(Contrast {
                    mesh: Arc::clone(mesh),
                    vertices,
                    ratio,
                });
            }
        }
    }

    /// The fluid.
    pub fn lattice(&self) -> &Lattice<T> {
        &self.lattice
    }

    /// Changes the force on every node and the velocities of the walls, in lattice units, from the next step on.
    ///
    /// # Errors
    /// As [`Lattice::set_force`] and [`Lattice::move_walls`].
    pub fn drive(&mut self, force: [f64; 3], sides: [Sides; 3]) -> Result<(), LatticeError> {
        self.order(Order::Drive(force, sides));
        self.lattice.set_force(force)?;
        self.lattice.move_walls(sides)
    }

    /// The time after all steps so far.
    pub fn time(&self) -> f64 {
        self.lattice.steps() as f64 * self.units.step
    }

    /// Advances fluid and membranes by one step.
    ///
    /// # Errors
    /// If forces cannot be evaluated, a vertex is too near to a wall, or the linear system is not solved;
    /// nothing has moved then. If a vertex is too fast; the membranes have not moved then, and the state
    /// cannot be continued.
    ///
    /// # Panics
    /// If there is not one position per vertex.
    pub fn advance(
        &mut self,
        membranes: &mut dyn Membranes,
        positions: &mut [[f64; 3]],
    ) -> Result<(), ImmersionError> {
        self.order(Order::Advance);
        T::advance(self, membranes, positions)
    }

    /// As [`Self::advance`], compiled for the number type in the crate that calls it.
    fn advance_here(
        &mut self,
        membranes: &mut dyn Membranes,
        positions: &mut [[f64; 3]],
    ) -> Result<(), ImmersionError> {
        self.check_speeds()?;
        (membranes.set_forces(positions, &mut self.forces)).map_err(ImmersionError::Membranes)?;
        let start = Instant::now();
        self.ripples.respond(positions, &self.forces);
        self.spread(positions, membranes.are_viscous())?;
        self.coupling.add(start);
        if membranes.are_viscous() {
            self.add_viscous_forces(membranes, positions)?;
        }
        let start = Instant::now();
        self.lattice.advance_keeping_velocities();
        self.fluid.add(start);
        let start = Instant::now();
        self.interpolate();
        self.ripples.add_to(&mut self.moving);
        self.coupling.add(start);
        self.check_speeds()?;
        // What follows is done by each rank for its membranes.
        self.volumes.correct(positions, &mut self.moving);
        let velocities = if self.redistribution.is_empty() {
            &self.moving
        } else {
            self.sliding.clone_from(&self.moving);
            self.redistribution.slide(positions, &mut self.sliding);
            let slides = |vertices: &Range<usize>| self.redistribution.moves(vertices);
            (self.volumes).correct_some(&slides, positions, &mut self.sliding);
            &self.sliding
        };
        for (position, velocity) in positions.iter_mut().zip(velocities) {
            for (coordinate, velocity) in position.iter_mut().zip(velocity) {
                *coordinate += self.units.step * velocity;
            }
        }
        self.volumes.restore(positions);
        self.division.gather(positions);
        self.division.gather(&mut self.moving);
        Ok(())
    }

    /// Spreads the forces to the fluid; for viscous membranes, each rank needs all vertices.
    fn spread(&mut self, positions: &[[f64; 3]], viscous: bool) -> Result<(), ImmersionError> {
        for (vertex, &position) in positions.iter().enumerate() {
            self.placed[vertex] = self.on_lattice(position);
        }
        if viscous {
            self.immersed.place(&self.lattice, &self.placed)?;
        } else {
            self.immersed.place_own(&self.lattice, &self.placed)?;
        }
        self.fill_membranes()?;
        let unit = self.units.force();
        for force in &mut self.forces {
            *force = force.map(|component| component / unit);
        }
        self.lattice.clear_forces();
        self.immersed.spread(&mut self.lattice, &self.forces)?;
        Ok(())
    }

    /// Spreads the forces of viscous membranes to the fluid.
    fn add_viscous_forces(
        &mut self,
        membranes: &mut dyn Membranes,
        positions: &[[f64; 3]],
    ) -> Result<(), ImmersionError> {
        let Self {
            lattice,
            immersed,
            units,
            velocities,
            forces,
            free,
            coupling,
            ..
        } = self;
        let start = Instant::now();
        free.resize(positions.len(), [0.0; 3]);
        immersed.interpolate(lattice, free);
        coupling.add(start);
        let unit = units.force();
        let mut resist = |velocities: &[[f64; 3]], unit: f64, forces: &mut [[f64; 3]]| {
            forces.fill([0.0; 3]);
            membranes.add_viscous_forces(positions, velocities, forces);
            let forces = forces.as_flattened_mut().iter_mut();
            forces.for_each(|force| *force *= unit);
        };
        // The forces at the velocities of the last step are close.
        resist(velocities, unit.recip(), forces);
        let unit = units.velocity() / unit;
        let solved = self.viscous.solve(
            &mut |velocities, forces| resist(velocities, unit, forces),
            &mut |forces, velocities| {
                let start = Instant::now();
                immersed.respond(lattice, forces, velocities);
                coupling.add(start);
            },
            free,
            forces,
        );
        if !solved.converged {
            return Err(ImmersionError::NotSolved {
                products: solved.products,
                residual: solved.residual,
            });
        }
        let start = Instant::now();
        immersed.spread(lattice, forces)?;
        coupling.add(start);
        Ok(())
    }

    /// Interpolates the velocities of the fluid before its step, and sets the velocities of the
    /// vertices.
    fn interpolate(&mut self) {
        self.moving.clone_from(&self.velocities);
        (self.immersed).interpolate_kept(&self.lattice, &mut self.velocities);
        let unit = self.units.velocity();
        for velocity in &mut self.velocities {
            *velocity = velocity.map(|component| component * unit);
        }
        for (mean, velocity) in self.moving.iter_mut().zip(&self.velocities) {
            *mean = array::from_fn(|axis| 0.5 * (mean[axis] + velocity[axis]));
        }
    }

    fn check_speeds(&self) -> Result<(), ImmersionError> {
        let unit = self.units.velocity();
        let squared = |velocity: &[f64; 3]| velocity.iter().map(|u| u * u).sum::<f64>();
        let most = (FASTEST * unit).powi(2);
        let mut squares = self.velocities.iter().map(squared).enumerate();
        match squares.find(|(_, squared)| !(0.0..most).contains(squared)) {
            Some((vertex, squared)) => {
                let speed = squared.sqrt() / unit;
                Err(ImmersionError::TooFast { vertex, speed })
            }
            None => Ok(()),
        }
    }

    /// Sets the viscosity inside membranes.
    fn fill_membranes(&mut self) -> Result<(), LatticeError> {
        if self.contrasts.is_empty() {
            return Ok(());
        }
        let outer = self.lattice.setup().viscosity;
        let mut filled = Vec::with_capacity(self.contrasts.len());
        for contrast in &self.contrasts {
            let positions = &self.placed[contrast.vertices.clone()];
            let surface = Surface::new(&contrast.mesh, positions)?;
            filled.push((surface, contrast.ratio * outer));
        }
        self.lattice.set_inner_viscosities(&filled)
    }

    /// Velocity and pressure at points of the fluid; NaN beyond walls and inside obstacles.
    ///
    /// The pressure is 0 in fluid at rest, up to a uniform part of the box.
    pub fn fluid_at(&mut self, points: &[[f64; 3]]) -> Fluid {
        self.collect();
        let node = |&point: &[f64; 3]| {
            let node = self.lattice.fluid_at(self.on_lattice(point));
            node.map_or(([f64::NAN; 3], f64::NAN), |node| {
                let velocity = node.velocity.map(|u| u * self.units.velocity());
                (velocity, node.pressure() * self.units.pressure())
            })
        };
        let (velocity, pressure) = points.iter().map(node).unzip();
        Fluid { velocity, pressure }
    }

    fn on_lattice(&self, point: [f64; 3]) -> [f64; 3] {
        array::from_fn(|axis| (point[axis] - self.origin[axis]) / self.units.spacing)
    }

    /// The effort of fluid and coupling so far.
    pub fn efforts(&self) -> Vec<(&'static str, Effort)> {
        let efforts = [("lattice", self.fluid), ("immersed", self.coupling)];
        let efforts = efforts.into_iter();
        efforts.chain(self.redistribution.effort()).collect()
    }

    /// The state to store, besides positions, in order to continue bit for bit.
    pub fn state(&mut self) -> ImmersionState<T> {
        self.collect();
        ImmersionState {
            lattice: self.lattice.state().clone(),
            velocities: self.velocities.clone(),
        }
    }

    /// Restores a stored state, at these positions.
    ///
    /// # Errors
    /// If the state belongs to a lattice of another size.
    pub fn restore(
        &mut self,
        state: ImmersionState<T>,
        positions: &[[f64; 3]],
    ) -> Result<(), LatticeError> {
        self.lattice.restore(state.lattice)?;
        self.velocities = state.velocities;
        self.order(Order::Restore);
        self.distribute(&mut positions.to_vec());
        Ok(())
    }
}
