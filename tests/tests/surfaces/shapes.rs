//! Exact shapes: the tabulated discocyte, derivatives by dual numbers, scaling, and integrals.

use autodiff::FT;
use helfrich::Real;
use helfrich::shapes::{Discocyte, Ellipsoid, ExactPoint, Shape, Sphere, Torus};
use helfrich_tests::meshes::{cross, dot};
use helfrich_tests::quadrature::{over_sphere_like, over_torus};
use helfrich_tests::tolerance::Tolerance;
use std::array::from_fn;
use std::f64::consts::{PI, TAU};

/// Exact shapes against tabulated values, relative to each quantity's largest.
const SHAPE_REFERENCE: Tolerance = Tolerance::new(
    1e-13,
    "the tabulated radius is rounded once, and Δ_S H is a fourth derivative of the profile",
);

/// Exact shapes against derivatives by dual numbers, relative to a power of the curvature.
const SHAPE_DERIVATIVE: Tolerance = Tolerance::new(
    1e-11,
    "dual numbers have no truncation error; near the rim the extension off the surface has large terms",
);

/// Exact shapes at different scales, relative to a power of the curvature.
const SHAPE_SCALING: Tolerance = Tolerance::new(
    2e-14,
    "the scale enters by a few multiplications; the pre-image's last bits differ",
);

/// Exact shapes in f32 against f64, relative to each quantity's largest.
const SHAPE_SINGLE: Tolerance = Tolerance::new(
    2e-5,
    "f32 rounds at 6e-8, and the pre-image's rounding is amplified by H''' of the discocyte",
);

/// Pre-image of a position, absolute on the unit sphere.
const SHAPE_PREIMAGE: Tolerance =
    Tolerance::new(1e-14, "a division, a square root and a normalisation");

/// Exact normals against central differences of positions, absolute.
const NORMAL_DIFFERENCE: Tolerance = Tolerance::new(
    1e-7,
    "second-order differences with a step of 1e-5 leave 1e-10 of truncation and 1e-11/1e-5 of rounding",
);

/// Integrals over exact shapes by quadrature, relative.
const SHAPE_INTEGRAL: Tolerance = Tolerance::new(
    1e-12,
    "Gauss and trapezoidal rules on analytic integrands; only summed rounding remains",
);

/// A shape that can be built in every scalar and at every scale.
trait Case {
    const NAME: &'static str;
    fn shape<T: Real>(scale: f64) -> impl Shape<T>;
    /// Pre-images that cover the shape of scale 1.
    fn samples() -> Vec<[f64; 3]> {
        spiral()
    }
    /// Pre-image on the scaled shape that corresponds to `preimage` at scale 1.
    fn scaled_preimage(preimage: [f64; 3], _scale: f64) -> [f64; 3] {
        preimage
    }
}

struct RoundSphere;
struct Triaxial;
struct Prolate;
struct RingTorus;
struct RedBloodCell;

fn length<T: Real>(value: f64, scale: f64) -> T {
    T::constant(value * scale)
}

impl Case for RoundSphere {
    const NAME: &'static str = "sphere";
    fn shape<T: Real>(scale: f64) -> impl Shape<T> {
        Sphere::new(length(1.3, scale)).unwrap()
    }
}

impl Case for Triaxial {
    const NAME: &'static str = "triaxial ellipsoid";
    fn shape<T: Real>(scale: f64) -> impl Shape<T> {
        Ellipsoid::new([1.0, 0.8, 0.6].map(|axis| length(axis, scale))).unwrap()
    }
}

impl Case for Prolate {
    const NAME: &'static str = "prolate spheroid";
    fn shape<T: Real>(scale: f64) -> impl Shape<T> {
        Ellipsoid::new([0.7, 0.7, 1.6].map(|axis| length(axis, scale))).unwrap()
    }
}

