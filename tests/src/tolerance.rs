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
/// Results of an operator on a surface against its results on the surface moved, relative to the
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
/// Sum and torque of forces that have none, relative to the largest force.
pub const NO_NET_FORCE: Tolerance =
    Tolerance::new(1e-11, "rounding of some hundred forces on a body of size 1");
/// Results of a method in two ways that agree except for rounding, relative.
pub const SAME: Tolerance = Tolerance::new(
    1e-11,
    "some operations in another order, on numbers that do not cancel",
);
/// Energies and curvatures that stall, against the value at which they are known to, relative.
pub const STALL: Tolerance = Tolerance::new(
    5e-3,
    "the known value has three digits, and meshes of the same kind differ in the next",
);
/// Forces against derivatives by dual numbers, relative to the largest force.
pub const GRADIENT_DUAL: Tolerance = Tolerance::new(
    1e-12,
    "dual numbers differentiate the same formula: only rounding is left",
);
/// Forces against fourth-order central differences, relative to the largest force.
pub const GRADIENT_DIFFERENCE: Tolerance = Tolerance::new(
    1e-6,
    "a step of 1e-4 edges leaves 1e-9 of truncation and 1e-16/1e-4 of rounding, times the roughness",
);
/// Net force and torque of exact gradients, relative to Σ|F| and Σ|F||x|.
pub const BALANCE: Tolerance = Tolerance::new(1e-14, "a sum of terms that cancel, each rounded");
/// Net torque of methods of which it is not within [`BALANCE`], by their names in the law suite.
pub const TORQUE: &[(&str, Tolerance)] = &[(
    "Hamann",
    Tolerance::new(
        1e-10,
        "the torque of a fit vanishes as far as its normal equations are solved: to ε times their \
         condition, at most 1e6 where a fit is accepted",
    ),
)];
/// Rotation, relabelling and scaling, relative to the largest force times the mesh's roughness.
pub const INVARIANCE: Tolerance = Tolerance::new(
    1e-11,
    "the moved positions are rounded, and bending forces divide that by an edge length up to four times",
);
/// Rotation and relabelling of methods that fit, on meshes of a few vertices, too.
pub const FIT_INVARIANCE: Tolerance = Tolerance::new(
    1e-8,
    "the worst fits that are taken have a condition of 1/√ε = 7e7, by which they multiply the rounding of \
     1e-16 of positions",
);
/// The same in f32.
pub const INVARIANCE_SINGLE: Tolerance = Tolerance::new(5e-3, "as in f64, from a rounding of 6e-8");
/// Gauss–Bonnet, relative to the sum of all absolute angles.
pub const GAUSS_BONNET: Tolerance = Tolerance::new(1e-12, "a sum of rounded angles");
/// Σ of dual areas against the total area, relative to the sum of absolute parts.
pub const AREA_SUM: Tolerance = Tolerance::new(1e-13, "a sum of rounded parts");
/// Two orders of summation of an operator's row, relative to Σ|c| times the field.
pub const OPERATOR_ROUNDING: Tolerance =
    Tolerance::new(1e-14, "a dozen terms, each rounded a few times");
/// H R on inscribed meshes, relative to ε R² Σ|cot|/|A|.
pub const SPHERE_EXACT: Tolerance = Tolerance::new(
    4.0,
    "positions lie on the sphere to ε R, and each cotangent multiplies such an error of a difference",
);
/// Δ_S of polynomials on flat patches, relative to Σ|c| times the field.
pub const FLAT_EXACT: Tolerance = Tolerance::new(1e-14, "exact but for rounding");
/// Stiffness, mass, gradient and divergence in two ways, relative to ε times the sum of the absolute
/// terms, each with the condition `l²/2A` of its triangle.
pub const FINITE_ELEMENTS: Tolerance = Tolerance::new(
    32.0,
    "edges, normal and area of a triangle round a few times each, and a vertex has a dozen triangles",
);
/// l (l + 1) by Rayleigh quotients of spherical harmonics on a sphere of 2562 vertices, relative.
pub const RAYLEIGH_QUOTIENT: Tolerance = Tolerance::new(
    2e-2,
    "second order: edges of 0.07 in waves of length 2π/l, squared, and l = 3 at most",
);
/// Areas, volumes and angles of known polyhedra, relative.
pub const POLYHEDRON: Tolerance = Tolerance::new(1e-15, "a few roundings of f64");
/// Δ_S x against −2 n on the icosphere of 2562 vertices, largest error.
pub const EIGENFUNCTION_MAX: Tolerance = Tolerance::new(
    1e-2,
    "first order: along n the operator is exact, tangentially it is not",
);
/// Δ_S of the second zonal harmonic on the same mesh, mean error.
pub const EIGENFUNCTION_MEAN: Tolerance = Tolerance::new(
    2e-2,
    "nearly second order in the mean; at the twelve vertices of valence 5 there is no convergence",
);
/// Net force and torque of the strong form on a smooth mesh of 642 vertices, relative to Σ|F|.
pub const STRONG_BALANCE: Tolerance = Tolerance::new(
    4e-3,
    "forces are pointwise values times areas, no gradient: they balance as the mesh is refined, those \
     of the heat kernel of a quarter of an area least of all",
);

