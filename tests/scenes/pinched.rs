//! Bodies that a press squeezes against the ground to less than their thickness, and links that joints press into each
//! other, beside rapier's own shapes.

use crate::bodies::{attached, boxes, plateau, ring};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// A ring of 12 cones, a capsule and a rounded cuboid.
fn shapes(medial: bool) -> [SharedShape; 3] {
    let (end, half) = (Vector::X * 0.3, Vector::new(0.3, 0.15, 0.15));
    let mesh = ring(12, 0.4, 0.1);
    if medial {
        let capsule = MedialMesh::capsule(end, -end, 0.15).expect("a capsule");
        let cuboid = MedialMesh::round_cuboid(half, 0.05).expect("a cuboid");
        return [mesh, capsule, cuboid].map(SharedShape::medial_mesh);
    }
    let part = |e: &[u32; 2]| {
        let [a, b] = e.map(|k| mesh.spheres()[k as usize].center);
        (Pose::IDENTITY, SharedShape::capsule(a, b, 0.1))
    };
    [
        SharedShape::compound(mesh.edges().iter().map(part).collect()),
        SharedShape::capsule(end, -end, 0.15),
        SharedShape::round_cuboid(half.x, half.y, half.z, 0.05),
    ]
}

/// What a press did.
#[derive(Debug)]
struct Pressed {
    /// How deep the deepest body was in the ground or another in the end, a length.
    depth: Real,
    /// Farthest that one was thrown, a length.
    thrown: Real,
    /// Continuous queries of all steps.
    queries: u64,
}

/// Three bodies lie on each other, as they fell, under a plate that comes down by 0.5 m/s to `gap` above the ground,
/// stays for half a second, rises again and leaves them alone for two seconds.
fn press(medial: bool, seed: u64, gap: Real) -> Pressed {
    let mut world = PhysicsWorld::new();
    let mut pipeline = attached(&mut world);
    let ground = ColliderBuilder::cuboid(5.0, 0.5, 5.0).translation(Vector::NEG_Y * 0.5);
    world.insert_collider(ground, None);
    let mut random = crate::random::Random(seed);
    let [ours, own] = [true, false].map(shapes);
    let shapes = if medial { &ours } else { &own };
    let put = |(k, shape): (usize, &SharedShape)| {
        let at = Vector::Y * (0.5 + 0.4 * k as Real) + random.direction() * 0.1;
        let body = RigidBodyBuilder::dynamic().pose(Pose::new(at, random.direction()));
        let collider = ColliderBuilder::new(shape.clone()).density(300.0);
        world.insert(body, collider)
    };
    let bodies: Vec<_> = shapes.iter().enumerate().map(put).collect();
    let plate = RigidBodyBuilder::kinematic_velocity_based().translation(Vector::Y * 2.0);
    let (plate, _) = world.insert(plate, ColliderBuilder::cuboid(2.0, 0.1, 2.0));
    let (mut queries, mut rests) = (0, 0);
    for _ in 0..600 {
        let low = world.bodies[plate].translation().y - 0.1;
        let speed = match rests {
            0 if low > gap => -0.5,
            0..30 => {
                rests += 1;
                0.0
            }
            _ => 0.5,
        };
        world.bodies[plate].set_linvel(Vector::Y * speed, true);
        if medial {
            queries += pipeline.step(&mut world).continuous_queries;
        } else {
            world.step();
        }
    }
    let floor = SharedShape::cuboid(5.0, 0.5, 5.0);
    let pose = |k: usize| *world.bodies[bodies[k].0].position();
    let depth = |a: (Pose, &SharedShape), b: (Pose, &SharedShape)| {
        let contact = rapier3d::parry::query::contact(&a.0, &**a.1, &b.0, &**b.1, 0.0);
        contact.expect("rapier knows both").map_or(0.0, |c| -c.dist)
    };
    let mut deepest: Real = 0.0;
    for i in 0..3 {
        let at = Pose::from_translation(Vector::NEG_Y * 0.5);
        deepest = deepest.max(depth((at, &floor), (pose(i), &own[i])));
        for j in 0..i {
            deepest = deepest.max(depth((pose(i), &own[i]), (pose(j), &own[j])));
        }
    }
    let thrown = (0..3)
        .map(|k| pose(k).translation.length())
        .fold(0.0, Real::max);
    Pressed {
        depth: deepest,
        thrown,
        queries,
    }
}

