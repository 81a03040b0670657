//! A list of the primitive pairs of two bodies that may come near each other, on a known motion and on others like
//! it: a pair of bodies that is searched again and again in one step goes down its trees only to these.
//!
//! **What is listed.** On the motion known, from a time `t0` to the end of the step, all primitive pairs that the
//! bounds of the search (`pair::search`) do not prove farther apart than a reach `r` plus a margin `m`.
//!
//! **How long it holds.** On another motion, from `t ≥ t0` to the same end, a point of a body is never farther from
//! where the known motion has it at that time than the two motions drift apart. Let `e(τ)` be the difference of the
//! positions of the centre of rotation, which is linear in time, `θ` the angle between both rotations at `t`, `ω` and
//! `ω'` the angular velocities, and `ρ` the largest distance of a point of the body from that centre. The angle between
//! the rotations grows by `n·(ω' − ω)` per time, where `n` is the axis of the rotation between them, because that
//! rotation does not turn its own axis. So the distance of two bodies' points is off by no more than
//!
//! `d = max over t and end of |e₁ − e₂| + Σ ρ (θ + |ω' − ω| (end − t))`.
//!
//! While `d ≤ m`, primitives that are not listed stay farther apart than `r` ([`NearPairs::holds_for`]).
//!
//! **Why the answer is the same bit by bit.** A search of reach `r` finds no contact in pairs that stay farther apart
//! than that. What it looks at, and in which order, changes only with a contact found, with the pairs that are left in
//! the queue, whose order is that of their times, depths and nodes, and with nothing else. So without these pairs it
//! looks at all others at the same times in the same order.

use super::apart::free_until;
use super::outline::ActivePrimitives;
use super::pair_list::PairList;
use super::primitive_tree::PrimitiveTree;
use super::swept::{Bits, NodeContact, SearchSide, split};
use crate::elementary::first_contact::motion_is_finite;
use crate::math::Real;
use crate::math::lane::Vec3;
use crate::math::motion::RigidMotion;
use crate::math::tolerance::F64_ROUNDING;
use parry3d::query::NonlinearRigidMotion;
use std::sync::Arc;

/// Angle in radians that a body turns at most on a motion that is listed for: more, and sagittas would list too much.
const MOST_ANGLE: f64 = 0.5;

/// Pairs on a list at most. Twice as many as there are bits: with more, as of a nut on its bolt, most of the trees is
/// above some of them, and nothing is spared.
const MAX_LISTED_PAIRS: u32 = 2 * Bits::BITS;

/// Primitive pairs, and pairs of convex pieces, that may come near each other, by the nodes of both trees above them.
/// It may hold others.
pub struct NearPairs {
    pairs: PairList,
    /// Motions that they are listed for, and the step's seconds from their start to its end.
    motions: [NonlinearRigidMotion; 2],
    seconds: f64,
    /// Lengths.
    reach: f64,
    margin: f64,
    /// Node pairs looked at.
    nodes: u32,
}

impl NearPairs {
    /// A list of nothing, for two bodies that never come within `reach` plus `margin` (lengths).
    pub fn none(motions: &[NonlinearRigidMotion; 2], seconds: Real, reaches: [f64; 2]) -> Self {
        Self {
            pairs: PairList::default(),
            motions: *motions,
            seconds: f64::from(seconds),
            reach: reaches[0],
            margin: reaches[1],
            nodes: 0,
        }
    }

    /// Lists what may come within `reach` plus `margin` (lengths) in `seconds`; of what is `left`, where it is known
    /// that nothing else does. `None` for motions that turn too far or are not finite, and where too much is near.
    pub fn new(
        bodies: (&impl PrimitiveTree, &impl PrimitiveTree),
        motions: &[NonlinearRigidMotion; 2],
        seconds: Real,
        reaches: [f64; 2],
        left: Option<[ActivePrimitives; 2]>,
    ) -> Option<Self> {
        let finite = motions.iter().all(motion_is_finite) && reaches.iter().all(|r| r.is_finite());
        if !(finite && seconds.is_finite()) {
            return None;
        }
        let [first, second] = RigidMotion::pair(&motions[0], &motions[1], f64::from(seconds));
        if first.angle().max(second.angle()) > MOST_ANGLE {
            return None;
        }
        let (left1, left2) = left.map_or((None, None), |[a, b]| (Some(a), Some(b)));
        let mut sides = (
            SearchSide::new(bodies.0, first, left1),
            SearchSide::new(bodies.1, second, left2),
        );
        sides.0.begin(0.0, 1.0);
        sides.1.begin(0.0, 1.0);
        let mut list = Self::none(motions, seconds, reaches);
        list.walk(&mut sides).then_some(list)
    }

