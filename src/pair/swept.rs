//! One body over a piece of the step, as the search for a first contact ([`super::search`]) sees it: the chords
//! along which the centres of its nodes and primitives move, and radii enlarged by the sagitta, which is how far a
//! centre may be off its chord. Twin of `SearchSide::chord` on a device: `sweep` in `shaders/swept.wgsl`.

use super::apart::{Balls, SweptBall};
use super::outline::ActivePrimitives;
use super::primitive_tree::PrimitiveTree;
use crate::math::approach::first_touch;
use crate::math::lane::Vec3;
use crate::math::motion::{Frame, RigidMotion};
use crate::math::tolerance::{F64_ROUNDING, SIMILAR_RADII};
use crate::medial::MedialSphere;
use crate::medial::tree::NodeKind;
use std::ops::Range;
use std::sync::Arc;

/// A set of listed primitive pairs, one bit each, in turn where there are more.
pub(super) type Bits = u128;

/// Listed primitive pairs below each node of both bodies, by its number.
pub(super) type ListedBits = [Vec<Bits>; 2];

/// Chord of a node's centre over a piece, and the radius around it that covers the node, rounding
/// included.
#[derive(Clone, Copy)]
pub(super) struct Swept {
    pub(super) start: Vec3<f64>,
    pub(super) chord: Vec3<f64>,
    pub(super) radius: f64,
    pub(super) below: NodeKind,
    /// Part of the list of near primitives that is below the node; all bits where there is no list, none where nothing
    /// of it may meet the other side.
    pub(super) near: Bits,
    /// The body's node.
    pub(super) node: u32,
    /// Place of the first of its swept children; [`NOT_YET`] before they are wanted.
    next: u32,
    /// Place of the balls of its hull; [`NOT_YET`] before they are wanted.
    hull: u32,
    /// Place of the balls of its convex piece; [`NOT_YET`] before they are wanted.
    piece: u32,
}

/// Place of what is not swept yet.
const NOT_YET: u32 = u32::MAX;

/// Adds bits to those of one of a body's nodes.
pub(super) fn add_bits(bits: &mut Vec<Bits>, node: u32, more: Bits) {
    let place = node as usize;
    if more != 0 && bits.len() <= place {
        bits.resize(place + 1, 0);
    }
    if more != 0 {
        bits[place] |= more;
    }
}

/// Time at which two swept nodes come within a distance.
pub(super) enum NodeContact {
    /// Contact at the start, so deep as a share of the distance, from 0 to -1.
    AtStart(f64),
    /// Contact at this share of the piece.
    At(f64),
    /// The two do not touch in this piece of the step.
    Never,
}

impl Swept {
    /// Time at which the balls of two nodes are first within `reach` of each other.
    pub(super) fn touch(&self, other: &Self, reach: f64) -> NodeContact {
        let y = other.start - self.start;
        let rate = other.chord - self.chord;
        let radius = self.radius + other.radius + reach;
        let radius = (radius + F64_ROUNDING * radius.abs()).max(0.0);
        let distance = y.length();
        if distance <= radius {
            return NodeContact::AtStart((distance - radius) / radius.max(f64::MIN_POSITIVE));
        }
        // The margins of the radii cover its rounding.
        let (entry, exists) = first_touch(y, rate, radius);
        match !exists || y.dot(rate) >= 0.0 || entry > 1.0 {
            true => NodeContact::Never,
            false => NodeContact::At(entry),
        }
    }
}

/// Rotation in the step, in radians, up to which the margins of 64 ulps of the coordinates, of which an arm is one,
/// cover the rounding of the time as well: it is given half of them. Only rotation beyond it widens a node's ball.
/// Larger, and a ball may be a few ulps too small.
const COVERED_TURN: f64 = 32.0;

/// One side of a search. A node is swept once, however many nodes of the other side it meets.
pub(super) struct SearchSide<'a, V> {
    pub(super) body: &'a V,
    motion: RigidMotion<f64>,
    times: [f64; 2],
    /// Frames at the start and the end of the piece.
    frames: [Frame<f64>; 2],
    nodes: Vec<Swept>,
    balls: Vec<Balls>,
    /// Balls of convex pieces, and the bound of the coordinates in play.
    pieces: Vec<(Vec<SweptBall>, f64)>,
    /// Primitives that may meet the other side; `None`: all.
    left: Option<ActivePrimitives>,
    /// List of what may come near it, and which of the bodies this is.
    near: Option<(Arc<ListedBits>, usize)>,
}

