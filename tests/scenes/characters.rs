//! rapier's character controller in rooms and with characters of medial meshes: nothing is walked into or
//! through, at any speed, and the walk ends where it does among rapier's own shapes. Depths are judged in
//! `f64` from the planted rooms.

use crate::bodies::attached;
use rapier3d::control::{
    CharacterAutostep, CharacterLength, EffectiveCharacterMovement, KinematicCharacterController,
};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Radius of floors and walls, and of the character.
const WALL: Real = 0.1;
const RADIUS: Real = 0.2;
const HALF: Real = 0.3;

/// A profile in the plane of x and y, 4 m wide in z: its ends, first to last, are joined by slabs.
struct Room(Vec<[Real; 2]>);

impl Room {
    /// A floor and a wall at its end.
    fn corner() -> Self {
        Self(vec![[-3.0, 0.0], [1.0, 0.0], [1.0, 3.0]])
    }

    /// A floor, a slope of so many degrees, and a floor again.
    fn slope(degrees: Real) -> Self {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Self(vec![
            [-4.0, 0.0],
            [-1.0, 0.0],
            [-1.0 + 2.0 * cos, 2.0 * sin],
            [6.0 + 2.0 * cos, 2.0 * sin],
        ])
    }

    /// A floor that goes on so much higher, or lower.
    fn step(height: Real) -> Self {
        Self(vec![
            [-4.0, 0.0],
            [-1.0, 0.0],
            [-1.0, height],
            [5.0, height],
        ])
    }

    fn medial(&self) -> ColliderBuilder {
        let ends = self
            .0
            .iter()
            .flat_map(|&[x, y]| [-2.0, 2.0].map(|z| MedialSphere::new(Vector::new(x, y, z), WALL)));
        let slabs = (0..self.0.len() as u32 - 1).map(|k| 2 * k);
        let slabs = slabs.flat_map(|k| [[k, k + 1, k + 2], [k + 1, k + 3, k + 2]]);
        let mesh = MedialMesh::new(ends.collect(), vec![], slabs.collect()).expect("a room");
        ColliderBuilder::medial_mesh(mesh)
    }

    /// The same of rapier's round cuboids.
    fn rapiers(&self) -> ColliderBuilder {
        let thin = 0.001;
        let part = |ends: &[[Real; 2]]| {
            let [a, b] = [ends[0], ends[1]].map(|[x, y]| Vector::new(x, y, 0.0));
            let way = b - a;
            let turn = Vector::Z * way.y.atan2(way.x);
            let half = 0.5 * way.length();
            let shape = SharedShape::round_cuboid(half, thin, 2.0, WALL - thin);
            (Pose::new((a + b) * 0.5, turn), shape)
        };
        ColliderBuilder::compound(self.0.windows(2).map(part).collect())
    }

    /// Signed distance of an upright character at `p`, by sampling its axis.
    fn gap(&self, p: Vector) -> f64 {
        let mut least = f64::MAX;
        for ends in self.0.windows(2) {
            let [a, b] = [ends[0], ends[1]].map(|e| e.map(f64::from));
            let d = [b[0] - a[0], b[1] - a[1]];
            for k in 0..=600 {
                let y = f64::from(p.y) + f64::from(HALF) * (f64::from(k) / 300.0 - 1.0);
                let to = [f64::from(p.x) - a[0], y - a[1]];
                let s = (to[0] * d[0] + to[1] * d[1]) / (d[0] * d[0] + d[1] * d[1]);
                let s = s.clamp(0.0, 1.0);
                least = least.min((to[0] - s * d[0]).hypot(to[1] - s * d[1]));
            }
        }
        least - f64::from(RADIUS) - f64::from(WALL)
    }
}

fn medial_character() -> SharedShape {
    let ends = [-HALF, HALF].map(|y| MedialSphere::new(Vector::new(0.0, y, 0.0), RADIUS));
    SharedShape::new(MedialMesh::new(ends.to_vec(), vec![[0, 1]], vec![]).expect("a character"))
}

/// Where a walk ends.
#[derive(Clone, Copy, Debug)]
struct Walk {
    end: Vector,
    /// Moves after which the character overlaps the room.
    overlaps: usize,
    deepest: f64,
    grounded: usize,
}

