//! `helfrich study`.

use super::{
    Failure, check_outputs, file_named, interruption, positive, print, progress_bar, save, say,
};
use helfrich_std::effect_study::{EffectCosts, effect_costs};
use helfrich_std::flow_study::{FlowRow, FlowStudy, FlowStudyError};
use helfrich_std::generate::{AnyShape, Family};
use helfrich_std::method::BendingMethod;
use helfrich_std::provenance::{Build, Provenance};
use helfrich_std::report;
use helfrich_std::scalar::Scalar;
use helfrich_std::stability::{Group, Stability};
use helfrich_std::study::{Cache, LoadedCache, Progress, Quantity, Session, Study};
use helfrich_std::verdict::verdicts;
use std::fs;
use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::SystemTime;

/// How this program was built, by its build script.
const BUILD: Build = Build {
    commit: env!("HELFRICH_COMMIT"),
    compiler: env!("HELFRICH_COMPILER"),
    profile: env!("HELFRICH_PROFILE"),
    flags: env!("HELFRICH_FLAGS"),
    target: env!("HELFRICH_TARGET"),
};

#[derive(clap::Args)]
pub(super) struct StudyArguments {
    /// sphere[:R], ellipsoid[:a,b,c], torus[:R,r] or discocyte[:R].
    #[arg(long, default_value = "discocyte")]
    shape: AnyShape,
    /// Methods by name or letter, or `all`: kantor-nelson (A), gompper-kroll (B), meyer (C),
    /// belkin (D), farutin (E), loop (S), juelicher, j4, j6, jet (J, the degree that suits the mesh). By default A,B,C; in flow all but jet, which is one of
    /// j4 and j6.
    #[arg(long, value_delimiter = ',', value_parser = methods)]
    method: Vec<Vec<BendingMethod>>,
    /// Mesh families: regular, smooth, relaxed, irregular, hard, or `all`.
    #[arg(long, value_delimiter = ',', default_value = "regular,irregular", value_parser = families)]
    family: Vec<Vec<Family>>,
    /// Numbers of vertices, in any order; 10·4^k + 2 except for irregular meshes and the torus. By
    /// default 642,2562,10242,40962, with --full 163842, too.
    #[arg(long, value_delimiter = ',')]
    vertices: Vec<usize>,
    /// Number types: f32, f32-pair (positions in pairs of f32), f64. By default f64, on a page f32,f64,
    /// with --full all of them.
    #[arg(long, value_delimiter = ',')]
    scalar: Vec<Scalar>,
    /// Bending modulus κ.
    #[arg(long, default_value_t = 1.0, value_parser = positive, allow_negative_numbers = true)]
    modulus: f64,
    /// Seed of the random mesh families.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Study a capsule in shear flow instead: every method by boundary integrals and on a lattice,
    /// beside what was published; some minutes.
    #[arg(long, conflicts_with_all = ["shape", "family", "vertices", "scalar", "modulus", "seed"])]
    flow: bool,
    /// Write a page to this file: which method is the cheapest for an accuracy, with figures, tables and
    /// pictures; by default of all methods.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["flow", "stability"])]
    html: Option<PathBuf>,
    /// With larger meshes, every number type, the capsule in flow and what effects cost: some minutes.
    #[arg(long, requires = "html")]
    full: bool,
    /// Also write every figure of the page as SVG and PNG to this folder.
    #[arg(long, value_name = "FOLDER", requires = "html")]
    figures: Option<PathBuf>,
    /// Where measurements are kept for the next time, as if interrupted; for pages by default in the
    /// user's folder of caches.
    #[arg(long, value_name = "FILE", conflicts_with = "stability")]
    cache: Option<PathBuf>,
    /// Measure everything again.
    #[arg(long)]
    fresh: bool,
    /// Also write the rows as JSON to this file; `-` for standard output, instead of the table.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Instead, whether every method and formula stands hard cases, in every number type: exit code
    /// 4 if one does not.
    #[arg(long, conflicts_with_all = ["flow", "shape", "method", "family", "vertices", "scalar", "modulus", "seed"])]
    stability: bool,
    /// With a mesh of a million vertices among the hard cases, which takes minutes and 4 GB.
    #[arg(long, requires = "stability")]
    large: bool,
    /// Only one group of hard cases: geometry, cancellation, dynamics, threads or input.
    #[arg(long, requires = "stability")]
    group: Option<Group>,
    /// Also write the table of hard cases as Markdown to this file.
    #[arg(long, requires = "stability")]
    markdown: Option<PathBuf>,
}

