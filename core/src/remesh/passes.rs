//! Passes over a new mesh: splits, collapses, flips and movements of vertices.

mod turning;

use super::ground::{InputSurface, Sample, Spot};
use crate::edit::{EditableMesh, Freedom};
use crate::element::Execution;
use crate::face_tree::MeshPoint;
use crate::lane::Lane;
use crate::real::Real;
use crate::smooth_surface::{SmoothPoint, SmoothSurface};
use crate::vec3::{Vec3, add, cross, dot, norm, normalise, scale, sub, tangent_frame};
use alloc::vec;
use alloc::vec::Vec;
use core::iter::zip;

/// Edges longer than this part of the wanted length are split (M. Botsch and L. Kobbelt, Symp. Geometry Processing 2004).
const LONG: f64 = 4.0 / 3.0;

/// Edges shorter than this part are collapsed, source as above.
const SHORT: f64 = 4.0 / 5.0;

/// The part of the wanted length by which no vertex need move.
const SETTLED: f64 = 0.01;

/// Number of edges that are tried for each one to be collapsed; if these are not enough, as many times more.
const TRIED: usize = 8;

/// The cosine of the smallest angle of good triangles: 15°.
const SLENDER: f64 = 0.966;

/// The least cosine between the normals of a good triangle and of the input at its corners.
const OUTWARD: f64 = 0.5;

/// The error bar of a position, in edges of the input, from which on the flat triangle is taken instead.
const DOUBTFUL: f64 = 0.25;

/// Eight directions.
const COMPASS: [(f64, f64); 8] = {
    let half = core::f64::consts::FRAC_1_SQRT_2;
    [
        (1.0, 0.0),
        (half, half),
        (0.0, 1.0),
        (-half, half),
        (-1.0, 0.0),
        (-half, -half),
        (0.0, -1.0),
        (half, -half),
    ]
};

/// The worst of some triangles.
#[derive(Clone, Copy)]
struct WorstTriangle<T> {
    /// The least cosine between the normal of one and those of the input at its corners.
    outward: T,
    /// The cosine of the smallest angle.
    cosine: T,
}

impl<T: Real> WorstTriangle<T> {
    /// Whether these are good triangles.
    fn is_good(self) -> bool {
        self.outward >= T::constant(OUTWARD) && self.cosine <= T::constant(SLENDER)
    }

    /// Whether these are good triangles, or not worse than others.
    fn is_as_good_as(self, other: Self) -> bool {
        self.outward >= other.outward.min(T::constant(OUTWARD))
            && self.cosine <= other.cosine.max(T::constant(SLENDER))
    }
}

/// A new mesh in work.
pub(super) struct Remesher<'a, T> {
    pub(super) ground: InputSurface<'a, T>,
    pub(super) edited: EditableMesh,
    /// Where the vertices are on the input.
    pub(super) places: Vec<MeshPoint<T>>,
    /// Where they are on its lines.
    spots: Vec<Spot<T>>,
    /// The input at these places.
    samples: Vec<Sample<T>>,
    /// The points where they are put in the end.
    pub(super) points: Vec<SmoothPoint<T>>,
    /// Whether these are of the flat triangles.
    is_flat: Vec<bool>,
    /// The factor of all sizes.
    factor: T,
}

impl<'a, T: Real> Remesher<'a, T> {
    pub(super) fn new(ground: InputSurface<'a, T>) -> Self {
        let mesh = ground.surface.mesh();
        let used = |vertex: u32| mesh.valence(vertex as usize) > 0;
        let vertices = 0..mesh.vertex_count() as u32;
        let nowhere = MeshPoint {
            triangle: 0,
            barycentric: [T::zero(); 3],
        };
        let place = |vertex| {
            if used(vertex) {
                ground.vertex(vertex)
            } else {
                nowhere
            }
        };
        Self {
            edited: ground.corners.clone(),
            places: vertices.clone().map(place).collect(),
            spots: vertices.map(Spot::at_vertex).collect(),
            samples: ground.at_vertices(),
            points: Vec::new(),
            is_flat: Vec::new(),
            factor: T::one(),
            ground,
        }
    }

