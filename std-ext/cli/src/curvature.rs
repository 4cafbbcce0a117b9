//! `helfrich curvature`.

mod picture;

use crate::terminal::{
    Failure, ProgressBar, check_outputs, file_named, print, save, say, until_stopped,
};
use crate::{
    MeshArguments, OptionArguments, ThreadArguments, load, method_names, positive, refuse_replacing,
};
use clap::builder::PossibleValuesParser;
use helfrich::{AdaptiveJet, FitExtent, Surface};
use helfrich_std::execute::Parallel;
use helfrich_std::io::{MeshFile, write_vtp};
use helfrich_std::measurement::{Column, Measurement, in_numbers};
use helfrich_std::method::{AnyMethod, Compiled, Evaluated, Fields, MethodOptions};
use helfrich_std::orientation::inside_out;
use helfrich_std::painting::QUANTITIES;
use helfrich_std::remarks::{self, Remark};
use helfrich_std::report;
use helfrich_std::scalar::{HeldPositions, Scalar};
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(crate) struct CurvatureArguments {
    #[command(flatten)]
    input: MeshArguments,
    #[arg(long, default_value = "jet", value_parser = crate::method, help = format!(
        "Method by name or letter: {}; jet chooses degree and neighbours from the noise at each vertex",
        method_names()
    ))]
    method: AnyMethod,
    /// Bending modulus κ.
    #[arg(long, default_value_t = 1.0, value_parser = positive, allow_negative_numbers = true)]
    modulus: f64,
    #[command(flatten)]
    options: OptionArguments,
    /// Number type: f32, f32-pair (positions as pairs of f32) or f64.
    #[arg(long, default_value = "f64")]
    scalar: Scalar,
    /// Add principal curvatures, error bars and a verdict to the results of any method, by comparison with
    /// jets that choose their scale from the noise; `--method jet` always has them.
    #[arg(long)]
    errors: bool,
    /// Known standard deviation of the positions along the normal, a length: a lower bound of the noise
    /// that is assumed. By default the noise is estimated from the positions.
    #[arg(long, value_name = "LENGTH", value_parser = positive, allow_negative_numbers = true)]
    sigma: Option<f64>,
    /// Number of neighbours of the fits of `jet`, 28 to 4096. By default it is chosen from the noise, at
    /// each vertex and separately for H, K and f.
    #[arg(long, value_name = "NEIGHBOURS", value_parser = clap::value_parser!(u32).range(28..=4096))]
    scale: Option<u32>,
    /// Radius of the fits of `jet` instead, a length: they take all vertices within it, 28 to 4096 of them.
    #[arg(long, value_name = "LENGTH", value_parser = positive, allow_negative_numbers = true, conflicts_with = "scale")]
    radius: Option<f64>,
    /// Write to this file instead of standard output (`-`).
    #[arg(long)]
    csv: Option<PathBuf>,
    /// Write the surface with all results to this `.vtp` file; a table is then written only with `--csv`.
    #[arg(long, value_name = "FILE")]
    vtp: Option<PathBuf>,
    /// Draw the surface to this `.png` file, with principal directions if `--method jet` or `--errors` is
    /// given; a table is then written only with `--csv`. The surface is grey where twice the error bar
    /// exceeds the range of the colours.
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Quantity that the picture shows, by the name of its column; f is shown along the normal. Quantities
    /// other than H, K and f need `--method jet` or `--errors`.
    #[arg(
        long,
        value_name = "QUANTITY",
        default_value = "H",
        requires = "picture",
        value_parser = PossibleValuesParser::new(QUANTITIES)
    )]
    colour_by: String,
    #[command(flatten)]
    pub(crate) threads: ThreadArguments,
}

