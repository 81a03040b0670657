//! Heaps of rings of thin wire, or of wire without any thickness. The judge is the linking number of their centre
//! lines.

use super::bodies::*;
use super::linking::{line, linking};
use super::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

const RINGS: u32 = 10;
const PARTS: u32 = 16;

/// How a heap is made.
pub struct Heap {
    /// Radius of the wire, a length.
    pub radius: Real,
    /// Mass of a ring.
    pub mass: Real,
    /// Whether a heavy plate falls on it.
    pub plate: bool,
    /// Of rapier's capsules instead of medial rings.
    pub capsules: bool,
    pub seed: u64,
}

/// What it did.
#[derive(Debug)]
#[allow(dead_code, reason = "printed")]
pub struct Outcome {
    /// Largest number of pairs linked at the end of a step; none is at the start.
    pub linked: usize,
    /// Steps in which a body was held.
    pub held: usize,
    /// Distance of the farthest body from the middle of the ground at the end.
    pub farthest: Real,
    /// Speed of the fastest body at the end.
    pub speed: Real,
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
    /// Ten rings of radius 0 and of 20 g.
    pub fn of_no_thickness(seed: u64) -> Heap {
        Heap {
            radius: 0.0,
            mass: 0.02,
            plate: false,
            capsules: false,
            seed,
        }
    }

    /// What it did in `steps` steps.
    pub fn fall(&self, steps: usize) -> Outcome {
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
        let distances = world.bodies.iter().map(|(_, b)| b.translation().length());
        Outcome {
            farthest: distances.fold(0.0, Real::max),
            linked,
            held,
            speed: speeds.fold(0.0, Real::max),
        }
    }
}
