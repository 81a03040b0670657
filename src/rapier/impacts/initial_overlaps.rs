//! Pairs that are deep in each other because the user put them there: spawned at one place, teleported, given another
//! shape, group or type, or let go of a joint that turned their contacts off.
//!
//! The medial axes of such a pair are near each other or cross already, so there is nothing left to protect, and
//! holding them apart would hold them as they are for ever: whatever parts them at one place takes them deeper at
//! another. So the event loop leaves such a pair to rapier's solver until none of its contacts is deep any more
//! ([`crate::rapier::impacts::deep_pairs`]), and keeps it above the floor ([`crate::rapier::tuning::Tuning::floor`])
//! from then on. A pair left to the solver until it is above the floor alone would be held there: next to the contact
//! that is above it are edges that still cross.
//!
//! A pair counts as put into each other if one of the two is new to a pipeline, or its groups or type changed, or no
//! joint turns their contacts off any more, and rapier's solver did not hold the pair apart before; or if it is below
//! the floor and the two were moved against each other between two steps, or got other shapes, by so much that they may
//! have been apart before. A pair that forces pressed together is held, even if both are moved together. A free body
//! that gives way to another, by rapier's dominance groups, is left to the solver as soon as the two are below the
//! floor. So is one of a higher group than the kinematic one that it meets, and one between two that do not give way
//! ([`crate::rapier::impacts::pinched`]). A pair that a joint holds is left where it is watched and 2 mm deep, and
//! stays left when the joint is gone.

use crate::math::fast_hash::FastSet;
use crate::math::motion::chord;
use crate::math::{Pose, Real};
use crate::medial::MedialMesh;
use crate::rapier::impacts::deep_pairs::{Deep, DeepPairs};
use crate::rapier::impacts::pinched::{one_dominates, pinched, pressed_by_joints};
use crate::rapier::view::all_joints::for_each_joint;
use crate::rapier::view::eligible_pairs::Rules;
use crate::rapier::view::participants::Participants;
use crate::rapier::view::step_view::{StepCollider, StepView};
use rapier3d::dynamics::{RigidBodyHandle, RigidBodySet, RigidBodyType};
use rapier3d::geometry::{
    Collider, ColliderHandle, ContactManifold, InteractionGroups, NarrowPhase, SharedShape,
    SolverFlags,
};

pub type Pair = [ColliderHandle; 2];
/// In the order of their indices.
type BodyPair = [RigidBodyHandle; 2];

/// Record from step to step of bodies put into each other.
#[derive(Default)]
pub struct InitialOverlaps {
    /// How the last step left the colliders, by their indices.
    ends: Vec<Option<(ColliderHandle, End)>>,
    /// The colliders that the last step looked at.
    seen: Vec<ColliderHandle>,
    /// Pairs that rapier's solver held apart in the step before.
    met: FastSet<Pair>,
    /// New colliders, and those whose groups changed since the last step, or the type of their body.
    others: FastSet<ColliderHandle>,
    /// Bodies whose contacts a joint turns off.
    muted: FastSet<BodyPair>,
    /// Bodies whose contacts a joint turned off in the last step, and none does in this.
    freed: FastSet<BodyPair>,
    /// Pairs that are left to the solver.
    left: FastSet<Pair>,
}

/// Record from one step for the next, to be saved beside a world, of bodies that were put into each other: where
/// colliders were, and which pairs are left to rapier's solver.
#[cfg(feature = "serde-serialize")]
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct OverlapsRecord {
    ends: Vec<(ColliderHandle, Pose, CollisionKind)>,
    muted: Vec<BodyPair>,
    left: Vec<Pair>,
}

/// How a step left a collider.
struct End {
    pose: Pose,
    shape: KnownShape,
    kind: CollisionKind,
}

/// Key of whether a collider collides with others: its groups, and the type of its body.
type CollisionKind = ([InteractionGroups; 2], Option<RigidBodyType>);

fn kind(collider: &Collider, bodies: &RigidBodySet) -> CollisionKind {
    let body = collider.parent().and_then(|h| bodies.get(h));
    let groups = [collider.collision_groups(), collider.solver_groups()];
    (groups, body.map(|b| b.body_type()))
}

/// Shape of a collider, as far as it is told whether it is another one a step later. Other shapes than medial meshes
/// are not held, so that a game changes its own in place.
enum KnownShape {
    Medial(MedialMesh),
    /// Where the shape is in memory.
    Other(usize),
}

impl KnownShape {
    fn of(shape: &SharedShape) -> Self {
        match shape.as_shape::<MedialMesh>() {
            Some(mesh) => Self::Medial(mesh.clone()),
            None => Self::Other(std::ptr::from_ref(&*shape.0).addr()),
        }
    }

