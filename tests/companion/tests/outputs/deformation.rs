//! Deformation and inclination of known bodies, and plane sections.
#![expect(
    clippy::unwrap_used,
    reason = "what fails in a helper fails the test that called it"
)]

mod plateaus;
mod treading;

use helfrich_std::deformation::{
    Deformation, ShearPlane, extremes, roughness, taylor, wrinkle_indicator,
};
use helfrich_std::flow::Ambient;
use helfrich_std::generate::{AnyShape, Family, generate};
use helfrich_std::section::section;
use helfrich_tests::accuracy::surface;
use helfrich_tests::meshes::{
    GENERIC, Mesh, SplitMix64, bent, cross, dot, hemisphere, icosphere, norm, rotation, turned,
};
use helfrich_tests::tolerance::Tolerance;
use std::f64::consts::PI;

/// Moments, axes, angles and turns of polyhedra, relative to a natural scale.
const DEFORMATION: Tolerance = Tolerance::new(
    1e-12,
    "sums of a thousand terms of either sign, some thirty lengths from the origin",
);

/// A semi-axis extrapolated from two refinements, relative.
const DEFORMATION_EXTRAPOLATED: Tolerance =
    Tolerance::new(2e-5, "fourth order: the square of 5e-3 for 642 vertices");

/// D of an irregular mesh of 642 vertices.
const DEFORMATION_RANDOM_MESH: Tolerance = Tolerance::new(
    5e-3,
    "the polyhedron's volume is 1 % short, by more where curvature is larger; the difference enters D",
);

/// D by extreme points of a mesh of 2562 vertices.
const DEFORMATION_EXTREMES: Tolerance = Tolerance::new(
    2e-3,
    "chords deviate from the curve by an eighth of the squared edge length, 7e-4",
);

/// Distance to the nearest of 400 sample points on every line of a section, relative.
const DEFORMATION_SAMPLED: Tolerance = Tolerance::new(
    1e-4,
    "half a sample spacing on a line of a third of a radius is 4e-4, squared",
);

/// Areas of sections of a sphere of 642 vertices, relative.
const SECTION_AREA: Tolerance = Tolerance::new(
    2e-2,
    "chords of a polyhedron whose surface is up to 4e-3 inside; twice that at a height of 0.7",
);

/// The wrinkle indicator of a sphere of 642 vertices.
const WRINKLE_INDICATOR: Tolerance = Tolerance::new(1e-2, "second order in edges of 0.15 radii");

const SEMI_AXES: [f64; 3] = [1.7, 1.1, 0.6];

