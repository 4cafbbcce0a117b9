//! Half-edges: from triangles to edges and one-rings, with the checks of a manifold.

use super::{MeshError, NONE, VertexKind};
use alloc::vec::Vec;

/// The half-edges of the triangles, each identified by the corner `3 * triangle + 0, 1 or 2` at its
/// start.
pub(super) struct HalfEdges<'a> {
    triangles: &'a [[u32; 3]],
    /// Start in `entries` of the half-edges that leave each vertex.
    offsets: Vec<u32>,
    /// `(head, corner)`, sorted, vertex by vertex.
    entries: Vec<(u32, u32)>,
    /// For each corner, the corner at the start of the opposite half-edge; `NONE` at the boundary.
    opposite: Vec<u32>,
}

impl<'a> HalfEdges<'a> {
    /// The half-edges of triangles with three different vertices below `vertices`.
    ///
    /// # Errors
    /// The first reason found in a pair of triangles why they are no surface.
    pub(super) fn new(vertices: usize, triangles: &'a [[u32; 3]]) -> Result<Self, MeshError> {
        let mut offsets = alloc::vec![0u32; vertices + 1];
        for triangle in triangles {
            for &vertex in triangle {
                offsets[vertex as usize + 1] += 1;
            }
        }
        for v in 0..vertices {
            offsets[v + 1] += offsets[v];
        }
        let mut next = offsets.clone();
        let mut entries = alloc::vec![(0u32, 0u32); 3 * triangles.len()];
        for (t, triangle) in triangles.iter().enumerate() {
            for corner in 0..3 {
                let slot = &mut next[triangle[corner] as usize];
                entries[*slot as usize] = (triangle[(corner + 1) % 3], (3 * t + corner) as u32);
                *slot += 1;
            }
        }
        for v in 0..vertices {
            entries[offsets[v] as usize..offsets[v + 1] as usize].sort_unstable();
        }
        let opposite = alloc::vec![NONE; 3 * triangles.len()];
        let mut half_edges = Self {
            triangles,
            offsets,
            entries,
            opposite,
        };
        half_edges.pair()?;
        Ok(half_edges)
    }

    fn vertex_count(&self) -> u32 {
        self.offsets.len() as u32 - 1
    }

    /// The vertex opposite to the half-edge that leaves this corner.
    fn apex(&self, corner: u32) -> u32 {
        let previous = previous_corner(corner) as usize;
        self.triangles[previous / 3][previous % 3]
    }

    fn leaving(&self, vertex: u32) -> &[(u32, u32)] {
        let v = vertex as usize;
        &self.entries[self.offsets[v] as usize..self.offsets[v + 1] as usize]
    }

    /// The place of `tail -> head` among the half-edges that leave `tail`.
    fn find(&self, tail: u32, head: u32) -> Option<usize> {
        let leaving = self.leaving(tail);
        if leaving.len() <= 16 {
            leaving.iter().position(|entry| entry.0 == head)
        } else {
            leaving.binary_search_by_key(&head, |entry| entry.0).ok()
        }
    }

    /// The next corner at the same vertex, counter-clockwise; `NONE` at a boundary.
    fn next_around(&self, corner: u32) -> u32 {
        self.opposite[previous_corner(corner) as usize]
    }

    /// Finds the opposite half-edges. Every directed edge must occur once, and no two triangles may
    /// have the same vertices.
    fn pair(&mut self) -> Result<(), MeshError> {
        for tail in 0..self.vertex_count() {
            let end = self.offsets[tail as usize + 1] as usize;
            for at in self.offsets[tail as usize] as usize..end {
                let (head, corner) = self.entries[at];
                if let Some(&(next_head, second)) = self.entries[at + 1..end].first()
                    && next_head == head
                {
                    return Err(self.same_direction([tail, head], [corner, second]));
                }
                if tail > head {
                    continue;
                }
                let Some(found) = self.find(head, tail) else {
                    continue;
                };
                let other = self.leaving(head)[found].1;
                if self.apex(corner) == self.apex(other) {
                    let (first, second) = (corner / 3, other / 3);
                    return Err(MeshError::DuplicateTriangle {
                        first: first.min(second),
                        second: first.max(second),
                    });
                }
                self.opposite[corner as usize] = other;
                self.opposite[other as usize] = corner;
            }
        }
        Ok(())
    }

