//! Two fast bodies: those that surely meet exchange an impulse, those that surely do not fly on.

use crate::bodies::*;
use crate::oracle::*;
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Free flights that get deeper than this, a length, surely meet; those that stay further apart
/// surely do not. In between lies what sampling, and the gap at which bodies meet, leave open.
const SURE: [Real; 2] = [-0.02, 0.02];

/// An open hook, thick at one end and thin at the other.
fn hook() -> MedialMesh {
    let count = 9;
    let spheres = (0..count).map(|i| {
        let s = i as Real / (count - 1) as Real;
        let angle = 4.4 * s;
        let center = Vector::new(0.4 * angle.cos(), 0.2 * s, 0.4 * angle.sin());
        MedialSphere::new(center, 0.1 - 0.06 * s)
    });
    let edges = (1..count as u32).map(|i| [i - 1, i]).collect();
    MedialMesh::new(spheres.collect(), edges, vec![]).expect("a hook")
}

/// A link: two straight sides and two round ends.
fn link() -> MedialMesh {
    use std::f32::consts::PI;
    let spheres: Vec<_> = (0..12)
        .map(|i| {
            let (end, k) = if i < 6 { (1.0, i) } else { (-1.0, i - 6) };
            let angle = PI * (k as Real / 5.0) + if end > 0.0 { 0.0 } else { PI };
            let center = Vector::new(0.25 * angle.cos(), 0.0, 0.4 * end + 0.25 * angle.sin());
            MedialSphere::new(center, 0.07)
        })
        .collect();
    let edges = (0..12).map(|i| [i, (i + 1) % 12]).collect();
    MedialMesh::new(spheres, edges, vec![]).expect("a link")
}

fn rod() -> MedialMesh {
    let ends = [-0.5, 0.5].map(|z| MedialSphere::new(Vector::new(0.0, 0.0, z), 0.05));
    MedialMesh::new(ends.to_vec(), vec![[0, 1]], vec![]).expect("a rod")
}

/// Whether either body's velocity changed.
fn collides(solids: [&Solid; 2], flights: [&Flight; 2], hooked: bool) -> bool {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut pipeline = attached(&mut world);
    let handles = [0, 1].map(|k| {
        let handle = world.insert(flights[k].body(), solids[k].collider()).0;
        world.bodies[handle].set_allow_fast_rotation(true);
        handle
    });
    for _ in 0..STEPS {
        if hooked {
            pipeline.step(&mut world);
        } else {
            world.step();
        }
    }
    (0..2).any(|k| {
        world.bodies[handles[k]]
            .linvel()
            .distance(flights[k].linvel)
            > 1.0e-3
    })
}

struct Count {
    contacts: u32,
    clear: u32,
    missed: u32,
    ghosts: u32,
    missed_by_rapier: u32,
}

fn count(seed: u64, cases: u32, second: impl Fn(&mut Random) -> Solid) -> Count {
    let mut random = Random(seed);
    let shapes = [hook(), link(), rod(), ring(12, 0.4, 0.08)];
    let mut count = Count {
        contacts: 0,
        clear: 0,
        missed: 0,
        ghosts: 0,
        missed_by_rapier: 0,
    };
    for case in 0..cases {
        let first = Solid::Medial(shapes[(random.unit() * 4.0) as usize].clone());
        let second = second(&mut random);
        let solids = [&first, &second];
        let flights = meeting(&mut random);
        let flights = [&flights[0], &flights[1]];
        let least = least_distance(solids, flights);
        if least < SURE[0] {
            count.contacts += 1;
            if !collides(solids, flights, true) {
                count.missed += 1;
                println!("seed {seed} case {case}: missed at {least} m, {flights:?}");
            }
            count.missed_by_rapier += u32::from(!collides(solids, flights, false));
        } else if least > SURE[1] {
            count.clear += 1;
            if collides(solids, flights, true) {
                count.ghosts += 1;
                println!("seed {seed} case {case}: a ghost at {least} m, {flights:?}");
            }
        }
    }
    println!(
        "{} contacts, {} missed (rapier {}); {} clear, {} ghosts",
        count.contacts, count.missed, count.missed_by_rapier, count.clear, count.ghosts
    );
    count
}

fn check(count: &Count) {
    assert!(
        count.contacts >= 30 && count.clear >= 20,
        "cases do not represent"
    );
    assert!(
        count.missed_by_rapier > count.contacts / 3,
        "cases are easy"
    );
    assert_eq!((count.missed, count.ghosts), (0, 0));
}

#[test]
fn two_medial_bodies() {
    let shapes = [hook(), link(), rod(), ring(12, 0.4, 0.08)];
    let any = |random: &mut Random| Solid::Medial(shapes[(random.unit() * 4.0) as usize].clone());
    check(&count(71, 100, any));
}

#[test]
fn a_medial_body_and_a_cuboid() {
    let cuboid = |random: &mut Random| {
        let mut side = || random.within(0.05, 0.5);
        Solid::Cuboid(Vector::new(side(), side(), side()))
    };
    check(&count(72, 100, cuboid));
}

/// Two thin rods head-on at 2 × 60 m/s, crossing at right angles (rapier#984): without the event loop
/// most of these passed through each other, whatever rapier's options.
#[test]
fn crossed_rods_head_on() {
    for phase in 0..16 {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let mut pipeline = attached(&mut world);
        let mut throw = |x: Real, turn: Real| {
            let pose = Pose::new(Vector::new(x, 0.0, 0.0), Vector::new(turn, 0.0, 0.0));
            let speed = Vector::new(-60.0 * x.signum(), 0.0, 0.0);
            let body = RigidBodyBuilder::dynamic().pose(pose).linvel(speed);
            world.insert(body, ColliderBuilder::medial_mesh(rod())).0
        };
        let right = throw(3.0 + phase as Real / 16.0, 0.0);
        let left = throw(-3.0, std::f32::consts::FRAC_PI_2);
        for _ in 0..12 {
            pipeline.step(&mut world);
        }
        let x = |h: RigidBodyHandle| world.bodies[h].translation().x;
        assert!(x(right) > x(left), "phase {phase}");
    }
}
