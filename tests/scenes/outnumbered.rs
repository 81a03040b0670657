//! Few medial bodies in a crowd of rapier's own shapes: rapier keeps the crowd's contacts as long as the user says, and
//! those of the medial bodies no longer than they can bear (`src/rapier/contacts/outnumbered.rs`).

use crate::bodies::*;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use rapier3d_medial::rapier::RECYCLE_DISTANCE;
#[cfg(feature = "serde-serialize")]
use rapier3d_medial::rapier::{load_world, save_world};

/// A pipeline of a world whose recycle distance stays as it is.
fn with_users_distance(world: &mut PhysicsWorld) -> MedialPipeline {
    let mut pipeline = MedialPipeline::default();
    pipeline.attach(world);
    pipeline
}

/// Drops 48 bodies of rapier's own shapes onto the ground.
fn drop_crowd(world: &mut PhysicsWorld) -> Vec<RigidBodyHandle> {
    let place = |k: usize| {
        let [x, y, z] = [k % 4, k / 16, k / 4 % 4].map(|k| k as Real);
        let aside = 0.02 * (k % 5) as Real;
        Vector::new(0.55 * x + aside, 0.4 + 0.7 * y, 0.55 * z - aside)
    };
    let drop = |k: usize| {
        let shape = match k % 3 {
            0 => SharedShape::ball(0.25),
            1 => SharedShape::cuboid(0.25, 0.15, 0.2),
            _ => SharedShape::capsule_y(0.15, 0.15),
        };
        let body = RigidBodyBuilder::dynamic().translation(place(k));
        world.insert(body, ColliderBuilder::new(shape)).0
    };
    (0..48).map(drop).collect()
}

#[test]
fn a_crowd_far_from_medial_bodies_goes_as_by_rapier_alone_to_the_bit() {
    let crowd = |is_medial: bool| {
        let mut world = world_with_ground();
        let dropped = drop_crowd(&mut world);
        let mesh = ring(12, 0.4, 0.1);
        let shape = match is_medial {
            true => SharedShape::medial_mesh(mesh),
            false => SharedShape::ball(0.4),
        };
        let far = RigidBodyBuilder::fixed().translation(Vector::X * 15.0);
        world.insert(far, ColliderBuilder::new(shape));
        (world, dropped)
    };
    let ([mut with, mut alone], dropped) = {
        let ((with, dropped), (alone, _)) = (crowd(true), crowd(false));
        ([with, alone], dropped)
    };
    let mut pipeline = with_users_distance(&mut with);
    for step in 0..240 {
        pipeline.step(&mut with);
        alone.step();
        assert!(bits(&with) == bits(&alone), "step {step}");
    }
    let touching = |h: &&RigidBodyHandle| {
        let pairs = alone
            .narrow_phase
            .contact_pairs_with(alone.bodies[**h].colliders()[0]);
        pairs.filter(|pair| pair.has_any_active_contact()).count() > 1
    };
    let touching = dropped.iter().filter(touching).count();
    assert!(
        touching > 24,
        "only {touching} of the crowd touch each other"
    );
}

/// How far a contact of a collider is from where rapier has it: the most that its two points have moved against each
/// other since it was computed.
fn staleness(world: &PhysicsWorld, collider: ColliderHandle) -> Real {
    let drift = |pair: &ContactPair| {
        let [a, b] = [pair.collider1, pair.collider2].map(|h| *world.colliders[h].position());
        let moved = |m: &ContactManifold| {
            let normal = a.rotation * m.local_n1;
            let gaps = m
                .points
                .iter()
                .map(|p| b * p.local_p2 - a * p.local_p1 - normal * p.dist);
            gaps.map(Vector::length).fold(0.0, Real::max)
        };
        pair.manifolds().iter().map(moved).fold(0.0, Real::max)
    };
    let pairs = world.narrow_phase.contact_pairs_with(collider);
    pairs.map(drift).fold(0.0, Real::max)
}

/// Speed of the sliders, m/s.
const SPEED: Real = 0.06;

/// What slides on a medial table.
fn slab(half: Vector) -> ColliderBuilder {
    let (vertices, triangles) = boxes(&[(Vector::ZERO, half)]);
    let mesh = MedialMesh::from_trimesh(&vertices, &triangles, &BuildOptions::default());
    ColliderBuilder::medial_mesh(mesh.expect("a slab").0)
}

/// Steps a world and returns the largest staleness of a collider's contacts after a step.
fn stalest(
    (world, pipeline): (&mut PhysicsWorld, &mut MedialPipeline),
    collider: ColliderHandle,
    steps: usize,
) -> Real {
    let step = |_| {
        pipeline.step(world);
        staleness(world, collider)
    };
    (0..steps).map(step).fold(0.0, Real::max)
}

