//! The Helfrich force density in strong form, over any Laplace–Beltrami operator. With the
//! cotangent operator it is method C, after Meyer et al.
//!
//! Z.-C. Ou-Yang and W. Helfrich, Phys. Rev. A 39 (1989) 5280.

use crate::bending::SpontaneousCurvature;
use crate::curvature::{Curvature, Curvatures};
use crate::diagnostic::Finding;
use crate::element::{Execution, of_vertices};
use crate::laplacian::{Cotangent, HeatKernel, Jet, LaplaceBeltrami, Paraboloid, Rows};
use crate::mesh::{TriangleMesh, VertexKind};
use crate::method::{Energy, Force, ForceDensity, Method, ParameterError, Workspace};
use crate::real::{Real, finite_or_zero};
use crate::surface::Surface;
use crate::triangle::DualArea;
use crate::vec3::{Vec3, add, dot, scale, sub};
use alloc::vec::Vec;

/// `f = 2κ [Δ_S(H − H0) + 2(H − H0)(H² − K + H0 H)] n − 4κ (H − H0) ∇_S H0`, with Δ_S, H, K and n
/// of one operator; nodal forces `F_i = f_i A_i`.
///
/// The last term, tangential to the surface, is present only where the spontaneous curvature H0
/// varies. Its gradient comes from the same operator: `∇_S φ = ½ Σ_j c_ij (φ_j − φ_i)(x_j − x_i)`
/// without its component along n, because `Δ(φ x) = φ Δx + x Δφ + 2 ∇φ`.
///
/// The force is not the gradient of a discrete energy: forces sum to zero only in the limit of fine
/// meshes, see [`Projected`](crate::Projected). The reported energy is `2κ Σ (H_i − H0_i)² A_i`, a
/// quadrature of `2κ ∫ (H − H0)² dS` over interior vertices.
///
/// f is defined where the vertex and all its neighbours are interior, and 0 elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct StrongForm<T, L> {
    /// Bending modulus κ, in units of energy.
    pub modulus: T,
    /// Spontaneous curvature H0.
    pub spontaneous_curvature: SpontaneousCurvature<T>,
    /// The operator.
    pub operator: L,
}

impl<T: Real, L> StrongForm<T, L> {
    /// The force density with any operator, without spontaneous curvature.
    pub fn new(modulus: T, operator: L) -> Self {
        Self {
            modulus,
            spontaneous_curvature: SpontaneousCurvature::default(),
            operator,
        }
    }
}

impl<T: Real> StrongForm<T, Cotangent> {
    /// Method C: the cotangent operator with mixed areas.
    pub fn meyer(modulus: T) -> Self {
        Self::new(modulus, Cotangent::new(DualArea::Mixed))
    }
}

impl<T: Real> StrongForm<T, HeatKernel<T>> {
    /// Method D: the heat kernel with the bandwidth with which it converges,
    /// [`Bandwidth::Converging`](crate::Bandwidth).
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
pub struct StrongFormMemory<T, W> {
    /// The operator's workspace.
    operator: W,
    found: Found<T>,
}

/// Results of the operator on the surface.
#[derive(Clone, Debug)]
struct Found<T> {
    curvature: Vec<Curvature<T>>,
    /// H − H0.
    excess: Vec<T>,
    laplacian_of_mean: Vec<T>,
    /// The operator's rows, where H0 varies and its gradient is needed.
    rows: Rows<T>,
}

impl<T, W> StrongFormMemory<T, W> {
    /// n, H, K and A at each vertex.
    pub fn curvature(&self) -> &[Curvature<T>] {
        &self.found.curvature
    }

    /// Δ_S(H − H0) at each vertex, 0 where f is not defined; empty until a force was evaluated.
    pub fn laplacian_of_mean(&self) -> &[T] {
        &self.found.laplacian_of_mean
    }
}

impl<T: Real, L: LaplaceBeltrami<T> + Sync> StrongForm<T, L> {
    /// The energy of the last evaluation in `memory`, of any kind, without measuring the surface
    /// again.
    pub fn energy_of(
        &self,
        execution: &impl Execution,
        memory: &StrongFormMemory<T, Workspace<T, L>>,
    ) -> T {
        let curvature = memory.curvature();
        let sum = execution.sum(curvature.len(), |vertex| {
            let Curvature {
                mean, area, kind, ..
            } = curvature[vertex];
            if kind != VertexKind::Interior {
                return T::zero();
            }
            let excess = mean - self.spontaneous_curvature.at(vertex);
            let [term] = finite_or_zero([excess * excess * area]);
            term
        });
        T::constant(2.0) * self.modulus * sum
    }

    fn measure(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut StrongFormMemory<T, Workspace<T, L>>,
    ) {
        let vertices = surface.mesh().vertex_count();
        self.spontaneous_curvature.expect(self, surface.mesh());
        let StrongFormMemory { operator, found } = memory;
        found.curvature.resize(vertices, Curvature::default());
        let curvature = &mut found.curvature;
        self.operator
            .curvatures(execution, surface, operator, curvature);
    }

