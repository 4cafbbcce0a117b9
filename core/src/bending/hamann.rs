//! Hamann's method: paraboloids fitted to one-rings in the frame of averaged normals.
//!
//! B. Hamann, in: Geometric Modelling, Computing Supplementum 8 (1993) 139. As an energy: T. Mimura and
//! Y. Inoue, arXiv 2503.00302 (2025). The gradient is our own.

use crate::bending::SpontaneousCurvature;
use crate::curvature::{Curvature, Curvatures};
use crate::diagnostic::Finding;
use crate::element::{Corners, ElementKernel, Execution};
use crate::lane::Lane;
use crate::mesh::{TriangleMesh, VertexKind};
use crate::method::{Conservative, Energy, Force, Method, ParameterError, Workspace};
use crate::real::{Real, finite_or_zero};
use crate::surface::Surface;
use crate::vec3::{Vec3, add, cross, dot, norm, scale, sub, tangent_frame};
use alloc::vec::Vec;

/// `E = 2κ Σ_i (H_i − H0_i)² A_i` over interior vertices, and the exact gradient of this energy.
///
/// At each vertex the neighbours' heights z over the plane normal to `n = N/|N|`, N the sum of the
/// area vectors around the vertex, are fitted by `z = ½ pᵀ C p` with a symmetric 2×2 matrix C, p the
/// places in that plane: `H = −½ tr C`, `K = det C`. A_i is a third of the triangles around.
///
/// The fit has no slope: where the averaged normal is off, H is off in first order of the edge length
/// unless the one-ring is symmetric. Where the one-ring does not determine C, as with four neighbours
/// on two lines, the vertex is left out, and [`Method::inspect`] reports it.
#[derive(Clone, Debug, PartialEq)]
pub struct Hamann<T> {
    /// Bending modulus κ, in units of energy.
    pub modulus: T,
    /// Spontaneous curvature H0.
    pub spontaneous_curvature: SpontaneousCurvature<T>,
}

/// Memory of [`Hamann`].
#[derive(Clone, Debug, Default)]
pub struct HamannMemory<T> {
    /// Twice the area vector N, and three times the area A.
    sums: Vec<[T; 4]>,
    fits: Vec<Fit<T>>,
    /// −∂E/∂(2N), and −∂E/∂A.
    turns: Vec<[T; 4]>,
}

/// Numbers of a fit that its neighbours need: n, u, C, Λ, 1/ρ, ∂E/∂tr C. C and Λ are in units of ρ, the
/// root mean square distance of the neighbours; `Λ = (Σ m mᵀ)⁻¹ (1, 0, 1)` with
/// `m = (½u², uv, ½v²)`, all zero where there is no fit.
type Fit<T> = [T; 14];

/// `∂(tr C)/∂y` of a neighbour at y, times 1/ρ², and z times the part in the plane.
///
/// With `q = ½ pᵀCp`, the residual `r = z − q` and `w = ½ pᵀΛp`: `w n + (r Λ − w C) p`.
#[inline(always)]
fn slope<T: Real>(fit: &Fit<T>, difference: Vec3<T>) -> [Vec3<T>; 2] {
    let half = T::constant(0.5);
    let [n0, n1, n2, u0, u1, u2, c0, c1, c2, l0, l1, l2, over, _] = *fit;
    let (normal, first) = ([n0, n1, n2], [u0, u1, u2]);
    let second = cross(normal, first);
    let y = scale(over, difference);
    let (u, v, z) = (dot(first, y), dot(second, y), dot(normal, y));
    let (cu, cv) = (c0 * u + c1 * v, c1 * u + c2 * v);
    let (lu, lv) = (l0 * u + l1 * v, l1 * u + l2 * v);
    let residual = z - half * (u * cu + v * cv);
    let weight = half * (u * lu + v * lv);
    let along = [residual * lu - weight * cu, residual * lv - weight * cv];
    let plane = add(scale(along[0], first), scale(along[1], second));
    // The change of the normal: ∂z = p·∂n, ∂p = −z ∂n.
    let turn = [weight * u - z * along[0], weight * v - z * along[1]];
    let turn = add(scale(turn[0], first), scale(turn[1], second));
    [add(scale(weight, normal), plane), turn]
}

/// Sums around a vertex: twice the area vectors, three times the area.
struct AreaVectors;

impl<T: Real> ElementKernel<T, 3, 0, 4> for AreaVectors {
    #[inline(always)]
    fn evaluate(
        &self,
        _element: usize,
        corners: &Corners<T, 3>,
        _input: &[[T; 0]; 3],
    ) -> [[T; 4]; 3] {
        let triangle = corners.triangle();
        let [x, y, z] = triangle.area_vector;
        [[x, y, z, T::constant(0.5) * triangle.doubled_area]; 3]
    }
}

