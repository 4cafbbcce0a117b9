//! Hamann's method: paraboloids fitted to one-rings in the frame of averaged normals.
//!
//! B. Hamann, in: Geometric Modelling, Computing Supplementum 8 (1993) 139. As an energy: T. Mimura and
//! Y. Inoue, arXiv 2503.00302 (2025). The gradient is our own.

use crate::bending::MaterialParameter;
use crate::bending::area_vectors::{AreaVectorForce, AreaVectors};
use crate::curvature::{Curvature, Curvatures};
use crate::diagnostic::Finding;
use crate::element::{Corners, ElementKernel, Execution};
use crate::fit::Graph;
use crate::lane::Lane;
use crate::mesh::TriangleMesh;
use crate::method::{Method, ParameterError, TwoPass, Workspace};
use crate::real::{Real, finite_or_zero};
use crate::surface::Surface;
use crate::vec3::{Vec3, add, cross, dot, norm, scale, sub, tangent_frame};
use alloc::vec::Vec;

/// `E = 2 Σ_i κ_i (H_i − H0_i)² A_i` over interior vertices, and the exact gradient of this energy.
///
/// At each vertex let `n = N/|N|`, N the sum of the area vectors around it. The neighbours' heights z over
/// the plane normal to n are fitted by `z = ½ pᵀ C p`, with a symmetric 2×2 matrix C and p the positions in
/// that plane: `H = −½ tr C`, `K = det C`. A_i is a third of the area of the triangles around the vertex.
///
/// The fit has no slope. An error of the averaged normal therefore causes an error of H of first order
/// in the edge length, unless the one-ring is symmetric. Where the one-ring does not determine C, as with
/// four neighbours on two lines, the vertex is left out, and [`Method::inspect`] reports it.
#[derive(Clone, Debug, PartialEq)]
pub struct Hamann<T> {
    /// Bending modulus κ, in units of energy.
    pub modulus: MaterialParameter<T>,
    /// Spontaneous curvature H0.
    pub spontaneous_curvature: MaterialParameter<T>,
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

/// Results of a fit that the fits of its neighbours read: n, u, C, Λ, 1/ρ, ∂E/∂tr C, and H − H0. C and Λ are in
/// units of ρ, the root mean square distance of the neighbours; `Λ = (Σ m mᵀ)⁻¹ (1, 0, 1)` with
/// `m = (½u², uv, ½v²)`, all zero where there is no fit.
type Fit<T> = [T; 15];

/// Least determinant of scaled normal equations that is more than the rounding of `f32`.
const UNDETERMINED: f64 = 1e-6;

/// `∂(tr C)/∂y` of a neighbour at y, times 1/ρ², and z times the part in the plane.
///
/// With `q = ½ pᵀCp`, the residual `r = z − q` and `w = ½ pᵀΛp`: `w n + (r Λ − w C) p`.
#[inline(always)]
fn slope<T: Real>(fit: &Fit<T>, difference: Vec3<T>) -> [Vec3<T>; 2] {
    let half = T::constant(0.5);
    let [n0, n1, n2, u0, u1, u2, c0, c1, c2, l0, l1, l2, over, _, _] = *fit;
    let (normal, first) = ([n0, n1, n2], [u0, u1, u2]);
    let second = cross(normal, first);
    let y = scale(over, difference);
    let (u, v, z) = (dot(first, y), dot(second, y), dot(normal, y));
    let (cu, cv) = (c0 * u + c1 * v, c1 * u + c2 * v);
    let (lu, lv) = (l0 * u + l1 * v, l1 * u + l2 * v);
    let residual = z - half * (u * cu + v * cv);
    let weight = half * (u * lu + v * lv);
    let in_frame = |[along, across]: [T; 2]| add(scale(along, first), scale(across, second));
    let along = [residual * lu - weight * cu, residual * lv - weight * cv];
    // The change of the normal: ∂z = p·∂n, ∂p = −z ∂n.
    let turn = [weight * u - z * along[0], weight * v - z * along[1]];
    [add(scale(weight, normal), in_frame(along)), in_frame(turn)]
}

/// `H = −½ tr C`.
fn mean<T: Real>(fit: &Fit<T>) -> T {
    -T::constant(0.5) * fit[12] * (fit[6] + fit[8])
}

/// Forces between the ends of an edge, by the fit at each.
struct Pulled;

impl<T: Real> ElementKernel<T, 2, 15, 3> for Pulled {
    #[inline(always)]
    fn evaluate(&self, _: usize, corners: &Corners<T, 2>, [a, b]: &[Fit<T>; 2]) -> [[T; 3]; 2] {
        let [on_b, on_a] = [(a, 0, 1), (b, 1, 0)]
            .map(|(fit, from, to)| scale(-fit[13], slope(fit, corners.difference(from, to))[0]));
        [sub(on_a, on_b), sub(on_b, on_a)]
    }
}

impl<T: Real> Hamann<T> {
    /// The method without spontaneous curvature.
    pub fn new(modulus: T) -> Self {
        Self {
            modulus: modulus.into(),
            spontaneous_curvature: MaterialParameter::default(),
        }
    }

