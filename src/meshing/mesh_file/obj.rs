//! Wavefront OBJ: `v x y z` and `f a b c …`, indices from 1, or from −1 backwards. A corner may
//! carry texture and normal indices (`a/t/n`), a vertex a weight or a colour: skipped.

use super::{Polygons, Source};
use crate::error::BuildError;
use crate::math::Vector;
use crate::medial::text::{Line, Lines, TextError, quote};

pub(super) fn read(source: &Source) -> Result<Polygons, BuildError> {
    let mut polygons = Polygons {
        first_index: 1,
        ..Default::default()
    };
    let mut lines = Lines::new(source.bytes);
    let mut read_all = || -> Result<(), TextError> {
        while let Some(line) = lines.next_line()? {
            let number = line.number;
            let Some(begun) = line.text.strip_suffix('\\') else {
                statement(&line, &mut polygons)?;
                continue;
            };
            // A backslash continues the statement on the next line.
            let mut whole = begun.to_owned();
            while let Some(next) = lines.next_line()? {
                whole.push(' ');
                whole.push_str(next.text.trim_end_matches('\\'));
                if !next.text.ends_with('\\') {
                    break;
                }
            }
            let text = whole.as_str();
            statement(&Line { number, text }, &mut polygons)?;
        }
        Ok(())
    };
    read_all().map_err(|e| source.text_error(e))?;
    Ok(polygons)
}

fn statement(line: &Line, polygons: &mut Polygons) -> Result<(), TextError> {
    let mut tokens = line.text.split_whitespace();
    match tokens.next() {
        Some("v") => {
            let mut coordinate = |what| line.finite(&mut tokens, what);
            let v = Vector::new(coordinate("x")?, coordinate("y")?, coordinate("z")?);
            polygons.vertices.push(v);
        }
        Some("f") => {
            let mut corners = 0;
            for token in tokens {
                let index = token.split('/').next().unwrap_or_default();
                let given: i64 = line.parse(&mut [index].into_iter(), "a vertex index")?;
                let so_far = polygons.vertices.len() as i64;
                let from_zero = match given {
                    1.. => given - 1,
                    _ => so_far.saturating_add(given),
                };
                if given == 0 || from_zero < 0 {
                    return Err(line.error(format!(
                        "vertex {given} in {}: indices begin at 1, or at -1 backwards over the \
                         {so_far} vertices so far",
                        quote(line.text)
                    )));
                }
                polygons.corners.push(from_zero as u64);
                corners += 1;
            }
            if corners < 3 {
                let text = quote(line.text);
                return Err(line.error(format!("a face of {corners} corners: {text}")));
            }
            polygons.close_polygon(Some(line.number));
        }
        _ => {}
    }
    Ok(())
}
