//! Commands for scenes: `run`, `sweep`, `scenes` and `explain`.

use crate::terminal::{Failure, ProgressBar, interruption, print, save, say};
use crate::{ThreadArguments, threads};
use helfrich_std::execute::available_threads;
use helfrich_std::info::MeshInfo;
use helfrich_std::report;
use helfrich_std::run::{End, assist, check, run};
use helfrich_std::scene::{Overrides, SHIPPED, Scene, SceneFile, ShippedScene, shipped_files};
use helfrich_std::simulation::{Simulation, build};
use helfrich_std::sweep::{Outcome, Part, Sweep, Vary};
use helfrich_std::team::Team;
use std::fs;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::atomic::Ordering;

#[derive(clap::Args)]
pub(crate) struct SceneArguments {
    /// TOML file, or the name of a scene that comes with the program: see `helfrich scenes`.
    scene: PathBuf,
    /// Replace a value of the scene, as in `surface.vesicle.bending.modulus=0.3`, or remove it, as in
    /// `surface.vesicle.bending=`; may be repeated.
    #[arg(long, value_name = "PATH=VALUE")]
    set: Vec<String>,
    #[command(flatten)]
    pub(crate) threads: ThreadArguments,
}

#[derive(clap::Args)]
pub(crate) struct ScenesArguments {
    /// Write the scenes to this folder, with the files that they need and their JSON schema. Existing
    /// files are not overwritten.
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
}

#[derive(clap::Args)]
pub(crate) struct RunArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// Output folder; by default the scene's name without `.toml`.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Continue the run in the folder from its last checkpoint.
    #[arg(long)]
    resume: bool,
    /// Only report problems of the scene.
    #[arg(long, conflicts_with_all = ["resume", "out"])]
    check: bool,
}

#[derive(clap::Args)]
pub(crate) struct SweepArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// Output folder, with a subfolder for each run.
    #[arg(long)]
    out: PathBuf,
    /// A key and its values, as in `surface.0.bending.method=meyer,juelicher`; may be repeated, and the
    /// last key varies fastest. Commas inside brackets, braces and quotation marks belong to a value.
    #[arg(long, value_name = "PATH=VALUE,VALUE", required = true)]
    vary: Vec<Vary>,
    /// Columns of the series to show and to plot; by default those of the scene's plots.
    #[arg(long, value_delimiter = ',')]
    columns: Vec<String>,
    /// Continue the runs in the folder; runs that have ended are skipped.
    #[arg(long)]
    resume: bool,
    /// Run only the Kth of N parts: every Nth combination from the Kth on. Other processes, also on other machines, may run
    /// other parts in the same folder at the same time; the same command with `--resume` and without this compares all runs.
    #[arg(long, value_name = "K/N")]
    part: Option<Part>,
    /// Number of simultaneous runs, from 1 to 1024, which share the threads equally. As many jobs as
    /// threads suit runs with small meshes.
    #[arg(long, value_name = "N", default_value = "1", value_parser = threads)]
    jobs: NonZeroUsize,
}

/// A scene, its simulation, and the initial positions.
type Prepared = (Scene, Simulation, Vec<[f64; 3]>);

/// Reads and prepares the scene of a file with its overrides.
fn prepared(arguments: &SceneArguments) -> Result<Prepared, Failure> {
    let overrides = Overrides::new(&arguments.set).map_err(Failure::input)?;
    let file = SceneFile::read(&arguments.scene, &overrides).map_err(Failure::input)?;
    let (simulation, positions) = build(&file).map_err(Failure::input)?;
    Ok((file.scene, simulation, positions))
}

/// As [`prepared`]; prints the warnings of the scene.
fn scene(arguments: &SceneArguments) -> Result<Prepared, Failure> {
    let prepared = prepared(arguments)?;
    for warning in prepared.1.warnings() {
        say(format_args!("warning: {warning}"));
    }
    Ok(prepared)
}

pub(crate) fn scenes(arguments: &ScenesArguments) -> Result<(), Failure> {
    let Some(folder) = &arguments.out else {
        return print(|out| {
            SHIPPED
                .iter()
                .try_for_each(|scene| writeln!(out, "{:28} {}", scene.name, scene.title()))
        });
    };
    let failure = |error| Failure::output(folder.display(), &error);
    fs::create_dir_all(folder).map_err(failure)?;
    for (name, text) in shipped_files() {
        let path = folder.join(name);
        // Existing files are kept, because the user may have changed them.
        if path.symlink_metadata().is_ok() {
            say(format_args!(
                "warning: {}: exists already, and was not overwritten",
                path.display()
            ));
        } else {
            save(&path, |out| out.write_all(text.as_bytes()))?;
        }
    }
    Ok(())
}

