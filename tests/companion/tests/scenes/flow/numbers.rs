//! Quantities derived from the numbers of a scene, and warnings about them.

use super::super::{generated, parse, parse_with, valid};
use super::{capsule, driver, warned, warnings, with_flow};
use helfrich::Surface;
use helfrich_std::generate::{AnyShape, Family, generate};
use helfrich_std::info::MeshInfo;
use helfrich_std::scene::{Flow, Material, MeshSource};
use helfrich_std::simulation::Explanation;
use helfrich_std::simulation::build;
use helfrich_tests::tolerance::{self, Tolerance};

/// Volumes of smooth meshes of 10000 vertices against exact ones, relative.
const FINE_MESH_VOLUME: Tolerance = Tolerance::new(
    3e-3,
    "second order in edges of 0.04 of the size, and of 0.12 of a torus's tube radius",
);

/// Spectral radius estimated from the edge of the mean triangle, against that from the mean edge of an
/// icosphere, relative.
const MEAN_EDGE: Tolerance = Tolerance::new(
    4e-2,
    "edges differ by up to 16 %: their mean square exceeds the square of their mean by a hundredth, and \
     the cube of the edge enters",
);

#[test]
fn what_is_doubtful_in_flow_is_warned_of() {
    assert_eq!(warnings(&valid(&capsule(&[]))), [""; 0]);
    warned(
        &capsule(&[("method = \"B\"", "method = \"A\"")]),
        8,
        &["kantor-nelson (A)", "37 to 43 % too much"],
    );
    warned(
        &capsule(&[("strain = 4", "strain = 4\nvolume_correction = false")]),
        15,
        &["volumes drift"],
    );
    let held = capsule(&[
        ("strain = 4", "strain = 4\nvolume_correction = false"),
        ("[driver]", "volume.constraint = \"exact\"\n[driver]"),
    ]);
    assert_eq!(warnings(&valid(&held)), [""; 0]);
    warned(
        &capsule(&[("[driver]", "pressure.value = 1\n[driver]")]),
        10,
        &["`pressure` does nothing to \"capsule\""],
    );
    // Gravity gives no warning, because the fluid carries the weight.
    let heavy = capsule(&[(
        "[driver]",
        "gravity = { density_difference = 1, acceleration = [0, 0, -1] }\n[driver]",
    )]);
    assert_eq!(warnings(&valid(&heavy)), [""; 0]);

    let bending = "bending = { method = \"B\", modulus = 0.1125 }\n";
    let soft = capsule(&[(bending, "")]);
    warned(
        &soft,
        8,
        &["Ca_G = 0.150, below about 0.45", "add [surface.bending]"],
    );
    let fast = capsule(&[(bending, ""), ("rate = 0.15", "rate = 0.46")]);
    assert_eq!(warnings(&valid(&fast)), [""; 0]);

    for (method, part) in [
        ("B", "100 times shorter"),
        ("C", "200 times shorter"),
        ("E", "grow without limit"),
    ] {
        for family in ["irregular", "hard"] {
            let text = capsule(&[
                ("\"B\"", &format!("\"{method}\"")),
                ("\"regular\"", &format!("\"{family}\"")),
            ]);
            warned(
                &text,
                8,
                &["the mesh of \"capsule\" is uneven", part, "choose j4"],
            );
        }
    }
    let robust = capsule(&[("\"B\"", "\"j4\""), ("\"regular\"", "\"irregular\"")]);
    assert_eq!(warnings(&valid(&robust)), [""; 0]);
    // A mesh file is judged by its angles and valences.
    let file = valid(&capsule(&[]));
    let slivers = MeshInfo {
        angles: [2.0, 150.0],
        ..generated(&file, 0)
    };
    assert_eq!(file.mesh_warnings(0, &slivers).len(), 1);

    let tube = |radius: f64, through: f64| {
        with_flow(&format!(
            "kind = \"poiseuille\", centre_velocity = 1, radius = {radius}, direction = [1, 0, 0], through = [7, 0, {through}]"
        ))
    };
    assert_eq!(warnings(&valid(&tube(1.1, 0.0))), [""; 0]);
    warned(
        &tube(0.9, 0.0),
        13,
        &["\"capsule\" reaches 1.000 from the axis", "turns round"],
    );
    warned(&tube(1.1, 0.5), 13, &["reaches 1.500 from the axis"]);
}

