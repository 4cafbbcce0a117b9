//! The energy of blended jets: its gradient, parameters that vary, open meshes, and what is reported.
//! `convergence.rs` has its orders.

use autodiff::F1;
use helfrich::shapes::ExactPoint;
use helfrich::{
    AnyFunctional, Energy, Finding, Force, Galerkin, Jet, MaterialParameter, PatchFunctional,
    Prepared, Quality, Real, StrongForm, Surface, Targets, TriangleMesh,
};
use helfrich_std::generate::{AnyShape, Family, generate};
use helfrich_tests::accuracy::{exact_points, force_and_energy, surface};
use helfrich_tests::laws::{
    Balanced, ConservativeLaw, ForceIsDifference, ForceIsGradient, Invariant, Law, check_work,
};
use helfrich_tests::meshes::{Mesh, bent, cap, dot, icosphere, norm, tetrahedron, tube};
use helfrich_tests::potentials::Penalised;
use helfrich_tests::quadrature::over_sphere_like;
use helfrich_tests::tolerance::{self, Tolerance};
use std::f64::consts::PI;

/// The energy of a sphere of 642 vertices over 8πκ.
const SPHERE: Tolerance = Tolerance::new(
    1e-8,
    "twice the order of the patches' curvature, h⁸ with h = 0.14 and a small constant",
);

/// E and the largest force where H0 is the curvature of the sphere, over those of H0 = 0 and 1.
const PREFERRED: Tolerance = Tolerance::new(
    1e-7,
    "the curvature of patches has an error of some 1e-5, which enters E squared, and forces multiply by 1/h",
);

/// Moduli and spontaneous curvatures that vary over the surface.
fn varying<T: Real>(positions: &[[f64; 3]]) -> Galerkin<T> {
    let of = |value: &dyn Fn(&[f64; 3]) -> f64| {
        MaterialParameter::PerVertex(positions.iter().map(|x| T::constant(value(x))).collect())
    };
    Galerkin {
        modulus: of(&|[x, y, z]| 1.0 + 0.3 * x + 0.2 * y * z),
        spontaneous_curvature: of(&|[x, y, z]| 0.5 + 0.4 * y - 0.3 * x * z),
    }
}

fn energy<T: Real>(method: impl Energy<T>, mesh: &TriangleMesh, positions: &[[T; 3]]) -> T {
    let surface = Surface::new(mesh, positions).expect("one finite position a vertex");
    Prepared::new(method, mesh).energy(surface)
}

fn forces(method: impl Force<f64>, mesh: &Mesh) -> Vec<[f64; 3]> {
    let mut force = vec![[0.0; 3]; mesh.positions.len()];
    Prepared::new(method, &mesh.connectivity).add_force(mesh.surface(), &mut force);
    force
}

/// Forces include the change of fitted parameters with the positions.
#[test]
fn forces_are_gradients_where_parameters_vary() {
    let mesh = icosphere(3).map(bent);
    let force = forces(varying(&mesh.positions), &mesh);
    let Mesh {
        connectivity,
        positions,
    } = &mesh;
    let energy = |moved: &[_]| energy(varying::<F1>(positions), connectivity, moved);
    check_work(
        &force,
        positions,
        tolerance::GRADIENT_DUAL,
        "varying",
        energy,
    );
}

/// On spheres: `8πκ`; and nothing where H0 is their curvature.
#[test]
fn spheres_are_exact_to_high_order() {
    let sphere = icosphere(3);
    let round = energy(Galerkin::new(1.0), &sphere.connectivity, &sphere.positions);
    let expected = 8.0 * PI;
    SPHERE.assert(round, expected, expected, "energy of a sphere");
    let preferred = Galerkin {
        spontaneous_curvature: MaterialParameter::Constant(1.0),
        ..Galerkin::new(1.0)
    };
    let left = energy(preferred, &sphere.connectivity, &sphere.positions);
    PREFERRED.assert(left, 0.0, expected, "energy of a preferred sphere");
}

