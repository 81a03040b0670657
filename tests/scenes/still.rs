//! Worlds in which nothing moves. What was prepared for one step holds for the next, until somebody changes something:
//! each change is seen in the step that follows it, as in a world that never stood still.

use crate::bodies::*;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// A ring that lies on a fixed one, another beside them, and a rod of medial cones far above.
struct Heap {
    world: PhysicsWorld,
    pipeline: MedialPipeline,
    rings: [RigidBodyHandle; 2],
    fixed: ColliderHandle,
    rod: RigidBodyHandle,
}

/// Steps until rings sleep. Far away a box spins for ever where the world is not to stand `still`.
fn heap(still: bool) -> Heap {
    let mut world = world_with_ground();
    let mut pipeline = attached(&mut world);
    let at = |x: Real, y: Real| Pose::new(Vector::new(x, y, 0.0), Vector::ZERO);
    let fixed = ring_collider(As::Medial).position(at(0.0, MINOR));
    let fixed = world.insert_collider(fixed, None);
    let rings = [at(0.0, 3.1 * MINOR), at(1.5, 1.1 * MINOR)];
    let rings = rings.map(|pose| add_ring(&mut world, As::Medial, pose));
    let spheres = [-0.4, 0.4].map(|x| MedialSphere::new(Vector::X * x, 0.02));
    let rod = MedialMesh::new(spheres.to_vec(), vec![[0, 1]], vec![]).expect("a rod");
    let body = RigidBodyBuilder::dynamic()
        .pose(at(0.3, 5.0))
        .gravity_scale(0.0)
        .sleeping(true);
    let collider = ColliderBuilder::medial_mesh(rod).density(1000.0);
    let rod = world.insert(body, collider).0;
    let spins = RigidBodyBuilder::dynamic()
        .pose(at(0.0, 500.0))
        .gravity_scale(0.0)
        .angvel(Vector::Y)
        .can_sleep(false)
        .enabled(!still);
    world.insert(spins, ColliderBuilder::cuboid(0.1, 0.1, 0.1));
    let asleep = |world: &PhysicsWorld| rings.iter().all(|r| world.bodies[*r].is_sleeping());
    for _ in 0..600 {
        if asleep(&world) {
            break;
        }
        pipeline.step(&mut world);
    }
    assert!(asleep(&world) && world.bodies[rod].is_sleeping());
    for _ in 0..20 {
        let report = pipeline.step(&mut world);
        assert_eq!((report.jobs, report.continuous_queries), (0, 0));
    }
    Heap {
        world,
        pipeline,
        rings,
        fixed,
        rod,
    }
}

type Change = fn(&mut Heap);

const CHANGES: [(&str, Change); 9] = [
    ("thrown", |heap| {
        heap.world.bodies[heap.rod].set_linvel(Vector::NEG_Y * 300.0, true);
    }),
    ("teleported and thrown", |heap| {
        let body = &mut heap.world.bodies[heap.rod];
        body.set_translation(Vector::new(1.8, 4.0, 0.1), false);
        heap.pipeline.step(&mut heap.world);
        heap.world.bodies[heap.rod].set_linvel(Vector::NEG_Y * 300.0, true);
    }),
    ("woken", |heap| {
        for ring in heap.rings {
            heap.world.bodies[ring].set_angvel(Vector::X * 3.0, true);
        }
    }),
    ("support removed", |heap| {
        heap.world.remove_collider(heap.fixed);
    }),
    ("support moved", |heap| {
        heap.world.colliders[heap.fixed].set_translation(Vector::Y * -3.0);
        heap.world.bodies[heap.rings[0]].wake_up(true);
    }),
    ("support disabled", |heap| {
        heap.world.colliders[heap.fixed].set_enabled(false);
        heap.world.bodies[heap.rings[0]].wake_up(true);
    }),
    ("another group", |heap| {
        let groups = InteractionGroups::none();
        heap.world.colliders[heap.fixed].set_collision_groups(groups);
        heap.world.bodies[heap.rings[0]].wake_up(true);
    }),
    ("another shape", |heap| {
        let thin = ring(27, MAJOR, 0.5 * MINOR);
        heap.world.colliders[heap.fixed].set_shape(SharedShape::medial_mesh(thin));
        heap.world.bodies[heap.rings[0]].wake_up(true);
    }),
    ("a clone inserted fast", |heap| {
        let clone = heap.world.colliders[heap.fixed].clone();
        let body = RigidBodyBuilder::dynamic().linvel(Vector::NEG_Y * 300.0);
        let pose = Pose::new(Vector::new(0.9, 6.0, 0.0), Vector::X);
        heap.world.insert(body.pose(pose), clone);
    }),
];

#[test]
fn a_change_of_a_still_world_is_seen_at_once() {
    for (name, change) in CHANGES {
        let ends = [false, true].map(|still| {
            let mut heap = heap(still);
            change(&mut heap);
            let mut seen = 0;
            for _ in 0..90 {
                let report = heap.pipeline.step(&mut heap.world);
                seen += report.jobs + report.events + report.muted;
            }
            let poses = heap.rings.into_iter().chain([heap.rod]);
            let poses = poses.map(|b| *heap.world.bodies[b].position()).collect();
            (poses, seen)
        });
        let [moving, still]: [(Vec<Pose>, usize); 2] = ends;
        assert!(moving.1 > 0, "{name}: nothing happened");
        assert_eq!(still, moving, "{name}");
    }
}

