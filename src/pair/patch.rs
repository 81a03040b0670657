//! Where flat faces of two bodies lie on each other: one polygon for each pair of pieces, of which a plane of several
//! triangles, or a body of several blocks, has many. An impact there acts at the middle of all of them, so that a plate
//! that falls flat on one of two triangles and half on the other is struck as on one.

use crate::math::lane::Vec3;

/// Polygons, edges and corners that lie on each other, with their moments.
#[derive(Clone, Copy)]
pub(super) struct Patch {
    /// Number of corners, length of edges, and area, and the integral of the position over each.
    measures: [(f64, Vec3<f64>); 3],
}

impl Patch {
    /// One polygon; two corners are an edge, one is itself. `None` where there are none.
    pub(super) fn of(corners: &[Vec3<f64>]) -> Option<Self> {
        let first = *corners.first()?;
        let mut measures = [(0.0, Vec3::zero()); 3];
        let mut add = |k: usize, measure: f64, middle: Vec3<f64>| {
            measures[k].0 += measure;
            measures[k].1 = measures[k].1 + middle * measure;
        };
        for (k, p) in corners.iter().enumerate() {
            let next = corners[(k + 1) % corners.len()];
            add(0, 1.0, *p);
            add(1, (next - *p).length(), (*p + next) * 0.5);
            let area = 0.5 * (*p - first).cross(next - first).length();
            add(2, area, (first + *p + next) * (1.0 / 3.0));
        }
        Some(Self { measures })
    }

    /// The two patches as one.
    pub(super) fn and(&self, other: &Self) -> Self {
        let both = |k: usize| {
            let ((m, a), (n, b)) = (self.measures[k], other.measures[k]);
            (m + n, a + b)
        };
        Self {
            measures: [both(0), both(1), both(2)],
        }
    }

    /// The middle of the polygons, or of the edges where there are no polygons, or of the corners.
    pub(super) fn middle(&self) -> Vec3<f64> {
        let [corners, edges, areas] = self.measures;
        let (measure, moment) = match (areas.0 > 0.0, edges.0 > 0.0) {
            (true, _) => areas,
            (false, true) => edges,
            (false, false) => corners,
        };
        moment * (1.0 / measure)
    }
}
