//! New meshes of smooth surfaces: even triangles, curvatures that survive, borders and creases that stay.

use crate::noise::{disturbed, mean_edge};
use helfrich::shapes::Shape;
use helfrich::{
    Curvature, Curvatures, Jet, Method, Real, Remeshed, Remeshing, Serial, SmoothSurface, Surface,
    TriangleMesh, VertexKind, crossing_triangles,
};
use helfrich_std::generate::{AnyShape, Family, generate};
use helfrich_std::remesh::{EdgeLengths, MeshRequest, OfNoise, RemeshError, carried, remeshed};
use helfrich_tests::meshes::rows::{ExactMesh, Rows, drum, ellipsoid};
use helfrich_tests::meshes::{self, Mesh, difference, dot, norm};

const EVEN: Remeshing<'_, f64> = Remeshing {
    sizes: &[],
    vertices: None,
    rounds: Remeshing::<f64>::ROUNDS,
};

/// A new mesh with this number of vertices, and edges of the same length everywhere.
fn even(smooth: &SmoothSurface<f64>, vertices: usize) -> Remeshed<f64> {
    let sizes = vec![1.0; smooth.surface().mesh().vertex_count()];
    let settings = Remeshing {
        sizes: &sizes,
        vertices: Some(vertices),
        ..EVEN
    };
    smooth
        .remesh(&Serial, &settings, &mut |_| true)
        .expect("not interrupted")
}

fn smooth(surface: Surface<'_, f64>) -> SmoothSurface<f64> {
    SmoothSurface::new(&Serial, surface, &SmoothSurface::jet_for(surface.mesh()))
}

fn positions<T: Real>(remeshed: &Remeshed<T>) -> Vec<[T; 3]> {
    remeshed.points.iter().map(|point| point.position).collect()
}

/// The smallest angle of each triangle in degrees, in increasing order.
fn smallest_angles(mesh: &TriangleMesh, positions: &[[f64; 3]]) -> Vec<f64> {
    let surface = Surface::new(mesh, positions).expect("positions");
    let angles = (0..mesh.triangles().len()).map(|triangle| {
        let angles = surface.triangle_angles(triangle);
        angles
            .into_iter()
            .fold(f64::INFINITY, f64::min)
            .to_degrees()
    });
    let mut angles = Vec::from_iter(angles);
    angles.sort_by(f64::total_cmp);
    angles
}

/// H by jets of degree 6.
fn mean_curvatures(mesh: &TriangleMesh, positions: &[[f64; 3]]) -> Vec<f64> {
    let surface = Surface::new(mesh, positions).expect("positions");
    let mut workspace = Jet::j6().workspace(mesh);
    let mut found = vec![Curvature::default(); positions.len()];
    Jet::j6().curvatures(&Serial, surface, &mut workspace, &mut found);
    found.iter().map(|curvature| curvature.mean).collect()
}

fn worst(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, f64::max)
}

/// H of the ellipsoid with semi-axes 1, 0.8, 0.5 at a point of it.
fn of_ellipsoid(at: [f64; 3]) -> f64 {
    let axes = [1.0, 0.8, 0.5];
    let terms = at
        .iter()
        .zip(axes)
        .map(|(x, a): (_, f64)| (x / (a * a)).powi(2));
    let square: f64 = terms.sum();
    let squares: f64 = axes.iter().map(|a| a * a).sum();
    (squares - dot(at, at)) / (2.0 * 0.16 * square.powf(1.5))
}

/// Also with fewer and more vertices. Remeshers that put vertices on flat triangles lose H wholly.
#[test]
fn curvatures_survive_even_triangles() {
    let shape: AnyShape = "ellipsoid:1,0.8,0.5".parse().expect("a shape");
    let mut before = f64::INFINITY;
    for vertices in [642, 2562] {
        let made = generate(&shape, Family::Irregular, vertices, 3).expect("a mesh");
        let surface = Surface::new(&made.mesh, &made.positions).expect("positions");
        let exact = made.preimages.iter().map(|&at| shape.at(at).mean);
        let found = mean_curvatures(&made.mesh, &made.positions);
        let of_input = worst(exact.zip(found).map(|(exact, found)| (found - exact).abs()));
        let smooth = smooth(surface);
        let remeshed = even(&smooth, vertices);
        let places = positions(&remeshed);
        assert_eq!(places.len(), vertices);
        let angles = smallest_angles(&remeshed.mesh, &places);
        assert!(angles[0] > 34.0, "{}", angles[0]);
        assert!(
            angles[angles.len() / 2] > 52.0,
            "{}",
            angles[angles.len() / 2]
        );
        let found = mean_curvatures(&remeshed.mesh, &places);
        let errors = places
            .iter()
            .zip(found)
            .map(|(&at, found)| (found - of_ellipsoid(at)).abs());
        let error = worst(errors);
        assert!(error < 5.0 * of_input, "{vertices}: {error} {of_input}");
        assert!(error < before / 8.0, "{vertices}: {error} {before}");
        before = error;
        let triangles = remeshed.mesh.triangles().len();
        assert_eq!(triangles, 2 * vertices - 4);
    }
}

