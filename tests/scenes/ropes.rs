//! Ropes of bodies on ball joints, struck in their middle within a step: how wide their joints open, beside rapier's
//! capsules in sub-steps of 1/1,980 s until the step of the impact ends, and rapier's steps of 1/60 s from there.

use crate::bodies::attached;
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Radius of links, and their half length between joints, metres.
const RADIUS: Real = 0.05;
const HALF: Real = 0.2;

fn bar(medial: bool, axis: Vector, half: Real) -> ColliderBuilder {
    let end = axis * half;
    let collider = if medial {
        let mesh = MedialMesh::capsule(-end, end, RADIUS).expect("a bar");
        ColliderBuilder::medial_mesh(mesh)
    } else {
        ColliderBuilder::capsule_from_endpoints(-end, end, RADIUS)
    };
    collider.friction(0.0).density(1000.0)
}

/// How a rope ends.
struct End {
    /// The widest opening of a joint, metres.
    widest: Real,
    /// The energy over that of the start, seen from what holds the rope.
    energy: Real,
    turns: Vec<Rotation>,
}

/// A rope of so many links that is struck at a speed, and drifts with the rod and what holds it, if at all.
fn struck(links: usize, speed: Real, drift: Option<Vector>, medial: bool, steps: &[Real]) -> End {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut pipeline = attached(&mut world);
    let only = |own, other| InteractionGroups::new(own, other, InteractionTestMode::And);
    let [x, y] = [Vector::X, Vector::Y].map(|axis| axis * HALF);
    let moving = |drift| RigidBodyBuilder::kinematic_velocity_based().linvel(drift);
    let root = drift.map_or_else(RigidBodyBuilder::fixed, moving);
    let drift = drift.unwrap_or_default();
    let mut last = world.insert_body(root);
    let mut joints = Vec::new();
    for i in 0..links {
        let at = x * (2 * i + 1) as Real;
        let body = RigidBodyBuilder::dynamic().translation(at).linvel(drift);
        let collider = bar(medial, Vector::X, HALF - RADIUS);
        let (link, _) = world.insert(
            body,
            collider.collision_groups(only(Group::GROUP_1, Group::GROUP_2)),
        );
        let anchors = [if i == 0 { Vector::ZERO } else { x }, -x];
        let joint = SphericalJointBuilder::new().local_anchor1(anchors[0]);
        world.insert_impulse_joint(last, link, joint.local_anchor2(anchors[1]));
        joints.push(([last, link], anchors));
        last = link;
    }
    let start = Vector::new(links as Real * HALF, 0.0, -0.1 - speed / 60.0 * 1.37);
    let body = RigidBodyBuilder::dynamic()
        .translation(start)
        .linvel(Vector::Z * speed + drift);
    let rod = bar(medial, y.normalize(), HALF);
    world.insert(
        body,
        rod.collision_groups(only(Group::GROUP_2, Group::GROUP_1)),
    );
    let energy = |world: &PhysicsWorld| -> Real {
        let of = |b: &RigidBody| {
            let mut seen = b.clone();
            seen.set_linvel(b.linvel() - drift, false);
            seen.kinetic_energy()
        };
        let bodies = world.bodies.iter().filter(|(_, b)| b.is_dynamic());
        bodies.map(|(_, b)| of(b)).sum()
    };
    let before = energy(&world);
    let mut widest: Real = 0.0;
    for &dt in steps {
        world.integration_parameters.dt = dt;
        if medial {
            pipeline.step(&mut world);
        } else {
            world.step();
        }
        for (bodies, anchors) in &joints {
            let [a, b] = [0, 1].map(|k| world.bodies[bodies[k]].position() * anchors[k]);
            widest = widest.max(a.distance(b));
        }
    }
    let turn =
        |([_, link], _): &([RigidBodyHandle; 2], [Vector; 2])| *world.bodies[*link].rotation();
    End {
        widest,
        energy: energy(&world) / before,
        turns: joints.iter().map(turn).collect(),
    }
}

