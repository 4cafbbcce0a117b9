//! The page of a study: one HTML file that opens from disk and needs no network.
//!
//! Every number and every statement follows from measured rows. The page is complete without its
//! script, which only switches views and shows details.

mod accuracy;
mod answers;
mod costs;
mod curves;
mod pictures;
mod precision;
pub mod svg;
pub mod text;
mod verdicts;

pub use accuracy::{convergence_section, open_both};
pub use precision::precision_section;
pub use verdicts::write as verdict_section;

use crate::answer::each;
use crate::io::replace_file;
use crate::method::{AnyMethod, BendingMethod};
use crate::picture::Chart;
use crate::png;
use crate::provenance::{Build, Provenance, date};
use crate::report::SCATTERED;
use crate::study::{ErrorFields, MOST_SCATTER, Quantity, Row};
use crate::verdict::ConvergenceVerdict;
use std::io::{self, Write};
use std::path::Path;
use std::time::SystemTime;
use svg::COLOURS;
use text::escaped;

/// The content of a page.
#[derive(Clone, Copy, Debug)]
pub struct Page<'a> {
    /// Accuracy and cost of every method.
    pub rows: &'a [Row],
    /// Their convergence.
    pub verdicts: &'a [ConvergenceVerdict],
    /// Maps of their errors; drawn with the feature `pictures` only.
    pub errors: &'a [ErrorFields],
    /// Further parts with measurements of other programs.
    pub sections: &'a [Section],
    /// Program and machine.
    pub provenance: &'a Provenance,
    /// The command line.
    pub command: &'a str,
    /// The time of creation.
    pub when: SystemTime,
    /// Number of measurements from earlier runs of the same program on the same machine.
    pub reused: usize,
}

/// A part of a page, after those of the study.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// HTML with embedded figures: one or several elements `section`.
    pub html: Vec<u8>,
    /// The figures by name, for separate files.
    pub charts: Vec<(String, Chart)>,
}

/// Width and height of figures in pixels.
const FIGURE_SIZE: [u32; 2] = [1200, 900];

/// The quantities to choose from on the page.
const QUANTITIES: [Quantity; 2] = [Quantity::ForceDensity, Quantity::Mean];

/// The target accuracies.
const TARGETS: [f64; 4] = [0.1, 0.01, 0.001, 0.0001];

impl Page<'_> {
    /// Writes the page.
    ///
    /// # Errors
    /// If `out` cannot be written to, or there are maps of errors without the feature `pictures`.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let shape = self.rows.first().map_or("", |row| row.shape);
        let lead = format!(
            "Which method computes how a membrane bends, how far it is off, and how long it takes: measured on {} against exact values.",
            described(shape)
        );
        let document = Document {
            title: "What accuracy costs: bending of membranes",
            heading: "What accuracy costs",
            lead: &lead,
            generator: "helfrich study",
        };
        document.write(&serde_json::to_string(&self.rows)?, out, |out| {
            self.parts(out)
        })
    }

    /// Everything between the heading and the script.
    fn parts(&self, out: &mut dyn Write) -> io::Result<()> {
        let recommended = answers::recommended(self.rows);
        let recommended = recommended.as_ref();
        answers::write(self, recommended, out)?;
        accuracy::write(self, recommended, out)?;
        verdicts::write(self.verdicts, out)?;
        pictures::write(self, out)?;
        precision::write(self.rows, out)?;
        for section in self.sections {
            out.write_all(&section.html)?;
        }
        if self.sections.is_empty() {
            writeln!(
                out,
                "<section id=\"flow\"><h2>In flow</h2><p class=\"note\">The capsule in flow and the cost of effects are no part of this page. \
                 In the repository of helfrich they are measured, in some minutes, by <code>cargo run --release --package helfrich-studies -- page --html report.html</code>.</p></section>"
            )?;
        }
        let origin = Origin {
            provenance: self.provenance,
            command: self.command,
            when: self.when,
            reused: self.reused,
        };
        writeln!(
            out,
            "<section id=\"provenance\"><h2>Where the numbers come from</h2>"
        )?;
        origin.write(out)?;
        writeln!(
            out,
            "<p>{ABOUT_ERRORS} \
             <b>Time</b>: the median of one evaluation of forces (and energy, or curvatures) on the whole mesh, on one thread, \
             after the first; times of one page compare with each other, not with another machine. \
             {}\
             {ABOUT_ORDERS} \
             <b>Memory</b>: what the method keeps beside mesh and positions.</p>\
             <p>The question and six of the methods: {ARTICLE}. The jets, J, are this library’s.</p></section>",
            self.about_scatter()
        )
    }

    /// Writes every figure as SVG and PNG into an existing folder. Needs the feature `pictures`.
    ///
    /// # Errors
    /// If a file cannot be written, or without that feature.
    pub fn write_figures(&self, folder: &Path) -> io::Result<()> {
        write_charts(&self.charts(), folder)?;
        for (name, png) in pictures::all(self)? {
            replace_file(&folder.join(format!("{name}.png")), |out| {
                out.write_all(&png)
            })?;
        }
        Ok(())
    }

    /// A note on the number of unreliable times; empty if all are reliable.
    fn about_scatter(&self) -> String {
        let of_f = |row: &&Row| row.quantity == Quantity::ForceDensity;
        let times = self.rows.iter().filter(of_f);
        let scattered = times.clone().filter(|row| row.is_scattered()).count();
        if scattered == 0 {
            return String::new();
        }
        format!(
            "<b>{scattered} of {} times scatter</b>, and are marked by {SCATTERED}: the quartiles of their single runs are more than {:.0} % of the median apart, \
             as on a machine with other work. They are not kept, and measured again for the next page. ",
            times.count(),
            100.0 * MOST_SCATTER
        )
    }

    /// Every figure that is not empty, by name.
    fn charts(&self) -> Vec<(String, Chart)> {
        let mut charts = accuracy::charts(self);
        let more = self.sections.iter();
        charts.extend(more.flat_map(|section| section.charts.clone()));
        charts.retain(|(_, chart)| !chart.is_empty());
        charts
    }
}

