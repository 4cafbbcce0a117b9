//! One-sided fits near boundaries.
//!
//! To one side, the part of the shape that a polynomial leaves out is amplified a hundred times. Two choices
//! make it small.
//!
//! Heights are fitted after an inversion that leaves the vertex and lengths there as they are, and subtracts one
//! number from both principal curvatures. A sphere becomes a plane, and other shapes flatter. The number is a
//! part of H from 0 to 1, which grows while the residual of the fit falls. Inversions change the bending energy
//! (H0 = 0) by no more than a constant; f of the inverted surface is therefore f of the surface.
//! J. H. White, Proc. Am. Math. Soc. 38 (1973) 162.
//!
//! At the boundary itself there are fits of several degrees, numbers of neighbours and weights: see
//! [`AT_BORDER`](super::kind). The choice is the one with the least standard error of f as regression has it, as if residuals
//! were noise: `s² Σ r_j²`, with `s²` the residual per degree of freedom, and `r_j` the dependence of f on the
//! heights. Without noise, residuals fall with the degree and with sharper weights as far as the mesh resolves
//! the shape; with noise, all have the same `s²`, and the choice is the fit that amplifies noise the least.

use super::Ground;
use super::kind::FitKind;
use super::level::LevelScratch;
use crate::fit::Graph;
use crate::noise::fit::{Model, reach};
use crate::real::Real;
use crate::vec3::{Vec3, dot, scale, tangent_frame};

/// Number of steps from 0 to the inversion that makes H zero. Twice as many reduce errors to 0.9 of these in nearly twice
/// the time. Fits at the boundary begin at the step that the fit of other vertices has found. A search from 0 changes
/// errors by a tenth and takes 2.6 times as long.
const STEPS: i32 = 4;

/// Least ratio of the conditioning after and before an inversion: with less, the inverted surface turns away.
const UPRIGHT: f64 = 0.5;

/// A one-sided fit.
#[derive(Clone, Copy)]
struct Sided<T> {
    model: Model<T>,
    /// Number of neighbours to begin with.
    wanted: usize,
    /// b of the inversion, in inverse lengths.
    bend: Vec3<T>,
}

impl<T: Real> LevelScratch<T> {
    /// Repeats the last fit, with `count` neighbours, by the best of one-sided fits. Returns its model and its
    /// number of neighbours.
    pub(super) fn flatten(
        &mut self,
        ground: &Ground<'_, T>,
        vertex: usize,
        kind: &FitKind<T>,
        count: usize,
    ) -> (Model<T>, usize) {
        let model = &kind.model;
        self.fit
            .coefficients(model, model.degree, &mut self.coefficients);
        let over = self.fit.radius().recip();
        let [mean, _] = Graph::in_radii(&self.coefficients, over).curvatures();
        // A unit sphere becomes a plane by b = −n/2.
        let whole = scale(T::constant(-0.5) * mean, self.normal);
        let own = Sided {
            model: *model,
            wanted: count,
            bend: [T::zero(); 3],
        };
        let (error, own, step) = self.bent(ground, vertex, own, whole, 0);
        let at_border = match ground.rings[vertex] {
            0 => kind.at_border,
            _ => &[],
        };
        let mut best = (error, own);
        if !at_border.is_empty() {
            best.0 = T::infinity();
        }
        for &(degree, wanted, sharpness) in at_border {
            let model = Model {
                degree,
                sharpness: T::constant(sharpness),
                ..*model
            };
            let sided = Sided {
                model,
                wanted,
                ..own
            };
            let (error, sided, _) = self.bent(ground, vertex, sided, whole, step);
            if error < best.0 {
                best = (error, sided);
            }
        }
        let (_, best) = best;
        let (count, _) = self.fit_inverted(ground, vertex, &best);
        (best.model, count)
    }

    /// Line search over inversions, from the step `start`: the squared standard error, the fit and the step at the
    /// smallest residual.
    fn bent(
        &mut self,
        ground: &Ground<'_, T>,
        vertex: usize,
        mut sided: Sided<T>,
        whole: Vec3<T>,
        start: i32,
    ) -> (T, Sided<T>, i32) {
        sided.bend = [T::zero(); 3];
        let mut found = (T::infinity(), sided, 0);
        let (mut least, mut before) = (T::infinity(), T::zero());
        let directions: [&mut dyn Iterator<Item = i32>; 2] =
            [&mut (start..=STEPS), &mut (0..start).rev()];
        for steps in directions {
            for step in steps {
                sided.bend = scale(T::constant(f64::from(step) / f64::from(STEPS)), whole);
                let (_, conditioning) = self.fit_inverted(ground, vertex, &sided);
                if step == start {
                    before = conditioning;
                }
                let is_upright =
                    conditioning > T::zero() && conditioning >= T::constant(UPRIGHT) * before;
                // Also false for NaN.
                let is_better = is_upright && self.fit.residual(&sided.model) < least;
                if !is_better {
                    break;
                }
                least = self.fit.residual(&sided.model);
                found = (self.fit.squared_error(&sided.model), sided, step);
            }
            if found.2 != start {
                break;
            }
        }
        found
    }

    /// Fits the inverted surface. Returns the number of neighbours and the conditioning.
    fn fit_inverted(
        &mut self,
        ground: &Ground<'_, T>,
        vertex: usize,
        sided: &Sided<T>,
    ) -> (usize, T) {
        let Sided {
            model,
            wanted,
            bend,
        } = sided;
        let (surface, near) = (ground.surface, &mut self.near);
        let count = reach(surface, &ground.normals, vertex as u32, *wanted, near);
        self.fit
            .gather(surface, vertex as u32, &near.found[..count], model);
        self.fit.invert(scale(self.fit.radius(), *bend));
        self.bend = Some(*bend);
        self.normal = ground.upright[vertex];
        (count, self.fit.fit(&mut self.normal, model))
    }

    /// The number that an inversion has subtracted from both principal curvatures of the fitted surface.
    pub(super) fn subtracted(&self, graph: &Graph<T>, bend: Vec3<T>) -> T {
        let [x, y] = tangent_frame(self.normal);
        let normal = graph.normal([x, y, self.normal]);
        T::constant(-2.0) * dot(bend, normal)
    }
}
