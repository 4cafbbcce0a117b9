//! What effects ask of a mesh: seen once the mesh is known.

mod lattice;
mod overlap;

pub(super) use overlap::{check_apart, check_outside};

use super::build::reduced_volume;
use super::explain::{capillary_number, enclosed_radius};
use super::problem::{Problem, SceneErrors};
use super::{
    Driver, Flow, Held, Hold, InPlaneLaw, Interaction, MeshSource, Reference, ReferenceSource,
    SceneError, SceneFile, SurfaceScene, Target, VolumeTarget,
};
use crate::generate::Family;
use crate::info::MeshInfo;
use crate::method::BendingMethod;
use glam::DVec3;
use helfrich::TriangleMesh;

pub(super) fn check_mesh(
    file: &SceneFile,
    surface: usize,
    mesh: &MeshInfo,
) -> Result<(), SceneErrors> {
    let Some(scene) = file.scene.surfaces.get(surface) else {
        return Ok(());
    };
    let mut found = Vec::new();
    let mut problem = |key: &str, message: String| found.push((key.to_owned(), message));
    if mesh.isolated_vertices > 0 {
        let count = mesh.isolated_vertices;
        problem(
            "",
            format!(
                "{count} vertices of the mesh are in no triangle, and nothing would hold them: take them out of the mesh file"
            ),
        );
    }
    for key in needing_a_volume(scene) {
        match mesh.volume {
            None => problem(
                key,
                format!(
                    "`{key}` needs an enclosed volume, and the mesh of \"{}\" has {} boundary edges: \
                     close the mesh, or leave `{key}` out",
                    scene.name, mesh.boundary_edges
                ),
            ),
            Some(volume) if volume <= 0.0 => problem(
                key,
                format!(
                    "the mesh of \"{}\" encloses {volume}: its triangles run clockwise seen from \
                     outside: turn them over",
                    scene.name
                ),
            ),
            Some(_) => {}
        }
    }
    if let [first, ..] = mesh.degenerate_triangles.as_slice() {
        let initial = |reference: &Reference| reference.source == ReferenceSource::Initial;
        let elasticity = scene.elasticity.as_ref();
        let local_area = scene.local_area.as_ref();
        let named = [
            ("elasticity", elasticity.map(|law| initial(&law.reference))),
            ("local_area", local_area.map(|law| initial(&law.reference))),
        ];
        for (key, _) in named.into_iter().filter(|(_, named)| *named == Some(true)) {
            problem(
                key,
                format!(
                    "triangle {first} of the mesh has no area, and no strain can be measured from \
                     it: repair the mesh, or give `{key}` another reference"
                ),
            );
        }
    }
    targets(scene, mesh, &mut problem);
    if let Driver::LatticeBoltzmann(lattice) = &file.scene.driver {
        lattice::in_the_box(scene, mesh, lattice, &mut problem);
    }
    let errors = found.into_iter().map(|(key, message)| {
        let path = match key.as_str() {
            "" => format!("surface.{surface}"),
            key => format!("surface.{surface}.{key}"),
        };
        let origin = file.origins.of(&path);
        file.source
            .error(&origin, Problem::Contradiction { message })
    });
    SceneErrors::new(errors.collect()).map_or(Ok(()), Err)
}

pub(super) fn check_obstacle(
    file: &SceneFile,
    obstacle: usize,
    mesh: &MeshInfo,
) -> Result<(), SceneErrors> {
    let Some(scene) = file.scene.obstacles.get(obstacle) else {
        return Ok(());
    };
    let name = &scene.name;
    let outside = match &file.scene.driver {
        Driver::LatticeBoltzmann(lattice) => lattice::off_the_nodes(name, mesh, lattice),
        _ => None,
    };
    let message = match mesh.volume {
        None => format!(
            "the mesh of the obstacle \"{name}\" has {} boundary edges, and fluid flows around closed \
             bodies: close the mesh",
            mesh.boundary_edges
        ),
        Some(volume) if volume <= 0.0 => format!(
            "the mesh of the obstacle \"{name}\" encloses {volume}: its triangles run clockwise seen \
             from outside: turn them over"
        ),
        Some(_) => match outside {
            Some(message) => message,
            None => return Ok(()),
        },
    };
    let origin = file.origins.of(&format!("obstacle.{obstacle}"));
    let error = file
        .source
        .error(&origin, Problem::Contradiction { message });
    Err(error.into())
}

