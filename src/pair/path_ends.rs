//! How long one direction keeps two convex pieces apart on the paths that rigid motion moves their spheres on, for
//! [`super::convex_pieces`]. Chords, as in [`super::apart`], bound long spans better; these bounds go by the motion at
//! one time, and by how fast it may change.
//!
//! A direction may stand still or turn with one of the bodies. What lies on a turning face is kept apart from it by the
//! direction across the face while both turn together; one that stands still keeps them apart only until the far end of
//! the face has crossed the gap.

use super::primitive_tree::PrimitiveTree;
use crate::math::lane::Vec3;
use crate::math::motion::{PointState, RigidMotion};
use crate::medial::MedialSphere;

/// Spans on which the bound of a cubic is sought after the first, each twice as long as the time found before.
const CUBIC_STEPS: usize = 3;

/// Rounding of roots and divisions.
const ROOT_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A sphere on its path at a time.
#[derive(Clone, Copy)]
pub(super) struct MovingSphere {
    at: PointState<f64>,
    radius: f64,
    /// Lengths of the acceleration and of the jerk, at all times.
    acceleration: f64,
    jerk: f64,
}

/// The spheres that a node holds, at a time.
pub(super) fn moving_spheres(
    body: &impl PrimitiveTree,
    motion: &RigidMotion<f64>,
    node: u32,
    time: f64,
) -> Vec<MovingSphere> {
    let turned = motion.sin_cos(time);
    let moving = |s: &MedialSphere| {
        let path = motion.point(Vec3::from_vector(s.center));
        MovingSphere {
            at: path.at(time, turned),
            radius: f64::from(s.radius),
            acceleration: path.acceleration,
            jerk: path.jerk,
        }
    };
    match body.convex_piece(node) {
        Some(piece) => piece.spheres.iter().map(moving).collect(),
        None => {
            let (spheres, len) = body.hull(node);
            spheres[..len].iter().map(moving).collect()
        }
    }
}

/// How long a unit direction keeps the spheres of one hull farther than `least` beyond those of another on their paths;
/// `None` if as long as is asked. A sphere is never farther from where its rate leads than half its acceleration times
/// the square of the time.
pub(super) fn held_on_paths(
    [far, near]: [&[MovingSphere]; 2],
    n: Vec3<f64>,
    least: f64,
    asked: f64,
) -> Option<f64> {
    let most = |all: &[MovingSphere]| all.iter().map(|s| s.acceleration).fold(0.0, f64::max);
    let acceleration = most(far) + most(near);
    let end = |s: &MovingSphere, side: f64| {
        let place = n.dot(s.at.position) + side * s.radius;
        (place, n.dot(s.at.velocity))
    };
    let near: Vec<_> = near.iter().map(|s| end(s, -1.0)).collect();
    let mut held = asked;
    for (place, rate) in far.iter().map(|s| end(s, 1.0)) {
        for (other, others) in &near {
            let room = other - place - least;
            if room <= 0.0 {
                return Some(0.0);
            }
            if let Some(met) = first_root(room, others - rate, -acceleration) {
                held = held.min(met);
            }
        }
    }
    (held < asked).then_some(held * (1.0 - ROOT_ROUNDING))
}

