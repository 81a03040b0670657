//! Bodies with locked axes that touch something along a locked axis: nothing can move them along it, and rapier's
//! solver divides by what rounding leaves of their freedom.

use crate::bodies::{attached, world_with_ground};
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::f32::consts::FRAC_PI_2;

/// Half of the edge of the bodies, metres.
const HALF: Real = 0.2;

fn round_box() -> MedialMesh {
    MedialMesh::round_cuboid(Vector::splat(HALF - 0.05), 0.05).expect("a round box")
}

fn sharp_box() -> MedialMesh {
    MedialMesh::cuboid(Vector::splat(HALF)).expect("a box")
}

/// The highest speed and the longest way in a step, metres, of a body that can move in a plane only, falls on the
/// ground and leans against a wall behind it, up to a millimetre deep.
fn in_a_plane(body: ColliderBuilder, wall: &ColliderBuilder, deep: Real, turn: Real) -> [Real; 2] {
    let mut world = world_with_ground();
    let mut pipeline = attached(&mut world);
    world.insert(RigidBodyBuilder::fixed(), wall.clone());
    let at = Vector::new(0.0, 0.5, HALF - deep);
    let builder = RigidBodyBuilder::dynamic()
        .pose(Pose::from_parts(at, Rotation::from_rotation_z(turn)))
        .linvel(Vector::X * (turn - 1.0))
        .enabled_translations(true, true, false)
        .enabled_rotations(false, false, true);
    let (body, _) = world.insert(builder, body);
    let mut most: [Real; 2] = [0.0; 2];
    for _ in 0..120 {
        let before = world.bodies[body].translation();
        pipeline.step(&mut world);
        let body = &world.bodies[body];
        let way = (body.translation() - before).length();
        most = [most[0].max(body.linvel().length()), most[1].max(way)];
    }
    most
}

/// Symptom: of 100 boxes that could move in a plane only, 78 to 100 were flung by metres in one step off a wall behind
/// them, at up to 95 m/s; rapier's own off a half-space none. Cause: contacts along the locked axis, but for rounding.
#[test]
fn boxes_in_a_plane_are_not_flung_off_the_wall_behind_them() {
    let own = ColliderBuilder::cuboid(HALF, HALF, HALF);
    let turned = Pose::from_parts(Vector::ZERO, Rotation::from_rotation_x(FRAC_PI_2));
    let thick = Pose::from_parts(Vector::Z * -0.5, turned.rotation);
    let half_space = ColliderBuilder::new(SharedShape::halfspace(Vector::Y));
    let walls = [
        ("half-space", half_space.position(turned)),
        (
            "cuboid",
            ColliderBuilder::cuboid(9.0, 0.5, 9.0).position(thick),
        ),
    ];
    for (name, wall) in &walls {
        for mesh in [round_box(), sharp_box()] {
            for k in 0..8 {
                let deep = 0.125e-3 * k as Real;
                let turn = 0.7 * k as Real;
                let body = ColliderBuilder::medial_mesh(mesh.clone());
                let [speed, way] = in_a_plane(body, wall, deep, turn);
                println!("{name} {k}: {speed} m/s, {way} m in a step");
                if *name == "half-space" {
                    let [of_own, _] = in_a_plane(own.clone(), wall, deep, turn);
                    assert!((speed - of_own).abs() < 1.0, "{speed}, own {of_own} m/s");
                }
                // It falls at 3 m/s, and starts at up to 4.
                assert!(speed < 6.0, "{name} {k}: {speed} m/s");
                assert!(way < 0.1, "{name} {k}: {way} m in a step");
            }
        }
    }
}

