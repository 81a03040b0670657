//! Edge collapse by measured cost: how far the solid would really be off, not what quadrics guess.
//!
//! The cost of merging two balls is the largest distance, plus half the root mean square, over the
//! surface samples that belong to primitives at either; and, at the middle of each new primitive,
//! how far its ball sticks out of the surface. Costs are measured again when they are due, and put
//! back when they rose. The position is the quadrics' (`collapse.rs`), or the best of both balls
//! and their middle where that is bad. It is a hundred times the work of the quadric cost, so it
//! ends a collapse that the quadrics began.

use crate::error::BuildError;
use crate::math::least_first::least_first;
use crate::meshing::certify::inside::Solid;
use crate::meshing::certify::prepared_primitives::Prepared;
use crate::meshing::draft::{Ball, Corners, Signed};
use crate::meshing::geometry::bounds::Point;
use crate::meshing::geometry::chunks::{VERY_COSTLY, map_each};
use crate::meshing::geometry::triangle_tree::{GUESS, TriangleTree};
use crate::meshing::simplify::collapse::Simplifier;
use crate::meshing::simplify::merged_neighborhood::Merged;
use crate::meshing::watch::Watch;
use std::collections::BinaryHeap;

/// Weight of the root mean square of the distances, beside the largest one.
const RMS: f64 = 0.5;

/// Weight of the quadric's error (a length), which orders collapses that measure alike.
const QUADRIC: f64 = 1e-3;

/// Ratio to which a cost may have risen since it was queued and still be taken.
const STALE: f64 = 1.1;

/// Bulges below this (longest side 1) cost nothing: far below any error worth a primitive.
const BULGE: f64 = 2e-4;

/// Positions other than the quadrics' are tried below this many primitives; with more, edges are
/// short and it makes no difference.
const FEW: usize = 600;

/// An edge and its cost, and the versions of its balls when that was measured.
struct MeasuredCollapse {
    cost: f64,
    edge: [u32; 2],
    versions: [u32; 2],
}

least_first!(MeasuredCollapse, cost, edge);

/// Collapses edges until there are at most `target` primitives, or none may collapse.
pub fn reduce_measured(
    simplifier: &mut Simplifier,
    target: usize,
    samples: Vec<Point>,
    tree: &TriangleTree,
    watch: &mut Watch,
) -> Result<(), BuildError> {
    let start = simplifier.primitives();
    if start <= target {
        return Ok(());
    }
    let mut measure = Measure::new(simplifier, samples, tree, start < FEW);
    let complex = simplifier.complex();
    let alive = (0..complex.balls.len() as u32).filter(|&v| complex.is_alive(v));
    let above = |v: u32| complex.neighbors(v).iter().filter(move |&&u| u > v);
    let edges: Vec<[u32; 2]> = alive.flat_map(|v| above(v).map(move |&u| [v, u])).collect();
    let mut heap = BinaryHeap::from(measure.candidates(simplifier, &edges, 0.0, watch)?);
    let mut blocked = Vec::new();
    let mut progressed = false;
    // The error accepted so far: what is below it costs nothing new.
    let mut accepted = 0.0f64;
    while simplifier.primitives() > target {
        let Some(candidate) = heap.pop() else {
            if !progressed || blocked.is_empty() {
                break;
            }
            progressed = false;
            heap.extend(blocked.drain(..));
            continue;
        };
        watch.at((start - simplifier.primitives()) as f64 / (start - target) as f64)?;
        let MeasuredCollapse {
            cost,
            edge,
            versions,
        } = candidate;
        let [a, b] = edge;
        if edge.map(|v| simplifier.version(v)) != versions || !simplifier.complex().is_edge(a, b) {
            continue;
        }
        if !simplifier.may_collapse(a, b) {
            blocked.push(candidate);
            continue;
        }
        let (now, ball) = measure.best(simplifier, edge, accepted);
        if now > STALE * cost + 1e-6 {
            heap.push(MeasuredCollapse {
                cost: now,
                edge,
                versions,
            });
            continue;
        }
        accepted = accepted.max(0.7 * now);
        let old: Vec<u32> = measure.samples_around(simplifier, edge);
        simplifier.collapse(a, b, ball);
        measure.assign(simplifier, edge, old);
        progressed = true;
        let neighbors = simplifier.complex().neighbors(a).iter();
        let edges: Vec<[u32; 2]> = neighbors.map(|&v| [a.min(v), a.max(v)]).collect();
        heap.extend(measure.candidates(simplifier, &edges, accepted, watch)?);
    }
    Ok(())
}

