//! Measurements of accuracy and cost of bending methods on exact shapes; [`crate::report`] presents
//! them.

mod cache;
mod errors;
mod measured;
mod noisy;
mod timing;

pub use cache::{Cache, CacheError, CacheProblem, LoadedCache};
pub use errors::ErrorFields;
pub(crate) use errors::Reference;
pub use noisy::{BEST_FIXED, Bars, NoiseRow, NoiseStudy};
pub use timing::MOST_SCATTER;
pub(crate) use timing::{Timing, is_scattered};

use crate::execute::{Parallel, unless_interrupted};
use crate::generate::{self, AnyShape, Family, GenerateError, GeneratedMesh, generate};
use crate::method::{AnyMethod, Compiled, MethodOptions, RepeatedName};
use crate::scalar::{HeldPositions, Scalar};
use errors::natural_scales;
use helfrich::SurfaceError;
use measured::Measured;
use serde::Serialize;
use std::fmt;
use std::time::Instant;

/// A quantity that is compared with its exact value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
pub enum Quantity {
    /// Mean curvature.
    #[serde(rename = "H")]
    Mean,
    /// Gaussian curvature.
    #[serde(rename = "K")]
    Gaussian,
    /// Laplacian of the mean curvature.
    #[serde(rename = "LapH")]
    LaplacianOfMean,
    /// Force density, as a vector.
    #[serde(rename = "f")]
    ForceDensity,
}

impl Quantity {
    /// Every quantity, from the second to the fourth derivative.
    pub const ALL: [Self; 4] = [
        Self::Mean,
        Self::Gaussian,
        Self::LaplacianOfMean,
        Self::ForceDensity,
    ];

    /// Whether a method defines this quantity.
    pub fn is_defined_by(self, method: impl Into<AnyMethod>) -> bool {
        let method = method.into();
        let [mean, gaussian, laplacian] = method.description().defines;
        match self {
            Self::Mean => mean,
            Self::Gaussian => gaussian,
            Self::LaplacianOfMean => laplacian,
            Self::ForceDensity => method.has_force(),
        }
    }

    /// The name in the field.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Mean => "mean curvature, positive on a sphere",
            Self::Gaussian => "Gaussian curvature",
            Self::LaplacianOfMean => "Laplacian of H along the surface",
            Self::ForceDensity => "bending force per area",
        }
    }

    /// The symbol: `H`, `K`, `LapH` or `f`.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Mean => "H",
            Self::Gaussian => "K",
            Self::LaplacianOfMean => "LapH",
            Self::ForceDensity => "f",
        }
    }
}

/// A study: every combination of the listed values.
#[derive(Clone, Debug)]
pub struct Study {
    /// The exact shape.
    pub shape: AnyShape,
    /// The mesh families.
    pub families: Vec<Family>,
    /// Numbers of vertices of the meshes, in any order; duplicates are ignored.
    pub vertices: Vec<usize>,
    /// The methods: of the list, and of your own.
    pub methods: Vec<AnyMethod>,
    /// Options of the methods; each takes those that it has.
    pub options: MethodOptions,
    /// The number types.
    pub scalars: Vec<Scalar>,
    /// Bending modulus κ.
    pub modulus: f64,
    /// Seed of the random meshes.
    pub seed: u64,
}

/// One quantity of one method on one mesh.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The exact shape's name.
    pub shape: &'static str,
    /// The mesh family's name.
    pub family: &'static str,
    /// Number of vertices of the mesh.
    pub vertices: usize,
    /// The method.
    pub method: AnyMethod,
    /// Its options other than the defaults.
    #[serde(flatten)]
    pub options: MethodOptions,
    /// The number type.
    pub scalar: Scalar,
    /// The quantity compared.
    pub quantity: Quantity,
    /// Largest error over the vertices, relative to the largest exact value or, where that
    /// vanishes, to the scale of the shape (1/R³, κ/R³). Infinite (null in JSON) if a vertex has no
    /// result.
    pub max: f64,
    /// Area-weighted mean error, relative to the same.
    pub mean: f64,
    /// Order of convergence of `max` from the next coarser mesh: ln(e₁/e₂)/ln √(N₂/N₁).
    pub order_max: Option<f64>,
    /// Order of convergence of `mean`.
    pub order_mean: Option<f64>,
    /// Median time of one evaluation on one thread, in nanoseconds per vertex.
    pub ns_per_vertex: f64,
    /// Distance of the quartiles of that time over their median; see [`Self::is_scattered`].
    pub ns_scatter: f64,
    /// Memory of workspace and forces of the method, without mesh and positions, in bytes per
    /// vertex; `None` if it is not counted.
    pub bytes_per_vertex: Option<f64>,
}

