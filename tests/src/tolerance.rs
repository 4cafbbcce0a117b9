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
/// Values, sums and identities of spline bases and refinement, relative to the control points' size.
pub const SPLINE: Tolerance = Tolerance::new(
    1e-13,
    "some tens of products of weights; derivatives are compared in units of 2^level",
);
/// Derivatives of spline bases against central differences, relative to the largest.
pub const SPLINE_DIFFERENCE: Tolerance = Tolerance::new(
    1e-8,
    "second-order differences with a step of 1e-5 leave 1e-10 of truncation and 1e-11 of rounding",
);
/// Tangent planes and curvatures of one surface from different patches, relative.
pub const SPLINE_GEOMETRY: Tolerance = Tolerance::new(
    1e-9,
    "second derivatives of random control points, divided by the squares of tangents of any size",
);
/// Forces against the energy's derivative by dual numbers, relative to the largest force.
pub const GRADIENT_EXACT: Tolerance = Tolerance::new(
    1e-11,
    "dual numbers add no truncation; the sums over disturbed meshes cancel to about a thousandth",
);
/// Forces against central differences of the energy, relative to the largest force.
pub const GRADIENT_DIFFERENCE: Tolerance = Tolerance::new(
    1e-7,
    "fourth-order differences with a step of 2e-4 leave 1e-8 of truncation and 1e-10 of rounding",
);
/// Net force and torque of a conservative method, relative to the sum of all forces' lengths.
pub const NET_FORCE: Tolerance = Tolerance::new(
    1e-12,
    "exact but for the rounding of each force, and of weights whose sums are 0",
);
/// Energies and forces of a surface that was rotated and moved by about its size, relative.
pub const RIGID_MOTION: Tolerance = Tolerance::new(
    1e-11,
    "positions are rounded anew, and forces are their fourth derivatives",
);
/// Energy of method S with sharpened or hybrid control points on smooth discocytes, relative.
pub const LOOP_DISCOCYTE_642: Tolerance = Tolerance::new(
    1.5e-3,
    "fourth order away from twelve extraordinary vertices; measured 1.0e-3",
);
/// The same with four times the vertices.
pub const LOOP_DISCOCYTE_2562: Tolerance = Tolerance::new(1.2e-4, "measured 7e-5");
/// The same with sixteen times the vertices.
pub const LOOP_DISCOCYTE_10242: Tolerance = Tolerance::new(1e-5, "measured 5e-6");
/// Energy of method S in f32 against f64, relative.
pub const LOOP_SINGLE: Tolerance = Tolerance::new(
    1e-6,
    "positions rounded at 6e-8 are differentiated twice, over edges of a twentieth",
);
