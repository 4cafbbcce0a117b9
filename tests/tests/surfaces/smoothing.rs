//! Smoother positions: fits take noise and leave the shape, mean-curvature flow follows its theory, volumes are kept.

use crate::noise::{disturbed, mean_edge, mesh};
use helfrich::functional::EnclosedVolume;
use helfrich::shapes::Shape;
use helfrich::{Smoothing, Surface, Targets, TriangleMesh, VertexKind};
use helfrich_std::execute::with_threads;
use helfrich_std::generate::{Family, GeneratedMesh};
use helfrich_std::held::keep_volumes;
use helfrich_std::noise::NotQuieted;
use helfrich_std::smoothing::{Smoothed, Smoother, SmoothingError, implicit_step, smooth};
use std::num::NonZeroUsize;

type Points = Vec<[f64; 3]>;

fn surface<'a>(mesh: &'a TriangleMesh, positions: &'a [[f64; 3]]) -> Surface<'a, f64> {
    Surface::new(mesh, positions).expect("positions")
}

fn smoothed(mesh: &TriangleMesh, positions: &[[f64; 3]], smoother: Smoother) -> Smoothed {
    smooth(surface(mesh, positions), smoother, &mut |_| true).expect("smoother positions")
}

fn norm(x: [f64; 3]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Root mean square of some numbers.
fn mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let values = Vec::from_iter(values);
    let count = values.len() as f64;
    (values.iter().map(|x| x * x).sum::<f64>() / count).sqrt()
}

/// The distances of vertices from the exact surface, to first order: along the normals at their preimages.
fn distances<'a>(
    made: &'a GeneratedMesh,
    positions: &'a [[f64; 3]],
) -> impl Iterator<Item = f64> + 'a {
    positions.iter().zip(&made.preimages).map(|(x, &at)| {
        let exact = made.shape.at(at);
        (0..3)
            .map(|axis| (x[axis] - exact.position[axis]) * exact.normal[axis])
            .sum()
    })
}

/// The volume of each component.
fn volumes(mesh: &TriangleMesh, positions: &[[f64; 3]]) -> Vec<f64> {
    match Targets::measured(&EnclosedVolume, surface(mesh, positions)) {
        Targets::PerComponent(volumes) => volumes,
        Targets::Same(volume) => vec![volume],
    }
}

/// Some meshes beside each other, a distance of 4 apart.
fn beside(meshes: &[GeneratedMesh]) -> (TriangleMesh, Points) {
    let (mut positions, mut triangles) = (Points::new(), Vec::new());
    for (place, made) in meshes.iter().enumerate() {
        let first = positions.len() as u32;
        let corners = made.mesh.triangles().iter();
        triangles.extend(corners.map(|corners| corners.map(|corner| first + corner)));
        let away = 4.0 * place as f64;
        positions.extend(made.positions.iter().map(|&[x, y, z]| [x + away, y, z]));
    }
    (
        TriangleMesh::new(positions.len(), triangles).expect("a mesh"),
        positions,
    )
}

/// The part of a mesh whose triangles have all corners above a height, with the numbers of its vertices.
fn above(made: &GeneratedMesh, height: f64) -> (TriangleMesh, Vec<usize>) {
    let is_above = |&&corners: &&[u32; 3]| {
        corners
            .iter()
            .all(|&corner| made.positions[corner as usize][2] > height)
    };
    let kept = Vec::from_iter(made.mesh.triangles().iter().filter(is_above));
    let mut vertices = Vec::from_iter(
        kept.iter()
            .copied()
            .flatten()
            .map(|&corner| corner as usize),
    );
    vertices.sort_unstable();
    vertices.dedup();
    let number = |&corner: &u32| {
        vertices
            .binary_search(&(corner as usize))
            .expect("a vertex") as u32
    };
    let triangles = kept
        .iter()
        .map(|corners| [0, 1, 2].map(|at| number(&corners[at])));
    let mesh = TriangleMesh::new(vertices.len(), triangles.collect()).expect("a mesh");
    (mesh, vertices)
}

