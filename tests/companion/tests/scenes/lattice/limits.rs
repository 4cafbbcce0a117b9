//! Warnings about lattices, default steps, and their explanations.

use super::super::valid;
use super::{capsule, driver, placed, warned_beyond, warnings};
use helfrich_std::info::MeshInfo;
use helfrich_std::simulation::Explanation;
use helfrich_tests::tolerance;

/// A membrane that resists shear alone is too stiff on a lattice, and somewhat too stiff on a coarse mesh:
/// the limits of docs/FLOW.md, from η_s/(μa) of about 2 and 5 on. The radius is that of the mesh's volume.
#[test]
fn membranes_that_lock_are_warned_of() {
    let with = |viscosity: &str| {
        let lines = format!("membrane_viscosity = {{ {viscosity} }}\n[driver]");
        capsule(&[("[driver]", &lines)])
    };
    for fine in [
        "shear = 1",
        "shear = 20, dilational = 20",
        "shear = 20, dilational = 2.1",
    ] {
        assert_eq!(warnings(&with(fine)), [""; 0], "{fine}");
    }
    for locked in ["shear = 2.1", "shear = 20", "shear = 20, dilational = 1"] {
        let found = warnings(&with(locked));
        assert_eq!(found.len(), 1, "{locked}: {found:?}");
        for part in [
            "0.99, 0.83, 0.55 and 0.22",
            "a `dilational` of the order of `shear`",
            "more nodes per radius",
        ] {
            assert!(found[0].contains(part), "{locked}: {}", found[0]);
        }
    }
}

/// Each limit of the valid range, with a value on either side of it. Limits are computed by hand with a = μ =
/// G = 1, edges of 0.151, and a spacing of 1/6 unless another is set.
#[test]
fn steps_beyond_what_the_fluid_allows_are_warned_of() {
    assert_eq!(warnings(&capsule(&[])), [""; 0]);
    let soft = ("modulus = 0.1125", "modulus = 1e-4");
    let slow = ("rate = 0.15", "rate = 1e-3");
    let with = |lines: &str| format!("resolution = 6\n{lines}");
    // 3 G ν step/(μ a), which is 0.01 at a step of 1/60.
    warned_beyond(
        &[
            soft,
            slow,
            ("resolution = 6", &with("lattice_viscosity = 0.2\nstep = ?")),
        ],
        ["0.0166", "0.0168"],
        17,
        &[
            "3 P = 0.0101",
            "a `step` of 0.0167, or a `lattice_viscosity` of 0.198",
        ],
    );
    // With a density 3 G step²/(a ρ spacing²): here at a step of √(0.01/(3·36)) = 0.009623.
    warned_beyond(
        &[
            soft,
            slow,
            ("resolution = 6", &with("density = 1\nstep = ?")),
        ],
        ["0.0096", "0.0097"],
        17,
        &[
            "3 P = 0.0102",
            "a `step` of 0.00962, which is a viscosity of 0.346",
        ],
    );
    // √3 γ̇ L/2 step/spacing, which is 0.1 at a step of 0.01833.
    warned_beyond(
        &[
            soft,
            ("shear_modulus = 1", "shear_modulus = 0.01"),
            ("resolution = 6", &with("lattice_viscosity = 1\nstep = ?")),
        ],
        ["0.0182", "0.0185"],
        17,
        &[
            "the walls move with a Mach number of 0.101",
            "a `step` of 0.0183",
        ],
    );
    // γ̇ a² step/(ν spacing²), which is 0.2 at a step of 0.003704.
    warned_beyond(
        &[
            soft,
            ("resolution = 6", &with("lattice_viscosity = 0.1\nstep = ?")),
        ],
        ["0.0036", "0.0038"],
        17,
        &[
            "a Reynolds number γ̇a²/ν of 0.205",
            "a `step` of 0.0037, a `lattice_viscosity` of 0.103, or a `resolution` of 5.92",
        ],
    );
}

