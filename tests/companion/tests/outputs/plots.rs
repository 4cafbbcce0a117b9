//! Plots of series beside published curves, and pictures of flow on a plane.
#![expect(
    clippy::unwrap_used,
    reason = "what fails in a helper fails the test that called it"
)]

use helfrich_std::io::Grid;
use helfrich_std::picture::{Canvas, ColourMap, Colouring, FlowSlice, PictureError};
use helfrich_std::plots::{
    PlotError, PublishedCurve, SeriesCurve, SeriesPlot, columns_of, read_curves,
};
use helfrich_std::series::SeriesTable;
use helfrich_std::sweep::{Dependence, Sweep};
use helfrich_tests::meshes::{Mesh, icosphere};
use helfrich_tests::tolerance::PICTURE_RADIUS;
use std::fs;
use std::num::NonZeroUsize;
use tempfile::TempDir;

fn read(text: impl AsRef<[u8]>) -> Result<Vec<PublishedCurve>, String> {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("published.csv");
    fs::write(&path, text).unwrap();
    read_curves(&path).map_err(|error| {
        let message = error.to_string();
        let start = format!("{}: ", path.display());
        message.strip_prefix(&start).unwrap().to_owned()
    })
}

#[test]
fn published_curves_are_read_with_all_their_names() {
    let text = "# Digitised, ±0.002.\r\n\r\ncurve, x ,y\n\
                \"Guckenberger 2016, C and S\",0.1,2e-3\n\
                Zhu & Brandt 2015, 3 ,0.1536\n\
                \"Guckenberger 2016, C and S\" , 0.2 , -1\n\
                # In between.\n\
                \"the \"\"true\"\" one\",0,0";
    let expected = [
        ("Guckenberger 2016, C and S", vec![[0.1, 2e-3], [0.2, -1.0]]),
        ("Zhu & Brandt 2015", vec![[3.0, 0.1536]]),
        ("the \"true\" one", vec![[0.0, 0.0]]),
    ]
    .map(|(name, points)| PublishedCurve {
        name: name.to_owned(),
        points,
    });
    assert_eq!(read(text).unwrap(), expected);
    assert_eq!(read(format!("\u{feff}{text}")).unwrap(), expected);
}

#[test]
fn what_is_no_published_curve_is_refused_with_its_line() {
    for (text, message) in [
        ("", "there is no curve"),
        ("curve,x,y\n# nothing\n", "there is no curve"),
        ("x,y\n1,2\n", "line 1: the head has to be `curve,x,y`"),
        ("# a\na,1,2\n", "line 2: the head has to be `curve,x,y`"),
        ("curve,x,y\na,1\n", "line 2: 2 fields"),
        ("curve,x,y\na\n", "line 2: 1 fields"),
        ("curve,x,y\n\na,1,2,3\n", "line 3: 4 fields"),
        ("curve,x,y\nHuang, Chang and Sung,1,2\n", "line 2: 4 fields"),
        ("curve,x,y\n,1,2\n", "line 2: the curve has no name"),
        ("curve,x,y\n\" \",1,2\n", "line 2: the curve has no name"),
        (
            "curve,x,y\n\"a,1,2\n",
            "line 2: a name begins with a quotation",
        ),
        (
            "curve,x,y\n\"a\"b,1,2\n",
            "line 2: a name begins with a quotation",
        ),
        (
            "curve,x,y\na,1,2\na,l,2\n",
            "line 3, x: expected a finite number, found `l`",
        ),
        (
            "curve,x,y\na,1,\n",
            "line 2, y: expected a finite number, found ``",
        ),
        (
            "curve,x,y\na,1,inf\n",
            "line 2, y: expected a finite number, found `inf`",
        ),
    ] {
        let found = read(text).unwrap_err();
        assert!(found.starts_with(message), "{text:?}: {found}");
    }
    let found = read(b"curve,x,y\n\xff,1,2\n").unwrap_err();
    assert!(found.starts_with("line 2: is not UTF-8 text"), "{found}");
    let found = read(vec![b'#'; (1 << 24) + 1]).unwrap_err();
    assert!(
        found.starts_with("is longer than 16777216 bytes"),
        "{found}"
    );
    let folder = TempDir::new().unwrap();
    for path in [folder.path().join("none.csv"), folder.path().to_owned()] {
        let message = read_curves(&path).unwrap_err().to_string();
        assert!(
            message.starts_with(&path.display().to_string()),
            "{message}"
        );
    }
}

