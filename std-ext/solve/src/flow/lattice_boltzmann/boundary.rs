//! Half-way bounce-back: walls and obstacles as pairs of slots that are exchanged.
//!
//! A population that meets a surface half-way comes back to its node in the opposite direction
//! (A. J. C. Ladd, J. Fluid Mech. 271 (1994) 285). A link between two nodes crosses the surface
//! once and has a population in each direction. Both are bounced back, each to its own side, by
//! exchanging their slots. The two slots of a link are the same after even and odd steps.

use crate::flow::lattice_boltzmann::stencil::{Layout, Q, VELOCITIES, along, opposite, weight};
use crate::flow::lattice_boltzmann::{Precision, Sides, number};

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

/// All links that cross surfaces, and the force on these.
#[derive(Clone, Debug)]
pub(super) struct Links<T> {
    links: Vec<Link>,
    /// For each surface and direction, the change of populations by a moving surface.
    taken: Vec<[T; Q]>,
    /// Momentum transferred to each surface in the last step.
    forces: Vec<[f64; 3]>,
}

impl<T: Precision> Links<T> {
    /// `labels` has 0 for nodes of the fluid, and for others the number of their obstacle.
    pub(super) fn new(layout: &Layout, sides: &[Sides; 3], labels: Option<&[u16]>) -> Self {
        let label = |cell| labels.map_or(0, |labels| usize::from(labels[layout.node(cell)]));
        let last = labels.and_then(|labels| labels.iter().max()).copied();
        let surfaces = FIRST_OBSTACLE.max(usize::from(last.unwrap_or(0)) + 1);
        let mut links = Vec::new();
        let walled = sides.map(|sides| matches!(sides, Sides::Walls { .. }));
        if labels.is_some() || walled.contains(&true) {
            for node in 0..layout.nodes() {
                let cell = layout.cell(node);
                // Half of the directions: opposite ones are the same links.
                for direction in (1..Q).step_by(2) {
                    let step = VELOCITIES[direction];
                    let crossed = (0..3).find(|&axis| {
                        let end = if step[axis] > 0 {
                            layout.cells[axis] - 1
                        } else {
                            0
                        };
                        walled[axis] && step[axis] != 0 && cell[axis] == end
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
                        _ => continue,
                    };
                    links.push(Link {
                        slots: [
                            layout.slot(opposite(direction), cell),
                            layout.slot(direction, other),
                        ],
                        direction: direction as u8,
                        met: met.map(|surface| surface as u16),
                    });
                }
            }
        }
        let mut made = Self {
            links,
            taken: vec![[T::zero(); Q]; surfaces],
            forces: vec![[0.0; 3]; surfaces],
        };
        made.move_walls(sides);
        made
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
    pub(super) fn bounce_back(&mut self, populations: &mut [T], odd: bool) {
        self.forget();
        for link in &self.links {
            let [mut first, mut second] = link.slots;
            if odd {
                std::mem::swap(&mut first, &mut second);
            }
            let direction = usize::from(link.direction);
            let met = link.met.map(usize::from);
            let sent = [populations[first], populations[second]];
            let back = [
                sent[0] - self.taken[met[0]][direction],
                sent[1] + self.taken[met[1]][direction],
            ];
            [populations[second], populations[first]] = back;
            let given = [0, 1].map(|end| number(sent[end]) + number(back[end]));
            for (axis, &step) in VELOCITIES[direction].iter().enumerate() {
                self.forces[met[0]][axis] += f64::from(step) * given[0];
                self.forces[met[1]][axis] -= f64::from(step) * given[1];
            }
        }
    }

    /// Sets forces to 0.
    pub(super) fn forget(&mut self) {
        self.forces.fill([0.0; 3]);
    }

    /// The force on a surface in the last step.
    pub(super) fn force(&self, surface: usize) -> Option<[f64; 3]> {
        self.forces.get(surface).copied()
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<Link>() * self.links.len()
    }
}
