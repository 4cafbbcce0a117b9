//! Time of every kernel beside naive versions and beside what the processor allows:
//!
//! ```console
//! cargo bench -p helfrich-std
//! cargo bench -p helfrich-std -- --vertices 2562,40962
//! ```
//!
//! Vertices are in reverse Cuthill–McKee order. All columns of a row are measured in turn, again and
//! again, in samples of about a millisecond, and what is printed are first quartiles: on a machine with
//! other work, samples that were not interrupted are among the faster half, and only ratios within a
//! row mean anything.
#![expect(clippy::print_stdout, reason = "the tables are what it is for")]

mod counted;
mod first_result;
mod growth;
mod measured;
mod naive;
mod peak;
mod rows;

use helfrich::Reordering;
use helfrich_std::generate::{Family, generate};
use measured::Table;
use std::path::PathBuf;

type Error = Box<dyn std::error::Error>;

fn main() -> Result<(), Error> {
    let arguments = Arguments::read()?;
    let mut table = Table::new(peak::Peak::measure(), arguments.beside.as_deref())?;
    table.head();
    for &vertices in &arguments.vertices {
        let generated = generate(&"discocyte".parse()?, Family::Smooth, vertices, 1)?;
        let order = Reordering::reverse_cuthill_mckee(&generated.mesh);
        let mesh = order.of_mesh(&generated.mesh)?;
        let positions = order.apply(&generated.positions);
        rows::of::<f64>("f64", &mesh, &positions, &mut table)?;
        rows::of::<f32>("f32", &mesh, &positions, &mut table)?;
    }
    rows::stokeslets(&mut table)?;
    rows::lattice::<f64>("f64", &mut table)?;
    rows::lattice::<f32>("f32", &mut table)?;
    if let Some(path) = &arguments.save {
        table.save(path)?;
    }
    if arguments.all {
        growth::print()?;
        first_result::print()?;
    }
    Ok(())
}

struct Arguments {
    vertices: Vec<usize>,
    /// A file to write the times of the wide loops to.
    save: Option<PathBuf>,
    /// Such a file of another build, to compare with.
    beside: Option<PathBuf>,
    /// Whether more than the first table is asked for.
    all: bool,
}

impl Arguments {
    fn read() -> Result<Self, Error> {
        let mut known = Self {
            vertices: vec![2562],
            save: None,
            beside: None,
            all: true,
        };
        let mut given = std::env::args().skip(1);
        while let Some(name) = given.next() {
            let mut value = || given.next().ok_or(format!("{name} needs a value"));
            match name.as_str() {
                // Which cargo adds.
                "--bench" => {}
                "--vertices" => {
                    let numbers = value()?;
                    let numbers = numbers.split(',').map(str::parse);
                    known.vertices = numbers.collect::<Result<_, _>>()?;
                }
                "--save" => known.save = Some(value()?.into()),
                "--beside" => known.beside = Some(value()?.into()),
                "--table-only" => known.all = false,
                other => return Err(format!("there is no argument {other}").into()),
            }
        }
        Ok(known)
    }
}