/// Symptom: the press took 17,000 to 75,000 queries, bodies flew three times as far as rapier's, and one was left 5 cm
/// deep in another. Cause: the event loop held each body above the floor on either side in turn, though neither side
/// gave way.
#[test]
fn pressed_bodies_come_out_as_rapiers() {
    for gap in [0.15, 0.08, 0.02] {
        let seeds = 0..24;
        // One that leaves the ground, as some of rapier's do, falls for as long as the scene lasts: it counts as thrown
        // to the ground's corner.
        let corner = Real::hypot(5.0, 5.0);
        let mean = |all: &[Pressed]| {
            let thrown = all.iter().map(|p| p.thrown.min(corner));
            thrown.sum::<Real>() / all.len() as Real
        };
        let [ours, own] = [true, false].map(|medial| {
            let all = seeds.clone().map(|seed| press(medial, seed, gap));
            all.collect::<Vec<_>>()
        });
        let thrown = [mean(&ours), mean(&own)];
        println!("pressed to {gap} m: thrown by {thrown:?} m, ours and rapier's; {ours:.4?}");
        for (seed, p) in ours.iter().enumerate() {
            assert!(p.depth < 0.002, "to {gap} m, seed {seed}: {p:?}");
            assert!(p.queries < 2000, "to {gap} m, seed {seed}: {p:?}");
        }
        // The mean of six scatters by half, that of 24 by a quarter.
        assert!(thrown[0] < 1.5 * thrown[1], "to {gap} m: {thrown:?}");
    }
}

/// What a chain did.
#[derive(Debug)]
struct Hung {
    /// Farthest that a joint opened, a length.
    opened: Real,
    /// How often a body was held within a step in the last 100 steps of 600.
    held: usize,
    /// Fastest body in the last step.
    speed: Real,
}

/// Boxes on hinges that hang from a fixed one. Where a hinge bends, their edges press into each other.
fn chain(medial: bool, seed: u64) -> Hung {
    let mut world = PhysicsWorld::new();
    let mut pipeline = attached(&mut world);
    let mut random = crate::random::Random(seed);
    let half = Vector::new(0.25, random.within(0.03, 0.12), random.within(0.03, 0.12));
    let arm = half.x + random.within(0.01, 0.03);
    let links = 3 + (random.unit() * 6.0) as usize;
    let mut put = |k: usize| {
        let collider = match medial {
            true => ColliderBuilder::medial_mesh(MedialMesh::cuboid(half).expect("a box")),
            false => ColliderBuilder::cuboid(half.x, half.y, half.z),
        };
        let body = match k {
            0 => RigidBodyBuilder::fixed(),
            _ => RigidBodyBuilder::dynamic(),
        };
        let at = Vector::X * (2.0 * arm * k as Real);
        world
            .insert(body.translation(at), collider.density(800.0))
            .0
    };
    let bodies: Vec<_> = (0..=links).map(&mut put).collect();
    for two in bodies.windows(2) {
        let hinge = RevoluteJointBuilder::new(Vector::Z)
            .local_anchor1(Vector::X * arm)
            .local_anchor2(Vector::NEG_X * arm);
        world.insert_impulse_joint(two[0], two[1], hinge);
    }
    let (mut opened, mut held): (Real, usize) = (0.0, 0);
    for step in 0..600 {
        if medial {
            let frozen = pipeline.step(&mut world).frozen;
            held += if step < 500 { 0 } else { frozen };
        } else {
            world.step();
        }
        for two in bodies.windows(2) {
            let pose = |k: usize| world.bodies[two[k]].position();
            let ends = [pose(0) * (Vector::X * arm), pose(1) * (Vector::NEG_X * arm)];
            opened = opened.max(ends[0].distance(ends[1]));
        }
    }
    let speeds = bodies.iter().map(|b| world.bodies[*b].linvel().length());
    let speed = speeds.fold(0.0, Real::max);
    Hung {
        opened,
        held,
        speed,
    }
}