/// P₀ … P_l at z, by Bonnet's recursion.
fn legendre(degree: usize, z: f64) -> f64 {
    let (mut before, mut here) = (0.0, 1.0);
    for l in 0..degree {
        let l = l as f64;
        (before, here) = (here, ((2.0 * l + 1.0) * z * here - l * before) / (l + 1.0));
    }
    here
}

/// One implicit step takes the radius R to R/(1 + 2 t/R²), because −Δx = 2 x/R², for any t. The error of the cotangents is
/// of second order in the edges, 0.07 R and 0.035 R.
#[test]
fn a_sphere_shrinks_by_the_theory_of_one_step() {
    let radius = 2.0;
    for time in [0.01, 1.0, 1e4] {
        let off = [642, 2562].map(|vertices| {
            let made = mesh("sphere", Family::Regular, vertices).expect("a mesh");
            let positions = Points::from_iter(made.positions.iter().map(|x| x.map(|x| radius * x)));
            let moved = implicit_step(surface(&made.mesh, &positions), time).expect("a step");
            let expected = radius / (1.0 + 2.0 * time / (radius * radius));
            mean_square(moved.iter().map(|&x| norm(x) / expected - 1.0))
        });
        assert!(off[1] < 5e-3 && off[0] > 3.0 * off[1], "{time}: {off:?}");
    }
}

/// A wave x₀ = (1 + ε P_l) n of the unit sphere. To first order in ε, areas are those of the sphere times 1 + 2 ε P_l and
/// the stiffness is that of the sphere, because in two dimensions it does not change with conformal factors. The step
/// `(1 − t Δ + 2 ε P_l) x = (1 + 3 ε P_l) n` then has the solution `x = n/(1 + 2 t) + ε w`, `w = (1 + 6 t)/(1 + 2 t)
/// (1 − t Δ)⁻¹ P_l n`. P_l n consists of harmonics of the degrees l + 1 and l − 1, with the parts (l + 1)/(2 l + 1) and
/// l/(2 l + 1) of its radial component. For short times the wave falls by 1 − t (l (l + 1) − 2), as in mean-curvature flow.
///
/// Errors of cotangents are of second order in edges of 0.07 radians: (0.07 l)²/12 of the exponent at most.
#[test]
fn waves_on_a_sphere_decay_by_the_theory_of_one_step() {
    let made = mesh("sphere", Family::Regular, 2562).expect("a mesh");
    let size = 1e-5;
    let step = |degree: usize, size: f64, time: f64| {
        let waved = made.positions.iter();
        let waved = waved.map(|x| x.map(|part| (1.0 + size * legendre(degree, x[2])) * part));
        implicit_step(surface(&made.mesh, &Points::from_iter(waved)), time).expect("a step")
    };
    for degree in [2, 3, 6] {
        for time in [0.001, 0.05, 1.0] {
            let [waved, plain] = [size, 0.0].map(|size| step(degree, size, time));
            let l = degree as f64;
            let part = |l: f64| 1.0 / (1.0 + time * l * (l + 1.0));
            let mix = ((l + 1.0) * part(l + 1.0) + l * part(l - 1.0)) / (2.0 * l + 1.0);
            let expected = (1.0 + 6.0 * time) / (1.0 + 2.0 * time) * mix;
            let exact = made.positions.iter();
            let off = exact.zip(waved.iter().zip(&plain)).map(|(n, (x, y))| {
                let radial = (0..3)
                    .map(|axis| (x[axis] - y[axis]) * n[axis])
                    .sum::<f64>();
                radial / size - expected * legendre(degree, n[2])
            });
            let all = mean_square(made.positions.iter().map(|n| legendre(degree, n[2])));
            let off = mean_square(off) / (expected * all);
            assert!(off < 0.02, "{degree}, {time}: {off}");
        }
    }
}

