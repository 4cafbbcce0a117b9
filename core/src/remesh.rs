//! Even meshes of a smooth surface.
//!
//! Splits, collapses, flips and movements of vertices towards wanted edge lengths, after M. Botsch and L. Kobbelt, A
//! remeshing approach to multiresolution modeling, Symp. Geometry Processing 2004, 189. Vertices move on the flat
//! triangles of the input, and in the end each is put on the smooth surface over its place (D. R. Clark, N. Ray and X. Jiao,
//! Proc. 21st Int. Meshing Roundtable (2012) 99): fits are those of the input, and errors do not accumulate.

mod ground;
mod passes;

use crate::element::Execution;
use crate::mesh::TriangleMesh;
use crate::real::Real;
use crate::smooth_surface::{MeshPoint, SmoothPoint, SmoothSurface};
use alloc::vec;
use alloc::vec::Vec;
use ground::Ground;
use passes::State;

/// Number of rounds at the end that make triangles Delaunay ones.
const LAST: usize = 4;

/// The mesh that [`SmoothSurface::remesh`] makes.
#[derive(Clone, Copy, Debug)]
pub struct Remeshing<'a, T> {
    /// The edge length that is wanted at each vertex of the input, above 0.
    pub sizes: &'a [T],
    /// The number of vertices; lengths are then relative to each other.
    pub vertices: Option<usize>,
    /// Number of rounds of splits, collapses, flips and movements.
    pub rounds: usize,
}

/// A new mesh of a surface.
#[derive(Clone, Debug)]
pub struct Remeshed<T> {
    /// The mesh.
    pub mesh: TriangleMesh,
    /// The place of each vertex on the input.
    pub places: Vec<MeshPoint<T>>,
    /// The point of the smooth surface there: position, normal, curvatures, error bars.
    pub points: Vec<SmoothPoint<T>>,
}

impl<T: Real> SmoothSurface<T> {
    /// A new mesh of this surface with edges of wanted lengths; `None` if `go_on`, which gets the part that is done,
    /// returns `false`.
    ///
    /// # Panics
    /// If the number of sizes is not that of the vertices.
    pub fn remesh(
        &self,
        execution: &impl Execution,
        settings: &Remeshing<'_, T>,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Option<Remeshed<T>> {
        let ground = Ground::new(self.surface(), self.lines(), settings.sizes);
        let mut state = State::new(ground);
        let rounds = settings.rounds + LAST;
        for round in 0..rounds {
            if !go_on(round as f64 / rounds as f64) {
                return None;
            }
            if round < settings.rounds {
                if let Some(wanted) = settings.vertices {
                    state.scale_to(wanted);
                }
                state.split_long();
                state.collapse_short();
                state.flip_to_valence();
            } else {
                if let Some(wanted) = settings.vertices {
                    state.bring_to(wanted);
                }
                state.flip_to_delaunay();
            }
            state.smooth();
        }
        // The cosine of 40°.
        for _ in 0..LAST {
            state.widen_angles(T::constant(0.766));
            state.flip_to_delaunay();
        }
        let edited = state.edited.clone().finish();
        let vertices = &edited.vertices;
        let places = vertices.iter().map(|&vertex| state.places[vertex as usize]);
        let places = Vec::from_iter(places);
        let mut points = vec![SmoothPoint::default(); places.len()];
        execution.map(&mut points[..], |index, point| {
            *point = state.point(self, vertices[index]);
        });
        Some(Remeshed {
            mesh: edited.mesh,
            places,
            points,
        })
    }
}
