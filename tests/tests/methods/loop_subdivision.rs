//! Method S: its gradient, symmetries, and orders of convergence.

use helfrich::bending::ConsistentMemory;
use helfrich::shapes::Shape;
use helfrich::{
    ControlPoints, Curvature, Curvatures, Finding, LoopSubdivision, Prepared, Serial, Subdivision,
    Surface, TriangleMesh, VertexKind,
};
use helfrich_std::generate::{Family, GeneratedMesh, generate};
use helfrich_tests::meshes::{Mesh, SplitMix64, dot, norm, octahedron, tetrahedron};
use helfrich_tests::tolerance::{self, Tolerance};
use std::array::from_fn;

/// Energies and forces of a surface that is rotated and translated by about its size, relative.
const RIGID_MOTION: Tolerance = Tolerance::new(
    1e-11,
    "the moved positions are rounded, and forces are their fourth derivatives",
);

/// Energy of method S with sharpened or hybrid control points on smooth discocytes, relative.
const LOOP_DISCOCYTE_642: Tolerance = Tolerance::new(
    1.5e-3,
    "the term of fourth order over an edge, (hκ)⁴/4!, is 1.2e-3 on average over the energy (h = 0.126 R, κ \
     the larger curvature); edges differ by a tenth",
);

/// Energy of method S with four times the vertices, relative.
const LOOP_DISCOCYTE_2562: Tolerance =
    Tolerance::new(1.5e-3 / 16.0, "fourth order, with edges half as long");

/// Energy of method S with sixteen times the vertices, relative.
const LOOP_DISCOCYTE_10242: Tolerance =
    Tolerance::new(1.5e-3 / 256.0, "fourth order, with edges a quarter as long");

/// Energy of method S in f32 against f64, relative.
const LOOP_SINGLE: Tolerance = Tolerance::new(
    1e-6,
    "positions are rounded at 6e-8, and differentiated twice over edges of a twentieth",
);

type Positions = Vec<[f64; 3]>;

fn make(shape: &str, family: Family, vertices: usize) -> GeneratedMesh {
    generate(&shape.parse().unwrap(), family, vertices, 1).unwrap()
}

fn prepared(controls: ControlPoints, mesh: &TriangleMesh) -> Prepared<f64, LoopSubdivision<f64>> {
    Prepared::new(LoopSubdivision::with_controls(1.0, controls), mesh)
}

fn energy(controls: ControlPoints, mesh: &TriangleMesh, positions: &Positions) -> f64 {
    let surface = Surface::new(mesh, positions).unwrap();
    prepared(controls, mesh).energy(surface)
}

fn forces(controls: ControlPoints, mesh: &TriangleMesh, positions: &Positions) -> (f64, Positions) {
    let surface = Surface::new(mesh, positions).unwrap();
    let mut force = vec![[0.0; 3]; positions.len()];
    let energy = prepared(controls, mesh).add_force_and_energy(surface, &mut force);
    (energy, force)
}

/// Sphere with holes: the triangles around two vertices are left out.
fn with_hole() -> (TriangleMesh, Positions) {
    let made = make("discocyte", Family::Smooth, 162);
    let kept = made.mesh.triangles().iter();
    let kept = kept.filter(|triangle| !triangle.contains(&3) && !triangle.contains(&80));
    let mesh = TriangleMesh::new(162, kept.copied().collect()).unwrap();
    (mesh, made.positions)
}

/// Closed and open meshes with vertices of all valences, small and large.
fn meshes() -> Vec<(&'static str, TriangleMesh, Positions)> {
    let generated = |shape, family, vertices| {
        let made = make(shape, family, vertices);
        (made.mesh, made.positions)
    };
    [
        ("tetrahedron", parts(tetrahedron())),
        ("octahedron", parts(octahedron())),
        ("icosahedron", generated("sphere", Family::Smooth, 12)),
        ("smooth", generated("discocyte", Family::Smooth, 162)),
        ("irregular", generated("ellipsoid", Family::Irregular, 200)),
        ("torus", generated("torus", Family::Regular, 128)),
        ("with hole", with_hole()),
    ]
    .map(|(name, (mesh, positions))| {
        let directions = SplitMix64::new(1).directions(positions.len());
        let moved = positions.iter().zip(directions);
        let moved = moved.map(|(x, d)| from_fn(|axis| x[axis] + 0.02 * d[axis]));
        (name, mesh, moved.collect())
    })
    .into()
}

fn parts(mesh: Mesh) -> (TriangleMesh, Positions) {
    (mesh.connectivity, mesh.positions)
}

#[test]
fn interpolated_surfaces_pass_through_the_nodes() {
    for (name, mesh, positions) in meshes() {
        let surface = Surface::new(&mesh, &positions).unwrap();
        let mut limit = vec![[0.0; 3]; positions.len()];
        prepared(ControlPoints::Interpolated, &mesh).with(|method, execution, workspace| {
            method.limit_positions(execution, surface, workspace, &mut limit);
        });
        for (found, expected) in limit.iter().zip(&positions) {
            for axis in 0..3 {
                tolerance::SPLINE.assert(found[axis], expected[axis], 1.0, name);
            }
        }
    }
}

