//! Builds the driver and the outputs from their values.

use super::super::reader::Reader;
use super::super::value::default_name;
use super::super::{
    BoundaryIntegral, Driver, Every, Flow, Hold, Integrator, LatticeBoltzmann, Output,
    PictureField, Plot, Probe, Relax, Scheme, Slice, SurfaceScene, Volume,
};
use super::Builder;
use crate::method::BendingMethod;
use crate::series::{ITERATION, TIME};
use crate::six::Six;

impl Builder<'_> {
    /// The driver; `None` if its kind is unknown.
    pub(super) fn driver(
        &mut self,
        driver: Reader<'_>,
        surfaces: &[SurfaceScene],
        readers: &[Reader<'_>],
    ) -> Option<Driver> {
        match driver.text("kind")? {
            "relax" => Some(Driver::Relax(self.relax(driver, surfaces))),
            "boundary-integral" => Some(Driver::BoundaryIntegral(
                self.boundary_integral(driver, surfaces),
            )),
            "lattice-boltzmann" => Some(Driver::LatticeBoltzmann(
                self.lattice_boltzmann(driver, surfaces, readers),
            )),
            _ => None,
        }
    }

    fn relax(&mut self, driver: Reader<'_>, surfaces: &[SurfaceScene]) -> Relax {
        let strong_form = |surface: &&SurfaceScene| !surface.is_conservative();
        let strong_form = surfaces.iter().find(strong_form);
        let scheme = match driver.text("scheme") {
            Some("minimise") => Scheme::Minimise,
            Some("overdamped") => Scheme::Overdamped,
            _ if strong_form.is_none() => Scheme::Minimise,
            _ => Scheme::Overdamped,
        };
        if let (Scheme::Minimise, Some(surface)) = (scheme, strong_form) {
            let method = surface
                .effects
                .bending
                .map_or("", |bending| bending.method.name());
            self.contradiction(
                &driver.origin_of("scheme"),
                format!(
                    "scheme = \"minimise\" needs an energy, and {method}, the bending method of \
                     \"{}\", has none: choose \"overdamped\" or \"auto\", or one of the methods {}",
                    surface.name,
                    conservative_methods()
                ),
            );
        }
        Relax {
            scheme,
            residual: driver.number("residual").unwrap_or(1e-5),
            iterations: driver.count("iterations").unwrap_or(10_000),
            redistribution: self.redistribution(driver, surfaces, SurfaceScene::is_fluid),
            energy_error: driver.number("energy_error").unwrap_or(0.01),
        }
    }

    /// Whether vertices are moved along the surfaces that allow it (`may`).
    pub(super) fn redistribution(
        &mut self,
        driver: Reader<'_>,
        surfaces: &[SurfaceScene],
        may: impl Fn(&SurfaceScene) -> bool,
    ) -> bool {
        let possible = surfaces.iter().any(may);
        let wanted = driver.switch("redistribution");
        if let (Some(true), false) = (wanted, possible) {
            let why = if surfaces.iter().any(SurfaceScene::is_fluid) {
                "elastic, or pulled at its vertices"
            } else {
                "elastic"
            };
            self.contradiction(
                &driver.origin_of("redistribution"),
                format!(
                    "redistribution moves vertices along fluid membranes, and every surface is {why}: \
                     choose false or \"auto\""
                ),
            );
        }
        wanted.unwrap_or(possible)
    }

    fn boundary_integral(
        &mut self,
        driver: Reader<'_>,
        surfaces: &[SurfaceScene],
    ) -> BoundaryIntegral {
        let flow = self.flow(driver.table("flow"));
        if let (Flow::Channel { .. }, Some(table)) = (flow, driver.table("flow")) {
            self.contradiction(
                &table.origin_of("kind"),
                "a channel has walls, and the driver \"boundary-integral\" none: choose \"poiseuille\", \
                 or the driver \"lattice-boltzmann\""
                    .to_owned(),
            );
        }
        self.volumes_kept(driver, surfaces);
        let duration = self.duration(driver, flow);
        BoundaryIntegral {
            viscosity: driver.needed("viscosity"),
            flow,
            duration,
            integrator: self.integrator(driver, surfaces, duration),
            tolerance: driver.number("tolerance").unwrap_or(1e-4),
            volume_correction: driver.switch("volume_correction").unwrap_or(true),
            redistribution: self.redistribution(driver, surfaces, SurfaceScene::slides),
        }
    }

    /// Warns about volumes that nothing conserves.
    pub(super) fn volumes_kept(&mut self, driver: Reader<'_>, surfaces: &[SurfaceScene]) {
        let exact = |surface: &SurfaceScene| {
            let hold = surface.effects.volume.map(|volume| volume.hold);
            hold == Some(Hold::Exact)
        };
        if driver.switch("volume_correction") == Some(false) && !surfaces.iter().all(exact) {
            let message =
                "without `volume_correction` the surfaces' volumes drift with the errors of \
                           mesh and steps, and their deformation with them: leave it on, or hold \
                           `volume` exactly"
                    .to_owned();
            self.doubt(&driver.origin_of("volume_correction"), message);
        }
    }

    /// The time at which the run ends.
    pub(super) fn duration(&mut self, driver: Reader<'_>, flow: Flow) -> f64 {
        let strain = driver.number("strain");
        let key = if strain.is_some() {
            "strain"
        } else {
            "duration"
        };
        let duration = match strain {
            Some(strain) => self.time_of(strain, driver, "strain", flow, "duration"),
            None => driver.needed("duration"),
        };
        if let Some(rate) = flow.rate()
            && duration.is_finite()
            && rate * duration > MOST_STRAIN
        {
            self.contradiction(
                &driver.origin_of(key),
                format!(
                    "the run would go on to a strain of {}: the limit is {MOST_STRAIN:e}; choose a shorter `{key}`",
                    Six(rate * duration)
                ),
            );
        }
        // A placeholder has its error already.
        if driver.has(key) && !duration.is_nan() && !(0.01 * duration).is_normal() {
            self.contradiction(
                &driver.origin_of(key),
                format!(
                    "the run would last {}: choose other units of time",
                    Six(duration)
                ),
            );
        }
        duration
    }

    /// The time that corresponds to a strain, the value of a key; `other` is the key for a time.
    fn time_of(
        &mut self,
        strain: f64,
        reader: Reader<'_>,
        key: &str,
        flow: Flow,
        other: &str,
    ) -> f64 {
        if let Some(rate) = flow.rate() {
            return strain / rate;
        }
        let finite = match flow {
            Flow::Quiescent => true,
            Flow::Linear { gradient } => gradient.as_flattened().iter().all(|x| x.is_finite()),
            _ => false,
        };
        // What is not finite, or 0 where it must not be, has its error already.
        if finite {
            self.contradiction(
                &reader.origin_of(key),
                format!(
                    "`{key}` is a rate times a time, and this flow, {}, has no rate of strain: give `{other}`",
                    flow.name()
                ),
            );
        }
        f64::NAN
    }

    /// The flow. The width of a channel follows from its box.
    pub(super) fn flow(&mut self, flow: Option<Reader<'_>>) -> Flow {
        let Some(flow) = flow else {
            return Flow::Quiescent;
        };
        let rate = flow.needed("rate");
        match flow.text("kind") {
            Some("quiescent") => Flow::Quiescent,
            Some("extension") => Flow::Extension { rate },
            Some("plane-extension") => Flow::PlaneExtension { rate },
            Some("linear") => self.linear(flow),
            Some("poiseuille") => Flow::Poiseuille {
                centre_velocity: flow.needed("centre_velocity"),
                radius: flow.needed("radius"),
                direction: flow.vector("direction").unwrap_or_default(),
                through: flow.vector("through").unwrap_or_default(),
            },
            Some("channel") => Flow::Channel {
                centre_velocity: flow.needed("centre_velocity"),
                width: f64::NAN,
                depth: (flow.text("section") == Some("duct")).then_some(f64::NAN),
            },
            _ => Flow::Shear { rate },
        }
    }

    fn linear(&mut self, flow: Reader<'_>) -> Flow {
        let gradient = flow.matrix("gradient").unwrap_or([[f64::NAN; 3]; 3]);
        let entries = gradient.as_flattened().iter();
        let size = entries.fold(0.0, |size: f64, entry| size.max(entry.abs()));
        let trace = gradient[0][0] + gradient[1][1] + gradient[2][2];
        if trace.abs() > TRACE * size {
            self.contradiction(
                &flow.origin_of("gradient"),
                format!(
                    "the trace of this gradient is {}, and an incompressible fluid's is 0: the \
                     diagonal's entries have to add up to 0",
                    Six(trace)
                ),
            );
        }
        if gradient == [[0.0; 3]; 3] {
            self.contradiction(
                &flow.origin_of("gradient"),
                "this gradient is 0: for fluid at rest choose kind = \"quiescent\"".to_owned(),
            );
        }
        Flow::Linear { gradient }
    }

    /// Warns about steps so short that the run would take too long.
    pub(super) fn endless(&mut self, driver: Reader<'_>, duration: f64, step: f64) {
        if duration.is_finite() && duration / step > MOST_STEPS {
            self.contradiction(
                &driver.origin_of("step"),
                format!(
                    "the run would take {} steps of {}: the limit is {MOST_STEPS:e}; choose a longer `step`, or a shorter run",
                    Six(duration / step),
                    Six(step)
                ),
            );
        }
    }

    fn integrator(
        &mut self,
        driver: Reader<'_>,
        surfaces: &[SurfaceScene],
        duration: f64,
    ) -> Integrator {
        let name = driver.text("integrator");
        if driver.has("step") && name != Some("rk4") {
            self.contradiction(
                &driver.origin_of("step"),
                "`step` is for integrator = \"rk4\": the others choose their steps by `tolerance`"
                    .to_owned(),
            );
        }
        match name {
            Some("rk4") => {
                if !driver.has("step") {
                    self.contradiction(
                        &driver.origin_of("integrator"),
                        "rk4 has no error control, and needs a `step`, a time: give it, or choose \
                         another integrator"
                            .to_owned(),
                    );
                }
                let step = driver.needed("step");
                self.endless(driver, duration, step);
                Integrator::Rk4 { step }
            }
            Some("rkc2") => Integrator::Rkc2,
            Some("bs23") => Integrator::Bs23,
            _ if surfaces.iter().any(SurfaceScene::is_stiff) => Integrator::Rkc2,
            _ => Integrator::Bs23,
        }
    }

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
            pictures: switch("pictures").unwrap_or(true),
            picture_field: match output.and_then(|output| output.text("picture_field")) {
                Some("gaussian-curvature") => PictureField::GaussianCurvature,
                Some("bending-force") => PictureField::BendingForce,
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
            // The centre of a surface has these columns.
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

/// The most rows of a series: at a thousand a second it takes three hours to write them.
const MOST_ROWS: f64 = 1e7;

/// The most steps of a run: at a millisecond a step it takes four months.
const MOST_STEPS: f64 = 1e10;

/// The most strain of a run, in steps of half a unit of strain, the longest that are taken.
const MOST_STRAIN: f64 = 0.5 * MOST_STEPS;

/// The trace of a gradient that was written with its digits in full, relative to its entries.
const TRACE: f64 = 1e-9;

/// The most points of a slice.
const POINTS: usize = 4_000_000;

/// Placeholder for a driver that cannot be read.
pub(super) const PLACEHOLDER: Driver = Driver::Relax(Relax {
    scheme: Scheme::Overdamped,
    residual: f64::NAN,
    iterations: 0,
    redistribution: false,
    energy_error: f64::NAN,
});

fn conservative_methods() -> String {
    let all = BendingMethod::ALL.into_iter();
    let names = all
        .filter(|method| method.is_conservative())
        .map(BendingMethod::name);
    Vec::from_iter(names).join(", ")
}
