//! The Helfrich force density in strong form, over any Laplace–Beltrami operator. With the
//! cotangent operator it is method C, after Meyer et al.
//!
//! Z.-C. Ou-Yang and W. Helfrich, Phys. Rev. A 39 (1989) 5280.

use crate::element::Execution;
use crate::energy::{Energy, Finding, Force, ForceDensity, Method};
use crate::laplacian::{Cotangent, Curvature, HeatKernel, Jet, LaplaceBeltrami, Paraboloid};
use crate::mesh::TriangleMesh;
use crate::real::Real;
use crate::surface::Surface;
use crate::triangle::DualArea;
use crate::vec3::{add, scale};
use alloc::vec::Vec;

/// `f = 2κ [Δ_S H + 2H (H² − K)] n`, with Δ_S, H, K and n of one operator; nodal forces
/// `F_i = f_i A_i`.
///
/// Not the gradient of a discrete energy: forces sum to zero only as the mesh is refined. The
/// energy that goes with it is `2κ Σ H_i² A_i`, a quadrature of `2κ ∫ H² dS` over interior vertices.
///
/// f is defined where the vertex and all its neighbours are interior, and 0 elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrongForm<T, L> {
    /// Bending modulus κ, in units of energy.
    pub modulus: T,
    /// The operator.
    pub operator: L,
}

impl<T: Real, L> StrongForm<T, L> {
    /// Over any operator.
    pub fn new(modulus: T, operator: L) -> Self {
        Self { modulus, operator }
    }
}

impl<T: Real> StrongForm<T, Cotangent> {
    /// Method C: the cotangent operator with mixed areas.
    pub fn meyer(modulus: T) -> Self {
        Self::new(modulus, Cotangent::new(DualArea::Mixed))
    }
}

impl<T: Real> StrongForm<T, HeatKernel<T>> {
    /// Method D: the heat kernel with a bandwidth of each vertex's mixed area.
    pub fn belkin(modulus: T) -> Self {
        Self::new(modulus, HeatKernel::default())
    }
}

impl<T: Real> StrongForm<T, Paraboloid> {
    /// Method E: paraboloids fitted to one-rings, as published; [`Paraboloid::guarded`] is the
    /// operator that also withstands one-rings near a conic section.
    pub fn farutin(modulus: T) -> Self {
        Self::new(modulus, Paraboloid::default())
    }
}

impl<T: Real> StrongForm<T, Jet<T>> {
    /// Method J of degree 6: [`Jet::j6`].
    pub fn j6(modulus: T) -> Self {
        Self::new(modulus, Jet::j6())
    }

    /// Method J of degree 4: [`Jet::j4`].
    pub fn j4(modulus: T) -> Self {
        Self::new(modulus, Jet::j4())
    }
}

/// Memory of [`StrongForm`], and what its last evaluation found.
#[derive(Clone, Debug)]
pub struct StrongFormMemory<T, M> {
    operator: M,
    curvature: Vec<Curvature<T>>,
    mean: Vec<T>,
    laplacian_of_mean: Vec<T>,
}

impl<T, M: Default> Default for StrongFormMemory<T, M> {
    fn default() -> Self {
        Self {
            operator: M::default(),
            curvature: Vec::new(),
            mean: Vec::new(),
            laplacian_of_mean: Vec::new(),
        }
    }
}

impl<T, M> StrongFormMemory<T, M> {
    /// n, H, K and A at each vertex.
    pub fn curvature(&self) -> &[Curvature<T>] {
        &self.curvature
    }

    /// Δ_S H at each vertex, 0 where f is not defined; empty until a force was evaluated.
    pub fn laplacian_of_mean(&self) -> &[T] {
        &self.laplacian_of_mean
    }
}

impl<T: Real, L: LaplaceBeltrami<T> + Sync> StrongForm<T, L> {
    fn measure(
        &self,
        execution: &impl Execution,
        plan: &L::Plan,
        surface: Surface<'_, T>,
        memory: &mut StrongFormMemory<T, L::Memory>,
    ) {
        let vertices = surface.mesh().vertex_count();
        memory.curvature.resize(vertices, Curvature::default());
        let StrongFormMemory {
            operator,
            curvature,
            ..
        } = memory;
        self.operator
            .measure(execution, plan, surface, operator, curvature);
    }

