//! Numbers with their units, for explanations.

use super::UnitSystem;
use super::units::Dimension;
use serde::Serialize;

/// A number with its unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Its key.
    pub name: &'static str,
    /// The number in the scene's units.
    pub value: f64,
    /// The unit; empty if there is none.
    pub unit: String,
}

/// Numbers with the units of a scene.
pub(crate) struct Parameters(UnitSystem);

impl Parameters {
    pub(crate) fn new(units: UnitSystem) -> Self {
        Self(units)
    }

    pub(crate) fn of(&self, name: &'static str, value: f64, dimension: Dimension) -> Parameter {
        Parameter {
            name,
            value,
            unit: dimension.unit(self.0),
        }
    }

    pub(crate) fn plain(&self, name: &'static str, value: f64) -> Parameter {
        self.of(name, value, Dimension::NONE)
    }

    pub(crate) fn percent(&self, name: &'static str, value: f64) -> Parameter {
        let unit = "%".to_owned();
        Parameter { name, value, unit }
    }

    pub(crate) fn vector(
        &self,
        names: [&'static str; 3],
        value: [f64; 3],
        dimension: Dimension,
    ) -> [Parameter; 3] {
        std::array::from_fn(|axis| self.of(names[axis], value[axis], dimension))
    }
}
