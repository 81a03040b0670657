//! Straight casts that start within their target distance, as a character controller asks for them: what
//! comes nearer at the start is hit there, what parts is let go, and whatever else comes first is hit at the
//! target distance. Counted beside rapier's compound of the same parts; judged by [`Truth`].
//!
//! The full run, 2,000 casts of each shape:
//! `CASTS=2000 cargo test --release --all-features --test casts within -- --nocapture`.

use crate::rng::Rng;
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use parry3d::math::{Pose, Real, Rotation, Vector};
use parry3d::query::details::ShapeCastOptions;
use parry3d::query::{DefaultQueryDispatcher, QueryDispatcher, ShapeCastHit};
use parry3d::shape::{Shape, SharedShape};
use rapier3d_medial::{MedialDispatcher, MedialMesh, MedialSphere};

const TARGET: f64 = 0.016;
const SECONDS: f64 = 2.0;
/// Contact distance of the casts, which may be early by it, and what rounding of `f32` poses adds.
const EARLY: f64 = 1.0e-4;
const ROUNDING: f64 = 2.0e-6;
/// Nearer than this to the border between two answers, either is right.
const UNSURE: f64 = 2.0e-4;

/// Signed distance of a point to a convex body, in its frame.
type Distance = fn(Vector3<f64>) -> f64;

fn to_cuboid(p: Vector3<f64>) -> f64 {
    let q = p.abs() - Vector3::new(0.09, 0.06, 0.12);
    q.sup(&Vector3::zeros()).norm() + q.max().min(0.0)
}

fn to_cylinder(p: Vector3<f64>) -> f64 {
    let (x, y) = (p.x.hypot(p.z) - 0.08, p.y.abs() - 0.1);
    x.max(0.0).hypot(y.max(0.0)) + x.max(y).min(0.0)
}

