//! Edge collapse by spherical quadric error. Source: Li et al., "Q-MAT: Computing medial axis
//! transform by quadratic error minimization" (2015), §4 and §5.
//!
//! Changes versus the paper:
//! - The stability ratio has a floor ([`STABILITY_FLOOR`]): at 0 a collapse is free, however wrong.
//! - Topology: the strict link condition stalls far above small targets. An edge that breaks it may
//!   still collapse when every loop or shell that closes by it has its middle inside the solid: the
//!   solid has no hole there. When nothing else is left the count wins over the topology.
//! - Lone balls, which no collapse can remove, are dropped by the same order of cost.

use super::bounds::{Point, direction};
use super::complex::Complex;
use super::draft::{Ball, Draft};
use super::quadric::{Quadric, cone_normals, slab_normals};
use super::queue::{Candidate, Queue};
use super::triangle_tree::TriangleTree;
use super::voids::open_voids;
use super::watch::{Watch, bytes_of};
use crate::error::BuildError;

/// Added to the error before the stability ratio scales it (Q-MAT's `k`, in units of the longest
/// side): orders the collapses that cost nothing by their stability.
const FLAT_COST: f64 = 1e-5;

/// Floor under the stability ratio. Measured: 0 to 0.2 loses fins and ears (error .015 for .006 at
/// 2000 primitives); 0.2 to 0.5 is alike.
const STABILITY_FLOOR: f64 = 0.3;

/// A minimiser may lie this many edge lengths from the edge's middle: farther, the quadric is
/// nearly singular there and says nothing.
const REACH: f64 = 3.0;

/// A merged ball may stick out of the solid by this share of its radius; at low counts good ones do.
const BULGE: f64 = 0.2;

/// Cosine of the angle between two faces at an edge below which one lies on the other.
const FOLDED: f64 = 0.99;

/// Weight of the planes that hold the medial mesh's boundary, for a solid and for thin sheets,
/// whose boundary is the surface's own.
pub const BOUNDARY_WEIGHT_SOLID: f64 = 0.1;
/// See [`BOUNDARY_WEIGHT_SOLID`].
pub const BOUNDARY_WEIGHT_SHEET: f64 = 1.0;

/// A medial mesh on its way to fewer primitives.
pub struct Simplifier<'a> {
    complex: Complex,
    quadrics: Vec<Quadric>,
    versions: Vec<u32>,
    queue: Queue,
    /// Each ball's centre lies inside the solid, and no triangle is nearer to it than this; 0 where
    /// nothing is known.
    clear: Vec<f64>,
    /// Edges that the topology rule held back.
    blocked: Vec<Candidate>,
    /// Whether anything was collapsed since the blocked edges were last tried.
    progressed: bool,
    keep_topology: bool,
    tree: &'a TriangleTree,
}

impl<'a> Simplifier<'a> {
    /// Computes the quadrics of all balls and the costs of all edges.
    pub fn new(
        draft: Draft,
        boundary_weight: f64,
        tree: &'a TriangleTree,
        watch: &mut Watch,
    ) -> Result<Self, BuildError> {
        let complex = Complex::new(draft);
        let n = complex.balls.len();
        let mut simplifier = Self {
            quadrics: quadrics(&complex, boundary_weight, watch)?,
            versions: vec![0; n],
            queue: Queue::default(),
            clear: vec![0.0; n],
            complex,
            blocked: Vec::new(),
            progressed: false,
            keep_topology: true,
            tree,
        };
        for v in 0..n as u32 {
            if v % 512 == 0 {
                watch.at(0.0)?;
            }
            simplifier.push_around(v, |u| u > v);
        }
        watch.hold(simplifier.bytes());
        Ok(simplifier)
    }

    /// Says that the balls lie inside the solid and touch samples of its surface, `spacing` apart, as
    /// yet: seen from a ball of radius r, a flat surface bulges in by r − √(r² − spacing²) between them.
    pub fn touching(mut self, spacing: f64) -> Self {
        for (clear, ball) in self.clear.iter_mut().zip(&self.complex.balls) {
            let clear_sq = ball.radius * ball.radius - spacing * spacing;
            *clear = clear_sq.max(0.0).sqrt();
        }
        self
    }