pub(super) fn methods(name: &str) -> Result<Vec<BendingMethod>, String> {
    match name {
        "all" => Ok(BendingMethod::ALL.to_vec()),
        name => Ok(vec![name.parse().map_err(|error| format!("{error}"))?]),
    }
}

fn families(name: &str) -> Result<Vec<Family>, String> {
    match name {
        "all" => Ok(Family::ALL.to_vec()),
        name => Ok(vec![name.parse().map_err(|error| format!("{error}"))?]),
    }
}

pub(super) fn study(arguments: &StudyArguments) -> Result<(), Failure> {
    if arguments.flow {
        return flow_study(arguments);
    }
    if arguments.stability {
        return stability(arguments);
    }
    let page = arguments.html.is_some();
    let or = |given: Vec<BendingMethod>, none: &[BendingMethod]| match given {
        given if given.is_empty() => none.to_vec(),
        given => unique(given),
    };
    let study = Study {
        shape: arguments.shape,
        families: unique(arguments.family.concat()),
        vertices: match &arguments.vertices {
            none if none.is_empty() => {
                let larger = arguments.full.then_some(163_842);
                NUMBERS.into_iter().chain(larger).collect()
            }
            numbers => numbers.clone(),
        },
        methods: or(
            arguments.method.concat(),
            if page { &BendingMethod::ALL } else { &COMPARED },
        ),
        scalars: match arguments.scalar.clone() {
            none if none.is_empty() => match (page, arguments.full) {
                (_, true) => Scalar::ALL.to_vec(),
                (true, _) => vec![Scalar::F32, Scalar::F64],
                _ => vec![Scalar::F64],
            },
            scalars => unique(scalars),
        },
        modulus: arguments.modulus,
        seed: arguments.seed,
    };
    check_outputs(
        file_named(arguments.json.as_ref())
            .into_iter()
            .chain(arguments.html.as_deref()),
    )?;
    if let Some(folder) = &arguments.figures {
        fs::create_dir_all(folder).map_err(|error| Failure::output(folder.display(), &error))?;
    }
    let stop = interruption();
    let interrupted = || stop.load(Ordering::Relaxed);
    let mut cache = cache(arguments)?;
    let bar = progress_bar();
    let rows = study.run_in(&mut Session {
        progress: &mut |Progress { done, total, at }| {
            bar.set_length(total);
            bar.set_position(done);
            bar.set_message(at.to_owned());
        },
        interrupted: &interrupted,
        cache: cache.as_mut(),
        allocated: Some(&super::allocated),
    });
    bar.finish_and_clear();
    let rows = rows.map_err(|error| {
        keep(cache.as_mut());
        Failure::input(error)
    })?;
    keep(cache.as_mut());
    let verdicts = verdicts(&rows);
    if interrupted() {
        if !page {
            show_rows(arguments, &rows, |out| report::study_table(&rows, out))?;
        }
        return Err(left_off(cache.as_ref()));
    }
    let Some(file) = &arguments.html else {
        return show_rows(arguments, &rows, |out| {
            report::study_table(&rows, out)?;
            report::verdict_table(&verdicts, out)
        });
    };
    let (flow, effects) = if arguments.full {
        let flow = flow_rows(&FlowStudy::brief(), cache.as_mut(), &interrupted)?;
        let effects = effects(cache.as_mut(), &interrupted)?;
        keep(cache.as_mut());
        if interrupted() {
            return Err(left_off(cache.as_ref()));
        }
        (flow, effects)
    } else {
        (Vec::new(), None)
    };
    // As fine as shows where errors are, and no finer than can be seen.
    let pictured = rows.iter().map(|row| row.vertices);
    let pictured = pictured.filter(|&vertices| vertices <= 2562).max();
    let errors = match pictured {
        Some(vertices) => study.error_fields(vertices, Quantity::ForceDensity),
        None => Ok(Vec::new()),
    };
    let errors = errors.map_err(Failure::input)?;
    let page = report::Page {
        rows: &rows,
        verdicts: &verdicts,
        errors: &errors,
        flow: &flow,
        effects: effects.as_ref(),
        provenance: &Provenance::here(BUILD),
        command: &command(),
        when: SystemTime::now(),
        reused: cache.as_ref().map_or(0, Cache::used),
    };
    save(file, |out| page.write(out))?;
    if let Some(folder) = &arguments.figures {
        page.write_figures(folder)
            .map_err(|error| Failure::output(folder.display(), &error))?;
    }
    show_rows(arguments, &rows, |out| {
        report::study_table(&rows, out)?;
        report::verdict_table(&verdicts, out)?;
        writeln!(out, "\nwritten to {}", file.display())
    })
}

