//! Closed loops thrown at each other from all sides: none may pass through another. The judge is the
//! linking number of their centre lines, which changes with every such passage.

use crate::bodies::*;
use crate::oracle::*;
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

pub type Loop = Vec<[f64; 3]>;

/// Centre line of a loop at a pose.
pub fn line(mesh: &MedialMesh, pose: &Pose) -> Loop {
    let world = |s: &MedialSphere| (*pose * s.center).to_array().map(f64::from);
    mesh.spheres().iter().map(world).collect()
}

/// Linking number of two polygons: half the signed crossings seen along a direction that no edge has.
pub fn linking(a: &Loop, b: &Loop) -> i32 {
    // A fixed rotation, so that no edge is seen end on.
    let seen = |p: &[f64; 3]| {
        let [x, y, z] = *p;
        [
            0.8 * x + 0.33 * y + 0.5 * z,
            -0.41 * x + 0.91 * y + 0.06 * z,
            -0.44 * x - 0.25 * y + 0.86 * z,
        ]
    };
    let edges = |l: &Loop| {
        let points: Vec<_> = l.iter().map(seen).collect();
        let next = |i: usize| points[(i + 1) % points.len()];
        (0..points.len())
            .map(|i| [points[i], next(i)])
            .collect::<Vec<_>>()
    };
    let mut sum = 0;
    for [p, q] in edges(a) {
        for [r, s] in edges(b) {
            let (d, e) = ([q[0] - p[0], q[1] - p[1]], [s[0] - r[0], s[1] - r[1]]);
            let cross = d[0] * e[1] - d[1] * e[0];
            let w = [r[0] - p[0], r[1] - p[1]];
            let (t, u) = (
                (w[0] * e[1] - w[1] * e[0]) / cross,
                (w[0] * d[1] - w[1] * d[0]) / cross,
            );
            if (0.0..1.0).contains(&t) && (0.0..1.0).contains(&u) {
                let above = p[2] + t * (q[2] - p[2]) > r[2] + u * (s[2] - r[2]);
                sum += if (cross > 0.0) == above { 1 } else { -1 };
            }
        }
    }
    sum / 2
}

/// What a heap did.
#[derive(Debug, Default)]
struct Findings {
    /// Pairs whose linking number differs from that at the start, over all steps.
    wrong_links: usize,
    /// Largest kinetic and potential energy, in units of that at the start.
    energy: Real,
    events: usize,
}

/// Throws loops together at `speed`, above a ground; `hooked`: with the pipeline, else rapier alone.
fn heap(shapes: &[MedialMesh], speed: Real, seed: u64, steps: usize, hooked: bool) -> Findings {
    let mut random = Random(seed);
    let mut world = world_with_ground();
    let mut pipeline = attached(&mut world);
    let mut bodies = Vec::new();
    for i in 0..12 {
        let mesh = &shapes[i % shapes.len()];
        // From a grid wide enough that none is linked, towards its middle.
        let cell = [i % 3, i / 3 % 2, i / 6].map(|k| k as Real);
        let place = Vector::new(
            1.6 * cell[0] - 1.6,
            2.0 + 1.6 * cell[1],
            1.6 * cell[2] - 0.8,
        );
        let turn = random.direction() * random.within(0.0, 3.0);
        let linvel = (Vector::new(0.0, 2.0, 0.0) - place).normalize_or_zero() * speed;
        let flight = Flight {
            pose: Pose::new(place, turn),
            linvel: linvel + random.direction() * 0.3 * speed,
            angvel: random.direction() * random.within(0.0, 20.0),
        };
        let collider = ColliderBuilder::medial_mesh(mesh.clone());
        let handle = world.insert(flight.body(), collider).0;
        world.bodies[handle].set_allow_fast_rotation(true);
        bodies.push((handle, mesh));
    }
    let energy = |world: &PhysicsWorld| -> Real {
        let of = |b: &RigidBody| b.kinetic_energy() + b.mass() * 9.81 * b.center_of_mass().y;
        world.bodies.iter().map(|(_, b)| of(b)).sum()
    };
    let mut findings = Findings::default();
    let mut first = None;
    for _ in 0..steps {
        if hooked {
            findings.events += pipeline.step(&mut world).events;
        } else {
            world.step();
        }
        let now = energy(&world);
        let first = *first.get_or_insert(now);
        findings.energy = findings.energy.max(now / first);
        let lines: Vec<_> = bodies
            .iter()
            .map(|(h, m)| line(m, world.bodies[*h].position()))
            .collect();
        for j in 1..lines.len() {
            findings.wrong_links += (0..j)
                .filter(|&i| linking(&lines[i], &lines[j]) != 0)
                .count();
        }
    }
    findings
}

/// Links as in `fast_pairs`, and rings, of a size.
fn loops() -> [MedialMesh; 2] {
    [ring(12, 0.4, 0.08), crate::fast_pairs::link()]
}

#[test]
fn violent_heaps_of_loops_stay_unlinked() {
    for (seed, speed) in [(501, 20.0), (502, 20.0), (503, 60.0), (504, 60.0)] {
        let found = heap(&loops(), speed, seed, 100, true);
        println!("{speed} m/s, seed {seed}: {found:?}");
        assert!(found.events > 10, "{speed} m/s, seed {seed}: {found:?}");
        assert_eq!(found.wrong_links, 0, "{speed} m/s, seed {seed}");
        assert!(found.energy < 1.005, "{speed} m/s, seed {seed}: {found:?}");
    }
}

#[test]
fn the_same_heaps_get_linked_in_rapier() {
    let wrong = heap(&loops(), 60.0, 503, 100, false).wrong_links;
    assert!(wrong > 0, "the heaps above prove nothing");
}

/// Two linked rings, each thrown away from the other.
#[test]
fn linked_rings_pulled_apart_stay_linked() {
    for phase in 0..16 {
        let mesh = ring(27, MAJOR, MINOR);
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let mut pipeline = attached(&mut world);
        let mut throw = |x: Real, turn: Real, speed: Real| {
            let pose = Pose::new(Vector::new(x, 0.0, 0.0), Vector::new(turn, 0.0, 0.0));
            let body = RigidBodyBuilder::dynamic()
                .pose(pose)
                .linvel(Vector::new(speed, 0.0, 0.0));
            world
                .insert(body, ColliderBuilder::medial_mesh(mesh.clone()))
                .0
        };
        let shift = 0.02 * phase as Real;
        let handles = [
            throw(-0.25 - shift, 0.1, -25.0),
            throw(0.25, 1.4 + 0.02 * phase as Real, 25.0),
        ];
        let linked = |world: &PhysicsWorld| {
            let [a, b] = handles.map(|h| line(&mesh, world.bodies[h].position()));
            linking(&a, &b).abs()
        };
        assert_eq!(linked(&world), 1, "phase {phase}: not linked at the start");
        for step in 0..60 {
            pipeline.step(&mut world);
            assert_eq!(linked(&world), 1, "phase {phase}, step {step}");
        }
    }
}
