//! Membranes that move with the flow that they make.

use super::{Ambient, DoubleLayer, Effort, Fluid, Gmres, KeptVolumes, Membranes, SingleLayer};
use crate::dynamics::integrate::RightHandSide;
use helfrich::TriangleMesh;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Instant;

/// The residual of solutions, relative: what derivatives by differences can stand.
pub const SOLUTION_TOLERANCE: f64 = 1e-8;

/// Membranes suspended in unbounded fluid: their velocities are that of the ambient flow and those
/// that their forces make by the boundary integrals of Stokes flow.
///
/// Where viscosities differ inside and outside, or membranes are viscous themselves, forces depend on
/// the velocities, which are then the solution of a linear system: `u = b + K u`.
#[derive(Debug)]
pub struct Suspension {
    ambient: Option<Ambient>,
    single: SingleLayer,
    /// Only where viscosities differ.
    double: Option<DoubleLayer>,
    volumes: KeptVolumes,
    forces: Vec<[f64; 3]>,
    solver: Gmres,
    /// The last solution, with which the next begins.
    guess: Vec<[f64; 3]>,
    products: u64,
    single_layers: Effort,
    double_layers: Effort,
}

impl Suspension {
    /// Membranes of these meshes in fluid of viscosity μ, with fluid of μ times the mesh's viscosity
    /// ratio in each. Only ratios other than 1 take time; their meshes are closed.
    ///
    /// # Panics
    /// If there is not one viscosity ratio a mesh, or 2³² vertices or more.
    pub fn new(
        meshes: &[Arc<TriangleMesh>],
        viscosity: f64,
        viscosity_ratios: &[f64],
        ambient: Option<Ambient>,
        threads: NonZeroUsize,
    ) -> Self {
        let borrowed = || meshes.iter().map(|mesh| &**mesh);
        let single = SingleLayer::new(borrowed(), viscosity, threads);
        // Viscous membranes are stiff; contrasts of viscosity take a tenth of it.
        let mut solver = Gmres::new(SOLUTION_TOLERANCE);
        (solver.restart, solver.products) = (100, 500);
        let contrast = viscosity_ratios.iter().any(|&ratio| ratio != 1.0);
        Self {
            ambient,
            double: contrast.then(|| DoubleLayer::new(borrowed(), viscosity_ratios, threads)),
            forces: vec![[0.0; 3]; single.vertex_count()],
            single,
            volumes: KeptVolumes::default(),
            solver,
            guess: Vec::new(),
            products: 0,
            single_layers: Effort::default(),
            double_layers: Effort::default(),
        }
    }

    /// Keeps these volumes: velocities do not change them, and [`Self::restore_volumes`] takes away
    /// what is left of a step's error.
    pub fn keep_volumes(&mut self, volumes: KeptVolumes) {
        self.volumes = volumes;
    }

    /// Sets the velocities of all vertices.
    ///
    /// # Errors
    /// The reason why the membranes give no forces.
    ///
    /// # Panics
    /// If there is not one position and one velocity a vertex.
    pub fn set_velocities(
        &mut self,
        membranes: &mut impl Membranes,
        positions: &[[f64; 3]],
        velocities: &mut [[f64; 3]],
    ) -> Result<(), String> {
        membranes.set_forces(positions, &mut self.forces)?;
        velocities.fill([0.0; 3]);
        if let Some(ambient) = &self.ambient {
            ambient.add_velocity(positions, velocities);
        }
        let start = Instant::now();
        self.single.set_forces(positions, &self.forces);
        self.single.add_at_vertices(velocities);
        self.single_layers.add(start);
        if self.double.is_some() || membranes.are_viscous() {
            self.solve(membranes, positions, velocities)?;
        }
        self.volumes.correct(positions, velocities);
        Ok(())
    }

    /// Makes u of b, with `u = b + K u`.
    fn solve(
        &mut self,
        membranes: &mut impl Membranes,
        positions: &[[f64; 3]],
        velocities: &mut [[f64; 3]],
    ) -> Result<(), String> {
        let Self {
            single,
            double,
            forces,
            solver,
            guess,
            products,
            single_layers,
            double_layers,
            ..
        } = self;
        if guess.len() != velocities.len() {
            guess.clear();
            guess.extend_from_slice(velocities);
        }
        if let Some(double) = double {
            double.set_positions(positions);
        }
        let mut apply = |u: &[[f64; 3]], product: &mut [[f64; 3]]| {
            product.fill([0.0; 3]);
            if let Some(double) = double {
                let start = Instant::now();
                double.set_velocities(u);
                double.add_at_vertices(product);
                double_layers.add(start);
            }
            if membranes.are_viscous() {
                forces.fill([0.0; 3]);
                membranes.add_viscous_forces(positions, u, forces);
                let start = Instant::now();
                single.set_forces(positions, forces);
                single.add_at_vertices(product);
                single_layers.add(start);
            }
            let entries = product.as_flattened_mut().iter_mut();
            for (product, u) in entries.zip(u.as_flattened()) {
                *product = u - *product;
            }
        };
        let solved = solver.solve(&mut apply, velocities, guess);
        *products += solved.products as u64;
        velocities.copy_from_slice(guess);
        if solved.converged {
            return Ok(());
        }
        Err(format!(
            "after {} products the velocities that viscosity makes depend on themselves are still \
             wrong by {:.1e} of their size, and {:.0e} is needed",
            solved.products, solved.residual, solver.tolerance
        ))
    }