pub(super) fn mesh_warnings(file: &SceneFile, surface: usize, mesh: &MeshInfo) -> Vec<SceneError> {
    let mut warnings = Vec::new();
    let mut warn = |path: &str, message: String| {
        let origin = file.origins.of(path);
        warnings.push(file.source.error(&origin, Problem::Doubtful { message }));
    };
    for (index, interaction) in file.scene.interactions.iter().enumerate() {
        let Interaction::Repulsion {
            cutoff, between, ..
        } = interaction;
        let concerned = between.is_none_or(|pair| pair.contains(&surface));
        let longest = mesh.edge_lengths[1];
        if concerned && longest > 0.5 * cutoff {
            let message = format!(
                "the repulsion reaches {cutoff}, and edges of \"{}\" are up to {longest} long: a \
                 surface can slip between the vertices of another: choose a longer `cutoff` or more \
                 vertices, such that edges are half of it or less",
                file.scene.surfaces[surface].name
            );
            warn(&format!("interaction.{index}.cutoff"), message);
        }
    }
    let driver = &file.scene.driver;
    if let (Some(flow), Some(scene)) = (driver.flow(), file.scene.surfaces.get(surface)) {
        for (key, message) in in_flow(scene, mesh, driver) {
            warn(&format!("surface.{surface}.{key}"), message);
        }
        if let Some(message) = beyond_the_tube(scene, mesh, flow) {
            warn("driver.flow.radius", message);
        }
    }
    if let (Driver::LatticeBoltzmann(lattice), Some(scene)) =
        (driver, file.scene.surfaces.get(surface))
    {
        for (path, message) in lattice::doubts(file, surface, scene, mesh, lattice) {
            warn(&path, message);
        }
    }
    warnings
}

/// What is doubtful about a membrane in flow, each with its key.
fn in_flow(scene: &SurfaceScene, mesh: &MeshInfo, driver: &Driver) -> Vec<(&'static str, String)> {
    let mut found = Vec::new();
    let name = &scene.name;
    let law = scene.elasticity.as_ref().map(|elasticity| elasticity.law);
    if let (Some(InPlaneLaw::NeoHookean { .. }), None) = (law, scene.bending)
        && let Some(capillary) = capillary_number(scene, mesh, driver)
        && capillary < WRINKLING
    {
        found.push((
            "elasticity",
            format!(
                "\"{name}\" is neo-Hookean and has no bending, and with Ca_G = {capillary:.3}, below \
                 about {WRINKLING}, the flow compresses it: it wrinkles at the scale of its mesh, more \
                 so on a finer one: add [surface.bending]"
            ),
        ));
    }
    let [fewest, most] = mesh.valences;
    let irregular = fewest <= 3 || most >= 9;
    let uneven = match scene.source {
        MeshSource::Shape {
            family: Family::Irregular | Family::Hard,
            ..
        } => true,
        _ => irregular || mesh.angles[0] < 10.0,
    };
    let consequence = match scene.bending.map(|bending| bending.method) {
        Some(BendingMethod::GompperKroll) => {
            "with method gompper-kroll (B) steps were 100 times shorter on irregular meshes, and came \
             to nothing on slivers"
        }
        Some(BendingMethod::Meyer) => {
            "with method meyer (C) steps were 200 times shorter on irregular meshes, and shorter still \
             on slivers"
        }
        Some(BendingMethod::Farutin) => {
            "with method farutin (E) deformations of the scale of the mesh grow without end on such \
             meshes"
        }
        Some(BendingMethod::Belkin) if irregular => {
            "with method belkin (D) capsules on irregular meshes were deformed too much, by 19 % with \
             162 vertices and by 8 % with 642"
        }
        Some(BendingMethod::Loop) if irregular => {
            "with method loop (S) capsules on irregular meshes came to a stop at once"
        }
        _ => return found,
    };
    if uneven {
        let angle = mesh.angles[0];
        found.push((
            "bending.method",
            format!(
                "the mesh of \"{name}\" is uneven, with {fewest} to {most} neighbours of a vertex and \
                 angles from {angle:.1}°: {consequence}: choose j4, or an even mesh"
            ),
        ));
    }
    found
}

