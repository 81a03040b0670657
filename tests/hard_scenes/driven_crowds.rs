//! What driven and turning bodies sweep along: crowds of rods before a wall, a rod in a closed box that turns. Judged
//! by where bodies were planted: a rod stays before the wall, and in the box. Beside rapier's own capsules with
//! `ccd_enabled`, before a cuboid and in a compound of cuboids.

use crate::rng::Rng;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// A rod of radius 1 cm along x: the ends of its axis.
const ENDS: [Vector; 2] = [Vector::new(-0.3, 0.0, 0.0), Vector::new(0.3, 0.0, 0.0)];

fn rod(medial: bool) -> ColliderBuilder {
    if !medial {
        return ColliderBuilder::capsule_x(0.3, 0.01);
    }
    let spheres = ENDS.map(|end| MedialSphere::new(end, 0.01));
    let rod = MedialMesh::new(spheres.to_vec(), vec![[0, 1]], vec![]).expect("a rod");
    ColliderBuilder::medial_mesh(rod)
}

fn walls(corners: &[Vector], faces: Vec<[u32; 3]>, radius: Real) -> ColliderBuilder {
    let spheres = corners.iter().map(|c| MedialSphere::new(*c, radius));
    let walls = MedialMesh::new(spheres.collect(), vec![], faces).expect("walls");
    ColliderBuilder::medial_mesh(walls)
}

/// Sheets of rods, 3 cm from each other, at rest before a kinematic wall that comes at 12 m/s (0.2 m a step). Step
/// after which the wall's middle plane is past a rod's end, and by how much (m).
fn swept_over(medial: bool, rods: u32, seed: u64) -> Option<(u32, Real)> {
    let mut random = Rng::new(seed);
    let mut draw = |most: f64| random.range(-most, most) as Real;
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut pipeline = MedialPipeline::new(MedialOptions::default());
    pipeline.attach(&mut world);
    let corners = [(-3.0, -3.0), (3.0, -3.0), (3.0, 3.0), (-3.0, 3.0)];
    let corners = corners.map(|(y, z)| Vector::new(0.0, y, z));
    let speed = 0.2 / world.integration_parameters.dt;
    let wall = RigidBodyBuilder::kinematic_velocity_based().linvel(Vector::X * speed);
    let faces = vec![[0, 1, 2], [0, 2, 3]];
    let shape = match medial {
        true => walls(&corners, faces, 0.02),
        false => ColliderBuilder::cuboid(0.02, 3.0, 3.0),
    };
    let (wall, _) = world.insert(wall, shape);
    let bodies: Vec<_> = (0..rods)
        .map(|k| {
            let across = Vector::new(0.0, draw(0.01), std::f32::consts::FRAC_PI_2 + draw(0.01));
            let turn = Rotation::from_scaled_axis(Vector::X * draw(3.0));
            let turn = turn * Rotation::from_scaled_axis(across);
            let at = Vector::new(0.1 + 0.03 * k as Real, draw(0.1), draw(0.1));
            let body = RigidBodyBuilder::dynamic()
                .pose(Pose::from_parts(at, turn))
                .ccd_enabled(!medial);
            world.insert(body, rod(medial).friction(0.5)).0
        })
        .collect();
    (0..4).find_map(|step| {
        pipeline.step(&mut world);
        let x = world.bodies[wall].translation().x;
        let ahead = |body: &RigidBodyHandle| {
            let ends = ENDS.map(|end| *world.bodies[*body].position() * end);
            // Beside the wall it may be passed.
            match ends.iter().any(|p| p.y.abs().max(p.z.abs()) > 2.5) {
                true => Real::MAX,
                false => ends[0].x.min(ends[1].x) - x,
            }
        };
        let least = bodies.iter().map(ahead).fold(Real::MAX, Real::min);
        (least < 0.0).then_some((step, least))
    })
}

/// Rods that meet each other again and again within the step are carried along by the wall, however many there are.
#[test]
fn a_wall_passes_none_of_the_rods_that_it_pushes() {
    let passed = |medial| -> Vec<_> {
        let passed = |seed| swept_over(medial, 12 + 12 * (seed % 2) as u32, seed);
        (0..30).filter_map(passed).collect()
    };
    let own = passed(false).len();
    println!("rapier's own cuboid passes rods in {own} of 30");
    assert!(own > 0, "rapier's own cuboid passes none");
    let passed = passed(true);
    assert!(passed.is_empty(), "step and m, of 30: {passed:?}");
}

/// A rod in a closed box of six medial walls (2 m, radius 1 cm) that turns by `angle` radians a step of a sixtieth of a
/// second. Step after which an end of the rod's axis is outside the box of the walls' axes, and by how much (m).
fn leaves(
    medial: bool,
    driven: bool,
    angle: Real,
    gravity: Real,
    seed: u32,
) -> Option<(u32, Real)> {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::NEG_Y * gravity;
    let mut pipeline = MedialPipeline::new(MedialOptions::default());
    pipeline.attach(&mut world);
    let (corners, faces) = Cuboid::new(Vector::ONE).to_trimesh();
    let seed = seed as Real;
    let axis = Vector::new(1.0, 0.4, 0.2 + 0.07 * seed).normalize();
    let body = match driven {
        true => RigidBodyBuilder::kinematic_velocity_based(),
        false => RigidBodyBuilder::dynamic(),
    };
    let spin = axis * angle / world.integration_parameters.dt;
    let body = body.angvel(spin).can_sleep(false);
    let shape = match medial {
        true => walls(&corners, faces, 0.01),
        false => {
            let wall = |k: usize| {
                let (mut half, mut at) = (Vector::ONE, Vector::ZERO);
                half[k / 2] = 0.01;
                at[k / 2] = [1.0, -1.0][k % 2];
                (
                    Pose::from_translation(at),
                    SharedShape::cuboid(half.x, half.y, half.z),
                )
            };
            ColliderBuilder::compound((0..6).map(wall).collect())
        }
    };
    let (closed, _) = world.insert(body, shape.mass(1.0));
    let body = RigidBodyBuilder::dynamic()
        .rotation(Vector::new(0.3 * seed, 1.0, 0.5))
        .linvel(Vector::new(0.5, 0.2, 0.1 * seed))
        .ccd_enabled(!medial)
        .can_sleep(false);
    let (inside, _) = world.insert(body, rod(medial));
    (0..400).find_map(|step| {
        pipeline.step(&mut world);
        let [closed, inside] = [closed, inside].map(|body| *world.bodies[body].position());
        let out = ENDS.map(|end| (closed.inverse() * (inside * end)).abs().max_element() - 1.0);
        let most = out[0].max(out[1]);
        (most > 1.0e-4).then_some((step, most))
    })
}

/// Pressed on by nothing but their own motion, step after step, the axes come no nearer than poses are rounded.
#[test]
fn a_rod_stays_in_a_box_that_turns() {
    for (driven, angle, gravity) in [
        (false, 0.3, 0.0),
        (false, 1.0, 0.0),
        (true, 0.3, 9.81),
        (true, 1.0, 9.81),
    ] {
        let left = |medial| -> Vec<_> {
            let left = |seed| leaves(medial, driven, angle, gravity, seed);
            (0..8).filter_map(left).collect()
        };
        let own = left(false).len();
        println!("driven {driven}, {angle} rad a step: of rapier's own {own} of 8 rods get out");
        assert!(own > 0, "none of rapier's own gets out");
        let left = left(true);
        assert!(left.is_empty(), "step and m, of 8: {left:?}");
    }
}
