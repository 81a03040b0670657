//! Object File Format, text: `OFF`, then the counts `vertices faces edges`, then a vertex a line,
//! then a face a line as `n i j k …`, indices from 0. The counts may follow `OFF` on its line;
//! colours, normals and texture coordinates (`COFF`, `NOFF`, `STOFF`) are skipped.

use super::{Polygons, Source};
use crate::error::BuildError;
use crate::math::Vector;
use crate::medial::text::{Line, Lines, TextError, quote};

/// Largest number of corners of one face (a count), far above any real one.
const MAX_CORNERS: u64 = 1 << 20;

pub(super) fn read(source: &Source) -> Result<Polygons, BuildError> {
    let mut lines = Lines::new(source.bytes);
    read_lines(&mut lines).map_err(|e| source.text_error(e))
}

fn read_lines(lines: &mut Lines<&[u8]>) -> Result<Polygons, TextError> {
    let first = some_line(lines, "the keyword `OFF`")?;
    let (keyword, rest) = first
        .text
        .split_at(first.text.find("OFF").map_or(0, |at| at + 3));
    if !matches!(
        keyword,
        "OFF" | "COFF" | "NOFF" | "CNOFF" | "STOFF" | "STNOFF" | "STCNOFF"
    ) {
        let found = quote(first.text);
        return Err(first.error(format!("expected the keyword `OFF`, found {found}")));
    }
    let rest = rest.trim();
    let (vertices, faces) = if rest.is_empty() {
        let line = some_line(lines, "the counts")?;
        counts(&line, line.text)?
    } else {
        counts(&first, rest)?
    };
    let mut polygons = Polygons::default();
    for index in 0..vertices {
        let line = some_line(lines, &format!("vertex {index} of {vertices}"))?;
        let mut tokens = line.text.split_whitespace();
        let mut coordinate = |what| line.finite(&mut tokens, what);
        let v = Vector::new(coordinate("x")?, coordinate("y")?, coordinate("z")?);
        polygons.vertices.push(v);
    }
    for index in 0..faces {
        let line = some_line(lines, &format!("face {index} of {faces}"))?;
        let mut tokens = line.text.split_whitespace();
        let corners: u64 = line.parse(&mut tokens, "the number of corners")?;
        // A face of one or two corners is a point or a segment, which has no surface.
        if corners > MAX_CORNERS {
            return Err(line.error(format!("a face of {corners} corners")));
        }
        for _ in 0..corners {
            let vertex = line.parse::<u32>(&mut tokens, "a vertex index")?;
            polygons.corners.push(vertex.into());
        }
        polygons.close_polygon(Some(line.number));
    }
    Ok(polygons)
}

fn some_line<'a>(lines: &'a mut Lines<&[u8]>, what: &str) -> Result<Line<'a>, TextError> {
    let end = lines.number().max(1);
    lines.next_line()?.ok_or_else(|| TextError::Syntax {
        line: end,
        message: format!("the file ends before {what}"),
    })
}

fn counts(line: &Line, text: &str) -> Result<(u32, u32), TextError> {
    let mut tokens = text.split_whitespace();
    let vertices = line.parse(&mut tokens, "the number of vertices")?;
    let faces = line.parse(&mut tokens, "the number of faces")?;
    Ok((vertices, faces))
}
