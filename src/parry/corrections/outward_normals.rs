//! Normals that contacts of a primitive may have, where it is part of a convex piece of its mesh: those along which the
//! piece reaches no further than the primitive. Along any other, another part of the piece sticks out further, so that
//! the contact would be inside the solid: such a normal is turned to that of the nearest flat face of the piece that
//! the primitive ends at, as parry does at internal edges of triangle meshes.
//!
//! They are for callers of parry's own dispatcher, as rapier's character controller is one to find the ground, and for
//! the surfaces of soft bodies: a box is of thin slabs, and a contact with the side of one would carry a character
//! away. (parry asks for none where balls meet balls, and capsules capsules.) Our dispatcher looks at all contacts of a
//! mesh together, and needs those too (`ghost_contacts.rs`, `touching_normals.rs`).

use crate::math::{Pose, Real, Vector};
use crate::medial::MedialMesh;
use crate::parry::contacts::convex_parts::ConvexPart;
use parry3d::query::details::NormalConstraints;

/// How much further than the primitive the piece may reach, in units of the longest side of the mesh's box: parry's
/// iterative algorithms find normals that are off by some 1e-4.
const SLACK: Real = 1.0e-4;

/// Normals of contacts of a primitive. parry wants what borrows nothing.
pub struct OutwardNormals {
    mesh: MedialMesh,
    primitive: u32,
}

impl OutwardNormals {
    /// The normals that contacts of a primitive may have; `None` where any is allowed, because the primitive is in no
    /// convex piece.
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
        let own = ConvexPart::Primitive(self.mesh.primitive(self.primitive as usize));
        let piece = ConvexPart::of(&self.mesh, self.primitive);
        let slack = SLACK * self.mesh.aabb().extents().max_element();
        let is_outward = |n: &Vector| own.reach(*n) >= piece.reach(*n) - slack;
        if is_outward(normal) {
            return true;
        }
        let faces = piece.flat_normals().filter(is_outward);
        let nearest = faces.max_by(|a, b| normal.dot(*a).total_cmp(&normal.dot(*b)));
        if let Some(nearest) = nearest {
            *normal = nearest;
        }
        nearest.is_some()
    }

    fn project_local_normal2(
        &self,
        pos12: &Pose,
        normal1: &mut Vector,
        normal2: &mut Vector,
    ) -> bool {
        let before = *normal2;
        let is_any = self.project_local_normal_mut(normal2);
        // parry compares the other bit by bit with what it was.
        if *normal2 != before {
            *normal1 = pos12.rotation * -*normal2;
        }
        is_any
    }
}