/// The surroundings of a running study: progress, interruption, cache.
pub struct Session<'a> {
    /// Called at every step.
    pub progress: &'a mut dyn FnMut(StudyProgress<'_>),
    /// Whether to stop; called before each measurement. Measurements made so far are returned.
    pub interrupted: &'a dyn Fn() -> bool,
    /// Earlier measurements, to which new ones are added.
    pub cache: Option<&'a mut Cache>,
    /// Number of bytes allocated by the program; without it memory is not measured.
    pub allocated: Option<&'a dyn Fn() -> usize>,
    /// Whether evaluations are repeated until the median of their times is known. Otherwise the time is that
    /// of the first evaluation, on all threads, with a scatter of NaN: errors take a third of the time.
    pub timed: bool,
}

impl fmt::Debug for Session<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut session = formatter.debug_struct("Session");
        session.field("cache", &self.cache).finish_non_exhaustive()
    }
}

/// The progress of a study.
#[derive(Clone, Copy, Debug)]
pub struct StudyProgress<'a> {
    /// Work done, in vertices.
    pub done: u64,
    /// All work, in vertices.
    pub total: u64,
    /// The current work.
    pub at: &'a str,
}

/// The reason why a study cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A mesh cannot be made.
    #[error(transparent)]
    Generate(#[from] GenerateError),
    /// Two methods have one name.
    #[error(transparent)]
    Name(#[from] RepeatedName),
    /// The curvatures overflow, or lose their digits.
    #[error(
        "{shape} cannot be studied in {scalar}: with its size and κ = {modulus:?}, κ², 1/R³ or κ/R³ \
         are out of range"
    )]
    OutOfRange {
        /// The shape with its parameters.
        shape: AnyShape,
        /// Bending modulus κ.
        modulus: f64,
        /// The number type.
        scalar: Scalar,
    },
    /// A mesh cannot be used in this number type.
    #[error("the mesh of {vertices} vertices cannot be held in {scalar}: {source}")]
    Surface {
        /// Number of vertices.
        vertices: usize,
        /// The number type.
        scalar: Scalar,
        /// The problem.
        source: SurfaceError,
    },
}

