//! Density and velocity of the fluid.

use crate::flow::lattice_boltzmann::stencil::{Q, VELOCITIES};
use crate::flow::lattice_boltzmann::{Lattice, Precision, Sides, number};
use std::array;

/// Density and velocity at a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// ρ, 1 at rest.
    pub density: f64,
    /// u, including half of the force that the next step will add. Without inertia it is the
    /// momentum, whatever the density.
    pub velocity: [f64; 3],
}

impl Node {
    /// Fluid at rest.
    pub const REST: Self = Self {
        density: 1.0,
        velocity: [0.0; 3],
    };

    /// (ρ − 1)/3, in units of a density times a squared velocity.
    pub fn pressure(&self) -> f64 {
        (self.density - 1.0) / 3.0
    }
}

/// Nodes along x, from one on.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeRow {
    pub(super) start: [usize; 3],
    pub(super) count: usize,
}

/// δρ, and momentum with half of the force.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moments {
    excess: f64,
    momentum: [f64; 3],
}

impl Moments {
    fn add(&mut self, other: &Self) {
        self.excess += other.excess;
        for (sum, momentum) in self.momentum.iter_mut().zip(other.momentum) {
            *sum += momentum;
        }
    }
}

impl<T: Precision> Lattice<T> {
    /// Density and velocity at a node.
    ///
    /// # Panics
    /// If there is no such node.
    pub fn node(&self, cell: [usize; 3]) -> Node {
        self.assert_inside(cell);
        let mut moments = [Moments::default()];
        let row = NodeRow {
            start: cell,
            count: 1,
        };
        self.read(row, &mut moments);
        let [moments] = moments;
        Node {
            density: 1.0 + moments.excess,
            velocity: self.velocity(&moments),
        }
    }

    /// Density and velocity at a point, interpolated linearly between the surrounding nodes.
    /// Between the last fluid nodes and a wall or obstacle, the velocity goes linearly to that of
    /// the surface half-way, and the density is that of the last nodes. On periodic axes the point
    /// may lie anywhere.
    ///
    /// `None` beyond walls, in the cells of nodes inside obstacles, and where a coordinate is not
    /// finite.
    pub fn fluid_at(&self, point: [f64; 3]) -> Option<Node> {
        let mut nodes = [[None; 2]; 3];
        let mut weights = [[0.0; 2]; 3];
        for (axis, mut coordinate) in point.into_iter().enumerate() {
            let count = self.layout.cells[axis];
            if self.is_periodic(axis) {
                coordinate = coordinate.rem_euclid(count as f64);
            }
            // Not finite, or beyond a wall.
            if !(0.0..=count as f64).contains(&coordinate) {
                return None;
            }
            let before = (coordinate - 0.5).floor();
            let after = coordinate - 0.5 - before;
            weights[axis] = [1.0 - after, after];
            nodes[axis] = [0, 1].map(|side| {
                let node = before as i64 + side;
                let in_box = self.is_periodic(axis) || (0..count as i64).contains(&node);
                in_box.then(|| node.rem_euclid(count as i64) as usize)
            });
        }
        // Corners of the cube of nodes around the point; the bits of a corner's number give its
        // side along each axis.
        let side = |corner: usize, axis: usize| (corner >> axis) & 1;
        let cell = |corner| {
            let [x, y, z] = array::from_fn(|axis| nodes[axis][side(corner, axis)]);
            Some([x?, y?, z?])
        };
        let nearest: usize = (0..3)
            .map(|axis| match nodes[axis] {
                [Some(_), None] => 0,
                [None, Some(_)] => 1 << axis,
                _ => usize::from(weights[axis][1] >= 0.5) << axis,
            })
            .sum();
        let fluid: [_; 8] = array::from_fn(|corner| {
            (cell(corner).filter(|&cell| !self.is_solid(cell))).map(|cell| self.node(cell))
        });
        fluid[nearest]?;
        let mut corners: [_; 8] = array::from_fn(|corner| match fluid[corner] {
            Some(node) => node,
            None => behind_obstacle(corner, &fluid),
        });
        // Behind edges between walls, the value along the last axis is used.
        for axis in 0..3 {
            let Sides::Walls { low, high } = self.setup.sides[axis] else {
                continue;
            };
            for corner in (0..8).filter(|&corner| nodes[axis][side(corner, axis)].is_none()) {
                let wall = [low, high][side(corner, axis)];
                let before = corners[corner ^ (1 << axis)];
                corners[corner] = Node {
                    velocity: array::from_fn(|k| 2.0 * wall[k] - before.velocity[k]),
                    ..before
                };
            }
        }
        let mut mean = Node {
            density: 0.0,
            velocity: [0.0; 3],
        };
        for (number, corner) in corners.iter().enumerate() {
            let weight: f64 = (0..3)
                .map(|axis| weights[axis][side(number, axis)])
                .product();
            mean.density += weight * corner.density;
            for (sum, velocity) in mean.velocity.iter_mut().zip(corner.velocity) {
                *sum += weight * velocity;
            }
        }
        Some(mean)
    }

