//! Errors against time and mesh, what evaluations cost, verdicts, pictures, number types.

use super::chart::{Axis, Chart, Curve, Point, Scale, mark};
use super::text::{Table, bytes, count, csv_line, escaped, percent, target, time};
use super::{Page, QUANTITIES, about, called, each, short, style_of};
use crate::answer::{Norm, seconds};
use crate::method::BendingMethod;
use crate::picture::{ColourMap, Colouring, PaintedSurface, Picture, Shading, View};
use crate::scalar::Scalar;
use crate::study::{Quantity, Row};
use crate::verdict::Verdict;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use helfrich::Surface;
use std::io::{self, Write};

/// Errors of f32 up to so many times those of f64 are as good.
const AS_GOOD: f64 = 1.5;

/// Common logarithms of the errors that the ends of the pictures' colours stand for.
const COLOURS: [f64; 2] = [-4.0, 1.0];

pub(super) fn write(page: &Page<'_>, out: &mut dyn Write) -> io::Result<()> {
    let rows = page.rows;
    let families = each(rows.iter().map(|row| row.family));
    writeln!(out, "<section id=\"accuracy\"><h2>Error against time</h2>")?;
    write_choice(&families, out)?;
    write_legend(rows, out)?;
    writeln!(out, "<div class=\"pair\">")?;
    for [kind, heading] in [
        ["time", "Error against time of an evaluation"],
        ["vertices", "Error against the number of vertices"],
    ] {
        writeln!(out, "<figure><figcaption>{heading}</figcaption>")?;
        for variant in variants(&families) {
            let chart = error_chart(rows, &variant, kind);
            variant.open(out)?;
            if chart.is_empty() {
                writeln!(out, "<p class=\"note\">Nothing was measured here.</p>")?;
            } else {
                chart.write_svg(&variant.name(&format!("error-{kind}")), false, out)?;
            }
            writeln!(out, "</div>")?;
        }
        writeln!(out, "</figure>")?;
    }
    writeln!(out, "</div>")?;
    for variant in variants(&families) {
        variant.open(out)?;
        error_table(page, &variant).write_folded(&variant.name("errors"), out)?;
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
            let chart = cost_chart(rows, family, kind);
            if chart.is_empty() {
                writeln!(out, "<p class=\"note\">It was not measured.</p>")?;
            } else {
                chart.write_svg(&format!("{kind}-{family}"), false, out)?;
                cost_table(rows, family, kind)
                    .write_folded(&format!("{kind}-table-{family}"), out)?;
            }
            writeln!(out, "</div>")?;
        }
        writeln!(out, "</figure>")?;
    }
    writeln!(out, "</div></section>")?;
    write_verdicts(page.verdicts, out)?;
    write_pictures(page, out)?;
    write_precisions(rows, &families, out)
}

/// One state of the switches.
struct Variant<'a> {
    quantity: Quantity,
    norm: Norm,
    family: &'a str,
    first: bool,
}

