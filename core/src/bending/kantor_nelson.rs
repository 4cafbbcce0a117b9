//! Method A: dihedral angles.
//!
//! Y. Kantor and D. R. Nelson, Phys. Rev. Lett. 58 (1987) 2774; on the choice of the edge modulus
//! H. S. Seung and D. R. Nelson, Phys. Rev. A 38 (1988) 1005, and G. Gompper and D. M. Kroll,
//! J. Phys. I France 6 (1996) 1305.

use crate::bending::hinge::{Hinge, Hinges};
use crate::diagnostic::Finding;
use crate::elasticity::ReferenceError;
use crate::element::{Corners, ElementEnergy, ElementMemory, Execution};
use crate::lane::Lane;
use crate::mesh::TriangleMesh;
use crate::mesh_identity::MeshIdentity;
use crate::method::{Conservative, Energy, Force, Method, ParameterError, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use alloc::vec::Vec;

/// `E = k̃ Σ_edges (1 − cos(θ − θ0))`, θ the angle between the normals of the two triangles at an edge,
/// positive where the surface is convex; the force is its exact gradient.
///
/// Boundary edges and edges at a triangle without area contribute nothing. On an equilateral
/// lattice `E → k̃ √3 ∫ (H² − ⅔ K) dS`. No single `k̃` is right for every shape, see the
/// constructors.
///
/// The reference angles θ0 are 0 unless a reference shape is given: [`Self::with_reference`].
#[derive(Clone, Debug, PartialEq)]
pub struct KantorNelson<T> {
    /// The modulus k̃ of an edge, in units of energy.
    pub edge_modulus: T,
    /// `[sin θ0, cos θ0]` of each hinge; empty if all are flat.
    reference: Vec<[T; 2]>,
    /// The mesh of the reference shape.
    mesh: Option<MeshIdentity>,
}

impl<T: Real> KantorNelson<T> {
    /// The method with modulus k̃ of an edge.
    pub fn with_edge_modulus(edge_modulus: T) -> Self {
        Self {
            edge_modulus,
            reference: Vec::new(),
            mesh: None,
        }
    }

    /// The same method with the angles of `shape` as reference, for surfaces with the mesh `mesh`.
    /// In the reference shape energy and forces are exactly zero, at convex and concave hinges.
    ///
    /// Preparing the method for another mesh panics.
    ///
    /// # Errors
    /// If the triangles of `mesh` and `shape` differ.
    pub fn with_reference(
        mut self,
        mesh: &TriangleMesh,
        shape: Surface<'_, T>,
    ) -> Result<Self, ReferenceError> {
        ReferenceError::unless_same(mesh, shape.mesh())?;
        let hinges = Hinges::new(shape.mesh());
        let angle = |&hinge| {
            let hinge = Hinge::<T>::new(&Corners::of(shape, hinge));
            [hinge.sine, hinge.cosine]
        };
        self.reference = hinges.vertices.iter().map(angle).collect();
        self.mesh = Some(MeshIdentity::of(mesh));
        Ok(self)
    }

    /// `k̃ = 2κ/√3`: the right forces for bending modulus κ, and the right energy of a cylinder.
    /// The usual choice.
    pub fn new(modulus: T) -> Self {
        Self::with_edge_modulus(modulus * T::constant(2.0 / SQRT_3))
    }

    /// `k̃ = √3 κ`: the right energy of a sphere if the energy includes a Gaussian modulus κ_G =
    /// −κ.
    pub fn with_opposite_gaussian_modulus(modulus: T) -> Self {
        Self::with_edge_modulus(modulus * T::constant(SQRT_3))
    }

    /// `k̃ = 2√3 κ`: the right energy 8πκ of a sphere; forces are then three times too large.
    pub fn with_sphere_energy(modulus: T) -> Self {
        Self::with_edge_modulus(modulus * T::constant(2.0 * SQRT_3))
    }
}

/// √3, to the last bit of f64.
const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// The angles of hinges at rest. Resolved at compile time: a flat rest shape costs nothing.
trait Reference<T: Real>: Copy + Sync {
    /// `[sin θ0, cos θ0]` of hinges `first`, `first + 1`, …, one per lane entry.
    fn angle<L: Lane<Scalar = T>>(self, first: usize) -> [L; 2];
}

#[derive(Clone, Copy)]
struct Flat;

impl<T: Real> Reference<T> for Flat {
    #[inline(always)]
    fn angle<L: Lane<Scalar = T>>(self, _first: usize) -> [L; 2] {
        [L::zero(), L::literal(1.0)]
    }
}

impl<T: Real> Reference<T> for &[[T; 2]] {
    #[inline(always)]
    fn angle<L: Lane<Scalar = T>>(self, first: usize) -> [L; 2] {
        core::array::from_fn(|part| L::from_fn(|k| self[first + k][part]))
    }
}

/// 1 − cos(θ − θ0), computed as half the squared chord between two points on the unit circle, which
/// avoids cancellation at small angles.
#[inline(always)]
fn energy<L: Lane>(hinge: &Hinge<L>, [sine, cosine]: [L; 2]) -> L {
    let chord = [hinge.cosine - cosine, hinge.sine - sine];
    L::literal(0.5) * hinge.presence * (chord[0] * chord[0] + chord[1] * chord[1])
}

struct HingeEnergy<T, R> {
    edge_modulus: T,
    reference: R,
}

impl<T: Real, R: Reference<T>> ElementEnergy<T, 4> for HingeEnergy<T, R> {
    /// −∂E/∂x = −k̃ sin(θ − θ0) ∂θ/∂x, and half of E/k̃ for each end of the edge. The sine as a
    /// difference of products that agree to the last bit in the reference shape: there the force is
    /// exactly zero.
    #[inline(always)]
    fn evaluate(&self, first: usize, corners: &Corners<T, 4>) -> ([[T; 3]; 4], [T; 4]) {
        let hinge = Hinge::new(corners);
        let angle = self.reference.angle::<T>(first);
        let [sine, cosine] = angle;
        let turned = hinge.sine * cosine - hinge.cosine * sine;
        let forces = hinge.forces(corners, self.edge_modulus * turned * hinge.presence);
        let half = T::constant(0.5) * energy(&hinge, angle);
        (forces, [half, half, T::zero(), T::zero()])
    }
}

/// Memory of [`KantorNelson`].
#[derive(Clone, Debug)]
pub struct KantorNelsonMemory<T> {
    hinges: Hinges,
    /// Energies in units of k̃.
    sums: ElementMemory<T>,
}

impl<T: Real> Method<T> for KantorNelson<T> {
    type Memory = KantorNelsonMemory<T>;

    /// # Panics
    /// If the reference shape has another mesh.
    fn memory(&self, mesh: &TriangleMesh) -> KantorNelsonMemory<T> {
        if let Some(of_reference) = &self.mesh {
            let remedy = "make it by KantorNelson::with_reference for that mesh";
            of_reference.expect::<Self>(mesh, remedy);
        }
        KantorNelsonMemory {
            hinges: Hinges::new(mesh),
            sums: ElementMemory::default(),
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        // That of the edges is up to 2√3 times the bending modulus it is made of.
        let limit = T::constant(4.0) * ParameterError::largest_modulus();
        ParameterError::unless_within("modulus of an edge", self.edge_modulus, limit)
    }

    fn inspect(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        report: &mut dyn FnMut(Finding),
    ) {
        workspace.for_mesh(surface.mesh());
        surface.report_uneven_mesh(report);
        surface.report_valences(report);
        surface.report_rough_vertices(report);
    }
}

impl<T: Real> KantorNelson<T> {
    fn hinge<R: Reference<T>>(&self, reference: R) -> HingeEnergy<T, R> {
        HingeEnergy {
            edge_modulus: self.edge_modulus,
            reference,
        }
    }
}

impl<T: Real> Energy<T> for KantorNelson<T> {
    fn energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
    ) -> T {
        let KantorNelsonMemory { hinges, sums } = workspace.for_mesh_mut(surface.mesh());
        let hinges = &hinges.vertices[..];
        let sum = if self.reference.is_empty() {
            sums.energy(execution, surface, hinges, &self.hinge(Flat))
        } else {
            let kernel = self.hinge(&self.reference[..]);
            sums.energy(execution, surface, hinges, &kernel)
        };
        self.edge_modulus * sum
    }
}

impl<T: Real> Force<T> for KantorNelson<T> {
    fn add_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) {
        let KantorNelsonMemory { hinges, sums } = workspace.for_mesh_mut(surface.mesh());
        let hinges = &hinges.vertices[..];
        if self.reference.is_empty() {
            sums.add_force(execution, surface, hinges, &self.hinge(Flat), force);
        } else {
            let kernel = self.hinge(&self.reference[..]);
            sums.add_force(execution, surface, hinges, &kernel, force);
        }
    }
}

impl<T: Real> Conservative<T> for KantorNelson<T> {
    fn add_force_and_energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) -> T {
        let KantorNelsonMemory { hinges, sums } = workspace.for_mesh_mut(surface.mesh());
        let hinges = &hinges.vertices[..];
        let sum = if self.reference.is_empty() {
            let kernel = self.hinge(Flat);
            sums.add_force_and_energy(execution, surface, hinges, &kernel, force)
        } else {
            let kernel = self.hinge(&self.reference[..]);
            sums.add_force_and_energy(execution, surface, hinges, &kernel, force)
        };
        self.edge_modulus * sum
    }
}
