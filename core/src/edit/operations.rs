//! Flips, splits and collapses.

use super::{EditableMesh, Freedom, NONE, Refusal, next, previous, rotated};
use alloc::vec::Vec;

impl EditableMesh {
    /// Replaces an edge by the other diagonal of its two triangles. The half-edge keeps its number.
    ///
    /// # Errors
    /// At the border, on a kept line, or if the diagonal exists.
    ///
    /// # Panics
    /// If there is no such half-edge.
    pub fn flip(&mut self, half_edge: u32) -> Result<(), Refusal> {
        self.may_flip(half_edge)?;
        let other = self.opposite[half_edge as usize];
        let [a, b] = [self.tail(half_edge), self.tail(other)];
        let [c, d] = [self.apex(half_edge), self.apex(other)];
        let [bc, ca] = [next(half_edge), previous(half_edge)];
        let [ad, db] = [next(other), previous(other)];
        let outside =
            [bc, ca, ad, db].map(|at| (self.opposite[at as usize], self.kept[at as usize]));
        let [[t, k], [u, l]] = [half_edge, other].map(|at| [at / 3, at % 3].map(|x| x as usize));
        // (d, c, a) and (c, d, b): the half-edge runs from d to c.
        self.triangles[t] = rotated([d, c, a], k);
        self.triangles[u] = rotated([c, d, b], l);
        self.set_kept(half_edge, false);
        for (place, (opposite, kept)) in [
            previous(other),
            next(half_edge),
            previous(half_edge),
            next(other),
        ]
        .into_iter()
        .zip(outside)
        {
            self.pair(place, opposite);
            self.set_kept(place, kept);
        }
        for corner in [
            half_edge,
            next(half_edge),
            previous(half_edge),
            other,
            next(other),
            previous(other),
        ] {
            self.leave_by(corner);
        }
        Ok(())
    }

    /// Whether [`Self::flip`] is legal.
    ///
    /// # Errors
    /// The errors of [`Self::flip`].
    ///
    /// # Panics
    /// If there is no such half-edge.
    pub fn may_flip(&self, half_edge: u32) -> Result<(), Refusal> {
        let other = self.opposite(half_edge).ok_or(Refusal::Border)?;
        if self.is_kept(half_edge) {
            return Err(Refusal::Kept);
        }
        let edge = [self.apex(half_edge), self.apex(other)];
        if edge[0] == edge[1] || self.neighbours(edge[0]).any(|vertex| vertex == edge[1]) {
            return Err(Refusal::ExistingEdge { edge });
        }
        Ok(())
    }

    /// Splits an edge, and the triangles at it, by a new vertex, and returns its number. The half-edge keeps its number
    /// and its start. Parts of a kept edge are kept.
    ///
    /// # Panics
    /// If there is no such half-edge.
    pub fn split(&mut self, half_edge: u32) -> u32 {
        let middle = self.leaving.len() as u32;
        self.leaving.push(NONE);
        self.fixed.push(false);
        let kept = self.kept[half_edge as usize];
        let other = self.opposite(half_edge);
        let halves = [Some(half_edge), other].map(|side| Some(self.split_side(side?, middle)));
        if let [Some(behind), there] = halves {
            match (other, there) {
                (Some(other), Some(beyond)) => {
                    // The half-edge ends at the middle; `other` begins at the old head.
                    self.pair(half_edge, beyond);
                    self.pair(behind, other);
                }
                _ => self.pair(behind, NONE),
            }
            self.set_kept(half_edge, kept);
            self.set_kept(behind, kept);
            for start in [Some(behind), there, other, Some(half_edge)]
                .into_iter()
                .flatten()
            {
                for corner in [start, next(start), previous(start)] {
                    self.leave_by(corner);
                }
            }
        }
        middle
    }

