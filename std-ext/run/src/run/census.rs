//! Columns of the surfaces of a population, as their means and standard deviations, and of each surface.

use super::RunError;
use crate::scene::{PopulationScene, Scene};
use crate::series::{Series, SeriesError};
use crate::simulation::EffectCost;
use std::collections::HashMap;
use std::path::Path;

/// The columns of a series: those of surfaces alone, and for each population the mean and the standard deviation of every
/// column of its surfaces, at the place of that of the first.
#[derive(Debug)]
pub(super) struct Census {
    columns: Vec<String>,
    parts: Vec<Part>,
    own: Vec<PerCell>,
}

/// The columns of each surface of a population.
#[derive(Debug)]
struct PerCell {
    population: String,
    count: usize,
    columns: Vec<String>,
    /// For each column the indices in the numbers of a row, in the order of the surfaces.
    indices: Vec<Vec<usize>>,
    series: Option<Series>,
}

/// Source of one or two columns in the numbers of a row, in the order of the columns.
#[derive(Debug)]
enum Part {
    /// A number as it is.
    Alone(usize),
    /// The mean and the standard deviation of these numbers.
    Of(Vec<usize>),
}

/// The surfaces of populations by their names.
struct Names<'a> {
    populations: HashMap<&'a str, &'a str>,
}

impl<'a> Names<'a> {
    fn new(scene: &'a Scene) -> Self {
        // A single surface has no name in its columns.
        let populations = scene
            .populations
            .iter()
            .filter(|_| scene.surfaces.len() > 1);
        let names = populations.flat_map(|population| {
            let surfaces = &scene.surfaces[population.surfaces.clone()];
            surfaces
                .iter()
                .map(|surface| (surface.name.as_str(), population.name.as_str()))
        });
        Self {
            populations: names.collect(),
        }
    }

    /// The name of a column without its surface, and the population; none if it is not of a population.
    fn split<'c>(&self, column: &'c str) -> Option<(&'c str, &'a str)> {
        let mut ends = column.match_indices('_').map(|(at, _)| at);
        // The surface with the longest name comes first.
        ends.find_map(|at| Some((&column[..at], *self.populations.get(&column[at + 1..])?)))
    }
}

/// The populations with rows for each surface. Those of a single surface are the rows of the series.
fn per_cell(scene: &Scene) -> impl Iterator<Item = &PopulationScene> {
    let populations = scene.populations.iter();
    populations.filter(|population| population.per_cell && scene.surfaces.len() > 1)
}

/// The name of the file with rows for each surface of a population.
fn file(population: &str) -> String {
    format!("series-{population}.csv")
}

impl PerCell {
    fn new(population: &PopulationScene, first: &str) -> Self {
        Self {
            population: population.name.clone(),
            count: population.count(),
            columns: vec![first.to_owned(), "cell".to_owned()],
            indices: Vec::new(),
            series: None,
        }
    }

    /// Adds the next surface's number in a column.
    fn add(&mut self, column: &str, index: usize) {
        let place = self.columns[2..].iter().position(|name| name == column);
        let place = place.unwrap_or_else(|| {
            self.columns.push(column.to_owned());
            self.indices.push(Vec::new());
            self.indices.len() - 1
        });
        self.indices[place].push(index);
    }

    fn append(&mut self, all: &[f64]) -> Result<(), SeriesError> {
        let Some(series) = &mut self.series else {
            return Ok(());
        };
        (0..self.count).try_for_each(|cell| {
            let mut row = vec![all[0], 1.0 + cell as f64];
            row.extend(self.indices.iter().map(|column| all[column[cell]]));
            series.append(&row)
        })
    }
}

impl Census {
    /// The census of rows with these columns.
    pub(super) fn new(scene: &Scene, all: &[String]) -> Self {
        let names = Names::new(scene);
        let (mut columns, mut parts) = (Vec::new(), Vec::new());
        let own = per_cell(scene).map(|population| PerCell::new(population, &all[0]));
        let mut own = Vec::from_iter(own);
        let mut places = HashMap::new();
        for (index, column) in all.iter().enumerate() {
            let Some((name, population)) = names.split(column) else {
                columns.push(column.clone());
                parts.push(Part::Alone(index));
                continue;
            };
            let place = *places.entry((name, population)).or_insert(parts.len());
            if place == parts.len() {
                columns.extend(["mean", "sd"].map(|of| format!("{population}_{of}_{name}")));
                parts.push(Part::Of(Vec::new()));
            }
            if let Part::Of(indices) = &mut parts[place] {
                indices.push(index);
            }
            if let Some(own) = own.iter_mut().find(|own| own.population == population) {
                own.add(name, index);
            }
        }
        Self {
            columns,
            parts,
            own,
        }
    }

    /// The names of the files with rows for each surface.
    pub(super) fn files(scene: &Scene) -> impl Iterator<Item = String> {
        per_cell(scene).map(|population| file(&population.name))
    }

    /// Begins these files in a folder, or continues them after some rows of the series of the run.
    pub(super) fn open(&mut self, folder: &Path, rows: Option<u64>) -> Result<(), RunError> {
        for own in &mut self.own {
            let path = folder.join(file(&own.population));
            let columns = Vec::from_iter(own.columns.iter().map(String::as_str));
            own.series = Some(match rows {
                None => Series::create(&path, &columns)
                    .map_err(|error| RunError::Output(Box::new(error)))?,
                Some(rows) => Series::resume(&path, &columns, rows * own.count as u64)
                    .map_err(RunError::Series)?,
            });
        }
        Ok(())
    }

    /// Adds to these files the numbers of a row.
    pub(super) fn append(&mut self, all: &[f64]) -> Result<(), SeriesError> {
        self.own.iter_mut().try_for_each(|own| own.append(all))
    }

    /// As [`Series::mark`].
    pub(super) fn mark(&mut self) -> Result<(), SeriesError> {
        let mut series = self.own.iter_mut().filter_map(|own| own.series.as_mut());
        series.try_for_each(|series| series.mark().map(drop))
    }

    /// The names of the columns.
    pub(super) fn columns(&self) -> &[String] {
        &self.columns
    }

    /// The numbers for these columns from those of a row. A standard deviation is that of a sample, and NaN for a single
    /// surface.
    pub(super) fn row(&self, all: &[f64]) -> Vec<f64> {
        let mut row = Vec::with_capacity(self.columns.len());
        for part in &self.parts {
            match part {
                Part::Alone(index) => row.push(all[*index]),
                Part::Of(indices) => {
                    let values = || indices.iter().map(|&index| all[index]);
                    let count = indices.len() as f64;
                    let mean = values().sum::<f64>() / count;
                    let squares = values().map(|value| (value - mean).powi(2));
                    let variance = squares.sum::<f64>() / (count - 1.0);
                    row.extend([mean, variance.sqrt()]);
                }
            }
        }
        row
    }

    /// Costs of effects with those of a population in one.
    pub(super) fn costs(scene: &Scene, all: Vec<EffectCost>) -> Vec<EffectCost> {
        let names = Names::new(scene);
        let mut costs = Vec::<EffectCost>::new();
        let mut places = HashMap::new();
        for mut cost in all {
            if let Some((name, population)) = names.split(&cost.effect) {
                cost.effect = format!("{name}_{population}");
            }
            let place = *places.entry(cost.effect.clone()).or_insert(costs.len());
            match costs.get_mut(place) {
                None => costs.push(cost),
                Some(sum) => {
                    sum.evaluations += cost.evaluations;
                    sum.seconds += cost.seconds;
                }
            }
        }
        costs
    }
}
