//! Formulas compared with themselves in twice the precision.
//!
//! The same generic code runs once in the number type and once in [`DoubleDouble`], on the same positions.
//! The unit of errors is the sum of the changes by one rounding of the result and by a rounding of each
//! coordinate, relative to the longest edge. A formula that cancels more than its condition number demands
//! has an error of many units.

use super::double_double::DoubleDouble;
use super::{Bound, Group, Outcome, Row};
use glam::DVec3;
use helfrich::{
    Cotangent, DualArea, Energy, Force, GompperKroll, InPlane, Juelicher, KantorNelson,
    LoopSubdivision, MembraneViscosity, NeoHookean, Prepared, Real, Serial, Skalak, SparseMatrix,
    StrainEnergy, StrongForm, Surface, TriangleMesh,
};
use helfrich_std::generate::random::Random;
use helfrich_std::scalar::Scalar;
use num_traits::{Float, ToPrimitive};

/// Extreme triangles, hinges and closed surfaces, with the formulas that are evaluated on them.
struct Case {
    name: &'static str,
    meaning: &'static str,
    /// Positions, followed by further input of the formulas: a reference or velocities.
    input: fn(&mut Random, Scalar) -> Vec<[f64; 3]>,
    triangles: &'static [[u32; 3]],
    formulas: &'static [Formula],
}

/// Formula that is evaluated on a few vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Formula {
    Area,
    Normal,
    Angles,
    Cotangents,
    VoronoiArea,
    MixedArea,
    AreaGradient,
    NeoHookeanEnergy,
    NeoHookeanForce,
    SkalakForce,
    Viscosity,
    HingeEnergy,
    HingeForce,
    SquaredLaplacianEnergy,
    SquaredLaplacianForce,
    LengthTimesAngleForce,
    MeanCurvature,
    GaussianCurvature,
    SubdivisionForce,
    Volume,
    VolumeGradient,
}

impl Formula {
    fn name(self) -> &'static str {
        match self {
            Self::Area => "area",
            Self::Normal => "normal",
            Self::Angles => "angles",
            Self::Cotangents => "cotangents",
            Self::VoronoiArea => "Voronoi area",
            Self::MixedArea => "mixed area",
            Self::AreaGradient => "area gradient",
            Self::NeoHookeanEnergy => "neo-Hookean energy",
            Self::NeoHookeanForce => "neo-Hookean force",
            Self::SkalakForce => "Skalak force",
            Self::Viscosity => "membrane viscosity",
            Self::HingeEnergy => "A: energy",
            Self::HingeForce => "A: force",
            Self::SquaredLaplacianEnergy => "B: energy",
            Self::SquaredLaplacianForce => "B: force",
            Self::LengthTimesAngleForce => "Jülicher: force",
            Self::MeanCurvature => "C: mean curvature",
            Self::GaussianCurvature => "C: Gaussian curvature",
            Self::SubdivisionForce => "S: force",
            Self::Volume => "enclosed volume",
            Self::VolumeGradient => "gradient of the volume",
        }
    }

    /// Largest multiple of the unit that is allowed. In most rows the measured multiple is a tenth, because
    /// the unit is a sum over all coordinates.
    fn most(self) -> f64 {
        match self {
            // These formulas use all three edges of a triangle, whose differences are rounded separately. The
            // edges then no longer sum to zero, an error that grows with the aspect ratio.
            Self::NeoHookeanEnergy
            | Self::NeoHookeanForce
            | Self::SkalakForce
            | Self::Viscosity => 16.0,
            _ => 4.0,
        }
    }
}

const OF_TRIANGLES: &[Formula] = &[
    Formula::Area,
    Formula::Normal,
    Formula::Angles,
    Formula::Cotangents,
    Formula::VoronoiArea,
    Formula::MixedArea,
    Formula::AreaGradient,
];

const OF_STRAINS: &[Formula] = &[
    Formula::NeoHookeanEnergy,
    Formula::NeoHookeanForce,
    Formula::SkalakForce,
    Formula::Viscosity,
];

const OF_HINGES: &[Formula] = &[Formula::HingeEnergy, Formula::HingeForce];

