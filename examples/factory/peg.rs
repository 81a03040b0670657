//! Pegs of 8 mm that slide by their weight into holes with 0.05 mm of play, as in Factory: a round one and a square
//! one.

use super::nut::steel;
use super::solid::Mesh;
use super::{Kind, Setting};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::f64::consts::TAU;
use std::time::Instant;

/// Half of the peg's width and of the play, half of the peg's length, depth of the hole, metres.
const HALF: f64 = 4.0e-3;
const PLAY: f64 = 0.025e-3;
const LENGTH: f64 = 25.0e-3;
const DEPTH: f64 = 25.0e-3;
/// Flat walls of the round hole, and the radius of its wall's spheres, metres.
const WALLS: usize = 64;
const WALL: f64 = 3.0e-3;

/// The peg's shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    Round,
    Square,
}

/// How a peg went.
#[derive(Clone, Debug, Default)]
pub struct Slide {
    /// Seconds until its tip was at the hole's bottom, if it came there.
    pub seconds: Option<f64>,
    /// How far its tip was in the hole in the end, metres.
    pub inside: f64,
    /// Deepest that a point of the peg was in the wall, metres.
    pub depth: f64,
    /// Milliseconds of steps: median and worst.
    pub milliseconds: [f64; 2],
    /// Poses of the peg after each step.
    pub poses: Vec<Pose>,
}

/// Seconds that it falls freely into the hole.
pub fn free_fall() -> f64 {
    (2.0 * (DEPTH - START) / 9.81).sqrt()
}

/// How far the tip is in the hole at the start, metres.
const START: f64 = 1.0e-3;

/// Collider of the hole whose upper end is at the height 0, open at both ends, and of the peg.
pub fn colliders(shape: Shape, kind: Kind) -> Result<[ColliderBuilder; 2], String> {
    if kind == Kind::Medial {
        let [hole, peg] = match shape {
            Shape::Round => [
                round_hole(),
                MedialMesh::capsule(axis(-LENGTH + HALF), axis(LENGTH - HALF), HALF as Real),
            ],
            Shape::Square => [
                square_hole(),
                MedialMesh::cuboid(Vector::new(HALF as Real, LENGTH as Real, HALF as Real)),
            ],
        };
        let [hole, peg] = [hole, peg].map(|mesh| mesh.map_err(|e| e.to_string()));
        let [hole, peg] = [hole?, peg?];
        let mass = steel(&peg.mass_properties(1.0));
        return Ok([
            ColliderBuilder::medial_mesh(hole),
            ColliderBuilder::medial_mesh(peg).mass_properties(mass),
        ]);
    }
    let around = if shape == Shape::Round { WALLS } else { 4 };
    let polygon = |apothem: f64| {
        move |angle: f64, _: f64| {
            let side = TAU / around as f64;
            let to_flat = (angle / side + 0.5).rem_euclid(1.0) - 0.5;
            apothem / (to_flat * side).cos()
        }
    };
    let hole = Mesh::lathe(
        &[-DEPTH, -0.5 * DEPTH, 0.0],
        2 * around,
        polygon(HALF + 2.0 * WALL),
        Some(polygon(HALF + PLAY)),
    );
    let peg = match shape {
        Shape::Round => ColliderBuilder::capsule_y((LENGTH - HALF) as Real, HALF as Real),
        Shape::Square => ColliderBuilder::cuboid(HALF as Real, LENGTH as Real, HALF as Real),
    };
    Ok([
        kind.collider(hole.vertices, hole.indices)?,
        peg.density(7850.0),
    ])
}

fn axis(y: f64) -> Vector {
    Vector::Y * y as Real
}

/// Flat walls, as far from the axis as the true hole.
fn round_hole() -> Result<MedialMesh, MeshError> {
    let corner = (HALF + PLAY + WALL) / (0.5 * TAU / WALLS as f64).cos();
    let at = |k: usize, y: f64| {
        let (sin, cos) = (TAU * k as f64 / WALLS as f64).sin_cos();
        let center = [corner * cos, y, -corner * sin].map(|c| c as Real);
        MedialSphere::new(Vector::from_array(center), WALL as Real)
    };
    walls(WALLS, at)
}

