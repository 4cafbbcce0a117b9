//! Suction into a pipette.

use crate::element::{Corners, ElementKernel, Execution};
use crate::functional::{ComponentElements, closed_triangles};
use crate::mesh::TriangleMesh;
use crate::method::{Method, ParameterError, TwoPass};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, cross, dot, scale, sub};
use alloc::vec::Vec;

/// Suction behind the mouth of a pipette: `E = −Δp ∫ S(h/λ) dV` over the interior of each closed component, with
/// `S(t) = 1/(1 + e^(−t))` and the depth h behind the mouth, along the axis of the pipette.
///
/// The volume integral is a flux: `E = −Δp ∮ λ ln(1 + e^(h/λ)) a·n dS`, by the mean of the corners of each triangle. The
/// force is its exact gradient: a pressure that sets in over some λ at the mouth, and is Δp behind. In the limit λ → 0 a
/// membrane with the tension σ rests in the mouth of radius R as a cap of the curvature `Δp/2σ` more than outside; from
/// `Δp = 2σ (1/R − 1/R_v)` on it flows in: E. Evans and W. Rawicz, Phys. Rev. Lett. 64 (1990) 2094.
///
/// The force is external. Components with boundary enclose no volume and feel no force. The walls of the pipette are
/// another matter: see [`crate::Repulsion`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aspiration<T> {
    /// Δp, force per area; positive if it sucks.
    pub pressure: T,
    /// A point of the plane of the mouth, preferably near the surface: large distances cost digits.
    pub mouth: [T; 3],
    /// Unit vector a along the axis, into the pipette.
    pub axis: [T; 3],
    /// λ, a length above 0.
    pub width: T,
}

/// Memory of [`Aspiration`].
#[derive(Clone, Debug)]
pub struct AspirationMemory<T> {
    /// The triangles of the components without boundary.
    triangles: ComponentElements<3>,
    /// `Q = Δp λ ln(1 + e^(h/λ))` of each vertex, and Q′.
    potentials: Vec<[T; 2]>,
    /// The energy of each component.
    energies: Vec<T>,
}

/// Forces on the corners of a triangle: `Q′_i/3 (a·N) a + Q̄ ∂(a·N)/∂x_i`, N its area vector.
struct Suction<T> {
    axis: Vec3<T>,
}

impl<T: Real> ElementKernel<T, 3, 2, 3> for Suction<T> {
    #[inline(always)]
    fn evaluate(
        &self,
        _first: usize,
        corners: &Corners<T, 3>,
        potentials: &[[T; 2]; 3],
    ) -> [[T; 3]; 3] {
        let triangle = corners.triangle();
        let sixth = T::constant(1.0 / 6.0);
        let across = sixth * dot(self.axis, triangle.area_vector);
        let mean = sixth * (potentials[0][0] + potentials[1][0] + potentials[2][0]);
        core::array::from_fn(|corner| {
            let side = triangle.edges[corner];
            let turned = cross(self.axis, side);
            add(
                scale(across * potentials[corner][1], self.axis),
                scale(mean, turned),
            )
        })
    }
}

impl<T: Real> Method<T> for Aspiration<T> {
    type Memory = AspirationMemory<T>;

    fn memory(&self, mesh: &TriangleMesh) -> AspirationMemory<T> {
        AspirationMemory {
            triangles: closed_triangles(mesh),
            potentials: Vec::new(),
            energies: Vec::new(),
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_finite("pressure of the aspiration", self.pressure)?;
        ParameterError::unless_all_finite("mouth of the pipette", self.mouth)?;
        ParameterError::unless_all_finite("axis of the pipette", self.axis)?;
        ParameterError::unless_finite("width of the mouth's pressure", self.width)?;
        ParameterError::unless_finite("inverse width of the mouth's pressure", self.width.recip())
    }
}

impl<T: Real> TwoPass for Aspiration<T> {
    type Scalar = T;

    fn measure(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut AspirationMemory<T>,
    ) {
        let positions = surface.positions();
        let potentials = &mut memory.potentials;
        potentials.resize(positions.len(), [T::zero(); 2]);
        execution.map(&mut potentials[..], |vertex, potential| {
            let behind = sub(positions[vertex], self.mouth);
            let remainder = surface.remainders().map(|remainders| remainders[vertex]);
            let behind = remainder.map_or(behind, |remainder| add(behind, remainder));
            let depth = dot(self.axis, behind) / self.width;
            // The exponential of a number that is not positive does not overflow.
            let small = (-depth.abs()).exp();
            let share = (T::one() + small).recip();
            let share = if depth > T::zero() {
                share
            } else {
                small * share
            };
            let softened = depth.max(T::zero()) + small.ln_1p();
            *potential = [self.pressure * self.width * softened, self.pressure * share];
        });
    }

    fn measured_energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut AspirationMemory<T>,
    ) -> T {
        let AspirationMemory {
            triangles,
            potentials,
            energies,
        } = memory;
        energies.resize(triangles.components().count(), T::zero());
        triangles.sums(execution, energies, |_, triangle| {
            let [a, b, c] = triangle.map(|vertex| potentials[vertex as usize][0]);
            let corners = Corners::<T, 3>::of(surface, triangle);
            T::constant(1.0 / 6.0) * dot(self.axis, corners.triangle().area_vector) * (a + b + c)
        });
        -energies.iter().copied().sum::<T>()
    }

    fn add_measured_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut AspirationMemory<T>,
        force: &mut [[T; 3]],
    ) {
        let kernel = Suction { axis: self.axis };
        let (triangles, potentials) = (memory.triangles.all(), &memory.potentials);
        execution.scatter(&kernel, surface, triangles, potentials, force);
    }
}