/// With a plane outline, the limit of long times is the plane: −Δz = 0 between fixed heights of 0. Vertices of the outline
/// keep their bits.
#[test]
fn borders_stay_and_long_flow_ends_at_the_smallest_surface() {
    let made = mesh("sphere", Family::Irregular, 642).expect("a mesh");
    let (cap, vertices) = above(&made, 0.3);
    let mut positions = Points::from_iter(vertices.iter().map(|&vertex| made.positions[vertex]));
    for (vertex, at) in positions.iter_mut().enumerate() {
        if cap.vertex_kind(vertex) == VertexKind::Boundary {
            at[2] = 0.0;
        }
    }
    let moved = implicit_step(surface(&cap, &positions), 1e8).expect("a step");
    for (vertex, (from, to)) in positions.iter().zip(&moved).enumerate() {
        if cap.vertex_kind(vertex) == VertexKind::Boundary {
            assert_eq!(from, to);
        }
        // The time in units of the squared radius, with a factor for the mean area, and rounding times the time.
        assert!(to[2].abs() < 1e-6, "{vertex}: {to:?}");
    }
}

/// Each component has its own volume, whatever the others do. Newton's steps end at the rounding of positions up to 5, whose
/// sum over the area is 20 times that of the volume.
#[test]
fn every_component_keeps_its_volume() {
    let shapes = ["ellipsoid:1,0.8,0.5", "torus", "sphere"];
    let made = shapes.map(|shape| mesh(shape, Family::Irregular, 1280).expect("a mesh"));
    let (both, exact) = beside(&made);
    let noisy = disturbed(&exact, 1e-2 * mean_edge(&made[0]));
    let before = volumes(&both, &noisy);
    let smoother = [
        Smoother::Noise,
        Smoother::Scale(Smoothing::of_neighbours(256)),
        Smoother::Flow(1e-4),
        Smoother::Flow(1.0),
        Smoother::Flow(1e3),
    ];
    for smoother in smoother {
        let found = smoothed(&both, &noisy, smoother);
        assert!(
            found.unmoved.is_none() && found.displacements[0] > 0.0,
            "{smoother:?}"
        );
        let after = volumes(&both, &found.positions);
        for (before, after) in before.iter().zip(after) {
            assert!(
                (after / before - 1.0).abs() < 1e-12,
                "{smoother:?}: {before} {after}"
            );
        }
    }
    // An ellipsoid that is inside out has a negative volume, and is kept, too; a cap has none.
    let turned = made[0].mesh.triangles().iter().map(|&[a, b, c]| [a, c, b]);
    let turned = TriangleMesh::new(made[0].positions.len(), turned.collect()).expect("a mesh");
    let found = smoothed(&turned, &made[0].positions, Smoother::Flow(0.1));
    let [before, after] = found.volumes.expect("a volume");
    assert!(
        before < 0.0 && (after / before - 1.0).abs() < 1e-12,
        "{before} {after}"
    );
    let (cap, vertices) = above(&made[0], 0.0);
    let open = Points::from_iter(vertices.iter().map(|&vertex| made[0].positions[vertex]));
    let mut kept = open.clone();
    keep_volumes(surface(&cap, &open), &mut kept).expect("no volume to keep");
    assert_eq!(kept, open);
}

