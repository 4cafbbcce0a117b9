//! Integration in time: `x' = v(x, t)`.
//!
//! An [`Integrator`] moves positions with the velocities of a [`RightHandSide`]. There are four schemes:
//! stabilised steps with many stages for stiff problems, such as bending; linearly implicit steps for
//! very stiff ones; an embedded pair of third order for others; and the classical scheme of fourth
//! order with a fixed step. The spectral radius, a measure of stiffness, is estimated during the run.
//!
//! The state is plain data: a stored and restored run continues bit for bit.

mod bs23;
mod right_hand_side;
mod rk4;
mod rkc2;
mod rosenbrock;
mod settings;
mod spectral_radius;
mod step_control;

pub use right_hand_side::{Failure, RightHandSide};
pub use settings::{Scheme, Settings, SetupError, SpectralRadius};
pub use spectral_radius::Spectrum;

use super::vector::Vector;
use right_hand_side::{Checked, first_bad};
use serde::{Deserialize, Serialize};
use step_control::Previous;

/// The factor by which a step is shortened if its velocities fail.
const RETREAT: f64 = 0.25;

/// Accepted steps between two estimates of the spectral radius.
const OUTDATED: usize = 25;

/// The relative change of a proposed step that is allowed to reach an output time.
const SLACK: f64 = 1e-6;

/// The state of a run: plain data. A stored and restored run continues bit for bit, if numbers are stored
/// without loss.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    time: f64,
    positions: Vec<Vector>,
    /// The velocities at `positions`; empty before the first evaluation.
    velocities: Vec<Vector>,
    /// The step that is proposed; `None` before the first.
    step: Option<f64>,
    /// The last step that was not shortened.
    previous: Option<Previous>,
    spectrum: Option<Spectrum>,
    /// Accepted steps since the spectrum was estimated.
    age: usize,
    /// The last iterate of power iteration; empty before the first.
    mode: Vec<Vector>,
    accepted: usize,
    rejected: usize,
    evaluations: usize,
}

/// Report of a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepReport {
    /// The time after the step.
    pub time: f64,
    /// The length of the step; 0 if there was none.
    pub step: f64,
    /// The step that is proposed next, within its limits, output times aside; `None` before there was one.
    pub next_step: Option<f64>,
    /// The error estimate in units of that allowed; 0 for [`Scheme::Rk4`], which has none.
    pub error: f64,
    /// Number of stages.
    pub stages: usize,
    /// Number of accepted steps so far.
    pub accepted: usize,
    /// Number of rejected steps so far.
    pub rejected: usize,
    /// Number of evaluations so far, those for the spectral radius included.
    pub evaluations: usize,
    /// The last estimate of the spectrum, unless it was not asked for.
    pub spectrum: Option<Spectrum>,
    /// The longest stable step of the scheme, on the negative real axis, for [`Scheme::Rkc2`] with
    /// the largest number of stages; `None` if the spectral radius is not known or 0, and for
    /// [`Scheme::Rosenbrock`].
    pub step_limit: Option<f64>,
}

/// Integration of positions in time.
#[derive(Debug)]
pub struct Integrator {
    settings: Settings,
    state: State,
    work: Work,
}

/// The start of a step.
#[derive(Clone, Copy)]
struct Start<'a> {
    time: f64,
    positions: &'a [Vector],
    velocities: &'a [Vector],
}

/// Memory of a step, and its result.
#[derive(Debug)]
struct Work {
    end: Vec<Vector>,
    end_velocities: Vec<Vector>,
    stages: [Vec<Vector>; 4],
}

impl Integrator {
    /// Positions at a time.
    ///
    /// # Errors
    /// If settings are invalid, or a position or the time is not finite.
    pub fn new(
        positions: Vec<[f64; 3]>,
        time: f64,
        settings: Settings,
    ) -> Result<Self, SetupError> {
        let state = State {
            time,
            positions,
            velocities: Vec::new(),
            step: None,
            previous: None,
            spectrum: None,
            age: 0,
            mode: Vec::new(),
            accepted: 0,
            rejected: 0,
            evaluations: 0,
        };
        Self::resume(state, settings)
    }

