//! First contact of two moving triangle meshes: the ground truth for times of impact. It knows
//! nothing of medial meshes and works on the exact distances of triangles, in double precision.
//!
//! Conservative advancement (Mirtich 1996) over pairs of nodes of two sphere trees, the earliest
//! pair first: no point of a pair's parts comes nearer than its distance now less the time times
//! their largest speed, so the pair is put back for the time at which that could reach zero, or split
//! where its parts are nearer than they are large. The first two triangles to come within the
//! tolerance are the contact, for all other pairs wait for later times.

use super::mesh::Mesh;
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use rapier3d::prelude::Vector;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

type V = Vector3<f64>;

/// A rigid motion: the origin moves straight, the body turns about it at a constant rate.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// Where the body's origin starts.
    pub start: V,
    /// Velocity of the origin, per second.
    pub velocity: V,
    /// Angular velocity, in radians per second.
    pub turn: V,
}

impl Motion {
    /// Where the body is at a time.
    pub fn pose(&self, time: f64) -> Isometry3<f64> {
        Isometry3::from_parts(
            Translation3::from(self.start + self.velocity * time),
            UnitQuaternion::from_scaled_axis(self.turn * time),
        )
    }
}

/// A triangle mesh with a tree of spheres over its triangles.
pub struct TriangleBody {
    triangles: Vec<[V; 3]>,
    /// Node 0 is the root; a leaf has one triangle.
    nodes: Vec<Node>,
}

struct Node {
    center: V,
    radius: f64,
    below: Below,
}

enum Below {
    Nodes([usize; 2]),
    Triangle(usize),
}

impl TriangleBody {
    /// The tree over a mesh with at least one triangle.
    pub fn new(mesh: &Mesh) -> Self {
        let vector = |v: Vector| V::new(v.x.into(), v.y.into(), v.z.into());
        let corners = |&t: &[u32; 3]| mesh.corners(t).map(vector);
        let triangles: Vec<[V; 3]> = mesh.indices.iter().map(corners).collect();
        let mut body = Self {
            nodes: Vec::with_capacity(2 * triangles.len()),
            triangles,
        };
        let mut all: Vec<usize> = (0..body.triangles.len()).collect();
        body.grow(&mut all);
        body
    }

    /// Adds the node over some triangles and those below it; returns its number.
    fn grow(&mut self, triangles: &mut [usize]) -> usize {
        let points = || triangles.iter().flat_map(|&t| self.triangles[t]);
        let start = (V::repeat(f64::MAX), V::repeat(f64::MIN));
        let (low, high) = points().fold(start, |(low, high), p| (low.inf(&p), high.sup(&p)));
        let center = (low + high) / 2.0;
        let radius = points().map(|p| (p - center).norm()).fold(0.0, f64::max);
        let number = self.nodes.len();
        self.nodes.push(Node {
            center,
            radius,
            below: Below::Triangle(triangles[0]),
        });
        if triangles.len() > 1 {
            let axis = (high - low).imax();
            let all = &self.triangles;
            let middle = |t: usize| all[t].iter().map(|p| p[axis]).sum::<f64>();
            let half = triangles.len() / 2;
            triangles.select_nth_unstable_by(half, |&a, &b| middle(a).total_cmp(&middle(b)));
            let (left, right) = triangles.split_at_mut(half);
            let below = [self.grow(left), self.grow(right)];
            self.nodes[number].below = Below::Nodes(below);
        }
        number
    }
}

/// A pair of nodes that cannot touch before `time`.
struct Pending {
    time: f64,
    nodes: [usize; 2],
}

impl PartialEq for Pending {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}
impl Eq for Pending {}
impl PartialOrd for Pending {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Pending {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let by_time = self.time.total_cmp(&other.time);
        by_time.then(self.nodes.cmp(&other.nodes))
    }
}

/// Earliest time, in [0, `seconds`], at which the surfaces come within `tolerance` (a length); at
/// no earlier time do they touch. `None` where they do not in all that time. Surfaces only: a mesh
/// wholly inside another does not touch it.
pub fn first_contact(
    bodies: [&TriangleBody; 2],
    motions: [&Motion; 2],
    seconds: f64,
    tolerance: f64,
) -> Option<f64> {
    let slide = (motions[0].velocity - motions[1].velocity).norm();
    let turns = motions.map(|motion| motion.turn.norm());
    let mut queue = BinaryHeap::from([Reverse(Pending {
        time: 0.0,
        nodes: [0, 0],
    })]);
    while let Some(Reverse(Pending { time, nodes })) = queue.pop() {
        if time > seconds {
            return None;
        }
        let poses = motions.map(|motion| motion.pose(time));
        let parts = [0, 1].map(|k| &bodies[k].nodes[nodes[k]]);
        let [a, b] = [0, 1].map(|k| poses[k] * Point3::from(parts[k].center));
        let apart = (a - b).norm() - parts[0].radius - parts[1].radius;
        let swing = |k: usize| turns[k] * (parts[k].center.norm() + parts[k].radius);
        let speed = slide + swing(0) + swing(1);
        let mut put = |time, nodes| queue.push(Reverse(Pending { time, nodes }));
        let larger = usize::from(parts[1].radius > parts[0].radius);
        match (&parts[0].below, &parts[1].below) {
            _ if apart > parts[larger].radius => put(time + apart / speed, nodes),
            (&Below::Triangle(i), &Below::Triangle(j)) => {
                let first = bodies[0].triangles[i].map(|p| poses[0] * Point3::from(p));
                let second = bodies[1].triangles[j].map(|p| poses[1] * Point3::from(p));
                let distance =
                    triangle_distance(&first.map(|p| p.coords), &second.map(|p| p.coords));
                if distance <= tolerance {
                    return Some(time);
                }
                put(time + distance / speed, nodes);
            }
            (&Below::Nodes(children), Below::Triangle(_)) => {
                children.into_iter().for_each(|c| put(time, [c, nodes[1]]));
            }
            (Below::Triangle(_), &Below::Nodes(children)) => {
                children.into_iter().for_each(|c| put(time, [nodes[0], c]));
            }
            (&Below::Nodes(first), &Below::Nodes(second)) => {
                if larger == 0 {
                    first.into_iter().for_each(|c| put(time, [c, nodes[1]]));
                } else {
                    second.into_iter().for_each(|c| put(time, [nodes[0], c]));
                }
            }
        }
    }
    None
}

