//! What the user's hooks and switches turn off: each with a rod that is medial, and with rapier's capsule of the
//! same size in the same scene.

use crate::bodies::{attached, boxes};
use crate::oneway::plates;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Radius of the rod, metres.
const RADIUS: Real = 0.1;

/// Half of its length between the end spheres, metres.
const HALF: Real = 0.4;

/// The rod along X, medial or as rapier's capsule.
pub fn rod(medial: bool) -> ColliderBuilder {
    let end = Vector::X * HALF;
    if !medial {
        return ColliderBuilder::capsule_from_endpoints(-end, end, RADIUS);
    }
    let spheres = [-end, end].map(|c| MedialSphere::new(c, RADIUS));
    let mesh = MedialMesh::new(spheres.to_vec(), vec![[0, 1]], vec![]).expect("a rod");
    ColliderBuilder::medial_mesh(mesh)
}

/// A filter that lets what is above a height collide with everything, and what is below with nothing.
struct AboveOnly {
    height: Real,
    rod: RigidBodyHandle,
}

impl PhysicsHooks for AboveOnly {
    fn filter_contact_pair(&self, context: &PairFilterContext) -> Option<SolverFlags> {
        let above = context.bodies[self.rod].translation().y > self.height;
        above.then_some(SolverFlags::COMPUTE_RIGID_IMPULSES)
    }
}

/// A rod that falls on a thin kinematic platform which lets pass what is below its middle is stopped: whether
/// it was above is asked once, at the start of the step, and not again where the step has carried it.
#[test]
fn a_filter_by_height_is_asked_at_the_start_of_the_step() {
    for speed in [10.0, 30.0, 60.0] {
        let passed = (0..16).filter(|phase| {
            let mut world = PhysicsWorld::new();
            let mut pipeline = attached(&mut world);
            let platform = ColliderBuilder::cuboid(2.0, 0.05, 2.0);
            world.insert(RigidBodyBuilder::kinematic_velocity_based(), platform);
            let start = 0.4 + speed / 60.0 * (1.0 + *phase as Real / 16.0);
            let body = RigidBodyBuilder::dynamic()
                .translation(Vector::Y * start)
                .linvel(-Vector::Y * speed);
            let collider = rod(true).active_hooks(ActiveHooks::FILTER_CONTACT_PAIRS);
            let (rod, _) = world.insert(body, collider);
            let hooks = AboveOnly { height: 0.0, rod };
            for _ in 0..30 {
                pipeline.step_with_events(&mut world, &hooks, &());
            }
            world.bodies[rod].translation().y < 0.0
        });
        assert_eq!(passed.count(), 0, "pass at {speed} m/s");
    }
}

/// What a hook does with the contacts of the platform.
#[derive(Clone, Copy, Debug)]
enum Hook {
    /// `modify_solver_contacts` clears them.
    Cleared,
    /// `filter_contact_pair` returns no flags.
    NoFlags,
    /// `update_as_oneway_platform`, open from below.
    OneWay,
}

struct Platform {
    hook: Hook,
    platform: ColliderHandle,
}

impl PhysicsHooks for Platform {
    fn filter_contact_pair(&self, _: &PairFilterContext) -> Option<SolverFlags> {
        Some(SolverFlags::empty())
    }

    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        match self.hook {
            Hook::OneWay => {
                let side = if context.collider1 == self.platform {
                    1.0
                } else {
                    -1.0
                };
                context.update_as_oneway_platform(Vector::Y * side, 0.1);
            }
            _ => {
                let rigid = context.rigid_mut().expect("rigid bodies");
                rigid.solver_contacts.clear();
            }
        }
    }
}

