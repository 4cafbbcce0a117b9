//! Vertices near a vertex, found along the surface.

use crate::mesh::TriangleMesh;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::dot;
use alloc::collections::VecDeque;
use alloc::vec;
use alloc::vec::Vec;

/// Scratch memory for a search along the edges of a mesh, never through space: two sheets of a
/// surface that lie close together are not neighbours.
#[derive(Clone, Debug, Default)]
pub(crate) struct Neighbourhood<T> {
    /// The search in which each vertex was reached last.
    reached: Vec<u32>,
    search: u32,
    /// The vertices that were reached, without the centre: squared Euclidean distance, and vertex.
    pub(crate) found: Vec<(T, u32)>,
    /// Length of the shortest path to each vertex that this search reached, if the search uses path
    /// lengths.
    paths: Vec<T>,
    /// Queue of vertices whose neighbours are not searched yet; it holds each vertex at most once,
    /// so that it never outgrows the mesh.
    queue: VecDeque<u32>,
    /// Whether each vertex is in the queue.
    waiting: Vec<bool>,
}

impl<T: Real> Neighbourhood<T> {
    /// Finds all vertices within `rings` edges of `centre`, ring after ring.
    pub(crate) fn rings(&mut self, surface: Surface<'_, T>, centre: u32, rings: usize) {
        self.whole_rings(surface, centre, rings, 0);
    }

    /// Makes room for searches that find up to `count` vertices.
    pub(crate) fn reserve(&mut self, mesh: &TriangleMesh, count: usize) {
        self.fit(mesh);
        self.found.clear();
        self.found.reserve(count.min(mesh.vertex_count()));
    }

    /// Finds whole rings until at least `count` vertices are found, or all vertices of the
    /// component.
    pub(crate) fn at_least(&mut self, surface: Surface<'_, T>, centre: u32, count: usize) {
        self.whole_rings(surface, centre, 1, count);
    }

    /// Finds whole rings, at least so many and with at least `count` vertices, or all vertices of the
    /// component; ring after ring, the first of them in the order of the one-ring.
    pub(crate) fn whole_rings(
        &mut self,
        surface: Surface<'_, T>,
        centre: u32,
        rings: usize,
        count: usize,
    ) {
        self.start(surface.mesh(), centre);
        self.reach_around(surface, centre, centre);
        let mut ring = 0..self.found.len();
        let mut done = 1;
        while !ring.is_empty() && (done < rings || self.found.len() < count) {
            let end = self.found.len();
            for at in ring {
                let vertex = self.found[at].1;
                self.reach_around(surface, centre, vertex);
            }
            ring = end..self.found.len();
            done += 1;
        }
    }

    /// Finds vertices beyond whole rings around `centre`, along edges from the `nearest` of these rings on, as long as
    /// keys of distances are within a bound.
    pub(crate) fn beyond(
        &mut self,
        surface: Surface<'_, T>,
        centre: u32,
        rings: Nearby<'_>,
        (nearest, bound): (&[u32], i32),
    ) {
        self.start(surface.mesh(), centre);
        for &vertex in rings.vertices {
            self.reached[vertex as usize] = self.search;
        }
        let last = &rings.vertices[rings.inner..];
        let outer = nearest.iter().rev().take_while(|at| last.contains(at));
        for &vertex in &nearest[nearest.len() - outer.count()..] {
            self.reach_around(surface, centre, vertex);
        }
        let mut place = 0;
        while let Some(&(squared, vertex)) = self.found.get(place) {
            if key_of(squared) <= bound {
                self.reach_around(surface, centre, vertex);
            }
            place += 1;
        }
    }

