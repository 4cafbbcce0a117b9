//! Surfaces that have entered each other.

use super::Simulation;
use crate::enclosure::{Bounded, Inside, inside_of_images, inside_of_own_images};
use helfrich::Surface;

/// A surface that has entered another one, an obstacle, or its own image: part of it is inside. A
/// surface that is completely inside is intended.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    /// The name of the surface.
    pub surface: String,
    /// The name of the surface or obstacle that it has entered; `None` for its own image.
    pub into: Option<String>,
    /// The vertices inside.
    pub inside: Inside,
}

impl Simulation {
    /// All pairs of surfaces that cross at these positions, including images in a periodic box, each pair
    /// once.
    pub fn crossings(&self, positions: &[[f64; 3]]) -> Vec<Crossing> {
        let surfaces = self.bodies.iter().filter_map(|body| {
            let surface = body.surface(positions)?;
            Some((body.name(), Bounded::from(surface)))
        });
        let surfaces = Vec::from_iter(surfaces);
        let obstacles = self.obstacles.iter().filter_map(|obstacle| {
            let surface = Surface::new(&obstacle.mesh, &obstacle.positions).ok()?;
            Some((obstacle.name.as_str(), Bounded::from(surface)))
        });
        let others = Vec::from_iter(surfaces.iter().copied().chain(obstacles));
        let mut crossings = Vec::new();
        for (number, (name, surface)) in surfaces.iter().enumerate() {
            let mut add = |into: Option<&str>, found: Vec<Inside>| {
                let vertices = surface.surface().positions().len();
                let crossing = found.into_iter().find(|inside| inside.count < vertices);
                crossings.extend(crossing.map(|inside| Crossing {
                    surface: (*name).to_owned(),
                    into: into.map(str::to_owned),
                    inside,
                }));
            };
            for (_, (other, around)) in others.iter().enumerate().filter(|(k, _)| *k != number) {
                let found = inside_of_images(surface, around, &self.images);
                add(Some(other), found);
            }
            add(None, inside_of_own_images(surface, &self.images));
        }
        crossings
    }

    /// Whether the two that cross repel each other.
    pub fn is_repelled(&self, crossing: &Crossing) -> bool {
        let body = |name: &str| self.bodies.iter().position(|body| body.name() == name);
        let Some(surface) = body(&crossing.surface) else {
            return false;
        };
        let solid = |name: &str| self.obstacles.iter().position(|solid| solid.name == name);
        let other = crossing.into.as_deref();
        self.between.iter().any(|between| {
            let has = |body: Option<usize>| body.is_some_and(|body| between.bodies.contains(&body));
            let repels = |solid: usize| between.solids.iter().any(|&(number, _)| number == solid);
            let meets = match other {
                None => between.repulsion.images.own,
                Some(name) => has(body(name)) || solid(name).is_some_and(repels),
            };
            has(Some(surface)) && meets
        })
    }
}
