//! Loop subdivision: refinement of any triangle mesh, and the smooth surface in its limit.
//!
//! C. T. Loop, Smooth Subdivision Surfaces Based on Triangles, University of Utah (1987). The
//! positions at a mesh's vertices are *control points*: a [`Subdivision`] refines them, a quadruple
//! of triangles for each triangle and level, and [`limit_positions`] and [`limit_normals`] give the
//! limits of the vertices. Between the vertices the limit surface is known exactly, too: the
//! [`Patch`] of a triangle lists the control points on which it depends, and [`basis`] gives their
//! weights with first and second derivatives.
//!
//! | | weight at the vertex or ends | weight at the others |
//! |---|---|---|
//! | vertex of valence n | 1 − nβ | β = (5/8 − (3/8 + cos(2π/n)/4)²)/n at each neighbour |
//! | edge | 3/8, 3/8 | 1/8, 1/8 at the two vertices across |
//! | limit of a vertex | 1 − nω | ω = 1/(3/(8β) + n) at each neighbour |
//! | boundary vertex | 3/4 | 1/8, 1/8 at the two neighbours along the boundary |
//! | boundary edge | 1/2, 1/2 | |
//! | limit of a boundary vertex | 2/3 | 1/6, 1/6 at the two neighbours along the boundary |
//!
//! The β are Loop's own for every valence. A boundary thus becomes the cubic B-spline of its
//! polygon, whatever the triangles inside. Corners have no special rule: a vertex of only one
//! triangle is rounded like every boundary vertex. Isolated vertices stay where they are.
//!
//! The limit surface is twice continuously differentiable, except at *extraordinary* vertices,
//! interior ones of valence other than 6: there it has a tangent plane, but no second derivatives.
//!
//! ```
//! use helfrich::subdivision::Subdivision;
//! use helfrich::TriangleMesh;
//!
//! let tetrahedron = TriangleMesh::new(4, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])?;
//! let corners = [[1.0, 1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, 1.0]];
//! let twice = Subdivision::new(&tetrahedron, 2)?;
//! let positions = twice.refine(&corners);
//! assert_eq!(twice.mesh().triangles().len(), 64);
//! assert_eq!(positions.len(), twice.mesh().vertex_count());
//! # Ok::<(), helfrich::MeshError>(())
//! ```

mod limit;
mod masks;
mod patch;
mod regular;
mod stencils;

pub use limit::{limit_normals, limit_positions};
pub use masks::{limit_weight, vertex_weight};
pub use patch::{NoPatch, Patch, basis};
pub use regular::Basis;
pub use stencils::Stencils;

pub(crate) use limit::limit_normal;
pub(crate) use stencils::RowSum;

use crate::element::Serial;
use crate::mesh::{MeshError, TriangleMesh, VertexKind};
use crate::points::{Points, PointsMut};
use crate::real::Real;
use alloc::vec::Vec;

/// A mesh refined by Loop's rules, and the map that refines any field on it.
#[derive(Clone, Debug, PartialEq)]
pub struct Subdivision {
    mesh: TriangleMesh,
    stencils: Stencils,
}

impl Subdivision {
    /// Refines a mesh `levels` times.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if the result has more vertices or triangles than a mesh may have.
    pub fn new(mesh: &TriangleMesh, levels: u32) -> Result<Self, MeshError> {
        Self::sizes(mesh, levels)?;
        let mut refined = Self {
            mesh: mesh.clone(),
            stencils: Stencils::identity(mesh.vertex_count()),
        };
        for level in 0..levels {
            let step = Self::step(&refined.mesh);
            refined.stencils = if level == 0 {
                step.stencils
            } else {
                refined.stencils.then(&step.stencils)
            };
            refined.mesh = step.mesh;
        }
        Ok(refined)
    }

    /// Numbers of vertices and triangles after `levels` refinements, without refining.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if a mesh may not have that many.
    pub fn sizes(mesh: &TriangleMesh, levels: u32) -> Result<[usize; 2], MeshError> {
        let mut vertices = mesh.vertex_count();
        let mut edges = mesh.edges().len();
        let mut triangles = mesh.triangles().len();
        for _ in 0..levels {
            // Every level is checked against the limit, below which nothing overflows.
            (vertices, edges, triangles) =
                (vertices + edges, 2 * edges + 3 * triangles, 4 * triangles);
            for (what, count) in [("vertices", vertices), ("triangles", triangles)] {
                if count > TriangleMesh::LIMIT {
                    return Err(MeshError::TooLarge {
                        what,
                        count,
                        limit: TriangleMesh::LIMIT,
                    });
                }
            }
        }
        Ok([vertices, triangles])
    }

