//! Chains and rings that hang, and which contacts are computed when: those that can close in a step, and
//! anew those that a body hangs in (`src/rapier/contacts/predicted_contacts.rs`, `src/rapier/host/forced_updates.rs`).
//!
//! The full run: `cargo test --release --test scenes -- --ignored --nocapture full_chain`.

use crate::bodies::*;
use crate::crowds::{compound, medial};
use crate::linking::{line, linking};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::f32::consts::FRAC_PI_2;

/// A chain hung from a fixed ring: steps until it sleeps, and how far its lowest ring moves in the
/// `seconds` after `settle` steps, with sleep turned off.
fn chain(
    collider: &dyn Fn(&MedialMesh) -> ColliderBuilder,
    damping: Real,
    links: usize,
    settle: usize,
    seconds: usize,
) -> (Option<usize>, Real, bool) {
    let mesh = ring(27, MAJOR, MINOR);
    let pitch = 2.0 * (MAJOR - MINOR);
    let hang = || {
        let mut world = PhysicsWorld::new();
        let mut rings = Vec::new();
        for i in 0..links {
            let turn = if i % 2 == 0 { Vector::X } else { Vector::Z } * FRAC_PI_2;
            let pose = Pose::new(Vector::new(0.0, -pitch * i as Real, 0.0), turn);
            let body = if i == 0 {
                RigidBodyBuilder::fixed()
            } else {
                RigidBodyBuilder::dynamic()
            };
            let body = body
                .pose(pose)
                .angular_damping(damping)
                .linear_damping(damping);
            rings.push(world.insert(body, collider(&mesh).density(1000.0)).0);
        }
        let pipeline = attached(&mut world);
        (world, pipeline, rings)
    };
    let (mut world, mut pipeline, _) = hang();
    let slept = steps_until_sleep(&mut world, &mut pipeline, settle);
    let (mut world, mut pipeline, rings) = hang();
    for (_, body) in world.bodies.iter_mut() {
        *body.activation_mut() = RigidBodyActivation::cannot_sleep();
    }
    let lowest = *rings.last().expect("links");
    for _ in 0..settle {
        pipeline.step(&mut world);
    }
    let at = world.bodies[lowest].translation();
    let mut moved: Real = 0.0;
    for _ in 0..60 * seconds {
        pipeline.step(&mut world);
        moved = moved.max(world.bodies[lowest].translation().distance(at));
    }
    let lines: Vec<_> = rings
        .iter()
        .map(|h| line(&mesh, world.bodies[*h].position()))
        .collect();
    let linked = lines.windows(2).all(|w| linking(&w[0], &w[1]).abs() == 1);
    (slept, moved, linked)
}

#[test]
fn a_chain_of_four_sleeps() {
    let (slept, _, linked) = chain(&medial, 0.0, 4, 600, 1);
    assert!(slept.is_some() && linked, "{slept:?}");
}

/// Of rapier's compounds none does (`full_chain`).
#[test]
fn a_chain_of_twenty_sleeps() {
    let (slept, moved, linked) = chain(&medial, 0.0, 20, 600, 5);
    println!("slept {slept:?}, moves {moved} m when kept awake");
    assert!(slept.is_some() && linked, "{slept:?}");
}

