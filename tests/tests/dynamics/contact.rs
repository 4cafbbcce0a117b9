//! Contact between surfaces in a box of fluid, directly and through the ends of the periodic box.

use crate::scenes::{column, run_file};
use helfrich_std::dynamics::Problem;
use helfrich_std::run::End;
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_std::simulation::{Crossing, Simulation, build};
use helfrich_tests::meshes::{SplitMix64, norm};
use helfrich_tests::tolerance;
use std::path::Path;

/// Capsules of radius 1 in a box of fluid at rest that is periodic along all axes.
fn row(places: &[[f64; 3]], lengths: [f64; 3], more: &str) -> SceneFile {
    let surfaces = places.iter().enumerate().map(|(number, place)| {
        format!(
            "[[surface]]\nname = \"c{number}\"\nshape = \"sphere:1\"\nfamily = \"regular\"\n\
             vertices = 162\nposition = {place:?}\n\
             elasticity = {{ law = \"skalak\", shear_modulus = 1, area_ratio = 1 }}\n"
        )
    });
    let surfaces: String = surfaces.collect();
    let text = format!(
        "units = \"none\"\n{surfaces}{more}\n[driver]\nkind = \"lattice-boltzmann\"\nviscosity = 1\n\
         flow = {{ kind = \"quiescent\" }}\nspacing = 0.25\nbox = {lengths:?}\nduration = 0.01\n\
         [output]\ninterval = 0.01\npictures = false\nsurfaces = false\n"
    );
    let none = Overrides::default();
    let file = SceneFile::parse(&text, Path::new("row.toml"), &none);
    file.unwrap_or_else(|errors| panic!("{errors}"))
}

const REPULSION: &str = "[[interaction]]\nkind = \"repulsion\"\nstrength = 3\ncutoff = 0.7\n";

fn ready(file: &SceneFile) -> (Simulation, Vec<[f64; 3]>) {
    build(file).unwrap_or_else(|error| panic!("{error}"))
}

/// Warnings about overlaps, without the words that tell whether the overlap is through the ends of the box.
fn said(warnings: impl Iterator<Item = String>, what: &str) -> Vec<String> {
    let direct = |warning: String| {
        let through =
            [", through", " through"].map(|word| format!("{word} the ends of the periodic box"));
        through
            .iter()
            .fold(warning, |text, words| text.replace(words, ""))
    };
    warnings
        .filter(|warning| warning.contains(what))
        .map(direct)
        .collect()
}

/// Two surfaces that overlap through the ends of the box have the energy, forces and warnings of surfaces
/// that overlap directly, before and in a run.
#[test]
fn an_overlap_through_the_ends_is_one_inside() {
    let lengths = [6.0, 6.0, 7.0];
    let inside = row(&[[0.0; 3], [1.5, 0.0, 0.5]], lengths, REPULSION);
    let through = row(&[[0.0; 3], [-4.5, 6.0, -6.5]], lengths, REPULSION);
    let files = [&inside, &through];
    let [within, across] = files.map(|file| {
        let (mut simulation, positions) = ready(file);
        let mut force = vec![[0.0; 3]; positions.len()];
        let energy = simulation.evaluate(&positions, &mut force).energy;
        let warnings = simulation.warnings().iter().map(ToString::to_string);
        // The positions in the scene's text differ, so only the part from the first name on is compared.
        let said = said(warnings, "starts across");
        let messages = said.iter().map(|warning| {
            let start = warning.find("\"c").expect("a name");
            let end = warning.find('\n').unwrap_or(warning.len());
            warning[start..end].to_owned()
        });
        (energy, force, Vec::from_iter(messages))
    });
    assert!(within.0 > 0.1, "{}", within.0);
    tolerance::SAME.assert(across.0, within.0, within.0, "E");
    let largest = within.1.iter().map(|&f| norm(f)).fold(0.0, f64::max);
    for (a, b) in within.1.iter().flatten().zip(across.1.iter().flatten()) {
        tolerance::SAME.assert(*a, *b, largest, "F");
    }
    // One warning names both surfaces.
    assert_eq!(within.2.len(), 1, "{:?}", within.2);
    assert_eq!(within.2, across.2);
    // The runs go without the repulsion, which would throw overlapping surfaces apart.
    let [within, across] = [inside, through].map(|mut file| {
        file.scene.interactions.clear();
        let (summary, _) = run_file(file);
        said(summary.warnings.into_iter(), "has gone into")
    });
    assert_eq!(within.len(), 2, "{within:?}");
    assert_eq!(within, across);
}

/// One warning names both overlaps in a row of three surfaces.
#[test]
fn every_pair_that_starts_across_is_named() {
    let places = [[0.0; 3], [1.5, 0.0, 0.0], [3.0, 0.0, 0.0]];
    let (simulation, _) = ready(&row(&places, [8.0, 4.0, 4.0], ""));
    let warnings = simulation.warnings().iter().map(ToString::to_string);
    let said = said(warnings, "starts across");
    let [warning] = said.as_slice() else {
        panic!("{said:?}");
    };
    assert!(warning.contains("\"c0\" starts across \"c1\""), "{warning}");
    assert!(
        warning.contains("(and so for \"c1\" and \"c2\")"),
        "{warning}"
    );
}

