//! Curvatures of the graph of a height function z(x, y) from its derivatives.
//!
//! M. P. do Carmo, Differential Geometry of Curves and Surfaces, section 3.3; here with the sign that
//! makes H positive on the upper half of a sphere.

mod tangents;

use super::moments::place_of;
use crate::lane::Lane;

/// First and second derivatives of a height function at a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Graph<L> {
    /// z_x and z_y.
    pub(crate) first: [L; 2],
    /// z_xx, z_xy and z_yy.
    pub(crate) second: [L; 3],
}

impl<L: Lane> Graph<L> {
    /// The graph at the origin, from the coefficients of x, y, x², xy, y².
    #[inline(always)]
    pub(crate) fn of_coefficients(coefficients: &[L]) -> Self {
        let two = L::literal(2.0);
        Self {
            first: [coefficients[0], coefficients[1]],
            second: [
                two * coefficients[2],
                coefficients[3],
                two * coefficients[4],
            ],
        }
    }

    /// The graph at the origin, from coefficients for coordinates and heights in units of a radius;
    /// `over_radius` is 1 over the radius.
    #[inline(always)]
    pub(crate) fn in_radii(coefficients: &[L], over_radius: L) -> Self {
        Self::of_coefficients(coefficients).enlarged(over_radius)
    }

    /// This graph enlarged by a factor, of which `over_factor` is the reciprocal: slopes stay, second derivatives are
    /// multiplied by it.
    #[inline(always)]
    pub(crate) fn enlarged(self, over_factor: L) -> Self {
        Self {
            second: self.second.map(|entry| entry * over_factor),
            ..self
        }
    }

    /// The normal's component along the axis of heights, 1/√(1 + z_x² + z_y²).
    #[inline(always)]
    pub(crate) fn uprightness(&self) -> L {
        let [p, q] = self.first;
        (L::literal(1.0) + p * p + q * q)
            .sqrt()
            .reciprocal_or_zero()
    }

    /// H.
    #[inline(always)]
    pub(crate) fn mean(&self, uprightness: L) -> L {
        let [p, q] = self.first;
        let [xx, xy, yy] = self.second;
        let (one, two) = (L::literal(1.0), L::literal(2.0));
        let bend = (one + q * q) * xx - two * p * q * xy + (one + p * p) * yy;
        L::literal(-0.5) * bend * (uprightness * uprightness * uprightness)
    }

    /// The curvature of the normal section along y.
    #[inline(always)]
    pub(crate) fn along_y(&self, uprightness: L) -> L {
        let ([_, q], [.., yy]) = (self.first, self.second);
        let over = (L::literal(1.0) + q * q).reciprocal_or_zero();
        -(yy * uprightness * over)
    }

    /// K.
    #[inline(always)]
    pub(crate) fn gaussian(&self, uprightness: L) -> L {
        let [xx, xy, yy] = self.second;
        let squared = uprightness * uprightness;
        (xx * yy - xy * xy) * (squared * squared)
    }

    /// H and K.
    #[inline(always)]
    pub(crate) fn curvatures(&self) -> [L; 2] {
        let uprightness = self.uprightness();
        [self.mean(uprightness), self.gaussian(uprightness)]
    }

    /// Factors: the coefficients of x, y, x², xy, y² of a field φ times these add up to
    /// `Δ_S φ = g^{ab} φ_ab + 2H z_c φ_c/√g`.
    #[inline(always)]
    pub(crate) fn laplacian(&self, uprightness: L) -> [L; 5] {
        let [p, q] = self.first;
        let (one, two) = (L::literal(1.0), L::literal(2.0));
        let along = two * self.mean(uprightness) * uprightness;
        let squared = uprightness * uprightness;
        [
            along * p,
            along * q,
            two * (one - p * p * squared),
            -two * p * q * squared,
            two * (one - q * q * squared),
        ]
    }
}

/// The height of a polynomial without constant term at a point, and its graph there.
#[inline(always)]
pub(crate) fn graph_at<L: Lane>(degree: usize, coefficients: &[L], x: L, y: L) -> (L, Graph<L>) {
    // Horner's rule for z, z_x, z_y, z_xy, and half of z_xx and z_yy.
    let [mut z, mut zx, mut zy, mut zxx, mut zxy, mut zyy] = [L::zero(); 6];
    for a in (0..=degree).rev() {
        let [mut part, mut slope, mut bend] = [L::zero(); 3];
        for b in (0..=degree - a).rev() {
            let place = place_of(a + b, b);
            let coefficient = if place > 0 {
                coefficients[place - 1]
            } else {
                L::zero()
            };
            bend = bend * y + slope;
            slope = slope * y + part;
            part = part * y + coefficient;
        }
        zxx = zxx * x + zx;
        zxy = zxy * x + zy;
        zyy = zyy * x + bend;
        zx = zx * x + z;
        zy = zy * x + slope;
        z = z * x + part;
    }
    let graph = Graph {
        first: [zx, zy],
        second: [zxx + zxx, zxy, zyy + zyy],
    };
    (z, graph)
}

