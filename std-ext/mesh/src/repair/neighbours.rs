//! Neighbours of triangles, such that the triangles are an oriented manifold.

use super::around_edge::{Leaf, pairs};

/// Marks an edge of a triangle without a neighbour.
const NONE: u32 = u32::MAX;

/// Triangles that have become a manifold. A corner is numbered 3 × triangle + 0, 1 or 2; so is the edge that starts
/// there.
pub(super) struct Manifold {
    /// The vertex of each corner: the lowest corner of its fan.
    pub(super) vertices: Vec<[u32; 3]>,
    /// Whether each triangle has to be reversed.
    pub(super) is_reversed: Vec<bool>,
    /// The edges of the triangles at each edge with three or more.
    pub(super) crowded: Vec<Vec<u32>>,
    /// Pairs of edges that were cut because the surface has only one side.
    pub(super) cut: Vec<[u32; 2]>,
}

impl Manifold {
    /// The manifold of triangles with three different corners each, no two with the same three; `unmerged` are the
    /// same triangles before vertices were merged.
    ///
    /// In the first round triangles around an edge are paired by their angles, and fans become vertices. Where two
    /// pairs of an edge are still in one fan at both of its ends, they cannot be told apart by their vertices: in the
    /// second round no triangle has a neighbour there, which separates at least every third one. Rounds end when
    /// they split nothing, after four at most.
    pub(super) fn new(
        positions: &[[f64; 3]],
        triangles: &[[u32; 3]],
        unmerged: &[[u32; 3]],
    ) -> Self {
        let mut found = Self {
            vertices: triangles.to_vec(),
            is_reversed: vec![false; triangles.len()],
            crowded: Vec::new(),
            cut: Vec::new(),
        };
        let mut count = count_distinct(&found.vertices, positions.len());
        let mut is_first = true;
        loop {
            let (mut mates, crowded) = mates(&found.vertices);
            let is_done = crowded.is_empty();
            if is_first {
                for edges in &crowded {
                    let rest = pair_again(unmerged, edges, &mut mates);
                    pair(positions, triangles, &rest, &mut mates);
                }
                found.crowded = crowded;
            }
            is_first = false;
            found.orient(&mut mates);
            let fans;
            (found.vertices, fans) = vertices(&found.vertices, &mates);
            if is_done && fans == count {
                return found;
            }
            count = fans;
        }
    }

    /// Reverses the fewer triangles of each component, and cuts where that leaves a contradiction.
    fn orient(&mut self, mates: &mut [u32]) {
        let names = self.vertices.as_flattened();
        let agree = |one: u32, other: u32| names[one as usize] != names[other as usize];
        let mut is_seen = vec![false; self.vertices.len()];
        let mut component = Vec::new();
        self.is_reversed.fill(false);
        for start in 0..self.vertices.len() {
            if is_seen[start] {
                continue;
            }
            is_seen[start] = true;
            component.clear();
            component.push(start as u32);
            let (mut at, mut reversed) = (0, 0);
            while let Some(&triangle) = component.get(at) {
                at += 1;
                // In the order of triangles, which does not depend on the order of corners.
                let mut edges = [0, 1, 2].map(|corner| {
                    let edge = 3 * triangle + corner;
                    (mates[edge as usize], edge)
                });
                edges.sort_unstable();
                for (mate, edge) in edges {
                    let neighbour = (mate / 3) as usize;
                    if mate == NONE || is_seen[neighbour] {
                        continue;
                    }
                    is_seen[neighbour] = true;
                    let is_reversed = self.is_reversed[triangle as usize] == agree(edge, mate);
                    self.is_reversed[neighbour] = is_reversed;
                    reversed += usize::from(is_reversed);
                    component.push(neighbour as u32);
                }
            }
            if 2 * reversed > component.len() {
                for &triangle in &component {
                    self.is_reversed[triangle as usize] ^= true;
                }
            }
        }
        for edge in 0..mates.len() as u32 {
            let mate = mates[edge as usize];
            if mate == NONE || mate < edge {
                continue;
            }
            let [one, other] = [edge, mate].map(|edge| self.is_reversed[edge as usize / 3]);
            if (one == other) != agree(edge, mate) {
                mates[edge as usize] = NONE;
                mates[mate as usize] = NONE;
                self.cut.push([edge, mate]);
            }
        }
    }
}

/// The corner after this one in its triangle.
pub(super) fn next(corner: u32) -> u32 {
    if corner % 3 == 2 {
        corner - 2
    } else {
        corner + 1
    }
}