impl Study {
    /// Makes the study row by row, coarse meshes first; `progress` is called at every step. Invalid
    /// studies are refused before anything is computed.
    ///
    /// # Errors
    /// If a mesh cannot be made or does not fit a number type, or two methods have one name.
    pub fn run(&self, progress: &mut dyn FnMut(StudyProgress<'_>)) -> Result<Vec<Row>, StudyError> {
        self.run_in(&mut Session {
            progress,
            interrupted: &|| false,
            cache: None,
            allocated: None,
            timed: true,
        })
    }

    /// Makes the study with interruption and cache as given by the session.
    ///
    /// # Errors
    /// If a mesh cannot be made or does not fit a number type, or two methods have one name.
    pub fn run_in(&self, session: &mut Session<'_>) -> Result<Vec<Row>, StudyError> {
        self.check()?;
        let mut numbers = self.vertices.clone();
        numbers.sort_unstable();
        numbers.dedup();
        let passes = self.families.len() * (self.methods.len() * self.scalars.len() + 1);
        let total = numbers.iter().sum::<usize>() as u64 * passes as u64;
        let mut done = 0;
        let mut rows: Vec<Row> = Vec::new();
        for &family in &self.families {
            let mut meshes: Vec<Level> = Vec::with_capacity(numbers.len());
            for &asked in &numbers {
                if (session.interrupted)() {
                    return Ok(rows);
                }
                let at = &format!("{family} {asked}: mesh");
                (session.progress)(StudyProgress { done, total, at });
                done += asked as u64;
                let level = self.level(family, asked, session)?;
                // On the torus two numbers of vertices may lead to the same lattice.
                if meshes
                    .last()
                    .is_none_or(|last| last.vertices < level.vertices)
                {
                    meshes.push(level);
                }
            }
            for &scalar in &self.scalars {
                for &method in &self.methods {
                    let case = Case {
                        study: self,
                        family,
                        method,
                        scalar,
                    };
                    for level in &meshes {
                        if (session.interrupted)() {
                            return Ok(rows);
                        }
                        let vertices = level.vertices;
                        let at = &format!("{family} {vertices}: {method} {scalar}");
                        (session.progress)(StudyProgress { done, total, at });
                        done += vertices as u64;
                        let Some(found) = unless_interrupted(|| case.rows(level, session)) else {
                            return Ok(rows);
                        };
                        for mut row in found? {
                            row.set_orders(&rows);
                            rows.push(row);
                        }
                    }
                }
            }
        }
        (session.progress)(StudyProgress {
            done: total,
            total,
            at: "done",
        });
        Ok(rows)
    }

    /// A mesh, unless everything on it has been measured before.
    fn level(
        &self,
        family: Family,
        asked: usize,
        session: &Session<'_>,
    ) -> Result<Level, StudyError> {
        let cache = session.cache.as_deref();
        let mut known = None;
        'all: for &scalar in &self.scalars {
            for &method in &self.methods {
                let case = Case {
                    study: self,
                    family,
                    method,
                    scalar,
                };
                let key = case.key(asked, session.timed);
                let measured = cache.and_then(|cache| cache.get::<Measured>(&key));
                known = measured.map(|measured| measured.vertices);
                if known.is_none() {
                    break 'all;
                }
            }
        }
        if let Some(vertices) = known {
            return Ok(Level {
                asked,
                vertices,
                made: None,
            });
        }
        let mesh = generate(&self.shape, family, asked, self.seed)?;
        let exact = Reference::exact(&self.shape, &mesh, self.modulus);
        Ok(Level {
            asked,
            vertices: mesh.mesh.vertex_count(),
            made: Some((mesh, exact)),
        })
    }

    /// Refuses invalid studies.
    fn check(&self) -> Result<(), StudyError> {
        AnyMethod::check_names(&self.methods)?;
        for &vertices in &self.vertices {
            generate::check(&self.shape, vertices)?;
        }
        for &scalar in &self.scalars {
            let [.., third, force] = natural_scales(&self.shape, self.modulus);
            if !(scalar.holds_modulus(self.modulus) && scalar.holds(third) && scalar.holds(force)) {
                return Err(StudyError::OutOfRange {
                    shape: self.shape,
                    modulus: self.modulus,
                    scalar,
                });
            }
        }
        Ok(())
    }
}

impl Row {
    /// Whether the measured times scatter by more than [`MOST_SCATTER`], as on a machine with other
    /// work. Their median is then unreliable, and is not cached.
    pub fn is_scattered(&self) -> bool {
        is_scattered(self.ns_scatter)
    }

    /// Whether its time is the median of repeated evaluations; see [`Session::timed`].
    pub fn is_timed(&self) -> bool {
        !self.ns_scatter.is_nan()
    }

    /// The orders relative to the last earlier row of the same kind, which has fewer vertices.
    fn set_orders(&mut self, earlier: &[Self]) {
        let coarser = earlier.iter().rev().find(|row| {
            row.family == self.family
                && row.method == self.method
                && row.scalar == self.scalar
                && row.quantity == self.quantity
        });
        let Some(coarser) = coarser else {
            return;
        };
        let refinement = (self.vertices as f64 / coarser.vertices as f64).sqrt().ln();
        let order = |coarse: f64, fine: f64| {
            let order = (coarse / fine).ln() / refinement;
            order.is_finite().then_some(order)
        };
        self.order_max = order(coarser.max, self.max);
        self.order_mean = order(coarser.mean, self.mean);
    }
}

/// One method on one family in one number type.
#[derive(Clone, Copy)]
struct Case<'a> {
    study: &'a Study,
    family: Family,
    method: AnyMethod,
    scalar: Scalar,
}

/// A mesh of a family.
struct Level {
    /// Requested number of vertices.
    asked: usize,
    /// Actual number of vertices.
    vertices: usize,
    /// The mesh; `None` if all its measurements are cached.
    made: Option<(GeneratedMesh, Reference)>,
}

