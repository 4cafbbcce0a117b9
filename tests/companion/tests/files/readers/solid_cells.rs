//! The outer surface of solid cells.

use helfrich_std::io::{
    ColumnPlace, Format, MeshFile, parse, parse_with_columns, read, read_with_columns,
};
use std::fs;
use tempfile::TempDir;

/// A unit cube with its centre and, beside it at x > 1, the corners of a second one.
const POINTS: &str = "0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1 0.5 0.5 0.5\n\
    2 0 0 2 1 0 2 0 1 2 1 1\n";

/// A file with cells of these types and nodes, numbered from 1.
fn vtk(cells: &[(u8, &[u32])]) -> String {
    let size: usize = cells.iter().map(|(_, nodes)| nodes.len() + 1).sum();
    let mut text = format!(
        "# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 13 double\n{POINTS}\
         CELLS {} {size}\n",
        cells.len()
    );
    for (_, nodes) in cells {
        let nodes = Vec::from_iter(nodes.iter().map(u32::to_string));
        text += &format!("{} {}\n", nodes.len(), nodes.join(" "));
    }
    text += &format!("CELL_TYPES {}\n", cells.len());
    for (kind, _) in cells {
        text += &format!("{kind}\n");
    }
    text += &format!(
        "CELL_DATA {}\nSCALARS c double\nLOOKUP_TABLE default\n",
        cells.len()
    );
    for number in 1..=cells.len() {
        text += &format!("{number}\n");
    }
    text
}

fn volume(file: &MeshFile) -> f64 {
    let origin = file.positions[0];
    let terms = file.mesh.triangles().iter().map(|triangle| {
        let [a, b, c] = triangle.map(|vertex| {
            let x = file.positions[vertex as usize];
            [0, 1, 2].map(|axis| x[axis] - origin[axis])
        });
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    });
    terms.sum::<f64>() / 6.0
}

#[track_caller]
fn assert_is_closed(text: &str, format: Format, expected: f64, triangles: usize) {
    let file = parse(text.as_bytes(), format).unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert!(file.mesh.is_closed());
    assert_eq!(file.mesh.euler_characteristic(), 2);
    assert_eq!(file.mesh.triangles().len(), triangles);
    assert_eq!(volume(&file), expected, "{text}");
}

/// Every kind of solid cells has a closed outer surface whose normals point outward, whatever the sense of rotation
/// in which its nodes are listed.
#[test]
fn solid_cells_are_read_as_their_outer_surface() {
    let cubes: [&[(u8, &[u32])]; 7] = [
        &[(12, &[0, 1, 3, 2, 4, 5, 7, 6])],
        // Its mirror image.
        &[(12, &[4, 5, 7, 6, 0, 1, 3, 2])],
        &[(11, &[0, 1, 2, 3, 4, 5, 6, 7])],
        &[(13, &[0, 1, 2, 4, 5, 6]), (13, &[1, 3, 2, 5, 7, 6])],
        // One of them mirrored, as those of Gmsh are.
        &[(13, &[4, 5, 6, 0, 1, 2]), (13, &[1, 3, 2, 5, 7, 6])],
        &[
            (14, &[0, 1, 3, 2, 8]),
            (14, &[4, 6, 7, 5, 8]),
            (14, &[0, 4, 5, 1, 8]),
            (14, &[2, 3, 7, 6, 8]),
            (14, &[0, 2, 6, 4, 8]),
            (14, &[1, 5, 7, 3, 8]),
        ],
        &[
            (10, &[0, 1, 2, 4]),
            (10, &[3, 1, 2, 7]),
            (10, &[5, 1, 4, 7]),
            (10, &[6, 2, 4, 7]),
            (10, &[1, 2, 4, 7]),
        ],
    ];
    for cells in cubes {
        assert_is_closed(&vtk(cells), Format::Vtk, 1.0, 12);
    }
    // Two cubes share a face; a line and a point beside them change nothing.
    let two: &[(u8, &[u32])] = &[
        (12, &[0, 1, 3, 2, 4, 5, 7, 6]),
        (3, &[0, 8]),
        (12, &[1, 9, 10, 3, 5, 11, 12, 7]),
    ];
    assert_is_closed(&vtk(two), Format::Vtk, 2.0, 20);
    let (file, columns) = parse_with_columns(vtk(two).as_bytes(), Format::Vtk).unwrap();
    assert_eq!(file.positions.len(), 12, "the centre is left out");
    assert_eq!(columns[0].place, ColumnPlace::Triangles);
    let halves = [[1.0; 10], [3.0; 10]];
    assert_eq!(columns[0].values, halves.as_flattened());
    // Faces, if there are any, are the surface.
    let with_face: &[(u8, &[u32])] = &[(12, &[0, 1, 3, 2, 4, 5, 7, 6]), (5, &[0, 1, 2])];
    let face = parse(vtk(with_face).as_bytes(), Format::Vtk).unwrap();
    assert_eq!(face.mesh.triangles(), [[0, 1, 2]]);
    // Too few nodes, and polyhedra.
    for cells in [&[(10, &[0, 1, 2][..])][..], &[(42, &[0, 1, 2, 4])]] {
        let error = parse(vtk(cells).as_bytes(), Format::Vtk)
            .unwrap_err()
            .to_string();
        assert!(error.contains("extract their surface first"), "{error}");
    }
}

