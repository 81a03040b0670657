//! Threads and pegs at real scale, with tenths of a millimetre of play (`examples/factory` is the long run of these).

use crate::thread::{Part, THREADS, Thread};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::f64::consts::TAU;

type Ball = ([f64; 3], f64);

/// Balls of all slabs of a mesh, closely, in double precision.
fn balls(mesh: &MedialMesh) -> Vec<Ball> {
    const STEPS: usize = 6;
    let mut balls = Vec::new();
    for face in mesh.faces() {
        let corners = face.map(|k| mesh.spheres()[k as usize]);
        for i in 0..=STEPS {
            for j in 0..=STEPS - i {
                let weights = [i, j, STEPS - i - j].map(|w| w as f64 / STEPS as f64);
                let mut ball = ([0.0; 3], 0.0);
                for (corner, weight) in corners.iter().zip(weights) {
                    for (sum, c) in ball.0.iter_mut().zip(corner.center.to_array()) {
                        *sum += weight * f64::from(c);
                    }
                    ball.1 += weight * f64::from(corner.radius);
                }
                balls.push(ball);
            }
        }
    }
    balls
}

/// How far a point is outside of the true part, metres: along the normal of its flanks, or from its crest.
fn outside(thread: &Thread, part: Part, [x, y, z]: [f64; 3]) -> f64 {
    let from_ridge = thread.past_ridge(part, (-z).atan2(x), y);
    let [crest, _] = thread.radii(part);
    let r = x.hypot(z);
    let [beyond_crest, flat] = match part {
        Part::Bolt => [r - crest, thread.pitch / 16.0],
        Part::Nut => [crest - r, thread.pitch / 8.0],
    };
    // A flank is at 30° to the radius.
    let beyond_flank = 0.5 * beyond_crest + 0.75_f64.sqrt() * (from_ridge - flat);
    beyond_crest.max(beyond_flank)
}

/// The planted mesh is nowhere outside of the true thread, and nowhere on its flanks inside of it, by more than a share
/// of the play.
#[test]
fn planted_threads_are_as_iso_says() {
    for thread in THREADS {
        for part in [Part::Bolt, Part::Nut] {
            let [low, high] = [-1.5 * thread.pitch, 1.5 * thread.pitch];
            let mesh = thread.medial(part, [low, high]).expect("a thread");
            let balls = balls(&mesh);
            let (mut out, mut missing) = (f64::MIN, f64::MIN);
            for (center, radius) in &balls {
                // The valleys between two ridges are closed by both.
                let [x, y, z] = *center;
                let far = x.hypot(z);
                for k in 0..24 {
                    let (sin, cos) = (TAU * f64::from(k) / 24.0).sin_cos();
                    let side = [x / far, z / far].map(|c| c * radius * cos);
                    let point = [x + side[0], y + radius * sin, z + side[1]];
                    let [_, root] = thread.radii(part);
                    let r = point[0].hypot(point[2]);
                    let in_valley = match part {
                        Part::Bolt => r < root,
                        Part::Nut => r > root,
                    };
                    if !in_valley {
                        out = out.max(outside(&thread, part, point));
                    }
                }
            }
            for k in 0..60 {
                let angle = TAU * f64::from(k) / 60.0 - 0.5 * TAU;
                for step in [-5, -4, -3, 3, 4, 5] {
                    // Flanks between a fifth of a pitch from the middle of the ridge and the root.
                    let aside = f64::from(step) / 16.0 * thread.pitch;
                    let r = thread.surface(part, aside.abs());
                    let ahead = if part == Part::Bolt { 0.0 } else { 0.5 };
                    let mut turns = angle / TAU + ahead;
                    turns -= turns.round();
                    let y = turns * thread.pitch + aside;
                    let (sin, cos) = angle.sin_cos();
                    let point = [r * cos, y, -r * sin];
                    let gap = balls.iter().map(|(center, radius)| {
                        let square = (0..3).map(|k| (point[k] - center[k]).powi(2));
                        square.sum::<f64>().sqrt() - radius
                    });
                    missing = missing.max(gap.fold(f64::MAX, f64::min));
                }
            }
            println!(
                "{} {part:?}: {:.4} mm outside, {:.4} mm inside, of {} mm of play",
                thread.name,
                1.0e3 * out,
                1.0e3 * missing,
                1.0e3 * thread.play
            );
            assert!(
                out < 0.2 * thread.play,
                "{} {part:?}: {out} outside",
                thread.name
            );
            assert!(
                missing < 0.2 * thread.play,
                "{} {part:?}: {missing} inside",
                thread.name
            );
        }
    }
}

