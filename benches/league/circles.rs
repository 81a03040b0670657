//! The judge's geometry, in double precision and of its own: circles and segments, their distance, linking numbers.

use std::f64::consts::TAU;

pub type Point = [f64; 3];

fn add(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn scale(a: Point, s: f64) -> Point {
    a.map(|x| x * s)
}

fn cross(a: Point, b: Point) -> Point {
    let of = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    [of(1, 2), of(2, 0), of(0, 1)]
}

pub fn length(a: Point) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

pub fn minus(a: Point, b: Point) -> Point {
    add(a, scale(b, -1.0))
}

/// Position and rotation (quaternion x, y, z, w).
#[derive(Clone, Copy)]
pub struct Pose {
    position: Point,
    rotation: [f64; 4],
}

impl Pose {
    /// The rotation need not be normalised.
    pub fn new(position: Point, rotation: [f64; 4]) -> Self {
        let norm = rotation.iter().map(|x| x * x).sum::<f64>().sqrt();
        let rotation = rotation.map(|x| x / norm);
        Self { position, rotation }
    }

    fn turn(&self, v: Point) -> Point {
        let [x, y, z, w] = self.rotation;
        let axis = [x, y, z];
        let twice = scale(cross(axis, v), 2.0);
        add(v, add(scale(twice, w), cross(axis, twice)))
    }

    fn to_world(self, v: Point) -> Point {
        add(self.position, self.turn(v))
    }

    fn to_local(self, v: Point) -> Point {
        let [x, y, z, w] = self.rotation;
        let inverse = Self {
            position: [0.0; 3],
            rotation: [-x, -y, -z, w],
        };
        inverse.turn(minus(v, self.position))
    }

    /// The pose after so many seconds of free motion with constant velocity and spin.
    pub fn after(&self, velocity: Point, spin: Point, seconds: f64) -> Self {
        let rate = length(spin);
        let (sin, cos) = (0.5 * rate * seconds).sin_cos();
        let [a, b, c] = scale(spin, sin / rate.max(1.0e-12));
        let [x, y, z, w] = self.rotation;
        let rotation = [
            cos * x + a * w + b * z - c * y,
            cos * y + b * w + c * x - a * z,
            cos * z + c * w + a * y - b * x,
            cos * w - a * x - b * y - c * z,
        ];
        Self::new(add(self.position, scale(velocity, seconds)), rotation)
    }
}

/// The middle of a body: a circle about its y axis, or a segment along it to both sides.
pub enum Curve {
    Circle(f64),
    Segment(f64),
}

impl Curve {
    /// Points of the curve, 96 on a circle.
    pub fn points(&self, pose: &Pose) -> Vec<Point> {
        let points = 0..96;
        let local = |k: i32| match *self {
            Self::Circle(radius) => {
                let (sin, cos) = (TAU * f64::from(k) / 96.0).sin_cos();
                [radius * cos, 0.0, radius * sin]
            }
            Self::Segment(half) => [0.0, half * (f64::from(k) / 47.5 - 1.0), 0.0],
        };
        points.map(|k| pose.to_world(local(k))).collect()
    }
}

/// Least distance of points from a circle about a pose's y axis.
pub fn distance(points: &[Point], pose: &Pose, radius: f64) -> f64 {
    let of = |p: &Point| {
        let [x, y, z] = pose.to_local(*p);
        (x.hypot(z) - radius).hypot(y)
    };
    points.iter().map(of).fold(f64::MAX, f64::min)
}

/// Linking number of two closed polygons: half the signed crossings of their projection. A fixed rotation keeps edges
/// from being seen end on.
pub fn linking(a: &[Point], b: &[Point]) -> i32 {
    let seen = |p: &Point| {
        let [x, y, z] = *p;
        [
            0.8 * x + 0.33 * y + 0.5 * z,
            -0.41 * x + 0.91 * y + 0.06 * z,
            -0.44 * x - 0.25 * y + 0.86 * z,
        ]
    };
    let edges = |l: &[Point]| -> Vec<[Point; 2]> {
        let points: Vec<_> = l.iter().map(seen).collect();
        let next = |i: usize| points[(i + 1) % points.len()];
        (0..points.len()).map(|i| [points[i], next(i)]).collect()
    };
    let (first, second) = (edges(a), edges(b));
    let mut sum = 0;
    for [p, q] in &first {
        for [r, s] in &second {
            let (d, e, w) = (minus(*q, *p), minus(*s, *r), minus(*r, *p));
            let flat = |u: Point, v: Point| u[0] * v[1] - u[1] * v[0];
            let (t, u) = (flat(w, e) / flat(d, e), flat(w, d) / flat(d, e));
            if (0.0..1.0).contains(&t) && (0.0..1.0).contains(&u) {
                let is_above = p[2] + t * d[2] > r[2] + u * e[2];
                sum += if (flat(d, e) > 0.0) == is_above {
                    1
                } else {
                    -1
                };
            }
        }
    }
    sum / 2
}