    /// Restores a stored state.
    ///
    /// # Errors
    /// As [`Self::new`], or if parts of the state do not belong together.
    pub fn resume(state: State, settings: Settings) -> Result<Self, SetupError> {
        settings.check()?;
        let count = state.positions.len();
        for part in [&state.velocities, &state.mode] {
            let found = part.len();
            if found != 0 && found != count {
                let positions = count;
                return Err(SetupError::CountMismatch { found, positions });
            }
        }
        let bad = [&state.positions, &state.velocities, &state.mode];
        let bad = bad.into_iter().find_map(|field| first_bad(field));
        if let Some(vertex) = bad.or((!state.time.is_finite()).then_some(0)) {
            return Err(SetupError::NotFinite { vertex });
        }
        let field = || vec![[0.0; 3]; count];
        let work = Work {
            end: field(),
            end_velocities: field(),
            stages: [field(), field(), field(), field()],
        };
        Ok(Self {
            settings,
            state,
            work,
        })
    }

    /// The integration continued from other positions at the same time, such as those of new meshes, with the numbers of
    /// steps and evaluations so far.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn on_new_positions(
        &self,
        positions: Vec<[f64; 3]>,
        settings: Settings,
    ) -> Result<Self, SetupError> {
        let mut new = Self::new(positions, self.state.time, settings)?;
        new.state.accepted = self.state.accepted;
        new.state.rejected = self.state.rejected;
        new.state.evaluations = self.state.evaluations;
        Ok(new)
    }

    /// The state to store so that the run can be continued.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The settings of the run.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The current time.
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// The positions at that time.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.state.positions
    }

    /// Their velocities, of the positions that were restored; empty before the first step.
    pub fn velocities(&self) -> &[[f64; 3]] {
        &self.state.velocities
    }

    /// Must be called after parameters of the right-hand side have changed between two steps: velocities,
    /// step and spectrum are then computed again.
    pub fn right_hand_side_changed(&mut self) {
        self.state.velocities.clear();
        self.state.step = None;
        self.state.previous = None;
        self.state.spectrum = None;
    }

    /// Estimates the spectrum at the current positions, as steps do with [`SpectralRadius::Estimated`].
    ///
    /// # Errors
    /// If velocities cannot be computed.
    pub fn estimate_spectrum(
        &mut self,
        right_hand_side: &mut dyn RightHandSide,
    ) -> Result<Spectrum, Failure> {
        self.arrive(right_hand_side)?;
        let state = &mut self.state;
        let start = Start {
            time: state.time,
            positions: &state.positions,
            velocities: &state.velocities,
        };
        let mut checked = Checked {
            inner: right_hand_side,
            evaluations: &mut state.evaluations,
        };
        let (settings, work) = (&self.settings, &mut self.work);
        let spectrum =
            spectral_radius::estimate(&mut checked, start, settings, &mut state.mode, work)?;
        state.spectrum = Some(spectrum);
        state.age = 0;
        Ok(spectrum)
    }

    /// Takes one accepted step, which ends at `until` at the latest. A step shortened to end there does
    /// not affect the following steps. A time that has passed, or is not finite, changes nothing.
    ///
    /// # Errors
    /// If velocities cannot be computed here or at the end of every step above the shortest
    /// meaningful length, or if the error of every such step is too large. Time and positions are
    /// then unchanged.
    pub fn step(
        &mut self,
        right_hand_side: &mut dyn RightHandSide,
        until: f64,
    ) -> Result<StepReport, Failure> {
        let remaining = until - self.state.time;
        if !remaining.is_finite() || remaining <= 0.0 {
            return Ok(self.report(0.0, 0.0, 0));
        }
        self.arrive(right_hand_side)?;
        let mut fresh = false;
        let mut first = None;
        loop {
            let estimated = self.settings.spectral_radius == SpectralRadius::Estimated;
            let outdated = self.state.age >= OUTDATED || (fresh && self.state.age > 0);
            if estimated && (outdated || self.state.spectrum.is_none()) {
                self.estimate_spectrum(right_hand_side)?;
            }
            let wished = match (self.settings.scheme, self.state.step) {
                (Scheme::Rk4 { step }, _) | (_, Some(step)) => step,
                (_, None) => self.first_step(right_hand_side, remaining)?,
            };
            let longest = self.settings.longest_step.unwrap_or(f64::INFINITY);
            let limit = self.step_limit().unwrap_or(f64::INFINITY);
            let proposed = wished.min(longest).min(limit);
            self.state.step = Some(proposed);
            let shortened = remaining < proposed * (1.0 - SLACK);
            let last = remaining <= proposed * (1.0 + SLACK);
            let end_time = if last {
                until
            } else {
                self.state.time + proposed
            };
            let step = end_time - self.state.time;
            let stages = self.stages(step);
            let floor = self.floor(*first.get_or_insert(step));
            let error = match self.attempt(right_hand_side, end_time, stages) {
                Ok(error) => error / (self.settings.tolerance * self.settings.length),
                Err(failure) => {
                    self.state.rejected += 1;
                    fresh = true;
                    let shorter = RETREAT * step;
                    let fixed = matches!(self.settings.scheme, Scheme::Rk4 { .. });
                    if fixed || shorter < floor {
                        return Err(failure);
                    }
                    self.state.step = Some(shorter);
                    continue;
                }
            };
            // Not written as `error > 1`, so that a step with NaN is rejected.
            if error <= 1.0 {
                self.accept(end_time);
                if !shortened {
                    self.choose_step(step, error);
                }
                return Ok(self.report(step, error, stages));
            }
            self.state.rejected += 1;
            fresh = true;
            let shorter = Self::shorter(step, error);
            if shorter < floor {
                return Err(Failure::StepBelowFloor {
                    time: self.state.time,
                    tried: step,
                    error,
                    floor,
                });
            }
            self.state.step = Some(shorter);
        }
    }

    /// Steps until a time is reached, exactly; `each` sees every step and may stop there by `false`.
    /// Returns the last report.
    ///
    /// # Errors
    /// As [`Self::step`].
    pub fn run(
        &mut self,
        right_hand_side: &mut dyn RightHandSide,
        until: f64,
        mut each: impl FnMut(&Self, &StepReport) -> bool,
    ) -> Result<StepReport, Failure> {
        loop {
            let report = self.step(right_hand_side, until)?;
            let arrived = report.step == 0.0 || self.state.time >= until;
            if !each(self, &report) || arrived {
                return Ok(report);
            }
        }
    }

    /// Evaluates the first velocities.
    fn arrive(&mut self, right_hand_side: &mut dyn RightHandSide) -> Result<(), Failure> {
        let state = &mut self.state;
        if state.velocities.len() == state.positions.len() {
            return Ok(());
        }
        let mut checked = Checked {
            inner: right_hand_side,
            evaluations: &mut state.evaluations,
        };
        checked.evaluate(&state.positions, state.time, &mut self.work.end_velocities)?;
        state.velocities.clone_from(&self.work.end_velocities);
        Ok(())
    }

    /// Takes a step of the scheme without error control; returns the error estimate.
    fn attempt(
        &mut self,
        right_hand_side: &mut dyn RightHandSide,
        end_time: f64,
        stages: usize,
    ) -> Result<f64, Failure> {
        let state = &mut self.state;
        let start = Start {
            time: state.time,
            positions: &state.positions,
            velocities: &state.velocities,
        };
        let mut checked = Checked {
            inner: right_hand_side,
            evaluations: &mut state.evaluations,
        };
        let work = &mut self.work;
        match self.settings.scheme {
            Scheme::Rkc2 => rkc2::advance(&mut checked, start, end_time, stages, work),
            Scheme::Bs23 => bs23::advance(&mut checked, start, end_time, work),
            Scheme::Rosenbrock => rosenbrock::advance(&mut checked, start, end_time, work),
            Scheme::Rk4 { .. } => rk4::advance(&mut checked, start, end_time, work).map(|()| 0.0),
        }
    }

    fn accept(&mut self, end_time: f64) {
        let (state, work) = (&mut self.state, &mut self.work);
        state.time = end_time;
        std::mem::swap(&mut state.positions, &mut work.end);
        std::mem::swap(&mut state.velocities, &mut work.end_velocities);
        state.accepted += 1;
        state.age += 1;
    }

    fn stages(&self, step: f64) -> usize {
        match self.settings.scheme {
            Scheme::Rkc2 => {
                let radius = self.state.radius(&self.settings).unwrap_or(0.0);
                rkc2::stages(step, radius).min(self.settings.largest_stages())
            }
            Scheme::Bs23 => 3,
            Scheme::Rosenbrock | Scheme::Rk4 { .. } => 4,
        }
    }

    fn report(&self, step: f64, error: f64, stages: usize) -> StepReport {
        let state = &self.state;
        let step_limit = self.step_limit();
        let limits = [self.settings.longest_step, step_limit];
        let limit = limits.into_iter().flatten().fold(f64::INFINITY, f64::min);
        StepReport {
            time: state.time,
            step,
            next_step: state.step.map(|step| step.min(limit)),
            error,
            stages,
            accepted: state.accepted,
            rejected: state.rejected,
            evaluations: state.evaluations,
            spectrum: state.spectrum,
            step_limit,
        }
    }
}