pub(crate) fn explain_scene(arguments: &SceneArguments) -> Result<(), Failure> {
    let (scene, simulation, positions) = scene(arguments)?;
    let bodies = simulation.bodies().iter();
    let infos = bodies.filter_map(|body| Some(MeshInfo::new(body.surface(&positions)?)));
    let explanation = scene.explain(&Vec::from_iter(infos));
    print(|out| write!(out, "{explanation}"))
}

/// Runs a scene on all ranks that were started.
pub(crate) fn run_scene(arguments: &RunArguments) -> Result<(), Failure> {
    let team = helfrich_mpi::team().map_err(Failure::input)?;
    arguments.scene.threads.run_in(&team, || {
        if team.number() > 0 {
            return assist_run(arguments, &team);
        }
        if !team.is_alone() {
            let threads = match available_threads().get() {
                1 => "one thread".to_owned(),
                threads => format!("{threads} threads"),
            };
            say(format_args!("{} ranks, {threads} each", team.count()));
        }
        let result = run_alone(arguments, &team);
        team.dismiss();
        result
    })
}

/// Does what the first rank needs, which also says what is wrong with the scene.
fn assist_run(arguments: &RunArguments, team: &Team) -> Result<(), Failure> {
    // An interruption reaches all ranks, and the first one acts on it.
    let _ = interruption();
    let result = prepared(&arguments.scene).and_then(|(scene, mut simulation, positions)| {
        simulation.share(team.clone(), &positions);
        assist(&scene, (simulation, positions)).map_err(Failure::input)
    });
    match result {
        Ok(()) => Ok(()),
        Err(_) if team.listen().is_none() => Err(Failure::Unfinished(2)),
        Err(failure) => panic!("rank {} cannot begin: {failure:?}", team.number()),
    }
}

/// The run, as the first rank.
fn run_alone(arguments: &RunArguments, team: &Team) -> Result<(), Failure> {
    let (scene, mut simulation, positions) = scene(&arguments.scene)?;
    simulation.share(team.clone(), &positions);
    let path = &arguments.scene.scene;
    if arguments.check {
        check(&scene, (simulation, positions)).map_err(Failure::input)?;
        return print(|out| writeln!(out, "{}: is a valid scene", path.display()));
    }
    let folder = match &arguments.out {
        Some(folder) => folder.clone(),
        None => match ShippedScene::named(path) {
            Some(scene) => PathBuf::from(scene.name),
            None => PathBuf::from(path.file_stem().unwrap_or_default()),
        },
    };
    let known = simulation.warnings().len();
    let stop = interruption();
    let mut bar = ProgressBar::default();
    let outcome = run(
        &scene,
        (simulation, positions),
        &folder,
        arguments.resume,
        &|| stop.load(Ordering::Relaxed),
        &mut |progress| {
            bar.show(progress.fraction, progress.message);
        },
    );
    bar.clear();
    let summary = outcome.map_err(|error| {
        if error.is_output() {
            Failure::Output(error.to_string())
        } else {
            Failure::input(error)
        }
    })?;
    print(|out| report::run_table(&summary, &folder, out))?;
    // Warnings of the scene have been printed already, as has the reason of the end.
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

pub(crate) fn sweep(arguments: &SweepArguments) -> Result<(), Failure> {
    let sweep = Sweep {
        scene: arguments.scene.scene.clone(),
        set: arguments.scene.set.clone(),
        vary: arguments.vary.clone(),
        columns: arguments.columns.clone(),
        jobs: arguments.jobs,
        part: arguments.part,
    };
    let stop = interruption();
    let mut bar = ProgressBar::default();
    let swept = sweep.run(
        &arguments.out,
        arguments.resume,
        &|| stop.load(Ordering::Relaxed),
        &mut |progress| {
            let [case, cases] = progress.case;
            let (number, message) = (case + 1, &progress.run.message);
            let message = format!("{number} of {cases}, {}: {message}", progress.name);
            bar.show(progress.fraction, &message);
        },
    );
    bar.clear();
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
                "error: {count} of {all} runs did not complete"
            ));
            Err(Failure::Unfinished(4))
        }
    }
}
