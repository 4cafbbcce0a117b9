//! `helfrich curvature` with error bars.

use crate::fixture::{Fixture, disturbed, obj};
use crate::{fail, run, text};
use helfrich::shapes::Shape;
use helfrich_std::generate::{AnyShape, Family, GeneratedMesh, generate};
use helfrich_std::io::read;
use helfrich_std::report::noise_section;
use helfrich_std::study::{BEST_FIXED, Bars, NoiseRow};
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, SQRT_2};
use std::fs;

/// An ellipsoid with noise of 1e-3 of its size, a fiftieth of an edge on 2562 vertices.
fn noisy(vertices: usize) -> (AnyShape, GeneratedMesh, Fixture) {
    let shape: AnyShape = "ellipsoid:1,0.8,0.6".parse().unwrap();
    let mut made = generate(&shape, Family::Irregular, vertices, 1).unwrap();
    made.positions = disturbed(&made.positions, 1e-3);
    let file = Fixture::new("mesh.obj", obj(&made.positions, made.mesh.triangles()));
    (shape, made, file)
}

/// The columns of a table by their names.
fn columns(csv: &str) -> HashMap<String, Vec<String>> {
    let mut lines = csv.lines();
    let names = Vec::from_iter(lines.next().unwrap().split(','));
    let mut columns: HashMap<String, Vec<String>> = HashMap::new();
    for line in lines {
        let fields = Vec::from_iter(line.split(','));
        assert_eq!(fields.len(), names.len());
        for (name, field) in names.iter().zip(fields) {
            columns
                .entry((*name).to_owned())
                .or_default()
                .push(field.to_owned());
        }
    }
    columns
}

fn numbers(columns: &HashMap<String, Vec<String>>, name: &str) -> Vec<f64> {
    let fields = columns[name].iter();
    fields
        .map(|field| field.parse().unwrap_or(f64::NAN))
        .collect()
}

/// At nine of ten vertices and more the bar is longer than the error, whatever the method; those of jets
/// are short.
#[test]
fn bars_hold_for_every_method() {
    let (shape, made, file) = noisy(2562);
    let exact = Vec::from_iter(made.preimages.iter().map(|&at| shape.at(at)));
    let mut widths = Vec::new();
    for method in ["jet", "meyer", "loop", "j6"] {
        let arguments = ["curvature", file.path(), "--method", method, "--errors"];
        let columns = columns(&run(&arguments).stdout);
        let [mean, bar] = ["H", "H_error"].map(|name| numbers(&columns, name));
        let is_within =
            |vertex: &usize| (mean[*vertex] - exact[*vertex].mean).abs() <= bar[*vertex];
        let within = (0..exact.len()).filter(is_within).count();
        assert!(within * 100 >= 92 * exact.len(), "{method}: {within}");
        let verdicts = columns["verdict"].iter();
        assert!(
            verdicts.filter(|&verdict| verdict == "noise").count() > 2300,
            "{method}"
        );
        let mut bars = bar.clone();
        bars.sort_by(f64::total_cmp);
        widths.push(bars[bars.len() / 2]);
        if method == "jet" {
            let force = ["fx", "fy", "fz"].map(|name| numbers(&columns, name));
            let bar = numbers(&columns, "f_error");
            let is_within = |vertex: &usize| {
                let density = exact[*vertex].force_density(1.0);
                let off = (0..3).map(|k| force[k][*vertex] - density * exact[*vertex].normal[k]);
                off.map(|x| x * x).sum::<f64>().sqrt() <= bar[*vertex]
            };
            let within = (0..exact.len()).filter(is_within).count();
            assert!(within * 100 >= 92 * exact.len(), "f: {within}");
            let [larger, smaller] = ["k1", "k2"].map(|name| numbers(&columns, name));
            for (vertex, &mean) in mean.iter().enumerate() {
                assert!((0.5 * (larger[vertex] + smaller[vertex]) - mean).abs() < 1e-12);
            }
            let [curvedness, index] =
                ["curvedness", "shape_index"].map(|name| numbers(&columns, name));
            for (vertex, (&size, &index)) in curvedness.iter().zip(&index).enumerate() {
                // (k₁, k₂) in polar coordinates, to rounding.
                let angle = FRAC_PI_2 * index - FRAC_PI_4;
                let [along, across] = [SQRT_2 * size * angle.cos(), SQRT_2 * size * angle.sin()];
                assert!((along - larger[vertex]).abs() < 1e-12 * size, "{vertex}");
                assert!((across - smaller[vertex]).abs() < 1e-12 * size, "{vertex}");
            }
            let sigma = numbers(&columns, "sigma");
            assert!(sigma.iter().all(|sigma| (0.6e-3..1.5e-3).contains(sigma)));
        }
    }
    // Wide fits average noise, and the one-ring of a vertex does not.
    assert!(widths[0] < 0.2 * widths[1], "{widths:?}");
}

