//! Time of an evaluation: the median of several runs, and their scatter.

use crate::clock;
use std::time::Duration;

/// The scatter above which a median is unreliable: the distance of the quartiles relative to the
/// median. On an idle machine it is a few hundredths, while the compared methods differ by tenths
/// and more.
pub const MOST_SCATTER: f64 = 0.25;

/// Duration of repeated runs, and their largest number.
const WHILE: Duration = Duration::from_millis(40);
const MOST: usize = 1000;

/// Number of runs after which, and as often again, it is asked whether more would change the median.
const SEVERAL: usize = 25;

/// Scatter at which they would not: the median of 25 runs is then right within 2 %.
const LITTLE_SCATTER: f64 = 0.1;

/// Times of several runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Timing {
    /// The median.
    pub(crate) median: Duration,
    /// The distance of the quartiles over the median; 0 of a single run.
    pub(crate) scatter: f64,
}

impl Timing {
    /// Repeats runs until their median is known, at most for a short time, at least three times. Longer runs, which are disturbed less,
    /// are repeated less: twice from 0.1 s on, and once from 0.4 s on, unless their times
    /// contradict that of the `first` run. `first` is the time of an earlier run, which has warmed
    /// the memory.
    pub(crate) fn of_runs(first: Duration, mut run: impl FnMut()) -> Self {
        let start = clock::now();
        let mut times = Vec::new();
        while is_more_needed(first, &times, clock::since(start)) {
            let one = clock::now();
            run();
            times.push(clock::since(one));
        }
        Self::of(times)
    }

    /// The time of a single run.
    pub(crate) fn of_one(median: Duration) -> Self {
        Self {
            median,
            scatter: 0.0,
        }
    }

    /// Combines one run and further runs.
    fn of(mut times: Vec<Duration>) -> Self {
        times.sort_unstable();
        let last = times.len() - 1;
        let median = times[last / 2];
        let range = times[last - last / 4] - times[last / 4];
        Self {
            median,
            scatter: share(range, median),
        }
    }
}

/// Whether `scatter` makes the median unreliable.
pub(crate) fn is_scattered(scatter: f64) -> bool {
    scatter.is_nan() || scatter > MOST_SCATTER
}

fn share(part: Duration, whole: Duration) -> f64 {
    if part.is_zero() {
        0.0
    } else {
        part.as_secs_f64() / whole.as_secs_f64()
    }
}

/// Whether one more run is needed after these, which took `elapsed` together.
fn is_more_needed(first: Duration, times: &[Duration], elapsed: Duration) -> bool {
    let fewest = match first.as_millis() {
        400.. => 1,
        100.. => 2,
        _ => 3,
    };
    let (Some(&shortest), Some(&longest)) = (times.iter().min(), times.iter().max()) else {
        return true;
    };
    let (shortest, longest) = (shortest.min(first), longest.max(first));
    let contradicted = is_scattered(share(longest - shortest, shortest));
    let fewest = if contradicted { 3 } else { fewest };
    let settled = || Timing::of(times.to_vec()).scatter < LITTLE_SCATTER;
    let known = times.len().is_multiple_of(SEVERAL) && settled();
    times.len() < fewest || (elapsed < WHILE && times.len() < MOST && !known)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn milliseconds(times: &[u64]) -> Vec<Duration> {
        times.iter().copied().map(Duration::from_millis).collect()
    }

    #[test]
    fn medians_and_quartiles_of_known_times() {
        for (times, median, scatter) in [
            (&[7][..], 7, 0.0),
            (&[10, 12], 10, 0.2),
            (&[12, 10, 11], 11, 2.0 / 11.0),
            (&[50, 10, 11, 12, 13], 12, 2.0 / 12.0),
            (&[10, 10, 10, 10, 90, 10, 10, 10, 10], 10, 0.0),
            (&[10, 20, 10, 20, 10, 20, 10, 20, 10], 10, 1.0),
            (&[0, 0, 0], 0, 0.0),
        ] {
            let timing = Timing::of(milliseconds(times));
            assert_eq!(timing.median, Duration::from_millis(median), "{times:?}");
            assert!(
                (timing.scatter - scatter).abs() < 1e-12,
                "{times:?}: {timing:?}"
            );
        }
        // Half of them in no time at all: how far the rest is off is no share of that.
        assert!(is_scattered(Timing::of(milliseconds(&[0, 0, 5])).scatter));
    }

    #[test]
    fn a_quarter_is_the_limit() {
        let scattered = |times: &[u64]| is_scattered(Timing::of(milliseconds(times)).scatter);
        assert!(!scattered(&[100, 90, 115]));
        assert!(scattered(&[100, 90, 116]));
        assert!(is_scattered(f64::NAN) && is_scattered(f64::INFINITY));
    }

    #[test]
    fn long_runs_are_repeated_where_they_contradict_each_other() {
        let long = Duration::from_secs(1);
        let more = |first: u64, times: &[u64]| {
            is_more_needed(Duration::from_millis(first), &milliseconds(times), long)
        };
        assert!(more(500, &[]) && !more(500, &[500]) && more(500, &[800]) && more(900, &[500]));
        assert!(more(200, &[200]) && !more(200, &[200, 210]) && more(200, &[200, 300]));
        assert!(more(20, &[20, 20]) && !more(20, &[20, 90, 20]));
        assert!(!more(900, &[500, 900, 500]));
        let short = milliseconds(&[1; 5]);
        assert!(is_more_needed(short[0], &short, Duration::from_millis(5)));
        // 25 runs that agree are enough, and where they differ more are needed.
        let soon = Duration::from_millis(5);
        let (mut alike, mut apart) = (vec![short[0]; SEVERAL], milliseconds(&[1; SEVERAL]));
        apart[..10].fill(Duration::from_millis(2));
        assert!(!is_more_needed(short[0], &alike, soon) && is_more_needed(short[0], &apart, soon));
        alike.pop();
        assert!(is_more_needed(short[0], &alike, soon));
        let many = vec![Duration::from_nanos(1); MOST];
        assert!(!is_more_needed(many[0], &many, Duration::from_millis(5)));
    }
}
