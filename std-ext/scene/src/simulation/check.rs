//! Requirements of a scene on its meshes, checked once these are known.

mod lattice;
mod overlap;

use crate::generate::{Family, ShapeDeviation};
use crate::info::MeshInfo;
use crate::noise::Quieted;
use crate::scene::{
    Driver, Flow, InteractionScene, MeshCheck, MeshSource, Reference, SceneError, SceneErrors,
    SceneFile, SurfaceScene,
};
use crate::six::{Six, rounded};
use glam::DVec3;
use helfrich::TriangleMesh;

/// Triangles of a fluid surface in a flow are too narrow below this many degrees, and below what they
/// were at the start. Even meshes have 35 to 55; a drop at Ca = 0.02 whose mesh is drawn out is off by
/// 10 % in D before it gets there.
pub const NARROW: f64 = 20.0;

/// Share of a repulsion's range that edges may lose: surfaces stay apart by more than half of it.
const SAG: f64 = 0.25;

impl SceneFile {
    /// Compares the effects of a surface with its mesh, scaled as in the scene.
    ///
    /// # Errors
    /// All conflicts between effects and the mesh.
    pub fn check_mesh(&self, surface: usize, mesh: &MeshInfo) -> Result<(), SceneErrors> {
        let Some(scene) = self.scene.surfaces.get(surface) else {
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
        if mesh.boundary_edges == 0 && !scene.boundary.is_free() {
            let message = format!(
                "the mesh of \"{}\" is closed, and has no edge to support: leave `boundary` out",
                scene.name
            );
            problem("boundary", message);
        }
        let effects = scene.effects.iter();
        let needing_a_volume = effects.filter(|(_, effect)| effect.needs_volume());
        let flows = scene.viscosity_ratio.is_some_and(|ratio| ratio != 1.0);
        let of_the_fluid = flows.then_some("viscosity_ratio");
        let keys = needing_a_volume.map(|(key, _)| key).chain(of_the_fluid);
        for key in keys {
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
                        "the mesh of \"{}\" encloses {}: its triangles run clockwise seen from \
                         outside: turn them over",
                        scene.name,
                        Six(volume)
                    ),
                ),
                Some(_) => {}
            }
        }
        if let [first, ..] = mesh.degenerate_triangles.as_slice() {
            for (key, effect) in scene.effects.iter() {
                if effect.reference().is_some_and(Reference::is_initial) {
                    problem(
                        key,
                        format!(
                            "triangle {first} of the mesh has no area, and no strain can be measured from \
                             it: repair the mesh, or give `{key}` another reference"
                        ),
                    );
                }
            }
        }
        if let Some(message) = too_large_or_small(scene, mesh) {
            problem("", message);
        } else {
            for (key, message) in of_effects(scene, mesh, &self.scene.driver).contradictions {
                problem(&key, message);
            }
        }
        if let Driver::LatticeBoltzmann(lattice) = &self.scene.driver {
            lattice::in_the_box(scene, mesh, lattice, &mut problem);
        }
        let errors = found.into_iter().map(|(key, message)| {
            let path = match key.as_str() {
                "" => self.scene.path_of(surface),
                key => format!("{}.{key}", self.scene.path_of(surface)),
            };
            self.contradiction(&path, message)
        });
        SceneErrors::new(errors.collect()).map_or(Ok(()), Err)
    }

    /// Checks that the mesh of an obstacle, scaled as in the scene, can be an obstacle.
    ///
    /// # Errors
    /// If it has no interior.
    pub fn check_obstacle(&self, obstacle: usize, mesh: &MeshInfo) -> Result<(), SceneErrors> {
        let Some(scene) = self.scene.obstacles.get(obstacle) else {
            return Ok(());
        };
        let name = &scene.name;
        let outside = match &self.scene.driver {
            Driver::LatticeBoltzmann(lattice) => lattice::off_the_nodes(name, mesh, lattice),
            _ => None,
        };
        let message = match mesh.volume {
            None => format!(
                "the mesh of the obstacle \"{name}\" has {} boundary edges, and obstacles are closed \
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
        let path = format!("obstacle.{obstacle}");
        Err(self.contradiction(&path, message).into())
    }

    /// Warnings about a surface and its mesh, scaled as the scene demands.
    pub fn mesh_warnings(&self, surface: usize, mesh: &MeshInfo) -> Vec<SceneError> {
        let mut warnings = Vec::new();
        let mut warn = |path: &str, message: String| {
            warnings.push(self.doubt(path, message));
        };
        for (index, interaction) in self.scene.interactions.iter().enumerate() {
            let cutoff = interaction.barrier().cutoff;
            let concerned = interaction
                .between()
                .is_none_or(|pair| pair.iter().any(|side| side.range().contains(&surface)));
            let longest = mesh.edge_lengths[1];
            let sag = 0.25 * longest * longest / mesh.enclosed_radius();
            if concerned && sag > SAG * cutoff {
                let message = format!(
                    "the {} reaches {}, and edges of \"{}\" are up to {} long: between its vertices a \
                     surface can slip by e²/4a = {} into another: choose a longer `cutoff` or more vertices, \
                     such that this is a quarter of it or less",
                    interaction.name(),
                    Six(cutoff),
                    self.scene.surfaces[surface].name,
                    Six(longest),
                    Six(sag)
                );
                warn(&format!("interaction.{index}.cutoff"), message);
            }
            if let InteractionScene::Adhesion {
                distance, cutoff, ..
            } = *interaction
                && concerned
                && longest > cutoff - distance
            {
                let message = format!(
                    "the adhesion reaches from {} to {}, and edges of \"{}\" are up to {} long: the rim of a contact, \
                     where the gap opens, is held where it meets vertices: choose a longer `cutoff` or more \
                     vertices, such that edges are shorter than the difference",
                    Six(distance),
                    Six(cutoff),
                    self.scene.surfaces[surface].name,
                    Six(longest)
                );
                warn(&format!("interaction.{index}.cutoff"), message);
            }
        }
        if let Some(scene) = self.scene.surfaces.get(surface)
            && let Some(message) = off_its_shape(&scene.name, &scene.source, scene.scale, mesh)
        {
            warn(
                &format!("{}.vertices", self.scene.path_of(surface)),
                message,
            );
        }
        let driver = &self.scene.driver;
        if let Some(scene) = self.scene.surfaces.get(surface) {
            for (key, message) in of_effects(scene, mesh, driver).doubts {
                warn(&format!("{}.{key}", self.scene.path_of(surface)), message);
            }
            let flow = driver.flow();
            if let Some(message) = flow.and_then(|_| uneven_drop(scene, mesh)) {
                warn(&self.scene.path_of(surface), message);
            }
            if let Some(message) = flow.and_then(|flow| beyond_the_tube(scene, mesh, flow)) {
                warn("driver.flow.radius", message);
            }
        }
        if let (Driver::LatticeBoltzmann(lattice), Some(scene)) =
            (driver, self.scene.surfaces.get(surface))
        {
            for (path, message) in lattice::doubts(self, surface, scene, mesh, lattice) {
                warn(&path, message);
            }
        }
        warnings
    }

    /// A warning that vertices of a surface do not start where its mesh file has them.
    pub(super) fn noise_warning(&self, surface: usize, quieted: &Quieted) -> SceneError {
        let scene = &self.scene.surfaces[surface];
        let Quieted {
            noise, smoothing, ..
        } = quieted;
        let message = format!(
            "the mesh of \"{}\" is noisy: its vertices lie off a smooth surface by σ = {}, {} of an edge. \
             The noise is taken out once, at the start: vertices were moved {} times onto fits of degree {} \
             to {} neighbours, by {} in all (root mean square); choose j6 or j4 to start from the file as \
             it is",
            scene.name,
            Six(rounded(scene.scale.abs() * noise.length)),
            Six(rounded(noise.edges)),
            Quieted::TIMES,
            smoothing.degree,
            smoothing.neighbours,
            Six(rounded(scene.scale.abs() * quieted.moved)),
        );
        self.doubt(
            &format!("{}.bending.method", self.scene.path_of(surface)),
            message,
        )
    }

    /// A warning about the mesh of an obstacle.
    pub fn obstacle_warning(&self, obstacle: usize, mesh: &MeshInfo) -> Option<SceneError> {
        let scene = self.scene.obstacles.get(obstacle)?;
        let message = off_its_shape(&scene.name, &scene.source, scene.scale, mesh)?;
        Some(self.doubt(&format!("obstacle.{obstacle}.vertices"), message))
    }

    /// Compares a surface's mesh with the one of the reference that an effect of it names.
    ///
    /// # Errors
    /// If the two do not have the same triangles.
    pub fn check_reference(
        &self,
        surface: usize,
        effect: &str,
        mesh: &TriangleMesh,
        reference: &TriangleMesh,
    ) -> Result<(), SceneErrors> {
        let counts = |mesh: &TriangleMesh| (mesh.vertex_count(), mesh.triangles().len());
        let [here, there] = [counts(mesh), counts(reference)];
        let message = if here != there {
            format!(
                "the reference has {} vertices and {} triangles, and the surface {} and {}: both need \
                 the same triangles",
                there.0, there.1, here.0, here.1
            )
        } else if let Some(triangle) = (0..here.1)
            .find(|&triangle| mesh.triangles()[triangle] != reference.triangles()[triangle])
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
        let path = format!("{}.{effect}.reference", self.scene.path_of(surface));
        Err(self.contradiction(&path, message).into())
    }
}

/// Warns about a generated mesh whose area or volume differs from that of its shape.
fn off_its_shape(name: &str, source: &MeshSource, scale: f64, mesh: &MeshInfo) -> Option<String> {
    let MeshSource::Shape { shape, family, .. } = source else {
        return None;
    };
    let deviation = ShapeDeviation::new(shape, scale, mesh);
    let (value, quantity) = deviation.largest();
    let remedy = match family {
        Family::Regular => "",
        _ => ", or the family \"regular\"",
    };
    deviation.is_beyond_limit().then(|| {
        format!(
            "the mesh of \"{name}\" has {:.1} % {} {quantity} than {shape}, beyond {:.1} %, the limit \
             for {} vertices: what is computed is that of another shape: choose more `vertices`{remedy}",
            100.0 * value.abs(),
            if value < 0.0 { "less" } else { "more" },
            100.0 * deviation.limit(),
            mesh.vertices
        )
    })
}

/// Findings of the effects of a surface about its mesh.
fn of_effects<'a>(
    scene: &'a SurfaceScene,
    mesh: &'a MeshInfo,
    driver: &'a Driver,
) -> MeshCheck<'a> {
    let mut check = MeshCheck {
        name: &scene.name,
        effects: &scene.effects,
        source: &scene.source,
        boundary: scene.boundary,
        mesh,
        driver,
        contradictions: Vec::new(),
        doubts: Vec::new(),
    };
    for (_, effect) in scene.effects.iter() {
        effect.check_mesh(&mut check);
    }
    check
}

