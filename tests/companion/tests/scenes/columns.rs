//! Parameters that vary from vertex to vertex, read from columns of mesh files.

use helfrich_std::dynamics::Problem;
use helfrich_std::info::MeshInfo;
use helfrich_std::io::{
    PointField, PointValues, read_with_columns, write, write_vtp, write_vtp_with_cells,
};
use helfrich_std::method::BendingMethod;
use helfrich_std::run::run;
use helfrich_std::scene::{Overrides, SceneErrors, SceneFile};
use helfrich_std::simulation::build;
use helfrich_tests::meshes::{Mesh, difference, icosphere, norm};
use tempfile::TempDir;

/// Sphere with columns, in a folder of its own.
struct Files {
    folder: TempDir,
    mesh: Mesh,
}

impl Files {
    /// Writes these columns: `equal` is 2 everywhere, `jump` 1 below and 4 above, `H0` the height, `zero` 0
    /// at vertex 7, and `wrong` NaN there.
    fn new() -> Self {
        let folder = TempDir::new().unwrap();
        let mesh = icosphere(2);
        let of = |value: &dyn Fn(usize, [f64; 3]) -> f64| {
            let positions = mesh.positions.iter().enumerate();
            Vec::from_iter(positions.map(|(vertex, &x)| value(vertex, x)))
        };
        let columns = [
            ("equal", of(&|_, _| 2.0)),
            ("jump", of(&|_, x| if x[2] > 0.0 { 4.0 } else { 1.0 })),
            ("H0", of(&|_, x| x[2])),
            ("zero", of(&|vertex, _| if vertex == 7 { 0.0 } else { 1.0 })),
            (
                "wrong",
                of(&|vertex, _| if vertex == 7 { f64::NAN } else { 1.0 }),
            ),
        ];
        let fields = Vec::from_iter(columns.iter().map(|(name, values)| PointField {
            name,
            values: PointValues::Scalars(values),
        }));
        let path = folder.path().join("sphere.vtp");
        write_vtp(&path, &mesh.connectivity, &mesh.positions, None, &fields).unwrap();
        let path = folder.path().join("sphere.off");
        write(&path, &mesh.positions, &mesh.connectivity).unwrap();
        Self { folder, mesh }
    }

    /// Scene with these keys of the surface and of its bending.
    fn scene(&self, surface: &str, bending: &str) -> Result<SceneFile, SceneErrors> {
        let text = format!(
            "units = \"none\"\n[driver]\nkind = \"relax\"\n[[surface]]\n{surface}\nlocal_area.modulus \
             = 1\n[surface.bending]\n{bending}\n"
        );
        let path = self.folder.path().join("scene.toml");
        SceneFile::parse(&text, &path, &Overrides::default())
    }

    fn refused(&self, surface: &str, bending: &str, parts: &[&str]) {
        let message = self.scene(surface, bending).unwrap_err().to_string();
        for part in parts {
            assert!(message.contains(part), "{part}: {message}");
        }
    }
}

const MESH: &str = "mesh = \"sphere.vtp\"";

/// Energy and forces of a scene at its start, on the sphere stretched along x.
fn evaluated(file: &SceneFile) -> (f64, Vec<[f64; 3]>) {
    let (mut simulation, mut positions) = build(file).unwrap();
    for position in &mut positions {
        position[0] *= 1.2;
    }
    let mut force = vec![[0.0; 3]; positions.len()];
    let evaluation = simulation.evaluate(&positions, &mut force);
    (evaluation.energy, force)
}

/// A column of equal numbers gives the same bits as the number, with every method that accepts columns; a
/// column of other numbers does not.
#[test]
fn a_column_of_equal_numbers_is_the_number() {
    let files = Files::new();
    let methods = BendingMethod::ALL.into_iter();
    for method in methods.filter(|&method| method != BendingMethod::KantorNelson) {
        let with = |modulus: &str, curvature: &str| {
            let bending = format!(
                "method = \"{method}\"\nmodulus = {modulus}\nspontaneous_curvature = {curvature}"
            );
            let file = files.scene(MESH, &bending);
            evaluated(&file.unwrap_or_else(|errors| panic!("{errors}")))
        };
        let equal = "{ column = \"equal\" }";
        let number = with("2", "2");
        assert_eq!(with(equal, equal), number, "{method}");
        assert_ne!(with("{ column = \"jump\" }", "2"), number, "{method}");
        assert_ne!(with("2", "{ column = \"H0\" }"), number, "{method}");
    }
}

