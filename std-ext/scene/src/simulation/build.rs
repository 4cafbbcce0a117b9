//! Builds a simulation from a scene.

use super::error::BuildError;
use super::once::said_once;
use super::placed::{Placed, scale_to_volume};
use super::{Acts, Body, Obstacle, Repulsions, Simulation};
use crate::dynamics::{Held, Membrane, Motion};
use crate::effect::Lumping;
use crate::enclosure::Bounded;
use crate::execute::{Parallel, Shares};
use crate::info::MeshInfo;
use crate::io::Column;
use crate::ordered::Ordered;
use crate::scene::{
    self, Driver, Effects, HeldTargets, MeshFiles, MeshSource, Preparation, Reference,
    ReferenceSource, Scene, SceneError, SceneFile, Side, Stretch, SurfaceScene, start_shape,
};
use helfrich::interaction::RepulsionMemory;
use helfrich::shapes::Shape;
use helfrich::{
    AnyFunctional, Constraint, ConstraintError, Constraints, Images, Repulsion, Surface,
    TriangleMesh,
};
use helfrich_execute::team::Division;
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

/// Prepares a scene: its surfaces and effects, and the initial positions of all surfaces, one
/// surface after the other.
///
/// # Errors
/// If a mesh cannot be generated or read, or does not meet the requirements of the scene; see
/// [`BuildError`].
pub fn build(file: &SceneFile) -> Result<(Simulation, Vec<[f64; 3]>), BuildError> {
    let scene = &file.scene;
    let mut files = file.meshes.clone();
    let mut bodies: Vec<Body> = Vec::with_capacity(scene.surfaces.len());
    let mut positions = Vec::new();
    let mut previous = None::<Placed>;
    let mut groups = Vec::new();
    let mut group_count = 0;
    let mut held = Vec::new();
    let mut warnings = file.warnings.clone();
    for (index, surface) in scene.surfaces.iter().enumerate() {
        let start = match previous.take().filter(|_| scene.is_copy(index)) {
            Some(same) => same.moved(surface.orientation, surface.position),
            None => Placed::new(
                &surface.name,
                &surface.source,
                surface.scale,
                surface.orientation,
                surface.position,
                &mut files,
                surface.averages_noise(),
            )?,
        };
        if let Some(quieted) = &start.quieted {
            warnings.push(file.noise_warning(index, quieted));
        }
        let vertices = positions.len()..positions.len() + start.positions.len();
        let mut context = Context {
            file,
            files: &mut files,
            held: &mut held,
            warnings: &mut warnings,
        };
        let body = start.body(&mut context, index, surface, vertices)?;
        let (components, count) = body.mesh.components();
        groups.extend(components.into_iter().map(|group| group + group_count));
        group_count += count as u32;
        positions.extend_from_slice(&start.positions);
        bodies.push(body);
        previous = Some(start);
    }
    let bounded = bodies.iter().enumerate();
    let bounded = bounded.filter_map(|(index, body)| {
        let surface = body.surface(&positions)?;
        Some((index, Bounded::from(surface)))
    });
    let bounded = Vec::from_iter(bounded);
    for (index, surface) in &bounded {
        for (other, second) in bounded.iter().filter(|(other, _)| other != index) {
            warnings.extend(file.check_outside([*index, *other], surface, second));
        }
    }
    let obstacles = obstacles(file, &bounded, &mut files, &mut warnings)?;
    let images = scene.driver.images();
    let between = scene.interactions.iter();
    let met = scene.driver.meets_obstacles();
    let count = [bodies.len(), if met { obstacles.len() } else { 0 }];
    let between =
        between.map(|interaction| between_bodies(interaction, &bodies, &obstacles, count, images));
    let between = between.collect();
    let names = Vec::from_iter(scene.surfaces.iter().map(|surface| surface.name.as_str()));
    let warnings = said_once(warnings, &names);
    let mut simulation = Simulation {
        bodies,
        between,
        obstacles,
        images,
        groups,
        held,
        warnings,
        acting: Shares::default(),
        resisting: Shares::default(),
        division: Division::alone(),
        own: Vec::new(),
    };
    simulation.set_load(0);
    Ok((simulation, positions))
}

