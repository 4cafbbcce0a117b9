//! Canvases written as PNG files.

use super::Canvas;
use helfrich_mesh::io::replace_file;
use std::io::{self, Write};
use std::path::Path;

impl Canvas {
    /// Writes a PNG file, completely or not at all. Needs the feature `png`.
    ///
    /// # Errors
    /// Any error of the operating system from the folder, the file or the disk.
    pub fn write_png(&self, path: &Path) -> io::Result<()> {
        replace_file(path, |out| self.encode_png(out))
    }

    /// Writes the canvas in the PNG format, eight bits per colour. Needs the feature `png`.
    ///
    /// # Errors
    /// Any error of `out`.
    pub fn encode_png(&self, out: &mut dyn Write) -> io::Result<()> {
        let [width, height] = self.size();
        let mut encoder = png::Encoder::new(out, width as u32, height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        // Runs draw many pictures: this takes a small part of the time of the default, level 6.
        encoder.set_deflate_compression(png::DeflateCompression::Level(1));
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.rgb())?;
        writer.finish()?;
        Ok(())
    }
}
