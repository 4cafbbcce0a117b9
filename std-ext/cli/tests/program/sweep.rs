//! `helfrich sweep`: every combination once, whatever happens to some of them.

use crate::{Run, run, text};
use helfrich_std::series::SeriesTable;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const SCENE: &str = r#"
title = "Small capsule"
units = "none"

[[surface]]
name = "capsule"
shape = "sphere:1"
vertices = 42

[surface.elasticity]
law = "neo-hookean"
shear_modulus = 1

[surface.bending]
method = "gompper-kroll"
modulus = 0.1

[driver]
kind = "boundary-integral"
viscosity = 1
flow = { kind = "shear", rate = 0.15 }
strain = 0.4

[output]
strain_interval = 0.1
surfaces = false
pictures = false

[[output.plot]]
column = "deformation"
published = "published.csv"
"#;

struct Sweep {
    folder: TempDir,
    scene: PathBuf,
    out: PathBuf,
}

impl Sweep {
    fn new() -> Self {
        let folder = TempDir::new().unwrap();
        let scene = folder.path().join("scene.toml");
        fs::write(&scene, SCENE).unwrap();
        let published = "curve,x,y\n\"somebody, 2016\",0.3,0.09\n";
        fs::write(folder.path().join("published.csv"), published).unwrap();
        let out = folder.path().join("out");
        Self { folder, scene, out }
    }

    fn arguments<'a>(&'a self, more: &[&'a str]) -> Vec<&'a str> {
        let own = ["sweep", text(&self.scene), "--out", text(&self.out)];
        [&own, more].concat()
    }

    fn run(&self, more: &[&str]) -> Run {
        run(&self.arguments(more))
    }

    #[track_caller]
    fn ends(&self, code: i32, more: &[&str]) -> Run {
        let run = self.run(more);
        assert_eq!(run.code, Some(code), "{}{}", run.stdout, run.stderr);
        run
    }

    /// The lines of `sweep.csv`, without quotation marks.
    fn table(&self) -> Vec<Vec<String>> {
        let text = fs::read_to_string(self.out.join("sweep.csv")).unwrap();
        let cells = |line: &str| line.split(',').map(str::to_owned).collect();
        text.lines().map(cells).collect()
    }

    fn cell(&self, row: usize, column: &str) -> String {
        let table = self.table();
        let column = table[0].iter().position(|name| name == column).unwrap();
        table[row][column].clone()
    }
}

/// Every file of a folder and those below it.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            let content = fs::read(&path).unwrap();
            found.insert(path, content);
        }
    }
    found
}

const METHODS: &str = "surface.0.bending.method=gompper-kroll,meyer";
const MODULI: &str = "surface.0.bending.modulus=0.1,0.2";

#[test]
fn every_combination_is_run_as_if_alone() {
    let sweep = Sweep::new();
    let set = "driver.strain=0.3";
    let more = ["--vary", METHODS, "--vary", MODULI, "--set", set];
    let Run { stdout, stderr, .. } = sweep.ends(0, &more);
    assert_eq!(stderr, "");
    let lines = Vec::from_iter(stdout.lines());
    let heads = [
        "method",
        "modulus",
        "deformation",
        "evaluations",
        "seconds",
        "bending",
        "end",
    ];
    assert!(heads.iter().all(|head| lines[0].contains(head)), "{stdout}");
    for (at, start) in [
        "gompper-kroll  0.1",
        "gompper-kroll  0.2",
        "meyer          0.1",
    ]
    .into_iter()
    .enumerate()
    {
        assert!(lines[at + 2].starts_with(start), "{stdout}");
        assert!(lines[at + 2].ends_with("completed"), "{stdout}");
    }
    // The plot of the scene, and a folder a run.
    let folder = |name: &str| sweep.out.join(name);
    assert!(folder("deformation.png").exists());
    assert!(folder("deformation-over-modulus.png").exists());
    let own = folder("method=meyer,modulus=0.2");
    let alone = sweep.folder.path().join("alone");
    let arguments = [
        ["run", text(&sweep.scene)],
        ["--out", text(&alone)],
        ["--set", set],
        ["--set", "surface.0.bending.method=meyer"],
        ["--set", "surface.0.bending.modulus=0.2"],
    ];
    assert_eq!(run(&arguments.concat()).code, Some(0));
    let [own, alone] = [own, alone].map(|folder| folder.join("series.csv"));
    assert_eq!(fs::read(&own).unwrap(), fs::read(alone).unwrap());
    // Its last row is in the table, all digits of it.
    let series = SeriesTable::read(&own).unwrap();
    for column in ["strain", "deformation", "volume", "right_hand_sides"] {
        let last = *series.column(column).unwrap().last().unwrap();
        assert_eq!(sweep.cell(4, column).parse::<f64>().unwrap(), last);
    }
    assert_eq!(sweep.cell(4, "modulus"), "0.2");
    assert_eq!(sweep.cell(4, "end"), "completed");
    let bending: f64 = sweep.cell(4, "bending_seconds").parse().unwrap();
    assert!(bending > 0.0 && bending < 1.0);
    let evaluations: f64 = sweep.cell(4, "evaluations").parse().unwrap();
    assert!(evaluations >= *series.column("right_hand_sides").unwrap().last().unwrap());
    // Stiffer capsules are deformed less: rows and values belong together.
    let deformation = |row| sweep.cell(row, "deformation").parse::<f64>().unwrap();
    assert!(deformation(1) > deformation(2) && deformation(3) > deformation(4));
}

