//! Thin parts of thick bodies, and parts of radius 0: a body is as thin as what it meets with. Antennas,
//! sheets and fins are thrown at each other; whether one got through another is told by the order of their
//! axes, in double precision and without the library.

use crate::bodies::*;
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Throws of each kind.
const THROWS: u32 = 32;

/// Density of a body's mass as a box of these half extents: sheets have no volume of their own.
fn boxed(mesh: MedialMesh, half: Vector) -> MedialMesh {
    let shape = SharedShape::cuboid(half.x, half.y, half.z);
    mesh.with_mass_properties(shape.mass_properties(1.0))
}

/// Four spheres of a square in the plane Y = 0, and its two faces.
fn square(half: Real, radius: Real) -> (Vec<MedialSphere>, Vec<[u32; 3]>) {
    let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
    let sphere = |(x, z): (Real, Real)| MedialSphere::new(Vector::new(x, 0.0, z), radius);
    let spheres = corners.into_iter().map(sphere).collect();
    (spheres, vec![[0, 1, 2], [0, 2, 3]])
}

/// Axis of the antenna in the body's frame: 2.5 m of it stick out of the plate.
const ANTENNA: [Vector; 2] = [Vector::ZERO, Vector::new(0.0, 2.8, 0.0)];

/// A plate of 2 m by 2 m, 0.6 m thick, with an antenna whose radii are those given, from the plate on.
fn plate(antenna: [Real; 2]) -> MedialMesh {
    let (mut spheres, faces) = square(1.0, 0.3);
    for (center, radius) in ANTENNA.into_iter().zip(antenna) {
        spheres.push(MedialSphere::new(center, radius));
    }
    MedialMesh::new(spheres, vec![[4, 5]], faces).expect("a plate with an antenna")
}

/// On which side of the line `p` the line `q` is; `None` where the segments do not cross, seen along the
/// direction across both.
pub fn side(p: [Vector; 2], q: [Vector; 2]) -> Option<bool> {
    let [p0, p1, q0, q1] = [p[0], p[1], q[0], q[1]].map(|v| v.as_dvec3());
    let (u, v, w) = (p1 - p0, q1 - q0, q0 - p0);
    let across = u.cross(v);
    let square = across.length_squared();
    let s = w.cross(v).dot(across) / square;
    let t = w.cross(u).dot(across) / square;
    let inside = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t);
    inside.then_some(w.dot(across) > 0.0)
}

/// Whether two axes passed each other from one pose of each to the next, on the way straight between them.
pub fn crossed(axes: [[Vector; 2]; 2], before: [Pose; 2], after: [Pose; 2]) -> bool {
    const PARTS: u32 = 64;
    let at = |k: usize, s: Real| {
        let pose = Pose::from_parts(
            before[k].translation.lerp(after[k].translation, s),
            before[k].rotation.slerp(after[k].rotation, s),
        );
        axes[k].map(|p| pose * p)
    };
    let sides = |n| {
        let s = n as Real / PARTS as Real;
        side(at(0, s), at(1, s))
    };
    (0..PARTS).any(|n| matches!((sides(n), sides(n + 1)), (Some(a), Some(b)) if a != b))
}

/// How many of the throws at this speed take the antenna of a body through that of another, or through
/// a fixed pillar of radius 0.01.
fn antennas_passed(mesh: &MedialMesh, pillar: bool, speed: Real, throws: u32) -> u32 {
    let thrown = |phase: u32| {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let travel = speed * world.integration_parameters.dt;
        let x = 0.4 + travel * phase as Real / throws as Real;
        let lean = 0.02 * phase as Real - 0.3;
        let pose = Pose::new(Vector::new(x, 2.2, -1.6), Vector::new(1.57, lean, 0.0));
        let body = RigidBodyBuilder::dynamic().pose(pose);
        let body = body.linvel(Vector::new(-speed, 0.0, 0.0));
        let (moving, _) = world.insert(body, ColliderBuilder::medial_mesh(mesh.clone()));
        let resting = (!pillar).then(|| {
            let collider = ColliderBuilder::medial_mesh(mesh.clone());
            world.insert(RigidBodyBuilder::dynamic(), collider).0
        });
        if pillar {
            let spheres = ANTENNA.map(|c| MedialSphere::new(c, 0.01));
            let mesh = MedialMesh::new(spheres.to_vec(), vec![[0, 1]], vec![]).expect("a pillar");
            world.insert_collider(ColliderBuilder::medial_mesh(mesh), None);
        }
        let mut pipeline = attached(&mut world);
        let steps = (1.2 / travel) as usize;
        let poses = |world: &PhysicsWorld| {
            let still = resting.map_or(Pose::IDENTITY, |h| *world.bodies[h].position());
            [*world.bodies[moving].position(), still]
        };
        (0..steps).any(|_| {
            let before = poses(&world);
            pipeline.step(&mut world);
            crossed([ANTENNA; 2], before, poses(&world))
        })
    };
    (0..throws).filter(|phase| thrown(*phase)).count() as u32
}

