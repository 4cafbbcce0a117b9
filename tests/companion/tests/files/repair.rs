//! Meshes made of triangles that are none.

use helfrich::{MeshError, Surface, TriangleMesh, VertexKind};
use helfrich_std::generate::{Family, generate};
use helfrich_std::io::{Column, ColumnPlace, Format, parse, parse_soup};
use helfrich_std::repair::{
    Action, NEW, RepairError, RepairSettings, Repaired, Sheets, Soup, repair,
};
use helfrich_tests::meshes::{
    Mesh, SplitMix64, cases, cross, cubes, difference, disc, icosphere, norm, sheet, torus,
};
use proptest::prelude::*;
use std::f64::consts::TAU;

fn soup(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Soup {
    Soup {
        positions,
        triangles,
        short_faces: 0,
    }
}

fn soup_of(mesh: &Mesh) -> Soup {
    let triangles = mesh.connectivity.triangles().to_vec();
    soup(mesh.positions.clone(), triangles)
}

/// Triangles of meshes that touch or share nothing, one after the other.
fn together(meshes: &[&Mesh]) -> Soup {
    let mut all = soup(Vec::new(), Vec::new());
    for mesh in meshes {
        let first = all.positions.len() as u32;
        all.positions.extend(&mesh.positions);
        let triangles = mesh.connectivity.triangles().iter();
        all.triangles
            .extend(triangles.map(|triangle| triangle.map(|vertex| vertex + first)));
    }
    all
}

const WELDED: RepairSettings = RepairSettings {
    weld: Some(0.0),
    sheets: Sheets::Split,
    fill: 0,
    slivers: 0.0,
    outward: false,
    drop_unused: false,
};

#[track_caller]
fn mend(soup: &Soup, settings: &RepairSettings) -> Repaired {
    repair(soup.clone(), settings).expect("triangles are left")
}

/// The actions of a repair with default settings.
#[track_caller]
fn taken(soup: &Soup) -> Vec<(Action, usize)> {
    mend(soup, &RepairSettings::default())
        .report
        .taken()
        .collect()
}

fn again(repaired: &Repaired) -> Soup {
    let triangles = repaired.file.mesh.triangles().to_vec();
    soup(repaired.file.positions.clone(), triangles)
}

fn bits(positions: &[[f64; 3]]) -> Vec<[u64; 3]> {
    positions.iter().map(|x| x.map(f64::to_bits)).collect()
}

fn area(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> f64 {
    let areas = triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
        norm(cross(difference(b, a), difference(c, a))) / 2.0
    });
    areas.sum()
}

/// Meshes with and without a border, of one component and of several, with a vertex that no triangle has.
fn valid() -> Vec<Soup> {
    let sphere = icosphere(2);
    let mut lonely = together(&[&sphere, &disc(3)]);
    lonely.positions.insert(0, [7.0, -0.0, 1e-300]);
    for corner in lonely.triangles.as_flattened_mut() {
        *corner += 1;
    }
    let mut inside_out = soup_of(&sphere);
    for triangle in &mut inside_out.triangles {
        triangle.swap(0, 1);
    }
    let apart = sphere.beside(&torus(12, 8), [9.0, 0.0, 0.0]);
    let all = [
        soup_of(&sphere),
        soup_of(&torus(12, 8)),
        soup_of(&sheet(5)),
        soup_of(&apart),
    ];
    all.into_iter().chain([lonely, inside_out]).collect()
}

#[test]
fn valid_meshes_keep_every_bit() {
    for whole in valid() {
        for settings in [RepairSettings::default(), WELDED] {
            let found = mend(&whole, &settings);
            assert!(found.report.is_empty(), "{}", found.report);
            assert_eq!(bits(&found.file.positions), bits(&whole.positions));
            assert_eq!(found.file.mesh.triangles(), whole.triangles);
            let all = Vec::from_iter(0..whole.positions.len() as u32);
            assert_eq!(found.vertex_of, all);
            let all = Vec::from_iter(0..whole.triangles.len() as u32);
            assert_eq!(found.triangle_of, all);
        }
    }
}

