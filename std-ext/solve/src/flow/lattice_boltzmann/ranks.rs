//! A lattice of several ranks, each of which has consecutive planes of constant z.
//!
//! Every rank numbers nodes as one rank alone would, but uses no memory for planes that it does not touch. Between steps
//! each population is where its plane is. During an odd step populations cross the plane between two ranks: they are
//! fetched before it, and returned after it.

use super::stencil::{Layout, Q, VELOCITIES};
use super::{Lattice, LatticeError, Precision};
use helfrich_execute::team::{Pod, Team};
use std::ops::Range;

/// Fewest planes of a rank: the points of no kernel then reach those of three ranks.
const FEWEST: usize = 3;

/// The planes of one rank.
#[derive(Clone, Debug)]
pub(super) struct RankPlanes {
    pub(super) team: Team,
    /// The planes of each rank.
    all: Vec<Range<usize>>,
}

impl RankPlanes {
    /// # Errors
    /// If there are too few planes.
    pub(super) fn new(team: Team, cells: [usize; 3]) -> Result<Self, LatticeError> {
        let (ranks, planes) = (team.count(), cells[2]);
        if ranks > 1 && planes / ranks < FEWEST {
            let most = (planes / FEWEST).max(1);
            return Err(LatticeError::TooManyRanks {
                ranks,
                planes,
                most,
            });
        }
        let all = team.divide(planes);
        Ok(Self { team, all })
    }

    /// The planes of this rank.
    pub(super) fn own(&self) -> Range<usize> {
        self.all[self.team.number()].clone()
    }

    /// The parts of things of which each plane has the same number.
    pub(super) fn of_planes(&self, things: usize) -> Vec<Range<usize>> {
        let parts = self.all.iter();
        let parts = parts.map(|planes| planes.start * things..planes.end * things);
        parts.collect()
    }

    /// The first plane after those of this rank, and the last one before them, on the torus.
    fn beyond(&self) -> [usize; 2] {
        let [next, before] = self.team.neighbours();
        [self.all[next].start, self.all[before].end - 1]
    }

    /// This rank's outermost planes, the last and the first.
    fn outermost(&self) -> [usize; 2] {
        let own = self.own();
        [own.end - 1, own.start]
    }
}

/// The directions that go from one plane to the next, or to the one before.
fn across(upwards: bool) -> impl Iterator<Item = usize> {
    let step = if upwards { 1 } else { -1 };
    (0..Q).filter(move |&direction| VELOCITIES[direction][2] == step)
}

/// The slots of the populations in a plane that odd steps of the planes below it, or above it, use.
fn crossing(layout: Layout, plane: usize, from_below: bool) -> impl Iterator<Item = Range<usize>> {
    let sheets = across(from_below).map(move |direction| (plane * Q + direction) * layout.sheet);
    sheets.map(move |start| start..start + layout.sheet)
}

impl<T: Precision> Lattice<T> {
    /// The planes of this rank.
    pub(super) fn own_planes(&self) -> Range<usize> {
        self.parts.own()
    }

    /// Whether there is only one rank.
    pub(super) fn is_alone(&self) -> bool {
        self.parts.team.is_alone()
    }

    /// The number of this rank.
    pub(super) fn rank(&self) -> usize {
        self.parts.team.number()
    }

    /// The rank that has a plane.
    pub(super) fn rank_of(&self, plane: usize) -> usize {
        self.parts.all.partition_point(|planes| planes.end <= plane)
    }

    /// The planes of each rank.
    pub(super) fn each_part(&self) -> impl Iterator<Item = Range<usize>> {
        self.parts.all.iter().cloned()
    }

    /// Completes numbers of which each rank knows its part.
    pub(super) fn gather<N: Pod>(&self, numbers: &mut [N], parts: &[Range<usize>]) {
        self.parts.team.gather(numbers, parts);
    }

    /// Sends numbers to the next rank, and receives some from the one before.
    pub(super) fn pass_on<N: Pod>(&self, sent: &[N], received: &mut [N]) {
        let [next, before] = self.parts.team.neighbours();
        self.parts.team.exchange(next, sent, before, received);
    }