/// Forces by the change of normals and areas.
struct Turned;

impl<T: Real> ElementKernel<T, 3, 4, 3> for Turned {
    #[inline(always)]
    fn evaluate(
        &self,
        _element: usize,
        corners: &Corners<T, 3>,
        [a, b, c]: &[[T; 4]; 3],
    ) -> [[T; 3]; 3] {
        let triangle = corners.triangle();
        let turn = core::array::from_fn(|axis| a[axis] + b[axis] + c[axis]);
        let grow = triangle.outward_edges(T::constant(1.0 / 6.0) * (a[3] + b[3] + c[3]));
        core::array::from_fn(|corner| add(cross(turn, triangle.edges[corner]), grow[corner]))
    }
}

/// Forces between the ends of an edge, by the fit at each.
struct Pulled;

impl<T: Real> ElementKernel<T, 2, 14, 3> for Pulled {
    #[inline(always)]
    fn evaluate(
        &self,
        _element: usize,
        corners: &Corners<T, 2>,
        [a, b]: &[[T; 14]; 2],
    ) -> [[T; 3]; 2] {
        let [on_b, on_a] = [(a, 0, 1), (b, 1, 0)]
            .map(|(fit, from, to)| scale(-fit[13], slope(fit, corners.difference(from, to))[0]));
        [sub(on_a, on_b), sub(on_b, on_a)]
    }
}

impl<T: Real> Hamann<T> {
    /// The method without spontaneous curvature.
    pub fn new(modulus: T) -> Self {
        Self {
            modulus,
            spontaneous_curvature: SpontaneousCurvature::default(),
        }
    }

    fn measure(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut HamannMemory<T>,
    ) {
        let vertices = surface.mesh().vertex_count();
        let HamannMemory { sums, fits, .. } = memory;
        sums.clear();
        sums.resize(vertices, [T::zero(); 4]);
        execution.scatter(&AreaVectors, surface, surface.mesh().triangles(), &[], sums);
        fits.resize(vertices, [T::zero(); 14]);
        let sums = &*sums;
        execution.map(&mut fits[..], |vertex, fit| {
            *fit = self.fit(surface, vertex, sums[vertex]);
        });
    }

    fn fit(&self, surface: Surface<'_, T>, vertex: usize, [x, y, z, area]: [T; 4]) -> Fit<T> {
        let mesh = surface.mesh();
        let half = T::constant(0.5);
        let normal = scale(norm([x, y, z]).reciprocal_or_zero(), [x, y, z]);
        let [first, second] = tangent_frame(normal);
        let mut fit = [T::zero(); 14];
        fit[..3].copy_from_slice(&normal);
        if mesh.vertex_kind(vertex) != VertexKind::Interior {
            return fit;
        }
        let ring = || {
            let columns = mesh.one_ring(vertex).iter();
            columns.map(|&neighbour| surface.difference(vertex as u32, neighbour))
        };
        let squares: T = ring().map(|offset| dot(offset, offset)).sum();
        let count = T::constant(mesh.valence(vertex) as f64);
        let over = Lane::sqrt(squares / count).reciprocal_or_zero();
        // Upper triangle of Σ m mᵀ, and Σ m z.
        let [mut a, mut b, mut c, mut d, mut e, mut f] = [T::zero(); 6];
        let mut right = [T::zero(); 3];
        for offset in ring() {
            let offset = scale(over, offset);
            let (u, v) = (dot(first, offset), dot(second, offset));
            let [p, q, r] = [half * u * u, u * v, half * v * v];
            [a, b, c, d, e, f] = [
                a + p * p,
                b + p * q,
                c + p * r,
                d + q * q,
                e + q * r,
                f + r * r,
            ];
            right = add(right, scale(dot(normal, offset), [p, q, r]));
        }
        let adjugate = [
            [d * f - e * e, c * e - b * f, b * e - c * d],
            [c * e - b * f, a * f - c * c, b * c - a * e],
            [b * e - c * d, b * c - a * e, a * d - b * b],
        ];
        let determinant = a * adjugate[0][0] + b * adjugate[0][1] + c * adjugate[0][2];
        let largest = a.max(d).max(f);
        if determinant <= T::constant(UNDETERMINED) * largest * largest * largest {
            return fit;
        }
        let solve = |right: Vec3<T>| adjugate.map(|row| dot(row, right) / determinant);
        let shape = solve(right);
        let weights = solve([T::one(), T::zero(), T::one()]);
        fit[3..6].copy_from_slice(&first);
        fit[6..9].copy_from_slice(&shape);
        fit[9..12].copy_from_slice(&weights);
        let mean = -half * over * (shape[0] + shape[2]);
        let excess = mean - self.spontaneous_curvature.at(vertex);
        fit[12] = over;
        // ∂E/∂tr C = −½ ∂E/∂H, and the two factors 1/ρ of a slope.
        let area = area / T::constant(3.0);
        fit[13] = -T::constant(2.0) * self.modulus * excess * area * over * over;
        finite_or_zero(fit)
    }

