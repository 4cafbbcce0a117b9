//! From a scene to surfaces and effects.

use super::placed::{Placed, scale_to_volume};
use super::stretch::Stretch;
use super::{Between, Body, Obstacle, Simulation};
use crate::dynamics::{Held, Membrane, Motion};
use crate::effect::{Effect, EffectKind, Lumping, Viscosity};
use crate::generate::GenerateError;
use crate::info::MeshInfo;
use crate::io::{ReadError, read};
use crate::scene::{
    self, AreaDifferenceTarget, Driver, Hold, InPlaneLaw, MeshSource, Reference, ReferenceSource,
    SceneError, SceneErrors, SceneFile, SurfaceScene, Target, VolumeTarget,
};
use helfrich::interaction::RepulsionMemory;
use helfrich::shapes::Shape;
use helfrich::{
    AreaDifference, Constraint, ConstraintError, Constraints, Gravity, InPlane, LoadError,
    LocalArea, MembraneViscosity, NeoHookean, OsmoticPressure, Penalty, Quantity, ReferenceError,
    Repulsion, Skalak, StrainEnergy, Surface, SurfaceError, SurfaceTension, Targets, TriangleMesh,
};
use std::f64::consts::PI;
use std::sync::Arc;
use std::time::Duration;

/// Why a scene cannot be made ready. The message is one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// The scene asks something of a mesh that the mesh does not have.
    #[error(transparent)]
    Scene(#[from] SceneErrors),
    /// A mesh cannot be generated.
    #[error("surface \"{surface}\": {source}")]
    Generate {
        /// The surface's name.
        surface: String,
        /// Why.
        source: GenerateError,
    },
    /// A mesh file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A position is out of the range of numbers.
    #[error("surface \"{surface}\": {source}")]
    Positions {
        /// The surface's name.
        surface: String,
        /// Which.
        source: SurfaceError,
    },
    /// A reference shape cannot be used.
    #[error("surface \"{surface}\": {source}")]
    Reference {
        /// The surface's name.
        surface: String,
        /// Why.
        source: ReferenceError,
    },
    /// What is held exactly cannot be had from where the surface starts.
    #[error("surface \"{surface}\": {}", unreachable(constraints, source))]
    Constraints {
        /// The surface's name.
        surface: String,
        /// What is held, as scenes call it.
        constraints: Vec<&'static str>,
        /// Why not.
        source: ConstraintError,
    },
    /// The ends of a surface cannot be loaded.
    #[error("surface \"{surface}\": {source}")]
    Stretching {
        /// The surface's name.
        surface: String,
        /// Why.
        source: LoadError,
    },
}

/// Why constraints, called by these names, are out of reach.
fn unreachable(names: &[&str], error: &ConstraintError) -> String {
    let name = |constraint: usize| names.get(constraint).copied().unwrap_or_default();
    match *error {
        ConstraintError::Dependent { constraint, .. } => format!(
            "from where it starts, `{}` cannot be changed without the others that are held exactly, \
             as the volume of a sphere without its area: begin with another shape, an ellipsoid say",
            name(constraint)
        ),
        ConstraintError::NotReached {
            constraint,
            residual,
            ..
        } => format!(
            "from where it starts, `{}` does not come nearer to its target than {residual:.1e} of it: \
             begin with a shape that is nearer to it",
            name(constraint)
        ),
        error => error.to_string(),
    }
}

