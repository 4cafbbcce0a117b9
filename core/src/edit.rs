//! Connectivity that changes: splits, collapses and flips of edges.
//!
//! A mesh is a table of corners (J. Rossignac, A. Safonova and A. Szymczak, Proc. Shape Modeling International 2001,
//! 278): half-edge `3 t + k` starts at corner k of triangle t, and each one knows its opposite. Collapses are legal where
//! they obey the link condition (T. K. Dey, H. Edelsbrunner, S. Guha and D. V. Nekhayev, Publ. Inst. Math. 66 (1999) 23).

mod operations;

use crate::mesh::TriangleMesh;
use alloc::vec;
use alloc::vec::Vec;

/// Marks a missing opposite half-edge, and the corners of removed triangles.
const NONE: u32 = u32::MAX;

/// A triangle mesh whose connectivity changes by local operations, each of which leaves an oriented manifold.
///
/// Operations are legal, or refused with the reason and without effect. Vertices keep their numbers until
/// [`Self::finish`]; new ones follow. Positions are the caller's.
///
/// ```
/// use helfrich::edit::{EditableMesh, Refusal};
/// use helfrich::TriangleMesh;
///
/// // Two triangles over the edge from 0 to 2.
/// let mesh = TriangleMesh::new(4, vec![[0, 1, 2], [0, 2, 3]])?;
/// let mut edited = EditableMesh::new(&mesh);
/// let edge = edited.half_edge(0, 2).expect("an edge");
/// edited.flip(edge)?;
/// assert!(edited.half_edge(1, 3).is_some() && edited.half_edge(0, 2).is_none());
/// let border = edited.half_edge(0, 1).expect("an edge");
/// assert_eq!(edited.flip(border), Err(Refusal::Border));
/// assert_eq!(edited.split(border), 4);
/// assert_eq!(edited.finish().mesh.triangles().len(), 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct EditableMesh {
    /// Corners; removed triangles have the corner [`NONE`] three times.
    triangles: Vec<[u32; 3]>,
    opposite: Vec<u32>,
    /// Whether a half-edge belongs to a kept line.
    kept: Vec<bool>,
    /// Whether there have been kept lines other than borders.
    has_lines: bool,
    /// A half-edge that leaves each vertex, at a border the one along it; [`NONE`] without triangles.
    leaving: Vec<u32>,
    fixed: Vec<bool>,
    removed_triangles: usize,
}

/// The reason why an operation on an edge is not legal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// An edge of the border has one triangle.
    #[error("the edge is at the border: only edges between two triangles can be flipped")]
    Border,
    /// The edge belongs to a kept line.
    #[error("the edge belongs to a line that is kept")]
    Kept,
    /// The two vertices that a flip would connect are neighbours.
    #[error("vertices {} and {} are neighbours already", edge[0], edge[1])]
    ExistingEdge {
        /// The vertices.
        edge: [u32; 2],
    },
    /// A vertex that may not be removed: it is fixed, an end or a junction of kept lines, or leaves its line.
    #[error("vertex {vertex} is fixed, or would leave its line")]
    FixedVertex {
        /// The vertex.
        vertex: u32,
    },
    /// Other triangles than those of the edge would become one, or two parts of a border would be joined.
    #[error("the surface would not remain a manifold with the same holes")]
    Topology,
}

/// The result of edits.
#[derive(Clone, Debug)]
pub struct Edited {
    /// The mesh. Vertices and triangles have the order of their numbers before.
    pub mesh: TriangleMesh,
    /// The number that each vertex had while edits were made: for vertices of the mesh at the start their number in it.
    pub vertices: Vec<u32>,
}

impl Edited {
    fn new(triangles: Vec<[u32; 3]>, vertices: Vec<u32>) -> Self {
        let mesh = TriangleMesh::new(vertices.len(), triangles);
        Self {
            mesh: mesh.expect("every operation leaves an oriented manifold"),
            vertices,
        }
    }
}

