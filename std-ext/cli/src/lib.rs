//! The program `helfrich`: parses its arguments, calls the library, prints.
//!
//! This is a library so that programs with methods of their own can have all commands
//! ([`program_with`]), and so that other programs of the repository can share its output to terminals and
//! files ([`terminal`]) and extend the page of a study ([`study`]).

mod columns;
mod curvature;
mod paper;
mod recommend;
mod remesh;
mod repair;
mod scenes;
mod smooth;
mod split;
pub mod study;
pub mod terminal;

use cap::Cap;
use clap::{CommandFactory, Parser, Subcommand};
use columns::saved;
use curvature::{CurvatureArguments, curvature};
use helfrich::{Bandwidth, DualArea, Finding, Surface};
use helfrich_std::execute::{available_threads, with_threads};
use helfrich_std::info::{MeshInfo, components};
use helfrich_std::io::{
    Column, Format, MeshFile, check_replaceable, is_same_file, read, read_welded_within,
    read_with_columns, write,
};
use helfrich_std::method::{AnyMethod, BendingMethod, MethodOptions, OwnMethod};
use helfrich_std::noise::noise_seen;
use helfrich_std::report;
use helfrich_std::subdivide::{Target, subdivide};
use helfrich_std::team::Team;
use paper::{PaperArguments, paper};
use recommend::{RecommendArguments, recommend_method};
use remesh::{RemeshArguments, remesh_file};
use repair::{RepairArguments, repair_file};
use scenes::{
    RunArguments, SceneArguments, ScenesArguments, SweepArguments, explain_scene, run_scene,
    scenes, sweep,
};
use smooth::{SmoothArguments, smooth_file};
use split::{SplitArguments, split_file};
use std::alloc::System;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::OnceLock;
use study::{StudyArguments, study};
use terminal::{Failure, print, say};

/// The allocator counts bytes, so that studies can report the memory of a method.
#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, usize::MAX);

/// Number of bytes that the program has allocated.
pub fn allocated() -> usize {
    ALLOCATOR.allocated()
}

/// Bending of triangulated membranes: compares methods, measures curvature, runs scenes.
///
/// Exit codes: 0 success; 2 the arguments or an input file are invalid; 3 an output could not be
/// written; 4 a run stopped before equilibrium or before its end time; 130 the command was
/// interrupted, and a run can be resumed.
#[derive(Parser)]
#[command(name = "helfrich", version, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Measure errors and times of bending methods on exact shapes.
    Study(StudyArguments),
    /// Recommend a method for a mesh file, by measurements on that mesh.
    Recommend(RecommendArguments),
    /// Compute curvatures and force density at every vertex of a mesh file, as CSV or VTP.
    ///
    /// The columns of the table: H, mean curvature, positive on a sphere; K, Gaussian curvature; LapH, Laplacian
    /// of H along the surface; fx, fy, fz, bending force per area; area and normal of the vertex.
    Curvature(CurvatureArguments),
    /// Show counts, topology, area, volume and quality of a mesh file.
    Info(MeshArguments),
    /// Make a new mesh with even triangles of the smooth surface through the vertices of a mesh file.
    ///
    /// Vertices lie on polynomials fitted to the vertices of the file, so that curvatures of the new mesh are as accurate as
    /// those of the old one. Borders and creases keep their curves.
    Remesh(RemeshArguments),
    /// Make a mesh of a file that others refuse, and say what was changed.
    ///
    /// Faces that are no triangles, repeated corners, duplicates, edges with three or more triangles,
    /// contradicting orientations, surfaces with one side, and vertices where surfaces only touch are always
    /// repaired; everything else only on request. A valid mesh keeps every bit, and a second repair finds nothing.
    Repair(RepairArguments),
    /// Remove the noise of the positions of a mesh file, or smooth them by mean-curvature flow.
    ///
    /// Vertices keep their numbers, and are moved along their normals onto polynomials fitted to their neighbours, at
    /// the scale that the measured noise asks for. Closed components keep their volumes. A mesh without noise keeps every
    /// bit.
    Smooth(SmoothArguments),
    /// Write each connected component of a mesh file to a file of its own.
    Split(SplitArguments),
    /// Refine a mesh file by Loop's rules: four triangles for each triangle and level.
    Subdivide(SubdivideArguments),
    /// Run a scene: surfaces, the effects that act on each, and a driver that moves them.
    Run(RunArguments),
    /// Run a scene with every combination of given values, and compare the results.
    Sweep(SweepArguments),
    /// List the scenes that come with the program, which `run`, `sweep` and `explain` take by name.
    Scenes(ScenesArguments),
    /// Make the figures of Guckenberger et al. (2016) with ours beside its data, as one page.
    ///
    /// Curvatures and forces of its six methods and ours on the exact red blood cell, its capsule in shear flow by boundary
    /// integrals and on a lattice, what others found for that capsule, and what each digit costs; with deviations from
    /// published data in one table. An interrupted command continues where it stopped.
    Paper(PaperArguments),
    /// Explain a scene without running it: effects, dimensionless groups, memory, step limits.
    Explain(SceneArguments),
}

