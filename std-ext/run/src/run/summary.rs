//! The end of a run, and its summary file.

use super::remedy::remedy;
use super::{Average, EnergyEstimate, Flagged, Remeshing};
use crate::dynamics::Mode;
use crate::scene::{Relax, Scene};
use crate::simulation::{EffectCost, messages_once};
use serde::{Deserialize, Serialize};

/// The way in which a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// Every load reached its equilibrium.
    Converged,
    /// Forces vanish, but the energy is not known well enough, or so much of it lies on flagged vertices
    /// that this is no equilibrium of the surface.
    Unresolved,
    /// The run reached the end of its duration.
    Completed,
    /// The last load did not reach its equilibrium: the limit of iterations was reached.
    IterationLimit,
    /// The last load did not reach its equilibrium: the relaxation stagnates.
    Stagnated,
    /// The run failed; the last good state is kept.
    Failed,
    /// The run was interrupted, and can be resumed.
    Interrupted,
}

impl End {
    /// Name in tables and in `summary.json`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::Unresolved => "unresolved",
            Self::Completed => "completed",
            Self::IterationLimit => "iteration-limit",
            Self::Stagnated => "stagnated",
            Self::Failed => "failed",
            Self::Interrupted => "interrupted",
        }
    }

    /// Whether a relaxation cannot get closer to its equilibrium.
    pub(super) fn is_reached(self) -> bool {
        matches!(
            self,
            Self::Converged | Self::Stagnated | Self::IterationLimit
        )
    }
}

/// Contents of `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// The scene's title.
    pub title: String,
    /// The way in which it ended.
    pub end: End,
    /// The same in words.
    pub message: String,
    /// Total number of iterations, or of steps in time.
    pub iterations: u64,
    /// Total number of evaluations of the velocities, including those for the spectral radius; only for
    /// drivers in time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub right_hand_sides: Option<u64>,
    /// Total time in seconds, including resumed runs.
    pub seconds: f64,
    /// The names and numbers of the last row; a number that is not finite is null.
    pub last: Vec<(String, f64)>,
    /// Cost of each effect, and of the flow.
    pub effects: Vec<EffectCost>,
    /// Cost of everything else: the rest of the driver's work, `quality`, `files` and `pictures`. With
    /// the effects, these are all seconds of the run.
    pub parts: Vec<EffectCost>,
    /// Findings of the bending methods at the end, surface by surface.
    pub flagged: Vec<Flagged>,
    /// The estimated errors of the energies of closed surfaces at the end of a relaxation.
    pub energy_estimates: Vec<EnergyEstimate>,
    /// New meshes of surfaces, in their order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub remeshings: Vec<Remeshing>,
    /// The normal modes of least stiffness at the end of a relaxation, if the driver asks for them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub modes: Vec<Mode>,
    /// Means over the time of the run, if the scene measures a suspension.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rheology: Vec<Average>,
    /// Remarks on the results.
    pub warnings: Vec<String>,
    /// The version of the program.
    pub version: &'static str,
    /// Digest of everything that a continuation must have in common with the run, in hexadecimal
    /// digits.
    pub fingerprint: String,
    /// The scene as run.
    pub scene: Scene,
}

/// The end of a relaxation and its message. If an energy lies on flagged vertices, or is not known with
/// the required accuracy, the result is not an equilibrium.
pub(super) fn judge(
    (end, message): (End, String),
    scene: &Scene,
    relax: Relax,
    flagged: &[Flagged],
    estimates: &[EnergyEstimate],
) -> (End, String) {
    let mut doubts = Vec::new();
    let mut remedies: Vec<String> = Vec::new();
    for surface in &scene.surfaces {
        let flagged = flagged.iter().filter(|it| it.surface == surface.name);
        let flagged = flagged.filter(|flagged| flagged.rules());
        let own = estimates.iter().filter(|it| it.surface == surface.name);
        let off = own.filter(|estimate| !estimate.is_within(relax.energy_error));
        let before = doubts.len();
        doubts.extend(flagged.map(Flagged::message));
        doubts.extend(off.map(|estimate| estimate.message(relax.energy_error)));
        let remedy = remedy(surface);
        if doubts.len() > before && !remedies.contains(&remedy) {
            remedies.push(remedy);
        }
    }
    if doubts.is_empty() {
        return (end, message);
    }
    let names = scene.surfaces.iter().map(|surface| surface.name.as_str());
    let doubts = messages_once(doubts, &Vec::from_iter(names)).join("; ");
    let remedies = remedies.join("; ");
    match end {
        End::Converged => {
            // What is said about the way to the equilibrium remains.
            let way = message.strip_prefix("converged").unwrap_or_default();
            let message = format!(
                "the forces vanish{way}, but the energy is not to be trusted: {doubts}: {remedies}"
            );
            (End::Unresolved, message)
        }
        // The same remedies help against stagnation.
        End::Stagnated if message.contains(&remedies) => (end, format!("{message}; {doubts}")),
        End::Stagnated | End::IterationLimit => (end, format!("{message}; {doubts}: {remedies}")),
        _ => (end, message),
    }
}
