//! The edges that the meshes of a surface are to have.

use crate::remesh::{EdgeLengths, MeshRequest, OfNoise};
use crate::scene::Remesh;
use helfrich::Surface;
use std::f64::consts::PI;

/// Fewest vertices of a new mesh: those of an icosahedron.
const FEWEST: usize = 12;

/// The edges of a surface, and its mesh at the start.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    pub(super) edges: Remesh,
    pub(super) vertices: usize,
    pub(super) area: f64,
    /// Whether exactly held areas and volumes are those of the smooth surface. Those of flat triangles depend on the mesh
    /// to second order in the edges, and a surface with few of them would get another shape with another mesh.
    pub(super) smooth: bool,
}

impl Wanted {
    /// The number of vertices that a surface of this area is to have; NaN if it depends on more than the area.
    pub(super) fn vertices_of(self, area: f64) -> f64 {
        match self.edges {
            Remesh::Auto => self.vertices as f64 * area / self.area,
            Remesh::Vertices(count) => count as f64,
            // Each vertex of equilateral triangles has the area √3/2 l².
            Remesh::Edge(length) => 2.0 / 3.0_f64.sqrt() * area / (length * length),
            Remesh::Curvature(_) | Remesh::Error(_) => f64::NAN,
        }
    }

    /// The largest angle between neighbouring triangles, in degrees, if lengths depend on curvature, and the angle by which
    /// an edge is to turn at most; along a curve, neighbours of equilateral triangles turn by 1/√3 of what an edge does.
    pub(super) fn turn(self, surface: Surface<'_, f64>) -> Option<[f64; 2]> {
        let Remesh::Curvature(angle) = self.edges else {
            return None;
        };
        let mesh = surface.mesh();
        let turns = (0..mesh.edges().len()).filter_map(|edge| {
            let (left, right) = mesh.edge_triangles(edge);
            let [left, right] = [left, right?].map(|triangle| {
                glam::DVec3::from_array(surface.triangle_normal(triangle as usize))
            });
            Some(left.cross(right).length().atan2(left.dot(right)))
        });
        Some([turns.fold(0.0, f64::max).to_degrees(), angle])
    }

    pub(super) fn request(self, area: f64) -> MeshRequest {
        MeshRequest {
            lengths: match self.edges {
                // Relative to each other.
                Remesh::Auto | Remesh::Vertices(_) => EdgeLengths::Uniform(1.0),
                Remesh::Edge(length) => EdgeLengths::Uniform(length),
                Remesh::Curvature(angle) => EdgeLengths::ByCurvature(angle.to_radians()),
                Remesh::Error(part) => EdgeLengths::ByError(part),
            },
            vertices: match self.edges {
                Remesh::Auto | Remesh::Vertices(_) => {
                    Some((self.vertices_of(area).round() as usize).max(FEWEST))
                }
                Remesh::Edge(_) | Remesh::Curvature(_) | Remesh::Error(_) => None,
            },
            // A membrane that bends has none, and narrow triangles are no reason to keep some.
            creases: PI,
            noise: OfNoise::Kept,
        }
    }
}
