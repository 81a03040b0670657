//! The maths of two primitives (layer 2): their distance at a fixed time, and when they first touch in motion. It knows
//! spheres and their motion, but no meshes.
//!
//! Two primitives, each of 1, 2 or 3 spheres, are in contact exactly when one of their
//! elementary tests is (paper §4.1): cone–cone for every two edges, sphere–slab for every sphere
//! of one and the slab of the other. That list is complete as long as the medial triangles do not
//! cross: over two triangles the four parameters map to three coordinates (`y`, from one centre to
//! the other), so some direction of change leaves `y` fixed and changes the radius sum linearly,
//! and following it reaches an edge of one of them; edge against triangle has its stationary points
//! on its boundary unless `y = 0`, the crossing. Crossings at the start are found by
//! [`slab_crossing`].
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
//!
//! # Files
//! - What is computed: `test_list.rs` (which tests two primitives need), `path.rs` (their motion), `cone_cone.rs` and
//!   `sphere_slab.rs` (nearest spheres at a fixed time).
//! - First contact: `bracket.rs` (the loop), `certificate.rs` (why no contact is missed), `first_contact.rs` (the call
//!   for two primitives), `earliest.rs` (the earliest of many tests), `resumed.rs` (a loop that pauses and goes on
//!   later); in eight lanes `many.rs`, in double precision `f64.rs`.
//! - At fixed poses: `distance.rs` (signed distance), `penetration.rs` (depth and normal of an overlap),
//!   `slab_crossing.rs` (an edge through a medial triangle).
//! - The paper's own iteration, only to compare with: `alternating.rs`.

pub mod alternating;
pub mod bracket;
pub(crate) mod certificate;
pub(crate) mod cone_cone;
pub mod distance;
pub(crate) mod earliest;
pub mod f64;
pub mod first_contact;
pub mod many;
pub mod path;
pub mod penetration;
pub(crate) mod resumed;
pub mod slab_crossing;
pub(crate) mod sphere_slab;
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

/// Options of a query for the first contact: the distance that counts as a contact, and the tolerance of the answer.
/// The defaults suit metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToiOptions {
    /// How much farther than [`Self::target_distance`] apart bodies may be to count as in contact, in the user's
    /// unit of length. Default 1e-4. It is raised if it is finer than rounding allows ([`Toi::tolerance`]).
    pub tolerance: Real,
    /// How wide the bracket of the contact time may be at the end, as a fraction of the step. Default 1e-6.
    pub time_tolerance: Real,
    /// Largest number of iterations of one elementary test; the answer is [`ToiStatus::Unresolved`] beyond it.
    pub max_iterations: u32,
    /// Signed distance at which bodies count as in contact, a length. 0 stands for the bodies as they are, a negative
    /// value lets them overlap that deep first, a positive one keeps them apart. The guarantee then holds for
    /// `D − target_distance`. Bodies are never let in deeper than the smallest sum of the radii of two primitives,
    /// because deeper than that medial surfaces may cross: a deeper target is raised to it. (This is so with
    /// [`InitialContact::Stop`]; with [`InitialContact::Deepen`] ask for [`Cores`] instead.)
    pub target_distance: Real,
    /// Treatment of primitives that touch at the start already. Only in queries of meshes.
    pub initial_contact: InitialContact,
    /// Start of the paper's iteration. Only for [`alternating()`].
    pub alternating_start: AlternatingStart,
    /// The paths on which the points of a turning body move. Only in queries of meshes.
    pub paths: Paths,
    /// Cores of the bodies: if set, their first contact is asked for instead of that of the bodies. Read by queries of
    /// meshes only.
    pub cores: Option<Cores>,
}

/// The cores of two bodies: what remains of their primitives when the radii are reduced. Bodies may overlap as long as
/// their cores do not, so that thick parts may be pressed deeper into each other than thin ones.
///
/// A sphere of radius `r` has a core of radius `r − s min(r, t)`, where `t` is the thickness of the thinner of the two
/// primitives that meet (`medial/thickness.rs`). If both bodies are medial, `s` is half of [`Self::share`] for
/// each of them. If one is a surface without an inside, it loses nothing, and `s` of the other is all of
/// [`Self::share`]. So bodies whose cores do not overlap are nowhere deeper in each other than `share × t`. And while
/// `share` is at most 1, each core contains its medial axis, so no axis has crossed another, or a surface, however
/// thin the part is.
///
/// Two convex pieces (the parts of a body with flat faces) that touch at the start, and have no edges sharper than 60
/// degrees, are looked at as a whole: they count as touching at their cores when they are `share × t` deep, if `t` is
/// the thickness of the thinner one, wherever that is.
///
/// [`ToiOptions::target_distance`] counts from the cores. Cores that touch at the start may sink into each other with
/// [`InitialContact::Deepen`], but never as far as the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cores {
    /// How deep the bodies may be in each other, as a share of the local thickness, from 0 to 1.
    pub share: Real,
    /// An upper limit of that thickness, a length: the thickness of a partner that is not medial. Infinite if there is
    /// no limit.
    pub at_most: Real,
    /// Thickness down to which a blunt tip is kept from passing through what it touches at the start
    /// ([`InitialContact::Deepen`]), as a share of the local thickness; a thinner end of the tip is not. Two medial
    /// bodies take half of it each, as of [`Self::share`]. With 0 the whole tip is kept, however thin it ends.
    pub tips: Real,
}