/// How long a unit direction that turns with one of two hulls from a time on, `own`, keeps all spheres of the other
/// farther than `least` from it; `None` if as long as is asked. It points from the first hull to the second, and `side`
/// is 1 where it turns with the first, -1 where with the second. The motion of `own`, which `carrier` is, is rigid.
///
/// Along a direction `n` that turns by `ω` a sphere at `d` from the centre of rotation is at `h = n·d`. The derivatives
/// of `h` follow from those of `d` and from `n' = ω × n`. With a bound `J` of the third one, `h` is at least
/// `h + h' s + h'' s²/2 - J s³/6` after `s`. The spheres of `own` stay where they are along `n`.
pub(super) fn held_turning(
    (carrier, own): (&RigidMotion<f64>, &[MovingSphere]),
    others: &[MovingSphere],
    (n, side): (Vec3<f64>, f64),
    [time, asked]: [f64; 2],
    least: f64,
) -> Option<f64> {
    let (omega, angle) = (carrier.angular_velocity(), carrier.angle());
    let [center, drift] = carrier.center_at(time);
    let n1 = omega.cross(n);
    let n2 = omega.cross(n1);
    let (first, second) = (n1.length(), n2.length());
    let reaches = own
        .iter()
        .map(|s| side * n.dot(s.at.position - center) + s.radius);
    let reach = reaches.fold(f64::MIN, f64::max);
    let mut held = asked;
    for s in others {
        let (d, d2) = (s.at.position - center, s.at.acceleration);
        let d1 = s.at.velocity - drift;
        let fastest = d1.length() + s.acceleration * held;
        let farthest = d.length() + fastest * held;
        let jerk =
            second * (angle * farthest + 3.0 * fastest) + 3.0 * first * s.acceleration + s.jerk;
        let room = side * n.dot(d) - reach - s.radius - least;
        let rate = side * (n1.dot(d) + n.dot(d1));
        let bend = side * (n2.dot(d) + 2.0 * n1.dot(d1) + n.dot(d2));
        held = stays_above([room, rate, bend, jerk], held);
    }
    (held < asked).then_some(held * (1.0 - ROOT_ROUNDING))
}

/// A time, at most `asked`, up to which `room + rate s + bend s²/2 - jerk s³/6` is above 0. On a span the last term is
/// no more than a part of the square, and what is left has its first root in closed form.
fn stays_above([room, rate, bend, jerk]: [f64; 4], asked: f64) -> f64 {
    if room <= 0.0 {
        return 0.0;
    }
    let on_span = |span: f64| {
        let root = first_root(room, rate, bend - jerk * span / 3.0);
        root.map_or(span, |root| root.min(span))
    };
    let mut held = on_span(asked);
    for _ in 0..CUBIC_STEPS {
        held = held.max(on_span(asked.min(2.0 * held)));
    }
    held
}

