//! rapier's character controller on a creature: a body with thick and thin limbs, walked over by a capsule, a ball and
//! a cuboid in all directions. Overlap is judged in `f64`, by sampling the creature's spheres against the character's
//! closed form.

use crate::bodies::attached;
use crate::rng::Rng;
use rapier3d::control::KinematicCharacterController;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// A character, its half extents or radii, and its signed distance to a point.
type Character = (&'static str, SharedShape, fn([f64; 3]) -> f64);

fn characters() -> [Character; 3] {
    let capsule = |[x, y, z]: [f64; 3]| x.hypot(z).hypot((y.abs() - 0.3).max(0.0)) - 0.2;
    let ball = |[x, y, z]: [f64; 3]| x.hypot(y).hypot(z) - 0.3;
    let cuboid = |[x, y, z]: [f64; 3]| {
        let beyond = [x.abs() - 0.2, y.abs() - 0.4, z.abs() - 0.2];
        let [a, b, c] = beyond.map(|d| d.max(0.0));
        a.hypot(b).hypot(c) + beyond[0].max(beyond[1]).max(beyond[2]).min(0.0)
    };
    [
        ("capsule", SharedShape::capsule_y(0.3, 0.2), capsule),
        ("ball", SharedShape::ball(0.3), ball),
        ("cuboid", SharedShape::cuboid(0.2, 0.4, 0.2), cuboid),
    ]
}

/// A trunk with limbs that end thin, the ears slabs: 6 m long.
fn creature(seed: u64) -> MedialMesh {
    let mut random = Rng::new(seed);
    let mut draw = |low: f64, high: f64| random.range(low, high) as Real;
    let mut spheres = vec![
        MedialSphere::new(Vector::new(-1.6, 0.0, 0.0), 0.7),
        MedialSphere::new(Vector::new(0.0, 0.2, 0.1), 0.9),
        MedialSphere::new(Vector::new(1.7, 0.1, -0.1), 0.5),
    ];
    let mut edges = vec![[0, 1], [1, 2]];
    for limb in 0..9 {
        let mut last = limb % 3;
        let mut at = spheres[last as usize].center;
        let way = Vector::new(draw(-0.6, 0.6), draw(-0.5, 1.0), draw(-1.0, 1.0)).normalize();
        for radius in [0.3, 0.12, draw(0.01, 0.08)] {
            at += way * draw(0.5, 0.8) + Vector::new(0.0, draw(-0.2, 0.2), draw(-0.2, 0.2));
            spheres.push(MedialSphere::new(at, radius));
            edges.push([last, spheres.len() as u32 - 1]);
            last = spheres.len() as u32 - 1;
        }
    }
    let ear = spheres.len() as u32;
    for z in [-0.7, 0.7] {
        let tip = Vector::new(2.3, draw(0.9, 1.3), z);
        spheres.push(MedialSphere::new(tip, 0.03));
    }
    MedialMesh::new(spheres, edges, vec![[2, ear, ear + 1]]).expect("a creature")
}

/// Centres and radii of spheres all over a mesh.
fn samples(mesh: &MedialMesh) -> Vec<(Vector, f64)> {
    const SIDE: usize = 40;
    let of = |spheres: [MedialSphere; 3], i: usize, j: usize| {
        let weights = [i, j, SIDE - i - j].map(|k| k as Real / SIDE as Real);
        let sum = |part: fn(&MedialSphere) -> Vector| -> Vector {
            (0..3).map(|k| part(&spheres[k]) * weights[k]).sum()
        };
        let radius = sum(|s| Vector::X * s.radius).x;
        (sum(|s| s.center), f64::from(radius))
    };
    let grid = || (0..=SIDE).flat_map(|i| (0..=SIDE - i).map(move |j| (i, j)));
    let primitives = mesh.primitives();
    primitives
        .flat_map(|p| grid().map(move |(i, j)| of(p.as_slab(), i, j)))
        .collect()
}

#[test]
fn characters_walk_over_creatures_without_overlapping_them() {
    for seed in 0..3 {
        let mesh = creature(seed);
        let samples = samples(&mesh);
        let mut world = PhysicsWorld::new();
        let _pipeline = attached(&mut world);
        world.insert_collider(ColliderBuilder::medial_mesh(mesh), None);
        world.detect_collisions(&(), &());
        let controller = KinematicCharacterController::default();
        for (name, shape, distance) in characters() {
            let (mut overlaps, mut near) = (0, 0);
            for walk in 0..12 {
                let (sin, cos) = (0.52 * walk as Real + 0.1).sin_cos();
                let speed = [0.02, 0.07, 0.2][walk % 3];
                let mut at = Vector::new(1.3 * cos, 4.0, 0.6 * sin);
                for step in 0..120 {
                    let wish = match step < 40 {
                        true => Vector::NEG_Y * 0.12,
                        false => Vector::new(cos * speed, -0.03, sin * speed),
                    };
                    let queries = world.query_pipeline();
                    let pose = Pose::from_translation(at);
                    let moved =
                        controller.move_shape(1.0 / 60.0, &queries, &*shape, &pose, wish, |_| ());
                    at += moved.translation;
                    let gap = |(center, radius): &(Vector, f64)| {
                        distance((*center - at).to_array().map(f64::from)) - radius
                    };
                    let gap = samples.iter().map(gap).fold(f64::MAX, f64::min);
                    overlaps += u32::from(gap < 0.0);
                    near += u32::from(gap < 0.03);
                }
            }
            println!("creature {seed}, {name}: {overlaps} overlap, {near} of 1440 are near");
            assert_eq!(overlaps, 0, "creature {seed}, {name}");
            assert!(near > 200, "creature {seed}, {name}: {near} moves are near");
        }
    }
}
