//! Connectivity of a triangle mesh, without coordinates.

use alloc::vec::Vec;

/// Marks the missing side of a boundary edge in [`TriangleMesh::edge_triangles`].
const NONE: u32 = u32::MAX;

/// An oriented, manifold triangle mesh, closed or with boundary: connectivity only.
///
/// Validated once, by [`TriangleMesh::new`]. Every instance guarantees:
/// * every index is in range and every triangle has three different vertices;
/// * every edge belongs to one or two triangles, which run through it in opposite directions;
/// * the triangles at a vertex form one fan, closed at an interior vertex, open at a boundary one;
/// * no two triangles have the same three vertices.
///
/// Vertices that no triangle uses are allowed and take part in nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TriangleMesh {
    triangles: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
    edge_triangles: Vec<[u32; 2]>,
    ring_offsets: Vec<u32>,
    ring_vertices: Vec<u32>,
    vertex_kinds: Vec<VertexKind>,
    boundary_edges: u32,
    fingerprint: u64,
}

/// The position of a vertex in its mesh: interior, at a boundary, or in no triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum VertexKind {
    /// Surrounded by triangles.
    #[default]
    Interior,
    /// At the end of a boundary edge.
    Boundary,
    /// In no triangle.
    Isolated,
}

/// The reason why triangles do not form a [`TriangleMesh`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// There are no triangles.
    #[error("the mesh is empty: it has no triangle")]
    Empty,
    /// A list of indices that does not end with a whole triangle.
    #[error("{indices} indices are not a multiple of three: each triangle has three")]
    IncompleteTriangle {
        /// Number of indices.
        indices: usize,
    },
    /// More vertices or triangles than 32-bit indices can name.
    #[error("{count} {what} are too many: the limit is {limit}")]
    TooLarge {
        /// `"vertices"` or `"triangles"`.
        what: &'static str,
        /// The number of these.
        count: usize,
        /// The largest possible number.
        limit: usize,
    },
    /// A triangle names a vertex that does not exist.
    #[error(
        "triangle {triangle} names vertex {vertex}, but there are {vertices} vertices, numbered from 0"
    )]
    VertexOutOfRange {
        /// The triangle, from 0.
        triangle: u32,
        /// The vertex that it names.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A triangle names a vertex twice.
    #[error("triangle {triangle} names vertex {vertex} twice: three different vertices are needed")]
    RepeatedVertex {
        /// The triangle, from 0.
        triangle: u32,
        /// The vertex.
        vertex: u32,
    },
    /// Two triangles have the same three vertices.
    #[error("triangles {first} and {second} have the same three vertices")]
    DuplicateTriangle {
        /// The first of them.
        first: u32,
        /// The second of them.
        second: u32,
    },
    /// Three or more triangles meet in an edge.
    #[error(
        "{triangles} triangles meet in the edge between vertices {} and {}, triangle {triangle} among them: a surface has at most two", edge[0], edge[1]
    )]
    NonManifoldEdge {
        /// The edge's ends.
        edge: [u32; 2],
        /// Number of triangles that meet there.
        triangles: u32,
        /// One of them.
        triangle: u32,
    },
    /// Two neighbours run through their common edge in the same direction.
    #[error(
        "triangles {} and {} both run from vertex {} to vertex {}: their orientations contradict each other", triangles[0], triangles[1], edge[0], edge[1]
    )]
    InconsistentOrientation {
        /// The edge, in the direction in which both run.
        edge: [u32; 2],
        /// The two triangles.
        triangles: [u32; 2],
    },
    /// The triangles at a vertex form more than one fan.
    #[error(
        "the triangles at vertex {vertex} form {fans} separate fans (a bow-tie), triangles {} and {} in different ones: a surface has one", triangles[0], triangles[1]
    )]
    NonManifoldVertex {
        /// The vertex.
        vertex: u32,
        /// Number of fans.
        fans: u32,
        /// A triangle of one fan, and a triangle of another.
        triangles: [u32; 2],
    },
}

