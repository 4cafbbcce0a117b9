//! The smooth surface through the vertices: its points, their order, and projections.

use helfrich::{Jet, MeshPoint, Real, Serial, SmoothPoint, SmoothSurface, Surface, TriangleMesh};
use helfrich_std::execute::Parallel;
use helfrich_std::generate::{AnyShape, Family, GeneratedMesh, generate};
use helfrich_tests::meshes::{self, SplitMix64, difference, dot, norm, turned};

/// A shape of which distance and curvature are known in space.
struct Exact {
    name: &'static str,
    /// The distance of a nearby point, and H at the point next to it.
    at: fn([f64; 3]) -> [f64; 2],
}

const SEMI_AXES: [f64; 3] = [1.0, 0.8, 0.5];

/// The distance is F/|∇F|, with errors of second order in it.
fn ellipsoid(at: [f64; 3]) -> [f64; 2] {
    let sum = |power: i32| -> f64 {
        let terms = at.iter().zip(SEMI_AXES);
        terms.map(|(x, a)| (x / a.powi(power)).powi(2)).sum()
    };
    let squares: f64 = SEMI_AXES.iter().map(|a| a * a).sum();
    let product: f64 = SEMI_AXES.iter().map(|a| a * a).product();
    let mean = (squares - dot(at, at)) / (2.0 * product * sum(2).powf(1.5));
    [(sum(1) - 1.0) / (2.0 * sum(2).sqrt()), mean]
}

fn torus([x, y, z]: [f64; 3]) -> [f64; 2] {
    let around = x.hypot(y) - 1.0;
    let radius = around.hypot(z);
    let cosine = 0.5 * around / radius;
    [radius - 0.5, (1.0 + 2.0 * cosine) / (1.0 + cosine)]
}

const SHAPES: [Exact; 2] = [
    Exact {
        name: "ellipsoid:1,0.8,0.5",
        at: ellipsoid,
    },
    Exact {
        name: "torus:1,0.5",
        at: torus,
    },
];

fn made(name: &str, family: Family, vertices: usize) -> GeneratedMesh {
    let shape: AnyShape = name.parse().expect("a shape");
    generate(&shape, family, vertices, 1).expect("a mesh")
}

fn smooth(made: &GeneratedMesh, jet: &Jet<f64>) -> SmoothSurface<f64> {
    let surface = Surface::new(&made.mesh, &made.positions).expect("positions");
    SmoothSurface::new(&Parallel::new(), surface, jet)
}

/// The point of each triangle at these coordinates.
fn points(smooth: &SmoothSurface<f64>, barycentric: [f64; 3]) -> Vec<SmoothPoint<f64>> {
    let triangles = 0..smooth.surface().mesh().triangles().len();
    let place = |triangle| MeshPoint {
        triangle,
        barycentric,
    };
    triangles
        .map(|triangle| smooth.at(place(triangle)))
        .collect()
}

/// The centre of each triangle, where a blend is farthest from vertices.
fn centres(smooth: &SmoothSurface<f64>) -> Vec<SmoothPoint<f64>> {
    points(smooth, [1.0 / 3.0; 3])
}

fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let squares = Vec::from_iter(values.map(|x| x * x));
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// Order d + 1 of positions and d − 1 of H, less half an order: meshes of one family are not similar.
#[test]
fn points_between_vertices_have_the_order_of_the_fits() {
    for shape in &SHAPES {
        for (jet, degree) in [(Jet::j4(), 4.0), (Jet::j6(), 6.0)] {
            let errors = [2562, 10_242].map(|vertices| {
                let made = made(shape.name, Family::Irregular, vertices);
                let points = centres(&smooth(&made, &jet));
                let distance = points.iter().map(|point| (shape.at)(point.position)[0]);
                let mean = points.iter();
                let mean = mean.map(|point| point.mean - (shape.at)(point.position)[1]);
                [root_mean_square(distance), root_mean_square(mean)]
            });
            let [coarse, fine] = errors;
            for (quantity, least) in [degree + 0.5, degree - 1.5].into_iter().enumerate() {
                let order = (coarse[quantity] / fine[quantity]).log2();
                let what = (shape.name, degree, quantity);
                assert!(order > least, "{what:?}: {order}, {errors:?}");
            }
        }
    }
}

