//! The constants of the event loop, in one place so that `cargo bench --bench effects -- --sweep` can vary them.
//! None needs tuning by users.
//!
//! Each but [`Tuning::flat_sink`] and [`Tuning::flat_depth`], which are for flat faces and for triangles, was halved
//! and doubled alone, in 1,458 flights of two fast bodies, and in heaps of 27 loops at 20, 60 and 150 m/s, with
//! restitution 0 (measured at commit 343b3fc) and 0.9, where energy is judged. With no value was a contact missed or
//! invented, a loop linked wrongly, or, at 0.9, energy gained, and the median error of the first change of velocity
//! stayed within 0.01. Where something else moves, the constant says so; with all others, depth stays within 0.1 of the
//! radii, and the number of queries within a quarter.

use crate::math::Real;

/// Constants of the event loop. The defaults are what is meant to be used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// Relative travel in a step, in units of the thickness of the thinner of two parts that may meet, from
    /// which a pair is fast. With [`Self::floor`] it makes a whole half: a slow pair deeper than the floor less this at
    /// the start is watched, any other cannot get to the floor.
    pub fast: Real,
    /// Depth no pair may reach, in units of the local thickness: half way to the medial axes
    /// ([`crate::elementary::Cores`]). Above 1 they cross. Depth over radius sum in a heap: 0.20 halved, 0.27 default,
    /// 0.50 doubled. Queries a step at 20 m/s: 536 halved, 340 default, 315 doubled.
    pub floor: Real,
    /// How thick a blunt tip has to be, in units of the local thickness, not to pass through what it touches
    /// ([`crate::elementary::Cores::tips`]). At 0 sharp edges that are pressed into each other freeze their bodies: in
    /// three heaps of 12 blocks with flat faces 308 times in 240 steps, at 0.1 33 times, at 0.2 twice; their corners
    /// get 2.4 cm into the ground at 0.1 and 3.7 cm at 0.2, of a thickness of 17.5 cm.
    pub tips: Real,
    /// Relative travel in a step where a pair may meet, in units of the thickness, from which the pair is muted.
    /// Between this and [`Self::fast`] both the solver and the loop have it.
    pub muted: Real,
    /// Gap at which a fast pair counts as in contact, in units of rapier's length unit, and of the
    /// thickness, whichever is less.
    pub gap: [Real; 2],
    /// The least such gap, in units of rapier's length unit, however thin the parts are; floors are half of
    /// it further out. Ten times the rounding of poses 40 m from the origin; larger, and sheets of
    /// radius 0 rest on air that can be seen.
    pub least_gap: Real,
    /// Tolerance of the query, in units of the gap: smaller costs iterations.
    pub tolerance: Real,
    /// Gap up to which a pair touches at the start and belongs to the solver, in units of [`Self::gap`].
    pub touching: Real,
    /// Gap at which a pair stops the world, in units of [`Self::gap`]: with the query's tolerance and
    /// rounding below [`Self::touching`], so that the solver has the contact in what is left of the
    /// step. Doubling it breaks this, and costs a quarter more queries.
    pub stopping: Real,
    /// How much deeper a touching fast pair may get in one go, in units of the thickness.
    pub sink: Real,
    /// How much deeper a pair of bodies with flat faces that is below the floor may get in one go, in units of the
    /// thickness; the nearer their axes are, the less (`pair/deepening.rs`). Two walls of bricks of which some are
    /// 10,000 times as heavy as others make 406 and 2,322 impacts in 400 steps at 0.02, and about 9,800 without. At
    /// 0.04 a frame that is pressed against a wall still moves when the press has stopped. Rings have none of this: a
    /// heavy one would drive a light one into the ground.
    pub flat_sink: Real,
    /// The least that a pair may get deeper in one go, in units of the gap. At 0 it would never leave its first
    /// contact.
    pub min_sink: Real,
    /// Impacts of a body in one step after which it stays where it is. Halved and doubled, 1.7 times and
    /// half as many bodies do at 150 m/s, for 0.75 and 1.33 times the queries.
    pub max_events: u32,
    /// Number of still colliders from which a step leaves out those that nothing gets to, and how many times as many as
    /// the moving ones they must be. Among fewer, looking for them costs more than it saves.
    pub least_still: [usize; 2],
    /// Times that the world stops in one step. Each costs a step; after the last one impulses take the
    /// rest, so fewer only make impacts less exact: at half, 0.7 impulses a flight instead of 0.3.
    pub max_stops: usize,
    /// Speed up to which nothing bounces where no force pulls, in units of rapier's length unit per second. Far below
    /// what can be seen; ten times as large, and boxes of elastic bodies lose a hundredth of their energy.
    pub least_bounce: Real,
    /// Depth up to which a body lies on the plane of a face, in units of rapier's length unit, beyond what gravity
    /// presses it in: bodies that slide are not that deep, and what is deeper beside a face may strike its edge.
    pub flat_depth: Real,
    /// Depth from which bodies in an impact are pushed apart, in units of the thickness.
    pub push_depth: Real,
    /// Share of the depth below it that is pushed out in a step.
    pub push: Real,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            fast: 0.25,
            floor: 0.5,
            tips: 0.2,
            muted: 1.0,
            gap: [1.0e-3, 0.1],
            least_gap: 5.0e-5,
            tolerance: 0.1,
            touching: 0.45,
            stopping: 0.25,
            sink: 0.1,
            flat_sink: 0.02,
            min_sink: 0.1,
            max_events: 16,
            least_still: [64, 2],
            max_stops: 8,
            least_bounce: 1.0e-3,
            flat_depth: 6.0e-3,
            push_depth: 0.1,
            push: 0.2,
        }
    }
}

impl Tuning {
    /// Depth of rapier's contacts, in units of the thickness, from which a slow pair is watched.
    pub(crate) fn guarded(&self) -> Real {
        self.floor - self.fast
    }

    /// Impacts after which a body is no longer carried along either: two that push it from both sides
    /// would go on for ever.
    pub(crate) fn max_carried(&self) -> u32 {
        2 * self.max_events
    }
}
