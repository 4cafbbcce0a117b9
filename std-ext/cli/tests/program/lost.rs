//! Files of the user that are in the way of an output: none is changed.

use crate::run::{SCENE, command, files, run, sparse, succeed};
use crate::{fail, text};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;
use tempfile::TempDir;

/// A folder with this scene.
fn folder_with(scene: &str) -> (TempDir, PathBuf) {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(&path, scene).unwrap();
    (folder, path)
}

/// A run that is refused before it changes anything, and its message.
#[track_caller]
fn refused(scene: &Path, out: &Path, more: &[&str]) -> String {
    let before = files(out);
    let output = run(scene, out, more);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(files(out) == before, "{message}");
    message
}

/// The text of a user in a file that has the name of a lock, now or in earlier versions, stays.
#[test]
fn a_file_of_the_user_is_no_lock() {
    let (folder, scene) = folder_with(&sparse());
    let out = folder.path().join("out");
    fs::create_dir(&out).unwrap();
    fs::write(out.join("lock"), "combination: 1234").unwrap();
    succeed(&scene, &out, &[]);
    assert_eq!(fs::read(out.join("lock")).unwrap(), b"combination: 1234");
    fs::remove_file(out.join("checkpoint")).unwrap();
    refused(&scene, &out, &["--resume"]);

    let other = folder.path().join("other");
    fs::create_dir(&other).unwrap();
    fs::write(other.join(".helfrich-lock"), "mine").unwrap();
    let message = refused(&scene, &other, &[]);
    assert!(message.contains("is no lock of this program"), "{message}");
}

/// A lock is never looked for behind a link: any file could be there.
#[cfg(unix)]
#[test]
fn links_are_no_locks() {
    use std::os::unix::fs::symlink;
    let (folder, scene) = folder_with(&sparse());
    let out = folder.path().join("out");
    fs::create_dir(&out).unwrap();
    let [precious, missing] = ["precious", "missing"].map(|name| folder.path().join(name));
    // As a lock that a killed process has left, but for the link.
    fs::write(&precious, "process 1 on another machine").unwrap();
    for target in [&precious, &missing] {
        let link = out.join(".helfrich-lock");
        symlink(target, &link).unwrap();
        let message = refused_with_link(&scene, &out);
        assert!(message.contains("is no lock of this program"), "{message}");
        fs::remove_file(link).unwrap();
    }
    let link = out.join("lock");
    symlink(&precious, &link).unwrap();
    succeed(&scene, &out, &[]);
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(
        fs::read(&precious).unwrap(),
        b"process 1 on another machine"
    );
    assert!(!missing.exists());
}

#[cfg(unix)]
fn refused_with_link(scene: &Path, out: &Path) -> String {
    let output = run(scene, out, &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        fs::symlink_metadata(out.join(".helfrich-lock"))
            .unwrap()
            .is_symlink()
    );
    String::from_utf8(output.stderr).unwrap()
}

/// The file beside a cache is not its lock.
#[test]
fn a_cache_leaves_the_files_beside_it_alone() {
    let folder = TempDir::new().unwrap();
    let [cache, beside] = ["c", "c.lock"].map(|name| folder.path().join(name));
    fs::write(&beside, "mine").unwrap();
    let study = [
        "study",
        "--method",
        "A",
        "--vertices",
        "12",
        "--family",
        "regular",
    ];
    crate::succeed(&[&study[..], &["--cache", text(&cache)]].concat());
    assert_eq!(fs::read(&beside).unwrap(), b"mine");
    let mut names = Vec::from_iter(
        fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name()),
    );
    names.sort();
    // Times that scatter, as on a busy machine, are not cached: then there is no cache.
    names.retain(|name| name != "c");
    assert_eq!(names, ["c.lock"]);
}

