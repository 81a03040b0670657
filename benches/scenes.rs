//! Whole scenes beside rapier's own shapes: what a step costs while bodies fall, when they are spawned in one place,
//! and when nothing happens at all.
//!
//! ```text
//! cargo bench --bench scenes                # minutes
//! cargo bench --bench scenes -- spawned     # the scenes whose name has the word
//! ```
//!
//! Every kind of collider gets the same bodies at the same places, of the same mass, and rapier's defaults. The kinds
//! take turns, three times; a step counts with the least of its three times. Bodies of different kinds fall
//! differently, so all but the first steps are scenes of equal numbers.

mod common;
mod torus;

use common::{Hash, median, processor};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::f32::consts::TAU;
use std::time::Instant;
use torus::{MAJOR, MINOR, ring, surface};

/// Turns of each kind.
const TURNS: usize = 3;
/// Cones of a ring, and capsules of its compound.
const PARTS: u32 = 24;
/// Milliseconds of a frame.
const FRAME: f64 = 1000.0 / 60.0;

/// What a ring is, and how its world is stepped.
#[derive(Clone, Copy)]
enum Kind {
    /// A medial mesh with these effects.
    Medial(Effects),
    /// A medial mesh with the options for games.
    Games,
    /// A compound of as many capsules.
    Capsules,
    /// The same, which rapier sweeps.
    CapsulesSwept,
    /// rapier's convex decomposition.
    Decomposition,
    Hull,
}

fn kinds() -> Vec<(&'static str, Kind)> {
    let auto = Effects::default();
    let without = auto.continuous(Effect::Off);
    vec![
        ("medial", Kind::Medial(auto)),
        ("`MedialOptions::games`", Kind::Games),
        ("without `continuous`", Kind::Medial(without)),
        ("all effects off", Kind::Medial(Effects::OFF)),
        ("compound of capsules", Kind::Capsules),
        ("the same, `ccd_enabled`", Kind::CapsulesSwept),
        ("VHACD", Kind::Decomposition),
        ("hull", Kind::Hull),
    ]
}

impl Kind {
    fn shape(self) -> SharedShape {
        let (points, triangles) = surface();
        match self {
            Kind::Medial(_) | Kind::Games => SharedShape::medial_mesh(ring(PARTS)),
            Kind::Capsules | Kind::CapsulesSwept => {
                let end = |k: u32| {
                    let (sin, cos) = (TAU * k as Real / PARTS as Real).sin_cos();
                    Vector::new(cos, 0.0, sin) * MAJOR as Real
                };
                let part = |k| SharedShape::capsule(end(k), end(k + 1), MINOR as Real);
                SharedShape::compound((0..PARTS).map(|k| (Pose::IDENTITY, part(k))).collect())
            }
            Kind::Decomposition => SharedShape::convex_decomposition(&points, &triangles),
            Kind::Hull => SharedShape::convex_hull(&points).expect("a hull of a torus"),
        }
    }
}

/// A world and how it is stepped.
struct Run {
    world: PhysicsWorld,
    pipeline: Option<MedialPipeline>,
}

impl Run {
    fn new(kind: Kind) -> Self {
        let world = PhysicsWorld::default();
        let options = match kind {
            Kind::Medial(effects) => MedialOptions::default().effects(effects),
            Kind::Games => MedialOptions::games(),
            _ => {
                return Self {
                    world,
                    pipeline: None,
                };
            }
        };
        let pipeline = Some(MedialPipeline::new(options));
        let mut run = Self { world, pipeline };
        run.attach();
        run
    }

    fn attach(&mut self) {
        let pipeline = self.pipeline.get_or_insert_default();
        pipeline.attach(&mut self.world);
    }

    fn step(&mut self) {
        match &mut self.pipeline {
            Some(pipeline) => drop(pipeline.step(&mut self.world)),
            None => self.world.step(),
        }
    }

    fn hash(&self) -> String {
        let mut hash = Hash::new();
        for (_, body) in self.world.bodies.iter() {
            for x in body.translation().to_array() {
                hash.add(x.to_bits().into());
            }
        }
        hash.short()
    }

