//! Thin plates that are thrown up through a one-way platform that moves.

use super::bodies::attached;
use super::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Lets through what comes from below a platform.
struct FromBelow(ColliderHandle);

impl PhysicsHooks for FromBelow {
    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        let side = if context.collider1 == self.0 {
            1.0
        } else {
            -1.0
        };
        context.update_as_oneway_platform(Vector::Y * side, 0.6);
    }
}

/// Where 96 plates are, medial or rapier's cuboids, five seconds after they were thrown up through a platform that
/// rises for two seconds.
#[derive(Debug, Default)]
pub struct Plates {
    /// Have been in the platform for the last second.
    pub held: usize,
    /// Others that lie on it.
    pub on_top: usize,
}

/// Throws the plates, each alone.
pub fn plates(medial: bool) -> Plates {
    let half = Vector::new(0.5, 0.03, 0.35);
    let shape = match medial {
        true => SharedShape::medial_mesh(MedialMesh::cuboid(half).expect("a plate")),
        false => SharedShape::cuboid(half.x, half.y, half.z),
    };
    let mut ends = Plates::default();
    for seed in 0..96 {
        let mut random = Random(seed);
        let mut world = PhysicsWorld::new();
        let mut pipeline = attached(&mut world);
        let thick = [0.05, 0.1, 0.2][(random.unit() * 3.0) as usize];
        let platform = ColliderBuilder::cuboid(4.0, thick, 4.0)
            .translation(Vector::NEG_Y * thick)
            .active_hooks(ActiveHooks::MODIFY_SOLVER_CONTACTS);
        let moves = RigidBodyBuilder::kinematic_velocity_based()
            .linvel(Vector::Y * random.within(0.5, 3.0));
        let (base, platform) = world.insert(moves, platform);
        let turn = random.direction() * random.within(0.0, 3.0);
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::NEG_Y * (2.0 * thick + 0.7))
            .rotation(turn)
            .angvel(turn)
            .linvel(Vector::new(1.0, random.within(4.0, 6.5), 0.0));
        let (body, plate) = world.insert(body, ColliderBuilder::new(shape.clone()));
        let mut is_held = true;
        for step in 0..300 {
            if step == 120 {
                world.bodies[base].set_linvel(Vector::ZERO, true);
            }
            pipeline.step_with_events(&mut world, &FromBelow(platform), &());
            let top = world.bodies[base].translation().y;
            let aabb = world.colliders[plate].compute_aabb();
            let is_in = aabb.mins.y < top - 0.03 && aabb.maxs.y > top - 2.0 * thick + 0.03;
            is_held &= step < 240 || is_in;
        }
        let height = world.bodies[body].translation().y - world.bodies[base].translation().y;
        ends.held += usize::from(is_held);
        ends.on_top += usize::from(!is_held && (0.0..1.0).contains(&height));
    }
    ends
}
