//! Falling rings for a page in the browser: the scene of the example `falling_rings` as a class of
//! JavaScript. A device opened by `open_device` goes from stage to stage. Poses and meshes go out as flat arrays, which
//! `site/renderer.js` draws.

#[path = "../../examples/common/mod.rs"]
mod common;
mod dropped;
mod state;

use common::creature::creature;
use common::falling::{falling_on, falling_ring};
use common::mesh::Mesh;
use common::scene::{Actor, Kind, Model, Scene, Stage};
use common::scene_strip::rainbow;
use common::skeleton::Skeleton;
use common::surfaces::surface;
use dropped::Dropped;
use rapier3d::prelude::{RigidBodyBuilder, SharedShape, Vector};
use rapier3d_medial::batch::Batch;
use rapier3d_medial::batch::gpu::{Gpu, GpuOptions};
use rapier3d_medial::{
    Backend, BuildOptions, Effect, Effects, MedialMesh, MedialPipeline, StepReport,
};
use state::state_hash;
use std::sync::Arc;
use wasm_bindgen::prelude::*;

/// Bodies that fall, at the start.
const COUNT: usize = 15;
/// The most that the user may throw besides.
const THROWN: usize = 40;
/// Speed (m/s) of what is thrown.
const SPEED: f32 = 16.0;

/// A world of rings, or of bodies of the user's, above the creature, and those that the user threw.
#[wasm_bindgen]
pub struct Demo {
    scene: Scene,
    ring: Arc<Model>,
    /// What falls, and what it falls on.
    models: [Arc<Model>; 2],
    stage: Stage,
    kind: Kind,
    effects: Effects,
    report: StepReport,
    /// Whether batches are to go to the device.
    on_gpu: bool,
    /// The device, while the stage does not have it.
    device: Option<Batch>,
    settled_by_gpu: u64,
}

/// Builds the medial mesh of a ring or of the creature, of so many primitives at most, as a baked file.
#[wasm_bindgen]
pub fn bake(name: &str, primitives: usize) -> Result<Vec<u8>, JsError> {
    let (mesh, _) = match name {
        "ring" => falling_ring(),
        "creature" => creature(),
        _ => return Err(JsError::new(&format!("no body is called `{name}`"))),
    };
    let options = BuildOptions {
        primitives: Some(primitives),
        ..Default::default()
    };
    let (medial, _) = MedialMesh::from_trimesh(&mesh.vertices, &mesh.indices, &options)?;
    Ok(medial.to_bytes())
}

/// Triangles of a body, in its own frame.
#[wasm_bindgen]
pub struct Surface(Mesh);

#[wasm_bindgen]
impl Surface {
    /// Coordinates x, y, z of each vertex.
    pub fn vertices(&self) -> Vec<f32> {
        flat(&self.0.vertices)
    }

    /// Unit normals of the vertices.
    pub fn normals(&self) -> Vec<f32> {
        flat(&self.0.normals())
    }

    /// Three vertices to a triangle.
    pub fn indices(&self) -> Vec<u32> {
        self.0.indices.as_flattened().to_vec()
    }
}

#[wasm_bindgen]
impl Demo {
    /// From baked meshes of a ring and of the creature.
    #[wasm_bindgen(constructor)]
    pub fn new(ring: &[u8], animal: &[u8], kind: &str) -> Result<Demo, JsError> {
        let kind = Kind::named(kind).map_err(|e| JsError::new(&e))?;
        let (mesh, lines) = falling_ring();
        let ring = Model::new(mesh, lines, MedialMesh::from_bytes(ring)?);
        let (mesh, lines) = creature();
        let animal = Model::new(mesh, lines, MedialMesh::from_bytes(animal)?);
        let scene = falling_on(Arc::clone(&animal), &ring, COUNT);
        Ok(Self {
            stage: scene.stage(kind),
            scene,
            models: [Arc::clone(&ring), animal],
            ring,
            kind,
            effects: Effects::default(),
            report: StepReport::default(),
            on_gpu: false,
            device: None,
            settled_by_gpu: 0,
        })
    }

