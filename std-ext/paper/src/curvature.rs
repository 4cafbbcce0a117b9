//! Curvatures and forces on the exact red blood cell: the article's methods as published, and ours.

use helfrich::shapes::{ExactPoint, Shape};
use helfrich::{Bandwidth, DualArea, Surface};
use helfrich_evaluate::method::{AnyMethod, BendingMethod, MethodOptions};
use helfrich_evaluate::scalar::Scalar;
use helfrich_execute::execute::Parallel;
use helfrich_mesh::generate::{AnyShape, Family};
use helfrich_study::study::{
    Cache, ErrorFields, Quantity, Row, Session, Study, StudyError, StudyProgress,
};
use serde::{Deserialize, Serialize};

/// The article's methods by their letters, and ours.
pub const METHODS: [BendingMethod; 8] = [
    BendingMethod::KantorNelson,
    BendingMethod::GompperKroll,
    BendingMethod::Meyer,
    BendingMethod::Belkin,
    BendingMethod::Farutin,
    BendingMethod::Loop,
    BendingMethod::Galerkin,
    BendingMethod::J6,
];

/// The article's own methods.
pub const ARTICLE: usize = 6;

/// The quantities of the article.
pub const QUANTITIES: [Quantity; 3] = [
    Quantity::ForceDensity,
    Quantity::Mean,
    Quantity::LaplacianOfMean,
];

/// The families whose values along the meridian are kept: the evenest mesh, and one as it comes.
pub const ALONG: [Family; 2] = [Family::Regular, Family::Irregular];

/// The options with which a method is the published one: those of the others are the defaults.
pub fn as_published(method: AnyMethod) -> MethodOptions {
    match method {
        AnyMethod::Listed(BendingMethod::GompperKroll) => MethodOptions {
            areas: Some(DualArea::Voronoi),
            ..MethodOptions::default()
        },
        AnyMethod::Listed(BendingMethod::Belkin) => MethodOptions {
            bandwidth: Some(Bandwidth::MixedArea(1.0)),
            ..MethodOptions::default()
        },
        _ => MethodOptions::default(),
    }
}

/// A study of the cell.
#[derive(Clone, Debug)]
pub struct CellStudy {
    /// The shape: the article's discocyte.
    pub shape: AnyShape,
    /// The families of meshes.
    pub families: Vec<Family>,
    /// Numbers of vertices.
    pub vertices: Vec<usize>,
    /// The methods, each with the options of [`as_published`].
    pub methods: Vec<AnyMethod>,
    /// Seed of the random families.
    pub seed: u64,
}

/// The errors of one quantity over the vertices of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// The largest error at vertices with six neighbours.
    pub six: f64,
    /// The largest error at all others; none if there are no others.
    pub other: Option<f64>,
    /// The part of the vertices with errors above a tenth.
    pub above: f64,
    /// The number of neighbours of the worst vertex.
    pub valence: usize,
}

/// The error from which on vertices count for [`Spread::above`].
pub const LARGE: f64 = 0.1;

/// Values at a vertex near a meridian.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeridianNode {
    /// Length of the meridian from the pole to the vertex, mirrored into the upper half.
    pub arc: f64,
    /// Number of neighbours.
    pub valence: usize,
    /// Values of [`QUANTITIES`], f along the exact normal; NaN where there is none.
    pub values: [f64; 3],
}

/// The results of the methods at the vertices of one mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeRow {
    /// The family.
    pub family: Family,
    /// Number of vertices.
    pub vertices: usize,
    /// The method.
    pub method: AnyMethod,
    /// Errors of [`QUANTITIES`]; none if the method does not define it.
    pub spreads: [Option<Spread>; 3],
    /// Values along the meridian; none outside of [`ALONG`].
    pub nodes: Vec<MeridianNode>,
}

/// Cached results of a method.
type Kept = ([Option<Spread>; 3], Vec<MeridianNode>);

