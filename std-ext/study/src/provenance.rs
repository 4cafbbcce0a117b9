//! The origin of measurements: program, compiler, machine.

use crate::io::sha256;
use serde::Serialize;
use std::fs;
use std::thread::available_parallelism;
use std::time::{SystemTime, UNIX_EPOCH};

/// The build of a program, recorded by its build script.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Build {
    /// The commit of the sources, with `-dirty` if they had been changed; empty if the sources were
    /// not in a repository.
    pub commit: &'static str,
    /// The compiler and its version.
    pub compiler: &'static str,
    /// The profile, with the level of optimisation.
    pub profile: &'static str,
    /// Further flags of the compiler; usually empty.
    pub flags: &'static str,
    /// The target triple.
    pub target: &'static str,
}

/// Everything that a measurement of time depends on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Provenance {
    /// The version of the program.
    pub version: &'static str,
    /// Its build.
    #[serde(flatten)]
    pub build: Build,
    /// The SHA-256 of the program's file; zeros if it cannot be read.
    #[serde(skip)]
    pub program: [u8; 32],
    /// The name of the processor according to the operating system.
    pub processor: String,
    /// Widest vectors of the processor that Stokes sums and lattices use; other loops use AVX2 at most.
    pub vectors: &'static str,
    /// Number of threads.
    pub threads: usize,
}

impl Provenance {
    /// The provenance of this build of the program on this machine.
    pub fn here(build: Build) -> Self {
        let program = std::env::current_exe().and_then(fs::read);
        Self {
            version: env!("CARGO_PKG_VERSION"),
            build,
            program: program.map_or([0; 32], |bytes| sha256(&[&bytes])),
            processor: processor(),
            vectors: vectors(),
            threads: available_parallelism().map_or(1, usize::from),
        }
    }

    /// Processor, vectors and threads, which identify a machine for comparisons of times.
    pub fn machine(&self) -> String {
        let Self {
            processor,
            vectors,
            threads,
            ..
        } = self;
        format!("{processor}, {vectors}, {threads} threads")
    }
}

#[cfg(target_arch = "x86_64")]
fn vectors() -> &'static str {
    match pulp::Arch::new() {
        pulp::Arch::V4(_) => "AVX-512",
        pulp::Arch::V3(_) => "AVX2",
        _ => "SSE2",
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn vectors() -> &'static str {
    "the target's own vectors"
}

/// The name of the first processor on Linux; elsewhere only the architecture.
fn processor() -> String {
    let text = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let named = text.lines().find_map(|line| {
        let (key, value) = line.split_once(':')?;
        (key.trim() == "model name").then(|| value.trim().to_owned())
    });
    named.unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}

/// A time as a date and time of day in UTC. Days to dates: H. Hinnant, *chrono-compatible low-level
/// date algorithms* (2013, public domain).
pub fn date(when: SystemTime) -> String {
    let seconds = when
        .duration_since(UNIX_EPOCH)
        .map_or(0, |since| since.as_secs());
    let days = (seconds / 86_400) as i64 + 719_468;
    let era = days / 146_097;
    let of_era = days % 146_097;
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let shifted = (5 * of_year + 2) / 153;
    let day = of_year - (153 * shifted + 2) / 5 + 1;
    let month = if shifted < 10 {
        shifted + 3
    } else {
        shifted - 9
    };
    let year = year + 400 * era + i64::from(month <= 2);
    let (hour, minute) = (seconds / 3600 % 24, seconds / 60 % 60);
    format!("{year}-{month:02}-{day:02} {hour:02}:{minute:02} UTC")
}
