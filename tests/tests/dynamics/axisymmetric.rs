//! The axisymmetric vesicles against theory: references of relaxations.

use helfrich_tests::axisymmetric::{Branch, Error, Vesicle};
use helfrich_tests::tolerance::Tolerance;

/// Energies by different numbers of coefficients, over 8πκ.
const CONVERGED: Tolerance = Tolerance::new(
    1e-10,
    "the shape is good to 1e-5, and the energy is stationary",
);

/// Slopes by the multiplier against differences of energies.
const SLOPE: Tolerance = Tolerance::new(
    1e-7,
    "central differences over 2e-3, improved once, leave 1e-12 times a fifth derivative of 1e4",
);

/// Energies by few coefficients.
const FEW: Tolerance = Tolerance::new(
    2e-2,
    "next to nothing is resolved, but the energy is stationary: other branches differ by more",
);

/// Reduced volumes at which branches cross.
const CROSSING: Tolerance = Tolerance::new(1e-3, "a unit in the last of three digits");

/// Energies at these crossings, over 8πκ, read from a printed figure.
const FIGURE: Tolerance = Tolerance::new(5e-3, "half a unit in the last of three digits");

fn vesicle(branch: Branch, reduced_volume: f64) -> Vesicle {
    let coefficients = match branch {
        Branch::Stomatocyte => 64,
        _ => 32,
    };
    let found = Vesicle::new(branch, reduced_volume, coefficients);
    found.unwrap_or_else(|error| panic!("{error}"))
}

/// The reduced volume at which two branches have the same energy, by Newton's method.
fn crossing(branches: [Branch; 2], near: f64) -> (f64, f64) {
    let mut v = near;
    for _ in 0..8 {
        let [a, b] = branches.map(|branch| vesicle(branch, v));
        let change = (b.energy() - a.energy()) / (a.slope() - b.slope());
        v += change;
        if change.abs() < 1e-11 {
            return (v, a.energy());
        }
    }
    panic!("no crossing near {near}")
}

#[test]
fn energies_converge_with_the_number_of_coefficients() {
    for (branch, v, counts) in [
        (Branch::Prolate, 0.9, [3, 6, 24]),
        (Branch::Prolate, 0.6, [6, 10, 24]),
        (Branch::Oblate, 0.651, [3, 6, 24]),
        (Branch::Oblate, 0.6, [3, 6, 24]),
        (Branch::Stomatocyte, 0.6, [28, 40, 64]),
    ] {
        let solved = counts.map(|count| {
            let found = Vesicle::new(branch, v, count);
            found.unwrap_or_else(|error| panic!("{error}"))
        });
        let [coarse, fine, reference] = solved.each_ref().map(Vesicle::energy);
        CONVERGED.assert(fine, reference, 1.0, &format!("{branch:?} {v}"));
        let [coarse, fine] = [coarse, fine].map(|energy| (energy - reference).abs());
        assert!(fine < 1e-2 * coarse, "{branch:?} {v}: {coarse:e}, {fine:e}");
        let [coarse, .., fine] = solved.each_ref().map(Vesicle::first_integral);
        assert!(fine < 1e-3 * coarse, "{branch:?} {v}: {coarse:e}, {fine:e}");
    }
}

/// The shape equation at every point, with tension and pressure from the slope of the energy.
#[test]
fn shapes_satisfy_the_first_integral_of_the_shape_equation() {
    for (branch, v, bound) in [
        (Branch::Prolate, 0.97, 1e-12),
        (Branch::Prolate, 0.651, 1e-12),
        (Branch::Oblate, 0.9, 1e-12),
        (Branch::Oblate, 0.6, 1e-12),
        (Branch::Stomatocyte, 0.65, 1e-6),
    ] {
        let residual = vesicle(branch, v).first_integral();
        assert!(residual < bound, "{branch:?} {v}: {residual:e}");
    }
}

