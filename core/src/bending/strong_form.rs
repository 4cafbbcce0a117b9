//! The Helfrich force density in strong form, over any Laplace–Beltrami operator. With the
//! cotangent operator it is method C, after Meyer et al.
//!
//! Z.-C. Ou-Yang and W. Helfrich, Phys. Rev. A 39 (1989) 5280.

use crate::bending::MaterialParameter;
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

/// `f = 2[Δ_S(κ(H − H0)) + 2κ(H − H0)(H² − K + H0 H)] n − 4κ (H − H0) ∇_S H0 + 2 (H − H0)² ∇_S κ`,
/// with Δ_S, H, K and n of one operator; nodal forces `F_i = f_i A_i`.
///
/// The last two terms, tangential to the surface, are present only where the spontaneous curvature
/// H0 or the bending modulus κ vary: the material moves to where it is bent as it prefers, and stiff
/// material to where less is bent. Gradients come from the same operator: `∇_S φ = ½ Σ_j c_ij
/// (φ_j − φ_i)(x_j − x_i)` without its component along n, because `Δ(φ x) = φ Δx + x Δφ + 2 ∇φ`.
///
/// The force is not the gradient of a discrete energy: forces sum to zero only in the limit of fine
/// meshes, see [`Projected`](crate::Projected). The reported energy is `2 Σ κ_i (H_i − H0_i)² A_i`, a
/// quadrature of `2 ∫ κ (H − H0)² dS` over interior vertices, and over those of boundaries if the operator defines
/// H there ([`Curvatures::reaches_boundary`]).
///
/// f is defined where the vertex and all its neighbours are interior, and 0 elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct StrongForm<T, L> {
    /// Bending modulus κ, in units of energy.
    pub modulus: MaterialParameter<T>,
    /// Spontaneous curvature H0.
    pub spontaneous_curvature: MaterialParameter<T>,
    /// The operator.
    pub operator: L,
}

impl<T: Real, L> StrongForm<T, L> {
    /// The force density with any operator, without spontaneous curvature.
    pub fn new(modulus: T, operator: L) -> Self {
        Self {
            modulus: modulus.into(),
            spontaneous_curvature: MaterialParameter::default(),
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

    /// Method J of degree 8: [`Jet::j8`].
    pub fn j8(modulus: T) -> Self {
        Self::new(modulus, Jet::j8())
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
    /// κ(H − H0), where κ varies; otherwise empty.
    moment: Vec<T>,
    /// Δ_S(H − H0), or where κ varies Δ_S(κ(H − H0)).
    laplacian_of_mean: Vec<T>,
    /// The operator's rows, where κ or H0 vary and their gradients are needed.
    rows: Rows<T>,
    /// Whether the rows are those of the last surface.
    varies: bool,
}

impl<T: Real, W> StrongFormMemory<T, W> {
    /// Memory with this workspace of the operator.
    pub(super) fn new(operator: W) -> Self {
        Self {
            operator,
            found: Found {
                curvature: Vec::new(),
                excess: Vec::new(),
                moment: Vec::new(),
                laplacian_of_mean: Vec::new(),
                rows: Rows::new(),
                varies: false,
            },
        }
    }

    /// The operator's workspace.
    pub(super) fn operator(&self) -> &W {
        &self.operator
    }
}

impl<T, W> StrongFormMemory<T, W> {
    /// n, H, K and A at each vertex.
    pub fn curvature(&self) -> &[Curvature<T>] {
        &self.found.curvature
    }

    /// Δ_S(H − H0) at each vertex, or Δ_S(κ(H − H0)) if the bending modulus varies; 0 where f is not
    /// defined, and empty until a force was evaluated.
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
        let reaches_boundary = self.operator.reaches_boundary();
        let sum = execution.sum(curvature.len(), |vertex| {
            let Curvature {
                mean, area, kind, ..
            } = curvature[vertex];
            if !(kind == VertexKind::Interior || reaches_boundary && kind == VertexKind::Boundary) {
                return T::zero();
            }
            let excess = mean - self.spontaneous_curvature.at(vertex);
            let [term] = finite_or_zero([excess * excess * area]);
            self.modulus.at(vertex) * term
        });
        T::constant(2.0) * sum
    }

    /// The formula on surfaces with this mesh.
    fn formula(&self, mesh: &TriangleMesh) -> Formula<'_, T, L> {
        let Self {
            modulus,
            spontaneous_curvature,
            operator,
        } = self;
        MaterialParameter::expect(self, modulus, spontaneous_curvature, mesh);
        Formula {
            modulus,
            spontaneous_curvature,
            operator,
        }
    }
}

/// The formula of [`StrongForm`], with parameters that may belong to another method.
#[derive(Debug)]
pub(super) struct Formula<'a, T, L> {
    pub(super) modulus: &'a MaterialParameter<T>,
    pub(super) spontaneous_curvature: &'a MaterialParameter<T>,
    pub(super) operator: &'a L,
}

impl<T, L> Clone for Formula<'_, T, L> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T, L> Copy for Formula<'_, T, L> {}

