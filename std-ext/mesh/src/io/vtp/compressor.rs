//! Compressors of VTK's blocks of data: zlib, LZ4 and LZMA.
//!
//! Sources: *VTK file formats* (docs.vtk.org, XML formats); the .xz file format 1.2.1 (tukaani.org), in which VTK
//! stores a block of LZMA.

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
                let mut data = after_xz_headers(block)?;
                // The decoder keeps what it has unpacked, so that its length is checked before.
                if unpacked_length(data)? > length {
                    return None;
                }
                let mut whole = Vec::new();
                lzma_rs::lzma2_decompress(&mut data, &mut whole).ok()?;
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

/// The length of data of LZMA2 that its chunks state; `None` if they do not end.
fn unpacked_length(mut data: &[u8]) -> Option<usize> {
    // Kinds of chunks. The lowest five bits of a packed one are the highest of its length.
    const END: u8 = 0;
    const STORED: [u8; 2] = [1, 2];
    const PACKED: u8 = 0x80;
    const WITH_PROPERTIES: u8 = 0xc0;
    let mut total = 0_usize;
    loop {
        let (&kind, rest) = data.split_first()?;
        let number = |at: usize| {
            Some(usize::from(u16::from_be_bytes(
                rest.get(at..at + 2)?.try_into().ok()?,
            )))
        };
        let (length, header, packed) = match kind {
            END => return Some(total),
            _ if STORED.contains(&kind) => (number(0)? + 1, 2, number(0)? + 1),
            PACKED.. => {
                let high = usize::from(kind & 0x1f) << 16;
                let properties = usize::from(kind >= WITH_PROPERTIES);
                (high + number(0)? + 1, 4 + properties, number(2)? + 1)
            }
            _ => return None,
        };
        total = total.checked_add(length)?;
        data = rest.get(header + packed..)?;
    }
}
