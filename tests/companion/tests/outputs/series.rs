//! Tables that grow during a run.
#![expect(
    clippy::unwrap_used,
    reason = "what fails in a helper fails the test that called it"
)]

use super::bits;
use helfrich_std::series::{Series, SeriesProblem, SeriesTable};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const COLUMNS: [&str; 3] = ["time", "energy_bending", "area"];

/// Numbers of all sizes, including infinity and NaN.
fn row(at: u64) -> [f64; 3] {
    let at = at as f64;
    let odd = [f64::NAN, f64::INFINITY, -0.0, 5e-324, f64::MAX][at as usize % 5];
    [at * 0.1, (at + 1.0) / 3.0, odd]
}

fn written(path: &Path, rows: u64) -> Vec<u8> {
    let mut series = Series::create(path, &COLUMNS).unwrap();
    (0..rows).for_each(|at| series.append(&row(at)).unwrap());
    assert_eq!(series.mark().unwrap(), rows);
    fs::read(path).unwrap()
}

#[test]
fn a_series_reads_back_to_the_bit() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("series.csv");
    let bytes = written(&path, 9);
    let first = "time,energy_bending,area\n0.0,0.3333333333333333,NaN\n";
    assert!(bytes.starts_with(first.as_bytes()));
    let table = SeriesTable::read(&path).unwrap();
    assert_eq!(table.columns, COLUMNS);
    assert_eq!(table.rows.len(), 9);
    for (at, found) in table.rows.iter().enumerate() {
        assert_eq!(bits(found), bits(&row(at as u64)));
    }
    let expected: Vec<f64> = (0..9).map(|at| row(at)[0]).collect();
    assert_eq!(table.column("time"), Some(expected));
    assert_eq!(table.column("volume"), None);
}

#[test]
fn wherever_a_series_was_torn_the_resumed_one_is_the_same() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("series.csv");
    let whole = written(&path, 5);
    let lines = |bytes: &[u8]| bytes.iter().filter(|&&byte| byte == b'\n').count() as u64;
    for length in 0..=whole.len() {
        let torn = &whole[..length];
        for marked in 0..=5 {
            fs::write(&path, torn).unwrap();
            let resumed = Series::resume(&path, &COLUMNS, marked);
            if lines(torn) < marked + 1 {
                resumed.unwrap_err();
                assert_eq!(fs::read(&path).unwrap(), torn);
                continue;
            }
            let mut series = resumed.unwrap();
            assert_eq!(lines(&fs::read(&path).unwrap()), marked + 1);
            (marked..5).for_each(|at| series.append(&row(at)).unwrap());
            assert_eq!(fs::read(&path).unwrap(), whole);
        }
    }
    // A reader does not see the incomplete line.
    fs::write(&path, &whole[..whole.len() - 2]).unwrap();
    assert_eq!(SeriesTable::read(&path).unwrap().rows.len(), 4);
}

/// A series that is deleted during a run is written again completely.
#[test]
fn a_series_that_was_taken_away_is_there_again() {
    let folder = TempDir::new().unwrap();
    let [path, whole] = ["series.csv", "whole.csv"].map(|name| folder.path().join(name));
    let whole = written(&whole, 6);
    let mut series = Series::create(&path, &COLUMNS).unwrap();
    for at in 0..6 {
        if at % 2 == 1 {
            fs::remove_file(&path).unwrap();
        }
        series.append(&row(at)).unwrap();
    }
    fs::remove_file(&path).unwrap();
    assert_eq!(series.mark().unwrap(), 6);
    assert_eq!(fs::read(&path).unwrap(), whole);
    // If its folder is gone, too, it cannot be written.
    drop(folder);
    let error = series.append(&row(6)).unwrap_err();
    assert!(
        matches!(error.problem, SeriesProblem::Inaccessible(_)),
        "{error}"
    );
}

/// Rows that another program writes into a series are not mixed with those of the run.
#[test]
fn a_series_that_another_program_has_changed_is_not_gone_on_with() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("series.csv");
    for change in [&b"9.0,9.0,9.0\n"[..], b""] {
        let mut series = Series::create(&path, &COLUMNS).unwrap();
        (0..3).for_each(|at| series.append(&row(at)).unwrap());
        let mut content = fs::read(&path).unwrap();
        if change.is_empty() {
            content.truncate(content.len() / 2);
        }
        content.extend(change);
        fs::write(&path, &content).unwrap();
        for problem in [
            series.append(&row(3)).unwrap_err().problem,
            series.mark().unwrap_err().problem,
        ] {
            assert!(
                matches!(problem, SeriesProblem::Changed { .. }),
                "{problem}"
            );
        }
        assert_eq!(fs::read(&path).unwrap(), content);
    }
}

#[test]
fn what_is_no_series_is_refused() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("series.csv");
    let create = |columns: &[&str]| Series::create(&path, columns).unwrap_err().problem;
    assert!(matches!(
        create(&["area", "time"]),
        SeriesProblem::NoTime { .. }
    ));
    assert!(matches!(create(&[]), SeriesProblem::NoTime { .. }));
    for name in ["", "a,b", "a\"", " a", "a\nb"] {
        assert!(matches!(
            create(&["time", name]),
            SeriesProblem::Name { .. }
        ));
    }
    let repeated = create(&["time", "area", "area"]);
    assert!(matches!(repeated, SeriesProblem::RepeatedName { .. }));
    assert!(!path.exists());

    let whole = written(&path, 4);
    let resume = |columns: &[&str], rows| {
        let before = fs::read(&path).unwrap();
        let error = Series::resume(&path, columns, rows).unwrap_err();
        assert_eq!(fs::read(&path).unwrap(), before);
        error.problem
    };
    let other = resume(&["time", "area"], 4);
    assert!(
        matches!(other, SeriesProblem::OtherColumns { .. }),
        "{other}"
    );
    let few = resume(&COLUMNS, 5);
    assert!(
        matches!(
            few,
            SeriesProblem::TooFewRows {
                found: 4,
                expected: 5
            }
        ),
        "{few}"
    );
    for (from, to, message) in [
        (
            "0.1,",
            "0.1,,",
            "line 3: 4 numbers, but there are 3 columns",
        ),
        (
            "0.1,",
            "O.1,",
            "line 3, column `time`: expected a number, found `O.1`",
        ),
        (
            "0.1,",
            "\0\0\0,",
            "line 3, column `time`: expected a number",
        ),
    ] {
        let text = String::from_utf8(whole.clone())
            .unwrap()
            .replacen(from, to, 1);
        fs::write(&path, text).unwrap();
        for problem in [
            resume(&COLUMNS, 4),
            SeriesTable::read(&path).unwrap_err().problem,
        ] {
            assert!(problem.to_string().starts_with(message), "{problem}");
        }
    }
    fs::write(&path, vec![b'1'; 2 << 20]).unwrap();
    assert!(matches!(
        resume(&COLUMNS, 0),
        SeriesProblem::NotARow { line: 1 }
    ));

    let mut series = Series::create(&path, &COLUMNS).unwrap();
    let problem = series.append(&[0.0, 1.0]).unwrap_err().problem;
    assert!(matches!(
        problem,
        SeriesProblem::WrongLength {
            line: 2,
            found: 2,
            columns: 3
        }
    ));
}
