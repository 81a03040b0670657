//! PLY, text or binary, through `ply-rs-bw`: elements `vertex` (`x`, `y`, `z`) and `face`
//! (`vertex_indices` or `vertex_index`); other elements and properties are skipped.
//!
//! The crate caps what it reserves, but an element without properties takes no bytes and is
//! "read" as often as its count says. So each count is checked against the bytes that are left.

use super::{Polygons, Source};
use crate::error::BuildError;
use crate::math::Vector;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{Encoding, Property, PropertyAccess, PropertyAccessResult};

/// Longest message taken over from the crate, in characters.
const MESSAGE: usize = 240;

pub(super) fn read(source: &Source) -> Result<Polygons, BuildError> {
    let mut reader = Reader::new(source.bytes);
    let header = Parser::<Skipped>::new()
        .read_header(&mut reader)
        .map_err(|e| fault(source, e, None))?;
    let binary = header.encoding != Encoding::Ascii;
    let mut polygons = Polygons::default();
    for (name, element) in &header.elements {
        let left = reader.get_ref().len();
        // A property takes at least a byte, a line its line break.
        if element.count > left || (element.properties.is_empty() && element.count > 0) {
            let (count, properties) = (element.count, element.properties.len());
            return Err(source.at_byte(
                source.bytes.len() - left,
                format!("{count} `{name}` elements of {properties} properties in {left} bytes"),
            ));
        }
        macro_rules! elements {
            ($kind:ty) => {{
                let read = Parser::<$kind>::new();
                let found = read.read_payload_for_element(&mut reader, element, &header);
                let at = source.bytes.len() - reader.get_ref().len();
                found.map_err(|e| fault(source, e, binary.then_some(at)))?
            }};
        }
        match name.as_str() {
            "vertex" => {
                for (index, vertex) in elements!(Vertex).into_iter().enumerate() {
                    let [Some(x), Some(y), Some(z)] = vertex.0 else {
                        let at = source.bytes.len() - left;
                        let message = format!("vertex {index} lacks one of x, y, z");
                        return Err(source.at_byte(at, message));
                    };
                    polygons.vertices.push(Vector::new(x, y, z));
                }
            }
            "face" => {
                for (index, face) in elements!(Face).into_iter().enumerate() {
                    let Some(corners) = face.0 else {
                        let at = source.bytes.len() - left;
                        let message = format!("face {index} has no list of vertex indices ≥ 0");
                        return Err(source.at_byte(at, message));
                    };
                    polygons.corners.extend(corners.into_iter().map(u64::from));
                    polygons.close_polygon(None);
                }
            }
            _ => drop(elements!(Skipped)),
        }
    }
    Ok(polygons)
}

/// The crate's error on one line, with its line, or the byte where a binary file failed.
fn fault(source: &Source, error: ParseError, byte: Option<usize>) -> BuildError {
    let text = error.to_string();
    let prefix = error
        .line()
        .map_or(String::new(), |l| format!("Line {l}: "));
    let text = text.strip_prefix(&prefix).unwrap_or(&text);
    let words: Vec<&str> = text.split_whitespace().collect();
    let printable = words
        .join(" ")
        .chars()
        .filter(|c| !c.is_control())
        .take(MESSAGE)
        .collect::<String>();
    match (byte, error.line()) {
        (Some(byte), _) => source.at_byte(byte, printable),
        (None, Some(line)) => source.at_line(line, printable),
        (None, None) => source.at_line(1, printable),
    }
}

/// `x`, `y`, `z`, as far as given.
struct Vertex([Option<f32>; 3]);

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self([None; 3])
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let axis = match name {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            _ => return PropertyAccessResult::Ignored,
        };
        self.0[axis] = value.to_f32_lossy();
        PropertyAccessResult::Set
    }
}

/// Corners, if given as integers ≥ 0.
struct Face(Option<Vec<u32>>);

impl PropertyAccess for Face {
    fn new() -> Self {
        Self(None)
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if !matches!(name, "vertex_indices" | "vertex_index") {
            return PropertyAccessResult::Ignored;
        }
        self.0 = value.to_u32_list();
        PropertyAccessResult::Set
    }
}

/// An element, or a header, of which nothing is kept.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}
