//! Time, as runs in a flow count it.

use crate::scene::{Every, Flow, Scene};

/// The time of a run in a flow: when it ends, when outputs are due, and what it is called.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    pub(super) duration: f64,
    /// Time between outputs.
    interval: f64,
    /// The flow's own, 1/time.
    rate: Option<f64>,
}

impl Clock {
    pub(super) fn new(scene: &Scene, flow: &Flow, duration: f64) -> Self {
        let interval = match scene.output.every {
            Every::Time(interval) => interval,
            Every::Iterations(_) => duration,
        };
        Self {
            duration,
            interval,
            rate: flow.rate(),
        }
    }

    /// When the next output is due after so many, the first not counted; the end is the last one.
    pub(super) fn next_output(&self, outputs: u64) -> f64 {
        let next = (outputs + 1) as f64 * self.interval;
        // An interval that ends within a rounding of the end ends there.
        if next >= self.duration * (1.0 - 1e-9) {
            self.duration
        } else {
            next
        }
    }

    /// The names of the time's columns.
    pub(super) fn columns(&self) -> Vec<String> {
        let columns = ["time"].into_iter().chain(self.rate.map(|_| "strain"));
        columns.map(str::to_owned).collect()
    }

    /// The time, and in units of the flow's own if it has one.
    pub(super) fn numbers(&self, time: f64) -> Vec<f64> {
        let strain = self.rate.map(|rate| rate * time);
        [time].into_iter().chain(strain).collect()
    }

    pub(super) fn caption(&self, time: f64) -> String {
        match self.rate {
            Some(rate) => format!("γ̇t = {:.3}", rate * time),
            None => format!("t = {time:.4}"),
        }
    }

    /// How far it is, and how long steps are.
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
