//! Two triangles that meet in an edge, and the angle between them.

use crate::diagnostic::Finding;
use crate::element::{Corners, ElementEnergy, ElementMemory, Execution};
use crate::lane::Lane;
use crate::mesh::TriangleMesh;
use crate::method::{Conservative, Energy, Force, Method, ParameterError, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, cross, dot, neg, norm, scale, sub};
use alloc::vec::Vec;

/// The interior edges of a mesh, each with its four vertices: the ends a and b, then the opposite
/// corner in the triangle on the left, then the one in the triangle on the right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hinges {
    pub(crate) vertices: Vec<[u32; 4]>,
}

impl Hinges {
    pub(crate) fn new(mesh: &TriangleMesh) -> Self {
        let opposite = |triangle: u32, [a, b]: [u32; 2]| {
            // The third corner is the exclusive or of the two ends and all three indices.
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

/// One hinge, two triangles at an edge: the sine and cosine of the angle θ between their normals,
/// positive where the surface is convex, and the ingredients of its gradient.
#[derive(Clone, Copy, Debug)]
pub struct Hinge<L> {
    edge: Vec3<L>,
    /// The length of the edge.
    pub edge_length: L,
    /// One over the edge's length.
    along: L,
    normals: [Vec3<L>; 2],
    reciprocals: [L; 2],
    /// cos θ.
    pub cosine: L,
    /// sin θ.
    pub sine: L,
    /// 1, or 0 where a triangle or the edge has no extent.
    pub presence: L,
}

impl<L: Lane> Hinge<L> {
    /// The hinge of two ends of an edge, the corner on its left and the one on its right.
    #[inline(always)]
    pub fn new(corners: &Corners<L, 4>) -> Self {
        let edge = corners.difference(0, 1);
        let left = cross(edge, corners.difference(0, 2));
        let right = cross(corners.difference(0, 3), edge);
        let edge_length = norm(edge);
        let lengths = [norm(left), norm(right)];
        let reciprocals = lengths.map(L::reciprocal_or_zero);
        let normals = [scale(reciprocals[0], left), scale(reciprocals[1], right)];
        let along = edge_length.reciprocal_or_zero();
        // Each factor is 1 to rounding, or 0, so that no product overflows.
        let sides = (lengths[0] * reciprocals[0]) * (lengths[1] * reciprocals[1]);
        let present = (edge_length * along) * sides;
        Self {
            edge,
            edge_length,
            along,
            normals,
            reciprocals,
            cosine: dot(normals[0], normals[1]),
            sine: dot(edge, cross(normals[0], normals[1])) * along,
            presence: L::select(L::zero().less(present), L::literal(1.0), L::zero()),
        }
    }

    /// θ in (−π, π]; 0 where a triangle or the edge has no extent.
    #[inline(always)]
    pub fn angle(&self) -> L {
        // If the hinge has no extent, sine and cosine are 0 or meaningless.
        self.presence * self.sine.atan2(self.cosine)
    }

    /// The unit vector along the edge; 0 for one without length.
    #[inline(always)]
    pub fn direction(&self) -> Vec3<L> {
        scale(self.along, self.edge)
    }

    /// `−torque ∂θ/∂x` at the four corners. Moving an opposite corner along the normal of its
    /// triangle lowers θ by the inverse of its height. The ends of the edge share the opposite
    /// force in proportion to the position of the corner's foot between them.
    #[inline(always)]
    pub fn forces(&self, corners: &Corners<L, 4>, torque: L) -> [Vec3<L>; 4] {
        let lever = |side: usize| scale(torque * self.reciprocals[side], self.normals[side]);
        let (left, right) = (lever(0), lever(1));
        // Scalar products of the edge with the vectors from its ends to the corner.
        let from_b = |corner: usize| dot(corners.difference(corner, 1), self.edge) * self.along;
        let from_a = |corner: usize| dot(corners.difference(0, corner), self.edge) * self.along;
        [
            neg(add(scale(from_b(2), left), scale(from_b(3), right))),
            neg(add(scale(from_a(2), left), scale(from_a(3), right))),
            scale(self.edge_length, left),
            scale(self.edge_length, right),
        ]
    }

    /// `weight ∂(l θ)/∂x = weight (θ ∂l + l ∂θ)` at the four corners, l the edge's length.
    #[inline(always)]
    pub fn length_times_angle_gradient(&self, corners: &Corners<L, 4>, weight: L) -> [Vec3<L>; 4] {
        let weight = weight * self.presence;
        let [a, b, left, right] = self.forces(corners, -(weight * self.edge_length));
        let stretch = scale(weight * self.angle(), self.direction());
        [sub(a, stretch), add(b, stretch), left, right]
    }
}

/// A bending method of your own, from the formula of one hinge: `E = Σ w` over the interior edges of
/// a mesh, and the forces that the formula gives.
///
/// The corners of a hinge are the two ends of the edge, the corner on its left and the one on its
/// right. A formula should contribute nothing where [`Hinge::presence`] is 0. Whether its forces are
/// the gradient of its energy, the laws of `helfrich-tests` show.
///
/// ```
/// use helfrich::bending::{Hinge, OverHinges};
/// use helfrich::element::{Corners, ElementEnergy};
/// use helfrich::{Prepared, Real, Surface, TriangleMesh};
///
/// /// w = 1 − cos θ, half of it for each end.
/// struct OfCosine;
///
/// impl<T: Real> ElementEnergy<T, 4> for OfCosine {
///     fn evaluate(&self, _: usize, corners: &Corners<T, 4>) -> ([[T; 3]; 4], [T; 4]) {
///         let hinge = Hinge::new(corners);
///         let half = T::constant(0.5) * hinge.presence * (T::one() - hinge.cosine);
///         let forces = hinge.forces(corners, hinge.presence * hinge.sine);
///         (forces, [half, half, T::zero(), T::zero()])
///     }
/// }
///
/// let mesh = TriangleMesh::new(4, vec![[0, 1, 2], [0, 3, 1]])?;
/// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let energy = Prepared::new(OverHinges(OfCosine), &mesh).energy(Surface::new(&mesh, &points)?);
/// assert_eq!(energy, 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverHinges<E>(pub E);

/// Memory of methods whose energy is a sum over hinges: [`OverHinges`] and
/// [`KantorNelson`](super::KantorNelson).
#[derive(Clone, Debug)]
pub struct HingeMemory<T> {
    hinges: Hinges,
    sums: ElementMemory<T>,
}

impl<T: Real> HingeMemory<T> {
    pub(crate) fn new(mesh: &TriangleMesh) -> Self {
        Self {
            hinges: Hinges::new(mesh),
            sums: ElementMemory::default(),
        }
    }

    /// Reports where a surface is too uneven or too rough for angles between triangles.
    pub(crate) fn inspect(surface: Surface<'_, T>, report: &mut dyn FnMut(Finding)) {
        surface.report_uneven_mesh(report);
        surface.report_valences(report);
        surface.report_rough_vertices(report);
    }

    /// The energy of all hinges by this formula.
    pub(crate) fn energy(
        &mut self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        formula: &impl ElementEnergy<T, 4>,
    ) -> T {
        let hinges = &self.hinges.vertices;
        self.sums.energy(execution, surface, hinges, formula)
    }

    /// Adds the nodal forces of all hinges.
    pub(crate) fn add_force(
        &mut self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        formula: &impl ElementEnergy<T, 4>,
        force: &mut [[T; 3]],
    ) {
        let hinges = &self.hinges.vertices;
        self.sums
            .add_force(execution, surface, hinges, formula, force);
    }

    /// Adds the nodal forces of all hinges, and returns their energy.
    pub(crate) fn add_force_and_energy(
        &mut self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        formula: &impl ElementEnergy<T, 4>,
        force: &mut [[T; 3]],
    ) -> T {
        let hinges = &self.hinges.vertices;
        self.sums
            .add_force_and_energy(execution, surface, hinges, formula, force)
    }
}

impl<T: Real, E: ElementEnergy<T, 4>> Method<T> for OverHinges<E> {
    type Memory = HingeMemory<T>;

    fn memory(&self, mesh: &TriangleMesh) -> HingeMemory<T> {
        HingeMemory::new(mesh)
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.0.check()
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

impl<T: Real, E: ElementEnergy<T, 4>> Energy<T> for OverHinges<E> {
    fn energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
    ) -> T {
        let memory = workspace.for_mesh_mut(surface.mesh());
        memory.energy(execution, surface, &self.0)
    }
}

impl<T: Real, E: ElementEnergy<T, 4>> Force<T> for OverHinges<E> {
    fn add_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        memory.add_force(execution, surface, &self.0, force);
    }
}

impl<T: Real, E: ElementEnergy<T, 4>> Conservative<T> for OverHinges<E> {
    fn add_force_and_energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) -> T {
        let memory = workspace.for_mesh_mut(surface.mesh());
        memory.add_force_and_energy(execution, surface, &self.0, force)
    }
}