#[test]
fn multipliers_are_the_slopes_of_energies() {
    for (branch, v) in [
        (Branch::Prolate, 0.9),
        (Branch::Prolate, 0.651),
        (Branch::Oblate, 0.6),
        (Branch::Stomatocyte, 0.62),
    ] {
        let difference = |step: f64| {
            let [below, above] = [-step, step].map(|step| vesicle(branch, v + step).energy());
            (above - below) / (2.0 * step)
        };
        let found = (4.0 * difference(5e-4) - difference(1e-3)) / 3.0;
        let expected = vesicle(branch, v).slope();
        SLOPE.assert(found, expected, 1.0, &format!("{branch:?} {v}"));
    }
}

/// To second order in the amplitude u of a harmonic of degree 2, the excess area over R² is 2u² and the excess
/// energy 12κu²: S. T. Milner and S. A. Safran, Phys. Rev. A 36 (1987) 4371. With v = (1 + 2u²/4π)^(−3/2), E/8πκ =
/// 1 + 2(1 − v). Terms of third order have opposite signs for prolates and oblates.
#[test]
fn near_spheres_have_the_energy_of_second_order() {
    let excess = |v: f64| {
        let energies = [Branch::Prolate, Branch::Oblate].map(|branch| vesicle(branch, v).energy());
        let even = 0.5 * (energies[0] + energies[1]) - 1.0 - 2.0 * (1.0 - v);
        let odd = 0.5 * (energies[1] - energies[0]);
        [even, odd]
    };
    let [coarse, fine] = [0.99, 0.9975].map(excess);
    let order = |part: usize| (coarse[part] / fine[part]).log(4.0);
    assert!(
        (order(0) - 2.0).abs() < 0.05,
        "fourth order in u: {coarse:?} {fine:?}"
    );
    assert!(
        (order(1) - 1.5).abs() < 0.05,
        "third order in u: {coarse:?} {fine:?}"
    );
}

/// Seifert, Berndl and Lipowsky, Phys. Rev. A 44 (1991) 1182, figure 8: the points D, D^sto and M^sto, and the end of
/// the oblates SI^ob.
#[test]
fn branches_cross_where_the_literature_has_it() {
    let (v, energy) = crossing([Branch::Prolate, Branch::Oblate], 0.65);
    CROSSING.assert(v, 0.652, 1.0, "prolates and oblates");
    FIGURE.assert(energy, 1.82, 1.0, "their energy");
    let (v, energy) = crossing([Branch::Oblate, Branch::Stomatocyte], 0.59);
    CROSSING.assert(v, 0.591, 1.0, "oblates and stomatocytes");
    FIGURE.assert(energy, 1.98, 1.0, "their energy");
    let cup = |v: f64| Vesicle::new(Branch::Stomatocyte, v, 64);
    assert!(cup(0.66).is_ok());
    assert!(
        matches!(cup(0.68), Err(Error::NotConverged(..))),
        "the fold"
    );
    let disc = |v: f64| Vesicle::new(Branch::Oblate, v, 32).map(|vesicle| vesicle.energy());
    assert!(disc(0.52).is_ok());
    assert_eq!(disc(0.5), Err(Error::Intersects(Branch::Oblate, 0.5)));
}

#[test]
fn spurious_shapes_are_refused() {
    for v in [0.0, 1.0, -0.5, f64::NAN] {
        let found = Vesicle::new(Branch::Prolate, v, 24).map(|vesicle| vesicle.energy());
        assert!(
            matches!(found, Err(Error::ReducedVolume(_))),
            "{v}: {found:?}"
        );
    }
    // An oblate, which two coefficients cannot tell from a stomatocyte.
    let found = Vesicle::new(Branch::Stomatocyte, 0.6, 2).map(|vesicle| vesicle.energy());
    assert_eq!(found, Err(Error::OtherBranch(Branch::Stomatocyte, 0.6)));
    for (branch, counts) in [
        (Branch::Prolate, 4..9),
        (Branch::Oblate, 2..9),
        (Branch::Stomatocyte, 9..13),
    ] {
        let expected = vesicle(branch, 0.6).energy();
        for count in counts {
            if let Ok(found) = Vesicle::new(branch, 0.6, count) {
                let what = format!("{branch:?} of {count} coefficients");
                FEW.assert(found.energy(), expected, 1.0, &what);
            }
        }
    }
}