/// Area and volume of patches on a long spheroid, relative errors on meshes of 642 and 2562 vertices; those
/// of flat triangles are 4e-3 and 1e-3.
#[test]
fn areas_and_volumes_of_patches_converge_as_the_energy() {
    let (across, along) = (0.8_f64, 1.4_f64);
    let eccentricity = (1.0 - (across / along).powi(2)).sqrt();
    let area = 2.0 * PI * across * (across + along * eccentricity.asin() / eccentricity);
    let volume = 4.0 / 3.0 * PI * across * across * along;
    let shape: AnyShape = format!("ellipsoid:{across},{across},{along}")
        .parse()
        .expect("a shape");
    for (functional, exact) in [
        (PatchFunctional::Area, area),
        (PatchFunctional::Volume, volume),
    ] {
        let [coarse, fine] = [642, 2562].map(|vertices| {
            let made = generate(&shape, Family::Relaxed, vertices, 1).expect("a mesh");
            let Targets::PerComponent(found) = Targets::measured(&functional, surface(&made))
            else {
                panic!("a value for each component");
            };
            (found[0] / exact - 1.0).abs()
        });
        // A fortieth of the error of flat triangles; and an order of at least 5, the degree of the patches.
        assert!(coarse < 1e-4, "{functional:?}: {coarse:e}");
        assert!(fine < coarse / 32.0, "{functional:?}: {coarse:e}, {fine:e}");
    }
}

/// Energies of the area and volume of patches obey the laws of conservative methods.
#[test]
fn penalties_of_patches_are_conservative() {
    let mesh = &icosphere(2).map(bent);
    for (functional, target) in [(PatchFunctional::Area, 9.0), (PatchFunctional::Volume, 2.5)] {
        let penalty = Penalised {
            quantity: AnyFunctional::OfPatches(functional),
            target,
        };
        // A penalty with a target depends on the unit of length: no law of scales.
        ForceIsGradient(mesh).check(penalty);
        ForceIsDifference(mesh).check(penalty);
        Balanced(mesh).check(penalty);
        Law::check(&mut Invariant { mesh, seed: 1 }, penalty);
    }
}

fn findings(mesh: &Mesh) -> Vec<Finding> {
    let mut prepared = Prepared::new(Galerkin::new(1.0), &mesh.connectivity);
    prepared.energy(mesh.surface());
    let mut findings = Vec::new();
    prepared.inspect(mesh.surface(), &mut |finding| findings.push(finding));
    findings
}

#[test]
fn what_is_not_resolved_is_reported() {
    let smooth = icosphere(3);
    assert_eq!(findings(&smooth), []);
    let is_unresolved = |finding: &Finding| matches!(finding, Finding::Unresolved { .. });
    let coarse = findings(&icosphere(1).map(bent));
    assert!(coarse.iter().any(is_unresolved), "{coarse:?}");
    let reduced = |finding: &Finding| matches!(finding, Finding::ReducedDegree { .. });
    assert_eq!(coarse.iter().filter(|f| reduced(f)).count(), 42);
    let none = findings(&tetrahedron());
    let left_out = |finding: &Finding| matches!(finding, Finding::TooFewNeighbours { .. });
    assert_eq!(none.iter().filter(|f| left_out(f)).count(), 4);
    // Pressed flat: the two sides are no graph over each other.
    let flat = findings(&smooth.map(|[x, y, z]| [x, y, 1e-3 * z]));
    let no_graph = |finding: &Finding| matches!(finding, Finding::NoGraph { .. });
    assert!(flat.iter().any(no_graph));
}

/// Where two vertices of a sphere are close, only the vertices around them are flagged, about the energy and
/// the nodal forces; H is right there, too.
#[test]
fn findings_belong_to_their_own_vertices_and_quantities() {
    let mut sphere = icosphere(4);
    let moved = 1000;
    let close = sphere.connectivity.one_ring(moved)[0] as usize;
    let [from, to] = [moved, close].map(|vertex| sphere.positions[vertex]);
    let between = [0, 1, 2].map(|k| 0.02 * from[k] + 0.98 * to[k]);
    sphere.positions[moved] = between.map(|x| x / norm(between));
    let mut prepared = Prepared::new(Galerkin::new(1.0), &sphere.connectivity);
    prepared.energy(sphere.surface());
    let flagged = |prepared: &Prepared<f64, Galerkin<f64>>| {
        let mesh = &sphere.connectivity;
        let quality = Quality::gather(mesh, |report| prepared.inspect(sphere.surface(), report));
        quality.flagged().to_vec()
    };
    let of_energy = flagged(&prepared);
    assert!(of_energy[moved] && of_energy[close]);
    // Vertices within two edges of both, at most 37.
    let count = of_energy.iter().filter(|&&flagged| flagged).count();
    assert!(count <= 37, "{count}");
    let curvatures = prepared.curvatures(sphere.surface()).to_vec();
    assert_eq!(flagged(&prepared), vec![false; sphere.positions.len()]);
    for (vertex, at) in curvatures.iter().enumerate() {
        // Jets of degree 8 over an edge of 0.07: h⁷ with a small constant.
        assert!((at.mean - 1.0).abs() < 1e-8, "{vertex}: {}", at.mean);
    }
}