/// Triangles that were reversed at random, on surfaces with and without a border.
#[test]
fn reversed_triangles_are_turned_back() {
    let mut random = SplitMix64::new(3);
    for whole in valid() {
        let mut reversed = 0;
        let mut wrong = whole.clone();
        for triangle in &mut wrong.triangles {
            if random.below(3) == 0 {
                triangle.swap(1, 2);
                reversed += 1;
            }
        }
        let found = mend(&wrong, &RepairSettings::default());
        assert_eq!(bits(&found.file.positions), bits(&whole.positions));
        let volume = Surface::new(&found.file.mesh, &found.file.positions)
            .unwrap()
            .volume();
        if found.report.count(Action::Reversed) == reversed {
            assert_eq!(found.file.mesh.triangles(), whole.triangles);
        } else {
            // The sphere that is inside out: a closed component that is changed is turned outwards.
            assert_eq!(
                found.report.count(Action::Reversed),
                whole.triangles.len() - reversed
            );
            assert!(volume.unwrap() > 0.0);
        }
        let taken = Vec::from_iter(found.report.taken().map(|(action, _)| action));
        assert_eq!(taken, [Action::Reversed]);
    }
}

/// Half of a sphere is as much as the other half: its volume decides, but not that of a cavity.
#[test]
fn changed_components_are_turned_outwards_unless_they_bound_a_cavity() {
    let sphere = icosphere(2);
    let mut half = soup_of(&sphere);
    let count = half.triangles.len();
    for triangle in &mut half.triangles[..count / 2 + 20] {
        triangle.swap(1, 2);
    }
    let found = mend(&half, &RepairSettings::default());
    assert_eq!(found.file.mesh.triangles(), sphere.connectivity.triangles());
    assert_eq!(found.report.count(Action::Reversed), count / 2 + 20);

    // Turned on request, unless they bound a cavity.
    let small = sphere.map(|x| x.map(|x| 0.5 * x));
    let mut shell = together(&[&sphere, &small]);
    for triangle in &mut shell.triangles[count..] {
        triangle.swap(1, 2);
    }
    let outward = RepairSettings {
        outward: true,
        ..RepairSettings::default()
    };
    assert!(mend(&shell, &outward).report.is_empty());
    shell.triangles.truncate(count);
    for triangle in &mut shell.triangles {
        triangle.swap(1, 2);
    }
    assert_eq!(taken(&shell), []);
    let found = mend(&shell, &outward).report;
    assert_eq!(Vec::from_iter(found.taken()), [(Action::Turned, 1)]);
}

