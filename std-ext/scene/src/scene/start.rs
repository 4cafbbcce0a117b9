//! Initial shapes for targets.

use super::effects::reduced_volume;
use super::{MeshSource, SurfaceScene, VolumeTarget};
use crate::generate::AnyShape;
use helfrich::shapes::Ellipsoid;

/// Semi-axes of a prolate, for spheres, which have no direction of their own.
const PROLATE: [f64; 3] = [1.0, 1.0, 2.0];

/// The ellipsoid of `start_for` for the reduced volume that a surface is to have.
pub fn start_shape(surface: &SurfaceScene, near: f64) -> Option<AnyShape> {
    match surface.effects.volume?.target {
        VolumeTarget::Reduced(target) => start_for(&surface.source, target, near),
        _ => None,
    }
}

/// The ellipsoid with a reduced volume and the area of a shape, a sphere or an ellipsoid. It is oblate or
/// prolate like that ellipsoid; for a sphere it is prolate. `None` if the reduced volume of an
/// ellipsoid differs from the target by a smaller fraction than `near`.
pub(super) fn start_for(source: &MeshSource, target: f64, near: f64) -> Option<AnyShape> {
    let MeshSource::Shape { shape, .. } = source else {
        return None;
    };
    let near = match shape {
        AnyShape::Sphere(_) => 0.0,
        _ => near,
    };
    let axes = match shape {
        AnyShape::Ellipsoid(ellipsoid) => ellipsoid.semi_axes,
        AnyShape::Sphere(_) => PROLATE,
        _ => return None,
    };
    let stretched = |power: f64| {
        let semi_axes = axes.map(|axis| axis.powf(power));
        AnyShape::Ellipsoid(Ellipsoid { semi_axes })
    };
    let reduced = |shape: &AnyShape| reduced_volume(shape.volume(), shape.area());
    if (reduced(shape) / target - 1.0).abs() < near {
        return None;
    }
    // Bounds: a sphere, and an ellipsoid whose longest axis is thirty times the shortest.
    let [least, most] = axes
        .iter()
        .fold([f64::INFINITY, 0.0], |[least, most], &axis| {
            [axis.min(least), axis.max(most)]
        });
    let mut range = [0.0, 30f64.ln() / (most / least).ln()];
    if !(range[1].is_finite() && reduced(&stretched(range[1])) < target && target < 1.0) {
        return None;
    }
    for _ in 0..60 {
        let middle = 0.5 * (range[0] + range[1]);
        let end = usize::from(reduced(&stretched(middle)) <= target);
        range[end] = middle;
    }
    let AnyShape::Ellipsoid(found) = stretched(range[0]) else {
        return None;
    };
    let scale = (shape.area() / AnyShape::Ellipsoid(found).area()).sqrt();
    let four_digits = |axis: f64| format!("{:.3e}", scale * axis).parse().ok();
    let [a, b, c] = found.semi_axes.map(four_digits);
    let semi_axes = [a?, b?, c?];
    Some(AnyShape::Ellipsoid(Ellipsoid { semi_axes }))
}