#[test]
fn steps_beyond_what_membranes_allow_are_warned_of() {
    let soft = ("modulus = 0.1125", "modulus = 1e-4");
    let slow = ("rate = 0.15", "rate = 1e-3");
    let with = |lines: &str| format!("resolution = 6\n{lines}");
    // (K_s + G) step/(μ spacing) may be 0.5; twice that, at a step of 1/24, is too much.
    warned_beyond(
        &[
            soft,
            slow,
            (
                "resolution = 6",
                &with("lattice_viscosity = 0.05\nstep = ?"),
            ),
        ],
        ["0.0412", "0.0421"],
        17,
        &[
            "more than twice 0.0208, which the elasticity of \"capsule\" allows",
            "choose a `step` of 0.0208, or fewer `vertices`",
        ],
    );
    // κ step/(μ spacing edge²) may be 0.09/ν; twice that is too much.
    let edge = equilateral_edge(&placed(&capsule(&[])));
    let most = 2.0 * 0.45 * edge * edge / 6.0;
    warned_beyond(
        &[
            ("modulus = 0.1125", "modulus = 1"),
            ("resolution = 6", &with("lattice_viscosity = 0.2\nstep = ?")),
        ],
        [&(0.99 * most).to_string(), &(1.01 * most).to_string()],
        17,
        &["which the bending of \"capsule\" allows"],
    );
}

#[test]
fn edges_and_boxes_out_of_range_are_warned_of() {
    // Edges are 0.151 long.
    warned_beyond(
        &[("resolution = 6", "resolution = ?")],
        ["9.9", "10.1"],
        6,
        &[
            "1.52 nodes long",
            "fluid leaks",
            "more `vertices`, 2562 say, or a `resolution` of 9.9",
        ],
    );
    warned_beyond(
        &[("resolution = 6", "spacing = ?")],
        ["0.49", "0.51"],
        6,
        &[
            "0.295 nodes long",
            "fewer `vertices`, or a `spacing` of 0.251",
        ],
    );
    for (axis, lengths) in [("x", "[?, 7, 7]"), ("y", "[7, ?, 7]"), ("z", "[7, 7, ?]")] {
        let what = if axis == "y" { "walls" } else { "images" };
        warned_beyond(
            &[(
                "resolution = 6",
                &format!("resolution = 6\nbox = {lengths}"),
            )],
            ["6.95", "6.5"],
            16,
            &[
                &format!(
                    "6.5 radii of \"capsule\" long along {axis}, below 7: it is influenced by its {what}"
                ),
                "D by about 2.4 (a/L)³ = 0.00874",
            ],
        );
    }
    // The walls act on a drop by another law, and by none that is known on a vesicle.
    let walled = ("resolution = 6", "resolution = 6\nbox = [7, 4, 7]");
    let elasticity = "elasticity = { law = \"neo-hookean\", shear_modulus = 1 }";
    let bending = "bending = { method = \"B\", modulus = 0.1125 }\n";
    let drop = [
        walled,
        (bending, ""),
        (elasticity, "tension = { value = 1 }"),
    ];
    let vesicle = [walled, (elasticity, "local_area = { modulus = 1 }")];
    for (surface, law) in [
        (
            &drop[..],
            ", D by about the fraction 5.7 (1 + 2.5 λ)/(1 + λ) (a/L)³ = 0.156:",
        ),
        (&vesicle, "influenced by its walls: choose 7"),
    ] {
        let found = warnings(&capsule(surface));
        let found = Vec::from_iter(
            found
                .iter()
                .filter(|warning| warning.contains("the box is")),
        );
        assert!(found.len() == 1 && found[0].contains(law), "{found:?}");
    }
    // The walls of a channel are meant to influence the flow.
    let channel = "kind = \"channel\", centre_velocity = 0.1";
    let channel = capsule(&[
        ("kind = \"shear\", rate = 0.15", channel),
        ("resolution = 6", "resolution = 6\nbox = [7, 3, 7]"),
    ]);
    assert_eq!(warnings(&channel), [""; 0]);
    // Nodes are counted in the radius of the smaller of two surfaces, in either order.
    for [first, second] in [[1.0, 0.5], [0.5, 1.0]] {
        let pair = [
            ("sphere:1", &*format!("sphere:{first}")),
            ("resolution = 6", "resolution = 6\nbox = [9, 7, 7]"),
            (
                "[driver]",
                &format!(
                    "[[surface]]\nname = \"other\"\nshape = \"sphere:{second}\"\nvertices = 642\n\
                     position = [3, 0, 0]\ntension = {{ value = 1 }}\n[driver]"
                ),
            ),
        ];
        let spacing = driver(&valid(&capsule(&pair)).scene).spacing;
        tolerance::SCENE_NUMBER.assert(spacing, 0.5 / 6.0, 1.0, "spacing");
    }
    // Only warnings of the scene itself: the mesh would be too coarse for this resolution, too.
    let large = valid(&capsule(&[("resolution = 6", "resolution = 250")]));
    let [message] = large.warnings.as_slice() else {
        panic!("{:?}", large.warnings);
    };
    let message = message.to_string();
    for part in [
        "the lattice takes 1070 GB of memory",
        "`precision` = \"f32\"",
        "a `spacing` of",
    ] {
        assert!(message.contains(part), "`{part}` is not in: {message}");
    }
}

