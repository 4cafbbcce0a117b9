//! Method S: the Helfrich energy of a Loop subdivision surface.
//!
//! F. Cirak, M. Ortiz, P. Schröder, Int. J. Numer. Meth. Eng. 47 (2000) 2039; F. Feng and
//! W. S. Klug, J. Comput. Phys. 220 (2006) 394. Control points that are not the nodes, the exact
//! bases around extraordinary vertices and the form of the gradient are our own.

mod consistent;
mod controls;
mod evaluation;
mod patches;

pub use consistent::ConsistentMemory;
pub use controls::ControlPoints;

use self::controls::ControlMap;
use self::evaluation::PatchMemory;
use self::patches::{Field, Patches};
use crate::bending::MaterialParameter;
use crate::curvature::{Curvature, Curvatures};
use crate::diagnostic::Finding;
use crate::element::{Execution, of_vertices};
use crate::lane::Lane;
use crate::mesh::{TriangleMesh, VertexKind};
use crate::mesh_identity::expect_parameter;
use crate::method::{Conservative, Energy, Force, ForceDensity, Method, ParameterError, Workspace};
use crate::real::{Real, finite_or_zero};
use crate::subdivision::{Stencils, basis, limit_normal, limit_positions};
use crate::surface::Surface;
use crate::vec3::{add, dot, scale};
use alloc::vec::Vec;

/// `E = 2 ∫ κ (H − H0)² dS` over the limit surface of Loop subdivision, by three quadrature points
/// per triangle, and the exact gradient of this sum with respect to the nodes.
///
/// The control points follow from the nodes by a linear map, `C = QX`, and the nodal forces are
/// `F_X = Qᵀ F_C`: see [`ControlPoints`], which decides the accuracy.
///
/// On smooth meshes of valence 6 the energy and f converge with fourth order (with second order for
/// [`ControlPoints::Nodes`]), and H and K at the nodes with second order. At extraordinary vertices
/// forces do not converge on any mesh, while the energy does. On meshes with mostly extraordinary
/// vertices neither converges, unless the mesh is first refined by
/// [`crate::subdivision::Subdivision`].
///
/// Triangles with two or three extraordinary corners are refined once: the surface is the same,
/// with four times the quadrature points. Triangles with a boundary vertex are left out of the
/// energy, because the boundary rules determine the surface over them; the remaining triangles
/// still exert forces on boundary vertices. A mesh without interior triangles has no energy and no
/// forces.
///
/// Spontaneous curvature that is given per vertex is a function in the same basis as the surface,
/// with control values `Q H0`. A bending modulus that is given per vertex is one with the control
/// values κ themselves: Q could make it negative between a soft and a stiff vertex, and basis
/// functions, which are not negative, cannot.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopSubdivision<T> {
    /// Bending modulus κ, in units of energy.
    pub modulus: MaterialParameter<T>,
    /// Spontaneous curvature H0.
    pub spontaneous_curvature: MaterialParameter<T>,
    /// The map from nodes to control points. A workspace depends on it.
    pub controls: ControlPoints,
}

impl<T: Real> LoopSubdivision<T> {
    /// The method with the best control points for most meshes: [`ControlPoints::Hybrid`].
    pub fn new(modulus: T) -> Self {
        Self::with_controls(modulus, ControlPoints::default())
    }

    /// The method with any choice of control points.
    pub fn with_controls(modulus: T, controls: ControlPoints) -> Self {
        Self {
            modulus: modulus.into(),
            spontaneous_curvature: MaterialParameter::default(),
            controls,
        }
    }

    /// Sets `positions` to the points of the limit surface under the nodes, `LQX`.
    ///
    /// # Panics
    /// If `positions` has fewer entries than the surface has vertices, or the surface another mesh
    /// than that of the workspace.
    pub fn limit_positions(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        positions: &mut [[T; 3]],
    ) {
        let LoopSubdivisionMemory { plan, buffers } = self.expect(workspace, surface);
        plan.set_controls(execution, surface, buffers);
        let controls = &buffers.controls;
        let origin = surface.positions()[plan.origin as usize];
        let positions = of_vertices(surface, positions);
        execution.map(positions, |vertex, position| {
            let [x, y, z, _] = plan.limit.at(vertex, controls);
            *position = add(origin, [x, y, z]);
        });
    }

