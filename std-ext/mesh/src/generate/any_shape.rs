//! A shape that is chosen at run time.

use super::carlson;
use helfrich::shapes::{Discocyte, Ellipsoid, ExactPoint, Shape, ShapeError, Sphere, Torus};
use std::f64::consts::PI;
use std::fmt;
use std::str::FromStr;

/// One of the exact shapes.
///
/// It is parsed from and formatted as a name, alone or with parameters: `sphere`, `sphere:R`,
/// `ellipsoid:a,b,c`, `torus:R,r`, `discocyte:R`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnyShape {
    /// By default of radius 1.
    Sphere(Sphere<f64>),
    /// By default with three different semi-axes: 1, 0.8 and 0.6.
    Ellipsoid(Ellipsoid<f64>),
    /// By default with R = 2 and r = 1.
    Torus(Torus<f64>),
    /// By default of radius 1.
    Discocyte(Discocyte<f64>),
}

/// Calls a method of the actual shape.
macro_rules! each {
    ($any:expr, $shape:ident => $call:expr) => {
        match $any {
            AnyShape::Sphere($shape) => $call,
            AnyShape::Ellipsoid($shape) => $call,
            AnyShape::Torus($shape) => $call,
            AnyShape::Discocyte($shape) => $call,
        }
    };
}

impl AnyShape {
    /// The shape's name, without parameters.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Sphere(_) => "sphere",
            Self::Ellipsoid(_) => "ellipsoid",
            Self::Torus(_) => "torus",
            Self::Discocyte(_) => "discocyte",
        }
    }

    /// The lengths after the name: the radii or semi-axes.
    fn parameters(&self) -> Vec<f64> {
        match self {
            Self::Sphere(sphere) => vec![sphere.radius],
            Self::Ellipsoid(ellipsoid) => ellipsoid.semi_axes.into(),
            Self::Torus(torus) => vec![torus.radius, torus.tube_radius],
            Self::Discocyte(discocyte) => vec![discocyte.radius],
        }
    }

    /// Length that makes the shape's curvatures dimensionless: R of sphere, torus and discocyte, the longest
    /// semi-axis of an ellipsoid.
    pub fn size(&self) -> f64 {
        match self {
            Self::Sphere(sphere) => sphere.radius,
            Self::Ellipsoid(ellipsoid) => ellipsoid.semi_axes.into_iter().fold(0.0, f64::max),
            Self::Torus(torus) => torus.radius,
            Self::Discocyte(discocyte) => discocyte.radius,
        }
    }

    /// The area: `4πR²`; `4π²Rr` of the torus; of the ellipsoid `4π R_G(a²b², b²c², c²a²)` with
    /// Carlson's symmetric integral; of the discocyte `4πR² ∫₀¹ √G dz` with its area element √G.
    pub fn area(&self) -> f64 {
        match self {
            Self::Sphere(sphere) => 4.0 * PI * sphere.radius.powi(2),
            Self::Ellipsoid(ellipsoid) => {
                // Lengths are in units of the longest semi-axis, so that no product overflows or underflows.
                let unit = self.size();
                let [a, b, c] = ellipsoid.semi_axes.map(|axis| (axis / unit).powi(2));
                4.0 * PI * unit * unit * carlson::second_kind([a * b, b * c, c * a])
            }
            Self::Torus(torus) => 4.0 * PI * PI * torus.radius * torus.tube_radius,
            Self::Discocyte(discocyte) => {
                let element = |z: f64| discocyte.area_element([(1.0 - z * z).sqrt(), 0.0, z]);
                4.0 * PI * integral(element)
            }
        }
    }

    /// The enclosed volume: `4π a b c/3`; `2π² R r²` of the torus; of the discocyte
    /// `2π R³ ∫₀¹ s √(1 − s²) (C0 + C1 s² + C2 s⁴) ds = 2π R³ (C0/3 + 2 C1/15 + 8 C2/105)`.
    pub fn volume(&self) -> f64 {
        match self {
            Self::Sphere(sphere) => 4.0 * PI / 3.0 * sphere.radius.powi(3),
            Self::Ellipsoid(ellipsoid) => {
                4.0 * PI / 3.0 * ellipsoid.semi_axes.iter().product::<f64>()
            }
            Self::Torus(torus) => 2.0 * PI * PI * torus.radius * torus.tube_radius.powi(2),
            Self::Discocyte(discocyte) => {
                let [c0, c1, c2] = discocyte.coefficients;
                let integral = c0 / 3.0 + 2.0 * c1 / 15.0 + 8.0 * c2 / 105.0;
                2.0 * PI * discocyte.radius.powi(3) * integral
            }
        }
    }

    /// χ, the Euler characteristic: 0 for the torus, 2 for the others.
    pub fn euler_characteristic(&self) -> i64 {
        match self {
            Self::Torus(_) => 0,
            _ => 2,
        }
    }
}

