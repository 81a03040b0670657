//! Saved and loaded worlds go on bit by bit as if nothing had happened.

use crate::bodies::*;
use crate::random::Random;
use crate::told::Record;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use rapier3d_medial::rapier::{SavedWorld, SavedWorldError, load_world, save_world};

const BEFORE: usize = 70;
const AFTER: usize = 500;

/// Rings on a ground, linked rings, balls, a jointed pair; still moving at the save.
fn mixed_world() -> (PhysicsWorld, MedialMesh) {
    let mut world = world_with_ground();
    let mesh = ring(27, MAJOR, MINOR);
    for i in 0..6 {
        let at = Vector::new(0.1 * i as Real, 0.4 + 0.5 * i as Real, -0.07 * i as Real);
        let turn = Vector::new(0.5 * i as Real, 0.2, 0.9 * (i % 2) as Real);
        let body = RigidBodyBuilder::dynamic().pose(Pose::new(at, turn));
        world.insert(
            body,
            ColliderBuilder::medial_mesh(mesh.clone()).density(1000.0),
        );
        let side = Vector::new(1.5, 0.5 + 0.5 * i as Real, 0.2 * i as Real);
        let body = RigidBodyBuilder::dynamic().translation(side);
        world.insert(body, ColliderBuilder::ball(0.2).density(500.0));
    }
    let anchor =
        world.insert_body(RigidBodyBuilder::fixed().translation(Vector::new(-3.0, 4.0, 0.0)));
    let hung = RigidBodyBuilder::dynamic().translation(Vector::new(-2.0, 4.0, 0.0));
    let hung = world
        .insert(hung, ColliderBuilder::medial_mesh(ring(12, 0.3, 0.05)))
        .0;
    let joint = SphericalJointBuilder::new().local_anchor2(Vector::new(-1.0, 0.0, 0.0));
    world.insert_impulse_joint(anchor, hung, joint);
    (world, mesh)
}

/// Heavy bricks on light ones, which impacts move in each step until they sleep.
fn pressed_world() -> PhysicsWorld {
    let mut world = world_with_ground();
    let half = Vector::new(0.4, 0.1, 0.2);
    let brick = MedialMesh::cuboid(half).expect("a brick");
    let brick = ColliderBuilder::medial_mesh(brick);
    for (x, y, density) in [
        (0.0, 0.1, 1.0),
        (0.01, 0.3, 100.0),
        (2.0, 0.1, 1.0),
        (2.02, 0.3, 100.0),
    ] {
        let at = Vector::new(x, y, 0.0);
        let body = RigidBodyBuilder::dynamic().translation(at);
        world.insert(body, brick.clone().density(density));
    }
    world
}

/// How long what impacts move has been slow is known after loading too.
#[test]
fn a_loaded_world_of_pressed_bodies_falls_asleep_at_the_same_time() {
    let mut world = pressed_world();
    let mut pipeline = attached(&mut world);
    let mut saved = Vec::new();
    let mut trace = Vec::new();
    for step in 0..200 {
        if (76..140).contains(&step) && step % 6 == 0 {
            saved.push((step, save_world(&world).expect("a world that can be saved")));
        }
        pipeline.step(&mut world);
        trace.push(bits(&world));
    }
    assert!(world.bodies.iter().all(|(_, b)| b.is_sleeping()));
    for (at, bytes) in saved {
        let mut loaded = load_world(&bytes).expect("what was saved");
        let mut other = attached(&mut loaded);
        let difference = (at..200).find(|step| {
            other.step(&mut loaded);
            bits(&loaded) != trace[*step]
        });
        assert_eq!(difference, None, "saved after {at} steps");
    }
}

/// A rope of rings that hangs by a multibody from a body that moves to and fro at up to 2 m/s.
#[test]
fn a_loaded_rope_on_a_moving_hand_goes_on_bit_by_bit() {
    let mut world = PhysicsWorld::new();
    let hand = RigidBodyBuilder::kinematic_velocity_based().translation(Vector::Y * 4.0);
    let hand = world.insert_body(hand);
    let mut above = hand;
    for k in 0..4 {
        let at = Vector::new(0.0, 3.2 - 0.8 * k as Real, 0.0);
        let link = ColliderBuilder::medial_mesh(ring(12, 0.3, 0.05));
        let (link, _) = world.insert(RigidBodyBuilder::dynamic().translation(at), link);
        let joint = SphericalJointBuilder::new()
            .local_anchor1(Vector::NEG_Y * 0.4)
            .local_anchor2(Vector::Y * 0.4);
        world.insert_multibody_joint(above, link, joint);
        above = link;
    }
    let step = |world: &mut PhysicsWorld, pipeline: &mut MedialPipeline, k: usize| {
        let speed = Vector::X * (2.0 * (k as Real * 0.1).sin());
        world.bodies[hand].set_linvel(speed, true);
        pipeline.step(world);
    };
    let mut pipeline = attached(&mut world);
    (0..77).for_each(|k| step(&mut world, &mut pipeline, k));
    let saved = save_world(&world).expect("a world that can be saved");
    let mut loaded = load_world(&saved).expect("what was saved");
    let mut other = attached(&mut loaded);
    for k in 77..300 {
        step(&mut world, &mut pipeline, k);
        step(&mut loaded, &mut other, k);
        assert_eq!(bits(&world), bits(&loaded), "step {k}");
    }
}

