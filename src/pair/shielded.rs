//! First contacts with a primitive of a medial mesh that another one shields ([`super::ghost_contacts`]).
//!
//! A solver lets bodies sink in a little. What rolls on a level plate of several slabs, just below its top, comes to
//! the rim of the next slab under a normal that is aslant, and would be thrown up there. The rim is inside the plate:
//! the slab on which the body lies keeps it from the next one. So such a contact gets the normal and the place of the
//! one that shields it. If the body does not approach along that normal, it goes on, and the two primitives touch.
//!
//! This is for first contacts only. At the floor ([`crate::elementary::Cores`]), where a body has to stop, no contact
//! is shielded: one may be deep for a thin primitive and not for the thick one that shields it.

use super::contact_list::ContactList;
use super::first_contact::{Counts, Query};
use super::ghost_contacts::{PartContact, ghosts};
use super::placement::Placement;
use super::primitive_pair::PrimitivePair;
use super::primitive_tree::PrimitiveTree;
use super::search::Search;
use super::sphere_pair::SpherePair;
use crate::elementary::{Toi, ToiStatus};
use crate::math::{Pose, Real, Vector};
use crate::medial::exact::{balls, tangent_normals};
use crate::medial::tree::NodeKind;
use crate::medial::{MedialPrimitive, MedialSphere};

/// Rounding of heights, in units of the coordinates.
const SLACK: Real = 1.0e-6;

/// How much deeper than a contact the other body may be along its normal, if it is to shield a primitive, in units of
/// the primitive's least radius: what slides is tilted a little. Larger, and it may be deep in the primitive.
const SUNK: Real = 0.1;

/// The spheres of a primitive.
fn spheres(body: &impl PrimitiveTree, primitive: u32) -> impl Iterator<Item = MedialSphere> {
    let (spheres, share) = body.primitive(primitive);
    spheres.into_iter().take(share.spheres)
}

/// How far primitives of a body that is at `pose` reach along a unit direction, a length.
fn reach(
    body: &impl PrimitiveTree,
    pose: &Pose,
    primitives: impl Iterator<Item = u32>,
    n: Vector,
) -> Real {
    let heights = primitives.flat_map(|p| spheres(body, p));
    let heights = heights.map(|s| n.dot(pose * s.center) + s.radius);
    heights.fold(Real::MIN, Real::max)
}

/// The largest coordinate of a primitive of a body that is at `pose`, and in the body's own frame, a length.
fn size(body: &impl PrimitiveTree, pose: &Pose, primitive: u32) -> Real {
    let sizes = spheres(body, primitive).map(|s| {
        let placed = (pose * s.center).abs().max_element();
        placed.max(s.center.abs().max_element()) + s.radius
    });
    sizes.fold(0.0, Real::max)
}

impl<A: PrimitiveTree, B: PrimitiveTree> Query<'_, A, B> {
    /// The contact that shields the one of an answer, if there is any: its normal is in the first body's frame, each
    /// point in its own body's. Only primitives that touched at the start may shield others.
    pub(super) fn shielding_contact(&self, toi: &Toi) -> Option<SpherePair> {
        let search = self.search.as_ref()?;
        let is_floor = search.cores.is_some_and(|cores| cores.share > 0.0);
        if toi.status != ToiStatus::Contact || search.met.is_some() || is_floor {
            return None;
        }
        let poses = [0, 1].map(|side| self.pose_at(side, toi.lower));
        let place = Placement::new(&poses[0].inv_mul(&poses[1]));
        let gap = (toi.points[1] - toi.points[0]).dot(toi.normal);
        let touching = search.touching.iter();
        let contacts = touching.filter_map(|(nodes, _)| {
            let contact = deepest_contact(search, *nodes, &place, gap)?;
            shield(search, toi, &contact, &poses)
        });
        // The others may be ghosts of it.
        contacts.min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    /// An answer with the normal and the place of the contact that shields its own.
    pub(super) fn shielded(&self, toi: Toi) -> Toi {
        let Some(contact) = self.shielding_contact(&toi) else {
            return toi;
        };
        let poses = [0, 1].map(|side| self.pose_at(side, toi.lower));
        let normal = poses[0].rotation * contact.normal;
        let middle = (poses[0] * contact.points[0] + poses[1] * contact.points[1]) * 0.5;
        let half = normal * (0.5 * (toi.points[1] - toi.points[0]).dot(toi.normal));
        Toi {
            normal,
            points: [middle - half, middle + half],
            ..toi
        }
    }
}