    /// Measures the surface, and computes Δ_S(H − H0).
    fn measure_twice(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut StrongFormMemory<T, Workspace<T, L>>,
    ) {
        self.measure(execution, surface, memory);
        let mesh = surface.mesh();
        let StrongFormMemory { operator, found } = memory;
        let Found {
            curvature,
            excess,
            laplacian_of_mean,
            rows,
        } = found;
        excess.resize(mesh.vertex_count(), T::zero());
        laplacian_of_mean.resize(mesh.vertex_count(), T::zero());
        execution.map(&mut excess[..], |vertex, excess| {
            *excess = curvature[vertex].mean - self.spontaneous_curvature.at(vertex);
        });
        let laplacian = &mut laplacian_of_mean[..];
        self.operator
            .apply_to_scalar(execution, surface, operator, excess, laplacian);
        if !mesh.is_closed() {
            execution.map(laplacian, |vertex, value| {
                *value = if mesh.is_surrounded(vertex) {
                    *value
                } else {
                    T::zero()
                };
            });
        }
        if self.varies() {
            self.operator.assemble(surface, operator, rows);
        }
    }

    fn varies(&self) -> bool {
        matches!(
            self.spontaneous_curvature,
            SpontaneousCurvature::PerVertex(_)
        )
    }

    /// f at one vertex, after both applications of the operator.
    fn density_at(&self, surface: Surface<'_, T>, found: &Found<T>, vertex: usize) -> Vec3<T> {
        let two = T::constant(2.0);
        let Curvature {
            normal,
            mean,
            gaussian,
            ..
        } = found.curvature[vertex];
        let excess = found.excess[vertex];
        let spontaneous = self.spontaneous_curvature.at(vertex);
        let defined = if surface.mesh().is_surrounded(vertex) {
            T::one()
        } else {
            T::zero()
        };
        let cubic = excess * (mean * mean - gaussian + spontaneous * mean);
        let along_normal = two * (found.laplacian_of_mean[vertex] + two * cubic);
        let density = scale(defined * self.modulus * along_normal, normal);
        if !self.varies() {
            return finite_or_zero(density);
        }
        let gradient = self.gradient_of_spontaneous(surface, &found.rows, vertex);
        let tangential = sub(gradient, scale(dot(gradient, normal), normal));
        let four = T::constant(4.0);
        let weight = defined * four * self.modulus * excess;
        finite_or_zero(sub(density, scale(weight, tangential)))
    }

    /// `½ Σ_j c_ij (H0_j − H0_i)(x_j − x_i)`.
    fn gradient_of_spontaneous(
        &self,
        surface: Surface<'_, T>,
        rows: &Rows<T>,
        vertex: usize,
    ) -> Vec3<T> {
        let here = self.spontaneous_curvature.at(vertex);
        let (columns, coefficients) = rows.row(vertex);
        let mut sum = [T::zero(); 3];
        for (&column, &coefficient) in columns.iter().zip(coefficients) {
            let step = self.spontaneous_curvature.at(column as usize) - here;
            let weight = T::constant(0.5) * coefficient * step;
            sum = add(
                sum,
                scale(weight, surface.difference(vertex as u32, column)),
            );
        }
        sum
    }
}

impl<T: Real, L: LaplaceBeltrami<T> + Sync> Method<T> for StrongForm<T, L> {
    type Memory = StrongFormMemory<T, Workspace<T, L>>;

    fn memory(&self, mesh: &TriangleMesh) -> Self::Memory {
        StrongFormMemory {
            operator: self.operator.workspace(mesh),
            found: Found {
                curvature: Vec::new(),
                excess: Vec::new(),
                laplacian_of_mean: Vec::new(),
                rows: Rows::new(),
            },
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.spontaneous_curvature.check_with(self.modulus)
    }

    fn inspect(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        report: &mut dyn FnMut(Finding),
    ) {
        let memory = workspace.for_mesh(surface.mesh());
        self.operator.inspect(surface, &memory.operator, report);
    }
}

/// n, H, K and A of the operator.
impl<T: Real, L: LaplaceBeltrami<T> + Sync> Curvatures<T> for StrongForm<T, L> {
    fn curvatures(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        curvature: &mut [Curvature<T>],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.measure(execution, surface, memory);
        let found = memory.curvature();
        curvature[..found.len()].copy_from_slice(found);
    }
}

impl<T: Real, L: LaplaceBeltrami<T> + Sync> Energy<T> for StrongForm<T, L> {
    fn energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
    ) -> T {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.measure(execution, surface, memory);
        self.energy_of(execution, memory)
    }
}

impl<T: Real, L: LaplaceBeltrami<T> + Sync> ForceDensity<T> for StrongForm<T, L> {
    fn force_density(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        density: &mut [[T; 3]],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.measure_twice(execution, surface, memory);
        let found = &memory.found;
        execution.map(of_vertices(surface, density), |vertex, density| {
            *density = self.density_at(surface, found, vertex);
        });
    }
}

impl<T: Real, L: LaplaceBeltrami<T> + Sync> Force<T> for StrongForm<T, L> {
    fn add_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.measure_twice(execution, surface, memory);
        let found = &memory.found;
        execution.map(of_vertices(surface, force), |vertex, force| {
            let density = self.density_at(surface, found, vertex);
            let nodal = scale(found.curvature[vertex].area, density);
            *force = add(*force, finite_or_zero(nodal));
        });
    }
}
