//! The program `helfrich-studies`: studies of helfrich itself.

use clap::{Parser, Subcommand};
use helfrich_cli::allocated;
use helfrich_cli::study::{
    BUILD, CacheArguments, StudyArguments, full_page, keep, left_off, methods, show_rows, unique,
};
use helfrich_cli::terminal::{
    Failure, ProgressBar, check_outputs, ended, file_named, interruption, save, say,
};
use helfrich_paper::flow::{FlowProgress, FlowRow, FlowStudy, FlowStudyError, run_cases};
use helfrich_std::method::{AnyMethod, BendingMethod};
use helfrich_std::provenance::Provenance;
use helfrich_std::study::{Cache, MOST_SCATTER, StudyProgress};
use helfrich_studies::costs::{costs as measured_costs, documents};
use helfrich_studies::effects::{EffectCosts, effect_costs};

use helfrich_studies::report;
use helfrich_studies::stability::{Group, Stability};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::Ordering;

/// Studies of helfrich itself: hard cases, a capsule in flow, the costs of methods and effects.
///
/// Exit codes: 0 success; 2 the arguments or an input file are invalid; 3 an output could not be
/// written; 4 a hard case was not passed; 130 the command was interrupted.
#[derive(Parser)]
#[command(name = "helfrich-studies", version, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Test every method and formula on hard cases, in every number type: two minutes.
    Stability(StabilityArguments),
    /// Compute a capsule in shear flow by every method, with boundary integrals and on a lattice, and
    /// compare with published results: a quarter of an hour.
    Flow(FlowArguments),
    /// Measure the cost of each effect of a capsule in shear flow.
    Effects(EffectArguments),
    /// Measure the cost of each method relative to method B, on one thread: half a minute.
    Costs(CostArguments),
    /// Write the page of `helfrich study --html` with larger meshes, every number type, the capsule in
    /// flow and the cost of effects: some minutes.
    Page(Box<StudyArguments>),
}

#[derive(clap::Args)]
struct StabilityArguments {
    /// Add a mesh of a million vertices to the hard cases, which takes half an hour.
    #[arg(long)]
    large: bool,
    /// The only group of hard cases to run: geometry, cancellation, dynamics, threads or input.
    #[arg(long)]
    group: Option<Group>,
    /// Also write the table as Markdown to this file.
    #[arg(long)]
    markdown: Option<PathBuf>,
    /// Also write the rows as JSON to this file; `-` for standard output, instead of the table.
    #[arg(long)]
    json: Option<PathBuf>,
}

#[derive(clap::Args)]
struct FlowArguments {
    /// Methods by name or letter; by default all but jet, which is one of j4, j6 and j8.
    #[arg(long, value_delimiter = ',', value_parser = listed)]
    method: Vec<Vec<BendingMethod>>,
    #[command(flatten)]
    kept: CacheArguments,
    /// Also write the rows as JSON to this file; `-` for standard output, instead of the table.
    #[arg(long)]
    json: Option<PathBuf>,
}

#[derive(clap::Args)]
struct EffectArguments {
    #[command(flatten)]
    kept: CacheArguments,
    /// Also write the costs as JSON to this file; `-` for standard output, instead of the table.
    #[arg(long)]
    json: Option<PathBuf>,
}

#[derive(clap::Args)]
struct CostArguments {
    /// Write the costs into the program and the guides, in the root folder of the repository.
    #[arg(long)]
    update: bool,
    /// Also write the costs as JSON to this file; `-` for standard output, instead of the table.
    #[arg(long)]
    json: Option<PathBuf>,
}

fn main() -> ExitCode {
    ended(match Arguments::parse().command {
        Command::Stability(arguments) => stability(&arguments),
        Command::Flow(arguments) => flow(&arguments),
        Command::Effects(arguments) => effects(&arguments),
        Command::Costs(arguments) => costs(&arguments),
        Command::Page(arguments) => page(&arguments),
    })
}

/// The methods of a name or letter, or of `all`: scenes have those of the list only.
fn listed(name: &str) -> Result<Vec<BendingMethod>, String> {
    let methods = methods(name)?.into_iter();
    let listed = methods.filter_map(|method| match method {
        AnyMethod::Listed(method) => Some(method),
        AnyMethod::Own(_) => None,
    });
    Ok(listed.collect())
}

fn stability(arguments: &StabilityArguments) -> Result<(), Failure> {
    let json = file_named(arguments.json.as_ref());
    check_outputs(json.into_iter().chain(arguments.markdown.as_deref()))?;
    let table = Stability {
        large: arguments.large,
        group: arguments.group,
    };
    let mut bar = ProgressBar::default();
    let rows = table.run(&mut |StudyProgress { done, total, at }| {
        bar.show(done as f64 / total as f64, at);
    });
    bar.clear();
    let rows = rows.map_err(Failure::input)?;
    show_rows(arguments.json.as_ref(), &rows, |out| {
        report::stability_table(&rows, out)
    })?;
    if let Some(path) = &arguments.markdown {
        save(path, |out| report::stability_markdown(&rows, out))?;
    }
    match rows.iter().filter(|row| !row.passed).count() {
        0 => Ok(()),
        failed => {
            say(format_args!(
                "error: {failed} rows of the table did not pass"
            ));
            Err(Failure::Unfinished(4))
        }
    }
}

