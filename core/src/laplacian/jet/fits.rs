//! The fits around all vertices, several vertices at a time.

use super::normal_equations::{NormalEquations, Points, TOGETHER};
use super::{Attempt, Jet, coefficient_count};
use crate::element::{SlotKernel, Slots};
use crate::lane::{Lane, Several, WIDTH};
use crate::laplacian::least_squares::LeastSquares;
use crate::laplacian::{Curvature, RowSlots};
use crate::neighbourhood::{Search, Surroundings};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{cross, dot, norm, normalise, scale, sub};
use alloc::vec::Vec;

/// Slope of the fitted surface in its frame above which it is fitted again in a frame along its
/// normal.
const LEAN: f64 = 0.1;

/// Number of vertices with pending fits: enough to find several of the same degree among repeated
/// attempts.
const PENDING: usize = 32;

/// The fits around all vertices.
pub(super) struct Fits<'a, T> {
    pub(super) jet: &'a Jet<T>,
    pub(super) surroundings: &'a Surroundings,
    pub(super) surface: Surface<'a, T>,
}

/// Output of a fit: the curvature, with the initial normal, the degree, a bound of the distances of the
/// neighbours, and a row.
type FitSlots<'a, T> = (
    (&'a mut [Curvature<T>], (&'a mut [u8], &'a mut [i32])),
    RowSlots<'a, T>,
);

/// Memory to fit several vertices at once, padded with neighbours at the vertex itself, whose
/// monomials are zero.
#[derive(Clone, Debug, Default)]
pub(super) struct Block<T> {
    /// The keys of the surroundings of each pending vertex, the same number of entries for each.
    keys: Vec<i32>,
    ranks: Vec<u64>,
    /// Neighbours' positions relative to the vertex, along each axis.
    differences: [Vec<Several<T>>; 3],
    /// Coordinates in the tangent plane in units of the radius, and weights.
    places: [Vec<Several<T>>; 2],
    heights: Vec<Several<T>>,
    /// Weights of neighbours, or of their squares if equations are normal.
    weights: Vec<Several<T>>,
    coefficients: Vec<Several<T>>,
    functional: Vec<Several<T>>,
    equations: NormalEquations<T>,
    factorisation: LeastSquares<T>,
}

/// Results for each vertex of a block, without coefficients.
struct Found<T> {
    frame: [[Several<T>; 3]; 2],
    over_radius: Several<T>,
}

/// A degree, and how fits of it are computed: vertices with the same are fitted together.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Kind {
    degree: usize,
    /// Whether by normal equations, or by an orthogonal factorisation.
    normal: bool,
    /// Whether solutions of normal equations are refined.
    refined: bool,
}

/// A polynomial in units of the radius, over the tangent plane of `normal`.
struct Polynomial<T> {
    normal: [T; 3],
    frame: [[T; 3]; 2],
    over_radius: T,
    /// p, q, c₂₀, c₁₁, c₀₂ of `p x + q y + c₂₀ x² + c₁₁ x y + c₀₂ y² + …`.
    leading: [T; LEADING],
}

/// Coefficients on which H, K and Δ_S depend.
const LEADING: usize = coefficient_count(2);

/// A vertex of which the fit is pending.
struct Pending<'a, T> {
    vertex: usize,
    curvature: &'a mut Curvature<T>,
    degree: &'a mut u8,
    /// See [`Search::bound`].
    bound: &'a mut i32,
    length: &'a mut u32,
    columns: &'a mut [u32],
    row: &'a mut [T],
    /// The normal of the frame, and whether it comes from a fit.
    normal: [T; 3],
    upright: bool,
    attempt: Attempt,
    available: usize,
    /// Number of nearby vertices of which the distances are known.
    known: usize,
}

/// The vertices with pending fits, each in its own slot.
type Queue<'a, T> = [Option<Pending<'a, T>>; PENDING];