/// Runs `along`³ Skalak capsules of radius 1 in shear, at random angles. The run reaches its end without a
/// warning that one has gone into another or into an image.
fn stay_apart(along: u32, lengths: [f64; 3], capsule: &str, more: &str) {
    let mut random = SplitMix64::new(1);
    let mut text = "units = \"none\"\n".to_owned();
    for number in 0..along.pow(3) {
        // Along y, the layers next to the walls keep the same distance from walls as from each other, less
        // the width of the kernel.
        let place = [0, 1, 2].map(|axis| {
            let layer = f64::from(number / along.pow(axis) % along) - 0.5 * f64::from(along - 1);
            let shaken = if axis == 1 { 0.01 } else { 0.03 };
            let room = if axis == 1 { 0.95 } else { 1.0 };
            let length = lengths[axis as usize];
            layer * room * length / f64::from(along) + shaken * random.symmetric()
        });
        let axis = [0; 3].map(|_| random.symmetric());
        let angle = 180.0 * random.symmetric();
        text += &format!(
            "[[surface]]\nname = \"c{number}\"\nshape = \"sphere:1\"\nfamily = \"regular\"\n\
             match_volume = true\nposition = {place:?}\n\
             orientation = {{ axis = {axis:?}, angle = {angle} }}\n\
             elasticity = {{ law = \"skalak\", shear_modulus = 1, area_ratio = 1 }}\n{capsule}\n"
        );
    }
    text += &format!(
        "[[interaction]]\nkind = \"repulsion\"\nstrength = 3\n{more}\nkind = \"lattice-boltzmann\"\n\
         viscosity = 1\nflow = {{ kind = \"shear\", rate = 0.3 }}\nbox = {lengths:?}\n\
         precision = \"f32\"\n\
         [output]\nstrain_interval = 0.25\npictures = false\nsurfaces = false\n"
    );
    let none = Overrides::default();
    let file = SceneFile::parse(&text, Path::new("dense.toml"), &none);
    let (summary, series) = run_file(file.unwrap_or_else(|errors| panic!("{errors}")));
    assert_eq!(summary.end, End::Completed, "{}", summary.message);
    // They have come so close that the repulsion acts.
    let felt = column(&series, "energy_repulsion");
    assert!(felt.iter().any(|&energy| energy > 0.0), "{felt:?}");
    let gone = said(summary.warnings.into_iter(), "has gone into");
    assert_eq!(gone, [""; 0]);
}

/// Eight capsules fill 40 % of the volume without the layers at the walls. The meshes are so coarse that
/// vertices are farther apart than the repulsion's range.
#[test]
fn dense_suspensions_stay_apart() {
    let capsule = "vertices = 42\nbending = { method = \"gompper-kroll\", modulus = 0.01 }";
    let more = "cutoff = 0.3\n[driver]\nspacing = 0.25\nstrain = 1";
    stay_apart(2, [4.4, 5.0, 4.4], capsule, more);
}

/// 27 capsules with 42 % of the volume, without bending, so that they crumple.
#[test]
#[ignore = "three minutes: by .ci/long"]
fn dense_suspensions_stay_apart_for_long() {
    let more = "cutoff = 0.2\n[driver]\nspacing = 0.2\nstrain = 6";
    stay_apart(3, [6.4, 6.6, 6.4], "vertices = 162", more);
}

/// In a periodic row, every capsule is as far from the next as the last from the image of the first, so that
/// the net repulsion on each vanishes, also for a single capsule and its own images.
#[test]
fn a_symmetric_row_is_not_pushed() {
    for count in [1, 3] {
        let distance = 2.25;
        let places = Vec::from_iter((0..count).map(|k| [f64::from(k) * distance, 0.0, 0.0]));
        let lengths = [f64::from(count) * distance, 4.0, 4.0];
        let (mut simulation, positions) = ready(&row(&places, lengths, REPULSION));
        assert_eq!(simulation.crossings(&positions), []);
        let acting = simulation.resolve(&positions);
        let repulsion = acting.last().expect("the repulsion");
        assert!(repulsion.between && repulsion.energy > 0.0);
        for body in simulation.bodies() {
            let force = repulsion.on(body);
            let net = [0, 1, 2].map(|axis| force.iter().map(|f| f[axis]).sum::<f64>());
            let scale = force.iter().map(|&f| norm(f)).sum::<f64>();
            assert!(scale > 0.0);
            tolerance::SAME.assert(norm(net), 0.0, scale, "net force");
        }
    }
}

/// A surface that is stretched along the box overlaps its own next image.
#[test]
fn surfaces_are_seen_in_their_own_images() {
    let (simulation, mut positions) = ready(&row(&[[0.3, 0.0, 0.0]], [2.5, 4.0, 4.0], ""));
    assert_eq!(simulation.crossings(&positions), []);
    for position in &mut positions {
        position[0] *= 1.3;
    }
    let crossings = simulation.crossings(&positions);
    let [
        Crossing {
            surface,
            into,
            inside,
        },
    ] = crossings.as_slice()
    else {
        panic!("{crossings:?}");
    };
    assert_eq!((surface.as_str(), into), ("c0", &None));
    assert_eq!(inside.shift.map(f64::abs), [2.5, 0.0, 0.0]);
    assert!(inside.is_by_image() && inside.count > 0);
    // In a longer box the surface does not reach its image.
    let (simulation, _) = ready(&row(&[[0.3, 0.0, 0.0]], [4.0; 3], ""));
    assert_eq!(simulation.crossings(&positions), []);
}
