//! The torus.

use super::{ExactPoint, Shape, ShapeError, between};
use crate::real::Real;
use crate::vec3;

/// The torus around the z axis: a tube of radius r around a circle of radius R > r.
///
/// With the angle θ around the tube, 0 on the outer equator, and the distance w = R + r cosθ from
/// the axis:
/// ```text
/// H = 1/(2r) + cosθ/(2w)     K = cosθ/(r w)     Δ_S H = −R (R cosθ + r)/(2 r² w³)
/// ```
/// A point is its own pre-image; a point off the surface stands for the nearest point on the
/// surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus<T> {
    /// R, of the circle that the tube follows, finite and above 0; a length.
    pub radius: T,
    /// r, above 0 and below R; a length.
    pub tube_radius: T,
}

/// A point of the torus by its two angles, each as a cosine and a sine.
struct Angles<T> {
    around_tube: [T; 2],
    around_axis: [T; 2],
}

impl<T: Real> Torus<T> {
    /// The torus with these radii R and r.
    ///
    /// # Errors
    /// Unless 0 < `radius` < ∞ and 0 < `tube_radius` < `radius`.
    pub fn new(radius: T, tube_radius: T) -> Result<Self, ShapeError> {
        let radius = between("torus's radius", radius, T::zero(), T::infinity())?;
        let tube_radius = between("torus's tube radius", tube_radius, T::zero(), radius)?;
        Ok(Self {
            radius,
            tube_radius,
        })
    }

    /// The angles of the surface's point that is nearest to `position`.
    fn angles(&self, position: [T; 3]) -> Angles<T> {
        let [x, y, z] = vec3::scale(self.radius.recip(), position);
        let distance = vec3::norm([x, y, T::zero()]);
        let [cos_axis, sin_axis, _] = vec3::normalise([x, y, T::zero()]);
        let [cos_tube, sin_tube, _] = vec3::normalise([distance - T::one(), z, T::zero()]);
        Angles {
            around_tube: [cos_tube, sin_tube],
            around_axis: [cos_axis, sin_axis],
        }
    }
}

impl<T: Real> Shape<T> for Torus<T> {
    fn at(&self, preimage: [T; 3]) -> ExactPoint<T> {
        let half = T::constant(0.5);
        let Angles {
            around_tube: [cos_tube, sin_tube],
            around_axis: [cos_axis, sin_axis],
        } = self.angles(preimage);
        let unit = self.radius;
        let tube = self.tube_radius / unit;
        let distance = T::one() + tube * cos_tube;
        let laplacian_of_mean =
            -half * (cos_tube + tube) / (tube * tube * distance * distance * distance);
        ExactPoint {
            position: vec3::scale(
                unit,
                [distance * cos_axis, distance * sin_axis, tube * sin_tube],
            ),
            normal: [cos_tube * cos_axis, cos_tube * sin_axis, sin_tube],
            mean: half * (tube.recip() + cos_tube / distance) / unit,
            gaussian: cos_tube / (tube * distance) / unit / unit,
            laplacian_of_mean: laplacian_of_mean / unit / unit / unit,
        }
    }

    /// The nearest point of the surface; points on the axis and on the tube's own circle have none.
    fn preimage(&self, position: [T; 3]) -> [T; 3] {
        self.position(position)
    }

    fn area_element(&self, _preimage: [T; 3]) -> T {
        T::one()
    }
}
