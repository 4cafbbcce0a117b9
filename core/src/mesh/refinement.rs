//! The connectivity of a mesh whose triangles are divided in four, by arithmetic.

use super::{NONE, TriangleMesh, VertexKind, fingerprint};
use alloc::vec::Vec;

impl TriangleMesh {
    /// The mesh of which each triangle is divided in four at the middles of its edges.
    ///
    /// Vertices keep their numbers, middles follow in the order of the edges. Triangle t becomes
    /// 4t … 4t + 3: those at its three corners, and the middle one. Everything is what
    /// [`Self::new`] finds for these triangles; nothing has to be searched or checked, because all
    /// neighbours follow from those of the edges. The caller has checked the size of the result.
    pub(crate) fn refined(&self) -> Self {
        let coarse = self.vertex_count();
        let vertices = coarse + self.edges.len();
        let middles = self.middles();
        let quarters = |(&[a, b, c], &[ab, bc, ca]): (&[u32; 3], &[u32; 3])| {
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        let mut triangles = Vec::with_capacity(4 * middles.len());
        triangles.extend(self.triangles.iter().zip(&middles).flat_map(quarters));

        let edges = 2 * self.edges.len() + 3 * self.triangles.len();
        let mut fine = Self {
            fingerprint: fingerprint(vertices, &triangles),
            triangles,
            edges: Vec::with_capacity(edges),
            edge_triangles: Vec::with_capacity(edges),
            ring_offsets: Vec::with_capacity(vertices + 1),
            ring_vertices: Vec::with_capacity(2 * edges),
            vertex_kinds: Vec::with_capacity(vertices),
            boundary_edges: 2 * self.boundary_edges,
        };
        fine.ring_offsets.extend_from_slice(&self.ring_offsets);
        fine.vertex_kinds.extend_from_slice(&self.vertex_kinds);
        self.refine_around_vertices(&mut fine);
        self.refine_around_edges(&middles, &mut fine);
        fine
    }

    /// The number of the middle of the edge that leaves each corner of each triangle.
    fn middles(&self) -> Vec<[u32; 3]> {
        let mut middles = alloc::vec![[0; 3]; self.triangles.len()];
        let first = self.vertex_count() as u32;
        let all = self.edges.iter().zip(&self.edge_triangles);
        for (middle, (&[tail, head], &[left, right])) in (first..).zip(all) {
            middles[left as usize][self.corner(left, tail)] = middle;
            if right != NONE {
                middles[right as usize][self.corner(right, head)] = middle;
            }
        }
        middles
    }

    /// The place of a vertex among the corners of one of its triangles.
    fn corner(&self, triangle: u32, vertex: u32) -> usize {
        let [first, second, _] = self.triangles[triangle as usize];
        match vertex {
            _ if vertex == first => 0,
            _ if vertex == second => 1,
            _ => 2,
        }
    }

    /// Adds the edges and rings of the vertices that were there before.
    fn refine_around_vertices(&self, fine: &mut Self) {
        let count = self.vertex_count();
        let quarter = |triangle: u32, vertex| 4 * triangle + self.corner(triangle, vertex) as u32;
        // Edges are sorted by their tails.
        let mut offsets = alloc::vec![0u32; count + 1];
        for &[tail, _] in &self.edges {
            offsets[tail as usize + 1] += 1;
        }
        for vertex in 0..count {
            offsets[vertex + 1] += offsets[vertex];
        }
        let between = |tail: u32, head: u32| {
            let range = offsets[tail as usize]..offsets[tail as usize + 1];
            let mut heads = range.zip(&self.edges[offsets[tail as usize] as usize..]);
            heads
                .find(|(_, edge)| edge[1] == head)
                .map(|(edge, _)| edge)
        };
        let mut around = Vec::new();
        for vertex in 0..count as u32 {
            around.clear();
            let ring = self.one_ring(vertex as usize).iter();
            around.extend(ring.filter_map(|&neighbour| {
                let [low, high] = [vertex.min(neighbour), vertex.max(neighbour)];
                between(low, high).or_else(|| between(high, low))
            }));
            let ring = around.iter().map(|edge| count as u32 + edge);
            fine.ring_vertices.extend(ring);
            if self.is_interior(vertex as usize) {
                let start = fine.ring_vertices.len() - around.len();
                start_lowest(&mut fine.ring_vertices[start..]);
            }
            around.sort_unstable();
            for &edge in &around {
                let [left, right] = self.edge_triangles[edge as usize];
                let sides = if self.edges[edge as usize][0] == vertex {
                    let right = if right == NONE {
                        NONE
                    } else {
                        quarter(right, vertex)
                    };
                    [quarter(left, vertex), right]
                } else if right != NONE {
                    [quarter(right, vertex), quarter(left, vertex)]
                } else {
                    continue;
                };
                fine.edges.push([vertex, count as u32 + edge]);
                fine.edge_triangles.push(sides);
            }
        }
    }

    /// Adds the edges and rings of the middles of edges.
    fn refine_around_edges(&self, middles: &[[u32; 3]], fine: &mut Self) {
        let first = self.vertex_count() as u32;
        let all = self.edges.iter().zip(&self.edge_triangles);
        for (middle, (&[tail, head], &[left, right])) in (first..).zip(all) {
            let mut leaving = [([0; 2], [0; 2]); 5];
            let mut count = 0;
            let mut leave = |to: u32, sides: [u32; 2]| {
                leaving[count] = ([middle, to], sides);
                count += 1;
            };
            // In the triangle (a, b, c) beside its edge ab: the middles of bc and ca.
            let mut beside = |triangle: u32, a: u32| {
                let corner = self.corner(triangle, a);
                let numbers = middles[triangle as usize];
                let [bc, ca] = [1, 2].map(|next| numbers[(corner + next) % 3]);
                let at = |corner: usize| 4 * triangle + (corner % 3) as u32;
                let inner = 4 * triangle + 3;
                if bc > middle {
                    leave(bc, [inner, at(corner + 1)]);
                }
                if ca > middle {
                    leave(ca, [at(corner), inner]);
                }
                ([bc, ca], at(corner + 1))
            };
            let ([bc, ca], at_head) = beside(left, tail);
            if right == NONE {
                fine.ring_vertices.extend([head, bc, ca, tail]);
                fine.vertex_kinds.push(VertexKind::Boundary);
                leave(head, [at_head, NONE]);
            } else {
                let ([ad, db], _) = beside(right, head);
                fine.ring_vertices.extend(if head < tail {
                    [head, bc, ca, tail, ad, db]
                } else {
                    [tail, ad, db, head, bc, ca]
                });
                fine.vertex_kinds.push(VertexKind::Interior);
            }
            fine.ring_offsets.push(fine.ring_vertices.len() as u32);
            leaving[..count].sort_unstable();
            for &(edge, sides) in &leaving[..count] {
                fine.edges.push(edge);
                fine.edge_triangles.push(sides);
            }
        }
    }
}

/// Turns a ring until its lowest vertex is the first.
fn start_lowest(ring: &mut [u32]) {
    let lowest = ring.iter().enumerate().min_by_key(|(_, vertex)| **vertex);
    if let Some((place, _)) = lowest {
        ring.rotate_left(place);
    }
}
