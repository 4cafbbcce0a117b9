//! The fits of one degree around several vertices at a time.

use crate::fit::{
    Graph, HIGHEST_DEGREE, Inversion, MONOMIALS, NormalEquations, Points, TOGETHER,
    coefficient_count, evaluate, exponential, graph_at,
};
use crate::lane::{Lane, Several};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, cross, dot, norm, normalise, scale, sub};
use alloc::vec::Vec;
use core::array;
use core::iter::zip;

/// Degree of the fit that determines the inversion, if the final degree is not lower.
const STEP_DEGREE: usize = 4;

/// Least factor by which an inversion may divide offsets: it is 1/2 where the normals of a sphere turn by 90° and the
/// inversion makes it a plane.
const NEAREST: f64 = 0.4;

/// Polynomials that are fitted.
#[derive(Clone, Copy)]
pub(super) struct Polynomials<T> {
    pub(super) degree: usize,
    /// See [`Jet::sharpness`](super::Jet::sharpness).
    pub(super) sharpness: T,
    pub(super) refined: bool,
}

/// Memory to fit several vertices at once, padded with neighbours at the vertex itself, whose
/// monomials are zero.
#[derive(Clone, Debug, Default)]
pub(super) struct Block<T> {
    /// Neighbours' positions relative to the vertex in units of the radius, in space, in the frame of the
    /// fit, and after the inversion.
    differences: [Vec<Several<T>>; 3],
    offsets: [Vec<Several<T>>; 3],
    places: [Vec<Several<T>>; 3],
    /// Squared distances, in units of the radius, and weights.
    distances: Vec<Several<T>>,
    weights: Vec<Several<T>>,
    coefficients: Vec<Several<T>>,
    /// Coefficients of functionals, and of fits of other columns.
    others: Vec<Several<T>>,
    /// Values at the neighbours.
    values: Vec<Several<T>>,
    scaled: Vec<Several<T>>,
    errors: Vec<Several<T>>,
    equations: NormalEquations<T>,
}

/// Vertices of a block: the normal of the frame, which fits improve, and the spacing.
#[derive(Clone, Copy)]
pub(super) struct Lanes<T> {
    pub(super) normals: Vec3<Several<T>>,
    pub(super) along: Vec3<Several<T>>,
    pub(super) aspects: Several<T>,
}

/// Results at the vertices of a block.
pub(super) struct Found<T> {
    pub(super) normal: Vec3<Several<T>>,
    pub(super) mean: Several<T>,
    pub(super) gaussian: Several<T>,
    /// The direction of the larger principal curvature.
    pub(super) direction: Vec3<Several<T>>,
    /// The gradients of H and K on the fitted surface.
    pub(super) gradients: [Vec3<Several<T>>; 2],
    /// Δ_S H of the fitted surface.
    pub(super) laplacian_of_mean: Several<T>,
    /// The squared slope of the surface in its frame.
    pub(super) slope: Several<T>,
    /// The least distance of a column from the columns before it, squared, in units of the length that it
    /// would have if the directions of neighbours were spread evenly.
    pub(super) spread: Several<T>,
    /// The axes of the polynomial: two tangent vectors, and the normal.
    axes: [Vec3<Several<T>>; 3],
    inversion: Inversion<Several<T>>,
    over_radius: Several<T>,
    aspects: Several<T>,
}

impl<T: Real> Block<T> {
    /// Resizes for fits with `rows` neighbours, none of which is set, and this degree.
    #[inline(always)]
    pub(super) fn clear(&mut self, rows: usize, degree: usize) {
        let rows = rows.next_multiple_of(TOGETHER);
        for differences in &mut self.differences {
            differences.clear();
            differences.resize(rows, Several::zero());
        }
        let arrays = self.offsets.iter_mut().chain(&mut self.places);
        for array in arrays {
            array.resize(rows, Several::zero());
        }
        for array in [&mut self.distances, &mut self.weights, &mut self.errors] {
            array.resize(rows, Several::zero());
        }
        let count = coefficient_count(degree.max(STEP_DEGREE));
        for array in [&mut self.coefficients, &mut self.others, &mut self.scaled] {
            array.resize(count, Several::zero());
        }
    }

