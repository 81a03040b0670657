//! The part of the search for a first contact ([`super::search`]) that deals with convex pieces: parts of a body that
//! are the hull of a few spheres, although many primitives make them up. One direction that keeps two pieces apart does
//! so for all their primitives, and where none does, the pieces meet: only a few of their primitives are ever looked
//! at. Which pieces there are: `medial/convex_pieces.rs`; their contacts at fixed poses: [`super::face_contacts`].
//!
//! Conservative advancement (Mirtich 1996) along the direction of the largest gap of the hulls at one time after the
//! other. Along chords ([`super::apart`]) and along the paths themselves ([`super::path_ends`]) a direction keeps them
//! apart for a while.
//!
//! **Pieces that touch at the start** and may sink in, or must come nearer to count
//! ([`crate::elementary::InitialContact`]), have a gap of their own at which they meet. Where they are so deep in each
//! other that the shortest way apart might lead on through, their primitives decide. If they may not sink in, those
//! that are apart meet at the start; of those that overlap their primitives decide.

use super::apart::{end_along, ends_hold};
use super::deepening::given;
use super::hull_gap::{HullGap, PlacedHull, hull_gap};
use super::path_ends::{held_on_paths, held_turning, moving_spheres};
use super::piece_contact::{PieceGap, PieceLook, PiecePair, PiecesMet, is_blunt, patch, placed};
use super::primitive_tree::{PrimitiveTree, thickness};
use super::search::FirstContactSearch;
use crate::elementary::bracket::Bracket;
use crate::elementary::penetration::gap_along;
use crate::elementary::test_list::{OwnedFeatures, for_each_test};
use crate::elementary::{InitialContact, ToiStatus};
use crate::math::tolerance::F64_ROUNDING;

/// Depth of two solid pieces in units of the thickness of the thinner, from which the shortest way apart may lead on
/// through: there the middles of two alike pass each other.
const MAX_RELIABLE_DEPTH: f64 = 2.0;

/// The same depth for a piece in a surface, in units of the thickness of the piece.
const MAX_RELIABLE_DEPTH_IN_SURFACE: f64 = 1.0;

/// How deep two solid pieces may get in the same units, to be settled as a whole. Their primitives, which decide beyond
/// it, point out of thin pieces on both sides: at 1.5, thirty cards that are dropped on each other are not at rest
/// after 150 steps, at 1.95 they sleep after 106.
const MAX_PIECE_DEPTH: f64 = 1.95;

/// The same depth for a piece in a surface, in units of the thickness of the piece.
const MAX_PIECE_DEPTH_IN_SURFACE: f64 = 0.75;

/// Distance below the gap at which pieces meet, in units of the tolerance, that a step of the search aims at. At 1 it
/// would be the target distance itself, and pieces that come no nearer than that would not be found free.
const AIM_BELOW: f64 = 0.99;

/// How much farther apart than where pieces meet their faces may be, in units of the tolerance, to lie on each other:
/// of pieces that touched at the start, and of others. Bodies at rest are tilted by the first, because rapier's solver
/// lets them sink into what they lie on: at 1, a box that slides over a floor into a post is struck at one end of its
/// edge, and tips into the floor; at 300, twice as many bricks are frozen in walls of very unlike ones. What falls from
/// outside may be tilted by more: at 3, bricks turn four times as fast after an almost flat fall as at 300, from where
/// on nothing changes.
const LEVEL: [f64; 2] = [3.0, 300.0];