    /// The point of the smooth surface at a vertex; on a line the mean of those of its sides over the smooth line. Or the
    /// point of the flat triangle.
    pub(super) fn point(&self, smooth: &SmoothSurface<T>, vertex: u32) -> SmoothPoint<T> {
        let spot = self.spots[vertex as usize];
        let place = self.places[vertex as usize];
        if self.is_flat[vertex as usize] {
            return smooth.flat_point(place, [T::zero(); 3]);
        }
        if self.edited.freedom(vertex) == Freedom::Free || spot.from == spot.to {
            return trusted(smooth, place, [T::zero(); 3]);
        }
        let bend = self.ground.bend(spot);
        let sides = self.ground.sides(spot).into_iter().flatten();
        let sides = Vec::from_iter(sides.map(|side| trusted(smooth, side, bend)));
        let part = T::one() / T::constant(sides.len() as f64);
        let positions = sides.iter().map(|side| scale(part, side.position));
        SmoothPoint {
            position: positions.fold([T::zero(); 3], add),
            ..sides[0]
        }
    }

    /// Puts the vertices on the smooth surface, or on the flat triangles.
    pub(super) fn settle(&mut self, execution: &impl Execution, smooth: &SmoothSurface<T>) {
        self.is_flat.resize(self.places.len(), false);
        let mut points = vec![SmoothPoint::default(); self.places.len()];
        execution.map(&mut points[..], |vertex, point| {
            if self.edited.is_used(vertex as u32) {
                *point = self.point(smooth, vertex as u32);
            }
        });
        for (sample, point) in zip(&mut self.samples, &points) {
            sample.position = point.position;
        }
        self.points = points;
    }

    /// Takes the flat triangles at vertices and their neighbours, and returns whether any of them was not there.
    pub(super) fn retreat(&mut self, vertices: impl Iterator<Item = u32>) -> bool {
        let mut any = false;
        for vertex in vertices {
            for near in self.edited.neighbours(vertex).chain([vertex]) {
                any |= !core::mem::replace(&mut self.is_flat[near as usize], true);
            }
        }
        any
    }

    /// Number of vertices in triangles.
    pub(super) fn vertex_count(&self) -> usize {
        let vertices = 0..self.edited.vertex_count() as u32;
        vertices
            .filter(|&vertex| self.edited.is_used(vertex))
            .count()
    }

    fn at(&self, vertex: u32) -> Vec3<T> {
        self.samples[vertex as usize].position
    }

    fn size(&self, vertex: u32) -> T {
        self.samples[vertex as usize].size
    }

    /// The length of an edge over the wanted one.
    fn relative_length(&self, half_edge: u32) -> T {
        let [tail, head] = [self.edited.tail(half_edge), self.edited.head(half_edge)];
        self.relative_distance(tail, head)
    }

    fn relative_distance(&self, from: u32, to: u32) -> T {
        let wanted = (self.size(from) + self.size(to)) / T::constant(2.0);
        let length = norm(sub(self.at(to), self.at(from)));
        length * (self.factor * wanted).reciprocal_or_zero()
    }

    /// Twice the area vector of a triangle.
    fn area_vector(&self, corners: [u32; 3]) -> Vec3<T> {
        let [a, b, c] = corners.map(|corner| self.at(corner));
        cross(sub(b, a), sub(c, a))
    }

    fn set_place(&mut self, vertex: u32, place: MeshPoint<T>) {
        self.places[vertex as usize] = place;
        self.samples[vertex as usize] = self.ground.sample(place);
    }

    /// Edges whose relative length is beyond a limit, the farthest first, at most so many.
    fn beyond(&self, limit: T, longer: bool, most: usize) -> Vec<(T, u32)> {
        let edges = self.edited.edges();
        let edges = edges.map(|edge| (self.relative_length(edge), edge));
        let sign = if longer { -T::one() } else { T::one() };
        let edges = edges.filter(|(length, _)| sign * *length < sign * limit);
        let mut edges = Vec::from_iter(edges.map(|(length, edge)| (sign * length, edge)));
        let order = |(a, first): &(T, u32), (b, second): &(T, u32)| {
            let order = a.partial_cmp(b).unwrap_or(core::cmp::Ordering::Equal);
            order.then(first.cmp(second))
        };
        if most < edges.len() {
            edges.select_nth_unstable_by(most, order);
            edges.truncate(most);
        }
        edges.sort_unstable_by(order);
        edges
    }

