//! A prepared scene: its surfaces and effects.
//!
//! [`build`] checks the scene on its meshes; [`Scene::explain`](crate::scene::Scene::explain) lists
//! effects, with numbers. A [`Simulation`] computes the forces at given positions; it moves and writes
//! nothing. [`crate::dynamics`] moves the positions, and `helfrich_run::run` writes results.

mod build;
mod check;
mod crossing;
mod error;
mod evaluation;
mod explain;
mod moment;
mod once;
mod placed;
mod ranks;

pub use build::{BodyMesh, build};
#[doc(hidden)]
pub use check::NARROW;
pub use crossing::Crossing;
pub use error::BuildError;
pub use explain::{Active, Explanation, LatticeExplanation, SurfaceExplanation};
#[doc(hidden)]
pub use once::messages_once;
pub(crate) use placed::Placed;

use crate::checked;
use crate::dynamics::{Held, Membrane, Motion};
use crate::effect::{Effect, Viscosity};
use crate::execute::{Parallel, Shares};
use crate::io::Column;
use crate::ordered::Ordered;
use crate::scene::{HeldTargets, Named, SceneError, Stretch, Stretching};
use helfrich::interaction::RepulsionMemory;
use helfrich::{AnyFunctional, Finding, Images, Repulsion, Surface, TriangleMesh};
use helfrich_execute::team::Division;
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

/// Surfaces and their forces, for a driver.
#[derive(Debug)]
pub struct Simulation {
    bodies: Vec<Body>,
    between: Vec<Repulsions>,
    obstacles: Vec<Obstacle>,
    images: Images<f64>,
    /// The connected component of each vertex, among those of all bodies.
    groups: Vec<u32>,
    /// Quantities with an exact constraint in some body; each has its own field of constraint gradients.
    held: Vec<AnyFunctional>,
    warnings: Vec<SceneError>,
    /// The division of bodies among threads, for forces and for viscous forces.
    acting: Shares,
    resisting: Shares,
    /// The division of vertices among ranks, and whether each body belongs to this one; empty for one that is alone.
    division: Division,
    own: Vec<bool>,
}

/// One surface.
#[derive(Debug)]
pub struct Body {
    name: String,
    mesh: Arc<TriangleMesh>,
    vertices: Range<usize>,
    membrane: Membrane,
    acts: Acts,
    /// The order in which these are evaluated, if it is not that of the mesh.
    ordered: Option<Ordered<f64>>,
    /// The place of each of its constraints among those of the simulation.
    places: Vec<usize>,
    stretch: Option<Stretch>,
    targets: Vec<HeldTargets>,
    /// See [`BodyMesh::ratios`].
    ratios: Vec<[f64; 2]>,
    columns: Vec<Arc<Column>>,
    /// The energies of its effects in the last evaluation; none if a position was not finite.
    energies: Option<Vec<f64>>,
}

/// All that acts on one surface alone.
#[derive(Debug)]
struct Acts {
    effects: Vec<Effect>,
    viscosity: Option<Viscosity>,
    held: Held,
}

/// A closed body at rest in the fluid.
#[derive(Clone, Debug)]
pub struct Obstacle {
    /// The obstacle's name.
    pub name: String,
    /// Its mesh.
    pub mesh: Arc<TriangleMesh>,
    /// The positions of its vertices.
    pub positions: Vec<[f64; 3]>,
}

/// Repulsion or adhesion between some surfaces, and their images.
#[derive(Debug)]
struct Repulsions {
    /// The name of the interaction.
    name: &'static str,
    repulsion: Repulsion<f64>,
    /// The bodies in their order: two or more, or one that has images or acts on itself.
    bodies: Vec<usize>,
    /// The obstacles, with memory for the forces on them.
    solids: Vec<(usize, Vec<[f64; 3]>)>,
    memory: RepulsionMemory<f64>,
    /// The same for the surfaces of one of several ranks.
    own_memory: RepulsionMemory<f64>,
    execution: Parallel,
    evaluations: u64,
    time: Duration,
}

/// Energy and forces of one effect at some positions.
#[derive(Clone, Debug)]
pub struct Acting {
    /// The effect's name, followed by the surface's name if there are several surfaces.
    pub effect: String,
    /// Whether it acts between surfaces.
    pub between: bool,
    /// Its energy; for a method in strong form, its quadrature of the energy.
    pub energy: f64,
    /// The vertices on which it acts: those of its surface, or all of them.
    pub vertices: Range<usize>,
    /// Its nodal forces on these.
    pub force: Vec<[f64; 3]>,
}