fn square_hole() -> Result<MedialMesh, MeshError> {
    let corner = HALF + PLAY + WALL;
    let at = |k: usize, y: f64| {
        let (x, z) = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)][k % 4];
        let center = [corner * x, y, corner * z].map(|c| c as Real);
        MedialSphere::new(Vector::from_array(center), WALL as Real)
    };
    walls(4, at)
}

fn walls(count: usize, at: impl Fn(usize, f64) -> MedialSphere) -> Result<MedialMesh, MeshError> {
    let ends = [-DEPTH + WALL, -WALL];
    let spheres = (0..count).flat_map(|k| ends.map(|y| at(k, y))).collect();
    let wall = |k: usize| {
        let [a, b] = [k, (k + 1) % count].map(|k| 2 * k as u32);
        [[a, a + 1, b], [a + 1, b + 1, b]]
    };
    MedialMesh::new(spheres, Vec::new(), (0..count).flat_map(wall).collect())
}

/// Deepest that a point of the peg within the hole's height is in its wall, metres.
fn deepest(shape: Shape, pose: &Pose) -> f64 {
    let mut deepest = f64::MIN;
    for k in 0..32 {
        let (sin, cos) = (TAU * f64::from(k) / 32.0).sin_cos();
        let reach = match shape {
            Shape::Round => 1.0,
            Shape::Square => 1.0 / sin.abs().max(cos.abs()),
        };
        for step in 0..=20 {
            let y = (f64::from(step) / 10.0 - 1.0) * (LENGTH - HALF);
            let local = [HALF * reach * cos, y, HALF * reach * sin];
            let rotated = pose.rotation.as_dquat() * rapier3d::glamx::DVec3::from_array(local);
            let p = rotated + pose.translation.as_dvec3();
            if !(-DEPTH + WALL..-WALL).contains(&p.y) {
                continue;
            }
            let out = match shape {
                Shape::Round => p.x.hypot(p.z),
                Shape::Square => p.x.abs().max(p.z.abs()),
            };
            deepest = deepest.max(out - HALF - PLAY);
        }
    }
    deepest
}

/// Lets a peg go at the mouth of its hole, a fifth of the play to the side and leaning, for a second at most.
pub fn slide(
    shape: Shape,
    [hole, peg]: &[ColliderBuilder; 2],
    kind: Kind,
    setting: &Setting,
) -> Slide {
    let mut world = setting.world();
    world.insert(RigidBodyBuilder::fixed(), hole.clone().friction(0.0));
    let start = Vector::new(0.2 * PLAY as Real, (LENGTH - START) as Real, 0.0);
    let body = RigidBodyBuilder::dynamic()
        .can_sleep(false)
        .translation(start)
        .rotation(Vector::Z * 1.0e-3);
    let (body, _) = world.insert(body, peg.clone().friction(0.0));
    let mut pipeline = MedialPipeline::default();
    let (mut slide, mut times) = (Slide::default(), Vec::new());
    for step in 1..=setting.hertz as usize {
        let clock = Instant::now();
        if kind == Kind::Medial {
            pipeline.step(&mut world);
        } else {
            world.step();
        }
        times.push(1.0e3 * clock.elapsed().as_secs_f64());
        let pose = *world.bodies[body].position();
        slide.inside = LENGTH - f64::from(pose.translation.y);
        slide.depth = slide.depth.max(deepest(shape, &pose));
        slide.poses.push(pose);
        if slide.inside > DEPTH {
            slide.seconds = Some(step as f64 / f64::from(setting.hertz));
            break;
        }
    }
    times.sort_by(f64::total_cmp);
    slide.milliseconds = [times[times.len() / 2], times[times.len() - 1]];
    slide
}
