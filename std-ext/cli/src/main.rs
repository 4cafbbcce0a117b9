//! The `helfrich` program: parses its arguments, calls the library, prints.

mod recommend;
mod study;

use cap::Cap;
use clap::{Parser, Subcommand};
use helfrich::{Finding, Surface};
use helfrich_std::info::MeshInfo;
use helfrich_std::io::{MeshFile, WriteError, check_replaceable, read, replace_file, write};
use helfrich_std::method::{BendingMethod, Evaluated, Evaluator};
use helfrich_std::report;
use helfrich_std::run::{End, run};
use helfrich_std::scalar::{HeldPositions, Scalar};
use helfrich_std::scene::{Overrides, Scene, SceneFile};
use helfrich_std::simulation::{Simulation, build};
use helfrich_std::subdivide::{Target, subdivide};
use helfrich_std::sweep::{Outcome, Sweep, Vary};
use indicatif::{ProgressBar, ProgressStyle};
use recommend::{RecommendArguments, recommend_method};
use std::alloc::System;
use std::error::Error;
use std::fmt::Display;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use study::{StudyArguments, study};

/// Counts, so that studies can say what memory a method takes.
#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, usize::MAX);

/// How many bytes the program has allocated.
fn allocated() -> usize {
    ALLOCATOR.allocated()
}

/// Bending of triangulated membranes: compares methods, measures curvature, relaxes scenes.
///
/// Exit codes: 0 done; 2 the arguments or an input file are at fault; 3 an output could not be
/// written; 4 a run ended before its equilibrium; 130 it was interrupted, and can be resumed.
#[derive(Parser)]
#[command(name = "helfrich", version, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Compare bending methods with exact shapes: error and time side by side.
    Study(StudyArguments),
    /// Which method to take on a mesh of your own: measured there.
    Recommend(RecommendArguments),
    /// Curvatures and force density at every vertex of a mesh file, as CSV.
    Curvature(CurvatureArguments),
    /// What a mesh file holds: counts, topology, area, volume, quality.
    Info {
        /// OBJ, OFF, STL or PLY file.
        mesh: PathBuf,
    },
    /// Refine a mesh file by Loop's rules: four triangles for each triangle and level.
    Subdivide(SubdivideArguments),
    /// Run a scene: surfaces, the effects that act on each, and what drives them.
    Run(RunArguments),
    /// Run a scene with every combination of some values, and compare.
    Sweep(SweepArguments),
    /// What a scene asks for: effects, dimensionless groups, memory, step limits. Runs nothing.
    Explain(SceneArguments),
}

#[derive(clap::Args)]
struct SceneArguments {
    /// TOML file; `scenes/scene.schema.json` describes it.
    scene: PathBuf,
    /// Replaces a value of the scene, as in `surface.vesicle.bending.modulus=0.3`, or takes it away, as in
    /// `surface.vesicle.bending=`; as often as needed.
    #[arg(long, value_name = "PATH=VALUE")]
    set: Vec<String>,
}

#[derive(clap::Args)]
struct RunArguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// The folder that everything is written to; the scene's name without `.toml` if there is none.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Go on with the run that is in the folder, from its last checkpoint.
    #[arg(long)]
    resume: bool,
    /// Only say what is wrong with the scene, if anything is.
    #[arg(long, conflicts_with_all = ["resume", "out"])]
    check: bool,
}

#[derive(clap::Args)]
struct SweepArguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// The folder that everything is written to, a folder a run in it.
    #[arg(long)]
    out: PathBuf,
    /// A key and its values, as in `surface.0.bending.method=meyer,juelicher`; as often as needed, the
    /// last varies fastest. Commas inside brackets, braces and quotation marks belong to a value.
    #[arg(long, value_name = "PATH=VALUE,VALUE", required = true)]
    vary: Vec<Vary>,
    /// Columns of the series to show and to plot; those of the scene's plots if there are none.
    #[arg(long, value_delimiter = ',')]
    columns: Vec<String>,
    /// Go on with the runs that are in the folder; those that have ended are left as they are.
    #[arg(long)]
    resume: bool,
}

