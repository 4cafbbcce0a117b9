//! Methods selected by name agree with the core's methods, with the same defaults everywhere.

use helfrich::{
    Bandwidth, Conservative, DualArea, ForceDensity, GompperKroll, HeatKernel, Jet,
    MaterialParameter, Prepared, StrongForm, Surface,
};
use helfrich_std::effect::{Effect, Lumping};
use helfrich_std::execute::Parallel;
use helfrich_std::generate::{AnyShape, Family, GeneratedMesh, generate};
use helfrich_std::method::{BendingMethod, Evaluator, Fields, MethodOptions};

/// Irregular mesh with some obtuse triangles.
fn irregular() -> GeneratedMesh {
    let shape: AnyShape = "discocyte".parse().expect("a shape");
    generate(&shape, Family::Irregular, 400, 3).expect("a mesh")
}

fn evaluated(
    method: BendingMethod,
    options: MethodOptions,
    surface: Surface<'_, f64>,
) -> Vec<[f64; 3]> {
    let threads = Parallel::single();
    let mut evaluator = Evaluator::with_options(method, &options, 1.0, surface.mesh(), threads);
    evaluator.evaluate(surface);
    evaluator.force().to_vec()
}

fn conservative<M: Conservative<f64>>(method: M, surface: Surface<'_, f64>) -> Vec<[f64; 3]> {
    let mut force = vec![[0.0; 3]; surface.positions().len()];
    Prepared::new(method, surface.mesh()).add_force_and_energy(surface, &mut force);
    force
}

fn density<M: ForceDensity<f64>>(method: M, surface: Surface<'_, f64>) -> Vec<[f64; 3]> {
    let mut force = vec![[0.0; 3]; surface.positions().len()];
    Prepared::new(method, surface.mesh()).force_density(surface, &mut force);
    force
}

/// Study, table of curvatures and run evaluate the same method under one name.
#[test]
fn runs_and_studies_evaluate_the_same_method() {
    let mesh = irregular();
    let surface = Surface::new(&mesh.mesh, &mesh.positions).expect("positions");
    let all = BendingMethod::ALL.into_iter().chain([BendingMethod::Jet]);
    for method in all.filter(|method| method.is_conservative()) {
        let options = MethodOptions::default();
        let mut run = Effect::bending(
            "bending",
            method,
            &options,
            [1.0, 0.0].map(MaterialParameter::Constant),
            Lumping::Own,
            &mesh.mesh,
        )
        .expect("a bending method");
        let mut force = vec![[0.0; 3]; mesh.positions.len()];
        let energy = run.add_force(surface, &mut force);
        assert_eq!(force, evaluated(method, options, surface), "{method}");
        let mut evaluator = Evaluator::new(method, 1.0, &mesh.mesh);
        assert_eq!(energy, evaluator.energy(surface), "{method}");
    }
    for method in all_in_strong_form() {
        let options = MethodOptions::default();
        let mut run = Effect::bending(
            "bending",
            method,
            &options,
            [1.0, 0.0].map(MaterialParameter::Constant),
            Lumping::Own,
            &mesh.mesh,
        )
        .expect("a bending method");
        let energy = run.add_force(surface, &mut vec![[0.0; 3]; mesh.positions.len()]);
        let mut evaluator = Evaluator::new(method, 1.0, &mesh.mesh);
        assert_eq!(energy, evaluator.energy(surface), "{method}");
    }
}

fn all_in_strong_form() -> impl Iterator<Item = BendingMethod> {
    let all = BendingMethod::ALL.into_iter().chain([BendingMethod::Jet]);
    all.filter(|method| !method.is_conservative())
}

/// The options for areas and bandwidth reach the core's method.
#[test]
fn options_choose_the_variant() {
    let mesh = irregular();
    let surface = Surface::new(&mesh.mesh, &mesh.positions).expect("positions");
    let default = evaluated(
        BendingMethod::GompperKroll,
        MethodOptions::default(),
        surface,
    );
    for areas in [DualArea::Mixed, DualArea::Voronoi, DualArea::Barycentric] {
        let options = MethodOptions {
            areas: Some(areas),
            ..MethodOptions::default()
        };
        let found = evaluated(BendingMethod::GompperKroll, options, surface);
        let own = conservative(GompperKroll::with_areas(1.0, areas), surface);
        assert_eq!(found, own, "{areas:?}");
        assert_eq!(found == default, areas == DualArea::Mixed, "{areas:?}");
    }
    let area = surface.area() / mesh.positions.len() as f64;
    let half = HeatKernel::new(Bandwidth::MeanArea(0.5));
    let global = HeatKernel::new(Bandwidth::Global(0.5 * area));
    let options = MethodOptions {
        bandwidth: Some(Bandwidth::MeanArea(0.5)),
        ..MethodOptions::default()
    };
    let found = evaluated(BendingMethod::Belkin, options, surface);
    assert_eq!(found, density(StrongForm::new(1.0, half), surface));
    let global = density(StrongForm::new(1.0, global), surface);
    let largest = global
        .iter()
        .flatten()
        .fold(0.0, |a: f64, b| a.max(b.abs()));
    for (found, global) in found.iter().flatten().zip(global.iter().flatten()) {
        // The sum of the areas is rounded in another order.
        assert!((found - global).abs() < 1e-9 * largest);
    }
}

