//! Cases of runs, and their bounds.

use super::scenes::{CAPSULE, CHANNEL, DEFLATED, ON_LATTICE, PRESSED, RELAXED};
use crate::stability::Bound;
use helfrich_std::method::BendingMethod;

/// A scene and its variations.
pub(super) struct Case {
    pub(super) name: &'static str,
    pub(super) meaning: &'static str,
    pub(super) scene: &'static str,
    pub(super) trials: Trials,
}

/// The runs of a case.
pub(super) enum Trials {
    /// A list of runs.
    These(&'static [Trial]),
    /// One run with each bending method that has a bound.
    EveryMethod {
        /// Overrides of keys.
        changes: &'static [&'static str],
        /// Further overrides, which make the run with which the deformation is compared.
        against: &'static [&'static str],
        bound: fn(BendingMethod) -> Option<Bound>,
    },
}

impl Trials {
    pub(super) fn count(&self) -> usize {
        match self {
            Self::These(trials) => trials.len(),
            Self::EveryMethod { bound, .. } => {
                let all = BendingMethod::ALL.into_iter();
                all.filter_map(*bound).count()
            }
        }
    }
}

/// One run.
pub(super) struct Trial {
    pub(super) subject: &'static str,
    /// Overrides of keys.
    pub(super) changes: &'static [&'static str],
    pub(super) bound: Bound,
}

