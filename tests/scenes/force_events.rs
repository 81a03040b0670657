//! Contact-force events, on which damage and sounds hang: none is lost, and they tell the whole impulse.

use crate::bodies::{attached, ring};
use crate::filters::rod;
use crate::random::Random;
use crate::told::{Record, Told};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// One central meeting of two rods that cross: impulse told over change of momentum, and what was told of starts.
fn meet(medial: bool, speed: Real, random: &mut Random) -> (Real, Told) {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut pipeline = attached(&mut world);
    let steps = 3.0 + random.unit();
    let shift = 0.1 + 0.5 * speed / 60.0 * steps;
    let restitution = random.unit();
    let rods = [-1.0, 1.0].map(|side: Real| {
        let turn = Vector::Z * if side > 0.0 { 1.5 } else { 0.0 };
        let body = RigidBodyBuilder::dynamic()
            .pose(Pose::new(Vector::Z * side * shift, turn))
            .linvel(Vector::Z * -side * 0.5 * speed);
        let collider = rod(medial)
            .friction(0.0)
            .restitution(restitution)
            .active_events(ActiveEvents::COLLISION_EVENTS | ActiveEvents::CONTACT_FORCE_EVENTS)
            .contact_force_event_threshold(0.0);
        world.insert(body, collider).0
    });
    let record = Record::default();
    for _ in 0..12 {
        pipeline.step_with_events(&mut world, &(), &record);
    }
    let changes = [-1.0, 1.0].map(|side: Real| {
        let body = &world.bodies[rods[usize::from(side > 0.0)]];
        body.mass() * (body.linvel().z + side * 0.5 * speed).abs()
    });
    let told = record.take();
    (told.impulse / changes[0].max(changes[1]), told)
}

/// `MEETINGS=1000` for the full count.
#[test]
fn every_meeting_tells_its_impulse() {
    let count = std::env::var("MEETINGS").map_or(150, |n| n.parse().expect("a number"));
    let mut random = Random(2104);
    let (mut lost, mut worst, mut bare) = (0, 0.0, 0);
    for _ in 0..count {
        let speed = 0.3 * Real::powf(200.0 / 0.3, random.unit());
        let (share, told) = meet(true, speed, &mut random);
        let starts: Vec<_> = told.events.iter().filter(|e| e.started).collect();
        lost += usize::from(share == 0.0 || share.is_nan() || starts.is_empty());
        bare += starts.iter().filter(|e| !e.has_points).count();
        worst = (share - 1.0).abs().max(worst);
    }
    let slow = meet(false, 1.0, &mut random).0;
    println!(
        "{count} meetings: {lost} lost, {bare} bare, impulse off by {worst}; rapier's at 1 m/s {slow}"
    );
    assert_eq!([lost, bare], [0, 0]);
    assert!(worst < 0.01, "{worst}");
    assert!((slow - 1.0).abs() < 0.01, "{slow}");
}

/// Steps in which a ring without friction that meets a rod has other velocities after than before: how far what was
/// told is from the change of its momentum, over that.
fn ring_meets_rod(speed: Real, random: &mut Random) -> Vec<Real> {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut pipeline = attached(&mut world);
    let bouncing = |mesh: MedialMesh| {
        let collider = ColliderBuilder::medial_mesh(mesh)
            .friction(0.0)
            .density(500.0);
        let collider = collider.restitution(0.5).contact_force_event_threshold(0.0);
        collider.active_events(ActiveEvents::CONTACT_FORCE_EVENTS)
    };
    let mut side = || 2.0 * random.unit() - 1.0;
    let turn = 3.0 * Vector::new(side(), side(), side());
    let aside = Vector::new(0.2 * side(), 0.2 * side(), 0.0);
    let before = 0.7 + speed / 60.0 * (1.0 + 0.5 * side());
    let body = RigidBodyBuilder::dynamic()
        .pose(Pose::new(aside - Vector::Z * before, turn))
        .linvel(Vector::Z * speed);
    let (body, collider) = world.insert(body, bouncing(ring(14, 0.4, 0.08)));
    let ends = [-0.5, 0.5].map(|x| MedialSphere::new(Vector::X * x, 0.08));
    let rod = MedialMesh::new(ends.to_vec(), vec![[0, 1]], vec![]).expect("a rod");
    world.insert_collider(bouncing(rod), None);
    let record = Record::default();
    let mut off = Vec::new();
    for _ in 0..12 + (60.0 / speed) as usize {
        let velocity = world.bodies[body].linvel();
        pipeline.step_with_events(&mut world, &(), &record);
        let body = &world.bodies[body];
        let change = (body.linvel() - velocity) * body.mass();
        let impulses = record.take().impulses.into_iter();
        let told = impulses.map(|(first, j)| if first == collider { -j } else { j });
        let told = told.fold(Vector::ZERO, |sum, j| sum + j);
        if change.length() > 1.0e-4 * body.mass() * speed {
            off.push((told - change).length() / change.length());
        }
    }
    off
}

/// A ring turns as it slides over the rod, so the blows of a step have different normals.
#[test]
fn impulses_are_told_in_their_directions() {
    let mut random = Random(2611);
    let mut off = Vec::new();
    for _ in 0..120 {
        let speed = Real::powf(100.0, random.unit());
        off.extend(ring_meets_rod(speed, &mut random));
    }
    let worst = off.iter().copied().fold(0.0, Real::max);
    println!(
        "{} steps with a change, told off by {worst} at most",
        off.len()
    );
    assert!(off.len() > 100 && worst < 0.01, "{worst}");
}
