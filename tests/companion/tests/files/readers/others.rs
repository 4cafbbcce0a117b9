//! Formats of other programs: the same mesh in each, files that these programs wrote, and damaged files.

use super::file;
use helfrich_std::io::{
    ColumnPlace, Format, ParseError, Problem, parse, parse_soup, parse_with_columns, read,
    read_with_columns,
};
use helfrich_tests::invariants::check_reader;
use std::path::Path;

/// A tetrahedron with a column at the vertices and one at the faces.
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n\
    property double z\nproperty float p\nelement face 4\nproperty list uchar int vertex_indices\n\
    property float c\nend_header\n0.1 0 0 0.5\n1 0 0 1.5\n0 1 0 2.5\n0 0 1 3.5\n\
    3 0 2 1 1\n3 0 1 3 2\n3 1 2 3 3\n3 2 0 3 4\n";

const VTK: &str = "# vtk DataFile Version 3.0\n# a title: not a comment\nASCII\nDATASET POLYDATA\n\
    POINTS 4 double\n0.1 0 0 1 0\n0 0 1 0 0 0 1\nLINES 1 3\n2 0 1\nPOLYGONS 4 16\n3 0 2 1 3 0 1 3\n\
    3 1 2 3 3 2 0 3\nMETADATA\nINFORMATION 0\n\nPOINT_DATA 4\nVECTORS v float\n1 2 3 4 5 6 7 8 9 10 11 12\n\
    SCALARS p float\nLOOKUP_TABLE default\n0.5 1.5 2.5 3.5\nCELL_DATA 5\nFIELD all 2\n\
    names 1 5 string\na b\nc\nd\ne\nf\nc 1 5 float\n9 1 2 3 4\n";

const NEW_VTK: &str = "# vtk DataFile Version 5.1\n\nASCII\nDATASET UNSTRUCTURED_GRID\n\
    POINTS 4 double\n0.1 0 0 1 0 0 0 1 0 0 0 1\nCELLS 6 14\nOFFSETS vtktypeint64\n0 2 5 8 11 14\n\
    CONNECTIVITY vtktypeint64\n0 1 0 2 1 0 1 3 1 2 3 2 0 3\nCELL_TYPES 5\n3 5 5 7 5\n\
    POINT_DATA 4\nSCALARS p double 1\nLOOKUP_TABLE default\n0.5 1.5 2.5 3.5\nCELL_DATA 5\n\
    SCALARS c int\nLOOKUP_TABLE default\n9 1 2 3 4\n";

const VTU: &str = r#"<?xml version="1.0"?><VTKFile type="UnstructuredGrid"><UnstructuredGrid>
<Piece NumberOfPoints="4" NumberOfCells="5"><PointData><DataArray type="Float32" Name="p" format="ascii">
0.5 1.5 2.5 3.5</DataArray></PointData><CellData><DataArray type="Int8" Name="c" format="ascii">9 1 2 3 4
</DataArray></CellData><Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
0.1 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points><Cells>
<DataArray type="Int8" Name="connectivity" format="ascii">0 1 0 2 1 0 1 3 1 2 3 2 0 3</DataArray>
<DataArray type="Int8" Name="offsets" format="ascii">2 5 8 11 14</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">3 5 5 7 5</DataArray></Cells></Piece>
</UnstructuredGrid></VTKFile>"#;

/// The tags of nodes and elements are in no order.
const MSH_2: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"wall\"\n$EndPhysicalNames\n\
    $Nodes\n5\n7 0.1 0 0\n3 1 0 0\n9 0 1 0\n4 0 0 1\n1 5 5 5\n$EndNodes\n$Elements\n6\n1 15 2 0 1 1\n\
    2 1 2 0 1 7 3\n13 2 2 1 6 7 9 3\n12 2 2 1 6 7 3 4\n11 2 2 1 6 3 9 4\n10 2 3 1 6 0 9 7 4\n$EndElements\n\
    $NodeData\n1\n\"p\"\n1\n0.0\n3\n0\n1\n4\n3 1.5\n7 0.5\n4 3.5\n9 2.5\n$EndNodeData\n\
    $ElementData\n1\n\"c\"\n0\n3\n0\n1\n4\n10 4\n11 3\n12 2\n13 1\n$EndElementData\n";