fn plane() -> ShearPlane {
    ShearPlane::new([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).unwrap()
}

fn of(mesh: &Mesh) -> Deformation {
    Deformation::new(mesh.surface()).unwrap()
}

fn stretched(refinement: u32, [a, b, c]: [f64; 3]) -> Mesh {
    icosphere(refinement).map(|[x, y, z]| [a * x, b * y, c * z])
}

/// Rotation about z, from x towards y.
fn inclined(degrees: f64) -> impl Fn([f64; 3]) -> [f64; 3] {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    move |[x, y, z]| [cosine * x - sine * y, sine * x + cosine * y, z]
}

fn moved([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x + 12.0, y - 31.0, z + 7.0]
}

/// Box with corners at ± half of its sides.
fn cuboid(sides: [f64; 3]) -> Mesh {
    let corner =
        |index: u32| std::array::from_fn(|axis| (f64::from(index >> axis & 1) - 0.5) * sides[axis]);
    let squares = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let triangles = squares
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    Mesh::new((0..8).map(corner).collect(), triangles.collect())
}

#[track_caller]
fn assert_close(found: f64, expected: f64, scale: f64, what: &str) {
    DEFORMATION.assert(found, expected, scale, what);
}

/// The moments of a box are a²/12 along a side a.
#[test]
fn a_box_has_the_moments_of_a_box() {
    let sides = [3.0, 1.0, 2.0];
    let turn = rotation(GENERIC);
    let found = of(&cuboid(sides).map(|x| moved(turned(turn, x))));
    assert_close(found.volume, 6.0, 6.0, "volume");
    for (axis, expected) in moved([0.0; 3]).into_iter().enumerate() {
        assert_close(found.centroid[axis], expected, 30.0, "centroid");
    }
    for (found, side) in found.semi_axes.into_iter().zip([3.0, 2.0, 1.0]) {
        assert_close(found, (5.0_f64 / 12.0).sqrt() * side, side, "semi-axis");
    }
    // Longest along x, then z, then y.
    for (found, axis) in found.directions.into_iter().zip([0, 2, 1]) {
        let mut expected = [0.0; 3];
        expected[axis] = 1.0;
        assert_close(dot(found, turned(turn, expected)).abs(), 1.0, 1.0, "axis");
    }
    let [first, second, third] = found.directions;
    assert_close(dot(cross(first, second), third), 1.0, 1.0, "handedness");
}

/// Icosahedra have isotropic moments, and affine maps preserve ratios: D and θ of an inscribed ellipsoid are
/// exact; lengths are too small in second order.
#[test]
fn ellipsoids_are_recognised_however_they_lie() {
    let [a, b, c] = SEMI_AXES;
    let mut errors = Vec::new();
    for refinement in 1..=4 {
        let found = of(&stretched(refinement, SEMI_AXES).map(|x| moved(inclined(25.0)(x))));
        assert_close(found.taylor(), (a - c) / (a + c), 1.0, "D of all axes");
        let flat = found.in_plane(plane());
        assert_close(flat.taylor(), (a - b) / (a + b), 1.0, "D in the plane");
        assert_close(flat.inclination, 25.0, 90.0, "inclination");
        assert_close(flat.semi_axes[1], found.semi_axes[1], 1.0, "semi-axis");
        errors.push(a - found.semi_axes[0]);
    }
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.8..2.2).contains(&order), "order {order} in {errors:?}");
    }
    let extrapolated = (4.0 * errors[3] - errors[2]) / 3.0;
    DEFORMATION_EXTRAPOLATED.assert(extrapolated, 0.0, a, "semi-axis");
}

#[test]
fn random_meshes_leave_an_error_of_second_order() {
    let shape: AnyShape = "ellipsoid:1.7,1.1,0.6".parse().unwrap();
    let [a, _, c] = SEMI_AXES;
    for (vertices, refined) in [(642, 1.0), (2562, 4.0)] {
        let made = generate(&shape, Family::Irregular, vertices, 3).unwrap();
        let found = Deformation::new(surface(&made)).unwrap();
        let error = found.taylor() - (a - c) / (a + c);
        DEFORMATION_RANDOM_MESH.assert(refined * error, 0.0, 1.0, "D");
    }
}

#[test]
fn inclination_is_between_a_quarter_turn_either_way() {
    for (turn, expected) in [
        (0.0, 0.0),
        (45.0, 45.0),
        (90.0, 90.0),
        (-90.0, 90.0),
        (120.0, -60.0),
        (-45.0, -45.0),
        (179.0, -1.0),
        (215.0, 35.0),
    ] {
        let body = stretched(1, SEMI_AXES).map(inclined(turn));
        let found = of(&body).in_plane(plane()).inclination;
        assert!(found > -90.0 && found <= 90.0);
        // At the seam, −90° and 90° are equivalent.
        let away = (found - expected).abs();
        assert_close(away.min(180.0 - away), 0.0, 90.0, "inclination");
    }
    let standing = of(&cuboid([1.0, 2.0, 3.0])).in_plane(plane());
    assert_eq!(standing.inclination, 90.0);
}

#[test]
fn deformation_depends_on_shape_alone() {
    let body = icosphere(2).map(bent);
    let reference = of(&body);
    let in_plane = reference.in_plane(plane());
    let turn = rotation(GENERIC);
    let scale = 3e-6;
    let other = of(&body.map(|x| moved(turned(turn, x)).map(|x| scale * x)));
    assert_close(other.taylor(), reference.taylor(), 1.0, "D");
    for (other, own) in other.semi_axes.into_iter().zip(reference.semi_axes) {
        assert_close(other, scale * own, scale, "semi-axis");
    }
    let axes = [[1.0, 0.0, 0.0], [0.2, 1.0, 0.0]].map(|axis| turned(turn, axis));
    let turned_plane = ShearPlane::new(axes[0], axes[1]).unwrap();
    let other = other.in_plane(turned_plane);
    assert_close(other.taylor(), in_plane.taylor(), 1.0, "D in the plane");
    assert_close(other.inclination, in_plane.inclination, 90.0, "inclination");
    // A mesh of the opposite orientation encloses the mirrored body.
    let mirrored = body.map(|[x, y, z]| [x, -y, z]);
    let found = of(&mirrored);
    assert!(found.volume < 0.0);
    assert_close(found.taylor(), reference.taylor(), 1.0, "D inside out");
    let mirrored = found.in_plane(plane()).inclination;
    assert_close(mirrored, -in_plane.inclination, 90.0, "mirrored");
}

