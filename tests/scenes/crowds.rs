//! Heaps at full size, chains that hang, and thin pillars.
//!
//! The full runs: `cargo test --release --test scenes -- --ignored --nocapture full_heaps full_chain`.

use crate::bodies::*;
use crate::fast_pairs::{hook, link, rod};
use crate::heaps::*;
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::f32::consts::FRAC_PI_2;
use std::time::Instant;

/// Three corners with one slab.
fn slab() -> MedialMesh {
    let corners = [[-0.3, -0.2], [0.35, -0.1], [0.0, 0.4]];
    let spheres = corners.map(|[x, z]| MedialSphere::new(Vector::new(x, 0.0, z), 0.06));
    MedialMesh::new(spheres.to_vec(), vec![], vec![[0, 1, 2]]).expect("a slab")
}

type Kind = (&'static str, Vec<MedialMesh>, [usize; 3]);

fn kinds() -> [Kind; 4] {
    let ring = || ring(12, 0.4, 0.08);
    [
        ("36 rings", vec![ring()], [4, 3, 3]),
        ("48 links", vec![link()], [4, 3, 4]),
        ("60 hooks", vec![hook()], [5, 3, 4]),
        ("48 mixed", vec![ring(), link(), hook(), slab()], [4, 3, 4]),
    ]
}

/// The same bodies as rapier's compounds: a capsule for each cone, of its mean radius.
fn compound(mesh: &MedialMesh) -> ColliderBuilder {
    let capsule = |e: &[u32; 2]| {
        let [a, b] = e.map(|i| mesh.spheres()[i as usize]);
        let radius = 0.5 * (a.radius + b.radius);
        (
            Pose::IDENTITY,
            SharedShape::capsule(a.center, b.center, radius),
        )
    };
    ColliderBuilder::compound(mesh.edges().iter().map(capsule).collect())
}

fn medial(mesh: &MedialMesh) -> ColliderBuilder {
    ColliderBuilder::medial_mesh(mesh.clone())
}

fn check(found: &Findings, what: &str) {
    assert_eq!(found.wrong_links, 0, "{what}");
    assert!(
        found.depth < 0.75 && found.energy < 1.005,
        "{what}: {found:?}"
    );
}

#[test]
fn heaps_with_hooks_and_slabs_do_not_cross() {
    let [.., (_, hooks, _), (_, mixed, _)] = kinds();
    for (shapes, speed) in [(&hooks, 20.0), (&mixed, 60.0), (&mixed, 150.0)] {
        let found = heap(shapes, [3, 2, 2], speed, 701, 60, true);
        println!("{speed} m/s: {found:?}");
        check(&found, &format!("{speed} m/s"));
    }
    let alone = heap(&mixed, [3, 2, 2], 60.0, 701, 60, false);
    assert!(
        alone.depth > 0.9 || alone.wrong_links > 0,
        "rapier alone: {alone:?}"
    );
}

#[test]
#[ignore = "minutes"]
fn full_heaps() {
    for (name, shapes, grid) in kinds() {
        for speed in [5.0, 20.0, 60.0, 150.0] {
            for seed in 801..806 {
                let found = heap(&shapes, grid, speed, seed, 120, true);
                println!("{name}, {speed} m/s, seed {seed}: {found:?}");
                check(&found, name);
            }
        }
    }
}

/// Steps until all sleep, ours and those of rapier's compounds, six seeds each.
#[test]
#[ignore = "minutes"]
fn full_heaps_sleep() {
    for (name, shapes, grid) in kinds().into_iter().take(3) {
        let mut steps = [vec![], vec![]];
        for seed in 901..907 {
            let (mut ours, _) = throw(&shapes, grid, 5.0, seed, medial);
            let mut pipeline = attached(&mut ours);
            steps[0].push(steps_until_sleep(&mut ours, &mut pipeline, 1500));
            let (mut theirs, _) = throw(&shapes, grid, 5.0, seed, compound);
            let asleep = |w: &PhysicsWorld| w.bodies.iter().all(|(_, b)| b.is_sleeping());
            let compounds = (0..1500).position(|_| {
                theirs.step();
                asleep(&theirs)
            });
            steps[1].push(compounds);
        }
        let [ours, compounds] = steps;
        println!("{name}: {ours:?} steps, compounds {compounds:?}");
    }
}

/// Milliseconds per step beside rapier's compounds in the same run, step by step in turn.
#[test]
#[ignore = "a measurement"]
fn full_heaps_cost() {
    for (name, shapes, grid) in kinds().into_iter().take(2) {
        for (speed, skipped, steps) in [(60.0, 0, 60), (5.0, 500, 100)] {
            let (mut ours, _) = throw(&shapes, grid, speed, 902, medial);
            let (mut theirs, _) = throw(&shapes, grid, speed, 902, compound);
            let (mut plain, _) = throw(&shapes, grid, speed, 902, medial);
            for world in [&mut ours, &mut theirs, &mut plain] {
                for (_, body) in world.bodies.iter_mut() {
                    *body.activation_mut() = RigidBodyActivation::cannot_sleep();
                }
            }
            let mut pipeline = attached(&mut ours);
            let mut times = [vec![], vec![], vec![]];
            for step in 0..skipped + steps {
                let clock = Instant::now();
                pipeline.step(&mut ours);
                let a = clock.elapsed();
                theirs.step();
                let b = clock.elapsed();
                plain.step();
                let c = clock.elapsed();
                if step >= skipped {
                    let all = [a, b - a, c - b].map(|t| t.as_secs_f64() * 1.0e3);
                    (0..3).for_each(|k| times[k].push(all[k]));
                }
            }
            let [a, b, c] = times.map(|mut t| {
                t.sort_by(f64::total_cmp);
                t[t.len() / 2]
            });
            println!(
                "{name}, {speed} m/s, steps {skipped} to {}: medial {a:.2} ms, compound {b:.2}, \
                 medial without the pipeline {c:.2}: ratios {:.2} and {:.2}",
                skipped + steps,
                a / b,
                a / c
            );
        }
    }
}

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
fn what_swings_does_not_swing_wider() {
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
    assert_eq!(contacts(0.012, &|_, _| ()), 0);
    assert!(contacts(0.008, &|_, _| ()) > 0);
    let fast = |world: &mut PhysicsWorld, body: RigidBodyHandle| {
        world.bodies[body].set_linvel(Vector::NEG_Y, true);
    };
    assert!(contacts(0.018, &fast) > 0);
    // In a sixtieth of a second a body falls by 3 mm, in a thirtieth by 11.
    let falls = |world: &mut PhysicsWorld, _| world.gravity = Vector::NEG_Y * 9.81;
    assert_eq!(contacts(0.014, &falls), 0);
    assert!(contacts(0.011, &falls) > 0);
    let falls_longer = |world: &mut PhysicsWorld, _| {
        world.gravity = Vector::NEG_Y * 9.81;
        world.integration_parameters.dt = 1.0 / 30.0;
    };
    assert!(contacts(0.018, &falls_longer) > 0);
    let pushed = |world: &mut PhysicsWorld, body: RigidBodyHandle| {
        let force = Vector::NEG_Y * 50.0 * mesh.mass_properties(1.0).mass();
        world.bodies[body].add_force(force, true);
    };
    assert!(contacts(0.018, &pushed) > 0);
}

/// A ball near a plate is struck from behind within the step: it comes down on the plate, not into it.
#[test]
fn what_a_third_body_pushes_meets_what_is_near() {
    let ball = MedialMesh::ball(0.1).expect("a ball");
    let plate = MedialMesh::round_plate(1.0, 1.0, 0.1).expect("a plate");
    for (gap, speed) in [(0.006, 1.0), (0.006, 3.0), (0.009, 3.0)] {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        world.insert_collider(medial(&plate), None);
        let mut put = |height: Real, speed: Real| {
            let body = RigidBodyBuilder::dynamic()
                .translation(Vector::Y * height)
                .linvel(Vector::NEG_Y * speed);
            world.insert(body, medial(&ball)).0
        };
        let near = put(0.2 + gap, 0.0);
        put(0.2 + gap + 0.2 + 0.012, speed);
        let mut pipeline = attached(&mut world);
        let depth = (0..30).map(|_| {
            pipeline.step(&mut world);
            0.2 - world.bodies[near].translation().y
        });
        let deepest = depth.fold(Real::MIN, Real::max);
        println!("gap {gap} m, {speed} m/s: {deepest} m deep");
        assert!(deepest < 0.001, "{gap} {speed}: {deepest}");
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
#[ignore = "a minute"]
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

/// The paper's first benchmark: five shapes fall on a grate of pillars 5 mm thin, whose gaps are narrower
/// than any of them. All stay above.
#[test]
fn five_shapes_fall_on_thin_pillars() {
    let shapes = [ring(12, 0.4, 0.08), link(), hook(), rod(), slab()];
    let ends = [-2.0, 2.0].map(|z| MedialSphere::new(Vector::new(0.0, 0.0, z), 0.0025));
    let pillar = MedialMesh::new(ends.to_vec(), vec![[0, 1]], vec![]).expect("a pillar");
    let below = |shape: &MedialMesh, seed: u64, speed: Real, hooked: bool| {
        let mut random = Random(seed);
        let mut world = PhysicsWorld::new();
        for i in -30..=30 {
            let at = Vector::new(0.065 * i as Real, 0.0, 0.0);
            world.insert_collider(medial(&pillar).translation(at), None);
        }
        let turn = random.direction() * random.within(0.0, 3.0);
        let pose = Pose::new(Vector::new(0.0, random.within(1.0, 2.0), 0.0), turn);
        let body = RigidBodyBuilder::dynamic()
            .pose(pose)
            .linvel(Vector::new(0.0, -speed, 0.0))
            .angvel(random.direction() * random.within(0.0, 20.0));
        let handle = world.insert(body, medial(shape)).0;
        let mut pipeline = attached(&mut world);
        (0..12).any(|_| {
            if hooked {
                pipeline.step(&mut world);
            } else {
                world.step();
            }
            let pose = *world.bodies[handle].position();
            shape.spheres().iter().any(|s| (pose * s.center).y < 0.0)
        })
    };
    for (k, shape) in shapes.iter().enumerate() {
        for seed in 0..6 {
            let speed = [20.0, 60.0, 120.0][seed as usize % 3];
            assert!(
                !below(shape, 7100 + seed, speed, true),
                "shape {k}, seed {seed}"
            );
        }
    }
}