#[test]
fn each_action_is_counted() {
    let sphere = icosphere(1);
    let whole = soup_of(&sphere);
    let vertices = whole.positions.len() as u32;
    let with = |change: &dyn Fn(&mut Soup)| {
        let mut soup = whole.clone();
        change(&mut soup);
        soup
    };
    let short = with(&|soup| soup.short_faces = 2);
    assert_eq!(taken(&short), [(Action::ShortFaces, 2)]);
    let unknown = with(&|soup| {
        soup.positions.extend([[f64::NAN; 3], [f64::INFINITY; 3]]);
        soup.triangles.push([0, 1, vertices]);
    });
    let expected = [(Action::NotFinite, 1), (Action::Unused, 2)];
    assert_eq!(taken(&unknown), expected);
    let repeated = with(&|soup| soup.triangles.extend([[3, 3, 4], [5, 6, 5], [7, 7, 7]]));
    assert_eq!(taken(&repeated), [(Action::Repeated, 3)]);
    let duplicates = with(&|soup| {
        let [[a, b, c], [d, e, f]] = [soup.triangles[4], soup.triangles[9]];
        soup.triangles.extend([[b, c, a], [d, f, e]]);
    });
    assert_eq!(taken(&duplicates), [(Action::Duplicates, 2)]);
    // The fewer are reversed, also if the first is among them.
    let flat = soup_of(&sheet(3));
    let mut reversed = flat.clone();
    reversed.triangles[0].swap(1, 2);
    let found = mend(&reversed, &RepairSettings::default());
    assert_eq!(
        Vec::from_iter(found.report.taken()),
        [(Action::Reversed, 1)]
    );
    assert_eq!(found.file.mesh.triangles(), flat.triangles);
    // A fin on an edge.
    let fin = with(&|soup| {
        let [a, b, _] = soup.triangles[0];
        soup.positions.push([3.0, 3.0, 3.0]);
        soup.triangles.push([a, b, vertices]);
    });
    let found = mend(&fin, &RepairSettings::default());
    assert_eq!(Vec::from_iter(found.report.taken()), [(Action::Edges, 1)]);
    assert_eq!(found.file.mesh.components().1, 2);
    let largest = RepairSettings {
        sheets: Sheets::Largest,
        ..RepairSettings::default()
    };
    let found = mend(&fin, &largest);
    let expected = [(Action::SmallSheets, 1), (Action::Unused, 1)];
    assert_eq!(Vec::from_iter(found.report.taken()), expected);
    assert_eq!(found.file.mesh, sphere.connectivity);
    // Another sphere that has a vertex of the first.
    let mut touch = with(&|soup| {
        let other = sphere
            .positions
            .iter()
            .map(|x| [2.0 * sphere.positions[0][0] - x[0], x[1], x[2]]);
        soup.positions.extend(other);
        let others = sphere.connectivity.triangles().iter();
        let name = |vertex: u32| if vertex == 0 { 0 } else { vertex + vertices };
        soup.triangles
            .extend(others.map(|&[a, b, c]| [a, c, b].map(name)));
        soup.positions.swap_remove(vertices as usize);
    });
    let last = touch.positions.len() as u32;
    for corner in touch.triangles.as_flattened_mut() {
        if *corner == last {
            *corner = vertices;
        }
    }
    let found = mend(&touch, &RepairSettings::default());
    assert_eq!(Vec::from_iter(found.report.taken()), [(Action::BowTies, 1)]);
    assert_eq!(found.file.positions.len(), 2 * vertices as usize);
    assert_eq!(found.vertex_of.last(), Some(&0));
    // A vertex for each corner.
    let corners = sphere.connectivity.triangles().as_flattened();
    let apart = corners
        .iter()
        .map(|&vertex| sphere.positions[vertex as usize]);
    let apart = Vec::from_iter(apart);
    let own = Vec::from_iter((0..apart.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]));
    let merged = corners.len() - sphere.positions.len();
    let apart = soup(apart, own);
    assert_eq!(taken(&apart), []);
    let found = mend(&apart, &WELDED);
    assert_eq!(
        Vec::from_iter(found.report.taken()),
        [(Action::Merged, merged)]
    );
    assert!(found.file.mesh.is_closed());
    // A vertex of the input that no triangle has.
    let unused = with(&|soup| soup.positions.push([9.0; 3]));
    assert_eq!(taken(&unused), []);
    let drop_unused = RepairSettings {
        drop_unused: true,
        ..RepairSettings::default()
    };
    let found = mend(&unused, &drop_unused);
    assert_eq!(Vec::from_iter(found.report.taken()), [(Action::Unused, 1)]);
    assert_eq!(found.file.positions, sphere.positions);
}

/// A strip of triangles with a half turn.
fn moebius(pieces: u32) -> Soup {
    let place = |row: u32| {
        let angle = TAU * f64::from(row) / f64::from(pieces);
        [-1.0, 1.0].map(|side| {
            let [out, up] = [3.0 + side * (angle / 2.0).cos(), side * (angle / 2.0).sin()];
            [out * angle.cos(), out * angle.sin(), up]
        })
    };
    let positions = (0..pieces).flat_map(place).collect();
    let triangles = (0..pieces).flat_map(|row| {
        let [a, b] = [2 * row, 2 * row + 1];
        let [c, d] = if row + 1 == pieces {
            [1, 0]
        } else {
            [a + 2, b + 2]
        };
        [[a, c, b], [b, c, d]]
    });
    soup(positions, triangles.collect())
}

#[test]
fn surfaces_with_one_side_are_cut_across() {
    let strip = moebius(20);
    let found = mend(&strip, &RepairSettings::default());
    assert_eq!(found.report.count(Action::Cut), 1);
    assert_eq!(found.file.mesh.components().1, 1);
    assert_eq!(found.file.mesh.euler_characteristic(), 1);
    assert_eq!(found.file.mesh.triangles().len(), strip.triangles.len());
    // Welding puts the ends together again, and the same cut takes them apart.
    let second = mend(&again(&found), &WELDED);
    assert!(second.report.is_empty(), "{}", second.report);
    assert_eq!(second.file, found.file);
}

