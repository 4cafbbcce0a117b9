//! Polynomials fitted to the surface around a vertex by least squares, as height functions, and the
//! curvatures of their graphs.
//!
//! Several vertices are fitted at once, one in each entry of a lane.

pub(crate) mod cholesky;
mod graph;
mod inversion;
mod least_squares;
mod moments;
mod normal_equations;
mod spacing;

pub(crate) use graph::{Graph, force_density, graph_at};
pub(crate) use inversion::Inversion;
pub(crate) use least_squares::LeastSquares;
pub(crate) use moments::{
    HIGHEST_DEGREE, MONOMIALS, Points, TOGETHER, coefficient_count, evaluate, exponential,
    place_of, set_moments,
};
pub(crate) use normal_equations::NormalEquations;
pub(crate) use spacing::{Spacing, spacing};