    /// Velocity and pressure at points of the fluid, on either side of the membranes.
    ///
    /// Pressure is the one that the membranes' forces make, and that which drives the ambient flow;
    /// inside, it is above the one outside by what the membranes hold.
    ///
    /// # Errors
    /// The reason why there is no flow.
    ///
    /// # Panics
    /// If there is not one position a vertex.
    pub fn fluid_at(
        &mut self,
        membranes: &mut impl Membranes,
        positions: &[[f64; 3]],
        points: &[[f64; 3]],
    ) -> Result<Fluid, String> {
        // What is looked at in between changes nothing.
        let guess = self.guess.clone();
        let mut moving = vec![[0.0; 3]; positions.len()];
        let evaluated = self.set_velocities(membranes, positions, &mut moving);
        let solution = std::mem::replace(&mut self.guess, guess);
        evaluated?;
        let mut fluid = Fluid {
            velocity: vec![[0.0; 3]; points.len()],
            pressure: vec![0.0; points.len()],
        };
        if let Some(ambient) = &self.ambient {
            ambient.add_velocity(points, &mut fluid.velocity);
            for (pressure, &point) in fluid.pressure.iter_mut().zip(points) {
                *pressure += ambient.pressure(point, self.single.viscosity);
            }
        }
        membranes.set_forces(positions, &mut self.forces)?;
        if membranes.are_viscous() {
            membranes.add_viscous_forces(positions, &solution, &mut self.forces);
        }
        self.single.set_forces(positions, &self.forces);
        self.single.add_at_points(points, &mut fluid.velocity);
        self.single
            .add_pressure_at_points(points, &mut fluid.pressure);
        if let Some(double) = &mut self.double {
            double.set_positions(positions);
            double.set_velocities(&solution);
            double.add_at_points(points, &mut fluid.velocity);
            double.add_pressure_at_points(self.single.viscosity, points, &mut fluid.pressure);
            let mut ratios = vec![1.0; points.len()];
            double.viscosity_ratios(points, &mut ratios);
            for (velocity, ratio) in fluid.velocity.iter_mut().zip(ratios) {
                *velocity = velocity.map(|component| component / ratio);
            }
        }
        Ok(fluid)
    }

    /// Moves positions to where volumes are what they were.
    pub fn restore_volumes(&mut self, positions: &mut [[f64; 3]]) {
        self.volumes.restore(positions);
    }

    /// What boundary integrals took so far: those that are used.
    pub fn efforts(&self) -> Vec<(&'static str, Effort)> {
        let mut efforts = vec![("single_layer", self.single_layers)];
        if self.double.is_some() {
            efforts.push(("double_layer", self.double_layers));
        }
        efforts
    }

    /// Products that solutions took so far.
    pub fn products(&self) -> u64 {
        self.products
    }

    /// The last solution, with which the next begins; empty before the first. To be stored for a
    /// run to continue bit for bit.
    pub fn guess(&self) -> &[[f64; 3]] {
        &self.guess
    }

    /// Takes up a stored solution.
    pub fn set_guess(&mut self, guess: Vec<[f64; 3]>) {
        self.guess = guess;
    }

    /// Whether fluids of several viscosities meet.
    pub fn has_contrast(&self) -> bool {
        self.double.is_some()
    }
}

/// The right-hand side of an integration in time: the velocities of these membranes.
#[derive(Debug)]
pub struct Moving<'a, M> {
    /// The fluid.
    pub suspension: &'a mut Suspension,
    /// What moves.
    pub membranes: &'a mut M,
}

impl<M: Membranes> RightHandSide for Moving<'_, M> {
    fn evaluate(
        &mut self,
        positions: &[[f64; 3]],
        _time: f64,
        velocities: &mut [[f64; 3]],
    ) -> Result<(), String> {
        self.suspension
            .set_velocities(self.membranes, positions, velocities)
    }

    fn restore(&mut self, positions: &mut [[f64; 3]]) {
        self.suspension.restore_volumes(positions);
    }
}