/// Steps both worlds; the first step at which they differ.
fn first_difference(
    [a, b]: [&mut PhysicsWorld; 2],
    [pipeline_a, pipeline_b]: [&mut MedialPipeline; 2],
) -> Option<usize> {
    (0..AFTER).find(|_| {
        pipeline_a.step(a);
        pipeline_b.step(b);
        bits(a) != bits(b)
    })
}

#[test]
fn a_loaded_world_goes_on_bit_by_bit() {
    let (mut world, _) = mixed_world();
    let mut pipeline = attached(&mut world);
    for _ in 0..BEFORE {
        pipeline.step(&mut world);
    }
    assert!(world.bodies.iter().any(|(_, b)| b.linvel().length() > 0.1));
    let bytes = save_world(&world).expect("a world that can be saved");
    let mut loaded = load_world(&bytes).expect("what was saved");
    assert_eq!(bits(&world), bits(&loaded));
    let mut other = MedialPipeline::new(MedialOptions::default());
    other.attach(&mut loaded);
    let worlds = [&mut world, &mut loaded];
    assert_eq!(first_difference(worlds, [&mut pipeline, &mut other]), None);
    // The bytes of a second save may differ: rapier keeps colours and tangents of contacts that have no
    // force any more, and a load begins some of them afresh. The bodies go on alike.
    let bytes = save_world(&world).expect("a world that can be saved");
    let mut again = load_world(&bytes).expect("what was saved");
    let mut third = attached(&mut again);
    let worlds = [&mut loaded, &mut again];
    assert_eq!(first_difference(worlds, [&mut other, &mut third]), None);
}

/// Rings that roll slowly over a plate have contacts that rapier keeps for several steps, and only it
/// knows since when: what it asks for after loading is not what a new pipeline expects.
#[test]
fn a_world_of_kept_contacts_goes_on_bit_by_bit() {
    let mesh = ring(27, MAJOR, MINOR);
    let plate = MedialMesh::round_plate(6.0, 6.0, 0.1).expect("a plate");
    for saved in [45, 61, 63, 80] {
        let mut world = PhysicsWorld::new();
        world.insert_collider(ColliderBuilder::medial_mesh(plate.clone()), None);
        for i in 0..4 {
            let speed = 0.03 + 0.02 * i as Real;
            let body = RigidBodyBuilder::dynamic()
                .translation(Vector::new(0.0, 0.1 + MAJOR + MINOR, 1.5 * i as Real - 2.0))
                .rotation(Vector::X * std::f32::consts::FRAC_PI_2)
                .linvel(Vector::X * speed)
                .angvel(Vector::NEG_Z * speed / (MAJOR + MINOR));
            world.insert(body, ColliderBuilder::medial_mesh(mesh.clone()));
        }
        let mut pipeline = attached(&mut world);
        for _ in 0..saved {
            pipeline.step(&mut world);
        }
        let bytes = save_world(&world).expect("a world that can be saved");
        let mut loaded = load_world(&bytes).expect("what was saved");
        let mut other = attached(&mut loaded);
        let worlds = [&mut world, &mut loaded];
        let difference = first_difference(worlds, [&mut pipeline, &mut other]);
        assert_eq!(difference, None, "saved after {saved} steps");
    }
}

