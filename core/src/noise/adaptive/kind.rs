//! The kinds of fits: polynomials, numbers of neighbours, and what is asked of these.

use crate::noise::DEGREES;
use crate::noise::fit::Model;
use crate::real::Real;

/// Degree, number of neighbours and sharpness of a fit.
pub(super) type OneSided = (usize, usize, f64);

/// The fits of vertices at a boundary: without noise the third or the last is chosen at most vertices of a mesh
/// that resolves the shape, with noise the first.
const AT_BORDER: [OneSided; 4] = [(6, 112, 7.0), (6, 80, 7.0), (8, 180, 12.0), (8, 180, 18.0)];

/// The fit with which these are compared for error bars: most of the distance is the error of this one. By degree
/// 6 over 128 neighbours, bars were five times as wide on fine meshes, and too narrow on coarse ones.
const WIDER_AT_BORDER: [OneSided; 1] = [(8, 250, 12.0)];

/// Least diagonal entry of the triangular factor with which a jet is accepted: before and after it has
/// the largest number of neighbours that is allowed.
const CONDITIONING: [f64; 2] = [0.012, 0.001];

/// The same limits for regression jets and for the wider jets with which others are compared. It is 0.05
/// and more on irregular meshes; where a regular mesh has 0.012 to 0.05, H of exact tori was off by a
/// fifth, because neighbours near a conic section do not determine the polynomial.
const STRICT: [f64; 2] = [0.05, 0.012];

/// Number of neighbours that determines a polynomial of degree 6 well on any mesh.
const SURE: usize = 128;

/// Ratio of the numbers of neighbours of jets at a boundary and elsewhere: with fewer, errors of the
/// positions are amplified several times.
pub(super) const ONE_SIDED: [usize; 2] = [10, 7];

/// The kind of the fits of a level.
#[derive(Clone, Copy, Debug)]
pub(super) struct FitKind<T> {
    pub(super) model: Model<T>,
    /// Number of neighbours at first, and at most if the fit needs more.
    pub(super) neighbours: [usize; 2],
    /// Least diagonal entries of the triangular factor.
    pub(super) conditioning: [f64; 2],
    /// Whether these are to hold for the columns in any order, as for the jets of the library: on regular tori the
    /// factor had 0.012 or more where f of the fit was off by five orders of magnitude.
    pub(super) in_any_order: bool,
    /// The fits among which vertices at a boundary choose; if empty, they have the fit of other vertices.
    pub(super) at_border: &'static [OneSided],
}

impl<T: Real> FitKind<T> {
    /// A polynomial through the vertex, as [`Jet::j6`](crate::Jet::j6) has it.
    pub(super) fn interpolating() -> Self {
        Self {
            model: Model {
                degree: DEGREES[1],
                sharpness: T::constant(7.0),
                interpolates: true,
            },
            neighbours: [56, 112],
            conditioning: CONDITIONING,
            in_any_order: true,
            at_border: &AT_BORDER,
        }
    }

    /// Jets of the library with these polynomials.
    pub(super) fn of_jets(model: Model<T>) -> Self {
        Self {
            model,
            ..Self::interpolating()
        }
    }

    /// Jets over more neighbours, for estimates of the errors of [`Self::interpolating`].
    pub(super) fn wider() -> Self {
        Self {
            neighbours: [90, 180],
            conditioning: STRICT,
            in_any_order: false,
            at_border: &WIDER_AT_BORDER,
            ..Self::interpolating()
        }
    }

    /// A regression with a constant term. With few neighbours, of which some lie near a conic section, it
    /// may need more.
    pub(super) fn regression(neighbours: usize) -> Self {
        let more = if neighbours < SURE { neighbours / 2 } else { 0 };
        Self {
            model: Model {
                degree: DEGREES[1],
                sharpness: T::constant(4.0),
                interpolates: false,
            },
            neighbours: [neighbours, neighbours + more],
            conditioning: STRICT,
            in_any_order: false,
            at_border: &[],
        }
    }

    /// The largest number of vertices in a fit, including the vertex itself.
    pub(super) fn room(&self) -> usize {
        self.neighbours[1] + 1
    }
}