/// If triangles have several extraordinary corners, refining them within the plan gives the energy of the
/// refined mesh.
#[test]
fn refinement_within_the_plan_changes_nothing_but_the_points() {
    let (mesh, positions) = parts(octahedron());
    let fine = Subdivision::new(&mesh, 1).unwrap();
    let fine_positions = fine.refine(&positions);
    let coarse = energy(ControlPoints::Nodes, &mesh, &positions);
    let refined = energy(ControlPoints::Nodes, fine.mesh(), &fine_positions);
    RIGID_MOTION.assert(coarse, refined, refined, "octahedron");
}

#[test]
fn without_interior_triangle_there_is_nothing() {
    let mesh = TriangleMesh::new(3, vec![[0, 1, 2]]).unwrap();
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for controls in ControlPoints::ALL {
        assert_eq!(
            forces(controls, &mesh, &positions),
            (0.0, vec![[0.0; 3]; 3])
        );
        let surface = Surface::new(&mesh, &positions).unwrap();
        let mut density = vec![[1.0; 3]; 3];
        prepared(controls, &mesh).force_density(surface, &mut density);
        assert_eq!(density, [[0.0; 3]; 3]);
    }
}

#[test]
fn points_without_area_contribute_nothing_and_are_reported() {
    let (mesh, _) = parts(octahedron());
    let positions = vec![[1.0, 2.0, 3.0]; 6];
    let surface = Surface::new(&mesh, &positions).unwrap();
    for controls in ControlPoints::ALL {
        let mut method = prepared(controls, &mesh);
        let mut force = vec![[0.0; 3]; 6];
        assert_eq!(method.add_force_and_energy(surface, &mut force), 0.0);
        assert_eq!(force, [[0.0; 3]; 6]);
        let mut findings = Vec::new();
        method.inspect(surface, &mut |finding| findings.push(finding));
        let all = (0..8).map(|triangle| Finding::DegenerateTriangle { triangle });
        assert_eq!(findings, Vec::from_iter(all));
    }
}

const DISCOCYTE: f64 = 48.474_464_751_661_5;

#[test]
fn energy_on_smooth_discocytes() {
    let errors = |controls| {
        [642, 2562, 10242].map(|vertices| {
            let made = make("discocyte", Family::Smooth, vertices);
            energy(controls, &made.mesh, &made.positions) / DISCOCYTE - 1.0
        })
    };
    let bounds = [
        LOOP_DISCOCYTE_642,
        LOOP_DISCOCYTE_2562,
        LOOP_DISCOCYTE_10242,
    ];
    for (error, bound) in errors(ControlPoints::Hybrid).into_iter().zip(bounds) {
        bound.assert(error, 0.0, 1.0, "hybrid");
    }
    for (error, bound) in errors(ControlPoints::Sharpened).into_iter().zip(bounds) {
        bound.assert(error, 0.0, 1.0, "sharpened");
    }
}

/// Order ln(e₁/e₂)/ln√(N₂/N₁).
fn order(coarse: f64, fine: f64, vertices: [usize; 2]) -> f64 {
    (coarse / fine).ln() / (vertices[1] as f64 / vertices[0] as f64).sqrt().ln()
}

/// Number of vertices, and errors on a torus with R/r = 2: of the energy, and the largest over the nodes of
/// the consistent and the lumped force density and of the mean curvature.
fn errors_on_torus(vertices: usize) -> (usize, [f64; 4]) {
    let made = make("torus", Family::Regular, vertices);
    let count = made.positions.len();
    let surface = Surface::new(&made.mesh, &made.positions).unwrap();
    let mut method = prepared(ControlPoints::Sharpened, &made.mesh);
    // 2κ ∫ H² dS = 2π² κ c²/√(c² − 1), c = R/r.
    let exact_energy = 2.0 * std::f64::consts::PI.powi(2) * 4.0 / 3f64.sqrt();
    let mut errors = [
        (method.energy(surface) / exact_energy - 1.0).abs(),
        0.0,
        0.0,
        0.0,
    ];

    let mut lumped = vec![[0.0; 3]; count];
    method.force_density(surface, &mut lumped);
    let mut consistent = vec![[0.0; 3]; count];
    let mut curvature = vec![Curvature::default(); count];
    let iterations = method.with(|method, execution, workspace| {
        method.curvatures(execution, surface, workspace, &mut curvature);
        let mut solver = ConsistentMemory::default();
        let density = &mut consistent;
        method.consistent_force_density(execution, surface, workspace, &mut solver, density)
    });
    assert!(iterations < 60, "{iterations}");
    let mut scale = 0.0f64;
    for vertex in 0..count {
        let exact = made.shape.at(made.preimages[vertex]);
        let value = exact.force_density(1.0);
        let error = |found: [f64; 3]| {
            let error: [f64; 3] = from_fn(|axis| found[axis] - value * exact.normal[axis]);
            norm(error)
        };
        errors[1] = errors[1].max(error(consistent[vertex]));
        errors[2] = errors[2].max(error(lumped[vertex]));
        errors[3] = errors[3].max((curvature[vertex].mean - exact.mean).abs());
        scale = scale.max(value.abs());
    }
    errors[1] /= scale;
    errors[2] /= scale;
    (count, errors)
}

