//! A joint of a multibody that is inserted between two bodies moves the second one to where it holds it, in one step:
//! into the ground, or into the first.

use crate::bodies::{attached, ring};
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// What became of two bodies after a joint had held them for a second.
#[derive(Default)]
struct Ends {
    /// Bodies that are deep in the ground: their middle is no higher than half their thickness.
    sunk: usize,
    /// Bodies that are awake.
    awake: usize,
    /// Fastest body at any time, in metres per second.
    fastest: Real,
    /// Steps in which a body was held.
    frozen: usize,
}

/// Rings and crosses rest beside each other on a cuboid. A hinge whose axes do not fit takes the second into the
/// ground, or aside; after a second it is removed, and the two have six seconds to come to rest.
fn ends(is_medial: bool, seed: u64) -> Ends {
    let mut random = Random(seed + 1);
    let mut world = PhysicsWorld::new();
    let mut pipeline = attached(&mut world);
    let ground = ColliderBuilder::cuboid(20.0, 0.5, 20.0).translation(Vector::NEG_Y * 0.5);
    world.insert_collider(ground, None);
    let mut put = |x: Real, is_ring: bool| {
        let mesh = match is_ring {
            true => ring(16, 0.3, 0.08),
            false => cross(),
        };
        let collider = match is_medial {
            true => ColliderBuilder::medial_mesh(mesh.clone()),
            false => crate::bodies::capsules(&mesh),
        };
        let at = Pose::new(Vector::new(x, 0.7, 0.0), random.direction() * 2.0);
        let body = RigidBodyBuilder::dynamic().pose(at);
        let mass = mesh.mass_properties(500.0);
        world.insert(body, collider.mass_properties(mass)).0
    };
    let bodies = [
        put(0.0, seed.is_multiple_of(2)),
        put(0.9, seed.is_multiple_of(3)),
    ];
    let mut ends = Ends::default();
    let mut joint = None;
    for step in 0..540 {
        if step == 120 {
            let poses = bodies.map(|b| *world.bodies[b].position());
            let middle = (poses[0].translation + poses[1].translation) * 0.5;
            let hinge = RevoluteJointBuilder::new(random.direction())
                .local_anchor1(poses[0].inverse() * middle)
                .local_anchor2(poses[1].inverse() * middle);
            joint = world.insert_multibody_joint(bodies[0], bodies[1], hinge);
        }
        if step == 180
            && let Some(joint) = joint.take()
        {
            world.remove_multibody_joint(joint);
        }
        match is_medial {
            true => ends.frozen += pipeline.step(&mut world).frozen,
            false => world.step(),
        }
        let speeds = bodies.map(|b| world.bodies[b].linvel().length());
        ends.fastest = speeds.into_iter().fold(ends.fastest, Real::max);
    }
    for body in bodies.map(|b| &world.bodies[b]) {
        ends.sunk += usize::from(body.translation().y < 0.04);
        ends.awake += usize::from(!body.is_sleeping());
    }
    ends
}

/// Six arms from one middle.
fn cross() -> MedialMesh {
    let ends = [Vector::X, Vector::Y, Vector::Z].map(|axis| axis * 0.3);
    let ends = ends.into_iter().flat_map(|end| [end, -end]);
    let centers = std::iter::once(Vector::ZERO).chain(ends);
    let spheres = centers.map(|center| MedialSphere::new(center, 0.08));
    let edges = (1..7).map(|k| [0, k]).collect();
    MedialMesh::new(spheres.collect(), edges, vec![]).expect("a cross")
}

#[test]
fn bodies_that_a_new_multibody_joint_moves_come_out_as_rapiers() {
    let sum = |is_medial: bool| {
        let mut sum = Ends::default();
        for seed in 0..40 {
            let ends = ends(is_medial, seed);
            sum.sunk += ends.sunk;
            sum.awake += ends.awake;
            sum.frozen += ends.frozen;
            sum.fastest = sum.fastest.max(ends.fastest);
        }
        sum
    };
    let [own, ours] = [false, true].map(sum);
    for (whose, e) in [("rapier's", &own), ("medial", &ours)] {
        println!(
            "{whose}: {} sunk and {} awake of 80, up to {:.1} m/s, held {} times",
            e.sunk, e.awake, e.fastest, e.frozen
        );
    }
    assert!(ours.sunk <= own.sunk, "{} of 80 in the ground", ours.sunk);
    assert!(ours.awake <= own.awake + 2, "{} of 80 awake", ours.awake);
    assert!(ours.fastest < 1.5 * own.fastest, "{} m/s", ours.fastest);
}
