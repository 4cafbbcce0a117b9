//! The effects on one surface of a scene.
//!
//! Methods are chosen once per surface. An evaluation makes one dynamic call for each effect;
//! everything below is resolved at compile time. An effect that the scene does not name takes no
//! memory and no time.

use crate::act::Act;
use crate::execute::Parallel;
use crate::method::{BendingMethod, MethodOptions, Settings, Visitor, choose};
use helfrich::{
    AnyFunctional, AreaDifference, Aspiration, BorderTension, Components, Conservative, Constraint,
    Cotangent, Curvatures, DualArea, EndPull, Energy, Finding, ForceDensity, GaussianBending,
    GaussianDomains, Gravity, InPlane, LaplaceBeltrami, LineTension, LocalArea, MaterialParameter,
    MembraneViscosity, Method, NeoHookean, OsmoticPressure, ParameterError, Penalty, PointLoads,
    Prepared, Projected, ReferenceError, RigidBody, Skalak, StrainEnergy, StrongForm, Surface,
    SurfaceTension, Targets, TriangleMesh, WallAdhesion, remove_net_force_and_torque,
};
use helfrich_execute::clock;
use std::fmt;
use std::time::Duration;

/// Areas by which the force densities of a method are multiplied to give nodal forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Lumping {
    /// The method's own areas, over which its energy is a sum.
    Own,
    /// A third of the area of the triangles around each vertex, for flows, which divide F_i by the
    /// same area.
    Thirds,
}

/// One effect, prepared for one mesh.
#[derive(Debug)]
pub struct Effect {
    name: &'static str,
    conservative: bool,
    prepared: Box<dyn Act<f64>>,
    evaluations: u64,
    time: Duration,
}

impl Effect {
    /// Prepares a method whose force is the gradient of its energy.
    ///
    /// # Errors
    /// If a parameter is out of its range.
    pub fn conservative(
        name: &'static str,
        method: impl CompiledPotential,
        mesh: &TriangleMesh,
    ) -> Result<Self, ParameterError> {
        method.check()?;
        Ok(Self::new(name, true, method.prepared(mesh).0))
    }

    /// Prepares a bending method with this modulus κ and spontaneous curvature H0. Net force and torque are
    /// removed from forces without an energy, because nothing else in a scene would balance them.
    ///
    /// # Errors
    /// If the method is an operator for curvatures only, or if it is kantor-nelson (A) and one of the
    /// parameters varies.
    pub fn bending(
        name: &'static str,
        method: BendingMethod,
        options: &MethodOptions,
        [modulus, spontaneous_curvature]: [MaterialParameter<f64>; 2],
        lumping: Lumping,
        mesh: &TriangleMesh,
    ) -> Result<Self, CannotBend> {
        CannotBend::unless_uniform(method, [&modulus, &spontaneous_curvature])?;
        let settings = Settings {
            modulus,
            spontaneous_curvature,
            options,
            mesh,
        };
        choose(
            method,
            settings,
            Acting {
                name,
                bending: method,
                lumping,
                mesh,
            },
        )
    }

    fn new(name: &'static str, conservative: bool, prepared: Box<dyn Act<f64>>) -> Self {
        Self {
            name,
            conservative,
            prepared,
            evaluations: 0,
            time: Duration::ZERO,
        }
    }

    /// The name of the effect, which ends the names of its columns.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Whether its force is the gradient of its energy.
    pub fn is_conservative(&self) -> bool {
        self.conservative
    }

    /// Adds nodal forces and returns the energy. For a method in strong form this is its quadrature
    /// of the energy, whose gradient is not the force.
    ///
    /// # Panics
    /// If `force` has fewer entries than the surface has vertices.
    pub fn add_force(&mut self, surface: Surface<'_, f64>, force: &mut [[f64; 3]]) -> f64 {
        let start = clock::now();
        let energy = self.prepared.add_force(surface, force);
        self.time += clock::since(start);
        self.evaluations += 1;
        energy
    }

    /// The energy alone, which [`Self::add_force`] returns, too.
    pub fn energy(&mut self, surface: Surface<'_, f64>) -> f64 {
        let start = clock::now();
        let energy = self.prepared.energy(surface);
        self.time += clock::since(start);
        self.evaluations += 1;
        energy
    }

