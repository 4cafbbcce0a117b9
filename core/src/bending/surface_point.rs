//! A surface at one quadrature point: curvature, bending energy and their derivatives.

use crate::lane::Lane;
use crate::vec3::{Vec3, add, cross, dot, scale, sub};
use num_traits::Float;

/// First and second derivatives x_v, x_w, x_vv, x_vw, x_ww and derived quantities.
///
/// All quantities are divided by powers of `J = |x_v × x_w|` as they are computed. No power of a
/// length beyond J² is ever formed, so that surfaces of any size neither overflow nor underflow.
pub(super) struct Point<L> {
    tangents: [Vec3<L>; 2],
    second: [Vec3<L>; 3],
    /// Normal n; 0 if there is no area, so that the point contributes nothing.
    pub(super) normal: Vec3<L>,
    /// J, and 1/J or 0.
    pub(super) area: L,
    over: L,
    /// x_v·x_v/J, x_v·x_w/J and x_w·x_w/J.
    metric: [L; 3],
    /// `(x_v·x_v x_ww − 2 x_v·x_w x_vw + x_w·x_w x_vv)/J`.
    bending: Vec3<L>,
    /// Its part along n: −2HJ.
    bend: L,
}

/// `x_v × x_w` and its length, 0 where the directions of the tangents differ only by rounding.
#[inline(always)]
pub(super) fn area_vector<L: Lane>(v: Vec3<L>, w: Vec3<L>) -> (Vec3<L>, L) {
    let vector = cross(v, w);
    let area = dot(vector, vector).sqrt();
    let rounding = L::splat(<L::Scalar as Float>::epsilon());
    let noise = L::literal(16.0) * rounding * (dot(v, v) + dot(w, w));
    (vector, L::select(noise.less(area), area, L::zero()))
}

impl<L: Lane> Point<L> {
    #[inline(always)]
    pub(super) fn new([v, w, vv, vw, ww]: [Vec3<L>; 5]) -> Self {
        let (vector, area) = area_vector(v, w);
        let over = area.reciprocal_or_zero();
        let normal = scale(over, vector);
        let metric = [dot(v, v) * over, dot(v, w) * over, dot(w, w) * over];
        let [e, f, g] = metric;
        let bending = add(sub(scale(e, ww), scale(f + f, vw)), scale(g, vv));
        Self {
            tangents: [v, w],
            second: [vv, vw, ww],
            normal,
            area,
            over,
            metric,
            bending,
            bend: dot(bending, normal),
        }
    }

    /// H, positive on a sphere, and K.
    #[inline(always)]
    pub(super) fn curvatures(&self) -> [L; 2] {
        let [l, m, n] = self.bent(self.over);
        [self.mean(), l * n - m * m]
    }

    /// The second derivatives along n, times a factor.
    #[inline(always)]
    fn bent(&self, factor: L) -> [L; 3] {
        let [vv, vw, ww] = self.second;
        let along = |second| factor * dot(second, self.normal);
        [along(vv), along(vw), along(ww)]
    }

    /// H, positive on a sphere.
    #[inline(always)]
    pub(super) fn mean(&self) -> L {
        -L::literal(0.5) * self.bend * self.over
    }

    /// The derivatives of a function of H and n with respect to x_v, x_w, x_vv, x_vw and x_ww, from its
    /// derivatives with respect to H and n.
    ///
    /// With `h = −½ ∂H/J²`, B the vector whose part along n is −2HJ, and `p` the derivative with
    /// respect to `x_v × x_w`: `J p = −2H ∂H n + (1 − n nᵀ)(∂n − ½ ∂H B/J)`.
    #[inline(always)]
    pub(super) fn pull(&self, by_mean: L, by_normal: Vec3<L>) -> [Vec3<L>; 5] {
        let [v, w] = self.tangents;
        let [e, f, g] = self.metric;
        let half = L::literal(0.5) * by_mean * self.over;
        let turned = sub(by_normal, scale(half, self.bending));
        let level = dot(self.normal, turned) + (by_mean + by_mean) * self.mean();
        let p = scale(self.over, sub(turned, scale(level, self.normal)));
        let [l, m, n] = self.bent(-by_mean * self.over * self.over);
        [
            add(sub(scale(n, v), scale(m, w)), cross(w, p)),
            add(sub(scale(l, w), scale(m, v)), cross(p, v)),
            scale(-half * g, self.normal),
            scale((half + half) * f, self.normal),
            scale(-half * e, self.normal),
        ]
    }

    /// c = −2(H − H0)J.
    #[inline(always)]
    fn excess(&self, spontaneous: L) -> L {
        self.bend + (spontaneous + spontaneous) * self.area
    }

    /// `2κ (H − H0)² J`, for κ times the weight of the point.
    #[inline(always)]
    pub(super) fn energy(&self, modulus: L, spontaneous: L) -> L {
        let excess = self.excess(spontaneous);
        L::literal(0.5) * modulus * excess * excess * self.over
    }

    /// The derivatives of the energy with respect to x_v, x_w, x_vv, x_vw and x_ww.
    ///
    /// With b = −2HJ, c = b + 2 H0 J, `s = κ c/J²`, `B` the vector whose part along n is b, and
    /// `p = s (B − (3b − c/2) n)`: `∂E/∂x_v = 2s (x_ww·n) x_v − 2s (x_vw·n) x_w + x_w × p`,
    /// `∂E/∂x_w = 2s (x_vv·n) x_w − 2s (x_vw·n) x_v + p × x_v`, and along n
    /// `s x_w·x_w`, `−2s x_v·x_w`, `s x_v·x_v` for the second derivatives.
    #[inline(always)]
    pub(super) fn gradient(&self, modulus: L, spontaneous: L) -> [Vec3<L>; 5] {
        let [v, w] = self.tangents;
        let [e, f, g] = self.metric;
        let excess = self.excess(spontaneous);
        // s·J: the remaining powers of J are in the metric, or in `over`.
        let strength = modulus * excess * self.over;
        let twice = (strength + strength) * self.over;
        let [l, m, n] = self.bent(twice);
        let shrink = L::literal(3.0) * self.bend - L::literal(0.5) * excess;
        let p = scale(
            strength * self.over,
            sub(self.bending, scale(shrink, self.normal)),
        );
        [
            add(sub(scale(n, v), scale(m, w)), cross(w, p)),
            add(sub(scale(l, w), scale(m, v)), cross(p, v)),
            scale(strength * g, self.normal),
            scale(-(strength + strength) * f, self.normal),
            scale(strength * e, self.normal),
        ]
    }
}
