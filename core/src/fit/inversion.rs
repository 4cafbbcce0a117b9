//! An inversion that flattens a surface around a vertex before a polynomial is fitted to it.
//!
//! The map `y = (d − |d|² b)/(1 − 2 b·d + |b|²|d|²)` of the offsets d from the vertex, b = β n with the
//! normal n, is a Möbius map: the force density f = 2[Δ_S H + 2H(H² − K)] is that of the image, divided by
//! the third power of the factor of lengths, which is 1 at the vertex, and so is the factor of Δ_S. A sphere
//! of curvature H becomes a plane with β = −H/2.
//!
//! J. H. White, Proc. Am. Math. Soc. 38 (1973) 162.

use super::graph::{Graph, laplacian_of_mean};
use crate::lane::Lane;

/// The inversion with b = β n, in a frame of which n is the third axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inversion<L>(
    /// β.
    pub(crate) L,
);

/// The surface at the vertex.
pub(crate) struct Bent<L> {
    /// H.
    pub(crate) mean: L,
    /// K.
    pub(crate) gaussian: L,
    /// Δ_S H of the surface itself, from the coefficients up to degree 4.
    pub(crate) laplacian_of_mean: L,
}

impl<L: Lane> Inversion<L> {
    /// The image of an offset.
    #[inline(always)]
    pub(crate) fn image(self, [x, y, z]: [L; 3]) -> [L; 3] {
        let Self(bend) = self;
        let squared = x * x + y * y + z * z;
        let scale = L::literal(1.0) + bend * (bend * squared - (z + z));
        let over = scale.reciprocal_or_zero();
        [x * over, y * over, (z - bend * squared) * over]
    }

    /// The derivatives by an offset and by β of a number whose derivative by the image is known.
    #[inline(always)]
    pub(crate) fn pull_back(self, [x, y, z]: [L; 3], by_image: [L; 3]) -> ([L; 3], L) {
        let Self(bend) = self;
        let squared = x * x + y * y + z * z;
        let scale = L::literal(1.0) + bend * (bend * squared - (z + z));
        let over = scale.reciprocal_or_zero();
        let [u, v, w] = self.image([x, y, z]);
        let [by_u, by_v, by_w] = by_image;
        // With D the scale and Y the image: dY = (dd − |d|² db − b d|d|² − Y dD)/D.
        let along = by_u * u + by_v * v + by_w * w;
        let upward = by_w + bend * along;
        let by_squared = -(bend * upward);
        let twice = by_squared + by_squared;
        let by_offset = [
            over * (by_u + twice * x),
            over * (by_v + twice * y),
            over * (upward + bend * along + twice * z),
        ];
        let by_bend = over * ((z + z) * along - squared * (upward + bend * along));
        (by_offset, by_bend)
    }

    /// Curvatures of the surface at the vertex, from the coefficients of the image.
    #[inline(always)]
    pub(crate) fn at_vertex(self, coefficients: &[L]) -> Bent<L> {
        let graph = Graph::of_coefficients(coefficients);
        let uprightness = graph.uprightness();
        let (flat, two) = (graph.mean(uprightness), L::literal(2.0));
        let gaussian = graph.gaussian(uprightness);
        let shift = -(two * self.0 * uprightness);
        let bent = |mean: L, gaussian: L| two * mean * (mean * mean - gaussian);
        let mean = flat + shift;
        let density = laplacian_of_mean(coefficients) + bent(flat, gaussian);
        let gaussian = gaussian + shift * (two * flat + shift);
        Bent {
            mean,
            gaussian,
            laplacian_of_mean: density - bent(mean, gaussian),
        }
    }

    /// H and K of the surface at the point of which the image lies at (x, y) of a graph of height z there.
    #[inline(always)]
    pub(crate) fn curvatures_at(self, [x, y, z]: [L; 3], graph: &Graph<L>) -> [L; 2] {
        let Self(bend) = self;
        let (one, two) = (L::literal(1.0), L::literal(2.0));
        let uprightness = graph.uprightness();
        let [p, q] = graph.first;
        let scale = one + bend * (two * z + bend * (x * x + y * y + z * z));
        let tilt = one + bend * (z - x * p - y * q);
        // Both principal curvatures are those of the image, stretched, and shifted.
        let shift = two * bend * tilt * uprightness;
        let stretched = graph.mean(uprightness) * scale;
        let gaussian = graph.gaussian(uprightness) * (scale * scale);
        let shifted = gaussian - shift * (two * stretched - shift);
        [stretched - shift, shifted]
    }
}