    fn fit(&self, surface: Surface<'_, T>, vertex: usize, [x, y, z, area]: [T; 4]) -> Fit<T> {
        let half = T::constant(0.5);
        let normal = scale(norm([x, y, z]).reciprocal_or_zero(), [x, y, z]);
        let [first, second] = tangent_frame(normal);
        let mut fit = [T::zero(); 15];
        fit[..3].copy_from_slice(&normal);
        if !surface.mesh().is_interior(vertex) {
            return fit;
        }
        let squares: T = surface.spokes(vertex).map(|y| dot(y, y)).sum();
        let count = T::constant(surface.mesh().valence(vertex) as f64);
        let over = Lane::sqrt(squares / count).reciprocal_or_zero();
        // Σ m mᵀ and Σ m z.
        let (mut matrix, mut right) = ([[T::zero(); 3]; 3], [T::zero(); 3]);
        for offset in surface.spokes(vertex).map(|offset| scale(over, offset)) {
            let (u, v) = (dot(first, offset), dot(second, offset));
            let m = [half * u * u, u * v, half * v * v];
            matrix = core::array::from_fn(|row| add(matrix[row], scale(m[row], m)));
            right = add(right, scale(dot(normal, offset), m));
        }
        let [a, b, c] = matrix;
        let adjugate = [cross(b, c), cross(c, a), cross(a, b)];
        let (determinant, largest) = (dot(a, adjugate[0]), a[0].max(b[1]).max(c[2]));
        if determinant <= T::constant(UNDETERMINED) * largest * largest * largest {
            return fit;
        }
        let solve = |right: Vec3<T>| adjugate.map(|row| dot(row, right) / determinant);
        fit[3..6].copy_from_slice(&first);
        fit[6..9].copy_from_slice(&solve(right));
        fit[9..12].copy_from_slice(&solve([T::one(), T::zero(), T::one()]));
        fit[12] = over;
        // ∂E/∂tr C = −½ ∂E/∂H, and the two factors 1/ρ of a slope.
        fit[14] = mean(&fit) - self.spontaneous_curvature.at(vertex);
        let by_mean =
            -T::constant(2.0) * self.modulus.at(vertex) * fit[14] * (area / T::constant(3.0));
        fit[13] = by_mean * over * over;
        finite_or_zero(fit)
    }
}

impl<T: Real> Method<T> for Hamann<T> {
    type Memory = HamannMemory<T>;

    fn memory(&self, _mesh: &TriangleMesh) -> HamannMemory<T> {
        HamannMemory::default()
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
        surface.report_rough_vertices(report);
        for (vertex, fit) in (0..).zip(&memory.fits) {
            if fit[12] == T::zero() && surface.mesh().is_interior(vertex as usize) {
                report(Finding::TooFewNeighbours { vertex });
            }
        }
    }
}

impl<T: Real> TwoPass for Hamann<T> {
    type Scalar = T;

    fn measure(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut HamannMemory<T>,
    ) {
        let (modulus, curvature) = (&self.modulus, &self.spontaneous_curvature);
        MaterialParameter::expect(self, modulus, curvature, surface.mesh());
        let HamannMemory { sums, fits, .. } = memory;
        AreaVectors.sum(execution, surface, sums);
        fits.resize(sums.len(), [T::zero(); 15]);
        execution.map(&mut fits[..], |i, fit| *fit = self.fit(surface, i, sums[i]));
    }

    fn measured_energy(
        &self,
        execution: &impl Execution,
        _: Surface<'_, T>,
        memory: &mut HamannMemory<T>,
    ) -> T {
        let HamannMemory { sums, fits, .. } = memory;
        let term = |i: usize| {
            let squared = fits[i][14] * fits[i][14];
            self.modulus.at(i) * (squared * sums[i][3] / T::constant(3.0))
        };
        T::constant(2.0) * execution.sum(fits.len(), term)
    }

    fn add_measured_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut HamannMemory<T>,
        force: &mut [[T; 3]],
    ) {
        let HamannMemory { sums, fits, turns } = memory;
        turns.resize(fits.len(), [T::zero(); 4]);
        execution.map(&mut turns[..], |vertex, turn| {
            let fit = &fits[vertex];
            let turned = surface.spokes(vertex).map(|offset| slope(fit, offset)[1]);
            let sum = turned.fold([T::zero(); 3], add);
            // One factor 1/ρ less: the normal has no length.
            let [x, y, z, _] = sums[vertex];
            let over = norm([x, y, z]).reciprocal_or_zero() * fit[12].reciprocal_or_zero();
            let [x, y, z] = scale(-fit[13] * over, sum);
            let shrink = -T::constant(2.0) * self.modulus.at(vertex) * fit[14] * fit[14];
            *turn = finite_or_zero([x, y, z, shrink]);
        });
        let triangles = surface.mesh().triangles();
        execution.scatter(&AreaVectorForce, surface, triangles, turns, force);
        execution.scatter(&Pulled, surface, surface.mesh().edges(), fits, force);
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
        let HamannMemory { sums, fits, .. } = memory;
        execution.map(&mut curvature[..fits.len()], |vertex, curvature| {
            let [n0, n1, n2, u0, u1, u2, c0, c1, c2, _, _, _, over, _, _] = fits[vertex];
            let (normal, first) = ([n0, n1, n2], [u0, u1, u2]);
            let graph = Graph {
                first: [T::zero(); 2],
                second: [c0, c1, c2],
            };
            let axes = [first, cross(normal, first), normal];
            let [direction, _] = graph.principal(axes).directions;
            *curvature = Curvature {
                normal,
                direction,
                mean: mean(&fits[vertex]),
                gaussian: (over * c0) * (over * c2) - (over * c1) * (over * c1),
                area: sums[vertex][3] / T::constant(3.0),
                kind: surface.mesh().vertex_kind(vertex),
            };
        });
    }
}
