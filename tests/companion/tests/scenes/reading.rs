//! Valid scenes.

use super::{folder, generated, mesh_file, shipped, valid, with};
use helfrich::DualArea;
use helfrich_std::method::BendingMethod;
use helfrich_std::scene::{
    Adhesion, AreaDifferenceTarget, Driver, Ends, Every, Hold, InPlaneLaw, InteractionScene,
    Material, MeshSource, Overrides, Pictures, Place, Pull, ReferenceSource, SceneFile, Scheme,
    Target, UnitSystem, VolumeTarget,
};

/// A scene with every key of surfaces, interactions, relaxations and outputs.
const EVERYTHING: &str = r#"
title = "Everything"
units = "micro"

[[surface]]
name = "a"
shape = "ellipsoid:3,3,2"
family = "relaxed"
vertices = 642
seed = 7
scale = 2
position = [0, "5 µm", 0.5]
orientation = { axis = [0, 0, 1], angle = 30 }
viscosity_ratio = 1.0
bending = { method = "B", modulus = "2e-19 J", areas = "voronoi", spontaneous_curvature = -0.5 }
area = { modulus = "5 N/m", target = "200 µm²" }
volume = { constraint = "exact", reduced = 0.6 }
area_difference = { modulus = 0.3, reduced = 1.2 }
tension.value = "1 nN/m"
pressure.value = "-0.5 Pa"
gravity = { density_difference = "50 kg/m³", acceleration = [0, 0, "-9.81 m/s²"] }

[surface.elasticity]
law = "skalak"
shear_modulus = "5.3 µN/m"
area_ratio = 1
reference = { shape = "sphere:3", scale = 0.9 }

[surface.local_area]
modulus = 3
reference.mesh = "rest.ply"

[surface.stretching]
axis = [1, 0, 0]
force = [0, "30 pN"]
fraction = 0.02

[[surface]]
mesh = "cell.ply"
area.constraint = "exact"
volume.modulus = 2
volume.target = 50
area_difference.constraint = "exact"
adhesion = { strength = "0.1 µN/m", distance = "60 nm", wall = [0, "-4 µm", 1], normal = [0, 2, 0] }

[[interaction]]
kind = "repulsion"
strength = 0.1
cutoff = 0.2
between = ["surface-2", "a"]
parts = true

[driver]
kind = "relax"
scheme = "overdamped"
residual = 1e-3
iterations = 7
redistribution = false

[output]
every = 3
surfaces = false
pictures = false
picture_field = "bending-force"
checkpoint_every = 11
"#;

#[test]
fn every_key_of_a_mesh_is_read() {
    let file = valid(EVERYTHING);
    let lines = Vec::from_iter(file.warnings.iter().map(|warning| match warning.place {
        Place::Text { line, .. } => line,
        _ => 0,
    }));
    // The warnings are about the pressure, because the volume is held exactly, and about gravity.
    assert_eq!(lines, [20, 21], "{:?}", file.warnings);
    let scene = &file.scene;
    assert_eq!(
        (scene.title.as_str(), scene.units),
        ("Everything", UnitSystem::Micro)
    );
    let [a, b] = scene.surfaces.as_slice() else {
        panic!("two surfaces");
    };
    let MeshSource::Shape {
        shape,
        family,
        vertices,
        seed,
        match_volume: false,
    } = a.source
    else {
        panic!("a shape");
    };
    assert_eq!(shape.to_string(), "ellipsoid:3,3,2");
    assert_eq!((family.name(), vertices, seed), ("relaxed", 642, 7));
    assert_eq!((a.scale, a.position), (2.0, [0.0, 5.0, 0.5]));
    let orientation = a.orientation.unwrap();
    assert_eq!(
        (orientation.axis, orientation.angle),
        ([0.0, 0.0, 1.0], 30.0)
    );
    assert_eq!(a.viscosity_ratio, Some(1.0));

    assert_eq!(b.name, "surface-2");
    assert_eq!(b.source, MeshSource::File(mesh_file("folder/cell.ply")));
    assert_eq!((b.scale, b.position), (1.0, [0.0; 3]));
}

#[test]
fn every_key_of_a_material_is_read() {
    let file = valid(EVERYTHING);
    let [a, b] = file.scene.surfaces.as_slice() else {
        panic!("two surfaces");
    };
    let bending = a.effects.bending.as_ref().unwrap();
    assert_eq!(bending.method, BendingMethod::GompperKroll);
    assert_eq!(bending.options.areas, Some(DualArea::Voronoi));
    assert_eq!(
        [&bending.modulus, &bending.spontaneous_curvature],
        [0.2, -0.5].map(Material::Number).each_ref()
    );
    let elasticity = a.effects.elasticity.as_ref().unwrap();
    let law = InPlaneLaw::Skalak {
        shear_modulus: 5.3,
        area_ratio: 1.0,
    };
    assert_eq!(elasticity.law, law);
    assert_eq!(elasticity.reference.scale, 0.9);
    let ReferenceSource::Shape(reference) = &elasticity.reference.source else {
        panic!("a shape");
    };
    assert_eq!(reference.to_string(), "sphere:3");
    let adhesion = Adhesion {
        strength: 0.1,
        distance: 0.06,
        range: 0.06 / 3.0,
        wall: [0.0, -4.0, 1.0],
        normal: [0.0, 2.0, 0.0],
    };
    assert_eq!(
        (a.effects.adhesion, b.effects.adhesion),
        (None, Some(adhesion))
    );
    let local = a.effects.local_area.as_ref().unwrap();
    let rest = ReferenceSource::File(mesh_file("folder/rest.ply"));
    assert_eq!((local.modulus, &local.reference.source), (3.0, &rest));
    assert!(
        b.effects.bending.is_none()
            && b.effects.elasticity.is_none()
            && b.effects.stretching.is_none()
    );
}

