//! Necks: short closed paths around a surface that do not shrink to a point.
//!
//! Around a vertex, Dijkstra's tree of shortest paths is grown up to half the longest length that a neck may have. An edge
//! between two of its branches closes a path; the path shrinks to a point within the tree's surroundings unless the edge
//! lies across a way, over triangles and edges outside the tree, from one side of the surroundings to another, or around
//! a handle (J. Erickson and S. Har-Peled, Discrete Comput. Geom. 31 (2004) 37). A sharp tip has surroundings with one side
//! only, so that it is no neck.

use glam::DVec3;
use helfrich::Surface;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};

/// The part of the curvature of a circle of the longest neck that the surface must have across an edge to be searched there:
/// along a flat-sided neck the mean is that of the circle.
const CURVED: f64 = 0.5;

/// The shortest closed path of edges along a neck, of at most this length, among those that `accept` approves; each search
/// goes on from the path that it has found, until no path through its vertices is shorter.
pub(super) fn neck(
    surface: Surface<'_, f64>,
    longest: f64,
    accept: impl Fn(&[u32]) -> bool,
) -> Option<Vec<u32>> {
    let mut search = PathSearch::new(surface, longest);
    let mut shortest: Option<ClosedPath> = None;
    // Paths that are shortest for all of their vertices.
    let mut is_known = vec![false; surface.positions().len()];
    let mut judged = HashSet::new();
    for vertex in curved(surface, CURVED * std::f64::consts::TAU / longest) {
        if is_known[vertex as usize] {
            continue;
        }
        let Some(mut found) = search.around(vertex) else {
            continue;
        };
        let mut is_shorter = true;
        while is_shorter {
            let others = found.vertices.clone();
            let others = others.iter().filter_map(|&vertex| search.around(vertex));
            let best = others.min_by(|a, b| a.length.total_cmp(&b.length));
            let best = best.filter(|best| best.length < found.length);
            is_shorter = best.is_some();
            found = best.unwrap_or(found);
        }
        for &vertex in &found.vertices {
            is_known[vertex as usize] = true;
        }
        let mut sorted = found.vertices.clone();
        sorted.sort_unstable();
        let is_best = shortest
            .as_ref()
            .is_none_or(|shortest| found.length < shortest.length);
        if is_best && judged.insert(sorted) && accept(&found.vertices) {
            shortest = Some(found);
        }
    }
    shortest.map(|shortest| shortest.vertices)
}

/// The vertices of edges across which the surface has at least this curvature: the angle between the triangles over the
/// distance of their centroids.
fn curved(surface: Surface<'_, f64>, least: f64) -> Vec<u32> {
    let mesh = surface.mesh();
    let mut are_curved = vec![false; mesh.vertex_count()];
    for (edge, &[from, to]) in mesh.edges().iter().enumerate() {
        let (left, right) = mesh.edge_triangles(edge);
        let Some(right) = right else {
            continue;
        };
        let normals = [left, right]
            .map(|triangle| DVec3::from_array(surface.triangle_normal(triangle as usize)));
        let areas = [left, right].map(|triangle| surface.triangle_area(triangle as usize));
        let angle = normals[0]
            .cross(normals[1])
            .length()
            .atan2(normals[0].dot(normals[1]));
        let length = DVec3::from_array(surface.difference(from, to)).length();
        // Each centroid is a third of the height above the edge.
        if angle * length >= least * 2.0 / 3.0 * (areas[0] + areas[1]) {
            are_curved[from as usize] = true;
            are_curved[to as usize] = true;
        }
    }
    let vertices = (0..).zip(are_curved);
    vertices
        .filter_map(|(vertex, is_curved)| is_curved.then_some(vertex))
        .collect()
}

/// A closed path.
struct ClosedPath {
    length: f64,
    vertices: Vec<u32>,
}

/// A search around one vertex after the other.
struct PathSearch<'a> {
    surface: Surface<'a, f64>,
    longest: f64,
    /// The place of each vertex among those of the present search.
    places: Vec<u32>,
    tree: Vec<Reached>,
}

