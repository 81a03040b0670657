//! First contacts with a part of a body that its neighbours shield ([`super::ghost_contacts`]).
//!
//! A solver lets bodies sink in a little. What rolls on a level plate of several slabs, just below its top, comes to
//! the rim of the next slab under a normal that is aslant, and would be thrown up there. The rim is inside the plate:
//! the slab on which the body lies keeps it from the next one. So such a contact gets the normal of the one that
//! shields it, along which the body does not approach.

use super::contact_list::ContactList;
use super::first_contact::{Counts, Query};
use super::ghost_contacts::{PartContact, ghosts};
use super::placement::Placement;
use super::primitive_pair::PrimitivePair;
use super::primitive_tree::PrimitiveTree;
use super::sphere_pair::SpherePair;
use crate::elementary::{Toi, ToiStatus};
use crate::math::{Pose, Real, Vector};
use crate::medial::tree::NodeKind;

/// Rounding of heights, in units of the coordinates.
const SLACK: Real = 1.0e-6;

/// How far a primitive of a body reaches along a unit direction, in the frame in which the body is at `pose`.
fn reach(body: &impl PrimitiveTree, pose: &Pose, primitive: u32, n: Vector) -> Real {
    let (spheres, share) = body.primitive(primitive);
    let heights = spheres[..share.spheres].iter();
    let heights = heights.map(|s| n.dot(pose * s.center) + s.radius);
    heights.fold(Real::MIN, Real::max)
}

impl<A: PrimitiveTree, B: PrimitiveTree> Query<'_, A, B> {
    /// The answer of a contact that another one shields: with the primitives, the normal and the place of that one.
    /// `None` where none does. Only primitives that touched at the start may shield others.
    pub(super) fn shielded(&self, toi: &Toi) -> Option<Toi> {
        let met = self.search.as_ref().and_then(|search| search.met.as_ref());
        if toi.status != ToiStatus::Contact || met.is_some() {
            return None;
        }
        let poses = [0, 1].map(|side| self.pose_at(side, toi.lower));
        let shield = self.shield(toi, &poses)?;
        let normal = poses[0].rotation * shield.normal;
        let middle = (poses[0] * shield.points[0] + poses[1] * shield.points[1]) * 0.5;
        let half = normal * (0.5 * (toi.points[1] - toi.points[0]).dot(toi.normal));
        Some(Toi {
            normal,
            points: [middle - half, middle + half],
            primitives: shield.primitives,
            ..*toi
        })
    }

    /// A contact that shields the one found, with the same convex part of one of the two bodies; its normal is in the
    /// first body's frame.
    fn shield(&self, toi: &Toi, poses: &[Pose; 2]) -> Option<SpherePair> {
        let search = self.search.as_ref()?;
        let bodies = (search.sides.0.body, search.sides.1.body);
        let found = toi.primitives;
        let parts = [
            bodies.0.convex_part(found[0]),
            bodies.1.convex_part(found[1]),
        ];
        let pos12 = poses[0].inv_mul(&poses[1]);
        let place = Placement::new(&pos12);
        let gap = (toi.points[1] - toi.points[0]).dot(toi.normal);
        let shield = |(nodes, _): &([u32; 2], f64)| {
            let kinds = (bodies.0.kind(nodes[0]), bodies.1.kind(nodes[1]));
            let (NodeKind::Primitive(p), NodeKind::Primitive(q)) = kinds else {
                return None;
            };
            let same = [parts[0].contains(&p), parts[1].contains(&q)];
            let body = match same {
                [false, true] => 0,
                [true, false] => 1,
                _ => return None,
            };
            let mut list = ContactList::new(gap.into());
            let pair = PrimitivePair::new(bodies.0, bodies.1, [p, q], &place);
            pair.contacts(&mut list, &mut Counts::default());
            let contacts = list.into_contacts().into_iter();
            let deepest = contacts.min_by(|a, b| a.distance.total_cmp(&b.distance))?;
            let shields = match body {
                0 => shields(bodies.0, 0, &deepest, toi, poses),
                _ => shields(bodies.1, 1, &deepest, toi, poses),
            };
            shields.then_some(deepest)
        };
        // Others may be in its shade themselves.
        let shields = search.touching.iter().filter_map(shield);
        shields.min_by(|a, b| a.distance.total_cmp(&b.distance))
    }
}

/// Whether a contact with a primitive of `body`, which is the first or the second (`side`), shields the one found with
/// another primitive of it.
fn shields(
    body: &impl PrimitiveTree,
    side: usize,
    contact: &SpherePair,
    found: &Toi,
    poses: &[Pose; 2],
) -> bool {
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
    let size = primitives.map(|p| {
        let (spheres, _) = body.primitive(p);
        let place = poses[side] * spheres[0].center;
        place.abs().max_element() + spheres[0].center.abs().max_element()
    });
    let reach = |part: u32, n: Vector| reach(body, &poses[side], primitives[part as usize], n);
    ghosts(&contacts, reach, |_| SLACK * size[0].max(size[1]))[1]
}
