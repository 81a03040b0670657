//! Moving pictures, written as animated PNG: after the first frame each holds what changed alone.

use super::render::Image;
use png::{BitDepth, BlendOp, ColorType, Compression, Encoder, EncodingError};
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

/// A channel of a pixel that changes by no more than this is left as it is.
const UNSEEN: u8 = 5;

/// Writes frames of one size as an animated PNG that repeats for ever, so many frames a second, and the
/// folders above it where there are none.
pub fn save_animation(frames: &[Image], per_second: u16, path: &Path) -> Result<(), String> {
    let saved = write(frames, per_second, path);
    saved.map_err(|e| format!("cannot write {}: {e}", path.display()))
}

fn write(frames: &[Image], per_second: u16, path: &Path) -> Result<(), EncodingError> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let Some(first) = frames.first() else {
        return Ok(());
    };
    let file = BufWriter::new(File::create(path)?);
    let mut encoder = Encoder::new(file, first.width as u32, first.height as u32);
    encoder.set_color(ColorType::Rgba);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::High);
    encoder.set_animated(frames.len() as u32, 0)?;
    encoder.set_frame_delay(1, per_second)?;
    encoder.set_blend_op(BlendOp::Over)?;
    let mut writer = encoder.write_header()?;
    let mut shown = None;
    for frame in frames {
        let part = Changed::new(&mut shown, frame);
        writer.reset_frame_position()?;
        writer.set_frame_dimension(part.width, part.height)?;
        writer.set_frame_position(part.left, part.top)?;
        writer.write_image_data(part.pixels.as_flattened())?;
    }
    writer.finish()
}

/// The rectangle of a frame that holds all pixels that changed; the others in it are transparent.
struct Changed {
    left: u32,
    top: u32,
    width: u32,
    height: u32,
    pixels: Vec<[u8; 4]>,
}

impl Changed {
    /// What has to be drawn over `shown`, which then is what one sees.
    fn new(shown: &mut Option<Image>, frame: &Image) -> Self {
        let differs: Vec<bool> = (0..frame.pixels.len())
            .map(|pixel| {
                let seen = shown.as_ref().map(|s| s.pixels[pixel]);
                seen.is_none_or(|seen| {
                    let mut channels = seen.iter().zip(&frame.pixels[pixel]);
                    channels.any(|(a, b)| a.abs_diff(*b) > UNSEEN)
                })
            })
            .collect();
        let shown = shown.get_or_insert_with(|| frame.clone());
        let (mut columns, mut rows) = ([frame.width - 1, 0], [frame.height - 1, 0]);
        for pixel in (0..frame.pixels.len()).filter(|pixel| differs[*pixel]) {
            shown.pixels[pixel] = frame.pixels[pixel];
            let (x, y) = (pixel % frame.width, pixel / frame.width);
            columns = [columns[0].min(x), columns[1].max(x)];
            rows = [rows[0].min(y), rows[1].max(y)];
        }
        // Nothing changed: one pixel, for a frame has to have some.
        let [left, right] = [columns[0], columns[1].max(columns[0])];
        let [top, bottom] = [rows[0], rows[1].max(rows[0])];
        let pixel = |x: usize, y: usize| {
            let [r, g, b] = frame.pixels[y * frame.width + x];
            match differs[y * frame.width + x] {
                true => [r, g, b, 255],
                false => [0; 4],
            }
        };
        let row = |y: usize| (left..=right).map(move |x| pixel(x, y));
        Self {
            left: left as u32,
            top: top as u32,
            width: (right - left + 1) as u32,
            height: (bottom - top + 1) as u32,
            pixels: (top..=bottom).flat_map(row).collect(),
        }
    }
}
