//! The results of a method on the mesh of the page.

use crate::{Answer, Array, Refusal};
use helfrich::{Finding, Quality, Surface};
use helfrich_std::io::{Format, MeshFile, write_to_with_colours, write_vtp_to};
use helfrich_std::measurement::{Column, Measurement, in_numbers, verdict_name};
use helfrich_std::method::{AnyMethod, Fields};
use helfrich_std::painting::{Painting, QUANTITIES, scalars, unit, values};
use helfrich_std::picture::{Colour, ColourMap, NO_VALUE};
use helfrich_std::remarks::{self, Remark};
use helfrich_std::report;
use serde_json::{Value, json};
use std::path::Path;

/// The number of colours of a map.
const COLOURS: usize = 256;

/// The number of vertices with the largest errors that are listed.
const WORST: usize = 12;

/// The results of a method, as `helfrich curvature` has them.
#[derive(Debug)]
pub(crate) struct Results {
    pub(crate) method: AnyMethod,
    pub(crate) fields: Fields<f64>,
    pub(crate) columns: Vec<Column>,
    pub(crate) findings: Vec<Finding>,
    pub(crate) remarks: Vec<Remark>,
}

/// Values with error bars, of which there may be none.
struct Painted {
    values: Vec<f64>,
    errors: Vec<f64>,
    painting: Painting,
    ends: [f64; 2],
}

impl Painted {
    fn new(quantity: &str, values: Vec<f64>, errors: Vec<f64>) -> Result<Self, Refusal> {
        let unknown = || Refusal::new(format_args!("no vertex has a value of {quantity}"));
        let painting = Painting::new(values.clone(), &errors).ok_or_else(unknown)?;
        let ends = painting.colouring(quantity).ends(&painting.values);
        Ok(Self {
            ends: ends.map_err(Refusal::new)?,
            values,
            errors,
            painting,
        })
    }
}

impl Results {
    /// The names of the quantities that are known.
    pub(crate) fn quantities(&self) -> Vec<&'static str> {
        let is_known = |name: &&str| {
            let values = values(name, &self.fields, &self.columns);
            values.iter().any(|value| value.is_finite())
        };
        QUANTITIES.into_iter().filter(is_known).collect()
    }

    fn painted(&self, quantity: &str) -> Result<Painted, Refusal> {
        let values = values(quantity, &self.fields, &self.columns);
        let errors = scalars(&self.columns, &format!("{quantity}_error")).to_vec();
        Painted::new(quantity, values, errors)
    }

    /// A quantity as colours, its values and error bars, and the vertices with the largest errors.
    pub(crate) fn paint(
        &self,
        quantity: &str,
        measured: Option<&Measurement>,
    ) -> Result<Answer, Refusal> {
        let painted = self.painted(quantity)?;
        let sizes = match painted.errors.as_slice() {
            [] => None,
            errors => Some(errors),
        };
        let worst = sizes.map_or_else(Vec::new, worst);
        let reason = |vertex: usize| {
            let at = measured.map(|measured| &measured.vertices[vertex]);
            at.map_or_else(String::new, |at| remarks::of_vertex(at, vertex as u32))
        };
        let rows = worst.into_iter();
        let rows = rows.map(|vertex| json!({ "vertex": vertex, "reason": reason(vertex) }));
        Ok(answer(quantity, painted, rows.collect()))
    }

    /// The values of another method less these.
    pub(crate) fn paint_difference(&self, other: &Self, quantity: &str) -> Result<Answer, Refusal> {
        let [one, two] = [self, other].map(|of| values(quantity, &of.fields, &of.columns));
        let difference = one.iter().zip(&two).map(|(one, two)| two - one);
        let difference = Vec::from_iter(difference);
        let painted = Painted::new(quantity, difference, Vec::new())?;
        let sizes = Vec::from_iter(painted.values.iter().map(|value| value.abs()));
        let rows = worst(&sizes)
            .into_iter()
            .filter(|&at| sizes[at].is_finite());
        let reason = format!("{} − {}", other.method, self.method);
        let rows = rows.map(|vertex| json!({ "vertex": vertex, "reason": reason }));
        Ok(answer(quantity, painted, rows.collect()))
    }

    /// Quantities, remarks and the vertices of findings, for the page.
    pub(crate) fn describe(&self, surface: Surface<'_, f64>) -> Answer {
        let quality = Quality::gather(surface.mesh(), |report| {
            self.findings.iter().copied().for_each(report);
        });
        let flagged = (0..)
            .zip(quality.flagged())
            .filter(|(_, flagged)| **flagged);
        let flagged = flagged.map(|(vertex, _)| vertex);
        let remarks = self
            .remarks
            .iter()
            .map(|remark| json!({ "warning": remark.is_warning, "text": remark.text }));
        let text = json!({
            "method": self.method.name(),
            "quantities": self.quantities(),
            "remarks": Vec::from_iter(remarks),
        });
        Answer::new(text).with("flagged", Array::Indices(flagged.collect()))
    }

    /// The table of the program.
    pub(crate) fn csv(&self, positions: &[[f64; 3]]) -> Result<Vec<u8>, Refusal> {
        let mut out = Vec::new();
        report::curvature_csv(positions, &self.fields, &self.columns, &mut out)
            .map_err(Refusal::new)?;
        Ok(out)
    }

    /// The mesh as a file: of VTP with all columns, otherwise with the colours of a quantity where the format has any.
    pub(crate) fn file(
        &self,
        name: &Path,
        mesh: &MeshFile,
        quantity: &str,
    ) -> Result<Vec<u8>, Refusal> {
        let mut out = Vec::new();
        let unknown = || {
            Refusal::new(format_args!(
                "{}: unknown format: {} files can be written",
                name.display(),
                Format::writable()
            ))
        };
        let format = Format::from_extension(name).ok_or_else(unknown)?;
        let (positions, mesh) = (&mesh.positions, &mesh.mesh);
        if format == Format::Vtp {
            let columns = in_numbers(&self.fields, &self.columns);
            let fields = Vec::from_iter(columns.iter().filter_map(Column::as_field));
            write_vtp_to(&mut out, name, mesh, positions, &fields).map_err(Refusal::new)?;
            return Ok(out);
        }
        let painted = self.painted(quantity)?;
        let [low, high] = painted.ends;
        let colours = painted.painting.map.colours(COLOURS);
        let none = in_bytes(NO_VALUE);
        let colour = |value: &f64| match value.is_nan() {
            true => none,
            false => {
                let place = ((value - low) / (high - low)).clamp(0.0, 1.0);
                colours[(place * (COLOURS - 1) as f64).round() as usize]
            }
        };
        let colours = Vec::from_iter(painted.painting.values.iter().map(colour));
        write_to_with_colours(&mut out, format, positions, mesh, &colours).map_err(Refusal::new)?;
        Ok(out)
    }
}

