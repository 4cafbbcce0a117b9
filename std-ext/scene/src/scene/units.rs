//! Dimensions, units, and numbers with a unit.

use super::UnitSystem;

/// Boltzmann's constant, 1.380649e-23 J/K by definition of the kelvin, in pN·µm/K.
const BOLTZMANN: f64 = 1.380649e-5;

/// The temperature of the unit `kT`, unless a scene names another one: 25 °C, in kelvin.
pub(super) const TEMPERATURE: f64 = 298.15;

/// The units of a scene, in which its numbers are read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    pub(super) units: UnitSystem,
    /// In kelvin.
    pub(super) temperature: f64,
}

/// The unit `kT` at a temperature in kelvin, in pN·µm.
pub(crate) fn thermal_energy(temperature: f64) -> f64 {
    BOLTZMANN * temperature
}

/// A dimension as powers of force, length and time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Dimension {
    force: i32,
    length: i32,
    time: i32,
}

impl Dimension {
    const fn new(force: i32, length: i32, time: i32) -> Self {
        Self {
            force,
            length,
            time,
        }
    }

    pub(crate) const NONE: Self = Self::new(0, 0, 0);
    pub(crate) const LENGTH: Self = Self::new(0, 1, 0);
    pub(crate) const AREA: Self = Self::new(0, 2, 0);
    pub(crate) const VOLUME: Self = Self::new(0, 3, 0);
    pub(crate) const CURVATURE: Self = Self::new(0, -1, 0);
    pub(crate) const FORCE: Self = Self::new(1, 0, 0);
    pub(crate) const ENERGY: Self = Self::new(1, 1, 0);
    pub(crate) const TENSION: Self = Self::new(1, -1, 0);
    pub(crate) const PRESSURE: Self = Self::new(1, -2, 0);
    pub(crate) const DENSITY: Self = Self::new(1, -4, 2);
    pub(crate) const ACCELERATION: Self = Self::new(0, 1, -2);
    pub(crate) const SURFACE_VISCOSITY: Self = Self::new(1, -1, 1);
    pub(crate) const REPULSION: Self = Self::new(1, -3, 0);
    pub(crate) const TIME: Self = Self::new(0, 0, 1);
    pub(crate) const RATE: Self = Self::new(0, 0, -1);
    pub(crate) const VELOCITY: Self = Self::new(0, 1, -1);
    pub(crate) const VISCOSITY: Self = Self::new(1, -2, 1);
    pub(crate) const FLOW_RATE: Self = Self::new(0, 3, -1);

    /// Its name in messages, and examples of numbers with a unit.
    const NAMES: [(Self, &'static str, &'static str); 17] = [
        (Self::NONE, "a number without a unit", "0.5"),
        (Self::LENGTH, "a length", "\"3.91 µm\""),
        (Self::AREA, "an area", "\"135 µm²\""),
        (Self::VOLUME, "a volume", "\"94 µm³\""),
        (Self::CURVATURE, "a curvature, 1/length", "\"0.5 1/µm\""),
        (Self::FORCE, "a force", "\"30 pN\""),
        (Self::ENERGY, "an energy", "\"2e-19 J\""),
        (Self::TENSION, "a force per length", "\"5.3 µN/m\""),
        (Self::PRESSURE, "a pressure", "\"0.5 Pa\""),
        (Self::DENSITY, "a mass density", "\"50 kg/m³\""),
        (Self::ACCELERATION, "an acceleration", "\"9.81 m/s²\""),
        (
            Self::SURFACE_VISCOSITY,
            "a surface viscosity, force·time/length",
            "\"0.5 µN·s/m\"",
        ),
        (
            Self::REPULSION,
            "an energy per area squared",
            "\"0.5 pN/µm³\"",
        ),
        (Self::TIME, "a time", "\"2 ms\""),
        (Self::RATE, "a rate, 1/time", "\"100 1/s\""),
        (Self::VELOCITY, "a velocity", "\"1 mm/s\""),
        (
            Self::VISCOSITY,
            "a viscosity, pressure·time",
            "\"1.2 mPa s\"",
        ),
    ];