impl<'a, V: PrimitiveTree> SearchSide<'a, V> {
    pub(super) fn new(
        body: &'a V,
        motion: RigidMotion<f64>,
        left: Option<ActivePrimitives>,
    ) -> Self {
        Self {
            body,
            motion,
            times: [0.0; 2],
            frames: [motion.frame(0.0); 2],
            nodes: Vec::with_capacity(48),
            balls: Vec::with_capacity(16),
            pieces: Vec::new(),
            left,
            near: None,
        }
    }

    /// Keeps the search to nodes above listed primitives of this side.
    pub(super) fn keep_near(&mut self, near: Arc<ListedBits>, side: usize) {
        self.near = Some((near, side));
    }

    /// Bits of swept nodes, those of what is below them added, by the body's nodes. What is below a convex piece that
    /// was not split has its bits.
    pub(super) fn gathered(&self, mut bits: Vec<Bits>) -> Vec<Bits> {
        bits.resize(self.nodes.len(), 0);
        let mut gathered = Vec::new();
        // Nodes below a node are swept after it.
        for (at, swept) in self.nodes.iter().enumerate().rev() {
            if swept.next != NOT_YET {
                let next = swept.next as usize;
                bits[at] |= bits[next] | bits[next + 1];
            }
            add_bits(&mut gathered, swept.node, bits[at]);
            if swept.next == NOT_YET && bits[at] != 0 {
                self.add_below(&mut gathered, swept.below, bits[at]);
            }
        }
        gathered
    }

    fn add_below(&self, gathered: &mut Vec<Bits>, below: NodeKind, bits: Bits) {
        if let NodeKind::Nodes(first, second) = below {
            for child in [first, second] {
                add_bits(gathered, child, bits);
                self.add_below(gathered, self.body.kind(child), bits);
            }
        }
    }

    /// Turns to the piece between two times, with its roots swept: the first of [`Self::node`].
    pub(super) fn begin(&mut self, start: f64, end: f64) {
        self.times = [start, end];
        self.frames = self.times.map(|t| self.motion.frame(t));
        self.nodes.clear();
        self.balls.clear();
        self.pieces.clear();
        for root in 0..self.body.roots() {
            self.nodes.push(self.sweep(root));
        }
    }

    pub(super) fn node(&self, at: u32) -> &Swept {
        &self.nodes[at as usize]
    }

    /// Places of the two children of a swept node; itself if it is a leaf, or not to be split.
    pub(super) fn parts(&mut self, at: u32, split: bool) -> Range<u32> {
        let Swept { below, next, .. } = *self.node(at);
        let NodeKind::Nodes(first, second) = below else {
            return at..at + 1;
        };
        if !split {
            return at..at + 1;
        }
        if next != NOT_YET {
            return next..next + 2;
        }
        let new = self.nodes.len() as u32;
        for child in [first, second] {
            self.nodes.push(self.sweep(child));
        }
        self.nodes[at as usize].next = new;
        new..new + 2
    }

    /// Sweeps the spheres of a node's hull, for [`Self::hull`].
    pub(super) fn sweep_hull(&mut self, at: u32) {
        let Swept { node, hull, .. } = &mut self.nodes[at as usize];
        if *hull != NOT_YET {
            return;
        }
        *hull = self.balls.len() as u32;
        let (spheres, len) = self.body.hull(*node);
        let balls = spheres[..len].iter().map(|s| self.ball(s));
        let balls = Balls::new(balls, self.motion.terms());
        self.balls.push(balls);
    }

    /// Sweeps the spheres of the convex piece that a node holds, or of its primitive, for [`Self::piece`].
    pub(super) fn sweep_piece(&mut self, at: u32) {
        let Swept { node, piece, .. } = *self.node(at);
        let Some(of) = self.body.convex_piece(node).filter(|_| piece == NOT_YET) else {
            return self.sweep_hull(at);
        };
        let balls: Vec<SweptBall> = of.spheres.iter().map(|s| self.ball(s)).collect();
        let size = |ball: &SweptBall| ball.0.taxicab() + ball.1.taxicab() + ball.2;
        let size = balls.iter().map(size).sum::<f64>() + self.motion.terms();
        self.nodes[at as usize].piece = self.pieces.len() as u32;
        self.pieces.push((balls, size));
    }

