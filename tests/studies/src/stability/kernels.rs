//! Kernels of Stokes flow and integrals over triangles, compared with the same formulas in twice the
//! precision.
//!
//! The library has these formulas only for f64 and vectors of f64, so they are repeated here.

use super::cancellation::{difference, extent, size};
use super::double_double::DoubleDouble;
use super::{Bound, Group, Outcome, Row};
use helfrich_std::flow::alone;
use helfrich_std::generate::random::Random;
use helfrich_std::scalar::Scalar;
use num_traits::Float;
use std::array;
use std::ops::Range;

type Vector = [DoubleDouble; 3];

/// Number of random trials for each row.
const TRIALS: usize = 20;

/// Allowed error: a few times the change by one rounding of each coordinate.
const MOST: f64 = 4.0;

/// Allowed error at a corner opposite a short edge: moments along that edge are differences between its ends,
/// and lose digits by the ratio of its distance to its length.
const MOST_OF_A_TIP: f64 = 1.0 / 1.75e-4;

/// A formula, with the points and vectors that it takes.
struct Formula {
    name: &'static str,
    /// Number of vectors that are positions; the others are forces, normals and velocities.
    positions: usize,
    found: fn(&[[f64; 3]]) -> Vec<f64>,
    exact: fn(&[Vector]) -> Vec<DoubleDouble>,
}

/// Formulas of a point source at a point.
const KERNELS: [Formula; 4] = [
    Formula {
        name: "Stokeslet",
        positions: 2,
        found: |v| alone::stokeslet(v[0], [v[1], v[2]]).to_vec(),
        exact: |v| stokeslet(sub(v[1], v[0]), v[2]).to_vec(),
    },
    Formula {
        name: "pressure of a force",
        positions: 2,
        found: |v| alone::gradient(v[0], [v[1], v[2]]).to_vec(),
        exact: |v| {
            let r = sub(v[1], v[0]);
            vec![dot(r, v[2]) / dot(r, r).powi(3).sqrt()]
        },
    },
    Formula {
        name: "stresslet",
        positions: 2,
        found: |v| alone::stresslet(v[0], [v[1], v[2], v[3]]).to_vec(),
        exact: |v| {
            let r = sub(v[1], v[0]);
            let squared = dot(r, r);
            let factor = dot(r, v[2]) * dot(r, v[3]) / (squared * squared * squared.sqrt());
            r.map(|r| r * factor).to_vec()
        },
    },
    Formula {
        name: "pressure of a stresslet",
        positions: 2,
        found: |v| alone::stresslet_pressure(v[0], [v[1], v[2], v[3]]).to_vec(),
        exact: |v| {
            let r = sub(v[1], v[0]);
            let squared = dot(r, r);
            let three = DoubleDouble::of(3.0);
            let first = three * dot(r, v[2]) * dot(r, v[3]) / squared;
            vec![(first - dot(v[2], v[3])) / (squared * squared.sqrt())]
        },
    },
];

/// Formula of a triangle and a point.
const SOLID_ANGLE: Formula = Formula {
    name: "solid angle",
    positions: 4,
    found: |v| vec![alone::solid_angle(v[0], [v[1], v[2], v[3]])],
    exact: |v| {
        let [a, b, c] = [1, 2, 3].map(|corner| sub(v[corner], v[0]));
        let [x, y, z] = [a, b, c].map(|corner| dot(corner, corner).sqrt());
        let below = x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y;
        vec![DoubleDouble::of(2.0) * dot(a, cross(b, c)).atan2(below)]
    },
};

/// Integral over a triangle with tractions, at its first corner.
const CORNER: Formula = Formula {
    name: "Stokeslets about a corner",
    positions: 3,
    found: |v| alone::stokeslets_about_corner([v[0], v[1], v[2]], [v[3], v[4], v[5]]).to_vec(),
    exact: |v| corner([v[0], v[1], v[2]], [v[3], v[4], v[5]]).to_vec(),
};

/// Points in an extreme configuration.
struct Case {
    name: &'static str,
    meaning: &'static str,
    /// Positions before rotation and translation.
    positions: &'static [[f64; 3]],
    formulas: &'static [Formula],
    /// Distance from the origin, in units of the size.
    away: f64,
    most: f64,
}

