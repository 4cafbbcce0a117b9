//! Positions on polynomials that are fitted to more vertices than they have coefficients.

use super::fit::{HeightFit, Model};
use super::normals;
use crate::element::{Execution, of_vertices};
use crate::neighbourhood::Neighbourhood;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, dot, scale};
use alloc::vec::Vec;

/// Number of neighbours that a fit keeps, however much the surface turns.
const LEAST: usize = 64;

/// Least cosine between the normals of a vertex and of the neighbours beyond those.
const UPRIGHT: f64 = 0.35;

/// Moves each vertex along its normal onto a polynomial fitted to its neighbourhood: a least-squares jet
/// of degree 4 with a constant term, weighted `exp(−4 r²/ρ²)`.
///
/// Repeated application removes ever longer waves of noise. The change of the shape grows with the
/// sixth power of the radius of a neighbourhood: several applications with few neighbours change
/// the shape less than one with many. Positions along the surface do not change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Smoothing {
    /// Number of neighbours k of a fit. Where the surface turns away fewer are used, but at least
    /// min(k, 64).
    pub neighbours: usize,
}

impl Smoothing {
    /// Sets `smooth` to the positions after smoothing, one entry per vertex. A vertex whose
    /// neighbours do not determine a fit is not moved.
    ///
    /// # Panics
    /// If `smooth` has fewer entries than the surface has vertices.
    pub fn apply<T: Real>(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        smooth: &mut [[T; 3]],
    ) {
        let normals = normals(surface);
        let model = Model {
            degree: 4,
            sharpness: T::constant(4.0),
            interpolates: false,
        };
        let mut memory: Vec<(Neighbourhood<T>, HeightFit<T>)> = Vec::new();
        let smooth = of_vertices(surface, smooth);
        execution.map_with(&mut memory, smooth, |(near, fit), vertex, position| {
            *position = surface.positions()[vertex];
            let here = normals[vertex];
            let count = reach(surface, &normals, vertex as u32, self.neighbours, near);
            fit.gather(surface, vertex as u32, &near.found[..count], &model);
            let mut normal = here;
            if fit.fit(&mut normal, &model) > T::epsilon().sqrt() {
                *position = add(*position, scale(fit.constant(&model), normal));
            }
        });
    }
}

/// Finds the nearest neighbours of a vertex; how many of them a fit takes.
pub(super) fn reach<T: Real>(
    surface: Surface<'_, T>,
    normals: &[Vec3<T>],
    vertex: u32,
    neighbours: usize,
    near: &mut Neighbourhood<T>,
) -> usize {
    near.nearest(surface, vertex, neighbours);
    let here = normals[vertex as usize];
    let turned = |&(_, other): &(T, u32)| dot(normals[other as usize], here) < T::constant(UPRIGHT);
    let upright = near.found.iter().position(turned);
    let count = upright.map_or(near.found.len(), |count| count.max(LEAST));
    count.min(near.found.len())
}
