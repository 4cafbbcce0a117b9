//! The cost of each effect of a scene: the scene with all effects, and without one at a time.
//!
//! The scene is `capsule-shear.toml`, with a viscosity ratio of 5, a viscous membrane and a penalty on
//! the area besides elasticity and bending.

use helfrich_paper::flow::FlowStudyError;
use helfrich_std::run::{End, Progress, Summary, run};
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_std::simulation::build;
use helfrich_std::study::Cache;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::Path;

/// Costs of the effects of the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectCosts {
    /// Time of one evaluation of the velocities with all effects, seconds.
    pub seconds: f64,
    /// Number of evaluations of the velocities.
    pub evaluations: u64,
    /// Cost of each effect.
    pub effects: Vec<EffectCost>,
}

/// The cost of one effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectCost {
    /// The effect's key in scenes.
    pub effect: String,
    /// Time of the effect in an evaluation of the velocities with all effects, in seconds; `None` for parts
    /// of the fluid's equations.
    pub own: Option<f64>,
    /// Time of an evaluation of the scene without the effect, in seconds.
    pub without: f64,
    /// Number of evaluations for the same strain without the effect.
    pub evaluations_without: u64,
}

/// Effects, with the overrides that add and remove them.
const EFFECTS: [(&str, &str, &str); 5] = [
    (
        "bending",
        "surface.0.bending.method=gompper-kroll",
        "surface.0.bending=",
    ),
    (
        "elasticity",
        "surface.0.elasticity.shear_modulus=1",
        "surface.0.elasticity=",
    ),
    (
        "area",
        "surface.0.area={ modulus = 0.1 }",
        "surface.0.area=",
    ),
    (
        "viscosity_ratio",
        "surface.0.viscosity_ratio=5",
        "surface.0.viscosity_ratio=1",
    ),
    (
        "membrane_viscosity",
        "surface.0.membrane_viscosity={ shear = 0.05 }",
        "surface.0.membrane_viscosity=",
    ),
];

/// γ̇t at the end of each run, which takes some dozens of evaluations.
const STRAIN: f64 = 0.1;

/// Measures the scene; `progress` receives the fraction that is done and the current run. `None` if
/// interrupted.
///
/// # Errors
/// If there is no space for the runs.
pub fn effect_costs(
    vertices: usize,
    mut cache: Option<&mut Cache>,
    interrupted: &dyn Fn() -> bool,
    progress: &mut dyn FnMut(f64, &str),
) -> Result<Option<EffectCosts>, FlowStudyError> {
    let key = format!("effects {vertices}");
    if let Some(known) = cache.as_deref().and_then(|cache| cache.get(&key)) {
        return Ok(Some(known));
    }
    let runs = (EFFECTS.len() + 1) as f64;
    progress(0.0, "all effects");
    let all = measure(vertices, None, interrupted)?;
    let [seconds, evaluations] = per_evaluation(&all);
    let mut effects = Vec::new();
    for (number, (effect, ..)) in EFFECTS.into_iter().enumerate() {
        if interrupted() {
            return Ok(None);
        }
        progress((number + 1) as f64 / runs, &format!("without {effect}"));
        let [without, count] = per_evaluation(&measure(vertices, Some(number), interrupted)?);
        let own = all.effects.iter().find(|cost| cost.effect == effect);
        effects.push(EffectCost {
            effect: effect.to_owned(),
            own: own.map(|cost| cost.seconds / evaluations),
            without,
            evaluations_without: count as u64,
        });
    }
    if interrupted() {
        return Ok(None);
    }
    let costs = EffectCosts {
        seconds,
        evaluations: evaluations as u64,
        effects,
    };
    if let Some(cache) = &mut cache {
        cache.insert(key, &costs);
    }
    Ok(Some(costs))
}

/// Seconds per evaluation of the velocities, and the number of evaluations.
fn per_evaluation(summary: &Summary) -> [f64; 2] {
    let evaluations = summary.right_hand_sides.unwrap_or(summary.iterations) as f64;
    [summary.seconds / evaluations, evaluations]
}

/// Runs the scene with all effects, or without one.
fn measure(
    vertices: usize,
    without: Option<usize>,
    interrupted: &dyn Fn() -> bool,
) -> Result<Summary, FlowStudyError> {
    let problem = |error: &dyn fmt::Display| FlowStudyError::Scene {
        case: match without {
            Some(number) => format!("the scene without {}", EFFECTS[number].0),
            None => "the scene with all effects".to_owned(),
        },
        message: error.to_string(),
    };
    let mut keys = vec![
        format!("driver.strain={STRAIN}"),
        format!("surface.0.vertices={vertices}"),
        "output.pictures=false".to_owned(),
        "output.surfaces=false".to_owned(),
        "output.slice=".to_owned(),
        "output.plot=".to_owned(),
    ];
    let effects = EFFECTS.iter().enumerate();
    keys.extend(effects.map(|(number, &(_, with, lose))| {
        let key = if without == Some(number) { lose } else { with };
        key.to_owned()
    }));
    let overrides = Overrides::new(keys).map_err(|error| problem(&error))?;
    let text = include_str!("../../../std-ext/scene/scenes/capsule-shear.toml");
    let file = SceneFile::parse(text, Path::new("capsule.toml"), &overrides)
        .map_err(|error| problem(&error))?;
    let ready = build(&file).map_err(|error| problem(&error))?;
    let folder = tempfile::tempdir()?;
    let out = folder.path().join("run");
    let mut unheard = |_: &Progress<'_>| {};
    let summary = run(&file.scene, ready, &out, false, interrupted, &mut unheard)?;
    match summary.end {
        End::Completed | End::Interrupted => Ok(summary),
        _ => Err(problem(&summary.message)),
    }
}