/// A sphere of 12 latitudes of 100 vertices each, whose edges differ by a factor of 9.
#[test]
fn rows_become_even() {
    let rows = ellipsoid([1.0; 3], 100, 11, Rows::Latitudes);
    let ExactMesh { mesh, .. } = rows;
    let remeshed = even(&smooth(mesh.surface()), mesh.positions.len());
    let places = positions(&remeshed);
    let angles = smallest_angles(&remeshed.mesh, &places);
    assert!(angles[0] > 30.0, "{}", angles[0]);
    let found = mean_curvatures(&remeshed.mesh, &places);
    let error = worst(found.iter().map(|mean| (mean - 1.0).abs()));
    assert!(error < 0.01, "{error}");
}

/// The rim of a spherical cap is a circle: its new vertices are as near to it as cubics through four neighbours are,
/// of order 4, and all are on the sphere.
#[test]
fn borders_keep_their_curve() {
    let mut before = f64::INFINITY;
    for rings in [8, 16] {
        let cap = meshes::cap(rings, 1.0);
        let (height, radius) = (1.0_f64.cos(), 1.0_f64.sin());
        for (part, times) in [(1, 2), (2, 1)] {
            let count = cap.positions.len() * times / part;
            let remeshed = even(&smooth(cap.surface()), count);
            let places = positions(&remeshed);
            let rim = places.iter().enumerate().filter_map(|(vertex, [x, y, z])| {
                let is_rim = remeshed.mesh.vertex_kind(vertex) == VertexKind::Boundary;
                is_rim.then(|| (z - height).abs().max((x.hypot(*y) - radius).abs()))
            });
            let off = worst(rim);
            assert!(
                off < 3e-5 * 16.0 * (8.0 / f64::from(rings)).powi(4),
                "{rings}: {off}"
            );
            let off = worst(places.iter().map(|&at| (norm(at) - 1.0).abs()));
            assert!(off < before, "{rings}: {off}");
            let angles = smallest_angles(&remeshed.mesh, &places);
            assert!(angles[0] > 25.0, "{}", angles[0]);
            assert_eq!(remeshed.mesh.euler_characteristic(), 1);
        }
        before = 1e-6;
    }
}

/// Edges of which the triangles differ by more than 60°.
fn sharp_edges(mesh: &Mesh) -> Vec<[u32; 2]> {
    mesh.surface().creases(1.0)
}

/// A drum has two rims where its flat ends meet its side. Both are fitted alone, so that no fit crosses a rim.
#[test]
fn creases_stay_sharp() {
    let drum = drum(48);
    let lines = sharp_edges(&drum);
    assert_eq!(lines.len(), 96);
    let smooth = SmoothSurface::with_lines(&Serial, drum.surface(), &Jet::j6(), &lines);
    for count in [drum.positions.len() / 2, 2 * drum.positions.len()] {
        let remeshed = even(&smooth, count);
        let places = positions(&remeshed);
        let off = |[x, y, z]: [f64; 3]| {
            let [side, end] = [(x.hypot(y) - 1.0).abs(), (z.abs() - 1.0).abs()];
            side.min(end)
        };
        let error = worst(places.iter().map(|&at| off(at)));
        assert!(error < 1e-5, "{error}");
        let on_rim = places
            .iter()
            .filter(|[x, y, z]| (x.hypot(*y) - 1.0).abs() < 1e-5 && (z.abs() - 1.0).abs() < 1e-5);
        // Edges of the wanted length on two circles.
        let edge = (10.0 / 3.0_f64.sqrt() * std::f64::consts::PI * 2.0 / 2.5 / count as f64).sqrt();
        let expected = 4.0 * std::f64::consts::PI / edge;
        let found = on_rim.count() as f64;
        assert!((found / expected - 1.0).abs() < 0.5, "{found} {expected}");
        let angles = smallest_angles(&remeshed.mesh, &places);
        assert!(angles[0] > 30.0, "{}", angles[0]);
        // No triangle crosses a rim: every normal is that of an end or of the side.
        let surface = Surface::new(&remeshed.mesh, &places).expect("positions");
        for triangle in 0..remeshed.mesh.triangles().len() {
            let height = surface.triangle_normal(triangle)[2].abs();
            assert!(!(0.2..0.98).contains(&height), "{height}");
        }
    }
}

