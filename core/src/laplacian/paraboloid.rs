//! The paraboloid fit: the operator of method E.
//!
//! A. Farutin, T. Biben and C. Misbah, J. Comput. Phys. 275 (2014) 539.

mod fits;

use crate::curvature::{Curvature, Curvatures};
use crate::diagnostic::Finding;
use crate::element::{Execution, of_vertices};
use crate::laplacian::{Cotangent, LaplaceBeltrami, Rows, VertexSums, expect_measured};
use crate::mesh::TriangleMesh;
use crate::mesh_identity::expect_parameter;
use crate::method::{Method, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use crate::triangle::DualArea;
use crate::vec3::dot;
use alloc::vec::Vec;
use fits::{Fits, Scratch};

/// At each vertex the least-squares paraboloid `z = a x + b y + ½ c x² + d x y + ½ e y²` through
/// the vertex and near its neighbours, in a frame whose z axis is iterated until it is the normal
/// of the paraboloid. With `w = 1 + a² + b²`
///
/// `H = −[(1+a²) e − 2ab d + (1+b²) c] / (2 w^{3/2})`,  `K = (c e − d²)/w²`,
///
/// and a field's paraboloid by the same fit gives
/// `Δ_S φ = (1 − a²/w) φ_xx − 2ab/w φ_xy + (1 − b²/w) φ_yy + 2H (a φ_x + b φ_y)/√w`.
///
/// * Pointwise, not symmetric. The area is the mixed area.
/// * The neighbours are the one-ring, or two rings if the one-ring has fewer than five vertices.
/// * Five neighbours near a conic section through the vertex do not determine a paraboloid, and
///   values grow without bound. This is the published method; [`Paraboloid::guarded`] avoids it.
/// * At a boundary vertex the fit is one-sided, and defines H and K there.
/// * Where the neighbours do not determine a paraboloid at all, because two rings have fewer than
///   five vertices (a tetrahedron) or by symmetry (an octahedron), the row is empty and H = K = 0;
///   [`Method::inspect`] reports it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Paraboloid {
    /// Whether two rings are also used where the one-ring nearly fails to determine the fit. The
    /// criterion is amplification by its row: `Σ_j |c_ij| |x_j − x_i|² > 10`. Without the absolute
    /// values this sum is 4 for a row that is exact for paraboloids; with positive coefficients the
    /// absolute values change nothing.
    pub guarded: bool,
}

/// Unknowns of the fit, and the fewest neighbours that can determine them.
const COEFFICIENTS: usize = 5;

/// Amplification above which a guarded fit takes two rings. Unlike diagonal entries of triangular
/// factors, it does not depend on the orientation of the frame.
const AMPLIFIED: f64 = 10.0;

impl Paraboloid {
    /// The operator with two rings where one ring is nearly singular.
    pub fn guarded() -> Self {
        Self { guarded: true }
    }

    fn expect<T: Real>(self, memory: &ParaboloidMemory<T>) {
        expect_parameter::<Self, _>("`guarded`", memory.guarded, self.guarded);
    }
}

/// Memory of [`Paraboloid`]: the rows of the surface that was measured last.
#[derive(Clone, Debug)]
pub struct ParaboloidMemory<T> {
    guarded: bool,
    /// Start of each row, whose capacity is the largest number of neighbours it can have, and the
    /// end of the last.
    offsets: Vec<usize>,
    cotangent: VertexSums<T>,
    rows: Rows<T>,
    scratches: Vec<Scratch<T>>,
}

impl<T: Real> Method<T> for Paraboloid {
    type Memory = ParaboloidMemory<T>;

    fn memory(&self, mesh: &TriangleMesh) -> ParaboloidMemory<T> {
        let mut offsets = Vec::with_capacity(mesh.vertex_count() + 1);
        let mut end = 0;
        offsets.push(end);
        for vertex in 0..mesh.vertex_count() {
            let ring = mesh.one_ring(vertex);
            // An upper bound, because some vertices lie in both rings or are neighbours of several.
            let both = ring.len()
                + ring
                    .iter()
                    .map(|&v| mesh.valence(v as usize))
                    .sum::<usize>();
            let one = !self.guarded && ring.len() >= COEFFICIENTS;
            end += if one { ring.len() } else { both };
            offsets.push(end);
        }
        ParaboloidMemory {
            guarded: self.guarded,
            offsets,
            cotangent: VertexSums::default(),
            rows: Rows::new(),
            scratches: Vec::new(),
        }
    }

    fn inspect(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        report: &mut dyn FnMut(Finding),
    ) {
        let memory = workspace.for_mesh(surface.mesh());
        surface.report_uneven_mesh(report);
        surface.report_rough_vertices(report);
        for vertex in 0..memory.rows.len() {
            let isolated = surface.mesh().one_ring(vertex).is_empty();
            let (columns, coefficients) = memory.rows.row(vertex);
            let place = vertex as u32;
            if !isolated && columns.is_empty() {
                report(Finding::TooFewNeighbours { vertex: place });
            }
            let parts = columns.iter().zip(coefficients);
            let amplification: T = parts
                .map(|(&column, &coefficient)| {
                    let offset = surface.difference(place, column);
                    coefficient.abs() * dot(offset, offset)
                })
                .sum();
            if amplification > T::constant(AMPLIFIED) {
                report(Finding::Amplified { vertex: place });
            }
        }
    }
}

impl<T: Real> Curvatures<T> for Paraboloid {
    fn curvatures(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        curvature: &mut [Curvature<T>],
    ) {
        let mesh = surface.mesh();
        let memory = workspace.for_mesh_mut(mesh);
        self.expect(memory);
        let ParaboloidMemory {
            offsets,
            cotangent,
            rows,
            scratches,
            ..
        } = memory;
        let curvature = of_vertices(surface, curvature);
        // Areas, and initial normals.
        Cotangent::new(DualArea::Mixed).sum(execution, surface, cotangent, curvature);
        let slots = rows.ragged_slots(offsets);
        let fits = Fits {
            guarded: self.guarded,
            surface,
        };
        execution.run(scratches, (curvature, slots), &fits);
    }
}

impl<T: Real> LaplaceBeltrami<T> for Paraboloid {
    fn apply<const D: usize>(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        field: &[[T; D]],
        laplacian: &mut [[T; D]],
    ) {
        let memory = workspace.for_mesh(surface.mesh());
        self.expect(memory);
        expect_measured(memory.rows.len(), surface.mesh().vertex_count());
        memory.rows.apply(execution, field, laplacian);
    }

    fn assemble(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        rows: &mut Rows<T>,
    ) {
        let memory = workspace.for_mesh(surface.mesh());
        self.expect(memory);
        expect_measured(memory.rows.len(), surface.mesh().vertex_count());
        rows.clone_from(&memory.rows);
    }
}
