//! Dimensionless groups.

use super::super::build::reduced_volume;
use super::super::{
    AreaDifferenceTarget, Bending, Driver, Flow, Hold, InPlaneLaw, MeshSource, ReferenceSource,
    Stretching, SurfaceScene, Target, VolumeTarget,
};
use super::Group;
use crate::generate::AnyShape;
use crate::info::MeshInfo;
use std::f64::consts::PI;

pub(super) fn groups(surface: &SurfaceScene, mesh: &MeshInfo, driver: &Driver) -> Vec<Group> {
    let radius = (mesh.area / (4.0 * PI)).sqrt();
    let mut groups = match driver {
        Driver::Relax(_) => Vec::new(),
        driver => in_flow(surface, mesh, driver),
    };
    let mut group = |name, formula, value: f64| {
        groups.push(Group {
            name,
            formula,
            value,
        });
    };
    if let Some(volume) = mesh.volume {
        let reduced = reduced_volume(volume, mesh.area);
        group("reduced volume at the start", "6√π V/A^(3/2)", reduced);
    }
    if let Some(held) = surface.volume {
        let area = match surface.area.map(|held| held.target) {
            Some(Target::Value(area)) => area,
            _ => mesh.area,
        };
        match held.target {
            VolumeTarget::Initial => {}
            VolumeTarget::Value(volume) => {
                let reduced = reduced_volume(volume, area);
                group("reduced volume of the target", "6√π V0/A^(3/2)", reduced);
            }
            VolumeTarget::Reduced(reduced) => {
                group("reduced volume of the target", "6√π V0/A^(3/2)", reduced);
            }
        }
    }
    match surface.area_difference.map(|held| held.target) {
        Some(AreaDifferenceTarget::Value(value)) => {
            let reduced = value / (4.0 * PI * radius);
            group("reduced area difference of the target", "M0/(4πR)", reduced);
        }
        Some(AreaDifferenceTarget::Reduced(reduced)) => {
            group("reduced area difference of the target", "M0/(4πR)", reduced);
        }
        _ => {}
    }
    let elasticity = surface.elasticity.as_ref().map(|elasticity| elasticity.law);
    if let Some(law) = elasticity {
        let ratio = law.area_modulus() / law.shear_modulus();
        group("area over shear modulus", "K_s/G", ratio);
        if let Some(stretching) = &surface.stretching {
            let value = largest(stretching) / (law.shear_modulus() * radius);
            group("largest stretching force over shear", "F/(G R)", value);
        }
    }
    let Some(bending) = surface.bending else {
        return groups;
    };
    let modulus = bending.modulus;
    if bending.spontaneous_curvature != 0.0 {
        let reduced = 2.0 * bending.spontaneous_curvature * radius;
        group("reduced spontaneous curvature", "c0 R = 2 H0 R", reduced);
    }
    if let Some(law) = elasticity {
        let [shear, area] = [law.shear_modulus(), law.area_modulus()];
        let young = 4.0 * area * shear / (area + shear);
        let squared = radius * radius;
        // In flow these are by the volume.
        if let Driver::Relax(_) = driver {
            let b = modulus / (squared * shear);
            group("bending number by G", "b = κ/(R² G)", b);
            group("bending number by E_s = 3 G", "κ/(R² 3 G)", b / 3.0);
        }
        let name = "Föppl–von Kármán number";
        group(
            name,
            "γ = Y R²/κ, Y = 4 K_s G/(K_s + G)",
            young * squared / modulus,
        );
    } else {
        if let Some(stretching) = &surface.stretching {
            let value = largest(stretching) * radius / modulus;
            group("largest stretching force over bending", "F R/κ", value);
        }
    }
    let penalty = |hold| match hold {
        Hold::Penalty(modulus) => Some(modulus),
        Hold::Exact => None,
    };
    if let Some(local) = &surface.local_area {
        let value = local.modulus * radius.powi(2) / modulus;
        group("local area over bending modulus", "k R²/κ", value);
    }
    if let Some(area) = surface.area.and_then(|held| penalty(held.hold)) {
        group(
            "area over bending modulus",
            "k R²/κ",
            area * radius.powi(2) / modulus,
        );
    }
    if let Some(volume) = surface.volume.and_then(|held| penalty(held.hold)) {
        group(
            "volume over bending modulus",
            "k R³/κ",
            volume * radius.powi(3) / modulus,
        );
    }
    if let Some(difference) = surface.area_difference.and_then(|held| penalty(held.hold)) {
        group(
            "area difference over bending modulus",
            "α = k/κ",
            difference / modulus,
        );
    }
    if let Some(tension) = surface.tension {
        group(
            "reduced tension",
            "σ R²/κ",
            tension * radius.powi(2) / modulus,
        );
    }
    if let Some(pressure) = surface.pressure {
        group(
            "reduced pressure",
            "Δp R³/κ",
            pressure * radius.powi(3) / modulus,
        );
    }
    if let Some(gravity) = surface.gravity {
        let [x, y, z] = gravity.acceleration;
        let weight = gravity.density_difference * x.hypot(y).hypot(z);
        group(
            "bending Bond number",
            "Δρ g R⁴/κ",
            weight * radius.powi(4) / modulus,
        );
    }
    groups
}

pub(super) fn largest(stretching: &Stretching) -> f64 {
    stretching.forces.iter().copied().fold(0.0, f64::max)
}

/// Radius a of the sphere of the same volume; of an open surface, of the same area.
pub(in crate::scene) fn enclosed_radius(mesh: &MeshInfo) -> f64 {
    match mesh.volume {
        Some(volume) if volume > 0.0 => (0.75 * volume / PI).cbrt(),
        _ => (mesh.area / (4.0 * PI)).sqrt(),
    }
}