/// The deepest contact of two primitives, given by their nodes, that are no farther apart than `gap` (a length) or
/// overlap.
fn deepest_contact<A: PrimitiveTree, B: PrimitiveTree>(
    search: &Search<A, B>,
    [i, j]: [u32; 2],
    place: &Placement,
    gap: Real,
) -> Option<SpherePair> {
    let (first, second) = (search.sides.0.body, search.sides.1.body);
    let (NodeKind::Primitive(p), NodeKind::Primitive(q)) = (first.kind(i), second.kind(j)) else {
        return None;
    };
    let mut found = ContactList::new(gap.max(0.0).into());
    let pair = PrimitivePair::new(first, second, [p, q], place);
    pair.contacts(&mut found, &mut Counts::default());
    let contacts = found.into_contacts().into_iter();
    contacts.min_by(|a, b| a.distance.total_cmp(&b.distance))
}

/// A contact as it shields that of an answer, if it does: one with another primitive of one body and the same convex
/// part of the other.
fn shield<A: PrimitiveTree, B: PrimitiveTree>(
    search: &Search<A, B>,
    toi: &Toi,
    contact: &SpherePair,
    poses: &[Pose; 2],
) -> Option<SpherePair> {
    let (first, second) = (search.sides.0.body, search.sides.1.body);
    let [p, q] = toi.primitives;
    let is_same = [
        first.convex_part(p).contains(&contact.primitives[0]),
        second.convex_part(q).contains(&contact.primitives[1]),
    ];
    let normal = match is_same {
        [false, true] => shields((first, second), 0, contact, toi, poses),
        [true, false] => shields((second, first), 1, contact, toi, poses),
        _ => None,
    }?;
    Some(SpherePair { normal, ..*contact })
}

/// The same for a contact with another primitive of `body`, which is the first or the second of the query (`side`): the
/// normal of the contact that the answer gets, in the first body's frame.
fn shields(
    (body, other): (&impl PrimitiveTree, &impl PrimitiveTree),
    side: usize,
    contact: &SpherePair,
    found: &Toi,
    poses: &[Pose; 2],
) -> Option<Vector> {
    if !body.is_medial() {
        return None;
    }
    let outward: Real = if side == 0 { 1.0 } else { -1.0 };
    let primitives = [contact.primitives[side], found.primitives[side]];
    let contacts = [
        PartContact {
            part: 0,
            other: 0,
            place: poses[side] * contact.points[side],
            normal: poses[0].rotation * contact.normal * outward,
            gap: contact.distance,
        },
        PartContact {
            part: 1,
            other: 0,
            place: found.points[side],
            normal: found.normal * outward,
            gap: (found.points[1] - found.points[0]).dot(found.normal),
        },
    ];
    let sizes = primitives.map(|p| size(body, &poses[side], p));
    let slack = SLACK * sizes[0].max(sizes[1]);
    // Of a solid only the face that touches need be beyond the contact's plane.
    let (n, others) = (contacts[0].normal, found.primitives[1 - side]);
    let lowest = -reach(other, &poses[1 - side], other.convex_part(others), -n);
    let thinnest = spheres(body, primitives[1]).map(|s| s.radius);
    let sunk = SUNK * thinnest.fold(Real::MAX, Real::min);
    if lowest - n.dot(contacts[0].place) < contacts[0].gap.min(0.0) - sunk - slack {
        return None;
    }
    let reach = |part: u32, n: Vector| {
        let primitive = primitives[part as usize];
        reach(body, &poses[side], std::iter::once(primitive), n)
    };
    if ghosts(&contacts, reach, |_| slack)[1] {
        return Some(contact.normal);
    }
    // The slab ahead rises above the one that the body lies on, and the body is to meet its face.
    let [shield, hidden] = &contacts;
    let to_body = |p: Vector| poses[side].inverse_transform_point(p);
    let depth = -primitive(body, primitives[0])
        .signed_distance(to_body(hidden.place))
        .distance;
    if shield.gap > hidden.gap || depth <= slack {
        return None;
    }
    let face = poses[side].rotation
        * face_normal(body, primitives[1], poses[side].rotation.inverse() * n)?;
    (face.dot(n) > hidden.normal.dot(n)).then(|| poses[0].rotation.inverse() * (face * outward))
}

/// A primitive of a body, in the body's frame.
fn primitive(body: &impl PrimitiveTree, index: u32) -> MedialPrimitive {
    let (spheres, share) = body.primitive(index);
    let [a, b, _] = spheres;
    match share.spheres {
        0 | 1 => MedialPrimitive::Sphere(a),
        2 => MedialPrimitive::Cone([a, b]),
        _ => MedialPrimitive::Slab(spheres),
    }
}

/// The unit normal of a slab's flat face that faces along `n` more than the other, in the body's frame.
fn face_normal(body: &impl PrimitiveTree, index: u32, n: Vector) -> Option<Vector> {
    let faces = tangent_normals(&balls(primitive(body, index).as_slab()))?;
    let [a, b] = faces.map(|face| face.to_vector());
    Some(if a.dot(n) < b.dot(n) { b } else { a })
}
