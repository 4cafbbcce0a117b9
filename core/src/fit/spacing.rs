//! The spacing of vertices that lie in rows.

use crate::mesh::VertexKind;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, dot, scale, tangent_frame};

/// The largest ratio of spacings that fits take into account.
const MOST_UNEVEN: f64 = 20.0;

/// The largest ratio of one vertex that counts in the mean of its surroundings: that at a pole or a sliver
/// says little.
const MOST_OF_ONE: f64 = 36.0;

/// How neighbours of a vertex are weighed, by their distances squared, `q = |d|²/a + (a − 1/a) (d·e)²`:
/// offsets along rows count a times as much as those across.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spacing<T> {
    /// e, the unit vector along rows; of no importance if a = 1.
    pub(crate) along: Vec3<T>,
    /// a ≥ 1.
    pub(crate) aspect: T,
}

impl<T: Real> Spacing<T> {
    /// Distances in space.
    pub(crate) fn even() -> Self {
        Self {
            along: [T::zero(); 3],
            aspect: T::one(),
        }
    }

    /// q.
    #[inline(always)]
    pub(crate) fn squared(&self, offset: Vec3<T>) -> T {
        let (over, along) = (self.aspect.recip(), dot(offset, self.along));
        dot(offset, offset) * over + along * along * (self.aspect - over)
    }
}

/// The mean over a vertex and its neighbours of the ratio of the spacings across and along rows, and the
/// direction of the rows: of the logarithms of the tensors `Σ e eᵀ` of the edges around each, in the tangent
/// plane.
///
/// V. Arsigny, P. Fillard, X. Pennec and N. Ayache, SIAM J. Matrix Anal. Appl. 29 (2007) 328.
pub(crate) fn spacing<T: Real>(
    surface: Surface<'_, T>,
    normals: &[Vec3<T>],
    vertex: usize,
) -> Spacing<T> {
    let axes = tangent_frame(normals[vertex]);
    let ring = surface.mesh().one_ring(vertex);
    let mut sum = [T::zero(); 2];
    for other in ring.iter().map(|&v| v as usize).chain([vertex]) {
        let frame = tangent_frame(normals[other]);
        let [even, cross] = elongation(surface, frame, other);
        // Components of the tensor in the tangent plane of the vertex.
        let [x, y] = frame.map(|axis| axes.map(|own| dot(own, axis)));
        let part = |k: usize, l: usize| {
            even * (x[k] * x[l] - y[k] * y[l]) + cross * (x[k] * y[l] + y[k] * x[l])
        };
        sum[0] += T::constant(0.5) * (part(0, 0) - part(1, 1));
        sum[1] += part(0, 1);
    }
    let [even, cross] = sum.map(|sum| sum / T::constant(ring.len() as f64 + 1.0));
    let size = (even * even + cross * cross).sqrt();
    if !(size > T::zero() && size.is_finite()) {
        return Spacing::even();
    }
    // The tensor is of the long spacings; rows run along the short ones.
    let angle = T::constant(0.5) * (-cross).atan2(-even);
    let (sine, cosine) = angle.sin_cos();
    Spacing {
        along: add(scale(cosine, axes[0]), scale(sine, axes[1])),
        aspect: size.exp().min(T::constant(MOST_UNEVEN)),
    }
}

/// The logarithm of the tensor of the edges around a vertex, traceless: its components xx and xy.
fn elongation<T: Real>(surface: Surface<'_, T>, frame: [Vec3<T>; 2], vertex: usize) -> [T; 2] {
    let mesh = surface.mesh();
    let ring = mesh.one_ring(vertex);
    let mut sums = [T::zero(); 3];
    let mut add = |edge: Vec3<T>, factor: f64| {
        let [x, y] = frame.map(|axis| dot(edge, axis));
        for (sum, square) in sums.iter_mut().zip([x * x, x * y, y * y]) {
            *sum += T::constant(factor) * square;
        }
    };
    let rims = match mesh.vertex_kind(vertex) {
        VertexKind::Interior => ring.len(),
        _ => ring.len().saturating_sub(1),
    };
    for (place, &other) in ring.iter().enumerate() {
        let is_end = rims < ring.len() && (place == 0 || place == rims);
        let spoke = surface.difference(vertex as u32, other);
        add(spoke, if is_end { 0.5 } else { 1.0 });
        if place < rims {
            let next = ring[(place + 1) % ring.len()];
            add(surface.difference(other, next), 1.0);
        }
    }
    let [xx, xy, yy] = sums;
    let half = T::constant(0.5);
    let (middle, off) = (half * (xx + yy), half * (xx - yy));
    let apart = (off * off + xy * xy).sqrt();
    if apart <= T::zero() {
        return [T::zero(); 2];
    }
    let most = T::constant(MOST_OF_ONE).ln();
    // The determinant, not the small eigenvalue, which may cancel: the product of both.
    let smaller = ((xx * yy - xy * xy) / (middle + apart)).max(T::zero());
    let ratio = half * ((middle + apart) / smaller).ln();
    let size = if ratio < most { ratio } else { most } / apart;
    [size * off, size * xy]
}
