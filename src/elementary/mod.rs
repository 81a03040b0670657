//! The maths of two primitives (layer 2): their distance at a fixed time, and when they first touch in motion. It knows
//! spheres and their motion, but no meshes.
//!
//! Two primitives of 1, 2 or 3 interpolated spheres each are in contact exactly when one of their
//! elementary tests is (paper §4.1): cone–cone for every two edges, sphere–slab for every sphere
//! of one and the slab of the other. That list is complete as long as the medial triangles do not
//! cross: over two triangles the four parameters map to three coordinates, so some direction of
//! change leaves `y` fixed and changes the radius sum linearly, and following it reaches an edge
//! of one of them; edge against triangle has its stationary points on its boundary unless `y = 0`,
//! the crossing. Crossings at the start are found by [`slab_crossing`].
//!
//! # What the answer promises
//! On the motion asked for (straight paths in [`first_contact()`], exact rigid motion in
//! [`first_contact_rigid`]), with `D(t)` the signed distance (paper Eq. 2, minimised):
//! - [`ToiStatus::Separated`]: `D > 0` in the whole step.
//! - [`ToiStatus::Contact`]: `D > 0` before `lower`, `D(upper) ≤ tolerance`, and
//!   `upper − lower ≤ time_tolerance`. Bodies that pass within `tolerance` may be reported.
//! - [`ToiStatus::Overlapping`]: `D(0) < 0`; `lower = upper = 0`.
//! - [`ToiStatus::Unresolved`]: the limit of iterations was reached; `D > 0` before `lower` still holds.
//!
//! Every bound that is compared with 0 first loses a rounding slack,
//! [`crate::math::tolerance::SLACK_ULPS`]` × EPSILON × scale`; a tolerance below twice that is
//! raised to it, and [`Toi::tolerance`] says so.

pub mod alternating;
pub mod bracket;
pub mod certificate;
pub mod cone_cone;
pub mod distance;
pub mod earliest;
pub mod f64;
pub mod first_contact;
pub mod many;
pub mod path;
pub mod penetration;
pub mod resumed;
pub mod slab_crossing;
pub mod sphere_slab;
pub mod test_list;

pub use alternating::alternating;
pub use first_contact::{first_contact, first_contact_rigid};

use crate::math::tolerance;
use crate::math::{Real, Vector};
use crate::medial::MedialSphere;

/// A sphere on a straight path over the step.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct MovingSphere {
    /// Centre at the start, in world space, in the user's unit of length.
    pub center: Vector,
    /// Radius, ≥ 0, same unit.
    pub radius: Real,
    /// Change of the centre over the whole step, same unit.
    pub displacement: Vector,
}

/// How exact an answer is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToiOptions {
    /// Distance at which bodies count as in contact, in the user's unit of length.
    pub tolerance: Real,
    /// Width at which the bracket of the contact time may stop, as a fraction of the step.
    pub time_tolerance: Real,
    /// Cap of the iterations of one elementary test.
    pub max_iterations: u32,
    /// Signed distance at which bodies count as in contact, a length. 0 for the bodies as they are;
    /// negative lets them overlap that deep first, positive keeps them apart. The guarantee then
    /// holds for `D − target_distance`. Never deeper than the two primitives are thick where they
    /// are thinnest: beyond the smallest sum of their radii medial surfaces may cross, and a deeper
    /// target is raised to it (with [`InitialContact::Stop`]; under `Deepen` ask for [`Cores`] instead).
    pub target_distance: Real,
    /// What becomes of primitives that touch at the start already. Mesh queries only.
    pub initial_contact: InitialContact,
    /// Where the paper's iteration begins. [`alternating()`] only.
    pub alternating_start: AlternatingStart,
    /// On which paths the points of a turning body go. Mesh queries only.
    pub paths: Paths,
    /// Asks for the first contact of cores instead of the bodies themselves. Mesh queries only.
    pub cores: Option<Cores>,
}

/// What of two bodies may not meet although they overlap: each primitive loses a share of its radius, as thick
/// as it and its partner are where they meet ([`crate::medial::thickness`]). A sphere of radius `r` has a
/// core of radius `r − s min(r, t)`, with `t` the thickness of the thinner of the two primitives. Where both
/// bodies are medial, `s` is half of [`Self::share`] for each of them; a surface has no inside to give, and
/// the other body gives all of it. So bodies whose cores do not overlap are no deeper in each other than
/// `share × t` in any place, and while `share` is at most 1 each core holds its medial axis: no axis has
/// crossed another, or a surface, however thin the part is.
///
/// [`ToiOptions::target_distance`] counts from the cores. Cores that touch at the start with
/// [`InitialContact::Deepen`] may sink further in, but never to the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cores {
    /// How deep the bodies may be in each other, in units of the local thickness: from 0 to 1.
    pub share: Real,
    /// Bound of that thickness, a length: how thick a partner is that is not medial. Infinite if there is
    /// none.
    pub at_most: Real,
}

