//! Strains near the ends of the floating-point range.

use helfrich::{
    Finding, InPlane, LocalArea, NeoHookean, Prepared, Skalak, StrainEnergy, Surface, TriangleMesh,
};

/// Energy, forces and findings of a flat right-angled triangle with legs of length `side`, whose reference
/// has legs of length 1.
fn one_triangle<W: StrainEnergy<f64>>(law: W, side: f64) -> (f64, [[f64; 3]; 3], Vec<Finding>) {
    let mesh = TriangleMesh::new(3, vec![[0, 1, 2]]).unwrap();
    let corners = |side: f64| [[0.0; 3], [side, 0.0, 0.0], [0.0, side, 0.0]];
    let (rest, now) = (corners(1.0), corners(side));
    let law = InPlane::new(law, &mesh, Surface::new(&mesh, &rest).unwrap()).unwrap();
    let surface = Surface::new(&mesh, &now).unwrap();
    let mut prepared = Prepared::new(law, &mesh);
    let mut force = [[0.0; 3]; 3];
    let energy = prepared.add_force_and_energy(surface, &mut force);
    let mut findings = Vec::new();
    prepared.inspect(surface, &mut |finding| findings.push(finding));
    (energy, force, findings)
}

/// Equal stretches λ of half a unit of area have the tension G (1 − λ⁻⁶): `E = A0 G/2 (2 λ² − 3 + λ⁻⁴)`. The
/// force along x on the corner on that axis is half of −dE/dλ.
#[test]
fn neo_hookean_forces_at_the_end_of_the_range() {
    for stretch in [1e3_f64, 1e40, 1e60, 1e74] {
        let law = NeoHookean { shear_modulus: 2.0 };
        let (energy, force, findings) = one_triangle(law, stretch);
        let expected = -0.5 * (2.0 * stretch - 2.0 * stretch.powi(-5));
        assert!(
            (force[1][0] / expected - 1.0).abs() < 1e-12,
            "{stretch}: {force:?}"
        );
        let expected = 0.5 * (2.0 * stretch * stretch - 3.0);
        assert!(
            (energy / expected - 1.0).abs() < 1e-12,
            "{stretch}: {energy}"
        );
        assert!(findings.is_empty(), "{stretch}: {findings:?}");
    }
}

/// A triangle is stretched by λ along x alone. With both principal stretches λ and μ, −ΣF·∂x/∂λ is `A0 ∂W/∂λ`
/// and −ΣF·∂x/∂μ is `A0 ∂W/∂μ`. Forces along the edges are larger by λ than their sum and cancel to it; where
/// they have lost their digits, a finding says so.
#[test]
fn forces_of_stretches_along_one_axis_are_right_or_flagged() {
    fn check<W: StrainEnergy<f64>>(law: W, stretch: f64, slopes: [f64; 2]) -> bool {
        let mesh = TriangleMesh::new(3, vec![[0, 1, 2]]).unwrap();
        let rest = [[0.1, 0.2, 0.0], [0.9, 0.5, 0.0], [0.3, 1.1, 0.0]];
        let now = rest.map(|[x, y, z]| [stretch * x, y, z]);
        let rest = Surface::new(&mesh, &rest).unwrap();
        let now = Surface::new(&mesh, &now).unwrap();
        let law = InPlane::new(law, &mesh, rest).unwrap();
        let mut prepared = Prepared::new(law, &mesh);
        let mut force = [[0.0; 3]; 3];
        prepared.add_force(now, &mut force);
        let mut findings = Vec::new();
        prepared.inspect(now, &mut |finding| findings.push(finding));
        if findings.is_empty() {
            let scale = rest.area() * slopes.into_iter().fold(0.0, |a: f64, b| a.max(b.abs()));
            for axis in 0..2 {
                let work = |(force, x): (&[f64; 3], &[f64; 3])| -force[axis] * x[axis];
                let found: f64 = force.iter().zip(rest.positions()).map(work).sum();
                let error = (found - rest.area() * slopes[axis]).abs() / scale;
                assert!(error < 1e-7, "{stretch} {axis}: {found}, error {error}");
            }
        } else {
            assert_eq!(findings, [Finding::Overstretched { triangle: 0 }]);
        }
        findings.is_empty()
    }
    let mut right = Vec::new();
    for l in [3.0_f64, 1e3, 1e6, 1e9, 1e20, 1e36] {
        let strain = l * l - 1.0;
        let by_stretch = (strain + 1.0 + strain) * l - l;
        let by_other = (strain + 1.0 + strain * l * l) - l * l;
        let (shear_modulus, area_ratio) = (1.0, 1.0);
        let skalak = Skalak {
            shear_modulus,
            area_ratio,
        };
        right.push(check(skalak, l, [by_stretch, by_other]));
    }
    assert_eq!(right, [true, true, true, false, false, false], "Skalak");
    let mut right = Vec::new();
    for l in [3.0_f64, 1e3, 1e6, 1e9, 1e20, 1e74] {
        let law = LocalArea { area_modulus: 1.0 };
        right.push(check(law, l, [l - 1.0, l * (l - 1.0)]));
        let law = NeoHookean { shear_modulus: 1.0 };
        assert!(check(law, l, [l - l.powi(-3), 1.0 - l.powi(-2)]));
    }
    assert!(
        right[..3].iter().all(|&right| right) && !right[5],
        "{right:?}"
    );
}

/// W of Skalak's law grows as the eighth power of the stretch; where it overflows, a finding says so.
#[test]
fn stretches_beyond_the_range_are_said() {
    let law = Skalak {
        shear_modulus: 1.0,
        area_ratio: 1.0,
    };
    let (energy, force, findings) = one_triangle(law, 1e20);
    assert!(energy.is_finite() && force.iter().flatten().all(|force| force.is_finite()));
    assert!(findings.is_empty());
    let (energy, _, findings) = one_triangle(law, 1e74);
    assert!(!energy.is_finite());
    assert_eq!(findings, [Finding::Overstretched { triangle: 0 }]);
}

/// The energy grows monotonically as a membrane collapses to a point.
#[test]
fn collapsed_membranes_have_more_energy_than_at_rest() {
    let law = NeoHookean { shear_modulus: 2.0 };
    let mut last = 0.0;
    for stretch in [1.0, 0.1, 1e-10, 1e-38, 1e-60, 0.0] {
        let (energy, _, findings) = one_triangle(law, stretch);
        assert!(energy >= last, "{stretch}: {energy} below {last}");
        last = energy;
        let lost = findings.contains(&Finding::DegenerateTriangle { triangle: 0 });
        assert_eq!(lost, stretch == 0.0, "{stretch}");
    }
    assert!(last.is_finite());
}