/// For each edge of a triangle that of its neighbour, and the edges that three or more triangles share.
fn mates(triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<Vec<u32>>) {
    let names = triangles.as_flattened();
    let mut edges = Vec::from_iter((0..names.len() as u32).map(|edge| {
        let [from, to] = [edge, next(edge)].map(|corner| names[corner as usize]);
        (from.min(to), from.max(to), edge)
    }));
    edges.sort_unstable();
    let mut mates = vec![NONE; names.len()];
    let mut crowded = Vec::new();
    for group in edges.chunk_by(|one, other| (one.0, one.1) == (other.0, other.1)) {
        match *group {
            [_] => {}
            [(_, _, one), (_, _, other)] => {
                mates[one as usize] = other;
                mates[other as usize] = one;
            }
            _ => crowded.push(group.iter().map(|&(_, _, edge)| edge).collect()),
        }
    }
    (mates, crowded)
}

/// Makes neighbours of triangles that were before vertices were merged, which makes the edge crowded, and returns
/// the edges of the others.
fn pair_again(unmerged: &[[u32; 3]], edges: &[u32], mates: &mut [u32]) -> Vec<u32> {
    let name = |corner: u32| unmerged.as_flattened()[corner as usize];
    let mut named = Vec::from_iter(edges.iter().map(|&edge| {
        let [from, to] = [name(edge), name(next(edge))];
        ([from.min(to), from.max(to)], edge)
    }));
    named.sort_unstable();
    let mut rest = Vec::new();
    for group in named.chunk_by(|one, other| one.0 == other.0) {
        match *group {
            [(_, one), (_, other)] => {
                mates[one as usize] = other;
                mates[other as usize] = one;
            }
            _ => rest.extend(group.iter().map(|&(_, edge)| edge)),
        }
    }
    rest.sort_unstable();
    rest
}

/// Makes neighbours of triangles that continue each other at a crowded edge.
fn pair(positions: &[[f64; 3]], triangles: &[[u32; 3]], edges: &[u32], mates: &mut [u32]) {
    let name = |corner: u32| triangles.as_flattened()[corner as usize];
    let Some(&first) = edges.first() else { return };
    let ends = [name(first), name(next(first))];
    let leaves = Vec::from_iter(edges.iter().map(|&edge| Leaf {
        apex: positions[name(next(next(edge))) as usize],
        is_forward: name(edge) == ends[0],
    }));
    for pair in pairs(ends.map(|end| positions[end as usize]), &leaves) {
        let [one, other] = pair.map(|leaf| edges[leaf]);
        mates[one as usize] = other;
        mates[other as usize] = one;
    }
}

/// The vertices as fans of neighbours, each named by its lowest corner, and their number.
fn vertices(triangles: &[[u32; 3]], mates: &[u32]) -> (Vec<[u32; 3]>, usize) {
    let names = triangles.as_flattened();
    let mut parents = Vec::from_iter(0..names.len() as u32);
    for (edge, &mate) in (0u32..).zip(mates) {
        if mate == NONE || mate < edge {
            continue;
        }
        let own = [edge, next(edge)];
        let mut others = [mate, next(mate)];
        if names[own[0] as usize] != names[others[0] as usize] {
            others.reverse();
        }
        for (own, other) in own.into_iter().zip(others) {
            join(&mut parents, own, other);
        }
    }
    let mut fans = 0;
    for corner in 0..parents.len() {
        fans += usize::from(parents[corner] as usize == corner);
        // A parent is lower than its child, and is a root already.
        parents[corner] = parents[parents[corner] as usize];
    }
    let (corners, _) = parents.as_chunks::<3>();
    (corners.to_vec(), fans)
}

/// The root of an element of a forest, whose path is halved.
pub(super) fn root(parents: &mut [u32], mut element: u32) -> u32 {
    while parents[element as usize] != element {
        let above = parents[parents[element as usize] as usize];
        parents[element as usize] = above;
        element = above;
    }
    element
}

/// Joins the trees of two elements under the lower root.
pub(super) fn join(parents: &mut [u32], one: u32, other: u32) {
    let [one, other] = [one, other].map(|element| root(parents, element));
    parents[one.max(other) as usize] = one.min(other);
}

fn count_distinct(triangles: &[[u32; 3]], vertices: usize) -> usize {
    let mut is_used = vec![false; vertices];
    for &vertex in triangles.as_flattened() {
        is_used[vertex as usize] = true;
    }
    is_used.iter().filter(|&&is_used| is_used).count()
}