/// Marks vertices that a search has not reached.
const NONE: u32 = u32::MAX;

/// A vertex that a search has reached.
#[derive(Clone, Copy)]
struct Reached {
    vertex: u32,
    distance: f64,
    /// The place of the vertex before it on the shortest path from the centre, and the number of edges of this path.
    before: u32,
    edges: u32,
}

impl<'a> PathSearch<'a> {
    fn new(surface: Surface<'a, f64>, longest: f64) -> Self {
        Self {
            surface,
            longest,
            places: vec![NONE; surface.positions().len()],
            tree: Vec::new(),
        }
    }

    fn length(&self, from: u32, to: u32) -> f64 {
        DVec3::from_array(self.surface.difference(from, to)).length()
    }

    /// The shortest path of a neck through the surroundings of a vertex.
    fn around(&mut self, centre: u32) -> Option<ClosedPath> {
        self.grow(centre);
        if self.is_disc() {
            return None;
        }
        let mesh = self.surface.mesh();
        // Sides of edges, two for each pair of neighbours: from the first to the second, its left one. Those from each vertex
        // are in the order of its ring.
        let (mut sides, mut starts) = (Vec::new(), vec![0]);
        for reached in &self.tree {
            let ring = mesh.one_ring(reached.vertex as usize).iter();
            let inside = ring.map(|&other| self.places[other as usize]).enumerate();
            sides.extend(inside.filter(|&(_, place)| place != NONE));
            starts.push(sides.len());
        }
        let from = |place: usize| starts[place]..starts[place + 1];
        let side_of = |from_place: u32, to_place: u32| {
            let mut own = from(from_place as usize);
            own.find(|&side| sides[side].1 == to_place)
        };
        // Sides join around triangles, and around what is outside.
        let mut regions = Regions::new(sides.len());
        let mut across = Vec::new();
        for (place, reached) in self.tree.iter().enumerate() {
            let ring = mesh.one_ring(reached.vertex as usize).len();
            let is_closed = mesh.is_interior(reached.vertex as usize);
            let own = from(place);
            for side in own.clone() {
                let next = if side + 1 < own.end {
                    side + 1
                } else {
                    own.start
                };
                let ((at, other), (next_at, next)) = (sides[side], sides[next]);
                let opposite = side_of(next, place as u32)?;
                // A triangle has neighbours that follow each other.
                let follows = next_at == at + 1 || is_closed && next_at == 0 && at + 1 == ring;
                regions.join(side, opposite, !follows);
                let is_tree =
                    self.is_branch(place as u32, other) || self.is_branch(other, place as u32);
                if (place as u32) < other && !is_tree {
                    across.push([side, side_of(other, place as u32)?]);
                }
            }
        }
        let stays = regions.without_dead_ends(&across);
        let closed = across.iter().zip(stays).filter(|(_, stays)| *stays);
        let closed =
            closed.filter_map(|(&[there, back], _)| self.closed(sides[back].1, sides[there].1));
        closed.min_by(|a, b| a.length.total_cmp(&b.length))
    }

    /// Whether every closed path through the tree's surroundings shrinks to a point: most often, and quickly found by their
    /// Euler number.
    fn is_disc(&self) -> bool {
        let mesh = self.surface.mesh();
        let is_inside = |&vertex: &u32| self.places[vertex as usize] != NONE;
        let (mut sides, mut corners) = (0, 0);
        for reached in &self.tree {
            let ring = mesh.one_ring(reached.vertex as usize);
            let mut last = match mesh.is_interior(reached.vertex as usize) {
                true => ring.last().is_some_and(is_inside),
                false => false,
            };
            for vertex in ring {
                let inside = is_inside(vertex);
                sides += usize::from(inside);
                corners += usize::from(inside && last);
                last = inside;
            }
        }
        self.tree.len() + corners / 3 == sides / 2 + 1
    }

    /// Whether the second vertex is the next on a shortest path through the first.
    fn is_branch(&self, before: u32, after: u32) -> bool {
        after > 0 && self.tree[after as usize].before == before
    }