const OF_SURFACES: &[Formula] = &[
    Formula::HingeForce,
    Formula::SquaredLaplacianEnergy,
    Formula::SquaredLaplacianForce,
    Formula::LengthTimesAngleForce,
    Formula::MeanCurvature,
    Formula::GaussianCurvature,
    Formula::SubdivisionForce,
    Formula::Volume,
    Formula::VolumeGradient,
];

const TRIANGLE: &[[u32; 3]] = &[[0, 1, 2]];
const HINGE: &[[u32; 3]] = &[[0, 1, 2], [1, 0, 3]];
const OCTAHEDRON: &[[u32; 3]] = &[
    [0, 1, 4],
    [1, 2, 4],
    [2, 3, 4],
    [3, 0, 4],
    [1, 0, 5],
    [2, 1, 5],
    [3, 2, 5],
    [0, 3, 5],
];

const CASES: &[Case] = &[
    Case {
        name: "needle triangles",
        meaning: "Two angles of 90° and one of 0.01°.",
        input: |random, _| turned(random, &[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.75e-4, 0.0]]),
        triangles: TRIANGLE,
        formulas: OF_TRIANGLES,
    },
    Case {
        name: "cap triangles",
        meaning: "Two angles of 0.01° and one of 179.98°.",
        input: |random, _| turned(random, &[[0.0; 3], [1.0, 0.0, 0.0], [0.5, 0.9e-4, 0.0]]),
        triangles: TRIANGLE,
        formulas: OF_TRIANGLES,
    },
    Case {
        name: "right angles",
        meaning: "Triangles with an angle near 90°, where the mixed area changes its \
                  formula.",
        input: |random, _| turned(random, &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.7, 0.0]]),
        triangles: TRIANGLE,
        formulas: OF_TRIANGLES,
    },
    Case {
        name: "triangles far away",
        meaning: "Needles 1e6 edges from the origin (1e3 in f32), for positions as stored.",
        input: |random, scalar| {
            let far = if scalar == Scalar::F64 { 1e6 } else { 1e3 };
            let mut input = turned(random, &[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.01, 0.0]]);
            input.iter_mut().flatten().for_each(|x| *x += far);
            input
        },
        triangles: TRIANGLE,
        formulas: OF_TRIANGLES,
    },
    Case {
        name: "small strains",
        meaning: "Triangles strained by 1e-6 (1e-3 in f32) from their reference.",
        input: |random, scalar| strained(random, scalar, 0.8),
        triangles: TRIANGLE,
        formulas: OF_STRAINS,
    },
    Case {
        name: "small strains of needles",
        meaning: "The same for needles of 0.6°.",
        input: |random, scalar| strained(random, scalar, 0.01),
        triangles: TRIANGLE,
        formulas: OF_STRAINS,
    },
    Case {
        name: "stretched triangles",
        meaning: "Triangles thirty times as long and half as wide as before.",
        input: |random, _| deformed(random, [30.0, 0.5]),
        triangles: TRIANGLE,
        formulas: OF_STRAINS,
    },
    Case {
        name: "blown-up triangles",
        meaning: "Triangles thirty times as large as before in both directions.",
        input: |random, _| deformed(random, [30.0, 30.0]),
        triangles: TRIANGLE,
        formulas: OF_STRAINS,
    },
    Case {
        name: "moderate strains",
        meaning: "Triangles stretched by a third, where the ratio of areas begins to be used.",
        input: |random, _| deformed(random, [1.4, 1.02]),
        triangles: TRIANGLE,
        formulas: OF_STRAINS,
    },
    Case {
        name: "collapsed triangles",
        meaning: "Triangles compressed to a fifth of their length: I₂ + 1 is small, but rounded like 1.",
        input: |random, _| deformed(random, [0.2, 1.0]),
        triangles: TRIANGLE,
        formulas: OF_STRAINS,
    },
    Case {
        name: "nearly flat hinges",
        meaning: "Two triangles that form an angle of 1e-6 (1e-3 in f32).",
        input: |random, scalar| {
            let lift = if scalar == Scalar::F64 { 1e-6 } else { 1e-3 };
            hinge(random, [0.8, 0.7], lift)
        },
        triangles: HINGE,
        formulas: OF_HINGES,
    },
    Case {
        name: "nearly closed hinges",
        meaning: "Two triangles folded almost onto each other.",
        input: |random, scalar| {
            let lift = if scalar == Scalar::F64 { 1e-6 } else { 1e-3 };
            let shape = [[0.0; 3], [1.0, 0.0, 0.0], [0.4, 0.8, 0.0], [0.6, 0.7, lift]];
            turned(random, &shape)
        },
        triangles: HINGE,
        formulas: OF_HINGES,
    },
    Case {
        name: "hinges of needles",
        meaning: "Heights of 1e-3 of the edge between them.",
        input: |random, _| hinge(random, [1e-3, 0.7], 0.3),
        triangles: HINGE,
        formulas: OF_HINGES,
    },
    Case {
        name: "flat octahedra",
        meaning: "Closed surfaces as thin as 1e-3 of their size.",
        input: |random, _| displaced_octahedron(random, [1.0, 1.0, 1e-3], 0.1),
        triangles: OCTAHEDRON,
        formulas: OF_SURFACES,
    },
    Case {
        name: "long octahedra",
        meaning: "Closed surfaces of needles, a hundred times as long as they are wide.",
        input: |random, _| displaced_octahedron(random, [0.01, 0.01, 1.0], 0.1),
        triangles: OCTAHEDRON,
        formulas: OF_SURFACES,
    },
    Case {
        name: "octahedra far away",
        meaning: "Surfaces 1e6 times their size from the origin (1e3 in f32), for \
                  positions as stored.",
        input: |random, scalar| {
            let far = if scalar == Scalar::F64 { 1e6 } else { 1e3 };
            let mut input = displaced_octahedron(random, [1.0, 0.8, 0.7], 0.1);
            input.iter_mut().flatten().for_each(|x| *x += far);
            input
        },
        triangles: OCTAHEDRON,
        formulas: OF_SURFACES,
    },
];

