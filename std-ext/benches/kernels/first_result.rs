//! The steps before the first evaluation: reading and building a mesh of a million vertices.

use crate::Error;
use helfrich::{Reordering, TriangleMesh};
use helfrich_std::io;
use std::time::Instant;

/// A torus of 1000 × 1000 vertices.
const AROUND: u32 = 1000;

fn torus() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let angle = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(AROUND);
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..AROUND {
        for j in 0..AROUND {
            let (u, v) = (angle(i), angle(j));
            let far = 2.0 + v.cos();
            positions.push([far * u.cos(), far * u.sin(), v.sin()]);
            let at = |i: u32, j: u32| i % AROUND * AROUND + j % AROUND;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    (positions, triangles)
}

/// The least of some times in seconds.
fn least<R>(mut run: impl FnMut() -> Result<R, Error>) -> Result<f64, Error> {
    let mut least = f64::INFINITY;
    for _ in 0..5 {
        let start = Instant::now();
        std::hint::black_box(run()?);
        least = least.min(start.elapsed().as_secs_f64());
    }
    Ok(least)
}

pub(crate) fn print() -> Result<(), Error> {
    let (positions, triangles) = torus();
    println!("\n{} vertices on one thread", positions.len());
    let mut made = Vec::new();
    for _ in 0..5 {
        let triangles = triangles.clone();
        let start = Instant::now();
        let mesh = TriangleMesh::new(positions.len(), triangles)?;
        made.push((start.elapsed().as_secs_f64(), mesh));
    }
    made.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (time, mesh) = made.swap_remove(0);
    println!("{:32}{time:>8.2} s", "TriangleMesh::new");
    let time = least(|| Ok(Reordering::reverse_cuthill_mckee(&mesh).of_mesh(&mesh)?))?;
    println!("{:32}{time:>8.2} s", "order, and mesh in it");
    for (name, format) in [("PLY", io::Format::Ply), ("OBJ", io::Format::Obj)] {
        let mut bytes = Vec::new();
        io::write_to(&mut bytes, format, &positions, &mesh)?;
        let parsed = least(|| Ok(io::parse(&bytes, format)?))?;
        let rate = bytes.len() as f64 / parsed / 1e6;
        println!(
            "{:32}{parsed:>8.2} s, {rate:.0} MB/s with the mesh made",
            format!("read {name}, {:.0} MB", bytes.len() as f64 / 1e6)
        );
    }
    Ok(())
}