/// Expected results of a method on the icosphere of 2562 vertices.
#[derive(Clone, Copy, Debug)]
pub struct OnSphere {
    /// The method's name in the law suite.
    pub method: &'static str,
    /// Limit of the energy, in 8πκ.
    pub energy: f64,
    /// How far from it the energy is, in 8πκ.
    pub energy_error: Tolerance,
    /// Largest |f| R³/κ, which is 0 on the sphere.
    pub density: Tolerance,
}

/// Methods on the sphere of which more is known than of every method. Densities above 1 are needed, and a
/// test says so.
pub const ON_SPHERE: &[OnSphere] = &[
    OnSphere {
        method: "Kantor–Nelson",
        energy: 1.0 / 3.0,
        energy_error: HINGED_SPHERE_ENERGY,
        density: HINGED_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Kantor–Nelson, opposite Gaussian modulus",
        energy: 0.5,
        energy_error: HINGED_SPHERE_ENERGY,
        density: HINGED_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Kantor–Nelson, sphere energy",
        energy: 1.0,
        energy_error: HINGED_SPHERE_ENERGY,
        density: HINGED_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Kantor–Nelson, formula of a hinge",
        energy: 1.0 / 3.0,
        energy_error: HINGED_SPHERE_ENERGY,
        density: HINGED_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Gompper–Kroll, Voronoi areas",
        energy: 1.0,
        energy_error: SPHERE_ENERGY,
        density: GRADIENT_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Gompper–Kroll",
        energy: 1.0,
        energy_error: SPHERE_ENERGY,
        density: GRADIENT_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Gompper–Kroll, barycentric areas",
        energy: 1.0,
        energy_error: SPHERE_ENERGY,
        density: BARYCENTRIC_SPHERE_DENSITY,
    },
    OnSphere {
        method: "sum of two",
        energy: 4.0 / 3.0,
        energy_error: HINGED_SPHERE_ENERGY,
        density: HINGED_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Meyer et al.",
        energy: 1.0,
        energy_error: SPHERE_ENERGY,
        density: STRONG_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Meyer, Voronoi areas",
        energy: 1.0,
        energy_error: SPHERE_ENERGY,
        density: STRONG_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Meyer, barycentric areas",
        energy: 1.0,
        energy_error: SPHERE_ENERGY,
        density: BARYCENTRIC_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Jülicher",
        energy: 1.0,
        energy_error: EDGE_SPHERE_ENERGY,
        density: EDGE_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Hamann",
        energy: 1.0,
        energy_error: AVERAGED_SPHERE_ENERGY,
        density: AVERAGED_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Belkin et al.",
        energy: 1.0,
        energy_error: KERNEL_SPHERE_ENERGY,
        density: NARROW_KERNEL_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Belkin, published bandwidth",
        energy: 1.0,
        energy_error: KERNEL_SPHERE_ENERGY,
        density: KERNEL_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Farutin et al.",
        energy: 1.0,
        energy_error: KERNEL_SPHERE_ENERGY,
        density: PARABOLOID_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Farutin, guarded",
        energy: 1.0,
        energy_error: KERNEL_SPHERE_ENERGY,
        density: PARABOLOID_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Loop, nodes",
        energy: 1.0,
        energy_error: LOOP_SPHERE_ENERGY,
        density: LOOP_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Loop, interpolated",
        energy: 1.0,
        energy_error: LOOP_SPHERE_ENERGY,
        density: LOOP_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Loop, sharpened",
        energy: 1.0,
        energy_error: LOOP_SPHERE_ENERGY,
        density: LOOP_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Loop",
        energy: 1.0,
        energy_error: LOOP_SPHERE_ENERGY,
        density: LOOP_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Jets, degree 4",
        energy: 1.0,
        energy_error: SPHERE_ENERGY,
        density: JET4_SPHERE_DENSITY,
    },
    OnSphere {
        method: "Jets, degree 6",
        energy: 1.0,
        energy_error: SPHERE_ENERGY,
        density: JET6_SPHERE_DENSITY,
    },
];