fn table() -> SeriesTable {
    SeriesTable {
        columns: ["time", "strain", "deformation_a", "deformation_b", "energy"]
            .map(str::to_owned)
            .to_vec(),
        rows: vec![
            vec![0.0, 0.0, 0.0, 0.0, 1.0],
            vec![1.0, 2.0, 0.1, f64::NAN, 1.0],
            vec![2.0, 4.0, 0.2, 0.4, 1.0],
        ],
    }
}

fn plot<'a>(curves: &'a [SeriesCurve<'a>], published: &'a [PublishedCurve]) -> SeriesPlot<'a> {
    SeriesPlot {
        size: [450, 350],
        title: "",
        labels: ["strain", "D"],
        curves,
        marked: false,
        hollow: &[],
        published,
    }
}

#[test]
fn names_stand_for_the_columns_of_all_surfaces() {
    let table = table();
    let surfaces = ["a", "c", "b"];
    let both = ["a", "b"].map(|name| (name.to_owned(), format!("deformation_{name}")));
    assert_eq!(columns_of(&table, "deformation", surfaces), both);
    let own = [("energy".to_owned(), "energy".to_owned())];
    assert_eq!(columns_of(&table, "energy", surfaces), own);
    assert_eq!(columns_of(&table, "volume", surfaces), []);
}

/// Number of pixels in colours that neither letters nor axes have.
fn coloured(canvas: &Canvas) -> usize {
    let rgb = canvas.rgb();
    let strong = |part: &&[u8]| part.iter().max().unwrap() - part.iter().min().unwrap() > 100;
    rgb.chunks(3).filter(strong).count()
}

#[test]
fn series_are_drawn_beside_what_was_published() {
    let table = table();
    let curve = |column| SeriesCurve {
        name: "",
        table: &table,
        against: "strain",
        column,
    };
    let line = [curve("deformation_a")];
    let drawn = coloured(&plot(&line, &[]).draw().unwrap());
    assert!(drawn > 100);
    // This column has a gap between its only two points, so that no line is drawn.
    let torn = [curve("deformation_b")];
    assert_eq!(coloured(&plot(&torn, &[]).draw().unwrap()), 0);
    let published = |points: &[[f64; 2]]| {
        [PublishedCurve {
            // There is no legend, which could hide parts of the curve.
            name: String::new(),
            points: points.to_vec(),
        }]
    };
    let mark = published(&[[1.0, 0.15]]);
    let marked = coloured(&plot(&line, &mark).draw().unwrap());
    assert!(marked > drawn + 20, "a mark: {marked} {drawn}");
    let curve = published(&[[0.0, 0.2], [2.0, 0.15], [4.0, 0.0]]);
    let dashed = coloured(&plot(&line, &curve).draw().unwrap());
    assert!(dashed > marked + 100, "broken lines");
    // A single row is drawn as a mark.
    let mut short = table.clone();
    short.rows.truncate(1);
    let alone = [SeriesCurve {
        table: &short,
        ..line[0]
    }];
    assert!(coloured(&plot(&alone, &[]).draw().unwrap()) > 10);
}

