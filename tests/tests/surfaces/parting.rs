//! Surfaces that part and join: necks that are cut, holes that are closed, films that break.

use helfrich::{AnyFunctional, Surface};
use helfrich_std::held::Quantity;
use helfrich_std::parting::{Break, Parted, joined, parted};
use helfrich_std::remesh::{EdgeLengths, MeshRequest, OfNoise, remeshed};
use helfrich_tests::meshes::{Mesh, difference, hemisphere, icosphere, norm, torus};
use std::f64::consts::{PI, TAU};

/// The sphere drawn out along x, with this radius at x = 0, and even triangles.
fn dumbbell(waist: f64) -> Mesh {
    let narrow = icosphere(4).map(|[x, y, z]| {
        let width = 1.0 - (1.0 - waist) * (-(2.0 * x).powi(2)).exp();
        [2.0 * x, width * y, width * z]
    });
    let request = MeshRequest {
        lengths: EdgeLengths::Uniform(0.4 * waist),
        vertices: None,
        creases: PI,
        noise: OfNoise::Kept,
    };
    let even = remeshed(narrow.surface(), &request, &mut |_| true).expect("a mesh");
    let points = even.made.points.iter().map(|point| point.position);
    Mesh::new(points.collect(), even.made.mesh.triangles().to_vec())
}

/// The volumes of the components, at the positions with flat or with smoothed caps.
fn volumes(parted: &Parted, positions: &[[f64; 3]]) -> Vec<f64> {
    let surface = Surface::new(&parted.mesh, positions).expect("finite");
    Quantity::new(AnyFunctional::Volume, &parted.mesh)
        .values(surface)
        .to_vec()
}

/// Triangles that were there stay, with their corners, and only caps are new.
fn check(before: &Mesh, after: &Parted, radius: f64) {
    let old = before.connectivity.triangles();
    for (triangle, corners) in old.iter().enumerate() {
        let now = after.mesh.triangles()[triangle].map(|corner| after.vertices[corner as usize]);
        assert_eq!(
            (now, after.triangles[triangle]),
            (*corners, triangle as u32)
        );
    }
    assert_eq!(after.triangles.len(), after.mesh.triangles().len());
    assert!(
        after
            .triangles
            .iter()
            .all(|&near| (near as usize) < old.len())
    );
    for (&near, flat) in after.vertices.iter().zip(&after.flat) {
        let away = norm(difference(before.positions[near as usize], *flat));
        assert!(away < 1.3 * radius, "{away}");
    }
    assert_eq!(after.positions.len(), after.mesh.vertex_count());
}

/// A neck is cut where it is shorter around than the circle of the radius, to what its edges allow, which zigzag around it;
/// both parts are closed, and together they have the volume.
#[test]
fn a_neck_is_cut_and_closed_on_both_sides() {
    for waist in [0.2, 0.3] {
        let mesh = dumbbell(waist);
        assert!(parted(mesh.surface(), 0.9 * waist).is_none());
        let after = parted(mesh.surface(), 1.2 * waist).expect("a neck");
        check(&mesh, &after, waist);
        assert_eq!(after.change, Break::Neck);
        assert_eq!(
            (after.mesh.components().1, after.mesh.euler_characteristic()),
            (2, 4)
        );
        assert!(after.mesh.is_closed());
        let caps = after.vertices.iter().enumerate();
        let caps =
            caps.filter(|&(vertex, &old)| vertex >= mesh.positions.len() || old != vertex as u32);
        for (vertex, _) in caps {
            assert!(
                after.flat[vertex][0].abs() < 0.4,
                "{:?}",
                after.flat[vertex]
            );
        }
        let whole =
            Quantity::new(AnyFunctional::Volume, &mesh.connectivity).values(mesh.surface())[0];
        let flat = volumes(&after, &after.flat);
        assert!(
            ((flat[0] + flat[1]) / whole - 1.0).abs() < 1e-13,
            "{flat:?} {whole}"
        );
        assert!((flat[0] / flat[1] - 1.0).abs() < 0.2, "{flat:?}");
        // Caps grow round towards their own side.
        let round = volumes(&after, &after.positions);
        assert!((0..2).all(|part| (0.9 * flat[part]..flat[part]).contains(&round[part])));
        // A part has no neck any more.
        let surface = Surface::new(&after.mesh, &after.positions).expect("finite");
        assert!(parted(surface, 1.2 * waist).is_none());
    }
}

/// Other components, however small, do not matter, and small patches and triangles are not closed.
#[test]
fn small_parts_stay_as_they_are() {
    let small = icosphere(1).map(|x| x.map(|x| 0.01 * x));
    let patch = Mesh::new(
        vec![[0.0; 3], [0.01, 0.0, 0.0], [0.0, 0.01, 0.0]],
        vec![[0, 1, 2]],
    );
    let mesh = dumbbell(0.2).beside(&small, [0.0, 3.0, 0.0]);
    let mesh = mesh.beside(&patch, [0.0, 5.0, 0.0]);
    let after = parted(mesh.surface(), 0.24).expect("a neck");
    check(&mesh, &after, 0.2);
    assert_eq!(after.mesh.components().1, 4);
    let surface = Surface::new(&after.mesh, &after.positions).expect("finite");
    assert!(parted(surface, 0.24).is_none());
}

/// The handle of a torus, whose tube has the radius 0.4, is cut, and the surface stays in one part.
#[test]
fn a_handle_is_cut() {
    let mesh = torus(40, 16);
    assert!(parted(mesh.surface(), 0.38).is_none());
    let after = parted(mesh.surface(), 0.41).expect("a neck");
    check(&mesh, &after, 0.4);
    assert_eq!(
        (after.mesh.components().1, after.mesh.euler_characteristic()),
        (1, 2)
    );
}

