//! Fields at the vertices of a smooth surface, between them.

use super::{DOUBTED, SmoothSurface};
use crate::element::{Execution, Ragged, SlotKernel, Slots};
use crate::face_tree::MeshPoint;
use crate::fit::{
    NormalEquations, Points, TOGETHER, coefficient_count, evaluate, exponential, graph_at,
};
use crate::lane::{Lane, Several, WIDTH};
use crate::laplacian::LocalPolynomial;
use crate::real::Real;
use crate::vec3::{add, sub};
use alloc::vec;
use alloc::vec::Vec;
use core::iter::zip;

/// Fields at the vertices of a [`SmoothSurface`], as smooth as the surface.
///
/// Around each vertex a polynomial of the degree of the surface is fitted to a field, over the same neighbours with the
/// same weights, and over each triangle those of the corners are averaged, as positions are. Fields have the values that
/// were given at vertices, and errors of order d + 1 in the edge length.
#[derive(Clone, Debug)]
pub struct SmoothFields<'a, T: Real> {
    surface: &'a SmoothSurface<T>,
    /// The fields, one after the other.
    values: Vec<T>,
    /// Numbers of each vertex: of each field the coefficients, and the largest difference of the polynomial from the
    /// values around the vertex.
    numbers: Vec<T>,
    offsets: Vec<usize>,
}

/// The value of a field at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FieldPoint<T> {
    /// The value.
    pub value: T,
    /// An error bar, 0 at vertices: four times how far the polynomials of the corners are from each other at the point,
    /// or from the values around their own vertex, less the nearer the point is to the corner. Infinite without a fit,
    /// where values are interpolated linearly.
    pub error: T,
}

impl<T: Real> SmoothSurface<T> {
    /// Fits polynomials to fields at the vertices.
    ///
    /// # Panics
    /// If a field has not one value for each vertex.
    pub fn fields(&self, execution: &impl Execution, fields: &[&[T]]) -> SmoothFields<'_, T> {
        let mesh = self.fitted();
        for field in fields {
            assert_eq!(field.len(), self.mesh.vertex_count(), "values at vertices");
        }
        let originals = (0..mesh.vertex_count()).map(|vertex| self.original(vertex) as usize);
        let originals = Vec::from_iter(originals);
        let columns = fields.iter().flat_map(|field| {
            let copies = originals.iter();
            copies.map(|&original| field[original])
        });
        let values = Vec::from_iter(columns);
        let mut offsets = vec![0];
        let mut end = 0;
        for vertex in 0..mesh.vertex_count() {
            if let Some(polynomial) = self.workspace.memory().polynomial(vertex) {
                end += fields.len() * stride(polynomial.degree());
            }
            offsets.push(end);
        }
        let mut numbers = vec![T::zero(); end];
        let kernel = FieldFits {
            surface: self,
            values: &values,
        };
        let slots = Ragged::new(&mut numbers, &offsets);
        execution.run(&mut Vec::new(), slots, &kernel);
        SmoothFields {
            surface: self,
            values,
            numbers,
            offsets,
        }
    }
}

impl<T: Real> SmoothFields<'_, T> {
    /// A field, by its number, at a place of the mesh.
    ///
    /// # Panics
    /// If there is no such field or triangle.
    pub fn at(&self, field: usize, place: MeshPoint<T>) -> FieldPoint<T> {
        let surface = self.surface;
        let count = surface.fitted().vertex_count();
        let values = &self.values[field * count..][..count];
        let corners = surface.corners(place, [T::zero(); 3]);
        let Some(corners) = corners else {
            let vertices = surface.fitted().triangles()[place.triangle];
            let terms = zip(vertices, place.barycentric);
            return FieldPoint {
                value: terms.map(|(k, weight)| weight * values[k as usize]).sum(),
                error: T::infinity(),
            };
        };
        let first = surface.position(surface.mesh.triangles()[place.triangle][0]);
        let position = sub(surface.at(place).position, first);
        let fits = corners.map(|corner| {
            let polynomial = surface.workspace.memory().polynomial(corner.vertex);
            let Some(polynomial) = polynomial.filter(|_| corner.weight > T::zero()) else {
                return (T::zero(), T::zero(), T::zero());
            };
            let stride = stride(polynomial.degree());
            let numbers = &self.numbers[self.offsets[corner.vertex] + field * stride..][..stride];
            let vertex = surface.original(corner.vertex);
            let [x, y] = polynomial.place(sub(add(position, first), surface.position(vertex)));
            let (rise, _) = graph_at(polynomial.degree(), numbers, x, y);
            let misfit = corner.away * corner.away * numbers[stride - 1];
            (corner.weight, values[corner.vertex] + rise, misfit)
        });
        let value: T = fits.iter().map(|&(weight, value, _)| weight * value).sum();
        let blended = fits.iter().filter(|(weight, ..)| *weight > T::zero());
        let apart = blended.map(|&(_, other, _)| (other - value).abs());
        let misfit = fits
            .iter()
            .map(|&(weight, _, misfit)| weight * misfit)
            .sum();
        FieldPoint {
            value,
            error: T::constant(DOUBTED) * apart.fold(misfit, T::max),
        }
    }

    /// As [`Self::at`], at many places.
    pub fn all_at(
        &self,
        execution: &impl Execution,
        field: usize,
        places: &[MeshPoint<T>],
    ) -> Vec<FieldPoint<T>> {
        let mut points = vec![FieldPoint::default(); places.len()];
        execution.map(&mut points[..], |index, point| {
            *point = self.at(field, places[index]);
        });
        points
    }
}

