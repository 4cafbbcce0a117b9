//! Domains of a membrane: parts with another Gaussian modulus, and the line tension of their borders.
//!
//! F. Jülicher, R. Lipowsky, Phys. Rev. E 53 (1996) 2670. The discretisation and its gradient are our own.

use crate::bending::MaterialParameter;
use crate::element::{Corners, ElementKernel, Execution};
use crate::functional::LengthGradient;
use crate::lane::Lane;
use crate::mesh::TriangleMesh;
use crate::mesh_identity::MeshIdentity;
use crate::method::{Method, ParameterError, TwoPass};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, cross, dot, norm, scale, sub};
use alloc::vec::Vec;

/// `E = Σ_i κ_G,i (2π − Σ angles)` over interior vertices: `∫ κ_G K dS` with a Gaussian modulus κ_G for
/// each vertex, and its exact gradient.
///
/// The angles of a triangle sum to π. The energy therefore depends on angles only where the vertices of a
/// triangle differ in κ_G, or where some are at a boundary, and has no gradient elsewhere: none at all on a
/// closed surface with the same κ_G everywhere, where it is the constant 2πχ κ_G. A border between two
/// domains thus lies in the triangles between them. By Gauss and Bonnet the energy changes there by the
/// jump of κ_G times the geodesic curvature of the border.
///
/// With a constant κ_G this is [`GaussianBending`](crate::GaussianBending), which is faster.
#[derive(Clone, Debug, PartialEq)]
pub struct GaussianDomains<T> {
    /// Gaussian modulus κ_G, an energy, which belongs to the material at a vertex and moves with it.
    pub modulus: MaterialParameter<T>,
}

/// Memory of [`GaussianDomains`].
#[derive(Clone, Debug, Default)]
pub struct GaussianDomainsMemory<T> {
    /// κ_G at interior vertices, 0 elsewhere.
    moduli: Vec<[T; 1]>,
}

/// `−∂E/∂x` of a triangle.
struct Turn;

impl<T: Real> ElementKernel<T, 3, 1, 3> for Turn {
    /// An edge that turns by an angle changes the angles at its two ends by as much, one up and one down.
    #[inline(always)]
    fn evaluate(
        &self,
        _element: usize,
        corners: &Corners<T, 3>,
        moduli: &[[T; 1]; 3],
    ) -> [[T; 3]; 3] {
        let triangle = corners.triangle();
        let normal = triangle.normal();
        let turn = |from: usize, to: usize, edge: Vec3<T>| {
            let jump = moduli[from][0] - moduli[to][0];
            let weight = jump * dot(edge, edge).reciprocal_or_zero();
            scale(weight, cross(normal, edge))
        };
        let [first, second, third] = triangle.edges;
        let (first, second, third) = (turn(1, 2, first), turn(2, 0, second), turn(0, 1, third));
        [sub(third, second), sub(first, third), sub(second, first)]
    }
}

impl<T: Real> Method<T> for GaussianDomains<T> {
    type Memory = GaussianDomainsMemory<T>;
    const NEEDS_AREAS: bool = true;

    fn memory(&self, _mesh: &TriangleMesh) -> GaussianDomainsMemory<T> {
        GaussianDomainsMemory::default()
    }

    fn check(&self) -> Result<(), ParameterError> {
        let values = self.modulus.values().iter().copied();
        ParameterError::unless_all_finite("Gaussian modulus", values)
    }
}

impl<T: Real> TwoPass for GaussianDomains<T> {
    type Scalar = T;

    /// The moduli of interior vertices.
    fn measure(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut GaussianDomainsMemory<T>,
    ) {
        let mesh = surface.mesh();
        self.modulus.expect_each(self, "Gaussian moduli", mesh);
        memory.moduli.resize(mesh.vertex_count(), [T::zero()]);
        execution.map(&mut memory.moduli[..], |vertex, modulus| {
            *modulus = match mesh.is_interior(vertex) {
                true => [self.modulus.at(vertex)],
                false => [T::zero()],
            };
        });
    }

    /// `Σ_i 2π κ_i − Σ_triangles Σ κ φ`, with `Σ κ φ = π κ_0 + (κ_1 − κ_0) φ_1 + (κ_2 − κ_0) φ_2`.
    fn measured_energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut GaussianDomainsMemory<T>,
    ) -> T {
        let moduli = &memory.moduli;
        let triangles = surface.mesh().triangles();
        let of = |vertex: u32| moduli[vertex as usize][0];
        let two = T::constant(2.0);
        let vertices = execution.sum(moduli.len(), |vertex| two * moduli[vertex][0]);
        let corners = execution.sum(triangles.len(), |index| of(triangles[index][0]));
        let turned = execution.sum(triangles.len(), |index| {
            let [a, b, c] = triangles[index];
            let jumps = [of(b) - of(a), of(c) - of(a)];
            if jumps == [T::zero(); 2] {
                return T::zero();
            }
            let angle = |corner: [u32; 3]| {
                let triangle = Corners::<T, 3>::of(surface, corner).triangle();
                triangle.doubled_area.atan2(triangle.dots[0])
            };
            jumps[0] * angle([b, c, a]) + jumps[1] * angle([c, a, b])
        });
        T::constant(core::f64::consts::PI) * (vertices - corners) - turned
    }

    fn add_measured_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut GaussianDomainsMemory<T>,
        force: &mut [[T; 3]],
    ) {
        let triangles = surface.mesh().triangles();
        execution.scatter(&Turn, surface, triangles, &memory.moduli, force);
    }
}