/// A measurement as results of its own method.
pub(crate) fn of_measurement(
    method: AnyMethod,
    surface: Surface<'_, f64>,
    measured: &Measurement,
) -> Results {
    let fields = measured.fields(1.0);
    let mut columns = measured.columns(&fields, 1.0);
    columns.extend(measured.columns_of_jets());
    Results {
        method,
        fields,
        columns,
        findings: measured.findings(),
        remarks: remarks::of_measurement(surface, measured),
    }
}

/// The numbers and words at a vertex.
pub(crate) fn at_vertex(results: &Results, measured: Option<&Measurement>, vertex: usize) -> Value {
    let quantities = results.quantities().into_iter();
    let rows = quantities
        .filter(|name| !name.ends_with("_error"))
        .map(|name| {
            let at = |name: &str| {
                values(name, &results.fields, &results.columns)
                    .get(vertex)
                    .copied()
            };
            json!({
                "quantity": name,
                "value": at(name),
                "error": at(&format!("{name}_error")),
                "unit": unit(name),
            })
        });
    let rows = Vec::from_iter(rows);
    let at = measured.and_then(|measured| measured.vertices.get(vertex));
    json!({
        "rows": rows,
        "verdict": at.map(|at| verdict_name(at.verdict)),
        "reason": at.map(|at| remarks::of_vertex(at, vertex as u32)),
    })
}

/// The vertices with the largest errors; those whose error is not known come first.
fn worst(errors: &[f64]) -> Vec<usize> {
    let key = |vertex: &usize| match errors[*vertex] {
        error if error.is_nan() => f64::INFINITY,
        error => error,
    };
    let mut order = Vec::from_iter(0..errors.len());
    let larger = |a: &usize, b: &usize| key(b).total_cmp(&key(a)).then(a.cmp(b));
    if order.len() > WORST {
        order.select_nth_unstable_by(WORST, larger);
        order.truncate(WORST);
    }
    order.sort_by(larger);
    order
}

fn answer(quantity: &str, painted: Painted, worst: Vec<Value>) -> Answer {
    let Painted {
        values,
        errors,
        painting,
        ends,
    } = painted;
    let text = json!({
        "quantity": quantity,
        "unit": unit(quantity),
        "range": ends,
        "map": map_name(painting.map),
        "error": painting.error,
        "worst": worst,
    });
    Answer::new(text)
        .with("values", Array::Doubles(values))
        .with("errors", Array::Doubles(errors))
        .with("painted", Array::Doubles(painting.values))
}

fn map_name(map: ColourMap) -> &'static str {
    match map {
        ColourMap::Sequential => "sequential",
        ColourMap::Diverging => "diverging",
    }
}

fn in_bytes(colour: Colour) -> [u8; 3] {
    colour.map(|part| (255.0 * part).round() as u8)
}

/// The colours of both maps and of missing values, as the page needs them.
pub(crate) fn colours() -> Value {
    let maps = [ColourMap::Sequential, ColourMap::Diverging];
    let maps = maps.map(|map| (map_name(map).to_owned(), json!(map.colours(COLOURS))));
    json!({ "maps": serde_json::Map::from_iter(maps), "missing": in_bytes(NO_VALUE) })
}