/// The time at which `room + rate s + bend s²/2`, above 0 at first, comes to 0; `None` if never. Of the two forms of
/// the root, the one that adds numbers of one sign is used: the other loses a small room beside a large rate.
fn first_root(room: f64, rate: f64, bend: f64) -> Option<f64> {
    let square = rate * rate - 2.0 * bend * room;
    if square < 0.0 {
        return None;
    }
    let sum = square.sqrt() + rate.abs();
    let root = match rate > 0.0 {
        true => sum / -bend,
        false => 2.0 * room / sum,
    };
    (root >= 0.0 && root.is_finite()).then_some(root)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Pose, Rotation, Vector};
    use parry3d::query::NonlinearRigidMotion;

    fn sphere(motion: &RigidMotion<f64>, center: Vector, radius: f64, time: f64) -> MovingSphere {
        let path = motion.point(Vec3::from_vector(center));
        MovingSphere {
            at: path.at(time, motion.sin_cos(time)),
            radius,
            acceleration: path.acceleration,
            jerk: path.jerk,
        }
    }

    /// Corners of a plate and of a die, each with a radius of a hundredth.
    fn corners() -> [Vec<Vector>; 2] {
        let signs = [-1.0, 1.0];
        let all = |half: Vector| {
            let across = |x| signs.map(|y| signs.map(|z| half * Vector::new(x, y, z)));
            signs.map(across).concat().concat()
        };
        [Vector::new(1.0, 0.1, 1.0), Vector::splat(0.2)].map(all)
    }

    /// Of pairs that spin at random, whichever the direction turns with: brute force at a thousand times.
    #[test]
    fn nothing_crosses_a_turning_direction_while_it_holds() {
        let mut state = 7u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f32::from((state >> 16) as u16) / 32_768.0 - 1.0
        };
        let mut vector = move |size: f32| Vector::new(random(), random(), random()) * size;
        let mut met = 0;
        for _ in 0..500 {
            let mut motion = |place: Vector| {
                let pose = Pose::from_parts(place, Rotation::from_scaled_axis(vector(0.1)));
                NonlinearRigidMotion::new(pose, vector(2.0), vector(1.0), vector(1.5))
            };
            let motions = [motion(Vector::ZERO), motion(Vector::Y * 0.8)];
            let pair = RigidMotion::<f64>::pair(&motions[0], &motions[1], 1.0);
            let hulls = corners();
            let place = |time: f64| {
                [0, 1].map(|k| {
                    hulls[k]
                        .iter()
                        .map(|c| sphere(&pair[k], *c, 0.01, time))
                        .collect()
                })
            };
            let start: [Vec<MovingSphere>; 2] = place(0.0);
            let n = Vec3::new(0.0, 1.0, 0.0);
            for (k, side) in [(0, 1.0), (1, -1.0)] {
                let (own, others) = (&start[k], &start[1 - k]);
                let held = held_turning((&pair[k], own), others, (n, side), [0.0, 1.0], 0.0);
                let until = held.unwrap_or(1.0);
                met += usize::from(held.is_some());
                let axis = pair[k].angular_velocity();
                for step in 0..=1000 {
                    let time = until * f64::from(step) / 1000.0;
                    let turned = turn(n, axis, time);
                    let ends = |spheres: &[MovingSphere], side: f64| {
                        let ends = spheres
                            .iter()
                            .map(|s| side * turned.dot(s.at.position) + s.radius);
                        ends.fold(f64::MIN, f64::max)
                    };
                    let [first, second] = place(time);
                    let gap = -ends(&second, -1.0) - ends(&first, 1.0);
                    assert!(gap > -1.0e-9 || until == 0.0, "{gap} at {time} of {until}");
                }
            }
        }
        assert!((200..1000).contains(&met), "{met} meet");
    }

    /// What first moves away and then comes back, from as near as you like.
    #[test]
    fn roots_are_right_however_little_room_there_is() {
        for room in [1.0e-4, 1.0e-9, 1.0e-12, 1.0e-15, 1.0e-17, 1.0e-300] {
            // 1 s - 2 s², from `room` on.
            let root = first_root(room, 1.0, -4.0).expect("a root");
            assert!((root - 0.5).abs() <= 1.1 * room + 1.0e-16, "{room}: {root}");
            // -1 s + s²/2, which comes to -1/2 at 1.
            let root = first_root(room, -1.0, 1.0).expect("a root");
            assert!(
                (root / room - 1.0).abs() <= room + 1.0e-15,
                "{room}: {root}"
            );
        }
        assert_eq!(first_root(1.0, -1.0, 1.0), None);
        assert_eq!(first_root(1.0, 1.0, 0.0), None);
        assert_eq!(first_root(1.0, 0.0, 0.0), None);
        assert_eq!(first_root(1.0, -2.0, 0.0), Some(0.5));
    }

    /// A vector turned by `axis`, a scaled axis per unit of time.
    fn turn(n: Vec3<f64>, axis: Vec3<f64>, time: f64) -> Vec3<f64> {
        let angle = axis.length() * time;
        if angle == 0.0 {
            return n;
        }
        let axis = axis * (1.0 / axis.length());
        let along = axis * axis.dot(n);
        along + (n - along) * angle.cos() + axis.cross(n) * angle.sin()
    }

    /// A plate and what lies above it turn about one axis: its normal, turning, keeps them apart for good, and standing
    /// still only until its rim has crossed the gap.
    #[test]
    fn what_turns_together_stays_apart_along_a_turning_normal() {
        let motion = |place: Vector| {
            let pose = Pose::from_translation(place);
            NonlinearRigidMotion::new(pose, -place, Vector::ZERO, Vector::Z * 0.2)
        };
        let motions = [motion(Vector::ZERO), motion(Vector::Y * 0.33)];
        let pair = RigidMotion::<f64>::pair(&motions[0], &motions[1], 1.0);
        let hulls = corners();
        let [a, b] = [0, 1].map(|k| {
            let moving = hulls[k].iter().map(|c| sphere(&pair[k], *c, 0.01, 0.0));
            moving.collect::<Vec<_>>()
        });
        let n = Vec3::new(0.0, 1.0, 0.0);
        let turning = held_turning((&pair[0], &a), &b, (n, 1.0), [0.0, 1.0], 0.0);
        let still = held_on_paths([&a, &b], n, 0.0, 1.0);
        assert!(turning.is_none(), "{turning:?}");
        assert!(still.is_some_and(|held| held < 0.1), "{still:?}");
    }
}