    /// Adds the forces for a picture or a file, without counting the evaluation and its time.
    ///
    /// # Panics
    /// As [`Self::add_force`].
    pub fn add_force_uncounted(
        &mut self,
        surface: Surface<'_, f64>,
        force: &mut [[f64; 3]],
    ) -> f64 {
        self.prepared.add_force(surface, force)
    }

    /// Replaces the method, and keeps the count of evaluations and their time.
    pub fn replace(&mut self, method: impl CompiledPotential, mesh: &TriangleMesh) {
        self.prepared = method.prepared(mesh).0;
        self.conservative = true;
    }

    /// Number of evaluations, and their total time.
    pub fn cost(&self) -> (u64, Duration) {
        (self.evaluations, self.time)
    }

    /// Adds the cost of the same effect on an earlier mesh.
    pub fn continue_cost(&mut self, earlier: &Self) {
        self.evaluations += earlier.evaluations;
        self.time += earlier.time;
    }

    /// See [`helfrich::Method::inspect`].
    pub fn inspect(&self, surface: Surface<'_, f64>, report: &mut dyn FnMut(Finding)) {
        self.prepared.inspect(surface, report);
    }
}

/// A method whose force is the gradient of its energy, with loops that are compiled in this crate, so that
/// they are fast however the calling crate is optimised.
///
/// A new effect needs one more line in the list below.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not in the list of potentials",
    note = "add it to `potentials!` in std-ext/evaluate/src/effect.rs, where its loops are compiled"
)]
pub trait CompiledPotential: Conservative<f64> + Send {
    /// Prepares the method for a mesh.
    fn prepared(self, mesh: &TriangleMesh) -> PreparedPotential;
}

/// A [`CompiledPotential`] prepared for a mesh.
#[derive(Debug)]
pub struct PreparedPotential(Box<dyn Act<f64>>);

macro_rules! potentials {
    ($($method:ty),* $(,)?) => {$(
        impl CompiledPotential for $method {
            fn prepared(self, mesh: &TriangleMesh) -> PreparedPotential {
                PreparedPotential(Box::new(prepared(self, mesh)))
            }
        }
    )*};
}

potentials! {
    AreaDifference<f64>,
    Aspiration<f64>,
    BorderTension<f64>,
    EndPull<f64>,
    GaussianBending<f64>,
    GaussianDomains<f64>,
    Gravity<f64>,
    InPlane<f64, LocalArea<f64>>,
    InPlane<f64, NeoHookean<f64>>,
    InPlane<f64, Skalak<f64>>,
    LineTension<f64>,
    OsmoticPressure<f64>,
    Penalty<f64, AnyFunctional>,
    PointLoads<f64>,
    SurfaceTension<f64>,
    WallAdhesion<f64>,
}

/// A law of in-plane elasticity whose surface is free of stress at some positions, scaled by a factor.
///
/// # Errors
/// If a triangle has no area there, or the factor is not positive.
pub fn in_plane<W: StrainEnergy<f64>>(
    law: W,
    unstressed: Surface<'_, f64>,
    scale: f64,
) -> Result<InPlane<f64, W>, ReferenceError> {
    InPlane::new(law, unstressed.mesh(), unstressed)?.with_scaled_reference(scale)
}

/// A part of a membrane.
#[derive(Debug)]
pub enum MembranePart {
    /// An effect that acts by its forces.
    Acting(Effect),
    /// A quantity of each component that is held exactly.
    Held(Constraint<f64>),
}

impl MembranePart {
    /// Area, volume or area difference, kept at targets by a penalty with this modulus, or exactly without one.
    ///
    /// # Errors
    /// If the modulus or a target is out of its range.
    pub fn keeping(
        name: &'static str,
        functional: AnyFunctional,
        modulus: Option<f64>,
        targets: Targets<f64>,
        mesh: &TriangleMesh,
    ) -> Result<Self, ParameterError> {
        let Some(modulus) = modulus else {
            return Ok(Self::Held(Constraint {
                functional,
                targets,
            }));
        };
        let effect = if functional == AnyFunctional::MeanCurvature {
            Effect::conservative(name, AreaDifference::new(modulus, targets), mesh)
        } else {
            let penalty = Penalty::new(functional, modulus, targets);
            Effect::conservative(name, penalty, mesh)
        };
        effect.map(Self::Acting)
    }
}

