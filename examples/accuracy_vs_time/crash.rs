//! A spiky creature flies into a blob (the paper's Figure 11): motions over a grid of linear and
//! angular speeds, each with the time at which the triangles first touch.

use crate::common::creature::creature;
use crate::common::isosurface::isosurface;
use crate::common::mesh::Mesh;
use crate::common::triangle_toi::{Motion, TriangleBody, distance_at, first_contact};
use crate::random::Random;
use nalgebra::Vector3;
use rapier3d::parry::query::NonlinearRigidMotion;
use rapier3d::prelude::{Pose, Real, Vector};
use std::f64::consts::PI;

/// Distances that the creature travels in the step, in its own widths.
pub const SPEEDS: [f64; 5] = [0.1, 0.3, 1.0, 3.0, 10.0];
/// Angles that it turns in the step, in radians.
pub const TURNS: [f64; 5] = [0.0, 0.1, 0.5, 1.5, PI];
/// Width of the creature, in metres.
pub const WIDTH: f64 = 4.0;
/// Two surfaces this near have touched, in metres: a hundred-thousandth of the width, above what
/// `f32` vertices resolve.
pub const TOUCH: f64 = 4.0e-5;

/// A motion over one second and what the triangles do in it.
pub struct Case {
    /// Creature first.
    pub motions: [Motion; 2],
    /// When the surfaces first touch, in seconds.
    pub time: Option<f64>,
}

/// Both bodies and the motions.
pub struct Crash {
    /// Creature, blob.
    pub meshes: [Mesh; 2],
    bodies: [TriangleBody; 2],
    /// The motions, grid cell by grid cell.
    pub cases: Vec<Case>,
}

impl Crash {
    /// `count` motions a grid cell, of the creature or of `own` body in its place; `progress` is
    /// called after each.
    pub fn new(own: Option<Mesh>, count: usize, progress: impl Fn() + Sync) -> Self {
        let flies = own.unwrap_or_else(|| creature().0).fitted(WIDTH as Real);
        let meshes = [flies, blob()];
        let bodies = [0, 1].map(|k| TriangleBody::new(&meshes[k]));
        let both = [&bodies[0], &bodies[1]];
        let mut random = Random(11);
        let mut flights = Vec::new();
        for cell in (0..SPEEDS.len()).flat_map(|s| (0..TURNS.len()).map(move |t| [s, t])) {
            let wanted = flights.len() + count;
            while flights.len() < wanted {
                let motions = motions(cell, &mut random);
                if distance_at(both, motions.each_ref(), 0.0) > 10.0 * TOUCH {
                    flights.push(motions);
                }
            }
        }
        let truth = |motions: &[Motion; 2]| {
            let time = first_contact(both, motions.each_ref(), 1.0, TOUCH);
            progress();
            Case {
                motions: *motions,
                time,
            }
        };
        // On two threads: nothing is timed here.
        let (first, second) = flights.split_at(flights.len() / 2);
        let cases = std::thread::scope(|scope| {
            let rest = scope.spawn(|| second.iter().map(truth).collect::<Vec<_>>());
            let mut cases: Vec<Case> = first.iter().map(truth).collect();
            cases.extend(rest.join().expect("the truth of half of the motions"));
            cases
        });
        Self {
            meshes,
            bodies,
            cases,
        }
    }

    /// Distance of the triangles at a time of a case.
    pub fn distance(&self, case: &Case, time: f64) -> f64 {
        let [a, b] = &case.motions;
        distance_at([&self.bodies[0], &self.bodies[1]], [a, b], time)
    }
}

/// The blob stands still; the creature starts so far away that it can just reach it, aims beside
/// its middle by up to its size, and turns about a random axis.
fn motions([speed, turn]: [usize; 2], random: &mut Random) -> [Motion; 2] {
    let travel = SPEEDS[speed] * WIDTH;
    let heading = random.direction();
    let side = random.direction().cross(&heading);
    let target = side * random.range(0.0, 1.2);
    // Slow creatures start near, or they would never arrive.
    let back = random.range(0.3, 0.9) * travel + random.range(0.8, 1.9);
    let creature = Motion {
        start: target - heading * back,
        velocity: heading * travel,
        turn: random.direction() * TURNS[turn],
    };
    let blob = Motion {
        start: Vector3::zeros(),
        velocity: Vector3::zeros(),
        turn: Vector3::zeros(),
    };
    [creature, blob]
}

/// Three balls melted into one, about 1.6 m wide.
fn blob() -> Mesh {
    let balls = [
        (Vector::new(0.0, 0.0, 0.0), 0.6),
        (Vector::new(0.45, 0.35, 0.1), 0.35),
        (Vector::new(-0.3, 0.45, -0.2), 0.25),
    ];
    let field = |p: Vector| {
        let sum: Real = balls
            .iter()
            .map(|(c, r)| (-4.0 * (p.distance(*c) - r)).exp())
            .sum();
        -sum.ln() / 4.0
    };
    isosurface(field, Vector::splat(-1.3), [26; 3], 0.1)
}

/// The same motion as parry's.
pub fn parry_motion(motion: &Motion) -> NonlinearRigidMotion {
    let vector = |v: Vector3<f64>| Vector::new(v.x as Real, v.y as Real, v.z as Real);
    NonlinearRigidMotion::new(
        Pose::from_translation(vector(motion.start)),
        Vector::ZERO,
        vector(motion.velocity),
        vector(motion.turn),
    )
}
