//! Further rows of docs/host.md: rapier alone, or with a dispatcher that answers as rapier does not expect.

use parry3d::math::{Pose, Vector};
use parry3d::query::details::{NormalConstraints, ShapeCastOptions};
use parry3d::query::{
    ClosestPoints, Contact, ContactManifold as Manifold, ContactManifoldsWorkspace,
    DefaultQueryDispatcher, NonlinearRigidMotion, PersistentQueryDispatcher, QueryDispatcher,
    ShapeCastHit, ShapeDistance, ShapeIntersection, TrackedContact, Unsupported,
};
use parry3d::shape::{PackedFeatureId, Shape};
use rapier3d::pipeline::{ContactModificationContext, PhysicsHooks};
use rapier3d::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Saved worlds and sleep timers read these marks, which rapier keeps to itself, from what it prints.
#[test]
fn a_collider_prints_what_was_changed() {
    let mut world = PhysicsWorld::new();
    let (body, collider) = world.insert(RigidBodyBuilder::dynamic(), ColliderBuilder::ball(0.1));
    world.step();
    let prints = |world: &PhysicsWorld, marks: &str| {
        let marks = format!("changes: ColliderChanges({marks})");
        format!("{:?}", world.colliders[collider]).contains(&marks)
    };
    assert!(prints(&world, "0x0"));
    world.colliders[collider].set_friction(0.1);
    assert!(prints(&world, "IN_MODIFIED_SET"));
    let pose = Pose::translation(1.0, 0.0, 0.0);
    world.bodies[body].set_position(pose, true);
    let set = &mut world.bodies;
    set.propagate_modified_body_positions_to_colliders(&mut world.colliders);
    assert!(prints(&world, "IN_MODIFIED_SET | POSITION"));
}

/// A compound of nine balls stands on a cuboid.
#[test]
fn four_contacts_of_one_normal_are_solved() {
    let mut world = PhysicsWorld::new();
    let ground = world.insert_collider(ColliderBuilder::cuboid(2.0, 0.5, 2.0), None);
    let feet = (0..9u8).map(|k| [k / 3, k % 3].map(|x| Real::from(x) - 1.0));
    let feet = feet.map(|[x, z]| (Pose::translation(x, 0.0, z), SharedShape::ball(0.1)));
    let body = RigidBodyBuilder::dynamic().translation(Vector::Y * 0.6);
    let body = world.insert(body, ColliderBuilder::compound(feet.collect()));
    (0..10).for_each(|_| world.step());
    let pair = world
        .narrow_phase
        .contact_pair(ground, body.1)
        .expect("touching");
    let found: usize = pair.manifolds().iter().map(|m| m.points.len()).sum();
    let solved = pair.solver_manifolds().iter();
    let solved: usize = solved.map(|m| m.data.solver_contacts.len()).sum();
    assert_eq!([found, solved], [9, 4]);
}

/// Clears all contacts.
struct NoContacts;

impl PhysicsHooks for NoContacts {
    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        if let Some(contacts) = context.rigid_mut() {
            contacts.solver_contacts.clear();
        }
    }
}

/// A ball flies down at 1 m a step through a thin plate whose contacts are cleared.
#[test]
fn sweeps_stop_bodies_once_at_contacts_that_the_user_cleared() {
    let height = |sweeps| {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        world.integration_parameters.max_ccd_substeps = sweeps;
        world.insert_collider(ColliderBuilder::cuboid(2.0, 0.01, 2.0), None);
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::Y * 1.3)
            .linvel(Vector::NEG_Y * 60.0);
        let ball = ColliderBuilder::ball(0.1).active_hooks(ActiveHooks::MODIFY_SOLVER_CONTACTS);
        let body = world.insert(body, ball).0;
        (0..3).for_each(|_| world.step_with_events(&NoContacts, &()));
        world.bodies[body].translation().y
    };
    let [without, with] = [0, 1].map(height);
    assert!(
        (without + 1.7).abs() < 0.01 && with > -1.0,
        "{without}, {with}"
    );
}