    /// Area and enclosed volume of the limit surface, by the quadrature of the energy; no volume
    /// if the mesh has a boundary.
    ///
    /// # Panics
    /// If the surface has another mesh than that of the workspace.
    pub fn area_and_volume(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
    ) -> (T, Option<T>) {
        let LoopSubdivisionMemory { plan, buffers } = self.expect(workspace, surface);
        self.evaluate::<false>(execution, plan, surface, buffers);
        let controls = &buffers.controls;
        let blocks = &buffers.patches.blocks;
        let area = execution.sum(blocks.len(), |block| blocks[block].area());
        let volume = surface.mesh().is_closed().then(|| {
            let third = T::constant(1.0 / 3.0);
            third
                * execution.sum(plan.patches.len(), |patch| {
                    plan.patches.flux(patch, controls)
                })
        });
        (area, volume)
    }

    /// The workspace's memory, for this surface.
    fn expect<'a>(
        &self,
        workspace: &'a mut Workspace<T, Self>,
        surface: Surface<'_, T>,
    ) -> &'a mut LoopSubdivisionMemory<T> {
        let memory = workspace.for_mesh_mut(surface.mesh());
        let made = memory.plan.control_points;
        expect_parameter::<Self, _>("the control points", made, self.controls);
        let (modulus, spontaneous) = (&self.modulus, &self.spontaneous_curvature);
        MaterialParameter::expect(self, modulus, spontaneous, surface.mesh());
        memory
    }

    /// Controls, patches, and with `GRADIENT` the nodal forces and masses in `buffers.nodal`.
    fn evaluate<const GRADIENT: bool>(
        &self,
        execution: &impl Execution,
        plan: &Plan<T>,
        surface: Surface<'_, T>,
        buffers: &mut Buffers<T>,
    ) {
        plan.set_controls(execution, surface, buffers);
        let (modulus, spontaneous) = (&self.modulus, &self.spontaneous_curvature);
        let spontaneous = if spontaneous.varies() {
            plan.set_field(execution, spontaneous.values(), &mut buffers.field);
            Field::Controlled(&buffers.field.controls)
        } else {
            Field::Constant(spontaneous.at(0))
        };
        let modulus = if modulus.varies() {
            plan.set_control_values(execution, modulus.values(), &mut buffers.moduli);
            Field::Controlled(&buffers.moduli)
        } else {
            Field::Constant(modulus.at(0))
        };
        let patches = &plan.patches;
        patches.evaluate::<GRADIENT>(
            execution,
            [modulus, spontaneous],
            &buffers.controls,
            &mut buffers.patches,
        );
        if GRADIENT {
            plan.collect(execution, buffers);
            let Buffers {
                gathered,
                nodal,
                scratch,
                ..
            } = buffers;
            nodal.resize(plan.vertices, [T::zero(); 4]);
            let on_controls = &gathered[..plan.vertices];
            plan.map
                .apply_transpose(execution, on_controls, nodal, scratch);
        }
    }

    fn energy_of(execution: &impl Execution, buffers: &Buffers<T>) -> T {
        let blocks = &buffers.patches.blocks;
        execution.sum(blocks.len(), |block| blocks[block].energy)
    }
}

/// Results that follow from the mesh.
#[derive(Clone, Debug)]
struct Plan<T> {
    control_points: ControlPoints,
    vertices: usize,
    /// The vertex relative to which positions are stored.
    origin: u32,
    map: ControlMap<T>,
    /// From control points to the points of the limit surface.
    limit: Stencils,
    patches: Patches<T>,
    /// First and second derivatives at a vertex of valence 6, from it and its neighbours.
    at_vertex: [[T; 5]; 7],
}

impl<T: Real> Plan<T> {
    fn new(controls: ControlPoints, mesh: &TriangleMesh) -> Self {
        let limit = limit_positions(mesh);
        let mut at_vertex = [[T::zero(); 5]; 7];
        let regular = basis(6, 0.0, 0.0).unwrap_or_default();
        for (derivatives, basis) in at_vertex.iter_mut().zip(&regular) {
            *derivatives = patches::derivatives(basis);
        }
        Self {
            control_points: controls,
            vertices: mesh.vertex_count(),
            origin: mesh.triangles()[0][0],
            map: ControlMap::new(controls, mesh, &limit),
            limit,
            patches: Patches::new(mesh),
            at_vertex,
        }
    }

    /// The control points, relative to the origin, followed by those of the refined triangles.
    fn set_controls(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        buffers: &mut Buffers<T>,
    ) {
        let Buffers {
            controls,
            nodal,
            scratch,
            ..
        } = buffers;
        nodal.resize(self.vertices, [T::zero(); 4]);
        execution.map(&mut nodal[..], |vertex, local| {
            let [x, y, z] = surface.difference(self.origin, vertex as u32);
            *local = [x, y, z, T::zero()];
        });
        controls.resize(self.patches.control_count(), [T::zero(); 4]);
        let (coarse, fine) = controls.split_at_mut(self.vertices);
        self.map.apply(execution, nodal, coarse, scratch);
        self.patches.refine(execution, coarse, fine);
    }

