//! Tolerances that several test files share, each with its reason. A tolerance of a single file stands in
//! that file.

pub mod methods;

/// Bound on the deviation of a computed number from the expected one.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// Bound, relative to the scale that the test gives.
    pub value: f64,
    /// Reason for this bound and against a smaller one.
    pub reason: &'static str,
}

impl Tolerance {
    /// The tolerance `value`, because of `reason`.
    pub const fn new(value: f64, reason: &'static str) -> Self {
        Self { value, reason }
    }

    /// Fails unless |`found` − `expected`| ≤ value · `scale`.
    #[track_caller]
    pub fn assert(&self, found: f64, expected: f64, scale: f64, what: &str) {
        let error = (found - expected).abs() / scale;
        assert!(
            approx::abs_diff_eq!(found, expected, epsilon = self.value * scale),
            "{what}: found {found:e}, expected {expected:e}, error {error:.2e} above {:.1e} ({})",
            self.value,
            self.reason
        );
    }
}

/// Errors of methods that do not converge, against those that another implementation measured on other meshes
/// of the same kind, relative.
pub const PUBLISHED_ERROR: Tolerance = Tolerance::new(
    0.4,
    "a largest error over the vertices depends on how the icosahedron is turned and mapped; the \
     orders do not",
);

/// Net force and torque of forces that should have none, relative to the largest force.
pub const NO_NET_FORCE: Tolerance =
    Tolerance::new(1e-11, "rounding of some hundred forces on a body of size 1");

/// Results of two computations that differ only by rounding, relative.
pub const SAME: Tolerance = Tolerance::new(
    1e-11,
    "some operations in another order, on numbers that do not cancel",
);

/// Energies and curvatures that do not converge, against the known values at which they stall, relative.
pub const STALL: Tolerance = Tolerance::new(
    5e-3,
    "the known value has three digits, and meshes of the same kind differ in the fourth",
);

/// Forces against derivatives by dual numbers, relative to the largest force.
pub const GRADIENT_DUAL: Tolerance = Tolerance::new(
    1e-12,
    "dual numbers differentiate the same formula: only rounding is left",
);

/// Net force and torque of exact gradients, relative to Σ|F| and Σ|F||x|.
pub const BALANCE: Tolerance = Tolerance::new(1e-14, "a sum of terms that cancel, each rounded");

/// Rotation, relabelling and scaling, relative to the largest force times the mesh's roughness.
pub const INVARIANCE: Tolerance = Tolerance::new(
    1e-11,
    "the moved positions are rounded, and bending forces divide that by an edge length up to four times",
);

/// Relabelling of effects on meshes of ten thousand vertices, relative to the largest force.
pub const RELABELLED: Tolerance = Tolerance::new(
    1e-10,
    "second differences of B over edges of h = 0.03 divide roundings of 1e-16 by h²; sums of 1e4 terms",
);

/// Gauss–Bonnet, relative to the sum of all absolute angles.
pub const GAUSS_BONNET: Tolerance = Tolerance::new(1e-12, "a sum of rounded angles");

/// Σ of dual areas against the total area, relative to the sum of absolute parts.
pub const AREA_SUM: Tolerance = Tolerance::new(1e-13, "a sum of rounded parts");

/// Two orders of summation of an operator's row, relative to Σ|c| times the field.
pub const OPERATOR_ROUNDING: Tolerance =
    Tolerance::new(1e-14, "a dozen terms, each rounded a few times");

/// Δ_S of polynomials on flat patches, relative to Σ|c| times the field.
pub const FLAT_EXACT: Tolerance = Tolerance::new(1e-14, "exact but for rounding");

/// Areas, volumes and angles of known polyhedra, relative.
pub const POLYHEDRON: Tolerance = Tolerance::new(1e-15, "a few roundings of f64");

/// Values, sums and identities of spline bases and refinement, relative to the control points' size.
pub const SPLINE: Tolerance = Tolerance::new(
    1e-13,
    "some tens of products of weights; derivatives are compared in units of 2^level",
);

