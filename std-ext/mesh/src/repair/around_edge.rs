//! Triangles around an edge: which of them continue each other.

use glam::DVec3;
use std::f64::consts::PI;

/// Most triangles at an edge of which all pairs are compared.
const MOST_COMPARED: usize = 16;

/// A triangle at an edge.
pub(super) struct Leaf {
    /// Its third corner.
    pub(super) apex: [f64; 3],
    /// Whether it runs from the first end of the edge to the second.
    pub(super) is_forward: bool,
}

/// The vector from one point to another in units of its largest coordinate, which cannot overflow later.
fn direction(from: [f64; 3], to: [f64; 3]) -> DVec3 {
    let vector = DVec3::from(to) - DVec3::from(from);
    vector / vector.abs().max_element()
}

/// Pairs of triangles that are neighbours at an edge with three or more. The others end there.
pub(super) fn pairs([from, to]: [[f64; 3]; 2], leaves: &[Leaf]) -> Vec<[usize; 2]> {
    let Some(along) = direction(from, to).try_normalize() else {
        return Vec::new();
    };
    let across = along.any_orthonormal_vector();
    let beyond = along.cross(across);
    let angle = |leaf: &Leaf| {
        let apex = direction(from, leaf.apex);
        apex.dot(beyond).atan2(apex.dot(across))
    };
    let angles = Vec::from_iter(leaves.iter().map(angle));
    let mut order = Vec::from_iter(0..leaves.len());
    order.sort_by(|&one, &other| angles[one].total_cmp(&angles[other]).then(one.cmp(&other)));
    let neighbours = (0..order.len()).map(|at| [order[at], order[(at + 1) % order.len()]]);
    let is_alternating =
        |&[one, other]: &[usize; 2]| leaves[one].is_forward != leaves[other].is_forward;
    if neighbours.clone().all(|pair| is_alternating(&pair)) {
        // A triangle that runs forward has its body below its angle, the others above.
        return neighbours
            .filter(|&[first, _]| !leaves[first].is_forward)
            .collect();
    }
    if leaves.len() > MOST_COMPARED {
        return Vec::new();
    }
    least_bent(&angles, leaves)
}

/// The pair that is least bent, then the next of the others; at equal angles those that run in opposite directions.
fn least_bent(angles: &[f64], leaves: &[Leaf]) -> Vec<[usize; 2]> {
    let all = (0..leaves.len()).flat_map(|other| (0..other).map(move |one| [one, other]));
    let mut rated = Vec::from_iter(all.map(|pair| {
        let [one, other] = pair.map(|leaf| angles[leaf]);
        let contradicts = leaves[pair[0]].is_forward == leaves[pair[1]].is_forward;
        (((one - other).abs() - PI).abs(), contradicts, pair)
    }));
    rated.sort_by(|one, other| {
        let by_angle = one.0.total_cmp(&other.0);
        by_angle.then_with(|| (one.1, one.2).cmp(&(other.1, other.2)))
    });
    let mut is_taken = vec![false; leaves.len()];
    let mut pairs = Vec::new();
    for (_, _, pair) in rated {
        if pair.iter().all(|&leaf| !is_taken[leaf]) {
            for leaf in pair {
                is_taken[leaf] = true;
            }
            pairs.push(pair);
        }
    }
    pairs
}
