//! Meshes on surfaces that are known exactly, as `proptest` strategies.

use crate::meshes::{Mesh, SplitMix64, icosphere, unit};
use crate::star::Star;
use helfrich::shapes::{ExactPoint, Shape};
use helfrich_std::generate::{AnyShape, Family, generate};
use proptest::prelude::{Strategy, prop_oneof};
use proptest::sample::select;

/// Mesh on an exact shape, described by a few readable numbers.
#[derive(Clone, Copy, Debug)]
pub struct OnShape {
    /// The shape.
    pub shape: AnyShape,
    /// The family of the mesh.
    pub family: Family,
    /// Number of vertices; on a torus within 1 % of it.
    pub vertices: usize,
    /// Seed of random families.
    pub seed: u64,
}

impl OnShape {
    /// The mesh, and the exact surface at each of its vertices.
    ///
    /// # Panics
    /// If there is no such mesh. The strategy [`on_shapes`] describes only meshes that exist.
    pub fn mesh(self) -> (Mesh, Vec<ExactPoint<f64>>) {
        let made = generate(&self.shape, self.family, self.vertices, self.seed);
        let made = made.expect("a mesh of the strategy's numbers");
        let exact = made.preimages.iter().map(|&at| self.shape.at(at));
        let exact = exact.collect();
        let mesh = Mesh {
            connectivity: made.mesh,
            positions: made.positions,
        };
        (mesh, exact)
    }
}

/// Shapes of every kind, with lengths of order 1.
pub fn shapes() -> impl Strategy<Value = AnyShape> {
    let read = |text: String| text.parse::<AnyShape>().expect("lengths within bounds");
    let length = || 0.5..2.0;
    prop_oneof![
        length().prop_map(|radius| format!("sphere:{radius}")),
        (length(), length(), length()).prop_map(|(a, b, c)| format!("ellipsoid:{a},{b},{c}")),
        (length(), 0.2..0.8).prop_map(|(radius, part)| format!("torus:{radius},{}", part * radius)),
        length().prop_map(|radius| format!("discocyte:{radius}")),
    ]
    .prop_map(read)
}

/// Meshes of every family on these shapes, with 200 to `most` vertices.
pub fn on_shapes(most: usize) -> impl Strategy<Value = OnShape> {
    let numbers = (200..=most, 0..1_000_000_u64);
    let strategy = (shapes(), select(Family::ALL.to_vec()), numbers);
    strategy.prop_map(|(shape, family, (vertices, seed))| OnShape {
        shape,
        family,
        vertices,
        seed,
    })
}

/// Mesh on a star-shaped surface with waves, described by a few readable numbers.
#[derive(Clone, Copy, Debug)]
pub struct OnStar {
    /// Seed of the directions of the waves.
    pub seed: u64,
    /// Number of waves.
    pub waves: usize,
    /// Amplitude of all waves together, below 1.
    pub amplitude: f64,
    /// Number of refinements of the icosahedron.
    pub refinement: u32,
}

impl OnStar {
    /// The surface: waves of degrees 2 and more in random directions.
    pub fn star(self) -> Star {
        let mut random = SplitMix64::new(self.seed);
        let term = |number| {
            let direction = [(); 3].map(|()| 1.0 + random.symmetric());
            (
                self.amplitude / self.waves as f64,
                2 + number,
                unit(direction),
            )
        };
        Star {
            terms: (0..self.waves).map(term).collect(),
        }
    }

    /// The mesh, and the exact surface at each of its vertices.
    pub fn mesh(self) -> (Mesh, Vec<ExactPoint<f64>>) {
        let (star, sphere) = (self.star(), icosphere(self.refinement));
        let exact = Vec::from_iter(sphere.positions.iter().map(|&at| star.at(at)));
        let mesh = Mesh {
            positions: exact.iter().map(|point| point.position).collect(),
            connectivity: sphere.connectivity,
        };
        (mesh, exact)
    }
}

/// Meshes of up to 642 vertices on star-shaped surfaces.
pub fn on_stars() -> impl Strategy<Value = OnStar> {
    let numbers = (0..1_000_000_u64, 1..4_usize, 0.0..0.4, 1..4_u32);
    numbers.prop_map(|(seed, waves, amplitude, refinement)| OnStar {
        seed,
        waves,
        amplitude,
        refinement,
    })
}