    /// Finds the `count` nearest of the vertices that are reached first, sorted by Euclidean
    /// distance, and by number where distances are equal.
    pub(crate) fn nearest(&mut self, surface: Surface<'_, T>, centre: u32, count: usize) {
        self.at_least(surface, centre, count + count * 7 / 10 + 20);
        // The bits of numbers that are not negative have their order, and are compared without a branch.
        let rank = |&(squared, vertex): &(T, u32)| {
            let bits = squared.to_f64().unwrap_or(f64::INFINITY).to_bits();
            u128::from(bits) << 32 | u128::from(vertex)
        };
        // Nearly half of those reached are farther: they need not be sorted.
        if 0 < count && count < self.found.len() {
            self.found.select_nth_unstable_by_key(count - 1, rank);
            self.found.truncate(count);
        }
        self.found.sort_unstable_by_key(rank);
    }

    /// Finds all vertices that a path of edges no longer than `longest` reaches. `edge_lengths` has
    /// the length of the edge to each entry of the mesh's one-rings.
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
        // The queue is first in, first out, and a vertex enters again if a shorter path turns up
        // later. On meshes with edges of similar length this is rare, and cheaper than a sorted
        // queue.
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
        self.fit(mesh);
        self.search += 1;
        self.reached[centre as usize] = self.search;
        self.found.clear();
    }

    /// Forgets searches in another mesh, or in this one before numbers of searches repeat.
    fn fit(&mut self, mesh: &TriangleMesh) {
        if self.reached.len() != mesh.vertex_count() || self.search == u32::MAX {
            self.reached.clear();
            self.reached.resize(mesh.vertex_count(), 0);
            self.search = 0;
        }
    }

    /// Adds the neighbours of `vertex` that have not been reached yet.
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

/// For each vertex of a mesh, the vertices that are reached first along edges, in this order. They
/// include the nearest vertices, whatever the positions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Surroundings {
    /// Start of the neighbourhood of each vertex, and the end of the last.
    offsets: Vec<usize>,
    vertices: Vec<u32>,
    /// Number of vertices without those of the last ring.
    inner: Vec<u32>,
    /// Largest number of candidates of one vertex.
    room: usize,
}

impl Surroundings {
    /// Searches breadth-first around each vertex until at least `enough` vertices, a number for each
    /// vertex, and two whole rings are reached, or all vertices of the component.
    pub(crate) fn rings(mesh: &TriangleMesh, enough: impl Fn(usize) -> usize) -> Self {
        let count = mesh.vertex_count();
        let mut offsets = Vec::with_capacity(count + 1);
        let mut inner = Vec::with_capacity(count);
        // Those up to `end` are reached, others are room.
        let (mut vertices, mut end): (Vec<u32>, usize) = (Vec::new(), 0);
        let mut longest = 0;
        // The search in which each vertex was reached last, counted from 1.
        let mut reached = vec![0_u32; count];
        offsets.push(0);
        for centre in 0..count {
            let search = centre as u32 + 1;
            let start = end;
            let enough = enough(centre);
            reached[centre] = search;
            let mut reach_around = |vertices: &mut Vec<u32>, vertex: usize| {
                let ring = mesh.one_ring(vertex);
                if vertices.len() < end + ring.len() {
                    vertices.resize((end + ring.len()) * 5 / 4, 0);
                }
                // Without branches, whose outcomes are random and could not be predicted.
                let (room, mut count) = (&mut vertices[end..][..ring.len()], 0);
                for &neighbour in ring {
                    let reached = &mut reached[neighbour as usize];
                    room[count] = neighbour;
                    count += usize::from(*reached != search);
                    *reached = search;
                }
                end += count;
                end
            };
            let mut reached_to = reach_around(&mut vertices, centre);
            let (mut rings, mut done) = (1, start);
            // What was reached is its own queue: what lies from `done` on is the newest ring.
            while done < reached_to && (rings < 2 || reached_to - start < enough) {
                let ring = done..reached_to;
                done = ring.end;
                for at in ring {
                    let vertex = vertices[at] as usize;
                    reached_to = reach_around(&mut vertices, vertex);
                }
                rings += 1;
            }
            inner.push((done - start) as u32);
            offsets.push(reached_to);
            longest = longest.max(reached_to - start);
        }
        vertices.truncate(end);
        vertices.shrink_to_fit();
        Self {
            offsets,
            vertices,
            inner,
            room: longest,
        }
    }