/// Height of the rod in 90 steps that begin at `start` with the given velocity, against a platform 0.2 m thick at
/// height 0: a fixed one, or a kinematic one that goes up at the speed `lift`, with a rod that rapier sweeps against
/// kinematic bodies.
fn flight(medial: bool, hook: Hook, start: Real, velocity: Real, lift: Option<Real>) -> Vec<Real> {
    let mut world = PhysicsWorld::new();
    let mut pipeline = attached(&mut world);
    let active = match hook {
        Hook::NoFlags => ActiveHooks::FILTER_CONTACT_PAIRS,
        _ => ActiveHooks::MODIFY_SOLVER_CONTACTS,
    };
    let platform = ColliderBuilder::cuboid(3.0, 0.1, 3.0).active_hooks(active);
    let body =
        lift.map(|speed| RigidBodyBuilder::kinematic_velocity_based().linvel(Vector::Y * speed));
    let body = body.map(|body| world.bodies.insert(body));
    let platform = world.insert_collider(platform, body);
    let body = RigidBodyBuilder::dynamic()
        .ccd_enabled(lift.is_some())
        .translation(Vector::Y * start)
        .linvel(Vector::Y * velocity);
    let (rod, _) = world.insert(body, rod(medial));
    let hooks = Platform { hook, platform };
    (0..90)
        .map(|_| {
            pipeline.step_with_events(&mut world, &hooks, &());
            world.bodies[rod].translation().y
        })
        .collect()
}

#[test]
fn contacts_that_are_turned_off_stop_nothing() {
    for hook in [Hook::Cleared, Hook::NoFlags, Hook::OneWay] {
        for speed in [3.0, 7.5, 30.0] {
            let starts: [(Real, Real); 2] = [(-0.35, speed), (0.6, -speed)];
            for (start, velocity) in starts {
                let own = flight(true, hook, start, velocity, None);
                let rapiers = flight(false, hook, start, velocity, None);
                let off = own.iter().zip(&rapiers).map(|(a, b)| (a - b).abs());
                let off = off.fold(0.0, Real::max);
                println!(
                    "{hook:?} {velocity} m/s: {off} m off, {} {}",
                    own[89], rapiers[89]
                );
                // Either is stopped at the first touch of each crossing, once, for what is left of the step.
                let steps = 2.0 * (speed / 60.0).max(9.81 * 1.5 / 60.0) + 0.01;
                assert!(off < steps, "{hook:?} at {velocity} m/s: {off} m off");
            }
        }
    }
}

/// Swept against a platform that goes up, rapier's own rod is stopped in every step in which it catches up with it: at
/// 7.5 and 30 m/s it never gets through. Planted is the flight without it (a platform
/// that flees), less a step's way at each of two crossings.
#[test]
fn contacts_that_are_turned_off_stop_nothing_on_a_platform_that_moves() {
    for hook in [Hook::Cleared, Hook::NoFlags] {
        for speed in [3.0, 7.5, 30.0] {
            for (start, velocity) in [(-0.35, speed), (0.6, -speed)] {
                let heights = |lift| flight(true, hook, start, velocity, lift);
                let [up, free] = [1.0, 100.0 * velocity.signum()].map(|lift| heights(Some(lift)));
                let off = up.iter().zip(&free).map(|(a, b)| (a - b).abs());
                let off = off.fold(0.0, Real::max);
                println!("{hook:?} {velocity} m/s: {off} m off, {}", up[89]);
                let steps = 2.0 * (speed / 60.0).max(9.81 * 1.5 / 60.0) + 0.01;
                assert!(off < steps, "{hook:?} at {velocity} m/s: {off} m off");
            }
        }
    }
}