impl Acting {
    /// The effects of a body, in their order, and those between bodies, of all that [`Simulation::resolve`] returns.
    pub fn of<'a>(all: &'a [Self], body: &Body) -> [&'a [Self]; 2] {
        let (own, between) = all.split_at(all.partition_point(|acting| !acting.between));
        let Range { start, end } = body.vertices();
        let first = own.partition_point(|acting| acting.vertices.start < start);
        let last = own.partition_point(|acting| acting.vertices.start < end);
        [&own[first..last], between]
    }

    /// Its nodal forces on a surface; none if it acts on another one.
    pub fn on(&self, body: &Body) -> &[[f64; 3]] {
        let Range { start, end } = body.vertices();
        let own = self.vertices.contains(&start) && end <= self.vertices.end;
        let own = own.then(|| start - self.vertices.start..end - self.vertices.start);
        own.map_or(&[], |own| &self.force[own])
    }
}

/// The cost of an effect so far.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct EffectCost {
    /// The effect, with the surface's name if there are several.
    pub effect: String,
    /// Number of evaluations.
    pub evaluations: u64,
    /// Their total time.
    pub seconds: f64,
}

impl Body {
    /// The surface's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its mesh.
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// Its mesh, shared.
    pub fn shared_mesh(&self) -> &Arc<TriangleMesh> {
        &self.mesh
    }

    /// Its vertices among those of all surfaces.
    pub fn vertices(&self) -> Range<usize> {
        self.vertices.clone()
    }

    /// The effects on it, without constraints. Those of a large surface are prepared for its mesh in
    /// another order: see [`crate::ordered`].
    pub fn effects(&self) -> &[Effect] {
        &self.acts.effects
    }

    /// Findings of one of its effects about the last evaluation, which must have been at this surface: see
    /// [`Effect::inspect`].
    pub fn inspect(
        &self,
        effect: &Effect,
        surface: Surface<'_, f64>,
        report: &mut dyn FnMut(Finding),
    ) {
        match &self.ordered {
            None => effect.inspect(surface, report),
            Some(ordered) => {
                ordered.inspect(
                    surface,
                    |surface, report| effect.inspect(surface, report),
                    report,
                );
            }
        }
    }

    /// The direction in which it is stretched, of length 1.
    pub fn stretching_axis(&self) -> Option<[f64; 3]> {
        Some(self.stretch.as_ref()?.axis())
    }

    /// The force that stretches this surface, and the distance of its ends unless these are vertices; NaN without the
    /// surface.
    pub fn stretching(&self, surface: Option<Surface<'_, f64>>) -> Option<(f64, Option<f64>)> {
        Some(self.stretch.as_ref()?.measured(surface))
    }

    /// Whether vertices may slide along the surface in a flow: the surface is fluid, no vertex is
    /// loaded, and none has parameters of its own.
    pub fn slides(&self) -> bool {
        let is_fluid = self.membrane.motion == Motion::AlongNormals;
        is_fluid && self.stretch.is_none() && self.columns.is_empty()
    }

    /// The columns of its mesh file that belong to its material; they are also written to its output
    /// files.
    pub fn columns(&self) -> &[Arc<Column>] {
        &self.columns
    }

    /// The targets of its held quantities.
    pub fn targets(&self) -> &[HeldTargets] {
        &self.targets
    }

    /// Area and volume of each component, as they are held, over those of its flat triangles; empty where they are the
    /// same.
    pub fn ratios(&self) -> &[[f64; 2]] {
        &self.ratios
    }

    /// The surface at these positions of all surfaces; none if one of them is not finite.
    pub fn surface<'a>(&'a self, positions: &'a [[f64; 3]]) -> Option<Surface<'a, f64>> {
        checked::surface(&self.mesh, &positions[self.vertices.clone()]).ok()
    }
}

impl Simulation {
    /// The surfaces.
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// The bodies at rest.
    pub fn obstacles(&self) -> &[Obstacle] {
        &self.obstacles
    }

    /// The periodic images of surfaces and obstacles in a box.
    pub fn images(&self) -> &Images<f64> {
        &self.images
    }

    /// Each surface moved by whole periods of the box, so that the mean of its vertices is in the period that begins at this
    /// corner: flows carry surfaces out of the box, where pictures do not show how near they are to each other's images.
    pub fn within_period(&self, corner: [f64; 3], positions: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut moved = positions.to_vec();
        for body in &self.bodies {
            let own = &mut moved[body.vertices.clone()];
            let count = own.len() as f64;
            for (axis, corner) in corner.into_iter().enumerate() {
                if let Some(period) = self.images.period(axis) {
                    let mean = own.iter().map(|at| at[axis]).sum::<f64>() / count;
                    let shift = period * ((mean - corner) / period).floor();
                    own.iter_mut().for_each(|at| at[axis] -= shift);
                }
            }
        }
        moved
    }

    /// Warnings of the scene and of its meshes.
    pub fn warnings(&self) -> &[SceneError] {
        &self.warnings
    }

    /// The membranes, for a relaxation.
    pub fn membranes(&self) -> Vec<Membrane> {
        let membrane = |body: &Body| body.membrane.clone();
        self.bodies.iter().map(membrane).collect()
    }

