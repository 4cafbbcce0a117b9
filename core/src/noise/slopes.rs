//! Curvatures of a height function from its derivatives, and their dependence on its coefficients.

use crate::real::Real;
use crate::vec3::{Vec3, add, normalise, scale, sub};
use core::array::from_fn;

/// Derivatives of a height function.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slopes<T> {
    /// z_x and z_y.
    first: [T; 2],
    /// z_xx, z_xy and z_yy.
    second: [T; 3],
}

impl<T: Real> Slopes<T> {
    /// From the coefficients of x, y, x², xy, y², in radii.
    pub(super) fn new(coefficients: &[T], radius: T) -> Self {
        let two = T::constant(2.0);
        let factors = [two, T::one(), two];
        Self {
            first: [coefficients[0], coefficients[1]],
            second: from_fn(|k| factors[k] * coefficients[2 + k] / radius),
        }
    }

    /// From z_x and z_y; z_xx, z_xy and z_yy.
    pub(super) fn of_derivatives(first: [T; 2], second: [T; 3]) -> Self {
        Self { first, second }
    }

    /// 1 + z_x² + z_y².
    fn metric(&self) -> T {
        let [p, q] = self.first;
        T::one() + p * p + q * q
    }

    /// Trace of second derivatives with the inverse of the metric, times [`Self::metric`].
    fn trace(&self) -> [T; 3] {
        let [p, q] = self.first;
        let two = T::constant(2.0);
        [T::one() + q * q, -two * p * q, T::one() + p * p]
    }

    /// H and K.
    pub(super) fn curvatures(&self) -> [T; 2] {
        let [r, s, t] = self.second;
        let [along_r, along_s, along_t] = self.trace();
        let square = self.metric();
        let twice = (along_r * r + along_s * s + along_t * t) / (square * square.sqrt());
        let gaussian = (r * t - s * s) / (square * square);
        [-T::constant(0.5) * twice, gaussian]
    }

    /// The Laplace–Beltrami operator as factors of a field's coefficients:
    /// `g^{ab} φ_ab + 2H z_c φ_c/√g`, heights above the surface counted along its normal.
    pub(super) fn laplacian(&self, radius: T) -> [T; 6] {
        let [mean, _] = self.curvatures();
        let two = T::constant(2.0);
        let over = (self.metric() * radius * radius).recip();
        let [along_r, along_s, along_t] = self.trace().map(|factor| factor * over);
        let along = two * mean / (self.metric().sqrt() * radius);
        let [p, q] = self.first.map(|slope| slope * along);
        [T::zero(), p, q, two * along_r, along_s, two * along_t]
    }

    /// The derivatives of H and K with respect to the coefficients of 1, x, y, x², xy, y² of the
    /// height, as factors of the coefficients of a field of heights in radii.
    pub(super) fn variations(&self, radius: T) -> [[T; 6]; 2] {
        let two = T::constant(2.0);
        let [p, q] = self.first;
        let [r, s, t] = self.second;
        let [mean, gaussian] = self.curvatures();
        let square = self.metric();
        let cube = square * square.sqrt();
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
        let half = T::constant(-0.5) / cube;
        let steeper = T::constant(3.0) * mean / square;
        let of_mean = of_second(
            self.trace().map(|factor| factor * half),
            [
                (q * s - p * t) / cube - steeper * p,
                (p * s - q * r) / cube - steeper * q,
            ],
        );
        let fourth = (square * square).recip();
        let flatter = T::constant(-4.0) * gaussian / square;
        let of_gaussian = of_second(
            [t * fourth, -two * s * fourth, r * fourth],
            [flatter * p, flatter * q],
        );
        [of_mean, of_gaussian]
    }

    /// The principal frame of the surface: the shape operator by the height's derivatives, in a frame of
    /// two tangent vectors of unit length. `axes` are the unit vectors along x, y and the height.
    pub(super) fn principal(&self, axes: [Vec3<T>; 3]) -> PrincipalFrame<T> {
        let [p, q] = self.first;
        let [along_x, along_y, up] = axes;
        // The Cholesky factor of the metric, and its inverse.
        let length = (T::one() + p * p).sqrt();
        let shared = p * q / length;
        let rest = (T::one() + q * q - shared * shared).sqrt();
        let inverse = [length.recip(), -shared / (length * rest), rest.recip()];
        let over = -self.metric().sqrt().recip();
        let in_frame = |[xx, xy, yy]: [T; 3]| {
            let [xx, xy, yy] = [over * xx, over * xy, over * yy];
            let [a, b, c] = inverse;
            let across = b * xx + c * xy;
            [a * a * xx, a * across, b * across + c * (b * xy + c * yy)]
        };
        let [first, shear, second] = in_frame(self.second);
        let two = T::constant(2.0);
        let angle = T::constant(0.5) * (two * shear).atan2(first - second);
        let (sine, cosine) = angle.sin_cos();
        let [a, b, c] = inverse;
        let x = add(along_x, scale(p, up));
        let y = add(along_y, scale(q, up));
        let vectors = [scale(a, x), add(scale(b, x), scale(c, y))];
        let turned =
            |cosine: T, sine: T| normalise(add(scale(cosine, vectors[0]), scale(sine, vectors[1])));
        // Dependence of the off-diagonal entry, in the principal frame, on the second derivatives.
        let by_second = [0, 1, 2].map(|place| {
            let mut unit = [T::zero(); 3];
            unit[place] = T::one();
            let [first, shear, second] = in_frame(unit);
            (second - first) * cosine * sine + shear * (cosine * cosine - sine * sine)
        });
        PrincipalFrame {
            directions: [turned(cosine, sine), turned(-sine, cosine)],
            by_second,
        }
    }

    /// The factors of the derivatives φ_x and φ_y in the gradient of a field: two tangent vectors.
    pub(super) fn gradient(&self, axes: [Vec3<T>; 3]) -> [Vec3<T>; 2] {
        let [p, q] = self.first;
        let [along_x, along_y, up] = axes;
        let x = add(along_x, scale(p, up));
        let y = add(along_y, scale(q, up));
        let over = self.metric().recip();
        let [xx, xy, yy] = [
            over * (T::one() + q * q),
            -over * p * q,
            over * (T::one() + p * p),
        ];
        [
            add(scale(xx, x), scale(xy, y)),
            add(scale(xy, x), scale(yy, y)),
        ]
    }

    /// Outward unit normal, for axes along x, y and the height.
    pub(super) fn normal(&self, [along_x, along_y, up]: [Vec3<T>; 3]) -> Vec3<T> {
        let [p, q] = self.first;
        normalise(sub(sub(up, scale(p, along_x)), scale(q, along_y)))
    }
}

/// The directions of principal curvatures.
pub(super) struct PrincipalFrame<T> {
    /// Tangent unit vectors, of the larger and the smaller curvature.
    pub(super) directions: [Vec3<T>; 2],
    /// Derivatives of the off-diagonal entry of the shape operator with respect to z_xx, z_xy and z_yy.
    pub(super) by_second: [T; 3],
}