    /// The error for two half-edges with the same tail and head.
    #[cold]
    fn same_direction(&self, [tail, head]: [u32; 2], corners: [u32; 2]) -> MeshError {
        let [first, second] = corners.map(|corner| corner / 3);
        if self.apex(corners[0]) == self.apex(corners[1]) {
            return MeshError::DuplicateTriangle { first, second };
        }
        let count = |from: u32, to: u32| {
            let heads = self.leaving(from).iter().map(|entry| entry.0);
            heads.filter(|&head| head == to).count() as u32
        };
        let meeting = count(tail, head) + count(head, tail);
        if meeting > 2 {
            MeshError::NonManifoldEdge {
                edge: [tail, head],
                triangles: meeting,
                triangle: second,
            }
        } else {
            MeshError::InconsistentOrientation {
                edge: [tail, head],
                triangles: [first, second],
            }
        }
    }

    /// Each edge once, and the triangles at its left and right.
    pub(super) fn edges(&self) -> (Vec<[u32; 2]>, Vec<[u32; 2]>) {
        let mut edges = Vec::with_capacity(self.opposite.len() / 2);
        let mut sides = Vec::with_capacity(self.opposite.len() / 2);
        for tail in 0..self.vertex_count() {
            for &(head, corner) in self.leaving(tail) {
                let opposite = self.opposite[corner as usize];
                if tail < head || opposite == NONE {
                    let right = if opposite == NONE { NONE } else { opposite / 3 };
                    edges.push([tail, head]);
                    sides.push([corner / 3, right]);
                }
            }
        }
        (edges, sides)
    }

    /// The offsets and entries of one-rings in counter-clockwise order, and the kind of each vertex.
    ///
    /// # Errors
    /// If the triangles at a vertex form more than one fan.
    #[expect(
        clippy::type_complexity,
        reason = "three columns of one table, taken apart at once"
    )]
    pub(super) fn rings(&self) -> Result<(Vec<u32>, Vec<u32>, Vec<VertexKind>), MeshError> {
        let vertices = self.vertex_count() as usize;
        let mut offsets = Vec::with_capacity(vertices + 1);
        let mut ring = Vec::with_capacity(self.opposite.len() + vertices / 4);
        let mut kinds = Vec::with_capacity(vertices);
        offsets.push(0);
        for vertex in 0..self.vertex_count() {
            let leaving = self.leaving(vertex);
            // An open fan starts at the boundary, a closed one at the lowest neighbour.
            let open = leaving
                .iter()
                .find(|&&(_, corner)| self.opposite[corner as usize] == NONE);
            let mut reached = 0;
            if let Some(&(head, start)) = open.or(leaving.first()) {
                ring.push(head);
                let mut corner = start;
                loop {
                    reached += 1;
                    let next = self.next_around(corner);
                    if next == start {
                        break;
                    }
                    ring.push(self.apex(corner));
                    if next == NONE {
                        break;
                    }
                    corner = next;
                }
            }
            if reached < leaving.len() {
                return Err(self.separate_fans(vertex));
            }
            kinds.push(if leaving.is_empty() {
                VertexKind::Isolated
            } else if open.is_some() {
                VertexKind::Boundary
            } else {
                VertexKind::Interior
            });
            offsets.push(ring.len() as u32);
        }
        Ok((offsets, ring, kinds))
    }

    /// The error for a vertex whose triangles form more than one fan.
    fn separate_fans(&self, vertex: u32) -> MeshError {
        let leaving = self.leaving(vertex);
        let next = Vec::from_iter(
            leaving
                .iter()
                .map(|&(_, corner)| self.find(vertex, self.apex(corner))),
        );
        // An open fan starts where no triangle precedes; corners that open fans do not reach are in
        // closed fans.
        let mut is_start = alloc::vec![true; leaving.len()];
        for &next in next.iter().flatten() {
            is_start[next] = false;
        }
        let mut starts = Vec::from_iter((0..leaving.len()).filter(|&at| is_start[at]));
        starts.extend((0..leaving.len()).filter(|&at| !is_start[at]));
        let mut seen = alloc::vec![false; leaving.len()];
        let mut fans = 0;
        let mut found = [0; 2];
        for start in starts {
            if seen[start] {
                continue;
            }
            if let Some(triangle) = found.get_mut(fans as usize) {
                *triangle = leaving[start].1 / 3;
            }
            fans += 1;
            let mut at = Some(start);
            while let Some(here) = at.filter(|&here| !seen[here]) {
                seen[here] = true;
                at = next[here];
            }
        }
        MeshError::NonManifoldVertex {
            vertex,
            fans,
            triangles: found,
        }
    }
}

/// The corner before this one in its triangle.
fn previous_corner(corner: u32) -> u32 {
    if corner.is_multiple_of(3) {
        corner + 2
    } else {
        corner - 1
    }
}
