//! Deformation, inclination and tank-treading of known bodies; sections; plateaus of curves.
#![expect(
    clippy::unwrap_used,
    reason = "what fails in a helper fails the test that called it"
)]

use helfrich::Images;
use helfrich_std::checkpoint::{self, Fingerprint};
use helfrich_std::deformation::{
    Deformation, ShearPlane, TankTreading, extremes, first_plateau, roughness, taylor,
    wrinkle_indicator,
};
use helfrich_std::enclosure::{
    Inside, encloses, inside_of_images, inside_of_own_images, surroundings, vertices_inside,
};
use helfrich_std::flow::Ambient;
use helfrich_std::generate::{AnyShape, Family, generate};
use helfrich_std::section::section;
use helfrich_tests::accuracy::surface;
use helfrich_tests::meshes::{
    GENERIC, Mesh, SplitMix64, bent, cross, dot, hemisphere, icosphere, norm, octahedron, rotation,
    turned, unit,
};
use helfrich_tests::tolerance::Tolerance;
use std::f64::consts::{PI, TAU};
use tempfile::TempDir;

/// Moments, axes, angles and turns of polyhedra, relative to a natural scale.
const DEFORMATION: Tolerance = Tolerance::new(
    1e-12,
    "sums of a thousand terms of either sign, some thirty lengths from the origin",
);

/// A semi-axis extrapolated from two refinements, relative.
const DEFORMATION_EXTRAPOLATED: Tolerance =
    Tolerance::new(2e-5, "fourth order: 5e-3 of 642 vertices squared");

/// D of an irregular mesh of 642 vertices.
const DEFORMATION_RANDOM_MESH: Tolerance = Tolerance::new(
    5e-3,
    "the polyhedron's volume is 1 % short, more where it is curved more; D has the difference",
);

/// D by extreme points of a mesh of 2562 vertices.
const DEFORMATION_EXTREMES: Tolerance = Tolerance::new(
    2e-3,
    "chords are short of the curve by an eighth of the squared edge, 7e-4",
);

/// The nearest of 400 points on every line of a section, relative.
const DEFORMATION_SAMPLED: Tolerance = Tolerance::new(
    1e-4,
    "half a part of a line of a third of a radius is 4e-4, squared",
);

/// Areas of sections of a sphere of 642 vertices, relative.
const SECTION_AREA: Tolerance = Tolerance::new(
    2e-2,
    "chords of a polyhedron whose surface is up to 4e-3 inside; twice that at a height of 0.7",
);

/// The wrinkle indicator of a sphere of 642 vertices.
const WRINKLE_INDICATOR: Tolerance = Tolerance::new(1e-2, "second order in edges of 0.15 radii");

/// Turns of a tank-treading ellipsoid of 162 vertices.
const TANK_TREADING: Tolerance = Tolerance::new(
    1e-2,
    "some thirty vertices are not evenly spread in phase; whole turns are interpolated over 0.09",
);

/// First plateaus of known curves, relative to the plateau.
const PLATEAU: Tolerance = Tolerance::new(
    2e-3,
    "the slope over five points of a coarse curve is up to a quarter too steep or too gentle",
);

/// When a slope is least, relative.
const PLATEAU_TIME: Tolerance =
    Tolerance::new(5e-2, "one sample in twenty, where the slope is least");

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

/// Turned about z, from x to y.
fn inclined(degrees: f64) -> impl Fn([f64; 3]) -> [f64; 3] {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    move |[x, y, z]| [cosine * x - sine * y, sine * x + cosine * y, z]
}

fn moved([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x + 12.0, y - 31.0, z + 7.0]
}

/// A box with corners at ± half its sides.
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

/// The moments of a box are those of every textbook: a²/12 along a side a.
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

/// Icosahedra have isotropic moments, and affine maps keep ratios: D and θ of an inscribed ellipsoid
/// are exact; lengths are short by the polyhedron's second order.
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
        // At the seam either end may be found.
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
    // The other hand: the mesh inside out encloses the same body.
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
    // Both may point the other way, together.
    let same = |a, b, what| assert_close(dot(a, b).abs(), 1.0, 1.0, what);
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

