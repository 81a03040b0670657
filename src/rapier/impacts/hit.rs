//! [`Hit`]: the first contact of a pair of colliders within the step, as far as its impact needs it.

use crate::elementary::{Toi, ToiStatus};
use crate::math::{Real, Vector};
use crate::pair::met::Met;

/// First contact of two colliders.
#[derive(Clone, Debug)]
pub struct Hit {
    /// Seconds into the step, at the contact's lower bound.
    pub time: Real,
    /// Unit normal from the first to the second, zero where unknown.
    pub normal: Vector,
    /// Where it acts, world frame, unless faces met ([`crate::rapier::impacts::center_of_pressure`]): the middle of the
    /// nearest points.
    pub point: Vector,
    /// Depth below the surfaces, a length; < 0 above them.
    pub depth: Real,
    /// The primitives that meet; 0 of a shape that is not medial.
    pub primitives: [u32; 2],
    /// The points or features that meet, where they are known.
    pub met: Option<Met>,
}

impl Hit {
    /// The hit of a query over `seconds` from `time` on, with what met, where that is known; `None` if it found none.
    pub fn of(toi: &Toi, met: Option<Met>, time: Real, seconds: Real) -> Option<Self> {
        (toi.status != ToiStatus::Separated).then(|| Self {
            time: time + toi.lower * seconds,
            normal: toi.normal,
            point: (toi.points[0] + toi.points[1]) * 0.5,
            depth: (toi.points[0] - toi.points[1]).dot(toi.normal),
            primitives: toi.primitives,
            met,
        })
    }
}
