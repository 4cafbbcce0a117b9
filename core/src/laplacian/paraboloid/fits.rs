//! The fits around all vertices, several vertices at a time.

use super::{AMPLIFIED, COEFFICIENTS};
use crate::element::{SlotKernel, Slots};
use crate::fit::{Graph, LeastSquares};
use crate::lane::{Lane, Several, WIDTH};
use crate::laplacian::{Curvature, RaggedRowSlots};
use crate::neighbourhood::Neighbourhood;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, dot, normalise, scale, sub, tangent_frame};
use alloc::vec::Vec;
use core::array;

/// Largest number of fits at one vertex. Each fit reduces the tilt by a factor of (edge length
/// times curvature)², so that few fits are needed unless the mesh is too coarse for the surface.
const MOST_FITS: usize = 12;

/// The fits around all vertices.
pub(super) struct Fits<'a, T> {
    pub(super) guarded: bool,
    pub(super) surface: Surface<'a, T>,
}

/// Output of a fit: the curvature, with the initial normal, and a row.
type FitSlots<'a, T> = (&'a mut [Curvature<T>], RaggedRowSlots<'a, T>);

/// Memory for fits of one thread.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch<T> {
    search: Neighbourhood<T>,
    block: Block<T>,
}

/// Memory to fit several vertices at once, padded with neighbours at the vertex itself, of which
/// every monomial is zero.
#[derive(Clone, Debug, Default)]
struct Block<T> {
    /// Neighbours' positions relative to the vertex, in units of the radius, the distance of the
    /// farthest.
    offsets: Vec<Vec3<Several<T>>>,
    problem: LeastSquares<T>,
}

/// Paraboloids that were fitted: the axes along x, y and the heights, their coefficients a, b, c, d, e in
/// units of the radius, and the normals that follow.
struct Fitted<T> {
    axes: [Vec3<Several<T>>; 3],
    coefficients: [Several<T>; COEFFICIENTS],
    normal: Vec3<Several<T>>,
    /// Whether the neighbours determine each.
    determined: [bool; WIDTH],
}

/// A vertex that is fitted.
struct Vertex<'a, T> {
    number: u32,
    /// Whether its one-ring has too few neighbours.
    narrow: bool,
    curvature: &'a mut Curvature<T>,
    length: &'a mut u32,
    columns: &'a mut [u32],
    row: &'a mut [T],
}

impl<'a, T: Real> SlotKernel<Scratch<T>, FitSlots<'a, T>> for Fits<'_, T> {
    #[inline(always)]
    fn set(&self, scratch: &mut Scratch<T>, start: usize, slots: FitSlots<'a, T>) {
        let Scratch { search, block } = scratch;
        let mut slots = (start..).zip(slots.into_slots());
        let mut vertices: [Option<Vertex<'_, T>>; WIDTH] = [const { None }; WIDTH];
        loop {
            for vertex in &mut vertices {
                let slot = slots.next();
                *vertex = slot.map(|(number, (curvature, (length, (columns, row))))| Vertex {
                    number: number as u32,
                    narrow: self.surface.mesh().valence(number) < COEFFICIENTS,
                    curvature,
                    length,
                    columns,
                    row,
                });
            }
            if vertices[0].is_none() {
                break;
            }
            // At most twice: vertices for which one ring is nearly singular are fitted again with
            // two rings.
            for again in [false, true] {
                self.fit_block(block, search, &mut vertices, again);
                if vertices.iter().all(Option::is_none) {
                    break;
                }
            }
        }
    }
}

impl<T: Real> Fits<'_, T> {
    /// Fits the pending vertices and removes the finished ones: all, or all except those that need
    /// two rings.
    #[inline(always)]
    fn fit_block(
        &self,
        block: &mut Block<T>,
        search: &mut Neighbourhood<T>,
        vertices: &mut [Option<Vertex<'_, T>>; WIDTH],
        again: bool,
    ) {
        let mut normals = [Several::zero(); 3];
        let mut counts = [0; WIDTH];
        let none = [Several::zero(); 3];
        block.offsets.clear();
        block.offsets.resize(COEFFICIENTS, none);
        for (lane, vertex) in vertices.iter_mut().enumerate() {
            let Some(vertex) = vertex else {
                continue;
            };
            let rings = if again || vertex.narrow { 2 } else { 1 };
            search.rings(self.surface, vertex.number, rings);
            counts[lane] = search.found.len();
            if block.offsets.len() < counts[lane] {
                block.offsets.resize(counts[lane], none);
            }
            let seen = self.surface.seen_from(vertex.number);
            let columns = vertex.columns.iter_mut().zip(&search.found);
            for (offset, (column, &(_, neighbour))) in block.offsets.iter_mut().zip(columns) {
                *column = neighbour;
                let difference = seen.difference(neighbour);
                for axis in 0..3 {
                    offset[axis].0[lane] = difference[axis];
                }
            }
            for (normal, &x) in normals.iter_mut().zip(&vertex.curvature.normal) {
                normal.0[lane] = x;
            }
        }
        let over_radius = block.set_unit();
        let fitted = block.settle(normals, &counts);
        let graph = fitted.graph();
        let uprightness = graph.uprightness();
        let (means, gaussians) = (graph.mean(uprightness), graph.gaussian(uprightness));
        let [directions, _] = graph.principal(fitted.axes).directions;
        let [x, y, xx, xy, yy] = graph.laplacian(uprightness);
        // The coefficients are those of ½ x² and ½ y².
        let half = Several::literal(0.5);
        let row = block.problem.row_of(&[x, y, half * xx, xy, half * yy]);
        let mut amplification = Several::zero();
        for (coefficient, &offset) in row.iter().zip(&block.offsets) {
            let negative = coefficient.less(Several::zero());
            let positive = Several::select(negative, -*coefficient, *coefficient);
            amplification = amplification + positive * dot(offset, offset);
        }
        for (lane, place) in vertices.iter_mut().enumerate() {
            let Some(vertex) = place else {
                continue;
            };
            let determined = fitted.determined[lane];
            let settled = determined && amplification.0[lane] <= T::constant(AMPLIFIED);
            if self.guarded && !vertex.narrow && !again && !settled {
                continue;
            }
            let over = over_radius.0[lane];
            let mean = means.0[lane] * over;
            let gaussian = gaussians.0[lane] * over * over;
            let bounded = [mean, gaussian, over * over].iter().all(|x| x.is_finite());
            if determined && bounded {
                vertex.curvature.normal = fitted.normal.map(|x| x.0[lane]);
                vertex.curvature.direction = directions.map(|x| x.0[lane]);
                (vertex.curvature.mean, vertex.curvature.gaussian) = (mean, gaussian);
                *vertex.length = counts[lane] as u32;
                for (entry, found) in vertex.row[..counts[lane]].iter_mut().zip(&*row) {
                    *entry = found.0[lane] * over * over;
                }
            } else {
                (vertex.curvature.mean, vertex.curvature.gaussian) = (T::zero(), T::zero());
                *vertex.length = 0;
            }
            *place = None;
        }
    }
}

