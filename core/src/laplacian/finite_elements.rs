//! The cotangent operator as linear finite elements: its stiffness and mass matrices, and the
//! gradient and divergence of which it is the product.
//!
//! G. Dziuk, Lecture Notes in Mathematics 1357 (1988) 142.
//!
//! Fields are continuous and linear in each triangle, with one number for each vertex; `λ_i` is the
//! field that is 1 at vertex i and 0 at all others. Integrals are over the triangles. Boundaries are
//! free: nothing flows through them.

use crate::element::{Corners, ElementKernel, Execution, of_vertices};
use crate::laplacian::Cotangent;
use crate::points::{Points, PointsMut};
use crate::real::{Real, finite_or_zero};
use crate::sparse_matrix::SparseMatrix;
use crate::surface::Surface;
use crate::triangle::Triangle;
use crate::vec3::{Vec3, add, dot, scale};

/// `Δ_S φ = A⁻¹ div grad φ = −A⁻¹ S φ`, with the areas A of [`Cotangent::dual_areas`].
///
/// S, M, div and grad do not depend on the kind of areas. A triangle without area contributes 0 to
/// each of them.
impl Cotangent {
    /// The stiffness S, as [`Self::assemble_stiffness`] fills it.
    pub fn stiffness<T: Real>(&self, surface: Surface<'_, T>) -> SparseMatrix<T> {
        let mut stiffness = SparseMatrix::new();
        self.assemble_stiffness(surface, &mut stiffness);
        stiffness
    }

    /// The consistent mass M, as [`Self::assemble_mass`] fills it.
    pub fn mass<T: Real>(&self, surface: Surface<'_, T>) -> SparseMatrix<T> {
        let mut mass = SparseMatrix::new();
        self.assemble_mass(surface, &mut mass);
        mass
    }

    /// Fills `stiffness` with the integrated `S_ij = ∫ ∇λ_i·∇λ_j dS`: `−½ (cot α + cot β)` for an
    /// edge, and minus the sum of these on the diagonal. It is dimensionless.
    ///
    /// * Positive semi-definite, the negative of the integrated Laplacian: `−Δ_S φ` is `S φ` divided
    ///   by areas, and `φ·S φ = ∫ |∇φ|² dS`.
    /// * Symmetric to the last bit. The sum of a row's other entries, in the order of columns, is
    ///   exactly minus its diagonal.
    /// * Applied to positions it gives `∂A/∂x_i`, which is `2 H` times the area of the vertex along n.
    ///
    /// The pattern is the vertex and its neighbours, as for [`Self::assemble_mass`].
    pub fn assemble_stiffness<T: Real>(
        &self,
        surface: Surface<'_, T>,
        stiffness: &mut SparseMatrix<T>,
    ) {
        let half = T::constant(0.5);
        let mesh = surface.mesh();
        stiffness.reset(mesh.vertex_count(), |vertex| mesh.one_ring(vertex));
        for (triangle, corners) in mesh.triangles().iter().enumerate() {
            let [a, b, c] = corners.map(|vertex| vertex as usize);
            let cotangents = surface.triangle(triangle).cotangents();
            for (cotangent, [i, j]) in cotangents.into_iter().zip([[b, c], [c, a], [a, b]]) {
                stiffness.add(i, j, -half * cotangent);
                stiffness.add(j, i, -half * cotangent);
            }
        }
        stiffness.close_rows();
    }

    /// Fills `mass` with the integrated `M_ij = ∫ λ_i λ_j dS`, the consistent mass matrix: each
    /// triangle contributes a sixth of its area to the diagonal entry of each of its vertices, and a
    /// twelfth to both entries of each edge. Its unit is length².
    ///
    /// * Positive definite if every vertex has a triangle with area: `φ·M φ = ∫ φ² dS`.
    /// * Symmetric to the last bit. All entries together sum to the area of the surface, those of a
    ///   row to the area of the vertex with [`DualArea::Barycentric`](crate::DualArea::Barycentric).
    ///
    /// The lumped mass matrix has the areas of [`Self::dual_areas`] on its diagonal, and nothing
    /// else; [`SparseMatrix::add_to_diagonal`] adds them to a matrix.
    pub fn assemble_mass<T: Real>(&self, surface: Surface<'_, T>, mass: &mut SparseMatrix<T>) {
        let (sixth, twelfth) = (T::constant(1.0 / 6.0), T::constant(1.0 / 12.0));
        let mesh = surface.mesh();
        mass.reset(mesh.vertex_count(), |vertex| mesh.one_ring(vertex));
        for (triangle, corners) in mesh.triangles().iter().enumerate() {
            let area = surface.triangle_area(triangle);
            for i in corners.map(|vertex| vertex as usize) {
                for j in corners.map(|vertex| vertex as usize) {
                    let part = if i == j { sixth } else { twelfth };
                    mass.add(i, j, part * area);
                }
            }
        }
    }

