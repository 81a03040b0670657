//! What rapier 0.36 does that this crate works round (docs/host.md). Each test is of rapier alone, or of rapier
//! with a shape that it does not know: one that fails after an upgrade says that a workaround can go.

mod parry;
#[allow(dead_code)]
#[path = "../common/random.rs"]
mod random;
mod rapier;

use rapier3d::control::KinematicCharacterController;
use rapier3d::prelude::*;
#[cfg(any(feature = "serde-serialize", feature = "debug-render"))]
use rapier3d_medial::prelude::*;

/// A ball that slides over a plate without friction by a millimetre a step. How many of `steps` steps
/// change the first contact's point on the plate.
fn contact_updates(hooks: ActiveHooks, steps: usize) -> usize {
    let mut world = PhysicsWorld::new();
    let plate = ColliderBuilder::cuboid(5.0, 0.5, 5.0).friction(0.0);
    let plate = world.insert_collider(plate, None);
    let body = RigidBodyBuilder::dynamic()
        .translation(Vector::Y)
        .linvel(Vector::X * 0.06)
        .can_sleep(false);
    let collider = ColliderBuilder::ball(0.5).friction(0.0).active_hooks(hooks);
    let (_, sliding) = world.insert(body, collider);
    let place = |world: &PhysicsWorld| {
        let pair = world.narrow_phase.contact_pair(plate, sliding);
        let manifold = pair.and_then(|pair| pair.manifolds().first());
        let point = manifold.and_then(|manifold| manifold.points.first());
        point.map(|point| [point.local_p1.x, point.local_p2.x])
    };
    (0..30).for_each(|_| world.step());
    let mut before = place(&world);
    let mut updates = 0;
    for _ in 0..steps {
        world.step();
        let now = place(&world);
        updates += usize::from(now != before);
        before = now;
    }
    updates
}

#[test]
fn contacts_are_kept_while_a_pair_moves_a_little() {
    let updates = contact_updates(ActiveHooks::empty(), 40);
    assert!(updates < 20, "{updates} of 40 steps computed contacts");
}

#[test]
fn a_hook_bit_without_meaning_makes_rapier_compute_contacts_anew() {
    let updates = contact_updates(ActiveHooks::from_bits_retain(1 << 31), 40);
    assert_eq!(updates, 40);
}

#[test]
fn fast_bodies_pass_each_other_though_both_are_bullets() {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut throw = |x: Real| {
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::X * x)
            .linvel(Vector::X * (-60.0 * x.signum()))
            .ccd_enabled(true);
        world.insert(body, ColliderBuilder::ball(0.1)).0
    };
    let (left, right) = (throw(-1.25), throw(1.25));
    (0..6).for_each(|_| world.step());
    let x = |body: RigidBodyHandle| world.bodies[body].translation().x;
    assert!(x(left) > x(right), "they bounced");
}

#[test]
fn colliders_learn_in_the_step_that_their_body_is_disabled() {
    let mut world = PhysicsWorld::new();
    let (body, collider) = world.insert(RigidBodyBuilder::dynamic(), ColliderBuilder::ball(0.1));
    world.step();
    world.bodies[body].set_enabled(false);
    assert!(world.colliders[collider].is_enabled());
    world.step();
    assert!(!world.colliders[collider].is_enabled());
}

#[test]
fn bodies_moved_by_position_get_their_velocity_in_the_step() {
    let mut world = PhysicsWorld::new();
    let moved = RigidBodyBuilder::kinematic_position_based();
    let (body, _) = world.insert(moved, ColliderBuilder::ball(0.1));
    world.step();
    world.bodies[body].set_next_kinematic_translation(Vector::X);
    assert_eq!(world.bodies[body].linvel(), Vector::ZERO);
    world.step();
    assert!(world.bodies[body].linvel().x > 1.0);
}

#[cfg(feature = "serde-serialize")]
#[test]
fn worlds_with_shapes_of_ones_own_are_not_saved() {
    let mut world = PhysicsWorld::new();
    let mesh = MedialMesh::ball(0.1).expect("a ball");
    world.insert_collider(ColliderBuilder::medial_mesh(mesh), None);
    let saved = bincode::serialize(&world.colliders);
    assert!(saved.is_err());
}