/// Two cubes that share an edge are two bodies again, whose volumes are those of the cubes; so are two tetrahedra, of
/// which the gaps are flatter than the edges.
#[test]
fn bodies_that_touch_along_an_edge_come_apart() {
    let cubes = cubes(&[[0, 0, 0]], 1);
    let edge = |mesh: &Mesh| {
        let mirrored = mesh.map(|[x, y, z]| [-x, -y, z]);
        let welded = together(&[mesh, &mirrored]);
        mend(&welded, &WELDED)
    };
    let tetrahedron = {
        let positions = vec![[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.5], [0.0, 1.0, 0.5]];
        let triangles = vec![[0, 2, 3], [1, 3, 2], [0, 1, 2], [0, 3, 1]];
        let own = mend(&soup(positions, triangles), &RepairSettings::default());
        Mesh::new(own.file.positions, own.file.mesh.triangles().to_vec())
    };
    for mesh in [&cubes, &tetrahedron] {
        let found = edge(mesh);
        assert_eq!(found.file.mesh.components().1, 2);
        assert_eq!(found.report.count(Action::Reversed), 0);
        // Two vertices at each end, none of them merged.
        assert!(found.report.is_empty(), "{}", found.report);
    }
    // The same as one list of triangles over shared vertices.
    let mut shared = together(&[&tetrahedron, &tetrahedron.map(|[x, y, z]| [-x, -y, z])]);
    for corner in shared.triangles.as_flattened_mut() {
        *corner = if [4, 5].contains(corner) {
            *corner - 4
        } else {
            *corner
        };
    }
    let error = TriangleMesh::new(8, shared.triangles.clone()).unwrap_err();
    assert!(matches!(
        error,
        MeshError::NonManifoldEdge { triangles: 4, .. }
    ));
    let found = mend(&shared, &RepairSettings::default());
    assert_eq!(Vec::from_iter(found.report.taken()), [(Action::Edges, 1)]);
    // Vertices that no triangle of the input has stay.
    assert_eq!(found.file.mesh.components().1, 4);
    let surface = Surface::new(&found.file.mesh, &found.file.positions).unwrap();
    let single = tetrahedron.surface().volume().unwrap();
    assert!((surface.volume().unwrap() - 2.0 * single).abs() < 1e-15);
}

/// Two cubes that share a row of edges: either choice of neighbours is a manifold there, and one has two bodies.
#[test]
fn bodies_that_touch_along_a_row_of_edges_come_apart() {
    let cube = cubes(&[[0, 0, 0]], 3);
    let mirrored = cube.map(|[x, y, z]| [-x, -y, z]);
    let mut shared = together(&[&cube, &mirrored]);
    let first = |position: &[f64; 3]| shared.positions.iter().position(|other| other == position);
    let names = shared
        .positions
        .iter()
        .map(|position| first(position).unwrap() as u32);
    let names = Vec::from_iter(names);
    for corner in shared.triangles.as_flattened_mut() {
        *corner = names[*corner as usize];
    }
    let found = mend(
        &shared,
        &RepairSettings {
            drop_unused: true,
            ..RepairSettings::default()
        },
    );
    assert_eq!(found.report.count(Action::Edges), 3);
    assert_eq!(found.file.mesh.components().1, 2);
    assert_eq!(found.file.positions.len(), shared.positions.len());
}

/// Sheets that cross in an edge stay flat.
#[test]
fn sheets_that_cross_stay_flat() {
    let positions = vec![
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 0.5],
        [-1.0, 0.0, 0.5],
        [0.5, 0.9, 0.5],
        [-0.5, -0.9, 0.5],
    ];
    let crossing = soup(positions, vec![[0, 1, 2], [1, 0, 3], [0, 1, 4], [1, 0, 5]]);
    let found = mend(&crossing, &RepairSettings::default());
    assert_eq!(Vec::from_iter(found.report.taken()), [(Action::Edges, 1)]);
    assert_eq!(found.file.mesh.components().1, 2);
    let surface = Surface::new(&found.file.mesh, &found.file.positions).unwrap();
    let [a, b, c, d] = [0, 1, 2, 3].map(|triangle| surface.triangle_normal(triangle));
    assert!(norm(difference(a, b)) < 1e-15 && norm(difference(c, d)) < 1e-15);
}

