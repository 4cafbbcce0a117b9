//! The course of a flow in time.

use super::builder::Builder;
use super::keys::{
    Form, Key, Keys, Kind, Range, count_of, kinds, of_kinds, optional, positive, required,
};
use super::parameter::Parameters;
use super::reader::Reader;
use super::units::Dimension;
use crate::flow::Course;

pub(super) const COURSE: Key = optional(
    "course",
    Form::Table(&COURSES),
    "How the flow changes in time: a factor from −1 to 1 of its velocities, on a lattice of the velocities of \
     walls and of the force that drives a channel; by default it is steady. Rates, strains and dimensionless \
     numbers are those of the factor 1.",
);

const KINDS: &[Kind] = &[
    kind(
        "oscillation",
        &[required(
            "period",
            positive(Dimension::TIME),
            "T of the factor cos(2π t/T).",
        )],
    ),
    kind(
        "table",
        &[
            required(
                "times",
                Form::Numbers(Dimension::TIME, Range::Any),
                "Times in ascending order.",
            ),
            required(
                "factors",
                Form::Numbers(Dimension::NONE, Range::Signed),
                "A factor for each time; straight lines between, and the first and the last before and after all.",
            ),
        ],
    ),
];

const fn kind(name: &'static str, keys: &'static [Key]) -> Kind {
    Kind {
        name,
        keys,
        exactly_one: &[],
    }
}

static COURSES: Keys = Keys {
    keys: &of_kinds::<{ 1 + count_of(KINDS) }>(
        required(
            "kind",
            Form::Choice(|| kinds(&COURSES)),
            "\"oscillation\", cos(2π t/T); \"table\", straight lines between given factors, such as a start, a stop or \
             a reversal.",
        ),
        KINDS,
    ),
    exactly_one: &[],
    at_most_one: &[],
    needs: &[],
    kinds: KINDS,
};

impl Builder<'_> {
    /// The course of the driver's flow.
    pub(super) fn course(&mut self, driver: Option<Reader<'_>>) -> Course {
        let table = driver.and_then(|driver| driver.table("flow"));
        let Some(course) = table.and_then(|table| table.table("course")) else {
            return Course::Steady;
        };
        if course.text("kind") != Some("table") {
            let period = course.needed("period");
            return Course::Oscillation { period };
        }
        let [times, factors] = ["times", "factors"].map(|key| course.numbers(key));
        if times.len() != factors.len() {
            self.contradiction(
                &course.origin_of("factors"),
                format!(
                    "there are {} factors for {} times: give one for each",
                    factors.len(),
                    times.len()
                ),
            );
            return Course::Steady;
        }
        let ascends = |pair: &[f64]| pair[0] < pair[1];
        if let Some(first) = times.windows(2).position(|pair| !ascends(pair)) {
            self.contradiction(
                &course.origin_of("times"),
                format!(
                    "time {} does not come after time {}: times ascend; for a jump give two that are close",
                    first + 2,
                    first + 1
                ),
            );
            return Course::Steady;
        }
        if times.is_empty() {
            return Course::Steady;
        }
        Course::Table { times, factors }
    }
}

/// The course in words, to follow those of the flow; empty if it is steady.
pub(crate) fn words(course: &Course, number: &Parameters) -> String {
    match course {
        Course::Steady => String::new(),
        Course::Oscillation { period } => {
            format!(
                ", times cos(2π t/T), {}",
                number.of("T", *period, Dimension::TIME)
            )
        }
        Course::Table { times, factors } => {
            let points = times.iter().zip(factors);
            let points = points.map(|(&time, factor)| {
                format!("{factor} at {}", number.of("t", time, Dimension::TIME))
            });
            format!(", times {}", Vec::from_iter(points).join(", "))
        }
    }
}