/// A sphere that was scaled by a factor is a sphere of the old radius again, after one step, however small it was.
#[test]
fn volumes_are_kept_along_the_normals() {
    let made = mesh("sphere", Family::Irregular, 642).expect("a mesh");
    let before = surface(&made.mesh, &made.positions);
    for factor in [1e-5, 0.5, 0.999, 1.001, 100.0] {
        let mut scaled = Points::from_iter(made.positions.iter().map(|x| x.map(|x| factor * x)));
        keep_volumes(before, &mut scaled).expect("a volume");
        // Normals of triangles around a vertex are off those of the sphere by less than an edge of 0.14.
        for (from, to) in made.positions.iter().zip(&scaled) {
            let off = norm([0, 1, 2].map(|axis| to[axis] - from[axis]));
            assert!(off < 0.14 * (1.0 - factor).abs(), "{factor}: {off}");
        }
    }
    // Nothing gives the volume of a flat surface back.
    let mut flat = Points::from_iter(made.positions.iter().map(|_| [0.0; 3]));
    let error = keep_volumes(before, &mut flat).expect_err("no volume");
    assert!((error.target - before.volume().expect("closed")).abs() < 1e-12 * error.target);
}

/// The rest of a sphere after a long time is small, but not lost: it is a sphere as before, also far from the origin, as
/// far as positions are not rounded there. Beyond that the volume cannot be kept.
#[test]
fn long_times_keep_the_shape_or_are_refused() {
    let made = mesh("sphere", Family::Regular, 642).expect("a mesh");
    let at =
        |away: f64| Points::from_iter(made.positions.iter().map(|&[x, y, z]| [x + away, y, z]));
    for (away, time) in [(0.0, 1e6), (0.0, 1e12), (1e3, 1e3)] {
        let found = smoothed(&made.mesh, &at(away), Smoother::Flow(time));
        // Cotangents shrink waves of the mesh a little more than the sphere, by the squared edge of 0.14 over 12.
        let off = found
            .positions
            .iter()
            .map(|&[x, y, z]| norm([x - away, y, z]) - 1.0);
        let off = mean_square(off);
        assert!(off < 2e-3, "{away}, {time}: {off}");
        let [before, after] = found.volumes.expect("a volume");
        // The rounding of positions at a distance of 1000, summed over the surface.
        assert!((after / before - 1.0).abs() < 1e-11, "{away}, {time}");
    }
    for (away, time) in [(1e3, 1e9), (0.0, 1e300)] {
        let positions = at(away);
        let error = smooth(
            surface(&made.mesh, &positions),
            Smoother::Flow(time),
            &mut |_| true,
        );
        let error = error.expect_err("nothing is left");
        assert!(
            matches!(
                error,
                SmoothingError::Volume(_) | SmoothingError::TooLong { .. }
            ),
            "{away}, {time}: {error}"
        );
    }
}

/// Fits of degree 4 to 49 neighbours leave 0.6 of independent noise (see above in `noise`), those to 90 therefore 0.6
/// √(49/90) = 0.44, wider fits less, and repeated moves less than one; errors of the fitted shape add to it.
#[test]
fn vertices_come_nearer_to_the_exact_surface() {
    for shape in ["discocyte", "ellipsoid:1,0.8,0.5", "torus"] {
        for family in [Family::Irregular, Family::Hard] {
            let made = mesh(shape, family, 2562).expect("a mesh");
            let noisy = disturbed(&made.positions, 1e-2 * mean_edge(&made));
            let found = smoothed(&made.mesh, &noisy, Smoother::Noise);
            let [before, after] = [&noisy, &found.positions]
                .map(|positions| mean_square(distances(&made, positions)));
            assert!(after < 0.5 * before, "{shape}, {family}: {before} {after}");
            let moved = noisy.iter().zip(&found.positions);
            let moved = moved.map(|(from, to)| norm([0, 1, 2].map(|axis| to[axis] - from[axis])));
            let moved = Vec::from_iter(moved);
            let largest = moved.iter().copied().fold(0.0, f64::max);
            let expected = [mean_square(moved.into_iter()), largest];
            for (found, expected) in found.displacements.iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 1e-12);
            }
        }
    }
}

