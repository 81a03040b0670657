//! The search for the first contact of two bodies. Everything that may meet (two nodes, two primitives, one elementary
//! test) waits in a queue at the time until which it is proven not to meet, and is looked at further only when it comes
//! first.
//!
//! - A node is a ball, which keeps its radius when it turns. Its centre stays within the sagitta `A/8` of the chord of
//!   its path ([`crate::math::motion`]). So two nodes cannot meet before the two balls, enlarged by both sagittas and
//!   moved along the chords, touch: the smaller root of a quadratic.
//! - Two nodes cannot meet while a direction keeps their hulls apart: swept rectangles, which fit better than balls
//!   ([`crate::medial::rectangle`]).
//! - Two convex pieces of several primitives are looked at as a whole before their primitives are
//!   ([`super::convex_pieces`]).
//! - Two primitives cannot meet while a direction keeps them apart ([`super::apart`]), nor can the spheres of one of
//!   their elementary tests. "Meet" here means to come within the tolerance, so that what touches at the start is
//!   found there.
//! - An elementary test has the lower bound of its bracket ([`crate::elementary::bracket`]).
//!
//! So the first test that is in contact when its turn comes is the first contact. A fast turn is searched in pieces,
//! so that sagittas stay small. The time of the first entry in the queue is a lower bound of the contact at any moment:
//! a search that has used up [`WORK`] ends with that bound, as unresolved.
//!
//! On a device `walk` in `shaders/cull.wgsl` splits nodes in the same way, but looks at all that meet.

use super::outline::ActivePrimitives;
use super::patch::Patch;
use super::piece_contact::{PieceLook, PiecePair, PiecesMet};
use super::primitive_tree::PrimitiveTree;
use super::queue::{Entry, OpenTest, Tested, WorkItem};
use super::swept::{NodeContact, SearchSide, split};
use crate::elementary::bracket::Limits;
use crate::elementary::first_contact::{Earliest, options_limits};
use crate::elementary::{Cores, InitialContact, ToiOptions, ToiStatus};
use crate::math::fast_hash::FastMap;
use crate::math::motion::RigidMotion;
use crate::math::tolerance::PIECE_ANGLE;
use crate::medial::tree::NodeKind;
use std::collections::BinaryHeap;

/// Node pairs, proofs by directions, iterations of elementary tests (twice), looks at convex pieces ([`LOOK`] times)
/// and pieces of one search, together, after which it ends unresolved. Interleaved combs of 1,236 primitives take a
/// seventh of it, fast flights of such meshes a thirty-sixth. A query of endless turns ends after two tenths of a
/// second. Larger, and it takes longer; smaller, and it knows less.
const WORK: u64 = 1 << 19;

/// Work of one look at two convex pieces, in elementary tests.
pub(super) const LOOK: u64 = 16;

/// Pieces whose pairs of roots do not count as work. As above.
const ROOT_PIECES: u64 = 64;

/// The state of one search for a first contact: both bodies, the queue, and what is under way. Its methods are in
/// `waiting.rs`, `leaves.rs`, `convex_pieces.rs` and `ending.rs` too.
pub(super) struct FirstContactSearch<'a, A, B> {
    pub(super) sides: (SearchSide<'a, A>, SearchSide<'a, B>),
    pub(super) motions: [RigidMotion<f64>; 2],
    /// Start and end of the piece searched.
    pub(super) times: [f64; 2],
    pub(super) target: f64,
    /// Distance that culling goes by: no primitive pair has a larger target, raised or not.
    pub(super) reach: f64,
    pub(super) initial_contact: InitialContact,
    /// Cores that may not meet; `None`: the whole bodies.
    pub(super) cores: Option<Cores>,
    pub(super) heap: BinaryHeap<Entry>,
    /// One candidate that is not in the heap.
    pub(super) first: Option<Entry>,
    /// Elementary tests that are not settled.
    pub(super) open: Vec<OpenTest>,
    /// Parts that the open tests are of.
    pub(super) tested: Vec<Tested>,
    /// Pieces begun, and how many there are.
    pub(super) pieces: u64,
    all_pieces: f64,
    /// Times that directions were tried on two primitives.
    pub(super) proofs: u64,
    /// Looks at two convex pieces as a whole.
    pub(super) looks: u64,
    /// Limit of [`Self::worked`].
    pub(super) budget: u64,
    /// Work after which the search pauses, as far as it can.
    pub(super) pause: u64,
    /// Node pairs looked at.
    pub(super) nodes: u32,
    pub(super) earliest: Earliest<f64>,
    /// Parts of the primitives found that were tested.
    pub(super) found: Option<Tested>,
    /// Pairs of the bodies' nodes, primitives or convex pieces, that touch at the start and may sink in, and how deep
    /// they may get, in the units of [`super::first_contact::Query::deepest`].
    pub(super) touching: Vec<([u32; 2], f64)>,
    /// Convex pieces looked at, by the bodies' nodes; `None` where their primitives decide.
    pub(super) convex: FastMap<[u32; 2], Option<PiecePair>>,
    /// The convex pieces that met, if the contact found is between pieces.
    pub(super) met: Option<PiecesMet>,
    /// Patch in which the pieces found, and all others that meet with them, lie on each other; set when it is asked
    /// for.
    pub(super) joined: Option<Patch>,
}