#[cfg(feature = "debug-render")]
#[test]
fn shapes_of_ones_own_are_not_drawn() {
    struct Count(usize);
    impl DebugRenderBackend for Count {
        fn draw_line(&mut self, _: DebugRenderObject, _: Vector, _: Vector, _: DebugColor) {
            self.0 += 1;
        }
    }
    let lines = |collider: ColliderBuilder| {
        let mut world = PhysicsWorld::new();
        world.insert_collider(collider, None);
        let mode = DebugRenderMode::COLLIDER_SHAPES;
        let mut pipeline = DebugRenderPipeline::new(DebugRenderStyle::default(), mode);
        let mut count = Count(0);
        pipeline.render_colliders(&mut count, &world.bodies, &world.colliders);
        count.0
    };
    let mesh = MedialMesh::ball(0.1).expect("a ball");
    assert_eq!(lines(ColliderBuilder::medial_mesh(mesh)), 0);
    assert!(lines(ColliderBuilder::ball(0.1)) > 0);
}

/// A sub-step moves bodies straight: what turns fast opens its joint by the square of the turn in one.
#[test]
fn joints_of_what_turns_fast_open_the_less_the_more_sub_steps_there_are() {
    let opening = |more: usize| {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let root = world.insert_body(RigidBodyBuilder::fixed());
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::X * 0.2)
            .linvel(Vector::Z * -8.0)
            .angvel(Vector::Y * 40.0)
            .additional_solver_iterations(more);
        let bar = ColliderBuilder::capsule_x(0.2, 0.05);
        let (bar, _) = world.insert(body, bar);
        let joint = SphericalJointBuilder::new().local_anchor2(Vector::X * -0.2);
        world.insert_impulse_joint(root, bar, joint.contacts_enabled(false));
        let step = |_| {
            world.step();
            (world.bodies[bar].position() * (Vector::X * -0.2)).length()
        };
        (0..10).map(step).fold(0.0, Real::max)
    };
    let [few, many] = [0, 28].map(opening);
    assert!(few > 2.0e-3, "opens by {few} m");
    assert!(many < 0.2 * few, "opens by {many} m, {few} in few");
}

#[test]
fn bodies_whose_pose_is_set_in_each_step_never_fall_asleep() {
    let sleeps = |is_set: bool| {
        let mut world = PhysicsWorld::new();
        let ground = ColliderBuilder::cuboid(1.0, 0.5, 1.0).translation(Vector::Y * -0.5);
        world.insert_collider(ground, None);
        let body = RigidBodyBuilder::dynamic().translation(Vector::Y * 0.5);
        let (body, _) = world.insert(body, ColliderBuilder::cuboid(0.5, 0.5, 0.5));
        for _ in 0..120 {
            world.step();
            if is_set {
                let body = &mut world.bodies[body];
                let mut pose = *body.position();
                pose.translation.x = 1.0e-4 - pose.translation.x;
                body.set_position(pose, false);
            }
        }
        world.bodies[body].is_sleeping()
    };
    assert!(sleeps(false) && !sleeps(true));
}