/// A warning before the run says that drops are less accurate on uneven meshes. For capsules, the warning
/// comes from their bending method.
#[test]
fn uneven_meshes_of_drops_are_warned_of() {
    let elasticity = "elasticity = { law = \"neo-hookean\", shear_modulus = 1 }\n";
    let bending = "bending = { method = \"B\", modulus = 0.1125 }\n";
    let drop = |family: &str| {
        capsule(&[
            (elasticity, "tension.value = 1\n"),
            (bending, ""),
            ("\"regular\"", &format!("\"{family}\"")),
        ])
    };
    for even in ["regular", "smooth", "relaxed"] {
        assert_eq!(warnings(&valid(&drop(even))), [""; 0], "{even}");
    }
    for uneven in ["irregular", "hard"] {
        let found = warnings(&valid(&drop(uneven)));
        assert_eq!(found.len(), 1, "{uneven}: {found:?}");
        for part in [
            "the mesh of \"capsule\" is uneven",
            "3.3 %",
            "choose the family regular",
        ] {
            assert!(found[0].contains(part), "{uneven}: {}", found[0]);
        }
    }
}

#[test]
fn overrides_change_flow_surface_and_law() {
    let set = |overrides: &[&str]| {
        let file = parse_with(&capsule(&[]), overrides);
        file.unwrap_or_else(|errors| panic!("{errors}")).scene
    };
    let scene = set(&[
        "driver.flow.rate=0.3",
        "surface.0.bending.modulus=0.0025",
        "surface.0.vertices=2562",
        "surface.0.viscosity_ratio=5",
        "surface.0.elasticity.law=skalak",
        "surface.0.elasticity.area_ratio=1",
        "driver.strain=10",
    ]);
    let surface = &scene.surfaces[0];
    assert_eq!(driver(&scene).flow, Flow::Shear { rate: 0.3 });
    assert_eq!(driver(&scene).duration, 10.0 / 0.3);
    let bending = surface.effects.bending.as_ref().unwrap();
    assert_eq!(bending.modulus, Material::Number(0.0025));
    assert!(matches!(
        surface.source,
        MeshSource::Shape { vertices: 2562, .. }
    ));
    assert_eq!(surface.viscosity_ratio, Some(5.0));
    assert_eq!(
        surface
            .effects
            .elasticity
            .as_ref()
            .unwrap()
            .law
            .area_modulus(),
        3.0
    );
    let flow = driver(&set(&["driver.flow.kind=extension"])).flow;
    assert_eq!(flow, Flow::Extension { rate: 0.15 });
    let slice =
        capsule(&[]) + "[[output.slice]]\nnormal = [0, 0, 1]\nsize = [1, 1]\npoints = [2, 2]\n";
    let scene = parse_with(&slice, &["output.slice.slice-1.points=[5, 6]"]).unwrap();
    assert_eq!(scene.scene.output.slices[0].points, [5, 6]);
    let errors = parse_with(&capsule(&[]), &["surface.0.elasticity.law=skalak"]).unwrap_err();
    assert!(errors.to_string().contains("lacks `area_ratio`"));
}

#[test]
fn units_of_flows_are_checked() {
    let micro = capsule(&[("\"none\"", "\"micro\"")]);
    let error = |old: &str, new: &str| {
        let text = micro.replace(old, new);
        parse(&text).expect_err(&text).to_string()
    };
    for (old, new, part) in [
        (
            "viscosity = 1",
            "viscosity = \"1 Pa\"",
            "a viscosity, pressure·time in pN·s/µm² is needed, such as \"1.2 mPa s\"",
        ),
        (
            "rate = 0.15",
            "rate = \"3 s\"",
            "`rate` is a time, \"3 s\": a rate, 1/time in 1/s is needed, such as \"100 1/s\"",
        ),
        (
            "strain = 4",
            "duration = \"3 µm\"",
            "a time in s is needed, such as \"2 ms\"",
        ),
    ] {
        let message = error(old, new);
        assert!(message.contains(part), "{message}");
    }
}

/// The volume of a shape agrees with that of fine meshes, within their error of second order.
#[test]
fn shapes_have_the_volume_of_fine_meshes() {
    for shape in [
        "sphere:1.5",
        "ellipsoid:1,2,0.7",
        "torus:2,0.6",
        "discocyte:3.9",
    ] {
        let shape: AnyShape = shape.parse().unwrap();
        let error = |vertices| {
            let made = generate(&shape, Family::Smooth, vertices, 1).unwrap();
            let surface = Surface::new(&made.mesh, &made.positions).unwrap();
            1.0 - surface.volume().unwrap() / shape.volume()
        };
        let vertices = match shape {
            AnyShape::Torus(_) => [2500, 10_000],
            _ => [2562, 10_242],
        };
        let [coarse, fine] = vertices.map(error);
        FINE_MESH_VOLUME.assert(fine, 0.0, 1.0, &shape.to_string());
        let order = (coarse / fine).log2();
        assert!((order - 2.0).abs() < 0.2, "{shape}: {order}");
    }
}

