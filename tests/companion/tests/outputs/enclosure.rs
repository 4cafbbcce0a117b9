//! Points and surfaces inside closed surfaces.

use helfrich::Images;
use helfrich_std::enclosure::{
    Inside, encloses, inside_of_images, inside_of_own_images, surroundings, vertices_inside,
};
use helfrich_tests::meshes::{Mesh, SplitMix64, hemisphere, icosphere};

/// Points are inside an ellipsoid according to its equation, near and far, also for flat meshes.
#[test]
fn closed_surfaces_enclose_what_is_inside() {
    let axes = [2.0, 1.0, 0.5];
    let mesh = icosphere(3).map(|x| [0, 1, 2].map(|axis| axes[axis] * x[axis]));
    let mut random = SplitMix64::new(5);
    let mut inside = 0;
    for _ in 0..200 {
        let unit = [0; 3].map(|_| 1.3 * random.symmetric());
        let distance = unit.iter().map(|x| x * x).sum::<f64>().sqrt();
        // Points between the polyhedron and the ellipsoid are skipped.
        if (0.97..1.0).contains(&distance) {
            continue;
        }
        let point = [0, 1, 2].map(|axis| axes[axis] * unit[axis]);
        assert_eq!(encloses(mesh.surface(), point), distance < 1.0, "{point:?}");
        inside += usize::from(distance < 1.0);
    }
    assert!((20..180).contains(&inside), "{inside}");
    assert!(!encloses(mesh.surface(), [1e6, 3e5, -2e5]));
    assert!(!encloses(hemisphere(2).surface(), [0.0, 0.0, 0.3]));
    let small = icosphere(1).map(|[x, y, z]| [0.2 * x + 1.9, 0.2 * y, 0.2 * z]);
    let (first, count) = vertices_inside(small.surface(), mesh.surface()).expect("some");
    assert!(encloses(mesh.surface(), small.positions[first]));
    assert!(count > 0 && count < small.positions.len(), "{count}");
    let within = icosphere(1).map(|x| x.map(|x| 0.3 * x));
    let all = within.positions.len();
    let found = vertices_inside(within.surface(), mesh.surface());
    assert_eq!(found, Some((0, all)));
    assert_eq!(vertices_inside(mesh.surface(), within.surface()), None);
}

/// Vertices are inside of a bowl or not as each point alone is, in its hollow, too.
#[test]
fn vertices_are_inside_as_points_are() {
    let bowl = icosphere(3).map(|[x, y, z]| [x, y, 0.3 * z + 0.8 * (x * x + y * y)]);
    let mut random = SplitMix64::new(7);
    let mut found = [0; 3];
    for number in 0..60_usize {
        let at = [0; 3].map(|_| 0.9 * random.symmetric());
        let small = match number {
            // Straight above and below vertices of the bowl.
            0..2 => bowl.map(|[x, y, z]| [x, y, z + [0.1, -0.1][number]]),
            _ => icosphere(1).map(|x| [0, 1, 2].map(|axis| at[axis] + 0.2 * x[axis])),
        };
        let places = small.positions.iter().enumerate();
        let inside = places.filter(|(_, point)| encloses(bowl.surface(), **point));
        let inside = Vec::from_iter(inside.map(|(vertex, _)| vertex));
        let expected = inside.first().map(|&first| (first, inside.len()));
        assert_eq!(vertices_inside(small.surface(), bowl.surface()), expected);
        found[if inside.is_empty() {
            0
        } else {
            1 + usize::from(inside.len() == small.positions.len())
        }] += 1;
    }
    assert!(found.iter().all(|&count| count > 0), "{found:?}");
}