/// Symptom: one such chain in five stood still in the air, with up to 44 m/s and 174 ms a step. Cause: the event loop
/// held what a joint pressed into its neighbour, and the joint pressed again in the next step.
#[test]
fn links_that_joints_press_into_each_other_hang_as_rapiers() {
    let seeds = 0..12;
    let [ours, own] = [true, false].map(|medial| {
        let all = seeds.clone().map(|seed| chain(medial, seed));
        all.collect::<Vec<_>>()
    });
    for (ours, own) in ours.iter().zip(&own) {
        println!("{ours:.3?}, rapier's {own:.3?}");
        assert!(ours.held < 10, "{ours:?}, rapier's {own:?}");
    }
    let [ours, own] = [ours, own].map(|all| {
        let opened = all.iter().map(|c| c.opened).fold(0.0, Real::max);
        let speed = all.iter().map(|c| c.speed).sum::<Real>();
        [opened, speed / all.len() as Real]
    });
    println!("opened by and speed: {ours:?}, rapier's {own:?}");
    assert!(ours[0] < own[0] + 0.05, "{ours:?}, rapier's {own:?}");
    assert!(ours[1] < own[1] + 1.0, "{ours:?}, rapier's {own:?}");
}

/// A frame of four bars, or an L of two; as rapier's own.
fn bars(medial: bool, is_frame: bool) -> SharedShape {
    let (flat, upright) = (Vector::new(0.5, 0.12, 0.12), Vector::new(0.12, 0.5, 0.12));
    let bars = match is_frame {
        true => vec![
            (Vector::Y * 0.38, flat),
            (Vector::NEG_Y * 0.38, flat),
            (Vector::X * 0.38, upright),
            (Vector::NEG_X * 0.38, upright),
        ],
        false => vec![
            (Vector::NEG_Y * 0.275, Vector::new(0.4, 0.125, 0.15)),
            (Vector::NEG_X * 0.275, Vector::new(0.125, 0.4, 0.15)),
        ],
    };
    let own = |(at, half): &(Vector, Vector)| {
        let bar = SharedShape::cuboid(half.x, half.y, half.z);
        (Pose::from_translation(*at), bar)
    };
    if !medial {
        return SharedShape::compound(bars.iter().map(own).collect());
    }
    let (vertices, indices) = boxes(&bars);
    let mesh = MedialMesh::from_trimesh(&vertices, &indices, &BuildOptions::default());
    SharedShape::medial_mesh(mesh.expect("bars").0)
}

/// A kinematic L pushes a frame against a wall for a while, and stops. Continuous queries in the last 40 steps, and the
/// speed of the frame then.
fn against_a_wall(shapes: &[SharedShape; 2], medial: bool, seed: u64) -> (u64, Real) {
    let mut world = PhysicsWorld::new();
    let mut pipeline = attached(&mut world);
    let mut wall = |half: Vector, at: Vector| {
        let wall = ColliderBuilder::cuboid(half.x, half.y, half.z).translation(at);
        world.insert_collider(wall, None);
    };
    wall(Vector::new(10.0, 0.5, 10.0), Vector::NEG_Y * 0.5);
    wall(Vector::new(0.5, 3.0, 10.0), Vector::new(-1.5, 2.5, 0.0));
    let mut random = crate::random::Random(seed);
    let at = Vector::new(-0.4, 0.4, -0.4);
    let way = Vector::new(-1.0, random.within(-0.2, 0.0), random.within(-0.1, 0.1)).normalize();
    let mut turned = |at| Pose::new(at, random.direction() * 3.0);
    let free = RigidBodyBuilder::dynamic().pose(turned(at));
    let pusher = RigidBodyBuilder::kinematic_velocity_based()
        .pose(turned(at - way * 1.3))
        .linvel(way * 2.5);
    let [first, second] = shapes.clone();
    let (free, _) = world.insert(free, ColliderBuilder::new(first).density(300.0));
    let (pusher, _) = world.insert(pusher, ColliderBuilder::new(second));
    let mut queries = 0;
    for step in 0..120 {
        if step == 40 {
            world.bodies[pusher].set_linvel(Vector::ZERO, true);
        }
        if !medial {
            world.step();
            continue;
        }
        let report = pipeline.step(&mut world);
        queries += if step < 80 {
            0
        } else {
            report.continuous_queries
        };
    }
    (queries, world.bodies[free].linvel().length())
}

