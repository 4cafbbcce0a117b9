//! Even meshes of a smooth surface.
//!
//! Splits, collapses, flips and movements of vertices towards wanted edge lengths, after M. Botsch and L. Kobbelt, A
//! remeshing approach to multiresolution modeling, Symp. Geometry Processing 2004, 189. Vertices move on the flat
//! triangles of the input, and in the end each is put on the smooth surface over its place (D. R. Clark, N. Ray and X. Jiao,
//! Proc. 21st Int. Meshing Roundtable (2012) 99): fits are those of the input, and errors do not accumulate.

mod ground;
mod passes;

use crate::edit::Edited;
use crate::element::Execution;
use crate::face_tree::MeshPoint;
use crate::mesh::TriangleMesh;
use crate::real::Real;
use crate::self_crossing::crossing_triangles;
use crate::smooth_surface::{SmoothPoint, SmoothSurface};
use crate::surface::Surface;
use alloc::vec::Vec;
use ground::InputSurface;
use passes::Remesher;

/// Least number of rounds before they may end early.
const SETTLING: usize = 4;

/// Rounds end early if fewer than one in this number of vertices was made or removed.
const FEW: usize = 50;

/// Number of rounds of Delaunay flips at the end, and of rounds that widen angles after them.
const LAST: usize = 3;

/// The cosine of the angle below which angles are widened: 40°.
const WIDE: f64 = 0.766;

/// Most passes that move vertices of triangles that cross or are turned onto the flat ones.
const RETREATS: usize = 8;

/// The settings of [`SmoothSurface::remesh`].
#[derive(Clone, Copy, Debug)]
pub struct Remeshing<'a, T> {
    /// The edge length that is wanted at each vertex of the input, above 0.
    pub sizes: &'a [T],
    /// The number of vertices, to which lengths are scaled; `None` for the number that lengths imply.
    pub vertices: Option<usize>,
    /// Most rounds of splits, collapses, flips and movements; they end early when few vertices change.
    pub rounds: usize,
}

impl<T> Remeshing<'_, T> {
    /// More rounds than this change little.
    pub const ROUNDS: usize = 10;
}

/// A new mesh of a surface.
#[derive(Clone, Debug)]
pub struct Remeshed<T> {
    /// The mesh.
    pub mesh: TriangleMesh,
    /// The place of each vertex on the input.
    pub places: Vec<MeshPoint<T>>,
    /// The point there: position, normal, curvatures, error bars. It is that of the flat triangle where `position_error` of
    /// the smooth surface is not small against the edges of the input, and at and beside triangles that would cross others
    /// or be turned; elsewhere that of the smooth surface.
    pub points: Vec<SmoothPoint<T>>,
    /// Pairs of triangles that cross each other, because the input has such pairs, or because it is thinner than the
    /// wanted edges.
    pub crossings: Vec<[u32; 2]>,
}

impl<T: Real> SmoothSurface<T> {
    /// A new mesh of this surface with edges of wanted lengths. Calls `go_on` with the part that is done; `None` if that
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
        let ground = InputSurface::new(self.surface(), self.lines(), settings.sizes);
        let mut state = Remesher::new(ground);
        let number = |count: usize| T::constant(count as f64);
        let expected = state.equilateral_count();
        let most = settings.rounds + LAST;
        let mut go_on = |round: usize| go_on(round as f64 / most as f64);
        for round in 0..settings.rounds {
            if !go_on(round) {
                return None;
            }
            let [vertices, triangles] =
                [state.vertex_count(), state.edited.triangle_count()].map(number);
            match settings.vertices.map(number) {
                // The first factor, from the expected number of triangles: a mesh has half as many vertices.
                Some(wanted) if round == 0 => state.scale(expected / number(2), wanted),
                Some(wanted) => state.scale(vertices, wanted),
                None if round == 0 => {}
                None => state.scale(triangles, expected),
            }
            let changed = state.split_long() + state.collapse_short();
            state.flip_to_valence();
            state.smooth();
            if round + 1 >= SETTLING && changed < state.vertex_count() / FEW {
                break;
            }
        }
        for round in settings.rounds..most {
            if !go_on(round) {
                return None;
            }
            if let Some(wanted) = settings.vertices {
                state.bring_to(wanted);
            }
            state.flip_to_delaunay();
            state.smooth();
        }
        for _ in 0..LAST {
            state.widen_angles(T::constant(WIDE));
            state.flip_to_delaunay();
        }
        let mut crossings = Vec::new();
        for _ in 0..RETREATS {
            state.settle(execution, self);
            state.turn_back(self);
            let edited = state.edited.clone().finish();
            let used = edited.vertices.iter();
            let positions = used.map(|&vertex| state.points[vertex as usize].position);
            let positions = Vec::from_iter(positions);
            crossings = crossing_triangles(Surface::of_checked(&edited.mesh, &positions, None));
            let crossing = crossings.as_flattened().iter();
            let corners = crossing.flat_map(|&triangle| edited.mesh.triangles()[triangle as usize]);
            let crossing = corners.map(|corner| edited.vertices[corner as usize]);
            if !state.retreat(crossing.chain(state.turned().into_iter().flatten())) {
                break;
            }
        }
        let Edited { mesh, vertices } = state.edited.clone().finish();
        let used = || vertices.iter().map(|&vertex| vertex as usize);
        Some(Remeshed {
            mesh,
            places: used().map(|vertex| state.places[vertex]).collect(),
            points: used().map(|vertex| state.points[vertex]).collect(),
            crossings,
        })
    }
}