/// Makes a scene ready: its surfaces where they start, one surface's positions after the other's,
/// and the effects that it names.
///
/// # Errors
/// If a mesh cannot be had, or does not allow what the scene asks of it; see [`BuildError`].
pub fn build(file: &SceneFile) -> Result<(Simulation, Vec<[f64; 3]>), BuildError> {
    let scene = &file.scene;
    let mut bodies: Vec<Body> = Vec::with_capacity(scene.surfaces.len());
    let mut positions = Vec::new();
    let mut groups = Vec::new();
    let mut group_count = 0;
    let mut held = Vec::new();
    let mut warnings = file.warnings.clone();
    for (index, surface) in scene.surfaces.iter().enumerate() {
        let start = Placed::new(
            &surface.name,
            &surface.source,
            surface.scale,
            surface.orientation,
            surface.position,
        )?;
        let vertices = positions.len()..positions.len() + start.positions.len();
        let body = start.body(file, index, surface, vertices, &mut held, &mut warnings)?;
        let (components, count) = body.mesh.components();
        groups.extend(components.into_iter().map(|group| group + group_count));
        group_count += count as u32;
        positions.extend(start.positions);
        bodies.push(body);
    }
    let all_positions = positions;
    for (index, body) in bodies.iter().enumerate() {
        for (other, second) in bodies
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != index)
        {
            let surfaces = body
                .surface(&all_positions)
                .zip(second.surface(&all_positions));
            if let Some((surface, second)) = surfaces {
                warnings.extend(file.check_outside([index, other], surface, second)?);
            }
        }
    }
    let mut obstacles = Vec::with_capacity(scene.obstacles.len());
    for (index, obstacle) in scene.obstacles.iter().enumerate() {
        let Placed {
            mesh, positions, ..
        } = Placed::new(
            &obstacle.name,
            &obstacle.source,
            obstacle.scale,
            obstacle.orientation,
            obstacle.position,
        )?;
        let surface = Surface::new(&mesh, &positions).map_err(|source| BuildError::Positions {
            surface: obstacle.name.clone(),
            source,
        })?;
        file.check_obstacle(index, &MeshInfo::new(surface))?;
        for (number, body) in bodies.iter().enumerate() {
            if let Some(body) = body.surface(&all_positions) {
                file.check_apart(number, body, index, surface)?;
            }
        }
        obstacles.push(Obstacle {
            name: obstacle.name.clone(),
            mesh,
            positions,
        });
    }
    let between = scene.interactions.iter().map(|interaction| {
        let scene::Interaction::Repulsion {
            strength,
            cutoff,
            between,
        } = *interaction;
        let mut between =
            between.map_or_else(|| Vec::from_iter(0..bodies.len()), |pair| pair.to_vec());
        between.sort_unstable();
        Between {
            repulsion: Repulsion {
                modulus: strength,
                range: cutoff,
            },
            bodies: between,
            memory: RepulsionMemory::default(),
            evaluations: 0,
            time: Duration::ZERO,
        }
    });
    let between = between.collect();
    let mut simulation = Simulation {
        bodies,
        between,
        obstacles,
        groups,
        held,
        warnings,
    };
    simulation.set_load(0);
    Ok((simulation, all_positions))
}