impl CellStudy {
    /// Studies with options, one for each set of options among the methods.
    fn studies(&self, scalars: &[Scalar]) -> Vec<Study> {
        let mut studies: Vec<Study> = Vec::new();
        for &method in &self.methods {
            let options = as_published(method);
            // An option of one method must not act on another that has it, too.
            let same = |study: &&mut Study| study.options == options;
            if let Some(study) = studies.iter_mut().find(same) {
                study.methods.push(method);
                continue;
            }
            studies.push(Study {
                shape: self.shape,
                families: self.families.clone(),
                vertices: self.vertices.clone(),
                methods: vec![method],
                options,
                scalars: scalars.to_vec(),
                modulus: 1.0,
                seed: self.seed,
            });
        }
        studies
    }

    /// Measures errors, and with `session.timed` times; rows are in the order of families and methods.
    ///
    /// # Errors
    /// If a mesh cannot be made or held in a number type.
    pub fn rows(
        &self,
        scalars: &[Scalar],
        session: &mut Session<'_>,
    ) -> Result<Vec<Row>, StudyError> {
        let studies = self.studies(scalars);
        let mut rows = Vec::new();
        let mut before = 0;
        let all = self.methods.len() as u64;
        for study in &studies {
            let own = study.methods.len() as u64;
            let progress = &mut *session.progress;
            let mut tell = |StudyProgress { done, total, at }: StudyProgress<'_>| {
                progress(StudyProgress {
                    done: before * total + own * done,
                    total: all * total,
                    at,
                });
            };
            rows.extend(study.run_in(&mut Session {
                progress: &mut tell,
                interrupted: session.interrupted,
                cache: session.cache.as_deref_mut(),
                allocated: session.allocated,
                timed: session.timed,
            })?);
            before += own;
        }
        let place = |row: &Row| {
            let family = self
                .families
                .iter()
                .position(|family| family.name() == row.family);
            let method = self.methods.iter().position(|&method| method == row.method);
            (family, method)
        };
        rows.sort_by_key(place);
        Ok(rows)
    }

    /// The errors at the vertices of one mesh of each family, and values along its meridian, in f64.
    ///
    /// # Errors
    /// If a mesh cannot be made.
    pub fn nodes(
        &self,
        vertices: usize,
        mut cache: Option<&mut Cache>,
        progress: &mut dyn FnMut(f64, &str),
    ) -> Result<Vec<NodeRow>, StudyError> {
        let mut rows = Vec::new();
        for (number, &family) in self.families.iter().enumerate() {
            let share = number as f64 / self.families.len() as f64;
            progress(share, &format!("{family} {vertices}: vertices"));
            let names = Vec::from_iter(self.methods.iter().map(|method| method.name()));
            let key = format!(
                "nodes {} {family} {vertices} {} {}",
                self.shape,
                self.seed,
                names.join(",")
            );
            let known = cache.as_deref().and_then(|cache| cache.get(&key));
            let kept: Vec<Kept> = match known {
                Some(kept) => kept,
                None => {
                    let kept = self.at_nodes(family, vertices)?;
                    if let Some(cache) = &mut cache {
                        cache.insert(key, &kept);
                    }
                    kept
                }
            };
            let methods = self.methods.iter().zip(kept);
            rows.extend(methods.map(|(&method, (spreads, nodes))| NodeRow {
                family,
                vertices,
                method,
                spreads,
                nodes,
            }));
        }
        Ok(rows)
    }

    fn at_nodes(&self, family: Family, vertices: usize) -> Result<Vec<Kept>, StudyError> {
        let mut kept = vec![Kept::default(); self.methods.len()];
        for study in self.studies(&[Scalar::F64]) {
            let study = Study {
                families: vec![family],
                ..study
            };
            for (place, quantity) in QUANTITIES.into_iter().enumerate() {
                for fields in study.error_fields(vertices, quantity)? {
                    for (method, errors) in &fields.methods {
                        let at = self.methods.iter().position(|other| other == method);
                        let Some(own) = at.map(|at| &mut kept[at]) else {
                            continue;
                        };
                        own.0[place] = spread(&fields, errors);
                        if place == 0 && ALONG.contains(&family) {
                            own.1 = self.along(&fields, *method, study.options);
                        }
                    }
                }
            }
        }
        Ok(kept)
    }

    /// Values of a method at the vertices near a meridian, mirrored into one eighth of the mesh.
    fn along(
        &self,
        fields: &ErrorFields,
        method: AnyMethod,
        options: MethodOptions,
    ) -> Vec<MeridianNode> {
        let mesh = &fields.mesh;
        let Ok(surface) = Surface::new(&mesh.mesh, &mesh.positions) else {
            return Vec::new();
        };
        let mut evaluator = method.evaluator(&options, 1.0, &mesh.mesh, Parallel::new());
        let found = evaluator.fields(surface);
        let meridian = Vec::from_iter(self.meridian().into_iter().map(|[arc, ..]| arc));
        let mut nodes = Vec::new();
        for (vertex, &[x, y, z]) in mesh.preimages.iter().enumerate() {
            let azimuth = y.abs().atan2(x.abs());
            if azimuth > SECTOR {
                continue;
            }
            let exact = self.shape.at([x, y, z]);
            let along_normal = found.force_density[vertex].map(|density| {
                let parts = density.iter().zip(exact.normal);
                parts.map(|(part, normal)| part * normal).sum::<f64>()
            });
            let polar = x.hypot(y).atan2(z.abs()) / QUARTER;
            let place = polar * (meridian.len() - 1) as f64;
            let low = (place as usize).min(meridian.len() - 2);
            let share = place - low as f64;
            nodes.push(MeridianNode {
                arc: meridian[low] + share * (meridian[low + 1] - meridian[low]),
                valence: mesh.mesh.valence(vertex),
                values: [
                    along_normal,
                    found.mean[vertex],
                    found.laplacian_of_mean[vertex],
                ]
                .map(|value| value.unwrap_or(f64::NAN)),
            });
        }
        nodes
    }

    /// Points of the exact meridian from the pole to the rim: the length from the pole, and the values of
    /// [`QUANTITIES`].
    pub fn meridian(&self) -> Vec<[f64; 4]> {
        let at = |number: usize| {
            let (sine, cosine) = (QUARTER * number as f64 / STEPS as f64).sin_cos();
            self.shape.at([sine, 0.0, cosine])
        };
        let mut arc = 0.0;
        let mut before: Option<ExactPoint<f64>> = None;
        let points = (0..=STEPS).map(at);
        let points = points.map(|point| {
            if let Some(before) = before {
                let [x, _, z] = [0, 1, 2].map(|axis| point.position[axis] - before.position[axis]);
                arc += x.hypot(z);
            }
            before = Some(point);
            [
                arc,
                point.force_density(1.0),
                point.mean,
                point.laplacian_of_mean,
            ]
        });
        points.collect()
    }
}

/// A quarter of a turn: the angle from the pole to the rim.
const QUARTER: f64 = std::f64::consts::FRAC_PI_2;

/// The azimuth, mirrored into a quarter, up to which vertices are shown: they are a twelfth of all.
const SECTOR: f64 = std::f64::consts::PI / 24.0;

/// Number of parts of the exact meridian: chords are shorter than arcs by 1e-6 of them.
const STEPS: usize = 1024;

fn spread(fields: &ErrorFields, errors: &[f64]) -> Option<Spread> {
    let mesh = &fields.mesh.mesh;
    let valence = |vertex: usize| mesh.valence(vertex);
    let largest = |is_six: bool| {
        let own = errors.iter().enumerate();
        let own = own.filter(|&(vertex, _)| (valence(vertex) == 6) == is_six);
        own.map(|(_, &error)| error).reduce(f64::max)
    };
    let worst = errors.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
    let (worst, _) = worst?;
    let above = errors.iter().filter(|&&error| error > LARGE).count();
    Some(Spread {
        six: largest(true).unwrap_or(0.0),
        other: largest(false),
        above: above as f64 / errors.len() as f64,
        valence: valence(worst),
    })
}
