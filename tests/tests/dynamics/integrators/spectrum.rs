//! Spectral radii and growing modes.

use super::{Chain, rough};
use helfrich_std::dynamics::integrate::{Integrator, Scheme, Settings};
use helfrich_tests::tolerance::Tolerance;

/// Rates of growing modes, relative.
const GROWTH_RATE: Tolerance = Tolerance::new(
    1e-2,
    "power iteration ends when the estimate changes by 1e-3",
);

#[test]
fn the_spectral_radius_is_found_within_its_margin() {
    let inside = |found: f64, exact: f64, what: &str| {
        println!(
            "{what}: {found:.5} of exactly {exact:.5}, {:.3}",
            found / exact
        );
        assert!(
            (exact..=1.2 * exact).contains(&found),
            "{what}: {found} of {exact}"
        );
    };
    let settings = Settings::new(Scheme::Rkc2, 1.0);
    for count in [1, 2, 3, 10, 100, 1000] {
        let mut chain = Chain {
            diffusion: 7.0,
            driven: None,
        };
        let mut run = Integrator::new(rough(count), 0.0, settings).expect("a start");
        let spectrum = run.estimate_spectrum(&mut chain).expect("velocities");
        inside(
            spectrum.radius,
            chain.radius(count),
            &format!("chain of {count}"),
        );
        assert!(
            spectrum.converged && spectrum.growth.is_none(),
            "{spectrum:?}"
        );
        let again = run.estimate_spectrum(&mut chain).expect("velocities");
        println!(
            "{} iterations, then {}",
            spectrum.iterations, again.iterations
        );
        assert!(again.iterations <= 3, "{again:?}");
    }
    // A complex pair of eigenvalues: vectors rotate and shrink.
    let mut spiral = |x: &[[f64; 3]], _: f64, v: &mut [[f64; 3]]| {
        for (v, x) in v.iter_mut().zip(x) {
            *v = [-x[0] - 5.0 * x[1], 5.0 * x[0] - x[1], -3.0 * x[2]];
        }
        Ok(())
    };
    let mut run = Integrator::new(rough(20), 0.0, settings).expect("a start");
    let spectrum = run.estimate_spectrum(&mut spiral).expect("velocities");
    inside(spectrum.radius, 26.0_f64.sqrt(), "spiral");
    assert!(
        spectrum.converged && spectrum.growth.is_none(),
        "{spectrum:?}"
    );
    // Positions far from the origin, which are rounded coarsely.
    let far: Vec<[f64; 3]> = rough(100).into_iter().map(|x| x.map(|x| x + 1e9)).collect();
    let mut chain = Chain {
        diffusion: 7.0,
        driven: None,
    };
    let mut run = Integrator::new(far, 0.0, settings).expect("a start");
    let spectrum = run.estimate_spectrum(&mut chain).expect("velocities");
    inside(spectrum.radius, chain.radius(100), "far away");
    // Constant velocities do not limit the step.
    let mut still = |_: &[[f64; 3]], _: f64, v: &mut [[f64; 3]]| {
        v.fill([1.0, 0.0, 0.0]);
        Ok(())
    };
    let mut run = Integrator::new(rough(5), 0.0, settings).expect("a start");
    let report = run.run(&mut still, 2.0, |_, _| true).expect("no failure");
    assert_eq!(
        (report.spectrum.map(|s| s.radius), report.step_limit),
        (Some(0.0), None)
    );
}

#[test]
fn a_mode_that_grows_is_named() {
    let growth: f64 = 8.0;
    let mut chain = Chain {
        diffusion: 1.0,
        driven: Some((17, growth)),
    };
    let settings = Settings::new(Scheme::Rkc2, 1.0);
    let mut run = Integrator::new(rough(60), 0.0, settings).expect("a start");
    let report = run.step(&mut chain, 1.0).expect("no failure");
    let spectrum = report.spectrum.expect("an estimate");
    // The bound state of one site: λ + 2 = 2 cosh κ, g = 2 sinh κ.
    let rate = (4.0 + growth * growth).sqrt() - 2.0;
    let found = spectrum.growth.expect("it grows");
    GROWTH_RATE.assert(found, rate, rate, "rate");
    assert_eq!(spectrum.vertex, 17);
    // Vectors that rotate while they grow.
    let mut spiral = |x: &[[f64; 3]], _: f64, v: &mut [[f64; 3]]| {
        for (i, (v, x)) in v.iter_mut().zip(x).enumerate() {
            let (rate, turn) = if i == 3 { (2.0, 5.0) } else { (0.5, 2.0) };
            *v = [rate * x[0] - turn * x[1], turn * x[0] + rate * x[1], -x[2]];
        }
        Ok(())
    };
    let mut run = Integrator::new(rough(6), 0.0, settings).expect("a start");
    let spectrum = run.estimate_spectrum(&mut spiral).expect("velocities");
    let found = spectrum.growth.expect("it grows");
    GROWTH_RATE.assert(found, 2.0, 2.0, "rate");
    assert_eq!(spectrum.vertex, 3);
}

/// Every mode decays, but velocities jump when vertices move to one side, as in methods that choose
/// neighbours by distance. Finite differences towards that side look like a growing mode.
#[test]
fn jumps_are_no_growth() {
    for jump in [1e-6, 1e-3, 1.0] {
        let mut decay = |x: &[[f64; 3]], _: f64, v: &mut [[f64; 3]]| {
            for (v, x) in v.iter_mut().zip(x) {
                *v = x.map(|x| -2.0 * x);
                v[0] += if x[0] > 0.0 { jump } else { 0.0 };
            }
            Ok(())
        };
        let settings = Settings::new(Scheme::Rkc2, 1.0);
        let start = vec![[0.0; 3]; 10];
        let mut run = Integrator::new(start, 0.0, settings).expect("a start");
        for _ in 0..6 {
            let spectrum = run.estimate_spectrum(&mut decay).expect("velocities");
            assert_eq!(spectrum.growth, None, "{jump}: {spectrum:?}");
        }
    }
}

/// Every mode decays, but the second vertex feels the square of the first one's displacement. This term of
/// even order looks like a growing mode to finite differences if the sign of the mode alternates.
#[test]
fn terms_of_second_order_are_no_growth() {
    for coupling in [1.0, 1e2, 1e3] {
        let mut decay = |x: &[[f64; 3]], _: f64, v: &mut [[f64; 3]]| {
            for (i, (v, x)) in v.iter_mut().zip(x).enumerate() {
                *v = x.map(|x| -(100.0 - 10.0 * i as f64) * x);
            }
            v[1][0] += coupling * x[0][0] * x[0][0];
            Ok(())
        };
        let settings = Settings {
            precision: 1e-6,
            ..Settings::new(Scheme::Rkc2, 1.0)
        };
        let start = vec![[0.0; 3]; 10];
        let mut run = Integrator::new(start, 0.0, settings).expect("a start");
        for _ in 0..6 {
            let spectrum = run.estimate_spectrum(&mut decay).expect("velocities");
            assert_eq!(spectrum.growth, None, "{coupling}: {spectrum:?}");
            assert!((100.0..=120.0).contains(&spectrum.radius), "{spectrum:?}");
        }
    }
}
