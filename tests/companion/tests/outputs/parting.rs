//! Runs whose surfaces part and join.

use super::remeshing::{column, continues, runs};
use helfrich_std::io::write_vtp_with_cells;
use helfrich_std::parting::Break;
use helfrich_std::run::{End, Remeshing, Summary};
use helfrich_tests::meshes::{Mesh, cap, icosphere};
use helfrich_tests::tolerance;
use std::f64::consts::PI;
use std::path::Path;
use tempfile::TempDir;

fn breaks(summary: &Summary) -> Vec<&Remeshing> {
    let events = summary.remeshings.iter();
    events.filter(|event| event.broke.is_some()).collect()
}

fn write(folder: &Path, mesh: &Mesh) {
    let path = folder.join("mesh.vtp");
    let Mesh {
        connectivity,
        positions,
        ..
    } = mesh;
    write_vtp_with_cells(&path, connectivity, positions, None, &[], &[]).expect("a file");
}

/// A disc whose line tension is above the threshold closes to a sphere, of which 8πκ is the energy.
#[test]
fn a_disc_closes_to_a_sphere() {
    let folder = TempDir::new().expect("a folder");
    write(folder.path(), &cap(9, 0.8));
    let text = r#"
units = "none"
[[surface]]
mesh = "mesh.vtp"
remesh = "auto"
topology = "may-break"
bending = { method = "juelicher", modulus = 1 }
area.constraint = "exact"
line_tension.value = 15
[driver]
kind = "relax"
iterations = 500
residual = 1e-3
[output]
every = 1
checkpoint_every = 7
files_every = 100000
pictures = false
"#;
    let out = folder.path().join("out");
    let summary = runs(text, folder.path(), &out, false, usize::MAX);
    assert_eq!(summary.end, End::Converged, "{}", summary.message);
    let broke = breaks(&summary);
    assert_eq!(broke.len(), 1, "{broke:?}");
    assert_eq!(
        (broke[0].broke, broke[0].euler_number),
        (Some(Break::Hole), [1, 2])
    );
    let last = |name: &str| *column(&out, name).last().expect("a row");
    assert!(
        (last("energy") / (8.0 * PI) - 1.0).abs() < 0.02,
        "{}",
        last("energy")
    );
    assert!(last("reduced_volume") > 0.999);
    let areas = column(&out, "area");
    for &area in &areas {
        tolerance::HELD.assert(area, areas[0], areas[0], "area");
    }
    continues(text, folder.path(), &out, 4);
}

/// Spontaneous curvature of more than two spheres pinches a vesicle off: area and volume of each part are held at what it got,
/// and together they are those of the vesicle.
#[test]
fn a_vesicle_parts_at_its_neck() {
    let folder = TempDir::new().expect("a folder");
    let text = r#"
units = "none"
[[surface]]
shape = "ellipsoid:0.583,0.583,2.119"
vertices = 642
remesh = { curvature = 25 }
topology = "may-break"
bending = { method = "juelicher", modulus = 1, spontaneous_curvature = 1.6 }
area.constraint = "exact"
volume = { constraint = "exact", reduced = 0.72 }
[driver]
kind = "relax"
iterations = 1000
residual = 1e-2
energy_error = 0.1
[output]
every = 1
checkpoint_every = 7
files_every = 100000
pictures = false
"#;
    let out = folder.path().join("out");
    let summary = runs(text, folder.path(), &out, false, usize::MAX);
    assert_eq!(summary.end, End::Converged, "{}", summary.message);
    let broke = breaks(&summary);
    assert_eq!(broke.len(), 1, "{broke:?}");
    assert_eq!(
        (broke[0].broke, broke[0].euler_number),
        (Some(Break::Neck), [2, 4])
    );
    for held in ["area", "volume"] {
        let values = column(&out, held);
        for &value in &values {
            tolerance::HELD.assert(value, values[0], values[0], held);
        }
    }
    continues(text, folder.path(), &out, 20);
}

/// Surface tension breaks a drop at its waist, in a fluid at rest: two drops, with the volume of the one.
#[test]
fn a_drop_breaks_at_its_waist() {
    let folder = TempDir::new().expect("a folder");
    let waist = icosphere(3).map(|[x, y, z]| {
        let width = 1.0 - 0.75 * (-(1.6 * x).powi(2)).exp();
        [3.5 * x, width * y, width * z]
    });
    write(folder.path(), &waist);
    let text = r#"
units = "none"
[[surface]]
mesh = "mesh.vtp"
remesh = "auto"
topology = { radius = 0.2 }
tension.value = 1
[driver]
kind = "boundary-integral"
viscosity = 1
flow = { kind = "quiescent" }
duration = 6
[output]
interval = 0.5
checkpoint_every = 5
files_every = 100000
pictures = false
"#;
    let out = folder.path().join("out");
    let summary = runs(text, folder.path(), &out, false, usize::MAX);
    assert_eq!(summary.end, End::Completed, "{}", summary.message);
    let broke = breaks(&summary);
    assert_eq!(broke.len(), 1, "{broke:?}");
    assert_eq!(broke[0].euler_number, [2, 4]);
    let volumes = column(&out, "volume");
    for &volume in &volumes {
        assert!((volume / volumes[0] - 1.0).abs() < 1e-11, "{volumes:?}");
    }
    continues(text, folder.path(), &out, 4);
}

/// Two drops that all but touch join, and surface tension makes one sphere of them, with the volume of both.
#[test]
fn two_drops_join() {
    let folder = TempDir::new().expect("a folder");
    let drop = icosphere(2);
    write(folder.path(), &drop.beside(&drop, [2.05, 0.0, 0.0]));
    let text = r#"
units = "none"
[[surface]]
mesh = "mesh.vtp"
remesh = "auto"
topology = "may-fuse"
tension.value = 1
[driver]
kind = "boundary-integral"
viscosity = 1
flow = { kind = "quiescent" }
duration = 12
[output]
interval = 0.5
checkpoint_every = 5
files_every = 100000
pictures = false
"#;
    let out = folder.path().join("out");
    let summary = runs(text, folder.path(), &out, false, usize::MAX);
    assert_eq!(summary.end, End::Completed, "{}", summary.message);
    let broke = breaks(&summary);
    assert_eq!(broke.len(), 1, "{broke:?}");
    assert_eq!(
        (broke[0].broke, broke[0].euler_number),
        (Some(Break::Film), [4, 2])
    );
    let volumes = column(&out, "volume");
    for &volume in &volumes {
        assert!((volume / volumes[0] - 1.0).abs() < 1e-11, "{volumes:?}");
    }
    let areas = column(&out, "area");
    assert!(
        areas.is_sorted_by(|before, after| before > after),
        "{areas:?}"
    );
    let reduced = *column(&out, "reduced_volume").last().expect("a row");
    assert!(reduced > 0.99, "{reduced}");
    continues(text, folder.path(), &out, 4);
}
