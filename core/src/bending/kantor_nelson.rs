//! Method A: dihedral angles.
//!
//! Y. Kantor and D. R. Nelson, Phys. Rev. Lett. 58 (1987) 2774; on the choice of the edge modulus
//! H. S. Seung and D. R. Nelson, Phys. Rev. A 38 (1988) 1005, and G. Gompper and D. M. Kroll,
//! J. Phys. I France 6 (1996) 1305.

use crate::element::{Corners, ElementKernel, Execution};
use crate::energy::{Conservative, Energy, Finding, Force, Method};
use crate::lane::Lane;
use crate::mesh::TriangleMesh;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, cross, dot, neg, norm, scale};
use alloc::vec::Vec;

/// `E = k̃ Σ_edges (1 − cos θ)`, θ the angle between the normals of the two triangles at an edge,
/// positive where the surface is convex; the force is its exact gradient.
///
/// Boundary edges and edges at a triangle without area contribute nothing. On an equilateral
/// lattice `E → k̃ √3 ∫ (H² − ⅔ K) dS`: no `k̃` serves every shape, see the constructors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KantorNelson<T> {
    /// The modulus k̃ of an edge, in units of energy.
    pub edge_modulus: T,
}

impl<T: Real> KantorNelson<T> {
    /// `k̃ = 2κ/√3`: the forces of a membrane with bending modulus κ, and a cylinder's energy. The
    /// usual choice.
    pub fn new(modulus: T) -> Self {
        Self {
            edge_modulus: modulus * T::constant(2.0 / SQRT_3),
        }
    }

    /// `k̃ = √3 κ`: a sphere's energy if a Gaussian modulus κ_G = −κ is counted with it.
    pub fn with_opposite_gaussian_modulus(modulus: T) -> Self {
        Self {
            edge_modulus: modulus * T::constant(SQRT_3),
        }
    }

    /// `k̃ = 2√3 κ`: a sphere's energy 8πκ; forces are then three times too large.
    pub fn with_sphere_energy(modulus: T) -> Self {
        Self {
            edge_modulus: modulus * T::constant(2.0 * SQRT_3),
        }
    }
}

/// √3, to the last bit of f64.
const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// The interior edges of a mesh, each with the four vertices around it: the edge from a to b, then
/// the corner opposite in the triangle to its left, then the one to its right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hinges {
    vertices: Vec<[u32; 4]>,
}

impl Hinges {
    fn new(mesh: &TriangleMesh) -> Self {
        let opposite = |triangle: u32, [a, b]: [u32; 2]| {
            // The three indices of a triangle and two of them: what is left is the third.
            let [i, j, k] = mesh.triangles()[triangle as usize];
            i ^ j ^ k ^ a ^ b
        };
        let hinge = |(index, &edge): (usize, &[u32; 2])| {
            let (left, right) = mesh.edge_triangles(index);
            right.map(|right| {
                [
                    edge[0],
                    edge[1],
                    opposite(left, edge),
                    opposite(right, edge),
                ]
            })
        };
        Self {
            vertices: mesh.edges().iter().enumerate().filter_map(hinge).collect(),
        }
    }
}

/// One hinge: the sine and cosine of its angle and what its gradient is made of.
struct Hinge<L> {
    edge: Vec3<L>,
    edge_length: L,
    normals: [Vec3<L>; 2],
    reciprocals: [L; 2],
    cosine: L,
    sine: L,
    /// 1, or 0 where a triangle or the edge has no extent.
    presence: L,
}

impl<L: Lane> Hinge<L> {
    #[inline(always)]
    fn new(corners: &Corners<L, 4>) -> Self {
        let edge = corners.difference(0, 1);
        let left = cross(edge, corners.difference(0, 2));
        let right = cross(corners.difference(0, 3), edge);
        let edge_length = norm(edge);
        let lengths = [norm(left), norm(right)];
        let reciprocals = lengths.map(L::reciprocal_or_zero);
        let normals = [scale(reciprocals[0], left), scale(reciprocals[1], right)];
        let along = edge_length.reciprocal_or_zero();
        let present = along * reciprocals[0] * reciprocals[1];
        Self {
            edge,
            edge_length,
            normals,
            reciprocals,
            cosine: dot(normals[0], normals[1]),
            sine: dot(edge, cross(normals[0], normals[1])) * along,
            presence: L::select(L::zero().less(present), L::literal(1.0), L::zero()),
        }
    }

    /// 1 − cos θ as half the squared chord between the angle's point on the unit circle and that
    /// of angle zero: no cancellation at small angles.
    #[inline(always)]
    fn energy(&self) -> L {
        let chord = self.cosine - L::literal(1.0);
        L::literal(0.5) * self.presence * (chord * chord + self.sine * self.sine)
    }
}

struct HingeForce<T> {
    edge_modulus: T,
}

impl<T: Real> ElementKernel<T, 4, 0, 3> for HingeForce<T> {
    /// −∂E/∂x = −k̃ sin θ ∂θ/∂x: lifting an opposite corner along its triangle's normal lowers θ by
    /// the inverse of its height, and the edge's ends answer in proportion to where the corner's
    /// foot lies between them.
    #[inline(always)]
    fn evaluate<L: Lane<Scalar = T>>(
        &self,
        _first: usize,
        corners: &Corners<L, 4>,
        _input: &[[L; 0]; 4],
    ) -> [[L; 3]; 4] {
        let hinge = Hinge::new(corners);
        let torque = L::splat(self.edge_modulus) * hinge.sine * hinge.presence;
        let along = hinge.edge_length.reciprocal_or_zero();
        let lever = |side: usize| scale(torque * hinge.reciprocals[side], hinge.normals[side]);
        let (left, right) = (lever(0), lever(1));
        // Scalar products of the edge with what leads from the foot's end to the corner.
        let from_b = |corner: usize| dot(corners.difference(corner, 1), hinge.edge) * along;
        let from_a = |corner: usize| dot(corners.difference(0, corner), hinge.edge) * along;
        [
            neg(add(scale(from_b(2), left), scale(from_b(3), right))),
            neg(add(scale(from_a(2), left), scale(from_a(3), right))),
            scale(hinge.edge_length, left),
            scale(hinge.edge_length, right),
        ]
    }
}

impl<T: Real> Method<T> for KantorNelson<T> {
    type Plan = Hinges;
    type Memory = ();

    fn plan(&self, mesh: &TriangleMesh) -> Hinges {
        Hinges::new(mesh)
    }

    fn inspect(
        &self,
        _plan: &Hinges,
        surface: Surface<'_, T>,
        _memory: &(),
        report: &mut dyn FnMut(Finding),
    ) {
        surface.report_degenerate_triangles(report);
    }
}

impl<T: Real> Energy<T> for KantorNelson<T> {
    fn energy(
        &self,
        execution: &impl Execution,
        plan: &Hinges,
        surface: Surface<'_, T>,
        _memory: &mut (),
    ) -> T {
        let sum = execution.sum(plan.vertices.len(), |hinge| {
            Hinge::<T>::new(&Corners::of(surface, plan.vertices[hinge])).energy()
        });
        self.edge_modulus * sum
    }
}

impl<T: Real> Force<T> for KantorNelson<T> {
    fn add_force(
        &self,
        execution: &impl Execution,
        plan: &Hinges,
        surface: Surface<'_, T>,
        _memory: &mut (),
        force: &mut [[T; 3]],
    ) {
        let kernel = HingeForce {
            edge_modulus: self.edge_modulus,
        };
        execution.scatter(&kernel, surface, &plan.vertices, &[], force);
    }
}

impl<T: Real> Conservative<T> for KantorNelson<T> {}
