//! Relaxation by forces without an energy.

use crate::scenes::{last, scenes};
use helfrich_std::run::{End, Summary, run};
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_std::series::SeriesTable;
use helfrich_std::simulation::build;
use tempfile::TempDir;

/// Relaxes the shipped oblate vesicle by jets of degree 4 on a mesh of this family.
fn relaxed(family: &str) -> (Summary, SeriesTable) {
    let family = format!("surface.vesicle.family={family}");
    let overrides = [
        "surface.vesicle.bending.method=j4",
        "surface.vesicle.vertices=642",
        // The test is about forces; with so few vertices the energy is accurate to 5 %.
        "driver.energy_error=0.1",
        "output.pictures=false",
        "output.surfaces=false",
        family.as_str(),
    ];
    let overrides = Overrides::new(overrides).expect("overrides");
    let file = SceneFile::read(&scenes().join("vesicle-oblate-0.7.toml"), &overrides);
    let file = file.unwrap_or_else(|errors| panic!("{errors}"));
    let folder = TempDir::new().expect("a folder");
    let out = folder.path().join("out");
    let built = build(&file).expect("a simulation");
    let summary = run(&file.scene, built, &out, false, &|| false, &mut |_| {});
    let summary = summary.unwrap_or_else(|error| panic!("{error}"));
    let series = SeriesTable::read(&out.join("series.csv")).expect("a series");
    (summary, series)
}

/// On a mesh that is stretched along the rim, quasi-Newton steps (secants) circle the equilibrium with
/// residuals of 1 to 100. Newton steps reach it, because forces are continuous if fits do not depend on the
/// orientation of the surface.
#[test]
fn jets_get_to_equilibrium_on_stretched_meshes() {
    let energies = ["smooth", "relaxed"].map(|family| {
        let (summary, series) = relaxed(family);
        assert_eq!(summary.end, End::Converged, "{}", summary.message);
        let residual = last(&series, "residual");
        assert!(residual < 1e-5, "{family}: {residual:e}");
        // Secants circle for hundreds of steps.
        let steps = last(&series, "iteration");
        assert!(steps < 200.0, "{family}: {steps}");
        last(&series, "energy")
    });
    // The same equilibrium, up to the errors of both meshes.
    let ratio = energies[0] / energies[1];
    assert!((ratio - 1.0).abs() < 0.02, "{energies:?}");
}
