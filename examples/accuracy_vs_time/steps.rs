//! The time step, with and without each effect: rings that fly about in a closed box, elastic and
//! without friction or weight, so that their energy should stay and nothing should pass anything.

use crate::common::random::Random;
use crate::common::skeleton::Skeleton;
use crate::report::{Plot, Point, Section};
use rapier3d::prelude::*;
use rapier3d_medial::error::MeshError;
use rapier3d_medial::prelude::*;
use std::time::Instant;

/// Radii of a ring's centre circle and of its tube, in metres; cones of a ring.
const RING: (Real, Real, usize) = (0.2, 0.03, 27);
/// Half the box's side, in metres.
const BOX: Real = 1.2;
/// Speed of each ring at the start, in metres per second: at 1/30 s three tubes a step.
const SPEED: Real = 6.0;
const RINGS: usize = 16;
const RATES: [u32; 5] = [30, 60, 120, 240, 480];

/// What a run gave.
#[derive(Default)]
struct Outcome {
    milliseconds: f64,
    crossings: usize,
    deepest: Real,
    escaped: usize,
    energy: f64,
}

fn settings() -> [(&'static str, Effects); 8] {
    let all = Effects::default;
    let with = |base: Effects, change: fn(&mut Effects)| {
        let mut effects = base;
        change(&mut effects);
        effects
    };
    [
        ("none", Effects::OFF),
        (
            "continuous",
            with(Effects::OFF, |e| e.continuous = Effect::Auto),
        ),
        ("guard", with(Effects::OFF, |e| e.guard = Effect::Auto)),
        (
            "speculative",
            with(Effects::OFF, |e| e.speculative = Effect::On),
        ),
        ("all, default", all()),
        (
            "default, straight paths",
            with(all(), |e| e.exact_rotation = Effect::Off),
        ),
        (
            "default, one contact",
            with(all(), |e| e.full_manifolds = Effect::Off),
        ),
        ("default, stop", with(all(), |e| e.stop = Effect::On)),
    ]
}

fn run(mesh: &MedialMesh, effects: Effects, rate: u32, seconds: f64) -> Outcome {
    let mut world = PhysicsWorld::default();
    world.gravity = Vector::ZERO;
    world.integration_parameters.dt = 1.0 / rate as Real;
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let mut half = Vector::splat(BOX + 1.0);
            half[axis] = 0.5;
            let mut place = Vector::ZERO;
            place[axis] = side * (BOX + 0.5);
            let wall = ColliderBuilder::cuboid(half.x, half.y, half.z)
                .translation(place)
                .restitution(1.0)
                .friction(0.0);
            world.insert_collider(wall, None);
        }
    }
    let mut options = MedialOptions::default();
    options.effects = effects;
    let mut pipeline = MedialPipeline::new(options);
    pipeline.attach(&mut world);
    let mut random = Random(5);
    let bodies: Vec<_> = (0..RINGS)
        .map(|k| {
            let cell = |n: usize| 0.55 * (n as Real - 1.0);
            let place = Vector::new(cell(k % 3), cell(k / 3 % 3), cell(k / 9));
            let body = RigidBodyBuilder::dynamic()
                .pose(Pose::new(place, random.direction()))
                .linvel(random.direction() * SPEED)
                .angvel(random.direction() * 8.0)
                .can_sleep(false)
                .ccd_enabled(effects.continuous != Effect::Off);
            let ring = ColliderBuilder::medial_mesh(mesh.instance());
            world.insert(body, ring.restitution(1.0).friction(0.0)).0
        })
        .collect();
    let lines = Skeleton::ring(RING.0, RING.1, RING.2 as u32);
    let poses = |world: &PhysicsWorld| -> Vec<Pose> {
        bodies
            .iter()
            .map(|b| *world.bodies[*b].position())
            .collect()
    };
    let energy = |world: &PhysicsWorld| -> f64 {
        bodies
            .iter()
            .map(|b| f64::from(world.bodies[*b].kinetic_energy()))
            .sum()
    };
    let before = energy(&world);
    let mut outcome = Outcome::default();
    for _ in 0..(seconds * f64::from(rate)) as usize {
        let old = poses(&world);
        let start = Instant::now();
        pipeline.step(&mut world);
        outcome.milliseconds += 1.0e3 * start.elapsed().as_secs_f64() / seconds;
        let new = poses(&world);
        for j in 0..RINGS {
            for i in 0..j {
                let crossed = lines.crosses([old[i], new[i]], &lines, [old[j], new[j]]);
                outcome.crossings += usize::from(crossed);
                outcome.deepest = outcome.deepest.max(lines.overlap(&new[i], &lines, &new[j]));
            }
        }
    }
    let outside = |pose: &&Pose| pose.translation.abs().max_element() > BOX;
    outcome.escaped = poses(&world).iter().filter(outside).count();
    outcome.energy = energy(&world) / before - 1.0;
    outcome
}

/// All steps and effects; `seconds` simulated each.
pub fn measure(seconds: f64, progress: &dyn Fn()) -> Result<Section, MeshError> {
    let mesh = MedialMesh::torus(RING.0, RING.1, RING.2)?;
    let mut rows = Vec::new();
    let mut series = Vec::new();
    for (name, effects) in settings() {
        let mut points = Vec::new();
        for rate in RATES {
            let outcome = run(&mesh, effects, rate, seconds);
            rows.push(vec![
                name.to_string(),
                format!("1/{rate}"),
                outcome.crossings.to_string(),
                outcome.escaped.to_string(),
                format!("{:.0}", 100.0 * outcome.deepest),
                format!("{:+.1}", 100.0 * outcome.energy),
                format!("{:.1}", outcome.milliseconds),
            ]);
            points.push(Point {
                label: format!("1/{rate}"),
                time: outcome.milliseconds,
                error: f64::from(100.0 * outcome.deepest).max(0.1),
                default: effects == Effects::default() && rate == 60,
            });
            progress();
        }
        series.push((name.to_string(), points));
    }
    let (major, minor, cones) = RING;
    Ok(Section {
        name: "steps",
        title: "Time step and effects",
        text: format!(
            "{RINGS} rings of {cones} cones, {major} and {minor} m in radius, fly at {SPEED} m/s in a closed \
             box for {seconds} s, elastic, without friction or weight. Missed: inner lines of two rings \
             crossed between one pose and the next; escaped: rings outside the box in the end. Overlap: \
             the deepest of two rings, as a share of their radii (100: inner lines meet). Energy: change \
             of the kinetic energy over the run, which should be none."
        ),
        note: "Longer steps, and straight paths, take less time at the same overlap in this scene.",
        plot: Plot::Front {
            time: "milliseconds per simulated second",
            error: "deepest overlap, % of the radii",
            series,
        },
        head: vec![
            "effects",
            "step s",
            "missed",
            "escaped",
            "overlap %",
            "energy %",
            "ms per simulated s",
        ],
        rows,
    })
}