/// How many of U-shaped bodies, medial or compounds of the same boxes, are still within a one-way platform of some half
/// thickness five seconds after they were thrown up through it.
fn left_within(medial: bool, half: Real) -> usize {
    let bars = [(-0.25, 0.1, 0.3), (0.25, 0.1, 0.3), (0.0, 0.3, 0.1)];
    let bars = bars.map(|(x, half_x, half_y): (Real, Real, Real)| {
        let (at, half) = match half_x < half_y {
            true => (Vector::new(x, 0.1, 0.0), Vector::new(half_x, half_y, 0.15)),
            false => (Vector::new(x, -0.3, 0.0), Vector::new(0.35, half_y, 0.15)),
        };
        (at, half)
    });
    let shape = match medial {
        true => {
            let (vertices, indices) = boxes(&bars);
            let built = MedialMesh::from_trimesh(&vertices, &indices, &BuildOptions::default());
            SharedShape::medial_mesh(built.expect("flat faces").0)
        }
        false => {
            let part = |(at, half): (Vector, Vector)| {
                let cuboid = SharedShape::cuboid(half.x, half.y, half.z);
                (Pose::from_translation(at), cuboid)
            };
            SharedShape::compound(bars.map(part).to_vec())
        }
    };
    let seeds = (0..8).filter(|seed| {
        let mut random = crate::random::Random(*seed);
        let mut world = PhysicsWorld::new();
        let mut pipeline = attached(&mut world);
        let platform = ColliderBuilder::cuboid(4.0, half, 4.0)
            .translation(Vector::NEG_Y * half)
            .active_hooks(ActiveHooks::MODIFY_SOLVER_CONTACTS);
        let platform = world.insert_collider(platform, None);
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::NEG_Y * (2.0 * half + 1.2))
            .rotation(Vector::Y * random.within(0.0, 6.0))
            .linvel(Vector::Y * (random.within(6.0, 9.0) + half));
        let (body, _) = world.insert(body, ColliderBuilder::new(shape.clone()));
        let hooks = Platform {
            hook: Hook::OneWay,
            platform,
        };
        for _ in 0..300 {
            pipeline.step_with_events(&mut world, &hooks, &());
        }
        (-5.0..0.1).contains(&world.bodies[body].translation().y)
    });
    seeds.count()
}

/// Symptom: all of the medial ones hung in the platform, 3 mm further in each step. Cause: rapier's sweeps, which are
/// on where hooks modify contacts, were told of what the body was deep in already.
#[test]
fn concave_bodies_pass_a_oneway_platform() {
    for half in [0.05, 0.5] {
        let [ours, own] = [true, false].map(|medial| left_within(medial, half));
        println!("half {half}: {ours} and {own} of 8 left within");
        assert!(ours <= own, "half {half}: {ours} left, of compounds {own}");
    }
}

/// Symptom: plates were carried up half through the platform, and trembled there for good. Cause: of a plate that stuck
/// in it some slabs pushed up and others down. That more of ours end on it is in `tests/known_issues.rs`.
#[test]
fn plates_pass_a_oneway_platform_that_moves() {
    let [ours, own] = [true, false].map(plates);
    println!("{ours:?}, of cuboids {own:?}");
    assert!(ours.held <= own.held, "{ours:?}, of cuboids {own:?}");
    assert!(ours.on_top >= own.on_top, "{ours:?}, of cuboids {own:?}");
}

/// Two rods that cross at 2 × 60 m/s; one is disabled, or enabled, right before the step in which they meet.
#[test]
fn bodies_are_disabled_and_enabled_between_steps() {
    for phase in 0..16 {
        for enabled in [false, true] {
            let mut world = PhysicsWorld::new();
            world.gravity = Vector::ZERO;
            let mut pipeline = attached(&mut world);
            let shift = 2.5 + phase as Real / 16.0;
            let rods = [-1.0, 1.0].map(|side: Real| {
                let turn = Vector::Y * if side > 0.0 { 1.5 } else { 0.0 };
                let body = RigidBodyBuilder::dynamic()
                    .pose(Pose::new(Vector::Z * side * shift, turn))
                    .linvel(Vector::Z * -side * 60.0)
                    .enabled(side < 0.0 || !enabled);
                world.insert(body, rod(true)).0
            });
            for _ in 0..2 {
                pipeline.step(&mut world);
            }
            if enabled {
                // A disabled body has not moved: it is put where the other will meet it.
                let at = Vector::Z * (shift - 2.0);
                world.bodies[rods[1]].set_translation(at, true);
            }
            world.bodies[rods[1]].set_enabled(enabled);
            let before = world.bodies[rods[1]].translation().z;
            for _ in 0..4 {
                pipeline.step(&mut world);
            }
            let [a, b] = rods.map(|h| world.bodies[h].translation().z);
            if enabled {
                assert!(a < b, "phase {phase}: passed an enabled body, {a} {b}");
            } else {
                let free = -shift + 6.0;
                assert!((a - free).abs() < 1.0e-3, "phase {phase}: {a}, not {free}");
                assert_eq!(b, before, "phase {phase}: a disabled body moves");
            }
        }
    }
}