/// How many numbers a field has at a vertex.
const fn stride(degree: usize) -> usize {
    coefficient_count(degree) + 1
}

/// The fits of fields around all vertices.
struct FieldFits<'a, T: Real> {
    surface: &'a SmoothSurface<T>,
    values: &'a [T],
}

/// Memory to fit fields around several vertices at once, padded with neighbours of no weight.
#[derive(Clone, Debug, Default)]
struct FieldScratch<T> {
    x: Vec<Several<T>>,
    y: Vec<Several<T>>,
    weights: Vec<Several<T>>,
    rises: Vec<Several<T>>,
    coefficients: Vec<Several<T>>,
    fitted: Vec<Several<T>>,
    equations: NormalEquations<T>,
}

/// A vertex with its fit and its numbers.
type Fitted<'a, T> = (usize, LocalPolynomial<'a, T>, &'a mut [T]);

impl<'a, T: Real> SlotKernel<FieldScratch<T>, Ragged<'a, T>> for FieldFits<'_, T> {
    #[inline(always)]
    fn set(&self, scratch: &mut FieldScratch<T>, start: usize, slots: Ragged<'a, T>) {
        let memory = self.surface.workspace.memory();
        let slots = (start..).zip(slots.into_slots());
        let fits = slots
            .filter_map(|(vertex, numbers)| Some((vertex, memory.polynomial(vertex)?, numbers)));
        // Blocks have one degree.
        let mut fits = fits.peekable();
        let mut block: Vec<Fitted<'_, T>> = Vec::with_capacity(WIDTH);
        while let Some(next) = fits.next() {
            let degree = next.1.degree();
            block.push(next);
            let goes_on = fits
                .peek()
                .is_some_and(|(_, other, _)| other.degree() == degree);
            if block.len() >= WIDTH || !goes_on {
                self.fit(scratch, degree, &mut block);
                block.clear();
            }
        }
    }
}

impl<T: Real> FieldFits<'_, T> {
    #[inline(always)]
    fn fit(&self, scratch: &mut FieldScratch<T>, degree: usize, block: &mut [Fitted<'_, T>]) {
        let memory = self.surface.workspace.memory();
        let neighbours = |vertex: usize| memory.row(vertex).0;
        let rows = block.iter().map(|(vertex, ..)| neighbours(*vertex).len());
        let rows = rows.max().unwrap_or(0).next_multiple_of(TOGETHER);
        let FieldScratch {
            x,
            y,
            weights,
            rises,
            coefficients,
            fitted,
            equations,
        } = scratch;
        for array in [&mut *x, &mut *y, &mut *weights, &mut *rises] {
            array.clear();
            array.resize(rows, Several::zero());
        }
        coefficients.resize(coefficient_count(degree), Several::zero());
        // As in the fits of the surface: squares of exp(−β d²).
        let steepness = -self.surface.jet.sharpness;
        for (lane, (vertex, polynomial, _)) in block.iter().enumerate() {
            let here = self.position(*vertex);
            for (row, &other) in neighbours(*vertex).iter().enumerate() {
                let offset = sub(self.position(other as usize), here);
                let [along, across] = polynomial.place(offset);
                (x[row].0[lane], y[row].0[lane]) = (along, across);
                let root = exponential(steepness * polynomial.squared_distance(offset));
                weights[row].0[lane] = root * root;
            }
        }
        let points = Points { x, y, weights };
        equations.set(degree, points);
        let count = self.surface.fitted().vertex_count();
        for (field, values) in self.values.chunks_exact(count).enumerate() {
            for (lane, (vertex, ..)) in block.iter().enumerate() {
                for (row, &other) in neighbours(*vertex).iter().enumerate() {
                    rises[row].0[lane] = values[other as usize] - values[*vertex];
                }
            }
            equations.solve(points, rises, &[], coefficients, 1);
            evaluate(degree, points, coefficients, fitted);
            for (lane, (vertex, _, numbers)) in block.iter_mut().enumerate() {
                let numbers = &mut numbers[field * stride(degree)..][..stride(degree)];
                for (number, coefficient) in zip(&mut *numbers, &*coefficients) {
                    *number = coefficient.0[lane];
                }
                let ring = self.surface.fitted().one_ring(*vertex);
                let rows = neighbours(*vertex).iter().enumerate();
                let around = rows.filter(|(_, other)| ring.contains(other));
                let misfits =
                    around.map(|(row, _)| (fitted[row].0[lane] - rises[row].0[lane]).abs());
                numbers[stride(degree) - 1] = misfits.fold(T::zero(), T::max);
            }
        }
    }

    fn position(&self, vertex: usize) -> [T; 3] {
        self.surface.position(self.surface.original(vertex))
    }
}
