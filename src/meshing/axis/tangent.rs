//! Balls made tangent to the faces around them.
//!
//! The circumsphere of four samples touches a smooth surface nearly; a ball of the medial axis
//! touches it. Newton's method on the tangent planes at the nearest points of each face: with outward
//! normals `n` and points `q`, `n·(q − c) = r` for all of them, by least squares of the change
//! (`geometry/quadric.rs`), until the planes no longer move. On flat faces one step is exact.

use crate::meshing::draft::Ball;
use crate::meshing::geometry::bounds::{Point, direction};
use crate::meshing::geometry::quadric::Quadric;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::surface::checked_surface::Surface;
use crate::meshing::surface::creases::SharpEdges;

/// Largest number of steps of Newton's method; a ball that needs more is given up.
const MAX_NEWTON_STEPS: usize = 30;

/// Distance between a ball and each of its planes at which Newton's method has converged (longest side 1).
const CONVERGED: f64 = 1e-10;

/// Largest number of faces that are added to the given ones because a converged ball reached into them.
const MORE_FACES: usize = 5;

/// Depth (longest side 1) by which a converged ball may reach into another face without that face being added. It must
/// be above rounding, or faces that the ball touches anyway would be added.
const TOUCHES: f64 = 1e-7;

/// Depth (longest side 1) by which a ball may reach into another face when no more faces are added; one that
/// reaches deeper is given up.
const REACHES_IN: f64 = 1e-6;

/// Cosine of the angle between the normals of two planes above which they may be one.
const SAME_NORMAL: f64 = 0.9999;

/// Distance (longest side 1) between the points of two planes below which they may be one;
/// [`SAME_POINT_SHARE`] of the ball's radius is added to it.
const SAME_POINT: f64 = 1e-3;

/// Part of that distance that grows with the ball, in units of its radius.
const SAME_POINT_SHARE: f64 = 0.05;

/// A ball touches a face from outside where this is above the cosine of the angle between their normals.
const OUTSIDE_COSINE: f64 = -0.5;

/// A plane that a ball touches: its outward unit normal, and a point of it.
#[derive(Clone, Copy, Debug)]
pub struct TangentPlane {
    /// Outward unit normal.
    pub normal: Point,
    /// A point of the plane; for a ball on a crease the ball itself.
    pub point: Point,
}

/// A ball that touches faces, and where.
pub struct Tangent {
    /// The ball.
    pub ball: Ball,
    /// The planes that it touches.
    pub planes: Vec<TangentPlane>,
    /// A triangle of each.
    pub triangles: Vec<u32>,
}

/// Faces that balls are made tangent to.
pub struct Faces<'a> {
    /// The surface.
    pub surface: &'a Surface,
    /// Tree of the surface.
    pub tree: &'a TriangleTree,
    /// Smooth groups of the surface.
    pub creases: &'a SharpEdges,
}

impl Faces<'_> {
    /// The ball near `start`, its centre within `reach`, that touches the faces of `triangles`; `None` where
    /// there is none, or where all of them are one plane.
    pub fn tangent(&self, start: Ball, triangles: &[u32], reach: f64) -> Option<Tangent> {
        let mut ball = start;
        let mut from = triangles.to_vec();
        let mut added = 0;
        for _ in 0..MAX_NEWTON_STEPS {
            let (planes, triangles) = self.planes(&ball, &mut from);
            if planes.len() < 2 {
                return None;
            }
            let off = |p: &TangentPlane| (p.normal.dot(p.point - ball.center) - ball.radius).abs();
            if planes.iter().map(off).fold(0.0, f64::max) < CONVERGED {
                let clear = ball.radius - TOUCHES;
                if let Some((distance, triangle)) = self.tree.nearest_within(ball.center, clear) {
                    if added < MORE_FACES {
                        from.push(self.tree.given(triangle));
                        added += 1;
                        continue;
                    }
                    if ball.radius - distance > REACHES_IN {
                        return None;
                    }
                }
                return self.is_behind(&planes, &triangles).then_some(Tangent {
                    ball,
                    planes,
                    triangles,
                });
            }
            let mut quadric = Quadric::default();
            for plane in &planes {
                let touched = Ball {
                    center: plane.point,
                    radius: 0.0,
                };
                quadric.add_plane(plane.normal, &touched, 1.0);
            }
            ball = quadric.minimiser(&ball)?;
            if ball.radius <= 0.0 || (ball.center - start.center).length() > reach {
                return None;
            }
        }
        None
    }

    /// Whether a ball that touches planes is behind the faces of `triangles`, as seen from outside, and not before
    /// them in a groove.
    fn is_behind(&self, planes: &[TangentPlane], triangles: &[u32]) -> bool {
        let mut both = planes.iter().zip(triangles);
        both.all(|(plane, &t)| plane.normal.dot(self.surface.normals[t as usize]) > OUTSIDE_COSINE)
    }

    /// The planes of the faces around a ball, each once, and a triangle of each; `from` follows.
    fn planes(&self, ball: &Ball, from: &mut [u32]) -> (Vec<TangentPlane>, Vec<u32>) {
        let (mut planes, mut triangles) = (Vec::<TangentPlane>::new(), Vec::new());
        for t in from {
            let (point, triangle) = self.creases.walk(self.surface, *t, ball.center);
            *t = triangle;
            let to = point - ball.center;
            let normal = match to.length() > 1e-9 {
                true => direction(to),
                false => self.surface.normals[triangle as usize],
            };
            let apart = SAME_POINT + SAME_POINT_SHARE * ball.radius;
            let same = |p: &TangentPlane| {
                p.normal.dot(normal) > SAME_NORMAL && (p.point - point).length() < apart
            };
            if !planes.iter().any(same) {
                planes.push(TangentPlane { normal, point });
                triangles.push(triangle);
            }
        }
        (planes, triangles)
    }
}