#[test]
fn viscosities_and_inertia_out_of_range_are_warned_of() {
    let with = |lines: &str| format!("resolution = 6\n{lines}");
    for range in [["0.021", "0.019"], ["0.99", "1.01"]] {
        warned_beyond(
            &[("resolution = 6", "resolution = 6\nlattice_viscosity = ?")],
            range,
            16,
            &[
                "best lies between 0.02 and 1",
                "choose a `lattice_viscosity` of ",
            ],
        );
    }
    // ρ γ̇ a²/μ.
    warned_beyond(
        &[("resolution = 6", "resolution = 6\ndensity = ?")],
        ["0.66", "0.68"],
        16,
        &[
            "Reynolds number ργ̇a²/μ of \"capsule\" is 0.102",
            "leave `density` out",
        ],
    );
    for (range, change) in [
        (["4.9", "5.1"], "choose a `lattice_viscosity` of 0.196"),
        (["0.11", "0.09"], "choose a `lattice_viscosity` of 0.222"),
        (["1", "60"], "no viscosity outside is right for both"),
    ] {
        warned_beyond(
            &[
                (
                    "match_volume = true",
                    "match_volume = true\nviscosity_ratio = ?",
                ),
                ("resolution = 6", &with("lattice_viscosity = 0.2")),
            ],
            range,
            8,
            &["inside of \"capsule\"", change],
        );
    }
    let resting = &[
        ("kind = \"shear\", rate = 0.15", "kind = \"?\""),
        ("strain = 4", "duration = 1"),
        (
            "match_volume = true",
            "match_volume = true\ngravity = { density_difference = 1, acceleration = [1, 0, 0] }",
        ),
    ];
    warned_beyond(
        resting,
        [
            "channel\", centre_velocity = 0.1, section = \"plates",
            "quiescent",
        ],
        8,
        &["in a box without walls nothing carries it"],
    );
}

/// The repulsion has p(r_c/2) = 27/8 k r_c = 10 P, with P = G/a. There −p' is 11/3 p/(r_c/2), and acts on
/// √3/2 (1/6)² per vertex on nodes 1/6 apart.
#[test]
fn the_repulsion_limits_the_step() {
    let cutoff = 0.03;
    let repelled = |step: &str| {
        let nodes = format!("resolution = 6\n{step}");
        let strength = 10.0 * 8.0 / (27.0 * cutoff);
        capsule(&[
            ("modulus = 0.1125", "modulus = 1e-4"),
            ("resolution = 6", &nodes),
        ]) + &format!(
            "[[interaction]]\nkind = \"repulsion\"\nstrength = {strength}\ncutoff = {cutoff}\n"
        )
    };
    let stiffness = 0.75_f64.sqrt() / 36.0 * (11.0 / 3.0) * 10.0 / (0.5 * cutoff);
    let expected = 1.0 / (6.0 * stiffness);
    let text = repelled("");
    let explanation = explained(&text);
    let limits = explanation
        .lattice
        .as_ref()
        .expect("a lattice")
        .limits
        .iter();
    let found = limits.min_by(|a, b| a.step.total_cmp(&b.step)).unwrap();
    assert_eq!(found.name, "repulsion");
    tolerance::SCENE_NUMBER.assert(found.step, expected, expected, "step");
    assert!(explanation.step_limit.starts_with("repulsion"));
    let step = driver(&valid(&text).scene).step;
    assert!((0.8..=0.9).contains(&(step / expected)), "{step}");
    assert_eq!(warnings(&text), [""; 0]);
    for (factor, count) in [(1.9, 0), (2.1, 1)] {
        let said = warnings(&repelled(&format!("step = {}", factor * expected)));
        assert_eq!(said.len(), count, "{said:?}");
        let names =
            |warning: &String| warning.contains("which the repulsion of \"capsule\" allows");
        assert!(said.iter().all(names), "{said:?}");
    }
}

