//! Slow pairs that bounce within the step do as rapier says: its combine rules, its events, its hooks.

use crate::told::{Record, Told};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Speed of approach, m/s: slow for balls of 0.2 m, so that only their restitution calls for the event loop.
const SPEED: Real = 0.5;

/// Velocities of two balls that meet in the middle, each at half the speed, their mass, and what was told.
fn meet(
    change: impl Fn(usize, ColliderBuilder) -> ColliderBuilder,
    hooks: &dyn PhysicsHooks,
) -> ([Vector; 2], Real, Told) {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let bodies = [0, 1].map(|k| {
        let side = [-1.0, 1.0][k];
        let body = RigidBodyBuilder::dynamic()
            .can_sleep(false)
            .translation(Vector::X * side * 0.3)
            .linvel(Vector::X * -side * 0.5 * SPEED);
        let ball = ColliderBuilder::medial_mesh(MedialMesh::ball(0.2).expect("a ball"))
            .friction(0.0)
            .active_events(ActiveEvents::COLLISION_EVENTS | ActiveEvents::CONTACT_FORCE_EVENTS);
        world.insert(body, change(k, ball)).0
    });
    let mut pipeline = MedialPipeline::default();
    let record = Record::default();
    for _ in 0..60 {
        pipeline.step_with_events(&mut world, hooks, &record);
    }
    let ends = bodies.map(|b| world.bodies[b].linvel());
    (ends, world.bodies[bodies[0]].mass(), record.take())
}

/// Every combine rule gives the restitution that it stands for, and the impact is told once, with its whole impulse.
#[test]
fn combine_rules_and_events_hold_for_bounces() {
    use CoefficientCombineRule::*;
    let rules = [
        (Average, 0.55),
        (Min, 0.3),
        (Multiply, 0.24),
        (Max, 0.8),
        (ClampedSum, 1.0),
        (GeometricMean, 0.24_f32.sqrt()),
    ];
    for (rule, known) in rules {
        let set = |k: usize, c: ColliderBuilder| {
            let c = c.restitution([0.3, 0.8][k]);
            c.restitution_combine_rule(rule)
        };
        let ([left, right], mass, told) = meet(set, &());
        let got = (right.x - left.x) / SPEED;
        let impulse = told.impulse;
        println!("{rule:?}: restitution {got}, {told:?}");
        assert!((got - known).abs() < 1.0e-3, "{rule:?}: {got}, not {known}");
        let change = 0.5 * mass * SPEED * (1.0 + known);
        assert!(
            (impulse / change - 1.0).abs() < 0.01,
            "{rule:?}: {impulse} of {change} N s"
        );
        assert_eq!(told.starts(), [true, false], "{rule:?}");
    }
}

/// Has no pair meet.
struct NoContacts;

impl PhysicsHooks for NoContacts {
    fn filter_contact_pair(&self, _: &PairFilterContext) -> Option<SolverFlags> {
        None
    }
}

/// Takes all solver contacts away.
struct Emptied;

impl PhysicsHooks for Emptied {
    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        let rigid = context.rigid_mut().expect("rigid bodies");
        rigid.solver_contacts.clear();
    }
}

#[test]
fn pairs_filtered_by_hooks_do_not_bounce() {
    let hooks: [(ActiveHooks, &dyn PhysicsHooks); 2] = [
        (ActiveHooks::FILTER_CONTACT_PAIRS, &NoContacts),
        (ActiveHooks::MODIFY_SOLVER_CONTACTS, &Emptied),
    ];
    for (active, hooks) in hooks {
        let set = |_: usize, c: ColliderBuilder| c.restitution(1.0).active_hooks(active);
        let ([left, right], _, told) = meet(set, hooks);
        assert_eq!([left.x, right.x], [0.5 * SPEED, -0.5 * SPEED]);
        assert_eq!(told.impulse, 0.0);
    }
    let ([left, _], ..) = meet(|_, c| c.restitution(1.0), &());
    assert!((left.x + 0.5 * SPEED).abs() < 1.0e-3, "{left}");
}