impl<A: PrimitiveTree, B: PrimitiveTree> FirstContactSearch<'_, A, B> {
    /// Looks at two nodes, proven free until a time, as convex pieces.
    pub(super) fn look_at_pieces(&mut self, [i, j]: [u32; 2], time: f64) -> PieceLook {
        let nodes = [self.sides.0.node(i).node, self.sides.1.node(j).node];
        if !(self.sides.0.body.is_convex(nodes[0]) && self.sides.1.body.is_convex(nodes[1])) {
            return PieceLook::Split;
        }
        let pieces = match self.convex.get(&nodes) {
            Some(pieces) => *pieces,
            None => {
                let pieces = self.begin_pieces(nodes, time);
                self.convex.insert(nodes, pieces);
                pieces
            }
        };
        let Some(mut pieces) = pieces else {
            return PieceLook::Split;
        };
        self.sides.0.sweep_piece(i);
        self.sides.1.sweep_piece(j);
        let look = self.advance_pieces([i, j], nodes, &mut pieces, time);
        self.convex.insert(nodes, Some(pieces));
        look
    }

    /// The gap at which two pieces meet; `None` if their primitives decide. Notes that they touch at the start, where
    /// they do and may.
    fn begin_pieces(&mut self, nodes: [u32; 2], time: f64) -> Option<PiecePair> {
        let (a, b) = (self.sides.0.body, self.sides.1.body);
        let thicknesses = [thickness(a, nodes[0]), thickness(b, nodes[1])];
        let thickness = self.at_most(thicknesses[0].min(thicknesses[1]));
        let depth = self.cores.map_or(0.0, |cores| cores.depth(thicknesses));
        let touching = self.target + self.earliest.limits.tolerance;
        let by = match self.initial_contact {
            // Deeper, each pair of primitives has a target of its own.
            InitialContact::Stop if self.target < 0.0 => return None,
            InitialContact::Stop => None,
            InitialContact::Deepen { by } | InitialContact::Approach { by } => Some(f64::from(by)),
        };
        let is_known_apart = self.is_known_apart(time);
        let at = if is_known_apart { time } else { 0.0 };
        self.looks += 1;
        let hulls = self.placed(nodes, at);
        let (mut found, mut known) = (hull_gap(hulls.each_ref(), touching), None);
        if !is_known_apart && found.gap <= touching {
            // How deep they are in each other their primitives say.
            if by.is_none() && (found.gap <= 0.0 || depth > 0.0) {
                return None;
            }
            // Where parry was not asked, no direction has more.
            if found.nearest.is_some() {
                let near = self.nearest(nodes, hulls.each_ref(), found, at);
                (found, known) = (near.hull, Some((at, near)));
            }
        }
        let touches = !is_known_apart && found.gap <= touching;
        // How deep cores are is not how deep pieces are, but for those that touch and have no sharp tips.
        let is_blunt = || is_blunt(a, nodes[0]) && is_blunt(b, nodes[1]);
        if depth > 0.0 && !(touches && is_blunt()) {
            return None;
        }
        let is_solid = thicknesses.iter().all(|t| t.is_finite());
        let (deepest, through) = if is_solid {
            (MAX_PIECE_DEPTH, MAX_RELIABLE_DEPTH)
        } else {
            (MAX_PIECE_DEPTH_IN_SURFACE, MAX_RELIABLE_DEPTH_IN_SURFACE)
        };
        let contact = match by.filter(|_| touches && found.gap <= touching - depth) {
            None => touching - depth,
            Some(f64::INFINITY) => {
                return Some(PiecePair {
                    contact: f64::NEG_INFINITY,
                    touched: false,
                    direction: found.direction,
                    known,
                });
            }
            Some(by) => {
                let left = through * thickness + found.gap;
                found.gap - given(by, left.max(0.0), self.earliest.limits.tolerance)
            }
        };
        if -contact > deepest * thickness {
            return None;
        }
        let touched = contact < touching - depth;
        if touched {
            let deepest = (contact - (touching - depth)) / thickness;
            self.touching.push((nodes, deepest));
        }
        Some(PiecePair {
            contact,
            touched,
            direction: found.direction,
            known,
        })
    }

    /// Goes on from a time at which two pieces are not known to meet.
    fn advance_pieces(
        &mut self,
        swept: [u32; 2],
        nodes: [u32; 2],
        pieces: &mut PiecePair,
        time: f64,
    ) -> PieceLook {
        let mut free = self.pieces_held_until(swept, nodes, pieces, time);
        let mut found = None;
        let mut known = pieces.known.take().filter(|(at, _)| *at == time);
        // First any direction that keeps them apart now, then that of the largest gap.
        for is_last in [false, true] {
            match free {
                None => return PieceLook::Free,
                Some(free) if !self.gains_too_little(free, time) => {
                    return PieceLook::FreeUntil(free);
                }
                Some(_) => {}
            }
            let known = known.take();
            let is_last = is_last || known.is_some();
            self.looks += u64::from(known.is_none());
            let placed = self.placed(nodes, time);
            let [a, b] = placed.each_ref().map(|hull| &hull.spheres[..]);
            let before = gap_along(a, b, pieces.direction);
            let enough = if is_last { f64::MAX } else { pieces.contact };
            let mut near = match known {
                Some((_, near)) => near,
                None => {
                    // A gap that was not enough is the largest that can be found.
                    let hull = match found {
                        Some(hull) => hull,
                        None => hull_gap(placed.each_ref(), enough),
                    };
                    found = (hull.gap <= enough).then_some(hull);
                    match is_last {
                        false => PieceGap::of(hull),
                        true => self.nearest(nodes, placed.each_ref(), hull, time),
                    }
                }
            };
            if before > near.hull.gap {
                (near.hull.gap, near.hull.direction) = (before, pieces.direction);
            }
            pieces.direction = near.hull.direction;
            if near.hull.gap > pieces.contact {
                let held = self.pieces_held_until(swept, nodes, pieces, time);
                free = free.zip(held).map(|(a, b)| a.max(b));
            } else if is_last {
                // How deep they are, hulls say; how far apart, primitives.
                let is_sure = pieces.contact < 0.0 || near.distance <= pieces.contact;
                return match near.primitives.filter(|_| is_sure) {
                    Some(primitives) => PieceLook::Met(Box::new(PiecesMet::of(
                        nodes,
                        placed.each_ref(),
                        (primitives, near.distance, &near.hull),
                        self.earliest.limits.tolerance,
                    ))),
                    None => PieceLook::Split,
                };
            }
        }
        match free {
            None => PieceLook::Free,
            Some(free) if free > time => PieceLook::FreeUntil(free),
            // Rounding.
            Some(_) => PieceLook::Split,
        }
    }

    /// The distance of two pieces at a time, found from the gap of their hulls.
    fn nearest(
        &self,
        nodes: [u32; 2],
        hulls: [&PlacedHull; 2],
        hull: HullGap,
        time: f64,
    ) -> PieceGap {
        let frames = [0, 1].map(|k| self.motions[k].frame(time));
        let bodies = (self.sides.0.body, self.sides.1.body);
        PieceGap::search(
            (bodies, nodes),
            (hulls, hull),
            |k, p| frames[k].point(p),
            |k, p| frames[k].local(p),
        )
    }

    /// Time until which the direction tried last keeps two pieces from meeting; `None` if until the end.
    fn pieces_held_until(
        &self,
        [i, j]: [u32; 2],
        nodes: [u32; 2],
        pieces: &PiecePair,
        time: f64,
    ) -> Option<f64> {
        let ((a, size_a), (b, size_b)) = (self.sides.0.piece(i), self.sides.1.piece(j));
        let n = pieces.direction;
        // Less than the gap at which they meet, so that a step comes to where they do.
        let least = pieces.contact - AIM_BELOW * self.earliest.limits.tolerance
            + F64_ROUNDING * (size_a + size_b);
        let far: Vec<_> = a.iter().map(|s| end_along(s, n, 1.0)).collect();
        let near: Vec<_> = b.iter().map(|s| end_along(s, n, -1.0)).collect();
        let on_chords = self.in_piece(time, |span| ends_hold([&far, &near], span, least, least))?;
        let [first, second] = &self.motions;
        let a = moving_spheres(self.sides.0.body, first, nodes[0], time);
        let b = moving_spheres(self.sides.1.body, second, nodes[1], time);
        let asked = self.earliest.upper.min(self.times[1]) - time;
        let turning = [(first, &a, &b, 1.0), (second, &b, &a, -1.0)];
        let turning = turning
            .into_iter()
            .filter(|(carrier, ..)| carrier.is_rigid());
        let turning = turning.map(|(carrier, own, others, side)| {
            held_turning((carrier, own), others, (n, side), [time, asked], least)
        });
        let still = std::iter::once_with(|| held_on_paths([&a, &b], n, least, asked));
        let mut held = 0.0;
        for some in turning.chain(still) {
            held = f64::max(held, some?);
        }
        Some(on_chords.max((time + held).next_down().max(time)))
    }

    /// Two nodes' pieces at a time.
    fn placed(&self, [p, q]: [u32; 2], time: f64) -> [PlacedHull<'_>; 2] {
        let [first, second] = &self.motions;
        [
            placed(self.sides.0.body, first, p, time),
            placed(self.sides.1.body, second, q, time),
        ]
    }

    /// Notes that two pieces meet; returns whether an earlier contact is still possible.
    pub(super) fn take_pieces(&mut self, met: PiecesMet, time: f64) -> bool {
        let nodes = met.nodes;
        let touched = self.touched(nodes);
        let approaches = matches!(self.initial_contact, InitialContact::Approach { .. });
        let (met, time) = match touched && approaches {
            true => {
                let placed = self.placed(nodes, 0.0);
                let hull = hull_gap(placed.each_ref(), f64::MAX);
                let near = self.nearest(nodes, placed.each_ref(), hull, 0.0);
                let primitives = near.primitives.unwrap_or(met.primitives);
                let tolerance = self.earliest.limits.tolerance;
                let found = (primitives, near.distance, &near.hull);
                (
                    PiecesMet::of(nodes, placed.each_ref(), found, tolerance),
                    0.0,
                )
            }
            false => (met, time),
        };
        let primitives = met.primitives;
        let shares = self
            .spheres(primitives)
            .map(|(_, share)| OwnedFeatures::whole(share.spheres));
        let mut some_test = None;
        for_each_test(shares[0], shares[1], |test| {
            some_test = Some(test);
            false
        });
        let Some(test) = some_test else {
            return true;
        };
        let mut bracket = Bracket::met(&self.earliest.limits, time, met.gap - self.target);
        if time == 0.0 && self.initial_contact == InitialContact::Stop {
            bracket.start_distance = met.distance - self.target;
        }
        let continues = self
            .earliest
            .take(test, bracket, self.earliest.limits.start, primitives);
        let is_found = |(_, found, by): (_, Bracket<f64>, [u32; 2])| {
            by == primitives && found.nearest.distance == bracket.nearest.distance
        };
        if self.earliest.found.is_some_and(is_found) {
            self.found = None;
            // Where they are nearer than the target at the start, faces that lie on each other may be far from where
            // they are nearest.
            let overlaps = self.earliest.status == ToiStatus::Overlapping;
            self.met = (!overlaps).then_some(met);
        }
        continues
    }

    /// Whether two pieces touched at the start.
    fn touched(&self, nodes: [u32; 2]) -> bool {
        let pieces = self.convex.get(&nodes).copied().flatten();
        pieces.is_some_and(|pieces| pieces.touched)
    }

    /// Finds where all pieces lie on each other in the plane in which two met: triangles of one ground, blocks of one
    /// body.
    pub(super) fn join_pieces(&mut self) {
        self.joined = None;
        let (Some(met), Some((_, found, _))) = (self.met, self.earliest.found) else {
            return;
        };
        let looked_at = self.convex.iter().filter(|(_, pieces)| pieces.is_some());
        let mut all: Vec<[u32; 2]> = looked_at.map(|(nodes, _)| *nodes).collect();
        // In an order that does not depend on how they were found.
        all.sort_unstable();
        let tolerance = self.earliest.limits.tolerance;
        let [level, farther] = LEVEL.map(|level| level * tolerance);
        let margin = match self.touched(met.nodes) {
            true => level,
            false => farther,
        };
        for nodes in all {
            let placed = self.placed(nodes, found.lower);
            let hulls = placed.each_ref();
            let [a, b] = hulls.map(|hull| &hull.spheres[..]);
            // Deeper ones do not lie in this plane: a floor reaches far behind the face of the wall on it.
            let above = gap_along(a, b, met.normal) - met.gap;
            if above < -level || above > margin {
                continue;
            }
            if let (Some(patch), _) = patch(hulls, met.normal, met.gap, [tolerance, margin]) {
                self.joined = Some(self.joined.map_or(patch, |joined| joined.and(&patch)));
            }
        }
    }
}