impl<'a, T: Real> SlotKernel<Block<T>, FitSlots<'a, T>> for Fits<'_, T> {
    #[inline(always)]
    fn set(&self, block: &mut Block<T>, start: usize, slots: FitSlots<'a, T>) {
        let mut slots = (start..).zip(slots.into_slots());
        let mut queue: Queue<'_, T> = [const { None }; PENDING];
        let room = self.surroundings.room();
        block.keys.resize(PENDING * room, 0);
        // Whether rings beyond the first are needed depends on the positions.
        block.ranks.resize(2 * room + 1, 0);
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
            // Blocks have one kind; an incomplete block is fitted only if there is no complete one.
            let (mut rest, mut idle) = (&order[..count], true);
            while let Some(&first) = rest.first() {
                let Some(kind) = self.kind_at(&queue, first) else {
                    break;
                };
                let alike = |&&place: &&usize| self.kind_at(&queue, place) == Some(kind);
                let alike = rest.iter().take(WIDTH).take_while(alike).count();
                let (members, others) = rest.split_at(alike);
                rest = others;
                if alike == WIDTH || (idle && others.is_empty()) {
                    self.fit_block(block, &mut queue, members, kind);
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
        ((curvature, (degree, bound)), (length, (columns, row))): <FitSlots<'b, T> as Slots>::Slot,
    ) -> Option<Pending<'b, T>> {
        let available = self.surroundings.of(vertex).count().min(columns.len());
        let normal = curvature.normal;
        let attempt = self.jet.first_attempt(self.jet.highest_degree(), available);
        (curvature.mean, curvature.gaussian) = (T::zero(), T::zero());
        (*degree, *length) = (0, 0);
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
            length,
            columns,
            row,
            normal,
            upright: false,
            attempt,
            available,
            known: 0,
        })
    }

    /// The kind of the pending fit in a slot of the queue.
    #[inline(always)]
    fn kind_at(&self, queue: &Queue<'_, T>, place: usize) -> Option<Kind> {
        queue[place].as_ref().map(|pending| {
            let least = self.least_ratio(pending);
            Kind {
                degree: pending.attempt.degree,
                normal: NormalEquations::serve(least),
                refined: NormalEquations::need_refinement(least),
            }
        })
    }

    #[inline(always)]
    fn least_ratio(&self, pending: &Pending<'_, T>) -> T {
        self.jet.least_ratio(pending.attempt, pending.available)
    }

    /// Fits the vertices in some slots of the queue, at most `WIDTH`, by polynomials of one kind.
    /// Finished vertices leave the queue.
    #[inline(always)]
    fn fit_block(
        &self,
        block: &mut Block<T>,
        queue: &mut Queue<'_, T>,
        members: &[usize],
        kind: Kind,
    ) {
        let neighbours = |&place: &usize| attempt_at(queue, place).map_or(0, |a| a.neighbours);
        let rows = members.iter().map(neighbours).max().unwrap_or(0);
        let rows = rows.next_multiple_of(TOGETHER);
        let mut normals = [Several::zero(); 3];
        block.clear(rows, coefficient_count(kind.degree));
        for (lane, &place) in members.iter().take(WIDTH).enumerate() {
            let Some(pending) = &mut queue[place] else {
                continue;
            };
            let nearest = &mut pending.columns[..pending.attempt.neighbours];
            let room = self.surroundings.room();
            let search = Search {
                keys: &mut block.keys[place * room..][..room],
                known: &mut pending.known,
                ranks: &mut block.ranks,
                bound: pending.bound,
            };
            let (centre, nearby) = (pending.vertex as u32, self.surroundings.of(pending.vertex));
            nearby.set_nearest(nearest, self.surface, centre, search);
            block.set_differences(lane, self.surface, pending.vertex as u32, nearest);
            for (normal, &x) in normals.iter_mut().zip(&pending.normal) {
                normal.0[lane] = x;
            }
        }
        let found = block.place(kind.normal, normals, self.jet.sharpness);
        let mut least = [T::zero(); WIDTH];
        for (least, &place) in least.iter_mut().zip(members) {
            if let Some(pending) = &queue[place] {
                *least = self.least_ratio(pending);
            }
        }
        let accepted = block.fit(kind, &least[..members.len()]);
        let mut settled = [false; WIDTH];
        for (lane, &place) in members.iter().take(WIDTH).enumerate() {
            let Some(pending) = &mut queue[place] else {
                continue;
            };
            let next = if accepted[lane] {
                let polynomial = found.polynomial(lane, pending.normal, &block.coefficients);
                let [p, q, ..] = polynomial.leading;
                // A slightly tilted frame is sufficient, because the formulas include p and q.
                if pending.upright || p * p + q * q <= T::constant(LEAN * LEAN) {
                    settled[lane] = pending.settle(&polynomial, lane, &mut block.functional);
                    None
                } else {
                    pending.upright = true;
                    pending.normal = polynomial.surface_normal();
                    let highest = self.jet.highest_degree();
                    self.jet.first_attempt(highest, pending.available)
                }
            } else {
                self.jet.next_attempt(pending.attempt, pending.available)
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
        let rows = block.rows(kind.normal, found.over_radius);
        for (lane, &place) in members.iter().take(WIDTH).enumerate() {
            if settled[lane]
                && let Some(pending) = queue[place].take()
            {
                let row = &mut pending.row[..pending.attempt.neighbours];
                for (entry, coefficient) in row.iter_mut().zip(rows) {
                    *entry = coefficient.0[lane];
                }
            }
        }
    }
}

#[inline(always)]
fn attempt_at<T>(queue: &Queue<'_, T>, place: usize) -> Option<Attempt> {
    queue[place].as_ref().map(|pending| pending.attempt)
}

impl<T: Real> Pending<'_, T> {
    /// Sets the curvature, and the functional of the row; false if they overflow.
    #[inline(always)]
    fn settle(
        &mut self,
        polynomial: &Polynomial<T>,
        lane: usize,
        functional: &mut [Several<T>],
    ) -> bool {
        let (mean, gaussian, laplacian) = polynomial.curvatures();
        let over = polynomial.over_radius;
        if !(mean.is_finite() && gaussian.is_finite() && (over * over).is_finite()) {
            return false;
        }
        self.curvature.normal = polynomial.surface_normal();
        (self.curvature.mean, self.curvature.gaussian) = (mean, gaussian);
        *self.degree = self.attempt.degree as u8;
        *self.length = self.attempt.neighbours as u32;
        for (entry, value) in functional.iter_mut().zip(laplacian) {
            entry.0[lane] = value;
        }
        true
    }
}

