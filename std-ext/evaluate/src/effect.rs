//! What acts on one surface of a scene: exactly the effects that it names.
//!
//! The choice is made once a surface; an evaluation is one dispatch for each effect, and from there on
//! everything is resolved at compile time. An effect that is not named is not there: it has no
//! memory, no loop and no time.

use crate::execute::Parallel;
use crate::method::BendingMethod;
use helfrich::laplacian::Bandwidth;
use helfrich::{
    Components, Conservative, Cotangent, DualArea, Finding, GompperKroll, HeatKernel, Jet,
    Juelicher, KantorNelson, LaplaceBeltrami, LoopSubdivision, MembraneViscosity, Method, Prepared,
    Projected, RigidBody, StrongForm, Surface, TriangleMesh, remove_net_force_and_torque,
};
use serde::Serialize;
use std::fmt;
use std::time::{Duration, Instant};

/// What an effect is, as scenes call it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EffectKind {
    /// Bending.
    Bending,
    /// Elasticity in the surface's plane.
    Elasticity,
    /// A penalty on the area of each triangle.
    LocalArea,
    /// A penalty on the total area.
    Area,
    /// A penalty on the volume.
    Volume,
    /// A penalty on the difference of the leaflets' areas.
    AreaDifference,
    /// Surface tension.
    Tension,
    /// Osmotic pressure.
    Pressure,
    /// Gravity and buoyancy.
    Gravity,
    /// Opposite forces at the ends.
    Stretching,
}

impl EffectKind {
    /// Its key in a scene, and the end of its columns' names.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bending => "bending",
            Self::Elasticity => "elasticity",
            Self::LocalArea => "local_area",
            Self::Area => "area",
            Self::Volume => "volume",
            Self::AreaDifference => "area_difference",
            Self::Tension => "tension",
            Self::Pressure => "pressure",
            Self::Gravity => "gravity",
            Self::Stretching => "stretching",
        }
    }
}

impl fmt::Display for EffectKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

/// How the force densities that a method finds become nodal forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Lumping {
    /// With the method's own areas, with which its energy is a sum over vertices.
    Own,
    /// With a third of the triangles around each vertex: for a flow, to which F_i over just these
    /// is the force per area.
    Thirds,
}

/// One effect, ready for one mesh.
#[derive(Debug)]
pub struct Effect {
    kind: EffectKind,
    conservative: bool,
    prepared: Box<dyn Act>,
    evaluations: u64,
    time: Duration,
}

impl Effect {
    /// Any method whose force is the gradient of its energy.
    pub fn conservative<M>(kind: EffectKind, method: M, mesh: &TriangleMesh) -> Self
    where
        M: Conservative<f64> + fmt::Debug + 'static,
        M::Plan: fmt::Debug,
        M::Memory: fmt::Debug,
    {
        Self::new(kind, true, Box::new(prepared(method, mesh)))
    }

    /// A bending method with modulus κ and spontaneous curvature H0, for a surface as it starts. Forces of methods that have no
    /// energy are freed of net force and torque, which nothing in a scene would balance.
    pub fn bending(
        method: BendingMethod,
        modulus: f64,
        spontaneous_curvature: f64,
        lumping: Lumping,
        surface: Surface<'_, f64>,
    ) -> Self {
        let kind = EffectKind::Bending;
        let mesh = surface.mesh();
        match method {
            // Its energy has no place for spontaneous curvature; scenes that ask for it are refused.
            BendingMethod::KantorNelson => {
                Self::conservative(kind, KantorNelson::new(modulus), mesh)
            }
            BendingMethod::GompperKroll => {
                // Signed areas leave the energy without a lower bound.
                let mut method = GompperKroll::with_mixed_areas(modulus);
                method.spontaneous_curvature = spontaneous_curvature.into();
                Self::conservative(kind, method, mesh)
            }
            BendingMethod::Loop => {
                let mut method = LoopSubdivision::new(modulus);
                method.spontaneous_curvature = spontaneous_curvature.into();
                Self::conservative(kind, method, mesh)
            }
            BendingMethod::Juelicher => {
                let mut method = Juelicher::new(modulus);
                method.spontaneous_curvature = spontaneous_curvature.into();
                Self::conservative(kind, method, mesh)
            }
            BendingMethod::Meyer => strong_form(
                StrongForm::meyer(modulus),
                spontaneous_curvature,
                lumping,
                mesh,
            ),
            BendingMethod::Belkin => {
                let operator = HeatKernel::new(converging_bandwidth(surface));
                strong_form(
                    StrongForm::new(modulus, operator),
                    spontaneous_curvature,
                    lumping,
                    mesh,
                )
            }
            BendingMethod::Farutin => strong_form(
                StrongForm::farutin(modulus),
                spontaneous_curvature,
                lumping,
                mesh,
            ),
            BendingMethod::J4 => strong_form(
                StrongForm::j4(modulus),
                spontaneous_curvature,
                lumping,
                mesh,
            ),
            BendingMethod::J6 => strong_form(
                StrongForm::j6(modulus),
                spontaneous_curvature,
                lumping,
                mesh,
            ),
            BendingMethod::Jet => {
                let method = StrongForm::new(modulus, Jet::for_mesh(mesh));
                strong_form(method, spontaneous_curvature, lumping, mesh)
            }
        }
    }

