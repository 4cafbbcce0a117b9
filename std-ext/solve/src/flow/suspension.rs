//! Membranes suspended in Stokes flow.

mod obstacles;

use super::{
    Ambient, Course, DoubleLayer, Effort, Fluid, Gmres, KeptVolumes, LocalMobility, Membranes,
    Recent, Redistribution, SingleLayer,
};
use crate::dynamics::Membrane;
use crate::dynamics::integrate::RightHandSide;
use helfrich::TriangleMesh;
use obstacles::Obstacles;
use std::borrow::Cow;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Instant;

/// The relative residual of solutions, small enough for derivatives by differences.
pub const SOLUTION_TOLERANCE: f64 = 1e-8;

/// Membranes suspended in unbounded fluid. Their velocity is that of the ambient flow plus that due to
/// their forces, by the boundary integrals of Stokes flow. A uniform pressure on a membrane whose volume is
/// [kept](Self::keep_volumes) moves nothing, and is left out: see [`KeptVolumes::balance`].
///
/// Where viscosities differ inside and outside, or membranes are viscous themselves, forces depend on
/// the velocities, which are then the solution of a linear system: `u = b + K u`. Around [obstacles](Self::set_obstacles)
/// the tractions that make the velocity 0 on them are further unknowns.
#[derive(Debug)]
pub struct Suspension {
    ambient: Option<Ambient>,
    course: Course,
    /// The factor of the ambient flow at this time.
    factor: f64,
    single: SingleLayer,
    /// The double layer, only where viscosities differ.
    double: Option<DoubleLayer>,
    obstacles: Option<Obstacles>,
    cluster_tolerance: f64,
    volumes: KeptVolumes,
    redistribution: Redistribution,
    /// For linearly implicit steps.
    mobility: Option<LocalMobility>,
    /// The last velocities of the material.
    material: Vec<[f64; 3]>,
    /// Forces and velocities of membranes, then those of obstacles.
    forces: Vec<[f64; 3]>,
    velocities: Vec<[f64; 3]>,
    solver: Gmres,
    /// The last solutions, from which the next one starts.
    recent: Recent,
    /// Velocities of membranes, then tractions of obstacles.
    solution: Vec<[f64; 3]>,
    products: u64,
    single_layers: Effort,
    double_layers: Effort,
}

impl Suspension {
    /// Membranes with these meshes in fluid of viscosity μ. The viscosity inside each is μ times the ratio
    /// of its mesh. Only ratios other than 1 take time; their meshes must be closed. Membranes are
    /// outside each other unless [`Self::set_surroundings`] states otherwise.
    ///
    /// # Panics
    /// If there is not one viscosity ratio per mesh, or 2³² vertices or more.
    pub fn new(
        meshes: &[Arc<TriangleMesh>],
        viscosity: f64,
        viscosity_ratios: &[f64],
        ambient: Option<Ambient>,
        threads: NonZeroUsize,
    ) -> Self {
        let borrowed = || meshes.iter().map(|mesh| &**mesh);
        let single = SingleLayer::new(borrowed(), viscosity, threads);
        // Viscous membranes are stiff and need many products; viscosity ratios need a tenth of
        // these.
        let mut solver = Gmres::new(SOLUTION_TOLERANCE);
        (solver.restart, solver.products) = (100, 500);
        let contrast = viscosity_ratios.iter().any(|&ratio| ratio != 1.0);
        Self {
            ambient,
            course: Course::Steady,
            factor: 1.0,
            double: contrast.then(|| DoubleLayer::new(borrowed(), viscosity_ratios, threads)),
            obstacles: None,
            forces: vec![[0.0; 3]; single.vertex_count()],
            velocities: vec![[0.0; 3]; single.vertex_count()],
            single,
            cluster_tolerance: 0.0,
            volumes: KeptVolumes::default(),
            redistribution: Redistribution::default(),
            mobility: None,
            material: Vec::new(),
            solver,
            recent: Recent::default(),
            solution: Vec::new(),
            products: 0,
            single_layers: Effort::default(),
            double_layers: Effort::default(),
        }
    }

    /// Sets, for each membrane, the membrane that contains it: see [`DoubleLayer::set_surroundings`].
    ///
    /// # Panics
    /// If there is not one entry per membrane, or if membranes contain each other in a cycle.
    pub fn set_surroundings(&mut self, surroundings: &[Option<usize>]) {
        if let Some(double) = &mut self.double {
            double.set_surroundings(surroundings);
        }
    }