/// Writes figures as SVG and PNG into an existing folder. Needs the feature `pictures`.
///
/// # Errors
/// If a file cannot be written, or without that feature.
pub fn write_charts(charts: &[(String, Chart)], folder: &Path) -> io::Result<()> {
    for (name, chart) in charts {
        replace_file(&folder.join(format!("{name}.svg")), |out| {
            svg::write(chart, name, true, out)
        })?;
        let canvas = chart.draw(FIGURE_SIZE).map_err(io::Error::other)?;
        replace_file(&folder.join(format!("{name}.png")), |out| {
            png::encode(&canvas, out)
        })?;
    }
    Ok(())
}

/// The definition of errors, as HTML.
pub const ABOUT_ERRORS: &str = "<b>Error</b>: the difference from the exact value at a vertex, relative to the largest exact value on the surface; \
     the largest over all vertices, or the mean weighted by area.";

/// The definition of orders of convergence, as HTML.
pub const ABOUT_ORDERS: &str = "<b>Order p</b>: error ~ h<sup>p</sup> with the edge length h ~ N<sup>−1/2</sup>, fitted to the three finest meshes.";

/// The article that asked the question, as HTML.
pub const ARTICLE: &str = "Guckenberger, Schraml, Chen, Leonetti, Gekle, <i>On the bending algorithms for soft objects in flows</i>, \
     Comput. Phys. Commun. 207 (2016) 1–23";

/// The frame of a page: one file that loads nothing, with the style and the script of all pages.
#[derive(Clone, Copy, Debug)]
pub struct Document<'a> {
    /// The title of the window.
    pub title: &'a str,
    /// The first heading.
    pub heading: &'a str,
    /// The line below it, as HTML.
    pub lead: &'a str,
    /// The command that wrote the page, in the head of the file: see [`Self::mark`].
    pub generator: &'a str,
}

impl Document<'_> {
    /// The text by which a file is known to be a page of this command.
    pub fn mark(&self) -> String {
        format!("<meta name=\"generator\" content=\"{}\">", self.generator)
    }

    /// Writes the page with these `parts` and the data `json`.
    ///
    /// # Errors
    /// If `out` cannot be written to.
    pub fn write(
        &self,
        json: &str,
        out: &mut dyn Write,
        parts: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        let Self {
            title,
            heading,
            lead,
            ..
        } = self;
        writeln!(
            out,
            "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">{}<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
             <title>{title}</title><style>{}{}</style>\
             <noscript><style>[data-when][hidden]{{display:block}}.choose,.legend input{{display:none}}</style></noscript></head><body><main>",
            self.mark(),
            include_str!("page/style.css"),
            colours(),
        )?;
        writeln!(
            out,
            "<header><p class=\"over\">helfrich · bending of triangulated membranes</p><h1>{heading}</h1>\
             <p class=\"lead\">{lead}</p></header>"
        )?;
        parts(out)?;
        writeln!(
            out,
            "<script type=\"application/json\" id=\"rows\">{}</script>\
             <div id=\"tip\" role=\"status\" aria-live=\"polite\" hidden></div></main><script>{}</script></body></html>",
            json.replace("</", "<\\/"),
            include_str!("page/script.js")
        )
    }
}