/// A hollow mark and its copy in the legend have less colour than two full ones.
#[test]
fn unresolved_runs_are_hollow() {
    let table = table();
    let line = [SeriesCurve {
        name: "",
        table: &table,
        against: "strain",
        column: "deformation_b",
    }];
    let hollow = [(0, vec![[2.0, 0.2]])];
    let drawn = |hollow: &[(usize, Vec<[f64; 2]>)]| {
        let plot = SeriesPlot {
            hollow,
            ..plot(&line, &[])
        };
        plot.draw().unwrap()
    };
    let ring = coloured(&drawn(&hollow));
    assert_eq!(coloured(&drawn(&[])), 0);
    let mark = [PublishedCurve {
        name: String::new(),
        points: vec![[2.0, 0.2]],
    }];
    let full = coloured(&plot(&line, &mark).draw().unwrap());
    assert!(ring > 10 && ring < 2 * full, "{ring} of {full}");
}

#[test]
fn plots_of_what_is_not_there_are_refused() {
    let table = table();
    let curve = [SeriesCurve {
        name: "",
        table: &table,
        against: "strian",
        column: "energy",
    }];
    let error = plot(&curve, &[]).draw().unwrap_err();
    assert_eq!(
        error.to_string(),
        "there is no column `strian`: there are time, strain, deformation_a, deformation_b, energy"
    );
    let tiny = SeriesPlot {
        size: [3, 3],
        ..plot(&[], &[])
    };
    let error = tiny.draw().unwrap_err();
    assert!(matches!(
        error,
        PlotError::Picture(PictureError::Size { .. })
    ));
}

const GRID: Grid = Grid {
    origin: [-3.0, -2.0, 0.5],
    axes: Grid::AXES,
    spacings: [0.5, 0.5, 1.0],
    counts: [13, 9, 1],
};

fn slice<'a>(velocity: &'a [[f64; 3]], field: Option<&'a [f64]>) -> FlowSlice<'a> {
    FlowSlice {
        size: [500, 400],
        title: "",
        grid: GRID,
        velocity,
        field,
        colours: Colouring {
            label: "p",
            range: None,
            map: ColourMap::Diverging,
        },
        surfaces: &[],
        length_unit: None,
    }
}

fn on_grid<V>(value: impl Fn([f64; 3]) -> V) -> Vec<V> {
    GRID.points().map(value).collect()
}

/// Pixels of a canvas with their colours.
fn pixels(canvas: &Canvas) -> Vec<([f64; 2], [u8; 3])> {
    let [width, _] = canvas.size();
    let rgb = canvas.rgb();
    let pixel = |(at, rgb): (usize, &[u8])| {
        let place = [(at % width) as f64 + 0.5, (at / width) as f64 + 0.5];
        (place, rgb.try_into().unwrap())
    };
    rgb.chunks(3).enumerate().map(pixel).collect()
}

/// A field that changes its sign is red on the right, blue on the left, and grey where it has no value: the
/// pixels show the directions of the plane's axes.
#[test]
fn colours_are_where_the_field_is() {
    let rest = on_grid(|_| [0.0; 3]);
    let field = on_grid(|[x, y, _]| if y < -1.4 { f64::NAN } else { x });
    let canvas = slice(&rest, Some(&field)).draw().unwrap();
    let mean = |of: fn([u8; 3]) -> bool| {
        // Pixels left of the colour bar.
        let found = pixels(&canvas);
        let found = found.iter().filter(|(at, rgb)| at[0] < 435.0 && of(*rgb));
        let found = Vec::from_iter(found.map(|(at, _)| *at));
        let count = found.len() as f64;
        [0, 1].map(|axis| found.iter().map(|at| at[axis]).sum::<f64>() / count)
    };
    let red = mean(|[r, _, b]| r > b.saturating_add(60));
    let blue = mean(|[r, _, b]| b > r.saturating_add(60));
    let grey = mean(|[r, g, b]| [r, g, b] == [140; 3]);
    assert!(red[0] > blue[0] + 100.0, "{red:?} {blue:?}");
    PICTURE_RADIUS.assert(red[1], blue[1], 300.0, "side by side");
    // Grey is below red, because y points upwards.
    assert!(grey[1] > red[1] + 100.0, "{grey:?}");
    PICTURE_RADIUS.assert(grey[0], 0.5 * (red[0] + blue[0]), 300.0, "in the middle");
}

