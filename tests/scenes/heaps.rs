//! Closed loops thrown at each other from all sides: none may pass through another. The judge is the
//! linking number of their centre lines, which changes with every such passage.

use crate::bodies::*;
use crate::linking::{line, linking};
use crate::oracle::*;
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// What a heap did.
#[derive(Debug, Default)]
pub struct Findings {
    /// Pairs of closed loops whose linking number differs from that at the start, over all steps.
    pub wrong_links: usize,
    /// Largest depth at the end of a step, in units of the radii of both: at 1 the medial axes touch.
    pub depth: Real,
    /// Largest kinetic and potential energy, in units of that at the start.
    pub energy: Real,
    pub events: usize,
    /// Energy at the first look.
    first: Option<Real>,
}

impl Findings {
    /// Looks at a heap after a step.
    pub fn look(&mut self, world: &PhysicsWorld, bodies: &Thrown) {
        let now = energy(world);
        let first = *self.first.get_or_insert(now);
        self.energy = self.energy.max(now / first);
        self.depth = self.depth.max(deepest(world, bodies));
        let lines: Vec<_> = bodies
            .iter()
            .filter(|(_, m)| is_loop(m))
            .map(|(h, m)| line(m, world.bodies[*h].position()))
            .collect();
        for j in 1..lines.len() {
            self.wrong_links += (0..j)
                .filter(|&i| linking(&lines[i], &lines[j]) != 0)
                .count();
        }
    }
}

/// Bodies of a heap, and the mesh of each.
pub type Thrown<'a> = Vec<(RigidBodyHandle, &'a MedialMesh)>;

/// A world with a ground over which bodies fly from a grid, wide enough that none is linked, towards its
/// middle at `speed`.
pub fn throw(
    shapes: &[MedialMesh],
    grid: [usize; 3],
    speed: Real,
    seed: u64,
    collider: impl Fn(&MedialMesh) -> ColliderBuilder,
) -> (PhysicsWorld, Thrown<'_>) {
    let mut random = Random(seed);
    let mut world = world_with_ground();
    let mut bodies = Vec::new();
    for i in 0..grid.iter().product() {
        let mesh = &shapes[i % shapes.len()];
        let cell = [i % grid[0], i / grid[0] % grid[1], i / (grid[0] * grid[1])];
        let at = [0, 2].map(|k| 1.6 * cell[k] as Real - 0.8 * (grid[k] - 1) as Real);
        let place = Vector::new(at[0], 2.0 + 1.6 * cell[1] as Real, at[1]);
        let turn = random.direction() * random.within(0.0, 3.0);
        let linvel = (Vector::new(0.0, 2.0, 0.0) - place).normalize_or_zero() * speed;
        let flight = Flight {
            pose: Pose::new(place, turn),
            linvel: linvel + random.direction() * 0.3 * speed,
            angvel: random.direction() * random.within(0.0, 20.0),
        };
        let handle = world.insert(flight.body(), collider(mesh)).0;
        world.bodies[handle].set_allow_fast_rotation(true);
        bodies.push((handle, mesh));
    }
    (world, bodies)
}

/// Kinetic and potential energy.
fn energy(world: &PhysicsWorld) -> Real {
    let of = |b: &RigidBody| b.kinetic_energy() + b.mass() * 9.81 * b.center_of_mass().y;
    world.bodies.iter().map(|(_, b)| of(b)).sum()
}

fn is_loop(mesh: &MedialMesh) -> bool {
    mesh.faces().is_empty() && mesh.edges().len() == mesh.spheres().len()
}

/// Depth of the deepest two edges of different bodies, in units of their radii there.
fn deepest(world: &PhysicsWorld, bodies: &Thrown) -> Real {
    use rapier3d::parry::query::details::closest_points_segment_segment_with_locations;
    let edges: Vec<Vec<_>> = bodies
        .iter()
        .map(|(h, mesh)| {
            let pose = world.bodies[*h].position();
            let ends = |e: &[u32; 2]| e.map(|i| mesh.spheres()[i as usize]);
            let edge = |[a, b]: [MedialSphere; 2]| {
                let line = Segment::new(*pose * a.center, *pose * b.center);
                (line, [a.radius, b.radius])
            };
            mesh.edges().iter().map(|e| edge(ends(e))).collect()
        })
        .collect();
    let at = |h: RigidBodyHandle| world.bodies[h].translation();
    let mut deepest: Real = 0.0;
    for j in 1..bodies.len() {
        for i in (0..j).filter(|&i| at(bodies[i].0).distance(at(bodies[j].0)) < 1.6) {
            for (p, r) in &edges[i] {
                for (q, s) in &edges[j] {
                    let (a, b) =
                        closest_points_segment_segment_with_locations(&Pose::IDENTITY, p, q);
                    let radius = |at: &SegmentPointLocation, r: &[Real; 2]| {
                        let [x, y] = at.barycentric_coordinates();
                        x * r[0] + y * r[1]
                    };
                    let radii = radius(&a, r) + radius(&b, s);
                    let apart = p.point_at(&a).distance(q.point_at(&b));
                    deepest = deepest.max(1.0 - apart / radii);
                }
            }
        }
    }
    deepest
}

