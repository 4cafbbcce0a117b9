//! The division of surfaces among ranks.

use super::Simulation;
use helfrich_execute::team::Team;
use std::ops::Range;

/// The surfaces of each rank.
#[derive(Debug, Default)]
pub(super) struct BodiesOfRanks {
    pub(super) team: Team,
    /// Consecutive surfaces for each rank; none for one that is alone, which has all.
    bodies: Vec<Range<usize>>,
}

impl Simulation {
    /// Shares the work with other ranks: as [membranes](crate::flow::Membranes), all compute the forces on the surfaces of one
    /// rank there. Surfaces follow one after the other, so that each rank has about the same number of vertices.
    pub fn share(&mut self, team: Team) {
        let count = team.count();
        let total = self.bodies.last().map_or(0, |body| body.vertices.end).max(1);
        // A surface belongs to the rank in whose share of all vertices its middle is.
        let rank = |body: &super::Body| {
            let middle = body.vertices.start.midpoint(body.vertices.end);
            middle * count / total
        };
        let first = |number: usize| self.bodies.partition_point(|body| rank(body) < number);
        let bodies = (0..count).map(|number| first(number)..first(number + 1));
        self.ranks = BodiesOfRanks {
            bodies: bodies.collect(),
            team,
        };
    }

    /// The ranks that share the work.
    pub fn team(&self) -> &Team {
        &self.ranks.team
    }

    /// Whether a surface belongs to this rank.
    pub fn owns(&self, body: usize) -> bool {
        self.own_bodies().contains(&body)
    }

    /// The vertices of each rank's surfaces.
    pub fn vertices_of_ranks(&self) -> Vec<Range<usize>> {
        let end = self.bodies.last().map_or(0, |body| body.vertices.end);
        let first = |number: usize| self.bodies.get(number).map_or(end, |body| body.vertices.start);
        let bodies = self.ranks.bodies.iter();
        let vertices = bodies.map(|bodies| first(bodies.start)..first(bodies.end));
        match self.ranks.team.is_alone() {
            true => vec![0..end],
            false => vertices.collect(),
        }
    }

    pub(super) fn own_bodies(&self) -> Range<usize> {
        match self.ranks.team.is_alone() {
            true => 0..self.bodies.len(),
            false => self.ranks.bodies[self.ranks.team.number()].clone(),
        }
    }
}
