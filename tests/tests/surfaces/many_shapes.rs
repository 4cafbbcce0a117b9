//! Error bars against true errors on many shapes: the figures of docs/NOISE.md.

use crate::adaptive::{QUANTITIES, bars, expected_over_true, of, shape};
use crate::expected_errors::{Case, disc, torus};
use helfrich::AdaptiveJet;
use helfrich_std::generate::Family;

/// Noise in mean edges.
const NOISE: [f64; 5] = [0.0, 1e-4, 1e-3, 1e-2, 3e-2];

/// Figures of a quantity in docs/NOISE.md, with noise and without.
struct Published {
    symbol: &'static str,
    /// Least fraction of the vertices within their bars; and its median over the cases with noise, of which the guide
    /// has three digits.
    within: [f64; 2],
    median_within: f64,
    /// Largest median ratio of bars to true errors; and its median over the cases without noise.
    width: [f64; 2],
    median_width: f64,
}

const PUBLISHED: [Published; QUANTITIES] = [
    Published {
        symbol: "H",
        within: [0.97, 0.98],
        median_within: 0.9895,
        width: [10.0, 52.0],
        median_width: 21.0,
    },
    Published {
        symbol: "K",
        within: [0.95, 0.98],
        median_within: 0.9905,
        width: [10.0, 88.0],
        median_width: 26.0,
    },
    Published {
        symbol: "f",
        within: [0.92, 0.98],
        median_within: 0.9955,
        width: [12.0, 25.0],
        median_width: 14.0,
    },
];

/// Range of the ratio of expected to true mean errors with noise.
const EXPECTED: [f64; 2] = [1.0 / 1.5, 1.5];

/// A case beyond the figures that hold for all others.
struct Exception {
    /// The start of its name.
    name: &'static str,
    noise: &'static [f64],
    symbol: &'static str,
    /// Least fraction of the vertices within their bars, if it is not the published one.
    within: Option<f64>,
    /// Largest median ratio of bars to true errors, and range of the ratio of expected to true mean errors.
    width: f64,
    expected: [f64; 2],
}

/// An exception of f.
const fn of_force(
    name: &'static str,
    noise: &'static [f64],
    width: f64,
    expected: [f64; 2],
) -> Exception {
    Exception {
        name,
        noise,
        symbol: "f",
        within: None,
        width,
        expected,
    }
}

const ANY: &[f64] = &[1e-4, 1e-3, 1e-2, 3e-2];
const LARGE: &[f64] = &[1e-2, 3e-2];

/// Fits over most of a star miss the same waves, and f nearly vanishes on tori of aspect 0.6.
const EXCEPTIONS: [Exception; 13] = [
    Exception {
        name: "torus:1,0.45, relaxed",
        noise: &[1e-4],
        symbol: "H",
        within: None,
        width: 10.0,
        expected: [1.0 / 1.5, 1.8],
    },
    // Its rim, half as wide as that of a red blood cell, is hardly resolved: bars are 15 % too narrow.
    Exception {
        name: "discocyte:1, relaxed",
        noise: &[0.0],
        symbol: "f",
        within: Some(0.94),
        width: 25.0,
        expected: EXPECTED,
    },
    of_force("torus:1,0.6, regular", &[0.0], 28.5, EXPECTED),
    of_force("ellipsoid:1,0.8,0.5, relaxed", &[0.0], 26.5, EXPECTED),
    of_force("torus:1,0.6,", ANY, 12.0, [1.0 / 1.5, 1.75]),
    of_force("torus:1,0.45, regular", &[1e-4], 12.0, [1.0 / 1.5, 1.55]),
    of_force("torus:1,0.45, relaxed", &[1e-4], 12.0, [1.0 / 1.5, 1.55]),
    of_force("star 1,", ANY, 12.0, [1.0 / 1.5, 1.75]),
    of_force("star 2, irregular", LARGE, 12.0, [0.45, 1.5]),
    of_force("star 3, irregular", LARGE, 12.0, [0.45, 1.5]),
    of_force("star 4, irregular", LARGE, 12.0, [0.45, 1.5]),
    of_force("star 6, irregular", LARGE, 12.0, [0.45, 1.5]),
    of_force("star 7, irregular", LARGE, 12.0, [0.45, 1.5]),
];

