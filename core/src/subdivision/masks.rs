//! The weights of Loop's rules.

use num_traits::Float;

/// Ends of an edge, and the vertices across from it.
pub(super) const EDGE: [f64; 2] = [0.375, 0.125];
/// A boundary vertex, and its neighbours along the boundary.
pub(super) const BOUNDARY_VERTEX: [f64; 2] = [0.75, 0.125];
/// The same in the limit.
pub(super) const BOUNDARY_LIMIT: [f64; 2] = [2.0 / 3.0, 1.0 / 6.0];

/// Loop's β: the weight of each neighbour of an interior vertex when it is refined,
/// `β_n = (5/8 − (3/8 + cos(2π/n)/4)²)/n`; the vertex itself has `1 − nβ_n`.
///
/// Meant for valences n ≥ 3, which all interior vertices have.
pub fn vertex_weight(valence: usize) -> f64 {
    let n = valence as f64;
    // Rounded alike on every machine for the valences that nearly all vertices have.
    let cosine = match valence {
        3 => -0.5,
        4 => 0.0,
        5 => (Float::sqrt(5.0f64) - 1.0) / 4.0,
        6 => 0.5,
        _ => Float::cos(core::f64::consts::TAU / n),
    };
    let root = 0.375 + 0.25 * cosine;
    (0.625 - root * root) / n
}

/// ω: the weight of each neighbour in the limit position of an interior vertex,
/// `ω_n = 1/(3/(8β_n) + n)`; the vertex itself has `1 − nω_n`.
///
/// Meant for valences n ≥ 3, which all interior vertices have.
pub fn limit_weight(valence: usize) -> f64 {
    1.0 / (0.375 / vertex_weight(valence) + valence as f64)
}
