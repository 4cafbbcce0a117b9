//! The sphere.

use super::{ExactPoint, Shape, ShapeError, between};
use crate::real::Real;
use crate::vec3;

/// The sphere |x| = R: H = 1/R, K = 1/R², Δ_S H = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere<T> {
    /// R, finite and above 0; a length.
    pub radius: T,
}

impl<T: Real> Sphere<T> {
    /// The sphere of this radius.
    ///
    /// # Errors
    /// Unless 0 < `radius` < ∞.
    pub fn new(radius: T) -> Result<Self, ShapeError> {
        let radius = between("sphere's radius", radius, T::zero(), T::infinity())?;
        Ok(Self { radius })
    }
}

impl<T: Real> Shape<T> for Sphere<T> {
    fn at(&self, preimage: [T; 3]) -> ExactPoint<T> {
        let curvature = self.radius.recip();
        ExactPoint {
            position: vec3::scale(self.radius, preimage),
            normal: preimage,
            mean: curvature,
            gaussian: curvature * curvature,
            laplacian_of_mean: T::zero(),
        }
    }

    /// x/|x|, for every point but the centre.
    fn preimage(&self, position: [T; 3]) -> [T; 3] {
        vec3::normalise(vec3::scale(self.radius.recip(), position))
    }

    fn area_element(&self, _preimage: [T; 3]) -> T {
        self.radius * self.radius
    }
}
