//! The limit surface over one triangle.

use super::masks::{EDGE, limit_weight, vertex_weight};
use super::regular::{Basis, regular_basis};
use crate::mesh::{TriangleMesh, VertexKind};
use alloc::vec::Vec;

/// The vertices on whose control points the limit surface over a triangle depends.
///
/// The triangle's corners are v0, v1, v2, counter-clockwise, with coordinates (v, w) = (0, 0),
/// (1, 0) and (0, 1). If one of them is extraordinary it is v0. The nodes are
///
/// * 0: v0, and 1 … N its neighbours, counter-clockwise from v1, so that 2 is v2;
/// * N + 1 … N + 5: the other neighbours of v1 and v2, counter-clockwise; the third of them lies
///   across the edge from v1 to v2.
///
/// A vertex may be several nodes if the mesh is tiny.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Patch {
    /// The corner of the triangle, 0, 1 or 2, that is v0.
    pub first_corner: usize,
    /// The nodes' vertices, N + 6 of them.
    pub nodes: Vec<u32>,
}

/// The reason why a triangle has no [`Patch`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
#[non_exhaustive]
pub enum NoPatch {
    /// A corner lies on the boundary, where neighbours are missing.
    #[error("a corner of the triangle lies on the boundary")]
    Boundary,
    /// Two or three corners are extraordinary; after one refinement of the mesh each of the four
    /// triangles has one such corner at most.
    #[error("the triangle has {corners} extraordinary corners: refine the mesh once")]
    SeveralExtraordinary {
        /// Number of such corners.
        corners: usize,
    },
}

impl Patch {
    /// The patch of a triangle.
    ///
    /// # Errors
    /// If the triangle has none; see [`NoPatch`].
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn new(mesh: &TriangleMesh, triangle: usize) -> Result<Self, NoPatch> {
        let corners = mesh.triangles()[triangle].map(|vertex| vertex as usize);
        if corners
            .iter()
            .any(|&v| mesh.vertex_kind(v) != VertexKind::Interior)
        {
            return Err(NoPatch::Boundary);
        }
        let is_extraordinary = |corner: &usize| mesh.valence(corners[*corner]) != 6;
        let extraordinary = (0..3).filter(is_extraordinary).count();
        if extraordinary > 1 {
            let corners = extraordinary;
            return Err(NoPatch::SeveralExtraordinary { corners });
        }
        let first_corner = (0..3).find(is_extraordinary).unwrap_or(0);
        let [v0, v1, v2] = [0, 1, 2].map(|k| corners[(first_corner + k) % 3]);
        let mut nodes = Vec::with_capacity(mesh.valence(v0) + 6);
        nodes.push(v0 as u32);
        nodes.extend(ring_from(mesh, v0, v1));
        nodes.extend(ring_from(mesh, v1, v0).skip(2).take(3));
        nodes.extend(ring_from(mesh, v2, v0).skip(3).take(2));
        Ok(Self {
            first_corner,
            nodes,
        })
    }

    /// The valence N of v0.
    pub fn valence(&self) -> usize {
        self.nodes.len() - 6
    }
}

/// The neighbours of an interior vertex, counter-clockwise from one of them.
fn ring_from(mesh: &TriangleMesh, vertex: usize, start: usize) -> impl Iterator<Item = u32> {
    let ring = mesh.one_ring(vertex);
    let place = ring.iter().position(|&v| v as usize == start).unwrap_or(0);
    ring[place..].iter().chain(&ring[..place]).copied()
}

/// The basis functions of a [`Patch`] at (v, w), one for each of its N + 6 nodes.
///
/// Around an extraordinary vertex the patch is refined until (v, w) lies in a part that is regular.
/// The values sum to 1, each of the derivatives to 0.
///
/// `None` outside the triangle and for valences below 3. At an extraordinary v0 itself the value is
/// the limit's, and the derivatives, which do not exist, are NaN.
pub fn basis(valence: usize, v: f64, w: f64) -> Option<Vec<Basis>> {
    let inside = v >= 0.0 && w >= 0.0 && v + w <= 1.0;
    if !inside || valence < 3 {
        return None;
    }
    if valence == 6 {
        return Some(regular_basis(v, w).to_vec());
    }
    if v + w <= 0.0 {
        return Some(at_extraordinary_vertex(valence));
    }
    Some(irregular_basis(valence, v, w))
}

fn at_extraordinary_vertex(valence: usize) -> Vec<Basis> {
    let omega = limit_weight(valence);
    let weight = |node: usize| match node {
        0 => 1.0 - valence as f64 * omega,
        _ if node <= valence => omega,
        _ => 0.0,
    };
    let basis = |node| Basis {
        value: weight(node),
        first: [f64::NAN; 2],
        second: [f64::NAN; 3],
    };
    (0..valence + 6).map(basis).collect()
}

