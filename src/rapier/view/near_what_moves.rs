//! Finds the still colliders that a step may get to: those that what moves may reach by its velocities, and, of a sleeping
//! body that is reached, those that touch it or nearly do, since rapier wakes what hangs together. What flies farther
//! than its velocities told, because it was struck, may reach others: then the step looks at all
//! ([`StepView::complete`]).

use crate::math::Real;
use crate::rapier::view::medial_colliders::Sets;
use crate::rapier::view::motion::Kind;
use crate::rapier::view::participants::Participants;
use crate::rapier::view::step_view::StepView;
use crate::rapier::view::still_colliders::StillRecord;
use parry3d::bounding_volume::BoundingVolume;
use rapier3d::geometry::ColliderHandle;

/// Margin that boxes are grown by, in units of rapier's length unit: more than half of any target distance, which grows
/// a little with each meeting of a pair.
pub const MARGIN: Real = 5.0e-3;

/// Who takes part in a step; `None` where all do, as where there are fewer than `least` still colliders.
pub fn find(record: &mut StillRecord, sets: Sets, least: usize) -> Option<Participants> {
    let parameters = sets.parameters;
    let margin = parameters
        .prediction_distance()
        .max(MARGIN * parameters.length_unit);
    let joints = (sets.impulse_joints, sets.multibody_joints);
    let (moving, still) = record.look((sets.bodies, sets.colliders), joints, (least, margin))?;
    let mut participants = Participants::new(moving, still);
    add_near(&mut participants, sets, margin);
    Some(participants)
}

/// Adds to those that move the still ones that the step may get to, with boxes grown by `margin` and their skins.
fn add_near(participants: &mut Participants, sets: Sets, margin: Real) {
    let moving = Sets {
        participants: Some(participants),
        ..sets
    };
    let view = StepView::take(moving);
    let dt = sets.parameters.dt;
    let moves = |k: &usize| view.bodies[view.parts[*k].body].kind != Kind::Fixed;
    let mut reached: Vec<ColliderHandle> = Vec::new();
    for k in (0..view.parts.len()).filter(moves) {
        let aabb = view.swept_aabb(k, 0.0, dt);
        let aabb = aabb.loosened(margin + view.parts[k].skin);
        reached.extend(participants.bystanders_in(&aabb));
        let pairs = sets.narrow_phase.contact_pairs_with(view.parts[k].handle);
        reached.extend(pairs.flat_map(|pair| [pair.collider1, pair.collider2]));
    }
    while let Some(handle) = reached.pop() {
        let Some(collider) = sets.colliders.get(handle) else {
            continue;
        };
        if !participants.add(handle) {
            continue;
        }
        let body = collider.parent().and_then(|h| sets.bodies.get(h));
        let Some(body) = body else { continue };
        reached.extend(body.colliders());
        if body.is_dynamic() {
            let grown = margin + collider.contact_skin();
            let aabb = collider.compute_aabb().loosened(grown);
            reached.extend(participants.bystanders_in(&aabb));
            let pairs = sets.narrow_phase.contact_pairs_with(handle);
            reached.extend(pairs.flat_map(|pair| [pair.collider1, pair.collider2]));
        }
    }
    participants.sort();
}
