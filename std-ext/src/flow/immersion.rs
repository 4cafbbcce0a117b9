//! Membranes that move with the fluid of a lattice.

use super::lattice_boltzmann::{Immersed, Kernel, Lattice, LatticeError, Precision, State, Units};
use super::{Effort, Fluid, KeptVolumes, Membranes};
use helfrich::{Surface, TriangleMesh};
use serde::{Deserialize, Serialize};
use std::array;
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

/// Membranes immersed in the fluid of a lattice: their vertices spread their forces over the nodes
/// around, and move as the fluid does there.
///
/// Positions, velocities and forces are in units of the membranes'; [`Units`] converts.
#[derive(Debug)]
pub struct Immersion<T> {
    lattice: Lattice<T>,
    units: Units,
    /// Where the lattice has its origin.
    origin: [f64; 3],
    immersed: Immersed,
    contrasts: Vec<Contrast>,
    volumes: KeptVolumes,
    /// Velocities in the last step.
    velocities: Vec<[f64; 3]>,
    forces: Vec<[f64; 3]>,
    /// Positions in lattice units.
    placed: Vec<[f64; 3]>,
    fluid: Effort,
    coupling: Effort,
}

/// A closed membrane with fluid of another viscosity inside.
#[derive(Debug)]
struct Contrast {
    mesh: Arc<TriangleMesh>,
    vertices: Range<usize>,
    ratio: f64,
}

/// What changes from step to step, besides positions.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ImmersionState<T> {
    lattice: State<T>,
    velocities: Vec<[f64; 3]>,
}

/// Why membranes do not move on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImmersionError {
    /// The membranes give no forces.
    #[error("{0}")]
    Membranes(String),
    /// The lattice does not take them.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// A velocity at which the lattice means nothing any more.
    #[error(
        "vertex {vertex} moves with {speed:.3} nodes a step, and sound with 0.577: the forces are too \
         stiff for the step, a shorter one is needed"
    )]
    TooFast {
        /// The vertex.
        vertex: usize,
        /// Its speed in lattice units.
        speed: f64,
    },
}

/// Of a vertex, in lattice units: half the speed of sound.
const FASTEST: f64 = 0.289;

impl<T: Precision> Immersion<T> {
    /// So many vertices in this fluid, whose first corner is at `origin`.
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
            velocities: vec![[0.0; 3]; vertices],
            forces: vec![[0.0; 3]; vertices],
            placed: vec![[0.0; 3]; vertices],
            fluid: Effort::default(),
            coupling: Effort::default(),
        }
    }

    /// Keeps these volumes.
    pub fn keep_volumes(&mut self, volumes: KeptVolumes) {
        self.volumes = volumes;
    }

    /// Fills the membranes of these closed meshes, one after the other, with fluid of the outer
    /// viscosity times their ratio. Only ratios other than 1 take time.
    ///
    /// # Panics
    /// If there is not one ratio a mesh.
    pub fn set_viscosity_ratios(&mut self, meshes: &[Arc<TriangleMesh>], ratios: &[f64]) {
        assert_eq!(meshes.len(), ratios.len(), "one viscosity ratio a mesh");
        let mut first = 0;
        self.contrasts.clear();
        for (mesh, &ratio) in meshes.iter().zip(ratios) {
            let vertices = first..first + mesh.vertex_count();
            first = vertices.end;
            if ratio != 1.0 {
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

    /// The time: that of all steps so far.
    pub fn time(&self) -> f64 {
        self.lattice.steps() as f64 * self.units.step
    }

    /// Moves fluid and membranes on by one step.
    ///
    /// Forces that depend on velocities are those of the last step.
    ///
    /// # Errors
    /// If the membranes give no forces, or are too near to a wall: nothing has moved then. If one
    /// moves too fast: the membranes have not moved then, and will not from this state on.
    ///
    /// # Panics
    /// If there is not one position a vertex.
    pub fn advance(
        &mut self,
        membranes: &mut impl Membranes,
        positions: &mut [[f64; 3]],
    ) -> Result<(), ImmersionError> {
        self.check_speeds()?;
        (membranes.set_forces(positions, &mut self.forces)).map_err(ImmersionError::Membranes)?;
        if membranes.are_viscous() {
            membranes.add_viscous_forces(positions, &self.velocities, &mut self.forces);
        }
        let start = Instant::now();
        self.spread(positions)?;
        self.coupling.add(start);
        let start = Instant::now();
        self.lattice.advance_keeping_velocities();
        self.fluid.add(start);
        let start = Instant::now();
        self.interpolate();
        self.coupling.add(start);
        self.check_speeds()?;
        self.volumes.correct(positions, &mut self.velocities);
        for (position, velocity) in positions.iter_mut().zip(&self.velocities) {
            for (coordinate, velocity) in position.iter_mut().zip(velocity) {
                *coordinate += self.units.step * velocity;
            }
        }
        self.volumes.restore(positions);
        Ok(())
    }

    /// Gives the forces to the fluid.
    fn spread(&mut self, positions: &[[f64; 3]]) -> Result<(), ImmersionError> {
        for (vertex, &position) in positions.iter().enumerate() {
            self.placed[vertex] = self.on_lattice(position);
        }
        self.immersed.place(&self.lattice, &self.placed)?;
        self.fill_membranes()?;
        let unit = self.units.force();
        for force in &mut self.forces {
            *force = force.map(|component| component / unit);
        }
        self.lattice.clear_forces();
        self.immersed.spread(&mut self.lattice, &self.forces)?;
        Ok(())
    }

    /// Takes the velocities that the fluid had before its step.
    fn interpolate(&mut self) {
        (self.immersed).interpolate_kept(&self.lattice, &mut self.velocities);
        let unit = self.units.velocity();
        for velocity in &mut self.velocities {
            *velocity = velocity.map(|component| component * unit);
        }
    }

    fn check_speeds(&self) -> Result<(), ImmersionError> {
        let unit = self.units.velocity();
        let speed = |velocity: &[f64; 3]| velocity.iter().map(|u| u * u).sum::<f64>().sqrt() / unit;
        let mut speeds = self.velocities.iter().map(speed).enumerate();
        match speeds.find(|(_, speed)| !(0.0..FASTEST).contains(speed)) {
            Some((vertex, speed)) => Err(ImmersionError::TooFast { vertex, speed }),
            None => Ok(()),
        }
    }

    /// Gives the fluid inside membranes its viscosity.
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

    /// Velocity and pressure at points of the fluid; not numbers beyond walls and inside obstacles.
    ///
    /// Pressure is 0 in fluid at rest, but for the uniform part that a box has of its own.
    pub fn fluid_at(&self, points: &[[f64; 3]]) -> Fluid {
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

    /// What fluid and coupling took so far.
    pub fn efforts(&self) -> Vec<(&'static str, Effort)> {
        vec![("lattice", self.fluid), ("immersed", self.coupling)]
    }

    /// What to store, beside positions, in order to go on bit for bit.
    pub fn state(&self) -> ImmersionState<T> {
        ImmersionState {
            lattice: self.lattice.state().clone(),
            velocities: self.velocities.clone(),
        }
    }

    /// Goes on from a stored state.
    ///
    /// # Errors
    /// If it is that of a lattice of another size.
    pub fn restore(&mut self, state: ImmersionState<T>) -> Result<(), LatticeError> {
        self.lattice.restore(state.lattice)?;
        self.velocities = state.velocities;
        Ok(())
    }
}
