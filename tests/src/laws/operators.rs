//! Laplace–Beltrami operators: results for constants, rows, and surfaces that are translated, rotated
//! or scaled.

use super::{CurvatureLaw, FEWEST_VERTICES, Finite, OperatorLaw};
use crate::meshes::{GENERIC, Mesh, SplitMix64, cross, difference, norm, rotation, small, turned};
use crate::tolerance::{self, Tolerance};
use helfrich::{
    Curvature, Curvatures, Finding, LaplaceBeltrami, Method, Rows, Serial, SparseMatrix, Workspace,
};
use helfrich_std::generate::{Family, generate};

/// Results of an operator on a moved surface against those on the original surface, relative to the
/// curvatures.
const OPERATOR_MOTION: Tolerance = Tolerance::new(
    1e-9,
    "the moved positions are rounded at 1e-16, and second derivatives divide that by h² = 1e-2, times \
     the condition number of a fit",
);

/// Operator with its workspace and its curvatures of one surface.
#[derive(Debug)]
pub struct Measured<'a, L: Method<f64>> {
    mesh: &'a Mesh,
    operator: L,
    workspace: Workspace<f64, L>,
    /// n, H, K and A at each vertex.
    pub curvature: Vec<Curvature<f64>>,
}

impl<'a, L: Curvatures<f64>> Measured<'a, L> {
    /// Evaluates the operator on the surface.
    pub fn new(operator: L, mesh: &'a Mesh) -> Self {
        let mut workspace = operator.workspace(&mesh.connectivity);
        let mut curvature = vec![Curvature::default(); mesh.positions.len()];
        operator.curvatures(&Serial, mesh.surface(), &mut workspace, &mut curvature);
        Self {
            mesh,
            operator,
            workspace,
            curvature,
        }
    }

    /// Findings of the operator.
    pub fn findings(&self) -> Vec<Finding> {
        let mut findings = Vec::new();
        let surface = self.mesh.surface();
        let mut report = |finding| findings.push(finding);
        self.operator.inspect(surface, &self.workspace, &mut report);
        findings
    }
}

impl<L: LaplaceBeltrami<f64>> Measured<'_, L> {
    /// Δ_S of a field.
    pub fn apply<const D: usize>(&self, field: &[[f64; D]]) -> Vec<[f64; D]> {
        // NaN would stay in the results of an operator that adds to them instead of setting them.
        let mut laplacian = vec![[f64::NAN; D]; field.len()];
        let surface = self.mesh.surface();
        self.operator
            .apply(&Serial, surface, &self.workspace, field, &mut laplacian);
        laplacian
    }

    /// Δ_S of a scalar field.
    pub fn apply_to_scalar(&self, field: &[f64]) -> Vec<f64> {
        let mut laplacian = vec![f64::NAN; field.len()];
        let surface = self.mesh.surface();
        self.operator
            .apply_to_scalar(&Serial, surface, &self.workspace, field, &mut laplacian);
        laplacian
    }

    /// Assembles the operator's rows.
    pub fn assemble(&self, rows: &mut Rows<f64>) {
        self.operator
            .assemble(self.mesh.surface(), &self.workspace, rows);
    }
}

/// Δ_S of a constant is zero, to the last bit, in every form.
#[derive(Clone, Copy, Debug)]
pub struct ConstantsVanish<'a>(pub &'a Mesh);

impl OperatorLaw for ConstantsVanish<'_> {
    fn check<L: LaplaceBeltrami<f64> + Copy>(&mut self, name: &str, operator: L) {
        let measured = Measured::new(operator, self.0);
        let vertices = self.0.positions.len();
        let zero = vec![0.0; vertices];
        let constant = vec![0.1; vertices];
        assert_eq!(measured.apply_to_scalar(&constant), zero, "{name}");
        let mut rows = Rows::new();
        measured.assemble(&mut rows);
        let mut result = vec![f64::NAN; vertices];
        rows.apply_to_scalar(&Serial, &constant, &mut result);
        assert_eq!(result, zero, "{name}: rows");
        let fields = measured.apply(&vec![[0.1, -7.0e30]; vertices]);
        assert_eq!(fields, vec![[0.0; 2]; vertices], "{name}: two fields");
    }
}

/// Rows give the same results as the operator. Assembled again for a moved surface, they reuse their memory.
#[derive(Clone, Copy, Debug)]
pub struct RowsAgree<'a>(pub &'a Mesh);

