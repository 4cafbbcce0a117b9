//! Double-double arithmetic compared with numbers that are known to more digits.

use helfrich_studies::stability::DoubleDouble;
use num_traits::{Float, FloatConst};

fn assert_near(found: DoubleDouble, high: f64, low: f64) {
    let error = found - DoubleDouble::new(high, low);
    let most = 1e-30 * high.abs();
    assert!(
        error.parts()[0].abs() <= most,
        "{found:?} is not {high:?} + {low:?}: {error:?}"
    );
}

/// Constants that are known to more digits than two f64 hold, each split into its nearest f64 and the rest.
#[test]
fn known_numbers() {
    assert_near(
        DoubleDouble::SQRT_2(),
        2.0_f64.sqrt(),
        -9.667_293_313_452_913e-17,
    );
    assert_near(
        DoubleDouble::E(),
        std::f64::consts::E,
        1.445_646_891_729_250_2e-16,
    );
    assert_near(
        DoubleDouble::LN_10(),
        std::f64::consts::LN_10,
        -2.170_756_223_382_249_4e-16,
    );
    assert_near(
        DoubleDouble::of(1.0) / 3.0.into(),
        1.0 / 3.0,
        1.850_371_707_708_594e-17,
    );
    // π is the angle whose tangent is 1, times four, and the logarithm of e is 1.
    let eighth = DoubleDouble::of(1.0).atan2(1.0.into());
    assert_near(
        eighth * 4.0.into(),
        std::f64::consts::PI,
        1.224_646_799_147_353_2e-16,
    );
    assert_near(DoubleDouble::E().ln(), 1.0, 0.0);
}

#[test]
fn functions_undo_each_other() {
    for value in [1e-9, 0.3, 0.77, 1.9, 3.1, 14.2] {
        let x = DoubleDouble::of(value) / 7.0.into();
        let ([high, low], above) = (x.parts(), (x + 1.0.into()).parts());
        let (sine, cosine) = x.sin_cos();
        assert_near(sine * sine + cosine * cosine, 1.0, 0.0);
        assert_near(sine.atan2(cosine), high, low);
        // The exponential of a number near 0 keeps only digits after the point.
        assert_near(x.exp().ln() + 1.0.into(), above[0], above[1]);
        assert_near(x.sqrt() * x.sqrt(), high, low);
        assert_near((x / 3.0.into()) * 3.0.into(), high, low);
        assert_near(x.cbrt().powi(3), high, low);
    }
}