#[derive(clap::Args)]
struct CurvatureArguments {
    /// OBJ, OFF, STL or PLY file.
    mesh: PathBuf,
    /// Method by name or letter: kantor-nelson (A), gompper-kroll (B), meyer (C),
    /// belkin (D), farutin (E), loop (S), juelicher, j4, j6, jet (J, the degree that suits the mesh).
    #[arg(long, default_value = "meyer")]
    method: BendingMethod,
    /// Bending modulus κ.
    #[arg(long, default_value_t = 1.0, value_parser = positive, allow_negative_numbers = true)]
    modulus: f64,
    /// Number type: f32, f32-pair (positions in pairs of f32) or f64.
    #[arg(long, default_value = "f64")]
    scalar: Scalar,
    /// Write to this file instead of standard output (`-`).
    #[arg(long)]
    csv: Option<PathBuf>,
}

#[derive(clap::Args)]
struct SubdivideArguments {
    /// OBJ, OFF, STL or PLY file.
    mesh: PathBuf,
    /// How often to refine.
    #[arg(long, default_value_t = 1)]
    levels: u32,
    /// Put the vertices on the smooth surface that further refinement would lead to.
    #[arg(long)]
    limit: bool,
    /// Write to this file; .obj, .off, .stl or .ply tells the format.
    #[arg(long, short)]
    output: PathBuf,
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("a finite number above 0 is needed".to_owned()),
    }
}

/// What ends the program early.
enum Failure {
    /// Exit code 2.
    Input(Box<dyn Error>),
    /// Exit code 3.
    Output(String),
    /// A run that ended early and has said so; its exit code.
    Unfinished(u8),
}

impl Failure {
    fn input(error: impl Error + 'static) -> Self {
        Self::Input(Box::new(error))
    }

    fn mesh(path: &Path, error: impl Display) -> Self {
        Self::Input(format!("{}: {error}", path.display()).into())
    }

    fn output(target: impl Display, error: &io::Error) -> Self {
        Self::Output(format!("{target}: {error}"))
    }
}

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Study(arguments) => study(&arguments),
        Command::Recommend(arguments) => recommend_method(&arguments),
        Command::Curvature(arguments) => curvature(&arguments),
        Command::Info { mesh } => info(&mesh),
        Command::Subdivide(arguments) => subdivide_file(&arguments),
        Command::Run(arguments) => run_scene(&arguments),
        Command::Sweep(arguments) => sweep(&arguments),
        Command::Explain(arguments) => explain_scene(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Unfinished(code)) => ExitCode::from(code),
        Err(Failure::Input(error)) => {
            say(format_args!("error: {error}"));
            ExitCode::from(2)
        }
        Err(Failure::Output(message)) => {
            say(format_args!("error: {message}"));
            ExitCode::from(3)
        }
    }
}

/// Writes a line to standard error. If nobody listens there, the exit code still tells:
/// `eprintln!` would panic instead.
fn say(line: impl Display) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Writes to standard output; a reader that has seen enough is no error.
fn print(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    let mut out = BufWriter::new(io::stdout().lock());
    match write(&mut out).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::output("standard output", &error))
        }
        _ => Ok(()),
    }
}

/// Writes a file as a whole or not at all.
fn save(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    replace_file(path, write).map_err(|error| Failure::output(path.display(), &error))
}

/// The file that an option names; none for `-`, standard output.
fn file_named(option: Option<&PathBuf>) -> Option<&Path> {
    let path = option.filter(|path| path.as_os_str() != "-")?;
    Some(path)
}

/// Not after minutes of work.
fn check_outputs<'a>(paths: impl IntoIterator<Item = &'a Path>) -> Result<(), Failure> {
    for path in paths {
        check_replaceable(path).map_err(|error| Failure::output(path.display(), &error))?;
    }
    Ok(())
}

/// On a terminal only; indicatif draws nothing elsewhere.
fn progress_bar() -> ProgressBar {
    let template = "{bar:30} {percent:>3} %  {elapsed} (still {eta})  {msg}";
    let style =
        ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(1).with_style(style)
}

