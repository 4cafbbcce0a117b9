//! Areas, volumes, centroids, normals and angles of known surfaces, and invalid positions.

use helfrich::{Surface, SurfaceError};
use helfrich_tests::meshes::{
    Mesh, cases, difference, disc, dot, hemisphere, icosahedron, icosphere, norm, octahedron,
    rough_closed, tetrahedron, torus,
};
use helfrich_tests::tolerance::{AREA_SUM, POLYHEDRON};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_4, PI};

/// Area, volume and angles of the Platonic solids with triangular faces in the unit sphere.
#[test]
fn platonic_solids() {
    let third = 1.0_f64 / 3.0;
    let icosahedron_edge = 1.0 / (0.4 * PI).sin();
    let of_edge = |edge: f64| edge * edge * 3.0_f64.sqrt() / 4.0;
    for (mesh, faces, edge, volume) in [
        (
            tetrahedron(),
            4.0,
            (8.0 * third).sqrt(),
            8.0 * third.sqrt() / 9.0,
        ),
        (octahedron(), 8.0, 2.0_f64.sqrt(), 4.0 * third),
        (
            icosahedron(),
            20.0,
            icosahedron_edge,
            5.0 / 12.0 * (3.0 + 5.0_f64.sqrt()) * icosahedron_edge.powi(3),
        ),
    ] {
        let surface = mesh.surface();
        let area = faces * of_edge(edge);
        POLYHEDRON.assert(surface.area(), area, area, "area");
        let found = surface.volume().expect("a closed surface has a volume");
        POLYHEDRON.assert(found, volume, volume, "volume");
        assert!(norm(surface.centroid()) < POLYHEDRON.value, "centroid");
        assert_eq!(surface.euler_characteristic(), 2);
        for triangle in 0..mesh.connectivity.triangles().len() {
            POLYHEDRON.assert(surface.triangle_area(triangle), of_edge(edge), 1.0, "face");
            for angle in surface.triangle_angles(triangle) {
                POLYHEDRON.assert(angle, FRAC_PI_3, 1.0, "angle");
            }
            let normal = surface.triangle_normal(triangle);
            POLYHEDRON.assert(norm(normal), 1.0, 1.0, "length of a normal");
            let [a, b, c] = mesh.connectivity.triangles()[triangle];
            for (from, to) in [(a, b), (b, c)] {
                let along = dot(normal, surface.difference(from, to));
                POLYHEDRON.assert(along, 0.0, 1.0, "normal along an edge");
            }
            assert!(
                dot(normal, mesh.positions[a as usize]) > 0.0,
                "normals point outward"
            );
        }
    }
}

#[test]
fn corner_of_a_cube() {
    let positions = vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 2.0]];
    let corner = Mesh::new(positions, vec![[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]]);
    let surface = corner.surface();
    assert_eq!(surface.volume(), Some(3.0));
    assert_eq!(surface.triangle_normal(0), [0.0, 0.0, -1.0]);
    assert_eq!(surface.triangle_area(0), 4.5);
    let [right, half, other] = surface.triangle_angles(0);
    assert_eq!((right, half, other), (FRAC_PI_2, FRAC_PI_4, FRAC_PI_4));
    // ∫ x dS / ∫ dS by hand; the slanted face has the area ½ |(6, 6, 9)|.
    let slanted = 0.5 * 153.0_f64.sqrt();
    let area = 4.5 + 3.0 + 3.0 + slanted;
    POLYHEDRON.assert(surface.area(), area, area, "area");
    let expected = [
        (4.5 + 3.0 + slanted) / area,
        (4.5 + 3.0 + slanted) / area,
        2.0 / 3.0 * (3.0 + 3.0 + slanted) / area,
    ];
    let distance = norm(difference(surface.centroid(), expected));
    POLYHEDRON.assert(distance, 0.0, 1.0, "centroid");
}

#[test]
fn open_surfaces_have_no_volume() {
    for mesh in [disc(2), hemisphere(2)] {
        assert_eq!(mesh.surface().volume(), None);
        assert_eq!(mesh.surface().euler_characteristic(), 1);
    }
    assert_eq!(torus(8, 6).surface().euler_characteristic(), 0);
    assert!(
        torus(8, 6)
            .surface()
            .volume()
            .is_some_and(|volume| volume > 0.0)
    );
    assert!(
        icosphere(2)
            .surface()
            .volume()
            .is_some_and(|volume| volume > 4.0)
    );
}

#[test]
fn inside_out_is_negative() {
    let mesh = icosahedron().map(|[x, y, z]| [x, y, -z]);
    assert!(mesh.surface().volume().is_some_and(|volume| volume < -2.0));
}

proptest! {
    #![proptest_config(cases(32))]

    #[test]
    fn angles_sum_to_a_half_turn_and_closed_surfaces_have_no_net_normal(rough in rough_closed()) {
        let mesh = rough.mesh();
        let surface = mesh.surface();
        let mut net = [0.0; 3];
        for triangle in 0..mesh.connectivity.triangles().len() {
            let sum = surface.triangle_angles(triangle).iter().sum::<f64>();
            POLYHEDRON.assert(sum, PI, 2.0, "sum of a triangle's angles");
            let area = surface.triangle_area(triangle);
            let normal = surface.triangle_normal(triangle);
            net = [0, 1, 2].map(|axis| net[axis] + area * normal[axis]);
        }
        AREA_SUM.assert(norm(net), 0.0, surface.area(), "Σ A n");
    }

    #[test]
    fn area_volume_and_centroid_follow_motions(rough in rough_closed()) {
        let mesh = rough.mesh();
        let shift = [3.0, -2.0, 7.0];
        let moved = mesh.map(|x| [0, 1, 2].map(|axis| 2.0 * x[axis] + shift[axis]));
        let (here, there) = (mesh.surface(), moved.surface());
        AREA_SUM.assert(there.area(), 4.0 * here.area(), here.area(), "area");
        let volume = |surface: Surface<'_, f64>| surface.volume().expect("closed");
        AREA_SUM.assert(volume(there), 8.0 * volume(here), here.area(), "volume");
        let expected = [0, 1, 2].map(|axis| 2.0 * here.centroid()[axis] + shift[axis]);
        AREA_SUM.assert(norm(difference(there.centroid(), expected)), 0.0, 1.0, "centroid");
    }
}

#[test]
fn misfits_are_refused() {
    let mesh = tetrahedron();
    let error = Surface::new(&mesh.connectivity, &mesh.positions[..3]).expect_err("one is missing");
    let expected = SurfaceError::CountMismatch {
        positions: 3,
        vertices: 4,
    };
    assert_eq!(error, expected);
    assert_eq!(
        error.to_string(),
        "3 positions were given for a mesh of 4 vertices"
    );
    for (value, axis) in [(f64::NAN, 0), (f64::INFINITY, 1), (f64::NEG_INFINITY, 2)] {
        let mut positions = mesh.positions.clone();
        positions[2][axis] = value;
        let error = Surface::new(&mesh.connectivity, &positions).expect_err("not finite");
        assert_eq!(error, SurfaceError::NotFinite { vertex: 2, axis });
        let name = ["x", "y", "z"][axis];
        let text = format!("coordinate {name} of vertex 2 is not a finite number");
        assert_eq!(error.to_string(), text);
    }
}