    /// Makes the populations at this rank's nodes readable.
    pub(super) fn prepare_reading(&mut self) {
        if self.odd() {
            self.fetch();
        }
    }

    /// Before an odd step: what it uses of the planes beyond.
    pub(super) fn fetch(&mut self) {
        let (outermost, beyond) = (self.parts.outermost(), self.parts.beyond());
        self.swap(outermost, beyond, [false, true]);
    }

    /// After an odd step: what it has left in the planes beyond.
    pub(super) fn deliver(&mut self) {
        let (outermost, beyond) = (self.parts.outermost(), self.parts.beyond());
        self.swap(beyond, outermost, [true, false]);
    }

    /// Sends slots of two planes to the ranks after this and before it, and receives others from those before and after.
    fn swap(&mut self, sent: [usize; 2], received: [usize; 2], sent_from_below: [bool; 2]) {
        if self.parts.team.is_alone() {
            return;
        }
        let layout = self.layout;
        let [next, before] = self.parts.team.neighbours();
        let populations = &mut self.state.populations;
        let mut leaving = Vec::new();
        let mut coming = vec![T::zero(); across(true).count() * layout.sheet];
        for (side, [to, from]) in [[next, before], [before, next]].into_iter().enumerate() {
            leaving.clear();
            for slots in crossing(layout, sent[side], sent_from_below[side]) {
                leaving.extend_from_slice(&populations[slots]);
            }
            self.parts.team.exchange(to, &leaving, from, &mut coming);
            // What goes up comes from below.
            let slots = crossing(layout, received[1 - side], sent_from_below[side]);
            for (slots, sheet) in slots.zip(coming.chunks(layout.sheet)) {
                populations[slots].copy_from_slice(sheet);
            }
        }
    }

    /// Brings the state and the forces on nodes of all planes to rank 0. All ranks have to call it.
    pub fn collect(&mut self) {
        let RankPlanes { team, .. } = &self.parts;
        if team.is_alone() {
            return;
        }
        let slots = self.parts.of_planes(Q * self.layout.sheet);
        to_first(team, &mut self.state.populations, &slots);
        let nodes = self
            .parts
            .of_planes(self.layout.cells[0] * self.layout.cells[1]);
        let rows = self.parts.of_planes(self.layout.cells[1]);
        // Ranks without points have no forces yet, others may have.
        self.nodal_forces();
        if let Some(forces) = &mut self.forces {
            forces.each_array(|axis| to_first(&self.parts.team, axis, &nodes));
            let touched = forces.touched_mut();
            let mut bytes = Vec::from_iter(touched.iter().map(|&touched| u8::from(touched)));
            to_first(&self.parts.team, &mut bytes, &rows);
            for (touched, byte) in touched.iter_mut().zip(bytes) {
                *touched = byte != 0;
            }
        }
    }

    /// Sends the state on rank 0 to the ranks of its planes. All ranks have to call it.
    pub fn distribute(&mut self) {
        let team = &self.parts.team;
        if team.is_alone() {
            return;
        }
        let mut steps = [self.state.steps];
        team.broadcast(&mut steps);
        [self.state.steps] = steps;
        let slots = self.parts.of_planes(Q * self.layout.sheet);
        match team.number() {
            0 => {
                for (rank, slots) in slots.into_iter().enumerate().skip(1) {
                    team.send(rank, &self.state.populations[slots]);
                }
            }
            own => team.receive(0, &mut self.state.populations[slots[own].clone()]),
        }
        self.links.forget();
    }
}

/// Sends each rank's part to rank 0.
fn to_first<N: Pod>(team: &Team, numbers: &mut [N], parts: &[Range<usize>]) {
    match team.number() {
        0 => {
            for (rank, part) in parts.iter().enumerate().skip(1) {
                team.receive(rank, &mut numbers[part.clone()]);
            }
        }
        own => team.send(0, &numbers[parts[own].clone()]),
    }
}