/// A floor whose normal comes out straight up and shorter than 1 by rounding is a slope that characters slip on: they
/// stand still for some of their moves. So the normals of hits that this crate tells are longer than 1.
#[test]
fn characters_stand_still_where_rounding_makes_normals_short() {
    let way = |shape: &SharedShape, turn: Vector| {
        let mut world = PhysicsWorld::new();
        let pose = Pose::new(Vector::NEG_Y * 20.0, turn);
        world.insert_collider(
            ColliderBuilder::cuboid(20.0, 20.0, 20.0).position(pose),
            None,
        );
        world.detect_collisions(&(), &());
        let controller = KinematicCharacterController::default();
        let mut at = Vector::new(0.0, 0.511, 0.0);
        for _ in 0..100 {
            let wish = Vector::new(0.04, -0.03, 0.03);
            let (queries, pose) = (world.query_pipeline(), Pose::from_translation(at));
            let moved = controller.move_shape(1.0 / 60.0, &queries, &**shape, &pose, wish, |_| ());
            at += moved.translation;
        }
        Vector::new(at.x, 0.0, at.z).length()
    };
    let axes = [Vector::X, Vector::Y, Vector::Z, Vector::NEG_X];
    let shapes = [
        SharedShape::ball(0.5),
        SharedShape::cuboid(0.2, 0.5, 0.2),
        SharedShape::cylinder(0.5, 0.2),
    ];
    for shape in &shapes {
        let turned = axes.map(|axis| way(shape, axis * std::f32::consts::FRAC_PI_2));
        let least = turned.into_iter().fold(Real::MAX, Real::min);
        assert!(least < 4.9, "{turned:?} m of 5");
    }
}

/// Bodies that slept when their joint was removed wake together, however far apart, and rapier tells so by a call that
/// its documentation hides.
#[test]
fn sleeping_islands_wake_as_a_whole() {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let ball = || ColliderBuilder::ball(0.1);
    let [a, b] = [0.0, 10.0].map(|x| {
        let body = RigidBodyBuilder::dynamic().translation(Vector::X * x);
        world.insert(body, ball()).0
    });
    let joint = FixedJointBuilder::new().local_anchor1(Vector::X * 10.0);
    let joint = world.impulse_joints.insert(a, b, joint, true);
    for _ in 0..300 {
        world.step();
    }
    assert!([a, b].iter().all(|h| world.bodies[*h].is_sleeping()));
    world.impulse_joints.remove(joint, false);
    world.step();
    let island = |world: &PhysicsWorld, h| world.islands.persistent_island_of(&world.bodies, h);
    assert!(world.bodies[b].is_sleeping() && island(&world, a) == island(&world, b));
    world.bodies[a].wake_up(true);
    world.step();
    assert!(!world.bodies[b].is_sleeping());
}

/// A ball strikes a bar on a multibody's hinge: the velocity of the hinge is not that of the bar until the next step.
#[test]
fn bodies_of_multibodies_get_their_last_velocity_in_the_next_step() {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let root = world.bodies.insert(RigidBodyBuilder::fixed());
    let bar = RigidBodyBuilder::dynamic().translation(Vector::X * 0.3);
    let (bar, _) = world.insert(bar, ColliderBuilder::cuboid(0.3, 0.05, 0.05));
    let hinge = RevoluteJointBuilder::new(Vector::Y).local_anchor2(Vector::X * -0.3);
    world.insert_multibody_joint(root, bar, hinge);
    let ball = RigidBodyBuilder::dynamic().translation(Vector::new(0.5, 0.0, -0.2));
    world.insert(ball.linvel(Vector::Z), ColliderBuilder::ball(0.1));
    let mut most: Real = 0.0;
    for _ in 0..20 {
        world.step();
        let link = world.multibody_joints.rigid_body_link(bar).copied();
        let multibody = link.and_then(|l| world.multibody_joints.get_multibody(l.multibody));
        let hinge = multibody.map(|m| m.generalized_velocity()[0]);
        most = most.max((hinge.expect("a hinge") - world.bodies[bar].angvel().y).abs());
    }
    assert!(most > 0.05, "{most} rad/s");
}

#[test]
fn a_new_multibody_joint_moves_its_second_body_in_the_step() {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut put = |x: Real| {
        let body = RigidBodyBuilder::dynamic().translation(Vector::X * x);
        world.insert(body, ColliderBuilder::ball(0.1)).0
    };
    let [a, b] = [0.0, 3.0].map(&mut put);
    let joint = SphericalJointBuilder::new().local_anchor1(Vector::X);
    world.insert_multibody_joint(a, b, joint);
    assert_eq!(world.bodies[b].translation().x, 3.0);
    world.step();
    let x = world.bodies[b].translation().x;
    assert!((x - 1.0).abs() < 0.01, "at {x}");
}