    /// Scratch memory for one key per candidate of a vertex.
    #[inline(always)]
    pub(crate) fn room(&self) -> usize {
        self.room
    }

    /// The neighbourhood of a vertex.
    #[inline(always)]
    pub(crate) fn of(&self, vertex: usize) -> Nearby<'_> {
        Nearby {
            vertices: &self.vertices[self.offsets[vertex]..self.offsets[vertex + 1]],
            inner: self.inner[vertex] as usize,
        }
    }
}

/// Known distances of vertices, and the memory of the search for the nearest.
pub(crate) struct Search<'a> {
    /// Keys of the distances: room for one of each vertex; and whether they are set.
    pub(crate) keys: &'a mut [i32],
    pub(crate) are_known: &'a mut bool,
    /// Scratch memory: twice as many entries, and one more.
    pub(crate) ranks: &'a mut [u64],
    /// A key between those of the nearest and of the others, 0 if none is known. That of an earlier evaluation
    /// saves the search for it on a surface that has moved by much less than an edge; it has no effect on the
    /// result.
    pub(crate) bound: &'a mut i32,
}

/// The neighbourhood of one vertex.
#[derive(Clone, Copy)]
pub(crate) struct Nearby<'a> {
    vertices: &'a [u32],
    /// Number of vertices without those of the last ring.
    inner: usize,
}

impl<'a> Nearby<'a> {
    /// The vertices, ring after ring; the first ring is the one-ring.
    pub(crate) fn vertices(&self) -> &'a [u32] {
        self.vertices
    }
}

impl Nearby<'_> {
    /// Number of vertices.
    #[inline(always)]
    pub(crate) fn count(&self) -> usize {
        self.vertices.len()
    }

    /// Sets `nearest` to the vertices that are nearest to `centre`, ring after ring; there must be at least
    /// as many. Distances are compared to six digits; of several vertices with the same distance, the
    /// smallest numbers are taken.
    ///
    /// False if vertices beyond these rings may be nearer, which they are not if the last one has no vertex among the
    /// nearest: rings beyond it are then farther still. Not inlined, because there is little to vectorise, and the
    /// loops of fits leave no registers.
    #[inline(never)]
    pub(crate) fn set_nearest<T: Real>(
        &self,
        nearest: &mut [u32],
        surface: Surface<'_, T>,
        centre: u32,
        search: Search<'_>,
    ) -> bool {
        let Search {
            keys,
            are_known,
            ranks,
            bound,
        } = search;
        if !*are_known {
            set_keys(keys, surface, centre, self.vertices);
            *are_known = true;
        }
        let keys = &keys[..self.vertices.len()];
        let mut beyond = FARTHEST;
        for &key in &keys[self.inner..] {
            beyond = beyond.min(key);
        }
        if 0 < *bound && count_within(keys, *bound) == nearest.len() {
            take(nearest, self.vertices, keys, *bound);
        } else {
            let within = count_within(keys, beyond - 1);
            let mut above = (beyond - 1, within);
            if within < nearest.len() {
                let farthest = keys.iter().copied().max();
                above = (farthest.unwrap_or(FARTHEST), keys.len());
            }
            *bound = choose(nearest, self.vertices, keys, above, ranks);
        }
        *bound < beyond
    }
}

/// A key larger than all others.
const FARTHEST: i32 = i32::MAX;

/// The upper half of the bits of a squared distance in f64. Keys have the order of the distances;
/// distances that agree in six digits have the same key.
#[inline(always)]
pub(crate) fn key_of<T: Real>(squared: T) -> i32 {
    (squared.to_f64().unwrap_or(f64::MAX).to_bits() >> 32) as i32
}

/// The least squared distance with a key.
#[inline(always)]
fn squared_of(key: i32) -> f64 {
    f64::from_bits((key as u64) << 32)
}

