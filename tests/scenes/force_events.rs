//! Contact-force events, on which damage and sounds hang: none is lost, and they tell the whole impulse.

use crate::bodies::attached;
use crate::filters::rod;
use crate::random::Random;
use crate::told::{Record, Told};
use rapier3d::prelude::*;

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
