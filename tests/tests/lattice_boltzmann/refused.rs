//! Refusal of impossible input, and units.

use crate::{between, lattice, periodic, sphere};
use helfrich_std::flow::lattice_boltzmann::{
    Immersed, Kernel, Lattice, Setup, Sides, Units, mach, memory, reynolds,
};
use helfrich_tests::tolerance;

#[test]
fn impossible_lattices_are_refused() {
    let good = periodic([4, 4, 4], 0.1);
    let refused = |setup: Setup| Lattice::<f64>::new(setup).unwrap_err().to_string();
    let with_cells = |cells| Setup {
        cells,
        ..good.clone()
    };
    assert!(refused(with_cells([4, 0, 4])).contains("0 nodes along y"));
    assert!(refused(with_cells([usize::MAX; 3])).contains("larger than any memory"));
    assert!(refused(with_cells([usize::MAX / 2, 1, 1])).contains("larger than any memory"));
    assert!(refused(with_cells([1 << 18, 1 << 18, 64])).contains("bytes of memory"));
    for viscosity in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let message = refused(Setup {
            viscosity,
            ..good.clone()
        });
        assert!(message.contains("above 0"), "{message}");
    }
    for velocity in [[0.0, 0.1, 0.0], [0.6, 0.0, 0.0], [f64::NAN, 0.0, 0.0]] {
        let walls = Sides::Walls {
            low: [0.0; 3],
            high: velocity,
        };
        let message = refused(between(1, walls, good.clone()));
        assert!(message.contains("the high wall along y"), "{message}");
    }
    let mut lattice = lattice::<f64>(good.clone());
    assert!(lattice.set_force([0.0, f64::NAN, 0.0]).is_err());
    assert!(
        lattice
            .add_force([0; 3], [f64::INFINITY, 0.0, 0.0])
            .is_err()
    );
    let other = Lattice::new(with_cells([4, 4, 5])).unwrap();
    let message = lattice
        .restore(other.state().clone())
        .unwrap_err()
        .to_string();
    assert!(message.contains("4 × 4 × 5"), "{message}");

    let ball = sphere(1.0, [2.0; 3]);
    let mut obstacle = |positions: &[[f64; 3]]| {
        let refused = lattice.add_obstacle(&ball.connectivity, positions);
        refused.unwrap_err().to_string()
    };
    assert!(obstacle(&ball.positions[1..]).contains("positions"));
    let small = ball.map(|x| x.map(|x| 2.0 + 0.1 * (x - 2.0)));
    assert!(obstacle(&small.positions).contains("no node"));
    let large = ball.map(|[x, y, z]| [x, y, 100.0 * z]);
    assert!(obstacle(&large.positions).contains("along z"));
    let open = helfrich_tests::meshes::disc(2);
    let message = lattice
        .add_obstacle(&open.connectivity, &open.positions)
        .unwrap_err();
    assert!(message.to_string().contains("boundary edges"), "{message}");
}

#[test]
fn impossible_points_are_refused() {
    let setup = between(1, Sides::RESTING, periodic([8; 3], 0.1));
    let mut lattice = lattice::<f64>(setup);
    for (kernel, distance) in [
        (Kernel::Two, 0.5),
        (Kernel::Three, 1.0),
        (Kernel::Four, 1.5),
    ] {
        let mut immersed = Immersed::new(kernel);
        let [inside, outside] = [distance + 1e-9, distance - 1e-9];
        for y in [inside, 8.0 - inside] {
            assert!(
                immersed.place(&lattice, &[[1.0, y, 1.0]]).is_ok(),
                "{kernel:?} at {y}"
            );
        }
        for y in [outside, 8.0 - outside, -3.0, 1e300] {
            let message = immersed.place(&lattice, &[[1.0, 4.0, 1.0], [1.0, y, 1.0]]);
            let message = message.unwrap_err().to_string();
            assert!(
                message.contains("point 1") && message.contains("walls"),
                "{message}"
            );
            assert_eq!(immersed.count(), 0);
        }
        let message = immersed
            .place(&lattice, &[[1.0, 4.0, f64::NAN]])
            .unwrap_err();
        assert!(
            message.to_string().contains("coordinate z of point 0"),
            "{message}"
        );
        immersed.place(&lattice, &[[1.0, 4.0, -1e17]]).unwrap();
        assert!(
            immersed
                .spread(&mut lattice, &[[0.0, f64::NAN, 0.0]])
                .is_err()
        );
    }
    assert_eq!(lattice.momentum(), [0.0; 3]);
}

/// Conversion with water in a channel: 1 µm spacing, 1000 kg/m³ and 1e-6 m²/s.
#[test]
fn units_convert_both_ways() {
    let units = Units::with_viscosity(1e-6, 1e3, 1e-6, 0.1).unwrap();
    let assert = |found: f64, expected: f64| {
        tolerance::LATTICE_ROUNDING.assert(found, expected, expected, "unit");
    };
    assert(units.step, 1e-7);
    assert(units.velocity(), 10.0);
    assert(units.rate(), 1e7);
    assert(units.kinematic_viscosity() * 0.1, 1e-6);
    assert(units.dynamic_viscosity() * 0.1, 1e-3);
    assert(units.pressure(), 1e5);
    assert(units.tension(), 0.1);
    assert(units.force(), 1e-7);
    assert(units.energy(), 1e-13);
    assert(units.force_density(), 1e11);
    assert(mach(3.0_f64.sqrt().recip()), 1.0);
    assert(reynolds(0.02, 30.0, 0.1), 6.0);
    let bytes = memory::<f32>([100; 3]).unwrap();
    assert!((76_000_000..78_000_000).contains(&bytes), "{bytes}");
    assert_eq!(bytes, lattice::<f32>(periodic([100; 3], 0.1)).bytes());
    assert!(memory::<f64>([1, 0, 1]).is_err());
    for [spacing, density] in [[0.0, 1.0], [1.0, f64::NAN], [1e-200, 1.0]] {
        assert!(Units::with_viscosity(spacing, density, 1.0, 0.1).is_err());
    }
}
