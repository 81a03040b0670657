//! Contacts of medial pairs in which a body hangs, computed as they will be at the end of the step, as far as
//! velocities tell at its start. With contacts of the step's start, chains and rings that hang swing ever wider.
//!
//! rapier keeps the normals and lever arms of a step's start through all its `s` substeps. A force that turns with its
//! body (the pull in a chain, the weight of a ring that rolls in another) then lags behind the body, which feeds the
//! oscillation. With contacts at the time `θ` of the step, as a fraction, an oscillation of angular frequency `ω` grows
//! in each step of length `h` by the factor
//!
//! `√(1 + ((s − 1) / 2s − θ) (ω h)²)`,
//!
//! the root of the determinant of one step `v' = v − h ω² (x + θ h v)`, `x' = x + (h / s) Σ_k v_k`, whose
//! force acts in `s` equal parts. Warm-started impulses lag too, by up to half a step more. With `θ = 0`
//! a ring that rolls in another swings ever wider, and twenty hanging links tremble for ever. With
//! `θ = 1`, backward Euler for directions, nothing grows, and they sleep.
//!
//! A body that tips over its support is the reverse case. Its force grows with `x`, `ω²` is negative, and contacts
//! of the step's end would feed the motion: a ring of cones that rolls on a plate tips over one corner after
//! another. So where no body hangs, contacts are those of the step's start.

use crate::batch::{Job, PairJob, PairResult};
use crate::math::{Pose, Real, Rotation, Vector};
use crate::medial::MedialMesh;
use crate::pair::thinned::thin;
use crate::pair::{RelativeMotionBound, SpherePair};
use crate::parry::contacts::manifolds::NARROW;
use crate::parry::narrow_phase_plan::PairKey;
use crate::rapier::contacts::reach::{closing, reach, way};
use crate::rapier::view::medial_colliders::{MedialCollider, MedialColliders};
use parry3d::math::AngularInertia;
use rapier3d::dynamics::IntegrationParameters;

/// How far ahead contacts of a body that hangs are computed, in steps. Chains of 5 to 40 links slept in 8, 12 and 14 of
/// 14 cases with 0.5, 0.75 and 1.
const LOOKAHEAD_HANGING: Real = 1.0;

/// Time ahead, in steps, for a body that hangs in one that stands still: nothing lags behind that one. A ring that
/// rolls in a fixed one has 0.66 of its first swing left after 20 s, and 0.33 with 1.
const LOOKAHEAD_HANGING_IN_STILL: Real = 0.6;

/// Time ahead, in steps, where neither body hangs. A ring of 48 cones that rolls on a plate at 0.5 m/s has 0.45 m/s
/// left after 5 s, and 0.46 if the plate is free; 0.58 and 0.55 with 0.25 and 0.2, 0.74 with 0.6 and 0.5.
const LOOKAHEAD_STANDING: Real = 0.0;

/// Relative travel in that time, in units of the thinner body's thickness and at most rapier's
/// prediction distance, beyond which contacts are computed less far ahead: a fast body would already be
/// in the other, or past it.
const MAX_LOOKAHEAD_TRAVEL: Real = 0.25;

/// How far apart two contacts are that bear a load like one, in units of the thinner body's thickness: a quarter of the
/// width of a patch, of which one contact is written (`parry/contacts/manifolds.rs`); where patches are narrow, all of
/// it.
const MERGE_DISTANCE: Real = 0.25;

/// The least such distance, in units of rapier's prediction distance: half of that in which two contacts are one for
/// rapier.
const LEAST_APART: Real = 0.125;

/// Speeds of two bodies against each other, in units of rapier's length unit per second, between which rapier may keep
/// their contacts for several steps in which they rock: it does until the pair has moved by 0.004 of its length unit.
/// With an upper bound of 0.24 instead of 0.39, 20 of 120 pairs of rings that lie on each other rock on for ever, with
/// 0.39 5; with 0.48 a ring that rolls at 0.2 m/s loses more speed than rapier's own. With a lower bound of 0 heaps at
/// rest cost a fifth more, and rock no less.
const ROCKING_SPEEDS: [Real; 2] = [0.03, 0.39];

/// Travel in a step, in units of rapier's length unit, beyond which contacts are not kept: that of the upper speed at
/// 60 steps a second.
const MAX_KEPT_TRAVEL: Real = 0.0065;

