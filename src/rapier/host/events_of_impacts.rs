//! Collision events and contact force events of impacts within a step, which rapier does not know. They are emitted
//! once, with a contact pair like rapier's, and are not repeated when rapier finds the same contact in a later
//! step.

use crate::math::Real;
use crate::medial::MedialMesh;
use crate::rapier::host::reported_impulse::{Impulse, ReportedImpulse};
use crate::rapier::view::filter_answers::sorted;
use parry3d::query::TrackedContact;
use parry3d::shape::PackedFeatureId;
use rapier3d::dynamics::{RigidBodySet, SoftBodySet, SoftBodyTearEvent};
use rapier3d::geometry::{
    Collider, ColliderHandle, ColliderSet, CollisionEvent, CollisionEventFlags, ContactManifold,
    ContactManifoldData, ContactPair, NarrowPhase, PairContacts, SolverFlags,
};
use rapier3d::pipeline::{ActiveEvents, EventHandler};
use std::sync::{Mutex, PoisonError};

type Pair = [ColliderHandle; 2];

/// Pairs whose start was told here, and not yet by rapier.
#[derive(Default)]
pub struct ReportedStarts {
    /// Pairs whose start was told, in the order of their handles.
    pub started: Vec<Pair>,
}

/// The user's handler, seen by rapier: starts already told are not told again, and forces between colliders that
/// may still meet in this step wait until it is known what impacts add.
pub struct DedupEventHandler<'a> {
    events: &'a dyn EventHandler,
    state: Mutex<SentEvents>,
}

/// Events that rapier has sent in this step.
#[derive(Default)]
struct SentEvents {
    started: Vec<Pair>,
    /// Pairs as rapier had them when it told of their forces.
    forces: Vec<ContactPair>,
}

/// The world when events are told.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    /// Seconds of the step.
    pub dt: Real,
    /// Bodies.
    pub bodies: &'a RigidBodySet,
    /// Colliders.
    pub colliders: &'a ColliderSet,
    /// Contacts of the pairs, as rapier knows them.
    pub narrow_phase: &'a NarrowPhase,
}

impl<'a> DedupEventHandler<'a> {
    /// A handler for one step of rapier.
    pub fn new(events: &'a dyn EventHandler, reported: &mut ReportedStarts) -> Self {
        let started = std::mem::take(&mut reported.started);
        let state = SentEvents {
            started,
            forces: Vec::new(),
        };
        Self {
            events,
            state: Mutex::new(state),
        }
    }

