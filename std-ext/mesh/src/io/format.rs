//! The formats of mesh files: the endings of their names, and the first bytes that identify them.

use std::path::Path;

use super::{gltf, legacy, msh, off, text, without_mark, zip};

/// The formats that can be read; [`Format::writable`] lists the endings of those that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Wavefront OBJ: `v` and `f` statements. Everything else is skipped, including free-form surfaces.
    Obj,
    /// Object File Format, text, three coordinates per vertex: `OFF`, and the variants with normals,
    /// colours or texture coordinates behind the position (`COFF`, `NOFF`, `STOFF`, …).
    Off,
    /// Stereolithography, ASCII or binary. Corners with the same coordinates, bit for bit, become
    /// one vertex, numbered in the order in which they first appear; −0 counts as 0.
    Stl,
    /// Polygon File Format (Stanford), ASCII or binary, little or big endian.
    Ply,
    /// Polygons and strips of VTK's PolyData in XML: as text, in base64 or appended, raw or compressed by
    /// zlib, LZ4 or LZMA, with pieces one after another. Lines and single vertices are skipped. Pieces may be files
    /// beside it: those of a `.pvtp` are joined where they have the same points, and cells that are copies of those of
    /// other pieces are skipped; the blocks of a `.vtm` stay apart.
    Vtp,
    /// VTK's UnstructuredGrid in XML, stored as [`Format::Vtp`]: its triangles, quadrilaterals, polygons and strips,
    /// and those of higher order by their corners; of solid cells without such faces their outer surface. Lines and
    /// points are skipped, and solid cells beside faces.
    Vtu,
    /// VTK's legacy files, ASCII or binary: the faces of PolyData and UnstructuredGrid, as in the XML formats, and
    /// StructuredGrid: its one layer, or the outer surface of many.
    Vtk,
    /// glTF 2.0, text or binary: the triangles of all nodes of the scene. Buffers may be within the file, or files in
    /// the same folder. Coordinates have 32 bits. Only `.glb` is written.
    Gltf,
    /// Meshes of Gmsh, versions 2 and 4, ASCII or binary: triangles and quadrilaterals, and those of higher order by
    /// their corners; of solid cells alone their outer surface. Lines and points are skipped, and solid cells beside
    /// faces.
    Msh,
    /// GIFTI surfaces of brains, as text or in base64, compressed or not, in the coordinates of the file.
    Gifti,
    /// 3MF models for printers: the items to be built, placed as their transformations say.
    ThreeMf,
}

/// Bytes in which the first tag of an XML file is searched for.
const START: usize = 1000;

/// Endings of names with their formats, and whether files with this ending are written.
const ENDINGS: [(&str, Format, bool); 15] = [
    ("obj", Format::Obj, true),
    ("off", Format::Off, true),
    ("stl", Format::Stl, true),
    ("ply", Format::Ply, true),
    ("vtp", Format::Vtp, true),
    ("vtu", Format::Vtu, false),
    ("pvtp", Format::Vtp, false),
    ("pvtu", Format::Vtu, false),
    ("vtm", Format::Vtp, false),
    ("vtk", Format::Vtk, false),
    ("glb", Format::Gltf, true),
    ("gltf", Format::Gltf, false),
    ("msh", Format::Msh, false),
    ("gii", Format::Gifti, false),
    ("3mf", Format::ThreeMf, false),
];

impl Format {
    /// The format for the ending of a file name, in upper or lower case. An ending `.gz` is ignored: files of every
    /// format may be compressed by gzip.
    pub fn from_extension(path: &Path) -> Option<Self> {
        let ending = |path: &Path| Some(path.extension()?.to_str()?.to_ascii_lowercase());
        let own = ending(path)?;
        let own = match own.as_str() {
            "gz" => ending(Path::new(path.file_stem()?))?,
            _ => own,
        };
        let mut endings = ENDINGS.iter();
        endings.find_map(|&(ending, format, _)| (ending == own).then_some(format))
    }

    /// The format of a file to be written, for the ending of its name.
    pub(super) fn to_write(path: &Path) -> Option<Self> {
        let own = path.extension()?.to_str()?.to_ascii_lowercase();
        let mut endings = ENDINGS.iter();
        endings.find_map(|&(ending, format, written)| (written && ending == own).then_some(format))
    }

    /// The format for the first bytes of a file. OBJ and binary STL have none of their own.
    pub fn from_content(bytes: &[u8]) -> Option<Self> {
        let bytes = without_mark(bytes);
        if legacy::is_header(bytes) {
            return Some(Self::Vtk);
        }
        if bytes.starts_with(gltf::MAGIC) || bytes.trim_ascii_start().starts_with(b"{") {
            return Some(Self::Gltf);
        }
        if bytes.starts_with(zip::MAGIC) {
            return Some(Self::ThreeMf);
        }
        match text::Text::new(bytes).statement()? {
            b"ply" => Some(Self::Ply),
            b"<?xml" | b"<!DOCTYPE" | b"<GIFTI" | b"<VTKFile" => {
                let start = &bytes[..bytes.len().min(START)];
                let is_gifti = start.windows(6).any(|here| here == b"<GIFTI");
                Some(if is_gifti { Self::Gifti } else { Self::Vtp })
            }
            msh::HEADER => Some(Self::Msh),
            b"solid" => Some(Self::Stl),
            header if off::is_header(header) => Some(Self::Off),
            _ => None,
        }
    }

    /// The endings of files that can be read, in lower case, without dots.
    pub fn endings() -> impl Iterator<Item = &'static str> {
        ENDINGS.iter().map(|&(ending, ..)| ending)
    }

    /// The endings of files that can be written, in lower case, without dots.
    pub fn written_endings() -> impl Iterator<Item = &'static str> {
        let written = ENDINGS.iter().filter(|&&(.., written)| written);
        written.map(|&(ending, ..)| ending)
    }

    /// The endings of files that can be read, as words: `.obj, .off and .stl`.
    pub fn readable() -> String {
        listed(Self::endings())
    }

    /// The endings of files that can be written, as words: `.obj, .off and .stl`.
    pub fn writable() -> String {
        listed(Self::written_endings())
    }
}

fn listed<'a>(endings: impl Iterator<Item = &'a str>) -> String {
    let mut endings = Vec::from_iter(endings.map(|ending| format!(".{ending}")));
    let last = endings.pop().unwrap_or_default();
    format!("{} and {last}", endings.join(", "))
}
