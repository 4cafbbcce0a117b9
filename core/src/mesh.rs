//! Connectivity of a triangle mesh, without coordinates.

mod refinement;

use alloc::vec::Vec;
use half_edges::HalfEdges;

mod half_edges;

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
        let half_edges = HalfEdges::new(vertices, &triangles)?;
        let (edges, edge_triangles) = half_edges.edges();
        let boundary_edges = edge_triangles
            .iter()
            .filter(|sides| sides[1] == NONE)
            .count() as u32;
        let (ring_offsets, ring_vertices, vertex_kinds) = half_edges.rings()?;
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