/// Symptom: ropes of 8 and 30 links opened by 131 and 60 mm at 120 m/s, rapier's own by 59 and 36, and kept 0.30 and
/// 0.41 of the energy, rapier's 0.47 and 0.43. Cause: an impact that came while bodies were on their way along the
/// chord of an arc took the chord for their velocity, and rapier's next steps move straight in a sub-step.
#[test]
fn a_rope_struck_opens_no_wider_than_rapiers() {
    let coarse = |n: usize| vec![1.0 / 60.0; n];
    let fine = [vec![1.0 / 1980.0; 66], coarse(2)].concat();
    for links in [4, 8, 16, 30] {
        for speed in [20.0, 60.0, 120.0] {
            let ours = struck(links, speed, None, true, &coarse(4));
            let own = struck(links, speed, None, false, &fine).widest;
            let (ours, energy) = (ours.widest, ours.energy);
            println!(
                "{links} links, {speed} m/s: {ours} m, rapier's own {own} m, {energy} of the energy"
            );
            assert!(energy <= 1.001, "{links} links, {speed} m/s: {energy}");
            assert!(
                ours < own + 2.0e-3,
                "{links} links, {speed} m/s: {ours} m, {own} m"
            );
        }
    }
}

/// A rope that is struck while it drifts goes as one that does not: energy, which impacts do not give, is that in the
/// frame of what holds it.
#[test]
fn a_drifting_rope_is_struck_as_one_at_rest() {
    let coarse = vec![1.0 / 60.0; 4];
    let ends = [0.0, 40.0].map(|drift| struck(5, 20.0, Some(Vector::X * drift), true, &coarse));
    let turns = ends[0].turns.iter().zip(&ends[1].turns);
    let off = turns.map(|(a, b)| a.angle_between(*b)).fold(0.0, Real::max);
    let energies = [0, 1].map(|k| ends[k].energy);
    println!("turns are {off} rad off, energies {energies:?}");
    assert!(off < 0.02, "turns are {off} rad off");
    assert!(
        (energies[0] - energies[1]).abs() < 0.01,
        "energies {energies:?}"
    );
}

/// Two ropes of 8 links on ball joints without weight, one of which flies at the other.
fn thrown(speed: Real, seed: u64) -> PhysicsWorld {
    const LINKS: usize = 8;
    let mut random = Random(seed);
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    for (at, speed) in [(0.0, 0.0), (-2.5, speed)] {
        let turn = random.direction() * 3.0;
        let rope = Pose::new(random.direction() * 0.2 + Vector::Z * at, turn);
        let mut last = None;
        for i in 0..LINKS {
            let along = Vector::X * HALF * (2.0 * i as Real + 1.0 - LINKS as Real);
            let body = RigidBodyBuilder::dynamic()
                .pose(Pose::from_parts(rope * along, rope.rotation))
                .linvel(Vector::Z * speed);
            let collider = bar(true, Vector::X, HALF - RADIUS).friction(0.3);
            let (link, _) = world.insert(body, collider);
            if let Some(last) = last {
                let joint = SphericalJointBuilder::new().local_anchor1(Vector::X * HALF);
                world.insert_impulse_joint(last, link, joint.local_anchor2(Vector::NEG_X * HALF));
            }
            last = Some(link);
        }
    }
    world
}

/// Symptom: ropes thrown at each other at 100 m/s lost a third to nine tenths of their momentum where bodies were
/// stopped after too many impacts. Cause: joints gave velocities as if a stopped body were of infinite mass, and only
/// to the other body; and of bodies that joints tie, only some were told the velocities that the step ends with.
#[test]
fn ropes_that_are_thrown_at_each_other_keep_their_momentum() {
    let mut stopped = 0;
    for seed in 1..=8 {
        let mut world = thrown(100.0, seed);
        let mut pipeline = attached(&mut world);
        let momentum = |world: &PhysicsWorld| -> Vector {
            let all = world.bodies.iter();
            all.map(|(_, body)| body.linvel() * body.mass()).sum()
        };
        let energy = |world: &PhysicsWorld| -> Real {
            let all = world.bodies.iter();
            all.map(|(_, body)| body.kinetic_energy()).sum()
        };
        let before = (momentum(&world), energy(&world));
        let mut own = 0;
        for _ in 0..30 {
            own += pipeline.step(&mut world).frozen;
        }
        let after = (momentum(&world), energy(&world));
        let lost = (after.0 - before.0).length() / before.0.length();
        let energy = after.1 / before.1;
        println!(
            "seed {seed}: {own} stopped, {lost} of the momentum lost, {energy} of the energy left"
        );
        assert!(lost < 1.0e-5, "seed {seed}: {lost} of the momentum lost");
        assert!(energy < 1.001, "seed {seed}: {energy} of the energy");
        stopped += own;
    }
    assert!(stopped > 0);
}
