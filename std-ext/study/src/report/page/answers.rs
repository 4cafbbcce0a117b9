//! The cheapest method for each accuracy.

use super::svg::style_class;
use super::text::{Table, count, csv_line, escaped, significant, target, time_of};
use super::{Page, QUANTITIES, TARGETS, called, each, label};
use crate::answer::{Norm, Question, Recommended, cheapest, most_accurate, seconds};
use crate::report::SCATTERED;
use crate::study::Row;
use std::io::{self, Write};

/// The accuracy that the text discusses; the tables have all of them.
const PLAIN: f64 = 0.01;

/// The recommended method, if one has H and f within 1 % on all meshes.
pub(super) fn recommended(rows: &[Row]) -> Option<Recommended<'_>> {
    Recommended::of(rows, &QUANTITIES, PLAIN)
}

pub(super) fn write(
    page: &Page<'_>,
    recommended: Option<&Recommended<'_>>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let families = each(page.rows.iter().map(|row| row.family));
    // Every time takes part in the choice.
    let busy = match page.rows.iter().any(Row::is_scattered) {
        true => format!("<abbr title=\"the machine had other work\">{SCATTERED}</abbr> "),
        false => String::new(),
    };
    writeln!(
        out,
        "<section id=\"answer\"><h2>{busy}Which method for 1 %?</h2><div class=\"answer\">"
    )?;
    write_recommended(recommended, &families, out)?;
    if !busy.is_empty() {
        writeln!(out, "<p class=\"note\">{}</p>", page.about_scatter())?;
    }
    writeln!(
        out,
        "<div class=\"scroll\"><table class=\"plain\"><thead><tr><th scope=\"col\">cheapest for {} of</th><th scope=\"col\">at every vertex</th><th scope=\"col\">on average</th></tr></thead><tbody>",
        target(PLAIN)
    )?;
    for quantity in QUANTITIES {
        for family in &families {
            let [strict, mean] = Norm::ALL.map(|norm| {
                let question = Question {
                    family,
                    quantity,
                    norm,
                    target: PLAIN,
                    method: None,
                };
                cell(page.rows, &question)
            });
            writeln!(
                out,
                "<tr><th scope=\"row\">{}, {family} mesh</th><td>{strict}</td><td>{mean}</td></tr>",
                called(quantity)
            )?;
        }
    }
    writeln!(
        out,
        "</tbody></table></div></div><p class=\"note\"><b>H</b> says how strongly the membrane is curved at a point, <b>f</b> with which force per area it resists: \
         a fourth derivative of the surface, and by far the harder of the two. <b>N</b> is the number of vertices of the mesh. \
         On a <b>regular</b> mesh nearly all vertices have six neighbours; an <b>irregular</b> one has them as they come. \
         “Every vertex” asks for the accuracy at the worst of them, “on average” forgives a few. \
         The cheapest is the method with the shortest evaluation among all that was measured; one whose error grows again on finer meshes does not count.</p>"
    )?;
    for norm in Norm::ALL {
        let table = table(page.rows, &families, norm);
        table.write(&format!("cheapest-{}", norm.name()), out)?;
    }
    writeln!(out, "</section>")
}

/// One method for H and f on all meshes, if there is one.
fn write_recommended(
    recommended: Option<&Recommended<'_>>,
    families: &[&str],
    out: &mut dyn Write,
) -> io::Result<()> {
    let kinds = families.join(" and ");
    let Some((found, largest)) = recommended.and_then(|found| Some((found, found.largest()?)))
    else {
        return writeln!(
            out,
            "<p class=\"big\">No method that was studied has both H and f within 1 %, even on average, on {kinds} meshes of these sizes.</p>"
        );
    };
    let Recommended { method, norm, .. } = found;
    let only = match norm {
        Norm::Max => "",
        Norm::Mean => " (None does at every vertex, on meshes of these sizes.)",
    };
    writeln!(
        out,
        "<p class=\"big\">Take <b>{}</b>, {} (<code>{method}</code>): it has curvature H and force f within 1 % {}, on {kinds} meshes, \
         from N = {} on, and takes {} an evaluation there.{only}</p>",
        label(*method),
        escaped(method.idea()),
        norm.in_words(),
        count(largest.vertices),
        time_of(largest, seconds(largest)),
    )
}

/// The cheapest method or, if none reaches the target, the smallest error.
fn cell(rows: &[Row], question: &Question<'_>) -> String {
    match (cheapest(rows, question), most_accurate(rows, question)) {
        (Some(row), _) => format!(
            "<b class=\"{}\">{}</b> <span>N = {}</span> <span>{}</span> <span>{}</span>",
            style_class(super::style_in(rows, row.method)),
            label(row.method),
            count(row.vertices),
            row.scalar,
            time_of(row, seconds(row)),
        ),
        (None, Some(row)) => format!(
            "<span class=\"none\">none; {} has {} % at N = {}</span>",
            label(row.method),
            significant(100.0 * question.norm.of(row), 3),
            count(row.vertices)
        ),
        (None, None) => "–".to_owned(),
    }
}

/// A table with a row for each target, and columns for quantities and families.
fn table(rows: &[Row], families: &[&str], norm: Norm) -> Table {
    let mut head = vec!["error at most".to_owned()];
    let columns = QUANTITIES
        .iter()
        .flat_map(|&quantity| families.iter().map(move |&family| (quantity, family)));
    let columns = Vec::from_iter(columns);
    head.extend(
        columns
            .iter()
            .map(|(quantity, family)| format!("{}, {family}", quantity.symbol())),
    );
    let mut csv = String::new();
    csv_line(
        &mut csv,
        &[
            &"target",
            &"quantity",
            &"family",
            &"norm",
            &"reached",
            &"method",
            &"scalar",
            &"vertices",
            &"error",
            &"seconds",
            &"scatter",
        ],
    );
    let mut lines = Vec::new();
    for error in TARGETS {
        let mut line = vec![target(error)];
        for &(quantity, family) in &columns {
            let question = Question {
                family,
                quantity,
                norm,
                target: error,
                method: None,
            };
            let found = cheapest(rows, &question);
            let nearest = most_accurate(rows, &question);
            if let Some(row) = found.or(nearest) {
                csv_line(
                    &mut csv,
                    &[
                        &error,
                        &quantity.symbol(),
                        &family,
                        &norm.name(),
                        &found.is_some(),
                        &row.method,
                        &row.scalar,
                        &row.vertices,
                        &norm.of(row),
                        &seconds(row),
                        &row.ns_scatter,
                    ],
                );
            }
            line.push(cell(rows, &question));
        }
        lines.push(line);
    }
    Table {
        caption: format!(
            "The cheapest method that was measured, error {}: mesh, number type, time of an evaluation",
            norm.in_words()
        ),
        head,
        rows: lines,
        csv,
    }
}
