//! Errors against time and mesh, and the cost of evaluations.

use super::curves::{curves, logarithmic, series};
use super::svg::{self, mark};
use super::text::{Table, count, csv_line, escaped, percent, signed, time_of};
use super::{Page, QUANTITIES, Section, called, each, label, style_in};
use super::{answers, costs};
use crate::answer::{Norm, Recommended, seconds};
use crate::picture::{Chart, Numbers, Point};
use crate::scalar::Scalar;
use crate::study::{Quantity, Row};
use crate::verdict::ConvergenceVerdict;
use std::io::{self, Write};

pub(super) fn write(
    page: &Page<'_>,
    recommended: Option<&Recommended<'_>>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let rows = page.rows;
    let families = each(rows.iter().map(|row| row.family));
    writeln!(out, "<section id=\"accuracy\"><h2>Error against time</h2>")?;
    write_choice(
        &[
            ("quantity", "Quantity", quantity_choice(&QUANTITIES)),
            (
                "norm",
                "Error",
                vec![("max", "at every vertex"), ("mean", "on average")],
            ),
            ("family", "Mesh", family_choice(&families)),
        ],
        out,
    )?;
    write_legend(rows, recommended, out)?;
    writeln!(out, "<div class=\"pair\">")?;
    for [kind, heading] in [
        ["time", "Error against time of an evaluation"],
        ["vertices", "Error against the number of vertices"],
    ] {
        writeln!(out, "<figure><figcaption>{heading}</figcaption>")?;
        for variant in variants(&QUANTITIES, &families) {
            let chart = error_chart(rows, recommended, &variant, kind);
            variant.open(out)?;
            if chart.is_empty() {
                writeln!(out, "<p class=\"note\">Nothing was measured here.</p>")?;
            } else {
                svg::write(&chart, &variant.name(&format!("error-{kind}")), false, out)?;
            }
            writeln!(out, "</div>")?;
        }
        writeln!(out, "</figure>")?;
    }
    writeln!(out, "</div>")?;
    for variant in variants(&QUANTITIES, &families) {
        variant.open(out)?;
        let table = error_table(rows, page.verdicts, &variant);
        table.write_folded(&variant.name("errors"), out)?;
        writeln!(out, "</div>")?;
    }
    writeln!(out, "<h2>What an evaluation costs</h2><div class=\"pair\">")?;
    for kind in ["cost", "memory"] {
        writeln!(
            out,
            "<figure><figcaption>{}</figcaption>",
            match kind {
                "cost" => "Time a vertex against the number of vertices",
                _ => "Memory a vertex against the number of vertices",
            }
        )?;
        for &family in &families {
            open_family(family, family != families[0], out)?;
            let chart = costs::chart(rows, recommended, family, kind);
            if chart.is_empty() {
                writeln!(out, "<p class=\"note\">It was not measured.</p>")?;
            } else {
                svg::write(&chart, &format!("{kind}-{family}"), false, out)?;
                costs::table(rows, family, kind)
                    .write_folded(&format!("{kind}-table-{family}"), out)?;
            }
            writeln!(out, "</div>")?;
        }
        writeln!(out, "</figure>")?;
    }
    writeln!(out, "</div></section>")
}

/// One state of the switches.
struct Variant<'a> {
    quantity: Quantity,
    norm: Norm,
    family: &'a str,
    first: bool,
}

fn variants<'a>(quantities: &[Quantity], families: &[&'a str]) -> Vec<Variant<'a>> {
    let mut variants = Vec::new();
    for &quantity in quantities {
        for norm in Norm::ALL {
            for &family in families {
                let first = variants.is_empty();
                variants.push(Variant {
                    quantity,
                    norm,
                    family,
                    first,
                });
            }
        }
    }
    variants
}

impl Variant<'_> {
    fn name(&self, kind: &str) -> String {
        let (quantity, norm) = (self.quantity.symbol(), self.norm.name());
        format!("{kind}-{quantity}-{norm}-{}", self.family)
    }

    fn open(&self, out: &mut dyn Write) -> io::Result<()> {
        let hidden = if self.first { "" } else { " hidden" };
        let (quantity, norm) = (self.quantity.symbol(), self.norm.name());
        let family = self.family;
        writeln!(
            out,
            "<div data-when=\"quantity={quantity} norm={norm} family={family}\"{hidden}>"
        )
    }
}

pub(super) fn open_family(family: &str, hidden: bool, out: &mut dyn Write) -> io::Result<()> {
    let hidden = if hidden { " hidden" } else { "" };
    writeln!(out, "<div data-when=\"family={family}\"{hidden}>")
}

/// Switches of a page: for each the key, the legend, and values with their labels, the first of which is chosen.
type Choices<'a> = [(&'a str, &'a str, Vec<(&'a str, &'a str)>)];

