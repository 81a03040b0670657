//! rapier's demo scene `convex_decomposition3` with its colliders swapped: models of 6 m across fall onto
//! the ground, four of each, as convex parts and as medial meshes. The models are this crate's own.
//!
//! The change is one line a collider, in `Kind::collider` of `examples/common/scene.rs`:
//! ```text
//! ColliderBuilder::convex_decomposition(&vertices, &indices)
//! ColliderBuilder::medial_mesh(medial)
//! ```
//! and `pipeline.step(&mut world)` for `world.step()`.
//!
//! ```text
//! cargo run --release --example convex_decomposition
//! ```
//! Option: `--out DIR` (where the picture goes; default target/convex_decomposition).
//!
//! Exits with 1 when the medial bodies do not come to rest, sink into the ground by a hundredth of their
//! size, or one passes through another.

mod common;

use common::arguments::{example_with_out, verdict};
use common::build::build;
use common::mesh::{Mesh, ring};
use common::render::Camera;
use common::scene::{Actor, Kind, Model, Scene};
use common::scene_strip::View;
use common::scene_table::table;
use common::skeleton::Skeleton;
use common::skin::{Limb, skin};
use rapier3d::prelude::*;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

/// Diagonal of each model's box and distance of their places, in metres, as in the demo.
const DIAGONAL: Real = 6.0;
const SHIFT: Real = 5.0;
/// How often each model falls, as in the demo.
const DUPLICATIONS: usize = 4;
const STEPS: usize = 900;
/// How deep a model may press into the ground as it lands, in units of its diagonal: rapier's contacts
/// are soft.
const SUNK: Real = 0.01;

fn main() -> ExitCode {
    example_with_out("target/convex_decomposition", convex_decomposition)
}

fn convex_decomposition(out: &Path) -> Result<(), String> {
    let scene = scene()?;
    let runs = [Kind::Medial, Kind::Parts].map(|kind| scene.run(kind, STEPS, |_, _| ()));
    let view = View {
        camera: Camera {
            eye: Vector::new(-14.0, 16.0, 34.0),
            target: Vector::new(3.0, 1.5, 11.5),
            field_of_view: 0.75,
            shadows: 18.0,
        },
        tile: [400, 320],
        steps: &[0, 60, 120, STEPS],
        ghost: 0.0,
    };
    let path = out.join("convex_decomposition.png");
    let [medial, parts] = &runs;
    view.strip(&scene, &[medial, parts]).save(&path)?;
    println!("{}\n\n{}", path.display(), table(&[medial, parts]));
    let mut failures = Vec::new();
    if medial.asleep_after.is_none() {
        failures.push(format!("not all sleep after {STEPS} steps"));
    }
    if !medial.audit.finite || medial.audit.crossings > 0 {
        failures.push(format!(
            "inner lines crossed {} times",
            medial.audit.crossings
        ));
    }
    if medial.audit.lowest < -SUNK * DIAGONAL {
        failures.push(format!("a body sank {} m", -medial.audit.lowest));
    }
    verdict(failures)
}

/// Four models in a square, each four times in a row, above the ground.
fn scene() -> Result<Scene, String> {
    let colors = [
        [0.90, 0.55, 0.08],
        [0.15, 0.35, 0.70],
        [0.55, 0.15, 0.20],
        [0.20, 0.50, 0.30],
    ];
    let mut actors = Vec::new();
    for (i, model) in models()?.into_iter().enumerate() {
        for k in 1..=DUPLICATIONS {
            let [x, y] = [(i % 2) as Real, (i / 2) as Real];
            let at = Vector::new(x * SHIFT, y * SHIFT + 4.0, k as Real * SHIFT);
            actors.push(Actor {
                model: Arc::clone(&model),
                start: RigidBodyBuilder::dynamic().translation(at),
                color: Vector::from(colors[i]),
            });
        }
    }
    Ok(Scene::new(actors))
}

fn models() -> Result<Vec<Arc<Model>>, String> {
    let (major, minor) = (1.75, 0.45);
    let torus = (ring(major, minor, 40, 15), Skeleton::ring(major, minor, 40));
    let limbs: [&[Limb]; 3] = [
        &[vec![
            [0.9, 2.3, 0.0, 0.3],
            [0.9, -0.8, 0.0, 0.35],
            [0.0, -1.9, 0.0, 0.4],
            [-1.0, -1.0, 0.0, 0.3],
            [-1.1, 0.4, 0.0, 0.2],
        ]],
        &[
            vec![[-1.6, -1.6, -1.6, 0.3], [1.6, 1.6, 1.6, 0.3]],
            vec![[1.6, -1.6, -1.6, 0.3], [-1.6, 1.6, 1.6, 0.3]],
            vec![[-1.6, -1.6, 1.6, 0.3], [1.6, 1.6, -1.6, 0.3]],
        ],
        &[
            vec![[-1.5, 0.0, -1.5, 0.3], [1.5, 0.0, -1.5, 0.3]],
            vec![[1.5, 0.0, -1.5, 0.3], [1.5, 0.0, 1.5, 0.3]],
            vec![[1.5, 0.0, 1.5, 0.3], [-1.5, 0.0, 1.5, 0.3]],
            vec![[1.5, 0.0, -1.5, 0.3], [1.5, -1.9, -1.5, 0.3]],
            vec![[1.5, 0.0, 1.5, 0.3], [1.5, -1.9, 1.5, 0.3]],
            vec![[-1.5, 0.0, 1.5, 0.3], [-1.5, 2.2, 1.5, 0.3]],
        ],
    ];
    let skins = limbs.map(|limbs| skin(limbs, 0.09));
    let all = [torus].into_iter().chain(skins);
    all.map(|(mesh, skeleton)| model(mesh, skeleton)).collect()
}

/// A model of the demo's size.
fn model(mesh: Mesh, skeleton: Skeleton) -> Result<Arc<Model>, String> {
    mesh.check_closed()?;
    let (low, high) = mesh.bounds();
    let diagonal = (high - low).length();
    if (diagonal - DIAGONAL).abs() > 0.25 * DIAGONAL {
        return Err(format!("a model is {diagonal} m across, not {DIAGONAL}"));
    }
    let medial = build("build a model", &mesh, 100)?;
    Ok(Model::new(mesh, skeleton, medial))
}