/// Two bent sheets that touch along an edge are valid, and welding does not make them cross.
#[test]
fn welding_leaves_neighbours_together() {
    let positions = vec![
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 0.5],
        [0.5, 0.9, 0.5],
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [-1.0, 0.0, 0.5],
        [-0.5, -0.9, 0.5],
    ];
    let bent = soup(positions, vec![[0, 1, 2], [1, 0, 3], [5, 4, 6], [4, 5, 7]]);
    let found = mend(&bent, &WELDED);
    assert!(found.report.is_empty(), "{}", found.report);
    assert_eq!(found.file.mesh.triangles(), bent.triangles);
}

/// Two cups with a common edge, whose border is a square: the diagonal of the square is that edge. A hole at a vertex
/// where another surface touches stays, too.
#[test]
fn holes_that_would_break_the_mesh_are_left() {
    let positions = vec![
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.7, 0.3, -3.0],
        [0.3, 0.7, -3.0],
    ];
    let cups = vec![
        [1, 0, 4],
        [2, 1, 4],
        [3, 2, 5],
        [0, 3, 5],
        [0, 2, 4],
        [2, 0, 5],
    ];
    let settings = RepairSettings {
        fill: 4,
        weld: Some(0.0),
        ..RepairSettings::default()
    };
    let found = mend(&soup(positions, cups), &settings);
    assert!(found.report.is_empty(), "{}", found.report);
    assert_eq!(found.report.holes_left, 1);

    let sphere = icosphere(1);
    let x = 2.0 * sphere.positions[0][0];
    let other = sphere.map(|p| [x - p[0], p[1], p[2]]);
    let mut touching = together(&[&sphere, &other]);
    let hole = touching
        .triangles
        .iter()
        .position(|triangle| triangle.contains(&0));
    touching.triangles.remove(hole.unwrap());
    for triangle in &mut touching.triangles[sphere.connectivity.triangles().len() - 1..] {
        triangle.swap(1, 2);
    }
    let found = mend(&touching, &settings);
    assert!(found.report.is_empty(), "{}", found.report);
    assert_eq!(found.report.holes_left, 1);
    let apart = RepairSettings {
        weld: None,
        ..settings
    };
    assert_eq!(mend(&touching, &apart).report.count(Action::Filled), 1);
}

/// Holes are filled, outlines are not.
#[test]
fn small_holes_are_filled() {
    let sphere = icosphere(2);
    let around = sphere.connectivity.one_ring(20).len();
    let mut holed = soup_of(&sphere);
    holed.triangles.retain(|triangle| !triangle.contains(&20));
    holed.triangles.pop();
    let settings = |fill: usize| RepairSettings {
        fill,
        ..RepairSettings::default()
    };
    let found = mend(&holed, &settings(3)).report;
    assert_eq!(Vec::from_iter(found.taken()), [(Action::Filled, 1)]);
    let found = mend(&holed, &settings(around));
    assert_eq!(found.report.count(Action::Filled), 2);
    assert!(found.file.mesh.is_closed());
    let new = found.triangle_of.iter().filter(|&&origin| origin == NEW);
    assert_eq!(new.count(), around - 2 + 1);
    let surface = Surface::new(&found.file.mesh, &found.file.positions).unwrap();
    assert!(surface.volume().unwrap() > 3.8);
    // The numbers at new triangles are unknown.
    let column = Column {
        name: "n".to_owned(),
        place: ColumnPlace::Triangles,
        values: (0..holed.triangles.len()).map(|n| n as f64).collect(),
    };
    let carried = found.columns(vec![column]).remove(0);
    assert_eq!(carried.values[..3], [0.0, 1.0, 2.0]);
    assert!(carried.values.last().unwrap().is_nan());
    for outline in [
        soup_of(&disc(2)),
        soup(
            vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            vec![[0, 1, 2]],
        ),
    ] {
        let found = mend(&outline, &settings(1000)).report;
        assert!(found.is_empty());
        assert_eq!(found.holes_left, 1);
    }
}

