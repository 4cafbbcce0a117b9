//! `helfrich smooth`: the mesh of a file with smoother positions.

use crate::columns::write_with_columns;
use crate::terminal::{Failure, ProgressBar, check_outputs, print, say, until_stopped};
use crate::{MeshArguments, ThreadArguments, load_with_columns, positive, refuse_replacing};
use helfrich::{Smoothing, Surface};
use helfrich_std::io::Format;
use helfrich_std::noise::NotQuieted;
use helfrich_std::report;
use helfrich_std::smoothing::{Smoother, smooth};
use std::path::PathBuf;

/// The arguments of the command.
#[derive(clap::Args)]
pub(crate) struct SmoothArguments {
    #[command(flatten)]
    input: MeshArguments,
    /// Number of neighbours of the fits, 28 to 4096, whatever the noise is: more of them smooth more. The fits have
    /// degree 4. By default number and degree are chosen from the noise.
    #[arg(long, value_name = "NEIGHBOURS", value_parser = clap::value_parser!(u32).range(28..=4096))]
    scale: Option<u32>,
    /// Smooth by one implicit step of mean-curvature flow instead, of this time: a length squared, in the unit of the
    /// file. Waves of length L are multiplied by 1/(1 + 39.5 TIME/L²).
    #[arg(long, value_name = "TIME", value_parser = positive, conflicts_with = "scale")]
    flow: Option<f64>,
    #[arg(long, short, help = format!(
        "Output file; its ending determines the format: {}. Numbers at vertices and triangles are kept in .vtp",
        Format::writable()
    ))]
    output: PathBuf,
    #[command(flatten)]
    pub(crate) threads: ThreadArguments,
}

/// Runs the command.
pub(crate) fn smooth_file(arguments: &SmoothArguments) -> Result<(), Failure> {
    let (path, output) = (&arguments.input.mesh, &arguments.output);
    refuse_replacing(path, "the mesh", output, "the smooth mesh")?;
    check_outputs([output.as_path()])?;
    let (file, columns) = load_with_columns(&arguments.input)?;
    let surface = Surface::new(&file.mesh, &file.positions);
    let surface = surface.map_err(|error| Failure::mesh(path, error))?;
    let smoother = match (arguments.scale, arguments.flow) {
        (Some(neighbours), _) => Smoother::Scale(Smoothing::of_neighbours(neighbours as usize)),
        (_, Some(time)) => Smoother::Flow(time),
        _ => Smoother::Noise,
    };
    let mut bar = ProgressBar::default();
    let found = until_stopped(|| {
        let found = smooth(surface, smoother, &mut |done| {
            bar.show(done, "noise, and fits of every scale");
            true
        });
        found.map_err(|error| Failure::mesh(path, error))
    });
    bar.clear();
    let found = found?;
    let shown = path.display();
    match &found.unmoved {
        Some(reason @ NotQuieted::NoNoise) => say(format_args!(
            "note: {shown}: {reason}: no vertex is moved; --scale or --flow smooth it nevertheless"
        )),
        Some(reason) => say(format_args!(
            "warning: {shown}: {reason}; no vertex is moved: --scale or --flow smooth it nevertheless"
        )),
        None => {}
    }
    write_with_columns(output, &found.positions, &file.mesh, &columns)?;
    print(|out| report::smoothing(&found, out))
}