/// Lengths of edges follow the sizes at the vertices of the input, and have them in the mean: without regard to the number of
/// triangles, edges are a tenth too short.
/// Triangles in a plane, one of which has the edge from vertex 0 to 1 as its long side, is as high as `low` and turned by
/// an angle about that side; beyond the edge is a triangle with this apex.
fn around_sliver(low: f64, angle: f64, beyond: [f64; 3]) -> Mesh {
    let apex = [0.5, low * angle.cos(), low * angle.sin()];
    Mesh {
        positions: vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            apex,
            [0.5, 1.0, 0.0],
            beyond,
        ],
        connectivity: TriangleMesh::new(5, vec![[0, 1, 2], [1, 3, 2], [3, 0, 2], [1, 0, 4]])
            .expect("a mesh"),
    }
}

/// A low triangle that stands out alone is no fold, and one that lies in a plane hides none.
#[test]
fn slivers_are_no_creases() {
    let limit = 60_f64.to_radians();
    let creases = |low: f64, degrees: f64, beyond: [f64; 3]| {
        let mesh = around_sliver(low, degrees.to_radians(), beyond);
        mesh.surface().creases(limit).len()
    };
    for low in [0.5, 0.1, 0.01] {
        for degrees in [0.0, 10.0] {
            assert_eq!(
                creases(low, degrees, [0.5, 0.0, -1.0]),
                1,
                "{low} {degrees}"
            );
        }
    }
    // A high triangle in a plane has folds at its sides; of a low one, these are errors of its apex.
    assert!(creases(0.5, 80.0, [0.5, -1.0, 0.0]) > 0);
    assert_eq!(creases(0.01, 80.0, [0.5, -1.0, 0.0]), 0);
    let mesh = sliver_ellipsoid(1000, 99, 0.3);
    assert_eq!(mesh.surface().creases(limit), Vec::<[u32; 2]>::new());
}

/// A flat ellipsoid with triangles of all shapes, down to slivers that are turned by more than 60°.
fn sliver_ellipsoid(vertices: usize, seed: u64, flat: f64) -> Mesh {
    let shape: AnyShape = "sphere".parse().expect("a shape");
    let generated = generate(&shape, Family::Hard, vertices, seed).expect("a mesh");
    Mesh {
        positions: Vec::from_iter(
            generated
                .positions
                .iter()
                .map(|&[x, y, z]| [x, y, flat * z]),
        ),
        connectivity: generated.mesh,
    }
}

/// Slivers of the input leave no triangle whose normal points inwards, by the exact ellipsoid at its corners.
#[test]
fn no_triangle_is_turned() {
    for (seed, flat) in [(0, 0.2), (3, 0.2), (16, 0.3), (19, 0.3)] {
        let mesh = sliver_ellipsoid(400, seed, flat);
        for lengths in [EdgeLengths::Uniform(1.0), EdgeLengths::ByCurvature(0.4)] {
            let request = MeshRequest {
                lengths,
                vertices: None,
                creases: 60_f64.to_radians(),
                noise: OfNoise::Refused,
            };
            let remeshed = remeshed(mesh.surface(), &request, &mut |_| true);
            let remeshed = remeshed.expect("a mesh").made;
            let places = positions(&remeshed);
            let surface = Surface::new(&remeshed.mesh, &places).expect("positions");
            for (triangle, corners) in remeshed.mesh.triangles().iter().enumerate() {
                let normal = surface.triangle_normal(triangle);
                let outward = corners.map(|corner| {
                    let [x, y, z] = places[corner as usize];
                    dot(normal, [x, y, z / (flat * flat)])
                });
                assert!(outward.iter().sum::<f64>() > 0.0, "{seed}: {outward:?}");
            }
        }
    }
}

