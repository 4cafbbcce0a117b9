//! Star-shaped surfaces with exact curvatures: all derivatives that a bending force needs, by truncated
//! Taylor series.

use core::array::from_fn;
use core::ops::{Add, Mul, Sub};
use helfrich::shapes::ExactPoint;

/// Degree up to which series are kept, because f needs fourth derivatives of the positions.
const DEGREE: usize = 4;

/// Coefficients of a series in two variables.
const COUNT: usize = (DEGREE + 1) * (DEGREE + 2) / 2;

/// A power series in u and v: coefficients of u^(d − e) v^e by rising d, then e.
#[derive(Clone, Copy, Debug)]
struct Series([f64; COUNT]);

fn place(u: usize, v: usize) -> usize {
    (u + v) * (u + v + 1) / 2 + v
}

/// The exponents of u and v in the order of the coefficients.
fn exponents() -> impl Iterator<Item = (usize, usize)> {
    (0..=DEGREE).flat_map(|degree| (0..=degree).map(move |v| (degree - v, v)))
}

impl Series {
    fn constant(value: f64) -> Self {
        Self(from_fn(|k| if k == 0 { value } else { 0.0 }))
    }

    /// `value + du u + dv v`.
    fn linear(value: f64, du: f64, dv: f64) -> Self {
        let mut series = Self::constant(value);
        (series.0[1], series.0[2]) = (du, dv);
        series
    }

    /// 1/self, by Newton's iteration, which doubles the known degrees.
    fn recip(self) -> Self {
        let mut inverse = Self::constant(self.0[0].recip());
        for _ in 0..3 {
            inverse = inverse * (Self::constant(2.0) - self * inverse);
        }
        inverse
    }

    /// The square root, by Newton's iteration, which also doubles the known degrees.
    fn sqrt(self) -> Self {
        let mut root = Self::constant(self.0[0].sqrt());
        for _ in 0..3 {
            root = (root + self * root.recip()) * Self::constant(0.5);
        }
        root
    }

    /// Derivatives with respect to u and v. They are known to one degree less.
    fn derivatives(self) -> [Self; 2] {
        let mut derivatives = [Self::constant(0.0); 2];
        for (u, v) in exponents() {
            let coefficient = self.0[place(u, v)];
            if u > 0 {
                derivatives[0].0[place(u - 1, v)] = u as f64 * coefficient;
            }
            if v > 0 {
                derivatives[1].0[place(u, v - 1)] = v as f64 * coefficient;
            }
        }
        derivatives
    }
}

impl Add for Series {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(from_fn(|k| self.0[k] + other.0[k]))
    }
}

impl Sub for Series {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(from_fn(|k| self.0[k] - other.0[k]))
    }
}

impl Mul for Series {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let mut product = Self::constant(0.0);
        for (u, v) in exponents() {
            for (other_u, other_v) in exponents() {
                if u + v + other_u + other_v <= DEGREE {
                    product.0[place(u + other_u, v + other_v)] +=
                        self.0[place(u, v)] * other.0[place(other_u, other_v)];
                }
            }
        }
        product
    }
}

fn dot(a: [Series; 3], b: [Series; 3]) -> Series {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [Series; 3], b: [Series; 3]) -> [Series; 3] {
    from_fn(|k| {
        let (l, m) = ((k + 1) % 3, (k + 2) % 3);
        a[l] * b[m] - a[m] * b[l]
    })
}

/// The surface r(p) p over the unit sphere, r = 1 + Σ a P_l(d·p) with Legendre polynomials P_l: sums of
/// spherical harmonics.
#[derive(Clone, Debug)]
pub struct Star {
    /// The amplitude a, degree l and unit vector d of each term. r has to be above 0.
    pub terms: Vec<(f64, usize, [f64; 3])>,
}

impl Star {
    /// r(p) of a series of unit vectors.
    fn radius(&self, p: [Series; 3]) -> Series {
        let mut radius = Series::constant(1.0);
        for &(amplitude, degree, direction) in &self.terms {
            let x = dot(p, direction.map(Series::constant));
            // (l + 1) P_(l+1) = (2l + 1) x P_l − l P_(l−1)
            let (mut before, mut legendre) = (Series::constant(0.0), Series::constant(1.0));
            for l in 0..degree {
                let l = l as f64;
                let ahead = x * legendre * Series::constant((2.0 * l + 1.0) / (l + 1.0));
                let next = ahead - before * Series::constant(l / (l + 1.0));
                (before, legendre) = (legendre, next);
            }
            radius = radius + legendre * Series::constant(amplitude);
        }
        radius
    }