    /// Bytes of its arrays.
    fn bytes(&self) -> usize {
        let of_each = bytes_of(&self.quadrics) + bytes_of(&self.versions) + bytes_of(&self.clear);
        self.complex.bytes() + of_each + self.queue.bytes()
    }

    /// Number of primitives now.
    pub fn primitives(&self) -> usize {
        self.complex.primitives()
    }

    /// Whether holes had to be closed, or parts joined, to reach a count.
    pub fn broke_topology(&self) -> bool {
        !self.keep_topology
    }

    /// The medial mesh as it is now, without voids where the solid has none: collapses leave them
    /// where many balls are close.
    pub fn draft(&self) -> Draft {
        let mut draft = self.complex.draft();
        open_voids(&mut draft, |middle| self.tree.winding(middle) > 0.5);
        draft
    }

    /// Collapses the cheapest edges until there are at most `target` (at least 1) primitives.
    pub fn reduce_to(&mut self, target: usize, watch: &mut Watch) -> Result<(), BuildError> {
        let start = self.primitives();
        let mut steps = 0usize;
        while self.primitives() > target.max(1) {
            if steps.is_multiple_of(512) {
                let done = (start - self.primitives()) as f64;
                watch.at(done / (start - target).max(1) as f64)?;
            }
            steps += 1;
            let (versions, queue) = (&self.versions, &mut self.queue);
            let current = |c: &Candidate| [c.a, c.b].map(|v| versions[v as usize]) == c.versions;
            match queue.pop(current) {
                Some(candidate) => self.take(candidate),
                None if self.retry() => {}
                None => break,
            }
        }
        Ok(())
    }

    fn take(&mut self, candidate: Candidate) {
        let Candidate { a, b, .. } = candidate;
        if !self.complex.is_alive(a) || !self.complex.is_alive(b) {
            return;
        }
        if a == b {
            self.complex.remove_lone(a);
            return;
        }
        if self.keep_topology && !self.may_collapse(a, b) {
            self.blocked.push(candidate);
            return;
        }
        let (_, mut ball) = self.merge(a, b);
        // On round bodies all planes agree on many balls, of which some reach far out of the solid.
        if !self.is_clear(a, b, &ball) {
            (_, ball) = self.cheapest(a, b);
        }
        self.collapse(a, b, ball);
        self.progressed = true;
        self.push_around(a, |_| true);
    }

    /// Whether the ball that `a` and `b` are merged into sticks out of the solid by no more than
    /// [`BULGE`]. What the tree says about its centre is kept as that of `a`.
    ///
    /// A ball that touches the surface all around is dear to ask for its nearest triangle, and cheap to
    /// ask for one well within.
    fn is_clear(&mut self, a: u32, b: u32, ball: &Ball) -> bool {
        let left = |v: u32| {
            let way = ball.center - self.complex.balls[v as usize].center;
            self.clear[v as usize] - way.length()
        };
        let known = left(a).max(left(b));
        let distance = ball.radius * (1.0 - BULGE);
        let clear = known >= distance || !self.tree.any_within(ball.center, distance);
        // A ball that left what was clear may have come out.
        let inside = clear && known > 0.0;
        self.clear[a as usize] = if inside { known.max(distance) } else { 0.0 };
        clear
    }

    /// Merges ball `b` into `a`, which becomes `ball`.
    pub(super) fn collapse(&mut self, a: u32, b: u32, ball: Ball) {
        self.quadrics[a as usize] = self.quadrics[a as usize].plus(&self.quadrics[b as usize]);
        self.complex.collapse(a, b, ball);
        self.versions[a as usize] += 1;
        self.versions[b as usize] += 1;
    }

    /// The medial mesh as a complex.
    pub(super) fn complex(&self) -> &Complex {
        &self.complex
    }

    /// How often a ball has changed.
    pub(super) fn version(&self, v: u32) -> u32 {
        self.versions[v as usize]
    }