impl EditableMesh {
    /// A mesh to be edited, without kept lines and fixed vertices.
    pub fn new(mesh: &TriangleMesh) -> Self {
        let triangles = mesh.triangles().to_vec();
        let mut edited = Self {
            opposite: vec![NONE; 3 * triangles.len()],
            kept: vec![false; 3 * triangles.len()],
            has_lines: false,
            leaving: vec![NONE; mesh.vertex_count()],
            fixed: vec![false; mesh.vertex_count()],
            triangles,
            removed_triangles: 0,
        };
        for (edge, &[tail, head]) in mesh.edges().iter().enumerate() {
            let (left, right) = mesh.edge_triangles(edge);
            let here = edited.corner_between(left, tail, head);
            if let Some(right) = right {
                let there = edited.corner_between(right, head, tail);
                edited.pair(here, there);
            }
        }
        for half_edge in 0..edited.opposite.len() as u32 {
            edited.leave_by(half_edge);
        }
        edited
    }

    /// A mesh with kept lines.
    ///
    /// # Panics
    /// If a line is not an edge of the mesh.
    pub fn with_lines(mesh: &TriangleMesh, lines: &[[u32; 2]]) -> Self {
        let mut edited = Self::new(mesh);
        for &[from, to] in lines {
            let edge = edited.half_edge(from, to);
            let edge = edge.or_else(|| edited.half_edge(to, from));
            edited.keep(edge.expect("lines are edges of the mesh"));
        }
        edited
    }

    /// Number of vertices, removed ones included.
    pub fn vertex_count(&self) -> usize {
        self.leaving.len()
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len() - self.removed_triangles
    }