impl<T: Real> Block<T> {
    /// Resizes for fits with `rows` neighbours, none of which is set, and `columns` coefficients.
    #[inline(always)]
    fn clear(&mut self, rows: usize, columns: usize) {
        for differences in &mut self.differences {
            differences.clear();
            differences.resize(rows, Several::zero());
        }
        self.coefficients.resize(columns, Several::zero());
        self.functional.clear();
        self.functional.resize(columns, Several::zero());
    }

    #[inline(always)]
    fn set_differences(
        &mut self,
        lane: usize,
        surface: Surface<'_, T>,
        vertex: u32,
        neighbours: &[u32],
    ) {
        let [x, y, z] = &mut self.differences;
        let seen = surface.seen_from(vertex);
        for (((&neighbour, x), y), z) in neighbours.iter().zip(x).zip(y).zip(z) {
            let difference = seen.difference(neighbour);
            (x.0[lane], y.0[lane], z.0[lane]) = (difference[0], difference[1], difference[2]);
        }
    }

    /// Sets places in the planes of the normals, heights and weights.
    #[inline(always)]
    fn place(&mut self, normal: bool, normals: [Several<T>; 3], sharpness: T) -> Found<T> {
        let Self {
            differences: [x, y, z],
            places: [across, along],
            heights,
            weights,
            ..
        } = self;
        let rows = x.len();
        let (y, z) = (&y[..rows], &z[..rows]);
        let [mut farthest, mut widest] = [Several::zero(); 2];
        let mut outermost = [Several::zero(); 3];
        for row in 0..rows {
            let difference = [x[row], y[row], z[row]];
            let squared = dot(difference, difference);
            farthest = Several::select(farthest.less(squared), squared, farthest);
            let height = dot(difference, normals);
            let sideways = squared - height * height;
            let wider = widest.less(sideways);
            widest = Several::select(wider, sideways, widest);
            for (outermost, coordinate) in outermost.iter_mut().zip(difference) {
                *outermost = Several::select(wider, coordinate, *outermost);
            }
        }
        let over_radius = farthest.sqrt().reciprocal_or_zero();
        let frame = frame_towards(scale(over_radius, outermost), normals);
        for values in [&mut *across, &mut *along, &mut *heights, &mut *weights] {
            values.resize(rows, Several::zero());
        }
        let steepness = Several::splat(-sharpness);
        for row in 0..rows {
            let local = scale(over_radius, [x[row], y[row], z[row]]);
            across[row] = dot(local, frame[0]);
            along[row] = dot(local, frame[1]);
            heights[row] = dot(local, normals);
            weights[row] = steepness * dot(local, local);
        }
        // In a loop of its own, where the processor computes several of these long chains at a time.
        for weight in weights.iter_mut() {
            let value = exponential(*weight);
            *weight = if normal { value * value } else { value };
        }
        Found { frame, over_radius }
    }

