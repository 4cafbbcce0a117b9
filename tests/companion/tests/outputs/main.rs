//! Files of a run, and measurements of its bodies.

mod approach;
mod checkpoints;
mod contact;
mod deformation;
mod enclosure;
mod interruption;
mod parting;
mod pictures;
mod plots;
mod population;
mod ranks;
mod remeshing;
mod rheology;
mod series;
mod vtk;

/// A time whose shortest exact text has many digits.
const TIME: f64 = 0.1 + 0.2;

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}