/// How far to the side a ring that rolls in a fixed one still swings in the last of `seconds`, in units
/// of its first swing.
fn swing(seconds: usize, hooked: bool) -> Real {
    let mesh = ring(27, MAJOR, MINOR);
    let mut world = PhysicsWorld::new();
    let pivot = Vector::new(0.0, -MAJOR, 0.0);
    let tilt = Pose::rotation(Vector::X * 0.4);
    let aside = Pose::from_translation(pivot) * tilt * Pose::from_translation(-pivot);
    let hang = |turn: Vector, down: Real| Pose::new(Vector::new(0.0, -down, 0.0), turn * FRAC_PI_2);
    let fixed = RigidBodyBuilder::fixed().pose(hang(Vector::X, 0.0));
    let dynamic = RigidBodyBuilder::dynamic().pose(aside * hang(Vector::Z, 2.0 * (MAJOR - MINOR)));
    world.insert(fixed, medial(&mesh));
    let ring = world.insert(dynamic.can_sleep(false), medial(&mesh)).0;
    let mut pipeline = attached(&mut world);
    let widest = |world: &mut PhysicsWorld, steps: usize, pipeline: &mut MedialPipeline| {
        let mut widest: Real = 0.0;
        for _ in 0..steps {
            if hooked {
                pipeline.step(world);
            } else {
                world.step();
            }
            widest = widest.max(world.bodies[ring].translation().z.abs());
        }
        widest
    };
    let first = widest(&mut world, 120, &mut pipeline);
    widest(&mut world, 60 * (seconds - 4), &mut pipeline);
    widest(&mut world, 120, &mut pipeline) / first
}

/// Nothing feeds a ring that rolls in another without slip, and nothing but the solver damps it.
#[test]
fn hanging_bodies_do_not_swing_wider() {
    let (hooked, alone) = (swing(20, true), swing(20, false));
    println!("after 20 s {hooked} of the first swing, at rapier's own step {alone}");
    assert!((0.6..1.0).contains(&hooked), "{hooked}");
    assert!(alone > 1.2, "rapier alone: {alone}");
}

/// Hooks of the user that nobody is to call.
struct Never;

impl PhysicsHooks for Never {
    fn filter_contact_pair(&self, _: &PairFilterContext) -> Option<SolverFlags> {
        panic!("nobody asked for it")
    }
    fn modify_solver_contacts(&self, _: &mut ContactModificationContext) {
        panic!("nobody asked for it")
    }
}

/// Contacts that a body hangs in are computed in all but the slowest steps of its swing, those of a ball
/// that rolls as slowly only now and then; and it is the batch that computes them.
#[test]
fn contacts_that_bodies_hang_in_are_computed_anew() {
    let computed = |body: RigidBodyBuilder, mesh: &MedialMesh, on: &MedialMesh| {
        let mut world = PhysicsWorld::new();
        world.insert_collider(medial(on), None);
        world.insert(body.can_sleep(false), medial(mesh));
        let mut pipeline = attached(&mut world);
        let steps = (0..120).map(|_| pipeline.step_with_events(&mut world, &Never, &()));
        steps.fold([0, 0], |[jobs, hits], r| {
            assert_eq!(r.cache_misses, 0);
            [jobs + r.jobs, hits + r.cache_hits as usize]
        })
    };
    let bar = MedialMesh::capsule(Vector::NEG_Z, Vector::Z, 0.1).expect("a bar");
    let down = MAJOR - MINOR - 0.1;
    let aside = Vector::new(0.05, -(down * down - 0.05 * 0.05).sqrt(), 0.0);
    let hanging = RigidBodyBuilder::dynamic().pose(Pose::new(aside, Vector::X * FRAC_PI_2));
    let [jobs, hits] = computed(hanging, &ring(27, MAJOR, MINOR), &bar);
    println!("hangs: {jobs} jobs, {hits} of them asked for");
    assert!(jobs > 100 && hits == jobs, "{jobs} {hits}");
    let ball = MedialMesh::ball(0.3).expect("a ball");
    let plate = MedialMesh::round_plate(1.0, 1.0, 0.1).expect("a plate");
    let rolling = RigidBodyBuilder::dynamic()
        .translation(Vector::Y * 0.4)
        .linvel(Vector::X * 0.015)
        .angvel(Vector::NEG_Z * 0.05);
    let [jobs, hits] = computed(rolling, &ball, &plate);
    println!("rolls: {jobs} jobs, {hits} of them asked for");
    assert!((2..60).contains(&jobs) && hits == jobs, "{jobs} {hits}");
}