/// Answers one manifold and three, in turn, without a workspace.
struct Changing;

type Answer<T> = Result<T, Unsupported>;

impl QueryDispatcher for Changing {
    fn intersection_test(
        &self,
        _: &Pose,
        _: &dyn Shape,
        _: &dyn Shape,
    ) -> Answer<ShapeIntersection> {
        Err(Unsupported)
    }

    fn distance(&self, _: &Pose, _: &dyn Shape, _: &dyn Shape) -> Answer<ShapeDistance> {
        Err(Unsupported)
    }

    fn contact(&self, _: &Pose, _: &dyn Shape, _: &dyn Shape, _: Real) -> Answer<Option<Contact>> {
        Err(Unsupported)
    }

    fn closest_points(
        &self,
        _: &Pose,
        _: &dyn Shape,
        _: &dyn Shape,
        _: Real,
    ) -> Answer<ClosestPoints> {
        Err(Unsupported)
    }

    fn cast_shapes(
        &self,
        _: &Pose,
        _: Vector,
        _: &dyn Shape,
        _: &dyn Shape,
        _: ShapeCastOptions,
    ) -> Answer<Option<ShapeCastHit>> {
        Err(Unsupported)
    }

    fn cast_shapes_nonlinear(
        &self,
        _: &NonlinearRigidMotion,
        _: &dyn Shape,
        _: &NonlinearRigidMotion,
        _: &dyn Shape,
        _: Real,
        _: Real,
        _: bool,
    ) -> Answer<Option<ShapeCastHit>> {
        Err(Unsupported)
    }
}

/// One contact, upwards.
fn one<M: Default, C: Default + Copy>(at: Real) -> Manifold<M, C> {
    let feature = PackedFeatureId::UNKNOWN;
    let mut manifold = Manifold::with_data(0, 0, M::default());
    manifold.local_n1 = Vector::Y;
    manifold.local_n2 = Vector::NEG_Y;
    let point = TrackedContact::new(
        Vector::new(at, 0.5, 0.0),
        Vector::new(at, -0.1, 0.0),
        feature,
        feature,
        0.0,
    );
    manifold.points.push(point);
    manifold
}

impl<M, C> PersistentQueryDispatcher<M, C> for Changing
where
    M: Default + Clone + Send + Sync,
    C: Default + Copy + Send + Sync,
{
    fn contact_manifolds(
        &self,
        _: &Pose,
        _: &dyn Shape,
        _: &dyn Shape,
        _: Real,
        manifolds: &mut Vec<Manifold<M, C>>,
        _: &mut Option<ContactManifoldsWorkspace>,
    ) -> Answer<()> {
        match manifolds.len() {
            3 => manifolds.truncate(1),
            n => manifolds.extend((n..3).map(|k| one(k as Real))),
        }
        Ok(())
    }

    fn contact_manifold_convex_convex(
        &self,
        _: &Pose,
        _: &dyn Shape,
        _: &dyn Shape,
        _: Option<&dyn NormalConstraints>,
        _: Option<&dyn NormalConstraints>,
        _: Real,
        _: &mut Manifold<M, C>,
    ) -> Answer<()> {
        Err(Unsupported)
    }
}

#[test]
fn lists_that_change_without_a_workspace_panic() {
    let mut world = PhysicsWorld::new();
    world.narrow_phase = NarrowPhase::with_query_dispatcher(Changing.chain(DefaultQueryDispatcher));
    world.insert_collider(ColliderBuilder::cuboid(2.0, 0.5, 2.0), None);
    for k in 0..20u8 {
        let [x, z] = [k % 5, k / 5].map(|x| 0.3 * Real::from(x));
        let body = RigidBodyBuilder::dynamic().translation(Vector::new(x, 0.6, z));
        let ball = ColliderBuilder::ball(0.1).active_hooks(ActiveHooks::from_bits_retain(1 << 31));
        world.insert(body, ball);
    }
    let steps = catch_unwind(AssertUnwindSafe(|| (0..60).for_each(|_| world.step())));
    assert!(steps.is_err());
}