/// Symptom: up to 68 queries in each step for as long as the pusher stood there. Cause: the body was deep
/// in the pusher, and in the wall less deep than what is watched, so it was not taken for pinched.
#[test]
fn frames_pushed_against_a_wall_are_left_to_the_solver() {
    let [ours, own] =
        [true, false].map(|medial| [true, false].map(|is_frame| bars(medial, is_frame)));
    let queries = (0..16).map(|seed| against_a_wall(&ours, true, seed).0);
    let most = queries.max().expect("some seeds");
    assert!(most < 100, "{most} queries in 40 steps");
    // What is thrown out of where it is pinched is chance; how often, is not.
    let thrown = [(&ours, true), (&own, false)].map(|(shapes, medial)| {
        let speeds = (0..240).map(|seed| against_a_wall(shapes, medial, seed).1);
        speeds.filter(|speed| *speed > 0.5).count()
    });
    println!("{most} queries, thrown {thrown:?}");
    assert!(thrown[0] <= thrown[1] + 3, "thrown, rapier's: {thrown:?}");
}

/// What a hand did with a body.
#[derive(Debug)]
struct Dragged {
    /// How far the body came along, a length, of 2 m.
    way: Real,
    /// How far from the hand it is in the end, a length.
    off: Real,
}

/// A kinematic hand holds a brick by a joint, presses it 10 cm into the ground, drags it along for 2 m, and lifts it
/// again.
fn drag(medial: bool, joint: impl Into<GenericJoint>) -> Dragged {
    let mut world = PhysicsWorld::new();
    let mut pipeline = attached(&mut world);
    world.insert_collider(plateau(), None);
    let half = Vector::new(0.4, 0.12, 0.25);
    let collider = match medial {
        true => ColliderBuilder::medial_mesh(MedialMesh::cuboid(half).expect("a box")),
        false => ColliderBuilder::cuboid(half.x, half.y, half.z),
    };
    let start = Vector::new(-8.0, half.y + 0.3, 0.3);
    let body = RigidBodyBuilder::dynamic().translation(start);
    let (body, _) = world.insert(body, collider.density(500.0));
    let hand = RigidBodyBuilder::kinematic_velocity_based().translation(start);
    let hand = world.insert_body(hand);
    world.insert_impulse_joint(hand, body, joint);
    for step in 0..360 {
        let velocity = match step {
            0..30 => Vector::NEG_Y * 0.8,
            30..150 => Vector::X,
            210..270 => Vector::Y * 0.6,
            _ => Vector::ZERO,
        };
        world.bodies[hand].set_linvel(velocity, true);
        match medial {
            true => drop(pipeline.step(&mut world)),
            false => world.step(),
        }
    }
    let [at, held_at] = [body, hand].map(|b| world.bodies[b].translation());
    Dragged {
        way: at.x - start.x,
        off: at.distance(held_at),
    }
}

/// Symptom: the body stood still in the ground for good, 2 m from the hand. Cause: the event loop held it above the
/// floor, though neither the joint nor the ground gave way.
#[test]
fn what_a_hand_presses_into_the_ground_comes_along_as_rapiers() {
    let off = Vector::new(0.1, 0.0, 0.05);
    let joints: [(&str, GenericJoint); 2] = [
        ("fixed", FixedJointBuilder::new().build().into()),
        (
            "spherical",
            SphericalJointBuilder::new()
                .local_anchor1(off)
                .local_anchor2(off)
                .build()
                .into(),
        ),
    ];
    for (name, joint) in joints {
        let [ours, own] = [true, false].map(|medial| drag(medial, joint));
        println!("{name}: {ours:.3?}, rapier's {own:.3?}");
        assert!(
            (ours.way - own.way).abs() < 0.05,
            "{name}: {ours:?}, {own:?}"
        );
        assert!(
            (ours.off - own.off).abs() < 0.05,
            "{name}: {ours:?}, {own:?}"
        );
    }
}
