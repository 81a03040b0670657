//! What slides or rolls over level ground without meeting anything keeps its speed: over medial plates, whose slabs
//! hide each other's flanks, and medial bodies with sharp edges over rapier's solids, whose edges just touch these.

use crate::bodies::{attached, octagon};
use crate::table_edges::{Slider, sliders};
use rapier3d::parry::shape::{ConvexPolyhedron, Cuboid};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// A ground as shapes at places, and its friction. Its top is at height 0.
type Ground = (Vec<(Vector, SharedShape)>, Real);

/// What a body did on its way.
#[derive(Debug)]
struct Run {
    /// Its least speed along the way, and its largest upwards.
    least: Real,
    up: Real,
    /// How far it sank in, a length.
    sunk: Real,
}

impl Run {
    fn is_level(&self, speed: Real) -> bool {
        self.least > 0.99 * speed && self.up < 0.1 && self.sunk < 0.006
    }
}

/// A body whose lowest point is at the height `low` in its frame, in 4 m along a ground.
fn along(
    (ground, friction): &Ground,
    (collider, low): (&ColliderBuilder, Real),
    (velocity, spin): (Real, Vector),
    turned: Real,
) -> Run {
    let mut world = PhysicsWorld::new();
    let mut pipeline = attached(&mut world);
    for (at, shape) in ground {
        let shape = ColliderBuilder::new(shape.clone()).translation(*at);
        world.insert_collider(shape.friction(*friction), None);
    }
    let body = RigidBodyBuilder::dynamic()
        .translation(Vector::new(-2.0, -low, 0.03))
        .rotation(Vector::Y * turned)
        .linvel(Vector::X * velocity)
        .angvel(spin);
    let (body, _) = world.insert(body.can_sleep(false), collider.clone().friction(*friction));
    let mut run = Run {
        least: velocity,
        up: 0.0,
        sunk: 0.0,
    };
    for _ in 0..(4.0 / velocity * 60.0) as usize {
        pipeline.step(&mut world);
        let body = &world.bodies[body];
        run.least = run.least.min(body.linvel().x);
        run.up = run.up.max(body.linvel().y);
        run.sunk = run.sunk.max(-low - body.translation().y);
    }
    run
}

fn plates() -> Vec<(&'static str, SharedShape, Real)> {
    let cuboid = |half| MedialMesh::cuboid(half).expect("a cuboid");
    let plate = |name, mesh, top| (name, SharedShape::medial_mesh(mesh), top);
    vec![
        plate("block", cuboid(Vector::new(3.0, 0.25, 1.5)), 0.25),
        plate("plate", cuboid(Vector::new(3.0, 0.05, 1.5)), 0.05),
        plate("sheet", cuboid(Vector::new(3.0, 0.01, 1.5)), 0.01),
        plate(
            "round plate",
            MedialMesh::round_plate(2.9, 1.4, 0.1).expect("a plate"),
            0.1,
        ),
    ]
}

/// Symptom: balls, capsules and boxes that slid over a level medial cuboid were thrown up by as much as 2.4 m/s,
/// rolling balls too. Cause: the next slab's rim, which is in the cuboid or in line with its top, had contacts ahead
/// under a normal aslant.
#[test]
fn what_runs_over_medial_plates_keeps_its_speed() {
    let ends = [Vector::X * -0.2, Vector::X * 0.2];
    let medial =
        |mesh: Result<MedialMesh, MeshError>| ColliderBuilder::medial_mesh(mesh.expect("a body"));
    let ball = || ColliderBuilder::ball(0.15);
    let bodies = [
        ("ball", ball(), -0.15),
        (
            "capsule",
            ColliderBuilder::capsule_from_endpoints(ends[0], ends[1], 0.1),
            -0.1,
        ),
        ("cuboid", ColliderBuilder::cuboid(0.2, 0.05, 0.12), -0.05),
        ("medial ball", medial(MedialMesh::ball(0.15)), -0.15),
        (
            "medial capsule",
            medial(MedialMesh::capsule(ends[0], ends[1], 0.1)),
            -0.1,
        ),
        (
            "medial torus",
            medial(MedialMesh::torus(0.2, 0.05, 20)),
            -0.05,
        ),
    ];
    let own = sliders()
        .into_iter()
        .map(|s| (s.name, ColliderBuilder::new(s.own), s.low));
    let meshes = sliders().into_iter();
    let meshes = meshes.map(|s| (s.name, ColliderBuilder::medial_mesh(s.mesh), s.low));
    let bodies: Vec<_> = bodies.into_iter().chain(own).chain(meshes).collect();
    for (plate, shape, top) in plates() {
        let ground = |friction| (vec![(Vector::Y * -top, shape.clone())], friction);
        for (name, body, low) in &bodies {
            for speed in [1.0, 2.0, 4.0, 8.0] {
                for turned in [0.0, 0.4, 2.0] {
                    let run = (speed, Vector::ZERO);
                    let run = along(&ground(0.0), (body, *low), run, turned);
                    assert!(
                        run.is_level(speed),
                        "{name} over a {plate} at {speed} m/s, turned by {turned}: {run:?}"
                    );
                }
            }
        }
        for speed in [1.0, 2.0, 4.0] {
            let run = (speed, Vector::NEG_Z * (speed / 0.15));
            let run = along(&ground(0.5), (&ball(), -0.15), run, 0.0);
            assert!(
                run.is_level(speed),
                "a ball that rolls over a {plate} at {speed} m/s: {run:?}"
            );
        }
    }
}

