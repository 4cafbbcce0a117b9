//! Sums of Stokeslets: the loop that takes the time.

use glam::DVec3;
use pulp::{Arch, Simd, WithSimd};

/// A point force: its place, and the force.
///
/// One source meets a vector of targets at a time, so that every target adds its sources in their
/// order; the six numbers of a source are read together and spread over the vector.
pub(super) type Source = [f64; 6];

/// A multiple of every width of vectors.
pub(super) const LANES: usize = 8;

/// Sources that stay in the first cache while all targets pass.
const TILE: usize = 384;

/// `Σ (f/r + r (r·f)/r³)` over all sources at every target. Coinciding points give nothing.
pub(super) fn sums(targets: &[DVec3], sources: &[Source]) -> Vec<DVec3> {
    let padded = targets.len().next_multiple_of(LANES);
    let axes = [0, 1, 2].map(|axis| {
        let mut coordinates = Vec::from_iter(targets.iter().map(|x| x[axis]));
        coordinates.resize(padded, 0.0);
        coordinates
    });
    let mut sums = [(); 3].map(|()| vec![0.0; padded]);
    Arch::new().dispatch(Task {
        targets: axes.each_ref().map(Vec::as_slice),
        sources,
        sums: sums.each_mut().map(Vec::as_mut_slice),
    });
    let [x, y, z] = &sums;
    (0..targets.len())
        .map(|k| DVec3::new(x[k], y[k], z[k]))
        .collect()
}

struct Task<'a> {
    targets: [&'a [f64]; 3],
    sources: &'a [Source],
    sums: [&'a mut [f64]; 3],
}

impl WithSimd for Task<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let [x, y, z] = self.targets.map(|axis| S::as_simd_f64s(axis).0);
        let [u, v, w] = self.sums.map(|axis| S::as_mut_simd_f64s(axis).0);
        for tile in self.sources.chunks(TILE) {
            let targets = x.iter().zip(y).zip(z);
            let sums = u.iter_mut().zip(v.iter_mut()).zip(w.iter_mut());
            for (((&x, &y), &z), ((u, v), w)) in targets.zip(sums) {
                let mut sum = [*u, *v, *w];
                for source in tile {
                    sum = add(simd, [x, y, z], source, sum);
                }
                [*u, *v, *w] = sum;
            }
        }
    }
}

/// `sum` with what one source gives to a vector of targets.
#[inline(always)]
fn add<S: Simd>(
    simd: S,
    target: [S::f64s; 3],
    source: &Source,
    [u, v, w]: [S::f64s; 3],
) -> [S::f64s; 3] {
    // No closures here: they would be compiled without the features of the caller.
    let [x, y, z, f, g, h] = *source;
    let (x, y, z) = (simd.splat_f64s(x), simd.splat_f64s(y), simd.splat_f64s(z));
    let (f, g, h) = (simd.splat_f64s(f), simd.splat_f64s(g), simd.splat_f64s(h));
    let dx = simd.sub_f64s(x, target[0]);
    let dy = simd.sub_f64s(y, target[1]);
    let dz = simd.sub_f64s(z, target[2]);
    let squared = simd.mul_add_e_f64s(dx, dx, simd.mul_add_e_f64s(dy, dy, simd.mul_f64s(dz, dz)));
    // The reciprocal and the root do not wait for each other.
    let over_squared = simd.div_f64s(simd.splat_f64s(1.0), squared);
    let apart = simd.greater_than_or_equal_f64s(squared, simd.splat_f64s(f64::MIN_POSITIVE));
    let over_squared = simd.select_f64s(apart, over_squared, simd.splat_f64s(0.0));
    let over = simd.mul_f64s(over_squared, simd.sqrt_f64s(squared));
    let along = simd.mul_add_e_f64s(dx, f, simd.mul_add_e_f64s(dy, g, simd.mul_f64s(dz, h)));
    let along = simd.mul_f64s(along, over_squared);
    [
        simd.mul_add_e_f64s(over, simd.mul_add_e_f64s(along, dx, f), u),
        simd.mul_add_e_f64s(over, simd.mul_add_e_f64s(along, dy, g), v),
        simd.mul_add_e_f64s(over, simd.mul_add_e_f64s(along, dz, h), w),
    ]
}

/// One source at one target.
pub(super) fn one(target: DVec3, source: Source) -> DVec3 {
    add(pulp::Scalar, target.to_array(), &source, [0.0; 3]).into()
}