/// Throws bodies together; `hooked`: with the pipeline, else rapier alone.
pub fn heap(
    shapes: &[MedialMesh],
    grid: [usize; 3],
    speed: Real,
    seed: u64,
    steps: usize,
    hooked: bool,
) -> Findings {
    let medial = |mesh: &MedialMesh| ColliderBuilder::medial_mesh(mesh.clone());
    let (world, bodies) = throw(shapes, grid, speed, seed, medial);
    watch(world, &bodies, steps, hooked)
}

/// Steps a heap; `hooked`: with the pipeline, else rapier alone.
pub fn watch(mut world: PhysicsWorld, bodies: &Thrown, steps: usize, hooked: bool) -> Findings {
    let mut pipeline = attached(&mut world);
    let mut findings = Findings::default();
    for _ in 0..steps {
        if hooked {
            findings.events += pipeline.step(&mut world).events;
        } else {
            world.step();
        }
        findings.look(&world, bodies);
    }
    findings
}

/// Grid of the quick tests.
const SMALL: [usize; 3] = [3, 2, 2];

/// Links as in `fast_pairs`, and rings, of a size.
pub fn loops() -> [MedialMesh; 2] {
    [ring(12, 0.4, 0.08), crate::fast_pairs::link()]
}

#[test]
fn violent_heaps_of_loops_stay_unlinked() {
    for (seed, speed) in [(501, 20.0), (502, 20.0), (503, 60.0), (504, 60.0)] {
        let found = heap(&loops(), SMALL, speed, seed, 100, true);
        println!("{speed} m/s, seed {seed}: {found:?}");
        assert!(found.events > 10, "{speed} m/s, seed {seed}: {found:?}");
        assert_eq!(found.wrong_links, 0, "{speed} m/s, seed {seed}");
        assert!(found.energy < 1.005, "{speed} m/s, seed {seed}: {found:?}");
    }
}

/// Restitution by Newton's law and friction by Coulomb's, each right for itself, can together gain energy
/// in an impact off the centres: these heaps flew apart with 1e16 and more times their energy.
///
/// Without gyroscopic forces: rapier's integration of them gains energy in free flight.
#[test]
fn elastic_heaps_gain_no_energy() {
    for seed in [8468, 8472] {
        let shapes = loops();
        let elastic = |m: &MedialMesh| ColliderBuilder::medial_mesh(m.clone()).restitution(0.9);
        let (mut world, _) = throw(&shapes, [3, 3, 3], 150.0, seed, elastic);
        for (_, body) in world.bodies.iter_mut() {
            body.enable_gyroscopic_forces(false);
        }
        let mut pipeline = attached(&mut world);
        let start = energy(&world);
        let mut events = 0;
        for step in 0..40 {
            events += pipeline.step(&mut world).events;
            let share = energy(&world) / start;
            assert!(share < 1.001, "seed {seed}, step {step}: {share}");
        }
        assert!(events > 100, "{events}");
    }
}

#[test]
fn the_same_heaps_get_linked_in_rapier() {
    let wrong = heap(&loops(), SMALL, 60.0, 503, 100, false).wrong_links;
    assert!(wrong > 0, "the heaps above prove nothing");
}

/// Two linked rings, each thrown away from the other.
#[test]
fn linked_rings_pulled_apart_stay_linked() {
    for case in 0..32 {
        let (phase, speed) = (case % 16, if case < 16 { 25.0 } else { 50.0 });
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
            throw(-0.25 - shift, 0.1, -speed),
            throw(0.25, 1.4 + 0.02 * phase as Real, speed),
        ];
        let linked = |world: &PhysicsWorld| {
            let [a, b] = handles.map(|h| line(&mesh, world.bodies[h].position()));
            linking(&a, &b).abs()
        };
        assert_eq!(
            linked(&world),
            1,
            "{speed} m/s, phase {phase}: not linked at the start"
        );
        for step in 0..60 {
            pipeline.step(&mut world);
            assert_eq!(linked(&world), 1, "{speed} m/s, phase {phase}, step {step}");
        }
    }
}
