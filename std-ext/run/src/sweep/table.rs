//! Comparison of all runs: the choice of columns, the table, the plots.

use super::{Case, Dependence, Ended, Outcome, Sweep, SweepError, Swept};
use crate::io::replace_file;
use crate::plots::{PublishedCurve, SeriesCurve, SeriesPlot, axis_label, columns_of, unit_of};
use crate::png;
use crate::scene::Scene;
use crate::series::{SeriesTable, TIME, quoted};
use std::path::{Path, PathBuf};

/// Width and height of the plots, in pixels.
const PLOT_SIZE: [u32; 2] = [900, 700];

impl Swept {
    pub(super) fn new(sweep: &Sweep, cases: Vec<(Case, Outcome)>) -> Self {
        Self {
            keys: super::vary::short_keys(&sweep.vary),
            columns: Vec::new(),
            units: Vec::new(),
            unknown: Vec::new(),
            known: Vec::new(),
            cases,
            warnings: Vec::new(),
        }
    }

    /// The runs with results.
    pub fn ended(&self) -> impl Iterator<Item = (&Case, &Ended)> {
        self.cases
            .iter()
            .filter_map(|(case, outcome)| match outcome {
                Outcome::Ended(ended) => Some((case, ended)),
                _ => None,
            })
    }

    /// The warnings of the runs, each with the number of runs that have it.
    pub fn shared_warnings(&self) -> Vec<(&str, usize)> {
        let mut shared: Vec<(&str, usize)> = Vec::new();
        for warning in self.ended().flat_map(|(_, ended)| &ended.warnings) {
            match shared.iter_mut().find(|(known, _)| known == warning) {
                Some((_, count)) => *count += 1,
                None => shared.push((warning, 1)),
            }
        }
        shared
    }

    /// The columns to show.
    pub(super) fn choose(&mut self, chosen: &[String], scene: &Scene) {
        let mut known: Vec<String> = Vec::new();
        for column in self.ended().flat_map(|(_, ended)| &ended.series.columns) {
            if !known.contains(column) {
                known.push(column.clone());
            }
        }
        let all = SeriesTable {
            columns: known.clone(),
            rows: Vec::new(),
        };
        let plots = scene.output.plots.iter();
        let names = match chosen {
            [] => Vec::from_iter(plots.map(|plot| plot.column.clone())),
            chosen => chosen.to_vec(),
        };
        (self.columns, self.unknown) = (Vec::new(), Vec::new());
        for name in names {
            let surfaces = scene.surfaces.iter().map(|surface| surface.name.as_str());
            let found = columns_of(&all, &name, surfaces);
            if found.is_empty() && !known.is_empty() {
                self.unknown.push(name);
            }
            for (_, column) in found {
                if !self.columns.contains(&column) {
                    self.columns.push(column);
                }
            }
        }
        if chosen.is_empty() && self.columns.is_empty() {
            let some = known.iter().filter(|name| *name != TIME).take(4);
            self.columns = some.cloned().collect();
        }
        let units = self.columns.iter().map(|column| unit_of(column, scene));
        self.units = units.collect();
        self.known = known;
    }

    /// All runs with all their last numbers, as CSV.
    pub(super) fn write_table(&self, path: &Path) -> Result<(), SweepError> {
        replace_file(path, |out| {
            let costs = [
                "iterations",
                "evaluations",
                "seconds",
                "bending_seconds",
                "end",
                "message",
            ];
            let keys = self.keys.iter().map(String::as_str);
            let names = self.known.iter().map(String::as_str);
            let head = keys.chain(names).chain(costs).map(quoted);
            writeln!(out, "{}", Vec::from_iter(head).join(","))?;
            for (case, outcome) in &self.cases {
                let mut cells = Vec::from_iter(case.values.iter().map(|value| quoted(value)));
                match outcome {
                    Outcome::Ended(ended) => {
                        let last = |column: &String| match ended.last(column) {
                            value if value.is_nan() => String::new(),
                            value => format!("{value:?}"),
                        };
                        cells.extend(self.known.iter().map(last));
                        let count = ended.right_hand_sides.map(|count| count.to_string());
                        let bending = ended.bending.map(|seconds| format!("{seconds:e}"));
                        cells.extend([
                            ended.iterations.to_string(),
                            count.unwrap_or_default(),
                            format!("{:?}", ended.seconds),
                            bending.unwrap_or_default(),
                            ended.end.name().to_owned(),
                            quoted(&ended.message),
                        ]);
                    }
                    Outcome::Refused(reason) => {
                        cells.extend(vec![String::new(); self.known.len() + 4]);
                        cells.extend(["refused".to_owned(), quoted(reason)]);
                    }
                    Outcome::Waiting => {
                        cells.extend(vec![String::new(); self.known.len() + 4]);
                        cells.extend(["waiting".to_owned(), String::new()]);
                    }
                }
                writeln!(out, "{}", cells.join(","))?;
            }
            Ok(())
        })
        .map_err(|source| SweepError::Unwritable {
            path: path.to_owned(),
            source,
        })
    }