/// Texts of options are parsed, and others are refused with a list of the possible ones.
#[test]
fn options_are_parsed() {
    for (name, areas) in [
        ("mixed", DualArea::Mixed),
        ("Voronoi", DualArea::Voronoi),
        ("barycentric", DualArea::Barycentric),
    ] {
        assert_eq!(MethodOptions::parse_areas(name), Ok(areas));
    }
    assert!(MethodOptions::parse_areas("circumcentric").is_err());
    for (text, bandwidth) in [
        ("0.5", Bandwidth::MeanArea(0.5)),
        ("converging", Bandwidth::Converging),
        ("published", Bandwidth::MixedArea(1.0)),
    ] {
        assert_eq!(MethodOptions::parse_bandwidth(text), Ok(bandwidth));
    }
    for wrong in ["0", "-1", "nan", "inf", "1e-320", "wide", ""] {
        let error = MethodOptions::parse_bandwidth(wrong).expect_err(wrong);
        assert!(error.to_string().contains("published"), "{error}");
    }
}

/// The default bandwidth is √N/100 mean vertex areas, and a quarter below 625 vertices.
#[test]
fn the_default_bandwidth_shrinks_more_slowly_than_the_triangles() {
    let shape: AnyShape = "discocyte".parse().expect("a shape");
    for (vertices, expected) in [(162, 0.25), (2562, 0.506_162)] {
        let mesh = generate(&shape, Family::Regular, vertices, 1).expect("a mesh");
        let surface = Surface::new(&mesh.mesh, &mesh.positions).expect("positions");
        let found = density(StrongForm::belkin(1.0), surface);
        let explicit = HeatKernel::new(Bandwidth::MeanArea(expected));
        let explicit = density(StrongForm::new(1.0, explicit), surface);
        let largest = explicit
            .iter()
            .flatten()
            .fold(0.0, |a: f64, b| a.max(b.abs()));
        for (found, explicit) in found.iter().flatten().zip(explicit.iter().flatten()) {
            // The expected factor has six digits.
            assert!((found - explicit).abs() < 1e-4 * largest, "{vertices}");
        }
    }
}

/// The energy alone is that which comes with the forces.
#[test]
fn an_energy_alone_is_that_beside_forces() {
    let mesh = irregular();
    let surface = Surface::new(&mesh.mesh, &mesh.positions).expect("positions");
    let options = MethodOptions::default();
    let material = [1.3, 0.2].map(MaterialParameter::Constant);
    for method in BendingMethod::ALL {
        for lumping in [Lumping::Own, Lumping::Thirds] {
            let mut material = material.clone();
            if method == BendingMethod::KantorNelson {
                material[1] = MaterialParameter::default();
            }
            let mesh = &mesh.mesh;
            let effect = Effect::bending("bending", method, &options, material, lumping, mesh);
            let mut effect = effect.expect("a bending method");
            let mut force = vec![[0.0; 3]; surface.positions().len()];
            let energy = effect.add_force(surface, &mut force);
            assert_eq!(effect.energy(surface), energy, "{method}");
        }
    }
}

