//! `helfrich study`.

use super::{OptionArguments, method, method_names, own_methods, positive};
use crate::terminal::{
    Failure, ProgressBar, check_outputs, file_named, interruption, print, save, say, until_stopped,
};
use helfrich_std::execute::{Interruption, interruptible};
use helfrich_std::generate::{AnyShape, Family};
use helfrich_std::io::remove_unfinished;
use helfrich_std::lock::{Lock, LockError};
use helfrich_std::method::{AnyMethod, BendingMethod};
use helfrich_std::provenance::{Build, Provenance};
use helfrich_std::report;
use helfrich_std::report::page::{Page, Section};
use helfrich_std::scalar::Scalar;
use helfrich_std::study::{
    Cache, LoadedCache, NoiseRow, NoiseStudy, Quantity, Row, Session, Study, StudyProgress,
};
use helfrich_std::verdict::verdicts;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::SystemTime;

/// How this program was built, by its build script.
pub const BUILD: Build = Build {
    commit: env!("HELFRICH_COMMIT"),
    compiler: env!("HELFRICH_COMPILER"),
    profile: env!("HELFRICH_PROFILE"),
    flags: env!("HELFRICH_FLAGS"),
    target: env!("HELFRICH_TARGET"),
};

/// The arguments of a study.
#[derive(Debug, clap::Args)]
pub struct StudyArguments {
    /// Exact shape: sphere[:R], ellipsoid[:a,b,c], torus[:R,r] or discocyte[:R].
    #[arg(long, default_value = "discocyte")]
    shape: AnyShape,
    #[arg(long, value_delimiter = ',', value_parser = methods, help = format!(
        "Methods by name or letter, or `all`: {}; jet is j4, j6 or j8, by the number of vertices. By default A,B,C,J6",
        method_names()
    ))]
    method: Vec<Vec<AnyMethod>>,
    #[command(flatten)]
    options: OptionArguments,
    /// Mesh families: regular, smooth, relaxed, irregular, hard, or `all`.
    #[arg(long, value_delimiter = ',', default_value = "regular,irregular", value_parser = families)]
    family: Vec<Vec<Family>>,
    /// Numbers of vertices, 12 or more, in any order. Meshes with 10·4^k + 2 vertices are the most
    /// regular; meshes of the torus have these numbers within 1 %. By default 642,2562,10242,40962.
    #[arg(long, value_delimiter = ',')]
    vertices: Vec<usize>,
    /// Number types: f32, f32-pair (positions as pairs of f32), f64. By default f64; with `--html`
    /// f32,f64.
    #[arg(long, value_delimiter = ',')]
    scalar: Vec<Scalar>,
    /// Bending modulus κ.
    #[arg(long, default_value_t = 1.0, value_parser = positive, allow_negative_numbers = true)]
    modulus: f64,
    /// Seed of the random mesh families.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write a page to this file that names the cheapest method for each accuracy, with figures, tables
    /// and pictures; by default of all methods.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Also write every figure of the page as SVG and PNG to this folder.
    #[arg(long, value_name = "FOLDER", requires = "html")]
    figures: Option<PathBuf>,
    /// Also write the rows as JSON to this file; `-` writes them to standard output instead of the table.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Also write the rows as CSV to this file; `-` writes them to standard output instead of the table.
    #[arg(long)]
    csv: Option<PathBuf>,
    /// Compare methods, `jet` and the best fixed fit on noisy vertices instead. The values are standard
    /// deviations of every coordinate in mean edge lengths, from 0 to 1; by default with 2562 vertices and
    /// all methods. With `--html` this comparison is added to the page.
    #[arg(
        long,
        value_name = "EDGES",
        value_delimiter = ',',
        num_args = 0..=1,
        default_missing_value = "0,1e-4,1e-3,1e-2,3e-2",
        value_parser = part_of_edge
    )]
    noise: Option<Vec<f64>>,
    #[command(flatten)]
    kept: CacheArguments,
}

/// A standard deviation in mean edges.
fn part_of_edge(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err("a number from 0 to 1 is needed".to_owned()),
    }
}

/// The cache of measurements.
#[derive(Debug, clap::Args)]
pub struct CacheArguments {
    /// File in which measurements are kept, so that a repeated or interrupted study reuses them; by
    /// default, for pages only, in the user's cache folder.
    #[arg(long, value_name = "FILE")]
    cache: Option<PathBuf>,
    /// Measure everything again.
    #[arg(long)]
    fresh: bool,
}

/// Further sections for a page, from further measurements; none if interrupted.
pub type More<'a> =
    &'a mut dyn FnMut(Option<&mut Cache>, &dyn Fn() -> bool) -> Result<Vec<Section>, Failure>;