/// Surface samples and the primitives that they belong to.
struct Measure<'a> {
    tree: &'a TriangleTree,
    samples: Vec<Point>,
    distance: Vec<f64>,
    primitive: Vec<Corners>,
    /// Samples by the ball of largest weight.
    of_ball: Vec<Vec<u32>>,
    few: bool,
}

impl<'a> Measure<'a> {
    fn new(
        simplifier: &Simplifier,
        samples: Vec<Point>,
        tree: &'a TriangleTree,
        few: bool,
    ) -> Self {
        let complex = simplifier.complex();
        let alive: Vec<u32> = (0..complex.balls.len() as u32)
            .filter(|&v| complex.is_alive(v))
            .collect();
        let draft = complex.draft();
        let solid = Solid::new(&draft);
        let mut measure = Self {
            tree,
            distance: Vec::with_capacity(samples.len()),
            primitive: Vec::with_capacity(samples.len()),
            of_ball: vec![Vec::new(); complex.balls.len()],
            samples,
            few,
        };
        let mut hint = 0;
        for (i, &p) in measure.samples.iter().enumerate() {
            let near = solid.nearest(p, hint);
            hint = near.primitive;
            let corners = solid.primitives()[hint as usize].map(|v| alive[v as usize]);
            measure.distance.push(near.signed.distance);
            measure.primitive.push(corners);
            let ball = heaviest(corners, near.signed.weights);
            measure.of_ball[ball as usize].push(i as u32);
        }
        measure
    }

    fn candidates(
        &self,
        s: &Simplifier,
        edges: &[[u32; 2]],
        accepted: f64,
        watch: &mut Watch,
    ) -> Result<Vec<MeasuredCollapse>, BuildError> {
        map_each(VERY_COSTLY, edges, watch, |&edge| {
            let (measured, _) = self.best(s, edge, accepted);
            let (quadric, _) = s.merge(edge[0], edge[1]);
            MeasuredCollapse {
                cost: measured + QUADRIC * quadric.sqrt(),
                edge,
                versions: edge.map(|v| s.version(v)),
            }
        })
    }

    /// The best ball for a merged edge and its measured cost.
    fn best(&self, s: &Simplifier, [a, b]: [u32; 2], accepted: f64) -> (f64, Ball) {
        let [ball_a, ball_b] = [a, b].map(|v| s.complex().balls[v as usize]);
        let (_, by_quadric) = s.merge(a, b);
        let middle = Ball::interpolate([ball_a, ball_b, ball_b], [0.5, 0.5, 0.0]);
        let after = Merged::new(s, [a, b]);
        let mut best = (f64::INFINITY, by_quadric);
        for (k, ball) in [by_quadric, ball_a, ball_b, middle].into_iter().enumerate() {
            if k > 0 && (best.0 < 1.2 * accepted || !self.few) {
                break;
            }
            let cost = self.cost(s, &after, &ball, accepted, best.0);
            if cost < best.0 {
                best = (cost, ball);
            }
        }
        best
    }

    /// Measured cost of a collapse. It ends early, with some value above `enough`, once the cost exceeds that.
    fn cost(&self, s: &Simplifier, after: &Merged, ball: &Ball, accepted: f64, enough: f64) -> f64 {
        let balls = &s.complex().balls;
        let [a, b] = after.edge;
        let of = |v: u32| if v == a { *ball } else { balls[v as usize] };
        let mut worst = 0.0f64;
        let (mut squares, mut count) = (0.0, 0usize);
        let prepared: Vec<Prepared> = after
            .primitives
            .iter()
            .map(|c| Prepared::new(*c, c.map(of)))
            .collect();
        let mut around: Option<Vec<Prepared>> = None;
        let mut last = 0;
        for &v in after.neighbors.iter().chain(&after.edge) {
            for &i in &self.of_ball[v as usize] {
                let i = i as usize;
                let corners = self.primitive[i];
                if !corners.contains(&a) && !corners.contains(&b) {
                    continue;
                }
                let p = self.samples[i];
                // The one nearest to the sample before rules most others out.
                let near = prepared[last].signed_distance(p);
                let way = prepared[last].direction_to(p, near.weights);
                let nearer = |d: f64, primitive: &Prepared| match primitive.is_beyond(p, way, d) {
                    true => d,
                    false => d.min(primitive.signed_distance(p).distance),
                };
                let mut d = near.distance;
                for (k, primitive) in prepared.iter().enumerate() {
                    let nearer = nearer(d, primitive);
                    if nearer < d {
                        (d, last) = (nearer, k);
                    }
                }
                if d > self.distance[i] && d > accepted {
                    let around = around.get_or_insert_with(|| after.around(s));
                    d = around.iter().fold(d, nearer);
                }
                worst = worst.max(d.abs());
                squares += d * d;
                count += 1;
            }
            if worst > enough {
                return worst;
            }
        }
        worst = self.sticks_out(after, of, worst, enough);
        if worst > enough {
            return worst;
        }
        worst + RMS * (squares / count.max(1) as f64).sqrt()
    }

