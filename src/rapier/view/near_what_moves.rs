//! Finds the still colliders that a step may get to: those that what moves may reach by its velocities, and, of a
//! sleeping body that is reached, those that touch it and those of its island, which rapier wakes together, and what is
//! beside these. What flies farther than its velocities told, because it was struck, may reach others, and rapier may
//! wake bodies for reasons of its own: then the step looks at all ([`StepView::complete`]).

use crate::math::Real;
use crate::math::fast_hash::FastMap;
use crate::rapier::view::medial_colliders::Sets;
use crate::rapier::view::motion::Mobility;
use crate::rapier::view::participants::Participants;
use crate::rapier::view::step_view::StepView;
use crate::rapier::view::still_colliders::StillRecord;
use parry3d::bounding_volume::BoundingVolume;
use rapier3d::dynamics::IslandManager;
use rapier3d::geometry::ColliderHandle;

/// Margin that boxes are grown by, in units of rapier's length unit: more than half of any target distance, which grows
/// a little with each meeting of a pair.
pub const MARGIN: Real = 5.0e-3;

/// Who takes part in a step; `None` where all do, as where there are not enough still colliders
/// ([`StillRecord::look`]).
pub fn find(
    record: &mut StillRecord,
    sets: Sets,
    islands: &IslandManager,
    least: [usize; 2],
) -> Option<Participants> {
    let parameters = sets.parameters;
    let margin = parameters
        .prediction_distance()
        .max(MARGIN * parameters.length_unit);
    let joints = (sets.impulse_joints, sets.multibody_joints);
    let (moving, still) = record.look((sets.bodies, sets.colliders), joints, (least, margin))?;
    let mut participants = Participants::new(moving, still);
    add_near(&mut participants, sets, islands, margin);
    Some(participants)
}

/// Adds to those that move the still ones that the step may get to, with boxes grown by `margin` and their skins.
fn add_near(participants: &mut Participants, sets: Sets, islands: &IslandManager, margin: Real) {
    let moving = Sets {
        participants: Some(participants),
        ..sets
    };
    let view = StepView::take(moving);
    let dt = sets.parameters.dt;
    let moves = |k: &usize| view.bodies[view.colliders[*k].body].mobility != Mobility::Fixed;
    // Colliders that rapier may wake in the step, and those beside them then.
    let mut woken: Vec<ColliderHandle> = participants.still().everywhere().collect();
    let mut beside = Vec::new();
    for k in (0..view.colliders.len()).filter(moves) {
        let aabb = view.swept_aabb(k, 0.0, dt);
        let aabb = aabb.loosened(margin + view.colliders[k].skin);
        woken.extend(participants.bystanders_in(&aabb));
        woken.extend(touching(sets, view.colliders[k].handle));
    }
    let mut sleeping = None;
    while let Some(handle) = woken.pop() {
        if !participants.add(handle) {
            continue;
        }
        let Some(collider) = sets.colliders.get(handle) else {
            continue;
        };
        let parent = collider.parent();
        let body = parent.and_then(|h| Some((h, sets.bodies.get(h)?)));
        let Some((parent, body)) = body else { continue };
        if body.is_dynamic() {
            woken.extend(body.colliders());
            let grown = margin + collider.contact_skin();
            let aabb = collider.compute_aabb().loosened(grown);
            beside.extend(participants.bystanders_in(&aabb));
            woken.extend(touching(sets, handle));
            let all =
                sleeping.get_or_insert_with(|| SleepingIslands::new(participants, sets, islands));
            woken.extend(all.take(islands.persistent_island_of(sets.bodies, parent)));
        }
    }
    for handle in beside {
        let body = sets.colliders.get(handle).and_then(|c| c.parent());
        let body = body.and_then(|h| sets.bodies.get(h));
        participants.add(handle);
        let dynamic = body.filter(|body| body.is_dynamic());
        for other in dynamic.map_or(&[][..], |body| body.colliders()) {
            participants.add(*other);
        }
    }
    participants.sort();
}

/// Whether something may get to a bystander on the path that rapier's step of a length, in a world of a length unit,
/// gave it.
pub fn leaves(view: &StepView, participants: &Participants, (dt, unit): (Real, Real)) -> bool {
    let moves = |k: &usize| {
        let body = &view.bodies[view.colliders[*k].body];
        body.mobility != Mobility::Fixed && body.awake
    };
    let mut moving = (0..view.colliders.len()).filter(moves);
    moving.any(|k| {
        let grown = view.colliders[k].skin + MARGIN * unit;
        let aabb = view.swept_aabb(k, 0.0, dt).loosened(grown);
        participants.bystanders_in(&aabb).next().is_some()
    })
}

/// Colliders of sleeping bodies, by the island of their body.
struct SleepingIslands(FastMap<u32, Vec<ColliderHandle>>);

impl SleepingIslands {
    fn new(participants: &Participants, sets: Sets, islands: &IslandManager) -> Self {
        let mut all = FastMap::<u32, Vec<ColliderHandle>>::default();
        for handle in participants.still().dynamic_bodies() {
            let island = islands.persistent_island_of(sets.bodies, handle);
            if let Some((island, body)) = island.zip(sets.bodies.get(handle)) {
                all.entry(island).or_default().extend(body.colliders());
            }
        }
        Self(all)
    }

    /// Takes the colliders of an island; none if they were taken before.
    fn take(&mut self, island: Option<u32>) -> Vec<ColliderHandle> {
        island
            .and_then(|island| self.0.remove(&island))
            .unwrap_or_default()
    }
}

/// Colliders that touch one, and itself.
fn touching(sets: Sets, handle: ColliderHandle) -> impl Iterator<Item = ColliderHandle> {
    let pairs = sets.narrow_phase.contact_pairs_with(handle);
    let touching = pairs.filter(|pair| pair.has_any_active_contact());
    touching.flat_map(|pair| [pair.collider1, pair.collider2])
}
