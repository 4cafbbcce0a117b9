//! Options of methods, common to the command line and scenes.

use super::{AnyMethod, BendingMethod};
use helfrich::{Bandwidth, DualArea, Real};
use serde::{Serialize, Serializer};
use std::fmt;

/// Options of a bending method; a method uses its default for an option that is not given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct MethodOptions {
    /// Areas of vertices for gompper-kroll (B) and meyer (C); by default mixed.
    #[serde(
        serialize_with = "areas_by_name",
        skip_serializing_if = "Option::is_none"
    )]
    pub areas: Option<DualArea>,
    /// Bandwidth of the heat kernel of belkin (D); by default [`Bandwidth::Converging`].
    #[serde(
        serialize_with = "bandwidth_by_name",
        skip_serializing_if = "Option::is_none"
    )]
    pub bandwidth: Option<Bandwidth<f64>>,
}

/// An option that a method does not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("method {method} has no option `{option}`: {}", known(option))]
pub struct UnusedOption {
    /// The method.
    pub method: AnyMethod,
    /// The option's name.
    pub option: &'static str,
}

fn known(option: &str) -> &'static str {
    match option {
        MethodOptions::AREAS => "gompper-kroll (B) and meyer (C) have",
        _ => "belkin (D) has",
    }
}

/// An unknown kind of area.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there are no areas `{name}`: areas are mixed, voronoi or barycentric")]
pub struct UnknownAreas {
    name: String,
}

/// A text that is not a bandwidth.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{text}` is not a bandwidth: it must be a number above 0, in mean areas of a vertex, or `converging`, \
     max(1/4, sqrt(N)/100) of them, or `published`, the mixed area of each vertex"
)]
pub struct InvalidBandwidth {
    text: String,
}

const AREAS: [(&str, DualArea); 3] = [
    ("mixed", DualArea::Mixed),
    ("voronoi", DualArea::Voronoi),
    ("barycentric", DualArea::Barycentric),
];

impl MethodOptions {
    /// The name of the option [`Self::areas`].
    pub const AREAS: &'static str = "areas";
    /// The name of the option [`Self::bandwidth`].
    pub const BANDWIDTH: &'static str = "bandwidth";

