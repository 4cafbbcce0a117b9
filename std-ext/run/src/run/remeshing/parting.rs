//! Surfaces that part, and surfaces that join.

use super::super::RunError;
use super::super::drive::Drive;
use super::event::{Remeshing, measured};
use super::meshes::ratios_to_flat;
use super::{Remesher, WORN};
use crate::held::{Quantity, reach_volumes};
use crate::io::ColumnPlace;
use crate::parting::{Break, Parted, joined, parted};
use crate::scene::{Scene, Topology};
use crate::simulation::{BodyMesh, Simulation};
use helfrich::{AnyFunctional, Surface, Targets};

/// The radius of the hole in a film that breaks, in mean edges and in radii of necks that are cut: its rim is no neck.
const HOLE: f64 = 2.0;

impl Remesher {
    /// Parts or joins each surface that may, where it or a film is thin enough, at one place; true if a surface has changed.
    pub(in crate::run) fn part(
        &mut self,
        scene: &Scene,
        simulation: &mut Simulation,
        drive: &mut dyn Drive,
    ) -> Result<bool, RunError> {
        let mut changed = false;
        for index in 0..self.topologies.len() {
            let Some(topology) = self.topologies[index] else {
                continue;
            };
            let (mark, before) = (drive.mark(), drive.positions().to_vec());
            let body = &simulation.bodies()[index];
            let Some(surface) = body.surface(&before) else {
                continue;
            };
            let Some(mut parts) = changed_topology(surface, topology) else {
                continue;
            };
            let (components, _) = body.mesh().components();
            let (groups, count) = parts.mesh.components();
            let mut parents = vec![Vec::new(); count];
            for (&group, &old) in groups.iter().zip(&parts.vertices) {
                let (parents, parent) = (&mut parents[group as usize], components[old as usize]);
                if !parents.contains(&parent) {
                    parents.push(parent);
                }
            }
            // Positions between others are finite.
            let Ok(flat) = Surface::new(&parts.mesh, &parts.flat) else {
                continue;
            };
            let volume = AnyFunctional::Volume;
            let volumes = match parts.change {
                Break::Neck | Break::Hole => {
                    Quantity::new(volume, &parts.mesh).values(flat).to_vec()
                }
                Break::Film => {
                    let mut quantity = Quantity::new(volume, body.mesh());
                    let old = quantity.values(surface);
                    let own = |parents: &Vec<u32>| {
                        parents.iter().map(|&old_one| old[old_one as usize]).sum()
                    };
                    parents.iter().map(own).collect()
                }
            };
            if let Err(error) = reach_volumes(&volumes, &parts.mesh, &mut parts.positions) {
                self.note(index, simulation, drive, &error.to_string());
                continue;
            }
            let geometry = scene.surfaces[index].effects.geometry(&scene.driver);
            let columns = body.columns().iter().map(|column| {
                let old = match column.place {
                    ColumnPlace::Triangles => &parts.triangles,
                    ColumnPlace::Vertices => &parts.vertices,
                };
                old.iter().map(|&old| column.values[old as usize]).collect()
            });
            let columns = columns.collect();
            let Ok(own) = Surface::new(&parts.mesh, &parts.positions) else {
                continue;
            };
            let targets = body.targets().iter();
            let targets = Vec::from_iter(targets.map(|held| held.of_parts(&parents, own)));
            let values = targets.iter().map(|held| match &held.targets {
                Targets::Same(target) => vec![*target; count],
                Targets::PerComponent(targets) => targets.clone(),
            });
            let values = values.collect();
            let ratios = match self.wanted[index] {
                Some(wanted) if wanted.smooth => ratios_to_flat(own),
                _ => Vec::new(),
            };
            let measured = measured(simulation, index, geometry, &before);
            let made = BodyMesh {
                columns,
                ratios,
                mesh: parts.mesh,
                positions: parts.positions,
            };
            if let Err(error) = self.install(index, scene, simulation, drive, made, targets)? {
                self.note(index, simulation, drive, &error);
                continue;
            }
            changed = true;
            let state = &mut self.state.surfaces[index];
            // Caps are uneven.
            state.limit = WORN;
            state.targets = Some(values);
            let after = self::measured(simulation, index, geometry, drive.positions());
            let name = &scene.surfaces[index].name;
            let event = Remeshing::of(name, mark.time, Some(parts.change), [measured, after]);
            self.state.events.push(event);
        }
        Ok(changed)
    }
}

/// The surface after the first change that may happen.
fn changed_topology(surface: Surface<'_, f64>, topology: Topology) -> Option<Parted> {
    let edge = mean_edge(surface);
    let [neck, film] = [topology.neck, topology.film].map(|extent| Some(extent?.of(edge)));
    let parts = neck.and_then(|radius| parted(surface, radius));
    parts.or_else(|| joined(surface, film?, HOLE * edge.max(neck.unwrap_or(0.0))))
}

/// The mean length of the edges of a surface.
fn mean_edge(surface: Surface<'_, f64>) -> f64 {
    let edges = surface.mesh().edges();
    let lengths = edges.iter().map(|&[from, to]| {
        let [x, y, z] = surface.difference(from, to);
        x.hypot(y).hypot(z)
    });
    lengths.sum::<f64>() / edges.len() as f64
}