    /// The number of equilateral triangles with edges of the wanted lengths: one of length l has the area √3/4 l².
    pub(super) fn equilateral_count(&self) -> T {
        let count = |half_edge: u32| {
            let corners = self.edited.corners(half_edge);
            let size: T = corners.map(|corner| self.size(corner)).into_iter().sum();
            let twice = norm(self.area_vector(corners));
            twice * T::constant(9.0) * (size * size).reciprocal_or_zero()
        };
        let counts: T = self.edited.triangles().map(count).sum();
        counts * T::constant(2.0 / 3.0_f64.sqrt())
    }

    /// Scales the wanted lengths: `now` is a number of triangles or vertices that came of the last factor.
    pub(super) fn scale(&mut self, now: T, wanted: T) {
        self.factor *= (now / wanted).sqrt();
    }

    /// Splits the longest or collapses the shortest edges until there are this many vertices, or none can be collapsed.
    pub(super) fn bring_to(&mut self, vertices: usize) {
        let now = self.vertex_count();
        if now < vertices {
            self.split(T::zero(), vertices - now);
            return;
        }
        // The shortest edges first; some cannot be collapsed.
        let mut left = now - vertices;
        let mut tried = left;
        while left > 0 && tried < 2 * self.edited.triangle_count() {
            tried = tried.saturating_mul(TRIED);
            left -= self.collapse(T::infinity(), T::infinity(), [left, tried]);
        }
    }

    /// Splits edges that are longer than a limit, the longest first, each once, and returns their number.
    fn split(&mut self, limit: T, most: usize) -> usize {
        let edges = self.beyond(limit, true, most);
        let ends = edges
            .iter()
            .map(|&(_, edge)| [self.edited.tail(edge), self.edited.head(edge)]);
        let ends = Vec::from_iter(ends);
        for &[tail, head] in &ends {
            // Splits before this one remove no other edge, but change numbers.
            let edge = self.edited.half_edge(tail, head);
            let edge = edge.or_else(|| self.edited.half_edge(head, tail));
            self.split_edge(edge.expect("an edge"));
        }
        ends.len()
    }

    /// Splits edges that are too long, each once, and returns their number.
    pub(super) fn split_long(&mut self) -> usize {
        self.split(T::constant(LONG), usize::MAX)
    }

    /// Collapses edges that are too short, and returns their number.
    pub(super) fn collapse_short(&mut self) -> usize {
        self.collapse(T::constant(SHORT), T::constant(LONG), [usize::MAX; 2])
    }

    fn split_edge(&mut self, edge: u32) {
        let [tail, head] = [self.edited.tail(edge), self.edited.head(edge)];
        let half = T::constant(0.5);
        let way = sub(self.at(head), self.at(tail));
        let (place, spot) = if self.edited.is_kept(edge) {
            let spot = self
                .ground
                .along(self.spots[tail as usize], way, half * norm(way));
            (self.ground.place(spot), spot)
        } else {
            let middle = add(self.at(tail), scale(half, way));
            let is_free = |vertex: &u32| self.edited.freedom(*vertex) == Freedom::Free;
            let place = match [tail, head].into_iter().find(is_free) {
                Some(free) => self.ground.nearest(self.places[free as usize], middle),
                None => self
                    .ground
                    .nearest_beside(self.spots[tail as usize], middle),
            };
            (place, Spot::at_vertex(0))
        };
        self.edited.split(edge);
        self.places.push(place);
        self.spots.push(spot);
        self.samples.push(self.ground.sample(place));
    }