/// Points of three polynomials lie side by side, and their mean is inside the sphere by 9e-7.
#[test]
fn means_of_points_do_not_sink_into_the_surface() {
    let made = made("sphere", Family::Irregular, 642);
    for point in centres(&smooth(&made, &Jet::j8())) {
        let off = (norm(point.position) - 1.0).abs();
        assert!(off < 5e-9, "{off}");
    }
}

/// The limits are twice the largest errors, which differ by their orders. At midpoints of edges the directions of two fits
/// cancel unless they have the same sign.
#[test]
fn normals_gaussian_curvatures_and_principal_directions_are_those_of_the_surface() {
    let made = made("torus:1,0.5", Family::Irregular, 2562);
    let smooth = smooth(&made, &Jet::j6());
    for point in [centres(&smooth), points(&smooth, [0.5, 0.5, 0.0])].concat() {
        let [x, y, z] = point.position;
        let around = x.hypot(y);
        let outward =
            [x * (1.0 - 1.0 / around), y * (1.0 - 1.0 / around), z].map(|entry| 2.0 * entry);
        assert!(
            norm(difference(point.normal, outward)) < 2.4e-4,
            "{point:?}"
        );
        let gaussian = 4.0 * (around - 1.0) / around;
        assert!((point.gaussian - gaussian).abs() < 8e-3, "{point:?}");
        let [larger, smaller] = point.principal();
        assert!((larger - 2.0).abs() < 5.5e-3, "{point:?}");
        assert!((larger * smaller - gaussian).abs() < 8e-3, "{point:?}");
        // Around the tube.
        let azimuthal = [-y / around, x / around, 0.0];
        assert!(dot(point.direction, azimuthal).abs() < 8e-4, "{point:?}");
        assert!((norm(point.direction) - 1.0).abs() < ROUNDING, "{point:?}");
    }
}

/// Relative to the largest extent: products of a few roundings, and of fits that sums of many neighbours determine.
const ROUNDING: f64 = 1e-12;

#[test]
fn it_passes_through_the_vertices_with_the_curvatures_of_their_fits() {
    let made = made("discocyte", Family::Irregular, 642);
    let smooth = smooth(&made, &Jet::j6());
    for (triangle, corners) in made.mesh.triangles().iter().enumerate() {
        for (k, &corner) in corners.iter().enumerate() {
            let mut barycentric = [0.0; 3];
            barycentric[k] = 1.0;
            let point = smooth.at(MeshPoint {
                triangle,
                barycentric,
            });
            let vertex = &smooth.vertices()[corner as usize];
            let off = norm(difference(point.position, made.positions[corner as usize]));
            assert!(off < ROUNDING, "{corner}: {off}");
            assert!(
                (point.mean - vertex.mean).abs() < ROUNDING * 100.0,
                "{corner}"
            );
            assert!(
                dot(point.normal, vertex.normal) > 1.0 - ROUNDING,
                "{corner}"
            );
            assert_eq!(point.position_error, 0.0);
        }
    }
}

/// Both triangles of an edge have the same points over it, since the opposite corners have no weight.
#[test]
fn triangles_meet_without_a_gap() {
    let made = made("torus:1,0.5", Family::Irregular, 600);
    let smooth = smooth(&made, &Jet::j4());
    let triangles = made.mesh.triangles();
    for (edge, ends) in made.mesh.edges().iter().enumerate() {
        let (one, other) = made.mesh.edge_triangles(edge);
        let sides = [one, other.expect("a closed surface")].map(|triangle| {
            let triangle = triangle as usize;
            let weight = |corner: u32| match ends.iter().position(|&end| end == corner) {
                Some(0) => 0.7,
                Some(_) => 0.3,
                None => 0.0,
            };
            smooth.at(MeshPoint {
                triangle,
                barycentric: triangles[triangle].map(weight),
            })
        });
        let [one, other] = sides;
        assert!(
            norm(difference(one.position, other.position)) < ROUNDING,
            "{edge}"
        );
        assert!(dot(one.normal, other.normal) > 1.0 - ROUNDING, "{edge}");
    }
}

