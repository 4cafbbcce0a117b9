//! What effects ask of a mesh: seen once the mesh is known.

use super::build::reduced_volume;
use super::problem::{Problem, SceneErrors};
use super::{
    Held, Hold, Interaction, Reference, ReferenceSource, SceneError, SceneFile, SurfaceScene,
    Target, VolumeTarget,
};
use crate::info::MeshInfo;
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

pub(super) fn mesh_warnings(file: &SceneFile, surface: usize, mesh: &MeshInfo) -> Vec<SceneError> {
    let interactions = file.scene.interactions.iter().enumerate();
    let warning = |(index, interaction): (usize, &Interaction)| {
        let Interaction::Repulsion {
            cutoff, between, ..
        } = interaction;
        let concerned = between.is_none_or(|pair| pair.contains(&surface));
        let longest = mesh.edge_lengths[1];
        (concerned && longest > 0.5 * cutoff).then(|| {
            let message = format!(
                "the repulsion reaches {cutoff}, and edges of \"{}\" are up to {longest} long: a \
                 surface can slip between the vertices of another: choose a longer `cutoff` or more \
                 vertices, such that edges are half of it or less",
                file.scene.surfaces[surface].name
            );
            let origin = file.origins.of(&format!("interaction.{index}.cutoff"));
            file.source.error(&origin, Problem::Doubtful { message })
        })
    };
    interactions.filter_map(warning).collect()
}

fn needing_a_volume(scene: &SurfaceScene) -> Vec<&'static str> {
    let effects = [
        ("volume", scene.volume.is_some()),
        ("area_difference", scene.area_difference.is_some()),
        ("pressure", scene.pressure.is_some()),
        ("gravity", scene.gravity.is_some()),
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
