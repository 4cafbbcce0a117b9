//! Measurements of a suspension in a box: stress and viscosity, profiles over the height, and their means.

use super::drive::{Drive, Sheared};
use super::{Run, RunError, SERIES};
use crate::enclosure::surroundings;
use crate::io::replace_file;
use crate::rheology::{
    block_average, free_layer, means_between, symmetric, velocity_moment, volumes_between,
};
use crate::scene::{Driver, Flow, LatticeBoltzmann, Rheology, Scene};
use crate::series::SeriesTable;
use crate::simulation::{Acting, Simulation};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The files' names in their folder.
pub(super) const RHEOLOGY: &str = "rheology.csv";
pub(super) const PROFILES: &str = "profiles.csv";

const PARTICLE_STRESS: [&str; 6] = [
    "particle_stress_xx",
    "particle_stress_yy",
    "particle_stress_zz",
    "particle_stress_xy",
    "particle_stress_xz",
    "particle_stress_yz",
];

/// A mean over the time of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Average {
    /// The quantity: a column of the series, or the thickness `free_layer`.
    pub quantity: String,
    /// Its mean.
    pub mean: f64,
    /// The standard error of the mean.
    pub standard_error: f64,
}

/// Profiles over the height at some time, slice by slice.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Profile {
    /// The strain, or the time of a flow without a rate.
    at: f64,
    velocity: Vec<f64>,
    /// The part of the volume that membranes enclose.
    share: Vec<f64>,
}

/// The instrument that a scene asks for.
#[derive(Debug)]
pub(super) struct Rheometer {
    settings: Rheology,
    driver: LatticeBoltzmann,
    /// The viscosity inside each surface less that around it, over that of the fluid outside of all.
    contrasts: Vec<f64>,
    /// Which surfaces enclose volume that no other one does.
    outermost: Vec<bool>,
}

impl Rheometer {
    /// `None` if the scene does not ask for it. Which surface lies in which is that of these positions.
    pub(super) fn new(
        scene: &Scene,
        simulation: &Simulation,
        positions: &[[f64; 3]],
    ) -> Option<Self> {
        let (Some(settings), Driver::LatticeBoltzmann(driver)) =
            (scene.output.rheology, scene.driver)
        else {
            return None;
        };
        let bodies = simulation.bodies().iter();
        let surfaces = bodies.map(|body| body.surface(positions));
        let around = surroundings(&surfaces.collect::<Option<Vec<_>>>()?, simulation.images());
        let inside = |surface: usize| scene.surfaces[surface].viscosity_ratio.unwrap_or(1.0);
        let contrast = |(surface, around): (usize, &Option<usize>)| {
            inside(surface) - around.map_or(1.0, inside)
        };
        let bodies = simulation.bodies().iter().zip(&around);
        Some(Self {
            settings,
            driver,
            contrasts: around.iter().enumerate().map(contrast).collect(),
            outermost: bodies
                .map(|(body, around)| around.is_none() && body.mesh().is_closed())
                .collect(),
        })
    }

    /// The names of the columns.
    pub(super) fn columns(&self) -> Vec<String> {
        let mut columns = Vec::new();
        if self.settings.stress {
            columns.extend(PARTICLE_STRESS);
            columns.extend(match self.driver.flow {
                Flow::Shear { .. } => &["wall_stress", "viscosity", "N1", "N2"][..],
                Flow::Channel { .. } => &["wall_stress", "viscosity", "flow_rate"],
                _ => &[],
            });
        }
        columns.into_iter().map(str::to_owned).collect()
    }

    /// The numbers of a row; NaN before the first step, when walls feel nothing yet.
    pub(super) fn numbers(
        &self,
        drive: &mut dyn Drive,
        simulation: &mut Simulation,
        acting: &[Acting],
    ) -> Vec<f64> {
        let numbers = drive
            .sheared()
            .filter(|_| self.settings.stress)
            .and_then(|sheared| self.stresses(&sheared, simulation, acting));
        numbers.unwrap_or_else(|| vec![f64::NAN; self.columns().len()])
    }