/// `E = Λ L`, L the length of the borders between domains, and its exact gradient. A domain is the
/// vertices or the triangles with the same label.
///
/// Borders between triangles run along their common edges. Those between vertices run through the midpoints of edges whose ends have different labels: in a triangle with two
/// labels along half the length of the edge between the two vertices that are alike, in one with three
/// labels from the midpoints to the centroid.
///
/// L is the length of these polylines, which is that of a smooth border where rows of the mesh follow it.
/// Elsewhere they zigzag, and are longer by a share that does not vanish on finer meshes.
#[derive(Clone, Debug, PartialEq)]
pub struct BorderTension<T> {
    /// Line tension Λ, energy per length; positive if borders contract.
    pub tension: T,
    /// The edges beside borders, once for each triangle with a border along half of their length.
    sides: Vec<[u32; 2]>,
    /// The corners of triangles in which three domains meet, begun at each.
    medians: Vec<[u32; 3]>,
    mesh: MeshIdentity,
}

impl<T: Real> BorderTension<T> {
    /// The energy with line tension Λ of the borders between vertices of a mesh with different labels.
    ///
    /// # Panics
    /// If there are not as many labels as vertices.
    pub fn new(tension: T, mesh: &TriangleMesh, labels: &[i64]) -> Self {
        assert!(
            labels.len() == mesh.vertex_count(),
            "there are {} labels for a mesh of {} vertices: give one for each vertex",
            labels.len(),
            mesh.vertex_count()
        );
        let (mut sides, mut medians) = (Vec::new(), Vec::new());
        for &[a, b, c] in mesh.triangles() {
            let [first, second, third] = [a, b, c].map(|vertex| labels[vertex as usize]);
            match [second == third, third == first, first == second] {
                [true, true, true] => {}
                [true, ..] => sides.push([b, c]),
                [_, true, _] => sides.push([c, a]),
                [.., true] => sides.push([a, b]),
                _ => medians.extend([[a, b, c], [b, c, a], [c, a, b]]),
            }
        }
        Self {
            tension,
            sides,
            medians,
            mesh: MeshIdentity::of(mesh),
        }
    }

    /// The energy with line tension Λ of the edges between triangles of a mesh with different labels.
    ///
    /// # Panics
    /// If there are not as many labels as triangles.
    pub fn of_triangles(tension: T, mesh: &TriangleMesh, labels: &[i64]) -> Self {
        assert!(
            labels.len() == mesh.triangles().len(),
            "there are {} labels for a mesh of {} triangles: give one for each triangle",
            labels.len(),
            mesh.triangles().len()
        );
        let is_border = |edge: usize| match mesh.edge_triangles(edge) {
            (left, Some(right)) => labels[left as usize] != labels[right as usize],
            (_, None) => false,
        };
        let edges = mesh.edges().iter().enumerate();
        let borders = edges.filter(|&(edge, _)| is_border(edge));
        Self {
            tension,
            sides: borders.flat_map(|(_, &ends)| [ends; 2]).collect(),
            medians: Vec::new(),
            mesh: MeshIdentity::of(mesh),
        }
    }

    /// Length L of all borders.
    ///
    /// # Panics
    /// If the surface has another mesh than that of the labels.
    pub fn length(&self, execution: &impl Execution, surface: Surface<'_, T>) -> T {
        self.expect(surface.mesh());
        let sides = execution.sum(self.sides.len(), |index| {
            let [a, b] = self.sides[index];
            norm(surface.difference(a, b))
        });
        let medians = execution.sum(self.medians.len(), |index| {
            norm(median(&Corners::<T, 3>::of(surface, self.medians[index])))
        });
        T::constant(0.5) * sides + T::constant(1.0 / 3.0) * medians
    }

    fn expect(&self, mesh: &TriangleMesh) {
        self.mesh
            .expect::<Self>(mesh, "make a BorderTension for that mesh");
    }
}

/// From the middle of the opposite edge to the first corner.
#[inline(always)]
fn median<T: Real>(corners: &Corners<T, 3>) -> Vec3<T> {
    let sum = add(corners.difference(1, 0), corners.difference(2, 0));
    scale(T::constant(0.5), sum)
}

/// `w ∂/∂x` of the length of a median.
struct MedianGradient<T>(T);

impl<T: Real> ElementKernel<T, 3, 0, 3> for MedianGradient<T> {
    #[inline(always)]
    fn evaluate(
        &self,
        _element: usize,
        corners: &Corners<T, 3>,
        _input: &[[T; 0]; 3],
    ) -> [[T; 3]; 3] {
        let median = median(corners);
        let pull = scale(self.0 * norm(median).reciprocal_or_zero(), median);
        let half = scale(T::constant(-0.5), pull);
        [pull, half, half]
    }
}

impl<T: Real> Method<T> for BorderTension<T> {
    type Memory = ();

    /// # Panics
    /// If the labels are those of another mesh.
    fn memory(&self, mesh: &TriangleMesh) {
        self.expect(mesh);
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_finite("line tension", self.tension)
    }
}

impl<T: Real> TwoPass for BorderTension<T> {
    type Scalar = T;

    fn measure(&self, _: &impl Execution, _: Surface<'_, T>, (): &mut ()) {}

    fn measured_energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        (): &mut (),
    ) -> T {
        self.tension * self.length(execution, surface)
    }

    fn add_measured_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        (): &mut (),
        force: &mut [[T; 3]],
    ) {
        let sides = LengthGradient(-T::constant(0.5) * self.tension);
        execution.scatter(&sides, surface, &self.sides, &[], force);
        let medians = MedianGradient(-T::constant(1.0 / 3.0) * self.tension);
        execution.scatter(&medians, surface, &self.medians, &[], force);
    }
}