/// Reason why a method cannot act.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CannotBend {
    /// The method has no forces.
    #[error("{0} measures curvatures only and has no force: choose a bending method, such as j4")]
    NoForce(BendingMethod),
    /// The method has no parameters per vertex.
    #[error("{0} has one modulus for all edges: choose another method for one that varies")]
    Uniform(BendingMethod),
}

impl CannotBend {
    /// Refuses a modulus or a spontaneous curvature that varies, where the method has one for all edges.
    pub(crate) fn unless_uniform(
        method: BendingMethod,
        material: [&MaterialParameter<f64>; 2],
    ) -> Result<(), Self> {
        if method == BendingMethod::KantorNelson && material.iter().any(|own| own.varies()) {
            return Err(Self::Uniform(method));
        }
        Ok(())
    }
}

/// Visitor that prepares a bending method as an effect.
struct Acting<'a> {
    name: &'static str,
    bending: BendingMethod,
    lumping: Lumping,
    mesh: &'a TriangleMesh,
}

impl Visitor<f64> for Acting<'_> {
    type Output = Result<Effect, CannotBend>;

    fn energy<M>(self, method: M) -> Self::Output
    where
        M: Conservative<f64> + fmt::Debug + Send + 'static,
    {
        let prepared = Box::new(prepared(method, self.mesh));
        Ok(Effect::new(self.name, true, prepared))
    }

    fn energy_and_curvatures<M>(self, method: M) -> Self::Output
    where
        M: Conservative<f64> + Curvatures<f64> + fmt::Debug + Send + 'static,
    {
        self.energy(method)
    }

    fn energy_and_density<M>(self, method: M) -> Self::Output
    where
        M: Conservative<f64> + Curvatures<f64> + ForceDensity<f64> + fmt::Debug + Send + 'static,
    {
        match self.lumping {
            Lumping::Own => self.energy(method),
            Lumping::Thirds => {
                // Densities last: findings are about them.
                let evaluate: Evaluation<M> = |prepared, surface, density| {
                    let energy = prepared.energy(surface);
                    prepared.force_density(surface, density);
                    energy
                };
                let lumped = Lumped::new(method, evaluate, self.mesh);
                Ok(Effect::new(self.name, false, Box::new(lumped)))
            }
        }
    }

    fn strong_form<L>(self, method: StrongForm<f64, L>) -> Self::Output
    where
        L: LaplaceBeltrami<f64> + fmt::Debug + Send + Sync + 'static,
    {
        let prepared: Box<dyn Act<f64>> = match self.lumping {
            Lumping::Own => Box::new(InStrongForm(prepared(Projected(method), self.mesh))),
            Lumping::Thirds => {
                // The force density leaves everything that the energy needs.
                let evaluate: Evaluation<StrongForm<f64, L>> = |prepared, surface, density| {
                    prepared.force_density(surface, density);
                    prepared.with(|method, execution, workspace| {
                        method.energy_of(execution, workspace.memory())
                    })
                };
                Box::new(Lumped::new(method, evaluate, self.mesh))
            }
        };
        Ok(Effect::new(self.name, false, prepared))
    }

    fn curvatures<M>(self, _method: M) -> Self::Output
    where
        M: Curvatures<f64> + fmt::Debug + Send + 'static,
    {
        Err(CannotBend::NoForce(self.bending))
    }
}

/// Prepares a method on all threads; no bit of the results depends on their number.
fn prepared<M: Method<f64>>(method: M, mesh: &TriangleMesh) -> Prepared<f64, M, Parallel> {
    Prepared::with_execution(method, mesh, Parallel::new())
}

impl<M> Act<f64> for Prepared<f64, M, Parallel>
where
    M: Conservative<f64> + fmt::Debug + Send,
{
    fn add_force(&mut self, surface: Surface<'_, f64>, force: &mut [[f64; 3]]) -> f64 {
        self.add_force_and_energy(surface, force)
    }

    fn energy(&mut self, surface: Surface<'_, f64>) -> f64 {
        Prepared::energy(self, surface)
    }

    fn inspect(&self, surface: Surface<'_, f64>, report: &mut dyn FnMut(Finding)) {
        self.inspect(surface, report);
    }
}

