//! Mesh files that tests make for themselves.

use crate::text;
use helfrich_std::generate::random::Random;
use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

/// A folder with a file in it.
pub(crate) struct Fixture {
    folder: TempDir,
    path: PathBuf,
}

impl Fixture {
    pub(crate) fn new(name: &str, content: impl AsRef<[u8]>) -> Self {
        let folder = TempDir::new().unwrap();
        let path = folder.path().join(name);
        fs::write(&path, content).unwrap();
        Self { folder, path }
    }

    pub(crate) fn path(&self) -> &str {
        text(&self.path)
    }

    pub(crate) fn beside(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The names in the folder.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let name = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name();
        let mut names = Vec::from_iter(entries.map(|e| name(e).into_string().unwrap()));
        names.sort();
        names
    }
}

pub(crate) fn obj(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> String {
    let mut text = String::new();
    for [x, y, z] in positions {
        writeln!(text, "v {x:?} {y:?} {z:?}").unwrap();
    }
    for [a, b, c] in triangles {
        writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
    }
    text
}

/// Each coordinate with an error of this standard deviation: the sum of twelve uniform ones.
pub(crate) fn disturbed(positions: &[[f64; 3]], deviation: f64) -> Vec<[f64; 3]> {
    let mut random = Random::new(5);
    let mut error = || (0..12).map(|_| random.unit()).sum::<f64>() - 6.0;
    let moved = positions.iter().map(|x| x.map(|x| x + deviation * error()));
    moved.collect()
}

pub(crate) fn off(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> String {
    let mut text = format!("OFF\n{} {} 0\n", positions.len(), triangles.len());
    for [x, y, z] in positions {
        writeln!(text, "{x:?} {y:?} {z:?}").unwrap();
    }
    for [a, b, c] in triangles {
        writeln!(text, "3 {a} {b} {c}").unwrap();
    }
    text
}

pub(crate) fn ply(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> String {
    let header = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\n\
         property double z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        positions.len(),
        triangles.len()
    );
    let body = off(positions, triangles);
    header + body.splitn(3, '\n').nth(2).unwrap()
}

pub(crate) fn stl(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> String {
    let mut text = "solid\n".to_owned();
    for triangle in triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        for &vertex in triangle {
            let [x, y, z] = positions[vertex as usize];
            writeln!(text, "vertex {x:?} {y:?} {z:?}").unwrap();
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid\n"
}

/// A sheet of 5 × 5 vertices with a bump, and a vertex that no triangle uses.
pub(crate) fn sheet() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for row in 0..5u32 {
        for column in 0..5u32 {
            let [x, y] = [column, row].map(f64::from);
            positions.push([x, y, 0.1 * x * x + 0.05 * x * y]);
            if row < 4 && column < 4 {
                let corner = 5 * row + column;
                triangles.push([corner, corner + 1, corner + 6]);
                triangles.push([corner, corner + 6, corner + 5]);
            }
        }
    }
    positions.push([9.0; 3]);
    (positions, triangles)
}
