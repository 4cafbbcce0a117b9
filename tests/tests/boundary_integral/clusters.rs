//! Sums over clusters against those over all pairs.

use super::{Field, ONE, VISCOSITY, at_points, at_vertices, away, largest_norm, layer, together};
use helfrich_std::flow::{DoubleLayer, SingleLayer};
use helfrich_tests::meshes::{Mesh, bent, difference, disc, icosphere, norm, torus};
use std::num::NonZeroUsize;

/// The degree of the polynomials rises in steps as the tolerance falls, so that some tolerances are met with
/// less to spare than others.
const TOLERANCES: [f64; 3] = [1e-3, 3e-6, 1e-8];

/// Elongated, round, bent and open bodies, and two close to each other. The order of the vertices does not
/// follow their positions.
fn bodies() -> Vec<(&'static str, Vec<Mesh>)> {
    let ball = icosphere(4);
    let needle = ball.map(|[x, y, z]| [5.0 * x, 0.5 * y, 0.5 * z]);
    let small = icosphere(3);
    let pair = [&small.map(bent), &away(&small, [0.3, 2.51, 0.0])];
    vec![
        ("needle", vec![needle.relabelled(3).0]),
        ("torus", vec![torus(48, 24)]),
        ("disc", vec![disc(24)]),
        ("pair", pair.map(Mesh::clone).into()),
    ]
}

fn rms(field: &[[f64; 3]]) -> f64 {
    let squares = field.iter().flatten().map(|x| x * x).sum::<f64>();
    (squares / field.len() as f64).sqrt()
}

fn errors(dense: &[[f64; 3]], found: &[[f64; 3]]) -> Field {
    let pairs = dense.iter().zip(found);
    pairs.map(|(&a, &b)| difference(a, b)).collect()
}

/// Vector field of several wavelengths, with values of both signs.
fn values(positions: &[[f64; 3]]) -> Field {
    let value = |&[x, y, z]: &[f64; 3]| [x - y * z, (9.0 * z).sin(), (41.0 * x).cos() - y];
    positions.iter().map(value).collect()
}

/// Points around, inside and on the surfaces.
fn points(positions: &[[f64; 3]]) -> Field {
    let scaled = |factor: f64| move |x: &[f64; 3]| x.map(|x| factor * x);
    let around = positions.iter().step_by(3).map(scaled(1.317));
    let inside = positions.iter().step_by(7).map(scaled(0.617));
    let on = positions.iter().copied().step_by(97);
    around.chain(inside).chain(on).collect()
}

#[track_caller]
fn assert_within(tolerance: f64, scale: f64, dense: &[[f64; 3]], found: &[[f64; 3]], what: &str) {
    let errors = errors(dense, found);
    let (mean, largest) = (rms(&errors) / scale, largest_norm(&errors) / scale);
    assert!(mean <= 2.0 * tolerance, "{what}, {tolerance:e}: {mean:e}");
    assert!(
        largest <= 20.0 * tolerance,
        "{what}, {tolerance:e}: {largest:e}"
    );
    // A mean error of zero would mean that the clusters were not used.
    assert!(mean > 0.0, "{what}, {tolerance:e}: all pairs");
}

#[test]
fn clusters_of_single_layers_keep_their_tolerance() {
    for (name, bodies) in bodies() {
        let bodies = Vec::from_iter(&bodies);
        let positions = together(&bodies);
        let tractions = values(&positions);
        let points = points(&positions);
        let one_way = Vec::from_iter(tractions.iter().map(|&q| [norm(q), 0.0, 0.0]));
        let scale = rms(&at_vertices(&layer(&bodies, &one_way)));
        let mut layer = layer(&bodies, &tractions);
        let dense = at_vertices(&layer);
        let dense_at_points = at_points(&layer, &points);
        for tolerance in TOLERANCES {
            layer.set_cluster_tolerance(tolerance);
            layer.set_tractions(&positions, &tractions);
            assert_within(tolerance, scale, &dense, &at_vertices(&layer), name);
            let found = at_points(&layer, &points);
            assert_within(tolerance, scale, &dense_at_points, &found, name);
        }
    }
}