    /// Opens a WebGPU device; whether it is more than code on the CPU. An error says why there is none.
    pub async fn open_device(&mut self) -> Result<bool, JsError> {
        let options = GpuOptions {
            software: true,
            ..GpuOptions::default()
        };
        let batch = Batch::open_async(Backend::Gpu, options).await;
        if let Some(error) = &batch.report().error {
            return Err(JsError::new(&error.to_string()));
        }
        let hardware = batch.gpu().is_some_and(Gpu::is_hardware);
        self.device = Some(batch);
        Ok(hardware)
    }

    /// Whether batches are to go to the device, if there is one; from the next step on.
    pub fn set_gpu(&mut self, on: bool) {
        self.on_gpu = on;
        self.take_device();
        self.lend_device();
    }

    /// Whether the device serves.
    pub fn on_gpu(&self) -> bool {
        self.batch().is_some_and(Batch::has_device)
    }

    /// Why the device has failed, if it has.
    pub fn device_error(&self) -> Option<String> {
        let error = self.batch()?.report().error.as_ref()?;
        Some(error.to_string())
    }

    /// Before a step: asks the device about its contacts, and waits for the answers without blocking.
    pub async fn prepare(&mut self) {
        if let Some(pipeline) = &mut self.stage.pipeline {
            pipeline.prepare(&self.stage.world).await;
        }
    }

    /// Steps the world by a sixtieth of a second.
    pub fn step(&mut self) {
        self.report = self.stage.step();
        self.settled_by_gpu += self.report.batch.settled_by_gpu;
    }

    /// Lets other bodies fall: a mesh as built by `Dropped`.
    pub fn set_falling(&mut self, dropped: &Dropped) -> Result<(), JsError> {
        let mesh = dropped.mesh();
        if SharedShape::convex_hull(&mesh.vertices).is_none() {
            return Err(JsError::new("rapier makes no convex hull of this mesh"));
        }
        let medial = MedialMesh::from_bytes(dropped.medial())?;
        let skeleton = Skeleton::of_medial(&medial, 0.0);
        self.models[0] = Model::new(mesh.clone(), skeleton, medial);
        self.restart();
        Ok(())
    }

    /// Lets rings fall again.
    pub fn set_rings(&mut self) {
        self.models[0] = Arc::clone(&self.ring);
        self.restart();
    }

    /// Throws one more of what falls, from a place along a direction; false when enough have been thrown.
    pub fn throw(&mut self, from: &[f32], along: &[f32]) -> bool {
        let (&[x, y, z], &[u, v, w]) = (from, along) else {
            return false;
        };
        let thrown = self.scene.actors.len() - COUNT - 1;
        let velocity = SPEED * Vector::new(u, v, w).normalize_or_zero();
        if thrown == THROWN || !velocity.is_finite() {
            return false;
        }
        let start = RigidBodyBuilder::dynamic()
            .translation(Vector::new(x, y.max(0.7), z))
            .rotation(Vector::new(0.4, 0.3 * thrown as f32, 0.9))
            .linvel(velocity)
            .angvel(Vector::new(2.0, 1.0, 0.5))
            .angular_damping(0.5);
        let color = rainbow((0.618_034 * thrown as f32).fract());
        let actor = Actor::new(&self.models[0], start, color);
        self.scene.add(actor, self.kind, &mut self.stage);
        let (_, collider) = self.stage.bodies[self.stage.bodies.len() - 1];
        if let Some(pipeline) = &mut self.stage.pipeline {
            pipeline.set_effects(collider, self.effects);
        }
        true
    }

    /// Back to the start; what was thrown is gone.
    pub fn restart(&mut self) {
        let [falling, animal] = &self.models;
        self.scene = falling_on(Arc::clone(animal), falling, COUNT);
        self.play(self.scene.stage(self.kind));
        self.settled_by_gpu = 0;
    }