    /// Number of loads in the longest sequence of stretching forces; 1 if nothing is stretched.
    pub fn load_count(&self) -> usize {
        let stretches = self.bodies.iter().filter_map(|body| body.stretch.as_ref());
        stretches.map(Stretch::count).max().unwrap_or(1)
    }

    /// Applies the load with this number to every stretched surface, or the last load of a shorter
    /// sequence.
    pub fn set_load(&mut self, load: usize) {
        for body in &mut self.bodies {
            if let Some(stretch) = &mut body.stretch {
                let stretching = |effect: &&mut Effect| effect.name() == Stretching::NAME;
                if let Some(effect) = body.acts.effects.iter_mut().find(stretching) {
                    let mesh = body.ordered.as_ref().map_or(&body.mesh, Ordered::mesh);
                    stretch.set(load, effect, mesh);
                }
            }
        }
    }

    /// The exactly held quantities at some positions: for each surface the values of each constraint, one
    /// for each component.
    #[doc(hidden)]
    pub fn held_values(&mut self, positions: &[[f64; 3]]) -> Vec<Vec<Vec<f64>>> {
        let values = self.bodies.iter_mut().map(|body| {
            let positions = &positions[body.vertices.clone()];
            match &body.ordered {
                None => body.acts.held.values(positions),
                Some(ordered) => body.acts.held.values(&ordered.order().apply(positions)),
            }
        });
        values.collect()
    }

    /// Sets the targets of exactly held quantities to this fraction of the way from some values, those of
    /// [`Self::held_values`], to their targets in the scene.
    #[doc(hidden)]
    pub fn approach(&mut self, starts: &[Vec<Vec<f64>>], fraction: f64) {
        for (body, starts) in self.bodies.iter_mut().zip(starts) {
            body.acts.held.approach(starts, fraction);
        }
    }

    /// The names of the effects: first those on each surface, then interactions.
    pub fn effect_names(&self) -> Vec<String> {
        let mut names = Vec::new();
        for body in &self.bodies {
            let own = body.acts.effects.iter().map(Effect::name);
            names.extend(own.map(|name| self.label(name, body)));
        }
        names.extend((0..self.between.len()).map(|index| self.label_of_interaction(index)));
        names
    }

    /// Energy and forces of each effect separately, in the order of [`Self::effect_names`], for
    /// files and pictures; not counted as cost. Empty if a position is not finite.
    pub fn resolve(&mut self, positions: &[[f64; 3]]) -> Vec<Acting> {
        let names = self.effect_names();
        let mut acting = Vec::with_capacity(names.len());
        let mut add = |between: bool, energy: f64, vertices: Range<usize>, force| {
            acting.push(Acting {
                effect: names[acting.len()].clone(),
                between,
                energy,
                vertices,
                force,
            });
        };
        for body in &mut self.bodies {
            for index in 0..body.acts.effects.len() {
                let mut force = vec![[0.0; 3]; body.vertices.len()];
                let energy = body.add_forces(positions, &mut force, |acts, surface, own| {
                    acts.effects[index].add_force_uncounted(surface, own)
                });
                let Some(energy) = energy else {
                    return Vec::new();
                };
                add(false, energy, body.vertices.clone(), force);
            }
        }
        for between in &mut self.between {
            let mut force = vec![[0.0; 3]; positions.len()];
            match between.add_force(&self.bodies, &[], &self.obstacles, positions, &mut force) {
                Some(energy) => add(true, energy, 0..positions.len(), force),
                None => return Vec::new(),
            }
        }
        acting
    }

    /// The cost of each effect so far.
    pub fn costs(&self) -> Vec<EffectCost> {
        let mut costs = Vec::new();
        for body in &self.bodies {
            for effect in &body.acts.effects {
                let (evaluations, time) = effect.cost();
                costs.push(EffectCost {
                    effect: self.label(effect.name(), body),
                    evaluations,
                    seconds: time.as_secs_f64(),
                });
            }
        }
        for body in &self.bodies {
            if let Some(viscosity) = &body.acts.viscosity {
                let (evaluations, time) = viscosity.cost();
                costs.push(EffectCost {
                    effect: self.label(Viscosity::NAME, body),
                    evaluations,
                    seconds: time.as_secs_f64(),
                });
            }
        }
        for (index, between) in self.between.iter().enumerate() {
            costs.push(EffectCost {
                effect: self.label_of_interaction(index),
                evaluations: between.evaluations,
                seconds: between.time.as_secs_f64(),
            });
        }
        costs
    }

    /// A column's name for one of the surfaces.
    pub fn label(&self, name: &str, body: &Body) -> String {
        if self.bodies.len() == 1 {
            name.to_owned()
        } else {
            format!("{name}_{}", body.name)
        }
    }

    fn label_of_interaction(&self, index: usize) -> String {
        // Adhesion to walls is an effect of that name.
        let name = match self.between[index].name {
            "adhesion" => "attraction",
            name => name,
        };
        if self.between.len() == 1 {
            name.to_owned()
        } else {
            format!("{name}_{}", index + 1)
        }
    }
}
