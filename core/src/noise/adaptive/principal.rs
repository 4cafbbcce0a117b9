//! Normals, principal directions and gradients of curvature, from the fits that were chosen for H.

use super::level::{Kind, Scratch};
use super::{Ground, Measured};
use crate::element::Execution;
use crate::noise::DEGREES;
use crate::noise::slopes::Slopes;
use crate::real::Real;
use crate::vec3::{Vec3, add, dot, scale, tangent_frame};
use alloc::vec::Vec;

/// Largest standard deviation of a direction, in radians: above it, the vertex counts as umbilic.
const CERTAIN: f64 = 0.2;

/// The fit that was chosen for H at a vertex.
pub(super) struct Fitted<'a, T> {
    pub(super) kind: Kind<T>,
    pub(super) degree: usize,
    /// H and K of this fit at every vertex.
    pub(super) fields: [&'a [T]; 2],
    /// Square of the bias of H.
    pub(super) bias: T,
}

/// Sets normals, principal curvatures, directions and gradients. `fitted` returns the fit chosen for H.
pub(super) fn set<'f, T: Real>(
    execution: &impl Execution,
    ground: &Ground<'_, T>,
    fitted: impl Fn(usize) -> Option<Fitted<'f, T>> + Sync,
    measured: &mut [Measured<T>],
) {
    let mut scratch: Vec<(Scratch<T>, [Vec<T>; 3])> = Vec::new();
    execution.map_with(&mut scratch, measured, |(scratch, rows), vertex, at| {
        let Some(fitted) = fitted(vertex) else {
            return;
        };
        let count = scratch.fit(ground, vertex, &fitted.kind);
        if count == 0 {
            return;
        }
        let (slopes, axes) = scratch.slopes(&fitted.kind, fitted.degree);
        let frame = slopes.principal(axes);
        let radius = scratch.fit.radius();
        let mut shear = [T::zero(); 6];
        let two = T::constant(2.0);
        let over = (radius * radius).recip();
        for ((entry, &factor), times) in
            shear[3..]
                .iter_mut()
                .zip(&frame.by_second)
                .zip([two, T::one(), two])
        {
            *entry = times * factor * over;
        }
        let mut along = [[T::zero(); 6]; 2];
        (along[0][1], along[1][2]) = (radius.recip(), radius.recip());
        let functionals = [shear, along[0], along[1]];
        scratch
            .fit
            .rows(&fitted.kind.model, fitted.degree, &functionals, rows);
        let [shear, along_x, along_y] = &*rows;
        let vectors = slopes.gradient(axes);
        let own = usize::from(!fitted.kind.model.interpolates);
        // Vertices with jets have been set already.
        if own == 1 {
            at.normal = slopes.normal(axes);
        }
        let neighbours = scratch.neighbours(count);
        let gradient = |field: &[T]| {
            let here = field[vertex];
            let mut derivatives = [T::zero(); 2];
            for (row, &(_, other)) in neighbours.iter().enumerate() {
                let difference = field[other as usize] - here;
                derivatives[0] += along_x[row + own] * difference;
                derivatives[1] += along_y[row + own] * difference;
            }
            add(
                scale(derivatives[0], vectors[0]),
                scale(derivatives[1], vectors[1]),
            )
        };
        let [of_mean, of_gaussian] = fitted.fields.map(gradient);
        at.gradient_of_mean = of_mean;
        // Every height has noise; in interpolating fits the error at the vertex enters all differences.
        let mut squares: T = shear.iter().map(|&entry| entry * entry).sum();
        if own == 0 {
            let sum: T = shear.iter().copied().sum();
            squares += sum * sum;
        }
        let gap = at.principal[0].value - at.principal[1].value;
        let deviation = (fitted.bias + at.deviation * at.deviation * squares).sqrt() / gap;
        // Also false for NaN.
        if deviation <= T::constant(CERTAIN) {
            at.directions = Some(frame.directions);
            at.extremalities = Some(extremalities(at, of_gaussian, frame.directions));
        }
    });
}

/// The derivatives of both principal curvatures along their own directions.
fn extremalities<T: Real>(
    at: &Measured<T>,
    gradient_of_gaussian: Vec3<T>,
    directions: [Vec3<T>; 2],
) -> [T; 2] {
    let [larger, smaller] = at.principal.map(|curvature| curvature.value);
    let gap = larger - smaller;
    let two = T::constant(2.0);
    // k = H ± √(H² − K), and the root is half of the gap.
    let along = |curvature: T, sign: T, direction: Vec3<T>| {
        let of_mean = dot(at.gradient_of_mean, direction);
        let of_gaussian = dot(gradient_of_gaussian, direction);
        sign * (two * curvature * of_mean - of_gaussian) / gap
    };
    [
        along(larger, T::one(), directions[0]),
        along(smaller, -T::one(), directions[1]),
    ]
}

impl<T: Real> Scratch<T> {
    /// The slopes of the last fit, and its axes along x, y and the height.
    fn slopes(&mut self, kind: &Kind<T>, degree: usize) -> (Slopes<T>, [Vec3<T>; 3]) {
        let own = usize::from(!kind.model.interpolates);
        let radius = self.fit.radius();
        self.fit
            .coefficients(&kind.model, degree, &mut self.coefficients);
        let [x, y] = tangent_frame(self.normal);
        let slopes = Slopes::new(&self.coefficients[own..], radius);
        (slopes, [x, y, self.normal])
    }
}

/// The degree of the fits that stand for jets of any degree.
pub(super) const JETS: usize = DEGREES[1];
