//! Membranes in Stokes flow without walls, moved by boundary integrals.

use super::super::flow::Flow;
use super::super::keys::{Form, Kind, NUMBER, Range, optional};
use super::super::parameter::{Parameter, Parameters};
use super::super::units::Dimension;
use super::DescribedDriver;
use super::shared::{
    DURATION, FLOW, REDISTRIBUTION, STEP, STRAIN, VISCOSITY, VOLUME_CORRECTION, flow_parameters,
    kept,
};
use serde::Serialize;

/// Membranes in Stokes flow, moved by boundary integrals.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BoundaryIntegral {
    /// Viscosity μ of the fluid outside, pressure times time.
    pub viscosity: f64,
    /// The undisturbed flow, without membranes.
    pub flow: Flow,
    /// The time at which the run ends; it begins at 0.
    pub duration: f64,
    /// The integrator; `auto` has been resolved.
    pub integrator: Integrator,
    /// The error tolerance of a step, in units of the size of the surfaces.
    pub tolerance: f64,
    /// The tolerance of sums over clusters of vertices; 0 sums over all pairs, and `None` chooses by
    /// [`Self::cluster_tolerance_at`].
    pub cluster_tolerance: Option<f64>,
    /// Whether the discrete volume of each closed surface is kept to rounding.
    pub volume_correction: bool,
    /// Whether vertices of fluid surfaces slide along them to keep the mesh even.
    pub redistribution: bool,
}

/// Least number of vertices for which clusters save half of the time.
const CLUSTERED: usize = 5000;

impl BoundaryIntegral {
    /// The tolerance of sums over clusters if all surfaces together have this many vertices; 0 for all
    /// pairs. [`crate::flow::SingleLayer::set_cluster_tolerance`] defines the norm of the error.
    pub fn cluster_tolerance_at(&self, vertices: usize) -> f64 {
        let automatic = if vertices < CLUSTERED { 0.0 } else { 1e-4 };
        self.cluster_tolerance.unwrap_or(automatic)
    }
}

/// The integrator. [`crate::dynamics::integrate::Scheme`] describes each.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "name")]
pub enum Integrator {
    /// Stabilised steps of second order, where bending limits the step.
    Rkc2,
    /// Linearly implicit steps of third order, where bending is much faster than the flow.
    Rosenbrock,
    /// A pair of third and second order.
    Bs23,
    /// The classical scheme of fourth order.
    Rk4 {
        /// The fixed step, a time.
        step: f64,
    },
}

impl DescribedDriver for BoundaryIntegral {
    const KIND: Kind = Kind {
        name: "boundary-integral",
        keys: &[
            VISCOSITY.required(),
            FLOW,
            DURATION,
            STRAIN,
            optional(
                "integrator",
                Form::Choice(|| vec!["auto", "rkc2", "rosenbrock", "bs23", "rk4"]),
                "\"rkc2\" if bending or surface tension limits the step, \"rosenbrock\" (linearly \
                 implicit) if they are much faster than the flow, \"bs23\" if they do not limit the \
                 step, \"rk4\" for fixed steps; \"auto\", the default, is rkc2 if a surface has \
                 bending or a tension, and bs23 otherwise.",
            ),
            STEP,
            optional(
                "tolerance",
                NUMBER,
                "Error tolerance of a step, relative to the size of the surfaces; by default 1e-4.",
            ),
            optional(
                "cluster_tolerance",
                Form::Number(Dimension::NONE, Range::NotNegative),
                "Relative error of velocities if they are summed over clusters of vertices, in a time \
                 proportional to the number of vertices; 0 sums over all pairs. By default 1e-4 if \
                 all surfaces together have 5000 vertices or more, and 0 otherwise.",
            ),
            VOLUME_CORRECTION,
            REDISTRIBUTION,
        ],
        exactly_one: &[&["duration", "strain"]],
    };

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let kept = kept(self.volume_correction, self.redistribution);
        let parameters = flow_parameters(number, self.viscosity, self.duration, self.flow);
        let choice = format!("Stokes flow without walls, Reynolds number 0, {kept}");
        (choice, parameters)
    }
}
