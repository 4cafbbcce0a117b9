//! Capsules in shear flow, by both solvers and every bending method. This file has the data;
//! [`crate::report`] presents them.
//!
//! The case is that of Guckenberger, Schraml, Chen, Leonetti and Gekle, Comput. Phys. Commun. 207
//! (2016) 1, section 5: a neo-Hookean sphere of radius a with Ca = μγ̇a/G = 0.15, κ/(a²G) = 0.1125 and
//! the same fluid inside and outside.

mod compared;

pub use compared::{Boxes, Deviation, PUBLISHED, Resolved, boxes, deviation, published, resolved};

use helfrich_evaluate::method::BendingMethod;
use helfrich_evaluate::scalar::Scalar;
use helfrich_run::run::{End, Progress, RunError, run};
use helfrich_scene::scene::{Overrides, SHIPPED, SceneFile};
use helfrich_scene::series::SeriesTable;
use helfrich_scene::simulation::build;
use helfrich_study::study::Cache;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::io;
use std::path::{Path, PathBuf, absolute};

/// The paper's Ca = μγ̇a/G.
pub const CAPILLARY_NUMBER: f64 = 0.15;

/// The paper's bending modulus, in units of a²G.
pub const BENDING: f64 = 0.1125;

/// Bending modulus that prevents wrinkles with little other effect, in units of a²G.
pub const LITTLE_BENDING: f64 = 0.0025;

/// Finest lattice for the coarse mesh, in nodes per radius. There its edges are 1.5 nodes long; finer
/// lattices would leak between its vertices. With much bending, the coarse mesh is necessary, because bending
/// limits the step by the squared edge length.
const FINE: f64 = 8.0;

/// The solver that moves the capsule.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "solver")]
pub enum Solver {
    /// Boundary integrals in unbounded fluid.
    BoundaryIntegral,
    /// A lattice in a cube with two moving walls.
    LatticeBoltzmann {
        /// Number of nodes along the capsule's radius.
        resolution: f64,
        /// Length of the cube's edges in radii.
        size: f64,
        /// Number type of the lattice.
        precision: Scalar,
    },
}

impl fmt::Display for Solver {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BoundaryIntegral => write!(formatter, "boundary integral"),
            Self::LatticeBoltzmann {
                resolution,
                size,
                precision,
            } => write!(
                formatter,
                "lattice, {resolution} nodes a radius, {size} radii, {precision}"
            ),
        }
    }
}

/// Case of one run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FlowCase {
    /// The solver.
    #[serde(flatten)]
    pub solver: Solver,
    /// The bending method.
    pub method: BendingMethod,
    /// Ca = μγ̇a/G.
    pub capillary: f64,
    /// κ/(a²G); 0 for a membrane without bending.
    pub bending: f64,
    /// Number of vertices of the capsule.
    pub vertices: usize,
    /// γ̇t at the end of the run.
    pub strain: f64,
}

/// The result of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FlowRow {
    /// The case that was run.
    #[serde(flatten)]
    pub case: FlowCase,
    /// Its outcome.
    #[serde(flatten)]
    pub outcome: FlowOutcome,
}

/// The outcome of a run, as it is cached.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlowOutcome {
    /// Kind of end of the run.
    pub end: End,
    /// A description of the end.
    pub message: String,
    /// Taylor deformation at the end, by the ellipsoid of the same inertia.
    pub deformation: f64,
    /// Inclination to the flow at the end, in degrees.
    pub inclination: f64,
    /// Volume at the end relative to that at the start, minus 1.
    pub volume_change: f64,
    /// Deformation over γ̇t.
    pub transient: Vec<[f64; 2]>,
    /// Inclination in degrees over γ̇t.
    pub inclinations: Vec<[f64; 2]>,
    /// Number of time steps.
    pub steps: u64,
    /// Duration of the run in seconds.
    pub seconds: f64,
}

