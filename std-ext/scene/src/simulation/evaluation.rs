//! Forces and energies of surfaces, for drivers and flows.

use super::{Acts, Body, Obstacle, Repulsions, Simulation};
use crate::checked;
use crate::contact::repel;
use crate::dynamics::{Evaluation, Problem};
use crate::effect::Effect;
use crate::execute::Shares;
use crate::flow::Membranes;
use helfrich::Surface;
use std::borrow::Cow;
use std::ops::Range;
use std::time::Instant;

impl Body {
    /// Adds the forces of its effects, and keeps their energies.
    fn evaluate(&mut self, positions: &[[f64; 3]], force: &mut [[f64; 3]]) {
        let mut energies = self.energies.take().unwrap_or_default();
        energies.clear();
        self.energies = self.add_forces(positions, force, |acts, surface, force| {
            let effects = acts.effects.iter_mut();
            energies.extend(effects.map(|effect| effect.add_force(surface, force)));
            energies
        });
    }

    /// Adds the forces that depend on velocities, those of all surfaces.
    fn resist(&mut self, positions: &[[f64; 3]], velocities: &[[f64; 3]], force: &mut [[f64; 3]]) {
        let velocities = &velocities[self.vertices.clone()];
        let velocities = match &self.ordered {
            None => Cow::Borrowed(velocities),
            Some(ordered) => Cow::Owned(ordered.order().apply(velocities)),
        };
        self.add_forces(positions, force, |acts, surface, force| {
            if let Some(viscosity) = &mut acts.viscosity {
                viscosity.add_force(surface, &velocities, force);
            }
        });
    }

    /// Calls `add` with all that acts, the surface and a slice for forces, in one order, and adds these
    /// forces to `force`, the slice of this body; returns what `add` does. None if a position is not
    /// finite.
    pub(super) fn add_forces<R>(
        &mut self,
        positions: &[[f64; 3]],
        force: &mut [[f64; 3]],
        add: impl FnOnce(&mut Acts, Surface<'_, f64>, &mut [[f64; 3]]) -> R,
    ) -> Option<R> {
        let surface = checked::surface(&self.mesh, &positions[self.vertices.clone()]).ok()?;
        let acts = &mut self.acts;
        Some(match &mut self.ordered {
            None => add(acts, surface, force),
            Some(ordered) => {
                let (surface, own) = ordered.parts(surface);
                checked::clear(own);
                let result = add(acts, surface, own);
                ordered.add_forces_to(force);
                result
            }
        })
    }
}

impl Problem for Simulation {
    fn is_conservative(&self) -> bool {
        let mut effects = self.bodies.iter().flat_map(|body| &body.acts.effects);
        effects.all(Effect::is_conservative)
    }

    fn evaluate(&mut self, positions: &[[f64; 3]], force: &mut [[f64; 3]]) -> Evaluation {
        let mut evaluation = self.evaluate_bodies(&[], positions, force);
        match self.add_between(&[], positions, force) {
            Some(energies) => energies
                .into_iter()
                .for_each(|energy| add(&mut evaluation, energy)),
            None => return Evaluation::new(f64::NAN),
        }
        evaluation
    }

    fn constraint_count(&self) -> usize {
        self.held.len()
    }

    fn groups(&self) -> &[u32] {
        &self.groups
    }

    fn constraint_gradients(&mut self, positions: &[[f64; 3]], gradients: &mut [Vec<[f64; 3]>]) {
        for gradient in gradients.iter_mut() {
            gradient.fill([0.0; 3]);
        }
        for body in &mut self.bodies {
            for (index, place) in body.places.clone().into_iter().enumerate() {
                let gradient = &mut gradients[place][body.vertices.clone()];
                body.add_forces(positions, gradient, |acts, surface, gradient| {
                    acts.held.gradient(index, surface.positions(), gradient);
                });
            }
        }
    }

    fn restore(&mut self, positions: &mut [[f64; 3]]) -> f64 {
        let restore = |body: &mut Body| {
            let positions = &mut positions[body.vertices.clone()];
            let held = &mut body.acts.held;
            let restored = match &mut body.ordered {
                None => held.restore(positions),
                Some(ordered) => ordered.change(positions, |positions| held.restore(positions)),
            };
            // The driver then takes a shorter step, or stops with a message.
            restored.map_or(f64::INFINITY, |correction| correction.residual)
        };
        self.bodies.iter_mut().map(restore).fold(0.0, f64::max)
    }
}

impl Membranes for Simulation {
    fn set_forces(
        &mut self,
        positions: &[[f64; 3]],
        forces: &mut [[f64; 3]],
    ) -> Result<(), String> {
        let own = std::mem::take(&mut self.own);
        let evaluation = self.evaluate_bodies(&own, positions, forces);
        let between = self.add_between(&own, positions, forces);
        self.own = own;
        let energies = between.map(|energies| energies.iter().sum::<f64>());
        let finite = energies.is_some_and(|sum| (sum + evaluation.energy).is_finite());
        self.division.gather(forces);
        if self.division.team().all(finite) {
            return Ok(());
        }
        Err("the energy is not a finite number: the mesh has been torn apart".to_owned())
    }

