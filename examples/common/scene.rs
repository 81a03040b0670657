//! Bodies above the ground y = 0, played with one kind of collider after another: set up, stepped,
//! timed and audited.

use super::audit::{Audit, Ghosts};
use super::mesh::Mesh;
use super::progress::bar;
use super::skeleton::Skeleton;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::sync::Arc;
use std::time::Instant;

/// A body's true shape.
pub struct Model {
    /// Its surface.
    pub mesh: Mesh,
    /// The same, as parry's shape.
    pub surface: TriMesh,
    /// Its inner lines.
    pub skeleton: Skeleton,
    /// What it collides as.
    pub medial: MedialMesh,
}

impl Model {
    /// Pairs a mesh with its skeleton and its collider.
    pub fn new(mesh: Mesh, skeleton: Skeleton, medial: MedialMesh) -> Arc<Self> {
        Arc::new(Self {
            surface: mesh.to_parry(),
            mesh,
            skeleton,
            medial,
        })
    }
}

/// What bodies collide as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Medial meshes, stepped by this crate.
    Medial,
    /// Convex hulls of the true meshes: plain rapier.
    Hulls,
    /// Convex parts of the true meshes, by rapier's decomposition: plain rapier.
    Parts,
    /// The true meshes: plain rapier.
    Triangles,
}

impl Kind {
    /// All kinds, with the names that they have as arguments.
    pub const ALL: [(Self, &str); 4] = [
        (Self::Medial, "medial"),
        (Self::Hulls, "hulls"),
        (Self::Parts, "parts"),
        (Self::Triangles, "triangles"),
    ];

    /// The kind that has a name as argument.
    pub fn named(name: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|(_, of)| *of == name);
        let found = found.ok_or(format!("a kind of collider cannot be `{name}`"));
        found.map(|(kind, _)| *kind)
    }

    /// Its name on pictures and in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Medial => "MEDIAL MESHES",
            Self::Hulls => "CONVEX HULLS",
            Self::Parts => "CONVEX PARTS",
            Self::Triangles => "TRIANGLE MESHES",
        }
    }

    fn collider(self, model: &Model) -> ColliderBuilder {
        let Mesh { vertices, indices } = &model.mesh;
        match self {
            Self::Medial => ColliderBuilder::medial_mesh(model.medial.clone()),
            Self::Hulls => ColliderBuilder::convex_hull(vertices).expect("a solid"),
            Self::Parts => ColliderBuilder::convex_decomposition(vertices, indices),
            Self::Triangles => ColliderBuilder::trimesh(vertices.clone(), indices.clone())
                .expect("a mesh with triangles"),
        }
    }
}

/// Colliders of one kind, each made once for all bodies of a model.
struct Shapes {
    kind: Kind,
    made: Vec<(Arc<Model>, ColliderBuilder)>,
}

impl Shapes {
    fn new(kind: Kind) -> Self {
        let made = Vec::new();
        Self { kind, made }
    }

    fn of(&mut self, model: &Arc<Model>) -> ColliderBuilder {
        let known = self.made.iter().find(|(of, _)| Arc::ptr_eq(of, model));
        if let Some((_, collider)) = known {
            return collider.clone();
        }
        let collider = self.kind.collider(model);
        self.made.push((Arc::clone(model), collider.clone()));
        collider
    }
}

/// One body of a scene.
#[derive(Clone)]
pub struct Actor {
    /// Its true shape.
    pub model: Arc<Model>,
    /// How it starts.
    pub start: RigidBodyBuilder,
    /// Red, green, blue.
    pub color: Vector,
}

impl Actor {
    /// A body that starts so.
    pub fn new(model: &Arc<Model>, start: RigidBodyBuilder, color: Vector) -> Self {
        Self {
            model: Arc::clone(model),
            start,
            color,
        }
    }
}

/// Bodies and where they start. The ground is a fixed box, and none of the actors.
pub struct Scene {
    /// The bodies.
    pub actors: Vec<Actor>,
    /// Where the batches of a medial run are computed.
    pub backend: Backend,
}

/// What a run of the scene gave.
pub struct Run {
    /// What the bodies collided as.
    pub kind: Kind,
    /// Milliseconds of each step.
    pub milliseconds: Vec<f64>,
    /// Elementary tests of all steps together.
    pub elementary_tests: u64,
    /// Poses of the actors: before the first step and after each.
    pub history: Vec<Vec<Pose>>,
    /// Ghost contacts of each step, in world space.
    pub ghosts: Vec<Vec<Vector>>,
    /// After how many steps all slept.
    pub asleep_after: Option<usize>,
    /// What the true shapes say.
    pub audit: Audit,
}

/// A world with the scene's bodies.
pub struct Stage {
    /// The world to step.
    pub world: PhysicsWorld,
    /// The actors in it.
    pub bodies: Vec<(RigidBodyHandle, ColliderHandle)>,
    /// What steps it, where bodies are medial.
    pub pipeline: Option<MedialPipeline>,
}

