//! In-plane elasticity relative to a reference shape.
//!
//! # The laws
//!
//! A strain energy per area of the reference, `W(I1, I2)`, with the invariants of R. Skalak,
//! A. Tozeren, R. P. Zarda and S. Chien, Biophys. J. 13 (1973) 245:
//! `I1 = λ1² + λ2² − 2`, `I2 = λ1² λ2² − 1`, λ the principal stretches. A flat triangle is stretched
//! homogeneously, so that `E = Σ A0 W` and its gradient are exact, A0 the area in the reference.
//!
//! # Small strains
//!
//! `W → ½ K_s (tr ε)² + G |dev ε|²`: every law has a shear modulus G and an area modulus K_s, in
//! units of force per length. From them follow the Young modulus `E_s = 4 K_s G/(K_s + G)` and the
//! Poisson ratio `ν_s = (K_s − G)/(K_s + G)` of the surface.
//!
//! | law | K_s | E_s | ν_s |
//! |---|---|---|---|
//! | [`NeoHookean`] | 3 G | 3 G | 1/2 |
//! | [`Skalak`] | (1 + 2 C) G | 2 G (1 + 2 C)/(1 + C) | C/(1 + C) |
//! | [`LocalArea`], on its own a fluid | k_a | 0 | 1 |
//!
//! Much of the literature on capsules scales by E_s and not by G. For a neo-Hookean membrane
//! `μ γ̇ a/E_s = 0.05` is `μ γ̇ a/G = 0.15`, and `κ/(a² E_s) = 0.0375` is `κ/(a² G) = 0.1125`. Here
//! all moduli are G.
//!
//! # Forces
//!
//! With `s_k` the scalar product of the two edges that leave corner k, S the doubled area, the
//! index 0 for the reference, `c_k = s0_k/S0` (a cotangent) and `γ_k = (s_k − s0_k)/S0`:
//!
//! `Γ = C − 1`, `tr Γ = Σ_k c_k (γ_i + γ_j)`, `det Γ = γ_0 γ_1 + γ_1 γ_2 + γ_2 γ_0`,
//! `I1 = tr Γ`, `I2 = tr Γ + det Γ`,
//!
//! and each edge pulls its ends together with `[(W1 + W2) c_k + W2 γ_k] e_k`, `W1 = ∂W/∂I1`,
//! `W2 = ∂W/∂I2`. This equals the usual form `2 A0 F (W1 1 + W2 cof C) D0⁻ᵀ`, but needs no local
//! frame, rotation or square root. The idea of forces along the edges is from H. Delingette, IEEE
//! Trans. Vis. Comput. Graph. 14 (2008) 329.
//!
//! In a triangle that is stretched λ times along one axis only, the terms `W2 γ_k e_k` cancel to the share
//! 1/λ of their size. Where half of the digits are lost, the triangle is reported.
//!
//! Differences from the reference are taken before any multiplication, and laws are written in `Γ`.
//! Small strains therefore lose no digits beyond those of the positions, and in the reference shape
//! energy and forces are exactly zero. In f32, at a strain of 1e-4, the error of the neo-Hookean
//! energy is 1e-5; computed from `tr C − 2` and `det C − 1` it would be 7 %.