/// A body that a first contact within the step has set somewhere else is marked as moved. Were it saved
/// as changed in shape, rapier would begin its contacts afresh: normals differ by 1e-6 then, and so do
/// impulses, at once where every pair is computed in every step.
#[test]
fn bodies_set_within_a_step_keep_their_contacts() {
    let mut world = world_with_ground();
    world.integration_parameters.contact_clustering = false;
    let mut pipeline = attached(&mut world);
    world
        .integration_parameters
        .normalized_contact_recycle_distance = 0.0;
    for i in 0..6 {
        let at = Vector::new(0.1 * i as Real, 0.4 + 0.5 * i as Real, -0.07 * i as Real);
        let turn = Vector::new(0.5 * i as Real, 0.2, 0.9 * (i % 2) as Real);
        add_ring(&mut world, As::Medial, Pose::new(at, turn));
    }
    let mut saved_after_an_event = 0;
    for _ in 0..12 {
        let events = (0..7).map(|_| pipeline.step(&mut world).events).last();
        saved_after_an_event += usize::from(events > Some(0));
        let bytes = save_world(&world).expect("a world that can be saved");
        let mut loaded = load_world(&bytes).expect("what was saved");
        let mut other = attached(&mut loaded);
        loaded.integration_parameters = world.integration_parameters;
        pipeline.step(&mut world);
        other.step(&mut loaded);
        assert_eq!(bits(&world), bits(&loaded));
    }
    assert!(saved_after_an_event > 3, "{saved_after_an_event} of 12");
}

#[test]
fn other_formats_hold_what_they_hold_of_rapiers_own_worlds() {
    let (mut world, _) = mixed_world();
    let mut pipeline = attached(&mut world);
    for _ in 0..BEFORE {
        pipeline.step(&mut world);
    }
    let saved = SavedWorld::new(&world).expect("a world that can be saved");
    let bytes = bincode::serialize(&saved).expect("bincode writes it");
    let loaded: SavedWorld = bincode::deserialize(&bytes).expect("bincode reads it");
    let mut loaded = loaded.into_world().expect("all meshes");
    let mut other = attached(&mut loaded);
    let worlds = [&mut world, &mut loaded];
    assert_eq!(first_difference(worlds, [&mut pipeline, &mut other]), None);
}

/// JSON carries worlds of finite numbers, bit by bit, and no others: rapier's own, and ours.
#[test]
fn json_carries_what_it_carries_of_rapiers_own_worlds() {
    let after = |kind: As, steps: usize, speed: Real| -> Result<Option<usize>, String> {
        let mut world = world_with_ground();
        let mut pipeline = attached(&mut world);
        for i in 0..4 {
            let at = Vector::new(0.1 * i as Real, 0.4 + 0.5 * i as Real, -0.07 * i as Real);
            let turn = Vector::new(0.5 * i as Real, 0.2, 0.9);
            let body = add_ring(&mut world, kind, Pose::new(at, turn));
            world.bodies[body].set_linvel(Vector::X * speed, true);
        }
        for _ in 0..steps {
            pipeline.step(&mut world);
        }
        let mut loaded = if kind == As::Medial {
            let saved = SavedWorld::new(&world).map_err(|e| e.to_string())?;
            let text = serde_json::to_string(&saved).map_err(|e| e.to_string())?;
            let saved: SavedWorld = serde_json::from_str(&text).map_err(|e| e.to_string())?;
            saved.into_world().map_err(|e| e.to_string())?
        } else {
            let text = serde_json::to_string(&world).map_err(|e| e.to_string())?;
            serde_json::from_str(&text).map_err(|e| e.to_string())?
        };
        let mut other = attached(&mut loaded);
        let worlds = [&mut world, &mut loaded];
        Ok(first_difference(worlds, [&mut pipeline, &mut other]))
    };
    for kind in [As::Hull, As::Medial] {
        for steps in [0, BEFORE] {
            assert_eq!(after(kind, steps, 0.1), Ok(None), "{kind:?}, {steps} steps");
        }
        let error = after(kind, 0, Real::NAN).expect_err("no number of JSON's");
        assert!(error.contains("null"), "{kind:?}: {error}");
    }
}

#[test]
fn a_mesh_is_written_once_and_shared_again() {
    let (mut world, mesh) = mixed_world();
    let one = save_world(&world).expect("a world").len();
    for _ in 0..4 {
        let collider = ColliderBuilder::medial_mesh(mesh.clone());
        world.insert(RigidBodyBuilder::dynamic(), collider);
    }
    let bytes = save_world(&world).expect("a world");
    let per_collider = (bytes.len() - one) / 4;
    let of_mesh = mesh.to_bytes().len();
    assert!(
        of_mesh > 2 * per_collider,
        "{per_collider} of {of_mesh} bytes each"
    );
    let loaded = load_world(&bytes).expect("what was saved");
    let meshes: Vec<&MedialMesh> = loaded
        .colliders
        .iter()
        .filter_map(|(_, c)| c.shape().as_shape())
        .filter(|m: &&MedialMesh| m.spheres().len() == 27)
        .collect();
    assert_eq!(meshes.len(), 10);
    assert!(meshes.iter().all(|m| m.shares_data(meshes[0])));
}