/// Velocities of the double layer at the vertices and at the points.
fn twice(layer: &DoubleLayer, points: &[[f64; 3]]) -> [Field; 2] {
    let mut fields = [
        vec![[0.0; 3]; layer.vertex_count()],
        vec![[0.0; 3]; points.len()],
    ];
    let [vertices, others] = &mut fields;
    layer.add_at_vertices(vertices);
    layer.add_at_points(points, others);
    fields
}

#[test]
fn clusters_of_double_layers_keep_their_tolerance() {
    for (name, bodies) in bodies() {
        let bodies = Vec::from_iter(&bodies);
        if !bodies.iter().all(|body| body.connectivity.is_closed()) {
            continue;
        }
        let positions = together(&bodies);
        let points = points(&positions);
        let ratios = &[5.0, 0.2][..bodies.len()];
        let meshes = bodies.iter().map(|body| &body.connectivity);
        let mut layer = DoubleLayer::new(meshes, ratios, ONE);
        // A rigid motion, whose double layer cancels, and a general field.
        let turning = Vec::from_iter(positions.iter().map(|&[x, y, _]| [1.0 - y, x, 0.5]));
        for (which, velocities) in [("turning", turning), ("any", values(&positions))] {
            let scale = 4.0 * rms(&velocities);
            let mut fields = |tolerance| {
                layer.set_cluster_tolerance(tolerance);
                layer.set_positions(&positions);
                layer.set_velocities(&velocities);
                twice(&layer, &points)
            };
            let dense = fields(0.0);
            for tolerance in TOLERANCES {
                for (dense, found) in dense.iter().zip(fields(tolerance)) {
                    assert_within(tolerance, scale, dense, &found, &format!("{name}, {which}"));
                }
            }
        }
    }
}

#[test]
fn clusters_do_not_depend_on_the_number_of_threads() {
    let bodies = [icosphere(4).map(bent), away(&icosphere(3), [0.0, 2.3, 0.0])];
    let bodies = Vec::from_iter(&bodies);
    let positions = together(&bodies);
    let points = points(&positions);
    let fields = |threads| {
        let threads = NonZeroUsize::new(threads).unwrap();
        let meshes = || bodies.iter().map(|body| &body.connectivity);
        let mut single = SingleLayer::new(meshes(), VISCOSITY, threads);
        single.set_cluster_tolerance(1e-4);
        single.set_tractions(&positions, &values(&positions));
        let mut double = DoubleLayer::new(meshes(), &[3.0, 0.5], threads);
        double.set_cluster_tolerance(1e-4);
        double.set_positions(&positions);
        double.set_velocities(&values(&positions));
        (
            at_vertices(&single),
            at_points(&single, &points),
            twice(&double, &points),
        )
    };
    let alone = fields(1);
    for threads in [2, 3, 7] {
        assert!(fields(threads) == alone, "{threads}");
    }
}