#[test]
fn scale_and_noise_can_be_told() {
    let (_, _, file) = noisy(2562);
    let arguments = ["curvature", file.path(), "--method", "jet"];
    let told = run(&[&arguments[..], &["--scale", "200", "--sigma", "0.01"]].concat()).stdout;
    let columns = columns(&told);
    let neighbours = numbers(&columns, "f_neighbours");
    assert!(neighbours.iter().all(|&count| count <= 200.0));
    assert!(neighbours.iter().filter(|&&count| count == 200.0).count() > 1500);
    assert!(
        numbers(&columns, "sigma")
            .iter()
            .all(|&sigma| sigma >= 0.01)
    );
    let error = fail(
        2,
        &[
            "curvature",
            file.path(),
            "--method",
            "meyer",
            "--sigma",
            "0.1",
        ],
    );
    assert!(error.contains("--errors"), "{error}");
    for wrong in [
        &["--scale", "12"][..],
        &["--radius", "0"],
        &["--radius", "0.1", "--scale", "50"],
    ] {
        fail(2, &[&["curvature", file.path()], wrong].concat());
    }
    let error = fail(
        2,
        &[
            "curvature",
            file.path(),
            "--method",
            "meyer",
            "--radius",
            "1",
        ],
    );
    assert!(error.contains("--errors"), "{error}");
    fail(
        2,
        &["curvature", file.path(), "--method", "jet", "--sigma", "-1"],
    );
}

/// Every column is a field, vectors as vectors, and the file is a mesh that can be read again.
#[test]
fn results_are_fields_of_a_surface() {
    let (_, made, file) = noisy(642);
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("surface.vtp");
    let vtp = text(&out);
    let printed = run(&["curvature", file.path(), "--method", "jet", "--vtp", vtp]);
    assert_eq!(printed.stdout, "");
    let written = fs::read_to_string(&out).unwrap();
    for name in [
        "H",
        "H_error",
        "f_error",
        "direction1",
        "gradient_H",
        "verdict",
        "f_neighbours",
    ] {
        assert!(written.contains(&format!("Name=\"{name}\"")), "{name}");
    }
    assert_eq!(read(&out).unwrap().positions, made.positions);
}

/// With a measurement there are lines of curvature, also over the values of another method; without there are
/// none.
#[test]
fn surfaces_are_drawn() {
    let (_, made, file) = noisy(642);
    let folder = tempfile::tempdir().unwrap();
    let draw = |name: &str, arguments: &[&str]| {
        let out = folder.path().join(name);
        let all = ["curvature", file.path(), "--picture", text(&out)];
        let printed = run(&[&all[..], arguments].concat());
        assert_eq!((printed.code, &*printed.stdout), (Some(0), ""));
        let decoder = png::Decoder::new(std::io::Cursor::new(fs::read(out).unwrap()));
        let mut reader = decoder.read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        pixels
    };
    // Of all pixels that are dark: lines.
    let lines = |pixels: &[u8]| {
        let of = |part: &[u8]| part.iter().all(|&x| x < 40);
        pixels.chunks(3).filter(|pixel| of(pixel)).count()
    };
    let jet = draw("jet.png", &["--method", "jet"]);
    let [without, with] = [
        draw("j6.png", &["--method", "j6"]),
        draw("j6-errors.PNG", &["--method", "j6", "--errors"]),
    ];
    for pixels in [&jet, &with] {
        let both = [pixels, &without].map(|pixels| lines(pixels));
        assert!(both[0] > 4 * both[1], "{both:?}");
    }
    for quantity in ["k2", "H_error"] {
        let other = draw("other.png", &["--method", "jet", "--colour-by", quantity]);
        assert!(other != jet, "{quantity}");
    }
    let refused = |name: &str, arguments: &[&str], reason: &str| {
        let out = folder.path().join(name);
        let all = ["curvature", file.path(), "--picture", text(&out)];
        let ended = run(&[&all[..], arguments].concat());
        assert_eq!((ended.code, &*ended.stdout), (Some(2), ""));
        assert!(ended.stderr.contains(reason), "{}", ended.stderr);
        assert!(!out.exists(), "{name}");
    };
    let by_fits = ["--method", "j6", "--colour-by", "k1"];
    refused("none.png", &by_fits, "--errors");
    let by_directions = ["--method", "j6", "--colour-by", "direction1"];
    refused("none.png", &by_directions, "H_error");
    refused(
        "none.png",
        &["--method", "kantor-nelson"],
        "no vertex has a value of H",
    );
    refused("none.jpg", &[], "a name that ends in .png");
    let both = folder.path().join("both.png");
    refused(
        "both.png",
        &["--vtp", text(&both)],
        "two outputs have this name",
    );
    let copy = Fixture::new("mesh.png", "");
    fail(2, &["curvature", copy.path(), "--picture", copy.path()]);
    fail(2, &["curvature", file.path(), "--picture", file.path()]);
    assert_eq!(
        read(file.path().as_ref()).unwrap().positions,
        made.positions
    );
}

