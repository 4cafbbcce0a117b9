//! Surfaces and obstacles that start where another one is.

use super::super::problem::{Problem, SceneErrors};
use super::super::{Driver, SceneError, SceneFile};
use crate::enclosure::vertices_inside;
use helfrich::Surface;

pub(in crate::scene) fn check_apart(
    file: &SceneFile,
    [surface, obstacle]: [usize; 2],
    body: Surface<'_, f64>,
    solid: Surface<'_, f64>,
) -> Result<(), SceneErrors> {
    let names = (
        file.scene.surfaces.get(surface).map(|scene| &scene.name),
        file.scene.obstacles.get(obstacle).map(|scene| &scene.name),
    );
    let (Some(name), Some(solid_name)) = names else {
        return Ok(());
    };
    let message = if let Some((vertex, count)) = vertices_inside(body, solid) {
        format!(
            "\"{name}\" starts inside the obstacle \"{solid_name}\", with {count} vertices, {vertex} \
             the first: no fluid is there: move one of them"
        )
    } else if vertices_inside(solid, body).is_some() {
        format!(
            "the obstacle \"{solid_name}\" is inside of \"{name}\", or reaches into it: move one of them"
        )
    } else {
        return Ok(());
    };
    let origin = file.origins.of(&format!("surface.{surface}.position"));
    let error = file
        .source
        .error(&origin, Problem::Contradiction { message });
    Err(error.into())
}

pub(in crate::scene) fn check_outside(
    file: &SceneFile,
    [index, other]: [usize; 2],
    inner: Surface<'_, f64>,
    outer: Surface<'_, f64>,
) -> Result<Option<SceneError>, SceneErrors> {
    let scenes = [index, other].map(|number| file.scene.surfaces.get(number));
    let ([Some(scene), Some(around)], Some((vertex, count))) =
        (scenes, vertices_inside(inner, outer))
    else {
        return Ok(None);
    };
    let (name, around_name) = (&scene.name, &around.name);
    let origin = file.origins.of(&format!("surface.{index}.position"));
    if count < inner.positions().len() {
        let message = format!(
            "\"{name}\" starts across \"{around_name}\", with {count} vertices inside of it, {vertex} \
             the first: move one of them"
        );
        return Ok(Some(
            file.source.error(&origin, Problem::Doubtful { message }),
        ));
    }
    let contrast = [scene, around].map(|scene| scene.viscosity_ratio.unwrap_or(1.0));
    if contrast == [1.0; 2] || !matches!(file.scene.driver, Driver::BoundaryIntegral(_)) {
        return Ok(None);
    }
    let message = format!(
        "\"{name}\" is inside of \"{around_name}\", and their viscosity ratios are {} and {}: the \
         driver \"boundary-integral\" has one viscosity outside of all surfaces: leave \
         `viscosity_ratio` out, or put them beside each other",
        contrast[0], contrast[1]
    );
    let error = file
        .source
        .error(&origin, Problem::Contradiction { message });
    Err(error.into())
}
