//! Meshes with several of the planted defects.

use crate::broken::*;
use crate::meshes::*;
use crate::oracle::Random;
use parry3d::math::Vector;

/// Two balls, one that lost triangles and one that is inside out, unwelded and some triangles
/// repeated, with a card through the first, a card beside them, and stray vertices.
pub fn everything() -> Mesh {
    let beside = |x: f32| move |v: Vector| v + Vector::new(x, 0.0, 0.0);
    let wings = card(4).map(|v| Vector::new(3.0 * v.x - 1.5, v.y - 0.5, 0.1));
    let mesh = lose(ball(1.0), 3, 11)
        .and(ball(1.0).inside_out().map(beside(4.0)))
        .and(wings)
        .and(card(3).map(|v| v + Vector::new(1.7, 1.0, 0.5)));
    with_stray_vertices(repeat(unweld(mesh)))
}

/// One to three parts, each with some defects, all by the seed.
pub fn combined(seed: u64) -> Mesh {
    let mut random = Random(seed);
    let mut all = Mesh {
        vertices: vec![],
        indices: vec![],
    };
    for _ in 0..1 + random.bits() % 3 {
        let mut part = match random.bits() % 6 {
            0 => block(),
            1 => ball(0.6),
            2 => disc(2),
            3 => l_shape(),
            4 => plate(10f32.powf(random.within(-4.0, -1.0) as f32)),
            _ => soup(6, random.bits()),
        };
        for _ in 0..random.bits() % 4 {
            let seed = random.bits();
            part = match random.bits() % 8 {
                0 => part.inside_out(),
                1 => turn_some(part, seed),
                2 => unweld(part),
                3 => lose(refine(part, 1), 3, seed),
                4 => repeat(part),
                5 => apart(part, 1e-3),
                6 => shaken(part, seed),
                _ => with_stray_vertices(part),
            };
        }
        let turn = random.within(0.0, 6.0) as f32;
        let shift = random.vector(0.8);
        let (sin, cos) = turn.sin_cos();
        all = all.and(
            part.map(|v| shift + Vector::new(v.x * cos - v.z * sin, v.y, v.x * sin + v.z * cos)),
        );
    }
    let scale = 10f32.powf(random.within(-3.0, 5.0) as f32);
    all.map(|v| v * scale)
}

/// Moves each vertex at random, so that surfaces pass through themselves.
fn shaken(mut mesh: Mesh, seed: u64) -> Mesh {
    let mut random = Random(seed);
    mesh.vertices
        .iter_mut()
        .for_each(|v| *v += random.vector(0.05));
    mesh
}