/// The highest speed of bricks that fall in a heap, once some axes of one are locked and its velocities along them
/// taken.
fn after_locking(count: usize, seed: u64) -> Real {
    let mut random = Random(seed * 1009 + 17);
    let half = Vector::new(0.2, 0.08, 0.12);
    let mesh = MedialMesh::cuboid(half).expect("a brick");
    let mut world = world_with_ground();
    let mut pipeline = attached(&mut world);
    let bricks: Vec<RigidBodyHandle> = (0..count)
        .map(|k| {
            let at = Vector::new(
                random.within(-0.1, 0.1),
                0.5 + 0.6 * k as Real,
                random.within(-0.1, 0.1),
            );
            let turn = Rotation::from_scaled_axis(random.direction() * random.within(0.0, 3.0));
            let body = RigidBodyBuilder::dynamic().pose(Pose::from_parts(at, turn));
            let collider = ColliderBuilder::medial_mesh(mesh.clone());
            world.insert(body, collider).0
        })
        .collect();
    let (locked_in, which) = (random.within(10.0, 50.0) as u32, seed as usize % count);
    let axes = LockedAxes::from_bits_truncate(random.within(1.0, 63.0) as u8);
    let mut fastest: Real = 0.0;
    for step in 0..locked_in + 60 {
        if step == locked_in {
            let brick = &mut world.bodies[bricks[which]];
            let free = |first: u8| {
                let is_free = |k: u8| Real::from(u8::from(axes.bits() >> (first + k) & 1 == 0));
                Vector::new(is_free(0), is_free(1), is_free(2))
            };
            let (slides, turns) = (brick.linvel() * free(0), brick.angvel() * free(3));
            brick.set_locked_axes(axes, true);
            brick.set_linvel(slides, true);
            brick.set_angvel(turns, true);
        }
        pipeline.step(&mut world);
        if step >= locked_in {
            let speeds = bricks.iter().map(|b| world.bodies[*b].linvel().length());
            fastest = speeds.fold(fastest, Real::max);
        }
    }
    fastest
}

/// Symptom: bricks of a heap got up to 6e8 m/s as soon as axes of one were locked. Cause: contacts along locked axes,
/// also those that rapier had kept from before.
#[test]
fn bricks_do_not_explode_when_axes_of_one_are_locked() {
    for count in [1, 2] {
        // In the last four rapier has kept such contacts.
        for seed in (0..100).chain([162, 358, 1300, 1312]) {
            let fastest = after_locking(count, seed);
            assert!(fastest < 8.0, "{count} bricks, seed {seed}: {fastest} m/s");
        }
    }
}

/// How far a box that can move along x only gets in a second at 1 m/s, towards a ramp that rises by `angle`, radians,
/// and that it touches after 0.1 m.
fn into_a_wedge(body: ColliderBuilder, angle: Real) -> Real {
    let mut world = PhysicsWorld::new();
    let mut pipeline = attached(&mut world);
    let turn = Rotation::from_rotation_z(angle);
    // The ramp's surface goes through the point that the box's lower front edge meets.
    let met = Vector::new(HALF + 0.1, -HALF, 0.0);
    let ramp = ColliderBuilder::cuboid(9.0, 0.5, 9.0);
    world.insert_collider(
        ramp.position(Pose::from_parts(met - turn * (Vector::Y * 0.5), turn)),
        None,
    );
    let builder = RigidBodyBuilder::dynamic()
        .linvel(Vector::X)
        .gravity_scale(0.0)
        .enabled_translations(true, false, false)
        .lock_rotations();
    let (body, _) = world.insert(builder, body.friction(0.0));
    for _ in 0..60 {
        pipeline.step(&mut world);
    }
    world.bodies[body].translation().x
}

/// Wedges of a tenth of a degree and more stop a body on a rail as they stop rapier's own: their normals are near the
/// locked axis, but not by rounding.
#[test]
fn gentle_wedges_stop_bodies_on_rails() {
    for angle in [0.002, 0.005, 0.01, 0.05] {
        let own = into_a_wedge(ColliderBuilder::cuboid(HALF, HALF, HALF), angle);
        let ours = into_a_wedge(ColliderBuilder::medial_mesh(sharp_box()), angle);
        println!("{angle} rad: {ours} m, rapier's own {own} m");
        assert!((ours - own).abs() < 5.0e-3, "{angle} rad: {ours}, {own} m");
    }
}

/// How far a load of a mass sinks in a second into a light plate that cannot move down, on which it lies.
fn sunk_into_a_held_plate(medial: [bool; 2], mass: Real) -> Real {
    let collider = |half: Vector, medial: bool| match medial {
        true => ColliderBuilder::medial_mesh(MedialMesh::cuboid(half).expect("a box")),
        false => ColliderBuilder::cuboid(half.x, half.y, half.z),
    };
    let mut world = PhysicsWorld::new();
    let mut pipeline = attached(&mut world);
    let plate = RigidBodyBuilder::dynamic()
        .enabled_translations(true, false, true)
        .lock_rotations();
    let thin = Vector::new(0.3, 0.05, 0.3);
    world.insert(plate, collider(thin, medial[0]).mass(1.0));
    let load = RigidBodyBuilder::dynamic().translation(Vector::Y * (0.05 + HALF));
    let (load, _) = world.insert(load, collider(Vector::splat(HALF), medial[1]).mass(mass));
    for _ in 0..60 {
        pipeline.step(&mut world);
    }
    0.05 + HALF - world.bodies[load].translation().y
}

