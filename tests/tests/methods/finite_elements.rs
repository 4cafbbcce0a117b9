//! Stiffness, mass, gradient and divergence of linear finite elements: their laws on closed and open meshes,
//! in f32 and f64.

use autodiff::F1;
use helfrich::{
    Cotangent, DualArea, Real, Serial, SparseMatrix, Surface, TriangleMesh, VertexKind,
};
use helfrich_std::execute::Parallel;
use helfrich_tests::laws::{Measured, largest};
use helfrich_tests::meshes::{
    Base, Mesh, Rough, SplitMix64, bent, cases, cross, difference, disc, dot, hemisphere,
    icosphere, norm, rough_any, sheet, torus,
};
use helfrich_tests::tolerance::{self, Tolerance};
use proptest::prelude::*;
use std::collections::BTreeSet;

/// Stiffness, mass, gradient and divergence computed in two ways, relative to ε times the sum of the absolute
/// terms, each multiplied by the condition `l²/2A` of its triangle.
const FINITE_ELEMENTS: Tolerance = Tolerance::new(
    32.0,
    "edges, normal and area of a triangle round a few times each, and a vertex has a dozen triangles",
);

/// Eigenvalues l (l + 1) from Rayleigh quotients of spherical harmonics on a sphere of 2562 vertices,
/// relative.
const RAYLEIGH_QUOTIENT: Tolerance = Tolerance::new(
    2e-2,
    "second order: edges of 0.07 and waves of length 2π/l with l ≤ 3, squared",
);

const KINDS: [DualArea; 3] = [DualArea::Mixed, DualArea::Voronoi, DualArea::Barycentric];

/// Operator with mixed areas; finite elements do not use them.
const ELEMENTS: Cotangent = Cotangent {
    area: DualArea::Mixed,
};

/// Surface in the precision T, with the same positions in f64.
struct Elements<'a, T> {
    mesh: &'a TriangleMesh,
    positions: Vec<[T; 3]>,
    exact: Vec<[f64; 3]>,
}

impl<'a, T: Real + Into<f64>> Elements<'a, T> {
    fn new(mesh: &'a Mesh) -> Self {
        let positions = mesh.positions_in::<T>();
        Self {
            mesh: &mesh.connectivity,
            exact: positions.iter().map(|x| x.map(Into::into)).collect(),
            positions,
        }
    }

    fn surface(&self) -> Surface<'_, T> {
        Surface::new(self.mesh, &self.positions).expect("one finite position a vertex")
    }

    fn stiffness(&self) -> SparseMatrix<T> {
        ELEMENTS.stiffness(self.surface())
    }

    fn mass(&self) -> SparseMatrix<T> {
        ELEMENTS.mass(self.surface())
    }

    fn gradient(&self, field: &[T]) -> Vec<[T; 3]> {
        let mut gradient = vec![[T::nan(); 3]; self.mesh.triangles().len()];
        ELEMENTS.gradient(&Serial, self.surface(), field, &mut gradient);
        gradient
    }

    fn divergence(&self, vectors: &[[T; 3]]) -> Vec<T> {
        let mut divergence = vec![T::nan(); self.positions.len()];
        ELEMENTS.integrated_divergence(&Serial, self.surface(), vectors, &mut divergence);
        divergence
    }

    /// Random field with values between −1 and 1.
    fn field(&self, random: &mut SplitMix64) -> Vec<T> {
        let vertices = 0..self.positions.len();
        vertices.map(|_| T::constant(random.symmetric())).collect()
    }

    /// The corners of each triangle in f64.
    fn corners(&self) -> impl Iterator<Item = ([usize; 3], [[f64; 3]; 3])> {
        self.mesh.triangles().iter().map(|triangle| {
            let corners = triangle.map(|vertex| vertex as usize);
            (corners, corners.map(|vertex| self.exact[vertex]))
        })
    }

    /// Rounding ε l²/2A of the cotangents of each triangle, with its longest edge l.
    fn roundings(&self) -> Vec<f64> {
        let epsilon: f64 = T::epsilon().into();
        let rounding = |x: [[f64; 3]; 3]| epsilon * longest(x).powi(2) / norm(area_vector(x));
        self.corners().map(|(_, x)| rounding(x)).collect()
    }

    /// For each vertex, sum of one number per triangle over its triangles.
    fn at_vertices(&self, of_triangles: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.positions.len()];
        for ((corners, _), number) in self.corners().zip(of_triangles) {
            corners
                .into_iter()
                .for_each(|vertex| sums[vertex] += number);
        }
        sums
    }
}

