//! The fits around all vertices: their neighbours, attempts and results.

use super::block::{Block, Found, Lanes, Polynomials};
use super::{Attempt, Jet, least_count};
use crate::element::{Ragged, SlotKernel, Slots};
use crate::fit::{NormalEquations, Spacing, spacing};
use crate::lane::{Lane, Several, WIDTH};
use crate::laplacian::{Curvature, RowSlots};
use crate::neighbourhood::{Neighbourhood, Search, Surroundings, key_of};
use crate::real::{Real, finite_or_zero};
use crate::surface::Surface;
use crate::vec3::{Vec3, dot};
use alloc::vec::Vec;
use core::iter::zip;

/// Slope of the fitted surface in its frame above which it is fitted again in a frame along its
/// normal.
const LEAN: f64 = 0.1;

/// Number of vertices with pending fits: enough to find several of the same degree among repeated
/// attempts.
const PENDING: usize = 32;

/// The least cosine between the normals at a vertex and at its neighbours.
const LEAST_COSINE: f64 = 0.05;

/// The ratio of spacings below which a mesh is even.
const FINER: f64 = 1.02;

/// Parts of a spread that is enough: at the first, fits take all of the rows into account, and from the second on
/// they accept neighbours that they have chosen with regard to rows.
const ROWS_ONLY: f64 = 0.01;
const ACCEPTED: f64 = 0.33;

/// Part of the least spread with which fits are accepted at a boundary, where all neighbours lie on one side.
const ONE_SIDED: f64 = 0.2;

/// Ratio of aspects that are not tried both.
const NEAR: f64 = 1.3;

/// Number of vertices that a search in rings finds, in units of the room for neighbours; beyond it, around vertices with
/// hundreds of edges, it allocates.
const SEARCHED: usize = 4;

/// Number of rings in which neighbours are sought if those nearest in space do not suffice.
const RINGS: usize = 4;

/// The fits around all vertices.
pub(super) struct Fits<'a, T> {
    pub(super) jet: &'a Jet<T>,
    pub(super) surroundings: &'a Surroundings,
    pub(super) surface: Surface<'a, T>,
    /// Initial normals.
    pub(super) normals: &'a [Vec3<T>],
}

/// Derivatives of curvatures at a vertex.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Derivatives<T> {
    /// The gradients of H and K on the fitted surface.
    pub(super) gradients: [Vec3<T>; 2],
    /// Δ_S H of the fitted surface, without what the row yields of H of that surface.
    pub(super) missing: T,
}

/// Output of a fit: the curvature, with the initial normal; the degree, a bound of the distances of the
/// neighbours, and derivatives; H and K at the vertices of the one-ring; a row; and the numbers of the polynomial, none
/// unless it is kept.
type FitSlots<'a, T> = (
    (
        &'a mut [Curvature<T>],
        (&'a mut [u8], (&'a mut [i32], &'a mut [Derivatives<T>])),
    ),
    (Ragged<'a, [T; 2]>, (RowSlots<'a, T>, Ragged<'a, T>)),
);

/// Memory of a worker.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch<T> {
    /// The keys of the surroundings of each pending vertex, the same number of entries for each.
    keys: Vec<i32>,
    ranks: Vec<u64>,
    /// Searches in rings: the vertices found, and their distances, numbers and order.
    near: Neighbourhood<T>,
    ranked: Vec<(i32, u32, u32)>,
    block: Block<T>,
}

/// A vertex of which the fit is pending.
struct Pending<'a, T> {
    vertex: usize,
    curvature: &'a mut Curvature<T>,
    degree: &'a mut u8,
    /// See [`Search::bound`].
    bound: &'a mut i32,
    derivatives: &'a mut Derivatives<T>,
    /// H and K at the vertices of the one-ring.
    ring: &'a mut [[T; 2]],
    length: &'a mut u32,
    columns: &'a mut [u32],
    row: &'a mut [T],
    polynomial: &'a mut [T],
    /// The normal of the frame, and whether it comes from a fit.
    normal: Vec3<T>,
    upright: bool,
    attempt: Attempt,
    available: usize,
    /// The spacing of the attempt.
    spacing: Spacing<T>,
    /// The spacing of the mesh, once it is needed.
    rows: Option<Spacing<T>>,
    /// Whether neighbours have to be chosen by their normals, too, and whether these limit them.
    turns: bool,
    limited: bool,
    /// Whether the distances of nearby vertices are known.
    are_known: bool,
}

