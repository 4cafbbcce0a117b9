//! Polynomials of degree 6 on a triangle, its quadrature, and the functions that blend three jets.
//!
//! Points are i/6, j/6, k/6 in barycentric coordinates. Local edge l of a triangle leads from corner l
//! to corner l + 1; its five points are counted from corner l. The free points are the fifteen on edges,
//! edge after edge, and the ten inside. The patch interpolates the vertices at the corners.
//!
//! Quadrature: K. Gatermann, Computing 40 (1988) 229.

use crate::real::Real;
use alloc::vec::Vec;

/// Degree of a patch.
const DEGREE: usize = 6;
/// Points of an edge without its ends.
pub(super) const ON_EDGE: usize = DEGREE - 1;
/// Points of a triangle that are on no edge.
pub(super) const INSIDE: usize = 10;
/// Points of a triangle without its corners.
pub(super) const FREE: usize = 3 * ON_EDGE + INSIDE;
/// Quadrature points of a triangle: exact for polynomials of degree 7.
pub(super) const QUADRATURE: usize = 12;
/// Quadrature points of an edge: exact for degree 7, too. With three points energies are less accurate
/// from ten thousand vertices on.
pub(super) const GAUSS: usize = 4;

/// The points inside, in sixths of the barycentric coordinates of a corner and of the two that follow it.
pub(super) const INNER: [[usize; 3]; INSIDE] = [
    [4, 1, 1],
    [1, 4, 1],
    [1, 1, 4],
    [3, 2, 1],
    [1, 3, 2],
    [2, 1, 3],
    [3, 1, 2],
    [2, 3, 1],
    [1, 2, 3],
    [2, 2, 2],
];

/// The number, among the points inside a triangle, of point `inner` as `corner` counts them.
pub(super) const fn inner_from(corner: usize, inner: usize) -> usize {
    let seen = INNER[inner];
    let mut found = 0;
    while found < INSIDE {
        let point = INNER[found];
        if point[corner] == seen[0] && point[(corner + 1) % 3] == seen[1] {
            return found;
        }
        found += 1;
    }
    found
}

/// The points around a corner that its jet helps to place: those of the edge to the next corner, then
/// those inside. In barycentric coordinates of this corner and of the two that follow.
pub(super) const AROUND: [[f64; 3]; ON_EDGE + INSIDE] = {
    let mut points = [[0.0; 3]; ON_EDGE + INSIDE];
    let mut k = 0;
    while k < ON_EDGE {
        let t = (k + 1) as f64 / DEGREE as f64;
        points[k] = [1.0 - t, t, 0.0];
        k += 1;
    }
    while k < ON_EDGE + INSIDE {
        let [i, j, l] = INNER[k - ON_EDGE];
        let sixths = DEGREE as f64;
        points[k] = [i as f64 / sixths, j as f64 / sixths, l as f64 / sixths];
        k += 1;
    }
    points
};

/// `λ² (3 − 2λ) + 2 λ λ′ λ″`: the weight of a corner's jet at a point with these barycentric coordinates.
/// The weights of the three corners sum to 1, and on the opposite edge the weight is 0.
pub(super) const fn blend([own, next, other]: [f64; 3]) -> f64 {
    own * own * (3.0 - 2.0 * own) + 2.0 * own * next * other
}

/// The free points of a triangle in barycentric coordinates.
pub(super) const POINTS: [[f64; 3]; FREE] = {
    let mut points = [[0.0; 3]; FREE];
    let mut k = 0;
    while k < FREE {
        if k < 3 * ON_EDGE {
            let (edge, [from, to, _]) = (k / ON_EDGE, AROUND[k % ON_EDGE]);
            points[k][edge] = from;
            points[k][(edge + 1) % 3] = to;
        } else {
            points[k] = AROUND[k - 3 * ON_EDGE + ON_EDGE];
        }
        k += 1;
    }
    points
};

/// Orbits of three quadrature points: two barycentric coordinates of one, and three times the weight
/// of each.
const ORBITS: [[f64; 3]; 4] = [
    [
        0.062_382_265_094_402_12,
        0.067_517_867_073_916_09,
        0.159_102_168_944_617_5,
    ],
    [
        0.055_225_456_656_926_61,
        0.321_502_493_851_981_8,
        0.263_288_452_286_676_3,
    ],
    [
        0.034_324_302_945_097_15,
        0.660_949_196_186_735_6,
        0.172_650_256_709_889_54,
    ],
    [
        0.515_842_334_353_591_7,
        0.277_716_166_976_391_8,
        0.404_959_122_058_816_7,
    ],
];