/// Streamlines follow directions only: a faster flow has the same lines, a flow along the normal has none.
#[test]
fn streamlines_follow_what_lies_in_the_plane() {
    let field = on_grid(|_| 0.0);
    let draw = |velocity: &[[f64; 3]]| slice(velocity, Some(&field)).draw().unwrap();
    let flow = |[x, y, _]: [f64; 3]| [y + 0.3, -x, 0.0];
    let drawn = draw(&on_grid(flow));
    assert_eq!(drawn, draw(&on_grid(|at| flow(at).map(|u| 1024.0 * u))));
    let out = on_grid(|at| {
        let [u, v, _] = flow(at);
        [u, v, 7.0]
    });
    assert_eq!(drawn, draw(&out));
    let rest = draw(&on_grid(|_| [0.0; 3]));
    assert_eq!(rest, draw(&on_grid(|_| [0.0, 0.0, 5.0])));
    assert_ne!(rest, drawn);
    // Without a field, colours show the speed, and missing values do not matter.
    let torn = on_grid(|[x, y, _]| [if x > 1.0 { f64::NAN } else { y }, 0.0, 0.0]);
    slice(&torn, None).draw().unwrap();
}

/// A ball of radius 1 cut at a height of ½ leaves a circle of radius √3/2.
#[test]
fn outlines_are_those_of_the_plane() {
    let rest = on_grid(|_| [0.0; 3]);
    let field = on_grid(|_| 0.0);
    let bare = slice(&rest, Some(&field)).draw().unwrap();
    let ball: Mesh = icosphere(4);
    let surfaces = [ball.surface()];
    let with = FlowSlice {
        surfaces: &surfaces,
        ..slice(&rest, Some(&field))
    };
    let with = with.draw().unwrap();
    let ink = pixels(&with).into_iter().zip(pixels(&bare));
    let ink = ink.filter(|((_, with), (_, bare))| with != bare && with[0] < 60);
    let ink = Vec::from_iter(ink.map(|((at, _), _)| at));
    let count = ink.len() as f64;
    let mean = |axis: usize| ink.iter().map(|at| at[axis]).sum::<f64>() / count;
    let centre = [mean(0), mean(1)];
    let radius = |at: &[f64; 2]| (at[0] - centre[0]).hypot(at[1] - centre[1]);
    let radii = ink.iter().map(radius);
    // The frame is 6 lengths wide, filled with the colour of 0.
    let neutral = pixel(&bare, centre);
    let row = pixels(&bare).into_iter();
    let row = row.filter(|(at, rgb)| (at[1] - centre[1]).abs() <= 0.5 && *rgb == neutral);
    let width = row.count() as f64 + 1.0;
    assert!(width > 300.0, "{width}");
    let expected = 0.5 * 3.0_f64.sqrt() / 6.0 * width;
    for radius in [
        radii.clone().sum::<f64>() / count,
        radii.clone().fold(0.0, f64::max) - 1.5,
    ] {
        PICTURE_RADIUS.assert(radius, expected, 2.0 * expected, "radius");
    }
}

fn pixel(canvas: &Canvas, [x, y]: [f64; 2]) -> [u8; 3] {
    let [width, _] = canvas.size();
    let start = 3 * (y as usize * width + x as usize);
    canvas.rgb()[start..start + 3].try_into().unwrap()
}

#[test]
fn impossible_slices_are_refused() {
    let rest = on_grid(|_| [0.0; 3]);
    let refused = |change: fn(&mut FlowSlice<'_>)| {
        let mut slice = slice(&rest, None);
        change(&mut slice);
        slice.draw().unwrap_err()
    };
    for error in [
        refused(|slice| slice.grid.counts = [117, 1, 1]),
        refused(|slice| slice.grid.counts = [13, 1, 9]),
        refused(|slice| slice.grid.spacings[1] = 0.0),
        refused(|slice| slice.grid.origin[0] = f64::NAN),
    ] {
        assert!(matches!(error, PictureError::Grid { .. }), "{error}");
    }
    let error = refused(|slice| slice.velocity = &slice.velocity[1..]);
    assert_eq!(
        error.to_string(),
        "a field of the slice has 116 values, its grid 117 points"
    );
    let error = refused(|slice| slice.field = Some(&[1.0]));
    assert!(matches!(
        error,
        PictureError::PointMismatch {
            found: 1,
            points: 117
        }
    ));
    let error = refused(|slice| slice.size = [10, 10]);
    assert!(matches!(error, PictureError::Size { .. }));
}