/// Needles and caps are removed, and the surface stays where it is.
#[test]
fn slivers_are_removed() {
    let sphere = icosphere(2);
    let settings_of = |slivers: f64| RepairSettings {
        slivers,
        ..RepairSettings::default()
    };
    let settings = settings_of(5.0);
    assert!(mend(&soup_of(&sphere), &settings).report.is_empty());
    let smallest = |found: &Repaired| {
        let surface = Surface::new(&found.file.mesh, &found.file.positions).unwrap();
        let angles =
            (0..found.file.mesh.triangles().len()).flat_map(|t| surface.triangle_angles(t));
        angles.fold(f64::INFINITY, f64::min).to_degrees()
    };
    for fraction in [0.0, 1e-9, 0.02] {
        // A new vertex beside a corner makes a needle, one near the middle of an edge a cap.
        for (at, action) in [
            ([fraction, 0.0], Action::Collapsed),
            ([0.5, fraction], Action::Flipped),
        ] {
            let mut soup = soup_of(&sphere);
            let [a, b, c] = soup.triangles[7];
            let new = soup.positions.len() as u32;
            let [x, y, z] = [a, b, c].map(|vertex| soup.positions[vertex as usize]);
            let toward =
                |axis: usize| x[axis] + at[0] * (y[axis] - x[axis]) + at[1] * (z[axis] - x[axis]);
            soup.positions.push([0, 1, 2].map(toward));
            soup.triangles[7] = [a, b, new];
            soup.triangles.extend([[b, c, new], [c, a, new]]);
            let found = mend(&soup, &settings);
            assert!(
                found.report.count(action) > 0,
                "{fraction} {action:?}: {}",
                found.report
            );
            assert_eq!(found.report.slivers_left, 0);
            assert!(smallest(&found) > 5.0, "{fraction} {action:?}");
            assert!(found.file.mesh.is_closed());
            let [before, after] = [
                area(&soup.positions, &soup.triangles),
                area(&found.file.positions, found.file.mesh.triangles()),
            ];
            assert!((after / before - 1.0).abs() < 0.01, "{before} {after}");
        }
    }
    // A flip at a fold would turn a triangle over.
    let fold = vec![
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [0.5, 0.05, 1e-3],
        [0.5, 0.8, 0.0],
    ];
    let found = mend(&soup(fold, vec![[0, 1, 2], [1, 0, 3]]), &settings_of(10.0)).report;
    assert!(found.is_empty(), "{found}");
    assert_eq!(found.slivers_left, 1);
    // The border stays: a sliver there is told, and left.
    let thin = soup(
        vec![[0.0; 3], [1.0, 0.0, 0.0], [0.5, 1e-3, 0.0]],
        vec![[0, 1, 2]],
    );
    let found = mend(&thin, &settings).report;
    assert!(found.is_empty());
    assert_eq!(found.slivers_left, 1);
    assert_eq!(found.to_string(), "slivers that could not be removed: 1");
}

/// A generated mesh with needles and caps has fewer of them, and the second repair finds nothing.
#[test]
fn hard_meshes_become_better() {
    let made = generate(
        &"ellipsoid:1,0.8,0.6".parse().unwrap(),
        Family::Hard,
        600,
        1,
    )
    .unwrap();
    let hard = soup(made.positions, made.mesh.triangles().to_vec());
    let settings = RepairSettings {
        slivers: 10.0,
        ..RepairSettings::default()
    };
    let found = mend(&hard, &settings);
    assert!(found.report.count(Action::Flipped) + found.report.count(Action::Collapsed) > 10);
    let second = mend(&again(&found), &settings);
    assert!(second.report.is_empty(), "{}", second.report);
    assert_eq!(second.file, found.file);
}

