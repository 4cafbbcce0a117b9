//! The page: the article's results beside ours. Nothing is computed here.

pub mod capsule;
mod curvature;
pub mod deviations;
mod review;

use crate::curvature::{CellStudy, NodeRow};
use crate::flow::FlowRow;
use helfrich_draw::picture::Chart;
use helfrich_evaluate::method::AnyMethod;
use helfrich_evaluate::scalar::Scalar;
use helfrich_study::report::page::text::{count, escaped};
use helfrich_study::report::page::{
    ABOUT_ERRORS, ABOUT_ORDERS, ARTICLE, Document, Origin, Section, precision_section,
};
use helfrich_study::study::Row;
use helfrich_study::verdict::verdicts;
use std::io::{self, Write};

/// The frame of the page, which also tells it from other files.
pub const DOCUMENT: Document<'static> = Document {
    title: "Bending algorithms for soft objects in flows: the article and helfrich",
    heading: "The article, made again",
    lead: "What Guckenberger, Schraml, Chen, Leonetti and Gekle, <i>On the bending algorithms for soft objects in flows</i> (2016), show: \
           six bending methods on a red blood cell and on a capsule in shear flow, beside methods that this article does not have.",
    generator: "helfrich paper",
};

/// Results of the cell.
#[derive(Clone, Copy, Debug)]
pub struct CellResults<'a> {
    /// The study.
    pub study: &'a CellStudy,
    /// Errors over refinement, in f64.
    pub rows: &'a [Row],
    /// Errors at the vertices of one mesh of each family.
    pub nodes: &'a [NodeRow],
}

/// The content of the page. Parts that were not asked for are missing.
#[derive(Clone, Copy, Debug)]
pub struct Page<'a> {
    /// The exact red blood cell.
    pub cell: Option<CellResults<'a>>,
    /// Capsules in shear flow.
    pub capsules: Option<&'a [FlowRow]>,
    /// The cell in every number type, with times, on the first family.
    pub precision: Option<&'a [Row]>,
    /// Whether the studies are the short ones.
    pub quick: bool,
    /// The origin of all measurements.
    pub origin: Origin<'a>,
}