/// Lever of a contact's normal about the joint of two neighbours in a multibody, in units of the smaller's size, below
/// which the joint holds the contact itself. Nothing but rounding moves along such a normal, and rapier divides by it:
/// a rope of 22 links whose neighbours touch end to end left all numbers within three steps of being struck.
const HELD_LEVER: Real = 0.03;

/// The contacts of a pair that rapier asks for unexpectedly, as the batch would have computed them; `None` if it is not
/// at its start, or rapier looks further than usual. Those that are not among `colliders` may be among `others`, which
/// stand still.
pub fn predicted(
    colliders: &MedialColliders,
    others: Option<&MedialColliders>,
    job: PairJob,
) -> Option<PairResult> {
    let of = |mesh| colliders.of(mesh).or_else(|| others?.of(mesh));
    let [a, b] = [&job.mesh1, &job.mesh2].map(of);
    let pair = [a?, b?];
    let at_start = pair[0].pose().inv_mul(pair[1].pose()) == job.pos12;
    let skins = pair[0].skin + pair[1].skin;
    let usual = job.prediction == colliders.parameters.prediction_distance() + skins;
    (at_start && usual).then(|| PredictedMotion::contacts(pair, &colliders.parameters, job))
}

/// Motion of a pair from the start of the step to where its contacts are computed: what brings them back.
pub struct PredictedMotion {
    /// Relative pose at the start (second in first).
    pos12: Pose,
    /// Turn of each body until then, in its own frame.
    turns: [Rotation; 2],
    /// Centre of mass of each, in its own frame.
    centers: [Vector; 2],
    /// The prediction distance that rapier will ask for.
    asked: Real,
    /// Rotation of the first at the start, and what resists the turning of both in the world.
    rotation: Rotation,
    inverse_inertias: [AngularInertia; 2],
    /// How far they may move.
    bound: RelativeMotionBound,
    /// Anchor of the joint of a multibody that holds them to each other, in the first's frame at the start, and the
    /// lever below which it holds a contact too.
    joint: Option<(Vector, Real)>,
    /// How far apart two contacts are that bear a load like one, a length; `None` where contacts are corners of faces,
    /// or the user may take away some.
    apart: Option<Real>,
    /// Whether the pair moves little, but more than at rest ([`ROCKING_SPEEDS`]).
    lasting: bool,
}

impl PredictedMotion {
    /// The motion of the two colliders of `job`, which is at their poses at the start of a step; with the job that
    /// computes their contacts.
    ///
    /// Only contacts within [`reach()`] count, and of them those that no nearer one holds back: the others within the
    /// prediction distance cost the solver as much as those that bear.
    pub fn new(
        starts: [&MedialCollider; 2],
        parameters: &IntegrationParameters,
        job: PairJob,
    ) -> (Self, PairJob) {
        let (dt, prediction) = (parameters.dt, parameters.prediction_distance());
        let thickness = job.mesh1.thickness().min(job.mesh2.thickness());
        let motions = starts.map(|s| &s.motion);
        let [a, b] = motions;
        let speed = closing(starts);
        let longest = prediction.min(MAX_LOOKAHEAD_TRAVEL * thickness);
        let still = motions
            .iter()
            .any(|m| m.linvel == Vector::ZERO && m.angvel == Vector::ZERO);
        let hangs = starts.iter().any(|s| s.hangs);
        let ahead = match (hangs, still) {
            (true, false) => LOOKAHEAD_HANGING,
            (true, true) => LOOKAHEAD_HANGING_IN_STILL,
            (false, _) => LOOKAHEAD_STANDING,
        } * dt;
        let time = if speed * ahead > longest {
            longest / speed
        } else {
            ahead
        };
        // At the start, if nothing moves or velocities are not finite.
        let poses = if speed > 0.0 && time > 0.0 {
            motions.map(|m| m.position_at_time(time))
        } else {
            [a.start, b.start]
        };
        let reach = reach(starts, parameters);
        let way = way(starts, parameters);
        let skins = job.prediction - prediction;
        let unit = parameters.length_unit;
        let lasting = speed * dt < MAX_KEPT_TRAVEL * unit
            && (ROCKING_SPEEDS[0]..ROCKING_SPEEDS[1]).contains(&(speed / unit));
        let width = if lasting { NARROW } else { MERGE_DISTANCE };
        let apart = (width * thickness).max(LEAST_APART * prediction);
        let are_of_pieces = [&job.mesh1, &job.mesh2].map(|m| !m.convex_pieces().is_empty());
        let is_thinned = are_of_pieces != [true; 2] && !starts.iter().any(|s| s.is_modified());
        let joint = |k: usize| {
            let (other, anchor) = starts[k].joint?;
            let pose = a.start.inv_mul(&motions[k].start);
            let lever = HELD_LEVER * starts[0].extent.min(starts[1].extent);
            (starts[1 - k].body == Some(other)).then(|| (pose * anchor, lever))
        };
        let turn = |k: usize| motions[k].start.rotation.inverse() * poses[k].rotation;
        let ahead = Self {
            pos12: a.start.inv_mul(&b.start),
            turns: [turn(0), turn(1)],
            centers: motions.map(|m| m.local_center),
            rotation: a.start.rotation,
            inverse_inertias: starts.map(|s| s.inverse_inertia),
            asked: job.prediction,
            bound: RelativeMotionBound {
                travel: way,
                angle: way / arm(&job.mesh1).min(arm(&job.mesh2)),
                skins,
            },
            joint: joint(0).or_else(|| joint(1)),
            lasting,
            apart: (is_thinned && apart > 0.0).then_some(apart),
        };
        let job = PairJob {
            pos12: poses[0].inv_mul(&poses[1]),
            prediction: skins + reach,
            ..job
        };
        (ahead, job)
    }

