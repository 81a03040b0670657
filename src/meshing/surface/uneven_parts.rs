//! Kits whose vertices are off: bodies of convex parts with sharp edges that touch, in files of few decimals. Their
//! parts' faces are flat to no fine tolerance, and leave cracks where the parts should touch.

use crate::error::BuildError;
use crate::meshing::geometry::convex::Plane;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::surface::flat_faces::{FLATNESS, convex_faces, rounding};
use crate::meshing::surface::touching::bodies;
use crate::meshing::watch::Watch;

/// Tolerances of flat faces that are tried in order (longest side 1): with the last, vertices may be off by a
/// thousandth of the size.
const UNEVEN: [f64; 3] = [1e-4, 5e-4, 1.5e-3];

/// Width of the cracks that count as matter, in units of the tolerance: as wide as two faces leave whose vertices are
/// off by the tolerance.
const CRACK: f64 = 2.0;

/// Cosine of the least angle between the normals of two faces of a part: facets of round parts, which are not uneven,
/// turn by less.
const SHARP: f64 = 0.9;

/// Faces of a part at most.
const MOST_FACES: usize = 64;

/// How uneven the parts of a kit are.
#[derive(Clone, Copy)]
pub struct Unevenness {
    /// Distance up to which vertices are off the planes of their faces (longest side 1).
    pub flat: f64,
    /// Width up to which cracks between parts count as matter (longest side 1).
    pub cracks: f64,
}

/// The unevenness of the parts of a surface, if it has several, all are convex with sharp edges, and some are more
/// uneven than those of exact bodies may be.
pub fn uneven_parts(
    surface: &Surface,
    watch: &mut Watch,
) -> Result<Option<Unevenness>, BuildError> {
    let parts = match surface.simple {
        true => Vec::new(),
        false => bodies(surface, watch)?,
    };
    if parts.len() < 2 {
        return Ok(None);
    }
    for flatness in FLATNESS {
        let flat = flatness * rounding(surface);
        if are_convex(surface, &parts, flat, |_| true, watch)? {
            return Ok(None);
        }
    }
    for flat in UNEVEN {
        if are_convex(surface, &parts, flat, is_sharp, watch)? {
            let cracks = CRACK * flat;
            return Ok(Some(Unevenness { flat, cracks }));
        }
    }
    Ok(None)
}

/// Whether all parts are convex with faces that are flat to `flat`, and the planes of these are as wanted.
fn are_convex(
    surface: &Surface,
    parts: &[Vec<usize>],
    flat: f64,
    wanted: impl Fn(&[Plane]) -> bool,
    watch: &mut Watch,
) -> Result<bool, BuildError> {
    for part in parts {
        let faces = convex_faces(surface, part.clone(), flat, MOST_FACES, watch)?;
        if !faces.is_some_and(|faces| wanted(&faces.planes)) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Whether no two planes of a convex part's faces are nearly parallel and face the same way.
fn is_sharp(planes: &[Plane]) -> bool {
    let pairs = (1..planes.len()).flat_map(|i| planes[..i].iter().map(move |p| (p, &planes[i])));
    let mut cosines = pairs.map(|(a, b): (&Plane, &Plane)| a.normal.dot(b.normal));
    cosines.all(|cosine| cosine < SHARP)
}
