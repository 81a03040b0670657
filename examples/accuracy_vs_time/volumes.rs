//! Trees of bounding volumes over triangles, with continuous collision of the triangles under them:
//! what the paper compares with (Figures 10, 12 and 13), oriented boxes and spheres.
//!
//! Both trees split their triangles at the median along the longest side, and are searched alike, by
//! conservative advancement, the earliest pair first: only the volume differs.

use crate::common::mesh::Mesh;
use crate::common::triangle_toi::{Motion, triangle_distance};
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use rapier3d::parry::query::PointQuery;
use rapier3d::prelude::{Real, Vector};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

type V = Vector3<f64>;

/// A volume round some points.
pub trait Volume: Sized {
    /// What the tree is called.
    const NAME: &'static str;
    /// A volume that holds all points.
    fn around(points: &[V]) -> Self;
    /// Lower bound of the distance of two placed volumes; not above 0 where they may touch.
    fn gap(&self, pose: &Isometry3<f64>, other: &Self, other_pose: &Isometry3<f64>) -> f64;
    /// Half its largest extent.
    fn size(&self) -> f64;
    /// About `count` points on its boundary, and whether a point is well inside.
    fn boundary(&self, count: usize) -> Vec<V>;
    /// Whether it holds a point in its inside.
    fn holds(&self, point: &V) -> bool;
}

/// A sphere about the middle of the points' box.
pub struct Ball {
    center: V,
    radius: f64,
}

impl Volume for Ball {
    const NAME: &'static str = "sphere tree";

    fn around(points: &[V]) -> Self {
        let center = (least(points) + most(points)) / 2.0;
        let radii = points.iter().map(|p| (p - center).norm());
        Self {
            center,
            radius: radii.fold(0.0, f64::max),
        }
    }

    fn gap(&self, pose: &Isometry3<f64>, other: &Self, other_pose: &Isometry3<f64>) -> f64 {
        let [a, b] = [
            pose * Point3::from(self.center),
            other_pose * Point3::from(other.center),
        ];
        (a - b).norm() - self.radius - other.radius
    }

    fn size(&self) -> f64 {
        self.radius
    }

    fn boundary(&self, count: usize) -> Vec<V> {
        let turn = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        let point = |k: usize| {
            let y = 1.0 - (2 * k + 1) as f64 / count as f64;
            let (sin, cos) = (turn * k as f64).sin_cos();
            let across = (1.0 - y * y).sqrt();
            self.center + V::new(across * cos, y, across * sin) * self.radius
        };
        (0..count).map(point).collect()
    }

    fn holds(&self, point: &V) -> bool {
        (point - self.center).norm() < self.radius * (1.0 - 1.0e-6)
    }
}

/// A box along the principal axes of the points.
pub struct TurnedBox {
    center: V,
    /// Unit columns.
    axes: Matrix3<f64>,
    half: V,
}

impl Volume for TurnedBox {
    const NAME: &'static str = "oriented-box tree";

    fn around(points: &[V]) -> Self {
        let mean = points.iter().sum::<V>() / points.len() as f64;
        let spread = |m: Matrix3<f64>, p: &V| m + (p - mean) * (p - mean).transpose();
        let axes = points
            .iter()
            .fold(Matrix3::zeros(), spread)
            .symmetric_eigen()
            .eigenvectors;
        let inside: Vec<V> = points
            .iter()
            .map(|p| axes.transpose() * (p - mean))
            .collect();
        let (low, high) = (least(&inside), most(&inside));
        Self {
            center: mean + axes * ((low + high) / 2.0),
            axes,
            half: (high - low) / 2.0,
        }
    }