/// A study of flow.
#[derive(Clone, Debug)]
pub struct FlowStudy {
    /// Bending methods with boundary integrals.
    pub methods: Vec<BendingMethod>,
    /// Bending methods on a lattice.
    pub lattice_methods: Vec<BendingMethod>,
    /// Values of κ/(a²G) of the runs that compare lattices.
    pub bendings: Vec<f64>,
    /// Resolutions of the lattice for the first method: number of nodes along the radius.
    pub resolutions: Vec<f64>,
    /// Lengths of the cubes' edges for this method, in radii. All other runs use the first.
    pub sizes: Vec<f64>,
    /// γ̇t at the end of the runs.
    pub strain: f64,
}

impl Default for FlowStudy {
    /// The complete study: a quarter of an hour.
    fn default() -> Self {
        Self {
            methods: BendingMethod::ALL.to_vec(),
            lattice_methods: BendingMethod::ALL.to_vec(),
            bendings: vec![BENDING, LITTLE_BENDING],
            resolutions: vec![6.0, 10.0],
            sizes: vec![7.0, 10.0],
            strain: 5.0,
        }
    }
}

/// Progress of a study of flow.
#[derive(Clone, Debug)]
pub struct FlowProgress<'a> {
    /// Fraction done, from 0 to 1, by the expected times of the runs.
    pub fraction: f64,
    /// The running case.
    pub case: &'a FlowCase,
    /// The progress of this run.
    pub run: &'a Progress<'a>,
}

/// The reason why a study of flow cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FlowStudyError {
    /// A case is not a valid scene.
    #[error("{case}: {message}")]
    Scene {
        /// The case.
        case: String,
        /// The problem.
        message: String,
    },
    /// A run cannot begin, or its output cannot be written.
    #[error(transparent)]
    Run(#[from] RunError),
    /// There is no space for the runs.
    #[error("a folder for the runs: {0}")]
    Folder(#[from] io::Error),
}

impl FlowStudyError {
    /// Whether the error is that of an output, and not of a scene.
    pub fn is_output(&self) -> bool {
        match self {
            Self::Scene { .. } => false,
            Self::Run(error) => error.is_output(),
            Self::Folder(_) => true,
        }
    }
}

impl fmt::Display for FlowCase {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "{}, {}, Ca = {}, b = {}",
            self.solver, self.method, self.capillary, self.bending
        )
    }
}

impl FlowStudy {
    /// Every method with boundary integrals and on one lattice: some minutes.
    pub fn brief() -> Self {
        Self {
            bendings: vec![BENDING],
            resolutions: vec![6.0],
            sizes: vec![7.0],
            ..Self::default()
        }
    }

    /// All runs: every method by both solvers; then method B, on each lattice and in both number
    /// types, with much and with little bending.
    pub fn cases(&self) -> Vec<FlowCase> {
        let lattice = |resolution: f64, size: f64| Solver::LatticeBoltzmann {
            resolution,
            size,
            precision: Scalar::F64,
        };
        let of = |solver: Solver, method: BendingMethod, bending: f64| FlowCase {
            solver,
            method,
            capillary: CAPILLARY_NUMBER,
            bending,
            strain: self.strain,
            vertices: match solver {
                Solver::LatticeBoltzmann { resolution, .. }
                    if resolution > FINE && bending < BENDING =>
                {
                    2562
                }
                _ => 642,
            },
        };
        let mut cases = Vec::new();
        let mut add = |case: FlowCase| {
            if !cases.contains(&case) {
                cases.push(case);
            }
        };
        // First every method with both solvers, then the cases that compare lattices.
        let first = self.resolutions.first().zip(self.sizes.first());
        for &method in &self.methods {
            add(of(Solver::BoundaryIntegral, method, BENDING));
            if let Some((&resolution, &size)) = first
                && self.lattice_methods.contains(&method)
            {
                add(of(lattice(resolution, size), method, BENDING));
            }
        }
        let method = BendingMethod::GompperKroll;
        for &bending in &self.bendings {
            add(of(Solver::BoundaryIntegral, method, bending));
            for &resolution in &self.resolutions {
                for &size in &self.sizes {
                    let case = of(lattice(resolution, size), method, bending);
                    // The same mesh with boundary integrals.
                    add(FlowCase {
                        solver: Solver::BoundaryIntegral,
                        ..case
                    });
                    add(case);
                }
            }
            if let Some((&resolution, &size)) = first {
                let single = Solver::LatticeBoltzmann {
                    resolution,
                    size,
                    precision: Scalar::F32,
                };
                add(of(single, method, bending));
            }
        }
        cases
    }
}

