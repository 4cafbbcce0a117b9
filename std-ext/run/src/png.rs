//! PNG files, which the feature `pictures` enables.

use crate::picture::Canvas;
use std::io::{self, Write};
use std::path::Path;

/// Whether PNG files can be written.
pub const IS_ENABLED: bool = cfg!(feature = "pictures");

/// Writes a PNG file, completely or not at all.
pub fn write(canvas: &Canvas, path: &Path) -> io::Result<()> {
    crate::io::replace_file(path, |out| encode(canvas, out))
}

#[cfg(feature = "pictures")]
pub fn encode(canvas: &Canvas, out: &mut dyn Write) -> io::Result<()> {
    canvas.encode_png(out)
}

#[cfg(not(feature = "pictures"))]
pub fn encode(_: &Canvas, _: &mut dyn Write) -> io::Result<()> {
    Err(io::Error::new(
        io::ErrorKind::Unsupported,
        "PNG files cannot be written: enable the feature `pictures` of helfrich-std",
    ))
}