use crate::diagnostic::Finding;
use crate::element::{Corners, ElementEnergy, ElementMemory, Execution};
use crate::lane::Lane;
use crate::mesh::TriangleMesh;
use crate::mesh_identity::MeshIdentity;
use crate::method::{Conservative, Energy, Force, Method, ParameterError, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use crate::triangle::Triangle;
use crate::vec3::{Vec3, add, cross, dot, scale, sub};
use alloc::vec::Vec;

mod local_area;
mod neo_hookean;
mod skalak;

pub use local_area::LocalArea;
pub use neo_hookean::NeoHookean;
pub use skalak::Skalak;

/// The strain of a triangle, in the form that laws need.
#[derive(Clone, Copy, Debug)]
pub struct Strain<T> {
    /// `I1 = λ1² + λ2² − 2`.
    pub first: T,
    /// `I2 = λ1² λ2² − 1`.
    pub second: T,
    /// `I1 − I2 = −(λ1² − 1)(λ2² − 1)`: of second order in the strain, and computed without
    /// cancellation.
    pub difference: T,
    /// `I2 + 1 = (A/A0)²`, from the areas: never negative.
    pub squared_area_ratio: T,
    /// Whether `I1 < 1`. Small strains are computed from det Γ, whose products are then small.
    /// Large strains are computed from the ratio of the areas, because the products in det Γ grow
    /// with the fourth power of the stretch and would cancel.
    pub is_small: bool,
}

impl<T: Real> Strain<T> {
    #[inline(always)]
    fn new(change: &Change<T>, squared_area_ratio: T) -> Self {
        let (trace, determinant) = (change.trace(), change.determinant());
        let is_small = trace < T::one();
        let dilation = squared_area_ratio - T::one();
        Self {
            first: trace,
            second: T::select(is_small, trace + determinant, dilation),
            difference: T::select(is_small, -determinant, trace - dilation),
            squared_area_ratio,
            is_small,
        }
    }
}

/// A strain energy per area of the reference: see the [module](self).
///
/// Laws: W and `W1 + W2` are 0 without strain, and W ≥ 0 for moduli that are not negative.
///
/// A law is plain arithmetic. The loop over triangles becomes vector instructions where a law has
/// no branch and calls no function that is not inlined.
///
/// ```
/// use helfrich::elasticity::Strain;
/// use helfrich::{InPlane, Prepared, StrainEnergy, Surface, TriangleMesh};
///
/// /// `W = k I1²`.
/// struct Squared(f64);
///
/// impl StrainEnergy<f64> for Squared {
///     fn density(&self, strain: &Strain<f64>) -> f64 {
///         self.0 * strain.first * strain.first
///     }
///     fn derivatives(&self, strain: &Strain<f64>) -> [f64; 2] {
///         [2.0 * self.0 * strain.first, 0.0]
///     }
///     fn shear_modulus(&self) -> f64 {
///         0.0
///     }
///     fn area_modulus(&self) -> f64 {
///         8.0 * self.0
///     }
/// }
///
/// let mesh = TriangleMesh::new(3, vec![[0, 1, 2]])?;
/// let rest = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let law = InPlane::new(Squared(3.0), &mesh, Surface::new(&mesh, &rest)?)?;
/// let doubled = rest.map(|point| point.map(|x| 2.0 * x));
/// // I1 = 2² + 2² − 2 = 6, on half a unit of area.
/// let energy = Prepared::new(law, &mesh).energy(Surface::new(&mesh, &doubled)?);
/// assert!((energy - 0.5 * 3.0 * 36.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait StrainEnergy<T: Real>: Sync {
    /// W, in units of energy per area.
    fn density(&self, strain: &Strain<T>) -> T;

    /// `[W1 + W2, W2]` with `W1 = ∂W/∂I1` and `W2 = ∂W/∂I2`. The sum is 0 without strain, and must
    /// be written without cancellation.
    fn derivatives(&self, strain: &Strain<T>) -> [T; 2];

    /// Shear modulus G at small strain.
    fn shear_modulus(&self) -> T;

    /// Area modulus K_s at small strain.
    fn area_modulus(&self) -> T;
}

/// The sum of two laws with the same reference; longer sums nest.
impl<T: Real, A: StrainEnergy<T>, B: StrainEnergy<T>> StrainEnergy<T> for (A, B) {
    #[inline(always)]
    fn density(&self, strain: &Strain<T>) -> T {
        self.0.density(strain) + self.1.density(strain)
    }

    #[inline(always)]
    fn derivatives(&self, strain: &Strain<T>) -> [T; 2] {
        let (a, b) = (self.0.derivatives(strain), self.1.derivatives(strain));
        [a[0] + b[0], a[1] + b[1]]
    }

    fn shear_modulus(&self) -> T {
        self.0.shear_modulus() + self.1.shear_modulus()
    }

    fn area_modulus(&self) -> T {
        self.0.area_modulus() + self.1.area_modulus()
    }
}