fn walk(
    ground: ColliderBuilder,
    shape: &dyn Shape,
    controller: &KinematicCharacterController,
    start: Vector,
    wish: Vector,
    moves: usize,
    gap: impl Fn(Vector) -> f64,
) -> Walk {
    let mut world = PhysicsWorld::new();
    let _pipeline = attached(&mut world);
    world.insert_collider(ground, None);
    world.detect_collisions(&(), &());
    let mut walk = Walk {
        end: start,
        overlaps: 0,
        deepest: 0.0,
        grounded: 0,
    };
    for _ in 0..moves {
        let at = Pose::from_translation(walk.end);
        let queries = world.query_pipeline();
        let moved: EffectiveCharacterMovement =
            controller.move_shape(1.0 / 60.0, &queries, shape, &at, wish, |_| ());
        walk.end += moved.translation;
        walk.grounded += usize::from(moved.grounded);
        let gap = gap(walk.end);
        walk.overlaps += usize::from(gap < 0.0);
        walk.deepest = walk.deepest.min(gap);
    }
    walk
}

/// All four of medial and rapier's rooms and characters, rapier's own first.
fn in_all(
    room: &Room,
    controller: &KinematicCharacterController,
    start: Vector,
    wish: Vector,
    moves: usize,
) -> [Walk; 4] {
    let (capsule, medial) = (SharedShape::capsule_y(HALF, RADIUS), medial_character());
    let gap = |p: Vector| room.gap(p);
    let go = |ground: ColliderBuilder, shape: &SharedShape| {
        walk(ground, shape.as_ref(), controller, start, wish, moves, gap)
    };
    [
        go(room.rapiers(), &capsule),
        go(room.medial(), &capsule),
        go(room.rapiers(), &medial),
        go(room.medial(), &medial),
    ]
}

#[test]
fn a_wall_stops_a_character_at_any_speed() {
    for speed in [0.005, 0.02, 0.07, 0.2, 1.0] {
        let (start, wish) = (Vector::new(-2.0, 0.62, 0.0), Vector::new(speed, -0.01, 0.0));
        let moves = if speed < 0.01 { 600 } else { 200 };
        let walks = in_all(
            &Room::corner(),
            &KinematicCharacterController::default(),
            start,
            wish,
            moves,
        );
        for walk in walks {
            assert_eq!(walk.overlaps, 0, "{speed}: {walk:?}");
            assert!(
                (walk.end - walks[0].end).length() < 0.005,
                "{speed}: {walks:?}"
            );
        }
    }
}

#[test]
fn slopes_are_climbed_or_not_as_in_rapier() {
    for degrees in [10.0, 30.0, 44.0, 60.0] {
        let (start, wish) = (Vector::new(-3.0, 0.62, 0.0), Vector::new(0.03, -0.02, 0.0));
        let walks = in_all(
            &Room::slope(degrees),
            &KinematicCharacterController::default(),
            start,
            wish,
            150,
        );
        for walk in walks {
            assert_eq!(walk.overlaps, 0, "{degrees}: {walk:?}");
            assert!(
                (walk.end - walks[0].end).length() < 0.05,
                "{degrees}: {walks:?}"
            );
        }
    }
}

#[test]
fn steps_are_climbed_and_snapped_to_as_in_rapier() {
    for height in [0.15, 0.5, -0.1, -0.5] {
        let controller = KinematicCharacterController {
            autostep: Some(CharacterAutostep {
                max_height: CharacterLength::Absolute(0.25),
                min_width: CharacterLength::Absolute(0.1),
                include_dynamic_bodies: false,
            }),
            snap_to_ground: Some(CharacterLength::Absolute(0.2)),
            ..Default::default()
        };
        let (start, wish) = (Vector::new(-3.0, 0.62, 0.0), Vector::new(0.03, -0.01, 0.0));
        let walks = in_all(&Room::step(height), &controller, start, wish, 150);
        for walk in walks {
            assert_eq!(walk.overlaps, 0, "{height}: {walk:?}");
            // rapier's character hangs for some moves at the edge of a step down.
            let (least, most) = (walks[0].end.x - 0.005, start.x + 150.0 * wish.x + 0.005);
            assert!((least..most).contains(&walk.end.x), "{height}: {walks:?}");
            assert!(
                (walk.end.y - walks[0].end.y).abs() < 0.001,
                "{height}: {walks:?}"
            );
        }
    }
}

/// A bumpy body: a square of slabs, each corner at a height of its own.
fn bumpy() -> MedialMesh {
    let side = 25u32;
    let spheres = (0..side * side).map(|k| {
        let (x, z) = ((k % side) as Real, (k / side) as Real);
        let height = 0.06 * ((1.9 * x + 0.7 * z).sin() + (0.8 * x - 2.3 * z).cos());
        MedialSphere::new(Vector::new(0.3 * x - 3.6, height, 0.3 * z - 3.6), 0.08)
    });
    let cells = (0..(side - 1) * (side - 1)).map(|c| c % (side - 1) + side * (c / (side - 1)));
    let faces = cells.flat_map(|c| [[c, c + 1, c + side + 1], [c, c + side + 1, c + side]]);
    MedialMesh::new(spheres.collect(), vec![], faces.collect()).expect("a bumpy body")
}

