//! Normals that contacts of a primitive may have, where it is part of a convex piece of its mesh: those along which the piece
//! reaches no further than the primitive. Along any other the primitive has the piece before it.
//!
//! They are for callers that ask parry's own dispatcher, as rapier's character controller does to find the ground: a box is of
//! thin slabs, and a contact with the side of one would carry the character away. Our dispatcher looks at all contacts
//! of a mesh together, and needs those too (`ghost_contacts.rs`, `touching_normals.rs`).

use super::convex_parts::Part;
use crate::math::{Real, Vector};
use crate::medial::MedialMesh;
use parry3d::query::details::NormalConstraints;

/// How much further than the primitive the piece may reach, in units of the mesh's size: parry's iterative algorithms find
/// normals that are off by some 1e-4.
const SLACK: Real = 1.0e-4;

/// Normals of contacts of a primitive.
pub struct OutwardNormals {
    mesh: MedialMesh,
    primitive: u32,
}

impl OutwardNormals {
    /// Those of a primitive of a mesh; `None` where they may be any.
    pub fn of(mesh: &MedialMesh, primitive: u32) -> Option<Self> {
        mesh.convex_pieces().node_of(primitive)?;
        Some(Self {
            mesh: mesh.clone(),
            primitive,
        })
    }
}

impl NormalConstraints for OutwardNormals {
    fn project_local_normal_mut(&self, normal: &mut Vector) -> bool {
        let own = Part::Primitive(self.mesh.primitive(self.primitive as usize));
        let piece = Part::of(&self.mesh, self.primitive);
        let slack = SLACK * self.mesh.aabb().extents().max_element();
        own.reach(*normal) >= piece.reach(*normal) - slack
    }
}
