//! Polygons of mesh files as triangles.

use glam::DVec3;
use helfrich::Surface;
use helfrich_std::io::{Format, parse, parse_with_columns};
use helfrich_std::polygon::{MOST_CORNERS, triangulate};
use std::f64::consts::TAU;
use std::fmt::Write;

/// Rounding of areas of polygons of unit size: some hundred sums.
const ROUNDING: f64 = 1e-13;

/// A plane outline on a slope, so that no coordinate plane is special.
fn on_a_slope(outline: &[[f64; 2]]) -> Vec<[f64; 3]> {
    let place = |&[x, y]: &[f64; 2]| [3.0 + 0.6 * x, y - 5.0, 0.8 * x];
    outline.iter().map(place).collect()
}

/// Area of a plane polygon by the shoelace formula.
fn area_of(outline: &[[f64; 2]]) -> f64 {
    let next = outline.iter().cycle().skip(1);
    let doubled = outline
        .iter()
        .zip(next)
        .map(|(a, b)| a[0] * b[1] - a[1] * b[0]);
    0.5 * doubled.sum::<f64>()
}

/// Areas of the triangles into which a polygon is divided.
fn areas(corners: &[[f64; 3]]) -> Vec<f64> {
    let triangles = triangulate(corners).unwrap();
    assert_eq!(triangles.len(), corners.len() - 2);
    let area = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|corner| DVec3::from(corners[corner as usize]));
        0.5 * (b - a).cross(c - a).length()
    };
    triangles.iter().map(area).collect()
}

/// Outlines that run to the left, each with its name.
fn outlines() -> Vec<(&'static str, Vec<[f64; 2]>)> {
    let ring = |radius: f64, count: usize, turns: f64| {
        (0..count).map(move |at| {
            let angle = turns * TAU * at as f64 / count as f64;
            [radius * angle.cos(), radius * angle.sin()]
        })
    };
    let comb = (0..12).flat_map(|tooth| {
        let x = f64::from(12 - tooth);
        [[x, 5.0], [x - 0.5, 0.3]]
    });
    let arms = (0..40).map(|at| f64::from(at) * 0.35);
    let spiral = |gap: f64| {
        arms.clone()
            .map(move |angle| [(angle + gap) * angle.cos(), (angle + gap) * angle.sin()])
    };
    vec![
        (
            "L",
            vec![
                [0.0, 0.0],
                [2.0, 0.0],
                [2.0, 1.0],
                [1.0, 1.0],
                [1.0, 2.0],
                [0.0, 2.0],
            ],
        ),
        (
            "dart",
            vec![[0.0, 0.0], [2.0, -1.0], [0.5, 0.0], [2.0, 1.0]],
        ),
        (
            "corners on edges",
            vec![
                [0.0, 0.0],
                [1.0, 0.0],
                [2.0, 0.0],
                [2.0, 1.0],
                [2.0, 2.0],
                [1.0, 2.0],
                [0.0, 2.0],
                [0.0, 1.0],
            ],
        ),
        (
            "triangle with corners on one edge",
            vec![[0.0, 0.0], [1.0, 0.0], [1.5, 0.0], [2.0, 0.0], [0.0, 1.0]],
        ),
        (
            "comb",
            [[0.0, 0.0], [12.0, 0.0]].into_iter().chain(comb).collect(),
        ),
        ("spiral", spiral(1.0).rev().chain(spiral(2.0)).collect()),
        (
            "star",
            (0..14)
                .map(|at| {
                    let angle = TAU * f64::from(at) / 14.0;
                    let radius = if at % 2 == 0 { 1.0 } else { 0.3 };
                    [radius * angle.cos(), radius * angle.sin()]
                })
                .collect(),
        ),
        // A hole, which a cut joins to the outline: both ends of the cut are two corners.
        (
            "ring",
            ring(2.0, 9, 1.0)
                .chain([[2.0, 0.0]])
                .chain(ring(1.0, 7, -1.0))
                .chain([[1.0, 0.0]])
                .collect(),
        ),
    ]
}

/// The triangles of a plane polygon cover it once, whatever its first corner, and none is flat: the fan of an
/// L is 7 % too large.
#[test]
fn triangles_cover_a_polygon_once_whatever_its_first_corner() {
    for (name, mut outline) in outlines() {
        let exact = area_of(&outline);
        for _ in 0..outline.len() {
            outline.rotate_left(1);
            let areas = areas(&on_a_slope(&outline));
            let sum = areas.iter().sum::<f64>();
            assert!(
                (sum - exact).abs() < ROUNDING * exact,
                "{name}: {sum} for {exact}"
            );
            let least = areas.iter().copied().fold(f64::INFINITY, f64::min);
            assert!(
                least > 1e-4 * exact,
                "{name}: a triangle of {least} in {exact}"
            );
        }
    }
}

/// Sizes whose squares underflow or overflow are divided as any other.
#[test]
fn the_size_of_a_polygon_does_not_matter() {
    let (_, l) = outlines().swap_remove(0);
    let expected = triangulate(&on_a_slope(&l));
    for exponent in [-660, 660] {
        let scaled = on_a_slope(&l)
            .into_iter()
            .map(|x| x.map(|x| x * 2_f64.powi(exponent)));
        assert_eq!(
            triangulate(&Vec::from_iter(scaled)),
            expected,
            "2^{exponent}"
        );
    }
}