#[test]
fn what_cannot_be_repaired_is_refused() {
    let settings = RepairSettings::default();
    let error = repair(soup(vec![[0.0; 3]; 2], vec![[0, 1, 2]]), &settings).unwrap_err();
    let expected = MeshError::VertexOutOfRange {
        triangle: 0,
        vertex: 2,
        vertices: 2,
    };
    assert_eq!(error, RepairError::Mesh(expected));
    let error = repair(soup(vec![[0.0; 3]], Vec::new()), &settings).unwrap_err();
    assert_eq!(error, RepairError::Mesh(MeshError::Empty));
    let error = repair(
        soup(vec![[f64::NAN; 3]; 3], vec![[0, 1, 2], [0, 0, 0]]),
        &settings,
    )
    .unwrap_err();
    assert_eq!(
        error.to_string(),
        "no triangle is left of 2: triangles with a coordinate that is not finite left out: 2"
    );
}

/// Faces that a reader refuses are read as triangles, and their columns are carried.
#[test]
fn files_that_are_no_mesh_are_read() {
    let text = "ply\nformat ascii 1.0\nelement vertex 5\nproperty double x\nproperty double y\nproperty double z\n\
                property double c\nelement face 5\nproperty list uchar int vertex_indices\nproperty int n\n\
                end_header\n0 0 0 10\n1 0 0 11\n1 1 0 12\n0 1 0 13\nnan 0 0 14\n4 0 1 2 3 1\n2 0 1 2\n3 0 0 1 3\n\
                3 0 1 4 4\n3 2 1 0 5\n";
    let error = parse(text.as_bytes(), Format::Ply).unwrap_err();
    assert_eq!(
        error.to_string(),
        "line 16 (vertex 4): coordinate x is `nan`: a finite number is needed"
    );
    let (soup, columns) = parse_soup(text.as_bytes(), Format::Ply).unwrap();
    assert_eq!(soup.short_faces, 1);
    let expected = [[0, 1, 2], [0, 2, 3], [0, 0, 1], [0, 1, 4], [2, 1, 0]];
    assert_eq!(soup.triangles, expected);
    assert_eq!(columns[1].values, [1.0, 1.0, 3.0, 4.0, 5.0]);
    let found = mend(&soup, &RepairSettings::default());
    let expected = [
        (Action::ShortFaces, 1),
        (Action::NotFinite, 1),
        (Action::Repeated, 1),
        (Action::Duplicates, 1),
        (Action::Unused, 1),
    ];
    assert_eq!(Vec::from_iter(found.report.taken()), expected);
    let carried = found.columns(columns);
    assert_eq!(carried[0].values, [10.0, 11.0, 12.0, 13.0]);
    assert_eq!(carried[1].values, [1.0, 1.0]);
    // A vertex that is out of range is an error here, too.
    let error = parse_soup(b"v 0 0 0\nf 1 2 3\n", Format::Obj).unwrap_err();
    assert!(error.to_string().contains("names vertex 2"), "{error}");
}

/// Triangles over few vertices of a small grid, so that everything that is wrong occurs.
fn triangles() -> impl Strategy<Value = Soup> {
    let place = prop_oneof![
        20 => (-1i8..=1, -1i8..=1, -1i8..=1).prop_map(|(x, y, z)| [x, y, z].map(f64::from)),
        1 => Just([0.0, f64::NAN, 0.0]),
    ];
    let positions = prop::collection::vec(place, 3..12);
    positions.prop_flat_map(|positions| {
        let corner = 0..positions.len() as u32;
        let triangle = [corner.clone(), corner.clone(), corner];
        prop::collection::vec(triangle, 1..40)
            .prop_map(move |triangles| soup(positions.clone(), triangles))
    })
}