#[test]
fn what_encloses_nothing_has_no_deformation() {
    assert!(Deformation::new(hemisphere(1).surface()).is_none());
    let flat = icosphere(1).map(|[x, y, _]| [x, y, 0.0]);
    assert!(Deformation::new(flat.surface()).is_none());
}

#[test]
fn planes_are_those_in_which_a_flow_shears() {
    let turn = rotation(GENERIC);
    let [along, across, normal] =
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| turned(turn, axis));
    let gradient = std::array::from_fn(|i| std::array::from_fn(|j| -40.0 * along[i] * across[j]));
    let found = ShearPlane::at(&Ambient::Linear { gradient }, [1.0, 2.0, 3.0]).unwrap();
    // Both directions may be reversed together.
    let same = |a: [f64; 3], b, what| assert_close(dot(a, b).abs(), 1.0, 1.0, what);
    same(found.flow(), along, "flow");
    same(found.gradient(), across, "gradient");
    assert_close(
        dot(found.flow(), along) * dot(found.gradient(), across),
        -1.0,
        1.0,
        "sign of the shear",
    );
    let shear = ShearPlane::at(&Ambient::shear(2.0), [0.0; 3]).unwrap();
    assert_close(dot(shear.normal(), [0.0, 0.0, 1.0]), 1.0, 1.0, "x to y");
    let tube = Ambient::Poiseuille {
        centre_velocity: 3.0,
        radius: 2.0,
        direction: along.map(|x| 5.0 * x),
        through: [1.0, 1.0, 1.0],
    };
    let beside = std::array::from_fn(|i| 1.0 + 0.3 * normal[i] - 4.0 * along[i]);
    let found = ShearPlane::at(&tube, beside).unwrap();
    same(found.flow(), along, "flow in a tube");
    same(found.gradient(), normal, "gradient in a tube");
    let sign = dot(found.flow(), along) * dot(found.gradient(), normal);
    assert_close(sign, -1.0, 1.0, "slower towards the wall");
    let compression = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0; 3]];
    for (flow, point) in [
        (
            Ambient::Linear {
                gradient: compression,
            },
            [0.0; 3],
        ),
        (Ambient::extension(1.0), [0.0; 3]),
        (Ambient::plane_extension(1.0), [0.0; 3]),
        (Ambient::shear(0.0), [0.0; 3]),
        (tube, std::array::from_fn(|i| 1.0 + 7.0 * along[i])),
    ] {
        assert_eq!(ShearPlane::at(&flow, point), None, "{flow:?}");
    }
    assert_eq!(ShearPlane::new([1.0, 2.0, 3.0], [-2.0, -4.0, -6.0]), None);
    assert_eq!(ShearPlane::new([0.0; 3], [1.0, 0.0, 0.0]), None);
}

/// A cube cut through its centre, parallel to a face: the extreme points are the corners and edge midpoints
/// of a square.
#[test]
fn extremes_are_those_of_the_cut() {
    let cube = cuboid([2.0; 3]).map(moved);
    let found = extremes(cube.surface(), moved([0.0; 3]), plane()).unwrap();
    assert_close(found[0], 2.0_f64.sqrt(), 1.0, "farthest");
    assert_close(found[1], 1.0, 1.0, "nearest");
    let mut errors = Vec::new();
    for refinement in 2..=4 {
        let body = stretched(refinement, SEMI_AXES).map(inclined(25.0));
        let found = extremes(body.surface(), of(&body).centroid, plane()).unwrap();
        let [a, b, _] = SEMI_AXES;
        errors.push((taylor(found) - taylor([a, b])).abs());
    }
    assert!(errors[2] < 0.3 * errors[0], "{errors:?}");
    DEFORMATION_EXTREMES.assert(errors[2], 0.0, 1.0, "D");
    assert_eq!(extremes(cube.surface(), [0.0; 3], plane()), None);
}

