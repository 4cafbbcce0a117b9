//! Laplace–Beltrami operators as matrices.

use super::{BendingMethod, MethodOptions, Settings, Visitor, choose};
use crate::execute::Parallel;
use helfrich::laplacian::Rows;
use helfrich::{
    Conservative, Curvatures, ForceDensity, LaplaceBeltrami, MaterialParameter, Prepared,
    SparseMatrix, StrongForm, Surface,
};
use std::fmt;

/// The operator of a method in strong form on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct OperatorMatrix {
    /// Δ_S, pointwise: rows for the vertices at which the results are.
    pub matrix: SparseMatrix<f64>,
    /// The area of each vertex.
    pub areas: Vec<f64>,
}

/// A method that has no Laplace–Beltrami operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{0} has no Laplace–Beltrami operator: meyer, belkin, farutin, j4, j6, j8 and jet have one"
)]
pub struct NoOperator(pub BendingMethod);

impl BendingMethod {
    /// The Laplace–Beltrami operator of a method in strong form, as a matrix.
    ///
    /// # Errors
    /// If the method has none.
    pub fn operator(
        self,
        options: &MethodOptions,
        surface: Surface<'_, f64>,
    ) -> Result<OperatorMatrix, NoOperator> {
        let settings = Settings {
            modulus: MaterialParameter::Constant(1.0),
            spontaneous_curvature: MaterialParameter::default(),
            options,
            mesh: surface.mesh(),
        };
        let assembling = Assembling {
            method: self,
            surface,
        };
        choose(self, settings, assembling)
    }
}

/// A surface on which an operator is assembled.
struct Assembling<'a> {
    method: BendingMethod,
    surface: Surface<'a, f64>,
}

impl Visitor<f64> for Assembling<'_> {
    type Output = Result<OperatorMatrix, NoOperator>;

    fn energy<M>(self, _method: M) -> Self::Output
    where
        M: Conservative<f64> + fmt::Debug + Send + 'static,
    {
        Err(NoOperator(self.method))
    }

    fn energy_and_curvatures<M>(self, _method: M) -> Self::Output
    where
        M: Conservative<f64> + Curvatures<f64> + fmt::Debug + Send + 'static,
    {
        Err(NoOperator(self.method))
    }

    fn energy_and_density<M>(self, _method: M) -> Self::Output
    where
        M: Conservative<f64> + Curvatures<f64> + ForceDensity<f64> + fmt::Debug + Send + 'static,
    {
        Err(NoOperator(self.method))
    }

    fn strong_form<L>(self, method: StrongForm<f64, L>) -> Self::Output
    where
        L: LaplaceBeltrami<f64> + fmt::Debug + Send + Sync + 'static,
    {
        let (operator, surface) = (method.operator, self.surface);
        let mut prepared = Prepared::with_execution(operator, surface.mesh(), Parallel::new());
        let measured = prepared.curvatures(surface).iter();
        let areas = measured.map(|vertex| vertex.area).collect();
        let mut rows = Rows::new();
        prepared.assemble(surface, &mut rows);
        let mut matrix = SparseMatrix::new();
        rows.fill_matrix(&mut matrix);
        Ok(OperatorMatrix { matrix, areas })
    }

    fn curvatures<M>(self, _method: M) -> Self::Output
    where
        M: Curvatures<f64> + fmt::Debug + Send + 'static,
    {
        Err(NoOperator(self.method))
    }
}
