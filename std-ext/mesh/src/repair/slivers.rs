//! Slivers and their removal, by flips and collapses of edges.

use glam::DVec3;
use std::collections::BTreeSet;

/// The result of a removal.
pub(super) struct Removed {
    pub(super) is_kept: Vec<bool>,
    pub(super) flipped: usize,
    pub(super) collapsed: usize,
    /// Number of triangles that are slivers still.
    pub(super) left: usize,
}

/// Most triangles at a corner of a sliver that is removed.
const MOST_TRIANGLES: usize = 1000;

/// Removes triangles of a mesh with an angle below `limit`, in radians: of a needle the shortest edge is
/// collapsed into one of its ends, of a cap the longest is flipped. Vertices do not move.
///
/// A flip makes the smallest angle of its two triangles larger, and a collapse makes no triangle with a smaller
/// angle than the sliver's, so that the removal ends. Neither turns a triangle over, and no border changes. Vertices
/// at the place of others keep their triangles.
pub(super) fn remove(
    positions: &[[f64; 3]],
    triangles: &mut [[u32; 3]],
    is_double: &[bool],
    limit: f64,
) -> Removed {
    let mut at = vec![Vec::new(); positions.len()];
    for (triangle, corners) in (0u32..).zip(triangles.iter()) {
        for &vertex in corners {
            at[vertex as usize].push(triangle);
        }
    }
    let mut surface = Editable {
        positions,
        is_double,
        is_kept: vec![true; triangles.len()],
        triangles,
        at,
    };
    let mut removed = Removed {
        is_kept: Vec::new(),
        flipped: 0,
        collapsed: 0,
        left: 0,
    };
    let all = 0..surface.triangles.len() as u32;
    let mut slivers =
        BTreeSet::from_iter(all.filter(|&triangle| surface.angle_of(triangle) < limit));
    let mut changed = Vec::new();
    // Slivers that could not be removed are looked at again when a triangle beside them has changed.
    while let Some(triangle) = slivers.pop_first() {
        if !surface.is_kept[triangle as usize] {
            continue;
        }
        changed.clear();
        let [shortest, _, longest] = surface.edges_by_length(triangle);
        if surface.is_crowded(triangle) {
            continue;
        }
        let is_cap = surface.is_cap(longest);
        if is_cap && surface.flip(triangle, longest, &mut changed) {
            removed.flipped += 1;
        } else if surface.collapse(triangle, shortest, &mut changed) {
            removed.collapsed += 1;
        } else if !is_cap && surface.flip(triangle, longest, &mut changed) {
            removed.flipped += 1;
        }
        for &vertex in &changed {
            let around = surface.at[vertex as usize].iter().copied();
            slivers.extend(around.filter(|&triangle| surface.angle_of(triangle) < limit));
        }
    }
    let kept = (0..surface.triangles.len() as u32).filter(|&t| surface.is_kept[t as usize]);
    removed.left = kept
        .filter(|&triangle| surface.angle_of(triangle) < limit)
        .count();
    removed.is_kept = surface.is_kept;
    removed
}

/// A mesh whose edges are flipped and collapsed.
struct Editable<'a> {
    positions: &'a [[f64; 3]],
    is_double: &'a [bool],
    triangles: &'a mut [[u32; 3]],
    is_kept: Vec<bool>,
    /// The triangles at each vertex.
    at: Vec<Vec<u32>>,
}