/// Without noise `jet` is J6; with it, it is nearly the best of all fits, and much better than J6.
#[test]
fn methods_are_compared_at_each_noise() {
    let arguments = ["study", "--noise", "0,1e-2", "--method", "meyer,j6"];
    let study = |more: &[&str]| run(&[&arguments[..], more].concat()).stdout;
    let rows = study(&["--family", "regular", "--vertices", "2562", "--json", "-"]);
    let rows: Vec<serde_json::Value> = serde_json::from_str(&rows).unwrap();
    let error = |method: &str, deviation: f64, quantity: usize| {
        let is_wanted = |row: &&serde_json::Value| {
            row["method"] == method && row["deviation"].as_f64() == Some(deviation)
        };
        let row = rows.iter().find(is_wanted).unwrap();
        row["errors"][quantity].as_f64().unwrap()
    };
    for quantity in 0..3 {
        let [jet, j6] = ["jet", "j6"].map(|method| error(method, 0.0, quantity));
        assert!((jet / j6 - 1.0).abs() < 1e-9);
        let [jet, j6, best] =
            ["jet", "j6", "best fixed fit"].map(|method| error(method, 1e-2, quantity));
        assert!(
            jet < 1.3 * best && jet < 0.2 * j6,
            "{quantity}: {jet} {best} {j6}"
        );
        assert!(error("meyer", 1e-2, quantity) > jet);
    }
    let table = study(&["--vertices", "162"]);
    assert!(table.contains("bars of jet"), "{table}");
    fail(2, &["study", "--noise", "-1"]);
    fail(2, &["study", "--noise", "2"]);
}

/// The bars of `jet` are below its errors, and the least error is bold: the best fixed fit is no method.
#[test]
fn a_page_has_a_table_for_each_quantity() {
    let row = |method, error| NoiseRow {
        family: "regular",
        vertices: 2562,
        deviation: 1e-2,
        method,
        errors: [Some(error), None, Some(10.0 * error)],
        bars: (method == "jet").then_some(
            [Bars {
                within: 0.994,
                median: 3.9,
                size: 0.31,
                neighbours: 128,
            }; 3],
        ),
        found: (method == "jet").then_some(9.8e-3),
        verdicts: (method == "jet").then_some([0.0, 0.97, 0.03]),
    };
    let rows = [row("meyer", 0.12), row("jet", 0.09), row(BEST_FIXED, 0.07)];
    let html = String::from_utf8(noise_section(&rows).unwrap().html).unwrap();
    let (_, table) = html.split_once("id=\"noise-regular-2562-H\"").unwrap();
    let (table, _) = table.split_once("</table>").unwrap();
    let cells = [
        "0.01 edges",
        "12 %",
        "<b>9.0 %</b>",
        "99.4 %, ×3.9",
        "<td>7.0 %",
    ];
    let places = cells.map(|cell| {
        table
            .find(cell)
            .unwrap_or_else(|| panic!("{cell}: {table}"))
    });
    assert!(places.is_sorted(), "{table}");
    assert_eq!(html.matches("<table").count(), 4);
    let (_, table) = html.split_once("id=\"noise-found-regular-2562\"").unwrap();
    let (table, _) = table.split_once("</table>").unwrap();
    for cell in ["9.8e-3", "<td>128<", "<td>31 %<", "<td>97 %<", "<td>3.0 %<"] {
        assert!(table.contains(cell), "{cell}: {table}");
    }
    let section = noise_section(&rows).unwrap();
    let names = Vec::from_iter(section.charts.iter().map(|(name, _)| name.as_str()));
    assert_eq!(
        names,
        ["noise-error-regular-2562-H", "noise-error-regular-2562-f"]
    );
    let curves = &section.charts[0].1.curves;
    let bars = curves
        .iter()
        .find(|curve| curve.name == "bars of jet")
        .unwrap();
    assert_eq!(bars.points[0].at, [1e-2, 0.31]);
}