impl<T: Real> Block<T> {
    /// Scales by the distances of the farthest neighbours, and returns the reciprocals of these.
    #[inline(always)]
    fn set_unit(&mut self) -> Several<T> {
        let mut farthest = Several::zero();
        for &offset in &self.offsets {
            let squared = dot(offset, offset);
            farthest = Several::select(farthest.less(squared), squared, farthest);
        }
        let over = farthest.sqrt().reciprocal_or_zero();
        for offset in &mut self.offsets {
            *offset = scale(over, *offset);
        }
        over
    }

    /// Repeats the fits, from initial normals, until every frame is aligned with its normal.
    /// Vertices that are aligned already are fitted again in the same frame, which changes nothing.
    #[inline(always)]
    fn settle(&mut self, mut normals: Vec3<Several<T>>, counts: &[usize; WIDTH]) -> Fitted<T> {
        let mut open = [true; WIDTH];
        let mut fits = 1;
        loop {
            let fitted = self.fit(normals, counts);
            let [a, b, ..] = fitted.coefficients;
            for (lane, open) in open.iter_mut().enumerate() {
                let tilt = a.0[lane].abs().max(b.0[lane].abs());
                *open &= fitted.determined[lane] && tilt > T::constant(8.0) * T::epsilon();
                if *open && fits < MOST_FITS {
                    for (normal, found) in normals.iter_mut().zip(&fitted.normal) {
                        normal.0[lane] = found.0[lane];
                    }
                }
            }
            if open == [false; WIDTH] || fits == MOST_FITS {
                return fitted;
            }
            fits += 1;
        }
    }

    #[inline(always)]
    fn fit(&mut self, normals: Vec3<Several<T>>, counts: &[usize; WIDTH]) -> Fitted<T> {
        let [first, second] = tangent_frame(normals);
        let half = Several::literal(0.5);
        let rows = self.offsets.len();
        let matrix = self.problem.matrix(rows, COEFFICIENTS);
        let mut largest = [Several::zero(); COEFFICIENTS];
        for (row, &offset) in self.offsets.iter().enumerate() {
            let (x, y) = (dot(offset, first), dot(offset, second));
            let basis = [x, y, half * x * x, x * y, half * y * y];
            for column in 0..COEFFICIENTS {
                let entry = basis[column];
                let square = entry * entry;
                let larger = largest[column].less(square);
                largest[column] = Several::select(larger, square, largest[column]);
                matrix[column * rows + row] = entry;
            }
            matrix[COEFFICIENTS * rows + row] = dot(offset, normals);
        }
        let independence = self.problem.factorise();
        let mut coefficients = [Several::zero(); COEFFICIENTS];
        self.problem.solve(&mut coefficients);
        let [a, b, ..] = coefficients;
        let tilt = add(scale(a, first), scale(b, second));
        let least = T::epsilon() * T::epsilon();
        Fitted {
            axes: [first, second, normals],
            coefficients,
            normal: normalise(sub(normals, tilt)),
            determined: array::from_fn(|lane| {
                // A column of rounding errors would otherwise be scaled up to a valid direction.
                let noise = largest.iter().any(|square| square.0[lane] <= least);
                let count = counts[lane];
                let rounding = T::constant(count as f64) * T::epsilon();
                count >= COEFFICIENTS && !noise && independence.0[lane] > rounding
            }),
        }
    }
}

impl<T: Real> Fitted<T> {
    fn graph(&self) -> Graph<Several<T>> {
        let [a, b, second @ ..] = self.coefficients;
        Graph {
            first: [a, b],
            second,
        }
    }
}