/// Below this Ca_G neo-Hookean capsules without bending wrinkle at the scale of their mesh:
/// E. Lac, D. Barthès-Biesel, N. A. Pelekasis, J. Tsamopoulos, J. Fluid Mech. 516 (2004) 303.
const WRINKLING: f64 = 0.45;

/// A surface that reaches where a Poiseuille flow turns round, as a sphere about its position.
fn beyond_the_tube(scene: &SurfaceScene, mesh: &MeshInfo, flow: &Flow) -> Option<String> {
    let Flow::Poiseuille {
        radius,
        direction,
        through,
        ..
    } = *flow
    else {
        return None;
    };
    let away = DVec3::from(scene.position) - DVec3::from(through);
    let distance = away
        .reject_from_normalized(DVec3::from(direction).normalize_or_zero())
        .length();
    let reach = distance + enclosed_radius(mesh);
    (reach > radius).then(|| {
        format!(
            "\"{}\" reaches {reach:.3} from the axis, and this Poiseuille flow, which has no walls, \
             turns round at `radius` {radius}: choose a larger one, or a smaller surface nearer to \
             the axis",
            scene.name
        )
    })
}

fn needing_a_volume(scene: &SurfaceScene) -> Vec<&'static str> {
    let effects = [
        ("volume", scene.volume.is_some()),
        ("area_difference", scene.area_difference.is_some()),
        ("pressure", scene.pressure.is_some()),
        ("gravity", scene.gravity.is_some()),
        (
            "viscosity_ratio",
            scene.viscosity_ratio.is_some_and(|ratio| ratio != 1.0),
        ),
    ];
    let named = effects.into_iter().filter(|(_, named)| *named);
    named.map(|(key, _)| key).collect()
}

/// Targets that no surface can have. Of several components the smallest is not known here.
fn targets(scene: &SurfaceScene, mesh: &MeshInfo, problem: &mut impl FnMut(&str, String)) {
    if mesh.components != 1 {
        return;
    }
    let exact_area = scene.area.is_some_and(|area| area.hold == Hold::Exact);
    let area = match scene.area {
        Some(Held {
            target: Target::Value(area),
            ..
        }) => area,
        _ => mesh.area,
    };
    if let Some(held) = scene.volume
        && exact_area
        && held.hold == Hold::Exact
    {
        let volume = match held.target {
            VolumeTarget::Value(volume) => Some(volume),
            VolumeTarget::Initial => mesh.volume,
            VolumeTarget::Reduced(_) => None,
        };
        if let Some(volume) = volume
            && reduced_volume(volume, area) > 1.0
        {
            problem(
                "volume",
                format!(
                    "area {area} and volume {volume} are both held, and their reduced volume is \
                     {:.4}: no surface of that area encloses more than {:.6}",
                    reduced_volume(volume, area),
                    volume / reduced_volume(volume, area)
                ),
            );
        }
    }
}

pub(super) fn check_reference(
    file: &SceneFile,
    surface: usize,
    mesh: &TriangleMesh,
    reference: &TriangleMesh,
) -> Result<(), SceneErrors> {
    let Some(scene) = file.scene.surfaces.get(surface) else {
        return Ok(());
    };
    let counts = |mesh: &TriangleMesh| (mesh.vertex_count(), mesh.triangles().len());
    let [here, there] = [counts(mesh), counts(reference)];
    let message = if here != there {
        format!(
            "the reference has {} vertices and {} triangles, and the surface {} and {}: both need \
             the same triangles",
            there.0, there.1, here.0, here.1
        )
    } else if let Some(triangle) =
        (0..here.1).find(|&triangle| mesh.triangles()[triangle] != reference.triangles()[triangle])
    {
        format!(
            "triangle {triangle} of the reference has the vertices {:?}, and the surface's {:?}: \
             both need the same triangles in the same order",
            reference.triangles()[triangle],
            mesh.triangles()[triangle]
        )
    } else {
        return Ok(());
    };
    let initial = |reference: &Reference| reference.source == ReferenceSource::Initial;
    let elasticity = scene.elasticity.as_ref();
    let effect = match elasticity.is_some_and(|elasticity| !initial(&elasticity.reference)) {
        true => "elasticity",
        false => "local_area",
    };
    let origin = file
        .origins
        .of(&format!("surface.{surface}.{effect}.reference"));
    let error = file
        .source
        .error(&origin, Problem::Contradiction { message });
    Err(error.into())
}