fn flow(arguments: &FlowArguments) -> Result<(), Failure> {
    let mut study = FlowStudy::default();
    if !arguments.method.is_empty() {
        study.methods = unique(arguments.method.concat());
        study.lattice_methods.clone_from(&study.methods);
    }
    check_outputs(file_named(arguments.json.as_ref()))?;
    let stop = interruption();
    let interrupted = || stop.load(Ordering::Relaxed);
    let mut cache = arguments.kept.open(None)?;
    let rows = flow_rows(&study, cache.as_mut(), &interrupted);
    keep(cache.as_mut());
    let rows = rows?;
    show_rows(arguments.json.as_ref(), &rows, |out| {
        report::flow_tables(&rows, out)
    })?;
    match interrupted() {
        true => Err(left_off(cache.as_ref())),
        false => Ok(()),
    }
}

fn effects(arguments: &EffectArguments) -> Result<(), Failure> {
    check_outputs(file_named(arguments.json.as_ref()))?;
    let stop = interruption();
    let interrupted = || stop.load(Ordering::Relaxed);
    let mut cache = arguments.kept.open(None)?;
    let costs = measured_effects(cache.as_mut(), &interrupted);
    keep(cache.as_mut());
    match costs? {
        None => Err(left_off(cache.as_ref())),
        Some(costs) => show_rows(arguments.json.as_ref(), &costs, |out| {
            report::effect_table(&costs, out)
        }),
    }
}

fn costs(arguments: &CostArguments) -> Result<(), Failure> {
    check_outputs(file_named(arguments.json.as_ref()))?;
    let root = Path::new(".");
    if arguments.update && !root.join(documents::DATA).exists() {
        let message = format!(
            "--update: there is no {} here: run it in the root of the repository",
            documents::DATA
        );
        return Err(Failure::Input(message.into()));
    }
    let mut bar = ProgressBar::default();
    let found = measured_costs(&Provenance::here(BUILD), &allocated, &mut |share, at| {
        bar.show(share, at);
    });
    bar.clear();
    let found = found.map_err(Failure::input)?;
    if found.scatter > MOST_SCATTER {
        say(format_args!(
            "warning: ratios scatter by {:.0} %: the machine had other work; measure again when it is idle",
            100.0 * found.scatter
        ));
    }
    if arguments.update {
        let texts = documents::texts(root, &found);
        let texts = texts.map_err(|error| Failure::Output(error.to_string()))?;
        for (path, text) in texts {
            save(&path, |out| out.write_all(text.as_bytes()))?;
        }
    }
    show_rows(arguments.json.as_ref(), &found, |out| {
        report::cost_table(&found, out)
    })
}

fn page(arguments: &StudyArguments) -> Result<(), Failure> {
    full_page(arguments, &mut |mut cache, interrupted| {
        let flow = flow_rows(&FlowStudy::brief(), cache.as_deref_mut(), interrupted)?;
        let Some(effects) = measured_effects(cache, interrupted)? else {
            return Ok(Vec::new());
        };
        let section = report::page_section(&flow, &effects)
            .map_err(|error| Failure::output("the page", &error))?;
        Ok(vec![section])
    })
}

fn flow_rows(
    study: &FlowStudy,
    cache: Option<&mut Cache>,
    interrupted: &dyn Fn() -> bool,
) -> Result<Vec<FlowRow>, Failure> {
    let mut bar = ProgressBar::default();
    let folder = tempfile::tempdir().map_err(|error| of_flow(error.into()))?;
    let mut tell = |progress: &FlowProgress<'_>| {
        bar.show(progress.fraction, &progress.case.to_string());
    };
    let rows = run_cases(&study.cases(), folder.path(), cache, interrupted, &mut tell);
    rows.map_err(of_flow)
}

/// Number of vertices of the capsule in the study of effects: enough that effects dominate the time.
const EFFECTS_AT: usize = 642;

fn measured_effects(
    cache: Option<&mut Cache>,
    interrupted: &dyn Fn() -> bool,
) -> Result<Option<EffectCosts>, Failure> {
    let mut bar = ProgressBar::default();
    let costs = effect_costs(EFFECTS_AT, cache, interrupted, &mut |share, at| {
        bar.show(share, at);
    });
    costs.map_err(of_flow)
}

fn of_flow(error: FlowStudyError) -> Failure {
    match error.is_output() {
        true => Failure::Output(error.to_string()),
        false => Failure::input(error),
    }
}