impl Stage {
    /// Poses of the actors.
    pub fn poses(&self) -> Vec<Pose> {
        let bodies = self.bodies.iter();
        bodies
            .map(|(body, _)| *self.world.bodies[*body].position())
            .collect()
    }

    /// Which actor a collider belongs to; `None` for the ground.
    pub fn actor_of(&self, collider: ColliderHandle) -> Option<usize> {
        self.bodies.iter().position(|(_, c)| *c == collider)
    }

    /// Steps the world: with this crate where bodies are medial, else with rapier alone.
    pub fn step(&mut self) -> StepReport {
        match &mut self.pipeline {
            Some(pipeline) => pipeline.step(&mut self.world),
            None => {
                self.world.step();
                StepReport::default()
            }
        }
    }

    /// What all actors call for, in a medial stage.
    pub fn set_effects(&mut self, effects: Effects) {
        if let Some(pipeline) = &mut self.pipeline {
            let colliders = self.bodies.iter().map(|(_, collider)| *collider);
            colliders.for_each(|collider| pipeline.set_effects(collider, effects));
        }
    }

    fn all_sleep(&self) -> bool {
        let mut bodies = self.world.bodies.iter();
        bodies.all(|(_, body)| body.is_sleeping() || !body.is_dynamic())
    }
}

impl Scene {
    /// A scene of these bodies, on the CPU.
    pub fn new(actors: Vec<Actor>) -> Self {
        Self {
            actors,
            backend: Backend::Cpu,
        }
    }

    /// A world in which the actors collide as told.
    pub fn stage(&self, kind: Kind) -> Stage {
        let mut world = PhysicsWorld::default();
        let ground = ColliderBuilder::cuboid(50.0, 0.5, 50.0).translation(Vector::NEG_Y * 0.5);
        world.insert_collider(ground, None);
        let mut shapes = Shapes::new(kind);
        let mut place = |actor: &Actor| world.insert(actor.start.clone(), shapes.of(&actor.model));
        let bodies = self.actors.iter().map(&mut place).collect();
        let mut options = MedialOptions::default();
        options.backend = self.backend;
        let mut pipeline = (kind == Kind::Medial).then(|| MedialPipeline::new(options));
        if let Some(pipeline) = &mut pipeline {
            pipeline.attach(&mut world);
        }
        Stage {
            world,
            bodies,
            pipeline,
        }
    }

    /// A body more, in a stage of a kind that plays.
    pub fn add(&mut self, actor: Actor, kind: Kind, stage: &mut Stage) {
        let collider = kind.collider(&actor.model);
        let body = stage.world.insert(actor.start.clone(), collider);
        stage.bodies.push(body);
        self.actors.push(actor);
    }

    /// A world in which the actors collide as told and go on from where they are in another.
    pub fn stage_from(&self, kind: Kind, last: &Stage) -> Stage {
        let mut stage = self.stage(kind);
        for ((body, _), (from, _)) in stage.bodies.iter().zip(&last.bodies) {
            let (body, from) = (&mut stage.world.bodies[*body], &last.world.bodies[*from]);
            body.set_position(*from.position(), true);
            body.set_linvel(from.linvel(), true);
            body.set_angvel(from.angvel(), true);
        }
        stage
    }

    /// Steps until all sleep, at most `steps` times. `before_step` may act on the stage, and gets
    /// the number of steps taken. Only the steps themselves are timed.
    pub fn run(
        &self,
        kind: Kind,
        steps: usize,
        mut before_step: impl FnMut(&mut Stage, usize),
    ) -> Run {
        let bar = bar(kind.name(), steps);
        let mut stage = self.stage(kind);
        let mut run = Run {
            kind,
            milliseconds: Vec::new(),
            elementary_tests: 0,
            history: vec![stage.poses()],
            ghosts: vec![Vec::new()],
            asleep_after: None,
            audit: Audit::default(),
        };
        while run.asleep_after.is_none() && run.milliseconds.len() < steps {
            before_step(&mut stage, run.milliseconds.len());
            let start = Instant::now();
            run.elementary_tests += stage.step().elementary_tests;
            run.milliseconds.push(1.0e3 * start.elapsed().as_secs_f64());
            let (before, after) = (&run.history[run.history.len() - 1], stage.poses());
            let Ghosts(ghosts) = run.audit.look(self, &stage, before, &after);
            run.ghosts.push(ghosts);
            run.history.push(after);
            run.asleep_after = stage.all_sleep().then_some(run.milliseconds.len());
            bar.inc(1);
        }
        let last = &run.history[run.milliseconds.len()];
        run.audit.count_floating(self, last);
        bar.finish();
        run
    }
}

impl Run {
    /// The `share` quantile of the milliseconds per step, over the first `steps`.
    pub fn quantile(&self, steps: usize, share: f64) -> f64 {
        let mut sorted = self.milliseconds[..steps].to_vec();
        sorted.sort_by(f64::total_cmp);
        sorted[((sorted.len() - 1) as f64 * share).round() as usize]
    }

    /// The checks that failed, in words: all bodies above the ground, none through another, all
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