/// Each surface is assigned to the innermost closed surface around it, whatever their order; a surface that
/// intersects another lies in none.
#[test]
fn surfaces_know_what_they_lie_in() {
    let ball = |radius: f64, x: f64| {
        icosphere(2).map(|[a, b, c]| [radius * a + x, radius * b, radius * c])
    };
    let open = hemisphere(2);
    let balls = [
        ball(3.0, 0.0),
        ball(0.2, 0.1),
        ball(0.7, 0.2),
        ball(1.0, 3.0),
        ball(1.5, 0.0),
        ball(0.2, 9.0),
        ball(0.1, 0.5),
    ];
    // The hemisphere of radius 1 lies in the fifth surface, and no surface lies in the hemisphere.
    let expected = [
        None,
        Some(2),
        Some(4),
        None,
        Some(0),
        None,
        Some(2),
        Some(4),
    ];
    let meshes = Vec::from_iter(balls.iter().chain([&open]));
    let surfaces = |order: &[usize]| Vec::from_iter(order.iter().map(|&k| meshes[k].surface()));
    for order in [[0, 1, 2, 3, 4, 5, 6, 7], [6, 4, 7, 2, 0, 3, 5, 1]] {
        let found = surroundings(&surfaces(&order), &Images::none());
        for (around, k) in found.into_iter().zip(order) {
            assert_eq!(
                around.map(|around| order[around]),
                expected[k],
                "surface {k}"
            );
        }
    }
}

/// In a periodic box, a surface inside an image of another one lies in that one, wherever in the box it is; a
/// surface that intersects an image lies in none.
#[test]
fn surfaces_lie_in_images_of_others() {
    let ball = |radius: f64, x: f64| {
        icosphere(2).map(|[a, b, c]| [radius * a + x, radius * b, radius * c])
    };
    let balls = [
        ball(1.5, 0.0),
        ball(0.5, 8.2),
        ball(0.2, -7.7),
        ball(0.4, 9.5),
    ];
    let images = Images {
        periods: [8.0, 0.0, 0.0],
        own: true,
    };
    let surfaces = Vec::from_iter(balls.iter().map(Mesh::surface));
    let found = surroundings(&surfaces, &images);
    assert_eq!(found, [None, Some(0), Some(1), None]);
    assert_eq!(surroundings(&surfaces, &Images::none()), [None; 4]);
}

/// An image encloses vertices like the surface itself, wherever in the box both are; in a short box, several
/// images do.
#[test]
fn images_enclose_as_surfaces_do() {
    let images = Images {
        periods: [4.0, 0.0, 3.0],
        own: true,
    };
    let sphere = icosphere(2);
    let at =
        |place: [f64; 3]| icosphere(1).map(|x| [0, 1, 2].map(|axis| 0.5 * x[axis] + place[axis]));
    let direct = at([1.0, 0.25, 0.0]);
    let direct = inside_of_images(&direct.surface().into(), &sphere.surface().into(), &images);
    let [expected] = direct.try_into().expect("one");
    assert!(!expected.is_by_image() && expected.count < 42);
    for shift in [[4.0, 0.0, 0.0], [-8.0, 0.0, 3.0], [0.0, 0.0, -300.0]] {
        let moved = at([1.0 + shift[0], 0.25, shift[2]]);
        let found = inside_of_images(&moved.surface().into(), &sphere.surface().into(), &images);
        let shift = shift.map(|length| 0.0 - length);
        assert_eq!(found, [Inside { shift, ..expected }]);
    }
    // There is no period along y.
    let beside = at([1.0, 4.25, 0.0]);
    let found = inside_of_images(&beside.surface().into(), &sphere.surface().into(), &images);
    assert_eq!(found, []);
    // Half of the surface lies in one image, half in the next.
    let touching = Images {
        periods: [2.0, 0.0, 0.0],
        own: false,
    };
    let found = inside_of_images(
        &at([1.0, 0.0, 0.0]).surface().into(),
        &sphere.surface().into(),
        &touching,
    );
    assert_eq!(
        Vec::from_iter(found.iter().map(|inside| inside.shift[0])),
        [-2.0, 0.0]
    );
    assert_eq!(inside_of_own_images(&sphere.surface().into(), &images), []);
    let long = sphere.map(|[x, y, z]| [2.2 * x, y, z]);
    let found = inside_of_own_images(&long.surface().into(), &images);
    assert_eq!(
        Vec::from_iter(found.iter().map(|inside| inside.shift[0])),
        [-4.0, 4.0]
    );
}