/// Nodes in [0, 1] and weights of Gauss's quadrature.
fn gauss() -> [[f64; 2]; GAUSS] {
    let root = num_traits::Float::sqrt(1.2);
    let [inner, outer] =
        [-1.0, 1.0].map(|sign| num_traits::Float::sqrt((3.0 + sign * 2.0 * root) / 7.0));
    let part = num_traits::Float::sqrt(30.0);
    let [heavy, light] = [1.0, -1.0].map(|sign| (18.0 + sign * part) / 72.0);
    [
        [0.5 - 0.5 * outer, light],
        [0.5 - 0.5 * inner, heavy],
        [0.5 + 0.5 * inner, heavy],
        [0.5 + 0.5 * outer, light],
    ]
}

/// Value and first two derivatives of `Π_{a < count} (6 t − a)/(a + 1)`.
fn factor(count: usize, t: f64) -> [f64; 3] {
    let mut factor = [1.0, 0.0, 0.0];
    for a in 0..count {
        let over = 1.0 / (a + 1) as f64;
        let (value, slope) = (over * (DEGREE as f64 * t - a as f64), over * DEGREE as f64);
        let [f, d, dd] = factor;
        factor = [
            f * value,
            d * value + f * slope,
            dd * value + 2.0 * d * slope,
        ];
    }
    factor
}

/// Value, ∂v, ∂w, ∂vv, ∂vw, ∂ww at (v, w) of the polynomial that is 1 at a point and 0 at the others;
/// v and w are the second and third barycentric coordinate.
fn polynomial(point: [f64; 3], [v, w]: [f64; 2]) -> [f64; 6] {
    let sixths = point.map(|x| num_traits::Float::round(DEGREE as f64 * x) as usize);
    let [a, b, c] = [
        factor(sixths[0], 1.0 - v - w),
        factor(sixths[1], v),
        factor(sixths[2], w),
    ];
    let term = |i: usize, j: usize, k: usize| a[i] * b[j] * c[k];
    [
        term(0, 0, 0),
        term(0, 1, 0) - term(1, 0, 0),
        term(0, 0, 1) - term(1, 0, 0),
        term(2, 0, 0) - 2.0 * term(1, 1, 0) + term(0, 2, 0),
        term(2, 0, 0) - term(1, 1, 0) - term(1, 0, 1) + term(0, 1, 1),
        term(2, 0, 0) - 2.0 * term(1, 0, 1) + term(0, 0, 2),
    ]
}

/// The polynomials of the free points at one quadrature point.
#[derive(Clone, Debug)]
pub(super) struct QuadraturePoint<T> {
    /// Part of the area of the parameter triangle, or of the edge.
    pub(super) weight: T,
    /// The second and third barycentric coordinate.
    pub(super) place: [T; 2],
    /// Values, at free points and corners.
    pub(super) values: [T; FREE],
    pub(super) corners: [T; 3],
    /// ∂v, ∂w, ∂vv, ∂vw, ∂ww.
    pub(super) derivatives: [[T; 5]; FREE],
}

impl<T: Real> QuadraturePoint<T> {
    fn new(weight: f64, [v, w]: [f64; 2]) -> Self {
        let mut node = Self {
            weight: T::constant(weight),
            place: [v, w].map(T::constant),
            values: [T::zero(); FREE],
            corners: [T::zero(); 3],
            derivatives: [[T::zero(); 5]; FREE],
        };
        for (k, &point) in POINTS.iter().enumerate() {
            let [value, derivatives @ ..] = polynomial(point, [v, w]);
            node.values[k] = T::constant(value);
            node.derivatives[k] = derivatives.map(T::constant);
        }
        for (k, corner) in node.corners.iter_mut().enumerate() {
            let mut point = [0.0; 3];
            point[k] = 1.0;
            *corner = T::constant(polynomial(point, [v, w])[0]);
        }
        node
    }
}

/// The quadrature points of a patch.
#[derive(Clone, Debug)]
pub(super) struct Basis<T> {
    pub(super) bulk: Vec<QuadraturePoint<T>>,
    /// Points of each edge, from its first corner to its second.
    pub(super) edges: Vec<QuadraturePoint<T>>,
}

impl<T: Real> Basis<T> {
    pub(super) fn new() -> Self {
        let mut bulk = Vec::with_capacity(QUADRATURE);
        for [a, b, weight] in ORBITS {
            let c = 1.0 - a - b;
            for place in [[a, b], [b, c], [c, a]] {
                bulk.push(QuadraturePoint::new(weight / 6.0, place));
            }
        }
        let mut edges = Vec::with_capacity(3 * GAUSS);
        for edge in 0..3 {
            for [t, weight] in gauss() {
                let place = [[t, 0.0], [1.0 - t, t], [0.0, 1.0 - t]][edge];
                edges.push(QuadraturePoint::new(weight, place));
            }
        }
        Self { bulk, edges }
    }
}
