//! Bodies that fall on a creature: set up, stepped, timed and audited. What the bodies collide as
//! is the caller's choice, and so is the step.

use super::audit::Audit;
use super::mesh::Mesh;
use super::skeleton::Skeleton;
use rapier3d::prelude::*;
use std::f32::consts::TAU;
use std::time::Instant;

/// A body's true shape.
pub struct Model {
    /// Its surface.
    pub mesh: Mesh,
    /// The same, as parry's shape.
    pub surface: TriMesh,
    /// Its inner lines.
    pub skeleton: Skeleton,
}

impl Model {
    /// Pairs a mesh with its skeleton.
    pub fn new(mesh: Mesh, skeleton: Skeleton) -> Self {
        Self {
            surface: mesh.to_parry(),
            mesh,
            skeleton,
        }
    }
}

/// Equal bodies above a creature that stands on the ground y = 0.
pub struct Scene {
    /// What falls.
    pub ring: Model,
    /// What it falls on, at the origin.
    pub creature: Model,
    /// Where each ring starts, and how fast it spins.
    pub starts: Vec<(Pose, Vector)>,
}

/// What a run of the scene gave.
pub struct Run {
    /// Milliseconds of each step.
    pub milliseconds: Vec<f64>,
    /// Elementary tests of all steps together.
    pub elementary_tests: u64,
    /// Poses of the rings, then of the creature: before the first step and after each.
    pub history: Vec<Vec<Pose>>,
    /// After how many steps all slept.
    pub asleep_after: Option<usize>,
    /// What the true shapes say.
    pub audit: Audit,
}

/// A world with the scene's bodies.
pub struct Stage {
    /// The world to step.
    pub world: PhysicsWorld,
    bodies: Vec<(RigidBodyHandle, ColliderHandle)>,
}

impl Scene {
    /// `count` rings on a spiral above the creature, every next one higher, turned and spun at
    /// random, the same way in every run.
    pub fn new(ring: Model, creature: Model, count: usize) -> Self {
        let mut random = Random(9);
        let starts = (0..count).map(|k| {
            let angle = TAU * 0.618_034 * k as Real;
            let out = 1.35 * ((k as Real + 0.6) / count as Real).sqrt();
            let place = Vector::new(out * angle.cos(), 3.2 + 0.55 * k as Real, out * angle.sin());
            let tilt = random.direction() * random.between(0.0, 1.2);
            let spin = random.direction() * random.between(0.0, 3.0);
            (Pose::new(place, tilt), spin)
        });
        Self {
            starts: starts.collect(),
            ring,
            creature,
        }
    }

    /// A world in which the rings and the creature collide as told.
    pub fn stage(&self, ring: &ColliderBuilder, creature: &ColliderBuilder) -> Stage {
        let mut world = PhysicsWorld::default();
        let ground = ColliderBuilder::cuboid(50.0, 0.5, 50.0).translation(Vector::NEG_Y * 0.5);
        world.insert_collider(ground, None);
        let mut bodies = Vec::new();
        for (pose, spin) in &self.starts {
            let body = RigidBodyBuilder::dynamic()
                .pose(*pose)
                .angvel(*spin)
                .angular_damping(0.5);
            bodies.push(world.insert(body, ring.clone()));
        }
        bodies.push(world.insert(RigidBodyBuilder::fixed(), creature.clone()));
        Stage { world, bodies }
    }

    /// The true shape of a body: rings first, then the creature.
    pub fn model(&self, body: usize) -> &Model {
        if body < self.starts.len() {
            &self.ring
        } else {
            &self.creature
        }
    }

    /// Steps until all sleep, at most `steps` times. `step` returns its number of elementary tests;
    /// only it is timed. `progress` is called after each.
    pub fn run(
        &self,
        mut stage: Stage,
        steps: usize,
        mut step: impl FnMut(&mut PhysicsWorld) -> u64,
        progress: impl Fn(),
    ) -> Run {
        let mut run = Run {
            milliseconds: Vec::new(),
            elementary_tests: 0,
            history: vec![stage.poses()],
            asleep_after: None,
            audit: Audit::default(),
        };
        while run.asleep_after.is_none() && run.milliseconds.len() < steps {
            let start = Instant::now();
            run.elementary_tests += step(&mut stage.world);
            run.milliseconds.push(1.0e3 * start.elapsed().as_secs_f64());
            let (before, after) = (&run.history[run.history.len() - 1], stage.poses());
            run.audit.look(self, &stage, before, &after);
            run.history.push(after);
            run.asleep_after = stage.all_sleep().then_some(run.milliseconds.len());
            progress();
        }
        run.audit
            .count_floating(self, &run.history[run.milliseconds.len()]);
        run
    }
}

impl Stage {
    /// Poses of the rings, then of the creature.
    pub fn poses(&self) -> Vec<Pose> {
        let bodies = self.bodies.iter();
        bodies
            .map(|(body, _)| *self.world.bodies[*body].position())
            .collect()
    }

    /// Which body a collider belongs to, in the order of `poses`; `None` for the ground.
    pub fn body_of(&self, collider: ColliderHandle) -> Option<usize> {
        self.bodies.iter().position(|(_, c)| *c == collider)
    }

    fn all_sleep(&self) -> bool {
        let mut bodies = self.world.bodies.iter();
        bodies.all(|(_, body)| body.is_sleeping() || body.is_fixed())
    }
}

impl Run {
    /// The `share` quantile of the milliseconds per step, over the first `steps`.
    pub fn quantile(&self, steps: usize, share: f64) -> f64 {
        let mut sorted = self.milliseconds[..steps].to_vec();
        sorted.sort_by(f64::total_cmp);
        sorted[((sorted.len() - 1) as f64 * share).round() as usize]
    }

    /// The checks that failed, in words: all rings above the ground, none through another body, all
    /// on something and asleep in the end.
    pub fn failures(&self) -> Vec<String> {
        let mut failures = self.audit.failures();
        if self.asleep_after.is_none() {
            failures.push(format!(
                "not all sleep after {} steps",
                self.milliseconds.len()
            ));
        }
        failures
    }

    /// Poses after a step, or at the end where there were fewer.
    pub fn poses_after(&self, step: usize) -> &[Pose] {
        &self.history[step.min(self.history.len() - 1)]
    }
}

/// SplitMix64 (Steele, Lea, Flood 2014): small, and the same numbers everywhere.
struct Random(u64);

impl Random {
    fn between(&mut self, low: Real, high: Real) -> Real {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        let share = ((z ^ (z >> 31)) >> 40) as Real / (1u64 << 24) as Real;
        low + (high - low) * share
    }

    fn direction(&mut self) -> Vector {
        let y = self.between(-1.0, 1.0);
        let (sin, cos) = self.between(0.0, TAU).sin_cos();
        let across = (1.0 - y * y).sqrt();
        Vector::new(across * cos, y, across * sin)
    }
}
