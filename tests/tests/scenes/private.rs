//! Private modules of helfrich-std that contain tests. They are compiled here, so that the library need not
//! be compiled a second time for its tests.

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

#[expect(dead_code, reason = "the library uses what the tests do not")]
#[path = "../../../std-ext/src/simulation/once.rs"]
mod once;

#[expect(dead_code, reason = "the library uses what the tests do not")]
#[path = "../../../std-ext/src/study/timing.rs"]
mod timing;

#[path = "../../../std-ext/src/study/measured.rs"]
mod measured;

/// The cache to which the module of measurements refers.
mod cache {
    pub(super) use helfrich_std::study::Cache;
}
