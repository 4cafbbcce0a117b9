//! Double-double arithmetic compared with numbers that are known to more digits, and with f64.

use helfrich::{Prepared, Surface};
use helfrich_std::method::{
    BendingMethod, Evaluator, ListVisitor, ListedEnergy, ListedOperator, Of, for_each_listed,
};
use helfrich_studies::stability::DoubleDouble;
use helfrich_tests::laws::{Candidate, Listed, ListedStrong, largest};
use helfrich_tests::meshes::{Mesh, icosphere};
use helfrich_tests::tolerance;
use num_traits::{Float, FloatConst, ToPrimitive};

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

/// A method computed in double-double arithmetic agrees with f64 to the digits of f64 without being equal, so
/// that every operation uses the higher precision.
struct MoreThanDouble(Mesh);

impl MoreThanDouble {
    /// Compares the compiled method in f64 with forces, or force densities in strong form, that were computed with
    /// both parts of the positions.
    fn compare(&self, method: BendingMethod, exact: &[[DoubleDouble; 3]]) {
        let Self(mesh) = self;
        let mut double = Evaluator::<f64>::new(method, 1.0, &mesh.connectivity);
        double.evaluate(mesh.surface());
        let scale = largest(double.force());
        let pairs = double.force().as_flattened().iter();
        let mut different = 0;
        for (&found, &exact) in pairs.zip(exact.as_flattened()) {
            let error = (DoubleDouble::of(found) - exact).to_f64();
            let error = error.expect("a number");
            tolerance::INVARIANCE.assert(error, 0.0, scale, method.name());
            different += usize::from(error != 0.0);
        }
        assert!(
            different > mesh.positions.len(),
            "{method}: {different} differ"
        );
    }

    /// Calls `add` with the surface and forces of 0, and returns these.
    fn forces(
        &self,
        add: impl FnOnce(Surface<'_, DoubleDouble>, &mut [[DoubleDouble; 3]]),
    ) -> Vec<[DoubleDouble; 3]> {
        let Self(mesh) = self;
        let fine = Vec::from_iter(mesh.positions.iter().map(|x| x.map(DoubleDouble::of)));
        let mut forces = vec![[DoubleDouble::of(0.0); 3]; fine.len()];
        let surface = Surface::new(&mesh.connectivity, &fine).expect("finite");
        add(surface, &mut forces);
        forces
    }
}

impl ListVisitor for MoreThanDouble {
    fn energy<const PLACE: usize>(&mut self, method: Of<PLACE>)
    where
        Of<PLACE>: ListedEnergy,
    {
        let method = Candidate::method(Listed(method), DoubleDouble::of(1.0));
        let mut prepared = Prepared::new(method, &self.0.connectivity);
        let forces = self.forces(|surface, forces| prepared.add_force(surface, forces));
        self.compare(Of::<PLACE>::METHOD, &forces);
    }

    fn strong_form<const PLACE: usize>(&mut self, method: Of<PLACE>)
    where
        Of<PLACE>: ListedOperator,
    {
        let method = ListedStrong(method).method(DoubleDouble::of(1.0));
        let mut prepared = Prepared::new(method, &self.0.connectivity);
        let forces = self.forces(|surface, forces| prepared.force_density(surface, forces));
        self.compare(Of::<PLACE>::METHOD, &forces);
    }
}

#[test]
fn double_double_is_more_than_double() {
    let mesh = icosphere(1).map(|[x, y, z]| [x + 0.2 * y * z, 0.8 * y, 0.7 * z]);
    for_each_listed(&mut MoreThanDouble(mesh));
}
