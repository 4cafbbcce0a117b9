//! Files that are much longer in memory than on disk.

use helfrich_std::io::{Format, parse, parse_with_columns};

/// A VTP file with these pieces and this raw data at its end.
fn vtp(attributes: &str, pieces: &str, data: &[u8]) -> Vec<u8> {
    let start = format!(
        "<VTKFile type=\"PolyData\" header_type=\"UInt32\" {attributes}><PolyData>{pieces}</PolyData>\
         <AppendedData encoding=\"raw\">_"
    );
    [start.as_bytes(), data, b"</AppendedData></VTKFile>"].concat()
}

/// A piece of one triangle, whose `points` are in the first array at the end of the file.
fn piece(points: usize, kind: &str) -> String {
    format!(
        "<Piece NumberOfPoints=\"{points}\" NumberOfPolys=\"1\">\
         <Points><DataArray type=\"{kind}\" format=\"appended\" offset=\"0\"/></Points>\
         <Polys><DataArray type=\"Int8\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray>\
         <DataArray type=\"Int8\" Name=\"offsets\" format=\"ascii\">3</DataArray></Polys></Piece>"
    )
}

fn with_length(data: &[u8]) -> Vec<u8> {
    [&(data.len() as u32).to_le_bytes(), data].concat()
}

/// Points of one byte for each coordinate.
fn points(count: usize) -> Vec<u8> {
    with_length(&Vec::from_iter((0..3 * count).map(|k| (k * k % 127) as u8)))
}

/// The message and its limit in bytes.
fn refused(bytes: &[u8]) -> (String, usize) {
    let error = parse(bytes, Format::Vtp).unwrap_err().to_string();
    let limit = error.split_whitespace().find_map(|word| word.parse().ok());
    (error.clone(), limit.unwrap_or_else(|| panic!("{error}")))
}

/// Pieces may share an array, but not until 400 kB are 8 GB.
#[test]
fn an_array_that_many_pieces_name_is_read_as_often_as_memory_allows() {
    let data = points(100_000);
    let file = |pieces: usize| vtp("", &piece(100_000, "Int8").repeat(pieces), &data);
    assert_eq!(
        parse(&file(3), Format::Vtp).unwrap().positions.len(),
        300_000
    );
    let many = file(1500);
    let (error, limit) = refused(&many);
    let what = format!(
        "too many for a file of {} bytes: they are named by",
        many.len()
    );
    assert!(error.contains(&what), "{error}");
    assert!(limit == (1 << 26) + 16 * many.len(), "{error}");
}

/// A compressed block is not unpacked if its stated length is out of proportion. The one here is damaged, which
/// would be the message if it were unpacked.
#[test]
fn compressed_data_are_unpacked_in_proportion_to_the_file() {
    let compressed = "compressor=\"vtkZLibDataCompressor\"";
    let block = |length: u32| {
        let header = [1, length, 0, 16].map(u32::to_le_bytes);
        [header.as_flattened(), &[0x55; 16]].concat()
    };
    let file = |length: u32| vtp(compressed, &piece(3, "Float32"), &block(length));
    let (error, limit) = refused(&file(1 << 30));
    assert!(error.contains("compressed beyond reason"), "{error}");
    assert!(limit == (1 << 26) + 256 * file(1 << 30).len(), "{error}");
    let error = parse(&file(1 << 20), Format::Vtp).unwrap_err().to_string();
    assert!(error.contains("found damaged ones"), "{error}");
}

/// Columns take memory from the same budget; a usual number of them fits.
#[test]
fn columns_count() {
    let data = [points(100_000), with_length(&vec![7; 100_000])].concat();
    let file = |columns: usize| {
        let names = 0..columns;
        let columns = names.map(|k| {
            format!(
                "<DataArray type=\"UInt8\" Name=\"c{k}\" format=\"appended\" offset=\"300004\"/>"
            )
        });
        let columns = format!("<PointData>{}</PointData>", String::from_iter(columns));
        let piece = piece(100_000, "Int8").replace("<Points>", &(columns + "<Points>"));
        vtp("", &piece, &data)
    };
    let (_, columns) = parse_with_columns(&file(8), Format::Vtp).unwrap();
    assert_eq!(columns.len(), 8);
    assert!(
        columns
            .iter()
            .all(|column| column.values == vec![7.0; 100_000])
    );
    let error = parse_with_columns(&file(200), Format::Vtp)
        .unwrap_err()
        .to_string();
    assert!(error.contains("too many for a file of"), "{error}");
}