impl OperatorLaw for RowsAgree<'_> {
    fn check<L: LaplaceBeltrami<f64> + Copy>(&mut self, name: &str, operator: L) {
        let mut measured = Measured::new(operator, self.0);
        let vertices = self.0.positions.len();
        let field = SplitMix64::new(3).directions(vertices);
        let mut rows = Rows::new();
        measured.assemble(&mut rows);
        assert_eq!(rows.len(), vertices, "{name}: one row a vertex");
        let agree = |rows: &Rows<f64>, expected: &[[f64; 3]], scalar: &[f64]| {
            let mut result = vec![[f64::NAN; 3]; vertices];
            rows.apply(&Serial, &field, &mut result);
            for vertex in 0..vertices {
                let scale = 2.0 * rows.row(vertex).1.iter().map(|c| c.abs()).sum::<f64>();
                let error = norm(difference(result[vertex], expected[vertex]));
                let scale = scale.max(f64::MIN_POSITIVE);
                tolerance::OPERATOR_ROUNDING.assert(error, 0.0, scale, name);
                assert_eq!(
                    scalar[vertex], expected[vertex][0],
                    "{name}: one field and three"
                );
            }
        };
        let first = Vec::from_iter(field.iter().map(|f| f[0]));
        agree(
            &rows,
            &measured.apply(&field),
            &measured.apply_to_scalar(&first),
        );

        let places = |rows: &Rows<f64>| {
            let (columns, coefficients) = rows.row(0);
            (columns.as_ptr(), coefficients.as_ptr())
        };
        let before = places(&rows);
        let moved = self.0.map(|[x, y, z]| [1.5 * x + 0.1 * y, y, z - 0.2 * x]);
        measured.mesh = &moved;
        let Measured {
            operator,
            workspace,
            curvature,
            ..
        } = &mut measured;
        operator.curvatures(&Serial, moved.surface(), workspace, curvature);
        measured.assemble(&mut rows);
        assert_eq!(
            places(&rows),
            before,
            "{name}: refilled rows moved in memory"
        );
        agree(
            &rows,
            &measured.apply(&field),
            &measured.apply_to_scalar(&first),
        );
        let mut fresh = Rows::new();
        measured.assemble(&mut fresh);
        for vertex in 0..vertices {
            assert_eq!(
                rows.row(vertex),
                fresh.row(vertex),
                "{name}: refilled rows and new ones"
            );
        }
    }
}

/// The rows with their diagonal form a valid sparse matrix with the same results as the operator. Filling it
/// again gives the same matrix.
#[derive(Clone, Copy, Debug)]
pub struct MatrixAgrees<'a>(pub &'a Mesh);

impl OperatorLaw for MatrixAgrees<'_> {
    fn check<L: LaplaceBeltrami<f64> + Copy>(&mut self, name: &str, operator: L) {
        let measured = Measured::new(operator, self.0);
        let vertices = self.0.positions.len();
        let mut rows = Rows::new();
        measured.assemble(&mut rows);
        let mut matrix = SparseMatrix::new();
        rows.fill_matrix(&mut matrix);
        assert_eq!(matrix.size(), vertices, "{name}: one row a vertex");

        let field = SplitMix64::new(3).directions(vertices);
        let expected = measured.apply(&field);
        let mut result = vec![[f64::NAN; 3]; vertices];
        matrix.apply(&Serial, &field, &mut result);
        for vertex in 0..vertices {
            let (columns, values) = matrix.row(vertex);
            assert!(columns.is_sorted_by(|a, b| a < b), "{name}: {columns:?}");
            assert!(columns.contains(&vertex), "{name}: no diagonal at {vertex}");
            let given = Vec::from_iter(rows.row(vertex).0.iter().map(|&column| column as usize));
            for (column, value) in columns.iter().zip(values) {
                let place = given.iter().position(|it| it == column);
                let coefficient = place.map(|place| rows.row(vertex).1[place]);
                assert_eq!(coefficient, (*column != vertex).then_some(*value), "{name}");
            }
            let scale = 2.0 * values.iter().map(|c| c.abs()).sum::<f64>();
            let scale = scale.max(f64::MIN_POSITIVE);
            let (diagonal, implied) = (matrix.diagonal(vertex), rows.diagonal(vertex));
            tolerance::OPERATOR_ROUNDING.assert(diagonal, implied, scale, name);
            let error = norm(difference(result[vertex], expected[vertex]));
            tolerance::OPERATOR_ROUNDING.assert(error, 0.0, scale, name);
        }
        let entries = rows_entries(&rows) + vertices;
        assert_eq!(matrix.values().len(), entries, "{name}: entries");

        let before = matrix.clone();
        rows.fill_matrix(&mut matrix);
        assert_eq!(matrix, before, "{name}: filled again");
    }
}

/// Number of entries in all rows.
fn rows_entries(rows: &Rows<f64>) -> usize {
    (0..rows.len()).map(|row| rows.row(row).0.len()).sum()
}

/// n and the principal direction rotate with the surface; H, K and A are invariant under motion; H scales as 1/length, K as 1/length², A
/// as length². Only meshes with enough vertices are rotated, for the sake of operators that choose by
/// thresholds.
#[derive(Clone, Copy, Debug)]
pub struct CurvatureFollows<'a>(pub &'a Mesh);

