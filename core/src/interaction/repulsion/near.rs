//! Vertices and triangles that may be near another surface.

use super::super::cells::{Cells, MARGIN, Near, Place};
use super::super::images::NearImages;
use super::face::Face;
use super::{Pairs, Repulsion, RepulsionMemory};
use crate::bending::AreaVectors;
use crate::element::Execution;
use crate::lane::Lane;
use crate::laplacian::Cotangent;
use crate::mesh::{TriangleMesh, VertexKind};
use crate::real::Real;
use crate::surface::Surface;
use crate::triangle::DualArea;
use crate::vec3::{Vec3, add, norm, scale, sub};
use alloc::vec::Vec;

/// A vertex that may be near another surface.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NearVertex<T> {
    pub(super) surface: u32,
    pub(super) vertex: u32,
    pub(super) area: T,
    pub(super) position: Vec3<T>,
    /// Rounding error of the position, where it is known.
    pub(super) remainder: Vec3<T>,
    /// The unit normal; 0 unless parts of a surface act on each other.
    pub(super) normal: Vec3<T>,
}

/// A triangle that may be near another surface.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NearFace<T> {
    pub(super) surface: u32,
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
    fn new(place: &Place<T>, surface: Surface<'_, T>, areas: &[T], normals: &[[T; 4]]) -> Self {
        let vertex = place.number as usize;
        let normal = normals.get(vertex).copied().unwrap_or_default();
        let remainders = surface.remainders();
        Self {
            surface: place.surface,
            vertex: place.number,
            area: areas[vertex],
            position: surface.positions()[vertex],
            remainder: remainders.map_or([T::zero(); 3], |all| all[vertex]),
            normal: [normal[0], normal[1], normal[2]],
        }
    }
}

/// The edges of a triangle from its first corner, the middle of its bounding box relative to that corner, and half of the
/// lengths of that box plus the range, with a margin for rounding.
fn boxed<T: Real>(
    surface: Surface<'_, T>,
    corners: [u32; 3],
    range: T,
) -> ([Vec3<T>; 2], [Vec3<T>; 2]) {
    let (half, wider) = (T::constant(0.5), T::constant(1.0 + MARGIN));
    let [first, second, third] = corners;
    let edges = [second, third].map(|corner| surface.difference(first, corner));
    let [low, high] = around_all([[T::zero(); 3], edges[0], edges[1]].into_iter());
    let centre = [0, 1, 2].map(|axis| half * (low[axis] + high[axis]));
    let reach = [0, 1, 2].map(|axis| wider * (half * (high[axis] - low[axis]) + range));
    (edges, [centre, reach])
}

impl<T: Real> NearFace<T> {
    fn new(place: &Place<T>, surface: Surface<'_, T>, range: T) -> Self {
        let (zero, half) = (T::zero(), T::constant(0.5));
        let mesh = surface.mesh();
        let corners = mesh.triangles()[place.number as usize];
        let (edges, [centre, reach]) = boxed(surface, corners, range);
        let over_range = range.reciprocal_or_zero();
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
        let first = corners[0] as usize;
        Self {
            surface: place.surface,
            corners,
            position: surface.positions()[first],
            remainder: surface.remainders().map_or([zero; 3], |all| all[first]),
            centre,
            reach,
            triangle: Face::new(
                edges.map(|edge| scale(over_range, edge)),
                [side(0), side(1), side(2)],
                corners.map(corner),
            ),
        }
    }
}