/// Most kinetic energy within a fifth of a second, in units of that at the start, of a rope of capsules on ball joints
/// without gravity, across which a ball flies. Infinite where numbers are lost.
fn energy_of_struck_rope(links: u8, touching: bool, speed: Real) -> Real {
    let (length, radius) = (0.2, 0.04);
    let half = 0.5 * length - if touching { radius } else { 0.0 };
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut last = world.insert_body(RigidBodyBuilder::fixed());
    for k in 0..links {
        let at = Vector::X * length * (Real::from(k) + 0.5);
        let link = ColliderBuilder::capsule_x(half, radius).density(1000.0);
        let next = world
            .insert(RigidBodyBuilder::dynamic().translation(at), link)
            .0;
        let anchor = if k == 0 { 0.0 } else { 0.5 * length };
        let joint = SphericalJointBuilder::new()
            .local_anchor1(Vector::X * anchor)
            .local_anchor2(Vector::NEG_X * 0.5 * length)
            .contacts_enabled(touching);
        world.insert_multibody_joint(last, next, joint);
        last = next;
    }
    let at = Vector::new(
        0.6 * Real::from(links) * length,
        (speed / 40.0).max(0.2),
        0.05,
    );
    let ball = RigidBodyBuilder::dynamic()
        .translation(at)
        .linvel(Vector::NEG_Y * speed);
    let ball = world
        .insert(ball, ColliderBuilder::ball(0.15).density(1000.0))
        .0;
    let start = world.bodies[ball].kinetic_energy();
    let energy = |_| {
        world.step();
        world
            .bodies
            .iter()
            .map(|(_, b)| b.kinetic_energy())
            .sum::<Real>()
            / start
    };
    let energies: Vec<Real> = (0..12).map(energy).collect();
    let or_lost = |x: Real| if x.is_finite() { x } else { Real::INFINITY };
    energies.into_iter().map(or_lost).fold(0.0, Real::max)
}

#[test]
fn multibodies_that_turn_fast_gain_energy() {
    let energy = energy_of_struck_rope(10, false, 20.0);
    assert!(energy > 2.0, "{energy}");
}

/// Slowly struck ropes, in which nothing turns far, with contacts between the links and without.
#[test]
fn contacts_between_neighbours_in_multibodies_lose_all_numbers() {
    let energies = [false, true].map(|touching| energy_of_struck_rope(22, touching, 1.0));
    assert!(energies[0] < 1.1 && energies[1] > 100.0, "{energies:?}");
}

#[test]
fn boxes_in_a_plane_are_thrown_off_the_wall_behind_them() {
    let mut world = PhysicsWorld::new();
    let wall = ColliderBuilder::cuboid(9.0, 9.0, 0.5).translation(Vector::Z * -0.5);
    world.insert_collider(wall, None);
    let ground = ColliderBuilder::cuboid(9.0, 0.5, 9.0).translation(Vector::Y * -0.5);
    world.insert_collider(ground, None);
    let body = RigidBodyBuilder::dynamic()
        .translation(Vector::new(0.0, 0.5, 0.1995))
        .rotation(Vector::Z * 0.7)
        .enabled_translations(true, true, false)
        .enabled_rotations(false, false, true);
    let rounded = ColliderBuilder::round_cuboid(0.15, 0.15, 0.15, 0.05);
    let (body, _) = world.insert(body, rounded);
    let mut fastest: Real = 0.0;
    for _ in 0..180 {
        world.step();
        fastest = fastest.max(world.bodies[body].linvel().length());
    }
    assert!(fastest > 8.0, "rapier no longer throws it: {fastest} m/s");
}
