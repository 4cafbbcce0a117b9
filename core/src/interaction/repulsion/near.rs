//! Vertices and triangles that may be near another surface.

use super::super::cells::{Cell, Cells, InCell, MARGIN};
use super::super::images::NearImages;
use super::face::Face;
use super::{Pairs, Repulsion, RepulsionMemory};
use crate::element::Execution;
use crate::lane::Lane;
use crate::laplacian::Cotangent;
use crate::mesh::{TriangleMesh, VertexKind};
use crate::real::Real;
use crate::surface::Surface;
use crate::triangle::DualArea;
use crate::vec3::{Vec3, scale};
use alloc::vec::Vec;

/// A vertex that may be near another surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearVertex<T> {
    pub(super) cell: Cell,
    pub(super) surface: u32,
    pub(super) vertex: u32,
    pub(super) area: T,
    pub(super) position: Vec3<T>,
    /// Rounding error of the position, where it is known.
    pub(super) remainder: Vec3<T>,
}

/// A triangle that may be near another surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearFace<T> {
    pub(super) cell: Cell,
    pub(super) surface: u32,
    number: u32,
    pub(super) corners: [u32; 3],
    /// The first corner, and its remainder after rounding.
    pub(super) position: Vec3<T>,
    pub(super) remainder: Vec3<T>,
    /// The middle of the bounding box, relative to the first corner.
    pub(super) centre: Vec3<T>,
    /// Half of the lengths of that box plus the range, with a margin for rounding.
    pub(super) reach: Vec3<T>,
    pub(super) triangle: Face<T>,
}

impl<T> InCell for NearVertex<T> {
    fn cell(&self) -> Cell {
        self.cell
    }
}

impl<T> InCell for NearFace<T> {
    fn cell(&self) -> Cell {
        self.cell
    }
}

/// A bounding box: lower and upper bounds.
pub(super) type Bounds<T> = [Vec3<T>; 2];

/// The bounding box of another box and a point.
fn around<T: Real>([low, high]: Bounds<T>, x: Vec3<T>) -> Bounds<T> {
    let by = |bound: Vec3<T>, f: fn(T, T) -> T| [0, 1, 2].map(|k| f(bound[k], x[k]));
    [by(low, T::min), by(high, T::max)]
}

/// The bounding box of at least one point.
fn around_all<T: Real>(mut points: impl Iterator<Item = Vec3<T>>) -> Bounds<T> {
    let first = points.next().unwrap_or_default();
    points.fold([first; 2], around)
}

fn meet<T: Real>([low, high]: &Bounds<T>, [other_low, other_high]: &Bounds<T>) -> bool {
    (0..3).all(|k| low[k] <= other_high[k] && other_low[k] <= high[k])
}

/// Whether an edge, from one vertex to another, has a triangle on one side only.
fn is_boundary(mesh: &TriangleMesh, from: u32, to: u32) -> bool {
    let at_boundary = |vertex: u32| mesh.vertex_kind(vertex as usize) == VertexKind::Boundary;
    let ring = || mesh.one_ring(from as usize);
    at_boundary(from)
        && at_boundary(to)
        && (ring().first() == Some(&to) || ring().last() == Some(&to))
}

impl<T: Real> NearVertex<T> {
    /// Adds the vertices of a surface that are in one of these boxes.
    fn add(
        vertices: &mut Vec<Self>,
        number: usize,
        surface: Surface<'_, T>,
        areas: &[T],
        near: &[Bounds<T>],
    ) {
        let remainders = surface.remainders();
        for (vertex, &position) in surface.positions().iter().enumerate() {
            if near.iter().any(|bounds| meet(bounds, &[position; 2])) {
                vertices.push(Self {
                    cell: [0; 3],
                    surface: number as u32,
                    vertex: vertex as u32,
                    area: areas[vertex],
                    position,
                    remainder: remainders.map_or([T::zero(); 3], |all| all[vertex]),
                });
            }
        }
    }
}