/// Convex polygons keep the fan around their first corner, and so do those without a normal.
#[test]
fn convex_polygons_are_fans() {
    let hexagon = (0..6).map(|at| (TAU * f64::from(at) / 6.0).sin_cos());
    let hexagon = hexagon.map(|(y, x)| [x, y, 0.1 * x * y]).collect();
    for corners in [
        hexagon,
        vec![[1.0; 3]; 6],
        vec![[f64::MAX; 3], [f64::MIN; 3], [0.0; 3], [1.0; 3]],
    ] {
        let fan = (2..corners.len() as u32).map(|last| [0, last - 1, last]);
        assert_eq!(triangulate(&corners).unwrap(), Vec::from_iter(fan));
    }
}

/// Polygons that cross themselves are divided in some way; those of very many corners are refused.
#[test]
fn strange_polygons_end_with_triangles_or_an_error() {
    let bow = [
        [0.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [3.0, 0.0, 0.0],
        [0.0, 1.5, 0.0],
    ];
    assert_eq!(areas(&bow).len(), 2);
    let zigzag = |count: usize| {
        let corner = |at: usize| [at as f64, (at % 2) as f64, (at % 3) as f64];
        Vec::from_iter((0..count).map(corner))
    };
    assert_eq!(areas(&zigzag(200)).len(), 198);
    let error = triangulate(&zigzag(MOST_CORNERS + 1))
        .unwrap_err()
        .to_string();
    assert_eq!(
        error,
        "a polygon of 10001 corners that is not convex: at most 10000 can be divided into triangles"
    );
}

/// A prism over an L, whose faces begin at any of their corners.
fn prism(turn: usize) -> (Vec<[f64; 3]>, Vec<Vec<usize>>) {
    let (_, l) = outlines().swap_remove(0);
    let at = |height: f64| l.iter().map(move |&[x, y]| [x, y, height]);
    let positions = at(0.0).chain(at(1.0)).collect();
    let sides = (0..6).map(|at| {
        let next = (at + 1) % 6;
        vec![at, next, next + 6, at + 6]
    });
    let caps = [(0..6).rev().collect(), (6..12).collect()];
    let mut faces = Vec::from_iter(caps.into_iter().chain(sides));
    for face in &mut faces {
        let count = face.len();
        face.rotate_left(turn % count);
    }
    (positions, faces)
}

fn lines<R: AsRef<[T]>, T: ToString>(rows: &[R], first: impl Fn(usize) -> String) -> String {
    let mut text = String::new();
    for row in rows {
        let row = row.as_ref();
        let words = Vec::from_iter(row.iter().map(T::to_string));
        let _ = writeln!(text, "{}{}", first(row.len()), words.join(" "));
    }
    text
}

/// The same prism in every format with polygons.
fn files(positions: &[[f64; 3]], faces: &[Vec<usize>]) -> [(String, Format); 4] {
    let [points, corners] = [
        lines(positions, |_| String::new()),
        lines(faces, |n| format!("{n} ")),
    ];
    let from_1 = Vec::from_iter(
        faces
            .iter()
            .map(|f| Vec::from_iter(f.iter().map(|v| v + 1))),
    );
    let ends = faces.iter().scan(0, |end, face| {
        *end += face.len();
        Some([*end])
    });
    let ends = lines(&Vec::from_iter(ends), |_| String::new());
    let connectivity = lines(faces, |_| String::new());
    let array = |kind: &str, name: &str, text: &str| {
        format!("<DataArray type=\"{kind}\" Name=\"{name}\" format=\"ascii\">{text}</DataArray>")
    };
    let numbers = lines(&Vec::from_iter((0..faces.len()).map(|at| [at])), |_| {
        String::new()
    });
    let vtp = format!(
        "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"12\" NumberOfPolys=\"8\">\
         <CellData>{}</CellData><Points>{}</Points><Polys>{}{}</Polys></Piece></PolyData></VTKFile>",
        array("Int64", "face", &numbers),
        array("Float64", "Points", &points),
        array("Int64", "connectivity", &connectivity),
        array("Int64", "offsets", &ends),
    );
    let faces_first = format!(
        "ply\nformat ascii 1.0\nelement face 8\nproperty list uchar int vertex_indices\n\
         element vertex 12\nproperty double x\nproperty double y\nproperty double z\n\
         end_header\n{corners}{points}"
    );
    [
        (
            lines(&from_1, |_| "f ".to_owned()) + &lines(positions, |_| "v ".to_owned()),
            Format::Obj,
        ),
        (format!("OFF\n12 8 0\n{points}{corners}"), Format::Off),
        (faces_first, Format::Ply),
        (vtp, Format::Vtp),
    ]
}

/// A prism over an L has an area of 14 and a volume of 3 in every format; fans give 15 and more.
#[test]
fn solids_with_concave_faces_have_their_area_and_volume() {
    for turn in 0..6 {
        let (positions, faces) = prism(turn);
        for (text, format) in files(&positions, &faces) {
            let file = parse(text.as_bytes(), format).unwrap();
            let surface = Surface::new(&file.mesh, &file.positions).unwrap();
            let (area, volume) = (surface.area(), surface.volume().unwrap());
            assert!((area - 14.0).abs() < ROUNDING, "{format:?}: area {area}");
            assert!(
                (volume - 3.0).abs() < ROUNDING,
                "{format:?}: volume {volume}"
            );
        }
    }
    let (positions, faces) = prism(0);
    let [.., (vtp, format)] = files(&positions, &faces);
    let (_, columns) = parse_with_columns(vtp.as_bytes(), format).unwrap();
    let own = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    let sides = (2..8).flat_map(|face| [f64::from(face); 2]);
    assert_eq!(
        columns[0].values,
        Vec::from_iter(own.into_iter().chain(sides))
    );
}
