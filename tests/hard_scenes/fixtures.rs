//! Fixtures on which the field tests contact: chain nets, spikes and wedges that meet tip to tip (Erleben), a wheel on
//! its axle. Nothing passes, nothing gains energy, and all comes to rest that must.

use crate::combs::Dropped;
use crate::linking::{line, linking};
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Distance of the net's rings, and their radii, metres.
const SPACING: Real = 1.5;
const RING: [Real; 2] = [0.5, 0.08];

/// A net of `rows` × `columns` flat rings and the upright ones that join neighbours, held at its four corners.
struct Net {
    world: PhysicsWorld,
    rings: Vec<RigidBodyHandle>,
    mesh: MedialMesh,
    /// Rings that are linked, by the linking number of their middle lines.
    linked: Vec<([usize; 2], i32)>,
}

impl Net {
    fn new(rows: usize, columns: usize) -> Self {
        let mesh = MedialMesh::torus(RING[0], RING[1], 16).expect("a ring");
        let mut world = PhysicsWorld::new();
        world.integration_parameters.dt = 0.01;
        let mut rings = Vec::new();
        let mut put = |at: [Real; 2], turn: Vector, held: bool| {
            let body = if held {
                RigidBodyBuilder::fixed()
            } else {
                RigidBodyBuilder::dynamic()
            };
            let at = Vector::new(at[0], 0.0, at[1]) * SPACING;
            let body = body.translation(at).rotation(turn);
            let collider = ColliderBuilder::medial_mesh(mesh.clone()).friction(0.2);
            rings.push(world.insert(body, collider).0);
            rings.len() - 1
        };
        let quarter = std::f32::consts::FRAC_PI_2;
        let mut pairs = Vec::new();
        let mut flat = Vec::new();
        for i in 0..rows {
            for j in 0..columns {
                let held = (i == 0 || i == rows - 1) && (j == 0 || j == columns - 1);
                flat.push(put([i as Real, j as Real], Vector::ZERO, held));
            }
        }
        for i in 0..rows {
            for j in 0..columns {
                let own = flat[i * columns + j];
                if i + 1 < rows {
                    let joins = put([i as Real + 0.5, j as Real], Vector::X * quarter, false);
                    pairs.extend([[own, joins], [joins, flat[(i + 1) * columns + j]]]);
                }
                if j + 1 < columns {
                    let joins = put([i as Real, j as Real + 0.5], Vector::Z * quarter, false);
                    pairs.extend([[own, joins], [joins, flat[i * columns + j + 1]]]);
                }
            }
        }
        let mut net = Self {
            world,
            rings,
            mesh,
            linked: Vec::new(),
        };
        net.linked = pairs.into_iter().map(|p| (p, net.number(p))).collect();
        assert!(net.linked.iter().all(|(_, number)| number.abs() == 1));
        net
    }

    fn number(&self, pair: [usize; 2]) -> i32 {
        let [a, b] = pair.map(|k| line(&self.mesh, self.world.bodies[self.rings[k]].position()));
        linking(&a, &b)
    }

    /// How many pairs are linked otherwise than at the start, of neighbours and of rings near each other.
    fn changed(&self) -> usize {
        let lost = self
            .linked
            .iter()
            .filter(|(pair, n)| self.number(*pair) != *n);
        let mut changed = lost.count();
        let at = |k: usize| self.world.bodies[self.rings[k]].translation();
        for a in 0..self.rings.len() {
            for b in 0..a {
                if at(a).distance(at(b)) < 2.2 * RING[0] {
                    let is_pair = |p: &[usize; 2]| *p == [a, b] || *p == [b, a];
                    let known = self.linked.iter().any(|(p, _)| is_pair(p));
                    changed += usize::from(!known && self.number([a, b]) != 0);
                }
            }
        }
        changed
    }

    /// Heavy loads hang on the first links: rapier's contacts, made stiff enough for them.
    fn with_stiff_contacts(mut self) -> Self {
        let parameters = &mut self.world.integration_parameters;
        parameters.contact_softness.natural_frequency = 120.0;
        parameters.num_solver_iterations = 12;
        self
    }

    fn run(&mut self, steps: usize) -> Ran {
        let mut pipeline = MedialPipeline::default();
        let mut ran = Ran::default();
        let clock = cpu_time::ProcessTime::now();
        for _ in 0..steps {
            ran.frozen += pipeline.step(&mut self.world).frozen;
            let speeds = self.world.bodies.iter().map(|(_, b)| b.linvel().length());
            ran.fastest = speeds.fold(ran.fastest, Real::max);
        }
        ran.milliseconds = 1.0e3 * clock.elapsed().as_secs_f64() / steps as f64;
        ran.changed = self.changed();
        ran
    }

    /// Runs so many hundreds of steps; no link may change in any of them.
    fn stays_linked(&mut self, hundreds: usize) {
        let rings = self.rings.len();
        for k in 1..=hundreds {
            let ran = self.run(100);
            println!("net of {rings} rings, step {k}00: {ran:?}");
            assert_eq!(ran.changed, 0);
        }
    }
}

/// What came of some steps.
#[derive(Debug, Default)]
struct Ran {
    /// Links that changed since the start.
    changed: usize,
    /// Speed of the fastest ring, m/s.
    fastest: Real,
    /// Bodies stopped after too many impacts, summed over the steps.
    frozen: usize,
    /// CPU time of a step.
    milliseconds: f64,
}