    /// Everything up to Δ_S H.
    fn measure_twice(
        &self,
        execution: &impl Execution,
        plan: &L::Plan,
        surface: Surface<'_, T>,
        memory: &mut StrongFormMemory<T, L::Memory>,
    ) {
        self.measure(execution, plan, surface, memory);
        let mesh = surface.mesh();
        let StrongFormMemory {
            operator,
            curvature,
            mean,
            laplacian_of_mean,
        } = memory;
        mean.resize(mesh.vertex_count(), T::zero());
        laplacian_of_mean.resize(mesh.vertex_count(), T::zero());
        execution.map(&mut mean[..], |vertex, mean| *mean = curvature[vertex].mean);
        self.operator
            .apply_to_scalar(execution, plan, surface, operator, mean, laplacian_of_mean);
        if !mesh.is_closed() {
            execution.map(&mut laplacian_of_mean[..], |vertex, value| {
                *value = if mesh.is_surrounded(vertex) {
                    *value
                } else {
                    T::zero()
                };
            });
        }
    }

    fn density_at(
        &self,
        mesh: &TriangleMesh,
        curvature: &Curvature<T>,
        laplacian: T,
        vertex: usize,
    ) -> [T; 3] {
        let two = T::constant(2.0);
        let Curvature {
            normal,
            mean,
            gaussian,
            ..
        } = *curvature;
        let defined = if mesh.is_surrounded(vertex) {
            T::one()
        } else {
            T::zero()
        };
        let normal_density = two * (laplacian + two * mean * (mean * mean - gaussian));
        scale(defined * self.modulus * normal_density, normal)
    }
}

impl<T: Real, L: LaplaceBeltrami<T> + Sync> Method<T> for StrongForm<T, L> {
    type Plan = L::Plan;
    type Memory = StrongFormMemory<T, L::Memory>;

    fn plan(&self, mesh: &TriangleMesh) -> L::Plan {
        self.operator.plan(mesh)
    }

    fn inspect(
        &self,
        plan: &L::Plan,
        surface: Surface<'_, T>,
        memory: &Self::Memory,
        report: &mut dyn FnMut(Finding),
    ) {
        self.operator
            .inspect(plan, surface, &memory.operator, report);
    }
}

impl<T: Real, L: LaplaceBeltrami<T> + Sync> Energy<T> for StrongForm<T, L> {
    fn energy(
        &self,
        execution: &impl Execution,
        plan: &L::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
    ) -> T {
        self.measure(execution, plan, surface, memory);
        let curvature = &memory.curvature;
        let sum = execution.sum(curvature.len(), |vertex| {
            let Curvature { mean, area, .. } = curvature[vertex];
            mean * mean * area
        });
        T::constant(2.0) * self.modulus * sum
    }
}

impl<T: Real, L: LaplaceBeltrami<T> + Sync> ForceDensity<T> for StrongForm<T, L> {
    fn force_density(
        &self,
        execution: &impl Execution,
        plan: &L::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
        density: &mut [[T; 3]],
    ) {
        self.measure_twice(execution, plan, surface, memory);
        let mesh = surface.mesh();
        let StrongFormMemory {
            curvature,
            laplacian_of_mean,
            ..
        } = &*memory;
        execution.map(&mut density[..mesh.vertex_count()], |vertex, density| {
            let laplacian = laplacian_of_mean[vertex];
            *density = self.density_at(mesh, &curvature[vertex], laplacian, vertex);
        });
    }
}

impl<T: Real, L: LaplaceBeltrami<T> + Sync> Force<T> for StrongForm<T, L> {
    fn add_force(
        &self,
        execution: &impl Execution,
        plan: &L::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
        force: &mut [[T; 3]],
    ) {
        self.measure_twice(execution, plan, surface, memory);
        let mesh = surface.mesh();
        let StrongFormMemory {
            curvature,
            laplacian_of_mean,
            ..
        } = &*memory;
        execution.map(&mut force[..mesh.vertex_count()], |vertex, force| {
            let laplacian = laplacian_of_mean[vertex];
            let density = self.density_at(mesh, &curvature[vertex], laplacian, vertex);
            *force = add(*force, scale(curvature[vertex].area, density));
        });
    }
}
