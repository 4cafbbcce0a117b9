//! One triangle, or several in the entries of a lane.

use crate::lane::Lane;
use crate::vec3::{Vec3, cross, dot, scale, sub};
use num_traits::Float;

/// The rule by which the area of a triangle is divided among its corners.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum DualArea {
    /// The part of the triangle that is nearest to the vertex; in an obtuse triangle, half of the
    /// triangle at the obtuse corner and a quarter at the two others. Positive, and continuous in
    /// the positions. Meyer, Desbrun, Schröder, Barr 2003.
    #[default]
    Mixed,
    /// ⅛ Σ (cot α + cot β) l²: signed, and reaches zero and below on obtuse fans.
    Voronoi,
    /// A third of each triangle.
    Barycentric,
}

/// A [`DualArea`] that is known at compile time, because a choice inside a loop over elements would
/// prevent vectorisation.
pub(crate) trait Kind: Copy + Sync {
    const AREA: DualArea;
}

/// [`DualArea::Mixed`].
#[derive(Clone, Copy)]
pub(crate) struct Mixed;

/// [`DualArea::Voronoi`].
#[derive(Clone, Copy)]
pub(crate) struct Voronoi;

/// [`DualArea::Barycentric`].
#[derive(Clone, Copy)]
pub(crate) struct Barycentric;

impl Kind for Mixed {
    const AREA: DualArea = DualArea::Mixed;
}

impl Kind for Voronoi {
    const AREA: DualArea = DualArea::Voronoi;
}

impl Kind for Barycentric {
    const AREA: DualArea = DualArea::Barycentric;
}

/// A triangle with the quantities that cotangent formulas share, computed once.
///
/// Corner k lies opposite `edges[k]`; the edges run around the triangle and sum to zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle<L> {
    pub(crate) edges: [Vec3<L>; 3],
    /// Scalar product of the two edge vectors that leave corner k.
    pub(crate) dots: [L; 3],
    /// The normal with twice the triangle's area as its length.
    pub(crate) area_vector: Vec3<L>,
    pub(crate) doubled_area: L,
    /// 0 for a triangle without area, which therefore contributes nothing.
    pub(crate) reciprocal: L,
}

impl<L: Lane> Triangle<L> {
    #[inline(always)]
    pub(crate) fn new(edges: [Vec3<L>; 3]) -> Self {
        let area_vector = cross(edges[1], edges[2]);
        // A square below the smallest normal number has lost digits, and its root would be wrong.
        let squared = dot(area_vector, area_vector);
        let least = L::splat(L::Scalar::min_positive_value());
        let doubled_area = L::select(squared.less(least), L::zero(), squared).sqrt();
        Self {
            edges,
            dots: [
                -dot(edges[1], edges[2]),
                -dot(edges[2], edges[0]),
                -dot(edges[0], edges[1]),
            ],
            area_vector,
            doubled_area,
            reciprocal: doubled_area.reciprocal_or_zero(),
        }
    }

    #[inline(always)]
    pub(crate) fn normal(&self) -> Vec3<L> {
        scale(self.reciprocal, self.area_vector)
    }

    #[inline(always)]
    pub(crate) fn cotangents(&self) -> [L; 3] {
        self.dots.map(|dot| dot * self.reciprocal)
    }

    /// The gradient of the triangle's area with respect to each corner, in its cotangent form.
    #[inline(always)]
    pub(crate) fn area_gradient(&self) -> [Vec3<L>; 3] {
        let half = L::literal(0.5) * self.reciprocal;
        let part: [Vec3<L>; 3] =
            core::array::from_fn(|k| scale(half * self.dots[k], self.edges[k]));
        [
            sub(part[1], part[2]),
            sub(part[2], part[0]),
            sub(part[0], part[1]),
        ]
    }

    /// The opposite edge of each corner, rotated outward in the plane and scaled. With a factor of
    /// ½ this is the gradient of the area, equal to [`Self::area_gradient`] to rounding.
    #[inline(always)]
    pub(crate) fn outward_edges(&self, factor: L) -> [Vec3<L>; 3] {
        let normal = scale(factor, self.normal());
        self.edges.map(|edge| cross(normal, edge))
    }

    #[inline(always)]
    pub(crate) fn angles(&self) -> [L; 3] {
        // Not by `map`, which would leave the arctangents behind a call.
        let [a, b, c] = self.dots;
        let height = self.doubled_area;
        [height.atan2(a), height.atan2(b), height.atan2(c)]
    }

    /// The part of the area that belongs to each corner.
    ///
    /// With S twice the area and d the scalar products, `S² = d0 d1 + d1 d2 + d2 d0` turns the
    /// Voronoi part `⅛ Σ cot l²` into `⅛ (S + d1 d2/S)`: squared lengths are not needed.
    #[inline(always)]
    pub(crate) fn dual_areas<K: Kind>(&self, _kind: K) -> [L; 3] {
        let voronoi = || {
            let eighth = L::literal(0.125);
            self.dot_products()
                .map(|m| eighth * (self.doubled_area + self.reciprocal * m))
        };
        match K::AREA {
            DualArea::Voronoi => voronoi(),
            DualArea::Barycentric => [self.doubled_area * L::literal(1.0 / 6.0); 3],
            DualArea::Mixed => {
                let voronoi = voronoi();
                let obtuse = self.obtuse();
                let any_obtuse = self.any_obtuse();
                let quarter = L::literal(0.25) * self.doubled_area;
                let eighth = L::literal(0.125) * self.doubled_area;
                core::array::from_fn(|k| {
                    let blunt = L::select(obtuse[k], quarter, eighth);
                    L::select(any_obtuse, blunt, voronoi[k])
                })
            }
        }
    }

    /// The products of the scalar products at the two other corners.
    #[inline(always)]
    pub(crate) fn dot_products(&self) -> [L; 3] {
        let [a, b, c] = self.dots;
        [b * c, c * a, a * b]
    }

    /// Whether the angle at each corner is obtuse.
    #[inline(always)]
    pub(crate) fn obtuse(&self) -> [L::Mask; 3] {
        self.dots.map(|dot| dot.less(L::zero()))
    }

    #[inline(always)]
    pub(crate) fn any_obtuse(&self) -> L::Mask {
        let least = |a: L, b: L| L::select(a.less(b), a, b);
        least(least(self.dots[0], self.dots[1]), self.dots[2]).less(L::zero())
    }
}
