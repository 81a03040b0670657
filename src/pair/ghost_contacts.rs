//! Ghost contacts: contacts of a convex part of a body that its neighbours shield. A ball on a level plate of several
//! slabs is near the rim of the next slab, which is within the plate or in line with its top, under a normal that is
//! aslant; a solver that keeps the ball from that rim throws it up. So it is on a compound of level cuboids.
//!
//! A contact says that the other shape stays beyond a plane. It is a ghost of another, deeper contact with the same
//! convex part of the other shape, if the body's part there reaches beyond the ghost's plane by more than the ghost's
//! gap, while the ghost's own part stays behind the plane of the other. The other contact then keeps both parts from
//! the other shape. In a corner neither plane has both parts behind it, and both contacts stay. This is of the poses at
//! hand: what turns about a contact may meet a part that it shields now, and has that contact in the next step.

use crate::math::{Real, Vector};

/// Cosine from which two normals are one (0.8°).
const PARALLEL: Real = 0.9999;

/// Contacts of a part in one plane, whose unit normals differ by at most this length, are compared with others as one.
const ONE_PLANE: Real = 1.0e-5;

/// Largest number of deeper contacts, none of them a ghost, that each contact is compared with. Contacts of one part in
/// one plane count as one. A body that lies on tiles has several contacts with each, and may meet a wall besides.
const COMPARED: usize = 128;

/// A contact in the frame of a body of convex parts.
#[derive(Clone, Copy, Debug)]
pub struct PartContact {
    /// A number of the body's part.
    pub part: u32,
    /// A number of the other shape's convex part.
    pub other: u32,
    /// The point on the body.
    pub place: Vector,
    /// Unit normal, out of the body.
    pub normal: Vector,
    /// Signed distance, a length.
    pub gap: Real,
}