impl Case for RingTorus {
    const NAME: &'static str = "torus";
    fn shape<T: Real>(scale: f64) -> impl Shape<T> {
        Torus::new(length(2.0, scale), length(0.9, scale)).unwrap()
    }
    fn samples() -> Vec<[f64; 3]> {
        let golden = (5f64.sqrt() - 1.0) / 2.0;
        (0..300)
            .map(|k| {
                let (sin_tube, cos_tube) = (TAU * f64::from(k) / 300.0).sin_cos();
                let (sin_axis, cos_axis) = (TAU * f64::from(k) * golden).sin_cos();
                let distance = 2.0 + 0.9 * cos_tube;
                [distance * cos_axis, distance * sin_axis, 0.9 * sin_tube]
            })
            .collect()
    }
    fn scaled_preimage(preimage: [f64; 3], scale: f64) -> [f64; 3] {
        preimage.map(|x| x * scale)
    }
}

impl Case for RedBloodCell {
    const NAME: &'static str = "discocyte";
    fn shape<T: Real>(scale: f64) -> impl Shape<T> {
        Discocyte::new(length(1.1, scale)).unwrap()
    }
}

/// Runs a law, generic over the case, for every shape.
macro_rules! on_every_shape {
    ($law:ident) => {
        $law::<RoundSphere>();
        $law::<Triaxial>();
        $law::<Prolate>();
        $law::<RingTorus>();
        $law::<RedBloodCell>();
    };
}

/// Directions that cover the unit sphere evenly.
fn spiral() -> Vec<[f64; 3]> {
    let golden = PI * (3.0 - 5f64.sqrt());
    (0..300)
        .map(|k| {
            let z = 1.0 - (2.0 * f64::from(k) + 1.0) / 300.0;
            let (sin, cos) = (golden * f64::from(k)).sin_cos();
            let radius = (1.0 - z * z).sqrt();
            [radius * cos, radius * sin, z]
        })
        .collect()
}

/// Two unit vectors that make a right-handed frame with `normal`.
fn tangents(normal: [f64; 3]) -> [[f64; 3]; 2] {
    let axis = (0..3).min_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs()));
    let mut other = [0.0; 3];
    other[axis.unwrap()] = 1.0;
    let across = cross(normal, other);
    let first = across.map(|x| x / dot(across, across).sqrt());
    [first, cross(normal, first)]
}

fn at<C: Case>(preimage: [f64; 3]) -> ExactPoint<f64> {
    C::shape::<f64>(1.0).at(preimage)
}

/// H, K and Δ_S H, for separate comparison.
fn curvatures<T: Real>(point: &ExactPoint<T>) -> [f64; 3] {
    [point.mean, point.gaussian, point.laplacian_of_mean].map(|value| value.to_f64().unwrap())
}

/// Largest |H|, |K| and |Δ_S H| on the shape of scale 1, but at least powers of the largest |H|, for
/// quantities that vanish identically.
fn largest_curvatures<C: Case>() -> [f64; 3] {
    let mut largest = [0.0f64; 3];
    for preimage in C::samples() {
        let found = curvatures(&at::<C>(preimage));
        largest = from_fn(|i| largest[i].max(found[i].abs()));
    }
    from_fn(|i| largest[i].max(largest[0].powi(i as i32 + 1)))
}

const QUANTITIES: [&str; 3] = ["H", "K", "Δ_S H"];