    /// Puts blocked edges back once something around them may have changed, or the count demands
    /// it. False when there is nothing left to do.
    fn retry(&mut self) -> bool {
        if self.blocked.is_empty() {
            return false;
        }
        if !self.progressed {
            self.keep_topology = false;
        }
        self.progressed = false;
        for candidate in self.blocked.drain(..) {
            self.queue.push(candidate);
        }
        true
    }

    /// Whether the solid has no hole where collapsing an edge would close one.
    pub(super) fn may_collapse(&self, a: u32, b: u32) -> bool {
        let mut closed = self.complex.closed_by(a, b);
        closed.all(|middle| {
            let inside = |v: u32| {
                let way = middle - self.complex.balls[v as usize].center;
                way.length() < self.clear[v as usize]
            };
            inside(a) || inside(b) || self.tree.winding(middle) > 0.5
        })
    }

    fn push_around(&mut self, v: u32, wanted: impl Fn(u32) -> bool) {
        for i in 0..self.complex.neighbors(v).len() {
            let u = self.complex.neighbors(v)[i];
            if wanted(u) {
                let (a, b) = (v.min(u), v.max(u));
                let (cost, _) = self.merge(a, b);
                self.push(a, b, cost);
            }
        }
        if self.complex.is_lone(v) {
            // Each plane that it touched is then off by up to its diameter.
            let diameter = 2.0 * self.complex.balls[v as usize].radius;
            let planes = self.quadrics[v as usize].weight().max(1.0);
            self.push(v, v, planes * diameter * diameter + FLAT_COST);
        }
    }

    fn push(&mut self, a: u32, b: u32, cost: f64) {
        let versions = [a, b].map(|v| self.versions[v as usize]);
        self.queue.push(Candidate {
            cost,
            a,
            b,
            versions,
        });
    }

    /// Cost of merging two balls, and the ball that they become.
    pub(super) fn merge(&self, a: u32, b: u32) -> (f64, Ball) {
        let [ball_a, ball_b] = [a, b].map(|v| self.complex.balls[v as usize]);
        let quadric = self.quadrics[a as usize].plus(&self.quadrics[b as usize]);
        let middle = middle(&ball_a, &ball_b);
        let length = (ball_b.center - ball_a.center).length();
        let near = |m: &Ball| (m.center - middle.center).length() <= REACH * length;
        let minimiser = quadric.minimiser(&middle);
        let Some(minimiser) = minimiser.filter(|m| m.radius > 0.0 && near(m)) else {
            return cheapest_of(&quadric, [ball_a, ball_b, middle]);
        };
        let cost = cost(quadric.error(&minimiser), &ball_a, &ball_b);
        (cost, minimiser)
    }

    /// The cheapest of two balls and their middle to merge the two into.
    fn cheapest(&self, a: u32, b: u32) -> (f64, Ball) {
        let [ball_a, ball_b] = [a, b].map(|v| self.complex.balls[v as usize]);
        let quadric = self.quadrics[a as usize].plus(&self.quadrics[b as usize]);
        cheapest_of(&quadric, [ball_a, ball_b, middle(&ball_a, &ball_b)])
    }
}

/// The cheapest of two balls and their middle to merge the two into, and its cost.
fn cheapest_of(quadric: &Quadric, balls: [Ball; 3]) -> (f64, Ball) {
    let [a, b, _] = balls;
    let tried = balls.into_iter().map(|ball| (quadric.error(&ball), ball));
    let best = tried.min_by(|x, y| x.0.total_cmp(&y.0));
    let (error, ball) = best.unwrap_or((0.0, a));
    (cost(error, &a, &b), ball)
}

/// Cost of merging two balls into one that is off by `error`.
fn cost(error: f64, a: &Ball, b: &Ball) -> f64 {
    let stability = stability(a, b).max(STABILITY_FLOOR);
    (error + FLAT_COST) * stability * stability
}

/// The ball halfway between two.
fn middle(a: &Ball, b: &Ball) -> Ball {
    Ball {
        center: (a.center + b.center) * 0.5,
        radius: 0.5 * (a.radius + b.radius),
    }
}