/// The half-edges of the triangles, each identified by the corner `3 * triangle + 0, 1 or 2` at its
/// start.
struct HalfEdges {
    /// Start in `entries` of the half-edges that leave each vertex.
    offsets: Vec<u32>,
    /// `(head, corner)`, sorted, vertex by vertex.
    entries: Vec<(u32, u32)>,
    /// For each corner, the corner at the start of the opposite half-edge; `NONE` at the boundary.
    opposite: Vec<u32>,
}

impl HalfEdges {
    fn new(vertices: usize, triangles: &[[u32; 3]]) -> Self {
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
        Self {
            offsets,
            entries,
            opposite,
        }
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
    fn pair(&mut self, triangles: &[[u32; 3]]) -> Result<(), MeshError> {
        for tail in 0..self.offsets.len() as u32 - 1 {
            let end = self.offsets[tail as usize + 1] as usize;
            for at in self.offsets[tail as usize] as usize..end {
                let (head, corner) = self.entries[at];
                if let Some(&(next_head, second)) = self.entries[at + 1..end].first()
                    && next_head == head
                {
                    return Err(self.same_direction([tail, head], [corner, second], triangles));
                }
                if tail > head {
                    continue;
                }
                let Some(found) = self.find(head, tail) else {
                    continue;
                };
                let other = self.leaving(head)[found].1;
                if apex(corner, triangles) == apex(other, triangles) {
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
    fn same_direction(
        &self,
        [tail, head]: [u32; 2],
        corners: [u32; 2],
        triangles: &[[u32; 3]],
    ) -> MeshError {
        let [first, second] = corners.map(|corner| corner / 3);
        if apex(corners[0], triangles) == apex(corners[1], triangles) {
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
}

/// The corner before this one in its triangle.
fn previous_corner(corner: u32) -> u32 {
    if corner.is_multiple_of(3) {
        corner + 2
    } else {
        corner - 1
    }
}

/// The vertex opposite to the half-edge that leaves this corner.
fn apex(corner: u32, triangles: &[[u32; 3]]) -> u32 {
    let previous = previous_corner(corner) as usize;
    triangles[previous / 3][previous % 3]
}

/// The FNV-1a hash of the number of vertices and of all corners, a number at a time.
fn fingerprint(vertices: usize, triangles: &[[u32; 3]]) -> u64 {
    let corners = triangles
        .as_flattened()
        .iter()
        .map(|&corner| u64::from(corner));
    core::iter::once(vertices as u64)
        .chain(corners)
        .fold(0xcbf2_9ce4_8422_2325, |hash, number| {
            (hash ^ number).wrapping_mul(0x0000_0100_0000_01b3)
        })
}

impl TriangleMesh {
    /// Most vertices and most triangles that a mesh may have: three corners a triangle are
    /// numbered with 32 bits, and so are up to six entries a triangle in the list of one-rings.
    pub const LIMIT: usize = (u32::MAX / 6) as usize;

    /// The mesh of `triangles` over the vertices 0 … `vertices` − 1, counter-clockwise seen from
    /// outside.
    ///
    /// # Errors
    /// The first reason found why these triangles are not an oriented manifold; see [`MeshError`].
    pub fn new(vertices: usize, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        for (what, count) in [("vertices", vertices), ("triangles", triangles.len())] {
            if count > Self::LIMIT {
                return Err(MeshError::TooLarge {
                    what,
                    count,
                    limit: Self::LIMIT,
                });
            }
        }
        if triangles.is_empty() {
            return Err(MeshError::Empty);
        }
        for (t, triangle) in triangles.iter().enumerate() {
            for corner in 0..3 {
                let vertex = triangle[corner];
                if vertex as usize >= vertices {
                    return Err(MeshError::VertexOutOfRange {
                        triangle: t as u32,
                        vertex,
                        vertices,
                    });
                }
                if vertex == triangle[(corner + 1) % 3] {
                    return Err(MeshError::RepeatedVertex {
                        triangle: t as u32,
                        vertex,
                    });
                }
            }
        }
        let fingerprint = fingerprint(vertices, &triangles);
        let mut half_edges = HalfEdges::new(vertices, &triangles);
        half_edges.pair(&triangles)?;

        let (edges, edge_triangles) = edges(vertices, &triangles, &half_edges);
        let boundary_edges = edge_triangles
            .iter()
            .filter(|sides| sides[1] == NONE)
            .count() as u32;
        let (ring_offsets, ring_vertices, vertex_kinds) = rings(vertices, &triangles, &half_edges)?;
        Ok(Self {
            triangles,
            edges,
            edge_triangles,
            ring_offsets,
            ring_vertices,
            vertex_kinds,
            boundary_edges,
            fingerprint,
        })
    }

    /// A hash of the vertices and triangles in their order, the same on every machine.
    #[inline]
    pub fn fingerprint(&self) -> u64 {
        self.fingerprint
    }

    /// Number of vertices, isolated ones included.
    #[inline]
    pub fn vertex_count(&self) -> usize {
        self.vertex_kinds.len()
    }

    /// The triangles, as they were given.
    #[inline]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The edges `[a, b]`, each once, in the direction in which its first triangle runs.
    #[inline]
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// The triangle left of edge `[a, b]` (which runs from a to b) and the one right of it, `None`
    /// at the boundary.
    ///
    /// # Panics
    /// If there is no such edge.
    #[inline]
    pub fn edge_triangles(&self, edge: usize) -> (u32, Option<u32>) {
        let [left, right] = self.edge_triangles[edge];
        (left, (right != NONE).then_some(right))
    }

    /// The neighbours of a vertex, counter-clockwise seen from outside; at a boundary vertex, from
    /// one boundary edge to the other.
    ///
    /// # Panics
    /// If there is no such vertex.
    #[inline]
    pub fn one_ring(&self, vertex: usize) -> &[u32] {
        &self.ring_vertices
            [self.ring_offsets[vertex] as usize..self.ring_offsets[vertex + 1] as usize]
    }

    /// The start of each one-ring in the list of all one-rings, and the length of the list at the
    /// end: the row offsets of a matrix with an entry for each vertex and neighbour.
    #[inline]
    pub fn ring_offsets(&self) -> &[u32] {
        &self.ring_offsets
    }

    /// All one-rings, one after the other.
    #[inline]
    pub fn ring_vertices(&self) -> &[u32] {
        &self.ring_vertices
    }

    /// Number of neighbours of a vertex.
    ///
    /// # Panics
    /// If there is no such vertex.
    #[inline]
    pub fn valence(&self, vertex: usize) -> usize {
        self.one_ring(vertex).len()
    }

    /// The kind of a vertex: interior, at the boundary, or in no triangle.
    ///
    /// # Panics
    /// If there is no such vertex.
    #[inline]
    pub fn vertex_kind(&self, vertex: usize) -> VertexKind {
        self.vertex_kinds[vertex]
    }

    /// Whether a vertex has a full ring of triangles.
    ///
    /// # Panics
    /// If there is no such vertex.
    #[inline]
    pub fn is_interior(&self, vertex: usize) -> bool {
        self.vertex_kinds[vertex] == VertexKind::Interior
    }

    /// Whether a vertex and all its neighbours are interior: there, operators that need a full ring
    /// can be applied twice.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn is_surrounded(&self, vertex: usize) -> bool {
        let interior = |vertex: usize| self.vertex_kinds[vertex] == VertexKind::Interior;
        interior(vertex)
            && (self.is_closed() || self.one_ring(vertex).iter().all(|&v| interior(v as usize)))
    }

    /// [`Self::vertex_kind`] of all vertices.
    #[inline]
    pub fn vertex_kinds(&self) -> &[VertexKind] {
        &self.vertex_kinds
    }

    /// Number of edges with one triangle only.
    #[inline]
    pub fn boundary_edge_count(&self) -> usize {
        self.boundary_edges as usize
    }

    /// Whether every edge has two triangles.
    #[inline]
    pub fn is_closed(&self) -> bool {
        self.boundary_edges == 0
    }

    /// χ = V − E + F, over the vertices that are in a triangle; 2(1 − genus) for one closed
    /// component.
    pub fn euler_characteristic(&self) -> i64 {
        let used = self
            .vertex_kinds
            .iter()
            .filter(|&&kind| kind != VertexKind::Isolated)
            .count();
        used as i64 - self.edges.len() as i64 + self.triangles.len() as i64
    }

    /// The connected component of each vertex, and the number of components. Components are
    /// numbered from 0 in the order of their lowest vertices. An isolated vertex is a component of
    /// its own.
    pub fn components(&self) -> (Vec<u32>, usize) {
        let mut component = alloc::vec![NONE; self.vertex_count()];
        let mut front = Vec::new();
        let mut count = 0;
        for start in 0..self.vertex_count() {
            if component[start] != NONE {
                continue;
            }
            component[start] = count;
            front.push(start as u32);
            while let Some(vertex) = front.pop() {
                for &neighbour in self.one_ring(vertex as usize) {
                    if component[neighbour as usize] == NONE {
                        component[neighbour as usize] = count;
                        front.push(neighbour);
                    }
                }
            }
            count += 1;
        }
        (component, count as usize)
    }
}

fn edges(
    vertices: usize,
    triangles: &[[u32; 3]],
    half_edges: &HalfEdges,
) -> (Vec<[u32; 2]>, Vec<[u32; 2]>) {
    let mut edges = Vec::with_capacity(3 * triangles.len() / 2);
    let mut sides = Vec::with_capacity(3 * triangles.len() / 2);
    for tail in 0..vertices as u32 {
        for &(head, corner) in half_edges.leaving(tail) {
            let opposite = half_edges.opposite[corner as usize];
            if tail < head || opposite == NONE {
                let right = if opposite == NONE { NONE } else { opposite / 3 };
                edges.push([tail, head]);
                sides.push([corner / 3, right]);
            }
        }
    }
    (edges, sides)
}

/// One-rings in counter-clockwise order, and what kind of vertex each is.
#[expect(
    clippy::type_complexity,
    reason = "three columns of one table, taken apart at once"
)]
fn rings(
    vertices: usize,
    triangles: &[[u32; 3]],
    half_edges: &HalfEdges,
) -> Result<(Vec<u32>, Vec<u32>, Vec<VertexKind>), MeshError> {
    let mut offsets = Vec::with_capacity(vertices + 1);
    let mut ring = Vec::with_capacity(3 * triangles.len() + vertices / 4);
    let mut kinds = Vec::with_capacity(vertices);
    offsets.push(0);
    for vertex in 0..vertices as u32 {
        let leaving = half_edges.leaving(vertex);
        // An open fan starts at the boundary, a closed one at the lowest neighbour.
        let open = leaving
            .iter()
            .find(|&&(_, corner)| half_edges.opposite[corner as usize] == NONE);
        let mut reached = 0;
        if let Some(&(head, start)) = open.or(leaving.first()) {
            ring.push(head);
            let mut corner = start;
            loop {
                reached += 1;
                let next = half_edges.next_around(corner);
                if next == start {
                    break;
                }
                ring.push(apex(corner, triangles));
                if next == NONE {
                    break;
                }
                corner = next;
            }
        }
        if reached < leaving.len() {
            return Err(separate_fans(vertex, triangles, half_edges));
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
fn separate_fans(vertex: u32, triangles: &[[u32; 3]], half_edges: &HalfEdges) -> MeshError {
    let leaving = half_edges.leaving(vertex);
    let next = Vec::from_iter(
        leaving
            .iter()
            .map(|&(_, corner)| half_edges.find(vertex, apex(corner, triangles))),
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
