//! `helfrich split`: the connected components of a mesh file, each in a file of its own.

use crate::columns::write_with_columns;
use crate::terminal::{Failure, print, say};
use crate::{MeshArguments, load_with_columns};
use helfrich::{Components, Surface};
use helfrich_std::io::{Column, ColumnPlace, Format};
use std::fs;
use std::path::PathBuf;

/// The arguments of the command.
#[derive(clap::Args)]
pub(crate) struct SplitArguments {
    #[command(flatten)]
    input: MeshArguments,
    /// Leave out components with fewer vertices, such as specks of a segmentation.
    #[arg(long, value_name = "VERTICES", default_value_t = 4)]
    least: usize,
    #[arg(long, value_name = "ENDING", default_value = "vtp", value_parser = writable, help = format!(
        "Format of the files: {}. Numbers at vertices and triangles are kept in .vtp", Format::writable()
    ))]
    format: String,
    /// Folder for the files component-1, component-2 and so on, in the order of their first vertices.
    #[arg(long, short)]
    out: PathBuf,
}

/// The ending of a format that can be written.
fn writable(text: &str) -> Result<String, String> {
    let ending = text.trim_start_matches('.');
    let known = Format::writable();
    let mut words = known.split([',', ' ']);
    if words.any(|word| word.strip_prefix('.') == Some(ending)) {
        return Ok(ending.to_owned());
    }
    Err(format!("one of {known} is needed"))
}

/// The columns at these vertices and triangles.
fn columns_of(columns: &[Column], vertices: &[u32], triangles: &[u32]) -> Vec<Column> {
    let own = columns.iter().map(|column| {
        let places = match column.place {
            ColumnPlace::Vertices => vertices,
            ColumnPlace::Triangles => triangles,
        };
        let values = places.iter().map(|&place| column.values[place as usize]);
        Column {
            values: values.collect(),
            ..column.clone()
        }
    });
    own.collect()
}

/// Runs the command.
pub(crate) fn split_file(arguments: &SplitArguments) -> Result<(), Failure> {
    let path = &arguments.input.mesh;
    let (file, columns) = load_with_columns(&arguments.input)?;
    let surface = Surface::new(&file.mesh, &file.positions);
    let surface = surface.map_err(|error| Failure::mesh(path, error))?;
    let parts = Components::new(&file.mesh).parts(surface);
    let mut component = vec![0; file.positions.len()];
    for (number, part) in parts.iter().enumerate() {
        for &vertex in part.vertices() {
            component[vertex as usize] = number;
        }
    }
    let mut triangles = vec![Vec::new(); parts.len()];
    for (number, &[first, ..]) in (0..).zip(file.mesh.triangles()) {
        triangles[component[first as usize]].push(number);
    }
    let parts = parts.iter().zip(&triangles);
    let parts =
        parts.filter_map(|(part, triangles)| Some((part.surface()?, part.vertices(), triangles)));
    let all = Vec::from_iter(parts);
    let is_large = |(_, vertices, _): &&(_, &[u32], _)| vertices.len() >= arguments.least;
    let parts = Vec::from_iter(all.iter().filter(is_large));
    if parts.is_empty() {
        let message = format!(
            "{}: no component has {} vertices or more: choose a smaller --least",
            path.display(),
            arguments.least
        );
        return Err(Failure::Input(message.into()));
    }
    let name = |number: usize| format!("component-{number}.{}", arguments.format);
    let outputs = (1..=parts.len()).map(|number| arguments.out.join(name(number)));
    let outputs = Vec::from_iter(outputs);
    if let Some(taken) = outputs.iter().find(|output| output.exists()) {
        let message = format!(
            "{}: there is such a file: choose another folder",
            taken.display()
        );
        return Err(Failure::Input(message.into()));
    }
    fs::create_dir_all(&arguments.out)
        .map_err(|error| Failure::output(arguments.out.display(), &error))?;
    for ((part, vertices, triangles), output) in parts.iter().zip(&outputs) {
        let own = columns_of(&columns, vertices, triangles);
        write_with_columns(output, part.positions(), part.mesh(), &own)?;
    }
    if parts.len() < all.len() {
        say(format_args!(
            "note: {} components with fewer than {} vertices are left out",
            all.len() - parts.len(),
            arguments.least
        ));
    }
    print(|out| {
        for (number, (part, vertices, triangles)) in (1..).zip(&parts) {
            let volume = match part.volume() {
                Some(volume) => format!("volume {volume}"),
                None => "open".to_owned(),
            };
            writeln!(
                out,
                "{}: {} vertices, {} triangles, area {}, {volume}",
                name(number),
                vertices.len(),
                triangles.len(),
                part.area()
            )?;
        }
        Ok(())
    })
}