impl<T: Real, L: LaplaceBeltrami<T> + Sync> Formula<'_, T, L> {
    /// Sets n, H, K and A.
    pub(super) fn measure(
        self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut StrongFormMemory<T, Workspace<T, L>>,
    ) {
        let vertices = surface.mesh().vertex_count();
        let StrongFormMemory { operator, found } = memory;
        found.curvature.resize(vertices, Curvature::default());
        let curvature = &mut found.curvature;
        self.operator
            .curvatures(execution, surface, operator, curvature);
    }

    /// Measures the surface, and applies the operator to H − H0 or κ(H − H0).
    fn measure_twice(
        self,
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
            moment,
            laplacian_of_mean,
            rows,
            varies,
        } = found;
        excess.resize(mesh.vertex_count(), T::zero());
        laplacian_of_mean.resize(mesh.vertex_count(), T::zero());
        execution.map(&mut excess[..], |vertex, excess| {
            *excess = curvature[vertex].mean - self.spontaneous_curvature.at(vertex);
        });
        moment.clear();
        if self.modulus.varies() {
            moment.resize(mesh.vertex_count(), T::zero());
            execution.map(&mut moment[..], |vertex, moment| {
                *moment = self.modulus.at(vertex) * excess[vertex];
            });
        }
        let field = if moment.is_empty() {
            &*excess
        } else {
            &*moment
        };
        let is_uniform = moment.is_empty();
        let factor = |vertex: usize| {
            if is_uniform {
                T::one()
            } else {
                self.modulus.at(vertex)
            }
        };
        let laplacian = &mut laplacian_of_mean[..];
        self.operator
            .apply_to_mean(execution, surface, operator, (field, factor), laplacian);
        if !mesh.is_closed() {
            execution.map(laplacian, |vertex, value| {
                *value = if mesh.is_surrounded(vertex) {
                    *value
                } else {
                    T::zero()
                };
            });
        }
        *varies = !moment.is_empty() || self.spontaneous_curvature.varies();
        if *varies {
            self.operator.assemble(surface, operator, rows);
        }
    }

    /// f at one vertex, after both applications of the operator.
    fn density_at(self, surface: Surface<'_, T>, found: &Found<T>, vertex: usize) -> Vec3<T> {
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
        let modulus = self.modulus.at(vertex);
        // The Laplacian has the factor κ already where κ varies.
        let [outside, inside] = match found.moment.is_empty() {
            true => [modulus, T::one()],
            false => [T::one(), modulus],
        };
        let cubic = excess * (mean * mean - gaussian + spontaneous * mean);
        let along_normal = two * (found.laplacian_of_mean[vertex] + two * inside * cubic);
        let density = scale(defined * outside * along_normal, normal);
        if !found.varies {
            return finite_or_zero(density);
        }
        let along_surface = |parameter: &MaterialParameter<T>| {
            let gradient = gradient(parameter, surface, &found.rows, vertex);
            sub(gradient, scale(dot(gradient, normal), normal))
        };
        let weight = defined * two * excess;
        let bent = scale(two * modulus, along_surface(self.spontaneous_curvature));
        let stiff = scale(excess, along_surface(self.modulus));
        finite_or_zero(sub(density, scale(weight, sub(bent, stiff))))
    }

    /// Sets f.
    pub(super) fn force_density(
        self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut StrongFormMemory<T, Workspace<T, L>>,
        density: &mut [[T; 3]],
    ) {
        self.measure_twice(execution, surface, memory);
        let found = &memory.found;
        execution.map(of_vertices(surface, density), |vertex, density| {
            *density = self.density_at(surface, found, vertex);
        });
    }
}

/// `½ Σ_j c_ij (φ_j − φ_i)(x_j − x_i)`.
fn gradient<T: Real>(
    parameter: &MaterialParameter<T>,
    surface: Surface<'_, T>,
    rows: &Rows<T>,
    vertex: usize,
) -> Vec3<T> {
    let here = parameter.at(vertex);
    let (columns, coefficients) = rows.row(vertex);
    let mut sum = [T::zero(); 3];
    for (&column, &coefficient) in columns.iter().zip(coefficients) {
        let step = parameter.at(column as usize) - here;
        let weight = T::constant(0.5) * coefficient * step;
        sum = add(
            sum,
            scale(weight, surface.difference(vertex as u32, column)),
        );
    }
    sum
}

impl<T: Real, L: LaplaceBeltrami<T> + Sync> Method<T> for StrongForm<T, L> {
    type Memory = StrongFormMemory<T, Workspace<T, L>>;

    fn memory(&self, mesh: &TriangleMesh) -> Self::Memory {
        StrongFormMemory::new(self.operator.workspace(mesh))
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
        self.formula(surface.mesh())
            .measure(execution, surface, memory);
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
        self.formula(surface.mesh())
            .measure(execution, surface, memory);
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
        self.formula(surface.mesh())
            .force_density(execution, surface, memory, density);
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
        let formula = self.formula(surface.mesh());
        formula.measure_twice(execution, surface, memory);
        let found = &memory.found;
        execution.map(of_vertices(surface, force), |vertex, force| {
            let density = formula.density_at(surface, found, vertex);
            let nodal = scale(found.curvature[vertex].area, density);
            *force = add(*force, finite_or_zero(nodal));
        });
    }
}
