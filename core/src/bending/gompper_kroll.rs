//! Method B: squared cotangent Laplacian.
//!
//! G. Gompper and D. M. Kroll, J. Phys. I France 6 (1996) 1305; the choice of areas after
//! C. Itzykson, in: Random Surfaces and Quantum Gravity (1986). The gradient is our own.

use crate::bending::MaterialParameter;
use crate::bending::area_vectors::{AreaVectorForce, AreaVectors};
use crate::curvature::{Curvature, Curvatures};
use crate::diagnostic::Finding;
use crate::element::{Corners, ElementKernel, Execution, of_vertices};
use crate::lane::Lane;
use crate::laplacian::{Cotangent, VertexSums};
use crate::mesh::TriangleMesh;
use crate::method::{Method, ParameterError, TwoPass, Workspace};
use crate::real::{Real, finite_or_zero};
use crate::surface::Surface;
use crate::triangle::{Barycentric, DualArea, Kind, Mixed, Triangle, Voronoi};
use crate::vec3::{Vec3, add, dot, norm, scale, sub};
use alloc::vec::Vec;

/// `E = ½ Σ_i κ_i |L_i|² / A_i` with `L_i = ½ Σ_j (cot α + cot β)(x_i − x_j) = ∂A/∂x_i`, and the
/// exact gradient of this energy, the change of the areas included.
///
/// With spontaneous curvature `E = 2 Σ_i κ_i |L_i/(2A_i) − H0_i n_i|² A_i`, which is the same for H0 =
/// 0. Here n_i is the normalised sum N_i of the area vectors of the triangles around the vertex, so
/// that the curvature vector is compared with the preferred one. The alternative `|L| − 2 A H0`
/// needs the sign of H, and has a kink where L vanishes.
///
/// The sum runs over interior vertices, but forces act on all vertices. A vertex with `A_i = 0` is
/// left out, and reported by [`Method::inspect`].
#[derive(Clone, Debug, PartialEq)]
pub struct GompperKroll<T> {
    /// Bending modulus κ, in units of energy.
    pub modulus: MaterialParameter<T>,
    /// Spontaneous curvature H0.
    pub spontaneous_curvature: MaterialParameter<T>,
    /// The areas A_i. `Mixed` areas are positive on every mesh. With `Voronoi`, the method as
    /// published, the energy is unbounded below where obtuse triangles make an area negative; with
    /// `Barycentric` forces do not converge, even on a sphere.
    pub area: DualArea,
}

impl<T: Real> GompperKroll<T> {
    /// The method with mixed areas, which are positive on every mesh.
    pub fn new(modulus: T) -> Self {
        Self::with_areas(modulus, DualArea::Mixed)
    }

    /// The method with other areas; [`DualArea::Voronoi`] is the published choice.
    pub fn with_areas(modulus: T, area: DualArea) -> Self {
        Self {
            modulus: modulus.into(),
            spontaneous_curvature: MaterialParameter::default(),
            area,
        }
    }

    /// Sets `mean` to `H_i = L_i·n_i / (2 A_i)` at every vertex, for given unit normals n_i,
    /// such as those of the exact surface; 0 at vertices that are not interior or have no area.
    ///
    /// # Panics
    /// If `normals` or `mean` have fewer entries than the surface has vertices, or the surface
    /// another mesh than that of the workspace.
    pub fn mean_curvature_along(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        normals: &[[T; 3]],
        mean: &mut [T],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.measure(execution, surface, memory);
        let half = T::constant(0.5);
        let curvature = &memory.curvature;
        execution.map(&mut mean[..curvature.len()], |vertex, mean| {
            let [x, y, z, _] = curvature[vertex];
            *mean = half * dot([x, y, z], normals[vertex]);
        });
    }

    /// `N_i/|N_i|` and `1/|N_i|`; 0 where the vertex is left out.
    fn measure_normals(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut GompperKrollMemory<T>,
    ) {
        let mesh = surface.mesh();
        let GompperKrollMemory {
            curvature, normals, ..
        } = memory;
        AreaVectors.sum(execution, surface, normals);
        execution.map(&mut normals[..], |vertex, sum| {
            let [x, y, z, _] = *sum;
            let interior = mesh.is_interior(vertex);
            let there = interior && curvature[vertex][3].reciprocal_or_zero() != T::zero();
            let over = if there {
                norm([x, y, z]).reciprocal_or_zero()
            } else {
                T::zero()
            };
            *sum = [x * over, y * over, z * over, over];
        });
    }

