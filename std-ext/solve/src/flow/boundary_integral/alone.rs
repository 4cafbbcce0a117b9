//! Kernels and exact integrals as separate functions, for checks in twice the precision.

use super::kernel::{Gradient, Kernel, Stokeslet, Stresslet, StressletPressure, source};
use super::panel::Panel;
use glam::DVec3;

/// `f/r + r (r·f)/r³` at a point, r from there to x.
pub fn stokeslet(at: [f64; 3], [x, f]: [[f64; 3]; 2]) -> [f64; 3] {
    Stokeslet.one(at, &source(&[x.into(), f.into()]))
}

/// `r·f/r³`.
pub fn gradient(at: [f64; 3], [x, f]: [[f64; 3]; 2]) -> [f64; 1] {
    Gradient.one(at, &source(&[x.into(), f.into()]))
}

/// `r (r·n)(r·u)/r⁵`, the velocity at the point being 0.
pub fn stresslet(at: [f64; 3], [x, n, u]: [[f64; 3]; 3]) -> [f64; 3] {
    let target = source(&[at.into(), DVec3::ZERO]);
    Stresslet.one(target, &source(&[x.into(), n.into(), u.into()]))
}

/// `3 (r·n)(r·u)/r⁵ − n·u/r³`.
pub fn stresslet_pressure(at: [f64; 3], [x, n, u]: [[f64; 3]; 3]) -> [f64; 1] {
    StressletPressure.one(at, &source(&[x.into(), n.into(), u.into()]))
}

/// The solid angle under which a triangle is seen.
pub fn solid_angle(at: [f64; 3], corners: [[f64; 3]; 3]) -> f64 {
    Panel::new([0, 1, 2], &corners.map(DVec3::from)).solid_angle(at.into())
}

/// The Stokeslets of a triangle, linear tractions on it, at its first corner.
pub fn stokeslets_about_corner(corners: [[f64; 3]; 3], tractions: [[f64; 3]; 3]) -> [f64; 3] {
    let corners = corners.map(DVec3::from);
    let panel = Panel::new([0, 1, 2], &corners);
    panel
        .stokeslets_about_corner(tractions.map(DVec3::from))
        .to_array()
}