impl<T: Real> Repulsion<T> {
    /// Finds the vertices in the widened box of another surface or of an image, and the triangles
    /// that intersect it, sorted by cell; all of them where parts of a surface act on each other. If there are no vertices or no triangles, both results
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
            vertex_places,
            face_places,
            near_vertices,
            areas,
            begins,
            doubled,
            normals,
            ..
        } = memory;
        vertices.clear();
        faces.clear();
        vertex_places.clear();
        face_places.clear();
        bounds.clear();
        areas.clear();
        begins.clear();
        normals.clear();
        let over_range = self.over_range();
        if over_range == T::zero() {
            return None;
        }
        let within = self.range * T::constant(1.0 + MARGIN);
        let mut width = within;
        bounds.extend(
            surfaces
                .iter()
                .map(|surface| around_all(surface.positions().iter().copied())),
        );
        for (a, surface) in surfaces.iter().enumerate() {
            let begin = areas.len();
            begins.push(begin);
            areas.resize(begin + surface.positions().len(), T::zero());
            near.clear();
            let mut own = self.parts;
            if own {
                near.push(bounds[a]);
            }
            for b in (0..surfaces.len()).filter(|&b| a != b || self.images.own) {
                let [low, high] = bounds[b];
                let widened = [low.map(|x| x - within), high.map(|x| x + within)];
                let before = near.len();
                self.images.add_meeting(widened, bounds[a], a == b, near);
                own |= a == b && near.len() > before;
            }
            if self.parts {
                AreaVectors.sum(execution, *surface, doubled);
                normals.extend(doubled.iter().map(|&[x, y, z, _]| {
                    let over = norm([x, y, z]).reciprocal_or_zero();
                    [x * over, y * over, z * over, over]
                }));
            }
            if near.is_empty() {
                continue;
            }
            let dual = Cotangent::new(DualArea::Barycentric);
            dual.dual_areas(execution, *surface, &mut areas[begin..]);
            let number = a as u32;
            let places = [&mut vertex_places.places, &mut face_places.places];
            width = width.max(self.add_places(number, *surface, own, near, places));
        }
        if vertex_places.places.is_empty() || face_places.places.is_empty() {
            return None;
        }
        let both = vertex_places.places.iter().chain(&face_places.places);
        let cells = Cells::new(
            &self.images,
            width,
            around_all(both.map(|place| place.middle)),
        );
        vertex_places.sort(&cells);
        face_places.sort(&cells);
        near_vertices.resize(vertex_places.cells.len(), Near::default());
        execution.map(&mut near_vertices[..], |k, near| {
            *near = cells.near(face_places, vertex_places.cells[k]);
        });
        vertices.resize(vertex_places.places.len(), NearVertex::default());
        execution.map(&mut vertices[..], |k, vertex| {
            let place = &vertex_places.places[k];
            let number = place.surface as usize;
            let begin = begins[number];
            let normals = normals.get(begin..).unwrap_or_default();
            *vertex = NearVertex::new(place, surfaces[number], &areas[begin..], normals);
        });
        faces.resize(face_places.places.len(), NearFace::default());
        execution.map(&mut faces[..], |k, face| {
            let place = &face_places.places[k];
            *face = NearFace::new(place, surfaces[place.surface as usize], self.range);
        });
        Some(Pairs {
            repulsion: self,
            over_range,
            cells,
            images: NearImages::new(&self.images),
        })
    }

    /// Adds the vertices and triangles of a surface that are near some boxes, and returns the width that cells need at least
    /// for these.
    fn add_places(
        &self,
        surface_number: u32,
        surface: Surface<'_, T>,
        own: bool,
        near: &[Bounds<T>],
        [vertices, faces]: [&mut Vec<Place<T>>; 2],
    ) -> T {
        let zero = T::zero();
        let is_near = |bounds: &Bounds<T>| near.iter().any(|other| meet(bounds, other));
        let place = |number: usize, middle, reach| Place {
            cell: 0,
            occupied: 0,
            surface: surface_number,
            number: number as u32,
            own,
            middle,
            reach,
        };
        let positions = surface.positions();
        for (vertex, &position) in positions.iter().enumerate() {
            if is_near(&[position; 2]) {
                vertices.push(place(vertex, position, zero));
            }
        }
        let mut width = zero;
        for (triangle, &corners) in surface.mesh().triangles().iter().enumerate() {
            let places = corners.map(|corner| positions[corner as usize]);
            if is_near(&around_all(places.into_iter())) {
                let (edges, [centre, sides]) = boxed(surface, corners, self.range);
                let middle = add(places[0], centre);
                let farthest = [[zero; 3], edges[0], edges[1]].map(|to| norm(sub(to, centre)));
                let farthest = farthest.into_iter().fold(zero, T::max);
                let reach = T::constant(1.0 + MARGIN) * (farthest + self.range);
                width = sides.into_iter().fold(width, T::max);
                faces.push(place(triangle, middle, reach));
            }
        }
        width
    }
}