/// Displacements of a surface along its normals, as functions in space.
const DISPLACEMENTS: [fn([f64; 3]) -> f64; 4] = [
    |_| 1.0,
    |[x, _, z]| x * x + 0.5 * z,
    |[x, y, z]| (1.3 * x + 0.7 * y - 0.4 * z).sin(),
    |[x, y, z]| (x - 0.5 * y).exp() * (2.0 * z).cos(),
];

/// The largest of `|Σ F·n φ − ∫ f φ dS|/∫ |f φ| dS` over some displacements φ: F are nodal forces, and n and f
/// exact.
fn weak_error(shape: &AnyShape, family: Family, vertices: usize) -> f64 {
    let made = generate(shape, family, vertices, 1).expect("a mesh");
    let (force, _) = force_and_energy(Galerkin::new(1.0), surface(&made));
    let points = exact_points(&made);
    let errors = DISPLACEMENTS.map(|displacement| {
        let work = points.iter().zip(&force);
        let work = work.map(|(at, &force)| dot(force, at.normal) * displacement(at.position));
        let density = |at: &ExactPoint<f64>| at.force_density(1.0) * displacement(at.position);
        let exact = over_sphere_like(shape, density);
        let size = over_sphere_like(shape, |at| density(at).abs());
        (work.sum::<f64>() - exact).abs() / size
    });
    errors.into_iter().fold(0.0, f64::max)
}

/// The gradient itself converges: the work of nodal forces in smooth displacements is that of the exact f, with
/// twice the order of the curvature of patches, as the energy; on meshes with needles and caps, too.
#[test]
fn the_work_of_nodal_forces_converges_as_the_energy() {
    for shape in ["ellipsoid:1,0.8,0.6", "discocyte"] {
        let shape: AnyShape = shape.parse().expect("a shape");
        for family in [Family::Relaxed, Family::Irregular, Family::Hard] {
            let [coarse, fine] = [642, 2562].map(|count| weak_error(&shape, family, count));
            let order = (coarse / fine).log2();
            // 2 (r − 2) with r − 2 ≥ 4, less half an order, because the meshes are two.
            assert!(order > 7.5, "{shape}, {family}: {coarse:e}, {fine:e}");
            // A hundredth of the error of an energy that is known to 1 %.
            assert!(fine < 1e-4, "{shape}, {family}: {fine:e}");
        }
    }
}

/// n, H, K and f are those of the strong form over jets, of a degree that suits the mesh.
#[test]
fn force_densities_are_the_strong_form_over_jets() {
    let shape: AnyShape = "discocyte".parse().expect("a shape");
    for (vertices, jet) in [(642, Jet::j4()), (1281, Jet::j6()), (2562, Jet::j8())] {
        let made = generate(&shape, Family::Irregular, vertices, 1).expect("a mesh");
        for method in [Galerkin::new(1.0), varying(&made.positions)] {
            let expected = StrongForm {
                modulus: method.modulus.clone(),
                spontaneous_curvature: method.spontaneous_curvature.clone(),
                operator: jet,
            };
            let mut own = Prepared::new(method, &made.mesh);
            let mut other = Prepared::new(expected, &made.mesh);
            let mut densities = [(); 2].map(|()| vec![[0.0; 3]; vertices]);
            own.force_density(surface(&made), &mut densities[0]);
            other.force_density(surface(&made), &mut densities[1]);
            assert!(densities[0] == densities[1], "f, {vertices}");
            let curvatures = own.curvatures(surface(&made));
            assert!(curvatures == other.curvatures(surface(&made)), "{vertices}");
        }
    }
}

/// f along the exact normals, at the vertices of a mesh.
fn densities(method: Galerkin<f64>, mesh: &Mesh, normals: &[[f64; 3]]) -> Vec<f64> {
    let mut density = vec![[0.0; 3]; mesh.positions.len()];
    Prepared::new(method, &mesh.connectivity).force_density(mesh.surface(), &mut density);
    let pairs = density.iter().zip(normals);
    pairs.map(|(&f, &normal)| dot(f, normal)).collect()
}