/// The methods of a name or letter, or of `all`, which includes operators for curvatures only and the
/// caller's own methods.
///
/// # Errors
/// If no method has that name.
pub fn methods(name: &str) -> Result<Vec<AnyMethod>, String> {
    match name {
        "all" => Ok(all_methods()),
        name => Ok(vec![method(name)?]),
    }
}

fn all_methods() -> Vec<AnyMethod> {
    with_own([&BendingMethod::ALL[..], &BendingMethod::CURVATURES].concat())
}

/// These methods, and the caller's own.
fn with_own(listed: Vec<BendingMethod>) -> Vec<AnyMethod> {
    let listed = listed.into_iter().map(AnyMethod::from);
    listed.chain(own_methods().iter().copied()).collect()
}

fn families(name: &str) -> Result<Vec<Family>, String> {
    match name {
        "all" => Ok(Family::ALL.to_vec()),
        name => Ok(vec![name.parse().map_err(|error| format!("{error}"))?]),
    }
}

/// Runs a study: prints its table, or writes its page.
pub(super) fn study(arguments: &StudyArguments) -> Result<(), Failure> {
    study_with(arguments, None)
}

/// Writes the page of a larger study, in every number type, with more parts on it.
///
/// # Errors
/// If the arguments are invalid, no file is named for the page, or it cannot be written.
pub fn full_page(arguments: &StudyArguments, more: More<'_>) -> Result<(), Failure> {
    if arguments.html.is_none() {
        return Err(Failure::Input("a page needs a file: --html FILE".into()));
    }
    study_with(arguments, Some(more))
}

fn study_with(arguments: &StudyArguments, more: Option<More<'_>>) -> Result<(), Failure> {
    let study = arguments.study(more.is_some())?;
    if [&arguments.json, &arguments.csv].map(|path| path.as_deref() == Some(Path::new("-")))
        == [true; 2]
    {
        let message = "--json - and --csv - both need standard output: name a file for one of them";
        return Err(Failure::Input(message.into()));
    }
    check_outputs(
        file_named(arguments.json.as_ref())
            .into_iter()
            .chain(file_named(arguments.csv.as_ref()))
            .chain(arguments.html.as_deref())
            .chain(arguments.kept.cache.as_deref()),
    )?;
    if arguments.noise.is_some() && arguments.html.is_none() {
        let rows = arguments.noise_rows()?;
        let table = |out: &mut dyn Write| report::noise_table(&rows, out);
        return show_rows(arguments.json.as_ref(), &rows, table);
    }
    let _figures = arguments.figures.as_deref().map(own_folder).transpose()?;
    let stop = interruption();
    let interrupted = || stop.load(Ordering::Relaxed);
    // A cache is valid for one program only.
    let name = match more {
        Some(_) => "full-study.cache",
        None => "study.cache",
    };
    let mut cache = arguments.kept.open(arguments.html.as_ref().map(|_| name))?;
    let mut bar = ProgressBar::default();
    let mut session = Session {
        progress: &mut |StudyProgress { done, total, at }| bar.show(done as f64 / total as f64, at),
        interrupted: &interrupted,
        cache: cache.as_mut(),
        allocated: Some(&super::allocated),
        timed: true,
    };
    let interruption = Interruption::by_flag(Arc::clone(&stop));
    let rows = interruptible(interruption, || study.run_in(&mut session));
    let rows = rows.unwrap_or(Ok(Vec::new()));
    bar.clear();
    keep(cache.as_mut());
    let rows = rows.map_err(Failure::input)?;
    let Some(file) = &arguments.html else {
        let rows_shown = arguments.show_rows(&rows, |out| {
            report::study_table(&rows, out)?;
            if interrupted() {
                return Ok(());
            }
            report::verdict_table(&verdicts(&rows), out)?;
            report::conclusion(&rows, out)
        });
        return match interrupted() {
            true => rows_shown.and(Err(left_off(cache.as_ref()))),
            false => rows_shown,
        };
    };
    if interrupted() {
        return Err(left_off(cache.as_ref()));
    }
    let sections = match more {
        Some(more) => more(cache.as_mut(), &interrupted),
        None => Ok(Vec::new()),
    };
    keep(cache.as_mut());
    let mut sections = sections?;
    if arguments.noise.is_some() {
        let noise = report::noise_section(&arguments.noise_rows()?);
        sections.push(noise.map_err(|error| Failure::output(file.display(), &error))?);
    }
    if interrupted() {
        return Err(left_off(cache.as_ref()));
    }
    let reused = cache.as_ref().map_or(0, Cache::used);
    arguments.write_page(file, (&study, &rows), &sections, reused)
}

