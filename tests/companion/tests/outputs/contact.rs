//! Runs whose surfaces touch themselves, or pass obstacles.

use super::remeshing::{column, continues, runs};
use helfrich::{Surface, crossing_triangles};
use helfrich_std::io::read;
use helfrich_std::run::End;
use tempfile::TempDir;

/// The dimples of a flat vesicle of little volume meet: with contact between its parts they rest on each other, without it
/// they cross.
#[test]
fn dimples_rest_on_each_other() {
    for parts in [true, false] {
        let folder = TempDir::new().expect("a folder");
        let contact = if parts {
            "[[interaction]]\nkind = \"repulsion\"\nstrength = 30\ncutoff = 0.2\nparts = true\n"
        } else {
            ""
        };
        let text = format!(
            r#"
units = "none"
[[surface]]
shape = "ellipsoid:1.2,1.2,0.3"
vertices = 400
remesh = "auto"
bending = {{ method = "juelicher", modulus = 1 }}
area.constraint = "exact"
volume = {{ constraint = "exact", reduced = 0.45 }}
{contact}[driver]
kind = "relax"
iterations = 600
residual = 1e-3
energy_error = 0.1
[output]
every = 100
files_every = 100000
pictures = false
"#
        );
        let out = folder.path().join("out");
        let summary = runs(&text, folder.path(), &out, false, usize::MAX);
        let last = read(&out.join("last.vtp")).expect("a mesh");
        let surface = Surface::new(&last.mesh, &last.positions).expect("finite");
        assert_eq!(crossing_triangles(surface).is_empty(), parts);
        assert_eq!(summary.end == End::Converged, parts, "{}", summary.message);
    }
}

/// A drop in shear flow gives way to an obstacle, on which the fluid does not slip, keeps its volume, and continues to the bit.
#[test]
fn a_drop_passes_an_obstacle() {
    let folder = TempDir::new().expect("a folder");
    let text = |obstacle: &str| {
        format!(
            r#"
units = "none"
[[surface]]
shape = "sphere:1"
vertices = 162
position = [-1.5, 0.8, 0]
remesh = "auto"
tension.value = 1
{obstacle}[driver]
kind = "boundary-integral"
viscosity = 1
flow = {{ kind = "shear", rate = 0.2 }}
strain = 2
[output]
interval = 1
checkpoint_every = 3
files_every = 100000
pictures = false
"#
        )
    };
    let obstacle =
        "[[obstacle]]\nshape = \"sphere:0.8\"\nvertices = 162\nposition = [1, -0.4, 0]\n";
    let reached = ["", obstacle].map(|obstacle| {
        let out = folder
            .path()
            .join(if obstacle.is_empty() { "free" } else { "out" });
        let summary = runs(&text(obstacle), folder.path(), &out, false, usize::MAX);
        assert_eq!(summary.end, End::Completed, "{}", summary.message);
        let volumes = column(&out, "volume");
        for volume in &volumes {
            assert!((volume / volumes[0] - 1.0).abs() < 1e-11, "{volumes:?}");
        }
        let last = read(&out.join("last.vtp")).expect("a mesh");
        let sum: f64 = last.positions.iter().map(|x| x[1]).sum();
        sum / last.positions.len() as f64
    });
    let [free, aside] = reached;
    assert!(aside > free + 0.05, "{aside} {free}");
    continues(
        &text(obstacle),
        folder.path(),
        &folder.path().join("out"),
        4,
    );
}
