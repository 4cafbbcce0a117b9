//! Builds the measurements of a suspension from their values.

use super::super::builder::Builder;
use super::super::reader::Reader;
use super::super::{Driver, Every, LatticeBoltzmann, Rheology, SurfaceScene};
use crate::six::Six;

/// The largest number of values of profiles, which a run keeps until its end: 80 MB.
const MOST_VALUES: f64 = 1e7;

/// The number of blocks, unless a scene gives one.
const BLOCKS: u64 = 10;

impl Builder<'_> {
    /// The measurements with these rows of the series, in a scene with these surfaces and perhaps obstacles.
    pub(super) fn rheology(
        &mut self,
        reader: Option<Reader<'_>>,
        driver: Option<&Driver>,
        every: Every,
        surfaces: &[SurfaceScene],
        has_obstacles: bool,
    ) -> Option<Rheology> {
        let reader = reader?;
        let count = |key: &str, default: u64| {
            usize::try_from(reader.count(key).unwrap_or(default)).unwrap_or(usize::MAX)
        };
        let rheology = Rheology {
            stress: reader.switch("stress").unwrap_or(true),
            profiles: count("profiles", 0),
            blocks: count("blocks", BLOCKS),
            skip: reader.number("skip").unwrap_or(0.0),
        };
        match (driver?, every) {
            (Driver::LatticeBoltzmann(lattice), Every::Time(interval)) => {
                self.measurable(reader, &rheology, lattice, interval);
            }
            (driver, _) => {
                let why = match driver {
                    Driver::Relax(_) => "has no fluid",
                    _ => {
                        "has unbounded fluid, without a volume over which a stress could be the mean and without walls"
                    }
                };
                self.contradiction(
                    reader.origin(),
                    format!(
                        "`output.rheology` measures the fluid in a box, and the driver \"{}\" {why}: choose the driver \
                         \"lattice-boltzmann\", or leave the table out",
                        driver.name()
                    ),
                );
            }
        }
        if rheology.stress {
            self.internal(reader, surfaces, has_obstacles);
        }
        Some(rheology)
    }

    /// Refuses what this lattice cannot measure, or not with rows at these intervals.
    fn measurable(
        &mut self,
        reader: Reader<'_>,
        rheology: &Rheology,
        lattice: &LatticeBoltzmann,
        interval: f64,
    ) {
        let [_, layers, _] = lattice.cells;
        let flow = lattice.flow.name();
        let mut refuse = |key: &str, message: String| {
            self.contradiction(&reader.origin_of(key), message);
        };
        if !rheology.stress && rheology.profiles == 0 {
            refuse(
                "stress",
                "`output.rheology` has neither `stress` nor `profiles`: give a number of `profiles`, or leave the table out"
                    .to_owned(),
            );
        }
        if rheology.profiles > 0 && !lattice.walls()[1] {
            refuse(
                "profiles",
                format!(
                    "`profiles` go from wall to wall, and the flow \"{flow}\" has none: choose \"shear\" or \"channel\", \
                     or leave `profiles` out"
                ),
            );
        } else if rheology.profiles > layers {
            refuse(
                "profiles",
                format!(
                    "{} slices are thinner than the distance of nodes: {layers} at most, one for each node over the height",
                    rheology.profiles
                ),
            );
        }
        let rows = lattice.duration / interval;
        let values = 2.0 * rheology.profiles as f64 * rows;
        if values > MOST_VALUES {
            refuse(
                "profiles",
                format!(
                    "the run would keep {} numbers of profiles: the limit is {MOST_VALUES:e}; choose fewer `profiles`, or a \
                     longer interval of the output",
                    Six(values)
                ),
            );
        }
        let total = lattice.flow.rate().map(|rate| rate * lattice.duration);
        match total {
            None if rheology.skip > 0.0 => refuse(
                "skip",
                format!(
                    "`skip` is a strain, a rate times a time, and the flow \"{flow}\" has no rate: leave `skip` out"
                ),
            ),
            Some(total) if rheology.skip >= total => refuse(
                "skip",
                format!(
                    "`skip` leaves nothing: the run ends at the strain {}: choose a smaller `skip`, or a longer run",
                    Six(total)
                ),
            ),
            _ => {}
        }
        let left = rheology.rows(lattice, interval);
        if left < rheology.blocks as f64 {
            self.doubt(
                &reader.origin_of("blocks"),
                format!(
                    "the run writes {} rows after `skip`, fewer than the {} blocks of means: there will be no means unless it \
                     is continued; choose fewer `blocks`, or a shorter interval of the output",
                    Six(left.max(0.0)),
                    rheology.blocks
                ),
            );
        }
    }

    /// Refuses the stress of forces that do not come from the membranes alone.
    fn internal(&mut self, reader: Reader<'_>, surfaces: &[SurfaceScene], has_obstacles: bool) {
        let outside = surfaces.iter().find_map(|surface| {
            let effects = &surface.effects;
            let names = [
                (effects.gravity.is_some(), "gravity"),
                (effects.adhesion.is_some(), "adhesion"),
                (effects.aspiration.is_some(), "aspiration"),
            ];
            let (_, name) = names.into_iter().find(|(acts, _)| *acts)?;
            Some(format!("`{name}` of \"{}\"", surface.name))
        });
        let outside = outside.or_else(|| has_obstacles.then(|| "an obstacle".to_owned()));
        if let Some(outside) = outside {
            self.contradiction(
                &reader.origin_of("stress"),
                format!(
                    "`stress` is that of membranes on which no forces act from outside, and {outside} exerts some: give \
                     `stress = false` with a number of `profiles`, or leave the table out"
                ),
            );
        }
    }
}

impl Rheology {
    /// The number of rows of a whole run that count in means, if they are at these intervals.
    pub(crate) fn rows(&self, lattice: &LatticeBoltzmann, interval: f64) -> f64 {
        let skipped = lattice.flow.rate().map_or(0.0, |rate| self.skip / rate);
        ((lattice.duration - skipped) / interval).round()
    }
}