    /// How far the primitives after a collapse, whose balls are `of`, stick out of the surface, or `worst`, if that is
    /// more. It ends early once that exceeds `enough`.
    fn sticks_out(
        &self,
        after: &Merged,
        of: impl Fn(u32) -> Ball + Copy,
        mut worst: f64,
        enough: f64,
    ) -> f64 {
        for &corners in &after.primitives {
            let weights = if corners[1] == corners[2] {
                [0.5, 0.5, 0.0]
            } else {
                [1.0 / 3.0; 3]
            };
            let middle = Ball::interpolate(corners.map(of), weights);
            let on_crease = |v: &&u32| of(**v).radius == 0.0;
            if corners.iter().any(|v| on_crease(&v)) {
                worst = worst.max(self.leaves(&middle));
                // Between two balls of radius 0 there may be no matter at all.
                for [u, v] in [[0, 1], [1, 2], [2, 0]].map(|k| k.map(|i: usize| corners[i])) {
                    if u != v && [u, v].iter().all(|v| on_crease(&v)) {
                        let [p, q] = [of(u), of(v)];
                        let chord = Ball::interpolate([p, q, q], [0.5, 0.5, 0.0]);
                        worst = worst.max(self.leaves(&chord));
                    }
                }
                if worst > enough {
                    return worst;
                }
                continue;
            }
            // Only what bulges by more than that counts; from near the medial axis the rest is dear.
            let within = middle.radius - worst.max(BULGE);
            if within <= 0.0 {
                continue;
            }
            if let Some(signed) = self.tree.signed_within(middle.center, within) {
                worst = worst.max(middle.radius + signed);
            }
            if worst > enough {
                return worst;
            }
        }
        worst
    }

    /// How far a ball next to a crease sticks out of the surface; 0 where that is nothing that matters.
    fn leaves(&self, ball: &Ball) -> f64 {
        let out = ball.radius
            + self
                .tree
                .signed_distance(ball.center, 1.2 * ball.radius.max(GUESS));
        if out > BULGE { out } else { 0.0 }
    }

    /// Samples that a collapse of the edge may give another primitive; they are no ball's then.
    fn samples_around(&mut self, s: &Simplifier, [a, b]: [u32; 2]) -> Vec<u32> {
        let mut around: Vec<u32> = [a, b].into();
        around.extend(s.complex().neighbors(a));
        around.extend(s.complex().neighbors(b));
        around.sort_unstable();
        around.dedup();
        let taken = |v: u32| std::mem::take(&mut self.of_ball[v as usize]);
        around.into_iter().flat_map(taken).collect()
    }

    /// Gives samples their primitives after edge `ab` was merged into `a`.
    fn assign(&mut self, s: &Simplifier, [a, b]: [u32; 2], samples: Vec<u32>) {
        let complex = s.complex();
        let prepare = |corners: Corners| {
            let balls = corners.map(|v| complex.balls[v as usize]);
            (Prepared::new(corners, balls), corners)
        };
        let own: Vec<_> = complex.primitives_at(a).map(prepare).collect();
        let around: Vec<_> = complex
            .neighbors(a)
            .iter()
            .flat_map(|&v| complex.primitives_at(v))
            .filter(|c| !c.contains(&a))
            .map(prepare)
            .collect();
        for i in samples {
            let at = i as usize;
            let p = self.samples[at];
            let to =
                |(prepared, corners): &(Prepared, Corners)| (prepared.signed_distance(p), *corners);
            let nearer = |x: &(Signed, Corners), y: &(Signed, Corners)| {
                x.0.distance.total_cmp(&y.0.distance)
            };
            let changed = |c: &Corners| c.contains(&a) || c.contains(&b);
            let lost = changed(&self.primitive[at]);
            let kept = (!lost).then(|| prepare(self.primitive[at]));
            let others = if lost { around.as_slice() } else { &[] };
            let candidates = own.iter().chain(others).chain(&kept).map(to);
            if let Some((signed, corners)) = candidates.min_by(nearer) {
                self.distance[at] = signed.distance;
                self.primitive[at] = corners;
                let ball = heaviest(corners, signed.weights);
                self.of_ball[ball as usize].push(i);
            }
        }
    }
}

fn heaviest(corners: Corners, weights: [f64; 3]) -> u32 {
    let heavier = |k: usize, j: usize| if weights[j] > weights[k] { j } else { k };
    corners[(1..3).fold(0, heavier)]
}
