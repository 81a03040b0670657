//! No impact gains energy, whatever turns.

use crate::bodies::attached;
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Kinetic energy of a body.
fn energy(body: &RigidBody) -> f64 {
    let mass = &body.mass_properties().local_mprops;
    let spin = body.rotation().inverse() * body.angvel();
    let spin = mass.principal_inertia_local_frame.inverse() * spin;
    let of = |v: Vector, weight: Vector| (v * v * weight).element_sum();
    let turning = of(spin, mass.principal_inertia());
    0.5 * f64::from(of(body.linvel(), Vector::splat(mass.mass())) + turning)
}

/// The largest gain of energy, in units of the energy before, in steps with an impact and without an impulse of the
/// solver: two thin rods 1 m long at 2 × 20 m/s, which turn at up to 40 rad/s.
fn worst_gain(friction: Real, restitution: Real, flights: usize, seed: u64) -> (f64, usize) {
    let mut random = Random(seed);
    let (mut worst, mut impacts) = (0.0, 0);
    for _ in 0..flights {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let mut pipeline = attached(&mut world);
        let rods = [-1.0, 1.0].map(|side: Real| {
            let end = Vector::X * 0.5;
            let spheres = [-end, end].map(|c| MedialSphere::new(c, 0.02));
            let mesh = MedialMesh::new(spheres.to_vec(), vec![[0, 1]], vec![]).expect("a rod");
            let at = Vector::Z * side * random.within(0.3, 0.8) + random.direction() * 0.1;
            let mut body = RigidBodyBuilder::dynamic()
                .pose(Pose::new(at, random.direction() * 3.0))
                .linvel(Vector::Z * -side * 20.0)
                .angvel(random.direction() * 40.0)
                .build();
            body.enable_gyroscopic_forces(false);
            body.set_allow_fast_rotation(true);
            let collider = ColliderBuilder::medial_mesh(mesh);
            let collider = collider.friction(friction).restitution(restitution);
            world.insert(body, collider).0
        });
        for _ in 0..8 {
            let before: f64 = rods.iter().map(|h| energy(&world.bodies[*h])).sum();
            let report = pipeline.step(&mut world);
            let solved = world.narrow_phase.contact_pairs();
            let solved = solved.map(|p| p.total_impulse_magnitude()).sum::<Real>();
            let after: f64 = rods.iter().map(|h| energy(&world.bodies[*h])).sum();
            if report.events > 0 && solved == 0.0 {
                impacts += 1;
                worst = ((after - before) / before).max(worst);
            }
        }
    }
    (worst, impacts)
}

#[test]
fn impacts_of_spinning_rods_gain_no_energy() {
    for (friction, restitution) in [(0.0, 1.0), (0.5, 0.0), (0.8, 0.3), (1.0, 1.0)] {
        let (worst, impacts) = worst_gain(friction, restitution, 150, 2107);
        println!("friction {friction}, restitution {restitution}: {worst} in {impacts} steps");
        assert!(impacts > 40, "{impacts}");
        assert!(
            worst < 1.0e-3,
            "friction {friction}, restitution {restitution}: {worst}"
        );
    }
}