impl Placed {
    fn body(
        &self,
        file: &SceneFile,
        index: usize,
        scene: &SurfaceScene,
        vertices: std::ops::Range<usize>,
        all_held: &mut Vec<Quantity>,
        warnings: &mut Vec<SceneError>,
    ) -> Result<Body, BuildError> {
        let surface =
            Surface::new(&self.mesh, &self.positions).map_err(|source| BuildError::Positions {
                surface: scene.name.clone(),
                source,
            })?;
        let info = MeshInfo::new(surface);
        file.check_mesh(index, &info)?;
        warnings.extend(file.mesh_warnings(index, &info));
        let mut constraints = Vec::new();
        let mut effects = Vec::new();
        if let Some(scene::Bending {
            method,
            modulus,
            spontaneous_curvature,
        }) = scene.bending
        {
            effects.push(Effect::bending(
                method,
                modulus,
                spontaneous_curvature,
                match file.scene.driver {
                    Driver::Relax(_) => Lumping::Own,
                    Driver::BoundaryIntegral(_) | Driver::LatticeBoltzmann(_) => Lumping::Thirds,
                },
                surface,
            ));
        }
        if let Some(elasticity) = &scene.elasticity {
            let reference = self.reference(file, index, &elasticity.reference)?;
            effects.push(self.in_plane(
                scene,
                EffectKind::Elasticity,
                elasticity.law,
                &reference,
                elasticity.reference.scale,
            )?);
        }
        if let Some(local_area) = &scene.local_area {
            let reference = self.reference(file, index, &local_area.reference)?;
            let law = LocalArea {
                area_modulus: local_area.modulus,
            };
            effects.push(self.law(
                scene,
                EffectKind::LocalArea,
                law,
                &reference,
                local_area.reference.scale,
            )?);
        }
        let areas = match scene.area {
            Some(scene::Held {
                target: Target::Value(area),
                ..
            }) => Targets::Same(area),
            _ => Targets::measured(&Quantity::Area, surface),
        };
        let mut hold = |hold, kind, quantity, targets: Targets<f64>| match hold {
            Hold::Exact => constraints.push(Constraint {
                functional: quantity,
                targets,
            }),
            Hold::Penalty(modulus) => {
                let penalty = Penalty::new(quantity, modulus, targets);
                effects.push(Effect::conservative(kind, penalty, &self.mesh));
            }
        };
        if let Some(area) = scene.area {
            hold(area.hold, EffectKind::Area, Quantity::Area, areas.clone());
        }
        if let Some(volume) = scene.volume {
            let targets = match volume.target {
                VolumeTarget::Initial => Targets::measured(&Quantity::Volume, surface),
                VolumeTarget::Value(volume) => Targets::Same(volume),
                VolumeTarget::Reduced(reduced) => {
                    map(&areas, |area| reduced * area.powf(1.5) / (6.0 * PI.sqrt()))
                }
            };
            hold(volume.hold, EffectKind::Volume, Quantity::Volume, targets);
        }
        if let Some(difference) = scene.area_difference {
            let targets = match difference.target {
                AreaDifferenceTarget::Initial => {
                    Targets::measured(&Quantity::MeanCurvature, surface)
                }
                AreaDifferenceTarget::Value(integral) => Targets::Same(integral),
                AreaDifferenceTarget::Reduced(reduced) => {
                    map(&areas, |area| reduced * (4.0 * PI * area).sqrt())
                }
            };
            match difference.hold {
                Hold::Exact => constraints.push(Constraint {
                    functional: Quantity::MeanCurvature,
                    targets,
                }),
                Hold::Penalty(modulus) => effects.push(Effect::conservative(
                    EffectKind::AreaDifference,
                    AreaDifference::new(modulus, targets),
                    &self.mesh,
                )),
            }
        }
        if let Some(tension) = scene.tension {
            let method = SurfaceTension::new(tension);
            effects.push(Effect::conservative(
                EffectKind::Tension,
                method,
                &self.mesh,
            ));
        }
        if let Some(pressure) = scene.pressure {
            let method = OsmoticPressure::new(pressure);
            effects.push(Effect::conservative(
                EffectKind::Pressure,
                method,
                &self.mesh,
            ));
        }
        if let Some(gravity) = scene.gravity {
            let method = Gravity {
                weight: gravity
                    .acceleration
                    .map(|acceleration| gravity.density_difference * acceleration),
                level: scene.position,
            };
            effects.push(Effect::conservative(
                EffectKind::Gravity,
                method,
                &self.mesh,
            ));
        }
        let stretch = match &scene.stretching {
            None => None,
            Some(stretching) => {
                let mut stretch =
                    Stretch::new(surface, stretching).map_err(|source| BuildError::Stretching {
                        surface: scene.name.clone(),
                        source,
                    })?;
                let loads = stretch.set(0);
                effects.push(Effect::conservative(
                    EffectKind::Stretching,
                    loads,
                    &self.mesh,
                ));
                Some(stretch)
            }
        };
        let places = constraints.iter().map(|constraint: &Constraint<f64>| {
            let quantity = constraint.functional;
            let known = all_held.iter().position(|&held| held == quantity);
            known.unwrap_or_else(|| {
                all_held.push(quantity);
                all_held.len() - 1
            })
        });
        let places = places.collect();
        let names = constraints
            .iter()
            .map(|constraint| match constraint.functional {
                Quantity::Area => "area",
                Quantity::Volume => "volume",
                Quantity::MeanCurvature => "area_difference",
            });
        let names = names.collect();
        let mesh = Arc::new(self.mesh.clone());
        let mut held = Held::new(Arc::clone(&mesh), Constraints { constraints });
        // Not after a first row has been written.
        held.restore(&mut self.positions.clone())
            .map_err(|source| BuildError::Constraints {
                surface: scene.name.clone(),
                constraints: names,
                source,
            })?;
        Ok(Body {
            name: scene.name.clone(),
            membrane: membrane(&mesh, scene),
            held,
            places,
            mesh,
            vertices,
            effects,
            viscosity: scene.membrane_viscosity.map(|viscosity| {
                let scene::MembraneViscosity { shear, dilational } = viscosity;
                Viscosity::new(MembraneViscosity { shear, dilational }, &self.mesh)
            }),
            stretch,
        })
    }