#[test]
fn orders_on_the_torus() {
    let found = [512, 2048, 8192, 32768].map(errors_on_torus);
    for pair in found.windows(2) {
        let [(coarse, before), (fine, after)] = [pair[0], pair[1]];
        let orders: [f64; 4] = from_fn(|k| order(before[k], after[k], [coarse, fine]));
        // At a node, second derivatives of a quartic spline are only of second order.
        for (order, least) in orders.iter().zip([3.7, 3.7, 3.3, 1.9]) {
            assert!(*order >= least, "{orders:?} from {before:?} to {after:?}");
        }
    }
}

/// Largest error of H over the nodes, and relative errors of area and volume.
fn errors_on_discocyte(vertices: usize) -> [f64; 3] {
    let made = make("discocyte", Family::Smooth, vertices);
    let surface = Surface::new(&made.mesh, &made.positions).unwrap();
    let mut curvature = vec![Curvature::default(); vertices];
    let mut method = prepared(ControlPoints::Hybrid, &made.mesh);
    let (area, volume) = method.with(|method, execution, workspace| {
        method.curvatures(execution, surface, workspace, &mut curvature);
        method.area_and_volume(execution, surface, workspace)
    });
    let sum: f64 = curvature.iter().map(|vertex| vertex.area).sum();
    tolerance::SPLINE.assert(sum, area, area, "areas of the nodes");
    let mut largest = 0.0f64;
    for (found, &preimage) in curvature.iter().zip(&made.preimages) {
        let exact = made.shape.at(preimage);
        largest = largest.max((found.mean - exact.mean).abs());
        assert_eq!(found.kind, VertexKind::Interior);
        assert!(dot(found.normal, exact.normal) > 0.999);
    }
    [
        largest,
        (area / 8.770_854_567_499_144 - 1.0).abs(),
        (volume.unwrap() / 1.574_048_683_029_473 - 1.0).abs(),
    ]
}

/// Every triangle of the solid has several extraordinary corners, so that all are refined. The solid is
/// convex, and its corners are equivalent.
#[test]
fn corners_of_refined_triangles_have_their_curvature() {
    for (mesh, positions) in [tetrahedron(), octahedron()].map(parts) {
        let surface = Surface::new(&mesh, &positions).unwrap();
        let mut bending = prepared(ControlPoints::default(), &mesh);
        let curvature = bending.curvatures(surface);
        let first = curvature[0];
        // H is positive where normals point outward.
        let outward = dot(first.normal, positions[0]);
        assert!(
            first.mean * outward > 0.0 && first.gaussian > 0.0,
            "{first:?}"
        );
        for vertex in curvature {
            tolerance::SAME.assert(vertex.mean, first.mean, first.mean.abs(), "H");
            tolerance::SAME.assert(vertex.gaussian, first.gaussian, first.gaussian, "K");
        }
    }
}

/// H converges slowly, also at extraordinary vertices, where it is an average; area and volume converge fast.
#[test]
fn curvature_area_and_volume() {
    let [before, after] = [642, 2562].map(errors_on_discocyte);
    let orders: [f64; 3] = from_fn(|k| order(before[k], after[k], [642, 2562]));
    for (order, least) in orders.iter().zip([0.7, 3.3, 3.3]) {
        assert!(*order >= least, "{orders:?} from {before:?} to {after:?}");
    }
}

/// Repeated evaluations agree to the last bit, and f32 agrees within its precision.
#[test]
fn evaluations_repeat_and_single_precision_agrees() {
    let made = make("discocyte", Family::Smooth, 642);
    let surface = Surface::new(&made.mesh, &made.positions).unwrap();
    let mut method = prepared(ControlPoints::Hybrid, &made.mesh);
    let mut force = vec![[0.0; 3]; 642];
    let first = method.add_force_and_energy(surface, &mut force);
    assert_eq!(method.energy(surface), first);
    let mut doubled = force.clone();
    assert_eq!(method.add_force_and_energy(surface, &mut doubled), first);
    for (twice, once) in doubled.iter().zip(&force) {
        assert_eq!(*twice, once.map(|f| f + f));
    }
    let loose = LoopSubdivision::new(1f32);
    let mut workspace = helfrich::Method::workspace(&loose, &made.mesh);
    let single = Vec::from_iter(made.positions.iter().map(|x| x.map(|x| x as f32)));
    let surface = Surface::new(&made.mesh, &single).unwrap();
    let found = helfrich::Energy::energy(&loose, &Serial, surface, &mut workspace);
    LOOP_SINGLE.assert(f64::from(found), first, first, "energy");
}