/// A cube cut through the middle, parallel to a side: the corners and the middles of a square.
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

/// Where lines of the cut would come nearer beyond their ends, as between spikes, they do not count.
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

/// Sections of a sphere are closed, lie in the plane, and enclose the area that they should.
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
    // Through vertices: each is on one side.
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

/// Follows a body through time.
fn followed(times: usize, step: f64, body: impl Fn(f64) -> Mesh) -> TankTreading {
    let start = body(0.0);
    let mut state = TankTreading::new(start.surface(), &of(&start), plane(), 0.0);
    for count in 1..=times {
        let time = count as f64 * step;
        let now = body(time);
        state.update(time, now.surface(), &of(&now));
    }
    state
}

/// Half the shear rate, as rotation goes in a shear flow: from y to x.
#[test]
fn a_sphere_that_rotates_takes_its_period() {
    let omega = 1.3;
    let ball = icosphere(2);
    let spun = |time: f64| ball.map(|x| moved(inclined((-omega * time).to_degrees())(x)));
    let before = followed(40, 0.12, spun);
    assert_close(before.turns(), omega * 4.8 / TAU, 1.0, "turns");
    assert!(before.period().is_nan());
    let state = followed(100, 0.12, spun);
    assert_close(state.turns(), omega * 12.0 / TAU, 3.0, "turns");
    assert_close(state.period(), TAU / omega, 5.0, "period");
    assert_eq!(state.axis_turns(), 0.0);
    let back = followed(100, 0.12, |time| spun(-time));
    assert_close(back.turns(), -omega * 12.0 / TAU, 3.0, "turns backwards");
    assert_close(back.period(), TAU / omega, 5.0, "period backwards");
}

/// A body with dimples that lies in the shear plane: the bottoms of the dimples are near the plane and
/// on the axis, where nothing turns; the rims' outer parts are far from the plane.
#[test]
fn what_is_on_the_axis_or_far_from_the_plane_does_not_count() {
    let omega = 1.1;
    // With vertices at the poles.
    let ball = octahedron().divided().divided().divided().map(unit);
    let disc = ball.map(|[x, y, z]| [x, y, 0.4 * z * (x * x + y * y + 0.05)]);
    let spun = |time: f64| {
        disc.map(|[x, y, z]| match z.abs() {
            // Far from the plane the material stays.
            0.05.. => [x, y, z],
            _ => inclined((-omega * time).to_degrees())([x, y, z]),
        })
    };
    let pole = disc.positions.iter().map(|&[x, y, _]| x.hypot(y));
    assert_eq!(pole.fold(1.0, f64::min), 0.0);
    let state = followed(30, 0.1, spun);
    assert_close(
        state.turns() + state.axis_turns(),
        omega * 3.0 / TAU,
        1.0,
        "turns",
    );
}

/// Keller and Skalak's membrane: an ellipsoid that stays, whose points run around it.
#[test]
fn a_membrane_that_treads_takes_its_period() {
    let ball = icosphere(2);
    let [a, b, c] = SEMI_AXES;
    let treading = |time: f64| {
        ball.map(|x| {
            let [x, y, z] = inclined(-time.to_degrees())(x);
            moved(inclined(20.0)([a * x, b * y, c * z]))
        })
    };
    let state = followed(200, 0.09, treading);
    // In between the vertices of this mesh are not quite evenly spread in phase.
    TANK_TREADING.assert(state.turns(), 18.0 / TAU, 1.0, "turns");
    TANK_TREADING.assert(state.period(), TAU, 1.0, "period");
    assert_close(state.axis_turns(), 0.0, 1.0, "the axis stays");
}