    /// Puts closed rigid bodies at rest into the fluid, outside of the membranes, which are given once more. The fluid does
    /// not slip on them.
    ///
    /// # Panics
    /// If there are 2³² vertices or more, or an obstacle has not one position per vertex.
    pub fn set_obstacles(
        &mut self,
        membranes: &[Arc<TriangleMesh>],
        obstacles: &[(&TriangleMesh, &[[f64; 3]])],
    ) {
        if obstacles.is_empty() {
            return;
        }
        let solids = obstacles.iter().map(|(mesh, _)| *mesh);
        let meshes = membranes.iter().map(|mesh| &**mesh).chain(solids);
        let SingleLayer {
            viscosity, threads, ..
        } = self.single;
        self.single = SingleLayer::new(meshes, viscosity, threads);
        self.single.set_cluster_tolerance(self.cluster_tolerance);
        self.obstacles = Some(Obstacles::new(obstacles, viscosity));
        for all in [&mut self.forces, &mut self.velocities] {
            all.resize(self.single.vertex_count(), [0.0; 3]);
        }
    }

    /// Positions of the membranes and of the obstacles.
    fn everywhere<'a>(&self, positions: &'a [[f64; 3]]) -> Cow<'a, [[f64; 3]]> {
        match &self.obstacles {
            None => Cow::Borrowed(positions),
            Some(obstacles) => Cow::Owned([positions, &obstacles.positions].concat()),
        }
    }

    /// Sums velocities over clusters of vertices instead of all pairs, with this tolerance; 0 for all pairs.
    /// See [`SingleLayer::set_cluster_tolerance`] and [`DoubleLayer::set_cluster_tolerance`].
    pub fn set_cluster_tolerance(&mut self, tolerance: f64) {
        self.cluster_tolerance = tolerance;
        self.single.set_cluster_tolerance(tolerance);
        if let Some(double) = &mut self.double {
            double.set_cluster_tolerance(tolerance);
        }
    }

    /// Sets the course of the ambient flow, which [`Self::set_time`] follows.
    pub fn set_course(&mut self, course: Course) {
        self.factor = course.at(0.0);
        self.course = course;
    }

    /// Takes the ambient flow of this time from its course.
    pub fn set_time(&mut self, time: f64) {
        self.factor = self.course.at(time);
    }

    /// Keeps these volumes: velocities do not change them, and [`Self::restore_volumes`] removes the error
    /// of a step.
    pub fn keep_volumes(&mut self, volumes: KeptVolumes) {
        self.volumes = volumes;
    }

    /// Lets the vertices of these membranes slide along them.
    pub fn redistribute(&mut self, redistribution: Redistribution) {
        self.redistribution = redistribution;
    }

    /// Prepares linearly implicit steps, for membranes with these stiffnesses. The vertices of those that
    /// move along normals are redistributed. `tolerance` is the error that solutions may have, relative
    /// to the displacements of a step.
    ///
    /// # Panics
    /// If there is not one viscosity ratio per membrane.
    pub fn set_implicit(
        &mut self,
        membranes: Vec<Membrane>,
        viscosity_ratios: &[f64],
        tolerance: f64,
    ) {
        assert_eq!(
            membranes.len(),
            viscosity_ratios.len(),
            "one ratio per membrane"
        );
        let outside = self.single.viscosity;
        let mean = viscosity_ratios
            .iter()
            .map(|ratio| 0.5 * outside * (1.0 + ratio));
        self.mobility = Some(LocalMobility::new(
            membranes,
            &Vec::from_iter(mean),
            tolerance,
        ));
    }

    /// Sets the velocities of all vertices: those of the material, plus the sliding of vertices.
    ///
    /// # Errors
    /// The reason why the forces of the membranes cannot be computed.
    ///
    /// # Panics
    /// If there is not one position and one velocity per vertex.
    pub fn set_velocities(
        &mut self,
        membranes: &mut dyn Membranes,
        positions: &[[f64; 3]],
        velocities: &mut [[f64; 3]],
    ) -> Result<(), String> {
        self.set_material_velocities(membranes, positions, velocities)?;
        self.material.clear();
        self.material.extend_from_slice(velocities);
        self.redistribution.slide(positions, velocities);
        self.volumes.correct(positions, velocities);
        Ok(())
    }

    /// Sets the velocities of the material, which are those of the fluid.
    fn set_material_velocities(
        &mut self,
        membranes: &mut dyn Membranes,
        positions: &[[f64; 3]],
        velocities: &mut [[f64; 3]],
    ) -> Result<(), String> {
        let everywhere = self.everywhere(positions);
        let (own, solid) = self.forces.split_at_mut(positions.len());
        membranes.set_forces(positions, own)?;
        self.volumes.balance(positions, own);
        solid.fill([0.0; 3]);
        let all = &mut self.velocities;
        all.fill([0.0; 3]);
        if let Some(ambient) = &self.ambient {
            ambient.add_velocity(&everywhere, all);
            scale(all, self.factor);
        }
        let start = Instant::now();
        self.single.set_forces(&everywhere, &self.forces);
        self.single.add_at_vertices(all);
        self.single_layers.add(start);
        if self.solves(membranes) {
            self.solve(membranes, positions, &everywhere)?;
        }
        velocities.copy_from_slice(&self.velocities[..positions.len()]);
        Ok(())
    }

    /// Whether velocities are the solution of a linear system.
    fn solves(&self, membranes: &dyn Membranes) -> bool {
        self.double.is_some() || self.obstacles.is_some() || membranes.are_viscous()
    }

    /// Solves `u = b + K u` for u, and for the tractions of obstacles.
    fn solve(
        &mut self,
        membranes: &mut dyn Membranes,
        positions: &[[f64; 3]],
        everywhere: &[[f64; 3]],
    ) -> Result<(), String> {
        let Self {
            single,
            double,
            obstacles,
            forces,
            velocities,
            solver,
            recent,
            solution,
            products,
            single_layers,
            double_layers,
            ..
        } = self;
        let count = positions.len();
        if let Some(double) = double {
            double.set_positions(positions);
        }
        let mut apply = |x: &[[f64; 3]], product: &mut [[f64; 3]]| {
            let (u, tractions) = x.split_at(count);
            product.fill([0.0; 3]);
            if let Some(double) = double {
                let start = Instant::now();
                double.set_velocities(u);
                let (own, solid) = product.split_at_mut(count);
                double.add_at_vertices(own);
                if let Some(obstacles) = obstacles {
                    double.add_at_points(&obstacles.positions, solid);
                }
                double_layers.add(start);
            }
            if membranes.are_viscous() || obstacles.is_some() {
                let (own, solid) = forces.split_at_mut(count);
                own.fill([0.0; 3]);
                if membranes.are_viscous() {
                    membranes.add_viscous_forces(positions, u, own);
                }
                if let Some(obstacles) = obstacles {
                    obstacles.set_forces(tractions, solid);
                }
                let start = Instant::now();
                single.set_forces(everywhere, forces);
                single.add_at_vertices(product);
                single_layers.add(start);
            }
            let (own, solid) = product.split_at_mut(count);
            let entries = own.as_flattened_mut().iter_mut();
            for (product, u) in entries.zip(u.as_flattened()) {
                *product = u - *product;
            }
            // The velocity on obstacles is 0: that of all else is minus that of their tractions.
            if let Some(obstacles) = obstacles {
                obstacles.add_mean_pressure(tractions, solid);
            }
        };
        // `b + K u + S q = 0` on obstacles.
        for component in velocities[count..].as_flattened_mut() {
            *component = -*component;
        }
        solution.clear();
        solution.extend_from_slice(velocities);
        recent.guess(velocities, solution);
        let solved = solver.solve(&mut apply, velocities, solution);
        *products += solved.products as u64;
        if solved.converged {
            recent.keep(velocities, solution);
            velocities.copy_from_slice(solution);
            return Ok(());
        }
        Err(format!(
            "after {} products the velocities, which viscosity or obstacles make depend on themselves, are still \
             wrong by {:.1e} of their size, and {:.0e} is needed",
            solved.products, solved.residual, solver.tolerance
        ))
    }

    /// Velocity and pressure at points of the fluid, on either side of the membranes.
    ///
    /// The pressure is that due to the forces of membranes plus that of the ambient flow. It jumps across
    /// a membrane by the normal force per area.
    ///
    /// # Errors
    /// The reason why the flow cannot be computed.
    ///
    /// # Panics
    /// If there is not one position per vertex.
    pub fn fluid_at(
        &mut self,
        membranes: &mut dyn Membranes,
        positions: &[[f64; 3]],
        points: &[[f64; 3]],
    ) -> Result<Fluid, String> {
        // An evaluation at other points must not change the next initial guess.
        let recent = self.recent.clone();
        let mut moving = vec![[0.0; 3]; positions.len()];
        let evaluated = self.set_material_velocities(membranes, positions, &mut moving);
        self.recent = recent;
        evaluated?;
        let mut fluid = Fluid {
            velocity: vec![[0.0; 3]; points.len()],
            pressure: vec![0.0; points.len()],
        };
        if let Some(ambient) = &self.ambient {
            ambient.add_velocity(points, &mut fluid.velocity);
            scale(&mut fluid.velocity, self.factor);
            for (pressure, &point) in fluid.pressure.iter_mut().zip(points) {
                *pressure += self.factor * ambient.pressure(point, self.single.viscosity);
            }
        }
        let everywhere = self.everywhere(positions);
        let count = positions.len();
        let (own, solid) = self.forces.split_at_mut(count);
        membranes.set_forces(positions, own)?;
        if membranes.are_viscous() {
            membranes.add_viscous_forces(positions, &self.solution[..count], own);
        }
        if let Some(obstacles) = &self.obstacles {
            obstacles.set_forces(&self.solution[count..], solid);
        }
        self.single.set_forces(&everywhere, &self.forces);
        self.single
            .add_pressure_at_points(points, &mut fluid.pressure);
        self.volumes.balance(positions, &mut self.forces[..count]);
        self.single.set_forces(&everywhere, &self.forces);
        self.single.add_at_points(points, &mut fluid.velocity);
        if let Some(double) = &mut self.double {
            double.set_positions(positions);
            double.set_velocities(&self.solution[..count]);
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

    /// Moves positions so that volumes have their initial values.
    pub fn restore_volumes(&mut self, positions: &mut [[f64; 3]]) {
        self.volumes.restore(positions);
    }

    /// The effort of boundary integrals so far, of each that is used.
    pub fn efforts(&self) -> Vec<(&'static str, Effort)> {
        let mut efforts = vec![("single_layer", self.single_layers)];
        if self.double.is_some() {
            efforts.push(("double_layer", self.double_layers));
        }
        efforts.extend(self.redistribution.effort());
        efforts
    }

    /// Number of products with the stiffness of the membranes in linearly implicit steps so far.
    pub fn stiffness_products(&self) -> u64 {
        self.mobility.as_ref().map_or(0, LocalMobility::products)
    }

    /// Number of matrix products of all solutions so far.
    pub fn products(&self) -> u64 {
        self.products
    }

    /// The last solutions, from which the next one starts; part of the state of a run that continues
    /// bit for bit.
    pub fn recent(&self) -> &Recent {
        &self.recent
    }

    /// Restores stored solutions.
    pub fn set_recent(&mut self, recent: Recent) {
        self.recent = recent;
    }

    /// The velocities of the material at the last evaluation; empty before the first.
    pub fn material_velocities(&self) -> &[[f64; 3]] {
        &self.material
    }

    /// The relative error of velocities that do not come from a linear system, as it appears in
    /// differences of velocities, whose displacement is the square root of this error.
    pub fn precision(&self) -> f64 {
        // Differences are needed along the stiffest motion, where a displacement by the tolerance of
        // clusters changes velocities by far more than this tolerance.
        let clusters = self.cluster_tolerance * self.cluster_tolerance;
        self.redistribution.precision().max(clusters)
    }

    /// Whether fluids of several viscosities meet.
    pub fn has_contrast(&self) -> bool {
        self.double.is_some()
    }

    /// Whether there are bodies at rest.
    pub fn has_obstacles(&self) -> bool {
        self.obstacles.is_some()
    }
}

/// Multiplies vectors by a factor.
fn scale(vectors: &mut [[f64; 3]], factor: f64) {
    for component in vectors.as_flattened_mut() {
        *component *= factor;
    }
}

/// The right-hand side of an integration in time: the velocities of these membranes.
#[derive(Debug)]
pub struct Moving<'a, M> {
    /// The fluid.
    pub suspension: &'a mut Suspension,
    /// The membranes that move.
    pub membranes: &'a mut M,
}