/// Least signed distance of an upright character to a mesh, by sampling its axis.
fn gap_to(mesh: &MedialMesh, p: Vector) -> f64 {
    let near = mesh
        .primitives()
        .filter(|m| m.spheres().iter().any(|s| (s.center - p).length() < 1.5));
    let mut least = Real::MAX;
    for primitive in near {
        for k in 0..=24 {
            let at = p + Vector::Y * (HALF * (k as Real / 12.0 - 1.0));
            least = least.min(primitive.signed_distance(at).distance);
        }
    }
    f64::from(least - RADIUS)
}

/// On bumps everywhere, no more overlaps than on rapier's triangle mesh of the same body, and as far.
#[test]
fn bumps_are_walked_over_as_on_a_triangle_mesh() {
    let mesh = bumpy();
    let (vertices, indices) = mesh.envelope(0.05);
    let capsule = SharedShape::capsule_y(HALF, RADIUS);
    let mut overlaps = [0; 3];
    let mut moved = [0.0; 3];
    for k in 0..4 {
        let angle = 0.7 + 1.6 * k as Real;
        let wish = Vector::new(0.03 * angle.cos(), -0.02, 0.03 * angle.sin());
        let start = Vector::new(0.1, 0.9, -0.2);
        let trimesh = ColliderBuilder::trimesh(vertices.clone(), indices.clone()).expect("a mesh");
        let grounds = [
            (trimesh, capsule.clone()),
            (ColliderBuilder::medial_mesh(mesh.clone()), capsule.clone()),
            (
                ColliderBuilder::medial_mesh(mesh.clone()),
                medial_character(),
            ),
        ];
        for (i, (ground, shape)) in grounds.into_iter().enumerate() {
            let controller = KinematicCharacterController::default();
            let gap = |p: Vector| gap_to(&mesh, p);
            let walk = walk(ground, shape.as_ref(), &controller, start, wish, 100, gap);
            overlaps[i] += walk.overlaps;
            let way = walk.end - start;
            moved[i] += way.x.hypot(way.z);
        }
    }
    assert!(
        overlaps[1] <= overlaps[0] && overlaps[2] <= overlaps[0],
        "{overlaps:?}"
    );
    assert!(
        moved[1] > 0.95 * moved[0] && moved[2] > 0.95 * moved[0],
        "{moved:?}"
    );
}

/// A ball of rapier's slides along a floor into a wall, under rapier's own continuous detection: how far
/// it gets.
fn slides_to(ground: ColliderBuilder, speed: Real, from: Real) -> Real {
    let mut world = PhysicsWorld::new();
    let _pipeline = attached(&mut world);
    world.insert_collider(ground.friction(0.0), None);
    let body = RigidBodyBuilder::dynamic()
        .translation(Vector::new(from, WALL + RADIUS, 0.0))
        .linvel(Vector::X * speed)
        .ccd_enabled(true);
    let (ball, _) = world.insert(body, ColliderBuilder::ball(RADIUS).friction(0.0));
    let mut farthest = from;
    for _ in 0..60 {
        world.step();
        farthest = farthest.max(world.bodies[ball].translation().x);
    }
    farthest
}

#[test]
fn a_sliding_ball_gets_no_deeper_into_a_medial_wall_than_into_rapiers() {
    // Slower, and rapier does not take the ball for fast.
    for k in 0..24 {
        let (speed, from) = (9.0 + 3.0 * k as Real, -2.0 + 0.03 * k as Real);
        let grounds = [Room::corner().rapiers(), Room::corner().medial()];
        let deep = grounds.map(|g| slides_to(g, speed, from) - (1.0 - WALL - RADIUS));
        // rapier's slop of 5 mm is its own measure of touching.
        assert!(deep[1] < deep[0].max(0.005), "{speed}: {deep:?}");
        assert!(deep[1] > -0.01, "{speed}: it stops at {}", deep[1]);
    }
}

