//! `helfrich paper`.

use crate::{command, fail, run, succeed, text};
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
        "42,162",
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

/// The page has its parts and figures, a repeated command measures nothing again, and a run that somebody else has put
/// there is left alone.
#[test]
fn the_page_is_complete_and_a_repeated_command_reuses_everything() {
    let folder = TempDir::new().unwrap();
    let [out, cache, figures] = ["out", "cache", "figures"].map(|name| folder.path().join(name));
    let own = "boundary-integral-meyer-0.15-0.1125-162-1.6";
    let foreign = out.join("runs").join(own);
    fs::create_dir_all(&foreign).unwrap();
    fs::write(foreign.join("series.csv"), "mine").unwrap();
    let arguments = small(&out, &cache);
    let said = succeed(&[&arguments[..], &["--figures", text(&figures)]].concat());
    assert!(
        said.contains("D(γ̇t) of C, boundary integral N = 162"),
        "{said}"
    );
    let page = out.join("index.html");
    let html = fs::read_to_string(&page).unwrap();
    for part in [
        "id=\"deviations\"",
        "id=\"curvature\"",
        "id=\"flow\"",
        "id=\"review\"",
        "all made for this page",
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
    let made = runs(&out);
    let second = format!("{own}-2");
    assert_eq!(
        made,
        [own, &second, "lattice-4-7-f64-meyer-0.15-0.1125-162-1.6"]
    );
    assert_eq!(
        fs::read_to_string(foreign.join("series.csv")).unwrap(),
        "mine"
    );
    assert_eq!(fs::read_dir(&foreign).unwrap().count(), 1);

    // Five families of two meshes, their vertices, and two runs.
    succeed(&arguments);
    let html = fs::read_to_string(&page).unwrap();
    assert!(html.contains("17 taken from earlier runs"), "{}", {
        let (_, after) = html.split_once("<dt>Measurements").unwrap();
        &after[..80]
    });
    assert_eq!(runs(&out), made);
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

/// An interrupted command ends within a second, says where it will continue, and does so in the same run.
#[cfg(unix)]
#[test]
fn an_interrupted_page_continues_its_run() {
    let folder = TempDir::new().unwrap();
    let [out, cache] = ["out", "cache"].map(|name| folder.path().join(name));
    let arguments = [&small(&out, &cache)[..], &["--part", "capsule"]].concat();
    let child = command(&arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let name = "lattice-4-7-f64-meyer-0.15-0.1125-162-1.6";
    let begun = out.join("runs").join(name).join("checkpoint");
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
    assert!(!out.join("index.html").exists());
    let again = run(&arguments);
    assert_eq!(again.code, Some(0), "{}", again.stderr);
    // The run by boundary integrals, and the knowledge that the other had begun.
    let html = fs::read_to_string(out.join("index.html")).unwrap();
    assert!(html.contains("2 taken from earlier runs"));
    assert_eq!(runs(&out).len(), 2);
}
