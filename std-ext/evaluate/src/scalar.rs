//! Number types, chosen at run time, and positions stored in them.

use helfrich::{Real, Surface, SurfaceError, TriangleMesh};
use serde::Serialize;
use std::fmt;
use std::str::FromStr;

/// Number type in which a method computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
pub enum Scalar {
    /// 32 bits, also for positions.
    #[serde(rename = "f32")]
    F32,
    /// 32 bits in all computations, with positions as pairs of 32-bit numbers.
    #[serde(rename = "f32-pair")]
    F32Pair,
    /// 64 bits.
    #[serde(rename = "f64")]
    F64,
}

impl Scalar {
    /// All number types, from the least to the most precise.
    pub const ALL: [Self; 3] = [Self::F32, Self::F32Pair, Self::F64];

    /// Whether a positive number neither overflows nor loses digits in this type.
    pub fn holds(self, value: f64) -> bool {
        let range = match self {
            Self::F32 | Self::F32Pair => f64::from(f32::MIN_POSITIVE)..=f64::from(f32::MAX),
            Self::F64 => f64::MIN_POSITIVE..=f64::MAX,
        };
        range.contains(&value)
    }

    /// Whether bending methods accept this modulus in this type, see
    /// [`Method::check`](helfrich::Method::check).
    pub fn holds_modulus(self, modulus: f64) -> bool {
        let largest = match self {
            Self::F32 | Self::F32Pair => f64::from(f32::MAX.sqrt()),
            Self::F64 => f64::MAX.sqrt(),
        };
        self.holds(modulus) && modulus <= largest
    }

    /// `f32`, `f32-pair` or `f64`.
    pub fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F32Pair => "f32-pair",
            Self::F64 => "f64",
        }
    }
}

impl fmt::Display for Scalar {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

impl FromStr for Scalar {
    type Err = UnknownScalar;

    fn from_str(name: &str) -> Result<Self, UnknownScalar> {
        let named = Self::ALL.into_iter().find(|scalar| scalar.name() == name);
        named.ok_or_else(|| UnknownScalar {
            name: name.to_owned(),
        })
    }
}

/// A name that does not belong to a number type.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no number type `{name}`: the number types are f32, f32-pair and f64")]
pub struct UnknownScalar {
    name: String,
}

/// Positions rounded to a scalar, with or without their remainders.
#[derive(Clone, Debug)]
pub struct HeldPositions<T> {
    positions: Vec<[T; 3]>,
    remainders: Option<Vec<[T; 3]>>,
}

impl<T: Real> HeldPositions<T> {
    /// Stores `positions` as `scalar` requires; T is its type for computations.
    pub fn new(scalar: Scalar, positions: &[[f64; 3]]) -> Self {
        let rounded: Vec<[T; 3]> = positions
            .iter()
            .map(|position| position.map(T::constant))
            .collect();
        let left_out = |(position, rounded): (&[f64; 3], &[T; 3])| {
            let back = rounded.map(|coordinate| coordinate.to_f64().unwrap_or(f64::NAN));
            core::array::from_fn(|axis| T::constant(position[axis] - back[axis]))
        };
        let remainders = match scalar {
            Scalar::F32 | Scalar::F64 => None,
            Scalar::F32Pair => Some(positions.iter().zip(&rounded).map(left_out).collect()),
        };
        Self {
            positions: rounded,
            remainders,
        }
    }

    /// The rounded positions.
    pub fn positions(&self) -> &[[T; 3]] {
        &self.positions
    }

    /// The surface with these positions.
    ///
    /// # Errors
    /// If the numbers of positions and vertices differ, or a position overflows the scalar.
    pub fn surface<'a>(&'a self, mesh: &'a TriangleMesh) -> Result<Surface<'a, T>, SurfaceError> {
        match &self.remainders {
            None => Surface::new(mesh, &self.positions),
            Some(remainders) => Surface::with_remainders(mesh, &self.positions, remainders),
        }
    }
}
