//! New meshes of surfaces whose triangles have become narrow, and of surfaces that part.
//!
//! An event is between two steps: the vertices of a new mesh are put on the smooth surface through the old ones, columns
//! are carried to them, and the effects are prepared for it. The volume of each closed component stays the same to
//! rounding, and the driver restores quantities that are held exactly. All depends on positions alone, so that a
//! continued run repeats its events bit for bit.

mod event;
mod meshes;
mod parting;
mod wanted;

pub use event::Remeshing;

use super::RunError;
use super::deformed::smallest_angle;
use super::drive::Drive;
use crate::remesh::RemeshError;
use crate::scene::{HeldTargets, Scene, Topology};
use crate::simulation::{Body, BodyMesh, Simulation};
use event::measured;
use helfrich::{Targets, TriangleMesh};
use meshes::{holds_triangles, new_mesh, same_mesh};
use serde::{Deserialize, Serialize};
use wanted::Wanted;

/// The smallest angle, in degrees, below which a mesh is replaced. New meshes have 35 to 42.
const WORN: f64 = 26.0;

/// The part of the smallest angle after an event below which the next is due, if the new mesh is not better than [`WORN`].
const FARTHER: f64 = 0.8;

/// The smallest angle of a new mesh, in degrees, below which it does not resolve the surface: even ones have four times as
/// much.
const HOPELESS: f64 = 10.0;

/// The part of the largest angle between triangles after an event above which the next is due, if the new mesh turns by more
/// than is wanted.
const TURNED: f64 = 1.3;

/// The ratio between the numbers of vertices that a surface is to have for its area, now and with its present mesh, or its
/// inverse, above which a mesh is replaced.
const GROWN: f64 = 1.25;

/// The part of the difference between the smooth surface and its flat triangles by which held areas and volumes may be off:
/// far less than the errors of methods, which are of the same order.
const SETTLED: f64 = 0.01;

/// Steps from one such measurement to the next; there is one at the end, too.
const MEASURED: u64 = 50;

/// The columns of a surface with this key.
pub(super) const COLUMNS: [&str; 3] = ["vertices", "remeshings", "remeshing_energy"];

/// The present mesh of a surface that has had events, as a checkpoint stores it.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct StoredMesh {
    triangles: Vec<[u32; 3]>,
    /// The positions for which effects were prepared.
    positions: Vec<[f64; 3]>,
    columns: Vec<Vec<f64>>,
    ratios: Vec<[f64; 2]>,
}

impl StoredMesh {
    fn of(new: &BodyMesh) -> Self {
        Self {
            triangles: new.mesh.triangles().to_vec(),
            positions: new.positions.clone(),
            columns: new.columns.clone(),
            ratios: new.ratios.clone(),
        }
    }
}

/// The state of one surface.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct SurfaceState {
    mesh: Option<StoredMesh>,
    /// The targets of held quantities for each component, if the surface has parted.
    targets: Option<Vec<Vec<f64>>>,
    /// The smallest angle, in degrees, below which an event is due.
    limit: f64,
    /// The largest angle between neighbouring triangles after the last attempt, in degrees, where lengths depend on
    /// curvature.
    turn: f64,
    /// The number of the driver's progress at the last attempt, and the number of vertices that was to be made for the
    /// area.
    attempt: Option<(u64, f64)>,
}

/// The state of all surfaces.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct RemeshingState {
    surfaces: Vec<SurfaceState>,
    events: Vec<Remeshing>,
    notes: Vec<String>,
}

/// The new meshes of a run.
#[derive(Debug)]
pub(super) struct Remesher {
    /// The edges of each surface that is to have new meshes.
    wanted: Vec<Option<Wanted>>,
    /// The initial positions of each surface.
    starts: Vec<Vec<[f64; 3]>>,
    topologies: Vec<Option<Topology>>,
    state: RemeshingState,
}