impl Page<'_> {
    /// Writes the page, and returns its figures by name.
    ///
    /// # Errors
    /// If `out` cannot be written to.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<Vec<(String, Chart)>> {
        let mut charts = Vec::new();
        let json = serde_json::json!({
            "cell": self.cell.map(|cell| cell.rows),
            "capsules": self.capsules,
            "precision": self.precision,
        });
        DOCUMENT.write(&json.to_string(), out, |out| {
            deviations::write(self, out)?;
            let parts = [
                self.cell
                    .map(|cell| {
                        curvature::section(&cell, &self.about(cell.rows, ""), &self.program())
                    })
                    .transpose()?,
                self.capsules
                    .map(|rows| self.flow_section(rows))
                    .transpose()?,
                self.capsules
                    .map(|rows| review::section(rows, &self.program()))
                    .transpose()?,
                self.precision
                    .map(|rows| self.precision_section(rows))
                    .transpose()?,
            ];
            for part in parts.into_iter().flatten() {
                out.write_all(&part.html)?;
                charts.extend(part.charts);
            }
            self.write_origin(out)
        })?;
        charts.retain(|(_, chart)| !chart.is_empty());
        Ok(charts)
    }

    /// Writes the verdicts of the first table as text, a line for each.
    ///
    /// # Errors
    /// If `out` cannot be written to.
    pub fn summary(&self, out: &mut dyn Write) -> io::Result<()> {
        deviations::summary(self, out)
    }

    /// Version and commit, for captions.
    fn program(&self) -> String {
        let provenance = self.origin.provenance;
        let commit = match provenance.build.commit {
            "" => String::new(),
            commit => format!(", commit {commit}"),
        };
        format!("helfrich {}{}", provenance.version, escaped(&commit))
    }

    /// Meshes, methods, number types and program of rows of the cell, for captions.
    fn about(&self, rows: &[Row], families: &str) -> String {
        let numbers = rows.iter().map(|row| row.vertices);
        let [least, most] = [numbers.clone().min(), numbers.max()];
        let [least, most] = [least, most].map(|number| count(number.unwrap_or(0)));
        let mut methods: Vec<AnyMethod> = Vec::new();
        let mut scalars: Vec<Scalar> = Vec::new();
        for row in rows {
            if !methods.contains(&row.method) {
                methods.push(row.method);
            }
            if !scalars.contains(&row.scalar) {
                scalars.push(row.scalar);
            }
        }
        let methods = methods.iter().map(|method| escaped(method.label()));
        let scalars = scalars.iter().map(Scalar::to_string);
        format!(
            "discocyte, {families}N = {least} … {most}; methods {}; {}; {}",
            Vec::from_iter(methods).join(", "),
            Vec::from_iter(scalars).join(", "),
            self.program()
        )
    }

    fn flow_section(&self, rows: &[FlowRow]) -> io::Result<Section> {
        let mut section = Section::default();
        let out = &mut section.html;
        let numbers = rows.iter().map(|row| row.case.vertices);
        let [least, most] = [numbers.clone().min(), numbers.max()].map(|n| count(n.unwrap_or(0)));
        let meshes = match least == most {
            true => least,
            false => format!("{least} … {most}"),
        };
        let about = format!(
            "regular meshes (S: smooth), N = {meshes}; methods at the curves; f64; {}",
            self.program()
        );
        writeln!(
            out,
            "<section id=\"flow\"><h2>A capsule in shear flow</h2><p>The article’s case: a neo-Hookean sphere of radius a, Ca = μγ̇a/G = {} \
             (0.05 in the article, which uses E<sub>s</sub> = 3G, the surface modulus at the Poisson ratio ½ of a neo-Hookean membrane), \
             κ/(a²G) = {}, the same fluid inside and outside. Boundary integrals have unbounded fluid, the lattice Boltzmann method a cube between two moving walls. \
             Methods take their default options here.</p>",
            crate::flow::CAPILLARY_NUMBER,
            crate::flow::BENDING
        )?;
        writeln!(out, "<div class=\"pair\">")?;
        for draw in [capsule::transient_chart, capsule::inclination_chart] {
            section.charts.push(draw(rows, out, &about)?);
            writeln!(out, "</figure>")?;
        }
        writeln!(out, "</div>")?;
        capsule::transients(rows).write_folded("transients", out)?;
        capsule::steady_table(rows).write("flow-steady", out)?;
        writeln!(out, "</section>")?;
        Ok(section)
    }

    fn precision_section(&self, rows: &[Row]) -> io::Result<Section> {
        let family = rows.first().map_or("", |row| row.family);
        let about = self.about(rows, &format!("{family} mesh, "));
        let mut section = precision_section(rows, family, &about)?;
        let mut html = format!(
            "<section id=\"precision\"><h2>f32 beside f64</h2><p>What each digit costs. Positions in f32 limit jets from some thousand vertices on; \
             <code>f32-pair</code> keeps positions as pairs of f32 and computes in f32. Methods whose own error is larger gain nothing from f64. \
             The article has no such comparison.</p>{}",
            note_on_scatter(rows)
        )
        .into_bytes();
        html.append(&mut section.html);
        html.extend_from_slice(b"</section>\n");
        section.html = html;
        Ok(section)
    }

    fn write_origin(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(
            out,
            "<section id=\"provenance\"><h2>Where the numbers come from</h2>"
        )?;
        self.origin.write(out)?;
        let quick = match self.quick {
            true => {
                "<p><b>This is the quick form</b>: coarser meshes and shorter runs than without <code>--quick</code>.</p>"
            }
            false => "",
        };
        writeln!(
            out,
            "{quick}<p>{ABOUT_ERRORS} {ABOUT_ORDERS}</p>\
             <p>Published data: {ARTICLE}; D(t) of its methods C and S, and steady values of other authors as it collects them, \
             digitised from its figures (±0.002), in <code>{}</code> of the shipped scenes. \
             <code>with-bending.csv</code>, <code>without-bending.csv</code> and <code>capsules.csv</code> are data of the package helfrich-paper; each begins with its source.</p></section>",
            crate::flow::PUBLISHED
        )
    }
}

/// A warning, if times scatter.
fn note_on_scatter(rows: &[Row]) -> &'static str {
    match rows.iter().any(Row::is_scattered) {
        true => {
            "<p class=\"note\">Times marked by ~ scatter, as on a machine with other work; they are measured again for the next page.</p>"
        }
        false => "",
    }
}

/// The letters of the article's methods whose f converges at every vertex, for each family.
pub(crate) fn converging(rows: &[Row]) -> Vec<(&'static str, Vec<&'static str>)> {
    use crate::curvature::{ARTICLE as OF_ARTICLE, METHODS};
    use helfrich_study::study::Quantity;
    use helfrich_study::verdict::Convergence;
    let mut found: Vec<(&'static str, Vec<&'static str>)> = Vec::new();
    for verdict in verdicts(rows) {
        let mut own = METHODS[..OF_ARTICLE].iter();
        let is_own = own.any(|&method| AnyMethod::from(method) == verdict.method);
        if verdict.quantity != Quantity::ForceDensity || !is_own {
            continue;
        }
        if found
            .last()
            .is_none_or(|(family, _)| *family != verdict.family)
        {
            found.push((verdict.family, Vec::new()));
        }
        if verdict.convergence == Convergence::AtAllNodes
            && let Some((_, methods)) = found.last_mut()
        {
            methods.push(verdict.method.label());
        }
    }
    found
}
