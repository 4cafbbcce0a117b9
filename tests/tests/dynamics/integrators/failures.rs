//! Velocities that fail, steps that are too long, and invalid settings.

use super::{RK4, distance, logistic, logistic_flow, vectors};
use helfrich_std::dynamics::integrate::{
    Failure, Integrator, Scheme, Settings, SetupError, SpectralRadius,
};

#[test]
fn what_goes_wrong_is_said_and_the_last_good_positions_stay() {
    for scheme in [Scheme::Rkc2, Scheme::Bs23, RK4] {
        let settings = Settings::new(scheme, 1.0);
        // Velocities that are NaN from the start.
        let mut broken = |x: &[[f64; 3]], time: f64, v: &mut [[f64; 3]]| {
            logistic(x, time, v)?;
            v[2][1] = f64::NAN;
            Ok(())
        };
        let mut run = Integrator::new(vectors(), 0.5, settings).expect("a start");
        let failure = run.step(&mut broken, 1.0).expect_err("not finite");
        assert_eq!(
            failure,
            Failure::NotFinite {
                vertex: 2,
                time: 0.5
            }
        );
        assert_eq!((run.time(), run.positions()), (0.5, &vectors()[..]));
        // Velocities that are infinite from t = 0.7 on.
        let mut broken = |x: &[[f64; 3]], time: f64, v: &mut [[f64; 3]]| {
            logistic(x, time, v)?;
            if time > 0.7 {
                v[3][0] = f64::INFINITY;
            }
            Ok(())
        };
        let mut run = Integrator::new(vectors(), 0.5, settings).expect("a start");
        let failure = run
            .run(&mut broken, 1.0, |_, _| true)
            .expect_err("not finite");
        assert!(
            matches!(failure, Failure::NotFinite { vertex: 3, .. }),
            "{failure}"
        );
        assert!((0.6..=0.7).contains(&run.time()), "{}", run.time());
        let exact = logistic_flow(&vectors(), 0.5, run.time());
        assert!(distance(run.positions(), &exact) < 1e-3);
        // The message of velocities that refuse positions is passed on.
        let mut refusing = |_: &[[f64; 3]], _: f64, _: &mut [[f64; 3]]| Err("too close".to_owned());
        let mut run = Integrator::new(vectors(), 0.5, settings).expect("a start");
        let failure = run.step(&mut refusing, 1.0).expect_err("refused");
        assert!(failure.to_string().contains("too close"), "{failure}");
    }
}

#[test]
fn a_step_that_went_too_far_is_tried_again_shorter() {
    for scheme in [Scheme::Rkc2, Scheme::Bs23] {
        // x' = −x, with a wall at 0 behind which there are no velocities.
        let mut walled = |x: &[[f64; 3]], _: f64, v: &mut [[f64; 3]]| {
            if x[0][0] < 0.0 {
                return Err("behind the wall".to_owned());
            }
            v[0] = x[0].map(|x| -x);
            Ok(())
        };
        let settings = Settings {
            tolerance: 1.0,
            spectral_radius: SpectralRadius::Given(0.1),
            ..Settings::new(scheme, 1.0)
        };
        let mut run = Integrator::new(vec![[1.0, 0.0, 0.0]], 0.0, settings).expect("a start");
        let report = run.run(&mut walled, 50.0, |_, _| true).expect("no failure");
        assert!(report.rejected > 0, "{scheme:?}: {report:?}");
    }
}

#[test]
fn where_no_step_is_short_enough_it_is_said() {
    for scheme in [Scheme::Rkc2, Scheme::Bs23] {
        // The solution of x' = |x| x diverges at t = 1.
        let mut explosive = |x: &[[f64; 3]], _: f64, v: &mut [[f64; 3]]| {
            v[0] = x[0].map(|y| x[0][0].abs() * y);
            Ok(())
        };
        let settings = Settings {
            spectral_radius: SpectralRadius::Estimated,
            ..Settings::new(scheme, 1.0)
        };
        let mut run = Integrator::new(vec![[1.0, 0.0, 0.0]], 0.0, settings).expect("a start");
        let failure = run
            .run(&mut explosive, 2.0, |_, _| true)
            .expect_err("no solution");
        println!("{scheme:?}: {failure}");
        assert!(
            run.time() < 1.01 && run.time() > 0.99,
            "{scheme:?}: {}",
            run.time()
        );
    }
}

#[test]
fn settings_that_make_no_sense_are_refused() {
    let usual = Settings::new(Scheme::Rkc2, 1.0);
    let refuse = |settings: Settings, positions: Vec<[f64; 3]>| {
        let refused = Integrator::new(positions, 0.0, settings);
        refused.map(|_| ()).expect_err("refused")
    };
    for settings in [
        Settings {
            tolerance: 0.0,
            ..usual
        },
        Settings {
            length: f64::NAN,
            ..usual
        },
        Settings {
            longest_step: Some(-1.0),
            ..usual
        },
        Settings {
            scheme: Scheme::Rk4 {
                step: f64::INFINITY,
            },
            ..usual
        },
        Settings {
            spectral_radius: SpectralRadius::Given(-1.0),
            ..usual
        },
    ] {
        let refused = refuse(settings, vectors());
        assert!(
            matches!(refused, SetupError::NotPositive { .. }),
            "{refused}"
        );
    }
    let unknown = Settings {
        spectral_radius: SpectralRadius::Unknown,
        ..usual
    };
    assert_eq!(refuse(unknown, vectors()), SetupError::NeedsRadius);
    let few = Settings {
        stage_limit: 1,
        ..usual
    };
    assert_eq!(refuse(few, vectors()), SetupError::StageLimit { limit: 1 });
    let bad = vec![[0.0; 3], [0.0, f64::NAN, 0.0]];
    assert_eq!(refuse(usual, bad), SetupError::NotFinite { vertex: 1 });
    // A system without vertices is accepted.
    let mut run = Integrator::new(Vec::new(), 0.0, usual).expect("a start");
    let report = run
        .run(&mut logistic, 1.0, |_, _| true)
        .expect("no failure");
    assert_eq!(report.time, 1.0);
}
