//! Rows of spikes and wedges that fall on each other: the degenerate contacts of Erleben's tests.

use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// A row of spikes or wedges on a plate, upwards, their tips of radius 0.
fn comb(is_wedge: bool, tips: usize) -> MedialMesh {
    let ball = |x: Real, y: Real, z: Real, r: Real| MedialSphere::new(Vector::new(x, y, z), r);
    let mut spheres = vec![
        ball(-0.5, 0.0, -0.3, 0.1),
        ball(0.5, 0.0, -0.3, 0.1),
        ball(0.5, 0.0, 0.3, 0.1),
        ball(-0.5, 0.0, 0.3, 0.1),
    ];
    let mut faces = vec![[0, 1, 2], [0, 2, 3]];
    let mut edges = Vec::new();
    for k in 0..tips {
        let x = (k as Real + 0.5) / tips as Real - 0.5;
        let first = spheres.len() as u32;
        if is_wedge {
            for z in [-0.3, 0.3] {
                spheres.extend([ball(x, 0.0, z, 0.1), ball(x, 0.5, z, 0.0)]);
            }
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| first + k);
            faces.extend([[a, b, c], [b, d, c]]);
        } else {
            spheres.extend([ball(x, 0.0, 0.0, 0.1), ball(x, 0.5, 0.0, 0.0)]);
            edges.push([first, first + 1]);
        }
    }
    MedialMesh::new(spheres, edges, faces).expect("a comb")
}

/// What became of a row that fell on another.
#[derive(Debug)]
pub struct Dropped {
    /// Largest speed, in metres per second.
    pub fastest: Real,
    /// Least height, in metres.
    pub lowest: Real,
    /// Speed after eight seconds, in metres per second.
    pub speed: Real,
    pub asleep: bool,
}

impl Dropped {
    /// A row falls, tips down, on a fixed one, `aside` in metres, along it or across.
    pub fn comb(is_wedge: bool, aside: Real, across: bool) -> Self {
        let half_turn = std::f32::consts::PI;
        let mut world = PhysicsWorld::new();
        let ground = ColliderBuilder::cuboid(5.0, 0.5, 5.0).translation(Vector::Y * -0.6);
        world.insert_collider(ground, None);
        let mesh = comb(is_wedge, 5);
        let collider = || ColliderBuilder::medial_mesh(mesh.clone()).friction(0.5);
        world.insert(RigidBodyBuilder::fixed(), collider());
        let across = if across { 0.5 * half_turn } else { 0.0 };
        let turn = Rotation::from_rotation_y(across) * Rotation::from_rotation_x(half_turn);
        let at = Vector::new(aside, 1.3, 0.0);
        let body = RigidBodyBuilder::dynamic().pose(Pose::from_parts(at, turn));
        let (body, _) = world.insert(body, collider().density(500.0));
        let mut pipeline = MedialPipeline::default();
        let (mut fastest, mut lowest) = (0.0, Real::MAX);
        for _ in 0..480 {
            pipeline.step(&mut world);
            let body = &world.bodies[body];
            fastest = body.linvel().length().max(fastest);
            lowest = body.translation().y.min(lowest);
        }
        let end = &world.bodies[body];
        Self {
            fastest,
            lowest,
            speed: end.linvel().length(),
            asleep: end.is_sleeping(),
        }
    }
}