/// Curvatures alone are those that come with forces, to the bit, and so are their findings, in any order of the mesh.
#[test]
fn curvatures_need_no_force() {
    let shape: AnyShape = "discocyte".parse().expect("a shape");
    let large = generate(&shape, Family::Irregular, 20_500, 3).expect("a mesh");
    let small = generate(&shape, Family::Irregular, 400, 3).expect("a mesh");
    // A sliver, for findings.
    let mut thin = small.positions.clone();
    let [a, b, _] = small.mesh.triangles()[0].map(|vertex| vertex as usize);
    thin[a] = std::array::from_fn(|axis| thin[b][axis] + 1e-3 * (thin[a][axis] - thin[b][axis]));
    let of_large = [BendingMethod::GompperKroll, BendingMethod::Meyer];
    let cases = [
        (&small.mesh, &small.positions, &BendingMethod::NAMED[..]),
        (&small.mesh, &thin, &BendingMethod::NAMED[..]),
        (&large.mesh, &large.positions, &of_large[..]),
    ];
    for (mesh, positions, methods) in cases {
        let surface = Surface::new(mesh, positions).expect("positions");
        for &method in methods {
            let (all, expected) = Evaluator::new(method, 1.0, mesh).fields_and_findings(surface);
            let mut evaluator = Evaluator::new(method, 1.0, mesh);
            let (found, findings) = evaluator.curvatures_and_findings(surface);
            assert_eq!(findings, expected, "{method}");
            let none = Fields {
                laplacian_of_mean: vec![None; positions.len()],
                force_density: vec![None; positions.len()],
                ..all
            };
            assert!(found == none, "{method}");
        }
    }
}

/// A material at the vertices is that of the mesh of the user, also where that is evaluated in another
/// order.
#[test]
fn evaluators_have_a_material() {
    let shape: AnyShape = "discocyte".parse().expect("a shape");
    let options = MethodOptions::default();
    for vertices in [400, 40_962] {
        let mesh = generate(&shape, Family::Regular, vertices, 3).expect("a mesh");
        let surface = Surface::new(&mesh.mesh, &mesh.positions).expect("positions");
        let of = |value: fn(&[f64; 3]) -> f64| {
            MaterialParameter::PerVertex(mesh.positions.iter().map(value).collect())
        };
        let material = [of(|x| 2.0 + x[0]), of(|x| 0.3 * x[1])];
        for method in [BendingMethod::GompperKroll, BendingMethod::Meyer] {
            let evaluator = Evaluator::with_material(
                method,
                &options,
                material.clone(),
                &mesh.mesh,
                Parallel::new(),
            );
            let mut evaluator = evaluator.expect("a bending method");
            evaluator.evaluate(surface);
            let [modulus, spontaneous_curvature] = material.clone();
            let expected = match method {
                BendingMethod::GompperKroll => conservative(
                    GompperKroll {
                        modulus,
                        spontaneous_curvature,
                        ..GompperKroll::new(1.0)
                    },
                    surface,
                ),
                _ => density(
                    StrongForm {
                        modulus,
                        spontaneous_curvature,
                        ..StrongForm::meyer(1.0)
                    },
                    surface,
                ),
            };
            let largest = expected
                .as_flattened()
                .iter()
                .fold(0.0, |most: f64, x| most.max(x.abs()));
            let pairs = evaluator.force().as_flattened().iter();
            for (found, expected) in pairs.zip(expected.as_flattened()) {
                // Sums around a vertex have another order.
                assert!((found - expected).abs() <= 1e-11 * largest, "{method}");
            }
        }
        let [modulus, _] = material;
        let uniform = MaterialParameter::default();
        for method in [BendingMethod::KantorNelson, BendingMethod::Corrected] {
            let material = [modulus.clone(), uniform.clone()];
            let threads = Parallel::new();
            let refused = Evaluator::with_material(method, &options, material, &mesh.mesh, threads);
            assert!(refused.is_err(), "{method}");
        }
    }
}

/// The matrix of an operator applies it; methods with an energy have none.
#[test]
fn operators_are_matrices() {
    let mesh = irregular();
    let surface = Surface::new(&mesh.mesh, &mesh.positions).expect("positions");
    let options = MethodOptions::default();
    for method in BendingMethod::NAMED {
        let operator = method.operator(&options, surface);
        let has_one = method.has_force() && !method.is_conservative();
        assert_eq!(operator.is_ok(), has_one, "{method}");
    }
    let found = BendingMethod::J6
        .operator(&options, surface)
        .expect("an operator");
    let mut jet = Prepared::new(Jet::j6(), &mesh.mesh);
    let areas = jet.curvatures(surface).iter().map(|vertex| vertex.area);
    assert_eq!(found.areas, Vec::from_iter(areas));
    let field = Vec::from_iter(mesh.positions.iter().map(|x| x[0] * x[1] + x[2]));
    let mut expected = vec![0.0; field.len()];
    jet.apply_to_scalar(surface, &field, &mut expected);
    let mut applied = vec![0.0; field.len()];
    found
        .matrix
        .apply_to_scalar(&Parallel::single(), &field, &mut applied);
    let largest = expected.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    for (applied, expected) in applied.iter().zip(&expected) {
        // The matrix has the diagonal, with which constants are 0 only to rounding.
        assert!((applied - expected).abs() <= 1e-9 * largest);
    }
}