/// Symptom: a contact with a load of more than 10,000 times the mass of the held plate below it was not solved.
#[test]
fn heavy_loads_lie_on_light_plates_that_are_held() {
    for mass in [1.0, 1.0e3, 1.0e5] {
        let own = sunk_into_a_held_plate([false, false], mass);
        for medial in [[true, false], [false, true], [true, true]] {
            let sunk = sunk_into_a_held_plate(medial, mass);
            println!("{mass} kg, {medial:?}: {sunk} m, rapier's own {own} m");
            assert!((sunk - own).abs() < 1.0e-3, "{mass} kg: {sunk}, {own} m");
        }
    }
}

/// A box, medial or rapier's own.
fn solid(medial: bool, half: Vector) -> ColliderBuilder {
    match medial {
        true => ColliderBuilder::medial_mesh(MedialMesh::cuboid(half).expect("a box")),
        false => ColliderBuilder::cuboid(half.x, half.y, half.z),
    }
}

/// A body that can only turn about a vertical axle, and does so at 1 rad/s.
fn turning(inertia: Real) -> RigidBodyBuilder {
    let heavy = MassProperties::new(Vector::ZERO, 1.0, Vector::splat(inertia));
    RigidBodyBuilder::dynamic()
        .enabled_translations(false, false, false)
        .enabled_rotations(false, true, false)
        .additional_mass_properties(heavy)
        .angvel(Vector::NEG_Y)
        .can_sleep(false)
}

/// How far a flywheel with arms of a metre turns in two seconds, radians, that turns at 1 rad/s towards a stop `lever`
/// metres beside its axle, 0.3 rad away; `medial`: the flywheel, and the stop.
fn flywheel_turned(medial: [bool; 2], inertia: Real, lever: Real) -> Real {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut pipeline = attached(&mut world);
    let (wheel, _) = world.insert(
        turning(inertia),
        solid(medial[0], Vector::new(1.0, 0.1, 0.05)),
    );
    let at = Rotation::from_rotation_y(-0.3);
    let pose = Pose::from_parts(at * Vector::new(lever, 0.0, 0.1), at);
    let stop = solid(medial[1], Vector::new(0.0005, 0.3, 0.05));
    world.insert(RigidBodyBuilder::fixed().pose(pose), stop);
    let mut turned = 0.0;
    for _ in 0..120 {
        pipeline.step(&mut world);
        turned -= world.bodies[wheel].angvel().y / 60.0;
    }
    turned
}

/// Symptom: flywheels, which have much inertia for their mass, turned through what was to stop them. Cause: what a
/// lever gives was compared with what the mass gives.
#[test]
fn flywheels_stop_at_what_they_touch() {
    for (inertia, lever) in [(1.0e4, 0.01), (1.0e6, 0.1), (1.0e6, 0.9)] {
        let own = flywheel_turned([false, false], inertia, lever);
        for medial in [[true, false], [false, true], [true, true]] {
            let turned = flywheel_turned(medial, inertia, lever);
            println!("{inertia} kg m² at {lever} m, {medial:?}: {turned}, own {own} rad");
            assert!((turned - own).abs() < 0.05, "{turned}, own {own} rad");
        }
    }
}

/// Where a key, at a lever of 8 mm and so far along the axle from the centre of mass of what turns at 1 rad/s, has
/// turned to after two seconds, rad: a stop is in its way.
fn key_turned(medial: bool, far: Real) -> Real {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut pipeline = attached(&mut world);
    let body = world.insert_body(turning(0.1));
    let key = solid(medial, Vector::new(0.01, 0.05, 0.001)).translation(Vector::Y * far);
    world.insert_collider(key.density(0.0), Some(body));
    let at = Rotation::from_rotation_y(-0.3);
    let place = at * Vector::new(0.008, far, 0.006);
    let stop = solid(medial, Vector::new(0.0005, 0.04, 0.005));
    let pose = Pose::from_parts(place, at);
    world.insert(RigidBodyBuilder::fixed().pose(pose), stop);
    let mut turned = 0.0;
    for _ in 0..120 {
        pipeline.step(&mut world);
        turned -= world.bodies[body].angvel().y / 60.0;
    }
    turned
}

/// Symptom: a key far along its axle turned through its stop. Cause: its lever was compared with the whole arm, of
/// which the part along the axle adds nothing to it.
#[test]
fn keys_far_along_their_axle_stop_at_what_they_touch() {
    for far in [0.0, 5.0, 20.0] {
        let [ours, own] = [true, false].map(|medial| key_turned(medial, far));
        println!("{far} m along the axle: {ours}, own {own} rad");
        assert!((ours - own).abs() < 0.06, "{far} m: {ours}, own {own} rad");
    }
}