impl CurvatureLaw for CurvatureFollows<'_> {
    fn check<L: Curvatures<f64> + Copy>(&mut self, name: &str, operator: L) {
        let pitch = 2.0_f64.powi(-40);
        let mesh = &self.0.map(|x| x.map(|x| (x / pitch).round() * pitch));
        let here = Measured::new(operator, mesh).curvature;
        let there =
            Measured::new(operator, &mesh.map(|x| [x[0] - 3.0, x[1], x[2] + 9.5])).curvature;
        assert_eq!(here, there, "{name}: translation");

        for exponent in [-40, 40] {
            let scale = 2.0_f64.powi(exponent);
            let scaled = mesh.map(|x| x.map(|x| scale * x));
            let scaled = Measured::new(operator, &scaled).curvature;
            let back = scaled.into_iter().map(|curvature| Curvature {
                mean: curvature.mean * scale,
                gaussian: curvature.gaussian * scale * scale,
                area: curvature.area / scale / scale,
                ..curvature
            });
            assert_eq!(Vec::from_iter(back), here, "{name}: scale 2^{exponent}");
        }

        if mesh.positions.len() < FEWEST_VERTICES {
            return;
        }
        let turn = rotation(GENERIC);
        let there = Measured::new(operator, &mesh.map(|x| turned(turn, x))).curvature;
        let largest = here.iter().map(|c| c.mean.abs()).fold(1.0, f64::max);
        for (here, there) in here.iter().zip(&there) {
            let normal = norm(difference(turned(turn, here.normal), there.normal));
            tolerance::INVARIANCE.assert(normal, 0.0, 1.0, name);
            tolerance::INVARIANCE.assert(there.mean, here.mean, largest, name);
            let square = largest * largest + here.gaussian.abs();
            tolerance::INVARIANCE.assert(there.gaussian, here.gaussian, square, name);
            // The less certain a direction, the smaller the difference of the curvatures.
            let [larger, smaller] = here.principal();
            let off = norm(cross(turned(turn, here.direction), there.direction));
            tolerance::INVARIANCE.assert((larger - smaller) * off, 0.0, largest, name);
            tolerance::INVARIANCE.assert(there.area, here.area, here.area.abs() + 1e-3, name);
        }
    }
}

/// Δ_S of a field is invariant when the surface is translated and rotated, and scales as 1/length².
#[derive(Clone, Copy, Debug)]
pub struct LaplacianFollows<'a>(pub &'a Mesh);

impl OperatorLaw for LaplacianFollows<'_> {
    fn check<L: LaplaceBeltrami<f64> + Copy>(&mut self, name: &str, operator: L) {
        let field = waves(self.0);
        let laplacian = |mesh: &Mesh| Measured::new(operator, mesh).apply_to_scalar(&field);
        let here = laplacian(self.0);
        // Scaling by a power of two is exact to the last bit, unless the code contains an absolute
        // number.
        for exponent in [-40, 40] {
            let scale = 2.0_f64.powi(exponent);
            let there = laplacian(&self.0.map(|x| x.map(|x| scale * x)));
            let back = there.into_iter().map(|value| value * scale * scale);
            assert_eq!(Vec::from_iter(back), here, "{name}: scale 2^{exponent}");
        }
        let turn = rotation(GENERIC);
        let there = laplacian(&self.0.map(|x| turned(turn, x).map(|x| x + 0.75)));
        for (found, expected) in there.into_iter().zip(here) {
            OPERATOR_MOTION.assert(found, expected, 10.0, name);
        }
    }
}

/// A smooth field.
fn waves(mesh: &Mesh) -> Vec<f64> {
    let wave = |&[x, y, z]: &[f64; 3]| (1.3 * x - 0.4 * y).sin() + z * (x + 0.2);
    mesh.positions.iter().map(wave).collect()
}

/// Checks every law of operators on an ellipsoid, for an operator that applies the rows that it assembles.
///
/// # Panics
/// If a law is broken.
pub fn check_operator(name: &str, operator: impl LaplaceBeltrami<f64> + Copy) {
    let shape = "ellipsoid".parse().expect("a shape");
    let made = generate(&shape, Family::Relaxed, 642, 0).expect("a mesh");
    let mesh = &Mesh {
        connectivity: made.mesh,
        positions: made.positions,
    };
    ConstantsVanish(mesh).check(name, operator);
    RowsAgree(mesh).check(name, operator);
    MatrixAgrees(mesh).check(name, operator);
    CurvatureFollows(mesh).check(name, operator);
    LaplacianFollows(mesh).check(name, operator);

    let (measured, field) = (Measured::new(operator, mesh), waves(mesh));
    let mut rows = Rows::new();
    measured.assemble(&mut rows);
    let mut by_rows = vec![f64::NAN; field.len()];
    rows.apply_to_scalar(&Serial, &field, &mut by_rows);
    assert_eq!(by_rows, measured.apply_to_scalar(&field), "{name}: rows");
}

/// Checks the laws that hold on the smallest meshes, and returns the operator's findings on each.
///
/// # Panics
/// If a law is broken.
pub fn findings_on_small_meshes(
    operator: impl LaplaceBeltrami<f64> + Copy,
) -> Vec<(&'static str, Vec<Finding>)> {
    let check = |(name, mesh): (&'static str, Mesh)| {
        OperatorLaw::check(&mut Finite(&mesh), name, operator);
        ConstantsVanish(&mesh).check(name, operator);
        RowsAgree(&mesh).check(name, operator);
        MatrixAgrees(&mesh).check(name, operator);
        (name, Measured::new(operator, &mesh).findings())
    };
    small().into_iter().map(check).collect()
}