    /// The control values of a quantity given at the vertices.
    fn set_field(&self, execution: &impl Execution, values: &[T], field: &mut FieldBuffers<T>) {
        let FieldBuffers {
            nodal,
            controls,
            scratch,
        } = field;
        nodal.resize(self.vertices, [T::zero()]);
        execution.map(&mut nodal[..], |vertex, nodal| *nodal = [values[vertex]]);
        controls.resize(self.patches.control_count(), [T::zero()]);
        let (coarse, fine) = controls.split_at_mut(self.vertices);
        self.map.apply(execution, nodal, coarse, scratch);
        self.patches.refine(execution, coarse, fine);
    }

    /// The control values of a quantity whose values at the vertices are control values.
    fn set_control_values(
        &self,
        execution: &impl Execution,
        values: &[T],
        controls: &mut Vec<[T; 1]>,
    ) {
        controls.resize(self.patches.control_count(), [T::zero()]);
        let (coarse, fine) = controls.split_at_mut(self.vertices);
        execution.map(&mut *coarse, |vertex, control| *control = [values[vertex]]);
        self.patches.refine(execution, coarse, fine);
    }

    /// Sums the contributions of the patches to their nodes into the first entries of
    /// `buffers.gathered`, one per control point.
    fn collect(&self, execution: &impl Execution, buffers: &mut Buffers<T>) {
        let Buffers {
            patches, gathered, ..
        } = buffers;
        gathered.resize(self.patches.control_count(), [T::zero(); 4]);
        self.patches.gather(execution, &patches.blocks, gathered);
    }

    /// H and K under a vertex.
    fn curvatures_at(&self, mesh: &TriangleMesh, controls: &[[T; 4]], vertex: usize) -> [T; 2] {
        let none = [T::zero(); 2];
        if mesh.vertex_kind(vertex) != VertexKind::Interior {
            return none;
        }
        if mesh.valence(vertex) == 6 {
            let centre = controls[vertex];
            let mut derivatives = [[T::zero(); 4]; 5];
            for (weights, &neighbour) in self.at_vertex[1..].iter().zip(mesh.one_ring(vertex)) {
                let spoke = patches::difference(centre, controls[neighbour as usize]);
                patches::accumulate(&mut derivatives, weights, spoke);
            }
            return patches::point(derivatives).curvatures();
        }
        let mut sum = none;
        let mut count = T::zero();
        for patch in self.patches.around(vertex) {
            let curvatures = self.patches.nearest_point(patch, controls).curvatures();
            sum = [sum[0] + curvatures[0], sum[1] + curvatures[1]];
            count += T::one();
        }
        sum.map(|sum| sum * Lane::reciprocal_or_zero(count))
    }
}

/// Memory of [`LoopSubdivision`].
#[derive(Clone, Debug)]
pub struct LoopSubdivisionMemory<T> {
    plan: Plan<T>,
    buffers: Buffers<T>,
}

impl<T: Real> LoopSubdivisionMemory<T> {
    /// Number of quadrature points: three per triangle, or twelve for a refined triangle.
    pub fn quadrature_points(&self) -> usize {
        3 * self.plan.patches.len()
    }
}

/// Memory of an evaluation.
#[derive(Clone, Debug, Default)]
struct Buffers<T> {
    /// Control points relative to the plan's origin, padded to four numbers.
    controls: Vec<[T; 4]>,
    patches: PatchMemory<T>,
    /// Force and mass at each control point.
    gathered: Vec<[T; 4]>,
    /// Positions, then force and mass at each node.
    nodal: Vec<[T; 4]>,
    scratch: Vec<[T; 4]>,
    /// Spontaneous curvature that varies.
    field: FieldBuffers<T>,
    /// Control values of a bending modulus that varies.
    moduli: Vec<[T; 1]>,
}

/// A quantity at the vertices and its control values.
#[derive(Clone, Debug, Default)]
struct FieldBuffers<T> {
    nodal: Vec<[T; 1]>,
    controls: Vec<[T; 1]>,
    scratch: Vec<[T; 1]>,
}

fn position<T: Real>(controls: &[[T; 4]], vertex: u32) -> [T; 3] {
    let [x, y, z, _] = controls[vertex as usize];
    [x, y, z]
}

impl<T: Real> Method<T> for LoopSubdivision<T> {
    type Memory = LoopSubdivisionMemory<T>;