/// The meshes of a study.
const NUMBERS: [usize; 4] = [642, 2562, 10_242, 40_962];

/// Vertices of the capsule whose effects are taken away: enough that they, and not what surrounds
/// them, take the time.
const EFFECTS_AT: usize = 642;

/// The arguments as they were given; of the program, only its name.
fn command() -> String {
    let arguments = std::env::args().skip(1).map(|argument| {
        if argument.contains(|c: char| c.is_whitespace() || c == '\'') {
            format!("{argument:?}")
        } else {
            argument
        }
    });
    let all = std::iter::once("helfrich".to_owned()).chain(arguments);
    Vec::from_iter(all).join(" ")
}

/// The cache that is asked for, or that pages have by default.
fn cache(arguments: &StudyArguments) -> Result<Option<Cache>, Failure> {
    let provenance = Provenance::here(BUILD);
    let by_default = || arguments.html.as_ref().and_then(|_| default_cache());
    let Some(path) = arguments.cache.clone().or_else(by_default) else {
        return Ok(None);
    };
    let opened = Cache::open(&path, &provenance);
    let opened = match opened {
        Ok(opened) => opened,
        // Nobody has asked for it.
        Err(error) if arguments.cache.is_none() => {
            say(format_args!("warning: {error}"));
            return Ok(None);
        }
        Err(error) => return Err(Failure::input(error)),
    };
    if arguments.cache.is_some() {
        check_outputs([path.as_path()])?;
    }
    let LoadedCache { mut cache, unused } = opened;
    if let Some(problem) = unused
        && !arguments.fresh
    {
        say(format_args!("warning: {}: {problem}", path.display()));
    }
    if arguments.fresh {
        cache.clear();
    }
    Ok(Some(cache))
}

/// Where the user's programs keep what they can make again; none if there is no such place.
fn default_cache() -> Option<PathBuf> {
    let variable = |name: &str| {
        let path = PathBuf::from(std::env::var_os(name)?);
        path.is_absolute().then_some(path)
    };
    let caches = variable("XDG_CACHE_HOME").or_else(|| Some(variable("HOME")?.join(".cache")));
    let folder = caches?.join("helfrich");
    fs::create_dir_all(&folder).ok()?;
    Some(folder.join("study.cache"))
}

/// Writes what has been measured. That it cannot be kept does not spoil what is known.
fn keep(cache: Option<&mut Cache>) {
    if let Some(Err(error)) = cache.map(Cache::save) {
        say(format_args!("warning: measurements are not kept: {error}"));
    }
}

/// What an interrupted study says.
fn left_off(cache: Option<&Cache>) -> Failure {
    match cache {
        Some(cache) => say(format_args!(
            "interrupted: what has been measured is kept in {}, and the same command goes on from there",
            cache.path().display()
        )),
        None => say("interrupted: with --cache FILE, measurements would have been kept"),
    }
    Failure::Unfinished(130)
}

