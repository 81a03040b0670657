//! First contacts with a part of a medial mesh, a primitive or a convex piece, that another one shields
//! ([`super::ghost_contacts`]).
//!
//! A solver lets bodies sink in a little. What rolls on a level plate of several slabs, just below its top, comes to
//! the rim of the next slab under a normal that is aslant, and would be thrown up there. The rim is inside the plate:
//! the slab on which the body lies keeps it from the next one. So such a contact gets the normal and the place of the
//! one that shields it. If the body does not approach along that normal, it goes on, and the two primitives touch.
//!
//! Slabs need not be level. Where the next one rises at a slight fold, its rim is inside the one that the body lies on
//! all the same, and the body is to meet its face: the contact gets the face's normal.
//!
//! At the floor ([`crate::elementary::Cores`]), where a body has to stop, a contact may be deep for a thin primitive
//! and not for a thick one beside it. There a part is shielded only by one that holds the place of the contact, and
//! has a floor of its own; and only from a body that is one convex part. Walls of two cups that are in each other have
//! shields that push to opposite sides: with these nothing would part the axes, and the cups would hang where they are.

use super::contact_list::ContactList;
use super::first_contact::{Counts, Query};
use super::ghost_contacts::{PartContact, ghosts};
use super::hull_gap::{PlacedHull, hull_gap, nearest_points};
use super::piece_contact::{nearest_primitive, patch};
use super::placement::Placement;
use super::primitive_pair::PrimitivePair;
use super::primitive_tree::PrimitiveTree;
use super::sphere_pair::SpherePair;
use crate::elementary::{Toi, ToiStatus};
use crate::math::lane::Vec3;
use crate::math::tolerance::HEIGHT_ROUNDING;
use crate::math::{Pose, Real, Vector};
use crate::medial::exact::{balls, tangent_normals};
use crate::medial::tree::NodeKind;
use crate::medial::{MedialPrimitive, MedialSphere};

/// How much deeper than a contact the other body may be along its normal, if it is to shield a part, in units of the
/// part's thickness: what slides is tilted a little. Larger, and it may be deep in the part.
const SHIELD_DEPTH: Real = 0.1;

/// Cosine of the steepest fold at which a part's face rises above the one that shields it (3.6°): beyond it the body is
/// struck at the rim of the next part, under the normal found.
const FOLD: Real = 0.998;

/// A convex part of a body: a primitive, or the piece that a node holds.
#[derive(Clone, Copy)]
enum PieceOrPrimitive {
    Primitive(u32),
    Piece(u32),
}

impl PieceOrPrimitive {
    /// The part that a node of a body holds, if it is one.
    fn of_node(body: &impl PrimitiveTree, node: u32) -> Option<Self> {
        match (body.convex_piece(node), body.kind(node)) {
            (Some(_), _) => Some(Self::Piece(node)),
            (None, NodeKind::Primitive(p)) => Some(Self::Primitive(p)),
            (None, NodeKind::Nodes(..)) => None,
        }
    }

    /// Whether it is the same as another one, or the two bound one convex body.
    fn is(self, body: &impl PrimitiveTree, other: Self) -> bool {
        match (self, other) {
            (Self::Piece(a), Self::Piece(b)) => a == b,
            (Self::Primitive(p), Self::Primitive(q)) => body.convex_part(p).contains(&q),
            (Self::Piece(node), Self::Primitive(p)) | (Self::Primitive(p), Self::Piece(node)) => {
                body.piece_of(p) == Some(node)
            }
        }
    }

    /// The spheres whose hull it is, in the body's frame.
    fn spheres(self, body: &impl PrimitiveTree) -> Vec<MedialSphere> {
        match self {
            Self::Primitive(p) => {
                let (spheres, share) = body.primitive(p);
                spheres[..share.spheres].to_vec()
            }
            Self::Piece(node) => {
                let piece = body.convex_piece(node);
                piece.map_or_else(Vec::new, |piece| piece.spheres.clone())
            }
        }
    }

    /// The spheres of the whole convex body that it is of: of a cuboid's face, those of all faces.
    fn solid(self, body: &impl PrimitiveTree) -> Vec<MedialSphere> {
        match self {
            Self::Primitive(p) => {
                let all = body.convex_part(p);
                all.flat_map(|p| Self::Primitive(p).spheres(body)).collect()
            }
            Self::Piece(_) => self.spheres(body),
        }
    }

    /// The thickness, a length: of a primitive its least radius.
    fn thickness(self, body: &impl PrimitiveTree) -> Real {
        match self {
            Self::Primitive(_) => {
                let radii = self.spheres(body).into_iter().map(|s| s.radius);
                radii.fold(Real::MAX, Real::min)
            }
            Self::Piece(node) => body.convex_piece(node).map_or(0.0, |piece| piece.thickness),
        }
    }

    /// How deep a point of the body's frame is in it, a length.
    fn depth(self, body: &impl PrimitiveTree, point: Vector) -> Real {
        let nearest = match self {
            Self::Primitive(p) => p,
            Self::Piece(node) => nearest_primitive(body, node, Vec3::from_vector(point)),
        };
        -primitive(body, nearest).signed_distance(point).distance
    }

