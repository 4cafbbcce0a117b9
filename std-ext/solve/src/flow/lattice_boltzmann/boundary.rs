//! Half-way bounce-back: walls and obstacles as pairs of slots that are exchanged.
//!
//! A population that meets a surface half-way comes back to its node in the opposite direction
//! (A. J. C. Ladd, J. Fluid Mech. 271 (1994) 285). A link between two nodes crosses the surface
//! once and has a population in each direction. Both are bounced back, each to its own side, by
//! exchanging their slots. The two slots of a link are the same after even and odd steps.
//!
//! Forces are added up over the links within each plane, and over those between each plane and the next, and then over
//! planes: so no sum depends on the number of ranks.

use super::ranks::RankPlanes;
use super::stencil::{Layout, Q, VELOCITIES, along, opposite, weight, wrapped};
use super::{Precision, Sides, number};
use std::ops::Range;

/// Codes of the bodies that links meet: the inside of an obstacle (not reported), the low and high
/// walls of the axes, obstacles.
pub(super) const INSIDE: usize = 0;
pub(super) const FIRST_OBSTACLE: usize = 7;

/// The number of a wall.
pub(super) fn wall(axis: usize, high: bool) -> usize {
    1 + 2 * axis + usize::from(high)
}

/// A link that crosses a surface.
#[derive(Clone, Copy, Debug)]
struct Link {
    /// The slot of the node at the first end against the direction, and of that at the second end along it.
    slots: [usize; 2],
    /// The direction from the first end.
    direction: u8,
    /// The bodies that the two ends meet.
    met: [u16; 2],
}

impl Link {
    /// The end in the lower plane, of a link between two planes.
    fn lower(&self) -> usize {
        usize::from(VELOCITIES[usize::from(self.direction)][2] < 0)
    }

    /// The content of its slots after the bounce, and the momentum that each end gives to what it meets, along the direction and
    /// against it. `taken`: see [`Links`].
    fn bounced<T: Precision>(
        &self,
        slots: [T; 2],
        odd: bool,
        taken: &[[T; Q]],
    ) -> ([T; 2], [f64; 2]) {
        let change = self
            .met
            .map(|met| taken[usize::from(met)][usize::from(self.direction)]);
        let [first, second] = if odd { [1, 0] } else { [0, 1] };
        let sent = [slots[first], slots[second]];
        let back = [sent[0] - change[0], sent[1] + change[1]];
        let given = [0, 1].map(|end| number(sent[end]) + number(back[end]));
        ([back[second], back[first]], given)
    }
}

/// The links within a plane, or between it and the next one.
#[derive(Clone, Debug)]
struct LinkGroup {
    /// Twice the number of the plane, and 1 more for those between planes.
    number: usize,
    links: Range<usize>,
    ends: Ends,
}

/// Whether both ends of links belong to this rank, or the lower ends, or the upper ones.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Ends {
    Here,
    Lower,
    Upper,
}

/// All links that cross surfaces, and the force on these.
#[derive(Clone, Debug)]
pub(super) struct Links<T> {
    links: Vec<Link>,
    groups: Vec<LinkGroup>,
    /// For each surface and direction, the change of populations by a moving surface.
    taken: Vec<[T; Q]>,
    /// Momentum transferred to each surface in the last step, by groups; empty without surfaces.
    forces: Vec<[f64; 3]>,
}

/// Finds links.
struct Finder<'a> {
    layout: &'a Layout,
    walled: [bool; 3],
    labels: Option<&'a [u16]>,
}

impl Finder<'_> {
    /// The links of a plane's nodes in the directions with this step along z. Of two opposite directions, which are the same
    /// links, only one is looked at.
    fn add(&self, links: &mut Vec<Link>, z: usize, step: i8) {
        let [length, rows, _] = self.layout.cells;
        let directions = (1..Q)
            .step_by(2)
            .filter(|&direction| VELOCITIES[direction][2] == step);
        let directions = Vec::from_iter(directions);
        for node in 0..length * rows {
            let cell = [node % length, node / length, z];
            let found = directions
                .iter()
                .filter_map(|&direction| self.link(cell, direction));
            links.extend(found);
        }
    }

    fn link(&self, cell: [usize; 3], direction: usize) -> Option<Link> {
        let layout = self.layout;
        let label = |cell| {
            self.labels
                .map_or(0, |labels| usize::from(labels[layout.node(cell)]))
        };
        let step = VELOCITIES[direction];
        let crossed = (0..3).find(|&axis| {
            let end = if step[axis] > 0 {
                layout.cells[axis] - 1
            } else {
                0
            };
            self.walled[axis] && step[axis] != 0 && cell[axis] == end
        });
        let other = layout.neighbour(cell, direction);
        let met = match (crossed, label(cell), label(other)) {
            (Some(axis), here, there) => {
                let high = step[axis] > 0;
                let seen = |label, high| {
                    if label == 0 { wall(axis, high) } else { INSIDE }
                };
                [seen(here, high), seen(there, !high)]
            }
            (None, 0, there) if there > 0 => [there, INSIDE],
            (None, here, 0) if here > 0 => [INSIDE, here],
            _ => return None,
        };
        Some(Link {
            slots: [
                layout.slot(opposite(direction), cell),
                layout.slot(direction, other),
            ],
            direction: direction as u8,
            met: met.map(|surface| surface as u16),
        })
    }
}