#[test]
fn discocyte_meets_the_reference() {
    let text = include_str!("../../data/discocyte.json");
    let reference: serde_json::Value = serde_json::from_str(text).unwrap();
    let number = |value: &serde_json::Value| value.as_str().unwrap().parse::<f64>().unwrap();
    let names = ["z", "n_r", "n_z", "H", "K", "LapH", "f_over_kappa"];
    let stations = reference["stations"].as_array().unwrap();
    assert_eq!(stations.len(), 12);
    let shape = Discocyte::new(1.0).unwrap();

    let largest = names.map(|name| {
        let magnitudes = stations.iter().map(|station| number(&station[name]).abs());
        magnitudes.fold(0.0, f64::max)
    });
    for station in stations {
        let r = number(&station["r"]);
        let point = shape.at([r, 0.0, ((1.0 - r) * (1.0 + r)).sqrt()]);
        let [h, k, laplacian] = curvatures(&point);
        let found = [
            point.position[2],
            point.normal[0],
            point.normal[2],
            h,
            k,
            laplacian,
            point.force_density(1.0),
        ];
        for i in 0..names.len() {
            let what = format!("{} at r = {r}", names[i]);
            let expected = number(&station[names[i]]);
            SHAPE_REFERENCE.assert(found[i], expected, largest[i], &what);
        }
    }

    let integral = |integrand: fn(&ExactPoint<f64>) -> f64| over_sphere_like(&shape, integrand);
    for (name, found) in [
        ("area", integral(|_| 1.0)),
        ("volume", integral(|p| dot(p.position, p.normal) / 3.0)),
        ("energy_over_kappa", integral(|p| 2.0 * p.mean * p.mean)),
    ] {
        let expected = number(&reference[name]);
        SHAPE_INTEGRAL.assert(found, expected, expected, name);
    }
}

#[test]
fn preimage_undoes_position() {
    fn law<C: Case>() {
        let shape = C::shape::<f64>(1.0);
        for preimage in C::samples() {
            let position = shape.position(preimage);
            assert_eq!(position, shape.at(preimage).position, "{}", C::NAME);
            let again = shape.preimage(position);
            for i in 0..3 {
                SHAPE_PREIMAGE.assert(again[i], preimage[i], 1.0, C::NAME);
            }
        }
    }
    on_every_shape!(law);
}

/// The pre-image of a point near the surface is near, because smoothing of meshes moves points in space.
#[test]
fn preimage_of_a_nearby_point_is_near() {
    fn law<C: Case>() {
        let shape = C::shape::<f64>(1.0);
        for preimage in C::samples() {
            let point = shape.at(preimage);
            let off: [f64; 3] = from_fn(|i| point.position[i] + 1e-3 * point.normal[i]);
            let foot = shape.position(shape.preimage(off));
            let gap: [f64; 3] = from_fn(|i| foot[i] - point.position[i]);
            assert!(dot(gap, gap).sqrt() < 0.01, "{}: {gap:?}", C::NAME);
        }
    }
    on_every_shape!(law);
}

#[test]
fn normal_agrees_with_differences_of_positions() {
    fn law<C: Case>() {
        let shape = C::shape::<f64>(1.0);
        let step = 1e-5;
        for preimage in C::samples() {
            let point = shape.at(preimage);
            let [along, across] = tangents(point.normal).map(|tangent| {
                let moved = |sign: f64| {
                    let near = from_fn(|i| point.position[i] + sign * step * tangent[i]);
                    shape.position(shape.preimage(near))
                };
                let (ahead, behind) = (moved(1.0), moved(-1.0));
                from_fn(|i| (ahead[i] - behind[i]) / (2.0 * step))
            });
            let normal = cross(along, across);
            let length = dot(normal, normal).sqrt();
            for (component, exact) in normal.into_iter().zip(point.normal) {
                let found = component / length;
                NORMAL_DIFFERENCE.assert(found, exact, 1.0, C::NAME);
            }
        }
    }
    on_every_shape!(law);
}