/// The measurement of the positions, if the arguments ask for one.
fn measurement(
    arguments: &CurvatureArguments,
    surface: Surface<'_, f64>,
) -> Result<Option<Measurement>, Failure> {
    let CurvatureArguments {
        sigma,
        scale,
        radius,
        ..
    } = arguments;
    if !(arguments.method.has_error_bars() || arguments.errors) {
        return Ok(None);
    }
    let jet = AdaptiveJet {
        deviation: sigma.unwrap_or(0.0),
        extent: match (scale, radius) {
            (Some(neighbours), _) => Some(FitExtent::Neighbours(*neighbours as usize)),
            (None, Some(radius)) => Some(FitExtent::Radius(*radius)),
            (None, None) => None,
        },
    };
    let mut bar = ProgressBar::default();
    let measured = Measurement::new(surface, &jet, &mut |done| {
        bar.show(done, "noise, and fits of every scale");
        true
    });
    bar.clear();
    let measured = measured.ok_or(Failure::Unfinished(130))?;
    tell(
        &arguments.input.mesh,
        remarks::of_measurement(surface, &measured),
    );
    Ok(Some(measured))
}

/// Prints remarks about a mesh.
fn tell(path: &Path, remarks: impl IntoIterator<Item = Remark>) {
    for remark in remarks {
        let (kind, path) = (remark.kind(), path.display());
        say(format_args!("{kind}: {path}: {}", remark.text));
    }
}

/// The largest number of components that are named.
const MOST_COMPONENTS: usize = 10;

/// Runs the command.
pub(crate) fn curvature(arguments: &CurvatureArguments) -> Result<(), Failure> {
    let CurvatureArguments {
        modulus, scalar, ..
    } = arguments;
    if !scalar.holds_modulus(*modulus) {
        let message = format!("the bending modulus {modulus} is out of the range of {scalar}");
        return Err(Failure::Input(message.into()));
    }
    let outputs = [
        (file_named(arguments.csv.as_ref()), "the table"),
        (arguments.vtp.as_deref(), "the surface"),
        (arguments.picture.as_deref(), "the picture"),
    ];
    for (path, new) in outputs {
        if let Some(path) = path {
            refuse_replacing(&arguments.input.mesh, "the mesh", path, new)?;
        }
    }
    check_outputs(outputs.into_iter().filter_map(|(path, _)| path))?;
    let is_measured = arguments.method.has_error_bars() || arguments.errors;
    let CurvatureArguments {
        sigma,
        scale,
        radius,
        ..
    } = arguments;
    if !is_measured && (sigma.is_some() || scale.is_some() || radius.is_some()) {
        let message = "--sigma, --scale and --radius are for --method jet, or with --errors";
        return Err(Failure::Input(message.into()));
    }
    if let Some(path) = &arguments.picture {
        picture::check(path, &arguments.colour_by, is_measured)?;
    }
    let options = arguments.options.checked(&[arguments.method])?;
    let file = load(&arguments.input)?;
    until_stopped(|| match arguments.scalar {
        Scalar::F32 | Scalar::F32Pair => curvature_in::<f32>(arguments, &options, &file),
        Scalar::F64 => curvature_in::<f64>(arguments, &options, &file),
    })
}