fn variants<'a>(families: &[&'a str]) -> Vec<Variant<'a>> {
    let mut variants = Vec::new();
    for quantity in QUANTITIES {
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

fn open_family(family: &str, hidden: bool, out: &mut dyn Write) -> io::Result<()> {
    let hidden = if hidden { " hidden" } else { "" };
    writeln!(out, "<div data-when=\"family={family}\"{hidden}>")
}

fn write_choice(families: &[&str], out: &mut dyn Write) -> io::Result<()> {
    writeln!(
        out,
        "<form class=\"choose\" aria-label=\"What the figures show\">"
    )?;
    let mut group = |key: &str, legend: &str, options: &[(&str, &str)]| -> io::Result<()> {
        write!(out, "<fieldset><legend>{legend}</legend>")?;
        for (number, (value, label)) in options.iter().enumerate() {
            let checked = if number == 0 { " checked" } else { "" };
            write!(
                out,
                "<label><input type=\"radio\" name=\"{key}\" value=\"{value}\"{checked}><span>{label}</span></label>"
            )?;
        }
        writeln!(out, "</fieldset>")
    };
    group(
        "quantity",
        "Quantity",
        &[("f", "force f"), ("H", "curvature H")],
    )?;
    group(
        "norm",
        "Error",
        &[("max", "at every vertex"), ("mean", "on average")],
    )?;
    let families = families.iter().map(|&family| (family, family));
    group("family", "Mesh", &Vec::from_iter(families))?;
    writeln!(out, "</form>")
}

fn write_legend(rows: &[Row], out: &mut dyn Write) -> io::Result<()> {
    writeln!(
        out,
        "<div class=\"legend\" role=\"group\" aria-label=\"Methods shown\">"
    )?;
    for method in each(rows.iter().map(|row| row.method)) {
        let style = style_of(method);
        let [name, what] = about(method);
        writeln!(
            out,
            "<label title=\"{method}\"><input type=\"checkbox\" checked data-method=\"{style}\">{}<b>{}</b> <span>{name}: {what}</span></label>",
            mark(style),
            short(method),
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

/// The series of one method in one number type on one family, coarse to fine.
fn series<'a>(
    rows: &'a [Row],
    family: &str,
    quantity: Quantity,
) -> Vec<(BendingMethod, Scalar, Vec<&'a Row>)> {
    let rows = rows
        .iter()
        .filter(|row| row.family == family && row.quantity == quantity);
    let rows = Vec::from_iter(rows);
    let kinds = each(rows.iter().map(|row| (row.method, row.scalar)));
    let of = |(method, scalar)| {
        let own = rows.iter().copied();
        let own = own.filter(|row| (row.method, row.scalar) == (method, scalar));
        let mut own = Vec::from_iter(own);
        own.sort_by_key(|row| row.vertices);
        (method, scalar, own)
    };
    kinds.into_iter().map(of).collect()
}

/// A curve for each method and number type; pairs of f32 have their own section.
fn curves(
    rows: &[Row],
    family: &str,
    quantity: Quantity,
    point: impl Fn(&Row) -> Option<Point>,
) -> Vec<Curve> {
    let series = series(rows, family, quantity).into_iter();
    let series = series.filter(|(_, scalar, _)| *scalar != Scalar::F32Pair);
    let both = each(rows.iter().map(|row| row.scalar)).contains(&Scalar::F64);
    let curves = series.map(|(method, scalar, rows)| Curve {
        name: format!("{method} {scalar}"),
        style: style_of(method),
        dashed: scalar == Scalar::F32,
        marked: true,
        label: if scalar == Scalar::F64 || !both {
            short(method).to_owned()
        } else {
            String::new()
        },
        points: rows.into_iter().filter_map(&point).collect(),
    });
    let mut curves = Vec::from_iter(curves);
    // Full lines over broken ones.
    curves.sort_by_key(|curve| !curve.dashed);
    curves
}

fn error_chart(rows: &[Row], variant: &Variant<'_>, kind: &str) -> Chart {
    let norm = variant.norm;
    let point = |row: &Row| {
        let error = norm.of(row);
        let at = match kind {
            "time" => seconds(row),
            _ => row.vertices as f64,
        };
        (error.is_finite() && error > 0.0).then(|| Point {
            at: [at, error],
            says: format!(
                "{} {}, N = {}: {} off, {} an evaluation ({} a vertex)",
                short(row.method),
                row.scalar,
                count(row.vertices),
                percent(error),
                time(seconds(row)),
                time(1e-9 * row.ns_per_vertex),
            ),
        })
    };
    let (label, scale) = match kind {
        "time" => ("time of one evaluation", Scale::Time),
        _ => ("number of vertices N", Scale::Count),
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
            Axis { label, scale },
            Axis {
                label: "relative error",
                scale: Scale::Share,
            },
        ],
        curves: curves(rows, variant.family, variant.quantity, point),
        guides: vec![(0.01, "1 %".to_owned())],
    }
}

/// Errors, times and orders of one state of the switches.
fn error_table(page: &Page<'_>, variant: &Variant<'_>) -> Table {
    let Variant {
        quantity,
        norm,
        family,
        ..
    } = *variant;
    let series = series(page.rows, family, quantity);
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
        ],
    );
    let mut lines = Vec::new();
    for (method, scalar, rows) in series {
        let mut line = vec![format!("{} {scalar}", short(method))];
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
                    ],
                );
                format!(
                    "{} <span>{}</span>",
                    percent(norm.of(row)),
                    time(seconds(row))
                )
            }));
        }
        let same = |verdict: &&Verdict| {
            (verdict.method, verdict.scalar, verdict.quantity) == (method, scalar, quantity)
                && verdict.family == family
        };
        let order = page.verdicts.iter().find(same).map(|verdict| match norm {
            Norm::Max => verdict.order_max,
            Norm::Mean => verdict.order_mean,
        });
        line.push(order.map_or("–".to_owned(), signed));
        lines.push(line);
    }
    Table {
        caption: format!(
            "{}, {family} meshes, {}: error, and time of an evaluation",
            called(quantity),
            match norm {
                Norm::Max => "largest error over the vertices",
                Norm::Mean => "mean error",
            }
        ),
        head,
        rows: lines,
        csv,
    }
}

