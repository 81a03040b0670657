//! The league's scenes: made here from seeds, written to one JSON file, and read from it by every engine.
//!
//! Metres, kilograms, seconds; y points up; rotations are quaternions x, y, z, w. Bodies turn about principal axes at
//! the start, so that their paths do not depend on whether an engine computes gyroscopic forces.

use crate::circles::{Curve, Pose, distance};
use crate::common::random::Random;
use rapier3d::math::{Rotation, Vector};
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// Radii of the rings' middle circle and tube, and capsules of a ring.
pub const RING: [f64; 2] = [0.5, 0.06];
const CAPSULES: usize = 24;
/// Half the length of a rod's middle line; its radius is that of the rings' tube.
const ROD: f64 = 1.0;
/// Half the side of a cube.
const CUBE: f64 = 0.25;
/// Indices into the list of shapes.
const A_RING: usize = 0;
const A_ROD: usize = 1;
const A_CUBE: usize = 2;

/// What a body consists of: capsules (two ends and a radius) or a box, given by half its sides.
#[derive(Serialize, Deserialize)]
pub struct Shape {
    pub capsules: Vec<[f64; 7]>,
    pub half: Option<[f64; 3]>,
    pub mass: f64,
    pub inertia: [f64; 3],
}

#[derive(Serialize, Deserialize)]
pub struct Body {
    pub shape: usize,
    pub position: [f64; 3],
    pub rotation: [f64; 4],
    pub velocity: [f64; 3],
    pub spin: [f64; 3],
}

/// A fixed box.
#[derive(Serialize, Deserialize)]
pub struct Wall {
    pub center: [f64; 3],
    pub half: [f64; 3],
}

#[derive(Serialize, Deserialize)]
pub struct World {
    pub scene: String,
    pub dt: f64,
    pub steps: usize,
    /// A state is recorded after each so many steps.
    pub every: usize,
    pub gravity: f64,
    pub friction: f64,
    pub restitution: f64,
    /// Half the sides of the room inside the walls; 0 where there are none.
    pub room: [f64; 3],
    pub walls: Vec<Wall>,
    pub bodies: Vec<Body>,
    /// Whether the two bodies of a flight meet.
    pub meets: bool,
}

#[derive(Serialize, Deserialize)]
pub struct League {
    pub shapes: Vec<Shape>,
    pub worlds: Vec<World>,
}

impl League {
    /// All scenes, or a few flights and short runs of the others.
    pub fn new(is_quick: bool) -> Self {
        let mut worlds = Vec::new();
        let (flights, seeds) = if is_quick { (3, 1) } else { (100, 3) };
        for (name, shape) in [("rings", A_RING), ("rod", A_ROD)] {
            for speed in [10.0, 60.0, 200.0] {
                let mut random = Random(shape as u64 * 1000 + speed as u64);
                for meets in [true, false] {
                    let fly =
                        || flight(&format!("{name} {speed}"), shape, speed, meets, &mut random);
                    worlds.extend(std::iter::repeat_with(fly).take(flights));
                }
            }
        }
        for seed in 0..seeds {
            for speed in [20.0, 60.0] {
                worlds.push(thrown(&format!("heap {speed}"), speed, 1, 36, seed));
                worlds.push(thrown(&format!("pairs {speed}"), speed, 2, 24, seed));
            }
            for hertz in [60.0, 240.0] {
                worlds.push(elastic(&format!("elastic {hertz}"), hertz, seed));
            }
        }
        worlds.push(rest());
        if is_quick {
            for world in &mut worlds {
                world.steps = world.steps.min(60);
                world.every = world.every.min(world.steps);
            }
        }
        let shapes = vec![ring(), rod(), cube()];
        Self { shapes, worlds }
    }
}

fn ring() -> Shape {
    let [big, small] = RING;
    let at = |k: usize| {
        let (sin, cos) = (TAU * k as f64 / CAPSULES as f64).sin_cos();
        [big * cos, 0.0, big * sin]
    };
    let capsule = |k| {
        let ([a, b, c], [d, e, f]) = (at(k), at((k + 1) % CAPSULES));
        [a, b, c, d, e, f, small]
    };
    // A true torus of 1 kg.
    let across = 0.5 * big * big + 0.625 * small * small;
    let about = big * big + 0.75 * small * small;
    Shape {
        capsules: (0..CAPSULES).map(capsule).collect(),
        half: None,
        mass: 1.0,
        inertia: [across, about, across],
    }
}