/// In-plane energies and forces in f32 against f64, relative to the largest.
pub const SINGLE_STRAIN: Tolerance = Tolerance::new(
    2e-5,
    "positions rounded at 6e-8 over edges of a tenth, and strains of a tenth",
);

/// |F/F0 − 1| after a correction.
pub const CONSTRAINED: Tolerance = Tolerance::new(
    1e-14,
    "some roundings of a value and of the positions it is taken from",
);

/// Rates of change of a quantity along directions that should preserve it, by central differences.
pub const TANGENT: Tolerance = Tolerance::new(
    1e-7,
    "a step of 1e-6 leaves 1e-12 of truncation and 1e-15/1e-6 of rounding, times a value of 20",
);

/// Area and volume of a vesicle in every step of its relaxation, relative.
pub const HELD: Tolerance = Tolerance::new(
    1e-10,
    "what the settings allow; Newton's method leaves far less",
);

/// Energies of vesicles of 2562 vertices against theory, relative.
pub const VESICLE_ENERGY: Tolerance = Tolerance::new(
    7e-3,
    "second order: the area and volume that are held are those of the polyhedron",
);

/// Positions and lengths in pictures, relative to a length of about a hundred pixels.
pub const PICTURE_RADIUS: Tolerance = Tolerance::new(
    1e-2,
    "pixels that an outline merely touches count as covered, an excess of half a pixel in a hundred",
);

/// Velocities that the same forces cause in other units, relative to the largest.
pub const FLOW_ROUNDING: Tolerance =
    Tolerance::new(1e-13, "thousands of terms summed in one order");

/// Velocities on a sphere of 2562 vertices against exact ones, relative.
pub const FLOW_SPHERE: Tolerance = Tolerance::new(
    2e-3,
    "second order: the polyhedron's area and volume are 1.3e-3 short",
);

/// Velocities near a surface whose triangles are halved adaptively, against those of the same surface with
/// edges a sixteenth as long, relative.
pub const FLOW_NEAR: Tolerance = Tolerance::new(
    5e-4,
    "the rule of edge midpoints on a triangle at twice its edge length is accurate to 1e-3 of the \
     contribution",
);

/// Velocities and pressures of the double layer, and pressures of the single one, near a triangle,
/// relative.
pub const FLOW_SEVEN_STRESSLETS: Tolerance = Tolerance::new(
    1e-5,
    "as for the single layer, with two more powers of the distance under the integral",
);

/// Velocities in, on and around a strained sphere of 2562 vertices at any viscosity ratio, absolute at
/// velocities of order 1.
pub const FLOW_STRAINED: Tolerance = Tolerance::new(
    5e-3,
    "second order: the polyhedron's area and volume are 1.3e-3 short, and forces grow as 2λ + 3",
);

/// Solutions of the integral equation of both layers that should be the same, relative.
pub const FLOW_SOLVED: Tolerance = Tolerance::new(
    1e-10,
    "residuals of 1e-12, times the condition number of the equation",
);

/// Mass of a lattice after a few steps, relative; momentum and differences of it, relative to a
/// twentieth of the mass.
pub const LATTICE_ROUNDING: Tolerance = Tolerance::new(
    4e-15,
    "the errors of a thousand nodes, rounded some hundred times each, mostly cancel",
);

/// Sums over the weights of a kernel, and values interpolated with it.
pub const LATTICE_KERNEL: Tolerance = Tolerance::new(1e-14, "sums of 64 terms, none above 1");

/// Coordinates of grid points as VTK computes them, absolute.
pub const GRID_POINT: Tolerance = Tolerance::new(
    1e-14,
    "VTK multiplies in another order, at coordinates of order one",
);

/// Numbers that follow by a short formula from those of a scene, or from the volume of a mesh.
pub const SCENE_NUMBER: Tolerance = Tolerance::new(
    1e-12,
    "a few roundings, or the sum over a thousand triangles",
);

/// Volumes in flow, relative.
pub const CAPSULE_VOLUME: Tolerance = Tolerance::new(
    1e-12,
    "the volume is corrected after every step; only these states are compared",
);