impl State {
    /// The spectral radius, if it is known.
    fn radius(&self, settings: &Settings) -> Option<f64> {
        match settings.spectral_radius {
            SpectralRadius::Estimated => self.spectrum.map(|spectrum| spectrum.radius),
            SpectralRadius::Given(radius) => Some(radius),
            SpectralRadius::Unknown => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Integrator, Scheme, Settings, State, StepReport};

    /// Vertices of a chain that are drawn to their neighbours, turned, and kept from the origin.
    fn chain(x: &[[f64; 3]], time: f64, v: &mut [[f64; 3]]) -> Result<(), String> {
        for i in 0..x.len() {
            let [before, after] = [i.saturating_sub(1), (i + 1).min(x.len() - 1)];
            let size: f64 = x[i].iter().map(|x| x * x).sum();
            for axis in 0..3 {
                let drawn = 40.0 * (x[before][axis] - 2.0 * x[i][axis] + x[after][axis]);
                v[i][axis] = drawn + (1.0 - size) * x[i][axis];
            }
            v[i][0] -= time.cos() * x[i][1];
            v[i][1] += time.cos() * x[i][0];
        }
        Ok(())
    }

    fn positions() -> Vec<[f64; 3]> {
        let position = |i: u32| {
            let s = f64::from(i);
            [(3.0 * s).sin(), 0.2 + s.cos(), 0.1 * (7.0 * s).sin()]
        };
        (0..30).map(position).collect()
    }

    #[test]
    fn a_stored_state_continues_bit_for_bit() {
        for scheme in [
            Scheme::Rkc2,
            Scheme::Bs23,
            Scheme::Rosenbrock,
            Scheme::Rk4 { step: 0.03 },
        ] {
            let settings = Settings::new(scheme, 1.0);
            let mut whole = Integrator::new(positions(), 0.25, settings).expect("a start");
            let mut expected = Vec::new();
            for output in [1.0, 1.001, 2.0] {
                whole
                    .run(&mut chain, output, |_, report| {
                        expected.push(*report);
                        true
                    })
                    .expect("no failure");
                assert_eq!(whole.time(), output);
            }

            let mut parts = Integrator::new(positions(), 0.25, settings).expect("a start");
            let mut reports: Vec<StepReport> = Vec::new();
            for output in [1.0, 1.001, 2.0] {
                while parts.time() < output {
                    reports.push(parts.step(&mut chain, output).expect("no failure"));
                    let bytes = postcard::to_stdvec(parts.state()).expect("encodes");
                    let state: State = postcard::from_bytes(&bytes).expect("decodes");
                    parts = Integrator::resume(state, settings).expect("a state");
                }
            }
            assert!(expected.len() > 30, "the spectrum is found anew on the way");
            assert_eq!(reports, expected, "{scheme:?}");
            assert_eq!(parts.state(), whole.state(), "{scheme:?}");
        }
    }
}