/// The vertices with pending fits, each in its own slot.
type Queue<'a, T> = [Option<Pending<'a, T>>; PENDING];

impl<'a, T: Real> SlotKernel<Scratch<T>, FitSlots<'a, T>> for Fits<'_, T> {
    #[inline(always)]
    fn set(&self, scratch: &mut Scratch<T>, start: usize, slots: FitSlots<'a, T>) {
        let mut slots = (start..).zip(slots.into_slots());
        let mut queue: Queue<'_, T> = [const { None }; PENDING];
        let room = self.surroundings.room();
        scratch.keys.resize(PENDING * room, 0);
        scratch.ranks.resize(2 * room + 1, 0);
        let searched = SEARCHED * room;
        scratch.near.reserve(self.surface.mesh(), searched);
        scratch.ranked.clear();
        scratch.ranked.reserve(searched);
        loop {
            let (mut order, mut count) = ([0; PENDING], 0);
            for (place, pending) in queue.iter_mut().enumerate() {
                while pending.is_none()
                    && let Some((vertex, slot)) = slots.next()
                {
                    *pending = self.begin(vertex, slot);
                }
                if pending.is_some() {
                    order[count] = place;
                    count += 1;
                }
            }
            order[..count].sort_unstable_by_key(|&place| (attempt_at(&queue, place), place));
            // Blocks have one degree; an incomplete block is fitted only if there is no complete one.
            let (mut rest, mut idle) = (&order[..count], true);
            while let Some(&first) = rest.first() {
                let Some(Attempt { degree, .. }) = attempt_at(&queue, first) else {
                    break;
                };
                let alike = |&&place: &&usize| {
                    attempt_at(&queue, place).is_some_and(|other| other.degree == degree)
                };
                let alike = rest.iter().take(WIDTH).take_while(alike).count();
                let (members, others) = rest.split_at(alike);
                rest = others;
                if alike == WIDTH || (idle && others.is_empty()) {
                    self.fit_block(scratch, &mut queue, members, degree);
                    idle = false;
                }
            }
            if idle {
                break;
            }
        }
    }
}

