//! Hands queries to the crate under test, in each precision, and reads its answers.

use super::judge::Answer;
use super::motion::{Ball, Motion, Query, Rigid};
use nalgebra::Vector3;
use parry3d::query::NonlinearRigidMotion;
use rapier3d_medial::elementary::many::{Lanes, first_contacts};
use rapier3d_medial::elementary::{self, MovingSphere, Toi, ToiOptions};
use rapier3d_medial::math::{Pose, Rotation, Vector};
use rapier3d_medial::pair::first_contact;
use rapier3d_medial::{MedialMesh, MedialSphere};
use std::time::{Duration, Instant};

/// What is under test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// The certified query in single precision.
    Single,
    /// The certified query in double precision.
    Double,
    /// The certified query in single precision, many at once; straight paths only.
    Lanes,
    /// The certified query of two meshes of one primitive each; rigid motion only.
    Mesh,
    /// The paper's iteration in double precision; straight paths only.
    Paper,
}

impl Subject {
    /// Those that give a guarantee.
    pub const CERTIFIED: [Self; 4] = [Self::Single, Self::Lanes, Self::Double, Self::Mesh];

    /// The tolerances it is asked for, with bodies of the given length. For the paper's iteration
    /// it is the distance at which it stops.
    pub fn options(self, size: f64) -> ToiOptions {
        let (tolerance, time_tolerance) = match self {
            Self::Single | Self::Lanes | Self::Mesh => (1.0e-4, 1.0e-6),
            Self::Double => (1.0e-9, 1.0e-10),
            Self::Paper => (1.0e-6, 1.0e-6),
        };
        let mut options = ToiOptions::default();
        options.tolerance = (tolerance * size) as f32;
        options.time_tolerance = time_tolerance;
        options
    }

    /// By how much its contact time may exceed the true one: nothing where that is guaranteed.
    pub fn late_by(self) -> f64 {
        match self {
            Self::Single | Self::Lanes | Self::Double | Self::Mesh => 0.0,
            Self::Paper => 1.0e-3,
        }
    }

    /// The answers to queries. `None` where the subject does not take such queries.
    pub fn answers(self, queries: &[Query], options: &ToiOptions) -> Vec<Option<Answer>> {
        if self != Self::Lanes {
            return queries
                .iter()
                .map(|query| self.answer(query, options))
                .collect();
        }
        let is_straight = |query: &&Query| query.motion == Motion::Straight;
        let sides: Vec<[Vec<MovingSphere>; 2]> = queries
            .iter()
            .filter(is_straight)
            .map(|query| query.balls.each_ref().map(|balls| each(balls, single)))
            .collect();
        let pairs: Vec<_> = sides.iter().map(|[a, b]| [&a[..], &b[..]]).collect();
        let (tois, time) = timed(|| first_contacts(&pairs, options, Lanes::Fastest));
        let time = time / pairs.len().max(1) as u32;
        let mut tois = tois.iter();
        let mut next = || tois.next().map(|toi| answer(toi, time));
        queries
            .iter()
            .map(|query| is_straight(&query).then(&mut next).flatten())
            .collect()
    }

    /// The answer to a query. `None` where the subject does not take such queries.
    pub fn answer(self, query: &Query, options: &ToiOptions) -> Option<Answer> {
        match self {
            Self::Single => {
                let (toi, time) = single_toi(query, options);
                return Some(answer(&toi, time));
            }
            Self::Lanes => return self.answers(std::slice::from_ref(query), options)[0],
            Self::Mesh => return mesh_answer(query, options),
            Self::Double | Self::Paper => {}
        }
        let [a, b] = &query.balls;
        let options = widen(options);
        let (toi, time) = match (self, &query.motion) {
            (Self::Paper, Motion::Rigid(..)) => return None,
            (Self::Paper, Motion::Straight) => {
                let (a, b) = (each(a, double), each(b, double));
                timed(|| elementary::f64::alternating(&a, &b, &options))
            }
            (_, Motion::Straight) => {
                let (a, b) = (each(a, double), each(b, double));
                timed(|| elementary::f64::first_contact(&a, &b, &options))
            }
            (_, Motion::Rigid(motions, seconds)) => {
                let (a, b) = (each(a, medial), each(b, medial));
                let [m1, m2] = motions.each_ref().map(rigid);
                let ask = elementary::f64::first_contact_rigid;
                timed(|| ask(&a, &m1, &b, &m2, *seconds, &options))
            }
        };
        Some(Answer {
            status: toi.status,
            lower: toi.lower,
            upper: toi.upper,
            tolerance: toi.tolerance,
            iterations: toi.iterations,
            time,
        })
    }
}