/// Fields of the surface are extended into space through the pre-image. For any extension g, Δ_S g is the sum
/// of its second derivatives along two tangents − 2H ∂ₙg, and the tangential derivatives of the normal are
/// the second fundamental form.
#[test]
fn curvatures_are_derivatives_of_the_normal() {
    type Dual = FT<f64>;
    type Dual2 = FT<Dual>;
    fn law<C: Case>() {
        let shape = C::shape::<f64>(1.0);
        let dual = C::shape::<Dual2>(1.0);
        let scale = largest_curvatures::<C>();
        for preimage in C::samples() {
            let point = shape.at(preimage);
            // The exact point along position + t direction, with its first and second t-derivative.
            let line = |direction: [f64; 3]| {
                let moving: [Dual2; 3] = from_fn(|i| {
                    let (x, slope) = (point.position[i], direction[i]);
                    Dual2::new(Dual::new(x, slope), Dual::new(slope, 0.0))
                });
                dual.at(dual.preimage(moving))
            };
            let [along, across] = tangents(point.normal);
            let (e1, e2, e3) = (line(along), line(across), line(point.normal));
            let turn = |line: &ExactPoint<Dual2>, direction| {
                dot(line.normal.map(|component| component.dx.x), direction)
            };
            let form = [
                turn(&e1, along),
                turn(&e1, across),
                turn(&e2, along),
                turn(&e2, across),
            ];
            let bend = |line: &ExactPoint<Dual2>| line.mean.dx.dx;
            let expected = [
                0.5 * (form[0] + form[3]),
                form[0] * form[3] - form[1] * form[2],
                bend(&e1) + bend(&e2) - 2.0 * point.mean * e3.mean.dx.x,
            ];
            for i in 0..3 {
                let what = format!("{} of {} at {preimage:?}", QUANTITIES[i], C::NAME);
                let found = curvatures(&point)[i];
                SHAPE_DERIVATIVE.assert(found, expected[i], scale[i], &what);
            }
        }
    }
    on_every_shape!(law);
}

#[test]
fn a_round_ellipsoid_is_a_sphere() {
    let sphere = Sphere::new(1.3).unwrap();
    let ellipsoid = Ellipsoid::new([1.3; 3]).unwrap();
    for preimage in spiral() {
        let found = curvatures(&ellipsoid.at(preimage));
        let expected = curvatures(&sphere.at(preimage));
        for (i, quantity) in QUANTITIES.iter().enumerate() {
            SHAPE_SCALING.assert(found[i], expected[i], 1.0, quantity);
        }
    }
}

/// Under x → s x, H, K and Δ_S H scale as 1/s, 1/s² and 1/s³, in f64 and within the narrower range of f32.
#[test]
fn curvatures_scale() {
    fn law<C: Case>() {
        let scale = largest_curvatures::<C>();
        let powers = |i: usize, s: f64| s.powi(i as i32 + 1);
        for s in [1e-12, 1e-3, 7.0, 1e12] {
            let scaled = C::shape::<f64>(s);
            for preimage in C::samples() {
                let expected = curvatures(&at::<C>(preimage));
                let found = curvatures(&scaled.at(C::scaled_preimage(preimage, s)));
                for i in 0..3 {
                    let what = format!("{} of {} scaled by {s:e}", QUANTITIES[i], C::NAME);
                    let found = found[i] * powers(i, s);
                    SHAPE_SCALING.assert(found, expected[i], scale[i], &what);
                }
            }
        }
        for s in [1e-6, 1.0, 1e6] {
            let scaled = C::shape::<f32>(s);
            for preimage in C::samples() {
                let single = C::scaled_preimage(preimage, s).map(|x| x as f32);
                let expected = curvatures(&at::<C>(preimage));
                let found = curvatures(&scaled.at(single));
                for i in 0..3 {
                    let what = format!("f32 {} of {} scaled by {s:e}", QUANTITIES[i], C::NAME);
                    let found = found[i] * powers(i, s);
                    SHAPE_SINGLE.assert(found, expected[i], scale[i], &what);
                }
            }
        }
    }
    on_every_shape!(law);
}

