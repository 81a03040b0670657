//! Ends of Voronoi polygons that run out of the solid: balls of radius 0, on a convex crease or at a corner.

use crate::meshing::axis::clip::Clipper;
use crate::meshing::axis::tangent::{Tangent, TangentPlane};
use crate::meshing::draft::Ball;
use crate::meshing::geometry::bounds::Point;
use crate::meshing::surface::samples::Sample;

/// A polygon ends on a crease within this many distances between samples.
const CLIP_REACH: f64 = 2.0;

/// Cosine of the angle between normals that count as one.
const SAME_PLANE: f64 = 0.9999;

impl Clipper<'_> {
    /// The ball of radius 0 at which the Voronoi edge of the samples `ab` and `third` ends.
    pub(crate) fn end(&mut self, ab: [u32; 2], third: u32) -> Option<u32> {
        let mut key = [ab[0], ab[1], third];
        key.sort_unstable();
        if let Some(&known) = self.ends.get(&key) {
            return known;
        }
        let third = self.samples.get(third as usize).copied();
        let end = self
            .corner_end(ab, third)
            .or_else(|| self.crease_end(ab, third));
        self.ends.insert(key, end);
        end
    }

    fn clip_reach(&self, ab: [u32; 2]) -> f64 {
        let [a, b] = ab.map(|v| self.samples[v as usize].point);
        let [of_a, of_b] = ab.map(|v| self.distances[v as usize]);
        CLIP_REACH * of_a.max(of_b).max((a - b).length())
    }

    /// The corner of the surface nearest to the place where samples of three groups meet.
    fn corner_end(&mut self, ab: [u32; 2], third: Option<Sample>) -> Option<u32> {
        let [a, b] = ab.map(|v| &self.samples[v as usize]);
        let mut groups: Vec<u32> = [*a, *b]
            .iter()
            .chain(&third)
            .map(|s| self.group(s))
            .collect();
        groups.sort_unstable();
        groups.dedup();
        if groups.len() < 3 {
            return None;
        }
        let middle = (a.point + b.point) * 0.5;
        let at = |v: u32| self.faces.surface.vertices[v as usize];
        let corners = self.faces.creases.corners_at(&groups);
        let (distance, vertex) = corners
            .map(|v| ((at(v) - middle).length(), v))
            .min_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)))?;
        (distance < self.clip_reach(ab)).then(|| self.corner_ball(vertex))
    }

    /// The point of the crease between the groups of `ab` that is nearest to the samples.
    fn crease_end(&mut self, ab: [u32; 2], third: Option<Sample>) -> Option<u32> {
        let (surface, creases) = (self.faces.surface, self.faces.creases);
        let [a, b] = ab.map(|v| &self.samples[v as usize]);
        let [group_a, group_b] = [a, b].map(|s| self.group(s));
        let middle = |x: Point, y: Point| (x + y) * 0.5;
        // The side of the crease that has two of the samples counts once.
        let near = match third.map(|s| (self.group(&s), s.point)) {
            Some((group, p)) if group == group_a => middle(middle(a.point, p), b.point),
            Some((group, p)) if group == group_b => middle(middle(b.point, p), a.point),
            _ => middle(a.point, b.point),
        };
        let mut best = (self.clip_reach(ab), None);
        for &i in creases.between(group_a, group_b) {
            let edge = &creases.convex[i as usize];
            let [p, q] = edge.vertices.map(|v| surface.vertices[v as usize]);
            let way = q - p;
            let t = ((near - p).dot(way) / way.length_sq()).clamp(0.0, 1.0);
            let point = p + way * t;
            let distance = (point - near).length();
            if distance < best.0 {
                best = (distance, Some((point, edge)));
            }
        }
        let (point, edge) = best.1?;
        let is_at = |&v: &u32| creases.is_corner(v) && surface.vertices[v as usize] == point;
        if let Some(corner) = edge.vertices.into_iter().find(is_at) {
            return Some(self.corner_ball(corner));
        }
        Some(self.push_end(point, edge.triangles.to_vec()))
    }

    /// The ball of radius 0 at a corner.
    fn corner_ball(&mut self, vertex: u32) -> u32 {
        if let Some(&known) = self.corner_balls.get(&vertex) {
            return known;
        }
        let at_it = self.faces.creases.convex_at(vertex);
        let triangles = at_it.flat_map(|edge| edge.triangles).collect();
        let ball = self.push_end(self.faces.surface.vertices[vertex as usize], triangles);
        self.corner_balls.insert(vertex, ball);
        ball
    }

    /// A ball of radius 0 that touches the planes of triangles.
    fn push_end(&mut self, center: Point, triangles: Vec<u32>) -> u32 {
        let mut normals: Vec<Point> = Vec::new();
        for &t in &triangles {
            let normal = self.faces.surface.normals[t as usize];
            if !normals.iter().any(|n| n.dot(normal) > SAME_PLANE) {
                normals.push(normal);
            }
        }
        let plane = |normal: Point| TangentPlane {
            normal,
            point: center,
        };
        self.mesh.push(Tangent {
            ball: Ball {
                center,
                radius: 0.0,
            },
            planes: normals.into_iter().map(plane).collect(),
            triangles,
        })
    }
}