/// Bars are made for 99 of 100 points.
#[test]
fn error_bars_of_positions_and_curvatures_hold_and_are_of_use() {
    for shape in &SHAPES {
        let made = made(shape.name, Family::Irregular, 2562);
        let points = centres(&smooth(&made, &Jet::j6()));
        let (mut positions, mut means) = (0, 0);
        let mut ratios = Vec::new();
        for point in &points {
            let [distance, mean] = (shape.at)(point.position);
            positions += usize::from(distance.abs() <= point.position_error);
            means += usize::from((mean - point.mean).abs() <= point.curvature_errors[0]);
            ratios.push(point.position_error / distance.abs());
        }
        let least = points.len() * 97 / 100;
        assert!(
            positions > least && means > least,
            "{}: {positions} {means}",
            shape.name
        );
        ratios.sort_by(f64::total_cmp);
        let median = ratios[ratios.len() / 2];
        assert!(median < 20.0, "{}: {median}", shape.name);
    }
}

/// Points are moved off the surface along their normals, by up to a third of the smallest radius of curvature.
#[test]
fn the_projection_of_a_point_beside_it_is_the_point_below() {
    let made = made("ellipsoid:1,0.8,0.5", Family::Irregular, 642);
    let smooth = smooth(&made, &Jet::j6());
    let mut random = SplitMix64::new(7);
    for _ in 0..300 {
        let triangle = random.below(made.mesh.triangles().len());
        let [a, b] = [0, 1].map(|_| 0.5 + 0.5 * random.symmetric());
        let [a, b] = if a + b > 1.0 {
            [1.0 - a, 1.0 - b]
        } else {
            [a, b]
        };
        let below = smooth.at(MeshPoint {
            triangle,
            barycentric: [1.0 - a - b, a, b],
        });
        let height = 0.08 * random.symmetric();
        let point = [0, 1, 2].map(|axis| below.position[axis] + height * below.normal[axis]);
        let found = smooth.at(smooth.project(point).expect("a place"));
        let left = difference(point, found.position);
        // The normal is blended, and that of the blend differs by its kinks: the nearest point is off by the height times
        // this angle.
        assert!(
            (norm(left) - height.abs()).abs() < 1e-5,
            "{height}: {left:?}"
        );
        let along = norm(difference(found.position, below.position));
        assert!(along < 1e-5, "{height}: {along}");
    }
}

/// Vertices of a finer mesh lie as near to the surface as its points to the exact one.
#[test]
fn exact_points_are_near_their_projections() {
    let coarse = made("torus:1,0.5", Family::Irregular, 2562);
    let fine = made("torus:1,0.5", Family::Irregular, 4000);
    let smooth = smooth(&coarse, &Jet::j6());
    let places = smooth.project_all(&Parallel::new(), &fine.positions);
    for (place, &position) in places.iter().zip(&fine.positions) {
        let found = smooth.at(place.expect("a place"));
        let off = norm(difference(found.position, position));
        // Ten times the largest error of centres, 6e-6.
        assert!(off < 6e-5, "{off}");
    }
}

/// Also far from the origin, with results that do not depend on threads.
#[test]
fn it_follows_motions() {
    let mesh = meshes::icosphere(2).map(|[x, y, z]| [x, 0.8 * y, 0.5 * z + 0.1 * x * x]);
    let rotation = meshes::rotation([0.3, 0.2, -0.5, 0.7]);
    let moved = mesh.map(|x| {
        let [x, y, z] = turned(rotation, x);
        [x + 3.0, y - 2.0, z + 1.0]
    });
    let [here, there] =
        [&mesh, &moved].map(|mesh| SmoothSurface::new(&Serial, mesh.surface(), &Jet::j4()));
    let threads = SmoothSurface::new(&Parallel::new(), mesh.surface(), &Jet::j4());
    for triangle in 0..mesh.connectivity.triangles().len() {
        let place = MeshPoint {
            triangle,
            barycentric: [0.5, 0.3, 0.2],
        };
        let [one, other] = [&here, &there].map(|smooth| smooth.at(place));
        assert_eq!(one, threads.at(place));
        let [x, y, z] = turned(rotation, one.position);
        let off = norm(difference([x + 3.0, y - 2.0, z + 1.0], other.position));
        assert!(off < ROUNDING, "{triangle}: {off}");
        let off = (one.mean - other.mean).abs();
        assert!(off < 1e-10, "{triangle}: {off}");
    }
}

