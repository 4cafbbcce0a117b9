//! Rows of a table, measured.

use crate::Error;
use crate::peak::Peak;
use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

/// Rounds, in each of which every column has its turn.
const ROUNDS: usize = 31;

/// Seconds of a sample: shorter than what a scheduler gives to a process at a time.
const SAMPLE: f64 = 1e-3;

/// The measurements of a kernel.
pub(crate) struct Row<'a> {
    pub(crate) name: String,
    /// The divisor of a run: number of vertices, nodes or pairs.
    pub(crate) count: usize,
    pub(crate) naive: Option<&'a mut dyn FnMut()>,
    pub(crate) serial: Option<&'a mut dyn FnMut()>,
    pub(crate) wide: &'a mut dyn FnMut(),
    pub(crate) both: &'a mut dyn FnMut(),
    pub(crate) bound: Bound<'a>,
}

/// The bound with which the time of wide loops is compared.
pub(crate) enum Bound<'a> {
    /// Nanoseconds per entry.
    Time(f64),
    /// A loop, measured in turn with the others.
    Loop(&'a mut dyn FnMut()),
}

pub(crate) struct Table {
    pub(crate) peak: Peak,
    beside: HashMap<String, f64>,
    text: String,
}

impl Table {
    pub(crate) fn new(peak: Peak, beside: Option<&Path>) -> Result<Self, Error> {
        let mut known = HashMap::new();
        if let Some(path) = beside {
            for line in std::fs::read_to_string(path)?.lines() {
                let (name, time) = line.rsplit_once('\t').ok_or("not a file of --save")?;
                known.insert(name.to_owned(), time.parse()?);
            }
        }
        Ok(Self {
            peak,
            beside: known,
            text: String::new(),
        })
    }

    pub(crate) fn head(&self) {
        println!(
            "ns a vertex (pair, node); n/s: naive over serial, and so on; bound: of wide loops"
        );
        print!(
            "{:16}{:>8}{:>9}{:>9}{:>9}{:>9}{:>7}{:>7}{:>7}{:>7}",
            "kernel", "N", "naive", "serial", "wide", "2 thr.", "n/w", "s/w", "w/2", "bound"
        );
        println!(
            "{}",
            if self.beside.is_empty() {
                ""
            } else {
                "  other"
            }
        );
    }

    /// Measures and prints a row.
    pub(crate) fn row(&mut self, row: Row<'_>) {
        let Row {
            name,
            count,
            naive,
            serial,
            wide,
            both,
            bound,
        } = row;
        let (known, bound) = match bound {
            Bound::Time(time) => (Some(time), None),
            Bound::Loop(run) => (None, Some(run)),
        };
        let [naive, serial, wide, both, bound] =
            quartiles([naive, serial, Some(wide), Some(both), bound])
                .map(|time| time.map(|time| 1e9 * time / count as f64));
        let bound = known.or(bound);
        let show = |value: Option<f64>, digits: usize| match value {
            Some(value) => format!("{value:.digits$}"),
            None => "–".to_owned(),
        };
        let ratio = |a: Option<f64>, b: Option<f64>| Some(a? / b?);
        let digits = if wide < Some(10.0) { 2 } else { 1 };
        print!("{name:16}{count:>8}");
        for time in [naive, serial, wide, both] {
            print!("{:>9}", show(time, digits));
        }
        for (a, b) in [(naive, wide), (serial, wide), (wide, both), (bound, wide)] {
            print!("{:>7}", show(ratio(a, b), 2));
        }
        let name = format!("{name} {count}");
        match self.beside.get(&name) {
            Some(&other) => println!("{:>7}", show(ratio(wide, Some(other)), 3)),
            None => println!(),
        }
        let _ = writeln!(self.text, "{name}\t{}", wide.unwrap_or(f64::NAN));
    }

    pub(crate) fn save(&self, path: &Path) -> Result<(), Error> {
        std::fs::write(path, &self.text)?;
        Ok(())
    }
}

/// The first quartile of each column's times, in seconds a run.
fn quartiles<const N: usize>(mut columns: [Option<&mut dyn FnMut()>; N]) -> [Option<f64>; N] {
    let mut repeats = [1; N];
    for (column, repeats) in columns.iter_mut().zip(&mut repeats) {
        if let Some(column) = column {
            // Memory is taken at the first evaluation.
            column();
            let start = Instant::now();
            column();
            *repeats = (SAMPLE / start.elapsed().as_secs_f64()).clamp(1.0, 1e6) as usize;
        }
    }
    let mut times = [const { Vec::new() }; N];
    for _ in 0..ROUNDS {
        for (k, column) in columns.iter_mut().enumerate() {
            if let Some(column) = column {
                let start = Instant::now();
                for _ in 0..repeats[k] {
                    column();
                }
                times[k].push(start.elapsed().as_secs_f64() / repeats[k] as f64);
            }
        }
    }
    times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times.get(ROUNDS / 4).copied()
    })
}
