//! Private modules of helfrich-std with their own tests: compiled here, so that the library need not be
//! compiled a second time for them.

use helfrich_std::scene::UnitSystem;

#[expect(dead_code, reason = "the library uses what the tests do not")]
#[path = "../../../std-ext/src/scene/units.rs"]
mod units;

#[expect(dead_code, reason = "the library uses what the tests do not")]
#[path = "../../../std-ext/src/six.rs"]
mod six;

#[path = "../../../std-ext/src/sweep/vary.rs"]
mod vary;

#[path = "../../../std-ext/src/run/curved.rs"]
mod curved;

#[path = "../../../std-ext/src/run/multipliers.rs"]
mod multipliers;

#[expect(dead_code, reason = "the library uses what the tests do not")]
#[path = "../../../std-ext/src/simulation/once.rs"]
mod once;

#[expect(dead_code, reason = "the library uses what the tests do not")]
#[path = "../../../std-ext/src/study/timing.rs"]
mod timing;

#[path = "../../../std-ext/src/study/measured.rs"]
mod measured;

/// The cache that measurements name.
mod cache {
    pub(super) use helfrich_std::study::Cache;
}
