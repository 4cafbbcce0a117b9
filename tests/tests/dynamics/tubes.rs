//! Tubes under tension, which pearl.

use helfrich::TriangleMesh;
use helfrich_std::io::{read, write_vtp_with_cells};
use helfrich_std::run::{End, run};
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_std::simulation::build;
use helfrich_tests::meshes::{Mesh, difference, torus};
use helfrich_tests::tolerance::Tolerance;
use std::f64::consts::TAU;
use tempfile::TempDir;

/// Growth rates of waves on a tube with twelve vertices around, relative to the fastest.
const PEARLING: Tolerance = Tolerance::new(
    6e-2,
    "second order in edges of 0.52 radii, 0.5²/12 = 2 %, and the tube is bent to a ring of 12 radii",
);

/// σ R²/κ.
const TENSION: f64 = 10.0;

/// Radius of the ring, in radii of the tube.
const RING: u32 = 12;

/// Number of vertices around the tube.
const AROUND: u32 = 12;

/// Modified Bessel functions I₀, I₁, K₀, K₁ by their integrals, M. Abramowitz and I. Stegun, 9.6.19 and 9.6.24. The
/// trapezoidal rule converges exponentially.
fn bessel(x: f64) -> [f64; 4] {
    let count = 400;
    let middles = (0..count).map(|k| (f64::from(k) + 0.5) / f64::from(count));
    let mut sums = [0.0; 4];
    for share in middles {
        let angle = 0.5 * TAU * share;
        let [first, second] = [(x * angle.cos()).exp(), (-x * (12.0 * share).cosh()).exp()];
        sums[0] += first;
        sums[1] += first * angle.cos();
        sums[2] += 12.0 * second;
        sums[3] += 12.0 * second * (12.0 * share).cosh();
    }
    sums.map(|sum| sum / f64::from(count))
}

/// Growth rate of the wave `R (1 + ε cos(q z/R))` in σ/(μR), with the same fluid inside and outside: P. Nelson,
/// T. Powers and U. Seifert, Phys. Rev. Lett. 74 (1995) 3384, for the energy; S. Tomotika, Proc. R. Soc. A 150 (1935)
/// 322, for the fluid.
fn theory(q: f64) -> f64 {
    let [i0, i1, k0, k1] = bessel(q);
    let mobility = i1 * k1 + 0.5 * q * (i1 * k0 - i0 * k1);
    let bending = q.powi(4) - 0.5 * q * q + 1.5;
    mobility * (1.0 - q * q - bending / TENSION)
}

/// Amplitude ε of `m` waves along the ring, from the volume between two azimuths, which is `1 + 2 ε cos(mφ)`; the
/// integral over the volume is the flux of a field across the surface.
fn amplitude(mesh: &TriangleMesh, positions: &[[f64; 3]], waves: f64) -> f64 {
    let (mut sums, mut volume) = ([0.0; 2], 0.0);
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
        let (u, v) = (difference(b, a), difference(c, a));
        let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2]];
        for place in 0..3 {
            let share = |k: usize| if k == place { 2.0 / 3.0 } else { 1.0 / 6.0 };
            let at = |axis: usize| share(0) * a[axis] + share(1) * b[axis] + share(2) * c[axis];
            let flux = at(0) * normal[0] + at(1) * normal[1];
            let phase = waves * at(1).atan2(at(0));
            sums[0] += flux * phase.cos();
            sums[1] += flux * phase.sin();
            volume += flux;
        }
    }
    sums[0].hypot(sums[1]) / volume
}

/// A tube with a number of waves, bent to a ring, of triangles that are equilateral without the waves.
fn waved(waves: f64) -> Mesh {
    let (around, across) = (14 * AROUND, AROUND);
    let mut mesh = torus(around, across);
    for i in 0..around {
        for j in 0..across {
            let azimuth = TAU * f64::from(i) / f64::from(around);
            // Around the ring the angle grows by whole turns.
            let angle = TAU * (f64::from(j) - 0.5 * f64::from(i)) / f64::from(across);
            let radius = 1.0 + 0.02 * (waves * azimuth).cos();
            let distance = f64::from(RING) + radius * angle.cos();
            mesh.positions[(i * across + j) as usize] = [
                distance * azimuth.cos(),
                distance * azimuth.sin(),
                radius * angle.sin(),
            ];
        }
    }
    mesh
}

/// Growth rate of these waves, in σ/(μR).
fn growth(waves: f64) -> f64 {
    const DURATION: f64 = 3.0;
    let folder = TempDir::new().expect("a folder");
    let mesh = waved(waves);
    let path = folder.path().join("tube.vtp");
    write_vtp_with_cells(&path, &mesh.connectivity, &mesh.positions, None, &[], &[])
        .expect("a file");
    let text = format!(
        r#"
        units = "none"
        [[surface]]
        mesh = "tube.vtp"
        tension.value = 1
        bending = {{ method = "gompper-kroll", modulus = {} }}
        [driver]
        kind = "boundary-integral"
        viscosity = 1
        duration = {DURATION}
        [output]
        interval = {DURATION}
        pictures = false
        "#,
        1.0 / TENSION
    );
    let file = SceneFile::parse(
        &text,
        &folder.path().join("tube.toml"),
        &Overrides::default(),
    );
    let file = file.unwrap_or_else(|errors| panic!("{errors}"));
    let out = folder.path().join("out");
    let built = build(&file).expect("a simulation");
    let summary = run(&file.scene, built, &out, false, &|| false, &mut |_| {}).expect("a run");
    assert_eq!(summary.end, End::Completed, "{}", summary.message);
    let last = read(&out.join("last.vtp")).expect("the end");
    let grown = amplitude(&last.mesh, &last.positions, waves);
    (grown / amplitude(&mesh.connectivity, &mesh.positions, waves)).ln() / DURATION
}

/// Waves on a tube under tension grow as theory has it, and the fastest of them have the wavelength of pearls.
#[test]
fn tubes_under_tension_pearl_with_the_wavelength_of_theory() {
    let waves = [4.0, 6.0, 8.0, 10.0];
    let numbers = waves.map(|waves| waves / f64::from(RING));
    let found = waves.map(growth);
    let fastest = theory(0.53);
    for (&q, found) in numbers.iter().zip(found) {
        PEARLING.assert(found, theory(q), fastest, &format!("q = {q}"));
    }
    // The vertex of the parabola through the three that are the fastest.
    let top = |rates: [f64; 3]| {
        let [before, here, after] = rates;
        numbers[1]
            + 0.5 * (numbers[1] - numbers[0]) * (before - after) / (before - 2.0 * here + after)
    };
    let expected = top([0, 1, 2].map(|k| theory(numbers[k])));
    let wavelength = TAU / top([found[0], found[1], found[2]]);
    assert!(
        (wavelength * expected / TAU - 1.0).abs() < 0.05,
        "{wavelength}"
    );
}