fn signed(order: f64) -> String {
    if order.is_finite() {
        format!("{order:+.1}").replace('-', "−")
    } else {
        "–".to_owned()
    }
}

/// What a row costs: time, or memory if it was measured.
fn cost(row: &Row, kind: &str) -> Option<f64> {
    match kind {
        "cost" => Some(1e-9 * row.ns_per_vertex),
        _ => row.bytes_per_vertex,
    }
}

fn in_words(cost: f64, kind: &str) -> String {
    match kind {
        "cost" => time(cost),
        _ => bytes(cost),
    }
}

fn cost_chart(rows: &[Row], family: &str, kind: &str) -> Chart {
    let (label, scale) = match kind {
        "cost" => ("time a vertex", Scale::Time),
        _ => ("memory a vertex", Scale::Bytes),
    };
    let point = |row: &Row| {
        let cost = cost(row, kind).filter(|cost| *cost > 0.0)?;
        Some(Point {
            at: [row.vertices as f64, cost],
            says: format!(
                "{} {}, N = {}: {} a vertex",
                short(row.method),
                row.scalar,
                count(row.vertices),
                in_words(cost, kind)
            ),
        })
    };
    Chart {
        title: format!("{label} against the number of vertices, {family} meshes"),
        axes: [
            Axis {
                label: "number of vertices N",
                scale: Scale::Count,
            },
            Axis { label, scale },
        ],
        // Of f, which every method has.
        curves: curves(rows, family, Quantity::ForceDensity, point),
        guides: Vec::new(),
    }
}

fn cost_table(rows: &[Row], family: &str, kind: &str) -> Table {
    let series = series(rows, family, Quantity::ForceDensity);
    let mut numbers = each(
        series
            .iter()
            .flat_map(|(.., rows)| rows.iter().map(|row| row.vertices)),
    );
    numbers.sort_unstable();
    let mut head = vec!["method".to_owned()];
    head.extend(
        numbers
            .iter()
            .map(|&number| format!("N = {}", count(number))),
    );
    let mut csv = String::new();
    let unit = match kind {
        "cost" => "seconds_per_vertex",
        _ => "bytes_per_vertex",
    };
    csv_line(
        &mut csv,
        &[&"method", &"scalar", &"family", &"vertices", &unit],
    );
    let mut lines = Vec::new();
    for (method, scalar, rows) in series {
        let mut line = vec![format!("{} {scalar}", short(method))];
        for &number in &numbers {
            let row = rows.iter().find(|row| row.vertices == number);
            let cost = row.and_then(|row| cost(row, kind));
            line.push(cost.map_or("–".to_owned(), |cost| {
                csv_line(&mut csv, &[&method, &scalar, &family, &number, &cost]);
                in_words(cost, kind)
            }));
        }
        lines.push(line);
    }
    Table {
        caption: format!("A vertex, {family} meshes"),
        head,
        rows: lines,
        csv,
    }
}

/// Every figure of this part, by name.
pub(super) fn charts(page: &Page<'_>) -> Vec<(String, Chart)> {
    let families = each(page.rows.iter().map(|row| row.family));
    let mut charts = Vec::new();
    for variant in variants(&families) {
        for kind in ["time", "vertices"] {
            let name = variant.name(&format!("error-{kind}"));
            charts.push((name, error_chart(page.rows, &variant, kind)));
        }
    }
    for family in families {
        for kind in ["cost", "memory"] {
            charts.push((
                format!("{kind}-{family}"),
                cost_chart(page.rows, family, kind),
            ));
        }
    }
    charts
}

