//! Exact surfaces: position, normal, curvatures and the Laplacian of the mean curvature at every
//! point, by formula.
//!
//! Signs and units as everywhere in this crate: normals point outward, `H` is positive on a sphere.

use crate::real::Real;

/// What is exactly known at one point of a [`Shape`].
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
/// Points are named by their *pre-image*: on sphere-like shapes a point of the unit sphere, on the
/// torus the point itself. Meshes are made and refined on the pre-image and mapped.
pub trait Shape<T: Real> {
    /// The exact surface at a pre-image.
    fn at(&self, preimage: [T; 3]) -> ExactPoint<T>;

    /// A pre-image for any point near the surface: exact on it, nearby off it.
    fn preimage(&self, position: [T; 3]) -> [T; 3];

    /// The position of a pre-image: `self.at(preimage).position`.
    fn position(&self, preimage: [T; 3]) -> [T; 3] {
        self.at(preimage).position
    }
}