/// `Ca_G = μγ̇a/G` of an elastic surface in a flow that has a rate.
pub(in crate::scene) fn capillary_number(
    surface: &SurfaceScene,
    mesh: &MeshInfo,
    driver: &Driver,
) -> Option<f64> {
    let elasticity = surface.elasticity.as_ref()?;
    let viscous = driver.viscosity()? * driver.flow()?.rate()? * enclosed_radius(mesh);
    Some(viscous / elasticity.law.shear_modulus())
}

/// The groups of a surface in viscous fluid.
fn in_flow(surface: &SurfaceScene, mesh: &MeshInfo, driver: &Driver) -> Vec<Group> {
    let mut groups = Vec::new();
    let mut group = |name, formula, value: f64| {
        groups.push(Group {
            name,
            formula,
            value,
        });
    };
    let radius = enclosed_radius(mesh);
    if let Some(capillary) = capillary_number(surface, mesh, driver) {
        group("capillary number by G", "Ca_G = μγ̇a/G", capillary);
        group(
            "capillary number by E_s = 3 G",
            "Ca_E = μγ̇a/E_s",
            capillary / 3.0,
        );
    }
    let modulus = surface.bending.map(|bending| bending.modulus);
    let shear = surface.elasticity.as_ref();
    let shear = shear.map(|elasticity| elasticity.law.shear_modulus());
    if let (Some(modulus), Some(shear)) = (modulus, shear) {
        let b = modulus / (radius * radius * shear);
        group("bending number by G", "b = κ/(a² G)", b);
        group("bending number by E_s = 3 G", "κ/(a² E_s)", b / 3.0);
    }
    let rate = driver.flow().and_then(Flow::rate);
    if let (Some(modulus), Some(rate), Some(viscosity)) = (modulus, rate, driver.viscosity()) {
        let viscous = viscosity * rate * radius.powi(3);
        group("capillary number by κ", "Ca_κ = μγ̇a³/κ", viscous / modulus);
    }
    let ratio = surface.viscosity_ratio.unwrap_or(1.0);
    group("viscosity inside over outside", "λ", ratio);
    match driver.flow() {
        Some(Flow::Poiseuille { radius: tube, .. }) => group(
            "size over that of the Poiseuille flow",
            "a/R",
            radius / tube,
        ),
        Some(Flow::Channel { width, .. }) => {
            group(
                "diameter over width of the channel",
                "2a/H",
                2.0 * radius / width,
            );
        }
        _ => {}
    }
    if let Some(deformation) = small_deformation(surface, mesh, driver) {
        let (formula, value) = deformation;
        group("expected D, theory for Ca_G → 0", formula, value);
    }
    groups
}

/// D = (L − B)/(L + B) of an elastic sphere in shear, to first order in Ca_G, and its formula; none
/// of what is no such sphere.
///
/// D. Barthès-Biesel, J. M. Rallison, J. Fluid Mech. 113 (1981) 251; b by the same expansion.
fn small_deformation(
    surface: &SurfaceScene,
    mesh: &MeshInfo,
    driver: &Driver,
) -> Option<(&'static str, f64)> {
    let elasticity = surface.elasticity.as_ref()?;
    let capillary = capillary_number(surface, mesh, driver)?;
    let reference = &elasticity.reference;
    let unstressed = reference.source == ReferenceSource::Initial && reference.scale == 1.0;
    let flat = |bending: Bending| bending.spontaneous_curvature == 0.0;
    let alone = surface.area.is_none()
        && surface.local_area.is_none()
        && surface.area_difference.is_none()
        && surface.tension.is_none()
        && surface.gravity.is_none()
        && surface.membrane_viscosity.is_none()
        && surface.stretching.is_none()
        && surface.bending.is_none_or(flat);
    let sphere = matches!(
        surface.source,
        MeshSource::Shape {
            shape: AnyShape::Sphere(_),
            ..
        }
    );
    let shear = matches!(driver.flow(), Some(Flow::Shear { .. }));
    if !(unstressed && alone && sphere && shear) {
        return None;
    }
    let radius = enclosed_radius(mesh);
    let modulus = surface.bending.map_or(0.0, |bending| bending.modulus);
    let b = modulus / (radius * radius * elasticity.law.shear_modulus());
    Some(match elasticity.law {
        InPlaneLaw::NeoHookean { .. } => (
            "(25/12) Ca_G/(1 + 11 b)",
            25.0 / 12.0 * capillary / (1.0 + 11.0 * b),
        ),
        InPlaneLaw::Skalak { area_ratio: c, .. } => (
            "(5/4)(2 + 3 C) Ca_G/(1 + 2 C + (15 + 18 C) b)",
            1.25 * (2.0 + 3.0 * c) * capillary / (1.0 + 2.0 * c + (15.0 + 18.0 * c) * b),
        ),
    })
}

/// What to know of the groups of a surface.
pub(super) fn notes(surface: &SurfaceScene, mesh: &MeshInfo, driver: &Driver) -> Vec<&'static str> {
    let mut notes = Vec::new();
    if capillary_number(surface, mesh, driver).is_some() {
        notes.push(
            "articles divide by G (Ca_G: Lac et al. 2004) or by E_s = 3 G (Ca_E: Ramanujan and \
             Pozrikidis 1998, Pozrikidis 2001): a factor of 3, in Ca and in κ/(a² …) alike",
        );
    }
    if small_deformation(surface, mesh, driver).is_some() {
        notes.push(
            "the theory gives more than is reached at finite Ca_G: 0.140 for 0.133 with the \
             neo-Hookean law at Ca_G = 0.15, b = 0.1125",
        );
    }
    notes
}
