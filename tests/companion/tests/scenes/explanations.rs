//! Explanations of scenes.

use super::{generated, refused, valid, with};
use helfrich_std::info::MeshInfo;
use helfrich_std::scene::Effects;

#[test]
fn explanations_name_effects_and_groups() {
    let file = valid(&with(
        "[surface.bending]\nmethod = \"B\"\nmodulus = 0.5\nspontaneous_curvature = 0.25\n\
         [surface.elasticity]\nlaw = \"neo-hookean\"\nshear_modulus = 2\n\
         [surface.volume]\nconstraint = \"exact\"\nreduced = 0.9\n\
         [surface.area]\nmodulus = 3\n",
    ));
    // The area and volume of an exact sphere of radius 3.
    let pi = std::f64::consts::PI;
    let mesh = MeshInfo {
        area: 36.0 * pi,
        volume: Some(36.0 * pi),
        ..generated(&file, 0)
    };
    let explanation = file.scene.explain(&[mesh]);
    let surface = &explanation.surfaces[0];
    let on = Vec::from_iter(surface.on.iter().map(|effect| effect.name));
    assert_eq!(on, ["bending", "elasticity", "area", "volume"]);
    assert_eq!(surface.off.len(), Effects::NAMES.len() - 4);
    let group = |formula: &str| {
        let found = surface.groups.iter().find(|group| group.formula == formula);
        found.unwrap_or_else(|| panic!("{formula}")).value
    };
    let close = |formula: &str, expected: f64| {
        let found = group(formula);
        assert!(
            (found / expected - 1.0).abs() < 1e-12,
            "{formula}: {found} for {expected}"
        );
    };
    close("6√π V/A^(3/2)", 1.0);
    close("6√π V0/A^(3/2)", 0.9);
    close("c0 R = 2 H0 R", 1.5);
    close("b = κ/(R² G)", 0.5 / 18.0);
    close("κ/(R² 3 G)", 0.5 / 54.0);
    close("K_s/G", 3.0);
    // Y = 3 G for an incompressible sheet.
    close("γ = Y R²/κ, Y = 4 K_s G/(K_s + G)", 6.0 * 9.0 / 0.5);
    close("k R²/κ", 54.0);
    let text = explanation.to_string();
    for part in [
        "off: gaussian_bending, local_area, area_difference",
        "step limit          none",
        "modulus = 0.5 pN·µm",
        "memory",
    ] {
        assert!(text.contains(part), "`{part}` is not in:\n{text}");
    }
}

/// kT is that at 298.15 K, or at the temperature that the scene sets; k_B is 1.380649e-23 J/K by definition.
#[test]
fn thermal_energies_have_a_temperature() {
    let bending = "bending = { method = \"B\", modulus = \"20 kT\" }";
    for (temperature, kelvin, shown) in [
        ("", 298.15, "kT: 0.0041164 pN·µm, at 298.15 K"),
        (
            "temperature = 310.15\n",
            310.15,
            "kT: 0.0042821 pN·µm, at 310.15 K",
        ),
    ] {
        let file = valid(&format!("{temperature}{}", with(bending)));
        let bending = file.scene.surfaces[0].effects.bending.as_ref();
        let modulus = bending.unwrap().modulus.largest();
        let expected = 20.0 * 1.380649e-5 * kelvin;
        // The product is rounded in another order.
        assert!(
            (modulus / expected - 1.0).abs() < 4.0 * f64::EPSILON,
            "{modulus}"
        );
        assert_eq!(file.scene.temperature, Some(kelvin));
        let text = file.scene.explain(&[generated(&file, 0)]).to_string();
        assert!(text.contains(shown), "{text}");
    }
    let without = valid(&with("bending = { method = \"B\", modulus = 0.1 }"));
    assert_eq!(without.scene.temperature, None);
    let none = with("").replace("\"micro\"", "\"none\"");
    refused(
        &format!("temperature = 300\n{none}"),
        [1, 15],
        &["kT", "units = \"micro\""],
    );
    refused(
        &format!("temperature = 0\n{}", with("")),
        [1, 15],
        &["above 0"],
    );
}
