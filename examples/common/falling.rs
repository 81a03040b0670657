//! Rings that fall on the creature: what the example, the viewer and the page in the browser show.

use super::mesh::{Mesh, ring};
use super::random::Random;
use super::scene::{Actor, Model, Scene};
use super::scene_strip::{SLATE, rainbow};
use super::skeleton::Skeleton;
use rapier3d::prelude::*;
use std::f32::consts::TAU;
use std::sync::Arc;

/// Radii of a ring's centre circle and of its tube, in metres.
const RING: (Real, Real) = (0.5, 0.1);
/// Longest side of what falls, in metres.
pub const SIZE: Real = 2.0 * (RING.0 + RING.1);

/// A ring of 1,200 triangles, as in the paper.
pub fn falling_ring() -> (Mesh, Skeleton) {
    let (major, minor) = RING;
    (ring(major, minor, 40, 15), Skeleton::ring(major, minor, 40))
}

/// `count` bodies on a spiral above the creature, every next one higher, turned and spun at random,
/// the same way in every run; the creature is the last actor.
pub fn falling_on(creature: Arc<Model>, body: &Arc<Model>, count: usize) -> Scene {
    let mut random = Random(9);
    let bodies = (0..count).map(|k| {
        let angle = TAU * 0.618_034 * k as Real;
        let out = 1.35 * ((k as Real + 0.6) / count as Real).sqrt();
        let place = Vector::new(out * angle.cos(), 3.2 + 0.55 * k as Real, out * angle.sin());
        let tilt = random.direction() * random.between(0.0, 1.2);
        let spin = random.direction() * random.between(0.0, 3.0);
        Actor {
            model: Arc::clone(body),
            start: RigidBodyBuilder::dynamic()
                .pose(Pose::new(place, tilt))
                .angvel(spin)
                .angular_damping(0.5),
            color: rainbow(k as Real / count as Real),
        }
    });
    let mut actors: Vec<Actor> = bodies.collect();
    actors.push(Actor {
        model: creature,
        start: RigidBodyBuilder::fixed(),
        color: SLATE,
    });
    Scene::new(actors)
}
