//! The part of the search for a first contact ([`super::search`]) that deals with convex pieces: parts of a body that
//! are the hull of a few spheres, although many primitives make them up. One direction that keeps two pieces apart
//! does so for all their primitives, so most pairs of pieces are settled without a look at these. Which pieces there
//! are: `medial/convex_pieces.rs`; their contacts at fixed poses: [`super::face_contacts`].
//!
//! **Pieces that touch at the start** and may sink in ([`InitialContact::Deepen`]) are settled too, where directions prove
//! that in the rest of the step they get deeper by no more than that. Where no directions do, or the pieces are so deep in
//! each other or so thin that the middle of one might get into the other, their primitives decide, each pair with a
//! distance of its own at the start.

use super::apart::{end_along, ends_hold};
use super::hull_gap::{HullGap, PlacedHull, hull_gap};
use super::primitive_tree::{PrimitiveTree, thickness};
use super::search::Search;
use super::swept::Side;
use crate::elementary::InitialContact;
use crate::math::lane::Vec3;
use crate::math::motion::RigidMotion;
use crate::math::tolerance::ROUNDING_ULPS;

/// How deep two pieces may get in units of their thickness, the largest radius in them or less, to be settled as a
/// whole. At 1 the middle of one may touch the other.
const DEEPEST: f64 = 0.5;

/// Work of one look at two pieces, in proofs by directions of two primitives.
const LOOK: u64 = 4;

/// Directions tried one after the other, each from where the last one failed, on pieces that touch at the start. With 4 a
/// row of dominoes takes eight times as long: faces turn away under a direction while one slides down on the next.
const TURNS: usize = 16;

impl<A: PrimitiveTree, B: PrimitiveTree> Search<'_, A, B> {
    /// Time until which two nodes are proven free from `time` on, because they hold convex pieces; `None` if as long as
    /// the search asks, `time` if nothing is proven.
    pub(super) fn pieces_free_until(&mut self, [i, j]: [u32; 2], time: f64) -> Option<f64> {
        let [p, q] = [self.sides.0.node(i).node, self.sides.1.node(j).node];
        if !(self.sides.0.body.is_convex(p) && self.sides.1.body.is_convex(q)) {
            return Some(time);
        }
        self.sides.0.sweep_piece(i);
        self.sides.1.sweep_piece(j);
        let touching = self.reach + self.earliest.limits.tolerance;
        let InitialContact::Deepen { by } = self.initial_contact else {
            return self.apart_until([i, j], time, touching);
        };
        if self.is_known_apart(time) {
            return self.apart_until([i, j], time, touching);
        }
        self.proofs += LOOK;
        let HullGap { gap, direction, .. } =
            hull_gap(self.placed([p, q], 0.0).each_ref(), touching);
        if gap > touching {
            return self.apart_until([i, j], time, touching);
        }
        let thickness = self.pieces_thickness([p, q]);
        let contact = gap - f64::from(by);
        let is_core = self.cores.is_some_and(|cores| cores.share > 0.0);
        if is_core || self.target - contact > DEEPEST * thickness {
            return Some(time);
        }
        let (mut from, mut n) = (time, direction);
        for turn in 0..TURNS {
            if turn > 0 || time > 0.0 {
                // Any direction with room for half of what they may sink in will do for a while.
                let enough = contact + 0.5 * f64::from(by);
                n = hull_gap(self.placed([p, q], from).each_ref(), enough).direction;
            }
            self.proofs += LOOK;
            let Some(free) = self.pieces_held_until([i, j], n, contact, from) else {
                self.touching
                    .push(([p, q], (contact - touching) / thickness));
                return None;
            };
            if !self.soon(free, from) {
                from = free;
                continue;
            }
            break;
        }
        Some(time)
    }

    /// Time until which directions keep two pieces farther apart than `contact` from `time` on.
    fn apart_until(&mut self, [i, j]: [u32; 2], time: f64, contact: f64) -> Option<f64> {
        let [p, q] = [self.sides.0.node(i).node, self.sides.1.node(j).node];
        let mut free = time;
        // First any direction that keeps them apart now, then that of the largest gap.
        for enough in [contact, f64::MAX] {
            self.proofs += LOOK;
            let placed = self.placed([p, q], time);
            let HullGap { gap, direction, .. } = hull_gap(placed.each_ref(), enough);
            if gap <= contact {
                break;
            }
            free = free.max(self.pieces_held_until([i, j], direction, contact, time)?);
            if !self.soon(free, time) {
                break;
            }
        }
        Some(free)
    }

    /// Time until which one direction keeps two pieces farther apart than `contact`; `None` if until the end.
    fn pieces_held_until(
        &self,
        [i, j]: [u32; 2],
        n: Vec3<f64>,
        contact: f64,
        time: f64,
    ) -> Option<f64> {
        let ((a, size_a), (b, size_b)) = (self.sides.0.piece(i), self.sides.1.piece(j));
        let length = n.length();
        let contact = contact + ROUNDING_ULPS * f64::EPSILON * (size_a + size_b);
        let far: Vec<_> = a.iter().map(|s| end_along(s, n, length)).collect();
        let near: Vec<_> = b.iter().map(|s| end_along(s, n, -length)).collect();
        let least = contact * length;
        self.in_piece(time, |span| ends_hold([&far, &near], span, least, least))
    }

    /// Two nodes' pieces at a time.
    fn placed(&self, [p, q]: [u32; 2], time: f64) -> [PlacedHull<'_>; 2] {
        let [first, second] = &self.motions;
        [
            placed(&self.sides.0, first, p, time),
            placed(&self.sides.1, second, q, time),
        ]
    }

    /// Thickness of the thinner of two pieces, or the least number where it has none.
    fn pieces_thickness(&self, [p, q]: [u32; 2]) -> f64 {
        let thinner = thickness(self.sides.0.body, p).min(thickness(self.sides.1.body, q));
        self.at_most(thinner)
    }
}

/// What a node holds at a time, as a hull.
fn placed<'a, V: PrimitiveTree>(
    side: &Side<'a, V>,
    motion: &RigidMotion<f64>,
    node: u32,
    time: f64,
) -> PlacedHull<'a> {
    let turned = motion.sin_cos(time);
    let point = |p| motion.point(Vec3::from_vector(p)).at(time, turned).position;
    let direction = |n| motion.direction(Vec3::from_vector(n), turned);
    PlacedHull::of_node(side.body, node, point, direction)
}