    /// Bound on how far the surface of the collider was moved by the change from this shape to that of `part`, a
    /// length; infinite if the two are not alike.
    fn moved_to(&self, part: &StepCollider) -> Real {
        match (self, Self::of(&part.shape)) {
            (Self::Medial(old), Self::Medial(new)) => moved_spheres(old, &new),
            (Self::Other(old), Self::Other(new)) if *old == new => 0.0,
            _ => Real::INFINITY,
        }
    }
}

/// How far the sphere that moved farthest did, radii included; infinite if the primitives are others.
fn moved_spheres(old: &MedialMesh, new: &MedialMesh) -> Real {
    if old.shares_data(new) {
        return 0.0;
    }
    let (old_spheres, new_spheres) = (old.spheres(), new.spheres());
    let is_alike = old_spheres.len() == new_spheres.len()
        && old.edges() == new.edges()
        && old.faces() == new.faces();
    if !is_alike {
        return Real::INFINITY;
    }
    let ways = old_spheres
        .iter()
        .zip(new_spheres)
        .map(|(a, b)| a.center.distance(b.center) + (a.radius - b.radius).abs());
    ways.fold(0.0, Real::max)
}

fn index(handle: ColliderHandle) -> u32 {
    handle.into_raw_parts().0
}

fn body_pair([a, b]: BodyPair) -> BodyPair {
    if a.into_raw_parts() <= b.into_raw_parts() {
        [a, b]
    } else {
        [b, a]
    }
}

/// The two in the order of their indices.
fn sorted([a, b]: Pair) -> Pair {
    if index(a) <= index(b) { [a, b] } else { [b, a] }
}

#[cfg(feature = "serde-serialize")]
impl InitialOverlaps {
    /// The record that a world is saved with.
    pub fn record(&self) -> OverlapsRecord {
        let ends = self.ends.iter().flatten();
        let mut record = OverlapsRecord {
            ends: ends.map(|(h, end)| (*h, end.pose, end.kind)).collect(),
            muted: self.muted.iter().copied().collect(),
            left: self.left.iter().copied().collect(),
        };
        record
            .muted
            .sort_unstable_by_key(|pair| pair.map(RigidBodyHandle::into_raw_parts));
        record
            .left
            .sort_unstable_by_key(|pair| pair.map(ColliderHandle::into_raw_parts));
        record
    }

    /// Goes on as when a world with these colliders was saved.
    pub fn resume(&mut self, record: OverlapsRecord, colliders: &rapier3d::geometry::ColliderSet) {
        let end = |(handle, pose, kind)| {
            let shape = KnownShape::of(colliders.get(handle)?.shared_shape());
            Some((handle, End { pose, shape, kind }))
        };
        self.seen.clear();
        self.ends.clear();
        for (handle, end) in record.ends.into_iter().filter_map(end) {
            self.set_end(handle, end);
        }
        self.muted = record.muted.into_iter().collect();
        self.left = record.left.into_iter().collect();
    }
}

impl InitialOverlaps {
    /// Looks at the contacts that rapier has at the start of a step, and whether its solver heeds them.
    pub fn begin(&mut self, view: &StepView, narrow_phase: &NarrowPhase, rules: &Rules) {
        self.met.clear();
        self.others.clear();
        self.freed.clear();
        self.find_freed(view, rules);
        let kind_of = |h| rules.colliders.get(h).map(|c| kind(c, rules.bodies));
        let is_other = |h: &ColliderHandle| {
            let end = self.end_of(*h);
            end.is_none_or(|end| kind_of(*h).is_none_or(|kind| kind != end.kind))
        };
        let handles = view.colliders.iter().map(|part| part.handle);
        let others: FastSet<_> = handles.filter(is_other).collect();
        self.others = others;
        if self.others.is_empty() && self.freed.is_empty() {
            return;
        }
        let bears = |m: &ContactManifold| {
            let flags = m.data.solver_flags;
            flags.contains(SolverFlags::COMPUTE_RIGID_IMPULSES)
                && !m.data.solver_contacts.is_empty()
        };
        let pairs = narrow_phase
            .contact_pairs()
            .filter(|pair| pair.solver_manifolds().iter().any(bears));
        let pairs = pairs.map(|pair| sorted([pair.collider1, pair.collider2]));
        self.met.extend(pairs);
    }

    /// Finds whose contacts joints turn off, and what they let go of.
    fn find_freed(&mut self, view: &StepView, rules: &Rules) {
        let muted_before = std::mem::take(&mut self.muted);
        if view.colliders.is_empty() {
            return;
        }
        for_each_joint(
            rules.impulse_joints,
            rules.multibody_joints,
            |bodies, joint| {
                if !joint.contacts_enabled() {
                    self.muted.insert(body_pair(bodies));
                }
            },
        );
        self.freed.extend(muted_before.difference(&self.muted));
    }