    /// H0 n; 0 where the vertex is left out.
    fn wanted(&self, memory: &GompperKrollMemory<T>, vertex: usize) -> Vec3<T> {
        let [x, y, z, _] = memory.normals[vertex];
        scale(self.spontaneous_curvature.at(vertex), [x, y, z])
    }

    /// The energy with the modulus at each vertex.
    fn energy_with(
        &self,
        execution: &impl Execution,
        memory: &GompperKrollMemory<T>,
        modulus: impl Fn(usize) -> T + Sync,
    ) -> T {
        let curvature = &memory.curvature;
        let plain = self.spontaneous_curvature.is_zero();
        let sum = execution.sum(curvature.len(), |vertex| {
            let [x, y, z, area] = curvature[vertex];
            let excess = if plain {
                [x, y, z]
            } else {
                sub(
                    [x, y, z],
                    scale(T::constant(2.0), self.wanted(memory, vertex)),
                )
            };
            let [term] = finite_or_zero([dot(excess, excess) * area]);
            modulus(vertex) * term
        });
        T::constant(0.5) * sum
    }

    /// Adds the terms `−2 Σ κ H0 L·n + 2 Σ κ H0² A`: their contributions to w and s, and those
    /// through the change of the normals.
    fn add_spontaneous(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut GompperKrollMemory<T>,
        force: &mut [[T; 3]],
    ) {
        let doubled = |vertex| T::constant(2.0) * self.modulus.at(vertex);
        let mut weights = core::mem::take(&mut memory.weights);
        let mut turns = core::mem::take(&mut memory.turns);
        let memory_now = &*memory;
        execution.map(&mut weights[..], |vertex, weight| {
            let wanted = self.wanted(memory_now, vertex);
            for (entry, wanted) in weight.iter_mut().zip(wanted) {
                *entry -= doubled(vertex) * wanted;
            }
            weight[3] -= doubled(vertex) * dot(wanted, wanted);
        });
        turns.resize(weights.len(), [T::zero(); 4]);
        execution.map(&mut turns[..], |vertex, turn| {
            let [x, y, z, area] = memory_now.curvature[vertex];
            let [u, v, w, over] = memory_now.normals[vertex];
            let (gradient, normal) = (scale(area, [x, y, z]), [u, v, w]);
            let across = sub(gradient, scale(dot(gradient, normal), normal));
            let spontaneous = self.spontaneous_curvature.at(vertex);
            let [x, y, z] = scale(doubled(vertex) * spontaneous * over, across);
            *turn = [x, y, z, T::zero()];
        });
        let triangles = surface.mesh().triangles();
        execution.scatter(&AreaVectorForce, surface, triangles, &turns, force);
        memory.weights = weights;
        memory.turns = turns;
    }
}

/// Memory of [`GompperKroll`].
#[derive(Clone, Debug, Default)]
pub struct GompperKrollMemory<T> {
    /// Used by curvatures only.
    cotangent: VertexSums<T>,
    /// The curvature vector L/A = 2 H n, and the area A.
    curvature: Vec<[T; 4]>,
    /// w = κ L/A, and s = κ |L|² / (2 A²).
    weights: Vec<[T; 4]>,
    /// Unit normal and 1/|N|; with spontaneous curvature only.
    normals: Vec<[T; 4]>,
    /// −∂E/∂N and 0; with spontaneous curvature only.
    turns: Vec<[T; 4]>,
}

struct AreaGradient<K>(K);

impl<T: Real, K: Kind> ElementKernel<T, 3, 0, 4> for AreaGradient<K> {
    #[inline(always)]
    fn evaluate(
        &self,
        _first: usize,
        corners: &Corners<T, 3>,
        _input: &[[T; 0]; 3],
    ) -> [[T; 4]; 3] {
        let triangle = corners.triangle();
        let areas = triangle.dual_areas(self.0);
        // In cotangent form, because L·x/R = 2A/R then holds to rounding on any mesh of a sphere.
        let gradient = triangle.area_gradient();
        core::array::from_fn(|k| [gradient[k][0], gradient[k][1], gradient[k][2], areas[k]])
    }
}

struct EnergyGradient<K>(K);