    /// Sets `gradient` to `grad_S φ = ∇φ`, one tangential vector for each triangle, in the unit of
    /// the field divided by length. The gradient of a constant is exactly 0.
    ///
    /// # Panics
    /// If `field` has fewer entries than the surface has vertices, or `gradient` fewer than it has
    /// triangles.
    pub fn gradient<T: Real>(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        field: &[T],
        gradient: &mut (impl PointsMut<Scalar = T> + ?Sized),
    ) {
        let triangles = surface.mesh().triangles();
        let gradient = &mut gradient.coordinates_mut()[..triangles.len()];
        execution.map(gradient, |triangle, gradient| {
            let [a, b, c] = triangles[triangle].map(|vertex| field[vertex as usize]);
            let [_, of_b, of_c] = corner_gradients(&surface.triangle(triangle));
            *gradient = finite_or_zero(add(scale(b - a, of_b), scale(c - a, of_c)));
        });
    }

    /// `∇λ` of the three corners of a triangle, in its order: the gradient of a field is the sum of its
    /// numbers at the corners times these. They are 0 for a triangle without area.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn corner_gradients<T: Real>(
        &self,
        surface: Surface<'_, T>,
        triangle: usize,
    ) -> [[T; 3]; 3] {
        corner_gradients(&surface.triangle(triangle)).map(finite_or_zero)
    }

    /// Sets `divergence` to the integrated `−∫ v·∇λ_i dS`, one number for each vertex, of a field v
    /// with one vector for each triangle, in the unit of v times length. Divided by the area of the
    /// vertex it is the divergence of the tangential part of v.
    ///
    /// * That of [`Self::gradient`] is `−S φ`, with the stiffness S of [`Self::assemble_stiffness`].
    /// * Positive where v points away from the vertex. All entries together sum to zero.
    ///
    /// # Panics
    /// If `vectors` has fewer entries than the surface has triangles, or `divergence` fewer than it
    /// has vertices.
    pub fn integrated_divergence<T: Real>(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        vectors: &(impl Points<Scalar = T> + ?Sized),
        divergence: &mut [T],
    ) {
        let triangles = surface.mesh().triangles();
        let vectors = &vectors.coordinates()[..triangles.len()];
        let divergence: &mut [[T; 1]] = of_vertices(surface, divergence).as_chunks_mut().0;
        divergence.fill([T::zero()]);
        execution.scatter(&Divergence(vectors), surface, triangles, &[], divergence);
        execution.map(divergence, |_, sum| *sum = finite_or_zero(*sum));
    }
}

/// ∇λ of the three corners: normal to the opposite edge, with length 1/height.
#[inline(always)]
fn corner_gradients<T: Real>(triangle: &Triangle<T>) -> [Vec3<T>; 3] {
    triangle.outward_edges(triangle.reciprocal)
}

/// Integrated divergence of a vector for each triangle.
struct Divergence<'a, T>(&'a [[T; 3]]);

impl<T: Real> ElementKernel<T, 3, 0, 1> for Divergence<'_, T> {
    #[inline(always)]
    fn evaluate(
        &self,
        element: usize,
        corners: &Corners<T, 3>,
        _input: &[[T; 0]; 3],
    ) -> [[T; 1]; 3] {
        // The area times ∇λ.
        let weighted = corners.triangle().outward_edges(T::constant(0.5));
        weighted.map(|gradient| [-dot(self.0[element], gradient)])
    }
}
