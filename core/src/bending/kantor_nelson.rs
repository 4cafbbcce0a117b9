//! Method A: dihedral angles.
//!
//! Y. Kantor and D. R. Nelson, Phys. Rev. Lett. 58 (1987) 2774; on the choice of the edge modulus
//! H. S. Seung and D. R. Nelson, Phys. Rev. A 38 (1988) 1005, and G. Gompper and D. M. Kroll,
//! J. Phys. I France 6 (1996) 1305.

use crate::bending::hinge::{Hinge, Hinges};
use crate::diagnostic::Finding;
use crate::elasticity::ReferenceError;
use crate::element::{Corners, ElementKernel, Execution};
use crate::lane::Lane;
use crate::mesh::TriangleMesh;
use crate::mesh_identity::MeshIdentity;
use crate::method::{Conservative, Energy, Force, Method, ParameterError, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::add;
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

struct HingeForce<T, R> {
    edge_modulus: T,
    reference: R,
}

impl<T: Real, R: Reference<T>> ElementKernel<T, 4, 0, 3> for HingeForce<T, R> {
    /// −∂E/∂x = −k̃ sin(θ − θ0) ∂θ/∂x. The sine is a difference of products that are equal to the
    /// last bit in the reference shape, so that the force is exactly zero there.
    #[inline(always)]
    fn evaluate(&self, first: usize, corners: &Corners<T, 4>, _input: &[[T; 0]; 4]) -> [[T; 3]; 4] {
        let hinge = Hinge::new(corners);
        let [sine, cosine] = self.reference.angle::<T>(first);
        let turned = hinge.sine * cosine - hinge.cosine * sine;
        hinge.forces(corners, self.edge_modulus * turned * hinge.presence)
    }
}

/// [`HingeForce`] and [`HingeEnergy`] at once.
struct HingeForceAndEnergy<T, R>(HingeForce<T, R>);

impl<T: Real, R: Reference<T>> ElementKernel<T, 4, 0, 4> for HingeForceAndEnergy<T, R> {
    #[inline(always)]
    fn evaluate(&self, first: usize, corners: &Corners<T, 4>, input: &[[T; 0]; 4]) -> [[T; 4]; 4] {
        let force: [[T; 3]; 4] = self.0.evaluate(first, corners, input);
        let reference = self.0.reference;
        let energy: [[T; 1]; 4] = HingeEnergy { reference }.evaluate(first, corners, input);
        core::array::from_fn(|k| [force[k][0], force[k][1], force[k][2], energy[k][0]])
    }
}

/// Half of a hinge's energy, in units of k̃, for each end of its edge.
struct HingeEnergy<R> {
    reference: R,
}

impl<T: Real, R: Reference<T>> ElementKernel<T, 4, 0, 1> for HingeEnergy<R> {
    #[inline(always)]
    fn evaluate(&self, first: usize, corners: &Corners<T, 4>, _input: &[[T; 0]; 4]) -> [[T; 1]; 4] {
        let half = T::constant(0.5) * energy(&Hinge::new(corners), self.reference.angle(first));
        [[half], [half], [T::zero()], [T::zero()]]
    }
}

/// Memory of [`KantorNelson`].
#[derive(Clone, Debug)]
pub struct KantorNelsonMemory<T> {
    hinges: Hinges,
    /// Half of the energies of the edges at each vertex, in units of k̃.
    energies: Vec<[T; 1]>,
    /// The force at each vertex, and the same energy.
    nodal: Vec<[T; 4]>,
}

impl<T: Real> KantorNelsonMemory<T> {
    /// Allocates all buffers together, so that no later evaluation allocates.
    fn resize(&mut self, vertices: usize) {
        self.energies.resize(vertices, [T::zero()]);
        self.nodal.resize(vertices, [T::zero(); 4]);
    }
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
            energies: Vec::new(),
            nodal: Vec::new(),
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_finite("modulus of an edge", self.edge_modulus)
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
    fn sum_energies(
        &self,
        execution: &impl Execution,
        hinges: &[[u32; 4]],
        surface: Surface<'_, T>,
        energies: &mut [[T; 1]],
        reference: impl Reference<T>,
    ) -> T {
        energies.fill([T::zero()]);
        execution.scatter(&HingeEnergy { reference }, surface, hinges, &[], energies);
        self.edge_modulus * execution.sum(energies.len(), |vertex| energies[vertex][0])
    }

    fn add_both(
        &self,
        execution: &impl Execution,
        hinges: &[[u32; 4]],
        surface: Surface<'_, T>,
        nodal: &mut [[T; 4]],
        force: &mut [[T; 3]],
        reference: impl Reference<T>,
    ) -> T {
        nodal.fill([T::zero(); 4]);
        let edge_modulus = self.edge_modulus;
        let kernel = HingeForceAndEnergy(HingeForce {
            edge_modulus,
            reference,
        });
        execution.scatter(&kernel, surface, hinges, &[], nodal);
        let nodal = &*nodal;
        execution.map(&mut force[..nodal.len()], |vertex, force| {
            let [x, y, z, _] = nodal[vertex];
            *force = add(*force, [x, y, z]);
        });
        edge_modulus * execution.sum(nodal.len(), |vertex| nodal[vertex][3])
    }
}

impl<T: Real> Energy<T> for KantorNelson<T> {
    fn energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
    ) -> T {
        let memory = workspace.for_mesh_mut(surface.mesh());
        memory.resize(surface.mesh().vertex_count());
        let KantorNelsonMemory {
            hinges, energies, ..
        } = memory;
        let hinges = &hinges.vertices[..];
        if self.reference.is_empty() {
            self.sum_energies(execution, hinges, surface, energies, Flat)
        } else {
            let reference = self.reference.as_slice();
            self.sum_energies(execution, hinges, surface, energies, reference)
        }
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
        let memory = workspace.for_mesh_mut(surface.mesh());
        memory.resize(surface.mesh().vertex_count());
        let edge_modulus = self.edge_modulus;
        if self.reference.is_empty() {
            let kernel = HingeForce {
                edge_modulus,
                reference: Flat,
            };
            execution.scatter(&kernel, surface, &memory.hinges.vertices, &[], force);
        } else {
            let reference = self.reference.as_slice();
            let kernel = HingeForce {
                edge_modulus,
                reference,
            };
            execution.scatter(&kernel, surface, &memory.hinges.vertices, &[], force);
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
        let memory = workspace.for_mesh_mut(surface.mesh());
        memory.resize(surface.mesh().vertex_count());
        let KantorNelsonMemory { hinges, nodal, .. } = memory;
        let hinges = &hinges.vertices[..];
        if self.reference.is_empty() {
            self.add_both(execution, hinges, surface, nodal, force, Flat)
        } else {
            let reference = self.reference.as_slice();
            self.add_both(execution, hinges, surface, nodal, force, reference)
        }
    }
}
