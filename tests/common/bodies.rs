//! Bodies and worlds that the scenes share.

use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Radius of a ring's centre line, in metres.
pub const MAJOR: Real = 0.5;
/// Radius of a ring's tube, in metres.
pub const MINOR: Real = 0.1;

/// A ring of `n` equal cones about the Y axis, with the mass properties of a true torus.
pub fn ring(n: u32, major: Real, minor: Real) -> MedialMesh {
    use std::f32::consts::{PI, TAU};
    let spheres = (0..n)
        .map(|i| {
            let angle = i as Real / n as Real * TAU;
            let center = Vector::new(major * angle.cos(), 0.0, major * angle.sin());
            MedialSphere::new(center, minor)
        })
        .collect();
    let edges = (0..n).map(|i| [i, (i + 1) % n]).collect();
    let mass = 2.0 * PI * PI * major * minor * minor;
    let about_axis = mass * (major * major + 0.75 * minor * minor);
    let across = mass * (0.5 * major * major + 0.625 * minor * minor);
    let inertia = Vector::new(across, about_axis, across);
    MedialMesh::new(spheres, edges, vec![])
        .expect("a ring is a medial mesh")
        .with_mass_properties(MassProperties::new(Vector::ZERO, mass, inertia))
}

/// rapier's own compound of capsules in place of a mesh of equally thick cones.
pub fn capsules(mesh: &MedialMesh) -> ColliderBuilder {
    let capsule = |edge: &[u32; 2]| {
        let [a, b] = edge.map(|k| mesh.spheres()[k as usize]);
        (
            Pose::IDENTITY,
            SharedShape::capsule(a.center, b.center, a.radius),
        )
    };
    ColliderBuilder::compound(mesh.edges().iter().map(capsule).collect())
}

/// How a body is represented.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum As {
    Medial,
    Hull,
}

/// The collider of a ring.
pub fn ring_collider(kind: As) -> ColliderBuilder {
    let mesh = ring(27, MAJOR, MINOR);
    match kind {
        As::Medial => ColliderBuilder::medial_mesh(mesh).density(1000.0),
        As::Hull => {
            let around = |c: Vector| {
                [Vector::X, Vector::Y, Vector::Z]
                    .into_iter()
                    .flat_map(move |axis| [c + axis * MINOR, c - axis * MINOR])
            };
            let points: Vec<Vector> = mesh
                .spheres()
                .iter()
                .flat_map(|s| around(s.center))
                .collect();
            ColliderBuilder::convex_hull(&points)
                .expect("a hull of a ring")
                .density(1000.0)
        }
    }
}

/// A world on a fixed ground whose surface is the plane Y = 0.
pub fn world_with_ground() -> PhysicsWorld {
    let mut world = PhysicsWorld::new();
    world.insert_collider(
        ColliderBuilder::cuboid(20.0, 0.5, 20.0).translation(Vector::new(0.0, -0.5, 0.0)),
        None,
    );
    world
}

/// Adds a ring at a pose.
pub fn add_ring(world: &mut PhysicsWorld, kind: As, pose: Pose) -> RigidBodyHandle {
    world
        .insert(RigidBodyBuilder::dynamic().pose(pose), ring_collider(kind))
        .0
}

/// Steps until all bodies sleep; the number of steps, or `None` after `limit`.
pub fn steps_until_sleep(
    world: &mut PhysicsWorld,
    pipeline: &mut MedialPipeline,
    limit: usize,
) -> Option<usize> {
    for step in 0..limit {
        pipeline.step(world);
        let asleep = |b: &RigidBody| !b.is_dynamic() || b.is_sleeping();
        if world.bodies.iter().all(|(_, b)| asleep(b)) {
            return Some(step + 1);
        }
    }
    None
}

/// A world's own pipeline, attached. Contacts of rapier's own shapes are kept no longer than in steps with medial
/// colliders, so that scenes of either can be compared.
pub fn attached(world: &mut PhysicsWorld) -> MedialPipeline {
    let parameters = &mut world.integration_parameters;
    parameters.normalized_contact_recycle_distance = rapier3d_medial::rapier::RECYCLE_DISTANCE;
    let mut pipeline = MedialPipeline::new(MedialOptions::default());
    pipeline.attach(world);
    pipeline
}

/// Boxes that overlap, by their centres and half sides.
pub fn boxes(all: &[(Vector, Vector)]) -> (Vec<Vector>, Vec<[u32; 3]>) {
    let (mut vertices, mut indices) = (Vec::new(), Vec::new());
    for (at, half) in all {
        let (points, triangles) = Cuboid::new(*half).to_trimesh();
        let first = vertices.len() as u32;
        vertices.extend(points.into_iter().map(|p| p + *at));
        indices.extend(triangles.into_iter().map(|t| t.map(|v| v + first)));
    }
    (vertices, indices)
}

/// A plateau of triangles in cells of a metre at height 0, which ends with a cliff 3 m high at x = 0; its internal
/// edges are fixed.
pub fn plateau() -> ColliderBuilder {
    let line = |k: i32| (-5..6).map(move |j| Vector::new((k - 10) as Real, 0.0, j as Real));
    let mut vertices: Vec<_> = (0..11).flat_map(line).collect();
    let pair = |i: u32, j: u32| {
        let [a, b] = [i * 11 + j, (i + 1) * 11 + j];
        [[a, a + 1, b + 1], [a, b + 1, b]]
    };
    let cells = (0..10).flat_map(|i| (0..10).flat_map(move |j| pair(i, j)));
    let mut triangles: Vec<_> = cells.collect();
    // The cliff, 3 m high.
    vertices.extend((-5..6).map(|j| Vector::new(0.0, -3.0, j as Real)));
    triangles.extend((0..10).flat_map(|j| {
        let [a, b] = [110 + j, 121 + j];
        [[a, a + 1, b + 1], [a, b + 1, b]]
    }));
    let flags = TriMeshFlags::FIX_INTERNAL_EDGES;
    let plateau = ColliderBuilder::trimesh_with_flags(vertices, triangles, flags);
    plateau.expect("a plateau")
}

/// A table of eight sides, 1 m high about the origin, with an edge at x = 4 m.
pub fn octagon() -> Vec<Vector> {
    let corners = (0..8).flat_map(|k| {
        let (z, x) = ((k as Real + 0.5) * std::f32::consts::FRAC_PI_4).sin_cos();
        let out = 4.0 / (0.5 * std::f32::consts::FRAC_PI_4).cos();
        [-0.5, 0.5].map(|y| Vector::new(out * x, y, out * z))
    });
    corners.collect()
}

/// The bits of all poses and velocities, and who sleeps.
pub fn bits(world: &PhysicsWorld) -> Vec<u32> {
    let mut all = Vec::new();
    for (handle, b) in world.bodies.iter() {
        let (t, r, v, w) = (b.translation(), b.rotation(), b.linvel(), b.angvel());
        all.push(handle.into_raw_parts().0);
        all.extend([t.x, t.y, t.z, r.x, r.y, r.z, r.w].map(Real::to_bits));
        all.extend([v.x, v.y, v.z, w.x, w.y, w.z].map(Real::to_bits));
        all.push(u32::from(b.is_sleeping()));
    }
    all
}
