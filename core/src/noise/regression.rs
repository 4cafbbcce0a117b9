//! Curvatures and bending forces from polynomials that are fitted to more vertices than they have
//! coefficients.

use super::fit::{HeightFit, Model, reach};
use super::slopes::Slopes;
use super::{DEGREES, normals};
use crate::element::Execution;
use crate::lane::Lane;
use crate::neighbourhood::Neighbourhood;
use crate::real::Real;
use crate::surface::Surface;
use alloc::vec;
use alloc::vec::Vec;
use core::array::from_fn;

/// Least diagonal entry of the triangular factor with which a fit is accepted.
const CONDITIONING: f64 = 1e-3;

/// Regression jets: least-squares polynomials of degrees 4 and 6 with a constant term, of the heights of k
/// neighbours over the tangent plane, weighted `exp(−4 r²/ρ²)`.
///
/// They average noise of the positions, while jets through the vertex pass it on: the standard
/// deviation due to noise falls as k⁻³ᐟ² in H and as k⁻⁵ᐟ² in Δ_S H. The smoothing error grows with
/// the radius of the neighbourhood: in H with its 6th power for degree 6, and with its 4th power
/// for degree 4.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Regression {
    /// Number of neighbours k of a fit, at least 28. Where the surface turns away from the tangent
    /// plane fewer are used, but at least min(k, 64).
    pub neighbours: usize,
}

/// Regression jets around every vertex of a surface, and of R copies of the surface with other heights.
#[derive(Clone, Debug)]
pub struct RegressionFits<T, const R: usize> {
    around: Vec<Around<T, R>>,
}

/// The fit around one vertex; without neighbours if it failed.
#[derive(Clone, Debug)]
struct Around<T, const R: usize> {
    /// The vertex itself, then its neighbours.
    vertices: Vec<u32>,
    /// H and K of each copy, for both degrees.
    curvatures: [[[T; 2]; R]; 2],
    /// Rows of the Laplace–Beltrami operator, for both degrees.
    laplacians: [Vec<T>; 2],
    /// The row of the constant term of degree 4.
    average: Vec<T>,
}

/// Fields of R copies of a surface, one entry per vertex; NaN where the fit failed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RegressionFields<T, const R: usize> {
    /// H, positive on a sphere.
    pub mean: Vec<[T; R]>,
    /// K.
    pub gaussian: Vec<[T; R]>,
    /// Δ_S H, of the fitted H.
    pub laplacian_of_mean: Vec<[T; R]>,
    /// The bending force density 2[Δ_S H + 2H(H² − K)] along the normal, for κ = 1.
    pub force_density: Vec<[T; R]>,
}

impl Regression {
    /// Fits around every vertex. The vertices of copy m are `errors[vertex][m]` above those of the
    /// surface; all copies share the neighbourhoods and tangent planes of the surface.
    ///
    /// # Panics
    /// If `errors` has fewer entries than the surface has vertices.
    pub fn fit<T: Real, const R: usize>(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        errors: &[[T; R]],
    ) -> RegressionFits<T, R> {
        let normals = normals(surface);
        let model = Model {
            degree: DEGREES[1],
            sharpness: T::constant(4.0),
            interpolates: false,
        };
        let none = Around {
            vertices: Vec::new(),
            curvatures: [[[T::nan(); 2]; R]; 2],
            laplacians: [Vec::new(), Vec::new()],
            average: Vec::new(),
        };
        let mut around = vec![none; surface.mesh().vertex_count()];
        let mut memory: Vec<(Neighbourhood<T>, HeightFit<T>)> = Vec::new();
        execution.map_with(
            &mut memory,
            &mut around[..],
            |(near, fit), place, around| {
                let vertex = place as u32;
                let count = reach(surface, &normals, vertex, self.neighbours, near);
                let neighbours = &near.found[..count];
                fit.gather(surface, vertex, neighbours, &model);
                let mut normal = normals[place];
                if fit.fit(&mut normal, &model) >= T::constant(CONDITIONING) {
                    around.vertices.push(vertex);
                    let found = neighbours.iter().map(|&(_, neighbour)| neighbour);
                    around.vertices.extend(found);
                    around.take(fit, &model, errors);
                }
            },
        );
        RegressionFits { around }
    }
}