fn write_choice(choices: &Choices<'_>, out: &mut dyn Write) -> io::Result<()> {
    writeln!(
        out,
        "<form class=\"choose\" aria-label=\"What the figures show\">"
    )?;
    for (key, legend, options) in choices {
        write!(out, "<fieldset><legend>{legend}</legend>")?;
        for (number, (value, label)) in options.iter().enumerate() {
            let checked = if number == 0 { " checked" } else { "" };
            write!(
                out,
                "<label><input type=\"radio\" name=\"{key}\" value=\"{value}\"{checked}><span>{label}</span></label>"
            )?;
        }
        writeln!(out, "</fieldset>")?;
    }
    writeln!(out, "</form>")
}

fn quantity_choice(quantities: &[Quantity]) -> Vec<(&'static str, &'static str)> {
    let label = |quantity| match quantity {
        Quantity::Mean => "curvature H",
        Quantity::Gaussian => "curvature K",
        Quantity::LaplacianOfMean => "Laplacian of H",
        Quantity::ForceDensity => "force f",
    };
    let each = quantities.iter();
    each.map(|&quantity| (quantity.symbol(), label(quantity)))
        .collect()
}

fn family_choice<'a>(families: &[&'a str]) -> Vec<(&'a str, &'a str)> {
    families.iter().map(|&family| (family, family)).collect()
}

fn write_legend(
    rows: &[Row],
    recommended: Option<&Recommended<'_>>,
    out: &mut dyn Write,
) -> io::Result<()> {
    writeln!(
        out,
        "<div class=\"legend\" role=\"group\" aria-label=\"Methods shown\">"
    )?;
    for method in each(rows.iter().map(|row| row.method)) {
        let style = style_in(rows, method);
        let [name, what] = [method.title(), method.idea()].map(escaped);
        let [class, taken] = match recommended {
            Some(found) if found.method == method => [" class=\"best\"", ", recommended above"],
            _ => [""; 2],
        };
        writeln!(
            out,
            "<label{class} title=\"{method}\"><input type=\"checkbox\" checked data-method=\"{style}\">{}<b>{}</b> <span>{name}: {what}{taken}</span></label>",
            mark(style),
            label(method),
        )?;
    }
    let scalars = each(rows.iter().map(|row| row.scalar));
    if scalars.contains(&Scalar::F64) && scalars.contains(&Scalar::F32) {
        writeln!(
            out,
            "<p class=\"note\">Full lines: f64; broken lines: f32. Down and to the left is better.</p>"
        )?;
    }
    writeln!(out, "</div>")
}

fn error_chart(
    rows: &[Row],
    recommended: Option<&Recommended<'_>>,
    variant: &Variant<'_>,
    kind: &str,
) -> Chart {
    let norm = variant.norm;
    let point = |row: &Row| {
        let error = norm.of(row);
        let at = match kind {
            "time" => seconds(row),
            _ => row.vertices as f64,
        };
        (error.is_finite() && error > 0.0).then(|| Point {
            at: [at, error],
            note: format!(
                "{} {}, N = {}: {} off{}",
                row.method.label(),
                row.scalar,
                count(row.vertices),
                percent(error),
                match row.is_timed() {
                    true => format!(
                        ", {} an evaluation ({} a vertex)",
                        time_of(row, seconds(row)),
                        time_of(row, 1e-9 * row.ns_per_vertex)
                    ),
                    false => String::new(),
                }
            ),
            bounds: None,
        })
    };
    let (label, numbers) = match kind {
        "time" => ("time of one evaluation", Numbers::Time),
        _ => ("number of vertices N", Numbers::Plain),
    };
    let which = match norm {
        Norm::Max => "largest",
        Norm::Mean => "mean",
    };
    Chart {
        title: format!(
            "{which} error of {} on {} meshes against the {label}",
            variant.quantity.symbol(),
            variant.family
        ),
        axes: [
            logarithmic(label, numbers),
            logarithmic("relative error", Numbers::Share),
        ],
        curves: curves(rows, recommended, (variant.family, variant.quantity), point),
        guides: vec![(0.01, "1 %".to_owned())],
    }
}