/// The obstacles, where they stand, and doubts about them.
fn obstacles(
    file: &SceneFile,
    bodies: &[(usize, Bounded<'_>)],
    files: &mut MeshFiles,
    warnings: &mut Vec<SceneError>,
) -> Result<Vec<Obstacle>, BuildError> {
    let mut obstacles = Vec::with_capacity(file.scene.obstacles.len());
    for (index, obstacle) in file.scene.obstacles.iter().enumerate() {
        let start = Placed::new(
            &obstacle.name,
            &obstacle.source,
            obstacle.scale,
            obstacle.orientation,
            obstacle.position,
            files,
            false,
        )?;
        let surface = Surface::new(&start.mesh, &start.positions).map_err(|source| {
            BuildError::Positions {
                surface: obstacle.name.clone(),
                source,
            }
        })?;
        let info = MeshInfo::new(surface);
        file.check_obstacle(index, &info)?;
        warnings.extend(file.obstacle_warning(index, &info));
        let bounded = Bounded::from(surface);
        for (number, body) in bodies {
            file.check_apart([*number, index], body, &bounded)?;
        }
        obstacles.push(Obstacle {
            name: obstacle.name.clone(),
            mesh: start.mesh,
            positions: start.positions,
        });
    }
    Ok(obstacles)
}

/// An interaction of these bodies; of the first `count` of each unless it names two sides.
fn between_bodies(
    interaction: &scene::InteractionScene,
    bodies: &[Body],
    obstacles: &[Obstacle],
    count: [usize; 2],
    images: Images<f64>,
) -> Repulsions {
    let between = interaction.between();
    let [moving, resting] = count;
    let all = || (0..moving).chain((0..resting).map(|number| bodies.len() + number));
    let mut acting = match between {
        None => Vec::from_iter(all()),
        Some(sides) => Vec::from_iter(sides.into_iter().flat_map(Side::range)),
    };
    acting.sort_unstable();
    acting.dedup();
    // Of two sides that differ, the first in this order.
    let sides = between.filter(|[a, b]| a != b);
    let first = sides.and_then(|sides| sides.into_iter().min_by_key(|side| side.first));
    let (moving, resting) =
        acting.split_at(acting.partition_point(|&number| number < bodies.len()));
    let solids = resting.iter().map(|number| {
        let obstacle = &obstacles[number - bodies.len()];
        let forces = vec![[0.0; 3]; obstacle.positions.len()];
        (number - bodies.len(), forces)
    });
    Repulsions {
        name: interaction.name(),
        repulsion: Repulsion {
            images: Images {
                own: between.is_none_or(|[a, b]| a == b),
                ..images
            },
            first_group: first.map(|side| side.count),
            ..interaction.pressure()
        },
        bodies: moving.to_vec(),
        solids: solids.collect(),
        memory: RepulsionMemory::default(),
        own_memory: RepulsionMemory::default(),
        execution: Parallel::new(),
        evaluations: 0,
        time: Duration::ZERO,
    }
}

/// The scene of a surface that is made ready, and what all surfaces share.
struct Context<'a> {
    file: &'a SceneFile,
    files: &'a mut MeshFiles,
    held: &'a mut Vec<AnyFunctional>,
    warnings: &'a mut Vec<SceneError>,
}

impl Placed {
    fn body(
        &self,
        context: &mut Context<'_>,
        index: usize,
        scene: &SurfaceScene,
        vertices: Range<usize>,
    ) -> Result<Body, BuildError> {
        let file = context.file;
        let surface =
            Surface::new(&self.mesh, &self.positions).map_err(|source| BuildError::Positions {
                surface: scene.name.clone(),
                source,
            })?;
        let info = MeshInfo::new(surface);
        file.check_mesh(index, &info)?;
        context.warnings.extend(file.mesh_warnings(index, &info));
        let mut unstressed = |effect: &str, reference: &Reference| {
            self.reference(file, context.files, index, effect, reference)
        };
        Preparing {
            scene,
            driver: &file.scene.driver,
            effects: &scene.effects,
            mesh: &self.mesh,
            positions: &self.positions,
            targets: Vec::new(),
            ratios: Vec::new(),
            unstressed: &mut unstressed,
            held: context.held,
        }
        .body(vertices)
    }

    /// The positions of a reference.
    fn reference(
        &self,
        file: &SceneFile,
        files: &mut MeshFiles,
        index: usize,
        effect: &str,
        reference: &Reference,
    ) -> Result<Vec<[f64; 3]>, BuildError> {
        match &reference.source {
            ReferenceSource::Initial => Ok(self.unplaced.to_vec()),
            ReferenceSource::Shape(shape) => {
                let preimages = self.preimages.iter().flat_map(|all| all.iter());
                let mut positions = Vec::from_iter(preimages.map(|&at| shape.position(at)));
                let source = &file.scene.surfaces[index].source;
                if matches!(
                    source,
                    MeshSource::Shape {
                        match_volume: true,
                        ..
                    }
                ) {
                    scale_to_volume(&self.mesh, &mut positions, shape.volume());
                }
                Ok(positions)
            }
            ReferenceSource::File(source) => {
                let reference = files.read(source)?;
                file.check_reference(index, effect, &self.mesh, &reference.mesh)?;
                Ok(reference.positions.clone())
            }
        }
    }
}

/// Gives the positions of the reference of an effect, by its name.
type Unstressed<'a> = dyn FnMut(&str, &Reference) -> Result<Vec<[f64; 3]>, BuildError> + 'a;

/// A surface on a mesh, of which a body is prepared.
struct Preparing<'a> {
    scene: &'a SurfaceScene,
    driver: &'a Driver,
    /// The effects, with columns of this mesh.
    effects: &'a Effects,
    mesh: &'a Arc<TriangleMesh>,
    positions: &'a [[f64; 3]],
    /// Targets that are known from an earlier mesh.
    targets: Vec<HeldTargets>,
    /// See [`BodyMesh::ratios`].
    ratios: Vec<[f64; 2]>,
    /// The positions of the reference of an effect.
    unstressed: &'a mut Unstressed<'a>,
    held: &'a mut Vec<AnyFunctional>,
}