#[test]
fn edges_have_the_wanted_lengths() {
    let sphere = meshes::icosphere(4);
    let sizes = sphere.positions.iter().map(|at| 0.06 + 0.04 * at[2]);
    let sizes = Vec::from_iter(sizes);
    let smooth = smooth(sphere.surface());
    let settings = Remeshing {
        sizes: &sizes,
        ..EVEN
    };
    let remeshed = smooth
        .remesh(&Serial, &settings, &mut |_| true)
        .expect("not interrupted");
    let places = positions(&remeshed);
    let ratios = remeshed.mesh.edges().iter().map(|edge| {
        let [from, to] = edge.map(|vertex| places[vertex as usize]);
        let wanted = 0.06 + 0.02 * (from[2] + to[2]);
        norm(difference(to, from)) / wanted
    });
    let ratios = Vec::from_iter(ratios);
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    assert!((mean - 1.0).abs() < 0.03, "{mean}");
    let within = ratios
        .iter()
        .filter(|&ratio| (0.6..1.5).contains(ratio))
        .count();
    assert!(
        within * 100 > ratios.len() * 98,
        "{within} of {}",
        ratios.len()
    );
}

/// The two sides of a lens are nearer to each other than the new edges are long.
#[test]
fn thin_surfaces_do_not_cross_themselves() {
    for (name, vertices) in [("ellipsoid:1,1,0.05", 162), ("ellipsoid:1,0.1,0.1", 642)] {
        let shape: AnyShape = name.parse().expect("a shape");
        let made = generate(&shape, Family::Irregular, 642, 1).expect("a mesh");
        let surface = Surface::new(&made.mesh, &made.positions).expect("positions");
        assert!(crossing_triangles(surface).is_empty());
        let remeshed = even(&smooth(surface), vertices);
        let places = positions(&remeshed);
        let surface = Surface::new(&remeshed.mesh, &places).expect("positions");
        assert!(crossing_triangles(surface).is_empty());
        assert!(surface.volume().expect("closed") > 0.0);
        assert!(remeshed.crossings.is_empty());
    }
}

/// The planes of two triangles cross, and each has an edge through the other one.
#[test]
fn crossing_triangles_are_found() {
    let positions = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.2, 0.2, -1.0],
        [0.2, 0.2, 1.0],
        [2.0, 2.0, 0.0],
    ];
    let mesh = TriangleMesh::new(6, vec![[0, 1, 2], [3, 4, 5]]).expect("a mesh");
    let surface = Surface::new(&mesh, &positions).expect("positions");
    assert_eq!(crossing_triangles(surface), [[0, 1]]);
    let apart = positions.map(|[x, y, z]| [x, y, if z == 0.0 { z } else { z + 1.5 }]);
    let surface = Surface::new(&mesh, &apart).expect("positions");
    assert!(crossing_triangles(surface).is_empty());
}

/// Rough positions of f32: whatever comes out is a mesh of finite positions.
#[test]
fn rough_surfaces_of_single_precision_have_new_meshes() {
    let mut random = meshes::SplitMix64::new(5);
    let sphere = meshes::icosphere(2);
    let rough = sphere.positions_in::<f32>().into_iter();
    let rough = rough.map(|x| x.map(|x| x + 0.05 * random.symmetric() as f32));
    let rough = Vec::from_iter(rough);
    let surface = Surface::new(&sphere.connectivity, &rough).expect("positions");
    let smooth = SmoothSurface::new(&Serial, surface, &Jet::j4());
    let sizes = vec![0.2_f32; rough.len()];
    let settings = Remeshing {
        sizes: &sizes,
        vertices: None,
        rounds: 5,
    };
    let remeshed = smooth
        .remesh(&Serial, &settings, &mut |_| true)
        .expect("not interrupted");
    let places = positions(&remeshed);
    let surface = Surface::new(&remeshed.mesh, &places).expect("finite positions");
    assert_eq!(surface.mesh().euler_characteristic(), 2);
}

