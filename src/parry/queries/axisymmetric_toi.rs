//! First contact of a medial mesh with cylinders and cones, plain or rounded, in exact rigid motion. It is a best-first
//! search over the mesh's tree, by the time until which each node is proven not to meet. Nodes are spheres, so
//! [`follow`] advances them as it does primitives, only less exactly.
//!
//! # Guarantee
//! It is that of [`crate::elementary`], where `D(t)` is the signed distance of
//! [`crate::parry::partners::axisymmetric`], which sees bodies inside the cylinder or cone as overlapping, and never
//! falls below minus the largest radius. For a contact, `upper = lower`, and `D` there is at most the tolerance. All is
//! computed in double precision.

use super::conservative_advancement::{Advance, CHASE_TOLERANCE_PER_SLACK, ChaseLimits, follow};
use crate::elementary::first_contact::motion_is_finite;
use crate::elementary::{InitialContact, Toi, ToiOptions, ToiStatus};
use crate::math::lane::Vec3;
use crate::math::least_first::least_first;
use crate::math::motion::RigidMotion;
use crate::math::sphere::Ball;
use crate::math::{Real, Vector};
use crate::medial::tree::NodeKind;
use crate::medial::{MedialMesh, MedialSphere};
use crate::pair::PrimitiveTree;
use crate::pair::deepening::Threshold;
use crate::pair::first_contact::{Counts, ToiResult};
use crate::parry::partners::axisymmetric::{AxisFrame, Axisymmetric, NearBall, unit};
use parry3d::query::NonlinearRigidMotion;
use std::collections::BinaryHeap;

/// Iterations of one primitive, in units of the cap asked for (64 by default). Measured on 26,801
/// primitives in fast rotation: 3.5 on average, 37 at most; 4 leaves a margin of 7.
const CAP: u32 = 4;

/// Iterations of one query after which it ends, unresolved, and how many more for each primitive of the mesh: no
/// contact before what comes first then. Queries that turn less than 40 radians take a thousand. Larger, and a query of
/// endless turns takes longer; smaller, and it knows less of them.
const WORK: [u32; 2] = [1 << 11, 1 << 4];

/// Iterations of a primitive before it waits for its turn again. Not tuned; only speed depends on it.
const SLICE: u32 = 64;

/// Distance at which a node of the tree counts as met, in units of its radius. Not tuned; only speed
/// depends on it: smaller takes more steps, larger culls less.
const NODE_TOLERANCE: f64 = 0.1;

/// Cap of the iterations of a node; what it has proven by then counts. Not tuned, as above.
const NODE_STEPS: u32 = 16;

/// First contact of `mesh` with the nearest in time of `bodies`, which share one motion. Times in
/// the answer are fractions of the step; the second primitive index is that in `bodies`.
pub fn first_contact(
    mesh: &MedialMesh,
    motion1: &NonlinearRigidMotion,
    bodies: &[Axisymmetric],
    motion2: &NonlinearRigidMotion,
    seconds: Real,
    options: &ToiOptions,
) -> ToiResult {
    let finite = motion_is_finite(motion1) && motion_is_finite(motion2) && seconds.is_finite();
    if !finite || !options.tolerance.is_finite() || !options.target_distance.is_finite() {
        let toi = Toi::bad_input(options);
        return ToiResult::of(toi, Counts::default(), f64::INFINITY);
    }
    let motions = RigidMotion::<f64>::pair(motion1, motion2, seconds.into());
    let mut search = AxisymmetricSearch {
        mesh,
        motions,
        options,
        counts: Counts::default(),
        heap: BinaryHeap::new(),
        work: 0,
        most: WORK[1]
            .saturating_mul(mesh.primitive_count() as u32)
            .saturating_add(WORK[0]),
        tolerance: options.tolerance.max(0.0).into(),
        status: ToiStatus::Separated,
        lower: 1.0,
        upper: 1.0,
        found: None,
        deepest: f64::INFINITY,
    };
    search.run(bodies);
    // From the pair's frame to the world: it starts at the first body's origin and moves with the
    // second body's velocity.
    let elapsed = search.lower * f64::from(seconds);
    let origin = Vec3::<f64>::from_vector(motion1.start.translation)
        + Vec3::from_vector(motion2.linvel) * elapsed;
    let toi = search.answer(bodies, origin);
    ToiResult::of(toi, search.counts, search.deepest)
}

/// The state of one search for the first contact of a mesh with cylinders and cones.
struct AxisymmetricSearch<'a> {
    mesh: &'a MedialMesh,
    motions: [RigidMotion<f64>; 2],
    options: &'a ToiOptions,
    counts: Counts,
    heap: BinaryHeap<Entry>,
    /// Iterations so far, and at most.
    work: u32,
    most: u32,
    tolerance: f64,
    status: ToiStatus,
    lower: f64,
    upper: f64,
    found: Option<FoundContact>,
    /// Depth of the deepest contact at the start, as [`crate::pair::first_contact::Query::deepest`].
    deepest: f64,
}