/// The integral of a smooth function from 0 to 1 by Simpson's rule.
fn integral(function: impl Fn(f64) -> f64) -> f64 {
    const INTERVALS: u32 = 1024;
    let terms = (0..=INTERVALS).map(|index| {
        let weight = match index {
            0 | INTERVALS => 1.0,
            _ if index % 2 == 1 => 4.0,
            _ => 2.0,
        };
        weight * function(f64::from(index) / f64::from(INTERVALS))
    });
    terms.sum::<f64>() / (3.0 * f64::from(INTERVALS))
}

impl Shape<f64> for AnyShape {
    fn at(&self, preimage: [f64; 3]) -> ExactPoint<f64> {
        each!(self, shape => shape.at(preimage))
    }

    fn preimage(&self, position: [f64; 3]) -> [f64; 3] {
        each!(self, shape => shape.preimage(position))
    }

    fn area_element(&self, preimage: [f64; 3]) -> f64 {
        each!(self, shape => shape.area_element(preimage))
    }

    fn position(&self, preimage: [f64; 3]) -> [f64; 3] {
        each!(self, shape => shape.position(preimage))
    }
}

/// The reason why a text does not name a shape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParseShapeError {
    /// A name that does not belong to a shape.
    #[error("there is no shape `{name}`: choose sphere, ellipsoid, torus or discocyte")]
    UnknownName {
        /// The name.
        name: String,
    },
    /// A parameter that cannot be read.
    #[error("`{text}` is not a number: parameters are written as in {example}")]
    NotANumber {
        /// The parameter.
        text: String,
        /// An example of a valid text.
        example: &'static str,
    },
    /// Too few or too many parameters.
    #[error("{found} parameters are given where {expected} are needed, as in {example}")]
    WrongCount {
        /// The number given.
        found: usize,
        /// The number that the shape has.
        expected: usize,
        /// An example of a valid text.
        example: &'static str,
    },
    /// A parameter out of its range.
    #[error(transparent)]
    Shape(#[from] ShapeError),
}

impl FromStr for AnyShape {
    type Err = ParseShapeError;

    fn from_str(text: &str) -> Result<Self, ParseShapeError> {
        let (name, parameters) = match text.split_once(':') {
            Some((name, parameters)) => (name, Some(parameters)),
            None => (text, None),
        };
        Ok(match name {
            "sphere" => {
                let [radius] = numbers(parameters, [1.0], "sphere:1")?;
                Self::Sphere(Sphere::new(radius)?)
            }
            "ellipsoid" => {
                let semi_axes = numbers(parameters, [1.0, 0.8, 0.6], "ellipsoid:1,0.8,0.6")?;
                Self::Ellipsoid(Ellipsoid::new(semi_axes)?)
            }
            "torus" => {
                let [radius, tube_radius] = numbers(parameters, [2.0, 1.0], "torus:2,1")?;
                Self::Torus(Torus::new(radius, tube_radius)?)
            }
            "discocyte" => {
                let [radius] = numbers(parameters, [1.0], "discocyte:1")?;
                Self::Discocyte(Discocyte::new(radius)?)
            }
            _ => return Err(ParseShapeError::UnknownName { name: name.into() }),
        })
    }
}

/// The numbers of a comma-separated list, or the defaults if there is no list.
fn numbers<const N: usize>(
    list: Option<&str>,
    default: [f64; N],
    example: &'static str,
) -> Result<[f64; N], ParseShapeError> {
    let Some(list) = list else {
        return Ok(default);
    };
    let number = |text: &str| {
        let text = text.trim();
        text.parse().map_err(|_| ParseShapeError::NotANumber {
            text: text.into(),
            example,
        })
    };
    let found: Vec<f64> = list.split(',').map(number).collect::<Result<_, _>>()?;
    let wrong_count = |found: Vec<f64>| ParseShapeError::WrongCount {
        found: found.len(),
        expected: N,
        example,
    };
    found.try_into().map_err(wrong_count)
}

impl fmt::Display for AnyShape {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parameters = self.parameters();
        let list = Vec::from_iter(parameters.iter().map(f64::to_string)).join(",");
        formatter.pad(&format!("{}:{list}", self.name()))
    }
}