    /// The positions of a reference.
    fn reference(
        &self,
        file: &SceneFile,
        index: usize,
        reference: &Reference,
    ) -> Result<Vec<[f64; 3]>, BuildError> {
        match &reference.source {
            ReferenceSource::Initial => Ok(self.unplaced.clone()),
            ReferenceSource::Shape(shape) => {
                let preimages = self.preimages.iter().flatten();
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
            ReferenceSource::File(path) => {
                let reference = read(path)?;
                file.check_reference(index, &self.mesh, &reference.mesh)?;
                Ok(reference.positions)
            }
        }
    }

    fn in_plane(
        &self,
        scene: &SurfaceScene,
        kind: EffectKind,
        law: InPlaneLaw,
        reference: &[[f64; 3]],
        scale: f64,
    ) -> Result<Effect, BuildError> {
        match law {
            InPlaneLaw::NeoHookean { shear_modulus } => {
                let law = NeoHookean { shear_modulus };
                self.law(scene, kind, law, reference, scale)
            }
            InPlaneLaw::Skalak {
                shear_modulus,
                area_ratio,
            } => {
                let law = Skalak {
                    shear_modulus,
                    area_ratio,
                };
                self.law(scene, kind, law, reference, scale)
            }
        }
    }

    fn law<W>(
        &self,
        scene: &SurfaceScene,
        kind: EffectKind,
        law: W,
        reference: &[[f64; 3]],
        scale: f64,
    ) -> Result<Effect, BuildError>
    where
        W: StrainEnergy<f64> + std::fmt::Debug + 'static,
    {
        let reference =
            Surface::new(&self.mesh, reference).map_err(|source| BuildError::Positions {
                surface: scene.name.clone(),
                source,
            })?;
        let law = InPlane::new(law, &self.mesh, reference)
            .and_then(|law| law.with_scaled_reference(scale))
            .map_err(|source| BuildError::Reference {
                surface: scene.name.clone(),
                source,
            })?;
        Ok(Effect::conservative(kind, law, &self.mesh))
    }
}

/// What the relaxation has to know of a surface.
fn membrane(mesh: &Arc<TriangleMesh>, scene: &SurfaceScene) -> Membrane {
    let elasticity = scene.elasticity.as_ref();
    let penalty = |hold: Option<Hold>| match hold {
        Some(Hold::Penalty(modulus)) => modulus,
        _ => 0.0,
    };
    let in_plane = [
        elasticity.map_or(0.0, |elasticity| elasticity.law.area_modulus()),
        scene.local_area.as_ref().map_or(0.0, |law| law.modulus),
        penalty(scene.area.map(|area| area.hold)),
        scene.tension.unwrap_or(0.0).abs(),
    ];
    let solid = elasticity.is_some() || scene.local_area.is_some();
    Membrane {
        mesh: Arc::clone(mesh),
        bending_modulus: scene.bending.map_or(0.0, |bending| bending.modulus),
        in_plane_modulus: in_plane.into_iter().fold(0.0, f64::max),
        motion: if solid {
            Motion::Free
        } else {
            Motion::AlongNormals
        },
    }
}

fn map(targets: &Targets<f64>, f: impl Fn(f64) -> f64) -> Targets<f64> {
    match targets {
        Targets::Same(target) => Targets::Same(f(*target)),
        Targets::PerComponent(targets) => {
            Targets::PerComponent(targets.iter().map(|&target| f(target)).collect())
        }
    }
}