fn curvature_in<T: Compiled>(
    arguments: &CurvatureArguments,
    options: &MethodOptions,
    file: &MeshFile,
) -> Result<(), Failure> {
    let held = HeldPositions::<T>::new(arguments.scalar, &file.positions);
    let surface = held.surface(&file.mesh).map_err(|error| {
        Failure::mesh(
            &arguments.input.mesh,
            format!("{error} in {}", arguments.scalar),
        )
    })?;
    // In f64, from the positions as they are held: their digits count as noise.
    let exact = Vec::from_iter(held.positions().iter().map(|x| x.map(to_f64)));
    let exact = match arguments.scalar {
        Scalar::F32 => &exact,
        _ => &file.positions,
    };
    let exact = Surface::new(&file.mesh, exact)
        .map_err(|error| Failure::mesh(&arguments.input.mesh, error))?;
    for component in inside_out(exact).iter().take(MOST_COMPONENTS) {
        let path = arguments.input.mesh.display();
        say(format_args!("warning: {path}: {component}"));
    }
    let measured = measurement(arguments, exact)?;
    let modulus = arguments.modulus;
    if let Some(measured) = &measured
        && arguments.method.has_error_bars()
    {
        let fields = measured.fields(modulus);
        let mut columns = measured.columns(&fields, modulus);
        columns.extend(measured.columns_of_jets());
        return save_results(
            arguments,
            exact.positions(),
            &fields,
            &columns,
            Some(measured),
            file,
        );
    }
    let (method, number) = (arguments.method, T::constant(modulus));
    let mut evaluator = method.evaluator(options, number, &file.mesh, Parallel::new());
    let (fields, findings) = evaluator.fields_and_findings(surface);
    tell(&arguments.input.mesh, remarks::of_findings(&findings));
    tell(&arguments.input.mesh, remarks::of_method(method, &fields));
    // Noise is measured on the positions of the file, in f64: rounded to f32 it may not be visible.
    if measured.is_none()
        && let Ok(surface) = Surface::new(&file.mesh, &file.positions)
    {
        tell(&arguments.input.mesh, remarks::of_noise(surface));
    }
    let measured = measured.as_ref();
    let columns = measured.map_or_else(Vec::new, |measured| measured.columns(&fields, modulus));
    save_results(
        arguments,
        held.positions(),
        &fields,
        &columns,
        measured,
        file,
    )
}

fn to_f64<T: Evaluated>(x: T) -> f64 {
    x.to_f64().unwrap_or(f64::NAN)
}

/// Writes the table, the surface and the picture, as they are asked for.
fn save_results<T: Evaluated>(
    arguments: &CurvatureArguments,
    positions: &[[T; 3]],
    fields: &Fields<T>,
    columns: &[Column],
    measured: Option<&Measurement>,
    file: &MeshFile,
) -> Result<(), Failure> {
    let csv = |out: &mut dyn Write| report::curvature_csv(positions, fields, columns, out);
    if let Some(path) = &arguments.vtp {
        save_surface(path, fields, columns, file)?;
    }
    if let Some(path) = &arguments.picture {
        let surface = Surface::new(&file.mesh, &file.positions)
            .map_err(|error| Failure::mesh(&arguments.input.mesh, error))?;
        picture::draw(
            path,
            &arguments.colour_by,
            surface,
            fields,
            columns,
            measured,
        )?;
    }
    let is_written = arguments.vtp.is_some() || arguments.picture.is_some();
    if is_written && arguments.csv.is_none() {
        return Ok(());
    }
    match file_named(arguments.csv.as_ref()) {
        Some(path) => save(path, csv),
        None => {
            print(csv)?;
            if io::stdout().is_terminal() {
                say(COLUMNS);
                if measured.is_some() {
                    say(MEASURED_COLUMNS);
                }
            }
            Ok(())
        }
    }
}

/// The columns of the table, for those who read it on a screen.
const COLUMNS: &str = "\
H: mean curvature, positive on a sphere. K: Gaussian curvature. LapH: Laplacian of H along the surface.
fx, fy, fz: bending force per area. area, nx, ny, nz: area and normal of the vertex.
A column is empty where the method does not define it.";

/// Further columns of a measurement.
const MEASURED_COLUMNS: &str = "\
k1, k2: principal curvatures. curvedness, shape_index: their size and ratio, from -1 to 1. …_error: error bar of that column. sigma: noise of the position, a length.
verdict: whether to trust the row, explained in docs/CHOOSING.md.";

/// Writes the surface with all results as fields.
fn save_surface<T: Evaluated>(
    path: &Path,
    fields: &Fields<T>,
    columns: &[Column],
    file: &MeshFile,
) -> Result<(), Failure> {
    let columns = in_numbers(fields, columns);
    let all = Vec::from_iter(columns.iter().filter_map(Column::as_field));
    write_vtp(path, &file.mesh, &file.positions, None, &all)
        .map_err(|error| Failure::Output(error.to_string()))
}
