//! Method E: its known behaviour, including where it stalls and diverges.

use helfrich::shapes::Shape;
use helfrich::{
    Curvature, Curvatures, Finding, LaplaceBeltrami, Method, Paraboloid, Serial, StrongForm,
    Surface,
};
use helfrich_std::generate::{Family, generate};
use helfrich_tests::accuracy::{StrongFormErrors, of_strong_form};
use helfrich_tests::laws::{check_operator, findings_on_small_meshes};
use helfrich_tests::tolerance;

const SIZES: [usize; 3] = [2562, 10242, 40962];

fn on_discocyte(operator: Paraboloid, family: Family) -> [StrongFormErrors; 3] {
    SIZES.map(|vertices| {
        let made = generate(&"discocyte".parse().unwrap(), family, vertices, 1).unwrap();
        of_strong_form(StrongForm::new(1.0, operator), &made)
    })
}

#[test]
fn laws() {
    check_operator("paraboloid", Paraboloid::default());
    check_operator("paraboloid, guarded", Paraboloid::guarded());
}

/// Vertices whose ring does not determine a paraboloid have no value, and a finding reports them.
#[test]
fn tiny_and_open_meshes_give_finite_values() {
    for operator in [Paraboloid::default(), Paraboloid::guarded()] {
        for (name, findings) in findings_on_small_meshes(operator) {
            let missing = |finding: &&Finding| matches!(finding, Finding::TooFewNeighbours { .. });
            let expected = match name {
                "tetrahedron" | "triangle pair" => 4,
                "octahedron" => 6,
                _ => 0,
            };
            assert_eq!(findings.iter().filter(missing).count(), expected, "{name}");
        }
    }
}

/// Δ_S x = −2H n has no component along a sphere, which slivers of a hard mesh show only with the slopes of fits in
/// their frames.
#[test]
fn positions_have_no_laplacian_along_a_sphere() {
    let made = generate(&"sphere".parse().unwrap(), Family::Hard, 162, 1).unwrap();
    let surface = Surface::new(&made.mesh, &made.positions).unwrap();
    let operator = Paraboloid::default();
    let mut workspace = operator.workspace(&made.mesh);
    let mut curvature = vec![Curvature::default(); made.positions.len()];
    operator.curvatures(&Serial, surface, &mut workspace, &mut curvature);
    let mut found = vec![[0.0; 3]; made.positions.len()];
    operator.apply(&Serial, surface, &workspace, &made.positions, &mut found);
    for (&preimage, found) in made.preimages.iter().zip(found) {
        let normal = made.shape.at(preimage).normal;
        let across: f64 = found.iter().zip(&normal).map(|(x, n)| x * n).sum();
        let along: [f64; 3] = std::array::from_fn(|k| found[k] - across * normal[k]);
        let along = along.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!(along <= 0.2, "{along:e}");
    }
}

/// H is of first order at every node, and f of order −1.
#[test]
fn orders_on_regular_meshes() {
    let found = on_discocyte(Paraboloid::default(), Family::Regular);
    for pair in found.windows(2) {
        let order = |coarse: f64, fine: f64| (coarse / fine).log2();
        let mean = order(pair[0].mean.max, pair[1].mean.max);
        assert!((0.8..1.3).contains(&mean), "order {mean} of H");
        let density = order(pair[0].force_density.max, pair[1].force_density.max);
        assert!((-1.1..-0.6).contains(&density), "order {density} of f");
    }
    for (found, expected) in found.iter().zip([0.47, 0.88, 1.8]) {
        let error = found.force_density.max;
        tolerance::PUBLISHED_ERROR.assert(error, expected, expected, "f on regular meshes");
    }
}

/// One-rings of five vertices near a conic section make the published method diverge; the guard keeps H
/// bounded.
#[test]
fn irregular_meshes_diverge_and_the_guard_helps() {
    let published = on_discocyte(Paraboloid::default(), Family::Irregular);
    let guarded = on_discocyte(Paraboloid::guarded(), Family::Irregular);
    assert!(published[2].force_density.max > 50.0 * published[0].force_density.max);
    for (published, guarded) in published.iter().zip(&guarded).skip(1) {
        assert!(guarded.force_density.max < 0.1 * published.force_density.max);
        assert!(guarded.mean.max < published.mean.max);
        assert!(guarded.gaussian.max < 0.3 * published.gaussian.max);
    }
}

/// On a sphere the error of H is of second order at every node of an icosphere.
#[test]
fn sphere() {
    let errors = [642, 2562].map(|vertices| {
        let made = generate(&"sphere".parse().unwrap(), Family::Regular, vertices, 0).unwrap();
        of_strong_form(StrongForm::farutin(1.0), &made).mean.max
    });
    assert!(errors[0] < 0.01 && errors[1] < 0.27 * errors[0]);
}
