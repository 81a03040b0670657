//! Signed distance of two bodies at fixed poses, and the pair of spheres that attains it: a best-first search over both
//! trees, the nearest pair of nodes first. Two convex pieces that are apart are looked at as a whole: one pair of their
//! primitives as far apart as their hulls is enough.
//!
//! For bodies that overlap it is the most negative distance of any two primitives: how deep the nearest spheres are in
//! each other, not how far the bodies must move to be apart.

use super::contact_list::ContactList;
use super::first_contact::Counts;
use super::hulls::Hulls;
use super::outline;
use super::placement::Placement;
use super::primitive_pair::PrimitivePair;
use super::primitive_tree::PrimitiveTree;
use super::sphere_pair::SpherePair;
use crate::math::lane::Vec3;
use crate::math::least_first::least_first;
use crate::math::{Pose, Real};
use crate::medial::tree::NodeKind;
use std::collections::BinaryHeap;

/// Which sphere pair is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// The nearest one.
    Nearest,
    /// Any.
    Any,
}

/// The nearest pair of spheres of two bodies at fixed poses, if they are within `max_distance` (a length) of each
/// other. `pos12` is the pose of the second body in the frame of the first. Computed in double precision. A pose
/// that is not finite gives `None`.
pub fn nearest_spheres(
    body1: &impl PrimitiveTree,
    body2: &impl PrimitiveTree,
    pos12: &Pose,
    max_distance: Real,
) -> (Option<SpherePair>, Counts) {
    near_spheres(body1, body2, pos12, max_distance, Wanted::Nearest)
}

/// A sphere pair of two bodies that is within `max_distance`: as [`nearest_spheres`], or any.
pub fn near_spheres(
    body1: &impl PrimitiveTree,
    body2: &impl PrimitiveTree,
    pos12: &Pose,
    max_distance: Real,
    wanted: Wanted,
) -> (Option<SpherePair>, Counts) {
    let mut counts = Counts::default();
    if !pos12.is_finite() || max_distance.is_nan() {
        return (None, counts);
    }
    let place = Placement::new(pos12);
    let mut best = NearestSoFar {
        pair: None,
        limit: max_distance.into(),
    };
    // Directions tell little of what is far.
    let near = if body1.roots() > 0 && max_distance < body1.bound(0).1 {
        outline::near(body1, body2, |p| place.point(p), max_distance)
    } else {
        Some(outline::NearPrimitives::default())
    };
    let Some(near) = near else {
        return (None, counts);
    };
    let mut heap = BinaryHeap::new();
    let entry = |i: u32, j: u32| Entry::of_balls((body1, body2), &place, [i, j]);
    for i in 0..body1.roots() {
        heap.extend((0..body2.roots()).map(|j| entry(i, j)));
    }
    let mut hulls = Hulls::new((body1, body2), &place);
    while let Some(mut e) = heap.pop() {
        if e.bound > best.limit || (best.pair.is_some() && wanted == Wanted::Any) {
            break;
        }
        let [i, j] = e.nodes;
        if !near.meet([i, j]) {
            continue;
        }
        if !e.of_hulls {
            counts.nodes += 1;
            e.bound = e.bound.max(hulls.gap(e.nodes, best.limit));
            e.of_hulls = true;
            if heap.peek().is_some_and(|next| *next > e) {
                heap.push(e);
                continue;
            }
            if e.bound > best.limit {
                break;
            }
        }
        if let Some(near) = hulls.pieces_nearest(e.nodes, best.limit) {
            if let Some(pair) = near.primitives {
                best.try_pair(PrimitivePair::new(body1, body2, pair, &place), &mut counts);
            }
            if best.is_no_farther_than(near.hull.gap) {
                continue;
            }
        }
        match (body1.kind(i), body2.kind(j)) {
            (NodeKind::Primitive(p), NodeKind::Primitive(q)) => {
                best.try_pair(
                    PrimitivePair::new(body1, body2, [p, q], &place),
                    &mut counts,
                );
            }
            (NodeKind::Nodes(c, d), other)
                if e.first_is_larger || matches!(other, NodeKind::Primitive(_)) =>
            {
                heap.extend([entry(c, j), entry(d, j)]);
            }
            (_, NodeKind::Nodes(c, d)) => heap.extend([entry(i, c), entry(i, d)]),
            // The guard above takes every pair with nodes on the left and none on the right.
            (NodeKind::Nodes(..), NodeKind::Primitive(_)) => {}
        }
    }
    (best.pair, counts)
}

/// The nearest pair of spheres so far.
struct NearestSoFar {
    pair: Option<SpherePair>,
    /// Distance of the nearest pair found, or the largest that counts before one is found.
    limit: f64,
}

impl NearestSoFar {
    /// Whether nothing that is apart by `gap` can be nearer.
    fn is_no_farther_than(&self, gap: f64) -> bool {
        // The answer is in single precision; what is asked for is exact.
        let rounding = match self.pair {
            Some(_) => f64::from(Real::EPSILON) * self.limit,
            None => 0.0,
        };
        gap > self.limit - rounding
    }

    /// Takes the nearest spheres of two primitives, if no others are nearer.
    fn try_pair(&mut self, pair: PrimitivePair, counts: &mut Counts) {
        let mut found = ContactList::new(self.limit);
        pair.contacts(&mut found, counts);
        for c in found.into_contacts() {
            if f64::from(c.distance) <= self.limit {
                (self.pair, self.limit) = (Some(c), c.distance.into());
            }
        }
    }
}

/// An entry of the queue: two nodes with a lower bound of their distance, the nearest first.
struct Entry {
    bound: f64,
    nodes: [u32; 2],
    first_is_larger: bool,
    /// Whether the bound is that of the hulls, not only of the balls.
    of_hulls: bool,
}

impl Entry {
    /// Two nodes with the bound that their balls give.
    fn of_balls(
        bodies: (&impl PrimitiveTree, &impl PrimitiveTree),
        place: &Placement,
        [i, j]: [u32; 2],
    ) -> Self {
        let (a, b) = (bodies.0.bound(i), bodies.1.bound(j));
        let y = place.point(b.0) - Vec3::from_vector(a.0);
        Self {
            bound: y.length() * (1.0 - 1.0e-12) - f64::from(a.1) - f64::from(b.1),
            nodes: [i, j],
            first_is_larger: a.1 >= b.1,
            of_hulls: false,
        }
    }
}

least_first!(Entry, bound, nodes);