/// How far a search came.
enum Reached {
    /// Nothing meets before this time; the search has not looked further.
    Free(f64),
    /// The end of the piece, without an answer.
    End,
    /// The answer.
    Answer,
}

impl<'a, A: PrimitiveTree, B: PrimitiveTree> FirstContactSearch<'a, A, B> {
    pub(super) fn new(
        bodies: (&'a A, &'a B),
        motions: [RigidMotion<f64>; 2],
        options: &ToiOptions,
        left: Option<[ActivePrimitives; 2]>,
    ) -> Self {
        let (left1, left2) = left.map_or((None, None), |[a, b]| (Some(a), Some(b)));
        let target = f64::from(options.target_distance);
        Self {
            sides: (
                SearchSide::new(bodies.0, motions[0], left1),
                SearchSide::new(bodies.1, motions[1], left2),
            ),
            motions,
            times: [0.0, 1.0],
            target,
            reach: match options.initial_contact {
                InitialContact::Stop => target.max(0.0),
                InitialContact::Deepen { .. } | InitialContact::Approach { .. } => target,
            },
            initial_contact: options.initial_contact,
            cores: options.cores,
            heap: BinaryHeap::with_capacity(64),
            first: None,
            open: Vec::with_capacity(16),
            tested: Vec::with_capacity(16),
            pieces: 0,
            all_pieces: 1.0,
            proofs: 0,
            looks: 0,
            budget: WORK,
            pause: WORK,
            nodes: 0,
            earliest: Earliest::new(options_limits(options)),
            found: None,
            touching: Vec::new(),
            convex: FastMap::default(),
            met: None,
            joined: None,
        }
    }

    /// Searches on until it has the answer (`None`), or nothing meets before a time after `until`, which
    /// it returns; then it can go on. Each call looks at one candidate at least.
    pub(super) fn run(&mut self, until: f64) -> Option<f64> {
        if self.pieces == 0 && !self.begin() {
            return None;
        }
        loop {
            match self.piece(until) {
                Reached::Free(time) => return Some(time),
                Reached::End if self.times[1] < 1.0 => self.next_piece(),
                Reached::End | Reached::Answer => break,
            }
        }
        self.settle();
        None
    }

    /// Begins with the first piece; false where there is nothing to search.
    fn begin(&mut self) -> bool {
        let fastest = self.motions[0].angle().max(self.motions[1].angle());
        self.all_pieces = (fastest / PIECE_ANGLE).ceil().max(1.0);
        let roots = [self.sides.0.body.roots(), self.sides.1.body.roots()].map(u64::from);
        // Bodies of many roots pay for them in each piece.
        self.budget = WORK + ROOT_PIECES * roots[0] * roots[1];
        let any = !roots.contains(&0);
        if any {
            self.next_piece();
        }
        any
    }

    fn next_piece(&mut self) {
        let start = self.pieces as f64 / self.all_pieces;
        self.pieces += 1;
        let end = self.pieces as f64 / self.all_pieces;
        self.earliest.limits = Limits {
            start,
            horizon: end,
            ..self.earliest.limits
        };
        self.times = [start, end];
        self.sides.0.begin(start, end);
        self.sides.1.begin(start, end);
        self.heap.clear();
        self.first = None;
        self.open.clear();
        self.tested.clear();
        for i in 0..self.sides.0.body.roots() {
            for j in 0..self.sides.1.body.roots() {
                self.push([i, j], self.times[0]);
            }
        }
    }

