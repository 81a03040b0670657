//! Tori: their meshes, seeded motions of two of them, and the true time at which they meet.
//!
//! The judge: two tori of the same tube meet when the distance of their centre circles falls to two
//! tube radii. From a point `(ρ, h)`, in cylindrical coordinates of the other torus, to its circle
//! that is `√((ρ − R)² + h²)`; the minimum over the points of the first circle is sampled, then
//! narrowed. It changes no faster than the bodies' points move, so an interval of time whose ends
//! are far enough apart is free; others are halved, the earlier half first.
//!
//! Each bench uses a part of it.
#![allow(dead_code)]

use nalgebra::{Quaternion, Translation3, UnitQuaternion, Vector3};
use rapier3d::math::{Pose, Vector};
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d_medial::{MedialMesh, MedialSphere};
use std::f64::consts::TAU;

/// Radius of the centre circle.
pub const MAJOR: f64 = 0.5;
/// Radius of the tube.
pub const MINOR: f64 = 0.12;

/// Points of the centre circle where its distance is sampled.
const SAMPLES: usize = 180;

/// A ring of equal cones about the Y axis.
pub fn ring(n: u32) -> MedialMesh {
    let sphere = |i| {
        let angle = TAU * f64::from(i) / f64::from(n);
        MedialSphere::new(point(MAJOR, 0.0, angle), MINOR as f32)
    };
    let edges = (0..n).map(|i| [i, (i + 1) % n]).collect();
    MedialMesh::new((0..n).map(sphere).collect(), edges, vec![]).expect("a ring is a medial mesh")
}

/// The surface in 1536 triangles about the Y axis.
pub fn surface() -> (Vec<Vector>, Vec<[u32; 3]>) {
    let (around, across) = (48, 16);
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..around {
        for j in 0..across {
            let tube = TAU * f64::from(j) / f64::from(across);
            let radius = MAJOR + MINOR * tube.cos();
            points.push(point(
                radius,
                MINOR * tube.sin(),
                TAU * f64::from(i) / f64::from(around),
            ));
            let at = |i: u32, j: u32| i % around * across + j % across;
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    (points, triangles)
}

fn point(radius: f64, height: f64, angle: f64) -> Vector {
    let (sin, cos) = angle.sin_cos();
    Vector::new((radius * cos) as f32, height as f32, (radius * sin) as f32)
}

/// Two motions over one second, and when the tori meet.
pub struct Meeting {
    pub motions: [NonlinearRigidMotion; 2],
    /// The true time, if they do.
    pub time: Option<f64>,
}

impl Meeting {
    pub fn new(motions: [NonlinearRigidMotion; 2]) -> Self {
        let judge = Judge::new(&motions);
        let ends = [0.0, 1.0].map(|t| (t, judge.distance(t)));
        let time = judge.first(ends[0], ends[1]);
        Self { motions, time }
    }
}

/// Seeded motions of tori that start apart: so many in which they meet, and so many in which they
/// come closer than a quarter of their size without meeting.
pub fn approaching(hits: usize, misses: usize) -> Vec<Meeting> {
    let mut random = Random(5);
    choose(hits, misses, || {
        let away = random.direction() * random.range(1.3, 1.8);
        let towards = away * -random.range(0.8, 1.6) + random.direction() * 0.4;
        let turns = [0, 1].map(|_| random.direction() * random.range(0.0, 3.0));
        Meeting::new([
            random.motion(Vector::ZERO, turns[0], Vector::ZERO),
            random.motion(away, turns[1], towards),
        ])
    })
}

/// Seeded motions of linked tori, the tube of each in the middle of the other's hole at the start;
/// in some they do not meet.
pub fn linked(hits: usize, misses: usize) -> Vec<Meeting> {
    let mut random = Random(6);
    choose(hits, misses, || {
        let shift = random.direction() * 0.05;
        let slip = random.direction() * random.range(0.05, 1.5);
        let upright = Vector::X * std::f32::consts::FRAC_PI_2;
        Meeting::new([
            random.motion(Vector::ZERO, Vector::ZERO, Vector::ZERO),
            random.motion(Vector::X * MAJOR as f32 + shift, upright, slip),
        ])
    })
}

fn choose(hits: usize, misses: usize, mut draw: impl FnMut() -> Meeting) -> Vec<Meeting> {
    let mut found = Vec::new();
    let mut wanted = [hits, misses];
    while wanted != [0, 0] {
        let meeting = draw();
        let judge = Judge::new(&meeting.motions);
        let nearest = (0..=100).map(|i| judge.distance(f64::from(i) / 100.0));
        let close = nearest.fold(f64::MAX, f64::min) < 0.5 * MAJOR;
        let left = &mut wanted[usize::from(meeting.time.is_none())];
        if *left > 0 && close && meeting.time != Some(0.0) {
            *left -= 1;
            found.push(meeting);
        }
    }
    found
}

/// A torus in motion, in double precision: parry's, about the body's own origin.
struct Mover {
    at: Vector3<f64>,
    turn: UnitQuaternion<f64>,
    velocity: Vector3<f64>,
    spin: Vector3<f64>,
}

impl Mover {
    fn new(motion: &NonlinearRigidMotion) -> Self {
        assert_eq!(motion.local_center, Vector::ZERO);
        let double = |v: Vector| Vector3::new(v.x.into(), v.y.into(), v.z.into());
        let [i, j, k, w] = motion.start.rotation.to_array().map(f64::from);
        Self {
            at: double(motion.start.translation),
            turn: UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k)),
            velocity: double(motion.linvel),
            spin: double(motion.angvel),
        }
    }

    fn pose(&self, t: f64) -> nalgebra::Isometry3<f64> {
        let turn = UnitQuaternion::from_scaled_axis(self.spin * t) * self.turn;
        nalgebra::Isometry3::from_parts(Translation3::from(self.at + self.velocity * t), turn)
    }
}