/// The reason why a shape cannot be the reference of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReferenceError {
    /// Mesh and reference have different numbers of triangles.
    #[error("the reference has {reference} triangles, the mesh {mesh}: they must be the same")]
    CountMismatch {
        /// Number of triangles of the reference.
        reference: usize,
        /// Number of triangles of the mesh.
        mesh: usize,
    },
    /// A triangle has other vertices, or the same ones in another order.
    #[error(
        "triangle {triangle} has the vertices {reference:?} in the reference and {mesh:?} in the \
         mesh: they must be the same, in the same order"
    )]
    TriangleMismatch {
        /// The first such triangle.
        triangle: usize,
        /// Its vertices in the reference.
        reference: [u32; 3],
        /// Its vertices in the mesh.
        mesh: [u32; 3],
    },
    /// A triangle of the reference has no area: no strain can be measured from it.
    #[error("triangle {triangle} of the reference has no area")]
    NoArea {
        /// The first such triangle.
        triangle: usize,
    },
    /// The scale factor of the reference is not a positive finite number.
    #[error("the reference cannot be scaled by {factor}: a positive, finite number is needed")]
    Factor {
        /// The factor.
        factor: f64,
    },
}

impl ReferenceError {
    /// Nothing, if both meshes have the same triangles in the same order.
    pub(crate) fn unless_same(
        mesh: &TriangleMesh,
        reference: &TriangleMesh,
    ) -> Result<(), ReferenceError> {
        let (mesh, reference) = (mesh.triangles(), reference.triangles());
        if mesh.len() != reference.len() {
            return Err(Self::CountMismatch {
                reference: reference.len(),
                mesh: mesh.len(),
            });
        }
        match (0..mesh.len()).find(|&triangle| mesh[triangle] != reference[triangle]) {
            None => Ok(()),
            Some(triangle) => Err(Self::TriangleMismatch {
                triangle,
                reference: reference[triangle],
                mesh: mesh[triangle],
            }),
        }
    }
}

/// Rest shape of a triangle: `s0_k` of the three corners, and S0.
type Rest<T> = [T; 4];

/// `E = Σ A0 W`: the in-plane energy of a law over a reference shape, see the [module](self); the
/// force is its exact gradient.
///
/// Triangles that have lost their area are reported by [`Method::inspect`]; their contributions are
/// finite, see each law.
///
/// ```
/// use helfrich::{InPlane, Prepared, Skalak, Surface, TriangleMesh};
///
/// let mesh = TriangleMesh::new(3, vec![[0, 1, 2]])?;
/// let rest = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let skalak = Skalak { shear_modulus: 5.3, area_ratio: 10.0 };
/// let law = InPlane::new(skalak, &mesh, Surface::new(&mesh, &rest)?)?;
///
/// let mut elasticity = Prepared::new(law, &mesh);
/// assert_eq!(elasticity.energy(Surface::new(&mesh, &rest)?), 0.0);
///
/// // Stretched along x: G/4 (I1² + 2 I1 − 2 I2 + C I2²) with I1 = I2 = 0.21, on half a unit of area.
/// let now = [[0.0, 0.0, 0.0], [1.1, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mut force = [[0.0; 3]; 3];
/// let energy = elasticity.add_force_and_energy(Surface::new(&mesh, &now)?, &mut force);
/// assert!((energy - 0.5 * 5.3 / 4.0 * 11.0 * 0.21 * 0.21_f64).abs() < 1e-14);
/// assert!(force[1][0] < 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct InPlane<T, W> {
    /// The law.
    pub law: W,
    rest: Vec<Rest<T>>,
    /// The mesh with which the triangles of the reference agree.
    mesh: MeshIdentity,
}

impl<T: Real, W: StrainEnergy<T>> InPlane<T, W> {
    /// The law with the edges and areas of `reference`, for surfaces with the mesh `mesh`. Both
    /// must have the same triangles. The shape of the reference may differ from the initial shape
    /// of a simulation.
    ///
    /// Preparing the law for any mesh other than `mesh` panics.
    ///
    /// # Errors
    /// If the triangles of mesh and reference differ, or one of the reference has no area.
    pub fn new(
        law: W,
        mesh: &TriangleMesh,
        reference: Surface<'_, T>,
    ) -> Result<Self, ReferenceError> {
        ReferenceError::unless_same(mesh, reference.mesh())?;
        let rest = |&corners| {
            let triangle = Corners::of(reference, corners).triangle();
            let [a, b, c] = triangle.dots;
            [a, b, c, triangle.doubled_area]
        };
        Self {
            law,
            rest: mesh.triangles().iter().map(rest).collect(),
            mesh: MeshIdentity::of(mesh),
        }
        .with_areas()
    }