impl<T: Real> Fits<'_, T> {
    /// Prepares a vertex; `None` if its neighbours do not determine any fit.
    #[inline(always)]
    fn begin<'b>(
        &self,
        vertex: usize,
        slot: <FitSlots<'b, T> as Slots>::Slot,
    ) -> Option<Pending<'b, T>> {
        let (of_vertex, (ring, ((length, (columns, row)), polynomial))) = slot;
        let (curvature, (degree, (bound, derivatives))) = of_vertex;
        let available = self.surroundings.of(vertex).count().min(columns.len());
        let normal = curvature.normal;
        let attempt = self.jet.first_attempt(self.jet.highest_degree(), available);
        (curvature.mean, curvature.gaussian) = (T::zero(), T::zero());
        (*degree, *length) = (0, 0);
        *derivatives = Derivatives::default();
        curvature.direction = [T::zero(); 3];
        let attempt = attempt?;
        // Without a normal, heights are undefined.
        if normal == [T::zero(); 3] {
            return None;
        }
        Some(Pending {
            vertex,
            curvature,
            degree,
            bound,
            derivatives,
            ring,
            length,
            columns,
            row,
            polynomial,
            normal,
            upright: false,
            attempt,
            available,
            spacing: Spacing::even(),
            rows: None,
            turns: false,
            limited: false,
            are_known: false,
        })
    }

    /// Fits the vertices in some slots of the queue, at most `WIDTH`, by polynomials of one degree.
    /// Finished vertices leave the queue.
    #[inline(always)]
    fn fit_block(
        &self,
        scratch: &mut Scratch<T>,
        queue: &mut Queue<'_, T>,
        members: &[usize],
        degree: usize,
    ) {
        let neighbours = |&place: &usize| attempt_at(queue, place).map_or(0, |a| a.neighbours);
        let rows = members.iter().map(neighbours).max().unwrap_or(0);
        let shape = Polynomials {
            degree,
            sharpness: self.jet.sharpness,
            refined: NormalEquations::need_refinement(self.jet.least_spread(degree)),
        };
        let mut lanes = Lanes {
            normals: [Several::zero(); 3],
            along: [Several::zero(); 3],
            aspects: Several::literal(1.0),
        };
        scratch.block.clear(rows, degree);
        let mut usable = [false; WIDTH];
        for (lane, &place) in members.iter().take(WIDTH).enumerate() {
            let Some(pending) = &mut queue[place] else {
                continue;
            };
            usable[lane] = self.choose(pending, scratch, place);
            if !usable[lane] {
                continue;
            }
            let nearest = &pending.columns[..pending.attempt.neighbours];
            let vertex = pending.vertex as u32;
            scratch
                .block
                .set_differences(lane, self.surface, vertex, nearest);
            let Spacing { along, aspect } = pending.spacing;
            lanes.aspects.0[lane] = aspect;
            let vectors = lanes.normals.iter_mut().zip(&mut lanes.along);
            for ((normal, row), (&x, &y)) in vectors.zip(pending.normal.iter().zip(&along)) {
                (normal.0[lane], row.0[lane]) = (x, y);
            }
        }
        let block = &mut scratch.block;
        let found = block.fit(shape, lanes);
        let mut settled = [false; WIDTH];
        for (lane, &place) in members.iter().take(WIDTH).enumerate() {
            let Some(pending) = &mut queue[place] else {
                continue;
            };
            let next = if !usable[lane] {
                self.lower(pending)
            } else if self.accepts(pending, found.spread.0[lane]) {
                // A slightly tilted frame is sufficient, because the formulas include slopes.
                if pending.upright || found.slope.0[lane] <= T::constant(LEAN * LEAN) {
                    settled[lane] = pending.settle(&found, lane);
                    None
                } else {
                    pending.upright = true;
                    pending.normal = found.normal.map(|x| x.0[lane]);
                    Some(pending.attempt)
                }
            } else {
                self.next_attempt(pending, found.spread.0[lane])
            };
            match next {
                Some(attempt) => pending.attempt = attempt,
                None if settled[lane] => {}
                None => queue[place] = None,
            }
        }
        if settled == [false; WIDTH] {
            return;
        }
        let mut most = 0;
        let mut are_kept = false;
        for (lane, &place) in members.iter().take(WIDTH).enumerate() {
            if settled[lane]
                && let Some(pending) = &mut queue[place]
            {
                most = most.max(pending.ring.len());
                if !pending.polynomial.is_empty() {
                    are_kept = true;
                    block.store(degree, &found, lane, pending.polynomial);
                }
            }
        }
        let missing = if are_kept {
            Several::zero()
        } else {
            self.set_rows(block, queue, members, (shape, &found), settled)
        };
        let [means, gaussians] = block.curvatures(degree, most, &found);
        for (lane, &place) in members.iter().take(WIDTH).enumerate() {
            if settled[lane]
                && let Some(pending) = queue[place].take()
            {
                [pending.derivatives.missing] = finite_or_zero([missing.0[lane]]);
                let of_lane = |gradient: Vec3<Several<T>>| gradient.map(|x| x.0[lane]);
                pending.derivatives.gradients = found.gradients.map(of_lane);
                let ring = self.surface.mesh().one_ring(pending.vertex);
                // Neighbours are in the order of the rings.
                let columns = &pending.columns[..pending.attempt.neighbours];
                let mut columns = zip(columns, zip(means, gaussians)).peekable();
                for (at, vertex) in pending.ring.iter_mut().zip(ring) {
                    let found = columns.next_if(|&(column, _)| column == vertex);
                    *at = found.map_or([T::nan(); 2], |(_, (mean, gaussian))| {
                        [mean.0[lane], gaussian.0[lane]]
                    });
                }
            }
        }
    }

    /// Sets the rows of Δ_S of the vertices that are settled, and returns Δ_S H of the polynomials without what the rows
    /// yield of it.
    #[inline(always)]
    fn set_rows(
        &self,
        block: &mut Block<T>,
        queue: &mut Queue<'_, T>,
        members: &[usize],
        (shape, found): (Polynomials<T>, &Found<T>),
        settled: [bool; WIDTH],
    ) -> Several<T> {
        let rows = block.rows(shape, found);
        for (lane, &place) in members.iter().take(WIDTH).enumerate() {
            if settled[lane]
                && let Some(pending) = &mut queue[place]
            {
                let row = &mut pending.row[..pending.attempt.neighbours];
                for (entry, coefficient) in row.iter_mut().zip(rows) {
                    *entry = coefficient.0[lane];
                }
            }
        }
        found.laplacian_of_mean - block.rows_of_mean(shape.degree, found)
    }

    /// Sets the neighbours of an attempt; false if those whose normals turn away leave too few.
    #[inline(always)]
    fn choose(&self, pending: &mut Pending<'_, T>, scratch: &mut Scratch<T>, place: usize) -> bool {
        let vertex = pending.vertex as u32;
        if pending.rows.is_none() && !pending.turns {
            let nearest = &mut pending.columns[..pending.attempt.neighbours];
            let room = self.surroundings.room();
            let search = Search {
                keys: &mut scratch.keys[place * room..][..room],
                are_known: &mut pending.are_known,
                ranks: &mut scratch.ranks,
                bound: pending.bound,
            };
            let nearby = self.surroundings.of(pending.vertex);
            if !nearby.set_nearest(nearest, self.surface, vertex, search) {
                self.search_farther(nearest, vertex, scratch);
            }
            pending.turns = !nearest.iter().all(|&other| self.sees(vertex, other));
            if !pending.turns {
                return true;
            }
        }
        self.choose_in_rows(pending, scratch)
    }

    /// Replaces the farthest of the nearest vertices by nearer ones beyond the surroundings. Not inlined, because there is
    /// little to vectorise.
    #[inline(never)]
    fn search_farther(&self, nearest: &mut [u32], vertex: u32, scratch: &mut Scratch<T>) {
        let Scratch { near, ranked, .. } = scratch;
        let seen = self.surface.seen_from(vertex);
        let key = |other| {
            let difference = seen.difference(other);
            key_of(dot(difference, difference))
        };
        ranked.clear();
        ranked.extend(
            nearest
                .iter()
                .zip(0..)
                .map(|(&other, order)| (key(other), other, order)),
        );
        // Not the bound of the search before, which depends on earlier evaluations.
        let farthest = ranked.iter().map(|&(key, ..)| key).max().unwrap_or(0);
        let rings = self.surroundings.of(vertex as usize);
        near.beyond(self.surface, vertex, rings, (nearest, farthest));
        let found = near.found.iter().map(|&(_, other)| (key(other), other));
        let found = found
            .filter(|&(key, _)| key <= farthest)
            .zip(ranked.len() as u32..);
        ranked.extend(found.map(|((key, other), order)| (key, other, order)));
        if ranked.len() > nearest.len() {
            take_least(nearest, ranked);
        }
    }

    /// Whether a neighbour's normal does not turn away.
    #[inline(always)]
    fn sees(&self, vertex: u32, other: u32) -> bool {
        let [own, other] = [vertex, other].map(|vertex| self.normals[vertex as usize]);
        dot(own, other) >= T::constant(LEAST_COSINE)
    }

    /// As [`Self::choose`], with distances in the spacing of rows, and only those that do not turn away. Not
    /// inlined, because it is rarely needed.
    #[inline(never)]
    fn choose_in_rows(&self, pending: &mut Pending<'_, T>, scratch: &mut Scratch<T>) -> bool {
        let Scratch { near, ranked, .. } = scratch;
        let vertex = pending.vertex as u32;
        let Attempt { degree, neighbours } = pending.attempt;
        near.whole_rings(
            self.surface,
            vertex,
            RINGS,
            neighbours + neighbours * 7 / 10 + 20,
        );
        let seen = self.surface.seen_from(vertex);
        ranked.clear();
        let mut left_out = i32::MAX;
        for (order, &(_, other)) in near.found.iter().enumerate() {
            let squared = pending.spacing.squared(seen.difference(other));
            let key = key_of(squared);
            if self.sees(vertex, other) {
                ranked.push((key, other, order as u32));
            } else {
                left_out = left_out.min(key);
            }
        }
        let count = ranked.len().min(neighbours);
        if let Some(farthest) = take_least(&mut pending.columns[..count], ranked) {
            pending.limited = left_out < farthest;
        }
        if count < neighbours {
            pending.attempt.neighbours = count;
            pending.available = count;
        }
        count >= least_count(degree)
    }

    /// Whether a fit is determined well enough.
    #[inline(always)]
    fn accepts(&self, pending: &mut Pending<'_, T>, spread: T) -> bool {
        let Attempt { degree, neighbours } = pending.attempt;
        let spread = spread.max(T::zero()).sqrt();
        let mut least = self.jet.least_spread(degree);
        let mut enough = self.jet.enough_spread(degree);
        if !self.surface.mesh().is_interior(pending.vertex) {
            enough = NormalEquations::<T>::least_distance().max(T::constant(ONE_SIDED) * least);
            least = enough;
        }
        if spread >= enough {
            return true;
        }
        let next = self.next_aspect(pending, spread);
        if spread < least || spread.is_nan() || next > T::constant(FINER) * pending.spacing.aspect {
            return false;
        }
        let last = self.jet.last_neighbours(degree, pending.available);
        spread >= T::constant(ACCEPTED) * enough || neighbours == last && !pending.limited
    }

    /// The aspect of the attempt after one of this spread: the less it is determined, the more the rows count.
    #[inline(never)]
    fn next_aspect(&self, pending: &mut Pending<'_, T>, spread: T) -> T {
        let rows = self.rows_at(pending).aspect;
        if pending.spacing.aspect > T::one() {
            let enough =
                spread >= T::constant(ACCEPTED) * self.jet.enough_spread(pending.attempt.degree);
            let further = (pending.spacing.aspect * rows).sqrt();
            return match enough {
                true => pending.spacing.aspect,
                false if further * T::constant(NEAR) < rows => further,
                false => rows,
            };
        }
        let part = spread / self.jet.enough_spread(pending.attempt.degree);
        let least = T::constant(ROWS_ONLY);
        if part > least {
            rows.powf(part.ln() / least.ln())
        } else {
            rows
        }
    }

    #[inline(always)]
    fn rows_at(&self, pending: &mut Pending<'_, T>) -> Spacing<T> {
        let at = || spacing(self.surface, self.normals, pending.vertex);
        *pending.rows.get_or_insert_with(at)
    }

    /// The attempt after a failed one of this spread: with more regard to the rows, with more neighbours, then
    /// of a lower degree.
    #[inline(never)]
    fn next_attempt(&self, pending: &mut Pending<'_, T>, spread: T) -> Option<Attempt> {
        let aspect = self.next_aspect(pending, spread.max(T::zero()).sqrt());
        let Attempt { degree, neighbours } = pending.attempt;
        if aspect > T::constant(FINER) * pending.spacing.aspect {
            pending.spacing = Spacing {
                aspect,
                ..self.rows_at(pending)
            };
            return Some(pending.attempt);
        }
        let last = self.jet.last_neighbours(degree, pending.available);
        if neighbours < last && !pending.limited {
            let neighbours = (2 * neighbours).min(last);
            return Some(Attempt { degree, neighbours });
        }
        self.lower(pending)
    }

    /// The first attempt of the next lower degree: two lower, because odd terms hardly change H.
    fn lower(&self, pending: &mut Pending<'_, T>) -> Option<Attempt> {
        pending.spacing = Spacing::even();
        let highest = match pending.attempt.degree {
            0..=2 => return None,
            degree => (degree - 2).max(2),
        };
        self.jet.first_attempt(highest, pending.available)
    }
}