/// Number of trials of each kind; the worst counts.
const TRIALS: usize = 40;

/// The same of a formula that takes as long as all others together.
const TRIALS_OF_SUBDIVISION: usize = 10;

/// Every formula on every case in f32 and f64.
pub(super) fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for case in CASES {
        for &formula in case.formulas {
            for scalar in [Scalar::F32, Scalar::F64] {
                let worst = match scalar {
                    Scalar::F32 | Scalar::F32Pair => case.worst::<f32>(formula, scalar),
                    Scalar::F64 => case.worst::<f64>(formula, scalar),
                };
                rows.push(Row::new(
                    Group::Cancellation,
                    (case.name, case.meaning),
                    (formula.name(), scalar),
                    Outcome::Measured(worst),
                    Bound::AtMost(formula.most()),
                ));
            }
        }
    }
    rows
}

impl Case {
    /// Largest multiple over all trials; NaN if any is NaN.
    fn worst<T: Real>(&self, formula: Formula, scalar: Scalar) -> f64 {
        let mut random = Random::new(11);
        let mut worst = 0.0_f64;
        let trials = match formula {
            Formula::SubdivisionForce => TRIALS_OF_SUBDIVISION,
            _ => TRIALS,
        };
        for _ in 0..trials {
            let input = (self.input)(&mut random, scalar);
            let held = Vec::from_iter(input.iter().map(|x| x.map(T::constant)));
            let exact = |x: T| DoubleDouble::of(x.to_f64().unwrap_or(f64::NAN));
            let fine = Vec::from_iter(held.iter().map(|x| x.map(exact)));
            let vertices = self.triangles.iter().flatten().max();
            let vertices = vertices.map_or(0, |&vertex| vertex as usize + 1);
            let evaluate = |input: &[[DoubleDouble; 3]]| {
                formula.evaluate(self.triangles, &input[..vertices], &input[vertices..])
            };
            let reference = evaluate(&fine);
            let found = formula.evaluate(self.triangles, &held[..vertices], &held[vertices..]);
            let found = Vec::from_iter(found.into_iter().map(exact));
            let rounding = T::epsilon().to_f64().unwrap_or(f64::NAN);
            let mut unit = rounding * size(&reference);
            // Sum of the changes by one rounding of each coordinate.
            for group in [0..vertices, vertices..fine.len()] {
                let step = DoubleDouble::of(rounding * extent(&fine[group.clone()]));
                for (at, axis) in group.flat_map(|at| [(at, 0), (at, 1), (at, 2)]) {
                    let mut moved = fine.clone();
                    moved[at][axis] += step;
                    unit += difference(&evaluate(&moved), &reference);
                }
            }
            let multiple = difference(&found, &reference) / unit;
            if multiple.is_nan() || multiple > worst {
                worst = multiple;
            }
        }
        worst
    }
}