fn any_settings() -> impl Strategy<Value = RepairSettings> {
    let weld = prop_oneof![Just(None), Just(Some(0.0)), Just(Some(1.0))];
    let sheets = prop_oneof![3 => Just(Sheets::Split), 1 => Just(Sheets::Largest)];
    let slivers = prop_oneof![2 => Just(0.0), 1 => Just(40.0)];
    (
        weld,
        sheets,
        0usize..6,
        slivers,
        any::<bool>(),
        any::<bool>(),
    )
        .prop_map(
            |(weld, sheets, fill, slivers, outward, drop_unused)| RepairSettings {
                weld,
                sheets,
                fill,
                slivers,
                outward,
                drop_unused,
            },
        )
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn any_triangles_become_a_mesh_that_needs_no_repair(soup in triangles(), settings in any_settings()) {
        match repair(soup.clone(), &settings) {
            Ok(found) => {
                prop_assert_eq!(found.vertex_of.len(), found.file.positions.len());
                prop_assert_eq!(found.triangle_of.len(), found.file.mesh.triangles().len());
                for (position, &origin) in found.file.positions.iter().zip(&found.vertex_of) {
                    prop_assert_eq!(position, &soup.positions[origin as usize]);
                }
                let second = repair(again(&found), &settings).unwrap();
                // Welded surfaces that cross each other may be paired in another way once they are apart.
                let crosses = [Action::Edges, Action::Cut].map(|action| found.report.count(action) > 0);
                if settings.weld.is_some() && crosses.contains(&true) {
                    return Ok(());
                }
                prop_assert!(second.report.is_empty(), "{}", second.report);
                prop_assert_eq!(bits(&second.file.positions), bits(&found.file.positions));
                prop_assert_eq!(&second.file.mesh, &found.file.mesh);
                prop_assert_eq!(found.report.holes_left, second.report.holes_left);
                prop_assert_eq!(found.report.slivers_left, second.report.slivers_left);
            }
            Err(RepairError::NothingLeft { .. }) => {}
            Err(error) => prop_assert!(false, "{error}"),
        }
    }

    /// Slivers are removed from any mesh, and what is left is a mesh with the same border.
    #[test]
    fn removing_slivers_keeps_the_border(soup in triangles(), slivers in 1.0..60.0) {
        let Ok(mesh) = repair(soup, &RepairSettings::default()) else { return Ok(()) };
        let settings = RepairSettings { slivers, ..RepairSettings::default() };
        let found = mend(&again(&mesh), &settings);
        let border = |repaired: &Repaired| {
            let mesh = &repaired.file.mesh;
            let edges = mesh.edges().iter().enumerate();
            let border = edges.filter(|&(edge, _)| mesh.edge_triangles(edge).1.is_none());
            let ends = border.map(|(_, ends)| {
                let mut ends = ends.map(|vertex| repaired.vertex_of[vertex as usize]);
                ends.sort_unstable();
                ends
            });
            ends.collect::<std::collections::BTreeSet<_>>()
        };
        let all = Vec::from_iter(0..mesh.file.positions.len() as u32);
        let before = Repaired { vertex_of: all, ..mesh };
        prop_assert_eq!(border(&found), border(&before));
        let second = mend(&again(&found), &settings);
        prop_assert!(second.report.is_empty(), "{}", second.report);
    }

    /// Splitting moves nothing, and keeps all triangles with three different corners; each once.
    #[test]
    fn splitting_keeps_area_and_triangles(soup in triangles()) {
        let mut known = soup;
        known.positions.retain(|x| x[1].is_finite());
        let count = known.positions.len() as u32;
        prop_assume!(count >= 3);
        let mut seen = std::collections::BTreeSet::new();
        known.triangles.retain(|&corners| {
            let mut sorted = corners;
            sorted.sort_unstable();
            let [a, b, c] = sorted;
            a < b && b < c && c < count && seen.insert(sorted)
        });
        prop_assume!(!known.triangles.is_empty());
        let found = mend(&known, &RepairSettings::default());
        prop_assert_eq!(found.file.mesh.triangles().len(), known.triangles.len());
        let [before, after] = [
            area(&known.positions, &known.triangles),
            area(&found.file.positions, found.file.mesh.triangles()),
        ];
        prop_assert!((before - after).abs() <= 1e-13 * before);
        for (corners, &origin) in found.file.mesh.triangles().iter().zip(&found.triangle_of) {
            let mut own = corners.map(|vertex| found.vertex_of[vertex as usize]);
            let mut old = known.triangles[origin as usize];
            own.sort_unstable();
            old.sort_unstable();
            prop_assert_eq!(own, old);
        }
        let copies = found.file.mesh.vertex_kinds().iter().filter(|&&kind| kind != VertexKind::Isolated);
        prop_assert!(copies.count() <= 3 * known.triangles.len());
    }
}