/// The same membrane, whose mesh stays while its material goes by, and drifts as a whole.
#[test]
fn material_that_goes_by_takes_its_period() {
    let ball = icosphere(2);
    let [a, b, c] = SEMI_AXES;
    let drift = [0.4, -0.1, 0.2];
    let stays = ball.map(|[x, y, z]| [a * x, b * y, c * z]);
    let at = |time: f64| {
        stays.map(|x| {
            let x = moved(inclined(20.0)(x));
            std::array::from_fn(|axis| x[axis] + time * drift[axis])
        })
    };
    let velocities = Vec::from_iter(stays.positions.iter().map(|&[x, y, _]| {
        let going = inclined(20.0)([a / b * y, -b / a * x, 0.0]);
        std::array::from_fn(|axis| going[axis] + drift[axis])
    }));
    let start = at(0.0);
    let mut state = TankTreading::new(start.surface(), &of(&start), plane(), 0.0);
    for count in 1..=200 {
        let time = f64::from(count) * 0.09;
        let now = at(time);
        state.update_by_velocities(time, now.surface(), &of(&now), &velocities);
    }
    TANK_TREADING.assert(state.turns(), 18.0 / TAU, 1.0, "turns");
    TANK_TREADING.assert(state.period(), TAU, 1.0, "period");
    assert_close(state.axis_turns(), 0.0, 1.0, "the axis stays");
}

/// A rigid body that turns, by velocities that change from step to step.
#[test]
fn material_that_turns_with_its_body_does_not_tread() {
    let omega = |time: f64| 1.0 + 0.5 * time.cos();
    let angle = |time: f64| time + 0.5 * time.sin();
    let long = stretched(2, [1.0, 3.0, 1.0]);
    let at = |time: f64| long.map(inclined(-angle(time).to_degrees()));
    let start = at(0.0);
    let mut state = TankTreading::new(start.surface(), &of(&start), plane(), 0.0);
    for count in 1..=100 {
        let time = f64::from(count) * 0.1;
        let now = at(time);
        let turning = now
            .positions
            .iter()
            .map(|&[x, y, _]| [omega(time) * y, -omega(time) * x, 0.0]);
        let velocities = Vec::from_iter(turning);
        state.update_by_velocities(time, now.surface(), &of(&now), &velocities);
    }
    assert_close(state.axis_turns(), angle(10.0) / TAU, 1.0, "tumbling");
    // Second order in steps of a tenth, the first of which has no rate before it.
    TANK_TREADING.assert(state.turns(), 0.0, 1.0, "treading");
}

/// A rigid body in shear: G. B. Jeffery, Proc. R. Soc. A 102 (1922) 161.
#[test]
fn a_body_that_tumbles_does_not_tread() {
    let (rate, ratio) = (0.7, 3.0);
    let orbit = TAU / rate * (ratio + 1.0 / ratio);
    let from_gradient = |time: f64| {
        let phase = TAU * time / orbit;
        // The arc tangent of r tan, beyond its branch.
        (ratio * phase.sin()).atan2(phase.cos())
    };
    let long = stretched(2, [1.0, ratio, 1.0]);
    let tumbling = |time: f64| long.map(inclined(-from_gradient(time).to_degrees()));
    for part in 1..20 {
        let time = orbit * f64::from(part) / 20.0;
        let found = of(&tumbling(time)).in_plane(plane()).inclination;
        let expected = 90.0 - from_gradient(time).to_degrees();
        let away = (found - expected).rem_euclid(180.0);
        assert_close(away.min(180.0 - away), 0.0, 90.0, "inclination");
    }
    let state = followed(150, orbit / 100.0, tumbling);
    assert_close(state.axis_turns(), 1.5, 1.0, "tumbling");
    assert_close(state.turns(), 0.0, 1.0, "treading");
    assert!(state.period().is_nan());
}

