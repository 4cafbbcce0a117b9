//! Pictures of surfaces, and charts.
#![expect(
    clippy::unwrap_used,
    reason = "what fails in a helper fails the test that called it"
)]

use helfrich_std::picture::{
    Axis, AxisScale, Canvas, Chart, ColourMap, Colouring, Curve, Frame, Marks, PaintedSurface,
    Picture, PictureError, Point, Shading, View,
};
use helfrich_tests::meshes::{Mesh, cases, icosphere};
use helfrich_tests::tolerance::PICTURE_RADIUS;
use proptest::prelude::*;
use std::{fs, io};
use tempfile::TempDir;

/// View of a ball in the middle of a square picture, along y with z upwards and x to the right.
const AHEAD: View = View {
    direction: [0.0, -1.0, 0.0],
    up: [0.0, 0.0, 1.0],
    frame: Some(Frame {
        centre: [0.0; 3],
        radius: 2.0,
    }),
};

fn picture<'a>(surfaces: &'a [PaintedSurface<'a>], map: ColourMap) -> Picture<'a> {
    Picture {
        size: [400, 400],
        title: "",
        surfaces,
        colours: Colouring {
            label: "x [µm]",
            range: None,
            map,
        },
        view: AHEAD,
        length_unit: None,
    }
}

fn painted<'a>(mesh: &'a Mesh, field: Option<&'a [f64]>) -> PaintedSurface<'a> {
    PaintedSurface {
        surface: mesh.surface(),
        field,
        shading: Shading::Smooth,
        edges: false,
        strokes: None,
    }
}

/// Red, green and blue of the pixel at these fractions of the width and the height.
fn pixel(canvas: &Canvas, x: f64, y: f64) -> [u8; 3] {
    let [width, height] = canvas.size();
    let at = |share: f64, count: usize| ((share * count as f64) as usize).min(count - 1);
    let start = 3 * (at(y, height) * width + at(x, width));
    canvas.rgb()[start..start + 3].try_into().unwrap()
}

const WHITE: [u8; 3] = [255; 3];

/// The parallel projection of a ball is a disc of the right size.
#[test]
fn a_sphere_covers_a_disc_of_the_right_size() {
    let mesh = icosphere(4);
    let surfaces = [painted(&mesh, None)];
    let canvas = picture(&surfaces, ColourMap::Sequential).draw().unwrap();
    let [width, height] = canvas.size();
    let rgb = canvas.rgb();
    let seen: Vec<[f64; 2]> = (0..width * height)
        .filter(|at| rgb[3 * at..3 * at + 3] != WHITE)
        .map(|at| [(at % width) as f64 + 0.5, (at / width) as f64 + 0.5])
        .collect();
    let count = seen.len() as f64;
    let radius = (count / std::f64::consts::PI).sqrt();
    // The frame's radius of 2 is half of what the margins leave of 400 pixels.
    let letters = 12.0 * (400.0_f64 / 900.0).sqrt();
    let expected = (400.0 - 4.0 * letters) / 4.0;
    PICTURE_RADIUS.assert(radius, expected, expected, "radius in pixels");
    for axis in 0..2 {
        let centre = seen.iter().map(|at| at[axis]).sum::<f64>() / count;
        PICTURE_RADIUS.assert(centre, 200.0, expected, "centre in pixels");
    }
}

/// A line at a vertex in front is visible, one at a vertex behind is not.
#[test]
fn lines_are_drawn_on_the_side_that_is_seen() {
    let ball = icosphere(3);
    let plain = [painted(&ball, None)];
    let plain = picture(&plain, ColourMap::Sequential).draw().unwrap();
    let ends = [-1.0, 1.0].map(|side| {
        let along = |x: &[f64; 3]| side * x[1];
        let mut vertices = (0..ball.positions.len()).collect::<Vec<_>>();
        vertices.sort_by(|&a, &b| along(&ball.positions[b]).total_cmp(&along(&ball.positions[a])));
        vertices[0]
    });
    for (vertex, is_seen) in ends.into_iter().zip([true, false]) {
        let mut directions = vec![None; ball.positions.len()];
        directions[vertex] = Some([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
        let surfaces = [PaintedSurface {
            strokes: Some(&directions),
            ..painted(&ball, None)
        }];
        let canvas = picture(&surfaces, ColourMap::Sequential).draw().unwrap();
        assert_eq!(canvas.rgb() != plain.rgb(), is_seen);
        let darkest = |canvas: &Canvas| canvas.rgb().chunks(3).map(|part| part[1]).min();
        assert_eq!(darkest(&canvas) < darkest(&plain), is_seen);
    }
    let surfaces = [PaintedSurface {
        strokes: Some(&[None]),
        ..painted(&ball, None)
    }];
    let refused = picture(&surfaces, ColourMap::Sequential).draw();
    assert!(matches!(refused, Err(PictureError::CountMismatch { .. })));
}

/// The lines of a ball end at the outline of a nearer ball.
#[test]
fn lines_end_where_another_surface_hides_them() {
    let ball = icosphere(4);
    let directions = Vec::from_iter(ball.positions.iter().map(|&[x, y, _]| {
        let length = (x * x + y * y).sqrt();
        let around = [-y / length, x / length, 0.0];
        (length > 0.0).then_some([around, around])
    }));
    let near = ball.map(|[x, y, z]| [x - 0.5, y - 3.0, z]);
    let far = ball.map(|[x, y, z]| [x + 0.5, y + 3.0, z]);
    let [plain, lines] = [None, Some(&directions[..])].map(|strokes| {
        let far = PaintedSurface {
            strokes,
            ..painted(&far, None)
        };
        let surfaces = [painted(&near, None), far];
        picture(&surfaces, ColourMap::Sequential).draw().unwrap()
    });
    // Outline of the nearer ball as in the test of its size, less the width of a line at the edge.
    let letters = 12.0 * (400.0_f64 / 900.0).sqrt();
    let radius = (400.0 - 4.0 * letters) / 4.0;
    let centre = [200.0 - 0.5 * radius, 200.0];
    let [width, _] = lines.size();
    let from_centre = |at: usize| {
        let x = [(at % width) as f64 + 0.5, (at / width) as f64 + 0.5];
        ((x[0] - centre[0]).powi(2) + (x[1] - centre[1]).powi(2)).sqrt()
    };
    let rgb = [lines.rgb(), plain.rgb()];
    let changed = (0..rgb[0].len() / 3)
        .filter(|at| rgb[0][3 * at..3 * at + 3] != rgb[1][3 * at..3 * at + 3])
        .map(from_centre);
    let changed = Vec::from_iter(changed);
    assert!(changed.len() > 1000, "{}", changed.len());
    let nearest = changed.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(
        (radius - 3.0..radius + 3.0).contains(&nearest),
        "{nearest} of {radius}"
    );
}

#[test]
fn fields_become_colours_where_they_are_and_the_nearer_surface_is_seen() {
    let ball = icosphere(3);
    let x: Vec<f64> = ball.positions.iter().map(|x| x[0]).collect();
    let surfaces = [painted(&ball, Some(&x))];
    let mut diverging = picture(&surfaces, ColourMap::Diverging);
    diverging.view.frame = None;
    diverging.size = [520, 400];
    let canvas = diverging.draw().unwrap();
    // Left of the colour bar, the ball fills the height: blue, light and red from left to right.
    let [left, middle, right] = [0.2, 0.42, 0.65].map(|x| pixel(&canvas, x, 0.5));
    assert!(left[2] > left[0] + 60, "{left:?}");
    assert!(right[0] > right[2] + 60, "{right:?}");
    assert!(middle[0].abs_diff(middle[2]) < 40, "{middle:?}");
    assert_eq!(pixel(&canvas, 0.01, 0.01), WHITE);

    // The viewer is at y = −∞: the ball with the smaller y is visible.
    let moved = |y: f64| ball.map(|[a, b, c]| [a, b + y, c]);
    let (near, far) = (moved(-3.0), moved(3.0));
    let [low, high] = [0.0, 1.0].map(|value| vec![value; ball.positions.len()]);
    for order in [[0, 1], [1, 0]] {
        let both = [painted(&near, Some(&low)), painted(&far, Some(&high))];
        let both = order.map(|at| both[at]);
        let canvas = picture(&both, ColourMap::Diverging).draw().unwrap();
        let seen = pixel(&canvas, 0.4, 0.5);
        assert!(seen[0].abs_diff(seen[2]) < 40, "{seen:?}");
        let both = [painted(&near, Some(&high)), painted(&far, Some(&low))];
        let both = order.map(|at| both[at]);
        let canvas = picture(&both, ColourMap::Diverging).draw().unwrap();
        let seen = pixel(&canvas, 0.4, 0.5);
        assert!(seen[0] > seen[2] + 60, "{seen:?}");
    }
}

#[test]
fn a_png_file_holds_the_canvas() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("picture.png");
    let ball = icosphere(2);
    let z: Vec<f64> = ball.positions.iter().map(|x| x[2]).collect();
    let surfaces = [painted(&ball, Some(&z))];
    let picture = Picture {
        title: "t = 0.1 s, κ − 1",
        length_unit: Some("µm"),
        ..picture(&surfaces, ColourMap::Sequential)
    };
    let canvas = picture.draw().unwrap();
    canvas.write_png(&path).unwrap();
    let file = io::BufReader::new(fs::File::open(&path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut bytes).unwrap();
    assert_eq!([frame.width, frame.height], [400, 400]);
    assert_eq!(bytes, canvas.rgb());
    assert_eq!(picture.draw().unwrap(), canvas);
}

#[test]
fn impossible_pictures_are_refused() {
    let ball = icosphere(0);
    let surfaces = [painted(&ball, Some(&[0.0; 3]))];
    let error = picture(&surfaces, ColourMap::Diverging).draw().unwrap_err();
    assert_eq!(
        error.to_string(),
        "surface 0: the field has 3 values, the mesh 12 vertices"
    );
    let surfaces = [painted(&ball, None)];
    let good = picture(&surfaces, ColourMap::Sequential);
    for size in [[100, 400], [400, 1 << 20]] {
        let error = Picture {
            size,
            ..good.clone()
        }
        .draw()
        .unwrap_err();
        assert!(matches!(error, PictureError::Size { .. }), "{error}");
    }
    for direction in [[0.0; 3], [0.0, 0.0, -2.0], [f64::NAN, 1.0, 0.0]] {
        let view = View { direction, ..AHEAD };
        let error = Picture {
            view,
            ..good.clone()
        }
        .draw()
        .unwrap_err();
        assert!(matches!(error, PictureError::View { .. }), "{error}");
    }
    for range in [
        [1.0, 1.0],
        [2.0, 1.0],
        [0.0, f64::NAN],
        [f64::MIN, f64::MAX],
    ] {
        let colours = Colouring {
            range: Some(range),
            ..good.colours
        };
        let error = Picture {
            colours,
            ..good.clone()
        }
        .draw()
        .unwrap_err();
        assert!(matches!(error, PictureError::Range { .. }), "{error}");
        let x = Axis {
            range: Some(range),
            ..Axis::default()
        };
        assert!(matches!(
            chart(x, Vec::new()).draw(SIZE),
            Err(PictureError::Range { .. })
        ));
    }
    let x = Axis {
        range: Some([0.0, 1.0]),
        scale: AxisScale::Logarithmic,
        ..Axis::default()
    };
    assert!(matches!(
        chart(x, Vec::new()).draw(SIZE),
        Err(PictureError::Range { .. })
    ));
}

/// Width and height of charts.
const SIZE: [u32; 2] = [450, 350];

fn chart(x: Axis, curves: Vec<Curve>) -> Chart {
    Chart {
        axes: [x, Axis::default()],
        curves,
        ..Chart::default()
    }
}

/// Mean position of the pixels with colours as saturated as a mark's, as fractions of the picture.
fn coloured(canvas: &Canvas) -> [f64; 2] {
    let [width, height] = canvas.size();
    let rgb = canvas.rgb();
    let strong = |at: &usize| {
        let part = &rgb[3 * at..3 * at + 3];
        part.iter().max().unwrap() - part.iter().min().unwrap() > 100
    };
    let found: Vec<usize> = (0..width * height).filter(strong).collect();
    assert!(!found.is_empty());
    let mean = |part: fn(usize, usize) -> usize, count: usize| {
        let sum: usize = found.iter().map(|&at| part(at, width)).sum();
        (sum as f64 / found.len() as f64 + 0.5) / count as f64
    };
    [
        mean(|at, width| at % width, width),
        mean(|at, width| at / width, height),
    ]
}

/// Equal steps on a linear axis, and equal ratios on a logarithmic one, are equal steps in the picture.
#[test]
fn points_are_where_their_axes_have_them() {
    for (scale, range, values) in [
        (AxisScale::Linear, [-1.0, 3.0], [0.0, 1.0, 2.0]),
        (AxisScale::Logarithmic, [1e-6, 1e2], [1e-4, 1e-2, 1.0]),
    ] {
        let axis = Axis {
            range: Some(range),
            scale,
            ..Axis::default()
        };
        let places = values.map(|value| {
            let chart = Chart {
                axes: [axis.clone(), axis.clone()],
                curves: vec![Curve {
                    points: vec![Point::from([value, value])],
                    marks: Marks::Points,
                    ..Curve::default()
                }],
                ..Chart::default()
            };
            coloured(&chart.draw(SIZE).unwrap())
        });
        // x increases to the right, y upwards.
        for (axis, direction) in [(0, 1.0), (1, -1.0)] {
            let [a, b, c] = places.map(|place| direction * place[axis]);
            assert!(b > a);
            PICTURE_RADIUS.assert(c - b, b - a, b - a, "step");
        }
    }
}

proptest! {
    #![proptest_config(cases(24))]

    /// Any input is either drawn or refused. Surfaces beyond 2²⁵² are refused.
    #[test]
    fn no_number_breaks_a_picture(
        exponent in -308_i32..76,
        values in prop::collection::vec(any::<f64>(), 12),
        diverging: bool,
        logarithmic: bool,
    ) {
        let size = 10.0_f64.powi(exponent);
        let ball = icosphere(0).map(|x| x.map(|x| size * x));
        for field in [&values, &vec![values[0]; 12]] {
            let map = if diverging { ColourMap::Diverging } else { ColourMap::Sequential };
            let direction = [values[0], values[1], values[2]];
            let strokes = [Some([[1.0, 0.0, 0.0], direction]); 12];
            let strokes = Some(&strokes[..]);
            let surfaces = [PaintedSurface { edges: diverging, strokes, ..painted(&ball, Some(field)) }];
            let mut picture = picture(&surfaces, map);
            picture.view = View::default();
            picture.length_unit = Some("m");
            picture.draw().unwrap();
        }
        let points = values.chunks(2).map(|pair| [pair[0], pair[1]]);
        let points = points.map(|at| Point { bounds: Some(at), ..Point::from(at) });
        let curve = Curve {
            name: "all".to_owned(),
            points: points.collect(),
            marks: Marks::LineAndPoints,
            ..Curve::default()
        };
        let scale = if logarithmic { AxisScale::Logarithmic } else { AxisScale::Linear };
        let axis = Axis { scale, ..Axis::default() };
        let dashed = Curve { marks: Marks::Dashes, ..curve.clone() };
        for curves in [vec![], vec![curve], vec![dashed]] {
            let axes = [axis.clone(), axis.clone()];
            Chart { axes, curves, ..Chart::default() }.draw(SIZE).unwrap();
        }
    }
}
