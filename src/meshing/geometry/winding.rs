//! How often the triangles of a tree wind round a point.
//!
//! A closed surface winds a whole number of times: as often as a ray from the point leaves it, less the times that it
//! enters. Any other winds as solid angles say: Jacobson et al., "Robust Inside-Outside Segmentation using Generalized
//! Winding Numbers" (2013), with the far field of Barill et al., "Fast Winding Numbers for Soups and Clouds" (2018):
//! seen from afar, a group of triangles is one dipole at its centroid, whose moment is the sum of its area vectors.

use crate::meshing::geometry::bounds::{Bounds, Point};
use crate::meshing::geometry::triangle::solid_angle_of;
use crate::meshing::geometry::triangle_tree::TriangleTree;

/// Winding number from which a point is inside matter: half of that within a closed surface.
pub const INSIDE: f64 = 0.5;

/// A group is seen as a dipole from beyond this many of its radii. The error of the winding number
/// is then below 0.05 on the models measured, and a ball is labelled by whether it exceeds ½.
const DIPOLE_DISTANCE: f64 = 2.3;

/// Direction of rays: along no axis or diagonal, so that few meet an edge. Its coordinates are positive.
const RAY: Point = Point {
    x: 0.532_614_907,
    y: 0.641_873_335,
    z: 0.551_670_129,
};

/// Rounding of the volume that three ways of up to twice the longest side span (longest side 1); of shorter ones in
/// units of the product of their lengths.
const ROUNDING: f64 = 1e-14;

/// Distance beside a box at which a ray still counts as meeting it, because of rounding (longest side 1).
const SLACK: f64 = 1e-12;

impl TriangleTree {
    /// How often the surface winds round `p`: 1 inside a closed outward surface, 0 outside, about the share of
    /// directions that hit it where it is open.
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
            let far = DIPOLE_DISTANCE * node.dipole.radius;
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

    /// How often a closed surface winds round `p`, from what a ray crosses; `None` where the ray passes through an
    /// edge, or `p` is on a triangle, to within rounding.
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

/// 1 where the ray from `p` passes through a triangle from behind, −1 where it does from the front, 0 where it misses
/// it; `None` where rounding would decide.
fn crossing(p: Point, corners: &[Point; 3]) -> Option<i32> {
    let [a, b, c] = corners.map(|corner| corner - p);
    // Volumes that the ray spans with the ways to both ends of each side: of one sign where it passes between them.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::BuildError;
    use crate::meshing::geometry::closed::closes;
    use crate::meshing::geometry::random::Random;
    use crate::meshing::options::Progress;
    use crate::meshing::watch::Watch;
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

        /// The solid's triangles, outward.
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
            let boxes = [(); 5].map(|()| Turned::random(&mut random));
            let triangles: Vec<_> = boxes.iter().flat_map(|b| b.triangles()).collect();
            let mut tree = tree(&triangles);
            assert!(tree.is_closed);
            // The fourth is a void, and the last does not count.
            let counts = [1, 1, 1, -1, 0];
            with_watch(|watch| tree.recount(|t| counts[t as usize / 12], watch));
            assert!(tree.is_closed);
            for k in 0..500 {
                if k == 250 {
                    tree.turn();
                }
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
                let all = inside.iter().zip(counts);
                let known: i32 = all.map(|(inside, count)| inside * i32::from(count)).sum();
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
