//! Section of the page about flow: a capsule in shear with every method, and the costs of effects.

use crate::effects::{EffectCost, EffectCosts};
use helfrich_paper::flow::FlowRow;
use helfrich_paper::report::capsule;
use helfrich_std::report::page::Section;
use helfrich_std::report::page::text::{Table, csv_line, digits, escaped, percent, time};
use std::io::{self, Write};

/// Section of a page about a capsule in flow and the costs of its effects.
///
/// # Errors
/// Never: writing to memory does not fail.
pub fn page_section(rows: &[FlowRow], effects: &EffectCosts) -> io::Result<Section> {
    let mut section = capsule::section(rows)?;
    write_effects(effects, &mut section.html)?;
    Ok(section)
}

fn write_effects(costs: &EffectCosts, out: &mut dyn Write) -> io::Result<()> {
    writeln!(
        out,
        "<section id=\"effects\"><h2>What each effect costs</h2><p>The capsule with bending, elasticity, a penalty on its area, a fluid inside that is five times as viscous, and a viscous membrane: \
         {} an evaluation of the velocities. A scene pays only for what it names; here is the same scene without one effect after the other.</p>",
        time(costs.seconds)
    )?;
    let mut csv = String::new();
    csv_line(
        &mut csv,
        &[
            &"effect",
            &"own_seconds",
            &"seconds_with_all",
            &"seconds_without",
            &"evaluations_with_all",
            &"evaluations_without",
        ],
    );
    let line = |cost: &EffectCost| {
        let own = cost.own.map_or(String::new(), |own| own.to_string());
        csv_line(
            &mut csv,
            &[
                &cost.effect,
                &own,
                &costs.seconds,
                &cost.without,
                &costs.evaluations,
                &cost.evaluations_without,
            ],
        );
        vec![
            format!("<code>{}</code>", escaped(&cost.effect)),
            cost.own.map_or("part of the fluid".to_owned(), |own| {
                format!(
                    "{} <span>{}</span>",
                    time(own),
                    percent(own / costs.seconds)
                )
            }),
            time(cost.without),
            format!("×{}", digits(costs.seconds / cost.without)),
            cost.evaluations_without.to_string(),
        ]
    };
    Table {
        caption: format!(
            "Own time in an evaluation, with its share; an evaluation without the effect; how many evaluations the same strain takes ({} with all)",
            costs.evaluations
        ),
        head: ["effect", "its own time", "evaluation without it", "with all over without", "evaluations without it"].map(str::to_owned).to_vec(),
        rows: costs.effects.iter().map(line).collect(),
        csv,
    }
    .write("effect-costs", out)?;
    writeln!(out, "</section>")
}
