//! Open membranes: free, hinged and clamped edges.

use helfrich::{Conservative, GaussianBending, GompperKroll, Hamann, Juelicher, LoopSubdivision};
use helfrich_std::dynamics::{Outcome, Relaxation, Settings, StepReport};
use helfrich_std::io::write;
use helfrich_std::run::{End, run};
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_std::simulation::build;
use helfrich_tests::laws::energy;
use helfrich_tests::meshes::{Mesh, cap, catenoid, norm, round_disc, tube};
use std::f64::consts::PI;
use std::path::Path;

/// Bessel's J0 and J1, by their power series.
fn bessel(x: f64) -> [f64; 2] {
    let mut sums = [0.0; 2];
    let mut term = 1.0;
    for k in 0..40 {
        let k = f64::from(k);
        sums[0] += term;
        sums[1] += term * 0.5 * x / (k + 1.0);
        term *= -0.25 * x * x / ((k + 1.0) * (k + 1.0));
    }
    sums
}

/// First solution kR of `kR J0(kR) + (κ_G/κ) J1(kR) = 0` for κ_G = 0 and κ_G = −κ: the first zeros of J0 and
/// of J1′.
const FIRST_ZEROS: [(f64, f64); 2] = [(0.0, 2.404_825_557_695_773), (-1.0, 1.841_183_781_340_659)];

/// A flat disc of radius R and fixed area with a free edge buckles at the line tension `Λ = κ k²/R`.
///
/// To second order in the slope ψ(r) = u′, the area that bending takes shortens the edge by
/// `π ∫ ψ² r dr / R`, so that `E = πκ ∫ (ψ′ + ψ/r)² r dr + π κ_G ψ(R)² − πΛ/R ∫ ψ² r dr`. Its stationary
/// points are ψ = J1(kr), with `κ (ψ′ + ψ/R) + κ_G ψ/R = 0` at the edge. Spherical caps, as in W. Helfrich,
/// Phys. Lett. A 50 (1974) 115, are stable up to `4 (2κ + κ_G)/R`, which is 8 instead of 5.78 for κ_G = 0,
/// and 4 instead of 3.39 for κ_G = −κ.
///
/// The energy of the mode, divided by the length of edge that the mode saves, is stationary at the mode, so
/// that its error is that of the energies alone: of first order, because of the strip at the edge.
#[test]
fn a_disc_buckles_at_the_line_tension_of_a_plate() {
    fn threshold<M: Conservative<f64>>(method: M, gaussian: f64, zero: f64, rings: u32) -> f64 {
        let flat = round_disc(rings);
        let bent = flat.map(|[x, y, _]| [x, y, 1e-3 * bessel(zero * x.hypot(y))[0]]);
        let sum = (method, GaussianBending::new(gaussian));
        let energy = energy(sum, &bent.connectivity, &bent.positions);
        let [before, after] = [&flat, &bent].map(|mesh| mesh.surface().area());
        energy / (PI * (after - before) / before)
    }
    fn check<M: Conservative<f64>>(name: &str, method: impl Fn() -> M) {
        for (gaussian, zero) in FIRST_ZEROS {
            let exact = zero * zero;
            let error = |rings| threshold(method(), gaussian, zero, rings) / exact - 1.0;
            let [coarse, fine] = [20, 40].map(error);
            assert!(
                fine.abs() < 0.035 && fine.abs() < (0.6 * coarse.abs()).max(1e-3),
                "{name}, κ_G = {gaussian} κ: errors {coarse} and {fine}"
            );
        }
    }
    check("B", || GompperKroll::new(1.0));
    check("Jülicher", || Juelicher::new(1.0));
    check("Hamann", || Hamann::new(1.0));
    check("S", || LoopSubdivision::new(1.0));
}

/// A scene in which a surface relaxes with these keys, in a folder.
fn scene(folder: &Path, start: &Mesh, keys: &str) -> SceneFile {
    let path = folder.join("start.ply");
    write(&path, &start.positions, &start.connectivity).expect("a mesh file");
    let text = format!(
        "units = \"none\"\n[driver]\nkind = \"relax\"\n[[surface]]\nmesh = \"start.ply\"\n{keys}"
    );
    SceneFile::parse(&text, &folder.join("scene.toml"), &Overrides::default()).expect("a scene")
}

/// Relaxes a surface with these keys in a scene; returns the final mesh and the last report.
fn relaxed(start: &Mesh, keys: &str, settings: Settings) -> (Mesh, StepReport) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = scene(folder.path(), start, keys);
    let (mut simulation, positions) = build(&file).expect("a simulation");
    let membranes = simulation.membranes();
    let mut relaxation = Relaxation::new(membranes, positions, settings).expect("a start");
    let report = relaxation.run(&mut simulation, |_, _| true);
    let mesh = Mesh {
        connectivity: start.connectivity.clone(),
        positions: relaxation.positions().to_vec(),
    };
    (mesh, report)
}

/// Selects the vertices at the edge, and with `beside` also their neighbours.
fn at_edge(mesh: &Mesh, beside: bool) -> impl Fn(usize) -> bool {
    let inside = |vertex: usize| mesh.connectivity.is_interior(vertex);
    let surrounded = |vertex: usize| mesh.connectivity.is_surrounded(vertex);
    move |vertex| !inside(vertex) || beside && !surrounded(vertex)
}

