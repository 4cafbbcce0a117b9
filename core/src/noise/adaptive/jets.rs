//! The jets of a mesh without noise, with the degree that suits the shape.

use super::level::{Level, Scratch};
use super::{Ground, ONE_STAGE, QUANTITIES};
use crate::curvature::{Curvature, Curvatures};
use crate::element::Execution;
use crate::laplacian::{Jet, LaplaceBeltrami};
use crate::method::Method;
use crate::noise::doubt::{Doubt, Fields};
use crate::noise::fit::Model;
use crate::real::Real;
use crate::surface::Surface;
use alloc::vec;
use alloc::vec::Vec;

/// Number of vertices below which degree 4 may be better than 6: it is where 56 neighbours are a large part of the
/// surface, but on a patch of little curvature, degree 6 has a tenth of its errors.
const COARSE: usize = 1000;

/// Jets around every vertex.
pub(super) struct Jets<T> {
    pub(super) curvature: Vec<Curvature<T>>,
    /// H, K and f; NaN where there is no fit.
    pub(super) values: [Vec<T>; QUANTITIES],
    pub(super) degrees: Vec<u8>,
    pub(super) neighbours: Vec<u32>,
    /// The polynomials of the highest degree.
    pub(super) model: Model<T>,
}

impl<T: Real> Jets<T> {
    /// The jets that [`Jet::for_mesh`] has.
    pub(super) fn new(execution: &impl Execution, surface: Surface<'_, T>) -> Self {
        Self::of(execution, surface, &Jet::for_mesh(surface.mesh()))
    }

    fn of(execution: &impl Execution, surface: Surface<'_, T>, jet: &Jet<T>) -> Self {
        let mesh = surface.mesh();
        let count = mesh.vertex_count();
        let mut workspace = jet.workspace(mesh);
        let mut curvature = vec![Curvature::default(); count];
        jet.curvatures(execution, surface, &mut workspace, &mut curvature);
        let degrees = workspace.memory().degrees().to_vec();
        let known = |at: &Curvature<T>, degree: &u8, value: T| {
            let is_known = *degree > 0 && at.normal != [T::zero(); 3];
            if is_known { value } else { T::nan() }
        };
        let mean = Vec::from_iter(curvature.iter().map(|at| at.mean));
        let mut force = vec![T::zero(); count];
        jet.apply_to_scalar(execution, surface, &workspace, &mean, &mut force);
        let two = T::constant(2.0);
        let all = || curvature.iter().zip(&degrees);
        let values = [
            all().map(|(at, d)| known(at, d, at.mean)).collect(),
            all().map(|(at, d)| known(at, d, at.gaussian)).collect(),
            all()
                .zip(&force)
                .map(|((at, d), &laplacian)| {
                    let (mean, gaussian) = (at.mean, at.gaussian);
                    let density = laplacian + two * mean * (mean * mean - gaussian);
                    known(at, d, two * density)
                })
                .collect(),
        ];
        let neighbours = (0..count).map(|vertex| workspace.memory().neighbours(vertex) as u32);
        Self {
            values,
            neighbours: neighbours.collect(),
            degrees,
            curvature,
            model: Model {
                degree: jet.degree,
                sharpness: jet.sharpness,
                interpolates: true,
            },
        }
    }

    /// On a coarse mesh, the jets of degree 4 or 6 whose H disagrees less between neighbours.
    pub(super) fn chosen(self, execution: &impl Execution, ground: &Ground<'_, T>) -> Self {
        if ground.normals.len() >= COARSE {
            return self;
        }
        let other = Self::of(execution, ground.surface, &Jet::j6());
        let [own, others] = [&self, &other].map(|jets| jets.disagreement(execution, ground));
        if others < own { other } else { self }
    }

    /// Takes the values of one-sided fits near a boundary.
    pub(super) fn take_one_sided(&mut self, ground: &Ground<'_, T>, twin: &Level<T>) {
        let [_, one_sided] = &twin.of_degrees;
        for (values, one_sided) in self.values.iter_mut().zip(&one_sided.values) {
            for (vertex, (value, &one_sided)) in values.iter_mut().zip(one_sided).enumerate() {
                if ground.rings[vertex] < ONE_STAGE && one_sided.is_finite() {
                    *value = one_sided;
                    self.degrees[vertex] = twin.degrees[vertex];
                    self.neighbours[vertex] = twin.neighbours[vertex];
                }
            }
        }
    }

    /// The sum of the squares of the disagreement in H; infinite if a vertex has no fit.
    fn disagreement(&self, execution: &impl Execution, ground: &Ground<'_, T>) -> T {
        let mut squares = vec![T::zero(); self.degrees.len()];
        let mut scratch: Vec<Scratch<T>> = Vec::new();
        execution.map_with(&mut scratch, &mut squares[..], |scratch, vertex, square| {
            let doubt = self.doubt(scratch, ground, vertex);
            let apart = doubt.map_or(T::infinity(), |doubt| doubt.apart[0]);
            *square = apart * apart;
        });
        squares.into_iter().sum()
    }

    fn doubt(
        &self,
        scratch: &mut Scratch<T>,
        ground: &Ground<'_, T>,
        vertex: usize,
    ) -> Option<Doubt<T>> {
        let [mean, gaussian, _] = &self.values;
        if !mean[vertex].is_finite() {
            return None;
        }
        let model = Model {
            degree: usize::from(self.degrees[vertex]),
            ..self.model
        };
        let count = self.neighbours[vertex] as usize;
        let count = scratch.fit_nearest(ground, vertex, &model, count);
        if count == 0 {
            return None;
        }
        let fields = Fields { mean, gaussian };
        Some(scratch.doubt(ground, vertex, (&model, model.degree, count), &[], fields))
    }
}