    /// Collapses edges that are shorter than a limit and make none longer than another, the shortest first, at most so
    /// many of as many that are tried, and returns their number.
    fn collapse(&mut self, limit: T, long: T, [most, tried]: [usize; 2]) -> usize {
        let mut count = 0;
        for (_, edge) in self.beyond(limit, false, tried) {
            if count == most {
                break;
            }
            // Collapses before this one may have removed or changed the edge.
            if !self.edited.is_edge(edge) || self.relative_length(edge) >= limit {
                continue;
            }
            let sides = [Some(edge), self.edited.opposite(edge)];
            for half_edge in sides.into_iter().flatten() {
                // The cheapest question first.
                if self.keeps_short(half_edge, long)
                    && self.edited.may_collapse(half_edge).is_ok()
                    && self.keeps_shape(half_edge)
                {
                    let done = self.edited.collapse(half_edge);
                    count += usize::from(done.is_ok());
                    break;
                }
            }
        }
        count
    }

    /// Whether a collapse makes no edge too long.
    fn keeps_short(&self, half_edge: u32, long: T) -> bool {
        let [tail, head] = [self.edited.tail(half_edge), self.edited.head(half_edge)];
        let mut neighbours = self.edited.neighbours(tail);
        neighbours.all(|other| other == head || self.relative_distance(other, head) < long)
    }

    /// Whether a collapse makes no bad triangle.
    fn keeps_shape(&self, half_edge: u32) -> bool {
        let [tail, head] = [self.edited.tail(half_edge), self.edited.head(half_edge)];
        let changed = || self.ring(tail).filter(|corners| !corners.contains(&head));
        let moved = |corner| if corner == tail { head } else { corner };
        let after = self.shape(changed().map(|corners| corners.map(moved)));
        after.is_good() || after.is_as_good_as(self.shape(changed()))
    }

    /// Flips edges where that brings numbers of neighbours nearer to those of a regular mesh.
    pub(super) fn flip_to_valence(&mut self) {
        let vertices = 0..self.edited.vertex_count() as u32;
        let missing = vertices.map(|vertex| {
            if !self.edited.is_used(vertex) {
                return 0;
            }
            let ideal = if self.edited.is_border(vertex) { 4 } else { 6 };
            self.edited.valence(vertex) as i32 - ideal
        });
        let mut beyond = Vec::from_iter(missing);
        for edge in Vec::from_iter(self.edited.edges()) {
            let Some(corners) = self.corners_of_flip(edge) else {
                continue;
            };
            let change = [-1, -1, 1, 1];
            let squares = zip(corners, change).map(|(corner, change)| {
                let now = beyond[corner as usize];
                (now + change) * (now + change) - now * now
            });
            if squares.sum::<i32>() < 0 && self.flip(edge, corners) {
                for (corner, change) in zip(corners, change) {
                    beyond[corner as usize] += change;
                }
            }
        }
    }

    /// Flips edges whose opposite angles have a sum above π.
    pub(super) fn flip_to_delaunay(&mut self) {
        for edge in Vec::from_iter(self.edited.edges()) {
            let Some(corners) = self.corners_of_flip(edge) else {
                continue;
            };
            let [a, b, c, d] = corners;
            // Cosine and sine of the angle at an apex, times the lengths of its sides; right for flat triangles, too.
            let angle = |apex: u32| {
                let [from, to] = [a, b].map(|end| sub(self.at(end), self.at(apex)));
                [dot(from, to), norm(cross(from, to)), norm(from) * norm(to)]
            };
            let [[cos_c, sin_c, size_c], [cos_d, sin_d, size_d]] = [angle(c), angle(d)];
            let sine_of_sum = sin_c * cos_d + cos_c * sin_d;
            if sine_of_sum < -T::epsilon().sqrt() * size_c * size_d {
                self.flip(edge, corners);
            }
        }
    }

    /// The ends of an edge, and its apexes, if it may be flipped for all that is known about its lines.
    fn corners_of_flip(&self, edge: u32) -> Option<[u32; 4]> {
        let other = self.edited.opposite(edge)?;
        let [a, b] = [self.edited.tail(edge), self.edited.head(edge)];
        let [c, d] = [self.edited.apex(edge), self.edited.apex(other)];
        (!self.edited.is_kept(edge)).then_some([a, b, c, d])
    }