#[track_caller]
fn assert_held(held: impl Fn(usize) -> bool, before: &Mesh, after: &Mesh) {
    for vertex in (0..before.positions.len()).filter(|&vertex| held(vertex)) {
        let [before, after] = [before, after].map(|mesh| mesh.positions[vertex]);
        assert_eq!(before, after, "vertex {vertex} is fixed");
    }
}

/// Plateau's problem for two rings: a film under tension between them becomes the catenoid `r = cosh z`, with
/// an error of second order in the edge length.
#[test]
fn a_film_between_rings_becomes_a_catenoid() {
    let error = |around: u32| {
        let height = 0.6_f64;
        let rows = catenoid(around, height).positions.len() as u32 / around - 1;
        let cylinder = tube(around, rows, height, |_| height.cosh());
        let keys = "boundary = \"hinged\"\ntension = { value = 1 }";
        let (film, report) = relaxed(&cylinder, keys, Settings::default());
        assert_eq!(report.outcome, Some(Outcome::Converged), "{report:?}");
        assert_held(at_edge(&cylinder, false), &cylinder, &film);
        let off = |[x, y, z]: &[f64; 3]| (x.hypot(*y) - z.cosh()).abs();
        film.positions.iter().map(off).fold(0.0, f64::max)
    };
    let [coarse, fine] = [24, 48].map(error);
    assert!(fine < 2e-3 && fine < coarse / 3.0, "{coarse:e} {fine:e}");
}

/// With bending alone, a cap that is clamped at its edge returns to the sphere, where ∫H² dS is stationary
/// and which has this edge and normal. A hinged cap has no torque at its edge and flattens.
#[test]
fn a_clamped_cap_stays_and_a_hinged_one_flattens() {
    let sphere = cap(10, 1.0);
    let bending = "bending = { method = \"B\", modulus = 1 }";
    for (boundary, beside) in [("clamped", true), ("hinged", false)] {
        let held = at_edge(&sphere, beside);
        let mut start = sphere.clone();
        for (vertex, [x, y, z]) in start.positions.iter_mut().enumerate() {
            if !held(vertex) {
                *z += 0.1 * (1.0 - (*x * *x + *y * *y) / 0.7);
            }
        }
        let keys = format!("boundary = \"{boundary}\"\n{bending}");
        let (mesh, report) = relaxed(&start, &keys, Settings::default());
        assert_eq!(report.outcome, Some(Outcome::Converged), "{report:?}");
        assert_held(&held, &sphere, &mesh);
        if beside {
            let off = mesh.positions.iter().map(|&x| (norm(x) - 1.0).abs());
            let off = off.fold(0.0, f64::max);
            assert!(off < 2e-3, "{off} off the sphere");
        } else {
            let rise = mesh.positions.iter().map(|x| (x[2] - 1.0_f64.cos()).abs());
            let rise = rise.fold(0.0, f64::max);
            assert!(rise < 1e-6 && report.energy < 1e-12, "{rise} {report:?}");
        }
    }
}

/// A slightly domed disc becomes flat below the line tension of
/// [`a_disc_buckles_at_the_line_tension_of_a_plate`]. Above it, the disc becomes a deep cup, until its edge
/// has shrunk to a few triangles.
#[test]
fn a_disc_flattens_or_closes() {
    let domed = round_disc(10).map(|[x, y, _]| [x, y, 0.05 * (1.0 - x * x - y * y)]);
    for (gaussian, below, above) in [(0.0, 5.0, 6.5), (-1.0, 3.0, 4.0)] {
        for tension in [below, above] {
            let keys = format!(
                "bending = {{ method = \"B\", modulus = 1 }}\narea = {{ constraint = \"exact\" }}\n\
                 line_tension = {{ value = {tension} }}\ngaussian_bending = {{ modulus = {gaussian} }}"
            );
            let (mesh, report) = relaxed(&domed, &keys, Settings::default());
            let heights = mesh.positions.iter().map(|x| x[2]);
            let [low, high] = [
                heights.clone().fold(1.0, f64::min),
                heights.fold(-1.0, f64::max),
            ];
            let rise = high - low;
            let flat = 2.0 * PI * tension;
            if tension == below {
                assert_eq!(report.outcome, Some(Outcome::Converged), "{report:?}");
                assert!(rise < 1e-3, "{rise}");
            } else {
                assert!(
                    rise > 1.0 && report.energy < 0.95 * flat,
                    "{rise} {report:?}"
                );
            }
        }
    }
}

/// A run of a disc that closes fails with a message that says so, one of a film between rings converges, and
/// both write the final surface.
#[test]
fn runs_of_open_surfaces_end_as_they_should() {
    let disc = round_disc(6).map(|[x, y, _]| [x, y, 0.2 * (1.0 - x * x - y * y)]);
    let closing = "bending = { method = \"B\", modulus = 1 }\narea = { constraint = \"exact\" }\n\
                   line_tension = { value = 8 }";
    let film = "boundary = \"hinged\"\ntension = { value = 1 }";
    let tube = tube(24, 6, 0.6, |_| 0.6_f64.cosh());
    for (start, keys, end, part) in [
        (&disc, closing, End::Failed, "closed under `line_tension`"),
        (&tube, film, End::Converged, "converged"),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let file = scene(folder.path(), start, keys);
        let built = build(&file).expect("a simulation");
        let out = folder.path().join("out");
        let summary = run(&file.scene, built, &out, false, &|| false, &mut |_| {});
        let summary = summary.expect("a run");
        assert_eq!(summary.end, end, "{}", summary.message);
        assert!(summary.message.contains(part), "{}", summary.message);
        assert!(out.join("last.vtp").exists());
    }
}
