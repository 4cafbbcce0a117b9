//! Keys that several drivers have.

use super::super::flow::{FLOW as FLOW_KEYS, Flow};
use super::super::keys::{Form, Key, NUMBER, optional, positive};
use super::super::parameter::{Parameter, Parameters};
use super::super::units::Dimension;

pub(super) const REDISTRIBUTION: Key = optional(
    "redistribution",
    Form::Either(&[Form::Switch, Form::Choice(|| vec!["auto"])]),
    "Whether vertices of fluid surfaces are moved along the surface to keep the mesh even; by default \
     \"auto\": for surfaces that are fluid (without elasticity and local_area) and, in a flow, not \
     stretched.",
);

pub(super) const VISCOSITY: Key = optional(
    "viscosity",
    positive(Dimension::VISCOSITY),
    "Viscosity μ of the fluid outside the surfaces.",
);

pub(super) const FLOW: Key = optional(
    "flow",
    Form::Table(&FLOW_KEYS),
    "The undisturbed flow, without surfaces; by default the fluid is at rest.",
);

pub(super) const DURATION: Key = optional(
    "duration",
    positive(Dimension::TIME),
    "Time at which the run ends.",
);

pub(super) const STRAIN: Key = optional(
    "strain",
    NUMBER,
    "Strain at which the run ends, the flow's rate times the time, instead of duration. \
     Rates: γ̇ of a shear, ε̇ of an extension, √(2 E:E) of a linear flow with E the symmetric \
     part of its gradient, 2U/R of a Poiseuille flow, 4U/H of a channel.",
);

pub(super) const STEP: Key = optional(
    "step",
    positive(Dimension::TIME),
    "Step of the integrator rk4, which requires it; refused if it is not stable at the start of the \
     run. Other integrators choose their steps by the tolerance. For a lattice: the step, by default \
     the longest that compressibility, inertia and membranes allow.",
);

pub(super) const VOLUME_CORRECTION: Key = optional(
    "volume_correction",
    Form::Switch,
    "Whether corrections keep the volume of each closed surface to rounding; without them it changes \
     by errors of the mesh and the steps; by default true.",
);

/// Corrections of positions in addition to the flow.
pub(super) fn kept(volumes: bool, meshes: bool) -> String {
    let volumes = match volumes {
        true => "volumes kept to rounding",
        false => "volumes not corrected",
    };
    let meshes = match meshes {
        true => ", vertices of fluid surfaces slide along them",
        false => "",
    };
    format!("{volumes}{meshes}")
}

/// The viscosity of the fluid and the duration, for `explain`; in a shear or another flow with a rate
/// also the strain at the end.
pub(super) fn flow_parameters(
    number: &Parameters,
    viscosity: f64,
    duration: f64,
    flow: Flow,
) -> Vec<Parameter> {
    let mut parameters = vec![
        number.of("viscosity", viscosity, Dimension::VISCOSITY),
        number.of("duration", duration, Dimension::TIME),
    ];
    if let Some(rate) = flow.rate() {
        parameters.push(number.plain("strain", rate * duration));
    }
    parameters
}
