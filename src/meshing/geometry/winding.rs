//! How often the triangles of a tree wind round a point.
//!
//! A closed surface winds a whole number of times: as often as a ray from the point leaves it, less the times that it
//! enters. Any other winds as solid angles say: Jacobson et al., "Robust Inside-Outside Segmentation using Generalized
//! Winding Numbers" (2013), with the far field of Barill et al., "Fast Winding Numbers for Soups and Clouds" (2018):
//! seen from afar, a group of triangles is one dipole at its centroid, whose moment is the sum of its area vectors.

use crate::error::BuildError;
use crate::meshing::geometry::bounds::{Bounds, Point};
use crate::meshing::geometry::triangle::solid_angle_of;
use crate::meshing::geometry::triangle_tree::TriangleTree;
use crate::meshing::watch::Watch;

/// A group is seen as a dipole from beyond this many of its radii. The error of the winding number
/// is then below 0.05 on the models measured, and a ball is labelled by whether it exceeds ½.
const FAR: f64 = 2.3;

/// Direction of rays: along no axis or diagonal, so that few meet an edge. Its coordinates are positive.
const RAY: Point = Point {
    x: 0.532_614_907,
    y: 0.641_873_335,
    z: 0.551_670_129,
};

/// Rounding of a product of three coordinates of a point against another (longest side 1).
const ROUNDING: f64 = 1e-14;

/// Distance by which a ray that misses a box may seem to meet it, or the other way round (longest side 1).
const SLACK: f64 = 1e-12;

impl TriangleTree {
    /// How often the surface winds round `p`: 1 inside a closed outward surface, 0 outside, about the share of directions
    /// that hit it where it is open.
    pub fn winding(&self, p: Point) -> f64 {
        self.winding_counted(p, &mut 0)
    }

    /// Does the same as [`Self::winding`]; adds 1 to `work`, and the number of triangles that were near enough to be
    /// looked at.
    pub fn winding_counted(&self, p: Point, work: &mut usize) -> f64 {
        *work += 1;
        let by_ray = self.is_closed.then(|| self.crossings(p, work)).flatten();
        by_ray.map_or_else(|| self.by_solid_angles(p, work), f64::from)
    }

    /// How often the surface winds round `p`, from the solid angles of its triangles.
    fn by_solid_angles(&self, p: Point, work: &mut usize) -> f64 {
        let mut solid_angle = 0.0;
        // Halving keeps the depth below 32, and each level leaves one node waiting.
        let mut stack = [0u32; 64];
        let mut len = 1;
        while len > 0 {
            len -= 1;
            let node = &self.nodes[stack[len] as usize];
            let to = node.dipole.center - p;
            let distance_sq = to.length_sq();
            let far = FAR * node.dipole.radius;
            if distance_sq > far * far {
                solid_angle += to.dot(node.dipole.moment) / (distance_sq * distance_sq.sqrt());
                continue;
            }
            let first = node.first as usize;
            if node.count > 0 {
                *work += node.count as usize;
                for i in first..first + node.count as usize {
                    if self.counts[i] != 0 {
                        let angle = solid_angle_of(p, &self.nearest.corners()[i]);
                        solid_angle += f64::from(self.counts[i]) * angle;
                    }
                }
            } else {
                stack[len] = first as u32;
                stack[len + 1] = first as u32 + 1;
                len += 2;
            }
        }
        solid_angle / (4.0 * std::f64::consts::PI)
    }

    /// How often a closed surface winds round `p`, from what a ray crosses; `None` where it passes an edge, or `p` is on
    /// a triangle, to within rounding.
    fn crossings(&self, p: Point, work: &mut usize) -> Option<i32> {
        let mut times = 0;
        let mut stack = [0u32; 64];
        let mut len = 1;
        while len > 0 {
            len -= 1;
            let node = &self.nodes[stack[len] as usize];
            if !meets(p, &node.bounds) {
                continue;
            }
            let first = node.first as usize;
            if node.count > 0 {
                *work += node.count as usize;
                for i in first..first + node.count as usize {
                    if self.counts[i] != 0 {
                        let crossing = crossing(p, &self.nearest.corners()[i])?;
                        times += i32::from(self.counts[i]) * crossing;
                    }
                }
            } else {
                stack[len] = first as u32;
                stack[len + 1] = first as u32 + 1;
                len += 2;
            }
        }
        Some(times)
    }
}