/// The contact found: the nearest sphere, the body's placement then, and the primitives on both sides.
#[derive(Clone, Copy)]
struct FoundContact {
    near: NearBall,
    place: AxisFrame,
    primitives: [u32; 2],
}

/// An entry of the queue: a node of the tree, or a primitive on its way, with the time until which it is free of a
/// body.
struct Entry {
    time: f64,
    body: u32,
    node: u32,
    /// Iterations of the primitive so far.
    spent: u32,
}
least_first!(Entry, time, body, node, spent);

impl AxisymmetricSearch<'_> {
    /// Best-first over the tree and the bodies, by the time until which each node is proven free.
    fn run(&mut self, bodies: &[Axisymmetric]) {
        for (index, body) in bodies.iter().enumerate() {
            for root in 0..self.mesh.roots() {
                self.push(body, index as u32, root, 0.0);
            }
        }
        while let Some(entry) = self.heap.pop() {
            let Some(body) = bodies.get(entry.body as usize) else {
                return;
            };
            if entry.time > self.upper || self.status == ToiStatus::Overlapping {
                return;
            }
            match self.mesh.kind(entry.node) {
                _ if self.work >= self.most => return self.give_up(body, &entry),
                NodeKind::Nodes(i, j) => {
                    self.push(body, entry.body, i, entry.time);
                    self.push(body, entry.body, j, entry.time);
                }
                NodeKind::Primitive(i) => self.leaf(body, [i, entry.body], &entry),
            }
        }
    }

    /// Ends unresolved: nothing meets before the entry's time, and nothing is known from there on. The
    /// witness is of a primitive that may come first.
    fn give_up(&mut self, body: &Axisymmetric, entry: &Entry) {
        let mut below = self.mesh.kind(entry.node);
        let primitive = loop {
            match below {
                NodeKind::Primitive(primitive) => break primitive,
                NodeKind::Nodes(first, _) => below = self.mesh.kind(first),
            }
        };
        let (balls, len) = self.balls(primitive);
        let limits = ChaseLimits {
            start: entry.time,
            horizon: self.upper,
            target: self.options.target_distance.into(),
            tolerance: self.tolerance,
            steps: 1,
        };
        let Advance { near, place, .. } = self.advance(body, &balls[..len], &limits);
        self.found = Some(FoundContact {
            near,
            place,
            primitives: [primitive, entry.body],
        });
        self.lower = self.lower.min(entry.time);
        self.status = ToiStatus::Unresolved;
    }

    fn balls(&self, primitive: u32) -> ([Ball; 3], usize) {
        let (spheres, share) = PrimitiveTree::primitive(self.mesh, primitive);
        let balls = spheres.map(|s| Ball::new(Vec3::from_vector(s.center), s.radius.into()));
        (balls, share.spheres.clamp(1, 3))
    }

    fn push(&mut self, body: &Axisymmetric, index: u32, node: u32, time: f64) {
        self.counts.nodes += 1;
        let (center, radius) = self.mesh.bound(node);
        let limits = ChaseLimits {
            start: time,
            horizon: self.upper,
            // A primitive below raises a negative target, to 0 at most.
            target: self.options.target_distance.max(0.0).into(),
            tolerance: self.tolerance + NODE_TOLERANCE * f64::from(radius),
            steps: NODE_STEPS,
        };
        let ball = Ball::new(Vec3::from_vector(center), f64::from(radius));
        let advance = self.advance(body, &[ball], &limits);
        if !advance.separated {
            self.heap.push(Entry {
                time: advance.lower,
                body: index,
                node,
                spent: 0,
            });
        }
    }

    /// The balls of a primitive that count, those of its core where only cores meet, and the thickness that counts.
    fn counted(&self, primitive: u32) -> (([Ball; 3], usize), Real) {
        let (all, len) = self.balls(primitive);
        let thickness = self.mesh.thicknesses().primitives[primitive as usize];
        let Some(cores) = &self.options.cores else {
            return ((all, len), thickness);
        };
        let [loss, _] = cores.losses([thickness, Real::INFINITY]);
        let core = all.map(|s| Ball::new(s.center, s.radius - loss.of(s.radius)));
        ((core, len), thickness.min(cores.at_most))
    }

    fn leaf(&mut self, body: &Axisymmetric, primitives: [u32; 2], entry: &Entry) {
        let ((mut all, len), thinner) = self.counted(primitives[0]);
        let cap = CAP.saturating_mul(self.options.max_iterations);
        let radii = all[..len].iter().map(|b| b.radius);
        let thinnest = radii.fold(f64::INFINITY, f64::min);
        let mut limits = ChaseLimits {
            start: entry.time,
            horizon: self.upper,
            // No sphere is deeper in a cylinder or cone than by its radius: a target below that would never be met.
            target: f64::from(self.options.target_distance).max(-thinnest),
            tolerance: self.tolerance,
            steps: SLICE.min(cap - entry.spent),
        };
        let at_once = matches!(
            self.options.initial_contact,
            InitialContact::Approach { .. }
        );
        let mut touching = None;
        if let InitialContact::Deepen { by } | InitialContact::Approach { by } =
            self.options.initial_contact
        {
            let at_start = ChaseLimits {
                start: 0.0,
                steps: 1,
                ..limits
            };
            let starting = self.advance(body, &all[..len], &at_start);
            let start = starting.near.distance();
            let within = limits.target + limits.tolerance;
            if start <= within && by == Real::INFINITY {
                return;
            }
            if start <= within {
                touching = Some(starting);
                let deeper = start - within - f64::from(by);
                let depth = deeper / f64::from(thinner.max(Real::MIN_POSITIVE));
                self.deepest = self.deepest.min(depth);
                limits.start = if entry.spent == 0 { 0.0 } else { entry.time };
                let tolerance = limits.tolerance;
                let axis = all.map(|s| Ball::new(s.center, 0.0));
                let axes = || self.advance(body, &axis[..len], &at_start).near.distance();
                let threshold = Threshold::deepened(start, thinnest, by.into(), tolerance, axes);
                all.iter_mut().for_each(|b| b.radius *= threshold.scale);
                limits.target = threshold.target;
                limits.tolerance = threshold.tolerance;
            }
        }
        let mut advance = self.advance(body, &all[..len], &limits);
        let steps = u64::from(advance.steps);
        match len {
            3 => self.counts.looks += steps,
            _ => self.counts.tests += steps,
        }
        if advance.separated {
            return;
        }
        if let Some(Advance { near, place, .. }) = touching.filter(|_| at_once && advance.met) {
            advance = Advance {
                lower: 0.0,
                near,
                place,
                ..advance
            };
        }
        let spent = entry.spent + advance.steps;
        if !advance.met && advance.steps == SLICE && spent < cap {
            self.heap.push(Entry {
                time: advance.lower,
                spent,
                ..*entry
            });
            return;
        }
        self.keep(&advance, primitives, limits.target);
    }

    /// Keeps what came out of following two primitives, if nothing earlier was found.
    fn keep(&mut self, advance: &Advance, primitives: [u32; 2], target: f64) {
        self.tolerance = self
            .tolerance
            .max(CHASE_TOLERANCE_PER_SLACK * advance.slack);
        let sooner = self.found.is_none() || advance.lower < self.lower;
        self.lower = self.lower.min(advance.lower);
        let overlap =
            advance.met && advance.lower <= 0.0 && advance.near.distance() < target - advance.slack;
        if sooner || overlap {
            self.found = Some(FoundContact {
                near: advance.near,
                place: advance.place,
                primitives,
            });
            self.status = match (advance.met, overlap) {
                (true, true) => ToiStatus::Overlapping,
                (true, false) => ToiStatus::Contact,
                (false, _) => ToiStatus::Unresolved,
            };
        }
        if advance.met {
            self.upper = self.upper.min(advance.lower);
        }
    }

    fn advance(&mut self, body: &Axisymmetric, balls: &[Ball], limits: &ChaseLimits) -> Advance {
        let advance = follow(&self.motions, body, balls, limits);
        self.work += advance.steps;
        advance
    }

    fn answer(&self, bodies: &[Axisymmetric], origin: Vec3<f64>) -> Toi {
        let separated = Toi::separated(self.options);
        let tolerance = self.tolerance as Real;
        let Some(found) = self.found else {
            return Toi {
                tolerance,
                ..separated
            };
        };
        let exact = self.lower;
        let mut lower = exact as Real;
        if f64::from(lower) > exact {
            lower = lower.next_down();
        }
        let unresolved = self.status == ToiStatus::Unresolved;
        let body = bodies.get(found.primitives[1] as usize);
        let border = body.map_or(0.0, |b| b.border);
        let NearBall { ball, apart, .. } = found.near;
        let (out, apart) = match body {
            // A centre inside has no nearest point but the way out.
            Some(b) if apart <= 0.0 => {
                let (out, way) = b.min_translation(&found.place, ball.center);
                (out, -way)
            }
            _ => (unit(found.near.direction), apart),
        };
        let world = |p: Vec3<f64>| (p + found.place.origin + origin).to_vector();
        let foot = ball.center - out * apart;
        let points = [
            ball.center - out * (ball.radius - f64::from(border)),
            foot + out * f64::from(border),
        ];
        let normal: Vector = (-out).to_vector();
        Toi {
            status: self.status,
            lower,
            upper: if unresolved {
                self.upper as Real
            } else {
                lower
            },
            tolerance,
            normal,
            spheres: [
                MedialSphere::new(world(ball.center), ball.radius as Real - border),
                MedialSphere::new(world(foot), border),
            ],
            points: points.map(world),
            primitives: found.primitives,
            ..separated
        }
    }
}

/// First contact with two bodies together, by the first contact with each.
pub(super) fn earlier(a: Toi, b: Toi) -> Toi {
    let overlap = |t: &Toi| t.status == ToiStatus::Overlapping;
    let (first, second) = if overlap(&b) || (!overlap(&a) && b.lower < a.lower) {
        (b, a)
    } else {
        (a, b)
    };
    Toi {
        upper: first.upper.min(second.upper),
        tolerance: first.tolerance.max(second.tolerance),
        iterations: first.iterations.saturating_add(second.iterations),
        ..first
    }
}
