//! Sums of Stokeslets: the loop that takes the time.

use glam::DVec3;
use pulp::{Arch, WithSimd};

/// A point force: its place, and the force.
///
/// One source meets a lane of targets at a time, so that every target adds its sources in their
/// order; the six numbers of a source are read together and spread over the lane.
pub(super) type Source = [f64; 6];

/// Targets at a time.
pub(super) const LANES: usize = 8;

/// Sources that stay in the first cache while all targets pass.
const TILE: usize = 384;

/// Coordinates, or velocities, of the targets of a lane.
type Block = [[f64; LANES]; 3];

/// `Σ (f/r + r (r·f)/r³)` over all sources at every target. Coinciding points give nothing.
///
/// Squared distances have to be within single precision.
pub(super) fn sums(targets: &[DVec3], sources: &[Source]) -> Vec<DVec3> {
    let blocks = targets.chunks(LANES).map(|chunk| {
        // The last block repeats a target.
        let target = |k: usize| chunk[k.min(chunk.len() - 1)];
        [0, 1, 2].map(|axis| std::array::from_fn(|k| target(k)[axis]))
    });
    let blocks = Vec::from_iter(blocks);
    let mut sums = vec![[[0.0; LANES]; 3]; blocks.len()];
    let task = Task {
        targets: &blocks,
        sources,
        sums: &mut sums,
    };
    match Arch::new() {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Arch::V3(simd) => pulp::Simd::vectorize(simd, Fused(task)),
        _ => task.run::<false>(),
    }
    let entry = |k: usize| DVec3::from(sums[k / LANES].map(|lane| lane[k % LANES]));
    (0..targets.len()).map(entry).collect()
}

struct Task<'a> {
    targets: &'a [Block],
    sources: &'a [Source],
    sums: &'a mut [Block],
}

/// A task on a processor that has fused multiplication and addition.
struct Fused<'a>(Task<'a>);

impl WithSimd for Fused<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.0.run::<true>();
    }
}

impl Task<'_> {
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        for tile in self.sources.chunks(TILE) {
            for (target, sum) in self.targets.iter().zip(self.sums.iter_mut()) {
                let mut lanes = *sum;
                for source in tile {
                    add::<FUSED, LANES>(target, source, &mut lanes);
                }
                *sum = lanes;
            }
        }
    }
}

/// a b + c.
#[inline(always)]
fn multiply_add<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

#[inline(always)]
fn add<const FUSED: bool, const W: usize>(
    target: &[[f64; W]; 3],
    &[x, y, z, f, g, h]: &Source,
    sum: &mut [[f64; W]; 3],
) {
    for k in 0..W {
        let [dx, dy, dz] = [x - target[0][k], y - target[1][k], z - target[2][k]];
        let squared = multiply_add::<FUSED>(dx, dx, multiply_add::<FUSED>(dy, dy, dz * dz));
        // Divisions and roots of single precision take half the time; a step of Newton's doubles
        // the digits, to 8e-15.
        let single = squared as f32;
        let guess = if single >= f32::MIN_POSITIVE {
            single.sqrt().recip()
        } else {
            0.0
        };
        let guess = f64::from(guess);
        let left = multiply_add::<FUSED>(-squared * guess, guess, 1.0);
        let over = multiply_add::<FUSED>(0.5 * guess, left, guess);
        let along = multiply_add::<FUSED>(dx, f, multiply_add::<FUSED>(dy, g, dz * h));
        let along = along * (over * over);
        sum[0][k] = multiply_add::<FUSED>(over, multiply_add::<FUSED>(along, dx, f), sum[0][k]);
        sum[1][k] = multiply_add::<FUSED>(over, multiply_add::<FUSED>(along, dy, g), sum[1][k]);
        sum[2][k] = multiply_add::<FUSED>(over, multiply_add::<FUSED>(along, dz, h), sum[2][k]);
    }
}

/// One source at one target.
pub(super) fn one(target: DVec3, source: Source) -> DVec3 {
    let mut sum = [[0.0]; 3];
    let target = target.to_array().map(|x| [x]);
    add::<false, 1>(&target, &source, &mut sum);
    DVec3::from(sum.map(|[x]| x))
}
