//! Adaptive jets where noise is hardly larger than the residual of the shape, so that it is found at some
//! vertices, at none, or where there is none.

use crate::adaptive::{
    FEW, QUANTITIES, bars, best_fixed, estimate, exact, of, root_mean_square, shape,
};
use crate::expected_errors::{Case, disc, torus};
use helfrich::{AdaptiveJet, Surface};
use helfrich_std::generate::Family;
use helfrich_std::method::{BendingMethod, Evaluator};

/// Largest ratio of the errors of H, K and f to those of J6. At single vertices the choice scatters where the noise is
/// uncertain: at the tips of an ellipsoid, where K of regression jets has a bias that noise hides.
const OF_JETS: [f64; QUANTITIES] = [1.25, 1.6, 1.25];

/// Largest ratio of the errors to those of the best fixed fit: the goal of the design.
const OF_BEST: f64 = 4.0;

/// Root mean square errors of H, K and f by J6.
fn of_jets(case: &Case, positions: &[[f64; 3]]) -> [f64; QUANTITIES] {
    let surface = Surface::new(&case.mesh, positions).expect("positions");
    let fields = Evaluator::new(BendingMethod::J6, 1.0, &case.mesh).fields(surface);
    let error = |vertex: usize, quantity: usize| {
        let point = &case.exact[vertex];
        let force = |f: [f64; 3]| (0..3).map(|k| f[k] * point.normal[k]).sum();
        let found = match quantity {
            0 => fields.mean[vertex],
            1 => fields.gaussian[vertex],
            _ => fields.force_density[vertex].map(force),
        };
        found.expect("a value") - exact(point, quantity)
    };
    [0, 1, 2].map(|quantity| {
        root_mean_square((0..positions.len()).map(|vertex| error(vertex, quantity)))
    })
}

/// Ratios of the errors to those of J6, and of the best of J6 and the fixed fits, for each quantity.
fn ratios(case: &Case, part: f64) -> [[f64; 2]; QUANTITIES] {
    let positions = case.disturbed(part * case.mean_edge());
    let found = of(&AdaptiveJet::default(), &case.mesh, &positions);
    let [jets, fixed] = [of_jets(case, &positions), best_fixed(case, &positions, FEW)];
    [0, 1, 2].map(|quantity| {
        let both = found.iter().zip(&case.exact);
        let errors = both.map(|(at, point)| estimate(at, quantity).value - exact(point, quantity));
        let error = root_mean_square(errors);
        let jets = jets[quantity];
        [error / jets, error / jets.min(fixed[quantity])]
    })
}

/// At the tips of the first ellipsoid and inside the tori, the residual of the shape is larger than the noise; on
/// regular meshes it is so everywhere.
#[test]
fn near_the_detection_limit_it_is_no_worse_than_jets() {
    for (name, family, part) in [
        (shape("ellipsoid:1,0.7,0.4"), Family::Relaxed, 1e-5),
        (torus(0.5), Family::Relaxed, 1e-5),
        (shape("discocyte"), Family::Relaxed, 3e-5),
        (torus(0.4), Family::Regular, 3e-5),
    ] {
        let case = Case::of_shape(&name, family, 2562);
        for ([of_jets, of_best], most) in ratios(&case, part).into_iter().zip(OF_JETS) {
            assert!(
                of_jets < most && of_best < OF_BEST,
                "{}, {part}: {of_jets} {of_best}",
                case.name
            );
        }
    }
}

/// Noise of this size, that of coordinates with 24 bits, is not found on these meshes. It disturbs jets of two degrees
/// alike: bars that stand on their distance alone held at 74 of 100 vertices of the discocyte for K, and of the torus for
/// H.
#[test]
fn bars_hold_where_noise_is_hidden() {
    for (shape, family) in [
        (shape("discocyte"), Family::Regular),
        (torus(0.4), Family::Hard),
    ] {
        let case = Case::of_shape(&shape, family, 2562);
        let positions = case.disturbed(1e-5 * case.mean_edge());
        let found = of(&AdaptiveJet::default(), &case.mesh, &positions);
        let seen = found.iter().filter(|at| at.deviation > 0.0).count();
        assert!(10 * seen < found.len(), "{}: {seen}", case.name);
        for quantity in [0, 1] {
            let (_, within) = bars(&found, &case, quantity);
            assert!(within > 0.92, "{}, {quantity}: {within}", case.name);
        }
    }
}

/// On a mesh that hardly resolves the shape, f of degree 6 is not closer to the truth than that of degree 4.
#[test]
fn a_coarse_mesh_is_no_noise() {
    let case = Case::of_shape(&torus(0.35), Family::Irregular, 1280);
    let found = of(&AdaptiveJet::default(), &case.mesh, &case.positions());
    assert!(found.iter().all(|at| at.deviation == 0.0));
}

#[test]
#[ignore = "five minutes: by .ci/long"]
fn many_shapes_near_the_detection_limit() {
    let shapes = [
        torus(0.4),
        torus(0.5),
        disc(),
        shape("ellipsoid:1,0.7,0.4"),
        shape("ellipsoid:1,0.8,0.5"),
        shape("ellipsoid:1,1,0.4"),
        shape("discocyte"),
    ];
    let mut lines = Vec::new();
    for family in [
        Family::Irregular,
        Family::Regular,
        Family::Relaxed,
        Family::Hard,
    ] {
        let stars = [2, 5].map(|seed| Case::of_star(seed, family, 2562));
        let others = shapes.iter();
        let others = others.map(|shape| Case::of_shape(shape, family, 2562));
        for case in stars.into_iter().chain(others) {
            for part in [3e-6, 1e-5, 3e-5, 1e-4] {
                let ratios = ratios(&case, part);
                let mut all = ratios.iter().zip(OF_JETS);
                if all.any(|(&[jets, best], most)| jets > most || best > OF_BEST) {
                    lines.push(format!("{}, {part}: {ratios:.2?}\n", case.name));
                }
            }
        }
    }
    assert!(lines.is_empty(), "{}", lines.concat());
}