    /// The contacts of `job`, as they are handed on from a batch.
    pub fn contacts(
        starts: [&MedialCollider; 2],
        parameters: &IntegrationParameters,
        job: PairJob,
    ) -> PairResult {
        let (ahead, job) = Self::new(starts, parameters, job);
        let mut result = job.answer();
        ahead.rebase_to_step_start(&mut result);
        result
    }

    /// The key under which rapier will ask for the contacts of `job`, and the prediction distance for which
    /// they serve.
    pub fn key(&self, job: &PairJob) -> (PairKey, Real) {
        (
            PairKey::new(&job.mesh1, &job.mesh2, &self.pos12),
            self.asked,
        )
    }

    /// Puts both points on one line along the normal.
    ///
    /// Each is where its body's lever arm will end, and they part by `t`, the way of the bodies along each other.
    /// rapier takes the arms of both from the points' midpoint, half of `t` off: under a ball that rolls, the
    /// ground would push ahead of its centre and brake it. A shift by `s1 t` and `s2 t`, `s1 + s2 = 1`, is least
    /// for the angular accelerations of both together, `(s1 i1)² + (s2 i2)²`, at `s1 = i2² / (i1² + i2²)`, with
    /// the inverse inertias `i` about the axis that `t` turns them about.
    fn align(&self, contact: &mut SpherePair) {
        let [p1, p2] = contact.points;
        let apart = self.pos12 * p2 - p1;
        let t = apart - contact.normal * apart.dot(contact.normal);
        let axis = self.rotation * contact.normal.cross(t);
        let [i1, i2] = self.inverse_inertias.map(|i| (i * axis).dot(axis).powi(2));
        let first = if i1 + i2 > 0.0 { i2 / (i1 + i2) } else { 0.5 };
        let back = self.pos12.rotation.inverse();
        contact.points = [p1 + t * first, p2 - back * t * (1.0 - first)];
    }

    /// Brings contacts back: normals and lever arms point as they will, gaps are those at the start. Of those
    /// that others hold back none is left.
    pub fn rebase_to_step_start(&self, result: &mut PairResult) {
        result.lasting = self.lasting;
        for contact in &mut result.contacts {
            let [p1, p2] = contact.points;
            contact.normal = self.turns[0] * contact.normal;
            contact.distance = (self.pos12 * p2 - p1).dot(contact.normal);
            let turned = |k: usize, p| self.centers[k] + self.turns[k] * (p - self.centers[k]);
            contact.points = [turned(0, p1), turned(1, p2)];
            self.align(contact);
        }
        if let Some((anchor, least)) = self.joint {
            let lever = |c: &SpherePair| (c.points[0] - anchor).cross(c.normal).length();
            result.contacts.retain(|c| lever(c) > least);
        }
        if let Some(apart) = self.apart {
            thin(&mut result.contacts, apart);
        }
        self.bound.drop_held_back(&mut result.contacts);
    }
}

/// Second half extent of a mesh: whatever axis it turns about, some point of it is about this far from it, so
/// that it turns by no more than that point's way over this. (A rod that lies across its frame is thinner.)
fn arm(mesh: &MedialMesh) -> Real {
    let h = mesh.aabb().half_extents();
    (h.x + h.y + h.z) - h.max_element() - h.min_element()
}
