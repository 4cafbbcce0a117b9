//! Points inside closed surfaces.

use glam::DVec3;
use helfrich::{Images, Surface};
use std::f64::consts::PI;

/// Whether a closed surface winds around a point, by the solid angle of the surface at the point: A. Van
/// Oosterom and J. Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125. Correct to rounding at any distance.
/// Open surfaces enclose nothing.
pub fn encloses(surface: Surface<'_, f64>, point: [f64; 3]) -> bool {
    surface.mesh().is_closed() && winds_around(surface, surface.mesh().triangles().iter(), point)
}

/// Whether closed components with these triangles wind around a point.
pub(crate) fn winds_around<'a>(
    surface: Surface<'_, f64>,
    triangles: impl Iterator<Item = &'a [u32; 3]>,
    point: [f64; 3],
) -> bool {
    let at = DVec3::from(point);
    let place = |vertex: u32| DVec3::from(surface.positions()[vertex as usize]) - at;
    let angle = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(place);
        let [x, y, z] = [a, b, c].map(DVec3::length);
        // a·(b × c) is computed from edges, because from far away the three vectors are nearly parallel.
        let doubled = a.dot((b - a).cross(c - a));
        2.0 * doubled.atan2(x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
    };
    triangles.map(angle).sum::<f64>().abs() > 2.0 * PI
}

/// How often a closed surface winds around a point: the triangles above it that face up, less those that face down. None
/// where, to rounding, the line upwards meets an edge, or the point a triangle.
fn windings(surface: Surface<'_, f64>, at: DVec3) -> Option<i32> {
    // The sign of a sum, if it is certain, with the sum of the absolute values of its terms.
    let sign = |sum: f64, size: f64| match sum.abs() > 16.0 * f64::EPSILON * size {
        true => sum.signum() as i32,
        false => 0,
    };
    let mut windings = 0;
    for triangle in surface.mesh().triangles() {
        let [a, b, c] = triangle.map(|k| DVec3::from(surface.positions()[k as usize]) - at);
        let turns = [(a, b), (b, c), (c, a)].map(|(from, to)| {
            let [left, right] = [from.x * to.y, from.y * to.x];
            sign(left - right, left.abs() + right.abs())
        });
        if turns.contains(&1) && turns.contains(&-1) {
            continue;
        }
        let [p, q] = [b.abs(), c.abs()];
        let size = DVec3::new(
            p.y * q.z + p.z * q.y,
            p.z * q.x + p.x * q.z,
            p.x * q.y + p.y * q.x,
        );
        let height = sign(a.dot(b.cross(c)), a.abs().dot(size));
        if height == 0 || turns.contains(&0) {
            return None;
        }
        windings += if height == turns[0] { height } else { 0 };
    }
    Some(windings)
}

/// Vertices of a surface that are inside another one, or inside an image of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inside {
    /// The first of these vertices.
    pub first: usize,
    /// The number of these vertices.
    pub count: usize,
    /// The shift, in whole periods along each axis, that moves the surface into the other one; zero if
    /// they overlap without a shift.
    pub shift: [f64; 3],
}

impl Inside {
    /// Whether the overlap is with an image.
    pub fn is_by_image(&self) -> bool {
        self.shift != [0.0; 3]
    }
}

/// A surface with its bounding box, which is computed once for many others.
#[derive(Clone, Copy, Debug)]
pub struct Bounded<'a> {
    surface: Surface<'a, f64>,
    low: DVec3,
    high: DVec3,
}

impl<'a> From<Surface<'a, f64>> for Bounded<'a> {
    fn from(surface: Surface<'a, f64>) -> Self {
        let [low, high] = corners_of(surface.positions().iter().copied());
        Self { surface, low, high }
    }
}

impl<'a> Bounded<'a> {
    /// The surface.
    pub fn surface(&self) -> Surface<'a, f64> {
        self.surface
    }

    /// As [`encloses`], without solid angles where something simpler decides.
    fn encloses(&self, point: DVec3) -> bool {
        if !(point.cmpge(self.low).all() && point.cmple(self.high).all()) {
            return false;
        }
        if !self.surface.mesh().is_closed() {
            return false;
        }
        // Whether a plane separates them.
        let outwards = point - (self.low + self.high) / 2.0;
        let positions = self.surface.positions().iter();
        let mut beyond = positions.map(|&vertex| (DVec3::from(vertex) - point).dot(outwards));
        if beyond.all(|distance| distance < 0.0) {
            return false;
        }
        let windings = windings(self.surface, point);
        windings.map_or_else(|| encloses(self.surface, point.into()), |count| count != 0)
    }
}

