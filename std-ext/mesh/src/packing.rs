//! Bodies placed at random in a box, without overlap.
//!
//! Each body is represented by balls inside it, which together come near every vertex. Bodies begin small and grow;
//! where balls overlap, their bodies move and turn apart (B. D. Lubachevsky and F. H. Stillinger, J. Stat. Phys. 60
//! (1990) 561, without velocities).

use crate::generate::random::Random;
use glam::{DQuat, DVec3, DVec4};
use helfrich::Surface;

/// A ball in a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its centre, relative to the body's.
    pub centre: [f64; 3],
    /// Its radius.
    pub radius: f64,
}

/// Largest number of vertices for which balls are sought; of more, every second one or fewer are used.
const MOST_VERTICES: usize = 5000;

/// Balls inside a closed surface that come within `tolerance` of its vertices, the largest first.
///
/// At each vertex the largest ball is sought that touches the surface there and has no other vertex inside (J. Ma,
/// S. W. Bae and S. Choi, Vis. Comput. 28 (2012) 7); of these balls, one is left out if larger ones come near its vertex.
pub fn inscribed_balls(surface: Surface<'_, f64>, tolerance: f64) -> Vec<Ball> {
    let stride = surface.positions().len().div_ceil(MOST_VERTICES).max(1);
    let mut normals = vec![DVec3::ZERO; surface.positions().len()];
    for &corners in surface.mesh().triangles() {
        let [a, b, c] = corners.map(|corner| DVec3::from(surface.positions()[corner as usize]));
        for corner in corners {
            normals[corner as usize] += (b - a).cross(c - a);
        }
    }
    let all = surface.positions().iter().zip(&normals).step_by(stride);
    let points = all.map(|(&at, normal)| (DVec3::from(at), normal.normalize_or_zero()));
    let points = Vec::from_iter(points);
    let reach = |from: DVec3| points.iter().map(move |(to, _)| from.distance_squared(*to));
    let touching = points.iter().map(|&(at, normal)| {
        let mut radius = 0.5 * reach(at).fold(0.0, f64::max).sqrt();
        loop {
            let centre = at - radius * normal;
            let inside = (1.0 - 1e-9) * radius * radius;
            let nearest = (points.iter().map(|(to, _)| *to)).min_by(|a, b| {
                a.distance_squared(centre)
                    .total_cmp(&b.distance_squared(centre))
            });
            let smaller = nearest
                .filter(|to| to.distance_squared(centre) < inside)
                .map(|to| {
                    let apart = at - to;
                    apart.length_squared() / (2.0 * apart.dot(normal))
                });
            match smaller {
                Some(next) if next > 0.0 && next < (1.0 - 1e-9) * radius => radius = next,
                _ => return (centre, radius),
            }
        }
    });
    let mut touching = Vec::from_iter(touching.zip(&points));
    touching.sort_by(|(a, _), (b, _)| b.1.total_cmp(&a.1));
    let mut chosen = Vec::<Ball>::new();
    for ((centre, radius), (at, _)) in touching {
        let near = |ball: &Ball| DVec3::from(ball.centre).distance(*at) <= ball.radius + tolerance;
        if !chosen.iter().any(near) {
            chosen.push(Ball {
                centre: centre.to_array(),
                radius,
            });
        }
    }
    chosen
}

/// A box with walls at the ends of some axes; the others are periodic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    /// The lower corner.
    pub corner: [f64; 3],
    /// The lengths.
    pub size: [f64; 3],
    /// Which axes end in walls.
    pub walls: [bool; 3],
}

/// Equal bodies that are to be placed.
#[derive(Clone, Debug, PartialEq)]
pub struct Kind {
    /// The balls in one of them.
    pub balls: Vec<Ball>,
    /// The number of bodies.
    pub count: usize,
    /// Least distance from other bodies and from walls; between two kinds the mean of both holds.
    pub gap: f64,
    /// Whether they may be turned; if not, they keep their orientation.
    pub turns: bool,
}

impl Kind {
    /// Bodies with this surface, at least `gap` apart.
    pub fn new(surface: Surface<'_, f64>, count: usize, gap: f64, turns: bool) -> Self {
        let balls = inscribed_balls(surface, 0.5 * gap);
        let beyond = |at: &[f64; 3]| {
            let from = |ball: &Ball| DVec3::from(ball.centre).distance((*at).into()) - ball.radius;
            balls.iter().map(from).fold(f64::INFINITY, f64::min)
        };
        let farthest = surface.positions().iter().map(beyond).fold(0.0, f64::max);
        Self {
            gap: gap + 2.0 * farthest,
            balls,
            count,
            turns,
        }
    }
}

