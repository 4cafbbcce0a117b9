//! Checks for surfaces and obstacles that overlap at the start.

use super::super::problem::{Problem, SceneErrors};
use super::super::{SceneError, SceneFile};
use crate::enclosure::{Inside, inside_of_images};
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
    let images = file.scene.driver.images();
    let message = if let [inside, ..] = inside_of_images(body, solid, &images).as_slice() {
        format!(
            "\"{name}\" starts inside the obstacle \"{solid_name}\", with {} vertices, {} the \
             first{}: no fluid is there: move one of them",
            inside.count,
            inside.first,
            through(inside)
        )
    } else if let [inside, ..] = inside_of_images(solid, body, &images).as_slice() {
        format!(
            "the obstacle \"{solid_name}\" is inside of \"{name}\", or reaches into it{}: move one \
             of them",
            through(inside)
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

/// Warns about a surface that intersects another one at the start. A surface completely inside
/// another is intended.
pub(in crate::scene) fn check_outside(
    file: &SceneFile,
    [index, other]: [usize; 2],
    inner: Surface<'_, f64>,
    outer: Surface<'_, f64>,
) -> Option<SceneError> {
    let [scene, around] = [index, other].map(|number| file.scene.surfaces.get(number));
    let (name, around_name) = (&scene?.name, &around?.name);
    let found = inside_of_images(inner, outer, &file.scene.driver.images());
    let is_across = |inside: &&Inside| inside.count < inner.positions().len();
    let inside = found.iter().find(is_across)?;
    let origin = file.origins.of(&format!("surface.{index}.position"));
    let message = format!(
        "\"{name}\" starts across \"{around_name}\", with {} vertices inside of it, {} the first{}: \
         move one of them",
        inside.count,
        inside.first,
        through(inside)
    );
    Some(file.source.error(&origin, Problem::Doubtful { message }))
}

/// Description of the image through which surfaces meet, if it is not the direct one.
fn through(inside: &Inside) -> &'static str {
    if inside.is_by_image() {
        ", through the ends of the periodic box"
    } else {
        ""
    }
}
