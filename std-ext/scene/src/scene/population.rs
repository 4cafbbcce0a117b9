//! Populations: equal surfaces at random or given places.

use super::builder::Builder;
use super::places::read_places;
use super::reader::Reader;
use super::{Driver, LatticeBoltzmann, MeshSource, ObstacleScene, Orientation, SurfaceScene};
use crate::info::MeshInfo;
use crate::io::free_memory;
use crate::simulation::Placed;
use crate::six::rounded;
use helfrich::Surface;
use helfrich_mesh::packing::{Ball, Kind, Place, Room, inscribed_balls, pack};
use serde::Serialize;
use std::ops::Range;

/// Equal surfaces of a scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PopulationScene {
    /// The population's name.
    pub name: String,
    /// Which of the scene's surfaces they are.
    pub surfaces: Range<usize>,
    /// Whether each of them has rows of its own in a series.
    pub per_cell: bool,
}

impl PopulationScene {
    /// The number of surfaces.
    pub fn count(&self) -> usize {
        self.surfaces.len()
    }
}

/// Least memory of a vertex in bytes.
const VERTEX_BYTES: f64 = 600.0;

/// A population as it is read: its surfaces before they have places.
struct Crowd<'a> {
    reader: Reader<'a>,
    surface: SurfaceScene,
    placed: Placed,
    info: MeshInfo,
    gap: f64,
    /// The places from a file.
    given: Option<Vec<Place>>,
}

impl Crowd<'_> {
    fn surface(&self) -> Option<Surface<'_, f64>> {
        Surface::new(self.placed.mesh(), &self.placed.positions).ok()
    }

    /// Its surfaces at these places.
    fn at(&self, places: &[Place]) -> impl Iterator<Item = SurfaceScene> {
        (1..).zip(places).map(|(number, place)| SurfaceScene {
            name: format!("{}-{number}", self.surface.name),
            position: place.position,
            orientation: (place.angle != 0.0).then_some(Orientation {
                axis: place.axis,
                angle: place.angle,
            }),
            ..self.surface.clone()
        })
    }
}

