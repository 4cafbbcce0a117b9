//! A method of your own: `E = 2k̃ Σ tan²(θ/2)` (Tamstorf, Grinspun, Graphical Models 75 (2013) 362).
//!
//! ```console
//! cargo run --release --example own_method -- study --method half-angles,B --html page.html
//! ```
use helfrich::bending::{Hinge, OverHinges};
use helfrich::element::{Corners, ElementEnergy};
use helfrich::{Lane, Real};
use helfrich_std::method::{Described, Description, ListedEnergy, OwnMethod, Settings};

/// The formula of one hinge, with the modulus k̃ = 2κ/√3 of an edge, for any number type.
#[derive(Debug)]
struct HalfAngles<T>(T);

impl<T: Real> ElementEnergy<T, 4> for HalfAngles<T> {
    fn evaluate(&self, _: usize, corners: &Corners<T, 4>) -> ([[T; 3]; 4], [T; 4]) {
        let hinge = Hinge::new(corners);
        // 1/(1 + cos θ), where 1 + cos θ cancels near a fold: (1 − cos θ)/sin² θ.
        let folded = (T::one() - hinge.cosine) * (hinge.sine * hinge.sine).reciprocal_or_zero();
        let open = (T::one() + hinge.cosine).reciprocal_or_zero();
        let over = T::select(hinge.cosine.less(T::zero()), folded, open) * hinge.presence;
        let tangent = hinge.sine * over;
        let forces = hinge.forces(corners, T::constant(4.0) * self.0 * tangent * over);
        let half = self.0 * tangent * tangent;
        (forces, [half, half, T::zero(), T::zero()])
    }
}

/// Entry of the method for the program's list.
#[derive(Clone, Copy)]
struct Mine;

impl Described for Mine {
    const DESCRIPTION: &'static Description = &Description {
        name: "half-angles",
        letter: None,
        label: "T",
        title: "Half angles",
        idea: "tangents of half the angles between triangles",
        defines: [false; 3],
    };
}

impl ListedEnergy for Mine {
    type Method<T: Real> = OverHinges<HalfAngles<T>>;

    fn method<T: Real>(settings: Settings<'_, T>) -> Self::Method<T> {
        let edge = T::constant(2.0 / 3_f64.sqrt());
        OverHinges(HalfAngles(edge * settings.modulus.at(0)))
    }
}

fn main() -> std::process::ExitCode {
    helfrich_cli::program_with(&[OwnMethod::energy::<Mine>()])
}

proptest::proptest! {
    #![proptest_config(helfrich_tests::meshes::cases(32))]
    #[test]
    fn obeys_the_laws(rough in helfrich_tests::meshes::rough_any()) {
        helfrich_tests::laws::check_conservative(helfrich_tests::laws::Listed(Mine), &rough.mesh());
    }
}
