//! Builds the outputs from their values.

use super::super::builder::Builder;
use super::super::reader::Reader;
use super::super::value::default_name;
use super::super::{
    BoundaryIntegral, Driver, Every, Flow, LatticeBoltzmann, Output, PictureField, Pictures, Plot,
    Probe, Slice, Volume,
};
use crate::series::{ITERATION, TIME};
use crate::six::Six;

/// The largest number of rows of a series: at a thousand per second it takes three hours to write them.
const MOST_ROWS: f64 = 1e7;

/// The largest number of points of a slice.
const POINTS: usize = 4_000_000;

impl Builder<'_> {
    pub(super) fn output(&mut self, output: Option<Reader<'_>>, driver: Option<&Driver>) -> Output {
        let switch = |key| output.and_then(|output| output.switch(key));
        let tables = |key| output.map_or_else(Vec::new, |output| output.tables(key));
        let against = match driver {
            Some(Driver::Relax(_)) => ITERATION,
            Some(driver) if driver.flow().and_then(Flow::rate).is_some() => "strain",
            _ => TIME,
        };
        let plot = |plot: Reader<'_>| Plot {
            column: plot.text("column").unwrap_or_default().to_owned(),
            against: plot.text("against").unwrap_or(against).to_owned(),
            published: plot.text("published").map(|name| self.file(name)),
        };
        let plots = tables("plot").into_iter().map(plot).collect();
        let checkpoint_every = output.and_then(|output| output.count("checkpoint_every"));
        Output {
            every: self.every(output, driver),
            surfaces: switch("surfaces").unwrap_or(true),
            pictures: match switch("pictures") {
                Some(true) => Pictures::Always,
                Some(false) => Pictures::Never,
                None => Pictures::Affordable,
            },
            picture_field: match output.and_then(|output| output.text("picture_field")) {
                Some("K" | "gaussian-curvature" | "gaussian_curvature") => {
                    PictureField::GaussianCurvature
                }
                Some("f" | "bending-force" | "bending_force") => PictureField::BendingForce,
                _ => PictureField::MeanCurvature,
            },
            checkpoint_every: checkpoint_every.unwrap_or(match driver {
                Some(Driver::BoundaryIntegral(_)) => 50,
                _ => 1000,
            }),
            files_every: output
                .and_then(|output| output.count("files_every"))
                .unwrap_or(1),
            plots,
            slices: self.slices(&tables("slice"), driver),
            volumes: self.volumes(&tables("volume"), driver),
            probes: self.probes(&tables("probe"), driver),
            rheology: None,
        }
    }

    fn every(&mut self, output: Option<Reader<'_>>, driver: Option<&Driver>) -> Every {
        let given = |key| output.filter(|output| output.has(key));
        match driver {
            None => Every::Iterations(0),
            Some(Driver::Relax(_)) => {
                for key in ["interval", "strain_interval"] {
                    if let Some(output) = given(key) {
                        self.contradiction(
                            &output.origin_of(key),
                            format!(
                                "the driver \"relax\" has no time, and `{key}` is for drivers that \
                                 have: give `every`, a number of iterations"
                            ),
                        );
                    }
                }
                let every = output.and_then(|output| output.count("every"));
                Every::Iterations(every.unwrap_or(100))
            }
            Some(
                Driver::BoundaryIntegral(BoundaryIntegral { flow, duration, .. })
                | Driver::LatticeBoltzmann(LatticeBoltzmann { flow, duration, .. }),
            ) => {
                if let (Some(output), Some(driver)) = (given("every"), driver) {
                    self.contradiction(
                        &output.origin_of("every"),
                        format!(
                            "the driver \"{}\" goes by time, and `every` counts iterations: give \
                             `interval`, a time, or `strain_interval`",
                            driver.name()
                        ),
                    );
                }
                let interval = output.and_then(|output| output.number("interval"));
                let strain = output.and_then(|output| {
                    let strain = output.number("strain_interval")?;
                    Some(self.time_of(strain, output, "strain_interval", *flow, "interval"))
                });
                let hundredth = 0.01 * duration;
                let interval = interval.or(strain).unwrap_or(hundredth);
                if let Some(output) = output
                    && duration / interval > MOST_ROWS
                {
                    let strain = output.has("strain_interval");
                    let key = if strain {
                        "strain_interval"
                    } else {
                        "interval"
                    };
                    self.contradiction(
                        &output.origin_of(key),
                        format!(
                            "the run would write {} rows: the limit is {MOST_ROWS:e}; choose a longer `{key}`",
                            Six(duration / interval)
                        ),
                    );
                }
                Every::Time(interval)
            }
        }
    }

    fn slices(&mut self, readers: &[Reader<'_>], driver: Option<&Driver>) -> Vec<Slice> {
        let size = |count: u64| usize::try_from(count).unwrap_or(usize::MAX);
        let slice = |(index, reader): (usize, &Reader<'_>)| Slice {
            name: match reader.text("name") {
                Some(name) => name.to_owned(),
                None => default_name("slice", index),
            },
            centre: reader.vector("centre").unwrap_or_default(),
            normal: reader.vector("normal").unwrap_or_default(),
            size: reader.pair("size").unwrap_or_default(),
            points: reader.counts("points").unwrap_or_default().map(size),
        };
        let slices = Vec::from_iter(readers.iter().enumerate().map(slice));
        let names = slices.iter().map(|slice| slice.name.as_str());
        self.different("slice", &Vec::from_iter(names), readers);
        if let (Some(Driver::Relax(_)), [first, ..]) = (driver, readers) {
            self.contradiction(
                first.origin(),
                "a slice shows the fluid, and the driver \"relax\" has none: leave \
                 [[output.slice]] out, or choose the driver \"boundary-integral\""
                    .to_owned(),
            );
        }
        for (slice, reader) in slices.iter().zip(readers) {
            let points = slice.points[0].saturating_mul(slice.points[1]);
            if points > POINTS {
                self.contradiction(
                    &reader.origin_of("points"),
                    format!("{points} points are too many for a slice: {POINTS} at most"),
                );
            }
            let what = format!("the slice \"{}\"", slice.name);
            self.in_the_fluid(reader.origin(), &what, &slice.corners(), driver);
        }
        slices
    }

    fn volumes(&mut self, readers: &[Reader<'_>], driver: Option<&Driver>) -> Vec<Volume> {
        let volume = |(index, reader): (usize, &Reader<'_>)| Volume {
            name: match reader.text("name") {
                Some(name) => name.to_owned(),
                None => default_name("volume", index),
            },
            stride: usize::try_from(reader.count("stride").unwrap_or(1)).unwrap_or(usize::MAX),
        };
        let volumes = Vec::from_iter(readers.iter().enumerate().map(volume));
        let names = volumes.iter().map(|volume| volume.name.as_str());
        self.different("volume", &Vec::from_iter(names), readers);
        if let (Some(driver), [first, ..]) = (driver, readers)
            && !matches!(driver, Driver::LatticeBoltzmann(_))
        {
            self.contradiction(
                first.origin(),
                format!(
                    "a volume shows the nodes of a lattice, and the driver \"{}\" has none: choose \
                     [[output.slice]] with \"boundary-integral\", or the driver \
                     \"lattice-boltzmann\"",
                    driver.name()
                ),
            );
        }
        volumes
    }

    fn probes(&mut self, readers: &[Reader<'_>], driver: Option<&Driver>) -> Vec<Probe> {
        let probe = |(index, reader): (usize, &Reader<'_>)| Probe {
            name: match reader.text("name") {
                Some(name) => name.to_owned(),
                None => default_name("probe", index),
            },
            point: reader.vector("point").unwrap_or_default(),
        };
        let probes = Vec::from_iter(readers.iter().enumerate().map(probe));
        let names = probes.iter().map(|probe| probe.name.as_str());
        self.different("probe", &Vec::from_iter(names), readers);
        if let (Some(Driver::Relax(_)), [first, ..]) = (driver, readers) {
            self.contradiction(
                first.origin(),
                "a probe measures the fluid, and the driver \"relax\" has none: leave \
                 [[output.probe]] out, or choose the driver \"boundary-integral\" or \
                 \"lattice-boltzmann\""
                    .to_owned(),
            );
        }
        for (probe, reader) in probes.iter().zip(readers) {
            let what = format!("the probe \"{}\"", probe.name);
            let origin = reader.origin_of("point");
            self.in_the_fluid(&origin, &what, &[probe.point], driver);
            // The centre of a surface has columns of this name.
            if probe.name == "centroid" {
                self.contradiction(
                    &reader.origin_of("name"),
                    "the columns centroid_x, centroid_y and centroid_z are the surfaces': choose \
                     another name"
                        .to_owned(),
                );
            }
        }
        probes
    }
}