impl Remesher {
    /// The new meshes of a run that begins here.
    pub(super) fn new(scene: &Scene, simulation: &mut Simulation, positions: &[[f64; 3]]) -> Self {
        let surfaces = scene.surfaces.iter().enumerate();
        let wanted = surfaces.map(|(index, surface)| {
            let body = &simulation.bodies()[index];
            let own = body.surface(positions)?;
            let wanted = Wanted {
                edges: surface.remesh?,
                vertices: body.mesh().vertex_count(),
                area: own.area(),
                smooth: false,
            };
            if !holds_triangles(surface, &scene.driver) {
                return Some(wanted);
            }
            let same = same_mesh(body, own);
            // Where targets are out of reach, those of flat triangles are, too, or will do.
            let smooth = simulation
                .replace_mesh(scene, index, same, Vec::new())
                .is_ok();
            Some(Wanted { smooth, ..wanted })
        });
        let state = SurfaceState {
            mesh: None,
            targets: None,
            limit: WORN,
            turn: 0.0,
            attempt: None,
        };
        let wanted = wanted.collect();
        let bodies = simulation.bodies().iter();
        Self {
            wanted,
            starts: bodies
                .map(|body| positions[body.vertices()].to_vec())
                .collect(),
            topologies: scene
                .surfaces
                .iter()
                .map(|surface| surface.topology)
                .collect(),
            state: RemeshingState {
                surfaces: vec![state; scene.surfaces.len()],
                ..RemeshingState::default()
            },
        }
    }

    /// Continues from a stored state: replaces the meshes of the simulation by those of the last events.
    pub(super) fn resume(
        &mut self,
        scene: &Scene,
        simulation: &mut Simulation,
        state: RemeshingState,
    ) -> Result<(), RunError> {
        for (index, surface) in state.surfaces.iter().enumerate() {
            let Some(stored) = surface.mesh.clone() else {
                continue;
            };
            let mesh = TriangleMesh::new(stored.positions.len(), stored.triangles);
            let mesh = mesh.map_err(|_| RunError::Mismatch)?;
            let new = BodyMesh {
                mesh,
                positions: stored.positions,
                columns: stored.columns,
                ratios: stored.ratios,
            };
            let own = simulation.bodies()[index].targets().iter();
            let targets = match &surface.targets {
                None => own.cloned().collect(),
                Some(stored) => own
                    .zip(stored)
                    .map(|(held, stored)| HeldTargets {
                        targets: Targets::PerComponent(stored.clone()),
                        ..*held
                    })
                    .collect(),
            };
            let replaced = simulation.replace_mesh(scene, index, new, targets);
            replaced.map_err(|_| RunError::Mismatch)?;
        }
        self.state = state;
        Ok(())
    }

    /// The positions with which each surface got its present mesh.
    pub(super) fn references(&self) -> Vec<[f64; 3]> {
        let surfaces = self.state.surfaces.iter().zip(&self.starts);
        let own = surfaces.map(|(state, start)| {
            let mesh = state.mesh.as_ref();
            mesh.map_or(&start[..], |mesh| &mesh.positions)
        });
        Vec::from_iter(own).concat()
    }

    /// The state to store.
    pub(super) fn state(&self) -> &RemeshingState {
        &self.state
    }

    /// All events so far.
    pub(super) fn events(&self) -> &[Remeshing] {
        &self.state.events
    }

    /// Remarks about meshes that could not be replaced.
    pub(super) fn notes(&self) -> &[String] {
        &self.state.notes
    }

    /// Whether a surface gets new meshes.
    pub(super) fn renews(&self, surface: usize) -> bool {
        self.wanted[surface].is_some()
    }

    /// The numbers of the columns of a surface.
    pub(super) fn numbers(&self, body: &Body) -> [f64; 3] {
        let own = self.state.events.iter();
        let own = own.filter(|event| event.surface == body.name());
        let changes = own.clone().map(|event| event.energy[1] - event.energy[0]);
        [
            body.mesh().vertex_count() as f64,
            own.count() as f64,
            changes.sum(),
        ]
    }

