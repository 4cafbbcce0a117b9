//! Runs whose surfaces touch themselves.

use super::remeshing::runs;
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
