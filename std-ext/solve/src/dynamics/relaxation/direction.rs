//! The direction of a step: secants preconditioned by the stiffness of the membranes.

use super::Relaxation;
use super::point::{RelaxationPoint, SPHERE};
use crate::dynamics::coordinates::Coordinates;
use crate::dynamics::place::Place;
use crate::dynamics::vector::{self, Vector};
use crate::dynamics::{Membrane, Problem};

/// Root-mean-square relative change of the edges after which the preconditioner is rebuilt.
const OUTDATED: f64 = 0.1;

impl Relaxation {
    pub(super) fn set_preconditioners(&mut self) {
        let parts = self.membranes.iter().zip(&self.places);
        for (preconditioner, (membrane, place)) in self.preconditioners.iter_mut().zip(parts) {
            preconditioner.set(membrane, &self.state.reference[place.vertices()]);
        }
    }

    /// Rebuilds preconditioners if membranes have changed too much.
    pub(super) fn refresh_preconditioners(&mut self, positions: &[Vector]) {
        if !self.settings.preconditioned {
            return;
        }
        let reference = &self.state.reference;
        let outdated = |membrane: &Membrane, place: &Place| {
            let [now, then] = [positions, reference].map(|all| &all[place.vertices()]);
            let squared = |all: &[Vector], &[a, b]: &[u32; 2]| {
                let edge = vector::sub(all[b as usize], all[a as usize]);
                vector::dot(edge, edge)
            };
            let change = |edge: &[u32; 2]| {
                let (now, then) = (squared(now, edge), squared(then, edge));
                // Twice the strain, to first order.
                ((now - then) / now.max(then)).powi(2)
            };
            let edges = membrane.mesh.edges();
            edges.iter().map(change).sum::<f64>() > (2.0 * OUTDATED).powi(2) * edges.len() as f64
        };
        let mut parts = self.membranes.iter().zip(&self.places);
        if reference.is_empty() || parts.any(|(membrane, place)| outdated(membrane, place)) {
            self.state.reference = positions.to_vec();
            self.set_preconditioners();
        }
    }

    /// The displacement that would cancel the force if the estimated stiffness were exact.
    pub(super) fn direction(&mut self, problem: &dyn Problem, here: &RelaxationPoint) -> Vec<f64> {
        let secants = std::mem::take(&mut self.state.secants);
        let mut direction = here.force.clone();
        secants.apply(&mut direction, |force| self.precondition(here, force));
        self.state.secants = secants;
        let groups = problem.groups();
        self.frame.restrict(&self.places, &mut direction);
        here.coordinates.keep(&self.places, groups, &mut direction);
        direction
    }

    /// The displacement that would cancel a force, by the preconditioner alone.
    pub(super) fn preconditioned(
        &mut self,
        problem: &dyn Problem,
        here: &RelaxationPoint,
        force: &[f64],
    ) -> Vec<f64> {
        let mut direction = force.to_vec();
        self.precondition(here, &mut direction);
        let groups = problem.groups();
        self.frame.restrict(&self.places, &mut direction);
        here.coordinates.keep(&self.places, groups, &mut direction);
        direction
    }

    fn precondition(&mut self, here: &RelaxationPoint, force: &mut [f64]) {
        let Self {
            places,
            membranes,
            preconditioners,
            settings,
            frame,
            ..
        } = self;
        let stiff = |membrane: &Membrane, place: &Place| {
            let areas = &here.coordinates.areas[place.vertices()];
            let shift = SPHERE / areas.iter().sum::<f64>();
            shift * (membrane.bending_modulus * shift + membrane.in_plane_modulus)
        };
        let parts = membranes.iter().zip(places.iter());
        let stiffest = parts.map(|(m, p)| stiff(m, p)).fold(0.0, f64::max);
        let precondition = |force: &mut [f64]| {
            for ((place, membrane), preconditioner) in
                places.iter().zip(membranes).zip(preconditioners)
            {
                let force = &mut force[place.numbers()];
                if settings.preconditioned {
                    preconditioner.apply(place.width, force);
                } else {
                    plain(membrane, place, &here.coordinates, force);
                }
            }
        };
        frame.apart_from_rigid(stiffest.recip(), force, precondition);
    }
}

/// Displacements in proportion to forces, as large as the shortest waves allow.
fn plain(membrane: &Membrane, place: &Place, coordinates: &Coordinates, force: &mut [f64]) {
    let areas = &coordinates.areas[place.vertices()];
    let area = areas.iter().sum::<f64>() / areas.len() as f64;
    let stiffness = membrane.bending_modulus / area + membrane.in_plane_modulus;
    force
        .iter_mut()
        .for_each(|entry| *entry *= 0.05 / stiffness);
}