const MSH_40: &str = "$MeshFormat\n4 0 8\n$EndMeshFormat\n$Nodes\n1 5\n6 2 0 5\n7 0.1 0 0\n3 1 0 0\n9 0 1 0\n\
    4 0 0 1\n1 5 5 5\n$EndNodes\n$Elements\n2 5\n1 1 1 1\n2 7 3\n6 2 2 4\n13 7 9 3\n12 7 3 4\n11 3 9 4\n\
    10 9 7 4\n$EndElements\n\
    $NodeData\n1\n\"p\"\n0\n3\n0\n1\n4\n3 1.5\n7 0.5\n4 3.5\n9 2.5\n$EndNodeData\n\
    $ElementData\n1\n\"c\"\n0\n3\n0\n1\n4\n10 4\n11 3\n12 2\n13 1\n$EndElementData\n";

/// Nodes of the second block are on a surface, with two coordinates there.
const MSH_41: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n2 5 1 9\n0 1 0 1\n1\n5 5 5\n2 6 1 4\n7\n3\n9\n4\n\
    0.1 0 0 8 8\n1 0 0 8 8\n0 1 0 8 8\n0 0 1 8 8\n$EndNodes\n$Elements\n2 5 2 13\n1 1 1 1\n2 7 3\n2 6 2 4\n\
    13 7 9 3\n12 7 3 4\n11 3 9 4\n10 9 7 4\n$EndElements\n\
    $NodeData\n1\n\"p\"\n0\n3\n0\n1\n4\n3 1.5\n7 0.5\n4 3.5\n9 2.5\n$EndNodeData\n\
    $ElementData\n1\n\"c\"\n0\n3\n0\n1\n4\n10 4\n11 3\n12 2\n13 1\n$EndElementData\n";

const GIFTI: &str = r#"<?xml version="1.0"?><!DOCTYPE GIFTI SYSTEM "gifti.dtd"><GIFTI Version="1.0">
<DataArray Intent="NIFTI_INTENT_SHAPE" DataType="NIFTI_TYPE_FLOAT64" Dimensionality="1" Dim0="4"
Encoding="ASCII"><MetaData><MD><Name><![CDATA[Name]]></Name><Value><![CDATA[p]]></Value></MD></MetaData>
<Data>0.5 1.5 2.5 3.5</Data></DataArray>
<DataArray Intent="NIFTI_INTENT_POINTSET" DataType="NIFTI_TYPE_FLOAT64" ArrayIndexingOrder="ColumnMajorOrder"
Dim0="4" Dim1="3" Encoding="ASCII"><Data>0.1 1 0 0 0 0 1 0 0 0 0 1</Data></DataArray>
<DataArray Intent="NIFTI_INTENT_TRIANGLE" DataType="NIFTI_TYPE_INT32" ArrayIndexingOrder="RowMajorOrder"
Dim0="4" Dim1="3" Encoding="ASCII"><Data>0 2 1 0 1 3 1 2 3 2 0 3</Data></DataArray></GIFTI>"#;

#[test]
fn every_format_has_the_same_mesh_and_columns() {
    let (expected, columns) = parse_with_columns(PLY.as_bytes(), Format::Ply).unwrap();
    assert_eq!(columns.len(), 2);
    for (text, format) in [
        (VTK, Format::Vtk),
        (NEW_VTK, Format::Vtk),
        (VTU, Format::Vtu),
        (MSH_2, Format::Msh),
        (MSH_40, Format::Msh),
        (MSH_41, Format::Msh),
        (GIFTI, Format::Gifti),
    ] {
        let (found, own) = parse_with_columns(text.as_bytes(), format).unwrap();
        assert_eq!(found, expected, "{text}");
        assert_eq!(parse(text.as_bytes(), format).unwrap(), expected);
        let faces = if format == Format::Gifti { 0 } else { 1 };
        assert_eq!(own[..=faces], columns[..=faces], "{text}");
        if format == Format::Msh {
            let group = own.iter().find(|column| column.name == "gmsh:geometrical");
            assert_eq!(group.unwrap().values, [6.0; 4]);
        }
        let unnamed = format!("unnamed-{}", text.len());
        assert_eq!(read(&file(&unnamed, text.as_bytes())).unwrap(), expected);
    }
}

