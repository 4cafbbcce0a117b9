//! Method `jet` removes the noise of a mesh file once, at the start.

use helfrich::Surface;
use helfrich::shapes::Shape;
use helfrich_std::generate::random::Random;
use helfrich_std::generate::{Family, GeneratedMesh, generate};
use helfrich_std::io::write;
use helfrich_std::method::{BendingMethod, Evaluator};
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_std::simulation::{Simulation, build};
use tempfile::TempDir;

type Points = Vec<[f64; 3]>;

/// A mesh with errors of 1e-3 in every coordinate, a hundredth of an edge length, and the exact mesh.
struct Files {
    folder: TempDir,
    made: GeneratedMesh,
    noisy: Points,
}

impl Files {
    fn new() -> Self {
        let shape = "ellipsoid:1,0.8,0.6".parse().unwrap();
        let made = generate(&shape, Family::Smooth, 1280, 1).unwrap();
        let mut random = Random::new(5);
        // The sum of twelve uniform numbers is sufficiently normal.
        let mut error = || 1e-3 * ((0..12).map(|_| random.unit()).sum::<f64>() - 6.0);
        let noisy = Vec::from_iter(made.positions.iter().map(|x| x.map(|x| x + error())));
        let folder = TempDir::new().unwrap();
        for (name, positions) in [("noisy.vtp", &noisy), ("exact.vtp", &made.positions)] {
            write(&folder.path().join(name), positions, &made.mesh).unwrap();
        }
        Self {
            folder,
            made,
            noisy,
        }
    }

    fn built(&self, surfaces: &str) -> (Simulation, Points) {
        let text = format!("units = \"none\"\n[driver]\nkind = \"relax\"\n{surfaces}");
        let path = self.folder.path().join("scene.toml");
        let file = SceneFile::parse(&text, &path, &Overrides::default()).unwrap();
        build(&file).unwrap()
    }

    /// Root mean square errors of H and f by jets of degree 6 at these positions, relative to those of the
    /// exact fields.
    fn errors(&self, positions: &[[f64; 3]]) -> [f64; 2] {
        let surface = Surface::new(&self.made.mesh, positions).unwrap();
        let fields = Evaluator::new(BendingMethod::J6, 1.0, &self.made.mesh).fields(surface);
        let mut sums = [[0.0_f64; 2]; 2];
        for (vertex, &preimage) in self.made.preimages.iter().enumerate() {
            let exact = self.made.shape.at(preimage);
            let force = fields.force_density[vertex].unwrap();
            let along = (0..3).map(|axis| force[axis] * exact.normal[axis]);
            let found = [fields.mean[vertex].unwrap(), along.sum()];
            for (sums, (found, exact)) in sums.iter_mut().zip(
                found
                    .into_iter()
                    .zip([exact.mean, exact.force_density(1.0)]),
            ) {
                sums[0] += (found - exact).powi(2);
                sums[1] += exact * exact;
            }
        }
        sums.map(|[error, all]| (error / all).sqrt())
    }
}

fn surface(mesh: &str, method: &str, more: &str) -> String {
    format!(
        "[[surface]]\nmesh = \"{mesh}\"\nbending = {{ method = \"{method}\", modulus = 1 }}\n{more}\n"
    )
}

/// Independent noise of standard deviation σ changes H by a few σ/A and f by 10 σ/A², where A is the area of
/// a vertex. Wide fits leave a fifth of the error of H and a twentieth of that of f, which falls with a
/// higher power of the width. The adaptive jet, which does not move positions, leaves as much.
#[test]
fn noise_is_taken_out_at_the_start() {
    let files = Files::new();
    let (simulation, positions) = files.built(&surface("noisy.vtp", "jet", ""));
    let [before, after] = [&files.noisy, &positions].map(|positions| files.errors(positions));
    assert!(after[0] < 0.2 * before[0], "{before:?} {after:?}");
    assert!(after[1] < 0.05 * before[1], "{before:?} {after:?}");
    let warnings = Vec::from_iter(simulation.warnings().iter().map(ToString::to_string));
    let [warning] = &warnings[..] else {
        panic!("{warnings:?}");
    };
    for part in [
        "scene.toml:6:",
        "\"surface-1\" is noisy",
        "σ = 0.00",
        "4 times onto fits of degree ",
        " neighbours, by 0.00",
        "choose j6 or j4",
    ] {
        assert!(warning.contains(part), "{part}: {warning}");
    }
}

/// Noise is removed before scaling, rotation and translation.
#[test]
fn it_is_taken_out_of_the_file() {
    let files = Files::new();
    let (_, plain) = files.built(&surface("noisy.vtp", "jet", ""));
    let placed = "scale = 2\nposition = [1, 2, 3]\norientation = { axis = [0, 0, 1], angle = 90 }";
    // A second surface from the same file is measured with the first, and the warning names it, too.
    let both = surface("noisy.vtp", "jet", placed) + &surface("noisy.vtp", "jet", "");
    let (simulation, positions) = files.built(&both);
    let (first, second) = positions.split_at(plain.len());
    assert_eq!(second, plain);
    for (&[x, y, z], here) in plain.iter().zip(first) {
        let there = [1.0 - 2.0 * y, 2.0 + 2.0 * x, 3.0 + 2.0 * z];
        // The bound is a few roundings of numbers up to 5.
        assert!((0..3).all(|axis| (here[axis] - there[axis]).abs() < 1e-14));
    }
    let noisy = |warning: &&String| warning.contains("is noisy");
    let warnings = Vec::from_iter(simulation.warnings().iter().map(ToString::to_string));
    let noisy = Vec::from_iter(warnings.iter().filter(noisy));
    let [warning] = noisy[..] else {
        panic!("{noisy:?}");
    };
    assert!(warning.contains("(and so for \"surface-2\")"), "{warning}");
}

/// Elastic membranes are stress-free at the positions without noise.
#[test]
fn references_have_none_either() {
    let files = Files::new();
    let elastic = "elasticity = { law = \"neo-hookean\", shear_modulus = 1 }";
    let (mut simulation, positions) = files.built(&surface("noisy.vtp", "jet", elastic));
    let acting = simulation.resolve(&positions);
    let of_elasticity = acting
        .iter()
        .find(|acting| acting.effect == "elasticity")
        .unwrap();
    // The bound is the squared rounding of strains.
    assert!(of_elasticity.energy.abs() < 1e-20);
}

/// Exact meshes, other methods and generated meshes keep their positions to the last bit.
#[test]
fn everything_else_starts_as_it_is() {
    let files = Files::new();
    for (mesh, method, positions) in [
        ("exact.vtp", "jet", &files.made.positions),
        ("noisy.vtp", "j6", &files.noisy),
        ("noisy.vtp", "B", &files.noisy),
    ] {
        let (simulation, built) = files.built(&surface(mesh, method, ""));
        assert_eq!(&built, positions, "{mesh}, {method}");
        assert!(simulation.warnings().is_empty(), "{mesh}, {method}");
    }
    // The errors of this generated mesh resemble noise.
    let coarse = "[[surface]]\nshape = \"discocyte\"\nfamily = \"irregular\"\nvertices = 642\n\
                  bending = { method = \"jet\", modulus = 1 }\n";
    let (_, built) = files.built(coarse);
    let made = generate(&"discocyte".parse().unwrap(), Family::Irregular, 642, 1).unwrap();
    assert_eq!(built, made.positions);
}