impl OnSphere {
    /// The row of a method, or what holds for every method that is consistent, by whether its force is
    /// the gradient of an energy.
    pub fn of(method: &'static str, is_gradient: bool) -> Self {
        let own = ON_SPHERE.iter().find(|row| row.method == method);
        own.copied().unwrap_or(Self {
            method,
            energy: 1.0,
            energy_error: CONSISTENT_ENERGY,
            density: if is_gradient {
                ANY_GRADIENT_DENSITY
            } else {
                CONSISTENT_DENSITY
            },
        })
    }
}

const CONSISTENT_ENERGY: Tolerance = Tolerance::new(
    0.14,
    "a consistent H is off by no more than the edge length of 0.07, and E has H²",
);
const ANY_GRADIENT_DENSITY: Tolerance = Tolerance::new(
    2.5e3,
    "the gradient of a consistent energy need not converge: it may be off by 2κ/R for each triangle at \
     a vertex, over an area of R²/204",
);
const CONSISTENT_DENSITY: Tolerance = Tolerance::new(
    1.0,
    "f of a strong form is a value at a vertex: above κ/R³ it does not converge, which needs a reason",
);
const LOOP_SPHERE_ENERGY: Tolerance = Tolerance::new(
    2.5e-3,
    "an icosphere by midpoints has kinks along the icosahedron's edges: first order",
);
const LOOP_SPHERE_DENSITY: Tolerance = Tolerance::new(
    90.0,
    "force errors of about κ/(3R) at vertices of valence 5, at any refinement: diverges as 1/area",
);
const EDGE_SPHERE_ENERGY: Tolerance = Tolerance::new(
    6e-3,
    "second order, but for a few vertices where H is 14.6 % wrong at any refinement",
);
const EDGE_SPHERE_DENSITY: Tolerance = Tolerance::new(
    300.0,
    "H is 14.6 % wrong at vertices of valence 5: diverges there as 1/area",
);
const AVERAGED_SPHERE_ENERGY: Tolerance = Tolerance::new(
    1.5e-2,
    "first order: over uneven rings the averaged normal is off by a part of h/R = 0.07, and E has H²",
);
const AVERAGED_SPHERE_DENSITY: Tolerance = Tolerance::new(
    1.2e3,
    "the gradient of normals and barycentric areas does not converge: diverges as 1/area",
);
const KERNEL_SPHERE_ENERGY: Tolerance = Tolerance::new(
    4e-3,
    "H is second order, as the kernel and the paraboloid see the fourth derivative of the shape",
);
const KERNEL_SPHERE_DENSITY: Tolerance = Tolerance::new(
    2.0,
    "H jumps by 4e-3 at vertices of valence 5, and over h = A that grows with refinement",
);
const NARROW_KERNEL_SPHERE_DENSITY: Tolerance = Tolerance::new(
    8.0,
    "the same at h = A/2: H jumps by more where the kernel averages over fewer neighbours, twice that \
     over h",
);
const PARABOLOID_SPHERE_DENSITY: Tolerance = Tolerance::new(
    0.4,
    "H jumps with the angles of the one-ring by an error of second order: no convergence",
);
const SPHERE_ENERGY: Tolerance = Tolerance::new(1.5e-3, "second order in the edge length");
const HINGED_SPHERE_ENERGY: Tolerance = Tolerance::new(
    0.04,
    "the limit holds for equilateral triangles; an icosphere's are not, however fine",
);
const JET4_SPHERE_DENSITY: Tolerance = Tolerance::new(
    0.01,
    "Δ_S H of a fit of degree 4 is of first order, on a mesh this regular of second",
);
const JET6_SPHERE_DENSITY: Tolerance = Tolerance::new(
    3e-4,
    "Δ_S H of a fit of degree 6 is of third order or better",
);
const HINGED_SPHERE_DENSITY: Tolerance = Tolerance::new(
    2.5e3,
    "diverges as 1/area at vertices of valence 5 and along the icosahedron's edges, for k̃ = 2√3 κ",
);
const GRADIENT_SPHERE_DENSITY: Tolerance = Tolerance::new(
    0.3,
    "the energy's gradient is 1.3e-3 κ/R at the worst vertex, divided by its area: no convergence",
);
const BARYCENTRIC_SPHERE_DENSITY: Tolerance = Tolerance::new(
    260.0,
    "barycentric areas are not those of the Laplacian: diverges as 1/area at vertices of valence 5",
);
const STRONG_SPHERE_DENSITY: Tolerance = Tolerance::new(
    0.015,
    "H is exact but for the normal, H² − K is second order, and so is the error of f here",
);

