//! Two cuboid fingers on prismatic motors close on a medial body and lift it; beside them rapier's own shapes of the
//! same sizes.

use crate::bodies::attached;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

#[derive(Clone, Copy, Debug)]
enum Thing {
    Ring,
    Box,
    Rod,
}

/// What a thing is made of: of a medial mesh, of rapier's capsules and cuboids, or of convex hulls in place of the
/// capsules.
#[derive(Clone, Copy, Debug, PartialEq)]
enum As {
    Medial,
    Capsules,
    Hulls,
}

/// A thing of 0.2 to 0.5 m.
fn thing(thing: Thing, made: As) -> ColliderBuilder {
    let half_rod = Vector::Z * 0.2;
    if made == As::Medial {
        let mesh = match thing {
            Thing::Ring => MedialMesh::torus(0.15, 0.05, 24),
            Thing::Box => MedialMesh::round_cuboid(Vector::splat(0.09), 0.01),
            Thing::Rod => MedialMesh::capsule(-half_rod, half_rod, 0.05),
        };
        return ColliderBuilder::medial_mesh(mesh.expect("a thing"));
    }
    let capsule = |a: Vector, b: Vector| match made {
        As::Hulls => hull_of_capsule(a, b, 0.05),
        _ => SharedShape::capsule(a, b, 0.05),
    };
    match thing {
        Thing::Ring => {
            let at = |i: u32| {
                let (sin, cos) = (i as Real / 24.0 * std::f32::consts::TAU).sin_cos();
                Vector::new(cos, 0.0, sin) * 0.15
            };
            let part = |i: u32| (Pose::IDENTITY, capsule(at(i), at(i + 1)));
            ColliderBuilder::compound((0..24).map(part).collect())
        }
        Thing::Box => ColliderBuilder::cuboid(0.1, 0.1, 0.1),
        Thing::Rod => ColliderBuilder::new(capsule(-half_rod, half_rod)),
    }
}

/// The convex hull of four circles of 64 points, two of them the capsule's own and one on each of its caps.
fn hull_of_capsule(a: Vector, b: Vector, radius: Real) -> SharedShape {
    let along = (b - a).normalize();
    let (side, other) = along.any_orthonormal_pair();
    let mut points = Vec::new();
    for i in 0..64 {
        let (sin, cos) = (i as Real / 64.0 * std::f32::consts::TAU).sin_cos();
        let out = (side * cos + other * sin) * radius;
        let cap = out * 0.5 + along * 0.75_f32.sqrt() * radius;
        points.extend([a + out, b + out, b + cap, a + cap.reflect(along)]);
    }
    SharedShape::convex_hull(&points).expect("a hull")
}

#[derive(Clone, Copy, Debug)]
struct Grasp {
    /// Mass of the thing and of a finger, kg.
    mass: Real,
    finger: Real,
    /// Half of its thickness, metres.
    thick: Real,
    /// Speed at which it closes, metres per second.
    speed: Real,
    friction: Real,
    /// Whether motors go to a position, or at a speed.
    to_position: bool,
    /// With how much at most, newtons.
    force: Real,
}

/// What became of a grasp.
struct Lift {
    /// How high the thing got while its fingers rose by 0.46 m, and how far aside.
    up: Real,
    aside: Real,
    /// The largest change of a finger's vertical speed in a step of the rise, metres per second.
    jump: Real,
}

impl Grasp {
    fn holds(self, what: Thing, made: As) -> bool {
        let Lift { up, aside, .. } = self.lift(what, made);
        up > 0.35 && aside < 0.2
    }

    fn lift(self, what: Thing, made: As) -> Lift {
        let mut world = PhysicsWorld::new();
        let mut pipeline = attached(&mut world);
        let ground = ColliderBuilder::cuboid(3.0, 0.5, 3.0).translation(Vector::NEG_Y * 0.5);
        world.insert_collider(ground.friction(self.friction), None);
        let height = if matches!(what, Thing::Box) {
            0.1
        } else {
            0.05
        };
        let body = RigidBodyBuilder::dynamic().translation(Vector::Y * height);
        let collider = thing(what, made).mass(self.mass).friction(self.friction);
        let (object, _) = world.insert(body.can_sleep(false), collider);
        let base = RigidBodyBuilder::kinematic_velocity_based().translation(Vector::Y * 0.5);
        let base = world.bodies.insert(base);
        let fingers = [-1.0, 1.0].map(|side: Real| {
            let at = Vector::new(side * 0.35, 0.12, 0.0);
            let body = RigidBodyBuilder::dynamic().translation(at).can_sleep(false);
            let finger = ColliderBuilder::cuboid(self.thick, 0.1, 0.1);
            let finger = finger.mass(self.finger).friction(self.friction);
            let (finger, _) = world.insert(body, finger);
            let joint = PrismaticJointBuilder::new(Vector::X)
                .local_anchor1(at - Vector::Y * 0.5)
                .motor_model(MotorModel::ForceBased)
                .motor_max_force(self.force);
            let joint = if self.to_position {
                joint.motor_position(-side * 0.35, 100.0, 5.0)
            } else {
                joint.motor_velocity(-side * self.speed, 1.0e3)
            };
            world.insert_impulse_joint(base, finger, joint);
            finger
        });
        let mut jump: Real = 0.0;
        for step in 0..150 {
            if step == 40 {
                world.bodies[base].set_linvel(Vector::Y * 0.25, true);
            }
            let rises = |world: &PhysicsWorld| fingers.map(|f| world.bodies[f].linvel().y);
            let before = rises(&world);
            pipeline.step(&mut world);
            if step > 41 {
                let after = rises(&world);
                jump = (0..2)
                    .map(|k| (after[k] - before[k]).abs())
                    .fold(jump, Real::max);
            }
        }
        let end = world.bodies[object].translation();
        Lift {
            up: end.y - height,
            aside: end.x.abs().max(end.z.abs()),
            jump,
        }
    }
}

