//! Whether neighbours determine a fit, and the fitted surface beside its vertex.

use super::{HeightFit, Model};
use crate::fit::graph_at;
use crate::lane::Lane;
use crate::real::Real;
use crate::vec3::{Vec3, dot};

/// The product of the odd numbers below 2n.
fn odd_factorial(n: usize) -> f64 {
    (1..=n).map(|k| (2 * k - 1) as f64).product()
}

impl<T: Real> HeightFit<T> {
    /// The least distance of a column of monomials up to a degree from the span of those before it, in units of the length
    /// that the column would have if the neighbours were spread evenly over all directions: 0 where they lie
    /// on an algebraic curve, such as three rows.
    ///
    /// In units of its own length, a column of rounding errors would pass for an independent one.
    pub(in crate::noise) fn spread(&self, model: &Model<T>, degree: usize) -> T {
        let width = model.columns() + 1;
        let mut least = T::one();
        for degree in usize::from(model.interpolates)..=degree {
            let terms = self.offsets.iter().zip(&self.weights);
            let terms = terms.map(|(&offset, &weight)| {
                weight * weight * dot(offset, offset).powi(degree as i32)
            });
            let sum: T = terms.sum();
            for power in 0..=degree {
                // The mean of the squares of cosᵖ sin^q over all directions.
                let factors = odd_factorial(degree - power) * odd_factorial(power);
                let mean = (1..=degree).fold(factors, |mean, k| mean / (2 * k) as f64);
                let even = (sum * T::constant(mean)).sqrt();
                let place = model.start(degree) + power;
                let own =
                    self.upper[place * width + place] * self.scales[place].reciprocal_or_zero();
                least = least.min(own * even.reciprocal_or_zero());
            }
        }
        least
    }

    /// H and K of the fitted polynomial, of a degree up to the model's, at the place of a neighbour. `axes` are
    /// those of the plane in which heights were fitted.
    pub(in crate::noise) fn curvatures_at(
        &self,
        coefficients: &[T],
        degree: usize,
        neighbour: usize,
        axes: [Vec3<T>; 2],
    ) -> [T; 2] {
        let [x, y] = axes.map(|axis| dot(self.offsets[neighbour], axis));
        let (_, graph) = graph_at(degree, coefficients, x, y);
        graph.enlarged(self.radius.recip()).curvatures()
    }
}