/// The part of the machine that a command uses.
#[derive(Debug, clap::Args)]
pub(crate) struct ThreadArguments {
    /// Number of threads, from 1 to 1024; by default as many as the machine runs at once. Results do
    /// not depend on it.
    #[arg(long, value_name = "N", value_parser = threads)]
    threads: Option<NonZeroUsize>,
}

impl ThreadArguments {
    /// Does `work` with that number of threads.
    fn run<R>(&self, work: impl FnOnce() -> R) -> R {
        self.run_in(&Team::alone(), work)
    }

    /// As [`Self::run`]; each of several ranks has one thread by default.
    fn run_in<R>(&self, team: &Team, work: impl FnOnce() -> R) -> R {
        let threads = match team.is_alone() {
            true => available_threads(),
            false => NonZeroUsize::MIN,
        };
        with_threads(self.threads.unwrap_or(threads), work)
    }
}

/// A number of threads that a system can be expected to start.
fn threads(text: &str) -> Result<NonZeroUsize, String> {
    match text.parse::<NonZeroUsize>() {
        Ok(threads) if threads.get() <= 1024 => Ok(threads),
        _ => Err("a whole number from 1 to 1024 is needed".to_owned()),
    }
}

#[derive(clap::Args)]
struct MeshArguments {
    #[arg(help = format!("Mesh file: {}, also compressed as .gz", Format::readable()))]
    mesh: PathBuf,
    /// Merge vertices at exactly the same point, or at most a distance apart. Files from renderers often have
    /// separate vertices for each face.
    #[arg(
        long,
        value_name = "DISTANCE",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "0",
        value_parser = distance
    )]
    weld: Option<f64>,
}

#[derive(clap::Args)]
struct SubdivideArguments {
    #[command(flatten)]
    input: MeshArguments,
    /// Number of refinements.
    #[arg(long, default_value_t = 1)]
    levels: u32,
    /// Place the vertices on the smooth surface to which further refinement would converge.
    #[arg(long)]
    limit: bool,
    #[arg(long, short, help = format!(
        "Output file; its ending determines the format: {}", Format::writable()
    ))]
    output: PathBuf,
}

/// Options of methods; each applies to the methods that have it.
#[derive(Debug, clap::Args)]
pub(crate) struct OptionArguments {
    /// Vertex areas of gompper-kroll and meyer: mixed, voronoi or barycentric; by default mixed.
    #[arg(long, value_parser = MethodOptions::parse_areas)]
    areas: Option<DualArea>,
    /// Bandwidth of the heat kernel of belkin: a number of mean vertex areas; `converging`, the default,
    /// which is max(1/4, sqrt(N)/100) of them; or `published`, the mixed area of each vertex.
    #[arg(long, value_parser = MethodOptions::parse_bandwidth)]
    bandwidth: Option<Bandwidth<f64>>,
}