/// rapier notes with each pair how long it may keep its contacts, so what it noted while the medial bodies were few
/// would hold on.
#[test]
fn contacts_of_medial_bodies_are_new_beside_a_crowd_and_when_it_is_gone() {
    let sliders = [
        slab(Vector::splat(0.1)),
        ColliderBuilder::cuboid(0.1, 0.1, 0.1),
    ];
    let ways = [
        (false, None),
        (true, None),
        (false, Some(true)),
        (false, Some(false)),
    ];
    let cases = sliders.iter().flat_map(|s| ways.map(|way| (s, way)));
    for (slider, (sleeps, without)) in cases {
        let mut world = world_with_ground();
        let table = slab(Vector::new(2.0, 0.1, 0.5)).friction(0.0);
        let table = table.translation(Vector::new(0.0, 1.0, 10.0));
        let table = world.insert_collider(table, None);
        let body = RigidBodyBuilder::dynamic().translation(Vector::new(-1.5, 1.2, 10.0));
        let body = body.linvel(Vector::X * SPEED).can_sleep(false);
        let (body, slider) = world.insert(body, slider.clone().friction(0.0));
        // Something medial that moves while the slider sleeps.
        let awake = RigidBodyBuilder::dynamic().translation(Vector::new(0.0, 0.1, -10.0));
        world.insert(awake.can_sleep(false), slab(Vector::splat(0.1)));
        let mut pipeline = with_users_distance(&mut world);
        let way = SPEED * world.integration_parameters.dt;
        let kept = RECYCLE_DISTANCE - way..RECYCLE_DISTANCE + 1.1 * way;
        // As soon as it lies on the table.
        stalest((&mut world, &mut pipeline), slider, 10);
        let alone = stalest((&mut world, &mut pipeline), slider, 60);
        assert!(kept.contains(&alone), "{alone} alone");
        let crowd = drop_crowd(&mut world);
        // Before the crowd has met each other it is none.
        stalest((&mut world, &mut pipeline), slider, 10);
        let beside = stalest((&mut world, &mut pipeline), slider, 60);
        assert!(beside < 1.1 * way, "{beside} beside a crowd");
        if sleeps {
            world.bodies[body].sleep();
        }
        stalest((&mut world, &mut pipeline), slider, 5);
        for dropped in crowd {
            world.remove_body(dropped);
        }
        // rapier notes nothing while it keeps no contacts.
        let parameters = world.integration_parameters;
        match without {
            Some(true) => world.integration_parameters.contact_recycling = false,
            Some(false) => {
                world
                    .integration_parameters
                    .normalized_contact_recycle_distance = 0.0
            }
            None => {}
        }
        stalest((&mut world, &mut pipeline), slider, 5);
        world.integration_parameters = parameters;
        if sleeps {
            assert!(world.bodies[body].is_sleeping());
            world.bodies[body].set_linvel(Vector::X * SPEED, true);
        }
        let after = stalest((&mut world, &mut pipeline), slider, 60);
        assert!(
            kept.contains(&after),
            "{after} after a crowd, sleeps: {sleeps}, {without:?}"
        );
        let hooks = [table, slider].map(|h| world.colliders[h].active_hooks().bits());
        assert!(
            hooks.iter().all(|bits| bits >> 30 == 0),
            "marks are left: {hooks:?}"
        );
    }
}

/// What comes to lie on a fixed medial collider in the very step after which no crowd is left.
#[test]
fn first_contacts_beside_a_crowd_that_goes_are_not_kept_longer() {
    for phase in 0..8 {
        let mut world = world_with_ground();
        let table = slab(Vector::new(2.0, 0.1, 0.5)).friction(0.0);
        world.insert_collider(table.translation(Vector::new(0.0, 1.0, 10.0)), None);
        let crowd = drop_crowd(&mut world);
        let mut pipeline = with_users_distance(&mut world);
        for _ in 0..60 {
            pipeline.step(&mut world);
        }
        let body = RigidBodyBuilder::dynamic().translation(Vector::new(-1.5, 1.205, 10.0));
        let cuboid = ColliderBuilder::cuboid(0.1, 0.1, 0.1).friction(0.0);
        let body = body.linvel(Vector::X * SPEED).can_sleep(false);
        let (_, slider) = world.insert(body, cuboid);
        stalest((&mut world, &mut pipeline), slider, phase);
        for dropped in crowd {
            world.remove_body(dropped);
        }
        // Until it has come to lie there.
        stalest((&mut world, &mut pipeline), slider, 10);
        let after = stalest((&mut world, &mut pipeline), slider, 60);
        let way = SPEED * world.integration_parameters.dt;
        let kept = RECYCLE_DISTANCE - way..RECYCLE_DISTANCE + 1.1 * way;
        assert!(
            kept.contains(&after),
            "{after} after {phase} steps beside a crowd"
        );
    }
}

/// Which pairs rapier keeps for longer is known from the world alone.
#[cfg(feature = "serde-serialize")]
#[test]
fn a_world_saved_before_its_crowd_goes_goes_on_bit_by_bit() {
    for ahead in [0, 1, 2, 5] {
        let mut world = world_with_ground();
        let table = slab(Vector::new(2.0, 0.1, 2.0)).friction(0.0);
        world.insert_collider(table.translation(Vector::new(0.0, 1.0, 10.0)), None);
        for i in 0..4 {
            let at = Vector::new(-1.5, 1.2, 9.0 + 0.5 * i as Real);
            let speed = Vector::X * (0.03 + 0.02 * i as Real);
            let body = RigidBodyBuilder::dynamic().translation(at).linvel(speed);
            world.insert(body, slab(Vector::splat(0.1)).friction(0.0));
        }
        let crowd = drop_crowd(&mut world);
        let mut pipeline = with_users_distance(&mut world);
        for _ in 0..60 {
            pipeline.step(&mut world);
        }
        let bytes = save_world(&world).expect("a world that can be saved");
        let mut loaded = load_world(&bytes).expect("what was saved");
        let mut other = with_users_distance(&mut loaded);
        for step in 0..200 {
            if step == ahead {
                for dropped in &crowd {
                    world.remove_body(*dropped);
                    loaded.remove_body(*dropped);
                }
            }
            pipeline.step(&mut world);
            other.step(&mut loaded);
            assert!(
                bits(&world) == bits(&loaded),
                "step {step}, loaded {ahead} before"
            );
        }
    }
}