    /// # Panics
    /// If triangles have to be refined and the mesh is so large that it cannot be; see
    /// [`crate::subdivision::Subdivision::sizes`].
    fn memory(&self, mesh: &TriangleMesh) -> LoopSubdivisionMemory<T> {
        LoopSubdivisionMemory {
            plan: Plan::new(self.controls, mesh),
            buffers: Buffers::default(),
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        MaterialParameter::check(&self.modulus, &self.spontaneous_curvature)
    }

    /// Reports the triangles whose limit surface has no area at a quadrature point, which was left
    /// out. Also reports vertices with an uneven mesh within two edges, because the limit surface
    /// follows the mesh.
    fn inspect(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        report: &mut dyn FnMut(Finding),
    ) {
        let LoopSubdivisionMemory { plan, buffers } = workspace.for_mesh(surface.mesh());
        surface.report_uneven_within(2, report);
        surface.report_rough_vertices(report);
        let without_area = plan.patches.without_area(&buffers.patches.blocks);
        let mut triangles: Vec<u32> = without_area.collect();
        // Refined triangles have several patches.
        triangles.sort_unstable();
        triangles.dedup();
        for triangle in triangles {
            report(Finding::DegenerateTriangle { triangle });
        }
    }
}

/// n, H and K of the limit surface under each node.
///
/// At interior vertices of valence 6, H and K are the exact values of the surface. At extraordinary
/// vertices, where the surface has no curvature, they are means over the nearest quadrature points
/// of the triangles around the vertex, or 0 if all these triangles touch the boundary. At other
/// vertices H and K are 0. The area is `(Qᵀm)_i`, with m the integrals of the basis functions: the
/// areas sum to that of the limit surface over all triangles that count.
impl<T: Real> Curvatures<T> for LoopSubdivision<T> {
    fn curvatures(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        curvature: &mut [Curvature<T>],
    ) {
        let LoopSubdivisionMemory { plan, buffers } = self.expect(workspace, surface);
        self.evaluate::<true>(execution, plan, surface, buffers);
        let mesh = surface.mesh();
        let Buffers {
            controls, nodal, ..
        } = &*buffers;
        execution.map(of_vertices(surface, curvature), |vertex, curvature| {
            let [mean, gaussian] = plan.curvatures_at(mesh, controls, vertex);
            *curvature = Curvature {
                normal: limit_normal(mesh, vertex, |v| position(controls, v)),
                mean,
                gaussian,
                direction: [T::zero(); 3],
                area: nodal[vertex][3],
                kind: mesh.vertex_kind(vertex),
            };
        });
    }
}

impl<T: Real> Energy<T> for LoopSubdivision<T> {
    fn energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
    ) -> T {
        let LoopSubdivisionMemory { plan, buffers } = self.expect(workspace, surface);
        self.evaluate::<false>(execution, plan, surface, buffers);
        Self::energy_of(execution, buffers)
    }
}

impl<T: Real> Force<T> for LoopSubdivision<T> {
    fn add_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) {
        self.add_force_and_energy(execution, surface, workspace, force);
    }
}

impl<T: Real> Conservative<T> for LoopSubdivision<T> {
    fn add_force_and_energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) -> T {
        let LoopSubdivisionMemory { plan, buffers } = self.expect(workspace, surface);
        self.evaluate::<true>(execution, plan, surface, buffers);
        let nodal = &buffers.nodal;
        execution.map(of_vertices(surface, force), |vertex, force| {
            let [x, y, z, _] = nodal[vertex];
            *force = add(*force, finite_or_zero([x, y, z]));
        });
        Self::energy_of(execution, buffers)
    }
}

/// `f_i = F_X,i / (Qᵀm)_i`, with m the integrals of the basis functions: lumped masses. 0 where no
/// triangle counts.
impl<T: Real> ForceDensity<T> for LoopSubdivision<T> {
    fn force_density(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        density: &mut [[T; 3]],
    ) {
        let LoopSubdivisionMemory { plan, buffers } = self.expect(workspace, surface);
        self.evaluate::<true>(execution, plan, surface, buffers);
        let nodal = &buffers.nodal;
        execution.map(of_vertices(surface, density), |vertex, density| {
            let [x, y, z, mass] = nodal[vertex];
            *density = scale(Lane::reciprocal_or_zero(mass), [x, y, z]);
        });
    }
}

/// Scalar product of the first three components.
fn dot_of<T: Real>(a: [T; 4], b: [T; 4]) -> T {
    dot([a[0], a[1], a[2]], [b[0], b[1], b[2]])
}
