//! `helfrich paper`.

use crate::{command, fail, succeed, text};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A small page: one method, coarse meshes, and two runs.
fn small<'a>(out: &'a Path, cache: &'a Path) -> Vec<&'a str> {
    vec![
        "paper",
        "--quick",
        "--out",
        text(out),
        "--cache",
        text(cache),
        "--part",
        "curvature,capsule",
        "--method",
        "C",
        "--vertices",
        "42,92",
    ]
}

/// The names of the runs in the folder of a page.
fn runs(out: &Path) -> Vec<String> {
    let entries = fs::read_dir(out.join("runs")).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names = Vec::from_iter(names);
    names.sort();
    names
}

/// How many measurements a page has taken from earlier runs.
#[track_caller]
fn reused(html: &str) -> usize {
    let (_, rest) = html.split_once("<dt>Measurements</dt><dd>").unwrap();
    match rest.split_once(" taken from earlier runs") {
        Some((count, _)) => count.parse().unwrap(),
        None => {
            assert!(
                rest.starts_with("all made for this page"),
                "{}",
                &rest[..60]
            );
            0
        }
    }
}

/// The runs of the small page.
const OWN: [&str; 2] = [
    "boundary-integral-meyer-0.15-0.1125-162-1.6",
    "lattice-4-7-f64-meyer-0.15-0.1125-162-1.6",
];

/// An interrupted command says where it continues, and does so in the same run; a run of somebody else is left alone; a
/// repeated command measures nothing again.
#[cfg(unix)]
#[test]
fn an_interrupted_page_is_continued_and_a_finished_one_is_reused() {
    let folder = TempDir::new().unwrap();
    let [out, cache, figures] = ["out", "cache", "figures"].map(|name| folder.path().join(name));
    let foreign = out.join("runs").join(OWN[0]);
    fs::create_dir_all(&foreign).unwrap();
    fs::write(foreign.join("series.csv"), "mine").unwrap();
    let second = format!("{}-2", OWN[0]);
    let arguments = small(&out, &cache);
    let child = command(&arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let begun = out.join("runs").join(OWN[1]).join("checkpoint");
    let start = Instant::now();
    while !begun.exists() && start.elapsed() < Duration::from_secs(60) {
        sleep(Duration::from_millis(5));
    }
    let id = child.id().to_string();
    Command::new("kill").args(["-INT", &id]).status().unwrap();
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(said.contains("kept in"), "{said}");
    let page = out.join("index.html");
    assert!(!page.exists());

    let said = succeed(&[&arguments[..], &["--figures", text(&figures)]].concat());
    assert!(
        said.contains("D(γ̇t) of C, boundary integral N = 162"),
        "{said}"
    );
    let html = fs::read_to_string(&page).unwrap();
    // Five families of two meshes, their vertices, the run by boundary integrals, and that the other had begun.
    assert_eq!(reused(&html), 17);
    let made = runs(&out);
    assert_eq!(made, [OWN[0], &second, OWN[1]]);
    assert_eq!(
        fs::read_to_string(foreign.join("series.csv")).unwrap(),
        "mine"
    );
    assert_eq!(fs::read_dir(&foreign).unwrap().count(), 1);
    is_complete(&html, &figures);

    let before = series(&out);
    // D over γ̇t is linear between rows: they must be as close as the first published points.
    for series in &before[1..] {
        let strain = series.lines().nth(2).and_then(|row| row.split(',').nth(1));
        let strain: f64 = strain.unwrap().parse().unwrap();
        assert!(strain < 0.051, "{strain}");
    }
    succeed(&arguments);
    assert_eq!(reused(&fs::read_to_string(&page).unwrap()), 17);
    assert_eq!(runs(&out), made);
    assert_eq!(series(&out), before);
}

/// The numbers of the runs.
fn series(out: &Path) -> Vec<String> {
    let of = |name: String| fs::read_to_string(out.join("runs").join(name).join("series.csv"));
    runs(out)
        .into_iter()
        .map(|name| of(name).unwrap())
        .collect()
}

/// The page has the parts that were asked for, and the folder every figure.
#[track_caller]
fn is_complete(html: &str, figures: &Path) {
    for part in [
        "id=\"deviations\"",
        "id=\"curvature\"",
        "id=\"flow\"",
        "id=\"review\"",
        "quick form",
    ] {
        assert!(html.contains(part), "{part}");
    }
    for absent in ["id=\"precision\"", "src=\"http", "<link", "url("] {
        assert!(!html.contains(absent), "{absent}");
    }
    for name in [
        "error-vertices-f-max-regular",
        "meridian-H-irregular-meyer",
        "flow-deformation",
    ] {
        assert!(html.contains(&format!("id=\"{name}\"")), "{name}");
        for ending in ["svg", "png"] {
            let file = figures.join(format!("{name}.{ending}"));
            assert!(fs::metadata(&file).unwrap().len() > 500, "{name}.{ending}");
        }
    }
}

/// A page of somebody else is not replaced, and impossible meshes are refused before anything is made.
#[test]
fn foreign_pages_and_impossible_meshes_are_refused() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let message = fail(2, &["paper", "--out", text(&out), "--vertices", "7"]);
    assert!(message.contains('7'), "{message}");
    assert!(!out.exists());
    fs::create_dir(&out).unwrap();
    let page = out.join("index.html");
    for foreign in ["", "<!doctype html><title>mine</title>"] {
        fs::write(&page, foreign).unwrap();
        let message = fail(2, &["paper", "--quick", "--out", text(&out)]);
        assert!(
            message.contains("move it away") && message.contains(text(&page)),
            "{message}"
        );
        assert_eq!(fs::read_to_string(&page).unwrap(), foreign);
    }
    assert_eq!(fs::read_dir(&out).unwrap().count(), 1);
}

/// Digits and times in every number type are a part of their own.
#[test]
fn the_part_of_number_types_has_each() {
    let folder = TempDir::new().unwrap();
    let [out, cache] = ["out", "cache"].map(|name| folder.path().join(name));
    succeed(&[
        "paper",
        "--out",
        text(&out),
        "--cache",
        text(&cache),
        "--part",
        "precision",
        "--method",
        "C,j4",
        "--vertices",
        "42,162",
    ]);
    let html = fs::read_to_string(out.join("index.html")).unwrap();
    let (_, table) = html.split_once("<table id=\"digits-f-table\"").unwrap();
    let (table, _) = table.split_once("</table>").unwrap();
    for scalar in ["f32", "f32-pair", "f64"] {
        assert!(
            table.contains(&format!("<th scope=\"col\">{scalar}, digits")),
            "{scalar}"
        );
    }
    assert_eq!(table.matches("<tr>").count(), 1 + 2);
    assert!(!html.contains("id=\"curvature\"") && !out.join("runs").exists());
}