impl<T: Precision> Links<T> {
    /// `labels` has 0 for nodes of the fluid, and for others the number of their obstacle.
    pub(super) fn new(
        layout: &Layout,
        parts: &RankPlanes,
        sides: &[Sides; 3],
        labels: Option<&[u16]>,
    ) -> Self {
        let last = labels.and_then(|labels| labels.iter().max()).copied();
        let surfaces = FIRST_OBSTACLE.max(usize::from(last.unwrap_or(0)) + 1);
        let walled = sides.map(|sides| matches!(sides, Sides::Walls { .. }));
        let finder = Finder {
            layout,
            walled,
            labels,
        };
        let (own, planes) = (parts.own(), layout.cells[2]);
        let mut made = Self {
            links: Vec::new(),
            groups: Vec::new(),
            taken: vec![[T::zero(); Q]; surfaces],
            forces: Vec::new(),
        };
        if labels.is_some() || walled.contains(&true) {
            made.forces = vec![[0.0; 3]; 2 * planes * surfaces];
            for z in own.clone() {
                made.add_group(2 * z, Ends::Here, |links| finder.add(links, z, 0));
            }
            let alone = parts.team.is_alone();
            let below = wrapped(own.start, -1, planes);
            for z in own.clone().chain((!alone).then_some(below)) {
                let ends = match (alone, z) {
                    (true, _) => Ends::Here,
                    (false, z) if z + 1 == own.end => Ends::Lower,
                    (false, z) if z == below => Ends::Upper,
                    _ => Ends::Here,
                };
                made.add_group(2 * z + 1, ends, |links| {
                    finder.add(links, z, 1);
                    finder.add(links, wrapped(z, 1, planes), -1);
                });
            }
        }
        made.move_walls(sides);
        made
    }

    fn add_group(&mut self, number: usize, ends: Ends, add: impl FnOnce(&mut Vec<Link>)) {
        let first = self.links.len();
        add(&mut self.links);
        let links = first..self.links.len();
        if !links.is_empty() {
            self.groups.push(LinkGroup {
                number,
                links,
                ends,
            });
        }
    }

    /// Sets the velocities of the walls.
    pub(super) fn move_walls(&mut self, sides: &[Sides; 3]) {
        for (axis, sides) in sides.iter().enumerate() {
            if let Sides::Walls { low, high } = *sides {
                for (velocity, high) in [(low, false), (high, true)] {
                    self.taken[wall(axis, high)] = std::array::from_fn(|direction| {
                        T::constant(6.0 * weight(direction) * along(direction, velocity))
                    });
                }
            }
        }
    }

    /// Bounces back the populations that crossed surfaces in the last step, even or odd.
    pub(super) fn bounce_back(&mut self, populations: &mut [T], odd: bool, parts: &RankPlanes) {
        self.forget();
        // What the other ends of links between ranks have sent.
        let [lower, upper] = self.far_ends(populations, parts);
        let surfaces = self.taken.len();
        for LinkGroup {
            number,
            links,
            ends,
        } in &self.groups
        {
            let forces = &mut self.forces[number * surfaces..][..surfaces];
            for (index, link) in self.links[links.clone()].iter().enumerate() {
                let mut slots = link.slots.map(|slot| populations[slot]);
                match ends {
                    Ends::Here => {}
                    Ends::Lower => slots[1 - link.lower()] = upper[index],
                    Ends::Upper => slots[link.lower()] = lower[index],
                }
                let (back, given) = link.bounced(slots, odd, &self.taken);
                for (slot, back) in link.slots.into_iter().zip(back) {
                    populations[slot] = back;
                }
                let met = link.met.map(usize::from);
                for (axis, &step) in VELOCITIES[usize::from(link.direction)].iter().enumerate() {
                    forces[met[0]][axis] += f64::from(step) * given[0];
                    forces[met[1]][axis] -= f64::from(step) * given[1];
                }
            }
        }
        if !(parts.team.is_alone() || self.forces.is_empty()) {
            let groups = parts.of_planes(2 * surfaces);
            parts.team.gather(&mut self.forces, &groups);
        }
    }

    /// The populations at the lower ends of the links to the rank before this one, and at the upper ends of those to
    /// the next.
    fn far_ends(&self, populations: &[T], parts: &RankPlanes) -> [Vec<T>; 2] {
        if parts.team.is_alone() || self.forces.is_empty() {
            return [Vec::new(), Vec::new()];
        }
        let ends = |which: Ends, lower: bool| {
            let groups = self.groups.iter().filter(|group| group.ends == which);
            let links = groups.flat_map(|group| &self.links[group.links.clone()]);
            let slot = move |link: &Link| match lower {
                true => link.slots[link.lower()],
                false => link.slots[1 - link.lower()],
            };
            Vec::from_iter(links.map(|link| populations[slot(link)]))
        };
        let [next, before] = parts.team.neighbours();
        let (mut lower, mut upper) = (ends(Ends::Upper, true), ends(Ends::Lower, false));
        let team = &parts.team;
        team.exchange(next, &ends(Ends::Lower, true), before, &mut lower);
        team.exchange(before, &ends(Ends::Upper, false), next, &mut upper);
        [lower, upper]
    }

    /// Sets forces to 0.
    pub(super) fn forget(&mut self) {
        self.forces.fill([0.0; 3]);
    }

    /// The force on a surface in the last step.
    pub(super) fn force(&self, surface: usize) -> Option<[f64; 3]> {
        let surfaces = self.taken.len();
        (surface < surfaces).then(|| {
            let forces = self.forces.chunks(surfaces).map(|group| group[surface]);
            forces.fold([0.0; 3], |sum, force| {
                std::array::from_fn(|axis| sum[axis] + force[axis])
            })
        })
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<Link>() * self.links.len()
    }
}
