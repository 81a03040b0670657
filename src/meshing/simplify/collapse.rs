//! Edge collapse by spherical quadric error. Source: Li et al., "Q-MAT: Computing medial axis
//! transform by quadratic error minimization" (2015), §4 and §5.
//!
//! Changes versus the paper:
//! - The stability ratio has a floor (`STABILITY_FLOOR` in `merge_cost.rs`): at 0 a collapse is free, however wrong.
//! - Topology: the strict link condition stalls far above small targets. An edge that breaks it may
//!   still collapse when every loop or shell that closes by it has its middle inside the solid: the
//!   solid has no hole there. When nothing else is left the count wins over the topology.
//! - Lone balls, which no collapse can remove, are dropped by the same order of cost.

use crate::error::BuildError;
use crate::meshing::axis::clip::CreasedMesh;
use crate::meshing::draft::{Ball, Draft};
use crate::meshing::geometry::quadric::Quadric;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::simplify::ball_quadrics::{creased_quadrics, quadrics};
use crate::meshing::simplify::complex::Complex;
use crate::meshing::simplify::queue::{Queue, QueuedCollapse};
use crate::meshing::simplify::voids::open_voids;
use crate::meshing::watch::{Watch, bytes_of};

/// A merged ball may stick out of the solid by this share of its radius; at low counts good ones do.
const BULGE: f64 = 0.2;

/// Ratio of a collapse's measured cost to the one it has in the queue, above which it goes back into the queue with the
/// measured cost. Larger, and collapses leave the order of their costs.
const STALE: f64 = 1.05;

/// Cost below which a difference is rounding (longest side 1): costs of about 0 would otherwise always count as stale.
const NO_COST: f64 = 1e-10;

/// A medial mesh on its way to fewer primitives.
#[derive(Clone)]
pub struct Simplifier<'a> {
    pub(crate) complex: Complex,
    pub(crate) quadrics: Vec<Quadric>,
    versions: Vec<u32>,
    queue: Queue,
    /// Distance of each ball's centre, inside the solid, to the nearest triangle at least; 0 where nothing is known.
    clear: Vec<f64>,
    /// Edges that the topology rule held back.
    blocked: Vec<QueuedCollapse>,
    /// Whether anything was collapsed since the blocked edges were last tried.
    progressed: bool,
    keep_topology: bool,
    /// Whether balls of radius 0 stay on creases.
    pub(crate) creased: bool,
    /// Whether sheets may bend, so that costs are measured, too.
    measures: bool,
    /// Whether costs are measured from the first collapse on, where much sticks out.
    pub(crate) measures_early: bool,
    pub(crate) tree: &'a TriangleTree,
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
        let quadrics = quadrics(&complex, boundary_weight, watch)?;
        Self::with_quadrics(complex, quadrics, tree, watch)
    }

    /// A simplifier for a medial mesh with creases, which knows the planes that its balls touch; `flat` says that all
    /// faces are flat.
    pub fn creased(
        mesh: CreasedMesh,
        flat: bool,
        tree: &'a TriangleTree,
        watch: &mut Watch,
    ) -> Result<Self, BuildError> {
        let complex = Complex::new(mesh.draft);
        let quadrics = creased_quadrics(&complex, &mesh.planes, flat, watch)?;
        let mut simplifier = Self::with_quadrics(complex, quadrics, tree, watch)?;
        simplifier.measures = !flat;
        Ok(simplifier)
    }

    fn with_quadrics(
        complex: Complex,
        quadrics: Vec<Quadric>,
        tree: &'a TriangleTree,
        watch: &mut Watch,
    ) -> Result<Self, BuildError> {
        let n = complex.balls.len();
        let mut simplifier = Self {
            quadrics,
            versions: vec![0; n],
            queue: Queue::default(),
            clear: vec![0.0; n],
            creased: complex.balls.iter().any(|b| b.radius == 0.0),
            measures: false,
            measures_early: false,
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

    /// Takes note that the balls lie inside the solid and still touch samples of its surface, `spacing` apart. Seen
    /// from a ball of radius r, a flat surface bulges in by r − √(r² − spacing²) between two of them.
    pub fn touching(mut self, spacing: f64) -> Self {
        for (clear, ball) in self.clear.iter_mut().zip(&self.complex.balls) {
            let clear_sq = ball.radius * ball.radius - spacing * spacing;
            *clear = clear_sq.max(0.0).sqrt();
        }
        self
    }

    /// Sets whether costs are measured from the first collapse on where much sticks out: many primitives can keep what
    /// few lose anyway.
    pub fn set_measures_early(&mut self, early: bool) {
        self.measures_early = early;
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
            let current =
                |c: &QueuedCollapse| [c.a, c.b].map(|v| versions[v as usize]) == c.versions;
            match queue.pop(current) {
                Some(candidate) => self.take(candidate),
                None if self.retry() => {}
                None => break,
            }
        }
        Ok(())
    }

    fn take(&mut self, candidate: QueuedCollapse) {
        let QueuedCollapse { a, b, .. } = candidate;
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
        if self.measures {
            let cost = self.measured_cost(a, b, &ball);
            if cost > STALE * candidate.cost + NO_COST {
                self.queue.push(QueuedCollapse { cost, ..candidate });
                return;
            }
        }
        // On round bodies all planes agree on many balls, of which some reach far out of the solid.
        if !self.is_on_crease(a, b) && !self.is_clear(a, b, &ball) {
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
    pub(crate) fn collapse(&mut self, a: u32, b: u32, ball: Ball) {
        self.quadrics[a as usize] = self.quadrics[a as usize].plus(&self.quadrics[b as usize]);
        self.complex.collapse(a, b, ball);
        self.versions[a as usize] += 1;
        self.versions[b as usize] += 1;
    }

    /// The medial mesh as a complex.
    pub(crate) fn complex(&self) -> &Complex {
        &self.complex
    }

    /// How often a ball has changed.
    pub(crate) fn version(&self, v: u32) -> u32 {
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
    pub(crate) fn may_collapse(&self, a: u32, b: u32) -> bool {
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
            self.push(v, v, planes * diameter * diameter + self.flat_cost());
        }
    }

    fn push(&mut self, a: u32, b: u32, cost: f64) {
        let versions = [a, b].map(|v| self.versions[v as usize]);
        self.queue.push(QueuedCollapse {
            cost,
            a,
            b,
            versions,
        });
    }
}
