//! `helfrich remesh`: a new mesh of the smooth surface through the vertices of a file.

use crate::columns::write_with_columns;
use crate::terminal::{Failure, ProgressBar, check_outputs, print, say, until_stopped};
use crate::{MeshArguments, ThreadArguments, load_with_columns, positive, refuse_replacing};
use helfrich::{Remeshed, SmoothSurface, Surface, TriangleMesh, VertexKind};
use helfrich_std::io::{Column, ColumnPlace, Format};
use helfrich_std::remesh::{
    EdgeLengths, MeshRequest, NewMesh, OfNoise, RemeshError, carried, old_triangles, remeshed,
};
use std::path::PathBuf;

/// The arguments of the command.
#[derive(clap::Args)]
pub(crate) struct RemeshArguments {
    #[command(flatten)]
    input: MeshArguments,
    /// Number of vertices; by default that of the input, unless lengths are given.
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u32).range(4..))]
    vertices: Option<u32>,
    /// Length of the edges, in the unit of the file.
    #[arg(long, value_name = "LENGTH", value_parser = positive, conflicts_with = "vertices")]
    edge: Option<f64>,
    /// Lengths of the edges from the numbers at the vertices with this name, in a PLY, VTK or GIFTI file; with
    /// `--vertices`, relative to each other.
    #[arg(long, value_name = "COLUMN", conflicts_with = "edge")]
    field: Option<String>,
    /// Lengths by curvature: no edge turns by more than this angle, in degrees; with `--vertices`, relative to each
    /// other.
    #[arg(long, value_name = "DEGREES", value_parser = positive, conflicts_with_all = ["edge", "field"])]
    curvature: Option<f64>,
    /// Edges as long as the error of H may be at most this part of the largest |H|, as in `1%` or `0.01`.
    #[arg(
        long,
        value_name = "PART",
        value_parser = part,
        conflicts_with_all = ["edge", "field", "curvature", "vertices"]
    )]
    error: Option<f64>,
    /// Keep edges as creases at which the triangles differ by more than this angle, in degrees.
    #[arg(long, value_name = "DEGREES", default_value_t = 60.0, value_parser = positive)]
    creases: f64,
    /// Remove the noise of the positions first.
    #[arg(long)]
    smooth: bool,
    /// Output file; its ending determines the format. Numbers at vertices and triangles are kept in `.vtp`.
    #[arg(long, short)]
    output: PathBuf,
    #[command(flatten)]
    pub(crate) threads: ThreadArguments,
}

/// A part of a whole, above 0, also in per cent.
fn part(text: &str) -> Result<f64, String> {
    let (number, unit) = match text.strip_suffix('%') {
        Some(number) => (number, 0.01),
        None => (text, 1.0),
    };
    match number.trim().parse::<f64>() {
        Ok(part) if part > 0.0 && part.is_finite() => Ok(part * unit),
        _ => Err("a part above 0, as in 1% or 0.01, is needed".to_owned()),
    }
}

/// Runs the command.
pub(crate) fn remesh_file(arguments: &RemeshArguments) -> Result<(), Failure> {
    let (path, output) = (&arguments.input.mesh, &arguments.output);
    refuse_replacing(path, "the mesh", output, "the new mesh")?;
    check_outputs([output.as_path()])?;
    let (file, columns) = load_with_columns(&arguments.input)?;
    let surface = Surface::new(&file.mesh, &file.positions);
    let surface = surface.map_err(|error| Failure::mesh(path, error))?;
    let request = MeshRequest {
        lengths: lengths(arguments, &columns, surface)?,
        vertices: vertices(arguments, surface),
        creases: arguments.creases.to_radians(),
        noise: OfNoise::removed_if(arguments.smooth),
    };
    let mut bar = ProgressBar::default();
    let found = until_stopped(|| {
        bar.show(0.0, "fits");
        let found = remeshed(surface, &request, &mut |done| {
            bar.show(done, "rounds of splits, collapses, flips and movements");
            true
        });
        found.map_err(|error| match error {
            RemeshError::Noise(_) => {
                Failure::mesh(path, format_args!("{error}: --smooth removes it first"))
            }
            _ => Failure::mesh(path, error),
        })
    });
    bar.clear();
    let NewMesh {
        smooth,
        made,
        moved,
    } = found?;
    if let Some(moved) = moved {
        say(format_args!(
            "note: {}: the noise is removed: vertices are moved by {moved:.1e}, root mean square",
            path.display()
        ));
    }
    let shown = path.display();
    if !smooth.lines().is_empty() {
        say(format_args!(
            "note: {shown}: {} edges are kept as creases, because their triangles differ by more than {}°: each side \
             is fitted alone",
            smooth.lines().len(),
            arguments.creases
        ));
    }
    let flat = made
        .points
        .iter()
        .filter(|point| point.mean.is_nan())
        .count();
    if flat > 0 {
        say(format_args!(
            "note: {shown}: {flat} vertices are on flat triangles, because fits disagree there, or triangles would cross"
        ));
    }
    let positions = Vec::from_iter(made.points.iter().map(|point| point.position));
    let keeps = Format::from_extension(output) == Some(Format::Vtp);
    let columns = if keeps {
        with_new_values(columns, &smooth, &made)
    } else {
        columns
    };
    write_with_columns(output, &positions, &made.mesh, &columns)?;
    let (old, new) = (surface.mesh(), &made.mesh);
    let known = made.points.iter().map(|point| point.position_error);
    let known = known.filter(|error| error.is_finite());
    print(|out| {
        writeln!(
            out,
            "{}: {} vertices, {} triangles (before: {}, {}), smallest angle {:.1}°",
            output.display(),
            new.vertex_count(),
            new.triangles().len(),
            old.vertex_count(),
            old.triangles().len(),
            smallest_angle(new, &positions)
        )?;
        writeln!(
            out,
            "distance from the surface through the old vertices: at most about {:.1e}, by the disagreement of fits",
            known.fold(0.0, f64::max)
        )
    })
}