    /// The surfaces whose meshes are due to be replaced.
    pub(super) fn due(&self, simulation: &Simulation, positions: &[[f64; 3]]) -> Vec<usize> {
        let bodies = simulation.bodies().iter().zip(&self.state.surfaces);
        let is_due = |(index, (body, state)): (usize, (&Body, &SurfaceState))| {
            let wanted = self.wanted[index]?;
            let surface = body.surface(positions)?;
            let count = match state.attempt {
                Some((_, count)) => count,
                None => body.mesh().vertex_count() as f64,
            };
            let ratio = wanted.vertices_of(surface.area()) / count;
            // The first mesh knows nothing of lengths that depend on more than the area.
            let grown = match ratio.is_nan() {
                true => state.attempt.is_none(),
                false => ratio.max(ratio.recip()) > GROWN,
            };
            let turned = wanted.turn(surface);
            let turned =
                turned.is_some_and(|[turn, wanted]| turn > wanted.max(TURNED * state.turn));
            let is_due = grown || turned || smallest_angle(surface) < state.limit;
            is_due.then_some(index)
        };
        bodies.enumerate().filter_map(is_due).collect()
    }

    /// Whether a mesh that cannot go on can be replaced: something has changed since the last attempt.
    pub(super) fn can_replace(&self, surface: usize, drive: &dyn Drive) -> bool {
        let attempt = self.state.surfaces[surface].attempt;
        self.renews(surface) && attempt.is_none_or(|(number, _)| number != drive.mark().number)
    }

    /// Replaces the meshes of these surfaces, as far as that is possible. False if `interrupted` has ended the work: the
    /// rest is still due then.
    pub(super) fn replace(
        &mut self,
        surfaces: &[usize],
        scene: &Scene,
        simulation: &mut Simulation,
        drive: &mut dyn Drive,
        interrupted: &dyn Fn() -> bool,
    ) -> Result<bool, RunError> {
        for &index in surfaces {
            let mark = drive.mark();
            let before = drive.positions().to_vec();
            let Some(wanted) = self.wanted[index] else {
                continue;
            };
            let geometry = scene.surfaces[index].effects.geometry(&scene.driver);
            let measured = measured(simulation, index, geometry, &before);
            let body = &simulation.bodies()[index];
            // A driver keeps the last positions that are finite.
            let Some(surface) = body.surface(&before) else {
                continue;
            };
            let made = new_mesh(wanted, body, surface, interrupted);
            if matches!(made, Err(RemeshError::Interrupted)) {
                return Ok(false);
            }
            let count = wanted.vertices_of(surface.area());
            self.state.surfaces[index].attempt = Some((mark.number, count));
            let made = match made {
                Ok(made) => made,
                Err(error) => {
                    self.refused(index, simulation, drive, &error.to_string(), measured.angle);
                    continue;
                }
            };
            let targets = body_targets(simulation, index);
            if let Err(error) = self.install(index, scene, simulation, drive, made, targets)? {
                self.refused(index, simulation, drive, &error, measured.angle);
                continue;
            }
            let after = self::measured(simulation, index, geometry, drive.positions());
            let state = &mut self.state.surfaces[index];
            state.limit = WORN.min(FARTHER * after.angle);
            let surface = simulation.bodies()[index].surface(drive.positions());
            let turn = surface.and_then(|surface| wanted.turn(surface));
            state.turn = turn.map_or(0.0, |[turn, _]| turn);
            let name = &scene.surfaces[index].name;
            let event = Remeshing::of(name, mark.time, None, [measured, after]);
            self.state.events.push(event);
        }
        Ok(true)
    }

    /// Gives a surface a mesh, or says why that is not possible; then nothing has changed.
    fn install(
        &mut self,
        index: usize,
        scene: &Scene,
        simulation: &mut Simulation,
        drive: &mut dyn Drive,
        made: BodyMesh,
        targets: Vec<HeldTargets>,
    ) -> Result<Result<(), String>, RunError> {
        let before = drive.positions();
        let vertices = simulation.bodies()[index].vertices();
        let (first, rest) = (&before[..vertices.start], &before[vertices.end..]);
        let all = [first, &made.positions, rest].concat();
        let stored = StoredMesh::of(&made);
        if let Err(error) = simulation.replace_mesh(scene, index, made, targets) {
            return Ok(Err(error.to_string()));
        }
        self.state.surfaces[index].mesh = Some(stored);
        drive.replace_meshes(simulation, self.references(), all)?;
        Ok(Ok(()))
    }