impl Trial {
    const fn new(subject: &'static str, changes: &'static [&'static str], bound: Bound) -> Self {
        Self {
            subject,
            changes,
            bound,
        }
    }
}

/// Relative change of a preserved volume: rounding of a sum over the triangles, and the tolerance of its
/// correction.
const KEPT: f64 = 1e-11;

/// The run ends with its volume preserved.
const RUNS: Bound = Bound::Runs { volume: KEPT };

/// The run ends with its volume preserved, without warnings.
const SILENT: Bound = Bound::RunsInSilence { volume: KEPT };

/// On bad meshes, D is within a tenth of that on an even mesh, the accuracy of 162 vertices.
const NEAR: Bound = Bound::RunsNear { most: 0.1 };

/// Bound for methods with modes at the scale of an edge that may grow on such meshes: as [`NEAR`], or the run
/// says that a mode grows.
const NEAR_OR_UNSTABLE: Bound = Bound::RunsNearOrSays {
    most: 0.1,
    why: "grows instead of decaying",
};

/// Bound for methods whose stiffest mode may decay so fast that steps become tiny: as [`NEAR`], or the run
/// says so.
const NEAR_OR_STIFF: Bound = Bound::RunsNearOrSays {
    most: 0.1,
    why: "steps have come down to",
};

/// The even mesh with which other meshes are compared.
const EVEN: &[&str] = &["surface.0.family=regular"];

/// On random points, most methods are as accurate as on an even mesh. Hamann's method is left out: its
/// paraboloids without a slope are so stiff there that 4000 evaluations do not reach γ̇t = 0.25.
fn on_random_points(method: BendingMethod) -> Option<Bound> {
    match method {
        BendingMethod::Farutin => Some(NEAR_OR_UNSTABLE),
        BendingMethod::Loop => Some(NEAR_OR_STIFF),
        BendingMethod::Hamann => None,
        _ => Some(NEAR),
    }
}

/// Bounds on needles and caps.
fn on_slivers(method: BendingMethod) -> Option<Bound> {
    match method {
        BendingMethod::Farutin | BendingMethod::Loop => Some(NEAR_OR_UNSTABLE),
        _ => Some(NEAR),
    }
}

pub(super) const CASES: &[Case] = &[
    Case {
        name: "low Ca without bending",
        meaning: "A neo-Hookean membrane without bending wrinkles at the scale of its mesh.",
        scene: CAPSULE,
        trials: Trials::These(&[
            Trial::new(
                "642 vertices",
                &[
                    "surface.0.bending=",
                    "surface.0.vertices=642",
                    "driver.flow.rate=0.05",
                    "driver.strain=2.25",
                ],
                Bound::Says("wrinkled at the scale of its mesh"),
            ),
            Trial::new(
                "said beforehand",
                &[
                    "surface.0.bending=",
                    "surface.0.vertices=42",
                    "driver.strain=0.25",
                ],
                Bound::Says("add [surface.bending]"),
            ),
        ]),
    },
    Case {
        name: "high Ca",
        meaning: "Ca = 3.",
        scene: CAPSULE,
        trials: Trials::These(&[
            Trial::new(
                "Skalak",
                &[
                    "surface.0.elasticity={ law = \"skalak\", shear_modulus = 1, area_ratio = 1 }",
                    "surface.0.bending.modulus=0.01",
                    "driver.flow.rate=3",
                    "driver.strain=5",
                ],
                RUNS,
            ),
            Trial::new(
                "neo-Hookean",
                &[
                    "surface.0.bending.modulus=0.01",
                    "driver.flow.rate=3",
                    "driver.strain=4",
                ],
                RUNS,
            ),
        ]),
    },
    Case {
        name: "bending from 1e-4 to 1",
        meaning: "Values of κ/(a²G).",
        scene: CAPSULE,
        trials: Trials::These(&[
            Trial::new("1e-4", &["surface.0.bending.modulus=1e-4"], SILENT),
            Trial::new("1e-3", &["surface.0.bending.modulus=1e-3"], SILENT),
            Trial::new("1e-2", &["surface.0.bending.modulus=1e-2"], SILENT),
            Trial::new("1e-1", &["surface.0.bending.modulus=1e-1"], SILENT),
            Trial::new("1", &["surface.0.bending.modulus=1"], SILENT),
        ]),
    },
    Case {
        name: "viscosity ratio from 0.05 to 50",
        meaning: "D at γ̇t = 1.",
        scene: CAPSULE,
        trials: Trials::These(&[
            Trial::new(
                "0.05",
                &["surface.0.viscosity_ratio=0.05", "surface.0.vertices=42"],
                SILENT,
            ),
            Trial::new(
                "0.2",
                &["surface.0.viscosity_ratio=0.2", "surface.0.vertices=42"],
                SILENT,
            ),
            Trial::new(
                "5",
                &["surface.0.viscosity_ratio=5", "surface.0.vertices=42"],
                SILENT,
            ),
            Trial::new(
                "50",
                &["surface.0.viscosity_ratio=50", "surface.0.vertices=42"],
                SILENT,
            ),
        ]),
    },
    Case {
        name: "100 γ̇t of tank-treading",
        meaning: "Some seven rotations: constant volume, and D within 3 %.",
        scene: CAPSULE,
        trials: Trials::These(&[
            Trial::new(
                "volume",
                &[
                    "surface.0.vertices=42",
                    "driver.strain=100",
                    "output.strain_interval=2",
                ],
                SILENT,
            ),
            Trial::new(
                "steadiness",
                &[
                    "surface.0.vertices=42",
                    "driver.strain=100",
                    "output.strain_interval=2",
                ],
                Bound::Steady { most: 0.03 },
            ),
        ]),
    },
    Case {
        name: "volume without correction",
        meaning: "An error of steps and quadrature, of second order in the edge length.",
        scene: CAPSULE,
        trials: Trials::These(&[
            Trial::new(
                "162 vertices, γ̇t = 4",
                &["driver.volume_correction=false", "driver.strain=4"],
                Bound::Runs { volume: 4e-3 },
            ),
            Trial::new(
                "642 vertices, γ̇t = 1",
                &["driver.volume_correction=false", "surface.0.vertices=642"],
                Bound::Runs { volume: 5e-4 },
            ),
        ]),
    },
    Case {
        name: "methods on an irregular mesh in flow",
        meaning: "Valences from 3 to 9 and angles from 10°. D at γ̇t = 0.5 is within 10 % of that on an even mesh; E and S may report a mode that grows or is too stiff.",
        scene: CAPSULE,
        trials: Trials::EveryMethod {
            changes: &["surface.0.family=irregular", "driver.strain=0.5"],
            against: EVEN,
            bound: on_random_points,
        },
    },
    Case {
        name: "methods on slivers in flow",
        meaning: "Angles from 0.8° to 176°. D at γ̇t = 0.25 is within 10 % of that on an even mesh; E and S may report a mode that grows.",
        scene: CAPSULE,
        trials: Trials::EveryMethod {
            changes: &["surface.0.family=hard", "driver.strain=0.25"],
            against: EVEN,
            bound: on_slivers,
        },
    },
    Case {
        name: "a mode that grows, and one that is too stiff",
        meaning: "The run stops and names the vertex.",
        scene: CAPSULE,
        trials: Trials::These(&[
            Trial::new(
                "farutin, slivers",
                // The changes of a run above, which is not repeated.
                &[
                    "surface.0.family=hard",
                    "driver.strain=0.25",
                    "surface.0.bending.method=farutin",
                ],
                Bound::Stops("grows instead of decaying"),
            ),
            Trial::new(
                "loop, irregular",
                &[
                    "surface.0.family=irregular",
                    "driver.strain=0.5",
                    "surface.0.bending.method=loop",
                ],
                Bound::Stops("steps have come down to"),
            ),
        ]),
    },
    Case {
        name: "capsules pressed together",
        meaning: "Repulsion, or the fluid between them, keeps them apart.",
        scene: PRESSED,
        trials: Trials::These(&[
            Trial::new("with repulsion", &[], RUNS),
            Trial::new("without", &["interaction="], RUNS),
        ]),
    },
    Case {
        name: "vesicle of reduced volume 0.6",
        meaning: "Long and thin.",
        scene: DEFLATED,
        trials: Trials::These(&[Trial::new("in shear", &[], RUNS)]),
    },
    Case {
        name: "vesicle of reduced volume 0.6 at rest",
        meaning: "Area and volume are constrained; a disc becomes biconcave.",
        scene: RELAXED,
        trials: Trials::These(&[Trial::new(
            "relaxed",
            &[],
            // The initial volume is not yet the constrained one.
            Bound::Runs { volume: 0.2 },
        )]),
    },
    Case {
        name: "on a lattice",
        meaning: "Both number types, and forces that are too stiff for the step.",
        scene: ON_LATTICE,
        trials: Trials::These(&[
            Trial::new("f64", &[], RUNS),
            Trial::new("f32", &["driver.precision=f32"], RUNS),
            Trial::new(
                "step too long",
                &["surface.0.bending.modulus=1", "driver.step=0.05"],
                Bound::Stops("too stiff for the step"),
            ),
        ]),
    },
    Case {
        name: "contradictory demands",
        meaning: "The message names both.",
        scene: CAPSULE,
        trials: Trials::These(&[
            Trial::new(
                "duration and strain",
                &["driver.duration=3"],
                Bound::RefusedForBoth("`duration`", "`strain`"),
            ),
            Trial::new(
                "step and tolerance",
                &["driver.integrator=rkc2", "driver.step=0.1"],
                Bound::RefusedForBoth("`step`", "`tolerance`"),
            ),
        ]),
    },
    Case {
        name: "contradictory demands on a vesicle",
        meaning: "More volume than the constrained area can enclose.",
        scene: RELAXED,
        trials: Trials::These(&[Trial::new(
            "area and volume",
            &[
                "surface.0.area={ constraint = \"exact\", target = 10 }",
                "surface.0.volume={ constraint = \"exact\", target = 4 }",
            ],
            Bound::RefusedForBoth("area 10", "reduced volume of these targets is 1.3452"),
        )]),
    },
    Case {
        name: "contradictory demands on a lattice",
        meaning: "Two keys for the same resolution; a capsule inside an obstacle.",
        scene: CHANNEL,
        trials: Trials::These(&[
            Trial::new(
                "spacing and resolution",
                &["driver.spacing=0.2"],
                Bound::RefusedForBoth("`spacing`", "`resolution`"),
            ),
            Trial::new(
                "capsule and obstacle",
                &[],
                Bound::RefusedForBoth("\"capsule\" starts inside", "\"ball\""),
            ),
        ]),
    },
];