    #[inline(always)]
    pub(super) fn set_differences(
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

    /// Fits polynomials: of degree 2 for the normal and the curvature, then after a first inversion for the
    /// best one, then of the final degree.
    #[inline(always)]
    pub(super) fn fit(&mut self, shape: Polynomials<T>, lanes: Lanes<T>) -> Found<T> {
        let (over_radius, outermost) = self.weigh(shape, &lanes);
        let uneven = Several::literal(1.0).less(lanes.aspects);
        let first: Vec3<Several<T>> =
            array::from_fn(|k| Several::select(uneven, lanes.along[k], outermost[k]));
        let mut normal = lanes.normals;
        let mut frame = frame_towards(first, normal);
        let mut inversion = Inversion(Several::zero());
        let mut curvature = Several::zero();
        let stages = [2, STEP_DEGREE.min(shape.degree), shape.degree];
        for (stage, degree) in stages.into_iter().enumerate() {
            if stage == 0 {
                self.turn(frame, normal);
            }
            if stage > 0 {
                self.invert(inversion);
            }
            let Self {
                offsets,
                places,
                weights,
                coefficients,
                equations,
                ..
            } = self;
            let [x, y, z] = if stage > 0 { places } else { offsets };
            let points = Points { x, y, weights };
            equations.set(degree, points);
            let refinements = usize::from(stage == 2 && shape.refined);
            equations.solve(points, z, &[], coefficients, refinements);
            match stage {
                0 => {
                    let graph = Graph::of_coefficients(coefficients);
                    let uprightness = graph.uprightness();
                    let mean = graph.mean(uprightness);
                    // Across rows, few neighbours have to determine what the inversion leaves: the curvature that
                    // leaves the least heights of neighbours, which lie farther across than along by the aspect.
                    let across = graph.along_y(uprightness);
                    let over = lanes.aspects.reciprocal_or_zero();
                    let along = (over * over) * (over * over);
                    let share = along * (Several::literal(1.0) + along).reciprocal_or_zero();
                    let two = Several::literal(2.0);
                    let curved = across + share * two * (mean - across);
                    let curved = Several::select(uneven, curved, mean);
                    let is_more = (mean * mean).less(curved * curved);
                    curvature = Several::select(is_more, curved, mean);
                    normal = tilted(normal, frame, graph.first);
                    frame = frame_towards(first, normal);
                    let quarter = Inversion(Several::literal(-0.25) * curvature);
                    self.turn(frame, normal);
                    inversion = self.unless_far(quarter, inversion);
                }
                1 => {
                    let improved = self.improve(degree, inversion, curvature);
                    inversion = self.unless_far(improved, inversion);
                }
                _ => {}
            }
        }
        let bent = inversion.at_vertex(&self.coefficients[..coefficient_count(shape.degree)]);
        let graph = Graph::of_coefficients(&self.coefficients);
        let functional = graph.laplacian(graph.uprightness());
        self.others.fill(Several::zero());
        self.others[..functional.len()].copy_from_slice(&functional);
        let axes = [frame[0], frame[1], normal];
        // Inversions leave principal directions as they are.
        let [direction, _] = graph.principal(axes).directions;
        let squared = over_radius * over_radius;
        let cubed = squared * over_radius;
        let [along_x, along_y] = graph.gradient(axes);
        let gradient =
            |[by_x, by_y]: [Several<T>; 2]| add(scale(by_x, along_x), scale(by_y, along_y));
        let [of_mean, of_gaussian] = bent.slopes.map(gradient);
        let [p, q] = graph.first;
        Found {
            normal: tilted(normal, frame, graph.first),
            mean: bent.mean * over_radius,
            gaussian: bent.gaussian * squared,
            direction,
            gradients: [scale(squared, of_mean), scale(cubed, of_gaussian)],
            laplacian_of_mean: bent.laplacian_of_mean * cubed,
            slope: p * p + q * q,
            spread: self.spread(shape.degree, lanes.aspects),
            axes,
            inversion,
            over_radius,
            aspects: lanes.aspects,
        }
    }

    /// Sets the numbers of a [`LocalPolynomial`], after [`Self::fit`].
    #[inline(never)]
    pub(super) fn store(&self, degree: usize, found: &Found<T>, lane: usize, numbers: &mut [T]) {
        let [first, _, normal] = found.axes;
        let head = first.iter().chain(&normal);
        let head = head.chain([&found.over_radius, &found.inversion.0, &found.aspects]);
        let all = head.chain(&self.coefficients[..coefficient_count(degree)]);
        for (number, entries) in numbers.iter_mut().zip(all) {
            *number = entries.0[lane];
        }
    }

    /// Sets distances and weights, and scales differences to units of the radius. Returns 1 over the radius,
    /// and the neighbour that lies farthest to the side.
    #[inline(always)]
    fn weigh(&mut self, shape: Polynomials<T>, lanes: &Lanes<T>) -> (Several<T>, Vec3<Several<T>>) {
        let Self {
            differences: [x, y, z],
            distances,
            weights,
            ..
        } = self;
        let rows = x.len();
        let (y, z) = (&mut y[..rows], &mut z[..rows]);
        let over_aspect = lanes.aspects.reciprocal_or_zero();
        let stretch = lanes.aspects - over_aspect;
        let [mut farthest, mut widest] = [Several::zero(); 2];
        let mut outermost = [Several::zero(); 3];
        for row in 0..rows {
            let difference = [x[row], y[row], z[row]];
            let squared = dot(difference, difference);
            let height = dot(difference, lanes.normals);
            let along = dot(difference, lanes.along);
            let distance = squared * over_aspect + along * along * stretch;
            distances[row] = distance;
            farthest = Several::select(farthest.less(distance), distance, farthest);
            let sideways = squared - height * height;
            let wider = widest.less(sideways);
            widest = Several::select(wider, sideways, widest);
            for (outermost, coordinate) in outermost.iter_mut().zip(difference) {
                *outermost = Several::select(wider, coordinate, *outermost);
            }
        }
        let over_radius = farthest.sqrt().reciprocal_or_zero();
        let over_square = over_radius * over_radius;
        let steepness = Several::splat(-shape.sharpness);
        for row in 0..rows {
            distances[row] = distances[row] * over_square;
            (x[row], y[row], z[row]) = (
                x[row] * over_radius,
                y[row] * over_radius,
                z[row] * over_radius,
            );
            weights[row] = steepness * distances[row];
        }
        // In a loop of its own, where the processor computes several of these long chains at a time.
        for weight in weights.iter_mut() {
            let root = exponential(*weight);
            *weight = root * root;
        }
        (over_radius, scale(over_radius, outermost))
    }

    /// Sets offsets in a frame.
    #[inline(always)]
    fn turn(&mut self, frame: [Vec3<Several<T>>; 2], normal: Vec3<Several<T>>) {
        let ([x, y, z], [a, b, c]) = (&self.differences, &mut self.offsets);
        for row in 0..x.len() {
            let local = [x[row], y[row], z[row]];
            a[row] = dot(local, frame[0]);
            b[row] = dot(local, frame[1]);
            c[row] = dot(local, normal);
        }
    }

    /// Sets the places of the neighbours after an inversion.
    #[inline(always)]
    fn invert(&mut self, inversion: Inversion<Several<T>>) {
        let ([x, y, z], [a, b, c]) = (&self.offsets, &mut self.places);
        for row in 0..x.len() {
            [a[row], b[row], c[row]] = inversion.image([x[row], y[row], z[row]]);
        }
    }

    /// An inversion, or another one where this maps a neighbour too far away: on coarse meshes neighbours may lie
    /// near the offset that is mapped to infinity.
    #[inline(always)]
    fn unless_far(
        &self,
        inversion: Inversion<Several<T>>,
        other: Inversion<Several<T>>,
    ) -> Inversion<Several<T>> {
        let [x, y, z] = &self.offsets;
        let mut least = Several::literal(1.0);
        for (&x, (&y, &z)) in zip(x, zip(y, z)) {
            let scale = inversion.scale_at([x, y, z]);
            least = Several::select(scale.less(least), scale, least);
        }
        let is_far = least.less(Several::literal(NEAREST));
        Inversion(Several::select(is_far, other.0, inversion.0))
    }

    /// One step from an inversion to that with the least residual of the fit: with the residual e = z − p
    /// of the polynomial p, the derivative of e by β is `z² − x² − y² − 2 z (x p_x + y p_y)`, because
    /// inversions compose. Bounded by no inversion, and that which flattens a sphere of this curvature: steps
    /// beyond it would follow noise.
    #[inline(always)]
    fn improve(
        &mut self,
        degree: usize,
        inversion: Inversion<Several<T>>,
        curvature: Several<T>,
    ) -> Inversion<Several<T>> {
        let Self {
            places: [x, y, z],
            weights,
            coefficients,
            scaled,
            values,
            errors,
            equations,
            ..
        } = self;
        let points = Points { x, y, weights };
        let two = Several::literal(2.0);
        evaluate(degree, points, coefficients, values);
        for ((error, &z), &value) in errors.iter_mut().zip(&*z).zip(&*values) {
            *error = z - value;
        }
        // x p_x + y p_y: each monomial times its degree.
        for ((scaled, &c), (d, _)) in scaled.iter_mut().zip(&*coefficients).zip(MONOMIALS) {
            *scaled = Several::literal(d as f64) * c;
        }
        evaluate(degree, points, scaled, values);
        // Without − x² − y², of which polynomials leave nothing.
        let [mut whole, mut products, mut squares, mut size] = [Several::zero(); 4];
        for ((value, &error), (&z, &weight)) in
            zip(&mut values[..], &*errors).zip(zip(&*z, &*weights))
        {
            let slope = z * (z - two * *value);
            whole = whole + weight * slope * slope;
            products = products + weight * slope * error;
            squares = squares + weight * error * error;
            size = size + weight * z * z;
            *value = slope;
        }
        // With few neighbours, what is left of the derivative may be rounding, and the step must not follow it.
        let rounding = Several::splat(T::epsilon().sqrt()) * whole;
        let left = equations.left_of(points, values);
        let left = Several::select(left.less(rounding), rounding, left);
        let over = left.reciprocal_or_zero();
        // Where the fit leaves rounding only, one inversion is as good as another.
        let digits = T::constant(1e3) * T::epsilon();
        let is_exact = squares.less(Several::splat(digits * digits) * size);
        let products = Several::select(is_exact, Several::zero(), products);
        let found = inversion.0 - products * over;
        let full = Several::literal(-0.5) * curvature;
        let zero = Several::zero();
        let negative = full.less(zero);
        let least = Several::select(negative, full, zero);
        let most = Several::select(negative, zero, full);
        let found = Several::select(found.less(least), least, found);
        Inversion(Several::select(most.less(found), most, found))
    }

    /// See [`Found::spread`].
    #[inline(always)]
    fn spread(&self, degree: usize, aspects: Several<T>) -> Several<T> {
        // Σ w q^d of each degree.
        let mut sums = [Several::<T>::zero(); 1 + HIGHEST_DEGREE];
        for (&weight, &distance) in self.weights.iter().zip(&self.distances) {
            let mut term = weight;
            for sum in &mut sums[1..=degree] {
                term = term * distance;
                *sum = *sum + term;
            }
        }
        let over_aspect = aspects.reciprocal_or_zero();
        let mut least = Several::literal(f64::MAX);
        let monomials = self
            .equations
            .pivots()
            .iter()
            .zip(MONOMIALS)
            .zip(EVEN_SPREAD);
        for ((&pivot, (degree, power)), even_spread) in monomials {
            let along = degree - power;
            let mut even_spread = sums[degree] * Several::literal(even_spread);
            let factor = if power > along { aspects } else { over_aspect };
            for _ in 0..power.abs_diff(along) {
                even_spread = even_spread * factor;
            }
            let spread = pivot * even_spread.reciprocal_or_zero();
            least = Several::select(spread.less(least), spread, least);
        }
        least
    }

    /// The rows of Δ_S, after [`Self::fit`].
    #[inline(always)]
    pub(super) fn rows(&mut self, shape: Polynomials<T>, found: &Found<T>) -> &[Several<T>] {
        let Self {
            places: [x, y, _],
            weights,
            others,
            scaled,
            values,
            equations,
            ..
        } = self;
        let points = Points { x, y, weights };
        equations.solve(points, &[], others, scaled, usize::from(shape.refined));
        evaluate(shape.degree, points, scaled, values);
        let over_square = found.over_radius * found.over_radius;
        for (entry, &weight) in values.iter_mut().zip(&*weights) {
            *entry = *entry * (weight * over_square);
        }
        values
    }

    /// The result of the rows, after [`Self::rows`], for H of the fitted surfaces at all neighbours, of polynomials
    /// without the terms of the highest degree: these follow the neighbours, and the rows give the same for the terms
    /// that they determine.
    #[inline(always)]
    pub(super) fn rows_of_mean(&self, degree: usize, found: &Found<T>) -> Several<T> {
        let Self {
            places: [x, y, _],
            coefficients,
            values: rows,
            ..
        } = self;
        let steady = degree.min(STEP_DEGREE.max(degree - 1));
        let [mut sum, mut total] = [Several::zero(); 2];
        for row in 0..x.len() {
            let (height, graph) = graph_at(steady, coefficients, x[row], y[row]);
            let image = [x[row], y[row], height];
            let [mean, _] = found.inversion.curvatures_at(image, &graph);
            sum = sum + rows[row] * mean;
            total = total + rows[row];
        }
        sum * found.over_radius - total * found.mean
    }

    /// H and K of the fitted surfaces at the first `near` neighbours.
    #[inline(always)]
    pub(super) fn curvatures(
        &mut self,
        degree: usize,
        near: usize,
        found: &Found<T>,
    ) -> [&[Several<T>]; 2] {
        let Self {
            places: [x, y, _],
            coefficients,
            errors: means,
            distances: gaussians,
            ..
        } = self;
        for row in 0..near.min(x.len()) {
            let (height, graph) = graph_at(degree, coefficients, x[row], y[row]);
            let image = [x[row], y[row], height];
            let [mean, gaussian] = found.inversion.curvatures_at(image, &graph);
            means[row] = mean * found.over_radius;
            gaussians[row] = gaussian * (found.over_radius * found.over_radius);
        }
        [means, gaussians]
    }
}

/// Means of cos^2a sin^2b over all directions, `(2a − 1)!! (2b − 1)!!/(2^d d!)`, of the monomials x^a y^b of
/// degree d: of their squares over points that lie evenly around the vertex.
const EVEN_SPREAD: [f64; MONOMIALS.len()] = {
    let mut spread = [1.0; MONOMIALS.len()];
    let mut place = 0;
    while place < spread.len() {
        let (degree, power) = MONOMIALS[place];
        let mut k = 0;
        while k < degree {
            let odd = if k < power { k } else { k - power };
            spread[place] *= (2 * odd + 1) as f64 / (2 * k + 2) as f64;
            k += 1;
        }
        place += 1;
    }
    spread
};

/// The normal of a graph in a frame.
#[inline(always)]
fn tilted<T: Real>(
    normal: Vec3<Several<T>>,
    frame: [Vec3<Several<T>>; 2],
    [p, q]: [Several<T>; 2],
) -> Vec3<Several<T>> {
    normalise(sub(sub(normal, scale(p, frame[0])), scale(q, frame[1])))
}

/// Two unit vectors that form a right-handed frame with a unit vector `normal`, the first one
/// towards a point to the side of it; zeros if the point lies along the normal. Polynomials of a
/// degree are the same in every frame, but the condition of a fit is not: with a frame along the
/// coordinate axes, the choice of neighbours would depend on the orientation of the surface.
#[inline(always)]
fn frame_towards<T: Real>(
    point: Vec3<Several<T>>,
    normal: Vec3<Several<T>>,
) -> [Vec3<Several<T>>; 2] {
    let sideways = sub(point, scale(dot(point, normal), normal));
    let first = scale(norm(sideways).reciprocal_or_zero(), sideways);
    [first, cross(normal, first)]
}
