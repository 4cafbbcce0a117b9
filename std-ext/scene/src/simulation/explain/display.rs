//! An explanation as text.

use super::{Active, Explanation, LatticeExplanation, SurfaceExplanation};
use crate::scene::{Group, Parameter, UnitSystem};
use std::fmt;

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.title.is_empty() {
            writeln!(f, "{}", self.title)?;
        }
        let units = match self.units {
            UnitSystem::Micro => "µm, pN, s",
            UnitSystem::None => "none",
        };
        writeln!(f, "units: {units}")?;
        if let Some([kelvin, energy]) = self.temperature {
            let energy = digits(energy);
            writeln!(f, "kT: {energy} pN·µm, at {kelvin} K")?;
        }
        for surface in &self.surfaces {
            write!(f, "{surface}")?;
        }
        if !self.interactions.is_empty() {
            writeln!(f, "\ninteractions")?;
            for interaction in &self.interactions {
                writeln!(f, "  {interaction}")?;
            }
        }
        writeln!(f, "\ndriver\n  {}", self.driver)?;
        for part in self.flow.iter().chain(&self.integrator) {
            writeln!(f, "  {part}")?;
        }
        if let Some(LatticeExplanation {
            lattice, groups, ..
        }) = &self.lattice
        {
            writeln!(f, "  {lattice}")?;
            for group in groups {
                writeln!(f, "    {group}")?;
            }
        }
        if let Some(rheology) = &self.rheology {
            writeln!(f, "  {rheology}")?;
        }
        writeln!(f, "  step limit          {}", self.step_limit)?;
        // Rounded up to megabytes, because the estimate is not more accurate.
        let megabytes = self.memory.div_ceil(1_000_000);
        writeln!(f, "  memory              about {megabytes} MB")?;
        if let Some(LatticeExplanation {
            steps,
            throughput,
            coupling,
            minutes,
            ..
        }) = &self.lattice
        {
            let minutes = match minutes.ceil() {
                1.0 => "a minute".to_owned(),
                minutes => format!("{minutes} minutes"),
            };
            let updates = digits((throughput / 1e5).round() / 10.0);
            writeln!(
                f,
                "  time                about {minutes}: {steps} steps, with {updates} million nodes a \
                 second and {} ms a step for all vertices, as on a small lattice just now",
                digits((1e5 * coupling).round() / 100.0)
            )?;
        }
        Ok(())
    }
}

impl fmt::Display for Group {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            name,
            formula,
            value,
        } = self;
        write!(f, "{name:38} {:>10}  {formula}", digits(*value))
    }
}

impl fmt::Display for SurfaceExplanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            name,
            count,
            mesh,
            vertices,
            ..
        } = self;
        match count {
            1 => writeln!(f, "\nsurface {name}: {mesh}, {vertices} vertices")?,
            _ => writeln!(
                f,
                "\npopulation {name}: {count} surfaces, each {mesh}, {vertices} vertices"
            )?,
        }
        let measures = Vec::from_iter(self.measures.iter().map(Parameter::to_string));
        writeln!(f, "  {}", measures.join(", "))?;
        for effect in &self.on {
            writeln!(f, "  {effect}")?;
        }
        if self.on.is_empty() {
            writeln!(f, "  nothing acts on it")?;
        }
        if !self.off.is_empty() {
            writeln!(f, "  off: {}", self.off.join(", "))?;
        }
        if !self.groups.is_empty() {
            writeln!(f, "  dimensionless groups")?;
        }
        for group in &self.groups {
            writeln!(f, "    {group}")?;
        }
        for note in &self.notes {
            writeln!(f, "    {note}")?;
        }
        match self.bending_cost {
            Some(1.0) => writeln!(f, "  cost: bending by method B, one of the two fastest"),
            Some(cost) => writeln!(
                f,
                "  cost: bending takes about {cost} times as long as by method B"
            ),
            None => Ok(()),
        }
    }
}

impl fmt::Display for Active {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:19} {}", self.name, self.choice)?;
        let parameters = Vec::from_iter(self.parameters.iter().map(Parameter::to_string));
        let separator = if self.choice.is_empty() || parameters.is_empty() {
            ""
        } else {
            "; "
        };
        write!(f, "{separator}{}", parameters.join(", "))
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, value, unit } = self;
        let space = if unit.is_empty() { "" } else { " " };
        write!(f, "{name} = {}{space}{unit}", digits(*value))
    }
}

/// Five digits, with a power of ten where zeros would hide them.
fn digits(value: f64) -> String {
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
        let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(value);
        rounded.to_string()
    } else {
        format!("{value:.4e}")
    }
}