fn write_verdicts(verdicts: &[Verdict], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "<section id=\"verdicts\"><h2>Does it converge?</h2>")?;
    if verdicts.is_empty() {
        return writeln!(
            out,
            "<p class=\"note\">It takes two meshes or more to say.</p></section>"
        );
    }
    writeln!(
        out,
        "<p>What a finer mesh does to the error, with the orders p of the largest and of the mean error over the three finest meshes. \
         Largest p ≥ ½: <b>converges</b>, at all vertices; else mean p ≥ ½: <b>in the mean</b>; else largest p &lt; −½: <b>diverges</b>; else <b>stalls</b>.</p>"
    )?;
    for family in each(verdicts.iter().map(|verdict| verdict.family)) {
        let own = verdicts.iter().filter(|verdict| verdict.family == family);
        let own = Vec::from_iter(own.filter(|verdict| verdict.scalar == Scalar::F64));
        if own.is_empty() {
            continue;
        }
        let mut csv = String::new();
        csv_line(
            &mut csv,
            &[
                &"family",
                &"method",
                &"quantity",
                &"verdict",
                &"order_max",
                &"order_mean",
            ],
        );
        let mut lines = Vec::new();
        for method in each(own.iter().map(|verdict| verdict.method)) {
            let mut line = vec![format!(
                "{} <span>{}</span>",
                short(method),
                about(method)[0]
            )];
            for quantity in Quantity::ALL {
                let verdict = own
                    .iter()
                    .find(|verdict| (verdict.method, verdict.quantity) == (method, quantity));
                line.push(verdict.map_or("–".to_owned(), |verdict| {
                    csv_line(
                        &mut csv,
                        &[
                            &family,
                            &method,
                            &quantity.symbol(),
                            &verdict.convergence,
                            &verdict.order_max,
                            &verdict.order_mean,
                        ],
                    );
                    let word = verdict.convergence.to_string();
                    format!(
                        "<b class=\"v-{}\">{word}</b> <span>{}, {}</span>",
                        word.replace(' ', "-"),
                        signed(verdict.order_max),
                        signed(verdict.order_mean)
                    )
                }));
            }
            lines.push(line);
        }
        Table {
            caption: format!(
                "{family} meshes, f64: verdict, and p of the largest and the mean error"
            ),
            head: ["method", "H", "K", "Δ<sub>S</sub>H", "f"]
                .map(str::to_owned)
                .to_vec(),
            rows: lines,
            csv,
        }
        .write(&format!("verdicts-{family}"), out)?;
    }
    writeln!(out, "</section>")
}

/// The surface coloured by each method's error, as PNG, by name.
pub(super) fn pictures(page: &Page<'_>) -> io::Result<Vec<(String, Vec<u8>)>> {
    let mut pictures = Vec::new();
    for fields in page.errors {
        let mesh = &fields.mesh;
        let surface = Surface::new(&mesh.mesh, &mesh.positions).map_err(io::Error::other)?;
        for (method, errors) in &fields.methods {
            // No error at all is below every colour, and not without one.
            let field = errors.iter().map(|&error| error.log10().clamp(-99.0, 99.0));
            let field = Vec::from_iter(field);
            let surfaces = [PaintedSurface {
                surface,
                field: Some(&field),
                shading: Shading::Smooth,
                edges: false,
            }];
            let picture = Picture {
                size: [420, 280],
                title: "",
                surfaces: &surfaces,
                colours: Colouring {
                    label: "log10 error",
                    range: Some(COLOURS),
                    map: ColourMap::Sequential,
                },
                view: View::default(),
                length_unit: None,
            };
            let canvas = picture.draw().map_err(io::Error::other)?;
            let mut png = Vec::new();
            canvas.encode_png(&mut png)?;
            pictures.push((format!("surface-{}-{method}", fields.family), png));
        }
    }
    Ok(pictures)
}

fn write_pictures(page: &Page<'_>, out: &mut dyn Write) -> io::Result<()> {
    let Some(first) = page.errors.first() else {
        return Ok(());
    };
    let [low, high] = COLOURS.map(|exponent| target(10f64.powf(exponent)));
    writeln!(
        out,
        "<section id=\"pictures\"><h2>Where it is off</h2><p>The error of the {} at N = {}, every method on the same colours: \
         from {low} (dark) to {high} (light) of the largest exact value.</p>",
        called(first.quantity),
        count(first.mesh.mesh.vertex_count()),
    )?;
    let pictures = pictures(page)?;
    let mut pictures = pictures.iter();
    for (number, fields) in page.errors.iter().enumerate() {
        open_family(fields.family.name(), number > 0, out)?;
        writeln!(out, "<div class=\"gallery\">")?;
        for (method, errors) in &fields.methods {
            let Some((_, png)) = pictures.next() else {
                break;
            };
            let worst = errors.iter().copied().fold(0.0, f64::max);
            writeln!(
                out,
                "<figure><img loading=\"lazy\" width=\"420\" height=\"280\" alt=\"{}: largest error {}\" src=\"data:image/png;base64,{}\"><figcaption><b>{}</b> {}; worst {}</figcaption></figure>",
                escaped(method.name()),
                percent(worst),
                STANDARD.encode(png),
                short(*method),
                about(*method)[0],
                percent(worst),
            )?;
        }
        writeln!(out, "</div></div>")?;
    }
    writeln!(out, "</section>")
}

