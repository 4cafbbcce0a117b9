//! Fields at the vertices of a smooth surface, between them.

use helfrich::{Jet, MeshPoint, Real, Serial, SmoothSurface, Surface};
use helfrich_std::execute::{Parallel, with_threads};
use helfrich_std::generate::{Family, generate};
use helfrich_tests::meshes::{self, Mesh, SplitMix64};

/// Some places of each triangle.
fn places<T: Real>(triangles: usize) -> Vec<MeshPoint<T>> {
    let weights = [[1.0, 1.0, 1.0], [8.0, 1.0, 0.0], [1.0, 5.0, 3.0]];
    let places = (0..triangles).flat_map(|triangle| {
        weights.map(|weights| {
            let sum: f64 = weights.iter().sum();
            let barycentric = weights.map(|weight| T::constant(weight / sum));
            MeshPoint {
                triangle,
                barycentric,
            }
        })
    });
    places.collect()
}

/// A disc of which the inner vertices are moved in its plane.
fn uneven_disc(rings: u32) -> Mesh {
    let mut disc = meshes::disc(rings);
    let most = 0.18 / f64::from(rings);
    let mut random = SplitMix64::new(7);
    for (vertex, [x, y, _]) in disc.positions.iter_mut().enumerate() {
        let moved = [most * random.symmetric(), most * random.symmetric()];
        if disc.connectivity.is_interior(vertex) {
            *x += moved[0];
            *y += moved[1];
        }
    }
    disc
}

/// A polynomial of this degree in two variables, of terms that are all present.
fn polynomial(degree: i32, [x, y]: [f64; 2]) -> f64 {
    let terms = (0..=degree).flat_map(|a| (0..=degree - a).map(move |b| (a, b)));
    let term = |(a, b): (i32, i32)| f64::from(1 + (3 * a + 5 * b) % 7) * x.powi(a) * y.powi(b);
    terms.map(term).sum()
}

/// On a flat surface fits of degree d keep every polynomial of degree d, and bars are rounding; on a disc of radius 1 the
/// largest value is below 200. Near the border only linear ones are certain to be kept. Stretched, vertices lie in rows.
fn polynomials_are_kept<T: Real>(jet: &Jet<T>, rounding: f64, stretch: f64) {
    let disc = uneven_disc(12);
    let stretched = disc.positions.iter().map(|&[x, y, z]| [stretch * x, y, z]);
    let positions = stretched.map(|at| at.map(T::constant));
    let positions = Vec::from_iter(positions);
    let surface = Surface::new(&disc.connectivity, &positions).expect("positions");
    let smooth = SmoothSurface::new(&Serial, surface, jet);
    let degree = smooth.degree() as i32;
    let fields = [degree, 1].map(|degree| {
        let values = disc.positions.iter();
        let values = values.map(|&[x, y, _]| T::constant(polynomial(degree, [x, y])));
        Vec::from_iter(values)
    });
    let fitted = smooth.fields(&Serial, &[&fields[0], &fields[1]]);
    for place in places(disc.connectivity.triangles().len()) {
        let [x, y, _] = smooth.at(place).position.map(|x| x.to_f64().unwrap());
        let x = x / stretch;
        for (field, degree) in [degree, 1].into_iter().enumerate() {
            let found = fitted.at(field, place);
            if degree > 1 && x.hypot(y) > 0.5 {
                continue;
            }
            let off = (found.value.to_f64().unwrap() - polynomial(degree, [x, y])).abs();
            assert!(off < 200.0 * rounding, "{degree}: {off} at {x}, {y}");
            let bar = found.error.to_f64().unwrap();
            assert!(bar < 2000.0 * rounding, "{degree}: bar {bar} at {x}, {y}");
        }
    }
}

/// Rounding: that of the number type times the condition of fits with neighbours on one side.
#[test]
fn polynomials_on_flat_surfaces_are_kept() {
    for jet in [Jet::j4(), Jet::j6(), Jet::j8()] {
        polynomials_are_kept::<f64>(&jet, 1e-12, 1.0);
    }
    polynomials_are_kept::<f64>(&Jet::j6(), 1e-12, 20.0);
    polynomials_are_kept::<f32>(&Jet::j4(), 1e-4, 1.0);
}

fn wave([x, y, z]: [f64; 3]) -> f64 {
    (2.0 * x).sin() + y * z
}