fn rod() -> Shape {
    let radius = RING[1];
    let across = (3.0 * radius * radius + (2.0 * ROD).powi(2)) / 12.0;
    Shape {
        capsules: vec![[0.0, -ROD, 0.0, 0.0, ROD, 0.0, radius]],
        half: None,
        mass: 1.0,
        inertia: [across, 0.5 * radius * radius, across],
    }
}

fn cube() -> Shape {
    Shape {
        capsules: Vec::new(),
        half: Some([CUBE; 3]),
        mass: 1.0,
        inertia: [2.0 / 3.0 * CUBE * CUBE; 3],
    }
}

fn wide(v: Vector) -> [f64; 3] {
    v.to_array().map(f64::from)
}

/// The curve in the middle of a shape's body frame.
fn middle(shape: usize) -> Curve {
    match shape {
        A_RING => Curve::Circle(RING[0]),
        _ => Curve::Segment(ROD),
    }
}

/// A body turned at random that spins about a principal axis, by at most so many rad/s.
fn body(random: &mut Random, shape: usize, at: Vector, velocity: Vector, spin: f32) -> Body {
    let turn = Rotation::from_scaled_axis(random.direction() * random.between(0.0, 3.0));
    let angle = random.between(0.0, TAU as f32);
    let axis = match (shape, random.between(0.0, 1.0) < 0.5) {
        (A_RING, true) => Vector::Y,
        _ => Vector::new(angle.cos(), 0.0, angle.sin()),
    };
    Body {
        shape,
        position: wide(at),
        rotation: turn.to_array().map(f64::from),
        velocity: wide(velocity),
        spin: wide(turn * axis * random.between(0.0, spin)),
    }
}

fn empty(scene: &str, hertz: f64, steps: usize) -> World {
    World {
        scene: scene.to_string(),
        dt: 1.0 / hertz,
        steps,
        every: 1,
        gravity: 0.0,
        friction: 0.3,
        restitution: 0.0,
        room: [0.0; 3],
        walls: Vec::new(),
        bodies: Vec::new(),
        meets: false,
    }
}

/// A ring and another body without weight that approach each other at a speed, and surely meet or clearly pass: tubes
/// of three quarters the radius would meet too, or there are 3 to 28 cm between the bodies.
fn flight(scene: &str, shape: usize, speed: f64, meets: bool, random: &mut Random) -> World {
    let radius = RING[1];
    let dt = 1.0 / 60.0;
    loop {
        let way = random.direction();
        let (right, up) = way.any_orthonormal_pair();
        let mut aside = || random.between(-1.2, 1.2);
        let aside = right * aside() + up * aside();
        let reach = 2.2 + f64::from(random.between(0.0, 1.0)) * speed * dt;
        let half = way * (0.5 * speed) as f32;
        let first = body(random, A_RING, Vector::ZERO, half, 3.0);
        let second = body(random, shape, way * reach as f32 + aside, -half, 3.0);
        let steps = ((reach + 2.2) / (speed * dt)).ceil() as usize;
        let bodies = vec![first, second];
        let nearest = nearest(&bodies, steps as f64 * dt, speed);
        let is_wanted = match meets {
            true => nearest < 1.5 * radius,
            false => (2.5 * radius..0.4).contains(&nearest),
        };
        if is_wanted {
            return World {
                every: steps + 10,
                bodies,
                meets,
                ..empty(scene, 60.0, steps + 10)
            };
        }
    }
}