    /// Fits polynomials to the heights; the coefficients where no fit is accepted have no meaning.
    #[inline(always)]
    fn fit(&mut self, kind: Kind, least: &[T]) -> [bool; WIDTH] {
        if !kind.normal {
            return self.factorise(kind.degree, least);
        }
        let points = Points {
            x: &self.places[0],
            y: &self.places[1],
            weights: &self.weights,
        };
        self.equations.set(kind.degree, kind.refined, points);
        let mut accepted = [false; WIDTH];
        for (lane, (accepted, &least)) in accepted.iter_mut().zip(least).enumerate() {
            *accepted = self.equations.determine(lane, least);
        }
        if accepted != [false; WIDTH] {
            self.equations
                .solve(points, &self.heights, &[], &mut self.coefficients);
        }
        accepted
    }

    /// As [`Self::fit`], by an orthogonal factorisation. Not inlined, because it is rarely needed.
    #[inline(never)]
    fn factorise(&mut self, degree: usize, least: &[T]) -> [bool; WIDTH] {
        let Self {
            places: [across, along],
            heights,
            weights,
            coefficients,
            factorisation,
            ..
        } = self;
        let rows = heights.len();
        let columns = coefficient_count(degree);
        let matrix = factorisation.matrix(rows, columns);
        let (matrix, right) = matrix.split_at_mut(rows * columns);
        set_product(right, weights, heights);
        // Degree after degree: x·(the last degree), and y·(its last monomial).
        set_product(&mut matrix[..rows], across, weights);
        set_product(&mut matrix[rows..2 * rows], along, weights);
        for degree in 2..=degree {
            let (last, start) = (coefficient_count(degree - 2), coefficient_count(degree - 1));
            let (before, now) = matrix.split_at_mut(start * rows);
            for (number, column) in now.chunks_exact_mut(rows).take(degree + 1).enumerate() {
                let (factor, from) = if number < degree {
                    (&*across, number)
                } else {
                    (&*along, degree - 1)
                };
                set_product(column, factor, &before[(last + from) * rows..][..rows]);
            }
        }
        let ratio = factorisation.factorise();
        factorisation.solve(coefficients);
        let mut accepted = [false; WIDTH];
        for ((accepted, &ratio), &least) in accepted.iter_mut().zip(&ratio.0).zip(least) {
            *accepted = ratio > T::zero() && ratio >= least;
        }
        accepted
    }

    /// The rows of the functionals.
    #[inline(always)]
    fn rows(&mut self, normal: bool, over_radius: Several<T>) -> &[Several<T>] {
        let rows = if normal {
            let points = Points {
                x: &self.places[0],
                y: &self.places[1],
                weights: &self.weights,
            };
            let coefficients = &mut self.coefficients;
            self.equations
                .solve(points, &[], &self.functional, coefficients);
            self.equations.evaluate(points, coefficients)
        } else {
            row_of(&mut self.factorisation, &self.functional)
        };
        for (entry, &weight) in rows.iter_mut().zip(&self.weights) {
            *entry = *entry * (weight * over_radius * over_radius);
        }
        rows
    }
}

