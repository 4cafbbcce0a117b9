//! The division of surfaces among ranks.

use super::{Body, Simulation};
use helfrich_execute::team::{Division, Team};
use std::ops::Range;

impl Simulation {
    /// Shares the work with other ranks: as [membranes](crate::flow::Membranes), each then computes the forces on its surfaces,
    /// and all know all forces. Surfaces are divided by the third coordinate of their middles, along which lattices are divided
    /// as well, so that each rank has about the same number of vertices.
    pub fn share(&mut self, team: Team, positions: &[[f64; 3]]) {
        if team.is_alone() {
            // All surfaces, and no memory beside that of one rank.
            (self.division, self.own) = (Division::alone(), Vec::new());
            return;
        }
        let (count, number) = (team.count(), team.number());
        let height = |body: &Body| {
            let own = &positions[body.vertices.clone()];
            own.iter().map(|[.., z]| z).sum::<f64>() / own.len() as f64
        };
        let mut heights = Vec::from_iter(self.bodies.iter().map(height).enumerate());
        heights.sort_by(|(_, one), (_, other)| one.total_cmp(other));
        let mut vertices = vec![Vec::<Range<usize>>::new(); count];
        self.own = vec![false; self.bodies.len()];
        let mut before = 0;
        for (body, _) in heights {
            // A surface belongs to the rank in whose share of all vertices its middle is.
            let own = self.bodies[body].vertices();
            let rank = (before + own.len() / 2) * count / positions.len().max(1);
            self.own[body] = rank == number;
            before += own.len();
            vertices[rank].push(own);
        }
        self.division = Division::new(team, vertices);
    }

    /// The vertices of each rank's surfaces.
    pub fn division(&self) -> &Division {
        &self.division
    }

    /// Whether a surface belongs to this rank.
    pub fn owns(&self, body: usize) -> bool {
        self.own.get(body).is_none_or(|own| *own)
    }
}