#[test]
fn a_world_saved_before_its_first_step_falls_the_same_way() {
    let (mut world, _) = mixed_world();
    let mut loaded = load_world(&save_world(&world).expect("a world")).expect("what was saved");
    let mut pipeline = attached(&mut world);
    let mut other = attached(&mut loaded);
    let worlds = [&mut world, &mut loaded];
    assert_eq!(first_difference(worlds, [&mut pipeline, &mut other]), None);
}

#[test]
fn damage_is_refused_and_removals_wait_for_a_step() {
    let (mut world, _) = mixed_world();
    let bytes = save_world(&world).expect("a world");
    for at in (0..bytes.len()).step_by(bytes.len() / 200) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0x10;
        assert!(load_world(&damaged).is_err(), "byte {at}");
        assert!(load_world(&bytes[..at]).is_err(), "cut at {at}");
    }
    // Zeros at the end do not change the checksum's last word.
    for zeros in 1..9 {
        let longer = [&bytes[..], &[0; 8][..zeros]].concat();
        assert!(load_world(&longer).is_err(), "{zeros} zeros more");
    }
    let is = |e: Option<SavedWorldError>, what: &str| {
        let text = e.map_or(String::new(), |e| e.to_string());
        assert!(text.contains(what), "{text}");
    };
    is(load_world(b"nothing").err(), "not a saved world");
    let mut newer = bytes.clone();
    newer[8] = 9;
    is(load_world(&newer).err(), "version 9");
    let first = world.colliders.iter().next().expect("a collider").0;
    world.remove_collider(first);
    is(save_world(&world).err(), "1 colliders were removed");
    world.step();
    assert!(save_world(&world).is_ok());
}

/// Any byte of the header or content changed: refused, with no panic; so is what ends early. A world
/// whose checksum was forged is rapier's to read (`SavedWorld`): numbers of meshes and handles that
/// are not there are refused.
#[test]
fn mutated_worlds_are_refused() {
    let (world, _) = mixed_world();
    let bytes = save_world(&world).expect("a world");
    let mut random = Random(7300);
    for _ in 0..400 {
        let mut other = bytes.clone();
        for _ in 0..1 + (random.unit() * 4.0) as usize {
            let at = (random.unit() * other.len() as Real) as usize;
            let value = (random.unit() * 256.0) as u8;
            if random.unit() < 0.2 {
                other.truncate(at.max(1));
                break;
            }
            other[at] = value;
        }
        assert!(other == bytes || load_world(&other).is_err());
    }
    let saved = SavedWorld::new(&world).expect("a world");
    let bytes = bincode::serialize(&saved).expect("written");
    // The meshes come first: their lengths, indices and numbers, before rapier's world.
    let mut refused = 0;
    for _ in 0..400 {
        let mut other = bytes.clone();
        let at = (random.unit() * 2000.0) as usize;
        other[at] = (random.unit() * 256.0) as u8;
        let read: Result<SavedWorld, _> = bincode::deserialize(&other);
        refused += u32::from(!read.is_ok_and(|w| w.into_world().is_ok()));
    }
    assert!(refused > 40, "{refused} of 400 are refused");
}

/// A world saved right after an impact within a step: rapier has not found the contact yet, and the start that was
/// told is neither lost nor told twice, whether the bodies bounce or stay.
#[test]
fn loaded_world_does_not_repeat_collision_events() {
    for restitution in [0.0, 1.0] {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let mut pipeline = attached(&mut world);
        let ball = MedialMesh::ball(0.1).expect("a ball");
        for side in [-1.0, 1.0] {
            let body = RigidBodyBuilder::dynamic()
                .translation(Vector::X * side * 2.2)
                .linvel(Vector::NEG_X * side * 60.0);
            let collider = ColliderBuilder::medial_mesh(ball.clone()).restitution(restitution);
            world.insert(body, collider.active_events(ActiveEvents::COLLISION_EVENTS));
        }
        let record = Record::default();
        let hit = (0..10).any(|_| pipeline.step_with_events(&mut world, &(), &record).events > 0);
        assert!(hit && pipeline.told_starts().len() == 1, "{restitution}");
        let bytes = save_world(&world).expect("saved");
        let mut loaded = load_world(&bytes).expect("loaded");
        let mut resumed = attached(&mut loaded);
        resumed.resume_told_starts(pipeline.told_starts().to_vec());
        let after =
            [(&mut world, &mut pipeline), (&mut loaded, &mut resumed)].map(|(world, pipeline)| {
                let record = Record::default();
                for _ in 0..5 {
                    pipeline.step_with_events(world, &(), &record);
                }
                record.take().starts()
            });
        println!("restitution {restitution}: {:?}", after[0]);
        assert_eq!(after[0], after[1], "restitution {restitution}");
        let again = after[0].contains(&true);
        assert!(!again, "restitution {restitution}: told again");
    }
}