/// Tips, creases and bumps are no necks, however sharp; neither are the borders of open surfaces.
#[test]
fn tips_and_borders_are_no_necks() {
    let needle = icosphere(4).map(|[x, y, z]| [3.0 * x, 0.1 * y, 0.1 * z]);
    assert!(parted(needle.surface(), 0.05).is_none());
    let lens = icosphere(4).map(|[x, y, z]| [x, y, 0.02 * z]);
    assert!(parted(lens.surface(), 0.3).is_none());
    let bump = icosphere(4).map(|x| {
        let height = 1.0 + 0.5 * (-((x[0] - 1.0) / 0.005).powi(2)).exp();
        x.map(|x| height * x)
    });
    assert!(parted(bump.surface(), 0.3).is_none());
    assert!(parted(hemisphere(4).surface(), 0.5).is_none());
}

/// A hole is closed where its border is shorter than the circle of the radius.
#[test]
fn a_hole_is_closed() {
    let (mesh, _) = icosphere(4).cut(|[x, ..]| x < 0.96);
    let border = 2.0 * PI * (1.0_f64 - 0.96 * 0.96).sqrt();
    assert_eq!(mesh.connectivity.euler_characteristic(), 1);
    let radius = border / TAU;
    assert!(parted(mesh.surface(), 0.8 * radius).is_none());
    let after = parted(mesh.surface(), 1.5 * radius).expect("a hole");
    check(&mesh, &after, radius);
    assert_eq!(
        (after.change, after.mesh.euler_characteristic()),
        (Break::Hole, 2)
    );
    assert!(after.mesh.is_closed());
    assert!(volumes(&after, &after.positions)[0] > 0.95 * 4.0 / 3.0 * PI);
}

/// Triangles that stay come first, with their corners; new triangles and rims are within the hole, and name what was there.
fn check_joined(before: &Mesh, after: &Parted, hole: f64) {
    let old = before.connectivity.triangles();
    let stays = |corners: &&[u32; 3]| corners.iter().all(|corner| after.vertices.contains(corner));
    let kept = old.iter().filter(stays).count();
    for (corners, &was) in after
        .mesh
        .triangles()
        .iter()
        .zip(&after.triangles)
        .take(kept)
    {
        assert_eq!(
            corners.map(|corner| after.vertices[corner as usize]),
            old[was as usize]
        );
    }
    assert!(after.mesh.is_closed());
    assert_eq!(
        after.mesh.euler_characteristic(),
        before.connectivity.euler_characteristic() - 2
    );
    assert!(after.vertices.is_sorted());
    for ((&was, flat), moved) in after.vertices.iter().zip(&after.flat).zip(&after.positions) {
        assert_eq!(before.positions[was as usize], *flat);
        assert!(norm(difference(*flat, *moved)) < hole);
    }
    let surface = Surface::new(&after.mesh, &after.positions).expect("finite");
    let cut = parted(surface, 0.5 * hole);
    assert!(cut.is_none(), "the hole is no neck");
}

/// Two spheres whose gap is thinner than the film join to one surface, the hole in the middle of the gap.
#[test]
fn drops_join() {
    let gap = 0.04;
    let sphere = icosphere(3);
    for away in [[2.0 + gap, 0.0, 0.0], [1.3, 1.0, 1.3]] {
        let length = (2.0 + gap) / norm(away);
        let both = sphere.beside(&sphere, away.map(|x| length * x));
        assert!(joined(both.surface(), 0.5 * gap, 0.3).is_none());
        let after = joined(both.surface(), 2.0 * gap, 0.3).expect("a film");
        check_joined(&both, &after, 0.3);
        assert_eq!((after.change, after.mesh.components().1), (Break::Film, 1));
        let middle = away.map(|x| 0.5 * length * x);
        let removed = (0..both.positions.len()).filter(|&k| !after.vertices.contains(&(k as u32)));
        for vertex in removed {
            let place = difference(both.positions[vertex], middle);
            assert!(norm(place) < 0.6, "{place:?}");
        }
        let [volume] = volumes(&after, &after.positions)[..] else {
            panic!("one volume");
        };
        let [one, other] =
            Quantity::new(AnyFunctional::Volume, &both.connectivity).values(both.surface())[..]
        else {
            panic!("two volumes");
        };
        // What was between the rims, 0.13 apart, is 0.003 of the volume, and their rounding adds to it.
        let change = volume / (one + other) - 1.0;
        assert!((0.0..0.02).contains(&change), "{change}");
    }
}

/// A cell whose dimples meet inside becomes a ring; a thin lens, whose sides meet at its rim, stays.
#[test]
fn dimples_join_inside() {
    let dimpled = icosphere(4).map(|[x, y, z]| {
        let inside = (-4.0 * (x * x + y * y)).exp();
        [x, y, z * (0.7 * (1.0 - inside) + 0.02 * inside)]
    });
    assert!(joined(dimpled.surface(), 0.01, 0.2).is_none());
    let after = joined(dimpled.surface(), 0.06, 0.2).expect("a film");
    check_joined(&dimpled, &after, 0.2);
    assert_eq!(after.mesh.components().1, 1);
    let tips = icosphere(4).map(|[x, y, z]| [3.0 * x, 0.15 * y, 0.15 * z]);
    assert!(joined(tips.surface(), 0.1, 0.2).is_none());
    assert!(joined(hemisphere(3).surface(), 0.1, 0.2).is_none());
}
