//! Falling rings for a page in the browser: the scene of the example `falling_rings` as a class of
//! JavaScript. A device opened by `open_device` goes from stage to stage. Poses and meshes go out as flat arrays; `site/main.js` draws them.

#[path = "../../examples/common/mod.rs"]
mod common;
mod state;

use common::creature::creature;
use common::falling::{falling_on, falling_ring};
use common::mesh::Mesh;
use common::scene::{Kind, Model, Scene, Stage};
use common::surfaces::surface;
use rapier3d::prelude::Vector;
use rapier3d_medial::batch::Batch;
use rapier3d_medial::batch::gpu::{Gpu, GpuOptions};
use rapier3d_medial::{
    Backend, BuildOptions, Effect, Effects, MedialMesh, MedialPipeline, StepReport,
};
use state::state_hash;
use wasm_bindgen::prelude::*;

const RINGS: usize = 15;

/// A world of rings above the creature, the last of its bodies.
#[wasm_bindgen]
pub struct Demo {
    scene: Scene,
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
        let scene = falling_on(animal, &ring, RINGS);
        Ok(Self {
            stage: scene.stage(kind),
            scene,
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
        self.settled_by_gpu += self.report.settled_by_gpu;
    }

    /// Back to the start.
    pub fn restart(&mut self) {
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
