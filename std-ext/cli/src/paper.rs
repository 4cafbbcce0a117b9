//! `helfrich paper`.

use crate::study::{
    BUILD, CacheArguments, command as command_line, keep, left_off, methods, own_folder, unique,
};
use crate::terminal::{Failure, ProgressBar, check_outputs, interruption, print, save};
use crate::{ThreadArguments, allocated};
use clap::ValueEnum;
use helfrich::shapes::Discocyte;
use helfrich_paper::curvature::{CellStudy, METHODS, NodeRow};
use helfrich_paper::flow::{
    BENDING, CAPILLARY_NUMBER, FlowCase, FlowRow, FlowStudyError, Solver, run_cases,
};
use helfrich_paper::report::{CellResults, DOCUMENT, Page};
use helfrich_std::execute::{Interruption, interruptible};
use helfrich_std::generate::{self, AnyShape, Family};
use helfrich_std::method::{AnyMethod, BendingMethod};
use helfrich_std::provenance::Provenance;
use helfrich_std::report::page::{Origin, write_charts};
use helfrich_std::scalar::Scalar;
use helfrich_std::study::{Cache, Row, Session, StudyError, StudyProgress};
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::SystemTime;

/// A part of the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Curvatures and forces on the exact red blood cell, over refinement and families of meshes.
    Curvature,
    /// The capsule in shear flow by both solvers, and what others found.
    Capsule,
    /// f32 beside f64: errors and times in every number type.
    Precision,
}

impl Part {
    /// Expected share of the time of all parts.
    fn weight(self) -> f64 {
        match self {
            Self::Curvature => 0.2,
            Self::Capsule => 0.7,
            Self::Precision => 0.1,
        }
    }
}

#[derive(Debug, clap::Args)]
pub(crate) struct PaperArguments {
    /// Output folder: the page `index.html`, and the runs of scenes in `runs`.
    #[arg(long, short, value_name = "FOLDER", default_value = "paper")]
    out: PathBuf,
    /// Take coarser meshes and shorter runs: less than a minute instead of ten.
    #[arg(long)]
    quick: bool,
    /// Parts of the page; by default all.
    #[arg(long, value_name = "PART", value_delimiter = ',')]
    part: Vec<Part>,
    /// Methods by name or letter; by default A,B,C,D,E,S,G,J6. On the lattice those of B, C, S and J6 among them.
    #[arg(long, value_delimiter = ',', value_parser = methods)]
    method: Vec<Vec<AnyMethod>>,
    /// Numbers of vertices of the red blood cell. By default 642,2562,10242,40962; with `--quick` 162,642,2562.
    #[arg(long, value_delimiter = ',')]
    vertices: Vec<usize>,
    /// Also write every figure of the page as SVG and PNG to this folder.
    #[arg(long, value_name = "FOLDER")]
    figures: Option<PathBuf>,
    #[command(flatten)]
    kept: CacheArguments,
    #[command(flatten)]
    pub(crate) threads: ThreadArguments,
}

/// The page's name in its folder.
const PAGE: &str = "index.html";

/// The folder of the runs in that of the page.
const RUNS: &str = "runs";

/// Methods on the lattice: differences between methods are those with boundary integrals.
const ON_LATTICE: [BendingMethod; 4] = [
    BendingMethod::GompperKroll,
    BendingMethod::Meyer,
    BendingMethod::Loop,
    BendingMethod::J6,
];

/// Makes the page.
pub(crate) fn paper(arguments: &PaperArguments) -> Result<(), Failure> {
    let page = arguments.out.join(PAGE);
    refuse_foreign(&page)?;
    let cell = arguments.cell()?;
    let _folder = own_folder(&arguments.out)?;
    check_outputs([page.as_path()])?;
    let _figures = arguments.figures.as_deref().map(own_folder).transpose()?;
    let mut cache = arguments.kept.open(Some("paper.cache"))?;
    let made = arguments.measure(cell.as_ref(), cache.as_mut());
    keep(cache.as_mut());
    let Some(made) = made? else {
        return Err(left_off(cache.as_ref()));
    };
    let reused = cache.as_ref().map_or(0, Cache::used);
    arguments.write(&page, cell.as_ref(), &made, reused)
}

/// Everything that was measured.
#[derive(Default)]
struct Made {
    cell: Option<(Vec<Row>, Vec<NodeRow>)>,
    precision: Option<Vec<Row>>,
    capsules: Option<Vec<FlowRow>>,
}