/// A run of its own last surface, in the folder of this surface: by name, through links, and as a reference.
#[test]
fn a_run_does_not_replace_what_its_scene_reads() {
    let (folder, scene) = folder_with(&sparse());
    let first = folder.path().join("first");
    succeed(&scene, &first, &[]);
    let here = folder.path().join("here");
    fs::create_dir(&here).unwrap();
    let mesh = here.join("last.vtp");
    fs::copy(first.join("last.vtp"), &mesh).unwrap();
    let of = |path: &str| {
        let mesh = format!("surface.vesicle.mesh={path}");
        let sets = ["surface.vesicle.shape=", "surface.vesicle.vertices=", &mesh];
        Vec::from_iter(
            sets.iter()
                .flat_map(|set| ["--set".to_owned(), (*set).to_owned()]),
        )
    };
    let refuses = |path: &str| {
        let more = of(path);
        let more = Vec::from_iter(more.iter().map(String::as_str));
        let message = refused(&scene, &here, &more);
        for hint in ["last.vtp", "which the scene reads", "--out"] {
            assert!(message.contains(hint), "no {hint} in {message}");
        }
    };
    refuses("here/last.vtp");
    refuses("here/../here/./last.vtp");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("here/last.vtp", folder.path().join("link.vtp")).unwrap();
        refuses("link.vtp");
        fs::hard_link(&mesh, folder.path().join("other.vtp")).unwrap();
        refuses("other.vtp");
    }
    // Without the run's name for it the mesh is no obstacle.
    fs::rename(&mesh, here.join("start.vtp")).unwrap();
    let more = of("here/start.vtp");
    run(
        &scene,
        &here,
        &Vec::from_iter(more.iter().map(String::as_str)),
    );
    assert!(here.join("summary.json").exists());
}

/// Files of others that have the names of a run's are kept, whatever they are.
#[test]
fn a_new_run_replaces_nothing() {
    let (folder, scene) = folder_with(SCENE);
    let out = folder.path().join("out");
    for name in [
        "summary.json",
        "series.csv",
        "modes.csv",
        "rheology.csv",
        "profiles.csv",
        "surfaces.pvd",
        "last.vtp",
        "surfaces/mine.vtp",
        "pictures/00000000.png",
    ] {
        let path = out.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, "{\"name\": \"mine\"}").unwrap();
        let message = refused(&scene, &out, &[]);
        assert!(message.contains("--out"), "{message}");
        assert_eq!(fs::read(&path).unwrap(), b"{\"name\": \"mine\"}");
        fs::remove_dir_all(&out).unwrap();
    }
    // A table of somebody else, where a run may have been stopped at its beginning.
    fs::create_dir(&out).unwrap();
    fs::write(out.join("series.csv"), "name,value\n").unwrap();
    refused(&scene, &out, &["--resume"]);
    // The user's own files do no harm.
    fs::remove_dir_all(&out).unwrap();
    fs::create_dir_all(out.join("surfaces")).unwrap();
    fs::write(out.join("notes.txt"), "mine").unwrap();
    run(&scene, &out, &["--set", "driver.iterations=1"]);
    assert!(out.join("series.csv").exists());
}

#[test]
fn a_sweep_replaces_nothing() {
    let (folder, scene) = folder_with(SCENE);
    let out = folder.path().join("out");
    fs::create_dir(&out).unwrap();
    for name in ["sweep.csv", "energy.png"] {
        fs::write(out.join(name), "mine").unwrap();
        let message = fail(
            2,
            &[
                "sweep",
                text(&scene),
                "--vary",
                "driver.iterations=1,2",
                "--columns",
                "energy",
                "--out",
                text(&out),
            ],
        );
        assert!(
            message.contains(name) && message.contains("--out"),
            "{message}"
        );
        assert_eq!(fs::read(out.join(name)).unwrap(), b"mine");
        fs::remove_file(out.join(name)).unwrap();
    }
}

