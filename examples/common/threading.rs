//! Whether a line runs through a loop: the planted truth of rings on hooks and of chains.

use nalgebra::Vector3;
use rapier3d::prelude::{Pose, Vector};

type V = Vector3<f64>;

/// Points of a body at a pose, in double precision.
pub fn placed(points: &[Vector], pose: &Pose) -> Vec<V> {
    let world = |p: &Vector| pose.transform_point(*p).as_dvec3().to_array();
    points.iter().map(|p| V::from(world(p))).collect()
}

/// How many bodies the line runs through, where `rim` is a loop of each.
pub fn threaded(line: &[V], rim: &[Vector], bodies: &[Pose]) -> usize {
    let through = |pose: &&Pose| passes(line, &placed(rim, pose)) != 0;
    bodies.iter().filter(through).count()
}

/// How often the line from point to point runs through the loop, from below less from above. For a
/// closed line (its first point repeated as its last) it is the linking number of the two.
///
/// The loop is a convex planar polygon: a piece of the line is through it where its ends are on
/// both sides of the plane and it meets the plane inside of all edges.
pub fn passes(line: &[V], rim: &[V]) -> i32 {
    let center = rim.iter().sum::<V>() / rim.len() as f64;
    let edges = || (0..rim.len()).map(|i| (rim[i], rim[(i + 1) % rim.len()]));
    let twice_area = |(a, b): (V, V)| (a - center).cross(&(b - center));
    let normal = edges().map(twice_area).sum::<V>();
    let through = |pair: &[V]| {
        let [from, to] = [pair[0], pair[1]].map(|p| normal.dot(&(p - center)));
        if (from > 0.0) == (to > 0.0) {
            return 0;
        }
        let p = pair[0] + (pair[1] - pair[0]) * (from / (from - to));
        let inside = |(a, b): (V, V)| (b - a).cross(&(p - a)).dot(&normal) > 0.0;
        match edges().all(inside) {
            true if to > 0.0 => 1,
            true => -1,
            false => 0,
        }
    };
    line.windows(2).map(through).sum()
}
