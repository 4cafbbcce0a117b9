//! Requests, and the mesh that they are about.

use crate::example::{EXAMPLES, example};
use crate::relax::{REDUCED_VOLUMES, Relaxing, Start};
use crate::results::{Results, at_vertex, colours, of_measurement};
use crate::{Answer, Array, Refusal};
use helfrich::{AdaptiveJet, Surface, TriangleMesh, VertexKind};
use helfrich_std::answer::Norm;
use helfrich_std::execute::Parallel;
use helfrich_std::info::{MeshInfo, components};
use helfrich_std::io::{Format, MeshFile, parse_named, parse_named_soup};
use helfrich_std::measurement::Measurement;
use helfrich_std::method::{AnyMethod, BendingMethod, MethodOptions};
use helfrich_std::noise::noise_seen;
use helfrich_std::orientation::inside_out;
use helfrich_std::painting::{QUANTITIES, unit};
use helfrich_std::recommend::{self, recommend_in_f64};
use helfrich_std::remarks;
use helfrich_std::remesh::{EdgeLengths, MeshRequest, OfNoise, remeshed};
use helfrich_std::repair::{RepairSettings, Soup, repair};
use helfrich_std::report;
use helfrich_std::scalar::Scalar;
use helfrich_std::study::Quantity;
use serde::Deserialize;
use serde_json::{Value, json};
use std::path::Path;
use std::time::Duration;

/// The largest number of vertices of which error bars are measured unless they are asked for: a few seconds.
const FEW: usize = 30_000;

/// The angle between triangles above which their edge is a crease of a new mesh, as in `helfrich remesh`.
const CREASES: f64 = 60.0;

/// Something that the page asks for.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case")]
pub enum Request {
    /// All names, words and colours of the page.
    About,
    /// A mesh from the bytes of a file of this name.
    Read {
        /// The name, whose ending identifies the format.
        name: String,
    },
    /// The mesh of an earlier session: the coordinates of its vertices, and its triangles after them.
    Restore {
        /// Its name.
        name: String,
        /// The number of vertices.
        vertices: usize,
    },
    /// A mesh on an exact shape.
    Example {
        /// The name of the example.
        name: String,
        /// The number of vertices.
        vertices: usize,
    },
    /// Results of a method, as by `helfrich curvature`.
    Evaluate {
        /// 0 or 1: the results that are replaced.
        slot: usize,
        /// Name or letter of the method.
        method: String,
        /// Whether error bars are measured, which `jet` always does; `None` if the mesh has few vertices.
        errors: Option<bool>,
    },
    /// A quantity as colours; the difference of both results without a slot.
    Paint {
        /// The results.
        slot: Option<usize>,
        /// The name of its column.
        quantity: String,
    },
    /// All numbers at a vertex.
    Vertex {
        /// The results.
        slot: usize,
        /// The vertex.
        vertex: usize,
    },
    /// Properties of the mesh, as by `helfrich info`.
    Info,
    /// A mesh of triangles that are none, as by `helfrich repair`; also of the file that was refused last.
    Repair {
        /// Whether vertices at the same point are merged.
        weld: bool,
        /// The most edges of a hole that is filled.
        fill: usize,
        /// The angle in degrees below which triangles are removed.
        slivers: f64,
        /// Whether components that are inside out are turned.
        outward: bool,
    },
    /// Even triangles on the same surface, as by `helfrich remesh`.
    Remesh {
        /// The number of vertices; `None` for as many as before.
        vertices: Option<usize>,
        /// Whether noise is removed first.
        smooth: bool,
    },
    /// The cheapest method for an accuracy, as by `helfrich recommend`.
    Recommend {
        /// The largest error, relative to the largest value.
        error: f64,
        /// The name of the quantity.
        quantity: String,
        /// Whether the error counts at every vertex, or on average.
        everywhere: bool,
    },
    /// A file with results; a table if its name ends in `.csv`.
    Save {
        /// Its name, whose ending identifies the format.
        name: String,
        /// The results.
        slot: usize,
        /// The quantity whose colours it has.
        quantity: String,
    },
    /// A vesicle at the start of its relaxation.
    Relax {
        /// The branch that it comes to.
        start: Start,
        /// The reduced volume.
        reduced_volume: f64,
    },
    /// Steps of the relaxation.
    Step {
        /// The time that they may take.
        milliseconds: u64,
    },
}

/// One mesh, and what is known about it.
#[derive(Debug, Default)]
pub struct Session {
    name: String,
    file: Option<MeshFile>,
    /// A file that is no mesh.
    refused: Option<Vec<u8>>,
    measured: Option<Measurement>,
    results: [Option<Results>; 2],
    relaxing: Option<Relaxing>,
}

