//! Files compressed by gzip.

use super::file;
use helfrich_std::io::{Format, parse, read, read_soup};
use miniz_oxide::deflate::compress_to_vec;

/// A member with these flags and this text behind its fixed header.
fn member(flags: u8, extra: &[u8], content: &[u8], checksum: u32) -> Vec<u8> {
    [
        &[0x1f, 0x8b, 8, flags, 0, 0, 0, 0, 0, 255],
        extra,
        &compress_to_vec(content, 6),
        &checksum.to_le_bytes(),
        &(content.len() as u32).to_le_bytes(),
    ]
    .concat()
}

/// The checksums of these texts are from Python's `zlib.crc32`.
const OFF: [(&str, u32); 2] = [
    ("OFF\n3 1 0\n0 0 0\n1 0 0\n", 0x210b_08f2),
    ("0 1 0\n3 0 1 2\n", 0x41e5_aa7c),
];

#[test]
fn files_of_every_format_may_be_compressed() {
    let parts = OFF.map(|(text, checksum)| (text.as_bytes(), checksum));
    let whole = parse(&[parts[0].0, parts[1].0].concat(), Format::Off).unwrap();
    let named = member(
        8 | 4 | 16 | 2,
        b"\x02\0xya.off\0note\0\x12\x34",
        parts[0].0,
        parts[0].1,
    );
    let two = [named, member(0, b"", parts[1].0, parts[1].1), vec![0; 20]].concat();
    assert_eq!(parse(&two, Format::Off).unwrap(), whole);
    for name in ["a.off.gz", "a.OFF.GZ", "a.gz", "compressed", "really.off"] {
        assert_eq!(read(&file(name, &two)).unwrap(), whole, "{name}");
        let (soup, _) = read_soup(&file(name, &two)).unwrap();
        assert_eq!(soup.triangles, whole.mesh.triangles(), "{name}");
    }
    assert_eq!(
        read(&file("plain.off.gz", &[parts[0].0, parts[1].0].concat())).unwrap(),
        whole
    );
}

/// A file that is truncated anywhere, or of which a bit is changed, is refused or still the same mesh.
#[test]
fn damaged_files_are_refused() {
    let (text, checksum) = ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", 0xa514_1502);
    let good = member(8, b"name\0", text.as_bytes(), checksum);
    let whole = parse(&good, Format::Off).unwrap();
    for length in 1..good.len() {
        assert!(parse(&good[..length], Format::Off).is_err(), "{length}");
        for bit in 0..8 {
            let mut damaged = good.clone();
            damaged[length] ^= 1 << bit;
            let result = parse(&damaged, Format::Off);
            assert!(result.is_err() || result == Ok(whole.clone()));
        }
    }
    let mut other = good.clone();
    let end = other.len();
    other[end - 8] ^= 1;
    let error = parse(&other, Format::Off).unwrap_err().to_string();
    assert_eq!(
        error,
        "byte 0: expected data with the checksum of the gzip member, found damaged or truncated data"
    );
    other = [&good[..], b"more"].concat();
    let error = parse(&other, Format::Off).unwrap_err().to_string();
    assert!(
        error.contains("expected the end of the file or another gzip member"),
        "{error}"
    );
}

/// Half a megabyte that would become 512 MiB is not unpacked.
#[test]
fn bombs_are_refused() {
    let zeros = vec![b'\n'; 1 << 20];
    let one = member(0, b"", &zeros, 0);
    let error = parse(&one, Format::Off).unwrap_err().to_string();
    assert!(error.contains("checksum"), "{error}");
    let bomb = member(0, b"", &zeros.repeat(512), 0);
    assert!(bomb.len() < 1 << 20);
    let error = parse(&bomb, Format::Off).unwrap_err().to_string();
    assert!(error.contains("compressed beyond reason"), "{error}");
}
