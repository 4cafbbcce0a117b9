//! Vertices and triangles that may be near another surface.

use super::super::cells::MARGIN;
use super::face::Face;
use super::neighbours::Neighbours;
use crate::bending::AreaVectors;
use crate::element::Execution;
use crate::lane::Lane;
use crate::laplacian::Cotangent;
use crate::mesh::{TriangleMesh, VertexKind};
use crate::real::Real;
use crate::surface::Surface;
use crate::triangle::DualArea;
use crate::vec3::{Vec3, norm, scale};
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

/// All that may be near another surface, at one evaluation.
#[derive(Clone, Debug, Default)]
pub(super) struct Nearby<T> {
    /// In the order of surfaces and vertices.
    pub(super) vertices: Vec<NearVertex<T>>,
    pub(super) faces: Vec<NearFace<T>>,
    /// Areas of the vertices of all surfaces, and where those of each begin; set for surfaces with vertices in the list.
    areas: Vec<T>,
    pub(super) begins: Vec<usize>,
    /// Twice the area vectors of one surface's vertices; unit normals N/|N| of all and 1/|2N|, where parts act.
    doubled: Vec<[T; 4]>,
    pub(super) normals: Vec<[T; 4]>,
}

/// A bounding box: lower and upper bounds.
pub(super) type Bounds<T> = [Vec3<T>; 2];

/// The bounding box of another box and a point.
fn around<T: Real>([low, high]: Bounds<T>, x: Vec3<T>) -> Bounds<T> {
    let by = |bound: Vec3<T>, f: fn(T, T) -> T| [0, 1, 2].map(|k| f(bound[k], x[k]));
    [by(low, T::min), by(high, T::max)]
}

/// The bounding box of at least one point.
pub(super) fn around_all<T: Real>(mut points: impl Iterator<Item = Vec3<T>>) -> Bounds<T> {
    let first = points.next().unwrap_or_default();
    points.fold([first; 2], around)
}

pub(super) fn meet<T: Real>([low, high]: &Bounds<T>, [other_low, other_high]: &Bounds<T>) -> bool {
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
    /// A vertex without area and normal.
    pub(super) fn at([surface_number, number]: [u32; 2], surface: Surface<'_, T>) -> Self {
        let vertex = number as usize;
        let remainders = surface.remainders();
        Self {
            surface: surface_number,
            vertex: number,
            area: T::zero(),
            position: surface.positions()[vertex],
            remainder: remainders.map_or([T::zero(); 3], |all| all[vertex]),
            normal: [T::zero(); 3],
        }
    }
}

/// The edges of a triangle from its first corner, the middle of its bounding box relative to that corner, and half of the
/// lengths of that box plus the range, with a margin for rounding.
pub(super) fn boxed<T: Real>(
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
    pub(super) fn new(
        [surface_number, number]: [u32; 2],
        surface: Surface<'_, T>,
        range: T,
    ) -> Self {
        let (zero, half) = (T::zero(), T::constant(0.5));
        let mesh = surface.mesh();
        let corners = mesh.triangles()[number as usize];
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
            surface: surface_number,
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

impl<T: Real> Nearby<T> {
    /// Measures what is listed.
    pub(super) fn measure(
        &mut self,
        execution: &impl Execution,
        surfaces: &[Surface<'_, T>],
        neighbours: &Neighbours<T>,
        range: T,
        parts: bool,
    ) {
        let Self {
            vertices,
            faces,
            areas,
            begins,
            doubled,
            normals,
        } = self;
        let (listed, listed_faces) = (neighbours.vertices(), neighbours.faces());
        begins.clear();
        normals.clear();
        let mut count = 0;
        let mut next = 0;
        for (number, surface) in surfaces.iter().enumerate() {
            begins.push(count);
            count += surface.positions().len();
            areas.resize(count.max(areas.len()), T::zero());
            if parts {
                AreaVectors.sum(execution, *surface, doubled);
                normals.extend(doubled.iter().map(|&[x, y, z, _]| {
                    let over = norm([x, y, z]).reciprocal_or_zero();
                    [x * over, y * over, z * over, over]
                }));
            }
            let own = listed[next..].partition_point(|listed| listed.place[0] as usize <= number);
            if own > 0 {
                next += own;
                let dual = Cotangent::new(DualArea::Barycentric);
                dual.dual_areas(execution, *surface, &mut areas[begins[number]..count]);
            }
        }
        vertices.resize(listed.len(), NearVertex::default());
        execution.map(&mut vertices[..], |k, vertex| {
            let place @ [surface, number] = listed[k].place;
            let index = begins[surface as usize] + number as usize;
            let [x, y, z, _] = normals.get(index).copied().unwrap_or_default();
            *vertex = NearVertex {
                area: areas[index],
                normal: [x, y, z],
                ..NearVertex::at(place, surfaces[surface as usize])
            };
        });
        faces.resize(listed_faces.len(), NearFace::default());
        execution.map(&mut faces[..], |k, face| {
            let surface = surfaces[listed_faces[k][0] as usize];
            *face = NearFace::new(listed_faces[k], surface, range);
        });
    }
}