/// 153 rings: no link changes, and nothing is faster than by falling through the net's depth.
#[test]
fn a_chain_net_stays_linked() {
    let mut net = Net::new(7, 8);
    let ran = net.run(200);
    println!("net of {} rings: {ran:?}", net.rings.len());
    assert_eq!(ran.changed, 0);
    assert!(ran.fastest < 15.0, "{} m/s", ran.fastest);
}

/// The corners carry some 700 rings each: rapier's contacts are stiffer and its iterations more than by default.
#[test]
#[ignore = "minutes: 2,913 rings over 1,000 steps, for docs/measurements/hard-scenes.md"]
fn a_large_chain_net_stays_linked() {
    Net::new(31, 32).with_stiff_contacts().stays_linked(10);
}

/// The same with rapier's default contacts: what the solver does not hold, impacts hold, one pair after another.
#[test]
#[ignore = "an hour: 2,913 rings over 1,000 steps, for docs/measurements/hard-scenes.md"]
fn a_large_chain_net_of_soft_contacts_stays_linked() {
    Net::new(31, 32).stays_linked(10);
}

/// Spikes and wedges fall on others, tip on tip, edge on edge, across, and between each other. Edges of radius 0 that
/// cross are in `known_issues`: they do not rest.
#[test]
fn spikes_and_wedges_come_to_rest_on_each_other() {
    for is_wedge in [false, true] {
        for aside in [0.0, 0.02, 0.1] {
            for across in [false, true] {
                let end = Dropped::comb(is_wedge, aside, across);
                let name = format!("wedges {is_wedge}, {aside} m aside, across {across}: {end:?}");
                println!("{name}");
                // From 1.3 m down to the ground it is 5.2 m/s.
                assert!(end.fastest < 5.5, "{name}");
                // Plates and ground are 0.1 thick on either side.
                assert!(end.lowest > -0.01, "{name}");
                let crossed = is_wedge && across;
                assert!(end.asleep || crossed && end.speed < 0.2, "{name}");
            }
        }
    }
}

/// A wheel, a torus with spokes round its hub, hangs loosely on a fixed axle, is struck, and comes to hang again.
#[test]
fn a_wheel_stays_on_its_axle() {
    let mut world = PhysicsWorld::new();
    let axle = [-0.5, 0.5].map(|x| MedialSphere::new(Vector::X * x, 0.08));
    let flange = |x: Real| {
        let rim = |k: u32| {
            let (sin, cos) = (k as Real / 12.0 * std::f32::consts::TAU).sin_cos();
            MedialSphere::new(Vector::new(x, 0.25 * cos, 0.25 * sin), 0.06)
        };
        MedialMesh::tube(&(0..12).map(rim).collect::<Vec<_>>(), true).expect("a flange")
    };
    let fixed = |mesh: MedialMesh| ColliderBuilder::medial_mesh(mesh).friction(0.3);
    world.insert_collider(
        fixed(MedialMesh::tube(&axle, false).expect("an axle")),
        None,
    );
    for x in [-0.4, 0.4] {
        world.insert_collider(fixed(flange(x)), None);
    }
    // Its hub is a ring of 0.1 m round the axle, its middle 0.02 m below.
    let ring = |radius: Real, thickness: Real, first: u32| {
        let at = move |k: u32| {
            let (sin, cos) = (k as Real / 24.0 * std::f32::consts::TAU).sin_cos();
            MedialSphere::new(Vector::new(0.0, radius * cos, radius * sin), thickness)
        };
        let spheres: Vec<_> = (0..24).map(at).collect();
        let edges: Vec<[u32; 2]> = (0..24).map(|k| [first + k, first + (k + 1) % 24]).collect();
        (spheres, edges)
    };
    let (mut spheres, mut edges) = ring(0.16, 0.06, 0);
    let (rim, around) = ring(0.6, 0.06, 24);
    spheres.extend(rim);
    edges.extend(around);
    edges.extend((0..6).map(|k| [4 * k, 24 + 4 * k]));
    let wheel = MedialMesh::new(spheres, edges, vec![]).expect("a wheel");
    let body = RigidBodyBuilder::dynamic()
        .translation(Vector::Y * -0.01)
        .angvel(Vector::X * 10.0);
    let (wheel, _) = world.insert(body, fixed(wheel).density(500.0));
    let mut pipeline = MedialPipeline::default();
    for step in 0..600 {
        if step == 120 {
            world.bodies[wheel].set_linvel(Vector::new(4.0, 20.0, 3.0), true);
        }
        pipeline.step(&mut world);
        let body = &world.bodies[wheel];
        let at = body.translation();
        assert!(at.x.abs() < 0.4, "step {step}: at {at}");
        assert!(at.y.hypot(at.z) < 0.1, "step {step}: at {at}");
        assert!(
            body.linvel().length() < 25.0,
            "step {step}: {}",
            body.linvel()
        );
    }
    let end = &world.bodies[wheel];
    println!(
        "wheel: ends at {:.3} with {:.3} m/s and {:.3} rad/s, asleep {}",
        end.translation(),
        end.linvel().length(),
        end.angvel().length(),
        end.is_sleeping()
    );
}
