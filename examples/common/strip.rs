//! Pictures tiled into a strip with labels, written as PNG.

use super::font::glyph;
use super::render::Image;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

/// Pixels between two tiles.
const GAP: usize = 4;
const GAP_COLOR: [u8; 3] = [250, 250, 250];

/// Tiles pictures of one size: each inner list is a row.
pub fn tile(rows: &[Vec<Image>]) -> Image {
    let (width, height) = (rows[0][0].width, rows[0][0].height);
    let columns = rows[0].len();
    let mut strip = Image::filled(
        columns * (width + GAP) - GAP,
        rows.len() * (height + GAP) - GAP,
        GAP_COLOR,
    );
    for (r, row) in rows.iter().enumerate() {
        for (c, image) in row.iter().enumerate() {
            for y in 0..height {
                let start = (r * (height + GAP) + y) * strip.width + c * (width + GAP);
                let source = &image.pixels[y * width..][..width];
                strip.pixels[start..][..width].copy_from_slice(source);
            }
        }
    }
    strip
}

impl Image {
    /// Writes a label on a bright plate, its upper left corner at `x`, `y`, each dot of the font
    /// `dot` pixels wide.
    pub fn label(&mut self, text: &str, [x, y]: [usize; 2], dot: usize) {
        const INK: [u8; 3] = [28, 34, 44];
        let plate = [(text.chars().count() * 6 + 1) * dot, 9 * dot];
        for k in 0..plate[0] * plate[1] {
            self.brighten([x + k % plate[0] - dot, y + k / plate[0] - dot]);
        }
        for (place, character) in text.chars().enumerate() {
            for (column, bits) in glyph(character).unwrap_or_default().into_iter().enumerate() {
                for row in (0..7).filter(|row| bits >> row & 1 == 1) {
                    let (left, top) = (x + (place * 6 + column) * dot, y + row * dot);
                    for k in 0..dot * dot {
                        self.put([left + k % dot, top + k / dot], INK);
                    }
                }
            }
        }
    }

    /// Goes most of the way to white.
    fn brighten(&mut self, [x, y]: [usize; 2]) {
        if x < self.width && y < self.height {
            let pixel = &mut self.pixels[y * self.width + x];
            *pixel = pixel.map(|c| 255 - (255 - c) / 4);
        }
    }

    fn put(&mut self, [x, y]: [usize; 2], color: [u8; 3]) {
        if x < self.width && y < self.height {
            self.pixels[y * self.width + x] = color;
        }
    }

    /// Writes the picture as PNG, and the folders above it where there are none.
    pub fn save(&self, path: &Path) -> Result<(), String> {
        let saved = self.write(path);
        saved.map_err(|e| format!("cannot write {}: {e}", path.display()))
    }

    fn write(&self, path: &Path) -> io::Result<()> {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        let file = BufWriter::new(File::create(path)?);
        let mut encoder = png::Encoder::new(file, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_compression(png::Compression::High);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(self.pixels.as_flattened())?;
        Ok(())
    }
}
