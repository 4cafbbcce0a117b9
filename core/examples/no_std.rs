//! The library without std, as firmware or a kernel would use it: `core` and `alloc` only, f32, no
//! allocation after the first evaluation. `tests/no-std` is a program that proves it: it has no std to
//! link to.
//!
//! ```console
//! cargo run --release --example no_std --no-default-features
//! ```
#![no_std]
#![expect(clippy::print_stdout, reason = "an example shows what it does")]

extern crate alloc;
// For `main` alone, which has somewhere to print to.
extern crate std;

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;
use helfrich::{GompperKroll, MeshError, Prepared, Surface, SurfaceError, TriangleMesh};

/// A membrane that is kept between calls, with all the memory that it will ever need.
struct Membrane {
    mesh: TriangleMesh,
    bending: Prepared<f32, GompperKroll<f32>>,
    force: Vec<[f32; 3]>,
}

impl Membrane {
    fn new(vertices: usize, triangles: Vec<[u32; 3]>, modulus: f32) -> Result<Self, MeshError> {
        let mesh = TriangleMesh::new(vertices, triangles)?;
        let bending = Prepared::new(GompperKroll::new(modulus), &mesh);
        Ok(Self {
            mesh,
            bending,
            force: vec![[0.0; 3]; vertices],
        })
    }

    /// The energy, and the forces on the vertices.
    fn evaluate(&mut self, points: &[[f32; 3]]) -> Result<(f32, &[[f32; 3]]), SurfaceError> {
        self.force.fill([0.0; 3]);
        let surface = Surface::new(&self.mesh, points)?;
        let energy = self.bending.add_force_and_energy(surface, &mut self.force);
        Ok((energy, &self.force))
    }
}

fn main() -> Result<(), Box<dyn core::error::Error>> {
    // An octahedron in a sphere of radius 2.
    let points = [
        [2.0, 0.0, 0.0],
        [0.0, 2.0, 0.0],
        [0.0, 0.0, 2.0],
        [-2.0, 0.0, 0.0],
        [0.0, -2.0, 0.0],
        [0.0, 0.0, -2.0],
    ];
    let triangles = vec![
        [0, 1, 2],
        [1, 3, 2],
        [3, 4, 2],
        [4, 0, 2],
        [1, 0, 5],
        [3, 1, 5],
        [4, 3, 5],
        [0, 4, 5],
    ];
    let mut membrane = Membrane::new(points.len(), triangles, 1.0)?;
    let (energy, force) = membrane.evaluate(&points)?;
    std::println!("energy {energy}, force on the first vertex {:?}", force[0]);
    // In a sphere H = 1/R on any mesh, so that the energy is 2κA/R²; and A = 4√3 R².
    let expected = 8.0 * 3.0_f32.sqrt();
    assert!((energy / expected - 1.0).abs() < 1e-5);
    // By symmetry forces are along the axes; the energy has no scale, so that they do not push outwards.
    assert!(
        force
            .iter()
            .flatten()
            .all(|component| component.abs() < 1e-4)
    );
    Ok(())
}