/// The place of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Its centre.
    pub position: [f64; 3],
    /// The axis of its rotation, of length 1.
    pub axis: [f64; 3],
    /// The angle of its rotation, in degrees.
    pub angle: f64,
}

/// The reason why bodies are not placed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NotPacked {
    /// A body that is longer than the box.
    #[error("a body is {length} long, with its gap, and the box {size} along {axis}")]
    TooLong {
        /// The length of the body and its gap.
        length: f64,
        /// The length of the box.
        size: f64,
        /// The axis: x, y or z.
        axis: char,
    },
    /// Bodies overlap after many movements.
    #[error(
        "no places were found: bodies of {:.0} % of their size fit, with their gaps", 100.0 * .0
    )]
    TooDense(f64),
}

/// Overlaps that are left, as a part of the smallest ball's radius; balls are larger by this.
const SLACK: f64 = 0.01;

/// Part of the size by which bodies grow where they hardly overlap.
const GROWTH: f64 = 0.02;

/// Size of the bodies at the start.
const SEED_SIZE: f64 = 0.3;

/// Number of movements after which bodies are shaken, and the number of times.
const PATIENCE: usize = 400;
const SHAKES: usize = 30;

/// Factor of movements: with their mean alone, dense bodies need twice as many.
const EAGER: f64 = 1.6;

/// A body that moves.
struct Moving {
    position: DVec3,
    rotation: DQuat,
    turns: bool,
    /// Movements by which it would leave overlaps: their sum and number; the moment of these, and of their arms.
    shift: DVec3,
    count: f64,
    moment: DVec3,
    arms: f64,
}

/// A ball of a body, or one that rests.
struct Placed {
    body: Option<u32>,
    offset: DVec3,
    radius: f64,
    gap: f64,
    /// Relative to the body, as it is turned and grown.
    arm: DVec3,
    at: DVec3,
}

/// Places bodies at random in a room, kind after kind; `solids` are balls at rest. The same seed gives the same places.
///
/// # Errors
/// If the bodies do not fit; see [`NotPacked`].
pub fn pack(
    room: &Room,
    kinds: &[Kind],
    solids: &[Ball],
    seed: u64,
) -> Result<Vec<Place>, NotPacked> {
    for kind in kinds {
        room.admits(kind)?;
    }
    let mut packing = Packing::new(room, kinds, solids, seed);
    let mut size = SEED_SIZE;
    for _ in 0..SHAKES {
        for _ in 0..PATIENCE {
            let deepest = packing.press(size);
            if deepest <= packing.slack {
                if size >= 1.0 {
                    return Ok(packing.bodies.iter().map(Moving::place).collect());
                }
                size = f64::min(1.0, size + GROWTH);
                packing.grow(GROWTH);
            } else {
                packing.move_apart();
            }
        }
        packing.shake(size);
    }
    Err(NotPacked::TooDense(size))
}

impl Room {
    fn admits(&self, kind: &Kind) -> Result<(), NotPacked> {
        let reach = |ball: &Ball| DVec3::from(ball.centre).length() + ball.radius;
        let length = 2.0 * kind.balls.iter().map(reach).fold(0.0, f64::max) + kind.gap;
        let short = "xyz"
            .chars()
            .zip(self.size)
            .find(|(_, size)| *size < length);
        match short {
            Some((axis, size)) => Err(NotPacked::TooLong { length, size, axis }),
            None => Ok(()),
        }
    }

    /// The difference of two points, or of the nearest of their images.
    fn apart(&self, a: DVec3, b: DVec3) -> DVec3 {
        let mut apart = a - b;
        for axis in 0..3 {
            if !self.walls[axis] {
                apart[axis] -= self.size[axis] * (apart[axis] / self.size[axis]).round();
            }
        }
        apart
    }
}

impl Moving {
    fn place(&self) -> Place {
        let (axis, angle) = self.rotation.to_axis_angle();
        Place {
            position: self.position.to_array(),
            axis: axis.to_array(),
            angle: angle.to_degrees(),
        }
    }

    /// Moves and turns the body, and returns the farthest movement of a point at most `reach` from its centre.
    fn change(&mut self, shift: DVec3, turn: DVec3, reach: f64) -> f64 {
        self.position += shift;
        if !self.turns {
            return shift.length();
        }
        self.rotation = (DQuat::from_scaled_axis(turn) * self.rotation).normalize();
        shift.length() + turn.length() * reach
    }