impl Editable<'_> {
    fn place(&self, vertex: u32) -> DVec3 {
        DVec3::from(self.positions[vertex as usize])
    }

    /// The vectors from the first corner to the others, in units of the longest coordinate.
    fn sides(&self, corners: [u32; 3]) -> [DVec3; 2] {
        let [a, b, c] = corners.map(|vertex| self.place(vertex));
        let size = (b - a).abs().max((c - a).abs()).max_element();
        let scale = if size > 0.0 { size } else { 1.0 };
        [(b - a) / scale, (c - a) / scale]
    }

    /// The smallest angle; 0 if corners coincide.
    fn angle(&self, [a, b, c]: [u32; 3]) -> f64 {
        let at = |corners: [u32; 3]| {
            let [one, other] = self.sides(corners);
            one.cross(other).length().atan2(one.dot(other))
        };
        at([a, b, c]).min(at([b, c, a])).min(at([c, a, b]))
    }

    fn angle_of(&self, triangle: u32) -> f64 {
        self.angle(self.triangles[triangle as usize])
    }

    /// A vector along the normal, of any length.
    fn normal(&self, corners: [u32; 3]) -> DVec3 {
        let [one, other] = self.sides(corners);
        one.cross(other).normalize_or_zero()
    }

    /// The edges of a triangle with the corner opposite to each, the shortest first.
    fn edges_by_length(&self, triangle: u32) -> [[u32; 3]; 3] {
        let [a, b, c] = self.triangles[triangle as usize];
        let mut edges = [[a, b, c], [b, c, a], [c, a, b]];
        edges.sort_by(|one, other| {
            let [one, other] = [one, other].map(|&[from, to, _]| {
                let apart = self.place(to) - self.place(from);
                apart.x.hypot(apart.y).hypot(apart.z)
            });
            one.total_cmp(&other)
        });
        edges
    }

    /// Whether a corner has so many triangles that changes there would take too long.
    fn is_crowded(&self, triangle: u32) -> bool {
        let corners = self.triangles[triangle as usize];
        corners
            .iter()
            .any(|&vertex| self.at[vertex as usize].len() > MOST_TRIANGLES)
    }

    /// Whether the angle opposite to an edge is above 135°: the triangle is a cap, and no needle.
    fn is_cap(&self, [from, to, apex]: [u32; 3]) -> bool {
        let [one, other] = self.sides([apex, from, to]);
        one.cross(other).length() < -one.dot(other)
    }

    /// The triangle beyond an edge of another one.
    fn beyond(&self, triangle: u32, [from, to]: [u32; 2]) -> Option<u32> {
        let mut around = self.at[from as usize].iter().copied();
        around.find(|&other| other != triangle && self.triangles[other as usize].contains(&to))
    }

    /// The corner of a triangle that is not on an edge.
    fn apex(&self, triangle: u32, edge: [u32; 2]) -> Option<u32> {
        let corners = self.triangles[triangle as usize];
        corners.into_iter().find(|corner| !edge.contains(corner))
    }

    /// The neighbours of a vertex.
    fn neighbours(&self, vertex: u32) -> BTreeSet<u32> {
        let around = self.at[vertex as usize].iter();
        let corners = around.flat_map(|&triangle| self.triangles[triangle as usize]);
        corners.filter(|&corner| corner != vertex).collect()
    }

    /// Whether a vertex is at the border: it has more neighbours than triangles.
    fn is_at_border(&self, vertex: u32) -> bool {
        self.neighbours(vertex).len() > self.at[vertex as usize].len()
    }

    /// Replaces the edge between a triangle and the one beyond it by the other diagonal, unless that exists or is
    /// worse.
    fn flip(&mut self, triangle: u32, [from, to, apex]: [u32; 3], changed: &mut Vec<u32>) -> bool {
        let Some(other) = self.beyond(triangle, [from, to]) else {
            return false;
        };
        let Some(far) = self.apex(other, [from, to]) else {
            return false;
        };
        let old = [triangle, other].map(|triangle| self.triangles[triangle as usize]);
        let new = [[from, far, apex], [far, to, apex]];
        let touches = [from, to, apex, far]
            .iter()
            .any(|&vertex| self.is_double[vertex as usize]);
        let is_edge = self.at[apex as usize]
            .iter()
            .any(|&t| self.triangles[t as usize].contains(&far));
        let angle = |pair: [[u32; 3]; 2]| {
            pair.map(|corners| self.angle(corners))
                .into_iter()
                .reduce(f64::min)
        };
        let normal = old.map(|corners| self.normal(corners));
        let turns_over = new.iter().any(|&corners| {
            let own = self.normal(corners);
            // The normal of a triangle on a line is unknown.
            normal.iter().any(|old| own.dot(*old) < 0.0)
        });
        if touches || is_edge || angle(new) <= angle(old) || turns_over {
            return false;
        }
        self.triangles[triangle as usize] = new[0];
        self.triangles[other as usize] = new[1];
        self.at[to as usize].retain(|&own| own != triangle);
        self.at[from as usize].retain(|&own| own != other);
        self.at[far as usize].push(triangle);
        self.at[apex as usize].push(other);
        changed.extend([from, to, apex, far]);
        true
    }

    /// Collapses an edge of a triangle into one of its ends, where the result is a mesh without worse triangles.
    fn collapse(&mut self, triangle: u32, [from, to, _]: [u32; 3], changed: &mut Vec<u32>) -> bool {
        let least = self.angle_of(triangle);
        let [around_from, around_to] = [from, to].map(|vertex| self.neighbours(vertex));
        let gone =
            Vec::from_iter(std::iter::once(triangle).chain(self.beyond(triangle, [from, to])));
        // Only the corners opposite to the edge may be neighbours of both ends, and none may lose its third neighbour.
        if around_from.intersection(&around_to).count() != gone.len() {
            return false;
        }
        let apexes = Vec::from_iter(gone.iter().filter_map(|&gone| self.apex(gone, [from, to])));
        let keeps_enough = |&apex: &u32| {
            let least = if self.is_at_border(apex) { 2 } else { 3 };
            self.at[apex as usize].len() > least
        };
        if !apexes.iter().all(keeps_enough) {
            return false;
        }
        let ends = [[from, to], [to, from]];
        let around_lost = |lost: u32| {
            let around = if lost == from {
                &around_from
            } else {
                &around_to
            };
            around.iter().copied().chain([lost])
        };
        let is_possible = |[lost, kept]: &[u32; 2]| {
            // A vertex of the border may only move along it, and not around a corner: it stays.
            let touches = around_lost(*lost).any(|vertex| self.is_double[vertex as usize]);
            !touches && !self.is_at_border(*lost) && self.is_no_worse(*lost, *kept, &gone, least)
        };
        let Some([lost, kept]) = ends.into_iter().find(is_possible) else {
            return false;
        };
        changed.extend(self.neighbours(lost));
        for &gone in &gone {
            self.is_kept[gone as usize] = false;
            for vertex in self.triangles[gone as usize] {
                self.at[vertex as usize].retain(|&own| own != gone);
            }
        }
        for moved in std::mem::take(&mut self.at[lost as usize]) {
            for corner in &mut self.triangles[moved as usize] {
                if *corner == lost {
                    *corner = kept;
                }
            }
            self.at[kept as usize].push(moved);
        }
        true
    }

    /// Whether the triangles of a vertex keep their direction, and angles above the least, when it moves.
    fn is_no_worse(&self, lost: u32, kept: u32, gone: &[u32], least: f64) -> bool {
        let moved = self.at[lost as usize]
            .iter()
            .filter(|moved| !gone.contains(moved));
        moved.copied().all(|moved| {
            let old = self.triangles[moved as usize];
            let new = old.map(|corner| if corner == lost { kept } else { corner });
            let is_thin = self.angle(new) < least.min(self.angle(old));
            !is_thin && self.normal(old).dot(self.normal(new)) >= 0.0
        })
    }
}