    /// Grows the tree of shortest paths from a vertex, up to half the longest length. Places are in the order of distances.
    fn grow(&mut self, centre: u32) {
        for reached in self.tree.drain(..) {
            self.places[reached.vertex as usize] = NONE;
        }
        // Lengths are not negative, so that their bits have the same order.
        let mut pending = BinaryHeap::from([Reverse((0, centre, 0, 0))]);
        while let Some(Reverse((bits, vertex, before, edges))) = pending.pop() {
            if self.places[vertex as usize] != NONE {
                continue;
            }
            let (place, distance) = (self.tree.len() as u32, f64::from_bits(bits));
            self.places[vertex as usize] = place;
            self.tree.push(Reached {
                vertex,
                distance,
                before,
                edges,
            });
            for &next in self.surface.mesh().one_ring(vertex as usize) {
                let farther = distance + self.length(vertex, next);
                if farther <= 0.5 * self.longest && self.places[next as usize] == NONE {
                    pending.push(Reverse((farther.to_bits(), next, place, edges + 1)));
                }
            }
        }
    }

    /// The path along the tree that an edge closes, without the part that both branches share.
    fn closed(&self, one: u32, other: u32) -> Option<ClosedPath> {
        let at = |place: u32| self.tree[place as usize];
        let (mut ends, mut branches) = ([one, other], [vec![one], vec![other]]);
        while ends[0] != ends[1] {
            let farther = usize::from(at(ends[1]).edges > at(ends[0]).edges);
            ends[farther] = at(ends[farther]).before;
            branches[farther].push(ends[farther]);
        }
        let lengths = [one, other].map(|end| at(end).distance - at(ends[0]).distance);
        let edge = self.length(at(one).vertex, at(other).vertex);
        let length = lengths[0] + edge + lengths[1];
        let [mut path, back] = branches;
        path.extend(back.iter().rev().skip(1));
        (length <= self.longest).then(|| ClosedPath {
            length,
            vertices: path.iter().map(|&place| at(place).vertex).collect(),
        })
    }
}

/// Triangles and parts of the outside, as sets of the sides of edges.
struct Regions {
    parents: Vec<usize>,
    is_outside: Vec<bool>,
}

impl Regions {
    fn new(sides: usize) -> Self {
        Self {
            parents: Vec::from_iter(0..sides),
            is_outside: vec![false; sides],
        }
    }

    fn of(&mut self, mut side: usize) -> usize {
        while self.parents[side] != side {
            self.parents[side] = self.parents[self.parents[side]];
            side = self.parents[side];
        }
        side
    }

    fn join(&mut self, one: usize, other: usize, is_outside: bool) {
        let [one, other] = [self.of(one), self.of(other)];
        let [low, high] = [one.min(other), one.max(other)];
        self.parents[high] = low;
        self.is_outside[low] |= self.is_outside[high] || is_outside;
    }

    /// Whether each of these edges, given by its sides, is left when dead ends are removed again and again: triangles with
    /// one edge to others.
    fn without_dead_ends(&mut self, edges: &[[usize; 2]]) -> Vec<bool> {
        let regions = edges.iter().map(|both| both.map(|side| self.of(side)));
        let regions = Vec::from_iter(regions);
        let mut at = vec![Vec::new(); self.parents.len()];
        for (edge, both) in regions.iter().enumerate() {
            for &region in both {
                at[region].push(edge);
            }
        }
        let mut stays = vec![true; edges.len()];
        let mut ends = Vec::from_iter((0..at.len()).filter(|&region| !at[region].is_empty()));
        while let Some(region) = ends.pop() {
            let mut left = at[region].iter().filter(|&&edge| stays[edge]);
            if let (Some(&edge), None, false) = (left.next(), left.next(), self.is_outside[region])
            {
                stays[edge] = false;
                let [one, other] = regions[edge];
                ends.push(if one == region { other } else { one });
            }
        }
        stays
    }
}
