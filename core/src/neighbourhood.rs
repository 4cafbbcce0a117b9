//! Vertices near a vertex, found along the surface.

use crate::mesh::TriangleMesh;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::dot;
use alloc::collections::VecDeque;
use alloc::vec::Vec;
use core::cmp::Ordering;

/// Scratch memory for a search along the edges of a mesh, never through space: two sheets of a
/// surface that lie close together are not neighbours.
#[derive(Clone, Debug, Default)]
pub(crate) struct Neighbourhood<T> {
    /// The search in which each vertex was reached last.
    reached: Vec<u32>,
    search: u32,
    /// What was reached, without the centre: squared distance through space, and vertex.
    pub(crate) found: Vec<(T, u32)>,
    /// Length of the shortest path to each vertex that this search reached, where it asks for it.
    paths: Vec<T>,
    /// Vertices to go on from, each at most once: it never needs more room than there are vertices.
    queue: VecDeque<u32>,
    /// Whether each vertex is in the queue.
    waiting: Vec<bool>,
}

impl<T: Real> Neighbourhood<T> {
    /// Finds the `most` vertices nearest to `centre` among those that a breadth-first search meets
    /// until it has at least `most · 8/5` vertices and two whole rings; all that there are, if there
    /// are fewer. [`Self::sort`] puts them in order.
    pub(crate) fn nearest(&mut self, surface: Surface<'_, T>, centre: u32, most: usize) {
        self.start(surface.mesh(), centre);
        let enough = most + most * 3 / 5;
        self.reach_around(surface, centre, centre);
        let mut rings = 1;
        let mut done = 0;
        // `found` is its own queue: what lies from `done` on is the newest ring.
        while done < self.found.len() && (rings < 2 || self.found.len() < enough) {
            let ring = done..self.found.len();
            done = ring.end;
            for at in ring {
                let vertex = self.found[at].1;
                self.reach_around(surface, centre, vertex);
            }
            rings += 1;
        }
        if self.found.len() > most {
            self.found.select_nth_unstable_by(most, nearer);
            self.found.truncate(most);
        }
    }

    /// Brings the `count` nearest of what [`Self::nearest`] found to the front: nearest first; what
    /// is equally near in the order of its number. `sorted` of them are there already.
    pub(crate) fn sort(&mut self, sorted: usize, count: usize) {
        let rest = &mut self.found[sorted..];
        let more = count - sorted;
        if more < rest.len() {
            rest.select_nth_unstable_by(more, nearer);
        }
        rest[..more].sort_unstable_by(nearer);
    }

    /// Finds all vertices within `rings` edges of `centre`, ring after ring.
    pub(crate) fn rings(&mut self, surface: Surface<'_, T>, centre: u32, rings: usize) {
        self.start(surface.mesh(), centre);
        self.reach_around(surface, centre, centre);
        let mut ring = 0..self.found.len();
        for _ in 1..rings {
            let end = self.found.len();
            for at in ring {
                let vertex = self.found[at].1;
                self.reach_around(surface, centre, vertex);
            }
            ring = end..self.found.len();
        }
    }

    /// Finds all vertices to which a path of edges leads that is no longer than `longest`.
    /// `edge_lengths` has the length of the edge to each entry of the mesh's one-rings.
    pub(crate) fn within(
        &mut self,
        surface: Surface<'_, T>,
        edge_lengths: &[T],
        centre: u32,
        longest: T,
    ) {
        let mesh = surface.mesh();
        let vertices = mesh.vertex_count();
        self.start(mesh, centre);
        self.found.reserve(vertices);
        self.queue.reserve(vertices);
        self.paths.resize(vertices, T::zero());
        self.waiting.resize(vertices, false);
        self.paths[centre as usize] = T::zero();
        self.queue.push_back(centre);
        // First come, first served, and again where a shorter path turns up later: on meshes with
        // edges of similar length that is rare, and cheaper than keeping the queue in order.
        while let Some(vertex) = self.queue.pop_front() {
            self.waiting[vertex as usize] = false;
            let start = mesh.ring_offsets()[vertex as usize] as usize;
            let ring = mesh.one_ring(vertex as usize);
            for (&neighbour, &edge) in ring.iter().zip(&edge_lengths[start..]) {
                let path = self.paths[vertex as usize] + edge;
                let known = self.reached[neighbour as usize] == self.search;
                let shorter = !known || path < self.paths[neighbour as usize];
                if path > longest || !shorter {
                    continue;
                }
                self.paths[neighbour as usize] = path;
                if !self.waiting[neighbour as usize] {
                    self.waiting[neighbour as usize] = true;
                    self.queue.push_back(neighbour);
                }
                if !known {
                    self.reach(surface, centre, neighbour);
                }
            }
        }
    }

    fn start(&mut self, mesh: &TriangleMesh, centre: u32) {
        if self.reached.len() != mesh.vertex_count() || self.search == u32::MAX {
            self.reached.clear();
            self.reached.resize(mesh.vertex_count(), 0);
            self.search = 0;
        }
        self.search += 1;
        self.reached[centre as usize] = self.search;
        self.found.clear();
    }

    /// Adds the neighbours of `vertex` that were not reached yet.
    fn reach_around(&mut self, surface: Surface<'_, T>, centre: u32, vertex: u32) {
        for &neighbour in surface.mesh().one_ring(vertex as usize) {
            if self.reached[neighbour as usize] != self.search {
                self.reach(surface, centre, neighbour);
            }
        }
    }

    fn reach(&mut self, surface: Surface<'_, T>, centre: u32, vertex: u32) {
        self.reached[vertex as usize] = self.search;
        let difference = surface.difference(centre, vertex);
        self.found.push((dot(difference, difference), vertex));
    }
}

/// Nearest first; numbers decide between equals, so that the order never depends on the search.
fn nearer<T: Real>(a: &(T, u32), b: &(T, u32)) -> Ordering {
    if a.0 < b.0 {
        Ordering::Less
    } else if a.0 > b.0 {
        Ordering::Greater
    } else {
        a.1.cmp(&b.1)
    }
}
