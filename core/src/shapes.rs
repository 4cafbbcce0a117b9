//! Exact surfaces: formulas for position, normal, curvatures and the Laplacian of the mean
//! curvature at every point.
//!
//! Signs and units as everywhere in this crate: normals point outward, `H` is positive on a sphere.
//! Every shape is computed in units of its own size, so that a scaled shape gives the same digits
//! whatever the scale.

mod discocyte;
mod ellipsoid;
mod sphere;
mod torus;

pub use discocyte::Discocyte;
pub use ellipsoid::Ellipsoid;
pub use sphere::Sphere;
pub use torus::Torus;

use crate::real::Real;

/// Exact geometry at one point of a [`Shape`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExactPoint<T> {
    /// The point x.
    pub position: [T; 3],
    /// Outward unit normal n.
    pub normal: [T; 3],
    /// Mean curvature H = (c₁ + c₂)/2, 1/length.
    pub mean: T,
    /// Gaussian curvature K = c₁ c₂, 1/length².
    pub gaussian: T,
    /// Δ_S H, 1/length³.
    pub laplacian_of_mean: T,
}

impl<T: Real> ExactPoint<T> {
    /// The Helfrich force density f·n = κ·2[Δ_S H + 2H(H² − K)] for zero spontaneous curvature;
    /// the density itself is this times the normal.
    pub fn force_density(&self, modulus: T) -> T {
        let two = T::constant(2.0);
        let cubic = two * self.mean * (self.mean * self.mean - self.gaussian);
        modulus * two * (self.laplacian_of_mean + cubic)
    }
}

/// A smooth closed surface that is known by formula.
///
/// Points are identified by their *pre-image*: a point of the unit sphere for sphere-like shapes,
/// the point itself for the torus. Meshes are generated and refined on the pre-image, then mapped.
pub trait Shape<T: Real> {
    /// The exact surface at a pre-image.
    fn at(&self, preimage: [T; 3]) -> ExactPoint<T>;

    /// A pre-image for any point near the surface: exact on it, nearby off it.
    fn preimage(&self, position: [T; 3]) -> [T; 3];

    /// Ratio dS/dΩ of surface area to area of the pre-image: a length² for sphere-like shapes, 1
    /// for the torus.
    fn area_element(&self, preimage: [T; 3]) -> T;

    /// The position of a pre-image: `self.at(preimage).position`.
    fn position(&self, preimage: [T; 3]) -> [T; 3] {
        self.at(preimage).position
    }
}

/// A parameter outside the range in which it describes a smooth closed surface.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the {parameter} is {value}: it must lie above {above} and below {below}")]
pub struct ShapeError {
    /// The parameter, with its shape's name.
    pub parameter: &'static str,
    /// The given value.
    pub value: f64,
    /// The lower bound, which it must exceed.
    pub above: f64,
    /// The upper bound, which it must stay below; infinite where every finite number will do.
    pub below: f64,
}

/// Returns `value` if it lies strictly between `above` and `below`; NaN does not.
fn between<T: Real>(
    parameter: &'static str,
    value: T,
    above: T,
    below: T,
) -> Result<T, ShapeError> {
    if above < value && value < below {
        return Ok(value);
    }
    let number = |t: T| t.to_f64().unwrap_or(f64::NAN);
    Err(ShapeError {
        parameter,
        value: number(value),
        above: number(above),
        below: number(below),
    })
}