#[test]
fn meshes_enclose_the_volume_of_their_shape() {
    for (shape, scale) in [("sphere:1", 1.0), ("ellipsoid:1,2,0.7", 3.0)] {
        let text = capsule(&[("sphere:1", shape)])
            .replace("vertices", &format!("scale = {scale}\nvertices"));
        let volume = |text: &str| {
            let (simulation, positions) = build(&valid(text)).unwrap();
            let body = &simulation.bodies()[0];
            (
                body.surface(&positions).unwrap().volume().unwrap(),
                simulation,
                positions,
            )
        };
        let expected = shape.parse::<AnyShape>().unwrap().volume() * f64::powi(scale, 3);
        let (found, mut simulation, positions) = volume(&text);
        tolerance::SCENE_NUMBER.assert(found, expected, expected, shape);
        // The scaled mesh is the stress-free reference.
        let acting = simulation.resolve(&positions);
        let elastic = acting.iter().find(|acting| acting.effect == "elasticity");
        let elastic = elastic.unwrap().energy;
        tolerance::SCENE_NUMBER.assert(elastic, 0.0, expected, shape);
        let (inscribed, ..) = volume(&text.replace("match_volume = true\n", ""));
        assert!(inscribed < expected * (1.0 - 1e-3), "{shape}: {inscribed}");
        // A reference on a named shape is scaled like the surface.
        let named = text.replace(
            "shear_modulus = 1",
            &format!("shear_modulus = 1, reference = {{ shape = \"{shape}\", scale = {scale} }}"),
        );
        let (_, mut simulation, positions) = volume(&named);
        let elastic = simulation.resolve(&positions)[1].energy;
        tolerance::SCENE_NUMBER.assert(elastic, 0.0, expected, shape);
    }
}

fn explained(text: &str) -> Explanation {
    let file = valid(text);
    file.scene.explain(&[generated(&file, 0)])
}

fn group(explanation: &Explanation, name: &str, formula: &str) -> Option<f64> {
    let groups = &explanation.surfaces[0].groups;
    let found =
        |group: &&helfrich_std::scene::Group| group.name == name && group.formula == formula;
    groups.iter().find(found).map(|group| group.value)
}

/// Boussinesq numbers are the membrane's viscosities over μa, on a sphere of radius 2.
#[test]
fn boussinesq_numbers_are_those_of_the_membrane() {
    let explanation = explained(&capsule(&[
        ("sphere:1", "sphere:2"),
        (
            "match_volume = true",
            "match_volume = true\nmembrane_viscosity = { shear = 6, dilational = 3 }",
        ),
    ]));
    for (name, formula, expected) in [
        ("Boussinesq number, shear", "η_s/(μa)", 3.0),
        ("Boussinesq number, dilation", "η_d/(μa)", 1.5),
    ] {
        let found = group(&explanation, name, formula).unwrap_or_else(|| panic!("{formula}"));
        tolerance::SCENE_NUMBER.assert(found, expected, expected, formula);
    }
}

/// Dimensionless groups of the paper's case in both conventions, and the results of theory.
#[test]
fn groups_are_named_by_both_conventions() {
    let explanation = explained(&capsule(&[]));
    let cases = [
        ("capillary number by G", "Ca_G = μγ̇a/G", 0.15),
        ("capillary number by E_s = 3 G", "Ca_E = μγ̇a/E_s", 0.05),
        ("bending number by G", "b = κ/(a² G)", 0.1125),
        ("bending number by E_s = 3 G", "κ/(a² E_s)", 0.0375),
        ("capillary number by κ", "Ca_κ = μγ̇a³/κ", 4.0 / 3.0),
        ("viscosity inside over that of the driver", "λ", 1.0),
        (
            "expected D, theory for Ca_G → 0",
            "(25/12) Ca_G/(1 + 11 b)",
            0.3125 / 2.2375,
        ),
    ];
    for (name, formula, expected) in cases {
        let found = group(&explanation, name, formula).unwrap_or_else(|| panic!("{formula}"));
        tolerance::SCENE_NUMBER.assert(found, expected, expected, formula);
    }
    let text = explanation.to_string();
    for part in [
        "sphere:1, regular, of its volume",
        "Reynolds number 0",
        "volumes kept to rounding",
        "strain = 4",
        "shear, u = (γ̇ y, 0, 0); rate = 0.15",
        "rkc2: \"capsule\" bends",
        "output interval = 0.26667",
        "a factor of 3",
        "theory",
        "λ",
    ] {
        assert!(text.contains(part), "`{part}` is not in:\n{text}");
    }
    // Skalak's law with C = 2, without bending, and with another size.
    let text = capsule(&[
        ("bending = { method = \"B\", modulus = 0.1125 }\n", ""),
        (
            "\"neo-hookean\", shear_modulus = 1",
            "\"skalak\", shear_modulus = 3, area_ratio = 2",
        ),
        ("sphere:1", "sphere:2"),
    ]);
    let explanation = explained(&text);
    let found = group(
        &explanation,
        "expected D, theory for Ca_G → 0",
        "(5/4)(2 + 3 C) Ca_G/(1 + 2 C + (15 + 18 C) b)",
    );
    let expected = 1.25 * 8.0 * 0.1 / 5.0;
    tolerance::SCENE_NUMBER.assert(found.unwrap(), expected, expected, "Skalak");
    assert!(explanation.to_string().contains("bs23: nothing bends"));
    // There is no theory for other shapes and flows, further effects, or a reference that is not the sphere
    // itself.
    for text in [
        capsule(&[("sphere:1", "ellipsoid:1,1,0.9")]),
        with_flow("kind = \"extension\", rate = 0.15"),
        capsule(&[("[driver]", "tension.value = 1\n[driver]")]),
        capsule(&[(
            "shear_modulus = 1",
            "shear_modulus = 1, reference.scale = 0.9",
        )]),
    ] {
        let text = explained(&text).to_string();
        assert!(!text.contains("expected D"), "{text}");
        assert!(!text.contains("the theory overestimates"), "{text}");
    }
}

