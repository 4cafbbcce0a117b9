//! Remedies for relaxations that did not reach an equilibrium.

use crate::generate::Family;
use crate::method::BendingMethod;
use crate::scene::{MeshSource, SurfaceScene, start_shape};

/// Vertices that resolve vesicles of reduced volume down to 0.6, in each family.
const RESOLVED: usize = 2562;

/// Largest relative difference of the initial reduced volume from the target: a mesh that is generated
/// for one shape and stretched to another is too coarse where it is stretched.
const NEAR: f64 = 0.05;

/// The remedy for a mesh that becomes bad in a relaxation, or that does not resolve the shape: method S
/// on an even mesh of nearly the requested shape. With this remedy, vesicles of reduced volume down to
/// 0.6 reach the energies of theory.
///
/// Line tension pulls the vertices of an edge together, and no mesh resolves an edge that has closed unless its hole is
/// closed, too.
pub(super) fn remedy(surface: &SurfaceScene) -> String {
    if surface.effects.line_tension.is_some() && surface.topology.is_none() {
        return "an edge may have closed under `line_tension`: with `remesh = \"auto\"` and `topology = \"may-break\"` of the \
                surface its hole is closed; or choose a smaller one"
            .to_owned();
    }
    let bending = surface.effects.bending.as_ref();
    // Only a surface that bends can bend by another method.
    let keeps_method = bending.is_none_or(|bending| bending.method == BendingMethod::Loop);
    let MeshSource::Shape {
        family, vertices, ..
    } = &surface.source
    else {
        let method = match keeps_method {
            true => "",
            false => "the bending method \"loop\" and ",
        };
        return format!("choose {method}a mesh of more and more even triangles");
    };
    let needed = regular_count(*vertices);
    let mut remedy = match (keeps_method, *family == Family::Relaxed) {
        (true, true) => String::new(),
        (true, false) => "choose a mesh of the family \"relaxed\"".to_owned(),
        (false, _) => {
            "choose the bending method \"loop\" on a mesh of the family \"relaxed\"".to_owned()
        }
    };
    if needed > *vertices {
        let of = match remedy.is_empty() {
            true => "choose a mesh of",
            false => " with",
        };
        remedy.push_str(&format!("{of} {needed} vertices"));
    }
    if let Some(start) = start_shape(surface, NEAR) {
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

/// Remedy for a surface whose triangles do not allow a further step.
pub(super) fn of_mesh(surface: &SurfaceScene) -> String {
    let may_close = surface.effects.line_tension.is_some() && surface.topology.is_none();
    if surface.remesh.is_none() && surface.can_have_new_meshes() && !may_close {
        return "give the surface `remesh = \"auto\"`: it then gets a new mesh whenever triangles have become narrow"
            .to_owned();
    }
    remedy(surface)
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

#[cfg(test)]
mod tests {
    use super::remedy;
    use crate::scene::{Overrides, SceneFile};
    use std::path::Path;

    fn said(surface: &str) -> String {
        let text = format!(
            "units = \"none\"\n[[surface]]\nvertices = 2562\nshape = \"sphere\"\n{surface}\n[driver]\nkind = \
             \"relax\""
        );
        let file = SceneFile::parse(&text, Path::new("scene.toml"), &Overrides::default());
        let file = file.unwrap_or_else(|errors| panic!("{errors}"));
        remedy(&file.scene.surfaces[0])
    }

    /// Neither is the method recommended that acts already, nor a method to a surface that does not bend.
    #[test]
    fn remedies_are_no_part_of_the_scene() {
        let bends = |method: &str| format!("bending = {{ method = \"{method}\", modulus = 1 }}");
        let even = "family = \"relaxed\"\n";
        for (surface, has_method, has_family) in [
            (bends("gompper-kroll"), true, true),
            (bends("loop"), false, true),
            (format!("{even}{}", bends("loop")), false, false),
            ("tension = { value = 1 }".to_owned(), false, true),
            (format!("{even}tension = {{ value = 1 }}"), false, false),
        ] {
            let said = said(&surface);
            let found = ["\"loop\"", "\"relaxed\""].map(|part| said.contains(part));
            assert_eq!(found, [has_method, has_family], "{surface}: {said}");
            assert!(said.contains("choose"), "{said}");
        }
    }
}