    /// Whether a vertex is in a triangle.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn is_used(&self, vertex: u32) -> bool {
        self.leaving[vertex as usize] != NONE
    }

    /// The half-edges of all edges, one of each, in the order of their numbers.
    pub fn edges(&self) -> impl Iterator<Item = u32> {
        (0..self.opposite.len() as u32).filter(|&half_edge| self.is_edge(half_edge))
    }

    /// The first half-edges of all triangles.
    pub fn triangles(&self) -> impl Iterator<Item = u32> {
        let first = (0..self.triangles.len() as u32).map(|triangle| 3 * triangle);
        first.filter(|&half_edge| self.is_half_edge(half_edge))
    }

    /// Whether a number is that of a half-edge, and the lower one of the two of its edge.
    pub fn is_edge(&self, half_edge: u32) -> bool {
        self.is_half_edge(half_edge) && half_edge < self.opposite[half_edge as usize]
    }

    fn is_half_edge(&self, half_edge: u32) -> bool {
        let triangle = self.triangles.get(half_edge as usize / 3);
        triangle.is_some_and(|corners| corners[0] != NONE)
    }

    /// The half-edge from one vertex to another.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn half_edge(&self, tail: u32, head: u32) -> Option<u32> {
        self.around(tail).find(|&there| self.head(there) == head)
    }

    /// The half-edges that leave a vertex, counter-clockwise; the border edge that arrives at it has none.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn around(&self, vertex: u32) -> impl Iterator<Item = u32> {
        let first = self.leaving[vertex as usize];
        let mut next = first;
        core::iter::from_fn(move || {
            let here = (next != NONE).then_some(next)?;
            next = self.opposite[previous(here) as usize];
            if next == first {
                next = NONE;
            }
            Some(here)
        })
    }

    /// The neighbours of a vertex, counter-clockwise.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn neighbours(&self, vertex: u32) -> impl Iterator<Item = u32> {
        let mut around = self.around(vertex);
        // The start of the border edge that arrives.
        let mut last = None;
        core::iter::from_fn(move || {
            let Some(half_edge) = around.next() else {
                return last.take();
            };
            let before = previous(half_edge);
            if self.opposite[before as usize] == NONE {
                last = Some(self.tail(before));
            }
            Some(self.head(half_edge))
        })
    }

    /// Number of neighbours of a vertex.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn valence(&self, vertex: u32) -> usize {
        self.neighbours(vertex).count()
    }

    /// The vertex at the start of a half-edge.
    ///
    /// # Panics
    /// If there is no such half-edge.
    #[inline]
    pub fn tail(&self, half_edge: u32) -> u32 {
        self.triangles[half_edge as usize / 3][half_edge as usize % 3]
    }

    /// The vertex at the end of a half-edge.
    ///
    /// # Panics
    /// If there is no such half-edge.
    #[inline]
    pub fn head(&self, half_edge: u32) -> u32 {
        self.tail(next(half_edge))
    }

    /// The third vertex of the triangle of a half-edge.
    ///
    /// # Panics
    /// If there is no such half-edge.
    #[inline]
    pub fn apex(&self, half_edge: u32) -> u32 {
        self.tail(previous(half_edge))
    }

    /// The half-edge in the other direction; `None` at the border.
    ///
    /// # Panics
    /// If there is no such half-edge.
    #[inline]
    pub fn opposite(&self, half_edge: u32) -> Option<u32> {
        let other = self.opposite[half_edge as usize];
        (other != NONE).then_some(other)
    }

    /// The corners of the triangle of a half-edge.
    ///
    /// # Panics
    /// If there is no such half-edge.
    #[inline]
    pub fn corners(&self, half_edge: u32) -> [u32; 3] {
        self.triangles[half_edge as usize / 3]
    }

    /// Whether an edge belongs to a kept line, as all of the border do.
    ///
    /// # Panics
    /// If there is no such half-edge.
    #[inline]
    pub fn is_kept(&self, half_edge: u32) -> bool {
        self.kept[half_edge as usize] || self.opposite[half_edge as usize] == NONE
    }

    /// Keeps an edge: it is not flipped, and its vertices are only collapsed along the line of kept edges.
    ///
    /// # Panics
    /// If there is no such half-edge.
    pub fn keep(&mut self, half_edge: u32) {
        self.set_kept(half_edge, true);
    }

    /// Fixes a vertex, which is then not collapsed.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn fix(&mut self, vertex: u32) {
        self.fixed[vertex as usize] = true;
    }

    /// Freedom of a vertex to move and to be removed.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn freedom(&self, vertex: u32) -> Freedom {
        if self.fixed[vertex as usize] {
            return Freedom::Fixed;
        }
        if !self.has_lines && self.is_used(vertex) && !self.is_border(vertex) {
            return Freedom::Free;
        }
        let mut ends = [NONE; 2];
        let mut count = 0;
        for half_edge in self.around(vertex) {
            let before = previous(half_edge);
            let arriving = self.opposite[before as usize] == NONE;
            let lines = [
                self.is_kept(half_edge).then(|| self.head(half_edge)),
                arriving.then(|| self.tail(before)),
            ];
            for end in lines.into_iter().flatten() {
                if let Some(place) = ends.get_mut(count) {
                    *place = end;
                }
                count += 1;
            }
        }
        match count {
            0 => Freedom::Free,
            2 => Freedom::OnLine(ends),
            _ => Freedom::Fixed,
        }
    }

    /// Whether a vertex is at the border.
    ///
    /// # Panics
    /// If there is no such vertex, or if it is in no triangle.
    pub fn is_border(&self, vertex: u32) -> bool {
        self.opposite[self.leaving[vertex as usize] as usize] == NONE
    }

    /// The mesh without what was removed.
    pub fn finish(self) -> Edited {
        let mut numbers = vec![NONE; self.leaving.len()];
        let mut vertices = Vec::new();
        for (vertex, &leaving) in self.leaving.iter().enumerate() {
            if leaving != NONE {
                numbers[vertex] = vertices.len() as u32;
                vertices.push(vertex as u32);
            }
        }
        let used = self.triangles.iter().filter(|corners| corners[0] != NONE);
        let triangles = used.map(|corners| corners.map(|corner| numbers[corner as usize]));
        Edited::new(triangles.collect(), vertices)
    }

    /// The mesh cut along its kept edges. Triangles have the same order and corners; of a vertex where lines pass, each
    /// side has a copy, and the first of them the number of the vertex.
    pub fn cut(mut self) -> Edited {
        let mut copies = Vec::from_iter(0..self.leaving.len() as u32);
        for vertex in 0..copies.len() as u32 {
            let mut ring = Vec::from_iter(self.around(vertex));
            let kept = |half_edge: &u32| self.kept[*half_edge as usize];
            // A ring without a border begins at a line.
            let begins_inside = ring
                .first()
                .is_some_and(|&first| self.opposite(first).is_some());
            let start = ring.iter().position(kept).filter(|_| begins_inside);
            ring.rotate_left(start.unwrap_or(0));
            let mut copy = vertex;
            for (place, &half_edge) in ring.iter().enumerate() {
                if place > 0 && self.kept[half_edge as usize] {
                    copy = copies.len() as u32;
                    copies.push(vertex);
                }
                self.triangles[half_edge as usize / 3][half_edge as usize % 3] = copy;
            }
        }
        let used = self
            .triangles
            .into_iter()
            .filter(|corners| corners[0] != NONE);
        Edited::new(used.collect(), copies)
    }

    fn corner_between(&self, triangle: u32, tail: u32, head: u32) -> u32 {
        let corners = self.triangles[triangle as usize];
        let is_start = |k: &usize| corners[*k] == tail && corners[(k + 1) % 3] == head;
        let start = (0..3).find(is_start).expect("an edge of the triangle");
        3 * triangle + start as u32
    }

    /// Makes two half-edges opposite, or one a half-edge of the border.
    fn pair(&mut self, here: u32, there: u32) {
        self.opposite[here as usize] = there;
        if there != NONE {
            self.opposite[there as usize] = here;
        }
    }

    fn set_kept(&mut self, half_edge: u32, kept: bool) {
        self.has_lines |= kept;
        self.kept[half_edge as usize] = kept;
        if let Some(other) = self.opposite(half_edge) {
            self.kept[other as usize] = kept;
        }
    }

    /// Lets the half-edges around the start of this one begin with it, unless they begin at a border.
    fn leave_by(&mut self, half_edge: u32) {
        let tail = self.tail(half_edge) as usize;
        let first = self.leaving[tail];
        let is_at_border = first != NONE
            && self.is_half_edge(first)
            && self.tail(first) as usize == tail
            && self.opposite[first as usize] == NONE;
        if !is_at_border {
            self.leaving[tail] = half_edge;
        }
    }

    /// Lets the half-edges around a vertex begin at the border, if it is there.
    fn start_at_border(&mut self, vertex: u32) {
        let first = self.leaving[vertex as usize];
        let mut at = first;
        // Clockwise.
        while let Some(other) = self.opposite(at) {
            at = next(other);
            if at == first {
                return;
            }
        }
        self.leaving[vertex as usize] = at;
    }
}

/// Freedom of a vertex of an [`EditableMesh`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Freedom {
    /// Anywhere on the surface.
    Free,
    /// Along the kept line or the border between these neighbours.
    OnLine([u32; 2]),
    /// Fixed, or an end or a junction of lines.
    Fixed,
}

/// The next half-edge of the triangle.
#[inline]
pub(crate) fn next(half_edge: u32) -> u32 {
    if half_edge % 3 == 2 {
        half_edge - 2
    } else {
        half_edge + 1
    }
}

/// The half-edge before this one in the triangle.
#[inline]
pub(crate) fn previous(half_edge: u32) -> u32 {
    if half_edge.is_multiple_of(3) {
        half_edge + 2
    } else {
        half_edge - 1
    }
}

/// Corners of which the first is at place k.
fn rotated(corners: [u32; 3], k: usize) -> [u32; 3] {
    core::array::from_fn(|at| corners[(at + 3 - k) % 3])
}
