//! Edge-based mean curvature: dihedral angles times edge lengths.
//!
//! F. Jülicher, J. Phys. II France 6 (1996) 1797. The gradient is our own.

use crate::bending::MaterialParameter;
use crate::curvature::{Curvature, Curvatures};
use crate::diagnostic::Finding;
use crate::element::{Corners, ElementKernel, Execution, of_vertices};
use crate::hinge::{Hinge, Hinges};
use crate::lane::Lane;
use crate::laplacian::{Cotangent, VertexSums};
use crate::mesh::{TriangleMesh, VertexKind};
use crate::method::{Method, ParameterError, TwoPass, Workspace};
use crate::real::{Real, finite_or_zero};
use crate::surface::Surface;
use crate::triangle::DualArea;
use alloc::vec::Vec;

/// `E = 2 Σ_i κ_i (H_i − H0_i)² A_i` with `H_i = M_i/A_i`, `M_i = ¼ Σ_edges l θ` over the edges at the
/// vertex. l is the length of an edge, θ the angle between the normals of its two triangles,
/// positive where the surface is convex, and A_i a third of the area of the triangles around the
/// vertex. The force is the exact gradient of this energy.
///
/// The sum runs over interior vertices, but forces act on all vertices. Boundary edges and edges at
/// a triangle without area have no angle. A vertex with `A_i = 0` is left out, and reported by
/// [`Method::inspect`].
///
/// The energy converges only on meshes of even triangles. At the vertices of valence five of an
/// icosphere H does not converge: its error is 14.6 %. The angle at an edge depends on the
/// curvature in one direction, and five equally weighted directions do not average to the mean
/// curvature.
#[derive(Clone, Debug, PartialEq)]
pub struct Juelicher<T> {
    /// Bending modulus κ, in units of energy.
    pub modulus: MaterialParameter<T>,
    /// Spontaneous curvature H0.
    pub spontaneous_curvature: MaterialParameter<T>,
}

/// Memory of [`Juelicher`].
#[derive(Clone, Debug)]
pub struct JuelicherMemory<T> {
    hinges: Hinges,
    /// Used by curvatures only.
    cotangent: VertexSums<T>,
    /// M and A, then H and A.
    curvature: Vec<[T; 2]>,
    /// −∂E/∂M and −∂E/∂A.
    weights: Vec<[T; 2]>,
}

impl<T: Real> Juelicher<T> {
    /// The method without spontaneous curvature.
    pub fn new(modulus: T) -> Self {
        Self {
            modulus: modulus.into(),
            spontaneous_curvature: MaterialParameter::default(),
        }
    }

    /// H − H0; 0 where the vertex is left out.
    fn excess(&self, mesh: &TriangleMesh, curvature: &[[T; 2]], vertex: usize) -> T {
        let [mean, area] = curvature[vertex];
        let interior = mesh.is_interior(vertex);
        if interior && area.reciprocal_or_zero() > T::zero() {
            mean - self.spontaneous_curvature.at(vertex)
        } else {
            T::zero()
        }
    }
}

/// `¼ l θ` for both ends of an edge.
struct LengthTimesAngle;

impl<T: Real> ElementKernel<T, 4, 0, 2> for LengthTimesAngle {
    #[inline(always)]
    fn evaluate(
        &self,
        _first: usize,
        corners: &Corners<T, 4>,
        _input: &[[T; 0]; 4],
    ) -> [[T; 2]; 4] {
        let hinge = Hinge::new(corners);
        let share = T::constant(0.25) * hinge.edge_length * hinge.angle();
        let (end, opposite) = ([share, T::zero()], [T::zero(); 2]);
        [end, end, opposite, opposite]
    }
}

/// A third of a triangle's area for each corner.
struct ThirdOfArea;

impl<T: Real> ElementKernel<T, 3, 0, 2> for ThirdOfArea {
    #[inline(always)]
    fn evaluate(
        &self,
        _first: usize,
        corners: &Corners<T, 3>,
        _input: &[[T; 0]; 3],
    ) -> [[T; 2]; 3] {
        let third = corners.triangle().doubled_area * T::constant(1.0 / 6.0);
        [[T::zero(), third]; 3]
    }
}

/// Contributions of the change of `l θ` to the corners of a hinge.
struct HingeForce;

impl<T: Real> ElementKernel<T, 4, 2, 3> for HingeForce {
    /// `u ∂(l θ)` with u = ¼ (w_a + w_b) of the two ends.
    #[inline(always)]
    fn evaluate(
        &self,
        _first: usize,
        corners: &Corners<T, 4>,
        weights: &[[T; 2]; 4],
    ) -> [[T; 3]; 4] {
        let weight = T::constant(0.25) * (weights[0][0] + weights[1][0]);
        Hinge::new(corners).length_times_angle_gradient(corners, weight)
    }
}