/// Whether two paths lead to the same file that exists.
fn same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

fn load(path: &Path) -> Result<MeshFile, Failure> {
    read(path).map_err(Failure::input)
}

fn info(path: &Path) -> Result<(), Failure> {
    let MeshFile { positions, mesh } = load(path)?;
    let surface = Surface::new(&mesh, &positions).map_err(|error| Failure::mesh(path, error))?;
    let info = MeshInfo::new(surface);
    print(|out| report::mesh_info(&info, out))
}

fn subdivide_file(arguments: &SubdivideArguments) -> Result<(), Failure> {
    let file = load(&arguments.mesh)?;
    // Not after the work.
    check_replaceable(&arguments.output)
        .map_err(|error| Failure::output(arguments.output.display(), &error))?;
    let target = if arguments.limit {
        Target::Limit
    } else {
        Target::Controls
    };
    let fine = subdivide(file, arguments.levels, target)
        .map_err(|error| Failure::Input(format!("{}: {error}", arguments.mesh.display()).into()))?;
    write(&arguments.output, &fine.positions, &fine.mesh).map_err(|error| match error {
        WriteError::Unwritable { .. } => Failure::Output(error.to_string()),
        _ => Failure::input(error),
    })
}

fn curvature(arguments: &CurvatureArguments) -> Result<(), Failure> {
    let CurvatureArguments {
        modulus, scalar, ..
    } = arguments;
    if !scalar.holds(*modulus) {
        let message = format!("the bending modulus {modulus} is out of the range of {scalar}");
        return Err(Failure::Input(message.into()));
    }
    if let Some(csv) = file_named(arguments.csv.as_ref())
        && same_file(csv, &arguments.mesh)
    {
        let message = format!("{}: the table would replace the mesh", csv.display());
        return Err(Failure::Input(message.into()));
    }
    let file = load(&arguments.mesh)?;
    match arguments.scalar {
        Scalar::F32 | Scalar::F32Pair => curvature_in::<f32>(arguments, &file),
        Scalar::F64 => curvature_in::<f64>(arguments, &file),
    }
}

fn curvature_in<T: Evaluated>(
    arguments: &CurvatureArguments,
    file: &MeshFile,
) -> Result<(), Failure> {
    let held = HeldPositions::<T>::new(arguments.scalar, &file.positions);
    let surface = held.surface(&file.mesh).map_err(|error| {
        Failure::mesh(&arguments.mesh, format!("{error} in {}", arguments.scalar))
    })?;
    let modulus = T::constant(arguments.modulus);
    let mut evaluator = Evaluator::new(arguments.method, modulus, &file.mesh);
    let fields = evaluator.fields(surface);
    warn(&arguments.mesh, &evaluator.findings(surface));
    let csv = |out: &mut dyn Write| report::curvature_csv(held.positions(), &fields, out);
    match file_named(arguments.csv.as_ref()) {
        Some(path) => save(path, csv),
        None => print(csv),
    }
}

/// The scene of a file with its overrides, made ready. What is probably not meant is said here.
fn scene(arguments: &SceneArguments) -> Result<(Scene, Simulation, Vec<[f64; 3]>), Failure> {
    let overrides = Overrides::new(&arguments.set).map_err(Failure::input)?;
    let file = SceneFile::read(&arguments.scene, &overrides).map_err(Failure::input)?;
    let (simulation, positions) = build(&file).map_err(Failure::input)?;
    for warning in simulation.warnings() {
        say(format_args!("warning: {warning}"));
    }
    Ok((file.scene, simulation, positions))
}

fn explain_scene(arguments: &SceneArguments) -> Result<(), Failure> {
    let (scene, simulation, positions) = scene(arguments)?;
    let bodies = simulation.bodies().iter();
    let infos = bodies.filter_map(|body| Some(MeshInfo::new(body.surface(&positions)?)));
    let explanation = scene.explain(&Vec::from_iter(infos));
    print(|out| write!(out, "{explanation}"))
}