#[test]
fn what_cannot_be_run_is_told_and_the_rest_is_run() {
    let sweep = Sweep::new();
    let more = [
        "--vary",
        "surface.0.vertices=12,11,42",
        "--columns",
        "inclination,colour",
    ];
    let Run { stdout, stderr, .. } = sweep.ends(4, &more);
    assert!(
        stderr.contains("error: 1 of 3 runs did not complete"),
        "{stderr}"
    );
    let reason = stdout
        .lines()
        .find(|line| line.starts_with("vertices=11: "));
    assert!(
        reason.is_some_and(|line| line.contains("between 12")),
        "{stdout}"
    );
    assert!(
        stdout.contains("no run has the column `colour`: there are time, strain"),
        "{stdout}"
    );
    assert!(sweep.out.join("inclination.png").exists());
    assert_eq!(
        [1, 2, 3].map(|row| sweep.cell(row, "end")),
        ["completed", "refused", "completed"]
    );
    assert!(!sweep.out.join("vertices=11").exists());
}

#[test]
fn mistakes_in_all_runs_are_told_once_before_anything_is_written() {
    let sweep = Sweep::new();
    for (more, message) in [
        (
            ["--vary", "surface.0.bending.metod=meyer,juelicher"].as_slice(),
            "metod",
        ),
        (&["--vary", "surface.0.vertices"], "varies nothing"),
        (&["--vary", "surface.0.vertices=12,,42"], "value 2 is empty"),
        (&["--vary", MODULI, "--vary", MODULI], "varies twice"),
        (
            &["--vary", MODULI, "--set", "driver.strain"],
            "sets nothing",
        ),
        (&[], "--vary"),
    ] {
        let Run { stdout, stderr, .. } = sweep.ends(2, more);
        assert!(stdout.is_empty() && stderr.contains(message), "{stderr}");
        assert!(!sweep.out.exists());
    }
}

/// Tables and texts with commas are values as any other.
#[test]
fn values_may_be_tables() {
    let sweep = Sweep::new();
    let laws = "surface.0.elasticity={law = \"neo-hookean\", shear_modulus = 2},\
                {law = \"skalak\", shear_modulus = 1, area_ratio = 1}";
    let run = sweep.ends(0, &["--vary", laws, "--set", "driver.strain=0.1"]);
    assert_eq!(run.stdout.matches("completed").count(), 2, "{}", run.stdout);
    let text = fs::read_to_string(sweep.out.join("sweep.csv")).unwrap();
    let line = text.lines().nth(1).unwrap();
    assert!(line.starts_with("\"{law = \"\"neo-hookean\"\", shear_modulus = 2}\","));
}