/// rapier's own cubes, bricks and cards sink into the octagon by 4 to 21 cm, or fall through it: parry looks at four
/// corners of a side only.
///
/// Symptom: cubes, bricks, cards and L's that slid over a level hull, cylinder or compound, far from any edge, or over
/// the end of a cuboid, were thrown up by as much as 1.8 m/s. Cause: where a sharp edge just touches a face, the
/// normals that parry's iterations find are noise. On a compound of tiles the next tile's side had contacts ahead, for
/// capsules where a normal was off by a ten-thousandth. rapier's own capsule trips there.
#[test]
fn sharp_bodies_keep_their_speed_over_level_solids() {
    let below = |shape| (Vector::Y * -0.5, shape);
    let hull = |points: &[Vector]| {
        SharedShape::new(ConvexPolyhedron::from_convex_hull(points).expect("a hull"))
    };
    let half = |z: Real| {
        (
            Vector::new(0.0, -0.5, z),
            SharedShape::cuboid(4.0, 0.5, 2.0),
        )
    };
    let parts = [-2.0, 2.0].map(|z| (Pose::translation(0.0, 0.0, z), half(z).1));
    let (points, _) = Cuboid::new(Vector::new(4.0, 0.5, 4.0)).to_trimesh();
    let tile = |k: usize| {
        Pose::translation(
            0.25 * (k / 8) as Real - 3.0,
            0.0,
            0.25 * (k % 8) as Real - 0.875,
        )
    };
    let tiles = (0..200).map(|k| (tile(k), SharedShape::cuboid(0.125, 0.5, 0.125)));
    let grounds = [
        ("hull", vec![below(hull(&points))]),
        ("octagon", vec![below(hull(&octagon()))]),
        ("cylinder", vec![below(SharedShape::cylinder(0.5, 4.0))]),
        (
            "compound",
            vec![below(SharedShape::compound(parts.to_vec()))],
        ),
        (
            "compound of tiles",
            vec![below(SharedShape::compound(tiles.collect()))],
        ),
        ("two cuboids", vec![half(-2.0), half(2.0)]),
        ("beam", vec![below(SharedShape::cuboid(4.0, 0.5, 0.1))]),
    ];
    let ring = || Slider {
        name: "ring",
        mesh: MedialMesh::torus(0.12, 0.03, 16).expect("a ring"),
        own: SharedShape::ball(0.03),
        low: -0.03,
    };
    for (ground, shapes) in grounds {
        for slider in sliders().into_iter().chain([ring()]) {
            let body = ColliderBuilder::medial_mesh(slider.mesh);
            for speed in [0.5, 2.0, 6.0] {
                // On the beam rapier's own L tips over, and what comes slowly wanders off its side.
                if ground == "beam" && (["L", "ring"].contains(&slider.name) || speed == 0.5) {
                    continue;
                }
                for turned in [0.0, 0.4, 2.0] {
                    let run = (speed, Vector::ZERO);
                    let ground_of = (shapes.clone(), 0.0);
                    let run = along(&ground_of, (&body, slider.low), run, turned);
                    assert!(
                        run.is_level(speed),
                        "{} over a {ground} at {speed} m/s, turned by {turned}: {run:?}",
                        slider.name
                    );
                }
            }
        }
    }
}

/// Symptom: a ball that came to roll over a compound of level tiles turned to the side, by 5 cm in three seconds
/// (rapier's own by 0). Cause: where it had sunk in a little an impact on the next tile, or on the other half of a
/// tile, acted along the ground's normal, but beside the ball's lowest point.
#[test]
fn balls_roll_straight_over_tiles() {
    let tile = |k: usize| Pose::translation(0.25 * k as Real - 3.0, -0.1, 0.0);
    let tiles = (0..40).map(|k| (tile(k), SharedShape::cuboid(0.125, 0.1, 1.0)));
    let ground = SharedShape::compound(tiles.collect());
    for k in 0..8 {
        let mut world = PhysicsWorld::new();
        let mut pipeline = attached(&mut world);
        world.insert_collider(ColliderBuilder::new(ground.clone()).friction(0.1), None);
        let ball = MedialMesh::ball(0.08).expect("a ball");
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::new(-2.0 + 0.03 * k as Real, 0.0805, 0.0))
            .linvel(Vector::X * (1.0 + 0.1 * k as Real));
        let (body, _) = world.insert(body, ColliderBuilder::medial_mesh(ball).friction(0.1));
        for _ in 0..180 {
            pipeline.step(&mut world);
        }
        let (at, v) = (
            world.bodies[body].translation(),
            world.bodies[body].linvel(),
        );
        assert!(at.z.abs() < 0.005, "{} m to the side, at {v} m/s", at.z);
    }
}