/// The long axis of what is all but a sphere is where its mesh has it.
#[test]
fn the_axis_counts_from_when_there_is_one() {
    let ball = icosphere(1);
    let growing = |time: f64| {
        let (stretch, angle) = match time {
            0.0..0.45 => (1.0 + 1e-3, 170.0),
            _ => (1.5, 40.0 - 10.0 * time),
        };
        ball.map(|[x, y, z]| inclined(angle)([stretch * x, y, z]))
    };
    let state = followed(9, 0.2, growing);
    // From 34° at 0.6 to 22° at 1.8.
    assert_close(state.axis_turns(), 12.0 / 360.0, 1.0, "turns of the axis");
    // Round in between, it goes on from where it was.
    let waning = |time: f64| {
        let stretch = if (0.5..1.1).contains(&time) { 1.0 } else { 1.5 };
        ball.map(|[x, y, z]| inclined(40.0 - 10.0 * time)([stretch * x, y, z]))
    };
    let state = followed(9, 0.2, waning);
    assert_close(state.axis_turns(), 18.0 / 360.0, 1.0, "turns in all");
}

#[test]
fn treading_goes_on_from_its_stored_bits() {
    let ball = icosphere(1);
    let body = |time: f64| {
        ball.map(|x| {
            let [x, y, z] = inclined(-30.0 * time)(x);
            inclined(10.0 * time.sin())([1.4 * x, y, z])
        })
    };
    let whole = followed(60, 0.3, body);
    let half = followed(37, 0.3, body);
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("checkpoint");
    let fingerprint = Fingerprint::of("treading");
    checkpoint::write(&path, fingerprint, &half).unwrap();
    let mut resumed: TankTreading = checkpoint::read(&path, fingerprint).unwrap();
    assert_eq!(resumed, half);
    for count in 38..=60 {
        let time = f64::from(count) * 0.3;
        let now = body(time);
        resumed.update(time, now.surface(), &of(&now));
    }
    assert_eq!(resumed, whole);
}

fn sampled(step: f64, end: f64, curve: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
    let count = (end / step).round() as usize;
    let times = Vec::from_iter((0..=count).map(|at| at as f64 * step));
    let values = times.iter().map(|&time| curve(time)).collect();
    (times, values)
}

/// D∞ (1 − e^(−t/τ)) is short of D∞ by the fraction at which its slope counts as none.
#[test]
fn plateaus_are_found_before_curves_creep_on() {
    let limit = 0.0104;
    let rise = |time: f64| limit * (1.0 - (-time / 0.4).exp());
    let creep = |time: f64| rise(time) + 1e-4 * limit * time;
    let upturn = |time: f64| rise(time) + 2e-3 * limit * time * time;
    let overshoot = |time: f64| limit * (1.0 - (-time / 0.4).exp() * (2.0 * time).cos());
    for (step, what) in [(0.01, "fine"), (0.1, "coarse")] {
        let first = |curve: &dyn Fn(f64) -> f64| {
            let (times, values) = sampled(step, 10.0, curve);
            first_plateau(&times, &values, 2e-3).unwrap()
        };
        let plain = first(&rise);
        PLATEAU.assert(plain.value, limit * (1.0 - 2e-3), limit, what);
        PLATEAU.assert(first(&creep).value, limit, limit, what);
        // Its slope is least where 2 · 2·10⁻³ t = e^(−t/τ)/τ has the same slope on both sides.
        let turn = 0.4 * (1.0 / (4e-3 * 0.16_f64)).ln();
        let turned = first(&upturn);
        PLATEAU_TIME.assert(turned.time, turn, turn, what);
        // At the first maximum: tan 2t = −1/(2τ).
        let peak = 0.5 * (PI - (1.25_f64).atan());
        PLATEAU.assert(first(&overshoot).value, overshoot(peak), limit, what);
    }
}

/// Five points tell the slope of a parabola at their middle exactly: between samples the slope and
/// the curve are straight.
#[test]
fn plateaus_are_between_samples() {
    let (times, values) = sampled(0.1, 1.5, |time| time - 0.5 * time * time);
    // The steepest slope is that of the first three points, 0.9; a quarter of it is at 0.775.
    let found = first_plateau(&times, &values, 0.25).unwrap();
    assert_close(found.time, 0.775, 1.0, "time");
    assert_close(found.value, 0.455 + 0.75 * 0.025, 1.0, "value");
}

