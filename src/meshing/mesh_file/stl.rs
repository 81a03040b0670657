//! STL: triangles without indices, as text or binary.
//!
//! Both may begin with `solid`. A file is binary if its length is what its count says, or if its
//! beginning holds a byte that no text holds; text if it begins with `solid`; else binary.

use super::{Polygons, Source};
use crate::error::BuildError;
use crate::math::Vector;
use crate::medial::text::{Line, Lines, TextError, quote};

/// Bytes before the count: a free header.
const HEADER: usize = 80;
/// Bytes before the first triangle: header and count (u32, little-endian as all numbers).
const PREAMBLE: usize = HEADER + 4;
/// Bytes of a triangle: normal, three corners (12 × f32), attribute (u16).
const TRIANGLE: usize = 50;
/// Bytes looked at to tell text from binary.
const PROBE: usize = 512;

pub(super) fn read(source: &Source) -> Result<Polygons, BuildError> {
    let bytes = source.bytes;
    let exact = binary_count(bytes).is_some_and(|count| count.1 == Some(bytes.len()));
    let probe = &bytes[..bytes.len().min(PROBE)];
    let word = probe.trim_ascii_start();
    let solid = word.len() >= 5 && word[..5].eq_ignore_ascii_case(b"solid");
    if solid && !exact && !probe.contains(&0) {
        let mut lines = Lines::new(bytes);
        return read_text(&mut lines).map_err(|e| source.text_error(e));
    }
    read_binary(source)
}

/// The triangles announced, and the length that a file of so many has.
fn binary_count(bytes: &[u8]) -> Option<(usize, Option<usize>)> {
    let field: [u8; 4] = bytes.get(HEADER..PREAMBLE)?.try_into().ok()?;
    let count = u32::from_le_bytes(field) as usize;
    let length = count.checked_mul(TRIANGLE);
    Some((count, length.and_then(|l| l.checked_add(PREAMBLE))))
}

fn read_binary(source: &Source) -> Result<Polygons, BuildError> {
    let bytes = source.bytes;
    let Some((count, length)) = binary_count(bytes) else {
        return Err(source.at_byte(
            bytes.len(),
            "the file ends before the count of triangles, and is no text that begins with `solid`",
        ));
    };
    if length.is_none_or(|length| length > bytes.len()) {
        let complete = (bytes.len() - PREAMBLE) / TRIANGLE;
        return Err(source.at_byte(
            bytes.len(),
            format!("the file ends after {complete} of {count} triangles"),
        ));
    }
    let mut polygons = Polygons::default();
    for triangle in bytes[PREAMBLE..].chunks_exact(TRIANGLE).take(count) {
        let number = |k: usize| {
            let field = [0, 1, 2, 3].map(|b| triangle[4 * k + b]);
            f32::from_le_bytes(field)
        };
        for corner in [3, 6, 9] {
            let v = Vector::new(number(corner), number(corner + 1), number(corner + 2));
            push_corner(&mut polygons, v);
        }
        polygons.close_polygon(None);
    }
    Ok(polygons)
}

fn push_corner(polygons: &mut Polygons, v: Vector) {
    polygons.corners.push(polygons.vertices.len() as u64);
    polygons.vertices.push(v);
}

fn read_text(lines: &mut Lines<&[u8]>) -> Result<Polygons, TextError> {
    let mut polygons = Polygons::default();
    let mut solid = false;
    while let Some(line) = lines.next_line()? {
        let keyword = line.text.split_whitespace().next().unwrap_or_default();
        match keyword.to_ascii_lowercase().as_str() {
            "solid" if !solid => solid = true,
            "endsolid" if solid => solid = false,
            "facet" if solid => read_facet(lines, &mut polygons)?,
            _ => {
                let expected = if solid {
                    "facet` or `endsolid"
                } else {
                    "solid"
                };
                let found = quote(line.text);
                return Err(line.error(format!("expected `{expected}`, found {found}")));
            }
        }
    }
    if solid {
        return Err(ends_before(lines, "endsolid"));
    }
    Ok(polygons)
}

/// The lines of a facet after its first: the loop of three corners and both ends.
fn read_facet(lines: &mut Lines<&[u8]>, polygons: &mut Polygons) -> Result<(), TextError> {
    let first = lines.number();
    expect(lines, "outer")?;
    for _ in 0..3 {
        let line = expect(lines, "vertex")?;
        let mut tokens = line.text.split_whitespace().skip(1);
        let mut coordinate = |what| line.finite(&mut tokens, what);
        let v = Vector::new(coordinate("x")?, coordinate("y")?, coordinate("z")?);
        push_corner(polygons, v);
    }
    expect(lines, "endloop")?;
    expect(lines, "endfacet")?;
    polygons.close_polygon(Some(first));
    Ok(())
}

fn expect<'a>(lines: &'a mut Lines<&[u8]>, keyword: &str) -> Result<Line<'a>, TextError> {
    let missing = ends_before(lines, keyword);
    let line = lines.next_line()?.ok_or(missing)?;
    let found = line.text.split_whitespace().next().unwrap_or_default();
    if !found.eq_ignore_ascii_case(keyword) {
        let found = quote(line.text);
        return Err(line.error(format!("expected `{keyword}`, found {found}")));
    }
    Ok(line)
}

fn ends_before(lines: &Lines<&[u8]>, keyword: &str) -> TextError {
    TextError::Syntax {
        line: lines.number(),
        message: format!("the file ends before `{keyword}`"),
    }
}
