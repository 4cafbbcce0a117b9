//! What effects ask of meshes.

use super::{generated, valid, with};
use helfrich_std::generate::generate;
use helfrich_std::info::MeshInfo;

#[test]
fn meshes_are_checked_when_they_are_known() {
    let text =
        with("volume.constraint = \"exact\"\npressure.value = 1\narea.constraint = \"exact\"");
    let file = valid(&text);
    let info = generated(&file, 0);
    file.check_mesh(0, &info).unwrap();
    let open = MeshInfo {
        volume: None,
        boundary_edges: 7,
        ..info.clone()
    };
    let message = file.check_mesh(0, &open).unwrap_err().to_string();
    assert!(
        message.contains("folder/cell.toml:8:1: `volume` needs an enclosed volume"),
        "{message}"
    );
    assert!(
        message.contains("7 boundary edges: close the mesh"),
        "{message}"
    );
    assert!(
        message.contains("folder/cell.toml:9:1: `pressure`"),
        "{message}"
    );
    let inside_out = MeshInfo {
        volume: Some(-3.0),
        ..info.clone()
    };
    let message = file.check_mesh(0, &inside_out).unwrap_err().to_string();
    assert!(message.contains("run clockwise"), "{message}");
    let isolated = MeshInfo {
        isolated_vertices: 2,
        ..info.clone()
    };
    let message = file.check_mesh(0, &isolated).unwrap_err().to_string();
    assert!(
        message.contains("2 vertices of the mesh are in no triangle"),
        "{message}"
    );
    let elastic = valid(&with(
        "bending = { method = \"B\", modulus = 1 }\nelasticity = { law = \"neo-hookean\", shear_modulus = 1 }",
    ));
    let degenerate = MeshInfo {
        degenerate_triangles: vec![7],
        ..info.clone()
    };
    let message = elastic.check_mesh(0, &degenerate).unwrap_err().to_string();
    assert!(
        message.contains("cell.toml:9:14: triangle 7 of the mesh has no area"),
        "{message}"
    );
    // More than a sphere of that area encloses.
    let text =
        with("volume = { constraint = \"exact\", target = 200 }\narea.constraint = \"exact\"");
    let file = valid(&text);
    let message = file.check_mesh(0, &info).unwrap_err().to_string();
    assert!(message.contains("cell.toml:8:10: area "), "{message}");
    assert!(
        message.contains("no surface of that area encloses more than"),
        "{message}"
    );
}

#[test]
fn families_have_the_same_triangles_on_every_shape() {
    use helfrich_std::generate::Family;
    for family in Family::ALL
        .into_iter()
        .filter(|&family| family != Family::Irregular)
    {
        let mesh = |shape: &str| {
            generate(&shape.parse().unwrap(), family, 642, 5)
                .unwrap()
                .mesh
        };
        let sphere = mesh("sphere:3");
        for shape in ["ellipsoid:1,2,0.3", "discocyte:4"] {
            assert_eq!(
                sphere.triangles(),
                mesh(shape).triangles(),
                "{family} {shape}"
            );
        }
    }
}

#[test]
fn repulsion_needs_short_edges() {
    let scene = |cutoff: f64| {
        with(&format!(
            "tension.value = 1\n[[surface]]\nmesh = \"a.ply\"\ntension.value = 1\n[[interaction]]\nkind = \"repulsion\"\nstrength = 1\ncutoff = {cutoff}"
        ))
    };
    let file = valid(&scene(0.3));
    let info = generated(&file, 0);
    let [warning] = file.mesh_warnings(0, &info).try_into().unwrap();
    let message = warning.to_string();
    assert!(
        message.starts_with("folder/cell.toml:15:10: the repulsion reaches 0.3"),
        "{message}"
    );
    assert!(valid(&scene(3.0)).mesh_warnings(0, &info).is_empty());
}

#[test]
fn references_have_the_triangles_of_their_surface() {
    let text = with(
        "elasticity = { law = \"neo-hookean\", shear_modulus = 1, reference = { mesh = \"r.ply\" } }",
    );
    let file = valid(&text);
    let mesh = |vertices| {
        let shape = "sphere".parse().unwrap();
        generate(&shape, helfrich_std::generate::Family::Smooth, vertices, 1)
            .unwrap()
            .mesh
    };
    file.check_reference(0, &mesh(642), &mesh(642)).unwrap();
    let message = file
        .check_reference(0, &mesh(642), &mesh(162))
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("cell.toml:8:68: the reference has 162 vertices"),
        "{message}"
    );
    let mut turned = mesh(642).triangles().to_vec();
    turned.swap(3, 4);
    let turned = helfrich::TriangleMesh::new(642, turned).unwrap();
    let message = file
        .check_reference(0, &mesh(642), &turned)
        .unwrap_err()
        .to_string();
    assert!(message.contains("triangle 3 of the reference"), "{message}");
}