impl Cores {
    /// What the spheres of two primitives of these thicknesses lose: a share of their radius, which is
    /// taken as `most` where it is larger. Infinite thickness stands for a surface.
    pub(crate) fn losses(&self, thickness: [Real; 2]) -> [Loss; 2] {
        let most = thickness[0].min(thickness[1]).min(self.at_most);
        let solid = thickness.map(Real::is_finite);
        let share = if solid == [true; 2] {
            0.5 * self.share
        } else {
            self.share
        };
        solid.map(|solid| Loss {
            share: if solid { f64::from(share) } else { 0.0 },
            most: f64::from(most),
        })
    }
}

/// What spheres lose of their radius.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Loss {
    share: f64,
    most: f64,
}

impl Loss {
    /// Of a sphere of this radius, a length.
    pub(crate) fn of(&self, radius: f64) -> f64 {
        self.share * radius.min(self.most)
    }
}

/// Paths of the points of a body that turns in the step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Paths {
    /// Those of its rigid motion.
    #[default]
    Exact,
    /// Straight from where each starts to where it ends (paper, Eq. 1): the guarantee is for these.
    Straight,
}

/// Time at which the paper's iteration looks for its first nearest sphere pair (§4.3, Figure 3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AlternatingStart {
    /// `t0`: ends at once where that pair only moves apart, as in Figure 3.
    Start,
    /// `t1`, the paper's choice.
    #[default]
    End,
}

/// What a mesh query makes of primitives within the tolerance of each other at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InitialContact {
    /// They are the answer: contact at time 0.
    Stop,
    /// They touch, and may go on touching, but not sink in: such a pair counts as in contact only
    /// when its signed distance has fallen below what it is at the start. Other pairs are searched
    /// as usual.
    Deepen {
        /// By how much at most, a length, > 0. Where parts are so thin that their axes would cross before,
        /// by half of what is left to them.
        by: Real,
    },
    /// They are the answer, contact at time 0, if they come nearer in the step than they are at the start,
    /// before others meet. Those that part or slide go on to its end. For straight motion, in which the
    /// distance of two primitives, convex in time, grows for ever once it does; if bodies turn, what parts
    /// first and comes nearer later is an answer at time 0 too.
    Approach {
        /// By how much nearer, a length, > 0: what rounding of poses and velocities makes of sliding.
        by: Real,
    },
}

impl Default for ToiOptions {
    fn default() -> Self {
        Self {
            tolerance: tolerance::TOLERANCE,
            time_tolerance: tolerance::TIME_TOLERANCE,
            max_iterations: tolerance::MAX_ITERATIONS,
            target_distance: 0.0,
            initial_contact: InitialContact::Stop,
            alternating_start: AlternatingStart::End,
            paths: Paths::Exact,
            cores: None,
        }
    }
}

/// What is known of the first contact; see the module's guarantee.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ToiStatus {
    /// No contact in the whole step.
    Separated,
    /// First contact bracketed by `lower` and `upper`.
    Contact,
    /// In contact with negative distance at the start already.
    Overlapping,
    /// Iteration cap reached, or bad input (then `lower = 0`).
    Unresolved,
}

/// First contact of two primitives or meshes; times are fractions of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Toi {
    /// What the numbers mean.
    pub status: ToiStatus,
    /// No contact before this time. 1 when separated.
    pub lower: Real,
    /// Contact, within the tolerance, at this time. 1 when separated or unknown.
    pub upper: Real,
    /// The contact distance used: as asked, or raised to twice the rounding slack.
    pub tolerance: Real,
    /// Iterations, summed over all elementary tests that were run.
    pub iterations: u32,
    /// Unit normal from the first body to the second, world frame, at `lower`.
    pub normal: Vector,
    /// Nearest spheres of both bodies, world frame, at `lower`.
    pub spheres: [MedialSphere; 2],
    /// Nearest points on both bodies' surfaces, world frame, at `lower`.
    pub points: [Vector; 2],
    /// Index of the primitive of each mesh; 0 for single primitives.
    pub primitives: [u32; 2],
}

impl Toi {
    pub(crate) fn bad_input(options: &ToiOptions) -> Self {
        Self {
            status: ToiStatus::Unresolved,
            lower: 0.0,
            upper: 1.0,
            ..Self::separated(options)
        }
    }

    pub(crate) fn separated(options: &ToiOptions) -> Self {
        Self {
            status: ToiStatus::Separated,
            lower: 1.0,
            upper: 1.0,
            tolerance: options.tolerance,
            iterations: 0,
            normal: Vector::ZERO,
            spheres: [MedialSphere::default(); 2],
            points: [Vector::ZERO; 2],
            primitives: [0; 2],
        }
    }
}
