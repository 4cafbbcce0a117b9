//! Meshes as `proptest` strategies.

use super::{Mesh, SplitMix64, disc, hemisphere, icosphere, torus, unit};
use proptest::prelude::{ProptestConfig, Strategy, prop_oneof};
use proptest::test_runner::FileFailurePersistence;
use proptest::test_runner::RngSeed;

/// Mesh with random displacements, described by numbers that shrink towards a smooth and coarse mesh.
#[derive(Clone, Copy, Debug)]
pub struct Rough {
    /// The polyhedron from which the mesh is made.
    pub base: Base,
    /// Seed of the displacements.
    pub seed: u64,
    /// Largest displacement, in mean edge lengths.
    pub amplitude: f64,
    /// Number of refinements of the polyhedron.
    pub refinement: u32,
}

/// A polyhedron from which a [`Rough`] mesh is made.
#[derive(Clone, Copy, Debug)]
pub enum Base {
    /// Closed, χ = 2.
    Icosphere,
    /// Closed, χ = 0.
    Torus,
    /// With boundary, χ = 1.
    Hemisphere,
    /// Flat, with boundary, χ = 1.
    Disc,
}

impl Rough {
    /// The mesh. It is bent, so that forces do not vanish even if it shrinks to a mesh without
    /// displacements; then every coordinate of every vertex is displaced at random.
    pub fn mesh(self) -> Mesh {
        let smooth = match self.base {
            Base::Icosphere => icosphere(self.refinement),
            Base::Torus => torus(6 << self.refinement, 4 << self.refinement),
            Base::Hemisphere => hemisphere(self.refinement + 1),
            Base::Disc => disc(2 << self.refinement),
        };
        let smooth = smooth.map(bent);
        let mut random = SplitMix64::new(self.seed);
        let reach = self.amplitude * smooth.edge_length();
        let displaced = |x: &[f64; 3]| x.map(|coordinate| coordinate + reach * random.symmetric());
        Mesh {
            positions: smooth.positions.iter().map(displaced).collect(),
            connectivity: smooth.connectivity,
        }
    }
}

/// A smooth map without symmetry.
pub fn bent([x, y, z]: [f64; 3]) -> [f64; 3] {
    [
        x + 0.2 * y * z,
        0.8 * y + 0.1 * x * x,
        0.7 * z + 0.3 * x * y + 0.2 * x * x,
    ]
}

fn rough(base: impl Strategy<Value = Base>) -> impl Strategy<Value = Rough> {
    let numbers = (0..1_000_000_u64, 0.0..0.2, 0..3_u32);
    (base, numbers).prop_map(|(base, (seed, amplitude, refinement))| Rough {
        base,
        seed,
        amplitude,
        refinement,
    })
}

fn one_of(bases: &'static [Base]) -> impl Strategy<Value = Base> {
    (0..bases.len()).prop_map(|index| bases[index])
}

/// Configuration of `count` cases, the same in every run, so that a change fails by its own fault only; or
/// of other cases in every run with `PROPTEST_CASES`, which gives their number. Failures are stored next to
/// the source of the test.
pub fn cases(count: u32) -> ProptestConfig {
    let given = ProptestConfig::default();
    let (cases, rng_seed) = match std::env::var_os("PROPTEST_CASES") {
        Some(_) => (given.cases, given.rng_seed),
        None => (count, RngSeed::Fixed(1)),
    };
    ProptestConfig {
        cases,
        rng_seed,
        max_shrink_iters: 200,
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("regressions"))),
        ..given
    }
}

/// Rough closed meshes.
pub fn rough_closed() -> impl Strategy<Value = Rough> {
    rough(one_of(&[Base::Icosphere, Base::Torus]))
}

/// Rough meshes, closed and with boundary.
pub fn rough_any() -> impl Strategy<Value = Rough> {
    prop_oneof![
        rough_closed(),
        rough(one_of(&[Base::Hemisphere, Base::Disc]))
    ]
}

/// A mesh whose vertices all lie on a sphere about the origin, with slivers and obtuse fans.
#[derive(Clone, Copy, Debug)]
pub struct Inscribed {
    /// Seed of the displacements along the sphere.
    pub seed: u64,
    /// Largest displacement, in mean edge lengths: from about 0.4 on, areas become negative.
    pub amplitude: f64,
    /// Number of subdivisions of the icosahedron.
    pub refinement: u32,
    /// The sphere's radius is ten to this power.
    pub exponent: i32,
}

impl Inscribed {
    /// The sphere's radius R.
    pub fn radius(self) -> f64 {
        10.0_f64.powi(self.exponent)
    }

    /// The mesh.
    pub fn mesh(self) -> Mesh {
        let smooth = icosphere(self.refinement);
        let mut random = SplitMix64::new(self.seed);
        let reach = self.amplitude * smooth.edge_length();
        let displaced = |x: &[f64; 3]| {
            let jittered = x.map(|coordinate| coordinate + reach * random.symmetric());
            unit(jittered).map(|coordinate| self.radius() * coordinate)
        };
        Mesh {
            positions: smooth.positions.iter().map(displaced).collect(),
            connectivity: smooth.connectivity,
        }
    }
}

/// Meshes inscribed in spheres.
pub fn inscribed() -> impl Strategy<Value = Inscribed> {
    let numbers = (0..1_000_000_u64, 0.0..0.9, 0..4_u32, -12..=12_i32);
    numbers.prop_map(|(seed, amplitude, refinement, exponent)| Inscribed {
        seed,
        amplitude,
        refinement,
        exponent,
    })
}