    /// Searches the piece begun.
    fn piece(&mut self, until: f64) -> Reached {
        let [start, end] = self.times;
        if self.worked() >= self.budget {
            self.give_up(start, None);
            return Reached::Answer;
        }
        let mut looked = false;
        while let Some(entry) = self.next() {
            if entry.time > self.earliest.upper.min(end) {
                break;
            }
            // Before any pause: a search that goes on has work left, and ends where it would have without.
            if self.worked() >= self.budget {
                self.give_up(entry.time, Some(entry.candidate));
                return Reached::Answer;
            }
            let pauses = entry.time > until || self.worked() >= self.pause;
            if looked && pauses && self.earliest.found.is_none() {
                let time = entry.time;
                self.first = Some(entry);
                return Reached::Free(time);
            }
            looked = true;
            let open = match entry.candidate {
                WorkItem::Nodes(nodes) => self.expand(nodes, entry.time),
                WorkItem::SubPrimitives(place) => self.list_later(place, entry.time),
                WorkItem::Test(index) => self.advance(index, entry.time),
            };
            if !open {
                return Reached::Answer;
            }
        }
        if self.earliest.status == ToiStatus::Separated {
            Reached::End
        } else {
            Reached::Answer
        }
    }

    pub(super) fn worked(&self) -> u64 {
        // Each takes about 0.3 µs, an iteration twice that.
        let iterations = 2 * u64::from(self.earliest.iterations);
        u64::from(self.nodes) + iterations + self.pieces + self.proofs + LOOK * self.looks
    }

    /// The first candidate. Of two nodes just split one is often the first again: it waits in
    /// `self.first`, which spares it the way through the heap.
    fn next(&mut self) -> Option<Entry> {
        let Some(entry) = self.first.take() else {
            return self.heap.pop();
        };
        match self.heap.peek_mut() {
            Some(mut top) if *top > entry => Some(std::mem::replace(&mut *top, entry)),
            _ => Some(entry),
        }
    }

    pub(super) fn queue(&mut self, entry: Entry) {
        match &mut self.first {
            None => self.first = Some(entry),
            Some(first) if *first < entry => {
                let later = std::mem::replace(first, entry);
                self.heap.push(later);
            }
            Some(_) => self.heap.push(entry),
        }
    }

    /// Queues two swept nodes, free until `from`, at the time at which their balls meet, if they do in this
    /// piece. Balls of parts may stick out of those of the whole, and would meet before.
    fn push(&mut self, nodes: [u32; 2], from: f64) {
        let (a, b) = (self.sides.0.node(nodes[0]), self.sides.1.node(nodes[1]));
        if a.near & b.near == 0 {
            return;
        }
        self.nodes += 1;
        // Within the tolerance they touch.
        let reach = self.reach + self.earliest.limits.tolerance;
        let (mut time, mut depth) = (self.times[0], 0.0);
        match a.touch(b, reach) {
            NodeContact::AtStart(deep) => depth = deep,
            NodeContact::At(share) => time += share * (self.times[1] - self.times[0]),
            NodeContact::Never => return,
        }
        time = time.max(from);
        if time <= self.earliest.upper.min(self.times[1]) {
            let of = [a.node, b.node];
            self.queue(Entry::of_nodes(time, depth, nodes, of));
        }
    }

    /// Two nodes wait until directions no longer keep their hulls apart; then they are replaced by what is below the
    /// larger, and of primitives by their elementary tests. Returns whether an earlier contact is still possible.
    fn expand(&mut self, [i, j]: [u32; 2], time: f64) -> bool {
        let (a, b) = (*self.sides.0.node(i), *self.sides.1.node(j));
        self.proofs += 1;
        let primitives = match (a.below, b.below) {
            (NodeKind::Primitive(p), NodeKind::Primitive(q)) => Some([p, q]),
            _ => None,
        };
        self.sweep_hulls([i, j]);
        let free = match primitives {
            Some(pair) if self.cores.is_some_and(|cores| cores.share > 0.0) => {
                self.free_until(self.swept([i, j], pair).each_ref(), time)
            }
            _ => self.free_until(self.hulls([i, j]), time),
        };
        let Some(free) = free else {
            return true;
        };
        if !self.gains_too_little(free, time) {
            return self.wait([i, j], free);
        }
        if primitives.is_some() {
            return self.list_tests([i, j], free);
        }
        match self.look_at_pieces([i, j], free) {
            PieceLook::Free => return true,
            PieceLook::FreeUntil(free) => return self.wait([i, j], free),
            PieceLook::Met(met) => return self.take_pieces(*met, free),
            PieceLook::Split => {}
        }
        let [parts_of_a, parts_of_b] = split(&mut self.sides, [i, j]);
        for a in parts_of_a.clone() {
            for b in parts_of_b.clone() {
                self.push([a, b], free);
            }
        }
        true
    }
}