/// ∫K dS = 2πχ and ∫Δ_S H dS = 0.
#[test]
fn integral_theorems_hold() {
    fn sphere_like(shape: &impl Shape<f64>) {
        let total = over_sphere_like(shape, |p| p.gaussian);
        SHAPE_INTEGRAL.assert(total, 2.0 * TAU, 2.0 * TAU, "Gauss-Bonnet");
        let magnitude = over_sphere_like(shape, |p| p.laplacian_of_mean.abs()).max(1.0);
        let flux = over_sphere_like(shape, |p| p.laplacian_of_mean);
        SHAPE_INTEGRAL.assert(flux, 0.0, magnitude, "integral of Δ_S H");
    }
    sphere_like(&RoundSphere::shape(1.0));
    sphere_like(&Triaxial::shape(1.0));
    sphere_like(&Prolate::shape(1.0));
    sphere_like(&RedBloodCell::shape(1.0));

    let torus = Torus::new(2.0, 0.9).unwrap();
    let integral = |integrand: fn(&ExactPoint<f64>) -> f64| over_torus(&torus, 2.0, 0.9, integrand);
    SHAPE_INTEGRAL.assert(integral(|p| p.gaussian), 0.0, TAU, "Gauss-Bonnet");
    let magnitude = integral(|p| p.laplacian_of_mean.abs());
    let flux = integral(|p| p.laplacian_of_mean);
    SHAPE_INTEGRAL.assert(flux, 0.0, magnitude, "integral of Δ_S H");
}

#[test]
fn bending_energies_are_the_known_ones() {
    let bending = |p: &ExactPoint<f64>| 2.0 * p.mean * p.mean;
    let spheroid =
        |height: f64| over_sphere_like(&Ellipsoid::new([1.0, 1.0, height]).unwrap(), bending);
    let triaxial = over_sphere_like(&Ellipsoid::new([1.0, 0.8, 0.6]).unwrap(), bending);
    let torus = |radius: f64| over_torus(&Torus::new(radius, 1.0).unwrap(), radius, 1.0, bending);

    for (found, expected, name) in [
        (spheroid(1.0), 8.0 * PI, "sphere"),
        (torus(2f64.sqrt()), 4.0 * PI * PI, "Clifford torus"),
        (torus(2.0), 45.58575006211245, "torus R/r = 2"),
        (triaxial, 27.972347356553226, "ellipsoid (1, 0.8, 0.6)"),
        (spheroid(2.0), 30.903213288653117, "spheroid (1, 1, 2)"),
        (spheroid(0.5), 33.8046239320634, "spheroid (1, 1, 1/2)"),
    ] {
        SHAPE_INTEGRAL.assert(found, expected, expected, name);
    }
}

#[test]
fn bad_parameters_are_named() {
    let messages = [
        Sphere::new(0.0).unwrap_err(),
        Sphere::new(f64::INFINITY).unwrap_err(),
        Ellipsoid::new([1.0, -2.0, 1.0]).unwrap_err(),
        Ellipsoid::new([1.0, 1.0, f64::NAN]).unwrap_err(),
        Torus::new(1.0, 1.0).unwrap_err(),
        Discocyte::new(-1.0).unwrap_err(),
        Discocyte::with_coefficients(1.0, [0.2, -1.0, 1.0]).unwrap_err(),
        Discocyte::with_coefficients(1.0, [0.2, f64::NAN, 1.0]).unwrap_err(),
    ]
    .map(|error| error.to_string());
    assert_eq!(
        messages,
        [
            "the sphere's radius is 0: it must lie above 0 and below inf",
            "the sphere's radius is inf: it must lie above 0 and below inf",
            "the ellipsoid's semi-axis along y is -2: it must lie above 0 and below inf",
            "the ellipsoid's semi-axis along z is NaN: it must lie above 0 and below inf",
            "the torus's tube radius is 1: it must lie above 0 and below 1",
            "the discocyte's radius is -1: it must lie above 0 and below inf",
            "the discocyte's least C0 + C1 u + C2 u² in 0 <= u <= 1 is -0.04999999999999999: \
             it must lie above 0 and below inf",
            "the discocyte's least C0 + C1 u + C2 u² in 0 <= u <= 1 is NaN: \
             it must lie above 0 and below inf",
        ]
    );
}
