//! Integration in time, compared with theory.

mod failures;
mod spectrum;

use helfrich_std::dynamics::integrate::{
    Integrator, RightHandSide, Scheme, Settings, SpectralRadius, StepReport,
};
use helfrich_tests::tolerance::{self, Tolerance};
use std::f64::consts::PI;

/// Observed orders of convergence in time.
const TIME_ORDER: Tolerance = Tolerance::new(
    0.1,
    "at steps of 1/40, the next term of the error is a fiftieth of the leading one",
);

/// Remainder of a mode after a linearly implicit step a billion times as long as its lifetime.
const STABLE_LIMIT: Tolerance = Tolerance::new(
    1e-6,
    "the reciprocal of the rate, times the square of coefficients of order 10",
);

/// Result of a stabilised step of a linear problem against the closed form of its polynomial, relative to the
/// start.
const STABILITY_POLYNOMIAL: Tolerance = Tolerance::new(
    1e-10,
    "rounding grows with the square of the number of stages, 1e4 at most",
);

/// Error of a step, relative to the allowed error.
const STEP_ERROR: Tolerance = Tolerance::new(
    3.0,
    "estimates are right to leading order, and the longest steps turn vectors by a third of a radian",
);

/// A tolerance so large that errors never limit a step.
const ANY: f64 = 1e12;

const RK4: Scheme = Scheme::Rk4 { step: 0.02 };

/// Vectors that turn about the z-axis at the rate cos t and grow towards unit length:
/// `x' = cos t e_z × x + (1 − |x|²) x`.
fn logistic(x: &[[f64; 3]], time: f64, v: &mut [[f64; 3]]) -> Result<(), String> {
    for (v, x) in v.iter_mut().zip(x) {
        let growth = 1.0 - x.iter().map(|x| x * x).sum::<f64>();
        *v = x.map(|x| growth * x);
        v[0] -= time.cos() * x[1];
        v[1] += time.cos() * x[0];
    }
    Ok(())
}

/// Exact solution of [`logistic`] at a later time.
fn logistic_flow(x: &[[f64; 3]], from: f64, to: f64) -> Vec<[f64; 3]> {
    let (sin, cos) = (to.sin() - from.sin()).sin_cos();
    let moved = |x: &[f64; 3]| {
        let square: f64 = x.iter().map(|x| x * x).sum();
        let later = 1.0 / (1.0 + (1.0 / square - 1.0) * (-2.0 * (to - from)).exp());
        let factor = (later / square).sqrt();
        [
            factor * (cos * x[0] - sin * x[1]),
            factor * (sin * x[0] + cos * x[1]),
            factor * x[2],
        ]
    };
    x.iter().map(moved).collect()
}

fn vectors() -> Vec<[f64; 3]> {
    vec![
        [0.3, 0.0, 0.1],
        [0.0, 1.2, -0.4],
        [-0.5, 0.5, 0.5],
        [0.1, -0.1, 1.5],
    ]
}