/// Single against double precision on a smooth mesh of 642 vertices, positions stored in f32.
#[derive(Clone, Copy, Debug)]
pub struct SinglePrecision {
    /// The start of the method's name in the law suite.
    pub method: &'static str,
    /// Energy, relative.
    pub energy: Tolerance,
    /// Force, relative to the largest.
    pub force: Tolerance,
}

/// Methods of which f32 says more or less than of every method.
pub const SINGLE_PRECISION: &[SinglePrecision] = &[
    SinglePrecision {
        method: "Kantor–Nelson",
        energy: SINGLE_ENERGY,
        force: SINGLE_HINGED,
    },
    SinglePrecision {
        method: "Jülicher",
        energy: SINGLE_ENERGY,
        force: SINGLE_HINGED,
    },
    SinglePrecision {
        method: "Belkin",
        energy: SINGLE_KERNEL_ENERGY,
        force: SINGLE_KERNEL,
    },
];

impl SinglePrecision {
    /// The row of a method, or what holds for every method.
    pub fn of(method: &'static str) -> Self {
        let own = SINGLE_PRECISION
            .iter()
            .find(|row| method.starts_with(row.method));
        own.copied().unwrap_or(Self {
            method,
            energy: SINGLE_ENERGY,
            force: SINGLE_LAPLACIAN,
        })
    }
}