#[test]
fn unusable_columns_are_refused() {
    let files = Files::new();
    let column = |name: &str| format!("method = \"B\"\nmodulus = {{ column = \"{name}\" }}");
    let bending = column("kapa");
    let known = "\"equal\", \"jump\", \"H0\", \"zero\", \"wrong\"";
    files.refused(
        MESH,
        &bending,
        &[
            "scene.toml:9:",
            "sphere.vtp has no column \"kapa\" of single numbers: it has ",
            known,
        ],
    );
    files.refused(
        "mesh = \"sphere.off\"",
        &bending,
        &["it has none; .ply, .vtp, .vtu, .vtk, .msh and .gii files may have columns"],
    );
    files.refused(
        "mesh = \"missing.vtp\"",
        &bending,
        &["missing.vtp: there is no such file"],
    );
    files.refused(
        "shape = \"sphere:1\"\nvertices = 42",
        &bending,
        &["the mesh of the surface is generated, and has no column \"kapa\""],
    );
    files.refused(
        "mesh = \"sphere.vtp\"\nweld = true",
        &column("jump"),
        &["`weld` merges vertices"],
    );
    files.refused(
        MESH,
        &column("zero"),
        &["the column \"zero\" is 0 at vertex 7: `modulus` has to be a finite number above 0"],
    );
    files.refused(
        MESH,
        "method = \"B\"\nmodulus = 1\nspontaneous_curvature = { column = \"wrong\" }",
        &["the column \"wrong\" is NaN at vertex 7"],
    );
    files.refused(
        MESH,
        &column("jump").replace("\"B\"", "\"A\""),
        &["method kantor-nelson (A) has one modulus for all edges"],
    );
    files.refused(
        MESH,
        "method = \"B\"\nmodulus = { colum = \"jump\" }",
        &["no key `colum` in `surface.0.bending.modulus`"],
    );
}

/// The explanation shows the range of a column; varying numbers form no dimensionless group.
#[test]
fn columns_are_explained() {
    let files = Files::new();
    let bending = "method = \"B\"\nmodulus = { column = \"jump\" }\nspontaneous_curvature = 1";
    let file = files.scene(MESH, bending).unwrap();
    let info = MeshInfo::new(files.mesh.surface());
    let text = file.scene.explain(&[info]).to_string();
    assert!(
        text.contains("modulus from 1 to 4 by column \"jump\""),
        "{text}"
    );
    assert!(text.contains("c0 R = 2 H0 R"), "{text}");
    assert!(!text.contains("k R²/κ"), "{text}");
    assert!(file.warnings.is_empty(), "{:?}", file.warnings);
}

/// Domains: the energies of their effects at the start, the explanation, and refused columns.
#[test]
fn domains_have_borders() {
    let files = Files::new();
    let tension = |domains: &str| {
        format!("{MESH}\nborder_tension = {{ value = 2, domains = {{ column = \"{domains}\" }} }}")
    };
    let bending = "method = \"B\"\nmodulus = 1";
    let file = files.scene(&tension("jump"), bending).unwrap();
    let (mut simulation, positions) = build(&file).unwrap();
    let acting = simulation.resolve(&positions);
    let acting = acting
        .iter()
        .find(|acting| acting.effect == "border_tension");
    let length = acting.expect("a border").energy / 2.0;
    // The border runs in a zigzag along the equator.
    let turn = 2.0 * std::f64::consts::PI;
    assert!(length > turn && length < 1.25 * turn, "{length}");
    let info = MeshInfo::new(files.mesh.surface());
    let text = file.scene.explain(&[info]).to_string();
    assert!(
        text.contains("2 domains") && text.contains("Λ R/κ"),
        "{text}"
    );
    files.refused(
        &tension("equal"),
        bending,
        &["the column \"equal\" is 2 everywhere, and one domain has no border"],
    );
    files.refused(
        &tension("H0"),
        bending,
        &["the label of a domain has to be a whole number"],
    );
    files.refused(
        &tension("wrong"),
        bending,
        &["the column \"wrong\" is NaN at vertex 7: `domains` has to be a finite number"],
    );
}