/// J. Stam, Evaluation of Loop subdivision surfaces (1998), but without eigenvectors: this takes
/// one product per level and avoids an eigenvalue problem that may be ill-conditioned.
fn irregular_basis(valence: usize, mut v: f64, mut w: f64) -> Vec<Basis> {
    let nodes = valence + 6;
    let refinement = refinement(valence);
    // The weight of each original node in each node of the patch at the current level.
    let mut weights: Vec<Vec<f64>> = (0..nodes)
        .map(|row| (0..nodes).map(|column| f64::from(row == column)).collect())
        .collect();
    let mut scale = 1.0;
    loop {
        let refined = Vec::from_iter(refinement.iter().map(|row| combine(row, &weights)));
        scale *= 2.0;
        // Doubling is exact: the parts are half-open, and no point is lost between them.
        if v + w >= 0.5 {
            let (part, [v, w], sign) = regular_part(valence, v, w);
            return pull_back(
                &part.map(|node| refined[node].as_slice()),
                v,
                w,
                sign * scale,
            );
        }
        (v, w) = (2.0 * v, 2.0 * w);
        weights = refined;
        weights.truncate(nodes);
    }
}

/// Σ weight · row over the entries of a sparse row.
fn combine(sparse: &[(usize, f64)], rows: &[Vec<f64>]) -> Vec<f64> {
    let mut sum = alloc::vec![0.0; rows.len()];
    for &(node, weight) in sparse {
        for (sum, entry) in sum.iter_mut().zip(&rows[node]) {
            *sum += weight * entry;
        }
    }
    sum
}

/// The regular basis at (v, w), through the weights of the original nodes in its twelve nodes.
/// `slope` is ±2^level: how (v, w) grow with the original coordinates.
fn pull_back(part: &[&[f64]; 12], v: f64, w: f64, slope: f64) -> Vec<Basis> {
    let mut sum = alloc::vec![Basis::default(); part[0].len()];
    for (basis, weights) in regular_basis(v, w).iter().zip(part) {
        for (sum, &weight) in sum.iter_mut().zip(*weights) {
            sum.value += weight * basis.value;
            for k in 0..2 {
                sum.first[k] += slope * weight * basis.first[k];
            }
            for k in 0..3 {
                sum.second[k] += slope * slope * weight * basis.second[k];
            }
        }
    }
    sum
}

/// The part of a refined patch in which (v, w), v + w ≥ 1/2, lies: its twelve nodes among those of
/// [`refinement`], the coordinates in it, and −1 if they run backwards.
fn regular_part(valence: usize, v: f64, w: f64) -> ([usize; 12], [f64; 2], f64) {
    let n = valence;
    let spoke = |k: usize| 1 + k % n;
    let (s1, s2, s3, sn) = (spoke(0), spoke(1), spoke(2), spoke(n - 1));
    let [e1n, v1, e12, v2, e23, e17, e18, e19, e29, e210, e211] =
        core::array::from_fn(|k| n + 1 + k);
    if v >= 0.5 {
        let nodes = [s1, v1, e12, s2, 0, sn, e1n, e17, e18, e19, e29, v2];
        (nodes, [2.0 * v - 1.0, 2.0 * w], 1.0)
    } else if w >= 0.5 {
        let nodes = [s2, e12, v2, e23, s3, 0, s1, v1, e19, e29, e210, e211];
        (nodes, [2.0 * v, 2.0 * w - 1.0], 1.0)
    } else {
        // The middle triangle is upside down.
        let nodes = [e12, s2, s1, v1, e19, e29, v2, e23, s3, 0, sn, e1n];
        (nodes, [1.0 - 2.0 * v, 1.0 - 2.0 * w], -1.0)
    }
}

/// One refinement of a patch with v0 of valence N: for each of its N + 12 nodes the weights of the
/// N + 6 coarse ones. The first N + 6 are the nodes of the patch at v0, in their order.
fn refinement(valence: usize) -> Vec<Vec<(usize, f64)>> {
    let n = valence;
    let ring = |k: usize| 1 + k % n;
    let (v0, v1, v2, r3, rn) = (0, 1, 2, ring(2), ring(n - 1));
    let [o7, o8, o9, o10, o11] = core::array::from_fn(|k| n + 1 + k);
    let edge = |ends: [usize; 2], sides: [usize; 2]| {
        let ends = ends.map(|node| (node, EDGE[0]));
        let sides = sides.map(|node| (node, EDGE[1]));
        Vec::from_iter(ends.into_iter().chain(sides))
    };
    let vertex = |centre: usize, neighbours: &[usize]| {
        let beta = vertex_weight(neighbours.len());
        let own = (centre, 1.0 - neighbours.len() as f64 * beta);
        let others = neighbours.iter().map(|&node| (node, beta));
        Vec::from_iter(core::iter::once(own).chain(others))
    };
    let mut rows = Vec::with_capacity(n + 12);
    rows.push(vertex(v0, &Vec::from_iter(1..=n)));
    rows.extend((0..n).map(|k| edge([v0, ring(k)], [ring(k + n - 1), ring(k + 1)])));
    rows.push(edge([v1, rn], [v0, o7]));
    rows.push(vertex(v1, &[v0, rn, o7, o8, o9, v2]));
    rows.push(edge([v1, v2], [v0, o9]));
    rows.push(vertex(v2, &[v0, v1, o9, o10, o11, r3]));
    rows.push(edge([v2, r3], [v0, o11]));
    rows.push(edge([v1, o7], [rn, o8]));
    rows.push(edge([v1, o8], [o7, o9]));
    rows.push(edge([v1, o9], [o8, v2]));
    rows.push(edge([v2, o9], [v1, o10]));
    rows.push(edge([v2, o10], [o9, o11]));
    rows.push(edge([v2, o11], [o10, r3]));
    rows
}
