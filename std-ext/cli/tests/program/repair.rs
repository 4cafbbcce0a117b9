//! `helfrich repair`.

use crate::fixture::{Fixture, obj, off, ply, sheet, stl};
use crate::{fail, run, succeed, text};
use helfrich_std::generate::{Family, generate};
use helfrich_std::io::{ColumnPlace, read, read_with_columns};
use helfrich_std::repair::Action;
use std::fs;
use std::path::Path;

/// A sphere of 42 vertices.
fn sphere() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let made = generate(&"sphere".parse().unwrap(), Family::Regular, 42, 1).unwrap();
    (made.positions, made.mesh.triangles().to_vec())
}

/// Every refusal because of the mesh names the command that mends it, and that command does.
#[test]
fn refused_files_are_mended_by_the_command_that_is_named() {
    let (positions, triangles) = sphere();
    let mut fin = (positions.clone(), triangles.clone());
    fin.0.push([3.0, 3.0, 3.0]);
    fin.1.push([triangles[0][0], triangles[0][1], 42]);
    let mut flipped = triangles.clone();
    for triangle in &mut flipped[..30] {
        triangle.swap(0, 1);
    }
    let mut duplicate = triangles.clone();
    duplicate.push(triangles[7]);
    let mut repeated = triangles.clone();
    repeated.push([3, 3, 4]);
    let mut touching = (positions.clone(), triangles.clone());
    let [x, _, _] = positions[0];
    touching
        .0
        .extend(positions.iter().map(|p| [2.0 * x - p[0], p[1], p[2]]));
    touching
        .1
        .extend(triangles.iter().map(|&[a, b, c]| [a + 42, c + 42, b + 42]));
    let mut unknown = (positions.clone(), triangles.clone());
    unknown.0.push([f64::NAN; 3]);
    unknown.1.push([0, 1, 42]);
    for (name, content, action) in [
        ("fin.obj", obj(&fin.0, &fin.1), Action::Edges),
        ("flipped.off", off(&positions, &flipped), Action::Reversed),
        (
            "a duplicate.ply",
            ply(&positions, &duplicate),
            Action::Duplicates,
        ),
        ("repeated.obj", obj(&positions, &repeated), Action::Repeated),
        ("touch.stl", stl(&touching.0, &touching.1), Action::BowTies),
        (
            "unknown.ply",
            ply(&unknown.0, &unknown.1),
            Action::NotFinite,
        ),
        (
            "short.off",
            off(&positions, &triangles).replace("42 80 0", "42 81 0") + "2 0 1\n",
            Action::ShortFaces,
        ),
    ] {
        let file = Fixture::new(name, content);
        let before = fs::read(file.path()).unwrap();
        let told = fail(2, &["info", file.path()]);
        let (_, command) = told.split_once("`helfrich repair ").unwrap();
        let (words, _) = command.split_once("` mends it").unwrap();
        let words = words.replace('\'', "");
        let (input, output) = words.split_once(" -o ").unwrap();
        assert_eq!((input, output), (file.path(), "OUT"));
        let mended = file.beside("mended.ply");
        let said = succeed(&["repair", input, "-o", text(&mended)]);
        assert!(
            said.contains(&format!("{}: ", action.words())),
            "{name}: {said}"
        );
        succeed(&["info", text(&mended)]);
        assert_eq!(fs::read(file.path()).unwrap(), before, "{name}");
        // The second repair finds nothing, and writes the same bytes.
        let again = file.beside("again.ply");
        let said = succeed(&["repair", text(&mended), "-o", text(&again)]);
        assert_eq!(
            said,
            format!("nothing to repair: {} is the same mesh\n", text(&again))
        );
        assert_eq!(fs::read(&again).unwrap(), fs::read(&mended).unwrap());
    }
    // Welding that leaves no mesh names the command with the distance.
    let file = Fixture::new("touch.obj", obj(&touching.0, &touching.1));
    succeed(&["info", file.path()]);
    let told = fail(2, &["info", "--weld", file.path()]);
    let expected = format!("`helfrich repair --weld=0.0 {} -o OUT`", file.path());
    assert!(told.contains(&expected), "{told}");
    let mended = file.beside("mended.obj");
    let said = succeed(&["repair", "--weld=0.0", file.path(), "-o", text(&mended)]);
    assert!(said.starts_with("nothing to repair"), "{said}");
    // STL has no numbers of vertices, so that what was split would be one again.
    let file = Fixture::new("touch.stl", stl(&touching.0, &touching.1));
    let told = fail(
        2,
        &["repair", file.path(), "-o", text(&file.beside("x.stl"))],
    );
    assert!(told.contains("choose .obj, .off, .ply or .vtp"), "{told}");
    assert_eq!(file.names(), ["touch.stl"]);
    // What no repair mends names none.
    let broken = Fixture::new("broken.obj", "v 0 0\nf 1 2 3\n");
    assert!(!fail(2, &["info", broken.path()]).contains("repair"));
    let told = fail(
        2,
        &["repair", broken.path(), "-o", text(&broken.beside("x.ply"))],
    );
    assert!(told.contains("line 1"), "{told}");
    let none = Fixture::new("none.obj", "v 0 0 0\nv 1 0 0\nf 1 2 1\n");
    let told = fail(
        2,
        &["repair", none.path(), "-o", text(&none.beside("x.ply"))],
    );
    assert!(told.contains("no triangle is left of 1"), "{told}");
    assert_eq!(none.names(), ["none.obj"]);
}