/// A triangle with a repeated corner is refused where it is, and is one of the triangles of which a repair makes a mesh.
#[test]
fn triangles_of_every_format_need_not_form_a_mesh() {
    let refusal = |bytes: &[u8], format| {
        let error = parse(bytes, format).unwrap_err();
        assert!(error.is_repairable() && !error.places.is_empty(), "{error}");
        assert_eq!(error.problem, Problem::RepeatedVertex { corners: [2, 3] });
    };
    let (_, columns) = parse_with_columns(PLY.as_bytes(), Format::Ply).unwrap();
    for (text, [good, bad], format) in [
        (PLY, ["3 2 0 3 4", "3 2 0 0 4"], Format::Ply),
        (VTK, ["2 0 3\nM", "2 0 0\nM"], Format::Vtk),
        (NEW_VTK, ["2 0 3\nC", "2 0 0\nC"], Format::Vtk),
        (VTU, ["2 0 3</D", "2 0 0</D"], Format::Vtu),
        (MSH_2, ["9 7 4\n$", "9 7 7\n$"], Format::Msh),
        (MSH_40, ["9 7 4\n$", "9 7 7\n$"], Format::Msh),
        (MSH_41, ["9 7 4\n$", "9 7 7\n$"], Format::Msh),
        (GIFTI, ["2 0 3</D", "2 0 0</D"], Format::Gifti),
    ] {
        let text = text.replace(good, bad);
        refusal(text.as_bytes(), format);
        let (soup, own) = parse_soup(text.as_bytes(), format).unwrap();
        let expected = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 0]];
        assert_eq!(soup.triangles, expected, "{text}");
        assert_eq!((soup.positions.len(), soup.short_faces), (4, 0));
        let faces = if format == Format::Gifti { 0 } else { 1 };
        assert_eq!(own[..=faces], columns[..=faces], "{text}");
    }
    let mut bytes = buffer();
    bytes[50] = 2;
    let bytes = glb(&gltf(""), &bytes);
    refusal(&bytes, Format::Gltf);
    let (soup, _) = parse_soup(&bytes, Format::Gltf).unwrap();
    assert_eq!(soup.triangles[..2], [[0, 2, 2], [4, 5, 6]]);
}

/// Every second triangle of a strip is reversed, and triangles with a repeated corner only join parts.
#[test]
fn strips_keep_their_orientation() {
    let strip = VTK.split("LINES").next().unwrap();
    let text = format!("{strip}TRIANGLE_STRIPS 1 8\n7 0 2 1 1 1 3 0\n");
    let found = parse(text.as_bytes(), Format::Vtk).unwrap();
    assert_eq!(found.mesh.triangles(), [[0, 2, 1], [1, 3, 0]]);
    let text = format!(
        "{strip}TRIANGLE_STRIPS 1 7\n6 0 2 1 3 0 2\nCELL_DATA 1\nSCALARS c int\n\
        LOOKUP_TABLE default\n7\n"
    );
    let (found, columns) = parse_with_columns(text.as_bytes(), Format::Vtk).unwrap();
    assert_eq!(
        found.mesh.triangles(),
        [[0, 2, 1], [1, 2, 3], [1, 3, 0], [0, 3, 2]]
    );
    assert!(found.mesh.is_closed());
    assert_eq!(columns[0].values, [7.0; 4]);
}

