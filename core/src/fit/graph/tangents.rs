//! Normals, tangent vectors and principal directions of graphs, and the dependence of H and K on coefficients.

use super::Graph;
use crate::lane::Lane;
use crate::real::Real;
use crate::vec3::{Vec3, add, normalise, scale, sub};

impl<L: Lane> Graph<L> {
    /// 1 + z_x² + z_y².
    #[inline(always)]
    fn metric(&self) -> L {
        let [p, q] = self.first;
        L::literal(1.0) + p * p + q * q
    }

    /// Trace of second derivatives with the inverse of the metric, times [`Self::metric`].
    #[inline(always)]
    fn trace(&self) -> [L; 3] {
        let [p, q] = self.first;
        let one = L::literal(1.0);
        [one + q * q, L::literal(-2.0) * p * q, one + p * p]
    }

    /// The derivatives of the position by x and y.
    #[inline(always)]
    fn tangents(&self, [along_x, along_y, up]: [Vec3<L>; 3]) -> [Vec3<L>; 2] {
        let [p, q] = self.first;
        [add(along_x, scale(p, up)), add(along_y, scale(q, up))]
    }

    /// The principal frame of the surface: the shape operator by the height's derivatives, in a frame of
    /// two tangent vectors of unit length. `axes` are the unit vectors along x, y and the height. Where all directions
    /// are principal, they are 0.
    #[inline(always)]
    pub(crate) fn principal(&self, axes: [Vec3<L>; 3]) -> PrincipalFrame<L> {
        let [p, q] = self.first;
        let (one, two, half) = (L::literal(1.0), L::literal(2.0), L::literal(0.5));
        // The inverse of the Cholesky factor of the metric.
        let length = (one + p * p).sqrt();
        let over_length = length.reciprocal_or_zero();
        let upright = self.uprightness();
        let [a, b, c] = [
            over_length,
            -(p * q * over_length * upright),
            length * upright,
        ];
        let in_frame = |second: [L; 3]| {
            let [xx, xy, yy] = second.map(|entry| -(upright * entry));
            let across = b * xx + c * xy;
            [a * a * xx, a * across, b * across + c * (b * xy + c * yy)]
        };
        let [first, shear, second] = in_frame(self.second);
        // Cosine and sine of half of the angle of (first − second, 2 shear), the larger one first.
        let (off, twice) = (first - second, two * shear);
        let size = (off * off + twice * twice).sqrt();
        let absolute = |x: L| L::select(x.less(L::zero()), -x, x);
        let larger = half * (one + absolute(off) * size.reciprocal_or_zero());
        let larger = larger.sqrt();
        let smaller = half * twice * (size * larger).reciprocal_or_zero();
        let signed = L::select(twice.less(L::zero()), -larger, larger);
        let is_steep = off.less(L::zero());
        let cosine = L::select(is_steep, absolute(smaller), larger);
        let sine = L::select(is_steep, signed, smaller);
        let [x, y] = self.tangents(axes);
        let vectors = [scale(a, x), add(scale(b, x), scale(c, y))];
        let is_umbilic = size.less(L::splat(
            <L::Scalar as num_traits::Float>::min_positive_value(),
        ));
        let turned = |cosine: L, sine: L| {
            let turned = normalise(add(scale(cosine, vectors[0]), scale(sine, vectors[1])));
            turned.map(|entry| L::select(is_umbilic, L::zero(), entry))
        };
        // Dependence of the off-diagonal entry, in the principal frame, on the second derivatives.
        let by_second = core::array::from_fn(|place| {
            let unit = core::array::from_fn(|other| if other == place { one } else { L::zero() });
            let [first, shear, second] = in_frame(unit);
            (second - first) * cosine * sine + shear * (cosine * cosine - sine * sine)
        });
        PrincipalFrame {
            directions: [turned(cosine, sine), turned(-sine, cosine)],
            by_second,
        }
    }

    /// The factors of the derivatives φ_x and φ_y in the gradient of a field: two tangent vectors.
    #[inline(always)]
    pub(crate) fn gradient(&self, axes: [Vec3<L>; 3]) -> [Vec3<L>; 2] {
        let [x, y] = self.tangents(axes);
        let over = self.metric().reciprocal_or_zero();
        let [xx, xy, yy] = self.trace().map(|entry| over * entry);
        let xy = L::literal(0.5) * xy;
        [
            add(scale(xx, x), scale(xy, y)),
            add(scale(xy, x), scale(yy, y)),
        ]
    }

    /// Outward unit normal, for axes along x, y and the height.
    #[inline(always)]
    pub(crate) fn normal(&self, [along_x, along_y, up]: [Vec3<L>; 3]) -> Vec3<L> {
        let [p, q] = self.first;
        normalise(sub(sub(up, scale(p, along_x)), scale(q, along_y)))
    }
}

impl<T: Real> Graph<T> {
    /// [`Self::laplacian`] for coefficients of 1, x, y, x², xy, y² of a field with coordinates in radii.
    pub(crate) fn laplacian_in_radii(&self, radius: T) -> [T; 6] {
        let along = radius.recip();
        let across = along * along;
        let [x, y, xx, xy, yy] = self.laplacian(self.uprightness());
        [
            T::zero(),
            x * along,
            y * along,
            xx * across,
            xy * across,
            yy * across,
        ]
    }

    /// The derivatives of H and K with respect to the coefficients of 1, x, y, x², xy, y² of the
    /// height, as factors of the coefficients of a field of heights in radii.
    pub(crate) fn variations(&self, radius: T) -> [[T; 6]; 2] {
        let two = T::constant(2.0);
        let [p, q] = self.first;
        let [r, s, t] = self.second;
        let [mean, gaussian] = self.curvatures();
        let upright = self.uprightness();
        let squared = upright * upright;
        let cubed = squared * upright;
        let along = radius.recip();
        let across = along * along;
        let of_second = |[by_r, by_s, by_t]: [T; 3], [by_p, by_q]: [T; 2]| {
            [
                T::zero(),
                by_p * along,
                by_q * along,
                two * by_r * across,
                by_s * across,
                two * by_t * across,
            ]
        };
        let half = T::constant(-0.5) * cubed;
        let steeper = T::constant(3.0) * mean * squared;
        let of_mean = of_second(
            self.trace().map(|factor| factor * half),
            [
                (q * s - p * t) * cubed - steeper * p,
                (p * s - q * r) * cubed - steeper * q,
            ],
        );
        let fourth = squared * squared;
        let flatter = T::constant(-4.0) * gaussian * squared;
        let of_gaussian = of_second(
            [t * fourth, -two * s * fourth, r * fourth],
            [flatter * p, flatter * q],
        );
        [of_mean, of_gaussian]
    }
}

/// The directions of principal curvatures.
pub(crate) struct PrincipalFrame<T> {
    /// Tangent unit vectors, of the larger and the smaller curvature.
    pub(crate) directions: [Vec3<T>; 2],
    /// Derivatives of the off-diagonal entry of the shape operator with respect to z_xx, z_xy and z_yy.
    pub(crate) by_second: [T; 3],
}