#[test]
fn an_interruption_ends_the_work() {
    let sphere = meshes::icosphere(2);
    let smooth = smooth(sphere.surface());
    let sizes = vec![1.0; sphere.positions.len()];
    let settings = Remeshing {
        sizes: &sizes,
        ..EVEN
    };
    let mut calls = 0;
    let stopped = smooth.remesh(&Serial, &settings, &mut |done| {
        calls += 1;
        assert!((0.0..1.0).contains(&done));
        calls < 3
    });
    assert!(stopped.is_none() && calls == 3);
}

/// Order 4 at least, of the largest error, after three remeshings that each change the number of vertices; labels stay
/// what they are, off the border between them.
#[test]
fn fields_and_labels_survive_three_remeshings() {
    let errors = [600, 2400].map(|vertices| {
        let shape: AnyShape = "torus:1,0.4".parse().expect("a shape");
        let made = generate(&shape, Family::Irregular, vertices, 1).expect("a mesh");
        let (mut mesh, mut places) = (made.mesh, made.positions);
        let wave = |[x, y, z]: [f64; 3]| (2.0 * x).sin() + y * z;
        let label = |[x, ..]: [f64; 3]| if x > 0.0 { 5.0 } else { 3.0 };
        let mut fields = [
            Vec::from_iter(places.iter().map(|&at| wave(at))),
            Vec::from_iter(places.iter().map(|&at| label(at))),
        ];
        for part in [1.2, 0.9, 1.0] {
            let surface = Surface::new(&mesh, &places).expect("positions");
            let smooth = smooth(surface);
            let remeshed = even(&smooth, (part * vertices as f64) as usize);
            let carried = carried(&smooth, &remeshed.places, &[&fields[0], &fields[1]]);
            fields = carried.try_into().expect("two fields");
            places = positions(&remeshed);
            mesh = remeshed.mesh;
        }
        // At most an edge for each remeshing; edges are 0.22 long at 600 vertices.
        for (&at, &found) in places.iter().zip(&fields[1]) {
            assert!(found == 5.0 || found == 3.0, "{found}");
            assert!(found == label(at) || at[0].abs() < 0.66, "{at:?}");
        }
        let errors = places.iter().zip(&fields[0]);
        worst(errors.map(|(&at, found)| (found - wave(at)).abs()))
    });
    let order = (errors[0] / errors[1]).log2();
    assert!(order > 4.0, "{order}, {errors:?}");
}

/// Misfits show noise of a size that is refused, and are far smaller without it.
///
/// At 642 vertices this holds for the ellipsoid alone: `Noise::of`, which has the last word, finds nothing on the discocyte
/// with noise of 1.5e-3 or 3e-3 edges, nor on the torus with 1e-2, because fits do not resolve these shapes there. Misfits
/// alone cannot tell: those of noise of 1.5e-3 on the discocyte are 8e-4 edges, and those of its exact mesh of 300
/// vertices 1.5e-3.
#[test]
fn noise_is_refused_where_fits_show_it() {
    for (name, vertices) in [("ellipsoid:1,0.8,0.6", 642), ("discocyte", 2562)] {
        let shape: AnyShape = name.parse().expect("a shape");
        let made = generate(&shape, Family::Irregular, vertices, 1).expect("a mesh");
        let edge = mean_edge(&made);
        let median = |positions: &[[f64; 3]]| {
            let smooth = smooth(Surface::new(&made.mesh, positions).expect("positions"));
            let mut misfits = smooth.misfits().to_vec();
            misfits.sort_by(f64::total_cmp);
            misfits[vertices / 2] / edge
        };
        // A tenth of the misfits that are looked into.
        let exact = median(&made.positions);
        assert!(exact < 1e-5, "{exact}");
        let request = MeshRequest {
            lengths: EdgeLengths::Uniform(edge),
            vertices: None,
            creases: 60_f64.to_radians(),
            noise: OfNoise::Refused,
        };
        let made_anew = |positions: &[[f64; 3]]| {
            let surface = Surface::new(&made.mesh, positions).expect("positions");
            remeshed(surface, &request, &mut |_| true).map(|_| ())
        };
        assert_eq!(made_anew(&made.positions), Ok(()));
        // A fit takes up part of the noise of the vertices that determine it: 0.55 and 0.81 of it are left here.
        let noisy = disturbed(&made.positions, 1.5e-3 * edge);
        let found = median(&noisy) / 1.5e-3;
        assert!((0.3..1.2).contains(&found), "{found}");
        assert!(matches!(made_anew(&noisy), Err(RemeshError::Noise(_))));
    }
}