#[test]
fn plateaus_survive_the_last_digits_of_a_time_step() {
    let mut random = SplitMix64::new(11);
    let (mut times, mut values) = sampled(0.02, 8.0, |time| 0.1 * (1.0 - (-time / 0.5).exp()));
    for value in &mut values {
        *value += 1e-6 * random.symmetric();
    }
    let found = first_plateau(&times, &values, 2e-3).unwrap();
    PLATEAU.assert(found.value, 0.1, 0.1, "with noise");
    times.insert(7, 0.131);
    values.insert(7, f64::NAN);
    assert_eq!(first_plateau(&times, &values, 2e-3), Some(found));
    // Falling curves, curves that never rest, and curves at rest.
    let fallen = Vec::from_iter(values.iter().map(|value| -value));
    let fallen = first_plateau(&times, &fallen, 2e-3).unwrap();
    assert_eq!(fallen.value, -found.value);
    let (times, values) = sampled(0.1, 5.0, |time| 3.0 * time);
    assert_eq!(first_plateau(&times, &values, 1e-2), None);
    let rest = first_plateau(&times, &vec![2.0; times.len()], 1e-2).unwrap();
    assert_eq!(rest.value, 2.0);
    assert_eq!(first_plateau(&times[..4], &values[..4], 0.9), None);
}

/// Points of an ellipsoid are inside where the sum of squares says so, near, far, and on flat meshes.
#[test]
fn closed_surfaces_enclose_what_is_inside() {
    let axes = [2.0, 1.0, 0.5];
    let mesh = icosphere(3).map(|x| [0, 1, 2].map(|axis| axes[axis] * x[axis]));
    let mut random = SplitMix64::new(5);
    let mut inside = 0;
    for _ in 0..200 {
        let unit = [0; 3].map(|_| 1.3 * random.symmetric());
        let distance = unit.iter().map(|x| x * x).sum::<f64>().sqrt();
        // Between the polyhedron and the ellipsoid nothing is asked.
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

/// The innermost of the closed surfaces around each one, whatever their order; what lies across another
/// one lies in none.
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
    // The hemisphere of radius 1 lies in the fifth, and nothing in it.
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

/// In a periodic box what lies in an image lies in the surface, wherever in the box it is; what lies across
/// the wall of one lies in none.
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

/// By an image as by the surface itself, wherever in the box both are; and by several of a short box.
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
    let direct = inside_of_images(direct.surface(), sphere.surface(), &images);
    let [expected] = direct.try_into().expect("one");
    assert!(!expected.is_by_image() && expected.count < 42);
    for shift in [[4.0, 0.0, 0.0], [-8.0, 0.0, 3.0], [0.0, 0.0, -300.0]] {
        let moved = at([1.0 + shift[0], 0.25, shift[2]]);
        let found = inside_of_images(moved.surface(), sphere.surface(), &images);
        let shift = shift.map(|length| 0.0 - length);
        assert_eq!(found, [Inside { shift, ..expected }]);
    }
    // No period along y.
    let beside = at([1.0, 4.25, 0.0]);
    let found = inside_of_images(beside.surface(), sphere.surface(), &images);
    assert_eq!(found, []);
    // Half of it in the one, half of it in the next.
    let touching = Images {
        periods: [2.0, 0.0, 0.0],
        own: false,
    };
    let found = inside_of_images(at([1.0, 0.0, 0.0]).surface(), sphere.surface(), &touching);
    assert_eq!(
        Vec::from_iter(found.iter().map(|inside| inside.shift[0])),
        [-2.0, 0.0]
    );
    assert_eq!(inside_of_own_images(sphere.surface(), &images), []);
    let long = sphere.map(|[x, y, z]| [2.2 * x, y, z]);
    let found = inside_of_own_images(long.surface(), &images);
    assert_eq!(
        Vec::from_iter(found.iter().map(|inside| inside.shift[0])),
        [-4.0, 4.0]
    );
}

/// Little on smooth surfaces, less on finer meshes; about 1 where vertices go up and down in turn.
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
