//! The one table of tolerances: every number a test allows, with the reason for it.

/// How far a computed number may be from the expected one.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// The bound, relative to what the test says.
    pub value: f64,
    /// Why it is this and not less.
    pub reason: &'static str,
}

impl Tolerance {
    const fn new(value: f64, reason: &'static str) -> Self {
        Self { value, reason }
    }

    /// Fails unless |`found` − `expected`| ≤ value · `scale`.
    #[track_caller]
    pub fn assert(&self, found: f64, expected: f64, scale: f64, what: &str) {
        let error = (found - expected).abs() / scale;
        assert!(
            error <= self.value,
            "{what}: found {found:e}, expected {expected:e}, error {error:.2e} above {:.1e} ({})",
            self.value,
            self.reason
        );
    }
}

/// Exact shapes against tabulated values, relative to each quantity's largest.
pub const SHAPE_REFERENCE: Tolerance = Tolerance::new(
    1e-13,
    "the tabulated radius is rounded once, and Δ_S H is a fourth derivative of the profile",
);
/// Exact shapes against derivatives by dual numbers, relative to a power of the curvature.
pub const SHAPE_DERIVATIVE: Tolerance = Tolerance::new(
    1e-11,
    "dual numbers add no truncation; near the rim the extension off the surface has large terms",
);
/// Exact shapes at different scales, relative to a power of the curvature.
pub const SHAPE_SCALING: Tolerance = Tolerance::new(
    2e-14,
    "the scale enters by a few multiplications; the pre-image's last bits differ",
);
/// Exact shapes in f32 against f64, relative to each quantity's largest.
pub const SHAPE_SINGLE: Tolerance = Tolerance::new(
    2e-5,
    "f32 rounds at 6e-8, and the pre-image's rounding is amplified by H''' of the discocyte",
);
/// Pre-image of a position, absolute on the unit sphere.
pub const SHAPE_PREIMAGE: Tolerance =
    Tolerance::new(1e-14, "a division, a square root and a normalisation");
/// Exact normals against central differences of positions, absolute.
pub const NORMAL_DIFFERENCE: Tolerance = Tolerance::new(
    1e-7,
    "second-order differences with a step of 1e-5 leave 1e-10 of truncation and 1e-11/1e-5 of rounding",
);
/// Integrals over exact shapes by quadrature, relative.
pub const SHAPE_INTEGRAL: Tolerance = Tolerance::new(
    1e-12,
    "Gauss and trapezoidal rules on analytic integrands; what is left is summed rounding",
);
/// A point of a mesh on its shape, relative to the shape's size.
pub const ON_SURFACE: Tolerance = Tolerance::new(
    1e-13,
    "positions are the image of their pre-images, and the way back rounds a few times",
);
/// What an operator makes of a surface against what it makes of the surface moved, relative to the
/// curvatures.
pub const OPERATOR_MOTION: Tolerance = Tolerance::new(
    1e-9,
    "positions are rounded anew at 1e-16 and second derivatives divide that by h² = 1e-2, times \
     the condition of a fit",
);
/// Errors of methods that do not converge, against what another implementation measured on other
/// meshes of the same kind, relative.
pub const PUBLISHED_ERROR: Tolerance = Tolerance::new(
    0.4,
    "a largest error over the vertices depends on how the icosahedron is turned and mapped; the \
     orders do not",
);
/// Two entries of a symmetric matrix that are computed apart, relative to themselves.
pub const SYMMETRY: Tolerance = Tolerance::new(
    1e-13,
    "products of a few factors, in another order; the exponential's argument reaches 36 and \
     multiplies its rounding by that",
);
/// Forces against derivatives of the energy by dual numbers, relative to the largest force.
pub const GRADIENT: Tolerance = Tolerance::new(
    1e-10,
    "both are exact; cotangents of irregular triangles amplify the rounding of 1e-16",
);
/// Forces against central differences of the energy, relative to the largest force.
pub const GRADIENT_DIFFERENCE: Tolerance = Tolerance::new(
    1e-6,
    "a step of 1e-5 leaves truncation of (1e-5/edge)² and rounding of E 1e-16/1e-5",
);
/// Sum and torque of forces that have none, relative to the largest force.
pub const NET_FORCE: Tolerance =
    Tolerance::new(1e-11, "rounding of some hundred forces on a body of size 1");
/// What a method computes in two ways that agree but for rounding, relative.
pub const SAME: Tolerance = Tolerance::new(
    1e-11,
    "some operations in another order, on numbers that do not cancel",
);
/// Energies and curvatures that stall, against the value at which they are known to, relative.
pub const STALL: Tolerance = Tolerance::new(
    5e-3,
    "the known value has three digits, and meshes of the same kind differ in the next",
);