impl Cores {
    /// Losses of the spheres of two primitives of these thicknesses: a share of their radius, which is taken as `most`
    /// where it is larger. Infinite thickness stands for a surface.
    pub(crate) fn losses(&self, thickness: [Real; 2]) -> [Loss; 2] {
        let (shares, most) = self.of_each(self.share, thickness);
        shares.map(|share| Loss { share, most })
    }

    /// How deep two bodies of these thicknesses may be in each other where their cores meet, a length.
    pub(crate) fn depth(&self, thickness: [Real; 2]) -> f64 {
        let (shares, most) = self.of_each(self.share, thickness);
        let share = shares[0] + shares[1];
        if share > 0.0 { share * most } else { 0.0 }
    }

    /// Radii, lengths, to which the tips of two primitives of these thicknesses are cut off ([`Self::tips`]), after
    /// their cores' loss. Only blunt tips are cut; a slender one is not thinner at its end.
    pub(crate) fn kept(&self, thickness: [Real; 2]) -> [f64; 2] {
        let losses = self.losses(thickness);
        let (shares, most) = self.of_each(self.tips, thickness);
        std::array::from_fn(|k| {
            let radius = if shares[k] > 0.0 {
                shares[k] * most
            } else {
                0.0
            };
            radius - losses[k].of(radius)
        })
    }

    /// Parts of a share that each of two primitives of these thicknesses has, and the local thickness, a length.
    fn of_each(&self, share: Real, thickness: [Real; 2]) -> ([f64; 2], f64) {
        let most = thickness[0].min(thickness[1]).min(self.at_most);
        let solid = thickness.map(Real::is_finite);
        let share = if solid == [true; 2] {
            0.5 * share
        } else {
            share
        };
        let shares = solid.map(|solid| if solid { f64::from(share) } else { 0.0 });
        (shares, f64::from(most))
    }
}

/// Loss of a sphere's radius.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Loss {
    share: f64,
    most: f64,
}

impl Loss {
    /// Loss of a sphere of this radius, a length.
    pub(crate) fn of(&self, radius: f64) -> f64 {
        self.share * radius.min(self.most)
    }
}

/// The paths on which the points of a turning body move in the step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Paths {
    /// The exact paths of the rigid motion.
    #[default]
    Exact,
    /// Straight from where each point is at the start to where it is at the end (paper, Eq. 1). The guarantee then
    /// holds for these paths, not for the rigid motion.
    Straight,
}

/// Time at which the paper's iteration ([`alternating()`]) looks for its first nearest pair of spheres (§4.3,
/// Figure 3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AlternatingStart {
    /// Start of the step, `t0`. The iteration ends at once if that pair only moves apart, as in Figure 3.
    Start,
    /// End of the step, `t1`: the paper's choice.
    #[default]
    End,
}

/// How a query of meshes treats primitives that are within the tolerance of each other at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InitialContact {
    /// Pairs in contact at the start are the answer: a contact at time 0.
    Stop,
    /// Pairs in contact at the start may stay in touch, and sink in by a length: such a pair counts as in contact only
    /// when its signed distance has fallen by `by` below what it is at the start. Other pairs are searched as usual.
    Deepen {
        /// How much deeper they may get at most, a length above 0. Where parts are so thin that their axes would cross
        /// before, it is a share of the distance of the axes instead. Infinite: such pairs never count as in contact.
        by: Real,
    },
    /// Pairs in contact at the start are the answer, a contact at time 0, if they come nearer to each other in the
    /// step, before another pair meets. Pairs that part or slide go on. This is meant for straight motion, in which the
    /// distance of two primitives never shrinks again once it has grown. If bodies turn, a pair that parts first and
    /// comes nearer later is an answer at time 0 too.
    Approach {
        /// How much nearer they must come, a length above 0: more than rounding of poses and velocities makes of
        /// sliding.
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

/// The outcome of a query for a first contact. The documentation of [this module](self) has the exact promise of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ToiStatus {
    /// No contact in the whole step.
    Separated,
    /// The first contact is between [`Toi::lower`] and [`Toi::upper`].
    Contact,
    /// The bodies overlap at the start already.
    Overlapping,
    /// The limit of iterations or work was reached: no contact before [`Toi::lower`], nothing is known after. Or the
    /// input was bad, and `lower` is 0.
    Unresolved,
}

/// First contact of two primitives or meshes; times are fractions of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Toi {
    /// The outcome, which says what the other fields mean.
    pub status: ToiStatus,
    /// Time before which there is no contact, a fraction of the step; 1 if separated.
    pub lower: Real,
    /// The bodies are in contact, within the tolerance, at this time. 1 if separated or unknown.
    pub upper: Real,
    /// The tolerance that was used, a length: as asked, or raised to the finest that rounding allows.
    pub tolerance: Real,
    /// Number of iterations, summed over all elementary tests.
    pub iterations: u32,
    /// Unit normal from the first body to the second, in the world frame, at `lower`: along it those parts meet that
    /// count as in contact then ([`InitialContact::Deepen`] lets others be deeper in each other). Where a deeper
    /// part of a mesh shields the one that meets, it is that of the deeper contact, or that of the flat face of the one
    /// that meets, and the points lie along it at the place of the deeper contact.
    pub normal: Vector,
    /// Nearest spheres of both bodies, in the world frame, at `lower`.
    pub spheres: [MedialSphere; 2],
    /// Nearest points on the surfaces of both bodies, in the world frame, at `lower`.
    pub points: [Vector; 2],
    /// Index of the touching primitive of each mesh; 0 for single primitives.
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
