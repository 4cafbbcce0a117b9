//! Bodies placed at random in a box, without overlap.
//!
//! Each body is represented by balls inside it, which together come near every vertex. Bodies begin small and grow;
//! where balls overlap, their bodies move and turn apart (B. D. Lubachevsky and F. H. Stillinger, J. Stat. Phys. 60
//! (1990) 561, without velocities).

mod balls;
mod moving;

pub use balls::{Ball, inscribed_balls};

use glam::DVec3;
use helfrich::Surface;
use moving::{FreeBody, Packing};

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
                    return Ok(packing.bodies.iter().map(FreeBody::place).collect());
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
