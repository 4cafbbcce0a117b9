//! Positions on polynomials that are fitted to more vertices than they have coefficients.

use super::fit::{HeightFit, Model, reach};
use super::{DEGREES, Measured, Verdict, normals};
use crate::element::{Execution, of_vertices};
use crate::neighbourhood::Neighbourhood;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{add, scale};
use alloc::vec::Vec;

/// Moves each vertex along its normal onto a polynomial fitted to its neighbourhood: a least-squares jet
/// with a constant term, weighted `exp(−4 r²/ρ²)`.
/// Repeated application removes ever longer waves of noise. The shape changes with a high power of the
/// radius of a neighbourhood, the sixth for degree 4 and the eighth for degree 6: several applications
/// with few neighbours change it less than one with many. Vertices do not move along the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Smoothing {
    /// Degree of the polynomials, 2 … 6.
    pub degree: usize,
    /// Number of neighbours k of a fit. Where the surface turns away from the tangent plane fewer are
    /// used, but at least min(k, 64).
    pub neighbours: usize,
}

impl Smoothing {
    /// Fits of degree 4 to a number of neighbours, for surfaces whose noise is not measured: of the two degrees that
    /// average noise, the one that smooths more.
    pub fn of_neighbours(neighbours: usize) -> Self {
        Self {
            degree: DEGREES[0],
            neighbours,
        }
    }

    /// One degree and number of neighbours for a surface measured by adaptive jets: the most frequent
    /// degree of their fits for H, and the median number of neighbours of these. `None` unless half of
    /// the vertices have noise, and half of all fits average it: other surfaces should not be smoothed.
    pub fn of_measured<T: Real>(measured: &[Measured<T>]) -> Option<Self> {
        let is_noisy = |at: &&Measured<T>| at.verdict == Verdict::Noise;
        let noisy = measured.iter().filter(is_noisy).count();
        let of_degree = |degree: u8| {
            let scales = measured.iter().map(|at| at.mean.scale);
            let own = scales.filter(|scale| !scale.interpolates && scale.degree == degree);
            let mut neighbours = Vec::from_iter(own.map(|scale| scale.neighbours));
            neighbours.sort_unstable();
            (degree, neighbours)
        };
        let [fourth, sixth] = DEGREES.map(|degree| of_degree(degree as u8));
        let averaging = fourth.1.len() + sixth.1.len();
        if 2 * noisy.min(averaging) < measured.len() {
            return None;
        }
        let (degree, neighbours) = if sixth.1.len() >= fourth.1.len() {
            sixth
        } else {
            fourth
        };
        let median = *neighbours.get(neighbours.len() / 2)?;
        Some(Self {
            degree: usize::from(degree),
            neighbours: median as usize,
        })
    }

    /// Sets `smooth` to the positions after smoothing, one entry per vertex. A vertex whose
    /// neighbours do not determine a fit is not moved.
    ///
    /// # Panics
    /// If `smooth` has fewer entries than the surface has vertices, or the degree is not 2 to 6.
    pub fn apply<T: Real>(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        smooth: &mut [[T; 3]],
    ) {
        assert!(
            (2..=6).contains(&self.degree),
            "polynomials that smooth have degrees 2 to 6, not {}",
            self.degree
        );
        let normals = normals(surface);
        let model = Model {
            degree: self.degree,
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