/// Curves of a sweep over one of its keys.
#[test]
fn crossings_of_cubics_are_exact() {
    let curve = |name: &str, values: &[f64], f: fn(f64) -> f64| {
        let points = values.iter().map(|&x| [x, f(x)]);
        (name.to_owned(), Vec::from_iter(points))
    };
    let values = [-1.0, -0.4, 0.1, 0.5, 1.2, 2.0];
    let dependence = Dependence {
        key: "x".to_owned(),
        column: "y".to_owned(),
        curves: vec![
            curve("a", &values, |x| 2.0 + x),
            // Crosses where (x − 0.3) (x + 0.7) (x − 3) = 0, twice in the range.
            curve("b", &values, |x| {
                2.0 + x + (x - 0.3) * (x + 0.7) * (x - 3.0)
            }),
            // Shares two values only, and touches a at one.
            curve("c", &[0.1, 0.2, 0.5], |x| 2.0 + x + (x - 0.5)),
        ],
        unresolved: Vec::new(),
    };
    let found = dependence.crossings();
    let of = |names: [&str; 2]| {
        let own = found.iter().filter(move |crossing| crossing.names == names);
        Vec::from_iter(own.map(|crossing| crossing.at))
    };
    for (crossing, x) in of(["a", "b"]).iter().zip([-0.7, 0.3]) {
        assert!(
            (crossing[0] - x).abs() < 1e-14 && (crossing[1] - 2.0 - x).abs() < 1e-14,
            "{found:?}"
        );
    }
    assert_eq!(of(["a", "b"]).len(), 2);
    assert_eq!(of(["a", "c"]).len(), 1);
    assert!((of(["a", "c"])[0][0] - 0.5).abs() < 1e-14, "{found:?}");
}

/// Runs that stop at the limit of iterations have no point on a curve of a sweep, and a hollow mark beside it.
#[test]
fn sweeps_have_hollow_marks_for_runs_without_an_equilibrium() {
    let folder = TempDir::new().unwrap();
    let scene = folder.path().join("scene.toml");
    let text = "units = \"none\"\n[[surface]]\nshape = \"ellipsoid:1,1,1.6\"\nvertices = 42\nbending = { method = \
                \"B\", modulus = 1 }\narea = { constraint = \"exact\" }\n[driver]\nkind = \"relax\"\niterations = \
                2\n[output]\npictures = false\nsurfaces = false\n";
    fs::write(&scene, text).unwrap();
    let sweep = Sweep {
        scene,
        set: Vec::new(),
        vary: vec!["surface.0.bending.modulus=1,2".parse().unwrap()],
        columns: vec!["energy".to_owned()],
        jobs: NonZeroUsize::MIN,
        part: None,
    };
    let out = folder.path().join("out");
    let swept = sweep.run(&out, false, &|| false, &mut |_| ()).unwrap();
    let found = swept.dependences("energy");
    let [dependence] = found.as_slice() else {
        panic!("{found:?}");
    };
    let [(_, points)] = dependence.curves.as_slice() else {
        panic!("{found:?}");
    };
    assert!(
        points.iter().all(|[_, energy]| energy.is_nan()),
        "{points:?}"
    );
    let [(0, points)] = dependence.unresolved.as_slice() else {
        panic!("{found:?}");
    };
    // The energy is proportional to the modulus.
    let [[1.0, first], [2.0, second]] = points.as_slice() else {
        panic!("{points:?}");
    };
    assert!((second / first - 2.0).abs() < 1e-6, "{points:?}");
}