/// The bodies of a query in rigid motion as meshes of one primitive each, with their motions and the seconds
/// of the step; `None` of what is no mesh.
pub fn meshes(query: &Query) -> Option<([MedialMesh; 2], [NonlinearRigidMotion; 2], f32)> {
    let Motion::Rigid(motions, seconds) = &query.motion else {
        return None;
    };
    let mesh = |balls: &Vec<Ball>| {
        let (edges, faces) = match balls.len() {
            2 => (vec![[0, 1]], vec![]),
            3 => (vec![], vec![[0, 1, 2]]),
            _ => (vec![], vec![]),
        };
        MedialMesh::new(each(balls, medial), edges, faces).ok()
    };
    let [a, b] = query.balls.each_ref().map(mesh);
    Some(([a?, b?], motions.each_ref().map(rigid), *seconds as f32))
}

/// The answer of a mesh query. It is found in `f64` and told in `f32`: the time of contact is rounded, and
/// the bodies are within the tolerance but for how far they move meanwhile.
fn mesh_answer(query: &Query, options: &ToiOptions) -> Option<Answer> {
    let Motion::Rigid(motions, seconds) = &query.motion else {
        return None;
    };
    let ([a, b], [m1, m2], length) = meshes(query)?;
    let (toi, time) = timed(|| first_contact(&a, &m1, &b, &m2, length, options));
    let swing = |k: usize| {
        let arm = |ball: &Ball| (ball.center - motions[k].local_center).norm();
        let arms = query.balls[k].iter().map(arm);
        motions[k].angvel.norm() * arms.fold(0.0, f64::max)
    };
    let speed = (motions[0].linvel - motions[1].linvel).norm() + swing(0) + swing(1);
    let mut answer = answer(&toi, time);
    answer.tolerance += 0.5 * f64::from(f32::EPSILON) * speed * *seconds;
    Some(answer)
}

fn answer(toi: &Toi, time: Duration) -> Answer {
    Answer {
        status: toi.status,
        lower: toi.lower.into(),
        upper: toi.upper.into(),
        tolerance: toi.tolerance.into(),
        iterations: toi.iterations,
        time,
    }
}

/// The full answer in single precision, and how long it took.
pub fn single_toi(query: &Query, options: &ToiOptions) -> (Toi, Duration) {
    let [a, b] = &query.balls;
    match &query.motion {
        Motion::Straight => {
            let (a, b) = (each(a, single), each(b, single));
            timed(|| elementary::first_contact(&a, &b, options))
        }
        Motion::Rigid(motions, seconds) => {
            let (a, b) = (each(a, medial), each(b, medial));
            let [m1, m2] = motions.each_ref().map(rigid);
            let seconds = *seconds as f32;
            timed(|| elementary::first_contact_rigid(&a, &m1, &b, &m2, seconds, options))
        }
    }
}

fn timed<T>(call: impl FnOnce() -> T) -> (T, Duration) {
    let start = Instant::now();
    let answer = call();
    (answer, start.elapsed())
}

fn each<T>(balls: &[Ball], convert: impl Fn(&Ball) -> T) -> Vec<T> {
    balls.iter().map(convert).collect()
}

fn vector(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x as f32, v.y as f32, v.z as f32)
}

fn single(ball: &Ball) -> MovingSphere {
    MovingSphere {
        center: vector(&ball.center),
        radius: ball.radius as f32,
        displacement: vector(&ball.displacement),
    }
}

fn double(ball: &Ball) -> elementary::f64::MovingSphere {
    elementary::f64::MovingSphere {
        center: ball.center.into(),
        radius: ball.radius,
        displacement: ball.displacement.into(),
    }
}

fn medial(ball: &Ball) -> MedialSphere {
    MedialSphere::new(vector(&ball.center), ball.radius as f32)
}

fn rigid(motion: &Rigid) -> NonlinearRigidMotion {
    let [x, y, z, w] = motion.rotation.map(|q| q as f32);
    NonlinearRigidMotion::new(
        Pose::from_parts(vector(&motion.translation), Rotation::from_xyzw(x, y, z, w)),
        vector(&motion.local_center),
        vector(&motion.linvel),
        vector(&motion.angvel),
    )
}

fn widen(options: &ToiOptions) -> elementary::f64::ToiOptions {
    elementary::f64::ToiOptions {
        tolerance: options.tolerance.into(),
        time_tolerance: options.time_tolerance.into(),
        max_iterations: options.max_iterations,
        target_distance: options.target_distance.into(),
        alternating_start: options.alternating_start,
    }
}