impl<M: Membranes> RightHandSide for Moving<'_, M> {
    fn evaluate(
        &mut self,
        positions: &[[f64; 3]],
        time: f64,
        velocities: &mut [[f64; 3]],
    ) -> Result<(), String> {
        self.suspension.set_time(time);
        self.suspension
            .set_velocities(self.membranes, positions, velocities)
    }

    fn linearise(&mut self, positions: &[[f64; 3]], _time: f64) -> Result<(), String> {
        match &mut self.suspension.mobility {
            Some(mobility) => mobility.set(self.membranes, positions),
            None => Ok(()),
        }
    }

    fn solve(&mut self, c: f64, field: &mut [[f64; 3]]) -> Result<(), String> {
        let Suspension {
            mobility,
            redistribution,
            volumes,
            ..
        } = &mut *self.suspension;
        if let Some(mobility) = mobility {
            let mut change = mobility.change(self.membranes, c, field)?;
            redistribution.respond(mobility.positions(), &mut change);
            volumes.correct(mobility.positions(), &mut change);
            let entries = field.as_flattened_mut().iter_mut();
            for (entry, change) in entries.zip(change.as_flattened()) {
                *entry += change;
            }
        }
        Ok(())
    }

    fn restore(&mut self, positions: &mut [[f64; 3]]) {
        self.suspension.restore_volumes(positions);
    }
}