/// Order d + 1, less half an order: meshes of one family are not similar. Bars hold at 19 of 20 places.
#[test]
fn fields_have_the_order_of_the_fits_and_bars_that_hold() {
    for (jet, degree, sizes) in [
        (Jet::j4(), 4.0, [642, 2562]),
        (Jet::j6(), 6.0, [2562, 10_242]),
    ] {
        for shape in ["ellipsoid:1,0.8,0.5", "torus:1,0.5"] {
            let errors = sizes.map(|vertices| {
                let shape = shape.parse().expect("a shape");
                let made = generate(&shape, Family::Irregular, vertices, 1).expect("a mesh");
                let surface = Surface::new(&made.mesh, &made.positions).expect("positions");
                let execution = Parallel::new();
                let smooth = SmoothSurface::new(&execution, surface, &jet);
                let field = Vec::from_iter(made.positions.iter().map(|&at| wave(at)));
                let fitted = smooth.fields(&execution, &[&field]);
                let places = places(made.mesh.triangles().len());
                let found = fitted.all_at(&execution, 0, &places);
                let exact = smooth.all_at(&execution, &places);
                let errors = found.iter().zip(&exact);
                let errors = errors.map(|(found, at)| (found.value - wave(at.position)).abs());
                let errors = Vec::from_iter(errors);
                let held = found.iter().zip(&errors);
                let held = held.filter(|(found, error)| found.error >= **error).count();
                let part = held as f64 / errors.len() as f64;
                assert!(part >= 0.95, "{shape}, {degree}: {part}");
                let squares: f64 = errors.iter().map(|error| error * error).sum();
                (squares / errors.len() as f64).sqrt()
            });
            let order = (errors[0] / errors[1]).log2();
            assert!(
                order > degree + 0.5,
                "{shape}, {degree}: {order}, {errors:?}"
            );
        }
    }
}

#[test]
fn fields_have_their_values_at_vertices_and_on_any_number_of_threads() {
    let torus = meshes::torus(24, 12);
    let smooth = SmoothSurface::new(&Serial, torus.surface(), &Jet::j6());
    let field = Vec::from_iter(torus.positions.iter().map(|&at| wave(at)));
    let fitted = smooth.fields(&Serial, &[&field]);
    for (triangle, corners) in torus.connectivity.triangles().iter().enumerate() {
        for (k, &corner) in corners.iter().enumerate() {
            let mut barycentric = [0.0; 3];
            barycentric[k] = 1.0;
            let found = fitted.at(
                0,
                MeshPoint {
                    triangle,
                    barycentric,
                },
            );
            assert!(
                (found.value - field[corner as usize]).abs() < 1e-12,
                "{corner}"
            );
            assert_eq!(found.error, 0.0);
        }
    }
    let places = places(torus.connectivity.triangles().len());
    let alone = fitted.all_at(&Serial, 0, &places);
    let together = with_threads(3.try_into().expect("a number"), || {
        let threads = Parallel::new();
        smooth
            .fields(&threads, &[&field])
            .all_at(&threads, 0, &places)
    });
    assert_eq!(alone, together);
}

/// A field with another slope on each side of a fold is a polynomial on each of them.
#[test]
fn fields_are_fitted_on_each_side_of_a_fold() {
    let mut sheet = uneven_disc(9);
    let middle = Vec::from_iter(sheet.connectivity.edges().iter().copied().filter(|ends| {
        let heights = ends.map(|end| sheet.positions[end as usize][1]);
        heights.iter().all(|y| y.abs() < 0.03)
    }));
    for end in middle.as_flattened() {
        sheet.positions[*end as usize][1] = 0.0;
    }
    let field = |[x, y, z]: [f64; 3]| if z > 0.0 { x * x + z } else { x * x - y * y };
    for [_, y, z] in &mut sheet.positions {
        if *y > 0.0 {
            (*y, *z) = (0.0, *y);
        }
    }
    let values = Vec::from_iter(sheet.positions.iter().map(|&at| field(at)));
    let places = places(sheet.connectivity.triangles().len());
    let largest = |lines: &[[u32; 2]]| {
        let smooth = SmoothSurface::with_lines(&Serial, sheet.surface(), &Jet::j4(), lines);
        let fitted = smooth.fields(&Serial, &[&values]);
        let errors = places
            .iter()
            .map(|&place| (fitted.at(0, place).value - field(smooth.at(place).position)).abs());
        errors.fold(0.0, f64::max)
    };
    assert!(largest(&middle) < 1e-12, "{}", largest(&middle));
    assert!(largest(&[]) > 1e-3, "{}", largest(&[]));
}

/// Four vertices determine no fit.
#[test]
fn without_fits_fields_are_linear_and_their_errors_unknown() {
    let solid = meshes::tetrahedron();
    let smooth = SmoothSurface::new(&Serial, solid.surface(), &Jet::j4());
    let fitted = smooth.fields(&Serial, &[&[1.0, 2.0, 3.0, 4.0]]);
    for place in places(4) {
        let corners =
            solid.connectivity.triangles()[place.triangle].map(|corner| f64::from(corner + 1));
        let terms = corners.iter().zip(place.barycentric);
        let linear: f64 = terms.map(|(value, weight)| value * weight).sum();
        let found = fitted.at(0, place);
        assert!((found.value - linear).abs() < 1e-14);
        assert_eq!(found.error, f64::INFINITY);
    }
}