const CASES: &[Case] = &[
    Case {
        name: "point sources",
        meaning: "A force or a stresslet, and a point near it.",
        positions: &[[0.0; 3], [0.6, 0.5, 0.3]],
        formulas: &KERNELS,
        away: 1.0,
        most: MOST,
    },
    Case {
        name: "point sources far away",
        meaning: "The same, 1e6 distances from the origin, for positions as stored.",
        positions: &[[0.0; 3], [0.6, 0.5, 0.3]],
        formulas: &KERNELS,
        away: 1e6,
        most: MOST,
    },
    Case {
        name: "point sources almost on the point",
        meaning: "Points whose distance is 1e-9 of their distance from the origin.",
        positions: &[[0.0; 3], [6e-10, 5e-10, 3e-10]],
        formulas: &KERNELS,
        away: 1.0,
        most: MOST,
    },
    Case {
        name: "seen from afar",
        meaning: "A triangle 1e3 edges away.",
        positions: &[[0.0, 0.0, 1e3], [0.0; 3], [1.0, 0.0, 0.0], [0.2, 0.9, 0.0]],
        formulas: &[SOLID_ANGLE],
        away: 1.0,
        most: MOST,
    },
    Case {
        name: "seen from close by",
        meaning: "A triangle 1e-8 edges away, almost a half space.",
        positions: &[[0.4, 0.3, 1e-8], [0.0; 3], [1.0, 0.0, 0.0], [0.2, 0.9, 0.0]],
        formulas: &[SOLID_ANGLE],
        away: 1.0,
        most: MOST,
    },
    Case {
        name: "seen from its plane",
        meaning: "A triangle from a point beside it, 1e-8 edges above its plane.",
        positions: &[[1.4, 0.8, 1e-8], [0.0; 3], [1.0, 0.0, 0.0], [0.2, 0.9, 0.0]],
        formulas: &[SOLID_ANGLE],
        away: 1.0,
        most: MOST,
    },
    Case {
        name: "a needle seen from its side",
        meaning: "An angle of 0.01°.",
        positions: &[
            [0.5, 0.3, 0.4],
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [1.0, 1.75e-4, 0.0],
        ],
        formulas: &[SOLID_ANGLE],
        away: 1.0,
        most: MOST,
    },
    Case {
        name: "about a corner",
        meaning: "Integral of linear tractions over a triangle around one of its corners.",
        positions: &[[0.0; 3], [1.0, 0.0, 0.0], [0.2, 0.9, 0.0]],
        formulas: &[CORNER],
        away: 1.0,
        most: MOST,
    },
    Case {
        name: "about the tip of a needle",
        meaning: "The same at an angle of 0.01°.",
        positions: &[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.75e-4, 0.0]],
        formulas: &[CORNER],
        away: 1.0,
        most: MOST_OF_A_TIP,
    },
    Case {
        name: "about the end of a needle",
        meaning: "The same at an angle of 90° opposite to a long edge.",
        positions: &[[1.0, 0.0, 0.0], [1.0, 1.75e-4, 0.0], [0.0; 3]],
        formulas: &[CORNER],
        away: 1.0,
        most: MOST,
    },
    Case {
        name: "about the top of a cap",
        meaning: "The same at an angle of 179.98°.",
        positions: &[[0.5, 0.9e-4, 0.0], [0.0; 3], [1.0, 0.0, 0.0]],
        formulas: &[CORNER],
        away: 1.0,
        most: MOST,
    },
];

pub(super) fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for case in CASES {
        for formula in case.formulas {
            rows.push(Row::new(
                Group::Cancellation,
                (case.name, case.meaning),
                (formula.name, Scalar::F64),
                Outcome::Measured(case.worst(formula)),
                Bound::AtMost(case.most),
            ));
        }
    }
    rows
}

impl Case {
    /// Largest multiple over all trials; NaN if any is NaN.
    fn worst(&self, formula: &Formula) -> f64 {
        let mut random = Random::new(11);
        let mut worst = 0.0_f64;
        for _ in 0..TRIALS {
            let right = random.on_sphere();
            let up = right.cross(random.on_sphere()).normalize();
            let centre = self.away * random.on_sphere();
            let place = |&[x, y, z]: &[f64; 3]| {
                (x * right + y * up + z * right.cross(up) + centre).to_array()
            };
            let mut input = Vec::from_iter(self.positions.iter().map(place));
            // As many vectors as any formula takes.
            input.extend((0..3).map(|_| random.on_sphere().to_array()));
            let multiple = multiple(formula, &input);
            if multiple.is_nan() || multiple > worst {
                worst = multiple;
            }
        }
        worst
    }
}