/// The least speed of a box on a rail that runs into a stop tilted by so many rad, m/s.
fn least_speed_on_a_rail(medial: [bool; 2], tilt: Real, speed: Real, friction: Real) -> Real {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut pipeline = attached(&mut world);
    let builder = RigidBodyBuilder::dynamic()
        .enabled_translations(true, false, false)
        .lock_rotations()
        .linvel(Vector::X * speed)
        .can_sleep(false);
    let slider = solid(medial[0], Vector::splat(0.2)).friction(friction);
    let (body, _) = world.insert(builder, slider);
    let pose = Pose::new(Vector::X * (0.55 + 0.3 * tilt.sin()), Vector::Z * tilt);
    let stop = solid(medial[1], Vector::new(0.05, 1.0, 1.0)).friction(friction);
    world.insert(RigidBodyBuilder::fixed().pose(pose), stop);
    let mut least = speed;
    for _ in 0..60 {
        pipeline.step(&mut world);
        least = least.min(world.bodies[body].linvel().x);
    }
    let x = world.bodies[body].translation().x;
    assert!((0.25..0.4).contains(&x), "it stops at {x} m");
    least
}

/// Symptom: what runs on a rail into a slanted stop, or turns into one that is off its middle, came back at up to
/// friction times the tangent of the slant times its speed; rapier's own stop dead. Cause: friction pushed
/// against the slide of before the impulse along the normal, which had stopped it.
#[test]
fn sliders_stop_dead_at_slanted_stops() {
    for (tilt, speed, friction) in [
        (0.3, 4.0, 0.5),
        (0.3, 4.0, 1.0),
        (0.3, 20.0, 0.5),
        (0.6, 4.0, 0.5),
    ] {
        for medial in [[false, false], [true, true], [true, false], [false, true]] {
            let least = least_speed_on_a_rail(medial, tilt, speed, friction);
            println!("{tilt} rad, {speed} m/s, friction {friction}, {medial:?}: {least} m/s");
            assert!(least > -1.0e-3 * speed, "{least} m/s of {speed}");
        }
    }
}

/// Symptom: a ball of which the vertical axis is locked, and which moves down slowly, got thousands of rad/s as it
/// touched the ground below its centre; rapier's own ball does not turn, and passes through. Cause: a lever that is
/// rounding.
#[test]
fn a_ball_driven_down_along_a_locked_axis_is_held_and_does_not_spin() {
    let mut world = world_with_ground();
    let mut pipeline = attached(&mut world);
    let body = RigidBodyBuilder::dynamic()
        .pose(Pose::new(Vector::Y * 0.4, Vector::Z * 0.1))
        .linvel(Vector::new(1.0, -0.5, 0.0))
        .locked_axes(LockedAxes::TRANSLATION_LOCKED_Y);
    let ball = MedialMesh::ball(0.15).expect("a ball");
    let (body, _) = world.insert(body, ColliderBuilder::medial_mesh(ball).density(300.0));
    for step in 0..120 {
        pipeline.step(&mut world);
        let spin = world.bodies[body].angvel().length();
        assert!(spin < 1.0, "{spin} rad/s in step {step}");
    }
    let y = world.bodies[body].translation().y;
    assert!(y > 0.0, "its centre is in the ground, at {y}");
}

/// Symptom: a box that lay on the ground with its vertical axis locked sank in by 6 mm when the axis was let go. Cause:
/// rapier kept the contacts that were not solved.
#[test]
fn boxes_stay_on_the_ground_when_an_axis_is_let_go() {
    let mut world = world_with_ground();
    let mut pipeline = attached(&mut world);
    let body = RigidBodyBuilder::dynamic()
        .translation(Vector::Y * HALF)
        .locked_axes(LockedAxes::TRANSLATION_LOCKED_Y | LockedAxes::ROTATION_LOCKED);
    let (body, _) = world.insert(body, ColliderBuilder::medial_mesh(sharp_box()));
    for _ in 0..30 {
        pipeline.step(&mut world);
    }
    world.bodies[body].set_locked_axes(LockedAxes::empty(), true);
    world.bodies[body].set_linvel(Vector::ZERO, true);
    for _ in 0..30 {
        pipeline.step(&mut world);
        let sunk = HALF - world.bodies[body].translation().y;
        assert!(sunk < 1.5e-3, "it is {sunk} m deep");
    }
}