/// A power series in two variables up to degree 2: coefficients of 1, x, y, x², xy, y².
type Series<L> = [L; 6];

#[inline(always)]
fn product<L: Lane>(a: Series<L>, b: Series<L>) -> Series<L> {
    [
        a[0] * b[0],
        a[0] * b[1] + a[1] * b[0],
        a[0] * b[2] + a[2] * b[0],
        a[0] * b[3] + a[1] * b[1] + a[3] * b[0],
        a[0] * b[4] + a[1] * b[2] + a[2] * b[1] + a[4] * b[0],
        a[0] * b[5] + a[2] * b[2] + a[5] * b[0],
    ]
}

/// The result of [`bending`].
pub(crate) struct Bending<L> {
    /// H_x and H_y.
    pub(crate) of_mean: [L; 2],
    /// K_x and K_y.
    pub(crate) of_gaussian: [L; 2],
    /// Derivatives of 1/√(1 + z_x² + z_y²).
    pub(crate) of_uprightness: [L; 2],
    /// Δ_S H.
    pub(crate) laplacian_of_mean: L,
}

/// Derivatives of H and K at the origin of a polynomial height function. Coefficients above degree 4 are not read; missing ones count as 0.
#[inline(always)]
pub(crate) fn bending<L: Lane>(coefficients: &[L]) -> Bending<L> {
    // The derivative of these orders by x and y, as a series up to degree 2.
    let derivative = |by_x: usize, by_y: usize| -> Series<L> {
        core::array::from_fn(|place| {
            let (x, y) = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)][place];
            let (x, y) = (x + by_x, y + by_y);
            let falling =
                |power: usize, times: usize| (power - times + 1..=power).product::<usize>();
            let factor = falling(x, by_x) * falling(y, by_y);
            match coefficients.get(place_of(x + y, y) - 1) {
                Some(&coefficient) => L::literal(factor as f64) * coefficient,
                None => L::zero(),
            }
        })
    };
    let (p, q) = (derivative(1, 0), derivative(0, 1));
    let (xx, xy, yy) = (derivative(2, 0), derivative(1, 1), derivative(0, 2));
    let (mut with_p, mut with_q, across) = (product(p, p), product(q, q), product(p, q));
    let graph = Graph {
        first: [p[0], q[0]],
        second: [xx[0], xy[0], yy[0]],
    };
    let uprightness = graph.uprightness();
    let squared = uprightness * uprightness;
    let mut growth: Series<L> = core::array::from_fn(|k| (with_p[k] + with_q[k]) * squared);
    growth[0] = L::zero();
    let square = product(growth, growth);
    // (1 + z_x² + z_y²)^(−3/2), relative to its value at the origin.
    let mut power: Series<L> =
        core::array::from_fn(|k| L::literal(1.875) * square[k] - L::literal(1.5) * growth[k]);
    power[0] = L::literal(1.0);
    with_p[0] = with_p[0] + L::literal(1.0);
    with_q[0] = with_q[0] + L::literal(1.0);
    let (first, second, third) = (
        product(with_q, xx),
        product(across, xy),
        product(with_p, yy),
    );
    let bend = core::array::from_fn(|k| first[k] - L::literal(2.0) * second[k] + third[k]);
    let mean = product(bend, power).map(|k| L::literal(-0.5) * k * (uprightness * squared));
    let functional = graph.laplacian(uprightness);
    let mut sum = L::zero();
    for (&factor, &coefficient) in functional.iter().zip(&mean[1..]) {
        sum = sum + factor * coefficient;
    }
    let (two, fourth) = (L::literal(2.0), squared * squared);
    let determinant = xx[0] * yy[0] - xy[0] * xy[0];
    let of_gaussian = [1, 2].map(|k| {
        let of_determinant = xx[k] * yy[0] + xx[0] * yy[k] - two * xy[0] * xy[k];
        (of_determinant - two * determinant * growth[k]) * fourth
    });
    Bending {
        of_mean: [mean[1], mean[2]],
        of_gaussian,
        of_uprightness: [1, 2].map(|k| L::literal(-0.5) * growth[k] * uprightness),
        laplacian_of_mean: sum,
    }
}

/// f/κ = 2[Δ_S H + 2H(H² − K)] at the origin of a polynomial height function.
#[inline(always)]
pub(crate) fn force_density<L: Lane>(coefficients: &[L]) -> L {
    let [mean, gaussian] = Graph::of_coefficients(coefficients).curvatures();
    let two = L::literal(2.0);
    two * (bending(coefficients).laplacian_of_mean + two * mean * (mean * mean - gaussian))
}