/// `ρ/γ̇ = (1/Ca) max{0.355 (K_s/G + 1)(a/h), 2.65 b (a/h)³}` for method B on icospheres, whose mean edge is
/// nearly h.
#[test]
fn the_step_limit_is_estimated() {
    for (rate, b, law, ratio) in [
        (0.15, 0.1125, "law = \"neo-hookean\"", 3.0),
        (0.6, 1e-4, "law = \"skalak\", area_ratio = 1.5", 4.0),
    ] {
        let text = capsule(&[
            ("rate = 0.15", &format!("rate = {rate}")),
            ("modulus = 0.1125", &format!("modulus = {b}")),
            ("law = \"neo-hookean\"", law),
        ]);
        let file = valid(&text);
        let MeshSource::Shape {
            shape,
            family,
            vertices,
            seed,
            ..
        } = &file.scene.surfaces[0].source
        else {
            panic!("no shape");
        };
        let made = generate(shape, *family, *vertices, *seed).unwrap();
        let surface = Surface::new(&made.mesh, &made.positions).unwrap();
        let edges = made.mesh.edges();
        let length = |edge: &[u32; 2]| {
            let [x, y, z] = surface.difference(edge[0], edge[1]);
            x.hypot(y).hypot(z)
        };
        let fine = edges.len() as f64 / edges.iter().map(length).sum::<f64>();
        // μ = a = G = 1.
        let capillary = rate;
        let stretch: f64 = 0.355 * (ratio + 1.0) * fine;
        let bending = 2.65 * b * fine.powi(3);
        let expected = rate / capillary * stretch.max(bending);
        let explanation = explained(&text);
        let found = explanation.spectral_radius.unwrap();
        MEAN_EDGE.assert(found, expected, expected, law);
        assert!(
            explanation.step_limit.contains("estimate Δt = "),
            "{}",
            explanation.step_limit
        );
    }
    // p(0.9 r_c) = 10 G/a, and −p' d = 18.816 p there, times 0.14921 for the fastest relaxing wave.
    let second = "\n[[surface]]\nname = \"other\"\nshape = \"sphere:1\"\nfamily = \"regular\"\n\
                  vertices = 642\nmatch_volume = true\nposition = [3, 0, 0]\nelasticity = { law = \"neo-hookean\", \
                  shear_modulus = 1 }\n[[interaction]]\nkind = \"repulsion\"\ncutoff = 0.5\n";
    let (q, cutoff) = (0.81_f64, 0.5);
    let part = 0.5 * cutoff * (1.0 - q).powi(2) * (1.0 + 2.0 * q) / q.powf(1.5);
    let text = capsule(&[("modulus = 0.1125", "modulus = 1e-4")])
        + second
        + &format!("strength = {}\n", 10.0 / part);
    let file = valid(&text);
    let infos = [0, 1].map(|surface| generated(&file, surface));
    let found = file.scene.explain(&infos).spectral_radius.expect("one");
    assert!((found / (0.14921 * 188.16) - 1.0).abs() < 1e-3, "{found}");
    for text in [
        capsule(&[("\"B\"", "\"J\"")]),
        capsule(&[("\"regular\"", "\"irregular\"")]),
    ] {
        let explanation = explained(&text);
        assert_eq!(explanation.spectral_radius, None);
        assert!(explanation.step_limit.contains("power iteration"));
    }
}
