//! The boundary of a solid of flat faces whose parts overlap, exactly: triangles are cut along the planes of all faces,
//! so that each piece is hidden as a whole or not at all.

use crate::error::BuildError;
use crate::meshing::geometry::bounds::{Bounds, Point};
use crate::meshing::geometry::convex::{Plane, cut_polygon};
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::surface::flat_faces::{flat_faces, rounding};
use crate::meshing::surface::folds::Folds;
use crate::meshing::surface::hidden::Hidden;
use crate::meshing::watch::Watch;

/// Flat faces at most: each triangle is cut along those that pass near it.
const MOST_FACES: usize = 128;

/// Pieces at most. Twenty boxes at random in one have 3,000.
const MOST_PIECES: usize = 50_000;

/// How far corners may be off the planes of their faces, in [`rounding`]s of the surface: vertices may
/// be moved by a millionth of the size.
const FLATNESS: f64 = 4.0;

/// Points this many times as far from a plane as a corner of a flat face may be are on it.
const ON: f64 = 2.0;

/// Winding numbers are asked for at so many times that from the surface.
const OFF: f64 = 8.0;

/// A piece of a triangle, and the triangle.
pub type Piece = ([Point; 3], usize);

/// The pieces of triangles that are not hidden, in the order of the triangles; `None` where faces are
/// not flat, or too many.
pub fn flat_pieces(
    surface: &Surface,
    tree: &TriangleTree,
    folds: &Folds,
    watch: &mut Watch,
) -> Result<Option<Vec<Piece>>, BuildError> {
    let flat = FLATNESS * rounding(surface);
    let on = ON * flat;
    let body = (0..surface.triangles.len()).collect();
    let Some(faces) = flat_faces(surface, body, flat, MOST_FACES, watch)? else {
        return Ok(None);
    };
    let mut boxes = vec![Bounds::EMPTY; faces.planes.len()];
    for &(t, face) in &faces.face_of {
        let around = &mut boxes[face as usize];
        *around = around.union(Bounds::of(surface.corners(t)));
    }
    let planes: Vec<(Plane, Bounds)> = faces.planes.into_iter().zip(boxes).collect();
    let mut hidden = Hidden {
        tree,
        folds,
        off: OFF * on,
        work: 0,
    };
    let mut pieces = Vec::new();
    let mut cut = 0;
    for (t, corners) in surface.all_corners().enumerate() {
        let (normal, patch) = (surface.normals[t], surface.patch_of[t]);
        let polygons = along(corners, &planes, on);
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
    Ok(Some(pieces))
}

/// A triangle cut along the planes of the faces that come near it.
fn along(triangle: [Point; 3], planes: &[(Plane, Bounds)], on: f64) -> Vec<Vec<Point>> {
    let own = Bounds::of(triangle);
    let near = planes.iter().filter(|(_, face)| face.is_near(&own, on));
    near.fold(vec![triangle.to_vec()], |polygons, (plane, _)| {
        let halves = polygons.iter().flat_map(|p| cut_polygon(p, plane, on));
        halves.flatten().collect()
    })
}