    /// The widest separation along the fifteen axes (Gottschalk 1996), which is no more than the distance.
    fn gap(&self, pose: &Isometry3<f64>, other: &Self, other_pose: &Isometry3<f64>) -> f64 {
        let placed = |pose: &Isometry3<f64>, b: &Self| {
            (
                (pose * Point3::from(b.center)).coords,
                pose.rotation.to_rotation_matrix().into_inner() * b.axes,
            )
        };
        let ((c1, a1), (c2, a2)) = (placed(pose, self), placed(other_pose, other));
        let between = c2 - c1;
        let along = |n: V| {
            let reach = |axes: &Matrix3<f64>, half: &V| (axes.transpose() * n).abs().dot(half);
            between.dot(&n).abs() - reach(&a1, &self.half) - reach(&a2, &other.half)
        };
        let mut widest = f64::MIN;
        for k in 0..3 {
            widest = widest
                .max(along(a1.column(k).into()))
                .max(along(a2.column(k).into()));
        }
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            let n = V::from(a1.column(i)).cross(&V::from(a2.column(j)));
            let length = n.norm();
            if length > 1.0e-6 {
                widest = widest.max(along(n / length));
            }
        }
        widest
    }

    fn size(&self) -> f64 {
        self.half.norm()
    }

    fn boundary(&self, count: usize) -> Vec<V> {
        let side = ((count as f64 / 6.0).sqrt().ceil() as usize).max(2);
        let share = |k: usize| 2.0 * k as f64 / (side - 1) as f64 - 1.0;
        let mut points = Vec::new();
        for axis in 0..3 {
            for k in 0..2 * side * side {
                let mut local = V::zeros();
                local[axis] = [-1.0, 1.0][k % 2];
                local[(axis + 1) % 3] = share(k / 2 % side);
                local[(axis + 2) % 3] = share(k / 2 / side);
                points.push(self.center + self.axes * local.component_mul(&self.half));
            }
        }
        points
    }

    fn holds(&self, point: &V) -> bool {
        let local = self.axes.transpose() * (point - self.center);
        let margin = 1.0e-6 * self.half.norm();
        (0..3).all(|k| local[k].abs() < self.half[k] - margin)
    }
}

fn least(points: &[V]) -> V {
    points.iter().fold(V::repeat(f64::MAX), |low, p| low.inf(p))
}

fn most(points: &[V]) -> V {
    points
        .iter()
        .fold(V::repeat(f64::MIN), |high, p| high.sup(p))
}

struct Node<T> {
    volume: T,
    /// Farthest corner of its triangles from the body's origin.
    reach: f64,
    below: Result<[usize; 2], usize>,
}

/// A triangle mesh under a tree of volumes, down to single triangles.
pub struct Tree<T> {
    triangles: Vec<[V; 3]>,
    nodes: Vec<Node<T>>,
}

/// Pairs of volumes and of triangles that a query looked at.
#[derive(Clone, Copy, Debug, Default)]
pub struct Looked {
    /// Of volumes.
    pub volumes: u64,
    /// Of triangles: the elementary tests.
    pub triangles: u64,
}

impl<T: Volume> Tree<T> {
    /// The tree over a mesh with at least one triangle.
    pub fn new(mesh: &Mesh) -> Self {
        let vector = |v: Vector| V::new(v.x.into(), v.y.into(), v.z.into());
        let corners = |&t: &[u32; 3]| mesh.corners(t).map(vector);
        let mut tree = Self {
            triangles: mesh.indices.iter().map(corners).collect(),
            nodes: Vec::new(),
        };
        let mut all: Vec<usize> = (0..tree.triangles.len()).collect();
        tree.grow(&mut all);
        tree
    }

    fn grow(&mut self, part: &mut [usize]) -> usize {
        let points: Vec<V> = part.iter().flat_map(|&t| self.triangles[t]).collect();
        let number = self.nodes.len();
        self.nodes.push(Node {
            volume: T::around(&points),
            reach: points.iter().map(V::norm).fold(0.0, f64::max),
            below: Err(part[0]),
        });
        if part.len() > 1 {
            let axis = (most(&points) - least(&points)).imax();
            let all = &self.triangles;
            let middle = |t: usize| all[t].iter().map(|p| p[axis]).sum::<f64>();
            let half = part.len() / 2;
            part.select_nth_unstable_by(half, |&a, &b| middle(a).total_cmp(&middle(b)));
            let (left, right) = part.split_at_mut(half);
            self.nodes[number].below = Ok([self.grow(left), self.grow(right)]);
        }
        number
    }