impl OptionArguments {
    /// The options, if each belongs to at least one of the methods.
    fn checked(&self, methods: &[AnyMethod]) -> Result<MethodOptions, Failure> {
        let options = MethodOptions {
            areas: self.areas,
            bandwidth: self.bandwidth,
        };
        options.check_any(methods).map_err(Failure::input)?;
        Ok(options)
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("a finite number above 0 is needed".to_owned()),
    }
}

/// The program's commands and their arguments, for man pages and shell completions.
pub fn command() -> clap::Command {
    Arguments::command()
}

/// Methods of the caller of [`program_with`], which arguments can name.
static OWN: OnceLock<Vec<AnyMethod>> = OnceLock::new();

/// The methods of the caller's own.
fn own_methods() -> &'static [AnyMethod] {
    OWN.get().map_or(&[], Vec::as_slice)
}

/// The names of all methods with their letters, separated by commas.
fn method_names() -> String {
    let own = own_methods().iter().map(|method| format!(", {method}"));
    BendingMethod::names() + &String::from_iter(own)
}

/// The method of this name or letter.
fn method(name: &str) -> Result<AnyMethod, String> {
    let is_meant = |own: &&AnyMethod| {
        let description = own.description();
        let names = [Some(description.name), description.letter];
        let mut names = names.into_iter().flatten();
        names.any(|own| own.eq_ignore_ascii_case(name))
    };
    if let Some(own) = own_methods().iter().find(is_meant) {
        return Ok(*own);
    }
    let listed = name.parse::<BendingMethod>();
    listed.map(AnyMethod::from).map_err(|_| {
        let names = method_names();
        format!("there is no bending method `{name}`: the methods are {names}")
    })
}

/// Runs the program with its command-line arguments.
pub fn program() -> ExitCode {
    program_with(&[])
}

/// Runs the program with methods of your own in addition to the listed ones: `study`, `recommend` and
/// `curvature` accept them by name, scenes do not. To be called once, by `main`.
pub fn program_with(methods: &[OwnMethod]) -> ExitCode {
    let own = Vec::from_iter(methods.iter().copied().map(AnyMethod::from));
    if let Err(error) = AnyMethod::check_names(&own) {
        return terminal::ended(Err(Failure::input(error)));
    }
    OWN.get_or_init(|| own);
    let result = match Arguments::parse().command {
        Command::Study(arguments) => study(&arguments),
        Command::Recommend(arguments) => arguments.threads.run(|| recommend_method(&arguments)),
        Command::Curvature(arguments) => arguments.threads.run(|| curvature(&arguments)),
        Command::Info(arguments) => info(&arguments),
        Command::Remesh(arguments) => arguments.threads.run(|| remesh_file(&arguments)),
        Command::Repair(arguments) => repair_file(&arguments),
        Command::Smooth(arguments) => arguments.threads.run(|| smooth_file(&arguments)),
        Command::Split(arguments) => split_file(&arguments),
        Command::Subdivide(arguments) => subdivide_file(&arguments),
        Command::Run(arguments) => run_scene(&arguments),
        Command::Sweep(arguments) => arguments.scene.threads.run(|| sweep(&arguments)),
        Command::Scenes(arguments) => scenes(&arguments),
        Command::Paper(arguments) => arguments.threads.run(|| paper(&arguments)),
        Command::Explain(arguments) => arguments.threads.run(|| explain_scene(&arguments)),
    };
    terminal::ended(result)
}

/// Refuses an output, called `new` in the message, that would replace an input, called `what`.
fn refuse_replacing(input: &Path, what: &str, output: &Path, new: &str) -> Result<(), Failure> {
    if is_same_file(input, output) {
        let output = output.display();
        let message = format!("{output}: {new} would replace {what}: choose another name for it");
        return Err(Failure::Input(message.into()));
    }
    Ok(())
}

