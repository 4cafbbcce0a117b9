//! Checks for surfaces and obstacles that overlap at the start.

use crate::enclosure::{Bounded, Inside, inside_of_images};
use crate::scene::{SceneError, SceneErrors, SceneFile};

impl SceneFile {
    /// Checks that a surface and an obstacle, with their images, are outside each other at the
    /// start.
    ///
    /// # Errors
    /// If a vertex of one is inside the other.
    pub fn check_apart(
        &self,
        [surface, obstacle]: [usize; 2],
        body: &Bounded<'_>,
        solid: &Bounded<'_>,
    ) -> Result<(), SceneErrors> {
        let names = (
            self.scene.surfaces.get(surface).map(|scene| &scene.name),
            self.scene.obstacles.get(obstacle).map(|scene| &scene.name),
        );
        let (Some(name), Some(solid_name)) = names else {
            return Ok(());
        };
        let images = self.scene.driver.images();
        let message = if let [inside, ..] = inside_of_images(body, solid, &images).as_slice() {
            format!(
                "\"{name}\" starts inside the obstacle \"{solid_name}\", with {} vertices, {} the \
                 first{}: obstacles are solid: move one of them",
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
        let path = format!("{}.position", self.scene.path_of(surface));
        Err(self.contradiction(&path, message).into())
    }

    /// A warning if a surface intersects another one, or an image of it, at the start. A surface
    /// completely inside another is intended.
    pub fn check_outside(
        &self,
        [index, other]: [usize; 2],
        inner: &Bounded<'_>,
        outer: &Bounded<'_>,
    ) -> Option<SceneError> {
        let [scene, around] = [index, other].map(|number| self.scene.surfaces.get(number));
        let (name, around_name) = (&scene?.name, &around?.name);
        let found = inside_of_images(inner, outer, &self.scene.driver.images());
        let is_across = |inside: &&Inside| inside.count < inner.surface().positions().len();
        let inside = found.iter().find(is_across)?;
        let message = format!(
            "\"{name}\" starts across \"{around_name}\", with {} vertices inside of it, {} the first{}: \
             move one of them",
            inside.count,
            inside.first,
            through(inside)
        );
        Some(self.doubt(&format!("{}.position", self.scene.path_of(index)), message))
    }
}

/// Description of the image through which surfaces meet, if it is not the direct one.
fn through(inside: &Inside) -> &'static str {
    if inside.is_by_image() {
        ", through the ends of the periodic box"
    } else {
        ""
    }
}