/// The rows of the functionals after a factorisation. Not inlined, because it is rarely needed.
#[inline(never)]
fn row_of<'a, T: Real>(
    factorisation: &'a mut LeastSquares<T>,
    functional: &[Several<T>],
) -> &'a mut [Several<T>] {
    factorisation.row_of(functional)
}

/// Two unit vectors that form a right-handed frame with a unit vector `normal`, the first one
/// towards a point to the side of it; zeros if the point lies along the normal. Polynomials of a
/// degree are the same in every frame, but the condition of a fit is not: with a frame along the
/// coordinate axes, the choice of neighbours would depend on the orientation of the surface.
#[inline(always)]
fn frame_towards<T: Real>(point: [Several<T>; 3], normal: [Several<T>; 3]) -> [[Several<T>; 3]; 2] {
    let sideways = sub(point, scale(dot(point, normal), normal));
    let first = scale(norm(sideways).reciprocal_or_zero(), sideways);
    [first, cross(normal, first)]
}

impl<T: Real> Found<T> {
    /// The polynomial of one vertex.
    #[inline(always)]
    fn polynomial(
        &self,
        lane: usize,
        normal: [T; 3],
        coefficients: &[Several<T>],
    ) -> Polynomial<T> {
        let mut leading = [T::zero(); LEADING];
        for (leading, coefficient) in leading.iter_mut().zip(coefficients) {
            *leading = coefficient.0[lane];
        }
        Polynomial {
            normal,
            frame: self.frame.map(|axis| axis.map(|x| x.0[lane])),
            over_radius: self.over_radius.0[lane],
            leading,
        }
    }
}

impl<T: Real> Polynomial<T> {
    /// The surface's normal at the vertex.
    fn surface_normal(&self) -> [T; 3] {
        let [p, q, ..] = self.leading;
        let along = sub(self.normal, scale(p, self.frame[0]));
        normalise(sub(along, scale(q, self.frame[1])))
    }

    /// H, K, and the functional that takes the leading coefficients of any field to its Δ_S in units of
    /// the radius.
    fn curvatures(&self) -> (T, T, [T; LEADING]) {
        let one = T::one();
        let two = T::constant(2.0);
        let [p, q, c20, c11, c02] = self.leading;
        let (xx, xy, yy) = (two * c20, c11, two * c02);
        let w = one + p * p + q * q;
        let root = w.sqrt();
        let bend = (one + q * q) * xx - two * p * q * xy + (one + p * p) * yy;
        let mean = -bend / (two * w * root);
        let gaussian = (xx * yy - xy * xy) / (w * w);
        let laplacian = [
            two * mean * p / root,
            two * mean * q / root,
            two * (one - p * p / w),
            -two * p * q / w,
            two * (one - q * q / w),
        ];
        let over = self.over_radius;
        (mean * over, gaussian * over * over, laplacian)
    }
}

/// `e^x` for −16 < x ≤ 0, to rounding: the 64th power of the series of `e^(x/64)`. There is no
/// function call, which would prevent vectorisation.
#[inline(always)]
pub(crate) fn exponential<L: Lane>(x: L) -> L {
    let y = x * L::literal(1.0 / 64.0);
    let mut factorial = 362_880.0;
    let mut sum = L::literal(1.0 / factorial);
    for factor in [9.0, 8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0] {
        factorial /= factor;
        sum = L::literal(1.0 / factorial) + sum * y;
    }
    let fourth = (sum * sum) * (sum * sum);
    let sixteenth = (fourth * fourth) * (fourth * fourth);
    (sixteenth * sixteenth) * (sixteenth * sixteenth)
}

/// Sets `product` to the product of two columns, entry by entry.
#[inline(always)]
fn set_product<L: Lane>(product: &mut [L], a: &[L], b: &[L]) {
    for ((product, &a), &b) in product.iter_mut().zip(a).zip(b) {
        *product = a * b;
    }
}