/// In f32 positions between vertices are as accurate as the vertices.
#[test]
fn in_single_precision_points_are_as_accurate_as_positions() {
    let mesh = meshes::icosphere(3);
    let positions = mesh.positions_in::<f32>();
    let surface = Surface::new(&mesh.connectivity, &positions).expect("positions");
    let smooth = SmoothSurface::new(&Serial, surface, &Jet::j6());
    for triangle in 0..mesh.connectivity.triangles().len() {
        let point = smooth.at(MeshPoint {
            triangle,
            barycentric: [0.2, 0.3, 0.5],
        });
        let radius = point
            .position
            .iter()
            .map(|&x| f64::from(x).powi(2))
            .sum::<f64>();
        let off = (radius.sqrt() - 1.0).abs();
        assert!(off < 8.0 * f64::from(f32::EPSILON), "{triangle}: {off}");
    }
}

fn one_triangle<T: Real>() -> (TriangleMesh, [[T; 3]; 3]) {
    let mesh = TriangleMesh::new(3, vec![[0, 1, 2]]).expect("a triangle");
    let (zero, one) = (T::zero(), T::one());
    (mesh, [[zero; 3], [one, zero, zero], [zero, one, zero]])
}

/// A vertex whose triangles have no area has no fit: it takes no part, and its unknown errors do not hide those of the
/// other corners.
#[test]
fn corners_without_fits_take_no_part() {
    let mesh = meshes::icosphere(2);
    let mut positions = mesh.positions.clone();
    for &other in mesh.connectivity.one_ring(0) {
        positions[other as usize] = positions[0];
    }
    let surface = Surface::new(&mesh.connectivity, &positions).expect("positions");
    let smooth = SmoothSurface::new(&Serial, surface, &Jet::j4());
    assert_eq!(smooth.vertices()[0].normal, [0.0; 3]);
    let mut blended = 0;
    for (triangle, corners) in mesh.connectivity.triangles().iter().enumerate() {
        let point = smooth.at(MeshPoint {
            triangle,
            barycentric: [1.0 / 3.0; 3],
        });
        assert!(!point.position_error.is_nan(), "{triangle}");
        assert!(
            point.curvature_errors.iter().all(|error| !error.is_nan()),
            "{triangle}"
        );
        blended += usize::from(corners.contains(&0) && point.mean.is_finite());
    }
    assert!(blended > 0);
}

/// Degrees that are not possible are those next to them.
#[test]
fn any_degree_of_a_jet_has_a_surface() {
    let mesh = meshes::icosphere(2);
    for degree in [0, 1, 20] {
        let jet = Jet {
            degree,
            ..Jet::j4()
        };
        let smooth = SmoothSurface::new(&Serial, mesh.surface(), &jet);
        let point = smooth.at(MeshPoint {
            triangle: 0,
            barycentric: [1.0 / 3.0; 3],
        });
        // Degree 2, of which the inversion flattens a sphere.
        assert!((norm(point.position) - 1.0).abs() < 1e-3, "{degree}");
    }
}

/// Three vertices determine no polynomial: the point is flat, and says so.
#[test]
fn without_fits_points_are_flat_and_curvatures_unknown() {
    let (mesh, positions) = one_triangle::<f64>();
    let surface = Surface::new(&mesh, &positions).expect("positions");
    let smooth = SmoothSurface::new(&Serial, surface, &Jet::j6());
    let place = smooth.project([0.25, 0.25, 3.0]).expect("a place");
    let point = smooth.at(place);
    assert_eq!(point.position, [0.25, 0.25, 0.0]);
    assert_eq!(point.normal, [0.0, 0.0, 1.0]);
    assert!(point.mean.is_nan() && point.gaussian.is_nan());
    assert_eq!(point.position_error, f64::INFINITY);
    assert_eq!(smooth.project([f64::NAN; 3]), None);
}
