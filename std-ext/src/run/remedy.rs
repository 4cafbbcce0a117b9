//! Remedies for relaxations that did not reach an equilibrium.

use crate::generate::{AnyShape, Family};
use crate::method::BendingMethod;
use crate::scene::{MeshSource, SurfaceScene, VolumeTarget};
use helfrich::shapes::Ellipsoid;
use std::f64::consts::PI;

/// Vertices that resolve vesicles of reduced volume down to 0.6, in each family.
const RESOLVED: usize = 2562;

/// Largest relative difference of the initial reduced volume from the target: a mesh that is generated
/// for one shape and stretched to another is too coarse where it is stretched.
const NEAR: f64 = 0.05;

/// The remedy for a mesh that becomes bad in a relaxation, or that does not resolve the shape: method S
/// on an even mesh of nearly the requested shape. With this remedy, vesicles of reduced volume down to
/// 0.6 reach the energies of theory.
///
/// Line tension pulls the vertices of an edge together, and no mesh resolves an edge that has closed.
pub(super) fn remedy(surface: &SurfaceScene) -> String {
    if surface.effects.line_tension.is_some() {
        return "an edge may have closed under `line_tension`, and triangles on its two sides cannot be \
         joined: choose a smaller one, or continue with a closed mesh"
            .to_owned();
    }
    let is_loop = surface
        .effects
        .bending
        .as_ref()
        .is_some_and(|bending| bending.method == BendingMethod::Loop);
    let MeshSource::Shape {
        shape,
        family,
        vertices,
        ..
    } = &surface.source
    else {
        let method = match is_loop {
            true => "",
            false => "the bending method \"loop\" and ",
        };
        return format!("choose {method}a mesh of more and more even triangles");
    };
    let needed = regular_count(*vertices);
    let mut remedy = if is_loop && *family == Family::Relaxed {
        String::new()
    } else {
        "choose the bending method \"loop\" on a mesh of the family \"relaxed\"".to_owned()
    };
    if needed > *vertices {
        let of = match remedy.is_empty() {
            true => "choose a mesh of",
            false => " with",
        };
        remedy.push_str(&format!("{of} {needed} vertices"));
    }
    if let Some(start) = start(surface, shape) {
        let begin = match remedy.is_empty() {
            true => "begin with",
            false => ", beginning with",
        };
        remedy.push_str(&format!("{begin} shape = \"{start}\""));
    }
    if remedy.is_empty() {
        remedy = format!("choose a mesh of {} vertices", 4 * vertices - 6);
    }
    remedy
}

/// The number of vertices of a refined icosahedron that resolves the shape, and is not below the
/// present number.
fn regular_count(vertices: usize) -> usize {
    let mut count = RESOLVED;
    while count < vertices {
        count = 4 * count - 6;
    }
    count
}

/// The ellipsoid with the requested reduced volume and the same area. It is oblate or prolate like the
/// given one, whose reduced volume differs too much.
fn start(surface: &SurfaceScene, shape: &AnyShape) -> Option<AnyShape> {
    let VolumeTarget::Reduced(target) = surface.effects.volume?.target else {
        return None;
    };
    let AnyShape::Ellipsoid(ellipsoid) = shape else {
        return None;
    };
    let stretched = |power: f64| {
        let semi_axes = ellipsoid.semi_axes.map(|axis| axis.powf(power));
        AnyShape::Ellipsoid(Ellipsoid { semi_axes })
    };
    let reduced = |shape: &AnyShape| 6.0 * PI.sqrt() * shape.volume() / shape.area().powf(1.5);
    if (reduced(shape) / target - 1.0).abs() < NEAR {
        return None;
    }
    // Bounds: a sphere, and an ellipsoid whose longest axis is thirty times the shortest.
    let [least, most] = ellipsoid
        .semi_axes
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

/// Remedy for surfaces whose relaxation does not converge.
pub(super) fn advice(surfaces: &[SurfaceScene]) -> String {
    let without_energy = surfaces.iter().find_map(without_energy);
    let bent = |surface: &&SurfaceScene| surface.effects.bending.is_some();
    let remedy = || {
        surfaces
            .iter()
            .find(bent)
            .map(|surface| format!(": {}", remedy(surface)))
    };
    without_energy.or_else(remedy).unwrap_or_else(|| {
        "; the remaining force may be rounding error of the energy: choose a larger `driver.residual`"
            .to_owned()
    })
}

/// Remedy for a surface whose bending method has forces but no energy.
fn without_energy(surface: &SurfaceScene) -> Option<String> {
    let method = surface.effects.bending.as_ref()?.method;
    if method.is_conservative() {
        return None;
    }
    let family = match surface.source {
        MeshSource::Shape { family, .. } if family != Family::Relaxed => format!(
            "on flat shapes that the mesh resolves family = \"{}\" instead of \"{family}\" leads there, \
             and everywhere ",
            Family::Relaxed
        ),
        _ => String::new(),
    };
    Some(format!(
        "; the forces of {}, by which \"{}\" bends, have no energy, and may lead to no equilibrium: \
         {family}a method with an energy, as B, S or juelicher, goes down to one",
        method.name(),
        surface.name
    ))
}
