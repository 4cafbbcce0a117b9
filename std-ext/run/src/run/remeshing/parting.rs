//! Surfaces that part.

use super::super::RunError;
use super::super::drive::Drive;
use super::event::{Remeshing, measured};
use super::meshes::ratios_to_flat;
use super::{Remesher, WORN};
use crate::held::keep_volumes;
use crate::io::ColumnPlace;
use crate::parting::parted;
use crate::scene::{Scene, Topology};
use crate::simulation::{BodyMesh, Simulation};
use helfrich::{Surface, Targets};

impl Remesher {
    /// Parts each surface that may break, where it is thin enough, at one place; true if a surface has parted.
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
            let radius = match topology {
                Topology::MayBreak => mean_edge(surface),
                Topology::Radius(radius) => radius,
            };
            let Some(mut parts) = parted(surface, radius) else {
                continue;
            };
            // Positions between others are finite.
            let Ok(flat) = Surface::new(&parts.mesh, &parts.flat) else {
                continue;
            };
            if let Err(error) = keep_volumes(flat, &mut parts.positions) {
                self.note(index, simulation, drive, &error.to_string());
                continue;
            }
            let geometry = scene.surfaces[index].effects.geometry(&scene.driver);
            let (components, _) = body.mesh().components();
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
            let (groups, count) = parts.mesh.components();
            let mut parents = vec![0; count];
            for (&group, &old) in groups.iter().zip(&parts.vertices) {
                parents[group as usize] = components[old as usize];
            }
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

/// The mean length of the edges of a surface.
fn mean_edge(surface: Surface<'_, f64>) -> f64 {
    let edges = surface.mesh().edges();
    let lengths = edges.iter().map(|&[from, to]| {
        let [x, y, z] = surface.difference(from, to);
        x.hypot(y).hypot(z)
    });
    lengths.sum::<f64>() / edges.len() as f64
}