/// Nodes on sides, and those of other cells, are no vertices of the mesh; their columns are left out as well.
#[test]
fn faces_of_higher_order_have_their_corners() {
    let start = "# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 float\n0 0 0 1 1 0 1 0 0 \
        0 1 0 0.5 0 0 0.5 0.5 0 0 0.5 0 0 0 1\n";
    let text = |cells: &str| {
        format!(
            "{start}{cells}POINT_DATA 8\nSCALARS p int\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7\n"
        )
    };
    let (found, columns) = parse_with_columns(
        text("CELLS 2 12\n6 0 2 3 4 5 6 4 0 2 3 7\nCELL_TYPES 2\n22 10\n").as_bytes(),
        Format::Vtk,
    )
    .unwrap();
    assert_eq!(
        found.positions,
        [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    );
    assert_eq!(found.mesh.triangles(), [[0, 1, 2]]);
    assert_eq!(
        (found.left_out, &columns[0].values[..]),
        (0, &[0.0, 2.0, 3.0][..])
    );
    let alone = text("CELLS 1 7\n6 0 2 3 4 5 6\nCELL_TYPES 1\n22\n");
    let alone = parse(alone.as_bytes(), Format::Vtk).unwrap();
    assert_eq!(alone, found);
    let error = parse(
        text("CELLS 1 5\n4 0 2 3 7\nCELL_TYPES 1\n42\n").as_bytes(),
        Format::Vtk,
    );
    let message = error.unwrap_err().to_string();
    assert!(
        message
            .contains("found polyhedra, or cells with too few nodes: extract their surface first"),
        "{message}"
    );
    let pixel = parse(
        text("CELLS 1 5\n4 0 2 3 1\nCELL_TYPES 1\n8\n").as_bytes(),
        Format::Vtk,
    );
    assert_eq!(pixel.unwrap().mesh.triangles(), [[0, 2, 1], [0, 1, 3]]);
}

/// A layer of a structured grid is a surface.
#[test]
fn a_structured_grid_of_one_layer_is_read() {
    let text = "# vtk DataFile Version 3.0\n\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS 3 1 2\nPOINTS 6 float\n\
        0 0 0 1 0 0 2 0 0 0 0 1 1 0 1 2 0 1\n";
    let found = parse(text.as_bytes(), Format::Vtk).unwrap();
    assert_eq!(
        found.mesh.triangles(),
        [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]]
    );
    let error = parse(text.replace("3 1 2", "3 2 2").as_bytes(), Format::Vtk).unwrap_err();
    assert_eq!(
        error.to_string(),
        "line 5: expected as many points as the product of the dimensions, found 6"
    );
}

/// Two nodes with a mesh each: moved, and mirrored; the second has a strip and a fan that share vertices.
fn gltf(buffer: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":1,"scenes":[{{"nodes":[9]}},{{"nodes":[0,2]}}],"nodes":[
        {{"children":[1],"translation":[10,0,0],"scale":[2,2,2]}},{{"mesh":0}},
        {{"mesh":1,"matrix":[-1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}}],"meshes":[
        {{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}},{{"attributes":{{"POSITION":0}},"mode":1}}]}},
        {{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":7}},"indices":2,"mode":5}},
        {{"attributes":{{"POSITION":0}},"indices":3,"mode":6}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}},
        {{"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"}},
        {{"bufferView":1,"byteOffset":3,"componentType":5121,"count":4,"type":"SCALAR"}},
        {{"bufferView":1,"byteOffset":7,"componentType":5121,"count":4,"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":11}}],
        "buffers":[{{"byteLength":59{buffer}}}]}}"#
    )
}

/// The corners of the tetrahedron; a triangle; the strip 0 2 1 3; the fan 3 2 0 1.
fn buffer() -> Vec<u8> {
    let points: [f32; 12] = [0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.];
    let mut bytes = Vec::from(points.map(f32::to_le_bytes).as_flattened());
    bytes.extend([0, 2, 1, 0, 2, 1, 3, 3, 2, 0, 1]);
    bytes
}

fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let length = |bytes: &[u8]| (bytes.len() as u32).to_le_bytes();
    let whole = ((28 + json.len() + binary.len()) as u32).to_le_bytes();
    let json = json.as_bytes();
    [
        b"glTF",
        &2_u32.to_le_bytes(),
        &whole,
        &length(json),
        b"JSON",
        json,
        &length(binary),
        b"BIN\0",
        binary,
    ]
    .concat()
}

