//! Relaxation to an equilibrium.

use super::super::keys::{Form, Kind, NUMBER, optional};
use super::super::parameter::{Parameter, Parameters};
use super::DescribedDriver;
use super::shared::REDISTRIBUTION;
use serde::Serialize;

/// Settings of a relaxation, and its stopping criteria.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Relax {
    /// The scheme; `auto` has been resolved.
    pub scheme: Scheme,
    /// The run ends when the root mean square of the remaining force per area is below this, in
    /// units of κ/R³ + K/R. K is the largest in-plane modulus, `4πR² = A`.
    pub residual: f64,
    /// Iterations after which the run ends in any case.
    pub iterations: u64,
    /// Whether vertices are moved along the surface to keep the mesh even.
    pub redistribution: bool,
    /// Largest relative error of the energy of a closed surface with bending at which a run counts
    /// as converged.
    pub energy_error: f64,
    /// Number of normal modes to find at the end.
    pub modes: u64,
}

/// The minimisation scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scheme {
    /// Energy minimisation, for conservative methods.
    Minimise,
    /// Overdamped dynamics, for all methods.
    Overdamped,
}

impl DescribedDriver for Relax {
    const KIND: Kind = Kind {
        name: "relax",
        keys: &[
            optional(
                "scheme",
                Form::Choice(|| vec!["auto", "minimise", "overdamped"]),
                "\"minimise\" for methods with an energy, \"overdamped\" for all; \"auto\", the \
                 default, minimises if all methods have an energy.",
            ),
            optional(
                "residual",
                NUMBER,
                "The run ends when the root mean square of the remaining force per area is below \
                 this, in units of κ/R³ + K/R with K the largest in-plane modulus and 4πR² = A; by \
                 default 1e-5.",
            ),
            optional(
                "iterations",
                Form::Count(1),
                "Largest number of iterations; by default 10000.",
            ),
            REDISTRIBUTION,
            optional(
                "energy_error",
                NUMBER,
                "Largest allowed relative error of the energy of each closed surface with bending, \
                 estimated by jets of degree 6 on the same vertices; by default 0.01. If it is \
                 larger, the run ends as unresolved instead of converged.",
            ),
            optional(
                "modes",
                Form::Count(0),
                "Number of normal modes to find at the end, by rising stiffness, up to 100; by \
                 default 0. They tell whether the equilibrium is stable: see `modes.csv`.",
            ),
        ],
        exactly_one: &[],
    };

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let scheme = match self.scheme {
            Scheme::Minimise => "minimise: the energy of all effects, under the constraints",
            Scheme::Overdamped => {
                "overdamped: forces without an energy, until they are below the residual"
            }
        };
        let mut parameters = vec![
            number.plain("residual", self.residual),
            number.plain("iterations", self.iterations as f64),
            number.plain("energy_error", self.energy_error),
        ];
        if self.modes > 0 {
            parameters.push(number.plain("modes", self.modes as f64));
        }
        (scheme.to_owned(), parameters)
    }
}
