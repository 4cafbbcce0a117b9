//! Meshes to begin with.

use crate::Refusal;
use helfrich::Surface;
use helfrich_std::generate::random::Random;
use helfrich_std::generate::{AnyShape, Family, generate};
use helfrich_std::info::mean_edge;
use helfrich_std::io::MeshFile;

/// A mesh on an exact shape.
pub(crate) struct Example {
    /// Its name.
    pub(crate) name: &'static str,
    /// The shape, as the program names it.
    shape: &'static str,
    family: Family,
    /// Standard deviation of the coordinates, in mean edges.
    noise: f64,
}

pub(crate) const EXAMPLES: [Example; 6] = [
    Example {
        name: "discocyte",
        shape: "discocyte",
        family: Family::Relaxed,
        noise: 0.0,
    },
    Example {
        name: "discocyte with noise",
        shape: "discocyte",
        family: Family::Relaxed,
        noise: 0.02,
    },
    Example {
        name: "torus",
        shape: "torus",
        family: Family::Relaxed,
        noise: 0.0,
    },
    Example {
        name: "ellipsoid",
        shape: "ellipsoid",
        family: Family::Irregular,
        noise: 0.0,
    },
    Example {
        name: "sphere with noise",
        shape: "sphere",
        family: Family::Relaxed,
        noise: 0.05,
    },
    Example {
        name: "discocyte with bad triangles",
        shape: "discocyte",
        family: Family::Hard,
        noise: 0.0,
    },
];

/// The mesh of the example with this name.
pub(crate) fn example(name: &str, vertices: usize) -> Result<MeshFile, Refusal> {
    let names = EXAMPLES.map(|example| example.name).join(", ");
    let found = EXAMPLES.into_iter().find(|example| example.name == name);
    let found = found.ok_or_else(|| {
        Refusal::new(format_args!(
            "there is no example `{name}`: there are {names}"
        ))
    })?;
    let shape: AnyShape = found.shape.parse().map_err(Refusal::new)?;
    let made = generate(&shape, found.family, vertices, 1).map_err(Refusal::new)?;
    let mut positions = made.positions;
    if found.noise > 0.0 {
        let surface = Surface::new(&made.mesh, &positions).map_err(Refusal::new)?;
        let edge = mean_edge(surface.area(), made.mesh.triangles().len());
        let mut random = Random::new(1);
        // A sum of twelve uniform numbers is nearly normal.
        let mut normal = || (0..12).map(|_| random.unit()).sum::<f64>() - 6.0;
        for x in positions.as_flattened_mut() {
            *x += found.noise * edge * normal();
        }
    }
    Ok(MeshFile::new(positions, made.mesh))
}