fn flow_rows(
    study: &FlowStudy,
    cache: Option<&mut Cache>,
    interrupted: &dyn Fn() -> bool,
) -> Result<Vec<FlowRow>, Failure> {
    let bar = progress_bar();
    bar.set_length(1000);
    let rows = study.run_with(cache, interrupted, &mut |progress| {
        bar.set_position((1000.0 * progress.fraction) as u64);
        bar.set_message(progress.case.to_string());
    });
    bar.finish_and_clear();
    rows.map_err(of_flow)
}

fn effects(
    cache: Option<&mut Cache>,
    interrupted: &dyn Fn() -> bool,
) -> Result<Option<EffectCosts>, Failure> {
    let bar = progress_bar();
    bar.set_length(1000);
    let costs = effect_costs(EFFECTS_AT, cache, interrupted, &mut |share, at| {
        bar.set_position((1000.0 * share) as u64);
        bar.set_message(at.to_owned());
    });
    bar.finish_and_clear();
    costs.map_err(of_flow)
}

fn of_flow(error: FlowStudyError) -> Failure {
    match error {
        FlowStudyError::Scene { .. } => Failure::input(error),
        _ => Failure::Output(error.to_string()),
    }
}

/// Writes rows as JSON to the file that is asked for, and the table to standard output; or the JSON
/// there.
fn show_rows(
    arguments: &StudyArguments,
    rows: &impl serde::Serialize,
    table: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Failure> {
    let json = |out: &mut dyn Write| {
        serde_json::to_writer_pretty(&mut *out, rows)?;
        writeln!(out)
    };
    match (&arguments.json, file_named(arguments.json.as_ref())) {
        (Some(_), None) => print(json),
        (_, None) => print(table),
        (_, Some(path)) => {
            print(table)?;
            save(path, json)
        }
    }
}

/// The methods that a study compares by default.
const COMPARED: [BendingMethod; 3] = [
    BendingMethod::KantorNelson,
    BendingMethod::GompperKroll,
    BendingMethod::Meyer,
];

fn flow_study(arguments: &StudyArguments) -> Result<(), Failure> {
    let mut study = FlowStudy::default();
    if !arguments.method.is_empty() {
        study.methods = unique(arguments.method.concat());
        study.lattice_methods.clone_from(&study.methods);
    }
    check_outputs(file_named(arguments.json.as_ref()))?;
    let stop = interruption();
    let interrupted = || stop.load(Ordering::Relaxed);
    let mut cache = cache(arguments)?;
    let rows = flow_rows(&study, cache.as_mut(), &interrupted);
    keep(cache.as_mut());
    let rows = rows?;
    show_rows(arguments, &rows, |out| report::flow_tables(&rows, out))?;
    if stop.load(Ordering::Relaxed) {
        return Err(Failure::Unfinished(130));
    }
    Ok(())
}

fn stability(arguments: &StudyArguments) -> Result<(), Failure> {
    let json = file_named(arguments.json.as_ref());
    check_outputs(json.into_iter().chain(arguments.markdown.as_deref()))?;
    let table = Stability {
        large: arguments.large,
        group: arguments.group,
    };
    let bar = progress_bar();
    let rows = table.run(&mut |Progress { done, total, at }| {
        bar.set_length(total);
        bar.set_position(done);
        bar.set_message(at.to_owned());
    });
    bar.finish_and_clear();
    let rows = rows.map_err(Failure::input)?;
    show_rows(arguments, &rows, |out| report::stability_table(&rows, out))?;
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

/// Each value once, in the order of its first mention.
pub(super) fn unique<V: PartialEq + Copy>(values: Vec<V>) -> Vec<V> {
    let mut seen = Vec::with_capacity(values.len());
    for value in values {
        if !seen.contains(&value) {
            seen.push(value);
        }
    }
    seen
}
