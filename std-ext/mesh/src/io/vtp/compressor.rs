//! Compressors of VTK's blocks of data: zlib, LZ4 and LZMA.
//!
//! Sources: *VTK file formats* (docs.vtk.org, XML formats); the .xz file format 1.2.1 (tukaani.org), in which VTK
//! stores a block of LZMA.

use std::io::Read;

use lzma_rust2::Lzma2Reader;
use miniz_oxide::inflate::decompress_to_vec_zlib_with_limit;

/// A compressor of blocks.
#[derive(Clone, Copy, Debug)]
pub(super) enum Compressor {
    Zlib,
    Lz4,
    Lzma,
}

impl Compressor {
    /// The compressor with a name of VTK.
    pub(super) fn named(name: &str) -> Option<Self> {
        Some(match name {
            "vtkZLibDataCompressor" => Self::Zlib,
            "vtkLZ4DataCompressor" => Self::Lz4,
            "vtkLZMADataCompressor" => Self::Lzma,
            _ => return None,
        })
    }

    /// Unpacks a block to at most this length; `None` if it is damaged.
    pub(super) fn unpacked(self, block: &[u8], length: usize) -> Option<Vec<u8>> {
        match self {
            Self::Zlib => decompress_to_vec_zlib_with_limit(block, length).ok(),
            Self::Lz4 => {
                let mut whole = vec![0; length];
                let written = lz4_flex::block::decompress_into(block, &mut whole).ok()?;
                whole.truncate(written);
                Some(whole)
            }
            Self::Lzma => {
                let data = after_xz_headers(block)?;
                // No distance in the data is longer than the data, whatever the header says.
                let reader = Lzma2Reader::new(data, u32::try_from(length).ok()?, None);
                let mut whole = Vec::new();
                let limit = length as u64 + 1;
                reader.take(limit).read_to_end(&mut whole).ok()?;
                Some(whole)
            }
        }
    }
}

/// The data of the first block of an .xz file, if they are compressed by LZMA2 alone.
fn after_xz_headers(file: &[u8]) -> Option<&[u8]> {
    const STREAM: usize = 12;
    /// Flags of a block: its number of filters less one.
    const FILTERS: u8 = 3;
    const LENGTHS: [u8; 2] = [0x40, 0x80];
    const LZMA2: u8 = 0x21;
    let block = file
        .starts_with(b"\xfd7zXZ\0")
        .then(|| file.get(STREAM..))??;
    let &[size, flags, ref fields @ ..] = block else {
        return None;
    };
    let mut fields = fields;
    // Lengths, of seven bits a byte, the last without the eighth.
    for flag in LENGTHS {
        if flags & flag != 0 {
            let end = fields.iter().position(|byte| byte & 0x80 == 0)?;
            fields = &fields[end + 1..];
        }
    }
    let is_plain = flags & FILTERS == 0 && fields.first() == Some(&LZMA2);
    is_plain.then(|| block.get(4 * (usize::from(size) + 1)..))?
}