/// A pressure of 10 P = 10 G/a compresses the adhesion to q = 2, where V″ = 12 W/λ². It acts on √3/2 (1/6)²
/// per vertex on nodes 1/6 apart.
#[test]
fn adhesion_limits_the_step() {
    let range = 0.03;
    let adhering = |step: &str| {
        let nodes = format!("resolution = 6\n{step}");
        let strength = 10.0 * range / 4.0;
        let adhesion = format!(
            "adhesion = {{ strength = {strength}, distance = 0.1, range = {range}, wall = [0, 0, -1.5] }}"
        );
        let bending = "bending = { method = \"B\", modulus = 0.1125 }";
        capsule(&[(bending, &adhesion), ("resolution = 6", &nodes)])
    };
    let stiffness = 0.75_f64.sqrt() / 36.0 * 12.0 * 10.0 / (4.0 * range);
    let expected = 1.0 / (6.0 * stiffness);
    let text = adhering("");
    let explanation = explained(&text);
    assert!(explanation.step_limit.starts_with("adhesion"));
    let lattice = explanation.lattice.expect("a lattice");
    let found = lattice.limits.iter().find(|limit| limit.name == "adhesion");
    let found = found.expect("a limit").step;
    tolerance::SCENE_NUMBER.assert(found, expected, expected, "step");
    let step = driver(&valid(&text).scene).step;
    assert!((0.8..=0.9).contains(&(step / expected)), "{step}");
    // Only warnings about adhesion are counted; there is also one about missing bending.
    for (step, count) in [
        (String::new(), 0),
        (format!("step = {}", 1.9 * expected), 0),
        (format!("step = {}", 2.1 * expected), 1),
    ] {
        let said = warnings(&adhering(&step));
        let names =
            |warning: &&String| warning.contains("which the adhesion of \"capsule\" allows");
        assert_eq!(said.iter().filter(names).count(), count, "{said:?}");
    }
}

/// Edge length of an equilateral triangle of the mean area.
fn equilateral_edge(mesh: &MeshInfo) -> f64 {
    (4.0 * mesh.area / (3_f64.sqrt() * mesh.triangles as f64)).sqrt()
}

/// The default step is the longest that all limits allow, less a tenth, and shortened to divide the output
/// interval.
#[test]
fn the_default_step_obeys_all_limits() {
    let soft = ("modulus = 0.1125", "modulus = 1e-4");
    let thin = ("resolution = 6", "resolution = 6\nlattice_viscosity = 0.1");
    let thinner = ("resolution = 6", "resolution = 6\nlattice_viscosity = 0.05");
    let thick = ("resolution = 6", "resolution = 6\nlattice_viscosity = 1");
    let edge = equilateral_edge(&placed(&capsule(&[])));
    for (replacements, name, limit) in [
        (
            &[][..],
            "bending",
            3.0 * 0.09 * edge * edge / (6.0 * 0.1125),
        ),
        (&[soft], "compressibility", 0.01),
        (&[soft, thick], "compressibility", 0.01 / 3.0),
        (
            &[soft, thin],
            "inertia of the lattice",
            0.02 / (36.0 * 0.15),
        ),
        (
            &[soft, thinner, ("rate = 0.15", "rate = 1e-3")],
            "elasticity",
            0.5 / (6.0 * 4.0),
        ),
        (
            &[soft, thick, ("shear_modulus = 1", "shear_modulus = 0.01")],
            "Mach number",
            0.1 / (6.0 * 3_f64.sqrt() * 0.525),
        ),
        (
            &[soft, ("resolution = 6", "resolution = 6\ndensity = 0.5")],
            "compressibility",
            (0.01 * 0.5 / 3.0_f64).sqrt() / 6.0,
        ),
    ] {
        let text = capsule(replacements);
        let explanation = explained(&text);
        let lattice = explanation.lattice.as_ref().unwrap();
        let shortest = lattice
            .limits
            .iter()
            .min_by(|a, b| a.step.total_cmp(&b.step));
        assert_eq!(shortest.unwrap().name, name);
        tolerance::SCENE_NUMBER.assert(shortest.unwrap().step, limit, limit, name);
        assert!(
            explanation.step_limit.starts_with(name),
            "{}",
            explanation.step_limit
        );
        let scene = valid(&text).scene;
        let step = driver(&scene).step;
        if driver(&scene).density.is_none() {
            assert!(
                (0.8..=0.9).contains(&(step / limit)),
                "{name}: {step} of {limit}"
            );
        } else {
            // The step is limited by the lattice viscosity of 1/3.
            tolerance::SCENE_NUMBER.assert(
                driver(&scene).lattice_viscosity,
                step * 36.0 / 0.5,
                1.0,
                name,
            );
            assert!((0.32..=0.34).contains(&driver(&scene).lattice_viscosity));
        }
        assert_eq!(warnings(&text), [""; 0]);
    }
}

