//! `helfrich recommend`.

use super::{MeshArguments, OptionArguments, ThreadArguments, load, refuse_replacing, warn};
use crate::study::{methods, unique};
use crate::terminal::{
    Failure, ProgressBar, check_outputs, file_named, interruption, print, save, until_stopped,
};
use helfrich::{Surface, TriangleMesh};
use helfrich_std::answer::Norm;
use helfrich_std::execute::Parallel;
use helfrich_std::io::MeshFile;
use helfrich_std::method::{AnyMethod, BendingMethod};
use helfrich_std::recommend::{Candidate, Recommendation, Request, recommend};
use helfrich_std::report;
use helfrich_std::scalar::Scalar;
use helfrich_std::study::{Quantity, StudyProgress};
use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::Ordering;

#[derive(clap::Args)]
pub(super) struct RecommendArguments {
    #[command(flatten)]
    input: MeshArguments,
    /// Largest allowed error, as in `1%` or `0.01`, relative to the largest value on the surface.
    #[arg(long, default_value = "1%", value_parser = share, allow_hyphen_values = true)]
    error: f64,
    /// Quantity that has to be accurate: H, K, LapH or f.
    #[arg(long, default_value = "f", value_parser = quantity)]
    quantity: Quantity,
    /// Norm of the error: `max`, at every vertex, or `mean`, on average.
    #[arg(long, default_value = "max", value_parser = norm)]
    norm: Norm,
    /// Methods to choose from, by name or letter; by default all.
    #[arg(long, value_delimiter = ',', default_value = "all", value_parser = candidates)]
    method: Vec<Vec<AnyMethod>>,
    #[command(flatten)]
    options: OptionArguments,
    /// Number types to choose from: f32, f32-pair, f64.
    #[arg(long, value_delimiter = ',', default_value = "f32,f64")]
    scalar: Vec<Scalar>,
    /// Also write the answer as JSON to this file; `-` writes it to standard output instead of the table.
    #[arg(long)]
    json: Option<PathBuf>,
    #[command(flatten)]
    pub(super) threads: ThreadArguments,
}

fn share(text: &str) -> Result<f64, String> {
    let (number, unit) = match text.trim().strip_suffix('%') {
        Some(number) => (number.trim_end(), 0.01),
        None => (text.trim(), 1.0),
    };
    match number.parse::<f64>() {
        Ok(value) if value > 0.0 && (value * unit).is_normal() => Ok(value * unit),
        _ => Err("a finite number above 0 is needed, as in 1% or 0.01".to_owned()),
    }
}

/// The methods of a name or letter, or of `all`, which includes `jet`.
fn candidates(name: &str) -> Result<Vec<AnyMethod>, String> {
    let mut named = methods(name)?;
    if name == "all" {
        named.push(BendingMethod::Jet.into());
    }
    Ok(named)
}

fn quantity(text: &str) -> Result<Quantity, String> {
    let named = Quantity::ALL
        .into_iter()
        .find(|quantity| quantity.symbol().eq_ignore_ascii_case(text));
    named.ok_or_else(|| "the quantities are H, K, LapH and f".to_owned())
}

fn norm(text: &str) -> Result<Norm, String> {
    let named = Norm::ALL.into_iter().find(|norm| norm.name() == text);
    named.ok_or_else(|| "the norms are max and mean".to_owned())
}

pub(super) fn recommend_method(arguments: &RecommendArguments) -> Result<(), Failure> {
    let methods = unique(arguments.method.concat());
    let options = arguments.options.checked(&methods)?;
    let json = file_named(arguments.json.as_ref());
    if let Some(json) = json {
        refuse_replacing(&arguments.input.mesh, "the mesh", json, "the answer")?;
    }
    let MeshFile {
        positions, mesh, ..
    } = load(&arguments.input)?;
    check_outputs(json)?;
    let request = Request {
        quantity: arguments.quantity,
        norm: arguments.norm,
        target: arguments.error,
        methods,
        options,
        scalars: unique(arguments.scalar.clone()),
    };
    let found = until_stopped(|| found(arguments, &request, &mesh, &positions))?;
    let write = |out: &mut dyn Write| {
        serde_json::to_writer_pretty(&mut *out, &found)?;
        writeln!(out)
    };
    match (&arguments.json, json) {
        (Some(_), None) => print(write),
        (_, None) => print(|out| report::recommendation(&found, out)),
        (_, Some(path)) => {
            print(|out| report::recommendation(&found, out))?;
            save(path, write)
        }
    }
}

/// The answer, which is measured; says what is doubtful about the mesh.
fn found(
    arguments: &RecommendArguments,
    request: &Request,
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
) -> Result<Recommendation, Failure> {
    let stop = interruption();
    let mut bar = ProgressBar::default();
    let found = recommend(
        mesh,
        positions,
        request,
        &|| stop.load(Ordering::Relaxed),
        &mut |StudyProgress { done, total, at }| {
            bar.show(done as f64 / total as f64, at);
        },
    );
    bar.clear();
    let found = found.map_err(|error| Failure::mesh(&arguments.input.mesh, error))?;
    let found = found.ok_or(Failure::Unfinished(130))?;
    if let Some(choice) = found.choice
        && let Ok(surface) = Surface::new(mesh, positions)
    {
        let Candidate {
            method, options, ..
        } = choice;
        let mut evaluator = method.evaluator(&options, 1.0, mesh, Parallel::new());
        evaluator.evaluate(surface);
        warn(&arguments.input.mesh, &evaluator.findings(surface));
    }
    Ok(found)
}
