//! Errors of jets due to the shape, from their distances from each other without the part of noise.

use super::super::of_sixth;
use super::{Candidates, EIGHTH, J6, Values};
use crate::noise::COPIES;

impl Candidates {
    /// Mean errors of J4 and J6 due to the shape.
    ///
    /// Where a mesh hardly resolves the shape, jets of degree 8 are no better than those of degrees 4
    /// and 6, which are then nearer to each other than to degree 8: an error is not larger than the
    /// distance of two jets whose errors are independent.
    pub(super) fn by_shape(&self) -> [f64; 2] {
        let which = self.quantity as usize;
        let [eighth, sixth] = [EIGHTH, J6].map(|index| &self.all[index].values[which][..]);
        let fourth = &self.fourth[..];
        let pairs = [[fourth, eighth], [sixth, eighth], [fourth, sixth]];
        let [far, near, between] = pairs.map(|pair| self.beyond_noise(pair));
        let unknown = of_sixth(near, far);
        [unknown.hypot(far), unknown].map(|error| error.min(between))
    }

    /// The mean distance of two jets without the part of noise; NaN if no vertex has both.
    fn beyond_noise(&self, [one, other]: [&[Values]; 2]) -> f64 {
        let mean = |apart: &dyn Fn(&Values, &Values) -> f64| {
            let all = one.iter().zip(other).zip(&self.areas);
            let all = all.map(|((one, other), area)| (apart(one, other).abs(), *area));
            // Some jets have no result at vertices near a boundary.
            let known = all.filter(|(apart, area)| *area > 0.0 && apart.is_finite());
            let (sum, areas) = known.fold((0.0, 0.0), |(sum, areas), (apart, area)| {
                (sum + area * apart, areas + area)
            });
            sum / areas
        };
        let apart = mean(&|one, other| one[0] - other[0]);
        let by_noise = (1..COPIES)
            .map(|copy| mean(&|one, other| one[copy] - one[0] - (other[copy] - other[0])).powi(2));
        let by_noise = by_noise.sum::<f64>() / (COPIES - 1) as f64;
        (apart * apart - by_noise).max(0.0).sqrt()
    }
}