impl Preparing<'_> {
    fn body(&mut self, vertices: Range<usize>) -> Result<Body, BuildError> {
        // Components keep their order, in which targets and ratios are.
        let keeps = !self.targets.is_empty() || !self.ratios.is_empty();
        let is_one = !keeps || self.mesh.components().1 < 2;
        match Ordered::of(self.mesh).filter(|_| is_one) {
            None => self.body_in(None, vertices),
            // Messages name the vertices of the scene's mesh.
            ordered => self
                .body_in(ordered, vertices.clone())
                .or_else(|_| self.body_in(None, vertices)),
        }
    }

    /// A body whose effects are evaluated in this order, or that of its mesh.
    fn body_in(
        &mut self,
        ordered: Option<Ordered<f64>>,
        vertices: Range<usize>,
    ) -> Result<Body, BuildError> {
        let (scene, effects) = (self.scene, self.effects);
        let order = ordered.as_ref().map(Ordered::order);
        let in_order = |values: Vec<[f64; 3]>| match order {
            Some(order) => order.apply(&values),
            None => values,
        };
        let own = ordered.as_ref().map_or(self.mesh, Ordered::mesh);
        let positions = in_order(self.positions.to_vec());
        let surface = Surface::new(own, &positions).map_err(|source| BuildError::Positions {
            surface: scene.name.clone(),
            source,
        })?;
        let relaxes = matches!(self.driver, Driver::Relax(_));
        let mut preparation = Preparation {
            surface,
            order,
            position: scene.position,
            lumping: if relaxes {
                Lumping::Own
            } else {
                Lumping::Thirds
            },
            geometry: scene.effects.geometry(self.driver),
            siblings: effects,
            unstressed: Vec::new(),
            forces: Vec::new(),
            constraints: Vec::new(),
            targets: self.targets.clone(),
            ratios: &self.ratios,
            viscosity: None,
            stretch: None,
        };
        for (name, effect) in effects.iter() {
            if let Some(reference) = effect.reference() {
                preparation.unstressed = in_order((self.unstressed)(name, reference)?);
            }
            let prepared = effect.prepare(&mut preparation);
            prepared.map_err(|source| BuildError::Effect {
                surface: scene.name.clone(),
                source,
            })?;
        }
        let Preparation {
            forces,
            constraints,
            targets,
            viscosity,
            stretch,
            ..
        } = preparation;
        let (names, constraints): (Vec<_>, Vec<_>) = constraints.into_iter().unzip();
        let places = constraints.iter().map(|constraint: &Constraint<f64>| {
            let quantity = constraint.functional;
            let known = self.held.iter().position(|&held| held == quantity);
            known.unwrap_or_else(|| {
                self.held.push(quantity);
                self.held.len() - 1
            })
        });
        let places = places.collect();
        let mut held = Held::new(Arc::clone(own), Constraints { constraints });
        // Checked here, and not after a first row has been written.
        if let Err(source) = held.restore(&mut positions.clone()) {
            let is_far = relaxes && matches!(source, ConstraintError::NotReached { .. });
            if !(is_far && can_approach(&mut held, &positions)) {
                return Err(BuildError::Constraints {
                    surface: scene.name.clone(),
                    constraints: names,
                    start: start_shape(scene, 0.0).map(|shape| shape.to_string()),
                    source,
                });
            }
        }
        Ok(Body {
            name: scene.name.clone(),
            membrane: membrane(self.mesh, scene),
            acts: Acts {
                effects: forces,
                viscosity,
                held,
            },
            ordered,
            places,
            mesh: Arc::clone(self.mesh),
            vertices,
            stretch,
            targets,
            ratios: self.ratios.clone(),
            columns: effects.columns().into_iter().cloned().collect(),
            energies: None,
        })
    }
}

