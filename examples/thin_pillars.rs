//! Bodies of five shapes are thrown into pillars 5 mm thin, as in the paper's "Multi-bodies"
//! benchmark (Figures 5 and 9). They travel up to 45 pillar widths in a step, and none may pass
//! through a pillar or through another body.
//!
//! ```text
//! cargo run --release --example thin_pillars
//! ```
//! Option: `--out DIR` (where the picture goes; default target/thin_pillars).
//!
//! Exits with 1 when a medial body's inner lines cross a pillar's axis or another body's lines, on
//! the way from pose to pose. Lines and axes are those of the formulas that the bodies were made of. In the end
//! none may be under the ground.

mod common;

use common::arguments::{example_with_out, verdict};
use common::build::build;
use common::mesh::{Mesh, capsule, ring};
use common::random::Random;
use common::render::Camera;
use common::scene::{Actor, Kind, Model, Scene};
use common::scene_strip::{SLATE, View, rainbow};
use common::scene_table::table;
use common::skeleton::{Bone, Skeleton};
use common::skin::{Limb, skin};
use rapier3d::prelude::*;
use rapier3d_medial::MedialMesh;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

/// Half the height of a pillar's axis, and its radius, in metres.
const PILLAR: (Real, Real) = (0.6, 0.0025);
/// Pillars along each side of the field, and their distance in metres.
const FIELD: (usize, Real) = (6, 0.32);
const BODIES: usize = 15;
const STEPS: usize = 100;

fn main() -> ExitCode {
    example_with_out("target/thin_pillars", thin_pillars)
}

fn thin_pillars(out: &Path) -> Result<(), String> {
    let scene = scene()?;
    let runs = [Kind::Medial, Kind::Triangles].map(|kind| scene.run(kind, STEPS, |_, _| ()));
    let view = View {
        camera: Camera {
            eye: Vector::new(1.9, 2.3, 3.9),
            target: Vector::new(0.0, 0.75, 0.0),
            field_of_view: 0.62,
            shadows: 3.0,
        },
        tile: [440, 440],
        steps: &[10, 30, STEPS],
        ghost: 0.0,
    };
    let path = out.join("thin_pillars.png");
    view.strip(&scene, &[&runs[0], &runs[1]]).save(&path)?;
    println!("{}\n\n{}", path.display(), table(&[&runs[0], &runs[1]]));
    let audit = &runs[0].audit;
    let mut failures = Vec::new();
    if audit.crossings > 0 {
        failures.push(format!("inner lines crossed {} times", audit.crossings));
    }
    if !audit.finite || audit.lowest_last < -0.005 {
        failures.push(format!("lowest point in the end: {} m", audit.lowest_last));
    }
    verdict(failures)
}

/// The bodies above the field, thrown down and to the side; then the pillars.
fn scene() -> Result<Scene, String> {
    let shapes = shapes()?;
    let mut random = Random(11);
    let bodies = (0..BODIES).map(|k| {
        let place = Vector::new(
            random.between(-1.6, 0.4),
            1.6 + 0.45 * (k / 3) as Real,
            -0.6 + 0.5 * (k % 3) as Real,
        );
        let aim = Vector::new(random.between(4.0, 8.0), random.between(-10.0, -6.0), 0.0);
        Actor {
            model: Arc::clone(&shapes[k % shapes.len()]),
            start: RigidBodyBuilder::dynamic()
                .pose(Pose::new(place, random.direction()))
                .linvel(aim)
                .angvel(random.direction() * 6.0)
                .ccd_enabled(true),
            color: rainbow((k % shapes.len()) as Real / shapes.len() as Real),
        }
    });
    let mut actors: Vec<Actor> = bodies.collect();
    let (half, radius) = PILLAR;
    let ends = [Vector::Y * half, Vector::NEG_Y * half];
    let skeleton = Skeleton::new(vec![Bone {
        ends,
        radii: [radius; 2],
    }]);
    let medial = MedialMesh::capsule(ends[0], ends[1], radius).map_err(|e| e.to_string())?;
    let pillar = Model::new(capsule(half, radius, 8), skeleton, medial);
    let (side, apart) = FIELD;
    actors.extend((0..side * side).map(|k| {
        let at = |n: usize| apart * (n as Real - (side - 1) as Real / 2.0);
        let place = Vector::new(at(k / side), half + radius, at(k % side));
        Actor {
            model: Arc::clone(&pillar),
            start: RigidBodyBuilder::fixed().translation(place),
            color: SLATE,
        }
    }));
    Ok(Scene::new(actors))
}

/// A ring, a jack, a hook, a dumb-bell and a frame of three legs.
fn shapes() -> Result<Vec<Arc<Model>>, String> {
    let jack: Vec<Limb> = [[0.2, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.2]]
        .map(|[x, y, z]| vec![[-x, -y, -z, 0.035], [x, y, z, 0.035]])
        .to_vec();
    let hook = vec![vec![
        [0.0, 0.22, 0.0, 0.03],
        [0.0, 0.0, 0.0, 0.035],
        [0.06, -0.12, 0.0, 0.035],
        [0.17, -0.14, 0.0, 0.035],
        [0.22, -0.03, 0.0, 0.03],
    ]];
    let bell = vec![
        vec![[-0.15, 0.0, 0.0, 0.04], [0.15, 0.0, 0.0, 0.04]],
        vec![[-0.18, 0.0, 0.0, 0.09], [-0.17, 0.0, 0.0, 0.09]],
        vec![[0.17, 0.0, 0.0, 0.09], [0.18, 0.0, 0.0, 0.09]],
    ];
    let legs: Vec<Limb> = [(0.2, 0.0), (-0.1, 0.17), (-0.1, -0.17)]
        .map(|(x, z)| {
            vec![
                [0.0, 0.0, 0.0, 0.04],
                [x, 0.04, z, 0.035],
                [x, -0.2, z, 0.03],
            ]
        })
        .to_vec();
    let mesh = ring(0.2, 0.04, 32, 12);
    let mut shapes = vec![model(mesh, Skeleton::ring(0.2, 0.04, 32))?];
    for limbs in [jack, hook, bell, legs] {
        let (mesh, skeleton) = skin(&limbs, 0.014);
        shapes.push(model(mesh, skeleton)?);
    }
    Ok(shapes)
}

fn model(mesh: Mesh, skeleton: Skeleton) -> Result<Arc<Model>, String> {
    mesh.check_closed()?;
    let medial = build("build a shape", &mesh, 40)?;
    Ok(Model::new(mesh, skeleton, medial))
}