/// Smallest distance of two surfaces at one time: pairs of nodes, the nearest first.
pub fn distance_at(bodies: [&TriangleBody; 2], motions: [&Motion; 2], time: f64) -> f64 {
    let poses = motions.map(|motion| motion.pose(time));
    let least = |nodes: [usize; 2]| {
        let parts = [0, 1].map(|k| &bodies[k].nodes[nodes[k]]);
        let [a, b] = [0, 1].map(|k| poses[k] * Point3::from(parts[k].center));
        ((a - b).norm() - parts[0].radius - parts[1].radius).max(0.0)
    };
    // `Pending` orders by one number: here it is a distance.
    let pending = |nodes| {
        let time = least(nodes);
        Reverse(Pending { time, nodes })
    };
    let mut queue = BinaryHeap::from([pending([0, 0])]);
    let mut best = f64::MAX;
    while let Some(Reverse(Pending { time: low, nodes })) = queue.pop() {
        if low >= best {
            break;
        }
        let parts = [0, 1].map(|k| &bodies[k].nodes[nodes[k]]);
        match (&parts[0].below, &parts[1].below) {
            (&Below::Triangle(i), &Below::Triangle(j)) => {
                let placed = |k: usize, triangle: [V; 3]| {
                    triangle.map(|p| (poses[k] * Point3::from(p)).coords)
                };
                let first = placed(0, bodies[0].triangles[i]);
                let second = placed(1, bodies[1].triangles[j]);
                best = best.min(triangle_distance(&first, &second));
            }
            (&Below::Nodes(below), second)
                if matches!(second, Below::Triangle(_)) || parts[0].radius >= parts[1].radius =>
            {
                queue.extend(below.map(|c| pending([c, nodes[1]])));
            }
            (_, &Below::Nodes(below)) => queue.extend(below.map(|c| pending([nodes[0], c]))),
            (Below::Nodes(_), Below::Triangle(_)) => unreachable!("taken by the guard above"),
        }
    }
    best
}

/// Distance of two triangles: 0 where an edge of one goes through the other, else the smallest over
/// edge and edge, corner and face.
pub fn triangle_distance(a: &[V; 3], b: &[V; 3]) -> f64 {
    let edges = |t: &[V; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    let pierced = |t: &[V; 3], by: &[V; 3]| edges(by).iter().any(|e| pierces(e, t));
    if pierced(a, b) || pierced(b, a) {
        return 0.0;
    }
    let between_edges = edges(a)
        .into_iter()
        .flat_map(|e| edges(b).map(|f| segment_distance(&e, &f)));
    let to_faces = b.iter().filter_map(|p| height_over(p, a));
    let from_faces = a.iter().filter_map(|p| height_over(p, b));
    let all = between_edges.chain(to_faces).chain(from_faces);
    all.fold(f64::MAX, f64::min)
}

/// Whether a segment crosses a triangle's inside.
fn pierces(segment: &[V; 2], triangle: &[V; 3]) -> bool {
    let [a, b, c] = triangle;
    let normal = (b - a).cross(&(c - a));
    let [from, to] = segment.map(|p| normal.dot(&(p - a)));
    if (from > 0.0) == (to > 0.0) || from == to {
        return false;
    }
    let p = segment[0] + (segment[1] - segment[0]) * (from / (from - to));
    is_over(&p, triangle, &normal)
}

/// Whether a point projects into a triangle along its normal.
fn is_over(p: &V, [a, b, c]: &[V; 3], normal: &V) -> bool {
    let inside = |from: &V, to: &V| (to - from).cross(&(p - from)).dot(normal) >= 0.0;
    inside(a, b) && inside(b, c) && inside(c, a)
}

/// Distance of a point to a triangle's plane, where it projects into the triangle.
fn height_over(p: &V, triangle: &[V; 3]) -> Option<f64> {
    let [a, b, c] = triangle;
    let normal = (b - a).cross(&(c - a));
    let over = normal.norm() > 0.0 && is_over(p, triangle, &normal);
    over.then(|| (p - a).dot(&normal).abs() / normal.norm())
}

/// Distance of two segments (Ericson 2005, 5.1.9): the closest point of the first line is clamped to
/// its segment, then the second's, then the first's again; the ends cover parallel segments.
fn segment_distance([a, b]: &[V; 2], [c, d]: &[V; 2]) -> f64 {
    let (u, v, w) = (b - a, d - c, a - c);
    let (uu, vv, uv) = (u.norm_squared(), v.norm_squared(), u.dot(&v));
    let (uw, vw) = (u.dot(&w), v.dot(&w));
    let share = |top: f64, bottom: f64| {
        if bottom > 0.0 {
            (top / bottom).clamp(0.0, 1.0)
        } else {
            0.0
        }
    };
    let determinant = uu * vv - uv * uv;
    let start = share(uv * vw - vv * uw, determinant);
    let at = |s: f64| {
        let t = share(vw + s * uv, vv);
        let s = share(t * uv - uw, uu);
        (w + u * s - v * t).norm()
    };
    [start, 0.0, 1.0]
        .map(at)
        .into_iter()
        .fold(f64::MAX, f64::min)
}
