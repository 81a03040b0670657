//! The initial medial mesh that keeps creases: the Voronoi complex of the samples inside, its balls made
//! tangent to their faces, its polygons clipped where they run out of the solid at a convex crease.
//!
//! The Voronoi polygon between the two halves of a pair at a crease (`crease_samples.rs`) leaves the
//! solid through it. The two of its edges that do so end on the crease, at balls of radius 0: a corner
//! where three groups meet, else the nearest point of the crease between the two groups. A Voronoi edge is
//! a Delaunay triangle, which names its end, so that neighbouring polygons share it.

use crate::error::BuildError;
use crate::math::fast_hash::FastMap;
use crate::meshing::axis::crease_samples::CreaseSamples;
use crate::meshing::axis::delaunay::{Delaunay, NONE};
use crate::meshing::axis::inner_balls::{JITTER, buried, circumsphere, vote};
use crate::meshing::axis::shrinking_ball::shrink_from;
use crate::meshing::axis::tangent::{Faces, Tangent, TangentPlane};
use crate::meshing::draft::{Ball, Draft};
use crate::meshing::geometry::bounds::{Bounds, Point, direction};
use crate::meshing::geometry::chunks::{COSTLY, map_each};
use crate::meshing::geometry::random::Random;
use crate::meshing::geometry::winding::INSIDE;
use crate::meshing::surface::samples::Sample;
use crate::meshing::watch::Watch;

/// A ball may move by this many distances between samples to become tangent.
const TANGENT_REACH: f64 = 3.0;

/// A ball that cannot be made tangent is dropped where the surface is nearer than this share of its radius.
const TRUE_RADIUS: f64 = 0.7;

/// Step beyond the medial axis, over the radius there.
const BEYOND: f64 = 0.05;

/// Guess of the distance from a ball's centre to the surface, over its radius: samples lie on it, but for a shift. Only
/// time depends on it.
const ABOUT: f64 = 1.01;

/// Half the side of the cube whose corners are added to the samples, so that no Voronoi polygon of a
/// sample is unbounded (longest side 1).
const HALF_BOX: f64 = 2.0;

/// Tetrahedra around an edge at most; more are of samples on a circle, in the jitter's order.
const LONGEST_RING: usize = 400;

/// Tetrahedra between two reports of progress.
const AT_A_TIME: usize = 4096;

/// Samples of one group, at a crease that fades within it, differ by more than this cosine.
const FADING: f64 = 0.9;

/// A medial mesh, and for each of its balls the planes that it touches and triangles of them.
#[derive(Default)]
pub struct CreasedMesh {
    /// The medial mesh; balls on creases have radius 0.
    pub draft: Draft,
    /// Planes that each ball touches.
    pub planes: Vec<Vec<TangentPlane>>,
    /// Triangles of the surface that each ball touches.
    pub triangles: Vec<Vec<u32>>,
}

impl CreasedMesh {
    /// Adds a ball; gives its index.
    pub fn push(&mut self, tangent: Tangent) -> u32 {
        self.draft.balls.push(tangent.ball);
        self.planes.push(tangent.planes);
        self.triangles.push(tangent.triangles);
        self.draft.balls.len() as u32 - 1
    }
}

/// The initial medial mesh of samples.
pub fn creased_mesh(
    faces: &Faces,
    CreaseSamples {
        samples, distances, ..
    }: &CreaseSamples,
    watch: &mut Watch,
) -> Result<CreasedMesh, BuildError> {
    watch.begin("delaunay")?;
    let points = with_far_points(samples);
    let all = points.len() as f64;
    let delaunay = Delaunay::with_tick(&points, |done| watch.at(done as f64 / all))?;
    watch.hold(delaunay.bytes(points.len()));
    watch.begin("inner balls")?;
    let mut clipper = Clipper {
        faces,
        samples,
        distances,
        ball_of: vec![NONE; delaunay.tetrahedra.len()],
        delaunay,
        mesh: CreasedMesh::default(),
        ends: FastMap::default(),
        corner_balls: FastMap::default(),
    };
    clipper.add_balls(&points, watch)?;
    clipper.add_polygons(watch)?;
    Ok(clipper.mesh)
}

/// The samples' points, shifted a little as ever, and eight far around them.
fn with_far_points(samples: &[Sample]) -> Vec<Point> {
    let mut random = Random::new(4);
    let mut points = crate::meshing::axis::inner_balls::shifted(samples);
    for corner in 0..8u32 {
        let mut side = |bit: u32| {
            let far = HALF_BOX + 0.1 * random.unit() + JITTER;
            if corner >> bit & 1 == 1 { far } else { -far }
        };
        points.push(Point::new(side(0), side(1), side(2)));
    }
    points
}