/// The first vertex of one surface that is inside another, and the number of such vertices; `None` if there
/// is none.
pub fn vertices_inside(inner: Surface<'_, f64>, outer: Surface<'_, f64>) -> Option<(usize, usize)> {
    let found = shifted_inside(inner, &outer.into(), [0.0; 3])?;
    Some((found.first, found.count))
}

/// Vertices of one surface inside another surface and its images in a periodic box, with an entry for
/// each image that contains some.
pub fn inside_of_images(
    inner: &Bounded<'_>,
    outer: &Bounded<'_>,
    images: &Images<f64>,
) -> Vec<Inside> {
    inside_of(inner, outer, images, false)
}

/// As [`inside_of_images`]; without the surface itself, if it is both.
fn inside_of(
    inner: &Bounded<'_>,
    outer: &Bounded<'_>,
    images: &Images<f64>,
    is_itself: bool,
) -> Vec<Inside> {
    let along = |axis: usize| {
        let low = outer.low[axis] - inner.high[axis];
        let high = outer.high[axis] - inner.low[axis];
        let period = images.period(axis).unwrap_or_default();
        let shifts = images.shifts(axis, low, high).into_iter();
        let counts = shifts.flat_map(|[first, last]| first as i64..=last as i64);
        counts.map(move |count| count as f64 * period)
    };
    let plane = along(0).flat_map(|x| along(1).map(move |y| [x, y]));
    let shifts = plane.flat_map(|[x, y]| along(2).map(move |z| [x, y, z]));
    let is_other = |shift: &[f64; 3]| !(is_itself && *shift == [0.0; 3]);
    shifts
        .filter(is_other)
        .filter_map(|shift| shifted_inside(inner.surface, outer, shift))
        .collect()
}

/// Vertices of a surface inside its own images in a periodic box, with an entry for each image that
/// contains some.
pub fn inside_of_own_images(surface: &Bounded<'_>, images: &Images<f64>) -> Vec<Inside> {
    inside_of(surface, surface, images, true)
}

/// Vertices of a surface that are inside another one after a translation by `shift`.
fn shifted_inside(inner: Surface<'_, f64>, outer: &Bounded<'_>, shift: [f64; 3]) -> Option<Inside> {
    let mut inside = (0..inner.positions().len()).filter(|&vertex| {
        outer.encloses(DVec3::from(inner.positions()[vertex]) + DVec3::from(shift))
    });
    let first = inside.next()?;
    Some(Inside {
        first,
        count: 1 + inside.count(),
        shift,
    })
}

/// Opposite corners of the bounding box of some points.
pub(crate) fn corners_of(points: impl IntoIterator<Item = [f64; 3]>) -> [DVec3; 2] {
    let points = points.into_iter().map(DVec3::from);
    let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    points.fold(empty, |[low, high], point| {
        [low.min(point), high.max(point)]
    })
}

/// For each surface, the innermost surface that contains all of it, directly or through an image.
pub fn surroundings(surfaces: &[Surface<'_, f64>], images: &Images<f64>) -> Vec<Option<usize>> {
    let surfaces = Vec::from_iter(surfaces.iter().copied().map(Bounded::from));
    let lies_in = |inner: usize, outer: usize| {
        let all = surfaces[inner].surface.positions().len();
        let is_whole = |inside: &Inside| inside.count == all;
        inner != outer
            && inside_of_images(&surfaces[inner], &surfaces[outer], images)
                .iter()
                .any(is_whole)
    };
    let count = surfaces.len();
    let around = |inner| (0..count).filter(move |&outer| lies_in(inner, outer));
    let around = Vec::from_iter((0..count).map(|inner| Vec::from_iter(around(inner))));
    // The innermost surface lies in all other surrounding ones.
    let innermost = |outer: &Vec<usize>| {
        outer
            .iter()
            .copied()
            .max_by_key(|&outer| around[outer].len())
    };
    around.iter().map(innermost).collect()
}
