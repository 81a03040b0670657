//! The scenes of the paper's three benchmarks, with bodies made in code.

use crate::common::build::build_as_many;
use crate::common::creature::{creature, creature_with_cells};
use crate::common::decimate::decimated;
use crate::common::mesh::ring;
use crate::common::pillars::field;
use crate::common::random::Random;
use crate::common::scene::{Actor, Model, Scene};
use crate::common::skeleton::Skeleton;
use rapier3d::prelude::*;
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// Five shapes three times above a field of 36 pillars, which are a primitive each: 2,262 in all, and
/// 786 where it has to be quick.
pub fn multi_bodies(quick: bool) -> Result<Scene, String> {
    let (cell, primitives) = if quick { (0.014, 250) } else { (0.0059, 742) };
    field(cell, primitives)
}

fn still(model: &Arc<Model>, start: RigidBodyBuilder) -> Actor {
    Actor::new(model, start, Vector::ONE)
}

/// Two creatures of 1,236 primitives, one upside down above the other.
pub fn creatures(quick: bool) -> Result<Scene, String> {
    let (mesh, skeleton) = if quick {
        creature()
    } else {
        creature_with_cells(0.0255)
    };
    let medial = build_as_many("two creatures", &mesh, 1236)?;
    let model = Model::new(mesh, skeleton, medial);
    let place = |place, turn| RigidBodyBuilder::dynamic().pose(Pose::new(place, turn));
    Ok(Scene::new(vec![
        still(&model, place(Vector::Y * 0.02, Vector::Y * 0.4)),
        still(&model, place(Vector::new(0.25, 6.0, 0.2), Vector::Z * PI)),
    ]))
}

/// Fifteen rings of 27 primitives and 1,200 triangles above a creature of 28 and 1,115.
pub fn rings() -> Result<Scene, String> {
    let mesh = ring(0.5, 0.1, 40, 15);
    let medial = build_as_many("a ring", &mesh, 27)?;
    let rings = Model::new(mesh, Skeleton::ring(0.5, 0.1, 40), medial);
    let (fine, skeleton) = creature();
    let mesh = decimated(&fine, 560);
    let medial = build_as_many("a small creature", &mesh, 28)?;
    let stands = Model::new(mesh, skeleton, medial);
    let mut random = Random(9);
    let mut actors: Vec<Actor> = (0..15)
        .map(|k| {
            let angle = TAU * 0.618_034 * k as Real;
            let out = 1.35 * ((k as Real + 0.6) / 15.0).sqrt();
            let height = 3.2 + 0.55 * k as Real;
            let place = Vector::new(out * angle.cos(), height, out * angle.sin());
            let pose = Pose::new(place, random.direction() * random.between(0.0, 1.2));
            still(
                &rings,
                RigidBodyBuilder::dynamic().pose(pose).angular_damping(0.5),
            )
        })
        .collect();
    actors.push(still(&stands, RigidBodyBuilder::fixed()));
    Ok(Scene::new(actors))
}