    fn stresses(
        &self,
        sheared: &Sheared<'_>,
        simulation: &mut Simulation,
        acting: &[Acting],
    ) -> Option<Vec<f64>> {
        let positions = sheared.positions;
        let viscosity = self.driver.viscosity;
        let volume = self.driver.size().iter().product::<f64>();
        let moment = simulation.moment(acting, positions, sheared.material)?;
        let mut stress = symmetric(&moment).map(|component| -component / volume);
        for (body, contrast) in simulation.bodies().iter().zip(&self.contrasts) {
            if *contrast != 0.0 && body.mesh().is_closed() {
                let velocities = &sheared.material[body.vertices()];
                let inner = velocity_moment(body.surface(positions)?, velocities);
                for (stress, inner) in stress.iter_mut().zip(symmetric(&inner)) {
                    *stress += 2.0 * contrast * viscosity * inner / volume;
                }
            }
        }
        let [xx, yy, zz, ..] = stress;
        let mut numbers = stress.to_vec();
        match self.driver.flow {
            Flow::Shear { rate } => numbers.extend([
                sheared.wall_stress,
                sheared.wall_stress / (viscosity * rate),
                xx - yy,
                yy - zz,
            ]),
            Flow::Channel { .. } => {
                let [found, undisturbed] = sheared.flow_rates;
                numbers.extend([sheared.wall_stress, undisturbed / found, found]);
            }
            _ => {}
        }
        Some(numbers)
    }

    /// The profiles at this strain or time; `None` before the first step.
    fn profile(&self, at: f64, drive: &mut dyn Drive, simulation: &Simulation) -> Option<Profile> {
        let heights = self.heights();
        let sheared = drive.sheared()?;
        let mut share = vec![0.0; self.settings.profiles];
        let bodies = simulation.bodies().iter().zip(&self.outermost);
        for (body, _) in bodies.filter(|(_, outermost)| **outermost) {
            let volumes = volumes_between(body.surface(sheared.positions)?, &heights);
            for (sum, volume) in share.iter_mut().zip(volumes) {
                *sum += volume;
            }
        }
        let slice = self.driver.size().iter().product::<f64>() / share.len() as f64;
        share.iter_mut().for_each(|share| *share /= slice);
        Some(Profile {
            at,
            velocity: means_between(&sheared.layers, &heights),
            share,
        })
    }

    /// The heights between which slices are.
    fn heights(&self) -> Vec<f64> {
        let [[_, low, _], [_, high, _]] = self.driver.corners();
        let count = self.settings.profiles;
        let height = |edge: usize| low + (high - low) * edge as f64 / count as f64;
        (0..=count).map(height).collect()
    }

    /// Whether a row at this strain or time counts in means.
    fn counts(&self, at: f64) -> bool {
        at > self.settings.skip
    }

    fn average(&self, quantity: &str, values: &[f64]) -> Option<Average> {
        let [mean, standard_error] = block_average(values, self.settings.blocks)?;
        Some(Average {
            quantity: quantity.to_owned(),
            mean,
            standard_error,
        })
    }
}

