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

/// The angle between the normals of its ends by which an edge may turn before its spring grows
/// stiffer, in root mean squares over the edges of the mesh as it begins.
const TURN: f64 = 4.0;

/// The largest such limit as the squared difference of unit normals, an angle of 60°, beyond which an
/// edge cuts corners; it matters on coarse meshes only.
const LARGEST_TURN: f64 = 1.0;

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
///
/// Springs alone settle near the conformal map, which leaves the tips of long shapes and the rims of
/// flat ones without vertices: the mesh slides off. An edge whose normals turn by an angle φ beyond the limit φ₀ is
/// (φ/φ₀)⁶ times as stiff: vertices stay where the surface is curved, and where no edge turns that
/// far nothing changes.
fn relax(shape: &AnyShape, draft: &mut Draft, steps: usize) {
    let Draft {
        preimages,
        triangles,
    } = draft;
    let mut positions = Vec::from_iter(preimages.iter().map(|&point| position(shape, point)));
    let mut normals = Vec::from_iter(preimages.iter().map(|&point| normal(shape, point)));
    let most = (TURN * TURN * mean_turn(triangles, &normals)).min(LARGEST_TURN);
    let mut pulls = vec![(DVec3::ZERO, 0.0); positions.len()];
    for _ in 0..steps {
        let rest = REST * mean_edge(triangles, &positions);
        pulls.fill((DVec3::ZERO, 0.0));
        for &[a, b, c] in triangles.iter() {
            for (tail, head) in [(a, b), (b, c), (c, a)] {
                // In a closed mesh every edge is met from both its ends.
                let [tail, head] = [tail as usize, head as usize];
                let edge = positions[head] - positions[tail];
                let turn = normals[head].distance_squared(normals[tail]) / most;
                let stiffness = if turn > 1.0 { turn * turn * turn } else { 1.0 };
                let (pull, stiff) = &mut pulls[tail];
                *pull += edge * (stiffness * (1.0 - rest / edge.length()).max(0.0));
                *stiff += stiffness;
            }
        }
        for (v, &(pull, stiff)) in pulls.iter().enumerate() {
            let along = pull - normals[v] * pull.dot(normals[v]);
            preimages[v] = preimage(shape, positions[v] + along * (SHARE / stiff));
            positions[v] = position(shape, preimages[v]);
            normals[v] = normal(shape, preimages[v]);
        }
    }
}

/// The exact outward normal.
fn normal(shape: &AnyShape, preimage: DVec3) -> DVec3 {
    shape.at(preimage.to_array()).normal.into()
}

/// The mean squared difference of the normals at the ends of an edge.
fn mean_turn(triangles: &[[u32; 3]], normals: &[DVec3]) -> f64 {
    let turn = |a: u32, b: u32| normals[a as usize].distance_squared(normals[b as usize]);
    mean_of_edges(triangles, turn)
}

fn mean_edge(triangles: &[[u32; 3]], positions: &[DVec3]) -> f64 {
    let length = |a: u32, b: u32| positions[a as usize].distance(positions[b as usize]);
    mean_of_edges(triangles, length)
}

fn mean_of_edges(triangles: &[[u32; 3]], value: impl Fn(u32, u32) -> f64) -> f64 {
    let sums = triangles
        .iter()
        .map(|&[a, b, c]| value(a, b) + value(b, c) + value(c, a));
    sums.sum::<f64>() / (3 * triangles.len()) as f64
}