    pub(super) fn velocity(&self, moments: &Moments) -> [f64; 3] {
        let mass = self.inertial_density(moments);
        moments.momentum.map(|momentum| momentum / mass)
    }

    /// Momentum over velocity: ρ, and 1 without inertia.
    pub(super) fn inertial_density(&self, moments: &Moments) -> f64 {
        if self.setup.inertia {
            1.0 + moments.excess
        } else {
            1.0
        }
    }

    /// The moments of a row of nodes, node by node, so that the memory accesses of all directions
    /// overlap.
    pub(super) fn read(&self, row: NodeRow, moments: &mut [Moments]) {
        let layout = &self.layout;
        let slots: [_; Q] =
            array::from_fn(|direction| layout.row(self.odd(), direction, row.start));
        let first = layout.node(row.start);
        for (along, moments) in moments[..row.count].iter_mut().enumerate() {
            let mut excess = 0.0;
            let mut momentum = self.force_at(first + along).map(|force| 0.5 * force);
            for (velocity, [before, after]) in VELOCITIES.iter().zip(&slots) {
                let slot = if along < before.len() {
                    before.start + along
                } else {
                    after.start + along - before.len()
                };
                let population = number(self.state.populations[slot]);
                excess += population;
                for (sum, &velocity) in momentum.iter_mut().zip(velocity) {
                    *sum += f64::from(velocity) * population;
                }
            }
            *moments = Moments { excess, momentum };
        }
    }

    /// Mass of the fluid, without that inside obstacles.
    pub fn mass(&self) -> f64 {
        let (nodes, Moments { excess, .. }) = self.totals();
        nodes as f64 + excess
    }

    /// Momentum of the fluid, without that inside obstacles.
    pub fn momentum(&self) -> [f64; 3] {
        self.totals().1.momentum
    }

    /// Mean velocity of the nodes at each y, from the first on; nodes inside obstacles are at rest.
    pub fn layer_velocities(&self) -> Vec<[f64; 3]> {
        let [length, rows, planes] = self.layout.cells;
        let mut layers = vec![[0.0; 3]; rows];
        self.each_row(|[y, _], fluid| {
            let mut sum = [0.0; 3];
            for moments in fluid {
                let velocity = self.velocity(moments);
                (0..3).for_each(|axis| sum[axis] += velocity[axis]);
            }
            (0..3).for_each(|axis| layers[y][axis] += sum[axis] / (length * planes) as f64);
        });
        layers
    }

    /// Number of nodes in the fluid, and the sums over them, by rows so that little is lost to
    /// rounding.
    fn totals(&self) -> (usize, Moments) {
        let mut nodes = 0;
        let mut total = Moments::default();
        self.each_row(|_, fluid| {
            let mut sum = Moments::default();
            for moments in fluid {
                nodes += 1;
                sum.add(moments);
            }
            total.add(&sum);
        });
        (nodes, total)
    }

    /// Calls `visit` with y and z of each row along x, and with its nodes outside obstacles.
    fn each_row(&self, mut visit: impl FnMut([usize; 2], &mut dyn Iterator<Item = &Moments>)) {
        let [length, rows, planes] = self.layout.cells;
        let mut moments = vec![Moments::default(); length];
        for (z, y) in (0..planes).flat_map(|z| (0..rows).map(move |y| (z, y))) {
            let row = NodeRow {
                start: [0, y, z],
                count: length,
            };
            self.read(row, &mut moments);
            let is_fluid = |x: usize| !self.is_labelled(self.layout.node([x, y, z]));
            let nodes = moments.iter().enumerate();
            let mut fluid = nodes.filter_map(|(x, moments)| is_fluid(x).then_some(moments));
            visit([y, z], &mut fluid);
        }
    }
}

/// The value for a corner of a cube inside an obstacle with which the velocity vanishes half-way to
/// the adjacent corners in the fluid.
fn behind_obstacle(corner: usize, fluid: &[Option<Node>; 8]) -> Node {
    let steps = |other: usize| (corner ^ other).count_ones();
    let others = || (0..8).filter_map(|other| Some((steps(other), fluid[other]?)));
    let Some(fewest) = others().map(|(steps, _)| steps).min() else {
        return Node::REST;
    };
    let next = || others().filter(|&(steps, _)| steps == fewest);
    let over = 1.0 / next().count() as f64;
    Node {
        density: next().map(|(_, node)| node.density).sum::<f64>() * over,
        velocity: array::from_fn(|axis| {
            -next().map(|(_, node)| node.velocity[axis]).sum::<f64>() * over
        }),
    }
}