impl StudyArguments {
    /// The requested study. A `full` one has larger meshes and every number type by default.
    fn study(&self, full: bool) -> Result<Study, Failure> {
        let page = self.html.is_some();
        let methods = match self.method.concat() {
            none if none.is_empty() && page => with_own(BendingMethod::ALL.to_vec()),
            none if none.is_empty() => with_own(COMPARED.to_vec()),
            given => unique(given),
        };
        Ok(Study {
            options: self.options.checked(&methods)?,
            methods,
            shape: self.shape,
            families: unique(self.family.concat()),
            vertices: match &self.vertices {
                none if none.is_empty() => {
                    NUMBERS.into_iter().chain(full.then_some(163_842)).collect()
                }
                numbers => numbers.clone(),
            },
            scalars: match self.scalar.clone() {
                none if none.is_empty() => match (page, full) {
                    (_, true) => Scalar::ALL.to_vec(),
                    (true, _) => vec![Scalar::F32, Scalar::F64],
                    _ => vec![Scalar::F64],
                },
                scalars => unique(scalars),
            },
            modulus: self.modulus,
            seed: self.seed,
        })
    }

    /// Measures methods on vertices with noise.
    fn noise_rows(&self) -> Result<Vec<NoiseRow>, Failure> {
        if self.csv.is_some() && self.html.is_none() {
            let message = "--noise has no CSV: take --json, or the table";
            return Err(Failure::Input(message.into()));
        }
        let methods = match self.method.concat() {
            none if none.is_empty() => all_methods(),
            given => unique(given),
        };
        let study = NoiseStudy {
            shape: self.shape,
            families: unique(self.family.concat()),
            vertices: match &self.vertices {
                none if none.is_empty() => vec![2562],
                numbers => numbers.clone(),
            },
            methods,
            deviations: self.noise.clone().map(unique).unwrap_or_default(),
            seed: self.seed,
        };
        let stop = interruption();
        let mut bar = ProgressBar::default();
        let rows = until_stopped(|| {
            let rows = study.run(&|| stop.load(Ordering::Relaxed), &mut |progress| {
                let StudyProgress { done, total, at } = progress;
                bar.show(done as f64 / total as f64, at);
            });
            Ok(rows)
        });
        bar.clear();
        let rows = rows?;
        if stop.load(Ordering::Relaxed) {
            return Err(Failure::Unfinished(130));
        }
        rows.map_err(Failure::input)
    }

    /// Writes the rows as CSV and JSON where that is asked for, and `table` unless one of them goes to
    /// standard output.
    fn show_rows(
        &self,
        rows: &[Row],
        table: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), Failure> {
        let csv = |out: &mut dyn Write| report::study_csv(rows, out);
        match (&self.csv, file_named(self.csv.as_ref())) {
            (None, _) => show_rows(self.json.as_ref(), &rows, table),
            (_, None) => show_rows(self.json.as_ref(), &rows, csv),
            (_, Some(path)) => {
                show_rows(self.json.as_ref(), &rows, table)?;
                save(path, csv)
            }
        }
    }

    fn write_page(
        &self,
        file: &Path,
        (study, rows): (&Study, &[Row]),
        sections: &[Section],
        reused: usize,
    ) -> Result<(), Failure> {
        let verdicts = verdicts(rows);
        // Fine enough to show the places of errors, and no finer than a picture can show.
        let pictured = rows.iter().map(|row| row.vertices);
        let pictured = pictured.filter(|&vertices| vertices <= 2562).max();
        let errors = match pictured {
            Some(vertices) => study.error_fields(vertices, Quantity::ForceDensity),
            None => Ok(Vec::new()),
        };
        let errors = errors.map_err(Failure::input)?;
        let page = Page {
            rows,
            verdicts: &verdicts,
            errors: &errors,
            sections,
            provenance: &Provenance::here(BUILD),
            command: &command(),
            when: SystemTime::now(),
            reused,
        };
        save(file, |out| page.write(out))?;
        if let Some(folder) = &self.figures {
            page.write_figures(folder)
                .map_err(|error| Failure::output(folder.display(), &error))?;
        }
        self.show_rows(rows, |out| {
            report::study_table(rows, out)?;
            report::verdict_table(&verdicts, out)?;
            report::conclusion(rows, out)?;
            writeln!(out, "\nwritten to {}", file.display())
        })
    }
}