/// Clips polygons against the inside.
pub struct Clipper<'a> {
    pub(crate) faces: &'a Faces<'a>,
    pub(crate) samples: &'a [Sample],
    pub(crate) distances: &'a [f64],
    delaunay: Delaunay,
    /// Ball of each tetrahedron inside, or [`NONE`].
    ball_of: Vec<u32>,
    pub(crate) mesh: CreasedMesh,
    /// Ends of the Voronoi edges that leave the solid, by the samples of their Delaunay triangle.
    pub(crate) ends: FastMap<[u32; 3], Option<u32>>,
    /// Balls at corners, by vertex.
    pub(crate) corner_balls: FastMap<u32, u32>,
}

impl Clipper<'_> {
    fn add_balls(&mut self, points: &[Point], watch: &mut Watch) -> Result<(), BuildError> {
        let bounds = Bounds::of(self.samples.iter().map(|s| s.point));
        let all: Vec<u32> = (0..self.delaunay.tetrahedra.len() as u32).collect();
        for part in all.chunks(AT_A_TIME) {
            watch.at(f64::from(part[0]) / all.len() as f64)?;
            let tangents = map_each(COSTLY, part, watch, |&t| self.ball_in(t, points, &bounds))?;
            for (t, tangent) in part.iter().zip(tangents) {
                if let Some(tangent) = tangent {
                    self.ball_of[*t as usize] = self.mesh.push(tangent);
                }
            }
        }
        for (t, neighbors) in self.delaunay.neighbors.iter().enumerate() {
            for &n in neighbors {
                let own = self.ball_of[t];
                if n != NONE && t < n as usize && own != NONE && self.ball_of[n as usize] != NONE {
                    self.mesh.draft.edges.push([own, self.ball_of[n as usize]]);
                }
            }
        }
        Ok(())
    }

    /// The ball of a tetrahedron whose circumcentre is inside the solid, and inside the bounds of the samples.
    fn ball_in(&self, tetrahedron: u32, points: &[Point], bounds: &Bounds) -> Option<Tangent> {
        let corners = self.delaunay.tetrahedra[tetrahedron as usize];
        if corners.iter().any(|&v| v as usize >= self.samples.len()) {
            return None;
        }
        let ball = circumsphere(corners.map(|v| points[v as usize]))?;
        let around = corners.map(|v| self.samples[v as usize]);
        let inside = || match vote(&ball, around) {
            Some(inside) => inside,
            None => self.faces.tree.winding(ball.center) > INSIDE,
        };
        let is_in = bounds.distance_sq(ball.center) <= 0.0 && inside();
        is_in.then(|| self.settle(ball, corners))?
    }

    /// The ball of four samples, tangent to their faces if that can be; `None` where it is far from touching
    /// the surface.
    fn settle(&self, ball: Ball, corners: [u32; 4]) -> Option<Tangent> {
        let around = corners.map(|v| self.samples[v as usize]);
        let distances = corners.map(|v| self.distances[v as usize]);
        let reach = TANGENT_REACH * distances.into_iter().fold(0.0, f64::max);
        let mut triangles = around.map(|s| s.triangle).to_vec();
        if let Some(tangent) = self.faces.tangent(ball, &triangles, reach) {
            return Some(tangent);
        }
        // Samples of one plane leave the sphere free: its centre may be on the surface.
        let tree = self.faces.tree;
        let (nearest, triangle) = tree.closest_triangle(ball.center, ABOUT * ball.radius);
        let radius = (nearest - ball.center).length();
        let inward = direction(ball.center - nearest);
        let grown = shrink_from(tree, nearest, inward, radius + reach);
        let near = radius > 0.0 && (grown.center - ball.center).length() < reach;
        if near && tree.winding(grown.center) > INSIDE {
            // Beyond the medial axis the nearest face is the other that the grown ball touches.
            let step = BEYOND * grown.radius;
            let reached = ABOUT * (grown.radius + step);
            let beyond = tree.closest_triangle(grown.center + inward * step, reached);
            let both = [triangle, beyond.1].map(|t| tree.given(t));
            triangles.extend(both);
            let tangent = self.faces.tangent(grown, &triangles, reach);
            // The samples may be of more faces than a ball touches.
            let tangent = tangent.or_else(|| self.faces.tangent(grown, &both, reach));
            if tangent.is_some() {
                return tangent;
            }
        }
        if radius < TRUE_RADIUS * ball.radius {
            return None;
        }
        let ball = Ball { radius, ..ball };
        let plane = |s: &Sample| {
            let normal = direction(s.point - ball.center);
            TangentPlane {
                normal,
                point: ball.center + normal * radius,
            }
        };
        triangles.truncate(4);
        Some(Tangent {
            ball,
            planes: around.iter().map(plane).collect(),
            triangles,
        })
    }

    fn add_polygons(&mut self, watch: &mut Watch) -> Result<(), BuildError> {
        let points = self.samples.len() + 8;
        let mut buried = buried(points, &self.delaunay, &self.ball_of);
        for t in 0..self.delaunay.tetrahedra.len() {
            if t % 1024 == 0 {
                watch.at(1.0)?;
            }
            let corners = self.delaunay.tetrahedra[t];
            for (i, j) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
                let (a, b) = (corners[i], corners[j]);
                if a.max(b) as usize >= self.samples.len() {
                    continue;
                }
                let Some(ring) = self.ring(t as u32, [a, b]) else {
                    continue;
                };
                let balls = || ring.iter().map(|step| self.ball_of[step.cell as usize]);
                if balls().any(|ball| ball == NONE) {
                    self.add_clipped([a, b], &ring);
                    continue;
                }
                let [at_a, at_b] = [a, b].map(|v| buried[v as usize]);
                if at_a != at_b {
                    // Left open, the ring joins the one's void to what is around the other.
                    (buried[a as usize], buried[b as usize]) = (false, false);
                } else if ring.len() >= 3 {
                    let polygon: Vec<u32> = balls().collect();
                    self.fan(&polygon, 0);
                }
            }
        }
        Ok(())
    }

    /// The tetrahedra around the Delaunay edge `ab`, in order, if `first` has the smallest index.
    fn ring(&self, first: u32, [a, b]: [u32; 2]) -> Option<Vec<Step>> {
        let others = |cell: u32| self.delaunay.tetrahedra[cell as usize].into_iter();
        let mut leave = others(first).find(|&v| v != a && v != b)?;
        let mut cell = first;
        let mut ring = Vec::new();
        loop {
            let corners = self.delaunay.tetrahedra[cell as usize];
            let across = corners.iter().position(|&v| v == leave)?;
            let next = self.delaunay.neighbors[cell as usize][across];
            let third = others(cell).find(|&v| v != a && v != b && v != leave)?;
            if next == NONE || next < first || ring.len() >= LONGEST_RING {
                return None;
            }
            ring.push(Step { cell, third });
            if next == first {
                return Some(ring);
            }
            // It is of the next cell, too, and lies across from where that is left.
            (leave, cell) = (third, next);
        }
    }

    /// The polygon of a ring that leaves the solid once, closed by its two ends on the crease.
    fn add_clipped(&mut self, ab: [u32; 2], ring: &[Step]) {
        let [a, b] = ab.map(|v| self.samples[v as usize]);
        let [group_a, group_b] = [a, b].map(|s| self.group(&s));
        if self.faces.creases.between(group_a, group_b).is_empty() {
            return;
        }
        if group_a == group_b && a.normal.dot(b.normal) > FADING {
            return;
        }
        let n = ring.len();
        let ball = |k: usize| self.ball_of[ring[k % n].cell as usize];
        let mut starts = (0..n).filter(|&k| ball(k) != NONE && ball(k + n - 1) == NONE);
        let (Some(start), None) = (starts.next(), starts.next()) else {
            return;
        };
        let mut polygon: Vec<u32> = (start..).map(ball).take_while(|&v| v != NONE).collect();
        let run = polygon.len();
        let [before, after] = [start + n - 1, start + run - 1].map(|k| ring[k % n].third);
        let (Some(last), Some(first)) = (self.end(ab, after), self.end(ab, before)) else {
            return;
        };
        polygon.push(last);
        if first != last {
            polygon.push(first);
        }
        for k in 0..polygon.len() {
            let edge = [polygon[k], polygon[(k + 1) % polygon.len()]];
            self.mesh.draft.edges.push(edge);
        }
        self.fan(&polygon, run);
    }

    /// Cuts a polygon into triangles from one of its corners.
    fn fan(&mut self, polygon: &[u32], from: usize) {
        let n = polygon.len();
        for k in 1..n.saturating_sub(1) {
            let [a, b, c] = [from, from + k, from + k + 1].map(|i| polygon[i % n]);
            if a != b && b != c && c != a {
                self.mesh.draft.faces.push([a, b, c]);
            }
        }
    }

    pub(crate) fn group(&self, sample: &Sample) -> u32 {
        self.faces.creases.group[sample.triangle as usize]
    }
}

/// A tetrahedron around a Delaunay edge, and the sample off the edge of the face to the next one.
struct Step {
    cell: u32,
    third: u32,
}