    /// In words, with an article.
    pub(super) fn name(self) -> String {
        let known = Self::NAMES.iter().find(|(known, ..)| *known == self);
        known.map_or_else(
            || format!("of dimension {}", self.symbol()),
            |(_, name, _)| (*name).to_owned(),
        )
    }

    /// A number of this dimension with its unit, in the notation of scenes.
    pub(super) fn example(self) -> &'static str {
        let known = Self::NAMES.iter().find(|(known, ..)| *known == self);
        known.map_or("", |(.., example)| example)
    }

    /// The unit of plain numbers in a scene; empty if there is none.
    pub(crate) fn unit(self, units: UnitSystem) -> String {
        match units {
            UnitSystem::Micro => self.symbol(),
            UnitSystem::None => String::new(),
        }
    }

    /// In pN, µm and s.
    fn symbol(self) -> String {
        let power = |exponent: i32| match exponent.abs() {
            1 => String::new(),
            2 => "²".to_owned(),
            3 => "³".to_owned(),
            4 => "⁴".to_owned(),
            other => format!("^{other}"),
        };
        let bases = [("pN", self.force), ("µm", self.length), ("s", self.time)];
        let part = |sign: i32, separator: &str| {
            let chosen = bases.iter().filter(|(_, exponent)| exponent * sign > 0);
            let words = chosen.map(|(symbol, exponent)| format!("{symbol}{}", power(*exponent)));
            Vec::from_iter(words).join(separator)
        };
        let [above, below] = [part(1, "·"), part(-1, "/")];
        match (above.as_str(), below.as_str()) {
            (_, "") => above,
            ("", _) => format!("1/{below}"),
            _ => format!("{above}/{below}"),
        }
    }
}

/// The reason why a text is not a number with a unit.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum QuantityError {
    /// It does not start with a number.
    NoNumber,
    /// The unit is missing.
    NoUnit,
    /// The unit is unknown.
    UnknownUnit(String),
    /// The number is out of the range of f64.
    TooLarge,
    /// The unit has the wrong dimension.
    Dimension(Dimension),
}

/// The value, in units of pN, µm and s, of a text like `2e-19 J` or `5.3 µN/m`. The result is the
/// nearest f64, because units only shift the decimal point; only `kT`, which depends on the temperature
/// in kelvin, is a factor, accurate to rounding.
pub(super) fn quantity(
    text: &str,
    expected: Dimension,
    temperature: f64,
) -> Result<f64, QuantityError> {
    let (mantissa, exponent, unit) = split_number(text.trim()).ok_or(QuantityError::NoNumber)?;
    let unit = unit.trim();
    if unit.is_empty() {
        return Err(QuantityError::NoUnit);
    }
    let Unit {
        power,
        thermal,
        dimension,
    } = parse_unit(unit)?;
    if dimension != expected {
        return Err(QuantityError::Dimension(dimension));
    }
    // pN and µm are 10⁻¹² N and 10⁻⁶ m.
    let shift = power + 12 * dimension.force + 6 * dimension.length;
    let exponent = exponent.saturating_add(shift);
    let value: f64 = format!("{mantissa}e{exponent}")
        .parse()
        .map_err(|_| QuantityError::NoNumber)?;
    let value = match thermal {
        0 => value,
        power => value * thermal_energy(temperature).powi(power),
    };
    if value.is_finite() {
        Ok(value)
    } else {
        Err(QuantityError::TooLarge)
    }
}

/// Whether a text is a number whose unit depends on the temperature.
pub(super) fn is_thermal(text: &str) -> bool {
    let unit = split_number(text.trim()).and_then(|(.., unit)| parse_unit(unit.trim()).ok());
    unit.is_some_and(|unit| unit.thermal != 0)
}