    /// Flips the edge (a, b) with the apexes c and d, if that is legal and leaves good triangles.
    fn flip(&mut self, edge: u32, [a, b, c, d]: [u32; 4]) -> bool {
        let after = self.shape([[d, c, a], [c, d, b]]);
        let is_fit = after.is_good() || after.is_as_good_as(self.shape([[a, b, c], [b, a, d]]));
        // Refused where c and d are neighbours.
        is_fit && self.edited.flip(edge).is_ok()
    }

    /// Moves every vertex towards the mean of its triangles' centroids, weighted by their areas over the square of the
    /// wanted length, or along its line.
    pub(super) fn smooth(&mut self) {
        for vertex in 0..self.edited.vertex_count() as u32 {
            if !self.edited.is_used(vertex) {
                continue;
            }
            match self.edited.freedom(vertex) {
                Freedom::Free => self.move_free(vertex),
                Freedom::OnLine(ends) => self.move_along(vertex, ends),
                Freedom::Fixed => {}
            }
        }
    }

    fn move_free(&mut self, vertex: u32) {
        let (mut sum, mut total) = ([T::zero(); 3], T::zero());
        let third = T::constant(1.0 / 3.0);
        for corners in self.ring(vertex) {
            let size: T = corners.map(|corner| self.size(corner)).into_iter().sum();
            let weight = norm(self.area_vector(corners)) * (size * size).reciprocal_or_zero();
            let middle = corners.map(|corner| self.at(corner));
            let middle = scale(third, middle.into_iter().fold([T::zero(); 3], add));
            sum = add(sum, scale(weight, sub(middle, self.at(vertex))));
            total += weight;
        }
        let step = scale(total.reciprocal_or_zero(), sum);
        if norm(step) < T::constant(SETTLED) * self.factor * self.size(vertex) {
            return;
        }
        let before = self.places[vertex as usize];
        // Along the surface: on a thin one, the mean is nearer to the other side.
        let normal = self.samples[vertex as usize].normal;
        let step = sub(step, scale(dot(step, normal), normal));
        let target = add(self.at(vertex), step);
        let place = self.ground.nearest(before, target);
        self.try_place(vertex, place);
    }

    /// Moves vertices whose triangles have an angle with a larger cosine than this one, in steps that make the smallest
    /// angle larger.
    pub(super) fn widen_angles(&mut self, cosine: T) {
        for vertex in 0..self.edited.vertex_count() as u32 {
            if !self.edited.is_used(vertex) || self.largest_cosine(vertex) <= cosine {
                continue;
            }
            match self.edited.freedom(vertex) {
                Freedom::Free => self.widen_angles_at(vertex),
                Freedom::OnLine(ends) => self.widen_angles_along(vertex, ends),
                Freedom::Fixed => {}
            }
        }
    }

    fn widen_angles_along(&mut self, vertex: u32, ends: [u32; 2]) {
        let fifth = T::constant(0.2);
        for end in ends {
            let (start, spot) = (self.places[vertex as usize], self.spots[vertex as usize]);
            let before = self.largest_cosine(vertex);
            let way = sub(self.at(end), self.at(vertex));
            let moved = self.ground.along(spot, way, fifth * norm(way));
            if self.try_place(vertex, self.ground.place(moved)) {
                if self.largest_cosine(vertex) < before {
                    self.spots[vertex as usize] = moved;
                } else {
                    self.set_place(vertex, start);
                }
            }
        }
    }

    fn widen_angles_at(&mut self, vertex: u32) {
        let areas = self.ring(vertex).map(|corners| self.area_vector(corners));
        let axes = tangent_frame(normalise(areas.fold([T::zero(); 3], add)));
        let mut step = T::constant(0.2) * self.factor * self.size(vertex);
        for _ in 0..4 {
            let (start, here) = (self.places[vertex as usize], self.at(vertex));
            let (mut best, mut least) = (start, self.largest_cosine(vertex));
            for (x, y) in COMPASS {
                let way = add(
                    scale(T::constant(x), axes[0]),
                    scale(T::constant(y), axes[1]),
                );
                let place = self.ground.nearest(start, add(here, scale(step, way)));
                if self.try_place(vertex, place) {
                    let cosine = self.largest_cosine(vertex);
                    if cosine < least {
                        least = cosine;
                        best = place;
                    }
                    self.set_place(vertex, start);
                }
            }
            self.set_place(vertex, best);
            if best == start {
                step /= T::constant(2.0);
            }
        }
    }