#[test]
fn no_antenna_of_a_plate_passes_another() {
    let counts = [2.0, 3.0, 4.0].map(|v| antennas_passed(&plate([0.01; 2]), false, v, THROWS));
    assert_eq!(counts, [0; 3], "at 2, 3 and 4 m/s");
}

#[test]
fn no_antenna_passes_a_fixed_pillar() {
    let counts = [2.0, 3.0, 4.0].map(|v| antennas_passed(&plate([0.01; 2]), true, v, THROWS));
    assert_eq!(counts, [0; 3], "at 2, 3 and 4 m/s");
}

/// So slow that the event loop has them only once the solver let them sink in.
#[test]
fn no_antenna_is_pressed_through_another() {
    for pillar in [false, true] {
        let counts = [0.1, 0.3, 1.0].map(|v| antennas_passed(&plate([0.01; 2]), pillar, v, 4));
        assert_eq!(counts, [0; 3], "pillar: {pillar}; at 0.1, 0.3 and 1 m/s");
    }
}

/// Under its own weight, the plate beyond the end of what the antenna lies on.
#[test]
fn no_antenna_sinks_through_a_pillar() {
    let fallen = |phase: u32| {
        let mut world = PhysicsWorld::new();
        let spheres = [-1.0, 1.0].map(|x| MedialSphere::new(Vector::new(x, 0.0, 0.0), 0.01));
        let axis = spheres.map(|s| s.center);
        let mesh = MedialMesh::new(spheres.to_vec(), vec![[0, 1]], vec![]).expect("a pillar");
        world.insert_collider(ColliderBuilder::medial_mesh(mesh), None);
        // The antenna along Z, across the pillar.
        let height = 0.03 + 0.01 * phase as Real;
        let pose = Pose::new(
            Vector::new(0.01 * phase as Real, height, -1.2),
            Vector::new(1.570_796_4, 0.0, 0.0),
        );
        let body = RigidBodyBuilder::dynamic().pose(pose);
        let collider = ColliderBuilder::medial_mesh(plate([0.01; 2]));
        let (body, _) = world.insert(body, collider);
        let mut pipeline = attached(&mut world);
        (0..40).any(|_| {
            let before = [*world.bodies[body].position(), Pose::IDENTITY];
            pipeline.step(&mut world);
            let after = [*world.bodies[body].position(), Pose::IDENTITY];
            crossed([ANTENNA, axis], before, after)
        })
    };
    assert_eq!((0..THROWS).filter(|phase| fallen(*phase)).count(), 0);
}

/// Thick at the plate, and thinner and thinner: down to 5 mm, or to a point.
#[test]
fn no_tapered_antenna_passes_another() {
    for radii in [[0.25, 0.005], [0.1, 0.0]] {
        let counts = [2.0, 4.0].map(|v| antennas_passed(&plate(radii), false, v, THROWS));
        assert_eq!(counts, [0; 2], "{radii:?} at 2 and 4 m/s");
    }
}

/// Throws two bodies at each other along X, each turned a little; how many of 16 end on the wrong side.
fn passed(mesh: &MedialMesh, turned: [Rotation; 2], speed: Real) -> u32 {
    let mut random = Random(20);
    let mut thrown = |phase: u32| {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let travel = speed * world.integration_parameters.dt;
        let handles = [0, 1].map(|k| {
            let side = [1.0, -1.0][k];
            let x = side * (1.0 + travel * phase as Real / 16.0);
            let tilt = Rotation::from_scaled_axis(random.direction() * 0.1);
            let pose = Pose::from_parts(Vector::new(x, 0.0, 0.0), tilt * turned[k]);
            let body = RigidBodyBuilder::dynamic().pose(pose);
            let body = body.linvel(Vector::new(-side * speed, 0.0, 0.0));
            world
                .insert(body, ColliderBuilder::medial_mesh(mesh.clone()))
                .0
        });
        let mut pipeline = attached(&mut world);
        let steps = (1.5 / travel) as usize + 3;
        (0..steps).any(|_| {
            pipeline.step(&mut world);
            let [a, b] = handles.map(|h| world.bodies[h].translation().x);
            a < b
        })
    };
    (0..16).filter(|phase| thrown(*phase)).count() as u32
}

