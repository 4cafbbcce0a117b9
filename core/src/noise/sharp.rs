//! Creases of a surface, and single vertices far off it.
//!
//! Neither is noise: polynomials fit neither, and the residuals of fits that include them say nothing about the
//! positions elsewhere.

use super::sort;
use crate::mesh::TriangleMesh;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, cross, dot, norm, normalise, scale, sub};
use alloc::vec::Vec;

/// A vertex that is not one of a smooth surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mark {
    /// Two or more edges with a sharp angle, as at an edge, a corner or a tip.
    Crease,
    /// A vertex far off the surface of its neighbours.
    Outlier,
}

/// Least angle between triangles at a crease, in radians, where steps between voxels have up to 0.96; and its least
/// ratio to the angles at three quarters of the nearby edges: on a coarse mesh of a smooth surface, all angles are large.
const ANGLE: f64 = 1.0;
const SHARPER: f64 = 4.0;

/// Slenderness of half a square, up to which triangles are no slivers.
const SLENDER: f64 = 2.0;

/// Least part of the sharp angles that have one sign: noise has both, and so have the steps of a surface between
/// voxels.
const ONE_SIGN: f64 = 0.8;

/// Least distance of an outlier from the middle of its neighbours, in distances of the farthest of these;
/// or, along the normal, in the same unit, and in distances of nearby vertices.
const OUTSIDE: f64 = 1.2;
const ABOVE: f64 = 0.25;
const HIGHER: f64 = 8.0;

/// Least ratio of the distance of an outlier to those of its neighbours, whose own neighbours include the outlier.
const ALONE: f64 = 2.2;

/// The marks of all vertices.
pub(super) fn marks<T: Real>(surface: Surface<'_, T>) -> Vec<Option<Mark>> {
    let mesh = surface.mesh();
    let turns = turns(surface);
    let edges = edges_of_vertices(mesh);
    let offsets =
        Vec::from_iter((0..mesh.vertex_count()).map(|vertex| Offset::new(surface, vertex)));
    let mut values = Vec::new();
    let mark = |vertex: usize| {
        if is_crease(mesh, vertex, &turns, &edges, &mut values) {
            return Some(Mark::Crease);
        }
        is_outlier(mesh, vertex, &offsets, &mut values).then_some(Mark::Outlier)
    };
    (0..mesh.vertex_count()).map(mark).collect()
}

/// The turn of a surface at an edge.
#[derive(Clone, Copy, Debug)]
struct Turn<T> {
    /// The angle between its triangles, positive where the surface is convex; 0 at a boundary.
    angle: T,
    /// The larger ratio of a longest edge to the height over it. On a smooth surface, the normals of slivers are off by
    /// as much more as those of other triangles.
    slenderness: T,
}

impl<T: Real> Turn<T> {
    /// Whether the angle is too large for a smooth surface whose edges nearby have angles of this size.
    fn is_sharp(&self, nearby: T) -> bool {
        let times = (self.slenderness / T::constant(SLENDER)).max(T::one());
        self.angle.abs() >= T::constant(ANGLE).max(T::constant(SHARPER) * times * nearby)
    }
}

/// The turns at all edges.
fn turns<T: Real>(surface: Surface<'_, T>) -> Vec<Turn<T>> {
    let mesh = surface.mesh();
    let turn = |edge: usize| {
        let (first, Some(second)) = mesh.edge_triangles(edge) else {
            return Turn {
                angle: T::zero(),
                slenderness: T::one(),
            };
        };
        let [a, b] =
            [first, second].map(|triangle| surface.triangle(triangle as usize).area_vector);
        let turned = cross(a, b);
        let [from, _] = mesh.edges()[edge];
        let opposite = mesh.triangles()[second as usize];
        // The surface is convex where the second triangle lies below the plane of the first.
        let below = opposite
            .iter()
            .map(|&corner| dot(a, surface.difference(from, corner)));
        let sign = if below.sum::<T>() < T::zero() {
            T::one()
        } else {
            -T::one()
        };
        let slenderness = [first, second].map(|triangle| {
            let corners = mesh.triangles()[triangle as usize];
            let edges = [0, 1, 2].map(|k| surface.difference(corners[k], corners[(k + 1) % 3]));
            let squares = edges.map(|edge| dot(edge, edge));
            let longest = squares.into_iter().fold(T::zero(), T::max);
            longest / norm(surface.triangle(triangle as usize).area_vector)
        });
        Turn {
            angle: sign * norm(turned).atan2(dot(a, b)),
            slenderness: slenderness[0].max(slenderness[1]),
        }
    };
    (0..mesh.edges().len()).map(turn).collect()
}