impl Builder<'_> {
    /// Takes the surfaces from `first` on, one for each of these populations, out of `surfaces`, and adds all surfaces of the
    /// populations instead.
    pub(super) fn populations(
        &mut self,
        readers: &[Reader<'_>],
        driver: (Option<Reader<'_>>, Option<&Driver>),
        surfaces: &mut Vec<SurfaceScene>,
        first: usize,
        obstacles: &[ObstacleScene],
    ) -> Vec<PopulationScene> {
        let Some(&one) = readers.first() else {
            return Vec::new();
        };
        let alone = surfaces.split_off(first);
        let (Some(table), Some(driver)) = driver else {
            return Vec::new();
        };
        let Driver::LatticeBoltzmann(lattice) = driver else {
            self.contradiction(
                one.origin(),
                "a population fills the box of the driver \"lattice-boltzmann\": choose this driver, or write every \
                 surface as a [[surface]]"
                    .to_owned(),
            );
            return Vec::new();
        };
        if !table.has("box") {
            self.contradiction(
                table.origin(),
                "a population fills the box of the driver, which has to be given by `box`"
                    .to_owned(),
            );
            return Vec::new();
        }
        // Surfaces are placed where everything else is right.
        if !self.problems.0.is_empty() {
            return Vec::new();
        }
        let crowds = alone.into_iter().zip(readers);
        let crowds = crowds.map(|(surface, reader)| self.crowd(surface, *reader, lattice.spacing));
        let Some(crowds) = crowds.collect::<Option<Vec<_>>>() else {
            return Vec::new();
        };
        let gap = crowds.iter().map(|crowd| crowd.gap).fold(0.0, f64::max);
        let mut standing = surfaces.clone();
        for crowd in &crowds {
            standing.extend(crowd.given.iter().flat_map(|places| crowd.at(places)));
        }
        let solids = self.solids(&standing, obstacles, gap);
        let free = volume(lattice) - solids.iter().map(|solid| solid.volume).sum::<f64>();
        let counts = crowds.iter().map(|crowd| self.count(crowd, free));
        let Some(counts) = counts.collect::<Option<Vec<usize>>>() else {
            return Vec::new();
        };
        let [corner, _] = lattice.corners();
        let room = Room {
            corner,
            size: lattice.size(),
            walls: lattice.walls(),
        };
        let random = crowds.iter().zip(&counts);
        let random = Vec::from_iter(random.filter(|(crowd, _)| crowd.given.is_none()));
        let kinds = random.iter().filter_map(|(crowd, count)| {
            let turns = crowd.reader.text("orientation") != Some("fixed");
            Some(Kind::new(crowd.surface()?, **count, crowd.gap, turns))
        });
        let kinds = Vec::from_iter(kinds);
        let solids = Vec::from_iter(solids.into_iter().flat_map(|solid| solid.balls));
        let seeds = readers.iter().filter_map(|reader| reader.count("seed"));
        let seed = seeds.fold(1, |all: u64, seed| all.wrapping_mul(31).wrapping_add(seed));
        let places = match pack(&room, &kinds, &solids, seed) {
            Ok(places) => places,
            Err(error) => {
                let numbers = random.iter().map(|(crowd, count)| {
                    format!("{count} surfaces of \"{}\"", crowd.surface.name)
                });
                let numbers = Vec::from_iter(numbers).join(" and ");
                let message = format!(
                    "{numbers} in the box: {error}: choose fewer, a smaller `gap`, or a larger `box`"
                );
                let largest = random.iter().max_by_key(|(_, count)| **count);
                let reader = largest.map_or(one, |(crowd, _)| crowd.reader);
                let key = match reader.has("count") {
                    true => "count",
                    false => "haematocrit",
                };
                self.contradiction(&reader.origin_of(key), message);
                return Vec::new();
            }
        };
        let mut places = places.into_iter();
        let mut populations = Vec::new();
        for (crowd, count) in crowds.iter().zip(counts) {
            let begin = surfaces.len();
            match &crowd.given {
                Some(given) => surfaces.extend(crowd.at(given)),
                None => {
                    let random = Vec::from_iter(places.by_ref().take(count));
                    surfaces.extend(crowd.at(&random));
                }
            }
            populations.push(PopulationScene {
                name: crowd.surface.name.clone(),
                surfaces: begin..surfaces.len(),
                per_cell: crowd.reader.switch("per_cell") == Some(true),
            });
        }
        populations
    }

    /// The mesh of a population; `None` if it has none, which is reported here or when it is made.
    fn crowd<'a>(
        &mut self,
        surface: SurfaceScene,
        reader: Reader<'a>,
        spacing: f64,
    ) -> Option<Crowd<'a>> {
        let placed = self.placed(
            &surface.name,
            &surface.source,
            surface.scale,
            None,
            [0.0; 3],
        );
        let placed = match placed {
            Ok(placed) => placed,
            Err(message) => {
                self.contradiction(reader.origin(), message);
                return None;
            }
        };
        let at = Surface::new(placed.mesh(), &placed.positions).ok()?;
        let info = MeshInfo::new(at);
        if !info.volume.is_some_and(|volume| volume > 0.0) {
            self.contradiction(
                reader.origin(),
                format!(
                    "the surfaces of \"{}\" enclose no volume, and a population needs closed ones, with their triangles \
                     counter-clockwise from outside",
                    surface.name
                ),
            );
            return None;
        }
        let cutoffs = self.barriers.iter().map(|barrier| barrier.cutoff);
        let cutoff = cutoffs.fold(0.0, f64::max);
        let gap = reader.number("gap");
        let file = reader.text("places").map(|name| self.file(name));
        let given = match file.map(|path| (read_places(&path), path)) {
            None => None,
            Some((Ok(places), _)) => Some(places),
            Some((Err(error), path)) => {
                let message = format!("{}: {error}", path.display());
                self.contradiction(&reader.origin_of("places"), message);
                return None;
            }
        };
        Some(Crowd {
            given,
            gap: gap.unwrap_or(spacing.max(0.5 * cutoff)),
            reader,
            surface,
            placed,
            info,
        })
    }

    fn placed(
        &mut self,
        name: &str,
        source: &MeshSource,
        scale: f64,
        orientation: Option<Orientation>,
        position: [f64; 3],
    ) -> Result<Placed, String> {
        let files = &mut self.meshes;
        Placed::new(name, source, scale, orientation, position, files, false)
            .map_err(|error| error.to_string())
    }

    /// The number of surfaces of a population in this volume.
    fn count(&mut self, crowd: &Crowd<'_>, free: f64) -> Option<usize> {
        let name = &crowd.surface.name;
        let haematocrit = crowd.reader.number("haematocrit");
        let (key, count) = match (&crowd.given, haematocrit) {
            (Some(places), _) => ("places", places.len() as f64),
            (None, Some(part)) => ("haematocrit", (part * free / crowd.info.volume?).round()),
            (None, None) => ("count", crowd.reader.count("count")? as f64),
        };
        let needed = VERTEX_BYTES * crowd.info.vertices as f64 * count;
        let memory = free_memory().map_or(f64::INFINITY, |bytes| bytes as f64);
        let message = if count < 1.0 {
            format!(
                "the box would have {count} surfaces of \"{name}\": choose more, or a larger `box`"
            )
        } else if needed > memory {
            let [needed, free] = [needed, memory].map(|bytes| rounded(1e-9 * bytes));
            format!(
                "{count} surfaces of \"{name}\" take at least {needed} GB of memory, and {free} are free: choose fewer"
            )
        } else {
            return Some(count as usize);
        };
        self.contradiction(&crowd.reader.origin_of(key), message);
        None
    }

    /// The surfaces and obstacles that have places already, widened by the gap, of which the fits of balls leave out a half.
    fn solids(
        &mut self,
        surfaces: &[SurfaceScene],
        obstacles: &[ObstacleScene],
        gap: f64,
    ) -> Vec<Solid> {
        let surfaces = surfaces.iter().map(|body| {
            (
                &body.name,
                &body.source,
                body.scale,
                body.orientation,
                body.position,
            )
        });
        let obstacles = obstacles.iter().map(|body| {
            (
                &body.name,
                &body.source,
                body.scale,
                body.orientation,
                body.position,
            )
        });
        let moving = surfaces.len();
        let bodies = surfaces.chain(obstacles).enumerate();
        let solids = bodies.filter_map(|(index, (name, source, scale, orientation, position))| {
            // What cannot be read is reported when it is made.
            let placed = self
                .placed(name, source, scale, orientation, position)
                .ok()?;
            let surface = Surface::new(placed.mesh(), &placed.positions).ok()?;
            let mut balls = inscribed_balls(surface, 0.5 * gap);
            for ball in &mut balls {
                ball.radius += gap;
            }
            let volume = surface.volume().filter(|_| index >= moving);
            Some(Solid {
                balls,
                volume: volume.unwrap_or(0.0),
            })
        });
        solids.collect()
    }
}

/// A body at rest while surfaces are placed.
struct Solid {
    balls: Vec<Ball>,
    /// The part of the box without fluid.
    volume: f64,
}

fn volume(lattice: &LatticeBoltzmann) -> f64 {
    lattice.size().iter().product()
}