/// Errors of f32 over those of f64, and times of f64 over those of f32.
fn write_precisions(rows: &[Row], families: &[&str], out: &mut dyn Write) -> io::Result<()> {
    let scalars = each(rows.iter().map(|row| row.scalar));
    let single = scalars.iter().filter(|&&scalar| scalar != Scalar::F64);
    let single = Vec::from_iter(single.copied());
    writeln!(out, "<section id=\"precision\"><h2>Is f32 enough?</h2>")?;
    if single.is_empty() || !scalars.contains(&Scalar::F64) {
        return writeln!(
            out,
            "<p class=\"note\">Only one number type was studied.</p></section>"
        );
    }
    writeln!(
        out,
        "<p>The largest error in f32 over that in f64, and how much longer f64 takes. Up to ×{AS_GOOD} f32 is enough: the method is further off than its rounding. \
         Where it is not, it is the storage of positions that hurts; <code>f32-pair</code> keeps them in pairs of f32 and computes in f32.</p>"
    )?;
    for &family in families {
        for quantity in QUANTITIES {
            let [hidden, symbol] = [
                if family == families[0] && quantity == QUANTITIES[0] {
                    ""
                } else {
                    " hidden"
                },
                quantity.symbol(),
            ];
            writeln!(
                out,
                "<div data-when=\"quantity={symbol} family={family}\"{hidden}>"
            )?;
            precision_table(rows, family, quantity, &single)
                .write(&format!("precision-{symbol}-{family}"), out)?;
            writeln!(out, "</div>")?;
        }
    }
    writeln!(out, "</section>")
}

fn precision_table(rows: &[Row], family: &str, quantity: Quantity, single: &[Scalar]) -> Table {
    let all = series(rows, family, quantity);
    let mut numbers = each(
        all.iter()
            .flat_map(|(.., rows)| rows.iter().map(|row| row.vertices)),
    );
    numbers.sort_unstable();
    let mut head = vec!["method".to_owned()];
    head.extend(
        numbers
            .iter()
            .map(|&number| format!("N = {}", count(number))),
    );
    let mut csv = String::new();
    csv_line(
        &mut csv,
        &[
            &"method",
            &"scalar",
            &"family",
            &"quantity",
            &"vertices",
            &"error_over_f64",
            &"time_of_f64_over",
        ],
    );
    let mut lines = Vec::new();
    for method in each(all.iter().map(|(method, ..)| *method)) {
        let of = |scalar: Scalar| {
            let own = all
                .iter()
                .find(|series| (series.0, series.1) == (method, scalar));
            own.map_or(&[][..], |series| &series.2)
        };
        for &scalar in single {
            let mut line = vec![format!("{} {scalar}", short(method))];
            for &number in &numbers {
                let at = |scalar| of(scalar).iter().find(|row| row.vertices == number);
                let pair = at(scalar).zip(at(Scalar::F64));
                line.push(pair.map_or("–".to_owned(), |(single, double)| {
                    let error = single.max / double.max;
                    let faster = double.ns_per_vertex / single.ns_per_vertex;
                    csv_line(
                        &mut csv,
                        &[
                            &method,
                            &scalar,
                            &family,
                            &quantity.symbol(),
                            &number,
                            &error,
                            &faster,
                        ],
                    );
                    let (class, word) = if error <= AS_GOOD {
                        ("yes", "✓")
                    } else {
                        ("no", "✗")
                    };
                    format!(
                        "<b class=\"{class}\">{word} ×{}</b> <span>f64 takes ×{faster:.1}</span>",
                        super::text::digits(error)
                    )
                }));
            }
            lines.push(line);
        }
    }
    Table {
        caption: format!(
            "{}, {family} meshes: error over that of f64 (✓ up to ×{AS_GOOD}), and time of f64 over its own",
            called(quantity)
        ),
        head,
        rows: lines,
        csv,
    }
}