/// Refuses a file in the place of the page that this command has not written.
fn refuse_foreign(page: &Path) -> Result<(), Failure> {
    let Ok(file) = File::open(page) else {
        return Ok(());
    };
    let mut head = Vec::new();
    // What cannot be read was not written by this command.
    let _ = file.take(1000).read_to_end(&mut head);
    if String::from_utf8_lossy(&head).contains(&DOCUMENT.mark()) {
        return Ok(());
    }
    let message = format!(
        "{}: the page would replace this, which `helfrich paper` has not written: move it away, or name another \
         folder with `--out`",
        page.display()
    );
    Err(Failure::Input(message.into()))
}

impl PaperArguments {
    fn has(&self, part: Part) -> bool {
        self.part.is_empty() || self.part.contains(&part)
    }

    fn methods(&self) -> Vec<AnyMethod> {
        match self.method.concat() {
            none if none.is_empty() => METHODS.map(AnyMethod::from).to_vec(),
            given => unique(given),
        }
    }

    /// The study of the cell, if a part needs it.
    fn cell(&self) -> Result<Option<CellStudy>, Failure> {
        if !self.has(Part::Curvature) && !self.has(Part::Precision) {
            return Ok(None);
        }
        let shape = Discocyte::new(1.0).map_err(Failure::input)?;
        let shape = AnyShape::Discocyte(shape);
        let vertices = match (&self.vertices, self.quick) {
            (none, true) if none.is_empty() => vec![162, 642, 2562],
            (none, false) if none.is_empty() => vec![642, 2562, 10_242, 40_962],
            (given, _) => given.clone(),
        };
        for &number in &vertices {
            generate::check(&shape, number).map_err(Failure::input)?;
        }
        Ok(Some(CellStudy {
            shape,
            families: Family::ALL.to_vec(),
            vertices,
            methods: self.methods(),
            seed: 1,
        }))
    }

    /// The runs of capsules: every method by boundary integrals; some on a lattice; one on several lattices in
    /// two boxes; and without bending, for comparison with others.
    fn cases(&self) -> Vec<FlowCase> {
        let listed = self.methods().into_iter();
        let listed = listed.filter_map(|method| match method {
            AnyMethod::Listed(method) => Some(method),
            AnyMethod::Own(_) => None,
        });
        let listed = Vec::from_iter(listed);
        let (vertices, strain) = match self.quick {
            true => (162, 1.6),
            false => (642, 5.0),
        };
        let lattice = |resolution: f64, size: f64| Solver::LatticeBoltzmann {
            resolution,
            size,
            precision: Scalar::F64,
        };
        let of = |solver: Solver, method: BendingMethod| FlowCase {
            solver,
            method,
            capillary: CAPILLARY_NUMBER,
            bending: BENDING,
            vertices,
            strain,
        };
        let mut cases = Vec::from_iter(
            listed
                .iter()
                .map(|&method| of(Solver::BoundaryIntegral, method)),
        );
        let on_lattice = ON_LATTICE.into_iter();
        let on_lattice = on_lattice.filter(|method| listed.contains(method));
        let first = if self.quick { 4.0 } else { 6.0 };
        let on_lattice = Vec::from_iter(on_lattice);
        cases.extend(
            on_lattice
                .iter()
                .map(|&method| of(lattice(first, 7.0), method)),
        );
        if self.quick {
            return cases;
        }
        if let Some(&method) = on_lattice.iter().find(|&&own| own == BendingMethod::Meyer) {
            for (resolution, size) in [(4.0, 7.0), (4.0, 10.0), (6.0, 10.0)] {
                cases.push(of(lattice(resolution, size), method));
            }
        }
        cases.extend([0.15, 0.3, 0.6].map(|capillary| FlowCase {
            capillary,
            bending: 0.0,
            strain: if capillary < 0.5 { 7.0 } else { 9.0 },
            ..of(Solver::BoundaryIntegral, BendingMethod::GompperKroll)
        }));
        cases
    }

