//! Vertices near a vertex, found along the surface.

use crate::mesh::TriangleMesh;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::dot;
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
}

impl<T: Real> Neighbourhood<T> {
    /// Finds the `most` vertices nearest to `centre` among those that a breadth-first search meets
    /// until it has at least `most · 8/5` vertices and two whole rings; all that there are, if there
    /// are fewer. Nearest first; what is equally near in the order of its number.
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
        self.found.sort_unstable_by(nearer);
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
            let reached = &mut self.reached[neighbour as usize];
            if *reached != self.search {
                *reached = self.search;
                let difference = surface.difference(centre, neighbour);
                self.found.push((dot(difference, difference), neighbour));
            }
        }
    }
}

/// Nearest first; numbers decide between equals, so that the order never depends on the search.
fn nearer<T: Real>(a: &(T, u32), b: &(T, u32)) -> Ordering {
    a.0.partial_cmp(&b.0)
        .unwrap_or(Ordering::Equal)
        .then(a.1.cmp(&b.1))
}
