//! Vesicles with properties that vary over the surface.

use helfrich::Surface;
use helfrich_std::generate::{Family, generate};
use helfrich_std::io::{PointField, PointValues, read_with_columns, write_vtp};
use helfrich_std::method::{BendingMethod, Evaluator};
use helfrich_std::run::{End, run};
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_std::simulation::build;
use std::path::Path;
use tempfile::TempDir;

/// Relaxes the vesicle of a mesh file with these bending keys. Returns `∫ H² dA` over the vertices that were
/// below and above the plane z = 0 in `vesicle.vtp`.
fn relaxed(folder: &Path, out: &str, mesh: &str, bending: &str) -> [f64; 2] {
    let text = format!(
        "units = \"none\"\n[driver]\nkind = \"relax\"\nenergy_error = 0.1\n[output]\npictures = \
         false\n[[surface]]\nmesh = \"{mesh}\"\nelasticity = {{ law = \"skalak\", shear_modulus = 1, area_ratio = 100, \
         reference = {{ mesh = \"vesicle.vtp\" }} }}\nvolume = {{ constraint = \
         \"exact\", reduced = 0.9 }}\nbending = {{ method = \"loop\", {bending} }}\n"
    );
    let file = SceneFile::parse(&text, &folder.join("scene.toml"), &Overrides::default());
    let file = file.unwrap_or_else(|errors| panic!("{errors}"));
    let out = folder.join(out);
    let built = build(&file).expect("a simulation");
    let summary = run(&file.scene, built, &out, false, &|| false, &mut |_| {});
    let summary = summary.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(summary.end, End::Converged, "{}", summary.message);
    let (start, _) = read_with_columns(&folder.join("vesicle.vtp")).expect("the start");
    let (last, _) = read_with_columns(&out.join("last.vtp")).expect("the end");
    let surface = Surface::new(&last.mesh, &last.positions).expect("a surface");
    let fields = Evaluator::new(BendingMethod::J4, 1.0, &last.mesh).fields(surface);
    let mut sums = [0.0; 2];
    for (vertex, start) in start.positions.iter().enumerate() {
        let (mean, area) = (fields.mean[vertex].expect("H"), fields.area[vertex]);
        sums[usize::from(start[2] > 0.0)] += mean * mean * area;
    }
    sums
}

/// A prolate vesicle whose upper half is five times as stiff bends more below than above; with a uniform
/// modulus, both halves are alike. H0 that favours curvature above has the opposite effect.
#[test]
fn soft_and_curved_parts_bend_more() {
    let folder = TempDir::new().expect("a folder");
    let made = generate(
        &"ellipsoid:1,1,1.6".parse().unwrap(),
        Family::Relaxed,
        642,
        1,
    );
    let made = made.expect("a mesh");
    let of = |below: f64, above: f64| {
        let value = |x: &[f64; 3]| if x[2] > 0.0 { above } else { below };
        Vec::from_iter(made.positions.iter().map(value))
    };
    let columns = [("kappa", of(1.0, 5.0)), ("H0", of(0.0, 1.0))];
    let fields = Vec::from_iter(columns.iter().map(|(name, values)| PointField {
        name,
        values: PointValues::Scalars(values),
    }));
    let path = folder.path().join("vesicle.vtp");
    write_vtp(&path, &made.mesh, &made.positions, None, &fields).expect("a file");
    let ratio = |out: &str, mesh: &str, bending: &str| {
        let [below, above] = relaxed(folder.path(), out, mesh, bending);
        below / above
    };
    let uniform = ratio("uniform", "vesicle.vtp", "modulus = 1");
    assert!((uniform - 1.0).abs() < 0.01, "{uniform}");
    let soft_below = ratio("soft", "vesicle.vtp", "modulus = { column = \"kappa\" }");
    assert!(soft_below > 1.1, "{soft_below}");
    // The final mesh file of a run keeps the columns that its scene names.
    let (_, kept) = read_with_columns(&folder.path().join("soft/last.vtp")).expect("the end");
    let [kappa] = kept.as_slice() else {
        panic!("{kept:?}");
    };
    assert_eq!(
        (kappa.name.as_str(), &kappa.values),
        ("kappa", &columns[0].1)
    );
    let curved_above = ratio(
        "curved",
        "vesicle.vtp",
        "modulus = 1, spontaneous_curvature = { column = \"H0\" }",
    );
    assert!(curved_above < 0.9, "{curved_above}");
}