/// Turns the normal of a sheet, Y, to X.
fn facing() -> Rotation {
    Rotation::from_scaled_axis(Vector::new(0.0, 0.0, 1.570_796_4))
}

#[test]
fn no_sheet_of_radius_0_passes_another() {
    let (spheres, faces) = square(0.5, 0.0);
    let sheet = MedialMesh::new(spheres, vec![], faces).expect("a sheet");
    let sheet = boxed(sheet, Vector::new(0.5, 0.01, 0.5));
    let counts = [5.0, 100.0].map(|v| passed(&sheet, [facing(); 2], v));
    assert_eq!(counts, [0; 2], "at 5 and 100 m/s");
}

#[test]
fn a_fin_of_radius_0_does_not_let_its_plate_through() {
    let (mut spheres, mut faces) = square(0.5, 0.05);
    for (x, y) in [(-0.5, 0.0), (0.5, 0.0), (0.0, 0.4)] {
        spheres.push(MedialSphere::new(Vector::new(x, y, 0.0), 0.0));
    }
    faces.push([4, 5, 6]);
    let finned = MedialMesh::new(spheres, vec![], faces).expect("a plate with a fin");
    let finned = boxed(finned, Vector::new(0.5, 0.05, 0.5));
    let back = Rotation::from_scaled_axis(Vector::new(0.0, 0.0, -1.570_796_4));
    for turned in [[facing(); 2], [facing(), back], [back, facing()]] {
        assert_eq!(passed(&finned, turned, 100.0), 0, "at 100 m/s");
    }
}

/// What a step costs where nothing is thin: printed, to compare versions.
#[test]
#[ignore = "prints counts to compare by eye, and judges nothing"]
fn print_the_work_of_steps_with_rings() {
    for (name, height) in [("resting", 0.101), ("falling", 1.5)] {
        let mut world = world_with_ground();
        for k in 0..6 {
            let at = Vector::new(0.3 * (k % 3) as Real, height + 0.25 * k as Real, 0.0);
            add_ring(&mut world, As::Medial, Pose::from_translation(at));
        }
        let mut pipeline = attached(&mut world);
        let (mut tests, mut nodes, mut queries, mut events) = (0, 0, 0, 0);
        let clock = std::time::Instant::now();
        for _ in 0..240 {
            let report = pipeline.step(&mut world);
            tests += report.elementary_tests;
            nodes += report.culled_nodes;
            queries += report.continuous_queries;
            events += report.events;
        }
        let ms = clock.elapsed().as_secs_f64() * 1e3;
        println!(
            "{name}: tests {tests}, nodes {nodes}, queries {queries}, events {events}, {ms:.1} ms"
        );
    }
}

/// A box of a triangle mesh with a rod that stands on it, as the builder makes it.
#[test]
fn no_rod_of_a_built_box_passes_another() {
    let (mut vertices, mut indices) = Cuboid::new(Vector::splat(0.4)).to_trimesh();
    let (rod, faces) = Cuboid::new(Vector::new(0.015, 1.4, 0.015)).to_trimesh();
    let first = vertices.len() as u32;
    let aside = Vector::new(0.0, 1.4, 0.0);
    vertices.extend(rod.into_iter().map(|p| p + aside));
    indices.extend(faces.into_iter().map(|face| face.map(|v| v + first)));
    let options = BuildOptions {
        primitives: Some(40),
        quality: Quality::Fast,
        ..BuildOptions::default()
    };
    let built = MedialMesh::from_trimesh(&vertices, &indices, &options);
    let (mesh, _) = built.expect("a box with a rod");
    let counts = [2.0, 3.0, 4.0].map(|v| antennas_passed(&mesh, false, v, THROWS));
    assert_eq!(counts, [0; 3], "at 2, 3 and 4 m/s");
}