/// A new mesh of one surface of a scene.
#[derive(Clone, Debug)]
pub struct BodyMesh {
    /// The mesh.
    pub mesh: TriangleMesh,
    /// The positions of its vertices.
    pub positions: Vec<[f64; 3]>,
    /// The values of the columns of [`Body::columns`] on it, in their order.
    pub columns: Vec<Vec<f64>>,
    /// Area and volume of each component of the smooth surface through the vertices over those of the flat triangles:
    /// exactly held areas and volumes are those of the smooth surface. Empty if they are those of the triangles.
    pub ratios: Vec<[f64; 2]>,
}

impl Simulation {
    /// Prepares the effects on one of the surfaces for a new mesh. The load and the costs of effects stay. Targets of held
    /// quantities are given, in the order of the components, or found anew from this mesh. Nothing has changed if this fails.
    ///
    /// # Errors
    /// If an effect cannot be prepared for the mesh, or remembers positions of the material.
    ///
    /// # Panics
    /// If there is no such surface, or the numbers of columns or of their values are wrong.
    pub fn replace_mesh(
        &mut self,
        scene: &Scene,
        index: usize,
        new: BodyMesh,
        targets: Vec<HeldTargets>,
    ) -> Result<(), BuildError> {
        let BodyMesh {
            mesh,
            positions,
            columns,
            ratios,
        } = new;
        let old = &self.bodies[index];
        let columns = old.columns.iter().zip(columns);
        let columns = columns.map(|(column, values)| {
            Arc::new(Column {
                values,
                ..Column::clone(column)
            })
        });
        let scene_of = &scene.surfaces[index];
        let effects = scene_of.effects.with_columns(&Vec::from_iter(columns));
        let solid = |_: &str, _: &Reference| -> Result<Vec<[f64; 3]>, BuildError> {
            // The reader of scenes refuses new meshes of solid surfaces.
            Ok(positions.clone())
        };
        let first = old.vertices.start;
        let vertices = first..first + positions.len();
        let (mut held, mut unstressed) = (self.held.clone(), solid);
        let mut body = Preparing {
            scene: scene_of,
            driver: &scene.driver,
            effects: &effects,
            mesh: &Arc::new(mesh),
            positions: &positions,
            targets,
            ratios,
            unstressed: &mut unstressed,
            held: &mut held,
        }
        .body(vertices)?;
        for (effect, old) in body.acts.effects.iter_mut().zip(&old.acts.effects) {
            effect.continue_cost(old);
        }
        let load = old.stretch.as_ref().map(Stretch::current);
        self.bodies[index] = body;
        self.held = held;
        let mut first = 0;
        let (mut groups, mut group_count) = (Vec::new(), 0);
        for body in &mut self.bodies {
            body.vertices = first..first + body.mesh.vertex_count();
            first = body.vertices.end;
            let (components, count) = body.mesh.components();
            groups.extend(components.into_iter().map(|group| group + group_count));
            group_count += count as u32;
        }
        self.groups = groups;
        for between in &mut self.between {
            between.memory = RepulsionMemory::default();
        }
        if let Some(load) = load {
            self.set_load(load);
        }
        Ok(())
    }
}

/// The fraction of the way to targets that has to be possible at once, if all of it is not.
const REACHABLE: f64 = 0.125;

/// Whether constrained values can come nearer to targets that they cannot reach at once. A relaxation
/// approaches these in steps.
fn can_approach(held: &mut Held, positions: &[[f64; 3]]) -> bool {
    let starts = held.values(positions);
    held.approach(&starts, REACHABLE);
    let is_reached = held.restore(&mut positions.to_vec()).is_ok();
    held.approach(&starts, 1.0);
    is_reached
}

/// Properties of a surface that the relaxation needs.
fn membrane(mesh: &Arc<TriangleMesh>, scene: &SurfaceScene) -> Membrane {
    let stiffness = scene.effects.iter().map(|(_, effect)| effect.stiffness());
    let in_plane = stiffness.map(|own| own.area.max(own.tension.abs()));
    Membrane {
        mesh: Arc::clone(mesh),
        bending_modulus: scene.effects.stiffness().bending,
        in_plane_modulus: in_plane.fold(0.0, f64::max),
        motion: if scene.is_fluid() {
            Motion::AlongNormals
        } else {
            Motion::Free
        },
        fixed: scene.boundary.fixed(mesh),
    }
}
