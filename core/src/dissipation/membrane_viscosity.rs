//! A membrane that flows in its own plane.
//!
//! L. E. Scriven, Chem. Eng. Sci. 12 (1960) 98, whose dilational and shear viscosities κ and ε are
//! the two here; for membranes with elasticity D. Barthès-Biesel and H. Sgaier, J. Fluid Mech. 160
//! (1985) 119.

use super::Dissipation;
use crate::elasticity::Change;
use crate::element::{Corners, ElementKernel, Execution};
use crate::lane::Lane;
use crate::mesh::TriangleMesh;
use crate::method::{Method, ParameterError, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, dot, sub};

/// Boussinesq–Scriven surface viscosity on flat triangles:
///
/// `R = Σ A [η_s |dev d|² + η_d/2 (tr d)²]`, d the rate of strain in the plane of each triangle,
/// `dev d = d − ½ (tr d) P`, P the projector on the plane.
///
/// The surface stress is `τ = (η_d − η_s) (tr d) P + 2 η_s d`: η_s resists shear alone, η_d
/// changes of area alone. A shear flow at rate γ̇ in a flat sheet dissipates `η_s γ̇²` per area, a
/// growing sphere `4 η_d (Ṙ/R)²`. The velocity is linear on each triangle, so the rate of strain,
/// computed from the rates of the squared edges, is exact. Velocities normal to a curved membrane
/// contribute, because they stretch it.
///
/// Triangles without area contribute nothing and are reported by [`Method::inspect`].
///
/// ```
/// use helfrich::{MembraneViscosity, Prepared, Surface, TriangleMesh};
///
/// let mesh = TriangleMesh::new(3, vec![[0, 1, 2]])?;
/// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let surface = Surface::new(&mesh, &points)?;
/// let viscosity = MembraneViscosity { shear: 0.3, dilational: 0.0 };
/// let mut viscosity = Prepared::new(viscosity, &mesh);
///
/// // Sheared along x at the rate 2: η_s γ̇² A.
/// let velocities = points.map(|[_, y, _]| [2.0 * y, 0.0, 0.0]);
/// let power: f64 = viscosity.dissipated_power(surface, &velocities);
/// assert!((power - 0.3 * 4.0 * 0.5).abs() < 1e-15);
///
/// let mut force = [[0.0; 3]; 3];
/// viscosity.add_dissipative_force(surface, &velocities, &mut force);
/// assert!(force[2][0] < 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MembraneViscosity<T> {
    /// Shear viscosity η_s of the surface, in units of force times time per length.
    pub shear: T,
    /// Dilational viscosity η_d, in the same units.
    pub dilational: T,
}

/// Triangles in motion, one per lane entry.
struct Moving<L> {
    edges: [Vec3<L>; 3],
    /// The rate of strain 2 d, which takes the place of Γ.
    rate: Change<L>,
    area: L,
}

impl<L: Lane> Moving<L> {
    #[inline(always)]
    fn new(corners: &Corners<L, 3>, velocities: &[Vec3<L>; 3]) -> Self {
        let triangle = corners.triangle();
        let edges = triangle.edges;
        let [a, b, c] = *velocities;
        let rates = [sub(c, b), sub(a, c), sub(b, a)];
        let of_dot = |i: usize, j: usize| {
            -(triangle.reciprocal * (dot(edges[i], rates[j]) + dot(rates[i], edges[j])))
        };
        Self {
            edges,
            rate: Change {
                cotangents: triangle.cotangents(),
                of_dots: [of_dot(1, 2), of_dot(2, 0), of_dot(0, 1)],
            },
            area: L::literal(0.5) * triangle.doubled_area,
        }
    }
}

impl<T: Real> MembraneViscosity<T> {
    /// The factors a and b of `2R/A = ½ (a (tr 2d)² + b det 2d)`; from `|dev d|² = ½ (tr d)² − 2 det d`.
    #[inline(always)]
    fn factors<L: Lane<Scalar = T>>(&self) -> [L; 2] {
        let half = L::literal(0.5);
        let (shear, dilational) = (L::splat(self.shear), L::splat(self.dilational));
        [half * (shear + dilational), -(shear + shear)]
    }
}

/// −∂R/∂v: with `R = A (¼ a t² + ¼ b Δ)` it is the force of an energy whose change is
/// `A (½ a t dt + ¼ b dΔ)`.
impl<T: Real> ElementKernel<T, 3, 3, 3> for MembraneViscosity<T> {
    #[inline(always)]
    fn evaluate(
        &self,
        _first: usize,
        corners: &Corners<T, 3>,
        velocities: &[[T; 3]; 3],
    ) -> [[T; 3]; 3] {
        let Moving { edges, rate, .. } = Moving::new(corners, velocities);
        let [a, b] = self.factors::<T>();
        let weights = [T::constant(0.5) * a * rate.trace(), T::constant(0.25) * b];
        rate.forces(edges, weights)
    }
}

impl<T: Real> Method<T> for MembraneViscosity<T> {
    type Memory = ();
    const NEEDS_AREAS: bool = true;

    fn memory(&self, _mesh: &TriangleMesh) {}

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_finite("shear viscosity of the membrane", self.shear)?;
        ParameterError::unless_finite("dilational viscosity of the membrane", self.dilational)
    }
}

impl<T: Real> Dissipation<T> for MembraneViscosity<T> {
    fn add_dissipative_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        velocities: &[[T; 3]],
        force: &mut [[T; 3]],
    ) {
        workspace.for_mesh(surface.mesh());
        let triangles = surface.mesh().triangles();
        execution.scatter(self, surface, triangles, velocities, force);
    }

    fn dissipated_power(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        velocities: &[[T; 3]],
    ) -> T {
        workspace.for_mesh(surface.mesh());
        let triangles = surface.mesh().triangles();
        let [a, b] = self.factors::<T>();
        execution.sum(triangles.len(), |triangle| {
            let corners = triangles[triangle];
            let of = corners.map(|vertex| velocities[vertex as usize]);
            let Moving { rate, area, .. } = Moving::new(&Corners::of(surface, corners), &of);
            let trace = rate.trace();
            T::constant(0.5) * area * (a * trace * trace + b * rate.determinant())
        })
    }
}
