//! One body over a piece of the step: nodes and primitives with the chords of their centres, and
//! radii that cover the sagitta.

use super::apart::Balls;
use super::volumes::Volumes;
use crate::math::lane::Vec3;
use crate::math::motion::RigidMotion;
use crate::medial::tree::Below;

/// Chord of a node's centre over a piece, and the radius around it that covers the node.
#[derive(Clone, Copy)]
pub(super) struct Swept {
    pub(super) start: Vec3<f64>,
    pub(super) chord: Vec3<f64>,
    pub(super) radius: f64,
    pub(super) below: Below,
    /// Where the first of its swept children is, or the balls of its primitive; [`NOT_YET`] before
    /// they are wanted.
    next: u32,
}

const NOT_YET: u32 = u32::MAX;

/// One side of a search. A node is swept once, however many nodes of the other side it meets.
pub(super) struct Side<'a, V> {
    pub(super) body: &'a V,
    motion: RigidMotion<f64>,
    times: [f64; 2],
    turned: [(f64, f64); 2],
    nodes: Vec<Swept>,
    balls: Vec<Balls>,
}

impl<'a, V: Volumes> Side<'a, V> {
    pub(super) fn new(body: &'a V, motion: RigidMotion<f64>) -> Self {
        Self {
            body,
            motion,
            times: [0.0; 2],
            turned: [(0.0, 1.0); 2],
            nodes: Vec::new(),
            balls: Vec::new(),
        }
    }

    /// Turns to the piece between two times, with its roots swept: the first of [`Self::node`].
    pub(super) fn begin(&mut self, start: f64, end: f64) {
        self.times = [start, end];
        self.turned = self.times.map(|t| self.motion.sin_cos(t));
        self.nodes.clear();
        self.balls.clear();
        for root in 0..self.body.roots() {
            self.nodes.push(self.sweep(root));
        }
    }

    pub(super) fn node(&self, at: u32) -> &Swept {
        &self.nodes[at as usize]
    }

    /// Where the two children of a swept node are; `None` if it is a leaf.
    pub(super) fn split(&mut self, at: u32) -> Option<[u32; 2]> {
        let Swept { below, next, .. } = *self.node(at);
        let Below::Nodes(first, second) = below else {
            return None;
        };
        if next != NOT_YET {
            return Some([next, next + 1]);
        }
        let new = self.nodes.len() as u32;
        for child in [first, second] {
            self.nodes.push(self.sweep(child));
        }
        self.nodes[at as usize].next = new;
        Some([new, new + 1])
    }

    /// Sweeps the spheres of a leaf's primitive; where they are for [`Self::balls`].
    pub(super) fn sweep_leaf(&mut self, at: u32, primitive: u32) -> u32 {
        let place = &mut self.nodes[at as usize].next;
        if *place != NOT_YET {
            return *place;
        }
        let new = self.balls.len() as u32;
        *place = new;
        let (spheres, share) = self.body.primitive(primitive);
        let balls = spheres[..share.spheres].iter().map(|s| {
            let (from, chord, sagitta) = self.chord(Vec3::from_vector(s.center));
            (from, chord, f64::from(s.radius) + sagitta)
        });
        let balls = Balls::new(balls);
        self.balls.push(balls);
        new
    }

    pub(super) fn balls(&self, place: u32) -> &Balls {
        &self.balls[place as usize]
    }

    /// Position of a point at the start of the piece, the chord of its path, and the sagitta.
    fn chord(&self, local: Vec3<f64>) -> (Vec3<f64>, Vec3<f64>, f64) {
        let path = self.motion.point(local);
        let [from, to] = [0, 1].map(|k| path.at(self.times[k], self.turned[k]).position);
        let length = self.times[1] - self.times[0];
        (from, to - from, path.acceleration * (length * length) / 8.0)
    }

    fn sweep(&self, node: u32) -> Swept {
        let (center, radius) = self.body.bound(node);
        let (start, chord, sagitta) = self.chord(Vec3::from_vector(center));
        Swept {
            start,
            chord,
            radius: f64::from(radius) + sagitta,
            below: self.body.below(node),
            next: NOT_YET,
        }
    }
}