/// Performs runs in subfolders of a folder, except those in the cache, and stores their results there. A run that the
/// same program on the same machine has begun in this folder, which only the cache knows, is continued; other folders
/// that are there are left alone.
///
/// # Errors
/// If a run cannot begin, or there is no space on the disk. A failed run is a row with its failure.
pub fn run_cases(
    cases: &[FlowCase],
    folder: &Path,
    mut cache: Option<&mut Cache>,
    interrupted: &dyn Fn() -> bool,
    progress: &mut dyn FnMut(&FlowProgress<'_>),
) -> Result<Vec<FlowRow>, FlowStudyError> {
    let total: f64 = cases.iter().map(FlowCase::weight).sum();
    let mut before = 0.0;
    let mut rows = Vec::new();
    for case in cases {
        if interrupted() {
            break;
        }
        let mut tell = |run: &Progress<'_>| {
            progress(&FlowProgress {
                fraction: (before + case.weight() * run.fraction) / total,
                case,
                run,
            });
        };
        let key = format!("flow {case}, {} vertices, {}", case.vertices, case.strain);
        let known = cache.as_deref().and_then(|cache| cache.get(&key));
        let outcome = match known {
            Some(outcome) => outcome,
            None => {
                let (place, resume) = case.place(&key, folder, cache.as_deref_mut());
                let outcome = case.run(&place, resume, interrupted, &mut tell)?;
                if let Some(cache) = &mut cache
                    && outcome.end != End::Interrupted
                {
                    cache.insert(key, &outcome);
                }
                outcome
            }
        };
        rows.push(FlowRow {
            case: *case,
            outcome,
        });
        before += case.weight();
    }
    Ok(rows)
}

impl FlowCase {
    /// Approximate duration of a run, in arbitrary units.
    fn weight(&self) -> f64 {
        match self.solver {
            Solver::BoundaryIntegral => 3e7 * (self.vertices as f64 / 642.0).powi(2),
            Solver::LatticeBoltzmann {
                resolution, size, ..
            } => (resolution * size).powi(3) * 15.0 * resolution.powi(2),
        }
    }

    /// The name of its folder.
    fn name(&self) -> String {
        let solver = match self.solver {
            Solver::BoundaryIntegral => "boundary-integral".to_owned(),
            Solver::LatticeBoltzmann {
                resolution,
                size,
                precision,
            } => format!("lattice-{resolution}-{size}-{precision}"),
        };
        let Self {
            method,
            capillary,
            bending,
            vertices,
            strain,
            ..
        } = self;
        format!("{solver}-{method}-{capillary}-{bending}-{vertices}-{strain}")
    }

    /// The folder of the run, and whether it continues the run there.
    fn place(&self, key: &str, folder: &Path, cache: Option<&mut Cache>) -> (PathBuf, bool) {
        let begun = format!("begun {key}");
        let folder = absolute(folder).unwrap_or_else(|_| folder.to_owned());
        let own = cache
            .as_deref()
            .and_then(|cache| cache.get::<PathBuf>(&begun));
        if let Some(own) = own.filter(|own| own.parent() == Some(&folder) && own.is_dir()) {
            return (own, true);
        }
        let name = self.name();
        let numbered = (2..).map(|number| format!("{name}-{number}"));
        let names = std::iter::once(name.clone()).chain(numbered);
        let mut places = names.map(|name| folder.join(name));
        let free = places.find(|place| place.symlink_metadata().is_err());
        let place = free.unwrap_or_else(|| folder.join(&name));
        if let Some(cache) = cache {
            cache.insert(begun, &place);
            // A failure is reported when the cache is saved for the last time.
            let _ = cache.save();
        }
        (place, false)
    }

