//! The surface that a jet describes around its vertex.

use crate::fit::{Inversion, coefficient_count, graph_at};
use crate::lane::Lane;
use crate::real::Real;
use crate::vec3::{Vec3, add, cross, dot, norm, scale, sub};
use core::array::from_fn;

/// Numbers before the coefficients: the first axis, the normal of the frame, 1 over the radius, β of the inversion, and
/// the ratio of spacings.
const HEAD: usize = 9;

/// The fitted polynomial of a vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalPolynomial<'a, T> {
    degree: usize,
    axes: [Vec3<T>; 3],
    over_radius: T,
    inversion: Inversion<T>,
    aspect: T,
    coefficients: &'a [T],
}

/// A point of the surface of a jet.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct JetPoint<T> {
    /// The offset from the vertex.
    pub(crate) offset: Vec3<T>,
    pub(crate) normal: Vec3<T>,
    /// H and K.
    pub(crate) curvatures: [T; 2],
    /// The unit vector of the larger principal curvature; 0 where all directions are principal.
    pub(crate) direction: Vec3<T>,
}

impl<T: Real> JetPoint<T> {
    /// The distance along a direction from a point to the surface, where it passes this point at a small distance: by
    /// the tangent plane and the curvatures here.
    pub(crate) fn height_over(&self, point: Vec3<T>, direction: Vec3<T>) -> T {
        let [mean, gaussian] = self.curvatures;
        let half = (mean * mean - gaussian).max(T::zero()).sqrt();
        let over = dot(direction, self.normal).reciprocal_or_zero();
        let to_plane = dot(sub(self.offset, point), self.normal) * over;
        let beside = add(sub(point, self.offset), scale(to_plane, direction));
        let along = dot(beside, self.direction);
        let two = T::constant(2.0);
        let bend = (mean - half) * dot(beside, beside) + two * half * along * along;
        to_plane - over * bend / two
    }
}

impl<'a, T: Real> LocalPolynomial<'a, T> {
    /// How many numbers are kept of a polynomial.
    pub(crate) const fn numbers(degree: usize) -> usize {
        HEAD + coefficient_count(degree)
    }

    /// The polynomial of these numbers.
    pub(crate) fn new(degree: usize, numbers: &'a [T]) -> Self {
        let [first, normal] = [0, 3].map(|start| from_fn(|axis| numbers[start + axis]));
        Self {
            degree,
            axes: [first, cross(normal, first), normal],
            over_radius: numbers[6],
            inversion: Inversion(numbers[7]),
            aspect: numbers[8],
            coefficients: &numbers[HEAD..],
        }
    }

    /// The degree.
    pub(crate) fn degree(&self) -> usize {
        self.degree
    }

    /// The squared distance of an offset from the vertex by which fits weigh it, in units of the radius.
    pub(crate) fn squared_distance(&self, offset: Vec3<T>) -> T {
        let [along, ..] = self.local(offset);
        let over = self.aspect.reciprocal_or_zero();
        let squared = dot(offset, offset) * (self.over_radius * self.over_radius);
        squared * over + along * along * (self.aspect - over)
    }

    /// The place of the tangent plane to which the inversion maps an offset from the vertex.
    pub(crate) fn place(&self, offset: Vec3<T>) -> [T; 2] {
        let [x, y, _] = self.inversion.image(self.local(offset));
        [x, y]
    }

    fn in_space(&self, [x, y, z]: Vec3<T>) -> Vec3<T> {
        let [first, second, normal] = self.axes;
        add(add(scale(x, first), scale(y, second)), scale(z, normal))
    }

    /// The offset from the vertex of the point with this image under the inversion.
    fn offset(&self, image: Vec3<T>) -> Vec3<T> {
        let Inversion(bend) = self.inversion;
        let radius = self.over_radius.reciprocal_or_zero();
        self.in_space(scale(radius, Inversion(-bend).image(image)))
    }

    fn local(&self, offset: Vec3<T>) -> Vec3<T> {
        self.axes.map(|axis| self.over_radius * dot(offset, axis))
    }

    /// The offset of the point of [`Self::beside`] alone.
    pub(crate) fn offset_beside(&self, offset: Vec3<T>) -> Vec3<T> {
        let [x, y] = self.place(offset);
        let (height, _) = graph_at(self.degree, self.coefficients, x, y);
        self.offset([x, y, height])
    }

    /// The point of the surface that the inversion maps to the same place of the tangent plane as it maps this offset
    /// from the vertex.
    pub(crate) fn beside(&self, offset: Vec3<T>) -> JetPoint<T> {
        let Inversion(bend) = self.inversion;
        let [x, y] = self.place(offset);
        let (height, graph) = graph_at(self.degree, self.coefficients, x, y);
        let image = [x, y, height];
        let back = Inversion(-bend);
        let [mean, gaussian] = self.inversion.curvatures_at(image, &graph);
        // The derivative of the inverse map, in axes of the polynomial.
        let (one, two) = (T::one(), T::constant(2.0));
        let square = dot(image, image);
        let over = back.scale_at(image).reciprocal_or_zero();
        let carried = |tangent: Vec3<T>| -> Vec3<T> {
            let along = two * dot(image, tangent);
            let growth = bend * (two * tangent[2] + bend * along);
            let up = [0, 1, 2].map(|axis| if axis == 2 { bend } else { T::zero() });
            let whole = add(image, scale(square, up));
            let moved = add(tangent, scale(along, up));
            add(scale(over, moved), scale(-over * over * growth, whole))
        };
        let units = [0, 1, 2].map(|k| from_fn(|axis| if axis == k { one } else { T::zero() }));
        let [p, q] = graph.first;
        let [along_x, along_y] = [[one, T::zero(), p], [T::zero(), one, q]].map(carried);
        let unit = |vector: Vec3<T>| scale(norm(vector).reciprocal_or_zero(), vector);
        let [direction, _] = graph.principal(units).directions;
        JetPoint {
            offset: self.offset(image),
            normal: self.in_space(unit(cross(along_x, along_y))),
            curvatures: [
                mean * self.over_radius,
                gaussian * (self.over_radius * self.over_radius),
            ],
            direction: self.in_space(unit(carried(direction))),
        }
    }
}
