//! Nodal forces freed of their net force and torque.

use crate::components::Components;
use crate::curvature::{Curvature, Curvatures};
use crate::diagnostic::Finding;
use crate::element::{Execution, of_vertices};
use crate::lane::Lane;
use crate::laplacian::Cotangent;
use crate::mesh::TriangleMesh;
use crate::method::{Energy, Force, ForceDensity, Method, ParameterError, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use crate::triangle::DualArea;
use crate::vec3::{Vec3, add, cross, dot, scale, sub};
use alloc::vec::Vec;

/// The rigid body of one component, and the force field that cancels its net force and torque.
#[derive(Clone, Copy, Debug, Default)]
pub struct RigidBody<T> {
    /// A vertex, from which positions are taken.
    origin: Option<u32>,
    /// ΣA.
    area: T,
    /// ΣA x/ΣA, from the origin.
    centre: Vec3<T>,
    /// Largest distance from the origin: the unit of length of what follows.
    radius: T,
    /// ΣF/ΣA.
    translation: Vec3<T>,
    torque: Vec3<T>,
    /// `xx yy zz yz zx xy` of ΣA (|r|² 1 − r rᵀ)/ΣA.
    inertia: [T; 6],
    /// I⁻¹ Σ r × F/ΣA.
    rotation: Vec3<T>,
}

impl<T: Real> RigidBody<T> {
    /// Position from the centre, in units of the radius.
    fn arm(&self, surface: Surface<'_, T>, vertex: u32) -> Vec3<T> {
        let from_origin = surface.difference(self.origin.unwrap_or(vertex), vertex);
        let from_centre = sub(from_origin, self.centre);
        scale(self.radius.reciprocal_or_zero(), from_centre)
    }

    /// Force per area at a vertex.
    fn density(&self, surface: Surface<'_, T>, vertex: u32) -> Vec3<T> {
        add(
            self.translation,
            cross(self.rotation, self.arm(surface, vertex)),
        )
    }
}

/// Removes from nodal forces the part that accelerates or spins each connected component as a rigid
/// body:
///
/// `F_i −= A_i (a + b × (x_i − x_c))`, `a = ΣF/ΣA`, `b = I⁻¹ Σ (x − x_c) × F`,
/// `I = ΣA (|d|² 1 − d dᵀ)`, `x_c = ΣA x/ΣA`, `d = x − x_c`.
///
/// Afterwards ΣF = 0 and Σ x × F = 0 in each component, to rounding. If all vertices lie on a line,
/// the rotation about it, which moves no vertex, is left out. A component without area keeps its
/// forces. `areas` are the A_i, one per vertex; `bodies` is memory that is reused.
///
/// # Panics
/// If `components`, `areas` or `force` have fewer entries than the surface has vertices.
pub fn remove_net_force_and_torque<T: Real>(
    components: &Components,
    surface: Surface<'_, T>,
    areas: &[T],
    bodies: &mut Vec<RigidBody<T>>,
    force: &mut [[T; 3]],
) {
    set_bodies(components, surface, areas, bodies, |vertex| force[vertex]);
    for (vertex, force) in force[..areas.len()].iter_mut().enumerate() {
        let body = &bodies[components.of_vertex()[vertex] as usize];
        let density = body.density(surface, vertex as u32);
        *force = sub(*force, scale(areas[vertex], density));
    }
}

/// Sets the rigid body of each component. Sums run over the vertices in their order, so that
/// results do not depend on threads.
fn set_bodies<T: Real>(
    components: &Components,
    surface: Surface<'_, T>,
    areas: &[T],
    bodies: &mut Vec<RigidBody<T>>,
    force: impl Fn(usize) -> Vec3<T>,
) {
    bodies.clear();
    bodies.resize(components.count(), RigidBody::default());
    let vertices = || {
        components
            .of_vertex()
            .iter()
            .map(|&body| body as usize)
            .enumerate()
    };
    for (vertex, body) in vertices() {
        let body = &mut bodies[body];
        let origin = *body.origin.get_or_insert(vertex as u32);
        let from_origin = surface.difference(origin, vertex as u32);
        body.area += areas[vertex];
        body.centre = add(body.centre, scale(areas[vertex], from_origin));
        body.translation = add(body.translation, force(vertex));
        body.radius = body.radius.max(dot(from_origin, from_origin).sqrt());
    }
    for body in bodies.iter_mut() {
        let over = body.area.reciprocal_or_zero();
        body.centre = scale(over, body.centre);
        body.translation = scale(over, body.translation);
    }
    for (vertex, body) in vertices() {
        let body = &mut bodies[body];
        let arm = body.arm(surface, vertex as u32);
        let over = body.area.reciprocal_or_zero();
        let share = areas[vertex] * over;
        let [x, y, z] = arm;
        let products = [
            y * y + z * z,
            z * z + x * x,
            x * x + y * y,
            -y * z,
            -z * x,
            -x * y,
        ];
        for (sum, product) in body.inertia.iter_mut().zip(products) {
            *sum += share * product;
        }
        body.torque = add(body.torque, scale(over, cross(arm, force(vertex))));
    }
    for body in bodies.iter_mut() {
        body.rotation = solve_symmetric(body.inertia, body.torque);
    }
}

/// A solution of `M b = t` for a symmetric, positive semi-definite M, given as `xx yy zz yz zx xy`,
/// and a t in its range: elimination with the largest pivot first. Unknowns whose pivot is lost in
/// rounding are 0.
fn solve_symmetric<T: Real>([xx, yy, zz, yz, zx, xy]: [T; 6], t: Vec3<T>) -> Vec3<T> {
    let mut matrix = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
    let mut right = t;
    let noise = T::constant(16.0) * T::epsilon() * (xx + yy + zz);
    let mut pivots = [None; 3];
    for place in 0..3 {
        let left = (0..3).filter(|k| !pivots.contains(&Some(*k)));
        let larger = |best: usize, k: usize| {
            if matrix[k][k] > matrix[best][best] {
                k
            } else {
                best
            }
        };
        let Some(pivot) = left.reduce(larger).filter(|&k| matrix[k][k] > noise) else {
            break;
        };
        pivots[place] = Some(pivot);
        for row in 0..3 {
            if pivots.contains(&Some(row)) {
                continue;
            }
            let factor = matrix[row][pivot] / matrix[pivot][pivot];
            matrix[row] = sub(matrix[row], scale(factor, matrix[pivot]));
            right[row] -= factor * right[pivot];
        }
    }
    let mut solution = [T::zero(); 3];
    for pivot in pivots.into_iter().rev().flatten() {
        // The unknown of the pivot itself is still 0 and does not contribute.
        let known = dot(matrix[pivot], solution);
        solution[pivot] = (right[pivot] - known) / matrix[pivot][pivot];
    }
    solution
}

/// A method whose forces are freed of net force and torque in each connected component, with mixed
/// areas as weights: see [`remove_net_force_and_torque`].
///
/// For methods that are not the gradient of an energy; an exact gradient has no net force or
/// torque. The same field per area is removed from force densities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projected<M>(pub M);

/// Memory of [`Projected`].
#[derive(Clone, Debug)]
pub struct ProjectedMemory<T, W> {
    /// The workspace of the method itself.
    pub method: W,
    components: Components,
    areas: Vec<T>,
    bodies: Vec<RigidBody<T>>,
    force: Vec<[T; 3]>,
}

impl<T: Real, M: Method<T>> Method<T> for Projected<M> {
    type Memory = ProjectedMemory<T, Workspace<T, M>>;

    fn memory(&self, mesh: &TriangleMesh) -> Self::Memory {
        ProjectedMemory {
            method: self.0.workspace(mesh),
            components: Components::new(mesh),
            areas: Vec::new(),
            bodies: Vec::new(),
            force: Vec::new(),
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.0.check()
    }

    fn inspect(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        report: &mut dyn FnMut(Finding),
    ) {
        let memory = workspace.for_mesh(surface.mesh());
        self.0.inspect(surface, &memory.method, report);
    }
}

impl<T: Real, M: Curvatures<T>> Curvatures<T> for Projected<M> {
    fn curvatures(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        curvature: &mut [Curvature<T>],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.0
            .curvatures(execution, surface, &mut memory.method, curvature);
    }
}

impl<T: Real, M: Energy<T>> Energy<T> for Projected<M> {
    fn energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
    ) -> T {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.0.energy(execution, surface, &mut memory.method)
    }
}

impl<T: Real, W> ProjectedMemory<T, W> {
    fn set_areas(&mut self, execution: &impl Execution, surface: Surface<'_, T>) {
        self.areas.resize(surface.mesh().vertex_count(), T::zero());
        Cotangent::new(DualArea::Mixed).dual_areas(execution, surface, &mut self.areas);
    }
}

impl<T: Real, M: Force<T>> Force<T> for Projected<M> {
    fn add_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        memory.set_areas(execution, surface);
        let ProjectedMemory {
            method,
            components,
            areas,
            bodies,
            force: own,
        } = memory;
        own.clear();
        own.resize(areas.len(), [T::zero(); 3]);
        self.0.add_force(execution, surface, method, own);
        remove_net_force_and_torque(components, surface, areas, bodies, own);
        execution.map(of_vertices(surface, force), |vertex, force| {
            *force = add(*force, own[vertex]);
        });
    }
}

impl<T: Real, M: ForceDensity<T>> ForceDensity<T> for Projected<M> {
    fn force_density(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        density: &mut [[T; 3]],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        memory.set_areas(execution, surface);
        let ProjectedMemory {
            method,
            components,
            areas,
            bodies,
            ..
        } = memory;
        self.0.force_density(execution, surface, method, density);
        let density = of_vertices(surface, density);
        let force = |vertex: usize| scale(areas[vertex], density[vertex]);
        set_bodies(components, surface, areas, bodies, force);
        execution.map(density, |vertex, density| {
            let body = &bodies[components.of_vertex()[vertex] as usize];
            *density = sub(*density, body.density(surface, vertex as u32));
        });
    }
}