impl Case<'_> {
    /// The identity of a measurement; each f64 is given by its bits.
    fn key(self, asked: usize, timed: bool) -> String {
        let Self {
            study,
            family,
            method,
            scalar,
        } = self;
        let (shape, seed) = (study.shape, study.seed);
        let modulus = study.modulus.to_bits();
        let options = study.options.of(method);
        let kind = if timed { "study" } else { "errors" };
        format!("{kind} {shape} {family} {asked} {seed} {method} {options} {scalar} {modulus:x}")
    }

    /// From the session's cache, or measured.
    fn rows(self, level: &Level, session: &mut Session<'_>) -> Result<Vec<Row>, StudyError> {
        let key = self.key(level.asked, session.timed);
        let cached = session.cache.as_deref();
        let cached = cached.and_then(|cache| cache.get::<Measured>(&key));
        let measured = match (cached, &level.made) {
            (Some(measured), _) => measured,
            (None, Some((mesh, exact))) => {
                let measured = match self.scalar {
                    Scalar::F32 | Scalar::F32Pair => self.measure::<f32>(mesh, exact, session),
                    Scalar::F64 => self.measure::<f64>(mesh, exact, session),
                };
                let measured = measured.map_err(|source| StudyError::Surface {
                    vertices: level.vertices,
                    scalar: self.scalar,
                    source,
                })?;
                measured.keep(key, session.timed, session.cache.as_deref_mut());
                measured
            }
            // The mesh exists, because a measurement is missing.
            (None, None) => return Ok(Vec::new()),
        };
        let defined = |quantity: &Quantity| quantity.is_defined_by(self.method);
        let quantities = Quantity::ALL.into_iter().filter(defined);
        let row = |(quantity, &[max, mean]): (Quantity, &[f64; 2])| Row {
            shape: self.study.shape.name(),
            family: self.family.name(),
            vertices: level.vertices,
            method: self.method,
            options: self.study.options.of(self.method),
            scalar: self.scalar,
            quantity,
            max,
            mean,
            order_max: None,
            order_mean: None,
            ns_per_vertex: measured.ns_per_vertex,
            ns_scatter: measured.ns_scatter,
            bytes_per_vertex: measured.bytes_per_vertex,
        };
        Ok(quantities.zip(&measured.errors).map(row).collect())
    }

    fn measure<T: Compiled>(
        self,
        mesh: &GeneratedMesh,
        exact: &Reference,
        session: &Session<'_>,
    ) -> Result<Measured, SurfaceError> {
        let allocated = session.allocated;
        let held = HeldPositions::<T>::new(self.scalar, &mesh.positions);
        let surface = held.surface(&mesh.mesh)?;
        let before = allocated.map(|allocated| allocated());
        let modulus = T::constant(self.study.modulus);
        // Time and memory of one thread; work of other threads would disturb the measurement.
        let threads = match session.timed {
            true => Parallel::single(),
            false => Parallel::new(),
        };
        let options = &self.study.options;
        let mut evaluator = self.method.evaluator(options, modulus, &mesh.mesh, threads);
        let start = Instant::now();
        evaluator.evaluate(surface);
        let first = start.elapsed();
        let bytes = allocated.zip(before);
        let bytes = bytes.map(|(allocated, before)| allocated().saturating_sub(before) as f64);
        let time = match session.timed {
            true => Timing::of_runs(first, || evaluator.evaluate(surface)),
            false => Timing {
                scatter: f64::NAN,
                ..Timing::of_one(first)
            },
        };
        let fields = evaluator.last_fields(surface);
        let vertices = mesh.mesh.vertex_count();
        let defined = |quantity: &Quantity| quantity.is_defined_by(self.method);
        let quantities = Quantity::ALL.into_iter().filter(defined);
        Ok(Measured {
            vertices,
            ns_per_vertex: time.median.as_secs_f64() * 1e9 / vertices as f64,
            ns_scatter: time.scatter,
            bytes_per_vertex: bytes.map(|bytes| bytes / vertices as f64),
            errors: quantities
                .map(|quantity| exact.errors(&fields, quantity))
                .collect(),
        })
    }
}
