//! Linking numbers of closed loops: they change whenever one passes through another (Gauss; here by counting the
//! signed crossings of a projection).

use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

pub type Loop = Vec<[f64; 3]>;

/// Centre line of a loop at a pose.
pub fn line(mesh: &MedialMesh, pose: &Pose) -> Loop {
    let world = |s: &MedialSphere| (*pose * s.center).to_array().map(f64::from);
    mesh.spheres().iter().map(world).collect()
}

/// Linking number of two polygons: half the signed crossings seen along a direction that no edge has.
pub fn linking(a: &Loop, b: &Loop) -> i32 {
    // A fixed rotation, so that no edge is seen end on.
    let seen = |p: &[f64; 3]| {
        let [x, y, z] = *p;
        [
            0.8 * x + 0.33 * y + 0.5 * z,
            -0.41 * x + 0.91 * y + 0.06 * z,
            -0.44 * x - 0.25 * y + 0.86 * z,
        ]
    };
    let edges = |l: &Loop| {
        let points: Vec<_> = l.iter().map(seen).collect();
        let next = |i: usize| points[(i + 1) % points.len()];
        (0..points.len())
            .map(|i| [points[i], next(i)])
            .collect::<Vec<_>>()
    };
    let mut sum = 0;
    for [p, q] in edges(a) {
        for [r, s] in edges(b) {
            let (d, e) = ([q[0] - p[0], q[1] - p[1]], [s[0] - r[0], s[1] - r[1]]);
            let cross = d[0] * e[1] - d[1] * e[0];
            let w = [r[0] - p[0], r[1] - p[1]];
            let (t, u) = (
                (w[0] * e[1] - w[1] * e[0]) / cross,
                (w[0] * d[1] - w[1] * d[0]) / cross,
            );
            if (0.0..1.0).contains(&t) && (0.0..1.0).contains(&u) {
                let above = p[2] + t * (q[2] - p[2]) > r[2] + u * (s[2] - r[2]);
                sum += if (cross > 0.0) == above { 1 } else { -1 };
            }
        }
    }
    sum / 2
}