/// Mantissa, decimal exponent and rest of a text that starts with a number.
fn split_number(text: &str) -> Option<(&str, i32, &str)> {
    let signed = text.strip_prefix(['+', '-']).unwrap_or(text);
    let digits = signed.len()
        - signed
            .trim_start_matches(|c: char| c.is_ascii_digit())
            .len();
    let after = &signed[digits..];
    let fraction = after.strip_prefix('.').map_or(0, |rest| {
        let count = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        1 + count
    });
    let has_digit = digits > 0 || fraction > 1;
    if !has_digit {
        return None;
    }
    let end = text.len() - after.len() + fraction;
    let (mantissa, rest) = text.split_at(end);
    // `e` starts an exponent only if a number follows: `2 erg` has none.
    if let Some(power) = rest.strip_prefix(['e', 'E']) {
        let signed = power.strip_prefix(['+', '-']).unwrap_or(power);
        let count = signed.len()
            - signed
                .trim_start_matches(|c: char| c.is_ascii_digit())
                .len();
        if count > 0 {
            let (exponent, rest) = power.split_at(power.len() - signed.len() + count);
            // Exponents out of the range of i32 give 0 or infinity.
            let beyond = if exponent.starts_with('-') {
                -100_000
            } else {
                100_000
            };
            return Some((mantissa, exponent.parse().unwrap_or(beyond), rest));
        }
    }
    Some((mantissa, 0, rest))
}

/// A power of ten of N, m and s, times a power of k_B T in pN·µm.
#[derive(Clone, Copy)]
struct Unit {
    power: i32,
    thermal: i32,
    dimension: Dimension,
}

/// Units without prefix.
const BASES: [(&str, Unit); 13] = [
    ("m", unit(0, Dimension::LENGTH)),
    ("s", unit(0, Dimension::TIME)),
    ("N", unit(0, Dimension::FORCE)),
    ("J", unit(0, Dimension::ENERGY)),
    ("Pa", unit(0, Dimension::PRESSURE)),
    // A gram is 10⁻³ N s²/m, a litre 10⁻³ m³.
    ("g", unit(-3, Dimension::new(1, -1, 2))),
    ("L", unit(-3, Dimension::VOLUME)),
    ("l", unit(-3, Dimension::VOLUME)),
    ("dyn", unit(-5, Dimension::FORCE)),
    ("erg", unit(-7, Dimension::ENERGY)),
    ("kT", THERMAL),
    ("kBT", THERMAL),
    ("1", unit(0, Dimension::NONE)),
];

/// The unit kT, which is not a power of ten: the powers cancel the factors 10⁻¹² N and 10⁻⁶ m of pN·µm.
const THERMAL: Unit = Unit {
    power: -18,
    thermal: 1,
    dimension: Dimension::ENERGY,
};

const PREFIXES: [(&str, i32); 14] = [
    ("a", -18),
    ("f", -15),
    ("p", -12),
    ("n", -9),
    // Micro sign, Greek letter mu, and the letter u.
    ("µ", -6),
    ("μ", -6),
    ("u", -6),
    ("m", -3),
    ("c", -2),
    ("d", -1),
    ("h", 2),
    ("k", 3),
    ("M", 6),
    ("G", 9),
];

const fn unit(power: i32, dimension: Dimension) -> Unit {
    Unit {
        power,
        thermal: 0,
        dimension,
    }
}