/// A prepared method in strong form, whose force is not the gradient of an energy.
#[derive(Debug)]
struct InStrongForm<L>(Prepared<f64, Projected<StrongForm<f64, L>>, Parallel>)
where
    L: LaplaceBeltrami<f64> + Sync;

impl<L> Act<f64> for InStrongForm<L>
where
    L: LaplaceBeltrami<f64> + fmt::Debug + Send + Sync,
{
    fn add_force(&mut self, surface: Surface<'_, f64>, force: &mut [[f64; 3]]) -> f64 {
        self.0.add_force(surface, force);
        self.0.with(|Projected(method), execution, workspace| {
            method.energy_of(execution, workspace.memory().method.memory())
        })
    }

    fn energy(&mut self, surface: Surface<'_, f64>) -> f64 {
        self.0.energy(surface)
    }

    fn inspect(&self, surface: Surface<'_, f64>, report: &mut dyn FnMut(Finding)) {
        self.0.inspect(surface, report);
    }
}

/// Sets force densities, and returns the energy.
type Evaluation<M> =
    fn(&mut Prepared<f64, M, Parallel>, Surface<'_, f64>, &mut Vec<[f64; 3]>) -> f64;

/// A prepared method whose force density acts, with [`Lumping::Thirds`].
#[derive(Debug)]
struct Lumped<M: Method<f64>> {
    method: Prepared<f64, M, Parallel>,
    evaluate: Evaluation<M>,
    components: Components,
    areas: Vec<f64>,
    bodies: Vec<RigidBody<f64>>,
    force: Vec<[f64; 3]>,
}

impl<M: Method<f64>> Lumped<M> {
    fn new(method: M, evaluate: Evaluation<M>, mesh: &TriangleMesh) -> Self {
        Self {
            method: prepared(method, mesh),
            evaluate,
            components: Components::new(mesh),
            areas: vec![0.0; mesh.vertex_count()],
            bodies: Vec::new(),
            force: vec![[0.0; 3]; mesh.vertex_count()],
        }
    }
}

impl<M> Act<f64> for Lumped<M>
where
    M: Energy<f64> + fmt::Debug + Send,
    M::Memory: Send,
{
    fn add_force(&mut self, surface: Surface<'_, f64>, force: &mut [[f64; 3]]) -> f64 {
        let thirds = Cotangent::new(DualArea::Barycentric);
        thirds.dual_areas(&Parallel::new(), surface, &mut self.areas);
        let energy = (self.evaluate)(&mut self.method, surface, &mut self.force);
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
        energy
    }

    fn energy(&mut self, surface: Surface<'_, f64>) -> f64 {
        self.method.energy(surface)
    }

    fn inspect(&self, surface: Surface<'_, f64>, report: &mut dyn FnMut(Finding)) {
        self.method.inspect(surface, report);
    }
}

/// The viscosity of a membrane, prepared for one mesh; the only effect that depends on velocities.
#[derive(Debug)]
pub struct Viscosity {
    prepared: Prepared<f64, MembraneViscosity<f64>, Parallel>,
    evaluations: u64,
    time: Duration,
}

impl Viscosity {
    /// Name of the effect in a scene, which ends the names of its columns.
    pub const NAME: &'static str = "membrane_viscosity";

    /// Prepares the viscosity for a mesh.
    pub fn new(viscosity: MembraneViscosity<f64>, mesh: &TriangleMesh) -> Self {
        Self {
            prepared: prepared(viscosity, mesh),
            evaluations: 0,
            time: Duration::ZERO,
        }
    }

    /// Adds the nodal forces at these velocities of the vertices.
    ///
    /// # Panics
    /// If there are fewer velocities or forces than the surface has vertices.
    pub fn add_force(
        &mut self,
        surface: Surface<'_, f64>,
        velocities: &[[f64; 3]],
        force: &mut [[f64; 3]],
    ) {
        let start = clock::now();
        self.prepared
            .add_dissipative_force(surface, velocities, force);
        self.time += clock::since(start);
        self.evaluations += 1;
    }

    /// Number of evaluations, and their total time.
    pub fn cost(&self) -> (u64, Duration) {
        (self.evaluations, self.time)
    }
}
