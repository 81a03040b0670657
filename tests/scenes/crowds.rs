//! Heaps at full size, and thin pillars.
//!
//! The full runs: `cargo test --release --test scenes -- --ignored --nocapture full_heaps`.

use crate::bodies::*;
use crate::fast_pairs::{hook, link, rod};
use crate::heaps::*;
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
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
pub fn compound(mesh: &MedialMesh) -> ColliderBuilder {
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

/// A medial collider.
pub fn medial(mesh: &MedialMesh) -> ColliderBuilder {
    ColliderBuilder::medial_mesh(mesh.clone())
}

/// Speed in m/s from which bodies come to spin so fast that rapier's integration of gyroscopic forces gains
/// energy in free flight (`known_issues`). Beyond it a second heap without these forces judges the energy.
const NO_GYROSCOPES: Real = 100.0;

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

/// An impact closes no contact that touches already, or this heap would have 1,499 of them; and of the many
/// neighbours of the bodies that it moves few are searched, and those not far. Counts, not times. In a heap of
/// 48 links an impact took 45 queries when all pairs of its two bodies were searched to the end of the step.
#[test]
fn an_impact_asks_few_of_its_neighbours() {
    let [_, (_, links, _), ..] = kinds();
    let (mut world, _) = throw(&links, [3, 3, 3], 60.0, 903, medial);
    let mut pipeline = attached(&mut world);
    let [mut events, mut queries, mut pairs] = [0; 3];
    for _ in 0..10 {
        let report = pipeline.step(&mut world);
        events += report.events as u64;
        pairs += report.continuous_jobs as u64;
        queries += report.continuous_queries;
    }
    println!("{events} impacts, {pairs} pairs, {queries} queries");
    assert!(events > 300 && pairs > 500, "{events}, {pairs}");
    assert!(events < 1_200, "{events}");
    assert!(queries < 11 * 1_499, "{queries} queries, {events} impacts");
}

#[test]
#[ignore = "minutes in release: 80 heaps, of which CI runs a few"]
fn full_heaps() {
    for (name, shapes, grid) in kinds() {
        for speed in [5.0, 20.0, 60.0, 150.0] {
            for seed in 801..806 {
                let mut found = heap(&shapes, grid, speed, seed, 120, true);
                println!("{name}, {speed} m/s, seed {seed}: {found:?}");
                if speed > NO_GYROSCOPES {
                    let (mut world, bodies) = throw(&shapes, grid, speed, seed, medial);
                    for (_, body) in world.bodies.iter_mut() {
                        body.enable_gyroscopic_forces(false);
                    }
                    let without = watch(world, &bodies, 120, true);
                    println!("  without gyroscopic forces: {without:?}");
                    check(&without, name);
                    found.energy = without.energy;
                }
                check(&found, name);
            }
        }
    }
}

/// Hooks that lie on each other sleep, most heaps within 500 steps. Of these eight six did not, where the fourth
/// contact of a pair is chosen without a look at how high it is above the others. rapier's compounds do not in 1,500
/// (`full_heaps_sleep`).
#[test]
fn most_heaps_of_hooks_sleep() {
    let [.., (_, hooks, grid), _] = kinds();
    let steps = (2001..2009).map(|seed| {
        let (mut world, _) = throw(&hooks, grid, 5.0, seed, medial);
        let mut pipeline = attached(&mut world);
        steps_until_sleep(&mut world, &mut pipeline, 500)
    });
    let steps: Vec<_> = steps.collect();
    let awake = steps.iter().filter(|s| s.is_none()).count();
    assert!(awake <= 3, "{steps:?}");
}

/// Steps until all sleep, ours and those of rapier's compounds, six seeds each.
#[test]
#[ignore = "minutes in release: prints steps until sleep, for docs/measurements/with-rapier.md"]
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

/// What the steps of a heap cost, nothing asleep: ours, rapier's compounds, and the same medial meshes without
/// the pipeline, step by step in turn.
struct Cost {
    /// Medians and means in milliseconds.
    medians: [f64; 3],
    means: [f64; 3],
    /// Impacts, continuous queries, node pairs and elementary tests a step, and milliseconds of impacts.
    counts: [f64; 5],
}

fn cost((_, shapes, grid): &Kind, speed: Real, seed: u64, steps: std::ops::Range<usize>) -> Cost {
    let (mut ours, _) = throw(shapes, *grid, speed, seed, medial);
    let (mut theirs, _) = throw(shapes, *grid, speed, seed, compound);
    let (mut plain, _) = throw(shapes, *grid, speed, seed, medial);
    for world in [&mut ours, &mut theirs, &mut plain] {
        for (_, body) in world.bodies.iter_mut() {
            *body.activation_mut() = RigidBodyActivation::cannot_sleep();
        }
    }
    let mut pipeline = attached(&mut ours);
    let mut times = [vec![], vec![], vec![]];
    let mut counts = [0.0; 5];
    let count = steps.len() as f64;
    for step in 0..steps.end {
        let clock = Instant::now();
        let report = pipeline.step(&mut ours);
        let a = clock.elapsed();
        theirs.step();
        let b = clock.elapsed();
        plain.step();
        let c = clock.elapsed();
        if !steps.contains(&step) {
            continue;
        }
        for (times, time) in times.iter_mut().zip([a, b - a, c - b]) {
            times.push(time.as_secs_f64() * 1.0e3);
        }
        let counted = [
            report.events as f64,
            report.continuous_queries as f64,
            report.culled_nodes as f64,
            report.elementary_tests as f64,
            report.event_seconds * 1.0e3,
        ];
        (0..5).for_each(|k| counts[k] += counted[k] / count);
    }
    Cost {
        means: times.each_ref().map(|t| t.iter().sum::<f64>() / count),
        medians: times.map(|mut t| *middle(&mut t)),
        counts,
    }
}

fn middle(values: &mut [f64]) -> &f64 {
    values.sort_by(f64::total_cmp);
    &values[values.len() / 2]
}

/// Milliseconds per step, and their ratios to rapier's compounds and to rapier's plain step, over nine heaps:
/// the median of a ratio and between which it lies.
#[test]
#[ignore = "times steps, alone and in release; judges nothing"]
fn full_heaps_cost() {
    for kind in kinds().iter().take(2) {
        for (speed, steps) in [(60.0, 0..60), (5.0, 500..600)] {
            println!("{}, {speed} m/s, steps {steps:?}", kind.0);
            let mut ratios = [vec![], vec![]];
            for seed in 902..911 {
                let Cost {
                    medians,
                    means,
                    counts: [events, queries, nodes, tests, loops],
                } = cost(kind, speed, seed, steps.clone());
                println!(
                    "  medial, compound, medial without the pipeline: {medians:.2?} ms, means {means:.2?}; \
                     a step {events:.0} impacts, {queries:.0} continuous queries, {nodes:.0} node pairs, \
                     {tests:.0} tests, {loops:.2} ms of impacts"
                );
                ratios[0].push(medians[0] / medians[1]);
                ratios[1].push(medians[0] / medians[2]);
            }
            for (mut ratios, to) in ratios.into_iter().zip(["compounds", "rapier's plain step"]) {
                let median = *middle(&mut ratios);
                let [least, .., most] = &ratios[..] else {
                    continue;
                };
                println!("  {median:.2} of {to} ({least:.2} to {most:.2})");
            }
        }
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