/// Characters that are moved down by 3 cm with each step of 5 cm walk 5 m over a flat floor whose collider is turned by
/// a quarter about any axis, by half a radian, or not, where the floor or the character is medial. On rapier's own
/// floors they lose some of it (`tests/host/main.rs`), because rapier's controller takes a normal that is shorter than
/// 1 by rounding for that of a slope.
#[test]
fn flat_floors_turned_by_a_quarter_are_walked_on() {
    let quarter = std::f32::consts::FRAC_PI_2;
    let turns = [
        Vector::X,
        Vector::Y,
        Vector::Z,
        Vector::NEG_X,
        Vector::NEG_Z,
    ];
    let turns = turns.map(|axis| axis * quarter);
    let controller = KinematicCharacterController::default();
    let floor = MedialMesh::cuboid(Vector::splat(20.0)).expect("a floor");
    let medial = SharedShape::new(MedialMesh::cuboid(Vector::new(0.2, 0.5, 0.2)).expect("a box"));
    let characters = [
        ("ball", SharedShape::ball(0.5), true),
        ("capsule", SharedShape::capsule_y(0.3, 0.2), true),
        ("cuboid", SharedShape::cuboid(0.2, 0.5, 0.2), true),
        ("cylinder", SharedShape::cylinder(0.5, 0.2), true),
        ("medial", medial.clone(), true),
        ("medial on a cuboid", medial, false),
    ];
    for turn in turns.into_iter().chain([Vector::ZERO, Vector::Y * 0.5]) {
        for (name, shape, on_medial) in &characters {
            let ground = match on_medial {
                true => ColliderBuilder::medial_mesh(floor.clone()),
                false => ColliderBuilder::cuboid(20.0, 20.0, 20.0),
            };
            let ground = ground.position(Pose::new(Vector::NEG_Y * 20.0, turn));
            let start = Vector::new(0.0, 0.511, 0.0);
            let wish = Vector::new(0.04, -0.03, 0.03);
            let end = walk(ground, &**shape, &controller, start, wish, 100, |_| 1.0).end;
            let way = Vector::new(end.x, 0.0, end.z).length();
            assert!((way - 5.0).abs() < 0.01, "{name}, {turn:?}: {way}, {end:?}");
        }
    }
}

/// How far a character gets of the 0.5 m that it means to go along `way`, and how far up: put `deep` into the front of
/// a wall of 2 m that stands on a floor.
fn leaves_wall(wall: &SharedShape, character: &SharedShape, deep: Real, way: Vector) -> [Real; 2] {
    let mut world = PhysicsWorld::new();
    let mut pipeline = attached(&mut world);
    let floor = ColliderBuilder::cuboid(10.0, 0.5, 10.0).translation(Vector::Y * -0.5);
    world.insert_collider(floor, None);
    let wall = ColliderBuilder::new(wall.clone()).translation(Vector::new(0.5, 1.0, 0.0));
    world.insert_collider(wall, None);
    pipeline.step(&mut world);
    let controller = KinematicCharacterController {
        offset: CharacterLength::Absolute(0.01),
        ..KinematicCharacterController::default()
    };
    let start = Vector::new(-0.2 + deep, 0.51, 0.1);
    let mut at = start;
    for _ in 0..20 {
        let queries = world.query_pipeline();
        let pose = Pose::from_translation(at);
        let wish = way * 0.025 + Vector::NEG_Y * 0.003;
        let moved = controller.move_shape(1.0 / 60.0, &queries, &*character.0, &pose, wish, |_| {});
        at += moved.translation;
    }
    [(at - start).dot(way), at.y - start.y]
}

/// Symptom: cuboids that were deeper in a medial wall than they stood above its lower edge could move nowhere. Cause:
/// each face of the cuboid was asked alone, and its lower one came nearer by any step upwards.
#[test]
fn characters_leave_walls_that_were_put_into_them() {
    let half = Vector::new(0.5, 1.0, 2.0);
    let medial = SharedShape::new(MedialMesh::cuboid(half).expect("a wall"));
    let own = SharedShape::cuboid(half.x, half.y, half.z);
    let characters = [
        SharedShape::cuboid(0.2, 0.5, 0.2),
        SharedShape::cylinder(0.5, 0.2),
        SharedShape::capsule_y(0.3, 0.2),
    ];
    for (k, character) in characters.iter().enumerate() {
        for deep in [0.01, 0.03, 0.1] {
            for way in [Vector::NEG_X, Vector::Z, Vector::X] {
                let [ours, own] = [&medial, &own].map(|w| leaves_wall(w, character, deep, way));
                let name = format!("character {k}, {deep} m deep, along {way:?}");
                assert!(
                    own[0] > 0.4 || way == Vector::X,
                    "rapier's own {name}: {own:?} m"
                );
                assert!(
                    (ours[0] - own[0]).abs() < 0.05,
                    "{name}: {ours:?} m, rapier's own {own:?} m"
                );
                assert!(
                    ours[1].abs() < 0.02,
                    "{name}: {ours:?} m, rapier's own {own:?} m"
                );
            }
        }
    }
}
