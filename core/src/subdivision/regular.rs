//! The box spline of a triangle whose three vertices have valence 6.

/// Contribution of one control point to a point (v, w) of a patch: value and derivatives of its
/// basis function, per unit of v and w.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Basis {
    /// φ.
    pub value: f64,
    /// ∂φ/∂v and ∂φ/∂w.
    pub first: [f64; 2],
    /// ∂²φ/∂v², ∂²φ/∂v∂w and ∂²φ/∂w².
    pub second: [f64; 3],
}

/// Twelve times the polynomials in (x, y, z): coefficients and exponents.
type Polynomial = &'static [(f64, [usize; 3])];

/// The basis function of a corner of the triangle: x is the barycentric coordinate of that corner.
const CORNER: Polynomial = &[
    (6.0, [4, 0, 0]),
    (24.0, [3, 1, 0]),
    (24.0, [3, 0, 1]),
    (24.0, [2, 2, 0]),
    (24.0, [2, 0, 2]),
    (60.0, [2, 1, 1]),
    (8.0, [1, 3, 0]),
    (8.0, [1, 0, 3]),
    (36.0, [1, 2, 1]),
    (36.0, [1, 1, 2]),
    (1.0, [0, 4, 0]),
    (1.0, [0, 0, 4]),
    (6.0, [0, 3, 1]),
    (6.0, [0, 1, 3]),
    (12.0, [0, 2, 2]),
];

/// The basis function of the vertex across an edge, whose ends have the coordinates x and y.
const ACROSS: Polynomial = &[
    (1.0, [4, 0, 0]),
    (1.0, [0, 4, 0]),
    (6.0, [3, 1, 0]),
    (6.0, [1, 3, 0]),
    (12.0, [2, 2, 0]),
    (2.0, [3, 0, 1]),
    (2.0, [0, 3, 1]),
    (6.0, [2, 1, 1]),
    (6.0, [1, 2, 1]),
];

/// The basis function of a vertex that shares with the triangle only the corner of coordinate x.
const APART: Polynomial = &[(1.0, [4, 0, 0]), (2.0, [3, 1, 0])];

/// For each node its polynomial, and which of (u, v, w) are its x, y and z.
const NODES: [(Polynomial, [usize; 3]); 12] = [
    (CORNER, [0, 1, 2]),
    (CORNER, [1, 0, 2]),
    (CORNER, [2, 0, 1]),
    (ACROSS, [0, 2, 1]),
    (APART, [0, 2, 1]),
    (APART, [0, 1, 2]),
    (ACROSS, [0, 1, 2]),
    (APART, [1, 0, 2]),
    (APART, [1, 2, 0]),
    (ACROSS, [1, 2, 0]),
    (APART, [2, 1, 0]),
    (APART, [2, 0, 1]),
];

/// The twelve basis functions at (v, w): quartic polynomials in barycentric coordinates, with
/// u = 1 − v − w. The nodes are in the order of a [`super::Patch`].
pub(super) fn regular_basis(v: f64, w: f64) -> [Basis; 12] {
    let coordinates = [1.0 - v - w, v, w];
    NODES.map(|(polynomial, order)| {
        let partial = |a: usize, b: usize| {
            let mut orders = [0; 3];
            for k in [a, b] {
                if let Some(order) = orders.get_mut(k) {
                    *order += 1;
                }
            }
            derivative(polynomial, order, coordinates, orders) / 12.0
        };
        const NO: usize = 3;
        let [du, dv, dw] = [0, 1, 2].map(|k| partial(k, NO));
        let uu = partial(0, 0);
        let [uv, uw, vw] = [[0, 1], [0, 2], [1, 2]].map(|[a, b]| partial(a, b));
        Basis {
            value: partial(NO, NO),
            first: [dv - du, dw - du],
            second: [
                partial(1, 1) - 2.0 * uv + uu,
                vw - uv - uw + uu,
                partial(2, 2) - 2.0 * uw + uu,
            ],
        }
    })
}

/// The derivative of these orders in u, v and w, taken as independent.
fn derivative(
    polynomial: Polynomial,
    order: [usize; 3],
    coordinates: [f64; 3],
    orders: [usize; 3],
) -> f64 {
    let term = |&(coefficient, exponents): &(f64, [usize; 3])| {
        let factors = exponents.iter().zip(order).map(|(&exponent, axis)| {
            let times = orders[axis];
            if times > exponent {
                return 0.0;
            }
            let falling: usize = (exponent - times + 1..=exponent).product();
            falling as f64 * power(coordinates[axis], exponent - times)
        });
        coefficient * factors.product::<f64>()
    };
    polynomial.iter().map(term).sum()
}

fn power(base: f64, exponent: usize) -> f64 {
    (0..exponent).fold(1.0, |power, _| power * base)
}
