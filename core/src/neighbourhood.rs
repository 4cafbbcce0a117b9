//! Vertices near a vertex, found along the surface.

use crate::mesh::TriangleMesh;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::dot;
use alloc::collections::VecDeque;
use alloc::vec::Vec;

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

/// Scratch memory for the search of the nearest vertices, which are sorted as whole numbers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Nearest {
    /// The search in which each vertex was reached last.
    reached: Vec<u32>,
    search: u32,
    /// What was reached, in the first `count` entries.
    vertices: Vec<u32>,
    /// Of each that was reached: the upper half of the squared distance as an f64, then its number.
    /// Distances that agree in six digits count as the same, and numbers decide.
    keys: Vec<u64>,
}

impl Nearest {
    /// Searches breadth-first around `centre` until at least `most · 8/5` vertices and two whole
    /// rings are reached; all that there are, if there are fewer. [`Self::sort`] puts them in order.
    pub(crate) fn search<T: Real>(&mut self, surface: Surface<'_, T>, centre: u32, most: usize) {
        let mesh = surface.mesh();
        if self.reached.len() != mesh.vertex_count() || self.search == u32::MAX {
            self.reached.clear();
            self.reached.resize(mesh.vertex_count(), 0);
            self.vertices.resize(mesh.vertex_count(), 0);
            self.search = 0;
        }
        self.search += 1;
        self.reached[centre as usize] = self.search;
        let mut count = self.reach_around(mesh, centre, 0);
        let enough = most + most * 3 / 5;
        let (mut rings, mut done) = (1, 0);
        // What was reached is its own queue: what lies from `done` on is the newest ring.
        while done < count && (rings < 2 || count < enough) {
            let ring = done..count;
            done = ring.end;
            for at in ring {
                count = self.reach_around(mesh, self.vertices[at], count);
            }
            rings += 1;
        }
        self.keys.clear();
        self.keys
            .extend(self.vertices[..count].iter().map(|&vertex| {
                let difference = surface.difference(centre, vertex);
                let squared = dot(difference, difference).to_f64().unwrap_or(f64::MAX);
                (squared.to_bits() & !u64::from(u32::MAX)) | u64::from(vertex)
            }));
    }

    /// Adds the neighbours of `vertex` that were not reached yet to the `count` that were. Which
    /// they are is as good as random: there is no branch.
    fn reach_around(&mut self, mesh: &TriangleMesh, vertex: u32, mut count: usize) -> usize {
        for &neighbour in mesh.one_ring(vertex as usize) {
            let reached = &mut self.reached[neighbour as usize];
            // The last entry is never needed: the centre is not among them.
            self.vertices[count] = neighbour;
            count += usize::from(*reached != self.search);
            *reached = self.search;
        }
        count
    }

    /// How many were reached.
    pub(crate) fn len(&self) -> usize {
        self.keys.len()
    }

    /// Brings the `count` nearest to the front: nearest first; what is equally near in the order of
    /// its number. `sorted` of them are there already.
    pub(crate) fn sort(&mut self, sorted: usize, count: usize) {
        let rest = &mut self.keys[sorted..];
        let more = count - sorted;
        if more < rest.len() {
            rest.select_nth_unstable(more);
        }
        rest[..more].sort_unstable();
    }

    /// The vertices; as many as were sorted are in order.
    pub(crate) fn vertices(&self) -> impl Iterator<Item = u32> + Clone {
        self.keys.iter().map(|&key| key as u32)
    }
}
