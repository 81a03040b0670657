//! How long one direction keeps two convex pieces apart on the paths that rigid motion moves their spheres on, for
//! [`super::convex_pieces`]. Chords, as in [`super::apart`], bound long spans better; this bounds short ones, at the
//! end of which two pieces meet.

use super::primitive_tree::PrimitiveTree;
use crate::math::lane::Vec3;
use crate::math::motion::RigidMotion;
use crate::medial::MedialSphere;

/// End of a sphere along a unit direction while it moves on its path: its place, its rate, and the largest
/// acceleration.
#[derive(Clone, Copy)]
pub(super) struct PathEnd {
    pub(super) place: f64,
    pub(super) rate: f64,
    pub(super) acceleration: f64,
}

/// How long a direction keeps the spheres of one hull farther than `least` beyond those of another on their paths;
/// `None` if as long as is asked. A sphere is never farther from where its rate leads than half its acceleration times
/// the square of the time.
pub(super) fn held_on_paths([far, near]: [&[PathEnd]; 2], least: f64, asked: f64) -> Option<f64> {
    let most = |ends: &[PathEnd]| ends.iter().map(|e| e.acceleration).fold(0.0, f64::max);
    let acceleration = most(far) + most(near);
    let mut held = asked;
    for a in far {
        for b in near {
            let room = b.place - a.place - least;
            if room <= 0.0 {
                return Some(0.0);
            }
            let closing = a.rate - b.rate;
            if (closing + 0.5 * acceleration * held) * held <= room {
                continue;
            }
            let root = (closing * closing + 2.0 * acceleration * room).sqrt();
            held = 2.0 * room / (closing + root);
        }
    }
    // Rounding of the root and the division.
    (held < asked).then_some(held * (1.0 - 16.0 * f64::EPSILON))
}

/// Ends along a unit direction of the spheres that a node holds, at a time, on their far side (`side` 1) or near side
/// (-1).
pub(super) fn path_ends(
    body: &impl PrimitiveTree,
    motion: &RigidMotion<f64>,
    node: u32,
    (n, side): (Vec3<f64>, f64),
    time: f64,
) -> Vec<PathEnd> {
    let turned = motion.sin_cos(time);
    let end = |s: &MedialSphere| {
        let path = motion.point(Vec3::from_vector(s.center));
        let at = path.at(time, turned);
        PathEnd {
            place: n.dot(at.position) + side * f64::from(s.radius),
            rate: n.dot(at.velocity),
            acceleration: path.acceleration,
        }
    };
    match body.convex_piece(node) {
        Some(piece) => piece.spheres.iter().map(end).collect(),
        None => {
            let (spheres, len) = body.hull(node);
            spheres[..len].iter().map(end).collect()
        }
    }
}
