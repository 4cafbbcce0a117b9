//! Time since a fixed moment, also on targets where the standard library has no clock.

use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// The clock that [`set`] has given.
static GIVEN: OnceLock<fn() -> Duration> = OnceLock::new();

/// Takes the time from another clock, which must not run backwards: in a browser there is none in the standard library,
/// whose [`Instant::now`] panics there. Only the first call counts.
pub fn set(clock: fn() -> Duration) {
    GIVEN.get_or_init(|| clock);
}

/// The time since a fixed moment.
pub fn now() -> Duration {
    static START: OnceLock<Instant> = OnceLock::new();
    match GIVEN.get() {
        Some(clock) => clock(),
        None => START.get_or_init(Instant::now).elapsed(),
    }
}

/// The time that has passed since [`now`] returned `start`.
pub fn since(start: Duration) -> Duration {
    now().saturating_sub(start)
}