    /// Splits the triangle (a, b, c) of the half-edge from a to b into (a, m, c) in its place and (m, b, c), and returns
    /// the half-edge from m to b.
    fn split_side(&mut self, half_edge: u32, middle: u32) -> u32 {
        let [b, c] = [self.head(half_edge), self.apex(half_edge)];
        let side = next(half_edge);
        let (outside, kept) = (self.opposite[side as usize], self.kept[side as usize]);
        let new = 3 * self.triangles.len() as u32;
        self.triangles.push([middle, b, c]);
        self.opposite.extend([NONE; 3]);
        self.kept.extend([false; 3]);
        self.triangles[side as usize / 3][side as usize % 3] = middle;
        self.pair(next(new), outside);
        self.set_kept(next(new), kept);
        self.pair(side, previous(new));
        self.set_kept(side, false);
        new
    }

    /// Removes the vertex at the start of a half-edge: its other neighbours become neighbours of the vertex at the end.
    ///
    /// # Errors
    /// If the vertex may not be removed, or if the surface would not remain a manifold with the same holes.
    ///
    /// # Panics
    /// If there is no such half-edge.
    pub fn collapse(&mut self, half_edge: u32) -> Result<(), Refusal> {
        self.may_collapse(half_edge)?;
        let [tail, head] = [self.tail(half_edge), self.head(half_edge)];
        let ring = Vec::from_iter(self.around(tail));
        for &corner in &ring {
            self.triangles[corner as usize / 3][corner as usize % 3] = head;
        }
        self.leaving[tail as usize] = NONE;
        let other = self.opposite(half_edge);
        let mut left = Vec::with_capacity(2);
        for side in [Some(half_edge), other].into_iter().flatten() {
            let [first, second] = [next(side), previous(side)];
            let outside = [first, second].map(|at| self.opposite[at as usize]);
            let kept = self.kept[first as usize] || self.kept[second as usize];
            left.push((self.apex(side), outside, kept));
            self.triangles[side as usize / 3] = [NONE; 3];
            self.removed_triangles += 1;
        }
        self.leaving[head as usize] = NONE;
        for (apex, outside, kept) in left {
            self.leaving[apex as usize] = NONE;
            match outside {
                [NONE, at] | [at, NONE] => self.pair(at, NONE),
                [at, there] => {
                    self.pair(at, there);
                    self.set_kept(at, kept);
                }
            }
            // Any half-edge of each vertex, and then the one along the border, if there is one.
            for at in outside.into_iter().filter(|&at| at != NONE) {
                for corner in [at, next(at), previous(at)] {
                    let tail = self.tail(corner) as usize;
                    if self.leaving[tail] == NONE {
                        self.leaving[tail] = corner;
                    }
                }
            }
            self.start_at_border(apex);
        }
        self.start_at_border(head);
        Ok(())
    }

    /// Whether [`Self::collapse`] is legal.
    ///
    /// # Errors
    /// The errors of [`Self::collapse`].
    ///
    /// # Panics
    /// If there is no such half-edge.
    pub fn may_collapse(&self, half_edge: u32) -> Result<(), Refusal> {
        let [tail, head] = [self.tail(half_edge), self.head(half_edge)];
        let along = self.is_kept(half_edge);
        match self.freedom(tail) {
            Freedom::Free => {}
            Freedom::OnLine(_) if along => {}
            _ => return Err(Refusal::FixedVertex { vertex: tail }),
        }
        let other = self.opposite(half_edge);
        let apexes = [Some(half_edge), other].map(|side| side.map(|side| self.apex(side)));
        let is_apex = |vertex: u32| apexes.contains(&Some(vertex));
        // The link condition: common neighbours are the apexes.
        let common = |vertex: &u32| self.neighbours(head).any(|other| other == *vertex);
        if self
            .neighbours(tail)
            .filter(common)
            .any(|vertex| !is_apex(vertex))
        {
            return Err(Refusal::Topology);
        }
        if self.is_border(tail) && self.is_border(head) && other.is_some() {
            return Err(Refusal::Topology);
        }
        for side in [Some(half_edge), other].into_iter().flatten() {
            let apex = self.apex(side);
            // Two triangles with the same corners would be left, or none at the apex.
            let least = if self.is_border(apex) { 2 } else { 3 };
            if self.valence(apex) <= least {
                return Err(Refusal::Topology);
            }
            // Two lines would become one.
            let [first, second] = [next(side), previous(side)].map(|at| self.is_kept(at));
            if first && second {
                return Err(Refusal::Topology);
            }
        }
        Ok(())
    }
}