/// One-sided fits leave more of the noise, and move vertices along their normals only: to the outline, at right angles to
/// the surface, tangential movements would be as large as the others.
#[test]
fn borders_lose_noise_and_do_not_shrink() {
    let made = mesh("ellipsoid:1,0.8,0.5", Family::Irregular, 2562).expect("a mesh");
    let (cap, vertices) = above(&made, 0.0);
    let noisy = disturbed(&made.positions, 1e-2 * mean_edge(&made));
    let noisy = Points::from_iter(vertices.iter().map(|&vertex| noisy[vertex]));
    let found = smoothed(&cap, &noisy, Smoother::Noise).positions;
    let on_border = |&vertex: &usize| cap.vertex_kind(vertex) == VertexKind::Boundary;
    let border = Vec::from_iter((0..vertices.len()).filter(on_border));
    assert!(border.len() > 50);
    // The parts of a vector along the exact normal, and along the surface.
    let parts = |vertex: usize, [from, to]: [[f64; 3]; 2]| {
        let normal = made.shape.at(made.preimages[vertices[vertex]]).normal;
        let vector = [0, 1, 2].map(|axis| to[axis] - from[axis]);
        let along = (0..3).map(|axis| vector[axis] * normal[axis]).sum::<f64>();
        [
            along,
            norm([0, 1, 2].map(|axis| vector[axis] - along * normal[axis])),
        ]
    };
    let exact = |vertex: usize| made.positions[vertices[vertex]];
    let off = |positions: &Points| {
        mean_square(
            border
                .iter()
                .map(|&vertex| parts(vertex, [exact(vertex), positions[vertex]])[0]),
        )
    };
    assert!(
        off(&found) < 0.7 * off(&noisy),
        "{} {}",
        off(&found),
        off(&noisy)
    );
    let moved = |part: usize| {
        mean_square(
            border
                .iter()
                .map(|&vertex| parts(vertex, [noisy[vertex], found[vertex]])[part]),
        )
    };
    // Fitted normals are off by the noise over an edge, 0.01, and as much as one-sided fits amplify it.
    assert!(moved(1) < 0.1 * moved(0), "{} {}", moved(1), moved(0));
}

/// Nothing is moved where nothing is to be gained.
#[test]
fn meshes_without_noise_keep_their_bits() {
    let made = mesh("torus", Family::Irregular, 642).expect("a mesh");
    let found = smoothed(&made.mesh, &made.positions, Smoother::Noise);
    assert_eq!(found.unmoved, Some(NotQuieted::NoNoise));
    assert_eq!(found.positions, made.positions);
    assert_eq!((found.fits, found.displacements), (None, [0.0; 2]));
}

/// Noise of a fifth of an edge is found on a tube that is six edges around, but no fit is wide enough to average it.
#[test]
fn noise_that_no_fit_reduces_stays() {
    let made = mesh("torus:1,0.2", Family::Irregular, 642).expect("a mesh");
    let noisy = disturbed(&made.positions, 0.2 * mean_edge(&made));
    let found = smoothed(&made.mesh, &noisy, Smoother::Noise);
    assert_eq!(found.unmoved, Some(NotQuieted::Unresolved(found.noise)));
    assert!(found.noise.is_seen() && found.positions == noisy);
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let made = mesh("discocyte", Family::Irregular, 2562).expect("a mesh");
    let noisy = disturbed(&made.positions, 1e-2 * mean_edge(&made));
    for smoother in [Smoother::Noise, Smoother::Flow(1e-3)] {
        let [one, three] = [1, 3].map(|threads| {
            let threads = NonZeroUsize::new(threads).expect("a number");
            with_threads(threads, || smoothed(&made.mesh, &noisy, smoother))
        });
        assert_eq!(one, three);
    }
}

/// Work ends when it is asked to.
#[test]
fn smoothing_is_interrupted() {
    let made = mesh("discocyte", Family::Irregular, 642).expect("a mesh");
    let noisy = disturbed(&made.positions, 1e-2 * mean_edge(&made));
    let ended = smooth(surface(&made.mesh, &noisy), Smoother::Noise, &mut |_| false);
    assert_eq!(ended, Err(SmoothingError::Interrupted));
}