    /// The names of areas.
    pub fn areas_names() -> Vec<&'static str> {
        AREAS.iter().map(|&(name, _)| name).collect()
    }

    /// The named bandwidths.
    pub fn bandwidth_names() -> Vec<&'static str> {
        vec!["converging", "published"]
    }

    /// Parses the name of areas.
    ///
    /// # Errors
    /// If the name is unknown.
    pub fn parse_areas(name: &str) -> Result<DualArea, UnknownAreas> {
        let named = AREAS
            .iter()
            .find(|(known, _)| known.eq_ignore_ascii_case(name));
        let unknown = || UnknownAreas {
            name: name.to_owned(),
        };
        named.map(|&(_, areas)| areas).ok_or_else(unknown)
    }

    /// Parses a bandwidth: a number of mean areas of a vertex, or a name.
    ///
    /// # Errors
    /// If it is neither.
    pub fn parse_bandwidth(text: &str) -> Result<Bandwidth<f64>, InvalidBandwidth> {
        if text.eq_ignore_ascii_case("converging") {
            return Ok(Bandwidth::Converging);
        }
        if text.eq_ignore_ascii_case("published") {
            return Ok(Bandwidth::MixedArea(1.0));
        }
        match text.parse::<f64>() {
            Ok(factor) if factor > 0.0 && factor.is_normal() => Ok(Bandwidth::MeanArea(factor)),
            _ => Err(InvalidBandwidth {
                text: text.to_owned(),
            }),
        }
    }

    /// Checks that a method has all given options.
    ///
    /// # Errors
    /// The first given option that the method does not have.
    pub fn check(&self, method: impl Into<AnyMethod>) -> Result<(), UnusedOption> {
        let method = method.into();
        let own = self.of(method);
        let unused = |option| Err(UnusedOption { method, option });
        if own.areas != self.areas {
            return unused(Self::AREAS);
        }
        if own.bandwidth != self.bandwidth {
            return unused(Self::BANDWIDTH);
        }
        Ok(())
    }

    /// Checks that each given option belongs to at least one of several methods.
    ///
    /// # Errors
    /// The first option that none of the methods has, with the first method.
    pub fn check_any(&self, methods: &[AnyMethod]) -> Result<(), UnusedOption> {
        let with = |options: Self| {
            let mut results = methods.iter().map(|&method| options.check(method));
            let first = results.next().unwrap_or(Ok(()));
            results.fold(first, Result::or)
        };
        with(Self {
            bandwidth: None,
            ..*self
        })?;
        with(Self {
            areas: None,
            ..*self
        })
    }

    /// The given options that apply to a method.
    #[must_use]
    pub fn of(self, method: impl Into<AnyMethod>) -> Self {
        let method = method.into();
        let have_areas = [BendingMethod::GompperKroll, BendingMethod::Meyer];
        let has_areas = have_areas.iter().any(|listed| method == *listed);
        let has_bandwidth = method == BendingMethod::Belkin;
        Self {
            areas: self.areas.filter(|_| has_areas),
            bandwidth: self.bandwidth.filter(|_| has_bandwidth),
        }
    }

    /// Whether no option is given.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// Bandwidth for a mesh of N vertices in mean areas of a vertex; the average if it follows the mixed
    /// areas.
    pub fn bandwidth_in_mean_areas(&self, vertices: usize) -> f64 {
        match self.bandwidth.unwrap_or_default() {
            Bandwidth::Converging => (0.01 * (vertices as f64).sqrt()).max(0.25),
            Bandwidth::MeanArea(factor) | Bandwidth::MixedArea(factor) => factor,
            Bandwidth::Global(_) => 1.0,
        }
    }

    pub(super) fn areas_or_default(&self) -> DualArea {
        self.areas.unwrap_or_default()
    }

    pub(super) fn bandwidth_or_default<T: Real>(&self) -> Bandwidth<T> {
        match self.bandwidth.unwrap_or_default() {
            Bandwidth::Converging => Bandwidth::Converging,
            Bandwidth::MeanArea(factor) => Bandwidth::MeanArea(T::constant(factor)),
            Bandwidth::MixedArea(factor) => Bandwidth::MixedArea(T::constant(factor)),
            Bandwidth::Global(area) => Bandwidth::Global(T::constant(area)),
        }
    }
}

/// Formats the options as `voronoi areas`, `bandwidth 0.5`, separated by commas; defaults give nothing.
impl fmt::Display for MethodOptions {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let areas = self.areas.map(|areas| format!("{} areas", name(areas)));
        let bandwidth = self.bandwidth.map(|bandwidth| match bandwidth {
            Bandwidth::Converging => "converging bandwidth".to_owned(),
            Bandwidth::MixedArea(_) => "published bandwidth".to_owned(),
            Bandwidth::MeanArea(value) | Bandwidth::Global(value) => format!("bandwidth {value}"),
        });
        let given = Vec::from_iter(areas.into_iter().chain(bandwidth));
        formatter.pad(&given.join(", "))
    }
}

fn name(areas: DualArea) -> &'static str {
    match areas {
        DualArea::Mixed => "mixed",
        DualArea::Voronoi => "voronoi",
        DualArea::Barycentric => "barycentric",
    }
}

fn areas_by_name<S: Serializer>(
    areas: &Option<DualArea>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    areas.map(name).serialize(serializer)
}

fn bandwidth_by_name<S: Serializer>(
    bandwidth: &Option<Bandwidth<f64>>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    match bandwidth {
        None => serializer.serialize_none(),
        Some(Bandwidth::Converging) => serializer.serialize_str("converging"),
        Some(Bandwidth::MixedArea(_)) => serializer.serialize_str("published"),
        Some(Bandwidth::MeanArea(value) | Bandwidth::Global(value)) => {
            serializer.serialize_f64(*value)
        }
    }
}