/// Of two rings that face each other those contacts are computed, and solved, that can close.
#[test]
fn contacts_that_cannot_close_are_left_out() {
    let mesh = ring(27, MAJOR, MINOR);
    let contacts = |gap: Real, change: &dyn Fn(&mut PhysicsWorld, RigidBodyHandle)| {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        world.insert_collider(medial(&mesh), None);
        let at = Vector::Y * (2.0 * MINOR + gap);
        let body = RigidBodyBuilder::dynamic().translation(at);
        let body = world.insert(body, medial(&mesh)).0;
        let mut pipeline = attached(&mut world);
        change(&mut world, body);
        pipeline.step(&mut world).contacts
    };
    assert_eq!(contacts(0.006, &|_, _| ()), 0);
    assert!(contacts(0.003, &|_, _| ()) > 0);
    let fast = |world: &mut PhysicsWorld, body: RigidBodyHandle| {
        world.bodies[body].set_linvel(Vector::NEG_Y, true);
    };
    // At 1 m/s it closes by 16.7 mm in the step, and is computed again in the next.
    assert!(contacts(0.0165, &fast) > 0);
    // Of what falls, as far as it falls before rapier asks again: when it has come by more than 4 mm.
    for dt in [1.0 / 120.0, 1.0 / 60.0, 1.0 / 30.0] {
        let mut alone = PhysicsWorld::new();
        alone.gravity = Vector::NEG_Y * 9.81;
        alone.integration_parameters.dt = dt;
        let body = alone.insert(RigidBodyBuilder::dynamic(), ColliderBuilder::ball(0.1));
        let mut fallen = 0.0;
        while fallen <= 0.004 {
            alone.step();
            fallen = -alone.bodies[body.0].translation().y;
        }
        println!("{fallen} m in steps of {dt} s");
        let falls = |world: &mut PhysicsWorld, _| {
            world.gravity = Vector::NEG_Y * 9.81;
            world.integration_parameters.dt = dt;
        };
        assert!(contacts(0.97 * fallen, &falls) > 0);
        assert_eq!(contacts(1.1 * fallen, &falls), 0);
    }
    let pushed = |world: &mut PhysicsWorld, body: RigidBodyHandle| {
        let force = Vector::NEG_Y * 50.0 * mesh.mass_properties(1.0).mass();
        world.bodies[body].add_force(force, true);
    };
    // 50 m/s² close by 8.7 mm in four substeps.
    assert!(contacts(0.0085, &pushed) > 0);
    assert_eq!(contacts(0.0095, &pushed), 0);
    // What comes near may push it, whatever its shape; what a joint holds may be pulled by anything.
    let comes = |world: &mut PhysicsWorld, _| {
        let at = Vector::new(MAJOR, 4.0 * MINOR + 0.02, 0.0);
        let body = RigidBodyBuilder::dynamic()
            .translation(at)
            .linvel(Vector::NEG_Y);
        let half = MINOR - 0.01;
        world.insert(body, ColliderBuilder::cuboid(half, half, half));
    };
    assert!(contacts(0.015, &comes) > 0);
    let tied = |world: &mut PhysicsWorld, body| {
        let far = RigidBodyBuilder::dynamic().translation(Vector::Y * 50.0);
        let far = world.insert_body(far);
        let joint = RopeJointBuilder::new(100.0);
        world.impulse_joints.insert(far, body, joint, true);
    };
    assert!(contacts(0.015, &tied) > 0);
}

