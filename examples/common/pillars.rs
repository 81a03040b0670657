//! Bodies of five shapes above a field of pillars 5 mm thin (the paper's Figures 5 and 9).

use super::build::{build_as_many, capsule_model};
use super::mesh::{Mesh, ring};
use super::random::Random;
use super::scene::{Actor, Model, Scene};
use super::scene_strip::{SLATE, rainbow};
use super::skeleton::Skeleton;
use super::skin::{Limb, skin};
use rapier3d::prelude::*;
use std::sync::Arc;

/// Half the height of a pillar's axis, and its radius, in metres.
const PILLAR: (Real, Real) = (0.6, 0.0025);
/// Pillars along each side of the field, and their distance in metres.
const FIELD: (usize, Real) = (6, 0.32);
const BODIES: usize = 15;

/// The bodies above the field, thrown down and to the side; then the pillars. `cell`, in metres, is the
/// side of a grid's cubes that the bodies' meshes are made with; the five shapes share `primitives`.
pub fn field(cell: Real, primitives: usize) -> Result<Scene, String> {
    let shapes = shapes(cell, primitives)?;
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
    let pillar = capsule_model(half, radius, 8)?;
    let (side, apart) = FIELD;
    actors.extend((0..side * side).map(|k| {
        let at = |n: usize| apart * (n as Real - (side - 1) as Real / 2.0);
        let place = Vector::new(at(k / side), half + radius, at(k % side));
        Actor::new(&pillar, RigidBodyBuilder::fixed().translation(place), SLATE)
    }));
    Ok(Scene::new(actors))
}

/// A ring, a jack, a hook, a dumb-bell and a frame of three legs.
fn shapes(cell: Real, primitives: usize) -> Result<Vec<Arc<Model>>, String> {
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
    let along = (0.45 / cell) as u32;
    let mesh = ring(0.2, 0.04, along, (0.17 / cell) as u32);
    let mut sources = vec![(mesh, Skeleton::ring(0.2, 0.04, along))];
    sources.extend([jack, hook, bell, legs].map(|limbs| skin(&limbs, cell)));
    // Where a shape has use for fewer than its share, the next ones get the rest.
    let (mut left, mut shapes) = (primitives, Vec::new());
    for (number, (mesh, skeleton)) in sources.into_iter().enumerate() {
        let shape = model(mesh, skeleton, left / (5 - number))?;
        left = left.saturating_sub(shape.medial.primitive_count());
        shapes.push(shape);
    }
    Ok(shapes)
}

fn model(mesh: Mesh, skeleton: Skeleton, primitives: usize) -> Result<Arc<Model>, String> {
    mesh.check_closed()?;
    let medial = build_as_many("build a shape", &mesh, primitives)?;
    Ok(Model::new(mesh, skeleton, medial))
}
