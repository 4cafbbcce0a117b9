//! Weight of the enclosed fluid.

use crate::element::{Corners, ElementKernel, Execution};
use crate::functional::{ComponentElements, closed_triangles, sixfold_volume};
use crate::mesh::TriangleMesh;
use crate::method::{Method, ParameterError, TwoPass};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, dot, scale, sub};
use alloc::vec::Vec;

/// Gravity and buoyancy: `E = −Δρ g·∫ (x − x_level) dV` over the interior of each closed component,
/// with Δρ the density inside minus the density outside and g the acceleration. The force is the
/// exact gradient of this integral over the polyhedron: the hydrostatic pressure `Δρ g·(x −
/// x_level)` on the triangles. Positive Δρ sinks along g.
///
/// The force is external: its sum is Δρ V g, and a translation by t changes the energy by −Δρ V
/// g·t. The level is the height at which inside and outside have the same pressure. Another level
/// adds a constant pressure, which has no effect where the volume is held. Components with boundary
/// enclose no volume and feel no force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gravity<T> {
    /// Δρ g, force per volume.
    pub weight: [T; 3],
    /// x_level, a point, preferably near the surface: large distances cost digits.
    pub level: [T; 3],
}

/// Memory of [`Gravity`].
#[derive(Clone, Debug)]
pub struct GravityMemory<T> {
    /// The triangles of the components without boundary.
    triangles: ComponentElements<3>,
    /// Δρ g·(x − x_level) of each vertex.
    pressures: Vec<[T; 1]>,
    /// ∫ Δρ g·(x − x_level) dV of each component.
    moments: Vec<T>,
}

/// Contributions of the pressure on a triangle to its corners: `∫ p φ_i dS n = (Σ p + p_i)/12 A n`.
struct Pressure;

impl<T: Real> ElementKernel<T, 3, 1, 3> for Pressure {
    #[inline(always)]
    fn evaluate(
        &self,
        _first: usize,
        corners: &Corners<T, 3>,
        pressures: &[[T; 1]; 3],
    ) -> [[T; 3]; 3] {
        let doubled = corners.triangle().area_vector;
        let sum = pressures[0][0] + pressures[1][0] + pressures[2][0];
        pressures.map(|[own]| scale(T::constant(1.0 / 24.0) * (sum + own), doubled))
    }
}

impl<T: Real> Method<T> for Gravity<T> {
    type Memory = GravityMemory<T>;

    fn memory(&self, mesh: &TriangleMesh) -> GravityMemory<T> {
        GravityMemory {
            triangles: closed_triangles(mesh),
            pressures: Vec::new(),
            moments: Vec::new(),
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_all_finite("weight per volume", self.weight)?;
        ParameterError::unless_all_finite("level of gravity", self.level)
    }
}

impl<T: Real> TwoPass for Gravity<T> {
    type Scalar = T;

    fn measure(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut GravityMemory<T>,
    ) {
        let positions = surface.positions();
        let pressures = &mut memory.pressures;
        pressures.resize(positions.len(), [T::zero()]);
        execution.map(&mut pressures[..], |vertex, pressure| {
            let above: Vec3<T> = sub(positions[vertex], self.level);
            let remainder = surface.remainders().map(|remainders| remainders[vertex]);
            let above = remainder.map_or(above, |remainder| add(above, remainder));
            *pressure = [dot(self.weight, above)];
        });
    }

    /// A sum over tetrahedra between the triangles and one vertex: the mean of the corners times
    /// the volume.
    fn measured_energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut GravityMemory<T>,
    ) -> T {
        let GravityMemory {
            triangles,
            pressures,
            moments,
        } = memory;
        let at = |vertex: u32| pressures[vertex as usize][0];
        moments.resize(triangles.components().count(), T::zero());
        triangles.sums(execution, moments, |[origin, ..], triangle| {
            let [a, b, c] = triangle.map(at);
            let mean = T::constant(0.25) * (at(origin) + a + b + c);
            mean * sixfold_volume(surface, origin, triangle) / T::constant(6.0)
        });
        -moments.iter().copied().sum::<T>()
    }

    fn add_measured_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut GravityMemory<T>,
        force: &mut [[T; 3]],
    ) {
        let (triangles, pressures) = (memory.triangles.all(), &memory.pressures);
        execution.scatter(&Pressure, surface, triangles, pressures, force);
    }
}