/// A doubt about a drop whose mesh is uneven from the start. Bending has its own.
fn uneven_drop(scene: &SurfaceScene, mesh: &MeshInfo) -> Option<String> {
    let effects = &scene.effects;
    let is_drop = scene.slides() && effects.tension.is_some() && effects.bending.is_none();
    (is_drop && mesh.angles[0] < NARROW).then(|| {
        format!(
            "the mesh of \"{}\" is uneven, with angles from {:.1}°: velocities by surface tension are \
             less accurate there. With 642 vertices the deformation of a drop at Ca = 0.02 was 3.3 % \
             above theory on an irregular mesh, and at most 1.5 % on even ones; with 2562 it was 0.6 % above \
             theory on an irregular mesh: choose the family regular, smooth or relaxed, or more vertices",
            scene.name, mesh.angles[0]
        )
    })
}

/// Warns about a surface that, taken as a sphere about its position, reaches the radius at which a
/// Poiseuille profile reverses.
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
    let reach = distance + mesh.enclosed_radius();
    (reach > radius).then(|| {
        format!(
            "\"{}\" reaches {reach:.3} from the axis, and this Poiseuille flow, which has no walls, \
             turns round at `radius` {radius}: choose a larger one, or a smaller surface nearer to \
             the axis",
            scene.name
        )
    })
}

/// Reports numbers whose squares overflow or underflow: all results would be 0 or infinite.
fn too_large_or_small(scene: &SurfaceScene, mesh: &MeshInfo) -> Option<String> {
    let longest = mesh.edge_lengths[1];
    let area = longest * longest;
    (!(area * area).is_normal()).then(|| {
        format!(
            "edges of \"{}\" are up to {} long, and squares of areas of that size are beyond the \
             numbers of f64: choose other units, or another `scale`",
            scene.name,
            Six(longest)
        )
    })
}