/// Symptom: a sheet 1 m wide that was dropped from 0.1 m fell through a triangle mesh or a fixed sheet, of radius 0 by
/// itself, up to 1 cm thick under a box. Cause: each meeting below the floor took the same length, or half of what was
/// left to the axes, so that a few meetings of a step used it up. And where that length was just what was left, it took
/// all of it: sheets of radius 0 came to lie 0.12 mm below, as deep as rapier's own cuboids rest.
#[test]
fn sheets_do_not_sink_through_what_they_lie_on() {
    let square = |half: Real| {
        let corner = |x: Real, z: Real| Vector::new(x * half, 0.0, z * half);
        [
            corner(-1.0, -1.0),
            corner(1.0, -1.0),
            corner(1.0, 1.0),
            corner(-1.0, 1.0),
        ]
    };
    let sheet = |half: Real, radius: Real| {
        let spheres = square(half).map(|c| MedialSphere::new(c, radius)).to_vec();
        MedialMesh::new(spheres, vec![], vec![[0, 1, 2], [0, 2, 3]]).expect("a sheet")
    };
    for (radius, on_triangles, loaded) in [0.0, 0.001, 0.01].into_iter().flat_map(|radius| {
        [[false, false], [false, true], [true, false], [true, true]]
            .map(|[on_triangles, loaded]| (radius, on_triangles, loaded))
    }) {
        let mut world = PhysicsWorld::new();
        let ground = if on_triangles {
            let triangles = vec![[0, 2, 1], [0, 3, 2]];
            ColliderBuilder::trimesh(square(5.0).to_vec(), triangles).expect("two triangles")
        } else {
            ColliderBuilder::medial_mesh(sheet(5.0, 0.0))
        };
        world.insert_collider(ground, None);
        let plate = SharedShape::cuboid(0.5, 0.01, 0.5).mass_properties(1.0);
        let dropped = RigidBodyBuilder::dynamic().translation(Vector::Y * 0.1);
        let collider = ColliderBuilder::medial_mesh(sheet(0.5, radius).with_mass_properties(plate));
        let dropped = world.insert(dropped, collider).0;
        if loaded {
            let above = RigidBodyBuilder::dynamic().translation(Vector::Y * 0.8);
            world.insert(above, ColliderBuilder::cuboid(0.3, 0.2, 0.3).density(50.0));
        }
        let mut pipeline = attached(&mut world);
        let mut y = Real::MAX;
        for _ in 0..200 {
            pipeline.step(&mut world);
            let pose = *world.bodies[dropped].position();
            y = square(0.5)
                .map(|corner| (pose * corner).y)
                .into_iter()
                .fold(y, Real::min);
        }
        assert!(
            y > 0.0,
            "radius {radius}, on triangles {on_triangles}, loaded {loaded}: {y}"
        );
    }
}

/// Symptom: a stack of cubes that tipped over hung in the air, its upper cubes frozen in every step, while gravity made
/// them faster. Cause: sharp edges that touched by less than the tolerance met again at once, though they parted.
#[test]
fn a_stack_of_cubes_that_tips_over_comes_to_rest() {
    let fastest = |collider: ColliderBuilder| {
        let mut world = PhysicsWorld::new();
        let ground = ColliderBuilder::cuboid(5.0, 1.0, 5.0).translation(Vector::Y * -1.0);
        world.insert_collider(ground, None);
        let mut bodies = Vec::new();
        for level in 0..6 {
            let aside = if level % 2 == 0 { 0.1 } else { -0.1 };
            let at = Vector::new(aside, 0.5 + 0.75 * level as Real, 0.0);
            let body = RigidBodyBuilder::dynamic().translation(at);
            bodies.push(world.insert(body, collider.clone()).0);
        }
        let mut pipeline = MedialPipeline::default();
        for _ in 0..600 {
            pipeline.step(&mut world);
        }
        let speeds = bodies.iter().map(|h| world.bodies[*h].linvel().length());
        speeds.fold(0.0, Real::max)
    };
    let cube = MedialMesh::cuboid(Vector::splat(0.25)).expect("a cube");
    let ours = fastest(ColliderBuilder::medial_mesh(cube));
    let own = fastest(ColliderBuilder::cuboid(0.25, 0.25, 0.25));
    assert!(ours < 0.01 && own < 0.01, "{ours} m/s, rapier's {own}");
}