    /// The series of all runs, a picture for each chosen column.
    pub(super) fn plot(
        &self,
        folder: &Path,
        scene: &Scene,
        published: &[Vec<PublishedCurve>],
    ) -> Result<(), SweepError> {
        for column in &self.columns {
            // Of several surfaces, each column has the curves of its name.
            let planned = scene.output.plots.iter().zip(published).find(|(plot, _)| {
                let rest = column.strip_prefix(plot.column.as_str());
                rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
            });
            let has = |name: &str| self.known.iter().any(|known| known == name);
            let against = match planned {
                Some((plot, _)) if has(&plot.against) => plot.against.as_str(),
                _ if has("strain") => "strain",
                _ => TIME,
            };
            if against == column {
                continue;
            }
            let has_both = |ended: &Ended| {
                let names = &ended.series.columns;
                [against, column]
                    .iter()
                    .all(|name| names.iter().any(|n| n == name))
            };
            let drawn = Vec::from_iter(self.ended().filter(|(_, ended)| has_both(ended)));
            let names = Vec::from_iter(drawn.iter().map(|(case, _)| self.legend(case, None)));
            let curves = drawn
                .iter()
                .zip(&names)
                .map(|((_, ended), name)| SeriesCurve {
                    name,
                    table: &ended.series,
                    against,
                    column,
                });
            let plot = SeriesPlot {
                size: PLOT_SIZE,
                title: &scene.title,
                labels: [axis_label(against), axis_label(column)],
                curves: &Vec::from_iter(curves),
                marked: false,
                hollow: &[],
                published: planned.map_or(&[], |(_, curves)| curves),
            };
            draw(&plot, folder.join(format!("{column}.png")))?;
        }
        for column in &self.columns {
            for dependence in self.dependences(column) {
                self.plot_over(folder, scene, &dependence)?;
            }
        }
        Ok(())
    }

    /// The last numbers of all runs over a key, with the points where curves cross.
    fn plot_over(
        &self,
        folder: &Path,
        scene: &Scene,
        dependence: &Dependence,
    ) -> Result<(), SweepError> {
        let Dependence {
            key,
            column,
            curves,
            unresolved,
        } = dependence;
        let tables = curves.iter().map(|(_, points)| dependence.table(points));
        let tables = Vec::from_iter(tables);
        let drawn = curves
            .iter()
            .zip(&tables)
            .map(|((name, _), table)| SeriesCurve {
                name,
                table,
                against: key,
                column,
            });
        let plot = SeriesPlot {
            size: PLOT_SIZE,
            title: &scene.title,
            labels: [key, axis_label(column)],
            curves: &Vec::from_iter(drawn),
            marked: true,
            hollow: unresolved,
            published: &dependence.marks(),
        };
        draw(&plot, folder.join(format!("{column}-over-{key}.png")))
    }
}

fn draw(plot: &SeriesPlot<'_>, path: PathBuf) -> Result<(), SweepError> {
    let canvas = plot.draw().map_err(|error| SweepError::Plot {
        path: path.clone(),
        error,
    })?;
    let written = png::write(&canvas, &path);
    written.map_err(|source| SweepError::Unwritable { path, source })
}
