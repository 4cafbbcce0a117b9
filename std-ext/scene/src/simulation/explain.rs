//! Explanation of a scene: its effects, their dimensionless groups, and the resulting memory, step limits
//! and cost.

mod display;
mod driver;
mod groups;
mod lattice;

pub use lattice::LatticeExplanation;

use crate::generate::ShapeDeviation;
use crate::info::MeshInfo;
use crate::scene::{
    Boundary, Dimension, Driver, Effects, Group, InteractionScene, MeshSource, Parameter,
    Parameters, Relax, Scene, Scheme, Side, SurfaceScene, UnitSystem, thermal_energy,
};
use serde::Serialize;
use std::f64::consts::PI;

/// Result of [`Scene::explain`]; its `Display` shows it as text.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Explanation {
    /// The scene's title.
    pub title: String,
    /// The units of its numbers.
    pub units: UnitSystem,
    /// The temperature in kelvin, if the unit kT is used, and kT in pN·µm.
    pub temperature: Option<[f64; 2]>,
    /// Surface by surface.
    pub surfaces: Vec<SurfaceExplanation>,
    /// Interactions between surfaces.
    pub interactions: Vec<Active>,
    /// The driver.
    pub driver: Active,
    /// The ambient flow, of drivers with a fluid.
    pub flow: Option<Active>,
    /// The integrator and the reason for it; `None` for drivers without time.
    pub integrator: Option<Active>,
    /// The lattice, if the driver has one.
    pub lattice: Option<LatticeExplanation>,
    /// Measurements of a suspension.
    pub rheology: Option<Active>,
    /// Estimate of the spectral radius ρ of the velocities' derivative by positions, 1/time, where
    /// there is a formula: explicit steps are stable up to about 2.5/ρ.
    pub spectral_radius: Option<f64>,
    /// The limit of the time step.
    pub step_limit: String,
    /// Estimate of the memory that the run needs, in bytes.
    pub memory: u64,
}

/// The effects on a surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfaceExplanation {
    /// Its name, or that of a population.
    pub name: String,
    /// The number of surfaces: 1, unless it is a population.
    pub count: usize,
    /// The source of its mesh.
    pub mesh: String,
    /// Number of vertices.
    pub vertices: usize,
    /// Area, volume and lengths of the mesh.
    pub measures: Vec<Parameter>,
    /// The effects that are on.
    pub on: Vec<Active>,
    /// The keys of the effects that are off.
    pub off: Vec<&'static str>,
    /// Dimensionless groups. R is the radius of the sphere with the same area; in flow, a is the
    /// radius of the sphere with the same volume.
    pub groups: Vec<Group>,
    /// Remarks on these groups.
    pub notes: Vec<&'static str>,
    /// Time of one evaluation of the bending force over that of method B.
    pub bending_cost: Option<f64>,
}

/// An effect, interaction or driver that is on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Active {
    /// Its key or kind.
    pub name: &'static str,
    /// The law, method or scheme.
    pub choice: String,
    /// Its numbers.
    pub parameters: Vec<Parameter>,
}

/// Bytes a vertex: mesh, positions, forces, their copies in outputs and checkpoints.
const BASE_BYTES: u64 = 600;
/// Bytes per vertex of the twelve pairs of positions and forces that minimisation keeps.
const MINIMISE_BYTES: u64 = 12 * 2 * 24;
/// Bytes per vertex of sources, centres and tractions of the triangles, and of the stages of a step.
const BOUNDARY_INTEGRAL_BYTES: u64 = 900;
/// Bytes per vertex of the search for near triangles.
const CONTACT_BYTES: u64 = 530;
/// Bytes per vertex of clusters, their moments and sums.
const CLUSTER_BYTES: u64 = 600;

