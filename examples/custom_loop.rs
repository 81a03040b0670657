//! For those who keep rapier's sets and loop themselves, without `PhysicsWorld`: `attach_sets` once,
//! and `step_sets` in place of `PhysicsPipeline::step`, with the same arguments. Rings fall over a
//! pole, which is one of rapier's own capsules, and lie round it in a stack.
//!
//! ```text
//! cargo run --release --example custom_loop
//! ```
//! Option: `--out DIR` (where the picture goes; default target/custom_loop).
//!
//! Exits with 1 unless in the end the pole runs through every ring and the stack is as high as so
//! many tubes on top of each other, less twice the overlap that rapier's solver allows at each.

mod common;

use common::arguments::example_with_out;
use common::light::{Facet, facets};
use common::mesh::{capsule, ring};
use common::random::Random;
use common::render::Camera;
use common::scene_strip::{SLATE, View, rainbow};
use common::skeleton::Skeleton;
use common::strip::tile;
use common::threading::{placed, threaded};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::path::Path;
use std::process::ExitCode;

/// Radii of a ring's centre circle and of its tube, in metres.
const RING: (Real, Real) = (0.5, 0.1);
/// Half the length of the pole's axis, and its radius, in metres.
const POLE: (Real, Real) = (1.4, 0.25);
const RINGS: usize = 8;

/// The sets of a game of one's own.
#[derive(Default)]
struct Game {
    pipeline: PhysicsPipeline,
    parameters: IntegrationParameters,
    islands: IslandManager,
    broad_phase: BroadPhaseBvh,
    narrow_phase: NarrowPhase,
    bodies: RigidBodySet,
    colliders: ColliderSet,
    impulse_joints: ImpulseJointSet,
    multibody_joints: MultibodyJointSet,
    soft_bodies: SoftBodySet,
    ccd_solver: CCDSolver,
    medial: MedialPipeline,
}

impl Game {
    fn add(&mut self, body: RigidBodyBuilder, collider: ColliderBuilder) {
        let body = self.bodies.insert(body);
        self.colliders
            .insert_with_parent(collider, body, &mut self.bodies);
    }

    /// Of the bodies that move.
    fn poses(&self) -> Vec<Pose> {
        let moving = self.bodies.iter().filter(|(_, body)| body.is_dynamic());
        moving.map(|(_, body)| *body.position()).collect()
    }

    fn step(&mut self) {
        self.medial.step_sets(
            &mut self.pipeline,
            Vector::NEG_Y * 9.81,
            &self.parameters,
            &mut self.islands,
            &mut self.broad_phase,
            &mut self.narrow_phase,
            &mut self.bodies,
            &mut self.colliders,
            &mut self.impulse_joints,
            &mut self.multibody_joints,
            &mut self.soft_bodies,
            &mut self.ccd_solver,
            &(),
            &(),
        );
    }
}

fn main() -> ExitCode {
    example_with_out("target/custom_loop", custom_loop)
}

fn custom_loop(out: &Path) -> Result<(), String> {
    let torus = MedialMesh::torus(RING.0, RING.1, 40).map_err(|e| e.to_string())?;
    let mut game = Game::default();
    game.medial.attach_sets(&mut game.narrow_phase);
    let ground = ColliderBuilder::cuboid(9.0, 0.5, 9.0).translation(Vector::NEG_Y * 0.5);
    game.colliders.insert(ground);
    let pole = ColliderBuilder::capsule_y(POLE.0, POLE.1).translation(Vector::Y * POLE.0);
    game.colliders.insert(pole);
    let mut random = Random(7);
    for k in 0..RINGS {
        let tilt = random.direction() * random.between(0.0, 0.2);
        let start = Pose::new(Vector::Y * (3.3 + 0.5 * k as Real), tilt);
        let body = RigidBodyBuilder::dynamic().pose(start).angular_damping(0.5);
        game.add(body, ColliderBuilder::medial_mesh(torus.clone()));
    }

    let view = View {
        camera: Camera {
            eye: Vector::new(1.5, 3.2, 6.5),
            target: Vector::new(0.0, 1.6, 0.0),
            field_of_view: 0.62,
            shadows: 3.5,
        },
        tile: [280, 380],
        steps: &[0, 40, 70, 600],
        ghost: 0.0,
    };
    let mut pictures = Vec::new();
    for step in 0..=600 {
        if view.steps.contains(&step) {
            pictures.push(view.labelled(&seen(&game.poses()), &[&format!("STEP {step}")]));
        }
        game.step();
    }
    let path = out.join("custom_loop.png");
    tile(&[pictures]).save(&path)?;

    let poses = game.poses();
    let axis = placed(&[Vector::ZERO, Vector::Y * (2.0 * POLE.0)], &Pose::IDENTITY);
    let on = threaded(&axis, &Skeleton::ring(RING.0, RING.1, 40).line(), &poses);
    let top = RING.1 + poses.iter().map(|p| p.translation.y).fold(0.0, Real::max);
    let due = 2.0 * RING.1 * RINGS as Real;
    println!("{}\n\nrings on the pole: {on} of {RINGS}", path.display());
    println!("height of the stack: {top:.3} m, {due:.3} m is due");
    let allowed = 2.0 * game.parameters.allowed_linear_error() * RINGS as Real;
    if on == RINGS && (top - due).abs() <= allowed {
        return Ok(());
    }
    Err("the rings do not lie round the pole, one on the other".into())
}

/// The rings and the pole.
fn seen(poses: &[Pose]) -> Vec<Facet> {
    let pole = capsule(POLE.0, POLE.1, 32);
    let ring = ring(RING.0, RING.1, 40, 15);
    let color = |k: usize| rainbow(k as Real / RINGS as Real);
    let rings = poses.iter().enumerate();
    let rings = rings.flat_map(|(k, pose)| facets(&ring, *pose, color(k)));
    let upright = Pose::from_translation(Vector::Y * POLE.0);
    rings.chain(facets(&pole, upright, SLATE)).collect()
}