impl<T: Real, const R: usize> Around<T, R> {
    /// Computes curvatures and rows from a fit.
    fn take(&mut self, fit: &mut HeightFit<T>, model: &Model<T>, errors: &[[T; R]]) {
        let mut coefficients = Vec::new();
        for (which, degree) in DEGREES.into_iter().enumerate() {
            for copy in (0..R).rev() {
                let error = |row: usize| errors[self.vertices[row] as usize][copy];
                fit.coefficients_with(model, degree, error, &mut coefficients);
                let slopes = Slopes::new(&coefficients[1..], fit.radius());
                self.curvatures[which][copy] = slopes.curvatures();
            }
            fit.coefficients_with(model, degree, |_| T::zero(), &mut coefficients);
            let functional = Slopes::new(&coefficients[1..], fit.radius()).laplacian(fit.radius());
            let mut rows = [Vec::new()];
            fit.rows(model, degree, &[functional], &mut rows);
            [self.laplacians[which]] = rows;
        }
        let mut rows = [Vec::new()];
        fit.rows(model, DEGREES[0], &[[T::one()]], &mut rows);
        [self.average] = rows;
    }
}

impl<T: Real, const R: usize> RegressionFits<T, R> {
    /// Mean number of neighbours of a fit.
    pub fn neighbours(&self) -> T {
        let fitted = self.around.iter().map(|around| around.vertices.len());
        let fitted = fitted.filter(|&count| count > 0);
        let (sum, count) = fitted.fold((0, 0), |(sum, count), more| (sum + more - 1, count + 1));
        T::constant(sum as f64) * T::constant(f64::from(count)).reciprocal_or_zero()
    }

    /// Fields of polynomials of degree 4, and of degree 6.
    pub fn fields(&self, execution: &impl Execution) -> [RegressionFields<T, R>; 2] {
        [0, 1].map(|which| {
            let curvature = |kind: usize| {
                let around = self.around.iter();
                let values = around.map(|around| from_fn(|m| around.curvatures[which][m][kind]));
                Vec::from_iter(values)
            };
            let [mean, gaussian] = [curvature(0), curvature(1)];
            let laplacian_of_mean =
                self.apply(execution, &mean, |around| &around.laplacians[which]);
            let two = T::constant(2.0);
            let force = |vertex: usize| {
                from_fn(|m| {
                    let [h, k] = [mean[vertex][m], gaussian[vertex][m]];
                    two * (laplacian_of_mean[vertex][m] + two * h * (h * h - k))
                })
            };
            let force_density = (0..mean.len()).map(force).collect();
            RegressionFields {
                mean,
                gaussian,
                laplacian_of_mean,
                force_density,
            }
        })
    }

    /// The values of polynomials of degree 4 that are fitted to a field around every vertex.
    /// Repeated application removes ever longer waves.
    pub fn average(&self, execution: &impl Execution, field: &[[T; R]]) -> Vec<[T; R]> {
        self.apply(execution, field, |around| &around.average)
    }

    fn apply(
        &self,
        execution: &impl Execution,
        field: &[[T; R]],
        row: impl Fn(&Around<T, R>) -> &[T] + Sync,
    ) -> Vec<[T; R]> {
        let mut result = vec![[T::nan(); R]; self.around.len()];
        let mut memory: Vec<()> = Vec::new();
        execution.map_with(&mut memory, &mut result[..], |(), vertex, result| {
            let around = &self.around[vertex];
            if around.vertices.is_empty() {
                return;
            }
            *result = [T::zero(); R];
            for (&other, &entry) in around.vertices.iter().zip(row(around)) {
                for (sum, &value) in result.iter_mut().zip(&field[other as usize]) {
                    *sum += entry * value;
                }
            }
        });
        result
    }
}
