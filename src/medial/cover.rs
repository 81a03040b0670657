//! Depth of points in the primitives around a sheet of the envelope.

use super::exact::{Ball, balls, nearest_to_point};
use super::mesh::MedialMesh;
use super::sheet::Sheet;
use crate::math::lane::Vec3;

/// A primitive that may hide points, with its box.
pub(super) struct Cover {
    balls: [Ball; 3],
    lo: Vec3<f64>,
    hi: Vec3<f64>,
    /// Spheres of the primitive.
    pub vertices: [u32; 3],
    /// Index of the primitive.
    pub index: u32,
}

impl Cover {
    /// With a box widened by `margin`.
    pub fn new(mesh: &MedialMesh, index: u32, margin: Vec3<f64>) -> Self {
        let balls = balls(&mesh.primitive(index as usize));
        let [a, b, c] = balls.map(|b| Sheet::Ball(b).bounds());
        let least =
            |a: Vec3<f64>, b: Vec3<f64>| Vec3::new(a.x.min(b.x), a.y.min(b.y), a.z.min(b.z));
        let most = |a: Vec3<f64>, b: Vec3<f64>| Vec3::new(a.x.max(b.x), a.y.max(b.y), a.z.max(b.z));
        Self {
            balls,
            lo: least(least(a[0], b[0]), c[0]) - margin,
            hi: most(most(a[1], b[1]), c[1]) + margin,
            vertices: mesh.simplices()[index as usize].vertices,
            index,
        }
    }

    /// Depth of a point in the primitive, with the outward normal there; `None` far outside.
    pub fn depth(&self, p: Vec3<f64>) -> Option<(f64, Vec3<f64>)> {
        let (lo, hi) = (self.lo, self.hi);
        let within = (lo.x <= p.x && p.x <= hi.x)
            && (lo.y <= p.y && p.y <= hi.y)
            && (lo.z <= p.z && p.z <= hi.z);
        within.then(|| {
            let nearest = nearest_to_point(&self.balls, p);
            (-nearest.distance, nearest.y * (-1.0 / nearest.length))
        })
    }
}

/// What hides a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hidden {
    /// Position in `Trimmer::covers`.
    pub cover: usize,
    /// All within this distance of the point is hidden, too.
    pub depth: f64,
}
