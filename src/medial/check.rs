//! Checks the spheres, edges and faces from which a medial mesh is to be made, or that a file contains.

use super::simplex::Simplex;
use super::sphere::MedialSphere;
use crate::error::{AssetError, MeshError};
use crate::math::Real;

/// Farthest that a sphere may reach from its body's origin along an axis, in the user's unit. Two points
/// are then at most 3.5e18 apart, whose square is a number in `f32`: ten times farther, and lengths,
/// bounding spheres and the thickness are infinite or wrong.
pub const LARGEST_REACH: Real = 1.0e18;

/// Fails on the first item that is not finite, too far away, negative, out of range or degenerate.
pub fn check(
    spheres: &[MedialSphere],
    edges: &[[u32; 2]],
    faces: &[[u32; 3]],
) -> Result<(), MeshError> {
    if spheres.is_empty() {
        return Err(MeshError::Empty);
    }
    for (index, s) in spheres.iter().enumerate() {
        if !(s.center.is_finite() && s.radius.is_finite()) {
            return Err(MeshError::NotFinite {
                index,
                center: s.center.into(),
                radius: s.radius,
            });
        }
        if s.center.abs().max_element() + s.radius.abs() > LARGEST_REACH {
            return Err(MeshError::TooFar {
                index,
                center: s.center.into(),
                radius: s.radius,
                most: LARGEST_REACH,
            });
        }
        if s.radius < 0.0 {
            return Err(MeshError::NegativeRadius {
                index,
                radius: s.radius,
            });
        }
    }
    let count = spheres.len();
    let element = |element: &'static str, index: usize, vertices: &[u32]| {
        for (k, &value) in vertices.iter().enumerate() {
            if value as usize >= count {
                return Err(MeshError::IndexOutOfRange {
                    element,
                    index,
                    value: value.into(),
                    count,
                });
            }
            if vertices[..k].contains(&value) {
                return Err(MeshError::RepeatedIndex {
                    element,
                    index,
                    value,
                });
            }
        }
        Ok(())
    };
    for (index, e) in edges.iter().enumerate() {
        element("edge", index, e)?;
    }
    for (index, f) in faces.iter().enumerate() {
        element("face", index, f)?;
    }
    let first = spheres[0];
    if spheres
        .iter()
        .all(|s| s.radius == 0.0 && s.center == first.center)
    {
        return Err(MeshError::ZeroSize {
            count,
            center: first.center.into(),
        });
    }
    Ok(())
}

/// The slabs are the faces, the cones some of the edges, in their order; every sphere and every edge is
/// owned once.
pub fn check_primitives(
    primitives: &[Simplex],
    spheres: usize,
    edges: &[[u32; 2]],
    faces: &[[u32; 3]],
) -> Result<(), AssetError> {
    let mut owned = vec![false; spheres];
    let (mut later_edges, mut owned_edges, mut last) = (edges.iter(), 0, None);
    for (index, p) in primitives.iter().enumerate() {
        let [a, b, c] = p.vertices;
        let known = match (p.len, faces.get(index)) {
            (3, Some(face)) => *face == p.vertices,
            (2, None) => b == c && later_edges.any(|e| *e == [a, b]),
            (1, None) => a == b && b == c && (a as usize) < spheres && last < Some(a),
            _ => false,
        };
        let bits_fit = p.owns_vertex >> p.len.min(7) == 0
            && p.owns_edge >> p.len.min(7) == 0
            && (p.len == 3 || p.owns_edge == 1);
        let once = known
            && (0..p.len.min(3)).all(|bit| {
                let owns = p.owns_vertex >> bit & 1 == 1;
                !owns || !std::mem::replace(&mut owned[p.vertices[bit as usize] as usize], true)
            });
        if !(bits_fit && once) {
            let value = format!("{p:?}");
            return Err(AssetError::content(
                "primitive",
                index,
                value,
                "of a face, an edge or a lone sphere",
            ));
        }
        if p.len == 1 {
            // Lone spheres come last: they follow no more edges.
            later_edges = [].iter();
            last = Some(a);
        } else {
            owned_edges += p.owns_edge.count_ones() as usize;
        }
    }
    if let Some(index) = owned.iter().position(|owned| !owned) {
        return Err(AssetError::content(
            "sphere",
            index,
            "in no primitive",
            "in one",
        ));
    }
    if owned_edges != edges.len() || primitives.len() < faces.len() {
        return Err(AssetError::content(
            "edge",
            owned_edges,
            "owned last",
            "the last edge",
        ));
    }
    Ok(())
}