/// `√(Σ|a_i − b_i|²/N)`.
fn distance(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let square = |(a, b): (&[f64; 3], &[f64; 3])| -> f64 {
        (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum()
    };
    (a.iter().zip(b).map(square).sum::<f64>() / a.len() as f64).sqrt()
}

fn size(a: &[[f64; 3]]) -> f64 {
    distance(a, &vec![[0.0; 3]; a.len()])
}

/// Chain of vertices with fixed ends, `x_i' = D (x_(i−1) − 2 x_i + x_(i+1))`, plus `g x_j` on one vertex j if
/// `driven`.
struct Chain {
    diffusion: f64,
    driven: Option<(usize, f64)>,
}

impl Chain {
    /// Exact spectral radius of a chain that is not driven.
    fn radius(&self, count: usize) -> f64 {
        let half = 0.5 * PI / (count + 1) as f64;
        4.0 * self.diffusion * (count as f64 * half).sin().powi(2)
    }
}

impl RightHandSide for Chain {
    fn evaluate(&mut self, x: &[[f64; 3]], _: f64, v: &mut [[f64; 3]]) -> Result<(), String> {
        let at = |i: Option<usize>, axis: usize| {
            let x = i.and_then(|i| x.get(i));
            x.map_or(0.0, |x| x[axis])
        };
        for (i, v) in v.iter_mut().enumerate() {
            for (axis, v) in v.iter_mut().enumerate() {
                let neighbours = at(i.checked_sub(1), axis) + at(Some(i + 1), axis);
                *v = self.diffusion * (neighbours - 2.0 * x[i][axis]);
            }
        }
        if let Some((i, growth)) = self.driven {
            for axis in 0..3 {
                v[i][axis] += growth * x[i][axis];
            }
        }
        Ok(())
    }
}

/// Positions that contain all modes of a chain.
fn rough(count: usize) -> Vec<[f64; 3]> {
    let position = |i: usize| {
        let s = (i * i) as f64;
        [(1.7 * s).sin(), (0.9 * s).cos(), (2.3 * s + 1.0).sin()]
    };
    (0..count).map(position).collect()
}

fn fixed_step(scheme: Scheme, step: f64, radius: SpectralRadius) -> Settings {
    let scheme = match scheme {
        Scheme::Rk4 { .. } => Scheme::Rk4 { step },
        other => other,
    };
    Settings {
        tolerance: ANY,
        longest_step: Some(step),
        spectral_radius: radius,
        stage_limit: 1000,
        ..Settings::new(scheme, 1.0)
    }
}

/// Spectral radius for which a stabilised step of this length takes this number of stages.
fn radius_for(stages: usize, step: f64) -> f64 {
    ((stages * stages) as f64 - 1.0) / (1.54 * step)
}

#[test]
fn orders_of_convergence_are_those_of_the_schemes() {
    let (from, to) = (0.3, 2.3);
    let cases = [
        (Scheme::Rkc2, Some(2), 2.0),
        (Scheme::Rkc2, Some(5), 2.0),
        (Scheme::Rkc2, Some(12), 2.0),
        (Scheme::Bs23, None, 3.0),
        (Scheme::Rosenbrock, None, 3.0),
        (RK4, None, 4.0),
    ];
    for (scheme, stages, order) in cases {
        let error = |steps: usize| {
            let step = (to - from) / steps as f64;
            let radius = match stages {
                Some(stages) => SpectralRadius::Given(radius_for(stages, step)),
                None => SpectralRadius::Unknown,
            };
            let settings = fixed_step(scheme, step, radius);
            let mut run = Integrator::new(vectors(), from, settings).expect("a start");
            let end = run.run(&mut logistic, to, |_, report| {
                assert!(stages.is_none_or(|stages| stages == report.stages));
                true
            });
            assert_eq!(end.expect("no failure").accepted, steps);
            distance(run.positions(), &logistic_flow(&vectors(), from, to))
        };
        let errors = [40, 80, 160].map(error);
        let found = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
        println!("{scheme:?} {stages:?}: errors {errors:?}, orders {found:.3?}");
        TIME_ORDER.assert(found[1], order, 1.0, "order");
    }
}

/// Velocities whose derivatives are approximated by a matrix A with these decay rates, one per axis.
struct Linearised<F> {
    velocities: F,
    rates: [f64; 3],
}

impl<F: RightHandSide> RightHandSide for Linearised<F> {
    fn evaluate(&mut self, x: &[[f64; 3]], time: f64, v: &mut [[f64; 3]]) -> Result<(), String> {
        self.velocities.evaluate(x, time, v)
    }

    fn solve(&mut self, c: f64, field: &mut [[f64; 3]]) -> Result<(), String> {
        for entry in field {
            *entry = [0, 1, 2].map(|axis| entry[axis] / (1.0 + c * self.rates[axis]));
        }
        Ok(())
    }
}

/// Linearly implicit steps keep their order although A has nothing in common with the derivatives of the
/// velocities.
#[test]
fn linearly_implicit_steps_keep_their_order_with_any_matrix() {
    let (from, to) = (0.3, 2.3);
    let error = |steps: usize| {
        let step = (to - from) / steps as f64;
        let settings = fixed_step(Scheme::Rosenbrock, step, SpectralRadius::Unknown);
        let mut run = Integrator::new(vectors(), from, settings).expect("a start");
        let mut velocities = Linearised {
            velocities: logistic,
            rates: [2.0, -0.5, 1.0],
        };
        run.run(&mut velocities, to, |_, _| true)
            .expect("no failure");
        distance(run.positions(), &logistic_flow(&vectors(), from, to))
    };
    let errors = [80, 160, 320].map(error);
    let found = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
    println!("errors {errors:?}, orders {found:.3?}");
    TIME_ORDER.assert(found[1], 3.0, 1.0, "order");
}

/// With the exact derivatives, modes vanish however long the step; with decay rates in A between 0.7 times
/// and four times the true ones they decay; with half of them they grow.
#[test]
fn linearly_implicit_steps_are_stable_for_similar_matrices() {
    let rate = 1e9;
    let after = |share: f64| {
        // The tolerance is huge, because it also limits the first step.
        let settings = Settings {
            tolerance: 1e30,
            ..fixed_step(Scheme::Rosenbrock, 1.0, SpectralRadius::Unknown)
        };
        let mut run = Integrator::new(vec![[1.0, -2.0, 0.5]], 0.0, settings).expect("a start");
        let mut decay = Linearised {
            velocities: |x: &[[f64; 3]], _: f64, v: &mut [[f64; 3]]| {
                v[0] = x[0].map(|x| -rate * x);
                Ok(())
            },
            rates: [share * rate; 3],
        };
        run.step(&mut decay, 1.0).expect("no failure");
        run.positions()[0][0]
    };
    STABLE_LIMIT.assert(after(1.0), 0.0, 1.0, "R(−∞)");
    for share in [0.7, 0.8, 1.2, 1.5, 2.0, 3.0, 4.0] {
        let left = after(share);
        assert!(left.abs() < 0.75, "{left} with {share} of the rate");
    }
    assert!(after(0.5).abs() > 1.0);
}

#[test]
fn a_stabilised_step_is_its_chebyshev_polynomial() {
    for stages in [2_usize, 3, 4, 7, 20, 100] {
        let s = stages as f64;
        // T_s = cosh sθ, w0 = cosh θ.
        let w0 = 1.0 + 2.0 / 13.0 / (s * s);
        let theta = w0.acosh();
        let t = (s * theta).cosh();
        let first = s * (s * theta).sinh() / theta.sinh();
        let second = (s * s * t - w0 * first) / (w0 * w0 - 1.0);
        let w1 = first / second;
        let b = second / (first * first);
        for share in [0.01, 0.3, 0.77, 1.0] {
            let z = -share * radius_for(stages, 1.0);
            let w = w0 + w1 * z;
            let chebyshev = if w.abs() <= 1.0 {
                (s * w.acos()).cos()
            } else {
                (s * w.abs().acosh()).cosh() * w.signum().powi(stages as i32)
            };
            let expected = 1.0 - b * t + b * chebyshev;
            let radius = SpectralRadius::Given(radius_for(stages, 1.0));
            let settings = fixed_step(Scheme::Rkc2, 1.0, radius);
            let mut run = Integrator::new(vec![[1.0, -2.0, 0.0]], 0.0, settings).expect("a start");
            let mut decay = |x: &[[f64; 3]], _: f64, v: &mut [[f64; 3]]| {
                v[0] = x[0].map(|x| z * x);
                Ok(())
            };
            let report = run.step(&mut decay, 1.0).expect("no failure");
            assert_eq!(report.stages, stages);
            let found = run.positions()[0];
            let scale = expected.abs().max(1.0);
            STABILITY_POLYNOMIAL.assert(found[0], expected, scale, "R(z)");
            STABILITY_POLYNOMIAL.assert(found[1], -2.0 * expected, 2.0 * scale, "R(z)");
        }
    }
}

#[test]
fn stabilised_steps_are_stable_up_to_their_limit() {
    let count = 100;
    // The stability intervals of 3 and 5 stages are much longer than the one given here.
    for stages in [2_usize, 4, 9, 10, 31] {
        for (share, stable) in [(0.95, true), (1.05, false)] {
            let mut chain = Chain {
                diffusion: 1.0,
                driven: None,
            };
            let step = share * radius_for(stages, chain.radius(count));
            let given = SpectralRadius::Given(radius_for(stages, step));
            let settings = fixed_step(Scheme::Rkc2, step, given);
            let mut run = Integrator::new(rough(count), 0.0, settings).expect("a start");
            let mut before = size(&rough(count));
            let start = before;
            for _ in 0..200 {
                let report = run.step(&mut chain, 1e9).expect("no failure");
                assert_eq!((report.stages, report.rejected), (stages, 0));
                let now = size(run.positions());
                assert!(
                    !stable || now <= before,
                    "{stages} stages: {before:e} becomes {now:e}"
                );
                before = now;
                if before > 1e6 * start {
                    break;
                }
            }
            assert!(
                stable || before > 10.0 * start,
                "{stages} stages: {before:e}"
            );
        }
    }
}

#[test]
fn steps_of_few_stages_end_where_they_are_stable() {
    for scheme in [Scheme::Bs23, RK4] {
        for (share, stable) in [(0.99, true), (1.01, false)] {
            let rate = 3.0;
            let mut decay = |x: &[[f64; 3]], _: f64, v: &mut [[f64; 3]]| {
                v[0] = x[0].map(|x| -rate * x);
                Ok(())
            };
            let given = SpectralRadius::Given(rate / share);
            let settings = fixed_step(scheme, 100.0, given);
            let mut run = Integrator::new(vec![[1.0, 2.0, 3.0]], 0.0, settings).expect("a start");
            let mut limit = None;
            for _ in 0..400 {
                limit = run.step(&mut decay, 1e9).expect("no failure").step_limit;
            }
            let grown = size(run.positions()) / size(&[[1.0, 2.0, 3.0]]);
            assert!(
                grown < 0.3 || !stable,
                "{scheme:?}: {grown:e} with {limit:?}"
            );
            assert!(
                grown > 3.0 || stable,
                "{scheme:?}: {grown:e} with {limit:?}"
            );
        }
    }
}

#[test]
fn errors_are_what_the_tolerance_allows() {
    for scheme in [Scheme::Rkc2, Scheme::Bs23] {
        let mut finals = Vec::new();
        for allowed in [1e-3, 1e-4, 1e-5, 1e-6] {
            let settings = Settings {
                tolerance: allowed,
                ..Settings::new(scheme, 2.0)
            };
            let mut run = Integrator::new(vectors(), 0.0, settings).expect("a start");
            let (mut at, mut time) = (vectors(), 0.0);
            let (mut largest, mut ratios) = (0.0_f64, Vec::new());
            let end = run.run(&mut logistic, 6.0, |run, report| {
                let exact = logistic_flow(&at, time, report.time);
                let error = distance(run.positions(), &exact) / (2.0 * allowed);
                largest = largest.max(error);
                ratios.push(error / report.error);
                at = run.positions().to_vec();
                time = report.time;
                true
            });
            let end = end.expect("no failure");
            ratios.sort_by(f64::total_cmp);
            let median = ratios[ratios.len() / 2];
            let error = distance(run.positions(), &logistic_flow(&vectors(), 0.0, 6.0));
            println!(
                "{scheme:?} {allowed:e}: largest error of a step {largest:.2} of that allowed, over \
                 its estimate {median:.2}, at the end {:.2}, {} + {} steps, {} evaluations",
                error / (2.0 * allowed),
                end.accepted,
                end.rejected,
                end.evaluations
            );
            assert!(largest <= STEP_ERROR.value, "{scheme:?}: {largest}");
            finals.push(error);
        }
        // The error allowed per step is of third order, so that a scheme of order p ends with an error ~
        // tolerance^(p/3).
        let found = (finals[1] / finals[3]).log10() / 2.0;
        println!("{scheme:?}: error at the end ~ tolerance^{found:.3}");
        let expected = if scheme == Scheme::Rkc2 {
            2.0 / 3.0
        } else {
            1.0
        };
        TIME_ORDER.assert(found, expected, 1.0, "power of the tolerance");
    }
}

#[test]
fn output_times_are_hit_and_leave_no_trace() {
    for scheme in [Scheme::Rkc2, Scheme::Bs23, RK4] {
        let settings = Settings::new(scheme, 1.0);
        let mut free = Integrator::new(vectors(), 0.0, settings).expect("a start");
        let natural = free
            .run(&mut logistic, 5.0, |_, _| true)
            .expect("no failure")
            .accepted;

        let mut run = Integrator::new(vectors(), 0.0, settings).expect("a start");
        let outputs: Vec<f64> = (1..=20)
            .flat_map(|i| [0.25 * f64::from(i) - 1e-7, 0.25 * f64::from(i)])
            .collect();
        let mut last: Option<StepReport> = None;
        for &output in &outputs {
            let end = run.run(&mut logistic, output, |_, report| {
                let shortened = last.and_then(|last| last.next_step);
                let shortened = shortened.filter(|step| report.step < 0.99 * step);
                if let (Some(proposed), 0) = (shortened, report.rejected) {
                    assert_eq!(report.next_step, Some(proposed), "{scheme:?}");
                }
                last = Some(*report);
                true
            });
            assert_eq!(end.expect("no failure").time, output);
            assert_eq!(run.time(), output);
        }
        let report = run.step(&mut logistic, 4.0).expect("nothing to do");
        assert_eq!((report.step, report.time), (0.0, 5.0));
        let steps = report.accepted;
        println!(
            "{scheme:?}: {natural} steps become {steps} with {} outputs",
            outputs.len()
        );
        assert!(steps <= natural + 2 * outputs.len(), "{scheme:?}: {steps}");
    }
}

#[test]
fn what_is_kept_is_restored_without_evaluations() {
    /// Rigid rotation, which preserves lengths.
    struct Turning;
    impl RightHandSide for Turning {
        fn evaluate(&mut self, x: &[[f64; 3]], _: f64, v: &mut [[f64; 3]]) -> Result<(), String> {
            for (v, x) in v.iter_mut().zip(x) {
                *v = [-x[1], x[0], 0.0];
            }
            Ok(())
        }

        fn restore(&mut self, x: &mut [[f64; 3]]) {
            for x in x {
                let length = x.iter().map(|x| x * x).sum::<f64>().sqrt();
                *x = x.map(|x| x / length);
            }
        }
    }
    for scheme in [Scheme::Rkc2, Scheme::Bs23, RK4] {
        let settings = Settings {
            spectral_radius: SpectralRadius::Given(1.0),
            ..Settings::new(scheme, 1.0)
        };
        let mut run = Integrator::new(vec![[0.6, 0.0, 0.8]; 3], 0.0, settings).expect("a start");
        let mut evaluations = None;
        run.run(&mut Turning, 3.0, |run, report| {
            for (x, v) in run.positions().iter().zip(run.velocities()) {
                let length = x.iter().map(|x| x * x).sum::<f64>().sqrt();
                tolerance::CONSTRAINED.assert(length, 1.0, 1.0, "length");
                assert_eq!(*v, [-x[1], x[0], 0.0]);
            }
            let before = evaluations.filter(|&(_, rejected)| rejected == report.rejected);
            if let Some((before, _)) = before {
                assert_eq!(report.evaluations, before + report.stages);
            }
            evaluations = Some((report.evaluations, report.rejected));
            true
        })
        .expect("no failure");
    }
}

#[test]
fn stabilised_steps_need_fewer_evaluations_where_it_is_stiff() {
    let count = 200;
    let (diffusion, end) = (4000.0, 1.0);
    let start: Vec<[f64; 3]> = (0..count)
        .map(|i| {
            let s = PI * (i + 1) as f64 / (count + 1) as f64;
            [
                s.sin(),
                (3.0 * s).sin(),
                (2.0 * s).sin() + 0.1 * (9.0 * s).sin(),
            ]
        })
        .collect();
    // Each term is a mode of the chain.
    let decay = |k: f64| {
        let rate = 4.0 * diffusion * (0.5 * k * PI / (count + 1) as f64).sin().powi(2);
        (-rate * end).exp()
    };
    let exact: Vec<[f64; 3]> = (0..count)
        .map(|i| {
            let s = PI * (i + 1) as f64 / (count + 1) as f64;
            let z = decay(2.0) * (2.0 * s).sin() + 0.1 * decay(9.0) * (9.0 * s).sin();
            [decay(1.0) * s.sin(), decay(3.0) * (3.0 * s).sin(), z]
        })
        .collect();
    let [rkc2, bs23, rk4] = [Scheme::Rkc2, Scheme::Bs23, Scheme::Rk4 { step: 1.0 }].map(|scheme| {
        let mut chain = Chain {
            diffusion,
            driven: None,
        };
        let mut run =
            Integrator::new(start.clone(), 0.0, Settings::new(scheme, 1.0)).expect("a start");
        let report = run.run(&mut chain, end, |_, _| true).expect("no failure");
        let error = distance(run.positions(), &exact);
        println!(
            "{scheme:?}: {} evaluations, {} + {} steps, error {error:.1e}, step limit {:.2e}",
            report.evaluations,
            report.accepted,
            report.rejected,
            report.step_limit.expect("a limit")
        );
        assert!(error < 1e-3, "{scheme:?}: {error:e}");
        report.evaluations
    });
    assert!(5 * rkc2 < rk4 && 5 * rkc2 < bs23, "{rkc2}, {bs23}, {rk4}");
}
