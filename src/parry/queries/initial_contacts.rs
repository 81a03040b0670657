//! Start of a shape cast whose bodies touch already, or are within the target distance: which of these contacts count
//! as hits, and how near other places may come.
//!
//! - In straight motion the distance of two primitives is convex in time: if they do not come nearer at once, they
//!   never do. So each pair of primitives that comes nearer is a hit at time 0, and one that does not is none.
//!   Pairs that start farther apart are hit at the target distance. parry treats the parts of a compound in the
//!   same way. Of two convex bodies the deepest contact alone counts, where it is sure: if it does not come nearer,
//!   nothing is hit.
//! - In turning motion, bodies that touch may stay as deep in each other as they are, and get deeper by the speed
//!   at which their deepest contact closes. No other place may get deeper than that: so the next facet of a floor
//!   stops nobody, and a wall stops everybody. And no place may get deeper than half way to the medial axes there,
//!   so a thin part of a thick body may sink in only in proportion to how thin it is.

use crate::elementary::{Cores, InitialContact, Toi, ToiOptions};
use crate::math::{Real, Vector};

/// How deep bodies that touch at the start may sink into each other at most, in units of the thickness of
/// the thinner of the two primitives that meet: half way to the medial axis.
const CORE: Real = 0.5;

/// How much deeper what is deeper than that already may sink in one cast, in units of how deep the deepest
/// contact may get; never to the medial axes.
const FURTHER: Real = 0.1;

/// Approach that rounding makes of sliding, in units of the lengths in play. Poses, vertices and velocities are good to
/// half an ulp each, so that a facet of a plane, seen from the body, is off by up to four of them, and so is the way
/// along it. Smaller, and the next facet of a floor may stop what slides on it; larger, and what slides comes nearer by
/// more in each cast.
const SLIDE_ROUNDING: Real = 4.0 * Real::EPSILON;

/// Length by which what slides seems to come nearer, from the sum of the lengths in play: coordinates and the way.
pub fn approach_of_rounding(lengths: Real) -> Real {
    (SLIDE_ROUNDING * lengths).clamp(Real::MIN_POSITIVE, Real::MAX)
}

/// How a cast treats contacts at its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AtStart {
    /// The contact at the start is the answer.
    Stop,
    /// The next, deeper contact is searched for.
    Deepen,
    /// The next, deeper contact is searched for, but two primitives that are deeper than half way to their medial axes
    /// already may pass each other. With this rapier's sweeps let a body move on that the solver did not keep out, as
    /// they do with rapier's own shapes: a body within a platform that is open to it.
    Pass,
}

impl AtStart {
    /// The treatment that parry's flag for casts asks for.
    pub fn of(stop_at_penetration: bool) -> Self {
        match stop_at_penetration {
            true => Self::Stop,
            false => Self::Deepen,
        }
    }
}

/// The deepest contact at the start, world frame.
#[derive(Clone, Copy, Debug)]
pub struct Touching {
    /// Signed distance there, a length.
    pub gap: Real,
    /// Unit normal from the first body to the second.
    pub normal: Vector,
    /// Nearest points of both bodies.
    pub points: [Vector; 2],
    /// Primitive of the first and subshape of the second.
    pub primitives: [u32; 2],
    /// Whether this is surely the deepest contact: one was found, less deep than the thinnest part, so that no medial
    /// surfaces cross.
    pub is_sure: bool,
    /// Velocity of the first body's point less that of the second's.
    pub slip: Vector,
    /// Coordinates from which its place was computed, summed.
    pub size: Real,
}

impl Touching {
    /// How much nearer the two come in `seconds` at the speed that they have.
    fn closing(&self, seconds: Real) -> Real {
        (self.slip.dot(self.normal) * seconds).clamp(0.0, Real::MAX)
    }

    /// Length by which sliding seems to come nearer in `seconds`.
    fn slide(&self, seconds: Real) -> Real {
        approach_of_rounding(self.size + self.slip.length() * seconds)
    }

    /// A contact at the same time with the place of this one.
    pub fn in_place_of(&self, toi: Toi) -> Toi {
        Toi {
            normal: self.normal,
            points: self.points,
            primitives: self.primitives,
            ..toi
        }
    }

    /// Whether the deepest contact comes nearer.
    pub fn approaches(&self, seconds: Real) -> bool {
        self.closing(seconds) > self.slide(seconds)
    }

    /// Options of a straight cast in which the deepest contact does not come nearer.
    pub fn unless_nearer(&self, seconds: Real, options: &ToiOptions) -> ToiOptions {
        let by = self.slide(seconds);
        ToiOptions {
            // A query may pass over what is within its tolerance and not at its target.
            tolerance: options.tolerance.min(by),
            initial_contact: InitialContact::Approach { by },
            ..*options
        }
    }

    /// Options of a cast in which they may go on touching: with `d` the depth that the deepest contact may
    /// get, two primitives of which the thinner is `t` thick may be `min(d, CORE t)` deep. `thickness` is
    /// that of a partner that is not medial, infinite if there is none.
    pub fn sinking(
        &self,
        at_start: AtStart,
        thickness: Real,
        seconds: Real,
        options: &ToiOptions,
    ) -> ToiOptions {
        let depth = (options.target_distance - self.gap).max(0.0) + self.closing(seconds);
        // A pair that is found within the tolerance of the target is as deep as it is allowed to get.
        let sinks = depth + self.slide(seconds) + options.tolerance;
        ToiOptions {
            initial_contact: InitialContact::Deepen {
                by: match at_start {
                    AtStart::Pass => Real::INFINITY,
                    _ => FURTHER * sinks,
                },
            },
            cores: Some(Cores {
                share: CORE,
                at_most: thickness.min(sinks / CORE),
                tips: 0.0,
            }),
            ..*options
        }
    }
}
