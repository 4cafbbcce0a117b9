//! Components of a mesh that are inside out.

use crate::enclosure::{corners_of, winds_around};
use glam::DVec3;
use helfrich::{Surface, VertexKind};
use std::fmt;

/// A closed component that is inside out: its triangles run clockwise seen from outside. It is not inside of
/// an odd number of others, where it would be the inner boundary of a body with a cavity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InsideOut {
    /// The component, from 1, in the order of their first vertices. Vertices in no triangle do not count.
    pub component: usize,
    /// The number of components.
    pub components: usize,
    /// The number of its vertices.
    pub vertices: usize,
    /// The first of its vertices.
    pub first: usize,
}

impl fmt::Display for InsideOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            component,
            components,
            vertices,
            first,
        } = self;
        write!(
            f,
            "component {component} of {components} ({vertices} vertices from vertex {first} on) is inside out: \
             H is below 0 where it is convex: reverse the corners of its triangles"
        )
    }
}

/// A connected component.
struct Component {
    first: usize,
    vertices: usize,
    is_closed: bool,
    /// Six times its volume, and the sum of the amounts of its terms.
    volume: [f64; 2],
    corners: [DVec3; 2],
}

/// The closed components that are inside out, in the order of their first vertices. Those whose volume is 0 up
/// to rounding are not among them.
pub fn inside_out(surface: Surface<'_, f64>) -> Vec<InsideOut> {
    let mesh = surface.mesh();
    let (of_vertex, count) = mesh.components();
    let mut components = Vec::from_iter((0..count).map(|_| Component {
        first: usize::MAX,
        vertices: 0,
        is_closed: true,
        volume: [0.0; 2],
        corners: corners_of([]),
    }));
    for (vertex, (&component, &position)) in of_vertex.iter().zip(surface.positions()).enumerate() {
        let component = &mut components[component as usize];
        component.first = component.first.min(vertex);
        component.vertices += 1;
        component.is_closed &= mesh.vertex_kind(vertex) == VertexKind::Interior;
        let [low, high] = component.corners;
        let position = DVec3::from(position);
        component.corners = [low.min(position), high.max(position)];
    }
    for triangle in mesh.triangles() {
        let component = &mut components[of_vertex[triangle[0] as usize] as usize];
        let near = |vertex: u32| DVec3::from(surface.difference(component.first as u32, vertex));
        let [a, b, c] = triangle.map(near);
        let term = a.dot(b.cross(c));
        component.volume[0] += term;
        component.volume[1] += term.abs();
    }
    let is_used =
        |component: &&Component| mesh.vertex_kind(component.first) != VertexKind::Isolated;
    let all = components.iter().filter(is_used).count();
    let is_inward = |component: &Component| {
        let [volume, amount] = component.volume;
        let rounding = f64::EPSILON * component.vertices as f64 * amount;
        component.is_closed && volume < -rounding
    };
    let encloses = |outer: &Component, inner: &Component| {
        let point = surface.positions()[inner.first];
        let [low, high] = outer.corners;
        let is_in_box = low.cmple(point.into()).all() && high.cmpge(point.into()).all();
        let own = |triangle: &&[u32; 3]| of_vertex[triangle[0] as usize] == of_vertex[outer.first];
        outer.is_closed
            && outer.first != inner.first
            && is_in_box
            && winds_around(surface, mesh.triangles().iter().filter(own), point)
    };
    let used = components.iter().filter(is_used).enumerate();
    let inward = used.filter(|(_, component)| is_inward(component));
    let bounds_no_cavity = |inner: &Component| {
        let outer = components.iter().filter(|outer| encloses(outer, inner));
        outer.count() % 2 == 0
    };
    inward
        .filter(|(_, component)| bounds_no_cavity(component))
        .map(|(number, component)| InsideOut {
            component: number + 1,
            components: all,
            vertices: component.vertices,
            first: component.first,
        })
        .collect()
}