/// Outputs by two names for one file, and over the mesh through links.
#[cfg(unix)]
#[test]
fn outputs_over_each_other_and_over_the_mesh_are_refused() {
    use crate::fixture::{Fixture, obj, sheet};
    let (positions, triangles) = sheet();
    let file = Fixture::new("sheet.obj", obj(&positions, &triangles));
    let mesh = fs::read(file.path()).unwrap();
    let [hard, soft] = ["hard.obj", "soft.obj"].map(|name| file.beside(name));
    fs::hard_link(file.path(), &hard).unwrap();
    std::os::unix::fs::symlink(file.path(), &soft).unwrap();
    for out in [text(&hard), text(&soft), file.path()] {
        for arguments in [
            ["curvature", file.path(), "--csv", out],
            ["curvature", file.path(), "--vtp", out],
            ["subdivide", file.path(), "-o", out],
            ["recommend", file.path(), "--json", out],
        ] {
            let message = fail(2, &arguments);
            assert!(message.contains("would replace the mesh"), "{message}");
            assert_eq!(fs::read(file.path()).unwrap(), mesh);
        }
    }
    let folder = Path::new(file.path()).parent().unwrap();
    let [one, other] = ["x.csv", "./x.csv"].map(|name| folder.join(name));
    let twice = [
        "curvature",
        file.path(),
        "--csv",
        text(&one),
        "--vtp",
        text(&other),
    ];
    let message = fail(2, &twice);
    assert!(message.contains("two outputs have this name"), "{message}");
}

/// The folders of a run that are removed again and again are made again.
#[test]
fn folders_may_go_under_a_run() {
    let (folder, scene) = folder_with(SCENE);
    let out = folder.path().join("out");
    let sets = [
        "surface.vesicle.vertices=2562",
        "driver.iterations=12",
        "output.every=1",
        "output.pictures=false",
    ];
    let sets = sets.map(|set| ["--set", set]);
    let mut child = command(&scene, &out, sets.as_flattened())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while child.try_wait().unwrap().is_none() {
        let _ = fs::remove_dir_all(out.join("surfaces"));
        sleep(Duration::from_millis(30));
    }
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(4), "{said}");
    assert!(out.join("summary.json").exists());
}

/// A name that no file can have is refused before anything is written.
#[test]
fn names_may_not_be_endless() {
    let (folder, scene) = folder_with(SCENE);
    let long = "n".repeat(5000);
    let message = fail(
        2,
        &[
            "run",
            text(&scene),
            "--out",
            text(&folder.path().join("long")),
            "--set",
            &format!("surface.vesicle.name={long}"),
        ],
    );
    assert!(
        message.contains("a name of 5000 letters"),
        "{}",
        &message[message.len() - 300..]
    );
    assert!(
        message.contains("100 characters at most"),
        "{}",
        &message[message.len() - 300..]
    );
    assert!(!folder.path().join("long").exists());
}

/// Messages about a stranger's scene do not show the files that it names.
#[test]
fn messages_do_not_quote_the_files_of_a_scene() {
    let folder = TempDir::new().unwrap();
    let secret = folder.path().join("secret.obj");
    fs::write(&secret, "$hunter2 is the password\n").unwrap();
    let curves = folder.path().join("secret.csv");
    fs::write(&curves, "hunter2,is,the,password\n").unwrap();
    let scene = folder.path().join("scene.toml");
    let plot = "[[output.plot]]\ncolumn = \"energy\"\npublished = \"secret.csv\"\n";
    let elasticity = "surface.vesicle.elasticity={law=\"neo-hookean\",shear_modulus=1,\
                      reference={mesh=\"secret.obj\"}}";
    let mesh = [
        "surface.vesicle.shape=",
        "surface.vesicle.vertices=",
        "surface.vesicle.mesh=secret.obj",
    ];
    for (more, sets, name) in [
        ("", &mesh[..], "secret.obj"),
        (plot, &[], "secret.csv"),
        ("", &[elasticity], "secret.obj"),
    ] {
        fs::write(&scene, format!("{SCENE}\n{more}")).unwrap();
        let sets = Vec::from_iter(sets.iter().flat_map(|set| ["--set", set]));
        let out = folder.path().join("out");
        let run = ["run", text(&scene), "--out", text(&out)];
        let message = fail(2, &[&run[..], &sets].concat());
        assert!(
            message.contains(name) && message.contains("line 1"),
            "{message}"
        );
        assert!(!message.contains("hunter2"), "{message}");
    }
    // About a file that the user has named, they say more.
    let message = fail(2, &["info", text(&secret)]);
    assert!(message.contains("hunter2"), "{message}");
}