/// Whether the ray from `p` meets a box.
fn meets(p: Point, bounds: &Bounds) -> bool {
    let [enters, leaves] = [bounds.lo - p, bounds.hi - p].map(|to| {
        let along = Point::new(to.x / RAY.x, to.y / RAY.y, to.z / RAY.z);
        [
            along.x.max(along.y).max(along.z),
            along.x.min(along.y).min(along.z),
        ]
    });
    enters[0].max(0.0) <= leaves[1] + SLACK
}

/// 1 where the ray from `p` leaves through a triangle, that is from behind it, −1 where it enters, 0 where it passes it;
/// `None` where rounding would decide.
fn crossing(p: Point, corners: &[Point; 3]) -> Option<i32> {
    let [a, b, c] = corners.map(|corner| corner - p);
    // Volumes of the ray and each side.
    let sides = [b.cross(c), c.cross(a), a.cross(b)].map(|area| RAY.dot(area));
    let [least, most] = [
        sides.into_iter().fold(f64::MAX, f64::min),
        sides.into_iter().fold(f64::MIN, f64::max),
    ];
    if least < -ROUNDING && most > ROUNDING {
        return Some(0);
    }
    if least <= ROUNDING && most >= -ROUNDING {
        return None;
    }
    let (ab, ac) = (b - a, c - a);
    let height = a.dot(ab.cross(ac));
    if height.abs() <= ROUNDING * a.length() * ab.length() * ac.length() {
        return None;
    }
    let leaves = least > 0.0;
    Some(match (leaves, height > 0.0) {
        (true, true) => 1,
        (false, false) => -1,
        _ => 0,
    })
}

/// Whether triangles close a surface, each as often as it counts: whether each edge is passed as often one way as the
/// other. Told by the sum of numbers that the edges have by their places, positive one way and negative the other: of a
/// surface with a border it is 0 in one of 2⁶⁴ cases.
pub(super) fn closes(
    triangles: &[[Point; 3]],
    counts: &[i8],
    watch: &mut Watch,
) -> Result<bool, BuildError> {
    let mut sum = 0u64;
    for (i, (corners, &count)) in triangles.iter().zip(counts).enumerate() {
        watch.every(i)?;
        let [a, b, c] = corners.map(number);
        for [from, to] in [[a, b], [b, c], [c, a]] {
            let edge = mixed(from.min(to) ^ mixed(from.max(to)));
            let times = if from < to { count } else { -count };
            sum = sum.wrapping_add(edge.wrapping_mul(i64::from(times) as u64));
        }
    }
    Ok(sum == 0)
}

/// A number for a place.
fn number(p: Point) -> u64 {
    // Of 0 and −0 the same.
    let bits = |x: f64| (x + 0.0).to_bits();
    mixed(bits(p.x) ^ mixed(bits(p.y) ^ mixed(bits(p.z))))
}