/// Factors and divisors of symbols with powers, from left to right: `pN·s/µm^2`, `1/µm`.
fn parse_unit(text: &str) -> Result<Unit, QuantityError> {
    let unknown = |word: &str| QuantityError::UnknownUnit(word.to_owned());
    let mut product = unit(0, Dimension::NONE);
    let mut rest = text;
    let mut sign = 1;
    loop {
        let end = rest.find(['·', '*', '/', ' ', '⋅']).unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        let (factor, exponent) =
            parse_factor(word).ok_or_else(|| unknown(if word.is_empty() { text } else { word }))?;
        let times = sign * exponent;
        product.power += times * factor.power;
        product.thermal += times * factor.thermal;
        product.dimension.force += times * factor.dimension.force;
        product.dimension.length += times * factor.dimension.length;
        product.dimension.time += times * factor.dimension.time;
        let after = after.trim_start();
        let Some(separator) = after.chars().next() else {
            return Ok(product);
        };
        sign = if separator == '/' { -1 } else { 1 };
        rest = after.trim_start_matches(['·', '*', ' ', '⋅']);
        if separator == '/' {
            rest = after[1..].trim_start();
        } else if let Some(divisor) = rest.strip_prefix('/') {
            sign = -1;
            rest = divisor.trim_start();
        }
    }
}

/// A symbol and its power: `µm`, `µm²`, `µm2`, `s^-1`, `s⁻¹`.
fn parse_factor(word: &str) -> Option<(Unit, i32)> {
    if word == "1" {
        return Some((unit(0, Dimension::NONE), 1));
    }
    let end = word
        .find(|c: char| !c.is_alphabetic())
        .unwrap_or(word.len());
    let (symbol, power) = word.split_at(end);
    let plain: String = power.chars().map(plain_digit).collect();
    let exponent = match plain.strip_prefix('^').unwrap_or(&plain) {
        "" if plain.is_empty() => 1,
        number => number
            .parse()
            .ok()
            .filter(|n: &i32| (1..=9).contains(&n.abs()))?,
    };
    let base = |name: &str| BASES.iter().find(|(base, _)| *base == name && name != "1");
    if let Some((_, found)) = base(symbol) {
        return Some((*found, exponent));
    }
    PREFIXES.iter().find_map(|(prefix, power)| {
        let (_, found) = base(symbol.strip_prefix(prefix)?)?;
        let prefixed = unit(found.power + power, found.dimension);
        (found.thermal == 0).then_some((prefixed, exponent))
    })
}