fn run_scene(arguments: &RunArguments) -> Result<(), Failure> {
    let (scene, simulation, positions) = scene(&arguments.scene)?;
    let path = &arguments.scene.scene;
    if arguments.check {
        return print(|out| writeln!(out, "{}: is a valid scene", path.display()));
    }
    let folder = match &arguments.out {
        Some(folder) => folder.clone(),
        None => PathBuf::from(path.file_stem().unwrap_or_default()),
    };
    let known = simulation.warnings().len();
    let stop = interruption();
    let bar = progress_bar();
    bar.set_length(1000);
    let outcome = run(
        &scene,
        (simulation, positions),
        &folder,
        arguments.resume,
        &|| stop.load(Ordering::Relaxed),
        &mut |progress| {
            bar.set_position((1000.0 * progress.fraction) as u64);
            bar.set_message(progress.message.clone());
        },
    );
    bar.finish_and_clear();
    let summary = outcome.map_err(|error| {
        if error.is_output() {
            Failure::Output(error.to_string())
        } else {
            Failure::input(error)
        }
    })?;
    print(|out| report::run_table(&summary, &folder, out))?;
    // Those of the scene have been said, and so has what is the reason of the end.
    for warning in summary.warnings.iter().skip(known) {
        if !summary.message.contains(warning) {
            say(format_args!("warning: {warning}"));
        }
    }
    match summary.end {
        End::Converged | End::Completed => Ok(()),
        End::Interrupted => Err(Failure::Unfinished(130)),
        _ => {
            say(format_args!("error: {}", summary.message));
            Err(Failure::Unfinished(4))
        }
    }
}

/// Becomes true when the program is asked to stop.
fn interruption() -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    let handler = Arc::clone(&stop);
    // Without a handler an interrupt ends the run at once: the last checkpoint remains.
    let _ = ctrlc::set_handler(move || handler.store(true, Ordering::Relaxed));
    stop
}

fn sweep(arguments: &SweepArguments) -> Result<(), Failure> {
    let sweep = Sweep {
        scene: arguments.scene.scene.clone(),
        set: arguments.scene.set.clone(),
        vary: arguments.vary.clone(),
        columns: arguments.columns.clone(),
    };
    let stop = interruption();
    let bar = progress_bar();
    bar.set_length(1000);
    let swept = sweep.run(
        &arguments.out,
        arguments.resume,
        &|| stop.load(Ordering::Relaxed),
        &mut |progress| {
            let [case, cases] = progress.case;
            bar.set_position((1000.0 * progress.fraction()) as u64);
            let (number, message) = (case + 1, &progress.run.message);
            bar.set_message(format!("{number} of {cases}, {}: {message}", progress.name));
        },
    );
    bar.finish_and_clear();
    let swept = swept.map_err(|error| {
        if error.is_output() {
            Failure::Output(error.to_string())
        } else {
            Failure::input(error)
        }
    })?;
    for warning in &swept.warnings {
        say(format_args!("warning: {warning}"));
    }
    for (warning, runs) in swept.shared_warnings() {
        let all = swept.cases.len();
        say(format_args!("warning: {runs} of {all} runs: {warning}"));
    }
    print(|out| report::sweep_table(&swept, &arguments.out, out))?;
    let ends = swept.cases.iter().map(|(_, outcome)| match outcome {
        Outcome::Ended(ended) => Some(ended.end),
        _ => None,
    });
    if stop.load(Ordering::Relaxed) {
        return Err(Failure::Unfinished(130));
    }
    let failed = |end: &Option<End>| !matches!(end, Some(End::Converged | End::Completed));
    match ends.filter(failed).count() {
        0 => Ok(()),
        count => {
            let all = swept.cases.len();
            say(format_args!(
                "error: {count} of {all} runs did not come to their end"
            ));
            Err(Failure::Unfinished(4))
        }
    }
}

/// One line for each kind of finding, with how many there are and where the first is.
fn warn(path: &Path, findings: &[Finding]) {
    for (count, first) in report::first_of_each_kind(findings) {
        say(format_args!(
            "warning: {}: {count} × {first}",
            path.display()
        ));
    }
}