/// The edges at each vertex.
fn edges_of_vertices(mesh: &TriangleMesh) -> Vec<Vec<u32>> {
    let mut edges = alloc::vec![Vec::new(); mesh.vertex_count()];
    for (edge, ends) in (0..).zip(mesh.edges()) {
        for &end in ends {
            edges[end as usize].push(edge);
        }
    }
    edges
}

fn is_crease<T: Real>(
    mesh: &TriangleMesh,
    vertex: usize,
    turns: &[Turn<T>],
    edges: &[Vec<u32>],
    values: &mut Vec<T>,
) -> bool {
    let at = |vertex: usize| edges[vertex].iter().map(move |&edge| turns[edge as usize]);
    let is_candidate = |turn: &Turn<T>| turn.is_sharp(T::zero());
    if at(vertex).filter(is_candidate).count() < 2 {
        return false;
    }
    let ring = || mesh.one_ring(vertex).iter().map(|&other| other as usize);
    let around = || ring().chain([vertex]).flat_map(at);
    values.clear();
    values.extend(around().map(|turn| turn.angle.abs()));
    sort(values);
    let nearby = values
        .get(3 * values.len() / 4)
        .copied()
        .unwrap_or(T::zero());
    let is_sharp = |turn: &Turn<T>| turn.is_sharp(nearby);
    let sharp = || around().filter(is_sharp).map(|turn| turn.angle);
    let sum: T = sharp().sum();
    let sizes: T = sharp().map(T::abs).sum();
    at(vertex).filter(is_sharp).count() >= 2 && sum.abs() >= T::constant(ONE_SIGN) * sizes
}

/// The place of a vertex relative to its neighbours.
struct Offset<T> {
    /// Distance from their middle, and its part along their normal.
    distance: T,
    height: T,
    /// The distance of the farthest neighbour from the middle.
    radius: T,
}

impl<T: Real> Offset<T> {
    fn new(surface: Surface<'_, T>, vertex: usize) -> Self {
        let mesh = surface.mesh();
        let ring = mesh.one_ring(vertex);
        let zero = [T::zero(); 3];
        if ring.len() < 3 || !mesh.is_interior(vertex) {
            return Self {
                distance: T::zero(),
                height: T::zero(),
                radius: T::zero(),
            };
        }
        let spoke = |other: u32| surface.difference(vertex as u32, other);
        let sum = ring.iter().fold(zero, |sum, &other| add(sum, spoke(other)));
        let middle = scale(T::constant(ring.len() as f64).recip(), sum);
        let from_middle = |other: u32| sub(spoke(other), middle);
        let mut normal: Vec3<T> = zero;
        let mut radius = T::zero();
        for (place, &other) in ring.iter().enumerate() {
            let next = ring[(place + 1) % ring.len()];
            normal = add(normal, cross(from_middle(other), from_middle(next)));
            radius = radius.max(norm(from_middle(other)));
        }
        Self {
            distance: norm(middle),
            height: dot(middle, normalise(normal)).abs(),
            radius,
        }
    }
}

fn is_outlier<T: Real>(
    mesh: &TriangleMesh,
    vertex: usize,
    offsets: &[Offset<T>],
    values: &mut Vec<T>,
) -> bool {
    let own = &offsets[vertex];
    let times = |factor: f64, value: T| T::constant(factor) * value;
    let is_outside = own.distance > times(OUTSIDE, own.radius);
    if !is_outside && own.height <= times(ABOVE, own.radius) {
        return false;
    }
    let ring = || mesh.one_ring(vertex).iter().map(|&other| other as usize);
    let most = ring().fold(T::zero(), |most, other| most.max(offsets[other].distance));
    if is_outside && own.distance >= times(ALONE, most) {
        return true;
    }
    values.clear();
    for other in ring() {
        let others = mesh.one_ring(other).iter().map(|&beyond| beyond as usize);
        values.extend(
            others
                .filter(|&other| other != vertex)
                .map(|other| offsets[other].height),
        );
    }
    sort(values);
    let nearby = values.get(values.len() / 2).copied().unwrap_or(T::zero());
    let highest = ring().fold(T::zero(), |most, other| most.max(offsets[other].height));
    own.height >= times(HIGHER, nearby) && own.height >= times(ALONE, highest)
}
