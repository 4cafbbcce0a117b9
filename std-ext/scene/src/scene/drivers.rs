//! Drivers, which move the surfaces: one file each, and one entry each in the lists below.
//!
//! The file of a driver holds its description, its keys and its explanation. Keys that several drivers
//! have are in `shared`. `build` of a scene reads a driver, because its defaults depend on the
//! surfaces.

mod boundary_integral;
mod lattice_boltzmann;
mod relax;
mod shared;

pub use boundary_integral::{BoundaryIntegral, Integrator};
pub(crate) use lattice_boltzmann::AXES;
pub use lattice_boltzmann::LatticeBoltzmann;
pub use relax::{Relax, Scheme};

use super::flow::Flow;
use super::keys::{Form, Keys, Kind, count_of, kinds, of_kinds, required};
use super::parameter::{Parameter, Parameters};
use helfrich::Images;
use serde::Serialize;

/// A driver, which moves the surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum Driver {
    /// Relaxation to an equilibrium; the path has no meaning, and there is no time.
    Relax(Relax),
    /// Membranes in Stokes flow without walls.
    BoundaryIntegral(BoundaryIntegral),
    /// Membranes in a box of fluid on a lattice.
    LatticeBoltzmann(LatticeBoltzmann),
}

impl Driver {
    /// Its name, the `kind` of a scene's driver.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Relax(_) => Relax::KIND.name,
            Self::BoundaryIntegral(_) => BoundaryIntegral::KIND.name,
            Self::LatticeBoltzmann(_) => LatticeBoltzmann::KIND.name,
        }
    }

    /// A description of the scheme, and the parameters.
    pub(crate) fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        match self {
            Self::Relax(driver) => driver.explain(number),
            Self::BoundaryIntegral(driver) => driver.explain(number),
            Self::LatticeBoltzmann(driver) => driver.explain(number),
        }
    }

    /// Whether interactions act between surfaces and obstacles; on a lattice, the fluid keeps them apart.
    pub(crate) fn meets_obstacles(&self) -> bool {
        !matches!(self, Self::LatticeBoltzmann(_))
    }

    /// The ambient flow; `None` for drivers without one.
    pub fn flow(&self) -> Option<&Flow> {
        match self {
            Self::Relax(_) => None,
            Self::BoundaryIntegral(driver) => Some(&driver.flow),
            Self::LatticeBoltzmann(driver) => Some(&driver.flow),
        }
    }

    /// The periodic images of surfaces in a box; none in free space.
    pub fn images(&self) -> Images<f64> {
        match self {
            Self::Relax(_) | Self::BoundaryIntegral(_) => Images::none(),
            Self::LatticeBoltzmann(driver) => driver.images(),
        }
    }

    /// Viscosity μ of the fluid outside the surfaces; `None` for drivers without a fluid.
    pub fn viscosity(&self) -> Option<f64> {
        match self {
            Self::Relax(_) => None,
            Self::BoundaryIntegral(driver) => Some(driver.viscosity),
            Self::LatticeBoltzmann(driver) => Some(driver.viscosity),
        }
    }
}

/// The table of a driver in a scene file.
trait DescribedDriver {
    /// The name of the driver and its keys.
    const KIND: Kind;

    /// A description of the scheme, and the parameters.
    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>);
}

const KINDS: &[Kind] = &[Relax::KIND, BoundaryIntegral::KIND, LatticeBoltzmann::KIND];

pub(super) static DRIVER: Keys = Keys {
    keys: &of_kinds::<{ 1 + count_of(KINDS) }>(
        required(
            "kind",
            Form::Choice(|| kinds(&DRIVER)),
            "The driver: \"relax\" finds an equilibrium, without time; \"boundary-integral\" \
             moves membranes in Stokes flow without walls; \"lattice-boltzmann\" in a box of \
             fluid, with or without inertia, walls and obstacles.",
        ),
        KINDS,
    ),
    exactly_one: &[],
    at_most_one: &[],
    needs: &[],
    kinds: KINDS,
};