impl<T: Real> NearFace<T> {
    /// Adds the triangles of a surface that intersect one of these boxes.
    fn add(
        faces: &mut Vec<Self>,
        number: usize,
        surface: Surface<'_, T>,
        range: T,
        near: &[Bounds<T>],
    ) {
        let (zero, half) = (T::zero(), T::constant(0.5));
        let over_range = range.reciprocal_or_zero();
        let wider = T::constant(1.0 + MARGIN);
        let mesh = surface.mesh();
        let remainders = surface.remainders();
        for (triangle, &corners) in mesh.triangles().iter().enumerate() {
            let places = corners.map(|corner| surface.positions()[corner as usize]);
            let bounds = around_all(places.into_iter());
            if !near.iter().any(|other| meet(&bounds, other)) {
                continue;
            }
            let [first, second, third] = corners;
            let edges = [second, third].map(|corner| surface.difference(first, corner));
            let [low, high] = around_all([[zero; 3], edges[0], edges[1]].into_iter());
            let side = |k: usize| {
                let boundary = is_boundary(mesh, corners[k], corners[(k + 1) % 3]);
                if boundary { zero } else { half }
            };
            let corner = |vertex: u32| match mesh.vertex_kind(vertex as usize) {
                VertexKind::Interior => {
                    let valence = T::from_usize(mesh.valence(vertex as usize));
                    valence.map_or(zero, T::recip)
                }
                _ => zero,
            };
            faces.push(Self {
                cell: [0; 3],
                surface: number as u32,
                number: triangle as u32,
                corners,
                position: places[0],
                remainder: remainders.map_or([zero; 3], |all| all[first as usize]),
                centre: [0, 1, 2].map(|axis| half * (low[axis] + high[axis])),
                reach: [0, 1, 2].map(|axis| wider * (half * (high[axis] - low[axis]) + range)),
                triangle: Face::new(
                    edges.map(|edge| scale(over_range, edge)),
                    [side(0), side(1), side(2)],
                    corners.map(corner),
                ),
            });
        }
    }

    /// Its position, up to rounding.
    fn middle(&self) -> Vec3<T> {
        [0, 1, 2].map(|axis| self.position[axis] + self.centre[axis])
    }
}

impl<T: Real> Repulsion<T> {
    /// Finds the vertices in the widened box of another surface or of an image, and the triangles
    /// that intersect it, sorted by cell. If there are no vertices or no triangles, both results
    /// are empty.
    pub(super) fn find(
        &self,
        execution: &impl Execution,
        surfaces: &[Surface<'_, T>],
        memory: &mut RepulsionMemory<T>,
    ) -> Option<Pairs<'_, T>> {
        let RepulsionMemory {
            bounds,
            near,
            vertices,
            faces,
            areas,
            ..
        } = memory;
        vertices.clear();
        faces.clear();
        bounds.clear();
        let over_range = self.over_range();
        if over_range == T::zero() {
            return None;
        }
        let width = self.range * T::constant(1.0 + MARGIN);
        bounds.extend(
            surfaces
                .iter()
                .map(|surface| around_all(surface.positions().iter().copied())),
        );
        for (a, surface) in surfaces.iter().enumerate() {
            near.clear();
            for b in (0..surfaces.len()).filter(|&b| a != b || self.images.own) {
                let [low, high] = bounds[b];
                let widened = [low.map(|x| x - width), high.map(|x| x + width)];
                self.images.add_meeting(widened, bounds[a], a == b, near);
            }
            if near.is_empty() {
                continue;
            }
            let count = surface.positions().len();
            if areas.len() < count {
                areas.resize(count, T::zero());
            }
            let areas = &mut areas[..count];
            Cotangent::new(DualArea::Barycentric).dual_areas(execution, *surface, areas);
            NearVertex::add(vertices, a, *surface, areas, near);
            NearFace::add(faces, a, *surface, self.range, near);
        }
        if vertices.is_empty() || faces.is_empty() {
            return None;
        }
        let reach = faces.iter().flat_map(|face| face.reach);
        let reach = reach.fold(T::zero(), T::max);
        let points = vertices.iter().map(|vertex| vertex.position);
        let cells = Cells::new(
            &self.images,
            reach,
            around_all(points.chain(faces.iter().map(NearFace::middle))),
        );
        for vertex in &mut *vertices {
            vertex.cell = cells.cell(vertex.position);
        }
        for face in &mut *faces {
            face.cell = cells.cell(face.middle());
        }
        vertices.sort_unstable_by_key(|near| (near.cell, near.surface, near.vertex));
        faces.sort_unstable_by_key(|near| (near.cell, near.surface, near.number));
        Some(Pairs {
            repulsion: self,
            over_range,
            cells,
            images: NearImages::new(&self.images),
        })
    }
}