    /// The same law with every length of the reference multiplied by `factor`. The membrane in the
    /// given shape is under tension if the factor is below 1, and under compression if it is above
    /// 1.
    ///
    /// # Errors
    /// If the factor is not positive and finite, or leaves a triangle without area.
    pub fn with_scaled_reference(mut self, factor: T) -> Result<Self, ReferenceError> {
        if !(factor > T::zero() && factor.is_finite()) {
            let factor = factor.to_f64().unwrap_or(f64::NAN);
            return Err(ReferenceError::Factor { factor });
        }
        for rest in &mut self.rest {
            *rest = rest.map(|entry| entry * factor * factor);
        }
        self.with_areas()
    }

    /// The law itself, if every triangle of the reference has an area.
    fn with_areas(self) -> Result<Self, ReferenceError> {
        let without = |rest: &Rest<T>| rest[3].reciprocal_or_zero() == T::zero();
        match self.rest.iter().position(without) {
            None => Ok(self),
            Some(triangle) => Err(ReferenceError::NoArea { triangle }),
        }
    }

    /// Area of the reference.
    pub fn reference_area(&self, execution: &impl Execution) -> T {
        T::constant(0.5) * execution.sum(self.rest.len(), |triangle| self.rest[triangle][3])
    }
}

/// The change of a triangle's edges from one shape to another, or its rate: `c_k` and `γ_k` of the
/// [module](self), for each corner.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Change<L> {
    pub(crate) cotangents: [L; 3],
    pub(crate) of_dots: [L; 3],
}

impl<L: Lane> Change<L> {
    /// tr Γ.
    #[inline(always)]
    pub(crate) fn trace(&self) -> L {
        let ([a, b, c], [u, v, w]) = (self.cotangents, self.of_dots);
        a * (v + w) + b * (w + u) + c * (u + v)
    }

    /// det Γ.
    #[inline(always)]
    pub(crate) fn determinant(&self) -> L {
        let [u, v, w] = self.of_dots;
        u * v + v * w + w * u
    }

    /// Forces on the corners, if `A0 (a d tr Γ + b d det Γ)` is the change of the energy.
    #[inline(always)]
    pub(crate) fn forces(&self, edges: [Vec3<L>; 3], [a, b]: [L; 2]) -> [Vec3<L>; 3] {
        let pull: [Vec3<L>; 3] =
            core::array::from_fn(|k| scale(a * self.cotangents[k] + b * self.of_dots[k], edges[k]));
        [
            sub(pull[2], pull[1]),
            sub(pull[0], pull[2]),
            sub(pull[1], pull[0]),
        ]
    }
}

/// A triangle of a surface relative to its rest shape.
struct Strained<T> {
    edges: [Vec3<T>; 3],
    change: Change<T>,
    /// The normal with the length S/S0.
    ratio: Vec3<T>,
    strain: Strain<T>,
    /// S0.
    doubled_area: T,
}

impl<T: Real> Strained<T> {
    #[inline(always)]
    fn new(rest: &Rest<T>, corners: &Corners<T, 3>) -> Self {
        let Triangle {
            edges,
            dots,
            area_vector,
            ..
        } = corners.triangle();
        let [a, b, c, doubled_area] = *rest;
        let over = doubled_area.reciprocal_or_zero();
        let rest_dots = [a, b, c];
        let change = Change {
            cotangents: rest_dots.map(|dot| over * dot),
            of_dots: core::array::from_fn(|k| over * (dots[k] - rest_dots[k])),
        };
        let ratio = scale(over, area_vector);
        Self {
            edges,
            change,
            ratio,
            strain: Strain::new(&change, dot(ratio, ratio)),
            doubled_area,
        }
    }

