//! A triangle mesh with fewer vertices: edges are collapsed, the cheapest by the quadric error first
//! (Garland and Heckbert 1997). Collapses that would pinch the surface or turn a triangle over are
//! left out.

use super::mesh::Mesh;
use nalgebra::{Matrix3, Vector3};
use rapier3d::prelude::{Real, Vector};
use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

type V = Vector3<f64>;

/// Sum of squared distances to planes: xᵀ A x + 2 bᵀ x + c.
#[derive(Clone, Copy)]
struct Quadric {
    a: Matrix3<f64>,
    b: V,
    c: f64,
}

impl Quadric {
    const ZERO: Self = Self {
        a: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        b: V::new(0.0, 0.0, 0.0),
        c: 0.0,
    };

    /// Of a triangle's plane, weighted by its area.
    fn of([p, q, r]: [V; 3]) -> Self {
        let across = (q - p).cross(&(r - p));
        let area = across.norm();
        if area == 0.0 {
            return Self::ZERO;
        }
        let (n, weight) = (across / area, area / 2.0);
        let d = -n.dot(&p);
        Self {
            a: n * n.transpose() * weight,
            b: n * (d * weight),
            c: d * d * weight,
        }
    }

    fn plus(&self, other: &Self) -> Self {
        Self {
            a: self.a + other.a,
            b: self.b + other.b,
            c: self.c + other.c,
        }
    }

    fn at(&self, x: &V) -> f64 {
        (x.dot(&(self.a * x)) + 2.0 * self.b.dot(x) + self.c).max(0.0)
    }
}

struct Surface {
    points: Vec<V>,
    quadrics: Vec<Quadric>,
    /// `None` once it is gone.
    triangles: Vec<Option<[usize; 3]>>,
    around: Vec<BTreeSet<usize>>,
    /// Counts the changes of a vertex: an older offer is void.
    version: Vec<u32>,
}

/// Cost as bits (costs are not negative, so bits are in order), the two ends and their versions.
type Offer = Reverse<(u64, [usize; 2], [u32; 2])>;

impl Surface {
    fn corners(&self, t: [usize; 3]) -> [V; 3] {
        t.map(|k| self.points[k])
    }

    fn neighbours(&self, k: usize) -> BTreeSet<usize> {
        let triangles = self.around[k].iter().filter_map(|&t| self.triangles[t]);
        triangles.flatten().filter(|&other| other != k).collect()
    }

    /// Where an edge is drawn together, and what that costs.
    fn target(&self, [i, j]: [usize; 2]) -> (f64, V) {
        let sum = self.quadrics[i].plus(&self.quadrics[j]);
        let (p, q) = (self.points[i], self.points[j]);
        let best = sum.a.try_inverse().map(|inverse| inverse * -sum.b);
        // A flat place has its least error anywhere: there the point may not go astray.
        let near = |x: &V| (x - p).norm() + (x - q).norm() <= 3.0 * (p - q).norm();
        let choices = [Some(p), Some(q), Some((p + q) / 2.0), best.filter(near)];
        let costs = choices.into_iter().flatten().map(|x| (sum.at(&x), x));
        let least = costs.min_by(|a, b| a.0.total_cmp(&b.0));
        least.expect("the ends are choices")
    }

    fn offer(&self, edge: [usize; 2]) -> Offer {
        let cost = self.target(edge).0;
        Reverse((cost.to_bits(), edge, edge.map(|k| self.version[k])))
    }

    /// Whether the surface stays a manifold, and no triangle turns over.
    fn may_collapse(&self, [i, j]: [usize; 2], at: &V) -> bool {
        let (of_i, of_j) = (self.neighbours(i), self.neighbours(j));
        if of_i.intersection(&of_j).count() != 2 || of_i.union(&of_j).count() < 5 {
            return false;
        }
        let normal = |[p, q, r]: [V; 3]| (q - p).cross(&(r - p));
        let kept = self.around[i].symmetric_difference(&self.around[j]);
        kept.filter_map(|&t| self.triangles[t]).all(|t| {
            let before = normal(self.corners(t));
            let moved = t.map(|k| {
                if k == i || k == j {
                    *at
                } else {
                    self.points[k]
                }
            });
            let after = normal(moved);
            before.dot(&after) > 0.2 * before.norm() * after.norm()
        })
    }

    /// Draws the edge together into its first end.
    fn collapse(&mut self, [i, j]: [usize; 2], at: V) {
        self.points[i] = at;
        self.quadrics[i] = self.quadrics[i].plus(&self.quadrics[j]);
        for t in std::mem::take(&mut self.around[j]) {
            let Some(mut triangle) = self.triangles[t] else {
                continue;
            };
            if triangle.contains(&i) {
                self.triangles[t] = None;
                for k in triangle {
                    self.around[k].remove(&t);
                }
            } else {
                triangle = triangle.map(|k| if k == j { i } else { k });
                self.triangles[t] = Some(triangle);
                self.around[i].insert(t);
            }
        }
        self.version[i] += 1;
        self.version[j] += 1;
    }
}

/// The mesh with at most so many vertices, where no more collapses are refused.
pub fn decimated(mesh: &Mesh, vertices: usize) -> Mesh {
    let count = mesh.vertices.len();
    let point = |v: &Vector| V::new(v.x.into(), v.y.into(), v.z.into());
    let mut surface = Surface {
        points: mesh.vertices.iter().map(point).collect(),
        quadrics: vec![Quadric::ZERO; count],
        triangles: Vec::new(),
        around: vec![BTreeSet::new(); count],
        version: vec![0; count],
    };
    for (number, corners) in mesh.indices.iter().enumerate() {
        let triangle = corners.map(|k| k as usize);
        let quadric = Quadric::of(surface.corners(triangle));
        for k in triangle {
            surface.quadrics[k] = surface.quadrics[k].plus(&quadric);
            surface.around[k].insert(number);
        }
        surface.triangles.push(Some(triangle));
    }
    let mut queue: BinaryHeap<Offer> = BinaryHeap::new();
    for i in 0..count {
        let edges = surface.neighbours(i).into_iter().filter(|&j| j > i);
        queue.extend(edges.map(|j| surface.offer([i, j])));
    }
    let mut left = count;
    while left > vertices {
        let Some(Reverse((_, edge, versions))) = queue.pop() else {
            break;
        };
        if edge.map(|k| surface.version[k]) != versions {
            continue;
        }
        let at = surface.target(edge).1;
        if !surface.may_collapse(edge, &at) {
            continue;
        }
        surface.collapse(edge, at);
        left -= 1;
        let i = edge[0];
        for j in surface.neighbours(i) {
            queue.push(surface.offer([i.min(j), i.max(j)]));
        }
    }
    packed(&surface)
}

/// The triangles that are left, with the vertices that they use.
fn packed(surface: &Surface) -> Mesh {
    let mut number = vec![None; surface.points.len()];
    let mut mesh = Mesh::default();
    for triangle in surface.triangles.iter().flatten() {
        let corners = triangle.map(|k| {
            *number[k].get_or_insert_with(|| {
                let p = surface.points[k];
                let vertex = Vector::new(p.x as Real, p.y as Real, p.z as Real);
                mesh.vertices.push(vertex);
                mesh.vertices.len() as u32 - 1
            })
        });
        mesh.indices.push(corners);
    }
    mesh
}