    /// The spheres of a node's convex piece or primitive, which are swept, and the bound of the coordinates in play.
    pub(super) fn piece(&self, at: u32) -> (&[SweptBall], f64) {
        match self.node(at).piece {
            NOT_YET => (self.hull(at).all(), self.hull(at).size),
            piece => {
                let (balls, size) = &self.pieces[piece as usize];
                (balls, *size)
            }
        }
    }

    fn ball(&self, s: &MedialSphere) -> SweptBall {
        let (from, chord, sagitta) = self.chord(Vec3::from_vector(s.center));
        (from, chord, f64::from(s.radius) + sagitta)
    }

    /// The spheres of a node's hull, which are swept.
    pub(super) fn hull(&self, at: u32) -> &Balls {
        &self.balls[self.node(at).hull as usize]
    }

    /// Position of a point at the start of the piece, the chord of its path, and the sagitta with what
    /// rounding of the time adds.
    fn chord(&self, local: Vec3<f64>) -> (Vec3<f64>, Vec3<f64>, f64) {
        let [from, to] = &self.frames;
        let arms = [from.arm(local), to.arm(local)];
        let length = self.times[1] - self.times[0];
        let acceleration = self.motion.acceleration(arms[0]);
        // Times are good to an ulp of the step, in which a point swings an ulp of the angle; up to
        // `COVERED_TURN` the margins for coordinates cover that.
        let swing = (self.motion.angle() - COVERED_TURN).max(0.0) * arms[0].length();
        let rounding = F64_ROUNDING * swing;
        (
            from.center + arms[0],
            (to.center - from.center) + (arms[1] - arms[0]),
            acceleration * (length * length) / 8.0 + rounding,
        )
    }

    fn sweep(&self, node: u32) -> Swept {
        let (center, radius) = self.body.bound(node);
        let (start, chord, sagitta) = self.chord(Vec3::from_vector(center));
        let radius = f64::from(radius) + sagitta;
        // Rounding of positions, chords and the time at which they meet: a few ulps of the numbers in
        // play, which are larger than the positions where a body is far from its own origin.
        let size = start.taxicab() + chord.taxicab() + radius + self.motion.terms();
        Swept {
            start,
            chord,
            radius: radius + F64_ROUNDING * size,
            below: self.body.kind(node),
            near: self.near(node),
            node,
            next: NOT_YET,
            hull: NOT_YET,
            piece: NOT_YET,
        }
    }

    fn near(&self, node: u32) -> Bits {
        if self.left.as_ref().is_some_and(|left| !left.meets(node)) {
            return 0;
        }
        let near = self.near.as_ref();
        near.map_or(Bits::MAX, |(near, side)| {
            near[*side].get(node as usize).copied().unwrap_or(0)
        })
    }
}

/// Children that replace two swept nodes, at least one of which is not a leaf.
pub(super) fn split<A: PrimitiveTree, B: PrimitiveTree>(
    sides: &mut (SearchSide<A>, SearchSide<B>),
    [i, j]: [u32; 2],
) -> [Range<u32>; 2] {
    let (a, b) = (sides.0.node(i), sides.1.node(j));
    // Both at once where they are about as large: the pairs in between would be looked at only to
    // be split. Below that, the larger one.
    let (small, large) = (
        a.radius * SIMILAR_RADII < b.radius,
        b.radius * SIMILAR_RADII < a.radius,
    );
    let inner = [a.below, b.below].map(|below| matches!(below, NodeKind::Nodes(..)));
    // A convex node is not split against one that is not convex until that is convex too: then the two are looked at
    // whole.
    let convex = [
        sides.0.body.is_convex(a.node),
        sides.1.body.is_convex(b.node),
    ];
    let [waits_a, waits_b] = [convex[0] && !convex[1], convex[1] && !convex[0]];
    [
        sides
            .0
            .parts(i, !(waits_a || small && inner[1] && !waits_b)),
        sides
            .1
            .parts(j, !(waits_b || large && inner[0] && !waits_a)),
    ]
}