/// A nut hammered at 1 m/s, ten times its play in a step, stays on its thread.
#[test]
fn a_hammered_nut_stays_on_its_thread() {
    let thread = THREADS[0];
    let mesh = |part, heights| thread.medial(part, heights).expect("a thread");
    let bolt = mesh(Part::Bolt, [-8.0, 8.0].map(|turns| turns * thread.pitch));
    let nut = mesh(Part::Nut, [-1.0, 1.0].map(|turns| turns * thread.pitch));
    let mut world = PhysicsWorld::new();
    world.integration_parameters = IntegrationParameters::for_detail(0.001).expect("a size");
    world.integration_parameters.dt = 1.0 / 120.0;
    let bolt = ColliderBuilder::medial_mesh(bolt).friction(0.15);
    world.insert(RigidBodyBuilder::fixed(), bolt);
    let nut = ColliderBuilder::medial_mesh(nut).friction(0.15);
    let (nut, _) = world.insert(RigidBodyBuilder::dynamic(), nut.density(7850.0));
    let mut pipeline = MedialPipeline::default();
    let (mut turns, mut off) = (0.0, 0.0_f64);
    for step in 0..24 {
        if step % 8 == 0 {
            world.bodies[nut].set_linvel(Vector::NEG_Y, true);
        }
        let last = *world.bodies[nut].rotation();
        pipeline.step(&mut world);
        let pose = world.bodies[nut].position();
        let turn = pose.rotation * last.inverse();
        turns += f64::from(2.0 * turn.y.atan2(turn.w)) / TAU;
        off = off.max((f64::from(pose.translation.y) - turns * thread.pitch).abs());
    }
    let play = thread.axial_play();
    println!("off by {off} m, {turns} turns, of {play} m of play");
    assert!(off < 1.2 * play, "off by {off} m of {play}");
}

/// Turns that a nut without friction goes down its bolt by its weight in some seconds.
fn turned(thread: &Thread, hertz: Real, seconds: f64) -> f64 {
    let mesh = |part, heights| thread.medial(part, heights).expect("a thread");
    let bolt = [-3.0 * thread.pitch - thread.nut[0], thread.nut[0]];
    let bolt = ColliderBuilder::medial_mesh(mesh(Part::Bolt, bolt)).friction(0.0);
    let nut = ColliderBuilder::medial_mesh(mesh(Part::Nut, thread.nuts_heights()));
    let mut world = PhysicsWorld::new();
    world.integration_parameters = IntegrationParameters::for_detail(0.001).expect("a size");
    world.integration_parameters.dt = hertz.recip();
    world.insert(RigidBodyBuilder::fixed(), bolt);
    // On the flanks below.
    let start = Vector::Y * (-0.9 * thread.axial_play()) as Real;
    let body = RigidBodyBuilder::dynamic().translation(start);
    let (nut, _) = world.insert(body, nut.friction(0.0).density(7850.0));
    let mut pipeline = MedialPipeline::default();
    let mut turns = 0.0;
    for _ in 0..(seconds * f64::from(hertz)).round() as usize {
        let last = *world.bodies[nut].rotation();
        pipeline.step(&mut world);
        let turn = *world.bodies[nut].rotation() * last.inverse();
        turns -= f64::from(2.0 * turn.y.atan2(turn.w)) / TAU;
    }
    turns
}