#[test]
fn every_key_of_targets_and_loads_is_read() {
    let file = valid(EVERYTHING);
    let [a, b] = file.scene.surfaces.as_slice() else {
        panic!("two surfaces");
    };
    let area = a.effects.area.unwrap();
    assert_eq!(
        (area.hold, area.target),
        (Hold::Penalty(5e6), Target::Value(200.0))
    );
    let volume = a.effects.volume.unwrap();
    assert_eq!(
        (volume.hold, volume.target),
        (Hold::Exact, VolumeTarget::Reduced(0.6))
    );
    let difference = a.effects.area_difference.unwrap();
    assert_eq!(difference.hold, Hold::Penalty(0.3));
    assert_eq!(difference.target, AreaDifferenceTarget::Reduced(1.2));
    assert_eq!(
        (
            a.effects.tension.unwrap().value,
            a.effects.pressure.unwrap().value
        ),
        (1e-3, -0.5)
    );
    let gravity = a.effects.gravity.unwrap();
    assert_eq!(gravity.density_difference, 5e-11);
    assert_eq!(gravity.acceleration, [0.0, 0.0, -9.81e6]);
    let stretching = a.effects.stretching.as_ref().unwrap();
    assert_eq!(stretching.axis, [1.0, 0.0, 0.0]);
    assert_eq!(
        (&stretching.pull, stretching.ends),
        (&Pull::Forces(vec![0.0, 30.0]), Ends::Fraction(0.02))
    );
    assert_eq!(b.effects.area.unwrap().hold, Hold::Exact);
    assert_eq!(b.effects.area.unwrap().target, Target::Initial);
    assert_eq!(b.effects.volume.unwrap().target, VolumeTarget::Value(50.0));
    assert_eq!(b.effects.volume.unwrap().hold, Hold::Penalty(2.0));
    assert_eq!(
        b.effects.area_difference.unwrap().target,
        AreaDifferenceTarget::Initial
    );
}

#[test]
fn every_key_of_a_relaxation_is_read() {
    let file = valid(EVERYTHING);
    let scene = &file.scene;
    let repulsion = InteractionScene::Repulsion {
        strength: 0.1,
        cutoff: 0.2,
        between: Some([1.into(), 0.into()]),
        parts: true,
    };
    assert_eq!(scene.interactions, [repulsion]);
    let Driver::Relax(relax) = scene.driver else {
        panic!("{:?}", scene.driver);
    };
    assert_eq!(relax.scheme, Scheme::Overdamped);
    assert_eq!((relax.residual, relax.iterations), (1e-3, 7));
    assert!(!relax.redistribution);
    let output = &scene.output;
    assert_eq!(
        (output.every, output.checkpoint_every),
        (Every::Iterations(3), 11)
    );
    assert!(!output.surfaces);
    assert_eq!(output.pictures, Pictures::Never);
    assert_eq!(
        serde_json::to_value(output.picture_field).unwrap(),
        "bending-force"
    );
}

#[test]
fn automatic_choices_follow_the_effects() {
    let relax = |effects: &str| {
        let Driver::Relax(relax) = valid(&with(effects)).scene.driver else {
            panic!("another driver");
        };
        (relax.scheme, relax.redistribution)
    };
    let bending = |method: &str| format!("bending = {{ method = \"{method}\", modulus = 1 }}\n");
    assert_eq!(relax(&bending("B")), (Scheme::Minimise, true));
    assert_eq!(relax(&bending("J")), (Scheme::Overdamped, true));
    let elastic = bending("S") + "elasticity = { law = \"neo-hookean\", shear_modulus = 1 }";
    assert_eq!(relax(&elastic), (Scheme::Minimise, false));
}

#[test]
fn shipped_scenes_are_valid() {
    let all = shipped();
    assert!(all.len() >= 7);
    for (name, text) in &all {
        let file = SceneFile::parse(text, &folder().join(name), &Overrides::default());
        let file = file.unwrap_or_else(|errors| panic!("{errors}"));
        assert_eq!(file.warnings, [], "{name}");
        let meshes = Vec::from_iter((0..file.scene.surfaces.len()).map(|surface| {
            let info = generated(&file, surface);
            file.check_mesh(surface, &info)
                .unwrap_or_else(|errors| panic!("{errors}"));
            info
        }));
        let explanation = file.scene.explain(&meshes).to_string();
        assert!(explanation.starts_with(&file.scene.title), "{explanation}");
    }
}