/// When bodies have come to rest, the solver keeps no contacts that were near only while they moved.
#[test]
fn contacts_of_a_fall_do_not_outlive_it() {
    let mesh = ring(27, MAJOR, MINOR);
    let mut world = PhysicsWorld::new();
    let ground = ColliderBuilder::cuboid(5.0, 0.5, 5.0).translation(Vector::NEG_Y * 0.5);
    world.insert_collider(ground, None);
    for k in 0..6 {
        let at = Vector::new(
            0.1 * (k % 3) as Real,
            0.3 + 0.4 * k as Real,
            0.05 * k as Real,
        );
        let body = RigidBodyBuilder::dynamic()
            .pose(Pose::new(at, Vector::X * 0.2 * k as Real))
            .can_sleep(false);
        world.insert(body, medial(&mesh));
    }
    let mut pipeline = attached(&mut world);
    let widest = |world: &PhysicsWorld| {
        let pairs = world.narrow_phase.contact_pairs();
        let medial = |h: ColliderHandle| {
            world.colliders[h]
                .shape()
                .as_shape::<MedialMesh>()
                .is_some()
        };
        let pairs = pairs.filter(|p| medial(p.collider1) && medial(p.collider2));
        let points = pairs.flat_map(|p| p.manifolds().iter().flat_map(|m| &m.points));
        points.map(|p| p.dist).fold(0.0, Real::max)
    };
    let mut falling: Real = 0.0;
    for _ in 0..120 {
        pipeline.step(&mut world);
        falling = falling.max(widest(&world));
    }
    let jobs = |steps: usize, pipeline: &mut MedialPipeline, world: &mut PhysicsWorld| {
        (0..steps).map(|_| pipeline.step(world).jobs).sum::<usize>()
    };
    jobs(480, &mut pipeline, &mut world);
    let late = jobs(60, &mut pipeline, &mut world);
    // What falls before rapier asks again, by a quarter more.
    let rest = widest(&world);
    println!("{falling} m while falling, {rest} m at rest, {late} jobs in the last second");
    assert!(falling > 0.015 && rest < 1.25 * 0.0062, "{falling} {rest}");
    assert!(late < 60, "{late} jobs");
}

/// A ball near a plate is struck from behind within the step: it comes down on the plate, not into it, or no
/// deeper than a ball of rapier's own that is squeezed by a heavy one.
#[test]
fn body_pushed_by_a_third_meets_its_neighbour() {
    let ball = MedialMesh::ball(0.1).expect("a ball");
    let plate = MedialMesh::round_plate(1.0, 1.0, 0.1).expect("a plate");
    let deepest = |shapes: [ColliderBuilder; 2], gap: Real, speed: Real, heavy: Real| {
        let [plate, ball] = shapes;
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        world.insert_collider(plate, None);
        let mut put = |height: Real, speed: Real, density: Real| {
            let body = RigidBodyBuilder::dynamic()
                .translation(Vector::Y * height)
                .linvel(Vector::NEG_Y * speed);
            world.insert(body, ball.clone().density(density)).0
        };
        let near = put(0.2 + gap, 0.0, 1.0);
        // The push goes through another ball.
        put(0.2 + gap + 0.201, 0.0, 1.0);
        put(0.2 + gap + 0.401 + 0.012, speed, heavy);
        let mut pipeline = attached(&mut world);
        let depth = (0..30).map(|_| {
            pipeline.step(&mut world);
            0.2 - world.bodies[near].translation().y
        });
        depth.fold(Real::MIN, Real::max)
    };
    // Light balls leave a heavy one at twice its speed, if they bounce.
    for (heavy, bounce) in [(1.0, 0.0), (50.0, 0.0), (50.0, 1.0)] {
        for (gap, speed) in [(0.006, 1.0), (0.006, 3.0), (0.009, 3.0), (0.017, 3.0)] {
            // So fast a heavy one is for the event loop, which lets it deeper.
            let speed = if heavy > 1.0 { 0.4 * speed } else { speed };
            let ours = [medial(&plate), medial(&ball)];
            let own = [
                ColliderBuilder::cuboid(1.0, 0.1, 1.0),
                ColliderBuilder::ball(0.1),
            ];
            let [ours, own] =
                [ours, own].map(|s| deepest(s.map(|c| c.restitution(bounce)), gap, speed, heavy));
            println!(
                "gap {gap} m, {speed} m/s, weight {heavy}, bounce {bounce}: {ours} m deep, \
                 rapier's {own}"
            );
            assert!(ours < Real::max(0.001, 1.1 * own), "{ours} {own}");
        }
    }
}