    /// Notes that the body should move by `shift` at this arm.
    fn note(&mut self, shift: DVec3, arm: DVec3) {
        self.shift += shift;
        self.count += 1.0;
        self.moment += arm.cross(shift);
        self.arms += arm.length_squared();
    }
}

impl Placed {
    fn reach(&self, size: f64) -> f64 {
        match self.body {
            Some(_) => size * self.radius + self.gap,
            None => self.radius,
        }
    }
}

struct Packing<'a> {
    room: &'a Room,
    bodies: Vec<Moving>,
    balls: Vec<Placed>,
    /// Largest distance of the centres of two balls that touch.
    width: f64,
    slack: f64,
    /// The farthest point of a body from its centre.
    reach: f64,
    /// Pairs of balls of different bodies that can touch, as long as these have moved by less than half of [`Self::skin`].
    pairs: Vec<[u32; 2]>,
    moved: f64,
    random: Random,
}

impl<'a> Packing<'a> {
    fn new(room: &'a Room, kinds: &[Kind], solids: &[Ball], seed: u64) -> Self {
        let mut random = Random::new(seed);
        let radii = kinds
            .iter()
            .flat_map(|kind| &kind.balls)
            .map(|ball| ball.radius);
        let slack = SLACK * radii.fold(f64::INFINITY, f64::min);
        let (mut bodies, mut balls) = (Vec::new(), Vec::new());
        for kind in kinds {
            for _ in 0..kind.count {
                let inside = DVec3::new(random.unit(), random.unit(), random.unit());
                let rotation = if kind.turns {
                    rotation(&mut random)
                } else {
                    DQuat::IDENTITY
                };
                balls.extend(kind.balls.iter().map(|ball| Placed {
                    body: Some(bodies.len() as u32),
                    offset: ball.centre.into(),
                    radius: ball.radius,
                    gap: 0.5 * (kind.gap + slack),
                    arm: DVec3::ZERO,
                    at: DVec3::ZERO,
                }));
                bodies.push(Moving {
                    position: DVec3::from(room.corner) + inside * DVec3::from(room.size),
                    rotation,
                    turns: kind.turns,
                    shift: DVec3::ZERO,
                    count: 0.0,
                    moment: DVec3::ZERO,
                    arms: 0.0,
                });
            }
        }
        balls.extend(solids.iter().map(|ball| Placed {
            body: None,
            offset: DVec3::ZERO,
            radius: ball.radius,
            gap: 0.0,
            arm: DVec3::ZERO,
            at: ball.centre.into(),
        }));
        let most = |of: fn(&Placed) -> f64| balls.iter().map(of).fold(0.0, f64::max);
        Self {
            room,
            width: 2.0 * most(|ball| ball.radius + ball.gap),
            reach: most(|ball| ball.offset.length() + ball.radius),
            bodies,
            balls,
            slack,
            pairs: Vec::new(),
            moved: f64::INFINITY,
            random,
        }
    }

    /// Notes all overlaps of bodies of this size, and returns the deepest one.
    fn press(&mut self, size: f64) -> f64 {
        for body in &mut self.bodies {
            (body.shift, body.moment) = (DVec3::ZERO, DVec3::ZERO);
            (body.count, body.arms) = (0.0, 0.0);
        }
        for ball in &mut self.balls {
            if let Some(body) = ball.body {
                let body = &self.bodies[body as usize];
                ball.arm = body.rotation * (size * ball.offset);
                ball.at = body.position + ball.arm;
            }
        }
        if self.moved > 0.5 * self.skin() {
            self.find_pairs(size);
            self.moved = 0.0;
        }
        let reach = |ball: &Placed| ball.reach(size);
        let mut deepest = 0.0_f64;
        for pair in &self.pairs {
            let [a, b] = pair.map(|ball| &self.balls[ball as usize]);
            let apart = self.room.apart(a.at, b.at);
            let (needed, distance) = (reach(a) + reach(b), apart.length());
            if distance >= needed {
                continue;
            }
            deepest = deepest.max(needed - distance);
            // Two bodies share the movement; beside one at rest, the other has it all.
            let share = if a.body.is_some() && b.body.is_some() {
                0.5
            } else {
                1.0
            };
            let shift = share * (needed - distance) * apart.try_normalize().unwrap_or(DVec3::X);
            let ends = [(a.body, shift, a.arm), (b.body, -shift, b.arm)];
            for (body, shift, arm) in ends {
                if let Some(body) = body {
                    self.bodies[body as usize].note(shift, arm);
                }
            }
        }
        for ball in &self.balls {
            let Some(body) = ball.body else { continue };
            for axis in (0..3).filter(|&axis| self.room.walls[axis]) {
                let low = self.room.corner[axis] + (reach(ball) + ball.gap) - ball.at[axis];
                let high = ball.at[axis] + (reach(ball) + ball.gap)
                    - self.room.corner[axis]
                    - self.room.size[axis];
                let shift = low.max(0.0) - high.max(0.0);
                if shift != 0.0 {
                    deepest = deepest.max(shift.abs());
                    self.bodies[body as usize].note(shift * DVec3::AXES[axis], ball.arm);
                }
            }
        }
        deepest
    }