/// To the triangle from the axis to the rim and the tip, turned about the axis.
fn to_cone(p: Vector3<f64>) -> f64 {
    let (h, r) = (0.12, 0.1);
    let (x, y) = (p.x.hypot(p.z), p.y);
    let segment = |(ax, ay): (f64, f64), (bx, by): (f64, f64)| {
        let (dx, dy) = (bx - ax, by - ay);
        let s = (((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
        (x - ax - s * dx).hypot(y - ay - s * dy)
    };
    let near = segment((0.0, -h), (r, -h)).min(segment((r, -h), (0.0, h)));
    let inside = y > -h && 2.0 * h * x + r * y < h * r;
    if inside { -near } else { near }
}

fn to_triangle(p: Vector3<f64>, [a, b, c]: [Vector3<f64>; 3]) -> f64 {
    let n = (b - a).cross(&(c - a));
    let edge = |a: Vector3<f64>, b: Vector3<f64>| {
        let d = b - a;
        let s = ((p - a).dot(&d) / d.norm_squared()).clamp(0.0, 1.0);
        (p - a - d * s).norm()
    };
    let left = |a: Vector3<f64>, b: Vector3<f64>| (b - a).cross(&(p - a)).dot(&n) >= 0.0;
    if left(a, b) && left(b, c) && left(c, a) {
        (p - a).dot(&n).abs() / n.norm()
    } else {
        edge(a, b).min(edge(b, c)).min(edge(c, a))
    }
}

const TIPS: f64 = 0.13;

/// An octahedron, by its symmetry.
fn to_hull(p: Vector3<f64>) -> f64 {
    let p = p.abs();
    let corners = [Vector3::x(), Vector3::y(), Vector3::z()].map(|e| e * TIPS);
    let above = p.sum() - TIPS;
    if above > 0.0 {
        to_triangle(p, corners)
    } else {
        above / 3f64.sqrt()
    }
}

const SLAB: [[f64; 3]; 3] = [[0.1, 0.0, -0.05], [-0.08, 0.03, 0.0], [0.0, -0.02, 0.11]];

fn to_slab(p: Vector3<f64>) -> f64 {
    to_triangle(p, SLAB.map(Vector3::from)) - 0.03
}

/// Name, the shape that ours and rapier's casts are given, and its distance.
fn shapes() -> Vec<(&'static str, [SharedShape; 2], Distance)> {
    let both = |s: SharedShape| [s.clone(), s];
    let tips = [Vector::X, Vector::Y, Vector::Z].into_iter();
    let tips: Vec<Vector> = tips
        .flat_map(|e| [e, -e].map(|e| e * TIPS as Real))
        .collect();
    let corners = SLAB.map(|c| Vector::from(c.map(|x| x as Real)));
    let slab = corners.map(|c| MedialSphere::new(c, 0.03)).to_vec();
    let slab = MedialMesh::new(slab, vec![], vec![[0, 1, 2]]).expect("a slab");
    let [a, b, c] = corners;
    let capsule = |p: Vector3<f64>| {
        let across = Vector3::new(p.x, p.y - p.y.clamp(-0.08, 0.08), p.z);
        across.norm() - 0.06
    };
    vec![
        ("ball", both(SharedShape::ball(0.1)), |p| p.norm() - 0.1),
        ("capsule", both(SharedShape::capsule_y(0.08, 0.06)), capsule),
        (
            "cuboid",
            both(SharedShape::cuboid(0.09, 0.06, 0.12)),
            to_cuboid,
        ),
        (
            "cylinder",
            both(SharedShape::cylinder(0.1, 0.08)),
            to_cylinder,
        ),
        ("cone", both(SharedShape::cone(0.12, 0.1)), to_cone),
        (
            "hull",
            both(SharedShape::convex_hull(&tips).expect("a hull")),
            to_hull,
        ),
        (
            "medial slab",
            [
                SharedShape::new(slab),
                SharedShape::round_triangle(a, b, c, 0.03),
            ],
            to_slab,
        ),
    ]
}

const PARTS: usize = 27;
const MAJOR: f64 = 0.5;
const MINOR: f64 = 0.1;

/// Centre of a ring's sphere, as `f32` has it.
fn center(i: usize) -> Vector {
    let (sin, cos) = ((i % PARTS) as f64 / PARTS as f64 * std::f64::consts::TAU).sin_cos();
    Vector::new((MAJOR * cos) as Real, 0.0, (MAJOR * sin) as Real)
}

fn ring() -> MedialMesh {
    let spheres = (0..PARTS).map(|i| MedialSphere::new(center(i), MINOR as Real));
    let edges = (0..PARTS as u32).map(|i| [i, (i + 1) % PARTS as u32]);
    MedialMesh::new(spheres.collect(), edges.collect(), vec![]).expect("a ring")
}

fn compound() -> SharedShape {
    let part = |i| SharedShape::capsule(center(i), center(i + 1), MINOR as Real);
    SharedShape::compound((0..PARTS).map(|i| (Pose::IDENTITY, part(i))).collect())
}

/// Least value of a convex function in an interval, and where.
pub fn least([mut a, mut b]: [f64; 2], f: impl Fn(f64) -> f64) -> (f64, f64) {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let mut x = [b - GOLDEN * (b - a), a + GOLDEN * (b - a)];
    let mut y = x.map(&f);
    for _ in 0..44 {
        if y[0] < y[1] {
            b = x[1];
            (x[1], y[1]) = (x[0], y[0]);
            x[0] = b - GOLDEN * (b - a);
            y[0] = f(x[0]);
        } else {
            a = x[0];
            (x[0], y[0]) = (x[1], y[1]);
            x[1] = a + GOLDEN * (b - a);
            y[1] = f(x[1]);
        }
    }
    let ends = [(f(a), a), (f(b), b)];
    if ends[0].0 <= ends[1].0 {
        ends[0]
    } else {
        ends[1]
    }
}

/// A cast in `f64`: the shape moves, the ring stands. The distance of a capsule to a convex body in
/// straight motion is convex along its axis and in time, so that both least values are found by section.
struct Truth {
    distance: Distance,
    pose: Isometry3<f64>,
    velocity: Vector3<f64>,
}

/// What the truth says of a cast.
#[derive(Debug, PartialEq)]
enum Answer {
    /// Something within the target comes nearer: contact at the start.
    AtOnce,
    /// Contact then; the moment at which one may be told, and that by which it must be.
    Between(f64, f64),
    None,
    /// Too near to two of these.
    Unsure,
}

impl Truth {
    /// Distance of a part at a time.
    fn part(&self, i: usize, t: f64) -> f64 {
        let wide = |v: Vector| Vector3::new(v.x as f64, v.y as f64, v.z as f64);
        let (a, b) = (wide(center(i)), wide(center(i + 1)));
        let at = |s: f64| {
            let p = Point3::from(a + (b - a) * s - self.velocity * t);
            (self.distance)(self.pose.inverse_transform_point(&p).coords)
        };
        least([0.0, 1.0], at).0 - MINOR
    }

    /// Whether a part is farther off than the target by a bound on balls.
    fn is_far(&self, i: usize, t: [f64; 2]) -> bool {
        let c = (center(i) + center(i + 1)) * 0.5;
        let to = Vector3::new(c.x as f64, c.y as f64, c.z as f64) - self.pose.translation.vector;
        let at = (to.dot(&self.velocity) / self.velocity.norm_squared()).clamp(t[0], t[1]);
        (to - self.velocity * at).norm() > 0.2 + 0.06 + MINOR + 0.05
    }

    fn gap(&self) -> f64 {
        let parts = (0..PARTS).filter(|&i| !self.is_far(i, [0.0, 0.0]));
        parts.map(|i| self.part(i, 0.0)).fold(1.0, f64::min)
    }

    fn answer(&self) -> Answer {
        let (mut may, mut must) = (f64::INFINITY, f64::INFINITY);
        let mut unsure = false;
        for i in (0..PARTS).filter(|&i| !self.is_far(i, [0.0, SECONDS])) {
            let start = self.part(i, 0.0);
            let step = 1.0e-3;
            let closing = (start - self.part(i, step)) / step;
            if (start - TARGET).abs() < UNSURE {
                unsure = true;
            } else if start < TARGET {
                unsure |= closing.abs() < 0.01;
                if closing > 0.0 {
                    return if unsure {
                        Answer::Unsure
                    } else {
                        Answer::AtOnce
                    };
                }
            } else {
                let (lowest, when) = least([0.0, SECONDS], |t| self.part(i, t));
                unsure |= (lowest - TARGET).abs() < UNSURE;
                if lowest > TARGET {
                    continue;
                }
                let reaches = |level: f64| {
                    let (mut a, mut b) = (0.0, when);
                    for _ in 0..40 {
                        let t = 0.5 * (a + b);
                        if self.part(i, t) > level {
                            a = t
                        } else {
                            b = t
                        }
                    }
                    b
                };
                may = may.min(reaches(TARGET + EARLY + ROUNDING));
                must = must.min(reaches(TARGET - ROUNDING));
            }
        }
        match (unsure, may.is_finite()) {
            (true, _) => Answer::Unsure,
            (false, true) => Answer::Between(may, must),
            (false, false) => Answer::None,
        }
    }
}

/// Wrong answers, by kind.
#[derive(Debug, Default, PartialEq, Eq)]
struct Wrong {
    missed: usize,
    late: usize,
    early: usize,
    false_hits: usize,
}

impl Wrong {
    fn count(&mut self, truth: &Answer, hit: Option<&ShapeCastHit>) {
        let time = hit.map(|h| f64::from(h.time_of_impact));
        // An ulp of the time, of which there are no more than `SECONDS`.
        let ulp = 4.0e-7;
        match (truth, time) {
            (Answer::Unsure, _) | (Answer::None, None) => {}
            (Answer::None, Some(_)) => self.false_hits += 1,
            (_, None) => self.missed += 1,
            (Answer::AtOnce, Some(t)) => self.late += usize::from(t > 0.0),
            (Answer::Between(may, must), Some(t)) => {
                self.late += usize::from(t > must + ulp);
                self.early += usize::from(t < may - ulp);
            }
        }
    }
}

/// A pose at which the shape is from 1 to 16 mm off the ring, and a way for it to go.
fn start(rng: &mut Rng, distance: Distance) -> (Truth, Pose, Vector) {
    loop {
        let turn = rng.direction() * rng.range(0.0, std::f64::consts::PI);
        let turn = UnitQuaternion::from_scaled_axis(turn);
        let from = rng.in_ball() * 0.4;
        let out = rng.direction();
        let wanted = rng.range(0.001, 0.016);
        let velocity = rng.direction();
        let truth = |way: f64| {
            // What `f32` holds is the truth.
            let p = (from + out * way).map(|x| x as Real);
            let v = velocity.map(|x| x as Real);
            let q = turn.coords.map(|x| x as Real);
            let rotation = Rotation::from_xyzw(q.x, q.y, q.z, q.w).normalize();
            let pose = Pose::from_parts(Vector::new(p.x, p.y, p.z), rotation);
            let wide = nalgebra::Quaternion::new(rotation.w, rotation.x, rotation.y, rotation.z);
            let truth = Truth {
                distance,
                pose: Isometry3::from_parts(
                    Translation3::from(p.map(f64::from)),
                    UnitQuaternion::from_quaternion(wide.cast()),
                ),
                velocity: v.map(f64::from),
            };
            (truth, pose, Vector::new(v.x, v.y, v.z))
        };
        let gap = |way: f64| truth(way).0.gap();
        let (mut a, mut b) = (0.0, 0.6);
        if gap(a) < wanted || gap(b) > wanted {
            continue;
        }
        for _ in 0..30 {
            let way = 0.5 * (a + b);
            if gap(way) > wanted { a = way } else { b = way }
        }
        return truth(a);
    }
}

#[test]
fn casts_that_start_within_their_target_meet_what_comes_later_at_the_target() {
    let casts = std::env::var("CASTS")
        .ok()
        .and_then(|n| n.parse().ok())
        .unwrap_or(16);
    let (ring, compound) = (ring(), compound());
    let ours = MedialDispatcher::default();
    for (k, (name, shape, distance)) in shapes().into_iter().enumerate() {
        let mut rng = Rng::new(900 + k as u64);
        let (mut wrong, mut swapped, mut rapiers) = <[Wrong; 3]>::default().into();
        let (mut later, mut at_once, mut free) = (0, 0, 0);
        while later < casts {
            let (truth, pose, velocity) = start(&mut rng, distance);
            let answer = truth.answer();
            match answer {
                Answer::Between(..) => later += 1,
                Answer::AtOnce => at_once += 1,
                Answer::None => free += 1,
                Answer::Unsure => continue,
            }
            let options = ShapeCastOptions {
                target_distance: TARGET as Real,
                max_time_of_impact: SECONDS as Real,
                stop_at_penetration: false,
                compute_impact_geometry_on_penetration: true,
            };
            let cast = |dispatcher: &dyn QueryDispatcher, ring: &dyn Shape, shape: &dyn Shape| {
                let hit = dispatcher.cast_shapes(&pose, velocity, ring, shape, options);
                hit.expect("swept")
            };
            wrong.count(&answer, cast(&ours, &ring, shape[0].as_ref()).as_ref());
            let (back, away) = (pose.inverse(), pose.rotation.inverse() * -velocity);
            let hit = ours.cast_shapes(&back, away, shape[0].as_ref(), &ring, options);
            swapped.count(&answer, hit.expect("swept").as_ref());
            let hit = cast(
                &DefaultQueryDispatcher,
                compound.as_ref(),
                shape[1].as_ref(),
            );
            rapiers.count(&answer, hit.as_ref());
        }
        println!(
            "{name}: {later} later, {at_once} at once, {free} free: ours {wrong:?}, swapped {swapped:?}, compound {rapiers:?}"
        );
        assert_eq!([&wrong, &swapped], [&Wrong::default(); 2], "{name}");
    }
}