/// Normal whose length is twice the area.
fn area_vector([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    cross(difference(b, a), difference(c, a))
}

fn longest([a, b, c]: [[f64; 3]; 3]) -> f64 {
    let lengths = [(a, b), (b, c), (c, a)].map(|(p, q)| norm(difference(p, q)));
    lengths.into_iter().fold(0.0, f64::max)
}

fn in_double<T: Into<f64> + Copy>(field: &[T]) -> Vec<f64> {
    field.iter().map(|&x| x.into()).collect()
}

/// x·A y.
fn product<T: Real + Into<f64>>(x: &[f64], matrix: &SparseMatrix<T>, y: &[f64]) -> f64 {
    let terms = matrix.triplets().map(|(i, j, a)| x[i] * a.into() * y[j]);
    terms.sum()
}

/// Checks that the compressed rows contain each vertex and its neighbours, in order, and that the matrix is
/// symmetric.
fn assert_form<T: Real>(matrix: &SparseMatrix<T>, mesh: &TriangleMesh) {
    let vertices = mesh.vertex_count();
    let mut pattern = BTreeSet::from_iter((0..vertices).map(|vertex| (vertex, vertex)));
    for triangle in mesh.triangles() {
        let corners = triangle.map(|vertex| vertex as usize);
        pattern.extend(corners.into_iter().flat_map(|i| corners.map(|j| (i, j))));
    }
    let found = Vec::from_iter(matrix.triplets().map(|(row, column, _)| (row, column)));
    assert_eq!(found, Vec::from_iter(pattern), "pattern");
    let mut transposed = Vec::from_iter(matrix.triplets().map(|(i, j, a)| (j, i, a)));
    transposed.sort_by_key(|&(row, column, _)| (row, column));
    assert_eq!(transposed, Vec::from_iter(matrix.triplets()), "symmetry");

    let (offsets, columns, values) = matrix.clone().into_parts();
    assert_eq!(offsets.len(), vertices + 1);
    assert_eq!((offsets[0], offsets[vertices]), (0, values.len()));
    assert_eq!(columns, Vec::from_iter(found.iter().map(|entry| entry.1)));
    for row in 0..vertices {
        let range = offsets[row]..offsets[row + 1];
        assert_eq!(
            matrix.row(row),
            (&columns[range.clone()], &values[range.clone()])
        );
        assert!(found[range].iter().all(|entry| entry.0 == row));
    }
}

/// Laws of the stiffness matrix: its form, rows that sum to zero, `φ·S φ = ∫ |∇φ|²`, `S = −div grad`.
fn stiffness_laws<T: Real + Into<f64>>(mesh: &Mesh, seed: u64) {
    let elements = Elements::<T>::new(mesh);
    let stiffness = elements.stiffness();
    assert_form(&stiffness, elements.mesh);
    for row in 0..stiffness.size() {
        let entries = stiffness
            .triplets()
            .filter(|&(i, j, _)| i == row && j != row);
        let others: T = entries.map(|(_, _, value)| value).sum();
        assert_eq!(others, -stiffness.diagonal(row), "sum of row {row}");
    }

    let field = elements.field(&mut SplitMix64::new(seed));
    let gradient = elements.gradient(&field);
    let roundings = elements.roundings();
    let scale: f64 = roundings.iter().sum();
    let squares = elements.corners().zip(&gradient).map(|((_, x), gradient)| {
        let gradient = gradient.map(Into::into);
        0.5 * norm(area_vector(x)) * dot(gradient, gradient)
    });
    let double = in_double(&field);
    let energy = product(&double, &stiffness, &double);
    FINITE_ELEMENTS.assert(energy, squares.sum(), scale, "∫ |∇φ|²");

    let mut product = vec![T::nan(); field.len()];
    stiffness.apply_to_scalar(&Serial, &field, &mut product);
    let divergence = elements.divergence(&gradient);
    let scales = elements.at_vertices(&roundings);
    for vertex in 0..field.len() {
        let (found, expected) = (divergence[vertex].into(), -product[vertex].into());
        FINITE_ELEMENTS.assert(found, expected, scales[vertex], "div grad");
    }
    let constant = vec![T::constant(0.1); field.len()];
    assert!(
        elements
            .gradient(&constant)
            .iter()
            .flatten()
            .all(|g| *g == T::zero())
    );
}

/// Laws of the mass matrix: its form, rows that sum to areas, `φ·M ψ = ∫ φ ψ`.
fn mass_laws<T: Real + Into<f64>>(mesh: &Mesh, seed: u64) {
    let elements = Elements::<T>::new(mesh);
    let mass = elements.mass();
    assert_form(&mass, elements.mesh);
    let epsilon: f64 = T::epsilon().into();
    let mut areas = vec![T::nan(); elements.positions.len()];
    Cotangent::new(DualArea::Barycentric).dual_areas(&Serial, elements.surface(), &mut areas);
    for (row, area) in in_double(&areas).into_iter().enumerate() {
        let sum = mass.row(row).1.iter().map(|&m| m.into()).sum();
        FINITE_ELEMENTS.assert(sum, area, epsilon * area, "sum of a row");
    }
    let total = mass.values().iter().map(|&m| m.into()).sum();
    let area = elements.surface().area().into();
    FINITE_ELEMENTS.assert(total, area, epsilon * area, "sum of all");

    // The rule of edge midpoints integrates quadratic functions exactly.
    let mut random = SplitMix64::new(seed);
    let [f, g] = [(); 2].map(|()| in_double(&elements.field(&mut random)));
    let (mut integral, mut scale) = (0.0, 0.0);
    for (corners, x) in elements.corners() {
        let sixth = norm(area_vector(x)) / 6.0;
        for k in 0..3 {
            let (i, j) = (corners[k], corners[(k + 1) % 3]);
            integral += sixth * 0.25 * (f[i] + f[j]) * (g[i] + g[j]);
        }
        // The area itself is rounded.
        scale += epsilon * longest(x).powi(2);
    }
    FINITE_ELEMENTS.assert(product(&f, &mass, &g), integral, scale, "∫ φ ψ");
}

/// Checks that the gradient of a·x is the tangential part of a.
fn gradient_laws<T: Real + Into<f64>>(mesh: &Mesh, seed: u64) {
    let elements = Elements::<T>::new(mesh);
    let along = SplitMix64::new(seed).directions(1)[0].map(T::constant);
    let value = |x: &[T; 3]| x[0] * along[0] + x[1] * along[1] + x[2] * along[2];
    let field = Vec::from_iter(elements.positions.iter().map(value));
    let along = along.map(Into::into);
    let gradient = elements.gradient(&field);
    let roundings = elements.roundings();
    for (((_, x), gradient), rounding) in elements.corners().zip(gradient).zip(roundings) {
        let vector = area_vector(x);
        let part = dot(along, vector) / dot(vector, vector);
        let expected = [0, 1, 2].map(|k| along[k] - part * vector[k]);
        let error = norm(difference(gradient.map(Into::into), expected));
        // The values of the field are rounded, and the gradient divides their differences by a height.
        let distance = x.into_iter().map(norm).fold(0.0, f64::max);
        let scale = rounding * (1.0 + distance / longest(x));
        FINITE_ELEMENTS.assert(error, 0.0, scale, "∇(a·x)");
    }
}

/// Checks that the divergence of any vectors is minus the adjoint of the gradient and sums to zero.
fn divergence_laws<T: Real + Into<f64>>(mesh: &Mesh, seed: u64) {
    let elements = Elements::<T>::new(mesh);
    let mut random = SplitMix64::new(seed);
    let field = elements.field(&mut random);
    let vectors = random.directions(elements.mesh.triangles().len());
    let vectors = Vec::from_iter(vectors.into_iter().map(|v| v.map(T::constant)));
    let divergence = in_double(&elements.divergence(&vectors));
    let gradient = elements.gradient(&field);
    let (mut adjoint, mut scale) = (0.0, 0.0);
    let triangles = elements.corners().zip(&vectors).zip(&gradient);
    for ((((_, x), vector), gradient), rounding) in triangles.zip(elements.roundings()) {
        let (vector, gradient) = (vector.map(Into::into), gradient.map(Into::into));
        adjoint -= 0.5 * norm(area_vector(x)) * dot(vector, gradient);
        scale += rounding * longest(x);
    }
    let found = divergence.iter().zip(in_double(&field)).map(|(d, f)| d * f);
    FINITE_ELEMENTS.assert(found.sum(), adjoint, scale, "∫ φ div v = −∫ v·∇φ");
    FINITE_ELEMENTS.assert(divergence.iter().sum(), 0.0, scale, "∫ div v");
}

/// Checks that `−Δ_S φ` is S φ divided by areas, and `2 H n` for φ = x.
fn operator_laws(mesh: &Mesh, seed: u64) {
    let elements = Elements::<f64>::new(mesh);
    let field = SplitMix64::new(seed).directions(mesh.positions.len());
    let stiffness = elements.stiffness();
    let apply = |field: &[[f64; 3]]| {
        let mut result = vec![[f64::NAN; 3]; field.len()];
        stiffness.apply(&Serial, field, &mut result);
        result
    };
    let (product, of_positions) = (apply(&field), apply(&mesh.positions));
    let scales = elements.at_vertices(&elements.roundings());
    let extent = mesh.positions.iter().map(|&x| norm(x)).fold(0.0, f64::max);
    for kind in KINDS {
        let measured = Measured::new(Cotangent::new(kind), mesh);
        let laplacian = measured.apply(&field);
        for (vertex, curvature) in measured.curvature.iter().enumerate() {
            let (area, scale) = (curvature.area, scales[vertex]);
            let integrated = laplacian[vertex].map(|value| -value * area);
            let error = norm(difference(product[vertex], integrated));
            FINITE_ELEMENTS.assert(error, 0.0, scale, "−A Δ_S φ");
            if curvature.kind == VertexKind::Interior {
                let found = dot(of_positions[vertex], curvature.normal);
                let expected = 2.0 * curvature.mean * area;
                FINITE_ELEMENTS.assert(found, expected, scale * extent, "2 H A");
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(48))]

    #[test]
    fn stiffness_on_any_mesh(rough in rough_any()) {
        stiffness_laws::<f64>(&rough.mesh(), rough.seed);
        stiffness_laws::<f32>(&rough.mesh(), rough.seed);
    }

    #[test]
    fn mass_on_any_mesh(rough in rough_any()) {
        mass_laws::<f64>(&rough.mesh(), rough.seed);
        mass_laws::<f32>(&rough.mesh(), rough.seed);
    }

    #[test]
    fn gradient_on_any_mesh(rough in rough_any()) {
        gradient_laws::<f64>(&rough.mesh(), rough.seed);
        gradient_laws::<f32>(&rough.mesh(), rough.seed);
    }

    #[test]
    fn divergence_on_any_mesh(rough in rough_any()) {
        divergence_laws::<f64>(&rough.mesh(), rough.seed);
        divergence_laws::<f32>(&rough.mesh(), rough.seed);
    }

    #[test]
    fn stiffness_over_area_is_the_operator(rough in rough_any()) {
        operator_laws(&rough.mesh(), rough.seed);
    }

    /// The stiffness of the positions is ∂A/∂x.
    #[test]
    fn stiffness_of_positions_is_the_gradient_of_the_area(rough in rough_any()) {
        let mesh = rough.mesh();
        let vertices = mesh.positions.len();
        let mut product = vec![[f64::NAN; 3]; vertices];
        Elements::new(&mesh).stiffness().apply(&Serial, &mesh.positions, &mut product);
        let mut random = SplitMix64::new(rough.seed);
        let largest = largest(&product);
        for _ in 0..10 {
            let (vertex, axis) = (random.below(vertices), random.below(3));
            let mut positions = Vec::from_iter(mesh.positions.iter().map(|x| x.map(F1::cst)));
            positions[vertex][axis] = F1::var(mesh.positions[vertex][axis]);
            let surface = Surface::new(&mesh.connectivity, &positions).expect("finite positions");
            let expected = surface.area().dx;
            tolerance::GRADIENT_DUAL.assert(product[vertex][axis], expected, largest, "∂A/∂x");
        }
    }
}

#[test]
fn positive_semidefinite_also_where_cotangent_sums_are_negative() {
    let uneven = icosphere(3).map(|[x, y, z]| [x, 0.2 * y, 3.0 * z + 0.5 * (9.0 * x).sin()]);
    let mut negative = 0;
    for mesh in [icosphere(3), torus(24, 16), disc(6), hemisphere(3), uneven] {
        let elements = Elements::<f64>::new(&mesh);
        let stiffness = elements.stiffness();
        let edges = stiffness.triplets().filter(|&(i, j, _)| i != j);
        negative += edges.filter(|&(_, _, value)| value > 0.0).count();
        let mut random = SplitMix64::new(5);
        for _ in 0..20 {
            let field = elements.field(&mut random);
            let energy = product(&field, &stiffness, &field);
            assert!(energy > 0.0, "φ·S φ = {energy}");
        }
    }
    assert!(negative > 0, "every cotangent sum is positive");
}

/// On a flat sheet, the divergence of v = x is 2, times a third of the area of the triangles around a vertex.
#[test]
fn divergence_of_positions_in_the_plane() {
    let jittered = Rough {
        base: Base::Disc,
        seed: 3,
        amplitude: 0.15,
        refinement: 1,
    };
    let flat = jittered.mesh().map(|[x, y, _]| [x, y, 0.0]);
    let elements = Elements::<f64>::new(&flat);
    let centre = |x: [[f64; 3]; 3]| [0, 1, 2].map(|k| (x[0][k] + x[1][k] + x[2][k]) / 3.0);
    let vectors = Vec::from_iter(elements.corners().map(|(_, x)| centre(x)));
    let mut areas = vec![f64::NAN; flat.positions.len()];
    Cotangent::new(DualArea::Barycentric).dual_areas(&Serial, flat.surface(), &mut areas);
    let mut compared = 0;
    for (vertex, found) in elements.divergence(&vectors).into_iter().enumerate() {
        if flat.connectivity.vertex_kind(vertex) == VertexKind::Interior {
            // A dozen terms, each a vector of length 1 at most times half an edge.
            let scale = f64::EPSILON * flat.edge_length();
            FINITE_ELEMENTS.assert(found, 2.0 * areas[vertex], scale, "∫ div x");
            compared += 1;
        }
    }
    assert!(compared > 10, "{compared} vertices inside");
}

/// A function on the sphere.
type Harmonic = fn([f64; 3]) -> f64;

/// Rayleigh quotients of spherical harmonics converge to l (l + 1) in second order in the edge length, with
/// each kind of mass matrix.
#[test]
fn eigenvalues_of_the_sphere() {
    let harmonics: [(f64, Harmonic); 3] = [
        (2.0, |[x, y, _]| x + 0.3 * y),
        (6.0, |[x, y, z]| 3.0 * z * z - 1.0 + x * y),
        (12.0, |[x, y, z]| z * (5.0 * z * z - 3.0) + x * y * z),
    ];
    let errors = |refinement| {
        let mesh = icosphere(refinement);
        let elements = Elements::<f64>::new(&mesh);
        let mut masses = vec![elements.mass()];
        for kind in KINDS {
            let mut areas = vec![f64::NAN; mesh.positions.len()];
            Cotangent::new(kind).dual_areas(&Serial, mesh.surface(), &mut areas);
            let mut lumped = elements.mass();
            lumped.values_mut().fill(0.0);
            lumped.add_to_diagonal(&areas);
            masses.push(lumped);
        }
        let stiffness = elements.stiffness();
        let mut errors = Vec::new();
        for (eigenvalue, harmonic) in harmonics {
            let field = Vec::from_iter(mesh.positions.iter().map(|&x| harmonic(x)));
            let energy = product(&field, &stiffness, &field);
            let quotients = masses
                .iter()
                .map(|mass| energy / product(&field, mass, &field));
            errors.extend(quotients.map(|quotient| quotient / eigenvalue - 1.0));
        }
        errors
    };
    let (coarse, fine) = (errors(3), errors(4));
    for (case, (coarse, fine)) in coarse.into_iter().zip(fine).enumerate() {
        RAYLEIGH_QUOTIENT.assert(fine, 0.0, 1.0, &format!("eigenvalue {case}"));
        // With areas on the diagonal, l = 1 is exact: x·S x is twice the area, as for any surface, and Σ A_i
        // |x_i|² is the area, as for any partition of this sphere; by symmetry, all axes are alike.
        if [1, 2, 3].contains(&case) {
            tolerance::SAME.assert(fine, 0.0, 1.0, "l = 1");
            continue;
        }
        let order = (coarse / fine).log2();
        assert!(
            (1.9..2.1).contains(&order),
            "order {order} of {case}: {coarse} to {fine}"
        );
    }
}

/// A triangle without area contributes nothing, and an isolated vertex has an empty row.
#[test]
fn triangles_without_area_and_isolated_vertices() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let (on_edge, isolated) = ([0.5, 0.5, 0.0], [9.0; 3]);
    let positions = [&corners[..], &[on_edge, isolated]].concat();
    let mesh = Mesh::new(positions, vec![[0, 1, 2], [2, 1, 3]]);
    let elements = Elements::<f64>::new(&mesh);
    let (stiffness, mass) = (elements.stiffness(), elements.mass());
    assert_form(&stiffness, elements.mesh);
    let row = |matrix: &SparseMatrix<f64>, row| {
        let mut dense = [0.0; 5];
        let (columns, values) = matrix.row(row);
        columns.iter().zip(values).for_each(|(&j, &a)| dense[j] = a);
        dense
    };
    assert_eq!(row(&stiffness, 0), [1.0, -0.5, -0.5, 0.0, 0.0]);
    assert_eq!(row(&stiffness, 1), [-0.5, 0.5, 0.0, 0.0, 0.0]);
    assert_eq!(row(&stiffness, 3), [0.0; 5]);
    assert_eq!(row(&mass, 1), [1.0, 2.0, 1.0, 0.0, 0.0].map(|m| m / 24.0));
    assert_eq!(row(&mass, 3), [0.0; 5]);
    assert_eq!(stiffness.row(4), (&[4][..], &[0.0][..]));
    assert_eq!(
        elements.gradient(&[3.0, 4.0, 5.0, 100.0, 7.0]),
        [[1.0, 2.0, 0.0], [0.0; 3]]
    );
    let divergence = elements.divergence(&[[1.0, 0.0, 4.0], [7.0; 3]]);
    assert_eq!(divergence, [0.5, -0.5, 0.0, 0.0, 0.0]);
}

/// Several threads and wide vectors give the same bits as the serial loop.
#[test]
fn executions_agree() {
    for mesh in [icosphere(4).map(bent), sheet(40).map(bent)] {
        let elements = Elements::<f64>::new(&mesh);
        let field = elements.field(&mut SplitMix64::new(2));
        let gradient = elements.gradient(&field);
        let (mut parallel, execution) = (vec![[f64::NAN; 3]; gradient.len()], Parallel::new());
        ELEMENTS.gradient(&execution, elements.surface(), &field, &mut parallel);
        assert_eq!(parallel, gradient);
        let mut divergence = vec![f64::NAN; field.len()];
        ELEMENTS.integrated_divergence(&execution, mesh.surface(), &gradient, &mut divergence);
        assert_eq!(divergence, elements.divergence(&gradient));
        let stiffness = elements.stiffness();
        let [mut serial, mut result] = [(); 2].map(|()| vec![f64::NAN; field.len()]);
        stiffness.apply_to_scalar(&Serial, &field, &mut serial);
        stiffness.apply_to_scalar(&execution, &field, &mut result);
        assert_eq!(result, serial);
    }
}