#[test]
fn nodes_of_gltf_are_placed() {
    use base64::Engine;
    let found = parse(&glb(&gltf(""), &buffer()), Format::Gltf).unwrap();
    let moved = [
        [10.0, 0.0, 0.0],
        [12.0, 0.0, 0.0],
        [10.0, 2.0, 0.0],
        [10.0, 0.0, 2.0],
    ];
    assert_eq!(found.positions[..4], moved);
    assert_eq!(found.positions[5], [-1.0, 0.0, 0.0]);
    let expected = [[0, 2, 1], [4, 5, 6], [5, 7, 6], [7, 4, 6], [7, 5, 4]];
    assert_eq!(found.mesh.triangles(), expected);
    let text = base64::engine::general_purpose::STANDARD.encode(buffer());
    let embedded = gltf(&format!(
        r#","uri":"data:application/gltf-buffer;base64,{text}""#
    ));
    assert_eq!(parse(embedded.as_bytes(), Format::Gltf).unwrap(), found);
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("mesh.gltf");
    std::fs::write(folder.path().join("the buffer.bin"), buffer()).unwrap();
    let beside = gltf(r#","uri":"the%20buffer.bin""#);
    std::fs::write(&path, &beside).unwrap();
    assert_eq!(read(&path).unwrap(), found);
    let error = parse(beside.as_bytes(), Format::Gltf)
        .unwrap_err()
        .to_string();
    assert!(error.contains("because it is read from memory"), "{error}");
    for elsewhere in [
        "../the buffer.bin",
        "%2e%2e/x.bin",
        "/etc/passwd",
        "a\\\\b.bin",
        "file:x.bin",
        ".hidden",
        "",
    ] {
        std::fs::write(&path, gltf(&format!(r#","uri":"{elsewhere}""#))).unwrap();
        let error = read(&path).unwrap_err().to_string();
        assert!(
            error.contains("a file name beside it"),
            "{elsewhere}: {error}"
        );
    }
}

/// Numbers of a sparse accessor replace others, and normalised ones are fractions.
#[test]
fn accessors_of_gltf_may_be_sparse_and_normalised() {
    let json = gltf("").replace(
        r#""count":4,"type":"VEC3"}"#,
        r#""count":4,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":1,"byteOffset":2,
        "componentType":5121},"values":{"bufferView":0,"byteOffset":12}}}"#,
    );
    let found = parse(&glb(&json, &buffer()), Format::Gltf).unwrap();
    assert_eq!(found.positions[1], [12.0, 0.0, 0.0]);
    let json = json.replace(r#""byteOffset":2,"#, r#""byteOffset":1,"#);
    let found = parse(&glb(&json, &buffer()), Format::Gltf).unwrap();
    assert_eq!(found.positions[2], [12.0, 0.0, 0.0]);
    let json = gltf("").replace("5126,", r#"5121,"normalized":true,"#);
    let mut bytes = vec![0; 48];
    bytes[3] = 255;
    bytes[7] = 51;
    bytes.extend(&buffer()[48..]);
    let found = parse(&glb(&json, &bytes), Format::Gltf).unwrap();
    assert_eq!(found.positions[5..7], [[-1.0, 0.0, 0.0], [0.0, 0.2, 0.0]]);
}

const FORMATS: [(&str, Format); 7] = [
    ("vtp", Format::Vtp),
    ("vtu", Format::Vtu),
    ("vtk", Format::Vtk),
    ("gltf", Format::Gltf),
    ("msh", Format::Msh),
    ("gifti", Format::Gifti),
    ("3mf", Format::ThreeMf),
];

/// Files of VTK, trimesh, meshio and nibabel, which are the seeds of the fuzz targets.
fn of_programs() -> Vec<(String, Vec<u8>, Format)> {
    let mut files = Vec::new();
    for (name, format) in FORMATS {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../fuzz/corpus-seeds")
            .join(format!("read_{name}"));
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let bytes = std::fs::read(&path).unwrap();
            files.push((path.display().to_string(), bytes, format));
        }
    }
    assert!(files.len() > 35);
    files
}

#[test]
fn files_of_other_programs_are_read() {
    let corner = |k: usize| {
        let mut corner = [0.0; 3];
        corner[k / 2] = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        corner
    };
    let octahedron = Vec::from_iter((0..6).map(corner));
    for (name, bytes, format) in of_programs() {
        let (file, columns) = parse_with_columns(&bytes, format).unwrap();
        assert_eq!(file.positions, octahedron, "{name}");
        assert_eq!(file.mesh.triangles().len(), 8, "{name}");
        assert!(file.mesh.is_closed(), "{name}");
        assert_eq!(read(Path::new(&name)).unwrap(), file);
        let column = |own: &str| columns.iter().find(|column| column.name == own);
        if let Some(at_vertices) = column("p") {
            assert_eq!(at_vertices.place, ColumnPlace::Vertices);
            assert_eq!(at_vertices.values, [0.5, 1.5, 2.5, 3.5, 4.5, 5.5], "{name}");
        }
        if let Some(at_faces) = column("c").filter(|_| !name.contains("strips")) {
            let expected = Vec::from_iter((0..8).map(|k| f64::from(k) + 0.5));
            assert_eq!(at_faces.values[..], expected, "{name}");
        }
    }
}

/// A file that is truncated anywhere, or of which any byte is changed, is a mesh or an error.
#[test]
fn damaged_files_are_errors_or_meshes() {
    let mut files = of_programs();
    let own = [VTK, NEW_VTK, VTU, MSH_2, MSH_40, MSH_41, GIFTI].map(str::as_bytes);
    let formats = [
        Format::Vtk,
        Format::Vtk,
        Format::Vtu,
        Format::Msh,
        Format::Msh,
        Format::Msh,
        Format::Gifti,
    ];
    files.extend(
        own.iter()
            .zip(formats)
            .map(|(own, format)| (String::new(), own.to_vec(), format)),
    );
    files.push((String::new(), glb(&gltf(""), &buffer()), Format::Gltf));
    for (_, whole, format) in files {
        // Long files differ from short ones in texts that are skipped.
        let step = 1 + whole.len() / 1000;
        for at in (0..whole.len()).step_by(step) {
            check_reader(&whole[..at], format);
            let mut damaged = whole.clone();
            damaged[at] ^= [1, 0x10, 0x80][at / step % 3];
            check_reader(&damaged, format);
        }
    }
}

fn refused(text: &str, format: Format) -> String {
    parse_with_columns(text.as_bytes(), format)
        .unwrap_err()
        .to_string()
}

/// Text of a file, its wrong replacement, and part of the message.
#[test]
fn wrong_files_say_where_and_what() {
    let glb_text = gltf(r#","uri":"data:;base64,""#);
    for (text, format, old, new, hint) in [
        (
            VTK,
            Format::Vtk,
            "ASCII",
            "Ascii?",
            "line 3: expected ASCII or BINARY, found `Ascii?`",
        ),
        (
            VTK,
            Format::Vtk,
            "POLYDATA",
            "STRUCTURED_POINTS",
            "line 4: expected POLYDATA, UNSTRUCTURED_GRID or",
        ),
        (
            VTK,
            Format::Vtk,
            "0.1 0 0 1 0",
            "0.1 0 0 1 z",
            "line 6: expected a coordinate, found `z`",
        ),
        (
            VTK,
            Format::Vtk,
            "0.1 0 0 1 0",
            "0.1 0 0 inf 0",
            "line 6 (vertex 1): coordinate x is inf",
        ),
        (
            VTK,
            Format::Vtk,
            "3 0 2 1 3",
            "3 0 2 4 3",
            "line 11 (face 0): the face names vertex 4, but there are 4",
        ),
        (
            VTK,
            Format::Vtk,
            "c 1 5 float\n9",
            "c 1 4 float\n",
            "an array of CELL_DATA has 4 numbers, and its piece 5",
        ),
        (
            NEW_VTK,
            Format::Vtk,
            "3 5 5 7 5\n",
            "3 5 5 99 5\n",
            "expected the number of a type of cells, such as 5",
        ),
        (
            NEW_VTK,
            Format::Vtk,
            "0 2 5 8",
            "0 2 1 8",
            "(face 0): expected ends of polygons that rise",
        ),
        (
            VTU,
            Format::Vtu,
            "3 5 5 7 5",
            "3 5 5 99 5",
            "line 8: expected the number of a type of cells",
        ),
        (
            VTU,
            Format::Vtu,
            "UnstructuredGrid\"",
            "ImageData\"",
            "the type PolyData or UnstructuredGrid",
        ),
        (
            MSH_2,
            Format::Msh,
            "2.2 0",
            "1.0 0",
            "line 2: expected a version of 2, 4.0 or 4.1, found `1.0`",
        ),
        (
            MSH_2,
            Format::Msh,
            "7 9 3\n",
            "7 8 3\n",
            "(face 0): expected the tag of a node of the section $Nodes, found `8`",
        ),
        (
            MSH_2,
            Format::Msh,
            "13 2 2",
            "13 99 2",
            "expected a type of elements of Gmsh, such as 2",
        ),
        (
            MSH_2,
            Format::Msh,
            "$EndPhysicalNames",
            "",
            "line 4: expected the end of this section, found `$PhysicalNames`",
        ),
        (
            GIFTI,
            Format::Gifti,
            "0 2 1 0",
            "0 2 4 0",
            "line 8 (face 0): the face names vertex 4, but there are 4",
        ),
        (
            GIFTI,
            Format::Gifti,
            "POINTSET",
            "NONE",
            "declares no array of points (NIFTI_INTENT_POINTSET)",
        ),
        (
            GIFTI,
            Format::Gifti,
            "0.1 1 0",
            "0.1 1",
            "line 6: expected as many numbers as the dimensions",
        ),
        (
            GIFTI,
            Format::Gifti,
            "\"ASCII\"><Data>0.1",
            "\"X\"><Data>0.1",
            "the encoding ASCII, Base64Binary or",
        ),
        (
            &glb_text,
            Format::Gltf,
            "[0,2]}",
            "[0,0]}",
            "expected a tree, in which each node has one parent",
        ),
        (
            &glb_text,
            Format::Gltf,
            "[0,2]}",
            "[0,7]}",
            "expected the number of a node, found 7",
        ),
        (
            &glb_text,
            Format::Gltf,
            ";base64,",
            ";base64,AAAA",
            "expected a buffer as long as its accessors need, found",
        ),
        (
            &glb_text,
            Format::Gltf,
            "\"scene\":1",
            "\"scene\":",
            "line 1: expected the JSON of a glTF file, found",
        ),
        (
            &glb_text,
            Format::Gltf,
            "\"scene\":1",
            "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]",
            "found the extension KHR_draco_mesh_compression: save the file without it",
        ),
    ] {
        assert!(text.contains(old), "{old}");
        let found = refused(&text.replacen(old, new, 1), format);
        assert!(found.contains(hint), "{new}: {found}");
    }
    let error: ParseError = parse(&glb(&gltf(""), &buffer()[..50]), Format::Gltf).unwrap_err();
    assert!(
        error.to_string().contains("found a buffer of 50 bytes"),
        "{error}"
    );
}

/// Accessors without a buffer are zeros, of any number, and meshes may be placed many times.
#[test]
fn counts_of_gltf_are_limited() {
    let json = gltf("").replace("\"bufferView\":0,", "").replace(
        "\"count\":4,\"type\":\"VEC3",
        "\"count\":400000000,\"type\":\"VEC3",
    );
    let error = parse(&glb(&json, &buffer()), Format::Gltf)
        .unwrap_err()
        .to_string();
    assert!(error.contains("too many for a file of"), "{error}");
}

#[test]
fn columns_are_read_from_files() {
    let path = file("columns.vtk.gz", VTK.as_bytes());
    let (_, columns) = read_with_columns(&path).unwrap();
    assert_eq!(columns.len(), 2);
}
