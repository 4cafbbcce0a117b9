//! Forces, energy and constraints at some positions.

use super::{Failure, Relaxation};
use crate::dynamics::coordinates::Coordinates;
use crate::dynamics::place::{Place, reciprocal_or_zero};
use crate::dynamics::vector::{self, Vector};
use crate::dynamics::{Evaluation, Problem};

/// Area of the unit sphere.
pub(super) const SPHERE: f64 = 4.0 * std::f64::consts::PI;

/// Forces, energy and geometry at some positions.
#[derive(Clone, Debug)]
pub(super) struct RelaxationPoint {
    pub(super) positions: Vec<Vector>,
    pub(super) evaluation: Evaluation,
    pub(super) coordinates: Coordinates,
    /// The force without the part that constraints balance.
    pub(super) force: Vec<f64>,
    pub(super) residual: f64,
}

impl Relaxation {
    /// Restores constraints if requested, and evaluates forces, energy and geometry.
    pub(super) fn evaluate(
        &mut self,
        problem: &mut dyn Problem,
        mut positions: Vec<Vector>,
        restore: bool,
    ) -> Result<RelaxationPoint, (Failure, Evaluation)> {
        let none = Evaluation::new(f64::NAN);
        if let Some(failure) = self.not_finite(&positions) {
            return Err((failure, none));
        }
        let constraints = problem.constraint_count();
        if restore && constraints > 0 {
            let error = problem.restore(&mut positions);
            let limit = self.settings.constraint_tolerance;
            if error > limit || error.is_nan() {
                return Err((Failure::ConstraintsLost { error, limit }, none));
            }
            if let Some(failure) = self.not_finite(&positions) {
                return Err((failure, none));
            }
        }
        let (membranes, places) = (&self.membranes, &self.places);
        let mut coordinates = Coordinates::new(membranes, places, &positions);
        if let Some((membrane, triangle)) = coordinates.folded(membranes, places, &positions) {
            return Err((Failure::Inverted { membrane, triangle }, none));
        }
        let (sine, membrane, triangle) = coordinates.narrowest(membranes, places, &positions);
        let [least, part] = self.settings.least_sine;
        let least = *self.state.least_sine.get_or_insert(least.min(part * sine));
        if sine < least {
            let degrees = sine.asin().to_degrees();
            let failure = Failure::Distorted {
                membrane,
                triangle,
                degrees,
            };
            return Err((failure, none));
        }
        if self.state.anchor.is_empty() {
            self.state.anchor.clone_from(&positions);
            self.set_frame();
        }
        let mut nodal = vec![[0.0; 3]; positions.len()];
        let evaluation = problem.evaluate(&positions, &mut nodal);
        self.state.evaluations += 1;
        if let Some(failure) = self.not_finite(&nodal) {
            return Err((failure, evaluation));
        }
        if !evaluation.energy.is_finite() {
            let failure = Failure::NotFinite {
                membrane: 0,
                vertex: 0,
            };
            return Err((failure, evaluation));
        }
        let mut force = self.frame.reduce(&self.places, &positions, &nodal);
        if constraints > 0 {
            let mut gradients = vec![vec![[0.0; 3]; positions.len()]; constraints];
            problem.constraint_gradients(&positions, &mut gradients);
            let reduced: Vec<_> = gradients
                .iter()
                .map(|gradient| self.frame.reduce(&self.places, &positions, gradient))
                .collect();
            coordinates.forbid(&self.places, problem.groups(), reduced);
            coordinates.take_out(&self.places, problem.groups(), &mut force);
        }
        let residual = self.residual(&coordinates, &force);
        Ok(RelaxationPoint {
            positions,
            evaluation,
            coordinates,
            force,
            residual,
        })
    }

    pub(super) fn not_finite(&self, field: &[Vector]) -> Option<Failure> {
        let bad = |entry: &Vector| entry.iter().any(|number| !number.is_finite());
        let index = field.iter().position(bad)?;
        let holds = |place: &Place| place.vertices().contains(&index);
        let membrane = self.places.iter().position(holds)?;
        Some(Failure::NotFinite {
            membrane,
            vertex: index - self.places[membrane].first_vertex,
        })
    }

    /// See [`StepReport::residual`].
    fn residual(&self, coordinates: &Coordinates, force: &[f64]) -> f64 {
        let mut largest = 0.0f64;
        for (membrane, place) in self.membranes.iter().zip(&self.places) {
            let areas = &coordinates.areas[place.vertices()];
            let forces = force[place.numbers()].chunks_exact(place.width);
            let squares = |(force, &area): (&[f64], &f64)| {
                vector::product(force, force) * reciprocal_or_zero(area)
            };
            let sum: f64 = forces.zip(areas).map(squares).sum();
            let area: f64 = areas.iter().sum();
            let over = reciprocal_or_zero((area / SPHERE).sqrt());
            let unit =
                membrane.bending_modulus * over * over * over + membrane.in_plane_modulus * over;
            largest = largest.max((sum / area).sqrt() / unit);
        }
        largest
    }
}