/// Error in units of rounding: the sum of the changes by one rounding of the result and by a rounding of each
/// coordinate, relative to distances for positions and to lengths for vectors.
fn multiple(formula: &Formula, input: &[[f64; 3]]) -> f64 {
    let fine = Vec::from_iter(input.iter().map(|x| x.map(DoubleDouble::of)));
    let reference = (formula.exact)(&fine);
    let found = (formula.found)(input).into_iter().map(DoubleDouble::of);
    let found = Vec::from_iter(found);
    let mut unit = f64::EPSILON * size(&reference);
    let mut add = |group: Range<usize>, length: f64| {
        let step = DoubleDouble::of(f64::EPSILON * length);
        for (at, axis) in group.flat_map(|at| [(at, 0), (at, 1), (at, 2)]) {
            let mut moved = fine.clone();
            moved[at][axis] += step;
            unit += difference(&(formula.exact)(&moved), &reference);
        }
    };
    add(0..formula.positions, extent(&fine[..formula.positions]));
    add(formula.positions..fine.len(), 1.0);
    difference(&found, &reference) / unit
}

fn dot(a: Vector, b: Vector) -> DoubleDouble {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn sub(a: Vector, b: Vector) -> Vector {
    array::from_fn(|axis| a[axis] - b[axis])
}

fn add(a: Vector, b: Vector) -> Vector {
    array::from_fn(|axis| a[axis] + b[axis])
}

fn scale(factor: DoubleDouble, a: Vector) -> Vector {
    a.map(|a| factor * a)
}

fn cross([a, b, c]: Vector, [x, y, z]: Vector) -> Vector {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

/// `f/r + r (r·f)/r³`.
fn stokeslet(r: Vector, f: Vector) -> Vector {
    let squared = dot(r, r);
    let along = dot(r, f) / squared;
    scale(squared.sqrt().recip(), add(f, scale(along, r)))
}

/// `A ∫₀¹ (I/|v| + v v/|v|³)·[q₀ + (1 − s) q₁ + s q₂] ds` with v from v₁ to v₂, by the moments of 1/r and
/// 1/r³ along the edge, measured from the foot of the perpendicular through the corner, with the logarithm in
/// its textbook form.
fn corner([x, a, b]: [Vector; 3], [own, first, second]: [Vector; 3]) -> Vector {
    let (v1, v2) = (sub(a, x), sub(b, x));
    let edge = sub(v2, v1);
    let length = dot(edge, edge).sqrt();
    let along = scale(length.recip(), edge);
    let (t1, t2) = (dot(v1, along), dot(v2, along));
    let (r1, r2) = (dot(v1, v1).sqrt(), dot(v2, v2).sqrt());
    let normal = cross(v1, v2);
    let doubled = dot(normal, normal).sqrt();
    let height = doubled / length;
    // Perpendicular to the edge in the plane, without the cancellation of v₁ − t₁ t.
    let up = scale((doubled * length).recip(), cross(edge, normal));
    let up = if dot(up, v1) < DoubleDouble::of(0.0) {
        scale(DoubleDouble::of(-1.0), up)
    } else {
        up
    };
    // ∫ dt/r = asinh(t₂/h) − asinh(t₁/h); for negative t, from the form without cancellation.
    let logarithm = |t: DoubleDouble, r: DoubleDouble| {
        if t < DoubleDouble::of(0.0) {
            -((r - t) / height).ln()
        } else {
            ((r + t) / height).ln()
        }
    };
    let over_r = logarithm(t2, r2) - logarithm(t1, r1);
    let squared = height * height;
    let ratio = t2 / r2 - t1 / r1;
    // ∫ tⁿ/r³ dt.
    let cubes = [
        ratio / squared,
        r1.recip() - r2.recip(),
        over_r - ratio,
        r2 - r1 + squared * (r2.recip() - r1.recip()),
    ];
    let slope = scale(length.recip(), sub(second, first));
    let base = sub(add(own, first), scale(t1, slope));
    let foot = scale(height, up);
    let constant = dot(foot, base);
    let linear = dot(along, base) + dot(foot, slope);
    let square = dot(along, slope);
    let upward = constant * cubes[0] + linear * cubes[1] + square * cubes[2];
    let forward = constant * cubes[1] + linear * cubes[2] + square * cubes[3];
    let isotropic = add(scale(over_r, base), scale(r2 - r1, slope));
    let sum = add(isotropic, add(scale(upward, foot), scale(forward, along)));
    scale(DoubleDouble::of(0.5) * height, sum)
}