/// Without friction nuts go down by their weight at about one share of the speed that theory gives, be the thread tight
/// or loose and the steps long or short. What slows them is that both threads have corners.
#[test]
fn nuts_without_friction_go_down_alike() {
    for (k, hertz) in [(2, 240.0), (2, 480.0), (3, 240.0), (4, 240.0)] {
        let thread = &THREADS[k];
        // One turn.
        let seconds = (2.0 * thread.pitch / thread.acceleration()).sqrt();
        let turns = turned(thread, hertz, seconds);
        let name = thread.name;
        println!("{name} at {hertz} steps a second: {turns:.3} turns of 1");
        assert!((0.6..0.8).contains(&turns), "{name}: {turns}");
    }
}

/// Metres that a round peg of 8 mm got into a hole with 0.05 mm of play in a tenth of a second.
fn peg(parameters: IntegrationParameters) -> Real {
    const WALLS: u32 = 64;
    let (half, play, wall) = (4.0e-3, 0.025e-3, 3.0e-3);
    let corner = (half + play + wall) / (std::f32::consts::PI / WALLS as Real).cos();
    let at = |k: u32| {
        let (sin, cos) = (k as Real / WALLS as Real * std::f32::consts::TAU).sin_cos();
        let center = |y| Vector::new(corner * cos, y, corner * sin);
        [-0.05, -0.003].map(|y| MedialSphere::new(center(y), wall))
    };
    let side = |k: u32| {
        let [a, b] = [2 * k, 2 * ((k + 1) % WALLS)];
        [[a, a + 1, b], [a + 1, b + 1, b]]
    };
    let spheres = (0..WALLS).flat_map(at).collect();
    let faces = (0..WALLS).flat_map(side).collect();
    let hole = MedialMesh::new(spheres, vec![], faces).expect("a hole");
    let tip = Vector::Y * 0.021;
    let peg = MedialMesh::capsule(-tip, tip, half).expect("a peg");
    let mut world = PhysicsWorld::new();
    world.integration_parameters = parameters;
    world.integration_parameters.dt = 1.0 / 120.0;
    let hole = ColliderBuilder::medial_mesh(hole).friction(0.0);
    world.insert_collider(hole, None);
    let start = Vector::new(0.2 * play, 0.024, 0.0);
    let body = RigidBodyBuilder::dynamic()
        .translation(start)
        .rotation(Vector::Z * 1.0e-3);
    let collider = ColliderBuilder::medial_mesh(peg).friction(0.0);
    let (peg, _) = world.insert(body, collider.density(7850.0));
    let mut pipeline = MedialPipeline::default();
    for _ in 0..12 {
        pipeline.step(&mut world);
    }
    start.y - world.bodies[peg].translation().y
}

/// A peg falls freely through a hole with 0.05 mm of play, by 49 mm in a tenth of a second, with the parameters for its
/// size. The length unit alone caps it at 0.4 m/s.
#[test]
fn a_peg_slides_through_a_narrow_hole_by_its_weight() {
    let fine = IntegrationParameters::for_detail(0.001).expect("a size");
    let unit_alone = IntegrationParameters {
        length_unit: 0.001,
        ..Default::default()
    };
    let [fine, unit_alone, default] = [fine, unit_alone, Default::default()].map(peg);
    println!("{fine} m; {unit_alone} with the length unit alone, {default} by default");
    assert!((0.046..0.054).contains(&fine), "{fine} m");
    assert!(unit_alone < 0.04, "{unit_alone} m");
}

#[test]
fn parameters_for_no_size_are_refused() {
    for detail in [0.0, -1.0, Real::NAN, Real::INFINITY] {
        let refused = IntegrationParameters::for_detail(detail);
        let message = refused.map(|_| ()).expect_err("no size").to_string();
        assert!(message.starts_with("detail is"), "{message}");
    }
    let tiny = IntegrationParameters::for_detail(1.0e-40).expect("a size");
    assert!(tiny.normalized_max_linear_velocity.is_finite());
}
