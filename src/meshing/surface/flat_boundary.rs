//! The boundary of a solid of flat faces whose parts overlap, exactly: triangles are cut along the planes of all faces,
//! so that each piece is hidden as a whole or not at all.

use crate::error::BuildError;
use crate::meshing::geometry::bounds::{Bounds, Point};
use crate::meshing::geometry::convex::{Plane, cut_polygon};
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::surface::flat_faces::{
    FLATNESS, FLATNESS_OF_PARTS, FlatFaces, ON, flat_faces, rounding,
};
use crate::meshing::surface::folds::Folds;
use crate::meshing::surface::hidden::Hidden;
use crate::meshing::watch::Watch;

/// Flat faces at most: each triangle is cut along those that pass near it.
const MOST_FACES: usize = 256;

/// Pieces at most, hidden or not. Twenty boxes at random in one are cut into 18,000, in a second and a half, and forty
/// into 121,000, in seven.
const MOST_PIECES: usize = 200_000;

/// Distance from the surface at which winding numbers are asked for, in units of how near to a plane points are on it.
/// Larger, and small pieces are judged by what is beside them: at 16, one of twenty boxes in one was 6e-5 of the size
/// inside.
const OFF: f64 = 2.0;

/// Distance up to which a face may hide part of a triangle, in units of how far before it hidden points are looked for.
const NEAR: f64 = 2.0;

/// A piece of a triangle, and the triangle.
pub type TrianglePiece = ([Point; 3], usize);

/// The pieces of triangles that are not hidden, in the order of the triangles, and the width up to which cracks count
/// as matter, which is `cracks` at least; `None` where faces are not flat, or too many.
pub fn flat_pieces(
    surface: &Surface,
    tree: &TriangleTree,
    folds: &Folds,
    cracks: f64,
    watch: &mut Watch,
) -> Result<Option<(Vec<TrianglePiece>, f64)>, BuildError> {
    let mut faces = None;
    let mut on = 0.0;
    for flatness in FLATNESS.into_iter().chain([FLATNESS_OF_PARTS]) {
        let flat = flatness * rounding(surface);
        let body = (0..surface.triangles.len()).collect();
        on = ON * flat;
        faces = match flat_faces(surface, body, flat, MOST_FACES, watch)? {
            None => faces_of_patches(surface, flat, watch)?,
            faces => faces,
        };
        if faces.is_some() {
            break;
        }
    }
    let Some(faces) = faces else {
        return Ok(None);
    };
    let mut boxes = vec![Bounds::EMPTY; faces.planes.len()];
    for &(t, face) in &faces.face_of {
        let around = &mut boxes[face as usize];
        *around = around.union(Bounds::of(surface.corners(t)));
    }
    let planes: Vec<(Plane, Bounds)> = faces.planes.into_iter().zip(boxes).collect();
    let off = OFF * on;
    let cracks = cracks.max(off);
    let mut hidden = Hidden {
        tree,
        folds,
        off,
        cracks,
        work: 0,
    };
    let mut pieces = Vec::new();
    let mut cut = 0;
    for (t, corners) in surface.all_corners().enumerate() {
        let (normal, patch) = (surface.normals[t], surface.patch_of[t]);
        let polygons = along(corners, &planes, [on, NEAR * cracks]);
        cut += polygons.len();
        if cut > MOST_PIECES {
            return Ok(None);
        }
        let mut seen = Vec::with_capacity(polygons.len());
        for polygon in &polygons {
            watch.again()?;
            let sum = polygon.iter().fold(Point::zero(), |sum, p| sum + *p);
            let middle = sum * (1.0 / polygon.len() as f64);
            let is_hidden =
                hidden.is_enclosed(middle, normal) || hidden.is_in_fold(middle, patch, normal);
            if !is_hidden {
                seen.push(polygon);
            }
        }
        if seen.len() == polygons.len() {
            pieces.push((corners, t));
            continue;
        }
        for polygon in seen {
            let fan = polygon[1..].windows(2);
            pieces.extend(fan.map(|w| ([polygon[0], w[0], w[1]], t)));
        }
    }
    Ok(Some((pieces, cracks)))
}

/// The faces of each patch by themselves: faces of different ones may be so near to one plane that together they are on
/// none.
fn faces_of_patches(
    surface: &Surface,
    flat: f64,
    watch: &mut Watch,
) -> Result<Option<FlatFaces>, BuildError> {
    let mut bodies = vec![Vec::new(); surface.whole.len()];
    for (t, &patch) in surface.patch_of.iter().enumerate() {
        bodies[patch as usize].push(t);
    }
    let mut all = FlatFaces {
        planes: Vec::new(),
        face_of: Vec::with_capacity(surface.triangles.len()),
    };
    for body in bodies {
        let (before, left) = (all.planes.len(), MOST_FACES - all.planes.len());
        let Some(faces) = flat_faces(surface, body, flat, left, watch)? else {
            return Ok(None);
        };
        let face_of = faces.face_of.into_iter();
        all.face_of
            .extend(face_of.map(|(t, face)| (t, before as u32 + face)));
        all.planes.extend(faces.planes);
    }
    Ok(Some(all))
}

/// A triangle cut along the planes of faces that come as near to it as `near`. Points within `on` of a plane are on it.
fn along(
    triangle: [Point; 3],
    planes: &[(Plane, Bounds)],
    [on, near]: [f64; 2],
) -> Vec<Vec<Point>> {
    let whole = vec![triangle.to_vec()];
    planes.iter().fold(whole, |polygons, (plane, face)| {
        let cut = |polygon: Vec<Point>| {
            let own = Bounds::of(polygon.iter().copied());
            match face.is_near(&own, near) {
                true => cut_polygon(&polygon, plane, on),
                false => [Some(polygon), None],
            }
        };
        polygons.into_iter().flat_map(cut).flatten().collect()
    })
}
