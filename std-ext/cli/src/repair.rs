//! `helfrich repair`: a mesh of the triangles of a file that are none.

use crate::columns::write_with_columns;
use crate::terminal::{Failure, check_outputs, print};
use crate::{MeshArguments, refuse_replacing};
use helfrich_std::io::{Format, MeshFile, parse, read_soup, write_to};
use helfrich_std::repair::{RepairSettings, Sheets, repair};
use std::path::{Path, PathBuf};

/// The arguments of the command.
#[derive(clap::Args)]
pub(crate) struct RepairArguments {
    #[command(flatten)]
    input: MeshArguments,
    /// Sheets to keep at edges with three or more triangles: `split` keeps all, `largest` the one with the largest
    /// area.
    #[arg(long, value_name = "SHEETS", default_value = "split")]
    sheets: Sheets,
    /// Fill holes with at most this number of edges. Borders that span more than half of the area of their component
    /// are outlines, and stay.
    #[arg(long, value_name = "EDGES", default_value_t = 0)]
    fill: usize,
    /// Remove triangles with an angle below this one, in degrees, by flips and collapses of edges.
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, value_parser = angle)]
    slivers: f64,
    /// Turn closed components that are inside out, even if they are valid.
    #[arg(long)]
    outward: bool,
    /// Leave out vertices in no triangle of the file, too.
    #[arg(long)]
    drop_unused: bool,
    #[arg(long, short, help = format!(
        "Output file; its ending determines the format: {}. Numbers at vertices and faces are kept in .vtp",
        Format::writable()
    ))]
    output: PathBuf,
}

/// An angle from 0° to 60°, which the smallest angle of a triangle cannot exceed.
fn angle(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(angle) if (0.0..=60.0).contains(&angle) => Ok(angle),
        _ => Err("an angle from 0 to 60 degrees is needed".to_owned()),
    }
}

/// Runs the command.
pub(crate) fn repair_file(arguments: &RepairArguments) -> Result<(), Failure> {
    let (path, output) = (&arguments.input.mesh, &arguments.output);
    refuse_replacing(path, "the mesh", output, "the repaired mesh")?;
    check_outputs([output.as_path()])?;
    let (soup, columns) = read_soup(path).map_err(Failure::input)?;
    let settings = RepairSettings {
        weld: arguments.input.weld,
        sheets: arguments.sheets,
        fill: arguments.fill,
        slivers: arguments.slivers,
        outward: arguments.outward,
        drop_unused: arguments.drop_unused,
    };
    let repaired = repair(soup, &settings).map_err(|error| Failure::mesh(path, error))?;
    let columns = repaired.columns(columns);
    let file = &repaired.file;
    if Format::from_extension(output) == Some(Format::Stl) {
        check_stl(output, file)?;
    }
    write_with_columns(output, &file.positions, &file.mesh, &columns)?;
    let report = &repaired.report;
    print(|out| {
        if report.is_empty() {
            writeln!(
                out,
                "nothing to repair: {} is the same mesh",
                output.display()
            )?;
        }
        match report.to_string().as_str() {
            "" => Ok(()),
            lines => writeln!(out, "{lines}"),
        }
    })
}

/// Refuses to write a mesh as STL whose split vertices the reader of STL would merge again.
fn check_stl(output: &Path, file: &MeshFile) -> Result<(), Failure> {
    let mut bytes = Vec::new();
    write_to(&mut bytes, Format::Stl, &file.positions, &file.mesh)
        .map_err(|error| Failure::output(output.display(), &error))?;
    match parse(&bytes, Format::Stl) {
        Err(error) if error.is_repairable() => {
            let message = "an STL file has no numbers of vertices, and those at the same point become one again: \
                           choose .obj, .off, .ply or .vtp";
            Err(Failure::mesh(output, message))
        }
        _ => Ok(()),
    }
}