    fn change<T>(&self, with: impl FnOnce(&mut SentEvents) -> T) -> T {
        with(&mut self.state.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Tells of the impacts after rapier's step, and of those that have ended.
    pub fn finish(self, reported: &mut ReportedStarts, impulses: &[Impulse], scene: Scene) {
        let (started, forces) = self.change(|state| {
            (
                std::mem::take(&mut state.started),
                std::mem::take(&mut state.forces),
            )
        });
        let hit = |pair: &Pair| {
            impulses
                .iter()
                .find(|i| sorted(i.colliders[0], i.colliders[1]) == *pair)
        };
        reported.started =
            self.tell_collisions(started, impulses, |pair| hit(pair).is_some(), scene);
        let pair_of = |c: &ContactPair| sorted(c.collider1, c.collider2);
        for mut contact in forces.iter().cloned() {
            if let Some(impulse) = hit(&pair_of(&contact)) {
                add_blows(&mut contact, impulse, scene.colliders);
            }
            self.tell_force(&contact, scene);
        }
        for impulse in impulses {
            let pair = sorted(impulse.colliders[0], impulse.colliders[1]);
            if forces.iter().all(|c| pair_of(c) != pair) {
                self.tell_force(&contact_pair(impulse, scene), scene);
            }
        }
    }

    /// Tells which pairs of `before` no longer meet and which meet for the first time; returns those whose start
    /// rapier has not told.
    fn tell_collisions(
        &self,
        before: Vec<Pair>,
        impulses: &[Impulse],
        hit: impl Fn(&Pair) -> bool,
        scene: Scene,
    ) -> Vec<Pair> {
        let tell = |event, contact: &ContactPair| {
            self.events
                .handle_collision_event(scene.bodies, scene.colliders, event, Some(contact));
        };
        let (mut started, ended): (Vec<Pair>, Vec<Pair>) = before.into_iter().partition(&hit);
        for [a, b] in ended {
            let removed = !(scene.colliders.contains(a) && scene.colliders.contains(b));
            let flags = if removed {
                CollisionEventFlags::REMOVED
            } else {
                CollisionEventFlags::empty()
            };
            let contact = known_pair([a, b], scene.narrow_phase);
            tell(CollisionEvent::Stopped(a, b, flags), &contact);
        }
        for impulse in impulses {
            let [a, b] = impulse.colliders;
            let pair = sorted(a, b);
            let active = |h| scene.colliders.get(h).map(Collider::active_events);
            let (Some(c1), Some(c2)) = (active(a), active(b)) else {
                continue;
            };
            let contact = scene.narrow_phase.contact_pair(a, b);
            if (c1 | c2).contains(ActiveEvents::COLLISION_EVENTS)
                && !contact.is_some_and(ContactPair::has_any_active_contact)
                && !started.contains(&pair)
            {
                let event = CollisionEvent::Started(a, b, CollisionEventFlags::empty());
                tell(event, &contact_pair(impulse, scene));
                started.push(pair);
            }
        }
        started
    }

    /// Tells of the force of a pair, if it is above what its colliders want to know.
    fn tell_force(&self, contact: &ContactPair, scene: Scene) {
        let wanted = |h: ColliderHandle| {
            let collider = scene.colliders.get(h)?;
            let active = collider.active_events();
            active
                .contains(ActiveEvents::CONTACT_FORCE_EVENTS)
                .then(|| collider.contact_force_event_threshold())
        };
        let thresholds = [contact.collider1, contact.collider2].map(wanted);
        let threshold = thresholds.into_iter().flatten().reduce(Real::min);
        let force = contact.total_impulse_magnitude() / scene.dt;
        if threshold.is_some_and(|threshold| force > threshold) {
            self.events.handle_contact_force_event(
                scene.dt,
                scene.bodies,
                scene.colliders,
                contact,
                force,
            );
        }
    }
}

/// Contacts of a pair as rapier knows them: none, if their boxes are not near.
fn known_pair([a, b]: Pair, narrow_phase: &NarrowPhase) -> ContactPair {
    let known = narrow_phase.contact_pair(a, b).cloned();
    known.unwrap_or_else(|| {
        let mut unknown = ContactPair::default();
        (unknown.collider1, unknown.collider2) = (a, b);
        unknown
    })
}

/// Contacts of a pair as rapier knows them, and its impacts.
fn contact_pair(impulse: &Impulse, scene: Scene) -> ContactPair {
    let mut contact = known_pair(impulse.colliders, scene.narrow_phase);
    add_blows(&mut contact, impulse, scene.colliders);
    contact
}

/// Adds a manifold for each blow to what rapier knows of a pair. They have no solver contacts: the solver has not
/// seen them.
fn add_blows(contact: &mut ContactPair, impulse: &Impulse, colliders: &ColliderSet) {
    let flipped = contact.collider1 != impulse.colliders[0];
    let parents = [contact.collider1, contact.collider2].map(|h| colliders.get(h)?.parent());
    let PairContacts::Rigid(rigid) = &mut contact.contacts else {
        return;
    };
    for blow in &impulse.blows {
        let mut manifold = manifold(blow, flipped);
        [manifold.data.rigid_body1, manifold.data.rigid_body2] = parents;
        // rapier sums over the clusters, where it made some.
        if !rigid.solver_clusters.is_empty() {
            rigid.solver_clusters.push(manifold.clone());
        }
        rigid.manifolds.push(manifold);
    }
}

fn manifold(blow: &ReportedImpulse, flipped: bool) -> ContactManifold {
    let ([mut p1, mut p2], [mut normal, mut n1, mut n2]) = (blow.points, blow.normals);
    if flipped {
        (p1, p2, normal, n1, n2) = (p2, p1, -normal, n2, n1);
    }
    let mut data = ContactManifoldData::default();
    data.normal = normal;
    data.solver_flags = SolverFlags::COMPUTE_RIGID_IMPULSES;
    let mut manifold = ContactManifold::with_data(0, 0, data);
    (manifold.local_n1, manifold.local_n2) = (n1, n2);
    let unknown = PackedFeatureId::UNKNOWN;
    let point = TrackedContact::new(p1, p2, unknown, unknown, blow.distance);
    manifold.points.push(point);
    for point in &mut manifold.points {
        point.data.impulse = blow.impulse;
    }
    manifold
}

impl EventHandler for DedupEventHandler<'_> {
    fn handle_collision_event(
        &self,
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
        event: CollisionEvent,
        contact_pair: Option<&ContactPair>,
    ) {
        let (CollisionEvent::Started(a, b, _) | CollisionEvent::Stopped(a, b, _)) = event;
        let pair = sorted(a, b);
        let known = self.change(|state| {
            let at = state.started.iter().position(|p| *p == pair);
            at.map(|i| state.started.remove(i)).is_some()
        });
        if !(known && event.started()) {
            self.events
                .handle_collision_event(bodies, colliders, event, contact_pair);
        }
    }

    fn handle_contact_force_event(
        &self,
        dt: Real,
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
        contact_pair: &ContactPair,
        total_force_magnitude: Real,
    ) {
        let medial = |h| {
            let collider = colliders.get(h);
            collider.is_some_and(|c| c.shape().as_shape::<MedialMesh>().is_some())
        };
        if medial(contact_pair.collider1) || medial(contact_pair.collider2) {
            self.change(|state| state.forces.push(contact_pair.clone()));
        } else {
            self.events.handle_contact_force_event(
                dt,
                bodies,
                colliders,
                contact_pair,
                total_force_magnitude,
            );
        }
    }

    fn handle_soft_body_tear_event(&self, soft_bodies: &SoftBodySet, event: &SoftBodyTearEvent) {
        self.events.handle_soft_body_tear_event(soft_bodies, event);
    }
}