struct Judge {
    movers: [Mover; 2],
    /// Bound of the rate at which the distance changes.
    speed: f64,
}

impl Judge {
    fn new(motions: &[NonlinearRigidMotion; 2]) -> Self {
        let movers = [Mover::new(&motions[0]), Mover::new(&motions[1])];
        let [a, b] = &movers;
        let speed = (a.velocity - b.velocity).norm() + (a.spin.norm() + b.spin.norm()) * MAJOR;
        Self { movers, speed }
    }

    /// Signed distance of the tori at a time.
    fn distance(&self, t: f64) -> f64 {
        let relative = self.movers[1].pose(t).inv_mul(&self.movers[0].pose(t));
        let to_circle = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let p = relative * nalgebra::Point3::new(MAJOR * cos, 0.0, MAJOR * sin);
            (p.x.hypot(p.z) - MAJOR).hypot(p.y)
        };
        let step = TAU / SAMPLES as f64;
        let sampled: Vec<f64> = (0..SAMPLES).map(|i| to_circle(i as f64 * step)).collect();
        let mut least = f64::MAX;
        for i in 0..SAMPLES {
            let around = [
                sampled[(i + SAMPLES - 1) % SAMPLES],
                sampled[(i + 1) % SAMPLES],
            ];
            if sampled[i] <= around[0] && sampled[i] <= around[1] {
                let (mut low, mut high) = ((i as f64 - 1.0) * step, (i as f64 + 1.0) * step);
                while high - low > 1.0e-7 {
                    let thirds = [(2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0];
                    if to_circle(thirds[0]) < to_circle(thirds[1]) {
                        high = thirds[1];
                    } else {
                        low = thirds[0];
                    }
                }
                least = least.min(to_circle((low + high) / 2.0));
            }
        }
        least - 2.0 * MINOR
    }

    /// First time between two, each with its distance, at which the tori meet.
    fn first(&self, start: (f64, f64), end: (f64, f64)) -> Option<f64> {
        if start.1 <= 0.0 {
            return Some(start.0);
        }
        let length = end.0 - start.0;
        if start.1 + end.1 > self.speed * length {
            return None;
        }
        if length < 1.0e-8 {
            return (end.1 <= 0.0).then_some(end.0);
        }
        let middle = (start.0 + end.0) / 2.0;
        let middle = (middle, self.distance(middle));
        self.first(start, middle)
            .or_else(|| self.first(middle, end))
    }
}

/// A small generator of reproducible numbers (Knuth's MMIX constants).
struct Random(u64);

impl Random {
    fn range(&mut self, low: f32, high: f32) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        low + (high - low) * ((self.0 >> 40) as f32 / (1u64 << 24) as f32)
    }
    /// A start pose and a velocity, with a spin of up to half a turn in the second.
    fn motion(&mut self, at: Vector, turn: Vector, velocity: Vector) -> NonlinearRigidMotion {
        let spin = self.direction() * self.range(0.05, 3.0);
        NonlinearRigidMotion::new(Pose::new(at, turn), Vector::ZERO, velocity, spin)
    }
    fn direction(&mut self) -> Vector {
        let mut one = || self.range(-1.0, 1.0);
        Vector::new(one(), one(), one()).normalize_or_zero()
    }
}
