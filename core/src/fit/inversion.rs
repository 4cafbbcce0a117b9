//! An inversion that flattens a surface around a vertex before a polynomial is fitted to it.
//!
//! The map `y = (d − |d|² b)/(1 − 2 b·d + |b|²|d|²)` of the offsets d from the vertex, b = β n with the
//! normal n, is a Möbius map: the force density f = 2[Δ_S H + 2H(H² − K)] is that of the image, divided by
//! the third power of the factor of lengths, which is 1 at the vertex, and so is the factor of Δ_S. A sphere
//! of curvature H becomes a plane with β = −H/2.
//!
//! J. H. White, Proc. Am. Math. Soc. 38 (1973) 162.

use super::graph::{Bending, Graph, bending};
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
    /// H_x and H_y, K_x and K_y.
    pub(crate) slopes: [[L; 2]; 2],
    /// Δ_S H of the surface itself, from the coefficients up to degree 4.
    pub(crate) laplacian_of_mean: L,
}

impl<L: Lane> Inversion<L> {
    /// The factor by which an inversion divides: 0 at the offset that it maps to infinity.
    #[inline(always)]
    pub(crate) fn scale_at(self, [x, y, z]: [L; 3]) -> L {
        let Self(bend) = self;
        L::literal(1.0) + bend * (bend * (x * x + y * y + z * z) - (z + z))
    }

    /// The image of an offset.
    #[inline(always)]
    pub(crate) fn image(self, [x, y, z]: [L; 3]) -> [L; 3] {
        let Self(bend) = self;
        let squared = x * x + y * y + z * z;
        let scale = L::literal(1.0) + bend * (bend * squared - (z + z));
        let over = scale.reciprocal_or_zero();
        [x * over, y * over, (z - bend * squared) * over]
    }

    /// Curvatures of the surface at the vertex, from the coefficients of the image.
    #[inline(always)]
    pub(crate) fn at_vertex(self, coefficients: &[L]) -> Bent<L> {
        let graph = Graph::of_coefficients(coefficients);
        let uprightness = graph.uprightness();
        let (flat, two) = (graph.mean(uprightness), L::literal(2.0));
        let gaussian = graph.gaussian(uprightness);
        let twice = two * self.0;
        let shift = -(twice * uprightness);
        let bent = |mean: L, gaussian: L| two * mean * (mean * mean - gaussian);
        let mean = flat + shift;
        let Bending {
            of_mean,
            of_gaussian,
            of_uprightness,
            laplacian_of_mean,
        } = bending(coefficients);
        let density = laplacian_of_mean + bent(flat, gaussian);
        // Lengths grow by the factor 1 + 2β z + …, curvatures shrink by it.
        let slopes = [0, 1].map(|k| {
            let growth = twice * graph.first[k];
            let of_shift = -(twice * of_uprightness[k]);
            let of_flat = of_mean[k] + flat * growth;
            let of_image = of_gaussian[k] + two * gaussian * growth;
            let of_gaussian =
                of_image + of_shift * (two * flat + shift) + shift * (two * of_flat + of_shift);
            [of_flat + of_shift, of_gaussian]
        });
        let gaussian = gaussian + shift * (two * flat + shift);
        Bent {
            mean,
            gaussian,
            slopes: [0, 1].map(|which| slopes.map(|of| of[which])),
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