/// Errors, times and orders of one state of the switches.
fn error_table(rows: &[Row], verdicts: &[ConvergenceVerdict], variant: &Variant<'_>) -> Table {
    let Variant {
        quantity,
        norm,
        family,
        ..
    } = *variant;
    let series = series(rows, family, quantity);
    let numbers = series
        .iter()
        .flat_map(|(.., rows)| rows.iter().map(|row| row.vertices));
    let mut numbers = each(numbers);
    numbers.sort_unstable();
    let mut head = vec!["method".to_owned()];
    head.extend(
        numbers
            .iter()
            .map(|&number| format!("N = {}", count(number))),
    );
    head.push("order p".to_owned());
    let mut csv = String::new();
    csv_line(
        &mut csv,
        &[
            &"method",
            &"scalar",
            &"family",
            &"quantity",
            &"norm",
            &"vertices",
            &"error",
            &"seconds",
            &"scatter",
        ],
    );
    let mut lines = Vec::new();
    for (method, scalar, rows) in series {
        let mut line = vec![format!("{} {scalar}", label(method))];
        for &number in &numbers {
            let row = rows.iter().find(|row| row.vertices == number);
            line.push(row.map_or("–".to_owned(), |row| {
                csv_line(
                    &mut csv,
                    &[
                        &method,
                        &scalar,
                        &family,
                        &quantity.symbol(),
                        &norm.name(),
                        &number,
                        &norm.of(row),
                        &seconds(row),
                        &row.ns_scatter,
                    ],
                );
                let error = percent(norm.of(row));
                match row.is_timed() {
                    true => format!("{error} <span>{}</span>", time_of(row, seconds(row))),
                    false => error,
                }
            }));
        }
        let same = |verdict: &&ConvergenceVerdict| {
            (verdict.method, verdict.scalar, verdict.quantity) == (method, scalar, quantity)
                && verdict.family == family
        };
        let order = verdicts.iter().find(same).map(|verdict| match norm {
            Norm::Max => verdict.order_max,
            Norm::Mean => verdict.order_mean,
        });
        line.push(order.map_or("–".to_owned(), signed));
        lines.push(line);
    }
    Table {
        caption: format!(
            "{}, {family} meshes, {}: error{}",
            called(quantity),
            match norm {
                Norm::Max => "largest error over the vertices",
                Norm::Mean => "mean error",
            },
            match rows.iter().all(Row::is_timed) {
                true => ", and time of an evaluation",
                false => "",
            }
        ),
        head,
        rows: lines,
        csv,
    }
}

/// The part of a page that shows errors over refinement: the largest beside the mean, for each of these quantities
/// and each mesh family, with their tables. Its switches of quantity and mesh act on the whole page; captions end
/// with `about`.
///
/// # Errors
/// Never: writing to memory does not fail.
pub fn convergence_section(
    rows: &[Row],
    verdicts: &[ConvergenceVerdict],
    quantities: &[Quantity],
    about: &str,
) -> io::Result<Section> {
    let families = each(rows.iter().map(|row| row.family));
    let mut section = Section::default();
    let out = &mut section.html;
    write_choice(
        &[
            ("quantity", "Quantity", quantity_choice(quantities)),
            ("family", "Mesh", family_choice(&families)),
        ],
        out,
    )?;
    write_legend(rows, None, out)?;
    writeln!(out, "<div class=\"pair\">")?;
    for norm in Norm::ALL {
        writeln!(
            out,
            "<figure><figcaption>{} error against the number of vertices <span>{about}</span></figcaption>",
            match norm {
                Norm::Max => "Largest",
                Norm::Mean => "Mean",
            }
        )?;
        let own = variants(quantities, &families).into_iter();
        for (number, variant) in own.filter(|variant| variant.norm == norm).enumerate() {
            let id = variant.name("error-vertices");
            let chart = error_chart(rows, None, &variant, "vertices");
            open_both(variant.quantity, variant.family, number > 0, out)?;
            if chart.is_empty() {
                writeln!(out, "<p class=\"note\">Nothing was measured here.</p>")?;
            } else {
                svg::write(&chart, &id, false, out)?;
                section.charts.push((id, chart));
            }
            error_table(rows, verdicts, &variant).write_folded(&variant.name("errors"), out)?;
            writeln!(out, "</div>")?;
        }
        writeln!(out, "</figure>")?;
    }
    writeln!(out, "</div>")?;
    Ok(section)
}

/// Opens an element that is shown in one state of the switches of quantity and mesh.
///
/// # Errors
/// If `out` cannot be written to.
pub fn open_both(
    quantity: Quantity,
    family: &str,
    hidden: bool,
    out: &mut dyn Write,
) -> io::Result<()> {
    let hidden = if hidden { " hidden" } else { "" };
    let quantity = quantity.symbol();
    writeln!(
        out,
        "<div data-when=\"quantity={quantity} family={family}\"{hidden}>"
    )
}

/// The largest errors of one quantity on one mesh family against the time of an evaluation.
pub(super) fn time_chart(rows: &[Row], quantity: Quantity, family: &str) -> Chart {
    let variant = Variant {
        quantity,
        norm: Norm::Max,
        family,
        first: true,
    };
    error_chart(rows, None, &variant, "time")
}

/// Every figure of this part, by name.
pub(super) fn charts(page: &Page<'_>) -> Vec<(String, Chart)> {
    let families = each(page.rows.iter().map(|row| row.family));
    let recommended = answers::recommended(page.rows);
    let recommended = recommended.as_ref();
    let mut charts = Vec::new();
    for variant in variants(&QUANTITIES, &families) {
        for kind in ["time", "vertices"] {
            let name = variant.name(&format!("error-{kind}"));
            charts.push((name, error_chart(page.rows, recommended, &variant, kind)));
        }
    }
    for family in families {
        for kind in ["cost", "memory"] {
            charts.push((
                format!("{kind}-{family}"),
                costs::chart(page.rows, recommended, family, kind),
            ));
        }
    }
    charts
}