impl<T: Real, K: Kind> ElementKernel<T, 3, 4, 3> for EnergyGradient<K> {
    /// One triangle's part of `−Σ_i w_i·∂L_i + Σ_i s_i ∂A_i`.
    ///
    /// With edges e_k from vertex i to j, `Δw_k = w_j − w_i`, d_k the scalar product at the opposite
    /// corner, S twice the area, v_i = s_i/8 for the Voronoi part and σ for what shares of the whole
    /// triangle amount to,
    ///
    /// `Σ w·L − Σ s A = V/S − σ S`,  `V = Σ_k ½ d_k Δw_k·e_k − Σ_k v_k d_i d_j`.
    ///
    /// `∂d_k` and `∂S` at a corner are combinations of the two edges there, so that the gradient
    /// needs no further cross product: at corner 0 it is `r_1 − r_2`, and cyclically for the
    /// others, with `r_k = [½ d_k Δw_k + (y_i + y_j − y_k − (V/S² + σ) d_k) e_k]/S`, `y_k = ∂V/∂d_k
    /// = ½ Δw_k·e_k − v_i d_j − v_j d_i`.
    #[inline(always)]
    fn evaluate(&self, _first: usize, corners: &Corners<T, 3>, input: &[[T; 4]; 3]) -> [[T; 3]; 3] {
        let triangle = corners.triangle();
        let Triangle {
            edges,
            dots,
            reciprocal: over,
            ..
        } = triangle;
        let half = T::constant(0.5);
        // Half of each difference of w.
        let w = |k: usize| [half * input[k][0], half * input[k][1], half * input[k][2]];
        let (w0, w1, w2) = (w(0), w(1), w(2));
        let steps = [sub(w2, w1), sub(w0, w2), sub(w1, w0)];
        let s = [input[0][3], input[1][3], input[2][3]];
        let (v, shares) = area_weights(self.0, &triangle, s);

        let turn: [T; 3] = core::array::from_fn(|k| dot(steps[k], edges[k]));
        let products = triangle.dot_products();
        let sum = dot(turn, dots) - dot(v, products);
        // Multiplied by one reciprocal after the other, because the square would overflow for small
        // triangles.
        let shrink = sum * over * over + shares;
        let y = [
            turn[0] - (v[1] * dots[2] + v[2] * dots[1]),
            turn[1] - (v[2] * dots[0] + v[0] * dots[2]),
            turn[2] - (v[0] * dots[1] + v[1] * dots[0]),
        ];
        let r: [_; 3] = core::array::from_fn(|k| {
            let along = (y[(k + 1) % 3] + y[(k + 2) % 3] - y[k]) - shrink * dots[k];
            add(
                scale(over * dots[k], steps[k]),
                scale(over * along, edges[k]),
            )
        });
        [sub(r[2], r[1]), sub(r[0], r[2]), sub(r[1], r[0])]
    }
}

/// v_k of the Voronoi part and σ of the whole triangle's in `Σ s A = Σ v_k d_i d_j/S + σ S`.
#[inline(always)]
fn area_weights<L: Lane, K: Kind>(_kind: K, triangle: &Triangle<L>, s: [L; 3]) -> ([L; 3], L) {
    let eighth = L::literal(0.125);
    let sum = s[0] + s[1] + s[2];
    match K::AREA {
        DualArea::Voronoi => (s.map(|s| eighth * s), eighth * sum),
        DualArea::Barycentric => ([L::zero(); 3], sum * L::literal(1.0 / 6.0)),
        DualArea::Mixed => {
            // At the obtuse corner half of the triangle instead of a quarter.
            let obtuse = triangle.obtuse();
            let more = |k: usize| L::select(obtuse[k], eighth * s[k], L::zero());
            let any = triangle.any_obtuse();
            let v = s.map(|s| L::select(any, L::zero(), eighth * s));
            (v, eighth * sum + more(0) + more(1) + more(2))
        }
    }
}

impl<T: Real> Method<T> for GompperKroll<T> {
    type Memory = GompperKrollMemory<T>;

    fn memory(&self, _mesh: &TriangleMesh) -> GompperKrollMemory<T> {
        GompperKrollMemory::default()
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
            let [.., area] = memory.curvature.get(vertex)?;
            is_interior(vertex).then_some(*area)
        };
        surface.report_areas(self.area, area, report);
    }
}

