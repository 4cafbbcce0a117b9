//! Columns of the surfaces of a population, as their means and standard deviations.

use crate::scene::Scene;
use crate::simulation::EffectCost;
use std::collections::HashMap;

/// The columns of a series: those of surfaces alone, and for each population the mean and the standard deviation of every
/// column of its surfaces, at the place of that of the first.
#[derive(Debug)]
pub(super) struct Census {
    columns: Vec<String>,
    parts: Vec<Part>,
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

impl Census {
    /// The census of rows with these columns.
    pub(super) fn new(scene: &Scene, all: &[String]) -> Self {
        let names = Names::new(scene);
        let (mut columns, mut parts) = (Vec::new(), Vec::new());
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
        }
        Self { columns, parts }
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