    /// Whether no more than [`MAX_LISTED_PAIRS`] are near.
    fn walk<A: PrimitiveTree, B: PrimitiveTree>(
        &mut self,
        sides: &mut (SearchSide<A>, SearchSide<B>),
    ) -> bool {
        let reach = self.reach + self.margin;
        let mut listed: [Vec<Bits>; 2] = Default::default();
        let mut count = 0;
        let mut stack = Vec::with_capacity(64);
        for i in 0..sides.0.body.roots() {
            stack.extend((0..sides.1.body.roots()).map(|j| [i, j]));
        }
        while let Some([i, j]) = stack.pop() {
            let (a, b) = (*sides.0.node(i), *sides.1.node(j));
            if a.near & b.near == 0 || matches!(a.touch(&b, reach), NodeContact::Never) {
                continue;
            }
            self.nodes += 1;
            sides.0.sweep_hull(i);
            sides.1.sweep_hull(j);
            let hulls = [sides.0.hull(i), sides.1.hull(j)];
            if free_until(hulls, [0.0, 1.0], reach, 0.0).is_none() {
                continue;
            }
            let convex = [
                sides.0.body.is_convex(a.node),
                sides.1.body.is_convex(b.node),
            ];
            // Convex pieces are listed whole: they are also searched so.
            if convex == [true; 2] {
                for (bits, at) in listed.iter_mut().zip([i, j]) {
                    if bits.len() <= at as usize {
                        bits.resize(at as usize + 1, 0);
                    }
                    bits[at as usize] |= 1 << (count % Bits::BITS);
                }
                count += 1;
                if count > MAX_LISTED_PAIRS {
                    return false;
                }
                continue;
            }
            let [parts_a, parts_b] = split(sides, [i, j]);
            for a in parts_a {
                stack.extend(parts_b.clone().map(|b| [a, b]));
            }
        }
        let [first, second] = listed;
        self.pairs = PairList(Arc::new([
            sides.0.gathered(first),
            sides.1.gathered(second),
        ]));
        true
    }

    /// The primitive pairs.
    pub fn pairs(&self) -> &PairList {
        &self.pairs
    }

    /// Node pairs that were looked at for the list.
    pub fn nodes(&self) -> u32 {
        self.nodes
    }

    /// Whether all that comes within `reach` (a length) is listed, for motions that end with those of the list,
    /// `seconds` after their start; `arms`: the largest distance of a point of each body from its centre of rotation.
    pub fn holds_for(
        &self,
        motions: &[NonlinearRigidMotion; 2],
        seconds: Real,
        arms: [f64; 2],
        reach: f64,
    ) -> bool {
        let passed = self.seconds - f64::from(seconds);
        let same = (0..2).all(|k| motions[k].local_center == self.motions[k].local_center);
        if !(same && passed >= 0.0) {
            return false;
        }
        let drift = self.drift(motions, seconds.into(), arms);
        // Rounding in double precision is far below a millionth of what is drifted.
        drift * (1.0 + 1.0e-6) + (reach - self.reach) <= self.margin
    }

    /// How far points of the two bodies get from where they are on the motions of the list, one against the other.
    fn drift(&self, motions: &[NonlinearRigidMotion; 2], seconds: f64, arms: [f64; 2]) -> f64 {
        let share = (self.seconds - seconds) / self.seconds;
        let (mut slides, mut turns, mut size) = ([Vec3::zero(); 2], 0.0, 0.0);
        for (k, sign) in [(0, 1.0), (1, -1.0)] {
            let old = RigidMotion::<f64>::alone(&self.motions[k], self.seconds);
            let new = RigidMotion::<f64>::alone(&motions[k], seconds);
            let (starts, ends) = (
                [old.frame(share), new.frame(0.0)],
                [old.frame(1.0), new.frame(1.0)],
            );
            for (slide, [old, new]) in slides.iter_mut().zip([starts, ends]) {
                *slide = *slide + (new.center - old.center) * sign;
                size += new.center.taxicab() + old.center.taxicab();
            }
            let rate = |m: &RigidMotion<f64>, seconds: f64| m.angular_velocity() * (1.0 / seconds);
            let faster = rate(&new, seconds) - rate(&old, self.seconds);
            turns += arms[k] * (starts[1].angle_at_most(&starts[0]) + faster.length() * seconds);
        }
        let slides = slides.map(|s| s.length());
        slides[0].max(slides[1]) + turns + F64_ROUNDING * size
    }
}