/// Symptom: fingers of 50 and 100 g that pressed with 10 N on a rod of 0.5 kg lost their speed within a step, and with
/// it the rod. Cause: an impact a billionth of a second before the step's end; what joints were open by was closed in
/// what was left of the step, and the speed that took, from poses in single precision, went to the bodies. Which step
/// jumps most hangs on rounding, for either shape: over masses, the mean must be no more than rapier's, and the most no
/// more than rapier's most.
#[test]
fn fingers_rise_as_their_base_does() {
    let masses = (0..41).map(|k| 0.05 + 0.00125 * k as Real);
    let (mut sums, mut most): ([Real; 2], [Real; 2]) = ([0.0; 2], [0.0; 2]);
    for finger in masses {
        let grasp = Grasp {
            mass: 0.5,
            finger,
            thick: 0.02,
            speed: 1.0,
            friction: 0.5,
            to_position: false,
            force: 10.0,
        };
        let jumps = [As::Medial, As::Capsules].map(|made| grasp.lift(Thing::Rod, made).jump);
        for (k, jump) in jumps.into_iter().enumerate() {
            sums[k] += jump;
            most[k] = most[k].max(jump);
        }
    }
    println!("fingers jump by {most:?} m/s in a step at most, medial and rapier's own");
    assert!(most[0] <= most[1], "{most:?}");
    let [ours, rapiers] = sums.map(|sum| sum / 41.0);
    assert!(
        ours <= rapiers,
        "{ours} m/s in the mean, rapier's own {rapiers}"
    );
}

/// Fingers of 50 and 100 g that press with 10 N: what is lifted of rapier's own shapes is lifted of medial ones.
#[test]
fn medial_fingers_lift_what_rapiers_fingers_do() {
    let mut lifted = [0; 2];
    for what in [Thing::Ring, Thing::Box, Thing::Rod] {
        for finger in [0.05, 0.1] {
            for thick in [0.01, 0.02, 0.05] {
                for (speed, to_position) in [(0.3, false), (1.0, false), (3.0, false), (1.0, true)]
                {
                    for friction in [0.5, 1.0] {
                        let grasp = Grasp {
                            mass: 0.2,
                            finger,
                            thick,
                            speed,
                            friction,
                            to_position,
                            force: 10.0,
                        };
                        let held = [As::Medial, As::Capsules].map(|made| grasp.holds(what, made));
                        lifted = [0, 1].map(|k| lifted[k] + usize::from(held[k]));
                        assert!(held[0] || !held[1], "{what:?} falls: {grasp:?}");
                    }
                }
            }
        }
    }
    println!("of 144 grasps {lifted:?} are lifted, medial ones and rapier's own");
}

/// Up to 2,500 m/s² of the fingers alone: rapier's solver presses them in by centimetres, and what then holds depends
/// on how many contacts a pair has. parry names those of capsules and cuboids twice.
#[test]
#[ignore = "a minute: it counts beyond what grasps promise, and judges nothing"]
fn overloaded_grasps() {
    for what in [Thing::Ring, Thing::Box, Thing::Rod] {
        let mut lifted = [0; 3];
        for finger in [0.02, 0.05, 0.1, 0.3, 1.0] {
            for force in [5.0, 10.0, 20.0, 50.0] {
                for mass in [0.05, 0.2, 0.5, 1.0] {
                    let grasp = Grasp {
                        mass,
                        finger,
                        thick: 0.02,
                        speed: 1.0,
                        friction: 0.5,
                        to_position: false,
                        force,
                    };
                    for (k, made) in [As::Medial, As::Hulls, As::Capsules]
                        .into_iter()
                        .enumerate()
                    {
                        lifted[k] += usize::from(grasp.holds(what, made));
                    }
                }
            }
        }
        println!("{what:?}: of 80 {lifted:?} are lifted, medial ones, hulls, capsules and cuboids");
    }
}
