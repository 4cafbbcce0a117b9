//! Costs of effects, for the terminal.

use crate::effects::EffectCosts;
use std::io::{self, Write};

/// Writes the costs as text, a line for each effect.
///
/// # Errors
/// If `out` cannot be written to.
pub fn effect_table(costs: &EffectCosts, out: &mut dyn Write) -> io::Result<()> {
    writeln!(
        out,
        "A capsule in shear flow with all of these effects: {:.2e} s an evaluation of the velocities, \
         {} evaluations.",
        costs.seconds, costs.evaluations
    )?;
    writeln!(
        out,
        "Own: time of the effect itself, s. Without: an evaluation of the scene without it, s; then \
         how many evaluations the same strain takes."
    )?;
    writeln!(
        out,
        "\n{:20} {:>9} {:>9} {:>12}",
        "effect", "own", "without", "evaluations"
    )?;
    writeln!(out, "{}", "─".repeat(53))?;
    for cost in &costs.effects {
        let own = cost.own.map_or("–".to_owned(), |own| format!("{own:.2e}"));
        writeln!(
            out,
            "{:20} {own:>9} {:>9.2e} {:>12}",
            cost.effect, cost.without, cost.evaluations_without
        )?;
    }
    Ok(())
}