#[test]
fn runs_that_have_ended_are_left_alone_and_others_added() {
    let sweep = Sweep::new();
    let first = ["--vary", "surface.0.bending.modulus=0.1"];
    sweep.ends(0, &first);
    let own = sweep.out.join("modulus=0.1");
    let before = files(&own);
    let message = sweep.ends(2, &["--vary", MODULI]).stderr;
    assert!(message.contains("--resume"), "{message}");
    sweep.ends(0, &["--vary", MODULI, "--resume"]);
    assert_eq!(files(&own), before);
    assert_eq!(
        [1, 2].map(|row| sweep.cell(row, "end")),
        ["completed", "completed"]
    );
    assert_ne!(sweep.cell(1, "deformation"), sweep.cell(2, "deformation"));
    // Of another scene than before, or of an end that is past: nothing is mixed.
    for (set, reason) in [
        ("driver.flow.rate=0.2", "of another scene"),
        ("driver.strain=0.2", "has already reached t = 2.66667"),
    ] {
        let set = ["--vary", MODULI, "--resume", "--set", set];
        let Run { stdout, .. } = sweep.ends(4, &set);
        assert_eq!(stdout.matches(reason).count(), 2, "{stdout}");
        assert_eq!(files(&own), before);
    }
    // The same scene by another name is the same.
    let scene = sweep.folder.path().join("./scene.toml");
    let arguments = ["sweep", text(&scene), "--out", text(&sweep.out), "--vary"];
    assert_eq!(
        run(&[&arguments[..], &[MODULI, "--resume"]].concat()).code,
        Some(0)
    );
    assert_eq!(files(&own), before);
    // A later end is gone on to.
    sweep.ends(
        0,
        &["--vary", MODULI, "--resume", "--set", "driver.strain=0.5"],
    );
    assert_eq!(sweep.cell(1, "strain").parse(), Ok(0.5));
    // A run that was killed before its first checkpoint begins again.
    let torn = sweep.out.join("modulus=0.3");
    fs::create_dir(&torn).unwrap();
    fs::write(torn.join("series.csv"), "time,strain\n0.0,0.0\n").unwrap();
    sweep.ends(0, &["--vary", "surface.0.bending.modulus=0.3", "--resume"]);
}

/// Two sweeps in one folder would mix their tables.
#[test]
fn a_second_sweep_in_a_folder_is_refused() {
    let sweep = Sweep::new();
    let long = ["--vary", MODULI, "--set", "surface.0.vertices=642"];
    let mut first = crate::command(&sweep.arguments(&long))
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    while !sweep.out.join("modulus=0.1/checkpoint").exists() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let message = sweep.ends(2, &[&long[..], &["--resume"]].concat()).stderr;
    let holder = format!("process {}", first.id());
    assert!(message.contains(&holder), "{message}");
    first.kill().unwrap();
    first.wait().unwrap();
    let short = ["--set", "driver.strain=0.1", "--resume"];
    sweep.ends(0, &[&long[..], &short].concat());
}

