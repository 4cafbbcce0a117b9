//! Bodies that overlap, and movements that part them.

use super::{Ball, Kind, Place, Room, SLACK};
use crate::generate::random::Random;
use glam::{DQuat, DVec3, DVec4};

/// Factor of movements: with their mean alone, dense bodies need twice as many.
const EAGER: f64 = 1.6;

/// A body that moves.
pub(super) struct FreeBody {
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

impl FreeBody {
    pub(super) fn place(&self) -> Place {
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

pub(super) struct Packing<'a> {
    room: &'a Room,
    pub(super) bodies: Vec<FreeBody>,
    balls: Vec<Placed>,
    /// Largest distance of the centres of two balls that touch.
    width: f64,
    /// Depth of overlaps that may stay.
    pub(super) slack: f64,
    /// The farthest point of a body from its centre.
    reach: f64,
    /// Pairs of balls of different bodies that can touch, as long as these have moved by less than half of [`Self::skin`].
    pairs: Vec<[u32; 2]>,
    moved: f64,
    random: Random,
}

impl<'a> Packing<'a> {
    pub(super) fn new(room: &'a Room, kinds: &[Kind], solids: &[Ball], seed: u64) -> Self {
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
                bodies.push(FreeBody {
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
    pub(super) fn press(&mut self, size: f64) -> f64 {
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
    pub(super) fn move_apart(&mut self) {
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
    pub(super) fn shake(&mut self, size: f64) {
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
    pub(super) fn grow(&mut self, by: f64) {
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