    fn new(kind: EffectKind, conservative: bool, prepared: Box<dyn Act>) -> Self {
        Self {
            kind,
            conservative,
            prepared,
            evaluations: 0,
            time: Duration::ZERO,
        }
    }

    /// What it is.
    pub fn kind(&self) -> EffectKind {
        self.kind
    }

    /// Whether its force is the gradient of its energy.
    pub fn is_conservative(&self) -> bool {
        self.conservative
    }

    /// Adds nodal forces and returns the energy; of a method in strong form, the energy that goes
    /// with it, of which the force is not the gradient.
    ///
    /// # Panics
    /// If `force` has fewer entries than the surface has vertices.
    pub fn add_force(&mut self, surface: Surface<'_, f64>, force: &mut [[f64; 3]]) -> f64 {
        let start = Instant::now();
        let energy = self.prepared.add_force(surface, force);
        self.time += start.elapsed();
        self.evaluations += 1;
        energy
    }

    /// The same for a picture or a file: it does not count as cost.
    ///
    /// # Panics
    /// As [`Self::add_force`].
    pub fn add_force_unseen(&mut self, surface: Surface<'_, f64>, force: &mut [[f64; 3]]) -> f64 {
        self.prepared.add_force(surface, force)
    }

    /// Puts another method in this one's place; what it has cost so far stays.
    pub fn replace<M>(&mut self, method: M, mesh: &TriangleMesh)
    where
        M: Conservative<f64> + fmt::Debug + 'static,
        M::Plan: fmt::Debug,
        M::Memory: fmt::Debug,
    {
        self.prepared = Box::new(prepared(method, mesh));
        self.conservative = true;
    }

    /// How often it has been evaluated, and the time that this took.
    pub fn cost(&self) -> (u64, Duration) {
        (self.evaluations, self.time)
    }

    /// See [`helfrich::Method::inspect`].
    pub fn inspect(&self, surface: Surface<'_, f64>, report: &mut dyn FnMut(Finding)) {
        self.prepared.inspect(surface, report);
    }
}

fn strong_form<L>(
    mut method: StrongForm<f64, L>,
    spontaneous_curvature: f64,
    lumping: Lumping,
    mesh: &TriangleMesh,
) -> Effect
where
    L: LaplaceBeltrami<f64, Plan: fmt::Debug, Memory: fmt::Debug> + fmt::Debug + Sync + 'static,
{
    method.spontaneous_curvature = spontaneous_curvature.into();
    let prepared: Box<dyn Act> = match lumping {
        Lumping::Own => Box::new(InStrongForm(prepared(Projected(method), mesh))),
        Lumping::Thirds => Box::new(Lumped::new(method, mesh)),
    };
    Effect::new(EffectKind::Bending, false, prepared)
}

/// The bandwidth of method D in units of the mean area of a vertex is √N/100: ¼ and ½ at 642 and
/// 2562 vertices. The area itself, as published, would leave the error as large as it is.
fn converging_bandwidth(surface: Surface<'_, f64>) -> Bandwidth<f64> {
    let vertices = surface.mesh().vertex_count() as f64;
    Bandwidth::Global(surface.area() / (100.0 * vertices.sqrt()))
}

/// On all threads, of which no bit depends.
fn prepared<M: Method<f64>>(method: M, mesh: &TriangleMesh) -> Prepared<f64, M, Parallel> {
    Prepared::with_execution(method, mesh, Parallel::new())
}