/// The origin of the numbers of a page.
#[derive(Clone, Copy, Debug)]
pub struct Origin<'a> {
    /// Program and machine.
    pub provenance: &'a Provenance,
    /// The command line.
    pub command: &'a str,
    /// The time of creation.
    pub when: SystemTime,
    /// Number of measurements from earlier runs of the same program on the same machine.
    pub reused: usize,
}

impl Origin<'_> {
    /// Writes the origin as a list.
    ///
    /// # Errors
    /// If `out` cannot be written to.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let Provenance { version, build, .. } = self.provenance;
        let Build {
            commit,
            compiler,
            profile,
            flags,
            target,
        } = *build;
        let or = |text: &str, none: &str| escaped(if text.is_empty() { none } else { text });
        writeln!(
            out,
            "<dl>\
             <dt>Command</dt><dd><code>{}</code></dd>\
             <dt>Program</dt><dd>helfrich {version}, commit {}</dd>\
             <dt>Compiler</dt><dd>{}, {}, {}; flags: {}</dd>\
             <dt>Machine</dt><dd>{}</dd>\
             <dt>Written</dt><dd>{}</dd>\
             <dt>Measurements</dt><dd>{}</dd></dl>",
            escaped(self.command),
            or(commit, "unknown"),
            or(compiler, "unknown"),
            escaped(profile),
            escaped(target),
            or(flags, "none"),
            escaped(&self.provenance.machine()),
            date(self.when),
            match self.reused {
                0 => "all made for this page".to_owned(),
                reused => format!(
                    "{reused} taken from earlier runs of the same program on this machine, the others made for this page"
                ),
            },
        )
    }
}

/// A shape in words.
fn described(shape: &str) -> &str {
    match shape {
        "discocyte" => "the shape of a red blood cell (the “discocyte”)",
        "sphere" => "a sphere",
        "ellipsoid" => "an ellipsoid",
        "torus" => "a torus",
        other => other,
    }
}

/// The colours of the styles, for the page.
fn colours() -> String {
    let colours = COLOURS.iter().enumerate().map(|(number, colour)| {
        format!(
            ".s{number}{{--c:{colour}}}@media(prefers-color-scheme:dark){{.s{number}{{--c:color-mix(in oklab,{colour} 62%,#fff)}}}}"
        )
    });
    colours.collect()
}

/// The style of a method's curves: its place among all.
pub fn style_of(method: BendingMethod) -> usize {
    let all = BendingMethod::NAMED.into_iter();
    all.take_while(|&other| other != method).count()
}

/// The style of the curves of a method of these rows; methods of the caller take unused colours.
fn style_in(rows: &[Row], method: AnyMethod) -> usize {
    if let AnyMethod::Listed(method) = method {
        return style_of(method);
    }
    let (own, used) = each(rows.iter().map(|row| row.method))
        .into_iter()
        .partition::<Vec<_>, _>(|method| matches!(method, AnyMethod::Own(_)));
    let used = used
        .iter()
        .map(|&method| style_in(rows, method) % COLOURS.len());
    let used = Vec::from_iter(used);
    let place = own.iter().take_while(|&&other| other != method).count();
    let first = BendingMethod::NAMED.len();
    let beyond = first + COLOURS.len();
    let free = (first..beyond).filter(|style| !used.contains(&(style % COLOURS.len())));
    free.chain(beyond..).nth(place).unwrap_or(beyond)
}

/// The label of a method, for the page.
fn label(method: AnyMethod) -> String {
    escaped(method.label())
}

/// The name of a quantity, with its symbol.
fn called(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Mean => "mean curvature H",
        Quantity::Gaussian => "Gaussian curvature K",
        Quantity::LaplacianOfMean => "Δ<sub>S</sub>H",
        Quantity::ForceDensity => "bending force f",
    }
}