    /// The triangles at a vertex.
    fn ring(&self, vertex: u32) -> impl Iterator<Item = [u32; 3]> {
        let around = self.edited.around(vertex);
        around.map(|half_edge| self.edited.corners(half_edge))
    }

    /// The cosine of the smallest angle of the triangles at a vertex.
    fn largest_cosine(&self, vertex: u32) -> T {
        let cosines = self.ring(vertex).map(|corners| self.cosine(corners));
        cosines.fold(-T::one(), T::max)
    }

    /// The cosine of the smallest angle of a triangle.
    fn cosine(&self, corners: [u32; 3]) -> T {
        let [a, b, c] = corners.map(|corner| self.at(corner));
        let edges = [sub(b, a), sub(c, b), sub(a, c)];
        let lengths = edges.map(norm);
        let [ab, bc, ca] = lengths;
        // Opposite to the shortest edge.
        let [one, other] = match (ab <= bc, bc <= ca, ca <= ab) {
            (true, _, false) => [1, 2],
            (false, true, _) => [2, 0],
            _ => [0, 1],
        };
        let over = (lengths[one] * lengths[other]).reciprocal_or_zero();
        -dot(edges[one], edges[other]) * over
    }

    fn move_along(&mut self, vertex: u32, ends: [u32; 2]) {
        let ways = ends.map(|end| sub(self.at(end), self.at(vertex)));
        let lengths = ends.map(|end| self.relative_distance(vertex, end));
        let longer = usize::from(lengths[1] > lengths[0]);
        let [shorter_length, longer_length] = [lengths[1 - longer], lengths[longer]];
        let part = (longer_length - shorter_length)
            / (T::constant(4.0) * longer_length).max(T::min_positive_value());
        let distance = part * norm(ways[longer]);
        let spot = self
            .ground
            .along(self.spots[vertex as usize], ways[longer], distance);
        if self.try_place(vertex, self.ground.place(spot)) {
            self.spots[vertex as usize] = spot;
        }
    }

    /// The least cosine between the normal of a triangle and those of the input at its corners.
    fn outward(&self, corners: [u32; 3]) -> T {
        let normal = normalise(self.area_vector(corners));
        let cosines = corners.map(|corner| dot(normal, self.samples[corner as usize].normal));
        cosines[0].min(cosines[1]).min(cosines[2])
    }

    /// The worst of these triangles.
    fn shape(&self, triangles: impl IntoIterator<Item = [u32; 3]>) -> WorstTriangle<T> {
        let mut worst = WorstTriangle {
            outward: T::one(),
            cosine: -T::one(),
        };
        for corners in triangles {
            worst.outward = worst.outward.min(self.outward(corners));
            worst.cosine = worst.cosine.max(self.cosine(corners));
        }
        worst
    }

    /// Moves a vertex unless that makes a bad triangle.
    fn try_place(&mut self, vertex: u32, place: MeshPoint<T>) -> bool {
        let index = vertex as usize;
        let before = (self.places[index], self.samples[index]);
        self.set_place(vertex, place);
        let moved = (self.places[index], self.samples[index]);
        let shape = self.shape(self.ring(vertex));
        if shape.is_good() {
            return true;
        }
        (self.places[index], self.samples[index]) = before;
        let fits = shape.is_as_good_as(self.shape(self.ring(vertex)));
        if fits {
            (self.places[index], self.samples[index]) = moved;
        }
        fits
    }
}

/// The point of the smooth surface beside a place, or of the flat triangle, if nothing is known about the smooth one.
fn trusted<T: Real>(
    smooth: &SmoothSurface<T>,
    place: MeshPoint<T>,
    shift: Vec3<T>,
) -> SmoothPoint<T> {
    let point = smooth.beside(place, shift);
    if point.position_error < T::constant(DOUBTFUL) * smooth.longest_edge(place.triangle) {
        point
    } else {
        smooth.flat_point(place, shift)
    }
}