/// Least distance of the middle lines of two free bodies; no point moves by more than a centimetre between samples.
fn nearest(bodies: &[Body], time: f64, speed: f64) -> f64 {
    let samples = (time * (speed + 6.0) / 0.01).ceil() as usize;
    let at = |k: usize| {
        let t = time * k as f64 / samples as f64;
        let pose = |b: &Body| Pose::new(b.position, b.rotation).after(b.velocity, b.spin, t);
        let curve = |b: &Body| middle(b.shape).points(&pose(b));
        let ring = pose(&bodies[0]);
        distance(&curve(&bodies[1]), &ring, RING[0])
    };
    (0..=samples).map(at).fold(f64::MAX, f64::min)
}

/// The walls of a closed room, each as thick as told.
fn room(half: [f64; 3], thick: f64) -> Vec<Wall> {
    let mut walls = Vec::new();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let mut center = [0.0; 3];
            center[axis] = side * (half[axis] + 0.5 * thick);
            let mut size = half.map(|h| h + thick);
            size[axis] = 0.5 * thick;
            walls.push(Wall { center, half: size });
        }
    }
    walls
}

/// Rings, single or linked in pairs, that are thrown at each other in a closed room.
fn thrown(scene: &str, speed: f64, linked: usize, count: usize, seed: u64) -> World {
    let mut random = Random(4000 + 10 * seed + linked as u64);
    let spacing = if linked == 1 { 1.4 } else { 2.2 };
    let mut bodies = Vec::new();
    for k in 0..count {
        let place = Vector::new(
            (k % 3) as f32 - 1.0,
            (k / 3 % 3) as f32 - 1.0,
            (k / 9) as f32 - 1.5,
        );
        let at = place * spacing + random.direction() * 0.1;
        let velocity = (random.direction() * 0.4 - at.normalize()) * speed as f32;
        let first = body(&mut random, A_RING, at, velocity, 3.0);
        if linked == 2 {
            // The second one stands upright in the first one's middle line.
            let turn = Rotation::from_array(first.rotation.map(|x| x as f32));
            let upright = turn * Rotation::from_rotation_x(0.5 * PI as f32);
            let velocity = velocity + random.direction() * (0.3 * speed) as f32;
            let place = at + turn * Vector::X * RING[0] as f32;
            let second = body(&mut random, A_RING, place, velocity, 0.0);
            let rotation = upright.to_array().map(f64::from);
            bodies.push(Body { rotation, ..second });
        }
        bodies.push(first);
    }
    let half = [5.0; 3];
    World {
        every: 120,
        gravity: -9.81,
        room: half,
        walls: room(half, 3.0),
        bodies,
        ..empty(scene, 60.0, 120)
    }
}

/// Thirty rings that fall into a pen.
fn rest() -> World {
    let mut random = Random(5000);
    let half = [1.9, 3.0, 1.3];
    let drop = |k: usize| {
        let place = [(k % 3) as f32 - 1.0, (k / 3 % 2) as f32 - 0.5];
        let at = Vector::new(1.2 * place[0], -2.5 + 0.35 * (k / 3) as f32, 1.2 * place[1]);
        body(&mut random, A_RING, at, Vector::ZERO, 0.0)
    };
    World {
        every: 60,
        gravity: -9.81,
        friction: 0.5,
        room: half,
        bodies: (0..30).map(drop).collect(),
        walls: room(half, 1.0),
        ..empty("rest", 60.0, 900)
    }
}

/// Eight elastic cubes without weight or friction in a closed room, ten seconds.
fn elastic(scene: &str, hertz: f64, seed: u64) -> World {
    let mut random = Random(6000 + seed);
    let mut most = |most: f32| Vector::from_array([(); 3].map(|()| random.between(-most, most)));
    let cube = |corner: usize| {
        let side = |bit: usize| if corner & bit == 0 { -0.7 } else { 0.7 };
        Body {
            shape: A_CUBE,
            position: [side(1), side(2), side(4)],
            rotation: [0.0, 0.0, 0.0, 1.0],
            velocity: wide(most(4.0)),
            spin: wide(most(6.0)),
        }
    };
    let half = [1.5; 3];
    World {
        every: (0.1 * hertz) as usize,
        friction: 0.0,
        restitution: 1.0,
        room: half,
        walls: room(half, 1.0),
        bodies: (0..8).map(cube).collect(),
        ..empty(scene, hertz, (10.0 * hertz) as usize)
    }
}