/// Stability ratio ρ = max(0, d − |r1 − r2|)/d: 0 where one ball contains the other.
fn stability(a: &Ball, b: &Ball) -> f64 {
    let d = (b.center - a.center).length();
    if d > 0.0 {
        ((d - (b.radius - a.radius).abs()) / d).max(0.0)
    } else {
        0.0
    }
}

/// Planes that each ball should go on touching: those of its slabs, and where the medial mesh ends,
/// planes that hold its boundary.
fn quadrics(
    complex: &Complex,
    boundary_weight: f64,
    watch: &mut Watch,
) -> Result<Vec<Quadric>, BuildError> {
    let balls = &complex.balls;
    let mut quadrics = vec![Quadric::default(); balls.len()];
    for face in complex.faces() {
        let corners = face.map(|v| balls[v as usize]);
        for n in slab_normals(corners).into_iter().flatten() {
            for (&v, ball) in face.iter().zip(&corners) {
                quadrics[v as usize].add_plane(n, ball, 1.0);
            }
        }
    }
    for a in 0..balls.len() as u32 {
        if a % 512 == 0 {
            watch.at(0.0)?;
        }
        for &b in complex.neighbors(a).iter().filter(|&&b| b > a) {
            let mut opposite = complex.opposite(a, b);
            match (opposite.next(), opposite.next()) {
                (None, _) => add_dangling(complex, [a, b], boundary_weight, &mut quadrics),
                (Some(c), None) => add_boundary(balls, [a, b, c], boundary_weight, &mut quadrics),
                // The two sides of something flat meet at its outline. Slabs of a solid's medial
                // mesh fold by chance only.
                (Some(c), Some(d))
                    if boundary_weight >= BOUNDARY_WEIGHT_SHEET && folds(balls, [a, b], [c, d]) =>
                {
                    add_boundary(balls, [a, b, c], boundary_weight, &mut quadrics);
                }
                _ => {}
            }
        }
    }
    Ok(quadrics)
}

/// Whether the faces `abc` and `abd` lie on each other, within a few degrees.
fn folds(balls: &[Ball], ab: [u32; 2], cd: [u32; 2]) -> bool {
    let at = |v: u32| balls[v as usize].center;
    let [a, b] = ab.map(at);
    let along = direction(b - a);
    let inward = |v: u32| {
        let from_a = at(v) - a;
        direction(from_a - along * from_a.dot(along))
    };
    inward(cd[0]).dot(inward(cd[1])) > FOLDED
}

/// Boundary edge `ab` of the face `abc`: a plane across the face, facing away from `c`.
fn add_boundary(balls: &[Ball], abc: [u32; 3], weight: f64, quadrics: &mut [Quadric]) {
    let [a, b, c] = abc.map(|v| balls[v as usize]);
    let along = direction(b.center - a.center);
    let from_c = a.center - c.center;
    let outward = direction(from_c - along * from_c.dot(along));
    if outward.length_sq() > 0.0 {
        let weight = weight * stability(&a, &b).powi(2);
        quadrics[abc[0] as usize].add_plane(outward, &a, weight);
        quadrics[abc[1] as usize].add_plane(outward, &b, weight);
    }
}

/// Edge `ab` without a face: four planes of its cone, and one across the axis at an end that is
/// joined to nothing else.
fn add_dangling(complex: &Complex, ab: [u32; 2], weight: f64, quadrics: &mut [Quadric]) {
    let [a, b] = ab.map(|v| complex.balls[v as usize]);
    let Some(normals) = cone_normals(&a, &b) else {
        return;
    };
    for n in normals {
        quadrics[ab[0] as usize].add_plane(n, &a, 1.0);
        quadrics[ab[1] as usize].add_plane(n, &b, 1.0);
    }
    let axis: Point = direction(b.center - a.center);
    let weight = weight * stability(&a, &b).powi(2);
    for (v, ball, outward) in [(ab[0], a, -axis), (ab[1], b, axis)] {
        if complex.neighbors(v).len() == 1 {
            quadrics[v as usize].add_plane(outward, &ball, weight);
        }
    }
}
