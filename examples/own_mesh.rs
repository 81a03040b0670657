//! A mesh of your own (OBJ, STL, PLY, OFF): build it, drop it, look at it. Prints all that the
//! builder measured and found, and draws the mesh beside the envelope of its medial mesh, then
//! four of them dropped.
//!
//! ```text
//! cargo run --release --example own_mesh -- my.obj
//! cargo run --release --example own_mesh
//! ```
//! Without a file it makes a knot. Options: `--primitives N` (at most; default 200), `--out DIR`
//! (where the picture goes; default target/own_mesh).
//!
//! Exits with 1 when the mesh cannot be built, when its vertices are further out of the medial mesh
//! than the report says, or when the dropped bodies end in the air or 5 mm in the ground.

mod common;

use common::arguments::{MeshOptions, example_with_mesh, verdict};
use common::build::{build_with_report, print};
use common::light::{Facet, facets};
use common::mesh::{Mesh, knot};
use common::random::Random;
use common::render::Camera;
use common::scene::{Actor, Kind, Model, Scene};
use common::scene_strip::{View, rainbow, seen};
use common::skeleton::Skeleton;
use common::strip::tile;
use rapier3d::prelude::*;
use rapier3d_medial::MedialMesh;
use std::process::ExitCode;
use std::sync::Arc;

/// Longest side, in metres, that meshes are scaled to.
const SIZE: Real = 1.0;
/// Bodies that end deeper in the ground, in metres, have failed.
const SUNK: Real = 0.005;

fn main() -> ExitCode {
    example_with_mesh(200, "target/own_mesh", own_mesh)
}

fn own_mesh(options: MeshOptions) -> Result<(), String> {
    let mesh = match &options.file {
        Some(file) => Mesh::read(file)?,
        None => knot(),
    };
    let mesh = mesh.fitted(SIZE);
    let (medial, report) = build_with_report("build", &mesh, options.primitives)?;
    print(&mesh, &report);

    let view = View {
        camera: Camera {
            eye: Vector::new(0.9, 2.0, 3.4),
            target: Vector::new(0.0, 0.55, 0.0),
            field_of_view: 0.60,
            shadows: 2.5,
        },
        tile: [400, 400],
        steps: &[],
        ghost: 0.0,
    };
    let (vertices, indices) = medial.envelope(0.01 * SIZE);
    let envelope = Mesh { vertices, indices };
    let place = Pose::from_translation(Vector::Y * 0.6);
    let alone = |mesh: &Mesh, color: Vector, name: &str| {
        let seen: Vec<Facet> = facets(mesh, place, color).collect();
        view.labelled(&seen, &[name])
    };
    let mut pictures = vec![
        alone(&mesh, Vector::new(0.75, 0.55, 0.20), "YOUR MESH"),
        alone(&envelope, Vector::new(0.20, 0.55, 0.30), "ITS MEDIAL MESH"),
    ];
    let mut failures = Vec::new();
    let out = farthest_out(&mesh, &medial);
    if out > report.hausdorff.uncovered + report.hausdorff.sampling {
        failures.push(format!("a vertex is {out} m out of the medial mesh"));
    }

    let skeleton = Skeleton::of_medial(&medial, 0.02 * SIZE);
    let scene = scene(&Model::new(mesh, skeleton, medial));
    let run = scene.run(Kind::Medial, 900, |_, _| ());
    for step in [30, 900] {
        let label = format!("STEP {}", step.min(run.milliseconds.len()));
        pictures.push(view.labelled(&seen(&scene, run.poses_after(step)), &["DROPPED", &label]));
    }
    let path = options.out.join("own_mesh.png");
    tile(&[pictures]).save(&path)?;
    println!("{}", path.display());
    let audit = &run.audit;
    println!(
        "{} bodies float, lowest point in the end: {:.1} mm",
        audit.floating,
        1.0e3 * audit.lowest_last
    );
    if !audit.finite || audit.lowest_last < -SUNK || audit.floating > 0 {
        failures.push("the bodies do not lie on the ground".to_string());
    }
    verdict(failures)
}

/// How far the farthest vertex is out of the solid, by parry's point query.
fn farthest_out(mesh: &Mesh, medial: &MedialMesh) -> Real {
    use rapier3d::parry::query::PointQuery;
    let distance = |v: &Vector| medial.distance_to_local_point(*v, true);
    mesh.vertices.iter().map(distance).fold(0.0, Real::max)
}

/// Four of them, above each other.
fn scene(model: &Arc<Model>) -> Scene {
    let mut random = Random(2);
    let actors = (0..4).map(|k| Actor {
        model: Arc::clone(model),
        start: RigidBodyBuilder::dynamic()
            .pose(Pose::new(
                Vector::new(random.between(-0.2, 0.2), 0.8 + 1.1 * k as Real, 0.0),
                random.direction(),
            ))
            .angular_damping(0.5),
        color: rainbow(k as Real / 4.0),
    });
    Scene::new(actors.collect())
}