/// What a prepared effect can be asked for, whichever it is.
trait Act: fmt::Debug {
    fn add_force(&mut self, surface: Surface<'_, f64>, force: &mut [[f64; 3]]) -> f64;

    fn inspect(&self, surface: Surface<'_, f64>, report: &mut dyn FnMut(Finding));
}

impl<M> Act for Prepared<f64, M, Parallel>
where
    M: Conservative<f64> + fmt::Debug,
    M::Plan: fmt::Debug,
    M::Memory: fmt::Debug,
{
    fn add_force(&mut self, surface: Surface<'_, f64>, force: &mut [[f64; 3]]) -> f64 {
        self.add_force_and_energy(surface, force)
    }

    fn inspect(&self, surface: Surface<'_, f64>, report: &mut dyn FnMut(Finding)) {
        self.inspect(surface, report);
    }
}

/// A method in strong form: its force is the gradient of no energy.
#[derive(Debug)]
struct InStrongForm<L>(Prepared<f64, Projected<StrongForm<f64, L>>, Parallel>)
where
    L: LaplaceBeltrami<f64, Plan: fmt::Debug, Memory: fmt::Debug> + Sync;

impl<L> Act for InStrongForm<L>
where
    L: LaplaceBeltrami<f64, Plan: fmt::Debug, Memory: fmt::Debug> + fmt::Debug + Sync,
{
    fn add_force(&mut self, surface: Surface<'_, f64>, force: &mut [[f64; 3]]) -> f64 {
        self.0.add_force(surface, force);
        self.0.with(|Projected(method), execution, _, memory| {
            method.energy_of(execution, &memory.method)
        })
    }

    fn inspect(&self, surface: Surface<'_, f64>, report: &mut dyn FnMut(Finding)) {
        self.0.inspect(surface, report);
    }
}

/// A method in strong form by [`Lumping::Thirds`].
#[derive(Debug)]
struct Lumped<L>
where
    L: LaplaceBeltrami<f64, Plan: fmt::Debug, Memory: fmt::Debug> + Sync,
{
    method: Prepared<f64, StrongForm<f64, L>, Parallel>,
    components: Components,
    areas: Vec<f64>,
    bodies: Vec<RigidBody<f64>>,
    force: Vec<[f64; 3]>,
}

impl<L> Lumped<L>
where
    L: LaplaceBeltrami<f64, Plan: fmt::Debug, Memory: fmt::Debug> + Sync,
{
    fn new(method: StrongForm<f64, L>, mesh: &TriangleMesh) -> Self {
        Self {
            method: prepared(method, mesh),
            components: Components::new(mesh),
            areas: vec![0.0; mesh.vertex_count()],
            bodies: Vec::new(),
            force: vec![[0.0; 3]; mesh.vertex_count()],
        }
    }
}

impl<L> Act for Lumped<L>
where
    L: LaplaceBeltrami<f64, Plan: fmt::Debug, Memory: fmt::Debug> + fmt::Debug + Sync,
{
    fn add_force(&mut self, surface: Surface<'_, f64>, force: &mut [[f64; 3]]) -> f64 {
        let thirds = Cotangent::new(DualArea::Barycentric);
        thirds.dual_areas(&Parallel::new(), surface, &mut self.areas);
        self.method.force_density(surface, &mut self.force);
        for (force, area) in self.force.iter_mut().zip(&self.areas) {
            *force = force.map(|density| area * density);
        }
        remove_net_force_and_torque(
            &self.components,
            surface,
            &self.areas,
            &mut self.bodies,
            &mut self.force,
        );
        for (sum, own) in force.iter_mut().zip(&self.force) {
            *sum = std::array::from_fn(|axis| sum[axis] + own[axis]);
        }
        self.method
            .with(|method, execution, _, memory| method.energy_of(execution, memory))
    }

    fn inspect(&self, surface: Surface<'_, f64>, report: &mut dyn FnMut(Finding)) {
        self.method.inspect(surface, report);
    }
}

/// The viscosity of a membrane, ready for one mesh: the one effect that depends on velocities.
#[derive(Debug)]
pub struct Viscosity {
    prepared: Prepared<f64, MembraneViscosity<f64>, Parallel>,
    evaluations: u64,
    time: Duration,
}

impl Viscosity {
    /// Its name in a scene, and the end of its columns' names.
    pub const NAME: &'static str = "membrane_viscosity";

    /// Prepares it.
    pub fn new(viscosity: MembraneViscosity<f64>, mesh: &TriangleMesh) -> Self {
        Self {
            prepared: prepared(viscosity, mesh),
            evaluations: 0,
            time: Duration::ZERO,
        }
    }

    /// Adds the nodal forces that go with these velocities of the vertices.
    ///
    /// # Panics
    /// If there are fewer velocities or forces than the surface has vertices.
    pub fn add_force(
        &mut self,
        surface: Surface<'_, f64>,
        velocities: &[[f64; 3]],
        force: &mut [[f64; 3]],
    ) {
        let start = Instant::now();
        self.prepared
            .add_dissipative_force(surface, velocities, force);
        self.time += start.elapsed();
        self.evaluations += 1;
    }

    /// How often it has been evaluated, and the time that this took.
    pub fn cost(&self) -> (u64, Duration) {
        (self.evaluations, self.time)
    }
}