/// Whatever the order in which runs end.
#[test]
fn runs_at_once_leave_what_one_after_the_other_leaves() {
    let [alone, together] = [(); 2].map(|()| Sweep::new());
    let more = ["--vary", METHODS, "--vary", "surface.0.vertices=162,11,42"];
    alone.ends(4, &more);
    let jobs = [&more[..], &["--jobs", "3", "--threads", "5"]].concat();
    together.ends(4, &jobs);
    let untimed = |sweep: &Sweep| {
        let mut table = sweep.table();
        let is_timed = |name: &String| name.ends_with("seconds");
        let timed = Vec::from_iter(table[0].iter().map(is_timed));
        for row in &mut table {
            let mut timed = timed.iter();
            row.retain(|_| timed.next() == Some(&false));
        }
        table
    };
    assert_eq!(untimed(&alone), untimed(&together));
    assert_eq!(untimed(&alone)[0].len(), alone.table()[0].len() - 2);
    for name in [
        "method=meyer,vertices=162",
        "method=gompper-kroll,vertices=42",
    ] {
        for file in ["series.csv", "last.vtp"] {
            let [alone, together] =
                [&alone, &together].map(|sweep| fs::read(sweep.out.join(name).join(file)).unwrap());
            assert_eq!(alone, together, "{name}");
        }
    }
    let plots =
        [&alone, &together].map(|sweep| fs::read(sweep.out.join("deformation.png")).unwrap());
    assert_eq!(plots[0], plots[1]);
    // None is run twice, and what has ended is left alone.
    let before = files(&together.out);
    together.ends(4, &[&jobs[..], &["--resume"]].concat());
    assert_eq!(files(&together.out), before);
    for jobs in ["0", "1025", "many"] {
        let stderr = alone
            .ends(2, &[&more[..], &["--jobs", jobs]].concat())
            .stderr;
        assert!(stderr.contains("--jobs"), "{stderr}");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_sweep_goes_on_where_it_was() {
    let whole = Sweep::new();
    whole.ends(0, &long("2"));
    for jobs in ["1", "2"] {
        interrupt_and_resume(jobs, &whole);
    }
}

/// Arguments of a sweep that takes long enough to be interrupted.
#[cfg(unix)]
fn long(jobs: &str) -> [&str; 8] {
    [
        "--vary",
        "surface.0.bending.modulus=0.1,0.2,0.3",
        "--set",
        "surface.0.vertices=162",
        "--set",
        "driver.strain=3",
        "--jobs",
        jobs,
    ]
}

#[cfg(unix)]
fn interrupt_and_resume(jobs: &str, whole: &Sweep) {
    use std::process::{Command, Stdio};
    let stopped = Sweep::new();
    let long = long(jobs);
    let child = crate::command(&stopped.arguments(&long))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while !stopped.out.join("modulus=0.1/checkpoint").exists() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let pid = child.id().to_string();
    Command::new("kill").args(["-INT", &pid]).status().unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(
        printed.contains("interrupted") && printed.contains("waiting"),
        "{printed}"
    );
    assert!(printed.contains("--resume"), "{printed}");
    assert!(!stopped.out.join("modulus=0.3").exists());
    stopped.ends(0, &[&long[..], &["--resume"]].concat());
    for name in ["modulus=0.1", "modulus=0.2", "modulus=0.3"] {
        let series = [whole, &stopped].map(|sweep| sweep.out.join(name).join("series.csv"));
        let [whole, stopped] = series.map(|path| fs::read(path).unwrap());
        assert_eq!(whole, stopped, "{name}");
    }
}

/// Parts in one folder, also at the same time, are disjoint and make up the whole; then the whole compares what they have
/// made, and makes nothing anew.
#[test]
fn parts_make_up_the_whole() {
    let sweep = Sweep::new();
    let all = [
        "--vary",
        METHODS,
        "--vary",
        MODULI,
        "--set",
        "driver.strain=0.1",
    ];
    let part = |part: &'static str| [&all[..], &["--part", part]].concat();
    let [first, second] = std::thread::scope(|scope| {
        let (sweep, part) = (&sweep, &part);
        let jobs =
            ["1/3", "2/3"].map(|number| scope.spawn(move || sweep.ends(0, &part(number)).stdout));
        jobs.map(|job| job.join().unwrap())
    });
    let runs = |stdout: &str| stdout.matches("completed").count();
    assert_eq!([runs(&first), runs(&second)], [2, 1], "{first}{second}");
    assert!(!sweep.out.join("sweep.csv").exists());
    assert!(!sweep.out.join("deformation.png").exists());
    let before = files(&sweep.out);
    assert!(before.contains_key(&sweep.out.join("sweep-2-of-3.csv")));
    sweep.ends(0, &[&all[..], &["--resume"]].concat());
    assert_eq!(sweep.table().len(), 5);
    assert!(sweep.out.join("deformation.png").exists());
    let after = files(&sweep.out);
    let same = |(path, content): (&PathBuf, &Vec<u8>)| after.get(path) == Some(content);
    assert!(before.iter().all(same), "a run was made again");
    // More parts than combinations: nothing to do.
    let none = sweep.ends(0, &part("9/9"));
    assert_eq!(runs(&none.stdout), 0, "{}", none.stdout);
    for wrong in ["0/3", "4/3", "1", "1/0", "a/b"] {
        let refused = sweep.ends(2, &[&all[..], &["--part", wrong]].concat());
        assert!(refused.stderr.contains("3/8"), "{}", refused.stderr);
    }
    assert!(sweep.ends(2, &part("1/3")).stderr.contains("--resume"));
}
