//! Ghost contacts: contacts of a part of a mesh that its neighbours shield. A ball on a level plate of several slabs is near
//! the rim of the next slab, which is within the plate or in line with its top, under a normal that is aslant; a solver
//! that keeps the ball from that rim throws it up.
//!
//! A contact says that the other shape stays beyond a plane. It is a ghost of another, deeper contact with the same convex
//! part of the other shape, if the mesh's part there reaches beyond the ghost's plane by more than the ghost's gap, while the
//! ghost's own part stays behind the plane of the other. The other contact then keeps both parts from the other shape.
//! In a corner neither plane has both parts behind it, and both contacts stay. This is of the poses at hand: what turns
//! about a contact may meet a part that it shields now, and has that contact in the next step.

use super::convex_parts::Part;
use crate::math::{Real, Vector};
use crate::medial::MedialMesh;

/// Cosine from which two normals are one (0.8°).
const PARALLEL: Real = 0.9999;

/// Each contact is compared with at most so many deeper ones that are no ghosts.
const COMPARED: usize = 16;

/// A contact in the mesh's frame.
#[derive(Clone, Copy, Debug)]
pub struct MeshContact {
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

impl MeshContact {
    /// How far the part of a primitive reaches beyond the contact's plane, a length.
    fn beyond(&self, mesh: &MedialMesh, primitive: u32) -> Real {
        Part::of(mesh, primitive).reach(self.normal) - self.normal.dot(self.place)
    }
}

/// Whether each contact is a ghost; heights that differ by up to `slack`, a length, are equal.
pub fn ghosts(mesh: &MedialMesh, contacts: &[MeshContact], slack: Real) -> Vec<bool> {
    let mut ghosts = vec![false; contacts.len()];
    let first = contacts.first().map_or(Vector::ZERO, |c| c.normal);
    let is_first = |c: &MeshContact| c.normal.dot(first) >= PARALLEL;
    if mesh.primitive_count() < 2 || contacts.iter().all(is_first) {
        return ghosts;
    }
    let mut order: Vec<usize> = (0..contacts.len()).collect();
    order.sort_unstable_by(|i, j| {
        let [a, b] = [&contacts[*i], &contacts[*j]];
        a.other
            .cmp(&b.other)
            .then(a.gap.total_cmp(&b.gap))
            .then(i.cmp(j))
    });
    for group in order.chunk_by(|i, j| contacts[*i].other == contacts[*j].other) {
        let mut kept: Vec<&MeshContact> = Vec::new();
        for &i in group {
            let c = &contacts[i];
            ghosts[i] = kept.iter().any(|deeper| {
                deeper.normal.dot(c.normal) < PARALLEL
                    && deeper.beyond(mesh, c.primitive) <= slack
                    && c.beyond(mesh, deeper.primitive) > c.gap.max(0.0) + slack
            });
            if !ghosts[i] && kept.len() < COMPARED {
                kept.push(c);
            }
        }
    }
    ghosts
}