    fn are_viscous(&self) -> bool {
        self.bodies.iter().any(|body| body.acts.viscosity.is_some())
    }

    fn add_viscous_forces(
        &mut self,
        positions: &[[f64; 3]],
        velocities: &[[f64; 3]],
        forces: &mut [[f64; 3]],
    ) {
        let resisting = &mut self.resisting;
        each_body(resisting, &mut self.bodies, &[], forces, |body, forces| {
            body.resist(positions, velocities, forces);
        });
    }
}

fn add(evaluation: &mut Evaluation, energy: f64) {
    evaluation.energy += energy;
    evaluation.energy_scale += energy.abs();
}

impl Simulation {
    /// Sets the forces of bodies on themselves: of all, or of those for which `only` is true.
    fn evaluate_bodies(
        &mut self,
        only: &[bool],
        positions: &[[f64; 3]],
        force: &mut [[f64; 3]],
    ) -> Evaluation {
        checked::clear(force);
        each_body(
            &mut self.acting,
            &mut self.bodies,
            only,
            force,
            |body, force| {
                body.evaluate(positions, force);
            },
        );
        let mut evaluation = Evaluation::default();
        for body in chosen(&mut self.bodies, only) {
            match &body.energies {
                Some(energies) => energies
                    .iter()
                    .for_each(|&energy| add(&mut evaluation, energy)),
                None => return Evaluation::new(f64::NAN),
            }
        }
        evaluation
    }

    /// Adds the forces between bodies, and returns the energies; none if a position is not finite. If forces on some bodies `only`
    /// are wanted, those on others, and the energies, lack something.
    fn add_between(
        &mut self,
        only: &[bool],
        positions: &[[f64; 3]],
        force: &mut [[f64; 3]],
    ) -> Option<Vec<f64>> {
        let between = self.between.iter_mut().map(|between| {
            let start = Instant::now();
            let energy =
                between.add_force(&self.bodies, only, &self.obstacles, positions, force)?;
            between.time += start.elapsed();
            between.evaluations += 1;
            Some(energy)
        });
        between.collect()
    }
}

/// All bodies, or those for which `only` is true.
fn chosen<'a>(bodies: &'a mut [Body], only: &[bool]) -> impl Iterator<Item = &'a mut Body> {
    let chosen = |number: usize| only.get(number).is_none_or(|only| *only);
    let bodies = bodies.iter_mut().enumerate();
    bodies.filter_map(move |(number, body)| chosen(number).then_some(body))
}

/// Does `work` for each body, or for those for which `only` is true, and its part of the vectors of all vertices.
fn each_body(
    shares: &mut Shares,
    bodies: &mut [Body],
    only: &[bool],
    vectors: &mut [[f64; 3]],
    work: impl Fn(&mut Body, &mut [[f64; 3]]) + Sync,
) {
    let (mut rest, mut first) = (vectors, 0);
    let parts = chosen(bodies, only).map(|body| {
        let Range { start, end } = body.vertices;
        let (_, own) = std::mem::take(&mut rest).split_at_mut(start - first);
        let (own, after) = own.split_at_mut(end - start);
        (rest, first) = (after, end);
        (end - start, (body, own))
    });
    shares.each(parts, |(body, own)| work(body, own));
}

impl Repulsions {
    /// Adds the forces and returns the energy; none if a position is not finite. If forces on some bodies `only` are wanted, those
    /// on others, and the energy, lack something.
    pub(super) fn add_force(
        &mut self,
        bodies: &[Body],
        only: &[bool],
        obstacles: &[Obstacle],
        positions: &[[f64; 3]],
        force: &mut [[f64; 3]],
    ) -> Option<f64> {
        let moving = self.bodies.iter();
        let moving = moving.map(|&body| bodies[body].surface(positions));
        let resting = self.solids.iter().map(|&(solid, _)| {
            let Obstacle {
                mesh, positions, ..
            } = &obstacles[solid];
            Surface::new(mesh, positions).ok()
        });
        let surfaces: Option<Vec<_>> = moving.chain(resting).collect();
        let surfaces = surfaces?;
        let mut rest = force;
        let mut first = 0;
        let mut forces = Vec::with_capacity(surfaces.len());
        for &body in &self.bodies {
            let vertices = bodies[body].vertices.clone();
            let (_, after) = rest.split_at_mut(vertices.start - first);
            let (own, after) = after.split_at_mut(vertices.len());
            forces.push(own);
            rest = after;
            first = vertices.end;
        }
        for (_, unused) in &mut self.solids {
            unused.fill([0.0; 3]);
            forces.push(unused);
        }
        let memory = if only.is_empty() {
            &mut self.memory
        } else {
            let only = Vec::from_iter(self.bodies.iter().map(|&body| only[body]));
            self.own_memory.limit_to(Some(&only));
            &mut self.own_memory
        };
        let (execution, repulsion) = (&self.execution, &self.repulsion);
        Some(repel(execution, repulsion, &surfaces, memory, &mut forces))
    }
}