    /// The exact surface at a unit vector.
    pub fn at(&self, preimage: [f64; 3]) -> ExactPoint<f64> {
        over_sphere(preimage, |p| self.radius(p))
    }
}

/// The surface r(p) p at a unit vector p.
fn over_sphere(preimage: [f64; 3], radius: impl Fn([Series; 3]) -> Series) -> ExactPoint<f64> {
    // Two tangents perpendicular to p; the result does not depend on their choice.
    let least = (0..3).min_by(|&a, &b| preimage[a].abs().total_cmp(&preimage[b].abs()));
    let axis: [f64; 3] = from_fn(|k| f64::from(u8::from(Some(k) == least)));
    let [x, y, z] = preimage;
    let first = [
        y * axis[2] - z * axis[1],
        z * axis[0] - x * axis[2],
        x * axis[1] - y * axis[0],
    ];
    let second = [
        y * first[2] - z * first[1],
        z * first[0] - x * first[2],
        x * first[1] - y * first[0],
    ];
    let ahead: [Series; 3] = from_fn(|k| Series::linear(preimage[k], first[k], second[k]));
    let over = dot(ahead, ahead).sqrt().recip();
    let unit = ahead.map(|part| part * over);
    let length = radius(unit);
    let position = unit.map(|part| part * length);

    let by_each = position.map(Series::derivatives);
    let [along_u, along_v] = [0, 1].map(|by| by_each.map(|derivatives| derivatives[by]));
    let area_vector = cross(along_u, along_v);
    let area = dot(area_vector, area_vector).sqrt();
    let over_area = area.recip();
    let normal = area_vector.map(|part| part * over_area);
    let [e, f, g] = [
        dot(along_u, along_u),
        dot(along_u, along_v),
        dot(along_v, along_v),
    ];
    let [uu, uv] = [0, 1].map(|by| along_u.map(|part| part.derivatives()[by]));
    let vv = along_v.map(|part| part.derivatives()[1]);
    let [l, m, n] = [uu, uv, vv].map(|second| dot(second, normal));
    let over_square = over_area * over_area;
    let two = Series::constant(2.0);
    // Positive on a sphere with outward normals.
    let mean = (two * f * m - e * n - g * l) * over_square * Series::constant(0.5);
    let gaussian = (l * n - m * m) * over_square;
    let [by_u, by_v] = mean.derivatives();
    let flux = [
        (g * by_u - f * by_v) * over_area,
        (e * by_v - f * by_u) * over_area,
    ];
    let laplacian = (flux[0].derivatives()[0] + flux[1].derivatives()[1]) * over_area;
    let outward: f64 = (0..3).map(|k| normal[k].0[0] * preimage[k]).sum();
    assert!(outward > 0.0, "the axes are right-handed");
    ExactPoint {
        position: position.map(|part| part.0[0]),
        normal: normal.map(|part| part.0[0]),
        mean: mean.0[0],
        gaussian: gaussian.0[0],
        laplacian_of_mean: laplacian.0[0],
    }
}

#[cfg(test)]
mod tests {
    use super::{Series, over_sphere};
    use approx::assert_relative_eq;
    use helfrich::shapes::{Ellipsoid, Shape};

    /// The series agree with the core's exact formulas for the ellipsoid, the star r = (Σ pᵢ²/aᵢ²)^(−1/2).
    #[test]
    fn series_give_the_ellipsoid() {
        let axes: [f64; 3] = [1.0, 0.8, 0.5];
        let ellipsoid = Ellipsoid::new(axes).expect("axes");
        for direction in [[0.6, 0.0, 0.8], [0.36, 0.48, 0.8], [-0.48, 0.8, -0.36]] {
            let found = over_sphere(direction, |p| {
                let parts = [0, 1, 2].map(|k| p[k] * Series::constant(axes[k].recip()));
                super::dot(parts, parts).sqrt().recip()
            });
            let exact = ellipsoid.at(ellipsoid.preimage(found.position));
            assert_relative_eq!(found.mean, exact.mean, max_relative = 1e-12);
            assert_relative_eq!(found.gaussian, exact.gaussian, max_relative = 1e-12);
            let [found, exact] = [found, exact].map(|point| point.laplacian_of_mean);
            assert_relative_eq!(found, exact, max_relative = 1e-10);
        }
    }
}
