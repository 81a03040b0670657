//! A wheel that rolls freely on a cuboid.

use super::bodies::capsules;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Speed of a torus of 96 cones, or of rapier's capsules in its place, that begins to roll at 1 m/s without slip, after
/// three seconds.
pub fn wheel_rolled(is_medial: bool) -> Real {
    let mut world = PhysicsWorld::new();
    let ground = ColliderBuilder::cuboid(20.0, 0.5, 20.0).translation(Vector::Y * -0.5);
    world.insert_collider(ground.friction(1.0), None);
    let mesh = MedialMesh::torus(0.15, 0.1, 96).expect("a wheel");
    let mass = mesh.mass_properties(1000.0);
    let collider = match is_medial {
        true => ColliderBuilder::medial_mesh(mesh),
        false => capsules(&mesh),
    };
    let upright = Vector::X * std::f32::consts::FRAC_PI_2;
    let body = RigidBodyBuilder::dynamic()
        .pose(Pose::new(Vector::new(-8.0, 0.25, 0.0), upright))
        .linvel(Vector::X)
        .angvel(Vector::NEG_Z * 4.0)
        .can_sleep(false);
    let (wheel, _) = world.insert(body, collider.mass_properties(mass).friction(1.0));
    let mut pipeline = MedialPipeline::default();
    for _ in 0..180 {
        match is_medial {
            true => drop(pipeline.step(&mut world)),
            false => world.step(),
        }
    }
    world.bodies[wheel].linvel().x
}