/// Spreads the bits of a number (Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators", 2014).
fn mixed(bits: u64) -> u64 {
    let bits = bits.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshing::geometry::random::Random;
    use crate::meshing::options::Progress;
    use std::ops::ControlFlow;

    /// A box, turned about the z axis.
    #[derive(Clone, Copy)]
    struct Turned {
        center: Point,
        half: Point,
        angle: f64,
    }

    impl Turned {
        fn random(random: &mut Random) -> Self {
            let mut within = |lo: f64, hi: f64| lo + (hi - lo) * random.unit();
            let mut point = |lo, hi| Point::new(within(lo, hi), within(lo, hi), within(lo, hi));
            let (center, half) = (point(-0.2, 0.2), point(0.05, 0.3));
            let angle = within(0.0, 1.5);
            Self {
                center,
                half,
                angle,
            }
        }

        /// Its triangles, outward.
        fn triangles(self) -> Vec<[Point; 3]> {
            let (sin, cos) = self.angle.sin_cos();
            let corner = |k: usize| {
                let sign = |bit: usize| if k & bit == 0 { -1.0 } else { 1.0 };
                let half = self.half;
                let p = Point::new(sign(1) * half.x, sign(2) * half.y, sign(4) * half.z);
                self.center + Point::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y, p.z)
            };
            let sides = [
                [0, 2, 3, 1],
                [4, 5, 7, 6],
                [0, 1, 5, 4],
                [2, 6, 7, 3],
                [0, 4, 6, 2],
                [1, 3, 7, 5],
            ];
            let halves = |[a, b, c, d]: [usize; 4]| [[a, b, c], [a, c, d]];
            let triangles = sides.into_iter().flat_map(halves);
            triangles.map(|t| t.map(corner)).collect()
        }

        /// How far a point is inside, along the axis along which it is least.
        fn depth(self, p: Point) -> f64 {
            let (sin, cos) = self.angle.sin_cos();
            let to = p - self.center;
            let own = Point::new(cos * to.x + sin * to.y, cos * to.y - sin * to.x, to.z);
            let [x, y, z] = [own.x, own.y, own.z].map(f64::abs);
            (self.half.x - x).min(self.half.y - y).min(self.half.z - z)
        }
    }

    fn with_watch<T>(run: impl FnOnce(&mut Watch) -> Result<T, BuildError>) -> T {
        let mut go_on = |_: Progress| ControlFlow::Continue(());
        run(&mut Watch::new(&mut go_on)).expect("nothing stops it")
    }

    fn tree(triangles: &[[Point; 3]]) -> TriangleTree {
        with_watch(|watch| TriangleTree::new(triangles.len(), |i| triangles[i], watch))
    }

    #[test]
    fn boxes_that_overlap_wind_as_often_as_there_are_boxes_around_a_point() {
        let mut random = Random::new(7);
        let mut by_ray = 0;
        for _ in 0..40 {
            let boxes = [(); 4].map(|()| Turned::random(&mut random));
            // The last is a void.
            let mut triangles: Vec<_> = boxes.iter().flat_map(|b| b.triangles()).collect();
            let void = triangles.len() - 12;
            triangles[void..].iter_mut().for_each(|t| t.swap(1, 2));
            let tree = tree(&triangles);
            assert!(tree.is_closed);
            for k in 0..500 {
                let mut unit = || random.unit() - 0.5;
                let free = Point::new(unit(), unit(), unit());
                // In the plane of a face, or on the height of a corner.
                let p = match k % 3 {
                    0 => Point::new(free.x, free.y, boxes[0].center.z + boxes[0].half.z),
                    1 => Point::new(triangles[0][0].x, free.y, free.z),
                    _ => free,
                };
                let depths = boxes.map(|b| b.depth(p));
                if depths.iter().any(|d| d.abs() < 1e-9) {
                    continue;
                }
                let inside = depths.map(|d| i32::from(d > 0.0));
                let known = inside[0] + inside[1] + inside[2] - inside[3];
                by_ray += usize::from(tree.crossings(p, &mut 0).is_some());
                assert_eq!(tree.winding(p).round() as i32, known, "{p:?}");
            }
        }
        assert!(by_ray > 19_000, "only {by_ray} points were told by a ray");
    }

    #[test]
    fn rays_through_edges_and_corners_leave_it_to_solid_angles() {
        let whole = Turned {
            center: Point::zero(),
            half: Point::new(0.3, 0.2, 0.4),
            angle: 0.3,
        };
        let triangles = whole.triangles();
        let tree = tree(&triangles);
        for [a, b, c] in &triangles {
            for on_border in [*a, (*a + *b) * 0.5, (*b + *c) * 0.5] {
                let before = on_border - RAY * 0.25;
                assert_eq!(tree.crossings(before, &mut 0), None);
                let known = f64::from(whole.depth(before) > 0.0);
                assert!((tree.winding(before) - known).abs() < 0.1);
            }
        }
    }

    #[test]
    fn only_closed_surfaces_close() {
        let closes = |triangles: &[[Point; 3]], counts: &[i8]| {
            with_watch(|watch| closes(triangles, counts, watch))
        };
        let mut random = Random::new(8);
        let mut triangles = Turned::random(&mut random).triangles();
        let first = triangles[0];
        assert!(closes(&triangles, &[1; 12]));
        assert!(closes(&triangles, &[-1; 12]));
        triangles[0].swap(0, 1);
        assert!(!closes(&triangles, &[1; 12]), "one is turned round");
        triangles[0] = [first[0], first[1], first[2] + Point::new(1e-9, 0.0, 0.0)];
        assert!(!closes(&triangles, &[1; 12]), "a corner is torn off");
        triangles.remove(0);
        assert!(!closes(&triangles, &[1; 11]), "one is missing");
        triangles.extend([first, first]);
        assert!(!closes(&triangles, &[1; 13]), "one is there twice");
        let mut counts = [1; 13];
        counts[12] = 0;
        assert!(closes(&triangles, &counts), "and counts once");
    }
}
