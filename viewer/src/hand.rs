//! The pointer as a hand: the left button takes hold of a body where it is seen, and pulls it along.

use crate::common::scene::Stage;
use rapier3d::prelude::{QueryFilter, Ray, Real, RigidBodyHandle, Vector};

/// How far bodies are picked (m).
const REACH: Real = 100.0;
/// Speed of the held point per distance from the pointer (1/s), and its largest (m/s).
const HASTE: Real = 8.0;
const FASTEST: Real = 12.0;
/// Share of the missing speed that the hand gives in a step: all of it would make turning bodies tremble.
const GRIP: Real = 0.3;
/// Share of its spin that a held body loses in a step.
const CALM: Real = 0.05;

/// A body in the hand.
struct Held {
    body: RigidBodyHandle,
    /// Where it is held, in its own frame.
    point: Vector,
    /// From the eye to that point along the pointer's ray (m).
    distance: Real,
}

/// What the pointer holds.
#[derive(Default)]
pub struct Hand(Option<Held>);

impl Hand {
    /// Takes hold of the first body on a ray; false if that cannot move, or there is none.
    pub fn grab(&mut self, stage: &Stage, (eye, along): (Vector, Vector)) -> bool {
        let world = &stage.world;
        let ray = Ray::new(eye, along);
        let hit = world.cast_ray(&ray, REACH, true, QueryFilter::default());
        self.0 = hit.and_then(|(collider, distance)| {
            let body = world.colliders[collider].parent()?;
            let pose = world.bodies[body].position();
            world.bodies[body].is_dynamic().then(|| Held {
                body,
                point: pose.inverse() * (eye + along * distance),
                distance,
            })
        });
        self.0.is_some()
    }

    /// Lets go.
    pub fn open(&mut self) {
        self.0 = None;
    }

    /// Before a step: pulls the held point to the same distance on the pointer's ray.
    pub fn pull(&mut self, stage: &mut Stage, (eye, along): (Vector, Vector)) {
        let Some(held) = &self.0 else { return };
        let Some(body) = stage.world.bodies.get_mut(held.body) else {
            return self.open();
        };
        let point = *body.position() * held.point;
        let missing = eye + along * held.distance - point;
        let wanted = (missing * HASTE).clamp_length_max(FASTEST);
        let impulse = (wanted - body.velocity_at_point(point)) * body.mass() * GRIP;
        body.apply_impulse_at_point(impulse, point, true);
        let spin = body.angvel() * (1.0 - CALM);
        body.set_angvel(spin, true);
    }
}