    /// Rings at poses, all of the same mass.
    fn rings(&mut self, kind: Kind, poses: impl Iterator<Item = (Pose, Vector)>) {
        let mass = ring(PARTS).mass_properties(1000.0);
        let collider = ColliderBuilder::new(kind.shape()).density(0.0);
        for (pose, velocity) in poses {
            let body = RigidBodyBuilder::dynamic()
                .pose(pose)
                .linvel(velocity)
                .ccd_enabled(matches!(kind, Kind::CapsulesSwept))
                .additional_mass_properties(mass);
            self.world.insert(body, collider.clone());
        }
    }

    fn ground(&mut self) {
        let ground = ColliderBuilder::cuboid(50.0, 0.5, 50.0).translation(Vector::NEG_Y * 0.5);
        self.world.insert_collider(ground, None);
    }

    /// Walls of a square pen of this half width.
    fn pen(&mut self, half: Real) {
        for axis in [Vector::X, Vector::NEG_X, Vector::Z, Vector::NEG_Z] {
            let along = Vector::new(axis.z.abs(), 0.0, axis.x.abs());
            let half_sides = axis.abs() * 0.5 + along * 50.0 + Vector::Y * 60.0;
            let wall = ColliderBuilder::cuboid(half_sides.x, half_sides.y, half_sides.z);
            self.world
                .insert_collider(wall.translation(axis * (half + 0.5)), None);
        }
    }
}

/// A scene of rings.
struct Scene {
    name: String,
    steps: usize,
    build: Box<dyn Fn(Kind) -> Run>,
}

/// Rings all spawned at the same place, tilted one by one.
fn spawned(count: usize) -> Scene {
    let build = move |kind| {
        let mut run = Run::new(kind);
        run.ground();
        let pose = |k: usize| {
            let tilt = Vector::new(0.7 * k as Real, 0.3, 0.2 * k as Real);
            (Pose::new(Vector::Y * 2.0, tilt), Vector::ZERO)
        };
        run.rings(kind, (0..count).map(pose));
        run
    };
    Scene {
        name: format!("spawned in one place: {count} rings"),
        steps: 60,
        build: Box::new(build),
    }
}

/// Rings that fall into a pen, in layers.
fn pen(count: usize, speed: Real, steps: usize) -> Scene {
    let build = move |kind| {
        let mut run = Run::new(kind);
        run.ground();
        let side = if count > 100 { 6 } else { 3 };
        run.pen(0.75 * side as Real);
        let pose = |k: usize| {
            let at = |i: usize| (i as Real - 0.5 * (side - 1) as Real) * 1.4;
            let (layer, place) = (k / (side * side), k % (side * side));
            let height = 1.6 + 0.9 * layer as Real;
            let center = Vector::new(at(place % side), height, at(place / side));
            let tilt = Vector::new(0.3, 0.0, 0.2) * ((k % 7) as Real - 3.0);
            (Pose::new(center, tilt), Vector::NEG_Y * speed)
        };
        run.rings(kind, (0..count).map(pose));
        run
    };
    Scene {
        name: format!("falling into a pen at {speed} m/s: {count} rings"),
        steps,
        build: Box::new(build),
    }
}

/// What every step of a kind took, in milliseconds, and how it ended.
struct Times {
    steps: Vec<f64>,
    hash: String,
}

fn turn(mut run: Run, steps: usize) -> Times {
    let step = |_| {
        let start = Instant::now();
        run.step();
        1e3 * start.elapsed().as_secs_f64()
    };
    let steps = (0..steps).map(step).collect();
    let hash = run.hash();
    Times { steps, hash }
}

