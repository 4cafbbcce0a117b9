//! Dimensionless groups.

use crate::generate::AnyShape;
use crate::info::MeshInfo;
use crate::scene::{
    Bending, Driver, Flow, Group, Groups, InPlaneLaw, MeshSource, SurfaceScene, capillary_number,
    reduced_volume,
};

pub(super) fn groups(surface: &SurfaceScene, mesh: &MeshInfo, driver: &Driver) -> Vec<Group> {
    let mut groups = Groups {
        effects: &surface.effects,
        mesh,
        driver,
        found: Vec::new(),
    };
    if let Some(volume) = mesh.volume {
        let reduced = reduced_volume(volume, mesh.area);
        groups.add("reduced volume at the start", "6√π V/A^(3/2)", reduced);
    }
    if driver.viscosity().is_some() {
        let ratio = surface.viscosity_ratio.unwrap_or(1.0);
        groups.add("viscosity inside over that of the driver", "λ", ratio);
    }
    let radius = mesh.enclosed_radius();
    match driver.flow() {
        Some(Flow::Poiseuille { radius: tube, .. }) => {
            let name = "size over that of the Poiseuille flow";
            groups.add(name, "a/R", radius / tube);
        }
        Some(Flow::Channel { width, .. }) => {
            let name = "diameter over width of the channel";
            groups.add(name, "2a/H", 2.0 * radius / width);
        }
        _ => {}
    }
    for (_, effect) in surface.effects.iter() {
        effect.groups(&mut groups);
    }
    if let Some((formula, value)) = small_deformation(surface, mesh, driver) {
        groups.add("expected D, theory for Ca_G → 0", formula, value);
    }
    groups.found
}

/// D = (L − B)/(L + B) of an elastic sphere in shear, to first order in Ca_G, and its formula;
/// `None` for other surfaces.
///
/// D. Barthès-Biesel, J. M. Rallison, J. Fluid Mech. 113 (1981) 251; b by the same expansion.
fn small_deformation(
    surface: &SurfaceScene,
    mesh: &MeshInfo,
    driver: &Driver,
) -> Option<(&'static str, f64)> {
    let effects = &surface.effects;
    let elasticity = effects.elasticity.as_ref()?;
    let capillary = capillary_number(&surface.effects, mesh, driver)?;
    let reference = &elasticity.reference;
    let unstressed = reference.is_initial() && reference.scale == 1.0;
    let plain = |bending: &Bending| {
        let spontaneous = bending.spontaneous_curvature.uniform();
        spontaneous == Some(0.0) && bending.modulus.uniform().is_some()
    };
    // A pressure has no effect, because the volume is conserved.
    let known = ["elasticity", "bending", "volume", "pressure"];
    let alone = effects.names().all(|name| known.contains(&name))
        && effects.bending.as_ref().is_none_or(plain);
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
    let radius = mesh.enclosed_radius();
    let modulus = effects.stiffness().bending;
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

/// Remarks on the groups of a surface.
pub(super) fn notes(surface: &SurfaceScene, mesh: &MeshInfo, driver: &Driver) -> Vec<&'static str> {
    let mut notes = Vec::new();
    if capillary_number(&surface.effects, mesh, driver).is_some() {
        notes.push(
            "articles divide by G (Ca_G: Lac et al. 2004) or by E_s = 3 G (Ca_E: Ramanujan and \
             Pozrikidis 1998, Pozrikidis 2001): a factor of 3, in Ca and in κ/(a² …) alike",
        );
    }
    if small_deformation(surface, mesh, driver).is_some() {
        notes.push(
            "the theory overestimates D at finite Ca_G: 0.140 instead of 0.133 with the \
             neo-Hookean law at Ca_G = 0.15, b = 0.1125",
        );
    }
    notes
}
