//! Adhesion to a wall.

use crate::components::Components;
use crate::element::{Corners, ElementKernel, Execution};
use crate::functional::ComponentElements;
use crate::mesh::TriangleMesh;
use crate::method::{Method, ParameterError, TwoPass};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{add, dot, scale, sub};
use alloc::vec::Vec;

/// Adhesion to a plane wall: `E = ∫ V(z) dS` with Morse's potential
/// `V(z) = W (q² − 2 q)`, `q = exp(−(z − d)/λ)`, of the height z above the wall.
///
/// A membrane at the height d gains the energy W per area. It is repelled below this height, and
/// attracted above it over a few λ. The integral over a triangle is the area of the triangle times
/// the mean of V at its corners, and the force is the exact gradient of the sum. In the limit λ → 0
/// a vesicle meets the wall with the curvature √(2W/κ): U. Seifert, R. Lipowsky, Phys. Rev. A 42
/// (1990) 4768.
///
/// The force is external: only its components parallel to the wall sum to zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallAdhesion<T> {
    /// Adhesion energy per area W.
    pub strength: T,
    /// Height d of the minimum.
    pub distance: T,
    /// Length λ of the potential.
    pub range: T,
    /// A point of the wall, preferably near the surface: large distances cost digits.
    pub wall: [T; 3],
    /// Unit normal of the wall, towards the membrane.
    pub normal: [T; 3],
}

/// Memory of [`WallAdhesion`].
#[derive(Clone, Debug)]
pub struct WallAdhesionMemory<T> {
    triangles: ComponentElements<3>,
    /// V and −V′ of each vertex.
    potentials: Vec<[T; 2]>,
    /// The energy of each component.
    energies: Vec<T>,
}

/// Forces on the corners of a triangle of a potential V per area that depends on the place along a direction n, given as V
/// and −V′ at the vertices: `−V̄ ∂A/∂x_i − A/3 V′_i n`.
pub(crate) struct PotentialForce<T> {
    pub(crate) direction: [T; 3],
}

impl<T: Real> ElementKernel<T, 3, 2, 3> for PotentialForce<T> {
    #[inline(always)]
    fn evaluate(
        &self,
        _element: usize,
        corners: &Corners<T, 3>,
        potentials: &[[T; 2]; 3],
    ) -> [[T; 3]; 3] {
        let triangle = corners.triangle();
        let [[a, _], [b, _], [c, _]] = *potentials;
        let shrink = triangle.outward_edges(T::constant(-1.0 / 6.0) * (a + b + c));
        let third = T::constant(1.0 / 6.0) * triangle.doubled_area;
        core::array::from_fn(|corner| {
            let [_, slope] = potentials[corner];
            add(shrink[corner], scale(third * slope, self.direction))
        })
    }
}

impl<T: Real> Method<T> for WallAdhesion<T> {
    type Memory = WallAdhesionMemory<T>;
    const NEEDS_AREAS: bool = true;

    fn memory(&self, mesh: &TriangleMesh) -> WallAdhesionMemory<T> {
        let triangles = mesh.triangles().iter().copied();
        WallAdhesionMemory {
            triangles: ComponentElements::new(Components::new(mesh), triangles),
            potentials: Vec::new(),
            energies: Vec::new(),
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_finite("adhesion energy per area", self.strength)?;
        ParameterError::unless_finite("height of the minimum", self.distance)?;
        ParameterError::unless_finite("range of the adhesion", self.range)?;
        ParameterError::unless_finite("inverse range of the adhesion", self.range.recip())?;
        ParameterError::unless_all_finite("point of the wall", self.wall)?;
        ParameterError::unless_all_finite("normal of the wall", self.normal)
    }
}

impl<T: Real> TwoPass for WallAdhesion<T> {
    type Scalar = T;

    fn measure(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut WallAdhesionMemory<T>,
    ) {
        let positions = surface.positions();
        let potentials = &mut memory.potentials;
        potentials.resize(positions.len(), [T::zero(); 2]);
        let two = T::constant(2.0);
        execution.map(&mut potentials[..], |vertex, potential| {
            let above = sub(positions[vertex], self.wall);
            let remainder = surface.remainders().map(|remainders| remainders[vertex]);
            let above = remainder.map_or(above, |remainder| add(above, remainder));
            let q = ((self.distance - dot(self.normal, above)) / self.range).exp();
            let slope = two * self.strength / self.range * q * (q - T::one());
            *potential = [self.strength * q * (q - two), slope];
        });
    }

    fn measured_energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut WallAdhesionMemory<T>,
    ) -> T {
        let WallAdhesionMemory {
            triangles,
            potentials,
            energies,
        } = memory;
        energies.resize(triangles.components().count(), T::zero());
        triangles.sums(execution, energies, |_, triangle| {
            let [a, b, c] = triangle.map(|vertex| potentials[vertex as usize][0]);
            let corners = Corners::<T, 3>::of(surface, triangle);
            T::constant(1.0 / 6.0) * corners.triangle().doubled_area * (a + b + c)
        });
        energies.iter().copied().sum()
    }

    fn add_measured_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut WallAdhesionMemory<T>,
        force: &mut [[T; 3]],
    ) {
        let kernel = PotentialForce {
            direction: self.normal,
        };
        let (triangles, potentials) = (memory.triangles.all(), &memory.potentials);
        execution.scatter(&kernel, surface, triangles, potentials, force);
    }
}