fn explained(text: &str) -> Explanation {
    valid(text).scene.explain(&[placed(text)])
}

#[test]
fn explanations_have_the_numbers_of_the_lattice() {
    let lines = "resolution = 6\nlattice_viscosity = 0.2\nstep = 0.002";
    let text = capsule(&[("resolution = 6", lines)]);
    let explanation = explained(&text);
    let lattice = explanation.lattice.as_ref().unwrap();
    let number = |formula: &str| {
        let found = lattice.groups.iter().find(|group| group.formula == formula);
        found.unwrap_or_else(|| panic!("{formula}")).value
    };
    let edge = equilateral_edge(&placed(&capsule(&[])));
    for (formula, expected) in [
        ("a_min/spacing", 6.0),
        ("h/spacing", 6.0 * edge),
        ("L_x/a", 7.0),
        ("L_y/a", 7.0),
        ("L_z/a", 7.0),
        ("ν", 0.2),
        ("τ = 3 ν + 1/2", 1.1),
        ("γ̇ step", 3e-4),
        ("√3 U step/spacing", 3_f64.sqrt() * 0.525 * 0.012),
        // Without a density, ρ is 0.002·5·36.
        ("3 P step²/(ρ spacing²)", 3.0 * 0.012_f64.powi(2) / 0.36),
        ("γ̇ a² step/(ν spacing²)", 3e-4 * 36.0 * 5.0),
        ("D(L_y) − D(∞) = 2.4 (a/L_y)³", 2.4 / 343.0),
    ] {
        tolerance::SCENE_NUMBER.assert(number(formula), expected, expected, formula);
    }
    // The run lasts 80/3 units of time.
    assert_eq!(lattice.steps, 13_334);
    let nodes = 42_f64.powi(3);
    assert!(lattice.throughput > 0.0 && lattice.coupling > 0.0);
    // Measured costs of nodes and coupling, and 2e-7 seconds per vertex.
    let step = nodes / lattice.throughput + lattice.coupling + 642.0 * 2e-7;
    let minutes = step * 13_334.0 / 60.0;
    tolerance::SCENE_NUMBER.assert(lattice.minutes, minutes, minutes, "minutes");
    // Nineteen populations, three times while a checkpoint is written, a force and a velocity per node; rows and planes are
    // padded.
    let least = nodes * (3.0 * 19.0 + 6.0) * 8.0;
    let found = explanation.memory as f64;
    assert!((1.0..1.2).contains(&(found / least)), "{found} for {least}");
    let half = text.replace("step =", "precision = \"f32\"\nstep =");
    let half = explained(&half).memory as f64;
    assert!((0.5..0.6).contains(&(half / found)), "{half} of {found}");
    let shown = explanation.to_string();
    for part in [
        "lattice-boltzmann   Stokes flow in a box, volumes kept to rounding",
        "42 × 42 × 42 nodes in f64, walls at the ends of y, kernel of 2 nodes an axis",
        "viscosity on the lattice                      0.2  ν",
        "step limit          inertia of the lattice; compressibility = 0.016667 (",
        "13334 steps",
        "step = 0.002, output interval = 0.26667",
        "Ca_G = μγ̇a/G",
    ] {
        assert!(shown.contains(part), "`{part}` is not in:\n{shown}");
    }
    // With a density, the Reynolds number is that of the fluid.
    let heavy = capsule(&[("resolution = 6", "resolution = 6\ndensity = 0.5")]);
    let heavy = explained(&heavy).lattice.unwrap().groups;
    let found = heavy.iter().find(|group| group.formula == "Re = ρ γ̇ a²/μ");
    tolerance::SCENE_NUMBER.assert(found.unwrap().value, 0.075, 0.075, "Re");
    // Other drivers have no such explanation.
    let integral = capsule(&[
        ("lattice-boltzmann", "boundary-integral"),
        ("resolution = 6\n", ""),
    ]);
    assert_eq!(explained(&integral).lattice, None);
}