/// What falls, or sinks and falls, towards a plate while rapier keeps that they do not touch has contacts in
/// time: it gets no deeper than a ball of rapier's own.
#[test]
fn body_falling_between_contact_updates_lands_on_its_neighbour() {
    let ball = MedialMesh::ball(0.1).expect("a ball");
    let plate = MedialMesh::round_plate(1.0, 1.0, 0.1).expect("a plate");
    let deepest =
        |[plate, ball]: [ColliderBuilder; 2], gap: Real, speed: Real, [dt, g]: [Real; 2]| {
            let mut world = PhysicsWorld::new();
            world.gravity = Vector::NEG_Y * g;
            world.integration_parameters.dt = dt;
            world.insert_collider(plate, None);
            let body = RigidBodyBuilder::dynamic()
                .translation(Vector::Y * (0.2 + gap))
                .linvel(Vector::NEG_Y * speed);
            let body = world.insert(body, ball).0;
            let mut pipeline = attached(&mut world);
            let depth = (0..20).map(|_| {
                pipeline.step(&mut world);
                0.2 - world.bodies[body].translation().y
            });
            depth.fold(Real::MIN, Real::max)
        };
    let own = || {
        [
            ColliderBuilder::cuboid(1.0, 0.1, 1.0),
            ColliderBuilder::ball(0.1),
        ]
    };
    for (rate, g) in [
        (60.0, 9.81),
        (50.0, 9.81),
        (40.0, 9.81),
        (120.0, 9.81),
        (60.0, 22.0),
        (60.0, 1.0),
    ] {
        let mut worst = [Real::MIN; 2];
        for k in 0..200 {
            let (gap, speed) = (0.004 + 0.0004 * (k % 25) as Real, 0.03 * (k / 25) as Real);
            let step = [1.0 / rate, g];
            let depths = [
                deepest([medial(&plate), medial(&ball)], gap, speed, step),
                deepest(own(), gap, speed, step),
            ];
            worst = [0, 1].map(|k| worst[k].max(depths[k]));
        }
        let [ours, own] = worst;
        println!("{rate} steps a second, {g} m/s²: {ours} m deep, rapier's {own}");
        assert!(ours < own + 5.0e-5, "{rate} {g}: {ours} {own}");
    }
}

/// Answers are found whatever the skins: they are added up as rapier does.
#[test]
fn contact_skins_do_not_miss_the_batch() {
    let ball = MedialMesh::ball(0.1).expect("a ball");
    let plate = MedialMesh::round_plate(1.0, 1.0, 0.1).expect("a plate");
    for skin in [0.005, 0.007, 0.01] {
        let mut world = PhysicsWorld::new();
        world.insert_collider(medial(&plate).contact_skin(skin), None);
        let rolling = RigidBodyBuilder::dynamic()
            .translation(Vector::Y * (0.2 + 2.0 * skin))
            .linvel(Vector::X * 0.5)
            .angvel(Vector::NEG_Z * 5.0);
        world.insert(rolling, medial(&ball).contact_skin(skin));
        let mut pipeline = attached(&mut world);
        let steps = (0..60).map(|_| pipeline.step(&mut world));
        let [hits, misses] = steps.fold([0, 0], |[h, m], r| [h + r.cache_hits, m + r.cache_misses]);
        assert!(
            hits > 30 && misses == 0,
            "{skin}: {hits} hits, {misses} misses"
        );
    }
}

#[test]
#[ignore = "a minute: chains kept awake for 60 s; CI keeps one awake for 5"]
fn full_chain() {
    for (damping, links, settle) in [
        (0.0, 4, 600),
        (0.0, 6, 600),
        (0.5, 6, 600),
        (0.0, 20, 1200),
        (0.5, 20, 1200),
    ] {
        for (name, collider) in [("medial", medial as fn(&_) -> _), ("compound", compound)] {
            let (slept, moved, linked) = chain(&collider, damping, links, settle, 60);
            println!(
                "{links} links, damping {damping}, {name}: sleeps {slept:?}, moves {moved} m, \
                 linked {linked}"
            );
        }
    }
    for links in [5, 8, 10, 12, 14, 16, 18, 22, 25, 28, 30, 35, 40] {
        let (slept, ..) = chain(&medial, 0.0, links, 1200, 0);
        println!("{links} links, damping 0, medial: sleeps {slept:?}");
    }
}