/// The figures of one case.
struct Found {
    name: String,
    part: f64,
    quantity: usize,
    within: f64,
    width: f64,
    expected: f64,
}

impl Found {
    fn of(case: &Case, part: f64) -> [Self; QUANTITIES] {
        let positions = match part {
            0.0 => case.positions(),
            _ => case.disturbed(part * case.mean_edge()),
        };
        let found = of(&AdaptiveJet::default(), &case.mesh, &positions);
        std::array::from_fn(|quantity| {
            let (ratios, within) = bars(&found, case, quantity);
            Self {
                name: case.name.clone(),
                part,
                quantity,
                within,
                width: ratios[ratios.len() / 2],
                expected: expected_over_true(&found, case, quantity),
            }
        })
    }

    /// A line about what is not as published; `None` if all is.
    fn amiss(&self) -> Option<String> {
        let is_clean = self.part == 0.0;
        let published = &PUBLISHED[self.quantity];
        let symbol = published.symbol;
        let exception = EXCEPTIONS.iter().find(|exception| {
            let is_case = self.name.starts_with(exception.name);
            is_case && exception.noise.contains(&self.part) && exception.symbol == symbol
        });
        let least_within = published.within[usize::from(is_clean)];
        let (within, width, [least, most]) = match exception {
            Some(exception) => (
                exception.within.unwrap_or(least_within),
                exception.width,
                exception.expected,
            ),
            None => (
                least_within,
                published.width[usize::from(is_clean)],
                EXPECTED,
            ),
        };
        let is_expected = is_clean || (least..most).contains(&self.expected);
        let is_within = self.within >= within;
        (!(is_within && self.width <= width && is_expected)).then(|| {
            let (name, part) = (&self.name, self.part);
            let figures = [self.within, self.width, self.expected];
            format!("{name}, {part}, {symbol}: {figures:.3?}\n")
        })
    }
}

/// 13 shapes in three families with five sizes of noise. A bar that is too narrow, too wide, or an expected error that
/// is wrong is either in the list of exceptions, or a failure.
#[test]
#[ignore = "ten minutes: by .ci/long"]
fn bars_of_many_shapes() {
    let shapes = [
        torus(0.4),
        torus(0.6),
        shape("ellipsoid:1,0.7,0.4"),
        disc(),
        torus(0.45),
        shape("ellipsoid:1,0.8,0.5"),
    ];
    let mut all = Vec::new();
    for family in [Family::Irregular, Family::Regular, Family::Relaxed] {
        let stars = (1..=7).map(|seed| Case::of_star(seed, family, 2562));
        let others = shapes.iter();
        let others = others.map(|shape| Case::of_shape(shape, family, 2562));
        for case in stars.chain(others) {
            all.extend(NOISE.into_iter().flat_map(|part| Found::of(&case, part)));
        }
    }
    let mut lines = Vec::from_iter(all.iter().filter_map(Found::amiss));
    for (quantity, published) in PUBLISHED.iter().enumerate() {
        let median = |is_clean: bool, of: fn(&Found) -> f64| {
            let cases = all.iter();
            let cases = cases.filter(|at| at.quantity == quantity && (at.part == 0.0) == is_clean);
            let mut values = Vec::from_iter(cases.map(of));
            values.sort_by(f64::total_cmp);
            values[values.len() / 2]
        };
        let within = median(false, |at| at.within);
        let width = median(true, |at| at.width);
        if within < published.median_within || width > published.median_width {
            lines.push(format!("{}: medians {within}, {width}\n", published.symbol));
        }
    }
    assert!(lines.is_empty(), "{}", lines.concat());
}