/// Structured grids of many layers, and elements of Gmsh of second order.
#[test]
fn solids_of_other_formats_are_read_as_their_outer_surface() {
    let points = (0..24).map(|at| format!("{} {} {}\n", at % 2, at / 2 % 3, at / 6));
    let grid = format!(
        "# vtk DataFile Version 3.0\n\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS 2 3 4\nPOINTS 24 double\n{}",
        String::from_iter(points)
    );
    assert_is_closed(&grid, Format::Vtk, 6.0, 44);
    let tetrahedron = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 6\n\
        5 0.5 0 0\n6 0.5 0.5 0\n7 0 0.5 0\n8 0 0 3\n9 0 0.5 3\n10 0.5 0 3\n$EndNodes\n$Elements\n1\n\
        1 11 2 1 1 1 2 3 4 5 6 7 8 9 10\n$EndElements\n";
    assert_is_closed(tetrahedron, Format::Msh, 1.0, 4);
}

/// Two cubes in two files, as two processes write them, each with the cell of the other as a copy.
fn piece(own: [u32; 8], copy: [u32; 8]) -> String {
    let numbers = |own: &[u32]| Vec::from_iter(own.iter().map(u32::to_string)).join(" ");
    let points = POINTS.replace('\n', " ");
    format!(
        r#"<VTKFile type="UnstructuredGrid"><UnstructuredGrid><Piece NumberOfPoints="13" NumberOfCells="2">
<PointData><DataArray type="Float64" Name="p" format="ascii">0 1 2 3 4 5 6 7 8 9 10 11 12</DataArray></PointData>
<CellData><DataArray type="UInt8" Name="vtkGhostType" format="ascii">1 0</DataArray>
<DataArray type="Float64" Name="c" format="ascii">-1 {}</DataArray></CellData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">{points}</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">{} {}</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">8 16</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">12 12</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>"#,
        own[1],
        numbers(&copy),
        numbers(&own)
    )
}

/// The parts of a surface in several files become one, with their columns; blocks stay apart. Names of files that lead
/// elsewhere are refused.
#[test]
fn files_of_parts_are_read_with_their_parts() {
    let folder = TempDir::new().unwrap();
    let [left, right] = [[0, 1, 3, 2, 4, 5, 7, 6], [1, 9, 10, 3, 5, 11, 12, 7]];
    fs::create_dir(folder.path().join("parts")).unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        path
    };
    write("parts/0.vtu", &piece(left, right));
    write("parts/1.vtu", &piece(right, left));
    let list = r#"<VTKFile type="PUnstructuredGrid"><PUnstructuredGrid GhostLevel="1">
        <PPoints/><Piece Source="parts/0.vtu"/><Piece Source="parts/1.vtu"/></PUnstructuredGrid></VTKFile>"#;
    let (file, columns) = read_with_columns(&write("all.pvtu", list)).unwrap();
    assert!(file.mesh.is_closed());
    assert_eq!((volume(&file), file.positions.len()), (2.0, 12));
    assert_eq!(file.mesh.triangles().len(), 20);
    let of = |name: &str| columns.iter().find(|column| column.name == name).unwrap();
    assert_eq!(
        of("p").values,
        [
            0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 9.0, 10.0, 11.0, 12.0
        ]
    );
    assert_eq!(of("c").values, [[1.0; 10], [9.0; 10]].as_flattened());

    let blocks = r#"<VTKFile type="vtkMultiBlockDataSet"><vtkMultiBlockDataSet><Block index="0">
        <DataSet index="0" file="parts/0.vtu"/><DataSet index="1"/></Block>
        <DataSet index="1" file="parts/1.vtu"/></vtkMultiBlockDataSet></VTKFile>"#;
    let apart = read(&write("all.vtm", blocks)).unwrap();
    assert_eq!((volume(&apart), apart.positions.len()), (2.0, 16));

    for (wrong, expected) in [
        (list.replace("parts/1", "../1"), "a file name beside it"),
        (list.replace("parts/1", "/1"), "a file name beside it"),
        (list.replace("parts/1", "parts/2"), "`parts/2.vtu`: "),
        (
            list.replace("parts/1.vtu", "all.pvtu"),
            "PolyData or UnstructuredGrid",
        ),
        (
            list.replace("Source", "Sauce"),
            "names of files with pieces, found none",
        ),
    ] {
        let error = read(&write("all.pvtu", &wrong)).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    let error = parse(list.as_bytes(), Format::Vtu).unwrap_err().to_string();
    assert!(error.contains("because it names others"), "{error}");
}