    /// The refined mesh.
    ///
    /// Vertices keep their numbers; those on the edges follow, in the order of the edges. Triangle
    /// t becomes 4t … 4t + 3: those at its three corners, and the middle one.
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// The map from control points, or any other field on the coarse mesh, to the refined mesh.
    /// Its transpose pulls nodal forces back.
    pub fn stencils(&self) -> &Stencils {
        &self.stencils
    }

    /// The refined mesh without the map.
    pub fn into_mesh(self) -> TriangleMesh {
        self.mesh
    }

    /// Refines positions, or vectors at vertices, of any type of points.
    ///
    /// # Panics
    /// If there are fewer points than the coarse mesh has vertices.
    pub fn refine_points<P: Clone>(&self, points: &[P]) -> Vec<P>
    where
        [P]: PointsMut,
    {
        let Some(first) = points.first() else {
            assert_eq!(self.stencils.len(), 0, "no points for a mesh with vertices");
            return Vec::new();
        };
        let mut refined = alloc::vec![first.clone(); self.stencils.len()];
        let fine = refined.as_mut_slice().coordinates_mut();
        self.stencils.apply(&Serial, points.coordinates(), fine);
        refined
    }

    /// Refines a field of D numbers per vertex: positions, colours, texture coordinates.
    ///
    /// # Panics
    /// If `field` has fewer entries than the coarse mesh has vertices.
    pub fn refine<T: Real, const D: usize>(&self, field: &[[T; D]]) -> Vec<[T; D]> {
        let mut refined = alloc::vec![[T::zero(); D]; self.stencils.len()];
        self.stencils.apply(&Serial, field, &mut refined);
        refined
    }

    /// One refinement, of a size that a mesh may have.
    fn step(mesh: &TriangleMesh) -> Self {
        let coarse = mesh.vertex_count();
        let vertices = coarse + mesh.edges().len();
        let mut stencils =
            Stencils::with_capacity(coarse, vertices, 7 * coarse + 4 * (vertices - coarse));
        for vertex in 0..coarse {
            push_vertex_mask(mesh, vertex, &mut stencils);
        }
        for (edge, &[tail, head]) in mesh.edges().iter().enumerate() {
            match mesh.edge_triangles(edge) {
                (left, Some(right)) => {
                    let [end, side] = masks::EDGE;
                    let [left, right] = [left, right].map(|side| across(mesh, side, [tail, head]));
                    stencils.push_row([(tail, end), (head, end), (left, side), (right, side)]);
                }
                (_, None) => stencils.push_row([(tail, 0.5), (head, 0.5)]),
            }
        }
        Self {
            mesh: mesh.refined(),
            stencils,
        }
    }
}

fn push_vertex_mask(mesh: &TriangleMesh, vertex: usize, stencils: &mut Stencils) {
    let ring = mesh.one_ring(vertex);
    let centre = vertex as u32;
    match (mesh.vertex_kind(vertex), ring) {
        (VertexKind::Boundary, &[first, .., last]) => {
            let [middle, side] = masks::BOUNDARY_VERTEX;
            stencils.push_row([(centre, middle), (first, side), (last, side)]);
        }
        (VertexKind::Interior, ring) => {
            let beta = vertex_weight(ring.len());
            let neighbours = ring.iter().map(|&neighbour| (neighbour, beta));
            let middle = (centre, 1.0 - ring.len() as f64 * beta);
            stencils.push_row(core::iter::once(middle).chain(neighbours));
        }
        _ => stencils.push_row([(centre, 1.0)]),
    }
}

/// The vertex of a triangle that is not an end of one of its edges.
fn across(mesh: &TriangleMesh, triangle: u32, [tail, head]: [u32; 2]) -> u32 {
    let [a, b, c] = mesh.triangles()[triangle as usize];
    a ^ b ^ c ^ tail ^ head
}