/// Sets `nearest` to the vertices of the least keys, in their order, and returns the largest of these keys.
fn take_least(nearest: &mut [u32], ranked: &mut Vec<(i32, u32, u32)>) -> Option<i32> {
    let last = nearest.len().checked_sub(1)?;
    let (_, &mut (farthest, ..), _) = ranked.select_nth_unstable(last);
    ranked.truncate(nearest.len());
    ranked.sort_unstable_by_key(|&(_, _, order)| order);
    for (nearest, &(_, other, _)) in zip(nearest, &*ranked) {
        *nearest = other;
    }
    Some(farthest)
}

#[inline(always)]
fn attempt_at<T>(queue: &Queue<'_, T>, place: usize) -> Option<Attempt> {
    queue[place].as_ref().map(|pending| pending.attempt)
}

impl<T: Real> Pending<'_, T> {
    /// Sets the curvature; false if it overflows.
    #[inline(always)]
    fn settle(&mut self, found: &Found<T>, lane: usize) -> bool {
        let (mean, gaussian) = (found.mean.0[lane], found.gaussian.0[lane]);
        if !(mean.is_finite() && gaussian.is_finite()) {
            return false;
        }
        self.curvature.normal = found.normal.map(|x| x.0[lane]);
        self.curvature.direction = found.direction.map(|x| x.0[lane]);
        (self.curvature.mean, self.curvature.gaussian) = (mean, gaussian);
        *self.degree = self.attempt.degree as u8;
        *self.length = self.attempt.neighbours as u32;
        true
    }
}