/// The slope of f on exact values over vertices this many edges from the boundary or more.
fn slope(mesh: &Mesh, found: &[f64], exact: &[f64], edges: u32) -> f64 {
    let far = mesh.edges_to_boundary();
    let inside = (0..found.len()).filter(|&v| far[v] >= edges);
    let (above, below) = inside.fold((0.0, 0.0), |(above, below), v| {
        (above + found[v] * exact[v], below + exact[v] * exact[v])
    });
    assert!(below > 0.0);
    above / below
}

/// A discocyte of this family, cut by a plane, with exact values.
fn cut_discocyte(family: Family, vertices: usize) -> (Mesh, Vec<[f64; 3]>, Vec<f64>) {
    let shape: AnyShape = "discocyte".parse().expect("a shape");
    let made = generate(&shape, family, vertices, 1).expect("a mesh");
    let whole = Mesh::new(made.positions.clone(), made.mesh.triangles().to_vec());
    let points = exact_points(&made);
    let (mesh, old) = whole.cut(|[x, y, z]| 0.8 * x - 0.3 * y + z < 0.35);
    let of = |v: &u32| points[*v as usize];
    let normals = old.iter().map(|v| of(v).normal).collect();
    let exact = old.iter().map(|v| of(v).force_density(1.0)).collect();
    (mesh, normals, exact)
}

/// On open meshes, too, the slope of f on exact values is 1, for the shapes where f has large and small terms, on
/// sheets with corners, and with a spontaneous curvature.
#[test]
fn force_densities_of_open_meshes_have_the_slope_of_exact_ones() {
    // f is far from constant, and largest on the rim. On 5 rings one-sided fits have visible errors.
    for (family, vertices) in [
        (Family::Regular, 2562),
        (Family::Irregular, 5762),
        (Family::Regular, 10_242),
    ] {
        let (mesh, normals, exact) = cut_discocyte(family, vertices);
        let found = densities(Galerkin::new(1.0), &mesh, &normals);
        let slope = slope(&mesh, &found, &exact, 5);
        assert!((slope - 1.0).abs() < 0.01, "{family} {vertices}: {slope}");
    }
    // A tube of radius 1, H = 1/2 and K = 0: f = 4 H³.
    let tube = tube(48, 40, 2.2, |_| 1.0);
    let normals = Vec::from_iter(tube.positions.iter().map(|[x, y, _]| [*x, *y, 0.0]));
    let found = densities(Galerkin::new(1.0), &tube, &normals);
    let exact = vec![0.5; found.len()];
    let of_tube = slope(&tube, &found, &exact, 2);
    assert!((of_tube - 1.0).abs() < 0.01, "{of_tube}");
    // The cap of a sphere with H0 = ½: f = 4 κ (H − H0)(H² − K + H0 H) = 1.
    let cap = cap(24, 1.2);
    let bent = Galerkin {
        spontaneous_curvature: MaterialParameter::Constant(0.5),
        ..Galerkin::new(1.0)
    };
    let found = densities(bent, &cap, &cap.positions);
    let exact = vec![1.0; found.len()];
    let of_cap = slope(&cap, &found, &exact, 2);
    assert!((of_cap - 1.0).abs() < 0.01, "{of_cap}");
}

/// A closed component has the same f beside an open one as alone.
#[test]
fn components_do_not_change_the_force_densities_of_others() {
    let sphere = icosphere(3).map(bent);
    let cap = cap(12, 1.2).map(|[x, y, z]| [x + 5.0, y, z]);
    let shift = sphere.positions.len() as u32;
    let moved = cap.connectivity.triangles().iter();
    let moved = moved.map(|corners| corners.map(|corner| corner + shift));
    let triangles = sphere.connectivity.triangles().iter().copied();
    let both = Mesh::new(
        [sphere.positions.clone(), cap.positions.clone()].concat(),
        triangles.chain(moved).collect(),
    );
    let density = |mesh: &Mesh| {
        let mut density = vec![[0.0; 3]; mesh.positions.len()];
        Prepared::new(Galerkin::new(1.0), &mesh.connectivity)
            .force_density(mesh.surface(), &mut density);
        density
    };
    let [together, alone, open] = [&both, &sphere, &cap].map(density);
    let expected = [alone, open].concat();
    let largest = expected.iter().map(|&f| norm(f)).fold(0.0, f64::max);
    for (f, expected) in together.iter().zip(&expected) {
        let difference = norm([0, 1, 2].map(|k| f[k] - expected[k]));
        // Fits are the same but for the order of their neighbours.
        assert!(difference < 1e-9 * largest, "{difference:e}");
    }
}
