//! Method A: dihedral angles.
//!
//! Y. Kantor and D. R. Nelson, Phys. Rev. Lett. 58 (1987) 2774; on the choice of the edge modulus
//! H. S. Seung and D. R. Nelson, Phys. Rev. A 38 (1988) 1005, and G. Gompper and D. M. Kroll,
//! J. Phys. I France 6 (1996) 1305.

use crate::diagnostic::Finding;
use crate::elasticity::ReferenceError;
use crate::element::{Corners, ElementEnergy, Execution};
use crate::hinge::{Hinge, HingeMemory, Hinges};
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
pub struct KantorNelson<T, R = FlatReference> {
    /// The modulus k̃ of an edge, in units of energy.
    pub edge_modulus: T,
    reference: R,
}

impl<T: Real> KantorNelson<T> {
    /// The method with modulus k̃ of an edge.
    pub fn with_edge_modulus(edge_modulus: T) -> Self {
        Self {
            edge_modulus,
            reference: FlatReference,
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
        self,
        mesh: &TriangleMesh,
        shape: Surface<'_, T>,
    ) -> Result<KantorNelson<T, ReferenceAngles<T>>, ReferenceError> {
        ReferenceError::unless_same(mesh, shape.mesh())?;
        let hinges = Hinges::new(shape.mesh());
        let angle = |&hinge| {
            let hinge = Hinge::<T>::new(&Corners::of(shape, hinge));
            [hinge.sine, hinge.cosine]
        };
        Ok(KantorNelson {
            edge_modulus: self.edge_modulus,
            reference: ReferenceAngles {
                angles: hinges.vertices.iter().map(angle).collect(),
                mesh: MeshIdentity::of(mesh),
            },
        })
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

/// The angles of hinges at rest. A type and not a value: a flat rest shape costs nothing.
trait Reference<T: Real>: Sync {
    /// `[sin θ0, cos θ0]` of a hinge.
    fn angle(&self, hinge: usize) -> [T; 2];

    /// Panics unless the angles are those of hinges of `mesh`; the message names the method `M`.
    fn expect<M>(&self, mesh: &TriangleMesh);
}

/// The reference of a [`KantorNelson`] without one: all hinges are flat at rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlatReference;

impl<T: Real> Reference<T> for FlatReference {
    #[inline(always)]
    fn angle(&self, _hinge: usize) -> [T; 2] {
        [T::zero(), T::one()]
    }

    fn expect<M>(&self, _mesh: &TriangleMesh) {}
}

/// The reference of a [`KantorNelson`] made by [`KantorNelson::with_reference`]: the angles of a
/// shape.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceAngles<T> {
    /// `[sin θ0, cos θ0]` of each hinge.
    angles: Vec<[T; 2]>,
    /// The mesh of the shape.
    mesh: MeshIdentity,
}

impl<T: Real> Reference<T> for ReferenceAngles<T> {
    #[inline(always)]
    fn angle(&self, hinge: usize) -> [T; 2] {
        self.angles[hinge]
    }

    fn expect<M>(&self, mesh: &TriangleMesh) {
        let remedy = "make it by KantorNelson::with_reference for that mesh";
        self.mesh.expect::<M>(mesh, remedy);
    }
}

/// The formula of one hinge: forces, but energies in units of k̃.
struct HingeFormula<'a, T, R>(&'a KantorNelson<T, R>);

impl<T: Real, R: Reference<T>> ElementEnergy<T, 4> for HingeFormula<'_, T, R> {
    /// −∂E/∂x = −k̃ sin(θ − θ0) ∂θ/∂x, and half of E/k̃ for each end of the edge. The sine as a
    /// difference of products that agree to the last bit in the reference shape: there the force is
    /// exactly zero. 1 − cos(θ − θ0) as half the squared chord between two points on the unit
    /// circle, which avoids cancellation at small angles.
    #[inline(always)]
    fn evaluate(&self, hinge: usize, corners: &Corners<T, 4>) -> ([[T; 3]; 4], [T; 4]) {
        let KantorNelson {
            edge_modulus,
            reference,
        } = self.0;
        let [sine, cosine] = reference.angle(hinge);
        let hinge = Hinge::new(corners);
        let turned = hinge.sine * cosine - hinge.cosine * sine;
        let forces = hinge.forces(corners, *edge_modulus * turned * hinge.presence);
        let chord = [hinge.cosine - cosine, hinge.sine - sine];
        let squared = chord[0] * chord[0] + chord[1] * chord[1];
        let energy = T::constant(0.5) * hinge.presence * squared;
        let half = T::constant(0.5) * energy;
        (forces, [half, half, T::zero(), T::zero()])
    }
}

impl<T: Real, R: Reference<T>> Method<T> for KantorNelson<T, R> {
    type Memory = HingeMemory<T>;

    /// # Panics
    /// If the reference shape has another mesh.
    fn memory(&self, mesh: &TriangleMesh) -> HingeMemory<T> {
        self.reference.expect::<Self>(mesh);
        HingeMemory::new(mesh)
    }

    fn check(&self) -> Result<(), ParameterError> {
        // The modulus of an edge is up to 2√3 times the bending modulus from which it was made.
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
        HingeMemory::inspect(surface, report);
    }
}

impl<T: Real, R: Reference<T>> Energy<T> for KantorNelson<T, R> {
    fn energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
    ) -> T {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.edge_modulus * memory.energy(execution, surface, &HingeFormula(self))
    }
}

impl<T: Real, R: Reference<T>> Force<T> for KantorNelson<T, R> {
    fn add_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        memory.add_force(execution, surface, &HingeFormula(self), force);
    }
}

impl<T: Real, R: Reference<T>> Conservative<T> for KantorNelson<T, R> {
    fn add_force_and_energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) -> T {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.edge_modulus
            * memory.add_force_and_energy(execution, surface, &HingeFormula(self), force)
    }
}