    fn energy_of(&self, execution: &impl Execution, memory: &HamannMemory<T>) -> T {
        let terms = memory.fits.len();
        let sum = execution.sum(terms, |vertex| {
            let excess = self.excess(memory, vertex);
            excess * excess * memory.sums[vertex][3] / T::constant(3.0)
        });
        T::constant(2.0) * self.modulus * sum
    }

    /// H − H0; 0 where there is no fit.
    fn excess(&self, memory: &HamannMemory<T>, vertex: usize) -> T {
        let [.., c0, _, c2, _, _, _, over, _] = memory.fits[vertex];
        if over == T::zero() {
            return T::zero();
        }
        -T::constant(0.5) * over * (c0 + c2) - self.spontaneous_curvature.at(vertex)
    }

    fn add_gradient(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut HamannMemory<T>,
        force: &mut [[T; 3]],
    ) {
        let mut turns = core::mem::take(&mut memory.turns);
        turns.resize(memory.fits.len(), [T::zero(); 4]);
        let known = &*memory;
        execution.map(&mut turns[..], |vertex, turn| {
            let fit = &known.fits[vertex];
            let mut sum = [T::zero(); 3];
            for &neighbour in surface.mesh().one_ring(vertex) {
                let offset = surface.difference(vertex as u32, neighbour);
                sum = add(sum, slope(fit, offset)[1]);
            }
            // One factor 1/ρ less: the normal has no length.
            let [x, y, z, _] = known.sums[vertex];
            let over = norm([x, y, z]).reciprocal_or_zero() * fit[12].reciprocal_or_zero();
            let [x, y, z] = scale(-fit[13] * over, sum);
            let excess = self.excess(known, vertex);
            let shrink = -T::constant(2.0) * self.modulus * excess * excess;
            *turn = finite_or_zero([x, y, z, shrink]);
        });
        let mesh = surface.mesh();
        execution.scatter(&Turned, surface, mesh.triangles(), &turns, force);
        execution.scatter(&Pulled, surface, mesh.edges(), &memory.fits, force);
        memory.turns = turns;
    }
}

/// Determinant of the scaled normal equations below which the neighbours lie on a conic section through
/// the vertex, to the rounding of `f32`.
const UNDETERMINED: f64 = 1e-6;

impl<T: Real> Method<T> for Hamann<T> {
    type Memory = HamannMemory<T>;

    fn memory(&self, _mesh: &TriangleMesh) -> HamannMemory<T> {
        HamannMemory::default()
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_finite("bending modulus", self.modulus)?;
        self.spontaneous_curvature.check()
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
        for (vertex, fit) in memory.fits.iter().enumerate() {
            let interior = surface.mesh().vertex_kind(vertex) == VertexKind::Interior;
            if interior && fit[12] == T::zero() {
                report(Finding::TooFewNeighbours {
                    vertex: vertex as u32,
                });
            }
        }
    }
}

/// H and K are 0 where there is no fit.
impl<T: Real> Curvatures<T> for Hamann<T> {
    fn curvatures(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        curvature: &mut [Curvature<T>],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.measure(execution, surface, memory);
        let HamannMemory { sums, fits, .. } = &*memory;
        execution.map(&mut curvature[..fits.len()], |vertex, curvature| {
            let [n0, n1, n2, _, _, _, c0, c1, c2, _, _, _, over, _] = fits[vertex];
            *curvature = Curvature {
                normal: [n0, n1, n2],
                mean: -T::constant(0.5) * over * (c0 + c2),
                gaussian: (over * c0) * (over * c2) - (over * c1) * (over * c1),
                area: sums[vertex][3] / T::constant(3.0),
                kind: surface.mesh().vertex_kind(vertex),
            };
        });
    }
}

impl<T: Real> Energy<T> for Hamann<T> {
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

impl<T: Real> Force<T> for Hamann<T> {
    fn add_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.measure(execution, surface, memory);
        self.add_gradient(execution, surface, memory, force);
    }
}

impl<T: Real> Conservative<T> for Hamann<T> {
    fn add_force_and_energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) -> T {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.measure(execution, surface, memory);
        self.add_gradient(execution, surface, memory, force);
        self.energy_of(execution, memory)
    }
}
