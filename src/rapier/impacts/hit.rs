//! [`Hit`]: the first contact of a pair of colliders within the step, as far as its impact needs it.

use crate::elementary::{Toi, ToiStatus};
use crate::math::{Real, Vector};
use crate::pair::met::Met;
use crate::pair::patch::{EXTREMES, FaceCorner};

/// First contact of two colliders.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Seconds into the step, at the contact's lower bound.
    pub time: Real,
    /// Unit normal from the first to the second, zero where unknown.
    pub normal: Vector,
    /// Where it acts, world frame: the middle of the nearest points.
    pub point: Vector,
    /// Corners, in the world frame, of faces that lie on each other, if it acts in their hull
    /// ([`crate::rapier::impacts::center_of_pressure`]).
    pub corners: Option<[FaceCorner; EXTREMES]>,
    /// Depth below the surfaces, a length; < 0 above them.
    pub depth: Real,
    /// The primitives that meet; 0 of a shape that is not medial.
    pub primitives: [u32; 2],
    /// The points or features that meet, where they are known.
    pub met: Option<Met>,
}

impl Hit {
    /// Corners of faces that lie on each other, each once, with the speed of approach that is left to it where the step
    /// takes `dt` seconds: those above the lowest may come down to where it is.
    pub fn corners_with_room(&self, dt: Real) -> Vec<(FaceCorner, Real)> {
        let mut corners: Vec<FaceCorner> = Vec::new();
        for corner in self.corners.into_iter().flatten() {
            if !corners.contains(&corner) {
                corners.push(corner);
            }
        }
        let distances = corners.iter().map(|c| c.distance);
        let lowest = distances.fold(Real::MAX, Real::min);
        let with_room = |c: FaceCorner| (c, (c.distance - lowest) / dt);
        corners.into_iter().map(with_room).collect()
    }

    /// The hit of a query over `seconds` from `time` on, with what met and the corners of faces that lie on each other,
    /// where these are known; `None` if it found none.
    pub fn of(
        toi: &Toi,
        (met, corners): (Option<Met>, Option<[FaceCorner; EXTREMES]>),
        time: Real,
        seconds: Real,
    ) -> Option<Self> {
        (toi.status != ToiStatus::Separated).then(|| Self {
            time: time + toi.lower * seconds,
            normal: toi.normal,
            point: (toi.points[0] + toi.points[1]) * 0.5,
            corners,
            depth: (toi.points[0] - toi.points[1]).dot(toi.normal),
            primitives: toi.primitives,
            met,
        })
    }
}