/// Contributions of the change of a triangle's area to its corners.
struct AreaForce;

impl<T: Real> ElementKernel<T, 3, 2, 3> for AreaForce {
    /// `⅓ Σ w ∂A`.
    #[inline(always)]
    fn evaluate(
        &self,
        _first: usize,
        corners: &Corners<T, 3>,
        weights: &[[T; 2]; 3],
    ) -> [[T; 3]; 3] {
        let sixth = T::constant(1.0 / 6.0) * (weights[0][1] + weights[1][1] + weights[2][1]);
        corners.triangle().outward_edges(sixth)
    }
}

impl<T: Real> Method<T> for Juelicher<T> {
    type Memory = JuelicherMemory<T>;

    fn memory(&self, mesh: &TriangleMesh) -> JuelicherMemory<T> {
        JuelicherMemory {
            hinges: Hinges::new(mesh),
            cotangent: VertexSums::default(),
            curvature: Vec::new(),
            weights: Vec::new(),
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        MaterialParameter::check(&self.modulus, &self.spontaneous_curvature)
    }

    fn inspect(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        report: &mut dyn FnMut(Finding),
    ) {
        let memory = workspace.for_mesh(surface.mesh());
        surface.report_uneven_mesh(report);
        surface.report_valences(report);
        surface.report_rough_vertices(report);
        let is_interior = |vertex: usize| surface.mesh().is_interior(vertex);
        let area = |vertex: usize| {
            let [_, area] = memory.curvature.get(vertex)?;
            is_interior(vertex).then_some(*area)
        };
        surface.report_areas(DualArea::Barycentric, area, report);
    }
}

/// H is 0 at vertices that are not interior or have no area; n and K are those of [`Cotangent`] with
/// barycentric areas.
impl<T: Real> Curvatures<T> for Juelicher<T> {
    fn curvatures(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        curvature: &mut [Curvature<T>],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.measure(execution, surface, memory);
        let curvature = of_vertices(surface, curvature);
        let cotangent = Cotangent::new(DualArea::Barycentric);
        cotangent.sum(execution, surface, &mut memory.cotangent, curvature);
        let means = &memory.curvature;
        execution.map(curvature, |vertex, curvature| {
            curvature.mean = means[vertex][0]
        });
    }
}

impl<T: Real> TwoPass for Juelicher<T> {
    type Scalar = T;

    /// M_i and A_i, then H_i in the place of M_i.
    fn measure(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut JuelicherMemory<T>,
    ) {
        let mesh = surface.mesh();
        let Self {
            modulus,
            spontaneous_curvature,
        } = self;
        MaterialParameter::expect(self, modulus, spontaneous_curvature, mesh);
        let JuelicherMemory {
            hinges, curvature, ..
        } = memory;
        curvature.clear();
        curvature.resize(mesh.vertex_count(), [T::zero(); 2]);
        execution.scatter(&LengthTimesAngle, surface, &hinges.vertices, &[], curvature);
        execution.scatter(&ThirdOfArea, surface, mesh.triangles(), &[], curvature);
        execution.map(&mut curvature[..], |vertex, entry| {
            let over = match mesh.vertex_kind(vertex) {
                VertexKind::Interior => entry[1].reciprocal_or_zero(),
                VertexKind::Boundary | VertexKind::Isolated => T::zero(),
            };
            [entry[0]] = finite_or_zero([entry[0] * over]);
        });
    }

    fn measured_energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut JuelicherMemory<T>,
    ) -> T {
        let curvature = &memory.curvature;
        let sum = execution.sum(curvature.len(), |vertex| {
            let excess = self.excess(surface.mesh(), curvature, vertex);
            let [term] = finite_or_zero([excess * excess * curvature[vertex][1]]);
            self.modulus.at(vertex) * term
        });
        T::constant(2.0) * sum
    }

    /// `dE = Σ 4κ (H − H0) dM − 2κ (H² − H0²) dA`.
    fn add_measured_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut JuelicherMemory<T>,
        force: &mut [[T; 3]],
    ) {
        let mesh = surface.mesh();
        let JuelicherMemory {
            hinges,
            curvature,
            weights,
            ..
        } = memory;
        weights.resize(curvature.len(), [T::zero(); 2]);
        execution.map(&mut weights[..], |vertex, weight| {
            let doubled = T::constant(2.0) * self.modulus.at(vertex);
            let excess = doubled * self.excess(mesh, curvature, vertex);
            let sum = curvature[vertex][0] + self.spontaneous_curvature.at(vertex);
            *weight = finite_or_zero([-(excess + excess), excess * sum]);
        });
        execution.scatter(&HingeForce, surface, &hinges.vertices, weights, force);
        execution.scatter(&AreaForce, surface, mesh.triangles(), weights, force);
        execution.map(&mut force[..weights.len()], |_, force| {
            *force = finite_or_zero(*force);
        });
    }
}