/// Largest absolute value.
pub(super) fn size(values: &[DoubleDouble]) -> f64 {
    let sizes = values.iter().map(|value| value.abs());
    sizes.fold(0.0, |most, value| {
        most.max(value.to_f64().unwrap_or(f64::NAN))
    })
}

/// Largest absolute difference; NaN if any is not finite.
pub(super) fn difference(a: &[DoubleDouble], b: &[DoubleDouble]) -> f64 {
    let differences = Vec::from_iter(a.iter().zip(b).map(|(&a, &b)| a - b));
    if differences.iter().all(|difference| difference.is_finite()) {
        size(&differences)
    } else {
        f64::NAN
    }
}

/// Largest distance along an axis.
pub(super) fn extent(points: &[[DoubleDouble; 3]]) -> f64 {
    let mut most = 0.0_f64;
    for (a, b) in points
        .iter()
        .flat_map(|a| points.iter().map(move |b| (a, b)))
    {
        most = most.max(difference(a, b));
    }
    most
}

impl Formula {
    /// All numbers of the result. `more` is the reference of a strain, or velocities.
    fn evaluate<T: Real>(
        self,
        triangles: &[[u32; 3]],
        positions: &[[T; 3]],
        more: &[[T; 3]],
    ) -> Vec<T> {
        let Ok(mesh) = TriangleMesh::new(positions.len(), triangles.to_vec()) else {
            return vec![T::nan()];
        };
        let Ok(surface) = Surface::new(&mesh, positions) else {
            return vec![T::nan()];
        };
        let one = T::one();
        let cotangent = |kind| Cotangent::new(kind);
        match self {
            Self::Area => vec![surface.triangle_area(0)],
            Self::Normal => surface.triangle_normal(0).to_vec(),
            Self::Angles => surface.triangle_angles(0).to_vec(),
            Self::Cotangents => {
                let operator = cotangent(DualArea::Mixed);
                let mut stiffness = SparseMatrix::new();
                operator.assemble_stiffness(surface, &mut stiffness);
                let edges = stiffness
                    .triplets()
                    .filter(|(row, column, _)| row != column);
                edges.map(|(_, _, value)| value).collect()
            }
            Self::VoronoiArea | Self::MixedArea => {
                let kind = match self {
                    Self::MixedArea => DualArea::Mixed,
                    _ => DualArea::Voronoi,
                };
                let mut areas = vec![T::zero(); positions.len()];
                cotangent(kind).dual_areas(&Serial, surface, &mut areas);
                areas
            }
            Self::AreaGradient => {
                let tension = helfrich::SurfaceTension::new(one);
                force(&tension, surface)
            }
            Self::NeoHookeanEnergy => {
                let [_, energy] = elastic(NeoHookean { shear_modulus: one }, surface, more);
                energy
            }
            Self::NeoHookeanForce => {
                let [force, _] = elastic(NeoHookean { shear_modulus: one }, surface, more);
                force
            }
            Self::SkalakForce => {
                let law = Skalak {
                    shear_modulus: one,
                    area_ratio: one,
                };
                let [force, _] = elastic(law, surface, more);
                force
            }
            Self::Viscosity => {
                let viscosity = MembraneViscosity {
                    shear: one,
                    dilational: one,
                };
                let mut result = vec![[T::zero(); 3]; positions.len()];
                Prepared::new(viscosity, &mesh).add_dissipative_force(surface, more, &mut result);
                result.into_iter().flatten().collect()
            }
            Self::HingeEnergy => vec![energy(&KantorNelson::new(one), surface)],
            Self::HingeForce => force(&KantorNelson::new(one), surface),
            // Voronoi areas have signs, and their sums cancel.
            Self::SquaredLaplacianEnergy => {
                vec![energy(
                    &GompperKroll::with_areas(one, DualArea::Voronoi),
                    surface,
                )]
            }
            Self::SquaredLaplacianForce => {
                force(&GompperKroll::with_areas(one, DualArea::Voronoi), surface)
            }
            Self::LengthTimesAngleForce => force(&Juelicher::new(one), surface),
            Self::SubdivisionForce => force(&LoopSubdivision::new(one), surface),
            Self::MeanCurvature | Self::GaussianCurvature => {
                let mut prepared = Prepared::new(StrongForm::meyer(one), &mesh);
                prepared.energy(surface);
                let curvature = prepared.memory().curvature().iter();
                let of = |vertex: &helfrich::Curvature<T>| match self {
                    Self::MeanCurvature => vertex.mean,
                    _ => vertex.gaussian,
                };
                curvature.map(of).collect()
            }
            Self::Volume => vec![surface.volume().unwrap_or_else(T::nan)],
            Self::VolumeGradient => force(&helfrich::OsmoticPressure::new(one), surface),
        }
    }
}

