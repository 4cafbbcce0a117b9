//! Regular meshes whose edges are relaxed as springs.

use super::lattice::Size;
use super::{AnyShape, Draft, icosphere, lattice, position, preimage};
use glam::DVec3;
use helfrich::shapes::{Shape, Torus};

/// The level up to which an icosphere is refined before it is relaxed for the first time: coarser
/// meshes do not follow the dimple of a discocyte.
const FIRST_LEVEL: u32 = 3;

/// Steps on the first mesh: enough to even out its longest waves.
const FIRST_STEPS: usize = 300;

/// Steps after each refinement, which leaves only short waves.
const STEPS: usize = 30;

/// The springs' rest length in mean edges: so long that edges become even along the surface, so short
/// that nearly all springs pull.
const REST: f64 = 0.6;

/// The share of the springs' mean pull by which a vertex moves in a step.
const SHARE: f64 = 0.5;

/// An icosphere that is relaxed on the shape, from a coarse level to the fine one.
pub(super) fn icosphere(shape: &AnyShape, level: u32) -> Draft {
    let first = level.min(FIRST_LEVEL);
    let coarse = icosphere::icosphere(first);
    relax_and_refine(shape, coarse, level - first, icosphere::midpoint)
}

/// A lattice of the torus that is relaxed from a coarse size to the fine one.
pub(super) fn lattice(torus: &Torus<f64>, vertices: usize) -> Draft {
    let Size {
        rows,
        columns,
        level,
    } = Size::nearest(torus, vertices);
    let coarse = lattice::lattice(torus, rows, columns);
    let midpoint = |a, b| preimage(torus, (a + b) / 2.0);
    relax_and_refine(&AnyShape::Torus(*torus), coarse, level, midpoint)
}

fn relax_and_refine(
    shape: &AnyShape,
    mut draft: Draft,
    levels: u32,
    midpoint: impl Fn(DVec3, DVec3) -> DVec3,
) -> Draft {
    relax(shape, &mut draft, FIRST_STEPS);
    for _ in 0..levels {
        draft = icosphere::refine(&draft, &midpoint);
        relax(shape, &mut draft, STEPS);
    }
    draft
}

/// Every edge pulls with (length − rest)/length of itself; every vertex follows its springs' mean
/// within the tangent plane, and is put back on the surface.
///
/// Springs shorter than their rest length are slack: rows that are pushed together, as on the inner
/// equator of a torus, would buckle and fold.
fn relax(shape: &AnyShape, draft: &mut Draft, steps: usize) {
    let Draft {
        preimages,
        triangles,
    } = draft;
    let mut positions = Vec::from_iter(preimages.iter().map(|&point| position(shape, point)));
    let mut pulls = vec![(DVec3::ZERO, 0.0); positions.len()];
    for _ in 0..steps {
        let rest = REST * mean_edge(triangles, &positions);
        pulls.fill((DVec3::ZERO, 0.0));
        for &[a, b, c] in triangles.iter() {
            for (tail, head) in [(a, b), (b, c), (c, a)] {
                // In a closed mesh every edge is met from both its ends.
                let edge = positions[head as usize] - positions[tail as usize];
                let (pull, count) = &mut pulls[tail as usize];
                *pull += edge * (1.0 - rest / edge.length()).max(0.0);
                *count += 1.0;
            }
        }
        for (v, &(pull, count)) in pulls.iter().enumerate() {
            let normal = DVec3::from(shape.at(preimages[v].to_array()).normal);
            let along = pull - normal * pull.dot(normal);
            preimages[v] = preimage(shape, positions[v] + along * (SHARE / count));
            positions[v] = position(shape, preimages[v]);
        }
    }
}

fn mean_edge(triangles: &[[u32; 3]], positions: &[DVec3]) -> f64 {
    let length = |a: u32, b: u32| positions[a as usize].distance(positions[b as usize]);
    let perimeters = triangles
        .iter()
        .map(|&[a, b, c]| length(a, b) + length(b, c) + length(c, a));
    perimeters.sum::<f64>() / (3 * triangles.len()) as f64
}
