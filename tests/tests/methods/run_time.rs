//! Methods selected by name agree with the core's methods, with the same defaults everywhere.

use helfrich::{
    Bandwidth, Conservative, DualArea, ForceDensity, GompperKroll, HeatKernel, MaterialParameter,
    Prepared, StrongForm, Surface,
};
use helfrich_std::effect::{Effect, Lumping};
use helfrich_std::execute::Parallel;
use helfrich_std::generate::{AnyShape, Family, GeneratedMesh, generate};
use helfrich_std::method::{BendingMethod, Evaluator, MethodOptions};

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
