//! Falling rings for a page in the browser: the scene of the example `falling_rings` as a class of
//! JavaScript. Poses and meshes go out as flat arrays; `site/main.js` draws them.

#[path = "../../examples/common/mod.rs"]
mod common;

use common::creature::creature;
use common::falling::{falling_on, falling_ring};
use common::mesh::Mesh;
use common::scene::{Kind, Model, Scene, Stage};
use common::surfaces::surface;
use rapier3d::prelude::Vector;
use rapier3d_medial::{BuildOptions, Effect, Effects, MedialMesh, StepReport};
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
        })
    }

    /// Steps the world by a sixtieth of a second.
    pub fn step(&mut self) {
        self.report = self.stage.step();
    }

    /// Back to the start.
    pub fn restart(&mut self) {
        self.stage = self.scene.stage(self.kind);
        self.stage.set_effects(self.effects);
    }

    /// Goes on with colliders of another kind.
    pub fn set_kind(&mut self, kind: &str) -> Result<(), JsError> {
        self.kind = Kind::named(kind).map_err(|e| JsError::new(&e))?;
        self.stage = self.scene.stage_from(self.kind, &self.stage);
        self.stage.set_effects(self.effects);
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
}

fn flat(vectors: &[Vector]) -> Vec<f32> {
    vectors.iter().flat_map(|v| v.to_array()).collect()
}
