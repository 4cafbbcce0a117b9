//! Files without end, disks without room, folders that take nothing, files that were cut: a message
//! and the code that goes with it, and nothing lost.

use crate::fixture::{Fixture, obj, off, ply, sheet, stl};
use crate::run::{FLOW, SCENE, command, files, run, succeed};
use crate::{fail, text};
use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// A folder with this scene.
fn folder_with(scene: &str) -> (TempDir, std::path::PathBuf) {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(&path, scene).unwrap();
    (folder, path)
}

#[cfg(unix)]
#[test]
fn files_without_end_are_refused() {
    let folder = TempDir::new().unwrap();
    let sparse = |name: &str, length: u64| {
        let path = folder.path().join(name);
        // Takes no room on the disk.
        File::create(&path).unwrap().set_len(length).unwrap();
        path
    };
    let mesh = sparse("huge.obj", 1 << 42);
    let scene = sparse("huge.toml", 1 << 30);
    let message = fail(2, &["info", text(&mesh)]);
    for hint in [text(&mesh), "4398046511104 bytes", "memory"] {
        assert!(message.contains(hint), "{message}");
    }
    let message = fail(2, &["run", text(&scene)]);
    for hint in [text(&scene), "1073741824 bytes"] {
        assert!(message.contains(hint), "{message}");
    }
    let endless = folder.path().join("endless.off");
    std::os::unix::fs::symlink("/dev/zero", &endless).unwrap();
    for arguments in [["info", text(&endless)], ["run", "/dev/zero"]] {
        let message = fail(2, &arguments);
        assert!(message.contains("on and on"), "{message}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn what_cannot_be_read_is_bad_input() {
    // Opens, and gives an error when it is read: even to those who may read all files.
    let folder = TempDir::new().unwrap();
    let unreadable = folder.path().join("unreadable.obj");
    std::os::unix::fs::symlink("/proc/self/mem", &unreadable).unwrap();
    for arguments in [["info", text(&unreadable)], ["run", text(&unreadable)]] {
        let message = fail(2, &arguments);
        assert!(message.contains("cannot be read"), "{message}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn folders_that_take_nothing_are_exit_code_3() {
    let (positions, triangles) = sheet();
    let mesh = Fixture::new("sheet.obj", obj(&positions, &triangles));
    let (_folder, scene) = folder_with(SCENE);
    // Nobody can make a file there.
    for arguments in [
        &["curvature", mesh.path(), "--csv", "/proc/out.csv"][..],
        &["subdivide", mesh.path(), "--output", "/proc/out.obj"],
        &["run", text(&scene), "--out", "/proc/out"],
        &["study", "--vertices", "12", "--json", "/proc/out.json"],
    ] {
        let message = fail(3, arguments);
        assert!(message.contains("/proc/out"), "{arguments:?}: {message}");
    }
}

/// The limit on the size of files stands for a full disk: what goes beyond is an error to write.
#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_fills_up_loses_nothing() {
    let (folder, scene) = folder_with(FLOW);
    let [whole, filled] = ["whole", "filled"].map(|name| folder.path().join(name));
    let set = ["--set", "driver.strain=2"];
    succeed(&scene, &whole, &set);
    let mut stopped = 0;
    let mut more = set.to_vec();
    // In units of 512 bytes or of 1024, as the shell has them.
    for blocks in [1, 5, 8, 10, 16] {
        let limited = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$@\"");
        let run = command(&scene, &filled, &more);
        let output = Command::new("sh")
            .args(["-c", &limited, "sh"])
            .arg(run.get_program())
            .args(run.get_args())
            .stdin(Stdio::null())
            .output()
            .unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        if output.status.code() == Some(3) {
            stopped += 1;
            assert!(message.starts_with("error: "), "{message}");
            assert!(message.contains(text(&filled)), "{message}");
        } else {
            assert_eq!(output.status.code(), Some(0), "{message}");
        }
        if filled.exists() {
            more = [&set[..], &["--resume"]].concat();
        }
    }
    assert!(stopped > 2, "{stopped} of the runs found no room");
    succeed(&scene, &filled, &more);
    assert!(files(&whole) == files(&filled));
}

#[test]
fn what_was_cut_is_not_gone_on_with() {
    let (folder, scene) = folder_with(SCENE);
    let out = folder.path().join("out");
    let set = ["--set", "driver.iterations=20"];
    assert_eq!(run(&scene, &out, &set).status.code(), Some(4));
    let before = files(&out);
    for name in ["checkpoint", "series.csv"] {
        let path = out.join(name);
        let content = fs::read(&path).unwrap();
        for length in [0, content.len() / 2] {
            fs::write(&path, &content[..length]).unwrap();
            let more = [&set[..], &["--resume"]].concat();
            let output = run(&scene, &out, &more);
            let message = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.code(), Some(2), "{name}, {length}: {message}");
            assert!(message.contains(name), "{message}");
            assert_eq!(fs::read(&path).unwrap(), content[..length], "{name}");
        }
        fs::write(&path, &content).unwrap();
    }
    assert!(files(&out) == before);
}

#[test]
fn a_byte_order_mark_is_no_word() {
    let mark = |text: String| [b"\xef\xbb\xbf", text.as_bytes()].concat();
    let (positions, triangles) = sheet();
    let plain = Fixture::new("sheet.obj", obj(&positions, &triangles));
    let area = |info: &str| {
        let line = info.lines().find(|line| line.contains("area"));
        line.unwrap().to_owned()
    };
    let expected = area(&crate::succeed(&["info", plain.path()]));
    for (name, content) in [
        ("sheet.obj", obj(&positions, &triangles)),
        ("sheet.off", off(&positions, &triangles)),
        ("sheet.ply", ply(&positions, &triangles)),
        ("sheet.stl", stl(&positions, &triangles)),
        ("sheet", off(&positions, &triangles)),
    ] {
        let file = Fixture::new(name, mark(content));
        assert_eq!(area(&crate::succeed(&["info", file.path()])), expected);
    }
    let scene = Fixture::new("scene.toml", mark(SCENE.to_owned()));
    crate::succeed(&["run", scene.path(), "--check"]);
    let wrong = Fixture::new("scene.toml", mark(SCENE.replace("modulus", "modolus")));
    let message = fail(2, &["run", wrong.path(), "--check"]);
    assert!(message.contains("scene.toml:12:1"), "{message}");
}

/// Refused before a file is written.
#[track_caller]
fn refused(scene: &str, sets: &[&str], hints: &[&str]) {
    let (folder, path) = folder_with(scene);
    let out = folder.path().join("out");
    let sets = Vec::from_iter(sets.iter().flat_map(|set| ["--set", set]));
    let output = run(&path, &out, &sets);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    for hint in hints {
        assert!(message.contains(hint), "no {hint:?} in {message}");
    }
    assert!(!out.exists());
}

#[test]
fn columns_have_different_names() {
    let probe =
        |name: &str| format!("{FLOW}\n[[output.probe]]\nname = \"{name}\"\npoint = [3, 0, 0]\n");
    refused(&probe("centroid"), &[], &["centroid_x", "another name"]);
    // The deformation of a surface called x.
    let other = "[[surface]]\nname = \"x\"\nshape = \"sphere:1\"\nvertices = 42\n\
                 position = [4, 0, 0]\nbending = { method = \"meyer\", modulus = 1 }\n[driver]";
    let scene = probe("deformation").replace("[driver]", other);
    refused(
        &scene,
        &["output.plot="],
        &["`deformation_x`", "another name"],
    );
}

#[test]
fn surfaces_start_in_each_other_as_a_whole() {
    let other = |position: &str, radius: &str| {
        let other = format!(
            "[[surface]]\nname = \"other\"\nshape = \"sphere:{radius}\"\nvertices = 42\n\
             position = {position}\nbending = {{ method = \"meyer\", modulus = 1 }}\n[driver]"
        );
        FLOW.replace("[driver]", &other)
            .replace("column = \"deformation\"", "column = \"deformation_other\"")
    };
    // As a whole: a nucleus.
    let (_folder, scene) = folder_with(&other("[0.1, 0, 0]", "0.5"));
    let check = crate::run(&["run", text(&scene), "--check"]);
    assert_eq!(check.code, Some(0), "{}", check.stderr);
    assert!(!check.stderr.contains("starts"), "{}", check.stderr);
    // Across it: worth a warning.
    let (_folder, scene) = folder_with(&other("[1, 0, 0]", "0.7"));
    let check = crate::run(&["run", text(&scene), "--check"]);
    assert_eq!(check.code, Some(0), "{}", check.stderr);
    assert!(check.stderr.contains("starts across"), "{}", check.stderr);
    // And the run says so, too.
    let (folder, scene) = folder_with(&other("[1, 0, 0]", "0.7"));
    let out = folder.path().join("out");
    let sets = [
        "surface.capsule.viscosity_ratio=1",
        "surface.capsule.membrane_viscosity=",
        "driver.strain=0.1",
    ];
    let sets = sets.map(|set| ["--set", set]);
    let output = run(&scene, &out, sets.as_flattened());
    let message = String::from_utf8(output.stderr).unwrap();
    for hint in ["\"other\" has gone into \"capsule\"", "γ̇t = 0.100"] {
        assert!(message.contains(hint), "no {hint:?} in {message}");
    }
    let (_folder, scene) = folder_with(&other("[4, 0, 0]", "0.7"));
    let check = crate::run(&["run", text(&scene), "--check"]);
    assert!(!check.stderr.contains("starts"), "{}", check.stderr);

    let obstacle = |position: &str, radius: &str| {
        format!(
            "{}\n[[obstacle]]\nname = \"ball\"\nshape = \"sphere:{radius}\"\nvertices = 162\n\
             position = {position}\n",
            crate::run::LATTICE
        )
    };
    for (position, radius, hint) in [
        ("[1.2, 0, 0]", "0.8", "starts inside the obstacle \"ball\""),
        ("[0, 0, 0]", "1.8", "starts inside the obstacle \"ball\""),
        ("[0, 0, 0]", "0.6", "the obstacle \"ball\" is inside of"),
    ] {
        refused(&obstacle(position, radius), &[], &[hint]);
    }
}

#[test]
fn a_step_beyond_stability_is_refused() {
    let bending = FLOW.replace("modulus = 0.05", "modulus = 5");
    let sets = ["driver.integrator=rk4", "driver.step=0.5"];
    refused(
        &bending,
        &sets,
        &["a step of 5e-1", "the longest that is stable"],
    );
    // The limit is named, and a little less is taken.
    let (folder, scene) = folder_with(&bending);
    let out = folder.path().join("out");
    let sets = sets.map(|set| ["--set", set]);
    let message = String::from_utf8(run(&scene, &out, sets.as_flattened()).stderr).unwrap();
    let advice = message.split("`step` of ").nth(1).unwrap();
    let step = format!("driver.step={}", advice.split_whitespace().next().unwrap());
    let sets = ["driver.integrator=rk4", &step, "driver.strain=0.05"];
    let sets = sets.map(|set| ["--set", set]);
    succeed(&scene, &out, sets.as_flattened());
}

/// The operating system lets a process run on one processor only, and it has one thread then.
#[cfg(target_os = "linux")]
#[test]
fn one_thread_or_two_leave_the_same_files() {
    let flow = FLOW.replace("strain = 2", "strain = 1");
    for scene in [&flow, crate::run::LATTICE] {
        let (folder, scene) = folder_with(scene);
        let [one, all] = ["one", "all"].map(|name| folder.path().join(name));
        succeed(&scene, &all, &[]);
        let run = command(&scene, &one, &[]);
        let status = Command::new("taskset")
            .args(["-c", "0"])
            .arg(run.get_program())
            .args(run.get_args())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .status();
        // A system without the tool, or with another first processor.
        if !status.is_ok_and(|status| status.success()) {
            assert!(!Path::new("/usr/bin/taskset").exists() || !one.exists());
            continue;
        }
        assert!(files(&one) == files(&all));
    }
}

/// Unfinished files of killed processes are removed by the next process that writes beside them.
#[test]
fn unfinished_files_do_not_stay() {
    let folder = TempDir::new().unwrap();
    let names = ["rows.json", "report.html", "cache"].map(|name| folder.path().join(name));
    let [rows, page, cache] = names.each_ref().map(|path| text(path));
    let figures = folder.path().join("figures");
    fs::create_dir(&figures).unwrap();
    let [beside, among] = [folder.path(), &figures].map(|it| it.join(".helfrich-aB12cd"));
    for path in [&beside, &among] {
        fs::write(path, "half a fi").unwrap();
    }
    let page = [
        "--html",
        page,
        "--figures",
        text(&figures),
        "--cache",
        cache,
    ];
    let arguments = [
        "study",
        "--vertices",
        "12,42",
        "--method",
        "B",
        "--scalar",
        "f64",
    ];
    crate::succeed(&[&arguments[..], &page, &["--json", rows]].concat());
    for path in [&beside, &among] {
        assert!(!path.exists(), "{}", path.display());
    }
    assert!(!folder.path().join("cache.lock").exists());
}

/// An output by the name of an input, or of another output, would be the end of it.
#[test]
fn outputs_do_not_replace_inputs() {
    let (positions, triangles) = sheet();
    let mesh = Fixture::new("sheet.obj", obj(&positions, &triangles));
    let before = fs::read(mesh.path()).unwrap();
    let other = mesh.beside("./sheet.obj");
    for output in [mesh.path(), text(&other)] {
        let message = fail(2, &["subdivide", mesh.path(), "--output", output]);
        assert!(message.contains("would replace the mesh"), "{message}");
    }
    assert_eq!(fs::read(mesh.path()).unwrap(), before);
    let both = mesh.beside("both");
    let both = text(&both);
    let message = fail(
        2,
        &["study", "--vertices", "12", "--json", both, "--html", both],
    );
    assert!(message.contains("two outputs have this name"), "{message}");
}