    /// Pairs with deep contacts in this step that are left to the solver.
    pub fn leave(
        &mut self,
        view: &StepView,
        participants: Option<&Participants>,
        deep: &DeepPairs,
        rules: &Rules,
    ) -> Vec<[usize; 2]> {
        let handles = |pair: [usize; 2]| sorted(pair.map(|k| view.colliders[k].handle));
        let was_put = |pair: [usize; 2], deep: &Deep| {
            let is_met = self.met.contains(&handles(pair));
            let is_other = pair
                .iter()
                .any(|k| self.others.contains(&view.colliders[*k].handle));
            match self.moved(view, pair) {
                Some(_)
                    if (is_other || Self::among(&self.freed, view, pair))
                        && deep.is_sunk
                        && !is_met =>
                {
                    true
                }
                Some(moved) => deep.way > 0.0 && moved >= deep.way,
                // rapier has contacts with enabled colliders of disabled bodies, too.
                None => deep.is_sunk && !(is_met && self.ends.is_empty()),
            }
        };
        let mut pinched = pinched(view, deep);
        pinched.extend(pressed_by_joints(view, deep, rules));
        let is_left = |pair: &[usize; 2], deep: &Deep| {
            self.left.contains(&handles(*pair))
                || was_put(*pair, deep)
                || deep.way > 0.0 && one_dominates(view, *pair)
                || deep.is_sunk && rules.are_jointed(view, *pair)
                || pinched.contains(pair)
        };
        let left = deep
            .watched
            .iter()
            .filter(|(pair, deep)| is_left(pair, deep));
        let pairs: Vec<_> = left.map(|(pair, _)| *pair).collect();
        // A pair that does not take part stays as it is.
        let stays = |pair: &Pair| {
            let mut both = pair.iter();
            participants.is_some_and(|p| both.any(|h| p.is_bystander(*h)))
        };
        self.left.retain(stays);
        self.left.extend(pairs.iter().map(|pair| handles(*pair)));
        pairs
    }

    /// The pairs that are left to the solver.
    pub fn left_to_solver(&self) -> FastSet<Pair> {
        self.left.clone()
    }

    /// Leaves other pairs to it.
    pub fn leave_again(&mut self, left: FastSet<Pair>) {
        self.left = left;
    }

    /// Whether the bodies of a pair are among some.
    fn among(bodies: &FastSet<BodyPair>, view: &StepView, pair: [usize; 2]) -> bool {
        let both = pair.map(|k| view.bodies[view.colliders[k].body].handle);
        matches!(both, [Some(a), Some(b)] if bodies.contains(&body_pair([a, b])))
    }

    /// Remembers where the step leaves the colliders; those that did not take part are where they were.
    pub fn end(&mut self, view: &StepView, participants: Option<&Participants>, rules: &Rules) {
        match participants {
            None => self.ends.clear(),
            Some(participants) => {
                let gone = |h: &ColliderHandle| !participants.is_bystander(*h);
                for handle in std::mem::take(&mut self.seen).into_iter().filter(gone) {
                    if let Some(end) = self.ends.get_mut(index(handle) as usize) {
                        *end = None;
                    }
                }
            }
        }
        let end = |part: &StepCollider| {
            let collider = rules.colliders.get(part.handle)?;
            let (pose, kind) = (*collider.position(), kind(collider, rules.bodies));
            let shape = KnownShape::of(&part.shape);
            Some((part.handle, End { pose, shape, kind }))
        };
        for (handle, end) in view.colliders.iter().filter_map(end) {
            self.set_end(handle, end);
        }
        self.seen = view.colliders.iter().map(|part| part.handle).collect();
    }

    fn set_end(&mut self, handle: ColliderHandle, end: End) {
        let place = index(handle) as usize;
        if self.ends.len() <= place {
            self.ends.resize_with(place + 1, || None);
        }
        self.ends[place] = Some((handle, end));
    }

    fn end_of(&self, handle: ColliderHandle) -> Option<&End> {
        let (known, end) = self.ends.get(index(handle) as usize)?.as_ref()?;
        (*known == handle).then_some(end)
    }

    /// Bound on how far points of two colliders were moved against each other between the last step and this one, a
    /// length; `None` if one of them is new.
    fn moved(&self, view: &StepView, pair: [usize; 2]) -> Option<Real> {
        let [p, q] = pair.map(|k| &view.colliders[k]);
        let start = |k: usize| view.start_pose(pair[k]);
        let [end1, end2] = [self.end_of(p.handle)?, self.end_of(q.handle)?];
        let before = end1.pose.inv_mul(&end2.pose);
        let now = start(0).inv_mul(&start(1));
        let turn = chord(before.rotation, now.rotation);
        let extent = q.bound.center().length() + q.bound.radius();
        let changed = end1.shape.moved_to(p) + end2.shape.moved_to(q);
        Some((now.translation - before.translation).length() + turn * extent + changed)
    }
}