#[test]
fn clusters_of_strange_positions_are_those_of_all_pairs() {
    type Place<'a> = &'a dyn Fn(usize, [f64; 3]) -> [f64; 3];
    // Ten times as many vertices as a cluster has at least.
    let ball = icosphere(3);
    let strange: [(&str, Place<'_>); 5] = [
        ("in one point", &|_, _| [0.3, 0.4, 0.5]),
        ("flat", &|_, [x, y, _]| [x, y, 0.0]),
        ("on a line", &|_, [x, _, _]| [x, 2.0 * x, 3.0 * x]),
        ("with one far away", &|k, x| {
            if k == 77 { [1e9, 1e9, 0.0] } else { x }
        }),
        ("small", &|_, x| x.map(|x| 1e-150 * x)),
    ];
    for (what, place) in strange {
        let positions = ball.positions.iter().enumerate();
        let positions = Vec::from_iter(positions.map(|(k, &x)| place(k, x)));
        let tractions = vec![[1.0, -2.0, 0.5]; positions.len()];
        let mut layer = SingleLayer::new([&ball.connectivity], VISCOSITY, ONE);
        layer.set_tractions(&positions, &tractions);
        let dense = at_vertices(&layer);
        layer.set_cluster_tolerance(1e-4);
        layer.set_tractions(&positions, &tractions);
        let found = at_vertices(&layer);
        let error = rms(&errors(&dense, &found));
        assert!(
            error <= 1e-4 * rms(&dense),
            "{what}: {error:e} of {:e}",
            rms(&dense)
        );
    }
    // A NaN spreads to all velocities, as in the sum over all pairs.
    let mut positions = ball.positions.clone();
    positions[123][1] = f64::NAN;
    let mut layer = SingleLayer::new([&ball.connectivity], VISCOSITY, ONE);
    layer.set_cluster_tolerance(1e-4);
    layer.set_tractions(&positions, &ball.positions);
    assert!(at_vertices(&layer).iter().flatten().all(|u| u.is_nan()));
}

/// Sums in single precision over points that are far apart, in units of the distances between neighbours.
#[test]
fn clusters_of_small_distant_bodies_keep_their_tolerance() {
    let tolerance = 1e-4;
    for distance in [1e1, 1e3, 1e5, 1e12] {
        let small = icosphere(1);
        let bodies = Vec::from_iter((0..40_u32).map(|k| {
            let angle = f64::from(k);
            let place = [angle.sin(), angle.cos(), (0.7 * angle).sin()];
            away(&small, place.map(|x| distance * x))
        }));
        let bodies = Vec::from_iter(&bodies);
        let positions = together(&bodies);
        // Each body has the same, so that velocities do not cancel.
        let tractions = vec![[1.0, -2.0, 0.5]; positions.len()];
        let mut layer = layer(&bodies, &tractions);
        let dense = at_vertices(&layer);
        layer.set_cluster_tolerance(tolerance);
        layer.set_tractions(&positions, &tractions);
        let what = format!("{distance:e} apart");
        let found = at_vertices(&layer);
        assert_within(tolerance, rms(&dense), &dense, &found, &what);
    }
}

#[test]
fn clusters_do_not_depend_on_units() {
    let ball = icosphere(4).map(bent);
    let tractions = values(&ball.positions);
    let velocities = |length: f64, strength: f64| {
        let scaled = |field: &[[f64; 3]], unit: f64| {
            Vec::from_iter(field.iter().map(|v| v.map(|x| unit * x)))
        };
        let positions = scaled(&ball.positions, length);
        let mut layer = SingleLayer::new([&ball.connectivity], VISCOSITY, ONE);
        layer.set_cluster_tolerance(1e-4);
        layer.set_tractions(&positions, &scaled(&tractions, strength));
        scaled(&at_vertices(&layer), (length * strength).recip())
    };
    let expected = velocities(1.0, 1.0);
    // Beyond the range of single precision.
    for power in [-100, 100] {
        let unit = 2.0_f64.powi(power);
        assert!(velocities(unit, 1.0) == expected, "lengths times 2^{power}");
        assert!(velocities(1.0, unit) == expected, "forces times 2^{power}");
    }
}

#[test]
fn few_points_and_no_surfaces_have_clusters() {
    let mesh = icosphere(0);
    let mut layer = layer(&[&mesh], &mesh.positions);
    let dense = at_vertices(&layer);
    layer.set_cluster_tolerance(1e-4);
    layer.set_tractions(&mesh.positions, &mesh.positions);
    let found = at_vertices(&layer);
    assert!(rms(&errors(&dense, &found)) <= 1e-4 * rms(&dense));
    assert!(at_points(&layer, &[]).is_empty());
    let mut none = SingleLayer::new([], VISCOSITY, ONE);
    none.set_cluster_tolerance(1e-4);
    none.set_tractions(&[], &[]);
    assert_eq!(at_points(&none, &[[1.0; 3]]), [[0.0; 3]]);
}
