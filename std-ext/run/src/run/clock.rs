//! Times of a run in a flow.

use super::RunError;
use crate::flow::Course;
use crate::scene::{Every, Flow, Scene};
use serde::{Deserialize, Serialize};

/// Relative difference below which two times are the same.
const ROUNDING: f64 = 1e-9;

/// The time of a run in a flow: its end, the times of outputs, and its names in tables.
#[derive(Clone, Debug)]
pub(super) struct Clock {
    pub(super) duration: f64,
    schedule: Schedule,
    /// Deformation rate of the flow, 1/time.
    rate: Option<f64>,
    course: Course,
}

/// The times at which outputs are due: plain data, for a checkpoint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Schedule {
    /// The end of the run at the time when the schedule was made.
    end: f64,
    /// Time between outputs.
    interval: f64,
    /// Number of elapsed intervals minus number of outputs: not 0 if the interval or the end has
    /// changed during the run.
    ahead: i64,
}

impl Clock {
    pub(super) fn new(scene: &Scene, flow: &Flow, duration: f64) -> Self {
        let interval = match scene.output.every {
            Every::Time(interval) => interval,
            Every::Iterations(_) => duration,
        };
        Self {
            duration,
            schedule: Schedule {
                end: duration,
                interval,
                ahead: 0,
            },
            rate: flow.rate(),
            course: scene.course.clone(),
        }
    }

    /// Clock of a run that continues at a time, after a number of outputs without the first. If its end
    /// or its interval has changed, outputs follow at the multiples of the new interval. Outputs are
    /// made at most `early` before they are due.
    pub(super) fn taken_up(
        mut self,
        before: Schedule,
        time: f64,
        early: f64,
        outputs: u64,
    ) -> Result<Self, RunError> {
        if time - early > self.duration * (1.0 + ROUNDING) {
            let duration = self.duration;
            return Err(RunError::Past { time, duration });
        }
        let Schedule { end, interval, .. } = self.schedule;
        if [end, interval] == [before.end, before.interval] {
            self.schedule = before;
        } else {
            let passed = ((time + early) / interval * (1.0 + ROUNDING)).floor();
            self.schedule.ahead = passed as i64 - outputs as i64;
        }
        Ok(self)
    }

    pub(super) fn schedule(&self) -> Schedule {
        self.schedule
    }

    /// The time of the next output after `outputs` outputs, not counting the first; the last is at the end.
    pub(super) fn next_output(&self, outputs: u64) -> f64 {
        let next = (outputs as i64 + 1 + self.schedule.ahead) as f64 * self.schedule.interval;
        // An interval that would end within rounding of the end is extended to it.
        if next >= self.duration * (1.0 - ROUNDING) {
            self.duration
        } else {
            next
        }
    }

    /// The names of the columns of time.
    pub(super) fn columns(&self) -> Vec<String> {
        let varies = !self.course.is_steady();
        let columns = ["time"].into_iter().chain(self.rate.map(|_| "strain"));
        let columns = columns.chain(varies.then_some("flow_factor"));
        columns.map(str::to_owned).collect()
    }

    /// The time; if the flow has a rate, also the strain, which is the time in units of the inverse rate; if the
    /// flow varies, also its factor at that time.
    pub(super) fn numbers(&self, time: f64) -> Vec<f64> {
        let strain = self.rate.map(|rate| rate * time);
        let factor = (!self.course.is_steady()).then(|| self.course.at(time));
        [time].into_iter().chain(strain).chain(factor).collect()
    }

    pub(super) fn caption(&self, time: f64) -> String {
        match self.rate {
            Some(rate) => format!("γ̇t = {:.3}", rate * time),
            None => format!("t = {time:.4}"),
        }
    }

    /// The progress of the run, with the length of its steps.
    pub(super) fn progress(&self, time: f64, step: f64) -> String {
        let caption = self.caption(time);
        match self.rate {
            Some(rate) => {
                let end = rate * self.duration;
                format!("{caption} of {end:.3}, step {:.4}", rate * step)
            }
            None => format!("{caption} of {:.4}, step {step:.3e}", self.duration),
        }
    }
}