/// Whether each contact is a ghost. `reach` is how far a part reaches along a unit direction, a length; heights of a
/// part that differ by up to its `slack`, a length, are equal.
pub fn ghosts(
    contacts: &[PartContact],
    reach: impl Fn(u32, Vector) -> Real,
    slack: impl Fn(u32) -> Real,
) -> Vec<bool> {
    let mut ghosts = vec![false; contacts.len()];
    let first = contacts.first().map_or(Vector::ZERO, |c| c.normal);
    let is_first = |c: &PartContact| c.normal.dot(first) >= PARALLEL;
    if contacts.iter().all(is_first) {
        return ghosts;
    }
    // How far a part reaches beyond a contact's plane.
    let beyond = |c: &PartContact, part: u32| reach(part, c.normal) - c.normal.dot(c.place);
    let mut order: Vec<usize> = (0..contacts.len()).collect();
    order.sort_unstable_by(|i, j| {
        let [a, b] = [&contacts[*i], &contacts[*j]];
        a.other
            .cmp(&b.other)
            .then(a.gap.total_cmp(&b.gap))
            .then(i.cmp(j))
    });
    for group in order.chunk_by(|i, j| contacts[*i].other == contacts[*j].other) {
        let mut kept: Vec<&PartContact> = Vec::new();
        for &i in group {
            let c = &contacts[i];
            ghosts[i] = kept.iter().any(|deeper| {
                deeper.normal.dot(c.normal) < PARALLEL
                    && beyond(deeper, c.part) <= slack(c.part)
                    && beyond(c, deeper.part) > c.gap.max(0.0) + slack(deeper.part)
            });
            let is_known = |k: &&PartContact| {
                k.part == c.part
                    && k.normal.distance(c.normal) <= ONE_PLANE
                    && k.normal.dot(c.place - k.place).abs() <= slack(c.part)
            };
            if !ghosts[i] && kept.len() < COMPARED && !kept.iter().any(is_known) {
                kept.push(c);
            }
        }
    }
    ghosts
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The reach of parts that are boxes, by their centres and half sides.
    fn reach(boxes: &[(Vector, Vector)]) -> impl Fn(u32, Vector) -> Real {
        |part, n| {
            let (at, half) = boxes[part as usize];
            n.dot(at) + n.abs().dot(half)
        }
    }

    fn contact(part: u32, place: [Real; 3], normal: [Real; 3], gap: Real) -> PartContact {
        PartContact {
            part,
            other: 0,
            place: place.into(),
            normal: Vector::from(normal).normalize(),
            gap,
        }
    }

    /// Two boxes side by side, each 1 m wide, the tops of which are at height 0 and `step`, moved by `off`.
    fn two_boxes(step: Real, off: Vector) -> [(Vector, Vector); 2] {
        [(-0.5, 0.0), (0.5, step)]
            .map(|(x, top)| (off + Vector::new(x, top - 0.5, 0.0), Vector::splat(0.5)))
    }

    fn found(boxes: &[(Vector, Vector)], contacts: &[PartContact]) -> Vec<bool> {
        ghosts(contacts, reach(boxes), |_| 1.0e-5)
    }

    /// A ball above the first box, with a contact on it and one ahead on the rim of the second.
    fn on_first(off: Vector, height: Real) -> [PartContact; 2] {
        let rim = Vector::new(0.0, height, 0.0) + off;
        [
            contact(0, (off - Vector::X * 0.1).into(), [0.0, 1.0, 0.0], 0.001),
            contact(1, rim.into(), [-0.5, 1.0, 0.0], 0.01),
        ]
    }

    #[test]
    fn the_rim_of_a_level_neighbour_is_a_ghost_at_any_place() {
        for off in [Vector::ZERO, Vector::new(10.0, -20.0, 5.0)] {
            let [low, rim] = on_first(off, 0.0);
            let boxes = two_boxes(0.0, off);
            assert_eq!(found(&boxes, &[low, rim]), [false, true]);
            assert_eq!(found(&boxes, &[rim, low]), [true, false]);
            // Below the top, too: the first box's plane has it behind it.
            assert_eq!(
                found(&two_boxes(-0.2, off), &on_first(off, -0.2)),
                [false, true]
            );
        }
    }

    #[test]
    fn a_step_is_met() {
        let contacts = on_first(Vector::ZERO, 0.001);
        assert_eq!(
            found(&two_boxes(0.001, Vector::ZERO), &contacts),
            [false; 2]
        );
    }

    #[test]
    fn the_rim_of_a_deeper_contact_stays() {
        let [low, rim] = on_first(Vector::ZERO, 0.0);
        let deeper = PartContact { gap: -0.001, ..rim };
        assert_eq!(
            found(&two_boxes(0.0, Vector::ZERO), &[low, deeper]),
            [false; 2]
        );
    }

    #[test]
    fn a_corner_and_a_ridge_keep_both_contacts() {
        // A ball in the corner of a floor and a wall.
        let corner = [
            (Vector::new(0.0, -0.5, 0.0), Vector::splat(0.5)),
            (Vector::new(1.0, 0.5, 0.0), Vector::splat(0.5)),
        ];
        let contacts = [
            contact(0, [0.4, 0.0, 0.0], [0.0, 1.0, 0.0], 0.001),
            contact(1, [0.5, 0.1, 0.0], [-1.0, 0.0, 0.0], 0.002),
        ];
        assert_eq!(found(&corner, &contacts), [false; 2]);
        // A body on the common edge of two roofs, each behind the plane of the other.
        let contacts = [
            contact(0, [-0.1, 0.0, 0.0], [-0.1, 1.0, 0.0], 0.001),
            contact(1, [0.1, 0.0, 0.0], [0.1, 1.0, 0.0], 0.002),
        ];
        let ridge = |part: u32, n: Vector| {
            let side = if part == 0 { -1.0 } else { 1.0 };
            let corners = [(0.0, 0.01), (side, -0.09), (side, -1.0), (0.0, -1.0)];
            let heights = corners.map(|(x, y)| n.dot(Vector::new(x, y, 0.0)));
            heights.into_iter().fold(Real::MIN, Real::max)
        };
        assert_eq!(ghosts(&contacts, ridge, |_| 1.0e-5), [false; 2]);
    }

    #[test]
    fn contacts_with_another_part_of_the_other_shape_hide_nothing() {
        let [low, rim] = on_first(Vector::ZERO, 0.0);
        let elsewhere = PartContact { other: 1, ..rim };
        assert_eq!(
            found(&two_boxes(0.0, Vector::ZERO), &[low, elsewhere]),
            [false; 2]
        );
    }

    #[test]
    fn what_is_not_a_number_is_kept() {
        let [low, rim] = on_first(Vector::ZERO, 0.0);
        let broken = PartContact {
            place: Vector::NAN,
            ..rim
        };
        assert_eq!(
            found(&two_boxes(0.0, Vector::ZERO), &[low, broken]),
            [false; 2]
        );
    }
}