impl Scene {
    /// Explains the scene on these meshes, one per surface, scaled as the scene demands.
    ///
    /// # Panics
    /// If there are fewer meshes than surfaces.
    pub fn explain(&self, meshes: &[MeshInfo]) -> Explanation {
        let surfaces = self.surfaces.iter().zip(meshes);
        assert!(meshes.len() >= self.surfaces.len(), "one mesh a surface");
        let clusters = match driver::cluster_tolerance(&self.driver, meshes) {
            0.0 => 0,
            _ => CLUSTER_BYTES,
        };
        let contact = match self.interactions.is_empty() {
            true => 0,
            false => CONTACT_BYTES,
        };
        let memory = surfaces.clone().map(|(surface, mesh)| {
            let vertices = mesh.vertices as u64;
            let minimises = |relax: &Relax| relax.scheme == Scheme::Minimise;
            let driver = match &self.driver {
                Driver::Relax(relax) if minimises(relax) => MINIMISE_BYTES,
                Driver::Relax(_) | Driver::LatticeBoltzmann(_) => 0,
                Driver::BoundaryIntegral(_) => BOUNDARY_INTEGRAL_BYTES + clusters,
            };
            let effects = surface.effects.iter().map(|(_, effect)| effect.bytes(mesh));
            vertices * (BASE_BYTES + driver + contact + effects.sum::<u64>())
        });
        let [populations, others] = self.lattice_memory();
        let number = Parameters::new(self.units);
        let interaction = |interaction: &InteractionScene| {
            let name = |side: Side| {
                let populations = &mut self.populations.iter();
                if let Some(all) =
                    populations.find(|all| side.count > 1 && all.surfaces == side.range())
                {
                    return all.name.as_str();
                }
                match self.surfaces.get(side.first) {
                    Some(surface) => surface.name.as_str(),
                    None => self.obstacles[side.first - self.surfaces.len()]
                        .name
                        .as_str(),
                }
            };
            Active {
                name: interaction.name(),
                choice: {
                    let own = [
                        (self.driver.images().is_periodic(), "images"),
                        (interaction.parts(), "parts"),
                    ];
                    let own = own.iter().filter(|(acts, _)| *acts);
                    let own = Vec::from_iter(own.map(|&(_, own)| own)).join(" and ");
                    match interaction.between() {
                        Some([a, b]) if a == b && a.count == 1 => {
                            format!("between {} and its {own}", name(a))
                        }
                        Some([a, b]) if a == b => {
                            format!("between all surfaces of {} and their {own}", name(a))
                        }
                        Some([a, b]) => format!("between {} and {}", name(a), name(b)),
                        None if own.is_empty() => "between all surfaces".to_owned(),
                        None => format!("between all surfaces and their {own}"),
                    }
                },
                parameters: match *interaction {
                    InteractionScene::Repulsion {
                        strength, cutoff, ..
                    } => vec![
                        number.of("strength", strength, Dimension::REPULSION),
                        number.of("cutoff", cutoff, Dimension::LENGTH),
                    ],
                    InteractionScene::Adhesion {
                        energy,
                        distance,
                        cutoff,
                        ..
                    } => vec![
                        number.of("energy", energy, Dimension::TENSION),
                        number.of("distance", distance, Dimension::LENGTH),
                        number.of("cutoff", cutoff, Dimension::LENGTH),
                    ],
                },
            }
        };
        let spectral_radius = driver::spectral_radius(self, meshes);
        let lattice = lattice::explain(self, meshes, &number);
        Explanation {
            title: self.title.clone(),
            units: self.units,
            temperature: self
                .temperature
                .map(|kelvin| [kelvin, thermal_energy(kelvin)]),
            surfaces: (surfaces.enumerate())
                .filter(|(index, _)| !self.is_copy(*index))
                .map(|(index, (surface, mesh))| {
                    let explained = explain_surface(surface, mesh, self);
                    match self.population_of(index) {
                        None => explained,
                        Some((_, population)) => SurfaceExplanation {
                            name: population.name.clone(),
                            count: population.count(),
                            ..explained
                        },
                    }
                })
                .collect(),
            interactions: self.interactions.iter().map(interaction).collect(),
            driver: driver::explain(&self.driver, meshes, &number),
            flow: driver::flow(self, &number),
            integrator: driver::integrator(self, &number),
            spectral_radius,
            step_limit: match &lattice {
                Some(lattice) => lattice::step_limit(lattice, &number),
                None => driver::step_limit(self, spectral_radius),
            },
            lattice,
            rheology: lattice::rheology(self),
            // While a checkpoint is written, there are two more copies of the populations.
            memory: memory.sum::<u64>() + 3 * populations + others,
        }
    }
}

fn explain_surface(surface: &SurfaceScene, mesh: &MeshInfo, scene: &Scene) -> SurfaceExplanation {
    let number = Parameters::new(scene.units);
    let radius = (mesh.area / (4.0 * PI)).sqrt();
    let mut measures = vec![
        number.of("area", mesh.area, Dimension::AREA),
        number.of("R", radius, Dimension::LENGTH),
        number.of("shortest edge", mesh.edge_lengths[0], Dimension::LENGTH),
        number.of("longest edge", mesh.edge_lengths[1], Dimension::LENGTH),
    ];
    if let Some(volume) = mesh.volume {
        measures.insert(1, number.of("volume", volume, Dimension::VOLUME));
    }
    let source = match &surface.source {
        MeshSource::Shape {
            shape,
            family,
            match_volume,
            ..
        } => {
            let deviation = ShapeDeviation::new(shape, surface.scale, mesh);
            let percent = |name, value: f64| number.percent(name, 100.0 * value);
            measures.push(percent("area off the exact shape", deviation.area));
            measures.push(percent("volume off the exact shape", deviation.volume));
            let volume = if *match_volume { ", of its volume" } else { "" };
            format!("{shape}, {family}{volume}")
        }
        MeshSource::File(file) => file.to_string(),
    };
    let source = match surface.boundary {
        _ if mesh.boundary_edges == 0 => source,
        Boundary::Free => format!("{source}, with a free edge"),
        Boundary::Hinged => format!("{source}, with a hinged edge"),
        Boundary::Clamped => format!("{source}, with a clamped edge"),
    };
    let source = match surface.remesh {
        Some(remesh) => format!(
            "{source}, replaced when it is worn: {}",
            remesh.words(&number)
        ),
        None => source,
    };
    let source = match surface.topology {
        Some(topology) => format!("{source}; {}", topology.words(&number)),
        None => source,
    };
    let on = surface.effects.iter().map(|(name, effect)| {
        let (choice, parameters) = effect.explain(&number);
        Active {
            name,
            choice,
            parameters,
        }
    });
    let on = Vec::from_iter(on);
    let is_off = |name: &&str| on.iter().all(|active| active.name != *name);
    let off = Effects::NAMES.iter().copied().filter(is_off).collect();
    SurfaceExplanation {
        name: surface.name.clone(),
        count: 1,
        mesh: source,
        vertices: mesh.vertices,
        measures,
        on,
        off,
        groups: groups::groups(surface, mesh, &scene.driver),
        notes: groups::notes(surface, mesh, &scene.driver),
        bending_cost: surface
            .effects
            .bending
            .as_ref()
            .map(|bending| bending.method.cost().relative),
    }
}
