//! Bodies whose velocity drives them along an axis that is locked: no contact slows them down along it, since none
//! moves them.

use crate::bodies::{attached, ring, world_with_ground};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Speed along the locked axis, metres per second.
const DOWN: Real = 5.0;

/// Symptom: a box of which the vertical axis is locked, and which moves down, touched the ground below its centre and
/// got 10⁶ rad/s and more; rods and rings lost their velocity instead. Cause: the impulse that stops the point of
/// contact by turning the body alone has no bound where its lever is short, and forces that rapier never adds along a
/// locked axis were taken back. rapier's own shapes pass through the ground, some of them at hundreds of rad/s.
#[test]
fn bodies_driven_along_a_locked_axis_are_held_by_the_ground() {
    let meshes = [
        MedialMesh::round_cuboid(Vector::splat(0.135), 0.015),
        MedialMesh::capsule(Vector::X * -0.2, Vector::X * 0.2, 0.06),
        Ok(ring(12, 0.2, 0.05)),
    ];
    for mesh in meshes {
        let mesh = mesh.expect("a mesh");
        for axes in [
            LockedAxes::TRANSLATION_LOCKED_Y,
            LockedAxes::TRANSLATION_LOCKED,
            LockedAxes::TRANSLATION_LOCKED_Y | LockedAxes::ROTATION_LOCKED,
        ] {
            let mut world = world_with_ground();
            let mut pipeline = attached(&mut world);
            let body = RigidBodyBuilder::dynamic()
                .pose(Pose::new(Vector::Y * 0.4, Vector::Z * 0.1))
                .linvel(Vector::new(1.0, -DOWN, 0.0))
                .locked_axes(axes);
            let (body, _) = world.insert(body, ColliderBuilder::medial_mesh(mesh.clone()));
            let mut fastest: [Real; 2] = [0.0; 2];
            for _ in 0..120 {
                pipeline.step(&mut world);
                let body = &world.bodies[body];
                let now = [body.linvel().length(), body.angvel().length()];
                fastest = [0, 1].map(|k| fastest[k].max(now[k]));
            }
            let body = &world.bodies[body];
            let (y, down) = (body.translation().y, -body.linvel().y);
            println!("{axes:?}: at {y}, {down} m/s down; at most {fastest:?} m/s and rad/s");
            assert!(y > -1.0e-3, "{axes:?}: it is at {y}");
            assert!((down - DOWN).abs() < 1.0e-3, "{axes:?}: {down} m/s down");
            assert!(fastest[0] < 2.0 * DOWN, "{axes:?}: {} m/s", fastest[0]);
            assert!(fastest[1] < 100.0, "{axes:?}: {} rad/s", fastest[1]);
        }
    }
}