/// A body that slides along a wall of tiles, on a floor of tiles, without friction, keeps its speed.
///
/// Symptom: blocks and planks lost two thirds of it (rapier's own nearly all). Cause: they had so many contacts with
/// the floor that those with the wall were not compared with each other.
#[test]
fn bodies_slide_along_tiled_walls() {
    let half_tile = 0.1;
    let tile = |at: Vector| {
        (
            Pose::from_translation(at),
            SharedShape::cuboid(half_tile, half_tile, half_tile),
        )
    };
    let places = (0..40 * 12).map(|k| {
        let (x, across) = (
            0.2 * (k % 40) as Real - 3.0,
            0.2 * (k / 40) as Real + half_tile,
        );
        [
            Vector::new(x, -half_tile, across - 0.4),
            Vector::new(x, across, -0.3),
        ]
    });
    let ground = SharedShape::compound(places.flatten().map(tile).collect());
    let mut least: [Real; 2] = [1.0; 2];
    for half in [Vector::new(0.2, 0.08, 0.12), Vector::new(0.5, 0.03, 0.12)] {
        let bodies = [
            ColliderBuilder::medial_mesh(MedialMesh::cuboid(half).expect("a cuboid")),
            ColliderBuilder::cuboid(half.x, half.y, half.z),
        ];
        for (least, body) in least.iter_mut().zip(bodies) {
            for start in 0..6 {
                let mut world = PhysicsWorld::new();
                let mut pipeline = attached(&mut world);
                world.insert_collider(ColliderBuilder::new(ground.clone()).friction(0.0), None);
                let at = Vector::new(0.017 * start as Real - 2.0, half.y + 0.001, half.z - 0.199);
                let moving = RigidBodyBuilder::dynamic()
                    .translation(at)
                    .linvel(Vector::new(1.0, 0.0, -0.2));
                let (handle, _) = world.insert(moving, body.clone().friction(0.0));
                for _ in 0..150 {
                    pipeline.step(&mut world);
                    *least = least.min(world.bodies[handle].linvel().x);
                }
            }
        }
    }
    let [ours, own] = least;
    assert!(
        ours > 0.95 && own < 0.5,
        "least speeds {ours} m/s, rapier's own {own}"
    );
}

/// Two boxes as one mesh: a floor of 100 m, and a step of 0.8 mm on it.
fn floor_with_step() -> MedialMesh {
    let [floor, step] = [Vector::new(50.0, 0.5, 2.0), Vector::new(0.1, 0.1, 2.0)];
    let [floor, step] = [floor, step].map(|half| MedialMesh::cuboid(half).expect("a cuboid"));
    let moved = |mesh: &MedialMesh, by: Vector| -> Vec<MedialSphere> {
        let spheres = mesh.spheres().iter();
        spheres
            .map(|s| MedialSphere::new(s.center + by, s.radius))
            .collect()
    };
    let mut spheres = moved(&floor, Vector::Y * -0.5);
    let first = spheres.len() as u32;
    spheres.extend(moved(&step, Vector::new(0.1, 0.0008 - 0.1, 0.0)));
    let shifted = step.faces().iter().map(|f| f.map(|k| k + first));
    let faces = floor.faces().iter().copied().chain(shifted).collect();
    MedialMesh::new(spheres, Vec::new(), faces).expect("a floor with a step")
}

/// A step that is low for the size of the mesh is met: a box that comes slowly stays in front of it, as rapier's own
/// does.
#[test]
fn low_steps_on_large_meshes_stop_boxes() {
    let (mesh, half) = (floor_with_step(), Vector::splat(0.025));
    let bodies = [
        ColliderBuilder::medial_mesh(MedialMesh::cuboid(half).expect("a cuboid")),
        ColliderBuilder::cuboid(half.x, half.y, half.z),
    ];
    for body in bodies {
        let mut world = PhysicsWorld::new();
        let mut pipeline = attached(&mut world);
        world.insert_collider(
            ColliderBuilder::medial_mesh(mesh.clone()).friction(0.0),
            None,
        );
        let at = Vector::new(-0.075, half.y, 0.0);
        let moving = RigidBodyBuilder::dynamic()
            .translation(at)
            .linvel(Vector::X * 0.3);
        let (body, _) = world.insert(moving, body.friction(0.0));
        for _ in 0..120 {
            pipeline.step(&mut world);
        }
        let front = world.bodies[body].translation().x + half.x;
        assert!(front < 0.001, "{front} m past the step");
    }
}