/// `H_i = L_i·n_i / (2 A_i)`, 0 at vertices that are not interior or have no area; n and K are those
/// of [`Cotangent`] with the same areas.
impl<T: Real> Curvatures<T> for GompperKroll<T> {
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
        let cotangent = Cotangent::new(self.area);
        cotangent.sum(execution, surface, &mut memory.cotangent, curvature);
        let half = T::constant(0.5);
        let vectors = &memory.curvature;
        execution.map(curvature, |vertex, curvature| {
            let [x, y, z, _] = vectors[vertex];
            curvature.mean = half * dot([x, y, z], curvature.normal);
        });
    }
}

/// Sets the derivatives of the energy with respect to the area vectors and areas of the vertices.
fn set_weights<T: Real>(
    execution: &impl Execution,
    curvature: &[[T; 4]],
    weights: &mut [[T; 4]],
    modulus: impl Fn(usize) -> T + Sync,
) {
    let half = T::constant(0.5);
    execution.map(weights, |vertex, weight| {
        let [x, y, z, _] = curvature[vertex];
        let squared = dot([x, y, z], [x, y, z]);
        let modulus = modulus(vertex);
        *weight = finite_or_zero([x, y, z, half * squared].map(|entry| modulus * entry));
    });
}

impl<T: Real> TwoPass for GompperKroll<T> {
    type Scalar = T;

    /// L_i and A_i, then `(L_i/A_i, A_i)` in their place.
    fn measure(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut GompperKrollMemory<T>,
    ) {
        let mesh = surface.mesh();
        MaterialParameter::expect(self, &self.modulus, &self.spontaneous_curvature, mesh);
        memory.curvature.clear();
        memory.curvature.resize(mesh.vertex_count(), [T::zero(); 4]);
        let (triangles, sums) = (mesh.triangles(), &mut memory.curvature[..]);
        match self.area {
            DualArea::Mixed => {
                execution.scatter(&AreaGradient(Mixed), surface, triangles, &[], sums);
            }
            DualArea::Voronoi => {
                execution.scatter(&AreaGradient(Voronoi), surface, triangles, &[], sums);
            }
            DualArea::Barycentric => {
                execution.scatter(&AreaGradient(Barycentric), surface, triangles, &[], sums);
            }
        }
        execution.map(&mut memory.curvature[..], |vertex, sum| {
            let [x, y, z, area] = *sum;
            let interior = mesh.is_interior(vertex);
            let over = if interior {
                Lane::reciprocal_or_zero(area)
            } else {
                T::zero()
            };
            *sum = finite_or_zero([x * over, y * over, z * over, area]);
        });
        if !self.spontaneous_curvature.is_zero() {
            self.measure_normals(execution, surface, memory);
        }
    }

    fn measured_energy(
        &self,
        execution: &impl Execution,
        _surface: Surface<'_, T>,
        memory: &mut GompperKrollMemory<T>,
    ) -> T {
        // Once for each kind, so that loops with one modulus do not look it up.
        match &self.modulus {
            MaterialParameter::Constant(modulus) => {
                self.energy_with(execution, memory, |_| *modulus)
            }
            MaterialParameter::PerVertex(moduli) => {
                self.energy_with(execution, memory, |vertex| moduli[vertex])
            }
        }
    }

    fn add_measured_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut GompperKrollMemory<T>,
        force: &mut [[T; 3]],
    ) {
        let GompperKrollMemory {
            curvature, weights, ..
        } = memory;
        weights.resize(curvature.len(), [T::zero(); 4]);
        match &self.modulus {
            MaterialParameter::Constant(modulus) => {
                set_weights(execution, curvature, weights, |_| *modulus);
            }
            MaterialParameter::PerVertex(moduli) => {
                set_weights(execution, curvature, weights, |vertex| moduli[vertex]);
            }
        }
        if !self.spontaneous_curvature.is_zero() {
            self.add_spontaneous(execution, surface, memory, force);
        }
        let (triangles, weights) = (surface.mesh().triangles(), &memory.weights[..]);
        match self.area {
            DualArea::Mixed => {
                execution.scatter(&EnergyGradient(Mixed), surface, triangles, weights, force);
            }
            DualArea::Voronoi => {
                execution.scatter(&EnergyGradient(Voronoi), surface, triangles, weights, force);
            }
            DualArea::Barycentric => {
                let kernel = EnergyGradient(Barycentric);
                execution.scatter(&kernel, surface, triangles, weights, force);
            }
        }
        execution.map(&mut force[..memory.weights.len()], |_, force| {
            *force = finite_or_zero(*force);
        });
    }
}