    /// Whether it is time to [measure](Self::measure).
    pub(super) fn measures(&self, drive: &dyn Drive) -> bool {
        let number = drive.mark().number;
        number > 0 && number.is_multiple_of(MEASURED)
    }

    /// The reason why the run cannot go on, if the last new mesh does not resolve its surface.
    pub(super) fn worn_out(&self, drive: &dyn Drive) -> Option<String> {
        let last = self.state.events.last()?;
        let Remeshing {
            surface,
            smallest_angle: [_, angle],
            ..
        } = Some(last).filter(|event| event.broke.is_none())?;
        (*angle < HOPELESS).then(|| {
            let what = format!("a new mesh of \"{surface}\" has an angle of {angle:.1}°");
            worn_out(drive, &what)
        })
    }

    /// The reason why the run cannot go on with a surface whose triangles fold although it gets new meshes.
    pub(super) fn folded(&self, body: &Body, drive: &dyn Drive) -> String {
        let name = body.name();
        let what = format!("triangles of \"{name}\" fold, and a new mesh does not help");
        worn_out(drive, &what)
    }

    /// Measures anew how much more than its flat triangles the smooth surface has; false if that is as it was, to
    /// [`SETTLED`].
    pub(super) fn measure(
        &mut self,
        scene: &Scene,
        simulation: &mut Simulation,
        drive: &mut dyn Drive,
    ) -> Result<bool, RunError> {
        let mut changed = false;
        for (index, wanted) in self.wanted.iter().enumerate() {
            let positions = drive.positions();
            let body = &simulation.bodies()[index];
            let Some(own) = body.surface(positions) else {
                continue;
            };
            if !wanted.is_some_and(|wanted| wanted.smooth) {
                continue;
            }
            let same = same_mesh(body, own);
            let [before, after] = [body.ratios(), &same.ratios].map(<[_]>::as_flattened);
            let largest = |numbers: &mut dyn Iterator<Item = f64>| numbers.fold(0.0, f64::max);
            let off = largest(&mut before.iter().zip(after).map(|(a, b)| (a - b).abs()));
            if off <= SETTLED * largest(&mut after.iter().map(|ratio| (ratio - 1.0).abs())) {
                continue;
            }
            let stored = StoredMesh::of(&same);
            let targets = body_targets(simulation, index);
            if simulation.replace_mesh(scene, index, same, targets).is_ok() {
                self.state.surfaces[index].mesh = Some(stored);
                changed = true;
            }
        }
        if changed {
            let positions = drive.positions().to_vec();
            drive.replace_meshes(simulation, self.references(), positions)?;
        }
        Ok(changed)
    }

    /// Notes that the mesh of a surface stays, and tries again when it has become worse.
    fn refused(
        &mut self,
        index: usize,
        simulation: &Simulation,
        drive: &dyn Drive,
        reason: &str,
        angle: f64,
    ) {
        let body = &simulation.bodies()[index];
        let surface = body.surface(drive.positions());
        let turn = surface.and_then(|surface| self.wanted[index]?.turn(surface));
        let state = &mut self.state.surfaces[index];
        state.limit = FARTHER * angle;
        state.turn = turn.map_or(0.0, |[turn, _]| turn);
        self.note(index, simulation, drive, reason);
    }

    /// Notes, once, why the mesh of a surface stays.
    fn note(&mut self, index: usize, simulation: &Simulation, drive: &dyn Drive, reason: &str) {
        let name = simulation.bodies()[index].name();
        let what = format!("\"{name}\" keeps its mesh");
        if !self.state.notes.iter().any(|note| note.contains(&what)) {
            let note = format!("from {}: {what}: {reason}", drive.caption());
            self.state.notes.push(note);
        }
    }
}

fn worn_out(drive: &dyn Drive, what: &str) -> String {
    format!(
        "mesh worn out at {}: {what}, because edges are as long as the surface is thick, as at a neck: choose more \
         vertices, `remesh.curvature`, or `topology` if it may part there",
        drive.caption()
    )
}

/// The present targets of a surface.
fn body_targets(simulation: &Simulation, index: usize) -> Vec<HeldTargets> {
    simulation.bodies()[index].targets().to_vec()
}
