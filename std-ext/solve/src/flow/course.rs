//! The course of a flow in time.

use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// The factor by which the velocities of an undisturbed flow change in time; from −1 to 1, so that the flow
/// itself is the fastest that there is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum Course {
    /// 1.
    #[default]
    Steady,
    /// `cos(2π t/T)`.
    Oscillation {
        /// T, a time above 0.
        period: f64,
    },
    /// Straight lines between given factors, and the first and the last of these before and after all times.
    Table {
        /// Times in ascending order, at least one.
        times: Vec<f64>,
        /// One factor for each time.
        factors: Vec<f64>,
    },
}

/// Number of steps that a period has to have.
const STEPS: f64 = 16.0;

impl Course {
    /// Whether the factor is 1 at all times.
    pub fn is_steady(&self) -> bool {
        *self == Self::Steady
    }

    /// The factor at a time.
    pub fn at(&self, time: f64) -> f64 {
        match self {
            Self::Steady => 1.0,
            Self::Oscillation { period } => (TAU * (time / period).fract()).cos(),
            Self::Table { times, factors } => {
                let after = times.partition_point(|&known| known <= time);
                let [before, after] = [after.saturating_sub(1), after.min(times.len() - 1)];
                let width = times[after] - times[before];
                if width <= 0.0 {
                    return factors[before];
                }
                let share = ((time - times[before]) / width).max(0.0);
                factors[before] + share * (factors[after] - factors[before])
            }
        }
    }

    /// The longest step that follows the course; infinite where it has no period.
    pub fn longest_step(&self) -> f64 {
        match self {
            Self::Steady | Self::Table { .. } => f64::INFINITY,
            Self::Oscillation { period } => period / STEPS,
        }
    }

    /// The first time after this one at which the factor is not smooth, so that a step has to end there; infinite without
    /// one.
    pub fn next_corner(&self, time: f64) -> f64 {
        let times = match self {
            Self::Steady | Self::Oscillation { .. } => &[][..],
            Self::Table { times, .. } => times,
        };
        let after = times.partition_point(|&corner| corner <= time);
        times.get(after).copied().unwrap_or(f64::INFINITY)
    }
}