    /// Measures all parts; `None` if interrupted.
    fn measure(
        &self,
        cell: Option<&CellStudy>,
        mut cache: Option<&mut Cache>,
    ) -> Result<Option<Made>, Failure> {
        let stop = interruption();
        let interrupted = || stop.load(Ordering::Relaxed);
        let mut bar = ProgressBar::default();
        let mut made = Made::default();
        let parts = [Part::Curvature, Part::Precision, Part::Capsule];
        let parts = parts.into_iter().filter(|&part| self.has(part));
        let total: f64 = parts.clone().map(Part::weight).sum();
        let mut before = 0.0;
        for part in parts {
            let mut tell = |share: f64, at: &str| {
                bar.show((before + part.weight() * share) / total, at);
            };
            let cache = cache.as_deref_mut();
            match (part, cell) {
                (Part::Curvature, Some(cell)) => {
                    made.cell = measured(|| self.curvature(cell, cache, &interrupted, &mut tell))?;
                }
                (Part::Precision, Some(cell)) => {
                    made.precision =
                        measured(|| self.precision(cell, cache, &interrupted, &mut tell))?;
                }
                _ => {
                    let folder = self.out.join(RUNS);
                    fs::create_dir_all(&folder)
                        .map_err(|error| Failure::output(folder.display(), &error))?;
                    let rows = run_cases(
                        &self.cases(),
                        &folder,
                        cache,
                        &interrupted,
                        &mut |progress| tell(progress.fraction, &progress.case.to_string()),
                    );
                    made.capsules = Some(rows.map_err(|error| of_flow(&error))?);
                }
            }
            if interrupted() {
                return Ok(None);
            }
            before += part.weight();
        }
        bar.clear();
        Ok(Some(made))
    }

    /// Errors in f64 over refinement, and errors at the vertices of one mesh.
    fn curvature(
        &self,
        cell: &CellStudy,
        mut cache: Option<&mut Cache>,
        interrupted: &dyn Fn() -> bool,
        tell: &mut dyn FnMut(f64, &str),
    ) -> Result<(Vec<Row>, Vec<NodeRow>), StudyError> {
        let rows = cell.rows(
            &[Scalar::F64],
            &mut Session {
                progress: &mut |StudyProgress { done, total, at }| {
                    tell(0.9 * done as f64 / total as f64, at);
                },
                interrupted,
                cache: cache.as_deref_mut(),
                allocated: None,
                timed: false,
            },
        )?;
        // Fine enough to show where errors are, and no finer than a figure can show.
        let pictured = cell
            .vertices
            .iter()
            .copied()
            .filter(|&number| number <= 2562);
        let nodes = match pictured.max() {
            Some(vertices) if !interrupted() => cell.nodes(vertices, cache, &mut |share, at| {
                tell(0.9 + 0.1 * share, at)
            })?,
            _ => Vec::new(),
        };
        Ok((rows, nodes))
    }

    /// Errors and times in every number type on regular meshes.
    fn precision(
        &self,
        cell: &CellStudy,
        cache: Option<&mut Cache>,
        interrupted: &dyn Fn() -> bool,
        tell: &mut dyn FnMut(f64, &str),
    ) -> Result<Vec<Row>, StudyError> {
        let regular = CellStudy {
            families: vec![Family::Regular],
            // Rounding shows from some thousand vertices on.
            vertices: Vec::from_iter(cell.vertices.iter().copied().filter(|&n| n <= 10_242)),
            ..cell.clone()
        };
        regular.rows(
            &Scalar::ALL,
            &mut Session {
                progress: &mut |StudyProgress { done, total, at }| {
                    tell(done as f64 / total as f64, at);
                },
                interrupted,
                cache,
                allocated: Some(&allocated),
                timed: true,
            },
        )
    }

    fn write(
        &self,
        file: &Path,
        cell: Option<&CellStudy>,
        made: &Made,
        reused: usize,
    ) -> Result<(), Failure> {
        let provenance = Provenance::here(BUILD);
        let page = Page {
            cell: cell
                .zip(made.cell.as_ref())
                .map(|(study, (rows, nodes))| CellResults { study, rows, nodes }),
            capsules: made.capsules.as_deref(),
            precision: made.precision.as_deref(),
            quick: self.quick,
            origin: Origin {
                provenance: &provenance,
                command: &command_line(),
                when: SystemTime::now(),
                reused,
            },
        };
        let mut charts = Vec::new();
        save(file, |out| {
            charts = page.write(out)?;
            Ok(())
        })?;
        if let Some(folder) = &self.figures {
            write_charts(&charts, folder)
                .map_err(|error| Failure::output(folder.display(), &error))?;
        }
        print(|out| {
            page.summary(out)?;
            writeln!(out, "\nwritten to {}", file.display())
        })
    }
}

/// The result of work that looks for interruptions; `None` if it was interrupted.
fn measured<R>(work: impl FnOnce() -> Result<R, StudyError>) -> Result<Option<R>, Failure> {
    let interruption = Interruption::by_flag(Arc::clone(&interruption()));
    let result = interruptible(interruption, work);
    result.transpose().map_err(Failure::input)
}

fn of_flow(error: &FlowStudyError) -> Failure {
    match error.is_output() {
        true => Failure::Output(error.to_string()),
        false => Failure::Input(error.to_string().into()),
    }
}