/// The nearest point lies on the lines of the cut, not on their extensions, as between spikes.
#[test]
fn extremes_are_points_of_the_surface() {
    let spiky = icosphere(2).map(|x| {
        let [a, b, c] = x.map(|x| (9.0 * x).sin());
        let factor = 1.0 + 0.5 * a * b + 0.2 * c;
        x.map(|x| factor * x)
    });
    let found = extremes(spiky.surface(), [0.0; 3], plane()).unwrap();
    let lines = section(spiky.surface(), [0.0; 3], [0.0, 0.0, 1.0]);
    let places = lines.iter().flat_map(|&[a, b]| {
        (0..=400).map(move |part| {
            let share = f64::from(part) / 400.0;
            norm(std::array::from_fn(|k| a[k] + share * (b[k] - a[k])))
        })
    });
    let [low, high] = places.fold([f64::INFINITY, 0.0], |[low, high], distance| {
        [low.min(distance), high.max(distance)]
    });
    assert_close(found[0], high, 1.0, "farthest");
    DEFORMATION_SAMPLED.assert(found[1], low, low, "nearest");
}

/// Sections of a sphere are closed, lie in the plane, and enclose the exact area.
#[test]
fn sections_are_closed_curves_around_the_inside() {
    let ball = icosphere(3);
    let normal = [0.3, -0.5, 0.8];
    for height in [0.0, 0.4, -0.7] {
        let point = normal.map(|x| height * x / norm(normal));
        let lines = section(ball.surface(), point, normal);
        let mut starts = Vec::from_iter(lines.iter().map(|line| line[0].map(f64::to_bits)));
        let mut ends = Vec::from_iter(lines.iter().map(|line| line[1].map(f64::to_bits)));
        starts.sort_unstable();
        ends.sort_unstable();
        assert_eq!(starts, ends);
        let mut area = 0.0;
        for [a, b] in lines {
            assert_close(dot(a, normal) / norm(normal), height, 1.0, "in the plane");
            area += 0.5 * dot(cross(a, b), normal) / norm(normal);
        }
        let expected = PI * (1.0 - height * height);
        SECTION_AREA.assert(area, expected, expected, "area");
    }
    // Vertices in the plane count to one side.
    let through = section(cuboid([2.0; 3]).surface(), [0.0; 3], [1.0, 1.0, 0.0]);
    let length: f64 = through
        .iter()
        .map(|[a, b]| norm(std::array::from_fn(|k| a[k] - b[k])))
        .sum();
    assert_close(length, 4.0 + 4.0 * 2.0_f64.sqrt(), 1.0, "around");
    assert!(section(ball.surface(), [0.0, 0.0, 1.5], [0.0, 0.0, 1.0]).is_empty());
}

#[test]
fn wrinkles_show_and_spheres_have_none() {
    let smooth = wrinkle_indicator(icosphere(3).map(|x| x.map(|x| 7.0 * x)).surface());
    WRINKLE_INDICATOR.assert(smooth, 1.0, 1.0, "sphere");
    let mut random = SplitMix64::new(5);
    let mut rough = icosphere(3);
    for position in &mut rough.positions {
        let factor = 1.0 + 0.02 * random.symmetric();
        *position = position.map(|x| factor * x);
    }
    assert!(wrinkle_indicator(rough.surface()) > 1.5);
}

/// The roughness is small on smooth surfaces, smaller on finer meshes, and about 1 if neighbouring vertices
/// alternate in height.
#[test]
fn roughness_is_of_the_scale_of_the_mesh() {
    let rough = |mesh: &Mesh| roughness(mesh.surface());
    let smooth = |refinement| icosphere(refinement).map(|[x, y, z]| [1.5 * x, y, 0.8 * z]);
    let [coarse, fine] = [rough(&smooth(2)), rough(&smooth(3))];
    assert!(coarse < 0.2 && fine < 0.5 * coarse, "{coarse}, {fine}");
    let wrinkled = smooth(3).map(|[x, y, z]| {
        let factor = 1.0 + 0.02 * (9173.0 * x + 5171.0 * y + 7919.0 * z).sin();
        [factor * x, factor * y, factor * z]
    });
    assert!(rough(&wrinkled) > 0.5, "{}", rough(&wrinkled));
}
