//! What acts on one surface of a scene: exactly the effects that it names.
//!
//! The choice is made once a surface; an evaluation is one dispatch for each effect, and from there on
//! everything is resolved at compile time. An effect that is not named is not there: it has no
//! memory, no loop and no time.

use crate::method::BendingMethod;
use helfrich::{
    Conservative, Finding, GompperKroll, Jet, Juelicher, KantorNelson, LaplaceBeltrami,
    LoopSubdivision, Prepared, Projected, StrongForm, Surface, TriangleMesh,
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
        Self::new(kind, true, Box::new(Prepared::new(method, mesh)))
    }

    /// A bending method with modulus κ and spontaneous curvature H0.
    pub fn bending(
        method: BendingMethod,
        modulus: f64,
        spontaneous_curvature: f64,
        mesh: &TriangleMesh,
    ) -> Self {
        let kind = EffectKind::Bending;
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
            BendingMethod::Meyer => {
                Self::strong_form(StrongForm::meyer(modulus), spontaneous_curvature, mesh)
            }
            BendingMethod::Belkin => {
                Self::strong_form(StrongForm::belkin(modulus), spontaneous_curvature, mesh)
            }
            BendingMethod::Farutin => {
                Self::strong_form(StrongForm::farutin(modulus), spontaneous_curvature, mesh)
            }
            BendingMethod::J4 => {
                Self::strong_form(StrongForm::j4(modulus), spontaneous_curvature, mesh)
            }
            BendingMethod::J6 => {
                Self::strong_form(StrongForm::j6(modulus), spontaneous_curvature, mesh)
            }
            BendingMethod::Jet => {
                let method = StrongForm::new(modulus, Jet::for_mesh(mesh));
                Self::strong_form(method, spontaneous_curvature, mesh)
            }
        }
    }

    fn strong_form<L>(
        mut method: StrongForm<f64, L>,
        spontaneous_curvature: f64,
        mesh: &TriangleMesh,
    ) -> Self
    where
        L: LaplaceBeltrami<f64, Plan: fmt::Debug, Memory: fmt::Debug> + fmt::Debug + Sync + 'static,
    {
        method.spontaneous_curvature = spontaneous_curvature.into();
        let prepared = Box::new(InStrongForm(Prepared::new(Projected(method), mesh)));
        Self::new(EffectKind::Bending, false, prepared)
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
        self.prepared = Box::new(Prepared::new(method, mesh));
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

/// What a prepared effect can be asked for, whichever it is.
trait Act: fmt::Debug {
    fn add_force(&mut self, surface: Surface<'_, f64>, force: &mut [[f64; 3]]) -> f64;

    fn inspect(&self, surface: Surface<'_, f64>, report: &mut dyn FnMut(Finding));
}

impl<M> Act for Prepared<f64, M>
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

/// A method in strong form: its force is the gradient of no energy. Without net force and torque,
/// which nothing in a scene would balance.
#[derive(Debug)]
struct InStrongForm<L>(Prepared<f64, Projected<StrongForm<f64, L>>>)
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
