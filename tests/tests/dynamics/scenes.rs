//! Scenes, run as users run them.

use helfrich_std::run::{End, Summary, run};
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_std::series::SeriesTable;
use helfrich_std::simulation::build;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use tempfile::TempDir;

pub(crate) fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../std-ext/scene/scenes")
}

/// Runs a shipped scene without its pictures.
pub(crate) fn run_scene(name: &str, overrides: &[&str]) -> (Summary, SeriesTable) {
    // Slices are drawn at the start and the end only.
    let quiet = [
        "output.pictures=false",
        "output.surfaces=false",
        "output.files_every=1000",
    ];
    let overrides = Overrides::new(quiet.iter().chain(overrides).copied()).expect("overrides");
    let file = SceneFile::read(&scenes().join(name), &overrides);
    run_file(file.unwrap_or_else(|errors| panic!("{errors}")))
}

/// The published capsule up to γ̇t = 4, computed once for all tests.
pub(crate) static PUBLISHED_CAPSULE: LazyLock<(Summary, SeriesTable)> =
    LazyLock::new(|| run_scene("capsule-shear.toml", &[]));

pub(crate) fn run_file(file: SceneFile) -> (Summary, SeriesTable) {
    let folder = TempDir::new().expect("a folder");
    let out = folder.path().join("out");
    let built = build(&file).expect("a simulation");
    let summary = run(&file.scene, built, &out, false, &|| false, &mut |_| {});
    let summary = summary.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(summary.end, End::Completed, "{}", summary.message);
    let series = SeriesTable::read(&out.join("series.csv")).expect("a series");
    (summary, series)
}

pub(crate) fn column(series: &SeriesTable, name: &str) -> Vec<f64> {
    let found = series.column(name);
    found.unwrap_or_else(|| panic!("no column {name} among {:?}", series.columns))
}

/// Last number of a column.
pub(crate) fn last(series: &SeriesTable, name: &str) -> f64 {
    *column(series, name).last().expect("a row")
}

/// Deformation at this strain, interpolated linearly between two rows.
pub(crate) fn at(series: &SeriesTable, strain: f64) -> f64 {
    let (strains, values) = (column(series, "strain"), column(series, "deformation"));
    let after = strains.partition_point(|&found| found < strain).max(1);
    let share = (strain - strains[after - 1]) / (strains[after] - strains[after - 1]);
    values[after - 1] + share * (values[after] - values[after - 1])
}