fn energy<T: Real>(method: &(impl Energy<T> + Clone), surface: Surface<'_, T>) -> T {
    Prepared::new(method.clone(), surface.mesh()).energy(surface)
}

fn force<T: Real>(method: &(impl Force<T> + Clone), surface: Surface<'_, T>) -> Vec<T> {
    let mut force = vec![[T::zero(); 3]; surface.positions().len()];
    Prepared::new(method.clone(), surface.mesh()).add_force(surface, &mut force);
    force.into_iter().flatten().collect()
}

/// Forces and energy of an in-plane law.
fn elastic<T: Real, W: StrainEnergy<T> + Clone>(
    law: W,
    surface: Surface<'_, T>,
    reference: &[[T; 3]],
) -> [Vec<T>; 2] {
    let mesh = surface.mesh();
    let law = Surface::new(mesh, reference)
        .ok()
        .and_then(|reference| InPlane::new(law, mesh, reference).ok());
    match law {
        Some(law) => [force(&law, surface), vec![energy(&law, surface)]],
        None => [vec![T::nan()], vec![T::nan()]],
    }
}

/// The points in a random rotation, with a common random size and translation.
fn turned(random: &mut Random, points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let right = random.on_sphere();
    let up = right.cross(random.on_sphere()).normalize();
    let normal = right.cross(up);
    let (size, centre) = (0.5 + random.unit(), random.on_sphere());
    let turned = |&[x, y, z]: &[f64; 3]| size * (x * right + y * up + z * normal) + centre;
    points
        .iter()
        .map(|point| turned(point).to_array())
        .collect()
}

/// An edge of length 1 with a triangle of one of these heights on either side; the second triangle is rotated
/// by an angle.
fn hinge(random: &mut Random, heights: [f64; 2], angle: f64) -> Vec<[f64; 3]> {
    let [left, right] = heights;
    let (sine, cosine) = libm::sincos(angle);
    let points = [
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [0.4, left, 0.0],
        [0.6, -right * cosine, -right * sine],
    ];
    turned(random, &points)
}

/// A triangle with this height, followed by a slightly strained copy, which serves as reference and as
/// velocities.
fn strained(random: &mut Random, scalar: Scalar, height: f64) -> Vec<[f64; 3]> {
    let strain = if scalar == Scalar::F64 { 1e-6 } else { 1e-3 };
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.3, height, 0.0]];
    let there = points.map(|[x, y, z]| [x + strain * (x + 0.5 * y), y - 0.7 * strain * y, z]);
    turned(random, &[points, there].concat())
}

/// A triangle that is stretched by these factors along two axes, followed by its unstretched shape, which
/// serves as reference and as velocities.
fn deformed(random: &mut Random, [along, across]: [f64; 2]) -> Vec<[f64; 3]> {
    let reference = [[0.0; 3], [1.0, 0.0, 0.0], [0.3, 0.8, 0.0]];
    let points = reference.map(|[x, y, z]| [along * x, across * y, z]);
    turned(random, &[points, reference].concat())
}

/// An octahedron with these semi-axes; each vertex is displaced at random by this fraction of them.
fn displaced_octahedron(random: &mut Random, axes: [f64; 3], jitter: f64) -> Vec<[f64; 3]> {
    let corners = [
        DVec3::X,
        DVec3::Y,
        -DVec3::X,
        -DVec3::Y,
        DVec3::Z,
        -DVec3::Z,
    ];
    let displaced = corners.map(|corner| {
        let corner = corner + jitter * random.on_sphere();
        (corner * DVec3::from(axes)).to_array()
    });
    turned(random, &displaced)
}
