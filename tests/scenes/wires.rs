//! Heaps of rings of thin wire, or of wire without any thickness: no ring gets through another, and what is held
//! because it has too many impacts gains no speed by its weight. The judge is the linking number of their centre
//! lines.

use crate::bodies::*;
use crate::heaps::{line, linking};
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

const RINGS: u32 = 10;
const PARTS: u32 = 16;

/// How a heap is made.
struct Heap {
    /// Radius of the wire, a length.
    radius: Real,
    /// Mass of a ring.
    mass: Real,
    /// Whether a heavy plate falls on it.
    plate: bool,
    /// Of rapier's capsules instead of medial rings.
    capsules: bool,
    seed: u64,
}

/// What it did.
#[derive(Debug)]
#[allow(dead_code, reason = "printed")]
struct Outcome {
    /// Largest number of pairs linked at the end of a step; none is at the start.
    linked: usize,
    /// Steps in which a body was held.
    held: usize,
    /// Speed of the fastest body at the end.
    speed: Real,
}

fn plate(capsules: bool) -> ColliderBuilder {
    let (half, radius) = (0.6, 0.02);
    if capsules {
        return ColliderBuilder::cuboid(half, radius, half).density(200.0);
    }
    let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
    let spheres = corners.map(|(x, z)| MedialSphere::new(Vector::new(x, 0.0, z), radius));
    let faces = vec![[0, 1, 2], [0, 2, 3]];
    let mesh = MedialMesh::new(spheres.to_vec(), vec![], faces).expect("a plate");
    let mass = SharedShape::cuboid(half, radius, half).mass_properties(200.0);
    ColliderBuilder::medial_mesh(mesh.with_mass_properties(mass))
}

impl Heap {
    fn fall(&self, steps: usize) -> Outcome {
        let mut random = Random(90 + self.seed);
        let mut world = world_with_ground();
        let inertia = Vector::new(0.02, 0.04, 0.02) * self.mass;
        let mass = MassProperties::new(Vector::ZERO, self.mass, inertia);
        let mesh = ring(PARTS, 0.2, self.radius).with_mass_properties(mass);
        let collider = || {
            if !self.capsules {
                return ColliderBuilder::medial_mesh(mesh.clone());
            }
            let end = |k: usize| mesh.spheres()[k % PARTS as usize].center;
            let part = |k| SharedShape::capsule(end(k), end(k + 1), self.radius);
            let parts = (0..PARTS as usize).map(|k| (Pose::IDENTITY, part(k)));
            ColliderBuilder::compound(parts.collect()).mass_properties(mass)
        };
        let mut aside = |k: u32| {
            let [x, z] = [0, 1].map(|_| random.within(-0.1, 0.1));
            let turn = random.direction() * random.within(0.0, 3.0);
            Pose::new(Vector::new(x, 0.3 + 0.45 * k as Real, z), turn)
        };
        let rings: Vec<_> = (0..RINGS)
            .map(|k| {
                let body = RigidBodyBuilder::dynamic().pose(aside(k));
                world.insert(body, collider()).0
            })
            .collect();
        if self.plate {
            let body = RigidBodyBuilder::dynamic().translation(Vector::Y * 5.5);
            world.insert(body, plate(self.capsules));
        }
        let mut pipeline = attached(&mut world);
        let (mut linked, mut held) = (0, 0);
        for _ in 0..steps {
            held += usize::from(pipeline.step(&mut world).frozen > 0);
            let lines = rings
                .iter()
                .map(|h| line(&mesh, world.bodies[*h].position()));
            let lines: Vec<_> = lines.collect();
            let with = |j: usize| {
                (0..j)
                    .filter(|&i| linking(&lines[i], &lines[j]) != 0)
                    .count()
            };
            linked = linked.max((1..lines.len()).map(with).sum());
        }
        let speeds = world.bodies.iter().map(|(_, b)| b.linvel().length());
        Outcome {
            linked,
            held,
            speed: speeds.fold(0.0, Real::max),
        }
    }
}

/// Symptom: rings of radius 0 got linked, in 3 heaps of 6. Cause: what is pressed on and on came nearer to the axes
/// than the rounding of poses. And a ring that was held in every step fell at 3 m/s in the end without moving: it kept
/// the speed that its weight gave it.
#[test]
fn rings_of_no_thickness_stay_unlinked() {
    for (seed, steps) in [(2, 200), (3, 170)] {
        let heap = Heap {
            radius: 0.0,
            mass: 0.02,
            plate: false,
            capsules: false,
            seed,
        };
        let found = heap.fall(steps);
        assert_eq!(found.linked, 0, "seed {seed}: {found:?}");
        assert!(found.speed < 0.5, "seed {seed}: {found:?}");
    }
}

/// Known: of twelve heaps (seeds 0 to 11) one ends with two pairs linked, from its step 108 on. The cause is not found.
#[test]
#[ignore = "fails: two pairs of rings get linked"]
fn every_heap_of_rings_of_no_thickness_stays_unlinked() {
    let linked = |seed| {
        let heap = Heap {
            radius: 0.0,
            mass: 0.02,
            plate: false,
            capsules: false,
            seed,
        };
        heap.fall(200).linked
    };
    assert_eq!((0..12).map(linked).collect::<Vec<_>>(), [0; 12]);
}

/// Under a plate a thousand times as heavy as all of them, where rapier's capsules are pressed through each other.
#[test]
#[ignore = "minutes"]
fn rings_of_thin_wire_under_a_plate() {
    for capsules in [true, false] {
        for seed in 0..3 {
            let heap = Heap {
                radius: 0.002,
                mass: 1.6e-5,
                plate: true,
                capsules,
                seed,
            };
            let found = heap.fall(200);
            println!("capsules: {capsules}, seed {seed}: {found:?}");
            assert!(
                capsules || found.linked == 0 && found.speed < 0.5,
                "{found:?}"
            );
        }
    }
}