/// Sets the first of `keys` to the keys of the distances of `vertices` from `centre`.
#[inline(never)]
fn set_keys<T: Real>(keys: &mut [i32], surface: Surface<'_, T>, centre: u32, vertices: &[u32]) {
    let seen = surface.seen_from(centre);
    for (key, &vertex) in keys.iter_mut().zip(vertices) {
        let difference = seen.difference(vertex);
        *key = key_of(dot(difference, difference));
    }
}

/// Number of `keys` that are at most `most`.
#[inline(always)]
fn count_within(keys: &[i32], most: i32) -> usize {
    let mut count = 0_i32;
    for &key in keys {
        count += i32::from(key <= most);
    }
    count as usize
}

/// Sets `nearest` to the vertices with keys of at most `bound`: there are as many.
#[inline(always)]
fn take(nearest: &mut [u32], vertices: &[u32], keys: &[i32], bound: i32) {
    let mut count = 0;
    for (&vertex, &key) in vertices.iter().zip(keys) {
        if count == nearest.len() {
            break;
        }
        nearest[count] = vertex;
        count += usize::from(key <= bound);
    }
}

/// Sets `nearest` to the vertices with the least `keys`, in their order. `above` is a key, and how many are at
/// most this: not fewer than are chosen. Returns a key between those that are chosen and the others, if no others
/// are equal.
#[inline(always)]
fn choose(
    nearest: &mut [u32],
    vertices: &[u32],
    keys: &[i32],
    above: (i32, usize),
    ranks: &mut [u64],
) -> i32 {
    let (certain, possible) = bracket(nearest.len(), keys, above);
    // There is no branch here, because the outcomes are random and could not be predicted.
    let mut all = 0;
    for (&vertex, &key) in vertices.iter().zip(keys) {
        ranks[all] = (key as u64) << 32 | u64::from(vertex);
        all += usize::from(key <= possible);
    }
    let (ranks, sorted) = ranks.split_at_mut(all);
    let mut doubtful = 0;
    for &rank in &*ranks {
        sorted[doubtful] = rank;
        doubtful += usize::from((rank >> 32) as i32 > certain);
    }
    let left = nearest.len() - (all - doubtful);
    let (mut last, mut bound) = (u64::MAX, possible);
    if left < doubtful {
        let sorted = &mut sorted[..doubtful];
        sorted.sort_unstable();
        // More keys are possible than chosen, and not all that are chosen are certain.
        last = sorted[left.max(1) - 1];
        let [nearer, farther] = [last, sorted[left]].map(|rank| (rank >> 32) as i32);
        bound = nearer + (farther - nearer) / 2;
    }
    let chosen = ranks.iter().filter(|&&rank| rank <= last);
    for (nearest, &rank) in nearest.iter_mut().zip(chosen) {
        *nearest = rank as u32;
    }
    bound
}

/// Two bounds of the key of rank `count`: fewer than `count` keys are at most the first bound, at
/// least `count` are at most the second, as are at most `high` at first. Few keys lie in between,
/// unless they are equal.
#[inline(always)]
fn bracket(count: usize, keys: &[i32], (mut high, mut above): (i32, usize)) -> (i32, i32) {
    let (mut low, mut below) = (-1, 0);
    let mut beyond = above > count + FEW / 2;
    for _ in 0..MOST_GUESSES {
        if above - below <= FEW || above == count || high - low <= 1 {
            break;
        }
        // On a surface the number of vertices is proportional to the squared distance. Guesses aim
        // alternately at a few more and a few less.
        let aim = (count - below) as f64 + if beyond { 2.5 } else { -1.5 };
        let part = (aim / (above - below) as f64).clamp(0.05, 0.95);
        let (least, most) = (squared_of(low.max(0)), squared_of(high));
        let guess = key_of(least + part * (most - least)).clamp(low + 1, high - 1);
        let found = count_within(keys, guess);
        beyond = found < count;
        if beyond {
            (low, below) = (guess, found);
        } else {
            (high, above) = (guess, found);
        }
    }
    (low, high)
}

/// Number of neighbours that are sorted without a further guess.
const FEW: usize = 10;

/// Number of guesses which distances these have: more guesses gain nothing.
const MOST_GUESSES: usize = 8;