/// Turns of every kind; of each step the least time.
fn in_turns(runs: &[&dyn Fn() -> Run], steps: usize) -> Vec<Times> {
    let mut all: Vec<Option<Times>> = runs.iter().map(|_| None).collect();
    for _ in 0..TURNS {
        for (run, least) in runs.iter().zip(&mut all) {
            let now = turn(run(), steps);
            match least {
                None => *least = Some(now),
                Some(least) => {
                    let both = least.steps.iter_mut().zip(&now.steps);
                    both.for_each(|(least, now)| *least = least.min(*now));
                }
            }
        }
    }
    all.into_iter().flatten().collect()
}

/// Mean, median, 99th percentile and largest, and how many are longer than a frame.
fn row(name: &str, times: &Times) {
    let mut sorted = times.steps.clone();
    let middle = median(&mut sorted);
    let n = sorted.len();
    println!(
        "{name:<26}{:>9.3}{middle:>9.3}{:>9.3}{:>9.3}{:>7}  {}",
        sorted.iter().sum::<f64>() / n as f64,
        sorted[(n * 99).div_ceil(100) - 1],
        sorted[n - 1],
        sorted.iter().filter(|t| **t > FRAME).count(),
        times.hash,
    );
}

fn title(name: &str, steps: usize) {
    println!(
        "\n{name}, {steps} steps\n{:<26}{:>9}{:>9}{:>9}{:>9}{:>7}  hash",
        "ms a step", "mean", "median", "p99", "most", "slow"
    );
}

/// Bodies without any medial collider, by rapier's step and with the pipeline round it.
fn attached() {
    let boxes = |attach: bool| {
        let mut run = Run::new(Kind::Hull);
        run.ground();
        let shape = ColliderBuilder::cuboid(0.2, 0.2, 0.2);
        for k in 0..800 {
            let at = |i: usize| 0.5 * (i % 9) as Real;
            let body = RigidBodyBuilder::dynamic()
                .translation(Vector::new(at(k), 0.5 + 0.45 * (k / 81) as Real, at(k / 9)))
                .can_sleep(false);
            run.world.insert(body, shape.clone());
        }
        if attach {
            run.attach();
        }
        run
    };
    let steps = 240;
    let times = in_turns(&[&|| boxes(false), &|| boxes(true)], steps);
    title("no medial collider: 800 boxes falling", steps);
    row("rapier's step", &times[0]);
    row("with the pipeline", &times[1]);
}

/// Fixed medial colliders, and nothing that moves.
fn idle() {
    let fixed = |medial: bool| {
        let kind = match medial {
            true => Kind::Medial(Effects::default()),
            false => Kind::Capsules,
        };
        let mut run = Run::new(kind);
        let collider = ColliderBuilder::new(kind.shape());
        for k in 0..10_000 {
            let at = Vector::new((k % 100) as Real, 0.0, (k / 100) as Real);
            run.world
                .insert_collider(collider.clone().translation(at), None);
        }
        run
    };
    let steps = 60;
    let times = in_turns(&[&|| fixed(false), &|| fixed(true)], steps);
    title("nothing moves: 10,000 fixed rings", steps);
    row("compounds of capsules", &times[0]);
    row("medial", &times[1]);
}

fn main() {
    let word = std::env::args().skip(1).find(|a| !a.starts_with("--"));
    let wanted = |name: &str| {
        word.as_ref()
            .is_none_or(|word| name.contains(word.as_str()))
    };
    println!("{}", processor());
    if wanted("attached") {
        attached();
    }
    if wanted("idle") {
        idle();
    }
    let scenes = [
        spawned(8),
        spawned(12),
        pen(30, 0.0, 240),
        pen(36, 5.0, 240),
        pen(100, 0.0, 240),
        pen(500, 0.0, 360),
    ];
    for scene in scenes.iter().filter(|scene| wanted(&scene.name)) {
        title(&scene.name, scene.steps);
        let kinds = kinds();
        let build = &scene.build;
        let runs: Vec<_> = kinds.iter().map(|(_, kind)| move || build(*kind)).collect();
        let runs: Vec<&dyn Fn() -> Run> = runs.iter().map(|run| run as _).collect();
        let times = in_turns(&runs, scene.steps);
        for ((name, _), times) in kinds.iter().zip(&times) {
            row(name, times);
        }
    }
}
