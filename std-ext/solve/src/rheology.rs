//! Stress of membranes in a sheared fluid, and their distribution between walls, as a rheometer finds them.
//!
//! In a volume V of fluid of viscosity μ, with membranes that exert the forces F_i on it at x_i and that enclose fluid of
//! viscosity λ μ, the mean stress exceeds that of the fluid alone by
//!
//! `S = −(1/V) Σ_i (F_i x_i + x_i F_i)/2 + (1/V) Σ (λ − 1) μ ∮ (u n + n u) dA`, n outward.
//!
//! A stretched membrane pulls the fluid inwards, F·x < 0, and S is positive along it. In Stokes flow between walls, periodic
//! otherwise, S_xy is the mean shear stress on the walls minus μ times the mean shear rate: multiply `∇·σ + f = 0` by y and
//! integrate. G. K. Batchelor, J. Fluid Mech. 41 (1970) 545; C. Pozrikidis, Boundary Integral and Singularity Methods,
//! Cambridge 1992, section 2.5.

use glam::DVec3;
use helfrich::Surface;
use std::array;

/// A tensor, row by row.
pub type Tensor = [[f64; 3]; 3];

/// The part of its mean below which the share of membranes ends at a wall: see [`free_layer`].
const FREE: f64 = 0.1;

/// `Σ_i a_i b_i`, whose rows have the components of a.
pub fn moment(first: &[[f64; 3]], second: &[[f64; 3]]) -> Tensor {
    let mut sum = Tensor::default();
    for (first, second) in first.iter().zip(second) {
        for (row, first) in sum.iter_mut().zip(first) {
            for (sum, second) in row.iter_mut().zip(second) {
                *sum += first * second;
            }
        }
    }
    sum
}

/// `∮ u n dA` of a closed surface whose vertices have these velocities; u is linear on each triangle.
///
/// # Panics
/// If there are fewer velocities than vertices.
pub fn velocity_moment(surface: Surface<'_, f64>, velocities: &[[f64; 3]]) -> Tensor {
    let mean = |corners: &[u32; 3]| {
        let sum = corners.map(|corner| DVec3::from(velocities[corner as usize]));
        (sum.into_iter().sum::<DVec3>() / 3.0).to_array()
    };
    let triangles = surface.mesh().triangles().iter();
    let (means, areas): (Vec<_>, Vec<_>) = triangles
        .map(|corners| (mean(corners), area_vector(surface, corners).to_array()))
        .unzip();
    moment(&means, &areas)
}

fn area_vector(surface: Surface<'_, f64>, &[a, b, c]: &[u32; 3]) -> DVec3 {
    let [first, second] = [b, c].map(|corner| DVec3::from(surface.difference(a, corner)));
    0.5 * first.cross(second)
}

/// The volume that a closed surface encloses between each two consecutive heights along y, exact for its triangles.
///
/// Below the height h it is `∮ min(y, h) n_y dA` by the divergence theorem.
pub fn volumes_between(surface: Surface<'_, f64>, heights: &[f64]) -> Vec<f64> {
    let mut above = vec![0.0; heights.len()];
    for corners in surface.mesh().triangles() {
        let area = area_vector(surface, corners).y;
        let mut places = corners.map(|corner| surface.positions()[corner as usize][1]);
        places.sort_by(f64::total_cmp);
        for (above, &height) in above.iter_mut().zip(heights) {
            *above += area * mean_above(places, height);
        }
    }
    above.windows(2).map(|pair| pair[0] - pair[1]).collect()
}

/// The mean of `max(y − h, 0)` over a triangle whose corners are at these heights y, from the lowest to the highest.
fn mean_above([low, middle, high]: [f64; 3], height: f64) -> f64 {
    let whole = (low + middle + high) / 3.0 - height;
    // The part of the triangle beyond the height, from the corner that is alone there.
    let cut = |tip: f64, others: [f64; 2]| {
        let share = others.map(|other| (tip - height) / (tip - other));
        share[0] * share[1] * (tip - height) / 3.0
    };
    if height <= low {
        whole
    } else if height >= high {
        0.0
    } else if height >= middle {
        cut(high, [low, middle])
    } else {
        whole - cut(low, [middle, high])
    }
}

/// The means between each two consecutive heights of a function that is linear between these points, heights and values.
pub fn means_between(points: &[[f64; 2]], heights: &[f64]) -> Vec<f64> {
    let mean = |slice: &[f64]| {
        let segments = points.windows(2).map(|segment| {
            let [[from, first], [to, last]] = [segment[0], segment[1]];
            let [begin, end] = [from.max(slice[0]), to.min(slice[1])];
            if end <= begin {
                return 0.0;
            }
            let middle = (0.5 * (begin + end) - from) / (to - from);
            (end - begin) * (first + middle * (last - first))
        });
        segments.sum::<f64>() / (slice[1] - slice[0])
    };
    heights.windows(2).map(mean).collect()
}

/// The thickness of the layers at two walls that membranes leave free, the mean of both: the distance from a wall at which
/// the share of membranes reaches a tenth of its mean over all slices. Slices are equally high, `height` together; between
/// their centres, and from 0 on the walls, the share is linear. NaN if there are no membranes.
pub fn free_layer(shares: &[f64], height: f64) -> f64 {
    let count = shares.len() as f64;
    let limit = FREE * shares.iter().sum::<f64>() / count;
    let thickness = |shares: &mut dyn Iterator<Item = &f64>| {
        let mut before = [0.0; 2];
        for (slice, &share) in shares.enumerate() {
            let place = (slice as f64 + 0.5) * height / count;
            if share >= limit {
                let way = (limit - before[1]) / (share - before[1]);
                return before[0] + way * (place - before[0]);
            }
            before = [place, share];
        }
        f64::NAN
    };
    0.5 * (thickness(&mut shares.iter()) + thickness(&mut shares.iter().rev()))
}

/// The mean of blocks of consecutive values, as equal as their number allows, and its standard error, which is that of
/// independent blocks. `None` if there are fewer than two blocks, or fewer values than blocks.
pub fn block_average(values: &[f64], blocks: usize) -> Option<[f64; 2]> {
    if blocks < 2 || values.len() < blocks {
        return None;
    }
    let block = |number: usize| {
        let [begin, end] = [number, number + 1].map(|edge| edge * values.len() / blocks);
        values[begin..end].iter().sum::<f64>() / (end - begin) as f64
    };
    let count = blocks as f64;
    let mean = (0..blocks).map(block).sum::<f64>() / count;
    let squares = (0..blocks).map(|number| (block(number) - mean).powi(2));
    let variance = squares.sum::<f64>() / (count - 1.0);
    Some([mean, (variance / count).sqrt()])
}

/// The components xx, yy, zz, xy, xz and yz of the symmetric part of a tensor.
pub fn symmetric(tensor: &Tensor) -> [f64; 6] {
    const PLACES: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [0, 2], [1, 2]];
    array::from_fn(|place| {
        let [row, column] = PLACES[place];
        0.5 * (tensor[row][column] + tensor[column][row])
    })
}