    /// Goes on with colliders of another kind.
    pub fn set_kind(&mut self, kind: &str) -> Result<(), JsError> {
        self.kind = Kind::named(kind).map_err(|e| JsError::new(&e))?;
        self.play(self.scene.stage_from(self.kind, &self.stage));
        Ok(())
    }

    /// Whether fast bodies meet at their exact first contact, and slow ones are guarded; else as rapier.
    pub fn set_continuous(&mut self, on: bool) {
        self.effects = Effects::default();
        if !on {
            self.effects.continuous = Effect::Off;
            self.effects.guard = Effect::Off;
        }
        self.stage.set_effects(self.effects);
    }

    /// How many bodies there are.
    pub fn count(&self) -> usize {
        self.scene.actors.len()
    }

    /// Position x, y, z and rotation x, y, z, w of each body.
    pub fn poses(&self) -> Vec<f32> {
        let poses = self.stage.poses().into_iter();
        let numbers = poses.flat_map(|pose| {
            let [x, y, z] = pose.translation.to_array();
            let [i, j, k, w] = pose.rotation.to_array();
            [x, y, z, i, j, k, w]
        });
        numbers.collect()
    }

    /// Red, green and blue of each body.
    pub fn colors(&self) -> Vec<f32> {
        let colors = self.scene.actors.iter().map(|actor| actor.color);
        flat(&colors.collect::<Vec<_>>())
    }

    /// The place in `poses` of the creature; all other bodies are alike.
    pub fn creature(&self) -> usize {
        COUNT
    }

    /// The triangles that a body came as.
    pub fn source(&self, body: usize) -> Option<Surface> {
        let actor = self.scene.actors.get(body)?;
        Some(Surface(actor.model.mesh.clone()))
    }

    /// What a body collides as.
    pub fn collider(&self, body: usize) -> Option<Surface> {
        let (_, collider) = self.stage.bodies.get(body)?;
        Some(Surface(surface(
            self.stage.world.colliders[*collider].shape(),
        )))
    }

    /// How many bodies sleep.
    pub fn sleeping(&self) -> usize {
        let bodies = self.stage.world.bodies.iter();
        bodies.filter(|(_, body)| body.is_sleeping()).count()
    }

    /// Contact points that the solver has, of all pairs.
    pub fn contact_points(&self) -> usize {
        let pairs = self.stage.world.narrow_phase.contact_pairs();
        let points = pairs
            .flat_map(|pair| pair.manifolds())
            .map(|m| m.points.len());
        points.sum()
    }

    /// Elementary tests of the last step.
    pub fn elementary_tests(&self) -> f64 {
        self.report.elementary_tests as f64
    }

    /// Jobs of batches since the start that the device answered.
    pub fn settled_by_gpu(&self) -> f64 {
        self.settled_by_gpu as f64
    }

    /// A hash of every bit of every body's pose and velocity.
    pub fn state_hash(&self) -> String {
        format!("{:016x}", state_hash(&self.stage.world))
    }
}

impl Demo {
    fn play(&mut self, stage: Stage) {
        self.take_device();
        self.stage = stage;
        self.stage.set_effects(self.effects);
        self.lend_device();
    }

    fn batch(&self) -> Option<&Batch> {
        self.stage.pipeline.as_ref().map(MedialPipeline::batch)
    }

    /// The stage goes on without the device.
    fn take_device(&mut self) {
        if self.on_gpu()
            && let Some(pipeline) = &mut self.stage.pipeline
        {
            self.device = Some(pipeline.replace_batch(Batch::default()));
        }
    }

    /// The stage gets the device, if it is to have it.
    fn lend_device(&mut self) {
        if self.on_gpu
            && let Some(pipeline) = &mut self.stage.pipeline
            && let Some(device) = self.device.take()
        {
            pipeline.replace_batch(device);
        }
    }
}

fn flat(vectors: &[Vector]) -> Vec<f32> {
    vectors.iter().flat_map(|v| v.to_array()).collect()
}
