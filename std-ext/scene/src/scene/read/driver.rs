//! Builds the driver from its values.

use super::super::builder::Builder;
use super::super::reader::Reader;
use super::super::{BoundaryIntegral, Driver, Flow, Hold, Integrator, Relax, Scheme, SurfaceScene};
use crate::method::BendingMethod;
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
                .as_ref()
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
            modes: self.modes(driver, scheme),
            residual: driver.number("residual").unwrap_or(1e-5),
            iterations: driver.count("iterations").unwrap_or(10_000),
            redistribution: self.redistribution(driver, surfaces, SurfaceScene::is_fluid),
            energy_error: driver.number("energy_error").unwrap_or(0.01),
        }
    }

    /// Number of normal modes, which need an energy.
    fn modes(&mut self, driver: Reader<'_>, scheme: Scheme) -> u64 {
        let modes = driver.count("modes").unwrap_or(0);
        let problem = if modes > 0 && scheme != Scheme::Minimise {
            "`modes` are those of an energy, and the scheme \"overdamped\" has none: leave `modes` out, or \
             choose a bending method with an energy and the scheme \"minimise\""
                .to_owned()
        } else if modes > MOST_MODES {
            format!("{modes} modes: the limit is {MOST_MODES}; choose fewer")
        } else {
            return modes;
        };
        self.contradiction(&driver.origin_of("modes"), problem);
        0
    }

    /// Whether vertices are moved along the surfaces; `may` states whether any surface allows it.
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
            cluster_tolerance: driver.number("cluster_tolerance"),
            volume_correction: driver.switch("volume_correction").unwrap_or(true),
            redistribution: self.redistribution(driver, surfaces, SurfaceScene::slides),
        }
    }

    /// Warns about volumes that are not conserved.
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
        // The error of an invalid value has been reported already.
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
    pub(super) fn time_of(
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
        // The error of a value that is not finite, or is 0 where this is not allowed, has been reported
        // already.
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
            Some("rosenbrock") => Integrator::Rosenbrock,
            Some("bs23") => Integrator::Bs23,
            _ if surfaces.iter().any(SurfaceScene::is_stiff) => Integrator::Rkc2,
            _ => Integrator::Bs23,
        }
    }
}

/// The largest number of normal modes: the time grows with its square.
const MOST_MODES: u64 = 100;

/// The largest number of steps of a run: at a millisecond per step they take four months.
const MOST_STEPS: f64 = 1e10;

/// The largest strain of a run: the largest number of steps, each with the largest strain of a step,
/// one half.
const MOST_STRAIN: f64 = 0.5 * MOST_STEPS;

/// The largest trace of a gradient, relative to its entries, that is attributed to rounding of its
/// digits.
const TRACE: f64 = 1e-9;

/// Placeholder for a driver that cannot be read.
pub(super) const PLACEHOLDER: Driver = Driver::Relax(Relax {
    scheme: Scheme::Overdamped,
    residual: f64::NAN,
    iterations: 0,
    redistribution: false,
    energy_error: f64::NAN,
    modes: 0,
});

fn conservative_methods() -> String {
    let all = BendingMethod::ALL.into_iter();
    let names = all
        .filter(|method| method.is_conservative())
        .map(BendingMethod::name);
    Vec::from_iter(names).join(", ")
}
