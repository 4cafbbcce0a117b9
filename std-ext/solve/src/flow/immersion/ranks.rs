//! Membranes and fluid of several ranks.
//!
//! Rank 0 gives an order for each step, and for each reading of fluid that other ranks have. All ranks then do the same, each
//! for its planes of the fluid and its membranes. All know the positions, velocities and forces of all vertices.

use super::{Immersion, ImmersionPrecision};
use crate::flow::Membranes;
use crate::flow::lattice_boltzmann::Sides;
use helfrich_execute::team::Division;
use serde::{Deserialize, Serialize};

/// The next thing that all ranks do.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) enum Order {
    /// [`Immersion::advance`].
    Advance,
    /// [`Immersion::drive`].
    Drive([f64; 3], [Sides; 3]),
    /// Rank 0 receives the fluid of all.
    Collect,
    /// All receive the state on rank 0.
    Restore,
}

impl<T: ImmersionPrecision> Immersion<T> {
    /// Shares the work with other ranks, among which the lattice is shared already, by the vertices of their membranes. Only
    /// volumes, redistributions and ripples of this rank's membranes must be set.
    pub fn share(&mut self, division: Division) {
        self.division = division;
    }

    /// Does what rank 0 needs of another rank, until it is dismissed. Membranes and positions are those of rank 0.
    ///
    /// # Panics
    /// If rank 0 runs another program.
    pub fn assist(&mut self, membranes: &mut dyn Membranes, positions: &mut [[f64; 3]]) {
        while let Some(message) = self.division.team().listen() {
            let order = postcard::from_bytes(&message).expect("all ranks run the same program");
            match order {
                // Rank 0 finds the same error, and reports it.
                Order::Advance => drop(T::advance(self, membranes, positions)),
                Order::Drive(force, sides) => {
                    let _ = self.lattice.set_force(force);
                    let _ = self.lattice.move_walls(sides);
                }
                Order::Collect => self.lattice.collect(),
                Order::Restore => self.distribute(positions),
            }
        }
    }

    /// As rank 0: has the others do the same as this one.
    pub(super) fn order(&self, order: Order) {
        if !self.division.team().is_alone() {
            self.division
                .team()
                .call(&postcard::to_stdvec(&order).expect("encodes"));
        }
    }

    /// As rank 0: has all fluid here for reading.
    pub fn collect(&mut self) {
        self.order(Order::Collect);
        self.lattice.collect();
    }

    /// Sends the state on rank 0 to all.
    pub(super) fn distribute(&mut self, positions: &mut [[f64; 3]]) {
        self.lattice.distribute();
        self.division.team().broadcast(&mut self.velocities);
        self.division.team().broadcast(positions);
    }
}