    #[inline(always)]
    fn forces(&self, law: &impl StrainEnergy<T>) -> [Vec3<T>; 3] {
        self.change
            .forces(self.edges, law.derivatives(&self.strain))
    }

    /// Whether the forces are numbers, and digits are left of them. Of a triangle that is stretched much
    /// more along one axis than along the other, the edge forces `W2 γ_k e_k` cancel each other. They are
    /// compared with the same by the gradient of the area, `−W2 (S/S0) n × e_k` beside `W1 c_k e_k`, which
    /// takes half as many instructions again.
    fn has_forces(&self, law: &impl StrainEnergy<T>) -> bool {
        let forces = self.forces(law);
        let [sum, second] = law.derivatives(&self.strain);
        let along = self.change.forces(self.edges, [sum - second, T::zero()]);
        let shrink = scale(-second, self.ratio);
        let largest = |most: T, vector: Vec3<T>| vector.iter().fold(most, |m, x| m.max(x.abs()));
        let (mut error, mut size) = (T::zero(), T::zero());
        for k in 0..3 {
            let exact = add(along[k], cross(shrink, self.edges[k]));
            error = largest(error, sub(forces[k], exact));
            size = largest(size, exact);
        }
        let finite = forces.as_flattened().iter().all(|force| force.is_finite());
        // Small strains are exact by edge forces alone.
        finite && (self.strain.is_small || error <= T::epsilon().sqrt() * size)
    }

    /// A third of the energy, for each corner.
    #[inline(always)]
    fn energy_share(&self, law: &impl StrainEnergy<T>) -> T {
        T::constant(1.0 / 6.0) * self.doubled_area * law.density(&self.strain)
    }
}

/// The energy of one triangle, a third to each corner.
impl<T: Real, W: StrainEnergy<T>> ElementEnergy<T, 3> for InPlane<T, W> {
    #[inline(always)]
    fn evaluate(&self, triangle: usize, corners: &Corners<T, 3>) -> ([[T; 3]; 3], [T; 3]) {
        let strained = Strained::new(&self.rest[triangle], corners);
        let share = strained.energy_share(&self.law);
        (strained.forces(&self.law), [share; 3])
    }
}

impl<T: Real, W: StrainEnergy<T>> Method<T> for InPlane<T, W> {
    type Memory = ElementMemory<T>;

    /// # Panics
    /// If the law was made for another mesh.
    fn memory(&self, mesh: &TriangleMesh) -> ElementMemory<T> {
        self.mesh
            .expect::<Self>(mesh, "make it by InPlane::new for that mesh");
        ElementMemory::default()
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_finite("shear modulus", self.law.shear_modulus())?;
        ParameterError::unless_finite("area modulus", self.law.area_modulus())
    }

    fn inspect(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        report: &mut dyn FnMut(Finding),
    ) {
        workspace.for_mesh(surface.mesh());
        surface.report_degenerate_triangles(report);
        for (triangle, &corners) in surface.mesh().triangles().iter().enumerate() {
            let strained = Strained::new(&self.rest[triangle], &Corners::of(surface, corners));
            let finite = strained.energy_share(&self.law).is_finite();
            if !(finite && strained.has_forces(&self.law)) {
                let triangle = triangle as u32;
                report(Finding::Overstretched { triangle });
            }
        }
    }
}

impl<T: Real, W: StrainEnergy<T>> Energy<T> for InPlane<T, W> {
    fn energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
    ) -> T {
        let memory = workspace.for_mesh_mut(surface.mesh());
        memory.energy(execution, surface, surface.mesh().triangles(), self)
    }
}

impl<T: Real, W: StrainEnergy<T>> Force<T> for InPlane<T, W> {
    fn add_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        memory.add_force(execution, surface, surface.mesh().triangles(), self, force);
    }
}

impl<T: Real, W: StrainEnergy<T>> Conservative<T> for InPlane<T, W> {
    fn add_force_and_energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) -> T {
        let triangles = surface.mesh().triangles();
        let memory = workspace.for_mesh_mut(surface.mesh());
        memory.add_force_and_energy(execution, surface, triangles, self, force)
    }
}