/// Columns at the vertices and triangles of a new mesh.
fn with_new_values(
    mut columns: Vec<Column>,
    smooth: &SmoothSurface<f64>,
    made: &Remeshed<f64>,
) -> Vec<Column> {
    let old_triangles = old_triangles(made);
    let (at_vertices, of_triangles): (Vec<_>, Vec<_>) = columns
        .iter_mut()
        .partition(|column| column.place == ColumnPlace::Vertices);
    let fields = Vec::from_iter(at_vertices.iter().map(|column| &column.values[..]));
    let fields = carried(smooth, &made.places, &fields);
    for (column, values) in at_vertices.into_iter().zip(fields) {
        column.values = values;
    }
    for column in of_triangles {
        let values = old_triangles.iter().map(|&old| column.values[old]);
        column.values = values.collect();
    }
    columns
}

/// The number of vertices that the arguments ask for; that of the input if they name no lengths.
fn vertices(arguments: &RemeshArguments, surface: Surface<'_, f64>) -> Option<usize> {
    let RemeshArguments {
        edge,
        field,
        curvature,
        error,
        ..
    } = arguments;
    let given = arguments.vertices.map(|number| number as usize);
    if edge.is_some() || field.is_some() || curvature.is_some() || error.is_some() {
        return given;
    }
    let kinds = surface.mesh().vertex_kinds().iter();
    let used = kinds.filter(|kind| **kind != VertexKind::Isolated);
    given.or(Some(used.count()))
}

/// The lengths that the arguments ask for.
fn lengths(
    arguments: &RemeshArguments,
    columns: &[Column],
    surface: Surface<'_, f64>,
) -> Result<EdgeLengths, Failure> {
    if let Some(angle) = arguments.curvature {
        return Ok(EdgeLengths::ByCurvature(angle.to_radians()));
    }
    if let Some(part) = arguments.error {
        return Ok(EdgeLengths::ByError(part));
    }
    let Some(name) = &arguments.field else {
        return Ok(EdgeLengths::Uniform(arguments.edge.unwrap_or(1.0)));
    };
    let at_vertices = columns
        .iter()
        .filter(|column| column.place == ColumnPlace::Vertices);
    let Some(column) = at_vertices.clone().find(|column| column.name == *name) else {
        let names = Vec::from_iter(at_vertices.map(|column| column.name.as_str()));
        let message = match names.as_slice() {
            [] => format!("there is no column `{name}`: the file has no numbers at vertices"),
            _ => format!(
                "there is no column `{name}` at vertices: there are {}",
                names.join(", ")
            ),
        };
        return Err(Failure::mesh(&arguments.input.mesh, message));
    };
    let is_used = |vertex: usize| surface.mesh().valence(vertex) > 0;
    let bad = column.values.iter().enumerate();
    let mut bad =
        bad.filter(|&(vertex, length)| is_used(vertex) && !(*length > 0.0 && length.is_finite()));
    if let Some((vertex, length)) = bad.next() {
        let message = format!(
            "column `{name}` has the length {length} at vertex {vertex}: lengths are above 0"
        );
        return Err(Failure::mesh(&arguments.input.mesh, message));
    }
    Ok(EdgeLengths::AtVertices(column.values.clone()))
}

fn smallest_angle(mesh: &TriangleMesh, positions: &[[f64; 3]]) -> f64 {
    let Ok(surface) = Surface::new(mesh, positions) else {
        return 0.0;
    };
    let angles = (0..mesh.triangles().len()).flat_map(|triangle| surface.triangle_angles(triangle));
    angles.fold(f64::INFINITY, f64::min).to_degrees()
}
