//! Points in the order of one coordinate, to find the nearest of them.

use crate::meshing::geometry::bounds::Point;

/// Points, by `x`.
pub struct Cloud(Vec<Point>);

impl Cloud {
    /// Puts points in order.
    pub fn new(mut points: Vec<Point>) -> Self {
        points.sort_unstable_by(|a, b| a.x.total_cmp(&b.x));
        Self(points)
    }

    /// The point nearest to `p`, if one is nearer than `limit`. Adds the number of points that were looked at to `work`.
    pub fn nearer(&self, p: Point, limit: f64, work: &mut u64) -> Option<Point> {
        let (below, above) = self.0.split_at(self.0.partition_point(|q| q.x < p.x));
        let mut best = (limit * limit, None);
        let mut look = |q: &Point| {
            *work += 1;
            let to = *q - p;
            if to.length_sq() < best.0 {
                best = (to.length_sq(), Some(*q));
            }
            to.x * to.x < best.0
        };
        // Each side ends where `x` alone is farther.
        let _ = below.iter().rev().all(&mut look);
        let _ = above.iter().all(&mut look);
        best.1
    }
}
