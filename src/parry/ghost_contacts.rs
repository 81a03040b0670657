//! Contacts ahead that nothing can meet. Each primitive of a mesh has contacts of its own, also where its neighbours hide
//! it: a ball on a level plate of several slabs is near the rim of the next one, which is in the plate or in line with its
//! top, under a normal that is aslant. A solver that keeps the ball from that rim throws it up.
//!
//! A contact says that the other shape stays beyond a plane. If a part of the mesh reaches beyond that plane and beyond the
//! other shape's point there, the other shape is at the part's side of it, and does not stay: the plane is not one between
//! the other shape and the mesh. If the contact of that part with the same convex part of the other shape has a plane that
//! the first part does not reach beyond either, it keeps both apart, and the first contact says nothing more. In a corner
//! between two parts neither plane does, and both stay.

use crate::math::{Real, Vector};
use crate::medial::convex_pieces::ConvexPiece;
use crate::medial::{MedialMesh, MedialPrimitive, MedialSphere};

/// Cosine from which two normals are one (0.8°).
const ONE_NORMAL: Real = 0.9999;

/// How far a part may reach beyond a plane and count as behind it, in units of the mesh's largest extent: rounding, and what
/// parry's iterations leave.
pub const BEHIND: Real = 1.0e-6;

/// Contacts, the deepest first, with which each other is compared.
const COMPARED: usize = 16;

/// A contact in the mesh's frame.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// The mesh's primitive.
    pub primitive: u32,
    /// A number of the other shape's convex part.
    pub other: u32,
    /// The point on the mesh.
    pub place: Vector,
    /// Unit normal, out of the mesh.
    pub normal: Vector,
    /// Signed distance, a length.
    pub gap: Real,
}

impl Seen {
    /// How far spheres reach beyond the contact's plane, a length.
    fn beyond(&self, spheres: &[MedialSphere]) -> Real {
        let heights = spheres.iter();
        let heights = heights.map(|s| self.normal.dot(s.center - self.place) + s.radius);
        heights.fold(Real::MIN, Real::max)
    }
}

/// Whether each contact is one that nothing can meet.
pub fn ghosts(mesh: &MedialMesh, contacts: &[Seen]) -> Vec<bool> {
    let mut ghosts = vec![false; contacts.len()];
    let first = contacts.first().map_or(Vector::ZERO, |seen| seen.normal);
    let is_first = |seen: &Seen| seen.normal.dot(first) >= ONE_NORMAL;
    if mesh.primitive_count() < 2 || contacts.iter().all(is_first) {
        return ghosts;
    }
    let behind = BEHIND * mesh.aabb().extents().max_element();
    let mut order: Vec<usize> = (0..contacts.len()).collect();
    order.sort_unstable_by(|i, j| {
        let [a, b] = [&contacts[*i], &contacts[*j]];
        a.other
            .cmp(&b.other)
            .then(a.gap.total_cmp(&b.gap))
            .then(i.cmp(j))
    });
    for group in order.chunk_by(|i, j| contacts[*i].other == contacts[*j].other) {
        let mut kept: Vec<&Seen> = Vec::new();
        for &i in group {
            let seen = &contacts[i];
            ghosts[i] = kept.iter().any(|other| {
                other.normal.dot(seen.normal) < ONE_NORMAL
                    && other.beyond(part_of(mesh, seen.primitive).spheres()) <= behind
                    && seen.beyond(part_of(mesh, other.primitive).spheres())
                        > seen.gap.max(0.0) + behind
            });
            if !ghosts[i] && kept.len() < COMPARED {
                kept.push(seen);
            }
        }
    }
    ghosts
}

/// A convex part of a mesh: a convex piece, or a primitive alone.
pub enum Part<'a> {
    Piece(&'a ConvexPiece),
    Primitive(MedialPrimitive),
}

impl Part<'_> {
    pub fn spheres(&self) -> &[MedialSphere] {
        match self {
            Self::Piece(piece) => &piece.spheres,
            Self::Primitive(primitive) => primitive.spheres(),
        }
    }

    /// Outward unit normals of the flat faces of a piece.
    pub fn normals(&self) -> impl Iterator<Item = Vector> {
        let faces = match self {
            Self::Piece(piece) => &piece.faces[..],
            Self::Primitive(_) => &[],
        };
        faces.iter().map(|face| face.normal)
    }
}

/// The convex part that a primitive belongs to.
pub fn part_of(mesh: &MedialMesh, primitive: u32) -> Part<'_> {
    let pieces = mesh.convex_pieces();
    let piece = pieces.node_of(primitive);
    match piece.and_then(|node| pieces.of_node(node)) {
        Some(piece) => Part::Piece(piece),
        None => Part::Primitive(mesh.primitive(primitive as usize)),
    }
}

/// A number of the convex part that a primitive of a mesh belongs to.
pub fn part_number(mesh: &MedialMesh, primitive: u32) -> u32 {
    let node = mesh.convex_pieces().node_of(primitive);
    node.map_or(primitive, |node| mesh.primitive_count() as u32 + node)
}