impl Run<'_> {
    /// Keeps the profiles of a row.
    pub(super) fn note_profile(&mut self) {
        if let Some(rheometer) = &self.rheometer
            && rheometer.settings.profiles > 0
        {
            let at = self.last[self.strain_column()];
            let profile = rheometer.profile(at, &mut *self.drive, &self.simulation);
            let profiles = &mut self.outputs.profiles;
            // A run that is continued may have another number of slices than before.
            profiles.retain(|before| before.share.len() == rheometer.settings.profiles);
            profiles.extend(profile);
        }
    }

    /// The column of the strain; of the time, if the flow has no rate.
    fn strain_column(&self) -> usize {
        let strain = |column: &String| column == "strain";
        self.census.columns().iter().position(strain).unwrap_or(0)
    }

    /// The means over the run so far, which are written to files, and a warning if there are none. Files of an earlier end
    /// are removed.
    pub(super) fn average(&self) -> Result<(Vec<Average>, Option<String>), RunError> {
        let Some(rheometer) = &self.rheometer else {
            return Ok((Vec::new(), None));
        };
        let Rheology {
            skip,
            blocks,
            profiles: count,
            ..
        } = rheometer.settings;
        let table = SeriesTable::read(&self.folder.join(SERIES)).map_err(RunError::Series)?;
        let strain = self.strain_column();
        let rows = table.rows.iter();
        let rows = Vec::from_iter(rows.filter(|row| rheometer.counts(row[strain])));
        let averages = rheometer.columns().into_iter().map(|name| {
            let column = table.columns.iter().position(|column| *column == name)?;
            let values = Vec::from_iter(rows.iter().map(|row| row[column]));
            rheometer.average(&name, &values)
        });
        let mut averages = averages.collect::<Option<Vec<_>>>();
        let kept = self.outputs.profiles.iter();
        let kept =
            kept.filter(|profile| rheometer.counts(profile.at) && profile.share.len() == count);
        let kept = Vec::from_iter(kept);
        if count > 0 {
            let height = rheometer.driver.size()[1];
            let layers = kept.iter().map(|kept| free_layer(&kept.share, height));
            let layer = rheometer.average("free_layer", &Vec::from_iter(layers));
            averages = averages.and_then(|mut all| {
                all.push(layer?);
                Some(all)
            });
        }
        let profiles = averages.as_ref().map(|_| {
            let heights = rheometer.heights();
            let middles = heights.windows(2).map(|edges| 0.5 * (edges[0] + edges[1]));
            let row = |(slice, middle): (usize, f64)| {
                let average = |of: fn(&Profile) -> &Vec<f64>| {
                    let values = Vec::from_iter(kept.iter().map(|profile| of(profile)[slice]));
                    block_average(&values, blocks).unwrap_or([f64::NAN; 2])
                };
                let [velocity, velocity_error] = average(|profile| &profile.velocity);
                let [share, share_error] = average(|profile| &profile.share);
                format!("{middle:?},{velocity:?},{velocity_error:?},{share:?},{share_error:?}")
            };
            Vec::from_iter(middles.enumerate().map(row))
        });
        let profiles = profiles.unwrap_or_default();
        let means = averages.iter().flatten().map(|average| {
            let Average {
                quantity,
                mean,
                standard_error,
            } = average;
            format!("{quantity},{mean:?},{standard_error:?}")
        });
        let means = Vec::from_iter(means);
        self.write_table(RHEOLOGY, "quantity,mean,standard_error", &means)?;
        let header = "height,velocity,velocity_standard_error,share,share_standard_error";
        self.write_table(PROFILES, header, &profiles)?;
        let warning = averages.is_none().then(|| {
            let found = rows.len();
            format!(
                "`output.rheology`: {found} rows after the strain {skip} are too few for means of {blocks} blocks: a longer \
                 run, a smaller `skip`, fewer `blocks` or a shorter interval of the output is needed"
            )
        });
        Ok((averages.unwrap_or_default(), warning))
    }

    /// Writes a table; without rows removes that of an earlier end.
    fn write_table(&self, name: &str, header: &str, rows: &[String]) -> Result<(), RunError> {
        let path = self.folder.join(name);
        written(&path, header, rows).map_err(|source| RunError::Unwritable { path, source })
    }
}

fn written(path: &Path, header: &str, rows: &[String]) -> std::io::Result<()> {
    if rows.is_empty() {
        return match std::fs::remove_file(path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(error),
            _ => Ok(()),
        };
    }
    replace_file(path, |out| {
        writeln!(out, "{header}")?;
        rows.iter().try_for_each(|row| writeln!(out, "{row}"))
    })
}