/// Superscripts as ordinary signs and digits.
fn plain_digit(letter: char) -> char {
    match letter {
        '⁻' => '-',
        '¹' => '1',
        '²' => '2',
        '³' => '3',
        '⁴' => '4',
        '⁵' => '5',
        '⁶' => '6',
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str, dimension: Dimension) -> Result<f64, QuantityError> {
        quantity(text, dimension, TEMPERATURE)
    }

    /// k_B = 1.380649e-23 J/K by definition: k_B T of 298.15 K is 4.1164049935e-21 J.
    #[test]
    fn thermal_energies_depend_on_the_temperature() {
        let cases = [
            ("1 kT", Dimension::ENERGY, 298.15, 4.116_404_993_5e-3),
            ("20 kBT", Dimension::ENERGY, 298.15, 8.232_809_987e-2),
            ("1 kT", Dimension::ENERGY, 310.15, 4.282_082_873_5e-3),
            ("0.5 kT/nm²", Dimension::TENSION, 298.15, 2_058.202_496_75),
            (
                "2 pN·µm²/kT",
                Dimension::LENGTH,
                298.15,
                2.0 / 4.116_404_993_5e-3,
            ),
        ];
        for (text, dimension, temperature, expected) in cases {
            let found = quantity(text, dimension, temperature).unwrap_or(f64::NAN);
            // Two products and a quotient.
            let rounding = 4.0 * f64::EPSILON * expected;
            assert!((found - expected).abs() <= rounding, "{text}: {found}");
            assert!(is_thermal(text));
        }
        let unknown = QuantityError::UnknownUnit("mkT".into());
        assert_eq!(value("1 mkT", Dimension::ENERGY), Err(unknown));
        assert!(!is_thermal("4 pN µm") && !is_thermal("kT"));
    }

    #[test]
    fn units_convert_to_the_last_bit() {
        let cases = [
            ("2e-19 J", Dimension::ENERGY, 0.2),
            ("5.3 µN/m", Dimension::TENSION, 5.3),
            ("5.3 uN/m", Dimension::TENSION, 5.3),
            ("5.3 μN m^-1", Dimension::TENSION, 5.3),
            ("0.0053 mN/m", Dimension::TENSION, 5.3),
            ("0.0053 dyn/cm", Dimension::TENSION, 5.3),
            ("3.91 µm", Dimension::LENGTH, 3.91),
            ("3910nm", Dimension::LENGTH, 3.91),
            ("0.5 Pa", Dimension::PRESSURE, 0.5),
            ("0.5 pN/µm²", Dimension::PRESSURE, 0.5),
            ("0.5 pN / µm / µm", Dimension::PRESSURE, 0.5),
            ("94 fL", Dimension::VOLUME, 94.0),
            ("94 µm3", Dimension::VOLUME, 94.0),
            ("-0.5 1/µm", Dimension::CURVATURE, -0.5),
            ("0.5 µm⁻¹", Dimension::CURVATURE, 0.5),
            ("30 pN", Dimension::FORCE, 30.0),
            ("2 erg", Dimension::ENERGY, 2e11),
            ("50 kg/m³", Dimension::DENSITY, 5e-11),
            ("9.81 m/s²", Dimension::ACCELERATION, 9.81e6),
            ("0.5 µN·s/m", Dimension::SURFACE_VISCOSITY, 0.5),
            (".5e-6 N*s/m", Dimension::SURFACE_VISCOSITY, 0.5),
            ("1.2 mPa s", Dimension::VISCOSITY, 1.2e-3),
            ("1.2e-3 Pa·s", Dimension::VISCOSITY, 1.2e-3),
            ("1.2e-3 pN s/µm²", Dimension::VISCOSITY, 1.2e-3),
            ("100 1/s", Dimension::RATE, 100.0),
            ("0.1 ms^-1", Dimension::RATE, 100.0),
            ("20 µs", Dimension::TIME, 2e-5),
            ("2 ms", Dimension::TIME, 2e-3),
            ("1.5 mm/s", Dimension::VELOCITY, 1500.0),
            ("2 m/s", Dimension::VELOCITY, 2e6),
            ("15 µm s⁻¹", Dimension::VELOCITY, 15.0),
        ];
        for (text, dimension, expected) in cases {
            assert_eq!(value(text, dimension), Ok(expected), "{text}");
        }
    }

    #[test]
    fn what_is_no_quantity_is_told_apart() {
        let length = Dimension::LENGTH;
        let cases = [
            ("µm", QuantityError::NoNumber),
            ("", QuantityError::NoNumber),
            (".", QuantityError::NoNumber),
            ("3", QuantityError::NoUnit),
            ("3 parsec", QuantityError::UnknownUnit("parsec".into())),
            ("3 µm^", QuantityError::UnknownUnit("µm^".into())),
            ("3 µm/", QuantityError::UnknownUnit("µm/".into())),
            (
                "3 µm^99999999999",
                QuantityError::UnknownUnit("µm^99999999999".into()),
            ),
            ("3 µm^0", QuantityError::UnknownUnit("µm^0".into())),
            ("1e400 µm", QuantityError::TooLarge),
            ("1e99999999999 µm", QuantityError::TooLarge),
            ("3 J", QuantityError::Dimension(Dimension::ENERGY)),
        ];
        for (text, expected) in cases {
            assert_eq!(value(text, length), Err(expected), "{text}");
        }
        assert_eq!(value("1e-99999999999 µm", length), Ok(0.0));
    }

    #[test]
    fn every_example_has_its_dimension() {
        for (dimension, name, example) in Dimension::NAMES {
            if dimension != Dimension::NONE {
                let text = example.trim_matches('"');
                assert!(value(text, dimension).is_ok(), "{name}: {text}");
                let unit = format!("1 {}", dimension.symbol());
                assert_eq!(value(&unit, dimension), Ok(1.0), "{name}: {unit}");
            }
        }
    }
}