    /// The outward unit normal of its flat face that faces along `n` most, in the body's frame; `None` where it has
    /// none.
    fn face_normal(self, body: &impl PrimitiveTree, n: Vector) -> Option<Vector> {
        let most = |a: &Vector, b: &Vector| a.dot(n).total_cmp(&b.dot(n));
        match self {
            Self::Primitive(p) => {
                let faces = tangent_normals(&balls(primitive(body, p).as_slab()))?;
                faces.into_iter().map(|face| face.to_vector()).max_by(most)
            }
            Self::Piece(node) => {
                let faces = body.convex_piece(node)?.faces.iter();
                faces.map(|face| face.normal).max_by(most)
            }
        }
    }
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

/// How far spheres of a body that is at `pose` reach along a unit direction, a length.
fn reach(spheres: &[MedialSphere], pose: &Pose, n: Vector) -> Real {
    let heights = spheres.iter().map(|s| n.dot(pose * s.center) + s.radius);
    heights.fold(Real::MIN, Real::max)
}

/// The largest coordinate of spheres of a body that is at `pose`, and in the body's own frame, a length.
fn size(spheres: &[MedialSphere], pose: &Pose) -> Real {
    let sizes = spheres.iter().map(|s| {
        let placed = (pose * s.center).abs().max_element();
        placed.max(s.center.abs().max_element()) + s.radius
    });
    sizes.fold(0.0, Real::max)
}

impl<A: PrimitiveTree, B: PrimitiveTree> Query<'_, A, B> {
    /// The contact that shields the one of an answer, if there is any: its normal is in the first body's frame, each
    /// point in its own body's. Parts that touched at the start may shield others; at the floor instead those that hold
    /// the place of the contact, whether they touched or not.
    pub(super) fn shielding_contact(&self, toi: &Toi) -> Option<SpherePair> {
        let search = self.search.as_ref()?;
        let is_floor = search.cores.is_some_and(|cores| cores.share > 0.0);
        if toi.status != ToiStatus::Contact {
            return None;
        }
        let bodies = (search.sides.0.body, search.sides.1.body);
        let parts_of = |[i, j]: [u32; 2]| {
            let first = PieceOrPrimitive::of_node(bodies.0, i)?;
            Some([first, PieceOrPrimitive::of_node(bodies.1, j)?])
        };
        let hidden = match &search.met {
            Some(met) => parts_of(met.nodes)?,
            None => toi.primitives.map(PieceOrPrimitive::Primitive),
        };
        let poses = [0, 1].map(|side| self.pose_at(side, toi.lower));
        let pos12 = poses[0].inv_mul(&poses[1]);
        let gap = (toi.points[1] - toi.points[0]).dot(toi.normal);
        let near: Vec<[u32; 2]> = if is_floor {
            let places = [0, 1].map(|side| poses[side].inverse_transform_point(toi.points[side]));
            let seconds = nodes_that_hold(bodies.1, places[1]);
            let firsts = nodes_that_hold(bodies.0, places[0]).into_iter();
            firsts
                .flat_map(|i| seconds.iter().map(move |j| [i, *j]))
                .collect()
        } else {
            search.touching.iter().map(|(nodes, _)| *nodes).collect()
        };
        let are_whole = [is_one_part(bodies.0), is_one_part(bodies.1)];
        let contacts = near.into_iter().filter_map(|nodes| {
            let parts = parts_of(nodes)?;
            let side = match [
                parts[0].is(bodies.0, hidden[0]),
                parts[1].is(bodies.1, hidden[1]),
            ] {
                [false, true] => 0,
                [true, false] => 1,
                _ => return None,
            };
            if is_floor && !are_whole[1 - side] {
                return None;
            }
            let contact = match parts {
                [
                    PieceOrPrimitive::Primitive(p),
                    PieceOrPrimitive::Primitive(q),
                ] => of_primitives(bodies, [p, q], &pos12, gap),
                _ => of_pieces(bodies, nodes, &pos12, gap),
            }?;
            let shield = (parts[side], &contact);
            let normal = match side {
                0 => shields(bodies, 0, shield, (hidden, toi), &poses),
                _ => shields((bodies.1, bodies.0), 1, shield, (hidden, toi), &poses),
            }?;
            Some(SpherePair { normal, ..contact })
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

/// Whether a body is one convex part.
fn is_one_part(body: &impl PrimitiveTree) -> bool {
    let part = |node| PieceOrPrimitive::of_node(body, node);
    let first = part(0);
    let is_first = |node| part(node).zip(first).is_some_and(|(a, b)| a.is(body, b));
    (0..body.roots()).all(is_first)
}

/// The nodes whose parts hold a point of the body's frame, rounding apart.
fn nodes_that_hold(body: &impl PrimitiveTree, point: Vector) -> Vec<u32> {
    let mut left: Vec<u32> = (0..body.roots()).collect();
    let mut found = Vec::new();
    while let Some(node) = left.pop() {
        let (center, radius) = body.bound(node);
        let slack = HEIGHT_ROUNDING * (center.abs().max_element() + radius);
        if center.distance(point) > radius + slack {
            continue;
        }
        match (PieceOrPrimitive::of_node(body, node), body.kind(node)) {
            (Some(part), _) => found.extend((part.depth(body, point) >= -slack).then_some(node)),
            (None, NodeKind::Nodes(a, b)) => left.extend([b, a]),
            (None, NodeKind::Primitive(_)) => {}
        }
    }
    found
}

/// The deepest contact of two primitives that are no farther apart than `gap` (a length) or overlap; the second body is
/// at `pos12` in the frame of the first.
fn of_primitives(
    bodies: (&impl PrimitiveTree, &impl PrimitiveTree),
    primitives: [u32; 2],
    pos12: &Pose,
    gap: Real,
) -> Option<SpherePair> {
    let mut found = ContactList::new(gap.max(0.0).into());
    let place = Placement::new(pos12);
    let pair = PrimitivePair::new(bodies.0, bodies.1, primitives, &place);
    pair.contacts(&mut found, &mut Counts::default());
    let contacts = found.into_contacts().into_iter();
    contacts.min_by(|a, b| a.distance.total_cmp(&b.distance))
}

/// The contact of the parts that two nodes hold, of which one at least is a piece of several primitives: in the middle
/// of faces that lie on each other, or else where they are nearest.
fn of_pieces(
    (first, second): (&impl PrimitiveTree, &impl PrimitiveTree),
    nodes: [u32; 2],
    pos12: &Pose,
    gap: Real,
) -> Option<SpherePair> {
    let gap = f64::from(gap.max(0.0));
    let turned = |n: Vector| Vec3::from_vector(pos12.rotation * n);
    let hulls = [
        PlacedHull::of_node(first, nodes[0], Vec3::from_vector, Vec3::from_vector),
        PlacedHull::of_node(second, nodes[1], |p| Vec3::from_vector(pos12 * p), turned),
    ];
    let hulls = hulls.each_ref();
    let found = hull_gap(hulls, gap);
    if found.gap > gap {
        return None;
    }
    let n = found.direction;
    let points = match patch(hulls, n, found.gap, [gap; 2]) {
        (Some(patch), _) => {
            let half = n * (0.5 * found.gap);
            [patch.middle - half, patch.middle + half]
        }
        (None, _) => nearest_points(hulls, found).nearest?,
    };
    let local = [
        points[0],
        Vec3::from_vector(pos12.inverse_transform_point(points[1].to_vector())),
    ];
    Some(SpherePair {
        primitives: [
            nearest_primitive(first, nodes[0], local[0]),
            nearest_primitive(second, nodes[1], local[1]),
        ],
        feature: 0,
        distance: found.gap as Real,
        normal: n.to_vector(),
        points: local.map(|p| p.to_vector()),
    })
}

/// The normal, in the first body's frame, that the contact found gets from one with the `shield`, another part of
/// `body`, if that shields it. `body` is the first or the second of the query (`side`).
fn shields(
    (body, other): (&impl PrimitiveTree, &impl PrimitiveTree),
    side: usize,
    (shield, contact): (PieceOrPrimitive, &SpherePair),
    (hidden, found): ([PieceOrPrimitive; 2], &Toi),
    poses: &[Pose; 2],
) -> Option<Vector> {
    if !body.is_medial() {
        return None;
    }
    let outward: Real = if side == 0 { 1.0 } else { -1.0 };
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
    let [first, second] = &contacts;
    let (pose, parts) = (&poses[side], [shield, hidden[side]]);
    let spheres = parts.map(|part| part.spheres(body));
    let slack = HEIGHT_ROUNDING * size(&spheres[0], pose).max(size(&spheres[1], pose));
    // Only the face of a solid that touches need be beyond the contact's plane.
    let n = first.normal;
    let lowest = -reach(&hidden[1 - side].solid(other), &poses[1 - side], -n);
    let sunk = SHIELD_DEPTH * parts[1].thickness(body);
    if lowest - n.dot(first.place) < first.gap.min(0.0) - sunk - slack {
        return None;
    }
    let reach = |part: u32, n: Vector| reach(&spheres[part as usize], pose, n);
    if ghosts(&contacts, reach, |_| slack)[1] {
        return Some(contact.normal);
    }
    // The part ahead rises above the one that the body lies on, and the body is to meet its face.
    let place = pose.inverse_transform_point(second.place);
    if first.gap > second.gap || shield.depth(body, place) < -slack {
        return None;
    }
    let face = parts[1].face_normal(body, pose.rotation.inverse() * n)?;
    let face = pose.rotation * face;
    let is_nearer = face.dot(n) > second.normal.dot(n);
    (is_nearer && face.dot(n) > FOLD).then(|| poses[0].rotation.inverse() * (face * outward))
}