    /// The volumes where the tree is cut at so many leaves, the largest split first.
    fn cut(&self, leaves: usize) -> Vec<&T> {
        let mut open = vec![0];
        while open.len() < leaves {
            let inner = open
                .iter()
                .enumerate()
                .filter(|(_, n)| self.nodes[**n].below.is_ok());
            let size = |n: usize| self.nodes[n].volume.size();
            let Some((place, _)) = inner.max_by(|a, b| size(*a.1).total_cmp(&size(*b.1))) else {
                break;
            };
            let number = open.swap_remove(place);
            open.extend(self.nodes[number].below.iter().flatten());
        }
        open.into_iter().map(|n| &self.nodes[n].volume).collect()
    }

    /// Largest distance from the boundary of the union of so many leaves to the surface, sampled at
    /// about `points` places.
    pub fn bloat(&self, source: &Mesh, leaves: usize, points: usize) -> f64 {
        let surface = source.to_parry();
        let volumes = self.cut(leaves);
        let mut largest: f64 = 0.0;
        for (number, volume) in volumes.iter().enumerate() {
            for point in volume.boundary(points / leaves + 6) {
                let p = Vector::new(point.x as Real, point.y as Real, point.z as Real);
                let off = f64::from(surface.project_local_point(p, false).point.distance(p));
                // The cheaper question first: most points cannot raise the largest.
                let covered = |(k, v): (usize, &&T)| k != number && v.holds(&point);
                if off > largest && !volumes.iter().enumerate().any(covered) {
                    largest = off;
                }
            }
        }
        largest
    }

    /// First time in one second at which the triangles come within `tolerance`.
    pub fn first_contact(
        &self,
        other: &Self,
        motions: [&Motion; 2],
        tolerance: f64,
    ) -> (Option<f64>, Looked) {
        let straight = (motions[0].velocity - motions[1].velocity).norm();
        let turns = motions.map(|m| m.turn.norm());
        let mut looked = Looked::default();
        let mut queue = BinaryHeap::from([Reverse(Pending(0.0, [0, 0]))]);
        while let Some(Reverse(Pending(time, nodes))) = queue.pop() {
            if time > 1.0 {
                break;
            }
            let [a, b] = [&self.nodes[nodes[0]], &other.nodes[nodes[1]]];
            let speed = straight + turns[0] * a.reach + turns[1] * b.reach;
            let poses = motions.map(|motion| motion.pose(time));
            looked.volumes += 1;
            let gap = a.volume.gap(&poses[0], &b.volume, &poses[1]);
            let mut put = |time, nodes| queue.push(Reverse(Pending(time, nodes)));
            if gap > a.volume.size().max(b.volume.size()) {
                put(time + gap / speed, nodes);
                continue;
            }
            match (a.below, b.below) {
                (Err(i), Err(j)) => {
                    looked.triangles += 1;
                    let placed = |pose: &Isometry3<f64>, t: [V; 3]| {
                        t.map(|p| (pose * Point3::from(p)).coords)
                    };
                    let distance = triangle_distance(
                        &placed(&poses[0], self.triangles[i]),
                        &placed(&poses[1], other.triangles[j]),
                    );
                    if distance <= tolerance {
                        return (Some(time), looked);
                    }
                    put(time + distance / speed, nodes);
                }
                (Ok(below), second) if second.is_err() || a.volume.size() >= b.volume.size() => {
                    below.into_iter().for_each(|c| put(time, [c, nodes[1]]));
                }
                (_, Ok(below)) => below.into_iter().for_each(|c| put(time, [nodes[0], c])),
                (Ok(_), Err(_)) => unreachable!("taken by the guard above"),
            }
        }
        (None, looked)
    }
}

/// A pair of nodes that cannot touch before a time.
struct Pending(f64, [usize; 2]);

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
        self.0.total_cmp(&other.0).then(self.1.cmp(&other.1))
    }
}