/// Reads a mesh file, and welds it if requested. Recommends welding where it would help.
fn load(MeshArguments { mesh: path, weld }: &MeshArguments) -> Result<MeshFile, Failure> {
    let file = match weld {
        Some(distance) => read_welded_within(path, *distance),
        None => read(path),
    };
    let file = file.map_err(Failure::input)?;
    hint(path, &file, weld.is_some());
    Ok(file)
}

/// As [`load`], with the numbers at the vertices and triangles; a welded mesh has none.
fn load_with_columns(arguments: &MeshArguments) -> Result<(MeshFile, Vec<Column>), Failure> {
    if arguments.weld.is_some() {
        return Ok((load(arguments)?, Vec::new()));
    }
    let (file, columns) = read_with_columns(&arguments.mesh).map_err(Failure::input)?;
    hint(&arguments.mesh, &file, false);
    Ok((file, columns))
}

/// Prints what was left out, and recommends welding where it would help.
fn hint(path: &Path, file: &MeshFile, is_welded: bool) {
    let shown = path.display();
    if file.left_out > 0 {
        say(format_args!(
            "note: {shown}: left out: {} vertices of no face with a coordinate that is not finite",
            file.left_out
        ));
    }
    let split = if is_welded { 0 } else { file.split_vertices() };
    let distance = GAP * shortest_edge(file);
    let near = file.near_vertices(distance);
    if near > split {
        say(format_args!(
            "warning: {shown}: the mesh has gaps: {near} vertices of its boundary are nearly at the same points as \
             others; --weld={distance:.1e} merges them"
        ));
    } else if split > 0 {
        say(format_args!(
            "warning: {shown}: the mesh has split vertices: {split} vertices of its boundary are at the same \
             points as others; --weld merges them"
        ));
    }
}

/// Part of the shortest edge within which vertices of a boundary are taken for the same point.
const GAP: f64 = 0.01;

fn shortest_edge(file: &MeshFile) -> f64 {
    let edges = file.mesh.edges().iter();
    let lengths = edges.map(|edge| {
        let [from, to] = edge.map(|vertex| file.positions[vertex as usize]);
        let [x, y, z] = [0, 1, 2].map(|axis| to[axis] - from[axis]);
        x.hypot(y).hypot(z)
    });
    lengths.reduce(f64::min).unwrap_or(0.0)
}

/// A distance, not below 0.
fn distance(text: &str) -> Result<f64, String> {
    let distance: Result<f64, _> = text.parse();
    match distance {
        Ok(distance) if distance >= 0.0 && distance.is_finite() => Ok(distance),
        _ => Err("a distance of 0 or more is needed".to_owned()),
    }
}

fn info(arguments: &MeshArguments) -> Result<(), Failure> {
    let path = &arguments.mesh;
    let MeshFile {
        positions, mesh, ..
    } = load(arguments)?;
    let surface = Surface::new(&mesh, &positions).map_err(|error| Failure::mesh(path, error))?;
    let info = MeshInfo::new(surface);
    let components = components(surface);
    let noise = noise_seen(surface);
    print(|out| report::mesh_info(&info, &components, &noise, out))
}

fn subdivide_file(arguments: &SubdivideArguments) -> Result<(), Failure> {
    refuse_replacing(
        &arguments.input.mesh,
        "the mesh",
        &arguments.output,
        "the refined mesh",
    )?;
    let file = load(&arguments.input)?;
    // Outputs are checked before the work, not after it.
    check_replaceable(&arguments.output)
        .map_err(|error| Failure::output(arguments.output.display(), &error))?;
    let target = if arguments.limit {
        Target::Limit
    } else {
        Target::Controls
    };
    let fine = subdivide(file, arguments.levels, target).map_err(|error| {
        Failure::Input(format!("{}: {error}", arguments.input.mesh.display()).into())
    })?;
    saved(write(&arguments.output, &fine.positions, &fine.mesh))
}

/// One line for each kind of finding, with the number of findings and the place of the first.
fn warn(path: &Path, findings: &[Finding]) {
    for (count, first) in report::first_of_each_kind(findings) {
        say(format_args!(
            "warning: {}: {count} × {first}",
            path.display()
        ));
    }
}