    fn file(&self) -> Result<SceneFile, FlowStudyError> {
        let family = match self.method {
            // Method S needs a surface that is as smooth as possible.
            BendingMethod::Loop => "smooth",
            _ => "regular",
        };
        let mut keys = vec![
            format!("driver.strain={}", self.strain),
            format!("driver.flow.rate={}", self.capillary),
            format!("surface.0.vertices={}", self.vertices),
            format!("surface.0.family={family}"),
            // The published curve has points at γ̇t = 0.051 and 0.1, between which D nearly doubles.
            "output.strain_interval=0.05".to_owned(),
            "output.pictures=false".to_owned(),
            "output.surfaces=false".to_owned(),
            "output.slice=".to_owned(),
            "output.plot=".to_owned(),
        ];
        match self.bending {
            0.0 => keys.push("surface.0.bending=".to_owned()),
            modulus => keys.extend([
                format!("surface.0.bending.method={}", self.method),
                format!("surface.0.bending.modulus={modulus}"),
            ]),
        }
        let name = match self.solver {
            Solver::BoundaryIntegral => "capsule-shear",
            Solver::LatticeBoltzmann {
                resolution,
                size,
                precision,
            } => {
                keys.push(format!("driver.resolution={resolution}"));
                keys.push(format!("driver.box=[{size}, {size}, {size}]"));
                keys.push(format!("driver.precision={precision}"));
                "capsule-shear-lattice"
            }
        };
        // A test runs both scenes.
        let text = SHIPPED.iter().find(|scene| scene.name == name);
        let text = text.map_or("", |scene| scene.text);
        let problem = |error: &dyn fmt::Display| FlowStudyError::Scene {
            case: self.to_string(),
            message: error.to_string(),
        };
        let overrides = Overrides::new(keys).map_err(|error| problem(&error))?;
        SceneFile::parse(text, Path::new("capsule.toml"), &overrides).map_err(|e| problem(&e))
    }

    fn run(
        &self,
        folder: &Path,
        resume: bool,
        interrupted: &dyn Fn() -> bool,
        progress: &mut dyn FnMut(&Progress<'_>),
    ) -> Result<FlowOutcome, FlowStudyError> {
        let file = self.file()?;
        let ready = build(&file).map_err(|error| FlowStudyError::Scene {
            case: self.to_string(),
            message: error.to_string(),
        })?;
        let summary = run(&file.scene, ready, folder, resume, interrupted, progress)?;
        let series = SeriesTable::read(&folder.join("series.csv")).map_err(RunError::Series)?;
        let column = |name: &str| {
            let unknown = || vec![f64::NAN; series.rows.len()];
            series.column(name).unwrap_or_else(unknown)
        };
        let ends = |name: &str| {
            let column = column(name);
            [column.first(), column.last()].map(|end| end.copied().unwrap_or(f64::NAN))
        };
        let [start, end] = ends("volume");
        let pairs = |name: &str| {
            let pairs = column("strain").into_iter().zip(column(name));
            pairs.map(|(strain, value)| [strain, value]).collect()
        };
        Ok(FlowOutcome {
            end: summary.end,
            message: summary.message,
            deformation: ends("deformation")[1],
            inclination: ends("inclination")[1],
            volume_change: end / start - 1.0,
            transient: pairs("deformation"),
            inclinations: pairs("inclination"),
            steps: summary.iterations,
            seconds: summary.seconds,
        })
    }
}