/// A folder for figures with a lock on it: otherwise two processes could mix the figures of two
/// studies.
pub(crate) fn own_folder(folder: &Path) -> Result<Lock, Failure> {
    fs::create_dir_all(folder).map_err(|error| Failure::output(folder.display(), &error))?;
    let lock = Lock::of_folder(folder).map_err(|error| match error {
        LockError::Inaccessible { path, source } => Failure::output(path.display(), &source),
        taken => Failure::input(taken),
    })?;
    remove_unfinished(folder);
    Ok(lock)
}

/// The meshes of a study.
const NUMBERS: [usize; 4] = [642, 2562, 10_242, 40_962];

/// The command line; of the program's path, only the file name.
pub(crate) fn command() -> String {
    let program = std::env::args_os().next().unwrap_or_default();
    let program = Path::new(&program)
        .file_stem()
        .unwrap_or("helfrich".as_ref());
    let arguments = std::env::args().skip(1).map(|argument| {
        if argument.contains(|c: char| c.is_whitespace() || c == '\'') {
            format!("{argument:?}")
        } else {
            argument
        }
    });
    let all = std::iter::once(program.to_string_lossy().into_owned()).chain(arguments);
    Vec::from_iter(all).join(" ")
}

impl CacheArguments {
    /// The requested cache, or the cache of this name in the user's cache folder.
    ///
    /// # Errors
    /// If the requested file cannot be a cache.
    pub fn open(&self, default: Option<&str>) -> Result<Option<Cache>, Failure> {
        let by_default = || default.and_then(default_cache);
        let Some(path) = self.cache.clone().or_else(by_default) else {
            return Ok(None);
        };
        if let Some(folder) = path.parent() {
            remove_unfinished(folder);
        }
        if self.cache.is_some() {
            check_outputs([path.as_path()])?;
        }
        let opened = match Cache::open(&path, &Provenance::here(BUILD)) {
            Ok(opened) => opened,
            // The default cache was not requested, so a failure is only a warning.
            Err(error) if self.cache.is_none() => {
                say(format_args!("warning: {error}"));
                return Ok(None);
            }
            Err(error) => return Err(Failure::input(error)),
        };
        let LoadedCache { mut cache, unused } = opened;
        if let Some(problem) = unused
            && !self.fresh
        {
            say(format_args!("warning: {}: {problem}", path.display()));
        }
        if self.fresh {
            cache.clear();
        }
        Ok(Some(cache))
    }
}

/// The cache folder of the user; `None` if there is none.
fn default_cache(name: &str) -> Option<PathBuf> {
    let variable = |name: &str| {
        let path = PathBuf::from(std::env::var_os(name)?);
        path.is_absolute().then_some(path)
    };
    let caches = variable("XDG_CACHE_HOME").or_else(|| Some(variable("HOME")?.join(".cache")));
    let folder = caches?.join("helfrich");
    fs::create_dir_all(&folder).ok()?;
    Some(folder.join(name))
}

/// Writes the measurements. A failure is only a warning, because the results are still valid.
pub fn keep(cache: Option<&mut Cache>) {
    if let Some(Err(error)) = cache.map(Cache::save) {
        say(format_args!("warning: measurements are not kept: {error}"));
    }
}

/// The message of an interrupted study.
pub fn left_off(cache: Option<&Cache>) -> Failure {
    match cache {
        Some(cache) => say(format_args!(
            "interrupted: measurements so far are kept in {}, and the same command continues from there",
            cache.path().display()
        )),
        None => say("interrupted: with --cache FILE, measurements would have been kept"),
    }
    Failure::Unfinished(130)
}

/// Writes rows as JSON to the requested file and the table to standard output, or only the JSON to
/// standard output.
///
/// # Errors
/// If one of them cannot be written.
pub fn show_rows(
    json_option: Option<&PathBuf>,
    rows: &impl serde::Serialize,
    table: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Failure> {
    let json = |out: &mut dyn Write| {
        serde_json::to_writer_pretty(&mut *out, rows)?;
        writeln!(out)
    };
    match (json_option, file_named(json_option)) {
        (Some(_), None) => print(json),
        (_, None) => print(table),
        (_, Some(path)) => {
            print(table)?;
            save(path, json)
        }
    }
}

/// The methods that a study compares by default.
const COMPARED: [BendingMethod; 4] = [
    BendingMethod::KantorNelson,
    BendingMethod::GompperKroll,
    BendingMethod::Meyer,
    BendingMethod::J6,
];

/// Each value once, in the order of its first mention.
pub fn unique<V: PartialEq + Copy>(values: Vec<V>) -> Vec<V> {
    let mut seen = Vec::with_capacity(values.len());
    for value in values {
        if !seen.contains(&value) {
            seen.push(value);
        }
    }
    seen
}