    /// How far apart balls are that make a pair.
    fn skin(&self) -> f64 {
        0.2 * self.width
    }

    /// Finds the pairs of balls of bodies of this size.
    fn find_pairs(&mut self, size: f64) {
        let (room, skin) = (self.room, self.skin());
        let width = self.width + skin;
        let counts: [usize; 3] =
            std::array::from_fn(|axis| ((room.size[axis] / width) as usize).clamp(1, 128));
        let cell = |at: DVec3| -> [usize; 3] {
            std::array::from_fn(|axis| {
                let along = (at[axis] - room.corner[axis]) / room.size[axis];
                let along = if room.walls[axis] {
                    along.clamp(0.0, 1.0)
                } else {
                    along - along.floor()
                };
                ((along * counts[axis] as f64) as usize).min(counts[axis] - 1)
            })
        };
        let number = |[x, y, z]: [usize; 3]| (x * counts[1] + y) * counts[2] + z;
        let mut cells = vec![Vec::new(); counts.iter().product()];
        for (ball, placed) in self.balls.iter().enumerate() {
            cells[number(cell(placed.at))].push(ball);
        }
        let beside = |axis: usize, at: usize| {
            let count = counts[axis];
            let all = if room.walls[axis] {
                [at.saturating_sub(1), at, (at + 1).min(count - 1)]
            } else {
                [(at + count - 1) % count, at, (at + 1) % count]
            };
            // Each cell once.
            (0..3)
                .filter(move |&k| !all[..k].contains(&all[k]))
                .map(move |k| all[k])
        };
        let mut pairs = std::mem::take(&mut self.pairs);
        pairs.clear();
        for (first, a) in self.balls.iter().enumerate() {
            let meets = |second: usize| {
                let b = &self.balls[second];
                let needed = a.reach(size) + b.reach(size) + skin;
                second > first
                    && b.body != a.body
                    && room.apart(a.at, b.at).length_squared() < needed * needed
            };
            let [x, y, z] = cell(a.at);
            for x in beside(0, x) {
                for y in beside(1, y) {
                    for z in beside(2, z) {
                        let others = cells[number([x, y, z])].iter();
                        let others = others.filter(|&&second| meets(second));
                        pairs.extend(others.map(|&second| [first as u32, second as u32]));
                    }
                }
            }
        }
        self.pairs = pairs;
    }

    /// Moves and turns every body by more than the mean of what its overlaps ask for.
    fn move_apart(&mut self) {
        let mut farthest = 0.0;
        for body in &mut self.bodies {
            let shift = if body.count > 0.0 {
                EAGER * body.shift / body.count
            } else {
                DVec3::ZERO
            };
            let turn = if body.arms > 0.0 {
                EAGER * body.moment / body.arms
            } else {
                DVec3::ZERO
            };
            farthest = f64::max(farthest, body.change(shift, turn, self.reach));
        }
        self.moved += farthest;
    }

    /// Moves and turns all bodies a little at random.
    fn shake(&mut self, size: f64) {
        let reach = 0.1 * size * self.width;
        let random = &mut self.random;
        for body in &mut self.bodies {
            let shift = reach * random.unit() * random.on_sphere();
            let turn = 0.2 * random.unit() * random.on_sphere();
            body.change(shift, turn, self.reach);
        }
        self.moved = f64::INFINITY;
    }

    /// Notes that all bodies have grown by a part of their size.
    fn grow(&mut self, by: f64) {
        self.moved += by * self.reach;
    }
}

/// A rotation with any orientation equally likely: G. Marsaglia, Ann. Math. Stat. 43 (1972) 645.
fn rotation(random: &mut Random) -> DQuat {
    let [first, second] = [random.in_disc(), random.in_disc()];
    let stretch = ((1.0 - first.length_squared()) / second.length_squared()).sqrt();
    let all = DVec4::new(first.x, first.y, stretch * second.x, stretch * second.y);
    DQuat::from_vec4(all.normalize())
}