impl Session {
    /// Answers a request; `data` are the bytes of files and meshes. `progress` gets the part of the work that is done.
    ///
    /// # Errors
    /// The message of the program if there is no answer.
    pub fn answer(
        &mut self,
        request: Request,
        data: Vec<u8>,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Answer, Refusal> {
        let watch = &mut |done| {
            progress(done);
            true
        };
        match request {
            Request::About => Ok(Answer::new(about())),
            Request::Read { name } => self.read(name, data),
            Request::Restore { name, vertices } => {
                let file = restored(vertices, &data)?;
                Ok(self.take(name, file, Vec::new()))
            }
            Request::Example { name, vertices } => {
                let file = example(&name, vertices)?;
                Ok(self.take(format!("{name}.ply"), file, Vec::new()))
            }
            Request::Evaluate {
                slot,
                method,
                errors,
            } => self.evaluate(slot, &method, errors, watch),
            Request::Paint { slot, quantity } => match slot {
                Some(slot) => self.results(slot)?.paint(&quantity, self.measured.as_ref()),
                None => self
                    .results(0)?
                    .paint_difference(self.results(1)?, &quantity),
            },
            Request::Vertex { slot, vertex } => {
                let results = self.results(slot)?;
                let text = at_vertex(results, self.measured.as_ref(), vertex);
                Ok(Answer::new(text))
            }
            Request::Info => self.info(),
            Request::Repair {
                weld,
                fill,
                slivers,
                outward,
            } => self.repair(&RepairSettings {
                weld: weld.then_some(0.0),
                fill,
                slivers,
                outward,
                ..RepairSettings::default()
            }),
            Request::Remesh { vertices, smooth } => self.remesh(vertices, smooth, watch),
            Request::Recommend {
                error,
                quantity,
                everywhere,
            } => self.recommend(error, &quantity, everywhere, progress),
            Request::Save {
                name,
                slot,
                quantity,
            } => {
                let (results, file) = (self.results(slot)?, self.file()?);
                let bytes = match name.strip_suffix(".csv") {
                    Some(_) => results.csv(&file.positions)?,
                    None => results.file(Path::new(&name), file, &quantity)?,
                };
                let answer = Answer::new(json!({ "name": name }));
                Ok(answer.with("file", Array::Bytes(bytes)))
            }
            Request::Relax {
                start,
                reduced_volume,
            } => {
                let (relaxing, file) = Relaxing::new(start, reduced_volume)?;
                let answer = self.take("vesicle.ply".to_owned(), file, Vec::new());
                let text = relaxing.describe();
                self.relaxing = Some(relaxing);
                Ok(Answer {
                    text: merged(answer.text, text),
                    ..answer
                })
            }
            Request::Step { milliseconds } => self.step(Duration::from_millis(milliseconds)),
        }
    }

    fn file(&self) -> Result<&MeshFile, Refusal> {
        let none = || Refusal::new("there is no mesh: read a file, or take an example");
        self.file.as_ref().ok_or_else(none)
    }

    fn results(&self, slot: usize) -> Result<&Results, Refusal> {
        let none = || Refusal::new("there are no results: choose a method");
        let results = self.results.get(slot).and_then(Option::as_ref);
        results.ok_or_else(none)
    }

    /// Takes a mesh for that of the session.
    fn take(&mut self, name: String, file: MeshFile, mut remarks: Vec<String>) -> Answer {
        if let Ok(surface) = Surface::new(&file.mesh, &file.positions) {
            let all = inside_out(surface);
            remarks.extend(all.iter().take(10).map(ToString::to_string));
        }
        if file.left_out > 0 {
            remarks.push(format!(
                "left out: {} vertices of no face with a coordinate that is not finite",
                file.left_out
            ));
        }
        let text = json!({
            "name": name,
            "vertices": file.positions.len(),
            "few": file.positions.len() <= FEW,
            "remarks": remarks,
        });
        let positions = file.positions.as_flattened().to_vec();
        let triangles = file.mesh.triangles().as_flattened().to_vec();
        *self = Self {
            name,
            file: Some(file),
            ..Self::default()
        };
        Answer::new(text)
            .with("positions", Array::Doubles(positions))
            .with("triangles", Array::Indices(triangles))
    }

    fn read(&mut self, name: String, data: Vec<u8>) -> Result<Answer, Refusal> {
        let refusal = match parse_named(Path::new(&name), &data) {
            Ok((file, _)) => match Surface::new(&file.mesh, &file.positions) {
                Ok(_) => return Ok(self.take(name, file, Vec::new())),
                Err(error) => Refusal::new(format_args!("{name}: {error}")),
            },
            Err(error) => Refusal {
                message: error.to_string(),
                is_repairable: parse_named_soup(Path::new(&name), &data).is_ok(),
            },
        };
        *self = Self {
            name,
            refused: refusal.is_repairable.then_some(data),
            ..Self::default()
        };
        Err(refusal)
    }

    fn evaluate(
        &mut self,
        slot: usize,
        method: &str,
        errors: Option<bool>,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Answer, Refusal> {
        let method: BendingMethod = method.parse().map_err(Refusal::new)?;
        let method = AnyMethod::from(method);
        let Self {
            file,
            measured,
            results,
            ..
        } = self;
        let none = || Refusal::new("there is no mesh: read a file, or take an example");
        let file = file.as_ref().ok_or_else(none)?;
        let surface = Surface::new(&file.mesh, &file.positions).map_err(Refusal::new)?;
        let is_measured = method.has_error_bars() || errors.unwrap_or(file.positions.len() <= FEW);
        if is_measured && measured.is_none() {
            *measured = Measurement::new(surface, &AdaptiveJet::default(), watch);
        }
        let measured = measured.as_ref().filter(|_| is_measured);
        let found = match measured {
            Some(measured) if method.has_error_bars() => of_measurement(method, surface, measured),
            _ => {
                let options = MethodOptions::default();
                let mut evaluator = method.evaluator(&options, 1.0, &file.mesh, Parallel::new());
                let (fields, findings) = evaluator.fields_and_findings(surface);
                let mut told = remarks::of_findings(&findings);
                told.extend(remarks::of_method(method, &fields));
                told.extend(match measured {
                    Some(measured) => remarks::of_measurement(surface, measured),
                    None => remarks::of_noise(surface),
                });
                let columns = measured.map(|measured| measured.columns(&fields, 1.0));
                Results {
                    method,
                    fields,
                    columns: columns.unwrap_or_default(),
                    findings,
                    remarks: told,
                }
            }
        };
        let mut answer = found.describe(surface);
        if let Some(measured) = measured {
            let noise = measured.noise(surface);
            let seen = match noise.is_seen() {
                true => report::noise_of_positions(&noise),
                false => "none found".to_owned(),
            };
            answer.text = merged(answer.text, json!({ "noise": seen }));
            let none = [f64::NAN; 6];
            let directions = measured.vertices.iter().flat_map(|at| {
                let both = at.directions.map(|[one, two]| [one, two].concat());
                both.unwrap_or_else(|| none.to_vec())
            });
            let directions = Array::Doubles(directions.collect());
            answer = answer.with("directions", directions);
        }
        let none = || Refusal::new(format_args!("there are no results {slot}: 0 and 1 are"));
        *results.get_mut(slot).ok_or_else(none)? = Some(found);
        Ok(answer)
    }

    fn info(&self) -> Result<Answer, Refusal> {
        let file = self.file()?;
        let surface = Surface::new(&file.mesh, &file.positions).map_err(Refusal::new)?;
        let noise = match &self.measured {
            Some(measured) => measured.noise(surface),
            None => noise_seen(surface),
        };
        let mut text = Vec::new();
        report::mesh_info(
            &MeshInfo::new(surface),
            &components(surface),
            &noise,
            &mut text,
        )
        .map_err(Refusal::new)?;
        Ok(Answer::new(
            json!({ "text": String::from_utf8_lossy(&text) }),
        ))
    }

    fn repair(&mut self, settings: &RepairSettings) -> Result<Answer, Refusal> {
        let soup = match (&self.refused, &self.file) {
            (Some(bytes), _) => {
                let parsed = parse_named_soup(Path::new(&self.name), bytes);
                parsed.map_err(Refusal::new)?.0
            }
            (None, Some(file)) => Soup {
                positions: file.positions.clone(),
                triangles: file.mesh.triangles().to_vec(),
                short_faces: 0,
            },
            (None, None) => return Err(self.file().err().unwrap_or_else(|| Refusal::new(""))),
        };
        let name = self.name.clone();
        let repaired = repair(soup, settings);
        let repaired = repaired.map_err(|error| Refusal::new(format_args!("{name}: {error}")))?;
        let report = &repaired.report;
        let mut remarks = Vec::from_iter(report.to_string().lines().map(str::to_owned));
        if report.is_empty() {
            remarks.insert(0, "nothing to repair".to_owned());
        }
        Ok(self.take(name, repaired.file, remarks))
    }

    fn remesh(
        &mut self,
        vertices: Option<usize>,
        smooth: bool,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Answer, Refusal> {
        let file = self.file()?;
        let surface = Surface::new(&file.mesh, &file.positions).map_err(Refusal::new)?;
        let kinds = file.mesh.vertex_kinds().iter();
        let used = kinds.filter(|kind| **kind != VertexKind::Isolated).count();
        let request = MeshRequest {
            lengths: EdgeLengths::Uniform(1.0),
            vertices: Some(vertices.unwrap_or(used)),
            creases: CREASES.to_radians(),
            noise: OfNoise::removed_if(smooth),
        };
        let made = remeshed(surface, &request, watch).map_err(Refusal::new)?;
        let mut remarks = Vec::new();
        if let Some(moved) = made.moved {
            remarks.push(format!(
                "the noise is removed: vertices are moved by {moved:.1e}, root mean square"
            ));
        }
        let points = made.made.points.iter();
        let positions = points.map(|point| point.position).collect();
        let name = self.name.clone();
        Ok(self.take(name, MeshFile::new(positions, made.made.mesh), remarks))
    }

    fn recommend(
        &self,
        error: f64,
        quantity: &str,
        everywhere: bool,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Answer, Refusal> {
        let file = self.file()?;
        let mut quantities = Quantity::ALL.into_iter();
        let quantity = quantities.find(|known| known.symbol() == quantity);
        let quantity =
            quantity.ok_or_else(|| Refusal::new("the quantities are H, K, LapH and f"))?;
        if !(error.is_normal() && error > 0.0) {
            return Err(Refusal::new(
                "a finite number above 0 is needed for the error, as in 1% or 0.01",
            ));
        }
        let request = recommend::Request {
            quantity,
            norm: if everywhere { Norm::Max } else { Norm::Mean },
            target: error,
            methods: BendingMethod::NAMED.map(AnyMethod::from).into(),
            options: MethodOptions::default(),
            scalars: vec![Scalar::F64],
        };
        let found = recommend_in_f64(
            &file.mesh,
            &file.positions,
            &request,
            &|| false,
            &mut |at| progress(at.done as f64 / at.total as f64),
        );
        let found = found.map_err(|error| Refusal::new(format_args!("{}: {error}", self.name)))?;
        let mut text = Vec::new();
        if let Some(found) = found {
            report::recommendation(&found, &mut text).map_err(Refusal::new)?;
        }
        Ok(Answer::new(
            json!({ "text": String::from_utf8_lossy(&text) }),
        ))
    }

    fn step(&mut self, time: Duration) -> Result<Answer, Refusal> {
        let (Some(relaxing), Some(file)) = (&mut self.relaxing, &mut self.file) else {
            return Err(Refusal::new("no vesicle is being relaxed"));
        };
        relaxing.run(time);
        file.positions.copy_from_slice(relaxing.positions());
        self.measured = None;
        self.results = [None, None];
        let positions = file.positions.as_flattened().to_vec();
        Ok(Answer::new(relaxing.describe()).with("positions", Array::Doubles(positions)))
    }
}

/// The names and words of the page.
fn about() -> Value {
    let methods = BendingMethod::NAMED.map(|method| {
        json!({
            "name": method.name(),
            "letter": method.letter(),
            "title": method.title(),
            "idea": method.idea(),
            "force": method.has_force(),
            "errors": method.has_error_bars(),
            "cost": method.cost().relative,
        })
    });
    let quantities = QUANTITIES.map(|name| json!({ "name": name, "unit": unit(name) }));
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "methods": methods,
        "quantities": quantities,
        "accuracies": Quantity::ALL.map(Quantity::symbol),
        "examples": EXAMPLES.map(|example| example.name),
        "read": Vec::from_iter(Format::endings()),
        "readable": Format::readable(),
        "written": Vec::from_iter(Format::written_endings()),
        "colours": colours(),
        "reduced_volumes": REDUCED_VOLUMES,
    })
}

/// All entries of two objects.
fn merged(mut one: Value, other: Value) -> Value {
    if let (Value::Object(all), Value::Object(more)) = (&mut one, other) {
        all.extend(more);
    }
    one
}

/// The mesh of positions and triangles in little endian.
fn restored(vertices: usize, data: &[u8]) -> Result<MeshFile, Refusal> {
    let middle = (24 * vertices).min(data.len());
    let (positions, triangles) = data.split_at(middle);
    let (positions, _) = positions.as_chunks::<8>();
    let (triangles, _) = triangles.as_chunks::<4>();
    let positions = Vec::from_iter(positions.iter().map(|&bytes| f64::from_le_bytes(bytes)));
    let triangles = Vec::from_iter(triangles.iter().map(|&bytes| u32::from_le_bytes(bytes)));
    let (positions, _) = positions.as_chunks::<3>();
    let (triangles, _) = triangles.as_chunks::<3>();
    let mesh = TriangleMesh::new(positions.len(), triangles.to_vec()).map_err(Refusal::new)?;
    Ok(MeshFile::new(positions.to_vec(), mesh))
}