/// Boxes on a ground, with the pipeline and without.
#[test]
fn a_world_without_medial_colliders_is_rapiers_own() {
    let ends = [true, false].map(|with| {
        let mut world = world_with_ground();
        let mut pipeline = MedialPipeline::new(MedialOptions::default());
        pipeline.attach(&mut world);
        for k in 0..30 {
            let at = Vector::new(0.15 * (k % 3) as Real, 0.3 + 0.5 * k as Real, 0.0);
            let body = RigidBodyBuilder::dynamic().pose(Pose::new(at, Vector::ONE * k as Real));
            world.insert(body, ColliderBuilder::cuboid(0.2, 0.1, 0.3));
        }
        for _ in 0..240 {
            if with {
                pipeline.step(&mut world);
            } else {
                world.step();
            }
        }
        let poses = world.bodies.iter().map(|(_, body)| *body.position());
        poses.collect::<Vec<Pose>>()
    });
    assert_eq!(ends[0], ends[1]);
}

/// What comes into a world that had no medial collider is met: rods at 300 m/s, none of which passes a fixed ring.
#[test]
fn the_first_medial_colliders_of_a_world_are_met() {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut pipeline = attached(&mut world);
    world.insert(
        RigidBodyBuilder::dynamic().translation(Vector::X * 9.0),
        ColliderBuilder::ball(0.5),
    );
    for _ in 0..5 {
        pipeline.step(&mut world);
    }
    world.insert_collider(ring_collider(As::Medial), None);
    let thrown: Vec<RigidBodyHandle> = (0..12)
        .map(|k| {
            let (sin, cos) = (0.5 * k as Real).sin_cos();
            let at = Vector::new(MAJOR * cos, 1.0 + 0.3 * k as Real, MAJOR * sin);
            let body = RigidBodyBuilder::dynamic()
                .translation(at)
                .linvel(Vector::NEG_Y * 300.0);
            let ball = MedialMesh::new(vec![MedialSphere::new(Vector::ZERO, 0.02)], vec![], vec![]);
            let collider = ColliderBuilder::medial_mesh(ball.expect("a ball"));
            world.insert(body, collider).0
        })
        .collect();
    for _ in 0..4 {
        pipeline.step(&mut world);
    }
    for ball in thrown {
        assert!(world.bodies[ball].translation().y > 0.0, "it passed");
    }
}

/// A fixed wire along x, on a body, and one along z that sleeps 0.1 m above it: both of radius 4 mm, in a world that
/// stood still for three steps. From then on things weigh so much that the upper one falls past the lower one in a
/// step.
struct Wires {
    world: PhysicsWorld,
    pipeline: MedialPipeline,
    lower: ColliderHandle,
    upper: RigidBodyHandle,
    /// Holds nothing; rapier wakes the upper wire in the step after somebody has asked to change it.
    joint: ImpulseJointHandle,
    /// Sleeps where the upper wire does, and has no collider.
    bare: RigidBodyHandle,
}

fn wires() -> Wires {
    let mut world = PhysicsWorld::new();
    let mut pipeline = attached(&mut world);
    let wire = |along: Vector| {
        let ends = [-0.5, 0.5].map(|x| MedialSphere::new(along * x, 0.004));
        let wire = MedialMesh::new(ends.to_vec(), vec![[0, 1]], vec![]).expect("a wire");
        ColliderBuilder::medial_mesh(wire).density(1000.0)
    };
    let (hook, lower) = world.insert(RigidBodyBuilder::fixed(), wire(Vector::X));
    let asleep = || {
        RigidBodyBuilder::dynamic()
            .translation(Vector::Y * 0.1)
            .sleeping(true)
    };
    let (upper, _) = world.insert(asleep(), wire(Vector::Z));
    let mass = MassProperties::new(Vector::ZERO, 5.0, Vector::ONE);
    let bare = world.insert_body(asleep().additional_mass_properties(mass));
    let free = GenericJointBuilder::new(JointAxesMask::empty());
    let joint = world.insert_impulse_joint(hook, upper, free);
    // The new joint wakes it, once.
    let gravity = std::mem::replace(&mut world.gravity, Vector::ZERO);
    pipeline.step(&mut world);
    world.bodies[upper].sleep();
    for _ in 0..3 {
        pipeline.step(&mut world);
    }
    assert!(world.bodies[upper].is_sleeping() && world.bodies[bare].is_sleeping());
    world.gravity = gravity * 500.0;
    Wires {
        world,
        pipeline,
        lower,
        upper,
        joint,
        bare,
    }
}

impl Wires {
    /// Height of the upper wire after a step.
    fn step(&mut self) -> Real {
        self.pipeline.step(&mut self.world);
        self.world.bodies[self.upper].translation().y
    }
}

/// Symptom: bodies that rapier itself woke within its step were where the last step had left them. Cause: what a still
/// world was prepared with was kept although joints, contact skins or places of colliders on their bodies had changed.
#[test]
fn bodies_woken_within_a_step_are_met_in_their_motion() {
    type Change = fn(&mut Collider);
    let higher: Change = |c| c.set_translation_wrt_parent(Vector::Y * 0.05);
    let thicker: Change = |c| c.set_contact_skin(0.05);
    for (what, change) in [("a skin of 0.05", thicker), ("a place 0.05 higher", higher)] {
        let mut wires = wires();
        change(&mut wires.world.colliders[wires.lower]);
        let joint = wires.world.impulse_joints.get_mut(wires.joint, true);
        assert!(joint.is_some());
        let height = wires.step();
        assert!(
            (0.05..0.07).contains(&height),
            "with {what} it is at {height}"
        );
    }

    let mut joined = wires();
    let (upper, bare) = (joined.upper, joined.bare);
    joined
        .world
        .insert_impulse_joint(upper, bare, FixedJointBuilder::new());
    let height = joined.step();
    let opens = joined.world.bodies[bare].translation().y - height;
    assert!(
        height > 0.0 && opens.abs() < 1.0e-3,
        "the wire is at {height}, the joint open by {opens}"
    );
}