/// With labels of faces, the border consists exactly of the edges between them. A modulus of faces is
/// averaged around each vertex. Both columns are in the last file of a run.
#[test]
fn faces_have_columns() {
    let files = Files::new();
    let (mesh, positions) = (&files.mesh.connectivity, &files.mesh.positions);
    let is_above = |corners: &[u32; 3]| {
        corners
            .iter()
            .all(|&vertex| positions[vertex as usize][2] > 0.4)
    };
    let triangles = mesh.triangles().iter();
    let labels = Vec::from_iter(triangles.map(|corners| if is_above(corners) { 3.0 } else { 1.0 }));
    let equal = vec![2.0; labels.len()];
    let field = |name, values| PointField {
        name,
        values: PointValues::Scalars(values),
    };
    let cells = [field("part", &labels), field("equal", &equal)];
    let path = files.folder.path().join("sphere.vtp");
    write_vtp_with_cells(&path, mesh, positions, None, &[], &cells).unwrap();
    let keys = "border_tension = { value = 2, domains = { column = \"part\" } }";
    let bending = |modulus: &str| format!("method = \"B\"\nmodulus = {{ column = \"{modulus}\" }}");
    let file = files.scene(&format!("{MESH}\n{keys}"), &bending("part"));
    let file = file.unwrap_or_else(|errors| panic!("{errors}"));
    let (mut simulation, start) = build(&file).unwrap();
    let found = simulation.resolve(&start);
    let mut length = 0.0;
    for (edge, &[a, b]) in mesh.edges().iter().enumerate() {
        let (left, right) = mesh.edge_triangles(edge);
        if labels[left as usize] != labels[right.unwrap() as usize] {
            length += norm(difference(positions[a as usize], positions[b as usize]));
        }
    }
    let mut found = found.iter();
    let border = found.find(|acting| acting.effect == "border_tension");
    let border = border.expect("a border").energy;
    assert!(
        (border / (2.0 * length) - 1.0).abs() < 1e-12,
        "{border} {length}"
    );
    let out = files.folder.path().join("out");
    let built = build(&file).unwrap();
    run(&file.scene, built, &out, false, &|| true, &mut |_| {}).unwrap();
    let (_, columns) = read_with_columns(&out.join("last.vtp")).unwrap();
    assert_eq!(columns.len(), 2);
    assert_eq!(columns[1].values, labels);
    let means = &columns[0].values;
    assert!(means.contains(&1.0) && means.contains(&3.0));
    assert!(means.iter().any(|mean| *mean > 1.0 && *mean < 3.0));

    let file = files.scene(MESH, "method = \"B\"\nmodulus = 2").unwrap();
    let expected = evaluated(&file);
    let file = files.scene(MESH, &bending("equal")).unwrap();
    assert_eq!(evaluated(&file), expected);
}

/// On a closed surface, a Gaussian modulus has an effect only if it varies.
#[test]
fn gaussian_moduli_have_columns() {
    let files = Files::new();
    let with = |gaussian: &str| {
        let surface = format!("{MESH}\ngaussian_bending.modulus = {gaussian}");
        let file = files.scene(&surface, "method = \"B\"\nmodulus = 5");
        let file = file.unwrap_or_else(|errors| panic!("{errors}"));
        let (simulation, _) = build(&file).unwrap();
        let warnings = simulation.warnings().iter().map(ToString::to_string);
        let idle = "`gaussian_bending` does nothing";
        (
            evaluated(&file),
            warnings.filter(|text| text.contains(idle)).count(),
        )
    };
    let number = with("2");
    assert_eq!(with("{ column = \"equal\" }"), number);
    assert_eq!(number.1, 1);
    let (results, idle) = with("{ column = \"jump\" }");
    assert_ne!(results, number.0);
    assert_eq!(idle, 0);
}

/// If nothing preserves local areas, one part grows at the cost of the other, and a warning says so.
#[test]
fn parts_whose_area_nothing_holds_are_doubted() {
    let files = Files::new();
    let bending = "method = \"B\"\nmodulus = { column = \"jump\" }";
    let text = format!(
        "units = \"none\"\n[driver]\nkind = \"relax\"\n[[surface]]\n{MESH}\n[surface.bending]\n{bending}\n"
    );
    let path = files.folder.path().join("scene.toml");
    let file = SceneFile::parse(&text, &path, &Overrides::default()).unwrap();
    let [warning] = file.warnings.as_slice() else {
        panic!("{:?}", file.warnings);
    };
    assert!(
        warning
            .to_string()
            .contains("add `elasticity` or `local_area`"),
        "{warning}"
    );
}