const SINGLE_ENERGY: Tolerance = Tolerance::new(
    3e-7,
    "a few roundings of 6e-8: those of single vertices average out",
);
const SINGLE_KERNEL_ENERGY: Tolerance = Tolerance::new(
    1e-4,
    "the kernel ends at 8 √h instead of 12: paths around a body of this size then leave out some \
     vertices where it is 1e-6",
);
const SINGLE_KERNEL: Tolerance = Tolerance::new(
    2e-2,
    "the same, uneven from vertex to vertex, over the bandwidth once more",
);
const SINGLE_HINGED: Tolerance = Tolerance::new(
    4e-5,
    "a stored position is off by 6e-8, a hinge's angle by that over an edge, and so twice more",
);
const SINGLE_LAPLACIAN: Tolerance = Tolerance::new(
    4e-4,
    "f is a fourth derivative: 6e-8 over the fourth power of an edge of 0.1, averaged",
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
pub const LOOP_GRADIENT_DIFFERENCE: Tolerance = Tolerance::new(
    1e-7,
    "fourth-order differences with a step of 2e-4 leave 1e-8 of truncation and 1e-10 of rounding",
);
/// Net force and torque of a conservative method, relative to the sum of all forces' lengths.
pub const LOOP_NET_FORCE: Tolerance = Tolerance::new(
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
    "the term of fourth order over an edge, (hκ)⁴/4!, is 1.2e-3 on average over the energy (h = 0.126 R, κ \
     the larger curvature); edges differ by a tenth",
);
/// The same with four times the vertices.
pub const LOOP_DISCOCYTE_2562: Tolerance =
    Tolerance::new(1.5e-3 / 16.0, "fourth order: edges of a half");
/// The same with sixteen times the vertices.
pub const LOOP_DISCOCYTE_10242: Tolerance =
    Tolerance::new(1.5e-3 / 256.0, "fourth order: edges of a quarter");
/// Energy of method S in f32 against f64, relative.
pub const LOOP_SINGLE: Tolerance = Tolerance::new(
    1e-6,
    "positions rounded at 6e-8 are differentiated twice, over edges of a twentieth",
);
/// Energies and forces of homogeneous strains, relative to modulus times area, forces over the
/// strain.
pub const HOMOGENEOUS: Tolerance = Tolerance::new(
    1e-13,
    "a linear triangle is exact: only some roundings are left",
);
/// Energies of small strains against their quadratic limit, relative, over the strain.
pub const SMALL_STRAIN: Tolerance = Tolerance::new(
    8.0,
    "terms of third order: the strain times a number that grows with the stretch's exponents",
);
/// The energy of a strain of 1e-8 in positions without structure, relative.
pub const TINY_STRAIN: Tolerance = Tolerance::new(
    1e-6,
    "positions are rounded at 1e-16 over an edge of a third, and the strain is 1e-8",
);
/// In-plane energies and forces in f32 against f64, relative to the largest.
pub const SINGLE_STRAIN: Tolerance = Tolerance::new(
    2e-5,
    "positions rounded at 6e-8 over edges of a tenth, and strains of a tenth",
);
/// Energies on a sphere of 2562 vertices against the smooth ones, relative.
pub const COARSE_SPHERE: Tolerance = Tolerance::new(
    2e-2,
    "M and A are second order, 1.5e-3 here, and five times that where M0 is 0.8 M; squared",
);
/// |F/F0 − 1| after a correction.
pub const CONSTRAINED: Tolerance = Tolerance::new(
    1e-14,
    "some roundings of a value and of the positions it is taken from",
);
/// The same 1e8 radii from the origin.
pub const CONSTRAINED_FAR: Tolerance =
    Tolerance::new(1e-7, "positions are rounded at 1e-8 of the radius there");
/// The same in f32.
pub const CONSTRAINED_SINGLE: Tolerance =
    Tolerance::new(5e-6, "as in f64, from a rounding of 6e-8");
/// Directions of a small step against those to first order.
pub const FIRST_ORDER: Tolerance = Tolerance::new(
    1e-5,
    "the step is 1e-6 of the size; cosines are second order",
);
/// Rates along directions that should keep a value, by central differences.
pub const TANGENT: Tolerance = Tolerance::new(
    1e-7,
    "a step of 1e-6 leaves 1e-12 of truncation and 1e-15/1e-6 of rounding, times a value of 20",
);
/// Repulsion in f32 against f64, relative.
pub const REPULSION_SINGLE: Tolerance = Tolerance::new(
    1e-5,
    "positions of size 3 rounded at 6e-8 over a range of 0.5, in the third power",
);
/// Rise of the energy in an accepted step of a relaxation, relative.
pub const ENERGY_RISE: Tolerance = Tolerance::new(
    1e-13,
    "thousands of terms of one size, summed in pairs, round at some 1e-16",
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
/// The estimate of the energy by jets of degree 6 on curved triangles, of 2562 vertices.
pub const VESICLE_ESTIMATE: Tolerance = Tolerance::new(
    1e-3,
    "fourth order, and of second order in the distance of the shape from the equilibrium; theory has \
     five digits",
);
/// The energy of the method itself, of 642 vertices.
pub const COARSE_VESICLE_ENERGY: Tolerance = Tolerance::new(
    2e-2,
    "four times that of 2562 vertices, less what methods share",
);
/// Area, volume and energy over G R² of an elastic sphere that relaxed, relative.
pub const REGAINED: Tolerance = Tolerance::new(
    1e-6,
    "the residual of 1e-5 bounds the strain, to which the energy is quadratic",
);
/// Places and lengths in pictures, relative to a length of about a hundred pixels.
pub const PICTURE_RADIUS: Tolerance = Tolerance::new(
    1e-2,
    "pixels that an outline merely touches are counted as seen, which is half a pixel in a hundred",
);
/// Observed orders of convergence in time.
pub const TIME_ORDER: Tolerance = Tolerance::new(
    0.1,
    "the next term of the error is a fiftieth of the first at steps of 1/40",
);
/// A stabilised step of a linear problem against its closed polynomial, relative to the start.
pub const STABILITY_POLYNOMIAL: Tolerance = Tolerance::new(
    1e-10,
    "rounding grows with the square of the number of stages, 1e4 at most",
);
/// Error of a step in units of the one allowed.
pub const STEP_ERROR: Tolerance = Tolerance::new(
    3.0,
    "estimates are right to leading order, and the longest steps turn vectors by a third of a radian",
);
/// Rates of growing modes, relative.
pub const GROWTH_RATE: Tolerance = Tolerance::new(
    1e-2,
    "power iteration ends when the estimate changes by 1e-3",
);
/// Integrals over a triangle about its corner against graded subdivision, relative.
pub const PANEL: Tolerance = Tolerance::new(
    1e-10,
    "forty halvings leave 1e-12; Gauss rules of 96 points on triangles of aspect up to ten the rest",
);
/// Velocities of moved and turned surfaces, relative to the largest.
pub const FLOW_MOTION: Tolerance = Tolerance::new(
    1e-11,
    "places rounded at 1e-15 of the distance between vertices some hundred times nearer",
);
/// Velocities from the same forces in other units, relative to the largest.
pub const FLOW_ROUNDING: Tolerance =
    Tolerance::new(1e-13, "thousands of terms summed in one order");
/// Velocities on a sphere of 2562 vertices against exact ones, relative.
pub const FLOW_SPHERE: Tolerance = Tolerance::new(
    2e-3,
    "second order: the polyhedron's area and volume are 1.3e-3 short",
);
/// Velocity next to a surface by halved triangles against the same on triangles of a 16th of the
/// edge, relative.
pub const FLOW_NEAR: Tolerance = Tolerance::new(
    5e-4,
    "middles of edges on a triangle at twice its edge are good to 1e-3 of what it gives",
);
/// Velocity near a single triangle against Gauss rules of 96 points, relative.
pub const FLOW_SEVEN_POINTS: Tolerance = Tolerance::new(
    1e-6,
    "corners are 0.29 distances from the centre at most, 6e-4 in the sixth power, times the rule's \
     constant; most parts are farther off, and signs differ",
);
/// Moments, axes, angles and turns of polyhedra, relative to a natural scale.
pub const DEFORMATION: Tolerance = Tolerance::new(
    1e-12,
    "sums of a thousand terms of either sign, some thirty lengths from the origin",
);
/// A semi-axis extrapolated from two refinements, relative.
pub const DEFORMATION_EXTRAPOLATED: Tolerance =
    Tolerance::new(2e-5, "fourth order: 5e-3 of 642 vertices squared");
/// D of an irregular mesh of 642 vertices.
pub const DEFORMATION_RANDOM_MESH: Tolerance = Tolerance::new(
    5e-3,
    "the polyhedron's volume is 1 % short, more where it is curved more; D has the difference",
);
/// D by extreme points of a mesh of 2562 vertices.
pub const DEFORMATION_EXTREMES: Tolerance = Tolerance::new(
    2e-3,
    "chords are short of the curve by an eighth of the squared edge, 7e-4",
);
/// The nearest of 400 points on every line of a section, relative.
pub const DEFORMATION_SAMPLED: Tolerance = Tolerance::new(
    1e-4,
    "half a part of a line of a third of a radius is 4e-4, squared",
);
/// Areas of sections of a sphere of 642 vertices, relative.
pub const SECTION_AREA: Tolerance = Tolerance::new(
    2e-2,
    "chords of a polyhedron whose surface is up to 4e-3 inside; twice that at a height of 0.7",
);
/// The wrinkle indicator of a sphere of 642 vertices.
pub const WRINKLE_INDICATOR: Tolerance =
    Tolerance::new(1e-2, "second order in edges of 0.15 radii");
/// Turns of a tank-treading ellipsoid of 162 vertices.
pub const TANK_TREADING: Tolerance = Tolerance::new(
    1e-2,
    "some thirty vertices are not evenly spread in phase; whole turns are interpolated over 0.09",
);
/// First plateaus of known curves, relative to the plateau.
pub const PLATEAU: Tolerance = Tolerance::new(
    2e-3,
    "the slope over five points of a coarse curve is up to a quarter too steep or too gentle",
);
/// When a slope is least, relative.
pub const PLATEAU_TIME: Tolerance =
    Tolerance::new(5e-2, "one sample in twenty, where the slope is least");
/// Velocities and pressures of the double layer, and pressures of the single one, near a triangle,
/// relative.
pub const FLOW_SEVEN_STRESSLETS: Tolerance = Tolerance::new(
    1e-5,
    "as for the single layer, with two more powers of the distance under the integral",
);
/// Velocities in, on and around a strained sphere of 2562 vertices of any viscosity, of 1.
pub const FLOW_STRAINED: Tolerance = Tolerance::new(
    5e-3,
    "second order: the polyhedron's area and volume are 1.3e-3 short, and forces are 2λ + 3 times them",
);
/// Pressures around it, within an edge of it too, of 5.
pub const FLOW_PRESSURE: Tolerance = Tolerance::new(
    2e-2,
    "flat triangles bend at edges, near which the pressure has the logarithm of the distance",
);
/// Pressures next to a coarse surface by halved triangles against the same on triangles of a 16th of
/// the edge, relative to a pressure two edges off.
pub const FLOW_NEAR_PRESSURE: Tolerance = Tolerance::new(
    1e-3,
    "middles of edges on a triangle at four times its edge, for the third power of 1/r",
);
/// Solutions of the equation of both layers in another order, relative.
pub const FLOW_SOLVED: Tolerance = Tolerance::new(
    1e-10,
    "residuals of 1e-12, and the condition of the equation",
);
/// Velocities on a pancake by facing triangles in parts against triangles of a quarter of the edge,
/// relative.
pub const FLOW_FACING: Tolerance = Tolerance::new(
    5e-3,
    "seven points on the neighbours of the triangles around a vertex, middles of edges beyond",
);
/// Steady flows on a lattice between plates, for which its walls are exact, relative to the fastest.
pub const LATTICE_STEADY: Tolerance = Tolerance::new(
    1e-12,
    "rounding over thousands of steps; what is left of the start is e⁻⁴⁰ and less",
);
/// Mass of a lattice after a few steps, relative; momentum and differences of it, relative to a
/// twentieth of the mass.
pub const LATTICE_ROUNDING: Tolerance = Tolerance::new(
    4e-15,
    "the errors of a thousand nodes, rounded some hundred times each, mostly cancel",
);
/// Velocities of a decayed vortex with 48 nodes to its wavelength, relative to the first.
pub const LATTICE_VORTEX: Tolerance = Tolerance::new(
    2e-3,
    "second order in k = 2π/48, k² = 0.017, and in the Mach number, Ma² = 5e-4",
);
/// The same in a stream four times as fast.
pub const LATTICE_STREAM: Tolerance = Tolerance::new(
    4e-3,
    "the viscosity is short of 3 · 0.05² = 0.75 %, which after a half-life is 0.26 % of the speed, \
     and the rest as without a stream",
);
/// Force on an obstacle in steady flow against that some time before, relative.
pub const LATTICE_DRAG_BALANCE: Tolerance = Tolerance::new(
    1e-4,
    "e⁻¹³ is left of the longest wave by then; boxes with obstacles have somewhat slower ones",
);
/// Drag of a sphere of six nodes' radius, relative.
pub const LATTICE_DRAG: Tolerance = Tolerance::new(
    2e-2,
    "its surface is made of steps: the radius is uncertain by a tenth of the distance of nodes",
);
/// f32 against f64 after forty steps, relative to the deviations.
pub const LATTICE_SINGLE: Tolerance = Tolerance::new(
    1e-6,
    "f32 rounds at 6e-8 of the deviations, some twenty times a step, with random signs",
);
/// Sums over the weights of a kernel, and what is interpolated with it.
pub const LATTICE_KERNEL: Tolerance = Tolerance::new(1e-14, "sums of 64 terms, none above 1");
/// Velocities that an f32 collision keeps, against the sum of its populations in f64.
pub const LATTICE_KEPT_SINGLE: Tolerance = Tolerance::new(
    1e-6,
    "sums of nineteen populations and a force, each rounded at 6e-8 of the largest",
);
/// Work of forces on points and on nodes, relative to what one of them does.
pub const LATTICE_WORK: Tolerance = Tolerance::new(
    1e-12,
    "forces on nodes are read off differences of velocities, of a hundredth of these",
);
/// Mobilities in two boxes, relative to their difference.
pub const LATTICE_IMAGES: Tolerance = Tolerance::new(
    1e-2,
    "second order: on the lattice, k² is off by some of its square, which is (2π/14)² for the first",
);
/// Where VTK says a grid's point is, absolute.
pub const GRID_POINT: Tolerance = Tolerance::new(
    1e-14,
    "VTK multiplies in another order, at places of order one",
);
/// The volume of smooth meshes of 10000 vertices.
pub const FINE_MESH_VOLUME: Tolerance = Tolerance::new(
    3e-3,
    "second order in edges of 0.04 of the size, and of 0.12 of a torus's tube",
);
/// The spectral radius by the edge of the mean triangle, for that by the mean edge of an icosphere.
pub const MEAN_EDGE: Tolerance = Tolerance::new(
    4e-2,
    "edges differ by up to 16 %: their mean square exceeds the square of their mean by a hundredth, \
     and the cube of the edge is wanted",
);
/// Numbers that follow from a scene's by a short formula, or by that of a mesh of its volume.
pub const SCENE_NUMBER: Tolerance = Tolerance::new(
    1e-12,
    "a few roundings, or the sum over a thousand triangles",
);
/// D of the paper's capsule against its digitised curve: absolute, or 2 % where that is more.
pub const CAPSULE_TRANSIENT: Tolerance = Tolerance::new(
    3e-3,
    "the curve was digitised to 0.002, and 1280 triangles are off by 0.002 with method B",
);
/// D in steady states against the independent computation on the same mesh, absolute.
pub const CAPSULE_REFERENCE: Tolerance = Tolerance::new(5e-4, "the prototype's own uncertainty");
/// Inclination against the independent computation, relative.
pub const CAPSULE_INCLINATION: Tolerance = Tolerance::new(1e-2, "it is given to 0.1 degrees");
/// D with Loop subdivision on 320 triangles against the paper's, absolute.
pub const CAPSULE_SUBDIVISION: Tolerance =
    Tolerance::new(5e-4, "what elasticity and flow leave on so few triangles");
/// D at a capillary number of 0.005 against small-deformation theory, relative.
pub const CAPSULE_SLOPE: Tolerance = Tolerance::new(
    1e-2,
    "1280 triangles, and the next order of the capillary number, of half a percent each",
);
/// D of a drop at a capillary number of 0.02 against linear theory, relative.
pub const DROP_TAYLOR: Tolerance = Tolerance::new(
    2e-2,
    "1280 triangles; a fourth of it is left on four times as many",
);
/// The same on 320 triangles.
pub const CAPSULE_VISCOUS: Tolerance =
    Tolerance::new(4e-2, "four times the error of method B on 1280 triangles");
/// Volumes in flow, relative.
pub const CAPSULE_VOLUME: Tolerance = Tolerance::new(
    1e-12,
    "they are corrected after every step; between, they are not looked at",
);
/// Symmetry of two capsules, in units of their radius.
pub const CAPSULE_PAIR: Tolerance = Tolerance::new(
    1e-3,
    "their meshes are not each other's image, and errors differ by the mesh's own",
);
/// Growth of 1/D with the viscosity of the membrane, relative.
pub const CAPSULE_MEMBRANE: Tolerance = Tolerance::new(
    5e-2,
    "elasticity has a few percent of what the most deformed has to overcome",
);
/// Speed of a falling capsule, relative.
pub const CAPSULE_FALL: Tolerance = Tolerance::new(
    1e-2,
    "the drag of 1280 triangles is off by 0.4 %; the membrane gives way by a hundredth",
);
/// Velocities in the middle of ducts, relative.
pub const DUCT: Tolerance = Tolerance::new(
    5e-4,
    "differences over a thirtieth of the half width; a book's four digits",
);
/// Loss of viscosity and speed of waves along streams, relative to 3u².
pub const LATTICE_GALILEAN: Tolerance = Tolerance::new(5e-2, "k² = (2π/32)² = 0.04 of it");
/// Velocities in a duct of 32 nodes' width, relative to the one in its middle.
pub const LATTICE_DUCT: Tolerance = Tolerance::new(1e-3, "second order: 1/32²");
/// Loss of a sphere's mobility by periodic sides, from three boxes.
pub const LATTICE_BOX: Tolerance = Tolerance::new(
    2e-2,
    "the next term, of sixth order, is 27 (4/24)⁶ = 6e-4 of the mobility",
);
/// Drag of a sphere of points, by its radius, relative.
pub const LATTICE_SMEARED: Tolerance = Tolerance::new(
    1.5e-2,
    "kernels are no Gaussians: a tenth of what they add to the radius, which is 0.5 of 4 for the \
     widest",
);
/// D of a capsule on a lattice of four nodes a radius against boundary integrals, relative.
pub const IMMERSED_COARSE: Tolerance = Tolerance::new(
    0.12,
    "a kernel of two points makes the membrane thicker by a share of a node, wider ones by more; \
     the published excess at this resolution with much bending is 15 %, box included",
);
/// D of the same run in f32 and f64, relative.
pub const IMMERSED_SINGLE: Tolerance = Tolerance::new(
    1e-3,
    "populations deviate from rest by 1e-3 and are rounded at 6e-8 of it a step, for a thousand steps",
);
/// Strain of viscous membranes that are as good as rigid, by their viscosity, relative.
pub const LATTICE_STIFF: Tolerance = Tolerance::new(
    0.05,
    "flows of higher order than strain, of which a box of four radii has many, give way by a little more",
);
/// Momentum of a sign that changes from step to step, with a membrane in the fluid, relative.
pub const LATTICE_STAGGERED: Tolerance = Tolerance::new(
    1e-2,
    "the first step has none before it, so that vertices are off by half of its displacement: a membrane      of a tenth of μ spacing/step pulls them by a tenth of that, on a part of the nodes, to and fro",
);
/// Growth of the deformation of a viscous membrane on a lattice of five nodes a radius, relative.
pub const IMMERSED_VISCOUS: Tolerance = Tolerance::new(
    0.04,
    "a box of seven radii adds 1.5 (a/L)³/D, about 3 % of it in elastic capsules, and vertices that \
     are spread over nodes make it larger by some percent",
);
/// D of bodies in each other on a lattice in another order of the surfaces, relative.
pub const NESTED_ORDER: Tolerance = Tolerance::new(
    1e-10,
    "forces on nodes are summed in another order, for a few hundred steps",
);
/// Velocities in a channel of 32 nodes, relative to the one in the middle.
pub const IMMERSED_PROBE: Tolerance = Tolerance::new(
    1e-2,
    "a grain a tenth as wide as the channel, and linear interpolation of a parabola",
);
/// Flow in ducts by a series of 200 terms, relative.
pub const CHANNEL_SERIES: Tolerance = Tolerance::new(5e-4, "the published number has four digits");
/// Extrapolations of numbers that obey their law, relative.
pub const SERIES_EXTRAPOLATION: Tolerance = Tolerance::new(
    1e-10,
    "differences of numbers that differ in the third digit",
);
/// Forces of one method in two orders of the vertices, over the largest of them.
pub const REORDERED: Tolerance = Tolerance::new(
    1e-12,
    "rounding of positions in a fourth derivative: 1e-16 over the fourth power of an edge of a tenth",
);
