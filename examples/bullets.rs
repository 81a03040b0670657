//! A bullet and a ring fly at each other, 2 m per step. Every other bullet is aimed at the ring's tube,
//! the others through its hole. Plain rapier sweeps fast bodies against what is fixed, not against
//! each other: it misses hits. Medial meshes meet at their exact first contact. The picture shows two
//! of the shots, all steps at once, the earlier the paler.
//!
//! ```text
//! cargo run --release --example bullets
//! ```
//! Option: `--out DIR` (where the picture goes; default target/bullets).
//!
//! Exits with 1 when a medial bullet misses its ring or feels one that it flies through. What must
//! happen follows from the straight flights and the formulas of ring and bullet.

mod common;

use common::arguments::example_with_out;
use common::build::{capsule_model, model};
use common::mesh::ring;
use common::random::Random;
use common::render::Camera;
use common::scene::{Actor, Kind, Model, Scene};
use common::scene_strip::{View, exposures};
use common::skeleton::Skeleton;
use common::strip::tile;
use common::table::Table;
use rapier3d::prelude::*;
use std::f32::consts::{FRAC_PI_2, TAU};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

/// Radii of the ring's centre circle and of its tube, in metres.
const RING: (Real, Real) = (0.5, 0.08);
/// Half the length of the bullet's axis, and its radius, in metres.
const BULLET: (Real, Real) = (0.25, 0.1);
/// Speeds of bullet and ring along x, in metres per second.
const SPEEDS: [Real; 2] = [90.0, -30.0];
const SHOTS: usize = 200;
/// Enough for all to have met.
const STEPS: usize = 7;
const KINDS: [Kind; 3] = [Kind::Medial, Kind::Hulls, Kind::Triangles];

/// One shot, and what must happen.
struct Shot {
    scene: Scene,
    hits: bool,
}

fn main() -> ExitCode {
    example_with_out("target/bullets", bullets)
}

fn bullets(out: &Path) -> Result<(), String> {
    let models = models()?;
    let mut random = Random(3);
    let shots: Vec<Shot> = (0..SHOTS).map(|k| shot(&models, k, &mut random)).collect();
    let mut table = Table::default();
    table.row("", KINDS.map(|kind| kind.name().to_lowercase()));
    let count = |hits: bool, kind: Kind| {
        let wrong = |shot: &&Shot| shot.hits == hits && feels(&shot.scene, kind) != hits;
        shots.iter().filter(wrong).count()
    };
    let missed = KINDS.map(|kind| count(true, kind));
    let ghosts = KINDS.map(|kind| count(false, kind));
    let half = SHOTS / 2;
    table.row(&format!("of {half} shots at the tube, missed"), missed);
    table.row(&format!("of {half} through the hole, stopped"), ghosts);

    let view = View {
        camera: Camera {
            eye: Vector::new(-1.2, 3.2, 8.2),
            target: Vector::new(0.2, 1.5, 0.0),
            field_of_view: 0.42,
            shadows: 6.0,
        },
        tile: [560, 230],
        steps: &[],
        ghost: 0.0,
    };
    let [at_tube, through] = [24, 25].map(|k| &shots[k]);
    let row = |kind: Kind| {
        let name = kind.name();
        [(at_tube, "AT THE TUBE"), (through, "THROUGH THE HOLE")]
            .map(|(shot, aim)| view.labelled(&exposures(&shot.scene, kind, STEPS), &[name, aim]))
            .to_vec()
    };
    let path = out.join("bullets.png");
    tile(&KINDS.map(row)).save(&path)?;
    println!("{}\n\n{table}", path.display());
    match missed[0] + ghosts[0] {
        0 => Ok(()),
        _ => Err(format!("{} hits missed, {} ghosts", missed[0], ghosts[0])),
    }
}

/// Bullet and ring.
fn models() -> Result<[Arc<Model>; 2], String> {
    let bullet = capsule_model(BULLET.0, BULLET.1, 24)?;
    let lines = Skeleton::ring(RING.0, RING.1, 40);
    let mesh = ring(RING.0, RING.1, 40, 15);
    Ok([bullet, model("build the ring", (mesh, lines), 40)?])
}

/// Even shots are at the middle half of the tube, odd ones through the middle half of what the hole
/// leaves to the bullet. The moment of the meeting goes once through a step's phases.
fn shot([bullet, ring]: &[Arc<Model>; 2], number: usize, random: &mut Random) -> Shot {
    let hits = number.is_multiple_of(2);
    let (major, minor) = RING;
    let off = if hits {
        major + random.between(-0.5, 0.5) * minor
    } else {
        random.between(0.0, 0.5) * (major - minor - BULLET.1)
    };
    let (sin, cos) = random.between(0.0, TAU).sin_cos();
    let phase = number as Real / SHOTS as Real;
    let apart = 7.0 + phase * (SPEEDS[0] - SPEEDS[1]) / 60.0;
    // They meet above the origin.
    let share = SPEEDS[0] / (SPEEDS[0] - SPEEDS[1]);
    let body = |place: Vector, speed: Real| {
        RigidBodyBuilder::dynamic()
            .pose(Pose::new(place + Vector::Y * 1.5, Vector::Z * FRAC_PI_2))
            .linvel(Vector::X * speed)
            .gravity_scale(0.0)
            .ccd_enabled(true)
    };
    let from = Vector::new(-apart * share, off * cos, off * sin);
    let to = Vector::X * (apart * (1.0 - share));
    let actors = vec![
        Actor::new(bullet, body(from, SPEEDS[0]), Vector::new(0.85, 0.25, 0.08)),
        Actor::new(ring, body(to, SPEEDS[1]), Vector::new(0.10, 0.35, 0.75)),
    ];
    Shot {
        scene: Scene::new(actors),
        hits,
    }
}

/// Whether the bullet flies otherwise than it started.
fn feels(scene: &Scene, kind: Kind) -> bool {
    let mut stage = scene.stage(kind);
    for _ in 0..STEPS {
        stage.step();
    }
    let velocity = stage.world.bodies[stage.bodies[0].0].linvel();
    (velocity - Vector::X * SPEEDS[0]).length() > 0.01 * SPEEDS[0]
}