#[test]
fn a_valid_mesh_is_the_same_mesh() {
    let (positions, triangles) = sheet();
    let file = Fixture::new("sheet.ply", ply(&positions, &triangles));
    let out = file.beside("out.off");
    let said = succeed(&["repair", file.path(), "-o", text(&out)]);
    assert!(said.starts_with("nothing to repair"), "{said}");
    let [before, after] = [Path::new(file.path()), &out].map(|path| read(path).unwrap());
    assert_eq!(before, after);
    let said = succeed(&["repair", "--drop-unused", file.path(), "-o", text(&out)]);
    assert_eq!(said, "vertices in no triangle left out: 1\n");
}

#[test]
fn options_are_taken_and_checked() {
    let (positions, triangles) = sphere();
    let file = Fixture::new("holed.obj", obj(&positions, &triangles[1..]));
    let out = file.beside("out.obj");
    let said = succeed(&["repair", "--fill=3", file.path(), "-o", text(&out)]);
    assert_eq!(said, "holes filled: 1\n");
    let said = succeed(&[
        "repair",
        "--slivers=50",
        "--weld=0.01",
        file.path(),
        "-o",
        text(&out),
    ]);
    assert!(said.starts_with("nothing to repair"), "{said}");
    let reversed = Vec::from_iter(triangles.iter().map(|&[a, b, c]| [a, c, b]));
    let inward = Fixture::new("inward.obj", obj(&positions, &reversed));
    let said = succeed(&["repair", "--outward", inward.path(), "-o", text(&out)]);
    assert_eq!(said, "closed components turned that were inside out: 1\n");
    for wrong in [
        "--slivers=61",
        "--slivers=nan",
        "--weld=-1",
        "--sheets=some",
        "--fill=-1",
    ] {
        let refused = run(&["repair", wrong, file.path(), "-o", text(&out)]);
        assert_eq!(refused.code, Some(2), "{wrong}");
    }
    let told = fail(2, &["repair", file.path(), "-o", file.path()]);
    assert!(told.contains("would replace the mesh"), "{told}");
    fail(
        3,
        &[
            "repair",
            file.path(),
            "-o",
            text(&file.beside("no/folder.ply")),
        ],
    );
}

/// Numbers at vertices and faces follow them into VTP.
#[test]
fn columns_are_carried() {
    let text_of = "ply\nformat ascii 1.0\nelement vertex 5\nproperty double x\nproperty double y\nproperty double z\n\
                   property double c\nelement face 3\nproperty list uchar int vertex_indices\nproperty int n\n\
                   end_header\n0 0 0 10\n1 0 0 11\n0 1 0 12\n-1 0 0 13\n0 -1 0 14\n3 0 1 2 1\n3 0 0 1 2\n3 0 3 4 3\n";
    let file = Fixture::new("columns.ply", text_of);
    let out = file.beside("out.vtp");
    let said = succeed(&["repair", file.path(), "-o", text(&out)]);
    assert_eq!(said.lines().count(), 2, "{said}");
    let (_, columns) = read_with_columns(&out).unwrap();
    let [vertices, triangles] = [ColumnPlace::Vertices, ColumnPlace::Triangles]
        .map(|place| columns.iter().find(|column| column.place == place).unwrap());
    assert_eq!(vertices.name, "c");
    assert_eq!(vertices.values, [10.0, 11.0, 12.0, 13.0, 14.0, 10.0]);
    assert_eq!(triangles.values, [1.0, 3.0]);
    let told = run(&["repair", file.path(), "-o", text(&file.beside("out.ply"))]);
    assert!(
        told.stderr.contains("left out: the numbers c, n"),
        "{}",
        told.stderr
    );
}

/// The guide has every action with its words, in the order in which they are made.
#[test]
fn the_guide_has_every_action() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let guide = fs::read_to_string(root.join("docs/REPAIR.md")).unwrap();
    let table = guide
        .split("\n\n")
        .find(|part| part.starts_with("| action |"))
        .unwrap();
    let rows = table.lines().skip(2).map(|row| {
        let cells = Vec::from_iter(row.split('|').map(str::trim));
        (cells[1].trim_matches('`').to_owned(), cells[2].to_owned())
    });
    let actions = Action::ALL.iter();
    let actions = actions.map(|action| (action.key().to_owned(), action.words().to_owned()));
    assert_eq!(Vec::from_iter(rows), Vec::from_iter(actions));
}
